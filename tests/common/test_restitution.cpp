// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/restitution.hpp>

#include <lagrain/check.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace lagrain;

namespace {

struct Impact {
  double restitution;
  double duration;
};

/// The clamped spring and dashpot, integrated by classical Runge-Kutta in units of omega0: an
/// independent way to the closed form.
Impact integrate_impact(double zeta) {
  const double h = 1e-5 / std::max(1.0, zeta);
  const auto acceleration = [zeta](double x, double v) { return -(x + 2 * zeta * v); };
  double x = 0;
  double v = 1;
  double t = 0;
  while (-acceleration(x, v) > 0 || t == 0) {
    const double v1 = v, a1 = acceleration(x, v);
    const double v2 = v + h / 2 * a1, a2 = acceleration(x + h / 2 * v1, v2);
    const double v3 = v + h / 2 * a2, a3 = acceleration(x + h / 2 * v2, v3);
    const double v4 = v + h * a3, a4 = acceleration(x + h * v3, v4);
    x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    t += h;
  }
  return {-v, t};
}

}  // namespace

TEST_SUITE("restitution") {
  TEST_CASE("the closed form agrees with an integrated impact, on both sides of critical damping") {
    for (const double zeta : {0.0, 0.05, 0.3, 0.7, 0.999, 1.0, 1.001, 2.0, 5.0}) {
      CAPTURE(zeta);

      const Impact impact = integrate_impact(zeta);

      // The integration overshoots the end by up to a step of 1e-5. The force is zero at the end,
      // so the speed hardly changes there.
      CHECK(test::relative_error(clamped_restitution(zeta), impact.restitution) < 1e-9);
      CHECK(test::relative_error(clamped_contact_time(zeta), impact.duration) < 1e-5);
    }
  }

  TEST_CASE("the damping solved for a restitution gives that restitution") {
    for (const double e : {1.0, 0.999, 0.9, 0.5, 0.2, 0.05, 1e-3}) {
      CAPTURE(e);
      CHECK(test::relative_error(clamped_restitution(damping_ratio_for(e)), e) < 1e-11);
    }
  }

  // The right values were computed with 200 bits.
  TEST_CASE("the damping ratio has 40 bits, the same with every C library") {
    CHECK(damping_ratio_for(0.9) == 0x1.18b357639ep-5);
    CHECK(damping_ratio_for(0.5) == 0x1.0566fa0caap-2);
    CHECK(damping_ratio_for(0.3) == 0x1.fd2c52ea1p-2);
    CHECK(damping_ratio_for(0.2) == 0x1.7665ff47a6p-1);
    CHECK(damping_ratio_for(0.05) == 0x1.f20235216ep+0);
    CHECK(damping_ratio_for(0.001) == 0x1.f6f20fdc86p+3);
  }

  TEST_CASE("the textbook relation would have given 0.550 for 0.5 and 0.325 for 0.2") {
    const auto textbook_ratio = [](double e) {
      const double l = std::log(e);
      return -l / std::hypot(std::numbers::pi, l);
    };

    CHECK(test::relative_error(clamped_restitution(textbook_ratio(0.5)), 0.550) < 1e-3);
    CHECK(test::relative_error(clamped_restitution(textbook_ratio(0.2)), 0.325) < 2e-3);
  }

  TEST_CASE("a restitution outside (0, 1] is refused") {
    CHECK_THROWS_AS(damping_ratio_for(0), ContractError);
    CHECK_THROWS_AS(damping_ratio_for(-0.1), ContractError);
    CHECK_THROWS_AS(damping_ratio_for(1.01), ContractError);
    CHECK_THROWS_AS(damping_ratio_for(std::nan("")), ContractError);
  }
}
