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

/// Shortest collision and safe step over all pairs of materials that occur, with the lightest grain
/// of each (the time grows with the mass; in Hertz's law it falls slowly with the radius, so grains
/// of one material are taken to share a density), and the walls. A piston yields, like a grain of
/// its mass. Where one law holds for all, all count as one material.
template <int Dim, class Law, Needs needs>
TimeScales time_scales(const Grains<Dim, needs>& g, const LawTable<Law>& laws,
                       const std::vector<Wall<Dim>>& walls) {
  std::map<std::size_t, int> lightest;
  for (int i = 0; i < g.size(); ++i) {
    const bool alike = laws.one_law() || g.material.empty();
    const std::size_t material = alike ? 0 : g.material[static_cast<std::size_t>(i)];
    const auto [at, inserted] = lightest.try_emplace(material, i);
    if (!inserted && g.mass[i] < g.mass[at->second]) at->second = i;
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
  for (const auto& [a, i] : lightest) {
    for (const auto& [b, j] : lightest) {
      if (b < a) continue;
      consider(laws.between(a, b), 1 / (1 / g.mass[i] + 1 / g.mass[j]),
               1 / (1 / g.radius[i] + 1 / g.radius[j]));
    }
    for (const Wall<Dim>& wall : walls) {
      const auto* piston = std::get_if<Piston<Dim>>(&wall.motion);
      const double m = piston ? 1 / (1 / g.mass[i] + 1 / piston->mass) : g.mass[i];
      consider(laws.between(a, static_cast<std::size_t>(wall.material)), m, g.radius[i]);
    }
  }
  return scales;
}

}  // namespace lagrain
