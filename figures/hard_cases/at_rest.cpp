// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases of what has to come to rest.

#include "stone.hpp"
#include "watch.hpp"

#include <lagrain/restitution.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lagrain::hard_cases {

template <int Dim>
Scene<Dim> crystal_scene(Crystal crystal, const Vec<Dim>& corner) {
  Scene<Dim> scene =
      stone<Dim>("crystal", weight<Dim>(kRadius) / (kCrystalOverlap * kRadius), kDeadRestitution);
  fall(scene);
  const int across = Dim == 2 ? 10 : 5, layers = Dim == 2 ? 10 : 6;
  const double rise = crystal == Crystal::square      ? 2
                      : crystal == Crystal::hexagonal ? std::numbers::sqrt3
                                                      : std::numbers::sqrt2;
  for (int layer = 0; layer < layers; ++layer) {
    // Every other layer lies in the hollows of the one below.
    const int shift = crystal == Crystal::square ? 0 : layer % 2;
    const int count = across - shift;
    for (int k = 0; k < (Dim == 2 ? count : count * count); ++k) {
      Vec<Dim> place = Vec<Dim>::Constant(1 + shift);
      place[0] += 2 * (k % count);
      if (Dim == 3) place[1] += 2 * (k / count);
      place[Dim - 1] = 1 + rise * layer;
      put<Dim>(scene, corner + kRadius * place);
    }
  }
  add_tub<Dim>(scene, corner, 2 * kRadius * across);
  step_widely(scene);
  return scene;
}
template Scene<2> crystal_scene<2>(Crystal, const Vec<2>&);
template Scene<3> crystal_scene<3>(Crystal, const Vec<3>&);

namespace {

template <int Dim>
CrystalAtRest rest(Crystal crystal, const StopCheck& check_stop) {
  const Scene<Dim> scene = crystal_scene<Dim>(crystal, Vec<Dim>::Zero());
  const auto run = make_run(scene, 1);
  const Columns<Dim> before = run->positions();
  CrystalAtRest result;
  watch(*run, kCrystalSteps, result, check_stop);

  result.grains = run->count();
  const Columns<Dim> move = run->positions() - before;
  result.move = move.colwise().norm().maxCoeff() / kRadius;
  result.sink = -move.row(Dim - 1).mean();
  const double all = run->masses().sum() * kGravity;
  result.floor_error = std::abs(-run->walls()[0].force[Dim - 1] / all - 1);
  double twice_elastic = 0;
  for (const ContactRecord<Dim>& contact : run->contacts()) {
    twice_elastic += scene.law.stiffness * contact.overlap * contact.overlap;
    if (contact.j < 0) continue;
    ++result.contacts;
    const double apart = (before.col(contact.i) - before.col(contact.j)).norm();
    result.strangers += apart > 2.01 * kRadius;
  }
  // Gravity's work on the way to rest is twice the energy in the springs: half of it is damped.
  result.explained = twice_elastic / all;
  for (int i = 0; i < run->count(); ++i) {
    for (int j = 0; j < i; ++j) {
      const Vec<Dim> between = run->positions().col(i) - run->positions().col(j);
      result.brute_force += between.norm() < 2 * kRadius;
    }
  }
  return result;
}

}  // namespace

CrystalAtRest crystal_at_rest(Crystal crystal, const StopCheck& check_stop) {
  return crystal == Crystal::face_centred ? rest<3>(crystal, check_stop)
                                          : rest<2>(crystal, check_stop);
}

