// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Small scenes whose answer is known, run with a step and timed: what diagrams of error against
/// time are made of.

#include "figure.hpp"
#include "measure.hpp"

#include <lagrain/run.hpp>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

inline constexpr double kTrialRadius = 0.01;    // [m]
inline constexpr double kTrialDensity = 2500;   // [kg/m^3]; a disc is a rod 1 m long
inline constexpr double kTrialStiffness = 1e6;  // [N/m]
inline constexpr double kTrialGravity = 9.81;   // [m/s^2]

/// A scene without grains, for few grains of kTrialRadius.
template <int Dim>
Scene<Dim> empty_trial() {
  Scene<Dim> scene;
  scene.neighbourhood = NeighbourhoodModel::all_pairs;
  scene.law.stiffness = kTrialStiffness;
  scene.materials = {{"stone", kTrialDensity}};
  return scene;
}

/// Mass of a trial's grain [kg].
template <int Dim>
double trial_mass() {
  return kTrialDensity * grain_volume<Dim>(kTrialRadius);
}

/// A scene that has been run to its end, and what that took.
template <int Dim>
struct Trial {
  std::unique_ptr<Run<Dim>> run;
  double cost = 0;  ///< processor time over simulated time [-]
};

/// Runs the scene to its duration in whole steps, the last of which ends there; again and again
/// until the clock can tell. The cost is the median of these runs: the first finds cold caches.
/// @param step  wanted; the one taken divides the duration [s]
/// @throws Interrupted
template <int Dim>
Trial<Dim> run_trial(Scene<Dim> scene, double step, const FigureOptions& options) {
  constexpr double kLeast = 3e-3, kLong = 5e-2;  // [s]
  const double steps = std::ceil(scene.duration / step * (1 - 1e-9));
  scene.time_step.seconds = scene.duration / steps;
  Trial<Dim> trial;
  std::vector<double> costs;
  double all = 0;
  do {
    options.check_stop();
    trial.run = make_run(scene, 1);
    const double start = bench::processor_seconds();
    while (!trial.run->finished()) trial.run->step();
    const double spent = bench::processor_seconds() - start;
    costs.push_back(spent / scene.duration);
    all += spent;
  } while (all < kLeast || (costs.size() < 3 && all < kLong));
  trial.cost = bench::median_of(costs);
  return trial;
}

/// Error [-] and cost [-] of one choice at one step.
struct Outcome {
  double error = 0;
  double cost = 0;
};

/// The root of the mean square error over phases of the first contact within a step: what a single
/// phase gives is luck.
/// @param trial  trial(phase in [0, 1))
template <class F>
Outcome over_phases(F&& trial, int phases = 8) {
  Outcome mean;
  for (int k = 0; k < phases; ++k) {
    const Outcome one = trial((k + 0.5) / phases);
    mean.error += one.error * one.error / phases;
    mean.cost += one.cost / phases;
  }
  mean.error = std::sqrt(mean.error);
  return mean;
}

}  // namespace lagrain::figures
