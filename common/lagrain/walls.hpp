// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Walls: half-spaces, round containers and sheets of pieces, fixed or moving, as contact partners.
/// Walls that meet are one surface: contact_foot() says which of their pieces a grain touches.

#include <lagrain/check.hpp>
#include <lagrain/state.hpp>
#include <lagrain/vec.hpp>
#include <lagrain/wall_pieces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace lagrain {

/// A plane (a line in 2D) with everything on its far side solid.
template <int Dim>
struct HalfSpace {
  Vec<Dim> normal;  ///< unit, towards the grains [-]
};

/// A round container: everything further than the radius from the axis, a line through the wall's
/// point, is solid. In the plane there is no axis: a circle about the point.
///
/// To a law the wall is flat (its curvature is left out of Hertz's effective radius): for grains
/// small against the container.
template <int Dim>
struct Cylinder {
  double radius;  ///< [m]
  Vec<Dim> axis;  ///< unit [-]; zero for a circle in the plane, and a ball in space
};

/// No motion.
struct Fixed {};

/// Motion with constant velocity between two times.
template <int Dim>
struct Steady {
  Vec<Dim> velocity;                                      ///< [m/s]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Harmonic motion between two times: displacement amplitude sin(2 pi frequency (t - start)). The
/// wall is at rest outside, after the end where it then is.
template <int Dim>
struct Shake {
  Vec<Dim> amplitude;                                     ///< [m]
  double frequency = 0;                                   ///< [Hz]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// A pressure on a face that reaches from wall to wall: these are half-spaces at right angles to
/// it, in the plane a parallel pair, in space two such pairs at right angles to each other. So the
/// face grows and shrinks as they move.
template <int Dim>
struct Pressure {
  double value = 0;                                      ///< [Pa]
  std::array<std::array<int, 2>, Dim - 1> between = {};  ///< pairs of places among the walls
  double depth = 1;                                      ///< of discs [m]; 1 in space
};

/// Motion of a guided mass along its load, pushed by the load and by the grains. It is held until
/// its start.
template <int Dim>
struct Piston {
  double mass;       ///< [kg]
  Vec<Dim> load;     ///< [N], its own weight included
  double start = 0;  ///< [s]
  /// That it holds: the load is this times the area of its face, along its normal, at each step.
  std::optional<Pressure<Dim>> pressure = {};
};

/// Motion along straight ways between places, from each to the next in the time between them. The
/// wall rests before the first time and after the last.
template <int Dim>
struct Path {
  std::vector<double> times;     ///< increasing [s]
  std::vector<Vec<Dim>> shifts;  ///< from where the wall was at time 0, one for each time [m]
};

/// No turning.
struct Upright {};

/// Turning at a constant rate between two times.
template <int Dim>
struct Turn {
  SpinVec<Dim> axis;                                      ///< unit; 1 in the plane [-]
  double rate = 0;                                        ///< right-handed about the axis [rad/s]
  Vec<Dim> about;                                         ///< on the axis, at time 0 [m]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Turning to and fro between two times: angle amplitude sin(2 pi frequency (t - start)). The wall
/// is at rest outside, after the end where it then is.
template <int Dim>
struct Swing {
  SpinVec<Dim> axis;                                      ///< unit; 1 in the plane [-]
  double amplitude = 0;                                   ///< right-handed about the axis [rad]
  double frequency = 0;                                   ///< [Hz]
  Vec<Dim> about;                                         ///< on the axis, at time 0 [m]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Where a wall is.
template <int Dim>
struct WallPose {
  Vec<Dim> point;                         ///< of the wall [m]
  Eigen::Matrix<double, Dim, Dim> frame;  ///< from the wall's own directions to those of the scene
  double angle = 0;                       ///< that it has turned by [rad]
};

/// What grains do to a wall.
template <int Dim>
struct WallLoad {
  Vec<Dim> force = Vec<Dim>::Zero();           ///< [N]
  SpinVec<Dim> torque = SpinVec<Dim>::Zero();  ///< about its pivot; of walls that turn [N m]
  double power = 0;  ///< given to what runs along its surface, see Wall::belt [W]

