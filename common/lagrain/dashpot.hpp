// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Dashpots in time steps: what a contact that began between two of them has felt, and what the
/// velocity that integrators predict is worth.

#include <lagrain/touch.hpp>

namespace lagrain {

/// What is special in the first step of a contact. For all others these are constants.
///
/// A force that an integrator evaluates acts for half a step back and half a step ahead. A spring
/// begins with no force, so nothing is lost where it begins between two steps. A dashpot begins
/// with its full force: without the weight the restitution depends on where in the step that is
/// (by up to 3 % for a restitution of 0.5 and 25 steps), and every scene with dashpots is of first
/// order. (Orders of force laws: Danby et al., Comput. Chem. Eng. 58 (2013) 211.)
template <class Real>
struct Onset {
  /// Of a dashpot's force [-]: 1, but in the first step the part of a step for which the dashpot
  /// has acted since the grains met, and acts in the half step ahead.
  Real weight = Real(1);
  /// Half a step where the contact begins: for so long the prediction of the velocity does not know
  /// the dashpot [s].
  Real slowing = Real(0);

  /// @param mean       of the dashpot's coefficient between no overlap and this one, over the one
  ///                   here
  /// @param time_step  0 for those who only look [s]
  template <int Dim>
  Onset(const Touch<Dim, Real>& touch, double mean, double time_step) {
    const auto begins = touch.overlap < touch.closing * time_step;
    if (!any(begins)) return;
    const Real since = touch.overlap / touch.closing;
    weight = select(begins, Real(0.5 + mean / time_step * since), Real(1));
    slowing = only_if(begins, Real(0.5 * time_step));
  }
};

/// A dashpot along the normal, as it is in one contact.
template <class Real>
struct Dashpot {
  Real coefficient;  ///< force over velocity [N s/m]
  Real lag;          ///< by how much predicted velocities are too fast; see push_of [N/m]
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
                         const Dashpot<Real>& dashpot, const Onset<Real>& onset, double time_step) {
  const Real per_mass = Real(1) / (touch.effective_mass + time_step * time_step * dashpot.lag);
  const Real damping = dashpot.coefficient * touch.effective_mass * per_mass * onset.weight;
  const Real force = positive_part(Real(elastic + damping * touch.closing));
  const Real damped = force - elastic;
  const Real closing = touch.closing - onset.slowing * per_mass * damped;
  return {force, damped * closing * time_step};
}

}  // namespace lagrain
