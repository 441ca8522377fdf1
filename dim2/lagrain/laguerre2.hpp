// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Laguerre cells in the plane: the dual of the regular triangulation, cut to a box.

#include <lagrain/triangulation2.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Geometry>

namespace lagrain {

/// The points x of the box where the power |x - x_i|^2 - w_i of site i is least, as a
/// convex polygon, 2 x K, counter-clockwise; K = 0 if there are none (in particular if the
/// site is hidden).
///
/// Only the neighbours in T can bound the cell. Weights are those of T, so for inflated discs these
/// are the cells of the inflated discs. Corners are rounded: this is for drawing and measuring, not
/// for deciding.
/// @pre the site is present and the box is not empty
Columns<2> laguerre_cell(const Triangulation<2>& triangulation, int site,
                         const Eigen::AlignedBox2d& box);

/// Area [m^2] of a simple polygon, 2 x K; positive if counter-clockwise, 0 if K < 3.
double polygon_area(const Columns<2>& polygon);

}  // namespace lagrain