  /// Of several parts, in their order.
  WallLoad& operator+=(const WallLoad& other) {
    force += other.force;
    torque += other.torque;
    power += other.power;
    return *this;
  }
};

/// A wall and what the grains exert on it.
template <int Dim>
struct Wall {
  std::string name;                   ///< for people, and for the files of a run
  Vec<Dim> point = Vec<Dim>::Zero();  ///< now: on the plane, an end or corner, on the axis [m]
  /// The shape says what is solid.
  std::variant<HalfSpace<Dim>, Cylinder<Dim>, Sheet<Dim>> shape;
  /// The motion says how its point moves.
  std::variant<Fixed, Steady<Dim>, Shake<Dim>, Path<Dim>, Piston<Dim>> motion = Fixed{};
  int material = 0;                  ///< row of the table of laws
  Vec<Dim> home = Vec<Dim>::Zero();  ///< where it was at time 0 [m], for motions given in time
  /// How it turns besides. A piston does not.
  std::variant<Upright, Turn<Dim>, Swing<Dim>> turning = Upright{};
  /// The surface runs with this velocity, as far as that lies in it, while the wall stays [m/s].
  Vec<Dim> belt = Vec<Dim>::Zero();
  double until = std::numeric_limits<double>::infinity();  ///< from then on it is gone [s]
  /// Of straight pieces with a front: whoever is behind where it begins to touch the wall passes
  /// through, until it touches no more. Whoever is in front finds it solid for as long.
  bool front_only = false;

  /// What follows is kept by the simulation.
  /// @{
  Vec<Dim> velocity = Vec<Dim>::Zero();        ///< of its pivot, now [m/s]
  SpinVec<Dim> spin = SpinVec<Dim>::Zero();    ///< now [rad/s]
  Vec<Dim> pivot = Vec<Dim>::Zero();           ///< on the axis, now; of a wall that turns [m]
  double angle = 0;                            ///< that it has turned by [rad]
  bool gone = false;                           ///< whether `until` has passed
  Vec<Dim> force = Vec<Dim>::Zero();           ///< by the grains, in the last step [N]
  SpinVec<Dim> torque = SpinVec<Dim>::Zero();  ///< the same about the pivot [N m]
  double work = 0;      ///< done on the grains since the start, without forces that move it [J]
  bool joined = false;  ///< whether it may meet other walls, or itself, see join_walls
  bool uneven = false;  ///< whether the velocity of its surface may differ from place to place
  double seam = 0;      ///< to which joints of that surface are known [m]
  /// Who touches a wall that is solid from the front alone, and whether it passes.
  struct Encounter {
    int grain;    ///< by slot
    bool passes;  ///< whether it came from behind
  };
  std::vector<Encounter> encounters;  ///< sorted by grain
  /// @}

