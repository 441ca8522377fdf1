// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Laguerre cells in space: the dual of the regular triangulation, cut to a box.

#include <lagrain/triangulation3.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Geometry>

#include <vector>

namespace lagrain {

/// A face of a Laguerre cell in space.
struct LaguerreFace {
  int beyond;  ///< the site whose cell is on the other side, or a side of the box (negative)
  Columns<3> corners;  ///< 3 x K, convex, counter-clockwise seen from outside [m]
};

/// How LaguerreFace::beyond names a side of the box: -1 and -2 for the lower and the upper one
/// along x, -3 and -4 along y, -5 and -6 along z.
constexpr int box_side(int axis, bool upper) { return -1 - 2 * axis - (upper ? 1 : 0); }

/// The points x of the box where the power |x - x_i|^2 - w_i of site i is least, as the faces of a
/// convex polyhedron; none if there are no such points (in particular if the site is hidden).
///
/// Only the neighbours in T can bound the cell. Weights are those of T, so for inflated spheres
/// these are the cells of the inflated spheres. Each face is cut out of its plane by itself:
/// rounding displaces corners (by about 1e-15 of the box) but cannot break the polyhedron.
/// Faces narrower than that, as ties have, are left out. This is for drawing and measuring, not
/// for deciding.
/// @pre the site is present and the box has a volume
std::vector<LaguerreFace> laguerre_cell(const Triangulation<3>& triangulation, int site,
                                        const Eigen::AlignedBox3d& box);

/// Volume [m^3] of a convex polyhedron; 0 without faces.
double polyhedron_volume(const std::vector<LaguerreFace>& faces);

/// Centre of mass [m] of a convex polyhedron.
/// @pre its volume is positive
Vec<3> polyhedron_centroid(const std::vector<LaguerreFace>& faces);

}  // namespace lagrain
