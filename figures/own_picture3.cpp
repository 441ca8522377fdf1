// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres, forces, walls and the triangulation of a state as a scene in space.

#include "own_picture.hpp"

#include <lagrain/laguerre3.hpp>
#include <lagrain/style.hpp>
#include <lagrain/wall_shapes.hpp>

#include <cmath>
#include <numbers>

namespace lagrain::figures {
namespace {

constexpr double kSmallGrain = 0.3;  // of its radius: so that lines between centres are seen
constexpr Colour kGlass{120, 150, 180, 30};

using Polygon3 = std::vector<Vec<3>>;

/// Adds what is drawn of walls.
class WallPainter {
 public:
  WallPainter(Scene3& space, const PictureScale<3>& scale, const Vec<3>& sight,
              const std::vector<Wall<3>>& walls)
      : space_(space), window_(scale.window), sight_(sight), walls_(walls) {}

  void add_all() {
    for (const Wall<3>& wall : walls_) {
      if (wall.gone) continue;
      if (const auto* plane = std::get_if<HalfSpace<3>>(&wall.shape)) {
        add_half_space(wall, plane->normal);
      } else if (const auto* round = std::get_if<Cylinder<3>>(&wall.shape)) {
        round->axis.isZero(0) ? add_ball(wall, round->radius) : add_tube(wall, *round);
      } else {
        add_pieces(wall);
      }
    }
  }

  void add_outline(const Polygon3& polygon) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      space_.lines.push_back({polygon[k], polygon[(k + 1) % polygon.size()], kLine});
    }
  }

 private:
  static constexpr Stroke kLine{style::kWall, style::kMedium};

  void add_pane(const Polygon3& p) {
    for (std::size_t k = 1; k + 1 < p.size(); k += 2) {
      space_.panes.push_back({{p[0], p[k], p[k + 1], p[std::min(k + 2, p.size() - 1)]}, kGlass});
    }
  }
  /// Glass is seen only behind the grains.
  void add_face(const Polygon3& polygon, const Vec<3>& normal) {
    if (polygon.size() < 3) return;
    if (normal.dot(sight_) < -1e-9) add_pane(polygon);
  }

  void add_half_space(const Wall<3>& wall, const Vec<3>& normal) {
    const Vec<3> u = any_normal<3>(normal), v = normal.cross(u);
    const Vec<3> middle = window_.center() - normal.dot(window_.center() - wall.point) * normal;
    const double reach = 2 * window_.diagonal().norm(), slack = 1e-6 * reach;
    Polygon3 face{middle - reach * u - reach * v, middle + reach * u - reach * v,
                  middle + reach * u + reach * v, middle - reach * u + reach * v};
    for (int d = 0; d < 3; ++d) {
      face = clipped(face, Vec<3>::Unit(d), window_.min(), slack);
      face = clipped(face, -Vec<3>::Unit(d), window_.max(), slack);
    }
    for (const Wall<3>& other : walls_) {
      const auto* plane = std::get_if<HalfSpace<3>>(&other.shape);
      if (plane != nullptr && &other != &wall && !other.gone) {
        face = clipped(face, plane->normal, other.point, slack);
      }
      // The end of a drum is round: the half-space is seen within it.
      const auto* round = std::get_if<Cylinder<3>>(&other.shape);
      if (round == nullptr || round->axis.isZero(0)) continue;
      if (std::abs(round->axis.dot(normal)) < 1 - 1e-9) continue;
      const Vec<3> centre = other.point + normal.dot(wall.point - other.point) * normal;
      face = circle(centre, normal, round->radius);
    }
    if (face.size() < 3) return;
    add_outline(face);
    add_face(face, normal);
  }

  static Polygon3 circle(const Vec<3>& centre, const Vec<3>& axis, double radius) {
    const Vec<3> u = any_normal<3>(axis), v = axis.cross(u);
    Polygon3 points;
    for (int k = 0; k < kFacets; ++k) {
      const double a = 2 * std::numbers::pi * k / kFacets;
      points.push_back(centre + radius * (std::cos(a) * u + std::sin(a) * v));
    }
    return points;
  }

  /// The surface between two circles that have equally many points.
  void add_side(const Polygon3& low, const Polygon3& high, const Vec<3>& on_axis,
                const Vec<3>& axis) {
    add_outline(low);
    add_outline(high);
    std::vector<bool> behind;
    for (std::size_t k = 0; k < low.size(); ++k) {
      const std::size_t next = (k + 1) % low.size();
      const Vec<3> middle = 0.25 * (low[k] + low[next] + high[k] + high[next]);
      const Vec<3> arm = middle - on_axis;
      const Vec<3> inwards = arm.dot(axis) * axis - arm;
      behind.push_back(inwards.dot(sight_) < 0);
      if (behind.back()) add_pane({low[k], low[next], high[next], high[k]});
    }
    // Where the side turns away from the viewer.
    for (std::size_t k = 0; k < low.size(); ++k) {
      if (behind[k] != behind[(k + low.size() - 1) % low.size()]) {
        space_.lines.push_back({low[k], high[k], kLine});
      }
    }
  }

