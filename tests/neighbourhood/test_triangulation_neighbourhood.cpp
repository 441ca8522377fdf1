// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation_neighbourhood.hpp>

#include <lagrain/cell_grid.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>
#include <support/site_sets.hpp>
#include <support/space.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
using Triangulated = TriangulationNeighbourhood<Dim>;
static_assert(Neighbourhood<Triangulated<2>, 2> && Neighbourhood<Triangulated<3>, 3>);

template <int Dim>
inline constexpr int kFew = Dim == 2 ? 36 : 48;
template <int Dim>
inline constexpr int kMany = Dim == 2 ? 100 : 125;

template <int Dim>
std::vector<MotionScene<Dim>> normal_scenes(std::uint64_t seed) {
  return {settling_bed<Dim>(kMany<Dim>, seed), stirring<Dim>(kMany<Dim>, seed),
          size_mix<Dim>(kMany<Dim>, 30, seed), drifting<Dim>(kMany<Dim>, seed)};
}

/// The lists of brute force, without margins.
template <int Dim>
std::vector<Pair> touching_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
  Eigen::VectorXd none = Eigen::VectorXd::Zero(radius.size());
  std::vector<Pair> pairs;
  AllPairs<Dim>{}.near_pairs(x, radius, none, pairs);
  return pairs;
}

}  // namespace

