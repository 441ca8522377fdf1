// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Scenes that are hard for a program of this kind. Every case is a function that runs its scene
/// and returns what happened, as numbers: the tests assert on them, figure 18 shows them. Each
/// heading below has its file in hard_cases/. Without a StopCheck a case runs to its end.

#include "figure.hpp"

#include <lagrain/scene.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lagrain::hard_cases {

/// What one asks of every run.
struct Outcome {
  std::int64_t steps = 0;
  std::int64_t audited = 0;  ///< contacts found from nothing, every few steps
  std::int64_t missed = 0;   ///< of these, not in the near list
  int lost = 0;              ///< grains behind a wall, or nowhere, at the end
  std::string stopped;       ///< the error that ended the run; empty: it came to its end
};

// ---- At rest -----------------------------------------------------------------------------------

enum class Crystal { square, hexagonal, face_centred };

/// A crystal of touching frictionless grains in a tub: every tie that there is, and gravity.
struct CrystalAtRest : Outcome {
  int grains = 0;
  int contacts = 0;        ///< between grains, at the end
  int brute_force = 0;     ///< the same, found by an independent search
  int strangers = 0;       ///< of these, between grains that did not touch at the start
  double move = 0;         ///< largest move of a grain, of its radius [-]
  double sink = 0;         ///< mean way down of the grains [m]
  double explained = 0;    ///< the same by Clapeyron's theorem from the contact forces [m]
  double floor_error = 0;  ///< force on the floor against the weight, relative [-]
};
CrystalAtRest crystal_at_rest(Crystal crystal, const StopCheck& check_stop = {});

/// The number of steps, and the largest relative error of a contact force then.
struct TowerSample {
  double steps;
  double error;
};

/// Discs on top of each other, put down without overlap: contact m from the top must carry m
/// weights once the tower has come to rest.
struct Tower : Outcome {
  std::vector<TowerSample> samples;
  std::vector<double> force;  ///< of contact m from the top, m = 1, 2, ..., in weights [-]
  double decay = 0;           ///< of the tower's slowest mode, by theory [1/step]
  /// What the last bit of a place makes of the force of the top contact, relative [-].
  double last_bit = 0;
};
Tower tower(int height, std::int64_t steps, const StopCheck& check_stop = {});

/// A grain of 1,000 times their density on two discs (four spheres) that touch, between walls.
struct HeavyOnLight : Outcome {
  double floor_error = 0;  ///< force on the floor against the weight, relative [-]
  double wall_error = 0;   ///< thrust on a side wall against that of rigid grains, relative [-]
  double overlap = 0;      ///< largest, of the radius [-]
  double decay = 0;        ///< of the heavy grain's swing, by theory [1/step]
};
template <int Dim>
HeavyOnLight heavy_on_light(const StopCheck& check_stop = {});

/// Three hundred discs run into the cleft beneath the flank of one that is 1,000 times larger.
struct GiantAndDust : Outcome {
  std::int64_t giant_contacts = 0;  ///< with the dust, at the end
  double giant_move = 0;            ///< of its radius [-]
  double overlap = 0;               ///< largest at the end, of the smaller radius [-]
  double residual = 0;              ///< of the ledger, of the energy that contacts have taken [-]
  std::int64_t rebuilds = 0;        ///< of the triangulation
};
GiantAndDust giant_and_dust(const StopCheck& check_stop = {});

/// A disc of a thousandth of their radius in the cleft between two discs on a floor.
struct Wedge : Outcome {
  double force = 0;        ///< on either flank of the small disc, of its weight [-]
  double closed_form = 0;  ///< the same from the equilibrium of the three discs [-]
  double overlap = 0;      ///< of the small disc, of its radius [-]
};
Wedge tiny_disc_between_giants(const StopCheck& check_stop = {});

// ---- Degenerate places -------------------------------------------------------------------------

/// Equal elastic grains in a row, apart; the first one is sent against the others.
struct Row : Outcome {
  double speed = 0;     ///< of the last grain in the end, of the first one's at the start [-]
  double bound = 0;     ///< how far that may be from 1 by the errors of so many collisions [-]
  double momentum = 0;  ///< change of the whole, relative [-]
  double sideways = 0;  ///< largest distance of a grain from the row, of its radius [-]
};
/// @param slanted  along the diagonal, on which places are rounded; else along an axis
template <int Dim>
Row row_of_grains(bool slanted, const StopCheck& check_stop = {});

/// All grains at the same point.
struct OnePlace {
  std::string refused;  ///< what a scene says to it
  std::string stopped;  ///< what the run says if the scene allows it
  Outcome free;         ///< what happens if the run allows it too
  int grains = 0;
  int pairs = 0;          ///< near pairs at the start
  double momentum = 0;    ///< at the end, of the sum of the magnitudes [-]
  double separation = 0;  ///< smallest distance of two grains at the end, of their diameter [-]
};
template <int Dim>
OnePlace all_in_one_place(const StopCheck& check_stop = {});

/// A crystal far from the origin against the same at the origin.
struct FarAway : Outcome {
  double last_bit = 0;       ///< of a coordinate, of the radius [-]
  double overlap_error = 0;  ///< largest difference of an overlap at rest, of the radius [-]
  double bound = 0;          ///< on that, by the places' last bit [-]
  double force_error = 0;    ///< largest difference of a contact force, of a grain's weight [-]
};
/// @param distance  of the crystal's corner from the origin along every axis, in radii
FarAway far_from_origin(double distance, const StopCheck& check_stop = {});

