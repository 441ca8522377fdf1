// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What walls with an end are made of: segments and arcs in the plane, plates and frusta in space.
/// A `Sheet` is many of them, with a tree that finds those near a place.

#include <lagrain/check.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace lagrain {

/// Walls meet where they come within this part of their size of each other, and what lies within it
/// of an edge or a corner counts as on it [-]. Rounding, and coordinates of seven digits, stay
/// below, and no grain feels a step of this height. With a tenth of it coordinates of seven digits
/// would leave joints open; ten times as much does the same.
inline constexpr double kSeam = 1e-6;

/// The part of a piece that its nearest point lies on: a corner, an edge (in space), or the inside
/// of its face. In order of their dimension.
enum class Feature { corner, edge, face };

/// A unit vector at a right angle to another one, the same for all of its multiples; the first unit
/// vector if that is zero.
template <int Dim>
Vec<Dim> any_normal(const Vec<Dim>& along) {
  if (along.isZero(0)) return Vec<Dim>::UnitX();
  Eigen::Index flattest = 0;
  along.cwiseAbs().minCoeff(&flattest);
  const Vec<Dim> n = Vec<Dim>::Unit(flattest);
  return (n - n.dot(along) / along.squaredNorm() * along).normalized();
}

// A piece has no thickness; what is straight has a front. Its places are relative to its wall's
// point, in the wall's own frame, which turns with it. Each has the same six functions.

/// A straight line in the plane.
class WallSegment {
 public:
  /// @param from, to  its ends [m]
  WallSegment(const Vec<2>& from, const Vec<2>& to) : from_(from), to_(to), along_(to - from) {}

  const Vec<2>& from() const { return from_; }    ///< its first end [m]
  const Vec<2>& to() const { return to_; }        ///< its second end [m]
  const Vec<2>& along() const { return along_; }  ///< from its first end to its second [m]
  /// Unit, to the left of the way from its first end to its second [-].
  Vec<2> front() const { return Vec<2>(-along_[1], along_[0]).normalized(); }

  /// The point of it that is nearest to x [m].
  Vec<2> nearest(const Vec<2>& x) const;
  /// A unit normal at one of its points [-].
  Vec<2> normal_at(const Vec<2>&) const { return any_normal<2>(along_); }
  /// What one of its points lies on, to a seam [m].
  Feature feature(const Vec<2>& foot, double seam) const;
  /// Its length from end to end, or its width [m].
  double size() const { return along_.norm(); }
  /// The ends or corners of a straight piece, the ends of an arc [m].
  std::vector<Vec<2>> corners() const { return {from_, to_}; }
  /// An axis-parallel box around it [m].
  Eigen::AlignedBox2d box() const { return Eigen::AlignedBox2d(from_).extend(to_); }

 private:
  Vec<2> from_, to_, along_;
};

/// An arc of a circle in the plane. A grain touches it at its nearest point alone: grains smaller
/// than the arc.
class Arc {
 public:
  /// @param from, through, to  three points of it in their order; the first and last are its ends
  /// @throws ContractError if they make no arc, see defect()
  Arc(const Vec<2>& from, const Vec<2>& through, const Vec<2>& to);
  /// Why three points make no arc: two on one spot, or all on a line. Empty if they make one.
  static std::string defect(const Vec<2>& from, const Vec<2>& through, const Vec<2>& to);

  const Vec<2>& from() const { return from_; }        ///< one end [m]
  const Vec<2>& through() const { return through_; }  ///< as it was given [m]
  const Vec<2>& to() const { return to_; }            ///< the other end [m]
  const Vec<2>& centre() const { return centre_; }    ///< of the circle [m]
  double radius() const { return radius_; }           ///< of the circle [m]

  /// The point of it that is nearest to x [m].
  Vec<2> nearest(const Vec<2>& x) const;
  /// A unit normal at one of its points [-].
  Vec<2> normal_at(const Vec<2>& foot) const { return (foot - centre_).normalized(); }
  /// What one of its points lies on, to a seam [m].
  Feature feature(const Vec<2>& foot, double seam) const;
  /// Its length from end to end, or its width [m].
  double size() const;
  /// The ends or corners of a straight piece, the ends of an arc [m].
  std::vector<Vec<2>> corners() const { return {from_, to_}; }
  /// An axis-parallel box around it [m].
  Eigen::AlignedBox2d box() const;

 private:
  /// How far along the arc a direction from its centre lies, in [0, 2 pi) [rad].
  double angle_along(const Vec<2>& arm) const;

  Vec<2> from_, through_, to_, centre_;
  double radius_ = 0;
  double start_ = 0;  // direction of the first end [rad]
  double turn_ = 1;   // 1: counter-clockwise, -1: clockwise
  double sweep_ = 0;  // angle from end to end [rad]
};

