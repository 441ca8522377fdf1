#pragma once
/// @file
/// Beds of discs for the benchmark: settled, and shaken.

#include <lagrain/cundall_strack.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/random.hpp>
#include <lagrain/simulation.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace lagrain::bench {

using Law = CundallStrack<LinearSpring>;
template <class N>
using Bed = Simulation<2, Law, VelocityVerlet<2>, N>;

/// Units: largest radius 1 m, gravity 1 m/s^2, density such that a disc of radius 1 weighs 1 N.
/// A bed 40 layers deep presses its lowest contacts by about 1 % of a radius.
inline constexpr double kStiffness = 4000;
inline constexpr double kRestitution = 0.3;
inline constexpr double kSmallest = 0.5;  // smallest radius

inline Law bed_law() {
  return {LinearSpring::with_restitution(kStiffness, kRestitution), 0.5, 2.0 / 7.0, 0.2};
}

inline double disc_mass(double radius) {
  return radius * radius;
}

/// A bed is settled in a box of at most this many discs; larger ones are made of its copies, side
/// by side, which come to rest soon after.
inline constexpr int kTile = 2500;

/// Width [m] of the box for n discs: 40 layers, or a square if there are few.
inline double bed_width(int n) {
  return n < kTile ? 2.0 * std::ceil(std::sqrt(static_cast<double>(n))) : n / 20.0;
}

inline std::vector<Wall<2>> open_box(double width) {
  return {Wall<2>::half_space("floor", {0, 0}, {0, 1}), Wall<2>::half_space("left", {0, 0}, {1, 0}),
          Wall<2>::half_space("right", {width, 0}, {-1, 0})};
}

inline double bed_time_step() {
  return bed_law().contact_time(disc_mass(kSmallest) / 2, 0) / 25;
}

/// The box is shaken up and down by one radius, with 4 times gravity.
inline constexpr double kAmplitude = 1;
inline double shake_frequency() {
  return std::sqrt(4 / kAmplitude) / (2 * std::numbers::pi);
}
inline int steps_per_shake() {
  return static_cast<int>(1 / (shake_frequency() * bed_time_step()));
}

/// Fall from a loose lattice until nearly at rest: n discs, radii uniform in [1/2, 1].
template <class N>
std::vector<Grain<2>> settle(int n) {
  Random random(static_cast<std::uint64_t>(n));
  const double width = bed_width(n);
  const int columns = static_cast<int>(width / 2.02);
  std::vector<Grain<2>> grains;
  for (int i = 0; i < n; ++i) {
    Grain<2> grain;
    grain.radius = random.uniform(kSmallest, 1);
    grain.mass = disc_mass(grain.radius);
    grain.position = {width / columns * (i % columns + 0.5) + random.uniform(-0.01, 0.01),
                      2.02 * (i / columns) + 1.01};
    grains.push_back(grain);
  }
  Bed<N> sim(make_grains<2, Law::needs>(grains), LawTable<Law>(bed_law()), open_box(width),
             {{0, -1}, bed_time_step()});
  const double quiet = 1e-5 * sim.grains().mass.sum();
  while (sim.time() < 30 || kinetic_energy(sim.grains()) > quiet) {
    for (int s = 0; s < 500; ++s) sim.step();
  }
  for (int i = 0; i < n; ++i) {
    grains[static_cast<std::size_t>(i)].position = sim.grains().position.col(i);
  }
  return grains;
}

/// A settled bed of n discs, shaken with 4 g if asked for.
/// @pre n < kTile, or a multiple of it
template <class N>
Bed<N> make_bed(int n, bool shaken) {
  static std::map<int, std::vector<Grain<2>>> settled;
  const int tile = std::min(n, kTile);
  if (settled[tile].empty()) settled[tile] = settle<N>(tile);

  std::vector<Grain<2>> grains;
  for (int i = 0; i < n; ++i) {
    grains.push_back(settled[tile][static_cast<std::size_t>(i % tile)]);
    grains.back().position.x() += bed_width(tile) * (i / tile);
  }
  std::vector<Wall<2>> walls = open_box(bed_width(n));
  if (shaken) {
    for (Wall<2>& wall : walls) wall.motion = Shake<2>{{0, kAmplitude}, shake_frequency()};
  }
  return Bed<N>(make_grains<2, Law::needs>(grains), LawTable<Law>(bed_law()), std::move(walls),
                {{0, -1}, bed_time_step()});
}

}  // namespace lagrain::bench
