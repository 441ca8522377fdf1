// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Dashpots in time steps: what a contact that began between two of them has felt, and what the
/// velocity that integrators predict is worth.

#include <lagrain/touch.hpp>

namespace lagrain {

/// How long the contact has lasted of the time step that ends now [s]: all of it, or since the
/// grains met. With a time step of 0, as for those who only look, no contact begins.
template <int Dim, class Real>
Real lasted(const Touch<Dim, Real>& touch, double time_step) {
  return select(touch.overlap < touch.closing * time_step, Real(touch.overlap / touch.closing),
                Real(time_step));
}

/// The weight [-] of a dashpot's force in this step: 1, but in the first one of a contact what the
/// dashpot has done since the grains met, and what it does in the half step ahead.
///
/// A force that an integrator evaluates acts for half a step back and half a step ahead. A spring
/// begins with no force, so nothing is lost where it begins between two steps. A dashpot begins
/// with its full force: without the weight the restitution depends on where in the step that is
/// (by up to 3 % for a restitution of 0.5 and 25 steps), and every scene with dashpots is of first
/// order. (Orders of force laws: Danby et al., Comput. Chem. Eng. 58 (2013) 211.)
///
/// @param mean  of the dashpot's coefficient between no overlap and this one, over the one here [-]
template <class Real>
Real onset_weight(const Real& lasted, double mean, double time_step) {
  return select(lasted < Real(time_step), Real(0.5 + mean / time_step * lasted), Real(1));
}

/// A dashpot along the normal, as it is in one contact.
template <class Real>
struct Dashpot {
  Real coefficient;  ///< force over velocity [N s/m]
  Real lag;          ///< by how much predicted velocities are too fast; see push_of [N/m]
  double mean;       ///< of the coefficient since no overlap, over that here [-]
};

/// What a spring and a dashpot along the normal do in a step.
template <class Real>
struct NormalPush {
  Real force;         ///< of both, never negative [N]
  Real dashpot_loss;  ///< energy taken by the dashpot [J]
};

/// Spring and dashpot over a time step [s].
///
/// The velocity that a contact sees is a prediction (integrator.hpp): it lacks half of the change
/// of the acceleration within the step, to which the spring alone adds k closing dt / m_eff. So the
/// dashpot's coefficient is lessened by the factor 1 / (1 + lag dt^2 / m_eff). A correction by the
/// force itself would be wrong at rest, where other forces balance it; a factor is none.
///
/// The loss is the dashpot's force times the way of a step. In the first step of a contact the
/// dashpot has already slowed the grains, which the prediction does not know.
/// @param elastic  the spring's force [N]
template <int Dim, class Real>
NormalPush<Real> push_of(const Touch<Dim, Real>& touch, const Real& elastic,
                         const Dashpot<Real>& dashpot, double time_step) {
  const Real since = lasted(touch, time_step);
  const Real per_mass = Real(1) / (touch.effective_mass + time_step * time_step * dashpot.lag);
  const Real damping = dashpot.coefficient * touch.effective_mass * per_mass;
  const Real force = positive_part(
      Real(elastic + damping * onset_weight(since, dashpot.mean, time_step) * touch.closing));
  const Real damped = force - elastic;
  const Real slowed = only_if(since < Real(time_step), Real(0.5 * time_step * per_mass * damped));
  return {force, damped * (touch.closing - slowed) * time_step};
}

}  // namespace lagrain
