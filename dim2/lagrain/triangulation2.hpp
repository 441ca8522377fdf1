#pragma once
/// @file
/// The dynamic regular triangulation of weighted sites in the plane.

#include <lagrain/predicates2.hpp>
#include <lagrain/topology2.hpp>
#include <lagrain/triangulation.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lagrain {

/// Regular (weighted Delaunay) triangulation of sites that move, appear, vanish and change weight.
///
/// A site is a position [m] and a weight [m^2]; for discs of radius r inflated by a skin s the
/// weight is (r + s)^2. Sites are known by ids 0, 1, ... that never change. After every public call
/// T is exactly the regular triangulation of the present sites under the tie rule of
/// predicates2.hpp; that triangulation is unique, so it does not depend on how it was reached.
///
/// Facts that contact detection stands on:
/// - Two overlapping discs, neither inside the other, share an edge if their point of equal power
///   on the line of centres lies in no third disc; it is enough that no overlap exceeds 0.58 of the
///   smaller radius of its pair.
/// - A site is *hidden* when its cell is empty: others cover it. Hidden sites are kept, tried again
/// after
///   every update, and listed by hidden().
///
/// How a move works (Ferrez & Liebling, 16th IMACS World Congress 2000, leave the details open):
/// 1. Put the moved sites in place. Triangles that turned inside out would spoil the triangulation,
/// so
///    a cover of them by moved sites is first taken out at the old places.
/// 2. Flip edges that are not locally regular. Edges to the infinite vertex follow the same rule,
///    so the hull needs no code of its own. An edge that cannot be flipped has a reflex end, which
///    is hidden by the three other sites: it is taken out (in the plane this is the whole remedy).
/// 3. Positive triangles and a convex hull that goes round once make a triangulation; with all
/// edges
///    locally regular it is the regular one. If the hull fails the test, build anew.
/// 4. Insert what was taken out, and try the hidden sites.
///
/// Representation: Topology2 and a list of edges, about 150 bytes per site with two copies of the
/// places. Sets on one
/// line are legal (dimension() < 2): a sorted list, made anew at every change. Sets with fewer than
/// kTiny visible sites are made anew as well.
///
/// Limits: coordinates of a size that products of four do not overflow go fast, others through
/// exact arithmetic; not safe for writing from several threads.
template <>
class Triangulation<2> {
 public:
  /// Something wrong that audit() found.
  struct Defect {
    int simplex;               ///< triangle, or -1
    std::array<int, 3> sites;  ///< sites concerned, -1 for none
    std::string sentence;
  };

  /// Below this number of visible sites an update builds anew, which is no rung of the ladder.
  static constexpr int kTiny = 8;

  /// Builds from nothing; forgets all former sites.
  /// @param sites    2 x N positions [m], site i in column i
  /// @param weights  N weights [m^2]
  /// @throws ContractError if sizes differ or a number is not finite; nothing has changed then
  void build(const Columns<2>& sites, const Eigen::VectorXd& weights);

  /// Gives the sites listed in `moved` new places and weights; the other columns are not read.
  /// @param moved    ids of present sites, any order, repetitions allowed
  /// @param sites    2 x size() positions [m]
  /// @param weights  size() weights [m^2]
  /// @throws ContractError as build(), or if an id is not present; nothing has changed then
  UpdateReport move(std::span<const int> moved, const Columns<2>& sites,
                    const Eigen::VectorXd& weights);

  /// Adds a site under an id that is not present: a removed one, or size(), which appends.
  UpdateReport insert(int id, const Vec<2>& position, double weight);

  /// Takes a present site out. Its id stays reserved and may be inserted again.
  UpdateReport remove(int id);

  /// Number of ids, removed ones included.
  int size() const { return static_cast<int>(sites_.size()); }
  /// True unless the id was removed (or never used).
  bool contains(int id) const;
  /// -1 empty, 0 one place, 1 one line, 2 otherwise; hidden sites do not count.
  int dimension() const { return dimension_; }
  Vec<2> site(int id) const { return {sites_[index(id)].x, sites_[index(id)].y}; }
  double weight(int id) const { return sites_[index(id)].w; }
  /// Present sites without a cell, in increasing order.
  std::span<const int> hidden() const { return hidden_; }

  /// The finite edges, sorted.
  std::span<const EdgeList::Edge> edges() const { return edges_.all(); }

  /// Calls f(i, j) once for each finite edge, i < j, in increasing order.
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

