#pragma once
/// @file
/// The dynamic regular triangulation of weighted sites in space.

#include <lagrain/predicates3.hpp>
#include <lagrain/topology3.hpp>
#include <lagrain/triangulation.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Core>

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

/// Regular (weighted Delaunay) triangulation of sites in space that move, appear, vanish and change
/// weight.
///
/// A site is a position [m] and a weight [m^2]; for spheres of radius r inflated by a skin s the
/// weight is (r + s)^2. Sites are known by ids 0, 1, ... that never change. After every public call
/// T is exactly the regular triangulation of the present sites under the tie rule of
/// predicates3.hpp; that triangulation is unique, so it does not depend on how it was reached.
///
/// Facts that contact detection stands on:
/// - Two overlapping spheres, neither inside the other, share an edge if their point of equal power
///   on the line of centres lies in no third sphere; it is enough that no overlap exceeds 0.58 of
///   the smaller radius of its pair.
/// - A site is *hidden* when its cell is empty: others cover it. Hidden sites are kept, tried again
///   after every update, and listed by hidden().
///
/// How a move works. In space flips alone do not do it: slivers turn inside out under tiny moves,
/// and flips can get stuck. So each step is checked, and what it leaves is taken up by the next:
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
/// Representation: Topology3, about 300 bytes per site. Flat sets are legal: a set of dimension() k
/// < 3 is joined to 3 - k auxiliary sites outside it. The cone over a regular triangulation is
/// regular wherever its apex is, so no test and no flip needs a case of its own. Such sets, sets so
/// thin that rounding finds no point inside, and sets with fewer than kTiny visible sites are built
/// anew at every change.
///
/// Limits: coordinates between 1e-60 and 1e60 in size go fast, others through exact arithmetic; not
/// safe for use from several threads, for_each_neighbour included (it keeps scratch).
template <>
class Triangulation<3> {
 public:
  /// Something wrong that audit() found.
  struct Defect {
    int simplex;               ///< tetrahedron, or -1
    std::array<int, 4> sites;  ///< sites concerned, -1 for none
    std::string sentence;
  };

  /// Below this number of visible sites an update builds anew, which is no rung of the ladder.
  static constexpr int kTiny = 16;

  /// Builds from nothing; forgets all former sites.
  /// @param sites    3 x N positions [m], site i in column i
  /// @param weights  N weights [m^2]
  /// @throws ContractError if sizes differ or a number is not finite; nothing has changed then
  void build(const Columns<3>& sites, const Eigen::VectorXd& weights);

  /// Gives the sites listed in `moved` new places and weights; the other columns are not read.
  /// @param moved    ids of present sites, any order, repetitions allowed
  /// @param sites    3 x size() positions [m]
  /// @param weights  size() weights [m^2]
  /// @throws ContractError as build(), or if an id is not present; nothing has changed then
  UpdateReport move(std::span<const int> moved, const Columns<3>& sites,
                    const Eigen::VectorXd& weights);

  /// Adds a site under an id that is not present: a removed one, or size(), which appends.
  UpdateReport insert(int id, const Vec<3>& position, double weight);

  /// Takes a present site out. Its id stays reserved and may be inserted again.
  UpdateReport remove(int id);

  /// Number of ids, removed ones included.
  int size() const { return size_; }
  /// True unless the id was removed (or never used).
  bool contains(int id) const;
  /// -1 empty, 0 one place, 1 one line, 2 one plane, 3 otherwise; hidden sites count only as they
  /// are needed to tell.
  int dimension() const { return dimension_; }
  Vec<3> site(int id) const {
    const Site3& s = sites_[index(id)];
    return {s.x, s.y, s.z};
  }
  double weight(int id) const { return sites_[index(id)].w; }
  /// Present sites without a cell, in increasing order.
  std::span<const int> hidden() const { return hidden_; }

  /// The edges, sorted.
  std::span<const EdgeList::Edge> edges() const { return edges_.all(); }

  /// Calls f(i, j) once for each edge, i < j, in increasing order.
  template <class F>
  void for_each_edge(F&& f) const {
    for (const auto& [i, j] : edges()) f(i, j);
  }

