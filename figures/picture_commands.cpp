// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture_commands.hpp"

#include "figure.hpp"
#include "run_folder.hpp"

#include <lagrain/check.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/units.hpp>
#include <lagrain/words.hpp>

#ifdef LAGRAIN_WITH_RENDER
#include "own_picture.hpp"

#include <lagrain/video.hpp>
#endif

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string folder;
  std::string at;
  std::string show = "grains,walls";
  std::string colour;
  std::string view;
  std::vector<std::string> cuts;
  std::string size;
  std::string out;
  std::vector<std::string> columns;
  int fps = 25;
};

#ifdef LAGRAIN_WITH_RENDER

/// The parts of a text between commas.
std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else if (c != ' ') {
      parts.back() += c;
    }
  }
  return parts;
}

/// The value that belongs to a word.
template <class Value>
Value chosen(const std::string& flag, const std::string& word,
             const std::vector<std::pair<std::string, Value>>& known) {
  std::string list;
  std::vector<std::string> names;
  for (const auto& [name, value] : known) {
    if (name == word) return value;
    list += (list.empty() ? "" : ", ") + name;
    names.push_back(name);
  }
  throw SceneError(flag + ": there is no " + shown(word) + suggestion(word, names) +
                   "; expected one of " + list);
}

double quantity(const std::string& flag, const std::string& text, Unit unit,
                const std::string& what) {
  try {
    const Quantity q = parse_quantity(text);
    if ((q.unit == unit || q.unit == Unit{}) && std::isfinite(q.value)) return q.value;
  } catch (const std::invalid_argument&) {  // said below
  }
  throw SceneError(flag + ": expected " + what + ", got \"" + text + "\"");
}

Vec<2> view_of(const std::string& text) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const std::vector<std::pair<std::string, Vec<2>>> known{
      {"front", {0, 0}},          {"back", {2 * kQuarter, 0}},
      {"left", {-kQuarter, 0}},   {"right", {kQuarter, 0}},
      {"side", {kQuarter, 0}},    {"top", {0, kQuarter}},
      {"bottom", {0, -kQuarter}}, {"iso", {-kQuarter / 2, std::atan(std::sqrt(0.5))}}};
  const std::vector<std::string> parts = parts_of(text);
  if (parts.size() == 2) {
    const Unit none{};
    const double azimuth = quantity("--view", parts[0], none, "two angles in degrees");
    const double elevation = quantity("--view", parts[1], none, "two angles in degrees");
    if (std::abs(elevation) > 90) {
      throw SceneError("--view: expected an elevation from -90 to 90 degrees, got \"" + parts[1] +
                       "\"");
    }
    return kQuarter / 90 * Vec<2>(azimuth, elevation);
  }
  return chosen("--view", text, known);
}

Cut cut_of(const std::string& text) {
  std::string tight;
  for (const char c : text) {
    if (c != ' ') tight += c;
  }
  const std::string expected = "\"x > 2 cm\" or \"z < 0.1\", what is taken out";
  if (tight.size() < 3 || tight[0] < 'x' || tight[0] > 'z' ||
      (tight[1] != '<' && tight[1] != '>')) {
    throw SceneError("--cut: expected " + expected + ", got \"" + text + "\"");
  }
  const double sign = tight[1] == '>' ? 1 : -1;
  const double at = quantity("--cut", text.substr(text.find(tight[1]) + 1), {.metre = 1}, expected);
  return {sign * Vec<3>::Unit(tight[0] - 'x'), sign * at};
}

std::array<int, 2> size_of(const std::string& text) {
  int width = 0, height = 0;
  char rest = 0;
  constexpr int kMost = 16000;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 64 ||
      height < 64 || width > kMost || height > kMost) {
    throw SceneError(
        "--size: expected width and height in pixels, from 64 to 16000, such as "
        "\"1600x1200\", got \"" +
        text + "\"");
  }
  return {width, height};
}

