// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the scene reader: surfaces from STL files.

#include <lagrain/walls.hpp>

#include <filesystem>
#include <vector>

namespace lagrain::detail {

/// The facets of an STL file, binary or text, as plates. Facets without an area are left out: they
/// are no more than edges of others.
/// @param scale  metres in a unit of the file
/// @throws std::invalid_argument if the file cannot be read, is no STL, or holds no facet or a
///         place that is not finite
std::vector<WallPiece<3>> read_stl(const std::filesystem::path& file, double scale);

}  // namespace lagrain::detail
