// SPDX-License-Identifier: GPL-3.0-or-later
// The speed report: its tables, the contenders that it is built from, and LAMMPS if it is there.

#include "beds.hpp"
#include "contenders.hpp"
#include "lammps.hpp"
#include "report.hpp"

#include <lagrain/cell_grid.hpp>
#include <lagrain/check.hpp>
#include <lagrain/output.hpp>

#include <support/files.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <sys/wait.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;
using namespace lagrain::bench;

namespace {

namespace fs = std::filesystem;

/// Rows of a CSV file by the names in its first line; names and texts may be quoted.
std::vector<std::map<std::string, std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> lines;
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : csv) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c == '\n') {
      lines.push_back(fields);
      fields.assign(1, "");
    } else {
      fields.back() += c;
    }
  }
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    REQUIRE(lines[k].size() == lines[0].size());
    for (std::size_t f = 0; f < lines[0].size(); ++f) {
      if (f == 0) rows.emplace_back();
      rows.back()[lines[0][f]] = lines[k][f];
    }
  }
  return rows;
}

const StopCheck kGoOn = [] {};

/// A few grains that slide over one another: a bed whose right wall is gone.
template <int Dim>
Bed<Dim> collapsing() {
  Bed<Dim> bed = pour<Dim>({Dim == 2 ? 60 : 40, 0.02, 0.014, 0.15}, kGoOn);
  bed.size[0] = 1;
  bed.walls = open_box<Dim>(bed.size);
  advance<Dim>(bed, steps_for(bed, 0.02, 2), kGoOn);
  return bed;
}

constexpr int kSteps = 400;

/// The grains so many steps later.
template <int Dim, class N>
auto after_steps(const Bed<Dim>& bed, N neighbourhood) {
  auto sim = simulate<Dim, N>(bed, std::move(neighbourhood));
  for (int s = 0; s < kSteps; ++s) sim.step();
  return sim.grains();
}

template <int Dim>
Answers<Dim> recorded(const Bed<Dim>& bed) {
  RecordingNeighbourhood<Dim> recorder;
  const auto answers = recorder.answers();
  auto sim = simulate<Dim, RecordingNeighbourhood<Dim>>(bed, std::move(recorder));
  note_touching<Dim>(*answers, sim.grains().position, sim.grains().radius);
  for (int s = 0; s < kSteps; ++s) {
    sim.step();
    note_touching<Dim>(*answers, sim.grains().position, sim.grains().radius);
  }
  return *answers;
}

template <int Dim>
void check_same_bits() {
  const Bed<Dim> bed = collapsing<Dim>();
  const Answers<Dim> answers = recorded<Dim>(bed);
  std::size_t given = 0, touched = 0;
  for (const auto& call : answers.calls) {
    given += call.pairs.size();
    touched += static_cast<std::size_t>(std::count(call.touched.begin(), call.touched.end(), true));
  }
  CHECK(answers.calls.size() > 3);  // it flows
  CHECK(touched < given);
  CHECK(touched > 0);

  const auto ours = after_steps<Dim>(bed, TriangulationNeighbourhood<Dim>{});
  const auto same = [&](const auto& other) {
    return ours.position == other.position && ours.velocity == other.velocity &&
           ours.omega == other.omega;
  };
  CHECK(same(after_steps<Dim>(bed, Oracle<Dim>(answers))));
  CHECK(same(after_steps<Dim>(bed, CellGrid<Dim>{})));
  CHECK(same(after_steps<Dim>(bed, RebuiltTriangulation<Dim>{})));
}

/// Two grains that meet off centre, without weight.
template <int Dim>
Bed<Dim> collision() {
  Bed<Dim> bed;
  Grain<Dim> a;
  a.radius = 0.02;
  a.mass = kDensity * grain_volume<Dim>(a.radius);
  a.position.setConstant(0.5);
  Grain<Dim> b = a;
  b.position[0] += 0.0389;
  b.position[1] += 0.01;
  // Slow: LAMMPS takes the lever arms of friction without the overlap.
  a.velocity[0] = 0.1;
  b.velocity[0] = -0.1;
  bed.grains = {a, b};
  bed.size.setConstant(1);
  // Nearly elastic: the dashpot of LAMMPS may attract at the end of the contact, which takes more
  // the stronger it is.
  choose_law<Dim>(bed, a.radius, a.radius, 0.95);
  bed.setting.gravity.setZero();
  return bed;
}

/// A report takes minutes where nothing is optimised.
bool too_slow() {
#ifdef __OPTIMIZE__
  return false;
#else
  MESSAGE("not optimised: no report is made");
  return true;
#endif
}

/// LAMMPS if it is installed; if not, the word by which ctest knows that nothing was tested.
std::optional<fs::path> lammps_or_message() {
  auto program = find_lammps();
  if (!program) MESSAGE("SKIPPED: LAMMPS is not installed");
  return program;
}

