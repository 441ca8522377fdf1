// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What the tests ask of the painter of scenes beyond its pictures. Private to render.

#include <lagrain/scene3.hpp>

#include <vector>

namespace lagrain::detail {

/// Distance before the eye, along the line of sight, of what is seen through the middle of each
/// pixel [m]; rows from top to bottom, infinity where there is nothing. Floor and panes are
/// left out.
std::vector<double> depths(const Scene3& scene, int width, int height);

}  // namespace lagrain::detail
