// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `PinnedGrains` knows which grains nothing moves.

#include <cstddef>
#include <vector>

namespace lagrain {

/// Which grains stay where they are, or move as they are driven, whatever pushes them.
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
  bool none() const { return pinned_.empty(); }  ///< whether all grains can move

 private:
  std::vector<bool> pinned_;  // empty: none is
};

}  // namespace lagrain
