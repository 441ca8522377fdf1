#include <lagrain/triangulation_neighbourhood.hpp>

#include <lagrain/cell_grid.hpp>
#include <lagrain/triangulation2.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>

#include <doctest/doctest.h>

using namespace lagrain;
using namespace lagrain::test;

namespace {

using Triangulated = TriangulationNeighbourhood<2>;
static_assert(Neighbourhood<Triangulated, 2>);

std::vector<MotionScene<2>> normal_scenes(std::uint64_t seed) {
  return {settling_bed<2>(100, seed), stirring<2>(100, seed), size_mix<2>(100, 30, seed),
          drifting<2>(100, seed)};
}

}  // namespace

TEST_SUITE("triangulation_neighbourhood") {
  TEST_CASE("the triangulation proposes the pairs of brute force, deep overlaps included") {
    for (const CloudKind kind : kClouds) {
      for (int seed = 0; seed < cases(10, 500); ++seed) {
        for (const int count : {2, 3, 4, 10, 100}) {
          check_lists<2, Triangulated>(kind, static_cast<std::uint64_t>(seed), count, 20);
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("all three neighbourhoods move grains alike, bit for bit", Law,
                     FrictionalSpring, LinearSpring, FrictionalHertz) {
    for (const auto& scene : {settling_bed<2>(36, 1), stirring<2>(36, 2), size_mix<2>(36, 30, 3),
                              size_mix<2>(36, 1000, 4), bullet<2>(36, 5), drifting<2>(36, 6)}) {
      check_trajectory<2, Law, Triangulated>(scene, cases(10000, 100000));
      check_trajectory<2, Law, CellGrid<2>>(scene, cases(2000, 100000));
    }
  }

  TEST_CASE("no contact is missed and nothing is built anew in normal scenes") {
    const auto law = make_law<FrictionalSpring>(kGravel);
    for (int seed = 0; seed < cases(3, 50); ++seed) {
      for (const auto& scene : normal_scenes(static_cast<std::uint64_t>(seed))) {
        CAPTURE(seed);
        CAPTURE(scene.name);
        auto sim = start<2>(scene, law, Triangulated{});

        const AuditResult result = audited<2>(sim, cases(5000, 50000));

        CHECK(result.contacts > 0);
        CHECK(result.missed == 0);
        CHECK(sim.neighbourhood().cost().moved > 0);
        CHECK(sim.neighbourhood().cost().ladder.rebuilds == 0);
      }
    }
  }

  TEST_CASE("no contact is missed with sizes 1 : 1000, nor around a bullet") {
    const auto law = make_law<FrictionalSpring>(kGravel);
    for (int seed = 0; seed < cases(3, 50); ++seed) {
      const auto s = static_cast<std::uint64_t>(seed);
      for (const auto& scene : {size_mix<2>(100, 1000, s), bullet<2>(100, s)}) {
        CAPTURE(seed);
        CAPTURE(scene.name);
        auto sim = start<2>(scene, law, Triangulated{});

        const AuditResult result = audited<2>(sim, cases(5000, 50000));

        CHECK(result.contacts > 0);
        CHECK(result.missed == 0);
      }
    }
  }

  TEST_CASE(
      "four equal discs in a square lose a contact of T beyond an overlap of 0.5858 r, and the "
      "search finds it") {
    for (const double overlap : {0.57, 0.60}) {
      CAPTURE(overlap);
      // Diagonals overlap a little, sides deeply.
      const double side = 2 - overlap;
      const double half = side / std::sqrt(2.0);
      Columns<2> x(2, 4);
      x << half, 0, -half, 0, 0, half * (1 - 1e-9), 0, -half * (1 - 1e-9);
      const Eigen::VectorXd radius = Eigen::VectorXd::Ones(4);
      Eigen::VectorXd margin = Eigen::VectorXd::Zero(4);
      std::vector<Pair> pairs;
      std::vector<Pair> expected;

      Triangulated found;
      found.near_pairs(x, radius, margin, pairs);

      AllPairs<2>{}.near_pairs(x, radius, margin, expected);
      CHECK(pairs == expected);
      CHECK(expected.size() == (overlap > 0.5858 ? 6 : 4));
      CHECK(found.cost().searched > 0);  // inflated by skins, already 0.57 is too deep to certify
    }
  }

  TEST_CASE("hidden grains keep their contacts, and come back") {
    Columns<2> x(2, 5);
    x << 0, 0.2, 3, 0, -2, 0, 0.1, 0, 2.5, 0;
    Eigen::VectorXd radius(5);
    radius << 2, 0.1, 1, 0.6, 0.3;
    std::vector<Pair> pairs;
    std::vector<Pair> expected;
    Triangulated found;
    std::size_t hidden = 0;
    for (int k = 0; k <= 40; ++k) {
      CAPTURE(k);
      // Grain 1 is carried from inside grain 0 out into the open.
      x.col(1) = Vec<2>(0.2 + 0.15 * k, 0.1);
      Eigen::VectorXd margin = 0.05 * radius;

      found.near_pairs(x, radius, margin, pairs);

      AllPairs<2>{}.near_pairs(x, radius, margin, expected);
      CHECK(pairs == expected);
      hidden += found.triangulation().hidden().size();
      if (k == 0) CHECK(found.triangulation().hidden().size() > 0);
      if (k == 40) CHECK(found.triangulation().hidden().empty());
    }
    CHECK(hidden > 0);
    CHECK(found.cost().searched > 0);
  }

  TEST_CASE("in a settling bed there is nothing to search for") {
    auto sim =
        start<2>(settling_bed<2>(100, 1), make_law<FrictionalSpring>(kGravel), Triangulated{});

    for (int k = 0; k < 5000; ++k) sim.step();

    CHECK(sim.neighbourhood().cost().searched == 0);
    CHECK(sim.neighbourhood().triangulation().audit().empty());
  }

  TEST_CASE("the audit reports what a frozen triangulation and skins ten times too wide miss") {
    for (const Laziness& laziness :
         {Laziness{.follow = false}, Laziness{.skin = 2.4, .certify = false}}) {
      CAPTURE(laziness.skin);
      auto sim = start<2>(stirring<2>(100, 1), make_law<FrictionalSpring>(kGravel),
                          Triangulated{laziness});

      CHECK(audited<2>(sim, 3000).missed > 0);
    }
  }
}
