// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `Follower` keeps the regular triangulation T up to date by flips: it gives new references to the
/// grains that are about to leave their skins.

#include <lagrain/contact_search.hpp>
#include <lagrain/lazy_sites.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/skins.hpp>
#include <lagrain/update_prices.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

/// Moves references so that T's edges hold every contact: the paper's step 5. skins.hpp has the
/// proof, and the numbers (2) to (4) below.
///
/// Skins are as large as the neighbours of a grain leave room for: where grains fly they reach to
/// half of the gap and beyond. A new reference stands ahead of its grain, on the way that it took
/// through its last skin, so that a grain in flight crosses the whole ball and not half of it.
///
/// Where an edge fails the certificate (deep overlap, a tiny grain come close to a large one) both
/// ends are brought up to date with small skins. What still fails, and what is hidden, is
/// uncertain: then the surroundings of these grains must be searched by brute force.
template <int Dim, RegularTriangulation<Dim> T>
class Follower {
 public:
  using Sites = LazySites<Dim, T>;  ///< what it works on

  /// Follows with these choices.
  explicit Follower(const Laziness& laziness) : laziness_(laziness) {}

  /// Grains whose pairs T may lack, sorted.
  const std::vector<int>& uncertain() const { return uncertain_; }
  /// What the updates have cost since the last call [ns], roughly.
  std::int64_t take_spent() { return std::exchange(spent_, 0); }
  /// T leaps from now on.
  void forget() { uncertain_.clear(); }

  /// Builds T with skins for which it can follow the grains.
  /// @pre T was built without
  void give_skins(Sites& sites, const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    for (int i = 0; i < sites.size(); ++i) sites.join(i);
    const auto place = [&](int i) -> Vec<Dim> { return x.col(i); };
    renew(sites, place, radius,
          Eigen::VectorXd::Constant(sites.size(), std::numeric_limits<double>::infinity()));
    sites.t.build(sites.reference, sites.weight);
    sites.placed.swap(sites.waiting);
    certify(sites, place, radius);
  }

  /// T has been changed by more than moves: tests all edges, and sees to those that fail.
  template <class Place>
  void test_all(Sites& sites, Place&& place, const Eigen::VectorXd& radius) {
    sites.placed.clear();
    certify(sites, place, radius, true);
  }

  /// Gives new references and skins to the grains that wait, and to neighbours that are in their
  /// way, and repairs T by flips.
  /// @param margin  that the skins should leave [m]
  template <class Place>
  void update(Sites& sites, Place&& place, const Eigen::VectorXd& radius,
              const Eigen::VectorXd& margin) {
    renew(sites, place, radius, margin);
    move_references(sites);
    certify(sites, place, radius);
  }

  /// Checks that every pair of reference balls that meet is an edge, or has an uncertain end, and
  /// that so has every edge that fails.
  void audit(const Sites& sites, const Eigen::VectorXd& radius,
             std::vector<std::string>& defects) const {
    if (!laziness_.certify) return;
    const T& t = sites.t;
    const auto uncertain = [&](int i) {
      return std::binary_search(uncertain_.begin(), uncertain_.end(), i);
    };
    std::vector<Pair> edges;  // sorted
    t.for_each_edge([&](int i, int j) { edges.push_back({i, j}); });
    for (const auto& [i, j] : edges) {
      if (sites.pass(i, j) || (uncertain(i) && uncertain(j))) continue;
      defects.push_back("edge " + std::to_string(i) + " " + std::to_string(j) + " fails unseen");
    }
    const auto is_grain = [&](int i) { return i >= 0 && i < sites.size(); };
    if (!std::all_of(uncertain_.begin(), uncertain_.end(), is_grain)) {
      defects.push_back("what is uncertain is no grain");
    }
    for (const int i : t.hidden()) {
      if (!uncertain(i)) defects.push_back("grain " + std::to_string(i) + " is hidden unseen");
    }
    ContactSearch<Dim> search;
    for (const Pair& pair : search.find(sites.reference, radius + sites.skin)) {
      if (uncertain(pair.i) || uncertain(pair.j) ||
          std::binary_search(edges.begin(), edges.end(), pair)) {
        continue;
      }
      defects.push_back("grains " + std::to_string(pair.i) + " and " + std::to_string(pair.j) +
                        " meet and are no edge");
    }
  }