Tower tower(int height, std::int64_t steps, const StopCheck& check_stop) {
  constexpr double kOverlap = 1e-4;  // by one weight, of the radius
  constexpr int kSamples = 250;
  const double w = weight<2>(kRadius), stiffness = w / (kOverlap * kRadius);
  Scene<2> scene = stone<2>("tower", stiffness, kDeadRestitution);
  fall(scene);
  for (int k = 0; k < height; ++k) put<2>(scene, {0, (2 * k + 1) * kRadius});
  scene.walls.push_back(Wall<2>::half_space("floor", {0, 0}, {0, 1}));
  step_widely(scene);
  const auto run = make_run(scene, 1);

  Tower result;
  const auto n = static_cast<std::size_t>(height);
  const auto measure = [&] {
    result.force.assign(n, 0);
    for (const ContactRecord<2>& contact : run->contacts()) {
      const int below = contact.j < 0 ? -1 : contact.i;
      result.force[static_cast<std::size_t>(height - below - 2)] = contact.force.norm() / w;
    }
    double worst = 0;
    for (std::size_t m = 1; m <= n; ++m) {
      const auto weights = static_cast<double>(m);
      worst = std::max(worst, std::abs(result.force[m - 1] / weights - 1));
    }
    result.samples.push_back({static_cast<double>(run->steps()), worst});
  };
  const std::int64_t every = std::max(kAuditEvery, steps / kSamples / kAuditEvery * kAuditEvery);
  watch(*run, steps, result, check_stop, [&] {
    if (run->steps() % every == 0 || run->steps() == steps) measure();
  });

  // The modes of a column on a floor: omega = 2 sqrt(k/m) sin((2p - 1) pi / (4 n + 2)). Dashpots of
  // 2 zeta sqrt(k m/2) between neighbours damp the slowest by zeta sqrt(m / 2k) omega^2.
  const double mass = w / kGravity;
  const double half_angle = std::numbers::pi / (4 * height + 2);
  const double squared = 4 * stiffness / mass * std::pow(std::sin(half_angle), 2);
  result.decay = damping_ratio_for(kDeadRestitution) * std::sqrt(mass / (2 * stiffness)) * squared *
                 run->time_step();
  result.last_bit = last_bit_of(2 * kRadius * height) / (kOverlap * kRadius);
  return result;
}

template <int Dim>
HeavyOnLight heavy_on_light(const StopCheck& check_stop) {
  constexpr double kTimes = 1000;    // as dense
  constexpr double kOverlap = 1e-4;  // by the heavy grain's weight, of the radius
  constexpr std::int64_t kSteps = 300000;
  const int light = 1 << (Dim - 1);
  const double w = weight<Dim>(kRadius);
  Scene<Dim> scene =
      stone<Dim>("heavy on light", kTimes * w / (kOverlap * kRadius), kDeadRestitution);
  fall(scene);
  scene.materials.push_back({"heavy stone", kTimes * kDensity});
  for (int k = 0; k < light; ++k) {
    Vec<Dim> place = Vec<Dim>::Ones();
    for (int d = 0; d < Dim - 1; ++d) place[d] += 2 * (k >> d & 1);
    put<Dim>(scene, kRadius * place);
  }
  // In the hollow of the others: by a radius off each of them along every horizontal axis.
  const double up = std::sqrt(4.0 - (Dim - 1));
  Vec<Dim> top = Vec<Dim>::Constant(2);
  top[Dim - 1] = 1 + up;
  put<Dim>(scene, kRadius * top);
  scene.grains.back().material = 1;
  add_tub<Dim>(scene, Vec<Dim>::Zero(), 4 * kRadius);
  step_widely(scene);
  const auto run = make_run(scene, 1);

  HeavyOnLight result;
  watch(*run, kSteps, result, check_stop);
  const double all = (kTimes + light) * w;
  result.floor_error = std::abs(-run->walls()[0].force[Dim - 1] / all - 1);
  // Each contact with the heavy grain carries its weight / (light cos), half of that along an axis;
  // half of the light grains lean on a wall.
  const double cosine = up / 2;
  const double thrust = kTimes * w / (4 * cosine);
  result.wall_error = std::abs(-run->walls()[1].force[0] / thrust - 1);
  // Its spring are those contacts, in series with the floor's and the walls'; dashpots of
  // 2 zeta sqrt(k m) go with all of them, so that it decays by zeta sqrt(m / k) omega^2.
  const double compliance = (1 / (cosine * cosine) + 1 + (Dim - 1) / (4 * cosine * cosine)) / light;
  const double natural = std::sqrt(w / kGravity / scene.law.stiffness);
  result.decay =
      damping_ratio_for(kDeadRestitution) / (natural * kTimes * compliance) * run->time_step();
  result.overlap = run->statistics().largest_overlap;
  return result;
}
template HeavyOnLight heavy_on_light<2>(const StopCheck&);
template HeavyOnLight heavy_on_light<3>(const StopCheck&);

