// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of scenes: the state of another run, as far as a scene can start from it.

#include <lagrain/placement.hpp>
#include <lagrain/scene.hpp>

#include <string>
#include <vector>

namespace lagrain::detail {

/// What a scene takes from the run that it starts from.
template <int Dim>
struct Start {
  std::vector<PlacedGrain<Dim>> grains;  ///< in the order of their ids
  std::vector<int> ids;                  ///< of these in that run
  std::vector<Wall<Dim>> walls;          ///< those of the scene, its pistons where they stood
  RecalledContacts recalled;             ///< by place among the grains
  std::string origin;                    ///< all this in words
};

/// Reads the state that a scene starts from.
/// @pre scene.start
/// @throws SceneError if there is no such state, or the scene cannot start from it
template <int Dim>
Start<Dim> read_start(const Scene<Dim>& scene);

/// The checkpoint that a scene starts from, as the bytes of its file.
/// @throws SceneError if there is none
std::string start_bytes(const StartState& start);

}  // namespace lagrain::detail
