// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/laguerre3.hpp>

#include <lagrain/check.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

namespace lagrain {

namespace {

using Polygon = std::vector<Vec<3>>;

/// The points with normal . x <= offset, and what lies beyond.
struct HalfSpace {
  Vec<3> normal;  // of length 1
  double offset;
  int beyond;
};

/// Keeps the part of a convex polygon in a half-space (Sutherland & Hodgman, Commun. ACM 17
/// (1974) 32).
void cut(Polygon& polygon, Polygon& scratch, const HalfSpace& keep) {
  scratch.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec<3>& p = polygon[k];
    const Vec<3>& q = polygon[(k + 1) % polygon.size()];
    const double beyond_p = keep.normal.dot(p) - keep.offset;
    const double beyond_q = keep.normal.dot(q) - keep.offset;
    if (beyond_p <= 0) scratch.push_back(p);
    if ((beyond_p < 0 && beyond_q > 0) || (beyond_p > 0 && beyond_q < 0)) {
      scratch.emplace_back(p + beyond_p / (beyond_p - beyond_q) * (q - p));
    }
  }
  polygon.swap(scratch);
}

/// A square in a plane, counter-clockwise seen from where the normal points, that holds all points
/// of the plane within `reach` of the origin.
/// @pre the plane is at most `reach` from the origin
Polygon square(const HalfSpace& plane, double reach) {
  const Vec<3> foot = plane.offset * plane.normal;
  const Vec<3> u = plane.normal.unitOrthogonal() * reach, v = plane.normal.cross(u);
  return {foot - u - v, foot + u - v, foot + u + v, foot - u + v};
}

/// Leaves out corners that are no farther than `rounding` from their neighbours or from the line
/// between them; empties what is narrower.
void tidy(Polygon& polygon, double rounding) {
  for (std::size_t k = 0; k < polygon.size() && polygon.size() > 2;) {
    const std::size_t count = polygon.size();
    const Vec<3> back = polygon[(k + count - 1) % count] - polygon[k];
    const Vec<3> ahead = polygon[(k + 1) % count] - polygon[k];
    const double height = back.cross(ahead).norm();
    if (back.norm() <= rounding || height <= rounding * (ahead - back).norm()) {
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(k));
    } else {
      ++k;
    }
  }
  if (polygon.size() < 3) polygon.clear();
}

/// Calls f(a, b, c) for triangles that fill the faces, as seen from the first corner of the first.
template <class F>
void for_each_triangle(const std::vector<LaguerreFace>& faces, F&& f) {
  for (const LaguerreFace& face : faces) {
    const Vec<3> from = faces[0].corners.col(0);
    for (Eigen::Index k = 2; k < face.corners.cols(); ++k) {
      f(Vec<3>(face.corners.col(0) - from), Vec<3>(face.corners.col(k - 1) - from),
        Vec<3>(face.corners.col(k) - from));
    }
  }
}

}  // namespace

std::vector<LaguerreFace> laguerre_cell(const Triangulation<3>& triangulation, int site,
                                        const Eigen::AlignedBox3d& box) {
  LAGRAIN_EXPECTS(triangulation.contains(site), "site " + std::to_string(site) + " is not present");
  LAGRAIN_EXPECTS(!box.isEmpty() && box.volume() > 0, "the box has no volume");
  const auto hidden = triangulation.hidden();
  if (std::binary_search(hidden.begin(), hidden.end(), site)) return {};

  // Relative to the site, so that a far origin costs no digits.
  const Vec<3> centre = triangulation.site(site);
  const Vec<3> low = box.min() - centre, high = box.max() - centre;
  const double reach = low.cwiseAbs().cwiseMax(high.cwiseAbs()).norm();
  std::vector<HalfSpace> bounds;
  triangulation.for_each_neighbour(site, [&](int j) {
    const Vec<3> away = triangulation.site(j) - centre;
    const double lead = triangulation.weight(site) - triangulation.weight(j);
    const double distance = away.norm();
    bounds.push_back({away / distance, (distance + lead / distance) / 2, j});
  });
  for (int axis = 0; axis < 3; ++axis) {
    const Vec<3> normal = Vec<3>::Unit(axis);
    bounds.push_back({-normal, -low[axis], box_side(axis, false)});
    bounds.push_back({normal, high[axis], box_side(axis, true)});
  }
  // Near planes first: they leave short edges, and corners on short edges are rounded less.
  std::stable_sort(bounds.begin(), bounds.end(), [](const HalfSpace& a, const HalfSpace& b) {
    return std::abs(a.offset) < std::abs(b.offset);
  });

  const double rounding = 0x1p-46 * reach;
  std::vector<LaguerreFace> faces;
  Polygon polygon, scratch;
  for (auto plane = bounds.begin(); plane != bounds.end(); ++plane) {
    if (std::abs(plane->offset) > reach) continue;
    polygon = square(*plane, reach);
    for (auto other = bounds.begin(); other != bounds.end() && !polygon.empty(); ++other) {
      if (other == plane) continue;
      cut(polygon, scratch, *other);
      // Of two equal planes (a side of the box may be one) the first has the face.
      if (other < plane && std::all_of(polygon.begin(), polygon.end(), [&](const Vec<3>& p) {
            return other->normal.dot(p) > other->offset - rounding;
          })) {
        polygon.clear();
      }
    }
    tidy(polygon, rounding);
    if (polygon.empty()) continue;
    LaguerreFace face{plane->beyond, Columns<3>(3, static_cast<Eigen::Index>(polygon.size()))};
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      face.corners.col(static_cast<Eigen::Index>(k)) = polygon[k] + centre;
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

double polyhedron_volume(const std::vector<LaguerreFace>& faces) {
  double six = 0;
  for_each_triangle(
      faces, [&](const Vec<3>& a, const Vec<3>& b, const Vec<3>& c) { six += a.dot(b.cross(c)); });
  return six / 6;
}

Vec<3> polyhedron_centroid(const std::vector<LaguerreFace>& faces) {
  LAGRAIN_EXPECTS(!faces.empty(), "nothing has no centre");
  double six = 0;
  Vec<3> moment = Vec<3>::Zero();
  for_each_triangle(faces, [&](const Vec<3>& a, const Vec<3>& b, const Vec<3>& c) {
    const double part = a.dot(b.cross(c));
    six += part;
    moment += part * (a + b + c) / 4;
  });
  return faces[0].corners.col(0) + moment / six;
}

}  // namespace lagrain
