// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `LawTable` gives the contact law for each pair of materials, or says that they do not touch.

#include <lagrain/check.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lagrain {

/// Pairs of materials that do not touch: what is made of them goes through each other.
class MaterialsApart {
 public:
  /// From now on two materials do not touch.
  void add(std::size_t a, std::size_t b) {
    apart_.resize(kMaterials * kMaterials);
    apart_[a * kMaterials + b] = apart_[b * kMaterials + a] = true;
  }
  /// From now on no two materials touch.
  void add_all() { apart_.assign(kMaterials * kMaterials, true); }
  /// Whether two materials do not touch.
  bool operator()(std::size_t a, std::size_t b) const {
    return !apart_.empty() && apart_[a * kMaterials + b];
  }
  bool empty() const { return apart_.empty(); }  ///< whether all materials touch

 private:
  static constexpr std::size_t kMaterials = 256;  // a grain keeps its material in one byte
  std::vector<bool> apart_;                       // empty: no pair is apart
};

/// Symmetric table of laws, one for each pair of materials. A table of one law holds for all
/// materials, however many there are.
template <class Law>
class LawTable {
 public:
  LawTable() = default;
  /// @param materials  rows of the table, from 1 to 255; every pair has this law until set() gives
  ///                   it another
  /// @throws ContractError for another number of materials
  explicit LawTable(Law law, int materials = 1)
      : materials_(static_cast<std::size_t>(materials)), laws_(materials_ * materials_, law) {
    LAGRAIN_EXPECTS(materials >= 1 && materials <= 255, "materials " + std::to_string(materials));
  }

  /// Gives a pair of materials its law, in both orders.
  void set(int a, int b, const Law& law) {
    laws_[index(static_cast<std::size_t>(a), static_cast<std::size_t>(b))] = law;
    laws_[index(static_cast<std::size_t>(b), static_cast<std::size_t>(a))] = law;
  }
  /// Two materials do not touch from now on, whatever their law. In a table of one law nothing
  /// touches anything then.
  void set_apart(int a, int b) {
    if (one_law()) {
      apart_.add_all();
    } else {
      apart_.add(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    }
  }
  const MaterialsApart& apart() const { return apart_; }  ///< pairs that do not touch
  /// The law between two materials.
  const Law& between(std::size_t a, std::size_t b) const {
    return one_law() ? laws_.front() : laws_[index(a, b)];
  }
  int materials() const { return static_cast<int>(materials_); }  ///< rows of the table
  bool one_law() const { return materials_ == 1; }  ///< whether the same law holds for all

  /// The law between the grains i and j.
  /// @param material  of all grains; empty if all are of material 0
  const Law& of(const std::vector<std::uint8_t>& material, int i, int j) const {
    if (material.empty()) return laws_.front();
    return between(material[static_cast<std::size_t>(i)], material[static_cast<std::size_t>(j)]);
  }
  /// The law between the grain i and a wall.
  const Law& with_wall(const std::vector<std::uint8_t>& material, int i, int wall_material) const {
    return between(material.empty() ? 0 : material[static_cast<std::size_t>(i)],
                   static_cast<std::size_t>(wall_material));
  }

 private:
  std::size_t index(std::size_t a, std::size_t b) const { return a * materials_ + b; }

  std::size_t materials_ = 0;
  std::vector<Law> laws_;
  MaterialsApart apart_;
};

}  // namespace lagrain
