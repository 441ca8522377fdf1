// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases of where grains are: in a row, at one point, far away, and of all sizes.

#include "stone.hpp"
#include "watch.hpp"

#include <lagrain/restitution.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace lagrain::hard_cases {

template <int Dim>
Row row_of_grains(bool slanted, const StopCheck& check_stop) {
  constexpr int kGrains = 20;
  constexpr double kGap = 0.1;            // between neighbours, of the radius
  constexpr double kDeepest = 0.01;       // overlap of a collision, of the radius
  constexpr double kStiffness = 1e7;      // [N/m]
  constexpr double kFraction = 1 / 50.5;  // a step, of the contact time; not a whole number of them
  Scene<Dim> scene = stone<Dim>("row", kStiffness, 1);
  scene.time_step.fraction_of_contact = kFraction;
  const Vec<Dim> along =
      slanted ? Vec<Dim>(Vec<Dim>::Ones().normalized()) : Vec<Dim>(Vec<Dim>::UnitX());
  for (int k = 0; k < kGrains; ++k) put<Dim>(scene, kRadius * (2 + kGap) * k * along);
  const double mass = kDensity * grain_volume<Dim>(kRadius);
  const double speed = kDeepest * kRadius * std::sqrt(2 * kStiffness / mass);
  scene.grains[0].velocity = speed * along;
  const auto run = make_run(scene, 1);

  Row result;
  // The way of the impulse, with the time that it spends in contacts, and once more the gap.
  const double seconds = kGrains * (kGap * kRadius / speed + run->time_scales().contact);
  watch(*run, std::llround(seconds / run->time_step()), result, check_stop, {}, 1);
  const Columns<Dim>& v = run->velocities();
  result.speed = v.col(kGrains - 1).dot(along) / speed;
  // Where a contact opens or closes within a step the energy errs by at most (omega dt)^2 / 4 of
  // the pair's, the speed by half of that; and the other way round where it ends.
  result.bound = (kGrains - 1) * std::pow(std::numbers::pi * kFraction, 2) / 8;
  result.momentum = (v.rowwise().sum() - speed * along).norm() / speed;
  for (int k = 0; k < kGrains; ++k) {
    const Vec<Dim> x = run->positions().col(k);
    result.sideways = std::max(result.sideways, (x - x.dot(along) * along).norm() / kRadius);
  }
  return result;
}
template Row row_of_grains<2>(bool, const StopCheck&);
template Row row_of_grains<3>(bool, const StopCheck&);

template <int Dim>
OnePlace all_in_one_place(const StopCheck& check_stop) {
  constexpr std::int64_t kSteps = 5000;
  OnePlace result;
  result.grains = 10;
  Scene<Dim> scene = stone<Dim>("one place", 1e7, 1);
  scene.time_step.fraction_of_contact = 1.0 / 100;
  for (int k = 0; k < result.grains; ++k) put<Dim>(scene, Vec<Dim>::Ones());
  try {
    make_run(scene, 1);
  } catch (const SceneError& error) {
    result.refused = error.what();
  }
  scene.largest_initial_overlap = 2;  // of the radius: all there is
  try {
    make_run(scene, 1);
  } catch (const SimulationError& error) {
    result.stopped = error.what();
  }
  scene.largest_overlap = 2;
  const auto run = make_run(scene, 1);
  result.pairs = static_cast<int>(run->near_pairs().size());
  watch(*run, kSteps, result.free, check_stop, {}, 1);
  const Columns<Dim>& v = run->velocities();
  result.momentum = v.rowwise().sum().norm() / v.colwise().norm().sum();
  result.separation = std::numeric_limits<double>::infinity();
  for (int i = 0; i < run->count(); ++i) {
    for (int j = 0; j < i; ++j) {
      const Vec<Dim> between = run->positions().col(i) - run->positions().col(j);
      result.separation = std::min(result.separation, between.norm() / (2 * kRadius));
    }
  }
  return result;
}
template OnePlace all_in_one_place<2>(const StopCheck&);
template OnePlace all_in_one_place<3>(const StopCheck&);

