// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/predicates3.hpp>

#include <lagrain/random.hpp>

#include "support/cases.hpp"

#include <CGAL/Gmpq.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

using namespace lagrain;

namespace {

using Exact = CGAL::Gmpq;
using Five = std::array<Site3, 5>;

int sign(const Exact& value) { return static_cast<int>(CGAL::sign(value)); }

Exact minor(const Exact& a, const Exact& b, const Exact& c, const Exact& d) {
  return a * d - b * c;
}

/// Six times the volume, written differently from the code under test: the determinant of four rows
/// (1, x, y, z), from its minors in two columns each.
Exact volume(const Site3& a, const Site3& b, const Site3& c, const Site3& d) {
  const auto xy = [](const Site3& p, const Site3& q) {
    return minor(Exact(p.x), Exact(p.y), Exact(q.x), Exact(q.y));
  };
  const auto one_z = [](const Site3& p, const Site3& q) -> Exact {
    return Exact(q.z) - Exact(p.z);
  };
  return xy(a, b) * one_z(c, d) - xy(a, c) * one_z(b, d) + xy(a, d) * one_z(b, c) +
         xy(b, c) * one_z(a, d) - xy(b, d) * one_z(a, c) + xy(c, d) * one_z(a, b);
}

Exact height(const Site3& a) {
  return Exact(a.x) * Exact(a.x) + Exact(a.y) * Exact(a.y) + Exact(a.z) * Exact(a.z) - Exact(a.w);
}

/// The interpolated height at e minus that of e, from barycentric coordinates.
Exact depth(const Five& s) {
  const Exact whole = volume(s[0], s[1], s[2], s[3]);
  return (volume(s[4], s[1], s[2], s[3]) * height(s[0]) +
          volume(s[0], s[4], s[2], s[3]) * height(s[1]) +
          volume(s[0], s[1], s[4], s[3]) * height(s[2]) +
          volume(s[0], s[1], s[2], s[4]) * height(s[3])) /
             whole -
         height(s[4]);
}

/// Random, on small integers, nearly tied, tiny, huge, or mixed.
Five draw(Random& random, int kind) {
  Five s;
  const auto uniform = [&](double scale) { return scale * random.uniform(-1, 1); };
  const double u[2] = {random.normal(), random.normal()};
  for (Site3& site : s) {
    switch (kind) {
      case 0:
        site = {uniform(1), uniform(1), uniform(1), uniform(1)};
        break;
      case 1:
        site = {1.0 * random.below(3), 1.0 * random.below(3), 1.0 * random.below(3),
                1.0 * random.below(2)};
        break;
      case 2: {  // on a sphere up to rounding
        const double x = random.normal(), y = random.normal(), z = random.normal();
        const double norm = std::sqrt(x * x + y * y + z * z);
        site = {3 + x / norm, 5 + y / norm, -2 + z / norm, 0.25};
        break;
      }
      case 3:
        site = {uniform(1e-160), uniform(1e-160), uniform(1e-160), uniform(1e-320)};
        break;
      case 4:
        site = {uniform(1e150), uniform(1e150), uniform(1e150), uniform(1e300)};
        break;
      case 5: {  // nearly in a plane, far from the origin
        const double a = random.uniform(), b = random.uniform();
        site = {1e6 + a, 1e6 + b, 1e6 + u[0] * a + u[1] * b, uniform(1e-9)};
        break;
      }
      case 6: {  // nearly on a line
        const double t = random.uniform();
        site = {t, u[0] * t, u[1] * t, t};
        break;
      }
      case 7: {  // the corners of a cuboid whose sides are not representable
        site = {random.below(2) * std::abs(u[0]), random.below(2) * std::abs(u[1]),
                random.below(2) * std::sqrt(2.0), 0.3};
        break;
      }
      default: {
        const double scale = std::pow(10.0, random.uniform(-60, 60));
        site = {uniform(scale), uniform(scale), uniform(scale), uniform(scale * scale)};
      }
    }
  }
  return s;
}

constexpr int kKinds = 9;

/// Any order of 0 ... N - 1, and whether it is even.
template <std::size_t N>
std::pair<std::array<std::size_t, N>, bool> shuffled(Random& random) {
  std::array<std::size_t, N> order;
  std::iota(order.begin(), order.end(), std::size_t{0});
  bool even = true;
  for (std::size_t k = N - 1; k > 0; --k) {
    const auto l = static_cast<std::size_t>(random.below(static_cast<int>(k) + 1));
    std::swap(order[k], order[l]);
    even = even == (k == l);
  }
  return {order, even};
}

/// Makes the first four positive; false if they lie in one plane.
bool make_positive(Five& s) {
  const int side = sign(volume(s[0], s[1], s[2], s[3]));
  if (side < 0) std::swap(s[0], s[1]);
  return side != 0;
}

}  // namespace

