// SPDX-License-Identifier: GPL-3.0-or-later
// Strong dashpots at the step that is called safe. Where it was too long, forces in a crystal
// alternated from step to step for ever, and walls reported nonsense.

#include <lagrain/run.hpp>

#include <support/space.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr double kRadius = 0.01;   // [m]
constexpr double kGravity = 9.81;  // [m/s^2]

/// No grains yet; the weight of one presses a contact in by 1e-5 r.
template <int Dim>
Scene<Dim> on_a_floor(double restitution) {
  Scene<Dim> scene;
  scene.duration = 1;
  scene.materials = {{"stone", 2500}};
  scene.gravity = -kGravity * Vec<Dim>::Unit(Dim - 1);
  scene.law.stiffness = 2500 * grain_volume<Dim>(kRadius) * kGravity / (1e-5 * kRadius);
  scene.law.restitution = restitution;
  scene.walls.push_back(Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), Vec<Dim>::Unit(Dim - 1)));
  return scene;
}

/// @param x  [kRadius]
template <int Dim>
void put(Scene<Dim>& scene, const Vec<Dim>& x) {
  PlacedGrain<Dim> grain;
  grain.position = kRadius * x;
  grain.radius = kRadius;
  scene.grains.push_back(grain);
}

Scene<2> tower(double restitution) {
  auto scene = on_a_floor<2>(restitution);
  for (int k = 0; k < 8; ++k) put<2>(scene, {0, 2 * k + 1});
  return scene;
}

/// Hexagonal, or face-centred cubic, in a tub.
template <int Dim>
Scene<Dim> closest_packing(double restitution) {
  auto scene = on_a_floor<Dim>(restitution);
  const int across = Dim == 2 ? 8 : 5, layers = Dim == 2 ? 8 : 6;
  const double rise = Dim == 2 ? std::numbers::sqrt3 : std::numbers::sqrt2;
  for (int k = 0; k < layers; ++k) {
    const int n = across - k % 2;
    for (int i = 0; i < (Dim == 2 ? n : n * n); ++i) {
      Vec<Dim> x = Vec<Dim>::Constant(1 + k % 2);
      x[0] += 2 * (i % n);
      if (Dim == 3) x[1] += 2 * (i / n);
      x[Dim - 1] = 1 + rise * k;
      put<Dim>(scene, x);
    }
  }
  for (int d = 0; d < Dim - 1; ++d) {
    const Vec<Dim> along = Vec<Dim>::Unit(d);
    scene.walls.push_back(Wall<Dim>::half_space("low", Vec<Dim>::Zero(), along));
    scene.walls.push_back(Wall<Dim>::half_space("high", 2 * kRadius * across * along, -along));
  }
  return scene;
}

/// What is left after so many steps, each the safe one.
struct Rest {
  double floor = 0;  ///< force on it over the weight [-]
  double spin = 0;   ///< the largest, times the radius [m/s]
};

template <int Dim>
Rest after_safe_steps(Scene<Dim> scene, int steps) {
  scene.time_step.seconds = 1e-12;
  scene.time_step.seconds = make_run(scene, 1)->time_scales().safe_step;
  const auto run = make_run(scene, 1);
  for (int k = 0; k < steps; ++k) run->step();
  return {-run->walls()[0].force[Dim - 1] / (run->masses().sum() * kGravity),
          run->spins() ? run->spins()->cwiseAbs().maxCoeff() * kRadius : 0};
}

}  // namespace

TEST_SUITE("strong dashpots") {
  TEST_CASE("a tower comes to rest at the safe step, however strong its dashpots") {
    for (const double e : {0.3, 0.1, 0.05, 0.01}) {
      CAPTURE(e);
      CHECK(std::abs(after_safe_steps(tower(e), 50000).floor - 1) < 1e-6);
    }
  }

  TEST_CASE_TEMPLATE("so does a closest packing", S, Space<2>, Space<3>) {
    for (const double e : {0.3, 0.15, 0.05}) {
      CAPTURE(e);
      CHECK(std::abs(after_safe_steps(closest_packing<S::Dim>(e), 30000).floor - 1) < 1e-6);
    }
  }

  TEST_CASE_TEMPLATE("grains of a closest packing with viscous friction stop turning", S, Space<2>,
                     Space<3>) {
    for (const double damping : {0.15, 0.5, 1.0}) {
      CAPTURE(damping);
      auto scene = closest_packing<S::Dim>(0.5);
      scene.friction = FrictionModel::viscous;
      scene.law.friction = 0.5;
      scene.law.tangential_damping = damping;
      for (std::size_t k = 0; k < scene.grains.size(); ++k) {
        scene.grains[k].spin.setConstant(1e-3 * static_cast<double>(1 + k % 3));
      }
      CHECK(after_safe_steps(scene, 50000).spin < 1e-8);  // 1e-3 at first
    }
  }
}
