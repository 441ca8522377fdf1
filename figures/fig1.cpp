// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 1 of the paper: 24 discs of different sizes and the edges of their regular triangulation,
// weight r^2, along which contacts are looked for. Here the discs have come to rest in an open box,
// and the edges that carry a contact are marked.
//
// Writes fig1.png, fig1.pdf, fig1_discs.csv and fig1_edges.csv.

#include "geometry_drawing.hpp"
#include "geometry_figures.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/run.hpp>

#include <algorithm>

namespace lagrain::figures {
namespace {

constexpr double kLegend = 17;  // height below the box [pt]
constexpr double kMargin = 3;   // around everything [pt]

double height_of(const Figure1& figure) {
  const Discs& discs = figure.scene.discs;
  return (discs.centre.row(1).transpose() + discs.radius).maxCoeff();
}

}  // namespace

Figure1 make_figure1() {
  Figure1 figure{.scene = settle(24, 0.004, 0.012, 0.09, 4), .contacts = {}};
  figure.contacts = find_contacts(figure.scene.discs);
  figure.hull = hull_edges(figure.contacts.triangulation);
  return figure;
}

Panel figure1_panel(const Figure1& figure) {
  const double width = style::kColumn - 2 * kMargin;
  const double top = height_of(figure) + 0.001;
  const double height = width * top / figure.scene.width;
  return {{{kMargin, kMargin + kLegend}, {kMargin + width, kMargin + kLegend + height}},
          {{0, 0}, {figure.scene.width, top}}};
}

DisplayList picture_of(const Figure1& figure) {
  const Panel panel = figure1_panel(figure);
  const Box& box = panel.box();
  const View view{panel, figure.scene.discs};
  DisplayList list{.width = style::kColumn,
                   .height = box.high[1] + kMargin,
                   .title = "Discs and the edges of their regular triangulation"};

  add_fills(list, view, style::kGrain);
  add_outlines(list, view, style::kGrainLine);
  add_triangulation(list, view, figure.contacts);
  const double out = 0.5 * style::kWallLine.width;
  list.add(Polyline{
      {Vec<2>(box.low[0] - out, box.high[1]), box.low - Vec<2>(out, out),
       Vec<2>(box.high[0] + out, box.low[1] - out), Vec<2>(box.high[0] + out, box.high[1])},
      style::kWallLine});

  add_legend_row(
      list, {box.low[0], kMargin + 4},
      {{LegendEntry::Sample::line, kContactLine,
        std::to_string(figure.contacts.found.size()) + " edges with a contact"},
       {LegendEntry::Sample::line, kEdgeLine,
        std::to_string(figure.contacts.edges.size() - figure.contacts.found.size()) + " without"}});
  add_scale_bar(list, {box.high[0] - panel.length(0.02) - 1, kMargin + 3}, panel, 0.02, "2 cm");
  return list;
}

FigureResult draw_figure1(const FigureOptions& options) {
  const Figure1 figure = make_figure1();
  const Settled& scene = figure.scene;
  write_picture(picture_of(figure), options.out, "fig1");

  std::vector<std::vector<double>> discs, edges;
  for (int i = 0; i < scene.discs.size(); ++i) {
    discs.push_back({static_cast<double>(i), scene.discs.at(i)[0], scene.discs.at(i)[1],
                     scene.discs.radius[i]});
  }
  for (const Pair& edge : figure.contacts.edges) {
    edges.push_back({static_cast<double>(edge.i), static_cast<double>(edge.j),
                     holds(figure.contacts.found, edge) ? 1.0 : 0.0, scene.discs.overlap(edge)});
  }
  write_csv(options.out / "fig1_discs.csv", "disc[-],x[m],y[m],r[m]", discs);
  write_csv(options.out / "fig1_edges.csv", "i[-],j[-],contact[-],overlap[m]", edges);

  const auto n = static_cast<std::size_t>(scene.discs.size());
  const double per_contact = static_cast<double>(figure.contacts.edges.size()) /
                             static_cast<double>(figure.contacts.found.size());
  FigureResult result;
  result.caption =
      std::to_string(n) +
      " discs at rest in an open box and the edges of their regular triangulation, weight r^2. "
      "Thick: the edges that carry a contact; there is no contact without an edge. The discs fell "
      "under gravity, with friction, for " +
      rounded(scene.time, 4) + " s.";
  result.comparisons = {
      {"discs", "24", std::to_string(n)},
      {"edges", "not given; linear in n: 3 n - 3 - hull",
       std::to_string(figure.contacts.edges.size()) + " = 3 x " + std::to_string(n) + " - 3 - " +
           std::to_string(figure.hull)},
      {"contacts without an edge", "none", std::to_string(figure.contacts.missed.size())}};
  result.facts = {
      {"edges of T", std::to_string(figure.contacts.edges.size())},
      {"edges on the convex hull", std::to_string(figure.hull)},
      {"contacts between discs", std::to_string(figure.contacts.found.size())},
      {"edges per contact", rounded(per_contact, 3)},
      {"radii", rounded(1e3 * scene.discs.radius.minCoeff(), 3) + " to " +
                    rounded(1e3 * scene.discs.radius.maxCoeff(), 3) + " mm"},
      {"seed", std::to_string(scene.seed)},
      {"steps", std::to_string(scene.steps) + " of " + rounded(1e6 * scene.time_step, 3) + " us"},
      {"stiffness, friction, restitution", rounded(scene.stiffness, 4) + " N/m, " +
                                               rounded(scene.friction, 4) + ", " +
                                               rounded(scene.restitution, 4)},
      {"overlap, mean and largest", rounded(100 * scene.mean_overlap, 2) + " % and " +
                                        rounded(100 * scene.largest_overlap, 2) +
                                        " % of the smaller radius"},
      {"kinetic energy at the end", rounded(scene.kinetic_energy, 2) + " J"},
      {"contacts audited, missed",
       std::to_string(scene.audited) + ", " + std::to_string(scene.missed)}};
  result.pictures = {"fig1.png"};
  result.downloads = {"fig1.pdf", "fig1_discs.csv", "fig1_edges.csv"};
  return result;
}

}  // namespace lagrain::figures