/// A flat convex polygon in space.
class Plate {
 public:
  /// @param corners  in their order around the plate [m]
  /// @throws ContractError if they make no plate, see defect()
  explicit Plate(std::vector<Vec<3>> corners);
  /// Why corners make no plate: fewer than three, two on one spot, not in one plane (to kSeam of
  /// the plate's size), or not convex. Empty if they make one.
  static std::string defect(const std::vector<Vec<3>>& corners);

  const std::vector<Vec<3>>& corners() const { return corners_; }  ///< as they were given [m]
  const Vec<3>& normal() const { return normal_; }  ///< unit; the corners turn left about it [-]
  const Vec<3>& front() const { return normal_; }   ///< the same

  /// The point of it that is nearest to x [m].
  Vec<3> nearest(const Vec<3>& x) const;
  /// A unit normal at one of its points [-].
  Vec<3> normal_at(const Vec<3>&) const { return normal_; }
  /// What one of its points lies on, to a seam [m].
  Feature feature(const Vec<3>& foot, double seam) const;
  /// Its length from end to end, or its width [m].
  double size() const { return size_; }
  /// An axis-parallel box around it [m].
  Eigen::AlignedBox3d box() const;

 private:
  std::vector<Vec<3>> corners_;
  Vec<3> normal_;
  double size_ = 0;
};

/// What a straight line sweeps that is turned about an axis: the side of a truncated cone. With
/// two equal radii it is a cylinder of finite length, without a height a ring; a ring whose inner
/// radius is 0 is a disc.
///
/// A grain touches it at its nearest point alone: small grains against round walls.
struct Frustum {
  Vec<3> base;             ///< on the axis, where it begins [m]
  Vec<3> axis;             ///< unit, from the base to the other end [-]
  double height = 0;       ///< along the axis [m]
  double low_radius = 0;   ///< at the base [m]
  double high_radius = 0;  ///< at the other end [m]

  /// Why numbers make no frustum; empty if they make one.
  std::string defect() const;

  /// The point of it that is nearest to x [m].
  Vec<3> nearest(const Vec<3>& x) const;
  /// A unit normal at one of its points [-].
  Vec<3> normal_at(const Vec<3>& foot) const;
  /// What one of its points lies on, to a seam [m].
  Feature feature(const Vec<3>& foot, double seam) const;
  /// Its length from end to end, or its width [m].
  double size() const;
  /// The ends or corners of a straight piece, the ends of an arc [m].
  std::vector<Vec<3>> corners() const { return {}; }
  /// An axis-parallel box around it [m].
  Eigen::AlignedBox3d box() const;
};

/// A piece of a wall with an end.
template <int Dim>
using WallPiece =
    std::conditional_t<Dim == 2, std::variant<WallSegment, Arc>, std::variant<Plate, Frustum>>;

/// Pieces that are one wall: a polyline, the facets of a mesh, or one piece alone. Copies of a
/// sheet share them.
template <int Dim>
class Sheet {
 public:
  using Box = Eigen::AlignedBox<double, Dim>;  ///< axis-parallel

  /// @throws ContractError without pieces
  explicit Sheet(std::vector<WallPiece<Dim>> pieces);

  /// All pieces, in the order in which they were given.
  const std::vector<WallPiece<Dim>>& pieces() const { return parts_->pieces; }
  const WallPiece<Dim>& piece(int k) const {  ///< piece number k
    return parts_->pieces[static_cast<std::size_t>(k)];
  }
  const Box& box() const { return parts_->box; }        ///< around all of them [m]
  double largest() const { return parts_->largest; }    ///< size of its largest piece [m]
  double smallest() const { return parts_->smallest; }  ///< size of its smallest piece [m]
  double extent() const { return parts_->extent; }      ///< no point is further from 0 [m]

  /// The pieces whose boxes are no further than `reach` from x, in increasing order, and perhaps
  /// some others.
  /// @param[out] found  what was there is lost
  void near(const Vec<Dim>& x, double reach, std::vector<int>& found) const;
  /// The piece that is nearest to x.
  int nearest_piece(const Vec<Dim>& x) const;

 private:
  struct Tree;
  struct Parts {
    std::vector<WallPiece<Dim>> pieces;
    Box box;
    double largest = 0, smallest = 0, extent = 0;
    std::shared_ptr<const Tree> tree;  // of the boxes; none where there are few
  };
  std::shared_ptr<const Parts> parts_;
};

extern template class Sheet<2>;
extern template class Sheet<3>;

}  // namespace lagrain
