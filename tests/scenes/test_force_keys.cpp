// SPDX-License-Identifier: GPL-3.0-or-later
// Gravity that changes, drag, and driven grains, as scenes say them.

#include <lagrain/checkpoint.hpp>
#include <lagrain/frame.hpp>
#include <lagrain/output.hpp>
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/files.hpp"
#include "support/scene_text.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr const char* kSteadyGravity = "gravity = [0, -9.81]";
constexpr const char* kTurningGravity =
    "gravity = { value = [0, -9.81], rate = \"60 rpm\", start = \"5 ms\", stop = \"15 ms\" }";

std::string refusal(const std::string& text, int dimension = 2) {
  try {
    if (dimension == 2) {
      make_run(parse_scene<2>(text, "scene.toml"));
    } else {
      make_run(parse_scene<3>(text, "scene.toml"));
    }
  } catch (const SceneError& error) {
    return error.what();
  }
  return "accepted";
}

template <int Dim>
bool has_column(const Run<Dim>& run, const std::string& name) {
  const auto columns = series_columns(run);
  return std::any_of(columns.begin(), columns.end(),
                     [&](const SeriesColumn& column) { return column.name == name; });
}

template <int Dim>
void check_round_trip(const std::string& text) {
  const Scene<Dim> scene = parse_scene<Dim>(text, "scene.toml");
  const std::string resolved = to_toml(scene);
  CHECK(to_toml(parse_scene<Dim>(resolved, "again.toml")) == resolved);
}

}  // namespace

