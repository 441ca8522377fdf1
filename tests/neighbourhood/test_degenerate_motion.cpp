// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes in which centres stand on lines, planes and lattices, exactly or nearly, and leave them.

#include <lagrain/triangulation_neighbourhood.hpp>

#include <lagrain/cell_grid.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>
#include <support/space.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr Laziness kFollowing{.leap = false};

/// What `watch` has seen.
struct Watch {
  AuditResult audit;
  TriangulationCost cost;
  int dimension = 0;       ///< of T at the start
  int last_dimension = 0;  ///< at the end
};

/// Follows the grains along the triangulation: every step misses nothing, and the trajectory is the
/// one with linked cells, bit for bit.
template <int Dim, class Law>
Watch watch(const MotionScene<Dim>& scene, int steps, Laziness laziness = {}) {
  CAPTURE(Dim);
  CAPTURE(scene.name);
  const Law law = make_law<Law>(kGravel);
  auto reference = start<Dim>(scene, law, CellGrid<Dim>{});
  auto sim = start<Dim>(scene, law, TriangulationNeighbourhood<Dim>(laziness));
  const auto& t = sim.neighbourhood().triangulation();
  Watch w;
  w.dimension = t.dimension();
  for (int k = 0; k < steps; k += 100) {
    const AuditResult result = audited<Dim>(sim, 100);
    for (int step = 0; step < 100; ++step) reference.step();
    w.audit.contacts += result.contacts;
    w.audit.missed += result.missed;
    CAPTURE(k);
    REQUIRE(same_bits(sim, reference));
  }
  w.last_dimension = t.dimension();
  w.cost = sim.neighbourhood().cost();
  CHECK(w.audit.contacts > 0);
  CHECK(w.audit.missed == 0);
  CHECK(sim.flow().dashpot > 0);
  CHECK(t.audit().empty());
  return w;
}

}  // namespace

TEST_SUITE("degenerate_motion") {
  TEST_CASE_TEMPLATE("a perfect crystal that gravity presses, or one grain breaks, misses nothing",
                     S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Disorder kinds[] = {{}, {.kick = 20}, {.room = 3, .kick = 20}, {.room = 3, .stir = 1}};
    for (const bool face_centred : {false, true}) {
      for (const Disorder& disorder : kinds) {
        CAPTURE(disorder.room);
        CAPTURE(disorder.kick);
        const auto scene = crystal<Dim>(Dim == 2 ? 10 : 5, face_centred, disorder);

        const Watch w = watch<Dim, FrictionalSpring>(scene, cases(3000, 50000), kFollowing);
        watch<Dim, FrictionalSpring>(scene, cases(3000, 50000));

        CHECK(w.dimension == Dim);
        CHECK((w.cost.ladder.flips > 0) == (disorder.room > 0));
        CHECK(w.cost.ladder.rebuilds == 0);
      }
    }
  }

  TEST_CASE_TEMPLATE("a crystal at rest without weight stays one, and costs nothing", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    for (const bool face_centred : {false, true}) {
      auto scene = crystal<Dim>(5, face_centred, {});
      scene.gravity.setZero();
      auto sim =
          start<Dim>(scene, make_law<FrictionalSpring>(kGravel), TriangulationNeighbourhood<Dim>{});

      for (int k = 0; k < 100; ++k) sim.step();

      CHECK(sim.neighbourhood().cost().moved == 0);
      CHECK(sim.neighbourhood().cost().searched == 0);
    }
  }

  TEST_CASE_TEMPLATE("grains in one layer on a floor are no flat set to the triangulation", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const bool dropped : {false, true}) {
      for (int seed = 0; seed < cases(1, 20); ++seed) {
        CAPTURE(seed);
        const auto scene = monolayer<Dim>(25, dropped, static_cast<std::uint64_t>(seed));

        const Watch rolling = watch<Dim, FrictionalSpring>(scene, cases(3000, 50000), kFollowing);
        const Watch sliding = watch<Dim, LinearSpring>(scene, cases(3000, 50000));

        // References stand off the layer by a hair.
        CHECK(rolling.dimension == Dim);
        CHECK(sliding.dimension == Dim);
        CHECK(sliding.last_dimension == Dim);
        // A flat set would be built anew in every update.
        CHECK(rolling.cost.ladder.rebuilds < rolling.cost.updates);
      }
    }
  }

  TEST_CASE_TEMPLATE("a box that fits its grains, shaken from below, misses nothing", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    for (const Disorder& disorder : {Disorder{.room = 1}, Disorder{.room = 1, .stir = 1}}) {
      const auto scene = shaken_box<Dim>(Dim == 2 ? 10 : 5, disorder);

      const Watch w = watch<Dim, FrictionalSpring>(scene, cases(5000, 50000), kFollowing);
      watch<Dim, FrictionalSpring>(scene, cases(5000, 50000));

      CHECK(w.cost.moved > 0);
      // A shock that hits a perfect crystal turns many of its flat simplices over at once.
      CHECK(w.cost.ladder.rebuilds * 100 <= w.cost.updates);
    }
  }

  TEST_CASE_TEMPLATE("grains in a row are no flat set to the triangulation", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    for (const int count : {2, 3, 4, 30}) {
      CAPTURE(count);
      for (const double aside : {0.0, 1.0}) {
        CAPTURE(aside);
        const auto straight = row<Dim>(count, along<Dim>(), aside);
        const auto slanted = row<Dim>(count, oblique<Dim>(), aside);

        const Watch w = watch<Dim, FrictionalSpring>(straight, cases(2000, 20000));
        watch<Dim, FrictionalSpring>(slanted, cases(2000, 20000));

        CHECK(w.dimension == std::min(count - 1, Dim));
        CHECK(w.last_dimension == std::min(count - 1, Dim));
      }
    }
  }

  TEST_CASE_TEMPLATE("grains pressed into a plane, or a line, and let go again keep their contacts",
                     S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (int seed = 0; seed < cases(5, 200); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      Cloud<Dim> cloud = make_cloud<Dim>(CloudKind::kUniform, 60, random);
      TriangulationNeighbourhood<Dim> neighbourhood;
      std::vector<Pair> found;
      std::vector<Pair> expected;
      // Thickness that the last axes keep: as they are, next to none, none.
      for (int round = 0; round < 40; ++round) {
        CAPTURE(round);
        Cloud<Dim> pressed = cloud;
        const int axes = random.below(Dim + 1);
        for (int d = Dim - axes; d < Dim; ++d) {
          pressed.x.row(d) *= std::pow(10, -10 * random.below(4));
          if (random.uniform() < 0.5) pressed.x.row(d).setZero();
        }
        Eigen::VectorXd margin = 0.05 * pressed.radius;

        neighbourhood.near_pairs(pressed.x, pressed.radius, margin, found);

        AllPairs<Dim>{}.near_pairs(pressed.x, pressed.radius, margin, expected);
        REQUIRE(found == expected);
        REQUIRE(neighbourhood.triangulation().audit().empty());
        jostle(cloud, random);
      }
    }
  }

  TEST_CASE_TEMPLATE("two, three and a few grains miss nothing", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (int count = 2; count <= 6; ++count) {
      for (int seed = 0; seed < cases(1, 20); ++seed) {
        CAPTURE(seed);
        watch<Dim, FrictionalSpring>(stirring<Dim>(count, static_cast<std::uint64_t>(seed)),
                                     cases(2000, 20000));
      }
    }
  }
}
