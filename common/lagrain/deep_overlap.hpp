// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// When an overlap exceeds what the run allows, these functions find the deepest one and end the
/// run with the names of the two.

#include <lagrain/check.hpp>
#include <lagrain/contact_scene.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/pair_table.hpp>
#include <lagrain/records.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace lagrain {

/// An overlap of a grain with another one or with a wall.
struct DeepOverlap {
  double ratio = 0;        ///< of the smaller radius [-]
  int slot = -1;           ///< of the grain; -1: no overlap is noted
  int partner = -1;        ///< slot of the other grain, or the wall's place among the walls
  bool with_wall = false;  ///< whether the partner is a wall
};

/// Overlap of two grains, of the smaller radius [-]; negative if they are apart.
template <int Dim, Needs needs>
double overlap_ratio(const GrainRecord<Dim, needs>& a, const GrainRecord<Dim, needs>& b) {
  return (a.radius() + b.radius() - (a.position() - b.position()).norm()) /
         std::min(a.radius(), b.radius());
}
/// Overlap of a grain with a wall, of its radius [-]; negative if they are apart.
template <int Dim, Needs needs>
double overlap_ratio(const GrainRecord<Dim, needs>& grain, const Wall<Dim>& wall) {
  return 1 - wall.foot(grain.position()).distance / grain.radius();
}

/// Notes the deepest overlap among listed pairs of grains, or of grains and walls, if it is deeper
/// than what is noted.
template <int Dim, class Law, class P, class Memory>
void note_deepest(DeepOverlap& deepest, const PairTable<P, Memory>& table,
                  const ContactScene<Dim, Law>& scene) {
  const auto note = [&](double ratio, int slot, int partner, bool with_wall) {
    if (ratio > deepest.ratio) deepest = {ratio, slot, partner, with_wall};
  };
  for (const P& pair : table.pairs()) {
    if constexpr (std::is_same_v<P, WallPair>) {
      note(overlap_ratio(scene.grains[pair.i], scene.walls[pair.wall]), pair.i, pair.wall, true);
    } else {
      note(overlap_ratio(scene.grains[pair.i], scene.grains[pair.j]), pair.i, pair.j, false);
    }
  }
}

/// Ends the run, and names who overlaps.
/// @param number  number(slot) of a grain
/// @param t       time [s]
/// @param limit   of the smaller radius [-]
/// @throws SimulationError always: it names the grains, or the grain and the wall
template <int Dim, class NumberOf>
[[noreturn]] void report_deep_overlap(const DeepOverlap& deepest, NumberOf&& number,
                                      const std::vector<Wall<Dim>>& walls, double t, double limit) {
  int grain = number(deepest.slot);
  std::string other;
  if (deepest.with_wall) {
    other = "wall " + walls[static_cast<std::size_t>(deepest.partner)].name;
  } else {
    const int second = number(deepest.partner);
    other = "grain " + std::to_string(std::max(grain, second));
    grain = std::min(grain, second);
  }
  std::ostringstream message;
  message << "t = " << t << " s: grain " << grain << " overlaps " << other << " by "
          << deepest.ratio << " of the smaller radius (limit " << limit
          << "); a stiffer contact, a smaller time step or a gentler start would help";
  throw SimulationError(message.str());
}

}  // namespace lagrain
