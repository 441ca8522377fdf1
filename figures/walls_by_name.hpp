// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The walls of a scene or a run, by name.

#include <lagrain/check.hpp>

#include <algorithm>
#include <string>

namespace lagrain::figures {

/// The wall that has a name.
/// @throws ContractError if none has
auto& wall_named(auto& walls, const std::string& name) {
  const auto at =
      std::find_if(walls.begin(), walls.end(), [&](const auto& wall) { return wall.name == name; });
  LAGRAIN_EXPECTS(at != walls.end(), "no wall \"" + name + "\"");
  return *at;
}

}  // namespace lagrain::figures
