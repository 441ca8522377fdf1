// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Small scenes, as text.

#include <lagrain/check.hpp>
#include <lagrain/scene.hpp>

#include <stdexcept>
#include <string>

namespace lagrain::test {

/// Fourteen discs with friction fall into a corner. Every key on its line: messages name them.
inline const std::string kHeap = R"(title = "heap"
dimension = 2
seed = 5
duration = "20 ms"
time_step = "1/25 contact"
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
neighbourhood = "linked cells"
[law]
stiffness = "1e7 N/m"
restitution = 0.5
friction = 0.4
[materials.rock]
density = "2650 kg/m^3"
[materials.gravel]
density = 2000
[[fill]]
material = "gravel"
count = 12
radius = { uniform = ["8 mm", "10 mm"] }
region = { low = [0, 0], high = ["0.1 m", "0.2 m"] }
velocity = [0, -1]
[[grain]]
position = [0.05, 0.3]
radius = "20 mm"
material = "rock"
[[grain]]
position = [0.05, 0.4]
radius = "20 mm"
material = "rock"
velocity = [0, "-2 m/s"]
[[wall]]
name = "floor"
material = "rock"
point = [0, 0]
normal = [0, 1]
[[wall]]
name = "left"
material = "rock"
from = [0, 0]
to = [0, 1]
)";

/// A sphere of steel above a place where a test puts a wall, without friction. It has 13 lines.
inline const std::string kSphere = R"(dimension = 3
duration = 1
gravity = [0, 0, -9.81]
normal = "linear"
friction = "none"
[law]
stiffness = 1e5
restitution = 0.5
[materials.steel]
density = 7800
[[grain]]
position = [0, 0, 1]
radius = 0.1
)";

/// `text` with one part replaced.
inline std::string with(std::string text, const std::string& part, const std::string& instead) {
  const auto at = text.find(part);
  if (at == std::string::npos) throw std::logic_error("no \"" + part + "\" in the scene");
  return text.replace(at, part.size(), instead);
}

/// A scene of discs as one of spheres: every place and direction gets a second component like its
/// first, on the same line, a wall from the origin up becomes a plate, and the layers of the heap
/// are filled. In the plane, the text as it is.
template <int Dim>
std::string in_space(std::string text) {
  if (Dim == 2) return text;
  for (const std::string key :
       {"gravity", "velocity", "position", "point", "normal", "low", "high", "amplitude", "load"}) {
    const std::string head = key + " = [";
    for (std::size_t at = 0; (at = text.find(head, at)) != std::string::npos;) {
      at += head.size();
      const std::string first = text.substr(at, text.find(',', at) - at);
      text.insert(at, first + ", ");
    }
  }
  const std::string upright = "from = [0, 0]\nto = [0, 1]\n";
  if (text.find(upright) != std::string::npos) {
    text = with(text, upright,
                "point = [0, 0, 0]\ncorners = [[0, -1, 0], [0, 1, 0], [0, 1, 1], [0, -1, 1]]\n");
  }
  if (text.find("count = 12") != std::string::npos) text = with(text, "count = 12", "count = 48");
  return with(text, "dimension = 2", "dimension = 3");
}

/// What the scene error says that an action throws; "accepted" if it throws none.
template <class Action>
std::string scene_error_of(Action&& action) {
  try {
    action();
  } catch (const SceneError& error) {
    return error.what();
  }
  return "accepted";
}

inline std::string without(const std::string& text, const std::string& line) {
  return with(text, line + "\n", "");
}

}  // namespace lagrain::test
