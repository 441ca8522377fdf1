// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What is fast enough may cross another grain, or a wall, within one time step, and be apart from
/// it before and after: no search for contacts sees that. These functions find such passages.
///
/// Bound. Two grains whose places change by d against each other in a step, and that are apart
/// before and after, overlap in between by at most R - sqrt(R^2 - d^2/4) < d^2 / (7 R) for d < R,
/// where R is the sum of their radii, at least twice the smaller one. So nothing deeper than
/// (2 kSlow)^2 / 14, about 1 % of the smaller radius, is missed while no grain moves by more than
/// kSlow of the smallest radius in a step. Sound runs stay far below: a grain that moves so far in
/// a tenth of a contact would overlap by more than half of its radius where it hits. Faster grains
/// are looked at one by one.

#include <lagrain/check.hpp>
#include <lagrain/contact_rules.hpp>
#include <lagrain/contact_search.hpp>
#include <lagrain/golden_section.hpp>
#include <lagrain/vec.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace lagrain {

/// The way, of the smallest radius, that a grain may go in a step without being looked at [-]. At
/// twice this value the bound is four times as large.
inline constexpr double kSlow = 0.2;
/// The overlap, of the smaller radius, that has to be missed for a run to stop [-]: the bound.
inline constexpr double kMissed = 4 * kSlow * kSlow / 14;

/// The overlap [m] that is seen neither at the start nor at the end of a straight way, if it is
/// deep enough to matter; else 0.
/// @param distance  distance(s) [m] of what moves from its partner, at the part s in [0, 1] of its
///                  way; a convex or a concave function
/// @param reach     distance at which they touch [m]
/// @param radius    the smaller one [m]
template <class Distance>
double missed_overlap(Distance&& distance, double reach, double radius) {
  const double nearest = least_between(0, 1, distance);  // an end, if it is concave
  const double seen = std::max(0.0, reach - std::min(distance(0.0), distance(1.0)));
  const double missed = reach - distance(nearest) - seen;
  return missed > kMissed * radius ? missed : 0;
}

/// Watches for passages. While everything is slow this costs a comparison per grain and step. A few
/// fast grains, and each flat wall that is fast, take one look at all grains each; many fast grains
/// take a search with cells in each step.
template <int Dim>
class PassageWatch {
 public:
  PassageWatch() = default;  ///< watches nothing
  /// Watches nothing until it has met grains.
  /// @param walls  as they are at time t [s]
  PassageWatch(const std::vector<Wall<Dim>>& walls, double t) { remember(walls, t); }

  /// Takes note of the grains, or of their new slots.
  /// @param blocks           of slots, which may be noted from side by side
  /// @param smallest_radius  of all grains [m]; infinite: everything counts as slow
  void meet(std::size_t blocks, double smallest_radius) {
    slow_ = kSlow * smallest_radius;
    long_ways_.assign(blocks, {});
  }

  /// When it was looked last [s]: ways are counted from there.
  double since() const { return since_; }

  /// Notes a grain of a block that has gone far against the frame, which has moved by frame_way.
  void note(std::size_t block, int slot, const Vec<Dim>& from, const Vec<Dim>& to,
            const Vec<Dim>& frame_way) {
    const Vec<Dim> way = to - from - frame_way;
    if (way.squaredNorm() > slow_ * slow_) long_ways_[block].push_back({slot, from});
  }

