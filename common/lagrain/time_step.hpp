// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The time step that the stiffest contact allows.

#include <lagrain/grains.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <variant>
#include <vector>

namespace lagrain {

/// The shortest times of a scene.
struct TimeScales {
  double contact = std::numeric_limits<double>::infinity();    ///< shortest collision [s]
  double safe_step = std::numeric_limits<double>::infinity();  ///< largest safe time step [s]
};

/// The largest time step, as a fraction of the shortest collision. A grain held by several
/// neighbours oscillates up to sqrt(3) times faster than a pair, and explicit schemes are stable up
/// to 0.37 of a pair's contact time then; a tenth keeps the error small as well.
inline constexpr double kLargestContactFraction = 0.1;

/// A packing has modes that are stiffer and more damped than a free pair under the same law: twice
/// in a chain, three times in a hexagonal layer, four times in a face-centred cubic crystal.
inline constexpr double kStiffestMode = 4;

/// The largest omega0 dt at which dashpots are stable, for a damping ratio zeta. Velocity Verlet
/// applies them to the predicted velocity v + dt a_old, and is stable for a mode of mass m,
/// stiffness k = z m omega0^2 and damping c = 2 z zeta m omega0 if c dt / m + k dt^2 / (4 m) < 1,
/// with z up to kStiffestMode. Beyond, forces alternate from step to step and never come to rest.
inline double largest_damped_phase(double damping_ratio) {
  constexpr double kFree = 4 / kStiffestMode;
  const double damped = 4 * damping_ratio;
  return kFree / (std::sqrt(damped * damped + kFree) + damped);
}

/// Shortest collision and safe step over all pairs of materials that occur, and the walls. Of each
/// material the lightest grain that moves is taken (the time grows with the mass; in Hertz's law it
/// falls slowly with the radius, so grains of one material are taken to share a density), and, as
/// its partner, the largest pinned one as well. A piston yields, like a grain of its mass. Two
/// things that cannot move never touch, nor do materials that are set apart. Where one law holds
/// for all, all count as one material.
template <int Dim, class Law, Needs needs>
TimeScales time_scales(const Grains<Dim, needs>& g, const LawTable<Law>& laws,
                       const std::vector<Wall<Dim>>& walls) {
  struct Extremes {
    int lightest = -1;        // that moves
    int largest_pinned = -1;  // -1: there is none
  };
  std::map<std::size_t, Extremes> extremes;
  for (int i = 0; i < g.size(); ++i) {
    const bool alike = laws.one_law() || g.material.empty();
    auto& [lightest, pinned] = extremes[alike ? 0 : g.material[static_cast<std::size_t>(i)]];
    if (g.inverse_mass[i] > 0) {
      if (lightest < 0 || g.mass[i] < g.mass[lightest]) lightest = i;
    } else {
      if (pinned < 0 || g.radius[i] > g.radius[pinned]) pinned = i;
    }
  }
  TimeScales scales;
  const auto consider = [&](const Law& law, double m, double r) {
    const double contact = law.contact_time(m, r);
    scales.contact = std::min(scales.contact, contact);
    scales.safe_step = std::min(scales.safe_step, kLargestContactFraction * contact);
    scales.safe_step =
        std::min(scales.safe_step,
                 largest_damped_phase(law.largest_damping_ratio()) * law.natural_time(m, r));
  };
  const auto in_parallel = [](double a, double b) { return 1 / (1 / a + 1 / b); };
  const auto consider_pair = [&](const Law& law, int i, int j) {
    if (i < 0 || j < 0) return;
    const double m = g.inverse_mass[j] > 0 ? in_parallel(g.mass[i], g.mass[j]) : g.mass[i];
    consider(law, m, in_parallel(g.radius[i], g.radius[j]));
  };
  for (const auto& [a, of_a] : extremes) {
    for (const auto& [b, of_b] : extremes) {
      if (b < a || laws.apart()(a, b)) continue;
      const Law& law = laws.between(a, b);
      consider_pair(law, of_a.lightest, of_b.lightest);
      consider_pair(law, of_a.lightest, of_b.largest_pinned);
      consider_pair(law, of_b.lightest, of_a.largest_pinned);
    }
    for (const Wall<Dim>& wall : walls) {
      if (laws.apart()(a, static_cast<std::size_t>(wall.material))) continue;
      const Law& law = laws.between(a, static_cast<std::size_t>(wall.material));
      const auto* piston = std::get_if<Piston<Dim>>(&wall.motion);
      if (const int i = of_a.lightest; i >= 0) {
        consider(law, piston ? in_parallel(g.mass[i], piston->mass) : g.mass[i], g.radius[i]);
      }
      if (const int i = of_a.largest_pinned; i >= 0 && piston) {
        consider(law, piston->mass, g.radius[i]);
      }
    }
  }
  return scales;
}

}  // namespace lagrain
