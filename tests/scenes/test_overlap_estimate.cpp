// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How deep grains will overlap, guessed before a run: closed forms, and runs.

#include <lagrain/overlap_estimate.hpp>
#include <lagrain/run.hpp>

#include "support/scene_text.hpp"
#include "support/space.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr double kG = 9.81;
constexpr double kRadius = 0.01;
constexpr double kStiffness = 1e6;
constexpr double kModulus = 1e8;

/// A scene above a floor, or without one.
template <int Dim>
Scene<Dim> scene_of(NormalModel normal, double restitution = 1) {
  Scene<Dim> scene;
  scene.duration = 1;
  scene.gravity[Dim - 1] = -kG;
  scene.normal = normal;
  scene.law.stiffness = kStiffness;
  scene.law.modulus = kModulus;
  scene.law.impact_speed = 3;
  scene.law.restitution = restitution;
  scene.materials = {{"rock", 2500}};
  scene.walls = {Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), Vec<Dim>::Unit(Dim - 1))};
  return scene;
}

template <int Dim>
void add_grain(Scene<Dim>& scene, double height, bool pinned = false) {
  PlacedGrain<Dim> grain;
  grain.position[Dim - 1] = height;
  grain.radius = kRadius;
  grain.pinned = pinned;
  scene.grains.push_back(grain);
}

template <int Dim>
OverlapEstimate estimate_of(const Scene<Dim>& scene) {
  return estimate_overlap(*make_run(scene));
}

/// The largest overlap of a whole run, of the smaller radius.
template <int Dim>
double largest_overlap(const Scene<Dim>& scene) {
  const auto run = make_run(scene);
  double largest = 0;
  while (!run->finished()) {
    run->step();
    largest = std::max(largest, run->statistics().largest_overlap);
  }
  return largest;
}

}  // namespace

