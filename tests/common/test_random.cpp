// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/random.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace lagrain;

TEST_SUITE("random") {
  TEST_CASE("a seed gives the same numbers on every platform") {
    Random random(5489);
    double last = 0;
    for (int k = 0; k < 10000; ++k) last = random.uniform();

    // The standard fixes the 10,000th output of mt19937_64 seeded with 5489.
    CHECK(last == static_cast<double>(9981545732273789042U >> 11) * 0x1p-53);
    // Golden: the normal uses log and cos, which may differ in the last bit between libraries.
    CHECK(test::relative_error(random.normal(), -1.5388312901428864) < 1e-14);
    CHECK(random.below(1000) == 251);
  }

  TEST_CASE("uniform and normal numbers have their moments") {
    Random random(3);
    constexpr int n = 200000;
    std::array<double, 2> uniform{};
    std::array<double, 4> normal{};
    for (int k = 0; k < n; ++k) {
      const double u = random.uniform();
      REQUIRE(u >= 0);
      REQUIRE(u < 1);
      uniform[0] += u / n;
      uniform[1] += u * u / n;
      const double z = random.normal();
      for (std::size_t p = 0; p < 4; ++p) normal[p] += std::pow(z, p + 1) / n;
    }

    // Four standard errors of each mean: sqrt(var / n), with var(u) = 1/12, var(u^2) = 4/45 and
    // var(z^p) = 1, 2, 15, 96.
    const double root = 4 / std::sqrt(n);
    CHECK(std::abs(uniform[0] - 1.0 / 2) < root * std::sqrt(1.0 / 12));
    CHECK(std::abs(uniform[1] - 1.0 / 3) < root * std::sqrt(4.0 / 45));
    CHECK(std::abs(normal[0]) < root);
    CHECK(std::abs(normal[1] - 1) < root * std::sqrt(2.0));
    CHECK(std::abs(normal[2]) < root * std::sqrt(15.0));
    CHECK(std::abs(normal[3] - 3) < root * std::sqrt(96.0));
  }

  TEST_CASE("integers below a count are equally likely") {
    Random random(4);
    constexpr int n = 70000;
    std::array<int, 7> seen{};
    for (int k = 0; k < n; ++k) ++seen.at(static_cast<std::size_t>(random.below(7)));

    // Binomial: standard deviation sqrt(n p (1 - p)) = 93; four of them.
    for (const int count : seen) CHECK(std::abs(count - n / 7) < 4 * 93);
  }
}
