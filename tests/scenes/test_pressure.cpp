// SPDX-License-Identifier: GPL-3.0-or-later
// Pistons that hold a pressure while the walls beside them move.
#include <lagrain/format.hpp>
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/scene_text.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// A disc lies still below a lid that presses between two walls, of which one closes in. Line 24 is
/// the motion of the lid.
const std::string kLid = R"(dimension = 2
duration = 2
time_step = 1e-4
depth = 0.5
gravity = [0, 0]
normal = "linear"
friction = "none"
[law]
stiffness = 1e5
restitution = 0.3
[materials.steel]
density = 1000
[[grain]]
position = [0.5, 0.1]
radius = 0.1
[[wall]]
name = "floor"
point = [0, 0]
normal = [0, 1]
[[wall]]
name = "lid"
point = [0, 0.2]
normal = [0, -1]
motion = { type = "piston", mass = 4, pressure = "2 kPa", between = ["left", "right"] }
[[wall]]
name = "left"
point = [0, 0]
normal = [1, 0]
motion = { type = "steady", velocity = [0.1, 0], stop = 1 }
[[wall]]
name = "right"
point = [1, 5]
normal = [-1, 0]
)";

const std::string kLidInSpace = R"(dimension = 3
duration = 2
time_step = 1e-4
gravity = [0, 0, 0]
normal = "linear"
friction = "none"
[law]
stiffness = 1e5
restitution = 0.3
[materials.steel]
density = 1000
[[grain]]
position = [0.5, 0.5, 0.1]
radius = 0.1
[[box]]
low = [0, 0, 0]
high = [1, 2, 9]
open = ["top", "left", "back"]
[[wall]]
name = "lid"
point = [0, 0, 0.2]
normal = [0, 0, -1]
motion = { type = "piston", mass = 4, pressure = 100, between = ["left", "right", "front", "back"] }
[[wall]]
name = "left"
point = [0, 0, 0]
normal = [1, 0, 0]
motion = { type = "steady", velocity = [0.1, 0, 0], stop = 1 }
[[wall]]
name = "back"
point = [0, 2, 0]
normal = [0, -1, 0]
motion = { type = "steady", velocity = [0, -0.2, 0], stop = 1 }
)";

template <int Dim>
const Wall<Dim>& wall_named(const Run<Dim>& run, const std::string& name) {
  return *std::find_if(run.walls().begin(), run.walls().end(),
                       [&](const Wall<Dim>& wall) { return wall.name == name; });
}

std::string refusal(const std::string& part, const std::string& instead) {
  return scene_error_of([&] { parse_scene<2>(with(kLid, part, instead), "s.toml"); });
}

}  // namespace

