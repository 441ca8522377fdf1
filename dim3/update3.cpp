#include <lagrain/triangulation3.hpp>

#include "cover.hpp"

#include <algorithm>
#include <cmath>

namespace lagrain {

// ---- Decisions ---------------------------------------------------------------------------------

/// Sign of a tetrahedron. An infinite one lies beyond its facet, as seen from the middle.
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

/// A hull facet always is: no finite site beyond it belongs to its two cells.
bool Triangulation<3>::locally_regular(int corner) const {
  const int apex = topology_.vertex(corner), opposite = topology_.vertex(topology_.twin(corner));
  return (apex | opposite) < 0 || !conflict(corner >> 2, opposite);
}

bool Triangulation<3>::moved_place(int id) const {
  if (id < 0) return false;
  const Site3 &a = sites_[index(id)], &b = before_[index(id)];
  return a.x != b.x || a.y != b.y || a.z != b.z;
}

bool Triangulation<3>::tiny() const {
  return dimension_ < 3 || thin_ || present_ - static_cast<int>(hidden_.size()) < kTiny;
}

/// A point to see the hull from: the mean of the visible sites, auxiliary ones included.
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

/// The same for a triangulation at rest, whose hull the mean may miss by rounding only.
void Triangulation<3>::choose_middle_at_rest() {
  choose_middle();
  thin_ = dimension_ >= 0 && !sees_whole_hull();
}

bool Triangulation<3>::sees_whole_hull() const {
  topology_.star(Topology3::kInfinite, star_);
  return std::all_of(star_.begin(), star_.end(), [&](int at) { return positive(at >> 2); });
}

/// Sign of the tetrahedron of a middle (see hull_goes_round_once) and three sites.
int Triangulation<3>::side_from(std::span<const Site3> middle, const Site3& a, const Site3& b,
                                const Site3& c) {
  for (const Site3& point : middle) {
    if (const int side = orientation(point, a, b, c); side != 0) return side;
  }
  return 0;
}

/// Infinite cells that are all positive cover the directions from the middle a whole number of
/// times; so count those that hold one direction. It leads to a hull facet a b c: to a, from there
/// an infinitesimal way towards b and a still smaller one towards c. So it meets no edge of another
/// facet, and all signs are exact.
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

/// A visible site that shares an edge with a visible site.
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

/// A visible site to start from, found along the hints.
int Triangulation<3>::visible_from(int site) const {
  int hint = site;
  for (int step = 0; step < 64; ++step) {
    const int note = topology_.corner_of(hint);
    if (note >= 0) return hint;
    if (note == Topology3::kNone) break;
    hint = -2 - note;
  }
  return finite_neighbour(Topology3::kInfinite);
}

/// The cell that holds the site, by a walk over facets that have it strictly beyond; infinite if it
/// lies outside. The walk ends because T is regular.
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

void Triangulation<3>::push(int corner) {
  corner = std::min(corner, topology_.twin(corner));
  if (!topology_.exchange_flag(corner, true)) queue_.push_back(corner);
}

void Triangulation<3>::push_cell(int cell) {
  for (int i = 0; i < 4; ++i) push(4 * cell + i);
}

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

/// 2-3: the facet opposite to a corner gives way to the edge that joins the two apices.
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

/// 3-2 or 4-4: the edge u v opposite to two corners of a cell gives way. With three cells round it,
/// the facet of their other vertices takes its place; with four, whose other vertices go round p,
/// w, q, x from `corner` and `other`, the edge p q does.
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

/// 4-1: a finite vertex of the facet opposite to a corner that has no other cells than these two
/// and their two common neighbours lies within the four other vertices: it is hidden now.
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
          sign(quad);  // of the tetrahedron that the edge opposite to i is in the way of
      if (side > 0) continue;
      if (flip_edge(corner, (corner & ~3) + i, side < 0 ? 3 : 4)) return true;
    }
    return false;
  };
  if (!flip_facet(corner) && !by_edge() && !flip_vertex(corner)) return false;
  for (std::size_t k = first; k < touched_.size(); ++k) push_cell(touched_[k]);
  return true;
}

