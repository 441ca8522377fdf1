// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The dynamic regular triangulation of weighted sites in space.

#include <lagrain/moving_sites.hpp>
#include <lagrain/predicates3.hpp>
#include <lagrain/topology3.hpp>
#include <lagrain/triangulation.hpp>

#include <array>
#include <compare>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace lagrain {

template <>
struct detail::TriangulationParts<3> {
  using Site = Site3;
  using Topology = Topology3;
  static constexpr std::array<double Site3::*, 3> kAxes{&Site3::x, &Site3::y, &Site3::z};
  static constexpr std::size_t kSimplices = 7;

  static int orientation(const std::array<const Site3*, 4>& p) {
    return lagrain::orientation(*p[0], *p[1], *p[2], *p[3]);
  }
  static bool collinear(const Site3& a, const Site3& b, const Site3& c) {
    return detail::collinear(a, b, c);
  }
};

/// Triangulation<3> is the regular (weighted Delaunay) triangulation T of sites in space that move,
/// appear, vanish and change weight.
///
/// A site is a position [m] and a weight [m^2]; for spheres of radius r inflated by a skin s the
/// weight is (r + s)^2. Sites are known by ids 0, 1, ... that never change. After every public call
/// T is exactly the regular triangulation of the present sites under the tie rule of
/// predicates3.hpp; that triangulation is unique, so it does not depend on how it was reached.
/// Building, moving, inserting, removing and the list of edges are those of its base, MovingSites.
///
/// Facts that contact detection stands on:
/// - Two overlapping spheres, neither inside the other, share an edge if their point of equal power
///   on the line of centres lies in no third sphere; it is enough that no overlap exceeds 0.58 of
///   the smaller radius of its pair. (Ferrez & Liebling, 16th IMACS World Congress 2000, show it in
///   theorem 2.1 for spheres that are disjoint, and remark that slight overlaps do no harm.)
/// - A site is *hidden* when its cell is empty: others cover it. Hidden sites are kept, tried again
///   after every update, and listed by hidden().
///
/// How a move works. This is step 5 of the paper's scheme, "update T with local operations",
/// which it leaves open. The flips 2-3, 3-2 and 4-4 are Joe's (Comput. Aided Geom. Des. 8 (1991)
/// 123). In space they alone do not do it: slivers turn inside out under tiny moves, and flips
/// can get stuck. What is done then is ours. Each step is checked, and what it leaves is taken up
/// by the next:
/// 1. Put the moved sites in place. Most tetrahedra that are now inverted go away by one flip that
///    makes positive ones only (2-3, 3-2, 4-4; so do the flat ones under a wall). If some stay, the
///    flips are undone, a cover of the rest by moved sites is taken out at the old places, where T
///    is regular, and step 1 begins again.
/// 2. Flip facets that are not locally regular: 2-3, 3-2, 4-4, and 4-1 for sites that are hidden
///    now. Each flip lowers the lifted surface, so this ends.
/// 3. Where a facet stays that cannot be flipped, the tetrahedra around it are triangulated anew,
///    as few as possible: the regular triangulation of their sites replaces them if their boundary
///    is one sphere and it holds that, else the cavity grows by one ring.
/// 4. Positive tetrahedra and a hull that goes round once make a triangulation; with all facets
///    locally regular it is the regular one. If any of this fails, build anew.
/// 5. Insert what was taken out, and try the hidden sites.
/// A site is taken out by flips as well, in an order that leaves T regular; where they get stuck,
/// the regular triangulation of its neighbours fills its star.
///
/// Why flips may be trusted while tetrahedra are inverted: T, the vertex at infinity included, maps
/// a 3-sphere onto a 3-sphere. Moving sites changes this map, but not how many times it covers
/// space: once. Nor does the exchange of a ball of tetrahedra for another with the same boundary.
/// (Where the hull takes part it may, and the times are counted.) Positive tetrahedra cannot
/// cancel, so as soon as all are positive every point lies in one of them. An infinite tetrahedron
/// counts as positive if it does not see a fixed point in the middle.
///
/// Until then T may be folded: two tetrahedra may overlap, two edges may join the same two sites,
/// and the stars of some sites together need be no ball. Nothing here stands on the contrary.
///
/// Representation: Topology3, two copies of the places and a list of edges, about 300 bytes per
/// site. Flat sets (dimension() < 3), sets so thin that rounding finds no point inside, and sets
/// with fewer than kTiny visible sites are built anew at every change.
///
/// Limits: coordinates between 1e-60 and 1e60 in size go fast, others through exact arithmetic; not
/// safe for use from several threads, for_each_neighbour included (it keeps scratch).
template <>
class Triangulation<3> : public detail::MovingSites<3> {
 public:
  /// Below this number of visible sites an update builds anew, which is no rung of the ladder. Such
  /// a build takes 16 us at most, so half or twice the number makes no difference.
  static constexpr int kTiny = 16;

  /// Calls f(a, b, c, d) for each tetrahedron, positive; for none if dimension() < 3.
  template <class F>
  void for_each_tetrahedron(F&& f) const {
    if (dimension_ < 3) return;
    for (int t = 0; t < topology_.slots(); ++t) {
      const auto& v = topology_.vertices(t);
      if ((v[0] | v[1] | v[2] | v[3]) >= 0) f(v[0], v[1], v[2], v[3]);
    }
  }

