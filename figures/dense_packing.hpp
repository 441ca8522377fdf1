// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Dense random packings for the report: grains that nearly touch, as they do at rest.

#include <lagrain/grains.hpp>
#include <lagrain/placement.hpp>
#include <lagrain/scene.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace lagrain::figures {

/// Solid fraction of these packings [-]: below random close packing, so that a few hundred grains,
/// of which many stand at a wall, still find room.
template <int Dim>
inline constexpr double kDense = Dim == 2 ? 0.75 : 0.5;

/// Grains of radius 0.7 to 1 m in a box, pushed apart until none overlaps another. Largest first.
template <int Dim>
std::vector<Grain<Dim>> dense_packing(int count, std::uint64_t seed) {
  constexpr double kLeast = 0.7;
  // Mean of r^Dim over the radii.
  const double mean = (1 - std::pow(kLeast, Dim + 1)) / ((Dim + 1) * (1 - kLeast));
  const double side = std::pow(count * mean * grain_volume<Dim>(1.0) / kDense<Dim>, 1.0 / Dim);
  Scene<Dim> scene;
  scene.seed = seed;
  scene.materials = {{"stone", 2500}};
  Fill<Dim> fill;
  fill.name = "dense";
  fill.count = count;
  fill.radius = UniformRadius{kLeast, 1};
  fill.region.high = Vec<Dim>::Constant(side);
  fill.arrangement = Arrangement::random;
  scene.fills = {fill};
  return place_grains(scene).grains;
}

}  // namespace lagrain::figures
