// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The lessons without a browser: what they are made of, and what the program makes of them.

#include "mathml.hpp"
#include "teach.hpp"
#include "teach_numbers.hpp"

#include <lagrain/check.hpp>
#include <lagrain/files.hpp>
#include <lagrain/numbers.hpp>

#include "support/files.hpp"
#include "support/tolerance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;
using namespace lagrain::figures;

namespace {

namespace fs = std::filesystem;

const fs::path kSources = LAGRAIN_TEACH;

/// What is wrong with the tags of a page; empty if each that opens is closed in its turn.
std::string trouble_with_tags(const std::string& page) {
  const std::vector<std::string> empty{"meta", "img", "link", "br", "!DOCTYPE"};
  std::vector<std::string> open;
  for (std::size_t at = 0; (at = page.find('<', at)) != std::string::npos;) {
    const bool closes = page[at + 1] == '/';
    const std::size_t begin = at + (closes ? 2 : 1);
    const std::string name = page.substr(begin, page.find_first_of(" >\n", begin) - begin);
    // A > within quotes does not end the tag.
    bool quoted = false;
    for (; at < page.size() && (quoted || page[at] != '>'); ++at) quoted ^= page[at] == '"';
    if (std::find(empty.begin(), empty.end(), name) != empty.end()) continue;
    if (!closes) {
      open.push_back(name);
      if (name == "script" || name == "style") at = page.find("</" + name, at);
      continue;
    }
    if (open.empty() || open.back() != name) {
      return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
    }
    open.pop_back();
  }
  return open.empty() ? std::string() : "<" + open.back() + "> is not closed";
}

/// A folder of lessons with one lesson, made of a good one by one change.
struct OneLesson {
  Folder folder;
  OneLesson(const std::string& part, const std::string& instead) {
    fs::create_directories(folder.path);
    fs::copy(kSources, folder.path / "teach", fs::copy_options::recursive);
    const fs::path lessons = folder.path / "teach/lessons";
    for (const auto& entry : fs::directory_iterator(lessons)) {
      if (entry.path().filename() != "01_power.html") fs::remove(entry.path());
    }
    std::string text = content(lessons / "01_power.html");
    const auto at = text.find(part);
    REQUIRE(at != std::string::npos);
    write_file(lessons / "01_power.html", text.replace(at, part.size(), instead));
  }
  std::string error() const {
    try {
      write_lessons({folder.path / "teach", {}, folder.path / "out"});
    } catch (const SceneError& error) {
      return error.what();
    }
    return {};
  }
};

}  // namespace

