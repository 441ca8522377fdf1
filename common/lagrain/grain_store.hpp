// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Where the grains of a simulation lie in memory, and how they are found by number.

#include <lagrain/check.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/records.hpp>
#include <lagrain/spatial_order.hpp>
#include <lagrain/state.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

namespace lagrain {

/// Grains in *slots*: records in the order of Hilbert's curve, so that neighbours in space are
/// neighbours in memory. They get new slots when they have mixed. Outside, everything speaks of the
/// grains' numbers, from 0 to N - 1. They are in the order of the grains' *ids*: a grain keeps its
/// id as long as it is there, and no other one gets it. Until grains come or leave, numbers and ids
/// are the same.
template <int Dim, Needs needs>
class GrainStore {
 public:
  using Record = GrainRecord<Dim, needs>;  ///< what contacts read of a grain
  using Load = LoadRecord<Dim, needs>;     ///< what contacts write

  /// @param with_materials  whether materials matter: more than one law acts
  GrainStore(Grains<Dim, needs> grains, bool with_materials)
      : by_number_(std::move(grains)),
        with_materials_(with_materials),
        next_id_(by_number_.size()) {
    const Grains<Dim, needs>& g = by_number_;
    if (g.size() > kSortFrom && g.position.allFinite()) numbers_ = spatial_order<Dim>(g.position);
    seat();
  }

  int count() const { return static_cast<int>(records_.size()); }  ///< N
  /// The number of the grain in a slot.
  int number(int slot) const { return numbers_.empty() ? slot : numbers_[index(slot)]; }
  /// The ids by number, in increasing order; empty while the numbers are the ids.
  const std::vector<int>& ids() const { return ids_; }
  /// The id of the grain in a slot.
  int id(int slot) const { return ids_.empty() ? number(slot) : ids_[index(number(slot))]; }

  // By slot.
  /// The record in a slot.
  /// @{
  Record& record(int slot) { return records_[index(slot)]; }
  const Record& record(int slot) const { return records_[index(slot)]; }
  /// @}
  const std::vector<Record>& records() const { return records_; }  ///< all of them, by slot
  /// The forces that were evaluated last.
  /// @{
  Load& load(int slot) { return loads_[index(slot)]; }
  const Load& load(int slot) const { return loads_[index(slot)]; }
  /// @}
  const Eigen::VectorXd& radius() const { return radius_; }  ///< N, by slot [m]
  /// Empty where materials do not matter.
  const std::vector<std::uint8_t>& materials() const { return materials_; }
  /// Dim x N, by slot [m].
  Columns<Dim> places() const {
    Columns<Dim> x(Dim, count());
    for (int slot = 0; slot < count(); ++slot) x.col(slot) = record(slot).position();
    return x;
  }

  /// All grains as they are now, by number. Put together when asked for after outdate().
  const Grains<Dim, needs>& by_number() const {
    if (!by_number_is_known_) put_together();
    return by_number_;
  }
  /// What never changes, by number, is there without being put together.
  /// @{
  const Eigen::VectorXd& radii() const { return by_number_.radius; }
  const Eigen::VectorXd& masses() const { return by_number_.mass; }
  /// @}
  /// The records have changed, or are about to.
  void outdate() { by_number_is_known_ = false; }

  /// Grains leave and others come. The others move up in their slots and numbers, so that they keep
  /// their order, and with it that of the sums; newcomers follow.
  /// @param kept       numbers of those that stay, in increasing order
  /// @param newcomers  with new ids
  /// @returns the new slot of each old one; -1 where the grain has left
  std::vector<int> exchange(const std::vector<int>& kept, const Grains<Dim, needs>& newcomers) {
    const int before = count();
    std::vector<int> new_number(index(before), -1), slot_of(index(before), -1), ids;
    for (const int i : kept) {
      new_number[index(i)] = static_cast<int>(ids.size());
      ids.push_back(ids_.empty() ? i : ids_[index(i)]);
    }
    std::vector<int> numbers;
    for (int slot = 0; slot < before; ++slot) {
      const int i = new_number[index(number(slot))];
      if (i < 0) continue;
      slot_of[index(slot)] = static_cast<int>(numbers.size());
      numbers.push_back(i);
    }
    for (int k = 0; k < newcomers.size(); ++k) {
      ids.push_back(next_id_++);
      numbers.push_back(static_cast<int>(numbers.size()));
    }
    by_number_ = joined(by_number(), kept, newcomers);
    ids_ = std::move(ids);
    numbers_ = std::move(numbers);
    seat();
    return slot_of;
  }

