// SPDX-License-Identifier: GPL-3.0-or-later
// What passes through a plane, in the series.
#include <lagrain/frame.hpp>
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/scene_text.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

const std::string kNothing = R"(dimension = 2
duration = 2
gravity = [0, 0]
normal = "linear"
friction = "none"
[law]
stiffness = 1e6
restitution = 1
[materials.steel]
density = 1000
)";

/// A value of the series as it is now.
template <int Dim>
double now(const Run<Dim>& run, const std::string& column) {
  const auto columns = series_columns(run);
  const Sample row = sample_of(run, run.ledger(), run.statistics());
  REQUIRE(columns.size() == row.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k].name != column) continue;
    return std::visit([](auto value) { return static_cast<double>(value); }, row[k]);
  }
  FAIL("no column ", column);
  return 0;
}

std::string grain(double x, double y, double vy, double radius = 0.01) {
  return "[[grain]]\nposition = [" + std::to_string(x) + ", " + std::to_string(y) +
         "]\nradius = " + std::to_string(radius) + "\nvelocity = [0, " + std::to_string(vy) + "]\n";
}

std::string refusal(const std::string& keys) {
  return scene_error_of(
      [&] { parse_scene<2>(kNothing + grain(0, 0, 0) + "[[measure]]\n" + keys, "s.toml"); });
}

}  // namespace

