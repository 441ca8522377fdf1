// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/laguerre3.hpp>

#include <lagrain/check.hpp>

#include <support/tolerance.hpp>
#include "dim3/sets3.hpp"
#include "support/cases.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace lagrain;

namespace {

Eigen::AlignedBox3d box_around(const test3::Sites& s) {
  const Vec<3> low = s.x.rowwise().minCoeff(), high = s.x.rowwise().maxCoeff();
  const Vec<3> margin = Vec<3>::Constant(0.1 * (high - low).norm());
  return {low - margin, high + margin};
}

}  // namespace

TEST_SUITE("laguerre3") {
  TEST_CASE("the cells of a box fill the box") {
    for (int seed = 0; seed < test::cases(2, 100); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test3::all_kinds(random)) {
        CAPTURE(seed);
        CAPTURE(s.name);
        const Eigen::AlignedBox3d box = box_around(s);
        const auto t = test::built(s);

        double sum = 0;
        for (int i = 0; i < s.size(); ++i) sum += polyhedron_volume(laguerre_cell(t, i, box));

        // Corners round to about 1e-16 of the coordinates, and each moves with it a face as wide
        // as a cell; 1e-12 unless the origin is far.
        const double rounding = 1e-12 * (1 + 0.01 * box.max().norm() / box.sizes().norm());
        CHECK(std::abs(sum - box.volume()) <= rounding * box.volume());
      }
    }
  }

  TEST_CASE("each face lies half-way in power to the site beyond, the rest of the cell nearer") {
    Random random(3);
    for (const auto& s : {test3::overlapping(random, 60), test3::polydisperse(random, 60, 100)}) {
      CAPTURE(s.name);
      const auto t = test::built(s);
      const Eigen::AlignedBox3d box = box_around(s);
      for (int i = 0; i < s.size(); ++i) {
        const auto cell = laguerre_cell(t, i, box);
        if (std::binary_search(t.hidden().begin(), t.hidden().end(), i)) CHECK(cell.empty());
        for (const LaguerreFace& face : cell) {
          for (Eigen::Index k = 0; k < face.corners.cols(); ++k) {
            const Vec<3> p = face.corners.col(k);
            const auto power = [&](int j) { return (p - s.x.col(j)).squaredNorm() - s.w[j]; };
            if (face.beyond >= 0) CHECK(std::abs(power(i) - power(face.beyond)) < 1e-10);
            double least = power(0);
            for (int j = 1; j < s.size(); ++j) least = std::min(least, power(j));
            CHECK(power(i) <= least + 1e-10);
            CHECK(box.exteriorDistance(p) < 1e-12);
          }
        }
      }
    }
  }

  TEST_CASE("grains that overlap little lie at their centres within their cells") {
    Random random(8);
    const auto s = test3::polydisperse(random, 200, 10);
    const auto t = test::built(s);
    const Eigen::AlignedBox3d box = box_around(s);
    REQUIRE(t.hidden().empty());

    for (int i = 0; i < s.size(); ++i) {
      const auto cell = laguerre_cell(t, i, box);
      for (const LaguerreFace& face : cell) {
        const Vec<3> a = face.corners.col(0), b = face.corners.col(1), c = face.corners.col(2);
        // Turned outwards.
        CHECK((b - a).cross(c - a).dot(s.x.col(i) - a) < 0);
      }
      const Vec<3> centroid = polyhedron_centroid(cell);
      double least = (centroid - s.x.col(0)).squaredNorm() - s.w[0];
      for (int j = 1; j < s.size(); ++j) {
        least = std::min(least, (centroid - s.x.col(j)).squaredNorm() - s.w[j]);
      }
      CHECK((centroid - s.x.col(i)).squaredNorm() - s.w[i] <= least + 1e-12);
    }
  }

  TEST_CASE("two cells share a face: the same corners, seen from both sides") {
    Random random(21);
    const auto s = test3::jittered(random, 4);
    const auto t = test::built(s);
    const Eigen::AlignedBox3d box = box_around(s);
    std::vector<std::vector<LaguerreFace>> cells;
    for (int i = 0; i < s.size(); ++i) cells.push_back(laguerre_cell(t, i, box));
    int shared = 0;

    for (int i = 0; i < s.size(); ++i) {
      for (const LaguerreFace& face : cells[static_cast<std::size_t>(i)]) {
        if (face.beyond < i) continue;
        const auto& beyond = cells[static_cast<std::size_t>(face.beyond)];
        const auto other = std::find_if(beyond.begin(), beyond.end(),
                                        [&](const LaguerreFace& f) { return f.beyond == i; });
        REQUIRE(other != beyond.end());
        REQUIRE(other->corners.cols() == face.corners.cols());
        for (Eigen::Index k = 0; k < face.corners.cols(); ++k) {
          const double nearest =
              (other->corners.colwise() - face.corners.col(k)).colwise().norm().minCoeff();
          CHECK(nearest < 1e-11);
        }
        ++shared;
      }
    }
    CHECK(shared > 300);
  }

  TEST_CASE("the cells of a cubic lattice are cubes, of an fcc lattice rhombic dodecahedra") {
    for (const double pitch : {1.0, 0.1 * std::sqrt(2.0), std::sqrt(3.0)}) {
      CAPTURE(pitch);
      const auto cubic = test3::cubic_lattice(3, pitch);
      const auto cube = laguerre_cell(test::built(cubic), 13, box_around(cubic));
      CHECK(cube.size() == 6);
      for (const LaguerreFace& face : cube) CHECK(face.corners.cols() == 4);
      CHECK(test::relative_error(polyhedron_volume(cube), std::pow(pitch, 3)) < 1e-12);
      CHECK((polyhedron_centroid(cube) - cubic.x.col(13)).norm() < 1e-13);

      const auto fcc = test3::fcc_lattice(5, pitch);
      const Vec<3> middle = 2 * pitch * Vec<3>::Ones();
      Eigen::Index at = 0;
      (fcc.x.colwise() - middle).colwise().norm().minCoeff(&at);
      const auto cell = laguerre_cell(test::built(fcc), static_cast<int>(at), box_around(fcc));
      CHECK(cell.size() == 12);
      for (const LaguerreFace& face : cell) CHECK(face.corners.cols() == 4);
      CHECK(test::relative_error(polyhedron_volume(cell), 2 * std::pow(pitch, 3)) < 1e-12);
    }
  }

  TEST_CASE("a side of the box that is also a face of the cell counts once") {
    const auto t = test::built(test3::make_sites("two", {{0, 0, 0, 1}, {1, 0, 0, 1}}));
    const Eigen::AlignedBox3d half(Vec<3>(-0.5, -1, -1), Vec<3>(0.5, 1, 1));

    CHECK(laguerre_cell(t, 0, half).size() == 6);
    CHECK(test::relative_error(polyhedron_volume(laguerre_cell(t, 0, half)), 4) < 1e-15);
    CHECK(polyhedron_volume(laguerre_cell(t, 1, half)) == 0);
  }

  TEST_CASE("one site has the whole box, and a cell outside the box is empty") {
    const auto one = test::built(test3::make_sites("one", {{0, 0, 0, 1}}));
    const auto two = test::built(test3::make_sites("two", {{0, 0, 0, 1}, {10, 0, 0, 1}}));
    const Eigen::AlignedBox3d box(Vec<3>(-1, -1, -1), Vec<3>(2, 1, 3));

    const auto whole = laguerre_cell(one, 0, box);
    CHECK(test::relative_error(polyhedron_volume(whole), 24) < 1e-15);
    CHECK((polyhedron_centroid(whole) - Vec<3>(0.5, 0, 1)).norm() < 1e-14);
    std::vector<int> sides;
    for (const LaguerreFace& face : whole) sides.push_back(face.beyond);
    std::sort(sides.begin(), sides.end());
    CHECK(sides == std::vector<int>{box_side(2, true), box_side(2, false), box_side(1, true),
                                    box_side(1, false), box_side(0, true), box_side(0, false)});
    CHECK(test::relative_error(polyhedron_volume(laguerre_cell(two, 0, box)), 24) < 1e-15);
    CHECK(laguerre_cell(two, 1, box).empty());
    CHECK(polyhedron_volume({}) == 0);
    CHECK_THROWS_AS(laguerre_cell(two, 2, box), ContractError);
    CHECK_THROWS_AS(laguerre_cell(two, 0, Eigen::AlignedBox3d()), ContractError);
    CHECK_THROWS_AS(polyhedron_centroid({}), ContractError);
  }
}
