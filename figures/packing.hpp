// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Packings of spheres under a piston, as figures 6, 7 and 9 need them: run, shaken, measured.

#include "figure.hpp"

#include <lagrain/display_list.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/run.hpp>

#include <Eigen/Geometry>

#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

/// The density of the closest packings of equal spheres, pi / (3 sqrt 2) (Hales, Annals of
/// Mathematics 162 (2005) 1065).
inline constexpr double kClosestPacking = std::numbers::pi / (3 * std::numbers::sqrt2);

/// How a box is shaken: all its walls but the piston, along (1, 0, 1).
inline constexpr double kShakeAmplitude = 0.004;  ///< along each of the two axes [m]
inline constexpr double kShakeFrequency = 12;     ///< [Hz]
inline constexpr double kShakeStart = 2;          ///< [s]
inline constexpr double kRest = 0.5;              ///< after the shaking [s]

/// A scene to run, and under what name its results are kept.
struct PackingJob {
  std::string name;
  Scene<3> scene;
};

/// What is left of a run.
struct Packing {
  std::string name;
  std::vector<double> time;      ///< [s]
  std::vector<double> density;   ///< at these times, by the piston's height [-]
  Columns<3> position;           ///< at the end, 3 x N [m]
  Eigen::VectorXd radius;        ///< N [m]
  Eigen::AlignedBox3d box;       ///< inside the walls, at the end
  Eigen::AlignedBox3d at_first;  ///< the same at time 0
  double bulk = 0;               ///< density of the Laguerre cells away from all walls [-]
  int bulk_count = 0;            ///< cells in that
  double edges_per_site = 0;
  double seconds = 0;            ///< wall clock
  ContactStatistics statistics;  ///< at the end
  double largest_overlap = 0;    ///< at any sample, of the smaller radius [-]
  std::int64_t audited = 0, missed = 0;
  TriangulationCost cost;
  std::int64_t steps = 0;
  double neighbourhood_share = 0;  ///< of the wall clock [-]
  double residual_share = 0;       ///< energy residual, of what was dissipated [-]

  double final_density() const { return density.back(); }
};

/// The scene of a file; with `quick` an eighth as many grains of twice the radius.
Scene<3> packing_scene(const FigureOptions& options, const std::string& file);

/// A scene whose box is shaken from kShakeStart on for a whole number of periods, then left alone.
/// @param seconds  of shaking, about
Scene<3> shaken(Scene<3> scene, double seconds);

/// A scene with another friction between all grains and walls. Without friction (0) spin and memory
/// are left out altogether.
Scene<3> with_friction(Scene<3> scene, double friction);

/// Runs the jobs, as many at once as there are cores; a job that was run before in this process is
/// not run again. Jobs come back in their order. Density against time is written to `csv`, also of
/// jobs that the user interrupts.
/// @throws Interrupted, SceneError, SimulationError
std::vector<Packing> run_packings(const std::vector<PackingJob>& jobs, const FigureOptions& options,
                                  const std::filesystem::path& csv);

/// Density within the Laguerre cells of the grains that keep a distance of three largest radii from
/// all walls. @returns density and number of cells; NaN without any
std::pair<double, int> bulk_density(const Columns<3>& position, const Eigen::VectorXd& radius,
                                    const Eigen::AlignedBox3d& box);

/// Positions and radii of a packing at its end as CSV.
std::string packing_csv(const Packing& packing);

/// A density as the figures print it, with three significant digits.
std::string digits(double density);

/// How far a density lies from the paper's, with its sign: "+0.012".
std::string difference_text(double density, double paper);

/// The density away from the walls and of how many cells it is, in words.
std::string bulk_text(const Packing& packing);

/// Says of a row of the paper how a quick figure differs from it.
std::string quick_text(bool quick);

/// Density against time.
Series density_series(const Packing& packing, int index, double from);

/// What colours the spheres of a picture.
enum class ColourBy { height, radius };

/// Adds a picture of a packing in its box, the piston a pane of glass if it has come down, and
/// a line of text below.
/// @param low  lower left corner on the page [pt]
/// @param width of the picture, which is a square [pt]
void add_packing(DisplayList& list, const Vec<2>& low, double width, const Packing& packing,
                 ColourBy by, bool quick, const std::string& text);

/// Adds a title whose top is at the given place [pt].
void add_title(DisplayList& list, const Vec<2>& at, const std::string& text);

/// Facts for the gallery: what the runs of a figure cost and what was checked.
std::vector<Fact> packing_facts(const std::vector<Packing>& packings);

}  // namespace lagrain::figures
