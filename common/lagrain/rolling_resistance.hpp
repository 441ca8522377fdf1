// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Resistance against rolling, and in space against twisting, over any friction law.

#include <lagrain/contact_law.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace lagrain {

/// A contact that carries a moment, as one of finite width does: a spring turned by the angle
/// theta that i has rolled on j, with a dashpot, cut where it yields.
///
///     M = -(k_r theta + c_r omega),  |M| <= mu_r R_eff f_n,
///     k_r = ratio k_n R_eff^2,  c_r = 2 zeta_r sqrt(k_r I_r),  I_r = (1 + I / m r^2) m_eff R_eff^2
///
/// omega is the angular velocity of i against j. Its part in the contact plane rolls. Its part
/// about the normal twists: in space it has a spring of its own with the same stiffness, the limit
/// mu_t R_eff f_n, and I_t = (I / m r^2) m_eff R_eff^2.
///
/// This is type C of Ai, Chen, Rotter & Ooi, Powder Technol. 206 (2011) 269. Three things were to
/// be chosen:
/// * The stiffness is that of tangential springs at the lever R_eff (Iwashita & Oda, J. Eng. Mech.
///   124 (1998) 285), not 2.25 mu_r^2 k_n R_eff^2: so the time in which contacts roll to and fro
///   does not depend on mu_r, and one bound holds for the time step. A contact yields once it has
///   rolled by (mu_r / ratio) times its overlap.
/// * The dashpot's ratio is exact for a grain that rolls without slip on a plane, where I_r is the
///   moment of inertia about the contact, and for one that twists there. Two equal grains that roll
///   on each other get 0.87 (discs) or 0.94 (spheres) of it: it needs no inertia of either.
/// * The spring is cut at the limit by itself, then its sum with the dashpot is cut again. So a
///   dashpot exerts nothing where the contact yields, and nothing jumps on the way there. No path
///   gains energy; CundallStrack has the proof, and the rule for springs whose stiffness follows
///   the overlap, which holds here too.
///
/// @tparam Friction  a law with spin over a normal law, which is its member `normal`
template <class Friction>
struct RollingResistance {
  static_assert(Friction::needs.spin, "what does not spin does not roll");
  static constexpr Needs needs{.spin = true, .memory = true, .rolling = true};  ///< all
  /// Whether the normal law's stiffness is one number.
  static constexpr bool kConstantStiffness = decltype(Friction::normal)::kConstantStiffness;

  /// What is remembered where there is nothing to remember: of a twist in the plane, of a stiffness
  /// that never changes.
  struct Nothing {
    bool operator==(const Nothing&) const = default;
  };
  /// What the friction law remembers, the angles [rad] that the springs are turned by, and the
  /// springs' stiffness [N m] where it changes.
  template <int Dim, class Real = double>
  struct Memory {
    using Sliding = typename Friction::template Memory<Dim, Real>;   ///< of the friction law
    static constexpr bool kStiffness = !kConstantStiffness;          ///< whether it is remembered
    static constexpr int kTwist = Sliding::kReals + kSpinDim<Dim>;   ///< place of the twist
    static constexpr int kReals = kTwist + (Dim == 3) + kStiffness;  ///< one for each number
    [[no_unique_address]] Sliding sliding{};                         ///< of the friction law
    SpinVec<Dim, Real> rolled = SpinVec<Dim, Real>::Zero();          ///< in the contact plane [rad]
    /// About the normal [rad].
    [[no_unique_address]] std::conditional_t<Dim == 3, Real, Nothing> twisted{};
    [[no_unique_address]] std::conditional_t<kStiffness, Real, Nothing> stiffness{};  ///< k_r [N m]
    /// Number k, in the order of the members.
    /// @{
    Real& operator[](int k) { return number(*this, k); }
    const Real& operator[](int k) const { return number(*this, k); }
    /// @}
    /// Seen from there the grain has rolled the other way; a screw is the same from both its ends.
    Memory seen_from_partner() const {
      return {sliding.seen_from_partner(), -rolled, twisted, stiffness};
    }
    bool operator==(const Memory&) const = default;

   private:
    template <class M>
    static auto& number(M& memory, int k) {
      if constexpr (Sliding::kReals > 0) {
        if (k < Sliding::kReals) return memory.sliding[k];
      }
      if constexpr (kStiffness) {
        if (k == kReals - 1) return memory.stiffness;
      }
      if constexpr (Dim == 3) {
        if (k == kTwist) return memory.twisted;
      }
      return memory.rolled[k - Sliding::kReals];
    }
  };

  Friction sliding;                    ///< the law of friction, over its normal law
  double rolling_friction = 0;         ///< mu_r [-]
  double twisting_friction = 0;        ///< mu_t, in space [-]
  double stiffness_ratio = 2.0 / 7.0;  ///< k_r / (k_n R_eff^2) [-]
  double damping_ratio = 0.3;          ///< zeta_r [-]

