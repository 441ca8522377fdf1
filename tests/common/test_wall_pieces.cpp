// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/wall_pieces.hpp>

#include <lagrain/check.hpp>
#include <lagrain/random.hpp>

#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
Vec<Dim> random_place(Random& random, double reach) {
  Vec<Dim> x;
  for (double& c : x) c = random.uniform(-reach, reach);
  return x;
}

/// Places along an arc, its ends among them.
std::vector<Vec<2>> samples(const Arc& arc, int count) {
  const Vec<2> from = arc.from() - arc.centre(), to = arc.to() - arc.centre();
  const Vec<2> through = arc.through() - arc.centre();
  const auto angle_of = [&](const Vec<2>& arm) {
    const double angle = std::atan2(from[0] * arm[1] - from[1] * arm[0], from.dot(arm));
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
  };
  // Counter-clockwise if the middle point comes before the end that way round.
  const bool left = angle_of(through) < angle_of(to);
  const double sweep = left ? angle_of(to) : angle_of(to) - 2 * std::numbers::pi;
  std::vector<Vec<2>> list;
  for (int k = 0; k <= count; ++k) {
    list.push_back(arc.centre() + Eigen::Rotation2Dd(sweep * k / count) * from);
  }
  return list;
}

/// Places on a frustum, its rims among them.
std::vector<Vec<3>> samples(const Frustum& f, int count) {
  const Vec<3> u = f.axis.unitOrthogonal(), v = f.axis.cross(u);
  std::vector<Vec<3>> list;
  for (int k = 0; k <= count; ++k) {
    const double t = static_cast<double>(k) / count;
    const double radius = f.low_radius + t * (f.high_radius - f.low_radius);
    for (int j = 0; j < 4 * count; ++j) {
      const double angle = 2 * std::numbers::pi * j / (4 * count);
      list.push_back(f.base + t * f.height * f.axis +
                     radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  return list;
}

template <int Dim>
double distance_to(const std::vector<Vec<Dim>>& places, const Vec<Dim>& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec<Dim>& p : places) least = std::min(least, (p - x).norm());
  return least;
}

/// The nearest point of a piece is on it, and nothing of it is nearer.
template <int Dim, class Piece>
void compare(const Piece& piece, int count, double spacing, Random& random) {
  const auto places = samples(piece, count);
  const auto box = piece.box();
  for (const Vec<Dim>& p : places) CHECK(box.exteriorDistance(p) < 1e-12);
  for (int k = 0; k < 300; ++k) {
    const Vec<Dim> x = random_place<Dim>(random, 3);
    const Vec<Dim> nearest = piece.nearest(x);
    CHECK(distance_to<Dim>(places, nearest) < spacing);
    CHECK((nearest - x).norm() < distance_to<Dim>(places, x) + 1e-12);
    if (piece.feature(nearest, 1e-9) == Feature::face) {
      const Vec<Dim> way = (x - nearest).normalized();
      CHECK(std::abs(std::abs(way.dot(piece.normal_at(nearest))) - 1) < 1e-9);
    }
  }
}

}  // namespace

TEST_SUITE("pieces of walls") {
  TEST_CASE("an arc is met at its nearest point, from both sides and around its ends") {
    Random random(1);
    int greater_than_half = 0;
    for (int k = 0; k < 80; ++k) {
      const Vec<2> from = random_place<2>(random, 1), through = random_place<2>(random, 1),
                   to = random_place<2>(random, 1);
      if (!Arc::defect(from, through, to).empty()) continue;
      const Arc arc(from, through, to);
      if (arc.radius() > 3) continue;
      CHECK(relative_error((arc.to() - arc.centre()).norm(), arc.radius()) < 1e-9);
      CHECK(relative_error((arc.through() - arc.centre()).norm(), arc.radius()) < 1e-9);
      CHECK((arc.nearest(through) - through).norm() < 1e-9);
      greater_than_half += (to - from).dot(through - from) < 0;
      compare<2>(arc, 4000, 2 * std::numbers::pi * arc.radius() / 4000, random);
      CHECK(arc.feature(from, 1e-9) == Feature::corner);
      CHECK(arc.feature(to, 1e-9) == Feature::corner);
      CHECK(arc.feature(through, 1e-9) == Feature::face);
    }
    CHECK(greater_than_half > 3);
  }

  TEST_CASE(
      "a frustum, a cone, a short cylinder, a ring and a disc are met at their nearest point") {
    Random random(2);
    const Vec<3> base(0.1, -0.2, 0.3), axis = Vec<3>(2, 3, 6) / 7;
    for (const Frustum& frustum :
         {Frustum{base, axis, 1.5, 0.5, 1.2}, Frustum{base, axis, 1.5, 0, 1.2},
          Frustum{base, axis, 2, 0.8, 0.8}, Frustum{base, axis, 0, 0.4, 1.3},
          Frustum{base, axis, 0, 0, 1.3}, Frustum{base, axis, 1, 1.2, 0}}) {
      CAPTURE(frustum.height);
      CAPTURE(frustum.low_radius);
      CAPTURE(frustum.high_radius);
      REQUIRE(frustum.defect().empty());
      compare<3>(frustum, 60, 0.1, random);
    }
  }

  TEST_CASE("rims are edges, a tip is a corner, the middle of a disc is a face") {
    const Frustum cone{Vec<3>::Zero(), Vec<3>::UnitZ(), 1, 0, 1};
    CHECK(cone.feature({0, 0, 0}, 1e-9) == Feature::corner);
    CHECK(cone.feature({0, 1, 1}, 1e-9) == Feature::edge);
    CHECK(cone.feature({0, 0.5, 0.5}, 1e-9) == Feature::face);
    const Frustum disc{Vec<3>::Zero(), Vec<3>::UnitZ(), 0, 0, 1};
    CHECK(disc.feature({0, 0, 0}, 1e-9) == Feature::face);
    CHECK(disc.feature({0, 1, 0}, 1e-9) == Feature::edge);
    // On the axis all directions are alike: one is chosen.
    CHECK(relative_error((cone.nearest({0, 0, 1}) - Vec<3>(0, 0, 1)).norm(), std::sqrt(0.5)) <
          1e-12);
  }

  TEST_CASE("an arc is as large as it is long, however wide its circle") {
    const Arc arc({-0.005, 0}, {0, 1e-6}, {0.005, 0});
    CHECK(arc.radius() > 10);
    CHECK(relative_error(arc.size(), 0.01) < 1e-6);
  }

  TEST_CASE("what makes no piece is said") {
    CHECK(Arc::defect({0, 0}, {1, 0}, {2, 0}) == "the points of an arc lie on a line");
    CHECK(Arc::defect({0, 0}, {1, 0}, {0, 0}) == "two of the points of an arc are one");
    CHECK_THROWS_AS(Arc({0, 0}, {1, 0}, {2, 0}), ContractError);
    const auto defect = [](double height, double low, double high) {
      return Frustum{Vec<3>::Zero(), Vec<3>::UnitX(), height, low, high}.defect();
    };
    CHECK(defect(0, 1, 1) == "a ring needs two radii that differ");
    CHECK(defect(-1, 1, 1) == "height and radii are not negative");
    CHECK(!defect(1, 0, 0).empty());
    CHECK(defect(0, 0, 1e200) == "it is too large for its size to be squared");
    CHECK(Frustum{Vec<3>::Zero(), Vec<3>::Zero(), 1, 1, 1}.defect() == "the axis has no direction");
    CHECK_THROWS_AS(Sheet<2>({}), ContractError);
  }

  TEST_CASE_TEMPLATE("a sheet finds the pieces that are near, few or many", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(3);
    for (const int count : {1, 5, 8, 9, 40, 700}) {
      CAPTURE(count);
      std::vector<WallPiece<Dim>> pieces;
      while (static_cast<int>(pieces.size()) < count) {
        const Vec<Dim> at = random_place<Dim>(random, 3);
        if constexpr (Dim == 2) {
          const Vec<2> b = random_place<2>(random, 0.4), c = random_place<2>(random, 0.4);
          if (random.uniform() < 0.5 && Arc::defect(at, at + b, at + c).empty()) {
            pieces.push_back(Arc(at, at + b, at + c));
          } else {
            pieces.push_back(WallSegment(at, at + b));
          }
        } else {
          const std::vector<Vec<3>> corners{at, at + random_place<3>(random, 0.4),
                                            at + random_place<3>(random, 0.4)};
          if (random.uniform() < 0.3) {
            pieces.push_back(Frustum{at, random_place<3>(random, 1).normalized(),
                                     random.uniform(0, 0.4), random.uniform(0, 0.3), 0.35});
          } else if (Plate::defect(corners).empty()) {
            pieces.push_back(Plate(corners));
          }
        }
      }
      const Sheet<Dim> sheet(pieces);
      const auto distance = [&](std::size_t k, const Vec<Dim>& x) {
        return std::visit([&](const auto& p) { return (p.nearest(x) - x).norm(); }, pieces[k]);
      };
      for (int trial = 0; trial < 50; ++trial) {
        const Vec<Dim> x = random_place<Dim>(random, 4);
        const double reach = random.uniform(0, 1);
        std::vector<int> found;
        sheet.near(x, reach, found);
        CHECK(std::is_sorted(found.begin(), found.end()));
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < pieces.size(); ++k) {
          least = std::min(least, distance(k, x));
          if (distance(k, x) > reach) continue;
          CHECK(std::binary_search(found.begin(), found.end(), static_cast<int>(k)));
        }
        CHECK(distance(static_cast<std::size_t>(sheet.nearest_piece(x)), x) == least);
      }
      for (const WallPiece<Dim>& piece : pieces) {
        for (const Vec<Dim>& corner :
             std::visit([](const auto& p) { return p.corners(); }, piece)) {
          CHECK(corner.norm() <= sheet.extent() * (1 + 1e-12));
        }
      }
    }
  }
}
