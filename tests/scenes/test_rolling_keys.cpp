// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Scenes with rolling resistance.
#include <lagrain/scene.hpp>

#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

const std::string kRolling = with(with(kHeap, "\"elastic\"", "\"rolling\""), "friction = 0.4",
                                  "friction = 0.4\nrolling_friction = 0.2\nrolling_damping = 0.5");

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
}
