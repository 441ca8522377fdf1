// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of this folder: grains from a file of comma-separated values.

#include <lagrain/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lagrain::detail {

/// The grains of a file, and where each stands in it.
template <int Dim>
struct ListedGrains {
  std::vector<PlacedGrain<Dim>> grains;  ///< N
  std::vector<std::int64_t> lines;       ///< N: from 1
};

/// Reads a file of grains of a scene.
/// @param index  of the file among scene.grain_files
/// @throws SceneError with file, line, column, what was expected and what was found
template <int Dim>
ListedGrains<Dim> read_grains(const Scene<Dim>& scene, std::size_t index);

}  // namespace lagrain::detail
