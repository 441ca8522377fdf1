#pragma once
/// @file
/// The flat list that the step loop runs over, and when it must be made anew.

#include <lagrain/check.hpp>
#include <lagrain/contact_law.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace lagrain {

/// A wall and a grain near it.
struct WallPair {
  int wall = 0;
  int i = 0;
  auto operator<=>(const WallPair&) const = default;
};

/// Sorted pairs and, where the law remembers, one memory each. History survives a refresh by
/// merging two sorted lists; without memory nothing is stored and nothing merged.
template <class P, class Memory>
struct PairTable {
  static constexpr bool kRemembers = !std::is_same_v<Memory, NoMemory>;

  std::vector<P> pairs;
  std::vector<Memory> memory;  ///< as many as pairs if the law remembers, else none

  /// Puts `fresh` (sorted) in place of the pairs, keeping the memory of those that stay; the old
  /// pairs are left in `fresh`.
  void replace(std::vector<P>& fresh) {
    if constexpr (kRemembers) {
      std::vector<Memory> kept(fresh.size());
      std::size_t old = 0;
      for (std::size_t k = 0; k < fresh.size(); ++k) {
        while (old < pairs.size() && pairs[old] < fresh[k]) ++old;
        if (old < pairs.size() && pairs[old] == fresh[k]) kept[k] = memory[old];
      }
      memory.swap(kept);
    }
    pairs.swap(fresh);
  }
};

/// All pairs within reach at the last refresh. Each grain has a margin m_i: as long as none has
/// moved further than its margin since the refresh, two grains that touch now were then at a gap of
/// at most m_i + m_j, so their pair is in the list. The same holds for walls.
///
/// Displacements are measured in a frame that moves on with the velocity that most grains had at
/// the refresh: a common drift wears nothing out. A margin follows the grain's speed in that frame,
/// so that a bed at rest is listed almost without surplus and one fast grain costs only its
/// surroundings; the two constants of that rule adapt to how long lists last. The choice of margins
/// never changes a result: pairs that do not touch are skipped, and the order of the others is
/// fixed by the grains' numbers.
template <int Dim, class Memory>
class NearList {
 public:
  PairTable<Pair, Memory> grains;
  PairTable<WallPair, Memory> walls;

  std::int64_t refreshes() const { return refreshes_; }

  /// Whether some grain or wall has left its margin since the last refresh. NaN counts as left.
  /// @param t time [s]
  bool expired(const Columns<Dim>& x, const std::vector<Wall<Dim>>& all_walls, double t) const {
    if (centre_.cols() != x.cols()) return true;
    const Vec<Dim> shift = (t - time_) * drift_;
    for (std::size_t w = 0; w < all_walls.size(); ++w) {
      const double moved = (all_walls[w].point - shift - wall_centre_[w]).norm();
      if (!(moved <= wall_margin_[w])) return true;
    }
    bool inside = true;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      inside &= (x.col(i) - shift - centre_.col(i)).squaredNorm() <= squared_margin_[i];
    }
    return !inside;
  }

  /// Lists the pairs near the current places, at time t [s] and step `step` of length dt [s].
  template <Needs needs, Neighbourhood<Dim> N>
  void refresh(const Grains<Dim, needs>& g, const std::vector<Wall<Dim>>& all_walls,
               N& neighbourhood, double t, double dt, std::int64_t step) {
    adapt(step);
    const int n = g.size();
    time_ = t;
    drift_ = common_drift<Dim>(n, [&](int i) { return g.velocity.col(i); });
    margin_.resize(n);
    for (int i = 0; i < n; ++i) {
      margin_[i] = std::clamp(kHorizon * dt * (g.velocity.col(i) - drift_).norm(),
                              floor_ * g.radius[i], kCeiling * g.radius[i]);
    }
    neighbourhood.near_pairs(g.position, g.radius, margin_, fresh_);
    grains.replace(fresh_);

    fresh_walls_.clear();
    wall_centre_.resize(all_walls.size());
    wall_margin_.resize(all_walls.size());
    const double slack = n > 0 ? floor_ * g.radius.minCoeff() : 0;
    for (std::size_t w = 0; w < all_walls.size(); ++w) {
      const Wall<Dim>& wall = all_walls[w];
      wall_centre_[w] = wall.point;
      // A fixed wall moves against the drift; without a drift it needs no margin.
      const bool still = !wall.moves() && drift_.isZero(0);
      wall_margin_[w] =
          still ? 0 : std::max(slack, kHorizon * dt * (wall.velocity - drift_).norm());
      const double reach = wall_margin_[w];
      wall.for_each_within(
          g.position, [&](int i) { return g.radius[i] + margin_[i] + reach; },
          [&](int i) {
            fresh_walls_.push_back({static_cast<int>(w), i});
          });
    }
    walls.replace(fresh_walls_);

    centre_ = g.position;
    // The margins promised are a hair wider than those used: rounding in the tests cannot matter.
    squared_margin_ = (margin_ * (1 - 1e-6)).array().square();
    for (double& m : wall_margin_) m *= 1 - 1e-6;
    ++refreshes_;
  }

 private:
  static constexpr double kHorizon = 40;       // steps that a grain may keep its speed
  static constexpr double kCeiling = 0.1;      // of a radius: wider lists cost more than refreshes
  static constexpr double kLeastFloor = 2e-3;  // of a radius
  static constexpr double kMostFloor = 5e-2;

  /// Lists that die young ask for wider margins, long-lived ones for narrower.
  void adapt(std::int64_t step) {
    if (refreshes_ > 0) {
      const std::int64_t age = step - last_refresh_;
      if (age < 15) floor_ = std::min(floor_ * 1.25, kMostFloor);
      if (age > 60) floor_ = std::max(floor_ * 0.8, kLeastFloor);
    }
    last_refresh_ = step;
  }

  double time_ = 0;                    // of the last refresh [s]
  Vec<Dim> drift_ = Vec<Dim>::Zero();  // velocity of the frame [m/s]
  Columns<Dim> centre_;
  Eigen::VectorXd margin_;
  Eigen::VectorXd squared_margin_;
  std::vector<Vec<Dim>> wall_centre_;
  std::vector<double> wall_margin_;
  std::vector<Pair> fresh_;
  std::vector<WallPair> fresh_walls_;
  double floor_ = 0.01;
  std::int64_t last_refresh_ = 0;
  std::int64_t refreshes_ = 0;
};

}  // namespace lagrain
