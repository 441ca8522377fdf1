// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Walls: half-spaces, segments, plates and cylinders, fixed or moving, as contact partners that
/// never turn. Walls that meet are one surface: contact_foot() says which of them a grain touches.

#include <lagrain/check.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace lagrain {

/// A plane (a line in 2D) with everything on its far side solid.
template <int Dim>
struct HalfSpace {
  Vec<Dim> normal;  ///< unit, towards the grains [-]
};

/// A straight wall in the plane from the wall's point to its other end, solid from both sides.
struct WallSegment {
  Vec<2> along;  ///< from the wall's point to the other end [m]
};

/// Walls meet where they come within this part of their size of each other, and what lies within it
/// of an edge or a corner counts as on it [-]. Rounding, and coordinates of seven digits, stay
/// below, and no grain feels a step of this height. With a tenth of it coordinates of seven digits
/// would leave joints open; ten times as much does the same.
inline constexpr double kSeam = 1e-6;

/// The part of a wall that its nearest point lies on: a corner, an edge (in space), or the inside
/// of its face. In order of their dimension.
enum class Feature { corner, edge, face };

/// A flat wall in space, a convex polygon, solid from both sides.
class Plate {
 public:
  /// @param corners  in their order around the plate, relative to the wall's point [m]
  /// @throws ContractError if they make no plate, see defect()
  explicit Plate(std::vector<Vec<3>> corners);
  /// Why corners make no plate: fewer than three, two on one spot, not in one plane (to kSeam of
  /// the plate's size), or not convex. Empty if they make one.
  static std::string defect(const std::vector<Vec<3>>& corners);

  const std::vector<Vec<3>>& corners() const { return corners_; }  ///< as they were given [m]
  const Vec<3>& normal() const { return normal_; }  ///< unit; the corners turn left about it [-]
  double size() const { return size_; }  ///< distance of the first corner from the furthest [m]

  /// The point of the plate that is nearest to x; both relative to the wall's point [m].
  Vec<3> nearest(const Vec<3>& x) const;
  /// What a point of the plate, relative to the wall's point, lies on, to a seam [m].
  Feature feature(const Vec<3>& foot, double seam) const;

 private:
  std::vector<Vec<3>> corners_;
  Vec<3> normal_;
  double size_ = 0;
};

/// A flat wall with an end to it: a segment in the plane, a plate in space.
template <int Dim>
using FlatPiece = std::conditional_t<Dim == 2, WallSegment, Plate>;

/// A round container: everything further than the radius from the axis, a line through the wall's
/// point, is solid. In the plane there is no axis: a circle about the point.
///
/// To a law the wall is flat (its curvature is left out of Hertz's effective radius): for grains
/// small against the container.
template <int Dim>
struct Cylinder {
  double radius;  ///< [m]
  Vec<Dim> axis;  ///< unit [-]; zero for a circle in the plane, and a ball in space
};

/// No motion.
struct Fixed {};

/// Motion with constant velocity between two times.
template <int Dim>
struct Steady {
  Vec<Dim> velocity;                                      ///< [m/s]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Harmonic motion between two times: displacement amplitude sin(2 pi frequency (t - start)). The
/// wall is at rest outside, after the end where it then is.
template <int Dim>
struct Shake {
  Vec<Dim> amplitude;                                     ///< [m]
  double frequency = 0;                                   ///< [Hz]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Motion of a guided mass along its load, pushed by the load and by the grains. It is held until
/// its start.
template <int Dim>
struct Piston {
  double mass;       ///< [kg]
  Vec<Dim> load;     ///< [N], its own weight included
  double start = 0;  ///< [s]
};

/// A wall and the force that the grains exert on it.
template <int Dim>
struct Wall {
  std::string name;                   ///< for people, and for the files of a run
  Vec<Dim> point = Vec<Dim>::Zero();  ///< now: on the plane, an end or corner, on the axis [m]
  /// The shape says what is solid.
  std::variant<HalfSpace<Dim>, FlatPiece<Dim>, Cylinder<Dim>> shape;
  /// The motion says how it moves.
  std::variant<Fixed, Steady<Dim>, Shake<Dim>, Piston<Dim>> motion = Fixed{};
  int material = 0;                      ///< row of the table of laws
  Vec<Dim> home = Vec<Dim>::Zero();      ///< where it was at time 0 [m], for motions given in time
  Vec<Dim> velocity = Vec<Dim>::Zero();  ///< [m/s]
  Vec<Dim> force = Vec<Dim>::Zero();     ///< by the grains, in the last step [N]
  std::vector<int> joined = {};          ///< walls that it forms one surface with, see join_walls
  double seam = 0;                       ///< to which joints of that surface are known [m]

