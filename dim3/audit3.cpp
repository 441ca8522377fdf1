#include <lagrain/triangulation3.hpp>

#include <algorithm>
#include <string>

namespace lagrain {

std::vector<Triangulation<3>::Defect> Triangulation<3>::audit() const {
  std::vector<Defect> defects;
  constexpr std::array<int, 4> kNobody{-1, -1, -1, -1};
  const auto report = [&](int simplex, const std::array<int, 4>& sites,
                          const std::string& sentence) {
    defects.push_back({simplex, sites, sentence});
  };

  int visible = 0, hidden = 0, present = 0;
  for (int id = 0; id < size_; ++id) {
    present += contains(id);
    visible += topology_.corner_of(id) >= 0;
    hidden += topology_.corner_of(id) <= -2;
    if (sites_[index(id)] != before_[index(id)]) {
      report(-1, {id, -1, -1, -1}, "two copies of the place differ");
    }
  }
  if (present != present_) report(-1, kNobody, "the number of present sites is wrong");
  if (hidden != static_cast<int>(hidden_.size()) ||
      !std::is_sorted(hidden_.begin(), hidden_.end())) {
    report(-1, kNobody, "the list of hidden sites is wrong");
  }
  if (present == 0) return defects;

  // A flat set has auxiliary sites, which count as vertices.
  const int vertices = visible + (3 - dimension_) + 1;
  for (int t = 0; t < topology_.slots(); ++t) {
    if (!topology_.alive(t)) continue;
    const auto& v = topology_.vertices(t);
    if (!topology_.infinite(t) && sign(v) <= 0) report(t, v, "the tetrahedron is not positive");
    for (int corner = 4 * t; corner < 4 * t + 4; ++corner) {
      const int other = topology_.twin(corner);
      bool shared = topology_.twin(other) == corner && topology_.alive(other >> 2);
      // Seen from the two sides the facet goes round in opposite order.
      for (int k = 0; shared && k < 3; ++k) {
        const auto& f = Topology3::kFacet[corner & 3];
        const int here = topology_.vertex((corner & ~3) + f[k]);
        const int after = topology_.vertex((corner & ~3) + f[(k + 1) % 3]);
        const auto& g = Topology3::kFacet[other & 3];
        bool found = false;
        for (int l = 0; l < 3; ++l) {
          found = found || (topology_.vertex((other & ~3) + g[l]) == after &&
                            topology_.vertex((other & ~3) + g[(l + 1) % 3]) == here);
        }
        shared = found;
      }
      if (!shared) {
        report(t, v, "two neighbours do not share their facet");
      } else if (corner < other && !locally_regular(corner)) {
        report(t, v, "a facet is not locally regular");
      }
      const int id = topology_.vertex(corner);
      if (id >= 0 && topology_.corner_of(id) < 0) {
        report(t, v, "a vertex of the tetrahedron has no corner");
      }
    }
  }
  for (int id = -1; id < size_; ++id) {
    const int corner = topology_.corner_of(id);
    if (corner >= 0 && (!topology_.alive(corner >> 2) || topology_.vertex(corner) != id)) {
      report(corner >> 2, {id, -1, -1, -1}, "the corner of the site belongs to another");
    }
  }
  if (!defects.empty()) return defects;

  // Euler on a 3-sphere: V - E + F - C = 0 with F = 2 C. Edges are counted at their ends.
  std::int64_t ends = 0, counted = 0;
  for (int id = -1; id < size_ + 3 - dimension_; ++id) {
    if (topology_.corner_of(id) < 0) continue;
    ++counted;
    topology_.star(id, star_);
    neighbours_.clear();
    collect_vertices(star_, neighbours_);
    const bool on_hull = id >= 0 && std::any_of(star_.begin(), star_.end(), [&](int at) {
                           return topology_.infinite(at >> 2);
                         });
    ends += static_cast<std::int64_t>(neighbours_.size()) - (id >= 0) + on_hull;
  }
  if (counted != vertices || counted - ends / 2 + topology_.cells() != 0) {
    report(-1, kNobody, "Euler's relation fails");
  }
  if (!thin_ && !sees_whole_hull()) {
    report(-1, kNobody, "the point in the middle lies outside the hull");
  } else if (!thin_ && !hull_goes_round_once()) {
    report(-1, kNobody, "the hull does not go round once");
  }
  for (const int id : hidden_) {
    const int t = locate(id, visible_from(id));
    if (topology_.infinite(t) || conflict(t, id)) {
      report(t, {id, -1, -1, -1}, "the hidden site has a cell");
    }
  }
  // The list of edges, against the cells.
  EdgeList found;
  find_edges(found);
  if (!std::ranges::equal(found.all(), edges())) {
    report(-1, kNobody, "the list of edges is out of date");
  }
  return defects;
}

}  // namespace lagrain
