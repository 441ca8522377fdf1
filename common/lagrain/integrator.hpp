// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Integrators of the motion, written for one coordinate or vector at a time.
///
/// A step evaluates the forces kEvaluations times. Before evaluation k, `advance` brings place x
/// and velocity v there; `finish` completes the step once the last forces are known. Both get the
/// acceleration a by the forces evaluated last, finish also the one before. Spins are velocities
/// whose angle x nobody asks for.

#include <array>
#include <concepts>

namespace lagrain {

/// What an integrator is: its name, when it wants forces, and the two halves of a step.
template <class I>
concept Integrator = requires(double& x, double a, double dt) {
  { I::kName } -> std::convertible_to<const char*>;
  { I::kConservativeOnly } -> std::convertible_to<bool>;
  { I::kEvaluations } -> std::convertible_to<int>;
  { I::time_of(0) } -> std::convertible_to<double>;  // of evaluation k, in steps
  I::template advance<double>(0, x, x, a, dt);
  I::template finish<double>(x, x, a, a, dt);
};

/// Velocity from the old force, then place from the new velocity. First order at the grid points,
/// symplectic, one force evaluation.
struct SymplecticEuler {
  /// Integrator asks for this member and explains it.
  /// @{
  static constexpr const char* kName = "symplectic Euler";
  static constexpr bool kConservativeOnly = false;
  static constexpr int kEvaluations = 1;
  static constexpr double time_of(int) { return 1; }

  template <class V>
  static void advance(int, V& x, V& v, const V& a, double dt) {
    v += dt * a;
    x += dt * v;
  }
  template <class V>
  static void finish(V&, V&, const V&, const V&, double) {}
  /// @}
};

/// Second order, symplectic without damping, one force evaluation (Swope et al., J. Chem. Phys. 76
/// (1982) 637). A dashpot needs the velocity at the new time before the new force is known: the
/// force sees the prediction v + dt a_old, which keeps second order, and the velocity is corrected
/// afterwards by dt/2 (a_new - a_old).
struct VelocityVerlet {
  /// Integrator asks for this member and explains it.
  /// @{
  static constexpr const char* kName = "velocity Verlet";
  static constexpr bool kConservativeOnly = false;
  static constexpr int kEvaluations = 1;
  static constexpr double time_of(int) { return 1; }

  template <class V>
  static void advance(int, V& x, V& v, const V& a, double dt) {
    const V change = dt * a;
    x += dt * (v + 0.5 * change);
    v += change;
  }
  template <class V>
  static void finish(V&, V& v, const V& a, const V& before, double dt) {
    v += (0.5 * dt) * (a - before);
  }
  /// @}
};

/// Fourth order, symplectic, four force evaluations: position-extended Forest-Ruth-like scheme of
/// Omelyan, Mryglod & Folk, Comput. Phys. Commun. 146 (2002) 188. For forces that depend on places
/// alone: no dashpot, no friction.
struct ForestRuth {
  /// Integrator asks for this member and explains it.
  /// @{
  static constexpr const char* kName = "Forest-Ruth (PEFRL)";
  static constexpr bool kConservativeOnly = true;
  static constexpr int kEvaluations = 4;
  static constexpr double time_of(int evaluation) {
    double t = 0;
    for (int k = 0; k <= evaluation; ++k) t += kDrifts[static_cast<std::size_t>(k)];
    return t;
  }

  template <class V>
  static void advance(int evaluation, V& x, V& v, const V& a, double dt) {
    const auto k = static_cast<std::size_t>(evaluation);
    if (k > 0) v += (kKicks[k - 1] * dt) * a;
    x += (kDrifts[k] * dt) * v;
  }
  template <class V>
  static void finish(V& x, V& v, const V& a, const V&, double dt) {
    v += (kKicks.back() * dt) * a;
    x += (kDrifts.back() * dt) * v;
  }
  /// @}

 private:
  static constexpr double kXi = 0.1786178958448091;
  static constexpr double kLambda = -0.2123418310626054;
  static constexpr double kChi = -0.06626458266981849;
  static constexpr std::array<double, 5> kDrifts{kXi, kChi, 1 - 2 * (kChi + kXi), kChi, kXi};
  static constexpr std::array<double, 4> kKicks{0.5 - kLambda, kLambda, kLambda, 0.5 - kLambda};
};

static_assert(Integrator<SymplecticEuler> && Integrator<VelocityVerlet> && Integrator<ForestRuth>);

}  // namespace lagrain
