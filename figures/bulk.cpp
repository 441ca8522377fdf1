// SPDX-License-Identifier: GPL-3.0-or-later
#include "bulk.hpp"

#include "measure.hpp"
#include "packing.hpp"
#include "walls_by_name.hpp"

#include <lagrain/check.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

namespace lagrain::figures {

namespace {

constexpr double kSiloRadius = 0.1;  // of the published cylinder [m]
constexpr double kFallBelow = 0.04;  // what is so far below the lip has left [m]
constexpr double kBedMargin = 0.02;  // of a bed's surface, in which its density is not measured [m]

/// Which of a scene's materials has a name.
int material_of(const Scene<3>& scene, const std::string& name) {
  const auto at = std::find_if(scene.materials.begin(), scene.materials.end(),
                               [&](const Material& material) { return material.name == name; });
  return static_cast<int>(at - scene.materials.begin());
}

/// Runs a scene on one thread, and lets `sample` look at it every so often [s].
template <class Sample>
RunReport run_sampled(const Scene<3>& scene, double every, const Watch& watch, Sample&& sample) {
  constexpr double kGrainStepsPerLook = 1e5;  // a few hundredths of a second
  const std::unique_ptr<Run<3>> run = make_run(scene, 1);
  RunReport report;
  report.grains = run->count();
  report.radius = run->radii().minCoeff();
  report.modulus = scene.law.modulus;
  report.time_step = run->time_step();
  const double start = bench::processor_seconds();
  double next = 0;
  while (!run->finished()) {
    const auto block = std::max<std::int64_t>(
        1, static_cast<std::int64_t>(kGrainStepsPerLook / std::max(1, run->count())));
    for (std::int64_t k = 0; k < block && !run->finished() && run->time() < next; ++k) {
      run->step();
      report.grain_steps += run->count();
    }
    if (!watch(run->time() / scene.duration)) return report;
    if (run->time() < next && !run->finished()) continue;
    next += every;
    report.largest_overlap = std::max(report.largest_overlap, run->statistics().largest_overlap);
    sample(*run);
  }
  report.seconds = bench::processor_seconds() - start;
  const Ledger ledger = run->ledger();
  report.residual = std::abs(run->energy_residual()) / (ledger.dashpot + ledger.friction);
  report.audited = run->audit().contacts();
  report.missed = run->audit().missed();
  return report;
}

/// The mean of the slopes of equal parts of a curve, and its standard error by their scatter.
std::pair<double, double> rate_of(const std::vector<double>& time, const std::vector<double>& left,
                                  std::size_t first) {
  constexpr std::size_t kParts = 6;
  const std::size_t length = (time.size() - first) / kParts;
  if (length < 2) return {0, 0};
  double sum = 0, squares = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t from = first + part * length;
    const double slope = bench::slope_of(std::span(time).subspan(from, length),
                                         std::span(left).subspan(from, length));
    sum -= slope;
    squares += slope * slope;
  }
  const double mean = sum / kParts;
  const double variance = std::max(0.0, squares / kParts - mean * mean) * kParts / (kParts - 1);
  return {mean, std::sqrt(variance / kParts)};
}

/// The height below which this share of the grains' centres lies [m].
double height_of_share(const Columns<3>& x, double share) {
  std::vector<double> z(x.row(2).begin(), x.row(2).end());
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(z.size() - 1));
  std::nth_element(z.begin(), z.begin() + at, z.end());
  return z[static_cast<std::size_t>(at)];
}

double surface_of(const Run<3>& run) {
  return height_of_share(run.positions(), 0.99) + run.radii().minCoeff();
}

}  // namespace

Scene<3> coarser(Scene<3> scene, double factor) {
  for (Fill<3>& fill : scene.fills) {
    fill.radius = factor * std::get<double>(fill.radius);
    fill.count = static_cast<int>(std::lround(*fill.count / std::pow(factor, 3)));
  }
  return scene;
}

Scene<3> softer(Scene<3> scene, double factor) {
  scene.law.modulus /= factor;
  for (PairLaw& pair : scene.pairs) pair.law.modulus /= factor;
  return scene;
}

Scene<3> with_orifice(Scene<3> scene, double orifice) {
  // The funnel begins where the cylinder ends, at height 0, and has a slope of 1.
  const double radius = orifice / 2, depth = kSiloRadius - radius;
  const Vec<3> up = Vec<3>::UnitZ(), lip = -depth * up;
  const auto put = [&](const std::string& name, const Frustum& frustum) {
    Wall<3>& wall = wall_named(scene.walls, name);
    Wall<3> other = Wall<3>::sheet(name, lip, {frustum});
    other.material = wall.material;
    other.until = wall.until;
    wall = other;
  };
  put("funnel", {Vec<3>::Zero(), up, depth, radius, kSiloRadius});
  put("gate", {Vec<3>::Zero(), up, 0, 0, radius});
  scene.outlets[0].region.high.z() = lip.z() - kFallBelow;
  return scene;
}

