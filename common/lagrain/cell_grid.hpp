#pragma once
/// @file
/// Linked cells: what most codes use.

#include <lagrain/neighbourhood.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lagrain {

/// Square cells as wide as the longest reach of any pair, so that every near pair lies in the same
/// or in adjacent cells. Together with the margins of the near list this is a Verlet list.
///
/// One cell size for all: with a wide range of sizes a cell holds many small grains, and the cost
/// grows with the ratio. (Hierarchical grids mend that; this is the usual baseline.)
template <int Dim>
class CellGrid {
 public:
  static const char* name() { return "linked cells"; }

  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    pairs.clear();
    const int n = static_cast<int>(radius.size());
    if (n < 2) return;
    sort_into_cells(x, radius, margin);
    for (int i = 0; i < n; ++i) {
      const std::size_t first = pairs.size();
      for_each_in_reach(i, [&](int j) {
        if (j > i && within_reach<Dim>(x, radius, margin, i, j)) pairs.push_back({i, j});
      });
      std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end());
    }
  }

 private:
  using Index = std::array<int, Dim>;

  void sort_into_cells(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                       const Eigen::VectorXd& margin) {
    const int n = static_cast<int>(radius.size());
    const Vec<Dim> low = x.rowwise().minCoeff();
    const Vec<Dim> extent = x.rowwise().maxCoeff() - low;
    // A slightly wider cell absorbs the rounding of the division below. A grain that flies far away
    // must not cost an empty cell per grain width: at most about four cells per grain.
    double width = 2 * (radius + margin).maxCoeff() * (1 + 1e-9);
    const auto cells_for = [&](double w) {
      double count = 1;
      for (int d = 0; d < Dim; ++d) count *= std::floor(extent[d] / w) + 1;
      return count;
    };
    while (cells_for(width) > 4.0 * n + 64) width *= 1.5;
    std::size_t count = 1;
    for (int d = 0; d < Dim; ++d) {
      shape_[static_cast<std::size_t>(d)] = static_cast<int>(extent[d] / width) + 1;
      count *= static_cast<std::size_t>(shape_[static_cast<std::size_t>(d)]);
    }

    start_.assign(count + 1, 0);
    cell_.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      Index index;
      for (int d = 0; d < Dim; ++d) {
        const auto k = static_cast<std::size_t>(d);
        index[k] = std::min(static_cast<int>((x(d, i) - low[d]) / width), shape_[k] - 1);
      }
      cell_[static_cast<std::size_t>(i)] = index;
      ++start_[flat(index) + 1];
    }
    for (std::size_t c = 0; c < count; ++c) start_[c + 1] += start_[c];
    member_.resize(static_cast<std::size_t>(n));
    std::vector<int>& next = scratch_;
    next.assign(start_.begin(), start_.end() - 1);
    for (int i = 0; i < n; ++i) {
      const std::size_t c = flat(cell_[static_cast<std::size_t>(i)]);
      member_[static_cast<std::size_t>(next[c]++)] = i;
    }
  }

  std::size_t flat(const Index& index) const {
    std::size_t c = 0;
    for (std::size_t d = 0; d < Dim; ++d) {
      c = c * static_cast<std::size_t>(shape_[d]) + static_cast<std::size_t>(index[d]);
    }
    return c;
  }

  template <class F>
  void for_each_in_reach(int i, F&& visit) const {
    const Index& home = cell_[static_cast<std::size_t>(i)];
    Index offset;
    offset.fill(-1);
    for (bool more = true; more;) {
      Index index;
      bool inside = true;
      for (std::size_t d = 0; d < Dim; ++d) {
        index[d] = home[d] + offset[d];
        inside = inside && index[d] >= 0 && index[d] < shape_[d];
      }
      if (inside) {
        const std::size_t c = flat(index);
        for (int k = start_[c]; k < start_[c + 1]; ++k) visit(member_[static_cast<std::size_t>(k)]);
      }
      more = false;  // count on in base 3
      for (std::size_t d = 0; d < Dim && !more; ++d) {
        more = offset[d] < 1;
        offset[d] = more ? offset[d] + 1 : -1;
      }
    }
  }

  Index shape_{};
  std::vector<Index> cell_;
  std::vector<int> start_;
  std::vector<int> member_;
  std::vector<int> scratch_;
};

static_assert(Neighbourhood<CellGrid<2>, 2> && Neighbourhood<CellGrid<3>, 3>);

}  // namespace lagrain
