// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/walls.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace lagrain {

namespace {

/// A vector along the normal of a polygon, as long as twice its area [m^2].
Vec<3> twice_area(const std::vector<Vec<3>>& corners) {
  Vec<3> sum = Vec<3>::Zero();
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    sum += (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]);
  }
  return sum;
}

double size_of(const std::vector<Vec<3>>& corners) {
  double size = 0;
  for (const Vec<3>& corner : corners) size = std::max(size, (corner - corners[0]).norm());
  return size;
}

}  // namespace

std::string Plate::defect(const std::vector<Vec<3>>& corners) {
  const std::size_t n = corners.size();
  if (n < 3) return "a plate needs at least 3 corners";
  const double size = size_of(corners);
  const double little = kSeam * size;
  const auto corner = [](std::size_t k) { return "corner " + std::to_string(k + 1) + " "; };
  Vec<3> along = Vec<3>::Zero();
  double width = 0;  // of the polygon across `along`
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t j = 0; j < k; ++j) {
      if ((corners[j] - corners[k]).norm() > little) continue;
      return corner(j) + "and corner " + std::to_string(k + 1) + " are one point";
    }
    const Vec<3> arm = corners[k] - corners[0];
    if (along.isZero(0)) along = arm.normalized();
    width = std::max(width, along.cross(arm).norm());
  }
  if (width <= little) return "the corners lie on a line";
  if (twice_area(corners).norm() <= little * size) return "the edges cross each other";
  const Vec<3> normal = twice_area(corners).normalized();
  for (std::size_t k = 0; k < n; ++k) {
    if (std::abs((corners[k] - corners[0]).dot(normal)) <= little) continue;
    return corner(k) +
           "does not lie in a plane with the others; give a plate of three corners each";
  }
  for (std::size_t k = 0; k < n; ++k) {
    const Vec<3> outwards = (corners[(k + 1) % n] - corners[k]).cross(normal).normalized();
    for (std::size_t j = 0; j < n; ++j) {
      if ((corners[j] - corners[k]).dot(outwards) <= little) continue;
      return "the corners make no convex polygon in this order: " + corner(j) +
             "lies outside of the edge from corner " + std::to_string(k + 1) +
             "; give several plates";
    }
  }
  return "";
}

Plate::Plate(std::vector<Vec<3>> corners) : corners_(std::move(corners)) {
  LAGRAIN_EXPECTS(defect(corners_).empty(), defect(corners_));
  normal_ = twice_area(corners_).normalized();
  size_ = size_of(corners_);
}

Vec<3> Plate::nearest(const Vec<3>& x) const {
  bool inside = true;
  double least = std::numeric_limits<double>::infinity();  // squared distance to an edge
  Vec<3> nearest = corners_[0];
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    const Vec<3> edge = corners_[(k + 1) % corners_.size()] - corners_[k];
    const Vec<3> from_corner = x - corners_[k];
    if (edge.cross(normal_).dot(from_corner) < 0) continue;
    inside = false;
    const double t = std::clamp(from_corner.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    const Vec<3> foot = corners_[k] + t * edge;
    const double squared_distance = (x - foot).squaredNorm();
    if (squared_distance >= least) continue;
    least = squared_distance;
    nearest = foot;
  }
  return inside ? x - (x - corners_[0]).dot(normal_) * normal_ : nearest;
}

Feature Plate::feature(const Vec<3>& foot, double seam) const {
  int edges_at_hand = 0;
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    const Vec<3>& from = corners_[k];
    const Vec<3> edge = corners_[(k + 1) % corners_.size()] - from;
    if ((foot - from).norm() <= seam) return Feature::corner;
    if (edge.cross(normal_).dot(foot - from) > -seam * edge.norm()) ++edges_at_hand;
  }
  return edges_at_hand == 0 ? Feature::face : edges_at_hand == 1 ? Feature::edge : Feature::corner;
}

namespace {

/// The seam of a surface is at most this part of its smallest wall [-], however large the others
/// are. It was not tuned: it only has to be small.
constexpr double kSmall = 1e-3;

/// Feet this close to each other are on the joint of two walls, or on both of two that lie on
/// each other.
template <int Dim>
double seam_of(const Wall<Dim>& a, const Wall<Dim>& b) {
  const double sizes[] = {a.size(), b.size()};
  const double larger = std::max(sizes[0], sizes[1]);
  return kSeam * (std::isfinite(larger) ? larger : std::min(sizes[0], sizes[1]));
}

/// Whether the boxes around two walls overlap, or come within a seam of each other; a wall without
/// an end has no box.
template <int Dim>
bool may_meet(const Wall<Dim>& a, const Wall<Dim>& b) {
  if (!a.has_end() && !b.has_end()) return false;
  const double seam = seam_of(a, b);
  if (!a.has_end() || !b.has_end()) {
    const std::vector<Vec<Dim>> corners = (a.has_end() ? a : b).corners();
    return std::any_of(corners.begin(), corners.end(), [&](const Vec<Dim>& corner) {
      return std::abs((a.has_end() ? b : a).foot(corner).distance) <= seam;
    });
  }
  const auto box_of = [](const Wall<Dim>& wall) {
    Eigen::AlignedBox<double, Dim> box;
    for (const Vec<Dim>& corner : wall.corners()) box.extend(corner);
    return box;
  };
  return box_of(a).exteriorDistance(box_of(b)) <= seam;
}

}  // namespace

