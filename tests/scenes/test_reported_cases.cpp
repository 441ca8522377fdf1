// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/run.hpp>

#include <lagrain/output.hpp>

#include <support/tolerance.hpp>
#include "support/files.hpp"
#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

// Scenes that users of other codes reported, each with the value that is right.

namespace {

/// Keys that all of these scenes share.
std::string head(int dimension, const std::string& duration, const std::string& stiffness,
                 double restitution = 0.5, const std::string& friction = "none") {
  return "dimension = " + std::to_string(dimension) + "\nduration = \"" + duration +
         "\"\ngravity = [0, " + (dimension == 3 ? "0, " : "") + "-9.81]\nnormal = \"linear\"\n" +
         "friction = \"" + friction + "\"\n[law]\nstiffness = \"" + stiffness +
         "\"\nrestitution = " + std::to_string(restitution) + "\n" +
         (friction == "none" ? "" : "friction = 0.5\n") + "[materials.glass]\ndensity = 1000\n";
}

std::string segment(const std::string& from, const std::string& to, const std::string& name) {
  return "[[wall]]\nname = \"" + name + "\"\nfrom = " + from + "\nto = " + to + "\n";
}
std::string plate(const std::string& corners, const std::string& name) {
  return "[[wall]]\nname = \"" + name + "\"\ncorners = [" + corners + "]\n";
}

std::string grain(const std::string& place, const std::string& radius,
                  const std::string& more = "") {
  return "[[grain]]\nposition = " + place + "\nradius = \"" + radius + "\"\n" + more;
}

template <int Dim>
std::unique_ptr<Run<Dim>> started(const std::string& text, int threads = 1) {
  return make_run<Dim>(parse_scene<Dim>(text, "s.toml"), threads);
}

template <int Dim>
std::unique_ptr<Run<Dim>> finished(const std::string& text, int threads = 1) {
  auto run = started<Dim>(text, threads);
  run->advance_to(run->scene().duration);
  return run;
}

template <int Dim>
std::string error_of(const std::string& text) {
  return scene_error_of([&] { started<Dim>(text); });
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What a run that is recorded says when it breaks off, and what is in its summary.
struct Recorded {
  std::string message, summary, last;
};
template <int Dim>
Recorded recorded(const std::string& text) {
  const Folder folder;
  const auto run = started<Dim>(text);
  Recorded result;
  try {
    record(*run, {folder.path, {}, {}});
  } catch (const SimulationError& error) {
    result.message = error.what();
  }
  result.summary = content(folder.path / "summary.txt");
  result.last = content(folder.path / "last.csv");
  return result;
}

/// A disc of 50 mm over a line, 1000 kg/m^3, at rest under its weight on 1e5 N/m.
constexpr double kDisc = 1000 * std::numbers::pi * 0.05 * 0.05 * 9.81, kSunk = kDisc / 1e5;

}  // namespace

TEST_SUITE("reported cases") {
  // ---- Surfaces made of pieces
  // -------------------------------------------------------------------

  TEST_CASE("a disc rests on the joint of two segments (box2d#553, rapier#669, phasicFlow#242)") {
    const std::string text = head(2, "3 s", "1e5 N/m") + grain("[0, 0.05]", "50 mm") +
                             segment("[-1.0, 0]", "[0.0, 0]", "s0") +
                             segment("[0.0, 0]", "[1.0, 0]", "s1");
    const auto run = finished<2>(text);

    CHECK(relative_error(0.05 - run->positions()(1, 0), 0.000770476) < 1e-6);
    CHECK(relative_error(run->positions()(1, 0), 0.049229524) < 1e-8);
    REQUIRE(run->contacts().size() == 1);
    CHECK(relative_error(run->contacts()[0].overlap, kSunk) < 1e-8);
    const Vec<2> force = run->walls()[0].force + run->walls()[1].force;
    CHECK(relative_error(-force[1], kDisc) < 1e-8);
  }

  TEST_CASE("discs rest at, before and beyond joints of a polyline given in any order") {
    std::string text = head(2, "3 s", "1e5 N/m");
    // Five pieces from -0.2 to 1.3, with sums of tenths as a person's script writes them.
    text += segment("[0.30000000000000004, 0]", "[0.7, 0]", "c") +
            segment("[0.1, 0]", "[-0.2, 0]", "a") + segment("[0.3, 0]", "[0.1, 0]", "b") +
            segment("[0.7, 0]", "[1.3, 0]", "d");
    for (const std::string x : {"-0.15", "0.1", "0.3", "0.5", "0.7000000001", "0.85", "1.2"}) {
      text += grain("[" + x + ", 0.05]", "50 mm");
    }
    const auto run = finished<2>(text);
    CHECK(run->contacts().size() == 7);
    for (int i = 0; i < run->count(); ++i) {
      CHECK(relative_error(0.05 - run->positions()(1, i), kSunk) < 1e-8);
    }
  }

  TEST_CASE("spheres rest where plates of a floor meet (lethe#2108)") {
    std::string text = head(3, "3 s", "1e4 N/m");
    text += plate("[0, 0, 0], [1, 0, 0], [0, 1, 0]", "a") +
            plate("[1, 0, 0], [1, 1, 0], [0, 1, 0]", "b") +
            plate("[-1, 0, 0], [0, 0, 0], [0, 1, 0], [-1, 1, 0]", "c") +
            plate("[0, 0, 0], [-1, 0, 0], [-1, -1, 0], [0, -1, 0]", "d") +
            plate("[0, -1, 0], [1, -1, 0], [1, 0, 0], [0, 0, 0]", "e");
    for (const std::string place :
         {"[0, 0, 0.05]", "[0.5, 0.5, 0.05]", "[0.3, 0, 0.05]", "[0, -0.4, 0.05]",
          "[0.2, 0.7, 0.05]", "[-0.9, 0.9, 0.05]", "[0.7, 0.3, 0.05]"}) {
      text += grain(place, "50 mm");
    }
    const auto run = finished<3>(text);
    const double sunk = run->masses()[0] * 9.81 / 1e4;
    CHECK(run->contacts().size() == 7);
    for (int i = 0; i < run->count(); ++i) {
      CHECK(relative_error(0.05 - run->positions()(2, i), sunk) < 1e-8);
    }
  }

  TEST_CASE("a disc slides over the joints of a polyline as over one segment (box2d#553)") {
    const auto slid = [](const std::string& walls) {
      return finished<2>("largest_initial_overlap = 0.02\n" + head(2, "0.5 s", "1e5 N/m", 1) +
                         grain("[0.1, 0.04922952440170711]", "50 mm", "velocity = [2, 0]\n") +
                         walls);
    };
    const auto pieces =
        slid(segment("[0, 0]", "[0.3, 0]", "a") + segment("[0.3, 0]", "[0.45, 0]", "b") +
             segment("[0.45, 0]", "[0.9, 0]", "c") + segment("[0.9, 0]", "[3, 0]", "d"));
    const auto whole = slid(segment("[0, 0]", "[3, 0]", "a"));
    CHECK(relative_error(pieces->velocities()(0, 0), 2) < 1e-12);
    CHECK(std::abs(pieces->positions()(1, 0) - whole->positions()(1, 0)) < 1e-13);
    CHECK(std::abs(pieces->energy_residual()) < 1e-10 * pieces->ledger().kinetic);
  }

  // ---- A plate in space
  // --------------------------------------------------------------------------

  TEST_CASE("a wall from one point to another in space is refused, with the remedy (lethe PR617)") {
    const std::string text = head(3, "0.5 s", "1e5 N/m") + grain("[0.5, 0.2, 0.3]", "50 mm");
    const std::string message =
        error_of<3>(text + "[[wall]]\nname = \"plate\"\nfrom = [0, 0, 0]\nto = [1, 1, 0]\n");
    CHECK(has(message, "wall[0].from"));
    CHECK(has(message, "corners = [["));

    // The remedy: a sphere falls on the plate, and lies on it.
    const auto run = finished<3>(with(text, "0.5 s", "3 s") +
                                 plate("[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]", "plate"));
    CHECK(relative_error(0.05 - run->positions()(2, 0), run->masses()[0] * 9.81 / 1e5) < 1e-6);
    CHECK(run->contacts().size() == 1);
  }

  // ---- Pinned grains
  // -----------------------------------------------------------------------------

  TEST_CASE("a pinned disc sunk in the floor exerts nothing (MercuryDPM, in.chute)") {
    const std::string text = "largest_initial_overlap = 1.5\n" + head(2, "2 s", "1e5 N/m") +
                             grain("[0, 0]", "50 mm", "pinned = true\n") +
                             grain("[0.5, 0.05]", "50 mm") +
                             "[[wall]]\nname = \"floor\"\npoint = [0, 0]\nnormal = [0, 1]\n";
    const auto first = started<2>(text);
    CHECK(first->contacts().size() <= 1);
    CHECK(first->ledger().elastic == 0);
    CHECK(first->walls()[0].force[1] == 0);

    const auto run = finished<2>(text);
    CHECK(relative_error(run->walls()[0].force[1], -kDisc) < 1e-6);
    REQUIRE(run->contacts().size() == 1);
    CHECK(run->contacts()[0].i == 1);
    // The ledger holds the loose disc's spring alone.
    CHECK(relative_error(run->ledger().elastic, 0.5 * 1e5 * kSunk * kSunk) < 1e-6);
    // It needs no leave to overlap either.
    CHECK(error_of<2>(without(text, "largest_initial_overlap = 1.5")) == "accepted");
  }

  TEST_CASE("beads glued to the ground do not set the time step (lammps: glued beads)") {
    std::string text = head(3, "1 ms", "1e4 N/m", 1);
    text = with(text, "density = 1000", "density = 2500");
    text += grain("[0, 0, 0]", "1 mm", "pinned = true\n") +
            grain("[\"3 mm\", 0, 0]", "1 mm", "pinned = true\n") +
            grain("[0, 0, \"20 mm\"]", "10 mm") + grain("[\"30 mm\", 0, \"20 mm\"]", "10 mm");
    CHECK(relative_error(started<3>(text)->time_scales().contact, 0.00227326) < 1e-5);
    // Over a floor, too.
    CHECK(
        relative_error(
            started<3>(text + "[[wall]]\nname = \"floor\"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n")
                ->time_scales()
                .contact,
            0.00227326) < 1e-5);
  }

  TEST_CASE("where nothing can move a step is asked for, and one in seconds is taken") {
    const std::string text = head(2, "1 ms", "1e5 N/m") +
                             grain("[0, 0]", "50 mm", "pinned = true\n") +
                             grain("[0.05, 0]", "50 mm", "pinned = true\n") +
                             "[[wall]]\nname = \"floor\"\npoint = [0, 0]\nnormal = [0, 1]\n";
    CHECK(
        error_of<2>(text) ==
        "s.toml: time_step: nothing in the scene can move, so no contact sets a step; give one in "
        "seconds, or a grain that is not pinned");
    CHECK(
        has(error_of<2>("time_step = \"1/50 contact\"\n" + text), "s.toml:1: time_step: nothing"));

    const auto run = finished<2>("time_step = \"10 us\"\n" + text);
    CHECK(run->steps() == 100);
    CHECK(run->contacts().empty());
    CHECK(run->ledger().balance() == run->start().balance());
    CHECK(has(explain(*run), "nothing in the scene can move"));
    CHECK(!has(explain(*run), "inf"));
    CHECK(!has(explain(*run), "nan"));
    for (const auto& fact : facts(*run)) {
      CAPTURE(fact.first);
      CHECK(!has(fact.second, "inf"));
      CHECK(!has(fact.second, "nan"));
    }
    const auto written = recorded<2>("time_step = \"10 us\"\n" + text);
    CHECK(written.message == "");
    CHECK(has(written.summary, "finished"));
    CHECK(!has(written.summary, "inf"));
    CHECK(!has(written.summary, "nan"));
    // A piston moves.
    CHECK(error_of<2>(text + "[[wall]]\nname = \"piston\"\npoint = [0, 1]\nnormal = [0, -1]\n"
                             "motion = { type = \"piston\", mass = 2, load = [0, -20] }\n") ==
          "accepted");
  }

  TEST_CASE("on a rough base all neighbourhoods and threads give the same bits, and miss nothing") {
    // 100 pinned spheres that overlap, and 30 that fall on them.
    std::string text = "audit = true\n" + head(3, "0.2 s", "1e5 N/m", 0.5, "elastic");
    for (int k = 0; k < 100; ++k) {
      const auto at = [](int n) { return std::to_string(n * 0.06); };
      text += grain(
          "[" + at(k % 10) + ", " + at(k / 10) + ", " + std::to_string(0.01 * (k * 7 % 5)) + "]",
          "50 mm", "pinned = true\n");
    }
    text +=
        "[[fill]]\ncount = 30\nradius = { uniform = [\"40 mm\", \"50 mm\"] }\n"
        "region = { low = [0, 0, 0.15], high = [0.55, 0.55, 0.6] }\nvelocity = [0.3, 0, -1]\n"
        "[[wall]]\nname = \"floor\"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n";
    const auto moved = [&](const std::string& neighbourhood, int threads) {
      auto run = finished<3>("neighbourhood = \"" + neighbourhood + "\"\n" + text, threads);
      CHECK(run->audit().missed() == 0);
      CHECK(run->audit().contacts() > 100);
      for (const Pair& pair : run->near_pairs()) CHECK((pair.i >= 100 || pair.j >= 100));
      for (const auto& contact : run->contacts()) CHECK((contact.i >= 100 || contact.j >= 100));
      return Columns<3>(run->positions());
    };
    const Columns<3> brute = moved("all pairs", 1);
    for (const std::string name : {"triangulation", "linked cells"}) {
      for (const int threads : {1, 4}) {
        CAPTURE(name);
        CAPTURE(threads);
        const bool same = moved(name, threads) == brute;
        CHECK(same);
      }
    }
  }

  TEST_CASE("discs on a rough base in the plane: the same bits from all neighbourhoods") {
    std::string text = "audit = true\n" + head(2, "0.3 s", "1e5 N/m", 0.5, "elastic");
    for (int k = 0; k < 40; ++k) {
      text +=
          grain("[" + std::to_string(k * 0.03) + ", " + std::to_string(0.01 * (k * 7 % 5)) + "]",
                "50 mm", "pinned = true\n");
    }
    text +=
        "[[fill]]\ncount = 20\nradius = { uniform = [\"40 mm\", \"50 mm\"] }\n"
        "region = { low = [0, 0.15], high = [1.2, 0.7] }\nvelocity = [0.3, -1]\n";
    const auto moved = [&](const std::string& neighbourhood) {
      auto run = finished<2>("neighbourhood = \"" + neighbourhood + "\"\n" + text);
      CHECK(run->audit().missed() == 0);
      CHECK(run->audit().contacts() > 100);
      for (const Pair& pair : run->near_pairs()) CHECK((pair.i >= 40 || pair.j >= 40));
      return Columns<2>(run->positions());
    };
    const Columns<2> brute = moved("all pairs");
    const bool triangulated = moved("triangulation") == brute,
               cells = moved("linked cells") == brute;
    CHECK(triangulated);
    CHECK(cells);
  }

  // ---- Passing through
  // ---------------------------------------------------------------------------

  TEST_CASE(
      "a bullet that crosses a disc or a thin wall breaks the run off (box2d#73, rapier#421)") {
    const std::string shot = with(head(2, "50 ms", "1e3 N/m", 1), "-9.81", "0") +
                             grain("[-1, 0]", "10 mm", "velocity = [100, 0]\n");
    const std::string disc = shot + grain("[0, 0]", "10 mm");
    const std::string wall = shot + segment("[0, -1]", "[0, 1]", "thin");
    for (const std::string& more : {std::string(), std::string("audit = true\n")}) {
      const auto through_disc = recorded<2>(more + disc);
      CHECK(has(through_disc.message, "grain 0 passed through grain 1 near ("));
      CHECK(has(through_disc.message, "a time step of at most "));
      CHECK(has(through_disc.message, "last.csv"));
      CHECK(has(through_disc.summary, "broke off"));
      CHECK(!has(through_disc.summary, "finished"));
      CHECK(through_disc.last.substr(0, 6) == "id[-],");
      CHECK(!has(through_disc.last, "nan"));

      const auto through_wall = recorded<2>(more + wall);
      CHECK(has(through_wall.message, "grain 0 passed through wall thin near ("));
      CHECK(has(through_wall.summary, "broke off"));
      CHECK(!has(through_wall.summary, "finished"));
    }
    // The last good state is before the passage: the bullet is on its own side.
    const auto last = recorded<2>(disc).last;
    const auto line = last.find('\n') + 1;
    CHECK(last.substr(line, 3) == "0,-");

    // At the step that the message names, either nothing passes, or the run stops for its overlap.
    for (const std::string& text : {disc, wall}) {
      const std::string message = recorded<2>(text).message;
      const auto at = message.find("at most ") + 8;
      const double step = std::strtod(message.c_str() + at, nullptr);
      REQUIRE(step > 0);
      const auto again = recorded<2>("time_step = " + std::to_string(step * 1e6) + "e-6\n" + text);
      CHECK(!has(again.message, "passed"));
      CHECK(has(again.message, "overlaps"));
    }
    // With a law as stiff as such a speed asks for, it bounces, and the summary says so.
    for (const std::string& text : {disc, wall}) {
      const auto bounced = recorded<2>(with(text, "1e3 N/m", "1e9 N/m"));
      CHECK(bounced.message == "");
      CHECK(has(bounced.summary, "finished"));
    }
  }

  TEST_CASE("a bullet in space, a plate, and one that misses (bullet3#2483)") {
    const std::string shot = with(head(3, "50 ms", "1e3 N/m", 1), "-9.81", "0") +
                             grain("[-1, 0, 0]", "10 mm", "velocity = [100, 3, 1]\n");
    CHECK(
        has(recorded<3>(shot + plate("[0, -1, -1], [0, 1, -1], [0.1, 1, 1], [0.1, -1, 1]", "thin"))
                .message,
            "grain 0 passed through wall thin near ("));
    CHECK(has(recorded<3>(shot + plate("[0, -1, -1], [0, 1, -1], [0.1, 0, 1]", "thin")).message,
              "grain 0 passed through wall thin near ("));
    const auto missed = recorded<3>(shot + plate("[0, 1, -1], [0, 2, -1], [0, 1.5, 1]", "thin"));
    CHECK(missed.message == "");
    CHECK(has(missed.summary, "finished"));
    const auto beside = recorded<3>(shot + grain("[0, 0.06, 0]", "10 mm"));
    CHECK(beside.message == "");
  }

  TEST_CASE("a thin wall that moves fast breaks the run off, too (rapier.js#286)") {
    const std::string still = with(head(2, "50 ms", "1e3 N/m", 1), "-9.81", "0") +
                              grain("[0.1, 0]", "10 mm") + grain("[0.5, 0.3]", "10 mm");
    const std::string wall = segment("[-1, -1]", "[-1, 1]", "paddle");
    for (const std::string motion :
         {"motion = { type = \"steady\", velocity = [100, 0] }\n",
          "motion = { type = \"shake\", amplitude = [3, 0], frequency = 10 }\n",
          "motion = { type = \"piston\", mass = 1, load = [2e4, 0] }\n",
          "motion = { type = \"steady\", velocity = [100, 0], start = \"5 ms\" }\n"}) {
      CAPTURE(motion);
      const auto swept = recorded<2>(still + wall + motion);
      CHECK(has(swept.message, "passed through wall paddle near ("));
      CHECK(has(swept.message, "grain 0"));
      CHECK(has(swept.summary, "broke off"));
    }
  }
}
