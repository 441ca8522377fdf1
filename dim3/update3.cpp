// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation3.hpp>

#include "updates.hpp"

#include <algorithm>
#include <cmath>

namespace lagrain {

namespace {

// These numbers were measured on the jittered lattices of tests/bench/bench_update.cpp, with 1,000
// to 20,000 spheres. None of them changes a result.

/// From this share of moved sites on, one pass over all cells finds the stars of all of them sooner
/// than one star after the other, which overlap and lie scattered in memory. The two cost the same
/// at 1/64, and at 1/32 the pass saves a quarter to a third. With half or twice the number an
/// update near these shares takes up to a third longer.
constexpr std::size_t kSweptShare = 32;
/// An update that has to take out more than this share of the sites builds T anew. A build is
/// cheaper from a share of about 1/30 on; at 1/6 an update takes up to four times as long. With
/// 1/12 that is two builds, with 1/3 five; only moves by half a radius and more get there.
constexpr int kMostTakenOut = 6;
/// Cavities that are wider than this many rings of stars are not tried; T is then built anew. Where
/// the weights of 300 or 3,000 spheres changed at random, facets got stuck five times in 66
/// updates, and any number from 1 to 8 gave the same counts and times.
constexpr int kRings = 4;

}  // namespace

// ---- Decisions ---------------------------------------------------------------------------------

/// Returns the sign of a tetrahedron. An infinite one is positive if it does not see the middle: it
/// then lies beyond its facet.
int Triangulation<3>::sign(const Quad& quad) const {
  std::array<const Site3*, 4> place;
  bool infinite = false;
  for (std::size_t i = 0; i < 4; ++i) {
    infinite = infinite || quad[i] < 0;
    place[i] = quad[i] < 0 ? &middle_ : &sites_[index(quad[i])];
  }
  const int side = orientation(*place[0], *place[1], *place[2], *place[3]);
  return infinite ? -side : side;
}

/// Returns true if the cell cannot belong to T because of the site; see predicates3.hpp.
bool Triangulation<3>::conflict(int cell, int site) const {
  Quad v = topology_.vertices(cell);
  for (int i = 0; i < 4; ++i) {
    if (v[index(i)] >= 0) continue;
    const auto& f = Topology3::kFacet[i];
    // (infinity, facet) is positive, so the facet turns its back to infinity.
    return in_conflict_beyond(sites_.data(), v[index(f[1])], v[index(f[0])], v[index(f[2])], site);
  }
  return in_conflict(sites_.data(), v[0], v[1], v[2], v[3], site);
}

/// Returns true if neither of the two cells at the facet opposite to a corner is in conflict with
/// the apex of the other. A hull facet is always regular: only one of its apices is finite.
bool Triangulation<3>::locally_regular(int corner) const {
  const int apex = topology_.vertex(corner), opposite = topology_.vertex(topology_.twin(corner));
  return (apex | opposite) < 0 || !conflict(corner >> 2, opposite);
}

/// Chooses the point that the hull is seen from: the mean of the visible sites, auxiliary
/// ones included.
void Triangulation<3>::choose_middle() {
  // Where sums of coordinates overflow they are made of smaller shares.
  for (const double share : {1.0, 0x1p-64}) {
    const Site3* first = nullptr;
    double x = 0, y = 0, z = 0, count = 0;
    for (int id = 0; id < size_ + 3; ++id) {
      if (topology_.corner_of(id) < 0) continue;
      // Relative to one of them, so that a far origin costs no digits.
      const Site3& s = sites_[index(id)];
      if (first == nullptr) first = &s;
      x += share * s.x - share * first->x;
      y += share * s.y - share * first->y;
      z += share * s.z - share * first->z;
      ++count;
    }
    if (first == nullptr) return;
    middle_ = {first->x + x / count / share, first->y + y / count / share,
               first->z + z / count / share, 0};
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) return;
  }
}

/// Chooses the middle of a triangulation at rest, whose hull the mean may miss by rounding only.
/// Such a T is thin.
void Triangulation<3>::choose_middle_at_rest() {
  choose_middle();
  thin_ = dimension_ >= 0 && !sees_whole_hull();
}

