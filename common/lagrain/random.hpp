// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Random numbers that are the same on every platform: the standard fixes the engine's output but
/// not its distributions, so the distributions are ours.

#include <lagrain/state.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

namespace lagrain {

/// Seeded generator. Same seed, same numbers, everywhere.
class Random {
 public:
  /// @param seed  any number; another one gives another sequence
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform integer in [0, count); the bias is below count / 2^53.
  int below(int count) { return static_cast<int>(uniform() * count); }

  /// Normal with mean 0 and standard deviation 1 (Box and Muller, Ann. Math. Stat. 29 (1958) 610).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

  /// Keeps or restores where it is in its sequence, in the words of the standard library.
  void persist(StateVisitor visit) {
    std::stringstream text;
    text << engine_;
    std::string words = text.str();
    visit("engine", words);
    std::stringstream restored(words);
    if (!(restored >> engine_)) throw SceneError("its random numbers cannot be read");
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace lagrain
