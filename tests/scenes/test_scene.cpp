// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/scene.hpp>

#include <lagrain/check.hpp>
#include <lagrain/numbers.hpp>

#include <support/tolerance.hpp>
#include "support/scene_text.hpp"
#include "support/space.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <variant>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim = 2>
std::string message_of(const std::string& text) {
  return scene_error_of([&] { parse_scene<Dim>(text, "s.toml"); });
}

/// The message after one line of the heap is replaced.
std::string after(const std::string& part, const std::string& instead) {
  return message_of(with(kHeap, part, instead));
}

}  // namespace

TEST_SUITE("scene") {
  TEST_CASE("units are converted and bare numbers are SI") {
    const Scene<2> s = parse_scene<2>(kHeap, "folder/s.toml");

    CHECK(s.title == "heap");
    CHECK(s.duration == 0.02);
    CHECK(s.gravity == Vec<2>(0, -9.81));
    CHECK(s.law.stiffness == 1e7);
    CHECK(s.law.stiffness_ratio == 2.0 / 7);
    CHECK(s.materials.at(0).name == "rock");
    CHECK(s.materials.at(1).density == 2000);
    CHECK(std::get<UniformRadius>(s.fills.at(0).radius).low == 0.008);
    CHECK(s.fills.at(0).region.high == Vec<2>(0.1, 0.2));
    CHECK(s.grains.at(1).velocity == Vec<2>(0, -2));
    CHECK(s.walls.at(0).name == "floor");
  }

  TEST_CASE("a time step is a fraction of the contact time or a time") {
    const auto step = [](const std::string& text) {
      return parse_scene<2>(with(kHeap, "\"1/25 contact\"", text), "s.toml").time_step;
    };

    CHECK(step("\"1/25 contact\"").fraction_of_contact == 1.0 / 25);
    CHECK(step("\"0.05 contact\"").fraction_of_contact == 0.05);
    CHECK(step("\"10 us\"").seconds == 1e-5);
    CHECK(step("2e-5").seconds == 2e-5);
    const std::string want =
        "s.toml:5: time_step: expected a fraction of contact time (\"1/25 contact\") or a time, "
        "got ";
    for (const char* bad : {"\"fast\"", "\"1/0 contact\"", "\"-1/25 contact\"", "\"1/2/3 contact\"",
                            "\"contact\"", "\"1/ contact\"", "\"3 mm\"", "[1]", "true"}) {
      CAPTURE(bad);
      CHECK(after("\"1/25 contact\"", bad) == want + bad);
    }
    CHECK(after("\"1/25 contact\"", "-1e-5") ==
          "s.toml:5: time_step: expected a positive time [s], got -1e-05");
  }

  TEST_CASE("a quantity of the wrong kind, sign or unit is an error that says what was expected") {
    CHECK(after("\"20 ms\"", "\"20 mm\"") ==
          "s.toml:4: duration: expected a positive time [s], got \"20 mm\"");
    CHECK(after("\"20 ms\"", "0") == "s.toml:4: duration: expected a positive time [s], got 0");
    CHECK(after("\"20 ms\"", "nan") == "s.toml:4: duration: expected a positive time [s], got nan");
    CHECK(after("\"20 ms\"", "inf") == "s.toml:4: duration: expected a positive time [s], got inf");
    CHECK(after("\"20 ms\"", "\"20 fortnights\"") ==
          "s.toml:4: duration: expected a positive time [s], got \"20 fortnights\": unknown unit "
          "\"fortnights\"");
    CHECK(after("[0, -9.81]", "[0, -9.81, 0]") ==
          "s.toml:6: gravity: expected [x, y], each an acceleration [m/s^2], got [0, -9.81, 0]");
    CHECK(after("[0, -9.81]", "[0, nan]") ==
          "s.toml:6: gravity: expected an acceleration [m/s^2], got nan");
    CHECK(after("\"1e7 N/m\"", "\"1e7 N\"") ==
          "s.toml:11: law.stiffness: expected a positive stiffness [N/m], got \"1e7 N\"");
    CHECK(after("restitution = 0.5", "restitution = 1.5") ==
          "s.toml:12: law.restitution: expected a number above 0 and at most 1, got 1.5");
    CHECK(after("friction = 0.4", "friction = -0.4") ==
          "s.toml:13: law.friction: expected a number that is not negative, got -0.4");
    CHECK(after("radius = \"20 mm\"", "radius = 0") ==
          "s.toml:26: grain[0].radius: expected a positive length [m], got 0");
    CHECK(after("radius = \"20 mm\"", "radius = \"-20 mm\"") ==
          "s.toml:26: grain[0].radius: expected a positive length [m], got \"-20 mm\"");
    CHECK(after("[\"8 mm\", \"10 mm\"]", "[\"8 mm\", \"1 mm\"]") ==
          "s.toml:21: fill[0].radius.uniform: expected [smallest, largest], got [\"8 mm\", \"1 "
          "mm\"]");
    CHECK(after("count = 12", "count = 0") ==
          "s.toml:20: fill[0].count: expected a whole number, at least 1, got 0");
    CHECK(after("seed = 5", "seed = -5") ==
          "s.toml:3: seed: expected a whole number, at least 0, got -5");
    CHECK(after("high = [\"0.1 m\", \"0.2 m\"]", "high = [0, 1]") ==
          "s.toml:22: fill[0].region: expected low below high in every direction");
    CHECK(after("normal = [0, 1]", "normal = [0, 0]") ==
          "s.toml:37: wall[0].normal: expected a direction, got [0, 0]");
  }

  TEST_CASE("an unknown key offers the nearest known one") {
    CHECK(after("restitution = 0.5", "restitution = 0.5\nrestituton = 0.4") ==
          "s.toml:13: law.restituton: unknown key (did you mean \"restitution\"?)");
    CHECK(after("seed = 5", "sead = 5") == "s.toml:3: sead: unknown key (did you mean \"seed\"?)");
    CHECK(after("seed = 5", "xyzzy = 5") == "s.toml:3: xyzzy: unknown key");
    CHECK(after("count = 12", "cuont = 12") ==
          "s.toml:20: fill[0].cuont: unknown key (did you mean \"count\"?)");
    CHECK(after("friction = \"elastic\"", "friction = \"elastics\"") ==
          "s.toml:8: friction: expected \"none\", \"viscous\", \"elastic\" or \"rolling\", got "
          "\"elastics\" (did you mean \"elastic\"?)");
    CHECK(after("material = \"gravel\"", "material = \"gravle\"") ==
          "s.toml:19: fill[0].material: no material \"gravle\" (did you mean \"gravel\"?)");
  }

  TEST_CASE("a missing key is named, and a misspelt one explains it") {
    CHECK(message_of(without(kHeap, "duration = \"20 ms\"")) ==
          "s.toml:1: duration: missing; expected a positive time [s]");
    CHECK(after("stiffness = ", "stifness = ") ==
          "s.toml:10: law.stiffness: missing; expected a positive stiffness [N/m] (is \"stifness\" "
          "on line 11 meant?)");
    CHECK(message_of(without(kHeap, "dimension = 2")) ==
          "s.toml: dimension: missing; expected 2 or 3");
    CHECK(after("dimension = 2", "dimension = 4") == "s.toml:2: dimension: expected 2 or 3, got 4");
    CHECK(message_of(with(kHeap, "density = 2000", "")) ==
          "s.toml:19: fill[0].material: grains of \"gravel\" need [materials.gravel] density");
    CHECK(message_of(kHeap.substr(0, kHeap.find("[[fill]]"))) ==
          "s.toml: no grains: expected at least one [[fill]], [[grain]], [[grains]], "
          "[[inlet]] or start");
  }

  TEST_CASE("a key that the model does not use is an error") {
    CHECK(
        after("friction = \"elastic\"", "friction = \"none\"") ==
        "s.toml:13: law.friction: friction = \"none\" does not use it; remove this line or choose "
        "\"viscous\" or \"elastic\" or \"rolling\"");
    const std::string hertz = with(with(kHeap, "\"linear\"", "\"hertz\""), "[law]",
                                   "[law]\nmodulus = \"1 MPa\"\nimpact_speed = 1");
    CHECK(message_of(hertz) ==
          "s.toml:13: law.stiffness: normal = \"hertz\" does not use it; remove this line or "
          "choose \"linear\"");
    CHECK(after("[law]", "[law]\nmodulus = 1") ==
          "s.toml:11: law.modulus: normal = \"linear\" does not use it; remove this line or choose "
          "\"hertz\"");
    const std::string frictionless =
        with(without(kHeap, "friction = 0.4"), "\"elastic\"", "\"none\"");
    CHECK(message_of(frictionless) == "accepted");
    CHECK(message_of(with(frictionless, "radius = \"20 mm\"", "radius = 0.02\nspin = 3")) ==
          "s.toml:26: grain[0].spin: nothing spins in a scene with friction = \"none\"; remove "
          "this line");
    CHECK(after("seed = 5", "audit_every = 5") ==
          "s.toml:3: audit_every: nothing is audited; add audit = true or remove this line");
    CHECK(after("radius = \"20 mm\"", "radius = 0.02\npinned = true\nvelocity = [1, 0]") ==
          "s.toml:28: grain[0].velocity: a pinned grain stays; remove this line");
    CHECK(after("seed = 5", "integrator = \"fourth order\"") ==
          "s.toml:3: integrator: \"fourth order\" is for forces without loss: it needs friction = "
          "\"none\"");
    CHECK(message_of(with(frictionless, "seed = 5", "integrator = \"fourth order\"")) ==
          "s.toml:3: integrator: \"fourth order\" is for forces without loss: it needs "
          "restitution = 1");
  }

  TEST_CASE("what is not TOML is an error with line and column") {
    CHECK(message_of("dimension = ").substr(0, 28) == "s.toml:1:13: not valid TOML:");
    // Letters outside of quotes, and the mark that may stand in front of a file.
    for (const std::string letter : {"\xC3\xA9", "\xD0\x8C", "\xE2\xBF\xBF", "\xEF\xBB\x9F"}) {
      CHECK(message_of("dimension = 2\nnor" + letter + "mal = 1").starts_with("s.toml:2:"));
    }
    CHECK(message_of("\xEF\xBB\xBF...").starts_with("s.toml:1:"));
    CHECK(message_of(kHeap + "[law]\n").substr(0, 10) == "s.toml:43:");
    CHECK_THROWS_WITH_AS(read_scene<2>("no/such/file.toml"), "no/such/file.toml: does not exist",
                         SceneError);
    const std::string here = std::filesystem::temp_directory_path().string();
    CHECK_THROWS_WITH_AS(read_scene<2>(here), (here + ": is a folder, no file").c_str(),
                         SceneError);
  }

  TEST_CASE("walls are half-planes, segments or circles, each with a motion") {
    const auto wall = [](const std::string& more) { return message_of(kHeap + more); };

    CHECK(wall("[[wall]]\nmaterial = \"rock\"\n") ==
          "s.toml:43: wall[2].point: missing; expected a shape: point and normal, from and to, "
          "points, or point and radius");
    CHECK(wall("point = [0, 0]\n") == "s.toml:38: wall[1].normal: missing; expected [x, y]");
    CHECK(wall("motion = { type = \"piston\", mass = 0, load = [0, 1] }\n") ==
          "s.toml:43: wall[1].motion.mass: expected a positive mass [kg], got 0");
    CHECK(
        wall("motion = { type = \"piston\", mass = 1, load = [0, 0] }\n") ==
        "s.toml:43: wall[1].motion.load: expected a force: the piston moves along it, got [0, 0]");
    CHECK(wall("motion = { type = \"shake\", amplitude = [0, \"1 mm\"], frequency = \"2 s\" }\n") ==
          "s.toml:43: wall[1].motion.frequency: expected a positive frequency [1/s], got \"2 s\"");
    CHECK(wall("motion = { type = \"steady\", velocity = [0, 1], start = 2, stop = 1 }\n") ==
          "s.toml:43: wall[1].motion.stop: expected a time after start");
    CHECK(wall("motion = { type = \"walk\" }\n") ==
          "s.toml:43: wall[1].motion.type: expected \"steady\", \"shake\", \"path\" or "
          "\"piston\", got \"walk\"");
    CHECK(wall("motion = { type = \"piston\", mass = 1, load = [0, 1], stop = 1 }\n") ==
          "s.toml:43: wall[1].motion.stop: a piston has none: grains stop it; remove this line");
    const std::string rock = "[[wall]]\nmaterial = \"rock\"\n";
    CHECK(wall(rock + "point = [0, 0]\nnormal = [0, 1]\nname = \"floor\"\n") ==
          "s.toml:47: wall[2].name: a second \"floor\"");
    CHECK(wall(rock + "point = [0, 0]\nradius = 0\n") ==
          "s.toml:46: wall[2].radius: expected a positive length [m], got 0");
    CHECK(wall(rock + "radius = 1\n") == "s.toml:43: wall[2].point: missing; expected [x, y]");
    CHECK(wall(rock + "radius = 1\npoint = [0, 0]\naxis = [0, 0, 1]\n") ==
          "s.toml:47: wall[2].axis: a circle has none; remove this line");
    CHECK(wall(rock + "radius = 1\npoint = [0, 0]\nnormal = [0, 1]\n") ==
          "s.toml:47: wall[2].normal: a round wall has point and radius; remove this line");
    CHECK(wall(rock + "point = [0, 0]\nnormal = [0, 1]\naxis = [0, 1]\n") ==
          "s.toml:47: wall[2].axis: an axis belongs to a round wall, with point and radius");
  }

  TEST_CASE("a round wall in space has an axis") {
    const auto wall = [](const std::string& more) {
      return message_of<3>(in_space<3>(kHeap) + "[[wall]]\nname = \"drum\"\nmaterial = \"rock\"\n" +
                           "point = [1, 2, 3]\n" + more);
    };

    CHECK(wall("radius = 2\n") == "s.toml:43: wall[2].axis: missing; expected [x, y, z]");
    CHECK(wall("radius = 2\naxis = [0, 0, 0]\n") ==
          "s.toml:48: wall[2].axis: expected a direction, got [0, 0, 0]");
    CHECK(wall("radius = 2\naxis = [0, 0, 1]\nfrom = [0, 0, 0]\n") ==
          "s.toml:49: wall[2].from: a round wall has point, axis and radius; remove this line");
    CHECK(wall("radius = \"20 cm\"\naxis = [0, 0, 2]\n") == "accepted");
  }

  TEST_CASE_TEMPLATE("a box is its sides as walls, but for the open ones", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const std::string text = in_space<Dim>(
        kHeap +
        "[[box]]\nname = \"pit\"\nmaterial = \"gravel\"\nlow = [-1, -2]\nhigh = [3, 4]\n"
        "open = [\"top\"]\n"
        "motion = { type = \"shake\", amplitude = [0, 0.1], frequency = 3, start = 1, "
        "stop = 2 }\n");
    const std::vector<std::string> names =
        Dim == 2 ? std::vector<std::string>{"pit left", "pit right", "pit bottom"}
                 : std::vector<std::string>{"pit left", "pit right", "pit front", "pit back",
                                            "pit bottom"};

    const auto scene = parse_scene<Dim>(text, "s.toml");

    REQUIRE(scene.walls.size() == 2 + names.size());
    const Vec<Dim> inside = Vec<Dim>::Constant(1);
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Wall<Dim>& wall = scene.walls[2 + k];
      CHECK(wall.name == names[k]);
      CHECK(wall.material == 1);
      const auto d = static_cast<Eigen::Index>(k / 2);
      const double at = k % 2 == 0 ? (d == Dim - 1 ? -2 : -1) : 3;
      CHECK(wall.foot(inside).distance == std::abs(1 - at));
      CHECK(wall.foot(inside).normal == (k % 2 == 0 ? 1 : -1) * Vec<Dim>::Unit(d));
      const auto& shake = std::get<Shake<Dim>>(wall.motion);
      CHECK(shake.amplitude == 0.1 * Vec<Dim>::Unit(Dim - 1));
      CHECK(shake.stop == 2);
    }
    // A resolved scene lists the sides.
    CHECK(to_toml(parse_scene<Dim>(to_toml(scene), "again.toml")) == to_toml(scene));

    const auto box = [](const std::string& more) {
      return message_of<Dim>(
          in_space<Dim>(kHeap + "[[box]]\nmaterial = \"rock\"\nlow = [0, 0]\n" + more));
    };
    CHECK(box("high = [1, 1]\nopen = [\"topp\"]\n") ==
          std::string(
              "s.toml:47: box[0].open: no side \"topp\" (did you mean \"top\"?); expected some "
              "of left, right, ") +
              (Dim == 3 ? "front, back, " : "") + "bottom, top");
    CHECK(box("high = [1, 1]\nopen = \"top\"\n") ==
          "s.toml:47: box[0].open: expected a list of sides, got \"top\"");
    CHECK(box("high = [1, 0]\n") ==
          "s.toml:46: box[0].high: expected low below high in every direction");
    CHECK(box("high = [1, 1]\n") == "s.toml:43: box[0].name: a second \"left\"");
    CHECK(box("high = [1, 1]\nname = \"b\"\nopenn = []\n") ==
          "s.toml:48: box[0].openn: unknown key (did you mean \"open\"?)");
    CHECK(box("high = [1, 1]\nname = \"b\"\nmotion = { type = \"piston\", mass = 1, load = [0, 1] "
              "}\n") ==
          "s.toml:48: box[0].motion: each side would move for itself; leave the side open and give "
          "the piston as a [[wall]]");
  }

  TEST_CASE("sizes by mass and sieve curves are read, written and checked") {
    const auto sizes = [](const std::string& law) {
      return with(kHeap, "{ uniform = [\"8 mm\", \"10 mm\"] }", "{ " + law + " }");
    };
    const auto read = [&](const std::string& law) {
      const Scene<2> scene = parse_scene<2>(sizes(law), "s.toml");
      CHECK(to_toml(parse_scene<2>(to_toml(scene), "s.toml")) == to_toml(scene));
      return scene.fills.at(0).radius;
    };
    CHECK(std::get<UniformRadius>(read("uniform = [1, 2]")).by == Share::number);
    CHECK(std::get<UniformRadius>(read("uniform = [1, 2], by = \"mass\"")).by == Share::mass);
    CHECK(std::get<ListedRadius>(read("values = [1, 2], by = \"mass\"")).by == Share::mass);
    const auto curve =
        std::get<SieveCurve>(read("sieves = [\"2 mm\", \"3 mm\", 1], passing = [0, \"30 %\", 1]"));
    CHECK(curve.openings == std::vector<double>{0.002, 0.003, 1});
    CHECK(curve.passing == std::vector<double>{0, 0.3, 1});

    const auto refusal = [&](const std::string& law) { return message_of(sizes(law)); };
    const std::string at = "s.toml:21: fill[0].radius.";
    CHECK(refusal("uniform = [1, 2], by = \"volume\"") ==
          at + "by: expected \"number\" or \"mass\", got \"volume\" (did you mean \"mass\"?)");
    CHECK(refusal("values = [1, 2], weights = [1]") ==
          at + "weights: expected as many weights as values, not all 0");
    CHECK(refusal("sieves = [1, 2]") == at + "passing: missing; expected a list");
    CHECK(refusal("sieves = [1], passing = [1]") ==
          at + "sieves: expected the openings of two or more sieves, each wider than the one "
               "before, got [1]");
    CHECK(refusal("sieves = [2, 1], passing = [0, 1]").starts_with(at + "sieves: expected"));
    const std::string rising =
        "passing: expected as many shares as sieves, rising from 0 to 1, got ";
    CHECK(refusal("sieves = [1, 2], passing = [0.1, 1]") == at + rising + "[0.1, 1]");
    CHECK(refusal("sieves = [1, 2], passing = [0, 2]") == at + rising + "[0, 2]");
    CHECK(refusal("sieves = [1, 2, 3], passing = [0, 1]") == at + rising + "[0, 1]");
    CHECK(refusal("sieves = [1, 2, 3, 4], passing = [0, 0.7, 0.6, 1]") ==
          at + rising + "[0, 0.7, 0.6, 1]");
    CHECK(refusal("sieves = [1, 2], passing = [0, 1], by = \"number\"") ==
          at + "by: what passes a sieve is a share of the mass; remove this line");
    CHECK(refusal("uniform = [1, 2], sieves = [1, 2]") ==
          at + "sieves: either uniform, or values, or sieves and passing");
    CHECK(refusal("values = [1, 2], passing = [0, 1]") ==
          at + "passing: either values, or sieves and passing");
    CHECK(refusal("weights = [1]").starts_with("s.toml:21: fill[0].radius.weights: unknown key"));
  }

  TEST_CASE("a resolved scene reads back as itself, every default filled in") {
    const std::string text =
        with(kHeap, "gravity = [0, ", "gravity = [-0.0, ") +
        "motion = { type = \"shake\", amplitude = [0.1, 0.3], frequency = 7, stop = 3 }\n"
        "[[wall]]\nname = \"a \\\"slope\\\", 30°\"\nmaterial = \"gravel\"\npoint = [0.1, 0.7]\n"
        "normal = [0.3, 0.7]\n"
        "[[wall]]\nname = \"drum\"\nmaterial = \"rock\"\npoint = [0.1, 0.2]\nradius = 0.7\n"
        "motion = { type = \"piston\", mass = 2, load = [0, -3], start = 0.1 }\n"
        "[[pair]]\nbetween = [\"rock\", \"gravel\"]\nfriction = 0.7\n"
        "[[fill]]\nmaterial = \"rock\"\nradius = { values = [0.001, 0.003], weights = [1, 2] }\n"
        "region = { low = [1, 1], high = [1.1, 1e22] }\nvelocity = { random = 3 }\ncount = 3\n";
    const Scene<2> once = parse_scene<2>(text, "s.toml");

    const std::string resolved = to_toml(once);
    const Scene<2> twice = parse_scene<2>(resolved, "s.toml");

    CHECK(to_toml(twice) == resolved);
    CHECK(twice.walls.at(1).home == once.walls.at(1).home);
    CHECK(twice.walls.at(1).corners() == once.walls.at(1).corners());
    CHECK(std::get<HalfSpace<2>>(twice.walls.at(2).shape).normal ==
          std::get<HalfSpace<2>>(once.walls.at(2).shape).normal);
    CHECK(std::get<Cylinder<2>>(twice.walls.at(3).shape).radius == 0.7);
    CHECK(std::get<Piston<2>>(twice.walls.at(3).motion).start == 0.1);
    CHECK(twice.walls.at(2).name == "a \"slope\", 30°");
    CHECK(twice.pairs.at(0).law.friction == 0.7);
    CHECK(twice.pairs.at(0).law.stiffness == 1e7);
    CHECK(std::signbit(twice.gravity[0]));
    CHECK(twice.time_step.fraction_of_contact == once.time_step.fraction_of_contact);
    CHECK(resolved.find("largest_overlap = 0.3") != std::string::npos);
  }

  TEST_CASE("scenes of spheres read the same way") {
    const std::string text = R"(dimension = 3
duration = 1
gravity = [0, 0, -9.81]
normal = "hertz"
friction = "none"
[law]
modulus = "1 MPa"
impact_speed = 1
restitution = 1
[materials.steel]
density = 7800
[[grain]]
position = [0, 0, 1]
radius = 0.1
[[wall]]
point = [0, 0, 0.3]
axis = [0.1, 0.2, 0.7]
radius = "40 cm"
)";
    const Scene<3> s = parse_scene<3>(text, "s.toml");

    CHECK(s.gravity == Vec<3>(0, 0, -9.81));
    CHECK(to_toml(parse_scene<3>(to_toml(s), "s.toml")) == to_toml(s));
    const auto& drum = std::get<Cylinder<3>>(s.walls.at(0).shape);
    CHECK(drum.radius == 0.4);
    CHECK(relative_error(drum.axis.norm(), 1) < 1e-15);
    CHECK_THROWS_WITH_AS(parse_scene<2>(text, "s.toml"), "s.toml:1: dimension: expected 2, got 3",
                         SceneError);
  }

  TEST_CASE("numbers are written as the shortest text that reads back") {
    CHECK(shortest(0.1) == "0.1");
    CHECK(shortest(1e22) == "1e+22");
    CHECK(shortest(-0.0) == "-0");
    CHECK(shortest(std::numeric_limits<double>::infinity()) == "inf");
    CHECK(shortest(1.0 / 3) == "0.3333333333333333");
  }
}
