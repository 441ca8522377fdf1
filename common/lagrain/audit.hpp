#pragma once
/// @file
/// Checks that the near list holds every contact, by an independent search.

#include <lagrain/all_pairs.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/neighbourhood.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace lagrain {

/// Compares the contacts that a near list holds with those found from nothing: by brute force up to
/// 1,000 grains, with a fresh grid above.
template <int Dim>
class ContactAudit {
 public:
  static constexpr int kBruteForceLimit = 1000;

  std::int64_t checks() const { return checks_; }      ///< times that `check` was called
  std::int64_t contacts() const { return contacts_; }  ///< contacts found from nothing
  std::int64_t missed() const { return missed_; }      ///< of these, not in the near list

  /// @param near sorted pairs that claim to hold every contact at centres x [m]
  void check(const Columns<Dim>& x, const Eigen::VectorXd& radius, const std::vector<Pair>& near) {
    Eigen::VectorXd no_margin = Eigen::VectorXd::Zero(radius.size());
    if (radius.size() <= kBruteForceLimit) {
      AllPairs<Dim>{}.near_pairs(x, radius, no_margin, touching_);
    } else {
      grid_.near_pairs(x, radius, no_margin, touching_);
    }
    ++checks_;
    contacts_ += static_cast<std::int64_t>(touching_.size());
    for (const Pair& pair : touching_) {
      if (!std::binary_search(near.begin(), near.end(), pair)) ++missed_;
    }
  }

 private:
  CellGrid<Dim> grid_;
  std::vector<Pair> touching_;
  std::int64_t checks_ = 0;
  std::int64_t contacts_ = 0;
  std::int64_t missed_ = 0;
};

}  // namespace lagrain
