// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Checks that the near list holds every contact, by an independent search.

#include <lagrain/contact_rules.hpp>
#include <lagrain/contact_search.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/state.hpp>
#include <lagrain/walls.hpp>

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

  /// @param near   sorted pairs that claim to hold every contact at centres x [m]
  /// @param rules  which pairs can be contacts
  void check(const Columns<Dim>& x, const Eigen::VectorXd& radius, const std::vector<Pair>& near,
             const ContactRules& rules = {}) {
    touching_ = search_.find(x, radius);
    rules.drop_from(touching_);
    ++checks_;
    compare(touching_, near);
  }

  /// The same for contacts with walls, each piece for itself. Every grain is held against every
  /// piece, in which there is nothing to get wrong.
  /// @param near  sorted pairs that claim to hold every piece that a grain reaches
  void check_walls(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                   const std::vector<Wall<Dim>>& walls, const std::vector<WallPair>& near,
                   const ContactRules& rules = {}) {
    at_walls_.clear();
    for (int i = 0; i < static_cast<int>(radius.size()); ++i) {
      for (int w = 0; w < static_cast<int>(walls.size()); ++w) {
        const Wall<Dim>& wall = walls[static_cast<std::size_t>(w)];
        if (wall.gone || !rules.may_touch(i, wall)) continue;
        for (int piece = 0; piece < wall.piece_count(); ++piece) {
          if (wall.foot(piece, x.col(i)).distance < radius[i]) at_walls_.push_back({i, w, piece});
        }
      }
    }
    compare(at_walls_, near);
  }

 private:
  template <class P>
  void compare(const std::vector<P>& touching, const std::vector<P>& near) {
    contacts_ += static_cast<std::int64_t>(touching.size());
    std::vector<P> lacking;
    std::set_difference(touching.begin(), touching.end(), near.begin(), near.end(),
                        std::back_inserter(lacking));
    missed_ += static_cast<std::int64_t>(lacking.size());
  }

  ContactSearch<Dim> search_;
  std::vector<Pair> touching_;      // contacts found from nothing
  std::vector<WallPair> at_walls_;  // the same with walls
  std::int64_t checks_ = 0;
  std::int64_t contacts_ = 0;
  std::int64_t missed_ = 0;
};

}  // namespace lagrain
