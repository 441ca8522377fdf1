// SPDX-License-Identifier: GPL-3.0-or-later
// The impacts of figure 19 against closed forms: Hertz along the normal, momentum across it.

#include "impacts.hpp"

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

using namespace lagrain;
using namespace lagrain::figures;
using lagrain::test::relative_error;

namespace {

Impacts impacts_of(const std::string& scene, double steps = 25) {
  FigureOptions options;
  options.scenes = LAGRAIN_SCENES;
  const std::string file = LAGRAIN_SCENES "/impacts/" + scene + ".toml";
  return run_impacts(read_scene<3>(file), steps, options);
}

/// The first impact of a material.
const Impact& impact_of(const Impacts& impacts, const std::string& upper,
                        const std::string& lower = "") {
  return *std::find_if(impacts.all.begin(), impacts.all.end(), [&](const Impact& i) {
    return i.upper.starts_with(upper) && i.lower.starts_with(lower);
  });
}

/// E* [Pa] of two bodies with a Young's modulus [Pa] and Poisson's ratio. The second one is so many
/// times as stiff.
double modulus(double young, double poisson, double times = 1) {
  return young / (1 - poisson * poisson) / (1 + 1 / times);
}

constexpr double kRigid = 1e300;

}  // namespace

TEST_SUITE("impacts") {
  TEST_CASE("the scenes' moduli and tangential stiffness are those of their materials") {
    const auto has = [](const Impact& impact, double expected, double poisson) {
      CAPTURE(impact.upper);
      CAPTURE(impact.lower);
      CHECK(relative_error(impact.law.modulus, expected) < 1e-10);
      if (impact.law.friction == 0) return;
      const double mindlin = 2 * (1 - poisson) / (2 - poisson);
      CHECK(relative_error(impact.law.stiffness_ratio, mindlin) < 1e-9);
    };
    const Impacts pair = impacts_of("elastic_pair"), plane = impacts_of("elastic_plane");
    has(impact_of(pair, "glass"), modulus(48e9, 0.2), 0.2);
    has(impact_of(pair, "limestone"), modulus(20e9, 0.25), 0.25);
    has(impact_of(plane, "aluminium"), modulus(70e9, 0.3, kRigid), 0.3);
    has(impact_of(plane, "magnesium"), modulus(40e9, 0.35, kRigid), 0.35);
    const Impacts restitution = impacts_of("restitution"), angle = impacts_of("oblique_angle");
    has(impact_of(restitution, "oxide"), modulus(380e9, 0.23, kRigid), 0.23);
    has(impact_of(restitution, "iron"), modulus(100e9, 0.25, kRigid), 0.25);
    has(impact_of(angle, "oxide"), modulus(380e9, 0.23, kRigid), 0.23);
    has(impact_of(angle, "alloy"), modulus(70e9, 0.33, kRigid), 0.33);
    const Impacts speed = impacts_of("oblique_speed"), spin = impacts_of("spin_on_plane");
    has(impact_of(speed, "steel"), modulus(208e9, 0.3, kRigid), 0.3);
    has(impact_of(speed, "polyethylene"), modulus(1e9, 0.4, kRigid), 0.4);
    has(impact_of(spin, "alloy"), modulus(70e9, 0.33, kRigid), 0.33);
    has(impact_of(spin, "nylon"), modulus(2.5e9, 0.4, kRigid), 0.4);
    const Impacts like = impacts_of("spin_pair"), unequal = impacts_of("spin_unequal");
    has(impact_of(like, "alloy"), modulus(70e9, 0.33), 0.33);
    has(impact_of(like, "copper"), modulus(120e9, 0.35), 0.35);
    has(impact_of(unequal, "alloy", "A"), modulus(70e9, 0.33, 1000), 0.33);
    has(impact_of(unequal, "alloy", "B"), modulus(70e9, 0.33), 0.33);
  }

  TEST_CASE("Hertz's impact lasts as long as Johnson says, and is half over at its deepest") {
    const Impacts impacts = impacts_of("elastic_plane");
    const Impact& impact = impacts.all.front();

    const HertzImpact hertz = hertz_impact(impact);

    CHECK(relative_error(hertz.duration, 2.94328 * hertz.overlap / 0.2) < 2e-6);
    CHECK(relative_error(hertz_time(impact, hertz.overlap), hertz.duration / 2) < 1e-14);
    CHECK(std::abs(hertz_time(impact, 0)) < 1e-14 * hertz.duration);
    // All energy is in the spring: 2/5 of force times overlap.
    const double energy = 0.5 * impact.effective_mass * 0.2 * 0.2;
    CHECK(relative_error(0.4 * hertz.force * hertz.overlap, energy) < 1e-14);
    // 7108 N and 7233 N are published for limestone and a magnesium alloy.
    CHECK(relative_error(hertz_impact(impacts.all[1]).force, 7233) < 1e-4);
    CHECK(relative_error(hertz_impact(impacts_of("elastic_pair").all[1]).force, 7108) < 1e-4);
  }

  TEST_CASE("elastic impacts have Hertz's force, duration and rebound") {
    for (const std::string scene : {"elastic_pair", "elastic_plane"}) {
      const Impacts usual = impacts_of(scene), finer = impacts_of(scene, 100);
      CHECK(usual.missed == 0);
      CHECK(usual.audited > 0);
      for (std::size_t k = 0; k < 2; ++k) {
        const Impact& impact = usual.all[k];
        const HertzImpact hertz = hertz_impact(impact);
        CHECK(relative_error(impact.largest_force(), hertz.force) < 3e-3);
        CHECK(relative_error(impact.duration, hertz.duration) < 2e-3);
        CHECK(relative_error(impact.restitution(), 1) < 2e-3);
        CHECK(relative_error(finer.all[k].largest_force(), hertz.force) < 3e-4);
        CHECK(relative_error(finer.all[k].duration, hertz.duration) < 2e-4);
        CHECK(relative_error(finer.all[k].restitution(), 1) < 2e-4);
        for (const ImpactMoment& moment : impact.moments) {
          CHECK(relative_error(moment.force, hertz_force(impact, moment.overlap)) < 1e-13);
        }
      }
    }
  }

  TEST_CASE("a damped impact has the restitution that is named") {
    for (const Impact& impact : impacts_of("restitution", 100).all) {
      CAPTURE(impact.upper);
      CHECK(relative_error(impact.restitution(), impact.law.restitution) < 5e-3);
    }
  }

  TEST_CASE("what slides without a dashpot loses across what Coulomb's law takes, to rounding") {
    int sliding = 0;
    for (const Impact& impact : impacts_of("oblique_speed").all) {
      if (!slides(impact)) continue;
      ++sliding;
      const ImpactMotion exact = after_sliding(impact);
      const double normal = impact.before.approach - impact.after.approach;
      const double across = impact.before.across - impact.after.across;
      CHECK(relative_error(across, impact.law.friction * normal) < 1e-12);
      CHECK(velocity_error(impact, exact) < 1e-4);
      // Friction turns the sphere about its flattened surface.
      CHECK(impact.after.spin < exact.spin);
      CHECK(relative_error(impact.after.spin, exact.spin) < 0.03);
    }
    CHECK(sliding == 6);
  }

  TEST_CASE("oblique impacts slide beyond the angle of rigid spheres") {
    const Impacts impacts = impacts_of("oblique_angle");
    int sliding = 0;
    for (const Impact& impact : impacts.all) {
      const double tangent = impact.before.slip / impact.before.approach;
      CHECK(slides(impact) == (tangent > std::tan(0.57)));  // 32.5 degrees
      if (!slides(impact)) continue;
      ++sliding;
      CHECK(velocity_error(impact, after_sliding(impact)) < 5e-4);
      CHECK(impact.after.slip > 0);
    }
    CHECK(sliding == 14);
    CHECK(impacts.missed == 0);
  }

  TEST_CASE("spheres that spin like gears keep their spins, and rubbing ones lose what slides") {
    const Impacts impacts = impacts_of("spin_pair");
    int gears = 0;
    for (const Impact& impact : impacts.all) {
      if (impact.before.slip == 0) {
        ++gears;
        CHECK(impact.after.spin == impact.before.spin);
        CHECK(impact.after.across == 0);
      } else if (slides(impact)) {
        CHECK(velocity_error(impact, after_sliding(impact)) < 3e-3);
        CHECK(spin_error(impact, after_sliding(impact)) < 5e-3);
      } else {
        CHECK(std::abs(impact.after.slip) < impact.before.slip);
      }
    }
    CHECK(gears == 10);
  }

  TEST_CASE("a much heavier sphere is nearly a plane") {
    const Impacts on_plane = impacts_of("spin_on_plane", 100);
    const Impacts on_sphere = impacts_of("spin_unequal", 100);
    for (std::size_t k = 0; k < 17; ++k) {  // the alloy; case A
      const Impact &plane = on_plane.all[k], &sphere = on_sphere.all[k];
      CHECK(velocity_error(sphere, plane.after) < 0.02);
      CHECK(spin_error(sphere, plane.after) < 0.02);
    }
  }

  TEST_CASE("an impact that has not ended is an error") {
    FigureOptions options;
    Scene<3> scene = read_scene<3>(LAGRAIN_SCENES "/impacts/elastic_plane.toml");
    scene.duration = 3e-4;
    CHECK_THROWS_AS(run_impacts(scene, 25, options), SimulationError);
  }
}
