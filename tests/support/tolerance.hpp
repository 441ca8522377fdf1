// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Errors as numbers, so that a failed check prints them.

#include <cmath>

namespace lagrain::test {

/// |measured - expected| / |expected|; 0 where both are equal, so that an expected 0 has to be met
/// exactly. Tests use it instead of doctest's Approx, which adds 1 to |expected| unless told
/// otherwise: a small number then passes with almost any value.
inline double relative_error(double measured, double expected) {
  if (measured == expected) return 0;
  return std::abs(measured - expected) / std::abs(expected);
}

/// p in error ~ step^p from two errors whose steps stand in the given ratio.
inline double observed_order(double coarse, double fine, double ratio = 2) {
  return std::log(coarse / fine) / std::log(ratio);
}

}  // namespace lagrain::test
