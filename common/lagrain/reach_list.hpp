// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `ReachList` lists all pairs of balls that meet, found by walks along the edges of a
/// regular triangulation.

#include <lagrain/contact_search.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/triangulation.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

namespace lagrain {

/// All pairs of balls that meet, however deeply, by ball. It is made from the regular triangulation
/// T of the balls' centres c_k with their squared radii as weights; later, single balls may move
/// while T stays as it is.
///
/// **Theorem.** Let Q be a convex set that the balls of T cover. Then the sites of T whose balls
/// meet Q are connected in T.
///
/// Proof. P_k(x) = |x - c_k|^2 - r_k^2 is the power of x, and m(x) the site where it is least: x
/// lies in the cell of m(x). For x in Q that power is not positive, because x lies in some ball; so
/// x lies in the ball of m(x), which therefore meets Q. While x runs through Q, m(x) changes to
/// adjacent cells only (a path may avoid where more than two cells meet), that is along edges of T:
/// all m(x) are connected. Any other site j whose ball meets Q holds a point x of Q, but not in its
/// own cell: then an edge leads from j to a site k with P_k(x) < P_j(x) <= 0, whose ball holds x as
/// well, and so on down to m(x).
///
/// - With Q = B_i, a walk from i over the balls that meet B_i finds them all.
/// - T is also the triangulation of the balls with squared radii r_k^2 + L, for any L. Let b be the
///   site nearest to a ball Q that has come from elsewhere, and L such that the ball of b, enlarged
///   so, holds Q. Then a walk from b over the enlarged balls that meet Q finds all that meet it.
/// - Q becomes a *guest* of b. Another such ball that meets Q meets the enlarged ball of b: its
///   walk finds b, and there Q, if its own L is no smaller.
///
/// Balls that are hidden from T, or far from all sites, are compared with all others.
template <int Dim>
class ReachList {
 public:
  /// A ball by its centre and radius.
  struct Ball {
    Vec<Dim> centre;  ///< [m]
    double radius;    ///< [m]
  };

  /// Lists the pairs of n balls anew.
  /// @param t     regular for the balls
  /// @param ball  ball(i)
  template <RegularTriangulation<Dim> T, class BallOf>
  void build(T& t, BallOf&& ball) {
    const int n = t.size();
    balls_.resize(index(n));
    for (int i = 0; i < n; ++i) balls_[index(i)] = ball(i);
    sites_ = balls_;
    stamps_.assign(index(n), 0);
    stamp_ = 0;
    more_.resize(index(n));
    for (auto& list : more_) list.clear();
    added_.clear();
    list_edges(t.edges(), n);
    first_guest_.assign(index(n), -1);
    guests_.clear();
    widest_ = 0;
    apart_.assign(t.hidden().begin(), t.hidden().end());
    if (edge_ends_.empty()) {  // nowhere to walk
      apart_.resize(index(n));
      std::iota(apart_.begin(), apart_.end(), 0);
    }

    first_.assign(1, 0);
    partners_.clear();
    pairs_.clear();
    for (int i = 0; i < n; ++i) {
      met_.clear();
      if (!neighbours(i).empty()) walk(i, i, 0);
      partners_.insert(partners_.end(), met_.begin(), met_.end());
      first_.push_back(partners_.size());
      const auto listed = static_cast<std::ptrdiff_t>(pairs_.size());
      for (const int j : met_) {
        if (j > i) pairs_.push_back({i, j});
      }
      std::sort(pairs_.begin() + listed, pairs_.end());
    }
    for (const int i : apart_) {
      stamp_partners(i);
      for (int j = 0; j < n; ++j) link_if_met(i, j);
    }
  }

  /// Adds the partners of a ball that has moved; those that it has left stay listed.
  void move(int i, const Ball& ball) {
    balls_[index(i)] = ball;
    met_.clear();
    if (!edge_ends_.empty()) {
      const int base = nearest(i);
      const Ball& b = sites_[index(base)];
      const double far = (ball.centre - b.centre).norm() + ball.radius;
      const double enlarged = std::max(0.0, (far - b.radius) * (far + b.radius));
      walk(i, base, std::max(enlarged, widest_));
      if (enlarged > kWidest * b.radius * b.radius) {
        apart_.push_back(i);
      } else {
        widest_ = std::max(widest_, enlarged);
        guests_.push_back({i, first_guest_[index(base)]});
        first_guest_[index(base)] = static_cast<int>(guests_.size()) - 1;
      }
    }
    stamp_partners(i);
    for (const int j : met_) link_if_met(i, j);
    for (const int j : apart_) link_if_met(i, j);
  }

  /// Where ball i is now.
  const Ball& ball(int i) const { return balls_[index(i)]; }
  /// How many balls are compared with each one that moves.
  std::size_t apart() const { return apart_.size(); }

