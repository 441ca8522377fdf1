// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Scenes with rolling resistance, and fills that are pinned: rough floors.
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/scene_text.hpp"
#include "support/space.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

const std::string kRolling = with(with(kHeap, "\"elastic\"", "\"rolling\""), "friction = 0.4",
                                  "friction = 0.4\nrolling_friction = 0.2\nrolling_damping = 0.5");
const std::string kVelocity = "velocity = [0, -1]";

template <int Dim>
std::string message_of(const std::string& text) {
  return scene_error_of([&] { parse_scene<Dim>(in_space<Dim>(text), "s.toml"); });
}

}  // namespace

TEST_SUITE("rolling keys") {
  TEST_CASE("numbers of rolling are read, kept out of the plane if they twist, and required") {
    const auto flat = parse_scene<2>(kRolling, "s.toml");
    CHECK(flat.law.rolling_friction == 0.2);
    CHECK(flat.law.rolling_damping == 0.5);
    CHECK(flat.law.rolling_stiffness_ratio == 2.0 / 7);
    CHECK(to_toml(flat).find("twisting") == std::string::npos);
    const std::string twisting = with(kRolling, "rolling_damping", "twisting_friction");
    CHECK(parse_scene<3>(in_space<3>(twisting), "s.toml").law.twisting_friction == 0.5);

    CHECK(message_of<2>(twisting) ==
          "s.toml:15: law.twisting_friction: there is no such motion in the plane; remove this "
          "line");
    CHECK(message_of<2>(without(kRolling, "rolling_friction = 0.2")) ==
          "s.toml:10: law.rolling_friction: missing; expected a number that is not negative");
    CHECK(message_of<2>(with(kHeap, "friction = 0.4", "friction = 0.4\nrolling_friction = 0.2")) ==
          "s.toml:14: law.rolling_friction: friction = \"elastic\" does not use it; remove this "
          "line or choose \"rolling\"");
    CHECK(message_of<2>(with(kRolling, "0.2", "-0.2")) ==
          "s.toml:14: law.rolling_friction: expected a number that is not negative, got -0.2");
  }

  TEST_CASE_TEMPLATE("a pinned fill reads back, and its grains stay where they were placed", S,
                     Space<2>, Space<3>) {
    const std::string text = in_space<S::Dim>(with(kRolling, kVelocity, "pinned = true"));
    const auto scene = parse_scene<S::Dim>(text, "s.toml");
    CHECK(scene.fills[0].pinned);
    CHECK(to_toml(parse_scene<S::Dim>(to_toml(scene), "again.toml")) == to_toml(scene));

    const auto run = make_run(scene, 1);
    const Columns<S::Dim> before = run->positions();
    run->advance_to(scene.duration);

    int moved = 0;
    for (int i = 0; i < run->count(); ++i) {
      moved += run->positions().col(i) != before.col(i);
    }
    // The two grains that were placed by hand fall.
    CHECK(moved == 2);
    CHECK(run->count() > 12);
    CHECK(message_of<S::Dim>(with(kRolling, kVelocity, kVelocity + "\npinned = true")) ==
          "s.toml:25: fill[0].velocity: pinned grains stay; remove this line");
  }
}