  void add_tube(const Wall<3>& wall, const Cylinder<3>& round) {
    const Vec<3>& axis = round.axis;
    const double middle = axis.dot(window_.center() - wall.point);
    const double reach = 0.5 * axis.cwiseAbs().dot(window_.sizes());
    double from = middle - reach, to = middle + reach;
    for (const Wall<3>& other : walls_) {
      const auto* plane = std::get_if<HalfSpace<3>>(&other.shape);
      if (plane == nullptr || other.gone) continue;
      const double along = plane->normal.dot(axis);
      if (std::abs(along) < 1 - 1e-9) continue;
      const double at = axis.dot(other.point - wall.point);
      if (along > 0) from = std::max(from, at);
      if (along < 0) to = std::min(to, at);
    }
    if (!(from < to)) return;
    add_side(circle(wall.point + from * axis, axis, round.radius),
             circle(wall.point + to * axis, axis, round.radius), wall.point, axis);
  }

  void add_ball(const Wall<3>& wall, double radius) {
    for (int d = 0; d < 3; ++d) add_outline(circle(wall.point, Vec<3>::Unit(d), radius));
    add_outline(circle(wall.point, sight_, radius));
  }

  void add_pieces(const Wall<3>& wall) {
    // Of a fine mesh all edges would be a black surface.
    constexpr std::size_t kFew = 60;
    const WallPose<3> pose = wall.pose();
    const auto& pieces = wall.pieces()->pieces();
    for (const WallPiece<3>& piece : pieces) {
      if (const auto* plate = std::get_if<Plate>(&piece)) {
        Polygon3 corners = plate->corners();
        for (Vec<3>& c : corners) c = pose.point + pose.frame * c;
        if (pieces.size() <= kFew) add_outline(corners);
        add_pane(corners);
        continue;
      }
      const auto& frustum = std::get<Frustum>(piece);
      const Vec<3> axis = pose.frame * frustum.axis;
      const Vec<3> base = pose.point + pose.frame * frustum.base;
      add_side(circle(base, axis, frustum.low_radius),
               circle(base + frustum.height * axis, axis, frustum.high_radius), base, axis);
    }
  }

  Scene3& space_;
  const Eigen::AlignedBox3d& window_;
  Vec<3> sight_;
  const std::vector<Wall<3>>& walls_;
};

/// Whether a place has been taken out.
bool is_cut(const Vec<3>& x, const std::vector<Cut>& cuts) {
  for (const Cut& c : cuts) {
    if (c.normal.dot(x) > c.offset) return true;
  }
  return false;
}

}  // namespace

Scene3 space_of(const Scene<3>& scene, const Snapshot<3>& snapshot, const PictureWish& wish,
                const PictureScale<3>& scale) {
  const Frame<3>& frame = snapshot.frame;
  const auto n = frame.position.cols();
  Scene3 space;
  space.subframes = wish.subframes;
  space.cuts = wish.cuts;
  const bool inside = wish.forces || wish.cells || wish.edges;
  if (wish.grains) {
    const std::vector<Colour> colours = grain_colours(snapshot, wish, scale);
    for (Eigen::Index i = 0; i < n; ++i) {
      space.balls.push_back({frame.position.col(i), (inside ? kSmallGrain : 1) * frame.radius[i],
                             colours[static_cast<std::size_t>(i)]});
    }
  }
  if (wish.forces) {
    for (const ContactRecord<3>& c : *snapshot.contacts) {
      const Vec<3> from = frame.position.col(c.i);
      const Vec<3> to = c.j >= 0 ? Vec<3>(frame.position.col(c.j))
                                 : Vec<3>(from - (frame.radius[c.i] - c.overlap) * c.normal);
      const double share = std::min(c.force.norm() / scale.strongest, 1.0);
      space.tubes.push_back({from, to, 0.5 * share * scale.thickest()});
    }
  }
  if ((wish.cells || wish.edges) && n > 0) {
    Triangulation<3> triangulation;
    triangulation.build(frame.position, frame.radius.array().square().matrix());
    if (wish.edges) {
      triangulation.for_each_edge([&](int i, int j) {
        const Vec<3> a = frame.position.col(i), b = frame.position.col(j);
        if (!is_cut(0.5 * (a + b), wish.cuts)) space.lines.push_back({a, b, style::kEdgeLine});
      });
    }
    for (int i = 0; wish.cells && i < triangulation.size(); ++i) {
      for (const LaguerreFace& face : laguerre_cell(triangulation, i, scale.window)) {
        // Each face between two cells once.
        if (face.beyond >= 0 && face.beyond < i) continue;
        for (Eigen::Index k = 0; k < face.corners.cols(); ++k) {
          const Vec<3> a = face.corners.col(k), b = face.corners.col((k + 1) % face.corners.cols());
          if (!is_cut(0.5 * (a + b), wish.cuts)) space.lines.push_back({a, b, style::kCellLine});
        }
      }
    }
  }
  if (!wish.walls) return space;
  WallPainter(space, scale, line_of_sight(wish.view), snapshot.walls).add_all();
  const auto add_region = [&](const Region<3>& region) {
    const Eigen::AlignedBox3d box =
        Eigen::AlignedBox3d(region.low, region.high).intersection(scale.window);
    if (!box.isEmpty()) {
      add_edges(space, {box.min(), box.max()}, {style::kFaint, style::kThin});
    }
  };
  for (const auto& inlet : scene.inlets) add_region(inlet.region);
  for (const auto& outlet : scene.outlets) add_region(outlet.region);
  for (const Wall<3>& wall : snapshot.walls) {
    const auto* plane = std::get_if<HalfSpace<3>>(&wall.shape);
    if (plane == nullptr || wall.gone || plane->normal[2] < 0.9) continue;
    space.floor = Floor{plane->normal.dot(wall.point), plane->normal};
  }
  return space;
}

}  // namespace lagrain::figures
