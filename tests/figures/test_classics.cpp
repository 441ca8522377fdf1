// SPDX-License-Identifier: GPL-3.0-or-later
// The measurements of figure 21 on beds whose answer is known.

#include "classics.hpp"

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::figures;
using lagrain::test::relative_error;

namespace {

const std::string kScenes = LAGRAIN_SCENES;
constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

TEST_SUITE("classics") {
  TEST_CASE("Janssen's stress is the bed's weight near the surface, and has a limit") {
    CHECK(relative_error(janssen_stress(1e-6, 2e4, 0.3), 2e4 * 1e-6) < 1e-5);
    CHECK(relative_error(janssen_stress(100, 2e4, 0.3), 2e4 * 0.3) < 1e-14);
  }

  TEST_CASE("a fit finds the length of a profile that is Janssen's") {
    std::vector<double> depth, stress;
    for (int k = 1; k <= 20; ++k) {
      depth.push_back(0.05 * k);
      stress.push_back(janssen_stress(depth.back(), 2e4, 0.23));
    }
    CHECK(relative_error(janssen_length(depth, stress, 2e4), 0.23) < 1e-7);
  }

  TEST_CASE("the flanks of a heap of rows have its angle") {
    constexpr double kR = 0.005;
    for (const double degrees : {10.0, 25.0, 40.0}) {
      std::vector<Vec<2>> places;
      for (int row = 0; row < 40; ++row) {
        const double y = (2 * row + 1) * kR;
        const double half = (0.2 - y) / std::tan(degrees * kDegree);
        for (double x = -half; x <= half; x += 2 * kR) places.push_back({x, y});
      }
      Columns<2> x(2, static_cast<Eigen::Index>(places.size()));
      for (std::size_t i = 0; i < places.size(); ++i) {
        x.col(static_cast<Eigen::Index>(i)) = places[i];
      }

      const auto angles = flank_angles(x, Eigen::VectorXd::Constant(x.cols(), kR));

      REQUIRE(angles.size() == 2);
      for (const double angle : angles) CHECK(relative_error(angle, degrees * kDegree) < 0.06);
    }
  }

  TEST_CASE("a heap of three discs has no flanks") {
    Columns<2> x(2, 3);
    x << -0.01, 0, 0.01, 0.005, 0.013, 0.005;
    CHECK(flank_angles(x, Eigen::VectorXd::Constant(3, 0.005)).empty());
  }

  TEST_CASE("stresses of three to one mobilise thirty degrees") {
    CHECK(relative_error(friction_angle(3, 1), 30 * kDegree) < 1e-14);
  }

  TEST_CASE("between smooth walls the stress is the weight above") {
    Scene<2> scene = read_scene<2>(kScenes + "/janssen.toml");
    scene.law.friction = 0;
    scene.audit = false;
    scene.fills.front().count = 300;
    scene.fills.front().region.high[1] = 0.22;
    scene.law.stiffness = 5e5;
    const auto run = make_run(scene, 1);

    const JanssenSilo silo = run_silo(*run, FigureOptions());

    CHECK(silo.wall_friction == 0);
    CHECK(relative_error(silo.width, 0.15) < 1e-15);
    int full = 0;
    for (std::size_t k = 0; k < silo.depth.size(); ++k) {
      if (silo.depth[k] < 0.05) continue;
      ++full;
      CHECK(relative_error(silo.vertical[k], silo.weight * silo.depth[k]) < 0.08);
    }
    CHECK(full >= 2);
  }

  TEST_CASE("the biaxial bed is dense, and rests under the pressure of its piston") {
    Scene<2> scene = read_scene<2>(kScenes + "/biaxial.toml");
    scene.audit = false;
    scene.duration = 0.26;
    const auto run = make_run(scene, 1);
    double solid = 0;
    for (int i = 0; i < run->count(); ++i) {
      solid += std::numbers::pi * run->radii()[i] * run->radii()[i];
    }

    const Biaxial test = run_biaxial(*run, FigureOptions());

    CHECK(run->count() == 1440);
    REQUIRE(test.strain.size() >= 2);
    CHECK(std::abs(test.strain.front()) < 1e-3);
    CHECK(std::abs(test.dilation.front()) < 1e-3);
    REQUIRE(scene.walls[0].name == "side");
    REQUIRE(scene.walls[1].name == "top");
    const double width = scene.walls[0].point[0], height = scene.walls[1].point[1];
    CHECK(solid / (width * height) > 0.83);
    CHECK(relative_error(test.lateral.front(), 10e3) < 0.01);
    CHECK(test.axial.back() > test.axial.front());
  }
}
