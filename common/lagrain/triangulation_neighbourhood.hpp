// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The neighbourhood that the project exists for: the edges of a regular triangulation that follows
/// the grains lazily, and misses nothing.

#include <lagrain/check.hpp>
#include <lagrain/follower.hpp>
#include <lagrain/lazy_sites.hpp>
#include <lagrain/leaper.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/triangulation.hpp>
#include <lagrain/update_prices.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <vector>

namespace lagrain {

/// Contacts along the edges of a lazy regular triangulation, after Ferrez & Liebling (2000).
///
/// T is exactly regular for *reference* centres, with weights (r_i + s_i)^2 for a skin s_i > 0.
/// While every grain stays within its skin of its reference centre, T stays as it is and misses
/// nothing: skins.hpp has the theorems and their proofs. Which grains get new references, and how,
/// is chosen between two ways:
///
/// - T *follows* (Follower): single references are moved, and T is repaired by flips around them.
/// - T *leaps* (Leaper): it is built anew with wide skins, and pairs are listed by walks in it.
///
/// T leaps when moves have cost as much as one build. When the grains have calmed down it follows
/// them again.
template <int Dim, RegularTriangulation<Dim> T = Triangulation<Dim>>
class TriangulationNeighbourhood {
 public:
  TriangulationNeighbourhood() = default;
  /// Follows and leaps with these choices.
  explicit TriangulationNeighbourhood(Laziness laziness)
      : laziness_(laziness), follower_(laziness) {}

  static const char* name() { return "regular triangulation"; }  ///< for people
  /// Regular for the reference balls, those of the last leap if T leaps; in a frame that
  /// drifts with the grains.
  const T& triangulation() const { return sites_.t; }
  const TriangulationCost& cost() const { return sites_.cost; }  ///< since the start
  const Laziness& laziness() const { return laziness_; }         ///< what was chosen
  /// Where T believes grain i to be [m], in the frame of the grains at the last question.
  Vec<Dim> reference(int i) const { return sites_.reference.col(i) + sites_.drift; }
  /// How far grain i may be from there before T has to know [m].
  double skin(int i) const { return sites_.skin[i]; }
  /// How far the frame of T's sites has gone with the grains [m].
  const Vec<Dim>& drift() const { return sites_.drift; }
  /// Grains around which pairs are searched, because T cannot vouch for their edges; in order.
  std::span<const int> uncertain() const { return follower_.uncertain(); }
  /// Without the certificate, or a T that follows, pairs may be missing.
  bool keeps_promise() const { return laziness_.certify && laziness_.follow; }

  /// The grains have other numbers from now on: T is built anew at the next question.
  void forget() { sites_.reference.resize(Dim, 0); }

  /// Grains have left, and others have come behind those that stay: T follows by local operations,
  /// unless so many come and go that a build is cheaper.
  /// @param new_number  of each former grain, in the same order; -1: it has left
  /// @param x           all grains now [m]; finite
  void exchange(const std::vector<int>& new_number, const Columns<Dim>& x,
                const Eigen::VectorXd& radius) {
    const auto left = std::count(new_number.begin(), new_number.end(), -1);
    const auto come = x.cols() - static_cast<Eigen::Index>(new_number.size()) + left;
    const bool known = laziness_.follow && sites_.reference.cols() > 0 &&
                       sites_.reference.cols() == static_cast<Eigen::Index>(new_number.size());
    if (!known || kMostExchanged * (left + come) > x.cols()) {
      forget();
      return;
    }
    sites_.exchange(new_number, x, radius);
    if (leaping_) {
      leap(x, radius);
    } else {
      follower_.test_all(
          sites_, [&](int i) -> Vec<Dim> { return x.col(i); }, radius);
    }
  }

  /// @pre x is finite
  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    if (x.cols() == 0) {
      sites_.t.build(x, radius);
      pairs.clear();
      return;
    }
    const auto place = [&](int i) -> Vec<Dim> { return x.col(i); };
    if (sites_.reference.cols() != x.cols()) {
      build(x, radius);
      for (int i = 0; i < size(); ++i) margin[i] = std::min(margin[i], sites_.room(i, x.col(i)));
    } else if (laziness_.follow) {
      // T does not change when everything moves together: displacements count against the drift.
      sites_.drift =
          common_drift<Dim>(size(), [&](int i) { return x.col(i) - sites_.reference.col(i); });
      choose_mode(x, radius, margin);
      for (int i = 0; i < size(); ++i) see_to(i, x.col(i), margin);
      update(place, radius, margin);
    } else {
      for (int i = 0; i < size(); ++i) margin[i] = std::min(margin[i], 0.5 * sites_.skin[i]);
    }

