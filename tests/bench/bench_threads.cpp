// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What threads are worth: one simulation stepped by two threads, against two simulations stepped
/// by one thread each at the same time. That is the fair bar on a machine whose cores share memory
/// and power; both take turns, and the figure is the ratio of medians. Link with benchmark_main.

#include "beds.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <thread>
#include <vector>

namespace {

using namespace lagrain;
using namespace lagrain::bench;

constexpr double kRadius = 0.02;  // [m]
constexpr int kTile = 1000;       // beds are made of copies, side by side
constexpr int kSteps = 50;
constexpr int kRounds = 9;

template <class F>
double seconds(F&& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Argument: thousands of grains.
template <int Dim>
void two_threads(benchmark::State& state) {
  const int copies = static_cast<int>(state.range(0));
  const Bed<Dim> tile =
      pour<Dim>({kTile, kRadius, Dim == 2 ? 0.7 * kRadius : kRadius, Dim == 2 ? 0.6 : 0.4}, [] {});
  const int rows = Dim == 2 ? 1 : 8;
  const Bed<Dim> bed = tiled<Dim>(tile, {copies / rows, rows});
  const int n = bed.count();
  using Sim = BedSimulation<Dim, TriangulationNeighbourhood<Dim>>;
  Sim shared = simulate<Dim, TriangulationNeighbourhood<Dim>>(bed);
  Sim first = simulate<Dim, TriangulationNeighbourhood<Dim>>(bed);
  Sim second = simulate<Dim, TriangulationNeighbourhood<Dim>>(bed);
  shared.use_threads(2);
  std::vector<double> together, alone;
  const auto round = [&](int steps) {
    together.push_back(seconds([&] { shared.step(steps); }));
    alone.push_back(seconds([&] {
      std::thread other([&] { second.step(steps); });
      first.step(steps);
      other.join();
    }));
  };
  round(500);  // the tiles settle, the margins adapt
  together.clear();
  alone.clear();
  for (auto _ : state) {
    for (int k = 0; k < kRounds; ++k) round(kSteps);
  }
  // Two simulations in a time, against one in half of it.
  state.counters["throughput_ratio"] = median(alone) / 2 / median(together);
  state.counters["ns_per_grain_step"] = 1e9 * median(together) / kSteps / n;
  state.counters["same_bits"] = shared.grains().position == first.grains().position;
}

BENCHMARK(two_threads<2>)->Arg(200)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(two_threads<3>)->Arg(64)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
