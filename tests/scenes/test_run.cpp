// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/run.hpp>

#include <lagrain/hooke.hpp>
#include <lagrain/output.hpp>

#include <support/tolerance.hpp>
#include "support/files.hpp"
#include "support/scene_text.hpp"
#include "support/space.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

const std::string kFrictionless = without(with(kHeap, "\"elastic\"", "\"none\""), "friction = 0.4");

template <int Dim>
Scene<Dim> scene_of(const std::string& text) {
  return parse_scene<Dim>(in_space<Dim>(text), "s.toml");
}

template <int Dim>
std::string trajectory(const std::string& text) {
  const auto run = make_run(scene_of<Dim>(text));
  run->advance_to(run->scene().duration);
  return frame_csv(*run);
}

template <int Dim>
std::string error_of(const std::string& text) {
  return scene_error_of([&] { make_run(scene_of<Dim>(text)); });
}

/// Forty pairs of discs that meet head-on at 1 m/s each. Their gaps are spread evenly over a time
/// step, and lasting `steps` steps a contact meets all phases of it.
std::string head_on_impacts(double restitution, double steps) {
  const double radius = 0.05, stiffness = 1e7, mass = 1000 * std::numbers::pi * radius * radius;
  const double contact =
      LinearSpring::with_restitution(stiffness, restitution).contact_time(mass / 2, radius / 2);
  std::ostringstream text;
  text.precision(17);
  text << "title = \"impacts\"\ndimension = 2\nduration = " << 10 * contact << "\ntime_step = \""
       << 1 / steps << " contact\"\ngravity = [0, 0]\n"
       << "normal = \"linear\"\nfriction = \"none\"\n[law]\nstiffness = " << stiffness
       << "\nrestitution = " << restitution << "\n[materials.a]\ndensity = 1000\n";
  for (int k = 0; k < 40; ++k) {
    const double x = radius + (2 + (k + 0.5) / 40) * contact / steps;
    for (const double side : {-1.0, 1.0}) {
      text << "[[grain]]\nposition = [" << side * x << ", " << 0.3 * k
           << "]\nradius = 0.05\nvelocity = [" << -side << ", 0]\n";
    }
  }
  return text.str();
}

}  // namespace

