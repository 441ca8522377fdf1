#pragma once
/// @file
/// Walls: half-spaces and segments, fixed or moving, as contact partners that never turn.

#include <lagrain/vec.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

namespace lagrain {

/// Everything on the far side of a plane (a line in 2D) is solid.
template <int Dim>
struct HalfSpace {
  Vec<Dim> normal;  ///< unit, towards the grains [-]
};

/// A straight wall from the wall's point to its other end, solid from both sides.
template <int Dim>
struct WallSegment {
  Vec<Dim> along;  ///< from the wall's point to the other end [m]
};

struct Fixed {};

/// Constant velocity between two times.
template <int Dim>
struct Steady {
  Vec<Dim> velocity;  ///< [m/s]
  double start = 0;   ///< [s]
  double stop = std::numeric_limits<double>::infinity();
};

/// Displacement amplitude sin(2 pi frequency (t - start)) between two times; at rest outside, after
/// the end where it then is.
template <int Dim>
struct Shake {
  Vec<Dim> amplitude;    ///< [m]
  double frequency = 0;  ///< [Hz]
  double start = 0;      ///< [s]
  double stop = std::numeric_limits<double>::infinity();
};

/// A guided mass: moves along its load, pushed by the load and by the grains.
template <int Dim>
struct Piston {
  double mass;    ///< [kg]
  Vec<Dim> load;  ///< [N], its own weight included
};

/// A wall and the force that the grains exert on it.
template <int Dim>
struct Wall {
  std::string name;
  Vec<Dim> point = Vec<Dim>::Zero();  ///< where it is now: on the plane, or the segment's end [m]
  std::variant<HalfSpace<Dim>, WallSegment<Dim>> shape;
  std::variant<Fixed, Steady<Dim>, Shake<Dim>, Piston<Dim>> motion = Fixed{};
  int kind = 0;                          ///< row of the table of laws
  Vec<Dim> home = Vec<Dim>::Zero();      ///< where it was at time 0 [m], for motions given in time
  Vec<Dim> velocity = Vec<Dim>::Zero();  ///< [m/s]
  Vec<Dim> force = Vec<Dim>::Zero();     ///< by the grains, in the last step [N]

  static Wall half_space(std::string name, const Vec<Dim>& point, const Vec<Dim>& normal) {
    return {std::move(name), point, HalfSpace<Dim>{normal.normalized()}, Fixed{}, 0, point};
  }
  static Wall segment(std::string name, const Vec<Dim>& from, const Vec<Dim>& to) {
    return {std::move(name), from, WallSegment<Dim>{to - from}, Fixed{}, 0, from};
  }

  bool moves() const { return !std::holds_alternative<Fixed>(motion); }

  /// Distance [m] from the wall's surface to x, and the unit vector from the wall towards x.
  struct Foot {
    double distance;
    Vec<Dim> normal;
  };
  Foot foot(const Vec<Dim>& x) const {
    if (const auto* plane = std::get_if<HalfSpace<Dim>>(&shape)) {
      return {(x - point).dot(plane->normal), plane->normal};
    }
    const Vec<Dim>& along = std::get<WallSegment<Dim>>(shape).along;
    const double t = std::clamp((x - point).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const Vec<Dim> away = x - (point + t * along);
    const double distance = away.norm();
    // A centre exactly on the segment is pushed out along its first normal.
    if (distance == 0) return {0, any_normal(along)};
    return {distance, away / distance};
  }

  /// Visits, in increasing order, every grain i whose centre x.col(i) is no further than reach(i)
  /// [m] from the wall's surface.
  template <class Reach, class F>
  void for_each_within(const Columns<Dim>& x, Reach&& reach, F&& visit) const {
    const int n = static_cast<int>(x.cols());
    if (const auto* plane = std::get_if<HalfSpace<Dim>>(&shape)) {
      for (int i = 0; i < n; ++i) {
        if ((x.col(i) - point).dot(plane->normal) <= reach(i)) visit(i);
      }
    } else {
      for (int i = 0; i < n; ++i) {
        if (foot(x.col(i)).distance <= reach(i)) visit(i);
      }
    }
  }

  /// Brings the wall to time t [s], a step dt [s] after the last call.
  void advance(double t, double dt) {
    std::visit([&](const auto& m) { follow(m, t, dt); }, motion);
  }

 private:
  static Vec<Dim> any_normal(const Vec<Dim>& along) {
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
  void follow(const Piston<Dim>& m, double, double dt) {
    const Vec<Dim> axis = m.load.normalized();
    velocity += dt * (m.load.norm() + force.dot(axis)) / m.mass * axis;
    point += dt * velocity;
  }
};

}  // namespace lagrain
