// SPDX-License-Identifier: GPL-3.0-or-later
// Plots of a run's series, and how pages become files.

#include "own_picture.hpp"

#include <lagrain/style.hpp>
#include <lagrain/text.hpp>
#include <lagrain/words.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lagrain::figures {
namespace {

constexpr double kWidth = 330, kPanel = 190, kBetween = 12;  // [pt]

bool is_nothing(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
}

/// The energies that are anything.
std::vector<std::string> energies(const CsvFile& csv,
                                  const std::vector<std::vector<double>>& columns) {
  std::vector<std::string> names;
  for (const char* name : {"kinetic", "elastic", "wall_work", "dashpot", "friction", "driven_work",
                           "carried", "drag_work"}) {
    const auto place = csv.find(name);
    if (place && !is_nothing(columns[*place])) names.emplace_back(name);
  }
  if (names.empty()) names.emplace_back("kinetic");
  return names;
}

}  // namespace

std::string label_text(const std::string& text) {
  std::string label;
  for (std::size_t k = 0; k < text.size();) {
    std::size_t end = k + 1;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) ++end;
    std::string letter = text.substr(k, end - k);
    k = end;
    if (letter == "$" || letter == "\\") letter.insert(0, "\\");
    try {
      text_extents(letter, style::kText);
    } catch (const std::exception&) {
      letter = "?";  // the font does not have it
    }
    label += letter;
  }
  return label;
}

PicturePage plot_of_series(const std::filesystem::path& series, std::vector<std::string> names,
                           std::optional<std::array<int, 2>> size) {
  CsvFile csv(series);
  const std::size_t time = csv.column("time");
  std::vector<std::vector<double>> columns(csv.names().size());
  while (csv.next()) {
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].push_back(csv.number(c));
  }
  if (columns[time].empty()) throw SceneError(series.string() + ": no row yet");
  if (names.empty()) names = energies(csv, columns);

  std::vector<std::pair<std::string, Plot>> plots;  // by unit
  for (const std::string& asked : names) {
    const std::string name = asked.substr(0, asked.find('['));
    const auto place = csv.find(name);
    if (!place || *place == time) {
      throw SceneError(series.string() + ": no column " + shown(name) +
                       suggestion(name, csv.names()));
    }
    const std::string& unit = csv.units()[*place];
    auto plot =
        std::find_if(plots.begin(), plots.end(), [&](const auto& p) { return p.first == unit; });
    if (plot == plots.end()) {
      plots.push_back({unit, {.x = {.label = ""}, .y = {}, .series = {}}});
      plot = plots.end() - 1;
    }
    Series curve = series_style(static_cast<int>(plot->second.series.size()));
    curve.name = label_text(name);
    curve.x = columns[time];
    curve.y = columns[*place];
    // Values of walls that do not exist yet, and so on.
    if (std::none_of(curve.y.begin(), curve.y.end(), [](double v) { return std::isfinite(v); })) {
      throw SceneError(series.string() + ": \"" + name + "\" has no values");
    }
    plot->second.series.push_back(std::move(curve));
  }

  PicturePage page;
  DisplayList& list = page.list;
  list.title = "lagrain";
  list.width = kWidth;
  list.height = static_cast<double>(plots.size()) * (kPanel + kBetween);
  if (size) {
    list.height =
        std::max(list.width * (*size)[1] / (*size)[0], 110.0 * static_cast<double>(plots.size()));
    page.dpi = 72.0 * (*size)[0] / list.width;
  }
  const double panel = list.height / static_cast<double>(plots.size());
  double y = list.height;
  for (auto& [unit, plot] : plots) {
    const bool energy = unit == "J";
    const bool alone = plot.series.size() == 1;
    const std::string bracket = unit == "-" || unit.empty() ? "" : " [" + unit + "]";
    plot.x.label = "time [s]";
    plot.y.label = (alone ? plot.series[0].name : energy ? "energy" : "") + bracket;
    if (alone) plot.legend = Corner::none;
    // Room for the legend above the curves.
    double low = 0, high = 0;
    bool first = true;
    for (const Series& curve : plot.series) {
      for (const double v : curve.y) {
        if (!std::isfinite(v)) continue;
        low = first ? v : std::min(low, v);
        high = first ? v : std::max(high, v);
        first = false;
      }
    }
    if (!alone && low < high) {
      const double rows = static_cast<double>(plot.series.size()) * 12 / (panel - 60);
      plot.y.high = high + (high - low) * std::min(0.15 + 1.3 * rows, 2.0);
    }
    add_plot(list, {{4, y - panel + 5}, {kWidth - 4, y - 5}}, plot);
    y -= panel;
  }
  return page;
}

void write_page(const PicturePage& page, const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".png") {
    paint_png(page.list, file, page.dpi);
  } else if (ending == ".pdf") {
    paint_pdf(page.list, file);
  } else if (ending == ".svg") {
    paint_svg(page.list, file);
  } else {
    throw SceneError(file.string() + ": a picture ends in .png, .pdf or .svg");
  }
}

}  // namespace lagrain::figures