  /// A fixed half-space.
  /// @param point   on the plane [m]
  /// @param normal  towards the grains, of any length
  static Wall half_space(std::string name, const Vec<Dim>& point, const Vec<Dim>& normal) {
    return at(std::move(name), point, HalfSpace<Dim>{normal.normalized()});
  }
  /// A fixed straight wall between two points of the plane [m].
  static Wall segment(std::string name, const Vec<2>& from, const Vec<2>& to) requires(Dim == 2) {
    return sheet(std::move(name), from, {WallSegment(Vec<2>::Zero(), to - from)});
  }
  /// A fixed convex plate in space.
  /// @param corners  in their order around the plate [m]
  /// @throws ContractError if they make no plate, see Plate::defect
  static Wall plate(std::string name, std::vector<Vec<3>> corners) requires(Dim == 3) {
    LAGRAIN_EXPECTS(!corners.empty(), "a plate without corners");
    const Vec<3> first = corners.front();
    for (Vec<3>& corner : corners) corner -= first;
    return sheet(std::move(name), first, {Plate(std::move(corners))});
  }
  /// A fixed wall of pieces.
  /// @param pieces  relative to the point
  static Wall sheet(std::string name, const Vec<Dim>& point, std::vector<WallPiece<Dim>> pieces) {
    return at(std::move(name), point, Sheet<Dim>(std::move(pieces)));
  }
  /// A fixed round container.
  /// @param point  on the axis [m]
  /// @param axis   of any length; zero in the plane, and for a ball
  /// @param radius of the container [m]
  static Wall cylinder(std::string name, const Vec<Dim>& point, const Vec<Dim>& axis,
                       double radius) {
    return at(std::move(name), point, Cylinder<Dim>{radius, axis.normalized()});
  }

  /// Whether any of it can change its place.
  bool moves() const { return !std::holds_alternative<Fixed>(motion) || turns(); }
  /// Whether it turns.
  bool turns() const { return !std::holds_alternative<Upright>(turning); }
  /// Whether its surface can have a velocity, so that it does work on grains.
  bool drives() const { return moves() || runs(); }
  /// Whether its surface runs while it stays.
  bool runs() const { return !belt.isZero(0); }
  /// Whether a force moves it; the other walls stay, or follow their motion whatever pushes them.
  bool yields() const { return std::holds_alternative<Piston<Dim>>(motion); }
  /// Why it cannot turn as it should, or be moved as well; empty if it can.
  std::string defect() const;

  /// Its pieces, if it has an end, so that one can go around it; else null.
  const Sheet<Dim>* pieces() const { return std::get_if<Sheet<Dim>>(&shape); }
  /// How many pieces there are; 1 for a wall without an end.
  int piece_count() const {
    const Sheet<Dim>* sheet = pieces();
    return sheet ? static_cast<int>(sheet->pieces().size()) : 1;
  }

  /// The point of the wall that is nearest to a place.
  struct Foot {
    double distance;  ///< from the wall's surface; negative behind a half-space or a cylinder [m]
    Vec<Dim> normal;  ///< unit, from the wall towards the place [-]
  };
  /// The foot of x [m] on one of its pieces as it is now.
  Foot foot(int piece, const Vec<Dim>& x) const {
    return std::visit([&](const auto& s) { return foot_on(s, piece, x); }, shape);
  }
  /// The foot of x [m] on the piece that is nearest.
  Foot foot(const Vec<Dim>& x) const {
    const Sheet<Dim>* sheet = pieces();
    if (gone) return {std::numeric_limits<double>::infinity(), Vec<Dim>::UnitX()};
    if (!sheet || sheet->pieces().size() == 1) return foot(0, x);
    return foot(sheet->nearest_piece(in_own_frame(x)), x);
  }
  /// What a point of a piece [m] lies on. Within `reach` [m] of an edge or corner it counts as
  /// lying on that.
  Feature feature(int piece, const Vec<Dim>& foot, double reach) const {
    const Sheet<Dim>* sheet = pieces();
    if (!sheet) return Feature::face;
    return std::visit([&](const auto& p) { return p.feature(in_own_frame(foot), reach); },
                      sheet->piece(piece));
  }
  /// Whether the grain in a slot passes through it, having come from behind.
  bool lets_through(int slot) const {
    const auto found = std::lower_bound(encounters.begin(), encounters.end(), slot,
                                        [](const Encounter& e, int s) { return e.grain < s; });
    return found != encounters.end() && found->grain == slot && found->passes;
  }
  /// How far in front of a piece's nearest point a place is, along its front [m]; negative behind.
  double in_front(int piece, const Vec<Dim>& x) const;
  /// Ends or corners of all of its pieces as they are now [m]; empty for one without an end.
  std::vector<Vec<Dim>> corners() const;
  /// The box around it as it was made [m]; empty for one without an end.
  Eigen::AlignedBox<double, Dim> box() const {
    const Sheet<Dim>* sheet = pieces();
    return sheet ? Eigen::AlignedBox<double, Dim>(sheet->box()).translate(point)
                 : Eigen::AlignedBox<double, Dim>();
  }