template <int Dim>
void join_walls(std::vector<Wall<Dim>>& walls) {
  for (Wall<Dim>& wall : walls) wall.joined.clear();
  for (std::size_t a = 0; a < walls.size(); ++a) {
    for (std::size_t b = a + 1; b < walls.size(); ++b) {
      const bool may_come_to_meet =
          walls[a].has_end() && walls[b].has_end() && (walls[a].moves() || walls[b].moves());
      if (!may_come_to_meet && !may_meet(walls[a], walls[b])) continue;
      walls[a].joined.push_back(static_cast<int>(b));
      walls[b].joined.push_back(static_cast<int>(a));
    }
  }
  // Walls that hang together share one seam, so that each of them judges a joint alike.
  std::vector<bool> seen(walls.size());
  for (std::size_t first = 0; first < walls.size(); ++first) {
    if (seen[first] || walls[first].joined.empty()) continue;
    std::vector<std::size_t> surface{first};
    seen[first] = true;
    double smallest = std::numeric_limits<double>::infinity(), largest = 0;
    for (std::size_t k = 0; k < surface.size(); ++k) {
      const Wall<Dim>& wall = walls[surface[k]];
      smallest = std::min(smallest, wall.size());
      if (wall.has_end()) largest = std::max(largest, wall.size());
      for (const int o : wall.joined) {
        const auto next = static_cast<std::size_t>(o);
        if (seen[next]) continue;
        seen[next] = true;
        surface.push_back(next);
      }
    }
    for (const std::size_t w : surface) {
      walls[w].seam = std::min(kSeam * largest, kSmall * smallest);
    }
  }
}

template void join_walls<2>(std::vector<Wall<2>>&);
template void join_walls<3>(std::vector<Wall<3>>&);

namespace {

/// The point of one wall that is nearest to a grain's centre.
template <int Dim>
struct Candidate {
  int wall;
  double distance;
  Vec<Dim> foot;
  Feature feature;
};

/// Whether the candidate `own` of a list is a contact of the surface that their walls
/// make together.
///
/// From a foot that lies on another wall, to a seam, the way leads to the foot of that wall unless
/// it is further away by more than a seam. A candidate from which every way leads back is a minimum
/// of the distance. All those on its ways are the same minimum: that with most to it carries (a
/// face before an edge before a corner), the nearer before the further, the first before the last.
/// From a face a way leads only to another face that lies on it.
template <int Dim>
bool is_contact(const std::vector<Candidate<Dim>>& list, std::size_t own, const Wall<Dim>* walls,
                double seam) {
  const std::size_t n = list.size();
  const auto leads_to = [&](const Candidate<Dim>& one, const Candidate<Dim>& other) {
    if (other.distance > one.distance + seam) return false;
    if (one.feature == Feature::face && other.feature != Feature::face) return false;
    if (one.feature == Feature::face) return (one.foot - other.foot).norm() <= 2 * seam;
    return std::abs(walls[other.wall].foot(one.foot).distance) <= seam;
  };
  const auto reached_from = [&](std::size_t start) {
    std::vector<bool> reached(n);
    std::vector<std::size_t> way{start};
    reached[start] = true;
    while (!way.empty()) {
      const std::size_t at = way.back();
      way.pop_back();
      for (std::size_t k = 0; k < n; ++k) {
        if (reached[k] || !leads_to(list[at], list[k])) continue;
        reached[k] = true;
        way.push_back(k);
      }
    }
    return reached;
  };
  const std::vector<bool> minimum = reached_from(own);
  const auto rank = [&](std::size_t k) {
    return std::tuple(-static_cast<int>(list[k].feature), list[k].distance, list[k].wall);
  };
  for (std::size_t k = 0; k < n; ++k) {
    if (k == own || !minimum[k]) continue;
    if (rank(k) < rank(own) || !reached_from(k)[own]) return false;
  }
  return true;
}

}  // namespace

namespace detail {

template <int Dim>
typename Wall<Dim>::Foot foot_on_surface(const Wall<Dim>* walls, int w, const Vec<Dim>& x) {
  const auto own = walls[w].foot(x);
  const double seam = walls[w].seam;
  std::vector<Candidate<Dim>> list;
  const auto add = [&](int wall, const typename Wall<Dim>::Foot& foot) {
    const Vec<Dim> point = x - foot.distance * foot.normal;
    list.push_back({wall, foot.distance, point, walls[wall].feature(point, seam)});
  };
  for (const int o : walls[w].joined) {
    const auto foot = walls[o].foot(x);
    if (foot.distance <= own.distance + 2 * seam) add(o, foot);
  }
  if (list.empty()) return own;
  add(w, own);
  if (is_contact<Dim>(list, list.size() - 1, walls, seam)) return own;
  return {std::numeric_limits<double>::max(), own.normal};
}

template Wall<2>::Foot foot_on_surface<2>(const Wall<2>*, int, const Vec<2>&);
template Wall<3>::Foot foot_on_surface<3>(const Wall<3>*, int, const Vec<3>&);

}  // namespace detail

}  // namespace lagrain
