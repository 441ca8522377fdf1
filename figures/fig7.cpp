// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 7 of the paper: packings of spheres of two radii, as figure 6, and what shaking does.

#include "packing.hpp"

#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lagrain::figures {

namespace {

struct Row {
  const char* file;
  const char* numbers;  // n1, r1; n2, r2
  double paper;         // density
};
constexpr std::array<Row, 2> kRows{{{"packing_207_227.toml", "207, 0.08; 227, 0.04", 0.57},
                                    {"packing_1484_1747.toml", "1484, 0.04; 1747, 0.02", 0.59}}};

/// Share of the smaller grains in the solid volume [-].
double small_share(const Packing& packing) {
  const double middle = packing.radius.mean();
  double small = 0, all = 0;
  for (const double r : packing.radius) {
    const double volume = std::pow(r, 3);
    all += volume;
    if (r < middle) small += volume;
  }
  return small / all;
}

/// The packings of the figure.
struct Figure7 {
  double shaking;            ///< how long packings are shaken [s]
  std::vector<Packing> all;  ///< for each of kRows: still, shaken, without friction

  const Packing& still(std::size_t k) const { return all[3 * k]; }
  const Packing& shook(std::size_t k) const { return all[3 * k + 1]; }
  const Packing& smooth(std::size_t k) const { return all[3 * k + 2]; }
};

Figure7 make_figure7(const FigureOptions& options) {
  const double shaking = options.quick ? 1 : 2;
  std::vector<PackingJob> jobs;
  for (const Row& row : kRows) {
    const Scene<3> scene = packing_scene(options, row.file);
    const std::string radius = shortest(std::get<double>(scene.fills[0].radius)) + ", " +
                               shortest(std::get<double>(scene.fills[1].radius));
    jobs.push_back({"$r$ = " + radius, scene});
    jobs.push_back({"$r$ = " + radius, shaken(scene, shaking)});
    jobs.push_back({"$r$ = " + radius + ", frictionless", with_friction(scene, 0)});
  }
  return {shaking, run_packings(jobs, options, options.out / "fig7_density.csv")};
}

/// Density by the piston while it presses.
Plot pressing_plot(const Figure7& figure) {
  Plot plot{.x = {.label = "time [s]", .low = 0.5, .high = 2},
            .y = {.label = "density"},
            .series = {},
            .legend = Corner::bottom_right};
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    plot.series.push_back(density_series(figure.still(k), static_cast<int>(k), 0.5));
  }
  return plot;
}

Plot shaking_plot(const Figure7& figure) {
  const std::vector<double>& fine = figure.shook(1).density;
  Plot plot{.x = {.label = "time [s]"},
            .y = {.label = "density, shaken from 2 s",
                  .high = 0.03 + *std::max_element(fine.begin(), fine.end())},
            .series = {},
            .legend = Corner::top_left};
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    plot.series.push_back(density_series(figure.shook(k), static_cast<int>(k), 1.8));
    plot.series.back().width = 0.6;
  }
  return plot;
}

DisplayList picture_of(const Figure7& figure, bool quick) {
  const double gap = 16, half = (style::kPage - gap) / 2, picture = 0.86 * half;
  const double plot_height = 140;
  DisplayList list{.width = style::kPage,
                   .height = 6 + picture + 34 + plot_height + 4,
                   .title = "lagrain, figure 7"};
  const double top = list.height - 6 - picture;
  const std::array<Plot, 2> plots{pressing_plot(figure), shaking_plot(figure)};
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    const Packing& still = figure.still(k);
    const double x = static_cast<double>(k) * (half + gap);
    const Eigen::Index large = (still.radius.array() > still.radius.mean()).count();
    add_packing(list, {x + 0.07 * half, top}, picture, still, ColourBy::radius, quick,
                "$n$ = " + std::to_string(large) + " + " +
                    std::to_string(still.radius.size() - large) + ", " + still.name +
                    " m: $d$ = " + digits(still.final_density()));
    add_title(list, {x, list.height - 4}, std::string("(") + "ab"[k] + ")");
  }
  for (std::size_t k = 0; k < plots.size(); ++k) {
    const double x = static_cast<double>(k) * (half + gap);
    list.add(Label{.text = std::string("(") + "cd"[k] + ")",
                   .at = {x, plot_height + 6},
                   .size = style::kTitle});
    add_plot(list, {{x, 0}, {x + half, plot_height}}, plots[k]);
  }
  return list;
}

Comparison comparison_of(const Figure7& figure, std::size_t k, bool quick) {
  const Row& row = kRows[k];
  const Packing &still = figure.still(k), &shook = figure.shook(k), &smooth = figure.smooth(k);
  const bool explained =
      still.final_density() < row.paper && row.paper < smooth.final_density() + 0.01;
  return {std::string("density of ") + row.numbers + quick_text(quick), shortest(row.paper),
          digits(still.final_density()) + " by the piston (" +
              difference_text(still.final_density(), row.paper) + "), " + bulk_text(still) +
              "; shaken for " + rounded(figure.shaking, 2) +
              " s: " + digits(shook.final_density()) + ", " + bulk_text(shook) +
              "; without friction: " + digits(smooth.final_density()) + ", " + bulk_text(smooth) +
              (explained ? ": a smoother material accounts for the difference" : "")};
}

/// The paper expects higher densities with smaller grains.
Comparison size_comparison(const Packing& coarse, const Packing& fine) {
  const bool by_piston = fine.final_density() > coarse.final_density();
  return {"densities are higher with smaller grains", "as expected",
          std::string(by_piston ? "confirmed" : "refuted") + " by the piston's height (" +
              digits(coarse.final_density()) + ", " + digits(fine.final_density()) + "); " +
              bulk_text(coarse) + ", " + bulk_text(fine) + "; small grains are " +
              rounded(100 * small_share(coarse), 2) + " % and " +
              rounded(100 * small_share(fine), 2) + " % of the volume"};
}

}  // namespace

FigureResult draw_figure7(const FigureOptions& options) {
  const Figure7 figure = make_figure7(options);
  const DisplayList picture = picture_of(figure, options.quick);
  paint_png(picture, options.out / "fig7.png", 300);
  paint_pdf(picture, options.out / "fig7.pdf");
  write_file(options.out / "fig7_packing.csv", packing_csv(figure.still(1)));

  FigureResult result;
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    result.comparisons.push_back(comparison_of(figure, k, options.quick));
  }
  result.comparisons.push_back(size_comparison(figure.still(0), figure.still(1)));
  result.caption =
      "(a), (b) Spheres of two radii dropped at random into the unit cube and pressed by a piston, "
      "after 2 s. (c) Density by the piston's height. (d) The same, shaken along (1, 0, 1) with " +
      rounded(1000 * kShakeAmplitude, 2) + " mm and " + rounded(kShakeFrequency, 2) +
      " Hz along each axis: the dips are the piston, thrown up.";
  result.facts = packing_facts(figure.all);
  result.pictures = {"fig7.png", "fig7.pdf"};
  result.downloads = {"fig7_density.csv", "fig7_packing.csv", options.scenes / kRows[0].file,
                      options.scenes / kRows[1].file};
  return result;
}

}  // namespace lagrain::figures