  /// Calls f(j) for each site that shares an edge with the site, j increasing; for none if it is
  /// hidden or not present.
  template <class F>
  void for_each_neighbour(int site, F&& f) const {
    if (!contains(site) || topology_.corner_of(site) < 0) return;
    topology_.star(site, star_);
    neighbours_.clear();
    collect_vertices(star_, neighbours_);
    for (const int j : neighbours_) {
      if (j != site && j < size_) f(j);
    }
  }

 private:
  friend class detail::MovingSites<3>;
  friend struct AuditProbe;
  using Quad = Topology3::Quad;

  /// A member that its owner's copies begin without.
  template <class T>
  struct NotCopied {
    NotCopied() = default;
    NotCopied(const NotCopied&) {}
    NotCopied(NotCopied&&) noexcept = default;
    NotCopied& operator=(const NotCopied&) { return *this; }
    NotCopied& operator=(NotCopied&&) noexcept = default;
    std::unique_ptr<T> held;
  };
  /// What undoes a flip.
  struct Flip {
    std::array<Quad, 4> quads;
    std::array<int, 4> made;
    int quad_count;
    int made_count;
  };
  /// A facet on the boundary of a cavity, seen from inside.
  struct CavityFacet {
    std::array<int, 3> sites;  // numbers in the small triangulation, least first, in turn
    int outside;               // corner beyond
    int inside;                // corner found in the small triangulation
  };

  /// A tetrahedron that one flip may cut off the star of a site: see flip_out.
  struct Ear {
    bool infinite;  // these go last
    double key;     // in increasing order
    int corner;     // at the facet between the two cells of the star
    auto operator<=>(const Ear&) const = default;
  };

  // Decisions (update3.cpp).
  int sign(const Quad& quad) const;
  bool positive(int cell) const { return sign(topology_.vertices(cell)) > 0; }
  bool conflict(int cell, int site) const;
  bool locally_regular(int corner) const;
  static int side_from(std::span<const Site3> middle, const Site3& a, const Site3& b,
                       const Site3& c);
  bool hull_goes_round_once(std::span<const Site3> middle) const;
  bool tiny() const { return dimension_ < 3 || thin_ || visible_sites() < kTiny; }
  int locate(int site, int hint) const;
  int finite_neighbour(int site) const;
  void choose_middle();
  void choose_middle_at_rest();
  bool sees_whole_hull() const;
  void collect_vertices(std::span<const int> corners, std::vector<int>& vertices) const;

  // Audit (audit3.cpp).
  void audit_simplices(std::vector<Defect>& defects) const;
  void audit_sphere(std::vector<Defect>& defects) const;
  void audit_hull(std::vector<Defect>& defects) const;

  // Steps of an update (update3.cpp).
  void rebuild();
  bool repair();
  bool exchange(std::span<const int> in, std::span<const Quad> out);
  bool flip_facet(int corner);
  bool flip_edge(int corner, int other, int cells);
  bool flip_vertex(int corner);
  bool resolve(int corner);
  bool resolve_inverted(int cell);
  void undo_flips();
  bool unstick(int corner);
  void unpinch(std::vector<int>& cavity);
  bool flip_to_regular();
  void collect_around(std::span<const int> moved);
  void list_inverted();
  void see_hull_again();
  bool extract_inverted();
  bool insert_visible(int site);
  void note_edges_of_insertion(int site);
  void find_edges(EdgeList& list) const;

  // Cavities (refill3.cpp).
  bool refill(std::span<const int> hole, std::span<const int> sites, const Site3* away);
  Triangulation& triangulate_alone(std::span<const int> sites, const Site3* away);
  void list_facets(std::span<const int> hole, std::span<const int> sites);
  bool facets_form_sphere(int count);
  bool find_facets(Triangulation& small);
  bool list_inside(Triangulation& small);
  bool keeps_vertices(const Triangulation& small, std::span<const int> hole);
  bool has_volume(const Triangulation& small) const;
  void copy_inside(const Triangulation& small, std::span<const int> hole,
                   std::span<const int> sites);

  // Taking out (take_out3.cpp).
  bool take_out_at_rest(int site);
  bool take_out(int site);
  bool flip_out(int site);
  void list_ears(int at);
  Ear ear_at(int corner, int site) const;
  bool flip_last(int site);

  Site3 middle_{};     // strictly within the hull
  bool thin_ = false;  // unless rounding finds no such point

  // Scratch of an update.
  bool logging_ = false;  // flips go to log_
  std::vector<Flip> log_;
  std::vector<Ear> ears_;  // a heap
  std::vector<int> around_, unresolved_, cavity_, cavity_sites_, inside_;
  std::vector<CavityFacet> facets_;
  std::vector<std::pair<std::pair<int, int>, int>> facet_edges_;  // ends, facet
  std::vector<int> part_of_facet_;
  std::vector<char> vertex_seen_;  // of vertex v at v + 1
  std::vector<int> facet_table_;
  NotCopied<Triangulation<3>> small_;
  mutable std::vector<int> star_, neighbours_, vertex_note_;
};

static_assert(RegularTriangulation<Triangulation<3>, 3>);

}  // namespace lagrain
