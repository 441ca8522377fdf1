// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/neighbourhood.hpp>

#include <lagrain/all_pairs.hpp>
#include <lagrain/cell_grid.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>

#include <doctest/doctest.h>

using namespace lagrain;
using namespace lagrain::test;

TEST_SUITE("neighbourhood") {
  TEST_CASE("within reach means a gap of at most both margins") {
    Columns<2> x(2, 2);
    x << 0, 3, 0, 4;
    const Eigen::VectorXd radius = Eigen::Vector2d(1, 3);

    CHECK(within_reach<2>(x, radius, Eigen::Vector2d(0.5, 0.5), 0, 1));
    CHECK_FALSE(within_reach<2>(x, radius, Eigen::Vector2d(0.5, 0.499), 0, 1));
  }

  TEST_CASE_TEMPLATE("linked cells propose the pairs of brute force", N, CellGrid<2>, CellGrid<3>) {
    constexpr int Dim = std::is_same_v<N, CellGrid<2>> ? 2 : 3;
    for (const CloudKind kind : kClouds) {
      for (int seed = 0; seed < cases(5, 200); ++seed) {
        for (const int count : {2, 3, 10, 150}) {
          check_lists<Dim, N>(kind, static_cast<std::uint64_t>(seed), count, 5);
        }
      }
    }
  }

  TEST_CASE("a grain that flew away costs no empty cells") {
    Columns<3> x = Columns<3>::Zero(3, 3);
    x.col(1) = Vec<3>(1.5, 0, 0);
    x.col(2) = Vec<3>(1e12, -1e12, 1e9);
    const Eigen::VectorXd radius = Eigen::Vector3d(1, 1, 1);
    Eigen::VectorXd margin = Eigen::Vector3d::Zero();
    std::vector<Pair> pairs;

    CellGrid<3>{}.near_pairs(x, radius, margin, pairs);

    CHECK(pairs == std::vector<Pair>{{0, 1}});
  }

  TEST_CASE_TEMPLATE("linked cells and brute force move grains alike, bit for bit", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, Case<2, FrictionalHertz>,
                     Case<3, ViscousHertz>) {
    constexpr int Dim = C::Dim;
    const int count = Dim == 2 ? 25 : 27;
    check_trajectory<Dim, typename C::Law, CellGrid<Dim>>(settling_bed<Dim>(count, 1),
                                                          cases(10000, 100000));
    check_trajectory<Dim, typename C::Law, CellGrid<Dim>>(stirring<Dim>(count, 2),
                                                          cases(3000, 100000));
    check_trajectory<Dim, typename C::Law, CellGrid<Dim>>(drifting<Dim>(count, 3),
                                                          cases(3000, 100000));
  }
}
