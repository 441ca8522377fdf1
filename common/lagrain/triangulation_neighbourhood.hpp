#pragma once
/// @file
/// The neighbourhood that the project exists for: the edges of a regular triangulation that follows
/// the grains lazily, and misses nothing.

#include <lagrain/check.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/triangulation.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace lagrain {

/// How the triangulation follows the grains. The defaults are proved to miss nothing; other values
/// exist to show and to test what goes wrong without them.
struct Laziness {
  /// Skin of a grain, as a fraction of the smallest radius among it and its neighbours in T.
  /// References taken at different instants pass the certificate up to 0.2426; overlaps cost 0.41
  /// of their size.
  double skin = 0.24;
  bool certify = true;  ///< test the certificate after every update
  bool follow = true;   ///< false: T is built once and never moved
};

/// What the triangulation has cost so far.
struct TriangulationCost {
  std::int64_t updates = 0;   ///< refreshes in which some reference centre moved
  std::int64_t moved = 0;     ///< reference centres moved
  UpdateReport ladder;        ///< what the updates had to do
  std::int64_t shrunk = 0;    ///< grains brought up to date because an edge failed the certificate
  std::int64_t searched = 0;  ///< range searches around grains that still failed, or are hidden
};

/// Contacts along the edges of a lazy regular triangulation, after Ferrez & Liebling (2000).
///
/// T is exactly regular for *reference* centres, with weights (r_i + s_i)^2 for a skin s_i > 0.
/// While every grain stays within its skin of its reference centre, a pair that touches is a pair
/// of inflated reference spheres that touch, hence an edge of T, provided that these spheres meet
/// pairwise at less than a right angle: |c_a - c_b|^2 > rho_a^2 + rho_b^2. It is enough to test
/// that on the edges of T and to see that no site is hidden (the certificate: 3n comparisons in the
/// plane). So a grain's reference is moved, and T repaired by flips around it, only when the grain
/// is about to leave its skin. Nothing depends on speeds, time step or the order of flips.
///
/// Where an edge fails the certificate (deep overlap, a tiny grain come close to a large one) both
/// ends are brought up to date with skins chosen anew. What still fails, and what is hidden, is
/// searched by brute force: then too every pair is found, and `cost().searched` says so.
template <int Dim, RegularTriangulation<Dim> T = Triangulation<Dim>>
class TriangulationNeighbourhood {
 public:
  TriangulationNeighbourhood() = default;
  explicit TriangulationNeighbourhood(Laziness laziness) : laziness_(laziness) {}

  static const char* name() { return "regular triangulation"; }
  /// Regular for the inflated reference discs, in a frame that drifts with the grains.
  const T& triangulation() const { return t_; }
  const TriangulationCost& cost() const { return cost_; }
  const Laziness& laziness() const { return laziness_; }

  /// @pre x is finite
  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    if (reference_.cols() != x.cols()) {
      build(x, radius);
    } else if (laziness_.follow) {
      // T does not change when everything moves together: displacements count against the drift.
      drift_ = common_drift<Dim>(size(), [&](int i) { return x.col(i) - reference_.col(i); });
      for (int i = 0; i < size(); ++i) {
        margin[i] = std::min(margin[i], 0.5 * skin_[i]);
        if (strayed(x, i, margin[i])) moved_.push_back(i);
      }
      if (!moved_.empty()) {
        ++cost_.updates;
        move_references(x, radius);
        certify(x, radius);
      }
    }
    for (int i = 0; i < size(); ++i) margin[i] = std::min(margin[i], 0.5 * skin_[i]);

