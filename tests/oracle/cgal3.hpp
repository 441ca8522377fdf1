// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// CGAL's regular triangulation of a set of sites in space.

#include <lagrain/triangulation3.hpp>

#include "oracle/cgal.hpp"

#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <vector>

namespace lagrain::test {

template <class Kernel>
struct Cgal<3, Kernel> {
  using Oracle = CGAL::Regular_triangulation_3<
      Kernel, CGAL::Triangulation_data_structure_3<
                  CGAL::Triangulation_vertex_base_with_info_3<
                      int, Kernel, CGAL::Regular_triangulation_vertex_base_3<Kernel>>,
                  CGAL::Regular_triangulation_cell_base_3<Kernel>>>;
  using Point = typename Kernel::Weighted_point_3;

  static Point weighted(const SiteSet<3>& s, int i) {
    return {typename Kernel::Point_3(s.x(0, i), s.x(1, i), s.x(2, i)), s.w[i]};
  }

  static Answer<3> read(const Oracle& oracle) {
    Answer<3> answer;
    answer.dimension = oracle.dimension();
    for (auto v = oracle.finite_vertices_begin(); v != oracle.finite_vertices_end(); ++v) {
      answer.visible.push_back(v->info());
    }
    for (auto e = oracle.finite_edges_begin(); e != oracle.finite_edges_end(); ++e) {
      answer.edges.push_back(
          sorted(e->first->vertex(e->second)->info(), e->first->vertex(e->third)->info()));
    }
    for (auto c = oracle.finite_cells_begin(); c != oracle.finite_cells_end(); ++c) {
      answer.simplices.push_back(
          {c->vertex(0)->info(), c->vertex(1)->info(), c->vertex(2)->info(), c->vertex(3)->info()});
    }
    sort_all(answer);
    return answer;
  }

  /// Ties of a set that spans space. An edge is certain if its dual has an area: it runs through
  /// more than two power centres, where a ray to infinity counts as one.
  static void find_ties(const Oracle& oracle, Answer<3>& answer) {
    using Cell = typename Oracle::Cell_handle;
    const auto power_side = Kernel().power_side_of_oriented_power_sphere_3_object();
    const auto orientation_of = Kernel().orientation_3_object();
    enum class Pair { different, tied, tied_on_hull };
    // Do a cell and its neighbour have one power centre, or is their ray the same?
    const auto compare = [&](Cell c, int i) {
      const auto d = c->neighbor(i);
      const bool c_out = oracle.is_infinite(c), d_out = oracle.is_infinite(d);
      if (c_out != d_out) return Pair::different;
      std::vector<typename Kernel::Weighted_point_3> p;
      for (int k = 0; k < 4; ++k) {
        if (!oracle.is_infinite(c->vertex(k))) p.push_back(c->vertex(k)->point());
      }
      const auto q = d->vertex(d->index(c))->point();
      if (!c_out) {
        return power_side(p[0], p[1], p[2], p[3], q) == CGAL::ON_ORIENTED_BOUNDARY
                   ? Pair::tied
                   : Pair::different;
      }
      const bool flat =
          orientation_of(p[0].point(), p[1].point(), p[2].point(), q.point()) == CGAL::COPLANAR;
      return flat && power_side(p[0], p[1], p[2], q) == CGAL::ON_ORIENTED_BOUNDARY
                 ? Pair::tied_on_hull
                 : Pair::different;
    };
    for (auto e = oracle.finite_edges_begin(); e != oracle.finite_edges_end(); ++e) {
      auto c = oracle.incident_cells(*e);
      const auto first = c;
      int different = 0;
      bool area = true;  // two rays on one line have none between them
      do {
        const Cell now = c;
        ++c;
        const Pair pair = compare(now, now->index(Cell(c)));
        answer.ties = answer.ties || pair != Pair::different;
        area = area && pair != Pair::tied_on_hull;
        different += pair == Pair::different;
      } while (c != first);
      if (area && different > 2) {
        answer.certain.push_back(
            sorted(e->first->vertex(e->second)->info(), e->first->vertex(e->third)->info()));
      }
    }
    std::sort(answer.certain.begin(), answer.certain.end());
  }
};

/// How all sites lie to all tetrahedra.
inline PowerSides power_sides(const Triangulation<3>& t, const SiteSet<3>& s,
                              const std::vector<int>& ids) {
  PowerSides sides;
  sides.tied.resize(static_cast<std::size_t>(s.size()));
  const auto test = FastKernel().power_side_of_oriented_power_sphere_3_object();
  const auto point = [&](int i) { return Cgal<3, FastKernel>::weighted(s, i); };
  t.for_each_tetrahedron([&](int a, int b, int c, int d) {
    const auto pa = point(a), pb = point(b), pc = point(c), pd = point(d);
    for (const int e : ids) {
      if (e == a || e == b || e == c || e == d) continue;
      sides.add({a, b, c, d}, e, test(pa, pb, pc, pd, point(e)));
    }
  });
  return sides;
}

}  // namespace lagrain::test
