// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 5 of the paper: rock fall on an embankment (left) and the pressure distribution (right).
//
// Left: the bed after it has absorbed the rock; colours are the horizontal layers just before the
// impact. Right: every edge of the triangulation that carries a contact, drawn with a thickness
// proportional to its force, walls likewise, at the instant of the largest force on the slab.
// Below: a strip in time, the force on the slab, and where the energy went.

#include "figure.hpp"
#include "force_scale.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/plot.hpp>
#include <lagrain/run.hpp>
#include <lagrain/style.hpp>
#include <lagrain/video.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr int kLayers = 8;
constexpr double kImpactWindow = 0.6;  // of the strip and the plots, after the impact [s]
constexpr double kFrameEvery = 0.004;  // simulated time between video frames [s]
constexpr double kWallHeight = 0.59;   // drawn, of the width of the bed

struct Snapshot {
  double time = 0;  ///< [s]
  Columns<2> position;
};

/// Grains placed by hand come first, and the rock is the only one.
constexpr int kRock = 0;

/// What is kept of the run.
struct Record {
  double impact = -1;                    ///< when the rock first touches the bed [s]
  std::vector<int> layer;                ///< of each grain just before the impact; -1 for the rock
  std::vector<double> time, slab_force;  ///< [s], [N], downwards
  std::vector<double> ledger_time;       ///< [s]
  std::vector<Ledger> ledger;
  Snapshot peak;          ///< at the largest force on the slab after impact
  double peak_force = 0;  ///< [N]
  std::vector<ContactRecord<2>> peak_contacts;
  ContactStatistics peak_statistics;
  double bed_surface = 0;       ///< before the impact [m]
  double deepest_rock = 1e300;  ///< lowest point that the rock's underside reaches [m]
  std::vector<Snapshot> strip;
};

/// Times of the strip, after the impact [s].
constexpr std::array<double, 5> kStrip{-0.02, 0.02, 0.1, 0.25, 0.5};

Colour layer_colour(int layer) {
  if (layer < 0) return {96, 94, 100, 255};
  // Neighbouring layers differ in lightness as well, twice: along the map, and every other one
  // lighter. So they part in grey print too.
  const Colour base = colour(ColourMap::viridis, (layer + 0.5) / kLayers);
  return layer % 2 == 0 ? base : mix(base, style::kPaper, 0.35);
}

Box world_window(const Run<2>& run) {
  const double width = run.walls()[2].point.x();
  return {{-0.02 * width, -0.02 * width}, {1.02 * width, (kWallHeight + 0.02) * width}};
}

void add_box_walls(DisplayList& list, const Panel& panel, const Run<2>& run, double top) {
  const double width = run.walls()[2].point.x();
  const Stroke stroke = style::kWallLine;
  list.add(Segment{panel.point({0, 0}), panel.point({width, 0}), stroke});
  list.add(Segment{panel.point({0, 0}), panel.point({0, top}), stroke});
  list.add(Segment{panel.point({width, 0}), panel.point({width, top}), stroke});
}

void add_layers(DisplayList& list, const Panel& panel, const Run<2>& run, const Record& record,
                const Snapshot& at) {
  list.add(PushClip{panel.box()});
  for (int i = 0; i < run.count(); ++i) {
    const bool rock = i == kRock;
    Disc disc{panel.point(at.position.col(i)), panel.length(run.radii()[i]),
              record.layer.empty() ? (rock ? layer_colour(-1) : style::kGrain)
                                   : layer_colour(record.layer[static_cast<std::size_t>(i)])};
    if (rock) disc.outline = {style::kInk, style::kMedium};
    list.add(disc);
  }
  add_box_walls(list, panel, run, kWallHeight * run.walls()[2].point.x());
  list.add(PopClip{});
}

/// Width of the strongest line [pt]: so many mean grain diameters that chains stand out and the
/// grains between them stay visible.
double widest_line(const Panel& panel, const Run<2>& run) {
  return 1.5 * panel.length(2 * run.radii().mean());
}

void add_forces(DisplayList& list, const Panel& panel, const Run<2>& run, const Record& record) {
  list.add(PushClip{panel.box()});
  for (int i = 0; i < run.count(); ++i) {
    list.add(Disc{panel.point(record.peak.position.col(i)), panel.length(run.radii()[i]),
                  style::kGrainPale});
  }
  std::vector<ContactRecord<2>> contacts = record.peak_contacts;
  // Strong chains lie on top of weak ones.
  std::stable_sort(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) {
    return a.force.squaredNorm() < b.force.squaredNorm();
  });
  const double ceiling = force_ceiling<2>(contacts);
  const double widest = widest_line(panel, run);
  for (const ContactRecord<2>& c : contacts) {
    const Vec<2> from = record.peak.position.col(c.i);
    const Vec<2> to = c.j >= 0 ? Vec<2>(record.peak.position.col(c.j))
                               : Vec<2>(from - (run.radii()[c.i] - c.overlap) * c.normal);
    const double width = widest * std::min(c.force.norm() / ceiling, 1.0);
    list.add(Segment{panel.point(from), panel.point(to), {style::kContact, width}});
  }
  add_box_walls(list, panel, run, kWallHeight * run.walls()[2].point.x());
  list.add(PopClip{});
}

