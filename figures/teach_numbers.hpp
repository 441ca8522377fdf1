// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The numbers that stand in the lessons: each is computed, by the library, whenever they are
/// written.

#include <string>
#include <vector>

namespace lagrain::figures {

/// A number of a lesson, in the unit that stands behind it in the text.
/// @throws SceneError for an unknown name
double lesson_number(const std::string& name);

/// The names of all of them.
std::vector<std::string> lesson_numbers();

/// A triangulation of discs of the plane as three corners each, counter-clockwise, and the heights
/// of its sites. What the bench of flips starts from: the triangles follow the hull of the sites
/// as a fan, whatever the weights.
struct FlipStart {
  std::vector<std::vector<double>> sites;   ///< x, y, r of each
  std::vector<std::vector<int>> triangles;  ///< none of T's, as far as that is possible
};

/// Triangles that are all but regular: sites are put in one by one from left to right, and each is
/// joined to what it sees of the hull.
FlipStart sweep_triangulation(std::vector<std::vector<double>> sites);

/// The fewest flips that lead from a triangulation to the regular one.
/// @pre no site is hidden in it
int least_flips(const FlipStart& start);

}  // namespace lagrain::figures
