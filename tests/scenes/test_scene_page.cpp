// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The page that explains scene files (common/scenes/README.md) and the reader of scene files say
/// the same. The test asks the reader: it puts every key into every table, with a value that no key
/// accepts, and reads in the message whether the key is known there, and what it should have been.

#include <lagrain/contact_laws.hpp>
#include <lagrain/scene.hpp>

#include "support/files.hpp"
#include "support/scene_text.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

const std::filesystem::path kFolder = LAGRAIN_SCENES_SOURCE;

/// A row of one of the page's tables of keys.
struct Row {
  std::string key, meaning, unit, range, fallback, example;
};

struct Page {
  std::map<std::string, std::vector<Row>> tables;  ///< by path: "", "law", "fill.region", ...
  std::vector<std::string> scenes;                 ///< examples that are whole scenes
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// What stands between backticks.
std::vector<std::string> in_backticks(const std::string& cell) {
  static const std::regex quoted("`([^`]*)`");
  std::vector<std::string> values;
  for (std::sregex_iterator at(cell.begin(), cell.end(), quoted), end; at != end; ++at) {
    values.push_back((*at)[1]);
  }
  return values;
}

/// The path of a table, from its header or the heading of its section.
std::string path_of(std::string header) {
  std::erase_if(header, [](char c) { return c == '[' || c == ']' || c == '`' || c == '#'; });
  header.erase(0, header.find_first_not_of(' '));
  if (header == "At the top") return "";
  return header == "materials.stone" ? "materials.NAME" : header;
}

Page read_page() {
  Page page;
  std::string path = "none";
  bool in_scene = false;
  for (const std::string& line : lines_of(content(kFolder / "README.md"))) {
    if (line.starts_with("```")) {
      in_scene = line == "```toml";
      if (in_scene) page.scenes.emplace_back();
    } else if (in_scene) {
      page.scenes.back() += line + "\n";
    } else if (line.starts_with("### ")) {
      path = path_of(line);
    } else if (line.starts_with("## ")) {
      path = "none";
    } else if (line.starts_with("| `") && path != "none") {
      std::vector<std::string> cells;
      for (std::size_t at = 2; at < line.size();) {
        const std::size_t end = std::min(line.find(" | ", at), line.size() - 2);
        cells.push_back(line.substr(at, end - at));
        at = end + 3;
      }
      REQUIRE_MESSAGE(cells.size() == 6, line);
      page.tables[path].push_back(
          {in_backticks(cells[0]).at(0), cells[1], cells[2], cells[3], cells[4], cells[5]});
    }
  }
  return page;
}

/// Every key that the reader may ask for.
std::set<std::string> all_keys() {
  std::set<std::string> keys;
  const std::string source = content(kFolder / "scene_keys.hpp");
  const std::regex spelled("Key k\\w+\\{\"([a-z_]+)\"");
  for (std::sregex_iterator at(source.begin(), source.end(), spelled), end; at != end; ++at) {
    keys.insert((*at)[1]);
  }
  for (const LawDescription& law : kNormalLaws) {
    for (const LawKey& key : law.keys) keys.emplace(key.name);
  }
  for (const LawDescription& law : kFrictionLaws) {
    for (const LawKey& key : law.keys) keys.emplace(key.name);
  }
  return keys;
}

/// The page's example of a mesh as a file that is there: one facet.
std::string with_mesh(std::string text) {
  static const Folder folder;
  const std::string name = "rotor.stl", file = folder.path / name;
  if (!std::filesystem::exists(file)) {
    std::filesystem::create_directory(folder.path);
    std::ofstream(file) << "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                           "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
  }
  const auto at = text.find('"' + name);
  return at == std::string::npos ? text : text.replace(at + 1, name.size(), file);
}

/// Scenes in which every table occurs, and every shape and law that changes which keys are known.
std::vector<std::string> make_scenes() {
  const std::string plain = R"(dimension = 2
duration = 1
gravity = [0, -9.81]
normal = "linear"
friction = "elastic"
[law]
stiffness = 1e6
restitution = 0.5
friction = 0.4
[materials.stone]
density = 2500
[[pair]]
between = ["stone", "stone"]
[[fill]]
radius = 0.01
[fill.region]
low = [0, 0]
high = [1, 1]
[[grain]]
position = [3, 3]
radius = 0.01
[start]
run = "runs/bed"
[[grains]]
file = "bed.csv"
[[inlet]]
rate = 1
[inlet.region]
low = [0, 0]
high = [1, 1]
[inlet.radius]
uniform = [0.01, 0.01]
[[outlet]]
low = [2, 2]
high = [3, 3]
[domain]
low = [-9, -9]
high = [9, 9]
[[wall]]
point = [0, 0]
normal = [0, 1]
[[box]]
low = [0, 0]
high = [1, 1]
[[measure]]
[measure.region]
low = [0, 0]
high = [1, 1]
[output]
)";
  const std::string plane = "point = [0, 0]\nnormal = [0, 1]\n";
  const std::string fill = "radius = 0.01\n[fill.region]\n";
  const auto moving = [&](const std::string& motion) {
    return with(plain, plane, plane + "[wall.motion]\n" + motion);
  };
  const auto changing = [](const std::string& scene, const std::string& steady,
                           const std::string& gravity) {
    return with(with(scene, "gravity = " + steady + "\n", ""), "[law]",
                "[gravity]\n" + gravity + "[law]");
  };
  const auto in_space_with = [&](const std::string& shape) {
    return with(in_space<3>(plain), "point = [0, 0, 0]\nnormal = [0, 0, 1]\n", shape);
  };
  const std::string round = with(plain, plane, "point = [0, 0]\nradius = 1\n");
  return {
      plain,
      with(plain, "[law]", "audit = true\n[law]"),
      with(plain, "[law]", "[drag]\nrate = 1\n[law]"),
      in_space<3>(with(plain, "[law]", "[drag]\nrate = 1\n[law]")),
      in_space<3>(with(plain, "[law]", "[drag]\nviscosity = 1\n[law]")),
      changing(plain, "[0, -9.81]", "value = [0, -9.81]\nrate = 1\n"),
      changing(in_space<3>(plain), "[0, 0, -9.81]",
               "value = [0, 0, -9.81]\naxis = [0, 0, 1]\nrate = 1\n"),
      changing(plain, "[0, -9.81]", "times = [0, 1, 1]\nvalues = [[0, -9], [0, -9], [9, 0]]\n"),
      with(plain, "\"elastic\"", "\"viscous\""),
      without(with(plain, "\"elastic\"", "\"none\""), "friction = 0.4"),
      with(with(plain, "\"linear\"", "\"hertz\""), "stiffness = 1e6",
           "modulus = 1e8\nimpact_speed = 1"),
      in_space<3>(plain),
      with(with(in_space<3>(plain), "\"elastic\"", "\"rolling\""), "friction = 0.4",
           "friction = 0.4\nrolling_friction = 0.1"),
      with(plain, fill, "count = 1\narrangement = \"random\"\n" + fill),
      with(plain, fill, "[fill.radius]\nuniform = [0.01, 0.02]\n[fill.region]\n"),
      with(plain, fill, "[fill.radius]\nvalues = [0.01, 0.02]\n[fill.region]\n"),
      with(plain, fill, "[fill.radius]\nsieves = [0.01, 0.02]\npassing = [0, 1]\n[fill.region]\n"),
      with(plain, fill, "radius = 0.01\n[fill.velocity]\nrandom = 1\n[fill.region]\n"),
      with(plain, plane, "from = [0, 0]\nto = [0, 1]\n"),
      with(plain, plane, "from = [0, 0]\nalong = [0, 1]\n"),
      in_space_with("corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n"),
      round,
      with(in_space<3>(round), "radius = 1\n", "radius = 1\naxis = [0, 0, 1]\n"),
      with(plain, plane, "points = [[0, 0], [0, 1], [1, 1]]\n"),
      with(plain, plane, "lines = [[[0, 0], [0, 1]], [[1, 1], [1, 0]]]\n"),
      with(plain, plane, "from = [0, 0]\nthrough = [0.5, 0.2]\nto = [1, 0]\n"),
      in_space_with("plates = [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]\n"),
      in_space_with("mesh = \"rotor.stl\"\n"),
      in_space_with("point = [0, 0, 0]\naxis = [0, 0, 1]\nheight = 1\nradius = 1\n"),
      in_space_with("point = [0, 0, 0]\naxis = [0, 0, 1]\nradii = [0, 1]\n"),
      with(plain, plane,
           "from = [0, 0]\nto = [0, 1]\n[wall.turning]\ntype = \"steady\"\nrate = 1\n"),
      with(plain, plane,
           "from = [0, 0]\nto = [0, 1]\n[wall.turning]\ntype = \"swing\"\nangle = 1\n"
           "frequency = 1\n"),
      in_space_with("point = [0, 0, 0]\nnormal = [0, 0, 1]\n[wall.turning]\ntype = \"steady\"\n"
                    "axis = [0, 0, 1]\nrate = 1\n"),
      with(plain, "[output]",
           "[[box.openings]]\nside = \"bottom\"\nlow = [0.3]\nhigh = [0.6]\n[output]"),
      moving("type = \"path\"\ntimes = [0, 1, 3]\nshifts = [[0, 0], [0, 1], [1, 1]]\n"),
      moving("type = \"steady\"\nvelocity = [0, 1]\n"),
      moving("type = \"shake\"\namplitude = [0, 1]\nfrequency = 1\n"),
      moving("type = \"piston\"\nmass = 1\nload = [0, 1]\n"),
      moving("type = \"piston\"\nmass = 1\npressure = 1\nbetween = [\"left\", \"right\"]\n"),
      with(plain, "[[measure]]\n", "[[measure]]\npoint = [0, 0]\nnormal = [0, 1]\n"),
  };
}