TEST_SUITE("predicates3") {
  TEST_CASE("orientation has the sign of rational arithmetic, for any numbers") {
    int ties = 0;
    for (int seed = 0; seed < test::cases(5000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Five s = draw(random, seed % kKinds);

      const int found = orientation(s[0], s[1], s[2], s[3]);

      ties += found == 0;
      INFO("seed " << seed);
      REQUIRE(found == sign(volume(s[0], s[1], s[2], s[3])));
      const auto [p, even] = shuffled<4>(random);
      REQUIRE(orientation(s[p[0]], s[p[1]], s[p[2]], s[p[3]]) == (even ? found : -found));
    }
    CHECK(ties > 100);
    CHECK(orientation({0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}) == 1);
  }

  TEST_CASE("the power test has the sign of rational arithmetic, for any numbers") {
    int ties = 0;
    for (int seed = 0; seed < test::cases(5000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      Five s = draw(random, seed % kKinds);
      if (!make_positive(s)) continue;

      const int found = power_side(s[0], s[1], s[2], s[3], s[4]);

      ties += found == 0;
      INFO("seed " << seed);
      REQUIRE(found == sign(depth(s)));
      const auto [p, even] = shuffled<4>(random);
      if (even) REQUIRE(power_side(s[p[0]], s[p[1]], s[p[2]], s[p[3]], s[4]) == found);
    }
    CHECK(ties > 50);
  }

  TEST_CASE("three sites are collinear exactly if their crossed differences vanish") {
    int lines = 0;
    for (int seed = 0; seed < test::cases(3000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Five s = draw(random, seed % kKinds);
      const Exact u[3] = {Exact(s[1].x) - Exact(s[0].x), Exact(s[1].y) - Exact(s[0].y),
                          Exact(s[1].z) - Exact(s[0].z)};
      const Exact v[3] = {Exact(s[2].x) - Exact(s[0].x), Exact(s[2].y) - Exact(s[0].y),
                          Exact(s[2].z) - Exact(s[0].z)};
      bool expected = true;
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        expected = expected && minor(u[k], u[l], v[k], v[l]) == 0;
      }

      lines += expected;
      INFO("seed " << seed);
      REQUIRE(detail::collinear(s[0], s[1], s[2]) == expected);
    }
    CHECK(lines > 20);
  }

  TEST_CASE(
      "ties are decided as by one small perturbation of the heights in the order of the ids") {
    // On integers below 3 the first perturbation that matters beats the next if they differ by
    // 2^-10: the volumes that weigh them are at most 16.
    int ties = 0;
    for (int seed = 0; seed < test::cases(5000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      Five s = draw(random, 1);
      if (!make_positive(s)) continue;
      Five perturbed = s, by_id;
      const auto ids = shuffled<5>(random).first;
      for (std::size_t k = 0; k < 5; ++k) {
        // A greater height is a smaller weight; 2^-50 is still exact beside weights below 2.
        perturbed[k].w -= std::ldexp(1.0, -10 * (static_cast<int>(ids[k]) + 1));
        by_id[ids[k]] = s[k];
      }
      const auto id = [&](std::size_t k) { return static_cast<int>(ids[k]); };

      const bool found = in_conflict(by_id.data(), id(0), id(1), id(2), id(3), id(4));

      ties += sign(depth(s)) == 0;
      INFO("seed " << seed);
      REQUIRE(sign(depth(perturbed)) != 0);
      REQUIRE(found == (sign(depth(perturbed)) > 0));
    }
    CHECK(ties > 100);
  }

  TEST_CASE("five sites have one regular triangulation: their conflicts agree with one another") {
    // Of the simplices of five sites, those on the two sides of the lifted surface: the sites whose
    // barycentric share of a flip is positive see one answer, the others the opposite one.
    for (int seed = 0; seed < test::cases(5000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Five s = draw(random, seed % kKinds);
      int upper = 0;
      for (int e = 0; e < 5; ++e) {
        std::array<int, 4> q;
        for (int k = 0, l = 0; k < 5; ++k) {
          if (k != e) q[static_cast<std::size_t>(l++)] = k;
        }
        const auto at = [&](std::size_t k) -> const Site3& {
          return s[static_cast<std::size_t>(q[k])];
        };
        int side = orientation(at(0), at(1), at(2), at(3));
        if (side == 0) continue;
        if (side < 0) std::swap(q[0], q[1]);
        // (-1)^e times the volume without e is the coefficient of e in their affine relation.
        const int share = e % 2 == 0 ? side : -side;

        const bool conflict = in_conflict(s.data(), q[0], q[1], q[2], q[3], e);

        INFO("seed " << seed << " site " << e);
        const int now = conflict ? share : -share;
        if (upper == 0) upper = now;
        REQUIRE(now == upper);
      }
    }
  }

  TEST_CASE(
      "beyond a hull facet the sign of the volume decides, in its plane the perturbed circle") {
    int in_plane = 0;
    for (int seed = 0; seed < test::cases(5000, 100000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      // Four sites in a plane that may be oblique, and one off it.
      const std::array<double, 3> u{1.0 * random.below(3), 1.0 * random.below(3),
                                    1.0 * random.below(3)};
      const std::array<double, 3> v{1.0 * random.below(3), -1.0 * random.below(3),
                                    1.0 * random.below(3)};
      std::array<Site3, 4> s;
      for (Site3& site : s) {
        const double a = random.below(4), b = random.below(4);
        site = {a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2],
                1.0 * random.below(9)};
      }
      if (detail::collinear(s[0], s[1], s[2])) continue;
      ++in_plane;
      const std::array<int, 4> ids{0, 1, 2, 3};

      const bool found = in_conflict_beyond(s.data(), 0, 1, 2, 3);

      // The same with a fifth site off the plane: the cone over the plane's triangulation. It has
      // the last id, and its share is zero.
      INFO("seed " << seed);
      std::array<Site3, 5> with_apex{s[0], s[1], s[2], s[3], {}};
      for (const double z : {5.0, -7.0}) {
        with_apex[4] = {s[0].x + 1, s[0].y + 2, s[0].z + z, random.uniform(-5, 5)};
        const int side = orientation(s[0], s[1], s[2], with_apex[4]);
        if (side == 0) continue;
        const bool conflict = side > 0 ? in_conflict(with_apex.data(), 0, 1, 2, 4, 3)
                                       : in_conflict(with_apex.data(), 1, 0, 2, 4, 3);
        REQUIRE(conflict == found);
      }
      // Even and odd orders of the facet see the same.
      REQUIRE(in_conflict_beyond(s.data(), ids[1], ids[2], ids[0], 3) == found);
      REQUIRE(in_conflict_beyond(s.data(), ids[1], ids[0], ids[2], 3) == found);
    }
    CHECK(in_plane > 500);

    const std::array<Site3, 5> corner{
        {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, -9}, {0, 0, -1, 9}}};
    CHECK(in_conflict_beyond(corner.data(), 0, 1, 2, 3));
    CHECK(!in_conflict_beyond(corner.data(), 0, 1, 2, 4));
  }
}
