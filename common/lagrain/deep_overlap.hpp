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
#include <lagrain/touch.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <array>
#include <cmath>
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
  double closing = 0;      ///< how fast they approach [m/s]
  double impact = 0;       ///< speed of the free impact that has the contact's energy [m/s]
  double stiffer = 0;      ///< what missing_stiffness says [-]
};

/// What the spring of a contact holds, and what it has not stopped yet [J].
template <int Dim, class Law>
double energy_to_hold(const Law& law, const Touch<Dim>& touch) {
  const typename Law::template Memory<Dim> unstretched{};
  const double closing = std::max(0.0, touch.closing);
  return law.elastic_energy(touch, unstretched) + 0.5 * touch.effective_mass * closing * closing;
}

/// How many times as stiff a contact has to be if its overlap is to stay below a limit [-]: then
/// the spring holds at the limit all that it has to hold. (The energy of a spring is proportional
/// to its stiffness.)
/// @param touch  the contact as it is
/// @param limit  overlap [m]
template <int Dim, class Law>
double missing_stiffness(const Law& law, Touch<Dim> touch, double limit) {
  const typename Law::template Memory<Dim> unstretched{};
  const double to_hold = energy_to_hold(law, touch);
  touch.overlap = limit;
  return to_hold / law.elastic_energy(touch, unstretched);
}

/// Notes the deepest overlap among listed pairs of grains, or of grains and walls, if it is deeper
/// than what is noted.
template <int Dim, class Law, class P, class Memory>
void note_deepest(DeepOverlap& deepest, const PairTable<P, Memory>& table,
                  const ContactScene<Dim, Law>& scene) {
  const auto body = [&](int slot) {
    return read_bodies<double>(scene.grains, std::array<int, 1>{slot});
  };
  const auto note = [&](int slot, int partner, bool with_wall, const Law& law,
                        const MaybeTouch<Dim, double>& maybe, double smaller) {
    const Touch<Dim>& touch = maybe.touch;
    if (!maybe.touching || !(touch.overlap / smaller > deepest.ratio)) return;
    deepest = {touch.overlap / smaller,
               slot,
               partner,
               with_wall,
               touch.closing,
               std::sqrt(2 * energy_to_hold(law, touch) / touch.effective_mass),
               missing_stiffness(law, touch, scene.largest_overlap * smaller)};
  };
  for (std::size_t k = 0; k < table.size(); ++k) {
    const P& pair = table.pairs()[k];
    const auto i = body(pair.i);
    if constexpr (std::is_same_v<P, WallPair>) {
      const Wall<Dim>& wall = scene.walls[pair.wall];
      const auto [distance, normal] =
          contact_foot<Dim>(scene.walls, table.pairs(), k, i.position, i.radius);
      const Vec<Dim> velocity = wall.velocity_at(i.position - distance * normal, normal);
      note(pair.i, pair.wall, true, scene.law_with_wall(pair.i, wall),
           touch_of_wall(i, 1 / i.inverse_mass, distance, normal, velocity, wall.spin), i.radius);
    } else {
      const auto j = body(pair.j);
      note(pair.i, pair.j, false, scene.law(pair.i, pair.j), touch_of(i, j),
           std::min(i.radius, j.radius));
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
          << deepest.ratio << " of the smaller radius (largest_overlap is " << limit << ")";
  if (deepest.closing > 0) {
    message << " and goes on at " << deepest.closing << " m/s, with the energy of an impact at "
            << deepest.impact << " m/s";
  }
  message << "; ";
  if (deepest.stiffer > 1 && std::isfinite(deepest.stiffer)) {
    message << "a contact " << deepest.stiffer << " times as stiff would hold it, or ";
  }
  message << "a gentler start";
  throw SimulationError(message.str());
}

}  // namespace lagrain
