// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Steps 2 and 3 of the paper: contacts are detected among the near pairs, and the law is applied
/// at each. What comes out is the force on every grain.

#include <lagrain/contact_kernel.hpp>
#include <lagrain/deep_overlap.hpp>
#include <lagrain/grain_store.hpp>
#include <lagrain/near_list.hpp>
#include <lagrain/records.hpp>
#include <lagrain/stopwatch.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lagrain {

/// Forces on the grains, block by block of the near list, so that blocks may be shared by threads.
/// First every block keeps the forces of its pairs across blocks; then each adds up all that acts
/// on its own grains, in an order that the slots fix: weights, pairs within the block, pairs
/// across, walls.
template <int Dim, class Law>
class ContactForces {
 public:
  static constexpr Needs needs = Law::needs;          ///< what the law needs
  using Memory = typename Law::template Memory<Dim>;  ///< what a contact remembers
  using Load = LoadRecord<Dim, needs>;                ///< force and torque on a grain
  using Scene = ContactScene<Dim, Law>;               ///< what all contacts share
  using List = NearList<Dim, Memory>;                 ///< where near pairs are listed

  /// What all blocks have added up, once each has been evaluated.
  struct Totals {
    Tally tally;              ///< losses, contacts, excess
    double pair_seconds = 0;  ///< of all threads together [s]
    double wall_seconds = 0;  ///< the same for contacts with walls [s]
  };

  /// @param one_law  all contacts between grains follow the first law of the table
  ContactForces(InstructionSet set, bool one_law) : kernel_(set, one_law) {}

  void measure_time(bool on) { measuring_ = on; }  ///< whether times are taken from now on

  /// Makes room for an evaluation.
  void begin(const List& near, const std::vector<Wall<Dim>>& walls, int threads) {
    const std::size_t blocks = near.blocks().size();
    sums_.resize(blocks);
    for (BlockSums& sums : sums_) {
      sums.deepest = {};
      sums.pair_seconds = sums.wall_seconds = 0;
    }
    kept_.resize(near.across_count());
    loads_.resize(static_cast<std::size_t>(threads));
    wall_loads_.assign(blocks * walls.size(), {});
    wall_count_ = walls.size();
    walls_meet_ =
        std::any_of(walls.begin(), walls.end(), [](const Wall<Dim>& wall) { return wall.joined; });
  }

  /// Keeps the forces of the pairs that block b has with later ones.
  void keep_pairs_across(const Scene& scene, List& near, std::size_t b) {
    auto& block = near.blocks()[b];
    BlockSums& sums = sums_[b];
    const Stopwatch watch(measuring_);
    sums.across =
        kernel_.pairs(scene, block.across, listing_for(block.across.size(), sums.across.contacts),
                      kept_.data() + block.first_across);
    if (sums.across.excess > 0) note_deepest(sums.deepest, block.across, scene);
    sums.pair_seconds += watch.seconds();
  }

  /// The loads of the grains of block b, from its first slot on; good until the thread is at
  /// another block.
  /// @pre the forces of all pairs across blocks are kept
  Load* detect_and_apply_law(Scene scene, List& near, std::size_t b, std::size_t thread,
                             const GrainStore<Dim, needs>& store, const Vec<Dim>& gravity) {
    auto& block = near.blocks()[b];
    BlockSums& sums = sums_[b];
    std::vector<Load>& loads = loads_[thread];
    const Stopwatch watch(measuring_);
    loads.resize(static_cast<std::size_t>(block.end_slot - block.first_slot));
    scene.loads = loads.data();
    scene.first_slot = block.first_slot;
    for (int slot = block.first_slot; slot < block.end_slot; ++slot) {
      set_to_weight(scene.load(slot), store.load(slot).at[Load::kMass], gravity);
      fetch_ahead(store.record(slot));
    }
    sums.within =
        kernel_.pairs(scene, block.within, listing_for(block.within.size(), sums.within.contacts));
    for (const auto& end : block.ends) {
      const PairLoad<Dim, needs>& both = kept_[end.pair];
      Load& load = scene.load(end.slot);
      if (end.second()) {
        both.give_to_j(load);
      } else {
        both.give_to_i(load);
      }
    }
    const double pair_seconds = watch.seconds();
    if (walls_meet_) hand_over_memories(scene, block.walls);
    sums.walls = kernel_.walls(scene, block.walls, wall_loads_.data() + b * wall_count_);
    if (sums.within.excess > 0) note_deepest(sums.deepest, block.within, scene);
    if (sums.walls.excess > 0) note_deepest(sums.deepest, block.walls, scene);
    sums.pair_seconds += pair_seconds;
    sums.wall_seconds += watch.seconds() - pair_seconds;
    return loads.data();
  }

