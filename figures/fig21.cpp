// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 21 (report): three scenes that every user of discrete elements knows. (a, b) Janssen's
// silo: the stress grows to a limit with depth, as friction at the walls carries the rest. (c, d)
// A tube is lifted, and the angle of the heap under it depends on what resists rolling. (e to g) A
// biaxial test of a dense bed: friction angle and dilation.
//
// Writes fig21.png, fig21.pdf, fig21_silo.csv, fig21_heaps.csv and fig21_biaxial.csv; runs
// janssen.toml, lifted_tube.toml and biaxial.toml, whose bed is biaxial_bed.csv.

#include "classics.hpp"
#include "diagrams.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

/// A state to be drawn.
struct Snapshot {
  Columns<2> position;
  Eigen::VectorXd radius;
  std::vector<ContactRecord<2>> contacts;
};

Snapshot snapshot_of(const Run<2>& run) { return {run.positions(), run.radii(), run.contacts()}; }

/// Mean of some numbers and their standard deviation; 0 for a single one.
struct Spread {
  double mean = 0, deviation = 0;
};

Spread spread_of(const std::vector<double>& values) {
  Spread s;
  const auto count = static_cast<double>(values.size());
  for (const double v : values) s.mean += v / count;
  for (const double v : values) s.deviation += (v - s.mean) * (v - s.mean);
  s.deviation = values.size() < 2 ? 0 : std::sqrt(s.deviation / (count - 1));
  return s;
}

struct SiloSeries {
  JanssenSilo mean;             ///< over the seeds
  std::vector<double> lengths;  ///< fitted, of each seed [m]
  double friction = 0;          ///< of the walls as the scene has it
  Snapshot last;
};

struct Heap {
  double friction = 0, rolling = 0;
  Spread angle;  ///< over flanks and seeds [rad]
  int flanks = 0;
};

struct Heaps {
  std::vector<Heap> all;
  Snapshot drawn;
  double friction = 0, rolling = 0;  ///< of the one that is drawn
};

struct Compression {
  double friction = 0;
  Biaxial test;
};

struct Figure21 {
  SiloSeries silo;
  Heaps heaps;
  std::vector<Compression> compressions;
  Snapshot sheared;  ///< the scene's own friction, at the end
  std::int64_t missed = 0, audited = 0;

  void count(const Run<2>& run) {
    missed += run.audit().missed();
    audited += run.audit().contacts();
  }
};

/// A scene of the same kind with fewer grains. (So few would be audited at every step.)
void fill_less(Scene<2>& scene, int times) {
  Fill<2>& fill = scene.fills.back();
  fill.count = *fill.count / times;
  Region<2>& region = fill.region;
  region.high[1] = region.low[1] + (region.high[1] - region.low[1]) / times;
  scene.law.stiffness /= 2;
  scene.audit = false;
}

void run_silos(Figure21& figure, const FigureOptions& options) {
  const int seeds = options.quick ? 1 : 3;
  Scene<2> scene = read_scene<2>(options.scenes / "janssen.toml");
  if (options.quick) fill_less(scene, 2);
  figure.silo.friction = scene.law.friction;
  JanssenSilo& mean = figure.silo.mean;
  for (int seed = 1; seed <= seeds; ++seed) {
    options.progress(0.3 * (seed - 1) / seeds, "Janssen's silo");
    scene.seed = static_cast<std::uint64_t>(seed);
    const auto run = make_run(scene, 1);
    const JanssenSilo silo = run_silo(*run, options);
    figure.silo.lengths.push_back(janssen_length(silo.depth, silo.vertical, silo.weight));
    figure.count(*run);
    if (seed == 1) {
      mean = silo;
      figure.silo.last = snapshot_of(*run);
      continue;
    }
    const auto add = [seed](double& to, double value) { to += (value - to) / seed; };
    for (std::size_t k = 0; k < mean.depth.size(); ++k) {
      add(mean.depth[k], silo.depth[k]);
      add(mean.vertical[k], silo.vertical[k]);
      add(mean.horizontal[k], silo.horizontal[k]);
    }
    add(mean.weight, silo.weight);
    add(mean.wall_friction, silo.wall_friction);
    add(mean.lateral_ratio, silo.lateral_ratio);
  }
}

