// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What holds of T in every dimension: each law checks one set of sites. Where dimensions differ
/// (in what updates may cost, in which sets are flat) their own tests say so.

#include "support/site_sets.hpp"

#include <lagrain/check.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

namespace lagrain::test {

/// At least one of so many ids.
inline std::vector<int> one_or_some_ids(Random& random, int count, double fraction) {
  const std::vector<int> ids = some_ids(random, count, fraction);
  return ids.empty() ? std::vector<int>{random.below(count)} : ids;
}

/// Sites inserted one by one into nothing give the triangulation that build gives.
template <int Dim>
void check_insertions(const SiteSet<Dim>& s) {
  CAPTURE(s.name);
  Triangulation<Dim> t;

  for (int i = 0; i < s.size(); ++i) t.insert(i, s.x.col(i), s.w[i]);

  CHECK_AS_BUILT(t, s);
}

/// A move gives the triangulation that build gives, and moving back the former one.
/// @return what the moves by less than a radius took
template <int Dim>
UpdateReport check_moves(const SiteSet<Dim>& s, Random& random) {
  UpdateReport small_moves;
  auto t = built(s);
  for (const double distance : {0.01, 0.05, 0.17, 1.0}) {
    for (const double fraction : {0.0, 0.02, 0.3, 1.0}) {
      CAPTURE(s.name);
      CAPTURE(distance);
      CAPTURE(fraction);
      const auto ids = one_or_some_ids(random, s.size(), fraction);
      const auto there = displaced(s, ids, distance * s.r, random);

      UpdateReport report = t.move(ids, there.x, there.w);
      CHECK_AS_BUILT(t, there);
      report += t.move(ids, s.x, s.w);
      CHECK_AS_BUILT(t, s);

      if (distance < 1) small_moves += report;
    }
  }
  return small_moves;
}

/// Weights may change, hiding sites and showing them again.
/// @param share  of the sites whose weights change
/// @return what showing them again took
template <int Dim>
UpdateReport check_weights(const SiteSet<Dim>& s, double share, Random& random) {
  auto other = s;
  const auto ids = some_ids(random, s.size(), share);
  for (const int i : ids) other.w[i] = random.uniform(-1, 40);
  auto t = built(s);

  t.move(ids, s.x, other.w);
  CHECK_AS_BUILT(t, other);
  CHECK(!t.hidden().empty());
  const UpdateReport report = t.move(ids, s.x, s.w);

  CHECK_AS_BUILT(t, s);
  CHECK(t.hidden().empty());
  CHECK(report.reinserted > 0);
  return report;
}

/// Without the removed ids T is that of the sites that are there, and lives on.
template <int Dim>
void check_closed_gaps(Triangulation<Dim> t, const SiteSet<Dim>& s) {
  std::vector<int> present, removed;
  for (int i = 0; i < s.size(); ++i) (t.contains(i) ? present : removed).push_back(i);
  const auto sites_of = [&](const std::vector<int>& ids) {
    SiteSet<Dim> some = s;
    some.x = s.x(Eigen::seqN(0, Eigen::fix<Dim>), ids);
    some.w = s.w(ids);
    return some;
  };

  t.close_gaps();

  CHECK(t.size() == static_cast<int>(present.size()));
  CHECK_AS_BUILT(t, sites_of(present));
  for (const int i : removed) {
    t.insert(t.size(), s.x.col(i), s.w[i]);
    present.push_back(i);
    CHECK(audited(t) == "");
  }
  CHECK_AS_BUILT(t, sites_of(present));
}

/// Any sequence of moves, insertions and removals ends in the triangulation of what is there.
template <int Dim>
void check_sequence(SiteSet<Dim> s, Random& random) {
  CAPTURE(s.name);
  std::vector<bool> present(static_cast<std::size_t>(s.size()), true);
  auto t = built(s);
  for (int step = 0; step < 40; ++step) {
    CAPTURE(step);
    const int i = random.below(s.size());
    const auto k = static_cast<std::size_t>(i);
    if (random.uniform() < 0.3) {
      s.x.col(i) += 5 * s.r * random_direction<Dim>(random);
      if (random.uniform() < 0.5) s.w[i] *= random.uniform(0.5, 1.5);
      if (present[k]) t.move(std::vector<int>{i, i}, s.x, s.w);
    } else if (present[k]) {
      t.remove(i);
      present[k] = false;
    } else {
      t.insert(i, s.x.col(i), s.w[i]);
      present[k] = true;
    }
    CHECK(audited(t) == "");
  }
  check_closed_gaps(t, s);
  for (int i = 0; i < s.size(); ++i) {
    CHECK(t.contains(i) == present[static_cast<std::size_t>(i)]);
    if (!t.contains(i)) t.insert(i, s.x.col(i), s.w[i]);
  }
  CHECK_AS_BUILT(t, s);
}

/// Every neighbour relation is an edge, seen from both ends.
template <int Dim>
void check_neighbours(const SiteSet<Dim>& s) {
  CAPTURE(s.name);
  const auto t = built(s);
  std::vector<Edge> seen;

  for (int i = 0; i < s.size(); ++i) {
    t.for_each_neighbour(i, [&](int j) { seen.emplace_back(std::min(i, j), std::max(i, j)); });
  }

  std::sort(seen.begin(), seen.end());
  std::vector<Edge> twice;
  for (const Edge& edge : edges(t)) twice.insert(twice.end(), 2, edge);
  CHECK(seen == twice);
}

/// An update tells which edges it made.
template <int Dim>
void check_new_edges(SiteSet<Dim> s, Random& random) {
  CAPTURE(s.name);
  auto t = built(s);
  for (const double distance : {0.05, 1.0}) {
    for (const double fraction : {0.0, 0.05, 1.0}) {
      const auto ids = one_or_some_ids(random, s.size(), fraction);
      s = displaced(s, ids, distance * s.r, random);
      const auto before = edges(t);

      t.move(ids, s.x, s.w);

      std::vector<Edge> told;
      t.for_each_new_edge([&](int i, int j) { told.emplace_back(i, j); });
      std::sort(told.begin(), told.end());
      const auto after = edges(t);
      std::vector<Edge> made;
      std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                          std::back_inserter(made));
      CHECK(std::includes(told.begin(), told.end(), made.begin(), made.end()));
    }
  }
}

