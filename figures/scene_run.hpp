#pragma once
/// @file
/// Scenes of any neighbourhood, the triangulation included.

#include <lagrain/run.hpp>

#include <memory>

namespace lagrain {

/// Builds the simulation that a scene names; see make_run.
/// @param threads  that share its steps; 0: as many as pay
/// @throws SceneError
template <int Dim>
std::unique_ptr<Run<Dim>> make_scene_run(const Scene<Dim>& scene, int threads = 0);

}  // namespace lagrain
