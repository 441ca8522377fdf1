#pragma once
/// @file
/// Beds of discs for the benchmark: settled, and shaken.

#include <lagrain/cundall_strack.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/random.hpp>
#include <lagrain/simulation.hpp>

#include <cmath>
#include <map>
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

inline Law bed_law() {
  return {LinearSpring::with_restitution(kStiffness, kRestitution), 0.5, 2.0 / 7.0, 0.2};
}

inline double disc_mass(double radius) { return radius * radius; }

/// Width [m] of the box for n discs: 40 layers, or a square if there are few.
inline double bed_width(int n) {
  return 2.0 * std::ceil(std::max(std::sqrt(static_cast<double>(n)), n / 40.0));
}

inline std::vector<Wall<2>> open_box(double width) {
  return {Wall<2>::half_space("floor", {0, 0}, {0, 1}),
          Wall<2>::half_space("left", {0, 0}, {1, 0}),
          Wall<2>::half_space("right", {width, 0}, {-1, 0})};
}

inline double bed_time_step(double smallest_radius) {
  return bed_law().contact_time(disc_mass(smallest_radius) / 2, 0) / 25;
}

/// n discs, radii uniform in [1/ratio, 1], fallen from a loose lattice and come to rest.
/// Made once for each (n, ratio) in a program run.
template <class N>
const std::vector<Grain<2>>& settled_bed(int n, double ratio) {
  static std::map<std::pair<int, double>, std::vector<Grain<2>>> made;
  auto& bed = made[{n, ratio}];
  if (!bed.empty()) return bed;

  Random random(static_cast<std::uint64_t>(n));
  const double width = bed_width(n);
  const int columns = static_cast<int>(width / 2.02);
  std::vector<Grain<2>> loose;
  double smallest = 1;
  for (int i = 0; i < n; ++i) {
    Grain<2> grain;
    grain.radius = random.uniform(1 / ratio, 1);
    grain.mass = disc_mass(grain.radius);
    smallest = std::min(smallest, grain.radius);
    const double jitter = 0.01;
    grain.position = {width / columns * (i % columns + 0.5) + random.uniform(-jitter, jitter),
                      2.02 * (i / columns) + 1.01};
    loose.push_back(grain);
  }
  Bed<N> sim(make_grains<2, Law::needs>(loose), LawTable<Law>(bed_law()), open_box(width),
             {{0, -1}, bed_time_step(smallest)});
  // Free fall over the gaps, then some sound travel times of the deepest bed.
  const double quiet = 1e-6 * sim.grains().mass.sum();
  for (int s = 0; sim.time() < 400; ++s) {
    sim.step();
    if (s % 500 == 0 && sim.time() > 20 && kinetic_energy(sim.grains()) < quiet) break;
  }
  for (int i = 0; i < n; ++i) {
    Grain<2>& grain = loose[static_cast<std::size_t>(i)];
    grain.position = sim.grains().position.col(i);
    grain.velocity.setZero();
  }
  return bed = loose;
}

/// A settled bed, running again; shaken with 4 g if asked for.
template <class N>
Bed<N> make_bed(int n, double ratio, bool shaken) {
  const std::vector<Grain<2>>& grains = settled_bed<N>(n, ratio);
  double smallest = 1;
  for (const Grain<2>& grain : grains) smallest = std::min(smallest, grain.radius);
  std::vector<Wall<2>> walls = open_box(bed_width(n));
  if (shaken) {
    const double amplitude = 1;
    const double frequency = std::sqrt(4 / amplitude) / (2 * std::numbers::pi);
    for (Wall<2>& wall : walls) wall.motion = Shake<2>{{0, amplitude}, frequency};
  }
  return Bed<N>(make_grains<2, Law::needs>(grains), LawTable<Law>(bed_law()), std::move(walls),
                {{0, -1}, bed_time_step(smallest)});
}

}  // namespace lagrain::bench
