#include "figure.hpp"

#include <lagrain/output.hpp>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>

namespace lagrain {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>lagrain: figures</title>
<style>
body { font: 17px/1.55 "Latin Modern Roman", Charter, Georgia, serif; color: #222; background: #fff;
       max-width: 52rem; margin: 3rem auto; padding: 0 1.2rem; }
h1 { font-weight: normal; margin-bottom: 0; }
h2 { font-size: 1.25rem; margin: 0 0 .8rem; }
article { border-top: 1px solid #ccc; padding-top: 1.6rem; margin-top: 2.6rem; }
img, video { display: block; max-width: 100%; height: auto; margin: .6rem 0; }
table { border-collapse: collapse; margin: .8rem 0; font-size: .92rem; }
th, td { text-align: left; vertical-align: top; padding: .15rem 1.4rem .15rem 0; }
th { font-weight: normal; color: #666; }
thead th { border-bottom: 1px solid #ccc; }
.links, .note { color: #666; font-size: .92rem; }
.links a { margin-right: 1rem; }
a { color: #0a5a9c; }
</style>
</head>
<body>
)";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// A path as a link inside the gallery: relative to it, with what a URL cannot hold encoded.
std::string link(const fs::path& file, const fs::path& out) {
  const std::string plain =
      (file.is_absolute() ? file.lexically_relative(fs::absolute(out)) : file).generic_string();
  std::string url;
  for (const char c : plain) {
    constexpr std::string_view kHex = "0123456789ABCDEF";
    if (std::string_view("%?#\"<> &").find(c) == std::string_view::npos) {
      url += c;
    } else {
      url += '%';
      url += kHex[static_cast<unsigned char>(c) / 16];
      url += kHex[static_cast<unsigned char>(c) % 16];
    }
  }
  return url;
}

/// A path below `out` may be given with `out` in front or without.
fs::path inside(const fs::path& file, const fs::path& out) {
  const fs::path relative = fs::absolute(file).lexically_relative(fs::absolute(out));
  return relative.empty() || *relative.begin() == ".." ? file : relative;
}

std::string article(const Figure& figure, const FigureResult& result, const FigureOptions& options,
                    const std::string& seconds) {
  const std::string number = std::to_string(figure.number);
  std::string html = "<article id=\"fig" + number + "\">\n<h2>Figure " + number + ". " +
                     escaped(figure.title) + "</h2>\n";
  std::string links;
  const auto add_link = [&](const fs::path& file) {
    const std::string url = link(file, options.out);
    links += "<a href=\"" + url + "\">" + escaped(file.filename().string()) + "</a>\n";
  };
  for (const fs::path& given : result.pictures) {
    const fs::path picture = inside(given, options.out);
    const std::string url = link(picture, options.out);
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

void write_index(const std::vector<Figure>& all, const fs::path& out) {
  std::string html = kHead;
  html +=
      "<h1>lagrain</h1>\n<p class=\"note\">Granular simulation on dynamic regular "
      "triangulations, after Ferrez &amp; Liebling. Version " +
      std::string(version()) + ".</p>\n";
  bool any = false;
  for (const Figure& figure : all) {
    std::ifstream in(article_file(figure, out), std::ios::binary);
    if (!in) continue;
    std::ostringstream text;
    text << in.rdbuf();
    html += text.str();
    any = true;
  }
  if (!any) html += "<p>No figure has been drawn yet.</p>\n";
  write_file(out / "index.html", html + "</body>\n</html>\n");
}

}  // namespace

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
  write_index(all, options.out);
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
    write_index(all, options.out);
    report("figure " + std::to_string(figure.number) + ": " + figure.title + " (" + taken + " s)");
    if (options.stop()) throw Interrupted();
  }
}

}  // namespace lagrain
