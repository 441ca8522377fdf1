// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What every reader of a file owes.

#include <lagrain/check.hpp>

#include <cstdlib>
#include <iostream>
#include <string>

namespace lagrain::test {

/// Calls read(), which may refuse with a SceneError of one line, and nothing else.
template <class Read>
void refuses_in_one_line(Read&& read) {
  std::string message;
  try {
    read();
  } catch (const SceneError& error) {
    message = error.what();
  }
  constexpr std::size_t kLongest = 1500;
  if (message.find('\n') == std::string::npos && message.size() < kLongest) return;
  std::cerr << "not one sentence: " << message << '\n';
  std::abort();
}

}  // namespace lagrain::test