  /// ContactLaw asks for this member and explains it.
  /// @{
  template <int Dim, class Real>
  Response<Dim, Real> respond(const Touch<Dim, Real>& touch, Memory<Dim, Real>& memory,
                              double time_step) const {
    using std::sqrt;
    Response<Dim, Real> response = sliding.respond(touch, memory.sliding, time_step);
    // Limit of the moment for a coefficient of 1.
    const Real leverage = touch.effective_radius * dot(response.force, touch.normal);
    Spring<Real> spring;
    spring.stiffness = stiffness_of(touch);
    spring.compliance = 1 / spring.stiffness;
    spring.before = spring.stiffness;
    if constexpr (!kConstantStiffness) spring.before = memory.stiffness;
    constexpr double kOfCentre = Dim == 2 ? 0.5 : 0.4;  // I / m r^2
    const Real critical =
        2 * touch.effective_radius * sqrt(touch.effective_mass * spring.stiffness);

    const SpinVec<Dim, Real> twisting = about<Real>(touch.normal, touch.relative_spin);
    SpinVec<Dim, Real> rolled = turned_with(memory.rolled, touch, time_step);
    spring.damping = damping_ratio * std::sqrt(1 + kOfCentre) * critical;
    response.moment = moment_of<SpinVec<Dim, Real>>(rolled, touch.relative_spin - twisting, spring,
                                                    Real(rolling_friction * leverage), time_step,
                                                    response.friction_loss);
    if (time_step > 0) memory.rolled = rolled;
    if constexpr (Dim == 3) {
      using Angle = Eigen::Matrix<Real, 1, 1>;
      Angle twisted(memory.twisted);
      spring.damping = damping_ratio * std::sqrt(kOfCentre) * critical;
      const Angle moment =
          moment_of<Angle>(twisted, Angle(dot(touch.normal, touch.relative_spin)), spring,
                           Real(twisting_friction * leverage), time_step, response.friction_loss);
      response.moment += moment[0] * touch.normal;
      if (time_step > 0) memory.twisted = twisted[0];
    }
    if constexpr (!kConstantStiffness) {
      if (time_step > 0) memory.stiffness = spring.stiffness;
    }
    return response;
  }

  template <int Dim>
  double elastic_energy(const Touch<Dim>& touch, const Memory<Dim>& memory) const {
    double angle_squared = memory.rolled.squaredNorm();
    if constexpr (Dim == 3) angle_squared += memory.twisted * memory.twisted;
    return sliding.elastic_energy(touch, memory.sliding) +
           0.5 * stiffness_of(touch) * angle_squared;
  }

  double contact_time(double effective_mass, double effective_radius) const {
    return sliding.contact_time(effective_mass, effective_radius);
  }
  double natural_time(double effective_mass, double effective_radius) const {
    return sliding.natural_time(effective_mass, effective_radius) / quickening();
  }
  double largest_damping_ratio() const {
    return std::max(sliding.largest_damping_ratio(),
                    kRollingMobility * damping_ratio * std::sqrt(1.4 * stiffness_ratio)) /
           quickening();
  }
  bool conservative() const { return false; }
  /// @}

 private:
  /// In a closest packing of equal spheres that turn against each other as much as they can,
  /// rolling and twisting springs are as stiff as 16 k_r / I = 5 ratio omega0^2, where normal ones
  /// reach 4 omega0^2 in their stiffest mode (kStiffestMode): 5/4 of the ratio. (Layers of discs:
  /// 9/4 ratio omega0^2.) Dashpots are as much stronger, with 1 + I / m r^2 = 1.4 in their I_r.
  static constexpr double kRollingMobility = 1.25;

  /// How much faster the stiffest mode counts than it does without rolling springs. No mode of two
  /// sets of springs is stiffer than the stiffest of the one and of the other together. Springs
  /// that add up predicted velocities count twice: velocity Verlet is stable for a mode of
  /// stiffness k with a dashpot c if c dt / m + k dt^2 / (2 m) < 1, where a spring that follows the
  /// places has a 4 (put alternating angles into its difference equation).
  double quickening() const { return std::sqrt(1 + 2 * kRollingMobility * stiffness_ratio); }

  /// A spring against turning, in one contact.
  template <class Real>
  struct Spring {
    Real stiffness;   ///< k [N m]
    Real compliance;  ///< 1 / k [1/(N m)]
    Real before;      ///< k in the step before [N m]
    Real damping;     ///< of its dashpot [N m s]
  };

  template <int Dim, class Real>
  Real stiffness_of(const Touch<Dim, Real>& touch) const {
    return stiffness_ratio * sliding.normal.stiffness_at(touch) *
           (touch.effective_radius * touch.effective_radius);
  }

  /// The moment of a spring and its dashpot, cut at the limit. The angle turns by the step, and
  /// what is lost is added to `loss` [J].
  template <class V, class Real>
  static V moment_of(V& angle, const V& rate, const Spring<Real>& spring, const Real& limit,
                     double time_step, Real& loss) {
    const Real stored = 0.5 * spring.before * squared(angle);
    if constexpr (!kConstantStiffness) {
      angle = smaller(Real(spring.before * spring.compliance), Real(1)) * angle;
    }
    angle = shortened<V>(angle + time_step * rate, limit * spring.compliance);
    V moment = shortened<V>(-(spring.stiffness * angle + spring.damping * rate), limit);
    loss += -dot(moment, rate) * time_step - (0.5 * spring.stiffness * squared(angle) - stored);
    return moment;
  }
};

}  // namespace lagrain