  /// Whether slots are looked at before a step. The steps are fixed and places alone decide, so
  /// that all neighbourhoods do the same.
  static bool sort_is_due(std::int64_t step) {
    return step % kStepsBetweenSorts == kStepsBetweenSorts - 1;
  }
  /// Whether there are so many grains that the order of slots matters for speed.
  bool order_matters() const { return count() > kSortFrom; }
  /// Gives the grains new slots if neighbours in space lie far apart in memory.
  /// @returns the new slot of each old one; empty if all stay where they are
  /// @pre all places are finite
  std::vector<int> sort_if_mixed() {
    const Columns<Dim> x = places();
    const auto way = [&](auto&& slot_at) {
      double length = 0;
      for (int k = 1; k < count(); ++k) {
        length += (x.col(slot_at(k)) - x.col(slot_at(k - 1))).norm();
      }
      return length;
    };
    const std::vector<int> order = spatial_order<Dim>(x);
    if (way([](int k) { return k; }) <= kMixed * way([&](int k) { return order[index(k)]; })) {
      return {};
    }
    const auto permute = [&](auto& list) {
      if (list.empty()) return;
      auto sorted = list;
      for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = list[index(order[k])];
      list.swap(sorted);
    };
    permute(records_);
    permute(loads_);
    permute(numbers_);
    permute(materials_);
    std::vector<int> slot_of(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      slot_of[index(order[k])] = static_cast<int>(k);
      radius_[static_cast<Eigen::Index>(k)] = records_[k].radius();
    }
    return slot_of;
  }

  /// Keeps or restores the grains, each in a row, in the order of the slots.
  /// @throws SceneError if the state holds no such grains
  void persist(StateVisitor visit) {
    std::vector<int> number(records_.size());
    for (int slot = 0; slot < count(); ++slot) number[index(slot)] = this->number(slot);
    Grains<Dim, needs> g;
    if (!visit.restores()) g = joined(by_number(), number, make_grains<Dim, needs>({}));
    visit("number", number);
    visit("ids", ids_);
    visit("next_id", next_id_);
    visit("position", g.position);
    visit("velocity", g.velocity);
    visit("force", g.force);
    visit("radius", g.radius);
    visit("mass", g.mass);
    visit("inverse_mass", g.inverse_mass);
    visit("material", g.material);
    if constexpr (needs.spin) {
      visit("omega", g.omega);
      visit("torque", g.torque);
      visit("inverse_inertia", g.inverse_inertia);
    }
    if (visit.restores()) restore(std::move(g), std::move(number));
  }

  /// @throws SimulationError if a place or velocity is not a number; it names the time t [s]
  void expect_finite(double t) const {
    for (int slot = 0; slot < count(); ++slot) {
      if (record(slot).position().allFinite() && record(slot).velocity().allFinite()) continue;
      std::ostringstream message;
      message << "t = " << t << " s: grain " << id(slot)
              << " has a place or velocity that is not a number; a smaller time step would help";
      throw SimulationError(message.str());
    }
  }

 private:
  // The next three numbers were not tuned, and change results only in the last digits: the order of
  // slots is that of the sums.

  /// Up to this number the records of all grains, at most 160 bytes each, lie in the second-level
  /// cache in any order. Sorting them as well would cost next to nothing.
  static constexpr int kSortFrom = 1024;
  /// To look whether grains have mixed takes as long as a few steps: less than a thousandth of a
  /// run, at half of this number too. At twice, grains that flow lie out of order for longer.
  static constexpr std::int64_t kStepsBetweenSorts = 10000;
  /// Slots are put in order again when the way through all grains is longer by this factor. Near 1
  /// grains that only rattle would be sorted each time; at twice as much a flow would stay out of
  /// order for longer.
  static constexpr double kMixed = 1.3;

