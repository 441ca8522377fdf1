// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases of grains that are too fast for the step, and of steps that are too long.

#include "stone.hpp"
#include "watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lagrain::hard_cases {

FastGrain fast_grain(double way, int shots, const StopCheck& check_stop) {
  FastGrain result;
  result.way = way;
  result.shots = shots;
  Scene<2> scene = stone<2>("fast grain", 1e7, 1);
  put<2>(scene, {0, 0});
  scene.grains[0].pinned = true;
  Scene<2> aimed = scene;
  put<2>(aimed, {-10 * kRadius, 0});
  const double step = make_run(aimed, 1)->time_step();
  for (int shot = 0; shot < shots; ++shot) {
    Scene<2> one = scene;
    // The first contact lies anywhere in a step.
    const double start = -2 - way * (shot + 0.5) / shots;
    put<2>(one, {start * kRadius, 0}, kRadius, {way * kRadius / step, 0});
    const auto run = make_run(one, 1);
    // Long enough for a bounce (a contact lasts 25 steps or, against a pinned grain, 36), or to
    // come out.
    watch(*run, 60 + static_cast<std::int64_t>(5 / way), result, check_stop, {}, 1);
    if (result.stopped.find("passed through") != std::string::npos) {
      ++result.crossed;
      result.passage = std::exchange(result.stopped, {});
    } else if (!result.stopped.empty()) {
      ++result.refused;
      result.refusal = std::exchange(result.stopped, {});
    } else if (run->positions()(0, 1) < 0) {
      ++result.bounced;
    } else {
      ++result.unseen;
    }
  }
  // Nearer than 2 radii less the largest overlap the run stops before; what ends a step further
  // away and the next one beyond the middle has passed.
  const double guarded = 2 - scene.largest_overlap;
  result.expected = std::max(0.0, 1 - guarded / way);
  const double mass = kDensity * grain_volume<2>(kRadius);
  result.bounce_up_to = scene.largest_overlap * std::sqrt(scene.law.stiffness / mass) * step;
  return result;
}

namespace {

Scene<2> head_on(double overlap, double speed) {
  Scene<2> scene = stone<2>("head-on collision", 0, 1);
  scene.normal = NormalModel::hertz;
  // Hertz's deepest overlap is (5 m v^2 / 4 K)^(2/5), K = (4/3) E* sqrt(r_eff).
  const double mass = kDensity * grain_volume<2>(kRadius) / 2;
  const double k = 1.25 * mass * speed * speed / std::pow(overlap * kRadius, 2.5);
  scene.law.modulus = 0.75 * k / std::sqrt(kRadius / 2);
  put<2>(scene, {-1.001 * kRadius, 0}, kRadius, {speed / 2, 0});
  put<2>(scene, {1.001 * kRadius, 0}, kRadius, {-speed / 2, 0});
  return scene;
}

}  // namespace

std::string refusal_of_step(double safe_steps) {
  Scene<2> scene = head_on(0.02, 1);
  scene.law.impact_speed = 1;
  scene.time_step.fraction_of_contact = safe_steps * kLargestContactFraction;
  try {
    make_run(scene, 1);
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

StepSize collisions_at_step(double safe_steps, const StopCheck& check_stop) {
  constexpr double kOverlap = 0.02;  // of the radius
  constexpr double kSpeed = 1;       // [m/s]
  constexpr int kPhases = 32;
  StepSize result;
  result.safe_steps = safe_steps;
  Scene<2> scene = head_on(kOverlap, kSpeed);
  // The contact time goes with the speed to the power -1/5.
  scene.law.impact_speed = kSpeed * std::pow(safe_steps, -5);
  scene.time_step.fraction_of_contact = kLargestContactFraction;
  const double way = kSpeed * make_run(scene, 1)->time_step();  // of both together
  for (int phase = 0; phase < kPhases; ++phase) {
    Scene<2> one = scene;
    const double gap = way * (phase + 0.5) / kPhases;
    one.grains[0].position.x() = -kRadius - gap / 2;
    one.grains[1].position.x() = kRadius + gap / 2;
    const auto run = make_run(one, 1);
    double deepest = 0;
    ContactAudit<2> audit;
    // Until they part again.
    const auto apart = [&] {
      const Vec<2> between = run->positions().col(1) - run->positions().col(0);
      deepest = std::max(deepest, 2 - between.norm() / kRadius);
      return between.norm() > 2 * kRadius;
    };
    const auto closing = [&] { return run->velocities()(0, 0) > run->velocities()(0, 1); };
    while ((!apart() || closing()) && result.stopped.empty()) {
      try {
        run->step();
      } catch (const SimulationError& error) {
        result.stopped = error.what();
      }
      audit.check(run->positions(), run->radii(), run->near_pairs(), run->pinned());
    }
    if (check_stop) check_stop();
    const double energy = run->ledger().kinetic / run->start().kinetic;
    result.energy_error = std::max(result.energy_error, std::abs(energy - 1));
    result.overlap_error = std::max(result.overlap_error, std::abs(deepest / kOverlap - 1));
    result.steps += run->steps();
    result.audited += audit.contacts();
    result.missed += audit.missed();
  }
  return result;
}

}  // namespace lagrain::hard_cases
