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

double slope_of(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    mean_x += x[k] / n;
    mean_y += y[k] / n;
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xy += (x[k] - mean_x) * (y[k] - mean_y);
  }
  return x.size() < 2 ? std::numeric_limits<double>::quiet_NaN() : xy / xx;
}

double observed_order(std::span<const double> x, std::span<const double> y) {
  std::vector<double> log_x, log_y;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!(x[k] > 0 && y[k] > 0)) continue;
    log_x.push_back(std::log(x[k]));
    log_y.push_back(std::log(y[k]));
  }
  return slope_of(log_x, log_y);
}

}  // namespace lagrain::bench
