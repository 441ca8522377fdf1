// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `AllPairs` compares every grain with every other: it is the reference that every other
/// neighbourhood is held against.

#include <lagrain/neighbourhood.hpp>

#include <vector>

namespace lagrain {

/// Tests all n (n - 1) / 2 pairs. Cost O(n^2); nothing to get wrong.
template <int Dim>
class AllPairs {
 public:
  static const char* name() { return "all pairs"; }  ///< for people

  /// Lists the pairs within reach, as Neighbourhood has it; shrinks no margin.
  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) const {
    pairs.clear();
    const int n = static_cast<int>(radius.size());
    for (int i = 0; i < n; ++i) {
      for (int j = i + 1; j < n; ++j) {
        if (within_reach<Dim>(x, radius, margin, i, j)) pairs.push_back({i, j});
      }
    }
  }
};

static_assert(Neighbourhood<AllPairs<2>, 2> && Neighbourhood<AllPairs<3>, 3>);

}  // namespace lagrain
