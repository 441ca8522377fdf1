// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `Hertz` is the contact of elastic spheres with viscous damping.

#include <lagrain/contact_law.hpp>
#include <lagrain/restitution.hpp>

#include <cmath>
#include <numbers>

namespace lagrain {

/// Hertz's law for elastic spheres with a dashpot, never attractive.
///
///     f = max(0, K delta^(3/2) + sqrt(5) zeta sqrt(m_eff K) delta^(1/4) closing),
///     K = (4/3) E* sqrt(R_eff)
///
/// With the dashpot of Tsuji, Tanaka & Ishida, Powder Technology 71 (1992) 239, the
/// restitution does not depend on the speed. Measured along s = (4/5) delta^(5/4) the motion
/// is that of a linear damped spring (Antypov & Elliott, EPL 94 (2011) 50004), and the force
/// vanishes at the same moment in both pictures, so zeta is the same function of the
/// restitution as in `LinearSpring`.
///
/// Discs use the same formula (with their radii): the contact line of two cylinders has no finite
/// stiffness of its own, so in the plane this is a model, not elasticity.
struct Hertz {
  static constexpr Needs needs{};                    ///< neither spin nor memory
  static constexpr bool kConstantStiffness = false;  ///< it grows with the overlap
  /// Its dashpot goes with overlap^(1/4), whose mean is 4/5 of the last.
  static constexpr double kDashpotMean = 0.8;
  /// Its contacts remember nothing.
  template <int Dim, class Real = double>
  using Memory = NoMemory;

  double modulus = 0;        ///< effective Young's modulus E* [Pa]; (1 - nu^2)/E adds over the pair
  double damping_ratio = 0;  ///< zeta [-]
  double impact_speed = 0;   ///< the fastest collision expected [m/s]: sets the contact time

  /// The law with the dashpot that gives a restitution.
  /// @param modulus       E* [Pa], positive
  /// @param restitution   of a head-on impact [-], in (0, 1]
  /// @param impact_speed  the fastest collision expected [m/s], positive
  /// @throws ContractError for a restitution outside (0, 1]
  static Hertz with_restitution(double modulus, double restitution, double impact_speed) {
    return {modulus, damping_ratio_for(restitution), impact_speed};
  }

  /// K [N/m^(3/2)] for an effective radius [m].
  template <class Real>
  Real coefficient(const Real& effective_radius) const {
    using std::sqrt;
    return 4.0 / 3.0 * modulus * sqrt(effective_radius);
  }

  /// NormalLaw or ContactLaw asks for this member and explains it.
  /// @{
  template <int Dim, class Real>
  Real stiffness_at(const Touch<Dim, Real>& touch) const {
    using std::sqrt;
    return 1.5 * coefficient(touch.effective_radius) * sqrt(touch.overlap);
  }
  template <int Dim, class Real>
  Real elastic_force(const Touch<Dim, Real>& touch) const {
    using std::sqrt;
    return coefficient(touch.effective_radius) * touch.overlap * sqrt(touch.overlap);
  }
  template <int Dim, class Real>
  NormalPush<Real> push(const Touch<Dim, Real>& touch, const Onset<Real>& onset,
                        double time_step) const {
    using std::sqrt;
    const Real k = coefficient(touch.effective_radius);
    const Real root = sqrt(touch.overlap);
    const Real damping = std::sqrt(5.0) * damping_ratio * sqrt(touch.effective_mass * k * root);
    return push_of<Dim, Real>(touch, k * touch.overlap * root, {damping, kLag * 1.5 * k * root},
                              onset, time_step);
  }
  template <int Dim, class Real>
  NormalPush<Real> push(const Touch<Dim, Real>& touch, double time_step) const {
    return push(touch, Onset<Real>(touch, kDashpotMean, time_step), time_step);
  }
  template <int Dim, class Real>
  Response<Dim, Real> respond(const Touch<Dim, Real>& touch, NoMemory&, double time_step) const {
    const auto [force, loss] = push(touch, time_step);
    return {force * touch.normal, loss, 0};
  }
  template <int Dim>
  double elastic_energy(const Touch<Dim>& touch, const NoMemory&) const {
    return 0.4 * elastic_force(touch) * touch.overlap;
  }
  /// @}

  /// The time 1 / omega0 [s] of the linear spring whose collisions last as long. The undamped
  /// collision at `impact_speed` lasts 2.94328 delta_max / v, where the deepest overlap
  /// delta_max is (5 m v^2 / (4 K))^(2/5) (Johnson, Contact Mechanics, 1985, section 11.4), and a
  /// linear spring of that duration has 1 / omega0 = duration / pi.
  double natural_time(double effective_mass, double effective_radius) const {
    const double deepest = std::pow(
        1.25 * effective_mass * impact_speed * impact_speed / coefficient(effective_radius), 0.4);
    return 2.94328 * deepest / impact_speed / std::numbers::pi;
  }
  /// ContactLaw asks for this member and explains it.
  /// @{
  double contact_time(double effective_mass, double effective_radius) const {
    return clamped_contact_time(damping_ratio) * natural_time(effective_mass, effective_radius);
  }
  double largest_damping_ratio() const { return damping_ratio; }
  bool conservative() const { return damping_ratio == 0; }
  /// @}

 private:
  /// By how much the dashpot's velocities are predicted too fast, of the stiffness [-]. It was
  /// fitted: with 25 steps a restitution of 0.2 errs by 0.2 %, with none or twice of it by 0.3 %,
  /// which is where test_contact_law holds it.
  static constexpr double kLag = 0.25;
};

static_assert(NormalLaw<Hertz, 2> && NormalLaw<Hertz, 3>);

}  // namespace lagrain
