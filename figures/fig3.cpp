// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 3 of the paper: Laguerre cells and the regular triangulation of overlapping discs. The
// overlaps are exaggerated, the detection still works. Beside it the case where it stops: four
// equal discs in a square, whose sides overlap by 2 - sqrt 2 = 0.5858 of the radius, just below and
// just above.
//
// Writes fig3.png, fig3.pdf, fig3_discs.csv and fig3_edges.csv.

#include "geometry_drawing.hpp"
#include "geometry_figures.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/random.hpp>
#include <lagrain/run.hpp>

#include <algorithm>
#include <cmath>

namespace lagrain::figures {
namespace {

constexpr double kMargin = 3;     // around everything [pt]
constexpr double kHeading = 15;   // above a panel [pt]
constexpr double kLegend = 20;    // below all panels [pt]
constexpr double kBetween = 13;   // panels [pt]
constexpr double kSquare = 92;    // side of a panel (b), (c) [pt]
constexpr double kWindow = 58;    // magnified windows [pt]
constexpr double kZoomed = 8e-4;  // what they show [m]

double overlap_share(const Discs& discs, Pair pair) {
  return discs.overlap(pair) / std::min(discs.radius[pair.i], discs.radius[pair.j]);
}

/// Overlap over the smaller radius, of the contact in which it is largest.
double deepest(const Found& found) {
  double largest = 0;
  for (const auto* pairs : {&found.found, &found.missed}) {
    for (const Pair& pair : *pairs) largest = std::max(largest, overlap_share(found.discs, pair));
  }
  return largest;
}

void add_square(DisplayList& list, const Found& found, const Vec<2>& low, const std::string& text) {
  const Panel panel({low, low + Vec<2>(kSquare, kSquare)}, {{-2.15, -2.15}, {2.15, 2.15}});
  const View view{panel, found.discs};
  add_cells_and_discs(list, view, found.triangulation);
  add_triangulation(list, view, found);
  add_numbers(list, view, {Vec<2>(-8, 0), Vec<2>(8, 0), Vec<2>(0, 8), Vec<2>(0, -8)});
  add_heading(list, panel.box(), text);

  const Vec<2> corner(low[0] + kSquare + 16, low[1] + 0.5 * (kSquare - kWindow));
  const Box window{corner, corner + Vec<2>(kWindow, kWindow)};
  add_zoom(list, found,
           {.page = window, .middle = {0, 0}, .width = kZoomed, .label = "0.0008 wide"});
  add_magnifier(list, panel.point({0, 0}), 1.5, window);

  const auto row = [&](double y, const std::string& left, const std::string& right) {
    for (const bool number : {false, true}) {
      list.add(Label{.text = number ? right : left,
                     .at = {window.high[0] + (number ? 60.0 : 9.0), y},
                     .size = style::kSmallText,
                     .colour = style::kInk,
                     .across = number ? Across::right : Across::left,
                     .along = Along::middle});
    }
  };
  const double y = window.centre()[1];
  row(y + 17, "overlap / $r$", "");
  row(y + 5, "sides", "$" + fixed(overlap_share(found.discs, {0, 2}), 5) + "$");
  row(y - 6,
      "0\xE2\x80\x93"
      "1",
      "$" + fixed(overlap_share(found.discs, {0, 1}), 5) + "$");
  row(y - 17,
      "2\xE2\x80\x93"
      "3",
      "$" + fixed(overlap_share(found.discs, {2, 3}), 5) + "$");
}

}  // namespace

Discs square_of_discs(double y) {
  return make_discs({{-0.9999, 0, 1}, {0.9999, 0, 1}, {0, y, 1}, {0, -y, 1}});
}

Figure3 make_figure3() {
  // Discs of random radii around a middle; each new one overlaps others by at most 0.45 of the
  // smaller radius, and takes the place nearest to the middle.
  Random random(3);
  std::vector<std::array<double, 3>> rows;
  while (rows.size() < 11) {
    const double r = random.uniform(0.07, 0.17);
    std::array<double, 3> best{0, 0, 0};
    double nearest = 1e9;
    for (int k = 0; k < 4000; ++k) {
      const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.6, 0.6);
      const bool allowed = std::all_of(rows.begin(), rows.end(), [&](const auto& other) {
        const double distance = std::hypot(x - other[0], y - other[1]);
        return r + other[2] - distance <= 0.45 * std::min(r, other[2]);
      });
      if (allowed && std::hypot(x, y) < nearest) {
        nearest = std::hypot(x, y);
        best = {x, y, r};
      }
    }
    rows.push_back(best);
  }
  return {find_contacts(make_discs(rows)), find_contacts(square_of_discs(1.00015)),
          find_contacts(square_of_discs(0.9998))};
}

