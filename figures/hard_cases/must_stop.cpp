// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases in which a run must stop, and say why.

#include "stone.hpp"
#include "watch.hpp"

#include <lagrain/output.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace lagrain::hard_cases {

namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The places in a frame that `record` has written. Numbers that are none stay what they are.
std::vector<Vec<2>> places_in(const std::filesystem::path& file) {
  std::istringstream text(content(file));
  std::vector<Vec<2>> places;
  std::string line, id, x, y;
  std::getline(text, line);  // the head
  while (std::getline(text, line)) {
    std::istringstream cells(line);
    std::getline(cells, id, ',');
    std::getline(cells, x, ',');
    std::getline(cells, y, ',');
    places.emplace_back(std::stod(x), std::stod(y));
  }
  return places;
}

/// Runs a scene into a folder, and notes what ends it.
/// @return whether last.csv holds all grains at finite places that fulfil a condition
template <class Condition>
bool record_until_it_stops(Run<2>& run, const std::filesystem::path& folder, Outcome& outcome,
                           const StopCheck& check_stop, Condition&& sound) {
  try {
    record(run, {folder,
                 [&] {
                   if (check_stop) check_stop();
                   return false;
                 },
                 {}});
  } catch (const SimulationError& error) {
    outcome.stopped = error.what();
  }
  outcome.steps = run.steps();
  outcome.audited = run.audit().contacts();
  outcome.missed = run.audit().missed();
  const std::vector<Vec<2>> places = places_in(folder / "last.csv");
  const std::string text = content(folder / "last.csv");
  return static_cast<int>(places.size()) == run.count() && text.find("nan") == std::string::npos &&
         text.find("inf") == std::string::npos && std::all_of(places.begin(), places.end(), sound);
}

}  // namespace

NotANumber not_a_number(const std::filesystem::path& folder, const StopCheck& check_stop) {
  NotANumber result;
  // A short tower, and a disc beside it that is to be spoilt.
  Scene<2> scene = stone<2>("not a number", 1e5, 0.5);
  fall(scene);
  scene.friction = FrictionModel::elastic;
  scene.law.friction = 0.5;
  scene.law.tangential_damping = 0.2;
  for (int k = 0; k < 5; ++k) put<2>(scene, {0, (2 * k + 1) * kRadius});
  put<2>(scene, {12 * kRadius, kRadius});
  scene.walls.push_back(Wall<2>::half_space("floor", {0, 0}, {0, 1}));

  try {
    const std::string sound = to_toml(scene), key = "position = [";
    const auto at = sound.find(key) + key.size();
    parse_scene<2>(sound.substr(0, at) + "nan" + sound.substr(sound.find(',', at)), "scene.toml");
  } catch (const SceneError& error) {
    result.in_file = error.what();
  }

  Scene<2> spoilt = scene;
  spoilt.grains[5].velocity.y() = std::numeric_limits<double>::quiet_NaN();
  try {
    make_run(spoilt, 1);
  } catch (const std::exception& error) {
    result.in_program = error.what();
  }

  Scene<2> fast = scene;
  fast.grains[5].velocity.y() = std::numeric_limits<double>::max();
  fast.duration = 1;
  fast.audit = true;
  {
    const auto run = make_run(fast, 1);
    result.last_is_sound = record_until_it_stops(*run, folder, result.overflow, check_stop,
                                                 [](const Vec<2>& x) { return x.allFinite(); });
  }

  fast.grains[5].velocity.y() = 1e150;
  const auto run = make_run(fast, 1);
  watch(*run, 1000, result.huge, check_stop);
  return result;
}

PushedThrough pushed_through_walls(const StopCheck& check_stop) {
  PushedThrough result;
  constexpr double kStiffness = 1e6;  // [N/m]
  Scene<2> scene = stone<2>("lid", kStiffness, 0.5);
  fall(scene);
  for (int k = 0; k < 40; ++k) {
    put<2>(scene, {(1 + 2 * (k % 8)) * kRadius, (1 + 2 * (k / 8)) * kRadius});
  }
  add_tub<2>(scene, {0, 0}, 16 * kRadius);
  Scene<2> crushed = scene;
  // Three times as fast as the contact can stop a disc within the largest overlap.
  const double mass = kDensity * grain_volume<2>(kRadius);
  const double speed = 3 * scene.largest_overlap * kRadius * std::sqrt(kStiffness / mass);
  crushed.walls.push_back(Wall<2>::half_space("lid", {0, 12 * kRadius}, {0, -1}));
  crushed.walls.back().motion = Steady<2>{{0, -speed}};
  watch(*make_run(crushed, 1), 10000, result.lid, check_stop);

  // The lowest discs would sink in by their radius.
  PairLaw soft{0, 1, scene.law};
  soft.law.stiffness = 5 * weight<2>(kRadius) / kRadius;
  scene.materials.push_back({"mud", 0});
  scene.pairs.push_back(soft);
  scene.walls[0].material = 1;
  watch(*make_run(scene, 1), 10000, result.soft_floor, check_stop);
  return result;
}

Shrinking shrinking_box(const std::filesystem::path& folder, const StopCheck& check_stop) {
  constexpr double kSide = 0.3;   // at the start [m]
  constexpr double kSpeed = 0.2;  // of each wall [m/s]
  Scene<2> scene = stone<2>("shrinking box", 1e6, 0.3);
  Fill<2> grains;
  grains.name = "grains";
  grains.count = 100;
  grains.radius = UniformRadius{0.7 * kRadius, kRadius};
  grains.region.low = {0, 0};
  grains.region.high = {kSide, kSide};
  grains.arrangement = Arrangement::random;
  scene.fills.push_back(grains);
  add_tub<2>(scene, {0, 0}, kSide);
  scene.walls.push_back(Wall<2>::half_space("lid", {0, kSide}, {0, -1}));
  for (Wall<2>& wall : scene.walls) {
    wall.motion = Steady<2>{kSpeed * std::get<HalfSpace<2>>(wall.shape).normal};
  }
  scene.duration = kSide / (2 * kSpeed);  // nothing is left of the box then
  scene.audit = true;
  const auto run = make_run(scene, 1);

  Shrinking result;
  result.grains = run->count();
  // The last good state is older than the walls are now: they have come nearer since.
  result.last_is_sound = record_until_it_stops(
      *run, folder, result, check_stop,
      [&](const Vec<2>& x) { return (x.array() > 0).all() && (x.array() < kSide).all(); });
  const double side = kSide - 2 * kSpeed * run->time();
  result.jammed = std::numbers::pi * run->radii().squaredNorm() / (side * side);
  return result;
}

}  // namespace lagrain::hard_cases
