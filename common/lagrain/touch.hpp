// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// One contact as a law sees it, and what the law answers.

#include <lagrain/lanes.hpp>
#include <lagrain/needs.hpp>
#include <lagrain/vec.hpp>

#include <type_traits>

namespace lagrain {

/// The overlap, of the smaller radius [-], beyond which a run stops unless it is told another: far
/// more than any sound contact, and less than the 0.58 up to which T is proved to miss nothing.
inline constexpr double kLargestOverlap = 0.3;

/// A contact of grain i with a partner j: another grain or a wall.
template <int Dim, class Real = double>
struct Touch {
  Real overlap = 0;                                ///< r_i + r_j - |x_i - x_j| [m], positive
  Vec<Dim, Real> normal = Vec<Dim, Real>::Zero();  ///< unit vector from j to i [-]
  Real closing = 0;  ///< -(v_i - v_j) . normal [m/s], positive when approaching
  /// Tangential velocity of i against j at the contact [m/s].
  Vec<Dim, Real> slip = Vec<Dim, Real>::Zero();
  /// Mean angular velocity of the two about the normal [rad/s]: how fast the contact turns in its
  /// own plane. Known to laws that remember.
  SpinVec<Dim, Real> twist = SpinVec<Dim, Real>::Zero();
  /// Angular velocity of i against j [rad/s]. The part in the contact plane rolls, the part about
  /// the normal twists. Known to laws that resist rolling.
  SpinVec<Dim, Real> relative_spin = SpinVec<Dim, Real>::Zero();
  Real effective_mass = 0;    ///< m_i m_j / (m_i + m_j) [kg]; m_i against a wall
  Real effective_radius = 0;  ///< r_i r_j / (r_i + r_j) [m]; r_i against a wall
};

/// The answer of a law, and where the energy of the step went.
template <int Dim, class Real = double>
struct Response {
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();  ///< on i [N]; j receives the opposite
  Real dashpot_loss = 0;   ///< energy taken by the normal dashpot in this step [J]
  Real friction_loss = 0;  ///< energy taken by sliding, rolling, and the damping of both [J]
  /// On i, besides that of the force [N m]; j receives the opposite. Only laws that resist rolling
  /// give one.
  SpinVec<Dim, Real> moment = SpinVec<Dim, Real>::Zero();
};

/// A grain as its contacts see it.
template <int Dim, Needs needs, class Real = double>
struct Body {
  Vec<Dim, Real> position;  ///< [m]
  Vec<Dim, Real> velocity;  ///< [m/s]
  Real radius;              ///< [m]
  Real inverse_mass;        ///< [1/kg], 0 for a pinned grain
  struct NoOmega {};
  [[no_unique_address]] std::conditional_t<needs.spin, SpinVec<Dim, Real>, NoOmega>
      omega;  ///< [rad/s]
};

/// A contact, or two grains apart: then `touching` is false and the touch means nothing.
template <int Dim, class Real>
struct MaybeTouch {
  decltype(Real(0) < Real(0)) touching;  ///< true or false, in each lane
  Touch<Dim, Real> touch;                ///< of what touches
};

/// Step 2 of the paper for one pair, or one pair per lane: whether two grains touch, and how.
template <Needs needs, int Dim, class Real>
MaybeTouch<Dim, Real> touch_of(const Body<Dim, needs, Real>& i, const Body<Dim, needs, Real>& j) {
  using std::sqrt;
  MaybeTouch<Dim, Real> result;
  Touch<Dim, Real>& touch = result.touch;
  const Real inverse_mass = i.inverse_mass + j.inverse_mass;
  const Vec<Dim, Real> between = i.position - j.position;
  const Real reach = i.radius + j.radius;
  const Real distance_squared = squared(between);
  // Two pinned grains never touch.
  result.touching = distance_squared < only_if(inverse_mass > Real(0), Real(reach * reach));
  if (!any(result.touching)) return result;

  const Real distance = sqrt(distance_squared);
  touch.overlap = reach - distance;
  // Coincident centres have no direction of their own; any fixed one parts them.
  const Real inverse_distance = only_if(distance > Real(0), Real(1 / distance));
  touch.normal = inverse_distance * between;
  touch.normal[0] = select(distance > Real(0), touch.normal[0], Real(1));
  Vec<Dim, Real> velocity = i.velocity - j.velocity;
  touch.closing = -dot(velocity, touch.normal);
  if constexpr (needs.spin) {
    const Real half = 0.5 * touch.overlap;
    const SpinVec<Dim, Real> rolling = (i.radius - half) * i.omega + (j.radius - half) * j.omega;
    velocity -= cross<Real>(rolling, touch.normal);
    touch.slip = velocity + touch.closing * touch.normal;
  }
  if constexpr (needs.memory) {
    touch.twist = about<Real>(touch.normal, SpinVec<Dim, Real>(Real(0.5) * (i.omega + j.omega)));
  }
  if constexpr (needs.rolling) touch.relative_spin = i.omega - j.omega;
  touch.effective_mass = Real(1) / inverse_mass;
  touch.effective_radius = i.radius * j.radius / reach;
  return result;
}

/// Whether a grain of a mass [kg] touches a wall, and how. The wall's surface is `distance` [m]
/// from the grain's centre, has its unit normal towards the grain, moves with `wall_velocity` [m/s]
/// there, and turns with `wall_spin` [rad/s].
template <Needs needs, int Dim, class Real>
MaybeTouch<Dim, Real> touch_of_wall(const Body<Dim, needs, Real>& i, const Real& mass,
                                    const Real& distance, const Vec<Dim, Real>& normal,
                                    const Vec<Dim, Real>& wall_velocity,
                                    const SpinVec<Dim, Real>& wall_spin) {
  MaybeTouch<Dim, Real> result;
  Touch<Dim, Real>& touch = result.touch;
  touch.overlap = i.radius - distance;
  result.touching = touch.overlap > Real(0);
  touch.normal = normal;
  Vec<Dim, Real> velocity = i.velocity - wall_velocity;
  touch.closing = -dot(velocity, normal);
  if constexpr (needs.spin) {
    velocity -= cross<Real>(SpinVec<Dim, Real>(distance * i.omega), normal);
    touch.slip = velocity + touch.closing * normal;
  }
  if constexpr (needs.memory) {
    touch.twist = about<Real>(normal, SpinVec<Dim, Real>(Real(0.5) * (i.omega + wall_spin)));
  }
  if constexpr (needs.rolling) touch.relative_spin = i.omega - wall_spin;
  touch.effective_mass = mass;
  touch.effective_radius = i.radius;
  return result;
}

}  // namespace lagrain
