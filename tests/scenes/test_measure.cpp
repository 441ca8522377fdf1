// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Stress and solid fraction of regions, in the series.

#include <lagrain/frame.hpp>
#include <lagrain/run.hpp>

#include "support/scene_text.hpp"
#include "support/space.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr double kPi = std::numbers::pi;

template <int Dim>
Scene<Dim> empty_scene() {
  Scene<Dim> scene;
  scene.duration = 1;
  scene.depth = 0.5;
  scene.law.stiffness = 1e6;
  scene.materials = {{"rock", 2500}};
  scene.largest_initial_overlap = 0.1;
  return scene;
}

template <int Dim>
void add_grain(Scene<Dim>& scene, const Vec<Dim>& at, double radius) {
  PlacedGrain<Dim> grain;
  grain.position = at;
  grain.radius = radius;
  scene.grains.push_back(grain);
}

template <int Dim>
void measure(Scene<Dim>& scene, const std::string& name, const Vec<Dim>& low, const Vec<Dim>& high,
             int slices = 1, int axis = Dim - 1) {
  scene.measures.push_back({name, {low, high}, slices, axis});
}

/// The first row of a scene's series, by the names of its columns.
template <int Dim>
std::map<std::string, double> first_row(const Scene<Dim>& scene) {
  const auto run = make_run(scene);
  const auto columns = series_columns(*run);
  const Sample sample = sample_of(*run, run->ledger(), run->statistics());
  REQUIRE(columns.size() == sample.size());
  std::map<std::string, double> row;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    std::visit([&](auto value) { row[columns[k].name] = static_cast<double>(value); }, sample[k]);
  }
  return row;
}

/// The solid fraction of a region of [0, 1]^Dim in which a grain lies.
template <int Dim>
double solid_of(const Vec<Dim>& at, double radius) {
  Scene<Dim> scene = empty_scene<Dim>();
  add_grain<Dim>(scene, at, radius);
  measure<Dim>(scene, "all", Vec<Dim>::Zero(), Vec<Dim>::Ones());
  return first_row(scene).at("all.solid");
}

}  // namespace

