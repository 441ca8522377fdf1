// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/restitution.hpp>

#include <lagrain/check.hpp>

#include <cmath>
#include <numbers>
#include <string>

namespace lagrain {

// In units of omega0 the overlap obeys x'' + 2 zeta x' + x = 0, x(0) = 0, x'(0) = 1. The force
// x + 2 zeta x' vanishes first when tan(w t) = -2 zeta w / (1 - 2 zeta^2), w = sqrt(1 - zeta^2)
// (hyperbolic above zeta = 1); the restitution is -x' at that moment, which simplifies to
// exp(-zeta t): there x = -2 zeta x' and the amplitude is exp(-zeta t) on both sides of zeta = 1.
double clamped_contact_time(double damping_ratio) {
  const double zeta = damping_ratio;
  if (zeta < 1) {
    const double w = std::sqrt((1 - zeta) * (1 + zeta));
    // The angle is pi - 2 asin(zeta) = 2 acos(zeta): sin and cos of it are 2 zeta w and 2 zeta^2
    // - 1.
    return w > 0 ? 2 * std::acos(zeta) / w : 2;
  }
  const double w = std::sqrt((zeta - 1) * (zeta + 1));
  return w > 0 ? 2 * std::acosh(zeta) / w : 2;
}

double clamped_restitution(double damping_ratio) {
  return std::exp(-damping_ratio * clamped_contact_time(damping_ratio));
}

namespace {

/// Rounds to 40 significant bits, which are the same with every C library: their exp and acos
/// differ by a few units in the last of 53.
double with_bits_of_any_library(double number) {
  constexpr int kBits = 40;
  int exponent = 0;
  const double fraction = std::frexp(number, &exponent);
  return std::ldexp(std::round(std::ldexp(fraction, kBits)), exponent - kBits);
}

}  // namespace

double damping_ratio_for(double restitution) {
  LAGRAIN_EXPECTS(restitution > 0 && restitution <= 1,
                  "restitution " + std::to_string(restitution) + " is out of range");
  if (restitution == 1) return 0;
  double low = 0;
  double high = 1;
  while (clamped_restitution(high) > restitution) high *= 2;
  // Bisection to the last bit: the relation is smooth and falls all the way.
  for (double middle = 0.5 * (low + high); low < middle && middle < high;
       middle = 0.5 * (low + high)) {
    (clamped_restitution(middle) > restitution ? low : high) = middle;
  }
  return with_bits_of_any_library(high);
}

}  // namespace lagrain
