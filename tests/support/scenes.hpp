// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Small scenes that many tests share: laws by their measurable properties, pairs, boxes, packings.

#include <lagrain/all_pairs.hpp>
#include <lagrain/compiled_kernels.hpp>
#include <lagrain/cundall_strack.hpp>
#include <lagrain/hertz.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/random.hpp>
#include <lagrain/rolling_resistance.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/viscous_friction.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace lagrain::test {

/// One pair of dimension and law: 2D and 3D run the same cases.
template <int D, class L>
struct Case {
  static constexpr int Dim = D;
  using Law = L;
};

using FrictionalSpring = CundallStrack<LinearSpring>;
using FrictionalHertz = CundallStrack<Hertz>;
using RollingSpring = RollingResistance<FrictionalSpring>;
using RollingHertz = RollingResistance<FrictionalHertz>;
using ViscousSpring = ViscousFriction<LinearSpring>;
using ViscousHertz = ViscousFriction<Hertz>;

/// A simulation by velocity Verlet over brute force, unless a test asks for something else.
template <int Dim, class Law, class N = AllPairs<Dim>, class Motion = VelocityVerlet>
using Sim = Simulation<Dim, Law, Motion, N>;

/// What one can measure of a material; each law takes what it needs.
struct Material {
  double stiffness = 1e6;  ///< k [N/m], and E* [Pa] for Hertz
  double restitution = 1;
  double friction = 0;
  double tangential_damping_ratio = 0;
  double impact_speed = 1;  ///< [m/s]
  double rolling_friction = 0;
  double twisting_friction = 0;
  double rolling_stiffness_ratio = 2.0 / 7;
  double rolling_damping_ratio = 0.3;
};

template <class Law>
struct LawMaker;
template <>
struct LawMaker<LinearSpring> {
  static LinearSpring make(const Material& m) {
    return LinearSpring::with_restitution(m.stiffness, m.restitution);
  }
};
template <>
struct LawMaker<Hertz> {
  static Hertz make(const Material& m) {
    return Hertz::with_restitution(m.stiffness, m.restitution, m.impact_speed);
  }
};
template <class Normal>
struct LawMaker<CundallStrack<Normal>> {
  static CundallStrack<Normal> make(const Material& m) {
    return {.normal = LawMaker<Normal>::make(m),
            .friction = m.friction,
            .tangential_damping_ratio = m.tangential_damping_ratio};
  }
};
template <class Normal>
struct LawMaker<ViscousFriction<Normal>> {
  static ViscousFriction<Normal> make(const Material& m) {
    return {.normal = LawMaker<Normal>::make(m),
            .friction = m.friction,
            .tangential_damping_ratio = m.tangential_damping_ratio};
  }
};
template <class Friction>
struct LawMaker<RollingResistance<Friction>> {
  static RollingResistance<Friction> make(const Material& m) {
    return {.sliding = LawMaker<Friction>::make(m),
            .rolling_friction = m.rolling_friction,
            .twisting_friction = m.twisting_friction,
            .stiffness_ratio = m.rolling_stiffness_ratio,
            .damping_ratio = m.rolling_damping_ratio};
  }
};

template <class Law>
Law make_law(const Material& material) {
  return LawMaker<Law>::make(material);
}

/// The last axis points up, the first is horizontal.
template <int Dim>
Vec<Dim> up() {
  return Vec<Dim>::Unit(Dim - 1);
}
template <int Dim>
Vec<Dim> along() {
  return Vec<Dim>::UnitX();
}

/// A unit vector on no axis, so that no coordinate is special: 3-4-5 and 2-3-6-7.
template <int Dim>
Vec<Dim> oblique() {
  if constexpr (Dim == 2) {
    return {0.6, 0.8};
  } else {
    return {2.0 / 7, 3.0 / 7, 6.0 / 7};
  }
}

/// The spin that rolls a grain along `along()` on ground below it: velocity omega x up, per unit of
/// speed and radius.
template <int Dim>
SpinVec<Dim> rolling_spin() {
  if constexpr (Dim == 2) {
    return SpinVec<2>(-1.0);
  } else {
    return SpinVec<3>(0, 1, 0);
  }
}

/// Moment of inertia over m r^2: 1/2 for a disc, 2/5 for a sphere.
template <int Dim>
inline constexpr double kInertiaFactor = Dim == 2 ? 0.5 : 0.4;

