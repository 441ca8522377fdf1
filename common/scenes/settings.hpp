// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the scene reader: keys that are set beside a scene's text (`lagrain run --set`).

#include "toml_table.hpp"

#include <string>

namespace lagrain::detail {

/// Puts a value in the place of what a scene says, or where it says nothing. Whether there is such
/// a key, and what it may hold, is the reader's to say.
/// @param setting  "law.friction=0.3", see Settings (scene.hpp)
/// @throws SceneError if it is no setting, or names a table of a list that is not there
void apply_setting(toml::table& root, const std::string& setting);

}  // namespace lagrain::detail
