// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What the dynamic regular triangulations of the plane and of space share: their sites, and the
/// order of the steps of an update.

#include <lagrain/edge_list.hpp>
#include <lagrain/triangulation.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lagrain::detail {

/// The parts of a triangulation that depend on the dimension; dim2 and dim3 specialise it with
/// - `Site`, `Topology`: a weighted site, and simplices that know their neighbours;
/// - `kAxes`: the coordinates of a site, as pointers to members;
/// - `kSimplices`: simplices per site in a packing, rounded up, for which memory is reserved;
/// - `orientation(places)`: the sign of the simplex of Dim + 1 sites;
/// - `collinear(a, b, c)`: whether three sites lie on one line.
template <int Dim>
struct TriangulationParts;

/// Sites that move, appear and vanish, and what a triangulation keeps of them beside its simplices.
///
/// This is the base of Triangulation<2> and Triangulation<3> and no triangulation by itself. It
/// checks arguments, knows which sites are present and which are hidden, and leads through the
/// steps of an update. What needs geometry it calls by name in Triangulation<Dim>:
/// - `rebuild()` builds T from nothing, by rebuild_by_insertion();
/// - `insert_visible(site)` and `take_out_at_rest(site)` change a regular T by one site;
/// - `repair()` makes T regular after `moved_` have moved, and `tiny()` tells where not to try;
/// - `locally_regular(corner)`, `resolve(corner)` and `unstick(corner)` are what a flip asks, what
///   it does, and what is left to do where it cannot;
/// - `finite_neighbour(site)` is a visible site next to one that is visible, or to infinity;
/// - `locate(site, from)` is the simplex that holds a site, and `conflict(simplex, site)` whether
///   that must give way to it;
/// - `find_edges(list)` lists the edges from nothing;
/// - `audit_simplices(defects)` checks simplex by simplex, and `audit_sphere(defects)` whether
///   simplices that are sound make a sphere.
///
/// A site of a set that spans less than Dim dimensions has no simplex by itself. Such a set is
/// joined to Dim - dimension() *auxiliary* sites outside its span, whose ids follow those
/// of the others. The cone over a regular triangulation is regular wherever its apex is, so no test
/// and no flip needs a case of its own. Flat sets are built anew at every change.
template <int Dim>
class MovingSites {
 public:
  /// Something wrong that audit() found.
  struct Defect {
    int simplex;                     ///< triangle or tetrahedron, or -1
    std::array<int, Dim + 1> sites;  ///< sites concerned, -1 for none
    std::string sentence;
  };

  /// Builds from nothing; forgets all former sites.
  /// @param sites    Dim x N positions [m], site i in column i
  /// @param weights  N weights [m^2]
  /// @throws ContractError if sizes differ or a number is not finite; nothing has changed then
  void build(const Columns<Dim>& sites, const Eigen::VectorXd& weights);

  /// Gives the sites listed in `moved` new places and weights; the other columns are not read.
  /// @param moved    ids of present sites, any order, repetitions allowed
  /// @param sites    Dim x size() positions [m]
  /// @param weights  size() weights [m^2]
  /// @throws ContractError as build(), or if an id is not present; nothing has changed then
  UpdateReport move(std::span<const int> moved, const Columns<Dim>& sites,
                    const Eigen::VectorXd& weights);

  /// Adds a site under an id that is not present: a removed one, or size(), which appends.
  /// @throws ContractError for another id or a number that is not finite; nothing has changed then
  UpdateReport insert(int id, const Vec<Dim>& position, double weight);

  /// Takes a present site out. Its id stays reserved and may be inserted again.
  /// @throws ContractError if the id is not present
  UpdateReport remove(int id);

  /// Takes the removed ids away: present sites get the ids 0, 1, ... in the order that they have.
  void close_gaps();

  /// Number of ids, removed ones included.
  int size() const { return size_; }
  /// True unless the id was removed (or never used).
  bool contains(int id) const {
    return id >= 0 && id < size_ && topology_.corner_of(id) != Topology::kNone;
  }
  /// What the present sites span: -1 nothing, 0 a place, 1 a line, 2 a plane, 3 space.
  int dimension() const { return dimension_; }
  /// Position [m].
  Vec<Dim> site(int id) const { return place_of(sites_[index(id)]); }
  /// Weight [m^2].
  double weight(int id) const { return sites_[index(id)].w; }
  /// Present sites without a cell, in increasing order.
  std::span<const int> hidden() const { return hidden_; }

