// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What an update of the triangulation costs against building it anew, in the plane and in space.
///
/// Build and update alternate inside one benchmark, so that a busy machine slows both; the ratio is
/// that of their medians. Link with benchmark_main.

#include <lagrain/random.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <benchmark/benchmark.h>

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace {

using namespace lagrain;

template <int Dim>
struct Sites {
  Columns<Dim> x;
  Eigen::VectorXd w;
};

/// Disjoint grains of radius 0.35 to 0.5 on a jittered lattice, row by row.
template <int Dim>
Sites<Dim> jittered(Random& random, int count) {
  const int side = static_cast<int>(std::ceil(std::pow(count, 1.0 / Dim)));
  Sites<Dim> sites{Columns<Dim>(Dim, count), Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    int rest = i;
    for (int axis = 0; axis < Dim; ++axis, rest /= side) {
      sites.x(axis, i) = 1.2 * (rest % side) + random.uniform(-0.3, 0.3);
    }
    const double r = random.uniform(0.35, 0.5);
    sites.w[i] = r * r;
  }
  return sites;
}

template <int Dim>
Vec<Dim> direction(Random& random) {
  Vec<Dim> v;
  for (int axis = 0; axis < Dim; ++axis) v[axis] = random.normal();
  return v.normalized();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Processor time of this thread [s]; a shared machine takes the wall clock's time away.
double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class F>
double seconds(F&& f) {
  const double start = now();
  f();
  return now() - start;
}

/// Arguments: number of grains, per cent of them that move, displacement in thousandths of r = 0.5.
template <int Dim>
void update_against_build(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  const double fraction = static_cast<double>(state.range(1)) / 100;
  const double step = static_cast<double>(state.range(2)) / 1000 * 0.5;
  Random random(1);
  Sites<Dim> sites = jittered<Dim>(random, count);
  Triangulation<Dim> updated, built;
  updated.build(sites.x, sites.w);
  UpdateReport total;
  std::vector<double> update_times, build_times;
  double moved_sites = 0;
  std::vector<int> moved;

  for (auto _ : state) {
    moved.clear();
    for (int i = 0; i < count; ++i) {
      if (random.uniform() >= fraction) continue;
      sites.x.col(i) += step * direction<Dim>(random);
      moved.push_back(i);
    }
    update_times.push_back(seconds([&] { total += updated.move(moved, sites.x, sites.w); }));
    build_times.push_back(seconds([&] { built.build(sites.x, sites.w); }));
    moved_sites += static_cast<double>(moved.size());
    state.SetIterationTime(update_times.back());
  }

  const double updates = static_cast<double>(update_times.size());
  const auto per_update = [&](std::int64_t value) { return static_cast<double>(value) / updates; };
  state.counters["rebuild_over_update"] = median(build_times) / median(update_times);
  state.counters["ns_per_moved"] =
      1e9 * median(update_times) / std::max(1.0, moved_sites / updates);
  state.counters["ns_per_built"] = 1e9 * median(build_times) / count;
  state.counters["flips"] = per_update(total.flips);
  state.counters["extracted"] = per_update(total.extracted);
  state.counters["unstuck"] = per_update(total.unstuck);
  state.counters["rebuilds"] = per_update(total.rebuilds);
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"n", "percent", "milliradii"})
      ->ArgsProduct({{1000, 10000, 100000}, {1, 10, 100}, {10, 50, 170}})
      ->UseManualTime()
      ->Unit(benchmark::kMicrosecond)
      ->Iterations(15);
}
BENCHMARK(update_against_build<2>)->Apply(sizes);
BENCHMARK(update_against_build<3>)->Apply(sizes);

}  // namespace
