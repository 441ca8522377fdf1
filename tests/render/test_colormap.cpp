// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/colormap.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <initializer_list>
#include <limits>

using namespace lagrain;

TEST_SUITE("colormap") {
  TEST_CASE("the maps end in the colours of their sources") {
    CHECK(colour(ColourMap::viridis, 0) == Colour{68, 1, 84, 255});
    CHECK(colour(ColourMap::viridis, 1) == Colour{253, 231, 37, 255});
    CHECK(colour(ColourMap::cividis, 0) == Colour{0, 34, 78, 255});
    CHECK(colour(ColourMap::cividis, 1) == Colour{254, 232, 56, 255});
    CHECK(colour(ColourMap::blue_red, 0) == Colour{59, 76, 192, 255});
    CHECK(colour(ColourMap::blue_red, 1) == Colour{180, 4, 38, 255});
  }

  TEST_CASE("lightness of an ordered map grows evenly, so that it reads in grey") {
    for (const ColourMap map : {ColourMap::viridis, ColourMap::cividis}) {
      const double whole = lightness(colour(map, 1)) - lightness(colour(map, 0));
      CHECK(whole > 70);
      for (int k = 0; k < 8; ++k) {
        const double part = lightness(colour(map, (k + 1) / 8.0)) - lightness(colour(map, k / 8.0));
        CHECK(part > 0.5 * whole / 8);
        CHECK(part < 1.5 * whole / 8);
      }
    }
  }

  TEST_CASE("lightness of an ordered map never falls by more than rounding") {
    for (const ColourMap map : {ColourMap::viridis, ColourMap::cividis}) {
      for (int k = 0; k < 255; ++k) {
        CHECK(lightness(colour(map, (k + 1) / 255.0)) > lightness(colour(map, k / 255.0)) - 0.15);
      }
    }
  }

  TEST_CASE("the signed map is lightest and neutral in the middle") {
    const Colour middle = colour(ColourMap::blue_red, 0.5);

    CHECK(std::abs(middle.r - middle.b) <= 4);
    for (int k = 0; k < 127; ++k) {
      CHECK(lightness(colour(ColourMap::blue_red, k / 255.0)) < lightness(middle) + 0.3);
      CHECK(lightness(colour(ColourMap::blue_red, 1 - k / 255.0)) < lightness(middle) + 0.3);
    }
  }

  TEST_CASE("values outside the range take the end colours, and NaN is grey") {
    CHECK(colour(ColourMap::viridis, -3) == colour(ColourMap::viridis, 0));
    CHECK(colour(ColourMap::viridis, 7) == colour(ColourMap::viridis, 1));
    CHECK(colour(ColourMap::viridis, std::numeric_limits<double>::quiet_NaN()) ==
          Colour{128, 128, 128, 255});
  }

  TEST_CASE("white is 100 and black is 0 on the scale of lightness") {
    // The coefficients of the three channels, given to seven digits, add up to 1 + 1e-7.
    CHECK(test::relative_error(lightness({255, 255, 255, 255}), 100) < 1e-7);
    CHECK(lightness({0, 0, 0, 255}) == 0);
    CHECK(test::relative_error(lightness({119, 119, 119, 255}), 50) < 0.01);
  }

  TEST_CASE("categories wrap around") {
    CHECK(category(0) == category(8));
    CHECK(category(-1) == category(7));
    CHECK(category(0) != category(1));
  }
}
