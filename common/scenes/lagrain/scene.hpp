// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// A scene: what a TOML file says, as plain numbers in SI. The physics lives in types; make_run
/// (run.hpp) turns the names into them.

#include <lagrain/body_force.hpp>
#include <lagrain/check.hpp>
#include <lagrain/contact_laws.hpp>
#include <lagrain/gravity.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/touch.hpp>
#include <lagrain/vec.hpp>
#include <lagrain/walls.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace lagrain {

/// The integrators that a scene can name.
enum class IntegratorModel { velocity_verlet, symplectic_euler, fourth_order };
/// The neighbourhoods that a scene can name.
enum class NeighbourhoodModel { triangulation, linked_cells, all_pairs };

/// The words of the scene file.
/// @{
std::string_view name_of(NormalModel model);
std::string_view name_of(FrictionModel model);
std::string_view name_of(IntegratorModel model);
std::string_view name_of(NeighbourhoodModel model);
/// @}

/// Numbers that hold between two materials instead of the scene's own.
struct PairLaw {
  int a = 0;          ///< material
  int b = 0;          ///< material
  LawNumbers law;     ///< the numbers of the law
  bool touch = true;  ///< false: what is made of the two goes through each other
};

/// What grains and walls are made of.
struct Material {
  std::string name;    ///< as the scene calls it
  double density = 0;  ///< [kg/m^3]; 0 if only walls are made of it
};

/// Whether the shares of sizes are shares of the number of grains or of their mass.
enum class Share { number, mass };

/// Radii uniform between two bounds [m].
struct UniformRadius {
  double low = 0;            ///< [m]
  double high = 0;           ///< [m]
  Share by = Share::number;  ///< what is uniform
};

/// Radii [m] picked from a list.
struct ListedRadius {
  std::vector<double> values;   ///< [m]
  std::vector<double> weights;  ///< relative share of each value
  Share by = Share::number;     ///< of what
};

/// Radii as sieves find them: a sieve lets through what is smaller than its openings. Between two
/// sieves the mass is uniform over the sizes.
struct SieveCurve {
  std::vector<double> openings;  ///< diameters, rising [m]
  std::vector<double> passing;   ///< share of the mass that passes each sieve, from 0 to 1 [-]
};

/// One radius [m], or a law of many.
using RadiusLaw = std::variant<double, UniformRadius, ListedRadius, SieveCurve>;

/// How a fill places its grains.
enum class Arrangement { lattice, random };

/// An axis-parallel box.
template <int Dim>
struct Region {
  Vec<Dim> low = Vec<Dim>::Zero();   ///< corner with the lowest coordinates [m]
  Vec<Dim> high = Vec<Dim>::Zero();  ///< corner with the highest ones [m]
};

/// A group of grains that fills an axis-parallel region.
template <int Dim>
struct Fill {
  std::string name;                                ///< as the scene calls it
  int material = 0;                                ///< place among the materials
  std::optional<int> count;                        ///< none: as many as the lattice holds
  RadiusLaw radius;                                ///< of its grains
  Region<Dim> region;                              ///< that holds them
  Arrangement arrangement = Arrangement::lattice;  ///< rows, or places at random
  Vec<Dim> velocity = Vec<Dim>::Zero();            ///< [m/s]
  double random_speed = 0;                         ///< added, in a random direction [m/s]
  SpinVec<Dim> spin = SpinVec<Dim>::Zero();        ///< [rad/s]
  bool pinned = false;                             ///< all of them stay where they are
  bool driven = false;                             ///< all of them keep velocity and spin
};

/// Where grains come in, one by one.
template <int Dim>
struct Inlet {
  std::string name;                                       ///< as the scene calls it
  int material = 0;                                       ///< place among the materials
  RadiusLaw radius;                                       ///< of its grains
  Region<Dim> region;                                     ///< that holds each of them as it comes
  double rate = 0;                                        ///< [1/s]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
  std::optional<int> count;                               ///< in all; none: without a limit
  Vec<Dim> velocity = Vec<Dim>::Zero();                   ///< [m/s]
  double random_speed = 0;                                ///< added, in a random direction [m/s]
};

/// Where grains leave: those whose centres come into its region.
template <int Dim>
struct Outlet {
  std::string name;    ///< as the scene calls it
  Region<Dim> region;  ///< both faces of each side belong to it
};

/// A grain placed by hand.
template <int Dim>
struct PlacedGrain {
  Vec<Dim> position = Vec<Dim>::Zero();      ///< [m]
  double radius = 0;                         ///< [m]
  Vec<Dim> velocity = Vec<Dim>::Zero();      ///< [m/s]
  SpinVec<Dim> spin = SpinVec<Dim>::Zero();  ///< [rad/s]
  int material = 0;                          ///< place among the materials
  bool pinned = false;                       ///< stays where it is
  bool driven = false;                       ///< keeps its velocity and spin

  bool held() const { return pinned || driven; }  ///< no force moves it
};

/// Grains that a file of comma-separated values lists. It is read when the grains are placed.
template <int Dim>
struct GrainFile {
  std::filesystem::path file;  ///< as the program finds it
  /// Place among the materials; none: the file's column says it, or there is only one.
  std::optional<int> material;
  Vec<Dim> shift = Vec<Dim>::Zero();  ///< added to every place in the file [m]
  bool at_rest = false;               ///< without the file's velocities and spins
  bool pinned = false;                ///< all of them stay where they are
  bool driven = false;                ///< all of them keep velocity and spin
};

/// The state of another run, whose grains are there at time 0, with what their contacts remember.
struct StartState {
  std::filesystem::path run;  ///< its folder, or one of its checkpoints
};

