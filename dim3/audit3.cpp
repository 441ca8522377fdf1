#include <lagrain/triangulation3.hpp>

#include "audit_sites.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace lagrain {

namespace {

using Quad = Topology3::Quad;

/// Whether the corner and its twin see the same facet, in opposite order.
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

/// What is kept beside the tetrahedra comes last: it is checked against tetrahedra that are right.
std::vector<Triangulation<3>::Defect> Triangulation<3>::audit() const {
  std::vector<Defect> defects;
  const auto report = [&](int site, const std::string& sentence) {
    defects.push_back({-1, {site, -1, -1, -1}, sentence});
  };
  const auto report_cell = [&](int cell, const std::string& sentence) {
    defects.push_back({cell, topology_.vertices(cell), sentence});
  };

  detail::audit_sites<Topology3, Site3>(topology_, size_, present_ > 0 ? 3 - dimension_ : 0, sites_,
                                        before_, present_, hidden_, report);
  if (last_ < 0 || last_ > size_) report(-1, "the search for the next site begins nowhere");
  if (present_ > 0) {
    audit_cells(report, report_cell);
    if (!defects.empty()) return defects;
    audit_hull(report);
  } else if (dimension_ != -1 || topology_.slots() != 0) {
    report(-1, "nothing is present, and something is left");
  }
  if (!defects.empty()) return defects;

  for (const int id : hidden_) {
    const int t = locate(id, visible_from(id));
    if (topology_.infinite(t) || conflict(t, id)) {
      defects.push_back({t, {id, -1, -1, -1}, "the hidden site has a cell"});
    }
  }
  EdgeList found;
  find_edges(found);
  if (const std::string wrong = edges_.audit(found); !wrong.empty()) report(-1, wrong);
  const auto zero = [](int note) { return note == 0; };
  if (!std::all_of(site_note_.begin(), site_note_.end(), zero) ||
      !std::all_of(vertex_note_.begin(), vertex_note_.end(), zero)) {
    report(-1, "a note of a site is left from an update");
  }
  return defects;
}

/// Positive tetrahedra that share their facets, are locally regular and have corners that are known
/// at their sites; and as many of everything as a 3-sphere has.
template <class Report, class ReportCell>
void Triangulation<3>::audit_cells(Report&& report, ReportCell&& report_cell) const {
  bool sound = true;
  if (!detail::free_slots_are_dead(topology_)) report(-1, "the list of free slots is wrong");
  for (int t = 0; t < topology_.slots(); ++t) {
    if (!topology_.alive(t)) continue;
    const Quad& v = topology_.vertices(t);
    if (!topology_.infinite(t) && sign(v) <= 0) report_cell(t, "the tetrahedron is not positive");
    if (!topology_.at_rest(t)) report_cell(t, "a flag or mark is left from an update");
    for (int corner = 4 * t; corner < 4 * t + 4; ++corner) {
      if (!share_facet(topology_, corner, topology_.twin(corner))) {
        report_cell(t, "two neighbours do not share their facet");
        sound = false;
      } else if (corner < topology_.twin(corner) && !locally_regular(corner)) {
        report_cell(t, "a facet is not locally regular");
      }
      if (topology_.vertex(corner) >= 0 && topology_.corner_of(topology_.vertex(corner)) < 0) {
        report_cell(t, "a vertex of the tetrahedron has no corner");
        sound = false;
      }
    }
  }
  const int last_vertex = size_ + (3 - dimension_);  // a flat set has auxiliary sites
  for (int id = -1; id < last_vertex; ++id) {
    const int corner = topology_.corner_of(id);
    if (corner < 0 && id >= 0 && id < size_) continue;
    if (corner < 0 || corner >> 2 >= topology_.slots() || !topology_.alive(corner >> 2) ||
        topology_.vertex(corner) != id) {
      report(id, "the corner of the site belongs to another");
      sound = false;
    }
  }
  if (!sound) return;

  // Euler on a 3-sphere: V - E + F - C = 0 with F = 2 C. Edges are counted at their ends. Stars
  // hold all four corners of each cell, or a vertex has two.
  std::int64_t vertices = 0, ends = 0, corners = 0;
  for (int id = -1; id < last_vertex; ++id) {
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
    report(-1, "Euler's relation fails");
  }
}

/// The hull goes round once as seen from within a tetrahedron, which no rounding touches, and the
/// rounded point that updates see it from is inside or known not to be. The dimension is that of
/// the present sites.
template <class Report>
void Triangulation<3>::audit_hull(Report&& report) const {
  int cell = 0;
  while (cell < topology_.slots() && (!topology_.alive(cell) || topology_.infinite(cell))) ++cell;
  if (cell == topology_.slots()) {
    report(-1, "there is no tetrahedron");
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
  if (!seen || !hull_goes_round_once(middle)) report(-1, "the hull does not go round once");
  if (thin_ == sees_whole_hull()) {
    report(-1, thin_ ? "the point in the middle lies inside a hull that counts as thin"
                     : "the point in the middle lies outside the hull");
  }

  std::vector<int> present;
  for (int id = 0; id < size_; ++id) {
    if (contains(id)) present.push_back(id);
  }
  Quad simplex;
  if (span_of(present, simplex) != dimension_) report(-1, "the dimension is wrong");
}

}  // namespace lagrain