void run_heaps(Figure21& figure, const FigureOptions& options) {
  const std::vector<double> rolling =
      options.quick ? std::vector<double>{0, 0.2} : std::vector<double>{0, 0.1, 0.2, 0.4};
  const std::vector<double> frictions =
      options.quick ? std::vector<double>{0.5} : std::vector<double>{0.25, 0.5};
  const int seeds = options.quick ? 1 : 2;
  Scene<2> scene = read_scene<2>(options.scenes / "lifted_tube.toml");
  if (options.quick) {
    fill_less(scene, 3);
    scene.duration = 3.5;
  }
  const double own_friction = scene.law.friction, own_rolling = scene.law.rolling_friction;
  const auto count = static_cast<double>(rolling.size() * frictions.size());
  for (const double mu : frictions) {
    for (const double roll : rolling) {
      options.progress(0.3 + 0.5 * static_cast<double>(figure.heaps.all.size()) / count,
                       "a lifted tube");
      std::vector<double> angles;
      for (int seed = 1; seed <= seeds; ++seed) {
        scene.seed = static_cast<std::uint64_t>(seed);
        scene.law.friction = mu;
        scene.law.rolling_friction = roll;
        const auto run = make_run(scene, 1);
        while (!run->finished()) {
          options.check_stop();
          run->step(500);
        }
        figure.count(*run);
        std::vector<int> heap;
        for (int i = 0; i < run->count(); ++i) {
          if (!run->pinned()[i]) heap.push_back(i);
        }
        const auto flanks = flank_angles(run->positions()(Eigen::all, heap), run->radii()(heap));
        angles.insert(angles.end(), flanks.begin(), flanks.end());
        if (seed == 1 && mu == own_friction && roll == own_rolling) {
          figure.heaps.drawn = snapshot_of(*run);
          figure.heaps.friction = mu;
          figure.heaps.rolling = roll;
        }
      }
      figure.heaps.all.push_back({mu, roll, spread_of(angles), static_cast<int>(angles.size())});
    }
  }
}

void run_compressions(Figure21& figure, const FigureOptions& options) {
  Scene<2> scene = read_scene<2>(options.scenes / "biaxial.toml");
  const double own = scene.law.friction;
  for (const double mu : options.quick ? std::vector<double>{own} : std::vector<double>{0.2, own}) {
    options.progress(mu == own ? 0.9 : 0.8, "biaxial test");
    scene.law.friction = mu;
    if (options.quick) scene.duration = 0.7;
    const auto run = make_run(scene, 1);
    figure.compressions.push_back({mu, run_biaxial(*run, options)});
    figure.count(*run);
    if (mu == own) figure.sheared = snapshot_of(*run);
  }
}

void add_discs(DisplayList& list, const Panel& panel, const Snapshot& s, Colour fill) {
  for (Eigen::Index i = 0; i < s.position.cols(); ++i) {
    list.add(Disc{panel.point(s.position.col(i)),
                  panel.length(s.radius[i]),
                  fill,
                  {style::kGrainOutline, style::kHairline}});
  }
}

/// Contacts as lines as thick as their forces are large.
void add_forces(DisplayList& list, const Panel& panel, const Snapshot& s) {
  double strongest = 0;
  for (const ContactRecord<2>& c : s.contacts) strongest = std::max(strongest, c.force.norm());
  const double widest = panel.length(2 * s.radius.mean());
  for (const ContactRecord<2>& c : s.contacts) {
    const Vec<2> from = s.position.col(c.i);
    const Vec<2> to = c.j >= 0 ? Vec<2>(s.position.col(c.j))
                               : Vec<2>(from - (s.radius[c.i] - c.overlap) * c.normal);
    const double width = widest * c.force.norm() / strongest;
    list.add(Segment{panel.point(from), panel.point(to), {style::kContact, width}});
  }
}

/// A picture of the discs in a window of the world, with its title.
void add_picture(DisplayList& list, const Box& page, const Box& world, const Snapshot& s,
                 bool forces, const std::string& title) {
  const Panel panel(page, world);
  list.add(PushClip{panel.box()});
  add_discs(list, panel, s, forces ? style::kGrainPale : style::kGrain);
  if (forces) add_forces(list, panel, s);
  list.add(PopClip{});
  list.add(Label{.text = title, .at = {page.low[0], page.high[1] + 6}, .size = style::kTitle});
}