  /// The pairs that met when the list was built, in increasing order.
  std::span<const Pair> pairs() const { return pairs_; }
  /// Those that balls have added since by moving, in no order. None is there twice.
  std::span<const Pair> added() const { return added_; }
  /// Calls f(j) for the partner j of i in each of them, in no order.
  template <class F>
  void for_each_partner(int i, F&& f) const {
    for (std::size_t k = first_[index(i)]; k < first_[index(i) + 1]; ++k) f(partners_[k]);
    for (const int j : more_[index(i)]) f(j);
  }

  /// Checks the list against a search from nothing, and what is kept for walks; empty means valid.
  /// @param t  as in build()
  template <RegularTriangulation<Dim> T>
  std::vector<std::string> audit(const T& t) const {
    std::vector<std::string> defects;
    const auto is_ball = [&](int i) { return i >= 0 && index(i) < balls_.size(); };
    if (sites_.size() != balls_.size() || stamps_.size() != balls_.size() ||
        first_.size() != balls_.size() + 1 || first_.back() != partners_.size() ||
        !std::is_sorted(first_.begin(), first_.end()) ||
        !std::all_of(apart_.begin(), apart_.end(), is_ball)) {
      return {"the parts of the list do not fit together"};
    }
    audit_pairs(defects);
    audit_guests(defects);
    ReachList anew;
    std::vector<EdgeList::Edge> edges;
    t.for_each_edge([&](int i, int j) { edges.push_back({i, j}); });
    anew.list_edges(edges, t.size());
    if (anew.first_edge_ != first_edge_ || anew.edge_ends_ != edge_ends_) {
      defects.push_back("the edges are not those of T");
    }
    for (int k = 0; k < t.size(); ++k) {
      const Ball& site = sites_[index(k)];
      if (site.centre == t.site(k) && site.radius * site.radius == t.weight(k)) continue;
      defects.push_back("site " + std::to_string(k) + " is not that of T");
    }
    const auto known = [&](int i) {
      return edge_ends_.empty() || std::find(apart_.begin(), apart_.end(), i) != apart_.end();
    };
    if (!std::all_of(t.hidden().begin(), t.hidden().end(), known)) {
      defects.push_back("a hidden ball is not compared with all others");
    }
    if (std::any_of(stamps_.begin(), stamps_.end(), [&](auto stamp) { return stamp > stamp_; })) {
      defects.push_back("a stamp is ahead of its time");
    }
    return defects;
  }

 private:
  friend struct AuditProbe;
  /// Part of a squared distance: what touches by no more than rounding is taken for meeting.
  static constexpr double kRounding = 1 + 1e-9;
  /// The largest L of a guest, in squared radii of the site that it is nearest to. A ball that asks
  /// for more is compared with all others instead, because it would make all walks long. It changes
  /// no result: half as much sends more balls to be compared, twice as much makes walks longer.
  static constexpr double kWidest = 1.5;

  struct Guest {
    int ball;
    int next;  ///< of the same site; -1 for none
  };

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  static bool meet(const Ball& a, const Ball& b) {
    const double reach = a.radius + b.radius;
    return (a.centre - b.centre).squaredNorm() <= kRounding * reach * reach;
  }

  std::span<const int> neighbours(int k) const {
    const std::size_t first = first_edge_[index(k)];
    return std::span(edge_ends_).subspan(first, first_edge_[index(k) + 1] - first);
  }

  void next_stamp() {
    if (++stamp_ != 0) return;
    std::fill(stamps_.begin(), stamps_.end(), 0);
    stamp_ = 1;
  }

  /// Stamps i and its partners.
  void stamp_partners(int i) {
    next_stamp();
    stamps_[index(i)] = stamp_;
    for_each_partner(i, [&](int j) { stamps_[index(j)] = stamp_; });
  }

  /// Makes j a partner of i if their balls meet, unless j is stamped as one already.
  void link_if_met(int i, int j) {
    if (stamps_[index(j)] == stamp_ || !meet(balls_[index(i)], balls_[index(j)])) return;
    stamps_[index(j)] = stamp_;
    more_[index(i)].push_back(j);
    more_[index(j)].push_back(i);
    added_.push_back({std::min(i, j), std::max(i, j)});
  }

  /// Checks that all pairs that meet are listed, none twice, and that each ball knows its partners.
  void audit_pairs(std::vector<std::string>& defects) const {
    const auto count = static_cast<Eigen::Index>(balls_.size());
    std::vector<Pair> listed(pairs_.begin(), pairs_.end());
    if (!std::is_sorted(listed.begin(), listed.end())) defects.push_back("pairs are not sorted");
    listed.insert(listed.end(), added_.begin(), added_.end());
    std::sort(listed.begin(), listed.end());
    if (std::adjacent_find(listed.begin(), listed.end()) != listed.end()) {
      defects.push_back("a pair is listed twice");
    }
    std::vector<Pair> ends, partners;  // each pair from both ends
    for (const Pair& pair : listed) ends.insert(ends.end(), {pair, {pair.j, pair.i}});
    for (int i = 0; i < count; ++i) {
      for_each_partner(i, [&](int j) { partners.push_back({i, j}); });
    }
    std::sort(ends.begin(), ends.end());
    std::sort(partners.begin(), partners.end());
    if (ends != partners) defects.push_back("partners are not those of the pairs");

    Columns<Dim> centre(Dim, count);
    Eigen::VectorXd radius(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      centre.col(i) = balls_[static_cast<std::size_t>(i)].centre;
      radius[i] = balls_[static_cast<std::size_t>(i)].radius;
    }
    ContactSearch<Dim> search;
    for (const Pair& pair : search.find(centre, radius)) {
      if (std::binary_search(listed.begin(), listed.end(), pair)) continue;
      defects.push_back("balls " + std::to_string(pair.i) + " and " + std::to_string(pair.j) +
                        " meet and are not listed");
    }
  }

