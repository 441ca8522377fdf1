// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `PinnedGrains` knows which grains nothing moves.

#include <lagrain/neighbourhood.hpp>

#include <cstddef>
#include <vector>

namespace lagrain {

/// Which grains stay where they are, or move as they are driven, whatever pushes them. Two things
/// that no force moves exert nothing on each other: their pair is no contact, holds no energy and
/// need not be listed.
class PinnedGrains {
 public:
  PinnedGrains() = default;  ///< all grains can move
  /// @param count         number of grains
  /// @param inverse_mass  inverse_mass(i) [1/kg], 0 for a pinned or driven grain
  template <class F>
  PinnedGrains(int count, F&& inverse_mass) {
    for (int i = 0; i < count; ++i) {
      if (inverse_mass(i) > 0) continue;
      pinned_.resize(static_cast<std::size_t>(count));
      pinned_[static_cast<std::size_t>(i)] = true;
    }
  }

  /// Whether no force moves grain i.
  bool operator[](int i) const { return !pinned_.empty() && pinned_[static_cast<std::size_t>(i)]; }
  /// Whether no force moves either grain of a pair.
  bool both(const Pair& pair) const { return (*this)[pair.i] && (*this)[pair.j]; }
  /// Takes the pairs out of a list that can be no contact.
  void drop_from(std::vector<Pair>& pairs) const {
    if (!pinned_.empty()) std::erase_if(pairs, [&](const Pair& pair) { return both(pair); });
  }

 private:
  std::vector<bool> pinned_;  // empty: none is
};

}  // namespace lagrain
