// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Beds of grains for the benchmark and the speed report: settled, of like and of unlike sizes,
/// shaken, collapsing, hit.

#include "figure.hpp"

#include <lagrain/compiled_kernels.hpp>
#include <lagrain/cundall_strack.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/random.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lagrain::bench {

using Law = CundallStrack<LinearSpring>;
template <int Dim, class N>
using BedSimulation = Simulation<Dim, Law, VelocityVerlet, N>;

inline constexpr double kGravity = 9.81;  // [m/s^2]
inline constexpr double kDensity = 2500;  // [kg/m^3]; a disc is a rod 1 m long
/// Stiffness over the radius of the small grains [N/m^2]: overlaps at rest are far below 1 %.
template <int Dim>
inline constexpr double kHardness = Dim == 2 ? 5e8 : 1e8;
inline constexpr double kRestitution = 0.5;
inline constexpr double kFriction = 0.5;
inline constexpr double kTangentialDamping = 0.2;
inline constexpr double kStepsPerContact = 25;
inline constexpr double kLargestOverlap = 0.5;  // a hard impact is deep, and still measured
/// Beds of more grains are made with all cores: a step is then long against waking them, as
/// bench_threads shows. A wrong number costs time in making beds and nothing else, since any number
/// of threads gives the same bits.
inline constexpr int kShareFrom = 5000;

/// A state to start from: what every contender is given. Wall 0 is the floor.
template <int Dim>
struct Bed {
  std::vector<Grain<Dim>> grains;
  std::vector<Wall<Dim>> walls;
  Law law;
  Setting<Dim> setting;
  Vec<Dim> size = Vec<Dim>::Zero();  ///< of the box; its height is that of the grains [m]

  int count() const { return static_cast<int>(grains.size()); }
};

template <int Dim, class N>
BedSimulation<Dim, N> simulate(const Bed<Dim>& bed, N neighbourhood = {}) {
  return BedSimulation<Dim, N>(make_grains<Dim, Law::needs>(bed.grains), LawTable<Law>(bed.law),
                               bed.walls, bed.setting, std::move(neighbourhood));
}

/// The law and the time step for grains whose ordinary size and smallest size are given.
/// @param softness  divides the stiffness: a soft bed comes to rest in fewer steps
template <int Dim>
void choose_law(Bed<Dim>& bed, double radius, double smallest, double restitution = kRestitution,
                double softness = 1) {
  bed.law = {LinearSpring::with_restitution(kHardness<Dim> * radius / softness, restitution),
             kFriction, 2.0 / 7.0, kTangentialDamping};
  bed.setting.gravity = -kGravity * Vec<Dim>::Unit(Dim - 1);
  const double mass = kDensity * grain_volume<Dim>(smallest);
  bed.setting.time_step = bed.law.contact_time(mass / 2, smallest / 2) / kStepsPerContact;
  bed.setting.largest_overlap = kLargestOverlap;
}

/// A floor, and sides if they stand; no lid.
template <int Dim>
std::vector<Wall<Dim>> open_box(const Vec<Dim>& size) {
  const Vec<Dim> origin = Vec<Dim>::Zero();
  std::vector<Wall<Dim>> walls{Wall<Dim>::half_space("floor", origin, Vec<Dim>::Unit(Dim - 1))};
  for (int axis = 0; axis < Dim - 1; ++axis) {
    const Vec<Dim> across = Vec<Dim>::Unit(axis);
    const Vec<Dim> far = size[axis] * across;
    walls.push_back(Wall<Dim>::half_space("low " + std::to_string(axis), origin, across));
    walls.push_back(Wall<Dim>::half_space("high " + std::to_string(axis), far, -across));
  }
  return walls;
}

template <int Dim>
void measure_height(Bed<Dim>& bed) {
  double top = 0;
  for (const Grain<Dim>& grain : bed.grains) {
    top = std::max(top, grain.position[Dim - 1] + grain.radius);
  }
  bed.size[Dim - 1] = top;
}