Series line_of(const std::string& name, std::vector<double> dashes = {}) {
  return {.name = name,
          .x = {},
          .y = {},
          .colour = style::kInk,
          .width = style::kMedium,
          .dashes = std::move(dashes)};
}

Plot silo_plot(const SiloSeries& series) {
  const JanssenSilo& silo = series.mean;
  Series found = curve(0, "measured"), fit = line_of("Janssen, fitted"),
         told = line_of("Janssen, from the walls", {3, 2}), free = line_of("without walls", {1, 2});
  found.width = 0;
  for (std::size_t k = 0; k < silo.depth.size(); ++k) {
    found.x.push_back(silo.depth[k]);
    found.y.push_back(silo.vertical[k] / 1e3);
  }
  const double fitted = janssen_length(silo.depth, silo.vertical, silo.weight);
  constexpr int kParts = 80;
  const double deepest = silo.depth.front();
  for (int p = 0; p <= kParts; ++p) {
    const double z = deepest * p / kParts;
    for (Series* s : {&fit, &told, &free}) s->x.push_back(z);
    fit.y.push_back(janssen_stress(z, silo.weight, fitted) / 1e3);
    told.y.push_back(janssen_stress(z, silo.weight, silo.length()) / 1e3);
    free.y.push_back(silo.weight * z / 1e3);
  }
  const double top = 2 * *std::max_element(found.y.begin(), found.y.end());
  return {.x = {.label = "depth [m]", .low = 0},
          .y = {.label = "vertical stress [kPa]", .low = 0, .high = top},
          .series = {free, fit, told, found},
          .legend = Corner::top_right};
}

Plot heap_plot(const Heaps& heaps) {
  Plot plot{.x = {.label = "rolling friction", .low = -0.02, .high = 0.42},
            .y = {.label = "angle of repose [degrees]", .low = 0, .high = 45},
            .series = {},
            .legend = Corner::top_left};
  int index = 0;
  for (std::size_t k = 0; k < heaps.all.size();) {
    const double mu = heaps.all[k].friction;
    Series means = curve(index++, "friction " + rounded(mu));
    for (; k < heaps.all.size() && heaps.all[k].friction == mu; ++k) {
      const Heap& heap = heaps.all[k];
      if (heap.flanks == 0) continue;
      means.x.push_back(heap.rolling);
      means.y.push_back(degrees(heap.angle.mean));
      Series bar{.name = "",
                 .x = {heap.rolling, heap.rolling},
                 .y = {},
                 .colour = means.colour,
                 .width = style::kThin};
      for (const double sign : {-1.0, 1.0}) {
        bar.y.push_back(degrees(heap.angle.mean + sign * heap.angle.deviation));
      }
      plot.series.push_back(std::move(bar));
    }
    plot.series.push_back(std::move(means));
  }
  return plot;
}

Plot biaxial_plot(const std::vector<Compression>& all, const std::string& label,
                  double (*y)(const Biaxial&, std::size_t)) {
  Plot plot{.x = {.label = "axial strain [%]", .low = 0},
            .y = {.label = label},
            .series = {},
            .legend = Corner::top_left};
  for (const Compression& c : all) {
    Series s = curve(static_cast<int>(plot.series.size()), "friction " + rounded(c.friction));
    s.marker = Marker::none;
    for (std::size_t k = 0; k < c.test.strain.size(); ++k) {
      s.x.push_back(100 * c.test.strain[k]);
      s.y.push_back(y(c.test, k));
    }
    plot.series.push_back(std::move(s));
  }
  leave_room_for_legend(plot);
  return plot;
}

double mobilised(const Biaxial& test, std::size_t k) {
  return degrees(friction_angle(test.axial[k], test.lateral[k]));
}

/// What a test has come to.
struct Strength {
  double peak = 0, at = 0;  ///< [degrees], strain [-]
  double last = 0;          ///< mean over the last fifth [degrees]
  double dilation = 0;      ///< at the end [-]
};

