// SPDX-License-Identifier: GPL-3.0-or-later
// Walls that are solid from the front alone.
#include <lagrain/format.hpp>
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/scene_text.hpp"
#include "support/space.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// A disc is thrown up from below a plate that shows its front to the top.
const std::string kThrow = R"(dimension = 2
duration = 2
time_step = 1e-4
gravity = [0, -10]
normal = "linear"
friction = "none"
audit = true
[law]
stiffness = 1e6
restitution = 1
[materials.steel]
density = 1000
[[grain]]
position = [0, -0.5]
radius = 0.1
velocity = [0, 5]
[[wall]]
name = "plate"
from = [-1, 0]
to = [1, 0]
solid = "front"
)";

std::string in_dimension(int dim) {
  if (dim == 2) return kThrow;
  return in_space<3>(
      with(kThrow, "from = [-1, 0]\nto = [1, 0]",
           "plates = [[[-1, -1, 0], [0, -1, 0], [0, 1, 0], [-1, 1, 0]], [[0, -1, 0], "
           "[1, -1, 0], [1, 1, 0], [0, 1, 0]]]"));
}

template <int Dim>
std::string without_wall(const std::string& text) {
  return text.substr(0, text.find("[[wall]]"));
}

/// Discs rain from the front while others come from behind, and some leave.
const std::string kTraffic = R"(dimension = 2
duration = 1.5
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
audit = true
[law]
stiffness = 4e6
restitution = 0.5
friction = 0.4
[materials.steel]
density = 1000
[[inlet]]
name = "rain"
radius = { uniform = [0.015, 0.02] }
region = { low = [-0.5, 0.6], high = [0.5, 0.9] }
rate = 60
stop = 1.3
[[inlet]]
name = "fountain"
radius = { uniform = [0.015, 0.02] }
region = { low = [-0.5, -0.9], high = [0.5, -0.6] }
rate = 60
velocity = [0, 4]
[[outlet]]
low = [-9, -3]
high = [9, -1]
[[wall]]
name = "plate"
points = [[-1, 0.1], [-0.2, 0], [0.2, 0], [1, 0.1]]
solid = "front"
)";

std::string refusal(const std::string& part, const std::string& instead) {
  return scene_error_of([&] { parse_scene<2>(with(kThrow, part, instead), "s.toml"); });
}

}  // namespace

