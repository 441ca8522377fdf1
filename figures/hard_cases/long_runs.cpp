// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases of runs so long that small errors could add up.

#include "stone.hpp"
#include "watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lagrain::hard_cases {

namespace {

/// The largest force that is left on a grain, of its weight.
template <int Dim>
double unbalanced(const Run<Dim>& run) {
  Columns<Dim> force = run.scene().gravity * run.masses().transpose();
  for (const ContactRecord<Dim>& contact : run.contacts()) {
    force.col(contact.i) += contact.force;
    if (contact.j >= 0) force.col(contact.j) -= contact.force;
  }
  double largest = 0;
  for (int i = 0; i < run.count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (k < run.scene().grains.size() && run.scene().grains[k].pinned) continue;
    largest = std::max(largest, force.col(i).norm() / (run.masses()[i] * kGravity));
  }
  return largest;
}

}  // namespace

Pile pile(FrictionModel friction, std::int64_t steps, const StopCheck& check_stop) {
  constexpr int kPinned = 30, kAcross = 5, kLayers = 10;
  constexpr int kSamples = 400;
  constexpr double kStiffness = 1e7;  // [N/m]: the lowest discs overlap by about 0.1 % of a radius
  Scene<2> scene = stone<2>("pile", kStiffness, 0.3);
  fall(scene);
  scene.friction = friction;
  scene.law.friction = 0.5;
  // A thick film creeps slowly enough to be seen for a while; it needs short steps.
  const bool viscous = friction == FrictionModel::viscous;
  scene.law.tangential_damping = viscous ? 0.35 : 0.2;
  scene.time_step.fraction_of_contact = viscous ? 1.0 / 36 : 1.0 / 20;
  for (int k = 0; k < kPinned; ++k) {
    put<2>(scene, {(2 * k + 1) * kRadius, 0});
    scene.grains.back().pinned = true;
  }
  const double middle = kPinned * kRadius, half = 2.1 * kRadius * kAcross / 2;
  Fill<2> column;
  column.name = "column";
  column.count = kAcross * kLayers;
  column.radius = UniformRadius{0.8 * kRadius, kRadius};
  column.region.low = {middle - half, kRadius};
  column.region.high = {middle + half, kRadius * (1 + 2.1 * kLayers)};
  scene.fills.push_back(column);
  scene.walls.push_back(Wall<2>::half_space("left", {0, 0}, {1, 0}));
  scene.walls.push_back(Wall<2>::half_space("right", {2 * middle, 0}, {-1, 0}));
  const auto run = make_run(scene, 1);

  Pile result;
  result.grains = run->count() - kPinned;
  const std::int64_t every = std::max(kAuditEvery, steps / kSamples / kAuditEvery * kAuditEvery);
  const std::int64_t tenth = (steps - steps / 10) / kAuditEvery * kAuditEvery;
  Columns<2> then;
  watch(*run, steps, result, check_stop, [&] {
    if (run->steps() % every == 0) {
      result.samples.push_back(
          {run->time(), run->ledger().kinetic, run->positions().row(1).maxCoeff()});
    }
    if (run->steps() == tenth) then = run->positions();
  });
  if (!result.stopped.empty()) return result;
  result.drift = (run->positions() - then).colwise().norm().maxCoeff() / kRadius;
  result.drift_seconds = static_cast<double>(steps - tenth) * run->time_step();
  // Along both axes; a disc that rolls so has half as much again in its spin.
  const double crawl = std::numbers::sqrt2 * last_bit_of(2 * middle) / (2 * run->time_step());
  result.crawl = crawl / kRadius;
  result.rounding_floor = 1.5 * result.grains * run->masses().maxCoeff() / 2 * crawl * crawl;
  // A film of 2 zeta_t sqrt(k m_eff) under a tangential force of mu times a disc's weight.
  const double mass = kDensity * grain_volume<2>(kRadius);
  const double film = 2 * scene.law.tangential_damping * std::sqrt(kStiffness * mass / 2);
  result.creep = scene.law.friction * mass * kGravity / film / kRadius;
  result.unbalanced = unbalanced(*run);
  return result;
}

Gas elastic_gas(std::int64_t grain_steps, const StopCheck& check_stop) {
  constexpr int kGrains = 200, kSamples = 200;
  constexpr double kSide = 0.45;  // [m]
  // A step, of the contact time. What remains of a contact after whole steps, 0.24 of one, is where
  // the errors at its two ends are uncorrelated (the root of Bernoulli's fourth polynomial).
  constexpr double kFraction = 1 / 25.24;
  Scene<2> scene = stone<2>("elastic gas", 1e7, 1);
  scene.time_step.fraction_of_contact = kFraction;
  Fill<2> gas;
  gas.name = "gas";
  gas.count = kGrains;
  gas.radius = kRadius;
  gas.region.low = {0, 0};
  gas.region.high = {kSide, kSide};
  gas.arrangement = Arrangement::random;
  gas.random_speed = 2;
  scene.fills.push_back(gas);
  add_tub<2>(scene, {0, 0}, kSide);
  scene.walls.push_back(Wall<2>::half_space("lid", {0, kSide}, {0, -1}));
  const auto run = make_run(scene, 1);

  Gas result;
  result.grains = kGrains;
  const std::int64_t steps = grain_steps / kGrains;
  const std::int64_t every = std::max(kAuditEvery, steps / kSamples / kAuditEvery * kAuditEvery);
  double open = 0, samples = 0, most_open = 0;
  watch(*run, steps, result, check_stop, [&] {
    const auto contacts = static_cast<double>(run->statistics().contacts);
    open += contacts;
    most_open = std::max(most_open, contacts);
    samples += 1;
    if (run->steps() % every != 0 && run->steps() != steps) return;
    result.samples.push_back({static_cast<double>(run->steps() * kGrains),
                              run->energy_residual() / run->start().kinetic});
  });
  result.collisions = open / samples * run->time() / run->time_scales().contact;
  // A contact that opens or closes a share s of a step before the step's end errs by
  // (omega dt)^2 s (1 - s) of the pair's energy along the normal, with opposite signs at the two
  // ends: a standard deviation of (omega dt)^2 sqrt(2 (1/30 - 1/36)) of an energy whose mean square
  // over collisions in the plane is 2 (kT)^2; and the gas has kGrains kT.
  const double squared = std::pow(std::numbers::pi * kFraction, 2);
  result.random_walk =
      squared * std::sqrt(2 * (1.0 / 30 - 1.0 / 36) * 2 * result.collisions) / kGrains;
  // Within a contact velocity Verlet errs by (omega dt)^2 / 4 of its energy, of kT in the mean.
  result.open_contacts = squared / 4 * most_open / kGrains;
  return result;
}

}  // namespace lagrain::hard_cases