  template <class I>
  static std::size_t index(I i) {
    return static_cast<std::size_t>(i);
  }

  /// Fills the slots with the grains by number.
  void seat() {
    const Grains<Dim, needs>& g = by_number_;
    records_.assign(index(g.size()), {});
    loads_.assign(index(g.size()), {});
    materials_.resize(with_materials_ && !g.material.empty() ? records_.size() : 0);
    radius_.resize(g.size());
    for (int slot = 0; slot < g.size(); ++slot) {
      const int i = number(slot);
      Record& record = records_[index(slot)];
      Load& load = loads_[index(slot)];
      record.position() = g.position.col(i);
      record.velocity() = g.velocity.col(i);
      record.at[Record::kRadius] = radius_[slot] = g.radius[i];
      record.at[Record::kInverseMass] = g.inverse_mass[i];
      load.at[Load::kMass] = g.mass[i];
      load.force() = g.force.col(i);
      if constexpr (needs.spin) {
        record.omega() = g.omega.col(i);
        record.at[Record::kInverseInertia] = g.inverse_inertia[i];
        load.torque() = g.torque.col(i);
      }
      if (!materials_.empty()) materials_[index(slot)] = g.material[index(i)];
    }
  }

  /// @param g        grains by slot
  /// @param numbers  of the slots
  void restore(Grains<Dim, needs> g, std::vector<int> numbers) {
    const auto n = g.radius.size();
    bool sound = numbers.size() == index(n) && (ids_.empty() || ids_.size() == index(n)) &&
                 g.position.cols() == n && g.velocity.cols() == n && g.force.cols() == n &&
                 g.mass.size() == n && g.inverse_mass.size() == n &&
                 (g.material.empty() || g.material.size() == index(n));
    if constexpr (needs.spin) {
      sound = sound && g.omega.cols() == n && g.torque.cols() == n && g.inverse_inertia.size() == n;
    }
    std::vector<int> slot_of(index(n), -1);
    for (int slot = 0; sound && slot < n; ++slot) {
      const int i = numbers[index(slot)];
      sound = i >= 0 && i < n && slot_of[index(i)] < 0;
      if (sound) slot_of[index(i)] = slot;
    }
    if (!sound) throw SceneError("its grains do not fit together");
    const auto positive = [](const Eigen::VectorXd& list) {
      return list.allFinite() && (list.array() > 0).all();
    };
    if (!positive(g.radius) || !positive(g.mass) || !g.inverse_mass.allFinite() ||
        !g.position.allFinite() || !g.velocity.allFinite() ||
        !std::all_of(g.material.begin(), g.material.end(), [](int m) {
          return m >= 0 && m <= std::numeric_limits<std::uint8_t>::max();
        })) {
      throw SceneError(
          "a grain of it has a size, mass, place, velocity or material that cannot be");
    }
    by_number_ = joined(g, slot_of, make_grains<Dim, needs>({}));
    by_number_is_known_ = true;
    numbers_ = std::move(numbers);
    seat();
  }

  void put_together() const {
    Grains<Dim, needs>& g = by_number_;
    for (int slot = 0; slot < count(); ++slot) {
      const int i = number(slot);
      g.position.col(i) = record(slot).position();
      g.velocity.col(i) = record(slot).velocity();
      g.force.col(i) = load(slot).force();
      if constexpr (needs.spin) {
        g.omega.col(i) = record(slot).omega();
        g.torque.col(i) = load(slot).torque();
      }
    }
    by_number_is_known_ = true;
  }

  mutable Grains<Dim, needs> by_number_;
  mutable bool by_number_is_known_ = true;
  bool with_materials_;       // whether they matter
  int next_id_;               // of the grain that comes next
  std::vector<int> ids_;      // by number; empty if they are the numbers
  std::vector<int> numbers_;  // of the grains in the slots; empty if they are the slots
  std::vector<Record> records_;
  std::vector<Load> loads_;
  std::vector<std::uint8_t> materials_;
  Eigen::VectorXd radius_;
};

}  // namespace lagrain