FarAway far_from_origin(double distance, const StopCheck& check_stop) {
  FarAway result;
  double step = 0;
  const auto settled = [&](const Vec<2>& corner) {
    const auto run = make_run(crystal_scene<2>(Crystal::hexagonal, corner), 1);
    watch(*run, kCrystalSteps, result, check_stop);
    result.last_bit = last_bit_of(run->positions().cwiseAbs().maxCoeff()) / kRadius;
    step = run->time_step();
    return run->contacts();
  };
  const auto here = settled(Vec<2>::Zero());
  const auto there = settled(Vec<2>::Constant(distance * kRadius));
  // Places stand once a step adds less than half of a last bit to each coordinate. What two grains
  // may still have of speed then, 2 sqrt(2) times that at most, their dashpot turns into a force of
  // 2 zeta sqrt(k m_eff) times it, in place of an overlap; and overlaps have last bits as well.
  const double mass = kDensity * grain_volume<2>(kRadius);
  const double natural = std::sqrt(mass / 2 * kCrystalOverlap * kRadius / weight<2>(kRadius));
  result.bound =
      (2 * std::numbers::sqrt2 * damping_ratio_for(kDeadRestitution) * natural / step + 2) *
      result.last_bit;
  const double w = weight<2>(kRadius);
  // A contact that one of the two lacks counts with the whole of the other's.
  const auto key = [](const ContactRecord<2>& c) { return std::array{c.wall, c.i, c.j}; };
  auto a = here.begin(), b = there.begin();
  while (a != here.end() || b != there.end()) {
    const bool has_a = a != here.end() && (b == there.end() || key(*a) <= key(*b));
    const bool has_b = b != there.end() && (a == here.end() || key(*b) <= key(*a));
    const Vec<2> none = Vec<2>::Zero();
    const double overlap = (has_a ? a->overlap : 0) - (has_b ? b->overlap : 0);
    const Vec<2> force = (has_a ? a->force : none) - (has_b ? b->force : none);
    result.overlap_error = std::max(result.overlap_error, std::abs(overlap) / kRadius);
    result.force_error = std::max(result.force_error, force.norm() / w);
    if (has_a) ++a;
    if (has_b) ++b;
  }
  return result;
}

Scales nine_decades_of_radii(std::int64_t steps, const StopCheck& check_stop) {
  constexpr double kGiant = 1000;         // [m]
  constexpr double kStiffness = 1e7;      // [N/m]
  constexpr double kDeepest = 0.01;       // overlap of an impact, of the radius
  constexpr double kFraction = 1.0 / 25;  // a step, of the shortest contact time
  Scene<2> scene = stone<2>("scales", kStiffness, 1);
  scene.time_step.fraction_of_contact = kFraction;
  put<2>(scene, {0, -kGiant}, kGiant);
  // In the plane the contact time goes with the radius: all hit with the same speed.
  const double speed = kDeepest * std::sqrt(kStiffness / (kDensity * std::numbers::pi));
  const std::vector<double> radii{1e-6, 1e-3, 1};
  for (std::size_t k = 0; k < radii.size(); ++k) {
    // On the giant's surface, at an angle so that they are clear of each other.
    const double angle = 0.003 * static_cast<double>(k);
    const Vec<2> up(std::sin(angle), std::cos(angle));
    const Vec<2> place = Vec<2>(0, -kGiant) + (kGiant + radii[k]) * up;
    put<2>(scene, place, radii[k], -speed * up);
  }
  const auto run = make_run(scene, 1);

  Scales result;
  watch(*run, steps, result, check_stop);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    Bounce bounce;
    bounce.radius = radii[k];
    const auto i = static_cast<Eigen::Index>(k + 1);
    const double inverse_mass = 1 / run->masses()[i] + 1 / run->masses()[0];
    const double angle = std::sqrt(kStiffness * inverse_mass) * run->time();
    bounce.over = angle > std::numbers::pi;
    const Vec<2> up = (run->positions().col(i) - run->positions().col(0)).normalized();
    const Vec<2> velocity = run->velocities().col(i) - run->velocities().col(0);
    const double expected = bounce.over ? 1 : -std::cos(angle);
    bounce.speed_error = std::abs(velocity.dot(up) / speed - expected);
    // The step in a contact, the last bit of the distance in the overlap, and the last bit of a
    // place in what a step adds to it.
    const double place = run->positions().col(i).cwiseAbs().maxCoeff();
    bounce.bound = std::pow(angle / static_cast<double>(steps), 2) / 8 +
                   last_bit_of(kGiant) / (kDeepest * radii[k]) +
                   last_bit_of(place) / (2 * speed * run->time_step());
    result.bounces.push_back(bounce);
  }
  return result;
}

}  // namespace lagrain::hard_cases