const std::vector<std::string>& scenes_to_try() {
  static const std::vector<std::string> scenes = make_scenes();
  return scenes;
}

/// A scene with `key = value` in one of its tables, in place of what the key was there.
/// @returns nothing if the scene has no such table, or, if `only_new`, if the key is there
std::optional<std::string> with_key(const std::string& scene, const std::string& path,
                                    const std::string& key, const std::string& value,
                                    bool only_new = false) {
  const std::string inner = path.empty() ? key : path + "." + key;
  std::string text = path.empty() ? key + " = " + value + "\n" : "";
  bool found = path.empty();
  std::string here;
  for (const std::string& line : lines_of(scene)) {
    if (line.starts_with("[")) here = path_of(line);
    const bool replaced = (here == path && line.starts_with(key + " = ")) || here == inner ||
                          here.starts_with(inner + ".");
    if (replaced && only_new) return {};
    if (!replaced) text += line + "\n";
    if (line.starts_with("[") && here == path) {
      found = true;
      text += key + " = " + value + "\n";
    }
  }
  if (!found) return {};
  return text;
}

/// The scene with every default filled in.
/// @throws SceneError
std::string resolved(const std::string& scene) {
  const std::string text = with_mesh(scene);
  if (text.find("dimension = 3") != std::string::npos) {
    return to_toml(parse_scene<3>(text, "page"));
  }
  return to_toml(parse_scene<2>(text, "page"));
}

