// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/wall_pieces.hpp>

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

// ---- Segments ----------------------------------------------------------------------------------

Vec<2> WallSegment::nearest(const Vec<2>& x) const {
  const double t = std::clamp((x - from_).dot(along_) / along_.squaredNorm(), 0.0, 1.0);
  return from_ + t * along_;
}

Feature WallSegment::feature(const Vec<2>& foot, double seam) const {
  const bool at_end = (foot - from_).norm() <= seam || (foot - to_).norm() <= seam;
  return at_end ? Feature::corner : Feature::face;
}

// ---- Arcs --------------------------------------------------------------------------------------

std::string Arc::defect(const Vec<2>& from, const Vec<2>& through, const Vec<2>& to) {
  const Vec<2> a = through - from, b = to - from;
  const double size = std::max({a.norm(), b.norm(), (b - a).norm()});
  const double little = kSeam * size;
  if (!(a.norm() > little && b.norm() > little && (b - a).norm() > little)) {
    return "two of the points of an arc are one";
  }
  if (std::abs(a[0] * b[1] - a[1] * b[0]) <= little * size) {
    return "the points of an arc lie on a line";
  }
  return "";
}

Arc::Arc(const Vec<2>& from, const Vec<2>& through, const Vec<2>& to)
    : from_(from), through_(through), to_(to) {
  const std::string why = defect(from, through, to);
  LAGRAIN_EXPECTS(why.empty(), why);
  // The centre c is as far from all three: 2 (c - from) . a = a . a, and the same for b.
  const Vec<2> a = through - from, b = to - from;
  const double area = a[0] * b[1] - a[1] * b[0];
  const double aa = a.squaredNorm() / (2 * area), bb = b.squaredNorm() / (2 * area);
  const Vec<2> to_centre(aa * b[1] - bb * a[1], bb * a[0] - aa * b[0]);
  centre_ = from + to_centre;
  radius_ = to_centre.norm();
  turn_ = area > 0 ? 1 : -1;
  start_ = std::atan2(-to_centre[1], -to_centre[0]);
  sweep_ = angle_along(to - centre_);
}

double Arc::angle_along(const Vec<2>& arm) const {
  const double angle = turn_ * (std::atan2(arm[1], arm[0]) - start_);
  return angle - 2 * std::numbers::pi * std::floor(angle / (2 * std::numbers::pi));
}

Vec<2> Arc::nearest(const Vec<2>& x) const {
  const Vec<2> arm = x - centre_;
  if (!arm.isZero(0) && angle_along(arm) <= sweep_) return centre_ + radius_ * arm.normalized();
  return (x - from_).squaredNorm() <= (x - to_).squaredNorm() ? from_ : to_;
}

Feature Arc::feature(const Vec<2>& foot, double seam) const {
  const bool at_end = (foot - from_).norm() <= seam || (foot - to_).norm() <= seam;
  return at_end ? Feature::corner : Feature::face;
}

// Not the radius: a short arc of a wide circle has a narrow seam.
double Arc::size() const { return box().diagonal().norm(); }

Eigen::AlignedBox2d Arc::box() const {
  Eigen::AlignedBox2d box(from_);
  box.extend(to_);
  for (const Vec<2>& direction : {Vec<2>(1, 0), Vec<2>(0, 1), Vec<2>(-1, 0), Vec<2>(0, -1)}) {
    if (angle_along(direction) <= sweep_) box.extend(centre_ + radius_ * direction);
  }
  return box;
}

// ---- Plates ------------------------------------------------------------------------------------

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
  const std::string why = defect(corners_);
  LAGRAIN_EXPECTS(why.empty(), why);
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

Eigen::AlignedBox3d Plate::box() const {
  Eigen::AlignedBox3d box;
  for (const Vec<3>& corner : corners_) box.extend(corner);
  return box;
}

// ---- Frusta ------------------------------------------------------------------------------------

namespace {

/// A place of space seen from the axis of a frustum: how far out and how far along it is, and in
/// which direction.
struct OnMeridian {
  double out, along;
  Vec<3> outwards;

  OnMeridian(const Frustum& frustum, const Vec<3>& x) {
    const Vec<3> arm = x - frustum.base;
    along = arm.dot(frustum.axis);
    const Vec<3> radial = arm - along * frustum.axis;
    out = radial.norm();
    outwards = out > 0 ? Vec<3>(radial / out) : any_normal<3>(frustum.axis);
  }
};

}  // namespace

std::string Frustum::defect() const {
  if (!(std::abs(axis.squaredNorm() - 1) < 1e-9)) return "the axis has no direction";
  if (!std::isfinite(size() * size())) return "it is too large for its size to be squared";
  if (!(height >= 0 && low_radius >= 0 && high_radius >= 0)) {
    return "height and radii are not negative";
  }
  if (!(size() > 0) || (low_radius == 0 && high_radius == 0)) {
    return "a surface needs a radius above 0, and a height or two radii that differ";
  }
  if (height == 0 && low_radius == high_radius) {
    return "a ring needs two radii that differ";
  }
  return "";
}

Vec<3> Frustum::nearest(const Vec<3>& x) const {
  const OnMeridian at(*this, x);
  const double wider = high_radius - low_radius;
  const double t = std::clamp(
      ((at.out - low_radius) * wider + at.along * height) / (wider * wider + height * height), 0.0,
      1.0);
  return base + t * height * axis + (low_radius + t * wider) * at.outwards;
}

Vec<3> Frustum::normal_at(const Vec<3>& foot) const {
  return (height * OnMeridian(*this, foot).outwards - (high_radius - low_radius) * axis)
      .normalized();
}

