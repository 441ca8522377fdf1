#include <lagrain/run.hpp>

#include <lagrain/output.hpp>

#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A folder for one test, gone afterwards.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("lagrain_test_run_" + std::to_string(++count));
  Folder() { fs::remove_all(path); }
  ~Folder() { fs::remove_all(path); }
  static inline int count = 0;
};

const std::string kFrictionless = without(with(kHeap, "\"elastic\"", "\"none\""), "friction = 0.4");

std::string trajectory(const std::string& text) {
  const auto run = make_run(parse_scene<2>(text, "s.toml"));
  run->advance_to(run->scene().duration);
  return frame_csv(*run);
}

std::string error_of(const std::string& text) {
  try {
    make_run(parse_scene<2>(text, "s.toml"));
  } catch (const SceneError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_SUITE("run") {
  TEST_CASE("every model that a scene can name runs, with the same bits from two neighbourhoods") {
    const std::string conservative = with(kFrictionless, "restitution = 0.5", "restitution = 1");
    for (const std::string& text :
         {kHeap, kFrictionless, with(kHeap, "\"elastic\"", "\"viscous\""),
          with(kHeap, "seed = 5", "integrator = \"symplectic Euler\""),
          with(conservative, "seed = 5", "integrator = \"fourth order\""),
          with(with(kHeap, "\"linear\"", "\"hertz\""), "stiffness = \"1e7 N/m\"",
               "modulus = \"2 GPa\"\nimpact_speed = 2")}) {
      CAPTURE(text);
      CHECK(trajectory(text) == trajectory(with(text, "linked cells", "all pairs")));
    }
  }

  TEST_CASE("spheres run through the same code") {
    const auto run = make_run(parse_scene<3>(R"(dimension = 3
duration = 0.5
gravity = [0, 0, -10]
normal = "linear"
friction = "elastic"
neighbourhood = "linked cells"
[law]
stiffness = 1e5
restitution = 0.5
friction = 0.5
[materials.rock]
density = 2500
[[grain]]
position = [0, 0, 0.1]
radius = 0.1
[[wall]]
point = [0, 0, 0]
normal = [0, 0, 1]
)",
                                             "s.toml"));
    run->advance_to(0.5);

    CHECK(run->walls()[0].force.z() == doctest::Approx(-10 * run->masses()[0]).epsilon(0.01));
    CHECK(run->size().memory_per_pair == 24);
  }

  TEST_CASE("the time step is the stated fraction of the shortest contact time") {
    const auto run = make_run(parse_scene<2>(kHeap, "s.toml"));

    CHECK(run->time_step() == doctest::Approx(run->time_scales().contact / 25));
    const auto steps = static_cast<double>(run->steps_planned());
    CHECK(steps * run->time_step() >= 0.02 * (1 - 1e-9));
    CHECK((steps - 1) * run->time_step() < 0.02);
  }

  TEST_CASE("too large a time step is an error that names the safe one") {
    const std::string message = error_of(with(kHeap, "1/25 contact", "1/5 contact"));

    CHECK(message.substr(0, 21) == "s.toml:5: time_step: ");
    const auto at = message.find("allows at most ");
    REQUIRE(at != std::string::npos);
    const std::string safe = message.substr(at + 15, message.find(" s (\"", at) - at - 15);
    CHECK(error_of(with(kHeap, "\"1/25 contact\"", safe)) == "accepted");
  }

  TEST_CASE("a frictionless run carries neither spin nor memory") {
    const auto without_friction = make_run(parse_scene<2>(kFrictionless, "s.toml"));
    const auto with_friction = make_run(parse_scene<2>(kHeap, "s.toml"));

    CHECK(without_friction->spins() == nullptr);
    CHECK(without_friction->size().spin_per_grain == 0);
    CHECK(without_friction->size().memory_per_pair == 0);
    CHECK(without_friction->size().per_near_pair == sizeof(Pair));
    CHECK(with_friction->spins() != nullptr);
    CHECK(with_friction->size().spin_per_grain == 24);
    CHECK(with_friction->size().memory_per_pair == 16);
    CHECK(explain(*without_friction).find("for spin") == std::string::npos);
    CHECK(explain(*with_friction).find("24 of them for spin") != std::string::npos);
  }

  TEST_CASE("an audited run checks every step and misses nothing") {
    const auto run = make_run(parse_scene<2>(with(kHeap, "seed = 5", "audit = true"), "s.toml"));
    run->advance_to(0.02);

    CHECK(run->audit().checks() == run->steps() + 1);
    CHECK(run->audit().contacts() > 0);
    CHECK(run->audit().missed() == 0);
  }

  TEST_CASE("contacts push their grains apart, and walls feel the sum") {
    const auto run = make_run(parse_scene<2>(kHeap, "s.toml"));
    run->advance_to(0.02);

    Vec<2> on_floor = Vec<2>::Zero();
    for (const auto& contact : run->contacts()) {
      CHECK(contact.force.dot(contact.normal) >= 0);
      CHECK((contact.j < 0) == (contact.wall >= 0));
      if (contact.wall == 0) on_floor -= contact.force;
    }
    // The wall's force was taken with the predicted velocities, a fraction of a step earlier.
    CHECK((on_floor - run->walls()[0].force).norm() < 1e-2 * on_floor.norm());
  }

  TEST_CASE("a run folder holds the run, and its scene gives the same run bit for bit") {
    const Folder first;
    const Folder second;
    const std::string text =
        kHeap +
        "[[pair]]\nbetween = [\"rock\", \"gravel\"]\nfriction = 0.1\n[output]\nframes_every "
        "= \"5 ms\"\ncontacts = true\n";
    const auto once = make_run(parse_scene<2>(text, "s.toml"));
    REQUIRE(record(*once, {first.path, {}, {}}));

    const auto again = make_run(read_scene<2>(first.path / "scene.toml"));
    REQUIRE(record(*again, {second.path, {}, {}}));

    int compared = 0;
    for (const auto& entry : fs::recursive_directory_iterator(first.path)) {
      if (!entry.is_regular_file() || entry.path().filename() == "summary.txt") continue;
      const fs::path name = entry.path().lexically_relative(first.path);
      CAPTURE(name.string());
      CHECK(content(entry.path()) == content(second.path / name));
      ++compared;
    }
    CHECK(compared == 3 + 2 * 5);
    CHECK(content(first.path / "frames/0000.csv").substr(0, 73) ==
          "id[-],x[m],y[m],vx[m/s],vy[m/s],omega[rad/s],radius[m],material[-]\n0,0.05");
    CHECK(content(first.path / "series.csv").substr(0, 18) == "time[s],kinetic[J]");
    CHECK(content(first.path / "summary.txt").find("finished") != std::string::npos);
  }

  TEST_CASE("a run that is stopped keeps what was computed") {
    const Folder folder;
    const auto run = make_run(parse_scene<2>(kHeap, "s.toml"));
    int steps = 0;

    const bool finished = record(*run, {folder.path, [&] { return ++steps == 30; }, {}});

    CHECK(!finished);
    CHECK(run->steps() == 30);
    CHECK(content(folder.path / "frames/0001.csv") == frame_csv(*run));
    CHECK(content(folder.path / "summary.txt").find("stopped by the user") != std::string::npos);
  }

  TEST_CASE("a run that breaks off says who, when and why, and keeps the last good state") {
    const Folder folder;
    const auto run = make_run(
        parse_scene<2>(with(with(kHeap, "velocity = [0, \"-2 m/s\"]", "velocity = [0, -400]"),
                            "seed = 5", "largest_overlap = 0.2"),
                       "s.toml"));
    std::string message;

    try {
      record(*run, {folder.path, {}, {}});
    } catch (const SimulationError& error) {
      message = error.what();
    }

    CHECK(message.substr(0, 4) == "t = ");
    CHECK(message.find("grain 0 overlaps grain 1 by 0.") != std::string::npos);
    CHECK(message.find("smaller time step") != std::string::npos);
    CHECK(message.find("last.csv") != std::string::npos);
    CHECK(content(folder.path / "last.csv").substr(0, 6) == "id[-],");
    CHECK(content(folder.path / "last.csv").find("nan") == std::string::npos);
    CHECK(content(folder.path / "summary.txt").find("broke off") != std::string::npos);
  }

  TEST_CASE("a folder that cannot be written is an error before the first step") {
    const Folder folder;
    fs::create_directories(folder.path);
    std::ofstream(folder.path / "file") << "x";
    const auto run = make_run(parse_scene<2>(kHeap, "s.toml"));

    CHECK_THROWS_AS(record(*run, {folder.path / "file" / "run", {}, {}}), SceneError);
    CHECK_THROWS_AS(record(*run, {folder.path / "file", {}, {}}), SceneError);
    CHECK(run->steps() == 0);
  }

  TEST_CASE("a second run into the same folder leaves no frame of the first") {
    const Folder folder;
    const std::string often = kHeap + "[output]\nframes_every = \"1 ms\"\n";
    record(*make_run(parse_scene<2>(often, "s.toml")), {folder.path, {}, {}});
    REQUIRE(fs::exists(folder.path / "frames/0010.csv"));
    std::ofstream(folder.path / "frames/notes.csv") << "mine";

    record(*make_run(parse_scene<2>(kHeap, "s.toml")), {folder.path, {}, {}});

    CHECK(!fs::exists(folder.path / "frames/0010.csv"));
    CHECK(fs::exists(folder.path / "frames/0001.csv"));
    CHECK(fs::exists(folder.path / "frames/notes.csv"));
  }
}
