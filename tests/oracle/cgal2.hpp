// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// CGAL's regular triangulation of a set of sites in the plane.

#include <lagrain/triangulation2.hpp>

#include "oracle/cgal.hpp"

#include <CGAL/Regular_triangulation_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <vector>

namespace lagrain::test {

template <class Kernel>
struct Cgal<2, Kernel> {
  using Oracle = CGAL::Regular_triangulation_2<
      Kernel, CGAL::Triangulation_data_structure_2<
                  CGAL::Triangulation_vertex_base_with_info_2<
                      int, Kernel, CGAL::Regular_triangulation_vertex_base_2<Kernel>>,
                  CGAL::Regular_triangulation_face_base_2<Kernel>>>;
  using Point = typename Kernel::Weighted_point_2;

  static Point weighted(const SiteSet<2>& s, int i) {
    return {typename Kernel::Point_2(s.x(0, i), s.x(1, i)), s.w[i]};
  }

  static Answer<2> read(const Oracle& oracle) {
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
      answer.simplices.push_back(
          {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    }
    sort_all(answer);
    return answer;
  }

  /// Ties of a set that spans the plane. An edge is certain if its dual has a length.
  static void find_ties(const Oracle& oracle, Answer<2>& answer) {
    for (auto e = oracle.finite_edges_begin(); e != oracle.finite_edges_end(); ++e) {
      const auto f = e->first, g = f->neighbor(e->second);
      const bool tie =
          !oracle.is_infinite(f) && !oracle.is_infinite(g) &&
          oracle.power_test(f, g->vertex(g->index(f))->point()) == CGAL::ON_ORIENTED_BOUNDARY;
      answer.ties = answer.ties || tie;
      if (tie) continue;
      answer.certain.push_back(sorted(f->vertex(oracle.cw(e->second))->info(),
                                      f->vertex(oracle.ccw(e->second))->info()));
    }
    std::sort(answer.certain.begin(), answer.certain.end());
  }
};

/// How all sites lie to all triangles.
inline PowerSides power_sides(const Triangulation<2>& t, const SiteSet<2>& s,
                              const std::vector<int>& ids) {
  PowerSides sides;
  sides.tied.resize(static_cast<std::size_t>(s.size()));
  const auto test = FastKernel().power_side_of_oriented_power_circle_2_object();
  const auto point = [&](int i) { return Cgal<2, FastKernel>::weighted(s, i); };
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