    collect_near(x, radius, margin, pairs);
    if (!follower_.uncertain().empty()) search_around_uncertain(x, radius, margin, pairs);
    if constexpr (kAudited) {
      std::vector<int> all(static_cast<std::size_t>(size()));
      std::iota(all.begin(), all.end(), 0);
      detail::expect_no_defect(name(), audit(radius, all, place, margin));
    }
  }

  /// Also adds to the strays the grains that got new references.
  bool pairs_of(std::vector<int>& strays, const PlaceOf<Dim>& place, const Eigen::VectorXd& radius,
                Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    if (!laziness_.follow || !follower_.uncertain().empty() || leap_is_due()) return false;
    for (const int i : strays) see_to(i, place(i), margin);
    update(place, radius, margin);
    if (!follower_.uncertain().empty()) return false;
    strays.insert(strays.end(), sites_.placed.begin(), sites_.placed.end());
    sort_unique(strays);
    pairs.clear();
    for (const int i : strays) {
      const auto add = [&](int j) { pairs.push_back({std::min(i, j), std::max(i, j)}); };
      if (leaping_) {
        leaper_.reach().for_each_partner(i, add);
      } else {
        sites_.t.for_each_neighbour(i, add);
      }
    }
    if constexpr (kAudited) {
      detail::expect_no_defect(name(), audit(radius, strays, place, margin));
    }
    return true;
  }

  /// Checks T, what is kept beside it, and the promise that rests on both; empty means valid.
  /// @param radius   those of the last question [m]
  /// @param centred  grains that were centred in it
  /// @param place    where they were then, and margin what it answered
  template <class Place>
  std::vector<std::string> audit(const Eigen::VectorXd& radius, std::span<const int> centred,
                                 Place&& place, const Eigen::VectorXd& margin) const {
    std::vector<std::string> defects;
    for (const auto& defect : sites_.t.audit()) defects.push_back("T: " + defect.sentence);
    if (!defects.empty()) return defects;
    audit_sites(radius, defects);
    if (leaping_) {
      leaper_.audit(sites_, radius, defects);
    } else {
      follower_.audit(sites_, radius, defects);
    }
    for (const int i : centred) {
      if (laziness_.follow && !(margin[i] <= sites_.room(i, place(i)))) {
        defects.push_back("grain " + std::to_string(i) + " has a margin beyond its skin");
      }
    }
    return defects;
  }

 private:
  friend struct AuditProbe;
  using Sites = LazySites<Dim, T>;

  // When a bed is calm. These numbers change no result. They keep T from going to and fro: each way
  // costs a build, and a bed that T follows too early makes it leap again soon.
  /// Of a radius: a grain that wants so much more margin than the slowest one is fast.
  static constexpr double kFast = 0.01;
  /// Of so many grains at most one is fast in a calm bed. With half or twice as many T follows a
  /// little later or earlier after a shake.
  static constexpr int kFewest = 10;
  /// If more than one grain in so many comes or goes, T is built anew: to insert or remove a site
  /// takes about as long as its part of a build, and T is built twice. It was not tuned.
  static constexpr int kMostExchanged = 4;
  /// Questions in a row at which the bed is calm and no grain has left its skin.
  static constexpr int kCalm = 5;

  int size() const { return sites_.size(); }

  void build(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    sites_.reset(x, radius);
    // Skins follow the neighbours in T, and T the skins: start without.
    sites_.build_without_skins(x, radius);
    if (leaping_) {
      leap(x, radius);
    } else {
      follow(x, radius);
    }
  }

  void follow(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    leaping_ = false;
    leaper_.forget();
    follower_.give_skins(sites_, x, radius);
    spent_ = follower_.take_spent();
  }

  void leap(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    leaping_ = true;
    spent_ = 0;
    calm_ = 0;
    follower_.forget();
    leaper_.leap(sites_, x, radius);
  }

  /// Whether what was spent on single grains since the last build would have paid for a leap: so
  /// the choice of mode costs at most about twice what the better one does.
  bool leap_is_due() const { return laziness_.leap && spent_ > UpdatePrices<Dim>::kLeap * size(); }

  /// Leaps, or follows again, if it is time to. Calm is judged by the margins that are wanted,
  /// which follow speeds above a floor that is the same for all.
  void choose_mode(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                   const Eigen::VectorXd& margin) {
    if (leap_is_due()) {
      leap(x, radius);
    } else if (leaping_) {
      const Eigen::ArrayXd wanted = margin.array() / radius.array();
      const auto fast = (wanted > wanted.minCoeff() + kFast).count();
      calm_ = kFewest * fast < size() ? calm_ + 1 : 0;
      if (calm_ < kCalm) return;
      sites_.build_without_skins(x, radius);
      follow(x, radius);
    }
  }