/// Far above any need.
std::int64_t Triangulation<3>::most_flips() const {
  return 64 * static_cast<std::int64_t>(topology_.slots()) + 10000;
}

/// Flips until the queue is empty; facets that cannot be flipped end in stuck_.
/// @return false if the budget is spent, which means that T was no triangulation
bool Triangulation<3>::drain() {
  while (!queue_.empty()) {
    const int corner = queue_.back();
    queue_.pop_back();
    if (!topology_.alive(corner >> 2) || !topology_.exchange_flag(corner, false)) continue;
    if (locally_regular(corner)) continue;
    if (!resolve(corner)) stuck_.push_back(corner);
    if (--budget_ < 0) return false;
  }
  return true;
}

/// Drains the queue, and triangulates anew around facets that stay, until T is locally regular.
bool Triangulation<3>::settle() {
  for (;;) {
    if (!drain()) return false;
    if (stuck_.empty()) return true;
    const int corner = stuck_.back();
    stuck_.pop_back();
    if (!topology_.alive(corner >> 2) || locally_regular(corner) || resolve(corner)) continue;
    if (!refill_around(corner)) return false;
  }
}

/// Refills the stars of the five sites at a facet, or a wider cavity if that one does not hold.
bool Triangulation<3>::refill_around(int corner) {
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
    for (const int cell : fresh) push_cell(cell);
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

/// Flips until T is regular, given that it is so but for the facets of the cells in around_ and
/// touched_.
bool Triangulation<3>::flip_to_regular() {
  queue_.clear();
  stuck_.clear();
  budget_ = most_flips();
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

void Triangulation<3>::undo_flips() {
  for (; !log_.empty(); log_.pop_back()) {
    Flip& flip = log_.back();
    const std::size_t made = index(flip.made_count), was = index(flip.quad_count);
    topology_.exchange({flip.made.data(), made}, {flip.quads.data(), was}, flip.made);
    --report_.flips;
  }
}

void Triangulation<3>::sort_unique(std::vector<int>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Lists the cells with a moved vertex in around_, in increasing order.
void Triangulation<3>::collect_around(std::span<const int> moved) {
  around_.clear();
  if (moved.size() > index(size_) / 32) {
    // Stars overlap and lie scattered in memory: one pass over all cells is cheaper.
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

/// Flips inverted tetrahedra away; where that fails, takes moved sites out, at their old places,
/// until it does not.
/// @return false if too many would have to go
bool Triangulation<3>::extract_inverted() {
  touched_.clear();
  inverted_.clear();
  hull_touched_ = false;
  const auto look = [&](int cell) {
    if (!positive(cell)) inverted_.push_back(cell);
  };
  for (const int cell : around_) {
    hull_touched_ = hull_touched_ || topology_.infinite(cell);
    look(cell);
  }
  const auto infinite = [&](int cell) { return topology_.infinite(cell); };
  if (std::any_of(inverted_.begin(), inverted_.end(), infinite)) {
    // Is it the hull or the point it is seen from?
    const Site3 before = middle_;
    const auto look_at_hull = [&] {
      std::erase_if(inverted_, infinite);
      topology_.star(Topology3::kInfinite, star_);
      for (const int at : star_) look(at >> 2);
    };
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

  const std::int64_t most = present_ / 6;  // about where a build is cheaper
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

/// Fills cover_ with moved sites, at least one in each of the cells.
/// @return false if one has none: an infinite cell that the point in the middle has left
bool Triangulation<3>::choose_cover(std::span<const int> cells) {
  return detail::choose_cover(
      cells, [&](int cell) { return topology_.vertices(cell); },
      [&](int id) { return moved_place(id); }, site_note_, cover_);
}

/// Tries every hidden site. One pass is enough: an insertion only hides others.
void Triangulation<3>::try_hidden() {
  std::vector<int> tried;
  tried.swap(hidden_);
  for (const int id : tried) {
    if (insert_visible(id)) {
      ++report_.reinserted;
    } else {
      hidden_.push_back(id);
    }
  }
}

}  // namespace lagrain
