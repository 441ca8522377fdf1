// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of this folder: stress and solid fraction of a scene's regions, and what
/// flows through its planes.

#include <lagrain/frame.hpp>

#include <vector>

namespace lagrain::detail {

/// Adds the columns of all regions, for each slice its solid fraction and the parts of its stress,
/// and of all planes: mass and number of what has passed.
template <int Dim>
void add_measure_columns(const Scene<Dim>& scene, std::vector<SeriesColumn>& columns);

/// Adds their values at this instant.
///
/// Stress [Pa] is Love's and Weber's sum over the contacts whose points lie in the region,
///
///     sigma = 1/V sum of f b^T, made symmetric,
///
/// with f the force on a grain and b the way to its centre from the partner's, or from the foot on
/// a wall: pressure is positive. V is the region's volume, in the plane its area times the depth of
/// the discs. (Bagi, Mechanics of Materials 22 (1996) 165, has the sum and its limits.)
///
/// The solid fraction counts the part of each grain that lies in the region: exactly for discs; for
/// spheres that its faces cut, to about 1e-3 of a sphere. Overlaps count twice.
template <int Dim>
void add_measures(const Run<Dim>& run, Sample& row);

/// Area [m^2] of the part of a disc that lies in a rectangle.
double area_within(const Vec<2>& centre, double radius, const Vec<2>& low, const Vec<2>& high);

/// Volume [m^3] of the part of a sphere that lies in a box, to about 1e-3 of the sphere.
double volume_within(const Vec<3>& centre, double radius, const Vec<3>& low, const Vec<3>& high);

}  // namespace lagrain::detail
