// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Points in, sign out: the exact geometric decisions of the regular triangulation in the plane.
///
/// Every sign is exact. A floating-point filter with a proven error bound answers nearly always;
/// what it cannot decide goes out of line to interval and then to multiprecision arithmetic.
///
/// **The tie rule.** Site i has the height h_i = |x_i|^2 - w_i, and T is the lower convex hull of
/// the lifted sites. Ties are broken by an infinitesimal perturbation h_i + eps_i with eps_0 >>
/// eps_1 >> ... > 0, in the order of the ids, which never change. T is then unique, so two ways to
/// it must agree triangle for triangle. Perturbing heights and not positions never creates a flat
/// simplex (Devillers & Teillaud, Comput. Geom. 44 (2011) 160). CGAL orders by coordinates instead;
/// coordinates of grains change, and cocircular groups would be cut anew for no reason.

#include <cmath>

namespace lagrain {

/// A weighted site: position x, y [m] and weight w [m^2]. All finite.
struct Site2 {
  double x;  ///< [m]
  double y;  ///< [m]
  double w;  ///< [m^2]

  bool operator==(const Site2&) const = default;
};

namespace detail {
int exact_orientation(const Site2& a, const Site2& b, const Site2& c);
int exact_power_side(const Site2& a, const Site2& b, const Site2& c, const Site2& d);
int exact_power_side_on_line(const Site2& a, const Site2& b, const Site2& d);
bool tie_in_conflict(const Site2* sites, int a, int b, int c, int d);
bool conflict_on_line(const Site2* sites, int a, int b, int d);
}  // namespace detail

/// Sign of the area of the triangle a, b, c: +1 counter-clockwise, 0 collinear, -1 clockwise.
///
/// Bound: with u = 2^-53 each difference carries one rounding, each product two more and their own,
/// the subtraction one: the error is at most gamma_4 (|p| + |q|) in exact p, q, and the computed
/// |p| + |q| is at least (1 - gamma_4) times that: 8 u covers it. A product that underflows adds at
/// most 2^-1074, or 2^-1022 where subnormals are flushed: 2^-1000 covers it. An overflow makes the
/// bound infinite or not a number, and both comparisons false.
inline int orientation(const Site2& a, const Site2& b, const Site2& c) {
  const double p = (a.x - c.x) * (b.y - c.y);
  const double q = (a.y - c.y) * (b.x - c.x);
  const double bound = 0x1p-50 * (std::abs(p) + std::abs(q)) + 0x1p-1000;
  if (p - q > bound) return 1;
  if (q - p > bound) return -1;
  return detail::exact_orientation(a, b, c);
}

/// Sign of the height of the plane through the lifted a, b, c above the lifted d, without
/// perturbation: +1 if d is in conflict with the triangle, 0 on a tie.
/// @pre a, b, c counter-clockwise
///
/// Everything is taken relative to d: with (x, y)_i = x_i - x_d and h_i = x^2 + y^2 - (w_i - w_d)
/// it is the sign of D = sum over the cyclic i, j, k of h_i (x_j y_k - y_j x_k).
///
/// Bound: h_i carries at most 5 factors (1 + delta), |delta| <= u, on its sum of moduli H_i, a
/// bracket 4 on its sum of moduli M_i, their product one more, the two additions 2. So the error is
/// at most gamma_12 P with P = sum H_i M_i in exact terms, the computed P is at least (1 -
/// gamma_12) times that, and 16 u covers both. Each of the fewer than 16 products underflows by at
/// most 2^-1022, and the result is multiplied by at most max(1, H, M), where M <= H_j + H_k: the
/// last term.
inline int power_side(const Site2& a, const Site2& b, const Site2& c, const Site2& d) {
  const double ax = a.x - d.x, ay = a.y - d.y, aw = a.w - d.w;
  const double bx = b.x - d.x, by = b.y - d.y, bw = b.w - d.w;
  const double cx = c.x - d.x, cy = c.y - d.y, cw = c.w - d.w;
  const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const double bxcy = bx * cy, bycx = by * cx;
  const double cxay = cx * ay, cyax = cy * ax;
  const double axby = ax * by, aybx = ay * bx;
  const double det =
      (a2 - aw) * (bxcy - bycx) + (b2 - bw) * (cxay - cyax) + (c2 - cw) * (axby - aybx);
  const double ha = a2 + std::abs(aw), hb = b2 + std::abs(bw), hc = c2 + std::abs(cw);
  const double permanent = ha * (std::abs(bxcy) + std::abs(bycx)) +
                           hb * (std::abs(cxay) + std::abs(cyax)) +
                           hc * (std::abs(axby) + std::abs(aybx));
  const double bound = 0x1p-49 * permanent + 0x1p-1000 * (1 + ha + hb + hc);
  if (det > bound) return 1;
  if (-det > bound) return -1;
  return detail::exact_power_side(a, b, c, d);
}

/// True if site d, lifted and perturbed, lies below the plane of the triangle a, b, c, so that this
/// triangle cannot belong to T. Ids index `sites`; all four differ.
/// @pre a, b, c strictly counter-clockwise
inline bool in_conflict(const Site2* sites, int a, int b, int c, int d) {
  const int side = power_side(sites[a], sites[b], sites[c], sites[d]);
  return side != 0 ? side > 0 : detail::tie_in_conflict(sites, a, b, c, d);
}

/// The same for the infinite triangle on the left of a -> b, where the hull runs b -> a with the
/// sites on its left: true if d lies strictly on the left of a -> b, or on the line and below the
/// line through the lifted a and b (extended beyond both).
/// @pre a and b at different places
inline bool in_conflict_beyond(const Site2* sites, int a, int b, int d) {
  const int side = orientation(sites[a], sites[b], sites[d]);
  return side != 0 ? side > 0 : detail::conflict_on_line(sites, a, b, d);
}

}  // namespace lagrain