/// What the reader says of a key that holds a date, in each scene where it knows the key.
std::vector<std::string> objections(const std::string& path, const std::string& key) {
  std::vector<std::string> list;
  for (const std::string& scene : scenes_to_try()) {
    const auto text = with_key(scene, path, key, "1979-05-27");
    if (!text) continue;
    try {
      resolved(*text);
      FAIL("a date is accepted: ", key);
    } catch (const SceneError& error) {
      const std::string message = error.what();
      INFO(*text);
      CHECK(message.find("not valid TOML") == std::string::npos);
      if (message.find("unknown key") == std::string::npos) list.push_back(message);
    }
  }
  return list;
}

bool has_row(const std::vector<Row>& rows, const std::string& key) {
  return std::any_of(rows.begin(), rows.end(), [&](const Row& row) { return row.key == key; });
}

/// How the page writes the range that a message asks for; empty if it asks for none.
std::string range_in(const std::string& message) {
  if (message.find("a positive ") != std::string::npos) return "> 0";
  if (message.find("that is not negative") != std::string::npos) return "≥ 0";
  if (message.find("above 0 and at most 1") != std::string::npos) return "> 0, ≤ 1";
  return "";
}

}  // namespace

TEST_SUITE("scene page") {
  TEST_CASE("a key stands in a table of the page if, and only if, the reader knows it there") {
    const Page page = read_page();
    const std::set<std::string> keys = all_keys();
    REQUIRE(keys.size() > 50);
    REQUIRE(page.tables.size() == 24);
    std::set<std::string> explained;
    for (const auto& table : page.tables) {
      const std::string& path = table.first;
      const std::vector<Row>& rows = table.second;
      for (const Row& row : rows) {
        INFO("[", path, "] ", row.key);
        CHECK(keys.contains(row.key));
        CHECK(std::count_if(rows.begin(), rows.end(),
                            [&](const Row& other) { return other.key == row.key; }) == 1);
        explained.insert(row.key);
      }
      for (const std::string& key : keys) {
        INFO("[", path, "] ", key);
        const bool known = !objections(path, key).empty();
        // A pair may have the keys of the law, which the page explains once.
        const bool on_page =
            has_row(rows, key) || (path == "pair" && has_row(page.tables.at("law"), key));
        CHECK(on_page == known);
      }
    }
    CHECK(explained == keys);
  }

  TEST_CASE("units, ranges and words are those that the reader asks for") {
    const Page page = read_page();
    const std::regex unit("\\[([^\\]]+)\\], got a date");
    const std::regex word("\"([^\"]+)\"");
    for (const auto& table : page.tables) {
      const std::string& path = table.first;
      const std::vector<Row>& rows = table.second;
      for (const Row& row : rows) {
        INFO("[", path, "] ", row.key);
        std::set<std::string> ranges;
        for (const std::string& message : objections(path, row.key)) {
          std::smatch match;
          if (std::regex_search(message, match, unit)) CHECK(row.unit == match[1].str());
          if (const std::string range = range_in(message); !range.empty()) ranges.insert(range);
          const auto words = message.find(": expected \"");
          if (words == std::string::npos) continue;
          for (std::sregex_iterator
                   at(message.begin() + static_cast<std::ptrdiff_t>(words), message.end(), word),
               end;
               at != end; ++at) {
            CHECK(row.meaning.find((*at)[0]) != std::string::npos);
          }
        }
        if (ranges.empty()) continue;
        CHECK(std::any_of(ranges.begin(), ranges.end(),
                          [&](const std::string& range) { return row.range.starts_with(range); }));
      }
    }
  }

  TEST_CASE("what the page calls a default changes nothing, and its examples are accepted") {
    const Page page = read_page();
    const auto is_default = [](const std::string& path, const Row& row, const std::string& value) {
      for (const std::string& scene : scenes_to_try()) {
        const auto text = with_key(scene, path, row.key, value, true);
        try {
          if (text && resolved(*text) == resolved(scene)) return true;
        } catch (const SceneError&) {
          // The key is not for this scene.
        }
      }
      return false;
    };
    const auto reason_against = [](const std::string& path, const Row& row,
                                   const std::string& value) {
      std::string reason = "no table [" + path + "]";
      for (const std::string& scene : scenes_to_try()) {
        const auto text = with_key(scene, path, row.key, value);
        if (!text) continue;
        try {
          resolved(*text);
          return std::string();
        } catch (const SceneError& error) {
          reason = error.what();
        }
      }
      return reason;
    };
    for (const auto& table : page.tables) {
      const std::string& path = table.first;
      const std::vector<Row>& rows = table.second;
      for (const Row& row : rows) {
        for (const std::string& value : in_backticks(row.fallback)) {
          INFO("[", path, "] ", row.key, " = ", value);
          CHECK(is_default(path, row, value));
        }
        if (row.example.starts_with("see ")) continue;
        REQUIRE_MESSAGE(in_backticks(row.example).size() == 1, row.key);
        INFO("[", path, "] ", row.key, " = ", in_backticks(row.example)[0]);
        CHECK(reason_against(path, row, in_backticks(row.example)[0]) == "");
      }
    }
  }

  TEST_CASE("the scenes of the page are read") {
    const Page page = read_page();
    CHECK(page.scenes.size() == 2);
    for (const std::string& scene : page.scenes) {
      INFO(scene);
      const bool in_plane = scene.find("dimension = 2") != std::string::npos;
      if (in_plane) {
        CHECK_NOTHROW(parse_scene<2>(scene, "page"));
      } else {
        CHECK_NOTHROW(parse_scene<3>(scene, "page"));
      }
    }
  }
}
