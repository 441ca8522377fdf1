// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/skins.hpp>

#include <lagrain/random.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace lagrain;
using namespace lagrain::test;

TEST_SUITE("skins") {
  TEST_CASE("two equal grains that touch get (3 sqrt 2 - 4) r each, and a small skin is less") {
    const double r = 0.7, expected = 3 * std::sqrt(2.0) - 4;

    CHECK(relative_error(fair_skin(r, r, 4 * r * r), expected * r) < 1e-14);
    CHECK(kSmallSkin < expected);
    CHECK(kSmallSkin > 0.98 * expected);
  }

  TEST_CASE(
      "a fair skin passes the certificate when one grain has strayed by all of it; more fails") {
    Random random(1);
    for (int k = 0; k < 1000; ++k) {
      const double a = random.uniform(0.1, 1), b = random.uniform(0.1, 1);
      const double d = (a + b) * random.uniform(0.95, 3);
      const auto passes = [&](double s) {
        return d > s && passes_certificate((d - s) * (d - s), weight_with(a, s), weight_with(b, s));
      };

      const double skin = fair_skin(a, b, d * d);

      CAPTURE(a);
      CAPTURE(b);
      CAPTURE(d);
      CHECK(skin > 0);
      CHECK(passes(skin * (1 - 1e-9)));
      CHECK_FALSE(passes(skin * (1 + 1e-9)));
    }
  }

  TEST_CASE("an allowed skin passes with the reference ahead; more fails") {
    Random random(2);
    for (int k = 0; k < 1000; ++k) {
      const double r = random.uniform(0.1, 1), weight = std::pow(random.uniform(0.1, 1), 2);
      const double x = random.uniform(-3, 3), y = random.uniform(-3, 3);  // of i, seen from c_j
      const double angle = random.uniform(0, 6.28), share = random.uniform(0, 0.7);
      const double slack = x * x + y * y - r * r - weight;
      const double forward = x * std::cos(angle) + y * std::sin(angle);
      const auto passes = [&](double s) {
        const double cx = x + share * s * std::cos(angle), cy = y + share * s * std::sin(angle);
        return passes_certificate(cx * cx + cy * cy, weight_with(r, s), weight);
      };

      const double skin = allowed_skin(r - share * forward, share, slack);

      CAPTURE(k);
      CHECK((skin > 0) == (slack > 0));
      if (slack > 0.01) {
        CHECK(passes(skin * (1 - 1e-9)));
        CHECK_FALSE(passes(skin * (1 + 1e-9)));
      }
    }
  }

  TEST_CASE("grains that overlap deeply have no skin in common") {
    CHECK(fair_skin(1, 1, 1.9) == 0);
    CHECK(allowed_skin(1, 0, -0.1) == 0);
  }
}
