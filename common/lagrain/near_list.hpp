#pragma once
/// @file
/// The flat lists that the step loop runs over, and when they must be made anew.

#include <lagrain/neighbourhood.hpp>
#include <lagrain/pair_table.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lagrain {

/// All pairs within reach at the last refresh. Each grain has a margin m_i: as long as none has
/// moved further than its margin since the refresh, two grains that touch now were then at a gap of
/// at most m_i + m_j, so their pair is in the list. The same holds for walls.
///
/// Displacements are measured in a frame that moves on with the velocity that most grains had at
/// the refresh: a common drift wears nothing out. A margin follows the grain's speed in that frame,
/// so that a bed at rest is listed almost without surplus and one fast grain costs only its
/// surroundings; the two constants of that rule adapt to how long lists last. The choice of margins
/// never changes a result: pairs that do not touch are skipped, and the order of the others is
/// fixed by the grains' slots.
///
/// Slots are dealt with in blocks of equal size, the same whatever the number of threads. Pairs
/// within a block belong to it alone; pairs across blocks are listed apart, and each block has a
/// list of what they do to its grains.
template <int Dim, class Memory>
class NearList {
 public:
  /// One end of a pair across blocks.
  struct End {
    int slot;
    int pair;     ///< in `across`
    bool second;  ///< the end j of the pair
  };

  PairTable<Pair, Memory> within;  ///< pairs within a block
  PairTable<Pair, Memory> across;  ///< pairs across blocks
  PairTable<WallPair, Memory> walls;

  /// Slots in a block, and the number of blocks.
  int block_size() const { return block_size_; }
  int blocks() const { return blocks_; }
  int first_slot(int block) const { return block * block_size_; }
  int end_slot(int block) const { return std::min(size_, (block + 1) * block_size_); }
  /// Where a block's entries of a table begin; those of block + 1 follow. In `across` the pairs
  /// whose i is in the block.
  std::size_t first_within(int block) const { return first_within_[index(block)]; }
  std::size_t first_across(int block) const { return first_across_[index(block)]; }
  std::size_t first_wall(int block) const { return first_wall_[index(block)]; }
  /// The ends in a block of pairs across, in the order of the pairs.
  const std::vector<End>& ends(int block) const { return ends_[index(block)]; }

  std::int64_t refreshes() const { return refreshes_; }
  bool fresh() const { return known_; }

  /// Sets the number of grains and the size of blocks; nothing is listed.
  void reset(int size, int block_size) {
    size_ = size;
    block_size_ = block_size;
    blocks_ = (size + block_size - 1) / block_size;
    known_ = false;
  }

  /// How far the frame has moved since the last refresh, at time t [s].
  Vec<Dim> shift(double t) const { return (t - time_) * drift_; }

  /// Whether a grain at x, where the frame has moved by `shift`, has kept within its margin since
  /// the last refresh. NaN has not.
  /// @pre the list is fresh
  bool holds(int slot, const Vec<Dim>& x, const Vec<Dim>& shift) const {
    const Stay& stay = stay_[index(slot)];
    return (x - shift - stay.centre).squaredNorm() <= stay.squared_margin;
  }

  /// The same for all walls.
  bool walls_hold(const std::vector<Wall<Dim>>& all_walls, const Vec<Dim>& shift) const {
    for (std::size_t w = 0; w < all_walls.size(); ++w) {
      const double moved = (all_walls[w].point - shift - wall_centre_[w]).norm();
      if (!(moved <= wall_margin_[w])) return false;
    }
    return true;
  }

  /// Lists the pairs near the places x [m], at time t [s] and step `step` of length dt [s].
  /// @param velocity  velocity(slot) [m/s]
  template <Neighbourhood<Dim> N, class Velocity>
  void refresh(const Columns<Dim>& x, const Eigen::VectorXd& radius, Velocity&& velocity,
               const std::vector<Wall<Dim>>& all_walls, N& neighbourhood, double t, double dt,
               std::int64_t step) {
    adapt(step);
    time_ = t;
    drift_ = common_drift<Dim>(size_, velocity);
    margin_.resize(size_);
    for (int i = 0; i < size_; ++i) {
      margin_[i] = std::clamp(kHorizon * dt * (velocity(i) - drift_).norm(), floor_ * radius[i],
                              kCeiling * radius[i]);
    }
    neighbourhood.near_pairs(x, radius, margin_, fresh_);
    list_pairs();
    list_walls(x, radius, all_walls, dt);

    stay_.resize(static_cast<std::size_t>(size_));
    for (int i = 0; i < size_; ++i) {
      // The margins promised are a hair wider than those used: rounding in the tests cannot matter.
      const double margin = margin_[i] * (1 - 1e-6);
      stay_[index(i)] = {x.col(i), margin * margin};
    }
    for (double& m : wall_margin_) m *= 1 - 1e-6;
    known_ = true;
    ++refreshes_;
  }

  /// The grains have new slots: the memories follow, and the list is no longer fresh.
  /// @param slot  new slot of each old one
  void renumber(const std::vector<int>& slot) {
    std::vector<std::pair<Pair, Memory>> pairs;
    for (const auto* table : {&within, &across}) {
      for (std::size_t k = 0; k < table->size(); ++k) {
        const Pair old = table->pairs()[k];
        const Pair pair{slot[index(old.i)], slot[index(old.j)]};
        if (pair.i < pair.j) {
          pairs.emplace_back(pair, table->memory(k));
        } else {
          pairs.emplace_back(Pair{pair.j, pair.i}, table->memory(k).seen_from_partner());
        }
      }
    }
    set(within, pairs, [&](const Pair& p) { return p.i / block_size_ == p.j / block_size_; });
    set(across, pairs, [&](const Pair& p) { return p.i / block_size_ != p.j / block_size_; });
    std::vector<std::pair<WallPair, Memory>> wall_pairs;
    for (std::size_t k = 0; k < walls.size(); ++k) {
      const WallPair old = walls.pairs()[k];
      wall_pairs.emplace_back(WallPair{slot[index(old.i)], old.wall}, walls.memory(k));
    }
    set(walls, wall_pairs, [](const WallPair&) { return true; });
    known_ = false;
  }

