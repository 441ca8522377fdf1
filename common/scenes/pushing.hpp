// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Pushes overlapping grains apart. Included by placement.cpp alone.

#include <lagrain/cell_grid.hpp>
#include <lagrain/compiled_kernels.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/simulation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lagrain::detail {

/// Motion in syrup: what a push gives is soon lost again.
struct Syrup {
  static constexpr const char* kName = "syrup";
  static constexpr bool kConservativeOnly = false;
  static constexpr int kEvaluations = 1;
  static constexpr double kKept = 0.9;  ///< of the velocity, in a step
  static constexpr double time_of(int) { return 1; }

  template <class V>
  static void advance(int, V& x, V& v, const V& a, double dt) {
    v = kKept * v + dt * a;
    x += dt * v;
  }
  template <class V>
  static void finish(V&, V&, const V&, const V&, double) {}
};

/// Moves the grains that are not pinned until none overlaps another or a wall; walls stay as they
/// are. Springs that are a little longer than the grains do it, so that the last contact opens
/// after finitely many steps.
///
/// @param grains velocities are left alone, masses too
/// @param most   steps after which it gives up
/// @param look   called every few steps; what it throws ends it
/// @return the largest overlap left, of the smaller radius; 0 if nothing overlaps [-]
template <int Dim, class Look>
double push_apart(std::vector<Grain<Dim>>& grains, std::vector<Wall<Dim>> walls, int most,
                  Look&& look) {
  constexpr double kSurplus = 0.005;  // of a radius
  constexpr int kLookEvery = 10;      // steps
  double smallest = std::numeric_limits<double>::infinity();
  for (const Grain<Dim>& grain : grains) smallest = std::min(smallest, grain.radius);

  std::vector<Grain<Dim>> soft = grains;
  for (Grain<Dim>& grain : soft) {
    // As heavy as its surface has room for neighbours: together they cannot shake it.
    grain.mass = std::pow(grain.radius / smallest, Dim - 1);
    grain.radius *= 1 + kSurplus;
    grain.velocity.setZero();
    grain.omega.setZero();
  }
  for (Wall<Dim>& wall : walls) {
    wall.velocity.setZero();
    wall.motion = Fixed{};
    wall.turning = Upright{};
    wall.until = std::numeric_limits<double>::infinity();
  }
  const LinearSpring spring{.stiffness = 1};
  auto state = make_grains<Dim, LinearSpring::needs>(soft);
  Setting<Dim> setting;
  setting.time_step = time_scales(state, LawTable(spring), walls).safe_step;
  setting.largest_overlap = std::numeric_limits<double>::infinity();
  Simulation<Dim, LinearSpring, Syrup, CellGrid<Dim>> sim(std::move(state), LawTable(spring), walls,
                                                          setting);

  // Half of the surplus stays as a gap: rounding cannot close it.
  const auto largest_overlap = [&] {
    const auto& r = sim.grains().radius;
    double largest = 0;
    const auto note = [&](double overlap, double reach, double smaller) {
      const double real = overlap - 0.5 * kSurplus * reach;
      largest = std::max(largest, real / smaller);
    };
    sim.for_each_contact([&](Pair pair, const Touch<Dim>& touch, const auto&, const auto&) {
      note(touch.overlap, r[pair.i] + r[pair.j], std::min(r[pair.i], r[pair.j]));
    });
    sim.for_each_wall_contact([&](WallPair pair, const Touch<Dim>& touch, const auto&,
                                  const auto&) { note(touch.overlap, r[pair.i], r[pair.i]); });
    return largest;
  };
  double left = largest_overlap();
  while (left > 0 && sim.steps() < most) {
    sim.step(kLookEvery);
    look();
    left = largest_overlap();
  }
  for (std::size_t i = 0; i < grains.size(); ++i) {
    grains[i].position = sim.grains().position.col(static_cast<Eigen::Index>(i));
  }
  return left;
}

}  // namespace lagrain::detail