  /// Velocity of the surface [m/s] at a place of it with this normal.
  Vec<Dim> velocity_at(const Vec<Dim>& place, const Vec<Dim>& normal) const {
    Vec<Dim> v = velocity;
    if (!uneven) return v;
    if (turns()) v += cross<double>(spin, place - pivot);
    if (runs()) v += belt_along(normal);
    return v;
  }
  /// What runs along the surface where it has this normal [m/s].
  Vec<Dim> belt_along(const Vec<Dim>& normal) const { return belt - belt.dot(normal) * normal; }
  /// The power of a load: what the grains do to the wall [W].
  double power_of(const WallLoad<Dim>& load) const {
    double power = load.force.dot(velocity);
    if (!uneven) return power;
    if (turns()) power += load.torque.dot(spin);
    if (runs()) power += load.power;
    return power;
  }

  /// Where it is now.
  WallPose<Dim> pose() const { return {point, frame_, angle}; }
  /// No part of it has moved further than this since it was at a pose, seen from a frame that has
  /// moved by `shift` meanwhile [m].
  double way_since(const WallPose<Dim>& then, const Vec<Dim>& shift) const {
    return (point - shift - then.point).norm() + std::abs(angle - then.angle) * swept();
  }
  /// No part of it moves faster than this in a frame [m/s].
  double fastest(const Vec<Dim>& frame_velocity) const {
    if (!turns()) return (velocity - frame_velocity).norm();
    const Vec<Dim> of_point = velocity + cross<double>(spin, point - pivot);
    return (of_point - frame_velocity).norm() + spin.norm() * swept();
  }
  /// Where a place [m] of the wall at a pose is now.
  Vec<Dim> carried_along(const WallPose<Dim>& then, const Vec<Dim>& x) const {
    if (!turned_) return x + (point - then.point);
    return point + frame_ * (then.frame.transpose() * (x - then.point));
  }

  /// Visits, grain by grain in increasing order, every grain i and piece whose distance is no
  /// further than reach(i) [m] from the centre x.col(i): visit(i, piece).
  template <class Reach, class F>
  void for_each_within(const Columns<Dim>& x, Reach&& reach, F&& visit) const {
    const int n = static_cast<int>(x.cols());
    std::vector<int> found;
    for (int i = 0; i < n; ++i)
      for_each_near(x.col(i), reach(i), found, [&](int p) { visit(i, p); });
  }
  /// Visits every piece that is no further than reach [m] from x, in increasing order.
  /// @param found  scratch
  template <class F>
  void for_each_near(const Vec<Dim>& x, double reach, std::vector<int>& found, F&& visit) const {
    if (gone) return;
    const Sheet<Dim>* sheet = pieces();
    if (!sheet || sheet->pieces().size() == 1) {
      if (foot(0, x).distance <= reach) visit(0);
      return;
    }
    sheet->near(in_own_frame(x), reach, found);
    for (const int piece : found) {
      if (foot(piece, x).distance <= reach) visit(piece);
    }
  }

  /// Brings the wall to time t [s], a step dt [s] after the last call.
  void advance(double t, double dt) {
    std::visit([&](const auto& m) { follow(m, t, dt); }, motion);
    if (turns()) turn_to(t);
    gone = t >= until;
  }