/// Runs the scene and keeps what the figure needs. The video is written on the way.
class Recorder {
 public:
  Recorder(Run<2>& run, const FigureOptions& options)
      : run_(run), options_(options), video_(options.out / "fig5.mp4", 25) {}

  Record run() {
    while (!run_.finished()) {
      run_.step();
      after_step();
      if (options_.stop()) {
        write_series();
        throw Interrupted();
      }
    }
    keep(record_.strip);  // the last picture of the strip is the final state
    write_series();
    return std::move(record_);
  }

  VideoReport finish_video() { return video_.finish(); }

  /// The series as CSV; also what is left of an interrupted run.
  void write_series() const {
    Csv force("time[s],slab_force[N]");
    for (std::size_t k = 0; k < record_.time.size(); ++k) {
      force.row(record_.time[k], record_.slab_force[k]);
    }
    write_file(options_.out / "fig5_slab_force.csv", force.text());
    Csv energy("time[s],kinetic[J],gravity[J],elastic[J],dashpot[J],friction[J],residual[J]");
    for (std::size_t k = 0; k < record_.ledger.size(); ++k) {
      const Ledger& l = record_.ledger[k];
      energy.row(record_.ledger_time[k], l.kinetic, l.gravity, l.elastic, l.dashpot, l.friction,
                 residual(l, record_.ledger.front()));
    }
    write_file(options_.out / "fig5_energy.csv", energy.text());
  }

 private:
  double underside() const { return run_.positions()(1, kRock) - run_.radii()[kRock]; }

  void after_step() {
    const std::int64_t step = run_.steps();
    if (step % kWatchEvery == 0) {
      if (record_.impact < 0) {
        watch_for_impact();
      } else {
        record_.deepest_rock = std::min(record_.deepest_rock, underside());
      }
    }
    if (step % kForceEvery == 0) {
      const double force = -run_.walls()[0].force.y();
      record_.time.push_back(run_.time());
      record_.slab_force.push_back(force);
      if (record_.impact >= 0 && force > record_.peak_force) {
        record_.peak_force = force;
        record_.peak = {run_.time(), run_.positions()};
        record_.peak_contacts = run_.contacts();
        record_.peak_statistics = run_.statistics();
      }
    }
    if (step % kLedgerEvery == 0 || step == 1) {
      record_.ledger_time.push_back(run_.time());
      record_.ledger.push_back(run_.ledger());
      options_.progress(run_.time() / run_.scene().duration, "rock fall");
    }
    if (record_.impact >= 0 && record_.strip.size() + 1 < kStrip.size() &&
        run_.time() >= record_.impact + kStrip[record_.strip.size()]) {
      keep(record_.strip);
    }
    if (record_.impact >= 0 && run_.time() >= next_frame_) {
      add_frame();
      next_frame_ += options_.quick ? 4 * kFrameEvery : kFrameEvery;
    }
  }

  void keep(std::vector<Snapshot>& where) { where.push_back({run_.time(), run_.positions()}); }

  /// Foresees the impact some 0.03 s before the rock reaches the bed, and takes the layers of
  /// that moment.
  void watch_for_impact() {
    const Columns<2>& x = run_.positions();
    double surface = 0;
    const double middle = x(0, kRock);
    const double reach = run_.radii()[kRock];
    for (int i = kRock + 1; i < run_.count(); ++i) {
      if (std::abs(x(0, i) - middle) < reach) {
        surface = std::max(surface, x(1, i) + run_.radii()[i]);
      }
    }
    const double speed = std::abs(run_.velocities()(1, kRock));
    if (underside() - surface > 0.03 * speed) return;
    record_.impact = run_.time() + (underside() - surface) / speed;
    record_.bed_surface = surface;
    next_frame_ = run_.time();

    // Layers of equal thickness over the height of the bed, whose surface we take as the 99 %
    // quantile of the heights: single stones lie higher.
    std::vector<double> heights;
    for (int i = kRock + 1; i < run_.count(); ++i) heights.push_back(x(1, i));
    const auto at = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), heights.begin() + at, heights.end());
    const double top = heights[static_cast<std::size_t>(at)];
    record_.layer.assign(static_cast<std::size_t>(run_.count()), -1);
    for (int i = kRock + 1; i < run_.count(); ++i) {
      record_.layer[static_cast<std::size_t>(i)] =
          std::clamp(static_cast<int>(x(1, i) / top * kLayers), 0, kLayers - 1);
    }
  }

  void add_frame() {
    DisplayList list{.width = 640, .height = 400};
    const Panel panel({{4, 4}, {636, 384}}, world_window(run_));
    add_layers(list, panel, run_, record_, {run_.time(), run_.positions()});
    const double ms = 1000 * (run_.time() - record_.impact);
    list.add(Label{.text = "$t = " + std::to_string(std::lround(ms)) + "$ ms",
                   .at = {14, 392},
                   .size = 14,
                   .along = Along::top});
    video_.add(paint_rgba(list, 144, Quality::frame));
  }

  static constexpr std::int64_t kForceEvery = 10;
  static constexpr std::int64_t kWatchEvery = 100;  // steps between looks at the rock: 1 ms
  static constexpr std::int64_t kLedgerEvery = 200;

  Run<2>& run_;
  const FigureOptions& options_;
  VideoWriter video_;
  Record record_;
  double next_frame_ = 1e300;
};