 private:
  friend struct AuditProbe;
  using Standing = typename Sites::Standing;
  using Prices = UpdatePrices<Dim>;

  // The numbers below change no result, only how often references move. They were chosen together
  // on the shaken beds of `bench_lagrain`: references moved half as often as with equal skins and
  // no reference ahead. What a factor of two does to each was not measured; it says what to expect.

  /// The largest skin, of a grain's radius. It binds only where a grain has much room: with half of
  /// it a grain in flight is placed up to twice as often.
  static constexpr double kMostSkin = 2;
  /// The smallest skin, of the smallest radius around: a grain gets it even if the certificate
  /// then fails. With less, a grain squeezed by others is placed again very soon; with more, more
  /// edges fail.
  static constexpr double kLeastSkin = 0.02;
  /// How far ahead a reference may stand, of a skin. With none, a grain in flight crosses half of
  /// the ball and is placed nearly twice as often; with a whole skin a grain that turns round has
  /// no room.
  static constexpr double kMostAhead = 0.7;
  /// A neighbour that leaves less than this part of a fair share is placed anew itself. With more,
  /// more neighbours are placed; with less, skins stay tight beside neighbours that have strayed.
  static constexpr double kTooLittle = 0.25;
  /// After so many rounds of smaller skins, edges that still fail are left to the search. Another
  /// round costs one pass over all edges where grains overlap deeply, and nothing elsewhere.
  static constexpr int kRounds = 3;
  /// If more than one grain in so many has a new reference, all edges are tested in one pass over
  /// the list: to visit those of single grains costs several times as much for each edge. It was
  /// not tuned; the tests are a small part of an update.
  static constexpr std::size_t kTestAllFrom = 16;

  /// What a new reference must keep from a neighbour's: see renew_one.
  struct Bound {
    double slack;    // the right side of (4) [m^2]
    double forward;  // the way towards the neighbour's far side, along the motion: v.u in (4) [m]
  };

  /// Gives the grains that wait new references and skins. Neighbours whose own skins leave too
  /// little join them.
  template <class Place>
  void renew(Sites& sites, Place&& place, const Eigen::VectorXd& radius,
             const Eigen::VectorXd& margin) {
    for (std::size_t k = 0; k < sites.waiting.size(); ++k) {
      renew_one(sites, place, radius, sites.waiting[k], margin[sites.waiting[k]]);
    }
  }

  /// The skin is the largest that the certificate allows (4) against the neighbours in T as it
  /// stands, at their references, and that is fair to them (3) at their present places. T will
  /// change: that the new edges pass too is only likely here, and seen to by certify().
  template <class Place>
  void renew_one(Sites& sites, Place&& place, const Eigen::VectorXd& radius, int i, double margin) {
    const Vec<Dim> here = place(i) - sites.drift;
    const double r = radius[i];
    Vec<Dim> ahead = here - sites.reference.col(i);
    const double way = ahead.norm();
    ahead *= way > 0 ? 1 / way : 0;

    bounds_.clear();
    double smallest = r;
    double fair = kMostSkin * r;
    double centred = fair;  // allowed if the reference is put here
    sites.t.for_each_neighbour(i, [&](int j) {
      smallest = std::min(smallest, radius[j]);
      const double share =
          laziness_.skin * fair_skin(r, radius[j], (place(j) - sites.drift - here).squaredNorm());
      fair = std::min(fair, share);
      if (sites.standing_of(j) == Standing::waiting) return;
      const Vec<Dim> away = here - sites.reference.col(j);
      const Bound bound{away.squaredNorm() - r * r - sites.weight[j], away.dot(ahead)};
      const double allowed = allowed_skin(r, 0, bound.slack);
      if (sites.standing_of(j) == Standing::at_rest && allowed < kTooLittle * share) {
        sites.join(j);
        return;
      }
      centred = std::min(centred, allowed);
      bounds_.push_back(bound);
    });

    double skin = std::min(fair, centred);
    double shift = 0;
    // Ahead by a share of the skin that leaves the margin on all sides.
    const double share = way > 0 ? std::min(kMostAhead, 1 - margin / skin) : 0;
    if (share > 0) {
      double shifted = fair;
      for (const Bound& bound : bounds_) {
        shifted = std::min(shifted, allowed_skin(r - share * bound.forward, share, bound.slack));
      }
      if ((1 + share) * shifted > skin) {
        skin = shifted;
        shift = share * skin;
      }
    }
    if (!(skin > kLeastSkin * smallest)) {
      skin = kLeastSkin * smallest;
      shift = 0;
    }
    // A hair less, so that neither rounding nor the hair's breadth aside fails the certificate.
    sites.reference.col(i) = here + kUsable * shift * ahead + skin * sites.aside.col(i);
    sites.set_skin(radius, i, kUsable * skin);
    sites.standing_of(i) = Standing::placed;
  }