TEST_SUITE("walls solid from one side") {
  TEST_CASE_TEMPLATE("a grain passes from behind, and lands on the front", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto run = make_run(parse_scene<Dim>(in_dimension(Dim), "s"));
    auto free = make_run(parse_scene<Dim>(without_wall<Dim>(in_dimension(Dim)), "s"));
    run->advance_to(0.8);  // its highest place is 0.75 m, at 0.5 s
    free->advance_to(0.8);
    CHECK(run->positions() == free->positions());
    double lowest = 1, highest = 0;
    while (!run->finished()) {
      run->step(10);
      const double height = run->positions()(Dim - 1, 0);
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
    // The spring holds the energy of a fall from 0.65 m.
    const double mass = run->masses()[0];
    CHECK(lowest < 0.1);
    CHECK(lowest > 0.1 - 1.1 * std::sqrt(2 * mass * 10 * 0.65 / 1e6));
    CHECK(relative_error(highest, 0.75) < 0.01);
    CHECK(std::abs(run->energy_residual()) < 1e-3 * mass * 7.5);
    CHECK(run->audit().missed() == 0);
  }

  TEST_CASE_TEMPLATE("a grain that turns back half-way is not held, wherever its centre is", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const std::string speed : {"2.9", "3.1", "3.16", "3.2", "3.3", "3.45"}) {
      CAPTURE(speed);  // the highest place is between -0.08 and 0.095 m
      const auto text = with(in_dimension(Dim), ", 5]", ", " + speed + "]");
      auto run = make_run(parse_scene<Dim>(text, "s"));
      auto free = make_run(parse_scene<Dim>(without_wall<Dim>(text), "s"));
      for (const double t : {0.3, 0.5, 1.0}) {
        run->advance_to(t);
        free->advance_to(t);
        REQUIRE(run->positions() == free->positions());
      }
    }
  }

  TEST_CASE("over its edge a plate carries as one that is solid from both sides, bit for bit") {
    std::string text = with(kThrow, "position = [0, -0.5]", "position = [0.9, 0.1]");
    text = with(text, "velocity = [0, 5]", "velocity = [0.2, 0]");
    auto run = make_run(parse_scene<2>(text, "s"));
    auto both = make_run(parse_scene<2>(with(text, "\"front\"", "\"both\""), "s"));
    bool below = false;
    for (int k = 0; k < 15; ++k) {
      run->advance_to(0.1 * k);
      both->advance_to(0.1 * k);
      REQUIRE(run->positions() == both->positions());
      below = below || (run->statistics().wall_contacts > 0 && run->positions()(1, 0) < 0.08);
    }
    CHECK(below);  // it has turned about the edge
    CHECK(run->positions()(1, 0) < -1);
    CHECK(std::abs(run->energy_residual()) < 1e-3 * run->masses()[0] * 10);
  }

  TEST_CASE("nobody falls through from the front while others come from behind") {
    auto run = make_run(parse_scene<2>(kTraffic, "s"));
    std::vector<bool> was_above(1000);
    while (!run->finished()) {
      run->step(50);
      for (int i = 0; i < run->count(); ++i) {
        const Vec<2> x = run->positions().col(i);
        if (std::abs(x[0]) > 0.9) continue;
        const double surface = std::max(0.0, (std::abs(x[0]) - 0.2) / 8);
        const auto id = static_cast<std::size_t>(run->id(i));
        if (x[1] > surface + 0.021) was_above[id] = true;
        REQUIRE((!was_above[id] || x[1] > surface));
      }
    }
    CHECK(std::count(was_above.begin(), was_above.end(), true) > 60);
    CHECK(run->traffic()->outlets[0].grains > 5);
    CHECK(run->audit().missed() == 0);
    CHECK(std::abs(run->energy_residual()) < 0.01 * run->ledger().carried);
  }

  TEST_CASE("all neighbourhoods give the same bits") {
    const auto end_of = [](const std::string& text) {
      auto run = make_run(parse_scene<2>(text, "s"));
      run->advance_to(0.8);
      return frame_csv(*run) + contacts_csv(*run);
    };
    const std::string text = without(kTraffic, "audit = true");
    const std::string reference = end_of(text);
    CHECK(end_of("neighbourhood = \"linked cells\"\n" + text) == reference);
    CHECK(end_of("neighbourhood = \"all pairs\"\n" + text) == reference);
    CHECK(end_of(to_toml(parse_scene<2>(text, "s"))) == reference);
  }

  TEST_CASE("a fast grain may come from behind, and stops the run if it goes in from the front") {
    const std::string fast = with(kThrow, "velocity = [0, 5]", "velocity = [0, 3000]");
    auto run = make_run(parse_scene<2>(fast, "s"));
    run->advance_to(0.01);
    CHECK(run->positions()(1, 0) > 29);
    const auto back = with(fast, "from = [-1, 0]\nto = [1, 0]", "from = [1, 0]\nto = [-1, 0]");
    auto stopped = make_run(parse_scene<2>(back, "s"));
    CHECK_THROWS_AS(stopped->advance_to(0.01), SimulationError);
  }

  TEST_CASE("out of a closed line that shows its front outwards grains come, and none comes in") {
    std::string text = with(kThrow, "[0, -10]", "[0, 0]");
    text =
        with(text, "from = [-1, 0]\nto = [1, 0]",
             "points = [[0.4, -0.9], [-0.4, -0.9], [-0.4, -0.1], [0, 0.2], [0.4, -0.1]]\n"
             "closed = true\nmotion = { type = \"shake\", amplitude = [0.01, 0], frequency = 3 }");
    text = with(text, "velocity = [0, 5]", "velocity = [0.1, 1]");
    for (int k = 0; k < 12; ++k) {
      const double angle = 0.5236 * k;
      const std::string x = std::to_string(2 * std::cos(angle));
      const std::string y = std::to_string(2 * std::sin(angle) - 0.4);
      text = with(text, "[[wall]]",
                  "[[grain]]\nposition = [" + x + ", " + y + "]\nradius = 0.06\nvelocity = [" +
                      std::to_string(-2 * std::cos(angle)) + ", " +
                      std::to_string(-2 * std::sin(angle)) + "]\n[[wall]]");
    }
    auto run = make_run(parse_scene<2>(text, "s"));
    run->advance_to(2);
    for (int i = 0; i < run->count(); ++i) {
      const Vec<2> x = run->positions().col(i);
      const bool within = std::abs(x[0]) < 0.38 && x[1] > -0.9 && x[1] < -0.1;
      CHECK(!within);
    }
    CHECK(run->ledger().wall_work != 0);
    CHECK(std::abs(run->energy_residual()) < 1e-3 * run->start().kinetic);
    CHECK(run->audit().missed() == 0);
  }

  TEST_CASE("what has no front is refused in one sentence") {
    CHECK(refusal("from = [-1, 0]\nto = [1, 0]", "point = [0, 0]\nnormal = [0, 1]") ==
          "s.toml:21: wall[0].solid: it has one side; only what is thin is solid from its front or "
          "both");
    CHECK(refusal("to = [1, 0]", "through = [0, 1]\nto = [1, 0]") ==
          "s.toml:22: wall[0].solid: an arc is solid from both sides; give points");
    CHECK(refusal("\"front\"", "\"frond\"").find("wall[0].solid: expected \"both\" or \"front\"") !=
          std::string::npos);
    const std::string resolved = to_toml(parse_scene<3>(in_dimension(3), "s"));
    CHECK(resolved.find("solid = \"front\"") != std::string::npos);
    CHECK(to_toml(parse_scene<3>(resolved, "s")) == resolved);
    CHECK(to_toml(parse_scene<2>(with(kThrow, "\"front\"", "\"both\""), "s")).find("solid") ==
          std::string::npos);
  }
}
