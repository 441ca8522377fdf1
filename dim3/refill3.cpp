// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation3.hpp>

#include <algorithm>
#include <numeric>

namespace lagrain {

namespace {

/// Returns the cyclic order of three numbers that begins with the least.
std::array<int, 3> least_first(int a, int b, int c) {
  if (a < b && a < c) return {a, b, c};
  if (b < c) return {b, c, a};
  return {c, a, b};
}

}  // namespace

/// Triangulates a cavity anew: the regular triangulation of `sites` alone replaces the cells of
/// `hole` if it holds every facet of the hole's boundary. Sites without a cell then are hidden.
///
/// If T was regular but for the cells of the hole, T comes out regular; in particular a site
/// whose star is the hole can be taken out so. In a T that is folded the hole may be anything,
/// and nothing is taken on trust: it is refilled only if its boundary is one sphere. The
/// vertex at infinity included, T and the small triangulation are 3-spheres, which a sphere
/// parts into two balls (Alexander, PNAS 10 (1924) 6). So a ball takes the place of a ball,
/// and T stays a 3-sphere.
/// @param hole   cells that hang together
/// @param sites  sites to be used, all of the boundary among them, in increasing order
/// @param away   see insert_all
/// @return       false if it cannot be done; T has not changed then
bool Triangulation<3>::refill(std::span<const int> hole, std::span<const int> sites,
                              const Site3* away) {
  Triangulation& small = triangulate_alone(sites, away);
  list_facets(hole, sites);
  // All sites but the one to be taken out may lie in a plane: the cone has an auxiliary site then.
  if (small.dimension_ < (away != nullptr ? 2 : 3)) return false;
  if (!facets_form_sphere(small.size_) || !find_facets(small) || !list_inside(small)) return false;
  if (!keeps_vertices(small, hole) || !has_volume(small)) return false;
  copy_inside(small, hole, sites);
  return true;
}

/// Makes the *small* triangulation: the regular one of some sites alone. Its site k is sites[k], so
/// ties are decided as in T.
Triangulation<3>& Triangulation<3>::triangulate_alone(std::span<const int> sites,
                                                      const Site3* away) {
  if (!small_.held) small_.held = std::make_unique<Triangulation<3>>();
  Triangulation<3>& small = *small_.held;
  const auto count = static_cast<int>(sites.size());
  small.restart(count);
  for (int k = 0; k < count; ++k) small.sites_[index(k)] = sites_[index(sites[index(k)])];
  pending_.resize(index(count));
  std::iota(pending_.begin(), pending_.end(), 0);
  small.insert_all(pending_, away);
  return small;
}

/// Lists the facets between the hole and what is outside in facets_, by their numbers in the
/// small triangulation.
void Triangulation<3>::list_facets(std::span<const int> hole, std::span<const int> sites) {
  for (std::size_t k = 0; k < sites.size(); ++k) site_note_[index(sites[k])] = static_cast<int>(k);
  const auto small_id = [&](int corner) {
    const int v = topology_.vertex(corner);
    return v < 0 ? v : site_note_[index(v)];
  };
  topology_.clear_marks();
  for (const int cell : hole) topology_.set_mark(cell);
  facets_.clear();
  for (const int cell : hole) {
    for (int corner = 4 * cell; corner < 4 * cell + 4; ++corner) {
      if (topology_.marked(topology_.twin(corner) >> 2)) continue;
      const auto& f = Topology3::kFacet[corner & 3];
      facets_.push_back({least_first(small_id(4 * cell + f[0]), small_id(4 * cell + f[1]),
                                     small_id(4 * cell + f[2])),
                         topology_.twin(corner), Topology3::kNone});
    }
  }
  for (const int id : sites) site_note_[index(id)] = 0;
}

/// Returns true if the facets of facets_, with numbers below `count`, form one sphere: every edge
/// joins two of them, all hang together, and V - E + F is 2 for the numbers of vertices, edges and
/// facets. It is less where a sphere has handles or touches itself in a vertex. Leaves notes of
/// their vertices in vertex_seen_.
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

/// Finds facets_ in the small triangulation. The corners that see them from inside are noted there
/// and flagged in the small triangulation; their cells are marked, and begin the list inside_.
/// @return false if a facet is missing
bool Triangulation<3>::find_facets(Triangulation& small) {
  // A hash table with linear probing. It is at most a quarter full.
  std::size_t slots = 16;
  while (slots < 4 * facets_.size()) slots *= 2;
  facet_table_.assign(slots, -1);
  const auto slot_of = [&](const std::array<int, 3>& key) {
    // Three primes spread the numbers (Teschner et al., Proc. VMV (2003) 47).
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
    const auto& v = small.topology_.vertices(cell);
    for (int i = 0; i < 4; ++i) {
      const auto& f = Topology3::kFacet[i];
      const int entry =
          facet_table_[slot_of(least_first(v[index(f[0])], v[index(f[1])], v[index(f[2])]))];
      if (entry < 0) continue;
      facets_[index(entry)].inside = 4 * cell + i;
      small.topology_.exchange_flag(4 * cell + i, true);
      ++found;
      if (small.topology_.marked(cell)) continue;
      small.topology_.set_mark(cell);
      inside_.push_back(cell);
    }
  }
  return found == facets_.size();
}

/// Completes inside_ by the cells that are reached without crossing a flagged facet.
/// @return false if one of them has an auxiliary site
bool Triangulation<3>::list_inside(Triangulation& small) {
  for (std::size_t k = 0; k < inside_.size(); ++k) {
    for (int corner = 4 * inside_[k]; corner < 4 * inside_[k] + 4; ++corner) {
      if (small.topology_.vertex(corner) >= small.size_) return false;
      if (small.topology_.exchange_flag(corner, false)) continue;
      const int beyond = small.topology_.twin(corner) >> 2;
      if (small.topology_.marked(beyond)) continue;
      small.topology_.set_mark(beyond);
      inside_.push_back(beyond);
    }
  }
  return true;
}

/// Returns true if the vertices inside are those of before, but for the hidden ones.
/// @pre vertex_seen_ notes the vertices of the boundary
bool Triangulation<3>::keeps_vertices(const Triangulation& small, std::span<const int> hole) {
  const auto note = [&](int v) -> char& { return vertex_seen_[index(v + 1)]; };
  const bool infinity_on_rim = note(Topology3::kInfinite) != 0;
  for (const int k : small.hidden_) note(k) = 1;
  for (const int cell : inside_) {
    for (const int v : small.topology_.vertices(cell)) note(v) = 1;
  }
  const bool infinity_inside =
      std::any_of(hole.begin(), hole.end(), [&](int cell) { return topology_.infinite(cell); });
  if (!infinity_on_rim && (note(Topology3::kInfinite) != 0) != infinity_inside) return false;
  return std::find(vertex_seen_.begin() + 1, vertex_seen_.end(), 0) == vertex_seen_.end();
}

/// Returns true if a tetrahedron is left inside, or just outside. If there is none the rest is
/// flat, and only seen from both sides.
bool Triangulation<3>::has_volume(const Triangulation& small) const {
  return std::any_of(inside_.begin(), inside_.end(),
                     [&](int cell) { return !small.topology_.infinite(cell); }) ||
         std::any_of(facets_.begin(), facets_.end(), [&](const CavityFacet& facet) {
           return !topology_.infinite(facet.outside >> 2);
         });
}

/// Puts the cells of inside_ in the place of the hole. Adds them to touched_.
void Triangulation<3>::copy_inside(const Triangulation& small, std::span<const int> hole,
                                   std::span<const int> sites) {
  const std::size_t first_note = edges_.mark(), first_made = touched_.size();
  topology_.clear_marks();
  for (const int cell : hole) topology_.set_mark(cell);
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
  const auto made = std::span(touched_).subspan(first_made);
  topology_.clear_marks();
  for (const int cell : made) topology_.set_mark(cell);
  topology_.for_each_edge_of(made, [&](int a, int b, bool) { edges_.note_made(a, b); });
  edges_.drop_unchanged(first_note);
  for (const int k : small.hidden_) hide(sites[index(k)], sites[index(facets_[0].sites[2])]);
}

}  // namespace lagrain
