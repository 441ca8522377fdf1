// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// An order of points in which neighbours in space are neighbours in memory.

#include <lagrain/vec.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace lagrain {

/// Place of a cell along Hilbert's curve through a grid of 2^bits cells per axis.
///
/// Source: Skilling, AIP Conf. Proc. 707 (2004) 381: undo the excess turns from the finest level to
/// the coarsest, Gray-decode, and interleave the bits.
template <int Dim>
std::uint64_t hilbert_index(std::array<std::uint32_t, Dim> cell, int bits) {
  for (std::uint32_t level = 1u << (bits - 1); level > 1; level >>= 1) {
    const std::uint32_t below = level - 1;
    for (std::uint32_t& axis : cell) {
      if (axis & level) {
        cell[0] ^= below;  // invert
      } else {
        const std::uint32_t swapped = (cell[0] ^ axis) & below;
        cell[0] ^= swapped;
        axis ^= swapped;
      }
    }
  }
  for (std::size_t k = 1; k < Dim; ++k) cell[k] ^= cell[k - 1];
  std::uint32_t turn = 0;
  for (std::uint32_t level = 1u << (bits - 1); level > 1; level >>= 1) {
    if (cell[Dim - 1] & level) turn ^= level - 1;
  }
  std::uint64_t index = 0;
  for (int bit = bits - 1; bit >= 0; --bit) {
    for (std::size_t k = 0; k < Dim; ++k) index = index << 1 | ((cell[k] ^ turn) >> bit & 1u);
  }
  return index;
}

/// The columns of x in the order of Hilbert's curve; equal places in the order of their numbers.
/// @pre x is finite
template <int Dim>
std::vector<int> spatial_order(const Columns<Dim>& x) {
  constexpr int kBits = Dim == 2 ? 20 : 16;
  const auto n = static_cast<std::size_t>(x.cols());
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  if (n < 2) return order;
  const Vec<Dim> low = x.rowwise().minCoeff();
  const double extent = (x.rowwise().maxCoeff() - low).maxCoeff();
  if (!(extent > 0)) return order;
  const double scale = ((1 << kBits) - 1) / extent;
  std::vector<std::pair<std::uint64_t, int>> keys(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<std::uint32_t, Dim> cell;
    for (std::size_t k = 0; k < Dim; ++k) {
      const auto row = static_cast<Eigen::Index>(k), column = static_cast<Eigen::Index>(i);
      cell[k] = static_cast<std::uint32_t>((x(row, column) - low[row]) * scale);
    }
    keys[i] = {hilbert_index<Dim>(cell, kBits), static_cast<int>(i)};
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < n; ++i) order[i] = keys[i].second;
  return order;
}

}  // namespace lagrain
