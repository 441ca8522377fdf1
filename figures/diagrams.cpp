// SPDX-License-Identifier: GPL-3.0-or-later
#include "diagrams.hpp"

#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace lagrain::figures {

Series curve(int index, const std::string& name) {
  constexpr std::array<Marker, 5> kMarkers{Marker::disc, Marker::ring, Marker::square,
                                           Marker::triangle, Marker::diamond};
  Series series = series_style(index);
  series.name = name;
  series.marker = kMarkers[static_cast<std::size_t>(index) % kMarkers.size()];
  return series;
}

Diagram error_diagram(const std::string& title, const std::string& error, Corner legend) {
  return {title,
          {.x = {.label = "processor s per simulated s", .log = true},
           .y = {.label = "error: " + error, .log = true},
           .series = {},
           .legend = legend}};
}

void leave_room_for_legend(Plot& plot) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Series& series : plot.series) {
    for (const double y : series.y) {
      if (!std::isfinite(y) || (plot.y.log && y <= 0)) continue;
      low = std::min(low, y);
      high = std::max(high, y);
    }
  }
  if (!(low <= high)) return;
  const auto named = std::count_if(plot.series.begin(), plot.series.end(),
                                   [](const Series& s) { return !s.name.empty(); });
  const double room = 0.06 + 0.09 * static_cast<double>(named);  // of the height
  if (plot.y.log) {
    plot.y.low = low / 1.5;
    plot.y.high = high * std::pow(high / *plot.y.low, room / (1 - room));
  } else {
    const double below = low == high ? 0.5 * std::abs(low) : 0.05 * (high - low);
    plot.y.low = low - below;
    plot.y.high = high + (high - *plot.y.low) * room / (1 - room);
  }
}

void draw_diagrams(const std::vector<Diagram>& diagrams, int columns, double height,
                   const FigureOptions& options, const std::string& name, FigureResult& result) {
  constexpr double kGap = 14, kTitleRoom = 18;
  const int count = static_cast<int>(diagrams.size()), rows = (count + columns - 1) / columns;
  const double width = (style::kPage - (columns - 1) * kGap) / columns;
  DisplayList list{
      .width = style::kPage, .height = rows * (height + kTitleRoom), .title = "lagrain, " + name};
  for (int k = 0; k < count; ++k) {
    const Diagram& diagram = diagrams[static_cast<std::size_t>(k)];
    const double x = (k % columns) * (width + kGap);
    const double y = list.height - (k / columns + 1) * (height + kTitleRoom);
    add_plot(list, {{x, y}, {x + width, y + height}}, diagram.plot);
    list.add(Label{.text = diagram.title, .at = {x, y + height + 6}, .size = style::kTitle});
  }
  paint_png(list, options.out / (name + ".png"), 300);
  paint_pdf(list, options.out / (name + ".pdf"));
  result.pictures.push_back(name + ".png");
  result.pictures.push_back(name + ".pdf");
}

}  // namespace lagrain::figures
