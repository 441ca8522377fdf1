// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Sets of weighted sites that tests of the plane share, and how two triangulations are compared.

#include <lagrain/random.hpp>
#include <lagrain/triangulation2.hpp>

#include "support/site_sets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lagrain::test {

using Sites = SiteSet<2>;

inline Sites make_sites(const std::string& name, const Rows<2>& rows, double r = 1) {
  return site_set<2>(name, rows, r);
}

/// Jittered square lattice of discs that do not overlap; spacing 2.
inline Sites jittered(Random& random, int side, double jitter = 0.5) {
  std::vector<std::array<double, 3>> rows;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const double r = random.uniform(0.35, 0.5);
      rows.push_back(
          {2 * i + jitter * random.uniform(-1, 1), 2 * j + jitter * random.uniform(-1, 1), r * r});
    }
  }
  return make_sites("disjoint", rows, 0.5);
}

/// Uniform centres with radii so large that many sites are hidden.
inline Sites overlapping(Random& random, int count) {
  std::vector<std::array<double, 3>> rows;
  const double side = std::sqrt(static_cast<double>(count));
  for (int i = 0; i < count; ++i) {
    const double r = random.uniform(0.3, 2.0);
    rows.push_back({random.uniform(0, side), random.uniform(0, side), r * r});
  }
  return make_sites("overlapping", rows);
}

/// Equal discs; the pitch 1 is representable, others are not, and then everything is nearly a tie.
inline Sites square_lattice(int side, double pitch) {
  std::vector<std::array<double, 3>> rows;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) rows.push_back({i * pitch, j * pitch, pitch * pitch / 4});
  }
  return make_sites("square lattice", rows, pitch / 2);
}

inline Sites hexagonal_lattice(int side, double pitch) {
  std::vector<std::array<double, 3>> rows;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      rows.push_back({(i + 0.5 * (j % 2)) * pitch, j * pitch * std::sqrt(0.75), pitch * pitch / 4});
    }
  }
  return make_sites("hexagonal lattice", rows, pitch / 2);
}

/// Small integers: coincident, collinear and cocircular sites with equal and different weights.
inline Sites integers(Random& random, int count, int range, int weights) {
  std::vector<std::array<double, 3>> rows;
  for (int i = 0; i < count; ++i) {
    rows.push_back({static_cast<double>(random.below(range)),
                    static_cast<double>(random.below(range)),
                    static_cast<double>(random.below(weights))});
  }
  return make_sites("integers", rows);
}

inline Sites collinear(Random& random, int count) {
  std::vector<std::array<double, 3>> rows;
  for (int i = 0; i < count; ++i) {
    const double t = random.below(3 * count);
    rows.push_back({t, 2 * t - 5, static_cast<double>(random.below(4))});
  }
  return make_sites("collinear", rows);
}

/// A few large discs among many that are a thousand times smaller.
inline Sites size_ratio(Random& random, int count) {
  std::vector<std::array<double, 3>> rows;
  for (int i = 0; i < count; ++i) {
    const double r = i % 25 == 0 ? 1.0 : 0.001;
    rows.push_back({random.uniform(0, 8), random.uniform(0, 8), r * r});
  }
  return make_sites("size ratio 1000", rows, 0.001);
}

/// Every kind once, small enough for quadratic tests.
inline std::vector<Sites> all_kinds(Random& random) {
  std::vector<Sites> kinds;
  kinds.push_back(jittered(random, 10));
  kinds.push_back(overlapping(random, 100));
  kinds.push_back(square_lattice(9, 1));
  kinds.push_back(square_lattice(9, 0.1 * std::sqrt(2.0)));
  kinds.push_back(hexagonal_lattice(9, 1));
  kinds.push_back(hexagonal_lattice(9, std::sqrt(3.0)));
  kinds.push_back(integers(random, 100, 7, 3));
  kinds.push_back(integers(random, 60, 12, 1));
  kinds.push_back(size_ratio(random, 100));
  kinds.push_back(far_away(jittered(random, 10)));
  kinds.push_back(far_away(overlapping(random, 80)));
  return kinds;
}

using Triple = std::array<int, 3>;

/// Sorted, each triangle turned so that its least id comes first.
inline std::vector<Triple> triangles(const Triangulation<2>& t) {
  std::vector<Triple> list;
  t.for_each_triangle([&](int a, int b, int c) {
    Triple triple{a, b, c};
    std::rotate(triple.begin(), std::min_element(triple.begin(), triple.end()), triple.end());
    list.push_back(triple);
  });
  std::sort(list.begin(), list.end());
  return list;
}

template <>
inline bool same<2>(const Triangulation<2>& a, const Triangulation<2>& b) {
  return a.dimension() == b.dimension() && triangles(a) == triangles(b) && edges(a) == edges(b) &&
         hidden(a) == hidden(b);
}

}  // namespace lagrain::test
