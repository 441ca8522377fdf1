// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure.hpp"

#include <lagrain/check.hpp>
#include <lagrain/output.hpp>

#include <support/files.hpp>

#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

namespace fs = std::filesystem;

FigureResult first(const FigureOptions& options) {
  write_file(options.out / "one.png", "PNG");
  return {"Grains & <cells>",
          {{"density", "0.54", "0.53"}},
          {{"grains", "24"}},
          {options.out / "one.png", options.out / "one.pdf"},
          {"one.csv"}};
}
FigureResult second(const FigureOptions&) { return {"Two", {}, {}, {"two.png", "two.mp4"}, {}}; }
FigureResult costs(const FigureOptions&) {
  FigureResult result;
  result.tables = {{"Time & error", {"law", "ns"}, {{"linear", "7"}, {"Hertz", "9"}}}};
  return result;
}
FigureResult broken(const FigureOptions&) { throw SimulationError("t = 1 s: grain 3 is lost"); }

const std::vector<Figure> kFigures{{1, "First", first}, {2, "Second", second}};

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_SUITE("gallery") {
  TEST_CASE("the gallery shows pictures, links print versions, and sets the paper beside ours") {
    const Folder folder;
    std::vector<std::string> lines;

    draw_figures(kFigures, {}, {.out = folder.path, .scenes = {}},
                 [&](const std::string& line) { lines.push_back(line); });

    const std::string html = content(folder.path / "index.html");
    CHECK(lines.size() == 2);
    CHECK(lines[0].substr(0, 17) == "figure 1: First (");
    CHECK(holds(html, "<img src=\"one.png\""));
    CHECK(holds(html, "<a href=\"one.pdf\">one.pdf</a>"));
    CHECK(holds(html, "<a href=\"one.csv\">one.csv</a>"));
    CHECK(holds(html, "<video src=\"two.mp4\""));
    CHECK(holds(html, "<th>density</th><td>0.54</td><td>0.53</td>"));
    CHECK(holds(html, "<th>grains</th><td>24</td>"));
    CHECK(holds(html, "Grains &amp; &lt;cells&gt;"));
    CHECK(html.find("Figure 1.") < html.find("Figure 2."));
    CHECK(!holds(html, folder.path.string()));
  }

  TEST_CASE("a figure drawn earlier stays in the gallery when another is drawn alone") {
    const Folder folder;
    const FigureOptions options{.out = folder.path, .scenes = {}};

    draw_figures(kFigures, {2}, options, [](const std::string&) {});
    draw_figures(kFigures, {1}, options, [](const std::string&) {});

    const std::string html = content(folder.path / "index.html");
    CHECK(holds(html, "Figure 1."));
    CHECK(holds(html, "Figure 2."));
  }

  TEST_CASE("figures of the report stand on a page of their own, with their tables") {
    const Folder folder;
    const std::vector<Figure> figures{{1, "First", first}, {10, "Costs", costs, Page::report}};

    draw_figures(figures, {1}, {.out = folder.path, .scenes = {}}, [](const std::string&) {});
    CHECK(!fs::exists(folder.path / "report.html"));
    CHECK(!holds(content(folder.path / "index.html"), "report.html"));

    draw_figures(figures, {10}, {.out = folder.path, .scenes = {}}, [](const std::string&) {});
    const std::string index = content(folder.path / "index.html");
    const std::string report = content(folder.path / "report.html");
    CHECK(holds(index, "href=\"report.html\""));
    CHECK(holds(index, "Figure 1."));
    CHECK(!holds(index, "Figure 10."));
    CHECK(holds(report, "Figure 10."));
    CHECK(!holds(report, "Figure 1."));
    CHECK(holds(report, "<caption>Time &amp; error</caption>"));
    CHECK(holds(report, "<tr><th>law</th><th>ns</th></tr>"));
    CHECK(holds(report, "<tr><td>linear</td><td>7</td></tr>"));
  }

  TEST_CASE("an unknown figure is an error before anything is drawn") {
    const Folder folder;

    CHECK_THROWS_WITH_AS(draw_figures(kFigures, {1, 7}, {.out = folder.path, .scenes = {}},
                                      [](const std::string&) {}),
                         "figure 7: there is none; expected one of 1, 2", SceneError);
    CHECK(!fs::exists(folder.path));
  }

  TEST_CASE("a figure that fails leaves the others in the gallery") {
    const Folder folder;
    const std::vector<Figure> figures{{1, "First", first}, {2, "Broken", broken}};

    CHECK_THROWS_AS(
        draw_figures(figures, {}, {.out = folder.path, .scenes = {}}, [](const std::string&) {}),
        SimulationError);
    CHECK(holds(content(folder.path / "index.html"), "Figure 1."));
  }

  TEST_CASE("a stop between two figures keeps the first") {
    const Folder folder;
    int lines = 0;
    FigureOptions options{.out = folder.path, .scenes = {}};
    options.stop = [] { return true; };

    CHECK_THROWS_AS(draw_figures(kFigures, {}, options, [&](const std::string&) { ++lines; }),
                    Interrupted);
    CHECK(lines == 1);
  }

  TEST_CASE("figures are listed in order, each number once") {
    int last = 0;
    for (const Figure& figure : all_figures()) {
      CHECK(figure.number > last);
      CHECK((figure.draw != nullptr));
      last = figure.number;
    }
  }
}
