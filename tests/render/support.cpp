// SPDX-License-Identifier: GPL-3.0-or-later
#include "support.hpp"

#include <lagrain/plot.hpp>
#include <lagrain/random.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace lagrain::test {

DisplayList mixed_list() {
  DisplayList list{style::kPage, 200};
  list.title = "mixed";
  Random random(7);
  const Panel panel({{10, 20}, {180, 190}}, {{0, 0}, {1, 1}});
  list.add(PushClip{panel.box()});
  // Hexagonal cells with a disc in each; the outermost ones reach beyond the clip.
  for (int row = -1; row < 7; ++row) {
    for (int k = -1; k < 7; ++k) {
      const Vec<2> centre(0.17 * k + (row % 2 == 0 ? 0 : 0.085), 0.147 * row);
      Polygon cell{{}, style::kCell, style::kCellLine};
      for (int corner = 0; corner < 6; ++corner) {
        const double angle = (corner + 0.5) * std::numbers::pi / 3;
        cell.corners.push_back(
            panel.point(centre + 0.098 * Vec<2>(std::cos(angle), std::sin(angle))));
      }
      list.add(cell);
      list.add(
          Segment{panel.point(centre), panel.point(centre + Vec<2>(0.17, 0)), style::kEdgeLine});
      list.add(Disc{panel.point(centre), panel.length(random.uniform(0.02, 0.08)),
                    with_alpha(style::kGrain, 0.8), style::kGrainLine});
      list.add(
          Label{std::string("$S_{").append(std::to_string(10 * (row + 1) + k + 1)).append("}$"),
                panel.point(centre), 8, style::kInk, Across::centre, Along::middle});
    }
  }
  list.add(PopClip{});
  add_frame(list, panel.box(), style::kWallLine);
  add_colour_bar(list, {{200, 40}, {208, 150}}, ColourMap::viridis, 0, 3, "$v$ [m/s]");
  const std::array<double, 3> forces{1, 5, 10};
  add_width_legend(list, {195, 22}, forces, 0.3, "N");
  for (int k = 0; k < 60; ++k) {
    const Vec<2> from(random.uniform(245, 300), random.uniform(20, 190));
    list.add(Segment{from,
                     from + Vec<2>(random.uniform(-9, 9), random.uniform(-9, 9)),
                     {style::kContact, 3 * random.uniform() * random.uniform()}});
  }
  Plot plot;
  plot.x.label = "time $t$ [s]";
  plot.y.label = "energy $E_\\mathrm{k}$ [J]";
  for (int s = 0; s < 4; ++s) {
    Series series = series_style(s);
    series.name = "$\\mu = 0." + std::to_string(s) + "$";
    for (int k = 0; k < 60; ++k) {
      series.x.push_back(k / 30.0);
      series.y.push_back(1e-4 * std::exp(-k * (s + 1) / 60.0));
    }
    plot.series.push_back(series);
  }
  add_plot(list, {{310, 5}, {style::kPage - 2, 195}}, plot);
  return list;
}

Scene3 heap() {
  Scene3 one;
  Random random(5);
  for (int k = 0; k < 60; ++k) {
    const double r = random.uniform(0.03, 0.09);
    one.balls.push_back({{random.uniform(), random.uniform(), r + 0.6 * random.uniform()},
                         r,
                         colour(ColourMap::viridis, random.uniform())});
  }
  for (int k = 0; k < 20; ++k) {
    one.tubes.push_back({{random.uniform(), random.uniform(), random.uniform()},
                         {random.uniform(), random.uniform(), random.uniform()},
                         0.01});
  }
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  add_edges(one, box);
  one.floor = Floor{};
  one.panes.push_back({{{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}}});
  one.cuts.push_back({{1, -1, 0}, 0.5});
  one.camera = camera_framing(box, {-0.6, 1, -0.5}, {0, 0, 1}, 1, 0.5);
  one.subframes = 3;
  return one;
}

}  // namespace lagrain::test
