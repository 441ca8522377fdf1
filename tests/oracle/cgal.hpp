// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What the comparisons with CGAL share in every dimension; cgal2.hpp and cgal3.hpp know
/// CGAL's triangulations.

#include "support/site_sets.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

namespace lagrain::test {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
// Its predicates are exact too; for large sets and for many.
using FastKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// What CGAL says.
template <int Dim>
struct Answer {
  int dimension = -1;
  std::vector<Edge> edges;                          // all, sorted
  std::vector<Edge> certain;                        // those that are there however ties are decided
  std::vector<std::array<int, Dim + 1>> simplices;  // ids of each in increasing order; sorted
  std::vector<int> visible;                         // sorted
  bool ties = false;
};

/// How sites lie to simplices that they are no vertices of, by CGAL's power test.
struct PowerSides {
  bool valid = true;       // no site is strictly in conflict with a simplex
  std::vector<char> tied;  // by id: of the site or a vertex, when the site is on the sphere

  void add(std::initializer_list<int> simplex, int site, CGAL::Sign side) {
    valid = valid && side != CGAL::ON_POSITIVE_SIDE;
    if (side != CGAL::ON_ORIENTED_BOUNDARY) return;
    tied[static_cast<std::size_t>(site)] = true;
    for (const int id : simplex) tied[static_cast<std::size_t>(id)] = true;
  }
  bool ties() const { return std::find(tied.begin(), tied.end(), true) != tied.end(); }
};

inline Edge sorted(int i, int j) { return {std::min(i, j), std::max(i, j)}; }

template <int Dim>
void sort_all(Answer<Dim>& answer) {
  std::sort(answer.visible.begin(), answer.visible.end());
  std::sort(answer.edges.begin(), answer.edges.end());
  for (auto& simplex : answer.simplices) std::sort(simplex.begin(), simplex.end());
  std::sort(answer.simplices.begin(), answer.simplices.end());
}

/// CGAL's regular triangulation in Dim dimensions: `Oracle`, its `Point`, `weighted(sites, i)`,
/// `read(oracle)`, and `find_ties(oracle, answer)` for a set that spans all dimensions.
template <int Dim, class Kernel>
struct Cgal;

/// What CGAL says when it is given one site at a time, and with a word on ties.
template <int Dim>
Answer<Dim> ask(const SiteSet<Dim>& s, const std::vector<int>& ids) {
  using Exact = Cgal<Dim, ExactKernel>;
  typename Exact::Oracle oracle;
  for (const int i : ids) {
    const auto v = oracle.insert(Exact::weighted(s, i));
    if (v != typename Exact::Oracle::Vertex_handle()) v->info() = i;
  }
  REQUIRE(oracle.is_valid());
  Answer<Dim> answer = Exact::read(oracle);
  if (answer.dimension == Dim) Exact::find_ties(oracle, answer);
  return answer;
}

/// What CGAL says when it may choose an order that is good for it, and without a word on ties.
template <int Dim>
Answer<Dim> ask_fast(const SiteSet<Dim>& s, const std::vector<int>& ids) {
  using Fast = Cgal<Dim, FastKernel>;
  std::vector<std::pair<typename Fast::Point, int>> points;
  for (const int i : ids) points.emplace_back(Fast::weighted(s, i), i);
  typename Fast::Oracle oracle;
  oracle.insert(points.begin(), points.end());
  return Fast::read(oracle);
}

}  // namespace lagrain::test
