// SPDX-License-Identifier: GPL-3.0-or-later
// Materials that do not touch: sieves, and grains that go through walls.
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

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// Coarse and fine discs fall on a sieve that the fine ones do not touch. Line 18 is the pair.
const std::string kSieve = R"(dimension = 2
duration = 1
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
audit = true
[law]
stiffness = 1e6
restitution = 0.4
friction = 0.3
[materials.coarse]
density = 2500
[materials.fine]
density = 2500
[materials.steel]
[[pair]]
between = ["fine", "steel"]
touch = false
[[fill]]
material = "coarse"
radius = 0.02
region = { low = [0, 0.5], high = [0.5, 0.8] }
count = 6
[[fill]]
material = "fine"
radius = 0.008
region = { low = [0, 0.8], high = [0.5, 0.9] }
count = 60
[[wall]]
name = "sieve"
material = "steel"
point = [0, 0.45]
from = [-1, 0]
to = [2, 0]
[[box]]
low = [0, 0]
high = [0.5, 2]
material = "coarse"
)";

std::string sieve(int dim) {
  const std::string text = with(kSieve, "point = [0, 0.45]\nfrom = [-1, 0]\nto = [2, 0]",
                                "from = [-1, 0.45]\nto = [2, 0.45]");
  if (dim == 2) return text;
  const std::string soft = with(text, "stiffness = 1e6", "stiffness = 1e5");
  return in_space<3>(
      with(soft, "from = [-1, 0.45]\nto = [2, 0.45]",
           "corners = [[-1, -1, 0.45], [2, -1, 0.45], [2, 2, 0.45], [-1, 2, 0.45]]"));
}

template <int Dim>
std::string end_of(const std::string& text, double t) {
  auto run = make_run(parse_scene<Dim>(text, "s"));
  run->advance_to(t);
  CHECK(run->audit().missed() == 0);
  return frame_csv(*run) + contacts_csv(*run);
}

std::string refusal(const std::string& part, const std::string& instead) {
  return scene_error_of([&] { parse_scene<2>(with(sieve(2), part, instead), "s.toml"); });
}

}  // namespace

