// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 6 of the paper: packings of equal spheres in the unit cube under gravity and a piston.
//
// Above: the packings after 2 s. Below: the density by the height of the piston while it presses
// (d), what friction does to it, for all the piston's height tells and within the packing alone
// (e), and what shaking the box does (f).

#include "packing.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace lagrain::figures {

namespace {

struct Row {
  const char* file;
  int count;
  const char* radius;
  double paper;  // density
};
constexpr std::array<Row, 3> kRows{{{"packing_1484.toml", 1484, "0.04", 0.52},
                                    {"packing_3498.toml", 3498, "0.03", 0.53},
                                    {"packing_6944.toml", 6944, "0.02", 0.54}}};
constexpr std::array<double, 6> kFrictions{0, 0.1, 0.2, 0.3, 0.5, 0.8};

/// The packings of the figure.
struct Figure6 {
  double own_friction = 0;        ///< of the scene files [-]
  double shaking = 0;             ///< how long the packing of (f) is shaken [s]
  std::vector<double> frictions;  ///< of (e) [-]
  /// Those of kRows, the shaken one, one for each friction, and all but the first of kRows rough.
  std::vector<Packing> all;

  const Packing& shaken() const { return all[kRows.size()]; }
  std::span<const Packing> swept() const {
    return std::span(all).subspan(kRows.size() + 1, frictions.size());
  }
  /// The k-th of kRows with the largest friction.
  const Packing& rough(std::size_t k) const {
    return k == 0 ? swept().back() : all[kRows.size() + frictions.size() + k];
  }
};

Figure6 make_figure6(const FigureOptions& options) {
  Figure6 figure;
  std::vector<PackingJob> jobs;
  for (const Row& row : kRows) {
    const Scene<3> scene = packing_scene(options, row.file);
    jobs.push_back({"$r$ = " + shortest(std::get<double>(scene.fills[0].radius)), scene});
  }
  const Scene<3> base = jobs[0].scene;
  figure.own_friction = base.law.friction;
  figure.shaking = options.quick ? 1 : 4;
  jobs.push_back({"shaken", shaken(base, figure.shaking)});
  for (const double mu : kFrictions) {
    if (options.quick && mu != 0 && mu != base.law.friction && mu != kFrictions.back()) continue;
    figure.frictions.push_back(mu);
    jobs.push_back({"friction " + shortest(mu), with_friction(base, mu)});
  }
  for (std::size_t k = 1; k < kRows.size(); ++k) {
    jobs.push_back({jobs[k].name + ", rough", with_friction(jobs[k].scene, kFrictions.back())});
  }
  figure.all = run_packings(jobs, options, options.out / "fig6_density.csv");
  return figure;
}

/// Density by the piston while it presses.
Plot pressing_plot(const Figure6& figure) {
  Plot plot{.x = {.label = "time [s]", .low = 0.5, .high = 2},
            .y = {.label = "density", .low = 0.2, .high = 0.6},
            .series = {},
            .legend = Corner::bottom_right};
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    plot.series.push_back(density_series(figure.all[k], static_cast<int>(k), 0.5));
  }
  return plot;
}

/// Density by the piston and within, over friction.
Plot friction_plot(const std::vector<double>& friction, std::span<const Packing> packings) {
  Series piston = series_style(0), bulk = series_style(1), paper = series_style(2);
  piston.name = "by the piston";
  piston.marker = Marker::disc;
  bulk.name = "away from the walls";
  bulk.marker = Marker::square;
  paper.name = "the paper";
  paper.x = {friction.front(), friction.back()};
  paper.y = {kRows[0].paper, kRows[0].paper};
  for (std::size_t k = 0; k < friction.size(); ++k) {
    for (Series* s : {&piston, &bulk}) s->x.push_back(friction[k]);
    piston.y.push_back(packings[k].final_density());
    bulk.y.push_back(packings[k].bulk);
  }
  return {.x = {.label = "friction $\\mu$", .low = 0},
          .y = {.label = "density", .low = 0.45, .high = 0.75},
          .series = {piston, bulk, paper}};
}

Plot shaking_plot(const Figure6& figure) {
  Series series = density_series(figure.shaken(), 0, 1.8);
  series.name = "";
  series.width = 0.6;
  return {
      .x = {.label = "time [s]"}, .y = {.label = "density, shaken from 2 s"}, .series = {series}};
}