  /// Checks that a ball that has moved is compared with all others, or is a guest of a site whose
  /// ball holds it when enlarged by widest_.
  void audit_guests(std::vector<std::string>& defects) const {
    std::vector<char> held(balls_.size(), 0);
    for (const int i : apart_) held[index(i)] = 1;
    std::size_t met = 0;
    for (std::size_t site = 0; site < sites_.size(); ++site) {
      const Ball &b = sites_[site], &now = balls_[site];
      if (b.centre == now.centre && b.radius == now.radius) held[site] = 1;
      const double wide = std::sqrt(b.radius * b.radius + widest_) * kRounding;
      for (int g = first_guest_[site]; g >= 0 && met <= guests_.size();
           g = guests_[index(g)].next) {
        ++met;
        const Ball& guest = balls_[index(guests_[index(g)].ball)];
        // It may have gone on since, to another site.
        if ((guest.centre - b.centre).norm() + guest.radius <= wide)
          held[index(guests_[index(g)].ball)] = 1;
      }
    }
    if (met != guests_.size()) defects.push_back("guests are lost");
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (held[i] == 0) defects.push_back("ball " + std::to_string(i) + " is nobody's guest");
    }
  }

  /// Finds a site of T near the ball of i: it goes down the power of the ball's centre, along
  /// edges. (Rounding may stop it early: any site would do.)
  int nearest(int i) const {
    const Vec<Dim>& x = balls_[index(i)].centre;
    const auto power = [&](int k) {
      const Ball& site = sites_[index(k)];
      return (x - site.centre).squaredNorm() - site.radius * site.radius;
    };
    int at = neighbours(i).empty() ? edge_ends_.front() : i;
    double least = power(at);
    for (bool descending = true; descending;) {
      descending = false;
      for (const int k : neighbours(at)) {
        const double p = power(k);
        if (p >= least) continue;
        least = p;
        at = k;
        descending = true;
      }
    }
    return at;
  }

  /// Fills met_ with the sites, but i, whose balls meet that of i; if balls are enlarged also with
  /// guests, and perhaps with others.
  /// @param from      where to begin
  /// @param enlarged  added to all squared radii, so that the ball at `from` holds that of i [m^2]
  void walk(int i, int from, double enlarged) {
    const Ball q = balls_[index(i)];
    next_stamp();
    way_.assign(1, from);
    stamps_[index(from)] = stamp_;
    for (std::size_t k = 0; k < way_.size(); ++k) {
      const int at = way_[k];
      if (at != i) met_.push_back(at);
      for (int g = first_guest_[index(at)]; g >= 0; g = guests_[index(g)].next) {
        met_.push_back(guests_[index(g)].ball);
      }
      for (const int j : neighbours(at)) {
        if (stamps_[index(j)] == stamp_) continue;
        stamps_[index(j)] = stamp_;
        Ball site = sites_[index(j)];
        if (enlarged > 0) site.radius = std::sqrt(site.radius * site.radius + enlarged);
        if (meet(q, site)) way_.push_back(j);
      }
    }
  }

  /// Lists the ends of the edges at each site, side by side.
  void list_edges(std::span<const EdgeList::Edge> edges, int sites) {
    first_edge_.assign(index(sites) + 2, 0);
    for (const auto& edge : edges) {
      for (const int i : edge) ++first_edge_[index(i) + 2];
    }
    for (std::size_t i = 2; i < first_edge_.size(); ++i) first_edge_[i] += first_edge_[i - 1];
    edge_ends_.resize(2 * edges.size());
    for (const auto& [i, j] : edges) {
      edge_ends_[first_edge_[index(i) + 1]++] = j;
      edge_ends_[first_edge_[index(j) + 1]++] = i;
    }
  }

  std::vector<Ball> balls_;
  std::vector<Pair> pairs_, added_;
  std::vector<std::size_t> first_;  // of each ball's partners in pairs_
  std::vector<int> partners_;
  std::vector<std::vector<int>> more_;  // in added_

  // T, and what it does not know.
  std::vector<Ball> sites_;
  std::vector<std::size_t> first_edge_;
  std::vector<int> edge_ends_;
  std::vector<int> first_guest_;  // of each site
  std::vector<Guest> guests_;
  double widest_ = 0;  // L of the guests [m^2]
  std::vector<int> apart_;

  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
  std::vector<int> met_, way_;
};

}  // namespace lagrain