double gate_of(const Scene<3>& scene) { return wall_named(scene.walls, "gate").until; }

Silo run_silo(const Scene<3>& scene, const Watch& watch) {
  constexpr double kEvery = 0.005;
  Silo silo;
  const Wall<3>& funnel = wall_named(scene.walls, "funnel");
  const double opened = gate_of(scene), lip = funnel.point.z();
  silo.orifice = 2 * std::get<Frustum>(funnel.pieces()->piece(0)).low_radius;
  silo.report = run_sampled(scene, kEvery, watch, [&](const Run<3>& run) {
    const double time = run.time() - opened;
    const Columns<3>& x = run.positions();
    if (time < 0) {
      if (time + kEvery < 0) return;
      const double half = kSiloRadius / 2;  // a box well within the funnel's upper half
      silo.solid = bulk_density(x, run.radii(),
                                {Vec<3>(-half, -half, lip / 2),
                                 Vec<3>(half, half, surface_of(run) - kBedMargin)})
                       .first;
      return;
    }
    silo.time.push_back(time);
    silo.left.push_back(static_cast<double>((x.row(2).array() > lip).count()));
    if (silo.radius.size() == 0 && time >= kSiloPicture) {
      silo.position = x;
      silo.radius = run.radii();
      silo.speed = run.velocities().colwise().norm();
    }
  });
  silo.grain = 2 * silo.report.radius;
  const auto first = static_cast<std::size_t>(
      std::lower_bound(silo.time.begin(), silo.time.end(), kSteadyFrom) - silo.time.begin());
  std::tie(silo.rate, silo.rate_error) = rate_of(silo.time, silo.left, first);
  return silo;
}

double beverloo_flow(double rate, double grain, double solid) {
  // W = rate * rho_s pi / 6 d^3, and rho = solid * rho_s.
  return rate * std::numbers::pi / 6 * std::sqrt(grain / kSiloGravity) / solid;
}

Beverloo fit_beverloo(const std::vector<double>& orifice_over_grain,
                      const std::vector<double>& flow) {
  const std::vector<double>& x = orifice_over_grain;
  LAGRAIN_EXPECTS(x.size() >= 3 && x.size() == flow.size(), "two constants and their errors");
  const auto n = static_cast<double>(x.size());
  std::vector<double> y;
  for (const double w : flow) y.push_back(std::pow(w, 0.4));
  const double slope = bench::slope_of(x, y);
  double mean_x = 0, mean_y = 0, xx = 0, rest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    rest += std::pow(y[i] - mean_y - slope * (x[i] - mean_x), 2);
  }
  // y = slope (x - k): k = mean_x - mean_y / slope, and the errors of mean_y and slope are
  // independent of each other.
  const double variance = rest / (n - 2), slope_error = std::sqrt(variance / xx);
  const double mean_error = std::sqrt(variance / n);
  Beverloo law;
  law.c = std::pow(slope, 2.5);
  law.c_error = 2.5 * law.c * slope_error / slope;
  law.k = mean_x - mean_y / slope;
  law.k_error = std::hypot(mean_error / slope, mean_y / slope * slope_error / slope);
  return law;
}

Drum run_drum(const Scene<3>& scene, const Watch& watch) {
  constexpr double kEvery = 0.02;
  Drum drum;
  const auto turn = std::get<Turn<3>>(wall_named(scene.walls, "drum").turning);
  const std::array<int, 2> materials{material_of(scene, "M1"), material_of(scene, "M2")};
  const double gravity = scene.gravity.norm();
  struct Sample {
    double time = 0, work = 0, arm = 0, momentum = 0;
  } last;
  drum.report = run_sampled(scene, kEvery, watch, [&](const Run<3>& run) {
    const Columns<3>& x = run.positions();
    const Columns<3>& v = run.velocities();
    const Eigen::VectorXd& m = run.masses();
    Sample now{run.time() - turn.start};
    for (const Wall<3>& wall : run.walls()) {
      if (wall.turns()) now.work += wall.work;
    }
    std::array<std::array<int, 2>, 2> count{};
    for (int i = 0; i < run.count(); ++i) {
      const Vec<3> place = x.col(i);
      const double inertia = 0.4 * m[i] * run.radii()[i] * run.radii()[i];
      now.arm += gravity * m[i] * place.x();
      now.momentum += turn.axis.dot(m[i] * place.cross(Vec<3>(v.col(i))) +
                                    inertia * Vec<3>(run.spins()->col(i)));
      const auto kind =
          static_cast<std::size_t>(run.materials()[static_cast<std::size_t>(i)] == materials[1]);
      if (place.x() > 0 && place.z() > 0) ++count[kind][0];
      if (place.x() < 0 && place.z() < 0) ++count[kind][1];
    }
    const bool first = drum.time.empty();
    if (now.time >= 0) {
      if (first) {
        drum.before = x;
        last = now;
      }
      const double interval = first ? kEvery : now.time - last.time;
      drum.time.push_back(now.time);
      drum.torque.push_back((now.work - last.work) / (turn.rate * interval));
      drum.weight.push_back((now.arm + last.arm) / 2);
      drum.momentum.push_back((now.momentum - last.momentum) / interval);
      for (std::size_t kind = 0; kind < 2; ++kind) {
        for (std::size_t zone = 0; zone < 2; ++zone) {
          drum.count[kind][zone].push_back(count[kind][zone]);
        }
      }
      last = now;
    }
    if (!run.finished()) return;
    drum.after = x;
    drum.radius = run.radii();
    for (const int material : run.materials()) {
      drum.material.push_back(material == materials[1]);
      ++drum.grains[static_cast<std::size_t>(drum.material.back())];
    }
  });
  return drum;
}

