// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/predicates2.hpp>

#include <lagrain/random.hpp>

#include "support/cases.hpp"

#include <CGAL/Gmpq.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

using namespace lagrain;

namespace {

using Exact = CGAL::Gmpq;
using Four = std::array<Site2, 4>;

int sign(const Exact& value) { return static_cast<int>(CGAL::sign(value)); }

/// Twice the area, written differently from the code under test.
Exact area(const Site2& a, const Site2& b, const Site2& c) {
  const Exact ax(a.x), ay(a.y), bx(b.x), by(b.y), cx(c.x), cy(c.y);
  return ax * by - ay * bx + bx * cy - by * cx + cx * ay - cy * ax;
}

Exact height(const Site2& a) {
  return Exact(a.x) * Exact(a.x) + Exact(a.y) * Exact(a.y) - Exact(a.w);
}

/// The interpolated height at d minus that of d, from barycentric coordinates.
Exact depth(const Four& s) {
  const Exact whole = area(s[0], s[1], s[2]);
  return (area(s[3], s[1], s[2]) * height(s[0]) + area(s[0], s[3], s[2]) * height(s[1]) +
          area(s[0], s[1], s[3]) * height(s[2])) /
             whole -
         height(s[3]);
}

/// Random, on small integers, nearly tied, tiny, huge, or mixed.
Four draw(Random& random, int kind) {
  Four s;
  for (Site2& site : s) {
    switch (kind) {
      case 0:
        site = {random.uniform(), random.uniform(), random.uniform()};
        break;
      case 1:
        site = {1.0 * random.below(4), 1.0 * random.below(4), 1.0 * random.below(2)};
        break;
      case 2: {  // on a circle up to rounding
        const double angle = random.uniform(0, 7);
        site = {3 + std::cos(angle), 5 + std::sin(angle), 0.25};
        break;
      }
      case 3:
        site = {1e-160 * random.uniform(), 1e-160 * random.uniform(), 1e-320 * random.uniform()};
        break;
      case 4:
        site = {1e150 * random.uniform(), 1e150 * random.uniform(), 1e300 * random.uniform()};
        break;
      case 5: {  // nearly on a line, far from the origin
        const double t = random.uniform();
        site = {1e6 + t, 1e6 + t / 3, 1e-9 * random.uniform()};
        break;
      }
      default: {
        const double scale = std::pow(10.0, random.uniform(-60, 60));
        site = {scale * random.uniform(-1, 1), scale * random.uniform(-1, 1), scale};
      }
    }
  }
  return s;
}

constexpr int kKinds = 7;

}  // namespace

TEST_SUITE("predicates2") {
  TEST_CASE("orientation has the sign of rational arithmetic, for any numbers") {
    for (int seed = 0; seed < test::cases(3000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Four s = draw(random, seed % kKinds);

      const int found = orientation(s[0], s[1], s[2]);

      INFO("seed " << seed);
      REQUIRE(found == sign(area(s[0], s[1], s[2])));
      REQUIRE(orientation(s[1], s[2], s[0]) == found);
      REQUIRE(orientation(s[1], s[0], s[2]) == -found);
    }
  }

  TEST_CASE("the power test has the sign of rational arithmetic, for any numbers") {
    for (int seed = 0; seed < test::cases(3000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      Four s = draw(random, seed % kKinds);
      const int turn = sign(area(s[0], s[1], s[2]));
      if (turn == 0) continue;
      if (turn < 0) std::swap(s[0], s[1]);

      const int found = power_side(s[0], s[1], s[2], s[3]);

      INFO("seed " << seed);
      REQUIRE(found == sign(depth(s)));
    }
  }

  TEST_CASE(
      "ties are decided as by one small perturbation of the heights in the order of the ids") {
    // Each perturbation is 2^-12 of the one before: areas of triangles with such small integers are
    // below 2^12, so the first perturbation that matters outweighs all others.
    int ties = 0;
    for (int seed = 0; seed < test::cases(3000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      Four s = draw(random, 1);
      if (area(s[0], s[1], s[2]) == 0) continue;
      if (area(s[0], s[1], s[2]) < 0) std::swap(s[0], s[1]);
      Four perturbed = s;
      std::array<int, 4> ids{0, 1, 2, 3};
      for (int k = 3; k > 0; --k)
        std::swap(ids[static_cast<std::size_t>(k)],
                  ids[static_cast<std::size_t>(random.below(k + 1))]);
      std::array<Site2, 4> by_id;
      for (std::size_t k = 0; k < 4; ++k) {
        // A greater height is a smaller weight; 2^-48 is still exact beside weights below 2.
        perturbed[k].w -= std::ldexp(1.0, -12 * (ids[k] + 1));
        by_id[static_cast<std::size_t>(ids[k])] = s[k];
      }

      const bool found = in_conflict(by_id.data(), ids[0], ids[1], ids[2], ids[3]);

      ties += sign(depth(s)) == 0;
      INFO("seed " << seed);
      REQUIRE(sign(depth(perturbed)) != 0);
      REQUIRE(found == (sign(depth(perturbed)) > 0));
    }
    CHECK(ties > 100);
  }

  TEST_CASE("the two diagonals of a quadrilateral are never both regular, nor both not") {
    for (int seed = 0; seed < test::cases(3000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Four s = draw(random, seed % kKinds);
      // a, b, c, d convex and counter-clockwise.
      const bool convex = area(s[0], s[1], s[2]) > 0 && area(s[1], s[2], s[3]) > 0 &&
                          area(s[2], s[3], s[0]) > 0 && area(s[3], s[0], s[1]) > 0;
      if (!convex) continue;

      const bool against_ac = in_conflict(s.data(), 0, 1, 2, 3);
      const bool against_bd = in_conflict(s.data(), 0, 1, 3, 2);

      INFO("seed " << seed);
      REQUIRE(against_ac != against_bd);
      REQUIRE(in_conflict(s.data(), 2, 3, 0, 1) == against_ac);
      REQUIRE(in_conflict(s.data(), 1, 2, 3, 0) == against_bd);
    }
  }

  TEST_CASE(
      "of three sites on a line one order alone has the middle one in conflict with the others") {
    int on_line = 0;
    for (int seed = 0; seed < test::cases(3000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      std::array<Site2, 3> s;
      const int step_x = random.below(3), step_y = random.below(3);
      for (std::size_t k = 0; k < 3; ++k) {
        const int t = 3 * static_cast<int>(k) + random.below(3);
        s[k] = {1.0 * t * step_x, 1.0 * t * step_y, 4.0 * random.below(12)};
      }
      if (step_x == 0 && step_y == 0) continue;
      ++on_line;

      const bool middle_below = in_conflict_beyond(s.data(), 0, 2, 1);

      INFO("seed " << seed);
      // If the middle one is above the line of the outer two, each outer one is below the line of
      // the others, and the other way round.
      REQUIRE(in_conflict_beyond(s.data(), 2, 0, 1) == middle_below);
      REQUIRE(in_conflict_beyond(s.data(), 0, 1, 2) == !middle_below);
      REQUIRE(in_conflict_beyond(s.data(), 1, 2, 0) == !middle_below);
    }
    CHECK(on_line > 100);
  }
}