  /// Keeps or restores what changes in time.
  /// @throws SceneError if the state holds no such wall
  void persist(StateVisitor visit) {
    visit("point", point);
    visit("velocity", velocity);
    visit("spin", spin);
    visit("pivot", pivot);
    visit("angle", angle);
    visit("frame", frame_);
    visit("gone", gone);
    visit("force", force);
    visit("torque", torque);
    visit("work", work);
    if (!front_only) return;
    std::vector<int> grains;
    std::vector<bool> passes;
    for (const Encounter& encounter : encounters) {
      grains.push_back(encounter.grain);
      passes.push_back(encounter.passes);
    }
    visit("encounters", grains);
    visit("passes", passes);
    if (grains.size() != passes.size()) throw SceneError("its encounters do not fit together");
    encounters.clear();
    for (std::size_t k = 0; k < grains.size(); ++k) encounters.push_back({grains[k], passes[k]});
  }

 private:
  using Frame = Eigen::Matrix<double, Dim, Dim>;

  template <class Shape>
  static Wall at(std::string&& name, const Vec<Dim>& point, Shape shape) {
    Wall wall;
    wall.name = std::move(name);
    wall.point = wall.home = point;
    wall.shape = std::move(shape);
    return wall;
  }

  Foot foot_on(const HalfSpace<Dim>& plane, int, const Vec<Dim>& x) const {
    return {(x - point).dot(plane.normal), plane.normal};
  }
  // Not inlined: kernels are faster for half-spaces, the common case, if this is apart.
  Foot foot_on(const Sheet<Dim>& sheet, int piece, const Vec<Dim>& x) const;
  Foot foot_on(const Cylinder<Dim>& cylinder, int, const Vec<Dim>& x) const {
    const Vec<Dim> arm = x - point;
    const Vec<Dim> away = arm - arm.dot(cylinder.axis) * cylinder.axis;
    const double distance = away.norm();
    // On the axis all of the wall is equally far.
    if (distance == 0) return {cylinder.radius, any_normal<Dim>(cylinder.axis)};
    return {cylinder.radius - distance, away / -distance};
  }

  Vec<Dim> in_own_frame(const Vec<Dim>& x) const {
    if (!turned_) return x - point;
    return frame_.transpose() * (x - point);
  }
  /// How far a part of it is from its point, if turning moves any [m].
  double swept() const { return turned_ ? pieces()->extent() : 0; }

  void follow(const Fixed&, double, double) {}
  void follow(const Steady<Dim>& m, double t, double) {
    point = home + (std::clamp(t, m.start, m.stop) - m.start) * m.velocity;
    velocity = t >= m.start && t < m.stop ? m.velocity : Vec<Dim>(Vec<Dim>::Zero());
  }
  void follow(const Shake<Dim>& m, double t, double) {
    const double omega = 2 * std::numbers::pi * m.frequency;
    const bool on = t >= m.start && t < m.stop;
    const double phase = omega * (std::clamp(t, m.start, m.stop) - m.start);
    point = home + std::sin(phase) * m.amplitude;
    velocity = on ? Vec<Dim>(omega * std::cos(phase) * m.amplitude) : Vec<Dim>(Vec<Dim>::Zero());
  }
  void follow(const Path<Dim>& m, double t, double) {
    const auto next = std::upper_bound(m.times.begin(), m.times.end(), t) - m.times.begin();
    const auto k = static_cast<std::size_t>(next);
    velocity.setZero();
    if (k == 0 || k == m.times.size()) {
      point = home + (k == 0 ? m.shifts.front() : m.shifts.back());
      return;
    }
    velocity = (m.shifts[k] - m.shifts[k - 1]) / (m.times[k] - m.times[k - 1]);
    point = home + m.shifts[k - 1] + (t - m.times[k - 1]) * velocity;
  }
  void follow(const Piston<Dim>& m, double t, double dt) {
    if (t <= m.start) return;
    const Vec<Dim> axis = m.load.normalized();
    velocity += dt * (m.load.norm() + force.dot(axis)) / m.mass * axis;
    point += dt * velocity;
  }

  void turn_to(double t);