template <int Dim>
LammpsReport<Dim> run_lammps(const fs::path& program, const fs::path& folder, const Bed<Dim>& bed,
                             const LammpsPlan& plan) {
  LammpsRun<Dim> run(program, folder, bed, plan);
  for (int turn = 0; turn < plan.turns; ++turn) run.take_turn();
  return run.finish();
}

template <int Dim>
void check_collision(const fs::path& program, const fs::path& folder) {
  const Bed<Dim> bed = collision<Dim>();
  const auto mine = after_steps<Dim>(bed, CellGrid<Dim>{});
  const auto theirs = run_lammps<Dim>(program, folder, bed, {0, kSteps, 1, false});

  const double speed = (bed.grains[0].velocity - bed.grains[1].velocity).norm();
  const auto after = [&](const Columns<Dim>& v) { return Vec<Dim>((v.col(0) - v.col(1)) / speed); };
  const Vec<Dim> ours = after(mine.velocity), other = after(theirs.velocity);
  CAPTURE(ours.transpose());
  CAPTURE(other.transpose());
  CHECK(ours[0] < -0.5);  // they have turned each other away
  CHECK(ours[1] < -0.1);
  CHECK((ours - other).norm() < 0.005);
}

}  // namespace

TEST_SUITE("report") {
  TEST_CASE("every neighbourhood of the report gives the same bits, the oracle's too") {
    check_same_bits<2>();
    check_same_bits<3>();
  }

  TEST_CASE("the oracle does not guess beyond what it was told") {
    Bed<2> bed = collapsing<2>();
    Answers<2> answers = recorded<2>(bed);
    answers.calls.resize(2);
    CHECK_THROWS_AS(after_steps<2>(bed, Oracle<2>(answers)), ContractError);
  }

  TEST_CASE("mirrored copies of a bed at rest stay at rest") {
    const Bed<2> tile = pour<2>({60, 0.02, 0.014, 0.2}, kGoOn);
    Bed<2> bed = tiled<2>(tile, {3});
    CHECK(bed.count() == 180);
    const Bed<2> before = bed;
    advance<2>(bed, 300, kGoOn);
    for (std::size_t i = 0; i < bed.grains.size(); ++i) {
      CHECK((bed.grains[i].position - before.grains[i].position).norm() < 0.02 * 0.014);
    }
  }

  TEST_CASE("LAMMPS is given the same grains") {
    Bed<3> bed = collapsing<3>();
    put_large_grains<3>(bed, 0.07, 1, kGoOn);
    std::istringstream lines(lammps_data<3>(bed));
    std::string line;
    int atoms = 0;
    std::set<int> types;
    bool inside = false;
    while (std::getline(lines, line)) {
      if (line.ends_with(" atoms")) CHECK(std::stoi(line) == bed.count());
      if (line.ends_with(" atom types")) CHECK(std::stoi(line) == 2);
      if (line.starts_with("Velocities")) inside = false;
      if (inside && !line.empty()) {
        std::istringstream fields(line);
        int id = 0, type = 0;
        double diameter = 0, density = 0, x = 0, y = 0, z = 0;
        fields >> id >> type >> diameter >> density >> x >> y >> z;
        const Grain<3>& grain = bed.grains[static_cast<std::size_t>(id - 1)];
        CHECK(diameter == 2 * grain.radius);
        CHECK(relative_error(grain_volume<3>(diameter / 2) * density, grain.mass) < 1e-15);
        CHECK(Vec<3>(x, y, z) == grain.position);
        types.insert(type);
        ++atoms;
      }
      if (line.starts_with("Atoms")) inside = true;
    }
    CHECK(atoms == bed.count());
    CHECK(types == std::set<int>{1, 2});
    const std::string input = lammps_input<3>(bed, {10, 20, 4, true});
    for (const char* part :
         {"units si\n", "dimension 3\n", " multi\n", "xplane 0 1\n", "zplane 0 NULL\n", "run 10\n",
          "run 20 pre no every 5 ", "fix motion all nve/sphere\n"}) {
      CAPTURE(part);
      CHECK(input.find(part) != std::string::npos);
    }
  }

  TEST_CASE("a program that is not LAMMPS is an error in its own words") {
    const Folder folder;
    CHECK_THROWS_AS(run_lammps<2>("/bin/false", folder.path, collision<2>(), {0, 1, 1, false}),
                    SimulationError);
  }

  TEST_CASE("a quick report writes its page, tables and plots, and misses no contact") {
    if (too_slow()) return;
    const Folder folder;
    FigureOptions options{.out = folder.path, .scenes = {}, .quick = true};
    write_speed_report(options);

    const std::string page = content(folder.path / "speed.html");
    for (const char* part : {"<h1>How fast, how accurate</h1>", "compiler", "linked cells",
                             "Settled beds", "Where the time goes", "speed_phases.csv"}) {
      CAPTURE(part);
      CHECK(page.find(part) != std::string::npos);
    }
    CHECK(page.find("has not come to its end") == std::string::npos);
    CHECK(content(folder.path / "report.html").find("href=\"speed.html\"") != std::string::npos);
    CHECK(content(folder.path / "index.html").find("href=\"report.html\"") != std::string::npos);

    std::set<std::string> contenders, groups;
    for (const auto& row : rows_of(content(folder.path / "speed.csv"))) {
      CAPTURE(row.at("scene"));
      CAPTURE(row.at("contender"));
      contenders.insert(row.at("contender"));
      groups.insert(row.at("group"));
      CHECK(std::stod(row.at("time[ns/grain/step]")) > 0);
      if (row.at("contender").starts_with("LAMMPS")) continue;
      CHECK(row.at("missed[-]") == "0");
      CHECK(std::stod(row.at("audited[-]")) > 0);
      CHECK(row.at("astray[%]") == "0");
    }
    CHECK(groups.size() == 5);
    for (const char* name : {kTriangulation, kOracle, kCells, kRebuilt}) {
      CHECK(contenders.contains(name));
    }
    CHECK(contenders.contains(kLammps) == find_lammps().has_value());

    const auto rounds = rows_of(content(folder.path / "speed_rounds.csv"));
    const auto phases = rows_of(content(folder.path / "speed_phases.csv"));
    CHECK(rounds.size() > groups.size());
    for (const auto& row : phases) CHECK(!row.at("phase").empty());
  }

  TEST_CASE("a report that is stopped keeps what it has measured") {
    if (too_slow()) return;
    const Folder folder;
    FigureOptions options{.out = folder.path, .scenes = {}, .quick = true};
    options.stop = [&] {
      return content(folder.path / "speed.csv").find(",triangulation,") != std::string::npos;
    };
    CHECK_THROWS_AS(write_speed_report(options), Interrupted);
    CHECK(!rows_of(content(folder.path / "speed.csv")).empty());
    CHECK(content(folder.path / "speed.html").find("has not come to its end") != std::string::npos);
  }
}

