// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/near_list.hpp>

#include <lagrain/cell_grid.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

TEST_SUITE("near_list") {
  TEST_CASE_TEMPLATE("no contact is ever missing from the near list, however violent the scene", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, Case<2, LinearSpring>,
                     Case<3, Hertz>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(kGravel);
    for (int seed = 0; seed < cases(2, 50); ++seed) {
      const auto s = static_cast<std::uint64_t>(seed);
      for (const auto& scene :
           {settling_bed<Dim>(64, s), stirring<Dim>(64, s), size_mix<Dim>(60, 30, s),
            bullet<Dim>(64, s), drifting<Dim>(64, s)}) {
        CAPTURE(seed);
        CAPTURE(scene.name);
        auto sim = start<Dim>(scene, law, CellGrid<Dim>{});

        const AuditResult result = audited<Dim>(sim, cases(1500, 10000));

        CHECK(result.contacts > 0);
        CHECK(result.missed == 0);
      }
    }
  }

  TEST_CASE_TEMPLATE("a bullet crosses more than its radius in a step, and hits what it lands in",
                     C, Case<2, LinearSpring>, Case<3, LinearSpring>) {
    auto sim =
        start<C::Dim>(bullet<C::Dim>(64, 1), make_law<LinearSpring>(kGravel), CellGrid<C::Dim>{});
    const int shot = sim.grains().size() - 1;
    CHECK(sim.grains().velocity.col(shot).norm() * sim.setting().time_step >
          sim.grains().radius[shot]);

    std::int64_t hits = 0;
    for (int k = 0; k < 100; ++k) {
      sim.step();
      sim.for_each_contact([&](Pair pair, auto&&...) { hits += pair.j == shot; });
    }

    CHECK(hits > 0);
  }

  TEST_CASE("a refresh keeps the memory of pairs that stay, and gives none to new ones") {
    using Memory = FrictionalSpring::Memory<2>;
    const auto m = [](double s) { return Memory{{s, 0}}; };
    PairTable<Pair, Memory> table;
    table.assign({{0, 1}, {0, 3}, {1, 2}, {2, 3}}, {m(1), m(2), m(3), m(4)});
    std::vector<Pair> fresh{{0, 2}, {0, 3}, {1, 2}, {1, 3}, {3, 4}};

    table.replace(fresh);

    CHECK(table.pairs() == std::vector<Pair>{{0, 2}, {0, 3}, {1, 2}, {1, 3}, {3, 4}});
    CHECK(fresh == std::vector<Pair>{{0, 1}, {0, 3}, {1, 2}, {2, 3}});
    const std::vector<Memory> expected{m(0), m(2), m(3), m(0), m(0)};
    for (std::size_t k = 0; k < expected.size(); ++k) CHECK(table.memory(k) == expected[k]);
  }

  TEST_CASE("a pair that comes between others brings no memory and leaves theirs alone") {
    using Memory = FrictionalSpring::Memory<2>;
    const auto m = [](double s) { return Memory{{s, -s}}; };
    PairTable<Pair, Memory> table;
    table.assign({{0, 1}, {1, 2}}, {m(1), m(2)});

    CHECK(table.insert({0, 3}));
    CHECK(table.insert({0, 0}));
    CHECK(table.insert({2, 3}));
    CHECK_FALSE(table.insert({0, 3}));

    CHECK(table.pairs() == std::vector<Pair>{{0, 0}, {0, 1}, {0, 3}, {1, 2}, {2, 3}});
    const std::vector<Memory> expected{m(0), m(1), m(0), m(2), m(0)};
    for (std::size_t k = 0; k < expected.size(); ++k) CHECK(table.memory(k) == expected[k]);
  }

  TEST_CASE_TEMPLATE("a few grains in motion among many at rest are listed anew alone", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    // A row of grains at rest under a roof, and one that comes from below and hits a second.
    constexpr int Dim = C::Dim;
    std::vector<Vec<Dim>> places;
    for (int k = 0; k < 400; ++k) places.push_back(3.0 * k * along<Dim>());
    places.push_back(-2.01 * up<Dim>() + 3.0 * along<Dim>());
    auto grains = equal_grains<Dim>(places);
    grains.back().velocity = 20 * up<Dim>() + 20 * along<Dim>();
    MotionScene<Dim> scene{"alarm", grains, {}};
    scene.walls.push_back(Wall<Dim>::half_space("roof", 8 * up<Dim>(), -up<Dim>()));
    auto sim = start<Dim>(scene, make_law<FrictionalSpring>(kGravel), CellGrid<Dim>{});

    const AuditResult result = audited<Dim>(sim, 2000);

    CHECK(result.contacts > 10);
    CHECK(result.missed == 0);
    CHECK(sim.amended() > 10);
    CHECK(sim.refreshes() < sim.amended());
  }

  TEST_CASE_TEMPLATE("a common drift wears no list out", C, Case<2, LinearSpring>,
                     Case<3, LinearSpring>) {
    const auto refreshes = [](MotionScene<C::Dim> scene) {
      scene.walls.clear();
      auto sim = start<C::Dim>(scene, make_law<LinearSpring>(kGravel), CellGrid<C::Dim>{});
      for (int k = 0; k < 1000; ++k) sim.step();
      return sim.refreshes();
    };
    auto still = drifting<C::Dim>(64, 1);
    for (auto& g : still.grains) g.velocity -= 200 * along<C::Dim>();

    const auto moving_list = refreshes(drifting<C::Dim>(64, 1));
    const auto still_list = refreshes(still);

    // Rounding parts the two trajectories after some collisions; the counts stay alike.
    CHECK(static_cast<double>(moving_list) < 1.2 * static_cast<double>(still_list));
  }

  TEST_CASE_TEMPLATE("a contact's spring survives the refreshes that happen while it holds", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    // A grain clamped between two pins and held by friction against a weak gravity, while another
    // flies off and makes the list expire.
    constexpr int Dim = C::Dim;
    const auto law = make_law<FrictionalSpring>(kGravel);
    Grain<Dim> block;
    block.radius = 1;
    block.mass = 1;
    Grain<Dim> left = block;
    Grain<Dim> right = block;
    left.pinned = right.pinned = true;
    left.position = -1.999 * along<Dim>();
    right.position = 1.999 * along<Dim>();
    Grain<Dim> fly = block;
    fly.position = 100 * up<Dim>();
    fly.velocity = 50 * up<Dim>();
    auto sim = make_sim<Dim, FrictionalSpring, CellGrid<Dim>>({block, left, right, fly}, law, {}, 1,
                                                              -0.1 * up<Dim>());
    double longest = 0;
    std::int64_t at = 0;
    for (int k = 0; k < 1000; ++k) {
      const std::int64_t before = sim.refreshes();
      const auto memories = contact_memories(sim);
      sim.step();
      const auto after = contact_memories(sim);
      if (sim.refreshes() == before || memories.empty() || after.empty()) continue;
      ++at;
      longest = std::max(longest, memories[0].second.stretch.norm());
      // A step changes the stretch by the slip of a step, never back to nothing: speeds stay below
      // g / omega0 and the contact lasts pi / omega0 = 10 steps.
      CHECK((after[0].second.stretch - memories[0].second.stretch).norm() <
            0.1 * std::numbers::pi * 0.1 / 1e5 * 2);
    }
    CHECK(at > 3);
    // At rest two springs carry the weight.
    CHECK(longest > 0.1 / (2 * 2.0 / 7 * 1e5) * 0.9);
  }
}
