// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the scene reader and writer: every key of a scene file and every word that one may
/// hold, spelled once. The page of the scenes (README.md beside this file) explains them; a test
/// holds page and list together.

#include <lagrain/contact_laws.hpp>
#include <lagrain/scene.hpp>
#include <lagrain/units.hpp>

#include <algorithm>
#include <array>
#include <string_view>

namespace lagrain::detail {

/// What a number measures.
struct Measure {
  std::string_view what;  ///< with its article
  Unit unit;
};

inline constexpr Measure kNumber{"a number", {}};
inline constexpr Measure kLength{"a length", {1, 0, 0}};
inline constexpr Measure kTime{"a time", {0, 0, 1}};
inline constexpr Measure kMass{"a mass", {0, 1, 0}};
inline constexpr Measure kRate{"a rate", {0, 0, -1}};
inline constexpr Measure kFrequency{"a frequency", {0, 0, -1}};
inline constexpr Measure kAngle{"an angle", {}};
inline constexpr Measure kAngularVelocity{"an angular velocity", {0, 0, -1}};
inline constexpr Measure kSpeed{"a speed", {1, 0, -1}};
inline constexpr Measure kAcceleration{"an acceleration", {1, 0, -2}};
inline constexpr Measure kForce{"a force", {1, 1, -2}};
inline constexpr Measure kPressure{"a pressure", {-1, 1, -2}};
inline constexpr Measure kDensity{"a density", {-3, 1, 0}};
inline constexpr Measure kViscosityMeasure{"a viscosity", {-1, 1, -1}};

/// A key of a table, and which numbers it accepts if it holds numbers.
struct Key {
  std::string_view name;
  Measure measure = kNumber;
  Range range = Range::any;
};

namespace keys {

inline constexpr Key kTitle{"title"};
inline constexpr Key kDimension{"dimension"};
inline constexpr Key kSeed{"seed"};
inline constexpr Key kDuration{"duration", kTime, Range::positive};
inline constexpr Key kTimeStep{"time_step", kTime, Range::positive};
inline constexpr Key kGravity{"gravity", kAcceleration};
inline constexpr Key kGravityValue{"value", kAcceleration};
inline constexpr Key kGravityValues{"values", kAcceleration};
inline constexpr Key kDepth{"depth", kLength, Range::positive};
inline constexpr Key kNormalLaw{"normal"};
inline constexpr Key kFrictionLaw{"friction"};
inline constexpr Key kIntegrator{"integrator"};
inline constexpr Key kNeighbourhood{"neighbourhood"};
inline constexpr Key kLargestOverlap{"largest_overlap", kNumber, Range::positive};
inline constexpr Key kLargestInitialOverlap{"largest_initial_overlap", kNumber,
                                            Range::not_negative};
inline constexpr Key kAudit{"audit"};
inline constexpr Key kAuditEvery{"audit_every"};

inline constexpr Key kLaw{"law"};
inline constexpr Key kPair{"pair"};
inline constexpr Key kDrag{"drag"};
inline constexpr Key kMaterials{"materials"};
inline constexpr Key kFill{"fill"};
inline constexpr Key kGrain{"grain"};
inline constexpr Key kGrains{"grains"};
inline constexpr Key kInlet{"inlet"};
inline constexpr Key kOutlet{"outlet"};
inline constexpr Key kDomain{"domain"};
inline constexpr Key kWall{"wall"};
inline constexpr Key kBox{"box"};
inline constexpr Key kMeasure{"measure"};
inline constexpr Key kOutput{"output"};

inline constexpr Key kBetween{"between"};
inline constexpr Key kTouch{"touch"};

inline constexpr Key kViscosity{"viscosity", kViscosityMeasure, Range::not_negative};
inline constexpr Key kDragRate{"rate", detail::kRate, Range::not_negative};

inline constexpr Key kMaterialDensity{"density", kDensity, Range::positive};

inline constexpr Key kName{"name"};
inline constexpr Key kMaterial{"material"};
inline constexpr Key kCount{"count"};
inline constexpr Key kRadius{"radius", kLength, Range::positive};
inline constexpr Key kUniform{"uniform", kLength, Range::positive};
inline constexpr Key kValues{"values", kLength, Range::positive};
inline constexpr Key kWeights{"weights", kNumber, Range::not_negative};
inline constexpr Key kBy{"by"};
inline constexpr Key kSieves{"sieves", kLength, Range::positive};
inline constexpr Key kPassing{"passing", kNumber, Range::not_negative};
inline constexpr Key kRegion{"region"};
inline constexpr Key kLow{"low", kLength};
inline constexpr Key kHigh{"high", kLength};
inline constexpr Key kArrangement{"arrangement"};
inline constexpr Key kVelocity{"velocity", kSpeed};
inline constexpr Key kRandomSpeed{"random", kSpeed, Range::not_negative};

inline constexpr Key kRate{"rate", detail::kRate, Range::positive};

inline constexpr Key kPosition{"position", kLength};
inline constexpr Key kPinned{"pinned"};
inline constexpr Key kDriven{"driven"};
inline constexpr Key kSpin{"spin", kAngularVelocity};

inline constexpr Key kFile{"file"};
inline constexpr Key kRun{"run"};
inline constexpr Key kInstant{"time"};
inline constexpr Key kShift{"shift", kLength};
inline constexpr Key kAtRest{"at_rest"};

inline constexpr Key kPoint{"point", kLength};
inline constexpr Key kNormal{"normal", kNumber};
inline constexpr Key kAxis{"axis", kNumber};
inline constexpr Key kFrom{"from", kLength};
inline constexpr Key kTo{"to", kLength};
inline constexpr Key kAlong{"along", kLength};
inline constexpr Key kCorners{"corners", kLength};
inline constexpr Key kPoints{"points", kLength};
inline constexpr Key kLines{"lines", kLength};
inline constexpr Key kClosed{"closed"};
inline constexpr Key kThrough{"through", kLength};
inline constexpr Key kPlates{"plates", kLength};
inline constexpr Key kMesh{"mesh"};
inline constexpr Key kScale{"scale", kNumber, Range::positive};
inline constexpr Key kHeight{"height", kLength, Range::positive};
inline constexpr Key kRadii{"radii", kLength, Range::not_negative};
inline constexpr Key kOpen{"open"};
inline constexpr Key kOpenings{"openings"};
inline constexpr Key kSide{"side"};
inline constexpr Key kBelt{"belt", kSpeed};
inline constexpr Key kSolid{"solid"};
inline constexpr Key kUntil{"until", kTime, Range::positive};

inline constexpr Key kMotion{"motion"};
inline constexpr Key kType{"type"};
inline constexpr Key kStart{"start", kTime, Range::not_negative};
inline constexpr Key kStop{"stop", kTime, Range::positive};
inline constexpr Key kAmplitude{"amplitude", kLength};
inline constexpr Key kFrequency{"frequency", detail::kFrequency, Range::positive};
inline constexpr Key kPistonMass{"mass", kMass, Range::positive};
inline constexpr Key kLoad{"load", kForce};
inline constexpr Key kPressure{"pressure", detail::kPressure, Range::positive};
inline constexpr Key kTimes{"times", kTime, Range::not_negative};
inline constexpr Key kShifts{"shifts", kLength};

inline constexpr Key kTurning{"turning"};
inline constexpr Key kAbout{"about", kLength};
inline constexpr Key kTurningRate{"rate", kAngularVelocity};
inline constexpr Key kAngle{"angle", detail::kAngle};

inline constexpr Key kSlices{"slices"};

inline constexpr Key kFramesEvery{"frames_every", kTime, Range::positive};
inline constexpr Key kFormats{"formats"};
inline constexpr Key kSeriesEvery{"series_every", kTime, Range::positive};
inline constexpr Key kContacts{"contacts"};

}  // namespace keys

/// A key of a law as one of the others.
inline Key key_of(const LawKey& key) {
  return {key.name,
          {key.what, key.unit.empty() ? Unit{} : parse_quantity("1 " + std::string(key.unit)).unit},
          key.range};
}

/// A word of the scene file and what it stands for.
template <class E>
struct Word {
  std::string_view text;
  E value;
};

inline constexpr std::array kIntegratorWords{
    Word<IntegratorModel>{"velocity Verlet", IntegratorModel::velocity_verlet},
    Word<IntegratorModel>{"symplectic Euler", IntegratorModel::symplectic_euler},
    Word<IntegratorModel>{"fourth order", IntegratorModel::fourth_order}};
inline constexpr std::array kNeighbourhoodWords{
    Word<NeighbourhoodModel>{"triangulation", NeighbourhoodModel::triangulation},
    Word<NeighbourhoodModel>{"linked cells", NeighbourhoodModel::linked_cells},
    Word<NeighbourhoodModel>{"all pairs", NeighbourhoodModel::all_pairs}};
inline constexpr std::array kArrangementWords{Word<Arrangement>{"lattice", Arrangement::lattice},
                                              Word<Arrangement>{"random", Arrangement::random}};

inline constexpr std::array kFormatWords{
    Word<OutputFormat>{"csv", OutputFormat::csv}, Word<OutputFormat>{"vtp", OutputFormat::vtp},
    Word<OutputFormat>{"cells", OutputFormat::cells}, Word<OutputFormat>{"xyz", OutputFormat::xyz},
    Word<OutputFormat>{"hdf5", OutputFormat::hdf5}};
/// The one value of `time`.
inline constexpr std::string_view kLastState = "last";
inline constexpr std::array kShareWords{Word<Share>{"number", Share::number},
                                        Word<Share>{"mass", Share::mass}};

/// How a wall can move; a wall without a motion is fixed.
enum class MotionType { steady, shake, path, piston };
inline constexpr std::array kMotionWords{
    Word<MotionType>{"steady", MotionType::steady}, Word<MotionType>{"shake", MotionType::shake},
    Word<MotionType>{"path", MotionType::path}, Word<MotionType>{"piston", MotionType::piston}};

/// From where a thin wall is solid.
inline constexpr std::array kSolidWords{Word<bool>{"both", false}, Word<bool>{"front", true}};

/// How a wall can turn; a wall without it stays upright.
enum class TurningType { steady, swing };
inline constexpr std::array kTurningWords{Word<TurningType>{"steady", TurningType::steady},
                                          Word<TurningType>{"swing", TurningType::swing}};

template <class E, std::size_t N>
constexpr std::string_view text_of(const std::array<Word<E>, N>& words, E value) {
  return std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.value == value; })
      ->text;
}

}  // namespace lagrain::detail
