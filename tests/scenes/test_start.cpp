// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Scenes that start from the state of another run.

#include <lagrain/checkpoint.hpp>
#include <lagrain/files.hpp>
#include <lagrain/output.hpp>

#include "support/cases.hpp"
#include "support/files.hpp"
#include "support/scene_text.hpp"
#include "support/space.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <memory>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

/// Without dashpots a force depends on where grains are and what contacts remember, and on nothing
/// that happened in the step before: bits can be compared. Strong gravity keeps grains in contact.
const std::string kElastic = with(with(kHeap, "restitution = 0.5", "restitution = 1"),
                                  "gravity = [0, -9.81]", "gravity = [0, -200]");

/// `text` without its grains.
std::string emptied(const std::string& text) {
  const auto first = text.find("[[fill]]"), walls = text.find("[[wall]]");
  return text.substr(0, first) + text.substr(walls);
}

std::string started_from(const fs::path& run) {
  return "[start]\nrun = \"" + run.string() + "\"\n";
}

template <int Dim>
std::unique_ptr<Run<Dim>> recorded(const std::string& text, const fs::path& folder) {
  auto run = make_run(parse_scene<Dim>(text, "bed.toml"));
  REQUIRE(record(*run, {folder, {}, {}}));
  return run;
}

/// The same, ended a step after two grains have met.
template <int Dim>
std::unique_ptr<Run<Dim>> recorded_in_contact(const std::string& text, const fs::path& folder) {
  auto run = make_run(parse_scene<Dim>(text, "bed.toml"));
  while (run->statistics().contacts == 0 && !run->finished()) run->step();
  run->step(8);
  REQUIRE_FALSE(record(*run, {folder, [] { return true; }, {}}));
  REQUIRE(run->statistics().contacts > 0);
  return run;
}

template <int Dim>
std::unique_ptr<Run<Dim>> made(const std::string& text) {
  return make_run(parse_scene<Dim>(text, "s.toml"));
}

}  // namespace

TEST_SUITE("a start from another run's state") {
  TEST_CASE_TEMPLATE("goes on as that run goes on", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const std::string friction : {"elastic", "rolling"}) {
      CAPTURE(friction);
      std::string text = with(in_space<Dim>(kElastic), "friction = \"elastic\"",
                              "friction = \"" + friction + "\"");
      if (friction == "rolling") {
        text = with(text, "friction = 0.4\n",
                    "friction = 0.4\nrolling_friction = 0.2\nrolling_damping = 0\n");
      }
      const Folder bed;
      const auto before = recorded_in_contact<Dim>(text, bed.path);
      const auto run = made<Dim>(emptied(text) + started_from(bed.path));
      REQUIRE(run->count() == before->count());
      CHECK(run->time() == 0);
      CHECK(run->origin().find("contacts that remember") != std::string::npos);
      CHECK(run->ledger().elastic == before->ledger().elastic);
      run->step(500);
      before->step(500);
      // Springs against rolling are turned with the contact once more, which rounds.
      const double rounding = friction == "elastic" ? 0 : 1e-12;
      const auto same = [&](const auto& a, const auto& b) {
        return (a - b).cwiseAbs().maxCoeff() <= rounding * b.cwiseAbs().maxCoeff();
      };
      CHECK(same(run->positions(), before->positions()));
      CHECK(same(run->velocities(), before->velocities()));
      CHECK(same(*run->spins(), *before->spins()));
      CHECK(std::abs(run->energy_residual()) <= 2 * std::abs(before->energy_residual()) + 1e-12);
    }
  }

  TEST_CASE("what contacts remember holds a bed: without it forces are others") {
    const Folder bed;
    const auto before = recorded_in_contact<2>(kElastic, bed.path);
    const auto run = made<2>(emptied(kElastic) + started_from(bed.path));
    Scene<2> forgetful = parse_scene<2>(kElastic, "s.toml");
    forgetful.fills.clear();
    forgetful.grains.clear();
    forgetful.grain_files.push_back(
        {bed.path / "frames/0001.csv", {}, Vec<2>::Zero(), false, false});
    forgetful.largest_initial_overlap = 0.3;
    const auto other = make_run(forgetful);
    CHECK(run->positions() == other->positions());
    bool same = true, same_without = true;
    const auto theirs = before->contacts(), ours = run->contacts(), others = other->contacts();
    REQUIRE(ours.size() == theirs.size());
    REQUIRE(others.size() == theirs.size());
    for (std::size_t k = 0; k < theirs.size(); ++k) {
      same = same && ours[k].force == theirs[k].force;
      same_without = same_without && others[k].force == theirs[k].force;
    }
    CHECK(same);
    CHECK_FALSE(same_without);
  }

  TEST_CASE("grains, walls and a piston of the new scene join those of the run") {
    const std::string piston = R"([[wall]]
name = "lid"
material = "rock"
point = [0, 0.6]
normal = [0, -1]
motion = { type = "piston", mass = 2, load = [0, -500] }
)";
    const Folder bed;
    const auto before = recorded<2>(kHeap + piston, bed.path);
    const double lid = before->walls().back().point[1];
    REQUIRE(lid < 0.599);
    const std::string more = R"([[fill]]