  /// Asks for no more margin than half a skin; a grain whose skin has no room for that waits for a
  /// new reference.
  void see_to(int i, const Vec<Dim>& x, Eigen::VectorXd& margin) {
    margin[i] = std::min(margin[i], 0.5 * sites_.skin[i]);
    if (!(sites_.room(i, x) >= margin[i])) sites_.join(i);
  }

  /// Brings T up to date with the grains that wait, and leaves all that have new references in
  /// sites_.placed, with margins that these allow.
  template <class Place>
  void update(Place&& place, const Eigen::VectorXd& radius, Eigen::VectorXd& margin) {
    sites_.placed.clear();
    if (sites_.waiting.empty()) return;
    ++sites_.cost.updates;
    if (leaping_) {
      calm_ = 0;
      spent_ += leaper_.update(sites_, place, radius);
    } else {
      follower_.update(sites_, place, radius, margin);
      spent_ += follower_.take_spent();
    }
    for (const int i : sites_.placed) margin[i] = std::min(margin[i], sites_.room(i, place(i)));
  }

  /// Checks that weights are those of radii and skins, no grain waits, and the references are T's
  /// sites (which those of grains that have walked since a leap are not).
  void audit_sites(const Eigen::VectorXd& radius, std::vector<std::string>& defects) const {
    for (int i = 0; i < size(); ++i) {
      const T& t = sites_.t;
      const bool sound =
          sites_.skin[i] > 0 && sites_.weight[i] == weight_with(radius[i], sites_.skin[i]) &&
          sites_.standing[static_cast<std::size_t>(i)] == Sites::Standing::at_rest &&
          (leaping_ || (t.site(i) == sites_.reference.col(i) && t.weight(i) == sites_.weight[i]));
      if (!sound) {
        defects.push_back("the reference of grain " + std::to_string(i) + " is not sound");
      }
    }
    if (!sites_.waiting.empty()) defects.push_back("grains wait for new references");
  }

  /// Lists the pairs within reach: edges of T or, while T leaps, pairs of reference balls
  /// that meet.
  void collect_near(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                    const Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    now_.resize(static_cast<std::size_t>(size()));
    for (int i = 0; i < size(); ++i) {
      now_[static_cast<std::size_t>(i)] = {x.col(i), radius[i] + margin[i]};
    }
    std::size_t count = 0;
    const auto filter = [&](const auto& candidates) {
      pairs.resize(count + candidates.size());
      for (const auto& [i, j] : candidates) {
        const auto &a = now_[static_cast<std::size_t>(i)], &b = now_[static_cast<std::size_t>(j)];
        // Written in any case and counted if near: cheaper than a branch that nobody can predict.
        pairs[count] = {i, j};
        count += within_reach<Dim>(a.centre, a.radius, b.centre, b.radius);
      }
      pairs.resize(count);
    };
    if (leaping_) {
      filter(leaper_.reach().pairs());
      const auto added = static_cast<std::ptrdiff_t>(count);
      filter(leaper_.reach().added());
      std::sort(pairs.begin() + added, pairs.end());
      std::inplace_merge(pairs.begin(), pairs.begin() + added, pairs.end());
    } else {
      filter(sites_.t.edges());
    }
  }

  /// Every pair that T may lack has an end that lies on a failed edge or is hidden: tests all
  /// grains around exactly these.
  void search_around_uncertain(const Columns<Dim>& x, const Eigen::VectorXd& radius,
                               const Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    sites_.cost.searched += static_cast<std::int64_t>(follower_.uncertain().size());
    for (const int i : follower_.uncertain()) {
      for (int j = 0; j < size(); ++j) {
        if (j == i || !within_reach<Dim>(x, radius, margin, std::min(i, j), std::max(i, j)))
          continue;
        pairs.push_back({std::min(i, j), std::max(i, j)});
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  }

  Laziness laziness_;
  Sites sites_;
  Follower<Dim, T> follower_{laziness_};
  Leaper<Dim, T> leaper_;
  bool leaping_ = false;
  int calm_ = 0;                                    ///< questions since the bed was not
  std::int64_t spent_ = 0;                          ///< since the last build [ns], roughly
  std::vector<typename ReachList<Dim>::Ball> now_;  ///< scratch: grains with their margins
};

}  // namespace lagrain
