// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/numbers.hpp>
#include <lagrain/placement.hpp>

#include "support/scene_text.hpp"
#include "support/space.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

std::string message_of(const std::string& text) {
  return scene_error_of([&] { place_grains(parse_scene<2>(text, "s.toml")); });
}

template <int Dim>
Scene<Dim> box(Arrangement arrangement, int count) {
  Scene<Dim> scene;
  scene.materials = {{"rock", 1000}};
  Fill<Dim> fill;
  fill.count = count;
  fill.radius = UniformRadius{0.02, 0.05};
  fill.region.low.setZero();
  fill.region.high.setOnes();
  fill.arrangement = arrangement;
  scene.fills = {fill};
  PlacedGrain<Dim> big;
  big.position.setConstant(0.5);
  big.radius = 0.2;
  scene.grains = {big};
  return scene;
}

/// The smallest gap of any two grains, and of any grain to the sides of [0, 1]^Dim [m].
template <int Dim>
double smallest_gap(const std::vector<Grain<Dim>>& grains) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const auto& a = grains[i];
    smallest = std::min(smallest, a.position.minCoeff() - a.radius);
    smallest = std::min(smallest, 1 - a.position.maxCoeff() - a.radius);
    for (std::size_t j = 0; j < i; ++j) {
      const auto& b = grains[j];
      smallest = std::min(smallest, (a.position - b.position).norm() - (a.radius + b.radius));
    }
  }
  return smallest;
}

template <int Dim>
void check_disjoint_and_inside(const Scene<Dim>& scene) {
  const auto placed = place_grains(scene);

  REQUIRE(static_cast<int>(placed.grains.size()) == *scene.fills.front().count + 1);
  CHECK(smallest_gap(placed.grains) >= 0);
}

/// Grains in the unit square or cube, each pair a count and a radius [m] of one fill.
template <int Dim>
Scene<Dim> crowd(const std::vector<std::pair<int, double>>& groups) {
  Scene<Dim> scene;
  scene.materials = {{"rock", 1000}};
  for (const auto& [count, radius] : groups) {
    Fill<Dim> fill;
    fill.name = "r = " + shortest(radius);
    fill.count = count;
    fill.radius = radius;
    fill.region.high.setOnes();
    fill.arrangement = Arrangement::random;
    scene.fills.push_back(fill);
  }
  return scene;
}

template <int Dim>
std::string refusal_of(const Scene<Dim>& scene) {
  return scene_error_of([&] { place_grains(scene); });
}

/// Radii of many grains that follow a law [m].
template <int Dim>
std::vector<double> many_radii(const RadiusLaw& law) {
  Scene<Dim> scene;
  scene.materials = {{"rock", 1000}};
  Fill<Dim> fill;
  fill.count = 40'000;
  fill.radius = law;
  fill.region.high.setConstant(Dim == 2 ? 2.0 : 0.4);  // room for as many of 4 mm
  scene.fills = {fill};
  std::vector<double> radii;
  for (const auto& grain : place_grains(scene).grains) radii.push_back(grain.radius);
  return radii;
}

/// The share of the grains with radii in [low, high).
double share_between(const std::vector<double>& radii, double low, double high) {
  return static_cast<double>(std::count_if(radii.begin(), radii.end(),
                                           [&](double r) { return r >= low && r < high; })) /
         static_cast<double>(radii.size());
}

/// Whether a share of many draws agrees with its probability, to four standard deviations.
bool agrees(double share, double probability, std::size_t draws) {
  return std::abs(share - probability) <=
         4 * std::sqrt(probability * (1 - probability) / static_cast<double>(draws));
}

}  // namespace

