// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The dynamic regular triangulation of weighted sites in the plane.

#include <lagrain/moving_sites.hpp>
#include <lagrain/predicates2.hpp>
#include <lagrain/topology2.hpp>
#include <lagrain/triangulation.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lagrain {

template <>
struct detail::TriangulationParts<2> {
  using Site = Site2;
  using Topology = Topology2;
  static constexpr std::array<double Site2::*, 2> kAxes{&Site2::x, &Site2::y};
  static constexpr std::size_t kSimplices = 2;

  static int orientation(const std::array<const Site2*, 3>& p) {
    return lagrain::orientation(*p[0], *p[1], *p[2]);
  }
  static bool collinear(const Site2& a, const Site2& b, const Site2& c) {
    return lagrain::orientation(a, b, c) == 0;
  }
};

/// Triangulation<2> is the regular (weighted Delaunay) triangulation T of sites in the plane that
/// move, appear, vanish and change weight.
///
/// A site is a position [m] and a weight [m^2]; for discs of radius r inflated by a skin s the
/// weight is (r + s)^2. Sites are known by ids 0, 1, ... that never change. After every public call
/// T is exactly the regular triangulation of the present sites under the tie rule of
/// predicates2.hpp; that triangulation is unique, so it does not depend on how it was reached.
/// Building, moving, inserting, removing and the list of edges are those of its base, MovingSites.
///
/// Facts that contact detection stands on:
/// - Two overlapping discs, neither inside the other, share an edge if their point of equal power
///   on the line of centres lies in no third disc; it is enough that no overlap exceeds 0.58 of the
///   smaller radius of its pair. (Ferrez & Liebling, 16th IMACS World Congress 2000, show it in
///   theorem 2.1 for discs that are disjoint, and remark that slight overlaps do no harm.)
/// - A site is *hidden* when its cell is empty: others cover it. Hidden sites are kept, tried again
///   after every update, and listed by hidden().
///
/// How a move works. This is step 5 of the paper's scheme, "update T with local operations",
/// which it leaves open. Flipping edges is due to Lawson (Mathematical Software III (1977) 161);
/// what to do where sites moved so far that T is no triangulation any more, and where flips get
/// stuck, is ours:
/// 1. Put the moved sites in place. Triangles that turned inside out would spoil the triangulation,
///    so a cover of them by moved sites is first taken out at the old places.
/// 2. Flip edges that are not locally regular. Edges to the infinite vertex follow the same rule,
///    so the hull needs no code of its own. An edge that cannot be flipped has a reflex end, which
///    is hidden by the three other sites: it is taken out (in the plane this is the whole remedy).
/// 3. Positive triangles and a convex hull that goes round once make a triangulation; with all
///    edges locally regular it is the regular one. If the hull fails the test, build anew.
/// 4. Insert what was taken out, and try the hidden sites.
///
/// Representation: Topology2, two copies of the places and a list of edges, about 150 bytes per
/// site. Sets with fewer than kTiny visible sites, and sets on one line (dimension() < 2), are
/// built anew at every change.
///
/// Limits: coordinates of a size that products of four do not overflow go fast, others through
/// exact arithmetic; not safe for writing from several threads.
template <>
class Triangulation<2> : public detail::MovingSites<2> {
 public:
  /// Below this number of visible sites an update builds anew, which is no rung of the ladder. Such
  /// a build takes 3 us at most, so half or twice the number makes no difference.
  static constexpr int kTiny = 8;

  /// Calls f(a, b, c) for each finite triangle, counter-clockwise; for none if dimension() < 2.
  template <class F>
  void for_each_triangle(F&& f) const {
    if (dimension_ < 2) return;
    for (int t = 0; t < topology_.slots(); ++t) {
      const auto v = topology_.vertices(t);
      if ((v[0] | v[1] | v[2]) >= 0) f(v[0], v[1], v[2]);
    }
  }

  /// Calls f(j) for each site that shares an edge with the site, counter-clockwise; for none if it
  /// is hidden or not present.
  template <class F>
  void for_each_neighbour(int site, F&& f) const {
    if (!contains(site) || topology_.corner_of(site) < 0) return;
    topology_.for_each_corner(site, [&](int at) {
      const int neighbour = topology_.source(at);
      if (neighbour >= 0 && neighbour < size_) f(neighbour);
    });
  }

 private:
  friend class detail::MovingSites<2>;
  friend struct AuditProbe;

  // Audit (audit2.cpp).
  void audit_simplices(std::vector<Defect>& defects) const;
  void audit_sphere(std::vector<Defect>& defects) const;

  // Decisions (update2.cpp).
  std::array<int, 3> corners_of(int triangle) const {
    const auto v = topology_.vertices(triangle);
    return {v[0], v[1], v[2]};
  }
  bool positive(const Site2* places, int a, int b, int c) const;
  bool conflict(int triangle, int site) const;
  bool locally_regular(int corner) const;
  bool hull_goes_round_once() const;
  bool tiny() const { return dimension_ < 2 || visible_sites() < kTiny; }
  int reflex_end(int corner) const;
  int finite_neighbour(int site) const;
  int crossed_hull_edge(int triangle) const;
  int locate(int site, int hint) const;

  // Steps of an update (update2.cpp).
  void rebuild() { rebuild_by_insertion(); }
  bool repair();
  void flip(int corner);
  bool resolve(int corner);
  int take_out_degree3(int site);
  bool unstick(int corner);
  bool flip_to_regular(std::span<const int> moved, bool sweep);
  bool remove_by_flips(int site, const Site2* places);
  bool take_out_at_rest(int site);
  void close_hull(std::size_t first, const Site2* places);
  bool extract_inverted(std::span<const int> moved, bool sweep);
  void choose_folded();
  bool insert_visible(int site);
  void find_edges(EdgeList& list) const;

  // Scratch of an update.
  std::vector<int> ring_, spokes_;
};

static_assert(RegularTriangulation<Triangulation<2>, 2>);

}  // namespace lagrain
