#pragma once
/// @file
/// CGAL's regular triangulation of a set of sites in the plane.

#include <lagrain/triangulation2.hpp>

#include "oracle/cgal.hpp"

#include <CGAL/Regular_triangulation_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace lagrain::test {

template <class Kernel>
using Oracle2 = CGAL::Regular_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<
                CGAL::Triangulation_vertex_base_with_info_2<
                    int, Kernel, CGAL::Regular_triangulation_vertex_base_2<Kernel>>,
                CGAL::Regular_triangulation_face_base_2<Kernel>>>;

template <class Kernel>
typename Kernel::Weighted_point_2 weighted(const SiteSet<2>& s, int i) {
  return {typename Kernel::Point_2(s.x(0, i), s.x(1, i)), s.w[i]};
}

template <class Kernel>
Answer<2> read(const Oracle2<Kernel>& oracle) {
  Answer<2> answer;
  answer.dimension = oracle.dimension();
  for (auto v = oracle.finite_vertices_begin(); v != oracle.finite_vertices_end(); ++v) {
    answer.visible.push_back(v->info());
  }
  for (auto e = oracle.finite_edges_begin(); e != oracle.finite_edges_end(); ++e) {
    answer.edges.push_back(sorted(e->first->vertex(oracle.cw(e->second))->info(),
                                  e->first->vertex(oracle.ccw(e->second))->info()));
  }
  for (auto f = oracle.finite_faces_begin(); f != oracle.finite_faces_end(); ++f) {
    answer.simplices.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  }
  sort_all(answer);
  return answer;
}

/// Ties of a set that spans the plane. An edge is certain if its dual has a length.
template <class Kernel>
void find_ties(const Oracle2<Kernel>& oracle, Answer<2>& answer) {
  for (auto e = oracle.finite_edges_begin(); e != oracle.finite_edges_end(); ++e) {
    const auto f = e->first, g = f->neighbor(e->second);
    const bool tie =
        !oracle.is_infinite(f) && !oracle.is_infinite(g) &&
        oracle.power_test(f, g->vertex(g->index(f))->point()) == CGAL::ON_ORIENTED_BOUNDARY;
    answer.ties = answer.ties || tie;
    if (tie) continue;
    answer.certain.push_back(
        sorted(f->vertex(oracle.cw(e->second))->info(), f->vertex(oracle.ccw(e->second))->info()));
  }
  std::sort(answer.certain.begin(), answer.certain.end());
}

/// One site at a time, and with a word on ties.
inline Answer<2> ask(const SiteSet<2>& s, const std::vector<int>& ids) {
  Oracle2<ExactKernel> oracle;
  for (const int i : ids) {
    const auto v = oracle.insert(weighted<ExactKernel>(s, i));
    if (v != Oracle2<ExactKernel>::Vertex_handle()) v->info() = i;
  }
  REQUIRE(oracle.is_valid());
  Answer<2> answer = read<ExactKernel>(oracle);
  if (answer.dimension == 2) find_ties<ExactKernel>(oracle, answer);
  return answer;
}

/// In an order that is good for CGAL, and without a word on ties.
inline Answer<2> ask_fast(const SiteSet<2>& s, const std::vector<int>& ids) {
  std::vector<std::pair<FastKernel::Weighted_point_2, int>> points;
  for (const int i : ids) points.emplace_back(weighted<FastKernel>(s, i), i);
  Oracle2<FastKernel> oracle;
  oracle.insert(points.begin(), points.end());
  return read<FastKernel>(oracle);
}

/// Of all sites to all triangles.
inline PowerSides power_sides(const Triangulation<2>& t, const SiteSet<2>& s,
                              const std::vector<int>& ids) {
  PowerSides sides;
  sides.tied.resize(static_cast<std::size_t>(s.size()));
  const auto test = FastKernel().power_side_of_oriented_power_circle_2_object();
  const auto point = [&](int i) { return weighted<FastKernel>(s, i); };
  t.for_each_triangle([&](int a, int b, int c) {
    const auto pa = point(a), pb = point(b), pc = point(c);
    for (const int d : ids) {
      if (d == a || d == b || d == c) continue;
      sides.add({a, b, c}, d, test(pa, pb, pc, point(d)));
    }
  });
  return sides;
}

}  // namespace lagrain::test
