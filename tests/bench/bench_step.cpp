// What a step costs, and what it is worth: discs and spheres, settled and shaken, with the
// triangulation and with linked cells. Every time stands beside the errors of the same run.

#include "beds.hpp"

#include <lagrain/audit.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <type_traits>

namespace {

using namespace lagrain;
using namespace lagrain::bench;

constexpr int kStepsPerSample = 100;
constexpr int kSettledSamples = 20;

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
  Bed<Dim, N> bed = make_bed<Dim, N>(n, sizes, shaken);
  // Let the tiles settle and the margins adapt, or the shaken bed begin to move.
  for (int s = 0; s < 2000; ++s) bed.step();

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
    for (int s = 0; s < kStepsPerSample; ++s) bed.step();
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
  const Ledger now = energy_ledger(bed);

  auto& counters = state.counters;
  counters["ns_per_grain_step"] = 1e9 * seconds / steps / n;
  counters["neighbourhood_%"] = 100 * (bed.neighbourhood_seconds() - before) / seconds;
  counters["contacts_per_grain"] = contacts / samples / n;
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
        // Shaken beds for one period.
        ->Iterations(shaken ? steps_per_shake<Dim>(sizes) / kStepsPerSample : kSettledSamples);
  };
  add_one("triangulation", [=](benchmark::State& state) {
    step<Dim, TriangulationNeighbourhood<Dim>>(state, sizes, shaken);
  });
  add_one("cells",
          [=](benchmark::State& state) { step<Dim, CellGrid<Dim>>(state, sizes, shaken); });
}

const bool kAdded = [] {
  for (const bool shaken : {false, true}) {
    add<2>("spread", Sizes::spread, shaken);
    add<3>("equal", Sizes::equal, shaken);
    add<3>("1:10", Sizes::mixed, shaken);
  }
  return true;
}();

}  // namespace