  /// A fixed half-space.
  /// @param point   on the plane [m]
  /// @param normal  towards the grains, of any length
  static Wall half_space(std::string name, const Vec<Dim>& point, const Vec<Dim>& normal) {
    return {std::move(name), point, HalfSpace<Dim>{normal.normalized()}, Fixed{}, 0, point};
  }
  /// A fixed straight wall between two points of the plane [m].
  static Wall segment(std::string name, const Vec<2>& from, const Vec<2>& to) requires(Dim == 2) {
    return {std::move(name), from, WallSegment{to - from}, Fixed{}, 0, from};
  }
  /// A fixed convex plate in space.
  /// @param corners  in their order around the plate [m]
  /// @throws ContractError if they make no plate, see Plate::defect
  static Wall plate(std::string name, std::vector<Vec<3>> corners) requires(Dim == 3) {
    LAGRAIN_EXPECTS(!corners.empty(), "a plate without corners");
    const Vec<3> first = corners.front();
    for (Vec<3>& corner : corners) corner -= first;
    return {std::move(name), first, Plate(std::move(corners)), Fixed{}, 0, first};
  }
  /// A fixed round container.
  /// @param point  on the axis [m]
  /// @param axis   of any length; zero in the plane, and for a ball
  /// @param radius of the container [m]
  static Wall cylinder(std::string name, const Vec<Dim>& point, const Vec<Dim>& axis,
                       double radius) {
    return {std::move(name), point, Cylinder<Dim>{radius, axis.normalized()}, Fixed{}, 0, point};
  }

  /// Whether it can move at all.
  bool moves() const { return !std::holds_alternative<Fixed>(motion); }
  /// Whether a force moves it; the other walls stay, or follow their motion whatever pushes them.
  bool yields() const { return std::holds_alternative<Piston<Dim>>(motion); }

  /// The point of the wall that is nearest to a place.
  struct Foot {
    double distance;  ///< from the wall's surface; negative behind a half-space or a cylinder [m]
    Vec<Dim> normal;  ///< unit, from the wall towards the place [-]
  };
  /// The foot of x [m] on the wall as it is now.
  Foot foot(const Vec<Dim>& x) const {
    return std::visit([&](const auto& s) { return foot_on(s, x); }, shape);
  }
  /// What a point of the wall [m] lies on. Within `reach` [m] of an edge or corner it counts as
  /// lying on that.
  Feature feature(const Vec<Dim>& foot, double reach) const {
    const auto* piece = std::get_if<FlatPiece<Dim>>(&shape);
    if (!piece) return Feature::face;
    if constexpr (Dim == 2) {
      const bool at_end =
          (foot - point).norm() <= reach || (foot - point - piece->along).norm() <= reach;
      return at_end ? Feature::corner : Feature::face;
    } else {
      return piece->feature(foot - point, reach);
    }
  }
  /// Whether it has an end, so that one can go around it.
  bool has_end() const { return std::holds_alternative<FlatPiece<Dim>>(shape); }
  /// Corners of the wall as it is now [m]; empty for one without an end.
  std::vector<Vec<Dim>> corners() const {
    const auto* piece = std::get_if<FlatPiece<Dim>>(&shape);
    if (!piece) return {};
    if constexpr (Dim == 2) {
      return {point, point + piece->along};
    } else {
      std::vector<Vec<Dim>> list = piece->corners();
      for (Vec<Dim>& corner : list) corner += point;
      return list;
    }
  }

  /// How large a wall is that has an end to it [m]; infinite for the others.
  double size() const {
    const auto* piece = std::get_if<FlatPiece<Dim>>(&shape);
    if (!piece) return std::numeric_limits<double>::infinity();
    if constexpr (Dim == 2) {
      return piece->along.norm();
    } else {
      return piece->size();
    }
  }

  /// Visits, in increasing order, every grain i whose centre x.col(i) is no further than reach(i)
  /// [m] from the wall's surface.
  template <class Reach, class F>
  void for_each_within(const Columns<Dim>& x, Reach&& reach, F&& visit) const {
    const int n = static_cast<int>(x.cols());
    std::visit(
        [&](const auto& s) {
          for (int i = 0; i < n; ++i) {
            if (foot_on(s, x.col(i)).distance <= reach(i)) visit(i);
          }
        },
        shape);
  }

