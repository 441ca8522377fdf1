#include <lagrain/triangulation3.hpp>

#include <Eigen/Geometry>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace lagrain {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using KeyedPoint = std::pair<Kernel::Point_3, int>;
using SortTraits =
    CGAL::Spatial_sort_traits_adapter_3<Kernel, CGAL::First_of_pair_property_map<KeyedPoint>>;

/// Sorts ids by their sites' places along a curve that fills space: neighbours in the order are
/// neighbours in space. With `in_rounds` in rounds that double in size, each sorted so: then no
/// arrangement of sites is a bad case for insertion.
void sort_spatially(std::vector<int>& ids, const std::vector<Site3>& sites, bool in_rounds) {
  std::vector<KeyedPoint> points;
  points.reserve(ids.size());
  for (const int id : ids) {
    const Site3& s = sites[static_cast<std::size_t>(id)];
    points.emplace_back(Kernel::Point_3(s.x, s.y, s.z), id);
  }
  if (in_rounds) {
    CGAL::spatial_sort(points.begin(), points.end(), SortTraits());
  } else {
    CGAL::hilbert_sort(points.begin(), points.end(), SortTraits());
  }
  for (std::size_t k = 0; k < ids.size(); ++k) ids[k] = points[k].second;
}

bool same_place(const Site3& a, const Site3& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// The cyclic order of three numbers, beginning with the least.
std::array<int, 3> least_first(int a, int b, int c) {
  if (a < b && a < c) return {a, b, c};
  if (b < c) return {b, c, a};
  return {c, a, b};
}

}  // namespace

// ---- Build -------------------------------------------------------------------------------------

void Triangulation<3>::rebuild() {
  std::vector<int> present;
  present.reserve(index(present_));
  for (int id = 0; id < size(); ++id) {
    if (contains(id)) present.push_back(id);
  }
  const bool large = present.size() > 64;
  if (large) sort_spatially(present, sites_, true);
  topology_.clear(size() + 3);
  topology_.reserve_cells(7 * present.size());
  edges_.clear();
  hidden_.clear();
  last_ = 0;
  insert_all(present, nullptr);
  if (large) {
    sort_spatially(present, sites_, false);
    sort_cells(present);
  }
  choose_middle_at_rest();
  std::sort(hidden_.begin(), hidden_.end());
  find_edges(edges_);
}

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

