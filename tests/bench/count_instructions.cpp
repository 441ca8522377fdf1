// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of a settled bed for callgrind, which counts instructions: the same on a busy machine.
//
//   valgrind --tool=callgrind --toggle-collect='*take_steps*'
//   build/release/tests/bench/count_instructions discs
//
// What it "collected", over the grain-steps printed here, is instructions per grain and step.
// Valgrind knows AVX2, not AVX-512: four contacts at once.

#include "beds.hpp"

#include <cstdint>
#include <cstdio>
#include <string_view>

namespace {

using namespace lagrain;
using namespace lagrain::bench;

constexpr int kPoured = 400, kCopies = 5, kSteps = 200;
constexpr double kRadius = 0.02;  // of the largest grain [m]

}  // namespace

/// Callgrind counts what happens within this function, which it knows by its name.
template <class Simulation>
[[gnu::noinline]] void take_steps(Simulation& simulation) {
  simulation.step(kSteps);
}

template <int Dim>
void count_bed() {
  const Bed<Dim> bed =
      tiled<Dim>(pour<Dim>({kPoured, kRadius, Dim == 2 ? 0.7 * kRadius : kRadius, 0.4}, [] {}),
                 Dim == 2 ? std::vector<int>{kCopies} : std::vector<int>{kCopies, 1});
  auto simulation = simulate<Dim, TriangulationNeighbourhood<Dim>>(bed);
  simulation.step();
  take_steps(simulation);
  const ContactStatistics contacts = contact_statistics(simulation);
  std::printf("%lld grain-steps, %.2f contacts and %.2f near pairs per grain\n",
              static_cast<long long>(bed.count()) * kSteps,
              static_cast<double>(contacts.contacts + contacts.wall_contacts) / bed.count(),
              static_cast<double>(simulation.near_count()) / bed.count());
}

int main(int count, char** words) {
  const std::string_view grains = count == 2 ? words[1] : "";
  if (grains == "discs") {
    count_bed<2>();
  } else if (grains == "spheres") {
    count_bed<3>();
  } else {
    std::fprintf(stderr, "usage: count_instructions discs|spheres\n");
    return 2;
  }
}