 private:
  static constexpr double kHorizon = 100;      // steps that a grain may keep its speed
  static constexpr double kCeiling = 0.3;      // of a radius: wider lists cost more than refreshes
  static constexpr double kLeastFloor = 1e-4;  // of a radius
  static constexpr double kMostFloor = 0.1;

  struct Stay {
    Vec<Dim> centre;
    double squared_margin;
  };

  template <class I>
  static std::size_t index(I i) {
    return static_cast<std::size_t>(i);
  }

  /// Lists that die young ask for wider margins, long-lived ones for narrower.
  void adapt(std::int64_t step) {
    if (refreshes_ > 0) {
      const std::int64_t age = step - last_refresh_;
      if (age < 30) floor_ = std::min(floor_ * 1.25, kMostFloor);
      if (age > 60) floor_ = std::max(floor_ * 0.4, kLeastFloor);
    }
    last_refresh_ = step;
  }

  /// Takes the entries that fulfil a condition, sorted.
  template <class P, class Condition>
  static void set(PairTable<P, Memory>& table, std::vector<std::pair<P, Memory>>& entries,
                  Condition&& condition) {
    std::sort(entries.begin(), entries.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<P> keys;
    std::vector<Memory> memories;
    for (const auto& [key, memory] : entries) {
      if (!condition(key)) continue;
      keys.push_back(key);
      memories.push_back(memory);
    }
    table.assign(std::move(keys), memories);
  }

  /// Where each block's entries begin in sorted pairs.
  template <class P>
  void find_blocks(const std::vector<P>& pairs, std::vector<std::size_t>& first) const {
    first.resize(index(blocks_) + 1);
    std::size_t k = 0;
    for (int b = 0; b <= blocks_; ++b) {
      while (k < pairs.size() && pairs[k].i < first_slot(b)) ++k;
      first[index(b)] = k;
    }
    first.back() = pairs.size();
  }

  void list_pairs() {
    if (blocks_ <= 1) {
      within.replace(fresh_);
      fresh_.clear();
    } else {
      fresh_within_.clear();
      fresh_across_.clear();
      int block = 0;  // of i
      for (const Pair& pair : fresh_) {
        while (pair.i >= end_slot(block)) ++block;
        (pair.j < end_slot(block) ? fresh_within_ : fresh_across_).push_back(pair);
      }
      within.replace(fresh_within_);
      fresh_.clear();
      fresh_.swap(fresh_across_);
    }
    across.replace(fresh_);
    find_blocks(within.pairs(), first_within_);
    find_blocks(across.pairs(), first_across_);
    ends_.resize(index(blocks_));
    for (auto& list : ends_) list.clear();
    for (std::size_t k = 0; k < across.size(); ++k) {
      const auto [i, j] = across.pairs()[k];
      ends_[index(i / block_size_)].push_back({i, static_cast<int>(k), false});
      ends_[index(j / block_size_)].push_back({j, static_cast<int>(k), true});
    }
  }

  void list_walls(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                  const std::vector<Wall<Dim>>& all_walls, double dt) {
    fresh_walls_.clear();
    wall_centre_.resize(all_walls.size());
    wall_margin_.resize(all_walls.size());
    const double slack = size_ > 0 ? floor_ * radius.minCoeff() : 0;
    for (std::size_t w = 0; w < all_walls.size(); ++w) {
      const Wall<Dim>& wall = all_walls[w];
      wall_centre_[w] = wall.point;
      // A fixed wall moves against the drift; without a drift it needs no margin.
      const bool still = !wall.moves() && drift_.isZero(0);
      wall_margin_[w] =
          still ? 0 : std::max(slack, kHorizon * dt * (wall.velocity - drift_).norm());
      const double reach = wall_margin_[w];
      wall.for_each_within(
          x, [&](int i) { return radius[i] + margin_[i] + reach; },
          [&](int i) {
            fresh_walls_.push_back({i, static_cast<int>(w)});
          });
    }
    std::sort(fresh_walls_.begin(), fresh_walls_.end());
    walls.replace(fresh_walls_);
    find_blocks(walls.pairs(), first_wall_);
  }

  int size_ = 0;
  int block_size_ = 1;
  int blocks_ = 0;
  bool known_ = false;
  double time_ = 0;                    // of the last refresh [s]
  Vec<Dim> drift_ = Vec<Dim>::Zero();  // velocity of the frame [m/s]
  Eigen::VectorXd margin_;
  std::vector<Stay> stay_;
  std::vector<Vec<Dim>> wall_centre_;
  std::vector<double> wall_margin_;
  std::vector<std::size_t> first_within_, first_across_, first_wall_;
  std::vector<std::vector<End>> ends_;
  std::vector<Pair> fresh_, fresh_within_, fresh_across_;
  std::vector<WallPair> fresh_walls_;
  double floor_ = 0.01;
  std::int64_t last_refresh_ = 0;
  std::int64_t refreshes_ = 0;
};

}  // namespace lagrain
