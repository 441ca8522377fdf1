// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `lagrain sweep`: a scene with several values of some of its keys, all combinations side by side.

#include <lagrain/scene.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lagrain {

/// A key and the values that it takes, in the scene's spelling.
struct Variation {
  std::string key;                  ///< with its tables, as in Settings
  std::vector<std::string> values;  ///< one or more
};

/// Reads "law.friction=0.1,0.3,0.5". Commas within quotes, brackets and braces part no values.
/// @throws SceneError if it is not of that form
Variation read_variation(const std::string& text);

/// What a sweep is made of.
struct SweepPlan {
  std::filesystem::path scene;        ///< file
  std::filesystem::path folder;       ///< where each run gets a folder of its own
  Settings settings;                  ///< of all runs
  std::vector<Variation> variations;  ///< the first one changes slowest
  int jobs = 1;                       ///< runs at a time, each a process with one thread
  std::string plot = "kinetic";       ///< the column of the series that is drawn
  double checkpoint_every = 60;       ///< see RecordOptions [s]
};

/// How far a sweep is.
struct SweepProgress {
  int finished = 0;     ///< runs
  int broken = 0;       ///< runs that broke off
  int runs = 0;         ///< in all
  double fraction = 0;  ///< of all their steps, as if all took equally long [-]
};

/// Runs all combinations. A run that is finished in the folder already, from the same scene, is
/// left as it is; one that was stopped goes on. Then results.csv has a row for each run: what was
/// varied, how it ended, and the last row of its series; and plot.png and plot.pdf show a column of
/// the series against time, if the program has the renderer.
/// @param stop      asked again and again: the runs then keep what they have computed
/// @param progress  told several times a second
/// @throws SceneError before anything is written if one of the scenes is wrong; and after all runs
/// if the column to draw is none
SweepProgress sweep(const SweepPlan& plan, const std::function<bool()>& stop,
                    const std::function<void(const SweepProgress&)>& progress);

}  // namespace lagrain