material = "gravel"
count = 8
radius = "9 mm"
region = { low = [0, 0], high = [0.3, 0.6] }
arrangement = "random"
)";
    const std::string right =
        "[[wall]]\nname = \"right\"\nmaterial = \"rock\"\npoint = [0.4, 0]\n"
        "normal = [-1, 0]\n";
    const auto run = made<2>(emptied(kHeap) + piston + right + started_from(bed.path) + more);
    CHECK(run->count() == before->count() + 8);
    CHECK(run->positions().leftCols(before->count()) == before->positions());
    CHECK(run->walls().size() == 4);
    CHECK(run->walls()[2].point[1] == lid);
    CHECK(run->walls()[2].velocity[1] == before->walls().back().velocity[1]);
    CHECK(run->origin().find("piston \"lid\"") != std::string::npos);
    // The newcomers overlap nothing.
    for (int i = before->count(); i < run->count(); ++i) {
      for (int j = 0; j < i; ++j) {
        const double gap = (run->positions().col(i) - run->positions().col(j)).norm() -
                           run->radii()[i] - run->radii()[j];
        CHECK(gap >= 0);
      }
    }
  }

  TEST_CASE("materials are found by name; masses are those of the new scene") {
    const Folder bed;
    const auto before = recorded<2>(kHeap, bed.path);
    std::string text = emptied(kHeap);
    text = with(text, "[materials.rock]\ndensity = \"2650 kg/m^3\"\n", "");
    text = with(text, "density = 2000\n", "density = 4000\n[materials.rock]\ndensity = 2650\n");
    const auto run = made<2>(text + started_from(bed.path));
    REQUIRE(run->count() == before->count());
    for (int i = 0; i < run->count(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const std::string& name =
          before->scene().materials[static_cast<std::size_t>(before->materials()[k])].name;
      CHECK(run->scene().materials[static_cast<std::size_t>(run->materials()[k])].name == name);
      const double factor = name == "gravel" ? 2 : 1;
      CHECK(std::abs(run->masses()[i] - factor * before->masses()[i]) <= 1e-15 * run->masses()[i]);
    }
  }

  TEST_CASE("under another law contacts remember nothing, and the run says so") {
    const Folder bed;
    recorded<2>(kHeap, bed.path);
    const std::string text =
        with(with(emptied(kHeap), "friction = \"elastic\"", "friction = \"none\""),
             "friction = 0.4\n", "");
    const auto run = made<2>(text + started_from(bed.path));
    CHECK(run->origin().find("contacts remember nothing") != std::string::npos);
    CHECK(explain(*run).find(run->origin()) != std::string::npos);
    run->step(10);
  }

  TEST_CASE("pinned grains stay, driven ones go on") {
    const std::string held = R"([[grain]]
position = [0.5, 0.5]
radius = "20 mm"
material = "rock"
pinned = true
[[grain]]
position = [0.7, 0.5]
radius = "20 mm"
material = "rock"
driven = true
velocity = [0.1, 0]
)";
    const Folder bed;
    const auto before = recorded<2>(kHeap + held, bed.path);
    const auto run = made<2>(emptied(kHeap) + started_from(bed.path));
    const int n = run->count();
    REQUIRE(n == before->count());
    CHECK(run->drives());
    run->step(100);
    bool stayed = false, moved = false;
    for (int i = 0; i < n; ++i) {
      const Vec<2> way = run->positions().col(i) - before->positions().col(i);
      stayed = stayed || (run->pinned()[i] && way.isZero(0));
      moved = moved || (run->pinned()[i] && way[1] == 0 && run->velocities()(0, i) == 0.1);
    }
    CHECK(stayed);
    CHECK(moved);
  }

  TEST_CASE("grains that came and left: those present start, in the order of their ids") {
    const std::string traffic = R"([[inlet]]
name = "hopper"
material = "rock"
radius = "5 mm"
region = { low = [0.2, 0.3], high = [0.4, 0.4] }
rate = 2000
[[outlet]]
name = "sink"
low = [0, 0]
high = [0.1, 0.02]
)";
    const Folder bed;
    const auto before = recorded<2>(
        with(kHeap, "position = [0.05, 0.4]", "position = [0.05, 0.25]") + traffic, bed.path);
    REQUIRE(before->traffic()->inlets[0].grains > 0);
    REQUIRE(before->traffic()->outlets[0].grains > 0);
    const auto run = made<2>(emptied(kHeap) + started_from(bed.path));
    REQUIRE(run->count() == before->count());
    CHECK(run->ids().empty());
    CHECK(run->positions() == before->positions());
  }

  TEST_CASE("its folder is whole: it can be run again, resumed and started from") {
    const std::string text = emptied(kHeap);
    Folder first, second, third;
    {
      const Folder bed;
      recorded<2>(kHeap, bed.path);
      recorded<2>(text + started_from(bed.path), first.path);
    }
    CHECK(fs::exists(first.path / "start.h5"));
    const std::string scene = content(first.path / "scene.toml");
    CHECK(scene.find("run = \"start.h5\"") != std::string::npos);
    const std::string series = content(first.path / "series.csv");
    REQUIRE(record(*make_run(read_scene<2>(first.path / "scene.toml")), {second.path, {}, {}}));
    CHECK(content(second.path / "series.csv") == series);
    CHECK(content(second.path / "scene.toml") == scene);
    // Into its own folder.
    REQUIRE(record(*make_run(read_scene<2>(first.path / "scene.toml")), {first.path, {}, {}}));
    CHECK(content(first.path / "series.csv") == series);
    // On from its end, as a resumed run, and as a scene of its own.
    const Checkpoint end = read_checkpoint(first.path);
    const auto resumed = resume_run<2>(end, 0.03);
    REQUIRE(record_on(*resumed, end, {}));
    recorded<2>(text + started_from(first.path), third.path);
    CHECK(fs::exists(third.path / "summary.txt"));
    CHECK(content(third.path / "summary.txt").find("start ") != std::string::npos);
    // From its own last state, in its own folder.
    write_file(third.path / "s.toml", text + "[start]\nrun = \".\"\n");
    REQUIRE(record(*make_run(read_scene<2>(third.path / "s.toml")), {third.path, {}, {}}));
  }

  TEST_CASE("what cannot be started from is refused in one sentence") {
    const Folder bed, empty;
    recorded<2>(kHeap, bed.path);
    make_folder(empty.path);
    const std::string text = emptied(kHeap);
    const auto refusal = [](const std::string& scene) {
      return scene_error_of([&] { make_run(parse_scene<2>(scene, "s.toml")); });
    };
    const std::string start = started_from(bed.path);
    CHECK(refusal(text + start) == "accepted");
    CHECK(refusal(text + start + "time = \"last\"\n") == "accepted");

    const std::string time = refusal(text + start + "time = \"1 s\"\n");
    CHECK(time.find("start.time") != std::string::npos);
    CHECK(time.find("\"last\"") != std::string::npos);
    const std::string nothing = refusal(text + "[start]\n");
    CHECK(nothing.find("start.run: missing") != std::string::npos);
    const std::string word = refusal(with(text, "seed = 5", "seed = 5\nstart = \"bed\""));
    CHECK(word.find("start") != std::string::npos);
    const std::string nowhere = refusal(text + started_from("no/such/run"));
    CHECK(nowhere.find("no/such/run") != std::string::npos);
    CHECK(nowhere.find("no checkpoint") != std::string::npos);
    CHECK(nowhere.find("no such folder") != std::string::npos);
    CHECK(nowhere.find("s.toml:") == 0);
    CHECK(refusal(text + started_from(empty.path)).find("no checkpoint") != std::string::npos);
    const std::string file = refusal(text + started_from(bed.path / "series.csv"));
    CHECK(file.find("it is no checkpoint") != std::string::npos);

    const std::string material = refusal(
        with(with(text, "[materials.gravel]\ndensity = 2000\n", ""), "seed = 5", "seed = 6") +
        start);
    CHECK(material.find("material \"gravel\"") != std::string::npos);
    CHECK(material.find("[materials.gravel]") != std::string::npos);
    const std::string wall = refusal(with(text, "point = [0, 0]", "point = [0, 0.2]") + start);
    CHECK(wall.find("behind wall \"floor\"") != std::string::npos);
    CHECK(wall.find("s.toml:") == 0);
    const std::string dimension = scene_error_of(
        [&] { make_run(parse_scene<3>(emptied(in_space<3>(kHeap)) + start, "s.toml")); });
    CHECK(dimension.find("2 dimensions") != std::string::npos);
  }

  TEST_CASE("the scene is written with its start, and reads back") {
    const std::string text = emptied(kHeap) + "[start]\nrun = \"runs/a \\\"bed\\\"\"\n";
    const std::string written = to_toml(parse_scene<2>(text, "s.toml"));
    CHECK(parse_scene<2>(written, "t.toml").start->run == fs::path("runs/a \"bed\""));
    CHECK(to_toml(parse_scene<2>(written, "t.toml")) == written);
  }
}