  /// Tells T of the new references of the grains that wait: they are placed.
  void move_references(Sites& sites) {
    const auto count = static_cast<std::int64_t>(sites.waiting.size());
    const UpdateReport report = sites.t.move(sites.waiting, sites.reference, sites.weight);
    sites.cost.moved += count;
    sites.cost.ladder += report;
    spent_ += Prices::kMove * count + Prices::kExtraction * report.extracted +
              Prices::kLeap * sites.size() * report.rebuilds;
    sites.placed.insert(sites.placed.end(), sites.waiting.begin(), sites.waiting.end());
    sites.waiting.clear();
  }

  /// Looks for edges that fail the certificate (2), and brings their ends up to date with skins
  /// that pass between grains of hardly any overlap. Ends of edges that fail again and again are
  /// uncertain. All grains are back at rest then.
  template <class Place>
  void certify(Sites& sites, Place&& place, const Eigen::VectorXd& radius, bool all = false) {
    // All edges passed before this update, unless some grains are uncertain: then, and if many
    // moved, test all of them.
    all = all || !uncertain_.empty() ||
          sites.placed.size() > static_cast<std::size_t>(sites.size()) / kTestAllFrom;
    uncertain_.clear();
    if (laziness_.certify) {
      for (int round = 0;; ++round) {
        find_failed(sites, all || round > 0);
        if (failed_.empty()) break;
        if (round == kRounds) {
          uncertain_ = failed_;
          break;
        }
        sites.cost.shrunk += static_cast<std::int64_t>(failed_.size());
        for (const int i : failed_) {
          const double skin = kSmallSkin * sites.smallest_around(radius, i);
          sites.reference.col(i) = place(i) - sites.drift + skin * sites.aside.col(i);
          sites.set_skin(radius, i, skin);
        }
        sites.waiting = failed_;
        move_references(sites);
      }
      const auto hidden = sites.t.hidden();
      uncertain_.insert(uncertain_.end(), hidden.begin(), hidden.end());
      sort_unique(uncertain_);
    }
    for (const int i : sites.placed) sites.standing_of(i) = Standing::at_rest;
  }

  /// Fills failed_ with the ends of edges that fail the certificate: of all, or of those that this
  /// update has changed.
  void find_failed(Sites& sites, bool all) {
    failed_.clear();
    const auto test = [&](int a, int b) {
      if (sites.pass(a, b)) return;
      failed_.push_back(a);
      failed_.push_back(b);
    };
    if (all) {
      for (const auto& [a, b] : sites.t.edges()) test(a, b);
    } else {
      for (const int i : sites.placed) {
        sites.t.for_each_neighbour(i, [&](int j) { test(i, j); });
      }
      sites.t.for_each_new_edge(test);
    }
    sort_unique(failed_);
  }

  Laziness laziness_;
  std::vector<int> uncertain_;
  std::int64_t spent_ = 0;
  std::vector<int> failed_;
  std::vector<Bound> bounds_;
};

}  // namespace lagrain
