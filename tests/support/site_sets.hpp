// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What tests of the triangulation share in every dimension: sets of weighted sites, displaced
/// copies of them, and what two triangulations are compared by.

#include <lagrain/random.hpp>
#include <lagrain/triangulation.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::test {

template <int Dim>
struct SiteSet {
  std::string name;
  Columns<Dim> x;     ///< Dim x N
  Eigen::VectorXd w;  ///< N
  double r = 1;       ///< a typical radius

  int size() const { return static_cast<int>(w.size()); }
};

/// Coordinates and weight, site by site.
template <int Dim>
using Rows = std::vector<std::array<double, Dim + 1>>;

template <int Dim>
SiteSet<Dim> site_set(const std::string& name, const Rows<Dim>& rows, double r) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  SiteSet<Dim> s{name, Columns<Dim>(Dim, count), Eigen::VectorXd(count), r};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& row = rows[static_cast<std::size_t>(i)];
    for (int axis = 0; axis < Dim; ++axis) s.x(axis, i) = row[static_cast<std::size_t>(axis)];
    s.w[i] = row[Dim];
  }
  return s;
}

template <int Dim>
SiteSet<Dim> far_away(SiteSet<Dim> s) {
  s.name += ", far away";
  s.x.array() += 1e6 * s.r;
  return s;
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

template <int Dim>
Vec<Dim> random_direction(Random& random) {
  Vec<Dim> direction;
  for (int axis = 0; axis < Dim; ++axis) direction[axis] = random.normal();
  return direction.normalized();
}

/// The sites listed, each at a distance from its place in a direction of its own.
template <int Dim>
SiteSet<Dim> displaced(const SiteSet<Dim>& s, const std::vector<int>& ids, double distance,
                       Random& random) {
  SiteSet<Dim> moved = s;
  for (const int i : ids) moved.x.col(i) += distance * random_direction<Dim>(random);
  return moved;
}

using Edge = std::pair<int, int>;

template <int Dim>
std::vector<Edge> edges(const Triangulation<Dim>& t) {
  std::vector<Edge> list;
  t.for_each_edge([&](int i, int j) { list.emplace_back(i, j); });
  std::sort(list.begin(), list.end());
  return list;
}

template <int Dim>
std::vector<int> hidden(const Triangulation<Dim>& t) {
  return {t.hidden().begin(), t.hidden().end()};
}

/// Present and not hidden, in increasing order.
template <int Dim>
std::vector<int> visible(const Triangulation<Dim>& t) {
  std::vector<int> list;
  const auto hidden = t.hidden();
  for (int i = 0; i < t.size(); ++i) {
    if (t.contains(i) && !std::binary_search(hidden.begin(), hidden.end(), i)) list.push_back(i);
  }
  return list;
}

template <int Dim>
Triangulation<Dim> built(const SiteSet<Dim>& s) {
  Triangulation<Dim> t;
  t.build(s.x, s.w);
  return t;
}

/// The sentences of an audit, for the message of a failed check.
template <int Dim>
std::string audited(const Triangulation<Dim>& t) {
  std::string text;
  for (const auto& defect : t.audit()) {
    text += std::to_string(defect.simplex) + " (";
    for (const int site : defect.sites) text += std::to_string(site) + " ";
    text.back() = ')';
    text += " " + defect.sentence + "; ";
    if (text.size() > 500) break;
  }
  return text;
}

/// Brute force: pairs that touch and are not edges.
template <int Dim>
int missed_contacts(const Triangulation<Dim>& t, const SiteSet<Dim>& s) {
  const auto list = edges(t);
  int missed = 0;
  for (int i = 0; i < s.size(); ++i) {
    for (int j = i + 1; j < s.size(); ++j) {
      const double reach = std::sqrt(s.w[i]) + std::sqrt(s.w[j]);
      if ((s.x.col(i) - s.x.col(j)).norm() > reach) continue;
      missed += !std::binary_search(list.begin(), list.end(), Edge{i, j});
    }
  }
  return missed;
}

/// Whether two triangulations agree: simplex for simplex, edge for edge, hidden for hidden site.
template <int Dim>
bool same(const Triangulation<Dim>& a, const Triangulation<Dim>& b);

/// T equals a triangulation of the same sites built from nothing, and its audit is empty.
#define CHECK_AS_BUILT(t, sites)              \
  do {                                        \
    CHECK(test::audited(t) == "");            \
    CHECK(test::same(t, test::built(sites))); \
  } while (false)

}  // namespace lagrain::test
