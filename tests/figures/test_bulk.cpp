// SPDX-License-Identifier: GPL-3.0-or-later
// The bulk processes of figure 20, and what is fitted to them.

#include "bulk.hpp"

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::figures;
using test::relative_error;

namespace {

Scene<3> scene_of(const std::string& file) {
  return read_scene<3>(std::filesystem::path(LAGRAIN_SCENES) / file);
}

const Watch kGoOn = [](double) { return true; };

double solid_volume(const Scene<3>& scene) {
  double volume = 0;
  for (const Fill<3>& fill : scene.fills) {
    volume += *fill.count * grain_volume<3>(std::get<double>(fill.radius));
  }
  return volume;
}

const Wall<3>& wall(const Scene<3>& scene, std::size_t k, const std::string& name) {
  REQUIRE(scene.walls[k].name == name);
  return scene.walls[k];
}

void check_sound(const RunReport& report) {
  CHECK(report.audited > 0);
  CHECK(report.missed == 0);
  CHECK(report.largest_overlap < 0.3);
  CHECK(report.residual < 0.01);
  CHECK(report.grain_steps > 0);
}

}  // namespace

TEST_SUITE("bulk processes") {
  TEST_CASE("coarser grains fill as much, softer ones have smaller moduli") {
    const Scene<3> drum = scene_of("drum_space.toml");
    const Scene<3> coarse = coarser(drum, 2);
    const Scene<3> soft = softer(drum, 4);

    CHECK(relative_error(solid_volume(coarse), solid_volume(drum)) < 1e-3);
    CHECK(std::get<double>(coarse.fills[0].radius) == 0.004);
    CHECK(*coarse.fills[0].count == 1000);
    CHECK(relative_error(soft.law.modulus, drum.law.modulus / 4) < 1e-15);
    for (std::size_t k = 0; k < drum.pairs.size(); ++k) {
      CHECK(relative_error(soft.pairs[k].law.modulus, drum.pairs[k].law.modulus / 4) < 1e-15);
    }
  }

  TEST_CASE("the moduli of the scenes are those of the materials, by one factor") {
    const auto effective = [](double a, double b) { return 1 / (0.96 / a + 0.96 / b); };
    const double m1 = 1e9, m2 = 0.5e9, steel = 210e9;
    for (const std::string file : {"silo_space.toml", "drum_space.toml", "penetration.toml"}) {
      const double factor = file == "penetration.toml" ? 50 : 100;
      const Scene<3> scene = scene_of(file);
      const auto young = [&](int material) {
        const std::string& name = scene.materials[static_cast<std::size_t>(material)].name;
        return name == "M1" ? m1 : name == "M2" ? m2 : steel;
      };
      CAPTURE(file);
      CHECK(relative_error(factor * scene.law.modulus, effective(m1, m1)) < 1e-3);
      for (const PairLaw& pair : scene.pairs) {
        CHECK(relative_error(factor * pair.law.modulus, effective(young(pair.a), young(pair.b))) <
              1e-3);
      }
    }
  }

  TEST_CASE("another orifice keeps the funnel's slope, and the scene has the published one") {
    const Scene<3> silo = scene_of("silo_space.toml");
    for (const double orifice : {0.06, 0.04}) {
      const Scene<3> other = with_orifice(silo, orifice);
      const Wall<3>& funnel = wall(other, 1, "funnel");
      const Wall<3>& gate = wall(other, 2, "gate");
      const auto& cone = std::get<Frustum>(funnel.pieces()->piece(0));
      CHECK(relative_error(cone.low_radius, orifice / 2) < 1e-15);
      CHECK(cone.high_radius == 0.1);
      CHECK(relative_error(cone.height, 0.1 - orifice / 2) < 1e-15);
      CHECK(relative_error(-funnel.point.z(), cone.height) < 1e-15);
      CHECK(gate.point == funnel.point);
      CHECK(std::get<Frustum>(gate.pieces()->piece(0)).high_radius == cone.low_radius);
      CHECK(gate_of(other) == 0.3);
      CHECK(gate.material == silo.walls[2].material);
    }
    CHECK(relative_error(with_orifice(silo, 0.06).walls[1].point.z(), silo.walls[1].point.z()) <
          1e-14);
    CHECK(relative_error(with_orifice(silo, 0.06).outlets[0].region.high.z(),
                         silo.outlets[0].region.high.z()) < 1e-14);
  }

  TEST_CASE("flows of the law give its constants, and scatter their errors") {
    const std::vector<double> x{6, 8, 10, 15};
    std::vector<double> flow;
    for (const double d : x) flow.push_back(0.58 * std::pow(d - 1.4, 2.5));
    const Beverloo exact = fit_beverloo(x, flow);
    CHECK(relative_error(exact.c, 0.58) < 1e-12);
    CHECK(relative_error(exact.k, 1.4) < 1e-12);
    CHECK(exact.c_error < 1e-12);
    CHECK(exact.k_error < 1e-12);

    for (std::size_t i = 0; i < x.size(); ++i) flow[i] *= i % 2 == 0 ? 1.02 : 0.98;
    const Beverloo off = fit_beverloo(x, flow);
    CHECK(off.c_error > 0);
    CHECK(std::abs(off.c - 0.58) < 3 * off.c_error);
    CHECK(std::abs(off.k - 1.4) < 3 * off.k_error);
  }

  TEST_CASE("a flow in the law's units is mass over bulk density") {
    // Grains of 4 mm at a solid fraction of 0.6, of any density: W = 0.6 rho sqrt(g d^5) at 1.
    const double grain = 0.004, mass = 2500 * std::numbers::pi / 6 * std::pow(grain, 3);
    const double rate = 0.6 * 2500 * std::sqrt(9.81 * std::pow(grain, 5)) / mass;
    CHECK(relative_error(beverloo_flow(rate, grain, 0.6), 1) < 1e-14);
  }

  TEST_CASE("a ball that obeys the law of impacts gives its numbers") {
    // m a = m g - m v^2 / d - k z, in small steps.
    const double length = 0.05, stiffness = 2000;
    Penetration p;
    p.surface = 0.1;
    p.ball = 0.01;
    double z = 0, v = 5;
    for (int step = 0; v > 0; ++step) {
      if (step % 100 == 0) {
        p.time.push_back(1e-6 * step);
        p.height.push_back(p.surface + p.ball - z);
        p.speed.push_back(v);
      }
      const double a = 9.81 - v * v / length - stiffness * z;
      z += 1e-6 * v + 0.5e-12 * a;
      v += 1e-6 * a;
    }
    const ImpactLaw law = fit_impact_law(p);
    CHECK(relative_error(law.length, length) < 1e-3);
    CHECK(relative_error(law.stiffness, stiffness) < 1e-2);
    CHECK(law.worst < 2e-3);
  }

  TEST_CASE("a silo empties at a steady rate") {
    Scene<3> scene = coarser(scene_of("silo_space.toml"), 4);
    scene.duration = 0.8;
    const Silo silo = run_silo(scene, kGoOn);

    check_sound(silo.report);
    CHECK(silo.report.grains == 625);
    CHECK(silo.left.front() == 625);
    CHECK(silo.left.back() < 600);
    CHECK(silo.rate > 0);
    CHECK(silo.rate_error < silo.rate / 2);
    CHECK(silo.solid > 0.5);
    CHECK(silo.solid < 0.65);
    CHECK(silo.radius.size() == silo.speed.size());
  }

  TEST_CASE("the torque of a drum is the weight's moment and the change of angular momentum") {
    Scene<3> scene = coarser(scene_of("drum_space.toml"), 5);
    scene.duration = 1.3;
    const Drum drum = run_drum(scene, kGoOn);

    check_sound(drum.report);
    REQUIRE(drum.time.size() > 40);
    CHECK(drum.grains[0] + drum.grains[1] == drum.report.grains);
    double torque = 0, difference = 0;
    for (std::size_t k = 1; k < drum.time.size(); ++k) {
      torque += drum.torque[k];
      difference += std::abs(drum.torque[k] - drum.weight[k] - drum.momentum[k]);
      for (std::size_t kind = 0; kind < 2; ++kind) {
        CHECK(drum.count[kind][0][k] + drum.count[kind][1][k] <= drum.grains[kind]);
      }
    }
    CHECK(torque > 0);
    CHECK(difference < 0.01 * torque);
  }

  TEST_CASE("a ball comes to rest in a bed") {
    const Penetration p = run_penetration(coarser(scene_of("penetration.toml"), 4), kGoOn);

    check_sound(p.report);
    REQUIRE(p.time.size() > 300);
    CHECK(relative_error(p.speed.front(), 5) < 2e-3);
    CHECK(std::abs(p.height.front() - kRelease) < 2e-3);
    CHECK(std::abs(p.speed.back()) < 0.5);
    CHECK(p.depth(p.time.size() - 1) > 0.02);
    CHECK(p.height.back() > p.ball);
    CHECK(p.layer.size() == p.position.cols());
  }

  TEST_CASE("pieces of work are done once each, and a failure or the user stops the others") {
    FigureOptions options;
    std::vector<std::atomic<int>> done(20);
    do_together(
        done.size(), [&](std::size_t k, const Watch& watch) { done[k] += watch(1); }, options, "");
    for (const auto& times : done) CHECK(times == 1);

    const auto until_told = [](const Watch& watch) {
      while (watch(0.5)) {
      }
    };
    CHECK_THROWS_WITH_AS(do_together(
                             5,
                             [&](std::size_t k, const Watch& watch) {
                               if (k == 0) throw std::runtime_error("no");
                               until_told(watch);
                             },
                             options, ""),
                         "no", std::runtime_error);
    options.stop = [] { return true; };
    CHECK_THROWS_AS(
        do_together(
            3, [&](std::size_t, const Watch& watch) { until_told(watch); }, options, ""),
        Interrupted);
  }
}
