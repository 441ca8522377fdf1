// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The lessons: pages that open from disk, in which the library itself runs.
///
/// A lesson is a file NN_name.html in teach/lessons, plain HTML that a teacher can edit, with
///
///     $x^2$, $$x^2$$              formulas (mathml.hpp)
///     {{number NAME}}             a number that the program computes (teach_numbers.hpp)
///     {{value NAME}}              the same with all digits, for attributes; a NAME start.KEY is a
///                                 number of the bench above
///     {{picture NAME | TEXT}}     a picture, and what it shows
///     {{discs START | TEXT}}      a picture of discs that are given
///     {{bench NAME START | TEXT}} what the reader moves, and what its still picture shows
///     {{lesson NN}}               a link
///
/// START is TOML: what the bench begins with (teach_pictures.hpp).

#include <filesystem>

namespace lagrain::figures {

/// What the lessons are made of, and where they go.
struct TeachOptions {
  std::filesystem::path sources;  ///< folder with lessons/, pages/, lab.css and playground.html
  std::filesystem::path module;   ///< lagrain.js; if it is not there, nothing moves
  std::filesystem::path out;      ///< folder for the pages
};

/// What was written.
struct TeachReport {
  int lessons = 0;
  bool moves = false;  ///< whether the compiled library is in the pages
};

/// Writes the lessons, their index, and the playground, which is one file with everything in it.
/// @throws SceneError: one sentence with file and line, if a lesson lacks something or asks for
/// what there is not, or a file cannot be read or written
TeachReport write_lessons(const TeachOptions& options);

}  // namespace lagrain::figures
