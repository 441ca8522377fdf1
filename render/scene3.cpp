// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/scene3.hpp>

#include <lagrain/check.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace lagrain {

Eigen::Matrix3d page_axes(const Camera& camera) {
  const Vec<3> back = camera.eye - camera.target;
  const Vec<3> right = camera.up.cross(back);
  LAGRAIN_EXPECTS(right.norm() > 1e-9 * camera.up.norm() * back.norm(),
                  "Camera: the eye is at the target, or up points along the line of sight");
  Eigen::Matrix3d rows;
  rows.row(0) = right.normalized();
  rows.row(1) = back.cross(right).normalized();
  rows.row(2) = back.normalized();
  return rows;
}

Camera camera_framing(const Box3& box, const Vec<3>& direction, const Vec<3>& up, double aspect,
                      double field_of_view, double margin) {
  LAGRAIN_EXPECTS(box.size().minCoeff() >= 0 && box.size().maxCoeff() > 0,
                  "camera_framing: the box is a point or inside out");
  LAGRAIN_EXPECTS(aspect > 0 && field_of_view >= 0 && field_of_view < std::numbers::pi &&
                      margin >= 0 && margin < 0.5,
                  "camera_framing: aspect " + std::to_string(aspect) + ", field of view " +
                      std::to_string(field_of_view) + " rad, margin " + std::to_string(margin));
  Camera camera{box.centre() - direction, box.centre(), up, 1, field_of_view > 0};
  const Eigen::Matrix3d rows = page_axes(camera);

  // Seen from the eye (x, y, z) the picture is 2 t (z - c) high at the depth of a corner (a, b, c).
  // The corner lies inside it while |b - y| <= t (z - c). So all corners do while max(b + t c) is
  // at most y + t z, and min(b - t c) at least y - t z; and likewise across. Parallel lines of
  // sight are the limit t -> 0.
  const double shrink = 1 - 2 * margin, half = std::tan(0.5 * field_of_view) * shrink;
  const Vec<2> t(half * aspect, half);
  const double inf = std::numeric_limits<double>::infinity();
  Vec<2> most = Vec<2>::Constant(-inf), least = Vec<2>::Constant(inf);
  double nearest = -inf;
  for (int corner = 0; corner < 8; ++corner) {
    Vec<3> p = box.low;
    for (int k = 0; k < 3; ++k) {
      if ((corner >> k & 1) != 0) p[k] = box.high[k];
    }
    const Vec<3> q = rows * (p - box.centre());
    most = most.cwiseMax(Vec<2>(q.head<2>() + t * q[2]));
    least = least.cwiseMin(Vec<2>(q.head<2>() - t * q[2]));
    nearest = std::max(nearest, q[2]);
  }
  const Vec<2> middle = 0.5 * (most + least), extent = most - least;
  camera.target = box.centre() + rows.topRows<2>().transpose() * middle;
  double distance = 2 * box.size().norm();
  if (camera.perspective) {
    distance = (0.5 * extent.array() / t.array()).maxCoeff();
    camera.height = 2 * distance * std::tan(0.5 * field_of_view);
  } else {
    camera.height = std::max(extent[1], extent[0] / aspect) / shrink;
  }
  camera.eye = camera.target + distance * rows.row(2).transpose();
  return camera;
}

Lights over_the_shoulder(const Camera& camera) {
  // Columns: right, up, towards the viewer.
  const Eigen::Matrix3d page = page_axes(camera).transpose();
  Lights lights;
  lights.sun = page * Vec<3>(-0.4, 0.55, 1);
  lights.zenith = page * Vec<3>(0, 0.6, 0.8);
  return lights;
}

void add_edges(Scene3& scene, const Box3& box, const Stroke& stroke) {
  for (int along = 0; along < 3; ++along) {
    const int second = (along + 1) % 3, third = (along + 2) % 3;
    for (int k = 0; k < 4; ++k) {
      Vec<3> a = box.low;
      if ((k & 1) != 0) a[second] = box.high[second];
      if ((k & 2) != 0) a[third] = box.high[third];
      Vec<3> b = a;
      b[along] = box.high[along];
      scene.lines.push_back({a, b, stroke});
    }
  }
}

View3::View3(const Camera& camera, const Box& page)
    : axes_(page_axes(camera)),
      eye_(camera.eye),
      middle_(page.centre()),
      scale_(page.size()[1] / camera.height),
      distance_(camera.perspective ? (camera.eye - camera.target).norm() : 0) {
  LAGRAIN_EXPECTS(page.size().minCoeff() > 0 && camera.height > 0,
                  "View3: the page or the camera's height is not positive");
}

Vec<2> View3::point(const Vec<3>& world) const {
  return middle_ + scale(world) * (axes_.topRows<2>() * (world - eye_));
}

double View3::depth(const Vec<3>& world) const { return -axes_.row(2).dot(world - eye_); }

double View3::scale(const Vec<3>& world) const {
  return distance_ > 0 ? scale_ * distance_ / depth(world) : scale_;
}

}  // namespace lagrain