TEST_SUITE("measure") {
  TEST_CASE("the solid fraction counts the parts of discs that lie in the region, exactly") {
    const double r = 0.1;
    const double disc = kPi * r * r;
    CHECK(relative_error(solid_of<2>({0.5, 0.5}, r), disc) < 1e-14);
    CHECK(relative_error(solid_of<2>({0, 0.5}, r), disc / 2) < 1e-13);
    CHECK(relative_error(solid_of<2>({1, 1}, r), disc / 4) < 1e-13);
    CHECK(solid_of<2>({-r, 0.5}, r) < 1e-16);
    CHECK(solid_of<2>({2, 0.5}, r) == 0);
    // A cap of height r / 2 is outside.
    const double cap = r * r * (kPi / 3 - std::sqrt(3.0) / 4);
    CHECK(relative_error(solid_of<2>({0.5, r / 2}, r), disc - cap) < 1e-13);
    // The region lies within the disc.
    CHECK(relative_error(solid_of<2>({0.5, 0.5}, 3), 1) < 1e-12);
  }

  TEST_CASE("the solid fraction counts the parts of spheres to a thousandth of a sphere") {
    const double r = 0.1;
    const double sphere = 4.0 / 3 * kPi * r * r * r;
    CHECK(relative_error(solid_of<3>({0.5, 0.5, 0.5}, r), sphere) < 1e-14);
    CHECK(std::abs(solid_of<3>({0.5, 0.5, 0}, r) - sphere / 2) < 1e-3 * sphere);
    CHECK(std::abs(solid_of<3>({0, 0.5, 0.5}, r) - sphere / 2) < 1e-3 * sphere);
    CHECK(std::abs(solid_of<3>({1, 0, 1}, r) - sphere / 8) < 1e-3 * sphere);
    // A cap of height r / 2 is outside: pi h^2 (3 r - h) / 3.
    const double cap = kPi * r * r / 4 * (3 * r - r / 2) / 3;
    for (int d = 0; d < 3; ++d) {
      Vec<3> at = Vec<3>::Constant(0.5);
      at[d] = r / 2;
      CHECK(std::abs(solid_of<3>(at, r) - (sphere - cap)) < 1e-3 * sphere);
    }
    CHECK(solid_of<3>({0.5, 0.5, 1.2}, r) == 0);
  }

  TEST_CASE_TEMPLATE("slices share a grain out among themselves", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Scene<Dim> scene = empty_scene<Dim>();
    const Vec<Dim> at = Vec<Dim>::Constant(0.45);
    add_grain<Dim>(scene, at, 0.2);
    measure<Dim>(scene, "all", Vec<Dim>::Zero(), Vec<Dim>::Ones());
    measure<Dim>(scene, "up", Vec<Dim>::Zero(), Vec<Dim>::Ones(), 5);
    measure<Dim>(scene, "along x", Vec<Dim>::Zero(), Vec<Dim>::Ones(), 5, 0);
    const auto row = first_row(scene);
    for (const std::string name : {"up", "along x"}) {
      double sum = 0;
      for (int k = 1; k <= 5; ++k) sum += row.at(name + " " + std::to_string(k) + ".solid") / 5;
      CHECK(relative_error(sum, row.at("all.solid")) < (Dim == 2 ? 1e-12 : 2e-3));
      CHECK(row.at(name + " 5.solid") == 0);
    }
  }

  TEST_CASE_TEMPLATE("the stress of one contact is force times branch over volume", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    Scene<Dim> scene = empty_scene<Dim>();
    Vec<Dim> n = Vec<Dim>::Zero();
    n[0] = 0.6;
    n[1] = 0.8;
    const double overlap = 0.001;
    const double branch = 0.1 + 0.2 - overlap;
    add_grain<Dim>(scene, Vec<Dim>::Constant(0.4), 0.1);
    add_grain<Dim>(scene, Vec<Dim>::Constant(0.4) + branch * n, 0.2);
    measure<Dim>(scene, "all", Vec<Dim>::Zero(), Vec<Dim>::Constant(2));
    // The contact lies 0.1 m from the first grain.
    const Vec<Dim> point = Vec<Dim>::Constant(0.4) + 0.0995 * n;
    measure<Dim>(scene, "there", point - Vec<Dim>::Constant(0.01),
                 point + Vec<Dim>::Constant(0.01));
    measure<Dim>(scene, "beside", Vec<Dim>::Zero(), point - Vec<Dim>::Constant(1e-6));

    const auto row = first_row(scene);

    const double moment = 1e6 * overlap * branch;
    const double volume = Dim == 2 ? 4 * 0.5 : 8;
    CHECK(relative_error(row.at("all.sxx"), 0.36 * moment / volume) < 1e-9);
    CHECK(relative_error(row.at("all.syy"), 0.64 * moment / volume) < 1e-9);
    CHECK(relative_error(row.at("all.sxy"), 0.48 * moment / volume) < 1e-9);
    if (Dim == 3) {
      CHECK(row.at("all.szz") == 0);
      CHECK(row.at("all.sxz") == 0);
      CHECK(row.at("all.syz") == 0);
    }
    const double little = Dim == 2 ? 4e-4 * 0.5 : 8e-6;
    CHECK(relative_error(row.at("there.syy"), 0.64 * moment / little) < 1e-9);
    CHECK(row.at("beside.syy") == 0);
  }

  TEST_CASE_TEMPLATE("in a column at rest the stress grows with the weight above", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    constexpr int kCount = 10;
    Scene<Dim> scene = empty_scene<Dim>();
    scene.gravity[Dim - 1] = -10;
    scene.walls = {Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), Vec<Dim>::Unit(Dim - 1))};
    const double r = 0.05;
    const double weight = 10 * 2500 * grain_volume<Dim>(r, scene.depth);
    double height = 0;
    double moment = 0;
    for (int k = 0; k < kCount; ++k) {
      const double force = (kCount - k) * weight;
      const double branch = (k == 0 ? r : 2 * r) - force / scene.law.stiffness;
      height += branch;
      moment += force * branch;
      add_grain<Dim>(scene, height * Vec<Dim>::Unit(Dim - 1), r);
    }
    Vec<Dim> low = Vec<Dim>::Constant(-r);
    Vec<Dim> high = Vec<Dim>::Constant(r);
    low[Dim - 1] = 0;
    high[Dim - 1] = 1;
    measure<Dim>(scene, "bed", low, high);
    measure<Dim>(scene, "profile", low, high, kCount);

    const auto row = first_row(scene);

    const std::string s = Dim == 2 ? ".syy" : ".szz";
    const double volume = Dim == 2 ? 2 * r * 0.5 : 4 * r * r;
    CHECK(relative_error(row.at("bed" + s), moment / volume) < 1e-9);
    CHECK(std::abs(row.at("bed.sxx")) < 1e-9 * row.at("bed" + s));
    // A slice of 0.1 m holds the contact on top of its grain: the weight above it over the area,
    // but for the overlap.
    for (int k = 2; k < kCount; ++k) {
      const double above = (kCount - k) * weight / volume;
      CHECK(relative_error(row.at("profile " + std::to_string(k) + s), above) < 0.02);
    }
  }

  TEST_CASE("measures are read, written and checked") {
    const std::string keys =
        "[[measure]]\nname = \"bed\"\nslices = 4\naxis = \"x\"\n"
        "region = { low = [0, 0], high = [\"10 cm\", 1] }\n[[measure]]\n"
        "region = { low = [0, 0], high = [1, 1] }\n";
    const Scene<2> scene = parse_scene<2>(kHeap + keys, "s.toml");
    REQUIRE(scene.measures.size() == 2);
    CHECK(scene.measures[0].name == "bed");
    CHECK(scene.measures[0].slices == 4);
    CHECK(scene.measures[0].axis == 0);
    CHECK(scene.measures[0].region.high == Vec<2>(0.1, 1));
    CHECK(scene.measures[1].name == "measure 2");
    CHECK(scene.measures[1].axis == 1);
    CHECK(to_toml(parse_scene<2>(to_toml(scene), "s.toml")) == to_toml(scene));
    const auto columns = series_columns(*make_run(scene));
    const auto named = [&](const std::string& name) {
      return std::any_of(columns.begin(), columns.end(),
                         [&](const SeriesColumn& column) { return column.name == name; });
    };
    CHECK(named("bed 4.solid"));
    CHECK(named("measure 2.sxy"));

    const auto refusal = [&](const std::string& part, const std::string& instead) {
      return scene_error_of([&] { parse_scene<2>(kHeap + with(keys, part, instead), "s.toml"); });
    };
    CHECK(refusal("axis = \"x\"", "axis = \"z\"") ==
          "s.toml:46: measure[0].axis: expected \"x\" or \"y\", got \"z\"");
    CHECK(refusal("slices = 4", "slices = 0") ==
          "s.toml:45: measure[0].slices: expected a whole number, at least 1, got 0");
    CHECK(refusal("slices = 4", "slices = 100000") ==
          "s.toml:45: measure[0].slices: expected at most 1000 slices, got 100000");
    CHECK(refusal("low = [0, 0]", "low = [1, 0]") ==
          "s.toml:47: measure[0].region: expected low below high in every direction");
    CHECK(refusal("\"bed\"", "\"measure 2\"") ==
          "s.toml:48: measure[1].name: a second \"measure 2\"");
  }
}
