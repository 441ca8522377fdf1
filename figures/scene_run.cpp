#include "scene_run.hpp"

#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

namespace lagrain {

template <int Dim>
std::unique_ptr<Run<Dim>> make_scene_run(const Scene<Dim>& scene, int threads) {
  auto run = scene.neighbourhood == NeighbourhoodModel::triangulation
                 ? make_run(scene, AnyNeighbourhood<Dim>(TriangulationNeighbourhood<Dim>{}))
                 : make_run(scene);
  run->use_threads(threads > 0 ? threads : threads_that_pay(run->count()));
  return run;
}

template std::unique_ptr<Run<2>> make_scene_run<2>(const Scene<2>&, int);
template std::unique_ptr<Run<3>> make_scene_run<3>(const Scene<3>&, int);

}  // namespace lagrain
