// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/scene.hpp>

#include <lagrain/check.hpp>

#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <string>
#include <variant>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// Line 15 is the first line of the wall's keys.
const std::string kSpace = kSphere + "[[wall]]\n";

template <int Dim>
std::string message_of(const std::string& text) {
  return scene_error_of([&] { parse_scene<Dim>(text, "s.toml"); });
}

std::string in_space_with(const std::string& keys) { return message_of<3>(kSpace + keys); }

std::string in_the_plane_with(const std::string& keys) {
  std::string text = with(kSpace, "dimension = 3", "dimension = 2");
  text = with(text, "[0, 0, -9.81]", "[0, -9.81]");
  return message_of<2>(with(text, "[0, 0, 1]", "[0, 1]") + keys);
}

/// One sentence: a file, a line, and no full stop but in numbers and the file's name.
bool is_one_sentence(const std::string& message) {
  return message.find(". ") == std::string::npos && message.find('\n') == std::string::npos &&
         message.substr(0, 7) == "s.toml:" && message.back() != '.';
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_SUITE("plates in scenes") {
  TEST_CASE("a plate is given by its corners, from the origin or from a point") {
    const auto wall = [](const std::string& keys) {
      return parse_scene<3>(kSpace + keys, "s.toml").walls.at(0);
    };
    const auto plain = wall("corners = [[1, 2, 3], [\"2 m\", 2, 3], [1, \"250 cm\", 3]]\n");
    CHECK(plain.home == Vec<3>(1, 2, 3));
    CHECK(plain.point == plain.home);
    CHECK(plain.corners() == std::vector<Vec<3>>{{1, 2, 3}, {2, 2, 3}, {1, 2.5, 3}});

    const auto moved = wall(
        "point = [1, 0, 0]\ncorners = [[1, 2, 3], [2, 2, 3], [2, 3, 3], [1, 3, 3]]\n"
        "motion = { type = \"steady\", velocity = [0, 0, 1] }\n");
    CHECK(moved.home == Vec<3>(1, 0, 0));
    CHECK(moved.corners() == std::vector<Vec<3>>{{2, 2, 3}, {3, 2, 3}, {3, 3, 3}, {2, 3, 3}});
    CHECK(moved.moves());
  }

  TEST_CASE("a plate reads back from the resolved scene bit for bit") {
    for (const std::string keys :
         {"corners = [[0.1, 0.2, 0.3], [1.7, 0.1, 0.3], [0.3, 0.7, 0.3]]\n",
          "point = [0.1, 0.7, -0.3]\n"
          "corners = [[0.1, 0.2, 0.3], [1.7, 0.1, 0.3], [0.3, 0.7, 0.3]]\n"
          "motion = { type = \"shake\", amplitude = [0, 0, 0.1], frequency = 3 }\n",
          "corners = [[1e-3, 0.1, 0.2], [1.1e-3, 0.1, 0.2], [1.1e-3, 0.10033333333333333, 0.2], "
          "[1e-3, 0.1004, 0.2]]\n",
          // Far away from its own size.
          "corners = [[1000.1, 0.2, 0.3], [1001.7, 0.1, 0.3], [1000.3, 0.7, 0.3]]\n"}) {
      CAPTURE(keys);
      const Scene<3> once = parse_scene<3>(kSpace + keys, "s.toml");

      const std::string resolved = to_toml(once);
      const Scene<3> twice = parse_scene<3>(resolved, "s.toml");

      CHECK(to_toml(twice) == resolved);
      CHECK(twice.walls[0].home == once.walls[0].home);
      CHECK(twice.walls[0].point == once.walls[0].point);
      const auto& a = std::get<Plate>(once.walls[0].pieces()->piece(0));
      const auto& b = std::get<Plate>(twice.walls[0].pieces()->piece(0));
      CHECK(a.corners() == b.corners());
      CHECK(a.normal() == b.normal());
      CHECK(a.size() == b.size());
      CHECK(twice.walls[0].corners() == once.walls[0].corners());
    }
  }

  TEST_CASE("from and to make no wall in space, and the message says what does") {
    for (const std::string keys :
         {"from = [0, 0, 0]\nto = [1, 1, 0]\n", "from = [0, 0, 0]\nalong = [1, 1, 0]\n",
          "to = [1, 1, 0]\n", "from = [0, 0]\nto = [1, 1]\n", "along = [1, 1, 0]\n",
          "from = [0, 0, 0]\n"}) {
      CAPTURE(keys);
      const std::string message = in_space_with(keys);
      CHECK(has(message, "corners"));
      CHECK(is_one_sentence(message));
    }
    CHECK(in_space_with("from = [0, 0, 0]\nto = [1, 1, 0]\n") ==
          "s.toml:15: wall[0].from: in space a line has no thickness to touch; give the corners of "
          "a plate: corners = [[x, y, z], [x, y, z], [x, y, z], ...]");
    // A wall without a shape tells of all that there are.
    const std::string none = in_space_with("name = \"w\"\n");
    CHECK(has(none, "point and normal"));
    CHECK(has(none, "corners"));
    CHECK(!has(none, "from and to"));
    CHECK(has(in_the_plane_with("name = \"w\"\n"), "from and to"));
    CHECK(!has(in_the_plane_with("name = \"w\"\n"), "corners"));
  }

  TEST_CASE("corners make no wall in the plane, and the message says what does") {
    for (const std::string keys :
         {"corners = [[0, 0], [1, 0]]\n", "corners = [[0, 0], [1, 0], [1, 1]]\n",
          "corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n",
          "point = [0, 0]\ncorners = [[0, 0], [1, 0]]\n", "corners = 3\n"}) {
      CAPTURE(keys);
      const std::string message = in_the_plane_with(keys);
      CHECK(has(message, "corners"));
      CHECK(has(message, "from and to"));
      CHECK(is_one_sentence(message));
    }
  }

  TEST_CASE("corners that make no plate are refused with the reason") {
    const auto check = [](const std::string& corners, const std::string& reason) {
      const std::string message = in_space_with("corners = " + corners + "\n");
      CAPTURE(message);
      CHECK(has(message, "s.toml:15: wall[0].corners"));
      CHECK(has(message, reason));
      CHECK(is_one_sentence(message));
    };
    check("[[0, 0, 0], [1, 0, 0]]", "a plate needs at least 3 corners");
    check("[[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]]", "corner 2 and corner 3 are one point");
    check("[[0, 0, 0], [1, 1, 0], [2, 2, 0]]", "the corners lie on a line");
    check("[[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]]", "does not lie in a plane");
    check("[[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0], [0, 2, 0]]", "no convex polygon");
    check("[[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]", "the edges cross each other");
    check("[]", "expected a list of points");
    check("7", "expected a list of points");
    check("[1, 2, 3]", "expected [x, y, z]");
    check("[[0, 0], [1, 0], [1, 1]]", "expected [x, y, z]");
    check("[[0, 0, 0], [1, 0, 0], [1, 1]]", "expected [x, y, z]");
    check("[[0, 0, 0], [1, 0, 0], [1, \"1 s\", 0]]", "1 s");
    check("[[0, 0, 0], [1, 0, 0], [1, nan, 0]]", "nan");
    check("[[0, 0, 0], [1, 0, 0], [1, inf, 0]]", "inf");
    check("[[0, 0, 0], [1, 0, 0], {x = 1}]", "expected [x, y, z]");
  }

  TEST_CASE("a plate with the keys of another shape is refused") {
    const std::string corners = "corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n";
    CHECK(has(in_space_with(corners + "normal = [0, 0, 1]\n"), "wall[0].normal"));
    CHECK(has(in_space_with(corners + "from = [0, 0, 1]\n"), "wall[0].from"));
    CHECK(has(in_space_with(corners + "to = [0, 0, 1]\n"), "wall[0].to"));
    CHECK(has(in_space_with(corners + "along = [0, 0, 1]\n"), "wall[0].along"));
    CHECK(has(in_space_with(corners + "axis = [0, 0, 1]\n"), "wall[0].axis"));
    CHECK(has(in_space_with("point = [0, 0, 0]\nradius = 1\naxis = [0, 0, 1]\n" + corners),
              "wall[0].corners"));
    CHECK(in_space_with(corners) == "accepted");
    CHECK(has(in_space_with(with(corners, "corners", "corner")), "did you mean \"corners\"?"));
  }
}
