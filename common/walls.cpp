// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/walls.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace lagrain {

namespace {

/// The seam of a surface is at most this part of its smallest wall [-], however large the others
/// are. It was not tuned: it only has to be small.
constexpr double kSmall = 1e-3;

/// The seam of a surface is at least this part of its largest wall [-], however small the others
/// are: what rounding moves a foot by stays below. A piece that is smaller is no more than a corner
/// of its neighbours. It was not tuned: a tenth or ten times of it do the same.
constexpr double kRounding = 1e-12;

/// Feet this close to each other are on the joint of two walls, or on both of two that lie on
/// each other.
template <int Dim>
double seam_of(const Wall<Dim>& a, const Wall<Dim>& b) {
  double largest = 0;
  for (const Wall<Dim>* wall : {&a, &b}) {
    if (const Sheet<Dim>* sheet = wall->pieces()) largest = std::max(largest, sheet->largest());
  }
  return kSeam * largest;
}

/// Whether a box comes within a seam of the surface of a wall without an end.
template <int Dim>
bool reaches(const Eigen::AlignedBox<double, Dim>& box, const Wall<Dim>& wall, double seam) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 1 << Dim; ++k) {
    least = std::min(
        least,
        wall.foot(0,
                  box.corner(static_cast<typename Eigen::AlignedBox<double, Dim>::CornerType>(k)))
            .distance);
  }
  return least <= seam;
}

/// Whether the boxes around two walls overlap, or come within a seam of each other; a wall without
/// an end has no box.
template <int Dim>
bool may_meet(const Wall<Dim>& a, const Wall<Dim>& b) {
  if (!a.pieces() && !b.pieces()) return false;
  const double seam = seam_of(a, b);
  if (!a.pieces()) return reaches(b.box(), a, seam);
  if (!b.pieces()) return reaches(a.box(), b, seam);
  return a.box().exteriorDistance(b.box()) <= seam;
}

}  // namespace

template <int Dim>
void join_walls(std::vector<Wall<Dim>>& walls) {
  const std::size_t n = walls.size();
  std::vector<std::vector<std::size_t>> partners(n);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      const bool may_come_to_meet =
          (walls[a].pieces() || walls[b].pieces()) && (walls[a].moves() || walls[b].moves());
      if (!may_come_to_meet && !may_meet(walls[a], walls[b])) continue;
      partners[a].push_back(b);
      partners[b].push_back(a);
    }
    walls[a].joined = !partners[a].empty() || walls[a].piece_count() > 1 || walls[a].front_only;
    walls[a].uneven = walls[a].turns() || walls[a].runs();
  }
  // Walls that hang together share one seam, so that each of them judges a joint alike.
  std::vector<bool> seen(n);
  for (std::size_t first = 0; first < n; ++first) {
    if (seen[first] || !walls[first].joined) continue;
    std::vector<std::size_t> surface{first};
    seen[first] = true;
    double smallest = std::numeric_limits<double>::infinity(), largest = 0;
    for (std::size_t k = 0; k < surface.size(); ++k) {
      if (const Sheet<Dim>* sheet = walls[surface[k]].pieces()) {
        smallest = std::min(smallest, sheet->smallest());
        largest = std::max(largest, sheet->largest());
      }
      for (const std::size_t next : partners[surface[k]]) {
        if (seen[next]) continue;
        seen[next] = true;
        surface.push_back(next);
      }
    }
    for (const std::size_t w : surface) {
      walls[w].seam = std::max(std::min(kSeam * largest, kSmall * smallest), kRounding * largest);
    }
  }
}

template void join_walls<2>(std::vector<Wall<2>>&);
template void join_walls<3>(std::vector<Wall<3>>&);

