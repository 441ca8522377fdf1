// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Finds contacts from nothing: what near lists are audited with.

#include <lagrain/all_pairs.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/neighbourhood.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lagrain {

/// Finds all pairs of grains that touch: by brute force up to 200 grains, with a fresh grid above.
/// The grid is made for the grains of ordinary size; the few that are much larger would make its
/// cells far too wide, so they are held against all others.
template <int Dim>
class ContactSearch {
 public:
  /// Up to so many grains the search is brute force, in which there is nothing to get wrong. It was
  /// not tuned: only audits of small scenes take longer if it is twice as large.
  static constexpr int kBruteForceLimit = 200;

  /// The pairs that touch, sorted; good until the next call.
  /// @param x       centres [m]
  /// @param radius  radii [m], with what is to be added to them for a wider reach
  const std::vector<Pair>& find(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    if (radius.size() <= kBruteForceLimit) {
      no_margin_.setZero(radius.size());
      AllPairs<Dim>{}.near_pairs(x, radius, no_margin_, touching_);
    } else {
      find_with_grid(x, radius);
    }
    return touching_;
  }

 private:
  /// Grains above so many median radii are held against all others. The limit was not tuned: at
  /// half of it more grains are compared with all, at twice a cell holds 2^Dim times as many.
  static constexpr double kGiant = 4;

  void find_with_grid(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    const int n = static_cast<int>(radius.size());
    std::vector<double> sizes(radius.begin(), radius.end());
    std::nth_element(sizes.begin(), sizes.begin() + n / 2, sizes.end());
    const double giant = kGiant * sizes[static_cast<std::size_t>(n / 2)];

    ordinary_.clear();
    for (int i = 0; i < n; ++i) {
      if (radius[i] <= giant) ordinary_.push_back(i);
    }
    no_margin_.setZero(static_cast<Eigen::Index>(ordinary_.size()));
    grid_.near_pairs(x(Eigen::seqN(0, Eigen::fix<Dim>), ordinary_), radius(ordinary_), no_margin_,
                     touching_);
    for (Pair& pair : touching_) {
      pair = {ordinary_[static_cast<std::size_t>(pair.i)],
              ordinary_[static_cast<std::size_t>(pair.j)]};
    }

    no_margin_.setZero(n);
    for (int i = 0; i < n; ++i) {
      if (radius[i] <= giant) continue;
      for (int j = 0; j < n; ++j) {
        const bool counted = radius[j] > giant && j < i;  // two giants, seen from the other one
        if (j == i || counted || !within_reach<Dim>(x, radius, no_margin_, i, j)) continue;
        touching_.push_back({std::min(i, j), std::max(i, j)});
      }
    }
    if (ordinary_.size() < static_cast<std::size_t>(n)) sort_pairs(touching_, n);
  }

  CellGrid<Dim> grid_;
  Eigen::VectorXd no_margin_;
  std::vector<int> ordinary_;
  std::vector<Pair> touching_;  ///< sorted
};

}  // namespace lagrain