Feature Frustum::feature(const Vec<3>& foot, double seam) const {
  const OnMeridian at(*this, foot);
  const auto rim = [&](double radius, double along) {
    if (std::hypot(at.out - radius, at.along - along) > seam) return Feature::face;
    if (radius > seam) return Feature::edge;
    return height > 0 ? Feature::corner : Feature::face;  // a tip, or the middle of a disc
  };
  return std::min(rim(low_radius, 0), rim(high_radius, height));
}

double Frustum::size() const { return std::max({height, 2 * low_radius, 2 * high_radius}); }

Eigen::AlignedBox3d Frustum::box() const {
  const Vec<3> wide = (1 - axis.array().square()).max(0).sqrt();
  const Vec<3> end = base + height * axis;
  Eigen::AlignedBox3d box(base - low_radius * wide, base + low_radius * wide);
  return box.extend(Eigen::AlignedBox3d(end - high_radius * wide, end + high_radius * wide));
}

// ---- Sheets ------------------------------------------------------------------------------------

namespace {

namespace geometry = boost::geometry;

template <int Dim>
using TreePoint = geometry::model::point<double, Dim, geometry::cs::cartesian>;
template <int Dim>
using TreeBox = geometry::model::box<TreePoint<Dim>>;

template <int Dim>
TreePoint<Dim> tree_point(const Vec<Dim>& x) {
  TreePoint<Dim> point;
  geometry::set<0>(point, x[0]);
  geometry::set<1>(point, x[1]);
  if constexpr (Dim == 3) geometry::set<2>(point, x[2]);
  return point;
}

template <int Dim>
Eigen::AlignedBox<double, Dim> box_of(const WallPiece<Dim>& piece) {
  return std::visit([](const auto& p) { return p.box(); }, piece);
}

template <int Dim>
double squared_distance(const WallPiece<Dim>& piece, const Vec<Dim>& x) {
  return std::visit([&](const auto& p) { return (p.nearest(x) - x).squaredNorm(); }, piece);
}

/// Up to so many pieces are looked at one by one. It was not tuned; only speed depends on it.
constexpr std::size_t kFew = 8;

}  // namespace

template <int Dim>
struct Sheet<Dim>::Tree {
  using Entry = std::pair<TreeBox<Dim>, int>;
  geometry::index::rtree<Entry, geometry::index::rstar<16>> boxes;
};

template <int Dim>
Sheet<Dim>::Sheet(std::vector<WallPiece<Dim>> pieces) {
  LAGRAIN_EXPECTS(!pieces.empty(), "a wall without pieces");
  Parts parts;
  parts.smallest = std::numeric_limits<double>::infinity();
  std::vector<typename Tree::Entry> entries;
  for (const WallPiece<Dim>& piece : pieces) {
    const Box box = box_of<Dim>(piece);
    const double size = std::visit([](const auto& p) { return p.size(); }, piece);
    parts.box.extend(box);
    parts.largest = std::max(parts.largest, size);
    parts.smallest = std::min(parts.smallest, size);
    // The corner of the box that is furthest from 0.
    parts.extent =
        std::max(parts.extent, box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm());
    entries.emplace_back(TreeBox<Dim>(tree_point<Dim>(box.min()), tree_point<Dim>(box.max())),
                         static_cast<int>(entries.size()));
  }
  parts.pieces = std::move(pieces);
  if (entries.size() > kFew) {
    auto tree = std::make_shared<Tree>();
    tree->boxes = decltype(tree->boxes)(entries.begin(), entries.end());
    parts.tree = std::move(tree);
  }
  parts_ = std::make_shared<const Parts>(std::move(parts));
}

template <int Dim>
void Sheet<Dim>::near(const Vec<Dim>& x, double reach, std::vector<int>& found) const {
  found.clear();
  if (box().exteriorDistance(x) > reach) return;
  if (!parts_->tree) {
    for (std::size_t k = 0; k < pieces().size(); ++k) found.push_back(static_cast<int>(k));
    return;
  }
  const Vec<Dim> far = Vec<Dim>::Constant(reach);
  const TreeBox<Dim> around(tree_point<Dim>(x - far), tree_point<Dim>(x + far));
  const auto& boxes = parts_->tree->boxes;
  for (auto entry = boxes.qbegin(geometry::index::intersects(around)); entry != boxes.qend();
       ++entry) {
    found.push_back(entry->second);
  }
  std::sort(found.begin(), found.end());
}

template <int Dim>
int Sheet<Dim>::nearest_piece(const Vec<Dim>& x) const {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto look_at = [&](int k) {
    const double distance = squared_distance<Dim>(piece(k), x);
    if (distance > least || (distance == least && k > nearest)) return;
    least = distance;
    nearest = k;
  };
  if (!parts_->tree) {
    for (std::size_t k = 0; k < pieces().size(); ++k) look_at(static_cast<int>(k));
    return nearest;
  }
  // No piece is nearer than its box, so that of the nearest box tells how far to look. To visit the
  // boxes in the order of their distance takes the tree as long as to sort all of them.
  for (auto entry = parts_->tree->boxes.qbegin(geometry::index::nearest(tree_point<Dim>(x), 1));
       entry != parts_->tree->boxes.qend(); ++entry) {
    look_at(entry->second);
  }
  constexpr double kHair = 1 + 1e-12;  // rounding cannot hide a piece
  std::vector<int> found;
  near(x, std::sqrt(least) * kHair, found);
  for (const int k : found) look_at(k);
  return nearest;
}

template class Sheet<2>;
template class Sheet<3>;

}  // namespace lagrain
