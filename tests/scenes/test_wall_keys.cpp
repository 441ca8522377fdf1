// SPDX-License-Identifier: GPL-3.0-or-later
// Walls of pieces, walls that turn or run, and boxes with openings, as scenes write them.
#include <lagrain/run.hpp>
#include <lagrain/scene.hpp>

#include "support/files.hpp"
#include "support/scene_text.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

std::string plane() {
  std::string text = with(kSphere, "dimension = 3", "dimension = 2");
  return with(with(text, "[0, 0, -9.81]", "[0, -9.81]"), "[0, 0, 1]", "[0, 1]");
}

template <int Dim>
Wall<Dim> wall_of(const std::string& keys) {
  const std::string text = (Dim == 2 ? plane() : kSphere) + "[[wall]]\n" + keys;
  const Scene<Dim> once = parse_scene<Dim>(text, "s.toml");
  const std::string resolved = to_toml(once);
  const Scene<Dim> twice = parse_scene<Dim>(resolved, "s.toml");
  CHECK(to_toml(twice) == resolved);
  Wall<Dim> a = once.walls.at(0), b = twice.walls.at(0);
  CHECK(a.home == b.home);
  CHECK(a.corners() == b.corners());
  CHECK(a.belt == b.belt);
  CHECK(a.until == b.until);
  // The same bits after it has moved.
  a.advance(0.7, 0.1);
  b.advance(0.7, 0.1);
  CHECK(a.point == b.point);
  CHECK(a.spin == b.spin);
  const Vec<Dim> x = Vec<Dim>::Constant(0.37);
  CHECK(a.foot(x).distance == b.foot(x).distance);
  return once.walls.at(0);
}

template <int Dim>
std::string error_of(const std::string& tables) {
  return scene_error_of(
      [&] { parse_scene<Dim>((Dim == 2 ? plane() : kSphere) + tables, "s.toml"); });
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void write_binary_stl(const std::filesystem::path& file,
                      const std::vector<std::vector<Vec<3>>>& facets) {
  std::ofstream out(file, std::ios::binary);
  out << std::string(80, ' ');
  const auto count = static_cast<std::uint32_t>(facets.size());
  out.write(reinterpret_cast<const char*>(&count), sizeof count);
  for (const auto& corners : facets) {
    const float zeros[3] = {0, 0, 0};
    out.write(reinterpret_cast<const char*>(zeros), sizeof zeros);
    for (const Vec<3>& corner : corners) {
      const Eigen::Vector3f c = corner.cast<float>();
      out.write(reinterpret_cast<const char*>(c.data()), 3 * sizeof(float));
    }
    out.write("\0\0", 2);
  }
}

}  // namespace

