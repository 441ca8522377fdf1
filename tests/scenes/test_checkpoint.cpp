// SPDX-License-Identifier: GPL-3.0-or-later
// Checkpoints hold a state whole, and a run that goes on from one is the run that was left alone.

#include <lagrain/checkpoint.hpp>
#include <lagrain/output.hpp>
#include <lagrain/random.hpp>
#include <lagrain/scene.hpp>

#include "support/files.hpp"

#include <doctest/doctest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

/// Discs come in, fall on a slope that shakes and a belt, and leave; a piston presses on others.
const std::string kPlane = R"(dimension = 2
duration = "60 ms"
gravity = [0, -9.81]
normal = "linear"
friction = "FRICTION"
neighbourhood = "NEIGHBOURHOOD"
[law]
stiffness = 1e6
restitution = 0.5
ROLLING
[materials.glass]
density = 2500
[materials.lead]
density = 11000
[[fill]]
material = "glass"
count = 40
radius = { uniform = ["8 mm", "10 mm"] }
region = { low = [0, 0], high = [0.3, 0.3] }
velocity = [0, -1]
[[grain]]
position = [0.15, 0.36]
radius = "20 mm"
material = "lead"
[[inlet]]
name = "hopper"
material = "glass"
radius = { uniform = ["5 mm", "6 mm"] }
region = { low = [0.02, 0.4], high = [0.28, 0.5] }
rate = 1000
velocity = { random = 0.5 }
[[outlet]]
name = "sink"
low = [0.1, -0.3]
high = [0.2, -0.01]
[domain]
low = [-0.5, -0.5]
high = [0.8, 0.8]
[[wall]]
name = "floor"
material = "glass"
from = [0, 0]
to = [0.12, 0]
belt = [0.3, 0]
[[wall]]
name = "shelf"
material = "glass"
from = [0.16, 0]
to = [0.3, 0]
motion = { type = "shake", amplitude = [0, "1 mm"], frequency = "50 Hz" }
[[wall]]
name = "left"
material = "glass"
point = [0, 0]
normal = [1, 0]
[[wall]]
name = "right"
material = "glass"
point = [0.3, 0]
normal = [-1, 0]
motion = { type = "piston", mass = 2, load = [-50, 0] }
[output]
frames_every = "10 ms"
series_every = "1 ms"
contacts = true
)";

/// Spheres rattle in a box under a piston; a paddle that turns among them goes away.
const std::string kSpace = R"(dimension = 3
duration = "20 ms"
gravity = [0, 0, -9.81]
normal = "hertz"
friction = "FRICTION"
neighbourhood = "NEIGHBOURHOOD"
[law]
modulus = 1e7
impact_speed = 3
restitution = 0.7
ROLLING
[materials.glass]
density = 2500
[[fill]]
count = 60
radius = { uniform = ["8 mm", "10 mm"] }
region = { low = [0, 0, 0], high = [0.1, 0.1, 0.2] }
velocity = { random = 1 }
[[box]]
name = "box"
low = [0, 0, 0]
high = [0.1, 0.1, 0.2]
open = ["top"]
[[wall]]
name = "lid"
point = [0, 0, 0.2]
normal = [0, 0, -1]
motion = { type = "piston", mass = 1, load = [0, 0, -20] }
[[wall]]
name = "paddle"
corners = [[0.02, 0.05, 0.02], [0.08, 0.05, 0.02], [0.08, 0.05, 0.08], [0.02, 0.05, 0.08]]
turning = { type = "steady", axis = [1, 0, 0], about = [0.05, 0.05, 0.05], rate = 20 }
until = "15 ms"
[output]
frames_every = "5 ms"
series_every = "1 ms"
contacts = true
)";

std::string with(std::string text, const std::string& friction, const std::string& neighbourhood) {
  const auto put = [&](const std::string& word, const std::string& value) {
    text.replace(text.find(word), word.size(), value);
  };
  put("FRICTION", friction);
  put("NEIGHBOURHOOD", neighbourhood);
  std::string law;
  if (friction != "none") law += "friction = 0.4\n";
  if (friction == "rolling") law += "rolling_friction = 0.1\n";
  put("ROLLING\n", law);
  return text;
}

template <int Dim>
std::unique_ptr<Run<Dim>> run_of(const std::string& text, int threads = 1) {
  return make_run(parse_scene<Dim>(text, "scene"), threads);
}