namespace {

/// The point of one piece of a wall that is nearest to a grain's centre.
template <int Dim>
struct Candidate {
  int wall, piece;
  double distance;
  Vec<Dim> foot;
  Feature feature;
};

/// Whether the candidate `own` of a list is a contact of the surface that their pieces
/// make together.
///
/// From a foot that lies on another piece, to a seam, the way leads to the foot of that piece
/// unless it is further away by more than a seam. A candidate from which every way leads back is a
/// minimum of the distance. All those on its ways are the same minimum: that with most to it
/// carries (a face before an edge before a corner), the nearer before the further, the first before
/// the last. From a face a way leads only to another face that lies on it.
template <int Dim>
bool is_contact(const std::vector<Candidate<Dim>>& list, std::size_t own, const Wall<Dim>* walls,
                double seam) {
  const std::size_t n = list.size();
  const auto leads_to = [&](const Candidate<Dim>& one, const Candidate<Dim>& other) {
    if (other.distance > one.distance + seam) return false;
    if (one.feature == Feature::face && other.feature != Feature::face) return false;
    if (one.feature == Feature::face) return (one.foot - other.foot).norm() <= 2 * seam;
    return std::abs(walls[other.wall].foot(other.piece, one.foot).distance) <= seam;
  };
  const auto rank = [&](std::size_t k) {
    return std::tuple(-static_cast<int>(list[k].feature), list[k].distance, list[k].wall,
                      list[k].piece);
  };
  // Many small pieces under one grain: nearly all find at once who carries in their place.
  std::vector<bool> minimum(n), leads_back(n);
  std::vector<std::size_t> way{own};
  minimum[own] = leads_back[own] = true;
  while (!way.empty()) {
    const std::size_t at = way.back();
    way.pop_back();
    for (std::size_t k = 0; k < n; ++k) {
      if (minimum[k] || !leads_to(list[at], list[k])) continue;
      if (rank(k) < rank(own)) return false;
      minimum[k] = true;
      way.push_back(k);
    }
  }
  way.push_back(own);
  while (!way.empty()) {
    const std::size_t at = way.back();
    way.pop_back();
    for (std::size_t k = 0; k < n; ++k) {
      if (leads_back[k] || !minimum[k] || !leads_to(list[k], list[at])) continue;
      leads_back[k] = true;
      way.push_back(k);
    }
  }
  return minimum == leads_back;
}

}  // namespace

namespace detail {

template <int Dim>
typename Wall<Dim>::Foot foot_on_surface(const Wall<Dim>* walls, std::span<const WallPair> pairs,
                                         std::size_t own_place, const Vec<Dim>& x, double reach) {
  const WallPair& own_pair = pairs[own_place];
  constexpr double kFar = std::numeric_limits<double>::max();
  if (walls[own_pair.wall].lets_through(own_pair.i)) return {kFar, Vec<Dim>::UnitX()};
  auto own = walls[own_pair.wall].foot(own_pair.piece, x);
  if (own.distance > reach) return own;
  const double seam = walls[own_pair.wall].seam;
  std::vector<Candidate<Dim>> list;
  const auto add = [&](const WallPair& pair, const typename Wall<Dim>::Foot& foot) {
    const Vec<Dim> point = x - foot.distance * foot.normal;
    list.push_back({pair.wall, pair.piece, foot.distance, point,
                    walls[pair.wall].feature(pair.piece, point, seam)});
  };
  const auto consider = [&](std::size_t k) {
    const Wall<Dim>& wall = walls[pairs[k].wall];
    if (!wall.joined || wall.lets_through(own_pair.i)) return;
    const auto foot = wall.foot(pairs[k].piece, x);
    if (foot.distance <= own.distance + 2 * seam) add(pairs[k], foot);
  };
  for (std::size_t k = own_place; k > 0 && pairs[k - 1].i == own_pair.i; --k) consider(k - 1);
  for (std::size_t k = own_place + 1; k < pairs.size() && pairs[k].i == own_pair.i; ++k) {
    consider(k);
  }
  if (list.empty()) return own;
  add(own_pair, own);
  if (is_contact<Dim>(list, list.size() - 1, walls, seam)) return own;
  return {kFar, own.normal};
}

template Wall<2>::Foot foot_on_surface<2>(const Wall<2>*, std::span<const WallPair>, std::size_t,
                                          const Vec<2>&, double);
template Wall<3>::Foot foot_on_surface<3>(const Wall<3>*, std::span<const WallPair>, std::size_t,
                                          const Vec<3>&, double);

}  // namespace detail

