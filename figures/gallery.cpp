// SPDX-License-Identifier: GPL-3.0-or-later
#include "figure.hpp"
#include "page.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

/// A path below `out` may be given with `out` in front or without.
fs::path inside(const fs::path& file, const fs::path& out) {
  const fs::path relative = fs::absolute(file).lexically_relative(fs::absolute(out));
  return relative.empty() || *relative.begin() == ".." ? file : relative;
}

std::string table_html(const Table& table) {
  const auto row = [](const std::vector<std::string>& cells, const std::string& tag) {
    std::string html = "<tr>";
    for (const std::string& cell : cells)
      html += "<" + tag + ">" + escaped(cell) + "</" + tag + ">";
    return html + "</tr>";
  };
  std::string html = "<table>\n<caption>" + escaped(table.title) + "</caption>\n<thead>" +
                     row(table.head, "th") + "</thead>\n";
  for (const auto& cells : table.rows) html += row(cells, "td") + "\n";
  return html + "</table>\n";
}

std::string article(const Figure& figure, const FigureResult& result, const FigureOptions& options,
                    const std::string& seconds) {
  const std::string number = std::to_string(figure.number);
  std::string html = "<article id=\"fig" + number + "\">\n<h2>Figure " + number + ". " +
                     escaped(figure.title) + "</h2>\n";
  std::string links;
  const auto add_link = [&](const fs::path& file) {
    const std::string url = page_link(file, options.out);
    links += "<a href=\"" + url + "\">" + escaped(file.filename().string()) + "</a>\n";
  };
  for (const fs::path& given : result.pictures) {
    const fs::path picture = inside(given, options.out);
    const std::string url = page_link(picture, options.out);
    const std::string kind = picture.extension().string();
    if (kind == ".png") {
      html += "<a href=\"" + url + "\"><img src=\"" + url + "\" alt=\"Figure " + number + ": " +
              escaped(figure.title) + "\"></a>\n";
    } else if (kind == ".mp4" || kind == ".webm") {
      html += "<video src=\"" + url + "\" controls loop muted playsinline></video>\n";
    }
    add_link(picture);
  }
  for (const fs::path& file : result.downloads) add_link(inside(file, options.out));
  html += "<p>" + escaped(result.caption) + "</p>\n";
  if (!result.comparisons.empty()) {
    html += "<table>\n<thead><tr><th></th><th>paper</th><th>lagrain</th></tr></thead>\n";
    for (const Comparison& c : result.comparisons) {
      html += "<tr><th>" + escaped(c.quantity) + "</th><td>" + escaped(c.paper) + "</td><td>" +
              escaped(c.ours) + "</td></tr>\n";
    }
    html += "</table>\n";
  }
  for (const Table& table : result.tables) html += table_html(table);
  html += "<table>\n";
  for (const Fact& fact : result.facts) {
    html += "<tr><th>" + escaped(fact.name) + "</th><td>" + escaped(fact.value) + "</td></tr>\n";
  }
  html += "<tr><th>drawn in</th><td>" + seconds + " s" +
          (options.quick ? ", quick: from a smaller scene" : "") + "</td></tr>\n</table>\n";
  if (!links.empty()) html += "<p class=\"links\">" + links + "</p>\n";
  return html + "</article>\n";
}

/// Each figure's article is kept beside it, so that a later call can draw another one alone.
fs::path article_file(const Figure& figure, const fs::path& out) {
  return out / ("fig" + std::to_string(figure.number) + ".html.part-of-index");
}

}  // namespace

fs::path speed_article_file(const fs::path& out) { return out / "speed.html.part-of-index"; }

void renew_gallery(const std::vector<Figure>& all, const fs::path& out) {
  const auto text_of = [](const fs::path& file) {
    std::ostringstream text;
    if (std::ifstream in(file, std::ios::binary); in) text << in.rdbuf();
    return text.str();
  };
  std::string figures, report;
  for (const Figure& figure : all) {
    (figure.page == Page::figures ? figures : report) += text_of(article_file(figure, out));
  }
  report += text_of(speed_article_file(out));
  const auto note = [](const std::string& text) { return "<p class=\"note\">" + text + "</p>\n"; };

  std::string html = page_head("lagrain: figures") + "<h1>lagrain</h1>\n" +
                     note(
                         "Granular simulation on dynamic regular triangulations, after Ferrez "
                         "&amp; Liebling. Version " +
                         std::string(version()) + ".");
  if (!report.empty()) html += note("<a href=\"report.html\">Speed against error</a>");
  if (figures.empty()) html += "<p>No figure has been drawn yet.</p>\n";
  write_file(out / "index.html", html + figures + "</body>\n</html>\n");
  if (report.empty()) return;
  html = page_head("lagrain: speed against error") + "<h1>Speed against error</h1>\n" +
         note(
             "<a href=\"index.html\">lagrain</a>: which choice for which error. Every number was "
             "measured by the program that drew the diagrams, on one machine.");
  write_file(out / "report.html", html + report + "</body>\n</html>\n");
}

void draw_figures(const std::vector<Figure>& all, const std::vector<int>& numbers,
                  const FigureOptions& options,
                  const std::function<void(const std::string& line)>& report) {
  for (const int number : numbers) {
    if (std::any_of(all.begin(), all.end(), [&](const Figure& f) { return f.number == number; }))
      continue;
    std::string known;
    for (const Figure& f : all) known += (known.empty() ? "" : ", ") + std::to_string(f.number);
    throw SceneError("figure " + std::to_string(number) + ": there is none; " +
                     (known.empty() ? "no figure exists yet" : "expected one of " + known));
  }
  make_folder(options.out);
  renew_gallery(all, options.out);
  for (const Figure& figure : all) {
    if (!numbers.empty() &&
        std::find(numbers.begin(), numbers.end(), figure.number) == numbers.end())
      continue;
    const auto start = std::chrono::steady_clock::now();
    const FigureResult result = figure.draw(options);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::string taken =
        seconds < 9.95 ? rounded(seconds, 2) : rounded(std::round(seconds), 6);
    write_file(article_file(figure, options.out), article(figure, result, options, taken));
    renew_gallery(all, options.out);
    report("figure " + std::to_string(figure.number) + ": " + figure.title + " (" + taken + " s)");
    options.check_stop();
  }
}

}  // namespace lagrain