/// Composes a simulation whose time step is the safe one divided by `refinement`.
template <int Dim, class Law, class N = AllPairs<Dim>, class Motion = VelocityVerlet>
Sim<Dim, Law, N, Motion> make_sim(const std::vector<Grain<Dim>>& list, const Law& law,
                                  const std::vector<Wall<Dim>>& walls, double refinement,
                                  const Vec<Dim>& gravity = Vec<Dim>::Zero(),
                                  N neighbourhood = {}) {
  auto grains = make_grains<Dim, Law::needs>(list);
  const LawTable<Law> laws(law);
  Setting<Dim> setting;
  setting.gravity = gravity;
  setting.time_step = time_scales(grains, laws, walls).safe_step / refinement;
  return {std::move(grains), laws, walls, setting, std::move(neighbourhood)};
}

/// A wall with ends: a segment between two points of the plane, and in space a strip of that length
/// and 2 m wide with the line between them in its middle.
template <int Dim>
Wall<Dim> flat_piece(const std::string& name, const Vec<Dim>& from, const Vec<Dim>& to) {
  if constexpr (Dim == 2) {
    return Wall<2>::segment(name, from, to);
  } else {
    const Vec<3> across = (to - from).unitOrthogonal();
    return Wall<3>::plate(name, {from - across, to - across, to + across, from + across});
  }
}

/// A closed axis-parallel box of half-spaces.
template <int Dim>
std::vector<Wall<Dim>> box(const Vec<Dim>& low, const Vec<Dim>& high) {
  std::vector<Wall<Dim>> walls;
  for (int d = 0; d < Dim; ++d) {
    walls.push_back(Wall<Dim>::half_space("low", low, Vec<Dim>::Unit(d)));
    walls.push_back(Wall<Dim>::half_space("high", high, -Vec<Dim>::Unit(d)));
  }
  return walls;
}

/// Grains on a shaken square lattice that overlaps nowhere: radii in [low, high], density 1.
struct Packing {
  int count = 100;
  double low = 0.7;    ///< smallest radius [m]
  double high = 1;     ///< largest radius [m]
  double spacing = 1;  ///< of the lattice, in units of 2.1 largest radii [-]
  double speed = 0;    ///< standard deviation of each velocity component [m/s]
  double spin = 0;     ///< of each component of the angular velocity [rad/s]
};

template <int Dim>
struct Packed {
  std::vector<Grain<Dim>> grains;
  Vec<Dim> low;   ///< corner of a box around all grains [m]
  Vec<Dim> high;  ///< the opposite corner [m]
};

template <int Dim>
Packed<Dim> lattice(const Packing& p, Random& random) {
  int side = 1;
  while (std::pow(side, Dim) < p.count) ++side;
  const double cell = 2.1 * p.high * p.spacing;
  Packed<Dim> packed{{}, Vec<Dim>::Zero(), Vec<Dim>::Constant(side * cell)};
  for (int k = 0; k < p.count; ++k) {
    Grain<Dim> g;
    g.radius = random.uniform(p.low, p.high);
    g.mass = grain_volume<Dim>(g.radius);
    const double room = 0.5 * cell - g.radius;
    for (int d = 0, rest = k; d < Dim; ++d, rest /= side) {
      g.position[d] = (rest % side + 0.5) * cell + random.uniform(-room, room);
      g.velocity[d] = p.speed * random.normal();
    }
    for (int d = 0; d < kSpinDim<Dim>; ++d) g.omega[d] = p.spin * random.normal();
    packed.grains.push_back(g);
  }
  return packed;
}

/// How a grain hits a partner head-on.
struct Strike {
  double mass_ratio = 1;   ///< of the second grain to the first
  double size_ratio = 1;   ///< likewise, of radii
  bool wall = false;       ///< the partner is a wall
  double speed = 1;        ///< of approach [m/s]
  double refinement = 10;  ///< safe time step over time step
  double phase = 0.5;      ///< first contact falls at this fraction of a time step
};

struct Impact {
  double restitution = 0;
  double duration = 0;  ///< of a repulsive force [s], known to a time step
  double deepest = 0;   ///< overlap [m]
  double time_step = 0;
};

