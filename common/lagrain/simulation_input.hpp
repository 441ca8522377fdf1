// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// These checks refuse a simulation whose materials, time step or integrator do not fit.

#include <lagrain/check.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/integrator.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/time_step.hpp>
#include <lagrain/walls.hpp>

#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace lagrain {

/// @throws ContractError if a grain or wall is of a material that the table of laws lacks. (A table
/// of one law holds for all materials.)
template <int Dim, class Law, Needs needs>
void expect_known_materials(const Grains<Dim, needs>& grains, const LawTable<Law>& laws,
                            const std::vector<Wall<Dim>>& walls) {
  const int materials = laws.materials();
  LAGRAIN_EXPECTS(materials >= 1, "the table of laws is empty");
  if (laws.one_law()) return;
  const std::string have =
      ", but the table of laws has " + std::to_string(materials) + " materials";
  for (std::size_t i = 0; i < grains.material.size(); ++i) {
    LAGRAIN_EXPECTS(grains.material[i] < materials, "grain " + std::to_string(i) +
                                                        " is of material " +
                                                        std::to_string(grains.material[i]) + have);
  }
  for (const Wall<Dim>& wall : walls) {
    LAGRAIN_EXPECTS(
        wall.material >= 0 && wall.material < materials,
        "wall " + wall.name + " is of material " + std::to_string(wall.material) + have);
  }
}

/// @throws ContractError if a time step [s] is not positive, or larger than the stiffest contact
/// allows; the message names the safe one
inline void expect_safe_step(double time_step, const TimeScales& scales) {
  std::ostringstream message;
  message << "time step " << time_step << " s: the stiffest contact lasts " << scales.contact
          << " s and allows at most " << scales.safe_step << " s";
  LAGRAIN_EXPECTS(time_step > 0 && time_step <= scales.safe_step, message.str());
}

/// @throws ContractError if a wall cannot move or turn as it should, see Wall::defect, or a piston
/// cannot hold its pressure, see pressure_defect
template <int Dim>
void expect_sound_walls(const std::vector<Wall<Dim>>& walls) {
  for (const Wall<Dim>& wall : walls) {
    const std::string why = wall.defect();
    LAGRAIN_EXPECTS(why.empty(), "wall " + wall.name + ": " + why);
    const std::string no_pressure = pressure_defect(walls, wall);
    LAGRAIN_EXPECTS(no_pressure.empty(), "wall " + wall.name + ": " + no_pressure);
  }
}

/// @throws ContractError if an integrator for conservative scenes meets a law that takes energy, or
/// a wall that moves
template <Integrator Motion, int Dim, class Law>
void expect_integrable(const LawTable<Law>& laws, const std::vector<Wall<Dim>>& walls) {
  if (!Motion::kConservativeOnly) return;
  const std::string integrates = std::string(Motion::kName) + " integrates conservative scenes: ";
  const auto materials = static_cast<std::size_t>(laws.materials());
  for (std::size_t k = 0; k < materials * materials; ++k) {
    LAGRAIN_EXPECTS(laws.between(k / materials, k % materials).conservative(),
                    integrates + "restitution 1");
  }
  for (const Wall<Dim>& wall : walls) {
    LAGRAIN_EXPECTS(!wall.drives(), integrates + "wall " + wall.name + " moves");
  }
}

}  // namespace lagrain