  /// Ends the run if something has passed through something since it was looked last.
  /// @param count      number of grains
  /// @param record     record(slot), as the grains are now
  /// @param number     number(slot) of a grain
  /// @param rules      who touches whom, by slot
  /// @param t          time [s]
  /// @param frame_way  what the frame has moved by meanwhile [m]
  /// @param dt         time step [s]
  /// @throws SimulationError that names the two, the place and the time step that would do
  template <class RecordOf, class NumberOf>
  void expect_no_passage(int count, RecordOf&& record, NumberOf&& number,
                         const std::vector<Wall<Dim>>& walls, const ContactRules& rules, double t,
                         const Vec<Dim>& frame_way, double dt) {
    if (!std::isfinite(slow_)) return;
    Passage passage = find(count, record, walls, rules, t - since_, frame_way);
    for (auto& list : long_ways_) list.clear();
    remember(walls, t);
    if (passage.slot < 0) return;
    std::ostringstream message;
    message << "t = " << t << " s: grain " << number(passage.slot) << " passed through ";
    if (passage.wall >= 0) {
      message << "wall " << walls[static_cast<std::size_t>(passage.wall)].name;
    } else {
      message << "grain " << number(passage.other);
    }
    message << " near (";
    for (int d = 0; d < Dim; ++d) message << (d > 0 ? ", " : "") << passage.place[d];
    message << ") m: in one step it moved by " << passage.way
            << " m against it; a time step of at most " << dt * slow_ / passage.way
            << " s would see the contact (a stiffer law asks for a smaller step by itself)";
    throw SimulationError(message.str());
  }

 private:
  /// The way of a grain since it was looked last, too long to be left unseen.
  struct LongWay {
    int slot;
    Vec<Dim> from;
  };
  /// What crossed what.
  struct Passage {
    int slot = -1;                      // of the grain; -1: nothing crossed
    int other = -1;                     // slot of the other grain, or
    int wall = -1;                      // place of the wall
    Vec<Dim> place = Vec<Dim>::Zero();  // of the grain, halfway [m]
    double way = 0;                     // against the other one [m]
  };

  void remember(const std::vector<Wall<Dim>>& walls, double t) {
    since_ = t;
    wall_poses_.resize(walls.size());
    for (std::size_t w = 0; w < walls.size(); ++w) wall_poses_[w] = walls[w].pose();
  }

  template <class RecordOf>
  Passage find(int count, RecordOf&& record, const std::vector<Wall<Dim>>& walls,
               const ContactRules& rules, double tau, const Vec<Dim>& frame_way) const {
    // To second order, for a grain that is not fast.
    const auto start = [&](int slot) -> Vec<Dim> {
      return record(slot).position() - tau * record(slot).velocity();
    };
    std::vector<LongWay> fast;
    for (const auto& list : long_ways_) fast.insert(fast.end(), list.begin(), list.end());
    const auto look_at = [&](const LongWay& way, int other,
                             const Vec<Dim>& others_from) -> Passage {
      const auto& grain = record(way.slot);
      if (other == way.slot || !rules.may_touch({way.slot, other}) ||
          !crosses(grain, way.from, record(other), others_from)) {
        return {};
      }
      const double length =
          (grain.position() - way.from - record(other).position() + others_from).norm();
      const bool other_is_faster =
          record(other).velocity().squaredNorm() > grain.velocity().squaredNorm();
      if (other_is_faster)
        return {other, way.slot, -1, halfway(record(other), others_from), length};
      return {way.slot, other, -1, halfway(grain, way.from), length};
    };
    if (fast.size() <= kFew) {
      for (const LongWay& way : fast) {
        for (int other = 0; other < count; ++other) {
          Passage passage = look_at(way, other, start(other));
          if (passage.slot >= 0) return passage;
        }
      }
    } else {
      Passage passage = find_among_many(fast, count, record, start, frame_way, look_at);
      if (passage.slot >= 0) return passage;
    }
    for (const auto& [slot, from] : fast) {
      for (std::size_t w = 0; w < walls.size(); ++w) {
        Passage passage = through_wall(slot, record(slot), from, walls, w, rules);
        if (passage.slot >= 0) return passage;
      }
    }
    for (std::size_t w = 0; w < walls.size(); ++w) {
      if (!walls[w].pieces() || walls[w].way_since(wall_poses_[w], frame_way) <= slow_) continue;
      for (int slot = 0; slot < count; ++slot) {
        Passage passage = through_wall(slot, record(slot), start(slot), walls, w, rules);
        if (passage.slot >= 0) return passage;
      }
    }
    return {};
  }