TEST_SUITE("flow in scenes") {
  TEST_CASE("of a row that falls, as many have passed as the closed form says") {
    std::string text = with(kNothing, "gravity = [0, 0]", "gravity = [0, -10]");
    for (int k = 0; k < 20; ++k) text += grain(0.1 * k, 0.033 + 0.1 * k, 0);
    text += "[[measure]]\nname = \"down\"\npoint = [7, 0]\nnormal = [0, -2]\n";
    text += "[[measure]]\nname = \"up\"\npoint = [7, 0]\nnormal = [0, 1]\n";
    text += "[[measure]]\nname = \"some\"\npoint = [7, 0]\nnormal = [0, -1]\n";
    text += "region = { low = [0.45, -0.01], high = [1.05, 0.01] }\n";
    auto run = make_run(parse_scene<2>(text, "s"));
    const double mass = run->masses()[0];
    CHECK(now(*run, "down.grains") == 0);
    for (const double t : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}) {
      run->advance_to(t);
      int passed = 0, some = 0;
      for (int k = 0; k < 20; ++k) {
        const bool has = 0.033 + 0.1 * k < 5 * run->time() * run->time();
        passed += has;
        some += has && k >= 5 && k <= 10;
      }
      CHECK(now(*run, "down.grains") == passed);
      CHECK(now(*run, "up.grains") == -passed);
      CHECK(now(*run, "some.grains") == some);
      CHECK(relative_error(now(*run, "down.mass"), mass * passed) < 1e-12);
      CHECK(relative_error(now(*run, "up.mass"), -mass * passed) < 1e-12);
    }
    CHECK(now(*run, "some.grains") == 6);
  }

  TEST_CASE("grains that go to and fro come to nothing, whenever one looks") {
    std::string text = kNothing + grain(0, 0.5, 3) + grain(1, 0.5, -2, 0.02);
    text += "[[box]]\nlow = [-1, 0]\nhigh = [2, 1]\n";
    text += "[[measure]]\nname = \"m\"\npoint = [0, 0.4]\nnormal = [0, 1]\n";
    auto run = make_run(parse_scene<2>(text, "s"));
    std::int64_t changes = 0;
    double before = 0;
    while (!run->finished()) {
      run->step(7);
      double count = 0, mass = 0;
      for (int i = 0; i < 2; ++i) {
        if (run->positions()(1, i) >= 0.4) continue;
        count -= 1;
        mass -= run->masses()[i];
      }
      REQUIRE(now(*run, "m.grains") == count);
      REQUIRE(std::abs(now(*run, "m.mass") - mass) < 1e-12);
      changes += count != before;
      before = count;
    }
    CHECK(changes > 10);
  }

  TEST_CASE("what flows out of a silo is what its outlet counts, however fast it leaves") {
    std::string text = with(kNothing, "gravity = [0, 0]", "gravity = [0, -9.81]");
    text = with(text, "restitution = 1", "restitution = 0.4");
    text +=
        "[[inlet]]\nname = \"rain\"\nradius = { uniform = [0.008, 0.012] }\nrate = 150\n"
        "stop = 1\nregion = { low = [-0.2, 0.5], high = [0.2, 0.9] }\n";
    text += "[[outlet]]\nname = \"sink\"\nlow = [-9, -2]\nhigh = [9, -1]\n";
    text += "[[wall]]\npoints = [[-0.3, 0.5], [-0.05, 0.1]]\n";
    text += "[[wall]]\npoints = [[0.3, 0.5], [0.05, 0.1]]\n";
    text +=
        "[[measure]]\nname = \"mouth\"\npoint = [0, 0.1]\nnormal = [0, -1]\n"
        "region = { low = [-0.06, 0], high = [0.06, 0.2] }\n";
    text += "[[measure]]\nname = \"edge\"\npoint = [0, -1]\nnormal = [0, -1]\n";
    const auto at_end = [&](const std::string& scene, int threads) {
      auto run = make_run(parse_scene<2>(scene, "s"), threads);
      while (!run->finished()) run->step(1000);
      return run;
    };
    const std::string whole = with(text, "duration = 2", "duration = 4");
    const auto run = at_end(whole, 1);
    REQUIRE(run->count() == 0);
    const auto& out = run->traffic()->outlets[0];
    CHECK(out.grains == 150);
    CHECK(now(*run, "mouth.grains") == 150);
    CHECK(now(*run, "edge.grains") == 150);
    CHECK(relative_error(now(*run, "mouth.mass"), out.mass) < 1e-12);
    CHECK(relative_error(now(*run, "edge.mass"), out.mass) < 1e-12);
    bool told = false;
    for (const auto& [name, value] : facts(*run)) {
      told = told || (name == "flow" && value.find("\"mouth\": 150 grains passed, ") == 0);
    }
    CHECK(told);
    CHECK(now(*at_end("neighbourhood = \"all pairs\"\n" + whole, 2), "mouth.mass") ==
          now(*run, "mouth.mass"));
  }

  TEST_CASE("an outlet as thin as a sheet of paper counts all that fall through it") {
    std::string text = with(kNothing, "gravity = [0, 0]", "gravity = [0, -9.81]");
    for (int k = 0; k < 15; ++k) text += grain(0.1 * k, 0.1 + 0.2 * k, -10 * k);
    text += "[[outlet]]\nname = \"sheet\"\nlow = [-1, -1e-4]\nhigh = [9, 0]\n";
    text += "[[outlet]]\nname = \"beside\"\nlow = [-1, -0.3]\nhigh = [-0.5, -0.2]\n";
    auto run = make_run(parse_scene<2>(text, "s"));
    run->advance_to(1);
    CHECK(run->traffic()->outlets[0].grains == 15);
    CHECK(run->traffic()->outlets[1].grains == 0);
    CHECK(run->count() == 0);
  }

  TEST_CASE("planes are read, written, explained and checked") {
    const std::string text = kNothing + grain(0, 0, 0) +
                             "[[measure]]\npoint = [1, \"10 cm\"]\nnormal = [3, 4]\n"
                             "[[measure]]\nregion = { low = [0, 0], high = [1, 1] }\n"
                             "[[measure]]\nname = \"part\"\npoint = [1, 0]\nnormal = [0, 1]\n"
                             "region = { low = [0, 0], high = [1, 1] }\n";
    const Scene<2> scene = parse_scene<2>(text, "s");
    REQUIRE(scene.planes.size() == 2);
    CHECK(scene.measures.size() == 1);
    CHECK(scene.planes[0].name == "measure 1");
    CHECK(scene.planes[0].point == Vec<2>(1, 0.1));
    CHECK((scene.planes[0].normal - Vec<2>(0.6, 0.8)).norm() < 1e-15);
    CHECK(!scene.planes[0].region);
    CHECK(scene.planes[1].region->high == Vec<2>(1, 1));
    const std::string resolved = to_toml(scene);
    CHECK(to_toml(parse_scene<2>(resolved, "s")) == resolved);
    CHECK(explain(*make_run(scene)).find("flow            through plane \"part\"") !=
          std::string::npos);
    CHECK(refusal("point = [0, 0]\n") == "s.toml:15: measure[0].normal: missing; expected [x, y]");
    CHECK(refusal("point = [0, 0]\nnormal = [0, 0]\n") ==
          "s.toml:17: measure[0].normal: expected a direction, got [0, 0]");
    CHECK(refusal("point = [0, 0]\nnormal = [0, 1]\nslices = 3\n") ==
          "s.toml:18: measure[0].slices: a plane has no slices; remove this line");
    CHECK(
        refusal("name = \"x\"\n") ==
        "s.toml:15: measure[0].region: missing; expected a region, or point and normal of a plane");
    CHECK(refusal("name = \"x\"\npoint = [0, 0]\nnormal = [0, 1]\n[[measure]]\nname = \"x\"\n") ==
          "s.toml:20: measure[1].name: a second \"x\"");
    CHECK(refusal("name = \"x\"\npoint = [0, 0]\nnormal = [0, 1]\n[[outlet]]\nname = \"x\"\n"
                  "low = [0, 0]\nhigh = [1, 1]\n") == "s.toml:16: measure[0].name: a second \"x\"");
  }
}
