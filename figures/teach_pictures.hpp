// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The pictures of the lessons: by name, or of what a bench starts from.

#include <lagrain/display_list.hpp>

#include "toml_library.hpp"

#include <string>
#include <vector>

namespace lagrain::figures {

/// A picture that the lessons call by its name.
/// @throws SceneError for an unknown name
DisplayList lesson_picture(const std::string& name);

/// The names of all of them.
std::vector<std::string> lesson_pictures();

/// What a bench shows before anybody touches it.
/// @param bench  "discs", "grains", "signs", "work", "lifting", "flips" or "space"
/// @param start  as the lesson has it, completed
/// @throws SceneError for an unknown bench, or a start that it cannot show
DisplayList picture_of_bench(const std::string& bench, const toml::table& start);

/// Puts into a start what its bench is not to choose by itself: discs at random places, the
/// triangles that flips begin with if the lesson gives none, the names of integrators.
void complete_start(const std::string& bench, toml::table& start);

}  // namespace lagrain::figures