  Frame frame_ = Frame::Identity();  // from its own directions to those of the scene
  bool turned_ = false;              // whether turning changes the place of any of it
};

/// A grain and a piece of a wall near it.
struct WallPair {
  int i = 0;      ///< the grain, by slot or number
  int wall = 0;   ///< place among the walls
  int piece = 0;  ///< of the wall
  auto operator<=>(const WallPair&) const = default;
};

/// Notes a grain that touches a wall which is solid from the front alone. If it has begun to, the
/// nearest piece says whether it comes from behind; of equally near ones, that which it faces most.
/// @param pieces  of the wall, near the grain at x [m]
/// @param now     gets the encounter, if there is one
template <int Dim>
void note_encounter(const Wall<Dim>& wall, std::span<const WallPair> pieces, const Vec<Dim>& x,
                    double radius, std::vector<typename Wall<Dim>::Encounter>& now);

/// Finds which walls may meet others, with which they are one surface then: at least one of two has
/// an end, and their boxes touch, or one of the two moves. A wall of several pieces meets itself.
/// Walls that hang together get one seam. Also sees which walls are uneven.
template <int Dim>
void join_walls(std::vector<Wall<Dim>>& walls);

/// Why a piston among these walls cannot hold its pressure; empty if it can, or holds none.
template <int Dim>
std::string pressure_defect(const std::vector<Wall<Dim>>& walls, const Wall<Dim>& piston);

/// The area [m^2] of a face that a pressure acts on, as the walls are now.
template <int Dim>
double area_of(const Pressure<Dim>& pressure, const std::vector<Wall<Dim>>& walls);

/// Brings the loads of all pistons that hold a pressure up to where the walls are now.
template <int Dim>
void update_loads(std::vector<Wall<Dim>>& walls) {
  for (Wall<Dim>& wall : walls) {
    auto* piston = std::get_if<Piston<Dim>>(&wall.motion);
    if (!piston || !piston->pressure) continue;
    piston->load = piston->pressure->value * area_of(*piston->pressure, walls) *
                   std::get<HalfSpace<Dim>>(wall.shape).normal;
  }
}

namespace detail {
/// The foot of x [m] on a wall that meets others, see contact_foot.
template <int Dim>
typename Wall<Dim>::Foot foot_on_surface(const Wall<Dim>* walls, std::span<const WallPair> near,
                                         std::size_t own, const Vec<Dim>& x, double reach);
extern template Wall<2>::Foot foot_on_surface<2>(const Wall<2>*, std::span<const WallPair>,
                                                 std::size_t, const Vec<2>&, double);
extern template Wall<3>::Foot foot_on_surface<3>(const Wall<3>*, std::span<const WallPair>,
                                                 std::size_t, const Vec<3>&, double);
}  // namespace detail

/// The foot of x [m] on a piece of a wall, as a contact sees it. Walls that meet are one surface,
/// which a grain touches at the points of it that are nearer than all around them. Where two pieces
/// meet, one leaves the contact to the other that is nearer, or has more to it there (a face before
/// an edge before a corner), or comes first. A piece that leaves a contact to another one is as
/// good as infinitely far. So a convex or flat joint is touched once, a concave one on both faces.
/// @param walls  all walls
/// @param pairs  sorted; those of one grain are together, and hold all pieces that its contact
///               could be left to: those within `reach` and two seams
/// @param own    place of the grain and the piece among the pairs
/// @param reach  distance beyond which the answer does not matter: the grain's radius [m]
template <int Dim>
typename Wall<Dim>::Foot contact_foot(const Wall<Dim>* walls, std::span<const WallPair> pairs,
                                      std::size_t own, const Vec<Dim>& x, double reach) {
  const auto [i, w, piece] = pairs[own];
  if (!walls[w].joined) return walls[w].foot(piece, x);
  return detail::foot_on_surface<Dim>(walls, pairs, own, x, reach);
}

}  // namespace lagrain
