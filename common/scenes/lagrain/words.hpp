// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Words in messages: what somebody wrote is shown short and without what a terminal would obey,
/// and the word that was meant is named.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lagrain {

/// Text with control characters as escapes: "\n", "\t", "\u001B". What is no UTF-8 becomes "\xNN".
std::string readable(std::string_view text);

/// The same with at most so many characters, and "..." for the rest.
std::string shortened(std::string_view text, std::size_t most = 60);

/// The same in quotes, as messages show what stands somewhere.
std::string shown(std::string_view text);

/// The known word that is most like `word`, capitals or not; empty if none is like it. A word that
/// holds the other is like it as well: "Verlet" and "velocity Verlet".
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

/// ` (did you mean "x"?)` for the nearest word, or nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

/// Significant digits for people of a limit that must not be exceeded: never more than the value.
/// @pre value > 0
std::string rounded_down(double value, int digits = 3);

}  // namespace lagrain
