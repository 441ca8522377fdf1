#include "scene_run.hpp"

#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

namespace lagrain {

template <int Dim>
std::unique_ptr<Run<Dim>> make_scene_run(const Scene<Dim>& scene) {
  if (scene.neighbourhood != NeighbourhoodModel::triangulation) return make_run(scene);
  return make_run(scene, AnyNeighbourhood<Dim>(TriangulationNeighbourhood<Dim>{}));
}

template std::unique_ptr<Run<2>> make_scene_run<2>(const Scene<2>&);
template std::unique_ptr<Run<3>> make_scene_run<3>(const Scene<3>&);

}  // namespace lagrain