TEST_SUITE("triangulation_neighbourhood") {
  TEST_CASE_TEMPLATE("the triangulation proposes the pairs of brute force, deep overlaps included",
                     S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const CloudKind kind : kClouds) {
      for (int seed = 0; seed < cases(10, Dim == 2 ? 500 : 100); ++seed) {
        for (const int count : {2, 3, 4, 10, 100}) {
          check_lists<Dim, Triangulated<Dim>>(kind, static_cast<std::uint64_t>(seed), count, 20);
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("all three neighbourhoods move grains alike, bit for bit", C,
                     Case<2, FrictionalSpring>, Case<2, LinearSpring>, Case<2, FrictionalHertz>,
                     Case<3, FrictionalSpring>, Case<3, LinearSpring>, Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    constexpr int kCount = kFew<Dim>;
    for (const auto& scene :
         {settling_bed<Dim>(kCount, 1), stirring<Dim>(kCount, 2), size_mix<Dim>(kCount, 30, 3),
          size_mix<Dim>(kCount, 1000, 4), bullet<Dim>(kCount, 5), drifting<Dim>(kCount, 6)}) {
      check_trajectory<Dim, Law, Triangulated<Dim>>(scene, cases(Dim == 2 ? 10000 : 3000, 100000));
      check_trajectory<Dim, Law>(scene, cases(2000, 100000),
                                 Triangulated<Dim>(Laziness{.leap = false}));
      check_trajectory<Dim, Law, CellGrid<Dim>>(scene, cases(2000, 100000));
    }
  }

  TEST_CASE_TEMPLATE("no contact is missed and nothing is built anew in normal scenes", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const auto law = make_law<FrictionalSpring>(kGravel);
    for (int seed = 0; seed < (Dim == 2 ? cases(3, 50) : cases(1, 10)); ++seed) {
      for (const auto& scene : normal_scenes<Dim>(static_cast<std::uint64_t>(seed))) {
        CAPTURE(seed);
        CAPTURE(scene.name);
        for (const bool leap : {false, true}) {
          CAPTURE(leap);
          auto sim = start<Dim>(scene, law, Triangulated<Dim>(Laziness{.leap = leap}));

          const AuditResult result = audited<Dim>(sim, cases(5000, 50000));

          const TriangulationCost& cost = sim.neighbourhood().cost();
          CHECK(result.contacts > 0);
          CHECK(result.missed == 0);
          CHECK(sim.amended() > 0);
          CHECK((leap ? cost.leaps : cost.moved) > 0);
          CHECK(cost.ladder.rebuilds == 0);
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("every grain is within its skin of its reference, in a frame that drifts", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto scene = drifting<Dim>(kMany<Dim>, 1);
    const auto count = static_cast<Eigen::Index>(scene.grains.size());
    Columns<Dim> x(Dim, count);
    Eigen::VectorXd radius(count);
    for (int i = 0; i < count; ++i) {
      x.col(i) = scene.grains[static_cast<std::size_t>(i)].position;
      radius[i] = scene.grains[static_cast<std::size_t>(i)].radius;
    }
    Triangulated<Dim> known(Laziness{.leap = false});
    std::vector<Pair> pairs;
    Random random(1);
    for (int question = 0; question < 100; ++question) {
      x.colwise() += along<Dim>();
      x += x.unaryExpr([&](double) { return 0.02 * random.uniform(-1, 1); });
      Eigen::VectorXd margin = 0.01 * radius;
      known.near_pairs(x, radius, margin, pairs);

      CHECK(known.uncertain().empty());
      for (int i = 0; i < count; ++i) {
        CHECK((x.col(i) - known.reference(i)).norm() < known.skin(i));
      }
    }
    CHECK(known.cost().moved > 0);
    CHECK((known.drift() - 99 * along<Dim>()).norm() < 0.1);
    const Vec<Dim> believed = known.triangulation().site(0) + known.drift();
    CHECK((known.reference(0) - believed).norm() < 1e-12);
  }

  TEST_CASE_TEMPLATE("no contact is missed with sizes 1 : 1000, nor around a bullet", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const auto law = make_law<FrictionalSpring>(kGravel);
    for (int seed = 0; seed < (Dim == 2 ? cases(3, 50) : cases(1, 10)); ++seed) {
      const auto s = static_cast<std::uint64_t>(seed);
      for (const auto& scene : {size_mix<Dim>(kMany<Dim>, 1000, s), bullet<Dim>(kMany<Dim>, s)}) {
        CAPTURE(seed);
        CAPTURE(scene.name);
        auto sim = start<Dim>(scene, law, Triangulated<Dim>{});

        const AuditResult result = audited<Dim>(sim, cases(5000, 50000));

        CHECK(result.contacts > 0);
        CHECK(result.missed == 0);
      }
    }
  }

  TEST_CASE_TEMPLATE(
      "four equal discs in a square, or six spheres in an octahedron, lose contacts of T beyond an "
      "overlap of 0.5858 r, and the search finds them",
      S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const double overlap : {0.57, 0.60}) {
      CAPTURE(overlap);
      // Diagonals overlap a little, sides deeply. One diagonal is an edge of T.
      const double half = (2 - overlap) / std::sqrt(2.0);
      Columns<Dim> x(Dim, 2 * Dim);
      for (int d = 0; d < Dim; ++d) {
        x.col(2 * d) = half * (1 - d * 1e-9) * Vec<Dim>::Unit(d);
        x.col(2 * d + 1) = -x.col(2 * d);
      }
      const Eigen::VectorXd radius = Eigen::VectorXd::Ones(2 * Dim);
      const SiteSet<Dim> bare{"diagonals", x, radius.array().square()};
      const bool diagonals_touch = overlap > 0.5858;
      const int sides = 2 * Dim * (Dim - 1);
      Eigen::VectorXd margin = Eigen::VectorXd::Zero(2 * Dim);
      std::vector<Pair> pairs;

      Triangulated<Dim> found;
      found.near_pairs(x, radius, margin, pairs);

      CHECK(missed_contacts(built(bare), bare) == (diagonals_touch ? Dim - 1 : 0));
      CHECK(pairs == touching_pairs<Dim>(x, radius));
      CHECK(static_cast<int>(pairs.size()) == sides + (diagonals_touch ? Dim : 0));
      CHECK(found.cost().searched > 0);  // inflated by skins, already 0.57 is too deep to certify
    }
  }

  TEST_CASE(
      "four equal spheres in a square lose a contact of T like discs, alone or among others") {
    const double half = 1.4 / std::sqrt(2.0);
    for (const int others : {0, 60}) {
      CAPTURE(others);
      Random random(1);
      Columns<3> x(3, 4 + others);
      x.col(0) = Vec<3>(half, 0, 0);
      x.col(1) = Vec<3>(-half, 0, 0);
      x.col(2) = Vec<3>(0, half * (1 - 1e-9), 0);
      x.col(3) = Vec<3>(0, -half * (1 - 1e-9), 0);
      const auto packed = lattice<3>({.count = others}, random);
      for (int i = 0; i < others; ++i) {
        x.col(4 + i) = packed.grains[static_cast<std::size_t>(i)].position + Vec<3>(-4, -4, 2);
      }
      const Eigen::VectorXd radius = Eigen::VectorXd::Ones(4 + others);
      const SiteSet<3> bare{"square", x, radius.array().square()};
      Eigen::VectorXd margin = Eigen::VectorXd::Zero(4 + others);
      std::vector<Pair> pairs;

      Triangulated<3> found;
      found.near_pairs(x, radius, margin, pairs);

      CHECK((others > 0 || missed_contacts(built(bare), bare) == 1));
      CHECK(pairs == touching_pairs<3>(x, radius));
      CHECK(found.cost().searched > 0);
    }
  }

  TEST_CASE_TEMPLATE("hidden grains keep their contacts, and come back", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> a = along<Dim>();
    const Vec<Dim> u = up<Dim>();
    // Below, a bed of others, so that T is no tiny set.
    Random random(1);
    const auto bed = lattice<Dim>({.count = 40}, random);
    const auto count = static_cast<Eigen::Index>(5 + bed.grains.size());
    Columns<Dim> x(Dim, count);
    Eigen::VectorXd radius(count);
    x.leftCols(5) << Vec<Dim>::Zero(), 0.2 * a, 3 * a + 0.1 * u, Vec<Dim>::Zero(), -2 * a + 2.5 * u;
    radius.head(5) << 2, 0.1, 1, 0.6, 0.3;
    for (Eigen::Index i = 5; i < count; ++i) {
      const Grain<Dim>& g = bed.grains[static_cast<std::size_t>(i - 5)];
      x.col(i) = g.position - 0.5 * bed.high - (0.5 * bed.high[Dim - 1] + 2) * u;
      radius[i] = g.radius;
    }
    std::vector<Pair> pairs;
    std::vector<Pair> expected;
    Triangulated<Dim> found;
    const auto& t = found.triangulation();
    for (int k = 0; k <= 40; ++k) {
      CAPTURE(k);
      // Grain 1 is carried from inside grain 0 out into the open.
      x.col(1) = (0.2 + 0.15 * k) * a + 0.1 * u;
      Eigen::VectorXd margin = 0.05 * radius;

      found.near_pairs(x, radius, margin, pairs);

      AllPairs<Dim>{}.near_pairs(x, radius, margin, expected);
      CHECK(pairs == expected);
      if (k == 0) CHECK(std::ranges::find(t.hidden(), 1) != t.hidden().end());
      if (k == 40) CHECK(std::ranges::find(t.hidden(), 1) == t.hidden().end());
    }
    CHECK(found.cost().ladder.reinserted > 0);
    CHECK(found.cost().searched > 0);
  }

  TEST_CASE_TEMPLATE(
      "a gas in flight, and one fast grain in it, miss nothing; references ahead of the grains "
      "stay within their skins, and every edge passes the certificate",
      S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const double fast : {1.0, 100.0}) {
      CAPTURE(fast);
      Random random(1);
      auto cloud = make_cloud<Dim>(CloudKind::kUniform, 80, random);
      cloud.x *= 4;  // room to fly
      Columns<Dim> velocity(Dim, cloud.x.cols());
      for (Eigen::Index i = 0; i < velocity.cols(); ++i) {
        velocity.col(i) = cloud.radius.minCoeff() * random_direction<Dim>(random);
      }
      velocity.col(0) *= fast;
      Triangulated<Dim> found;
      std::vector<Pair> pairs;
      std::vector<Pair> expected;
      for (int k = 0; k < 300; ++k) {
        CAPTURE(k);
        Eigen::VectorXd margin = 0.05 * cloud.radius;

        found.near_pairs(cloud.x, cloud.radius, margin, pairs);

        CHECK(margin.minCoeff() >= 0);
        AllPairs<Dim>{}.near_pairs(cloud.x, cloud.radius, margin, expected);
        REQUIRE(pairs == expected);
        const auto& t = found.triangulation();
        REQUIRE(t.audit().empty());
        if (found.cost().searched == 0) {
          t.for_each_edge([&](int a, int b) {
            REQUIRE((t.site(a) - t.site(b)).squaredNorm() > t.weight(a) + t.weight(b));
          });
        }
        cloud.x += 0.05 * velocity;
      }
      CHECK(found.cost().moved > 0);
    }
  }

  TEST_CASE_TEMPLATE(
      "T leaps where grains fly, walks with those that leave their skins, and "
      "follows again when they have calmed down",
      S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(1);
    auto cloud = make_cloud<Dim>(CloudKind::kSizes, 80, random);
    cloud.x *= 2;
    Columns<Dim> velocity(Dim, cloud.x.cols());
    for (Eigen::Index i = 0; i < velocity.cols(); ++i) {
      velocity.col(i) = cloud.radius[i] * random_direction<Dim>(random);
    }
    // What a near list would ask for: more for fast grains, and one of them is slow.
    velocity.col(0).setZero();
    Triangulated<Dim> found;
    std::vector<Pair> pairs;
    std::vector<Pair> expected;
    const auto ask = [&](double wanted) {
      Eigen::VectorXd margin = wanted * cloud.radius;
      margin[0] = 0.001 * cloud.radius[0];
      found.near_pairs(cloud.x, cloud.radius, margin, pairs);
      CHECK(margin.minCoeff() >= 0);
      AllPairs<Dim>{}.near_pairs(cloud.x, cloud.radius, margin, expected);
      REQUIRE(pairs == expected);
      REQUIRE(found.triangulation().audit().empty());
    };
    for (int k = 0; k < 200; ++k) {
      CAPTURE(k);
      ask(0.05);
      cloud.x += 0.05 * velocity;
    }
    ask(0.001);
    const TriangulationCost flying = found.cost();
    for (int k = 0; k < 10; ++k) ask(0.001);
    const TriangulationCost calm = found.cost();
    cloud.x.col(1).array() += 5 * cloud.radius[1];
    ask(0.001);

    CHECK(flying.leaps > 1);
    CHECK(flying.walks > 0);
    CHECK(flying.moved > 0);  // before it leaps
    CHECK(calm.leaps == flying.leaps);
    CHECK(found.cost().walks == calm.walks);
    CHECK(found.cost().moved > calm.moved);
  }

  TEST_CASE_TEMPLATE("in a settling bed there is nothing to search for", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto sim = start<Dim>(settling_bed<Dim>(kMany<Dim>, 1), make_law<FrictionalSpring>(kGravel),
                          Triangulated<Dim>{});

    for (int k = 0; k < 5000; ++k) sim.step();

    CHECK(sim.neighbourhood().cost().searched == 0);
    CHECK(sim.neighbourhood().triangulation().audit().empty());
  }

  TEST_CASE_TEMPLATE(
      "the audit reports what a frozen triangulation and skins ten times too wide miss", S,
      Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const Laziness& laziness :
         {Laziness{.follow = false}, Laziness{.skin = 13, .certify = false, .leap = false}}) {
      CAPTURE(laziness.skin);
      auto sim = start<Dim>(stirring<Dim>(kMany<Dim>, 1), make_law<FrictionalSpring>(kGravel),
                            Triangulated<Dim>{laziness});

      CHECK(audited<Dim>(sim, 3000).missed > 0);
      CHECK_FALSE(keeps_promise(sim.neighbourhood()));
    }
  }
}
