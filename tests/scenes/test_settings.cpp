// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/scene.hpp>

#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

Scene<2> heap_with(const Settings& settings) {
  return parse_scene<2>(kHeap, "heap.toml", settings);
}

std::string refusal_of(const std::string& setting) {
  return scene_error_of([&] { heap_with({setting}); });
}

}  // namespace

TEST_SUITE("settings") {
  TEST_CASE("a key is set beside the scene, in the scene's spelling, with or without quotes") {
    CHECK(heap_with({"law.friction=0.3"}).law.friction == 0.3);
    CHECK(heap_with({"law.friction = .25"}).law.friction == 0.25);
    CHECK(heap_with({"seed=7"}).seed == 7);
    CHECK(heap_with({"title=a slow heap"}).title == "a slow heap");
    CHECK(heap_with({"title=\"a \\\"slow\\\" heap\""}).title == "a \"slow\" heap");
    CHECK(heap_with({"title=a = b"}).title == "a = b");
    CHECK(heap_with({"duration=30 ms"}).duration == 0.03);
    CHECK(heap_with({"duration=\"30 ms\""}).duration == 0.03);
    CHECK(heap_with({"time_step=1/50 contact"}).time_step.fraction_of_contact == 1.0 / 50);
    CHECK(heap_with({"gravity=[0, \"-1.6 m/s^2\"]"}).gravity[1] == -1.6);
    CHECK(heap_with({"gravity[1]=-1.6 m/s^2"}).gravity[1] == -1.6);
    CHECK(heap_with({"audit=true"}).audit);
  }

  TEST_CASE("one of a list of tables is named by place, by name, or by being the only one") {
    CHECK(heap_with({"grain[1].radius=30 mm"}).grains[1].radius == 0.03);
    CHECK(heap_with({"fill.count=3"}).fills[0].count == 3);
    CHECK(heap_with({"fill[0].radius.uniform=[\"9 mm\", 0.01]"}).fills[0].count == 12);
    CHECK(heap_with({"wall[floor].point=[0, -1]"}).walls[0].home[1] == -1);
    CHECK(heap_with({"wall[\"left\"].name=the left one"}).walls[1].name == "the left one");
    CHECK(heap_with({"materials.rock.density=3 t/m^3"}).materials[0].density == 3000);
    CHECK(heap_with({"materials.\"rock\".density=3000"}).materials[0].density == 3000);
  }

  TEST_CASE("tables that the scene leaves out are made; later settings win") {
    CHECK(heap_with({"output.frames_every=5 ms"}).output.frames_every == 0.005);
    CHECK(heap_with({"seed=1", "seed=2"}).seed == 2);
    CHECK(heap_with({"domain={ low = [-1, -1], high = [2, 2] }"}).domain.has_value());
  }

  TEST_CASE("the resolved scene holds what was set") {
    const Scene<2> scene = heap_with({"law.friction=0.3", "fill.count=3", "title=x"});
    const Scene<2> again = parse_scene<2>(to_toml(scene), "again.toml");

    CHECK(again.law.friction == 0.3);
    CHECK(again.fills[0].count == 3);
    CHECK(to_toml(again) == to_toml(scene));
  }

  TEST_CASE("mistakes have the file's sentences and hints, and name the setting as the place") {
    CHECK(refusal_of("law.frction=0.3") ==
          "--set law.frction=0.3: law.frction: unknown key (did you mean \"friction\"?)");
    CHECK(refusal_of("lw.friction=0.3") ==
          "--set lw.friction=0.3: lw: unknown key (did you mean \"law\"?)");
    CHECK(refusal_of("law.friction=-1") ==
          "--set law.friction=-1: law.friction: expected a number that is not negative, got -1");
    CHECK(refusal_of("duration=5 kg") ==
          "--set duration=5 kg: duration: expected a positive time [s], got \"5 kg\"");
    CHECK(
        refusal_of("neighbourhood=grid") ==
        "--set neighbourhood=grid: neighbourhood: expected \"triangulation\", \"linked cells\" or "
        "\"all pairs\", got \"grid\" (did you mean \"linked cells\"?)");
    CHECK(
        refusal_of("fill[0].material=stone")
            .starts_with("--set fill[0].material=stone: fill[0].material: no material \"stone\""));
    CHECK(refusal_of("dimension=4") == "--set dimension=4: dimension: expected 2 or 3, got 4");
    CHECK(scene_error_of([] {
            parse_scene<2>(without(kHeap, "friction = 0.4"), "s.toml", {"law.frction=0.4"});
          }) ==
          "s.toml:10: law.friction: missing; expected a number that is not negative (is "
          "\"frction\" of --set law.frction=0.4 meant?)");
  }

  TEST_CASE("what is no setting, or names nothing of a list, is refused") {
    for (const char* wrong : {"", "=", "seed", "seed=", "=3", ".seed=3", "law..friction=1",
                              "law.friction.=1", "fill[=1", "fill[].count=1", "\"seed=1"}) {
      CAPTURE(wrong);
      CHECK(refusal_of(wrong).find("expected a key, \"=\" and a value") != std::string::npos);
    }
    CHECK(refusal_of("grain[2].radius=1") ==
          "--set grain[2].radius=1: there is no grain[2]: the list has 2, counted from 0");
    CHECK(refusal_of("wall[flor].point=[0, 0]") ==
          "--set wall[flor].point=[0, 0]: there is no wall with name = \"flor\" (did you mean "
          "\"floor\"?)");
    CHECK(refusal_of("grain.radius=1") ==
          "--set grain.radius=1: there are 2 [[grain]]; say which: grain[0], or grain[NAME]");
    CHECK(refusal_of("seed[0]=1") == "--set seed[0]=1: seed is no list");
    CHECK(refusal_of("seed.x=1") == "--set seed.x=1: seed holds a value and no table");
    CHECK(refusal_of("gravity=[0, -1 m/s^2]").find("in a") != std::string::npos);
    CHECK(refusal_of("gravity=[0, -1").starts_with("--set gravity=[0, -1: not valid TOML: "));
  }

  TEST_CASE("a value cannot bring further keys along") {
    CHECK(heap_with({"title=x\nseed = 9"}).seed == 5);
    CHECK(heap_with({"title=x\nseed = 9"}).title == "x\nseed = 9");
  }
}