/// A broken contract throws and changes nothing.
/// @pre more than five sites
template <int Dim>
void check_contracts(const SiteSet<Dim>& s) {
  auto t = built(s);
  auto bad = s;
  bad.x(Dim - 1, 3) = std::numeric_limits<double>::quiet_NaN();
  bad.w[5] = std::numeric_limits<double>::infinity();
  const int n = s.size();
  const Vec<Dim> origin = Vec<Dim>::Zero();

  CHECK_THROWS_AS(t.build(s.x, Eigen::VectorXd(3)), ContractError);
  CHECK_THROWS_AS(t.build(bad.x, s.w), ContractError);
  CHECK_THROWS_AS(t.move(std::vector<int>{1, 3}, bad.x, bad.w), ContractError);
  CHECK_THROWS_AS(t.move(std::vector<int>{1, 5}, bad.x, bad.w), ContractError);
  CHECK_THROWS_AS(t.move(std::vector<int>{1, n}, s.x, s.w), ContractError);
  CHECK_THROWS_AS(t.move(std::vector<int>{-1}, s.x, s.w), ContractError);
  CHECK_THROWS_AS(t.move(std::vector<int>{1}, Columns<Dim>(Dim, 3), Eigen::VectorXd(3)),
                  ContractError);
  CHECK_THROWS_AS(t.insert(2, origin, 1), ContractError);
  CHECK_THROWS_AS(t.insert(n + 1, origin, 1), ContractError);
  CHECK_THROWS_AS(t.insert(n, bad.x.col(3), 1), ContractError);
  CHECK_THROWS_AS(t.remove(n), ContractError);

  CHECK_AS_BUILT(t, s);
  t.move(std::vector<int>{1, 4}, bad.x, bad.w);  // columns that are not moved are not read
  CHECK_AS_BUILT(t, s);
}

/// A build sorts sites at the edge of numbers, one of them far away from the others.
template <int Dim>
void check_edge_of_numbers() {
  Random random(3);
  for (const double size : {1e300, 1.0, 1e-310}) {
    CAPTURE(size);
    Columns<Dim> x(Dim, 100);
    for (double& coordinate : x.reshaped()) coordinate = random.uniform(-size, size);
    x.col(7) *= size < 1 ? 1e300 : 1e7;

    Triangulation<Dim> t;
    t.build(x, Eigen::VectorXd::Zero(100));

    CHECK(t.hidden().empty());
    CHECK(audited(t) == "");
  }
}

}  // namespace lagrain::test
