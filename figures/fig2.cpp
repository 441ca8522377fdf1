// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 2 of the paper: discs S1 ... S4, their Laguerre cells L1 ... L4, the dual edges, and the
// power P1(x) as the square of the tangent from x to S1. Beside it the misprint of Theorem 2.1,
// "weights are the square roots of the radii": four discs for which the triangulation with weight
// r^2 holds the one contact, and that with weight sqrt(r) does not. (The radius is the square root
// of the weight.)
//
// Writes fig2.png, fig2.pdf, fig2_discs.csv and fig2_edges.csv.

#include "geometry_drawing.hpp"
#include "geometry_figures.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/run.hpp>
#include <lagrain/text.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lagrain::figures {
namespace {

constexpr double kMargin = 3;    // around everything [pt]
constexpr double kHeading = 15;  // above a panel [pt]
constexpr double kLegend = 20;   // below all panels [pt]
constexpr double kBetween = 13;  // panels [pt]
constexpr double kZoom = 58;     // magnified windows [pt]

void add_symbol(DisplayList& list, const std::string& text, const Vec<2>& at) {
  list.add(Label{.text = text,
                 .at = at,
                 .size = style::kTitle,
                 .colour = style::kInk,
                 .across = Across::centre,
                 .along = Along::middle});
}

void add_cells_and_power(DisplayList& list, const Figure2& figure, const Box& area) {
  const double height = area.size()[1] / area.size()[0];
  const Panel panel(area, {{0, 0}, {1, height}});
  const View view{panel, figure.cells.discs};
  add_cells_and_discs(list, view, figure.cells.triangulation);
  add_edges(list, view, figure.cells.edges, kEdgeLine);

  // The tangent, its right angle with the radius, and the power.
  const Vec<2> x = view.point(figure.x), touch = view.point(figure.tangent_point);
  const Vec<2> centre = view.centre(0);
  const Stroke line{style::kContact, style::kThick};
  list.add(Polyline{{centre, touch}, {style::kInk, style::kMedium}, {2, 2.4}});
  const Vec<2> in = 5 * (centre - touch).normalized(), along = 5 * (x - touch).normalized();
  list.add(Polyline{{touch + in, touch + in + along, touch + along}, style::kAxisLine});
  list.add(Segment{touch, x, line});
  list.add(Disc{.centre = x, .radius = 2, .fill = style::kContact});
  list.add(Disc{.centre = touch, .radius = 1.6, .fill = style::kContact});
  const Vec<2> below = -6.5 * in.normalized();
  list.add(Label{.text = "$P_1(x) = t^2$",
                 .at = 0.5 * (x + touch) + below,
                 .size = style::kText,
                 .colour = style::kInk,
                 .across = Across::centre,
                 .along = Along::middle,
                 .angle = std::atan2(along[1], along[0])});
  add_symbol(list, "$x$", x + Vec<2>(7, 0));
  add_sites(list, view, 1.6);

  // The symbols stand in these directions from the centre of S_i [degrees], and here in L_i.
  constexpr std::array<double, 4> kDirection{170, -50, 45, 130};
  const std::array<Vec<2>, 4> in_cell{Vec<2>(0.07, 0.1), Vec<2>(0.93, 0.1), Vec<2>(0.93, 0.87),
                                      Vec<2>(0.07, 0.87)};
  for (int i = 0; i < 4; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double angle = kDirection[k] * std::numbers::pi / 180;
    const std::string name = std::to_string(i + 1);
    add_symbol(list, "$S_" + name + "$",
               view.centre(i) + 0.58 * view.radius(i) * Vec<2>(std::cos(angle), std::sin(angle)));
    add_symbol(list, "$L_" + name + "$", panel.point({in_cell[k][0], in_cell[k][1] * height}));
  }
  add_heading(list, panel.box(), "(a) discs, cells, edges and the power of $x$");
}

/// The misprint's discs, the edges of T for some weights, and the contact through a magnifier.
void add_misprint(DisplayList& list, const Found& found, const Box& area, const std::string& text) {
  const Panel panel({area.low, {area.high[0] - kZoom - 12, area.high[1]}},
                    {{-20.6, -10.6}, {20.6, 10.6}});
  const View view{panel, found.discs};
  add_cells_and_discs(list, view, found.triangulation);
  add_triangulation(list, view, found);

  add_numbers(list, view, {Vec<2>(-8, 0), Vec<2>(8, 0), Vec<2>(0, 10), Vec<2>(0, -10)});
  add_heading(list, panel.box(), text);

  const double bottom = panel.box().centre()[1] - 0.5 * kZoom;
  const Box window{{area.high[0] - kZoom, bottom}, {area.high[0], bottom + kZoom}};
  add_zoom(list, found, {.page = window, .middle = {0, 0}, .width = 0.1, .label = "0.1 wide"});
  add_magnifier(list, panel.point({0, 0}), 1.5, window);
}

void append_edges(std::vector<std::vector<double>>& rows, double panel, const Found& found) {
  for (const Pair& edge : found.edges) {
    rows.push_back({panel, static_cast<double>(edge.i), static_cast<double>(edge.j),
                    holds(found.found, edge) ? 1.0 : 0.0, found.discs.overlap(edge)});
  }
}

}  // namespace

