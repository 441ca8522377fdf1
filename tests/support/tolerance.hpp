#pragma once
/// @file
/// Errors as numbers, so that a failed check prints them.

#include <cmath>

namespace lagrain::test {

/// |measured - expected| / |expected|. (doctest's Approx adds its scale, 1 unless told otherwise,
/// so a small number passes with almost any value.)
inline double relative_error(double measured, double expected) {
  return std::abs(measured - expected) / std::abs(expected);
}

/// p in error ~ step^p from two errors whose steps stand in the given ratio.
inline double observed_order(double coarse, double fine, double ratio = 2) {
  return std::log(coarse / fine) / std::log(ratio);
}

}  // namespace lagrain::test
