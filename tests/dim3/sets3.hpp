// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Sets of weighted sites that tests of space share, and what two triangulations are compared by.

#include <lagrain/random.hpp>
#include <lagrain/triangulation3.hpp>

#include "support/site_sets.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lagrain::test {

using Four = std::array<int, 4>;

/// Each tetrahedron with its ids in increasing order (all are positive, so that is enough), sorted.
inline std::vector<Four> tetrahedra(const Triangulation<3>& t) {
  std::vector<Four> list;
  t.for_each_tetrahedron([&](int a, int b, int c, int d) {
    list.push_back({a, b, c, d});
    std::sort(list.back().begin(), list.back().end());
  });
  std::sort(list.begin(), list.end());
  return list;
}

template <>
inline bool same<3>(const Triangulation<3>& a, const Triangulation<3>& b) {
  return a.dimension() == b.dimension() && tetrahedra(a) == tetrahedra(b) && edges(a) == edges(b) &&
         hidden(a) == hidden(b);
}

}  // namespace lagrain::test

namespace lagrain::test3 {

using Sites = test::SiteSet<3>;

inline Sites make_sites(const std::string& name, const test::Rows<3>& rows, double r = 1) {
  return test::site_set<3>(name, rows, r);
}

/// Jittered cubic lattice of spheres that do not overlap; spacing 2.
inline Sites jittered(Random& random, int side, double jitter = 0.5) {
  test::Rows<3> rows;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        const double r = random.uniform(0.35, 0.5);
        rows.push_back({2 * i + jitter * random.uniform(-1, 1),
                        2 * j + jitter * random.uniform(-1, 1),
                        2 * k + jitter * random.uniform(-1, 1), r * r});
      }
    }
  }
  return make_sites("disjoint", rows, 0.5);
}

/// Uniform centres, one in each unit of volume, and uniform radii.
inline Sites at_random(const std::string& name, Random& random, int count, double least,
                       double most, double typical) {
  test::Rows<3> rows;
  const double side = std::cbrt(static_cast<double>(count));
  for (int i = 0; i < count; ++i) {
    const double r = random.uniform(least, most);
    rows.push_back(
        {random.uniform(0, side), random.uniform(0, side), random.uniform(0, side), r * r});
  }
  return make_sites(name, rows, typical);
}

/// Small and nearly equal spheres at random.
inline Sites uniform(Random& random, int count) {
  return at_random("random", random, count, 0.15, 0.25, 0.25);
}

/// Spheres at random that are so large that many sites are hidden.
inline Sites overlapping(Random& random, int count) {
  return at_random("overlapping", random, count, 0.3, 2.0, 1);
}

/// Radii from 1/ratio to 1, as many in each octave, placed at random where they overlap no other by
/// more than the given part of the smaller radius; `count` at most.
inline Sites polydisperse(Random& random, int count, double ratio, double overlap = 0.05) {
  test::Rows<3> rows;
  const double side = 1.5 * std::cbrt(static_cast<double>(count));
  for (int trial = 0; trial < 20 * count && static_cast<int>(rows.size()) < count; ++trial) {
    const double r = std::pow(ratio, -random.uniform());
    const Vec<3> x(random.uniform(0, side), random.uniform(0, side), random.uniform(0, side));
    const bool fits = std::all_of(rows.begin(), rows.end(), [&](const auto& row) {
      const double q = std::sqrt(row[3]);
      return r + q - (x - Vec<3>(row[0], row[1], row[2])).norm() < overlap * std::min(r, q);
    });
    if (fits) rows.push_back({x[0], x[1], x[2], r * r});
  }
  return make_sites("polydisperse", rows, 1 / std::sqrt(ratio));
}

/// Equal spheres on a cubic lattice. With the pitch 1 every tie is exact; at other pitches the
/// places are rounded, which leaves near ties.
inline Sites cubic_lattice(int side, double pitch) {
  test::Rows<3> rows;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        rows.push_back({i * pitch, j * pitch, k * pitch, pitch * pitch / 4});
      }
    }
  }
  return make_sites("cubic lattice", rows, pitch / 2);
}

/// Face-centred cubic; the pitch is half the side of the cube.
inline Sites fcc_lattice(int side, double pitch) {
  test::Rows<3> rows;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (int k = 0; k < side; ++k) {
        if ((i + j + k) % 2 != 0) continue;
        rows.push_back({i * pitch, j * pitch, k * pitch, pitch * pitch / 2});
      }
    }
  }
  return make_sites("fcc lattice", rows, pitch / std::sqrt(2.0));
}

/// Hexagonal layers of touching spheres, each second one in the hollows of the first.
inline Sites hcp_lattice(int side, double pitch) {
  test::Rows<3> rows;
  for (int k = 0; k < side; ++k) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        rows.push_back({(i + 0.5 * ((j + k) % 2)) * pitch,
                        (j + (k % 2) / 3.0) * pitch * std::sqrt(0.75),
                        k * pitch * std::sqrt(2.0 / 3), pitch * pitch / 4});
      }
    }
  }
  return make_sites("hcp lattice", rows, pitch / 2);
}

