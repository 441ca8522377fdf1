// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The speed report: a page, its tables as CSV, and plots, all from one run on this machine.

#include "figure.hpp"
#include "speed.hpp"

#include <string>

namespace lagrain::bench {

/// One row per scene and contender: times, ratios and errors.
std::string speed_csv(const SpeedResults& results);

/// One row per scene, contender and round.
std::string rounds_csv(const SpeedResults& results);

/// One row per scene, contender and phase of a step.
std::string phases_csv(const SpeedResults& results);

/// Measures everything and writes speed.html, its CSV files and plots into options.out, anew after
/// every scene; the gallery there gets an entry.
/// @throws Interrupted, after writing what was measured
/// @throws SceneError if the folder cannot be written; SimulationError
void write_speed_report(const FigureOptions& options);

}  // namespace lagrain::bench
