// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/wall_shapes.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <variant>

namespace lagrain {
namespace {

template <int Dim>
using Facets = std::vector<std::vector<Vec<Dim>>>;

/// A point of a full turn, k facets on [m].
template <int Dim>
Vec<Dim> on_circle(const Vec<Dim>& centre, const Vec<Dim>& u, const Vec<Dim>& v, double radius,
                   int k) {
  const double angle = 2 * std::numbers::pi * k / kFacets;
  return centre + radius * (std::cos(angle) * u + std::sin(angle) * v);
}

/// The part of the plane or line through a point that lies in a box.
template <int Dim>
Facets<Dim> plane_in(const Vec<Dim>& point, const Vec<Dim>& normal,
                     const Eigen::AlignedBox<double, Dim>& box) {
  const double reach = box.diagonal().norm() + (point - box.center()).norm();
  if constexpr (Dim == 2) {
    // Liang and Barsky's way: the part of the line where it is within each pair of sides.
    const Vec<2> along(-normal[1], normal[0]);
    double from = -reach, to = reach;
    for (int d = 0; d < 2; ++d) {
      if (along[d] == 0) {
        if (point[d] < box.min()[d] || point[d] > box.max()[d]) return {};
        continue;
      }
      const double a = (box.min()[d] - point[d]) / along[d];
      const double b = (box.max()[d] - point[d]) / along[d];
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
    if (!(from < to)) return {};
    return {{point + from * along, point + to * along}};
  } else {
    const Vec<3> u = any_normal<3>(normal), v = normal.cross(u);
    std::vector<Vec<3>> polygon{point - reach * u - reach * v, point + reach * u - reach * v,
                                point + reach * u + reach * v, point - reach * u + reach * v};
    for (int d = 0; d < 3; ++d) {
      polygon = clipped(polygon, Vec<3>::Unit(d), box.min());
      polygon = clipped(polygon, -Vec<3>::Unit(d), box.max());
    }
    if (polygon.size() < 3) return {};
    return {polygon};
  }
}

/// The facets between two circles about one axis.
Facets<3> between_circles(const Vec<3>& low, double low_radius, const Vec<3>& high,
                          double high_radius, const Vec<3>& axis) {
  const Vec<3> u = any_normal<3>(axis), v = axis.cross(u);
  Facets<3> facets;
  for (int k = 0; k < kFacets; ++k) {
    std::vector<Vec<3>> facet{on_circle<3>(low, u, v, low_radius, k)};
    if (low_radius > 0) facet.push_back(on_circle<3>(low, u, v, low_radius, k + 1));
    facet.push_back(on_circle<3>(high, u, v, high_radius, k + 1));
    if (high_radius > 0) facet.push_back(on_circle<3>(high, u, v, high_radius, k));
    facets.push_back(std::move(facet));
  }
  return facets;
}

Facets<2> container(const Vec<2>& point, const Cylinder<2>& round,
                    const Eigen::AlignedBox<double, 2>&) {
  Facets<2> facets;
  for (int k = 0; k < kFacets; ++k) {
    facets.push_back({on_circle<2>(point, Vec<2>::UnitX(), Vec<2>::UnitY(), round.radius, k),
                      on_circle<2>(point, Vec<2>::UnitX(), Vec<2>::UnitY(), round.radius, k + 1)});
  }
  return facets;
}

Facets<3> container(const Vec<3>& point, const Cylinder<3>& round,
                    const Eigen::AlignedBox<double, 3>& box) {
  if (!round.axis.isZero(0)) {
    double low = 0, high = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec<3> x = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      low = std::min(low, round.axis.dot(x - point));
      high = std::max(high, round.axis.dot(x - point));
    }
    return between_circles(point + low * round.axis, round.radius, point + high * round.axis,
                           round.radius, round.axis);
  }
  Facets<3> facets;
  constexpr int kBands = kFacets / 2;
  const auto height = [&](int k) {
    return -round.radius * std::cos(std::numbers::pi * k / kBands);
  };
  const auto width = [&](int k) {
    return k == 0 || k == kBands ? 0 : round.radius * std::sin(std::numbers::pi * k / kBands);
  };
  for (int k = 0; k < kBands; ++k) {
    const Facets<3> band =
        between_circles(point + height(k) * Vec<3>::UnitZ(), width(k),
                        point + height(k + 1) * Vec<3>::UnitZ(), width(k + 1), Vec<3>::UnitZ());
    facets.insert(facets.end(), band.begin(), band.end());
  }
  return facets;
}

Facets<2> piece_facets(const WallSegment& segment) { return {{segment.from(), segment.to()}}; }

Facets<2> piece_facets(const Arc& arc) {
  const auto angle_of = [&](const Vec<2>& x) {
    return std::atan2(x[1] - arc.centre()[1], x[0] - arc.centre()[0]);
  };
  constexpr double kTurn = 2 * std::numbers::pi;
  const auto turned = [](double angle) { return angle < 0 ? angle + kTurn : angle; };
  const double start = angle_of(arc.from());
  double sweep = turned(angle_of(arc.to()) - start);
  if (turned(angle_of(arc.through()) - start) > sweep) sweep -= kTurn;
  const int count = std::max(1, static_cast<int>(std::ceil(kFacets * std::abs(sweep) / kTurn)));
  const auto at = [&](int k) -> Vec<2> {
    if (k == 0) return arc.from();
    if (k == count) return arc.to();
    const double angle = start + sweep * k / count;
    return arc.centre() + arc.radius() * Vec<2>(std::cos(angle), std::sin(angle));
  };
  Facets<2> facets;
  for (int k = 0; k < count; ++k) facets.push_back({at(k), at(k + 1)});
  return facets;
}

Facets<3> piece_facets(const Plate& plate) { return {plate.corners()}; }

Facets<3> piece_facets(const Frustum& side) {
  return between_circles(side.base, side.low_radius, side.base + side.height * side.axis,
                         side.high_radius, side.axis);
}

}  // namespace

std::vector<Vec<3>> clipped(const std::vector<Vec<3>>& polygon, const Vec<3>& normal,
                            const Vec<3>& point, double slack) {
  std::vector<Vec<3>> rest;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec<3>&a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double height_a = normal.dot(a - point) + slack;
    const double height_b = normal.dot(b - point) + slack;
    if (height_a >= 0) rest.push_back(a);
    if ((height_a < 0) != (height_b < 0)) {
      rest.push_back(a + height_a / (height_a - height_b) * (b - a));
    }
  }
  return rest;
}

