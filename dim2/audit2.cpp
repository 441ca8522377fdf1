// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation2.hpp>

#include "audit_sites.hpp"

#include <string>

namespace lagrain {

/// Checks that triangles are positive and share their edges, that these are locally regular, and
/// that vertices are known to have a corner.
void Triangulation<2>::audit_simplices(std::vector<Defect>& defects) const {
  for (int t = 0; t < topology_.slots(); ++t) {
    if (!topology_.alive(t)) continue;
    const auto v = corners_of(t);
    const auto report_triangle = [&](const std::array<int, 3>& sites, const std::string& sentence) {
      defects.push_back({t, sites, sentence});
    };
    if (!positive(sites_.data(), v[0], v[1], v[2])) {
      report_triangle(v, "the triangle is not counter-clockwise");
    }
    if (!topology_.at_rest(t)) report_triangle(v, "a flag or mark is left from an update");
    for (int corner = 4 * t; corner < 4 * t + 3; ++corner) {
      const int other = topology_.twin(corner);
      if (other < 0 || other >> 2 >= topology_.slots() || (other & 3) == 3 ||
          topology_.twin(other) != corner || !topology_.alive(other >> 2) ||
          topology_.source(corner) != topology_.target(other) ||
          topology_.target(corner) != topology_.source(other)) {
        report_triangle(v, "two neighbours do not share their edge");
      } else if (corner < other && !locally_regular(corner)) {
        report_triangle(
            {topology_.source(corner), topology_.target(corner), topology_.vertex(other)},
            "the edge of the first two sites is not locally regular against the third");
      }
      if (topology_.vertex(corner) >= 0 && topology_.corner_of(topology_.vertex(corner)) < 0) {
        report_triangle(v, "a vertex of the triangle has no corner");
      }
    }
  }
}

/// Checks that there are as many triangles as a sphere has, and that the hull goes round once.
void Triangulation<2>::audit_sphere(std::vector<Defect>& defects) const {
  // Euler's relation on a sphere, the vertex at infinity included.
  const int vertices = visible_sites() + auxiliary_sites() + 1;
  if (topology_.triangles() != 2 * vertices - 4) add_defect(defects, -1, "Euler's relation fails");
  if (!hull_goes_round_once()) add_defect(defects, -1, "the hull does not go round once");
}

template std::vector<Triangulation<2>::Defect> detail::MovingSites<2>::audit() const;

}  // namespace lagrain
