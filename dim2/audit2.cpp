#include <lagrain/triangulation2.hpp>

#include <algorithm>
#include <string>

namespace lagrain {

std::vector<Triangulation<2>::Defect> Triangulation<2>::audit() const {
  std::vector<Defect> defects;
  const auto report = [&](int simplex, std::array<int, 3> sites, const std::string& sentence) {
    defects.push_back({simplex, sites, sentence});
  };

  int visible = 0, hidden = 0, present = 0;
  for (int id = 0; id < size(); ++id) {
    present += contains(id);
    visible += topology_.corner_of(id) >= 0;
    hidden += topology_.corner_of(id) <= -2;
    if (sites_[index(id)] != before_[index(id)])
      report(-1, {id, -1, -1}, "two copies of the place differ");
  }
  if (present != present_) report(-1, {-1, -1, -1}, "the number of present sites is wrong");
  if (hidden != static_cast<int>(hidden_.size()) ||
      !std::is_sorted(hidden_.begin(), hidden_.end())) {
    report(-1, {-1, -1, -1}, "the list of hidden sites is wrong");
  }
  if (dimension_ < 2) {
    if (visible != static_cast<int>(line_.size()) || topology_.slots() != 0) {
      report(-1, {-1, -1, -1}, "the line does not hold the visible sites");
    }
    Triangulation<2> fresh = *this;
    fresh.rebuild();
    if (fresh.line_ != line_ || fresh.hidden_ != hidden_) {
      report(-1, {-1, -1, -1}, "the line differs from a fresh one");
    }
    return defects;
  }

  int triangles = 0;
  for (int t = 0; t < topology_.slots(); ++t) {
    if (!topology_.alive(t)) continue;
    ++triangles;
    const auto v = corners_of(t);
    if (!positive(sites_.data(), v[0], v[1], v[2]))
      report(t, v, "the triangle is not counter-clockwise");
    for (int corner = 4 * t; corner < 4 * t + 3; ++corner) {
      const int other = topology_.twin(corner);
      if (topology_.twin(other) != corner || !topology_.alive(other >> 2) ||
          topology_.source(corner) != topology_.target(other) ||
          topology_.target(corner) != topology_.source(other)) {
        report(t, v, "two neighbours do not share their edge");
      } else if (corner < other && !locally_regular(corner)) {
        report(t, {topology_.source(corner), topology_.target(corner), topology_.vertex(other)},
               "the edge of the first two sites is not locally regular against the third");
      }
      if (v[index(corner & 3)] >= 0 && topology_.corner_of(v[index(corner & 3)]) < 0) {
        report(t, v, "a vertex of the triangle has no corner");
      }
    }
  }
  for (int id = -1; id < size(); ++id) {
    const int corner = topology_.corner_of(id);
    if (corner >= 0 && (!topology_.alive(corner >> 2) || topology_.vertex(corner) != id)) {
      report(corner >> 2, {id, -1, -1}, "the corner of the site belongs to another");
    }
  }
  // Euler: a sphere on visible + 1 vertices.
  if (triangles != 2 * (visible + 1) - 4) report(-1, {-1, -1, -1}, "Euler's relation fails");
  if (!defects.empty()) return defects;

  if (!hull_goes_round_once()) report(-1, {-1, -1, -1}, "the hull does not go round once");
  for (const int id : hidden_) {
    const int t = locate(id, visible_from(id));
    if (topology_.infinite(t) || conflict(t, id))
      report(t, {id, -1, -1}, "the hidden site has a cell");
  }
  EdgeList found;
  find_edges(found);
  if (!std::ranges::equal(found.all(), edges())) {
    report(-1, {-1, -1, -1}, "the list of edges is out of date");
  }
  return defects;
}

}  // namespace lagrain