/// A time step [s], or a fraction of the shortest contact time.
struct TimeStep {
  double fraction_of_contact = 1.0 / 25;  ///< used if `seconds` is 0
  double seconds = 0;                     ///< [s]
};

/// A region whose stress and solid fraction are columns of the series.
template <int Dim>
struct MeasuredRegion {
  std::string name;    ///< as the scene calls it
  Region<Dim> region;  ///< that is measured
  int slices = 1;      ///< equal parts, each measured for itself
  int axis = Dim - 1;  ///< along which they follow each other
};

/// A plane; what passes through it is columns of the series.
template <int Dim>
struct MeasuredPlane {
  std::string name;                   ///< as the scene calls it
  Vec<Dim> point;                     ///< on it [m]
  Vec<Dim> normal;                    ///< unit, along which passing counts [-]
  std::optional<Region<Dim>> region;  ///< only what passes in it counts; none: all
};

/// How frames are spelled in files.
enum class OutputFormat { csv, vtp, cells, xyz, hdf5 };

/// What a run writes, and how often.
struct OutputPlan {
  double frames_every = 0;                               ///< [s]; 0: first and last frame only
  double series_every = 0;                               ///< [s]; 0: a thousandth of the duration
  bool contacts = false;                                 ///< contacts beside each frame
  std::vector<OutputFormat> formats{OutputFormat::csv};  ///< of the frames
};

/// Everything that a run needs to know. Same scene, same bits.
template <int Dim>
struct Scene {
  std::string file;                  ///< where it was read; empty if built by a program
  std::map<std::string, int> lines;  ///< key -> line in that file, for messages

  std::string title;                                    ///< for people
  std::uint64_t seed = 1;                               ///< of everything random
  double duration = 0;                                  ///< [s]
  TimeStep time_step;                                   ///< of the integrator
  Vec<Dim> gravity = Vec<Dim>::Zero();                  ///< at the start [m/s^2]
  GravityCourse<Dim> gravity_course = SteadyGravity{};  ///< how it changes
  std::optional<Drag<Dim>> drag;                        ///< of a fluid around the grains
  double depth = 1;                                     ///< of a disc [m]; spheres ignore it
  NormalModel normal = NormalModel::linear;             ///< the law along the normal
  FrictionModel friction = FrictionModel::none;         ///< the law of friction
  IntegratorModel integrator = IntegratorModel::velocity_verlet;         ///< of the motion
  NeighbourhoodModel neighbourhood = NeighbourhoodModel::triangulation;  ///< what proposes pairs
  double largest_overlap = kLargestOverlap;  ///< of the smaller radius: beyond it the run stops [-]
  double largest_initial_overlap = 0.01;     ///< of the smaller radius [-]
  bool audit = false;     ///< whether contacts are searched from nothing now and then
  int audit_every = 100;  ///< steps, above 1,000 grains

  LawNumbers law;                             ///< the numbers of the law
  std::vector<PairLaw> pairs;                 ///< between materials
  std::vector<Material> materials;            ///< all that occur
  std::optional<StartState> start;            ///< grains of another run
  std::vector<Fill<Dim>> fills;               ///< groups of grains
  std::vector<PlacedGrain<Dim>> grains;       ///< placed by hand
  std::vector<GrainFile<Dim>> grain_files;    ///< listed in files
  std::vector<Inlet<Dim>> inlets;             ///< where grains come in
  std::vector<Outlet<Dim>> outlets;           ///< where they leave
  std::optional<Region<Dim>> domain;          ///< whose leavers are taken out; none: no limit
  std::vector<Wall<Dim>> walls;               ///< single ones, then the sides of boxes
  std::vector<MeasuredRegion<Dim>> measures;  ///< columns of the series
  std::vector<MeasuredPlane<Dim>> planes;     ///< more columns
  OutputPlan output;                          ///< what is written

  /// The materials that do not touch.
  MaterialsApart apart() const {
    MaterialsApart apart;
    for (const PairLaw& pair : pairs) {
      if (!pair.touch)
        apart.add(static_cast<std::size_t>(pair.a), static_cast<std::size_t>(pair.b));
    }
    return apart;
  }

  /// "file:line: key: message", with what is known of it.
  SceneError error(const std::string& key, const std::string& message) const {
    std::string text;
    if (!file.empty()) {
      text = file + ":";
      if (const auto line = lines.find(key); line != lines.end()) {
        text += std::to_string(line->second) + ":";
      }
      text += " ";
    }
    return SceneError(text + key + ": " + message);
  }
};

/// Keys that are set beside a scene's text, each "law.friction=0.3": a key with its tables, and its
/// value as the scene spells it. Text needs no quotes: "time_step=1/25 contact". One of a list of
/// tables is named by place or by name: "fill[0].count=50", "wall[floor].point=[0, 0]".
using Settings = std::vector<std::string>;

/// The dimension that a scene file, or a setting beside it, names.
/// @throws SceneError if the file cannot be read, is not TOML, or names none
int scene_dimension(const std::filesystem::path& file, const Settings& settings = {});

/// Reads a scene file; every number is checked, the grains are not placed yet. Paths in it begin in
/// its folder.
/// @param settings  which messages name in place of file and line
/// @throws SceneError: one sentence with file, line, key, what was expected and what was found
template <int Dim>
Scene<Dim> read_scene(const std::filesystem::path& file, const Settings& settings = {});

/// The same from text; `name` stands for the file in messages, and paths begin in the program's
/// working folder.
template <int Dim>
Scene<Dim> parse_scene(std::string_view text, const std::string& name,
                       const Settings& settings = {});

/// The scene as TOML with every default filled in. Reading it back gives the same numbers, bit
/// for bit.
template <int Dim>
std::string to_toml(const Scene<Dim>& scene);

}  // namespace lagrain