    collect_near_edges(x, radius, margin, pairs);
    if (!uncertain_.empty()) search_around_uncertain(x, radius, margin, pairs);
  }

 private:
  int size() const { return static_cast<int>(weight_.size()); }

  void build(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    // Skins follow the neighbours in T, and T the skins: start without.
    reference_ = x;
    weight_ = radius.array().square();
    t_.build(reference_, weight_);
    skin_.setZero(radius.size());
    everybody();
    choose_skins(radius);
    t_.build(reference_, weight_);
    moved_.clear();
    certify(x, radius);
  }

  void everybody() {
    moved_.resize(static_cast<std::size_t>(size()));
    std::iota(moved_.begin(), moved_.end(), 0);
  }

  /// True if i may leave its skin before the next refresh, which comes at the latest when it has
  /// moved by its margin.
  bool strayed(const Columns<Dim>& x, int i, double margin) const {
    const double room = (skin_[i] - margin) * (1 - 1e-6);
    return !((x.col(i) - drift_ - reference_.col(i)).squaredNorm() <= room * room);
  }

  /// New skins for the grains in moved_, from their neighbours in T as it stands.
  void choose_skins(const Eigen::VectorXd& radius) {
    for (const int i : moved_) {
      double smallest = radius[i];
      t_.for_each_neighbour(i, [&](int j) { smallest = std::min(smallest, radius[j]); });
      skin_[i] = laziness_.skin * smallest;
      const double inflated = radius[i] + skin_[i];
      weight_[i] = inflated * inflated;
    }
  }

  /// Brings the references in moved_ up to date, repairs T, and empties moved_.
  void move_references(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    choose_skins(radius);
    for (const int i : moved_) reference_.col(i) = x.col(i) - drift_;
    cost_.moved += static_cast<std::int64_t>(moved_.size());
    cost_.ladder += t_.move(moved_, reference_, weight_);
    moved_.clear();
  }

  /// Edges whose inflated spheres meet at a right angle or more: their ends go to moved_, unless
  /// they are up to date with the smallest skin already, then to uncertain_.
  void certify(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    uncertain_.clear();
    if (!laziness_.certify) return;
    for (int round = 0;; ++round) {
      failed_.clear();
      t_.for_each_edge([&](int a, int b) {
        const double squared = (reference_.col(a) - reference_.col(b)).squaredNorm();
        // One part in 10^12 covers the rounding of both sides.
        if (!(squared > (weight_[a] + weight_[b]) * (1 + 1e-12))) {
          failed_.push_back(a);
          failed_.push_back(b);
        }
      });
      sort_unique(failed_);
      if (failed_.empty()) break;
      if (round == kRounds) {
        uncertain_ = failed_;
        break;
      }
      moved_ = failed_;
      cost_.shrunk += static_cast<std::int64_t>(moved_.size());
      move_references(x, radius);
    }
    const auto hidden = t_.hidden();
    uncertain_.insert(uncertain_.end(), hidden.begin(), hidden.end());
    sort_unique(uncertain_);
  }

  static void sort_unique(std::vector<int>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  /// The edges of T within reach; T has them in order.
  void collect_near_edges(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                          const Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    const auto edges = t_.edges();
    pairs.resize(edges.size());
    std::size_t count = 0;
    for (const auto& [i, j] : edges) {
      // Written in any case and counted if near: cheaper than a branch that nobody can predict.
      pairs[count] = {i, j};
      count += within_reach<Dim>(x, radius, margin, i, j);
    }
    pairs.resize(count);
  }

  /// Every pair that T may lack has an end that lies on a failed edge or is hidden: look at all
  /// grains around exactly these.
  void search_around_uncertain(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                               const Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    cost_.searched += static_cast<std::int64_t>(uncertain_.size());
    for (const int i : uncertain_) {
      for (int j = 0; j < size(); ++j) {
        if (j == i || !within_reach<Dim>(x, radius, margin, std::min(i, j), std::max(i, j)))
          continue;
        pairs.push_back({std::min(i, j), std::max(i, j)});
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  }

  static constexpr int kRounds = 3;

  Laziness laziness_;
  T t_;
  Columns<Dim> reference_;
  Eigen::VectorXd weight_;  ///< (r + skin)^2
  Eigen::VectorXd skin_;
  Vec<Dim> drift_ = Vec<Dim>::Zero();  ///< of the grains against the references' frame [m]
  std::vector<int> uncertain_;         ///< grains whose pairs T may lack
  TriangulationCost cost_;

  std::vector<int> moved_;
  std::vector<int> failed_;
};

}  // namespace lagrain