TEST_SUITE("materials that do not touch") {
  TEST_CASE_TEMPLATE("fine grains fall through a sieve that holds the coarse ones", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    auto run = make_run(parse_scene<Dim>(sieve(Dim), "s"));
    run->advance_to(1);
    int below = 0;
    for (int i = 0; i < run->count(); ++i) {
      const double height = run->positions()(Dim - 1, i);
      if (run->materials()[static_cast<std::size_t>(i)] == 0) {
        CHECK(height > 0.46);
      } else {
        below += height < 0.45;
      }
    }
    CHECK(below > 20);
    CHECK(run->audit().missed() == 0);
    CHECK(run->audit().contacts() > 50);
    for (const auto& contact : run->contacts()) {
      CHECK((contact.wall != 0 || run->materials()[static_cast<std::size_t>(contact.i)] == 0));
    }
    CHECK(std::abs(run->energy_residual()) < 0.01 * run->ledger().dashpot);
  }

  TEST_CASE_TEMPLATE("all neighbourhoods give the same bits", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const std::string text = sieve(Dim);
    const double t = Dim == 2 ? 0.6 : 0.3;
    const std::string reference = end_of<Dim>(text, t);
    CHECK(end_of<Dim>("neighbourhood = \"linked cells\"\n" + text, t) == reference);
    CHECK(end_of<Dim>("neighbourhood = \"all pairs\"\n" + text, t) == reference);
    const bool differs = end_of<Dim>(with(text, "touch = false", "touch = true"), t) != reference;
    CHECK(differs);
  }

  TEST_CASE("a grain that touches no wall falls as if there were none, bit for bit") {
    std::string text = with(sieve(2),
                            "[[fill]]\nmaterial = \"coarse\"\nradius = 0.02\n"
                            "region = { low = [0, 0.5], high = [0.5, 0.8] }\ncount = 6\n",
                            "");
    text = with(text, "count = 60", "count = 1\nvelocity = [0, -30]");  // fast through a thin wall
    // Walls of steel alone.
    const auto through = with(text, "high = [0.5, 2]\nmaterial = \"coarse\"",
                              "high = [0.5, 2]\nmaterial = \"steel\"");
    auto with_walls = make_run(parse_scene<2>("time_step = 1e-4\n" + through, "s"));
    const auto at = through.find("[[wall]]");
    auto without_walls =
        make_run(parse_scene<2>("time_step = 1e-4\n" + through.substr(0, at), "s"));
    with_walls->advance_to(0.5);
    without_walls->advance_to(0.5);
    CHECK(with_walls->positions()(1, 0) < -5);
    CHECK(with_walls->positions() == without_walls->positions());
  }

  TEST_CASE("who does not touch may overlap at the start, and does not set the step") {
    const std::string dust =
        "[[grain]]\nposition = [0.25, 0.45]\nradius = 1e-3\nmaterial = \"fine\"\n";
    const std::string lone =
        "[[pair]]\nbetween = [\"fine\", \"fine\"]\ntouch = false\n"
        "[[pair]]\nbetween = [\"fine\", \"coarse\"]\ntouch = false\n[[fill]]";
    const std::string apart = with(sieve(2), "[[fill]]", lone);
    const auto contact_time = [](const std::string& text) {
      return make_run(parse_scene<2>(text, "s"))->time_scales().contact;
    };
    CHECK(contact_time(apart + dust) == contact_time(apart));
    CHECK(contact_time(sieve(2) + dust) < 0.2 * contact_time(sieve(2)));
    // On the sieve, within another one, and behind the floor of the box.
    const std::string two =
        apart + dust + with(dust, "radius = 1e-3", "radius = 2e-3") + with(dust, "0.45]", "-3]");
    CHECK(scene_error_of([&] {
            make_run(parse_scene<2>(two, "s.toml"));
          }).find("lies behind wall") == std::string::npos);
    const std::string touching = with(two, "touch = false", "touch = true");
    CHECK(scene_error_of([&] {
            make_run(parse_scene<2>(touching, "s.toml"));
          }).find("overlaps wall \"sieve\"") != std::string::npos);
  }

  TEST_CASE("grains of one material may be a gas without contacts") {
    std::string text = with(sieve(2), "[[fill]]",
                            "[[pair]]\nbetween = [\"fine\", \"fine\"]\n"
                            "touch = false\n[[fill]]");
    text = with(text, "count = 60", "count = 60\nvelocity = { random = 1 }");
    text = with(text, "count = 6", "count = 1");
    auto run = make_run(parse_scene<2>(text, "s"));
    run->advance_to(0.3);
    bool overlap = false;
    for (int i = 1; i < run->count(); ++i) {
      for (int j = i + 1; j < run->count(); ++j) {
        overlap = overlap || (run->positions().col(i) - run->positions().col(j)).norm() < 0.016;
      }
    }
    CHECK(overlap);
    CHECK(run->audit().missed() == 0);
  }

  TEST_CASE("grains that come in keep to their materials") {
    const std::string text = sieve(2) +
                             "[[inlet]]\nmaterial = \"fine\"\nradius = 0.006\nrate = 100\n"
                             "region = { low = [0.1, 1.2], high = [0.4, 1.5] }\n"
                             "[[outlet]]\nlow = [0, -1]\nhigh = [0.5, 0.1]\n";
    auto run = make_run(parse_scene<2>(text, "s"));
    run->advance_to(1);
    CHECK(run->traffic()->outlets[0].grains > 40);
    CHECK(run->audit().missed() == 0);
    CHECK(std::abs(run->energy_residual()) < 0.01 * run->ledger().dashpot);
  }

  TEST_CASE("pairs that do not touch are read, written and explained") {
    const Scene<2> scene = parse_scene<2>(sieve(2), "s");
    REQUIRE(scene.pairs.size() == 1);
    CHECK(!scene.pairs[0].touch);
    CHECK(scene.apart()(1, 2));
    CHECK(!scene.apart()(0, 1));
    const std::string resolved = to_toml(scene);
    CHECK(to_toml(parse_scene<2>(resolved, "s")) == resolved);
    CHECK(explain(*make_run(scene)).find("no contacts     between \"fine\" and \"steel\"") !=
          std::string::npos);
    CHECK(refusal("touch = false", "touch = false\nfriction = 0.1") ==
          "s.toml:19: pair[0].friction: the two do not touch; remove this line");
    CHECK(refusal("touch = false", "touch = 0").find("pair[0].touch") != std::string::npos);
    CHECK(refusal("touch = false", "tuch = false").find("did you mean \"touch\"?") !=
          std::string::npos);
  }

  TEST_CASE("where nothing touches, a step has to be given") {
    std::string text = kSphere +
                       "[[pair]]\nbetween = [\"steel\", \"steel\"]\ntouch = false\n"
                       "[[wall]]\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n";
    CHECK(scene_error_of([&] {
            make_run(parse_scene<3>(text, "s.toml"));
          }).find("time_step: nothing in the scene that can move touches anything") !=
          std::string::npos);
    text = "time_step = 1e-3\n" + text;
    auto run = make_run(parse_scene<3>(text, "s.toml"));
    run->advance_to(1);
    CHECK(relative_error(run->positions()(2, 0) - 1, -9.81 / 2) < 1e-9);
    CHECK(explain(*run).find("none: nothing in the scene that can move touches") !=
          std::string::npos);
    // Without loss, whatever the law of the pair says.
    text = with(
        with(text, "friction = \"none\"", "friction = \"none\"\nintegrator = \"fourth order\""),
        "restitution = 0.5", "restitution = 1");
    CHECK_NOTHROW(make_run(parse_scene<3>(text, "s.toml"))->advance_to(0.1));
  }
}
