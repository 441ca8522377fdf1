// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of this folder: walls as lines and polygons that can be shown.

#include <lagrain/vec.hpp>
#include <lagrain/walls.hpp>

#include <Eigen/Geometry>

#include <vector>

namespace lagrain::detail {

/// A wall as it is now: each facet is a line of the plane, or a flat polygon in space, by its
/// corners in their order [m]. What is round is made of kFacets facets to a full turn; what has no
/// end goes as far as a box does.
/// @param box  around everything that is of interest [m]
template <int Dim>
std::vector<std::vector<Vec<Dim>>> facets_of(const Wall<Dim>& wall,
                                             const Eigen::AlignedBox<double, Dim>& box);

/// Facets to a full turn: flat to 0.14 % of the radius.
inline constexpr int kFacets = 60;

}  // namespace lagrain::detail
