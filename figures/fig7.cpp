// Figure 7 of the paper: packings of spheres of two radii, as figure 6, and what shaking does.

#include "packing.hpp"

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

}  // namespace

FigureResult draw_figure7(const FigureOptions& options) {
  const double shaking = options.quick ? 1 : 2;  // [s]
  std::vector<PackingJob> jobs;
  for (const Row& row : kRows) {
    const Scene<3> scene = packing_scene(options, row.file);
    const std::string radius = shortest(std::get<double>(scene.fills[0].radius)) + ", " +
                               shortest(std::get<double>(scene.fills[1].radius));
    jobs.push_back({"$r$ = " + radius, scene});
    jobs.push_back({"$r$ = " + radius, shaken(scene, shaking)});
    jobs.push_back({"$r$ = " + radius + ", frictionless", with_friction(scene, 0)});
  }
  const std::vector<Packing> packings =
      run_packings(jobs, options, options.out / "fig7_density.csv");

  const double gap = 16, half = (style::kPage - gap) / 2, picture = 0.86 * half;
  const double plot_height = 140;
  DisplayList list{.width = style::kPage,
                   .height = 6 + picture + 34 + plot_height + 4,
                   .title = "lagrain, figure 7"};
  const double top = list.height - 6 - picture;
  FigureResult result;
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    const Packing &still = packings[3 * k], &shook = packings[3 * k + 1],
                  &smooth = packings[3 * k + 2];
    const double x = static_cast<double>(k) * (half + gap);
    const Eigen::Index large = (still.radius.array() > still.radius.mean()).count();
    add_packing(list, {x + 0.07 * half, top}, picture, still, ColourBy::radius, options.quick,
                "$n$ = " + std::to_string(large) + " + " +
                    std::to_string(still.radius.size() - large) + ", " + still.name +
                    " m: $d$ = " + digits(still.final_density()));
    list.add(Label{.text = std::string("(") + "ab"[k] + ")",
                   .at = {x, list.height - 4},
                   .size = style::kTitle,
                   .along = Along::top});
    const double difference = still.final_density() - kRows[k].paper;
    const bool explained =
        still.final_density() < kRows[k].paper && kRows[k].paper < smooth.final_density() + 0.01;
    result.comparisons.push_back(
        {std::string("density of ") + kRows[k].numbers +
             (options.quick ? " (quick: an eighth as many, twice as large)" : ""),
         shortest(kRows[k].paper),
         digits(still.final_density()) + " by the piston (" + (difference < 0 ? "" : "+") +
             rounded(difference, 2) + "), " + bulk_text(still) + "; shaken for " +
             rounded(shaking, 2) + " s: " + digits(shook.final_density()) + ", " +
             bulk_text(shook) + "; without friction: " + digits(smooth.final_density()) + ", " +
             bulk_text(smooth) +
             (explained ? ": a smoother material accounts for the difference" : "")});
  }
  const Packing &coarse = packings[0], &fine = packings[3];
  const bool by_piston = fine.final_density() > coarse.final_density();
  result.comparisons.push_back(
      {"densities are higher with smaller grains", "as expected",
       std::string(by_piston ? "confirmed" : "refuted") + " by the piston's height (" +
           digits(coarse.final_density()) + ", " + digits(fine.final_density()) + "); " +
           bulk_text(coarse) + ", " + bulk_text(fine) + "; small grains are " +
           rounded(100 * small_share(coarse), 2) + " % and " + rounded(100 * small_share(fine), 2) +
           " % of the volume"});

  const auto place = [&](std::size_t k, const char* letter) {
    const double x = static_cast<double>(k) * (half + gap);
    list.add(Label{.text = letter, .at = {x, plot_height + 6}, .size = style::kTitle});
    return Box{{x, 0}, {x + half, plot_height}};
  };
  Plot pressing{.x = {.label = "time [s]", .low = 0.5, .high = 2},
                .y = {.label = "density"},
                .series = {},
                .legend = Corner::bottom_right};
  Plot shaking_plot{.x = {.label = "time [s]"},
                    .y = {.label = "density, shaken from 2 s",
                          .high = 0.03 + *std::max_element(packings[4].density.begin(),
                                                           packings[4].density.end())},
                    .series = {},
                    .legend = Corner::top_left};
  for (std::size_t k = 0; k < kRows.size(); ++k) {
    pressing.series.push_back(density_series(packings[3 * k], static_cast<int>(k), 0.5));
    shaking_plot.series.push_back(density_series(packings[3 * k + 1], static_cast<int>(k), 1.8));
    shaking_plot.series.back().width = 0.6;
  }
  add_plot(list, place(0, "(c)"), pressing);
  add_plot(list, place(1, "(d)"), shaking_plot);
  paint_png(list, options.out / "fig7.png", 300);
  paint_pdf(list, options.out / "fig7.pdf");
  write_file(options.out / "fig7_packing.csv", packing_csv(fine));

  result.caption =
      "(a), (b) Spheres of two radii dropped at random into the unit cube and pressed by a piston, "
      "after 2 s. (c) Density by the piston's height. (d) The same, shaken along (1, 0, 1) with " +
      rounded(1000 * kShakeAmplitude, 2) + " mm and " + rounded(kShakeFrequency, 2) +
      " Hz along each axis: the dips are the piston, thrown up.";
  result.facts = packing_facts(packings);
  result.pictures = {"fig7.png", "fig7.pdf"};
  result.downloads = {"fig7_density.csv", "fig7_packing.csv", options.scenes / kRows[0].file,
                      options.scenes / kRows[1].file};
  return result;
}

}  // namespace lagrain::figures
