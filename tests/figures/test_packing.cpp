// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing.hpp"

#include <support/files.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

using namespace lagrain;
using namespace lagrain::test;
using namespace lagrain::figures;

namespace {

/// Square layers in each other's hollows: face-centred cubic, spheres of radius 1.
Columns<3> closest_packing(int across, int layers) {
  std::vector<Vec<3>> sites;
  for (int k = 0; k < layers; ++k) {
    for (int i = 0; i < across - k % 2; ++i) {
      for (int j = 0; j < across - k % 2; ++j) {
        sites.emplace_back(1 + 2 * i + k % 2, 1 + 2 * j + k % 2, 1 + std::numbers::sqrt2 * k);
      }
    }
  }
  Columns<3> x(3, static_cast<Eigen::Index>(sites.size()));
  for (std::size_t i = 0; i < sites.size(); ++i) x.col(static_cast<Eigen::Index>(i)) = sites[i];
  return x;
}

FigureOptions options() {
  FigureOptions o;
  o.out = std::filesystem::path(LAGRAIN_TEST_FOLDER) / "packing";
  std::filesystem::create_directories(o.out);
  o.scenes = LAGRAIN_SCENES;
  o.quick = true;
  return o;
}

}  // namespace

TEST_SUITE("packing") {
  TEST_CASE("within a face-centred cubic packing the density is pi / (3 sqrt 2)") {
    const Columns<3> x = closest_packing(7, 10);
    const Eigen::VectorXd radius = Eigen::VectorXd::Ones(x.cols());
    const Eigen::AlignedBox3d box(Vec<3>::Zero(), Vec<3>(14, 14, 2 + 9 * std::numbers::sqrt2));

    const auto [density, count] = bulk_density(x, radius, box);

    CHECK(count > 50);
    CHECK(std::abs(density - kClosestPacking) < 1e-12);
    CHECK(std::abs(kClosestPacking - 0.74048) < 1e-5);
  }

  TEST_CASE("without a grain away from the walls there is no density, and the words say so") {
    const Columns<3> x = closest_packing(3, 3);
    const Eigen::AlignedBox3d box(Vec<3>::Zero(), Vec<3>::Constant(6));
    Packing packing;

    std::tie(packing.bulk, packing.bulk_count) =
        bulk_density(x, Eigen::VectorXd::Ones(x.cols()), box);

    CHECK(packing.bulk_count == 0);
    CHECK(std::isnan(packing.bulk));
    CHECK(bulk_text(packing) == "no cell away from the walls");
  }

  TEST_CASE("a frictionless packing carries no spin, and is denser than a rough one") {
    const FigureOptions o = options();
    const Scene<3> scene = packing_scene(o, "packing_1484.toml");
    CHECK(with_friction(scene, 0).friction == FrictionModel::none);
    CHECK(with_friction(scene, 0.5).law.friction == 0.5);

    const auto packings = run_packings({{"smooth", with_friction(scene, 0)}, {"rough", scene}}, o,
                                       o.out / "density.csv");

    REQUIRE(packings.size() == 2);
    CHECK(packings[0].final_density() > packings[1].final_density() + 0.01);
    for (const Packing& p : packings) {
      CHECK(p.radius.size() == 185);
      CHECK(p.bulk > p.final_density());
      CHECK(p.cost.ladder.rebuilds == 0);
      // The box by its piston holds the solid volume at this density.
      const double solid = 185 * 4.0 / 3 * std::numbers::pi * std::pow(0.08, 3);
      CHECK(relative_error(p.final_density(), solid / p.box.volume()) < 1e-13);
    }
    CHECK(content(o.out / "density.csv").starts_with("packing,time[s],density[-]\nsmooth,"));
  }

  TEST_CASE("a shaken scene shakes every wall but the piston, for whole periods, and then rests") {
    const Scene<3> scene = shaken(packing_scene(options(), "packing_1484.toml"), 1.03);

    int shaking = 0, pistons = 0;
    for (const Wall<3>& wall : scene.walls) {
      pistons += std::holds_alternative<Piston<3>>(wall.motion);
      const auto* shake = std::get_if<Shake<3>>(&wall.motion);
      if (shake == nullptr) continue;
      ++shaking;
      const double periods = (shake->stop - shake->start) * shake->frequency;
      CHECK(relative_error(periods, std::round(periods)) < 1e-13);
      CHECK(relative_error(scene.duration, shake->stop + kRest) < 1e-13);
    }
    CHECK(shaking == 5);
    CHECK(pistons == 1);
  }

  TEST_CASE("a user who stops a figure keeps the densities of the packings so far") {
    FigureOptions o = options();
    o.stop = [] { return true; };
    Scene<3> scene = packing_scene(o, "packing_1484.toml");
    scene.seed += 1;

    CHECK_THROWS_AS(run_packings({{"stopped", scene}}, o, o.out / "stopped.csv"), Interrupted);

    CHECK(content(o.out / "stopped.csv").starts_with("packing,time[s],density[-]\n"));
  }
}
