// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How deep a scene's grains will overlap, guessed before it is run.

#include <lagrain/run.hpp>

namespace lagrain {

/// Contacts that overlap by more of the smaller radius are soft against what they have to bear: a
/// bed then settles visibly, and a fast grain sinks into others [-].
inline constexpr double kSoundOverlap = 0.01;

/// What the weight and the deepest impact of a scene do to its softest contact. It is dead
/// reckoning, good for a factor of two.
struct OverlapEstimate {
  double load = 0;               ///< weight of the heaviest column of grains, one diameter wide [N]
  double overlap_of_load = 0;    ///< at its foot, of the smaller radius [-]
  double speed = 0;              ///< of the impact that overlaps deepest [m/s]
  double overlap_of_impact = 0;  ///< of the smaller radius [-]
  /// With it the largest overlap is kSoundOverlap: the first key of the normal law, which is k in
  /// N/m or E* in Pa. 0 if nothing overlaps.
  double stiffness = 0;

  /// The largest overlap [-]: where grains land, others press.
  double overlap() const { return overlap_of_load + overlap_of_impact; }
};

/// The estimate for a run at its start. Loads stand in columns; grains fall straight down until
/// they reach a wall or those below them, and hit what is heavy and at rest. The loads of pistons
/// and the speeds of walls are not counted.
template <int Dim>
OverlapEstimate estimate_overlap(const Run<Dim>& run);

}  // namespace lagrain