Penetration run_penetration(const Scene<3>& scene, const Watch& watch) {
  constexpr double kEvery = 2.5e-4;
  Penetration p;
  p.ball = scene.grains[0].radius;
  double released = 0;
  p.report = run_sampled(scene, kEvery, watch, [&](const Run<3>& run) {
    const Columns<3>& x = run.positions();
    const double height = x(2, 0), speed = -run.velocities()(2, 0);
    if (height > kRelease) return;
    if (p.time.empty()) {
      released = run.time() - (kRelease - height) / speed;
      const double top = surface_of(run);
      const Region<3>& bed = run.scene().fills[0].region;
      const int grains = run.count() - 1;  // the ball comes first
      p.solid = bulk_density(x.rightCols(grains), run.radii().tail(grains),
                             {bed.low, Vec<3>(bed.high.x(), bed.high.y(), top)})
                    .first;
      p.layer = x.row(2).transpose() / top;
    }
    p.time.push_back(run.time() - released);
    p.height.push_back(height);
    p.speed.push_back(speed);
    if (!run.finished()) return;
    p.position = x;
    p.radius = run.radii();
    const auto touch = std::max_element(p.speed.begin(), p.speed.end()) - p.speed.begin();
    p.surface = p.height[static_cast<std::size_t>(touch)] - p.ball;
  });
  return p;
}

ImpactLaw fit_impact_law(const Penetration& p) {
  constexpr double kGravity = 9.81;
  std::vector<double> depth, energy;  // per mass, from the first touch until the ball first rests
  for (std::size_t k = 0; k < p.time.size() && (depth.empty() || p.speed[k] > 0); ++k) {
    if (p.depth(k) < 0) continue;
    depth.push_back(p.depth(k));
    energy.push_back(p.speed[k] * p.speed[k] / 2);
  }
  ImpactLaw law;
  if (depth.size() < 3) return law;
  // What the grains took, E = (k / m) z^2 / 2 + (1 / d) int v^2 dz, is linear in both numbers.
  double path = 0, aa = 0, ab = 0, bb = 0, ae = 0, be = 0;
  const double z0 = depth.front(), e0 = energy.front();
  for (std::size_t k = 1; k < depth.size(); ++k) {
    path += (energy[k] + energy[k - 1]) * (depth[k] - depth[k - 1]);
    const double a = (depth[k] * depth[k] - z0 * z0) / 2;
    const double taken = e0 - energy[k] + kGravity * (depth[k] - z0);
    aa += a * a;
    ab += a * path;
    bb += path * path;
    ae += a * taken;
    be += path * taken;
  }
  const double determinant = aa * bb - ab * ab;
  law.stiffness = (ae * bb - be * ab) / determinant;
  law.length = determinant / (be * aa - ae * ab);
  double z = z0, e = e0;
  std::size_t k = 0;
  const double step = (depth.back() - z0) / 2000;
  while (e > 0 && z < 2 * depth.back()) {
    law.depth.push_back(z);
    law.speed.push_back(std::sqrt(2 * e));
    for (; k < depth.size() && depth[k] <= z; ++k) {
      law.worst = std::max(law.worst, std::abs(e - energy[k]) / e0);
    }
    const auto slope = [&](double at, double energy_there) {
      return kGravity - law.stiffness * at - 2 * energy_there / law.length;
    };
    e += step * slope(z + step / 2, e + step / 2 * slope(z, e));
    z += step;
  }
  return law;
}

}  // namespace lagrain::figures