/// Puts the cells into memory in the order of their first site, so that what passes over all of
/// them finds neighbours near each other.
void Triangulation<3>::sort_cells(const std::vector<int>& site_order) {
  std::vector<int> rank(sites_.size(), 0);
  for (std::size_t k = 0; k < site_order.size(); ++k) {
    rank[index(site_order[k])] = static_cast<int>(k);
  }
  std::vector<std::pair<int, int>> keys;
  keys.reserve(index(topology_.cells()));
  for (int cell = 0; cell < topology_.slots(); ++cell) {
    if (!topology_.alive(cell)) continue;
    int first = std::numeric_limits<int>::max();
    for (const int v : topology_.vertices(cell)) {
      if (v >= 0) first = std::min(first, rank[index(v)]);
    }
    keys.emplace_back(first, cell);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> order;
  order.reserve(keys.size());
  for (const auto& [first, cell] : keys) order.push_back(cell);
  topology_.renumber(order);
}

/// Builds from nothing by inserting the sites of `order`, one after the other. An insertion into a
/// regular triangulation always succeeds, and ties are ours from the first on.
/// @param away  auxiliary sites keep to the other side of a plane of sites than this one
void Triangulation<3>::insert_all(std::span<const int> order, const Site3* away) {
  const auto at = [&](int id) -> const Site3& { return sites_[index(id)]; };
  Quad simplex{-1, -1, -1, -1};
  dimension_ = span_of(order, simplex);
  if (dimension_ < 0) return;
  if (dimension_ < 3) place_auxiliaries(simplex, away);
  if (orientation(at(simplex[0]), at(simplex[1]), at(simplex[2]), at(simplex[3])) < 0) {
    std::swap(simplex[0], simplex[1]);
  }
  first_simplex(simplex);
  last_ = simplex[0];
  for (const int id : order) {
    if (std::find(simplex.begin(), simplex.end(), id) != simplex.end()) continue;
    topology_.set_corner_of(id, -2 - last_);
    if (!insert_visible(id)) hidden_.push_back(id);
  }
}

/// The dimension of what some sites span. The first of them that span a line, a plane, space are
/// put into `simplex`.
int Triangulation<3>::span_of(std::span<const int> sites, Quad& simplex) const {
  const auto at = [&](int id) -> const Site3& { return sites_[index(id)]; };
  int dimension = -1;
  for (const int id : sites) {
    if (dimension == 3) break;
    const bool raises =
        dimension == -1  ? true
        : dimension == 0 ? !same_place(at(simplex[0]), at(id))
        : dimension == 1 ? !detail::collinear(at(simplex[0]), at(simplex[1]), at(id))
                         : orientation(at(simplex[0]), at(simplex[1]), at(simplex[2]), at(id)) != 0;
    if (raises) simplex[index(++dimension)] = id;
  }
  return dimension;
}

/// Completes a simplex of dimension_ + 1 sites by auxiliary ones, each displaced from the first
/// along an axis.
void Triangulation<3>::place_auxiliaries(Quad& simplex, const Site3* away) {
  const auto at = [&](int k) -> Site3& { return sites_[index(simplex[index(k)])]; };
  const auto spans_space = [&] { return orientation(at(0), at(1), at(2), at(3)) != 0; };
  double size = 1;
  for (int k = 0; k <= dimension_; ++k) {
    size = std::max({size, std::abs(at(k).x), std::abs(at(k).y), std::abs(at(k).z)});
  }
  const int missing = 3 - dimension_;
  // One of the three choices of axes leads out of the span of the sites. The displacement is as
  // long as any coordinate, so that rounding does not swallow it, and towards zero, so that nothing
  // overflows.
  const auto coordinate = [](Site3& site, int axis) -> double& {
    return axis == 0 ? site.x : axis == 1 ? site.y : site.z;
  };
  int last_axis = 0;
  for (int skipped = 0; skipped < 3; ++skipped) {
    int axis = missing == 1 ? skipped : missing == 2 ? (skipped + 1) % 3 : 0;
    for (int k = dimension_ + 1; k <= 3; ++k, axis = (axis + 1) % 3) {
      simplex[index(k)] = size_ + k - dimension_ - 1;
      Site3& auxiliary = at(k);
      auxiliary = at(0);
      coordinate(auxiliary, axis) += coordinate(auxiliary, axis) > 0 ? -size : size;
      auxiliary.w = 0;
      last_axis = axis;
    }
    if (spans_space()) break;
  }
  if (away != nullptr && missing == 1 &&
      orientation(at(0), at(1), at(2), at(3)) == orientation(at(0), at(1), at(2), *away)) {
    // To the other side, and no further than doubles go.
    constexpr double kMost = std::numeric_limits<double>::max();
    const double from = coordinate(at(0), last_axis);
    coordinate(at(3), last_axis) = std::clamp(from > 0 ? from + size : from - size, -kMost, kMost);
  }
}

/// One tetrahedron and the four infinite ones round it.
void Triangulation<3>::first_simplex(const Quad& simplex) {
  topology_.add(simplex);
  for (int i = 0; i < 4; ++i) {
    Quad beyond = simplex;
    beyond[index(i)] = Topology3::kInfinite;
    // Seen from the other side of the facet.
    const auto& f = Topology3::kFacet[i];
    std::swap(beyond[index(f[0])], beyond[index(f[1])]);
    topology_.link(i, topology_.corner_at(topology_.add(beyond), Topology3::kInfinite));
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      topology_.link(topology_.corner_at(1 + i, simplex[index(j)]),
                     topology_.corner_at(1 + j, simplex[index(i)]));
    }
  }
}

// ---- Putting in --------------------------------------------------------------------------------

/// Notes that a present site has no cell of its own; `hint` is a visible site near it. A hint that
/// is hidden later leads on to its own hint, and so on without a cycle.
void Triangulation<3>::hide(int site, int hint) {
  topology_.set_corner_of(site, -2 - hint);
  hidden_.push_back(site);
}

