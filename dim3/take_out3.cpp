// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation3.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <functional>
#include <limits>

namespace lagrain {

/// Takes a visible site out of a regular T for good.
/// @return false if T must be built anew
bool Triangulation<3>::take_out_at_rest(int site) {
  if (!take_out(site)) return false;
  topology_.set_corner_of(site, Topology3::kNone);
  if (hull_touched_) choose_middle_at_rest();
  return true;
}

/// Takes a visible site out, and adds the cells that it made to touched_. The caller notes what
/// becomes of the site.
/// @pre T is regular
/// @return false if T must be built anew
bool Triangulation<3>::take_out(int site) {
  const std::size_t first = touched_.size();
  if (flip_out(site)) {
    // The order of these flips was rounded: look at the facets of what they made.
    start_flips();
    for (std::size_t k = first; k < touched_.size(); ++k) {
      if (topology_.alive(touched_[k])) push_simplex(touched_[k]);
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

/// Takes a site out by flips.
///
/// Its weight sinks to minus infinity, and if the site is on the hull it then goes to the middle.
/// Each flip on this way cuts an *ear* off its star: the tetrahedron that two neighbouring facets
/// of its link span. Ears that are cut in the order in which the site leaves them belong to what
/// stays (Devillers, Int. J. Comput. Geom. Appl. 12 (2002) 193; the infinite ones are a line
/// shelling). The keys of this order are rounded, so what comes out is a triangulation, but perhaps
/// not a regular one.
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
      // Then one edge from the site is in the way.
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

/// Returns the ear of a site across the facet opposite to a corner. Its key is the negative weight
/// at which the site leaves the ear's orthosphere; for an infinite ear it is the share of the way
/// to the middle at which the site crosses the hull facet. Where there is no ear it is infinite.
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

/// Replaces the four cells around a site by one, if there are four.
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
