// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Where a function of one variable is least.

namespace lagrain {

/// The place of the only minimum between two bounds, by golden sections; of a function without one
/// between them, an end. Each section leaves 0.618 of the rest: 60 leave what is below rounding.
/// @param f  f(x)
template <class F>
double least_between(double low, double high, F&& f) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSections = 60;
  for (int k = 0; k < kSections; ++k) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    if (f(a) < f(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return 0.5 * (low + high);
}

}  // namespace lagrain