namespace {

template <int Dim>
std::string defect_of(const Path<Dim>& path) {
  if (path.times.empty() || path.times.size() != path.shifts.size()) {
    return "a path needs as many places as times, and at least one";
  }
  if (std::adjacent_find(path.times.begin(), path.times.end(), std::greater_equal<double>()) !=
      path.times.end()) {
    return "the times of a path increase";
  }
  return "";
}

/// How a wall turns, as numbers of one kind. The axis is of unit length.
template <int Dim>
struct Turning {
  SpinVec<Dim> axis;
  Vec<Dim> about;
  double angle = 0, rate = 0;  // now [rad], [rad/s]
};

template <int Dim>
Turning<Dim> turning_at(const Turn<Dim>& turn, double t) {
  return {turn.axis, turn.about, turn.rate * (std::clamp(t, turn.start, turn.stop) - turn.start),
          t >= turn.start && t < turn.stop ? turn.rate : 0};
}
template <int Dim>
Turning<Dim> turning_at(const Swing<Dim>& swing, double t) {
  const double omega = 2 * std::numbers::pi * swing.frequency;
  const double phase = omega * (std::clamp(t, swing.start, swing.stop) - swing.start);
  return {swing.axis, swing.about, swing.amplitude * std::sin(phase),
          t >= swing.start && t < swing.stop ? swing.amplitude * omega * std::cos(phase) : 0};
}
template <int Dim>
Turning<Dim> turning_at(const Upright&, double) {
  return {SpinVec<Dim>::Zero(), Vec<Dim>::Zero()};
}

/// How fast it ever turns [rad/s].
template <int Dim>
double largest_rate(const Turn<Dim>& turn) {
  return turn.rate;
}
template <int Dim>
double largest_rate(const Swing<Dim>& swing) {
  return 2 * std::numbers::pi * swing.frequency * swing.amplitude;
}
double largest_rate(const Upright&) { return 0; }

/// Whether turning about an axis through the wall's point leaves all of its pieces where they are.
template <int Dim>
bool is_round(const Sheet<Dim>& sheet, const SpinVec<Dim>& axis) {
  if constexpr (Dim == 3) {
    const auto is_round_piece = [&](const WallPiece<3>& piece) {
      const auto* frustum = std::get_if<Frustum>(&piece);
      return frustum && frustum->axis.cross(axis).norm() < kSeam &&
             frustum->base.cross(axis).norm() < kSeam * frustum->size();
    };
    return std::all_of(sheet.pieces().begin(), sheet.pieces().end(), is_round_piece);
  }
  return false;
}

Eigen::Matrix2d rotation(const SpinVec<2>& axis, double angle) {
  return Eigen::Rotation2Dd(axis[0] * angle).toRotationMatrix();
}
Eigen::Matrix3d rotation(const SpinVec<3>& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

}  // namespace

template <int Dim>
std::string Wall<Dim>::defect() const {
  if (front_only) {
    const auto has_front = [](const WallPiece<Dim>& piece) {
      return std::visit(
          [](const auto& p) {
            return requires { p.front(); };
          },
          piece);
    };
    if (!pieces()) return "it has one side; only what is thin is solid from its front or both";
    const auto& all = pieces()->pieces();
    if (!std::all_of(all.begin(), all.end(), has_front)) {
      return Dim == 2 ? "an arc is solid from both sides; give points"
                      : "a round piece is solid from both sides; give plates";
    }
  }
  if (const auto* path = std::get_if<Path<Dim>>(&motion)) {
    if (std::string why = defect_of(*path); !why.empty()) return why;
  }
  if (!turns()) return "";
  if (yields()) return "a piston does not turn";
  const Turning<Dim> now = std::visit([](const auto& m) { return turning_at<Dim>(m, 0); }, turning);
  if (!(std::abs(now.axis.squaredNorm() - 1) < 1e-9)) return "it turns about no axis";
  constexpr double kFastest = 1e100;  // its square, and the way in any time, is a double
  const double rate = std::visit([](const auto& m) { return largest_rate(m); }, turning);
  if (!(std::abs(rate) < kFastest)) return "it turns faster than numbers tell; slow it down";
  const auto* plane = std::get_if<HalfSpace<Dim>>(&shape);
  if constexpr (Dim == 2) {
    if (plane) return "a line without an end does not turn; give from and to, or points";
  } else {
    const std::string give = "; give plates";
    if (plane && !(now.axis.cross(plane->normal).norm() < kSeam)) {
      return "what has no end turns about its normal alone" + give;
    }
    const auto* round = std::get_if<Cylinder<Dim>>(&shape);
    if (round && !round->axis.isZero(0) && !(now.axis.cross(round->axis).norm() < kSeam)) {
      return "what has no end turns about its axis alone" + give;
    }
  }
  return "";
}

template <int Dim>
std::string pressure_defect(const std::vector<Wall<Dim>>& walls, const Wall<Dim>& wall) {
  const auto* piston = std::get_if<Piston<Dim>>(&wall.motion);
  if (!piston || !piston->pressure) return "";
  const Pressure<Dim>& pressure = *piston->pressure;
  if (!(pressure.value > 0 && std::isfinite(pressure.value))) return "a pressure is positive";
  if (!(pressure.depth > 0 && std::isfinite(pressure.depth))) return "a depth is positive";
  const auto* face = std::get_if<HalfSpace<Dim>>(&wall.shape);
  if (!face) return "a piston that holds a pressure has point and normal, along which it presses";
  std::vector<Vec<Dim>> normals{face->normal};
  std::vector<std::string> names{wall.name};
  for (const auto& pair : pressure.between) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (pair[k] < 0 || pair[k] >= static_cast<int>(walls.size())) {
        return "it presses between walls that are not there";
      }
      const Wall<Dim>& side = walls[static_cast<std::size_t>(pair[k])];
      const auto* plane = std::get_if<HalfSpace<Dim>>(&side.shape);
      if (!plane) return "wall " + side.name + " is no flat wall with point and normal";
      if (k == 1) {
        if (pair[0] == pair[1]) return "it presses between wall " + side.name + " and itself";
        const Vec<Dim>& other = normals.back();
        if (!((plane->normal - plane->normal.dot(other) * other).norm() < kSeam)) {
          return "walls " + names.back() + " and " + side.name + " are not parallel";
        }
        continue;
      }
      for (std::size_t n = 0; n < normals.size(); ++n) {
        if (std::abs(plane->normal.dot(normals[n])) < kSeam) continue;
        return "wall " + side.name + " is not at a right angle to wall " + names[n];
      }
      normals.push_back(plane->normal);
      names.push_back(side.name);
    }
  }
  return "";
}

