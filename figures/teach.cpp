// SPDX-License-Identifier: GPL-3.0-or-later
#include "teach.hpp"

#include "mathml.hpp"
#include "page.hpp"
#include "teach_numbers.hpp"
#include "teach_pictures.hpp"

#include <lagrain/check.hpp>
#include <lagrain/files.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/words.hpp>

#include "toml_library.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace lagrain::figures {
namespace {

namespace fs = std::filesystem;

constexpr int kDigits = 4;  // of a number in a text

/// A lesson, or the playground, as it was read.
struct Source {
  fs::path file;
  std::string stem;  // "01_power"
  std::string text;
  std::string title, goal;
  std::string cover = {};  // the address of its first picture
};

[[noreturn]] void fail(const Source& source, std::size_t at, const std::string& what) {
  const auto line =
      1 + std::count(
              source.text.begin(),
              source.text.begin() + static_cast<std::ptrdiff_t>(std::min(at, source.text.size())),
              '\n');
  throw SceneError(source.file.string() + ":" + std::to_string(line) + ": " + what);
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \n\t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \n\t") - first + 1);
}

/// What stands between two marks; empty if they are not there.
std::string between(const std::string& text, const std::string& open, const std::string& close) {
  const auto begin = text.find(open);
  if (begin == std::string::npos) return {};
  const auto end = text.find(close, begin + open.size());
  if (end == std::string::npos) return {};
  return text.substr(begin + open.size(), end - begin - open.size());
}

/// What every lesson owes its reader.
void check_parts(const Source& lesson) {
  const std::array<std::pair<const char*, const char*>, 6> parts{{
      {"<h1>", "a title (h1)"},
      {"class=\"goal\"", "a goal (class \"goal\")"},
      {"{{bench ", "a bench"},
      {"class=\"exercise\"", "an exercise (class \"exercise\")"},
      {"class=\"solution\"", "a solution (class \"solution\")"},
      {"class=\"script\"", "a script for the teacher (class \"script\")"},
  }};
  for (const auto& [mark, name] : parts) {
    if (lesson.text.find(mark) == std::string::npos) {
      fail(lesson, 0, std::string("it has no ") + (name + 2));
    }
  }
}

/// Reads a lesson. Its formulas, none of which goes over the end of a line, become MathML.
Source read_source(const fs::path& file) {
  Source source{file, file.stem().string(), read_file(file), {}, {}};
  std::istringstream lines(source.text);
  std::string text, line;
  for (int number = 1; std::getline(lines, line); ++number) {
    try {
      text += with_formulas(line) + "\n";
    } catch (const SceneError& error) {
      throw SceneError(file.string() + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  source.text = std::move(text);
  source.title = between(source.text, "<h1>", "</h1>");
  source.goal = between(source.text, "<p class=\"goal\">", "</p>");
  return source;
}

/// A picture as an address that holds it (RFC 2397). As text it compresses better than in base 64.
std::string address_with(const std::string& svg) {
  std::string address = "data:image/svg+xml,";
  for (const char c : svg) {
    constexpr std::string_view kHex = "0123456789ABCDEF";
    if (std::string_view("%#\"<>\n").find(c) == std::string_view::npos) {
      address += c;
    } else {
      address +=
          {'%', kHex[static_cast<unsigned char>(c) / 16], kHex[static_cast<unsigned char>(c) % 16]};
    }
  }
  return address;
}

/// A script without its comments and indentation, for a page that is mailed.
std::string lean(const std::string& script) {
  std::istringstream lines(script);
  std::string lean;
  for (std::string line; std::getline(lines, line);) {
    const std::string text = trimmed(line);
    const bool comment = text.starts_with("//") || text.starts_with("/*") || text.starts_with("* ");
    if (!text.empty() && !comment) lean += text + "\n";
  }
  return lean;
}

/// Fills in what a lesson asks for.
class Filler {
 public:
  Filler(const Source& source, const std::vector<Source>& lessons, const fs::path& out,
         bool in_page)
      : source_(source), lessons_(lessons), out_(out), in_page_(in_page) {}

  std::string filled() {
    const std::string& text = source_.text;
    std::string filled;
    std::size_t at = 0;
    for (std::size_t open; (open = text.find("{{", at)) != std::string::npos;) {
      const std::size_t close = text.find("}}", open);
      if (close == std::string::npos) fail(source_, open, "a {{ without }}");
      filled += text.substr(at, open - at);
      try {
        filled += answer(text.substr(open + 2, close - open - 2));
      } catch (const SceneError& error) {
        fail(source_, open, error.what());
      } catch (const toml::parse_error& error) {
        fail(source_, open, std::string(error.description()));
      }
      at = close + 2;
    }
    return filled + text.substr(at);
  }

 private:
  /// What takes the place of "name rest", or "name rest | text".
  std::string answer(const std::string& wish) {
    const std::size_t bar = wish.rfind('|');
    const std::string words = trimmed(bar == std::string::npos ? wish : wish.substr(0, bar));
    const std::string shows =
        bar == std::string::npos ? std::string() : trimmed(wish.substr(bar + 1));
    const std::size_t space = words.find_first_of(" \n");
    const std::string name = words.substr(0, space);
    const std::string rest =
        space == std::string::npos ? std::string() : trimmed(words.substr(space));
    if (name == "number") return in_text(number(rest));
    if (name == "value") return shortest(number(rest));
    if (name == "lesson") return link(rest);
    if (name != "picture" && name != "discs" && name != "bench") {
      throw SceneError(
          "there is no " + shown(name) +
          suggestion(name, {"number", "value", "lesson", "picture", "discs", "bench"}));
    }
    if (shows.empty())
      throw SceneError(name + " " + shortened(rest) + ": say what it shows, behind |");
    if (name == "picture") return figure(lesson_picture(rest), rest, shows);
    if (name == "discs") {
      const toml::table start = toml::parse(rest);
      return figure(picture_of_bench("discs", start), "discs", shows);
    }
    return bench(rest, shows);
  }

  /// A number of the last bench's start, or one of those that all lessons share.
  double number(const std::string& name) const {
    const std::string of_start = "start.";
    if (!name.starts_with(of_start)) return lesson_number(name);
    const auto value = start_[name.substr(of_start.size())].value<double>();
    if (!value) throw SceneError("the bench above has no number " + shown(name));
    return *value;
  }

  static std::string in_text(double value) {
    const std::string text = rounded(value, kDigits);
    return value == std::floor(value) && std::abs(value) < 1e15
               ? grouped(static_cast<std::int64_t>(value))
               : text;
  }

  std::string link(const std::string& number) const {
    for (const Source& lesson : lessons_) {
      if (!lesson.stem.starts_with(number + "_")) continue;
      return "<a href=\"" + lesson.stem + ".html\">lesson " + std::to_string(std::stoi(number)) +
             "</a>";
    }
    throw SceneError("there is no lesson " + shown(number));
  }

  /// An image element of a picture that was written beside the page, or into it.
  std::string image(const DisplayList& list, const std::string& name, const std::string& shows) {
    const std::string file = source_.stem + "_" + std::to_string(++pictures_) + "_" + name + ".svg";
    const fs::path path = out_ / "pictures" / file;
    paint_svg(list, path);
    std::string address = "pictures/" + file;
    if (in_page_) {
      address = address_with(read_file(path));
      std::error_code ignored;
      fs::remove(path, ignored);
    }
    return "<img src=\"" + address + "\" alt=\"" + escaped(shows) + "\">";
  }
  std::string figure(const DisplayList& list, const std::string& name, const std::string& shows) {
    return "<figure>" + image(list, name, shows) + "<figcaption>" + escaped(shows) +
           "</figcaption></figure>";
  }
  std::string bench(const std::string& rest, const std::string& shows) {
    const std::size_t space = rest.find_first_of(" \n");
    const std::string name = rest.substr(0, space);
    start_ = toml::parse(space == std::string::npos ? std::string() : rest.substr(space));
    complete_start(name, start_);
    std::ostringstream json;
    json << toml::json_formatter{start_, toml::format_flags::none};
    return "<div class=\"bench\" data-bench=\"" + name + "\" data-start=\"" + escaped(json.str()) +
           "\">" + image(picture_of_bench(name, start_), name, shows) + "</div>";
  }

  const Source& source_;
  const std::vector<Source>& lessons_;
  fs::path out_;
  bool in_page_;
  int pictures_ = 0;
  toml::table start_;  // of the last bench
};

/// What the pages run: the library if it was compiled for them, and the benches.
struct Scripts {
  std::string module, benches, style;
};

/// A page around a text.
/// @param before  above the text: links
std::string page(const std::string& title, const std::string& before, const std::string& text,
                 const std::string& style, const std::string& scripts) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(title) + "</title>\n" + style + "</head>\n<body>\n" +
         "<a class=\"skip\" href=\"#text\">to the text</a>\n" + before + "<main id=\"text\">\n" +
         text + "</main>\n" + scripts + "</body>\n</html>\n";
}

const std::string kLinkedStyle = "<link rel=\"stylesheet\" href=\"lab.css\">\n";

std::string linked(const Scripts& scripts) {
  if (scripts.module.empty()) return {};
  return "<script src=\"lagrain.js\"></script>\n<script src=\"lab.js\"></script>\n";
}

std::string links_around(const std::vector<Source>& lessons, std::size_t k) {
  const auto link = [](const std::string& file, const std::string& text) {
    return "<a href=\"" + file + ".html\">" + text + "</a>";
  };
  std::string links =
      "<nav class=\"lessons\" aria-label=\"lessons\">" + link("index", "All lessons");
  if (k > 0) links += link(lessons[k - 1].stem, "\xE2\x86\x90 " + lessons[k - 1].title);
  if (k + 1 < lessons.size()) {
    links += link(lessons[k + 1].stem, lessons[k + 1].title + " \xE2\x86\x92");
  }
  return links + link("playground", "Playground") + "</nav>\n";
}

/// The files of a folder with an ending, in the order of their names.
std::vector<fs::path> files_of(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() == ending) files.push_back(entry.path());
  }
  if (files.empty()) {
    throw SceneError(folder.string() + ": there are no files *" + ending +
                     "; expected what lagrain was installed with");
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string index_of(const std::vector<Source>& lessons, bool moves) {
  std::string text =
      "<h1>Triangulations that move</h1>\n"
      "<p class=\"goal\">Twelve lessons on regular triangulations and grains, each with something "
      "to move, two exercises that the page checks, and a script for the teacher. 20 to 30 minutes "
      "each.</p>\n";
  if (!moves) {
    text +=
        "<p class=\"trouble\">These pages were written without the compiled library: pictures "
        "stand still, and exercises are not checked. <code>figures/run --teach</code> installs "
        "what is missing.</p>\n";
  }
  text += "<ol class=\"contents\">\n";
  for (const Source& lesson : lessons) {
    text += "<li><a href=\"" + lesson.stem + ".html\"><img src=\"" + lesson.cover + "\" alt=\"\">" +
            lesson.title + "</a><p>" + lesson.goal + "</p></li>\n";
  }
  return text +
         "</ol>\n"
         "<p>The <a href=\"playground.html\">playground</a> has all benches with all switches, in "
         "one file that can be mailed.</p>\n";
}

}  // namespace

TeachReport write_lessons(const TeachOptions& options) {
  std::vector<Source> lessons;
  for (const fs::path& file : files_of(options.sources / "lessons", ".html")) {
    lessons.push_back(read_source(file));
    check_parts(lessons.back());
  }
  Scripts scripts;
  std::error_code ignored;
  if (fs::exists(options.module, ignored)) scripts.module = read_file(options.module);
  for (const fs::path& file : files_of(options.sources / "pages", ".js")) {
    scripts.benches += read_file(file);
  }
  scripts.style = read_file(options.sources / "lab.css");
  const bool moves = !scripts.module.empty();

  make_folder(options.out);
  make_folder(options.out / "pictures");
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file(options.out / name, text);
  };
  for (std::size_t k = 0; k < lessons.size(); ++k) {
    const std::string text = Filler(lessons[k], lessons, options.out, false).filled();
    lessons[k].cover = between(text, "<img src=\"", "\"");
    write(lessons[k].stem + ".html",
          page(lessons[k].title, links_around(lessons, k), text, kLinkedStyle, linked(scripts)));
  }
  write("index.html", page("lagrain: lessons", {}, index_of(lessons, moves), kLinkedStyle, {}));
  write("lab.css", scripts.style);
  write("lab.js", scripts.benches);
  if (moves) write("lagrain.js", scripts.module);

  const Source playground = read_source(options.sources / "playground.html");
  const std::string text = Filler(playground, lessons, options.out, true).filled();
  write("playground.html",
        page(playground.title, {}, text, "<style>\n" + scripts.style + "</style>\n",
             moves ? "<script>\n" + scripts.module + "</script>\n<script>\n" +
                         lean(scripts.benches) + "</script>\n"
                   : std::string()));
  return {static_cast<int>(lessons.size()), moves};
}

}  // namespace lagrain::figures
