// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation_run.hpp"

namespace lagrain::detail {

template std::unique_ptr<Run<2>> make_run_with<2, RollingFriction>(const Scene<2>&, Placement<2>,
                                                                   AnyNeighbourhood<2>);
template std::unique_ptr<Run<3>> make_run_with<3, RollingFriction>(const Scene<3>&, Placement<3>,
                                                                   AnyNeighbourhood<3>);

}  // namespace lagrain::detail
