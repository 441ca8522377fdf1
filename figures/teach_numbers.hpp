// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The numbers that stand in the lessons. Each is computed by the library when they are written.

#include <string>
#include <vector>

namespace lagrain::figures {

/// A number of a lesson, in the unit that stands behind it in the text.
/// @throws SceneError for an unknown name
double lesson_number(const std::string& name);

/// The names of all of them.
std::vector<std::string> lesson_numbers();

/// What the bench of flips starts from.
struct FlipStart {
  std::vector<std::vector<double>> sites;   ///< x, y, r of each
  std::vector<std::vector<int>> triangles;  ///< three corners each, counter-clockwise
};

/// A triangulation as far from the regular one as flips lead: no edge that can be flipped is good.
/// @pre the sites do not lie on a line
FlipStart disordered_triangulation(std::vector<std::vector<double>> sites);

/// The fewest flips of bad edges that lead from a triangulation to the regular one. (A good edge
/// that is flipped must be flipped back.)
/// @pre no site is hidden in it
int least_flips(const FlipStart& start);

}  // namespace lagrain::figures
