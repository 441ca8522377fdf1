// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/display_list.hpp>

#include <lagrain/check.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

using namespace lagrain;

TEST_SUITE("display_list") {
  TEST_CASE("a panel keeps the aspect and centres what is left over") {
    const Panel panel({{10, 20}, {110, 70}}, {{-1, 0}, {1, 2}});

    CHECK(test::relative_error(panel.scale(), 25) < 1e-15);
    CHECK(test::relative_error(panel.length(0.5), 12.5) < 1e-15);
    CHECK((panel.point({0, 1}) - Vec<2>(60, 45)).norm() < 1e-12);
    CHECK((panel.box().low - Vec<2>(35, 20)).norm() < 1e-12);
    CHECK((panel.box().high - Vec<2>(85, 70)).norm() < 1e-12);
  }

  TEST_CASE("an empty panel is refused") {
    CHECK_THROWS_AS(Panel({{0, 0}, {0, 1}}, {{0, 0}, {1, 1}}), ContractError);
    CHECK_THROWS_AS(Panel({{0, 0}, {1, 1}}, {{0, 0}, {1, -1}}), ContractError);
  }

  TEST_CASE("dashes keep their length around corners") {
    const Polyline line{{{0, 0}, {4, 0}, {4, 4}}, {{}, 1}, {3, 2}};

    const auto pieces = dashed(line);

    REQUIRE(pieces.size() == 2);
    CHECK(pieces[0] == std::vector<Vec<2>>{{0, 0}, {3, 0}});
    REQUIRE(pieces[1].size() == 2);
    CHECK(pieces[1][0] == Vec<2>(4, 1));
    CHECK(pieces[1][1] == Vec<2>(4, 4));
  }

  TEST_CASE("a dash that turns a corner stays one piece") {
    const auto pieces = dashed({{{0, 0}, {2, 0}, {2, 2}}, {{}, 1}, {3, 10}});

    REQUIRE(pieces.size() == 1);
    CHECK(pieces[0] == std::vector<Vec<2>>{{0, 0}, {2, 0}, {2, 1}});
  }

  TEST_CASE("no dashes is one piece, no points is none") {
    CHECK(dashed({{{0, 0}, {1, 1}}, {{}, 1}, {}}).size() == 1);
    CHECK(dashed({{}, {{}, 1}, {}}).empty());
  }

  TEST_CASE("dashes that never end are refused") {
    CHECK_THROWS_AS(dashed({{{0, 0}, {1, 1}}, {{}, 1}, {0, 0}}), ContractError);
    CHECK_THROWS_AS(dashed({{{0, 0}, {1, 1}}, {{}, 1}, {2, -1}}), ContractError);
  }
}
