// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `ContactScene` holds what a pass over contacts reads: grains, walls, laws. `Tally` holds what it
/// adds up.

#include <lagrain/law_table.hpp>
#include <lagrain/needs.hpp>
#include <lagrain/records.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lagrain {

/// What one sweep over contacts adds up.
struct Tally {
  double dashpot = 0;   ///< [J]
  double friction = 0;  ///< [J]
  double excess = 0;    ///< largest overlap beyond the limit [m]
  double contacts = 0;  ///< that touch [-]

  /// Adds another tally; of the excesses the larger one stays.
  Tally& operator+=(const Tally& other) {
    dashpot += other.dashpot;
    friction += other.friction;
    excess = std::max(excess, other.excess);
    contacts += other.contacts;
    return *this;
  }
};

/// How many of the listed pairs touch: most of them in a bed at rest, few where grains fly. A loose
/// list is searched first for those that touch, because the law is not worth its time for all.
/// Forces do not depend on the choice, bit for bit; losses are added in another order.
enum class Listing { tight, loose };

/// A list of which fewer touch than this part is searched first. In beds at rest of `bench_lagrain`
/// the search took a sixth (discs) to a twelfth (spheres) of what the law takes, so it pays where
/// more than that part of the law's work is spared. At half of the number, lists of which half
/// touch would be gone through by the law alone, which takes up to twice as long for them; above 1,
/// beds at rest would be searched too, which takes 5 to 12 % longer.
inline constexpr double kTightFrom = 0.8;

/// What is faster for so many pairs of which so many touch.
inline Listing listing_for(std::size_t pairs, double touching) {
  return touching < kTightFrom * static_cast<double>(pairs) ? Listing::loose : Listing::tight;
}

/// The forces of a contact on both its grains, kept for later. They are to be added to the load of
/// i and subtracted from that of j.
template <int Dim, Needs needs>
struct PairLoad {
  LoadRecord<Dim, needs> for_i;  ///< what i feels
  LoadRecord<Dim, needs> for_j;  ///< the opposite of what j feels

  /// Adds its force to the load of i.
  void give_to_i(LoadRecord<Dim, needs>& load) const {
    for (std::size_t c = 0; c < load.at.size(); ++c) load.at[c] += for_i.at[c];
  }
  /// Subtracts its force from the load of j.
  void give_to_j(LoadRecord<Dim, needs>& load) const {
    for (std::size_t c = 0; c < load.at.size(); ++c) load.at[c] -= for_j.at[c];
  }
};

/// What all contacts of a pass share: the grains, walls and laws, and where loads are added.
template <int Dim, class Law>
struct ContactScene {
  const GrainRecord<Dim, Law::needs>* grains = nullptr;  ///< of all slots
  LoadRecord<Dim, Law::needs>* loads = nullptr;          ///< of the slots from first_slot on
  const std::vector<std::uint8_t>* materials = nullptr;  ///< of the slots; empty: all are 0
  const LawTable<Law>* laws = nullptr;                   ///< between materials
  const Wall<Dim>* walls = nullptr;                      ///< as they are now
  double time_step = 0;        ///< what memories and losses advance by [s]
  double largest_overlap = 0;  ///< of the smaller radius [-]
  int first_slot = 0;          ///< whose load is the first of `loads`

  /// The material of the grain in a slot.
  std::size_t material(int slot) const {
    return materials->empty() ? 0 : (*materials)[static_cast<std::size_t>(slot)];
  }
  /// The law between the grains in two slots.
  const Law& law(int i, int j) const { return laws->between(material(i), material(j)); }
  /// The law between the grain in a slot and a wall.
  const Law& law_with_wall(int i, const Wall<Dim>& wall) const {
    return laws->between(material(i), static_cast<std::size_t>(wall.material));
  }
  /// The load of a slot.
  LoadRecord<Dim, Law::needs>& load(int slot) const { return loads[slot - first_slot]; }
};

}  // namespace lagrain
