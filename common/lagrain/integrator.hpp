#pragma once
/// @file
/// Integrators of the motion. Each steps the grains by dt [s] and calls `forces(t)` [s from the
/// start of the step] whenever it needs the forces at the places and velocities then in `grains`.

#include <lagrain/grains.hpp>

#include <array>
#include <concepts>

namespace lagrain {

template <class I, class G, class Forces>
concept Integrator = requires(I integrator, G& grains, double dt, Forces& forces) {
  integrator.step(grains, dt, forces);
  { I::kName } -> std::convertible_to<const char*>;
  { I::kConservativeOnly } -> std::convertible_to<bool>;
};

namespace detail {

/// velocity += dt force / mass, and likewise for the spin.
template <class G>
void kick(G& g, double dt) {
  for (Eigen::Index i = 0; i < g.velocity.cols(); ++i) {
    g.velocity.col(i) += (dt * g.inverse_mass[i]) * g.force.col(i);
  }
  if constexpr (requires { g.omega; }) {
    for (Eigen::Index i = 0; i < g.omega.cols(); ++i) {
      g.omega.col(i) += (dt * g.inverse_inertia[i]) * g.torque.col(i);
    }
  }
}

template <class G>
void drift(G& g, double dt) {
  g.position += dt * g.velocity;
}

}  // namespace detail

/// Velocity from the old force, then place from the new velocity. First order at the grid points,
/// symplectic, one force evaluation.
struct SymplecticEuler {
  static constexpr const char* kName = "symplectic Euler";
  static constexpr bool kConservativeOnly = false;

  template <class G, class Forces>
  void step(G& g, double dt, Forces& forces) {
    detail::kick(g, dt);
    detail::drift(g, dt);
    forces(dt);
  }
};

/// Second order, symplectic without damping, one force evaluation (Swope et al., J. Chem. Phys. 76
/// (1982) 637). A dashpot needs the velocity at the new time before the new force is known: the
/// force sees the prediction v + dt a_old, which keeps second order, and the velocity is corrected
/// afterwards by dt/2 (a_new - a_old).
template <int Dim>
class VelocityVerlet {
 public:
  static constexpr const char* kName = "velocity Verlet";
  static constexpr bool kConservativeOnly = false;

  template <class G, class Forces>
  void step(G& g, double dt, Forces& forces) {
    for (Eigen::Index i = 0; i < g.position.cols(); ++i) {
      const Vec<Dim> change = (dt * g.inverse_mass[i]) * g.force.col(i);
      g.position.col(i) += dt * (g.velocity.col(i) + 0.5 * change);
      g.velocity.col(i) += change;
    }
    old_force_ = g.force;
    if constexpr (requires { g.omega; }) {
      for (Eigen::Index i = 0; i < g.omega.cols(); ++i) {
        g.omega.col(i) += (dt * g.inverse_inertia[i]) * g.torque.col(i);
      }
      old_torque_ = g.torque;
    }
    forces(dt);
    for (Eigen::Index i = 0; i < g.position.cols(); ++i) {
      g.velocity.col(i) += (0.5 * dt * g.inverse_mass[i]) * (g.force.col(i) - old_force_.col(i));
    }
    if constexpr (requires { g.omega; }) {
      for (Eigen::Index i = 0; i < g.omega.cols(); ++i) {
        g.omega.col(i) +=
            (0.5 * dt * g.inverse_inertia[i]) * (g.torque.col(i) - old_torque_.col(i));
      }
    }
  }

 private:
  Columns<Dim> old_force_;
  Columns<kSpinDim<Dim>> old_torque_;
};

/// Fourth order, symplectic, four force evaluations: position-extended Forest-Ruth-like scheme of
/// Omelyan, Mryglod & Folk, Comput. Phys. Commun. 146 (2002) 188. For forces that depend on places
/// alone: no dashpot, no friction.
struct ForestRuth {
  static constexpr const char* kName = "Forest-Ruth (PEFRL)";
  static constexpr bool kConservativeOnly = true;

  template <class G, class Forces>
  void step(G& g, double dt, Forces& forces) {
    constexpr double xi = 0.1786178958448091;
    constexpr double lambda = -0.2123418310626054;
    constexpr double chi = -0.06626458266981849;
    constexpr std::array<double, 5> drifts{xi, chi, 1 - 2 * (chi + xi), chi, xi};
    constexpr std::array<double, 4> kicks{0.5 - lambda, lambda, lambda, 0.5 - lambda};
    double t = 0;
    for (std::size_t stage = 0; stage < kicks.size(); ++stage) {
      detail::drift(g, drifts[stage] * dt);
      t += drifts[stage] * dt;
      forces(t);
      detail::kick(g, kicks[stage] * dt);
    }
    detail::drift(g, drifts.back() * dt);
  }
};

}  // namespace lagrain
