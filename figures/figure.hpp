// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// What a figure is. Each is one file that draws it and says what it shows; figures.cpp lists them.

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

namespace lagrain {

/// The user stopped a figure before it was drawn.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("stopped by the user") {}
};

/// A function that long work calls every few steps: it throws Interrupted once the user wants to
/// stop. It may show progress as well. Empty where nothing has to stop.
using StopCheck = std::function<void()>;

/// What a figure is told.
struct FigureOptions {
  std::filesystem::path out;     ///< folder for its files; it exists
  std::filesystem::path scenes;  ///< folder of the scene files
  bool quick = false;            ///< same picture from a smaller scene
  /// How far it has come [0 to 1] and what it is doing; may be called at every step.
  std::function<void(double fraction, const std::string& doing)> progress =
      [](double, const std::string&) {};
  /// True once the user wants to stop; a figure then throws Interrupted.
  std::function<bool()> stop = [] { return false; };

  /// @throws Interrupted once the user wants to stop
  void check_stop() const {
    if (stop()) throw Interrupted();
  }
};

/// A number of the paper beside ours. Text, with units: how many digits make sense differs.
struct Comparison {
  std::string quantity;
  std::string paper;
  std::string ours;
};

struct Fact {
  std::string name;
  std::string value;
};

/// Rows of text under a head; numbers with as many digits as make sense.
struct Table {
  std::string title;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// What a figure leaves behind. Paths lie in, or are relative to, FigureOptions::out.
struct FigureResult {
  std::string caption;
  std::vector<Comparison> comparisons;
  std::vector<Fact> facts;
  std::vector<std::filesystem::path> pictures;   ///< PNG and video are shown, PDF and SVG linked
  std::vector<std::filesystem::path> downloads;  ///< linked: CSV, scenes
  std::vector<Table> tables = {};
};

/// Where a figure stands: among those of the paper, or in the report of speed against error.
enum class Page { figures, report };

struct Figure {
  int number;
  std::string title;
  FigureResult (*draw)(const FigureOptions&);
  Page page = Page::figures;
};

/// Every figure that exists, in order.
const std::vector<Figure>& all_figures();

/// Draws figures in the order of `all`, tells `report` one line each, and renews the gallery
/// index.html and report.html after each one. Figures drawn by an earlier call stay in them.
/// @param numbers  which; none means all
/// @throws SceneError for an unknown number, before anything is drawn, or an unwritable folder
/// @throws Interrupted, SimulationError as a figure throws them; the gallery holds what was drawn
void draw_figures(const std::vector<Figure>& all, const std::vector<int>& numbers,
                  const FigureOptions& options,
                  const std::function<void(const std::string& line)>& report);

/// Where the report's entry for the speed page is kept.
std::filesystem::path speed_article_file(const std::filesystem::path& out);

/// Writes index.html and report.html anew, from what figures and the speed page have left in
/// the folder.
/// @throws SceneError if it cannot be written
void renew_gallery(const std::vector<Figure>& all, const std::filesystem::path& out);

}  // namespace lagrain