/// Returns true if all infinite cells are positive.
bool Triangulation<3>::sees_whole_hull() const {
  topology_.star(Topology3::kInfinite, star_);
  return std::all_of(star_.begin(), star_.end(), [&](int at) { return positive(at >> 2); });
}

/// Returns the sign of the tetrahedron of a middle (see hull_goes_round_once) and three sites.
int Triangulation<3>::side_from(std::span<const Site3> middle, const Site3& a, const Site3& b,
                                const Site3& c) {
  for (const Site3& point : middle) {
    if (const int side = orientation(point, a, b, c); side != 0) return side;
  }
  return 0;
}

/// Returns true if the hull goes round the middle once.
///
/// Infinite cells that are all positive cover the directions from the middle a whole number of
/// times; so count those that hold one direction. The direction leads to a hull facet a b c: to a,
/// from there an infinitesimal way towards b and a still smaller one towards c. So it meets no edge
/// of another facet, and all signs are exact.
/// @pre all infinite cells are positive
/// @param middle  the point to see them from: the first of these, or, where it lies in a plane that
///                is asked about, an infinitesimal way from it towards the next
bool Triangulation<3>::hull_goes_round_once(std::span<const Site3> middle) const {
  topology_.star(Topology3::kInfinite, star_);
  const auto facet_of = [&](int at) -> std::array<int, 3> {
    // In positive order as seen from the middle, which is negative from infinity.
    const auto& f = Topology3::kFacet[at & 3];
    const Quad& v = topology_.vertices(at >> 2);
    return {v[index(f[1])], v[index(f[0])], v[index(f[2])]};
  };
  const std::array<int, 3> aim = facet_of(star_.front());
  const auto is_left_of = [&](int from, int to) {
    for (const int id : aim) {
      if (id == from || id == to) continue;
      const int side = side_from(middle, sites_[index(from)], sites_[index(to)], sites_[index(id)]);
      if (side != 0) return side > 0;
    }
    return false;
  };
  return std::count_if(star_.begin(), star_.end(), [&](int at) {
           const auto [a, b, c] = facet_of(at);
           return is_left_of(a, b) && is_left_of(b, c) && is_left_of(c, a);
         }) == 1;
}

/// Returns a visible site that shares an edge with a visible one, or with infinity.
int Triangulation<3>::finite_neighbour(int site) const {
  const int corner = topology_.corner_of(site);
  const auto& f = Topology3::kFacet[corner & 3];
  const int first = topology_.vertex((corner & ~3) + f[0]);
  return first >= 0 ? first : topology_.vertex((corner & ~3) + f[1]);
}

/// Adds the finite vertices of the cells of some corners, sorted, each once.
/// @pre `vertices` is empty
void Triangulation<3>::collect_vertices(std::span<const int> corners,
                                        std::vector<int>& vertices) const {
  vertex_note_.resize(sites_.size());
  for (const int corner : corners) {
    for (const int v : topology_.vertices(corner >> 2)) {
      if (v < 0 || vertex_note_[index(v)] != 0) continue;
      vertex_note_[index(v)] = 1;
      vertices.push_back(v);
    }
  }
  for (const int v : vertices) vertex_note_[index(v)] = 0;
  std::sort(vertices.begin(), vertices.end());
}

// ---- Where is a site? --------------------------------------------------------------------------

/// Finds the cell that holds the site by a walk over facets that have it strictly beyond; the cell
/// is infinite if the site lies outside. The walk ends because T is regular.
int Triangulation<3>::locate(int site, int hint) const {
  int cell = topology_.corner_of(hint) >> 2;
  if (topology_.infinite(cell)) {
    cell = topology_.twin(topology_.corner_at(cell, Topology3::kInfinite)) >> 2;
  }
  int came = Topology3::kNone;
  for (bool walking = true; walking && !topology_.infinite(cell);) {
    walking = false;
    for (int i = 0; i < 4; ++i) {
      if (4 * cell + i == came) continue;
      Quad quad = topology_.vertices(cell);
      quad[index(i)] = site;
      if (sign(quad) >= 0) continue;
      came = topology_.twin(4 * cell + i);
      cell = came >> 2;
      walking = true;
      break;
    }
  }
  return cell;
}

// ---- Flips -------------------------------------------------------------------------------------

