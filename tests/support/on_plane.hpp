// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// A grain that slides or rolls on a plane, for laws of friction and of rolling.

#include <support/scenes.hpp>

#include <cmath>
#include <vector>

namespace lagrain::test {

inline constexpr double kGravity = 10;  // [m/s^2]
inline constexpr Material kRubber{
    .stiffness = 1e6, .restitution = 0.5, .friction = 0.5, .tangential_damping_ratio = 0.3};

/// The law along the normal under a law of friction, and of rolling.
template <class Law>
const auto& normal_of(const Law& law) {
  if constexpr (requires { law.sliding; }) {
    return law.sliding.normal;
  } else {
    return law.normal;
  }
}

/// A grain of radius and mass 1 on a plane that supports it: at its static overlap, so that the
/// normal force is constant. Gravity leans by `slope` [rad].
template <int Dim, class Law>
struct OnPlane {
  double arm;  ///< from the centre to the plane [m]
  Sim<Dim, Law> sim;

  OnPlane(const Law& law, double slope, double speed, double roll, double refinement = 1)
      : arm(1 - static_overlap<Dim>(normal_of(law), 1, kGravity * std::cos(slope))),
        sim(start(law, slope, speed, roll, refinement, arm)) {}

  static Sim<Dim, Law> start(const Law& law, double slope, double speed, double roll,
                             double refinement, double arm) {
    Grain<Dim> g;
    g.radius = 1;
    g.mass = 1;
    g.position = arm * up<Dim>();
    g.velocity = speed * along<Dim>();
    g.omega = roll * rolling_spin<Dim>();
    const Vec<Dim> gravity =
        kGravity * (std::sin(slope) * along<Dim>() - std::cos(slope) * up<Dim>());
    return make_sim<Dim>(std::vector<Grain<Dim>>{g}, law,
                         {Wall<Dim>::half_space("plane", Vec<Dim>::Zero(), up<Dim>())}, refinement,
                         gravity);
  }

  double place() const { return sim.grains().position.col(0).dot(along<Dim>()); }
  double speed() const { return sim.grains().velocity.col(0).dot(along<Dim>()); }
  double spin() const { return sim.grains().omega.col(0).dot(rolling_spin<Dim>()); }
  void run(double duration) {
    const double end = sim.time() + duration;
    while (sim.time() < end) sim.step();
  }
};

/// Inertia over m arm^2: the grain turns about the plane, which is `arm` below its centre.
template <int Dim>
double inertia_factor(double arm) {
  return kInertiaFactor<Dim> / (arm * arm);
}

}  // namespace lagrain::test
