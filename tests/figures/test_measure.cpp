// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure.hpp"

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace lagrain::bench;

TEST_SUITE("measure") {
  TEST_CASE("the observed order of a power law is its exponent, whatever its factor") {
    const std::vector<double> x{0.1, 0.2, 0.4, 0.8};
    for (const double order : {1.0, 2.0, 4.0, -0.5}) {
      std::vector<double> y;
      for (const double each : x) y.push_back(7 * std::pow(each, order));
      CHECK(lagrain::test::relative_error(observed_order(x, y), order) < 1e-12);
    }
  }

  TEST_CASE("points without a logarithm are left out of the observed order") {
    const std::vector<double> x{0.1, 0.2, 0.4}, y{0.01, 0, 0.16};
    CHECK(lagrain::test::relative_error(observed_order(x, y), 2) < 1e-12);
    CHECK(std::isnan(observed_order(std::vector{1.0}, std::vector{1.0})));
  }

  TEST_CASE("the median is the middle value, and none without values") {
    CHECK(median_of({3, 1, 2}) == 2);
    CHECK(median_of({5}) == 5);
    CHECK(std::isnan(median_of({})));
  }

  TEST_CASE("a call is timed by the processor's clock") {
    int calls = 0;
    const double seconds = seconds_per_call([&] { ++calls; }, 1e-4);
    CHECK(calls > 3);  // three rounds of several calls
    CHECK(seconds > 0);
    CHECK(seconds < 1e-4);
  }
}