/// Inserts a site that has no cell in place of the tetrahedra in conflict with it, and hides the
/// sites among them. False, and a fresh hint, if the site is hidden itself.
/// @pre T is regular
bool Triangulation<3>::insert_visible(int site) {
  const int start = locate(site, visible_from(site));
  if (!topology_.infinite(start) && !conflict(start, site)) {
    topology_.set_corner_of(site, -2 - topology_.vertex(4 * start));
    return false;
  }
  topology_.clear_marks();
  hole_.assign(1, start);
  rim_.clear();
  topology_.set_mark(start);
  for (std::size_t k = 0; k < hole_.size(); ++k) {
    for (int corner = 4 * hole_[k]; corner < 4 * hole_[k] + 4; ++corner) {
      const int beyond = topology_.twin(corner) >> 2;
      if (topology_.marked(beyond)) continue;
      if (conflict(beyond, site)) {
        topology_.set_mark(beyond);
        hole_.push_back(beyond);
      } else {
        rim_.push_back(corner);
      }
    }
  }
  // Sites of the hole that are not on its rim.
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

// ---- Cavities ----------------------------------------------------------------------------------

/// Triangulates a cavity anew: the regular triangulation of `sites` alone replaces the cells of
/// `hole` if it holds every facet of the hole's boundary. Sites without a cell then are hidden.
///
/// If T was regular but for the cells of the hole, T comes out regular; in particular a site whose
/// star is the hole can be taken out so. In a T that is folded the hole may be anything, and
/// nothing is taken on trust: it is refilled only if its boundary is one sphere. The vertex at
/// infinity included, T and the small triangulation are 3-spheres, which a sphere parts into two
/// balls (Alexander, PNAS 10 (1924) 6). So a ball takes the place of a ball, and T stays a
/// 3-sphere.
/// @param hole   cells that hang together
/// @param sites  sites to be used, all of the boundary among them, in increasing order
/// @param away   see insert_all
/// @return       false if it cannot be done; T has not changed then
bool Triangulation<3>::refill(std::span<const int> hole, std::span<const int> sites,
                              const Site3* away) {
  if (!small_.held) small_.held = std::make_unique<Triangulation<3>>();
  Triangulation<3>& small = *small_.held;
  const auto count = static_cast<int>(sites.size());
  small.size_ = small.present_ = count;
  small.sites_.resize(index(count + 3));
  small.site_note_.assign(index(count + 3), 0);
  small.hidden_.clear();
  small.topology_.clear(count + 3);
  pending_.resize(index(count));
  for (int k = 0; k < count; ++k) {
    small.sites_[index(k)] = sites_[index(sites[index(k)])];
    pending_[index(k)] = k;
    site_note_[index(sites[index(k)])] = k;
  }
  small.insert_all(pending_, away);

  topology_.clear_marks();
  for (const int cell : hole) topology_.set_mark(cell);
  const auto small_id = [&](int v) { return v < 0 ? v : site_note_[index(v)]; };
  facets_.clear();
  for (const int cell : hole) {
    for (int corner = 4 * cell; corner < 4 * cell + 4; ++corner) {
      if (topology_.marked(topology_.twin(corner) >> 2)) continue;
      const auto& f = Topology3::kFacet[corner & 3];
      facets_.push_back({least_first(small_id(topology_.vertex(4 * cell + f[0])),
                                     small_id(topology_.vertex(4 * cell + f[1])),
                                     small_id(topology_.vertex(4 * cell + f[2]))),
                         topology_.twin(corner), Topology3::kNone});
    }
  }
  for (const int id : sites) site_note_[index(id)] = 0;
  if (small.dimension_ < (away != nullptr ? 2 : 3) || !facets_form_sphere(count)) return false;

  // Find the boundary in the small triangulation.
  std::size_t slots = 16;
  while (slots < 4 * facets_.size()) slots *= 2;
  facet_table_.assign(slots, -1);
  const auto slot_of = [&](const std::array<int, 3>& key) {
    std::size_t slot = (static_cast<std::size_t>(key[0] + 1) * 73856093U ^
                        static_cast<std::size_t>(key[1] + 1) * 19349663U ^
                        static_cast<std::size_t>(key[2] + 1) * 83492791U) &
                       (slots - 1);
    while (facet_table_[slot] >= 0 && facets_[index(facet_table_[slot])].sites != key) {
      slot = (slot + 1) & (slots - 1);
    }
    return slot;
  };
  for (std::size_t k = 0; k < facets_.size(); ++k) {
    facet_table_[slot_of(facets_[k].sites)] = static_cast<int>(k);
  }
  std::size_t found = 0;
  inside_.clear();
  small.topology_.clear_marks();
  for (int cell = 0; cell < small.topology_.slots(); ++cell) {
    if (!small.topology_.alive(cell)) continue;
    for (int i = 0; i < 4; ++i) {
      const auto& f = Topology3::kFacet[i];
      const auto& v = small.topology_.vertices(cell);
      const int entry =
          facet_table_[slot_of(least_first(v[index(f[0])], v[index(f[1])], v[index(f[2])]))];
      if (entry < 0) continue;
      facets_[index(entry)].inside = 4 * cell + i;
      small.topology_.exchange_flag(4 * cell + i, true);
      ++found;
      if (!small.topology_.marked(cell)) {
        small.topology_.set_mark(cell);
        inside_.push_back(cell);
      }
    }
  }
  if (found != facets_.size()) return false;
  for (std::size_t k = 0; k < inside_.size(); ++k) {
    for (int i = 0; i < 4; ++i) {
      if (small.topology_.vertex(4 * inside_[k] + i) >= count) return false;  // auxiliary
      if (small.topology_.exchange_flag(4 * inside_[k] + i, false)) continue;
      const int beyond = small.topology_.twin(4 * inside_[k] + i) >> 2;
      if (small.topology_.marked(beyond)) continue;
      small.topology_.set_mark(beyond);
      inside_.push_back(beyond);
    }
  }

  // The vertices inside must be those of before, but for the hidden ones.
  const auto note = [&](int v) -> char& { return vertex_seen_[index(v + 1)]; };
  const bool infinity_on_rim = note(Topology3::kInfinite) != 0;
  for (const int k : small.hidden_) note(k) = 1;
  for (const int cell : inside_) {
    for (const int v : small.topology_.vertices(cell)) note(v) = 1;
  }
  const bool infinity_inside =
      std::any_of(hole.begin(), hole.end(), [&](int cell) { return topology_.infinite(cell); });
  if (!infinity_on_rim && (note(Topology3::kInfinite) != 0) != infinity_inside) return false;
  if (std::find(vertex_seen_.begin() + 1, vertex_seen_.end(), 0) != vertex_seen_.end()) {
    return false;
  }

  // If no tetrahedron is left the rest is flat, and only seen from both sides.
  const auto solid = [](const Topology3& topology, int cell) { return !topology.infinite(cell); };
  if (std::none_of(inside_.begin(), inside_.end(),
                   [&](int cell) { return solid(small.topology_, cell); }) &&
      std::none_of(facets_.begin(), facets_.end(), [&](const CavityFacet& facet) {
        return solid(topology_, facet.outside >> 2);
      })) {
    return false;
  }

  // Copy the inside.
  const std::size_t first_note = edges_.mark(), first_made = touched_.size();
  topology_.for_each_edge_of(hole, [&](int a, int b, bool) { edges_.note_gone(a, b); });
  for (const int cell : hole) {
    if (topology_.infinite(cell)) hull_touched_ = true;
    topology_.release(cell);
  }
  pending_.assign(index(small.topology_.slots()), -1);  // small cell -> cell
  for (const int cell : inside_) {
    Quad quad = small.topology_.vertices(cell);
    for (int& v : quad) v = v < 0 ? v : sites[index(v)];
    pending_[index(cell)] = topology_.add(quad);
    touched_.push_back(pending_[index(cell)]);
    if (topology_.infinite(touched_.back())) hull_touched_ = true;
  }
  for (const int cell : inside_) {
    for (int i = 0; i < 4; ++i) {
      const int twin = small.topology_.twin(4 * cell + i);
      const int beyond = pending_[index(twin >> 2)];
      if (beyond >= 0) topology_.link(4 * pending_[index(cell)] + i, 4 * beyond + (twin & 3));
    }
  }
  for (const CavityFacet& facet : facets_) {
    topology_.link(4 * pending_[index(facet.inside >> 2)] + (facet.inside & 3), facet.outside);
  }
  topology_.clear_marks();
  const auto made = std::span(touched_).subspan(first_made);
  for (const int cell : made) topology_.set_mark(cell);
  topology_.for_each_edge_of(made, [&](int a, int b, bool) { edges_.note_made(a, b); });
  edges_.drop_unchanged(first_note);
  for (const int k : small.hidden_) hide(sites[index(k)], sites[index(facets_[0].sites[2])]);
  return true;
}

/// Whether the facets of facets_, with numbers below `count`, form one sphere: every edge joins two
/// of them, all hang together, and V - E + F is 2, which is less where a sphere has handles or
/// touches itself in a vertex. Leaves notes of their vertices in vertex_seen_.
bool Triangulation<3>::facets_form_sphere(int count) {
  const std::size_t facets = facets_.size();
  vertex_seen_.assign(index(count + 1), 0);
  facet_edges_.clear();
  for (std::size_t k = 0; k < facets; ++k) {
    const auto& v = facets_[k].sites;
    for (std::size_t i = 0; i < 3; ++i) {
      vertex_seen_[index(v[i] + 1)] = 1;
      facet_edges_.push_back({std::minmax(v[i], v[(i + 1) % 3]), static_cast<int>(k)});
    }
  }
  std::sort(facet_edges_.begin(), facet_edges_.end());

  part_of_facet_.resize(facets);
  std::iota(part_of_facet_.begin(), part_of_facet_.end(), 0);
  const auto part_of = [&](int facet) {
    while (part_of_facet_[index(facet)] != facet) facet = part_of_facet_[index(facet)];
    return facet;
  };
  std::size_t parts = facets;
  for (std::size_t k = 0; k < facet_edges_.size(); k += 2) {
    const auto joins = [&](std::size_t other) {
      return other < facet_edges_.size() && facet_edges_[other].first == facet_edges_[k].first;
    };
    if (!joins(k + 1) || joins(k + 2)) return false;
    const int a = part_of(facet_edges_[k].second), b = part_of(facet_edges_[k + 1].second);
    if (a == b) continue;
    part_of_facet_[index(a)] = b;
    --parts;
  }
  const auto vertices = std::count(vertex_seen_.begin(), vertex_seen_.end(), 1);
  // E is 3 F / 2. Two facets back to back would be a sphere as well, but part nothing.
  return parts == 1 && facets > 2 && 2 * static_cast<std::size_t>(vertices) == facets + 4;
}

// ---- Taking out --------------------------------------------------------------------------------

/// Takes a visible site out. The caller notes what becomes of it.
/// @pre T is regular
/// @return false if T must be built anew
bool Triangulation<3>::take_out(int site) {
  const std::size_t first = touched_.size();
  if (flip_out(site)) {
    // The order of its flips was rounded.
    queue_.clear();
    stuck_.clear();
    budget_ = most_flips();
    for (std::size_t k = first; k < touched_.size(); ++k) {
      if (topology_.alive(touched_[k])) push_cell(touched_[k]);
    }
    return settle();
  }
  topology_.star(site, cavity_);
  cavity_sites_.clear();
  collect_vertices(cavity_, cavity_sites_);
  std::erase(cavity_sites_, site);
  for (int& corner : cavity_) corner >>= 2;
  return refill(cavity_, cavity_sites_, &sites_[index(site)]);
}

/// Takes a site out by flips: its weight sinks to minus infinity, and if it is on the hull it then
/// goes to the middle. Each flip on this way cuts an *ear* off its star, the tetrahedron that two
/// neighbouring facets of its link span; cut in the order in which the site leaves them they belong
/// to what stays (Devillers, Int. J. Comput. Geom. Appl. 12 (2002) 193, and a line shelling for the
/// infinite ones). Keys are rounded: what comes out is a triangulation, but perhaps not regular.
/// @return false if flips get stuck, as on lattices; T has not changed then
bool Triangulation<3>::flip_out(int site) {
  const std::size_t first = touched_.size(), first_note = edges_.mark();
  log_.clear();
  logging_ = true;
  ears_.clear();
  topology_.star(site, star_);
  std::size_t degree = star_.size();
  for (const int at : star_) list_ears(at);
  while (degree > 4 && !ears_.empty()) {
    std::pop_heap(ears_.begin(), ears_.end(), std::greater<>());
    const Ear ear = ears_.back();
    ears_.pop_back();
    if (!topology_.alive(ear.corner >> 2) || ear_at(ear.corner, site) != ear) continue;
    const std::size_t before = touched_.size();
    if (!flip_facet(ear.corner)) {
      // In the way of one edge from the site, then.
      const int at = topology_.corner_at(ear.corner >> 2, site);
      const auto& f = Topology3::kFacet[ear.corner & 3];
      if (std::none_of(std::begin(f), std::end(f), [&](int i) {
            const int other = (ear.corner & ~3) + i;
            return other != at && flip_edge(ear.corner, other, 3);
          })) {
        continue;
      }
      degree -= 2;
    }
    for (std::size_t k = before; k < touched_.size(); ++k) {
      const Quad& quad = topology_.vertices(touched_[k]);
      if (std::find(quad.begin(), quad.end(), site) == quad.end()) continue;
      list_ears(topology_.corner_at(touched_[k], site));
    }
  }
  const bool out = degree == 4 && flip_last(site);
  logging_ = false;
  if (!out) {
    undo_flips();
    edges_.take_back(first_note);
    touched_.resize(first);
  }
  return out;
}

/// Lists the ears across the three facets at a corner.
void Triangulation<3>::list_ears(int at) {
  for (const int i : Topology3::kFacet[at & 3]) {
    const int corner = (at & ~3) + i;
    const Ear ear = ear_at(std::min(corner, topology_.twin(corner)), topology_.vertex(at));
    if (!(ear.key < std::numeric_limits<double>::infinity())) continue;
    ears_.push_back(ear);
    std::push_heap(ears_.begin(), ears_.end(), std::greater<>());
  }
}

/// The ear of a site across the facet opposite to a corner. Its key is the negative weight at which
/// the site leaves the ear's orthosphere; for an infinite ear the share of the way to the middle at
/// which it crosses the hull facet. Infinity where there is no ear.
Triangulation<3>::Ear Triangulation<3>::ear_at(int corner, int site) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const Quad& cell = topology_.vertices(corner >> 2);
  const Site3& from = sites_[index(site)];
  std::array<Vec<3>, 4> e;
  std::array<double, 4> height{};
  std::size_t infinite = 4;
  bool has_site = false;
  for (std::size_t i = 0; i < 4; ++i) {
    int v = cell[i];
    if (v == site) {
      has_site = static_cast<int>(i) != (corner & 3);
      v = topology_.vertex(topology_.twin(corner));
    }
    if (v < 0) infinite = i;
    const Site3& to = v < 0 ? middle_ : sites_[index(v)];
    e[i] = {to.x - from.x, to.y - from.y, to.z - from.z};
    height[i] = e[i].squaredNorm() - to.w;
  }
  if (!has_site) return {false, kNever, corner};
  const Vec<3> first = e[0].cross(e[1]), last = e[2].cross(e[3]);
  const std::array<double, 4> share{e[1].dot(last), -e[0].dot(last), e[3].dot(first),
                                    -e[2].dot(first)};
  const double whole = share[0] + share[1] + share[2] + share[3];
  if (infinite < 4) {
    const double beyond = share[infinite];  // positive, as the whole is negative, if the site is
    if (!(whole < 0 && beyond > 0)) return {true, kNever, corner};
    return {true, beyond / (beyond - whole), corner};
  }
  if (!(whole > 0)) return {false, kNever, corner};
  double key = 0;
  for (std::size_t i = 0; i < 4; ++i) key += share[i] * height[i] / whole;
  return {false, key, corner};
}

/// The four cells around a site give way to one.
bool Triangulation<3>::flip_last(int site) {
  topology_.star(site, star_);
  if (star_.size() != 4) return false;
  const int at = star_[0], across = (at & ~3) + ((at + 1) & 3);
  std::array<Quad, 1> out{topology_.vertices(at >> 2)};
  out[0][index(at & 3)] = topology_.vertex(topology_.twin(across));
  std::array<int, 4> in{};
  std::transform(star_.begin(), star_.end(), in.begin(), [](int corner) { return corner >> 2; });
  if (!exchange(in, out)) return false;
  for (const int v : out[0]) edges_.note_gone(site, v);
  return true;
}

}  // namespace lagrain