TEST_SUITE("walls in scenes") {
  TEST_CASE("polylines, arcs and several lines make walls of pieces") {
    const auto line = wall_of<2>("points = [[0, 1], [0.4, 0.1], [\"60 cm\", 0.1]]\n");
    REQUIRE(line.pieces());
    CHECK(line.piece_count() == 2);
    CHECK(relative_error(line.foot({0.55, 0.2}).distance, 0.1) < 1e-14);
    CHECK(wall_of<2>("points = [[0, 0], [1, 0], [0, 1]]\nclosed = true\n").piece_count() == 3);
    CHECK(wall_of<2>("lines = [[[0, 0], [0.1, 0.7]], [[1, 0], [2, 0], [3, 1]]]\n").piece_count() ==
          3);
    const auto arc =
        wall_of<2>("point = [0.1, 0]\nfrom = [0, 0]\nthrough = [1, 1]\nto = [2, 0]\nuntil = 3\n");
    CHECK(relative_error(arc.foot({1.1, 3}).distance, 2) < 1e-14);
    CHECK(arc.until == 3);
  }

  TEST_CASE("plates, cones, rings and discs make walls in space") {
    CHECK(wall_of<3>("plates = [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0.3], "
                     "[0, 1, 0]]]\n")
              .piece_count() == 2);
    const auto cone =
        wall_of<3>("point = [0, 0, 1]\naxis = [0, 0, 3]\nheight = 2\nradii = [0.1, 2.1]\n");
    CHECK(relative_error(cone.foot({0, 0, 2}).distance, 1.1 / std::numbers::sqrt2) < 1e-14);
    const auto tube = wall_of<3>("point = [0, 0, 0]\naxis = [1, 2, 3]\nheight = 2\nradius = 0.3\n");
    CHECK(relative_error(tube.foot(Vec<3>(1, 2, 3) * 0.1).distance, 0.3) < 1e-14);
    const auto disc = wall_of<3>("point = [0, 0, 0]\naxis = [0, 0, 1]\nradii = [0, 2]\n");
    CHECK(disc.foot({1, 1, 0.5}).distance == 0.5);
    const auto ring = wall_of<3>("point = [0, 0, 0]\naxis = [0, 0, 1]\nradii = [1, 2]\n");
    CHECK(ring.foot({0, 0, 0}).distance == 1);
  }

  TEST_CASE("motions of walls are read back to the bit") {
    const std::string pieces = "points = [[0.1, 0.7], [0.3, 0.2], [1, 0.9]]\n";
    const auto wall = wall_of<2>(
        pieces +
        "motion = { type = \"path\", times = [0, 0.3, 1], shifts = [[0, 0], [0.1, 0], [0, 0.7]] }\n"
        "turning = { type = \"steady\", rate = \"30 rpm\", about = [0.1, 0.2], stop = 5 }\n"
        "belt = [0.1, 0]\n");
    CHECK(relative_error(std::get<Turn<2>>(wall.turning).rate, std::numbers::pi) < 1e-15);
    const auto swing = wall_of<2>(
        pieces +
        "turning = { type = \"swing\", angle = \"30 deg\", frequency = 0.7, start = 0.1 }\n");
    CHECK(relative_error(std::get<Swing<2>>(swing.turning).amplitude, std::numbers::pi / 6) <
          1e-15);
    CHECK(std::get<Swing<2>>(swing.turning).about.isZero(0));
    const auto drum = wall_of<3>(
        "point = [1, 2, 3]\naxis = [0.3, 0.1, 0.7]\nradius = 2\n"
        "turning = { type = \"steady\", axis = [0.3, 0.1, 0.7], rate = -2 }\n");
    CHECK(std::get<Turn<3>>(drum.turning).about == Vec<3>(1, 2, 3));
  }

  TEST_CASE("a mesh comes from an STL file, in the unit that the scene says") {
    const Folder folder;
    std::filesystem::create_directory(folder.path);
    const std::vector<std::vector<Vec<3>>> facets{
        {{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}},
        {{1000, 0, 0}, {1000, 1000, 0}, {0, 1000, 0}},
        {{0, 0, 0}, {500, 0, 0}, {1000, 0, 0}}};  // without an area
    write_binary_stl(folder.path / "plate.stl", facets);
    std::ofstream(folder.path / "s.toml")
        << kSphere << "[[wall]]\nmesh = \"plate.stl\"\nscale = 0.001\npoint = [0, 0, 1]\n";
    const Scene<3> scene = read_scene<3>(folder.path / "s.toml");
    CHECK(scene.walls.at(0).piece_count() == 2);
    CHECK(scene.walls[0].foot({0.5, 0.5, 3}).distance == 2);
    // The resolved scene needs the file no more.
    const Scene<3> again = parse_scene<3>(to_toml(scene), "again.toml");
    CHECK(again.walls[0].corners() == scene.walls[0].corners());

    // Some programs write text in capitals.
    std::ofstream(folder.path / "capitals.stl")
        << "SOLID S\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 1E0\nVERTEX 1 0 1\nVERTEX 0 1 1\n"
           "ENDLOOP\nENDFACET\nENDSOLID S\n";
    std::ofstream(folder.path / "c.toml") << kSphere << "[[wall]]\nmesh = \"capitals.stl\"\n";
    const Scene<3> capitals = read_scene<3>(folder.path / "c.toml");
    CHECK(capitals.walls.at(0).piece_count() == 1);
    CHECK(capitals.walls[0].foot({0.25, 0.25, 3}).distance == 2);

    const auto error = [&](const std::string& name) {
      std::ofstream(folder.path / "t.toml") << kSphere << "[[wall]]\nmesh = \"" << name << "\"\n";
      return scene_error_of([&] { read_scene<3>(folder.path / "t.toml"); });
    };
    CHECK(has(error("none.stl"), "none.stl: does not exist"));
    CHECK(has(error(std::string(5000, 'a')),
              "a...: cannot be read: File name too long"));  // no file's name is so long
    std::ofstream(folder.path / "text.stl") << "no mesh at all\n";
    CHECK(has(error("text.stl"), "text.stl: it "));
    write_binary_stl(folder.path / "empty.stl", {});
    CHECK(has(error("empty.stl"), "empty.stl: it holds no facet"));
    std::ofstream(folder.path / "short.stl", std::ios::binary)
        << std::string(80, ' ') << std::string("\xff\xff\xff\x7f", 4) << "too short";
    CHECK(has(error("short.stl"), "short.stl: it "));
  }

  TEST_CASE("an opening leaves the rest of a side of a box, thin") {
    const Scene<3> scene =
        parse_scene<3>(kSphere +
                           "[[box]]\nlow = [0, 0, 0]\nhigh = [4, 3, 10]\nopen = [\"top\"]\n"
                           "openings = [{ side = \"bottom\", low = [1, 1], high = [2, 3] }]\n",
                       "s.toml");
    REQUIRE(scene.walls.size() == 5);
    const Wall<3>& bottom = scene.walls.back();
    CHECK(bottom.name == "bottom");
    CHECK(bottom.piece_count() == 3);  // the opening reaches the back
    double covered = 0;
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 30; ++j) {
        const Vec<3> x(0.1 * i + 0.05, 0.1 * j + 0.05, 0);
        const bool open = x[0] > 1 && x[0] < 2 && x[1] > 1;
        CHECK((bottom.foot(x).distance > 0) == open);
        covered += open ? 0 : 0.01;
      }
    }
    CHECK(relative_error(covered, 4 * 3 - 2) < 1e-12);
    const Scene<2> flat =
        parse_scene<2>(plane() +
                           "[[box]]\nlow = [0, 0]\nhigh = [4, 10]\n"
                           "openings = [{ side = \"right\", low = [1], high = [2] }]\n",
                       "s.toml");
    CHECK(flat.walls[1].piece_count() == 2);
    CHECK(flat.walls[1].foot({4, 1.5}).distance == 0.5);
    CHECK(flat.walls[1].foot({3.5, 0.5}).distance == 0.5);
  }

  TEST_CASE("an opening that ends at the rim but for rounding leaves no strip there") {
    const auto pieces = [](const std::string& low, const std::string& high) {
      return parse_scene<3>(kSphere + "[[box]]\nlow = [0, 0, 0]\nhigh = [0.3, 1, 10]\n" +
                                "openings = [{ side = \"bottom\", low = " + low +
                                ", high = " + high + " }]\n",
                            "s.toml")
          .walls[4]
          .piece_count();
    };
    CHECK(pieces("[0, 0.2]", "[0.1, 0.5]") == 3);
    CHECK(pieces("[5e-17, 0.2]", "[0.1, 0.5]") == 3);
    CHECK(pieces("[0, 0.2]", "[0.29999999999999993, 1]") == 1);
    CHECK(pieces("[1e-9, 1e-9]", "[0.1, 0.999999999]") == 1);
    const Scene<2> flat =
        parse_scene<2>(plane() +
                           "[[box]]\nlow = [0, 0]\nhigh = [4, 10]\n"
                           "openings = [{ side = \"bottom\", low = [1e-15], high = [2] }]\n",
                       "s.toml");
    CHECK(flat.walls[2].piece_count() == 1);
  }

  TEST_CASE("what makes no wall is refused in one sentence") {
    const auto in_plane = [](const std::string& keys) { return error_of<2>("[[wall]]\n" + keys); };
    const auto in_space = [](const std::string& keys) { return error_of<3>("[[wall]]\n" + keys); };
    CHECK(in_plane("points = [[0, 0]]\n") ==
          "s.toml:15: wall[0].points: a line needs at least two points");
    CHECK(in_plane("points = [[0, 0], [0, 0]]\n") ==
          "s.toml:15: wall[0].points: point 1 and the next are one");
    CHECK(in_plane("lines = [[0, 0], [1, 1]]\n") ==
          "s.toml:15: wall[0].lines: expected [x, y], each a length [m], got 0");
    CHECK(in_plane("from = [0, 0]\nthrough = [1, 1]\nto = [2, 2]\n") ==
          "s.toml:16: wall[0].through: the points of an arc lie on a line");
    CHECK(has(in_plane("points = [[0, 0], [1, 1]]\nradius = 1\n"), "wall[0].point: missing"));
    CHECK(has(in_plane("plates = [[[0, 0], [1, 1]]]\n"), "a plate is for dimension = 3"));
    CHECK(has(in_plane("mesh = \"m.stl\"\n"), "a mesh is for dimension = 3"));
    CHECK(has(in_plane("point = [0, 0]\nradii = [1, 2]\n"), "round wall in space"));
    CHECK(has(
        in_plane("point = [0, 0]\nnormal = [0, 1]\nturning = { type = \"steady\", rate = 1 }\n"),
        "a line without an end does not turn; give from and to, or points"));
    for (const std::string fast :
         {"type = \"swing\", angle = 1e308, frequency = 1", "type = \"steady\", rate = -1e200",
          "type = \"swing\", angle = 1e60, frequency = 1e60"}) {
      CHECK(has(in_plane("from = [0, 0]\nto = [0, 1]\nturning = { " + fast + " }\n"),
                "wall[0].turning: it turns faster than numbers tell; slow it down"));
    }
    CHECK(has(in_space("point = [0, 0, 0]\nnormal = [0, 0, 1]\n"
                       "turning = { type = \"steady\", rate = 1, axis = [0, 1, 0] }\n"),
              "what has no end turns about its normal alone; give plates"));
    CHECK(has(in_plane("from = [0, 0]\nto = [0, 1]\n"
                       "turning = { type = \"steady\", rate = 1, axis = [0, 0, 1] }\n"),
              "in the plane all turns about the same"));
    CHECK(has(in_space("points = [[0, 0, 0], [1, 1, 1]]\n"), "lines are for dimension = 2"));
    CHECK(has(in_space("plates = [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [1, 0, 0]]]\n"),
              "plate 2: a plate needs at least 3 corners"));
    CHECK(has(in_space("point = [0, 0, 0]\naxis = [0, 0, 0]\nradii = [0, 1]\n"), "a direction"));
    CHECK(has(in_space("point = [0, 0, 0]\naxis = [0, 0, 1]\nradii = [1, 1]\n"),
              "a ring needs two radii that differ"));
    CHECK(has(in_space("point = [0, 0, 0]\naxis = [0, 0, 1]\nradii = [1]\n"),
              "[radius at point, radius at the end]"));
    CHECK(has(in_space("corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n"
                       "turning = { type = \"swing\", axis = [0, 0, 0], angle = 1, "
                       "frequency = 1 }\n"),
              "turning.axis: expected a direction"));
    CHECK(has(in_plane("from = [0, 0]\nto = [1, 0]\n"
                       "motion = { type = \"path\", times = [0, 1], shifts = [[0, 0]] }\n"),
              "a path needs as many places as times"));
    CHECK(has(in_plane("from = [0, 0]\nto = [1, 0]\n"
                       "motion = { type = \"piston\", mass = 1, load = [0, 1] }\n"
                       "turning = { type = \"steady\", rate = 1 }\n"),
              "a piston does not turn"));
    CHECK(has(in_plane("from = [0, 0]\nto = [1, 0]\nuntil = 0\n"), "wall[0].until"));
    // What doubles cannot tell from nothing, or square.
    CHECK(has(in_plane("from = [0, 0]\nalong = [1e-200, 0]\n"), "expected another point"));
    CHECK(has(in_plane("points = [[0, 0], [1e-200, 0]]\n"), "point 1 and the next are one"));
    for (const std::string tiny_or_huge : {"[0, 1e-200, 0]", "[1e200, 0, 0]"}) {
      CHECK(has(in_space("point = [0, 0, 0]\nnormal = " + tiny_or_huge + "\n"),
                "wall[0].normal: expected a direction"));
      CHECK(has(in_space("point = [0, 0, 0]\nradius = 1\naxis = " + tiny_or_huge + "\n"),
                "wall[0].axis: expected a direction"));
      CHECK(has(in_space("point = [0, 0, 0]\nradii = [0, 1]\naxis = " + tiny_or_huge + "\n"),
                "wall[0].axis: expected a direction"));
      CHECK(has(in_space("point = [0, 0, 0]\nnormal = [0, 0, 1]\nmotion = { type = \"piston\", "
                         "mass = 1, load = " +
                         tiny_or_huge + " }\n"),
                "motion.load: expected a force"));
    }

    const std::string box = "[[box]]\nlow = [0, 0]\nhigh = [4, 10]\n";
    const auto opening = [&](const std::string& keys) {
      return error_of<2>(box + "openings = [{ " + keys + " }]\n");
    };
    CHECK(has(opening("side = \"botom\", low = [1], high = [2]"), "did you mean \"bottom\"?"));
    CHECK(has(opening("side = \"bottom\", low = [2], high = [1]"), "expected low below high"));
    CHECK(has(opening("side = \"bottom\", low = [2], high = [5]"), "both on the side"));
    CHECK(has(error_of<2>(box + "open = [\"bottom\"]\n"
                                "openings = [{ side = \"bottom\", low = [1], high = [2] }]\n"),
              "is left out as a whole"));
    CHECK(has(opening("side = \"bottom\", low = [0], high = [4]"),
              "box[0].openings: nothing is left of side \"bottom\"; leave it out: open = "
              "[\"bottom\"]"));
  }

  TEST_CASE("the series tells the work and the torque of a wall that turns") {
    const std::string scene = plane() +
                              "[[wall]]\nname = \"drum\"\npoint = [0, 1.5]\nradius = 1\n"
                              "turning = { type = \"steady\", rate = 2 }\n";
    const std::string rough = with(scene, "friction = \"none\"", "friction = \"elastic\"");
    const auto run = make_run(parse_scene<2>(
        with(rough, "stiffness = 1e5", "stiffness = 1e7\nfriction = 0.5"), "s.toml"));
    run->advance_to(0.9);
    const Wall<2>& drum = run->walls()[0];
    CHECK(drum.work > 0);
    CHECK(relative_error(drum.angle, 1.8) < 1e-3);
    CHECK(relative_error(run->ledger().wall_work, drum.work) < 1e-9);
    CHECK(std::abs(run->energy_residual()) < 1e-2 * drum.work);
  }
}