TEST_SUITE("pressure") {
  TEST_CASE("a free lid is accelerated by pressure times the area at each time, in the plane") {
    // m a = p (1 - v t) depth, from rest.
    auto run = make_run(parse_scene<2>(with(kLid, "point = [0, 0.2]", "point = [0, 900]"), "s"));
    for (const double t : {0.25, 0.5, 1.0}) {
      run->advance_to(t);
      const double fallen = 900 - wall_named(*run, "lid").point[1];
      const double expected = 2000 * 0.5 / 4 * (t * t / 2 - 0.1 * t * t * t / 6);
      CHECK(relative_error(fallen, expected) < 4 * run->time_step() / t);
      CHECK(relative_error(wall_named(*run, "lid").velocity[1],
                           -2000 * 0.5 / 4 * (t - 0.1 * t * t / 2)) < 4 * run->time_step() / t);
    }
    // Then the walls rest, and so does the force.
    const double before = wall_named(*run, "lid").velocity[1];
    run->advance_to(1.5);
    CHECK(relative_error(wall_named(*run, "lid").velocity[1] - before,
                         -2000 * 0.5 / 4 * 0.9 * 0.5) < 1e-3);
    CHECK(run->ledger().wall_work == 0);
  }

  TEST_CASE("a free lid is accelerated by pressure times the area at each time, in space") {
    const auto text = with(kLidInSpace, "point = [0, 0, 0.2]", "point = [0, 0, 900]");
    auto run = make_run(parse_scene<3>(text, "s"));
    run->advance_to(0.8);
    // a = (p / m) 2 (1 - t / 10)^2.
    const double v = 2 * 100.0 / 4 * (1 - std::pow(0.92, 3)) / 0.3;
    CHECK(relative_error(-wall_named(*run, "lid").velocity[2], v) < 1e-3);
    CHECK(wall_named(*run, "lid").velocity.head<2>().isZero(0));
  }

  TEST_CASE("at rest a lid presses with pressure times area, and the ledger closes") {
    auto run = make_run(parse_scene<2>(kLid, "s"));
    const double whole = 2000 * 0.5;
    for (const double t : {0.4, 0.7, 0.95}) {
      run->advance_to(t);
      // The walls close in slowly against the springs: the lid follows.
      CHECK(relative_error(wall_named(*run, "lid").force[1], whole * (1 - 0.1 * t)) < 0.02);
    }
    run->advance_to(2);
    const double force = whole * 0.9;
    CHECK(relative_error(wall_named(*run, "lid").force[1], force) < 1e-6);
    CHECK(relative_error(-wall_named(*run, "floor").force[1], force) < 1e-6);
    CHECK(relative_error(0.2 - wall_named(*run, "lid").point[1], 2 * force / 1e5) < 1e-6);
    const Ledger now = run->ledger();
    CHECK(relative_error(now.elastic, force * force / 1e5) < 1e-5);
    CHECK(std::abs(run->energy_residual()) < 0.01 * now.wall_work);
    auto space = make_run(parse_scene<3>(kLidInSpace, "s"));
    space->advance_to(2);
    const double area = 0.9 * 1.8;
    CHECK(relative_error(wall_named(*space, "lid").force[2], 100 * area) < 1e-6);
    CHECK(relative_error(-wall_named(*space, "bottom").force[2], 100 * area) < 1e-6);
  }

  TEST_CASE("in a biaxial test the lid holds its pressure while the sides close in") {
    std::string text = with(kLid, "[[grain]]\nposition = [0.5, 0.1]\nradius = 0.1\n",
                            "[[fill]]\nradius = { uniform = [0.018, 0.022] }\ncount = 250\n"
                            "arrangement = \"random\"\n"
                            "region = { low = [0, 0], high = [1, 0.42] }\n");
    text = with(text, "point = [0, 0.2]", "point = [0, 0.42]");
    text = with(text, "velocity = [0.1, 0], stop = 1", "velocity = [0.05, 0], start = 1");
    text = with(text, "duration = 2", "duration = 3\naudit = true");
    auto run = make_run(parse_scene<2>(with(text, "mass = 4", "mass = 40"), "s"));
    run->advance_to(1);
    double sum = 0, area = 0;
    const double before = wall_named(*run, "lid").point[1];
    for (int k = 0; k < 200; ++k) {
      run->advance_to(1.02 + 0.009 * k);
      sum += wall_named(*run, "lid").force[1];
      area += 0.5 * (1 - wall_named(*run, "left").point[0]);
    }
    CHECK(relative_error(sum, 2000 * area) < 0.03);
    CHECK(wall_named(*run, "lid").point[1] > before);  // the bed is pushed up
    CHECK(run->audit().missed() == 0);
  }

  TEST_CASE("a pressure is the same bits for all neighbourhoods and threads, and when read again") {
    const auto end_of = [](const std::string& text, int threads) {
      auto run = make_run(parse_scene<2>(text, "s"), threads);
      run->advance_to(0.5);
      return frame_csv(*run) + std::to_string(wall_named(*run, "lid").point[1] * 1e9);
    };
    const std::string reference = end_of(kLid, 1);
    CHECK(end_of(kLid, 2) == reference);
    CHECK(end_of("neighbourhood = \"linked cells\"\n" + kLid, 1) == reference);
    CHECK(end_of("neighbourhood = \"all pairs\"\n" + kLid, 1) == reference);
    const std::string resolved = to_toml(parse_scene<2>(kLid, "s"));
    CHECK(to_toml(parse_scene<2>(resolved, "s")) == resolved);
    CHECK(end_of(resolved, 1) == reference);
    const std::string in_space = to_toml(parse_scene<3>(kLidInSpace, "s"));
    CHECK(to_toml(parse_scene<3>(in_space, "s")) == in_space);
    const auto text = explain(*make_run(parse_scene<2>(kLid, "s")));
    CHECK(text.find("\"lid\" holds 2000 Pa, at the start on 0.5 m^2") != std::string::npos);
  }

  TEST_CASE("what cannot hold a pressure is refused in one sentence") {
    CHECK(refusal("[\"left\", \"right\"]", "[\"left\", \"rigth\"]") ==
          "s.toml:24: wall[1].motion.between: no wall \"rigth\" (did you mean \"right\"?)");
    CHECK(refusal("[\"left\", \"right\"]", "[\"left\", \"floor\"]") ==
          "s.toml:24: wall[1].motion.between: walls left and floor are not parallel");
    CHECK(refusal("[\"left\", \"right\"]", "[\"floor\", \"lid\"]") ==
          "s.toml:24: wall[1].motion.between: wall floor is not at a right angle to wall lid");
    CHECK(refusal("[\"left\", \"right\"]", "[\"left\", \"left\"]") ==
          "s.toml:24: wall[1].motion.between: it presses between wall left and itself");
    CHECK(refusal("[\"left\", \"right\"]", "[\"left\"]").find("the names of the two walls") !=
          std::string::npos);
    CHECK(refusal("pressure = \"2 kPa\"", "pressure = 1, load = [0, -1]") ==
          "s.toml:24: wall[1].motion.load: either load or pressure");
    CHECK(refusal("pressure = \"2 kPa\"", "load = [0, -1]") ==
          "s.toml:24: wall[1].motion.between: it bounds the face that a pressure acts on; give "
          "pressure");
    CHECK(refusal("\"2 kPa\"", "0") ==
          "s.toml:24: wall[1].motion.pressure: expected a positive pressure [Pa], got 0");
    CHECK(refusal("\"2 kPa\"", "\"2 kN\"").find("[Pa]") != std::string::npos);
    CHECK(refusal("point = [0, 0.2]\nnormal = [0, -1]", "from = [0, 0.2]\nto = [1, 0.2]")
              .find("it acts along a normal") != std::string::npos);
    CHECK(refusal("name = \"left\"\npoint = [0, 0]\nnormal = [1, 0]",
                  "name = \"left\"\nfrom = [0, 0]\nto = [0, 1]")
              .find("wall left is no flat wall with point and normal") != std::string::npos);
    CHECK(scene_error_of([&] {
            parse_scene<3>(with(kLidInSpace, "\"front\", \"back\"]", "\"bottom\", \"back\"]"), "s");
          }).find("wall bottom is not at a right angle to wall lid") != std::string::npos);
    CHECK(scene_error_of([&] {
            parse_scene<3>(with(kLidInSpace, ", \"front\", \"back\"]", "]"), "s");
          }).find("the names of four walls") != std::string::npos);
    // In a program.
    Scene<2> scene = parse_scene<2>(kLid, "s");
    std::get<Piston<2>>(scene.walls[1].motion).pressure->between[0] = {2, 7};
    CHECK_THROWS_AS(make_run(scene), ContractError);
    std::get<Piston<2>>(scene.walls[1].motion).pressure->between[0] = {2, 3};
    std::get<Piston<2>>(scene.walls[1].motion).pressure->value = std::nan("");
    CHECK_THROWS_AS(make_run(scene), ContractError);
  }
}
