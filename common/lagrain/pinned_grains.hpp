// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `PinnedGrains` knows which grains nothing moves.

#include <lagrain/neighbourhood.hpp>

#include <cstddef>
#include <vector>

namespace lagrain {

/// Which grains stay where they are, whatever pushes them. Two things that cannot move exert
/// nothing on each other: their pair is no contact, holds no energy and need not be listed.
class PinnedGrains {
 public:
  PinnedGrains() = default;  ///< all grains can move
  /// @param count         number of grains
  /// @param inverse_mass  inverse_mass(i) [1/kg], 0 for a pinned grain
  template <class F>
  PinnedGrains(int count, F&& inverse_mass) {
    for (int i = 0; i < count; ++i) {
      if (inverse_mass(i) > 0) continue;
      pinned_.resize(static_cast<std::size_t>(count));
      pinned_[static_cast<std::size_t>(i)] = true;
    }
  }

  /// Whether grain i is pinned.
  bool operator[](int i) const { return !pinned_.empty() && pinned_[static_cast<std::size_t>(i)]; }
  /// Whether both grains of a pair are pinned.
  bool both(const Pair& pair) const { return (*this)[pair.i] && (*this)[pair.j]; }
  /// Takes the pairs out of a list that can be no contact.
  void drop_from(std::vector<Pair>& pairs) const {
    if (!pinned_.empty()) std::erase_if(pairs, [&](const Pair& pair) { return both(pair); });
  }

 private:
  std::vector<bool> pinned_;  // empty: none is
};

}  // namespace lagrain