TEST_SUITE("keys of forces") {
  TEST_CASE("gravity turns, and is switched") {
    const auto turning =
        make_run(parse_scene<2>(with(kHeap, kSteadyGravity, kTurningGravity), "a"));
    CHECK(has_column(*turning, "gravity_work"));
    CHECK_FALSE(has_column(*make_run(parse_scene<2>(kHeap, "b")), "gravity_work"));
    turning->advance_to(0.02);
    CHECK(turning->ledger().gravity_work != 0);
    CHECK(std::abs(turning->energy_residual()) < 0.02 * std::abs(turning->ledger().kinetic));
    check_round_trip<2>(with(kHeap, kSteadyGravity, kTurningGravity));

    const std::string table =
        "gravity = { times = [0, 0.01, 0.01], values = [[0, -9.81], [0, -9.81], [9.81, 0]] }";
    check_round_trip<2>(with(kHeap, kSteadyGravity, table));
    const auto switched = make_run(parse_scene<2>(with(kHeap, kSteadyGravity, table), "c"));
    CHECK(switched->scene().gravity == Vec<2>(0, -9.81));
    switched->advance_to(0.02);
    CHECK(switched->ledger().gravity_work != 0);
  }

  TEST_CASE("in space gravity turns about an axis") {
    const std::string text =
        with(kSphere, "gravity = [0, 0, -9.81]",
             "gravity = { value = [0, 0, -9.81], axis = [0, 2, 0], rate = 3.5 }");
    check_round_trip<3>(text);
    const auto run = make_run(parse_scene<3>(text, "a"));
    run->advance_to(0.1);
    // g (sin wt, 0, cos wt) downwards, integrated once.
    const Vec<3> velocity = run->velocities().col(0);
    CHECK(relative_error(velocity.z(), -9.81 / 3.5 * std::sin(3.5 * run->time())) < 1e-4);
    CHECK(relative_error(std::abs(velocity.x()), 9.81 / 3.5 * (1 - std::cos(3.5 * run->time()))) <
          1e-3);
  }

  TEST_CASE("what gravity cannot be is refused") {
    const auto refused = [](const std::string& gravity) {
      return refusal(with(kHeap, kSteadyGravity, "gravity = " + gravity));
    };
    CHECK(refused("{ value = [0, -1], axis = [0, 0, 1], rate = 1 }").find("axis") !=
          std::string::npos);
    CHECK(refused("{ value = [0, -1] }").find("gravity.rate: missing") != std::string::npos);
    CHECK(refused("{ value = [0, -1], rate = \"1 m\" }").find("an angular velocity") !=
          std::string::npos);
    CHECK(refused("{ value = [0, -1], rate = 1, start = 2, stop = 1 }").find("after start") !=
          std::string::npos);
    CHECK(refused("{ times = [0, 1], values = [[0, -1]] }").find("one for each of the times") !=
          std::string::npos);
    CHECK(refused("{ times = [1, 0], values = [[0, -1], [0, 1]] }").find("rising times") !=
          std::string::npos);
    CHECK(
        refused("{ times = [1, 1, 1], values = [[0, -1], [0, 1], [1, 0]] }").find("rising times") !=
        std::string::npos);
    CHECK(refused("{ value = [0, -1], rat = 1 }").find("rate") != std::string::npos);
    CHECK(refusal("integrator = \"fourth order\"\n" +
                  with(without(with(with(kHeap, "\"elastic\"", "\"none\""), kSteadyGravity,
                                    kTurningGravity),
                               "friction = 0.4"),
                       "restitution = 0.5", "restitution = 1"))
              .find("but here gravity changes") != std::string::npos);
  }

  TEST_CASE("drag: decay in the plane, Stokes in space") {
    const std::string plane = with(kHeap, "[law]", "[drag]\nrate = 2\nvelocity = [1, 0]\n[law]");
    check_round_trip<2>(plane);
    const auto run = make_run(parse_scene<2>(plane, "a"));
    CHECK(has_column(*run, "drag_work"));
    run->advance_to(0.02);
    CHECK(run->ledger().force_work < 0);

    // A sphere of steel in glycerine sinks at 2 (rho - 0) g r^2 / (9 eta).
    const std::string space = with(with(kSphere, "radius = 0.1", "radius = 0.01"), "[law]",
                                   "[drag]\nviscosity = \"1.4 Pa*s\"\n[law]");
    check_round_trip<3>(space);
    const auto sinking = make_run(parse_scene<3>(space, "b"));
    sinking->advance_to(0.9);
    const double speed = 2 * 7800 * 9.81 * 1e-4 / (9 * 1.4);
    // It has fallen for 7.3 decay times of 2 rho r^2 / (9 eta).
    const double decay = 2 * 7800 * 1e-4 / (9 * 1.4);
    CHECK(relative_error(-sinking->velocities()(2, 0),
                         speed * (1 - std::exp(-sinking->time() / decay))) < 1e-4);
  }

  TEST_CASE("what drag cannot be is refused") {
    const auto refused = [](const std::string& scene, const std::string& drag, int dimension) {
      return refusal(with(scene, "[law]", "[drag]\n" + drag + "\n[law]"), dimension);
    };
    CHECK(refused(kHeap, "viscosity = 1", 2).find("in the plane give a rate") != std::string::npos);
    CHECK(refused(kHeap, "velocity = [0, 1]", 2).find("drag.rate: missing") != std::string::npos);
    CHECK(refused(kHeap, "rate = -1", 2).find("drag.rate") != std::string::npos);
    CHECK(refused(kSphere, "viscosity = \"1 m\"", 3).find("a viscosity") != std::string::npos);
    CHECK(refused(kSphere, "viscosity = 1e9", 3).find("is too large for the drag") !=
          std::string::npos);
  }

  TEST_CASE("driven grains: by hand, as a fill, from a file") {
    const std::string intruder =
        with(kHeap, "velocity = [0, \"-2 m/s\"]", "velocity = [0, -2]\nspin = 3\ndriven = true");
    check_round_trip<2>(intruder);
    const auto run = make_run(parse_scene<2>(intruder, "a"));
    CHECK(run->drives());
    for (const char* column : {"driven_work", "driven.fx", "driven.fy", "driven.torque"}) {
      CHECK(has_column(*run, column));
    }
    run->advance_to(0.02);
    CHECK((run->velocities().col(0).transpose() == Vec<2>(0, -2).transpose() ||
           run->velocities().col(1).transpose() == Vec<2>(0, -2).transpose()));

    const std::string belt =
        with(kHeap, "velocity = [0, -1]", "velocity = [0.5, 0]\nspin = -2\ndriven = true");
    check_round_trip<2>(belt);
    const auto conveyor = make_run(parse_scene<2>(belt, "b"));
    conveyor->advance_to(0.02);
    int driven = 0;
    for (int i = 0; i < conveyor->count(); ++i) {
      driven += conveyor->velocities().col(i) == Vec<2>(0.5, 0) && (*conveyor->spins())(0, i) == -2;
    }
    CHECK(driven == 12);

    const Folder folder;
    REQUIRE(record(*conveyor, {.folder = folder.path, .stop = {}, .progress = {}}));
    const std::string again =
        with(kHeap, "[[wall]]\nname = \"floor\"",
             "[[grains]]\nfile = \"" + (folder.path / "frames/0000.csv").string() +
                 "\"\nshift = [5, 5]\ndriven = true\n[[wall]]\nname = \"floor\"");
    check_round_trip<2>(again);
    CHECK(make_run(parse_scene<2>(again, "c"))->drives());
  }

  TEST_CASE("what is driven is not pinned") {
    CHECK(refusal(with(kHeap, "velocity = [0, \"-2 m/s\"]", "pinned = true\ndriven = true"))
              .find("choose one") != std::string::npos);
    CHECK(refusal(with(kHeap, "velocity = [0, -1]", "pinned = true\nspin = 1"))
              .find("pinned grains stay") != std::string::npos);
  }

  TEST_CASE("a run with all of them goes on from a checkpoint to the same bits") {
    const std::string text =
        with(with(with(kHeap, kSteadyGravity, kTurningGravity), "[law]", "[drag]\nrate = 2\n[law]"),
             "velocity = [0, \"-2 m/s\"]", "velocity = [0, -2]\ndriven = true");
    const auto whole = make_run(parse_scene<2>(text, "a"));
    const auto parted = make_run(parse_scene<2>(text, "b"));
    parted->advance_to(0.008);
    State state;
    parted->persist(StateVisitor::keeping(state));
    const auto again = make_run(parse_scene<2>(text, "c"));
    again->persist(StateVisitor::restoring(decode_checkpoint(encode_checkpoint(state))));
    whole->advance_to(0.02);
    again->advance_to(0.02);
    CHECK(whole->positions() == again->positions());
    CHECK(whole->velocities() == again->velocities());
    CHECK(whole->ledger().gravity_work == again->ledger().gravity_work);
    CHECK(whole->ledger().force_work == again->ledger().force_work);
    CHECK(whole->ledger().driven_work == again->ledger().driven_work);
  }
}