template <int Dim>
double area_of(const Pressure<Dim>& pressure, const std::vector<Wall<Dim>>& walls) {
  double area = pressure.depth;
  for (const auto& [a, b] : pressure.between) {
    const Wall<Dim>& side = walls[static_cast<std::size_t>(a)];
    const Vec<Dim> across = walls[static_cast<std::size_t>(b)].point - side.point;
    area *= std::abs(across.dot(std::get<HalfSpace<Dim>>(side.shape).normal));
  }
  return area;
}

template <int Dim>
typename Wall<Dim>::Foot Wall<Dim>::foot_on(const Sheet<Dim>& sheet, int piece,
                                            const Vec<Dim>& x) const {
  const WallPiece<Dim>& p = sheet.piece(piece);
  const Vec<Dim> own = std::visit([&](const auto& q) { return q.nearest(in_own_frame(x)); }, p);
  const Vec<Dim> away = x - (turned_ ? Vec<Dim>(point + frame_ * own) : Vec<Dim>(point + own));
  const double distance = away.norm();
  if (distance > 0) return {distance, away / distance};
  // A centre exactly on the wall is pushed out along a normal of it.
  return {0, frame_ * std::visit([&](const auto& q) { return q.normal_at(own); }, p)};
}

template <int Dim>
double Wall<Dim>::in_front(int piece, const Vec<Dim>& x) const {
  const Vec<Dim> own = in_own_frame(x);
  return std::visit(
      [&](const auto& p) -> double {
        if constexpr (requires { p.front(); }) return (own - p.nearest(own)).dot(p.front());
        return 0;
      },
      pieces()->piece(piece));
}