  /// Calls f(i, j), i < j, for each edge that the last update made: maybe more than once, and maybe
  /// for edges that it took away again; for all edges if there is no telling.
  template <class F>
  void for_each_new_edge(F&& f) const {
    edges_.for_each_new(f);
  }

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

  /// Checks everything again, exactly; empty means valid. Each defect names simplex and sites.
  std::vector<Defect> audit() const;

 private:
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

  static constexpr int kRings = 4;  ///< cavities wider than this are not tried

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  // Decisions (update3.cpp).
  int sign(const Quad& quad) const;
  bool positive(int cell) const { return sign(topology_.vertices(cell)) > 0; }
  bool conflict(int cell, int site) const;
  bool locally_regular(int corner) const;
  static int side_from(std::span<const Site3> middle, const Site3& a, const Site3& b,
                       const Site3& c);
  bool hull_goes_round_once(std::span<const Site3> middle) const;
  bool tiny() const;
  bool moved_place(int id) const;
  int visible_from(int site) const;
  int locate(int site, int hint) const;
  int finite_neighbour(int site) const;
  void choose_middle();
  void choose_middle_at_rest();
  bool sees_whole_hull() const;
  void collect_vertices(std::span<const int> corners, std::vector<int>& vertices) const;

  // Audit (audit3.cpp).
  template <class Report, class ReportCell>
  void audit_cells(Report&& report, ReportCell&& report_cell) const;
  template <class Report>
  void audit_hull(Report&& report) const;

  // Build and cavities (build3.cpp).
  void rebuild();
  void find_edges(EdgeList& list) const;
  void insert_all(std::span<const int> order, const Site3* away);
  int span_of(std::span<const int> sites, Quad& simplex) const;
  void sort_cells(const std::vector<int>& site_order);
  void first_simplex(const Quad& simplex);
  void place_auxiliaries(Quad& simplex, const Site3* away);
  bool insert_visible(int site);
  void note_edges_of_insertion(int site);
  bool refill(std::span<const int> hole, std::span<const int> sites, const Site3* away);
  bool facets_form_sphere(int count);
  bool take_out(int site);
  bool flip_out(int site);
  void list_ears(int at);
  Ear ear_at(int corner, int site) const;
  bool flip_last(int site);
  void hide(int site, int hint);

  // Steps of an update (update3.cpp).
  void push(int corner);
  void push_cell(int cell);
  bool exchange(std::span<const int> in, std::span<const Quad> out);
  bool flip_facet(int corner);
  bool flip_edge(int corner, int other, int cells);
  bool flip_vertex(int corner);
  bool resolve(int corner);
  bool resolve_inverted(int cell);
  void undo_flips();
  std::int64_t most_flips() const;
  bool drain();
  bool settle();
  bool refill_around(int corner);
  void unpinch(std::vector<int>& cavity);
  bool flip_to_regular();
  static void sort_unique(std::vector<int>& list);
  void collect_around(std::span<const int> moved);
  bool extract_inverted();
  bool choose_cover(std::span<const int> cells);
  void try_hidden();
  void begin();
  UpdateReport finish();
  void expect_valid() const;

  int size_ = 0;
  std::vector<Site3> sites_;    // by id, then room for three auxiliary sites
  std::vector<Site3> before_;   // the same at rest; during a move the places before it
  mutable Topology3 topology_;  // corner_of(site): corner, or a note (see hide); marks are scratch
  std::vector<int> hidden_;     // sorted at rest
  int present_ = 0;
  int dimension_ = -1;
  Site3 middle_{};     // strictly within the hull
  bool thin_ = false;  // unless rounding finds no such point

  EdgeList edges_;

  // Scratch of an update, kept so that a small update costs nothing that grows with size().
  UpdateReport report_;
  std::int64_t budget_ = 0;     // of flips
  bool hull_touched_ = false;   // the hull has to be checked
  bool logging_ = false;        // flips go to log_
  int last_ = 0;                // inserted last: where to start looking for the next
  std::vector<int> site_note_;  // by id, zero between uses
  std::vector<Flip> log_;
  std::vector<Ear> ears_;           // a heap
  std::vector<int> queue_, stuck_;  // facets to be looked at, facets that would not flip
  std::vector<int> moved_, around_, inverted_, unresolved_, cover_, touched_;
  std::vector<int> hole_, rim_, cavity_, cavity_sites_, inside_, pending_;
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
