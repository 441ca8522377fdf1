// SPDX-License-Identifier: GPL-3.0-or-later
// A first packing: 300 discs of two sizes fall into a box and come to rest. What there is stands in
// the text of a scene; the program runs it and measures.
// To build it: find_package(lagrain 0.1) and lagrain::scenes, as in CMakeLists.txt.

#include <lagrain/run.hpp>

#include <cmath>
#include <cstdio>

using namespace lagrain;

constexpr const char* kScene = R"(
dimension = 2
duration  = "1.5 s"
gravity   = [0, -9.81]
normal    = "linear"                   # spring and dashpot
friction  = "elastic"                  # a tangential spring up to Coulomb's limit
audit     = true                       # are all contacts found?
law       = { stiffness = "4e6 N/m", restitution = 0.5, friction = 0.4, tangential_damping = 0.2 }

[materials.glass]
density = 2500                         # kg/m^3; discs are 1 m deep

[[fill]]
count       = 300
radius      = { values = ["8 mm", "12 mm"], weights = [1, 1] }
region      = { low = [0, 0], high = [0.4, 0.6] }
arrangement = "random"

[[box]]
low  = [0, 0]
high = [0.4, 0.6]
open = ["top"]
)";

int main() {
  const Scene<2> scene = parse_scene<2>(kScene, "first packing");
  const auto run = make_run(scene);
  run->advance_to(scene.duration);

  const double weight = 9.81 * run->masses().sum();  // [N]
  double carried = 0;                                // by the walls [N]
  for (const Wall<2>& wall : run->walls()) carried -= wall.force.y();
  const ContactStatistics contacts = run->statistics();
  std::printf("%d discs, %.2f contacts each, largest overlap %.2f %% of a radius\n", run->count(),
              contacts.coordination, 100 * contacts.largest_overlap);
  std::printf("of %.1f N the walls carry %.1f N\n", weight, carried);
  std::printf("%lld contacts found by another search, %lld of them missed\n",
              static_cast<long long>(run->audit().contacts()),
              static_cast<long long>(run->audit().missed()));
  const bool at_rest = std::abs(carried / weight - 1) < 0.01;
  return at_rest && contacts.coordination > 3 && run->audit().missed() == 0 ? 0 : 1;
}
