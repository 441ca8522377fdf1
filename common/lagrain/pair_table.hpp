// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `PairTable` holds listed pairs and what their contacts remember.

#include <lagrain/contact_law.hpp>
#include <lagrain/neighbourhood.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace lagrain {

/// Sorted pairs and, where the law remembers, one memory each. Memories survive a refresh by
/// merging two sorted lists; where the law remembers nothing, nothing is stored and nothing merged.
template <class P, class Memory>
class PairTable {
 public:
  static constexpr int kReals = Memory::kReals;  ///< numbers that a contact remembers

  const std::vector<P>& pairs() const { return pairs_; }  ///< all pairs, sorted
  std::size_t size() const { return pairs_.size(); }      ///< how many they are

  /// What pair k remembers.
  Memory memory(std::size_t k) const {
    Memory m;
    if constexpr (kReals > 0) {
      for (int r = 0; r < kReals; ++r) m[r] = memory_row(r)[k];
    }
    return m;
  }
  /// Gives pair k another memory.
  void set_memory(std::size_t k, const Memory& m) {
    if constexpr (kReals > 0) {
      for (int r = 0; r < kReals; ++r) memory_row(r)[k] = m[r];
    }
  }
  /// Number r of the memories of all pairs, side by side.
  /// @{
  double* memory_row(int r) { return memory_[static_cast<std::size_t>(r)].data(); }
  const double* memory_row(int r) const { return memory_[static_cast<std::size_t>(r)].data(); }
  /// @}

  /// Puts `pairs` (sorted) in place of its own, with these memories.
  void assign(std::vector<P> pairs, const std::vector<Memory>& memories) {
    pairs_ = std::move(pairs);
    for (auto& row : memory_) row.assign(pairs_.size(), 0.0);
    for (std::size_t k = 0; k < pairs_.size(); ++k) set_memory(k, memories[k]);
  }

  /// Exchanges its pairs for `pairs` (sorted), and keeps the memories of those that stay. The old
  /// pairs are left in `pairs`.
  void replace(std::vector<P>& pairs) {
    if constexpr (kReals > 0) {
      for (auto& row : next_memory_) row.assign(pairs.size(), 0.0);
      std::size_t old = 0;
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        while (old < pairs_.size() && pairs_[old] < pairs[k]) ++old;
        if (old == pairs_.size()) break;
        if (pairs_[old] != pairs[k]) continue;
        for (std::size_t r = 0; r < memory_.size(); ++r) next_memory_[r][k] = memory_[r][old];
      }
      memory_.swap(next_memory_);
    }
    pairs_.swap(pairs);
  }

  /// Whether the pairs are sorted, each is there once, and each has a memory.
  bool sound() const {
    const auto whole = [&](const auto& row) { return row.size() == pairs_.size(); };
    return std::adjacent_find(pairs_.begin(), pairs_.end(), std::greater_equal<P>()) ==
               pairs_.end() &&
           std::all_of(memory_.begin(), memory_.end(), whole);
  }

  /// Adds a pair without a past.
  /// @returns false if it is there already
  bool insert(const P& pair) {
    const auto place = std::lower_bound(pairs_.cbegin(), pairs_.cend(), pair);
    if (place != pairs_.cend() && *place == pair) return false;
    const auto k = place - pairs_.cbegin();
    pairs_.insert(place, pair);
    for (auto& row : memory_) row.insert(row.begin() + k, 0.0);
    return true;
  }

 private:
  friend struct AuditProbe;
  using Rows = std::array<std::vector<double>, static_cast<std::size_t>(kReals)>;

  std::vector<P> pairs_;
  Rows memory_;       // of each pair a column
  Rows next_memory_;  // scratch
};

}  // namespace lagrain