  /// Brings the wall to time t [s], a step dt [s] after the last call.
  void advance(double t, double dt) {
    std::visit([&](const auto& m) { follow(m, t, dt); }, motion);
  }

 private:
  Foot foot_on(const HalfSpace<Dim>& plane, const Vec<Dim>& x) const {
    return {(x - point).dot(plane.normal), plane.normal};
  }
  Foot foot_on(const FlatPiece<Dim>& piece, const Vec<Dim>& x) const {
    const Vec<Dim> away = x - nearest_on(piece, x);
    const double distance = away.norm();
    if (distance > 0) return {distance, away / distance};
    // A centre exactly on the wall is pushed out along a normal of it.
    if constexpr (Dim == 2) {
      return {0, any_normal(piece.along)};
    } else {
      return {0, piece.normal()};
    }
  }
  Foot foot_on(const Cylinder<Dim>& cylinder, const Vec<Dim>& x) const {
    const Vec<Dim> arm = x - point;
    const Vec<Dim> away = arm - arm.dot(cylinder.axis) * cylinder.axis;
    const double distance = away.norm();
    // On the axis all of the wall is equally far.
    if (distance == 0) return {cylinder.radius, any_normal(cylinder.axis)};
    return {cylinder.radius - distance, away / -distance};
  }

  Vec<2> nearest_on(const WallSegment& segment, const Vec<2>& x) const {
    const Vec<2>& along = segment.along;
    const double t = std::clamp((x - point).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return point + t * along;
  }
  Vec<3> nearest_on(const Plate& plate, const Vec<3>& x) const {
    return point + plate.nearest(x - point);
  }

  static Vec<Dim> any_normal(const Vec<Dim>& along) {
    if (along.isZero(0)) return Vec<Dim>::UnitX();
    Eigen::Index flattest = 0;
    along.cwiseAbs().minCoeff(&flattest);
    const Vec<Dim> n = Vec<Dim>::Unit(flattest);
    return (n - n.dot(along) / along.squaredNorm() * along).normalized();
  }

  void follow(const Fixed&, double, double) {}
  void follow(const Steady<Dim>& m, double t, double) {
    point = home + (std::clamp(t, m.start, m.stop) - m.start) * m.velocity;
    velocity = t >= m.start && t < m.stop ? m.velocity : Vec<Dim>(Vec<Dim>::Zero());
  }
  void follow(const Shake<Dim>& m, double t, double) {
    const double omega = 2 * std::numbers::pi * m.frequency;
    const bool on = t >= m.start && t < m.stop;
    const double phase = omega * (std::clamp(t, m.start, m.stop) - m.start);
    point = home + std::sin(phase) * m.amplitude;
    velocity = on ? Vec<Dim>(omega * std::cos(phase) * m.amplitude) : Vec<Dim>(Vec<Dim>::Zero());
  }
  void follow(const Piston<Dim>& m, double t, double dt) {
    if (t <= m.start) return;
    const Vec<Dim> axis = m.load.normalized();
    velocity += dt * (m.load.norm() + force.dot(axis)) / m.mass * axis;
    point += dt * velocity;
  }
};

/// Lists for each wall those that it may meet, with which it is one surface then: the boxes of the
/// two touch, a corner lies on a wall without an end, or one of them moves. Also finds the seams.
template <int Dim>
void join_walls(std::vector<Wall<Dim>>& walls);

namespace detail {
/// The foot of x [m] on a wall that meets others, see contact_foot.
template <int Dim>
typename Wall<Dim>::Foot foot_on_surface(const Wall<Dim>* walls, int w, const Vec<Dim>& x);
extern template Wall<2>::Foot foot_on_surface<2>(const Wall<2>*, int, const Vec<2>&);
extern template Wall<3>::Foot foot_on_surface<3>(const Wall<3>*, int, const Vec<3>&);
}  // namespace detail

/// The foot of x [m] on a wall, as a contact sees it. Walls that meet are one surface, which a
/// grain touches at the points of it that are nearer than all around them. Where two walls meet,
/// one leaves the contact to the other that is nearer, or has more to it there (a face before an
/// edge before a corner), or comes first. A wall that leaves a contact to another one is as good as
/// infinitely far. So a convex or flat joint is touched once, a concave one on both faces.
/// @param walls  all walls
/// @param w      place of the wall among them
template <int Dim>
typename Wall<Dim>::Foot contact_foot(const Wall<Dim>* walls, int w, const Vec<Dim>& x) {
  return walls[w].joined.empty() ? walls[w].foot(x) : detail::foot_on_surface(walls, w, x);
}

}  // namespace lagrain