PictureWish wish_of(const Arguments& arguments, int dimension) {
  PictureWish wish;
  wish.grains = wish.walls = false;
  const std::vector<std::pair<std::string, bool PictureWish::*>> layers{
      {"grains", &PictureWish::grains}, {"forces", &PictureWish::forces},
      {"cells", &PictureWish::cells},   {"edges", &PictureWish::edges},
      {"skins", &PictureWish::skins},   {"walls", &PictureWish::walls}};
  for (const std::string& name : parts_of(arguments.show)) {
    wish.*chosen("--show", name, layers) = true;
  }
  if (!arguments.colour.empty()) {
    wish.colour = chosen<ColourBy>("--colour", arguments.colour,
                                   {{"plain", ColourBy::plain},
                                    {"speed", ColourBy::speed},
                                    {"force", ColourBy::force},
                                    {"material", ColourBy::material},
                                    {"group", ColourBy::group},
                                    {"spin", ColourBy::spin},
                                    {"radius", ColourBy::radius},
                                    {"coordination", ColourBy::coordination},
                                    {"height", ColourBy::height}});
  }
  if (dimension == 2 && !(arguments.view.empty() && arguments.cuts.empty())) {
    throw SceneError("--view and --cut are for spheres; this run is of discs");
  }
  if (dimension == 3 && wish.skins) {
    throw SceneError("--show skins: skins are drawn around discs only, spheres would hide in them");
  }
  if (!arguments.view.empty()) wish.view = view_of(arguments.view);
  for (const std::string& text : arguments.cuts) wish.cuts.push_back(cut_of(text));
  constexpr std::size_t kMostCuts = 8;
  if (wish.cuts.size() > kMostCuts) throw SceneError("--cut: at most 8");
  if (!arguments.size.empty()) wish.size = size_of(arguments.size);
  return wish;
}

fs::path file_of(const Arguments& arguments, const std::string& name,
                 const std::vector<std::string>& endings) {
  if (arguments.out.empty()) return fs::path(arguments.folder) / name;
  fs::path file = arguments.out;
  const std::string ending = file.extension().string();
  if (std::find(endings.begin(), endings.end(), ending) == endings.end()) {
    std::string list;
    for (const std::string& e : endings) list += (list.empty() ? "" : ", ") + e;
    throw SceneError("--out: \"" + arguments.out + "\" ends in none of " + list);
  }
  return file;
}

template <int Dim>
int draw_run(const Arguments& arguments) {
  const fs::path file = file_of(arguments, "picture.png", {".png", ".pdf", ".svg"});
  const PictureWish wish = wish_of(arguments, Dim);
  std::optional<double> time;
  if (!arguments.at.empty()) time = quantity("--at", arguments.at, {.second = 1}, "a time");
  const RunFolder<Dim> folder(arguments.folder);
  const Snapshot<Dim> snapshot =
      folder.nearest(time, {.contacts = wish.needs_contacts(), .groups = wish.needs_groups()});
  const PictureScale<Dim> scale = scale_of(folder.scene(), snapshot, wish);
  write_page(picture_of(folder.scene(), snapshot, wish, scale), file);
  std::cout << "wrote " << file.string() << " (" << snapshot.source
            << ", t = " << rounded(snapshot.frame.time, 4) << " s)\n";
  return 0;
}

template <int Dim>
int film_run(const Arguments& arguments, const std::function<bool()>& stop) {
  const fs::path file = file_of(arguments, "movie.mp4", {".mp4", ".webm"});
  PictureWish wish = wish_of(arguments, Dim);
  wish.subframes = kVideoSubframes;
  const RunFolder<Dim> folder(arguments.folder);
  if (folder.frames() < 2) {
    throw SceneError(arguments.folder +
                     ": a film needs two frames or more; say under [output] of "
                     "the scene how often there is one, such as frames_every = \"20 ms\"");
  }
  const typename RunFolder<Dim>::Wish needed{wish.needs_contacts(), wish.needs_groups()};
  std::optional<PictureScale<Dim>> scale;
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < folder.frames(); ++k) {
    if (stop()) throw Interrupted();
    const Snapshot<Dim> snapshot = folder.at(k, needed);
    // Before the first grain comes there is nothing to see.
    if (snapshot.frame.id.empty() && folder.scene().inlets.empty()) continue;
    const PictureScale<Dim> own = scale_of(folder.scene(), snapshot, wish);
    scale ? scale->extend(own) : void(scale = own);
    shown.push_back(k);
  }
  if (!scale) throw SceneError(arguments.folder + ": no grain in any frame");
  if (!wish.size) {
    // As wide as a screen shows it.
    constexpr double kPixels = 1280;
    PictureWish plain = wish;
    plain.subframes = kPreviewSubframes;
    const DisplayList list =
        picture_of(folder.scene(), folder.at(shown.front(), needed), plain, *scale).list;
    const double dots = kPixels / std::max(list.width, list.height);
    wish.size = {static_cast<int>(dots * list.width) & ~1,
                 static_cast<int>(dots * list.height) & ~1};
  }
  VideoWriter video(file, arguments.fps);
  for (const std::size_t k : shown) {
    if (stop()) throw Interrupted();
    const PicturePage page = picture_of(folder.scene(), folder.at(k, needed), wish, *scale);
    video.add(paint_rgba(page.list, page.dpi, Quality::frame));
  }
  const VideoReport report = video.finish();
  std::cout << "wrote " << report.path.string() << " (" << report.frames << " frames)\n";
  if (!report.encoded) {
    std::cerr << "lagrain: there is no ffmpeg, so the film is a folder of pictures; install it "
                 "(Debian: apt install ffmpeg) and draw again for a video\n";
  }
  return 0;
}

