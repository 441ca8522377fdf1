// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation3.hpp>

#include "audit_sites.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

namespace lagrain {

namespace {

using Quad = Topology3::Quad;

/// Returns true if a corner and its twin see the same facet, in opposite order.
bool share_facet(const Topology3& topology, int corner, int other) {
  if (other < 0 || other >> 2 >= topology.slots() || topology.twin(other) != corner ||
      !topology.alive(other >> 2)) {
    return false;
  }
  const auto vertex = [&](int at, int k) {
    return topology.vertex((at & ~3) + Topology3::kFacet[at & 3][k % 3]);
  };
  for (int turn = 0; turn < 3; ++turn) {
    if (vertex(corner, 0) == vertex(other, turn) && vertex(corner, 1) == vertex(other, turn + 2) &&
        vertex(corner, 2) == vertex(other, turn + 1)) {
      return true;
    }
  }
  return false;
}

}  // namespace

/// Checks that tetrahedra are positive and share their facets, that these are locally regular, and
/// that vertices are known to have a corner.
void Triangulation<3>::audit_simplices(std::vector<Defect>& defects) const {
  for (int t = 0; t < topology_.slots(); ++t) {
    if (!topology_.alive(t)) continue;
    const Quad& v = topology_.vertices(t);
    const auto report_cell = [&](const std::string& sentence) {
      defects.push_back({t, v, sentence});
    };
    if (!topology_.infinite(t) && sign(v) <= 0) report_cell("the tetrahedron is not positive");
    if (!topology_.at_rest(t)) report_cell("a flag or mark is left from an update");
    for (int corner = 4 * t; corner < 4 * t + 4; ++corner) {
      if (!share_facet(topology_, corner, topology_.twin(corner))) {
        report_cell("two neighbours do not share their facet");
      } else if (corner < topology_.twin(corner) && !locally_regular(corner)) {
        report_cell("a facet is not locally regular");
      }
      if (topology_.vertex(corner) >= 0 && topology_.corner_of(topology_.vertex(corner)) < 0) {
        report_cell("a vertex of the tetrahedron has no corner");
      }
    }
  }
}

/// Checks that there is as much of everything as a 3-sphere has, and that the hull goes round once.
void Triangulation<3>::audit_sphere(std::vector<Defect>& defects) const {
  // Euler's relation on a 3-sphere: V - E + F - C = 0 with F = 2 C, for the numbers of vertices,
  // edges, facets and cells. Edges are counted at their ends. Stars hold all four corners of each
  // cell, or a vertex has two stars.
  std::int64_t vertices = 0, ends = 0, corners = 0;
  for (int id = -1; id < size_ + auxiliary_sites(); ++id) {
    if (topology_.corner_of(id) < 0) continue;
    ++vertices;
    topology_.star(id, star_);
    corners += static_cast<std::int64_t>(star_.size());
    neighbours_.clear();
    collect_vertices(star_, neighbours_);
    const bool on_hull = id >= 0 && std::any_of(star_.begin(), star_.end(), [&](int at) {
                           return topology_.infinite(at >> 2);
                         });
    ends += static_cast<std::int64_t>(neighbours_.size()) - (id >= 0) + on_hull;
  }
  if (corners != 4 * std::int64_t{topology_.cells()} ||
      vertices - ends / 2 + topology_.cells() != 0) {
    add_defect(defects, -1, "Euler's relation fails");
  }
  audit_hull(defects);
}

/// Checks that the hull goes round once as seen from within a tetrahedron, which no rounding
/// touches, and that the rounded point that updates see it from is inside or known not to be.
void Triangulation<3>::audit_hull(std::vector<Defect>& defects) const {
  int cell = 0;
  while (cell < topology_.slots() && (!topology_.alive(cell) || topology_.infinite(cell))) ++cell;
  if (cell == topology_.slots()) {
    add_defect(defects, -1, "there is no tetrahedron");
    return;
  }
  std::array<Site3, 4> middle;
  for (std::size_t i = 0; i < 4; ++i) middle[i] = sites_[index(topology_.vertices(cell)[i])];
  topology_.star(Topology3::kInfinite, star_);
  const bool seen = std::all_of(star_.begin(), star_.end(), [&](int at) {
    const auto& f = Topology3::kFacet[at & 3];
    const auto site = [&](int k) -> const Site3& {
      return sites_[index(topology_.vertices(at >> 2)[index(f[k])])];
    };
    return side_from(middle, site(1), site(0), site(2)) > 0;
  });
  if (!seen || !hull_goes_round_once(middle)) {
    add_defect(defects, -1, "the hull does not go round once");
  }
  if (thin_ == sees_whole_hull()) {
    add_defect(defects, -1,
               thin_ ? "the point in the middle lies inside a hull that counts as thin"
                     : "the point in the middle lies outside the hull");
  }
}

template std::vector<Triangulation<3>::Defect> detail::MovingSites<3>::audit() const;

}  // namespace lagrain