template <int Dim>
std::vector<std::vector<Vec<Dim>>> facets_of(const Wall<Dim>& wall,
                                             const Eigen::AlignedBox<double, Dim>& box) {
  if (wall.gone) return {};
  if (const auto* plane = std::get_if<HalfSpace<Dim>>(&wall.shape)) {
    // It does not turn.
    return plane_in<Dim>(wall.point, plane->normal, box);
  }
  if (const auto* round = std::get_if<Cylinder<Dim>>(&wall.shape)) {
    return container(wall.point, *round, box);
  }
  const WallPose<Dim> pose = wall.pose();
  Facets<Dim> facets;
  for (const WallPiece<Dim>& piece : wall.pieces()->pieces()) {
    for (auto& facet : std::visit([](const auto& p) { return piece_facets(p); }, piece)) {
      for (Vec<Dim>& corner : facet) corner = pose.point + pose.frame * corner;
      facets.push_back(std::move(facet));
    }
  }
  return facets;
}

template std::vector<std::vector<Vec<2>>> facets_of<2>(const Wall<2>&,
                                                       const Eigen::AlignedBox<double, 2>&);
template std::vector<std::vector<Vec<3>>> facets_of<3>(const Wall<3>&,
                                                       const Eigen::AlignedBox<double, 3>&);

}  // namespace lagrain
