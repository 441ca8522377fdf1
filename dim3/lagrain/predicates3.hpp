// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Points in, sign out: the exact geometric decisions of the regular triangulation in space.
///
/// Every sign is exact: a floating-point filter with a proven error bound answers nearly always,
/// what it cannot decide goes out of line to interval and then to multiprecision arithmetic.
///
/// **The tie rule** is that of the plane (predicates2.hpp): site i has the height h_i = |x_i|^2 -
/// w_i + eps_i with infinitesimal eps_0 >> eps_1 >> ... > 0 in the order of the ids. T is then
/// unique, and because heights are perturbed and not positions, no tetrahedron of T is flat
/// (Devillers & Teillaud, Comput. Geom. 44 (2011) 160).

#include <algorithm>
#include <cmath>

namespace lagrain {

/// A weighted site: position x, y, z [m] and weight w [m^2]. All finite.
struct Site3 {
  double x;  ///< [m]
  double y;  ///< [m]
  double z;  ///< [m]
  double w;  ///< [m^2]

  bool operator==(const Site3&) const = default;
};

namespace detail {
int exact_orientation(const Site3& a, const Site3& b, const Site3& c, const Site3& d);
int exact_power_side(const Site3& a, const Site3& b, const Site3& c, const Site3& d,
                     const Site3& e);
bool collinear(const Site3& a, const Site3& b, const Site3& c);
bool tie_in_conflict(const Site3* sites, int a, int b, int c, int d, int e);
bool conflict_in_plane(const Site3* sites, int a, int b, int c, int d);

inline double largest(double a, double b, double c) {
  return std::max(std::abs(a), std::max(std::abs(b), std::abs(c)));
}
inline double largest(double a, double b, double c, double d) {
  return std::max(std::max(std::abs(a), std::abs(b)), std::max(std::abs(c), std::abs(d)));
}
/// True if products of four such factors neither overflow nor lose digits to underflow.
inline bool tame(double a, double b, double c, double d) {
  return std::min(std::min(a, b), std::min(c, d)) > 0x1p-200 &&
         std::max(std::max(a, b), std::max(c, d)) < 0x1p+200;
}
}  // namespace detail

/// Sign of the volume of the tetrahedron a, b, c, d: +1 if b - a, c - a, d - a are right-handed, 0
/// if the four lie in one plane, else -1.
///
/// Bound: with u = 2^-53 each difference carries one rounding, each of the six products of three
/// differences then at most 8, so the error is at most gamma_8 times six times X Y Z, the product
/// of the largest differences in x, y, z. 64 u = 2^-47 covers it and the rounding of the bound.
inline int orientation(const Site3& a, const Site3& b, const Site3& c, const Site3& d) {
  const double bx = b.x - a.x, by = b.y - a.y, bz = b.z - a.z;
  const double cx = c.x - a.x, cy = c.y - a.y, cz = c.z - a.z;
  const double dx = d.x - a.x, dy = d.y - a.y, dz = d.z - a.z;
  const double det = bx * (cy * dz - cz * dy) + by * (cz * dx - cx * dz) + bz * (cx * dy - cy * dx);
  const double x = detail::largest(bx, cx, dx), y = detail::largest(by, cy, dy),
               z = detail::largest(bz, cz, dz);
  const double bound = 0x1p-47 * (x * y * z);
  if (std::abs(det) > bound && detail::tame(x, y, z, 1)) return det > 0 ? 1 : -1;
  return detail::exact_orientation(a, b, c, d);
}

/// Sign of the height of the hyperplane through the lifted a, b, c, d above the lifted e, without
/// perturbation: +1 if e is in conflict with the tetrahedron, 0 on a tie.
/// @pre a, b, c, d positive
///
/// Everything is taken relative to e: with p_i = x_i - x_e and h_i = |p_i|^2 - (w_i - w_e) it is
/// the sign of D = h_a [b c d] - h_b [a c d] + h_c [a b d] - h_d [a b c], brackets determinants.
///
/// Bound: h_i carries at most 6 roundings on the sum of its moduli, at most H; a bracket 8 on at
/// most 6 X Y Z; their product one more, the sum of four two more. So the error is at most gamma_17
/// 24 X Y Z H, and 512 u = 2^-44 covers it and the rounding of the bound.
inline int power_side(const Site3& a, const Site3& b, const Site3& c, const Site3& d,
                      const Site3& e) {
  const double ax = a.x - e.x, ay = a.y - e.y, az = a.z - e.z, aw = a.w - e.w;
  const double bx = b.x - e.x, by = b.y - e.y, bz = b.z - e.z, bw = b.w - e.w;
  const double cx = c.x - e.x, cy = c.y - e.y, cz = c.z - e.z, cw = c.w - e.w;
  const double dx = d.x - e.x, dy = d.y - e.y, dz = d.z - e.z, dw = d.w - e.w;
  const double a2 = ax * ax + ay * ay + az * az, b2 = bx * bx + by * by + bz * bz;
  const double c2 = cx * cx + cy * cy + cz * cz, d2 = dx * dx + dy * dy + dz * dz;
  const double ab = ax * by - bx * ay, ac = ax * cy - cx * ay, ad = ax * dy - dx * ay;
  const double bc = bx * cy - cx * by, bd = bx * dy - dx * by, cd = cx * dy - dx * cy;
  const double bcd = bz * cd - cz * bd + dz * bc, acd = az * cd - cz * ad + dz * ac;
  const double abd = az * bd - bz * ad + dz * ab, abc = az * bc - bz * ac + cz * ab;
  const double det = ((a2 - aw) * bcd - (b2 - bw) * acd) + ((c2 - cw) * abd - (d2 - dw) * abc);
  const double x = detail::largest(ax, bx, cx, dx), y = detail::largest(ay, by, cy, dy),
               z = detail::largest(az, bz, cz, dz);
  const double h = std::max(std::max(a2 + std::abs(aw), b2 + std::abs(bw)),
                            std::max(c2 + std::abs(cw), d2 + std::abs(dw)));
  const double bound = 0x1p-44 * (x * y * z * h);
  if (std::abs(det) > bound && detail::tame(x, y, z, h)) return det > 0 ? 1 : -1;
  return detail::exact_power_side(a, b, c, d, e);
}

/// True if site e, lifted and perturbed, lies below the hyperplane of the tetrahedron a, b, c, d,
/// so that this tetrahedron cannot belong to T. Ids index `sites`; all five differ.
/// @pre a, b, c, d strictly positive
inline bool in_conflict(const Site3* sites, int a, int b, int c, int d, int e) {
  const int side = power_side(sites[a], sites[b], sites[c], sites[d], sites[e]);
  return side != 0 ? side > 0 : detail::tie_in_conflict(sites, a, b, c, d, e);
}

/// The same for the infinite tetrahedron over the hull facet a, b, c, which sees the sites on its
/// negative side: true if d lies strictly on its positive side, or in its plane and below the plane
/// through the lifted a, b, c.
/// @pre a, b, c not collinear
inline bool in_conflict_beyond(const Site3* sites, int a, int b, int c, int d) {
  const int side = orientation(sites[a], sites[b], sites[c], sites[d]);
  return side != 0 ? side > 0 : detail::conflict_in_plane(sites, a, b, c, d);
}

}  // namespace lagrain
