// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/text.hpp>

#include "support.hpp"

#include <lagrain/check.hpp>
#include <lagrain/paint.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <numbers>
#include <string>

using namespace lagrain;
using lagrain::test::pixel;
using lagrain::test::relative_error;

TEST_SUITE("text") {
  TEST_CASE(
      "the ink of a label lies inside its reported box, and the box is no larger than needed") {
    for (const std::string text :
         {"$S_1$", "$P_1(x)$", "force $f_{ij}$ [N m$^{-1}$]", "Ag$\\mu^2$"}) {
      for (const double angle : {0.0, std::numbers::pi / 2, 0.4}) {
        for (const Across across : {Across::left, Across::centre, Across::right}) {
          for (const Along along : {Along::baseline, Along::middle, Along::top}) {
            const Label label{text, {100, 100}, 10, {}, across, along, angle};
            DisplayList list{200, 200};
            list.add(label);

            const Box box = label_box(label);
            const Image image = paint_rgba(list, 144);

            const auto size = static_cast<double>(image.height);
            Box seen{{1e9, 1e9}, {-1e9, -1e9}};
            for (int y = 0; y < image.height; ++y) {
              for (int x = 0; x < image.width; ++x) {
                if (pixel(image, x, y, 0) > 250) continue;
                seen.low = seen.low.cwiseMin(Vec<2>(x, size - y - 1));
                seen.high = seen.high.cwiseMax(Vec<2>(x + 1, size - y));
              }
            }
            const double scale = 2;  // pixels per point
            CHECK((seen.low - scale * box.low).minCoeff() > -1.1);
            CHECK((scale * box.high - seen.high).minCoeff() > -1.1);
            if (angle != 0.4) {
              CHECK((seen.low - scale * box.low).maxCoeff() < 2);
              CHECK((scale * box.high - seen.high).maxCoeff() < 2);
            }
          }
        }
      }
    }
  }

  TEST_CASE("text scales with its size") {
    const TextExtents small = text_extents("radius $r_i$", 7),
                      large = text_extents("radius $r_i$", 14);

    CHECK(relative_error(large.advance, 2 * small.advance) < 1e-14);
    CHECK((large.ink.high - 2 * small.ink.high).norm() < 1e-9);
  }

  TEST_CASE("a subscript goes below the baseline and a superscript above the letter") {
    const double letter = text_extents("$x$", 10).ink.high[1];

    CHECK(text_extents("$x$", 10).ink.low[1] > -0.2);
    CHECK(text_extents("$x_1$", 10).ink.low[1] < -1);
    CHECK(text_extents("$x^1$", 10).ink.high[1] > letter + 2);
    CHECK(text_extents("$x_1^2$", 10).advance < text_extents("$x_1x^2$", 10).advance - 4);
  }

  TEST_CASE("a group is the same as its letters") {
    CHECK(relative_error(text_extents("$x_{1}$", 10).advance, text_extents("$x_1$", 10).advance) <
          1e-14);
    CHECK(relative_error(text_extents("$\\mathrm{kg}$", 10).advance,
                         text_extents("kg", 10).advance) < 1e-14);
  }

  TEST_CASE("relations have air around them, signs of a number have not") {
    const auto advance = [](const char* text) { return text_extents(text, 18).advance; };

    CHECK(relative_error(advance("$a=b$"), advance("$a$") + advance("$=$") + advance("$b$") + 10) <
          1e-14);
    CHECK(relative_error(advance("$-1$"), advance("$-$") + advance("$1$")) < 1e-14);
  }

  TEST_CASE("an empty label has no ink") {
    CHECK(text_extents("", 8).advance == 0);
    CHECK(text_extents("", 8).ink.size().norm() == 0);
  }

  TEST_CASE("the height of a capital is what the anchors assume") {
    CHECK(relative_error(text_extents("H", 10).ink.high[1], 10 * kCapHeight) < 0.002);
  }

  TEST_CASE("wrong markup is refused with the text in the message") {
    for (const std::string text :
         {"$x_{1$", "$x}$", "$x", "$x_$", "$\\nonsense$", "$x_1_2$", "a\\b", "$\\mathrm{m$",
          "$\\mathrm m$", "$x^{$", "$\\$", "\xff", "\xe4\xb8\xad", "$\\"}) {
      INFO(text);
      CHECK_THROWS_AS(text_extents(text, 8), ContractError);
      try {
        text_extents(text, 8);
      } catch (const ContractError& error) {
        CHECK(std::string(error.what()).find('"' + text + '"') != std::string::npos);
      }
    }
  }

  TEST_CASE("every named sign has a glyph") {
    for (const char* name :
         {"alpha",  "beta",   "gamma", "delta", "varepsilon", "zeta",    "eta", "theta", "iota",
          "kappa",  "lambda", "mu",    "nu",    "xi",         "pi",      "rho", "sigma", "tau",
          "varphi", "chi",    "psi",   "omega", "partial",    "epsilon", "phi", "Gamma", "Delta",
          "Theta",  "Lambda", "Xi",    "Pi",    "Sigma",      "Phi",     "Psi", "Omega", "times",
          "cdot",   "pm",     "le",    "ge",    "approx",     "sim",     "to",  "infty", "propto",
          "ne",     "in",     "circ",  "prime", "ldots"}) {
      CHECK(text_extents(std::string("$\\").append(name).append("$"), 8).ink.size().minCoeff() > 0);
    }
    CHECK(text_extents("5 µm ± 2 °, a ≤ b", 8).advance > 0);
    CHECK(text_extents("\\$5 \\\\", 8).advance > 0);
  }
}
