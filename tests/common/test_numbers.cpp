// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/numbers.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>

using namespace lagrain;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_SUITE("numbers") {
  TEST_CASE("the shortest text of a double reads back as the same double") {
    for (const double value : {0.1, -0.0, 1.0 / 3, 1e-310, 1.7976931348623157e308}) {
      CHECK(std::strtod(shortest(value).c_str(), nullptr) == value);
    }
    CHECK(shortest(0.1) == "0.1");
    CHECK(shortest(-kInfinity) == "-inf");
  }

  TEST_CASE("significant digits") {
    CHECK(rounded(0.012345) == "0.0123");
    CHECK(rounded(1.2345e-5) == "1.23e-05");
    CHECK(rounded(kInfinity) == "inf");
  }

  TEST_CASE("decimals, and no sign before a zero") {
    CHECK(fixed(12.3, 2) == "12.30");
    CHECK(fixed(-0.004, 2) == "0.00");
    CHECK(fixed(-0.006, 2) == "-0.01");
    CHECK(fixed(2.5, 0) == "2");  // halves go to the even digit
    CHECK(fixed(1e308, 1).size() == 311);
    CHECK(fixed(std::numeric_limits<double>::quiet_NaN(), 1) == "nan");
  }

  TEST_CASE("hundredths") {
    CHECK(percent(0.1234) == "12 %");
    CHECK(percent(0.1234, 4) == "12.34 %");
  }

  TEST_CASE("commas between the thousands") {
    CHECK(grouped(999) == "999");
    CHECK(grouped(-999) == "-999");
    CHECK(grouped(1234567) == "1,234,567");
    CHECK(grouped(std::numeric_limits<std::int64_t>::min()) == "-9,223,372,036,854,775,808");
  }
}
