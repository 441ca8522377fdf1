// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/spatial_order.hpp>

#include <support/scenes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// The cells of a full grid by their index along the curve.
template <int Dim>
std::vector<std::array<std::uint32_t, Dim>> walk(int bits) {
  const std::uint32_t side = 1u << bits;
  std::uint32_t count = 1;
  for (int d = 0; d < Dim; ++d) count *= side;
  std::vector<std::array<std::uint32_t, Dim>> at(count);
  std::vector<int> visits(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    std::array<std::uint32_t, Dim> cell;
    std::uint32_t rest = k;
    for (auto& c : cell) {
      c = rest % side;
      rest /= side;
    }
    const auto index = static_cast<std::size_t>(hilbert_index<Dim>(cell, bits));
    at.at(index) = cell;
    ++visits.at(index);
  }
  CHECK(std::all_of(visits.begin(), visits.end(), [](int v) { return v == 1; }));
  return at;
}

template <int Dim>
void check_unit_steps(int bits) {
  const auto at = walk<Dim>(bits);
  int wrong = 0;
  for (std::size_t k = 1; k < at.size(); ++k) {
    int length = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      length += std::abs(static_cast<int>(at[k][d]) - static_cast<int>(at[k - 1][d]));
    }
    wrong += length != 1;
  }
  CHECK(wrong == 0);
}

}  // namespace

TEST_SUITE("spatial_order") {
  TEST_CASE("Hilbert's curve visits every cell once, in steps to a neighbour") {
    for (const int bits : {1, 2, 5}) check_unit_steps<2>(bits);
    for (const int bits : {1, 2, 4}) check_unit_steps<3>(bits);
  }

  TEST_CASE_TEMPLATE("the order holds every point once, and its way is short", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    Random random(1);
    constexpr int kCount = 4096;
    Columns<Dim> x(Dim, kCount);
    for (int i = 0; i < kCount; ++i) {
      for (int d = 0; d < Dim; ++d) x(d, i) = random.uniform(-3, 5);
    }
    const std::vector<int> order = spatial_order<Dim>(x);

    std::vector<int> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    std::vector<int> all(kCount);
    std::iota(all.begin(), all.end(), 0);
    CHECK(sorted == all);
    double length = 0;
    for (std::size_t k = 1; k < order.size(); ++k) {
      length += (x.col(order[k]) - x.col(order[k - 1])).norm();
    }
    // About the mean distance between neighbours each; at random it would be half of the box.
    CHECK(length / kCount < 2 * 8 / std::pow(kCount, 1.0 / Dim));
  }

  TEST_CASE("points on one place keep the order of their numbers; so do one point and none") {
    CHECK(spatial_order<2>(Columns<2>::Constant(2, 4, 1.5)) == std::vector<int>{0, 1, 2, 3});
    CHECK(spatial_order<3>(Columns<3>::Zero(3, 1)) == std::vector<int>{0});
    CHECK(spatial_order<3>(Columns<3>(3, 0)).empty());
  }
}
