// SPDX-License-Identifier: GPL-3.0-or-later
// What a step costs, and what it is worth: discs and spheres, settled and shaken, with the
// triangulation and with linked cells. Every time stands beside the errors of the same run.

#include "beds.hpp"

#include <lagrain/audit.hpp>
#include <lagrain/cell_grid.hpp>

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <type_traits>

namespace {

using namespace lagrain;
using namespace lagrain::bench;

constexpr int kStepsPerSample = 100;
constexpr int kSamples = 20;
constexpr int kTile = 1000;       // larger beds are made of copies, side by side
constexpr double kRadius = 0.02;  // of the largest grain, or of the small ones of a mixture [m]

/// Discs have radii from 0.7 to 1 times the largest, spheres are equal; or one in a thousand is
/// five times as large.
enum class Sizes { like, mixed };

/// @pre n is 1, 10 or 100 times kTile
template <int Dim>
Bed<Dim> make_bed(int n, Sizes sizes, bool shaken) {
  static std::map<int, Bed<Dim>> tiles;
  if (tiles.empty()) {
    tiles[kTile] = pour<Dim>(
        {kTile, kRadius, Dim == 2 ? 0.7 * kRadius : kRadius, Dim == 2 ? 0.6 : 0.4}, [] {});
  }
  const int copies = n / kTile;
  const int rows = Dim == 2 || copies == 1 ? 1 : copies == 10 ? 2 : 10;
  Bed<Dim> bed = tiled<Dim>(tiles[kTile], {copies / rows, rows});
  if (sizes == Sizes::mixed) put_large_grains<Dim>(bed, 5 * kRadius, copies, [] {});
  if (shaken) shake<Dim>(bed, kRadius, [] {});
  return bed;
}

template <int Dim, class N>
constexpr bool kIsTriangulation = std::is_same_v<N, TriangulationNeighbourhood<Dim>>;

template <int Dim>
std::int64_t edge_count(const Triangulation<Dim>& t) {
  std::int64_t edges = 0;
  t.for_each_edge([&](int, int) { ++edges; });
  return edges;
}

template <int Dim, class N>
void step(benchmark::State& state, Sizes sizes, bool shaken) {
  const int n = static_cast<int>(state.range(0));
  auto bed = simulate<Dim, N>(make_bed<Dim>(n, sizes, shaken));
  bed.step(500);  // margins adapt

  ContactAudit<Dim> audit;
  const Ledger start = energy_ledger(bed);
  const std::int64_t first_step = bed.steps();
  const std::int64_t first_refresh = bed.refreshes();
  const double before = bed.neighbourhood_seconds();
  TriangulationCost cost_before;
  if constexpr (kIsTriangulation<Dim, N>) cost_before = bed.neighbourhood().cost();
  double seconds = 0;
  double near_pairs = 0;
  double contacts = 0;
  double deepest = 0;
  int samples = 0;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    bed.step(kStepsPerSample);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    state.PauseTiming();
    audit.check(bed.grains().position, bed.grains().radius, bed.near_pairs());
    const ContactStatistics statistics = contact_statistics(bed);
    near_pairs += static_cast<double>(bed.near_count());
    contacts += static_cast<double>(statistics.contacts);
    deepest = std::max(deepest, statistics.largest_overlap);
    ++samples;
    state.ResumeTiming();
  }
  const auto steps = static_cast<double>(bed.steps() - first_step);
  const double grains = bed.grains().size();  // fewer than n where large ones took their place
  const Ledger now = energy_ledger(bed);

  auto& counters = state.counters;
  counters["ns_per_grain_step"] = 1e9 * seconds / steps / grains;
  counters["neighbourhood_%"] = 100 * (bed.neighbourhood_seconds() - before) / seconds;
  counters["contacts_per_grain"] = contacts / samples / grains;
  counters["near_per_contact"] = near_pairs / contacts;
  counters["refreshes_per_1000"] =
      1000 * static_cast<double>(bed.refreshes() - first_refresh) / steps;
  if constexpr (kIsTriangulation<Dim, N>) {
    const TriangulationCost& cost = bed.neighbourhood().cost();
    counters["edges_per_contact"] =
        static_cast<double>(edge_count(bed.neighbourhood().triangulation())) * samples / contacts;
    counters["updates_per_1000"] =
        1000 * static_cast<double>(cost.updates - cost_before.updates) / steps;
    counters["rebuilds"] = static_cast<double>(cost.ladder.rebuilds);
  }
  counters["bytes_per_grain"] = static_cast<double>(bytes_per_grain<Dim, Law::needs>());
  counters["missed"] = static_cast<double>(audit.missed());
  counters["audited"] = static_cast<double>(audit.contacts());
  counters["largest_overlap_%"] = 100 * deepest;
  const double turnover =
      std::max({now.kinetic + now.elastic,
                now.dashpot + now.friction - start.dashpot - start.friction, 1e-300});
  counters["energy_residual_%"] = 100 * residual(now, start) / turnover;
}

template <int Dim>
void add(const char* name, Sizes sizes, bool shaken) {
  const auto add_one = [&](const char* neighbourhood, auto body) {
    const std::string title =
        std::to_string(Dim) + "D " + name + (shaken ? " shaken " : " settled ");
    benchmark::RegisterBenchmark((title + neighbourhood).c_str(), body)
        ->Arg(1000)
        ->Arg(10000)
        ->Arg(100000)
        ->Unit(benchmark::kMillisecond)
        ->Iterations(kSamples);
  };
  add_one("triangulation", [=](benchmark::State& state) {
    step<Dim, TriangulationNeighbourhood<Dim>>(state, sizes, shaken);
  });
  add_one("cells",
          [=](benchmark::State& state) { step<Dim, CellGrid<Dim>>(state, sizes, shaken); });
}

const bool kAdded = [] {
  for (const bool shaken : {false, true}) {
    add<2>("alike", Sizes::like, shaken);
    add<3>("equal", Sizes::like, shaken);
    add<3>("1:5", Sizes::mixed, shaken);
  }
  return true;
}();

}  // namespace