/// Exchanges cells for others if all of these are positive.
bool Triangulation<3>::exchange(std::span<const int> in, std::span<const Quad> out) {
  for (const Quad& quad : out) {
    if (sign(quad) <= 0) return false;
  }
  for (const int cell : in) hull_touched_ = hull_touched_ || topology_.infinite(cell);
  Flip flip{};
  if (logging_) {
    flip.quad_count = static_cast<int>(in.size());
    for (std::size_t k = 0; k < in.size(); ++k) flip.quads[k] = topology_.vertices(in[k]);
  }
  flip.made_count = static_cast<int>(out.size());
  topology_.exchange(in, out, flip.made);
  touched_.insert(touched_.end(), flip.made.begin(), flip.made.begin() + flip.made_count);
  if (logging_) log_.push_back(flip);
  ++report_.flips;
  return true;
}

/// Flips 2-3: the facet opposite to a corner gives way to the edge that joins the two apices.
bool Triangulation<3>::flip_facet(int corner) {
  const int twin = topology_.twin(corner);
  const int apex = topology_.vertex(corner), opposite = topology_.vertex(twin);
  if (apex == opposite) return false;
  std::array<Quad, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = topology_.vertices(corner >> 2);
    out[k][index(Topology3::kFacet[corner & 3][k])] = opposite;
  }
  if (!exchange(std::array{corner >> 2, twin >> 2}, out)) return false;
  edges_.note_made(apex, opposite);
  return true;
}

/// Flips 3-2 or 4-4: the edge u v opposite to two corners of a cell gives way. With three cells
/// round it, the facet of their other vertices takes its place; with four, whose other vertices go
/// round p, w, q, x from `corner` and `other`, the edge p q does.
bool Triangulation<3>::flip_edge(int corner, int other, int cells) {
  const auto count = static_cast<std::size_t>(cells);
  if (topology_.degree(corner, other, cells + 1) != cells) return false;
  const int first = corner & 3, second = other & 3;
  std::array<int, 4> in{}, ring{};
  for (std::size_t k = 0; k < count; ++k) {
    in[k] = corner >> 2;
    ring[k] = topology_.vertex(corner);  // cell k has ring[k] and ring[k + 1]
    topology_.turn(corner, other);
  }
  const int q = ring[2];
  if (ring[0] == q || (count == 4 && ring[1] == ring[3])) return false;
  // Each cell that q is not in, once with q for u and once with q for v.
  std::array<Quad, 4> out;
  std::size_t end = 0;
  for (const int cell : {in[0], in[3]}) {
    if (end == 2 && count == 3) break;
    const Quad& quad = topology_.vertices(cell);
    for (std::size_t i = 0; i < 4; ++i) {
      if (std::find(ring.begin(), ring.begin() + cells, quad[i]) != ring.begin() + cells) continue;
      out[end] = quad;
      out[end++][i] = q;
    }
  }
  std::array<int, 2> ends{};
  for (int i = 0, k = 0; i < 4; ++i) {
    if (i != first && i != second) ends[index(k++)] = topology_.vertex(4 * in[0] + i);
  }
  if (!exchange({in.data(), count}, {out.data(), end})) return false;
  edges_.note_gone(ends[0], ends[1]);
  if (count == 4) edges_.note_made(ring[0], q);
  return true;
}

/// Flips 4-1: takes out a finite vertex of the facet opposite to a corner that has no other cells
/// than these two and their two common neighbours. It lies within the four other vertices, and is
/// hidden now.
bool Triangulation<3>::flip_vertex(int corner) {
  const int cell = corner >> 2, beyond = topology_.twin(corner) >> 2;
  const int opposite = topology_.vertex(topology_.twin(corner));
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& f = Topology3::kFacet[corner & 3];
    const int u = topology_.vertex(4 * cell + f[k]);
    const int v = topology_.vertex(4 * cell + f[(k + 1) % 3]);
    const int w = topology_.vertex(4 * cell + f[(k + 2) % 3]);
    if (u < 0) continue;
    const auto across = [&](int from, int vertex) {
      return topology_.twin(topology_.corner_at(from, vertex)) >> 2;
    };
    const int without_v = across(cell, v), without_w = across(cell, w);
    if (without_v == without_w || across(beyond, v) != without_v ||
        across(beyond, w) != without_w || across(without_v, w) != without_w) {
      continue;
    }
    std::array<Quad, 1> out{topology_.vertices(cell)};
    out[0][index(f[k])] = opposite;
    const int apex = topology_.vertex(corner);
    if (!exchange(std::array{cell, beyond, without_v, without_w}, out)) continue;
    for (const int end : {apex, opposite, v, w}) edges_.note_gone(u, end);
    hide(u, opposite >= 0 ? opposite : finite_neighbour(opposite));
    return true;
  }
  return false;
}