Vec<2> tangent_point(const Vec<2>& centre, double radius, const Vec<2>& x) {
  const Vec<2> out = x - centre;
  const double squared = out.squaredNorm();
  // In the frame (out, its left normal): radius^2 / |out| along, the rest across. Seen from x the
  // left normal of `out` points right.
  const double along = radius * radius / squared;
  const double across = radius * std::sqrt(squared - radius * radius) / squared;
  return centre + along * out - across * Vec<2>(-out[1], out[0]);
}

Figure2 make_figure2() {
  Figure2 figure;
  figure.cells = find_contacts(
      make_discs({{0.31, 0.33, 0.16}, {0.75, 0.34, 0.12}, {0.66, 0.62, 0.15}, {0.24, 0.64, 0.10}}));
  figure.x = {0.47, 0.12};
  figure.tangent_point =
      tangent_point(figure.cells.discs.at(0), figure.cells.discs.radius[0], figure.x);
  const Discs discs = make_discs({{-9.99, 0, 10}, {9.99, 0, 10}, {0, 4.7, 1}, {0, -4.7, 1}});
  figure.squares = find_contacts(discs);
  figure.roots = find_contacts(discs, discs.radius.array().sqrt());
  return figure;
}

DisplayList picture_of(const Figure2& figure) {
  const double left = style::kColumn - kMargin;
  const double right = style::kPage - 2 * kMargin - left - kBetween;
  const double small = (right - kZoom - 12) * 21.2 / 41.2;
  const double bottom = kMargin + kLegend;
  const double top = bottom + 2 * small + kHeading + 6;
  DisplayList list{.width = style::kPage,
                   .height = top + kHeading,
                   .title = "Laguerre cells, power, and the weight that finds contacts"};
  const double x = kMargin + left + kBetween;
  add_cells_and_power(list, figure, {{kMargin, bottom}, {kMargin + left, top}});
  add_misprint(list, figure.squares, {{x, top - small}, {x + right, top}},
               "(b) weight $r^2$: edge 0\xE2\x80\x93"
               "1 finds the contact");
  add_misprint(list, figure.roots, {{x, bottom}, {x + right, bottom + small}},
               "(c) weight $r^{1/2}$: edge 2\xE2\x80\x93"
               "3, the contact is missed");
  add_detection_legend(list, {kMargin, kMargin + 5});
  return list;
}

FigureResult draw_figure2(const FigureOptions& options) {
  const Figure2 figure = make_figure2();
  write_picture(picture_of(figure), options.out, "fig2");

  std::vector<std::vector<double>> discs, edges;
  double panel = 0;
  for (const Found* found : {&figure.cells, &figure.squares, &figure.roots}) {
    for (int i = 0; i < found->discs.size(); ++i) {
      discs.push_back({panel, static_cast<double>(i), found->discs.at(i)[0], found->discs.at(i)[1],
                       found->discs.radius[i], found->triangulation.weight(i)});
    }
    append_edges(edges, panel, *found);
    ++panel;
  }
  write_csv(options.out / "fig2_discs.csv", "panel[-],disc[-],x[m],y[m],r[m],weight[m^2]", discs);
  write_csv(options.out / "fig2_edges.csv", "panel[-],i[-],j[-],contact[-],overlap[m]", edges);

  const double power = figure.cells.discs.power(0, figure.x);
  const double tangent = (figure.x - figure.tangent_point).squaredNorm();
  const auto edge = [](const Found& found) {
    return std::string(holds(found.edges, {0, 1}) ? "0-1" : "2-3") + ", " +
           std::to_string(found.missed.size()) + " contacts missed";
  };
  FigureResult result;
  result.caption =
      "(a) Discs, their Laguerre cells and the edges of the regular triangulation, which joins "
      "discs whose cells share a border. The power of x to S1 is the square of the tangent's "
      "length. The weight of a disc is the square of its radius. (b) Discs 0 and 1 (r = 10) "
      "overlap by 0.02; discs 2 and 3 have r = 1. With weight r^2 the edge 0-1 is there, and the "
      "contact is found. (c) The same discs with weight r^(1/2), as Theorem 2.1 of the paper has "
      "it by a slip: the edge is 2-3, and the contact is missed. Squares: the middle, 0.1 wide.";
  result.comparisons = {
      {"weight in Theorem 2.1", "square root of r (its proof: r^2)", "r^2"},
      {"inner edge with weight r^2", "not given", edge(figure.squares)},
      {"inner edge with weight sqrt(r)", "not given", edge(figure.roots)},
      {"P1(x) against squared tangent", "equal", rounded(power, 6) + ", " + rounded(tangent, 6)}};
  result.facts = {{"overlap of discs 0 and 1", rounded(figure.squares.discs.overlap({0, 1}), 3)}};
  result.pictures = {"fig2.png"};
  result.downloads = {"fig2.pdf", "fig2_discs.csv", "fig2_edges.csv"};
  return result;
}

}  // namespace lagrain::figures