int plot_run(const Arguments& arguments) {
  const fs::path file = file_of(arguments, "plot.png", {".png", ".pdf", ".svg"});
  std::optional<std::array<int, 2>> size;
  if (!arguments.size.empty()) size = size_of(arguments.size);
  dimension_of_run(arguments.folder);
  write_page(plot_of_series(fs::path(arguments.folder) / "series.csv", arguments.columns, size),
             file);
  std::cout << "wrote " << file.string() << "\n";
  return 0;
}

#endif

void add_picture_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--show", arguments.show, "grains,forces,cells,edges,skins,walls")
      ->capture_default_str();
  app.add_option("--colour,--color", arguments.colour,
                 "plain|speed|force|material|group|spin|radius|coordination|height (default: "
                 "material if several, or speed if anything moves)");
  app.add_option("--view", arguments.view,
                 "of spheres: front|back|left|right|side|top|bottom|iso, or \"azimuth,elevation\" "
                 "in degrees");
  app.add_option("--cut", arguments.cuts,
                 "takes spheres out: \"y < 0\", \"x > 2 cm\"; again for each")
      ->allow_extra_args(false);
}

void add_common_options(CLI::App& app, Arguments& arguments, const std::string& endings,
                        const std::string& usual) {
  app.add_option("run", arguments.folder, "folder of the run")->required();
  app.add_option("--size", arguments.size, "width and height in pixels, \"1600x1200\"");
  app.add_option("--out", arguments.out,
                 "file to write, " + endings + " (default: " + usual + " in the folder)");
}

}  // namespace

struct PictureCommands::Commands {
  CLI::App* draw = nullptr;
  CLI::App* film = nullptr;
  CLI::App* plot = nullptr;
  Arguments arguments;
};

PictureCommands::PictureCommands(CLI::App& program) : commands_(std::make_unique<Commands>()) {
  Commands& c = *commands_;
  c.draw = program.add_subcommand("draw", "Draw a picture of a run");
  add_common_options(*c.draw, c.arguments, ".png, .pdf or .svg (spheres lie in these as pixels)",
                     "picture.png");
  c.draw->add_option("--at", c.arguments.at, "time of the picture, \"0.5 s\" (default: the last)");
  add_picture_options(*c.draw, c.arguments);

  c.film = program.add_subcommand("movie", "Make a film of the frames of a run");
  add_common_options(*c.film, c.arguments, ".mp4 or .webm", "movie.mp4");
  c.film->add_option("--fps", c.arguments.fps, "frames in a second of the film")
      ->check(CLI::Range(1, 240))
      ->capture_default_str();
  add_picture_options(*c.film, c.arguments);

  c.plot = program.add_subcommand("plot", "Plot columns of a run's series against time");
  add_common_options(*c.plot, c.arguments, ".png, .pdf or .svg", "plot.png");
  c.plot->add_option("columns", c.arguments.columns,
                     "names of columns of series.csv (default: the energies)");
}

PictureCommands::~PictureCommands() = default;

bool PictureCommands::parsed() const {
  return commands_->draw->parsed() || commands_->film->parsed() || commands_->plot->parsed();
}

int PictureCommands::run(const std::function<bool()>& stop) const {
#ifdef LAGRAIN_WITH_RENDER
  const Arguments& arguments = commands_->arguments;
  const int dimension = dimension_of_run(arguments.folder);
  if (commands_->plot->parsed()) return plot_run(arguments);
  if (commands_->draw->parsed()) {
    return dimension == 2 ? draw_run<2>(arguments) : draw_run<3>(arguments);
  }
  return dimension == 2 ? film_run<2>(arguments, stop) : film_run<3>(arguments, stop);
#else
  (void)stop;
  throw SceneError(
      "this lagrain was built without its renderer, so it draws nothing; build it with "
      "-DLAGRAIN_RENDER=ON");
#endif
}

}  // namespace lagrain::figures