TEST_SUITE("placement") {
  TEST_CASE_TEMPLATE("sizes shared by mass: so many small grains that the masses are as asked", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const std::vector<double> sizes{0.001, 0.002, 0.004};
    const std::vector<double> masses{1, 1, 2};

    const auto by_number = many_radii<Dim>(ListedRadius{sizes, masses, Share::number});
    const auto by_mass = many_radii<Dim>(ListedRadius{sizes, masses, Share::mass});

    // Numbers go with mass / radius^Dim: 16 : 4 : 2 in the plane, 64 : 8 : 2 in space.
    const std::vector<double> expected = Dim == 2
                                             ? std::vector<double>{16.0 / 22, 4.0 / 22, 2.0 / 22}
                                             : std::vector<double>{64.0 / 74, 8.0 / 74, 2.0 / 74};
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      CAPTURE(sizes[k]);
      const double next = sizes[k] * 1.1;
      CHECK(agrees(share_between(by_number, sizes[k], next), masses[k] / 4, by_number.size()));
      CHECK(agrees(share_between(by_mass, sizes[k], next), expected[k], by_mass.size()));
    }
  }

  TEST_CASE_TEMPLATE("sizes uniform in mass: the mass below a radius grows evenly with it", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const double low = 0.001;
    const double high = 0.004;
    const auto radii = many_radii<Dim>(UniformRadius{low, high, Share::mass});
    // The number of grains between a and b goes with the integral of dr / r^Dim.
    const auto number = [](double a, double b) {
      return Dim == 2 ? 1 / a - 1 / b : 0.5 * (1 / (a * a) - 1 / (b * b));
    };
    CHECK(*std::min_element(radii.begin(), radii.end()) >= low);
    CHECK(*std::max_element(radii.begin(), radii.end()) <= high);
    for (const double r : {0.0012, 0.002, 0.003}) {
      CAPTURE(r);
      CHECK(agrees(share_between(radii, low, r), number(low, r) / number(low, high), radii.size()));
    }
    double whole = 0;
    double below = 0;
    for (const double r : radii) {
      whole += std::pow(r, Dim);
      if (r < 0.5 * (low + high)) below += std::pow(r, Dim);
    }
    CHECK(relative_error(below / whole, 0.5) < 0.03);
  }

  TEST_CASE_TEMPLATE("a sieve curve is what sieves would find", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const SieveCurve curve{{0.002, 0.003, 0.006, 0.008}, {0, 0.25, 0.25, 1}};
    const auto radii = many_radii<Dim>(curve);

    // Means of 1 / radius^Dim in units of mm: 1 / (a b) or (a + b) / (2 a^2 b^2).
    const double fine = 0.25 * (Dim == 2 ? 1 / 1.5 : 2.5 / (2 * 2.25));
    const double coarse = 0.75 * (Dim == 2 ? 1 / 12.0 : 7 / (2 * 144.0));
    CHECK(agrees(share_between(radii, 0.001, 0.0015), fine / (fine + coarse), radii.size()));
    CHECK(share_between(radii, 0.0015, 0.003) == 0);
    double whole = 0;
    double through = 0;
    for (const double r : radii) {
      whole += std::pow(r, Dim);
      if (2 * r < curve.openings[1]) through += std::pow(r, Dim);
    }
    CHECK(relative_error(through / whole, 0.25) < 0.03);
  }

  TEST_CASE("lattices and random arrangements are disjoint, inside, and leave room for others") {
    check_disjoint_and_inside(box<2>(Arrangement::lattice, 60));
    check_disjoint_and_inside(box<2>(Arrangement::random, 80));
    check_disjoint_and_inside(box<3>(Arrangement::lattice, 400));
    check_disjoint_and_inside(box<3>(Arrangement::random, 400));
  }

  TEST_CASE_TEMPLATE("a lattice fills from the bottom up, and without a count fills its region", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto scene = box<Dim>(Arrangement::lattice, Dim == 2 ? 18 : 162);
    scene.grains.clear();

    const auto some = place_grains(scene);
    scene.fills.front().count.reset();
    const auto all = place_grains(scene);

    for (const auto& grain : some.grains) CHECK(grain.position[Dim - 1] < 0.21);
    CHECK(all.grains.size() == (Dim == 2 ? 81 : 729));
    CHECK(all.grains.front().position == some.grains.front().position);
  }

  TEST_CASE_TEMPLATE("same seed, same grains; another seed, others; groups do not disturb others",
                     S, Space<2>, Space<3>) {
    auto scene = box<S::Dim>(Arrangement::random, 30);
    const auto once = place_grains(scene);

    CHECK(place_grains(scene).grains[7].position == once.grains[7].position);
    auto longer = scene;
    longer.fills.push_back(scene.fills.front());
    longer.fills.back().count = 2;
    CHECK(place_grains(longer).grains[7].position == once.grains[7].position);
    scene.seed = 2;
    CHECK(place_grains(scene).grains[7].position != once.grains[7].position);
  }

  TEST_CASE_TEMPLATE("mass is density times volume, and random velocities have the speed asked", S,
                     Space<2>, Space<3>) {
    auto scene = box<S::Dim>(Arrangement::lattice, 4);
    scene.depth = 0.1;
    scene.fills.front().random_speed = 3;

    const auto placed = place_grains(scene);

    const double volume = std::numbers::pi * (S::Dim == 2 ? 0.04 * 0.1 : 4.0 / 3 * 0.008);
    CHECK(relative_error(placed.grains[0].mass, 1000 * volume) < 1e-15);
    CHECK(relative_error(placed.grains[2].velocity.norm(), 3) < 1e-15);
    CHECK(placed.group[0] == -1);
    CHECK(placed.group[1] == 0);
  }

  TEST_CASE("grains have the material that the scene names") {
    const Scene<2> scene = parse_scene<2>(kHeap, "s.toml");
    const auto placed = place_grains(scene);
    CHECK(placed.grains.front().material == 0);
    CHECK(placed.grains.back().material == 1);
  }

  TEST_CASE("a region too small for a lattice says how many grains it held") {
    CHECK(message_of(with(kHeap, "count = 12", "count = 1000")) ==
          "s.toml:18: fill[0]: \"fill 1\": its region held 36 of the 1000 grains asked for");
    const std::string wide = with(kHeap, "[\"8 mm\", \"10 mm\"]", "[0.06, 0.06]");
    const std::string no_fit = "s.toml:18: fill[0]: \"fill 1\": no grain fits into its region";
    CHECK(message_of(wide) == no_fit);
    CHECK(message_of(with(wide, "count = 12", "count = 1\narrangement = \"random\"")) == no_fit);
  }

  TEST_CASE_TEMPLATE("grains at random that find no place are pushed apart to no overlap at all", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    using Groups = std::vector<std::pair<int, double>>;
    // Solid fractions of 0.78, 0.75 and of 0.40, 0.40, 0.23, 0.50, 0.46.
    for (const Groups& groups : Dim == 2
                                    ? std::vector<Groups>{{{620, 0.02}}, {{60, 0.05}, {400, 0.015}}}
                                    : std::vector<Groups>{{{1484, 0.04}},
                                                          {{3498, 0.03}},
                                                          {{6944, 0.02}},
                                                          {{207, 0.08}, {227, 0.04}},
                                                          {{1484, 0.04}, {1747, 0.02}}}) {
      CAPTURE(groups.front().first);
      const auto scene = crowd<Dim>(groups);

      const auto placed = place_grains(scene);

      CHECK(smallest_gap(placed.grains) >= 0);
      // Groups stay apart in the list, in order and complete.
      std::size_t i = 0;
      for (std::size_t k = 0; k < groups.size(); ++k) {
        for (int c = 0; c < groups[k].first; ++c, ++i) {
          REQUIRE(placed.group[i] == static_cast<int>(k));
          REQUIRE(placed.grains[i].radius == groups[k].second);
        }
      }
      CHECK(placed.grains.size() == i);
    }
  }

  TEST_CASE_TEMPLATE("pushing is repeatable, and moves neither walls nor grains of elsewhere", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto scene = crowd<Dim>({{Dim == 2 ? 500 : 1000, Dim == 2 ? 0.02 : 0.04}});
    PlacedGrain<Dim> by_hand;
    by_hand.position.setConstant(0.4);
    by_hand.radius = 0.15;
    scene.grains = {by_hand};
    scene.walls = {
        Wall<Dim>::half_space("ramp", Vec<Dim>::Zero(), Vec<Dim>::UnitX() + Vec<Dim>::UnitY())};

    const auto once = place_grains(scene);
    const auto again = place_grains(scene);

    CHECK(smallest_gap(once.grains) >= 0);
    CHECK(once.grains[0].position == by_hand.position);
    CHECK(!once.grains[0].pinned);
    bool same = true;
    double nearest = 1;
    for (std::size_t i = 0; i < once.grains.size(); ++i) {
      same = same && once.grains[i].position == again.grains[i].position;
      const auto& grain = once.grains[i];
      nearest = std::min(nearest, scene.walls[0].foot(grain.position).distance - grain.radius);
    }
    CHECK(same);
    CHECK(nearest >= 0);
  }

  TEST_CASE_TEMPLATE("grains find walls where the run begins, whatever these do later", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const auto piece = [](double x, double z) {
      if constexpr (Dim == 2) {
        return Wall<2>::segment("piece", {x, z}, {x + 0.3, z + 0.1});
      } else {
        return Wall<3>::plate(
            "piece", {{x, 0.2, z}, {x + 0.3, 0.2, z + 0.1}, {x + 0.3, 0.8, z + 0.1}, {x, 0.8, z}});
      }
    };
    Wall<Dim> paddle = piece(0.1, 0.4), flap = paddle, gate = piece(0.6, 0.6);
    SpinVec<Dim> axis = SpinVec<Dim>::Zero();
    axis[kSpinDim<Dim> == 1 ? 0 : 1] = 1;
    paddle.turning = Turn<Dim>{axis, 0.1, Vec<Dim>::Constant(0.3)};
    flap.turning = Swing<Dim>{axis, 0.5, 0.05, Vec<Dim>::Constant(0.3)};
    gate.until = 1e-3;
    Wall<Dim> lift = piece(0.6, 0.1);
    lift.motion = Path<Dim>{{1, 2}, {0.2 * Vec<Dim>::UnitX(), Vec<Dim>::Zero()}};
    lift.point = lift.home = -0.2 * Vec<Dim>::UnitX() + lift.home;
    Wall<Dim> shaker = piece(0.6, 0.3);
    shaker.motion = Steady<Dim>{Vec<Dim>::UnitX()};

    for (Wall<Dim> wall : {paddle, flap, gate, lift, shaker}) {
      CAPTURE(wall.until);
      auto scene = crowd<Dim>({{Dim == 2 ? 520 : 850, Dim == 2 ? 0.02 : 0.05}});
      scene.walls = {wall};
      const auto placed = place_grains(scene);
      wall.advance(0, 0);
      double nearest = 1;
      for (const auto& grain : placed.grains) {
        nearest = std::min(nearest, wall.foot(grain.position).distance - grain.radius);
      }
      CHECK(nearest >= 0);
    }
  }

  TEST_CASE_TEMPLATE("a round container is filled at random up to its wall", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    auto scene = crowd<Dim>({{Dim == 2 ? 450 : 1050, Dim == 2 ? 0.02 : 0.04}});
    Vec<Dim> axis = Vec<Dim>::Zero();
    if (Dim == 3) axis[2] = 1;
    scene.walls = {Wall<Dim>::cylinder("drum", Vec<Dim>::Constant(0.5), axis, 0.5)};

    const auto placed = place_grains(scene);

    CHECK(smallest_gap(placed.grains) >= 0);
    double nearest = 1;
    for (const auto& grain : placed.grains) {
      nearest = std::min(nearest, scene.walls[0].foot(grain.position).distance - grain.radius);
    }
    CHECK(nearest >= 0);
  }

  TEST_CASE_TEMPLATE("a wall may take most of a region from the grains", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto scene = crowd<Dim>({{Dim == 2 ? 84 : 1900, 0.02}});
    scene.walls = {Wall<Dim>::half_space("cliff", 0.85 * Vec<Dim>::UnitX(), Vec<Dim>::UnitX())};

    const auto placed = place_grains(scene);

    CHECK(smallest_gap(placed.grains) >= 0);
    double nearest = 1;
    for (const auto& grain : placed.grains) {
      nearest = std::min(nearest, grain.position[0] - 0.85 - grain.radius);
    }
    CHECK(nearest >= 0);
  }

  TEST_CASE("more grains than a region can hold are refused, with the fraction and the limit") {
    CHECK(refusal_of(crowd<3>({{2836, 0.04}})) ==
          "fill[0]: \"r = 0.04\": a solid fraction of 0.76 in its region; equal spheres reach at "
          "most 0.74");
    CHECK(refusal_of(crowd<2>({{725, 0.02}})) ==
          "fill[0]: \"r = 0.02\": a solid fraction of 0.911 in its region; equal discs reach at "
          "most 0.907");
    // The second fill of a region counts the first one in.
    CHECK(refusal_of(crowd<2>({{250, 0.03}, {250, 0.02}})) ==
          "fill[1]: \"r = 0.02\": a solid fraction of 1.021 in its region; discs reach at most 1");
    const std::string jam = refusal_of(crowd<3>({{327, 0.08}}));
    CHECK(jam.find("fill[0]: \"r = 0.08\": a solid fraction of 0.701 in its region; after 3000 "
                   "pushes grains still overlap by ") == 0);
    CHECK(jam.find("equal spheres at random reach about 0.64)") != std::string::npos);
  }

  TEST_CASE("grains that overlap at the start are named, with the overlap") {
    CHECK(message_of(with(kHeap, "[0.05, 0.4]", "[0.05, 0.33]")) ==
          "s.toml:28: grain[1]: overlaps grain[0] by 50 % of the smaller radius (limit 1 %); "
          "largest_initial_overlap allows more");
    CHECK(message_of("largest_initial_overlap = 0.6\n" +
                     with(kHeap, "[0.05, 0.4]", "[0.05, 0.33]")) == "accepted");
    CHECK(message_of(with(kHeap, "[0.05, 0.3]", "[0.01, 0.3]")) ==
          "s.toml:24: grain[0]: overlaps wall \"left\" by 50 % of the smaller radius (limit 1 %); "
          "largest_initial_overlap allows more");
    CHECK(message_of(with(kHeap, "[0.05, 0.3]", "[0.05, -0.3]")) ==
          "s.toml:24: grain[0]: lies behind wall \"floor\"");
  }

  TEST_CASE_TEMPLATE("a large grain finds its place among small ones, whichever comes first", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const auto& groups : {std::vector<std::pair<int, double>>{{10, 0.05}, {300, 0.0005}},
                               std::vector<std::pair<int, double>>{{300, 0.0005}, {10, 0.05}},
                               std::vector<std::pair<int, double>>{{20, 1e-9}, {10, 0.05}}}) {
      const auto placed = place_grains(crowd<Dim>(groups));
      CHECK(placed.grains.size() == static_cast<std::size_t>(groups[0].first + groups[1].first));
      CHECK(smallest_gap(placed.grains) >= 0);
    }
  }

  TEST_CASE("placing looks at few places, whatever the sizes") {
    // It took a minute when cells were as small as the smallest grain.
    const auto begin = std::chrono::steady_clock::now();
    place_grains(crowd<3>({{50, 0.05}, {50, 0.00005}}));
    place_grains(crowd<3>({{50, 0.00005}, {50, 0.05}}));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    CHECK(took.count() < 10);
  }

  TEST_CASE("whoever watches is told how many grains are placed, and can end it") {
    struct Enough {};
    std::int64_t last = 0;
    place_grains(crowd<2>({{30, 0.01}, {20, 0.02}}), [&](std::int64_t placed, std::int64_t asked) {
      CHECK(placed >= last);
      CHECK(asked == 50);
      last = placed;
    });
    CHECK(last == 50);
    CHECK_THROWS_AS(place_grains(crowd<2>({{30, 0.01}}),
                                 [](std::int64_t placed, std::int64_t) {
                                   if (placed == 7) throw Enough{};
                                 }),
                    Enough);
    // Pushing apart and trying in vain can be ended as well.
    int calls = 0;
    CHECK_THROWS_AS(place_grains(crowd<2>({{2000, 0.0115}}),
                                 [&](std::int64_t placed, std::int64_t) {
                                   calls += placed == 2000 ? 1 : 0;
                                   if (calls == 3) throw Enough{};
                                 }),
                    Enough);
  }
}
