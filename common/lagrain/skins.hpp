// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Why a triangulation that follows the grains lazily misses no contact, and how large the skins
/// may be that make it so. Pure functions of a few numbers; who calls them is in follower.hpp.
///
/// Symbols, for a grain i (or a, b, j):
///
///     r_i   radius                                  x_i   where its centre is now
///     s_i   skin, positive                          c_i   its reference centre, a site of T
///     w_i   weight of the site, (r_i + s_i)^2
///
/// T is the regular triangulation of the sites c_i with the weights w_i.
///
/// **Theorem A** (Ferrez & Liebling 2000, theorem 2.1, with overlaps). Let the balls of radii rho
/// about c_a and c_b meet, and let every third ball k meet both at less than a right angle:
///
///     |c_k - c_a|^2 > rho_k^2 + rho_a^2,   |c_k - c_b|^2 > rho_k^2 + rho_b^2.             (1)
///
/// If (1) holds for the pair a, b as well, it is an edge of the regular triangulation with weights
/// rho^2, in any dimension. Proof: let p = l c_a + m c_b, with l + m = 1, be the point of the
/// segment that has the same power P = |p - c_a|^2 - rho_a^2 to both. The balls meet, so P <= 0,
/// and P = l m |c_a - c_b|^2 - l rho_a^2 - m rho_b^2. The power of p to any third ball k is
///
///     l |c_k - c_a|^2 + m |c_k - c_b|^2 - l m |c_a - c_b|^2 - rho_k^2 > -P >= 0 >= P
///
/// by (1). So p is nearer in power to a and b than to all others: it lies inside the common face of
/// their cells.
///
/// **Theorem B** (the certificate). If no site is hidden and every edge a, b of T fulfils
///
///     |c_a - c_b|^2 > w_a + w_b,                                                          (2)
///
/// then every pair does. So (1) needs to be tested on the edges alone. Proof: let a, b violate (2).
/// If c_a lies in its own cell, let b' have the least power at c_a among the others; that power is
/// at most w_a, and without a the cell of b' would hold c_a, so a, b' is an edge, and violates (2).
/// If c_a does not lie in its own cell, walk from c_a to that cell: the edge across which the walk
/// enters it violates (2). (If T has such edges or hidden sites, both ends of every violating pair
/// lie on a violating edge, or are hidden: it is enough to search around these.)
///
/// **Corollary** (skins). While |x_i - c_i| <= s_i for all grains, two grains that touch have
/// |c_a - c_b| <= (r_a + s_a) + (r_b + s_b): their reference balls of radii r + s meet. If the
/// certificate (2) holds, they are an edge of T. So T may stay as it is until a grain leaves its
/// skin, whatever the speeds and the time step.

#include <cmath>

namespace lagrain {

/// The weight of a site whose grain has a skin [m^2].
inline double weight_with(double radius, double skin) { return (radius + skin) * (radius + skin); }

/// The certificate (2): whether two reference balls meet at less than a right angle, or not at all.
/// One part in 10^12 covers the rounding of both sides.
inline bool passes_certificate(double squared_distance, double weight_a, double weight_b) {
  return squared_distance > (weight_a + weight_b) * (1 + 1e-12);
}

/// The skin that two grains of radii a and b may both have, at any two instants at which their
/// references are taken.
///
/// Suppose that a's reference is put at its true place now, while b has strayed from its own by at
/// most its skin s. The references are then at least d - s apart, d being the distance of the
/// grains, and (2) asks for
///
///     (d - s)^2 > (a + s)^2 + (b + s)^2,  that is  s^2 + 2 (a + b + d) s < d^2 - a^2 - b^2.   (3)
///
/// @returns the positive root of (3) [m]; 0 if there is none. Two equal grains that touch get
/// (3 sqrt 2 - 4) r = 0.2426 r.
inline double fair_skin(double a, double b, double squared_distance) {
  const double slack = squared_distance - a * a - b * b;
  const double sum = a + b + std::sqrt(squared_distance);
  return slack > 0 ? std::sqrt(sum * sum + slack) - sum : 0;
}

/// The skin that the certificate allows a grain i against one neighbour j whose reference stays.
///
/// The new reference is put at c_i = x_i + q s u: ahead by a share q of the new skin s, along the
/// unit vector u in which the grain moves. With v = x_i - c_j, (2) reads
///
///     |v + q s u|^2 > (r_i + s)^2 + w_j,
///     that is  (1 - q^2) s^2 + 2 (r_i - q v.u) s < |v|^2 - r_i^2 - w_j.                     (4)
///
/// @param b      r_i - q v.u [m]
/// @param share  q, in [0, 1)
/// @param slack  the right side of (4) [m^2]
/// @returns the positive root s of (4) [m]; 0 if there is none
inline double allowed_skin(double b, double share, double slack) {
  if (!(slack > 0)) return 0;
  const double a = 1 - share * share;
  const double root = std::sqrt(b * b + a * slack);
  return b > 0 ? slack / (b + root) : (root - b) / a;  // whichever does not cancel
}

/// A skin, of the smaller radius, that passes between any two grains whose references are taken at
/// their true places at any instants, if they hardly overlap: just below 3 sqrt 2 - 4, from (3).
inline constexpr double kSmallSkin = 0.24;

/// Part of a skin that a grain may use: rounding in the tests cannot matter.
inline constexpr double kUsable = 1 - 1e-6;

}  // namespace lagrain