/// The bed so many steps later. Memories of contacts stay behind: every contender starts without.
template <int Dim>
void advance(Bed<Dim>& bed, int steps, const StopCheck& check_stop) {
  auto sim = simulate<Dim, TriangulationNeighbourhood<Dim>>(bed);
  // The same bits with any number of threads, and only runs in turns are measured.
  if (bed.count() > kShareFrom) {
    sim.use_threads(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  }
  constexpr int kBetweenChecks = 100;
  for (int s = 0; s < steps; s += kBetweenChecks) {
    sim.step(std::min(kBetweenChecks, steps - s));
    check_stop();
  }
  const auto& g = sim.grains();
  for (int i = 0; i < g.size(); ++i) {
    Grain<Dim>& grain = bed.grains[static_cast<std::size_t>(i)];
    grain.position = g.position.col(i);
    grain.velocity = g.velocity.col(i);
    grain.omega = g.omega.col(i);
  }
  measure_height(bed);
}

template <int Dim>
void halt(Bed<Dim>& bed) {
  for (Grain<Dim>& grain : bed.grains) {
    grain.velocity.setZero();
    grain.omega.setZero();
  }
}

/// Steps for a time given in units of sqrt(r / g), in which a grain falls by half its radius.
template <int Dim>
int steps_for(const Bed<Dim>& bed, double radius, double times) {
  return static_cast<int>(std::ceil(times * std::sqrt(radius / kGravity) / bed.setting.time_step));
}

/// What to pour into a box.
template <int Dim>
struct Pour {
  int count = 0;
  double radius = 0;    ///< of the largest [m]
  double smallest = 0;  ///< radii are uniform between the two [m]
  double width = 0;     ///< of the box, along every horizontal axis [m]
};

/// Grains let down one after the other: each onto those before it, at the lowest of a few places.
template <int Dim>
std::vector<Grain<Dim>> let_down(const Pour<Dim>& what) {
  constexpr int kPlaces = 40;
  Random random(static_cast<std::uint64_t>(what.count));
  std::vector<Grain<Dim>> grains;
  for (int i = 0; i < what.count; ++i) {
    Grain<Dim> grain;
    grain.radius =
        what.smallest < what.radius ? random.uniform(what.smallest, what.radius) : what.radius;
    grain.mass = kDensity * grain_volume<Dim>(grain.radius);
    for (int place = 0; place < kPlaces; ++place) {
      Vec<Dim> x;
      for (int axis = 0; axis < Dim - 1; ++axis) {
        x[axis] = random.uniform(grain.radius, what.width - grain.radius);
      }
      x[Dim - 1] = grain.radius;
      for (const Grain<Dim>& below : grains) {
        const double reach = 1.001 * (grain.radius + below.radius);
        const double beside = (x - below.position).template head<Dim - 1>().squaredNorm();
        if (beside >= reach * reach) continue;
        x[Dim - 1] =
            std::max(x[Dim - 1], below.position[Dim - 1] + std::sqrt(reach * reach - beside));
      }
      if (place == 0 || x[Dim - 1] < grain.position[Dim - 1]) grain.position = x;
    }
    grains.push_back(grain);
  }
  return grains;
}

/// A part of settling.
struct Stage {
  double softness;  ///< divides the stiffness
  double time;      ///< [sqrt(r / g)]
};

/// Lets a bed come to rest: soft at first, which takes fewer steps. It settles with strong dashpots
/// and little friction: contenders start without the memory of contacts, and what leant on friction
/// would move again.
template <int Dim>
void settle(Bed<Dim>& bed, double radius, double smallest, const std::vector<Stage>& stages,
            const StopCheck& check_stop) {
  constexpr double kSettlingFriction = 0.1, kSettlingRestitution = 0.1;
  for (const Stage& stage : stages) {
    choose_law<Dim>(bed, radius, smallest, kSettlingRestitution, stage.softness);
    bed.law.friction = kSettlingFriction;
    halt(bed);
    advance<Dim>(bed, steps_for(bed, radius, stage.time), check_stop);
  }
}

/// Grains in a box that have come to rest.
template <int Dim>
Bed<Dim> pour(const Pour<Dim>& what, const StopCheck& check_stop) {
  Bed<Dim> bed;
  bed.size.setConstant(what.width);
  bed.walls = open_box<Dim>(bed.size);
  bed.grains = let_down(what);
  // In the plane columns weigh more, so that soft discs would overlap deeply.
  settle<Dim>(bed, what.radius, what.smallest,
              Dim == 2 ? std::vector<Stage>{{4, 25}, {2, 6}, {1, 4}}
                       : std::vector<Stage>{{16, 15}, {4, 3}, {1, 3}},
              check_stop);
  choose_law<Dim>(bed, what.radius, what.smallest);
  return bed;
}

/// Copies of a bed side by side, every other one mirrored: what leant on a wall then leans on its
/// own image, and the whole is nearly at rest.
template <int Dim>
Bed<Dim> tiled(const Bed<Dim>& tile, const std::vector<int>& copies) {
  Bed<Dim> bed = tile;
  for (int axis = 0; axis < Dim - 1; ++axis) {
    const std::vector<Grain<Dim>> one = bed.grains;
    const double width = tile.size[axis];
    const int count = copies[static_cast<std::size_t>(axis)];
    for (int c = 1; c < count; ++c) {
      for (Grain<Dim> grain : one) {
        double& x = grain.position[axis];
        x = c % 2 == 0 ? c * width + x : (c + 1) * width - x;
        bed.grains.push_back(grain);
      }
    }
    bed.size[axis] = count * width;
  }
  bed.walls = open_box<Dim>(bed.size);
  return bed;
}

/// Large grains stand on the floor, in a row (in space in rows), in place of the small ones that
/// were there.
template <int Dim>
void put_large_grains(Bed<Dim>& bed, double radius, int count, const StopCheck& check_stop) {
  const int rows = Dim == 2 ? 1
                            : std::max(1, static_cast<int>(std::lround(std::sqrt(
                                              count * bed.size[Dim == 2 ? 0 : 1] / bed.size[0]))));
  std::vector<Grain<Dim>> large;
  for (int k = 0; k < count; ++k) {
    Grain<Dim> grain;
    const int row = k % rows, place = k / rows, places = (count - row + rows - 1) / rows;
    grain.position[0] = bed.size[0] * (place + 0.5) / places;
    if (Dim == 3) grain.position[1] = bed.size[1] * (row + 0.5) / rows;
    grain.radius = radius;
    grain.mass = kDensity * grain_volume<Dim>(radius);
    // As deep in the floor as its weight presses it: a drop would shake the bed.
    grain.position[Dim - 1] = radius - grain.mass * kGravity / bed.law.normal.stiffness;
    large.push_back(grain);
  }
  double ordinary = 0, smallest = radius;
  for (const Grain<Dim>& grain : bed.grains) {
    ordinary = std::max(ordinary, grain.radius);
    smallest = std::min(smallest, grain.radius);
  }
  std::erase_if(bed.grains, [&](const Grain<Dim>& small) {
    return std::any_of(large.begin(), large.end(), [&](const Grain<Dim>& grain) {
      const double reach = grain.radius + small.radius;
      return (grain.position - small.position).squaredNorm() < reach * reach;
    });
  });
  bed.grains.insert(bed.grains.end(), large.begin(), large.end());
  // Not softened: a bed this wide would leap when it hardens.
  settle<Dim>(bed, ordinary, smallest, {{1, Dim == 2 ? 3 : 8}}, check_stop);
  choose_law<Dim>(bed, ordinary, smallest);
}

/// Period of shaking by one radius with four times gravity [s].
inline double shake_period(double radius) {
  return std::numbers::pi * std::sqrt(radius / kGravity);
}

/// Shakes the box up and down by one radius with four times gravity, and stops where it turns, at
/// its lowest: every contender goes on from there.
template <int Dim>
void shake(Bed<Dim>& bed, double radius, const StopCheck& check_stop) {
  const double period = shake_period(radius);
  const double to_the_lowest = 1.75 * period;
  const int steps = static_cast<int>(std::lround(to_the_lowest / bed.setting.time_step));
  const auto set = [&](double start) {
    for (Wall<Dim>& wall : bed.walls) {
      wall.motion = Shake<Dim>{radius * Vec<Dim>::Unit(Dim - 1), 1 / period, start};
    }
  };
  set(0);
  advance<Dim>(bed, steps, check_stop);
  set(-to_the_lowest);
}

}  // namespace lagrain::bench
