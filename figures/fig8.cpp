// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 8 of the paper: medium and small grains leave space for a large one, seen from below.
//
// A piston presses the large grain to the floor while the six pictures are taken. The video shows
// the same.

#include "figure.hpp"
#include "geometry_drawing.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/run.hpp>
#include <lagrain/style.hpp>
#include <lagrain/video.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr std::array<double, 6> kTimes{1.00, 1.05, 1.10, 1.15, 1.20, 1.25};  // [s]
constexpr double kFilmStart = 0.95, kFilmEnd = 1.35, kFilmEvery = 0.005;     // [s]
constexpr double kFilmDpi = 108;

Colour tint(double radius, const Run<3>& run) {
  const double smallest = run.radii().minCoeff(), largest = run.radii().maxCoeff();
  return radius > 0.99 * largest    ? Colour{150, 60, 50, 255}
         : radius < 1.01 * smallest ? Colour{222, 203, 150, 255}
                                    : Colour{92, 128, 160, 255};
}

Scene3 seen_from_below(const Run<3>& run, const Columns<3>& x, int subframes) {
  Scene3 scene;
  for (int i = 0; i < run.count(); ++i) {
    scene.balls.push_back({x.col(i), run.radii()[i], tint(run.radii()[i], run)});
  }
  const double width = 2 * run.scene().grains[0].position.x();  // the large one is in the middle
  const Box3 box{Vec<3>::Zero(), {width, width, 0.6 * width}};
  add_edges(scene, box);
  scene.camera =
      camera_framing({box.low, {width, width, 0.01 * width}}, {0, 0, 1}, {0, 1, 0}, 1, 0.35, 0.03);
  scene.lights = over_the_shoulder(scene.camera);
  scene.subframes = subframes;
  return scene;
}

std::string label(double time) {
  // Frames lie half-way between two hundredths: rounded up whatever the last bit of the time is.
  return "$t$ = " + fixed(std::round(100 * time) / 100, 2) + " s";
}

/// Grains placed by hand come first, and the large one is the only one.
constexpr int kLarge = 0;

/// The run, and what was kept on its way.
struct Figure8 {
  std::filesystem::path file;
  std::unique_ptr<Run<3>> run;
  std::vector<Columns<3>> kept;  ///< places at kTimes [m]
  VideoReport film;

  /// How high the large grain is above the floor, at the end [m].
  double bottom() const { return run->positions()(2, kLarge) - run->radii()[kLarge]; }
};

Image film_frame(const Run<3>& run, bool quick) {
  DisplayList page{.width = 400, .height = 424};
  page.add(paint_scene3(
      seen_from_below(run, run.positions(), quick ? kPreviewSubframes : kVideoSubframes),
      Box{{0, 0}, {400, 400}}, kFilmDpi));
  page.add(Label{.text = label(run.time()), .at = {14, 406}, .size = 14});
  return paint_rgba(page, kFilmDpi, Quality::frame);
}

/// Runs the scene; writes the video and the height of the large grain.
Figure8 make_figure8(const FigureOptions& options) {
  Figure8 figure;
  figure.file = options.scenes / "around_a_large_grain.toml";
  figure.run = make_run(read_scene<3>(figure.file));
  const Run<3>& run = *figure.run;
  VideoWriter video(options.out / "fig8.mp4", 25);
  Csv track("time[s],large_grain_bottom[m]");
  double next_frame = kFilmStart;
  while (!run.finished()) {
    figure.run->step();
    if (options.stop()) {
      write_file(options.out / "fig8_large_grain.csv", track.text());
      throw Interrupted();
    }
    if (run.steps() % 100 == 0) {
      options.progress(run.time() / run.scene().duration, "around a large grain");
      track.row(run.time(), figure.bottom());
    }
    if (figure.kept.size() < kTimes.size() && run.time() >= kTimes[figure.kept.size()]) {
      figure.kept.push_back(run.positions());
    }
    if (run.time() >= next_frame && run.time() <= kFilmEnd) {
      next_frame += options.quick ? 4 * kFilmEvery : kFilmEvery;
      video.add(film_frame(run, options.quick));
    }
  }
  figure.film = video.finish();
  write_file(options.out / "fig8_large_grain.csv", track.text());
  return figure;
}

DisplayList picture_of(const Figure8& figure, bool quick) {
  const double gap = 8, third = (style::kPage - 2 * gap) / 3;
  DisplayList list{.width = style::kPage, .height = 2 * (third + 16), .title = "lagrain, figure 8"};
  for (std::size_t k = 0; k < figure.kept.size(); ++k) {
    const double x = static_cast<double>(k % 3) * (third + gap);
    const double y = list.height - static_cast<double>(k / 3 + 1) * (third + 16);
    list.add(paint_scene3(
        seen_from_below(*figure.run, figure.kept[k], quick ? kPreviewSubframes : kPrintSubframes),
        Box{{x, y}, {x + third, y + third}}));
    list.add(Label{.text = label(kTimes[k]),
                   .at = {x + third / 2, y + third + 4},
                   .size = style::kText,
                   .across = Across::centre});
  }
  return list;
}

/// How many of the others touch the floor under the middle of the large grain.
int under_large(const Run<3>& run, const Columns<3>& x) {
  int count = 0;
  for (int i = 1; i < run.count(); ++i) {
    const Vec<2> from_middle = (x.col(i) - x.col(kLarge)).head<2>();
    count += x(2, i) < 1.5 * run.radii()[i] && from_middle.norm() < run.radii()[kLarge] / 2;
  }
  return count;
}

}  // namespace

FigureResult draw_figure8(const FigureOptions& options) {
  const Figure8 figure = make_figure8(options);
  const Run<3>& run = *figure.run;
  write_file(options.out / "fig8_final.csv", frame_csv(run));
  const DisplayList picture = picture_of(figure, options.quick);
  paint_png(picture, options.out / "fig8.png", 300);
  paint_pdf(picture, options.out / "fig8.pdf");

  FigureResult result;
  result.caption =
      "One large, 6 medium and 173 small grains (radii 5 : 2 : 1) from below, through the floor: a "
      "piston presses the large grain down, and the others leave space for it.";
  result.comparisons = {
      {"grains", "one large among medium and small ones",
       std::to_string(run.count()) + ": 1, 6 and 173"},
      {"on the floor under the middle of the large grain", "they leave space for it",
       std::to_string(under_large(run, figure.kept.front())) + " at 1.00 s, " +
           std::to_string(under_large(run, figure.kept.back())) + " at 1.25 s"}};
  for (auto& [name, value] : facts(run)) result.facts.push_back({name, value});
  result.facts.push_back({"height of the large grain above the floor, at the end",
                          rounded(1000 * figure.bottom(), 2) + " mm"});
  result.pictures = {"fig8.png", "fig8.pdf", figure.film.path};
  result.downloads = {"fig8_large_grain.csv", "fig8_final.csv", figure.file};
  return result;
}

}  // namespace lagrain::figures
