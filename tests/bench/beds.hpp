#pragma once
/// @file
/// Beds of grains for the benchmark: discs and spheres, of like and of unlike sizes, settled and
/// shaken.

#include <lagrain/cundall_strack.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/random.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

namespace lagrain::bench {

using Law = CundallStrack<LinearSpring>;
template <int Dim, class N>
using Bed = Simulation<Dim, Law, VelocityVerlet, N>;

/// Radii [m]: all 1; uniform in [1/2, 1]; half of the volume 1 and half 1/10.
enum class Sizes { equal, spread, mixed };

inline double smallest_radius(Sizes sizes) {
  return sizes == Sizes::equal ? 1 : sizes == Sizes::spread ? 0.5 : 0.1;
}

/// Units: largest radius 1 m, gravity 1 m/s^2, density such that a grain of radius 1 weighs 1 N. A
/// bed 40 layers deep presses its lowest contacts by about 1 % of a radius. Stiffness follows the
/// smaller radius of a pair, so that this holds for small grains too.
inline constexpr double kStiffness = 4000;
inline constexpr double kRestitution = 0.3;

template <int Dim>
double grain_mass(double radius) {
  return std::pow(radius, Dim);
}

inline Law law_of(double radius) {
  return {LinearSpring::with_restitution(kStiffness * radius, kRestitution), 0.5, 2.0 / 7.0, 0.2};
}
/// Kind 0 are large grains and walls, kind 1 the small ones of a mixture.
inline LawTable<Law> bed_laws(Sizes sizes) {
  LawTable<Law> laws(law_of(1), 2);
  if (sizes == Sizes::mixed) {
    laws.set(0, 1, law_of(smallest_radius(sizes)));
    laws.set(1, 1, law_of(smallest_radius(sizes)));
  }
  return laws;
}

template <int Dim>
double bed_time_step(Sizes sizes) {
  const double r = smallest_radius(sizes);
  return law_of(sizes == Sizes::mixed ? r : 1).contact_time(grain_mass<Dim>(r) / 2, 0) / 25;
}

/// A bed is settled in a box of at most this many grains; larger ones are made of its copies, side
/// by side, which come to rest soon after.
inline constexpr int kTile = 2500;

/// The box is shaken up and down by one radius, with 4 times gravity.
inline constexpr double kAmplitude = 1;
inline double shake_frequency() {
  return std::sqrt(4 / kAmplitude) / (2 * std::numbers::pi);
}
template <int Dim>
int steps_per_shake(Sizes sizes) {
  return static_cast<int>(1 / (shake_frequency() * bed_time_step<Dim>(sizes)));
}

template <int Dim>
struct Tile {
  std::vector<Grain<Dim>> grains;
  double width;  ///< along x, and in space along y [m]
};

/// A box without a lid, `length` along x and `width` across.
template <int Dim>
std::vector<Wall<Dim>> open_box(double length, double width) {
  std::vector<Wall<Dim>> walls;
  const Vec<Dim> origin = Vec<Dim>::Zero();
  const auto up = Vec<Dim>::Unit(Dim - 1);
  walls.push_back(Wall<Dim>::half_space("floor", origin, up));
  for (int axis = 0; axis < Dim - 1; ++axis) {
    const Vec<Dim> across = Vec<Dim>::Unit(axis);
    const Vec<Dim> far = (axis == 0 ? length : width) * across;
    walls.push_back(Wall<Dim>::half_space("low " + std::to_string(axis), origin, across));
    walls.push_back(Wall<Dim>::half_space("high " + std::to_string(axis), far, -across));
  }
  return walls;
}

template <int Dim, class N>
Bed<Dim, N> make_bed(const std::vector<Grain<Dim>>& grains, std::vector<Wall<Dim>> walls,
                     Sizes sizes) {
  return Bed<Dim, N>(make_grains<Dim, Law::needs>(grains), bed_laws(sizes), std::move(walls),
                     {-Vec<Dim>::Unit(Dim - 1), bed_time_step<Dim>(sizes)});
}

/// Falls from loose lattices, the larger grains lowest, until nearly at rest.
template <int Dim>
Tile<Dim> settle(int n, Sizes sizes) {
  Random random(static_cast<std::uint64_t>(n));
  const double small = smallest_radius(sizes);
  // Half of the volume each: as many small grains per large one as go into its volume.
  const int large =
      sizes == Sizes::mixed ? std::max(1, static_cast<int>(n * std::pow(small, Dim))) : n;
  std::vector<Grain<Dim>> grains;
  double volume = 0;  // of the cubes round the grains
  for (int i = 0; i < n; ++i) {
    Grain<Dim> grain;
    grain.radius = i >= large ? small : sizes == Sizes::spread ? random.uniform(small, 1) : 1;
    grain.mass = grain_mass<Dim>(grain.radius);
    grain.kind = sizes == Sizes::mixed && i >= large ? 1 : 0;
    volume += std::pow(2 * grain.radius, Dim);
    grains.push_back(grain);
  }
  // In the plane 40 layers, unless there are few grains; in space as wide as deep.
  const double side = 1.05 * std::pow(volume, 1.0 / Dim);
  const double width = std::max(2.1, Dim == 2 && n >= kTile ? volume / 80 : side);

  double floor = 0;
  for (int first = 0; first < n;) {
    const int end = first < large ? large : n;
    const double cell = 2.02 * (first < large ? 1 : small);
    const int across = static_cast<int>(width / cell);
    for (int i = first; i < end; ++i) {
      int rest = i - first;
      Vec<Dim>& x = grains[static_cast<std::size_t>(i)].position;
      for (int axis = 0; axis < Dim - 1; ++axis, rest /= across) {
        x[axis] = width / across * (rest % across + 0.5) + 0.005 * cell * random.uniform(-1, 1);
      }
      x[Dim - 1] = floor + cell * (rest + 0.5);
      if (i == end - 1) floor = x[Dim - 1] + cell / 2;
    }
    first = end;
  }

  auto bed =
      make_bed<Dim, TriangulationNeighbourhood<Dim>>(grains, open_box<Dim>(width, width), sizes);
  const double quiet = 1e-5 * bed.grains().mass.sum();
  while (bed.time() < 30 || kinetic_energy(bed.grains()) > quiet) {
    for (int s = 0; s < 500; ++s) bed.step();
  }
  for (int i = 0; i < n; ++i) {
    grains[static_cast<std::size_t>(i)].position = bed.grains().position.col(i);
  }
  return {grains, width};
}

/// A settled bed of n grains, shaken with 4 g if asked for.
/// @pre n < kTile, or a multiple of it
template <int Dim, class N>
Bed<Dim, N> make_bed(int n, Sizes sizes, bool shaken) {
  static std::map<std::pair<int, Sizes>, Tile<Dim>> settled;
  const int count = std::min(n, kTile);
  Tile<Dim>& tile = settled[{count, sizes}];
  if (tile.grains.empty()) tile = settle<Dim>(count, sizes);

  std::vector<Grain<Dim>> grains;
  for (int i = 0; i < n; ++i) {
    grains.push_back(tile.grains[static_cast<std::size_t>(i % count)]);
    grains.back().position.x() += tile.width * (i / count);
  }
  std::vector<Wall<Dim>> walls = open_box<Dim>(tile.width * (n / count), tile.width);
  if (shaken) {
    for (Wall<Dim>& wall : walls) {
      wall.motion = Shake<Dim>{kAmplitude * Vec<Dim>::Unit(Dim - 1), shake_frequency()};
    }
  }
  return make_bed<Dim, N>(grains, std::move(walls), sizes);
}

}  // namespace lagrain::bench
