// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/pinned_grains.hpp>

#include <lagrain/audit.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/observe.hpp>

#include <support/cases.hpp>
#include <support/scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr double kStiff = 1e5;  // [N/m]

template <int Dim>
Grain<Dim> ball(const Vec<Dim>& place, bool pinned = false, double radius = 1) {
  Grain<Dim> g;
  g.radius = radius;
  g.mass = grain_volume<Dim>(radius) / grain_volume<Dim>(1);
  g.position = place;
  g.pinned = pinned;
  return g;
}

LinearSpring soft_landing() {
  return make_law<LinearSpring>({.stiffness = kStiff, .restitution = 0.1});
}

template <int Dim>
Vec<Dim> drum_axis() {
  if constexpr (Dim == 2) {
    return Vec<2>::Zero();
  } else {
    return {0, 1, 0};
  }
}

template <class S>
void run_for(S& sim, double duration) {
  const double end = sim.time() + duration;
  while (sim.time() < end) sim.step();
}

/// Pinned grains that overlap by half, side by side, and grains that fall on them.
template <int Dim>
std::vector<Grain<Dim>> rough_base(int side, int loose, Random& random) {
  std::vector<Grain<Dim>> list;
  const auto spot = [&](int k) {
    Vec<Dim> x = Vec<Dim>::Zero();
    for (int d = 0, rest = k; d < Dim - 1; ++d, rest /= side) x[d] = rest % side;
    return x;
  };
  const int base = Dim == 2 ? side : side * side;
  for (int k = 0; k < base; ++k) {
    list.push_back(ball<Dim>(spot(k) + 0.2 * random.uniform() * up<Dim>(), true));
  }
  for (int k = 0; k < loose; ++k) {
    auto g = ball<Dim>(Vec<Dim>::Zero());
    const int row = side / 3;
    int rest = k;
    for (int d = 0; d < Dim - 1; ++d, rest /= row) g.position[d] = 3.0 * (rest % row) + 1;
    g.position += (2.3 + 2.1 * rest) * up<Dim>();
    for (double& v : g.velocity) v = random.normal();
    list.push_back(g);
  }
  // Numbers say nothing about who is pinned.
  for (std::size_t k = list.size(); k > 1; --k) {
    std::swap(list[k - 1], list[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  }
  return list;
}

template <class S>
int pinned_pairs_listed(const S& sim) {
  const auto& g = sim.grains();
  int count = 0;
  for (const Pair& pair : sim.near_pairs()) {
    count += g.inverse_mass[pair.i] == 0 && g.inverse_mass[pair.j] == 0;
  }
  return count;
}

}  // namespace

TEST_SUITE("pinned grains") {
  TEST_CASE("pairs of pinned grains are dropped from a list, and no other") {
    const std::vector<double> inverse_mass{0, 1, 0, 0, 2};
    const PinnedGrains pinned(5, [&](int i) { return inverse_mass[static_cast<std::size_t>(i)]; });
    std::vector<Pair> pairs{{0, 1}, {0, 2}, {0, 3}, {1, 4}, {2, 3}, {3, 4}};

    ContactRules(pinned).drop_from(pairs);

    CHECK(pairs == std::vector<Pair>{{0, 1}, {1, 4}, {3, 4}});
    CHECK((pinned[0] && !pinned[1] && pinned[3] && !pinned[4]));
    CHECK(!ContactRules(pinned).may_touch({2, 3}));
    CHECK(ContactRules(pinned).may_touch({3, 4}));
    const PinnedGrains none, free(2, [](int) { return 1.0; });
    std::vector<Pair> all{{0, 1}};
    ContactRules(none).drop_from(all);
    ContactRules(free).drop_from(all);
    CHECK(all.size() == 1);
    CHECK((!none[0] && !free[1]));
  }

  TEST_CASE_TEMPLATE("pinned grains are listed with no other pinned one, and touch none", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(1);
    const auto list = rough_base<Dim>(12, 12, random);
    auto sim =
        make_sim<Dim, LinearSpring, CellGrid<Dim>>(list, soft_landing(), {}, 1, -10 * up<Dim>());
    const auto& inverse_mass = sim.grains().inverse_mass;
    const PinnedGrains pinned(static_cast<int>(list.size()),
                              [&](int i) { return double(inverse_mass[i]); });
    ContactAudit<Dim> audit;
    std::int64_t touched = 0;
    CHECK(energy_ledger(sim).elastic == 0);
    CHECK(contact_statistics(sim).contacts == 0);
    for (int k = 0; k < 1500; ++k) {
      sim.step();
      CHECK(pinned_pairs_listed(sim) == 0);
      sim.for_each_contact([&](Pair pair, auto&&...) {
        ++touched;
        CHECK(ContactRules(pinned).may_touch({std::min(pair.i, pair.j), std::max(pair.i, pair.j)}));
      });
      if (sim.near_list_holds()) {
        audit.check(sim.grains().position, sim.radii(), sim.near_pairs(), pinned);
      }
    }
    CHECK(touched > 100);
    CHECK(sim.refreshes() > 1);
    CHECK(sim.amended() > 0);
    CHECK(audit.missed() == 0);
    CHECK(relative_error(static_cast<double>(audit.contacts()), static_cast<double>(touched)) <
          0.05);
    for (int i = 0; i < static_cast<int>(list.size()); ++i) {
      if (!list[static_cast<std::size_t>(i)].pinned) continue;
      CHECK(sim.grains().position.col(i) == list[static_cast<std::size_t>(i)].position);
    }
  }

  TEST_CASE_TEMPLATE("in a drifting cloud pinned grains are listed anew, and still not together", S,
                     Space<2>, Space<3>) {
    // Most fly: in the frame that moves with them the pinned ones leave their margins.
    constexpr int Dim = S::Dim;
    std::vector<Grain<Dim>> list;
    for (int k = 0; k < 600; ++k) {
      list.push_back(ball<Dim>(3.0 * k * along<Dim>() + 40 * up<Dim>()));
      list.back().velocity = 30 * along<Dim>();
      if (k % 60 == 0) list.push_back(ball<Dim>(0.5 * k * along<Dim>(), true));
      if (k % 60 == 0) list.push_back(ball<Dim>((0.5 * k + 0.7) * along<Dim>(), true));
    }
    auto sim = make_sim<Dim, LinearSpring, CellGrid<Dim>>(list, soft_landing(), {}, 1);
    const std::int64_t before = sim.amended();
    for (int k = 0; k < 600; ++k) {
      sim.step();
      CHECK(pinned_pairs_listed(sim) == 0);
    }
    CHECK(sim.amended() > before);
    CHECK(energy_ledger(sim).elastic == 0);
  }

  TEST_CASE_TEMPLATE("a pinned grain sunk in walls that no force moves exerts nothing", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    auto rising = Wall<Dim>::half_space("rising", -0.4 * up<Dim>(), up<Dim>());
    rising.motion = Steady<Dim>{0.1 * up<Dim>()};
    auto shaken = flat_piece<Dim>("shaken", -3 * along<Dim>(), 3 * along<Dim>());
    shaken.motion = Shake<Dim>{0.3 * up<Dim>(), 3};
    const auto drum = Wall<Dim>::cylinder("drum", -18.5 * up<Dim>(), drum_axis<Dim>(), 19.5);
    for (const auto& wall : {floor, rising, shaken, drum}) {
      CAPTURE(wall.name);
      const double elsewhere = wall.name == "drum" ? -18.5 : 9;
      const std::vector<Grain<Dim>> list{ball<Dim>(0.3 * up<Dim>(), true),
                                         ball<Dim>(elsewhere * up<Dim>())};
      auto sim = make_sim<Dim>(list, soft_landing(), {wall}, 1);
      run_for(sim, 0.5);
      CHECK(sim.walls()[0].force.isZero(0));
      CHECK(sim.grains().force.col(0).isZero(0));
      CHECK(contact_statistics(sim).wall_contacts == 0);
      CHECK(energy_ledger(sim).elastic == 0);
      CHECK(sim.flow().wall_work == 0);
    }
  }

  TEST_CASE_TEMPLATE("a piston is stopped by a pinned grain", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto piston = Wall<Dim>::half_space("piston", 1.05 * up<Dim>(), -up<Dim>());
    piston.motion = Piston<Dim>{2, -30 * up<Dim>()};
    // The grain is sunk in a floor: that is nothing; the piston comes to rest on it.
    const auto floor = Wall<Dim>::half_space("floor", -0.2 * up<Dim>(), up<Dim>());
    for (const bool with_loose_one : {true, false}) {
      std::vector<Grain<Dim>> list{ball<Dim>(Vec<Dim>::Zero(), true)};
      if (with_loose_one)
        list.push_back(ball<Dim>(20 * along<Dim>() - 0.1 * up<Dim>(), false, 0.1));
      auto sim = make_sim<Dim>(list, soft_landing(), {floor, piston}, 1);
      run_for(sim, 3);
      CHECK((sim.walls()[1].force - 30 * up<Dim>()).norm() < 1e-8);
      CHECK(sim.walls()[0].force.isZero(0));
      CHECK(relative_error(1 - sim.walls()[1].point.dot(up<Dim>()), 30 / kStiff) < 1e-8);
      CHECK(contact_statistics(sim).wall_contacts == 1);
      CHECK((sim.grains().force.col(0) + 30 * up<Dim>()).norm() < 1e-8);
    }
  }

  TEST_CASE_TEMPLATE("a loose grain feels pinned ones and the wall they are sunk in alike", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    const std::vector<Grain<Dim>> list{ball<Dim>(-1.5 * along<Dim>() - 0.5 * up<Dim>(), true),
                                       ball<Dim>(-0.8 * along<Dim>() - 0.5 * up<Dim>(), true),
                                       ball<Dim>(9 * along<Dim>() + up<Dim>()),
                                       ball<Dim>(-1.15 * along<Dim>() + 1.4 * up<Dim>())};
    auto sim = make_sim<Dim>(list, soft_landing(), {floor}, 1, -10 * up<Dim>());
    run_for(sim, 2);

    CHECK(relative_error(1 - sim.grains().position.col(2).dot(up<Dim>()), 10 / kStiff) < 1e-9);
    // Between the two pinned ones, 0.35 to each side.
    const double apart = 0.35;
    const double height = sim.grains().position.col(3).dot(up<Dim>()) + 0.5;
    const double load = 10 / (2 * height / std::hypot(height, apart));
    CHECK(relative_error(2 - std::hypot(height, apart), load / kStiff) < 1e-8);
    CHECK((sim.walls()[0].force + 10 * up<Dim>()).norm() < 1e-8);
    CHECK(contact_statistics(sim).contacts == 2);
  }

  // ---- The time step
  // -----------------------------------------------------------------------------

  TEST_CASE("fine pinned grains do not set the step: a linear spring") {
    // Beads of 1 mm, glued, and balls of 10 mm: the shortest collision is that of two balls.
    const auto grain = [](double radius, bool pinned, int material = 0) {
      Grain<3> g;
      g.radius = radius;
      g.mass = 2500 * grain_volume<3>(radius);
      g.pinned = pinned;
      g.material = material;
      return g;
    };
    const LawTable<LinearSpring> laws(make_law<LinearSpring>({.stiffness = 1e4}));
    const auto contact = [&](const std::vector<Grain<3>>& list,
                             const std::vector<Wall<3>>& walls = {}) {
      return time_scales(make_grains<3, LinearSpring::needs>(list), laws, walls).contact;
    };
    const double m = 2500 * grain_volume<3>(0.01);
    const double full = std::numbers::pi * std::sqrt(m / 1e4);

    CHECK(relative_error(contact({grain(1e-3, true), grain(1e-3, true), grain(0.01, false),
                                  grain(0.01, false)}),
                         full / std::sqrt(2)) < 1e-14);
    CHECK(relative_error(full / std::sqrt(2), 0.00227326) < 1e-5);
    // Two balls could meet; the law of the table does not ask whether there are two.
    CHECK(relative_error(contact({grain(1e-3, true), grain(0.01, false)}), full / std::sqrt(2)) <
          1e-14);
    CHECK(std::isinf(contact({grain(1e-3, true), grain(0.02, true)})));
    const auto floor = Wall<3>::half_space("f", {0, 0, 0}, {0, 0, 1});
    CHECK(std::isinf(contact({grain(1e-3, true)}, {floor})));
    auto piston = floor;
    piston.motion = Piston<3>{0.5 * m, {0, 0, -1}};
    CHECK(relative_error(contact({grain(1e-3, true)}, {piston}), full / std::sqrt(2)) < 1e-14);
    CHECK(relative_error(contact({grain(0.01, false)}, {piston}), full / std::sqrt(3)) < 1e-14);
    CHECK(std::isinf(contact({})));
  }

  TEST_CASE("fine pinned grains do not set the step: Hertz") {
    const Hertz law = make_law<Hertz>({.stiffness = 1e9, .impact_speed = 2});
    const LawTable<Hertz> laws(law);
    const auto grain = [](double radius, bool pinned) {
      Grain<3> g;
      g.radius = radius;
      g.mass = 2500 * grain_volume<3>(radius);
      g.pinned = pinned;
      return g;
    };
    const double m = 2500 * grain_volume<3>(0.01);
    const auto contact = [&](const std::vector<Grain<3>>& list) {
      return time_scales(make_grains<3, Hertz::needs>(list), laws, std::vector<Wall<3>>{}).contact;
    };
    const double balls = law.contact_time(m / 2, 0.005);
    CHECK(relative_error(contact({grain(1e-3, true), grain(0.01, false)}), balls) < 1e-14);
    // A huge pinned one makes the contact flatter and stiffer, but has no mass to give: the pair of
    // balls stays the shortest, or that with the pinned one is.
    const double flat = law.contact_time(m, 1 / (1 / 0.01 + 1 / 10.0));
    CHECK(relative_error(contact({grain(10, true), grain(1e-3, true), grain(0.01, false)}),
                         std::min(balls, flat)) < 1e-14);
  }

  TEST_CASE("with several materials each pair that can move sets the step by its law") {
    const auto grain = [](double mass, int material, bool pinned) {
      Grain<2> g;
      g.radius = 1;
      g.mass = mass;
      g.material = material;
      g.pinned = pinned;
      return g;
    };
    LawTable<LinearSpring> laws(make_law<LinearSpring>({.stiffness = 1}), 3);
    const auto spring = [](double k) { return make_law<LinearSpring>({.stiffness = k}); };
    const auto contact = [&](const std::vector<Grain<2>>& list,
                             const std::vector<Wall<2>>& walls = {}) {
      return time_scales(make_grains<2, LinearSpring::needs>(list), laws, walls).contact /
             std::numbers::pi;
    };
    laws.set(1, 1, spring(1e8));  // pinned against pinned: never
    CHECK(relative_error(contact({grain(2, 0, false), grain(1e-6, 1, true), grain(1e-6, 1, true)}),
                         1) < 1e-14);
    laws.set(0, 1, spring(100));  // the mover against the pinned: its full mass
    CHECK(relative_error(contact({grain(2, 0, false), grain(1e-6, 1, true)}),
                         std::sqrt(2 / 100.0)) < 1e-14);
    CHECK(relative_error(contact({grain(1e-6, 1, true), grain(2, 0, false)}),
                         std::sqrt(2 / 100.0)) < 1e-14);
    laws.set(2, 1, spring(1e6));  // a wall of the third material against the pinned: never
    auto wall = Wall<2>::half_space("w", {0, 0}, {0, 1});
    wall.material = 2;
    CHECK(relative_error(contact({grain(2, 0, false), grain(1e-6, 1, true)}, {wall}),
                         std::sqrt(2 / 100.0)) < 1e-14);
    wall.motion = Piston<2>{3, {0, -1}};
    CHECK(relative_error(contact({grain(2, 0, false), grain(1e-6, 1, true)}, {wall}),
                         std::sqrt(3 / 1e6)) < 1e-14);
    // Both pinned and loose ones of a material.
    laws.set(2, 1, spring(1));
    CHECK(relative_error(contact({grain(5, 1, false), grain(1e-6, 1, true)}),
                         std::sqrt(2.5 / 1e8)) < 1e-14);
  }

  TEST_CASE_TEMPLATE("the step that is called safe is safe for a grain between pinned ones", S,
                     Space<2>, Space<3>) {
    // Squeezed by two pinned grains of any size an elastic grain keeps its energy.
    constexpr int Dim = S::Dim;
    for (const double size : {0.01, 1.0, 100.0}) {
      CAPTURE(size);
      auto g = ball<Dim>(0.01 * std::min(size, 1.0) * along<Dim>());
      const double reach = 1 + size - 0.02 * std::min(size, 1.0);
      auto sim = make_sim<Dim>({g, ball<Dim>(reach * along<Dim>(), true, size),
                                ball<Dim>(-reach * along<Dim>(), true, size)},
                               make_law<LinearSpring>({.stiffness = kStiff}), {}, 1);
      const double start = energy_ledger(sim).balance();
      double worst = 0;
      for (int k = 0; k < 5000; ++k) {
        sim.step();
        worst = std::max(worst, std::abs(energy_ledger(sim).balance() - start));
      }
      CHECK(worst < 0.2 * start);
    }
  }

  // ---- The same bits
  // -----------------------------------------------------------------------------

  TEST_CASE_TEMPLATE("over a rough base all neighbourhoods and threads give the same bits", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(2);
    // More than one block of slots.
    const auto list = rough_base<Dim>(Dim == 2 ? 900 : 36, Dim == 2 ? 600 : 900, random);
    const auto law =
        make_law<FrictionalSpring>({.stiffness = kStiff, .restitution = 0.5, .friction = 0.4});
    const auto moved = [&]<class N>(N neighbourhood, int threads, bool at_once) {
      auto sim = make_sim<Dim, FrictionalSpring, N>(list, law, {}, 1, -10 * up<Dim>(),
                                                    std::move(neighbourhood));
      sim.use_threads(threads);
      if (at_once) {
        sim.step(500);
      } else {
        for (int k = 0; k < 500; ++k) sim.step();
      }
      CHECK(pinned_pairs_listed(sim) == 0);
      CHECK(contact_statistics(sim).contacts > 50);
      return Columns<Dim>(sim.grains().position);
    };
    const Columns<Dim> brute = moved(AllPairs<Dim>{}, 1, true);
    const bool cells = moved(CellGrid<Dim>{}, 1, false) == brute;
    const bool threads = moved(CellGrid<Dim>{}, 4, true) == brute;
    CHECK(cells);
    CHECK(threads);
  }
}
