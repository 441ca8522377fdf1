// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How thick the lines of forces are drawn, and what their legend says.

#include <lagrain/run.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lagrain::figures {

/// Of the forces; stronger ones are drawn no thicker.
inline constexpr double kThickestShare = 0.999;

/// The force above which lines grow no thicker [N].
template <int Dim>
double force_ceiling(const std::vector<ContactRecord<Dim>>& contacts) {
  std::vector<double> forces;
  for (const ContactRecord<Dim>& c : contacts) forces.push_back(c.force.norm());
  if (forces.empty()) return 1;
  const auto at =
      static_cast<std::ptrdiff_t>(kThickestShare * static_cast<double>(forces.size() - 1));
  std::nth_element(forces.begin(), forces.begin() + at, forces.end());
  return forces[static_cast<std::size_t>(at)];
}

/// Round values for a legend of forces up to the given one: about 20, 50 and 100 %.
inline std::vector<double> legend_forces(double ceiling) {
  const double unit = std::pow(10, std::floor(std::log10(ceiling)));
  const double top = std::floor(ceiling / unit) * unit;
  return {0.2 * top, 0.5 * top, top};
}

}  // namespace lagrain::figures
