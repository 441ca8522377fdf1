// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/simulation.hpp>

#include <lagrain/all_pairs.hpp>
#include <lagrain/audit.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/observe.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// A cloud that falls in on itself, without walls or gravity.
template <int Dim>
std::vector<Grain<Dim>> imploding(int count, std::uint64_t seed, bool spin) {
  Random random(seed);
  auto packed = lattice<Dim>({.count = count, .speed = 0.2, .spin = spin ? 1.0 : 0.0}, random);
  const Vec<Dim> middle = 0.5 * (packed.low + packed.high);
  for (auto& g : packed.grains) g.velocity -= 0.5 * (g.position - middle);
  return packed.grains;
}

/// Largest departure of the energy of an elastic gas from its start, over the start's.
template <int Dim, class Law>
double gas_drift(std::uint64_t seed, double refinement) {
  Random random(seed);
  const auto packed = lattice<Dim>({.count = 200, .spacing = 1.1, .speed = 1}, random);
  auto sim = make_sim<Dim, Law, CellGrid<Dim>>(packed.grains, make_law<Law>({.stiffness = 1e5}),
                                               box<Dim>(packed.low, packed.high), refinement);
  const double start = energy_ledger(sim).balance();
  double sum = 0;
  const int steps = static_cast<int>(1000 * refinement);
  for (int k = 0; k < steps; ++k) {
    sim.step();
    if (k % 10 == 0) sum += std::pow(energy_ledger(sim).balance() / start - 1, 2);
  }
  return std::sqrt(sum / (steps / 10));
}

template <int Dim>
Grain<Dim> unit(double place, double speed = 0) {
  Grain<Dim> g;
  g.radius = g.mass = 1;
  g.position = place * oblique<Dim>();
  g.velocity = speed * oblique<Dim>();
  return g;
}

