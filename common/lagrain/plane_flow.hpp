// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `PlaneFlow` counts the grains that pass through a plane.

#include <lagrain/check.hpp>
#include <lagrain/state.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace lagrain {

/// Counts what passes through a plane, in the plane a line, along its normal; what comes back is
/// taken off again. It looks at the grains now and then, and takes the way of a centre from look to
/// look as straight. A look just before grains leave counts them to the end, and one just after
/// others have come sees where those begin; they are known by their ids.
template <int Dim>
class PlaneFlow {
 public:
  using Box = Eigen::AlignedBox<double, Dim>;  ///< axis-parallel

  /// @param point   on the plane [m]
  /// @param normal  towards its front, unit
  /// @param within  only where a way meets the plane in this box [m] it counts; none: anywhere
  PlaneFlow(const Vec<Dim>& point, const Vec<Dim>& normal, std::optional<Box> within = {})
      : point_(point), normal_(normal), within_(within) {}

  /// Counts who has passed since the last look.
  /// @param ids   of all grains, in increasing order; empty while grain i has the id i
  /// @param x     their centres [m]
  /// @param mass  of each [kg]
  void look(const std::vector<int>& ids, const Columns<Dim>& x, const Eigen::VectorXd& mass) {
    std::vector<Place> now;
    now.reserve(static_cast<std::size_t>(x.cols()));
    auto before = places_.cbegin();
    for (int i = 0; i < static_cast<int>(x.cols()); ++i) {
      const int id = ids.empty() ? i : ids[static_cast<std::size_t>(i)];
      now.push_back({id, x.col(i)});
      while (before != places_.cend() && before->id < id) ++before;
      if (before == places_.cend() || before->id != id) continue;
      const int passage = passage_on(before->x, x.col(i));
      grains_ += passage;
      mass_ += passage * mass[i];
    }
    places_.swap(now);
  }

  /// Grains that have passed towards the front, less those that have passed back.
  std::int64_t grains() const { return grains_; }
  double mass() const { return mass_; }  ///< the same for their mass [kg]

  /// Keeps or restores what it has seen.
  /// @throws SceneError if the state holds no such flow
  void persist(StateVisitor visit) {
    std::vector<int> ids;
    Columns<Dim> x(Dim, static_cast<Eigen::Index>(places_.size()));
    for (const Place& place : places_) {
      x.col(static_cast<Eigen::Index>(ids.size())) = place.x;
      ids.push_back(place.id);
    }
    visit("ids", ids);
    visit("places", x);
    visit("grains", grains_);
    visit("mass", mass_);
    if (x.cols() != static_cast<Eigen::Index>(ids.size())) {
      throw SceneError("the grains at a plane do not fit together");
    }
    places_.clear();
    for (const int id : ids)
      places_.push_back({id, x.col(static_cast<Eigen::Index>(places_.size()))});
  }

 private:
  struct Place {
    int id;
    Vec<Dim> x;
  };

  /// Whether a way leads to the front (1), back (-1), or neither. The plane belongs to the front.
  int passage_on(const Vec<Dim>& from, const Vec<Dim>& to) const {
    const double a = normal_.dot(from - point_), b = normal_.dot(to - point_);
    if ((a >= 0) == (b >= 0)) return 0;
    if (within_ && !within_->contains(Vec<Dim>(from + a / (a - b) * (to - from)))) return 0;
    return b >= 0 ? 1 : -1;
  }

  Vec<Dim> point_, normal_;
  std::optional<Box> within_;
  std::vector<Place> places_;  // at the last look
  std::int64_t grains_ = 0;
  double mass_ = 0;
};

}  // namespace lagrain
