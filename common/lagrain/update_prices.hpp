// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// These prices decide whether the regular triangulation T is moved grain by grain or built anew.

#include <cstdint>

namespace lagrain {

/// Prices [ns] on one core, as measured on the shaken beds of `bench_lagrain` and rounded; its
/// update_against_build and figure 14 show moves and builds by themselves. Only their ratios
/// matter. They change no result: a wrong price makes T leap earlier or later. T leaps once single
/// moves have cost as much as one leap of all grains, so the choice costs at most about twice what
/// the better one does; with a ratio wrong by a factor of two, at most about three times.
template <int Dim>
struct UpdatePrices {
  /// Moves one reference in T.
  static constexpr std::int64_t kMove = Dim == 2 ? 800 : 6000;
  /// The surplus if it had to be taken out.
  static constexpr std::int64_t kExtraction = Dim == 2 ? 5000 : 90000;
  /// Finds the partners of one grain by a walk.
  static constexpr std::int64_t kWalk = Dim == 2 ? 3000 : 8000;
  /// Compares a grain that walks with one that stands apart.
  static constexpr std::int64_t kComparison = 2;
  /// A leap, or a build from nothing, for each grain.
  static constexpr std::int64_t kLeap = Dim == 2 ? 3000 : 8000;
};

}  // namespace lagrain
