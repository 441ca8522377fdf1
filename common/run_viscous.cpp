#include "simulation_run.hpp"

namespace lagrain::detail {

template <int Dim>
std::unique_ptr<Run<Dim>> make_viscous_run(const Scene<Dim>& scene, Placement<Dim> placement,
                                           AnyNeighbourhood<Dim> neighbourhood) {
  if (scene.normal == NormalModel::hertz) {
    return make_run_with<Dim, ViscousFriction<Hertz>>(scene, std::move(placement),
                                                      std::move(neighbourhood));
  }
  return make_run_with<Dim, ViscousFriction<LinearSpring>>(scene, std::move(placement),
                                                           std::move(neighbourhood));
}

template std::unique_ptr<Run<2>> make_viscous_run<2>(const Scene<2>&, Placement<2>,
                                                     AnyNeighbourhood<2>);
template std::unique_ptr<Run<3>> make_viscous_run<3>(const Scene<3>&, Placement<3>,
                                                     AnyNeighbourhood<3>);

}  // namespace lagrain::detail
