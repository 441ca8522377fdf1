// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `ContactRules` says which pairs can be contacts.

#include <lagrain/law_table.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/pinned_grains.hpp>
#include <lagrain/walls.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lagrain {

/// Which grains may touch each other and the walls. Two things that cannot move exert nothing on
/// each other, and some materials do not touch. A pair of such is no contact, holds no energy, and
/// is not listed: nobody else has to ask.
class ContactRules {
 public:
  ContactRules() = default;  ///< all may touch
  /// @param pinned    which grains nothing moves
  /// @param material  of each grain; empty: all are of material 0
  /// @param apart     materials that do not touch
  ContactRules(PinnedGrains pinned, const std::vector<std::uint8_t>& material = {},
               MaterialsApart apart = {})
      : pinned_(std::move(pinned)), apart_(std::move(apart)) {
    if (!apart_.empty()) material_ = material;
  }

  const PinnedGrains& pinned() const { return pinned_; }  ///< which grains nothing moves

  /// Whether two grains can be a contact.
  bool may_touch(const Pair& pair) const {
    return !(pinned_[pair.i] && pinned_[pair.j]) && !apart_(material(pair.i), material(pair.j));
  }
  /// Whether grain i and a wall can be one.
  template <int Dim>
  bool may_touch(int i, const Wall<Dim>& wall) const {
    return (wall.yields() || !pinned_[i]) &&
           !apart_(material(i), static_cast<std::size_t>(wall.material));
  }
  /// Takes the pairs out of a list that can be no contact.
  void drop_from(std::vector<Pair>& pairs) const {
    if (pinned_.none() && apart_.empty()) return;
    std::erase_if(pairs, [&](const Pair& pair) { return !may_touch(pair); });
  }

 private:
  std::size_t material(int i) const {
    return material_.empty() ? 0 : material_[static_cast<std::size_t>(i)];
  }

  PinnedGrains pinned_;
  MaterialsApart apart_;
  std::vector<std::uint8_t> material_;  // kept only where some materials do not touch
};

}  // namespace lagrain