DisplayList picture_of(const Figure6& figure, bool quick) {
  const double gap = 12, third = (style::kPage - 2 * gap) / 3, plot_height = 130;
  DisplayList list{.width = style::kPage,
                   .height = 14 + third + 34 + plot_height + 4,
                   .title = "lagrain, figure 6"};
  const double top = list.height - 14 - third;
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    const Packing& p = figure.all[k];
    const double x = static_cast<double>(k) * (third + gap);
    add_packing(list, {x, top}, third, p, ColourBy::height, quick,
                "$n$ = " + std::to_string(p.radius.size()) + ", $r$ = " + shortest(p.radius[0]) +
                    " m: $d$ = " + digits(p.final_density()));
    add_title(list, {x, list.height - 4}, std::string("(") + "abc"[k] + ")");
  }
  const std::array<Plot, 3> plots{
      pressing_plot(figure), friction_plot(figure.frictions, figure.swept()), shaking_plot(figure)};
  for (std::size_t k = 0; k < plots.size(); ++k) {
    const double x = static_cast<double>(k) * (third + gap);
    list.add(Label{.text = std::string("(") + "def"[k] + ")",
                   .at = {x, plot_height + 6},
                   .size = style::kTitle});
    add_plot(list, {{x, 0}, {x + third, plot_height}}, plots[k]);
  }
  return list;
}

Comparison comparison_of(const Figure6& figure, std::size_t k, bool quick) {
  const Row& row = kRows[k];
  const Packing& p = figure.all[k];
  const double rough = figure.rough(k).final_density();
  return {
      "density of n = " + std::to_string(row.count) + ", r = " + row.radius + quick_text(quick),
      shortest(row.paper),
      digits(p.final_density()) + " by the piston (" +
          difference_text(p.final_density(), row.paper) + "), " + bulk_text(p) +
          ": the walls cost " + digits(p.bulk - p.final_density()) + ", randomness " +
          digits(kClosestPacking - p.bulk) + " of the closest packing's 0.7405. With friction " +
          shortest(kFrictions.back()) + " in place of " + shortest(figure.own_friction) +
          " it is " + digits(rough) + " (" + difference_text(rough, row.paper) + ")" +
          (std::abs(rough - row.paper) < 0.01 ? ": a rougher material accounts for the difference"
                                              : "")};
}

void write_friction_table(const Figure6& figure, const std::filesystem::path& file) {
  Csv table("friction[-],density_by_piston[-],density_within[-],coordination[-]");
  const std::span<const Packing> swept = figure.swept();
  for (std::size_t k = 0; k < swept.size(); ++k) {
    table.row(figure.frictions[k], swept[k].final_density(), swept[k].bulk,
              swept[k].statistics.coordination);
  }
  write_file(file, table.text());
}

std::string caption_of(const Figure6& figure) {
  return "(a) to (c) Spheres dropped at random into the unit cube, pressed by a piston of a tenth "
         "of their weight, after 2 s; colours are heights. (d) Density by the piston's height. (e) "
         "The packing of (a) with other frictions (the paper does not state its own; ours is " +
         shortest(figure.own_friction) +
         "): by the piston's height, which counts the gaps at the walls, and within the Laguerre "
         "cells that keep away from them. (f) The packing of (a) shaken along (1, 0, 1) with " +
         rounded(1000 * kShakeAmplitude, 2) + " mm and " + rounded(kShakeFrequency, 2) +
         " Hz along each axis: the dips are the piston, thrown up.";
}

}  // namespace

FigureResult draw_figure6(const FigureOptions& options) {
  const Figure6 figure = make_figure6(options);
  const DisplayList picture = picture_of(figure, options.quick);
  paint_png(picture, options.out / "fig6.png", 300);
  paint_pdf(picture, options.out / "fig6.pdf");
  write_file(options.out / "fig6_packing.csv", packing_csv(figure.all[2]));
  write_friction_table(figure, options.out / "fig6_friction.csv");

  FigureResult result;
  result.caption = caption_of(figure);
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    result.comparisons.push_back(comparison_of(figure, k, options.quick));
  }
  result.facts = packing_facts(figure.all);
  const Packing &smooth = figure.swept().front(), &rough = figure.swept().back();
  result.facts.push_back({"frictionless to rough, by the piston",
                          digits(smooth.final_density()) + " to " + digits(rough.final_density())});
  const Packing &still = figure.all[0], &shook = figure.shaken();
  result.facts.push_back({"shaken for " + rounded(figure.shaking, 2) + " s",
                          digits(still.final_density()) + " becomes " +
                              digits(shook.final_density()) + " by the piston, " +
                              digits(still.bulk) + " becomes " + digits(shook.bulk) +
                              " away from the walls"});
  result.pictures = {"fig6.png", "fig6.pdf"};
  result.downloads = {"fig6_density.csv",
                      "fig6_friction.csv",
                      "fig6_packing.csv",
                      options.scenes / kRows[0].file,
                      options.scenes / kRows[1].file,
                      options.scenes / kRows[2].file};
  return result;
}

}  // namespace lagrain::figures