/// Makes a facet that is not locally regular go away by one flip, if one will do, and puts the
/// facets around on the queue.
/// @pre all cells are positive
bool Triangulation<3>::resolve(int corner) {
  const std::size_t first = touched_.size();
  const auto by_edge = [&] {
    for (const int i : Topology3::kFacet[corner & 3]) {
      Quad quad = topology_.vertices(corner >> 2);
      quad[index(i)] = topology_.vertex(topology_.twin(corner));
      const int side =
          sign(quad);  // below 0 if the edge opposite to i is in the way, 0 if it is flat
      if (side > 0) continue;
      if (flip_edge(corner, (corner & ~3) + i, side < 0 ? 3 : 4)) return true;
    }
    return false;
  };
  if (!flip_facet(corner) && !by_edge() && !flip_vertex(corner)) return false;
  for (std::size_t k = first; k < touched_.size(); ++k) push_simplex(touched_[k]);
  return true;
}

/// Refills the stars of the five sites at a facet, or a wider cavity if that one does not hold.
bool Triangulation<3>::unstick(int corner) {
  std::vector<int> sites;
  collect_vertices(std::array{corner, topology_.twin(corner)}, sites);
  for (int ring = 0; ring < kRings; ++ring) {
    std::vector<int> cavity;
    for (const int site : sites) {
      topology_.star(site, star_);
      for (const int at : star_) cavity.push_back(at & ~3);
    }
    sort_unique(cavity);
    for (int& cell : cavity) cell >>= 2;
    unpinch(cavity);
    if (cavity.size() > index(topology_.slots()) / 2) return false;
    std::vector<int> corners;
    for (const int cell : cavity) corners.push_back(4 * cell);
    sites.clear();
    collect_vertices(corners, sites);
    const std::size_t first = touched_.size();
    if (!refill(cavity, sites, nullptr)) continue;
    // An infinite cell of the small triangulation may not see the middle.
    const auto fresh = std::span(touched_).subspan(first);
    if (!std::all_of(fresh.begin(), fresh.end(), [&](int cell) { return positive(cell); })) {
      return false;
    }
    for (const int cell : fresh) push_simplex(cell);
    ++report_.unstuck;
    return true;
  }
  return false;
}

/// Adds to a cavity the cells around each edge in which it touches itself: a cavity that does is no
/// ball, and cannot be refilled.
void Triangulation<3>::unpinch(std::vector<int>& cavity) {
  topology_.clear_marks();
  for (const int cell : cavity) topology_.set_mark(cell);
  for (std::size_t k = 0; k < cavity.size(); ++k) {
    for (const auto& [i, j] : Topology3::kEdges) {
      // The cells around the edge between the other two corners.
      int through = 4 * cavity[k] + i, other = 4 * cavity[k] + j, ways_in = 0;
      do {
        const bool was_inside = topology_.marked(through >> 2);
        topology_.turn(through, other);
        ways_in += !was_inside && topology_.marked(through >> 2);
      } while (through >> 2 != cavity[k]);
      if (ways_in < 2) continue;
      do {
        if (!topology_.marked(through >> 2)) {
          topology_.set_mark(through >> 2);
          cavity.push_back(through >> 2);
        }
        topology_.turn(through, other);
      } while (through >> 2 != cavity[k]);
    }
  }
}

