#include <lagrain/placement.hpp>

#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

std::string message_of(const std::string& text) {
  try {
    place_grains(parse_scene<2>(text, "s.toml"));
  } catch (const SceneError& error) {
    return error.what();
  }
  return "accepted";
}

template <int Dim>
Scene<Dim> box(Arrangement arrangement, int count) {
  Scene<Dim> scene;
  scene.materials = {{"rock", 1000}};
  Fill<Dim> fill;
  fill.count = count;
  fill.radius = UniformRadius{0.02, 0.05};
  fill.low.setZero();
  fill.high.setOnes();
  fill.arrangement = arrangement;
  scene.fills = {fill};
  PlacedGrain<Dim> big;
  big.position.setConstant(0.5);
  big.radius = 0.2;
  scene.grains = {big};
  return scene;
}

template <int Dim>
void check_disjoint_and_inside(const Scene<Dim>& scene) {
  const auto placed = place_grains(scene);
  const int n = static_cast<int>(placed.grains.size());
  REQUIRE(n == *scene.fills.front().count + 1);
  for (int i = 0; i < n; ++i) {
    const auto& a = placed.grains[static_cast<std::size_t>(i)];
    CHECK((a.position.array() >= a.radius).all());
    CHECK((a.position.array() <= 1 - a.radius).all());
    for (int j = 0; j < i; ++j) {
      const auto& b = placed.grains[static_cast<std::size_t>(j)];
      if ((a.position - b.position).norm() < a.radius + b.radius) FAIL("overlap");
    }
  }
}

}  // namespace

TEST_SUITE("placement") {
  TEST_CASE("lattices and random arrangements are disjoint, inside, and leave room for others") {
    check_disjoint_and_inside(box<2>(Arrangement::lattice, 60));
    check_disjoint_and_inside(box<2>(Arrangement::random, 80));
    check_disjoint_and_inside(box<3>(Arrangement::lattice, 400));
    check_disjoint_and_inside(box<3>(Arrangement::random, 400));
  }

  TEST_CASE("a lattice fills from the bottom up, and without a count fills its region") {
    Scene<2> scene = box<2>(Arrangement::lattice, 18);
    scene.grains.clear();

    const auto some = place_grains(scene);
    scene.fills.front().count.reset();
    const auto all = place_grains(scene);

    for (const auto& grain : some.grains) CHECK(grain.position.y() < 0.21);
    CHECK(all.grains.size() == 81);
    CHECK(all.grains.front().position == some.grains.front().position);
  }

  TEST_CASE("same seed, same grains; another seed, others; groups do not disturb each other") {
    Scene<2> scene = box<2>(Arrangement::random, 30);
    const auto once = place_grains(scene);

    CHECK(place_grains(scene).grains[7].position == once.grains[7].position);
    Scene<2> longer = scene;
    longer.fills.push_back(scene.fills.front());
    longer.fills.back().count = 2;
    CHECK(place_grains(longer).grains[7].position == once.grains[7].position);
    scene.seed = 2;
    CHECK(place_grains(scene).grains[7].position != once.grains[7].position);
  }

  TEST_CASE("mass is density times area times depth, and random velocities have the speed asked") {
    Scene<2> scene = box<2>(Arrangement::lattice, 4);
    scene.depth = 0.1;
    scene.fills.front().random_speed = 3;

    const auto placed = place_grains(scene);

    CHECK(placed.grains[0].mass == doctest::Approx(1000 * 3.14159265 * 0.04 * 0.1));
    CHECK(placed.grains[2].velocity.norm() == doctest::Approx(3));
    CHECK(placed.group[0] == -1);
    CHECK(placed.group[1] == 0);
  }

  TEST_CASE("materials with one law for all are one kind; pairs of materials make several") {
    Scene<2> scene = parse_scene<2>(kHeap, "s.toml");
    CHECK(place_grains(scene).grains.back().kind == 0);

    scene = parse_scene<2>(kHeap + "[[pair]]\nbetween = [\"rock\", \"gravel\"]\nfriction = 0.1\n",
                           "s.toml");

    CHECK(place_grains(scene).grains.front().kind == 0);
    CHECK(place_grains(scene).grains.back().kind == 1);
  }

  TEST_CASE("a region too small says how many grains it held") {
    CHECK(message_of(with(kHeap, "count = 12", "count = 1000")) ==
          "s.toml:18: fill[0]: \"fill 1\": its region held 36 of the 1000 grains asked for");
    const std::string crowd =
        message_of(with(kHeap, "count = 12", "count = 1000\narrangement = \"random\""));
    CHECK(crowd.substr(0, 46) == "s.toml:18: fill[0]: \"fill 1\": its region held ");
    CHECK(message_of(with(kHeap, "[\"8 mm\", \"10 mm\"]", "[1, 2]")) ==
          "s.toml:18: fill[0]: \"fill 1\": no grain fits into its region");
  }

  TEST_CASE("grains that overlap at the start are named, with the overlap") {
    CHECK(message_of(with(kHeap, "[0.05, 0.4]", "[0.05, 0.33]")) ==
          "s.toml:28: grain[1]: overlaps grain[0] by 50 % of the smaller radius (limit 1 %)");
    CHECK(message_of("largest_initial_overlap = 0.6\n" +
                     with(kHeap, "[0.05, 0.4]", "[0.05, 0.33]")) == "accepted");
    CHECK(message_of(with(kHeap, "[0.05, 0.3]", "[0.01, 0.3]")) ==
          "s.toml:24: grain[0]: overlaps wall \"left\" by 50 % of the smaller radius (limit 1 %)");
    CHECK(message_of(with(kHeap, "[0.05, 0.3]", "[0.05, -0.3]")) ==
          "s.toml:24: grain[0]: lies behind wall \"floor\"");
  }
}