/// Shoots the first grain of radius and mass 1 at its partner and watches.
template <int Dim, class Law>
Impact head_on(const Law& law, const Strike& strike) {
  const Vec<Dim> n = oblique<Dim>();
  Grain<Dim> a;
  a.radius = 1;
  a.mass = 1;
  std::vector<Grain<Dim>> list{a};
  std::vector<Wall<Dim>> walls;
  if (strike.wall) {
    walls.push_back(Wall<Dim>::half_space("target", Vec<Dim>::Zero(), n));
    list[0].position = 1.0 * n;
    list[0].velocity = -strike.speed * n;
  } else {
    Grain<Dim> b;
    b.radius = strike.size_ratio;
    b.mass = strike.mass_ratio;
    list.push_back(b);
    list[0].position = (1 + strike.size_ratio) * n;
    // A common drift must not matter.
    list[1].velocity = 0.3 * along<Dim>();
    list[0].velocity = list[1].velocity - strike.speed * n;
  }
  auto probe = make_sim<Dim>(list, law, walls, strike.refinement);
  list[0].position += strike.speed * (1 + strike.phase) * probe.setting().time_step * n;
  auto sim = make_sim<Dim>(list, law, walls, strike.refinement);

  const auto closing = [&] {
    const auto& g = sim.grains();
    Vec<Dim> v = g.velocity.col(0);
    if (!strike.wall) v -= g.velocity.col(1);
    return -v.dot(n);
  };
  Impact impact;
  impact.time_step = sim.setting().time_step;
  const double before = closing();
  int forced = 0;
  bool touched = false;
  for (int k = 0; k < 1000000; ++k) {
    sim.step();
    bool touching = false;
    const auto note = [&](auto, const Touch<Dim>& touch, const auto&, const auto&) {
      touching = touched = true;
      impact.deepest = std::max(impact.deepest, touch.overlap);
    };
    sim.for_each_contact(note);
    sim.for_each_wall_contact(note);
    if (sim.grains().force.col(0).squaredNorm() > 0) ++forced;
    if (touched && !touching) break;
  }
  impact.restitution = -closing() / before;
  impact.duration = forced * impact.time_step;
  return impact;
}

/// The overlap at which the contact's elastic force carries a load [N], by bisection.
template <int Dim, class Normal>
double static_overlap(const Normal& normal, double effective_radius, double load) {
  Touch<Dim> touch;
  touch.effective_radius = effective_radius;
  double low = 0;
  double high = effective_radius;
  for (int k = 0; k < 200; ++k) {
    touch.overlap = 0.5 * (low + high);
    (normal.elastic_force(touch) < load ? low : high) = touch.overlap;
  }
  return touch.overlap;
}

/// How a grain hits its like, or a wall, at an angle.
struct Glance {
  bool wall = true;
  double tangent = 4;     ///< tangential over normal speed before; the normal speed is 1 m/s
  double mass_ratio = 1;  ///< of the second grain to the first
  double refinement = 10;
  double phase = 0;  ///< first contact falls at this fraction of a time step
};

/// Relative velocities of the centres and the slip of the surfaces, along the normal and along the
/// first tangential motion [m/s].
struct Rebound {
  double normal = 0;
  double tangential = 0;
  double slip = 0;
};

/// Shoots a grain of radius and mass 1, without spin.
template <int Dim, class Law>
Rebound glance(const Law& law, const Glance& shot, double gap = 1e-9) {
  const Vec<Dim> n = up<Dim>();
  Vec<Dim> t = along<Dim>();
  if constexpr (Dim == 3) t = Vec<3>(0.6, 0.8, 0);
  Grain<Dim> a;
  a.radius = 1;
  a.mass = 1;
  std::vector<Grain<Dim>> list{a};
  std::vector<Wall<Dim>> walls;
  const Vec<Dim> velocity = shot.tangent * t - n;
  if (shot.wall) {
    walls.push_back(Wall<Dim>::half_space("wall", -(1 + gap) * n, n));
    list[0].velocity = velocity;
  } else {
    list.push_back(a);
    list[1].mass = shot.mass_ratio;
    list[1].position = -(2 + gap) * n + (shot.tangent * gap) * t;
    list[0].velocity = 0.5 * velocity;
    list[1].velocity = -0.5 * velocity;
  }
  auto sim = make_sim<Dim>(list, law, walls, shot.refinement);
  if (shot.phase > 0) {
    Glance later = shot;
    later.phase = 0;
    return glance<Dim>(law, later, (1 + shot.phase) * sim.setting().time_step);
  }
  bool touched = false;
  for (int k = 0; k < 1000000; ++k) {
    sim.step();
    bool touching = false;
    const auto note = [&](auto...) { touching = touched = true; };
    sim.for_each_contact([&](auto&&...) { note(); });
    sim.for_each_wall_contact([&](auto&&...) { note(); });
    if (touched && !touching) break;
  }
  const auto& g = sim.grains();
  Vec<Dim> v = g.velocity.col(0);
  SpinVec<Dim> spin = g.omega.col(0);
  if (!shot.wall) {
    v -= g.velocity.col(1);
    spin += g.omega.col(1);
  }
  return {v.dot(n), v.dot(t), (v - cross(spin, n)).dot(t)};
}

}  // namespace lagrain::test
