// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/laguerre2.hpp>

#include <lagrain/check.hpp>

#include <support/tolerance.hpp>
#include "dim2/sets2.hpp"
#include "support/cases.hpp"

#include <doctest/doctest.h>

using namespace lagrain;

TEST_SUITE("laguerre2") {
  TEST_CASE("the cells of a box fill the box") {
    for (int seed = 0; seed < test::cases(5, 200); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const test::Sites& s : test::all_kinds(random)) {
        CAPTURE(seed);
        CAPTURE(s.name);
        const Vec<2> low = s.x.rowwise().minCoeff(), high = s.x.rowwise().maxCoeff();
        const Vec<2> margin = 0.1 * (high - low);
        const Eigen::AlignedBox2d box(low - margin, high + margin);
        const auto t = test::built(s);

        double sum = 0;
        for (int i = 0; i < s.size(); ++i) sum += polygon_area(laguerre_cell(t, i, box));

        // Corners round to about 1e-16 of the coordinates, each along an edge as long as a cell.
        const double rounding = 1e-13 * (1 + box.max().norm() / box.sizes().norm()) * s.size();
        CHECK(test::relative_error(sum, box.volume()) < rounding);
      }
    }
  }

  TEST_CASE("the corners of a cell have no smaller power to any other site") {
    Random random(3);
    const test::Sites s = test::overlapping(random, 60);
    const auto t = test::built(s);
    const Eigen::AlignedBox2d box(Vec<2>(-1, -1), Vec<2>(9, 9));
    REQUIRE(!t.hidden().empty());

    for (int i = 0; i < s.size(); ++i) {
      const Columns<2> cell = laguerre_cell(t, i, box);
      for (Eigen::Index k = 0; k < cell.cols(); ++k) {
        const auto power = [&](int j) { return (cell.col(k) - s.x.col(j)).squaredNorm() - s.w[j]; };
        for (int j = 0; j < s.size(); ++j) CHECK(power(i) <= power(j) + 1e-10);
      }
    }
    CHECK(laguerre_cell(t, t.hidden()[0], box).cols() == 0);
  }

  TEST_CASE("one site has the whole box, and a cell outside the box is empty") {
    const auto one = test::built(test::make_sites("one", {{0, 0, 1}}));
    const auto two = test::built(test::make_sites("two", {{0, 0, 1}, {10, 0, 1}}));
    const Eigen::AlignedBox2d box(Vec<2>(-1, -1), Vec<2>(2, 1));

    CHECK(test::relative_error(polygon_area(laguerre_cell(one, 0, box)), 6) < 1e-15);
    CHECK(test::relative_error(polygon_area(laguerre_cell(two, 0, box)), 6) < 1e-15);
    CHECK(laguerre_cell(two, 1, box).cols() == 0);
    CHECK_THROWS_AS(laguerre_cell(two, 2, box), ContractError);
    CHECK_THROWS_AS(laguerre_cell(two, 0, Eigen::AlignedBox2d()), ContractError);
  }
}
