// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Checks that the near list holds every contact, by an independent search.

#include <lagrain/contact_search.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/pinned_grains.hpp>
#include <lagrain/state.hpp>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

namespace lagrain {

/// Compares the contacts that a near list holds with those found from nothing.
template <int Dim>
class ContactAudit {
 public:
  std::int64_t checks() const { return checks_; }      ///< times that `check` was called
  std::int64_t contacts() const { return contacts_; }  ///< contacts found from nothing
  std::int64_t missed() const { return missed_; }      ///< of these, not in the near list

  /// Keeps or restores what it has counted.
  void persist(StateVisitor visit) {
    visit("checks", checks_);
    visit("contacts", contacts_);
    visit("missed", missed_);
  }

  /// @param near    sorted pairs that claim to hold every contact at centres x [m]
  /// @param pinned  grains that touch no other one of them
  void check(const Columns<Dim>& x, const Eigen::VectorXd& radius, const std::vector<Pair>& near,
             const PinnedGrains& pinned = {}) {
    touching_ = search_.find(x, radius);
    pinned.drop_from(touching_);
    ++checks_;
    contacts_ += static_cast<std::int64_t>(touching_.size());
    lacking_.clear();
    std::set_difference(touching_.begin(), touching_.end(), near.begin(), near.end(),
                        std::back_inserter(lacking_));
    missed_ += static_cast<std::int64_t>(lacking_.size());
  }

 private:
  ContactSearch<Dim> search_;
  std::vector<Pair> touching_;  ///< contacts found from nothing
  std::vector<Pair> lacking_;   ///< contacts that are not in the near list
  std::int64_t checks_ = 0;
  std::int64_t contacts_ = 0;
  std::int64_t missed_ = 0;
};

}  // namespace lagrain
