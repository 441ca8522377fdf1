// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The predicates of the triangulation put to the test: their formulas in plain doubles, behind
/// their filters, and in exact arithmetic alone, for sites of which some are degenerate.

#include <lagrain/predicates2.hpp>
#include <lagrain/predicates3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace lagrain::figures {

template <int Dim>
using Site = std::conditional_t<Dim == 2, Site2, Site3>;

/// A predicate: its formula for any number type made from a double, in the order of operations of
/// the filter, and the predicate itself.
template <int Dim>
struct Orientation;
template <int Dim>
struct PowerSide;

template <>
struct Orientation<2> {
  static constexpr int kDim = 2;
  static constexpr std::size_t kSites = 3;

  template <class T>
  static T of(const Site2& a, const Site2& b, const Site2& c) {
    return (T(a.x) - T(c.x)) * (T(b.y) - T(c.y)) - (T(a.y) - T(c.y)) * (T(b.x) - T(c.x));
  }
  static int sign(const Site2& a, const Site2& b, const Site2& c) { return orientation(a, b, c); }
};

template <>
struct PowerSide<2> {
  static constexpr int kDim = 2;
  static constexpr std::size_t kSites = 4;

  template <class T>
  static T of(const Site2& a, const Site2& b, const Site2& c, const Site2& d) {
    const T ax = T(a.x) - T(d.x), ay = T(a.y) - T(d.y), ah = ax * ax + ay * ay - (T(a.w) - T(d.w));
    const T bx = T(b.x) - T(d.x), by = T(b.y) - T(d.y), bh = bx * bx + by * by - (T(b.w) - T(d.w));
    const T cx = T(c.x) - T(d.x), cy = T(c.y) - T(d.y), ch = cx * cx + cy * cy - (T(c.w) - T(d.w));
    return ah * (bx * cy - by * cx) + bh * (cx * ay - cy * ax) + ch * (ax * by - ay * bx);
  }
  static int sign(const Site2& a, const Site2& b, const Site2& c, const Site2& d) {
    return power_side(a, b, c, d);
  }
};

template <>
struct Orientation<3> {
  static constexpr int kDim = 3;
  static constexpr std::size_t kSites = 4;

  template <class T>
  static T of(const Site3& a, const Site3& b, const Site3& c, const Site3& d) {
    const T bx = T(b.x) - T(a.x), by = T(b.y) - T(a.y), bz = T(b.z) - T(a.z);
    const T cx = T(c.x) - T(a.x), cy = T(c.y) - T(a.y), cz = T(c.z) - T(a.z);
    const T dx = T(d.x) - T(a.x), dy = T(d.y) - T(a.y), dz = T(d.z) - T(a.z);
    return bx * (cy * dz - cz * dy) + by * (cz * dx - cx * dz) + bz * (cx * dy - cy * dx);
  }
  static int sign(const Site3& a, const Site3& b, const Site3& c, const Site3& d) {
    return orientation(a, b, c, d);
  }
};

template <>
struct PowerSide<3> {
  static constexpr int kDim = 3;
  static constexpr std::size_t kSites = 5;

  template <class T>
  static T of(const Site3& a, const Site3& b, const Site3& c, const Site3& d, const Site3& e) {
    const T ax = T(a.x) - T(e.x), ay = T(a.y) - T(e.y), az = T(a.z) - T(e.z);
    const T bx = T(b.x) - T(e.x), by = T(b.y) - T(e.y), bz = T(b.z) - T(e.z);
    const T cx = T(c.x) - T(e.x), cy = T(c.y) - T(e.y), cz = T(c.z) - T(e.z);
    const T dx = T(d.x) - T(e.x), dy = T(d.y) - T(e.y), dz = T(d.z) - T(e.z);
    const T ah = ax * ax + ay * ay + az * az - (T(a.w) - T(e.w));
    const T bh = bx * bx + by * by + bz * bz - (T(b.w) - T(e.w));
    const T ch = cx * cx + cy * cy + cz * cz - (T(c.w) - T(e.w));
    const T dh = dx * dx + dy * dy + dz * dz - (T(d.w) - T(e.w));
    const T ab = ax * by - bx * ay, ac = ax * cy - cx * ay, ad = ax * dy - dx * ay;
    const T bc = bx * cy - cx * by, bd = bx * dy - dx * by, cd = cx * dy - dx * cy;
    const T bcd = bz * cd - cz * bd + dz * bc, acd = az * cd - cz * ad + dz * ac;
    const T abd = az * bd - bz * ad + dz * ab, abc = az * bc - bz * ac + cz * ab;
    return (ah * bcd - bh * acd) + (ch * abd - dh * abc);
  }
  static int sign(const Site3& a, const Site3& b, const Site3& c, const Site3& d, const Site3& e) {
    return power_side(a, b, c, d, e);
  }
};

/// What a predicate is asked.
template <class Predicate>
using Query = std::array<Site<Predicate::kDim>, Predicate::kSites>;

/// The sign that doubles give, right or wrong.
template <class Predicate>
int plain_sign(const Query<Predicate>& query) {
  const double value = std::apply(
      [](const auto&... sites) { return Predicate::template of<double>(sites...); }, query);
  return (value > 0) - (value < 0);
}

/// The project's predicate.
template <class Predicate>
int filtered_sign(const Query<Predicate>& query) {
  return std::apply([](const auto&... sites) { return Predicate::sign(sites...); }, query);
}

/// The sign in multiprecision floats, without any filter.
template <class Predicate>
int always_exact_sign(const Query<Predicate>& query);

/// Whether interval arithmetic knows the sign: what it does not know goes to multiprecision floats.
template <class Predicate>
bool intervals_decide(const Query<Predicate>& query);

/// What became of some queries.
struct Tally {
  int queries = 0;
  int wrong = 0;      ///< plain doubles give another sign than exact arithmetic
  int opposite = 0;   ///< of these, plus for minus or minus for plus
  int ties = 0;       ///< the exact sign is 0
  int undecided = 0;  ///< intervals do not know the sign

  bool operator==(const Tally&) const = default;
};

template <class Predicate>
Tally tally(std::span<const Query<Predicate>> queries);

template <int Dim>
struct TrialSet {
  std::string name;
  std::vector<Site<Dim>> sites;
};

/// Sites at random, of packed grains, and degenerate: on lattices, on a circle or sphere, near a
/// line or plane.
/// @param count  about as many sites in each
template <int Dim>
std::vector<TrialSet<Dim>> trial_sets(int count);

/// Queries as a triangulation asks them: a site and others of its nearest, in any order; for the
/// power side the first ones make a positive triangle or tetrahedron.
/// @throws ContractError if the sites hold none of these
template <class Predicate>
std::vector<Query<Predicate>> draw_queries(const std::vector<Site<Predicate::kDim>>& sites,
                                           int count, std::uint64_t seed);

/// Signs of the orientation of p, (12, 12), (24, 24) with p = (1/2 + i u, 1/2 + k u), u = 2^-53, in
/// row k and column i of `side` times `side`: after Kettner, Mehlhorn, Pion, Schirra & Yap,
/// Comput. Geom. 40 (2008) 61.
struct OrientationMap {
  int side = 0;
  std::vector<int> plain, exact;  ///< row by row

  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side) +
           static_cast<std::size_t>(column);
  }
};
OrientationMap orientation_map(int side);

}  // namespace lagrain::figures