/// Sites of small integers: there are coincident, collinear, coplanar and cospherical ones, with
/// equal and with different weights.
inline Sites integers(Random& random, int count, int range, int weights) {
  test::Rows<3> rows;
  for (int i = 0; i < count; ++i) {
    rows.push_back({1.0 * random.below(range), 1.0 * random.below(range), 1.0 * random.below(range),
                    1.0 * random.below(weights)});
  }
  return make_sites("integers", rows);
}

inline Sites collinear(Random& random, int count) {
  test::Rows<3> rows;
  for (int i = 0; i < count; ++i) {
    const double t = random.below(3 * count);
    rows.push_back({t, 2 * t - 5, 3 - t, 1.0 * random.below(4)});
  }
  return make_sites("collinear", rows);
}

/// Exactly in the plane that two vectors of small integers span; with ties.
inline Sites coplanar(Random& random, int count, const Vec<3>& u, const Vec<3>& v) {
  test::Rows<3> rows;
  for (int i = 0; i < count; ++i) {
    const Vec<3> x = random.below(9) * u + random.below(9) * v;
    rows.push_back({x[0], x[1], x[2], 1.0 * random.below(3)});
  }
  return make_sites("coplanar", rows);
}

/// In an oblique plane but for rounding, so that the hull is as thin as rounding.
inline Sites nearly_coplanar(Random& random, int count) {
  test::Rows<3> rows;
  const Vec<3> u = Vec<3>(1, std::sqrt(2.0), -0.3).normalized();
  const Vec<3> v = u.cross(Vec<3>(0.1, 0.7, std::sqrt(3.0))).normalized();
  const double side = std::sqrt(static_cast<double>(count));
  for (int i = 0; i < count; ++i) {
    const Vec<3> x = random.uniform(0, side) * u + random.uniform(0, side) * v;
    const double r = random.uniform(0.1, 0.3);
    rows.push_back({x[0], x[1], x[2], r * r});
  }
  return make_sites("nearly coplanar", rows, 0.3);
}

/// Few places, each with several sites.
inline Sites coincident(Random& random, int count) {
  test::Rows<3> rows;
  const int places = count / 4;
  for (int i = 0; i < count; ++i) {
    Random place(static_cast<std::uint64_t>(random.below(places)));
    const double x = place.uniform(0, 9), y = place.uniform(0, 9), z = place.uniform(0, 9);
    rows.push_back({x, y, z, 0.5 * random.below(3)});
  }
  return make_sites("coincident", rows);
}

/// A few large spheres among many that are a thousand times smaller.
inline Sites size_ratio(Random& random, int count) {
  test::Rows<3> rows;
  for (int i = 0; i < count; ++i) {
    const double r = i % 25 == 0 ? 1.0 : 0.001;
    rows.push_back({random.uniform(0, 4), random.uniform(0, 4), random.uniform(0, 4), r * r});
  }
  return make_sites("size ratio 1000", rows, 0.001);
}

/// Without symmetry, ties or nearly flat hulls: what a packing of grains is like.
inline std::vector<Sites> disordered_kinds(Random& random, int side) {
  const int count = side * side * side;
  return {jittered(random, side),
          uniform(random, count),
          overlapping(random, count),
          polydisperse(random, count, 100),
          size_ratio(random, count),
          far_away(jittered(random, side)),
          far_away(overlapping(random, count))};
}

/// Full of ties, exact or up to rounding.
inline std::vector<Sites> tied_kinds(Random& random, int side) {
  const int count = side * side * side;
  return {cubic_lattice(side, 1),        cubic_lattice(side, 0.1 * std::sqrt(2.0)),
          fcc_lattice(side + 1, 1),      fcc_lattice(side + 1, std::sqrt(3.0)),
          hcp_lattice(side, 1),          far_away(hcp_lattice(side, 0.7)),
          integers(random, count, 4, 3), integers(random, count / 2, 8, 1),
          coincident(random, count)};
}

/// Of less than three dimensions, or of three by rounding only.
inline std::vector<Sites> flat_kinds(Random& random, int count) {
  return {collinear(random, count),
          coplanar(random, count, {1, 0, 0}, {0, 1, 0}),
          coplanar(random, count, {0, 0, 1}, {0, 1, 0}),
          coplanar(random, count, {1, -1, 0}, {0, 2, -3}),
          far_away(coplanar(random, count, {1, 2, 5}, {3, 1, -1})),
          nearly_coplanar(random, count)};
}

/// Every kind once, small enough for quadratic tests.
inline std::vector<Sites> all_kinds(Random& random, int side = 4) {
  std::vector<Sites> kinds = disordered_kinds(random, side);
  for (auto& s : tied_kinds(random, side)) kinds.push_back(std::move(s));
  for (auto& s : flat_kinds(random, 40)) kinds.push_back(std::move(s));
  return kinds;
}

}  // namespace lagrain::test3
