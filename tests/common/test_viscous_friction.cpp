// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/viscous_friction.hpp>

#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace lagrain;
using namespace lagrain::test;

TEST_SUITE("viscous_friction") {
  TEST_CASE_TEMPLATE("the film drags in proportion to the slip until Coulomb's limit", C,
                     Case<2, ViscousSpring>, Case<3, ViscousSpring>) {
    const auto law = make_law<ViscousSpring>({.friction = 0.5, .tangential_damping_ratio = 0.3});
    Touch<C::Dim> touch;
    touch.normal = up<C::Dim>();
    touch.overlap = 1e-3;
    touch.effective_mass = 4;
    touch.effective_radius = 1;
    const double g = 2 * 0.3 * std::sqrt(1e6 * 4);
    const double limit = 0.5 * 1e6 * 1e-3;
    NoMemory none;
    for (const double factor : {0.0, 0.1, 0.999, 1.001, 10.0}) {
      CAPTURE(factor);
      touch.slip = factor * limit / g * along<C::Dim>();

      const Response<C::Dim> response = law.respond(touch, none, 1e-5);

      const double drag = std::min(factor, 1.0) * limit;
      CHECK(relative_error(-response.force.dot(along<C::Dim>()), drag) < 1e-13);
      CHECK(relative_error(response.friction_loss, drag * touch.slip.norm() * 1e-5) < 1e-13);
    }
  }
}