  /// The order of the sum is fixed by the blocks.
  Totals totals() const {
    Totals all;
    for (const BlockSums& sums : sums_) all.tally += sums.across;
    for (const BlockSums& sums : sums_) {
      all.tally += sums.within;
      all.tally += sums.walls;
      all.pair_seconds += sums.pair_seconds;
      all.wall_seconds += sums.wall_seconds;
    }
    return all;
  }
  /// What the grains do to a wall.
  WallLoad<Dim> wall_load(std::size_t wall) const {
    WallLoad<Dim> load;
    for (std::size_t b = 0; b < sums_.size(); ++b) load += wall_loads_[b * wall_count_ + wall];
    return load;
  }
  /// Known where an overlap has gone beyond the limit.
  DeepOverlap deepest() const {
    DeepOverlap deepest;
    for (const BlockSums& sums : sums_) {
      if (sums.deepest.ratio > deepest.ratio) deepest = sums.deepest;
    }
    return deepest;
  }

 private:
  /// What the passes over a block's pairs added up. How many contacts there were is a guess for the
  /// next step.
  struct BlockSums {
    Tally across, within, walls;
    DeepOverlap deepest;
    double pair_seconds = 0, wall_seconds = 0;
  };

  static void set_to_weight(Load& load, double mass, const Vec<Dim>& gravity) {
    load.at[Load::kMass] = mass;
    load.force() = mass * gravity;
    if constexpr (needs.spin) load.torque().setZero();
  }

  /// Where walls meet, a contact may pass from one to another: what it remembers goes along, to the
  /// nearest contact of the grain that is new.
  static void hand_over_memories(const Scene& scene, PairTable<WallPair, Memory>& table) {
    if constexpr (Memory::kReals > 0) {
      const auto& pairs = table.pairs();
      const auto touches = [&](std::size_t k) {
        const auto& grain = scene.grains[pairs[k].i];
        return contact_foot<Dim>(scene.walls, pairs, k, grain.position(), grain.radius()).distance <
               grain.radius();
      };
      const auto is_new = [&](std::size_t k) {
        bool empty = true;
        for (int r = 0; r < Memory::kReals; ++r) empty = empty && table.memory_row(r)[k] == 0;
        return empty;
      };
      for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {
        while (end < pairs.size() && pairs[end].i == pairs[first].i) ++end;
        if (end - first < 2) continue;
        for (std::size_t old = first; old < end; ++old) {
          if (is_new(old) || touches(old)) continue;
          // A way in a step is short against the grain, so the new foot is near the old one.
          const auto& grain = scene.grains[pairs[old].i];
          const auto arm = [&](std::size_t k) -> Vec<Dim> {
            const auto foot = scene.walls[pairs[k].wall].foot(pairs[k].piece, grain.position());
            return -foot.distance * foot.normal;
          };
          std::size_t heir = end;
          double least = 0.5 * grain.radius();
          for (std::size_t next = first; next < end; ++next) {
            if (next == old || !is_new(next) || !touches(next)) continue;
            const double way = (arm(next) - arm(old)).norm();
            if (way < least) {
              least = way;
              heir = next;
            }
          }
          if (heir < end) table.set_memory(heir, table.memory(old));
        }
      }
    }
  }

  ContactKernel<Dim, Law> kernel_;
  std::vector<BlockSums> sums_;
  std::vector<PairLoad<Dim, needs>> kept_;  // of the pairs across blocks
  std::vector<std::vector<Load>> loads_;    // of the block that each thread is at
  std::size_t wall_count_ = 0;
  bool walls_meet_ = false;                // any of them
  std::vector<WallLoad<Dim>> wall_loads_;  // by block, and in it by wall
  bool measuring_ = false;
};

}  // namespace lagrain