TEST_SUITE("overlap estimate") {
  TEST_CASE_TEMPLATE("a grain dropped on a floor: closed forms of both laws", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const double fall = 0.5;
    const double mass = 2500 * grain_volume<Dim>(kRadius);
    const double speed = std::sqrt(2 * kG * fall);
    for (const NormalModel normal : {NormalModel::linear, NormalModel::hertz}) {
      Scene<Dim> scene = scene_of<Dim>(normal);
      add_grain(scene, kRadius + fall);

      const OverlapEstimate guess = estimate_of(scene);

      const bool linear = normal == NormalModel::linear;
      const double hertz = 4.0 / 3 * kModulus * std::sqrt(kRadius);
      const double pressed = linear ? mass * kG / kStiffness : std::pow(mass * kG / hertz, 2.0 / 3);
      const double hit = linear ? speed * std::sqrt(mass / kStiffness)
                                : std::pow(1.25 * mass * speed * speed / hertz, 0.4);
      CHECK(relative_error(guess.load, mass * kG) < 1e-12);
      CHECK(relative_error(guess.overlap_of_load, pressed / kRadius) < 1e-9);
      CHECK(relative_error(guess.speed, speed) < 1e-9);
      CHECK(relative_error(guess.overlap_of_impact, hit / kRadius) < 1e-9);

      // The proposal makes both together 1 %.
      double& stiffness = linear ? scene.law.stiffness : scene.law.modulus;
      stiffness = guess.stiffness;
      CHECK(relative_error(estimate_of(scene).overlap(), 0.01) < 1e-9);
    }
  }

  TEST_CASE_TEMPLATE("a dropped grain overlaps as deep as was guessed, whatever its dashpot", S,
                     Space<2>, Space<3>) {
    for (const NormalModel normal : {NormalModel::linear, NormalModel::hertz}) {
      for (const double restitution : {1.0, 0.5, 0.2}) {
        Scene<S::Dim> scene = scene_of<S::Dim>(normal, restitution);
        add_grain(scene, kRadius + 0.1);
        scene.duration = 0.2;
        CAPTURE(restitution);
        CHECK(relative_error(largest_overlap(scene), estimate_of(scene).overlap_of_impact) < 0.02);
      }
    }
  }

  TEST_CASE_TEMPLATE("a column of grains: its weight, and the fall of its highest grain", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const double mass = 2500 * grain_volume<Dim>(kRadius);
    for (const double gap : {0.0, 0.001}) {
      CAPTURE(gap);
      Scene<Dim> scene = scene_of<Dim>(NormalModel::linear);
      for (int k = 0; k < 20; ++k) add_grain(scene, kRadius + gap + k * (2 * kRadius + gap));

      const OverlapEstimate guess = estimate_of(scene);

      CHECK(relative_error(guess.load, 20 * mass * kG) < 1e-12);
      CHECK(relative_error(guess.overlap_of_load, 20 * mass * kG / kStiffness / kRadius) < 1e-9);
      CHECK(std::abs(guess.speed - std::sqrt(2 * kG * 20 * gap)) < 1e-6);
      if (gap > 0) continue;
      CHECK(relative_error(guess.stiffness, 20 * mass * kG / (0.01 * kRadius)) < 1e-6);
    }
  }

  TEST_CASE_TEMPLATE("grains fall on pinned ones, into a round wall, or on nothing", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    Scene<Dim> scene = scene_of<Dim>(NormalModel::linear);
    scene.walls.clear();
    add_grain(scene, 0, true);
    add_grain(scene, 0.02 + 0.3);
    CHECK(relative_error(estimate_of(scene).speed, std::sqrt(2 * kG * 0.3)) < 1e-9);
    CHECK(relative_error(estimate_of(scene).load, kG * 2500 * grain_volume<Dim>(kRadius)) < 1e-9);

    scene.grains.erase(scene.grains.begin());
    CHECK(estimate_of(scene).speed == 0);
    scene.grains[0].velocity[0] = 3;
    CHECK(estimate_of(scene).speed == 3);

    Vec<Dim> axis = Vec<Dim>::Zero();
    if (Dim == 3) axis[1] = 1;
    scene.walls = {Wall<Dim>::cylinder("drum", Vec<Dim>::Zero(), axis, 1)};
    scene.grains[0].velocity.setZero();
    CHECK(relative_error(estimate_of(scene).speed, std::sqrt(2 * kG * (1 + 0.32 - kRadius))) <
          1e-3);
    // No grain is faster than gravity makes it while the run lasts.
    scene.duration = 0.1;
    CHECK(relative_error(estimate_of(scene).speed, kG * 0.1) < 1e-9);
  }

  TEST_CASE_TEMPLATE("beds that fall and settle overlap as guessed, within a factor of two", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const NormalModel normal : {NormalModel::linear, NormalModel::hertz}) {
      for (const double drop : {0.0, 0.1}) {
        Scene<Dim> scene = scene_of<Dim>(normal, 0.5);
        scene.duration = 0.4;
        scene.law.stiffness = Dim == 2 ? 1e7 : 1e4;
        scene.law.modulus = Dim == 2 ? 1e9 : 1e7;
        Fill<Dim> fill;
        fill.radius = UniformRadius{0.008, 0.01};
        const double width = Dim == 2 ? 0.2 : 0.08;
        fill.region.high.setConstant(width);
        fill.region.low[Dim - 1] = drop;
        fill.region.high[Dim - 1] = drop + (Dim == 2 ? 0.6 : 0.3);
        scene.fills = {fill};
        for (int d = 0; d + 1 < Dim; ++d) {
          const std::string name = std::to_string(d);
          scene.walls.push_back(
              Wall<Dim>::half_space("low" + name, Vec<Dim>::Zero(), Vec<Dim>::Unit(d)));
          scene.walls.push_back(
              Wall<Dim>::half_space("high" + name, fill.region.high, -Vec<Dim>::Unit(d)));
        }

        const OverlapEstimate guess = estimate_of(scene);

        const double expected = guess.overlap();
        const double found = largest_overlap(scene);
        CAPTURE(drop);
        CAPTURE(expected);
        CAPTURE(found);
        CHECK(found < 2 * expected);
        CHECK(found > expected / 2);
      }
    }
  }

  TEST_CASE("explain names load, impact and the stiffness for 1 %") {
    const std::string text = explain(*make_run(parse_scene<2>(kHeap, "s.toml")));
    CHECK(text.find("% of the smaller radius, to a factor of 2\n") != std::string::npos);
    CHECK(text.find("%, the heaviest column presses with ") != std::string::npos);
    CHECK(text.find("%, the deepest one at ") != std::string::npos);
    CHECK(text.find("for 1 %         stiffness = \"") != std::string::npos);
    Scene<2> still = scene_of<2>(NormalModel::hertz);
    add_grain(still, 1);
    CHECK(explain(*make_run(still)).find("for 1 %         modulus = \"") != std::string::npos);
    still.walls[0].motion = Steady<2>{Vec<2>(0, 1)};
    CHECK(explain(*make_run(still)).find("to a factor of 2, walls that move left out\n") !=
          std::string::npos);
    still.gravity.setZero();
    CHECK(explain(*make_run(still)).find("nothing moves or weighs") != std::string::npos);
  }
}