TEST_SUITE("lammps") {
  TEST_CASE("two grains leave a collision as they do in LAMMPS") {
    const auto program = lammps_or_message();
    if (!program) return;
    const Folder folder;
    check_collision<2>(*program, folder.path);
    check_collision<3>(*program, folder.path);
  }

  TEST_CASE("a bed under its weight stays where LAMMPS leaves it") {
    const auto program = lammps_or_message();
    if (!program) return;
    const Folder folder;
    const Bed<3> bed = pour<3>({60, 0.02, 0.02, 0.15}, kGoOn);
    const auto ours = after_steps<3>(bed, TriangulationNeighbourhood<3>{});
    const auto theirs = run_lammps<3>(*program, folder.path, bed, {0, kSteps, 1, false});
    CHECK((ours.position - theirs.position).colwise().norm().maxCoeff() < 1e-3 * 0.02);
    CHECK(fs::exists(folder.path / "in.lammps"));
    CHECK(fs::exists(folder.path / "data.lammps"));
  }

  TEST_CASE("LAMMPS in turns does what it does at once, and its steps before them do not count") {
    const auto program = lammps_or_message();
    if (!program) return;
    const Folder folder;
    Bed<3> bed = collapsing<3>();
    for (Grain<3>& grain : bed.grains) grain.velocity[0] += 5;
    const auto once = run_lammps<3>(*program, folder.path, bed, {600, 1200, 1, false});
    const auto turns = run_lammps<3>(*program, folder.path, bed, {600, 1200, 12, false});
    const auto from_the_start = run_lammps<3>(*program, folder.path, bed, {0, 1800, 12, false});
    CHECK(turns.position == once.position);
    CHECK(turns.velocity == once.velocity);
    CHECK(once.builds > 0);
    CHECK(turns.builds == once.builds);
    CHECK(from_the_start.builds > once.builds);
    double phases = 0;
    for (const auto& phase : turns.phases) phases += phase.second;
    CHECK(relative_error(phases, turns.wall_seconds) < 0.05);
  }

  TEST_CASE("LAMMPS that is left in the middle of its turns ends") {
    const auto program = lammps_or_message();
    if (!program) return;
    const Folder folder;
    { LammpsRun<2> run(*program, folder.path, collision<2>(), {0, 100, 4, false}); }
    CHECK(waitpid(-1, nullptr, WNOHANG) == -1);  // no child is left
    CHECK(errno == ECHILD);
  }
}