Strength strength_of(const Biaxial& test) {
  Strength s;
  const std::size_t count = test.strain.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (mobilised(test, k) > s.peak) {
      s.peak = mobilised(test, k);
      s.at = test.strain[k];
    }
  }
  for (std::size_t k = count - count / 5; k < count; ++k) {
    s.last += mobilised(test, k) / static_cast<double>(count / 5);
  }
  s.dilation = test.dilation.back();
  return s;
}

DisplayList picture_of(const Figure21& figure) {
  constexpr double kTitleRoom = 18, kGap = 16, kTop = 170, kHeap = 62, kBottom = 150;
  constexpr double kSilo = 34, kSample = 74;  // widths of pictures [pt]
  DisplayList list{.width = style::kPage,
                   .height = kTop + kHeap + kBottom + 3 * kTitleRoom,
                   .title = "Silo, heap, biaxial test"};
  const auto title = [&list](const std::string& text, double x, double y) {
    list.add(Label{.text = text, .at = {x, y + 6}, .size = style::kTitle});
  };
  double y = list.height - kTitleRoom - kTop;
  const double deepest = figure.silo.mean.depth.front();
  add_picture(list, {{0, y}, {kSilo, y + kTop}},
              {{-0.003, -0.03}, {figure.silo.mean.width + 0.003, deepest}}, figure.silo.last, true,
              "(a)");
  const double half = (style::kPage - kSilo - 2 * kGap) / 2;
  add_plot(list, {{kSilo + kGap, y}, {kSilo + kGap + half, y + kTop}}, silo_plot(figure.silo));
  title("(b) stress in a silo", kSilo + kGap, y + kTop);
  add_plot(list, {{style::kPage - half, y}, {style::kPage, y + kTop}}, heap_plot(figure.heaps));
  title("(c) heaps under a lifted tube", style::kPage - half, y + kTop);

  y -= kTitleRoom + kHeap;
  add_picture(list, {{0, y}, {style::kPage, y + kHeap}}, {{-0.8, -0.015}, {0.8, 0.186}},
              figure.heaps.drawn, false,
              "(d) friction " + rounded(figure.heaps.friction) + ", rolling friction " +
                  rounded(figure.heaps.rolling));

  y -= kTitleRoom + kBottom;
  const double wide = 1.15 * figure.sheared.position.row(0).maxCoeff();
  add_picture(list, {{0, y}, {kSample, y + kBottom}},
              {{-0.01, -0.01}, {wide, 0.01 + figure.sheared.position.row(1).maxCoeff()}},
              figure.sheared, true, "(e) sheared");
  const double width = (style::kPage - kSample - 2 * kGap) / 2;
  add_plot(list, {{kSample + kGap, y}, {kSample + kGap + width, y + kBottom}},
           biaxial_plot(figure.compressions, "friction angle [degrees]", mobilised));
  title("(f) biaxial test: strength", kSample + kGap, y + kBottom);
  add_plot(list, {{style::kPage - width, y}, {style::kPage, y + kBottom}},
           biaxial_plot(figure.compressions, "growth of volume [%]",
                        [](const Biaxial& t, std::size_t k) { return 100 * t.dilation[k]; }));
  title("(g) biaxial test: volume", style::kPage - width, y + kBottom);
  return list;
}

void write_numbers(const Figure21& figure, const FigureOptions& options, FigureResult& result) {
  const auto write = [&](const std::string& file, const Csv& csv) {
    write_file(options.out / file, csv.text());
    result.downloads.push_back(file);
  };
  Csv silo("depth[m],vertical_stress[Pa],horizontal_stress[Pa]");
  const JanssenSilo& mean = figure.silo.mean;
  for (std::size_t k = 0; k < mean.depth.size(); ++k) {
    silo.row(mean.depth[k], mean.vertical[k], mean.horizontal[k]);
  }
  write("fig21_silo.csv", silo);
  Csv heaps("friction[-],rolling_friction[-],angle[rad],deviation[rad],flanks[-]");
  for (const Heap& heap : figure.heaps.all) {
    heaps.row(heap.friction, heap.rolling, heap.angle.mean, heap.angle.deviation, heap.flanks);
  }
  write("fig21_heaps.csv", heaps);
  Csv biaxial("friction[-],strain[-],dilation[-],axial_stress[Pa],lateral_stress[Pa]");
  for (const auto& [friction, test] : figure.compressions) {
    for (std::size_t k = 0; k < test.strain.size(); ++k) {
      biaxial.row(friction, test.strain[k], test.dilation[k], test.axial[k], test.lateral[k]);
    }
  }
  write("fig21_biaxial.csv", biaxial);
}