  /// The finite edges, sorted.
  std::span<const EdgeList::Edge> edges() { return edges_.settle(); }

  /// Calls f(i, j) once for each finite edge, i < j, in increasing order.
  template <class F>
  void for_each_edge(F&& f) const {
    edges_.for_each(f);
  }

  /// Calls f(i, j), i < j, for each edge that the last update made: maybe more than once, and maybe
  /// for edges that it took away again; for all edges if there is no telling.
  template <class F>
  void for_each_new_edge(F&& f) const {
    edges_.for_each_new(f);
  }

  /// Checks everything again, exactly; empty means valid. Each defect names simplex and sites.
  std::vector<Defect> audit() const;

 protected:
  using Parts = TriangulationParts<Dim>;
  using Site = typename Parts::Site;
  using Topology = typename Parts::Topology;
  using Simplex = std::array<int, Dim + 1>;  ///< sites in positive order

  MovingSites() { topology_.clear(Dim); }

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  static Site site_at(const Vec<Dim>& place, double weight) {
    Site site{};
    for (int axis = 0; axis < Dim; ++axis) site.*Parts::kAxes[index(axis)] = place[axis];
    site.w = weight;
    return site;
  }
  static Vec<Dim> place_of(const Site& site) {
    Vec<Dim> place;
    for (int axis = 0; axis < Dim; ++axis) place[axis] = site.*Parts::kAxes[index(axis)];
    return place;
  }

  int auxiliary_sites() const { return dimension_ < 0 ? 0 : Dim - dimension_; }
  int visible_sites() const { return present_ - static_cast<int>(hidden_.size()); }
  bool moved_place(int id) const {
    return id >= 0 && place_of(sites_[index(id)]) != place_of(before_[index(id)]);
  }
  std::vector<int> present_sites() const;
  int span_of(std::span<const int> sites, Simplex& simplex) const;
  int orientation_of(const Simplex& simplex) const;
  int visible_from(int site) const;
  int hint_of(int hidden) const { return -2 - topology_.corner_of(hidden); }

  /// Notes that a present site has no simplex; `hint` is a visible site near it. A hint that is
  /// hidden later leads on to its own hint, and so on without a cycle.
  void hide(int site, int hint) {
    topology_.set_corner_of(site, -2 - hint);
    hidden_.push_back(site);
  }

  // Steps that updates are made of.
  void restart(int count);
  void rebuild_by_insertion();
  void insert_all(std::span<const int> order, const Site* away);
  void place_auxiliaries(Simplex& simplex, const Site* away);
  bool find_hole(int site);
  void sort_simplices(std::span<const int> site_order);
  void push(int corner);
  void push_simplex(int simplex);
  void start_flips();
  bool drain();
  bool settle();
  bool choose_cover(std::span<const int> simplices);
  void try_hidden();

  /// Adds a defect that concerns one site, or none (-1).
  static void add_defect(std::vector<Defect>& defects, int site, std::string sentence);

  int size_ = 0;
  std::vector<Site> sites_;   // by id, then room for Dim auxiliary sites
  std::vector<Site> before_;  // the same at rest; during a move the places before it
  Topology topology_;         // corner_of(site): corner, or kNone if absent, or a note: see hide
  std::vector<int> hidden_;   // sorted at rest
  EdgeList edges_;
  int present_ = 0;
  int dimension_ = -1;

  // Scratch of an update, kept so that a small update costs nothing that grows with size().
  UpdateReport report_;
  std::int64_t budget_ = 0;         // of flips
  bool hull_touched_ = false;       // the hull has to be checked
  int last_ = 0;                    // inserted last: where to start looking for the next
  std::vector<int> site_note_;      // by id, zero between uses
  std::vector<int> queue_, stuck_;  // corners opposite to facets to be looked at, or that stay
  std::vector<int> moved_, inverted_, cover_;
  std::vector<int> touched_;  // simplices that flips and fillings have made
  std::vector<int> hole_, rim_, pending_;

 private:
  Triangulation<Dim>& self() { return static_cast<Triangulation<Dim>&>(*this); }
  const Triangulation<Dim>& self() const { return static_cast<const Triangulation<Dim>&>(*this); }

  void begin();
  UpdateReport finish();
  void expect_valid() const;
  void audit_sites(std::vector<Defect>& defects) const;
  void audit_vertices(std::vector<Defect>& defects) const;
};

}  // namespace lagrain::detail
