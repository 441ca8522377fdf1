#pragma once
/// @file
/// The neighbourhood that the project exists for: the edges of a regular triangulation that follows
/// the grains lazily, and misses nothing.

#include <lagrain/check.hpp>
#include <lagrain/contact_search.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/random.hpp>
#include <lagrain/reach_list.hpp>
#include <lagrain/triangulation.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

/// How the triangulation follows the grains. The defaults are proved to miss nothing; other values
/// exist to show and to test what goes wrong without them.
struct Laziness {
  /// Skins as multiples of those that pass the certificate although references are taken at
  /// different instants: 0.2426 r between two equal grains that touch, more where there is room.
  double skin = 1.3;
  bool certify = true;  ///< test the certificate after every update
  bool follow = true;   ///< false: T is built once and never moved
  bool leap = true;     ///< where many grains fly, build T anew with wide skins
};

/// What the triangulation has cost so far.
struct TriangulationCost {
  std::int64_t updates = 0;   ///< refreshes in which some reference centre moved
  std::int64_t moved = 0;     ///< reference centres moved
  UpdateReport ladder;        ///< what the updates had to do
  std::int64_t shrunk = 0;    ///< grains given a small skin because an edge failed the certificate
  std::int64_t searched = 0;  ///< range searches around grains that still failed, or are hidden
  std::int64_t leaps = 0;     ///< builds with wide skins
  std::int64_t walks = 0;     ///< grains that left wide skins
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
/// Skins are as large as the neighbours of a grain leave room for: where grains fly they reach to
/// half of the gap and beyond. A new reference stands ahead of its grain, on the way that it took
/// through its last skin, so that a grain in flight crosses the whole ball and not half of it.
///
/// Where an edge fails the certificate (deep overlap, a tiny grain come close to a large one) both
/// ends are brought up to date with small skins. What still fails, and what is hidden, is searched
/// by brute force: then too every pair is found, and `cost().searched` says so.
///
/// Where many grains fly, or a few very far, all these moves cost more than to build T anew, and
/// wider skins make both rarer. They leave the certificate behind. So when moves have cost as much
/// as one build, T *leaps*: it is built with wide skins, and the pairs of
/// reference spheres that meet are listed by walking in it, which asks for no certificate
/// (ReachList). Until the next leap T stays as it is; grains that leave their wide skins find their
/// partners by such walks as well. When the grains have calmed down T follows them again.
template <int Dim, RegularTriangulation<Dim> T = Triangulation<Dim>>
class TriangulationNeighbourhood {
 public:
  TriangulationNeighbourhood() = default;
  explicit TriangulationNeighbourhood(Laziness laziness) : laziness_(laziness) {}

  static const char* name() { return "regular triangulation"; }
  /// Regular for the inflated reference spheres, those of the last leap if T leaps; in a frame that
  /// drifts with the grains.
  const T& triangulation() const { return t_; }
  const TriangulationCost& cost() const { return cost_; }
  const Laziness& laziness() const { return laziness_; }
  /// Without the certificate, or a T that follows, pairs may be missing.
  bool keeps_promise() const { return laziness_.certify && laziness_.follow; }

  /// The grains have other numbers from now on: T is built anew at the next question.
  void forget() { reference_.resize(Dim, 0); }

  /// @pre x is finite
  void near_pairs(const Columns<Dim>& x, const Eigen::VectorXd& radius, Eigen::VectorXd& margin,
                  std::vector<Pair>& pairs) {
    const auto place = [&](int i) -> Vec<Dim> { return x.col(i); };
    if (reference_.cols() != x.cols()) {
      build(x, radius);
      for (int i = 0; i < size(); ++i) margin[i] = std::min(margin[i], room(i, x.col(i)));
    } else if (laziness_.follow) {
      // T does not change when everything moves together: displacements count against the drift.
      drift_ = common_drift<Dim>(size(), [&](int i) { return x.col(i) - reference_.col(i); });
      choose_mode(x, radius, margin);
      for (int i = 0; i < size(); ++i) see_to(i, x.col(i), margin);
      update(place, radius, margin);
    } else {
      for (int i = 0; i < size(); ++i) margin[i] = std::min(margin[i], 0.5 * skin_[i]);
    }

    collect_near(x, radius, margin, pairs);
    if (!uncertain_.empty()) search_around_uncertain(x, radius, margin, pairs);
#ifdef LAGRAIN_AUDIT
    std::vector<int> all(static_cast<std::size_t>(size()));
    std::iota(all.begin(), all.end(), 0);
    detail::expect_no_defect(name(), audit(radius, all, place, margin));
#endif
  }

