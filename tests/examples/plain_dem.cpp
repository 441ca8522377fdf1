// SPDX-License-Identifier: GPL-3.0-or-later
// The distinct element method as plainly as it can be said: plain_dem.hpp, beside this file, has
// the paper's steps 1 to 5 as functions. Step 6, the loop, is here: discs, then spheres, fall into
// a box and come to rest, and the floor carries their weight.
// To build it: find_package(lagrain 0.1), lagrain::dim2 and lagrain::dim3, as in CMakeLists.txt.

#include "plain_dem.hpp"

#include <lagrain/random.hpp>

#include <cmath>
#include <cstdio>

using namespace lagrain;

/// A box, open at the top, with loose layers of grains; the last axis points up.
template <int Dim>
bool settles(int side, int layers) {
  const double radius = 0.01, pitch = 2.1 * radius, width = side * pitch;  // [m]
  std::vector<Grain<Dim>> list;
  std::vector<Wall<Dim>> walls;
  Random random(1);
  const int floor_count = Dim == 2 ? side : side * side;
  for (int k = 0; k < floor_count * layers; ++k) {
    Vec<Dim> x;
    for (int d = 0, rest = k; d < Dim; ++d, rest /= side) x[d] = (rest % side + 0.5) * pitch;
    x[Dim - 1] = (k / floor_count + 0.5) * pitch;
    for (double& coordinate : x) coordinate += random.uniform(-4e-4, 4e-4);
    list.push_back({.position = x, .radius = radius, .mass = 0.5});
  }
  const Vec<Dim> up = Vec<Dim>::Unit(Dim - 1);
  walls.push_back(Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up));
  for (int d = 0; d + 1 < Dim; ++d) {
    walls.push_back(Wall<Dim>::half_space("low", Vec<Dim>::Zero(), Vec<Dim>::Unit(d)));
    walls.push_back(Wall<Dim>::half_space("high", width * Vec<Dim>::Unit(d), -Vec<Dim>::Unit(d)));
  }

  PlainDem<Dim> dem{.grains = make_grains<Dim, LinearSpring::needs>(list),
                    .law = LinearSpring::with_restitution(1e5, 0.3),  // [N/m], [-]
                    .walls = walls,
                    .gravity = -9.81 * up,  // [m/s^2]
                    .time_step = 2e-4};     // [s]
  dem.construct_triangulation();
  for (int step = 0; step < 10000; ++step) dem.iterate();

  double carried = 0, weight = 9.81 * dem.grains.mass.sum();  // by the floor, of the grains [N]
  std::size_t touching = 0;
  for (const auto& contact : dem.contacts) {
    if (contact.j < 0) carried += contact.force[Dim - 1];
    if (contact.j >= 0) ++touching;
  }
  std::printf("%d grains in %d dimensions after 2 s: %zu contacts along %zu edges of T,\n",
              dem.grains.size(), Dim, touching, dem.triangulation.edges().size());
  std::printf("  fastest %.1e m/s, and the floor carries %.1f of %.1f N\n",
              dem.grains.velocity.colwise().norm().maxCoeff(), carried, weight);
  return std::abs(carried / weight - 1) < 0.01 && dem.triangulation.hidden().empty();
}

int main() { return settles<2>(15, 10) && settles<3>(4, 4) ? 0 : 1; }