/// Flips until T is regular, given that it is so but for the facets of the cells in around_
/// and touched_.
bool Triangulation<3>::flip_to_regular() {
  start_flips();
  around_.insert(around_.end(), touched_.begin(), touched_.end());
  topology_.clear_marks();
  for (const int cell : around_) topology_.set_mark(cell);
  for (const int cell : around_) {
    for (int corner = 4 * cell; corner < 4 * cell + 4; ++corner) {
      if (!topology_.alive(cell)) break;
      // Two cells of the list see their facet once; flips see to the facets of what they make.
      const int twin = topology_.twin(corner);
      if ((twin < corner && topology_.marked(twin >> 2)) || locally_regular(corner)) continue;
      push(corner);
      if (!drain()) return false;
    }
  }
  return settle() && (!hull_touched_ || hull_goes_round_once({&middle_, 1}));
}

// ---- Moves -------------------------------------------------------------------------------------

/// Makes an inverted tetrahedron go away by one flip to positive ones, if one will do.
bool Triangulation<3>::resolve_inverted(int cell) {
  for (int corner = 4 * cell; corner < 4 * cell + 4; ++corner) {
    if (flip_facet(corner)) return true;
  }
  for (const int cells : {3, 4}) {
    for (int corner = 4 * cell; corner < 4 * cell + 4; ++corner) {
      for (int other = 4 * cell; other < 4 * cell + 4; ++other) {
        // Three cells look the same from both corners, four do not.
        if (other == corner || (cells == 3 && other < corner)) continue;
        if (flip_edge(corner, other, cells)) return true;
      }
    }
  }
  return false;
}

/// Undoes the flips that log_ holds, the last one first.
void Triangulation<3>::undo_flips() {
  for (; !log_.empty(); log_.pop_back()) {
    Flip& flip = log_.back();
    const std::size_t made = index(flip.made_count), was = index(flip.quad_count);
    topology_.exchange({flip.made.data(), made}, {flip.quads.data(), was}, flip.made);
    --report_.flips;
  }
}

/// Makes T regular after the sites in moved_ have moved.
bool Triangulation<3>::repair() {
  collect_around(moved_);
  return extract_inverted() && flip_to_regular();
}

/// Builds T from nothing, and chooses the middle.
void Triangulation<3>::rebuild() {
  rebuild_by_insertion();
  choose_middle_at_rest();
}

/// Lists the cells with a moved vertex in around_, in increasing order.
void Triangulation<3>::collect_around(std::span<const int> moved) {
  around_.clear();
  if (moved.size() > index(size_) / kSweptShare) {
    for (const int site : moved) site_note_[index(site)] = 1;
    for (int t = 0; t < topology_.slots(); ++t) {
      const Quad& v = topology_.vertices(t);
      if (std::any_of(v.begin(), v.end(),
                      [&](int id) { return id >= 0 && site_note_[index(id)]; })) {
        around_.push_back(t);
      }
    }
    for (const int site : moved) site_note_[index(site)] = 0;
    return;
  }
  for (const int site : moved) {
    if (topology_.corner_of(site) < 0) continue;
    topology_.star(site, star_);
    for (const int at : star_) around_.push_back(at >> 2);
  }
  sort_unique(around_);
}

/// Lists the inverted tetrahedra of around_ in inverted_.
void Triangulation<3>::list_inverted() {
  inverted_.clear();
  hull_touched_ = false;
  for (const int cell : around_) {
    hull_touched_ = hull_touched_ || topology_.infinite(cell);
    if (!positive(cell)) inverted_.push_back(cell);
  }
  const auto infinite = [&](int cell) { return topology_.infinite(cell); };
  if (std::any_of(inverted_.begin(), inverted_.end(), infinite)) see_hull_again();
}

/// Looks at the hull again from another point, as inverted infinite tetrahedra may have to do with
/// the point they are seen from.
void Triangulation<3>::see_hull_again() {
  const auto infinite = [&](int cell) { return topology_.infinite(cell); };
  const auto look_at_hull = [&] {
    std::erase_if(inverted_, infinite);
    topology_.star(Topology3::kInfinite, star_);
    for (const int at : star_) {
      if (!positive(at >> 2)) inverted_.push_back(at >> 2);
    }
  };
  const Site3 before = middle_;
  choose_middle();
  look_at_hull();
  // A site thrown far takes the mean with it, out of the hull of those at rest.
  if (std::any_of(inverted_.begin(), inverted_.end(), [&](int cell) {
        const Quad& v = topology_.vertices(cell);
        return infinite(cell) &&
               std::none_of(v.begin(), v.end(), [&](int id) { return moved_place(id); });
      })) {
    middle_ = before;
    look_at_hull();
  }
}

