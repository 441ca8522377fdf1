// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What the scenes of the hard cases are made of: stone, gravity, grains put by hand, a tub.

#include "hard_cases.hpp"

#include <lagrain/run.hpp>

#include <cmath>
#include <limits>
#include <string>

namespace lagrain::hard_cases {

inline constexpr double kGravity = 9.81;  // [m/s^2]
inline constexpr double kDensity = 2500;  // [kg/m^3]
inline constexpr double kRadius = 0.01;   // [m]

/// The restitution of what is to come to rest soon: strong dashpots.
inline constexpr double kDeadRestitution = 0.05;

/// The distance from |x| to the next double.
inline double last_bit_of(double x) {
  return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x);
}

/// The weight of a grain of stone [N].
template <int Dim>
double weight(double radius) {
  return kDensity * grain_volume<Dim>(radius) * kGravity;
}

/// A scene of stone without grains and walls. Its duration plays no part: the cases count steps.
template <int Dim>
Scene<Dim> stone(const std::string& title, double stiffness, double restitution) {
  Scene<Dim> scene;
  scene.title = title;
  scene.duration = 1;
  scene.law.stiffness = stiffness;
  scene.law.restitution = restitution;
  scene.materials = {{"stone", kDensity}};
  return scene;
}

/// Lets gravity act.
template <int Dim>
void fall(Scene<Dim>& scene) {
  scene.gravity = -kGravity * Vec<Dim>::Unit(Dim - 1);
}

/// Takes the largest step that the scene's contacts allow.
template <int Dim>
void step_widely(Scene<Dim>& scene) {
  scene.time_step.fraction_of_contact = 1e-3;
  scene.time_step.seconds = make_run(scene, 1)->time_scales().safe_step;
}

/// Adds a grain of the first material.
template <int Dim>
void put(Scene<Dim>& scene, const Vec<Dim>& position, double radius = kRadius,
         const Vec<Dim>& velocity = Vec<Dim>::Zero()) {
  PlacedGrain<Dim> grain;
  grain.position = position;
  grain.radius = radius;
  grain.velocity = velocity;
  scene.grains.push_back(grain);
}

/// A floor, and sides around a square of the given width [m] from a corner on.
template <int Dim>
void add_tub(Scene<Dim>& scene, const Vec<Dim>& corner, double width) {
  scene.walls.push_back(Wall<Dim>::half_space("floor", corner, Vec<Dim>::Unit(Dim - 1)));
  for (int axis = 0; axis < Dim - 1; ++axis) {
    const Vec<Dim> across = Vec<Dim>::Unit(axis);
    const std::string name = axis == 0 ? "side" : "front";
    scene.walls.push_back(Wall<Dim>::half_space(name, corner, across));
    scene.walls.push_back(Wall<Dim>::half_space("other " + name, corner + width * across, -across));
  }
}

/// Steps a run, holds its near list against brute force now and then, and notes what ends it.
/// @param look   called after each of these checks

/// A weight presses a contact of a crystal in by this part of the radius.
inline constexpr double kCrystalOverlap = 1e-5;
/// The slowest mode of a column of ten decays as exp(-1.4e-3 k) in k steps (see tower): to 1e-12.
inline constexpr std::int64_t kCrystalSteps = 20000;

/// A crystal of touching grains that fills a tub from a corner on.
template <int Dim>
Scene<Dim> crystal_scene(Crystal crystal, const Vec<Dim>& corner);

}  // namespace lagrain::hard_cases
