// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How fast lagrain is, and how fast others are on the same beds: the scenes, and the harness that
/// runs all contenders in turns, so that a busy machine slows them alike.

#include "figure.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace lagrain::bench {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// How good a run was; kUnknown where a contender does not tell. One function for all contenders
/// computes overlaps, contacts and the load from the places at the end.
struct RunErrors {
  double missed = kUnknown;              ///< contacts not in the near list, over all audits
  double audited = kUnknown;             ///< contacts looked for
  double dangerous = kUnknown;           ///< list builds that may have come too late, by LAMMPS
  double energy_residual = kUnknown;     ///< of the energy turned over [-]
  double contacts_per_grain = kUnknown;  ///< between grains
  double mean_overlap = kUnknown;        ///< of the smaller radius [-]
  double largest_overlap = kUnknown;     ///< [-]
  double floor_load = kUnknown;          ///< elastic force on a floor at rest, of the weight [-]
  double near_per_contact = kUnknown;    ///< pairs in the list per contact
  double refreshes = kUnknown;           ///< of the list, per 1,000 steps
  double kinetic = kUnknown;             ///< of translation [J]
  double astray = kUnknown;  ///< largest distance from where the triangulation leaves a grain, of
                             ///< the smallest radius [-]; 0: the same bits
};

/// A part of a step.
struct Phase {
  std::string name;
  double ns = 0;  ///< per grain and step, in the median round
};

struct Contender {
  std::string name;
  std::vector<double> ns;  ///< per grain and step, one for each round
  std::vector<Phase> phases;
  RunErrors errors;  ///< of the first round; lagrain's rounds are the same bits

  double median() const;
  double spread() const;  ///< largest less smallest, of the median [-]
};

/// The time of one contender over that of another with whom it took turns: the median over
/// the rounds.
double ratio(const Contender& a, const Contender& b);

/// All contenders on one scene.
struct SceneSpeed {
  std::string group;  ///< scenes of one table
  std::string name;
  int dimension = 0;
  int grains = 0;
  int steps = 0;         ///< measured in each round
  double time_step = 0;  ///< [s]
  double parameter = 0;  ///< what the group varies: grains, ratio of sizes, speed
  std::vector<Contender> contenders;

  const Contender* find(const std::string& name) const;
};

inline constexpr const char* kTriangulation = "triangulation";
inline constexpr const char* kOracle = "oracle";
inline constexpr const char* kCells = "linked cells";
inline constexpr const char* kRebuilt = "triangulation built anew";
inline constexpr const char* kLammps = "LAMMPS";
inline constexpr const char* kLammpsMulti = "LAMMPS, multi";

inline constexpr const char* kSettledGroup = "Settled beds";
inline constexpr const char* kSizesGroup = "Ratio of sizes";
inline constexpr const char* kImpactGroup = "Impact";
inline constexpr const char* kMovingGroup = "Flow and shaking";
inline constexpr const char* kGrowthGroup = "Number of grains";

struct SpeedResults {
  std::vector<SceneSpeed> scenes;
  std::vector<std::string> notes;  ///< what could not be measured, and why
};

/// Runs every scene. Files of LAMMPS go to folders below options.out.
/// @param lammps the program, if there is one
/// @param after_scene called whenever a scene is done
/// @throws Interrupted, SimulationError
SpeedResults measure_speed(const FigureOptions& options,
                           const std::optional<std::filesystem::path>& lammps,
                           const std::function<void(const SpeedResults&)>& after_scene);

}  // namespace lagrain::bench