  /// Where many are fast, a search for the balls around their ways that touch finds who may have
  /// met. Ways are seen from the frame.
  template <class RecordOf, class Start, class Look>
  static Passage find_among_many(const std::vector<LongWay>& fast, int count, RecordOf&& record,
                                 Start&& start, const Vec<Dim>& frame_way, Look&& look_at) {
    std::vector<Vec<Dim>> from;
    std::vector<bool> is_fast(static_cast<std::size_t>(count));
    for (int slot = 0; slot < count; ++slot) from.push_back(start(slot));
    for (const LongWay& way : fast) {
      from[static_cast<std::size_t>(way.slot)] = way.from;
      is_fast[static_cast<std::size_t>(way.slot)] = true;
    }
    Columns<Dim> middle(Dim, count);
    Eigen::VectorXd reach(count);
    for (int slot = 0; slot < count; ++slot) {
      const Vec<Dim> half =
          0.5 * (record(slot).position() - from[static_cast<std::size_t>(slot)] - frame_way);
      middle.col(slot) = record(slot).position() - half;
      reach[slot] = record(slot).radius() + half.norm();
    }
    ContactSearch<Dim> search;
    for (const auto [i, j] : search.find(middle, reach)) {
      if (!is_fast[static_cast<std::size_t>(i)] && !is_fast[static_cast<std::size_t>(j)]) continue;
      Passage passage = look_at(LongWay{i, from[static_cast<std::size_t>(i)]}, j,
                                from[static_cast<std::size_t>(j)]);
      if (passage.slot >= 0) return passage;
    }
    return {};
  }

  template <class Record>
  static Vec<Dim> halfway(const Record& grain, const Vec<Dim>& from) {
    return 0.5 * (grain.position() + from);
  }
  template <class Record>
  static bool crosses(const Record& grain, const Vec<Dim>& from, const Record& other,
                      const Vec<Dim>& others_from) {
    const Vec<Dim> start = from - others_from;
    const Vec<Dim> way = grain.position() - other.position() - start;
    const double reach = grain.radius() + other.radius();
    // Most are too far away: |start| > reach + |way|.
    if (start.squaredNorm() > 2 * (reach * reach + way.squaredNorm())) return false;
    return missed_overlap([&](double s) { return (start + s * way).norm(); }, reach,
                          std::min(grain.radius(), other.radius())) > 0;
  }
  /// A wall behind whose face all is solid, and a round one, are not passed through: overlaps tell.
  template <class Record>
  Passage through_wall(int slot, const Record& grain, const Vec<Dim>& from,
                       const std::vector<Wall<Dim>>& walls, std::size_t w,
                       const ContactRules& rules) const {
    const Wall<Dim>& wall = walls[w];
    if (!wall.pieces() || !rules.may_touch(slot, wall) || wall.lets_through(slot)) return {};
    // Seen from the wall, the grain ends where it is now.
    const Vec<Dim> to = grain.position();
    const Vec<Dim> way = to - wall.carried_along(wall_poses_[w], from);
    bool crosses = false;
    std::vector<int> found;
    wall.for_each_near(to, grain.radius() + way.norm(), found, [&](int piece) {
      if (wall.front_only && wall.in_front(piece, to - way) < 0) return;
      crosses =
          crosses ||
          missed_overlap([&](double s) { return wall.foot(piece, to - (1 - s) * way).distance; },
                         grain.radius(), grain.radius()) > 0;
    });
    if (!crosses) return {};
    return {slot, -1, static_cast<int>(w), halfway(grain, from), way.norm()};
  }

  /// Up to so many fast grains each is held against all others, more are searched for with cells.
  /// It was not tuned; nothing but speed depends on it.
  static constexpr std::size_t kFew = 10;

  double slow_ = std::numeric_limits<double>::infinity();  // way in which nothing is missed [m]
  double since_ = 0;                                       // when it was looked last [s]
  std::vector<WallPose<Dim>> wall_poses_;                  // where walls were then
  std::vector<std::vector<LongWay>> long_ways_;            // of each block
};

}  // namespace lagrain