/// A series, cell by cell.
std::vector<std::vector<std::string>> cells_of(const fs::path& file) {
  std::istringstream in(content(file));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

/// Two series are the same bits, but for columns that tell of the search. Losses are summed over
/// all near pairs in an order that depends on it: they may differ by rounding.
void check_same_series(const fs::path& a, const fs::path& b) {
  const auto one = cells_of(a), other = cells_of(b);
  REQUIRE(one.size() == other.size());
  REQUIRE(one.size() > 10);
  const std::vector<std::string>& head = one.front();
  for (std::size_t row = 0; row < one.size(); ++row) {
    REQUIRE(one[row].size() == other[row].size());
    for (std::size_t k = 0; k < one[row].size(); ++k) {
      CAPTURE(head[k]);
      CAPTURE(row);
      if (head[k] == "near_pairs[-]" || head[k] == "refreshes[-]") continue;
      const bool summed =
          head[k] == "dashpot[J]" || head[k] == "friction[J]" || head[k] == "residual[J]";
      if (summed && row > 0) {
        CHECK(std::abs(std::stod(one[row][k]) - std::stod(other[row][k])) < 1e-13);
      } else {
        CHECK(one[row][k] == other[row][k]);
      }
    }
  }
}

/// The files of two runs hold the same bits.
void check_same(const fs::path& a, const fs::path& b) {
  check_same_series(a / "series.csv", b / "series.csv");
  int files = 0;
  for (const char* folder : {".", "frames", "contacts"}) {
    for (const auto& entry : fs::directory_iterator(a / folder)) {
      const fs::path name = fs::path(folder) / entry.path().filename();
      if (name.extension() != ".csv" || name.filename() == "series.csv") continue;
      INFO(name.string());
      CHECK(content(a / name) == content(b / name));
      ++files;
    }
    const auto count = [](const fs::path& path) {
      return std::distance(fs::directory_iterator(path), fs::directory_iterator());
    };
    CHECK(count(a / folder) == count(b / folder));
  }
  CHECK(files > 3);
}

RecordOptions into(const fs::path& folder) {
  RecordOptions options;
  options.folder = folder;
  return options;
}

/// Asks to stop after so many steps.
RecordOptions until_step(const fs::path& folder, int steps) {
  RecordOptions options = into(folder);
  options.stop = [left = steps]() mutable { return --left <= 0; };
  return options;
}

template <int Dim>
bool resume(const fs::path& folder, std::optional<double> until = {}, int threads = 1) {
  const Checkpoint checkpoint = read_checkpoint(folder);
  REQUIRE(checkpoint_dimension(checkpoint) == Dim);
  const auto run = resume_run<Dim>(checkpoint, until, threads);
  return record_on(*run, checkpoint, into({}));
}

State example() {
  State state;
  state.set("grains/radius", NumberTable<double>{1, {0.1, -0.0, 1e-310}});
  state.set("grains/place",
            NumberTable<double>{2, {std::numeric_limits<double>::infinity(), 1, 2, 3, 4, 5}});
  state.set("grains/empty", NumberTable<double>{3, {}});
  state.set("step", NumberTable<std::int64_t>{1, {std::numeric_limits<std::int64_t>::min()}});
  state.set("scene", "title = \"a\"\n");
  state.set("nothing", "");
  return state;
}

}  // namespace