template <class S>
std::string failure_of(S& sim, int steps, int at_once = 1) {
  try {
    for (int k = 0; k < steps; k += at_once) sim.step(at_once);
  } catch (const SimulationError& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_SUITE("simulation") {
  TEST_CASE_TEMPLATE("collisions of many grains conserve momentum and angular momentum to rounding",
                     C, Case<2, LinearSpring>, Case<3, Hertz>, Case<2, FrictionalSpring>,
                     Case<3, FrictionalSpring>, Case<3, FrictionalHertz>, Case<2, ViscousSpring>,
                     Case<3, ViscousSpring>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(
        {.stiffness = 1e5, .restitution = 0.5, .friction = 0.5, .tangential_damping_ratio = 0.3});
    auto sim = make_sim<Dim, typename C::Law, CellGrid<Dim>>(
        imploding<Dim>(100, 7, C::Law::needs.spin), law, {}, 1);
    const Vec<Dim> p = momentum(sim.grains());
    const SpinVec<Dim> l = angular_momentum(sim.grains());
    const double kinetic = kinetic_energy(sim.grains());
    // What a rounding is measured against: all momenta, without their signs.
    const double scale = sim.grains().mass.sum();
    const double reach = sim.grains().position.colwise().norm().maxCoeff();
    constexpr int kSteps = 3000;

    for (int k = 0; k < kSteps; ++k) sim.step();

    CHECK(kinetic_energy(sim.grains()) < 0.7 * kinetic);  // they did collide
    // Roundings of 10^-16 each, all of one sign at worst.
    CHECK((momentum(sim.grains()) - p).norm() < 1e-16 * kSteps * scale);
    CHECK((angular_momentum(sim.grains()) - l).norm() < 1e-16 * kSteps * scale * reach);
  }

  TEST_CASE_TEMPLATE("with damping or friction the energy never grows", C, Case<2, LinearSpring>,
                     Case<3, Hertz>, Case<2, FrictionalSpring>, Case<3, FrictionalSpring>,
                     Case<2, ViscousSpring>, Case<3, ViscousHertz>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(
        {.stiffness = 1e5, .restitution = 0.7, .friction = 0.5, .tangential_damping_ratio = 1});
    Random random(8);
    const auto packed = lattice<Dim>({.count = 80, .speed = 1, .spin = 1}, random);
    auto sim = make_sim<Dim, typename C::Law, CellGrid<Dim>>(
        packed.grains, law, box<Dim>(packed.low, packed.high), 4, -2 * up<Dim>());
    const auto mechanical = [&] {
      const Ledger l = energy_ledger(sim);
      return l.kinetic + l.elastic;
    };
    const auto gravity = [&] { return energy_ledger(sim).gravity; };
    const double ground = gravity();
    const double start = mechanical();
    double lowest = start;
    double worst = 0;
    for (int k = 0; k < 6000; ++k) {
      sim.step();
      if (k % 20 != 0) continue;
      const double now = mechanical() + gravity() - ground;
      worst = std::max(worst, now - lowest);
      lowest = std::min(lowest, now);
    }

    CHECK(lowest < start);
    // A step inside a contact errs by (omega0 dt)^2 / 8 of the energy in it, 10^-3 here; contacts
    // hold a small part of the energy.
    CHECK(worst < 1e-3 * start);
  }

  TEST_CASE_TEMPLATE(
      "the energy of an elastic gas wanders, and four times less when the step halves", C,
      Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, Hertz>, Case<3, Hertz>) {
    double coarse = 0;
    double fine = 0;
    for (int seed = 0; seed < cases(2, 20); ++seed) {
      coarse += gas_drift<C::Dim, typename C::Law>(static_cast<std::uint64_t>(seed), 1);
      fine += gas_drift<C::Dim, typename C::Law>(static_cast<std::uint64_t>(seed), 4);
    }
    coarse /= cases(2, 20);
    fine /= cases(2, 20);

    // A contact holds the energy to (omega0 dt)^2 / 8 = 1.2 % of its own while it lasts, and only a
    // few are open at a time.
    CHECK(coarse < 0.012);
    CHECK(observed_order(coarse, fine, 4) > 1.7);
  }

  TEST_CASE_TEMPLATE("in a column at rest the contact m from the top carries m weights", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, Hertz>, Case<3, Hertz>,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    constexpr int kHeight = 8;
    std::vector<Grain<Dim>> list;
    for (int k = 0; k < kHeight; ++k) {
      list.push_back(unit<Dim>(0));
      list.back().position = (2 * k + 1) * up<Dim>();
    }
    const auto law = make_law<typename C::Law>({.stiffness = 1e4, .restitution = 0.2});
    auto sim = make_sim<Dim>(list, law, {Wall<Dim>::half_space("f", Vec<Dim>::Zero(), up<Dim>())},
                             1, -10 * up<Dim>());
    // The slowest mode is 2 sin(pi / 34) = 0.18 of omega0, its ratio 0.18 of zeta = 0.5: it decays
    // as exp(-0.017 omega0 t), omega0 = 100/s (Hertz: about 80): to 10^-15 in 20 s.
    while (sim.time() < 25) sim.step();

    std::vector<double> force(kHeight);
    std::vector<double> overlap(kHeight);
    sim.for_each_contact([&](Pair pair, const Touch<Dim>& touch, const auto& response, auto&&) {
      CHECK(pair.j == pair.i + 1);
      const auto top = static_cast<std::size_t>(kHeight - pair.j);
      force.at(top) = -response.force.dot(up<Dim>());
      overlap.at(top) = touch.overlap;
    });
    for (std::size_t m = 1; m < kHeight; ++m) {
      CAPTURE(m);
      const double weight = 10.0 * static_cast<double>(m);
      CHECK(relative_error(force[m], weight) < 1e-8);
      const double closed_form = [&] {
        if constexpr (std::is_same_v<typename C::Law, Hertz>) {
          return std::pow(weight / law.coefficient(0.5), 2.0 / 3);
        } else {
          return weight / 1e4;
        }
      }();
      CHECK(relative_error(overlap[m], closed_form) < 1e-8);
    }
    CHECK(relative_error(-sim.walls()[0].force.dot(up<Dim>()), 10.0 * kHeight) < 1e-8);
  }

  TEST_CASE_TEMPLATE("a pinned grain stays, and measures what presses on it", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    Grain<Dim> pin = unit<Dim>(0);
    pin.pinned = true;
    Grain<Dim> rider = unit<Dim>(0);
    rider.position = 2 * up<Dim>();
    const auto law = make_law<FrictionalSpring>({.stiffness = 1e4, .restitution = 0.2});
    auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{pin, rider}, law, {}, 1, -10 * up<Dim>());

    while (sim.time() < 2) sim.step();

    CHECK(sim.grains().position.col(0).isZero(0));
    CHECK((sim.grains().force.col(0) + 20 * up<Dim>()).norm() < 1e-8);  // its own weight included
  }

  TEST_CASE_TEMPLATE("coincident centres part instead of dividing by zero", C,
                     Case<2, LinearSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    auto grains = make_grains<Dim, C::Law::needs>({unit<Dim>(0), unit<Dim>(0)});
    Setting<Dim> setting;
    setting.time_step = 1e-4;
    setting.largest_overlap = 10;
    Sim<Dim, typename C::Law> sim(grains, LawTable(make_law<typename C::Law>({.stiffness = 1e4})),
                                  {}, setting);

    for (int k = 0; k < 1000; ++k) sim.step();

    CHECK((sim.grains().position.col(0) - sim.grains().position.col(1)).norm() > 2);
  }

  TEST_CASE_TEMPLATE("a run stops when an overlap passes the limit, and says whose and when", C,
                     Case<2, LinearSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>({.stiffness = 1e4});
    auto pair = make_sim<Dim>(
        std::vector<Grain<Dim>>{unit<Dim>(-50), unit<Dim>(0), unit<Dim>(3, -100)}, law, {}, 1);
    auto wall =
        make_sim<Dim>(std::vector<Grain<Dim>>{unit<Dim>(50), unit<Dim>(2, -100)}, law,
                      {Wall<Dim>::half_space("anvil", Vec<Dim>::Zero(), oblique<Dim>())}, 1);

    // 1 m at 100 m/s, and 0.3 of a radius more: about 0.013 s.
    auto faster = pair;
    const std::string of_pair = failure_of(pair, 1000);
    const std::string of_wall = failure_of(wall, 1000);

    CHECK(failure_of(faster, 1000, 1000) == of_pair);
    CHECK(of_pair.find("grain 1 overlaps grain 2") != std::string::npos);
    CHECK(of_pair.find("t = 0.01") != std::string::npos);
    CHECK(of_pair.find("largest_overlap is 0.3") != std::string::npos);
    CHECK(of_wall.find("grain 1 overlaps wall anvil") != std::string::npos);
    CHECK(of_wall.find("t = 0.01") != std::string::npos);
    // Nothing is lost, so what is left of the speed and the spring make the impact's speed, but for
    // what a step so large errs by.
    for (const std::string& failure : {of_pair, of_wall}) {
      const std::string said = "with the energy of an impact at ";
      REQUIRE(failure.find(said) != std::string::npos);
      CHECK(relative_error(std::stod(failure.substr(failure.find(said) + said.size())), 100) <
            0.05);
    }
  }

  TEST_CASE_TEMPLATE("a run stops when a place is not a number, and says whose and when", C,
                     Case<2, LinearSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    Grain<Dim> wild = unit<Dim>(10);
    wild.velocity[0] = std::numeric_limits<double>::max();
    auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{unit<Dim>(0), wild},
                             make_law<typename C::Law>({.stiffness = 1e4}), {}, 1);

    const std::string failure = failure_of(sim, 100000);

    CHECK(failure.find("grain 1") != std::string::npos);
    CHECK(failure.find("not a number") != std::string::npos);
    CHECK(failure.find("t = ") != std::string::npos);
  }

  TEST_CASE_TEMPLATE("steps taken together are those taken one by one", C,
                     Case<2, FrictionalSpring>, Case<3, ViscousHertz>) {
    constexpr int Dim = C::Dim;
    Random random(7);
    const auto packed = lattice<Dim>({.count = 300, .speed = 1, .spin = 1}, random);
    auto walls = box<Dim>(packed.low, packed.high);
    walls[0].motion = Shake<Dim>{0.1 * along<Dim>(), 5};
    walls[1].motion = Piston<Dim>{100, -50 * along<Dim>()};
    const auto law = make_law<typename C::Law>(kGravel);
    auto single =
        make_sim<Dim, typename C::Law, CellGrid<Dim>>(packed.grains, law, walls, 4, -up<Dim>());
    auto together = single;

    const Vec<Dim> held = single.walls()[1].point;
    for (const int count : {1, 700, 2, 297, 0}) {
      for (int k = 0; k < count; ++k) single.step();
      together.step(count);

      CHECK(together.steps() == single.steps());
      CHECK(same_bits(together, single));
      CHECK(together.near_pairs() == single.near_pairs());
      CHECK(together.near_list_holds() == single.near_list_holds());
      CHECK(together.flow().wall_work == single.flow().wall_work);
      CHECK(together.walls()[1].point == single.walls()[1].point);
    }
    CHECK(single.flow().dashpot > 0);
    CHECK(single.walls()[1].point != held);
  }

  TEST_CASE_TEMPLATE("steps of several evaluations taken together are those taken one by one", C,
                     Case<2, LinearSpring>, Case<3, Hertz>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>({.stiffness = 1e5});
    auto single = make_sim<Dim, typename C::Law, CellGrid<Dim>, ForestRuth>(
        imploding<Dim>(100, 2, false), law, {}, 1);
    auto together = single;

    for (int k = 0; k < 500; ++k) single.step();
    together.step(500);

    CHECK(same_bits(together, single));
    CHECK(energy_ledger(single).elastic > 0);  // something touches
  }

  TEST_CASE_TEMPLATE("neither threads nor instruction sets change a bit", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, Case<2, LinearSpring>,
                     Case<3, ViscousHertz>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(kGravel);
    // Several blocks of slots, with contacts across them.
    const auto scene = settling_bed<Dim>(6000, 3);
    const int steps = cases(300, 3000);
    auto reference = start<Dim>(scene, law, CellGrid<Dim>{}, 1, InstructionSet::scalar);
    for (int k = 0; k < steps; ++k) reference.step();
    CHECK(reference.flow().dashpot > 0);

    for (const int threads : {1, 2, 3}) {
      for (const InstructionSet set : instruction_sets()) {
        CAPTURE(threads);
        CAPTURE(static_cast<int>(set));
        auto sim = start<Dim>(scene, law, CellGrid<Dim>{}, threads, set);
        sim.step(steps);

        CHECK(same_bits(sim, reference));
        CHECK(sim.flow().dashpot == reference.flow().dashpot);
        CHECK(sim.flow().friction == reference.flow().friction);
        for (std::size_t w = 0; w < sim.walls().size(); ++w) {
          CHECK(sim.walls()[w].force == reference.walls()[w].force);
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("grains keep their numbers when their slots are sorted anew", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    // A gas of many sizes and two materials that mixes while the slots are sorted.
    Random random(5);
    auto packed = lattice<Dim>({.count = 1500, .spacing = 1.5, .speed = 3}, random);
    for (std::size_t i = 0; i < packed.grains.size(); ++i) {
      packed.grains[i].material = static_cast<int>(i % 2);
    }
    const LawTable<FrictionalSpring> laws(make_law<FrictionalSpring>(kGravel), 2);
    const auto build = [&]<class N>(N neighbourhood, int threads) {
      auto grains = make_grains<Dim, FrictionalSpring::needs>(packed.grains);
      Setting<Dim> setting;
      const auto walls = box<Dim>(packed.low, packed.high);
      setting.time_step = time_scales(grains, laws, walls).safe_step;
      setting.threads = threads;
      return Sim<Dim, FrictionalSpring, N>(std::move(grains), laws, walls, setting,
                                           std::move(neighbourhood));
    };
    auto sim = build(CellGrid<Dim>{}, 1);
    auto twin = build(CellGrid<Dim>{}, 2);
    ContactAudit<Dim> audit;

    for (int k = 0; k < cases(10500, 20500); ++k) {
      sim.step();
      if (k % 500 != 0) continue;
      audit.check(sim.grains().position, sim.grains().radius, sim.near_pairs());
      twin.step(sim.steps() - twin.steps());  // also across the step at which slots are sorted
    }
    twin.step(sim.steps() - twin.steps());

    CHECK(audit.contacts() > 0);
    CHECK(audit.missed() == 0);
    CHECK(same_bits(sim, twin));
    // Contacts are reported by number, each once, and found again by brute force.
    std::vector<Pair> reported;
    sim.for_each_contact([&](Pair pair, auto&&...) {
      reported.push_back({std::min(pair.i, pair.j), std::max(pair.i, pair.j)});
    });
    std::sort(reported.begin(), reported.end());
    std::vector<Pair> expected;
    Eigen::VectorXd margin = Eigen::VectorXd::Zero(sim.grains().size());
    AllPairs<Dim>{}.near_pairs(sim.grains().position, sim.grains().radius, margin, expected);
    CHECK(reported == expected);
  }

  TEST_CASE_TEMPLATE("a material that the table of laws lacks is refused", C, Case<2, LinearSpring>,
                     Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    const LawTable<LinearSpring> laws(make_law<LinearSpring>({}), 2);
    Setting<Dim> setting;
    setting.time_step = 1e-5;
    Grain<Dim> odd = unit<Dim>(0);
    odd.material = 2;
    auto wall = Wall<Dim>::half_space("floor", -5 * up<Dim>(), up<Dim>());
    wall.material = 2;
    const auto build = [&](const Grain<Dim>& g, const LawTable<LinearSpring>& table,
                           const std::vector<Wall<Dim>>& walls) {
      return Sim<Dim, LinearSpring>(make_grains<Dim, LinearSpring::needs>({g}), table, walls,
                                    setting);
    };

    CHECK_NOTHROW(build(unit<Dim>(0), laws, {}));
    CHECK_THROWS_WITH_AS(build(odd, laws, {}), doctest::Contains("grain 0 is of material 2"),
                         ContractError);
    CHECK_THROWS_WITH_AS(build(unit<Dim>(0), laws, {wall}), doctest::Contains("wall floor"),
                         ContractError);
    CHECK_THROWS_AS(build(unit<Dim>(0), {}, {}), ContractError);
    // A table of one law holds for all materials.
    CHECK_NOTHROW(build(odd, LawTable(laws.between(0, 0)), {wall}));
  }
}