TEST_SUITE("run") {
  TEST_CASE("discs that meet head-on leave at the restitution named, at any phase of the step") {
    for (const double restitution : {1.0, 0.9, 0.5, 0.2}) {
      for (const double steps : {25.0, 25.5, 50.0}) {
        CAPTURE(restitution);
        CAPTURE(steps);
        const auto run = make_run(scene_of<2>(head_on_impacts(restitution, steps)));
        run->advance_to(run->scene().duration);

        double worst = 0;
        for (int i = 0; i < run->count(); ++i) {
          const double away = (i % 2 == 0 ? -1 : 1) * run->velocities()(0, i);
          worst = std::max(worst, std::abs(away / restitution - 1));
        }
        // Second order: 0.2 % with 25 steps at worst, 0.1 % as root mean square (test_contact_law).
        CHECK(worst < 2e-3 * std::pow(25 / steps, 2));
      }
    }
  }

  TEST_CASE_TEMPLATE(
      "every model that a scene can name runs, with the same bits from two neighbourhoods", S,
      Space<2>, Space<3>) {
    const std::string conservative = with(kFrictionless, "restitution = 0.5", "restitution = 1");
    for (const std::string& text :
         {kHeap, kFrictionless, with(kHeap, "\"elastic\"", "\"viscous\""),
          with(kHeap, "seed = 5", "integrator = \"symplectic Euler\""),
          with(conservative, "seed = 5", "integrator = \"fourth order\""),
          with(with(kHeap, "\"linear\"", "\"hertz\""), "stiffness = \"1e7 N/m\"",
               "modulus = \"2 GPa\"\nimpact_speed = 2")}) {
      CAPTURE(text);
      CHECK(trajectory<S::Dim>(text) ==
            trajectory<S::Dim>(with(text, "linked cells", "all pairs")));
    }
  }

  TEST_CASE_TEMPLATE("the time step is the stated fraction of the shortest contact time", S,
                     Space<2>, Space<3>) {
    const auto run = make_run(scene_of<S::Dim>(kHeap));

    CHECK(relative_error(run->time_step(), run->time_scales().contact / 25) < 1e-15);
    const auto steps = static_cast<double>(run->steps_planned());
    CHECK(steps * run->time_step() >= 0.02 * (1 - 1e-9));
    CHECK((steps - 1) * run->time_step() < 0.02);
  }

  TEST_CASE_TEMPLATE("too large a time step is an error that names the safe one", S, Space<2>,
                     Space<3>) {
    const std::string message = error_of<S::Dim>(with(kHeap, "1/25 contact", "1/5 contact"));

    CHECK(message.substr(0, 21) == "s.toml:5: time_step: ");
    const auto at = message.find("allows at most ");
    REQUIRE(at != std::string::npos);
    const std::string safe = message.substr(at + 15, message.find(" s (\"", at) - at - 15);
    CHECK(error_of<S::Dim>(with(kHeap, "\"1/25 contact\"", safe)) == "accepted");
  }

  TEST_CASE_TEMPLATE("a frictionless run carries neither spin nor memory", S, Space<2>, Space<3>) {
    const auto without_friction = make_run(scene_of<S::Dim>(kFrictionless));
    const auto with_friction = make_run(scene_of<S::Dim>(kHeap));

    CHECK(without_friction->spins() == nullptr);
    CHECK(without_friction->size().spin_per_grain == 0);
    CHECK(without_friction->size().memory_per_pair == 0);
    CHECK(without_friction->size().per_near_pair == sizeof(Pair));
    CHECK(with_friction->spins() != nullptr);
    CHECK(with_friction->size().spin_per_grain == (S::Dim == 2 ? 16 : 64));
    CHECK(with_friction->size().memory_per_pair == 8 * S::Dim);
    CHECK(explain(*without_friction).find("for spin") == std::string::npos);
    CHECK(
        explain(*with_friction).find(S::Dim == 2 ? "16 of them for spin" : "64 of them for spin") !=
        std::string::npos);
  }

  TEST_CASE_TEMPLATE("an audited run checks every step and misses nothing", S, Space<2>, Space<3>) {
    const auto run = make_run(scene_of<S::Dim>(with(kHeap, "seed = 5", "audit = true")));
    run->advance_to(0.02);

    CHECK(run->audit().checks() == run->steps() + 1);
    CHECK(run->audit().contacts() > 0);
    CHECK(run->audit().missed() == 0);
  }

  TEST_CASE_TEMPLATE("contacts push their grains apart, and walls feel the sum", S, Space<2>,
                     Space<3>) {
    const auto run = make_run(scene_of<S::Dim>(kHeap));
    run->advance_to(0.02);

    Vec<S::Dim> on_floor = Vec<S::Dim>::Zero();
    for (const auto& contact : run->contacts()) {
      CHECK(contact.force.dot(contact.normal) >= 0);
      CHECK((contact.j < 0) == (contact.wall >= 0));
      if (contact.wall == 0) on_floor -= contact.force;
    }
    // The wall's force was taken with the predicted velocities, a fraction of a step earlier.
    CHECK((on_floor - run->walls()[0].force).norm() < 1e-2 * on_floor.norm());
  }

  TEST_CASE_TEMPLATE("a run folder holds the run, and its scene gives the same run bit for bit", S,
                     Space<2>, Space<3>) {
    const Folder first;
    const Folder second;
    const std::string text = kHeap +
                             "[[pair]]\nbetween = [\"rock\", \"gravel\"]\nfriction = 0.1\n"
                             "[output]\nframes_every = \"5 ms\"\ncontacts = true\n";
    const auto once = make_run(scene_of<S::Dim>(text));
    REQUIRE(record(*once, {first.path, {}, {}}));

    const auto again = make_run(read_scene<S::Dim>(first.path / "scene.toml"));
    REQUIRE(record(*again, {second.path, {}, {}}));

    int compared = 0;
    for (const auto& entry : fs::recursive_directory_iterator(first.path)) {
      // Two files know how long the run took.
      if (!entry.is_regular_file() || entry.path().filename() == "summary.txt" ||
          entry.path().extension() == ".h5") {
        continue;
      }
      const fs::path name = entry.path().lexically_relative(first.path);
      CAPTURE(name.string());
      CHECK(content(entry.path()) == content(second.path / name));
      ++compared;
    }
    CHECK(compared == 3 + 2 * 5);
    const std::string frame = content(first.path / "frames/0000.csv");
    CHECK(frame.substr(0, frame.find('\n')) ==
          (S::Dim == 2 ? "id[-],x[m],y[m],vx[m/s],vy[m/s],omega[rad/s],radius[m],material[-]"
                       : "id[-],x[m],y[m],z[m],vx[m/s],vy[m/s],vz[m/s],omega_x[rad/s],"
                         "omega_y[rad/s],omega_z[rad/s],radius[m],material[-]"));
    CHECK(frame.substr(frame.find('\n'), 7) == "\n0,0.05");
    const std::string contacts = content(first.path / "contacts/0004.csv");
    CHECK(contacts.substr(0, contacts.find('\n')) ==
          (S::Dim == 2 ? "i[-],j[-],wall[-],overlap[m],nx[-],ny[-],fx[N],fy[N]"
                       : "i[-],j[-],wall[-],overlap[m],nx[-],ny[-],nz[-],fx[N],fy[N],fz[N]"));
    CHECK(content(first.path / "series.csv").substr(0, 18) == "time[s],kinetic[J]");
    CHECK(content(first.path / "summary.txt").find("finished") != std::string::npos);
  }

  TEST_CASE_TEMPLATE("a contact in a file is between two grains, or a grain and a wall", S,
                     Space<2>, Space<3>) {
    const auto run = make_run(scene_of<S::Dim>(kHeap));
    run->advance_to(0.02);
    std::istringstream lines(contacts_csv(*run));
    std::string line;
    std::getline(lines, line);
    std::size_t rows = 0, at_walls = 0;
    for (; std::getline(lines, line); ++rows) {
      int i = -2, j = -2, wall = -2;
      char comma = 0;
      std::istringstream(line) >> i >> comma >> j >> comma >> wall;
      CHECK((j == -1) != (wall == -1));
      if (wall >= 0) {
        ++at_walls;
        CHECK(wall < static_cast<int>(run->walls().size()));
      } else {
        CHECK(i < j);
      }
    }
    CHECK(rows == run->contacts().size());
    CHECK(at_walls > 0);
    CHECK(rows > at_walls);
  }

  TEST_CASE_TEMPLATE("what a run will write is guessed to a factor of two", S, Space<2>, Space<3>) {
    const std::string many =
        with(with(kHeap, "count = 12", "count = 600"), "high = [\"0.1 m\", \"0.2 m\"]",
             S::Dim == 2 ? "high = [0.4, 1]" : "high = [\"0.2 m\", \"0.4 m\"]");
    for (const char* const formats :
         {"\"csv\"", "\"vtp\"", "\"cells\"", "\"xyz\"", "\"hdf5\"", "\"csv\", \"xyz\", \"vtp\""}) {
      CAPTURE(formats);
      const Folder folder;
      const auto run = make_run(scene_of<S::Dim>(
          many + "[output]\nframes_every = \"2 ms\"\nformats = [" + formats + "]\n"));
      const OutputEstimate guess = estimate_output(*run);
      REQUIRE(record(*run, {folder.path, {}, {}}));
      double bytes = 0;
      for (const auto& entry : fs::recursive_directory_iterator(folder.path)) {
        if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
      }
      CHECK(guess.frames == 11);
      CHECK(guess.bytes < 2 * bytes);
      CHECK(guess.bytes > bytes / 2);
    }
  }

  TEST_CASE_TEMPLATE("a run that is stopped keeps what was computed", S, Space<2>, Space<3>) {
    const Folder folder;
    const auto run = make_run(scene_of<S::Dim>(kHeap));
    int steps = 0;

    const bool finished = record(*run, {folder.path, [&] { return ++steps == 30; }, {}});

    CHECK(!finished);
    CHECK(run->steps() == 30);
    CHECK(content(folder.path / "frames/0001.csv") == frame_csv(*run));
    CHECK(content(folder.path / "summary.txt").find("stopped by the user") != std::string::npos);
  }

  TEST_CASE_TEMPLATE(
      "a run of very many grains looks up seldom, and records the same as one step by step", S,
      Space<2>, Space<3>) {
    const std::string text =
        with(with(with(kHeap, "count = 12", "count = 10500"), "\"0.1 m\"", "\"30 m\""),
             "duration = \"20 ms\"", "duration = \"2 ms\"") +
        "[output]\nframes_every = \"0.5 ms\"\nseries_every = \"0.5 ms\"\n";
    const Folder folder;
    int looks = 0;
    REQUIRE(
        record(*make_run(scene_of<S::Dim>(text)), {folder.path, [&] { return ++looks < 0; }, {}}));

    const auto run = make_run(scene_of<S::Dim>(text));
    REQUIRE(run->count() > 10000);
    for (int frame = 0; frame <= 4; ++frame) {
      const auto due =
          frame < 4 ? std::llround(frame * 0.5e-3 / run->time_step()) : run->steps_planned();
      while (run->steps() < due) run->step();
      CAPTURE(frame);
      const bool same =
          content(folder.path / ("frames/000" + std::to_string(frame) + ".csv")) == frame_csv(*run);
      CHECK(same);
    }
    CHECK(looks < run->steps() / 4);
  }

  TEST_CASE_TEMPLATE("a run that breaks off says who, when and why, and keeps the last good state",
                     S, Space<2>, Space<3>) {
    const Folder folder;
    const auto run = make_run(
        scene_of<S::Dim>(with(with(kHeap, "velocity = [0, \"-2 m/s\"]", "velocity = [0, -400]"),
                              "seed = 5", "largest_overlap = 0.2")));
    std::string message;

    try {
      record(*run, {folder.path, {}, {}});
    } catch (const SimulationError& error) {
      message = error.what();
    }

    CHECK(message.substr(0, 4) == "t = ");
    CHECK(message.find("grain 0 overlaps grain 1 by 0.") != std::string::npos);
    CHECK(message.find("gentler start") != std::string::npos);
    CHECK(message.find("last.csv") != std::string::npos);
    CHECK(content(folder.path / "last.csv").substr(0, 6) == "id[-],");
    CHECK(content(folder.path / "last.csv").find("nan") == std::string::npos);
    CHECK(content(folder.path / "summary.txt").find("broke off") != std::string::npos);

    // The whole state is kept as well, and another run can start from it.
    CHECK(message.find("whole in " + (folder.path / "checkpoint.h5").string()) !=
          std::string::npos);
    CHECK(run->steps() % 64 == 0);
    CHECK(frame_csv(*run) == content(folder.path / "last.csv"));
    const auto kept = resume_run<S::Dim>(read_checkpoint(folder.path), {}, 1);
    CHECK(frame_csv(*kept) == frame_csv(*run));
    const auto undisturbed = make_run(run->scene());
    undisturbed->step(run->steps());
    CHECK(frame_csv(*undisturbed) == frame_csv(*run));
  }

  TEST_CASE_TEMPLATE("what is kept of a run that breaks off remembers its contacts", S, Space<2>,
                     Space<3>) {
    // A bed has come to rest under friction when a stone hits it too hard.
    const Folder folder;
    const std::string text = with(kHeap, "duration = \"20 ms\"", "duration = \"200 ms\"") + R"(
[[grain]]
material = "rock"
radius = "10 mm"
position = [0.05, 50]
velocity = [0, -400]
)";
    const auto run = make_run(scene_of<S::Dim>(text));
    CHECK_THROWS_AS(record(*run, {folder.path, {}, {}}), SimulationError);
    REQUIRE(run->steps() > 64);

    const auto kept = resume_run<S::Dim>(read_checkpoint(folder.path), {}, 1);

    const auto undisturbed = make_run(run->scene());
    undisturbed->step(run->steps());
    CHECK(contacts_csv(*undisturbed) == contacts_csv(*kept));
    CHECK(undisturbed->ledger().kinetic == kept->ledger().kinetic);
    undisturbed->step(10);
    kept->step(10);
    CHECK(frame_csv(*undisturbed) == frame_csv(*kept));
  }

  TEST_CASE_TEMPLATE("a folder that cannot be written is an error before the first step", S,
                     Space<2>, Space<3>) {
    const Folder folder;
    fs::create_directories(folder.path);
    std::ofstream(folder.path / "file") << "x";
    const auto run = make_run(scene_of<S::Dim>(kHeap));

    CHECK_THROWS_AS(record(*run, {folder.path / "file" / "run", {}, {}}), SceneError);
    CHECK_THROWS_AS(record(*run, {folder.path / "file", {}, {}}), SceneError);
    CHECK(run->steps() == 0);
  }

  TEST_CASE_TEMPLATE("a second run into the same folder leaves no frame of the first", S, Space<2>,
                     Space<3>) {
    const Folder folder;
    const std::string often = kHeap + "[output]\nframes_every = \"1 ms\"\n";
    record(*make_run(scene_of<S::Dim>(often)), {folder.path, {}, {}});
    REQUIRE(fs::exists(folder.path / "frames/0010.csv"));
    std::ofstream(folder.path / "frames/notes.csv") << "mine";

    record(*make_run(scene_of<S::Dim>(kHeap)), {folder.path, {}, {}});

    CHECK(!fs::exists(folder.path / "frames/0010.csv"));
    CHECK(fs::exists(folder.path / "frames/0001.csv"));
    CHECK(fs::exists(folder.path / "frames/notes.csv"));
  }

  TEST_CASE_TEMPLATE("the series tells where a moving wall is, and what presses on it", S, Space<2>,
                     Space<3>) {
    const Folder folder;
    const auto run = make_run(scene_of<S::Dim>(
        kHeap +
        "[[wall]]\nname = \"piston\"\nmaterial = \"rock\"\npoint = [0, 0.5]\nnormal = [0, -1]\n"
        "motion = { type = \"piston\", mass = 2, load = [0, -20], start = \"10 ms\" }\n"));
    record(*run, {folder.path, {}, {}});

    const std::string series = content(folder.path / "series.csv");
    const std::string columns = S::Dim == 2 ? "piston.fx[N],piston.fy[N],piston.x[m],piston.y[m]"
                                            : "piston.fx[N],piston.fy[N],piston.fz[N],piston.x[m],"
                                              "piston.y[m],piston.z[m]";
    CHECK(series.substr(0, series.find('\n')).find("," + columns) != std::string::npos);
    const std::string last = series.substr(series.rfind(',') + 1);
    // Free fall under 20 N / 2 kg for 10 ms, whose start and end are each met to a step.
    CHECK(relative_error(0.5 - std::stod(last), 0.5 * 10 * 1e-4) < 4 * run->time_step() / 0.01);
    CHECK(std::stod(last) == run->walls().back().point[S::Dim - 1]);
  }
}
