// SPDX-License-Identifier: GPL-3.0-or-later
#include "turns.hpp"

#include <lagrain/cell_grid.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <cstddef>

namespace lagrain::bench {

template <int Dim>
void examine(const Bed<Dim>& bed, const Columns<Dim>& x, const Columns<Dim>& v, RunErrors& errors) {
  const int n = bed.count();
  Eigen::VectorXd radius(n), no_margin = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) radius[i] = bed.grains[static_cast<std::size_t>(i)].radius;
  std::vector<Pair> touching;
  if (radius.maxCoeff() < 8 * radius.minCoeff()) {
    CellGrid<Dim>{}.near_pairs(x, radius, no_margin, touching);
  } else {
    TriangulationNeighbourhood<Dim>{}.near_pairs(x, radius, no_margin, touching);
  }
  double sum = 0, deepest = 0, load = 0, weight = 0, kinetic = 0;
  for (const auto& [i, j] : touching) {
    const double overlap =
        (radius[i] + radius[j] - (x.col(i) - x.col(j)).norm()) / std::min(radius[i], radius[j]);
    sum += overlap;
    deepest = std::max(deepest, overlap);
  }
  for (int i = 0; i < n; ++i) {
    const double mass = bed.grains[static_cast<std::size_t>(i)].mass;
    load += bed.law.normal.stiffness * std::max(0.0, radius[i] - x(Dim - 1, i));
    weight += mass * kGravity;
    kinetic += 0.5 * mass * v.col(i).squaredNorm();
  }
  const auto contacts = static_cast<double>(touching.size());
  errors.contacts_per_grain = contacts / n;
  errors.mean_overlap = contacts > 0 ? sum / contacts : 0;
  errors.largest_overlap = deepest;
  if (!bed.walls.front().moves()) errors.floor_load = load / weight;
  errors.kinetic = kinetic;
}
template void examine<2>(const Bed<2>&, const Columns<2>&, const Columns<2>&, RunErrors&);
template void examine<3>(const Bed<3>&, const Columns<3>&, const Columns<3>&, RunErrors&);

std::vector<Phase> per_grain_step(const std::vector<Phase>& spent, double wall, double cpu,
                                  double grain_steps) {
  std::vector<Phase> phases;
  double rest = 1;
  for (const Phase& phase : spent) {
    const double share = 1e-9 * phase.ns / wall;
    phases.push_back({phase.name, 1e9 * share * cpu / grain_steps});
    rest -= share;
  }
  phases.push_back({"rest of the step", 1e9 * rest * cpu / grain_steps});
  return phases;
}

}  // namespace lagrain::bench