/// A disc of the given radius that bounces off one of 1 km.
struct Bounce {
  double radius = 0;       ///< [m]
  double speed_error = 0;  ///< at the end, against the closed form, of the speed of impact [-]
  double bound = 0;        ///< on that, by the step and by the last bit of the distance [-]
  bool over = false;       ///< false: it is still in contact, the closed form says so as well
};

/// Discs of 1 um, 1 mm and 1 m that hit a disc of 1 km in one scene.
struct Scales : Outcome {
  std::vector<Bounce> bounces;
};
Scales nine_decades_of_radii(std::int64_t steps, const StopCheck& check_stop = {});

// ---- Speed and step ----------------------------------------------------------------------------

/// Discs shot head-on at an equal one that is pinned, from places spread over one step's way.
struct FastGrain : Outcome {
  double way = 0;  ///< in a step, in radii [-]
  int shots = 0;
  int bounced = 0;
  int refused = 0;          ///< stopped by the run for a deep overlap
  int crossed = 0;          ///< stopped because they passed through between two steps
  int unseen = 0;           ///< came out on the far side, and the run went on
  std::string refusal;      ///< what the run said of a deep overlap, the last time
  std::string passage;      ///< what it said of a disc that passed through, the last time
  double expected = 0;      ///< share that crosses: no step ends in a deep overlap before [-]
  double bounce_up_to = 0;  ///< the way in a step up to which a bounce keeps to the limit, in radii
};
FastGrain fast_grain(double way, int shots, const StopCheck& check_stop = {});

/// The answer to a time step of so many safe ones: empty if it is accepted.
std::string refusal_of_step(double safe_steps);

/// Elastic head-on collisions of two discs by Hertz's law at a step of so many safe ones. Beyond
/// one the run is deceived: the scene names an impact speed that is too low.
struct StepSize : Outcome {
  double safe_steps = 0;
  double energy_error = 0;   ///< worst of all phases, relative [-]
  double overlap_error = 0;  ///< of the deepest overlap against Hertz's, worst, relative [-]
};
StepSize collisions_at_step(double safe_steps, const StopCheck& check_stop = {});

// ---- Long runs ---------------------------------------------------------------------------------

/// A pile and when it was so.
struct PileSample {
  double time;     ///< [s]
  double kinetic;  ///< [J]
  double top;      ///< centre of the highest disc [m]
};

/// A column of discs that collapses on a floor of pinned ones.
struct Pile : Outcome {
  int grains = 0;  ///< without the pinned ones
  std::vector<PileSample> samples;
  double drift = 0;          ///< largest move in the last tenth of the run, of the radius [-]
  double drift_seconds = 0;  ///< that tenth [s]
  double crawl = 0;  ///< speed at which a step changes no place by half of its last bit [radii/s]
  double rounding_floor = 0;  ///< kinetic energy if all discs are as slow as that [J]
  double creep = 0;           ///< scale of the speed at which viscous contacts give way [radii/s]
  double unbalanced = 0;      ///< largest force left on a grain at the end, of its weight [-]
};
/// @param friction  elastic: the pile must stand. Viscous: it creeps.
Pile pile(FrictionModel friction, std::int64_t steps, const StopCheck& check_stop = {});

/// Grain-steps, and how far the energy is from the start's then.
struct GasSample {
  double grain_steps;
  double drift;  ///< relative [-]
};

/// Elastic discs in a box.
struct Gas : Outcome {
  int grains = 0;
  std::vector<GasSample> samples;
  double collisions = 0;  ///< of grains: from the mean number of open contacts, a contact time each
  /// Standard deviation of the energy at the end if every collision errs independently,
  /// relative [-].
  double random_walk = 0;
  double open_contacts = 0;  ///< what the largest number of open contacts may add, relative [-]
};
Gas elastic_gas(std::int64_t grain_steps, const StopCheck& check_stop = {});

// ---- What must stop ----------------------------------------------------------------------------

/// Numbers that are none.
struct NotANumber {
  std::string in_file;         ///< what a scene file with a NaN is told
  std::string in_program;      ///< what a program that hands over a NaN is told
  Outcome overflow;            ///< a grain so fast that its place overflows in the run
  bool last_is_sound = false;  ///< last.csv holds all grains, and finite numbers alone
  Outcome huge;                ///< a grain at 1e150 m/s, whose square overflows
};
/// @param folder  for the run that breaks off; made, and overwritten
NotANumber not_a_number(const std::filesystem::path& folder, const StopCheck& check_stop = {});

/// Discs under a lid that comes down much too fast, and on a floor that is much too soft.
struct PushedThrough {
  Outcome lid;
  Outcome soft_floor;
};
PushedThrough pushed_through_walls(const StopCheck& check_stop = {});

/// A box whose four walls move inwards until nothing fits.
struct Shrinking : Outcome {
  int grains = 0;
  double jammed = 0;           ///< solid fraction when the run stopped [-]
  bool last_is_sound = false;  ///< last.csv holds all grains, finite and within the box
};
/// @param folder  for the run; made, and overwritten
Shrinking shrinking_box(const std::filesystem::path& folder, const StopCheck& check_stop = {});

}  // namespace lagrain::hard_cases