TEST_SUITE("checkpoints") {
  TEST_CASE("the same state is the same bytes, whenever it is written") {
    const std::string bytes = encode_checkpoint(example());
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 counts seconds
    CHECK(encode_checkpoint(example()) == bytes);
  }

  TEST_CASE("a state comes back as it was") {
    const State state = example();
    CHECK(decode_checkpoint(encode_checkpoint(state)).values() == state.values());
  }

  TEST_CASE("a checkpoint that was cut off or changed anywhere is refused") {
    const std::string whole = encode_checkpoint(example());
    Random random(1);
    for (int k = 0; k < 300; ++k) {
      std::string bytes = whole;
      // Each byte of the header is tried, and some of the rest.
      const auto at =
          static_cast<std::size_t>(k < 150 ? k : random.below(static_cast<int>(whole.size())));
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
      CHECK_THROWS_AS(decode_checkpoint(bytes), SceneError);
      CHECK_THROWS_AS(decode_checkpoint(whole.substr(0, at)), SceneError);
    }
    CHECK_THROWS_AS(decode_checkpoint(whole + '\0'), SceneError);
    CHECK_THROWS_WITH_AS(decode_checkpoint("lagrain checkpoint"),
                         "it was cut off in its first line", SceneError);
  }

  TEST_CASE("the first line says what the file is, and a later version is refused by its number") {
    std::string bytes = encode_checkpoint(example());
    CHECK(bytes.starts_with("lagrain checkpoint 2: HDF5 from byte 512 on, "));
    bytes.replace(bytes.find('2'), 1, "3");
    CHECK_THROWS_WITH_AS(decode_checkpoint(bytes),
                         "it is of version 3, and this program reads version 2; resume it with the "
                         "lagrain that wrote it",
                         SceneError);
    CHECK_THROWS_WITH_AS(decode_checkpoint("time[s],kinetic[J]"), "it is no checkpoint",
                         SceneError);
  }

  TEST_CASE("the checkpoint before is taken where the last one is damaged") {
    const Folder folder;
    fs::create_directories(folder.path);
    CHECK_THROWS_AS(read_checkpoint(folder.path), SceneError);
    State state = example();
    write_checkpoint(folder.path, state);
    state.set("step", NumberTable<std::int64_t>{1, {7}});
    write_checkpoint(folder.path, state);
    CHECK(read_checkpoint(folder.path).state.values() == state.values());
    CHECK(read_checkpoint(folder.path).trouble.empty());
    fs::resize_file(folder.path / "checkpoint.h5", 700);
    const Checkpoint before = read_checkpoint(folder.path);
    CHECK(before.state.values() == example().values());
    CHECK(before.file == folder.path / "checkpoint_before.h5");
    CHECK(before.trouble.find("checkpoint.h5: it was cut off or changed") != std::string::npos);
    fs::resize_file(folder.path / "checkpoint_before.h5", 0);
    CHECK_THROWS_AS(read_checkpoint(folder.path), SceneError);
  }

  TEST_CASE("a checkpoint that cannot be written leaves the last one") {
    const Folder folder;
    fs::create_directories(folder.path);
    write_checkpoint(folder.path, example());
    // A folder stands where the new file would be.
    fs::create_directories(folder.path / "checkpoint.h5.new" / "full");
    CHECK_THROWS_AS(write_checkpoint(folder.path, {}), SceneError);
    CHECK(read_checkpoint(folder.path).state.values() == example().values());
    CHECK_THROWS_AS(write_checkpoint(folder.path / "vanished", example()), SceneError);
  }

  TEST_CASE("a state that lacks something is refused by its name") {
    State state;
    state.set("wall/point", NumberTable<double>{3, {1, 2, 3}});
    StateVisitor visit = StateVisitor::restoring(state).in("wall");
    Vec<2> point;
    double mass = 0;
    CHECK_THROWS_WITH_AS(visit("mass", mass), "it has no wall/mass", SceneError);
    CHECK_THROWS_WITH_AS(visit("point", point), "its wall/point is not 2 numbers wide", SceneError);
    std::int64_t whole = 0;
    CHECK_THROWS_WITH_AS(visit("point", whole), "its wall/point is of another kind", SceneError);
  }

  // These were found by fuzzing: such a state would have led out of a list, or for ever on.
  TEST_CASE("a state that points to what there is not is refused") {
    const std::string text = with(kPlane, "elastic", "triangulation");
    const auto run = run_of<2>(text);
    run->step(20);
    State whole;
    run->persist(StateVisitor::keeping(whole).in("run"));
    const auto refused = [&](const std::string& name, auto number) {
      State state = whole;
      auto table = state.get<NumberTable<decltype(number)>>(name);
      table.numbers.at(3 % table.numbers.size()) = number;
      state.set(name, table);
      const auto other = run_of<2>(text);
      std::string message;
      try {
        other->persist(StateVisitor::restoring(state).in("run"));
      } catch (const SceneError& error) {
        message = error.what();
      }
      return message;
    };
    using Whole = std::int64_t;
    const std::string cannot_be =
        "a grain of it has a size, mass, place, velocity or material that cannot be";
    CHECK(refused("run/grains/radius", -0.01) == cannot_be);
    CHECK(refused("run/grains/radius", std::nan("")) == cannot_be);
    CHECK(refused("run/grains/mass", 0.0) == cannot_be);
    CHECK(refused("run/grains/position", HUGE_VAL) == cannot_be);
    CHECK(refused("run/grains/number", Whole{1 << 20}) == "its grains do not fit together");
    CHECK(refused("run/materials", Whole{9}) == "its grains do not fit together");
    CHECK(refused("run/groups", Whole{7}) == "its grains do not fit together");
    CHECK(refused("run/groups", Whole{-2}) == "its grains do not fit together");
    CHECK(refused("run/step", Whole{-1}) == "its number of steps is negative");
  }

  TEST_CASE("a run that was stopped goes on to the same bits: discs") {
    for (const std::string friction : {"none", "viscous", "elastic", "rolling"}) {
      for (const std::string neighbourhood : {"triangulation", "linked cells"}) {
        const std::string text = with(kPlane, friction, neighbourhood);
        INFO(friction, ", ", neighbourhood);
        const Folder whole, parted;
        REQUIRE(record(*run_of<2>(text), into(whole.path)));
        REQUIRE_FALSE(record(*run_of<2>(text), until_step(parted.path, 137)));
        {
          // Stopped once more.
          const Checkpoint checkpoint = read_checkpoint(parted.path);
          const auto run = resume_run<2>(checkpoint);
          REQUIRE_FALSE(record_on(*run, checkpoint, until_step({}, 256)));
        }
        REQUIRE(resume<2>(parted.path));
        check_same(whole.path, parted.path);
      }
    }
  }

  TEST_CASE("a run that was stopped goes on to the same bits: spheres") {
    for (const std::string friction : {"none", "viscous", "elastic", "rolling"}) {
      const std::string text = with(kSpace, friction, "triangulation");
      INFO(friction);
      const Folder whole, parted;
      REQUIRE(record(*run_of<3>(text), into(whole.path)));
      REQUIRE_FALSE(record(*run_of<3>(text), until_step(parted.path, 41)));
      REQUIRE(resume<3>(parted.path));
      check_same(whole.path, parted.path);
    }
  }

  TEST_CASE("so many discs that slots are not numbers, and lie in several blocks") {
    std::string text = with(kPlane, "elastic", "triangulation");
    const auto put = [&](const std::string& word, const std::string& value) {
      text.replace(text.find(word), word.size(), value);
    };
    put("count = 40", "count = 2500");
    put("\"8 mm\", \"10 mm\"", "\"2 mm\", \"2.4 mm\"");
    put("60 ms", "3 ms");
    put("series_every = \"1 ms\"", "series_every = \"0.1 ms\"");
    put("frames_every = \"10 ms\"", "frames_every = \"1 ms\"");
    const Folder whole, parted;
    REQUIRE(record(*run_of<2>(text), into(whole.path)));
    REQUIRE_FALSE(record(*run_of<2>(text), until_step(parted.path, 23)));
    REQUIRE(resume<2>(parted.path, {}, 2));
    check_same(whole.path, parted.path);
  }

  TEST_CASE("a run that is killed at any moment goes on to the same bits") {
    const std::string text = with(kPlane, "elastic", "triangulation");
    const Folder whole, killed;
    REQUIRE(record(*run_of<2>(text), into(whole.path)));
    Random random(7);
    RecordOptions options = into(killed.path);
    options.checkpoint_every = 0;
    const auto kill_after = [&](int milliseconds, auto&& work) {
      const pid_t child = fork();
      if (child == 0) {
        work();
        _exit(0);
      }
      usleep(static_cast<useconds_t>(1000 * milliseconds));
      kill(child, SIGKILL);
      int status = 0;
      waitpid(child, &status, 0);
    };
    // Until it has written its first checkpoint, there is nothing to go on with.
    while (!fs::exists(killed.path / "checkpoint.h5")) {
      kill_after(20 + random.below(100), [&] { record(*run_of<2>(text), options); });
    }
    for (int k = 0; k < 5; ++k) {
      kill_after(5 + random.below(100), [&] {
        const Checkpoint checkpoint = read_checkpoint(killed.path);
        const auto run = resume_run<2>(checkpoint);
        record_on(*run, checkpoint, options);
      });
    }
    REQUIRE(resume<2>(killed.path));
    check_same(whole.path, killed.path);
  }

  TEST_CASE("a run goes on beyond its end") {
    const std::string text = with(kPlane, "elastic", "triangulation");
    const Folder longer, parted;
    REQUIRE(record(*run_of<2>(text), into(longer.path)));
    std::string shorter = text;
    shorter.replace(shorter.find("60 ms"), 5, "30 ms");
    REQUIRE(record(*run_of<2>(shorter), into(parted.path)));
    REQUIRE(resume<2>(parted.path, 0.06));
    check_same(longer.path, parted.path);
    CHECK_THROWS_AS(resume<2>(parted.path, 0.05), SceneError);
  }

  TEST_CASE("whoever resumes a run can end it while grains are placed") {
    const Folder folder;
    REQUIRE(record(*run_of<2>(with(kPlane, "elastic", "triangulation")), into(folder.path)));
    const Checkpoint checkpoint = read_checkpoint(folder.path);
    const auto stop = [](std::int64_t, std::int64_t) { throw std::runtime_error("stop"); };
    CHECK_THROWS_AS(resume_run<2>(checkpoint, {}, 1, stop), std::runtime_error);
  }

  TEST_CASE("files that were changed are refused") {
    const Folder folder;
    REQUIRE_FALSE(
        record(*run_of<2>(with(kPlane, "none", "linked cells")), until_step(folder.path, 100)));
    const auto size = fs::file_size(folder.path / "series.csv");
    REQUIRE(size > 1000);
    fs::resize_file(folder.path / "series.csv", 10);
    CHECK_THROWS_AS(resume<2>(folder.path), SceneError);
    fs::remove(folder.path / "series.csv");
    CHECK_THROWS_AS(resume<2>(folder.path), SceneError);
  }
}
