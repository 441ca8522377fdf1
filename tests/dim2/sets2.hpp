#pragma once
/// @file
/// Sets of weighted sites that tests of the plane share, and what two triangulations are compared
/// by.

#include <lagrain/random.hpp>
#include <lagrain/triangulation2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace lagrain::test {

struct Sites {
  std::string name;
  Columns<2> x;       ///< 2 x N
  Eigen::VectorXd w;  ///< N
  double r = 1;       ///< a typical radius

  int size() const { return static_cast<int>(w.size()); }
};

inline Sites make_sites(const std::string& name, const std::vector<std::array<double, 3>>& rows,
                        double r = 1) {
  Sites s{name, Columns<2>(2, static_cast<Eigen::Index>(rows.size())),
          Eigen::VectorXd(static_cast<Eigen::Index>(rows.size())), r};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    s.x.col(i) << rows[k][0], rows[k][1];
    s.w[i] = rows[k][2];
  }
  return s;
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

inline Sites far_away(Sites s) {
  s.name += ", far away";
  s.x.array() += 1e6 * s.r;
  return s;
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

inline std::vector<int> all_ids(int count) {
  std::vector<int> ids(static_cast<std::size_t>(count));
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

inline std::vector<int> some_ids(Random& random, int count, double fraction) {
  std::vector<int> ids;
  for (int i = 0; i < count; ++i) {
    if (random.uniform() < fraction) ids.push_back(i);
  }
  return ids;
}

using Edge = std::pair<int, int>;
using Triple = std::array<int, 3>;

inline std::vector<Edge> edges(const Triangulation<2>& t) {
  std::vector<Edge> list;
  t.for_each_edge([&](int i, int j) { list.emplace_back(i, j); });
  std::sort(list.begin(), list.end());
  return list;
}

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

inline std::vector<int> hidden(const Triangulation<2>& t) {
  return {t.hidden().begin(), t.hidden().end()};
}

/// Triangle for triangle, edge for edge, hidden site for hidden site.
inline bool same(const Triangulation<2>& a, const Triangulation<2>& b) {
  return a.dimension() == b.dimension() && triangles(a) == triangles(b) && edges(a) == edges(b) &&
         hidden(a) == hidden(b);
}

inline Triangulation<2> built(const Sites& s) {
  Triangulation<2> t;
  t.build(s.x, s.w);
  return t;
}

/// The sentences of an audit, for the message of a failed check.
inline std::string audited(const Triangulation<2>& t) {
  std::string text;
  for (const auto& defect : t.audit()) {
    text += std::to_string(defect.simplex) + " (" + std::to_string(defect.sites[0]) + " " +
            std::to_string(defect.sites[1]) + " " + std::to_string(defect.sites[2]) + ") " +
            defect.sentence + "; ";
    if (text.size() > 500) break;
  }
  return text;
}

}  // namespace lagrain::test