GiantAndDust giant_and_dust(const StopCheck& check_stop) {
  constexpr double kGiant = 1, kDust = 1e-3;  // [m]
  constexpr double kGiantDensity = 250;       // [kg/m^3]: it is hollow
  constexpr double kStiffness = 1e7;          // [N/m]
  constexpr double kSeconds = 0.12;
  Scene<2> scene = stone<2>("giant and dust", kStiffness, 0.3);
  // On a slope of 45 degrees; a wall holds the giant from below.
  const double part = kGravity / std::numbers::sqrt2;
  scene.gravity = {-part, -part};
  scene.friction = FrictionModel::elastic;
  scene.law.friction = 0.5;
  scene.law.tangential_damping = 0.2;
  scene.materials.push_back({"hollow stone", kGiantDensity});
  const double sunk = kGiantDensity * grain_volume<2>(kGiant) * part / kStiffness;
  put<2>(scene, {0, kGiant - sunk}, kGiant);
  scene.grains.back().material = 1;
  scene.walls.push_back(Wall<2>::half_space("slope", {0, 0}, {0, 1}));
  scene.walls.push_back(Wall<2>::half_space("stop", {sunk - kGiant, 0}, {1, 0}));
  // At x from its foot, the giant's flank is x^2 / 2 above the slope.
  constexpr double kLow = 0.06, kHigh = 0.24;  // [m]
  Fill<2> dust;
  dust.name = "dust";
  dust.count = 300;
  dust.radius = UniformRadius{0.8 * kDust, kDust};
  dust.region.low = {kLow, 0};
  dust.region.high = {kHigh, kHigh * kHigh / 2};
  dust.arrangement = Arrangement::random;
  scene.fills.push_back(dust);
  const auto run = make_run(scene, 1);
  const Vec<2> before = run->positions().col(0);

  GiantAndDust result;
  watch(*run, std::llround(kSeconds / run->time_step()), result, check_stop);
  for (const ContactRecord<2>& contact : run->contacts()) {
    result.giant_contacts += contact.i == 0 && contact.j > 0;
  }
  // Nobody gets through the cleft, or leaves it uphill.
  for (int i = 1; i < run->count(); ++i) {
    const double x = run->positions()(0, i);
    result.lost += x < 0 || x > kHigh;
  }
  result.giant_move = (run->positions().col(0) - before).norm() / kGiant;
  result.overlap = run->statistics().largest_overlap;
  const Ledger now = run->ledger();
  result.residual = run->energy_residual() / (now.dashpot + now.friction);
  result.rebuilds = run->neighbourhood().cost()->ladder.rebuilds;
  return result;
}

Wedge tiny_disc_between_giants(const StopCheck& check_stop) {
  constexpr double kGiant = 1, kTiny = 1e-3;  // [m]
  constexpr double kStiffness = 1e7;          // [N/m]
  // The giants' swing against their walls decays at zeta sqrt(k/M) = 18/s.
  constexpr double kSeconds = 1.6;
  Scene<2> scene = stone<2>("wedge", kStiffness, 0.3);
  fall(scene);
  const double foot = kGiant - weight<2>(kGiant) / kStiffness;
  put<2>(scene, {kGiant, foot}, kGiant);
  put<2>(scene, {3 * kGiant, foot}, kGiant);
  put<2>(scene, {2 * kGiant, foot + std::sqrt(kTiny * (2 * kGiant + kTiny))}, kTiny);
  add_tub<2>(scene, {0, 0}, 4 * kGiant);
  step_widely(scene);
  const auto run = make_run(scene, 1);

  Wedge result;
  watch(*run, std::llround(kSeconds / run->time_step()), result, check_stop);
  const double w = weight<2>(kTiny);
  for (const ContactRecord<2>& contact : run->contacts()) {
    if (contact.j != 2) continue;
    result.force = contact.force.norm() / w;
    result.overlap = contact.overlap / kTiny;
  }
  // The flanks carry the small disc, 2 f y / d = w; d is shorter by f / k, and each giant gives way
  // to f x / d by as much as that presses it into its wall.
  double f = w, x = kGiant;
  for (int round = 0; round < 100; ++round) {
    const double d = kGiant + kTiny - f / kStiffness;
    f = w * d / (2 * std::sqrt((d - x) * (d + x)));
    x = kGiant + f * x / d / kStiffness;
  }
  result.closed_form = f / w;
  return result;
}

}  // namespace lagrain::hard_cases