/// Force on the slab against time after the impact.
Plot slab_force_plot(const Record& record, double weight) {
  Series force = series_style(0);
  force.name = "force on the slab";
  for (std::size_t k = 0; k < record.time.size(); ++k) {
    const double after = record.time[k] - record.impact;
    if (after < -0.05 || after > kImpactWindow) continue;
    force.x.push_back(1000 * after);
    force.y.push_back(1e-3 * record.slab_force[k]);
  }
  Series load = series_style(1);
  load.name = "weight of bed and rock";
  load.x = {-50, 1000 * kImpactWindow};
  load.y = {1e-3 * weight, 1e-3 * weight};
  return {.x = {.label = "time after impact [ms]"},
          .y = {.label = "force [kN]", .low = 0},
          .series = {force, load}};
}

/// Where the energy that gravity gave has gone.
Plot energy_plot(const Record& record) {
  const std::array<std::string, 5> names{"kinetic", "elastic", "dashpots", "friction",
                                         "given by gravity"};
  std::vector<Series> series;
  for (std::size_t k = 0; k < names.size(); ++k) {
    series.push_back(series_style(static_cast<int>(k)));
    series.back().name = names[k];
  }
  const Ledger& start = record.ledger.front();
  double highest = 0;
  for (std::size_t k = 0; k < record.ledger.size(); ++k) {
    const Ledger& l = record.ledger[k];
    const std::array<double, 5> values{l.kinetic, l.elastic, l.dashpot, l.friction,
                                       start.gravity - l.gravity};
    highest = std::max(highest, 1e-3 * values.back());  // room for the legend above
    for (std::size_t s = 0; s < values.size(); ++s) {
      series[s].x.push_back(record.ledger_time[k]);
      series[s].y.push_back(1e-3 * values[s]);
    }
  }
  return {.x = {.label = "time [s]", .low = 0},
          .y = {.label = "energy [kJ]", .low = 0, .high = 2.1 * highest},
          .series = series,
          .legend = Corner::top_left};
}

void add_letter(DisplayList& list, const Box& box, const std::string& letter) {
  list.add(Label{.text = letter, .at = {box.low[0], box.high[1] + 4}, .size = style::kTitle});
}

DisplayList page(const Run<2>& run, const Record& record) {
  const Box world = world_window(run);
  const double gap = 12;
  const double half = 0.5 * (style::kPage - gap);
  const double panel_height = half * world.size()[1] / world.size()[0];
  const double strip_width = (style::kPage - 4 * 5.0) / 5;
  const double strip_height = strip_width * world.size()[1] / world.size()[0];
  const double plot_height = 130;
  const double height = 16 + panel_height + 30 + strip_height + 34 + plot_height + 4;
  DisplayList list{.width = style::kPage, .height = height, .title = "lagrain, figure 5"};

  double y = height - 16 - panel_height;
  const Box left{{0, y}, {half, y + panel_height}};
  const Box right{{half + gap, y}, {style::kPage, y + panel_height}};
  const Panel final_panel(left, world);
  add_layers(list, final_panel, run, record, record.strip.back());
  add_letter(list, left, "(a) after the impact");
  const Panel force_panel(right, world);
  add_forces(list, force_panel, run, record);
  add_letter(list, right,
             "(b) forces, $t$ = " +
                 std::to_string(std::lround(1000 * (record.peak.time - record.impact))) + " ms");
  const double ceiling = force_ceiling<2>(record.peak_contacts);
  std::vector<double> legend = legend_forces(1e-3 * ceiling);
  add_width_legend(list, {right.low[0] + 12, right.high[1] - 16}, legend,
                   widest_line(force_panel, run) / (1e-3 * ceiling), "kN");
  add_scale_bar(list, {left.low[0] + 12, left.high[1] - 14}, final_panel, 1, "1 m");

  y -= 30 + strip_height;
  for (std::size_t k = 0; k < record.strip.size(); ++k) {
    const double x = static_cast<double>(k) * (strip_width + 5);
    const Box box{{x, y}, {x + strip_width, y + strip_height}};
    add_layers(list, Panel(box, world), run, record, record.strip[k]);
    const long ms = std::lround(1000 * (record.strip[k].time - record.impact));
    list.add(Label{.text = (k == 0 ? "(c) $" : "$") + std::to_string(ms) + "$ ms",
                   .at = {box.low[0], box.high[1] + 4},
                   .size = k == 0 ? style::kTitle : style::kText});
  }

  y -= 34 + plot_height;
  const double weight = -run.scene().gravity.y() * run.masses().sum();
  const Box force_box{{0, y}, {half, y + plot_height}};
  add_plot(list, force_box, slab_force_plot(record, weight));
  add_letter(list, force_box, "(d)");
  const Box energy_box{{half + gap, y}, {style::kPage, y + plot_height}};
  add_plot(list, energy_box, energy_plot(record));
  add_letter(list, energy_box, "(e)");
  return list;
}