DisplayList picture_of(const Figure3& figure) {
  const double left = style::kColumn - kMargin;
  const double bottom = kMargin + kLegend;
  const double top = bottom + 2 * kSquare + kHeading + 6;
  DisplayList list{.width = style::kPage,
                   .height = top + kHeading,
                   .title = "Overlapping discs: where the detection works and where it stops"};

  const Discs& discs = figure.overlapping.discs;
  const Vec<2> low = discs.centre.rowwise().minCoeff();
  const Vec<2> high = discs.centre.rowwise().maxCoeff();
  const double around = 1.25 * discs.radius.maxCoeff();
  const Panel whole({{kMargin, bottom}, {kMargin + left, top}},
                    {low - Vec<2>::Constant(around), high + Vec<2>::Constant(around)});
  // The whole area is the window, so that panels line up.
  const Vec<2> half = 0.5 * Vec<2>(left, top - bottom) / whole.scale();
  const Vec<2> middle = 0.5 * (low + high);
  const Panel panel({{kMargin, bottom}, {kMargin + left, top}}, {middle - half, middle + half});
  const View view{panel, discs};
  add_cells_and_discs(list, view, figure.overlapping.triangulation);
  add_triangulation(list, view, figure.overlapping);
  add_heading(
      list, panel.box(),
      "(a) overlaps up to " + rounded(deepest(figure.overlapping), 2) + " of the smaller radius");

  const double x = kMargin + left + kBetween;
  add_square(list, figure.below, {x, top - kSquare}, "(b) just below 0.5858: found");
  add_square(list, figure.above, {x, bottom},
             "(c) just above: contact 0\xE2\x80\x93"
             "1 is missed");
  add_detection_legend(list, {kMargin, kMargin + 5});
  return list;
}

FigureResult draw_figure3(const FigureOptions& options) {
  const Figure3 figure = make_figure3();
  write_picture(picture_of(figure), options.out, "fig3");

  std::vector<std::vector<double>> discs, edges;
  double panel = 0;
  for (const Found* found : {&figure.overlapping, &figure.below, &figure.above}) {
    for (int i = 0; i < found->discs.size(); ++i) {
      discs.push_back({panel, static_cast<double>(i), found->discs.at(i)[0], found->discs.at(i)[1],
                       found->discs.radius[i]});
    }
    for (const Pair& edge : found->edges) {
      edges.push_back({panel, static_cast<double>(edge.i), static_cast<double>(edge.j), 1.0,
                       holds(found->found, edge) ? 1.0 : 0.0, found->discs.overlap(edge)});
    }
    for (const Pair& pair : found->missed) {
      edges.push_back({panel, static_cast<double>(pair.i), static_cast<double>(pair.j), 0.0, 1.0,
                       found->discs.overlap(pair)});
    }
    ++panel;
  }
  write_csv(options.out / "fig3_discs.csv", "panel[-],disc[-],x[m],y[m],r[m]", discs);
  write_csv(options.out / "fig3_edges.csv", "panel[-],i[-],j[-],edge[-],contact[-],overlap[m]",
            edges);

  const auto found = [](const Found& f) { return holds(f.found, {0, 1}) ? "found" : "missed"; };
  FigureResult result;
  result.caption =
      "(a) Overlapping discs, cells and regular triangulation, weight r^2: every contact is an "
      "edge. (b, c) Four equal discs, r = 1, in a square: the detection is proved up to overlaps "
      "of 2 - sqrt 2 = 0.5858 of the smaller radius. (b) Sides overlap by " +
      fixed(overlap_share(figure.below.discs, {0, 2}), 5) + ": contact 0-1 is found. (c) By " +
      fixed(overlap_share(figure.above.discs, {0, 2}), 5) +
      ": 0-1 and 2-3 both touch, but only one of them can be an edge, and 0-1 is missed. Squares: "
      "the middle, " +
      rounded(kZoomed, 4) + " wide.";
  result.comparisons = {
      {"overlaps in practice", "about 1 % of the grains' size",
       "drawn here: up to " + rounded(100 * deepest(figure.overlapping), 2) +
           " % of the smaller radius"},
      {"contacts missed in (a)", "none", std::to_string(figure.overlapping.missed.size())},
      {"side overlap where it stops", "not given (slightly overlap)", "0.58579 (2 - sqrt 2)"}};
  result.facts = {
      {"(a) contacts, edges", std::to_string(figure.overlapping.found.size()) + ", " +
                                  std::to_string(figure.overlapping.edges.size())},
      {"(b) side overlap, contact 0-1",
       fixed(overlap_share(figure.below.discs, {0, 2}), 6) + ", " + found(figure.below)},
      {"(c) side overlap, contact 0-1",
       fixed(overlap_share(figure.above.discs, {0, 2}), 6) + ", " + found(figure.above)}};
  result.pictures = {"fig3.png"};
  result.downloads = {"fig3.pdf", "fig3_discs.csv", "fig3_edges.csv"};
  return result;
}

}  // namespace lagrain::figures
