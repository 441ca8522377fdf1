#pragma once
/// @file
/// Checks that the near list holds every contact, by an independent search.

#include <lagrain/all_pairs.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/neighbourhood.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

namespace lagrain {

/// Compares the contacts that a near list holds with those found from nothing: by brute force up to
/// 200 grains, with a fresh grid above. The grid is made for the grains of ordinary size; the few
/// that are much larger would make its cells far too wide, so they are held against all others.
template <int Dim>
class ContactAudit {
 public:
  static constexpr int kBruteForceLimit = 200;

  std::int64_t checks() const { return checks_; }      ///< times that `check` was called
  std::int64_t contacts() const { return contacts_; }  ///< contacts found from nothing
  std::int64_t missed() const { return missed_; }      ///< of these, not in the near list

  /// @param near sorted pairs that claim to hold every contact at centres x [m]
  void check(const Columns<Dim>& x, const Eigen::VectorXd& radius, const std::vector<Pair>& near) {
    if (radius.size() <= kBruteForceLimit) {
      no_margin_.setZero(radius.size());
      AllPairs<Dim>{}.near_pairs(x, radius, no_margin_, touching_);
    } else {
      find_with_grid(x, radius);
    }
    ++checks_;
    contacts_ += static_cast<std::int64_t>(touching_.size());
    lacking_.clear();
    std::set_difference(touching_.begin(), touching_.end(), near.begin(), near.end(),
                        std::back_inserter(lacking_));
    missed_ += static_cast<std::int64_t>(lacking_.size());
  }

 private:
  static constexpr double kGiant = 4;  // times the median radius

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
    grid_.near_pairs(x(Eigen::all, ordinary_), radius(ordinary_), no_margin_, touching_);
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
  std::vector<Pair> lacking_;   ///< of these, not in the near list
  std::int64_t checks_ = 0;
  std::int64_t contacts_ = 0;
  std::int64_t missed_ = 0;
};

}  // namespace lagrain
