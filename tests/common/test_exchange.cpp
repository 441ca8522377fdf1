// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/cell_grid.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/simulation.hpp>

#include <support/cases.hpp>
#include <support/exchanges.hpp>
#include <support/scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
Grain<Dim> ball(const Vec<Dim>& place, double radius = 1) {
  Grain<Dim> g;
  g.position = place;
  g.radius = radius;
  g.mass = grain_volume<Dim>(radius);
  return g;
}

/// A bed in a corner, which is open to the far side.
template <int Dim>
MotionScene<Dim> corner_bed(int count) {
  MotionScene<Dim> bed = settling_bed<Dim>(count, 3);
  std::erase_if(bed.walls, [](const Wall<Dim>& wall) { return wall.name == "high"; });
  return bed;
}

/// Grains that are far from all others, each at a place of its own.
template <int Dim>
std::vector<Grain<Dim>> hermits(int count, int first = 0) {
  std::vector<Grain<Dim>> list;
  for (int k = first; k < first + count; ++k) {
    list.push_back(ball<Dim>(Vec<Dim>::Constant(1.1) + (5000.0 + 3 * k) * along<Dim>()));
  }
  return list;
}

template <class Action>
std::string contract_error_of(Action&& action) {
  try {
    action();
  } catch (const ContractError& error) {
    return error.what();
  }
  return "accepted";
}

/// The first grains of `sim` are those of `other`, bit for bit, and so are their contacts.
template <class A, class B>
bool begins_with(const A& sim, const B& other) {
  const auto& g = sim.grains();
  const auto& h = other.grains();
  const auto n = h.position.cols();
  bool same = g.position.leftCols(n) == h.position && g.velocity.leftCols(n) == h.velocity &&
              g.force.leftCols(n) == h.force && contact_memories(sim) == contact_memories(other);
  if constexpr (A::needs.spin) same = same && g.omega.leftCols(n) == h.omega;
  return same;
}

}  // namespace