/// Flips inverted tetrahedra away; where that fails, takes moved sites out, at their old places,
/// until it does not.
/// @return false if too many would have to go
bool Triangulation<3>::extract_inverted() {
  const std::int64_t most = present_ / kMostTakenOut;
  touched_.clear();
  list_inverted();
  for (;;) {
    const std::size_t first = touched_.size(), first_note = edges_.mark();
    log_.clear();
    logging_ = true;
    unresolved_ = inverted_;
    for (std::size_t left = unresolved_.size() + 1; unresolved_.size() < left;) {
      left = unresolved_.size();
      std::erase_if(unresolved_, [&](int cell) {
        return !topology_.alive(cell) || positive(cell) || resolve_inverted(cell);
      });
    }
    logging_ = false;
    if (unresolved_.empty()) return true;
    undo_flips();
    edges_.take_back(first_note);
    touched_.resize(first);
    // A cell without a moved site is an infinite one that the point in the middle has left.
    if (!choose_cover(unresolved_)) return false;
    if (report_.extracted + static_cast<std::int64_t>(cover_.size()) > most) return false;
    sites_.swap(before_);  // T is regular at the old places
    const bool taken = std::all_of(cover_.begin(), cover_.end(), [&](int site) {
      const int hint = finite_neighbour(site);
      if (!take_out(site)) return false;
      hide(site, hint);
      ++report_.extracted;
      return true;
    });
    sites_.swap(before_);
    if (!taken) return false;
    inverted_.insert(inverted_.end(), touched_.begin() + static_cast<std::ptrdiff_t>(first),
                     touched_.end());
    sort_unique(inverted_);
    std::erase_if(inverted_, [&](int cell) { return !topology_.alive(cell) || positive(cell); });
  }
}

// ---- Putting in --------------------------------------------------------------------------------

/// Inserts a site that has no cell in place of the tetrahedra in conflict with it (Bowyer, Comput.
/// J. 24 (1981) 162; Watson, ibid. 167), and hides the sites among them.
/// @pre T is regular
/// @return false if the site is hidden itself, which then has a fresh hint
bool Triangulation<3>::insert_visible(int site) {
  if (!find_hole(site)) return false;
  // Notes of sites: 2 on the rim of the hole, 1 inside it.
  const auto note = [&](int v, int value) {
    if (v >= 0) site_note_[index(v)] = value;
  };
  cavity_sites_.clear();
  for (const int cell : hole_) {
    for (const int v : topology_.vertices(cell)) {
      if (v < 0 || site_note_[index(v)] != 0) continue;
      note(v, 1);
      cavity_sites_.push_back(v);
    }
  }
  for (const int corner : rim_) {
    for (const int i : Topology3::kFacet[corner & 3]) note(topology_.vertex((corner & ~3) + i), 2);
  }
  note_edges_of_insertion(site);
  topology_.fill_from(site, hole_, rim_);
  for (const int v : cavity_sites_) {
    if (site_note_[index(v)] == 1) hide(v, site);
    note(v, 0);
  }
  last_ = site;
  return true;
}

/// Notes what changes when a site is joined to rim_ in place of hole_: the edges inside the hole
/// go, and one to each site of the rim (noted as 2) comes.
void Triangulation<3>::note_edges_of_insertion(int site) {
  if (!edges_.live()) return;
  topology_.for_each_edge_of(hole_, [&](int a, int b, bool inside) {
    if (inside) edges_.note_gone(a, b);
  });
  for (const int v : cavity_sites_) {
    if (site_note_[index(v)] == 2) edges_.note_made(site, v);
  }
}

/// Lists the finite edges from nothing, auxiliary sites left out.
void Triangulation<3>::find_edges(EdgeList& list) const {
  list.find(size_, [&](auto&& f) {
    for (int t = 0; t < topology_.slots(); ++t) {
      const Quad& v = topology_.vertices(t);
      for (const auto& [k, l] : Topology3::kEdges) {
        const int i = v[index(k)], j = v[index(l)];
        if ((i | j) >= 0 && std::max(i, j) < size_) f(i, j);
      }
    }
  });
}

template class detail::MovingSites<3>;

}  // namespace lagrain
