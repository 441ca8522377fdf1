// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What the commands of the program say on a terminal while they work.

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace lagrain {

/// One line on a terminal that overwrites itself; nothing elsewhere.
class ProgressLine {
 public:
  ~ProgressLine() { clear(); }

  void show(const std::string& text) {
    if (!terminal_) return;
    // Carriage return, text, and erase what a longer line has left.
    std::fprintf(stderr, "\r%s\x1b[K", text.c_str());
    shown_ = true;
  }
  void clear() {
    if (shown_) std::fputs("\r\x1b[K", stderr);
    shown_ = false;
  }
  bool terminal() const { return terminal_; }

 private:
  bool terminal_ = isatty(STDERR_FILENO) == 1;
  bool shown_ = false;
};

/// Says when something is due that is shown at most ten times a second.
class Pace {
 public:
  bool is_due() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100)) return false;
    last_ = now;
    return true;
  }

 private:
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace lagrain
