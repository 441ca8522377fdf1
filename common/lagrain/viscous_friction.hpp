// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Regularised Coulomb friction without memory, over any normal law.

#include <lagrain/contact_law.hpp>

#include <algorithm>
#include <cmath>

namespace lagrain {

/// Friction of a viscous film that cannot exceed Coulomb's limit:
///
///     f_t = -min(g |slip|, mu f_n) slip / |slip|,  g = 2 zeta_t sqrt(k m_eff)
///
/// It needs no memory, and the price is creep: a loaded contact at rest slides slowly. For flows it
/// is enough; a pile that must stand needs CundallStrack.
///
/// Source: Haff & Werner, Powder Technology 48 (1986) 239.
template <class Normal>
struct ViscousFriction {
  static constexpr Needs needs{.spin = true, .memory = false};  ///< spin alone
  /// Its contacts remember nothing.
  template <int Dim, class Real = double>
  using Memory = NoMemory;

  Normal normal;                           ///< the law along the normal
  double friction = 0;                     ///< mu [-]
  double tangential_damping_ratio = 0.15;  ///< zeta_t [-]

  /// ContactLaw asks for this member and explains it.
  /// @{
  template <int Dim, class Real>
  Response<Dim, Real> respond(const Touch<Dim, Real>& touch, NoMemory&, double time_step) const {
    using std::sqrt;
    const Onset<Real> onset(touch, Normal::kDashpotMean, time_step);
    const auto [fn, dashpot_loss] = normal.push(touch, onset, time_step);
    const Real g = 2 * tangential_damping_ratio * sqrt(normal.stiffness_at(touch)) *
                   sqrt(touch.effective_mass) * onset.weight;
    const Real limit = friction * fn;
    const Real speed = sqrt(squared(touch.slip));
    const Real coefficient = select(g * speed <= limit, g, Real(limit / speed));
    return {fn * touch.normal - coefficient * touch.slip, dashpot_loss,
            coefficient * speed * speed * time_step};
  }

  template <int Dim>
  double elastic_energy(const Touch<Dim>& touch, const NoMemory& none) const {
    return normal.elastic_energy(touch, none);
  }

  double contact_time(double effective_mass, double effective_radius) const {
    return normal.contact_time(effective_mass, effective_radius);
  }
  double natural_time(double effective_mass, double effective_radius) const {
    return normal.natural_time(effective_mass, effective_radius);
  }
  double largest_damping_ratio() const {
    return std::max(normal.largest_damping_ratio(), kTangentialMobility * tangential_damping_ratio);
  }
  bool conservative() const { return false; }
  /// @}
};

}  // namespace lagrain