template <int Dim>
void note_encounter(const Wall<Dim>& wall, std::span<const WallPair> pieces, const Vec<Dim>& x,
                    double radius, std::vector<typename Wall<Dim>::Encounter>& now) {
  double least = radius, most = -1;
  bool passes = false;
  for (const WallPair& pair : pieces) {
    const double distance = wall.foot(pair.piece, x).distance;
    if (!(distance < radius) || distance > least + wall.seam) continue;
    const double side = wall.in_front(pair.piece, x);
    if (distance < least - wall.seam || std::abs(side) > most) {
      most = std::abs(side);
      passes = side < 0;
    }
    least = std::min(least, distance);
  }
  if (most < 0) return;
  const int slot = pieces.front().i;
  const auto before =
      std::lower_bound(wall.encounters.begin(), wall.encounters.end(), slot,
                       [](const auto& encounter, int grain) { return encounter.grain < grain; });
  const bool goes_on = before != wall.encounters.end() && before->grain == slot;
  now.push_back({slot, goes_on ? before->passes : passes});
}

template <int Dim>
void Wall<Dim>::turn_to(double t) {
  const Vec<Dim> shift =
      std::holds_alternative<Fixed>(motion) ? Vec<Dim>(Vec<Dim>::Zero()) : Vec<Dim>(point - home);
  const Turning<Dim> now =
      std::visit([&](const auto& m) { return turning_at<Dim>(m, t); }, turning);
  angle = now.angle;
  spin = now.rate * now.axis;
  pivot = now.about + shift;
  const Frame turned = rotation(now.axis, now.angle);
  point = pivot + turned * (home - now.about);
  turned_ = pieces() && !is_round<Dim>(*pieces(), now.axis);
  if (turned_) frame_ = turned;
}

template <int Dim>
std::vector<Vec<Dim>> Wall<Dim>::corners() const {
  std::vector<Vec<Dim>> list;
  if (!pieces()) return list;
  for (const WallPiece<Dim>& piece : pieces()->pieces()) {
    for (const Vec<Dim>& corner : std::visit([](const auto& p) { return p.corners(); }, piece)) {
      list.push_back(turned_ ? Vec<Dim>(point + frame_ * corner) : Vec<Dim>(point + corner));
    }
  }
  return list;
}

template std::string pressure_defect<2>(const std::vector<Wall<2>>&, const Wall<2>&);
template std::string pressure_defect<3>(const std::vector<Wall<3>>&, const Wall<3>&);
template double area_of<2>(const Pressure<2>&, const std::vector<Wall<2>>&);
template double area_of<3>(const Pressure<3>&, const std::vector<Wall<3>>&);
template void note_encounter<2>(const Wall<2>&, std::span<const WallPair>, const Vec<2>&, double,
                                std::vector<Wall<2>::Encounter>&);
template void note_encounter<3>(const Wall<3>&, std::span<const WallPair>, const Vec<3>&, double,
                                std::vector<Wall<3>::Encounter>&);
template double Wall<2>::in_front(int, const Vec<2>&) const;
template double Wall<3>::in_front(int, const Vec<3>&) const;
template std::string Wall<2>::defect() const;
template std::string Wall<3>::defect() const;
template Wall<2>::Foot Wall<2>::foot_on(const Sheet<2>&, int, const Vec<2>&) const;
template Wall<3>::Foot Wall<3>::foot_on(const Sheet<3>&, int, const Vec<3>&) const;
template void Wall<2>::turn_to(double);
template void Wall<3>::turn_to(double);
template std::vector<Vec<2>> Wall<2>::corners() const;
template std::vector<Vec<3>> Wall<3>::corners() const;

}  // namespace lagrain
