// SPDX-License-Identifier: GPL-3.0-or-later
#include "impacts.hpp"

#include <lagrain/run.hpp>

#include <algorithm>
#include <cstddef>
#include <map>

namespace lagrain::figures {

namespace {

/// The numbers that hold between two materials.
LawNumbers law_between(const Scene<3>& scene, int a, int b) {
  for (const PairLaw& pair : scene.pairs) {
    if ((pair.a == a && pair.b == b) || (pair.a == b && pair.b == a)) return pair.law;
  }
  return scene.law;
}

/// A place of the sphere i above the sphere j, or above the plane z = 0 if j is -1.
struct Gauge {
  const Run<3>& run;
  int i, j;

  double gap() const {
    const auto& x = run.positions();
    const Eigen::VectorXd& r = run.radii();
    return j < 0 ? x(2, i) - r[i] : x(2, i) - x(2, j) - r[i] - r[j];
  }
  ImpactMotion motion() const {
    const auto& v = run.velocities();
    const Eigen::VectorXd& r = run.radii();
    const auto spin = [&](int k) { return run.spins() == nullptr ? 0 : (*run.spins())(1, k); };
    ImpactMotion m{-v(2, i), v(0, i) - r[i] * spin(i), v(0, i), spin(i)};
    if (j >= 0) {
      m.approach += v(2, j);
      m.slip -= v(0, j) + r[j] * spin(j);
    }
    return m;
  }
};

/// 2 times the integral of dx / sqrt(1 - x^(5/2)) from x to 1, with x = 1 - u^2, by Simpson's rule.
double rest_of_impact(double x) {
  constexpr int kParts = 200;
  const auto integrand = [](double u) {
    return u == 0 ? 2 / std::sqrt(2.5) : 2 * u / std::sqrt(1 - std::pow(1 - u * u, 2.5));
  };
  const double h = std::sqrt(1 - x) / kParts;
  double sum = 0;
  for (int k = 0; k <= kParts; ++k) {
    sum += (k == 0 || k == kParts ? 1 : k % 2 == 1 ? 4 : 2) * integrand(k * h);
  }
  return 2 * sum * h / 3;
}

}  // namespace

double Impact::largest_force() const {
  double largest = 0;
  for (const ImpactMoment& moment : moments) largest = std::max(largest, moment.force);
  return largest;
}

Impacts run_impacts(const Scene<3>& given, double steps, const FigureOptions& options,
                    double phase) {
  Scene<3> scene = given;
  scene.time_step = {.fraction_of_contact = 1 / steps};
  if (phase != 0) {
    const double step = make_run(scene, 1)->time_step();
    for (PlacedGrain<3>& grain : scene.grains) grain.position -= phase * step * grain.velocity;
  }
  const auto run = make_run(scene, 1);
  const bool plane = !run->walls().empty();

  Impacts impacts{.steps = steps};
  std::vector<Gauge> gauges;
  std::vector<double> touches;  // when, from the free flight before
  for (int i = 0; i < run->count(); i += plane ? 1 : 2) {
    const Gauge& gauge = gauges.emplace_back(Gauge{*run, i, plane ? -1 : i + 1});
    const double m = run->masses()[i], r = run->radii()[i];
    const int upper = run->materials()[static_cast<std::size_t>(i)];
    const int lower =
        plane ? run->walls().front().material : run->materials()[static_cast<std::size_t>(i) + 1];
    Impact impact{.upper = scene.materials[static_cast<std::size_t>(upper)].name,
                  .lower = scene.materials[static_cast<std::size_t>(lower)].name,
                  .law = law_between(scene, upper, lower),
                  .radius = r,
                  .effective_radius = r,
                  .effective_mass = m,
                  .before = gauge.motion()};
    if (!plane) {
      impact.effective_radius = 1 / (1 / r + 1 / run->radii()[i + 1]);
      impact.effective_mass = 1 / (1 / m + 1 / run->masses()[i + 1]);
      impact.mass_share = impact.effective_mass / m;
    }
    touches.push_back(gauge.gap() / impact.before.approach);
    impacts.all.push_back(std::move(impact));
  }

  while (!run->finished()) {
    options.check_stop();
    run->step();
    for (const ContactRecord<3>& contact : run->contacts()) {
      const auto k =
          static_cast<std::size_t>(plane ? contact.i : std::min(contact.i, contact.j) / 2);
      impacts.all[k].moments.push_back(
          {run->time() - touches[k], contact.overlap, std::abs(contact.force.dot(contact.normal))});
    }
  }
  for (std::size_t k = 0; k < gauges.size(); ++k) {
    Impact& impact = impacts.all[k];
    impact.after = gauges[k].motion();
    const double gap = gauges[k].gap();
    if (!(gap > 0) || !(impact.after.approach < 0)) {
      throw SimulationError(scene.title + ": impact " + std::to_string(k + 1) +
                            " has not ended after " + std::to_string(run->time()) + " s");
    }
    impact.duration = run->time() + gap / impact.after.approach - touches[k];
  }
  impacts.missed = run->audit().missed();
  impacts.audited = run->audit().contacts();
  return impacts;
}

HertzImpact hertz_impact(const Impact& impact) {
  const double v = impact.before.approach;
  const double k = hertz_force(impact, 1);
  const double deepest = std::pow(1.25 * impact.effective_mass * v * v / k, 0.4);
  return {deepest, hertz_force(impact, deepest), rest_of_impact(0) * deepest / v};
}

double hertz_force(const Impact& impact, double overlap) {
  return 4.0 / 3 * impact.law.modulus * std::sqrt(impact.effective_radius) * overlap *
         std::sqrt(overlap);
}

double hertz_time(const Impact& impact, double overlap) {
  const HertzImpact whole = hertz_impact(impact);
  return 0.5 * (whole.duration -
                rest_of_impact(overlap / whole.overlap) * whole.overlap / impact.before.approach);
}

bool slides(const Impact& impact) {
  return impact.before.slip >=
         3.5 * impact.law.friction * (1 + impact.law.restitution) * impact.before.approach;
}

ImpactMotion after_sliding(const Impact& impact) {
  const ImpactMotion& before = impact.before;
  const double e = impact.law.restitution;
  // The impulse of friction over the effective mass, and over that of the upper sphere.
  const double taken = impact.law.friction * (1 + e) * before.approach;
  const double of_upper = impact.mass_share * taken;
  return {-e * before.approach, before.slip - 3.5 * taken, before.across - of_upper,
          before.spin + 2.5 * of_upper / impact.radius};
}

double velocity_error(const Impact& impact, const ImpactMotion& exact) {
  return std::hypot(impact.mass_share * (impact.after.approach - exact.approach),
                    impact.after.across - exact.across) /
         impact.speed();
}

double spin_error(const Impact& impact, const ImpactMotion& exact) {
  return impact.radius * std::abs(impact.after.spin - exact.spin) / impact.speed();
}

}  // namespace lagrain::figures
