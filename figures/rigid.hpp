// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Rigid discs in closed form: what soft ones, and solvers with a tolerance, are held against.

#include <lagrain/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace lagrain::figures {

struct RigidDisc {
  Vec<2> position = Vec<2>::Zero();  ///< [m]
  Vec<2> velocity = Vec<2>::Zero();  ///< [m/s]
  double spin = 0;                   ///< [rad/s]
  double radius = 0;                 ///< [m]
  double mass = 0;                   ///< [kg]
};

/// The velocities after an instantaneous impact with restitution e and friction mu, whose contact
/// point keeps no slip where it sticks (Walton's three constants with beta0 = 0: O. R. Walton, in
/// Particulate Two-Phase Flow, ed. M. C. Roco (1993) 884). Discs touch and approach each other.
inline std::array<RigidDisc, 2> rigid_impact(std::array<RigidDisc, 2> discs, double restitution,
                                             double friction) {
  auto& [a, b] = discs;
  const Vec<2> normal = (a.position - b.position).normalized();
  const Vec<2> along(-normal.y(), normal.x());
  const Vec<2> relative = a.velocity - b.velocity;
  const double mass = 1 / (1 / a.mass + 1 / b.mass);
  const double slip = relative.dot(along) - a.radius * a.spin - b.radius * b.spin;
  const double push = (1 + restitution) * mass * -relative.dot(normal);
  // Along the tangent a contact point is three times lighter: r^2 / I = 2 / m for discs.
  const double drag = std::clamp(-slip * mass / 3, -friction * push, friction * push);
  const Vec<2> impulse = push * normal + drag * along;
  a.velocity += impulse / a.mass;
  b.velocity -= impulse / b.mass;
  a.spin -= 2 * drag / (a.mass * a.radius);
  b.spin -= 2 * drag / (b.mass * b.radius);
  return discs;
}

/// Velocity down an incline and spin of a disc so long after its rest.
struct Descent {
  double velocity;  ///< [m/s]
  double spin;      ///< [rad/s], of rolling downhill positive
};

/// The descent of a disc that starts at rest: it rolls while tan(angle) <= 3 mu, else it slides.
/// @param angle [rad] @param gravity [m/s^2]
inline Descent descent(double angle, double friction, double gravity, double radius, double time) {
  const double drive = gravity * std::sin(angle);
  const double drag = std::min(drive / 3, friction * gravity * std::cos(angle));
  return {(drive - drag) * time, 2 * drag / radius * time};
}

/// Share of the start phases in which a disc passes through its like, head-on, between two steps:
/// the engine has to catch it in the front half of the overlap, which is one diameter long.
/// @param stride  way per step over the diameter [-]
inline double tunnelling_share(double stride) { return std::max(0.0, 1 - 1 / stride); }

}  // namespace lagrain::figures