  /// Also adds to the strays the grains that got new references.
  bool pairs_of(std::vector<int>& strays, const PlaceOf<Dim>& place, const Eigen::VectorXd& radius,
                Eigen::VectorXd& margin, std::vector<Pair>& pairs) {
    if (!laziness_.follow || !uncertain_.empty() || leap_is_due()) return false;
    for (const int i : strays) see_to(i, place(i), margin);
    update(place, radius, margin);
    if (!uncertain_.empty()) return false;
    strays.insert(strays.end(), placed_.begin(), placed_.end());
    sort_unique(strays);
    pairs.clear();
    for (const int i : strays) {
      const auto add = [&](int j) { pairs.push_back({std::min(i, j), std::max(i, j)}); };
      if (leaping_) {
        reach_.for_each_partner(i, add);
      } else {
        t_.for_each_neighbour(i, add);
      }
    }
#ifdef LAGRAIN_AUDIT
    detail::expect_no_defect(name(), audit(radius, strays, place, margin));
#endif
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
    for (const auto& defect : t_.audit()) defects.push_back("T: " + defect.sentence);
    if (!defects.empty()) return defects;
    audit_skins(radius, defects);
    if (leaping_) {
      for (const std::string& defect : reach_.audit(t_)) defects.push_back("walks: " + defect);
    } else {
      audit_certificate(radius, defects);
    }
    for (const int i : centred) {
      if (laziness_.follow && !(margin[i] <= room(i, place(i)))) {
        defects.push_back("grain " + std::to_string(i) + " has a margin beyond its skin");
      }
    }
    return defects;
  }

 private:
  friend struct AuditProbe;
  /// Where a grain stands in an update: not concerned, in moved_ without a new reference, with one.
  enum class State : unsigned char { at_rest, waiting, placed };
  /// What a new reference must keep from a neighbour's: see renew_one.
  struct Bound {
    double slack;    // squared distance less both weights, without a skin here [m^2]
    double forward;  // the way towards the neighbour's far side, along the motion [m]
  };

  int size() const {
    return static_cast<int>(weight_.size());
  }
  State& state(int i) {
    return state_[static_cast<std::size_t>(i)];
  }

  void build(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    Random random(1);
    aside_ = x.unaryExpr([&](double) { return kHair * random.uniform(-1, 1); });
    skin_.setZero(radius.size());
    state_.assign(static_cast<std::size_t>(x.cols()), State::at_rest);
    moved_.clear();
    placed_.clear();
    // Skins follow the neighbours in T, and T the skins: start without.
    build_without_skins(x, radius);
    if (leaping_) {
      leap(x, radius);
    } else {
      give_skins(x, radius);
    }
  }

  void build_without_skins(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    reference_ = x;
    for (int i = 0; i < x.cols(); ++i) reference_.col(i) += radius[i] * aside_.col(i);
    drift_.setZero();
    weight_ = radius.array().square();
    t_.build(reference_, weight_);
  }

  /// Builds T with skins for which it follows the grains.
  /// @pre T was built without
  void give_skins(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    leaping_ = false;
    reach_ = {};
    spent_ = 0;
    for (int i = 0; i < size(); ++i) join(i);
    const auto place = [&](int i) -> Vec<Dim> { return x.col(i); };
    renew(place, radius,
          Eigen::VectorXd::Constant(size(), std::numeric_limits<double>::infinity()));
    t_.build(reference_, weight_);
    placed_.swap(moved_);
    certify(place, radius);
  }

