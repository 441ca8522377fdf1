// Figure 6 of the paper: packings of equal spheres in the unit cube under gravity and a piston.
//
// Above: the packings after 2 s. Below: the density by the height of the piston while it presses
// (d), what friction does to it, for all the piston's height tells and within the packing alone
// (e), and what shaking the box does (f).

#include "packing.hpp"

#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>

#include <array>
#include <cmath>
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

/// Density by the piston and within, over friction.
Plot friction_plot(const std::vector<double>& friction, const std::vector<Packing>& packings) {
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

}  // namespace

FigureResult draw_figure6(const FigureOptions& options) {
  std::vector<PackingJob> jobs;
  for (const Row& row : kRows) {
    const Scene<3> scene = packing_scene(options, row.file);
    jobs.push_back({"$r$ = " + shortest(std::get<double>(scene.fills[0].radius)), scene});
  }
  const Scene<3> base = jobs[0].scene;
  const double shaking = options.quick ? 1 : 4;  // [s]
  jobs.push_back({"shaken", shaken(base, shaking)});
  std::vector<double> frictions;
  for (const double mu : kFrictions) {
    if (options.quick && mu != 0 && mu != base.law.friction && mu != kFrictions.back()) continue;
    frictions.push_back(mu);
    jobs.push_back({"friction " + shortest(mu), with_friction(base, mu)});
  }
  const std::size_t sweep_end = jobs.size();
  for (std::size_t k = 1; k < kRows.size(); ++k) {
    jobs.push_back({jobs[k].name + ", rough", with_friction(jobs[k].scene, kFrictions.back())});
  }
  const std::vector<Packing> packings =
      run_packings(jobs, options, options.out / "fig6_density.csv");
  const Packing& shook = packings[3];
  const std::vector<Packing> swept(packings.begin() + 4,
                                   packings.begin() + static_cast<std::ptrdiff_t>(sweep_end));

  const double gap = 12, third = (style::kPage - 2 * gap) / 3, plot_height = 130;
  DisplayList list{.width = style::kPage,
                   .height = 14 + third + 34 + plot_height + 4,
                   .title = "lagrain, figure 6"};
  const double top = list.height - 14 - third;
  FigureResult result;
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    const Packing& p = packings[k];
    const double x = static_cast<double>(k) * (third + gap);
    const std::string count = std::to_string(p.radius.size());
    add_packing(list, {x, top}, third, p, ColourBy::height, options.quick,
                "$n$ = " + count + ", $r$ = " + shortest(p.radius[0]) +
                    " m: $d$ = " + digits(p.final_density()));
    list.add(Label{.text = std::string("(") + "abc"[k] + ")",
                   .at = {x, list.height - 4},
                   .size = style::kTitle,
                   .along = Along::top});
    const double difference = p.final_density() - kRows[k].paper;
    const double rough = (k == 0 ? swept.back() : packings[sweep_end + k - 1]).final_density();
    result.comparisons.push_back(
        {"density of n = " + std::to_string(kRows[k].count) + ", r = " + kRows[k].radius +
             (options.quick ? " (quick: an eighth as many, twice as large)" : ""),
         shortest(kRows[k].paper),
         digits(p.final_density()) + " by the piston (" + (difference < 0 ? "" : "+") +
             rounded(difference, 2) + "), " + bulk_text(p) + ": the walls cost " +
             digits(p.bulk - p.final_density()) + ", randomness " +
             digits(kClosestPacking - p.bulk) + " of the closest packing's 0.7405. With friction " +
             shortest(kFrictions.back()) + " in place of " + shortest(base.law.friction) +
             " it is " + digits(rough) + " (" + (rough < kRows[k].paper ? "" : "+") +
             rounded(rough - kRows[k].paper, 2) + ")" +
             (std::abs(rough - kRows[k].paper) < 0.01
                  ? ": a rougher material accounts for the difference"
                  : "")});
  }

  const auto place = [&](std::size_t k, const char* letter) {
    const double x = static_cast<double>(k) * (third + gap);
    list.add(Label{.text = letter, .at = {x, plot_height + 6}, .size = style::kTitle});
    return Box{{x, 0}, {x + third, plot_height}};
  };
  Plot pressing{.x = {.label = "time [s]", .low = 0.5, .high = 2},
                .y = {.label = "density", .low = 0.2, .high = 0.6},
                .series = {},
                .legend = Corner::bottom_right};
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    pressing.series.push_back(density_series(packings[k], static_cast<int>(k), 0.5));
  }
  add_plot(list, place(0, "(d)"), pressing);
  add_plot(list, place(1, "(e)"), friction_plot(frictions, swept));
  Series shaken_series = density_series(shook, 0, 1.8);
  shaken_series.name = "";
  shaken_series.width = 0.6;
  add_plot(list, place(2, "(f)"),
           {.x = {.label = "time [s]"},
            .y = {.label = "density, shaken from 2 s"},
            .series = {shaken_series}});
  paint_png(list, options.out / "fig6.png", 300);
  paint_pdf(list, options.out / "fig6.pdf");
  write_file(options.out / "fig6_packing.csv", packing_csv(packings[2]));

  std::string table = "friction[-],density_by_piston[-],density_within[-],coordination[-]\n";
  for (std::size_t k = 0; k < swept.size(); ++k) {
    table += shortest(frictions[k]) + "," + shortest(swept[k].final_density()) + "," +
             shortest(swept[k].bulk) + "," + shortest(swept[k].statistics.coordination) + "\n";
  }
  write_file(options.out / "fig6_friction.csv", table);

  result.caption =
      "(a) to (c) Spheres dropped at random into the unit cube, pressed by a piston of a tenth of "
      "their weight, after 2 s; colours are heights. (d) Density by the piston's height. (e) The "
      "packing of (a) with other frictions (the paper does not state its own; ours is " +
      shortest(base.law.friction) +
      "): by the piston's height, which counts the gaps at the walls, and within the Laguerre "
      "cells that keep away from them. (f) The packing of (a) shaken along (1, 0, 1) with " +
      rounded(1000 * kShakeAmplitude, 2) + " mm and " + rounded(kShakeFrequency, 2) +
      " Hz along each axis: the dips are the piston, thrown up.";
  result.facts = packing_facts(packings);
  result.facts.push_back(
      {"frictionless to rough, by the piston",
       digits(swept.front().final_density()) + " to " + digits(swept.back().final_density())});
  result.facts.push_back({"shaken for " + rounded(shaking, 2) + " s",
                          digits(packings[0].final_density()) + " becomes " +
                              digits(shook.final_density()) + " by the piston, " +
                              digits(packings[0].bulk) + " becomes " + digits(shook.bulk) +
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