TEST_SUITE("grains that come and leave") {
  TEST_CASE_TEMPLATE("those who stay move as if nobody had come or left, bit for bit", C,
                     Case<2, LinearSpring>, Case<2, FrictionalSpring>, Case<2, ViscousSpring>,
                     Case<3, FrictionalHertz>, Case<3, ViscousHertz>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    const auto law = make_law<Law>(kGravel);
    const auto bed = corner_bed<Dim>(Dim == 2 ? 60 : 90);
    // Hermits are first and last, so that numbers and slots of the others change.
    MotionScene<Dim> with_hermits = bed;
    const auto far = hermits<Dim>(6);
    with_hermits.grains.insert(with_hermits.grains.begin(), far.begin(), far.begin() + 3);
    with_hermits.grains.insert(with_hermits.grains.end(), far.begin() + 3, far.end());
    auto alone = start<Dim>(bed, law, CellGrid<Dim>{});
    auto sim = start<Dim>(with_hermits, law, CellGrid<Dim>{});
    alone.step(400);
    sim.step(400);
    const int n = static_cast<int>(bed.grains.size());

    sim.exchange({0, 1, 2, n + 3, n + 5}, make_grains<Dim, Law::needs>({}));
    CHECK(begins_with(sim, alone));
    CHECK(sim.ids().front() == 3);
    CHECK(sim.ids().back() == n + 4);
    for (int k = 0; k < 20; ++k) {
      alone.step(30);
      sim.step(30);
      REQUIRE(begins_with(sim, alone));
      sim.exchange({n}, make_grains<Dim, Law::needs>(hermits<Dim>(1 + k % 2, 10 * (k + 1))));
      REQUIRE(begins_with(sim, alone));
    }
    CHECK(sim.flow().dashpot > 0);
  }

  TEST_CASE("newcomers do not disturb the sums of a bed of several blocks") {
    const auto law = make_law<FrictionalSpring>(kGravel);
    const auto bed = corner_bed<2>(2500);
    auto alone = start<2>(bed, law, CellGrid<2>{});
    auto sim = start<2>(bed, law, CellGrid<2>{}, 3);
    for (int k = 0; k < 5; ++k) {
      alone.step(40);
      sim.step(40);
      sim.exchange({}, make_grains<2, Needs{true, true}>(hermits<2>(100, 100 * k)));
    }
    CHECK(begins_with(sim, alone));
  }

  TEST_CASE_TEMPLATE("grains that come at time 0 move like those that were there, bit for bit", C,
                     Case<2, FrictionalSpring>, Case<3, ViscousHertz>) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    const auto law = make_law<Law>(kGravel);
    const auto scene = stirring<Dim>(60, 5);
    auto reference = start<Dim>(scene, law, AllPairs<Dim>{});
    Setting<Dim> setting = reference.setting();
    Sim<Dim, Law> sim(make_grains<Dim, Law::needs>({}), LawTable<Law>(law), scene.walls, setting);

    sim.exchange({}, make_grains<Dim, Law::needs>(scene.grains));

    sim.step(500);
    reference.step(500);
    CHECK(same_bits(sim, reference));
    CHECK(relative_error(sim.flow().carried,
                         kinetic_energy(make_grains<Dim, Law::needs>(scene.grains))) < 1e-14);
  }

  TEST_CASE_TEMPLATE("random exchanges are the same with linked cells, and the ledger closes", C,
                     Case<2, LinearSpring>, Case<2, FrictionalSpring>, Case<2, ViscousSpring>,
                     Case<3, FrictionalHertz>, Case<3, ViscousHertz>, Case<3, Hertz>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(kGravel);
    for (int seed = 0; seed < cases(2, 20); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      const auto scene = settling_bed<Dim>(80, static_cast<std::uint64_t>(seed));
      auto reference = start<Dim>(scene, law, AllPairs<Dim>{});
      auto sim = start<Dim>(scene, law, CellGrid<Dim>{});
      check_exchanges<Dim>(sim, reference, 40, 25, random);
    }
  }

  TEST_CASE("random exchanges in several blocks are the same for all threads") {
    const auto law = make_law<FrictionalSpring>(kGravel);
    Random random(1);
    const auto scene = settling_bed<2>(3000, 1);
    auto reference = start<2>(scene, law, CellGrid<2>{});
    auto sim = start<2>(scene, law, CellGrid<2>{}, 3);
    check_exchanges<2>(sim, reference, 8, 20, random);
  }

  TEST_CASE_TEMPLATE("the force of one that leaves ends at once, on grains and walls", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const auto law = make_law<FrictionalSpring>(kGravel);
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    const auto other = Wall<Dim>::half_space("other", -9 * along<Dim>(), along<Dim>());
    auto sim = make_sim<Dim>({ball<Dim>(1 * up<Dim>()), ball<Dim>(3 * up<Dim>()),
                              ball<Dim>(-8.01 * along<Dim>() + 20 * up<Dim>())},
                             law, {floor, other}, 2, -10 * up<Dim>());
    while (sim.time() < 1) sim.step();
    const double weight = 10 * sim.masses()[0];
    CHECK(relative_error(-sim.walls()[0].force[Dim - 1], 2 * weight) < 0.01);
    const Vec<Dim> beside = sim.walls()[1].force;
    const double elastic = energy_ledger(sim).elastic;

    sim.exchange({1}, make_grains<Dim, decltype(sim)::needs>({}));

    // The floor still pushes twice the weight.
    CHECK(relative_error(sim.grains().force(Dim - 1, 0), weight) < 0.01);
    CHECK(sim.walls()[1].force == beside);
    CHECK(energy_ledger(sim).elastic < 0.9 * elastic);
    const double balance = energy_ledger(sim).balance();
    sim.exchange({0}, make_grains<Dim, decltype(sim)::needs>({}));
    CHECK(sim.walls()[0].force.isZero(0));
    CHECK(energy_ledger(sim).elastic == 0);
    CHECK(relative_error(energy_ledger(sim).balance(), balance) < 1e-12);
    CHECK(sim.ids() == std::vector<int>{2});
  }

  TEST_CASE_TEMPLATE("a piston falls when the grain leaves that carried it", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    auto piston = Wall<Dim>::half_space("piston", 2 * up<Dim>(), -up<Dim>());
    piston.motion = Piston<Dim>{.mass = 10, .load = -100 * up<Dim>()};
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    auto sim = make_sim<Dim>({ball<Dim>(1 * up<Dim>())}, make_law<LinearSpring>(kGravel),
                             {floor, piston}, 2);
    while (sim.time() < 2) sim.step();
    const double height = sim.walls()[1].point[Dim - 1];
    CHECK(relative_error(sim.walls()[1].force[Dim - 1], 100) < 1e-3);

    sim.exchange({0}, make_grains<Dim, decltype(sim)::needs>({}));

    CHECK(sim.grains().size() == 0);
    const double start = sim.time();
    while (sim.time() < start + 0.2) sim.step();
    const double fallen = height - sim.walls()[1].point[Dim - 1];
    CHECK(relative_error(fallen, 0.5 * 10 * std::pow(sim.time() - start, 2)) < 1e-2);
  }

  TEST_CASE_TEMPLATE("a simulation may be empty, at first and in between", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    using Law = FrictionalSpring;
    const auto law = make_law<Law>(kGravel);
    const auto none = make_grains<Dim, Law::needs>({});
    auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    floor.motion = Shake<Dim>{.amplitude = 0.1 * up<Dim>(), .frequency = 1};
    Simulation<Dim, Law, VelocityVerlet, CellGrid<Dim>> sim(
        none, LawTable<Law>(law), {floor}, {.gravity = -10 * up<Dim>(), .time_step = 4e-4});
    for (int round = 0; round < 3; ++round) {
      const double balance = energy_ledger(sim).balance();
      sim.step(50);
      CHECK(energy_ledger(sim).balance() == balance);
      CHECK(contact_statistics(sim).coordination == 0);
      sim.exchange({}, make_grains<Dim, Law::needs>({ball<Dim>(1.2 * up<Dim>())}));
      sim.step(400);
      CHECK(contact_statistics(sim).wall_contacts <= 1);
      const double fallen = 10 * sim.masses()[0];
      CHECK(std::abs(energy_ledger(sim).balance() - balance) < 0.01 * fallen);
      CHECK(sim.ids() == std::vector<int>{round});
      sim.exchange({0}, none);
      CHECK(sim.near_pairs().empty());
    }
  }

  TEST_CASE("a newcomer of another material brings the laws of its own") {
    const auto soft = make_law<LinearSpring>({.stiffness = 1e5, .restitution = 0.2});
    const auto hard = make_law<LinearSpring>({.stiffness = 1e5, .restitution = 0.9});
    LawTable<LinearSpring> laws(soft, 2);
    laws.set(0, 1, hard);
    std::vector<Grain<2>> pair{ball<2>({0, 0}), ball<2>({2.5, 0})};
    pair[1].material = 1;
    pair[1].velocity = {-1, 0};
    Sim<2, LinearSpring> sim(make_grains<2, Needs{}>({pair[0]}), laws, {}, {.time_step = 1e-4});
    sim.exchange({}, make_grains<2, Needs{}>({pair[1]}));
    sim.step(10000);
    const Vec<2> apart = sim.grains().velocity.col(1) - sim.grains().velocity.col(0);
    CHECK(relative_error(apart.x(), 0.9) < 1e-2);
    // The other way round: the newcomer is of material 0, and all others leave.
    sim.exchange({0, 1}, make_grains<2, Needs{}>({pair[0]}));
    CHECK(sim.grains().material == std::vector<std::uint8_t>{0});
  }

  TEST_CASE_TEMPLATE("pinned newcomers stay, and are not listed with each other", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    using Law = LinearSpring;
    auto sim =
        make_sim<Dim>({ball<Dim>(4 * up<Dim>())}, make_law<Law>(kGravel), {}, 2, -10 * up<Dim>());
    std::vector<Grain<Dim>> base{ball<Dim>(-0.5 * along<Dim>()), ball<Dim>(0.5 * along<Dim>())};
    for (auto& g : base) g.pinned = true;
    sim.exchange({}, make_grains<Dim, Law::needs>(base));
    while (sim.time() < 1) sim.step();
    CHECK(sim.grains().position.col(1) == base[0].position);
    for (const Pair& pair : sim.near_pairs()) CHECK(pair.i == 0);
    CHECK(sim.flow().dashpot > 0);
  }

  TEST_CASE("messages name the ids, which no other grain gets") {
    const auto law = make_law<LinearSpring>(kGravel);
    const auto failure = [&](const std::vector<Grain<2>>& newcomers) -> std::string {
      Sim<2, LinearSpring> sim(
          make_grains<2, Needs{}>({ball<2>({50, 0}), ball<2>({60, 0}), ball<2>({0, 0})}),
          LawTable<LinearSpring>(law), {Wall<2>::segment("fence", {20, -5}, {20, 5})},
          {.time_step = 1e-3});
      sim.exchange({0}, make_grains<2, Needs{}>({}));
      sim.exchange({0}, make_grains<2, Needs{}>(newcomers));
      try {
        sim.step(50);
      } catch (const SimulationError& error) {
        return error.what();
      }
      return "none";
    };
    CHECK(failure({ball<2>({0.5, 0})}).find("grain 2 overlaps grain 3 by") != std::string::npos);
    auto fast = ball<2>({10, 0});
    fast.velocity = {6000, 0};
    CHECK(failure({ball<2>({70, 0}), fast}).find("grain 4 passed through wall fence near (") !=
          std::string::npos);
    CHECK(failure({ball<2>({70, 0}), ball<2>({80, 0})}) == "none");
  }

  TEST_CASE("what cannot be exchanged is refused, and nothing has changed") {
    const auto law = make_law<LinearSpring>({.stiffness = 1e5});
    const auto two = make_grains<2, Needs{}>({ball<2>({0, 0}), ball<2>({3, 0})});
    Sim<2, LinearSpring> sim(two, LawTable<LinearSpring>(law), {}, {.time_step = 1e-3});
    const auto none = make_grains<2, Needs{}>({});
    for (const auto& leavers : {std::vector{2}, {-1}, {1, 0}, {0, 0}}) {
      CHECK(contract_error_of([&] { sim.exchange(leavers, none); }).find("is no grain") !=
            std::string::npos);
    }
    const auto dust = make_grains<2, Needs{}>({ball<2>({6, 0}, 0.01)});
    CHECK(contract_error_of([&] { sim.exchange({}, dust); }).find("time step 0.001 s") !=
          std::string::npos);
    CHECK(sim.grains().size() == 2);

    Sim<2, LinearSpring, AllPairs<2>, ForestRuth> smooth(two, LawTable<LinearSpring>(law), {},
                                                         {.time_step = 1e-3});
    CHECK(contract_error_of([&] { smooth.exchange({0}, none); }).find("conservative") !=
          std::string::npos);
    auto foreign = ball<2>({6, 0});
    foreign.material = 2;
    Sim<2, LinearSpring> mixed(two, LawTable<LinearSpring>(law, 2), {}, {.time_step = 1e-3});
    CHECK(contract_error_of([&] {
            mixed.exchange({}, make_grains<2, Needs{}>({foreign}));
          }).find("material 2") != std::string::npos);
  }
}