std::string with_spread(const Spread& s) {
  return fixed(s.mean, 1) + (s.deviation > 0 ? " ± " + fixed(s.deviation, 1) : "");
}

Table table_of(const Heaps& heaps) {
  Table table{"Heaps: mean and standard deviation over their flanks",
              {"friction", "rolling friction", "angle of repose, degrees", "flanks"},
              {}};
  for (const Heap& heap : heaps.all) {
    const Spread angle{degrees(heap.angle.mean), degrees(heap.angle.deviation)};
    table.rows.push_back({rounded(heap.friction), rounded(heap.rolling),
                          heap.flanks == 0 ? "too flat" : with_spread(angle),
                          std::to_string(heap.flanks)});
  }
  return table;
}

Table table_of(const std::vector<Compression>& all) {
  Table table{
      "Biaxial test",
      {"friction", "peak, degrees", "at a strain of", "last fifth, degrees", "growth of volume"},
      {}};
  for (const Compression& c : all) {
    const Strength s = strength_of(c.test);
    table.rows.push_back({rounded(c.friction), fixed(s.peak, 1), percent(s.at), fixed(s.last, 1),
                          percent(s.dilation)});
  }
  return table;
}

std::string caption_of(const Figure21& figure) {
  const JanssenSilo& silo = figure.silo.mean;
  const Spread lengths = spread_of(figure.silo.lengths);
  const Strength strength = strength_of(figure.compressions.back().test);
  const Biaxial& test = figure.compressions.back().test;
  const double wall = -std::expm1(-silo.depth.front() / lengths.mean);
  return "Three scenes that every user of discrete elements knows, in the plane. (a, b) Janssen: "
         "in a silo whose bottom has sunk a little the vertical stress reaches " +
         percent(wall) + " of its limit. Janssen's law fits with a length of " +
         rounded(100 * lengths.mean) + " cm" +
         (lengths.deviation > 0
              ? " (standard deviation " + rounded(100 * lengths.deviation, 2) + " cm over " +
                    std::to_string(figure.silo.lengths.size()) + " beds)"
              : "") +
         "; from what the walls tell, a mobilised friction of " + rounded(silo.wall_friction) +
         " and horizontal over vertical stress of " + rounded(silo.lateral_ratio) +
         ", he would say " + rounded(100 * silo.length()) + " cm. (The walls have a friction of " +
         rounded(figure.silo.friction) +
         "; not all of it is mobilised.) (c, d) A tube is lifted, and a heap stays; bars are "
         "standard deviations over flanks. (e to g) Biaxial test of a dense bed between smooth "
         "walls. The side holds a pressure, " +
         rounded(1e-3 * spread_of(test.lateral).mean) +
         " kPa on average as the grains feel it; both stresses are forces over the lengths as they "
         "are. The "
         "friction angle peaks at " +
         fixed(strength.peak, 1) + " degrees (strain " + percent(strength.at) +
         "), the last fifth "
         "has " +
         fixed(strength.last, 1) + "; the volume grows by " + percent(strength.dilation) + ".";
}

}  // namespace

FigureResult draw_figure21(const FigureOptions& options) {
  Figure21 figure;
  run_silos(figure, options);
  run_heaps(figure, options);
  run_compressions(figure, options);

  FigureResult result;
  const DisplayList list = picture_of(figure);
  paint_png(list, options.out / "fig21.png", 300);
  paint_pdf(list, options.out / "fig21.pdf");
  result.pictures = {"fig21.png", "fig21.pdf"};
  write_numbers(figure, options, result);
  result.caption = caption_of(figure);
  result.tables = {table_of(figure.heaps), table_of(figure.compressions)};
  result.facts = {{"contacts missed", grouped(figure.missed) + " of " + grouped(figure.audited)}};
  return result;
}

}  // namespace lagrain::figures