  /// Whether what was spent on single grains since the last build would have paid for a leap: so
  /// the choice of mode costs at most about twice what the better one does.
  bool leap_is_due() const {
    return laziness_.leap && spent_ > kLeap * size();
  }

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
      build_without_skins(x, radius);
      give_skins(x, radius);
    }
  }

  /// Builds T anew with references where the grains are, and lists the pairs that meet.
  void leap(const Columns<Dim>& x, const Eigen::VectorXd& radius) {
    Eigen::VectorXd smallest = radius;  // around a grain, which a wider skin would hide
    for (const auto& [i, j] : t_.edges()) {
      smallest[i] = std::min(smallest[i], radius[j]);
      smallest[j] = std::min(smallest[j], radius[i]);
    }
    leaping_ = true;
    spent_ = 0;
    calm_ = 0;
    drift_.setZero();
    for (int i = 0; i < size(); ++i) {
      const double skin = kWideSkin * smallest[i];
      reference_.col(i) = x.col(i) + skin * aside_.col(i);
      set_skin(radius, i, (1 - 1e-6) * skin);
    }
    t_.build(reference_, weight_);
    reach_.build(t_, [&](int i) { return reference_ball(radius, i); });
    uncertain_.clear();
    ++cost_.leaps;
  }

  typename ReachList<Dim>::Ball reference_ball(const Eigen::VectorXd& radius, int i) const {
    return {reference_.col(i), radius[i] + skin_[i]};
  }

  /// Asks for no more margin than half a skin; a grain whose skin has no room for that joins
  /// moved_.
  void see_to(int i, const Vec<Dim>& x, Eigen::VectorXd& margin) {
    margin[i] = std::min(margin[i], 0.5 * skin_[i]);
    if (!(room(i, x) >= margin[i])) join(i);
  }

  /// Brings T up to date with the grains in moved_, and leaves all that have new references in
  /// placed_, with margins that these allow.
  template <class Place>
  void update(Place&& place, const Eigen::VectorXd& radius, Eigen::VectorXd& margin) {
    placed_.clear();
    if (moved_.empty()) return;
    ++cost_.updates;
    if (leaping_) {
      placed_.swap(moved_);
      for (const int i : placed_) {
        reference_.col(i) = place(i) - drift_;
        reach_.move(i, reference_ball(radius, i));
        state(i) = State::at_rest;
      }
      cost_.walks += static_cast<std::int64_t>(placed_.size());
      calm_ = 0;
      spent_ += static_cast<std::int64_t>(placed_.size()) *
                (kWalk + kComparison * static_cast<std::int64_t>(reach_.apart()));
    } else {
      renew(place, radius, margin);
      move_references();
      certify(place, radius);
    }
    for (const int i : placed_) margin[i] = std::min(margin[i], room(i, place(i)));
  }

  /// How far i may move before it leaves its skin; negative if it has, or is not a number.
  double room(int i, const Vec<Dim>& x) const {
    return skin_[i] * (1 - 1e-6) - (x - drift_ - reference_.col(i)).norm();
  }

  void join(int i) {
    state(i) = State::waiting;
    moved_.push_back(i);
  }

  void set_skin(const Eigen::VectorXd& radius, int i, double skin) {
    skin_[i] = skin;
    weight_[i] = (radius[i] + skin) * (radius[i] + skin);
  }

  /// Gives the grains in moved_ new references and skins. Neighbours whose own skins leave too
  /// little join moved_.
  template <class Place>
  void renew(Place&& place, const Eigen::VectorXd& radius, const Eigen::VectorXd& margin) {
    for (std::size_t k = 0; k < moved_.size(); ++k) {
      renew_one(place, radius, moved_[k], margin[moved_[k]]);
    }
  }

  /// The skin is the largest that the certificate allows against the neighbours in T as it stands,
  /// at their references, and that is fair to them at their present places. T will change: that the
  /// new edges pass too is only likely here, and seen to by certify().
  template <class Place>
  void renew_one(Place&& place, const Eigen::VectorXd& radius, int i, double margin) {
    const Vec<Dim> here = place(i) - drift_;
    const double r = radius[i];
    Vec<Dim> ahead = here - reference_.col(i);
    const double way = ahead.norm();
    ahead *= way > 0 ? 1 / way : 0;

    bounds_.clear();
    double smallest = r;
    double fair = kMostSkin * r;
    double centred = fair;  // allowed if the reference is put here
    t_.for_each_neighbour(i, [&](int j) {
      smallest = std::min(smallest, radius[j]);
      const double share =
          laziness_.skin * fair_skin(r, radius[j], (place(j) - drift_ - here).squaredNorm());
      fair = std::min(fair, share);
      if (state(j) == State::waiting) return;
      const Vec<Dim> away = here - reference_.col(j);
      const Bound bound{away.squaredNorm() - r * r - weight_[j], away.dot(ahead)};
      const double allowed = allowed_skin(r, 0, bound.slack);
      if (state(j) == State::at_rest && allowed < kTooLittle * share) {
        join(j);
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
    reference_.col(i) = here + (1 - 1e-6) * shift * ahead + skin * aside_.col(i);
    set_skin(radius, i, (1 - 1e-6) * skin);
    state(i) = State::placed;
  }

  /// A skin for each of two grains that passes whatever happens until one of them moves its
  /// reference to its true place: the other is off its own by at most its skin s then, and
  /// (distance - s)^2 = (a + s)^2 + (b + s)^2.
  static double fair_skin(double a, double b, double squared_distance) {
    const double slack = squared_distance - a * a - b * b;
    const double sum = a + b + std::sqrt(squared_distance);
    return slack > 0 ? std::sqrt(sum * sum + slack) - sum : 0;
  }

  /// The positive root s of (1 - share^2) s^2 + 2 b s = slack; 0 if there is none.
  static double allowed_skin(double b, double share, double slack) {
    if (!(slack > 0)) return 0;
    const double a = 1 - share * share;
    const double root = std::sqrt(b * b + a * slack);
    return b > 0 ? slack / (b + root) : (root - b) / a;
  }

  /// Tells T of the new references of moved_, and empties it into placed_.
  void move_references() {
    cost_.moved += static_cast<std::int64_t>(moved_.size());
    const UpdateReport report = t_.move(moved_, reference_, weight_);
    cost_.ladder += report;
    spent_ += kMove * static_cast<std::int64_t>(moved_.size()) + kExtraction * report.extracted +
              kLeap * size() * report.rebuilds;
    placed_.insert(placed_.end(), moved_.begin(), moved_.end());
    moved_.clear();
  }

  /// Whether the inflated spheres of an edge meet at less than a right angle.
  bool passes(int a, int b) const {
    const double squared = (reference_.col(a) - reference_.col(b)).squaredNorm();
    // One part in 10^12 covers the rounding of both sides.
    return squared > (weight_[a] + weight_[b]) * (1 + 1e-12);
  }

  /// Looks for edges that fail the certificate, and brings their ends up to date with skins that
  /// pass between grains of hardly any overlap. Ends of edges that fail again and again are
  /// uncertain.
  /// @param placed_  all grains with a new reference in this update; back at rest then
  template <class Place>
  void certify(Place&& place, const Eigen::VectorXd& radius) {
    // All edges passed before this update, unless some grains are uncertain: then, and if many
    // moved, look at all of them.
    const bool all = !uncertain_.empty() || placed_.size() > static_cast<std::size_t>(size()) / 16;
    uncertain_.clear();
    if (laziness_.certify) {
      for (int round = 0;; ++round) {
        failed_.clear();
        const auto look = [&](int a, int b) {
          if (passes(a, b)) return;
          failed_.push_back(a);
          failed_.push_back(b);
        };
        if (all || round > 0) {
          for (const auto& [a, b] : t_.edges()) look(a, b);
        } else {
          for (const int i : placed_) {
            t_.for_each_neighbour(i, [&](int j) { look(i, j); });
          }
          t_.for_each_new_edge(look);
        }
        sort_unique(failed_);
        if (failed_.empty()) break;
        if (round == kRounds) {
          uncertain_ = failed_;
          break;
        }
        cost_.shrunk += static_cast<std::int64_t>(failed_.size());
        for (const int i : failed_) {
          double smallest = radius[i];
          t_.for_each_neighbour(i, [&](int j) { smallest = std::min(smallest, radius[j]); });
          const double skin = kSmallSkin * smallest;
          reference_.col(i) = place(i) - drift_ + skin * aside_.col(i);
          set_skin(radius, i, skin);
        }
        moved_ = failed_;
        move_references();
      }
      const auto hidden = t_.hidden();
      uncertain_.insert(uncertain_.end(), hidden.begin(), hidden.end());
      sort_unique(uncertain_);
    }
    for (const int i : placed_) state(i) = State::at_rest;
  }

  static void sort_unique(std::vector<int>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  /// Weights are those of radii and skins; the references are T's sites, or, while T leaps, the
  /// balls that walks know; no grain waits.
  void audit_skins(const Eigen::VectorXd& radius, std::vector<std::string>& defects) const {
    for (int i = 0; i < size(); ++i) {
      const double inflated = radius[i] + skin_[i];
      bool sound = skin_[i] > 0 && weight_[i] == inflated * inflated &&
                   state_[static_cast<std::size_t>(i)] == State::at_rest;
      if (leaping_) {
        const auto ball = reference_ball(radius, i);
        sound =
            sound && reach_.ball(i).centre == ball.centre && reach_.ball(i).radius == ball.radius;
      } else {
        sound = sound && t_.site(i) == reference_.col(i) && t_.weight(i) == weight_[i];
      }
      if (!sound)
        defects.push_back("the reference of grain " + std::to_string(i) + " is not sound");
    }
    if (!moved_.empty()) defects.push_back("grains wait for new references");
  }

  /// Every pair of inflated reference spheres that meet is an edge, or has an uncertain end; and so
  /// has every edge that fails.
  void audit_certificate(const Eigen::VectorXd& radius, std::vector<std::string>& defects) const {
    if (!laziness_.certify) return;
    const auto uncertain = [&](int i) {
      return std::binary_search(uncertain_.begin(), uncertain_.end(), i);
    };
    for (const auto& [i, j] : t_.edges()) {
      if (passes(i, j) || (uncertain(i) && uncertain(j))) continue;
      defects.push_back("edge " + std::to_string(i) + " " + std::to_string(j) + " fails unseen");
    }
    const auto is_grain = [&](int i) { return i >= 0 && i < size(); };
    if (!std::all_of(uncertain_.begin(), uncertain_.end(), is_grain)) {
      defects.push_back("what is uncertain is no grain");
    }
    for (const int i : t_.hidden()) {
      if (!uncertain(i)) defects.push_back("grain " + std::to_string(i) + " is hidden unseen");
    }
    ContactSearch<Dim> search;
    for (const auto& [i, j] : search.find(reference_, radius + skin_)) {
      if (uncertain(i) || uncertain(j) ||
          std::ranges::binary_search(t_.edges(), EdgeList::Edge{i, j})) {
        continue;
      }
      defects.push_back("grains " + std::to_string(i) + " and " + std::to_string(j) +
                        " meet and are no edge");
    }
  }

  /// The edges of T within reach; or, while T leaps, the pairs of reference spheres that meet.
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
      filter(reach_.pairs());
      const auto added = static_cast<std::ptrdiff_t>(count);
      filter(reach_.added());
      std::sort(pairs.begin() + added, pairs.end());
      std::inplace_merge(pairs.begin(), pairs.begin() + added, pairs.end());
    } else {
      filter(t_.edges());
    }
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
  static constexpr double kMostSkin = 2;                     // of a grain's radius
  static constexpr double kLeastSkin = 0.02;                 // of the smallest radius around
  static constexpr double kSmallSkin = 0.24;                 // of the same: below (3 sqrt 2 - 4)
  static constexpr double kMostAhead = 0.7;                  // of a skin
  static constexpr double kTooLittle = 0.25;                 // of a fair share
  static constexpr double kHair = 1e-7;                      // of a skin
  static constexpr double kWideSkin = Dim == 2 ? 2.0 : 1.0;  // of the smallest radius around
  static constexpr double kFast = 0.01;  // of a radius, that a grain wants as margin
  static constexpr int kFewest = 10;     // of so many grains at most one is fast in a calm bed
  static constexpr int kCalm = 5;        // questions in which it is, and none left its skin
  /// Roughly what things cost [ns]: to move a reference in T, more if it had to be taken out; to
  /// find the partners of a grain by a walk, and to compare it with one that stands apart; and a
  /// leap, for each grain.
  static constexpr std::int64_t kMove = Dim == 2 ? 800 : 6000;
  static constexpr std::int64_t kExtraction = Dim == 2 ? 5000 : 90000;
  static constexpr std::int64_t kWalk = Dim == 2 ? 3000 : 8000;
  static constexpr std::int64_t kComparison = 2;
  static constexpr std::int64_t kLeap = Dim == 2 ? 3000 : 8000;

  Laziness laziness_;
  T t_;
  Columns<Dim> reference_;
  /// References stand aside by this times the skin, each in a direction of its own: so they are in
  /// general position even where grains lie on a lattice, and predicates need no exact arithmetic.
  Columns<Dim> aside_;
  Eigen::VectorXd weight_;  ///< (r + skin)^2
  Eigen::VectorXd skin_;
  Vec<Dim> drift_ = Vec<Dim>::Zero();  ///< of the grains against the references' frame [m]
  std::vector<int> uncertain_;         ///< grains whose pairs T may lack
  bool leaping_ = false;
  int calm_ = 0;                                    ///< questions since the bed was not
  ReachList<Dim> reach_;                            ///< while leaping
  std::vector<typename ReachList<Dim>::Ball> now_;  ///< scratch: grains with their margins
  std::int64_t spent_ = 0;                          ///< since the last build [ns], roughly
  TriangulationCost cost_;

  std::vector<State> state_;
  std::vector<int> moved_;   ///< to be moved in T
  std::vector<int> placed_;  ///< moved in this update
  std::vector<int> failed_;
  std::vector<Bound> bounds_;
};

}  // namespace lagrain
