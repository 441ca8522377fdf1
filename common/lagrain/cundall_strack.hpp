// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Coulomb friction with an elastic tangential spring, over any normal law.

#include <lagrain/contact_law.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace lagrain {

/// Friction that holds: a tangential spring xi stretched by the slip, cut at Coulomb's limit.
///
///     f_t = -(kt xi + gt slip),  |f_t| <= mu f_n,
///     kt = ratio x normal stiffness,  gt = 2 zeta_t sqrt(kt m_eff)
///
/// The spring is cut at the limit by itself, then its sum with the dashpot is cut again. So a large
/// dashpot can neither load the spring nor change the impulse of a grazing impact, and friction
/// never gives energy: with X = kt xi inside the ball of radius mu f_n and P the point of the ball
/// nearest to X + gt slip, the loss is slip . (P - X) >= |P - X|^2 / gt.
///
/// Where the stiffness follows the overlap (Hertz), a spring whose contact is loaded keeps its
/// force X, one that is unloaded keeps its stretch X / kt. Its energy X^2 / (2 kt) falls in both
/// cases, and what it loses counts as friction: no path of overlap and slip can gain energy, which
/// a spring of fixed stretch would on being loaded (Thornton, Cummins & Cleary, Powder Technol. 233
/// (2013) 30; Elata & Berryman, Mech. Mater. 24 (1996) 229). The contact remembers its kt for it.
///
/// Source: Cundall & Strack, Geotechnique 29 (1979) 47.
template <class Normal>
struct CundallStrack {
  static constexpr Needs needs{.spin = true, .memory = true};  ///< both

  /// What is remembered of the stiffness where it never changes.
  struct NoStiffness {
    bool operator==(const NoStiffness&) const = default;
  };
  /// Stretch of the tangential spring [m], in the contact plane, and the spring's stiffness [N/m]
  /// where it changes.
  template <int Dim, class Real = double>
  struct Memory {
    static constexpr bool kStiffness = !Normal::kConstantStiffness;  ///< whether it is remembered
    static constexpr int kReals = kStiffness ? Dim + 1 : Dim;        ///< one for each component
    Vec<Dim, Real> stretch = Vec<Dim, Real>::Zero();                 ///< xi [m]
    [[no_unique_address]] std::conditional_t<kStiffness, Real, NoStiffness> stiffness{};  ///< kt
    /// Component k [m], or the stiffness [N/m].
    /// @{
    Real& operator[](int k) {
      if constexpr (kStiffness) {
        if (k == Dim) return stiffness;
      }
      return stretch[k];
    }
    const Real& operator[](int k) const {
      if constexpr (kStiffness) {
        if (k == Dim) return stiffness;
      }
      return stretch[k];
    }
    /// @}
    Memory seen_from_partner() const { return {-stretch, stiffness}; }  ///< the opposite stretch
    bool operator==(const Memory&) const = default;
  };

  Normal normal;                        ///< the law along the normal
  double friction = 0;                  ///< mu [-]
  double stiffness_ratio = 2.0 / 7.0;   ///< kt / kn [-]
  double tangential_damping_ratio = 0;  ///< zeta_t [-]

  /// ContactLaw asks for this member and explains it.
  /// @{
  template <int Dim, class Real>
  Response<Dim, Real> respond(const Touch<Dim, Real>& touch, Memory<Dim, Real>& memory,
                              double time_step) const {
    using std::sqrt;
    Response<Dim, Real> response;
    const Onset<Real> onset(touch, Normal::kDashpotMean, time_step);
    const auto [fn, dashpot_loss] = normal.push(touch, onset, time_step);
    response.dashpot_loss = dashpot_loss;

    // One number for a linear spring, one per contact for Hertz's; so are its root and inverse.
    const auto kt = stiffness_ratio * normal.stiffness_at(touch);
    const auto compliance = 1 / kt;
    const Real gt =
        2 * tangential_damping_ratio * sqrt(kt) * sqrt(touch.effective_mass) * onset.weight;
    Vec<Dim, Real> xi = turned_with(memory.stretch, touch, time_step);
    Real stored = 0.5 * kt * squared(xi);
    if constexpr (!Normal::kConstantStiffness) {
      stored = 0.5 * memory.stiffness * squared(xi);
      xi = smaller(Real(memory.stiffness * compliance), Real(1)) * xi;
    }
    xi = shortened<Vec<Dim, Real>>(xi + time_step * touch.slip, friction * fn * compliance);
    const auto ft = shortened<Vec<Dim, Real>>(-(kt * xi + gt * touch.slip), friction * fn);
    if (time_step > 0) {
      memory.stretch = xi;
      if constexpr (!Normal::kConstantStiffness) memory.stiffness = kt;
    }
    response.force = fn * touch.normal + ft;
    response.friction_loss = -dot(ft, touch.slip) * time_step - (0.5 * kt * squared(xi) - stored);
    return response;
  }

  template <int Dim>
  double elastic_energy(const Touch<Dim>& touch, const Memory<Dim>& memory) const {
    return normal.elastic_energy(touch, NoMemory{}) +
           0.5 * stiffness_ratio * normal.stiffness_at(touch) * memory.stretch.squaredNorm();
  }

  double contact_time(double effective_mass, double effective_radius) const {
    return normal.contact_time(effective_mass, effective_radius);
  }
  double natural_time(double effective_mass, double effective_radius) const {
    return normal.natural_time(effective_mass, effective_radius);
  }
  double largest_damping_ratio() const {
    return std::max(normal.largest_damping_ratio(),
                    kTangentialMobility * tangential_damping_ratio * std::sqrt(stiffness_ratio));
  }
  bool conservative() const { return false; }
  /// @}
};

}  // namespace lagrain