/// One of the two panels over the full width of a page.
DisplayList large_panel(const Run<2>& run, const Record& record, bool forces) {
  const Box world = world_window(run);
  const double height = style::kPage * world.size()[1] / world.size()[0];
  DisplayList list{.width = style::kPage, .height = height, .title = "lagrain, figure 5"};
  const Panel panel(list.page(), world);
  if (forces) {
    add_forces(list, panel, run, record);
    const double ceiling = 1e-3 * force_ceiling<2>(record.peak_contacts);
    add_width_legend(list, {24, height - 22}, legend_forces(ceiling),
                     widest_line(panel, run) / ceiling, "kN");
  } else {
    add_layers(list, panel, run, record, record.strip.back());
    add_scale_bar(list, {24, height - 20}, panel, 1, "1 m");
  }
  return list;
}

}  // namespace

FigureResult draw_figure5(const FigureOptions& options) {
  const std::filesystem::path file =
      options.scenes / (options.quick ? "rock_fall_quick.toml" : "rock_fall.toml");
  const std::unique_ptr<Run<2>> run = make_run(read_scene<2>(file));
  Recorder recorder(*run, options);
  const Record record = recorder.run();
  const VideoReport video = recorder.finish_video();

  const DisplayList list = page(*run, record);
  paint_png(list, options.out / "fig5.png", 450);
  paint_pdf(list, options.out / "fig5.pdf");
  paint_png(large_panel(*run, record, false), options.out / "fig5_layers.png", 450);
  paint_png(large_panel(*run, record, true), options.out / "fig5_forces.png", 450);
  write_file(options.out / "fig5_final.csv", frame_csv(*run));
  write_file(options.out / "fig5_contacts.csv", contacts_csv(*run));

  const ContactStatistics last = run->statistics();
  const Ledger ledger = run->ledger();
  FigureResult result;
  result.caption =
      "(a) A rock of 1 t per metre of depth has fallen 5 m onto a bed of " +
      std::to_string(run->count() - 1) +
      " stones over a slab; colours are horizontal layers just before the impact. (b) Every edge "
      "of the triangulation that carries a contact, with a thickness proportional to its force, at "
      "the largest force on the slab; contacts with the walls likewise. The strongest 0.1 % are "
      "drawn no thicker than the next. (c) Strip in time. (d) Force on the slab. (e) Energy "
      "ledger.";
  result.comparisons = {
      {"grains", "approx. 20,000", std::to_string(run->count() - 1) + " and the rock"},
      {"overlap (the paper: in practice, of the size of the grains)", "about 1 %",
       percent(record.peak_statistics.mean_overlap) + " mean at the largest force, " +
           percent(last.mean_overlap) + " at the end (of the smaller radius)"}};
  for (auto& [name, value] : facts(*run)) result.facts.push_back({name, value});
  result.facts.push_back(
      {"largest force on the slab", rounded(1e-3 * record.peak_force) + " kN per metre"});
  result.facts.push_back(
      {"penetration of the rock", rounded(record.bed_surface - record.deepest_rock) + " m"});
  result.facts.push_back(
      {"largest overlap at the largest force", percent(record.peak_statistics.largest_overlap)});
  result.facts.push_back({"energy residual, of what was dissipated",
                          percent(run->energy_residual() / (ledger.dashpot + ledger.friction))});
  result.pictures = {"fig5.png", "fig5.pdf", "fig5_layers.png", "fig5_forces.png", video.path};
  result.downloads = {"fig5_slab_force.csv", "fig5_energy.csv", "fig5_final.csv",
                      "fig5_contacts.csv", file};
  return result;
}

}  // namespace lagrain::figures
