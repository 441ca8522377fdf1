// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/units.hpp>

#include <doctest/doctest.h>

#include <numbers>
#include <stdexcept>
#include <string>

using namespace lagrain;

TEST_SUITE("units") {
  TEST_CASE("a quantity is the double nearest to what was written") {
    const auto same = [](const char* text, double value, Unit unit) {
      CAPTURE(text);
      const Quantity q = parse_quantity(text);
      CHECK(q.value == value);
      CHECK(to_string(q.unit) == to_string(unit));
      CHECK(q.unit == unit);
    };

    same("8 mm", 0.008, {1, 0, 0});
    same("8mm", 0.008, {1, 0, 0});
    same("0.7 cm", 0.007, {1, 0, 0});
    same("1.1e+2 mm", 0.11, {1, 0, 0});
    same("0.7 1/mm", 700, {-1, 0, 0});
    same("2650 kg/m^3", 2650, {-3, 1, 0});
    same("2.65 g/cm^3", 2650, {-3, 1, 0});
    same("1e7 N/m", 1e7, {0, 1, -2});
    same("3 N/mm", 3000, {0, 1, -2});
    same("5 ms", 0.005, {0, 0, 1});
    same("12 us", 12e-6, {0, 0, 1});
    same("2 Hz", 2, {0, 0, -1});
    same("10 m/s", 10, {1, 0, -1});
    same("9.81 m/s^2", 9.81, {1, 0, -2});
    same("9.81 m*s^-2", 9.81, {1, 0, -2});
    same("2 MPa", 2e6, {-1, 1, -2});
    same("50 kN", 5e4, {1, 1, -2});
    same("1.5 t", 1500, {0, 1, 0});
    same("2 min", 120, {0, 0, 1});
    same("1 h", 3600, {0, 0, 1});
    same("5 %", 0.05, {});
    same("-3", -3, {});
    same("180 deg", std::numbers::pi, {});
    same("60 rpm", 60 * (std::numbers::pi / 30), {0, 0, -1});
  }

  TEST_CASE("what is no quantity is refused with a reason") {
    const auto reason = [](const char* text) -> std::string {
      try {
        parse_quantity(text);
      } catch (const std::invalid_argument& e) {
        return e.what();
      }
      return "accepted";
    };

    CHECK(reason("fast") == "no number");
    CHECK(reason("") == "no number");
    CHECK(reason("8 furlong") == "unknown unit \"furlong\"");
    CHECK(reason("8 m /") == "the unit breaks off");
    CHECK(reason("8 m^x") == "unknown power \"m^x\"");
    CHECK(reason("8 m^") == "unknown power \"m^\"");
    CHECK(reason("8 kmin") == "unknown unit \"kmin\"");
    CHECK(reason("8 / s") == "unknown unit \"\"");
  }
}
