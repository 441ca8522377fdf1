// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Grains from files of comma-separated values.

#include <lagrain/files.hpp>
#include <lagrain/output.hpp>
#include <lagrain/placement.hpp>
#include <lagrain/random.hpp>

#include "support/cases.hpp"
#include "support/files.hpp"
#include "support/scene_text.hpp"
#include "support/space.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <string_view>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

/// A scene whose grains stand in bed.csv, beside it.
const std::string kScene = R"(dimension = 2
duration = "2 ms"
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
[law]
stiffness = 1e6
restitution = 0.5
friction = 0.4
[materials.rock]
density = 2500
[materials."glass, green"]
density = 2400
[materials.steel]
[[wall]]
name = "floor"
material = "steel"
point = [0, 0]
normal = [0, 1]
[[grains]]
file = "bed.csv"
)";
const std::string kMaterial = "material = \"rock\"\n";

/// A folder with a scene and its file of grains.
struct Bed {
  Folder folder;
  fs::path scene = folder.path / "s.toml";
  fs::path file = folder.path / "bed.csv";

  Bed(const std::string& scene_text, std::string_view rows) {
    make_folder(folder.path);
    write_file(scene, scene_text);
    write_file(file, rows);
  }
  template <int Dim>
  Placement<Dim> place() const {
    return place_grains(read_scene<Dim>(scene));
  }
  /// What the refusal says, with the folder's path left out; "accepted" if there is none.
  template <int Dim = 2>
  std::string refusal() const {
    std::string message = scene_error_of([&] { place<Dim>(); });
    const std::string path = folder.path.string() + "/";
    for (std::size_t at; (at = message.find(path)) != std::string::npos;) {
      message.erase(at, path.size());
    }
    return message;
  }
};

std::string refusal_of(std::string_view rows, const std::string& keys = kMaterial) {
  return Bed(kScene + keys, rows).refusal();
}

/// Whether a refusal begins so and names a remedy that holds the words.
void check_refusal(const std::string& refusal, const std::string& begin,
                   const std::string& words = "") {
  CAPTURE(refusal);
  CHECK(refusal.starts_with(begin));
  CHECK(refusal.find(words) != std::string::npos);
}

}  // namespace

