// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `Stopwatch` measures wall-clock time.

#include <chrono>

namespace lagrain {

/// Measures wall-clock time from where it is made. One that is off asks no clock, and shows 0.
class Stopwatch {
 public:
  /// Starts the watch.
  explicit Stopwatch(bool on = true) : on_(on), start_(on ? Clock::now() : Clock::time_point{}) {}

  /// Time since the start [s].
  double seconds() const {
    return on_ ? std::chrono::duration<double>(Clock::now() - start_).count() : 0;
  }

 private:
  using Clock = std::chrono::steady_clock;
  bool on_;
  Clock::time_point start_;
};

}  // namespace lagrain