TEST_SUITE("lessons") {
  TEST_CASE("all lessons can be written, and nothing in them is left to be filled in") {
    const Folder folder;
    const TeachReport report = write_lessons({kSources, {}, folder.path});
    CHECK(report.lessons == 12);
    CHECK(!report.moves);
    int pages = 0;
    for (const auto& entry : fs::directory_iterator(folder.path)) {
      if (entry.path().extension() != ".html") continue;
      CAPTURE(entry.path().filename().string());
      const std::string page = content(entry.path());
      CHECK(trouble_with_tags(page) == "");
      CHECK(page.find("{{") == std::string::npos);
      CHECK(page.find('$') == std::string::npos);
      // Every picture says what it shows; those of the index stand beside their titles.
      if (entry.path().filename() != "index.html") {
        CHECK(page.find("alt=\"\"") == std::string::npos);
      }
      for (std::size_t at = 0; (at = page.find("<img src=\"pictures/", at)) != std::string::npos;) {
        at += 10;
        CHECK(fs::exists(folder.path / page.substr(at, page.find('"', at) - at)));
      }
      ++pages;
    }
    CHECK(pages == 14);
  }

  TEST_CASE("numbers in a text are those that are computed again") {
    const Folder folder;
    write_lessons({kSources, {}, folder.path});
    const std::regex wish(R"(\{\{value (\w+)\}\})");
    int found = 0;
    for (const auto& entry : fs::directory_iterator(kSources / "lessons")) {
      const std::string source = content(entry.path());
      const std::string page = content(folder.path / entry.path().filename());
      for (std::sregex_iterator it(source.begin(), source.end(), wish), end; it != end; ++it) {
        const std::string name = (*it)[1];
        CAPTURE(name);
        CHECK(page.find("data-answer=\"" + shortest(lesson_number(name)) + "\"") !=
              std::string::npos);
        ++found;
      }
    }
    CHECK(found == 12);
  }

  TEST_CASE("numbers of the lessons have their closed forms") {
    const std::vector<std::pair<const char*, double>> right{
        {"border", 13.0 / 8},
        {"lifted_radius", std::sqrt(1.25)},
        {"hidden_radius", 0.75},
        {"spacing", std::ldexp(1e15, -49)},
        {"edges_of_12", 3 * 12 - 3 - 5},
        {"tetrahedra_after", 16},
        {"right_angle_share", 2 - std::sqrt(2)},
        {"skin_at_once", std::sqrt(2) - 1},
        {"skin_any_time", 3 * std::sqrt(2) - 4},
        {"diagonal_sum", 12},
        {"restitution", 0.6},
        {"first_miss", 5},
        {"steps_needed", 50},
    };
    for (const auto& number : right) {
      CAPTURE(number.first);
      CHECK(relative_error(lesson_number(number.first), number.second) < 1e-11);
    }
    CHECK(lesson_number("wrong_signs") > 1000);
    CHECK(lesson_number("verlet_error") < 0.1);  // [%]
    CHECK_THROWS_WITH_AS(lesson_number("bordr"),
                         "there is no number \"bordr\" (did you mean \"border\"?)", SceneError);
  }

  TEST_CASE("flips: a quadrilateral takes one, a regular triangulation none") {
    const FlipStart square =
        disordered_triangulation({{0, 0, 0.1}, {2, 0.1, 0.3}, {2.2, 1.9, 0.1}, {-0.1, 2, 0.2}});
    CHECK(square.triangles.size() == 2);
    CHECK(least_flips(square) == 1);
    const FlipStart triangle = disordered_triangulation({{0, 0, 1}, {3, 0, 1}, {0, 3, 1}});
    CHECK(triangle.triangles.size() == 1);
    CHECK(least_flips(triangle) == 0);
  }

  TEST_CASE("a lesson that lacks something is refused in a sentence with its file") {
    const auto says = [](const std::string& part, const std::string& instead) {
      const OneLesson lesson(part, instead);
      const std::string error = lesson.error();
      CHECK(error.starts_with((lesson.folder.path / "teach/lessons/01_power.html").string() + ":"));
      CHECK(error.find('\n') == std::string::npos);
      return error.substr(error.rfind(".html:") + 6);
    };
    CHECK(says("class=\"goal\"", "") == "1: it has no goal (class \"goal\")");
    CHECK(says("{{number border}}", "{{number bordr}}")
              .find(": there is no number \"bordr\" (did you mean \"border\"?)") !=
          std::string::npos);
    CHECK(says("{{value border}}", "{{valve border}}").find("did you mean \"value\"?") !=
          std::string::npos);
    CHECK(says("[3.4, 0.3, 0.6]]", "[3.4, 0.3]]").find("x, y and radius") != std::string::npos);
    CHECK(says("$$P(x) = |x - c|^2 - r^2$$", "$$P(x) = |x - c|^2 - r^$$") ==
          "7: formula \"P(x) = |x - c|^2 - r^\": it ends too early");
    CHECK(says("bench discs", "bench dics").find("did you mean \"discs\"?") != std::string::npos);
    CHECK(says("{{number border}}", "{{lesson 44}}").find("there is no lesson \"44\"") !=
          std::string::npos);
  }

  TEST_CASE("a picture without words is refused") {
    const OneLesson lesson(
        "| Two discs. From a point between them a tangent touches the larger "
        "disc; a straight border separates the two cells.",
        "");
    CHECK(lesson.error().find("say what it shows, behind |") != std::string::npos);
  }

  TEST_CASE("formulas become MathML") {
    CHECK(mathml("x") == "<math><mrow><mi>x</mi></mrow></math>");
    CHECK(mathml("r^2") == "<math><mrow><msup><mi>r</mi><mn>2</mn></msup></mrow></math>");
    CHECK(mathml("a_{ij} < 1.5") ==
          "<math><mrow><msub><mi>a</mi><mrow><mi>i</mi><mi>j</mi></mrow></msub><mo>&lt;</mo>"
          "<mn>1.5</mn></mrow></math>");
    CHECK(mathml("\\frac{1}{\\sqrt{2}}") ==
          "<math><mrow><mfrac><mrow><mn>1</mn></mrow><mrow><msqrt><mrow><mn>2</mn></mrow></msqrt>"
          "</mrow></mfrac></mrow></math>");
    CHECK(with_formulas("a $x$ and $$y$$ b") ==
          "a <math><mrow><mi>x</mi></mrow></math> and "
          "<math display=\"block\"><mrow><mi>y</mi></mrow></math> b");
    for (const char* const bad : {"^2", "\\frac{1", "{x", "x}", "\\foo", "a ? b", "x^"}) {
      CAPTURE(bad);
      CHECK_THROWS_AS(mathml(bad), SceneError);
    }
    CHECK_THROWS_AS(with_formulas("costs 5 $"), SceneError);
  }
}