TEST_SUITE("grain files") {
  TEST_CASE("columns stand in any order, with or without units; what is not known is passed over") {
    const Bed bed(
        kScene,
        "\xEF\xBB\xBFradius[m],\"y[m]\" , x,f[N],material[-],vy[m/s],vx[m/s],omega[rad/s]\r\n"
        "0.25,+1.5, -2 ,9,rock,-0.125,1e-3,3\r\n\r\n"
        "0.125,2,3,nan,\"glass, green\",0,0,-0\n");

    const auto placed = bed.place<2>();

    REQUIRE(placed.grains.size() == 2);
    const Grain<2>& first = placed.grains[0];
    CHECK(first.position == Vec<2>(-2, 1.5));
    CHECK(first.velocity == Vec<2>(1e-3, -0.125));
    CHECK(first.omega[0] == 3);
    CHECK(first.radius == 0.25);
    CHECK(first.material == 0);
    CHECK(!first.pinned);
    CHECK(placed.grains[1].material == 1);
    CHECK(placed.grains[1].position == Vec<2>(3, 2));
    CHECK(placed.group[1] == -1);
  }

  TEST_CASE("a file may be shifted, stopped, pinned, and made of one material") {
    const std::string rows = "x,y,radius,vx,vy,omega,material\n0,2,0.5,1,2,3,wood\n";
    const auto grain_with = [&](const std::string& keys) {
      return Bed(kScene + kMaterial + keys, rows).place<2>().grains.at(0);
    };
    CHECK(grain_with("shift = [1, \"50 cm\"]\n").position == Vec<2>(1, 2.5));
    CHECK(grain_with("").velocity == Vec<2>(1, 2));
    CHECK(grain_with("").omega[0] == 3);
    CHECK(grain_with("at_rest = true\n").velocity.isZero(0));
    CHECK(grain_with("at_rest = true\n").omega.isZero(0));
    CHECK(grain_with("pinned = true\n").velocity.isZero(0));
    CHECK(grain_with("pinned = true\n").pinned);
  }

  TEST_CASE("grains placed by hand come first, fills keep clear of a file's grains") {
    const Bed bed(kScene + kMaterial +
                      "[[grain]]\nmaterial = \"rock\"\nposition = [9, 9]\nradius = 1\n"
                      "[[fill]]\nmaterial = \"rock\"\nradius = 0.1\n"
                      "region = { low = [0, 0], high = [2, 2] }\n",
                  "x,y,radius\n1,1,0.8\n");
    const auto placed = bed.place<2>();
    REQUIRE(placed.grains.size() > 10);
    CHECK(placed.grains[0].radius == 1);
    CHECK(placed.grains[1].radius == 0.8);
    for (std::size_t i = 2; i < placed.grains.size(); ++i) {
      CHECK((placed.grains[i].position - Vec<2>(1, 1)).norm() >= 0.8 + 0.1);
    }
  }

  TEST_CASE_TEMPLATE("the frames of a run are files of grains", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Folder out;
    const std::string text = in_space<Dim>(kHeap);
    const auto run = make_run(parse_scene<Dim>(text, "s.toml"));
    REQUIRE(record(*run, {out.path, {}, {}}));

    Scene<Dim> next = parse_scene<Dim>(text, "s.toml");
    next.fills.clear();
    next.grains.clear();
    next.largest_initial_overlap = 0.3;
    next.grain_files.push_back({out.path / "frames/0001.csv", {}, Vec<Dim>::Zero(), false, false});
    const auto placed = place_grains(next);

    REQUIRE(static_cast<int>(placed.grains.size()) == run->count());
    bool same = true;
    for (int i = 0; i < run->count(); ++i) {
      const Grain<Dim>& grain = placed.grains[static_cast<std::size_t>(i)];
      same = same && grain.position == run->positions().col(i) &&
             grain.velocity == run->velocities().col(i) && grain.omega == run->spins()->col(i) &&
             grain.radius == run->radii()[i] && grain.mass == run->masses()[i] &&
             grain.material == run->materials()[static_cast<std::size_t>(i)];
    }
    CHECK(same);
  }

  TEST_CASE(
      "a run's folder gives the same run again, whatever becomes of the files it was read of") {
    const Folder first;
    const Folder second;
    {
      const Bed bed(kScene + kMaterial + "shift = [0.3, 0]\n",
                    "x,y,radius,vx\n0.1,0.05,0.05,0\n0.21,0.05,0.05,-1\n");
      CHECK(bed.refusal() != "accepted");
      write_file(bed.file, "x,y,radius,vx,vy\n0.1,0.05,0.05,0,0\n0.21,0.05,0.05,-1,0\n");
      REQUIRE(record(*make_run(read_scene<2>(bed.scene)), {first.path, {}, {}}));
    }
    const std::string scene = content(first.path / "scene.toml");
    CHECK(scene.find("file = \"grains_1.csv\"") != std::string::npos);
    REQUIRE(record(*make_run(read_scene<2>(first.path / "scene.toml")), {second.path, {}, {}}));
    const std::string series = content(first.path / "series.csv");
    CHECK(series.size() > 1000);
    CHECK(content(second.path / "series.csv") == series);
    CHECK(content(second.path / "scene.toml") == scene);

    // Once more into its own folder, and then from one of the frames that the new run removes.
    REQUIRE(record(*make_run(read_scene<2>(first.path / "scene.toml")), {first.path, {}, {}}));
    CHECK(content(first.path / "series.csv") == series);
    const std::string frame = content(first.path / "frames/0001.csv");
    write_file(first.path / "s.toml",
               with(kScene, "bed.csv", "frames/0001.csv") + "[output]\nframes_every = 1\n");
    REQUIRE(record(*make_run(read_scene<2>(first.path / "s.toml")), {first.path, {}, {}}));
    CHECK(content(first.path / "grains_1.csv") == frame);
    CHECK(content(first.path / "frames/0000.csv") == frame);
  }

  TEST_CASE("what is wrong with a file is said with line, column, value and remedy") {
    check_refusal(refusal_of(""), "bed.csv: empty; expected a first line", "x[m], y[m] and radius");
    check_refusal(refusal_of("\n\r\n"), "bed.csv: empty; ");
    check_refusal(refusal_of("x,y,radius\n"), "bed.csv:1: no grain below the names");
    check_refusal(refusal_of("x[m],y[m],raduis[m]\n1,1,1\n"),
                  "bed.csv:1: no column \"radius[m]\" (did you mean \"raduis\"?); expected a first "
                  "line",
                  "separated by commas");
    check_refusal(refusal_of("x;y;radius\n1;1;1\n"), "bed.csv:1: no column \"x[m]\"", "by commas");
    check_refusal(refusal_of("x,y,radius,vx\n1,1,1,1\n"), "bed.csv:1: no column \"vy[m/s]\"");
    CHECK(refusal_of("x[mm],y,radius\n1,1,1\n") == "bed.csv:1: column \"x[mm]\": expected x[m]");
    CHECK(refusal_of("x,y,radius,x\n1,1,1,1\n") == "bed.csv:1: a second column \"x\"");
    CHECK(refusal_of("x,y,z,radius\n1,1,1,1\n") ==
          "bed.csv:1: column \"z\": discs have none; remove it, or write dimension = 3");
    CHECK(refusal_of("x,y,radius\n1,1,1\n\n1,5,0.1O\n") ==
          "bed.csv:4: radius: expected a positive length [m], got \"0.1O\"");
    CHECK(refusal_of("x,y,radius\nnan,1,1\n") ==
          "bed.csv:2: x: expected a length [m], got \"nan\"");
    CHECK(refusal_of("x,y,radius\n1e999,1,1\n") ==
          "bed.csv:2: x: expected a length [m], got \"1e999\"");
    CHECK(refusal_of("x,y,radius\n1,,1\n") == "bed.csv:2: y: expected a length [m], got nothing");
    CHECK(refusal_of("x,y,radius\n1,1,0\n") ==
          "bed.csv:2: radius: expected a positive length [m], got \"0\"");
    CHECK(refusal_of("x,y,radius\n1,1,-1\n") ==
          "bed.csv:2: radius: expected a positive length [m], got \"-1\"");
    CHECK(refusal_of("x,y,radius\n1,1\n") ==
          "bed.csv:2: 2 values, expected 3, as many as columns are named");
    CHECK(refusal_of("x,y,radius\n1,1,1,1\n") ==
          "bed.csv:2: 4 values, expected 3, as many as columns are named");
    CHECK(refusal_of("x,y,radius,omega\n1,1,1,\"fast\n\"\n") ==
          "bed.csv:2: omega: expected an angular velocity [rad/s], got \"fast\\n\"");

    const std::string wood = "x,y,radius,material\n1,1,1,rock\n1,5,1,rook\n";
    CHECK(
        refusal_of(wood, "") ==
        "bed.csv:3: material: no material \"rook\" (did you mean \"rock\"?); expected one of the "
        "scene's [materials.NAME], or in grains[0] material = \"...\" for all grains of the file");
    CHECK(refusal_of(wood) == "accepted");
    CHECK(refusal_of("x,y,radius,material\n1,1,1,steel\n", "") ==
          "bed.csv:2: material: grains of \"steel\" need [materials.steel] density");
    CHECK(refusal_of("x,y,radius\n1,1,1\n", "") ==
          "s.toml: grains[0].material: missing; expected a name, because the scene has several "
          "materials and \"bed.csv\" has no column \"material\"");
  }

  TEST_CASE("a file that is not there, or none, is refused at the scene's line") {
    const auto refusal = [](const std::string& file) {
      return Bed(with(kScene, "bed.csv", file), "").refusal();
    };
    CHECK(
        refusal("bad.csv") ==
        "s.toml:21: grains[0].file: \"bad.csv\" does not exist; a path is taken from the folder of "
        "the scene file");
    CHECK(refusal("/dev/zero") ==
          "s.toml:21: grains[0].file: \"/dev/zero\" is no file; expected a "
          "file of grains (CSV)");
    CHECK(
        Bed(without(kScene, "file = \"bed.csv\""), "").refusal() ==
        "s.toml:20: grains[0].file: missing; expected a file of grains (CSV); a single grain is a "
        "table [[grain]]");
  }

  TEST_CASE("grains of a file that overlap are named by their lines") {
    CHECK(refusal_of("x,y,radius\n1,2,1\n\n3,2,1.5\n") ==
          "bed.csv:4: overlaps bed.csv:2 by 50 % of the smaller radius (limit 1 %); "
          "largest_initial_overlap allows more");
    CHECK(refusal_of("x,y,radius\n1,0.5,1\n") ==
          "bed.csv:2: overlaps wall \"floor\" by 50 % of the smaller radius (limit 1 %); "
          "largest_initial_overlap allows more");
    CHECK(refusal_of("x,y,radius\n1,-0.5,1\n") == "bed.csv:2: lies behind wall \"floor\"");
    const std::string by_hand =
        kMaterial + "[[grain]]\nmaterial = \"rock\"\nposition = [3, 1]\nradius = 1.5\n";
    CHECK(refusal_of("x,y,radius\n9,9,1\n1,1,1\n", by_hand + "pinned = true\n") ==
          "bed.csv:3: overlaps grain[0] by 50 % of the smaller radius (limit 1 %); "
          "largest_initial_overlap allows more");
    const std::string second = kMaterial + "[[grains]]\nfile = \"bed.csv\"\nmaterial = \"rock\"\n";
    CHECK(refusal_of("x,y,radius\n9,9,1\n1,1,1\n", second + "shift = [0, 1]\n") ==
          "bed.csv:2: overlaps bed.csv:2 by 100 % of the smaller radius (limit 1 %); "
          "largest_initial_overlap allows more");
  }

  TEST_CASE("places as far as numbers go are taken as they are") {
    CHECK(refusal_of("x,y,radius\n1e300,1,1\n-1e300,1,1\n1,1e308,1\n0,1,1e-9\n") == "accepted");
  }

  TEST_CASE("whatever bytes a file holds, it is read or refused") {
    Random random(20);
    const std::string_view likely = "0123456789.,,,\n\n\r\"+-e \tnaif[m]";
    const std::string sound = "x[m],y[m],radius[m],vx,vy,omega,material\n1,1,0.1,0,0,0,rock\n";
    for (int k = 0; k < cases(400, 20000); ++k) {
      std::string bytes;
      const int length = static_cast<int>(random.uniform(0, 120));
      for (int c = 0; c < length; ++c) {
        const double u = random.uniform();
        bytes += k % 2 == 0
                     ? static_cast<char>(static_cast<int>(256 * u))
                     : likely[static_cast<std::size_t>(u * static_cast<double>(likely.size()))];
      }
      // Alone, behind a sound beginning, or within it.
      if (k % 3 > 0) bytes = sound + bytes;
      if (k % 3 == 2) {
        bytes = sound;
        for (int c = 0; c < 3; ++c) {
          const double u = random.uniform();
          bytes[static_cast<std::size_t>(u * static_cast<double>(bytes.size()))] =
              likely[static_cast<std::size_t>(random.uniform() *
                                              static_cast<double>(likely.size()))];
        }
      }
      CAPTURE(bytes);
      const std::string refusal = refusal_of(bytes, "");
      CHECK((refusal == "accepted" || refusal.starts_with("bed.csv") ||
             refusal.starts_with("s.toml: grains[0]")));
    }
  }
}