  /// Calls f(a, b, c) for each finite triangle, counter-clockwise.
  template <class F>
  void for_each_triangle(F&& f) const {
    for (int t = 0; t < topology_.slots(); ++t) {
      const auto v = topology_.vertices(t);
      if ((v[0] | v[1] | v[2]) >= 0) f(v[0], v[1], v[2]);
    }
  }

  /// Calls f(j) for each site that shares an edge with the site, counter-clockwise; for none if it
  /// is hidden or not present.
  template <class F>
  void for_each_neighbour(int site, F&& f) const {
    const int corner = contains(site) ? topology_.corner_of(site) : Topology2::kNone;
    if (corner < 0) return;
    if (dimension_ < 2) {
      const auto k = index(corner);
      if (k > 0) f(line_[k - 1]);
      if (k + 1 < line_.size()) f(line_[k + 1]);
      return;
    }
    topology_.for_each_corner(site, [&](int at) {
      const int neighbour = topology_.source(at);
      if (neighbour >= 0) f(neighbour);
    });
  }

  /// Checks everything again, exactly; empty means valid. Each defect names simplex and sites.
  std::vector<Defect> audit() const;

 private:
  friend struct AuditProbe;
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  // Audit (audit2.cpp).
  template <class Report>
  void audit_line(Report&& report) const;
  template <class Report, class ReportTriangle>
  void audit_triangles(Report&& report, ReportTriangle&& report_triangle) const;

  // Build (build2.cpp).
  void rebuild();
  void rebuild_line(const std::vector<int>& present);
  void rebuild_plane(const std::vector<int>& present);
  void find_edges(EdgeList& list) const;

  // Decisions (update2.cpp).
  std::array<int, 3> corners_of(int triangle) const {
    const auto v = topology_.vertices(triangle);
    return {v[0], v[1], v[2]};
  }
  bool moved_place(int id) const {
    return id >= 0 && (sites_[index(id)].x != before_[index(id)].x ||
                       sites_[index(id)].y != before_[index(id)].y);
  }
  bool positive(const Site2* places, int a, int b, int c) const;
  bool conflict(int triangle, int site) const;
  bool locally_regular(int corner) const;
  bool hull_goes_round_once() const;
  bool tiny() const;
  int reflex_end(int corner) const;
  int finite_neighbour(int site) const;
  int crossed_hull_edge(int triangle) const;
  int visible_from(int site) const;
  int locate(int site, int hint) const;

  // Steps of an update (update2.cpp).
  int next_epoch();
  void hide(int site, int hint);
  void push(int corner);
  void push_triangle(int triangle);
  void flip(int corner);
  bool resolve(int corner);
  int take_out_degree3(int site);
  bool drain();
  bool settle();
  bool flip_to_regular(std::span<const int> moved, bool sweep);
  bool remove_by_flips(int site, const Site2* places);
  void close_hull(std::size_t first, const Site2* places);
  bool extract_inverted(std::span<const int> moved, bool sweep);
  void choose_cover(std::span<const int> triangles);
  void choose_folded();
  bool insert_visible(int site);
  void try_hidden();
  void begin();
  UpdateReport finish();
  void expect_valid() const;

  std::vector<Site2> sites_;   // by id
  std::vector<Site2> before_;  // the same at rest; during a move the places before it
  Topology2 topology_;         // corner_of(site): corner, or place in line_, or a note (see hide)
  std::vector<int> line_;    // visible sites in order along the line if dimension_ < 2, else empty
  std::vector<int> hidden_;  // sorted at rest
  EdgeList edges_;
  int present_ = 0;
  int dimension_ = -1;

  // Scratch of an update, kept so that a small update costs nothing that grows with size().
  UpdateReport report_;
  std::int64_t budget_ = 0;         // of flips, far above any need
  bool hull_touched_ = false;       // the hull has to be checked
  int last_ = 0;                    // inserted last: where to start looking for the next
  int epoch_ = 0;                   // marks of triangles and sites count if they equal it
  std::vector<int> site_epoch_;     // by id
  std::vector<int> site_count_;     // by id, zero outside choose_cover
  std::vector<int> queue_, stuck_;  // edges to be looked at, edges that would not flip
  std::vector<int> moved_, inverted_, cover_, touched_;
  std::vector<int> ring_, spokes_, hole_, rim_, pending_;
};

static_assert(RegularTriangulation<Triangulation<2>, 2>);

}  // namespace lagrain
