// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Walls: half-spaces, segments and cylinders, fixed or moving, as contact partners that
/// never turn.

#include <lagrain/vec.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

namespace lagrain {

/// A plane (a line in 2D) with everything on its far side solid.
template <int Dim>
struct HalfSpace {
  Vec<Dim> normal;  ///< unit, towards the grains [-]
};

/// A straight wall from the wall's point to its other end, solid from both sides.
template <int Dim>
struct WallSegment {
  Vec<Dim> along;  ///< from the wall's point to the other end [m]
};

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
  Vec<Dim> point = Vec<Dim>::Zero();  ///< now: on the plane, the segment's end, on the axis [m]
  /// The shape says what is solid.
  std::variant<HalfSpace<Dim>, WallSegment<Dim>, Cylinder<Dim>> shape;
  /// The motion says how it moves.
  std::variant<Fixed, Steady<Dim>, Shake<Dim>, Piston<Dim>> motion = Fixed{};
  int material = 0;                      ///< row of the table of laws
  Vec<Dim> home = Vec<Dim>::Zero();      ///< where it was at time 0 [m], for motions given in time
  Vec<Dim> velocity = Vec<Dim>::Zero();  ///< [m/s]
  Vec<Dim> force = Vec<Dim>::Zero();     ///< by the grains, in the last step [N]

  /// A fixed half-space.
  /// @param point   on the plane [m]
  /// @param normal  towards the grains, of any length
  static Wall half_space(std::string name, const Vec<Dim>& point, const Vec<Dim>& normal) {
    return {std::move(name), point, HalfSpace<Dim>{normal.normalized()}, Fixed{}, 0, point};
  }
  /// A fixed straight wall between two points [m].
  static Wall segment(std::string name, const Vec<Dim>& from, const Vec<Dim>& to) {
    return {std::move(name), from, WallSegment<Dim>{to - from}, Fixed{}, 0, from};
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

  /// The point of the wall that is nearest to a place.
  struct Foot {
    double distance;  ///< from the wall's surface; negative behind a half-space or a cylinder [m]
    Vec<Dim> normal;  ///< unit, from the wall towards the place [-]
  };
  /// The foot of x [m] on the wall as it is now.
  Foot foot(const Vec<Dim>& x) const {
    return std::visit([&](const auto& s) { return foot_on(s, x); }, shape);
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
  Foot foot_on(const WallSegment<Dim>& segment, const Vec<Dim>& x) const {
    const Vec<Dim>& along = segment.along;
    const double t = std::clamp((x - point).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const Vec<Dim> away = x - (point + t * along);
    const double distance = away.norm();
    // A centre exactly on the segment is pushed out along its first normal.
    if (distance == 0) return {0, any_normal(along)};
    return {distance, away / distance};
  }
  Foot foot_on(const Cylinder<Dim>& cylinder, const Vec<Dim>& x) const {
    const Vec<Dim> arm = x - point;
    const Vec<Dim> away = arm - arm.dot(cylinder.axis) * cylinder.axis;
    const double distance = away.norm();
    // On the axis all of the wall is equally far.
    if (distance == 0) return {cylinder.radius, any_normal(cylinder.axis)};
    return {cylinder.radius - distance, away / -distance};
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

}  // namespace lagrain
