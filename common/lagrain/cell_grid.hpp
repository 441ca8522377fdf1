// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `CellGrid` finds near pairs with linked cells, as most codes do.

#include <lagrain/neighbourhood.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace lagrain {

/// A grid of square cells (cubes in space) as wide as the longest reach of any pair, so that every
/// near pair lies in the same or in adjacent cells. Together with the margins of the near list this
/// is a Verlet list.
///
/// One cell size for all: with a wide range of sizes a cell holds many small grains, and the cost
/// grows with the ratio. (Hierarchical grids mend that; this is the usual baseline.)
template <int Dim>
class CellGrid {
 public:
  static const char* name() { return "linked cells"; }  ///< for people

  /// Lists the pairs within reach, as Neighbourhood has it; shrinks no margin.
  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    pairs.clear();
    strayed_.clear();
    const int n = static_cast<int>(radius.size());
    if (n < 2) return;
    sort_into_cells(x, radius, margin);
    // Every pair once: from each cell to what follows in its row, and to the rows that follow.
    Index cell{};
    for (std::size_t c = 0; c + 1 < start_.size(); ++c) {
      if (start_[c] < start_[c + 1]) {
        const int row_end = start_[c + (cell[kLast] + 1 < shape_[kLast] ? 2 : 1)];
        for (int k = start_[c]; k < start_[c + 1]; ++k) list_pairs(k, k + 1, row_end, pairs);
        for_each_row_ahead(cell, [&](int first, int end) {
          for (int k = start_[c]; k < start_[c + 1]; ++k) list_pairs(k, first, end, pairs);
        });
      }
      for (std::size_t d = Dim; d-- > 0;) {  // on to the next cell
        if (++cell[d] < shape_[d]) break;
        cell[d] = 0;
      }
    }
    sort_pairs(pairs, n);
  }

  /// Proposes the members of the cells around a stray, and all that have strayed since the cells
  /// were filled.
  bool pairs_of(std::vector<int>& strays, const PlaceOf<Dim>& place, const Eigen::VectorXd& radius,
                Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    pairs.clear();
    strayed_.insert(strayed_.end(), strays.begin(), strays.end());
    for (const int i : strays) {
      if (2 * (radius[i] + margin[i]) > width_) return false;
      const auto add = [&](int j) {
        if (j != i) pairs.push_back({std::min(i, j), std::max(i, j)});
      };
      for_each_row_around(cell_at(place(i)), [&](int first, int end) {
        for (int k = first; k < end; ++k) add(members_[static_cast<std::size_t>(k)].i);
      });
      for (const int j : strayed_) add(j);
    }
    return true;
  }

 private:
  using Index = std::array<int, Dim>;
  static constexpr std::size_t kLast = Dim - 1;
  /// Cells are widened by kWiden until there are so few. The limit binds only where grains fly far
  /// apart. It was not tuned: half or twice as many empty cells take no time beside the pairs.
  static constexpr double kMostCellsPerGrain = 4, kFewCells = 64, kWiden = 1.5;

  /// A grain in the order of the cells.
  struct Member {
    Vec<Dim> x;
    double reach;
    int i;
  };

  void sort_into_cells(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                       const Eigen::VectorXd& margin) {
    const int n = static_cast<int>(radius.size());
    low_ = x.rowwise().minCoeff();
    const Vec<Dim> extent = x.rowwise().maxCoeff() - low_;
    // A slightly wider cell absorbs the rounding of the division below. A grain that flies far away
    // must not cost an empty cell per grain width.
    width_ = 2 * (radius + margin).maxCoeff() * (1 + 1e-9);
    const auto cells_for = [&](double w) {
      double count = 1;
      for (int d = 0; d < Dim; ++d) count *= std::floor(extent[d] / w) + 1;
      return count;
    };
    while (cells_for(width_) > kMostCellsPerGrain * n + kFewCells) width_ *= kWiden;
    std::size_t count = 1;
    for (int d = 0; d < Dim; ++d) {
      shape_[static_cast<std::size_t>(d)] = static_cast<int>(extent[d] / width_) + 1;
      count *= static_cast<std::size_t>(shape_[static_cast<std::size_t>(d)]);
    }

    start_.assign(count + 1, 0);
    cell_.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      const std::size_t c = flat(cell_at(x.col(i)));
      cell_[static_cast<std::size_t>(i)] = c;
      ++start_[c + 1];
    }
    for (std::size_t c = 0; c < count; ++c) start_[c + 1] += start_[c];
    members_.resize(static_cast<std::size_t>(n));
    next_.assign(start_.begin(), start_.end() - 1);
    for (int i = 0; i < n; ++i) {
      const int k = next_[cell_[static_cast<std::size_t>(i)]]++;
      members_[static_cast<std::size_t>(k)] = {x.col(i), radius[i] + margin[i], i};
    }
  }

  /// The cell that holds a place, or the nearest if none does.
  Index cell_at(const Vec<Dim>& x) const {
    Index index;
    for (int d = 0; d < Dim; ++d) {
      const auto k = static_cast<std::size_t>(d);
      index[k] = static_cast<int>(
          std::clamp((x[d] - low_[d]) / width_, 0.0, static_cast<double>(shape_[k] - 1)));
    }
    return index;
  }

  std::size_t flat(const Index& index) const {
    std::size_t c = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      c = c * static_cast<std::size_t>(shape_[d]) + static_cast<std::size_t>(index[d]);
    }
    return c;
  }

  /// Visits the rows along the last axis that follow a cell's own, as far as they are adjacent to
  /// the cell: f(first, end) of their members, which lie side by side.
  template <class F>
  void for_each_row_ahead(const Index& cell, F&& f) const {
    const auto visit = [&](Index row) {
      for (std::size_t d = 0; d < kLast; ++d) {
        if (row[d] < 0 || row[d] >= shape_[d]) return;
      }
      row[kLast] = std::max(cell[kLast] - 1, 0);
      const int first = start_[flat(row)];
      row[kLast] = std::min(cell[kLast] + 1, shape_[kLast] - 1);
      f(first, start_[flat(row) + 1]);
    };
    Index row = cell;
    if constexpr (Dim == 3) {
      ++row[1];
      visit(row);
      ++row[0];
      visit(row);
      --row[1];
      visit(row);
      --row[1];
      visit(row);
    } else {
      ++row[0];
      visit(row);
    }
  }

  /// Visits the rows of a cell and of the cells around it: f(first, end) of their members.
  template <class F>
  void for_each_row_around(const Index& cell, F&& f) const {
    const auto range = [&](std::size_t d) {
      return std::pair{std::max(cell[d] - 1, 0), std::min(cell[d] + 1, shape_[d] - 1)};
    };
    const std::pair<int, int> ends = range(kLast);
    const auto visit = [&](Index row) {
      row[kLast] = ends.first;
      const int first = start_[flat(row)];
      row[kLast] = ends.second;
      f(first, start_[flat(row) + 1]);
    };
    Index row{};
    const auto [from0, to0] = range(0);
    for (row[0] = from0; row[0] <= to0; ++row[0]) {
      if constexpr (Dim == 3) {
        const auto [from1, to1] = range(1);
        for (row[1] = from1; row[1] <= to1; ++row[1]) visit(row);
      } else {
        visit(row);
      }
    }
  }

  /// Adds the pairs within reach of the member k and the members [first, end).
  void list_pairs(int k, int first, int end, std::vector<Pair>& pairs) const {
    const Member& a = members_[static_cast<std::size_t>(k)];
    for (int other = first; other < end; ++other) {
      const Member& b = members_[static_cast<std::size_t>(other)];
      if (!within_reach<Dim>(a.x, a.reach, b.x, b.reach)) continue;
      pairs.push_back({std::min(a.i, b.i), std::max(a.i, b.i)});
    }
  }

  Vec<Dim> low_ = Vec<Dim>::Zero();  ///< corner of the grid [m]
  double width_ = 0;                 ///< of a cell [m]
  Index shape_{};
  std::vector<std::size_t> cell_;  ///< of each grain
  std::vector<int> start_;         ///< of each cell's members
  std::vector<Member> members_;
  std::vector<int> next_;
  std::vector<int> strayed_;  ///< no longer where members_ have them
};

static_assert(AmendableNeighbourhood<CellGrid<2>, 2> && AmendableNeighbourhood<CellGrid<3>, 3>);

}  // namespace lagrain
