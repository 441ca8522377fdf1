#include <lagrain/triangulation2.hpp>

#include "audit_sites.hpp"

#include <algorithm>
#include <string>

namespace lagrain {

/// What is kept beside the triangles comes last: it is checked against triangles that are right.
std::vector<Triangulation<2>::Defect> Triangulation<2>::audit() const {
  std::vector<Defect> defects;
  const auto report = [&](int site, const std::string& sentence) {
    defects.push_back({-1, {site, -1, -1}, sentence});
  };
  const auto report_triangle = [&](int triangle, const std::array<int, 3>& sites,
                                   const std::string& sentence) {
    defects.push_back({triangle, sites, sentence});
  };

  detail::audit_sites<Topology2, Site2>(topology_, size(), 0, sites_, before_, present_, hidden_,
                                        report);
  if (last_ < 0 || last_ > size()) report(-1, "the search for the next site begins nowhere");
  if (dimension_ < 2) {
    audit_line(report);
  } else {
    audit_triangles(report, report_triangle);
  }
  if (!defects.empty()) return defects;

  if (dimension_ >= 2) {
    if (dimension_ > 2) report(-1, "the dimension is wrong");
    if (!hull_goes_round_once()) report(-1, "the hull does not go round once");
    for (const int id : hidden_) {
      const int t = locate(id, visible_from(id));
      if (topology_.infinite(t) || conflict(t, id)) {
        report_triangle(t, {id, -1, -1}, "the hidden site has a cell");
      }
    }
  }
  EdgeList found;
  find_edges(found);
  if (const std::string wrong = edges_.audit(found); !wrong.empty()) report(-1, wrong);
  const auto zero = [](int note) { return note == 0; };
  const auto past = [&](int epoch) { return epoch <= epoch_; };
  if (!std::all_of(site_count_.begin(), site_count_.end(), zero) ||
      !std::all_of(site_epoch_.begin(), site_epoch_.end(), past)) {
    report(-1, "a note of a site is left from an update");
  }
  return defects;
}

/// The line is that of a fresh build, and its sites know their places in it.
template <class Report>
void Triangulation<2>::audit_line(Report&& report) const {
  Triangulation<2> fresh = *this;
  fresh.rebuild();
  if (fresh.dimension_ != dimension_ || fresh.line_ != line_ || fresh.hidden_ != hidden_ ||
      topology_.slots() != 0) {
    report(-1, "the line differs from a fresh one");
  }
  for (std::size_t k = 0; k < line_.size(); ++k) {
    if (topology_.corner_of(line_[k]) != static_cast<int>(k)) {
      report(line_[k], "the place of the site in the line belongs to another");
    }
  }
}

/// Positive triangles that share their edges, are locally regular and have corners that are known
/// at their sites; and as many of them as a sphere has.
template <class Report, class ReportTriangle>
void Triangulation<2>::audit_triangles(Report&& report, ReportTriangle&& report_triangle) const {
  if (!line_.empty()) report(-1, "there is a line beside the triangles");
  if (!detail::free_slots_are_dead(topology_)) report(-1, "the list of free slots is wrong");
  for (int t = 0; t < topology_.slots(); ++t) {
    if (!topology_.alive(t)) continue;
    const auto v = corners_of(t);
    if (!positive(sites_.data(), v[0], v[1], v[2])) {
      report_triangle(t, v, "the triangle is not counter-clockwise");
    }
    if (!topology_.at_rest(t, epoch_)) {
      report_triangle(t, v, "a flag or mark is left from an update");
    }
    for (int corner = 4 * t; corner < 4 * t + 3; ++corner) {
      const int other = topology_.twin(corner);
      if (other < 0 || other >> 2 >= topology_.slots() || (other & 3) == 3 ||
          topology_.twin(other) != corner || !topology_.alive(other >> 2) ||
          topology_.source(corner) != topology_.target(other) ||
          topology_.target(corner) != topology_.source(other)) {
        report_triangle(t, v, "two neighbours do not share their edge");
      } else if (corner < other && !locally_regular(corner)) {
        report_triangle(
            t, {topology_.source(corner), topology_.target(corner), topology_.vertex(other)},
            "the edge of the first two sites is not locally regular against the third");
      }
      if (topology_.vertex(corner) >= 0 && topology_.corner_of(topology_.vertex(corner)) < 0) {
        report_triangle(t, v, "a vertex of the triangle has no corner");
      }
    }
  }
  int vertices = 0;
  for (int id = -1; id < size(); ++id) {
    const int corner = topology_.corner_of(id);
    if (corner < 0 && id >= 0) continue;
    ++vertices;
    if (corner < 0 || corner >> 2 >= topology_.slots() || !topology_.alive(corner >> 2) ||
        topology_.vertex(corner) != id) {
      report(id, "the corner of the site belongs to another");
    }
  }
  // Euler on a sphere.
  if (topology_.triangles() != 2 * vertices - 4) report(-1, "Euler's relation fails");
}

}  // namespace lagrain
