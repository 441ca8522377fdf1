// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure.hpp"

#include <lagrain/scene.hpp>

#include <ctime>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace lagrain::bench {

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median_of(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double seconds_per_call(const std::function<void()>& call, double least) {
  std::vector<double> rounds;
  for (int round = 0; round < 3; ++round) {
    const double start = processor_seconds();
    double spent = 0;
    int calls = 0;
    do {
      call();
      ++calls;
      spent = processor_seconds() - start;
    } while (spent < least);
    rounds.push_back(spent / calls);
  }
  return median_of(rounds);
}

double observed_order(std::span<const double> x, std::span<const double> y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!(x[k] > 0 && y[k] > 0)) continue;
    const double lx = std::log(x[k]), ly = std::log(y[k]);
    n += 1;
    sx += lx;
    sy += ly;
    sxx += lx * lx;
    sxy += lx * ly;
  }
  return n < 2 ? std::numeric_limits<double>::quiet_NaN()
               : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace lagrain::bench
