// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Dashpots in time steps: what a contact that began between two of them has felt, and what the
/// velocity that integrators predict is worth.

#include <lagrain/touch.hpp>

namespace lagrain {

/// Which contacts began within the time step that ends now, and since when they last. Few do, so
/// what they need is asked for only where `any` says so.
///
/// A force that an integrator evaluates acts for half a step back and half a step ahead. A spring
/// begins with no force, so nothing is lost where it begins between two steps. A dashpot begins
/// with its full force: without the weight the restitution depends on where in the step that is
/// (by up to 3 % for a restitution of 0.5 and 25 steps), and every scene with dashpots is of first
/// order. (Orders of force laws: Danby et al., Comput. Chem. Eng. 58 (2013) 211.)
template <class Real>
struct Onset {
  decltype(Real(0) < Real(0)) begins;  ///< in each lane; nowhere with a time step of 0
  bool any;                            ///< in some lane
  Real since;                          ///< how long the contact has lasted, where it begins [s]
  double time_step;                    ///< [s]

  /// @param step  the time step; 0 for those who only look [s]
  template <int Dim>
  Onset(const Touch<Dim, Real>& touch, double step)
      : begins(touch.overlap < touch.closing * step),
        any(lagrain::any(begins)),
        since(any ? Real(touch.overlap / touch.closing) : Real(0)),
        time_step(step) {}

  /// The weight [-] of a dashpot's force in this step: 1, but in the first one of a contact what
  /// the dashpot has done since the grains met, and what it does in the half step ahead.
  /// @param mean  of the dashpot's coefficient between no overlap and this one, over the one here
  Real weight(double mean) const {
    if (!any) return Real(1);
    return select(begins, Real(0.5 + mean / time_step * since), Real(1));
  }
};

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
  const Onset<Real> onset(touch, time_step);
  const Real per_mass = Real(1) / (touch.effective_mass + time_step * time_step * dashpot.lag);
  const Real damping = dashpot.coefficient * touch.effective_mass * per_mass;
  const Real force =
      positive_part(Real(elastic + damping * onset.weight(dashpot.mean) * touch.closing));
  const Real damped = force - elastic;
  Real closing = touch.closing;
  if (onset.any) closing -= only_if(onset.begins, Real(0.5 * time_step * per_mass * damped));
  return {force, damped * closing * time_step};
}

}  // namespace lagrain
