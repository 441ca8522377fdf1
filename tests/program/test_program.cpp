// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/output.hpp>
#include <lagrain/scene.hpp>

#include "support/cases.hpp"
#include "support/files.hpp"
#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

/// A fresh working folder for one test.
class Place {
 public:
  Place()
      : path_(fs::temp_directory_path() / ("lagrain_test_program_" + std::to_string(getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Place() { fs::remove_all(path_); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  fs::path operator/(const std::string& name) const { return path_ / name; }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

  /// Starts the program, its output going to files.
  pid_t start(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{LAGRAIN_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::cout.flush();  // or the child would print it once more
    const pid_t child = fork();
    if (child != 0) return child;
    if (std::freopen((path_ / "out").c_str(), "w", stdout) == nullptr ||
        std::freopen((path_ / "err").c_str(), "w", stderr) == nullptr || chdir(path_.c_str()) != 0)
      _exit(99);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(LAGRAIN_PROGRAM, argv.data());
    _exit(98);
  }
  /// Waits until the program hears signals, which on a busy machine takes its time, or has ended.
  static void until_it_hears(pid_t child) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    // Until then the child is this test, which hears them as well.
    const std::string name = "Name:\t" + fs::path(LAGRAIN_PROGRAM).filename().string() + "\n";
    while (std::chrono::steady_clock::now() < give_up) {
      const std::string status = content("/proc/" + std::to_string(child) + "/status");
      const std::string key = "SigCgt:";
      const auto at = status.find(key);
      if (at == std::string::npos || status.find("State:\tZ") != std::string::npos) return;
      const auto caught = std::stoull(status.substr(at + key.size()), nullptr, 16);
      if (status.starts_with(name) && (caught >> (SIGTERM - 1) & 1) != 0) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  static int exit_code(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int run(const std::vector<std::string>& arguments) const { return exit_code(start(arguments)); }
  std::string out() const { return content(path_ / "out"); }
  std::string err() const { return content(path_ / "err"); }

 private:
  fs::path path_;
};

const std::string kOnTriangulation = with(kHeap, "linked cells", "triangulation");

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

template <int Dim>
void check_start(const Scene<Dim>& scene) {
  const auto run = make_run(scene);
  for (int k = 0; k < cases(20, 2000); ++k) run->step();
  CHECK(run->audit().missed() == 0);
  CHECK(to_toml(parse_scene<Dim>(to_toml(run->scene()), "again.toml")) == to_toml(run->scene()));
}

}  // namespace

TEST_SUITE("program") {
  TEST_CASE("a run writes its folder and says where") {
    const Place place;
    place.write("heap.toml", kOnTriangulation);

    CHECK(place.run({"run", "heap.toml"}) == 0);

    CHECK(place.out() == "wrote runs/heap\n");
    CHECK(place.err().empty());
    for (const char* file : {"scene.toml", "series.csv", "frames.csv", "summary.txt",
                             "frames/0000.csv", "frames/0001.csv"}) {
      CAPTURE(file);
      CHECK(fs::exists(place / "runs/heap" / file));
    }
    CHECK(holds(content(place / "runs/heap/summary.txt"), "regular triangulation"));
  }

  TEST_CASE("the resolved scene reproduces the run bit for bit, and so do other neighbourhoods") {
    const Place place;
    place.write("heap.toml", kOnTriangulation);
    place.write("cells.toml", kHeap);

    REQUIRE(place.run({"run", "heap.toml", "--out", "a"}) == 0);
    REQUIRE(place.run({"run", "a/scene.toml", "--out", "b"}) == 0);
    REQUIRE(place.run({"run", "cells.toml", "--out", "c"}) == 0);

    CHECK(content(place / "a/scene.toml") == content(place / "b/scene.toml"));
    CHECK(content(place / "a/series.csv") == content(place / "b/series.csv"));
    CHECK(content(place / "a/frames/0001.csv") == content(place / "b/frames/0001.csv"));
    CHECK(content(place / "a/frames/0001.csv") == content(place / "c/frames/0001.csv"));
  }

  TEST_CASE("threads share the work, not the result; their number is a number") {
    const Place place;
    place.write("heap.toml", kOnTriangulation);

    REQUIRE(place.run({"run", "heap.toml", "--out", "one", "--threads", "1"}) == 0);
    REQUIRE(place.run({"run", "heap.toml", "--out", "three", "--threads", "3"}) == 0);

    CHECK(content(place / "one/series.csv") == content(place / "three/series.csv"));
    CHECK(content(place / "one/frames/0001.csv") == content(place / "three/frames/0001.csv"));
    for (const char* wrong : {"0", "-1", "many"}) {
      CAPTURE(wrong);
      CHECK(place.run({"run", "heap.toml", "--out", "none", "--threads", wrong}) == 2);
      const std::string err = place.err();
      CHECK(std::count(err.begin(), err.end(), '\n') == 1);
      CHECK(holds(err, "--threads"));
      CHECK(!fs::exists(place / "none"));
    }
  }

  TEST_CASE("bad input is one sentence, exit code 2, and nothing written") {
    const Place place;
    const auto refused = [&](const std::string& name, const std::string& text) {
      place.write(name, text);
      CHECK(place.run({"run", name, "--out", "result"}) == 2);
      CHECK(place.out().empty());
      CHECK(!fs::exists(place / "result"));
      std::string err = place.err();
      CHECK(std::count(err.begin(), err.end(), '\n') == 1);
      return err;
    };

    CHECK(refused("s.toml", "dimension = 2 2").substr(0, 18) == "lagrain: s.toml:1:");
    CHECK(refused("s.toml", with(kHeap, "friction = 0.4", "frction = 0.4")) ==
          "lagrain: s.toml:10: law.friction: missing; expected a number that is not negative (is "
          "\"frction\" on line 13 meant?)\n");
    CHECK(refused("s.toml", with(kHeap, "1/25 contact", "fast")) ==
          "lagrain: s.toml:5: time_step: expected a fraction of contact time (\"1/25 contact\") or "
          "a time, got \"fast\"\n");
    CHECK(refused("s.toml", with(kHeap, "[0.05, 0.4]", "[0.05, 0.33]")) ==
          "lagrain: s.toml:28: grain[1]: overlaps grain[0] by 50 % of the smaller radius (limit 1 "
          "%); largest_initial_overlap allows more\n");
    CHECK(holds(refused("s.toml", with(kHeap, "1/25 contact", "1/2 contact")), "allows at most"));
    CHECK(holds(
        refused("s.toml", with(kHeap, "count = 12", "count = 1000\narrangement = \"random\"")),
        "\"fill 1\": a solid fraction of 1"));
  }

  TEST_CASE("spheres run like discs: folder, resolved scene, explanation") {
    const Place place;
    place.write("heap.toml", in_space<3>(kHeap));
    place.write("pairs.toml", in_space<3>(with(kHeap, "linked cells", "all pairs")));
    place.write("t.toml", in_space<3>(kOnTriangulation));

    REQUIRE(place.run({"run", "heap.toml", "--out", "a"}) == 0);
    REQUIRE(place.run({"run", "a/scene.toml", "--out", "b"}) == 0);
    REQUIRE(place.run({"run", "pairs.toml", "--out", "c"}) == 0);
    REQUIRE(place.run({"run", "t.toml", "--out", "d"}) == 0);
    REQUIRE(place.run({"run", "--explain", "heap.toml"}) == 0);

    CHECK(content(place / "a/series.csv") == content(place / "b/series.csv"));
    CHECK(content(place / "a/frames/0001.csv") == content(place / "b/frames/0001.csv"));
    CHECK(content(place / "a/frames/0001.csv") == content(place / "c/frames/0001.csv"));
    CHECK(holds(place.out(), "dimension       3\n"));
    CHECK(holds(place.out(), "bytes per grain 192, 64 of them for spin\n"));
  }

  TEST_CASE("a missing scene, an unwritable folder and a wrong flag are exit code 2") {
    const Place place;
    place.write("heap.toml", kOnTriangulation);
    place.write("file", "x");

    CHECK(place.run({"run", "nowhere.toml"}) == 2);
    CHECK(place.err() == "lagrain: nowhere.toml: does not exist\n");
    CHECK(place.run({"run", "heap.toml", "--out", "file/run"}) == 2);
    CHECK(place.err().substr(0, 35) == "lagrain: file/run: cannot be writte");
    CHECK(place.run({"run", "heap.toml", "--fast"}) == 2);
    CHECK(holds(place.err(), "--fast"));
    CHECK(place.run({}) == 2);
    CHECK(place.run({"figure", "99"}) == 2);
    CHECK(place.err().substr(0, 27) == "lagrain: figure 99: there i");
    CHECK(place.run({"figure", "one"}) == 2);
    CHECK(place.run({"report", "--slow"}) == 2);
    CHECK(holds(place.err(), "--slow"));
    CHECK(place.run({"report", "--quick", "--out", "file/report"}) == 2);
  }

  TEST_CASE("a simulation that goes wrong is exit code 1, with grain, time and remedy") {
    const Place place;
    place.write("heap.toml",
                with(with(kOnTriangulation, "velocity = [0, \"-2 m/s\"]", "velocity = [0, -400]"),
                     "seed = 5", "largest_overlap = 0.2"));

    CHECK(place.run({"run", "heap.toml", "--out", "result"}) == 1);

    const std::string err = place.err();
    CHECK(std::count(err.begin(), err.end(), '\n') == 1);
    CHECK(holds(err, "lagrain: t = "));
    CHECK(holds(err, "grain 0 overlaps grain 1"));
    CHECK(holds(err, "gentler start"));
    CHECK(fs::exists(place / "result/last.csv"));
    CHECK(fs::exists(place / "result/series.csv"));
    CHECK(fs::exists(place / "result/frames/0000.csv"));
  }

  TEST_CASE("Ctrl-C ends the run after a step, keeps what was computed, and exits 130") {
    const Place place;
    place.write("heap.toml", with(kOnTriangulation, "\"20 ms\"", "\"1 h\""));

    const pid_t child = place.start({"run", "heap.toml", "--out", "result"});
    // The first frame is written when the first step is due; the signal handler is older.
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (!fs::exists(place / "result/frames/0000.csv") &&
           std::chrono::steady_clock::now() < give_up) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(child, SIGINT);

    CHECK(Place::exit_code(child) == 130);
    CHECK(place.err().substr(0, 24) == "lagrain: stopped at t = ");
    CHECK(holds(place.err(), "what was computed is in result (to go on: lagrain resume result)\n"));
    CHECK(fs::exists(place / "result/frames/0001.csv"));
    CHECK(fs::exists(place / "result/series.csv"));
    CHECK(holds(content(place / "result/summary.txt"), "stopped by the user"));
    for (const auto& entry : fs::recursive_directory_iterator(place / "result")) {
      CHECK(entry.path().extension() != ".part");
    }
  }

  TEST_CASE("what a run has written is there and whole when the program is killed") {
    const Place place;
    place.write("heap.toml", with(kOnTriangulation, "\"20 ms\"", "\"1 h\"") +
                                 "[output]\nseries_every = \"1 ms\"\nframes_every = \"5 ms\"\n");
    const auto lines = [&](const char* file) {
      const std::string text = content(place / "result" / file);
      return std::count(text.begin(), text.end(), '\n');
    };

    const pid_t child = place.start({"run", "heap.toml", "--out", "result"});
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (lines("frames.csv") < 4 && std::chrono::steady_clock::now() < give_up) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);

    REQUIRE(lines("frames.csv") >= 4);
    CHECK(lines("series.csv") >= 1 + 10);
    const std::string series = content(place / "result/series.csv");
    CHECK(series.back() == '\n');
    for (int frame = 0; frame < lines("frames.csv") - 1; ++frame) {
      const std::string name = std::to_string(frame);
      const std::string text =
          content(place / ("result/frames/" + std::string(4 - name.size(), '0') + name + ".csv"));
      CHECK(std::count(text.begin(), text.end(), '\n') == 1 + 14);
    }
  }

  TEST_CASE("a run that is killed is resumed to the bits of one that was left alone") {
    const Place place;
    place.write("heap.toml", with(kOnTriangulation, "\"20 ms\"", "\"60 ms\"") +
                                 "[output]\nframes_every = \"5 ms\"\n");
    REQUIRE(place.run({"run", "heap.toml", "--out", "whole"}) == 0);
    for (int milliseconds = 30; milliseconds < 400; milliseconds += 70) {
      const pid_t child =
          fs::exists(place / "parted/checkpoint.h5")
              ? place.start({"resume", "parted", "--checkpoint-every", "0 s"})
              : place.start({"run", "heap.toml", "--out", "parted", "--checkpoint-every", "0 s"});
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
    REQUIRE(place.run({"resume", "parted", "--threads", "2"}) == 0);
    int frames = 0;
    for (const auto& entry : fs::directory_iterator(place / "whole/frames")) {
      ++frames;
      CHECK(content(entry.path()) ==
            content(place / ("parted/frames/" + entry.path().filename().string())));
    }
    CHECK(frames == 13);
    CHECK(content(place / "whole/frames.csv") == content(place / "parted/frames.csv"));

    CHECK(place.run({"resume", "parted"}) == 0);
    CHECK(place.out().starts_with("parted is at its end, t = 0.06"));
    CHECK(place.run({"resume", "parted", "--until", "70 ms"}) == 0);
    CHECK(place.run({"resume", "parted", "--until", "70 kg"}) == 2);
    CHECK(holds(place.err(),
                "--until: expected a time such as \"90 s\" or \"2 min\", got \"70 kg\""));
    CHECK(place.run({"run", "heap.toml", "--out", "unborn", "--checkpoint-every", "1"}) == 2);
    CHECK_FALSE(fs::exists(place / "unborn"));
    CHECK(place.run({"resume", "nowhere"}) == 2);
    CHECK(holds(place.err(),
                "nowhere: there is no such folder, and so no checkpoint (checkpoint.h5)"));
  }

  TEST_CASE("a command or a flag that there is not is named, with the nearest one") {
    const Place place;
    place.write("base.toml", kHeap);

    CHECK(place.run({"run", "--thread", "2", "base.toml"}) == 2);
    CHECK(place.err() ==
          "lagrain: unknown flag --thread (did you mean \"--threads\"?) (see lagrain --help)\n");
    CHECK(place.run({"run", "base.toml", "--exlain"}) == 2);
    CHECK(holds(place.err(), "unknown flag --exlain (did you mean \"--explain\"?)"));
    CHECK(place.run({"--verison"}) == 2);
    CHECK(holds(place.err(), "did you mean \"--version\"?"));
    CHECK(place.run({"sweeep", "x"}) == 2);
    CHECK(
        holds(place.err(), "unknown command \"sweeep\" (did you mean \"sweep\"?); there are run"));
    CHECK(place.run({"\x1b[31mrun", "x"}) == 2);
    CHECK(holds(place.err(), "unknown command \"\\u001B[31mrun\""));
    CHECK(!fs::exists(place / "runs"));
  }

  TEST_CASE("--set puts values in the place of the scene's, and the folder's scene holds them") {
    const Place place;
    place.write("heap.toml", kHeap);

    REQUIRE(place.run({"run", "heap.toml", "--out", "a", "--set", "law.friction=0.3", "--set",
                       "fill[0].count=5", "--set", "duration=10 ms"}) == 0);
    REQUIRE(place.run({"run", "a/scene.toml", "--out", "b"}) == 0);

    CHECK(holds(content(place / "a/scene.toml"), "friction = 0.3\n"));
    CHECK(content(place / "a/scene.toml") == content(place / "b/scene.toml"));
    CHECK(content(place / "a/series.csv") == content(place / "b/series.csv"));
    CHECK(place.run({"run", "heap.toml", "--out", "c", "--set", "law.frction=0.3"}) == 2);
    CHECK(
        place.err() ==
        "lagrain: --set law.frction=0.3: law.frction: unknown key (did you mean \"friction\"?)\n");
    CHECK(place.run({"run", "heap.toml", "--explain", "--set", "fill.count=7"}) == 0);
    CHECK(holds(place.out(), "grains          9\n"));
    CHECK(place.run({"run", "heap.toml", "--set"}) == 2);
    CHECK(!fs::exists(place / "c"));
  }

  TEST_CASE("placing grains hears Ctrl-C and SIGTERM: exit 130, one sentence, nothing written") {
    const Place place;
    place.write("crowd.toml",
                with(with(kHeap, "count = 12", "count = 1000000\narrangement = \"random\""),
                     "{ uniform = [\"8 mm\", \"10 mm\"] }", "\"0.06 mm\""));
    for (const int signal : {SIGINT, SIGTERM}) {
      const pid_t child = place.start({"run", "crowd.toml", "--out", "result"});
      Place::until_it_hears(child);
      kill(child, signal);

      CHECK(Place::exit_code(child) == 130);
      CHECK(place.err() == "lagrain: stopped while grains were placed; nothing was written\n");
      CHECK(!fs::exists(place / "result"));
    }
  }

  TEST_CASE("a summary says how many grains fall for ever") {
    const Place place;
    const std::string plate =
        with(kHeap, "point = [0, 0]\nnormal = [0, 1]", "from = [0, 0]\nto = [0.2, 0]");
    place.write("falling.toml", plate +
                                    "[[grain]]\nposition = [0.5, -2]\nradius = 0.01\n"
                                    "material = \"rock\"\n");
    place.write("domain.toml",
                content(place / "falling.toml") + "[domain]\nlow = [-5, -5]\nhigh = [5, 5]\n");
    place.write("heap.toml", kHeap);

    for (const char* name : {"falling", "domain", "heap"}) {
      REQUIRE(place.run({"run", std::string(name) + ".toml"}) == 0);
      CHECK(holds(content(place / "runs" / name / "summary.txt"), "1 grains are below all walls") ==
            (name == std::string("falling")));
    }
  }

  TEST_CASE("a sweep runs all combinations, and the same command again leaves them as they are") {
    const Place place;
    place.write("heap.toml", kHeap);
    const std::vector<std::string> command{"sweep",  "heap.toml",
                                           "--vary", "law.friction=0.1,0.3",
                                           "--vary", "duration=5 ms, \"10 ms\"",
                                           "--set",  "fill.count=6",
                                           "--out",  "s",
                                           "--plot", "contacts"};
    REQUIRE(place.run(command) == 0);

    CHECK(place.out() == "wrote s/results.csv\n");
    const std::string table = content(place / "s/results.csv");
    CHECK(std::count(table.begin(), table.end(), '\n') == 5);
    CHECK(table.starts_with("run[-],law.friction,duration[s],ending[-],time[s],kinetic[J],"));
    CHECK(holds(table, "\nlaw.friction=0.1_duration=5ms,0.1,0.005,finished,"));
    CHECK(holds(table, "\nlaw.friction=0.3_duration=10ms,0.3,0.01,finished,"));
    REQUIRE(place.run({"run", "heap.toml", "--out", "alone", "--set", "law.friction=0.3", "--set",
                       "duration=10 ms", "--set", "fill.count=6"}) == 0);
    const fs::path one = place / "s/law.friction=0.3_duration=10ms";
    CHECK(content(place / "alone/series.csv") == content(one / "series.csv"));
    CHECK(content(place / "alone/scene.toml") == content(one / "scene.toml"));

    const auto before = fs::last_write_time(one / "summary.txt");
    REQUIRE(place.run(command) == 0);
    CHECK(fs::last_write_time(one / "summary.txt") == before);
    CHECK(content(place / "s/results.csv") == table);
  }

  TEST_CASE("a run of a sweep that breaks off is named, and stops no other") {
    const Place place;
    place.write("heap.toml", with(kHeap, "velocity = [0, \"-2 m/s\"]", "velocity = [0, -2]"));

    CHECK(place.run({"sweep", "heap.toml", "--vary", "grain[1].velocity=[0, -2],[0, -400]",
                     "--jobs", "1"}) == 1);
    CHECK(holds(place.err(), "1 of 2 runs are finished, 1 broke off: runs/heap_sweep/results.csv"));
    const std::string table = content(place / "runs/heap_sweep/results.csv");
    CHECK(holds(table, "grain-1-.velocity") == false);
    CHECK(holds(table, "finished"));
    CHECK(holds(table, "broke off: t = "));
  }

  TEST_CASE("a sweep that is stopped keeps what is done and goes on with the same command") {
    const Place place;
    place.write("heap.toml", with(kHeap, "\"20 ms\"", "\"60 ms\""));
    const std::vector<std::string> command{"sweep",  "heap.toml", "--vary", "seed=1,2,3",
                                           "--jobs", "2",         "--out",  "s"};
    REQUIRE(place.run({"sweep", "heap.toml", "--vary", "seed=1,2,3", "--out", "whole"}) == 0);
    int stopped = 0;
    for (const int signal : {SIGTERM, SIGINT, SIGKILL}) {
      const pid_t child = place.start(command);
      Place::until_it_hears(child);
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
      kill(child, signal);
      const int code = Place::exit_code(child);
      CHECK((code == 130 || code == 0 || signal == SIGKILL));
      if (code == 130) {
        ++stopped;
        CHECK(holds(place.err(),
                    "of 3 runs are finished, see s/results.csv (to go on: the same "
                    "command again)"));
      }
    }
    MESSAGE("stopped " << stopped << " times");
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // until those of the killed end
    REQUIRE(place.run(command) == 0);
    for (const char* run : {"seed=1", "seed=2", "seed=3"}) {
      CHECK(content(place / "s" / run / "frames/0001.csv") ==
            content(place / "whole" / run / "frames/0001.csv"));
    }
  }

  TEST_CASE("a wrong sweep is one sentence, exit code 2, and nothing written") {
    const Place place;
    place.write("heap.toml", kHeap);
    const auto refused = [&](const std::vector<std::string>& rest) {
      std::vector<std::string> words{"sweep", "heap.toml", "--out", "s"};
      words.insert(words.end(), rest.begin(), rest.end());
      CHECK(place.run(words) == 2);
      CHECK(!fs::exists(place / "s"));
      std::string err = place.err();
      CHECK(std::count(err.begin(), err.end(), '\n') == 1);
      return err;
    };
    CHECK(holds(refused({}), "--vary"));
    CHECK(holds(refused({"--vary", "seed"}), "expected a key, \"=\" and values"));
    CHECK(holds(refused({"--vary", "seed=1,,2"}), "expected a key, \"=\" and values"));
    CHECK(holds(refused({"--vary", "sed=1,2"}), "sed: unknown key (did you mean \"seed\"?)"));
    CHECK(holds(refused({"--vary", "seed=1,x"}), "--set seed=x: seed: expected a whole number"));
    CHECK(holds(refused({"--vary", "seed=1", "--jobs", "0"}), "--jobs"));

    CHECK(place.run({"sweep", "heap.toml", "--out", "s", "--vary", "seed=1", "--plot", "knetic"}) ==
          2);
    CHECK(holds(place.err(),
                "--plot: no series has a column \"knetic\" (did you mean "
                "\"kinetic\"?)"));
    CHECK(fs::exists(place / "s/results.csv"));
  }

  TEST_CASE("--explain says what the scene is made of, and runs and writes nothing") {
    const Place place;
    place.write("heap.toml", kOnTriangulation);
    place.write("smooth.toml",
                without(with(kOnTriangulation, "\"elastic\"", "\"none\""), "friction = 0.4"));

    CHECK(place.run({"run", "--explain", "heap.toml"}) == 0);
    const std::string rough = place.out();
    CHECK(place.run({"run", "--explain", "smooth.toml"}) == 0);
    const std::string smooth = place.out();

    for (const char* part :
         {"dimension       2", "linear spring and dashpot", "velocity Verlet", "grains          14",
          "contact time", "time step", "safe step", "steps"}) {
      CAPTURE(part);
      CHECK(holds(rough, part));
    }
    CHECK(holds(rough, "bytes per grain 120, 16 of them for spin\n"));
    CHECK(holds(rough, "bytes per pair  24, 16 of them for memory\n"));
    CHECK(holds(smooth, "bytes per grain 104\n"));
    CHECK(holds(smooth, "bytes per pair  8\n"));
    CHECK(holds(smooth, "> none           104         0           8           0\n"));
    CHECK(!fs::exists(place / "runs"));
  }

  TEST_CASE("the version is printed") {
    const Place place;

    CHECK(place.run({"--version"}) == 0);
    CHECK(place.out() == std::string("lagrain ") + version() + "\n");
  }

  TEST_CASE("every scene of the repository is valid, its step is safe, and it starts to run") {
    for (const auto& entry : fs::recursive_directory_iterator(LAGRAIN_SCENES)) {
      // Grains of a scene may stand in a file beside it.
      if (entry.is_directory() || entry.path().extension() == ".csv") continue;
      CAPTURE(entry.path().string());
      REQUIRE(entry.path().extension() == ".toml");
      if (scene_dimension(entry.path()) == 2) {
        check_start(read_scene<2>(entry.path()));
      } else {
        check_start(read_scene<3>(entry.path()));
      }
    }
  }

  TEST_CASE("a run is watched, drawn, filmed and plotted; what cannot be is said") {
    const Place place;
    place.write("heap.toml", kOnTriangulation);
    const std::string folder = "a b";
    if (place.run({"run", "heap.toml", "--out", folder, "--watch"}) == 2 &&
        holds(place.err(), "without its renderer")) {
      MESSAGE("SKIPPED: the renderer was not built");
      return;
    }

    const std::string page = content(place / folder / "watch.html");
    CHECK(holds(page, "<p>finished</p>"));
    CHECK_FALSE(holds(page, "refresh"));
    CHECK(fs::exists(place / folder / "watch.png"));
    CHECK(fs::exists(place / folder / "watch_series.png"));

    CHECK(place.run({"draw", folder, "--show", "grains,forces,walls"}) == 0);
    CHECK(holds(place.out(), "wrote a b/picture.png (the checkpoint, t = 0.02"));
    CHECK(place.run({"draw", folder, "--at", "0", "--colour", "group", "--out", "first.svg"}) == 0);
    CHECK(place.out() == "wrote first.svg (frame 0, t = 0 s)\n");
    CHECK(place.run({"plot", folder, "kinetic", "contacts", "--out", "p.pdf"}) == 0);
    CHECK(content(place / "p.pdf").starts_with("%PDF"));
    CHECK(place.run({"movie", folder}) == 0);

    const auto refused = [&](const std::vector<std::string>& words, const std::string& why) {
      CAPTURE(why);
      CHECK(place.run(words) == 2);
      const std::string err = place.err();
      CHECK(std::count(err.begin(), err.end(), '\n') == 1);
      CHECK(holds(err, why));
    };
    refused({"draw", "nowhere"}, "no folder; expected that of a run");
    refused({"draw", folder, "--out", "a.gif"}, "ends in none of .png, .pdf, .svg");
    refused({"draw", folder, "--colour", "blue"}, "there is no \"blue\"");
    refused({"draw", folder, "--show", "grain"}, "there is no \"grain\"");
    refused({"draw", folder, "--size", "3x4"}, "expected width and height in pixels");
    refused({"draw", folder, "--at", "2 m"}, "expected a time");
    refused({"draw", folder, "--view", "top"}, "for spheres");
    refused({"draw", folder, "--at", "0", "--show", "forces"}, "contacts = true");
    refused({"plot", folder, "kinetik"}, "did you mean \"kinetic\"?");
    refused({"movie", folder, "--fps", "0"}, "--fps");
    CHECK_FALSE(fs::exists(place / "a.gif"));
  }
}
