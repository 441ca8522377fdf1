// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Walls as lines and polygons that can be shown.

#include <lagrain/vec.hpp>
#include <lagrain/walls.hpp>

#include <Eigen/Geometry>

#include <vector>

namespace lagrain {

/// Facets to a full turn: flat to 0.034 % of the radius.
inline constexpr int kFacets = 120;

/// A wall as it is now: each facet is a line of the plane, or a flat polygon in space, by its
/// corners in their order [m]. What is round is made of kFacets facets to a full turn; what has no
/// end goes as far as a box does.
/// @param box  around everything that is of interest [m]
template <int Dim>
std::vector<std::vector<Vec<Dim>>> facets_of(const Wall<Dim>& wall,
                                             const Eigen::AlignedBox<double, Dim>& box);

/// What of a convex polygon lies on the side of a plane that its normal points to, or no further
/// behind it than `slack` [m].
/// @param point  on the plane [m]
std::vector<Vec<3>> clipped(const std::vector<Vec<3>>& polygon, const Vec<3>& normal,
                            const Vec<3>& point, double slack = 0);

}  // namespace lagrain
