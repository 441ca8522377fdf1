// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 9 (not in the paper): how far random packings stay from the closest one.
//
// (a) The closest packing of equal spheres, face-centred cubic, run through the engine under its
// own weight. (b) The third claim of the paper, measured: edges of the triangulation per site,
// linear in all scenes, and a family of sites where they are quadratic. (c) The densities of
// figures 6 and 7 on one axis with the closest packing's.

#include "packing.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>
#include <lagrain/triangulation3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr double kRadius = 0.04;         // of the spheres of the closest packing [m]
constexpr double kDuration = 0.1;        // of its run [s]
constexpr double kRandomClose = 0.6366;  // Scott & Kilgour, J. Phys. D 2 (1969) 863

/// Square layers, each in the hollows of the one below: the (100) planes of face-centred cubic.
/// Stiff, so that the weight of the layers above does not show in the first four digits.
Scene<3> closest_packing(int across, int layers) {
  Scene<3> scene;
  scene.title = "Face-centred cubic packing under its own weight";
  scene.duration = kDuration;
  scene.time_step.fraction_of_contact = 1.0 / 20;
  scene.gravity = {0, 0, -9.81};
  scene.friction = FrictionModel::none;
  scene.law.stiffness = 4e8;
  scene.law.restitution = 0.5;
  scene.materials = {{"stone", 2500}};
  scene.audit = true;
  for (int k = 0; k < layers; ++k) {
    const int count = across - k % 2;
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) {
        PlacedGrain<3> grain;
        grain.radius = kRadius;
        grain.position =
            kRadius * Vec<3>(1 + 2 * i + k % 2, 1 + 2 * j + k % 2, 1 + std::numbers::sqrt2 * k);
        scene.grains.push_back(grain);
      }
    }
  }
  const Vec<3> far = Vec<3>::Constant(2 * kRadius * across);
  const Vec<3> zero = Vec<3>::Zero();
  scene.walls = {
      Wall<3>::half_space("bottom", zero, {0, 0, 1}), Wall<3>::half_space("left", zero, {1, 0, 0}),
      Wall<3>::half_space("front", zero, {0, 1, 0}), Wall<3>::half_space("right", far, {-1, 0, 0}),
      Wall<3>::half_space("back", far, {0, -1, 0})};
  return scene;
}

/// The closest packing after its run.
struct Closest {
  Packing packing;
  double start = 0;          ///< density within, before it carries itself
  double largest_move = 0;   ///< of a grain, of its radius [-]
  double kinetic_share = 0;  ///< kinetic energy at the end, of the weight times a radius [-]
};

Closest run_closest(const FigureOptions& options) {
  const int across = options.quick ? 7 : 9, layers = options.quick ? 8 : 12;
  const std::unique_ptr<Run<3>> run = make_run(closest_packing(across, layers));
  const Columns<3> before = run->positions();
  Closest result;
  Eigen::AlignedBox3d box(Vec<3>::Zero(), Vec<3>::Constant(2 * kRadius * across));
  box.max().z() = kRadius * (2 + std::numbers::sqrt2 * (layers - 1));
  result.start = bulk_density(before, run->radii(), box).first;
  while (!run->finished()) {
    run->step();
    options.check_stop();
    if (run->steps() % 100 == 0) {
      options.progress(run->time() / run->scene().duration, "closest packing");
    }
  }
  Packing& p = result.packing;
  p.name = "closest";
  p.position = run->positions();
  p.radius = run->radii();
  p.box = p.at_first = box;
  std::tie(p.bulk, p.bulk_count) = bulk_density(p.position, p.radius, box);
  p.edges_per_site = static_cast<double>(run->neighbourhood().edges()) / run->count();
  p.audited = run->audit().contacts();
  p.missed = run->audit().missed();
  result.largest_move = (p.position - before).colwise().norm().maxCoeff() / kRadius;
  result.kinetic_share = run->ledger().kinetic / (run->masses().sum() * 9.81 * kRadius);
  return result;
}

/// Half of the sites on each of two lines that cross in space: every site sees all of the
/// other line.
double edges_per_site_on_two_lines(int n) {
  Columns<3> x(3, n);
  for (int i = 0; i < n; ++i) {
    const double t = 2.0 * (i / 2 + 0.5) / n - 0.5;
    x.col(i) = i % 2 == 0 ? Vec<3>(t, 0, 0) : Vec<3>(0, t, 1);
  }
  Triangulation<3> triangulation;
  triangulation.build(x, Eigen::VectorXd::Zero(n));
  std::int64_t edges = 0;
  triangulation.for_each_edge([&](int, int) { ++edges; });
  return static_cast<double>(edges) / n;
}

/// The densities of a packing, in a row of (c).
struct AxisRow {
  std::string name;
  double piston, bulk;  // NaN: none
  double shaken_piston, shaken_bulk;
};

/// Rows of marks over one axis of densities.
void add_density_axis(DisplayList& list, const Box& box, const std::vector<AxisRow>& rows) {
  constexpr double kLow = 0.5, kHigh = 0.76;
  const double left = box.low[0] + 118, bottom = box.low[1] + 26;
  const auto at = [&](double density) {
    return left + (density - kLow) / (kHigh - kLow) * (box.high[0] - left);
  };
  const double step = (box.high[1] - 20 - bottom) / static_cast<double>(rows.size());
  const double top = box.high[1] - 14;
  list.add(Segment{{left, bottom}, {box.high[0], bottom}, style::kAxisLine});
  for (const Tick& tick : nice_ticks(kLow, kHigh, 6).ticks) {
    const double x = at(tick.value);
    list.add(Segment{{x, bottom}, {x, bottom - 3}, style::kAxisLine});
    list.add(Label{.text = tick.label,
                   .at = {x, bottom - 5},
                   .size = style::kSmallText,
                   .across = Across::centre,
                   .along = Along::top});
  }
  list.add(Label{.text = "density",
                 .at = {(left + box.high[0]) / 2, box.low[1] + 8},
                 .size = style::kText,
                 .across = Across::centre,
                 .along = Along::top});
  const auto add_bound = [&](double density, const std::string& name) {
    list.add(Segment{{at(density), bottom}, {at(density), top}, {style::kFaint, style::kMedium}});
    list.add(Label{.text = name,
                   .at = {at(density), top + 3},
                   .size = style::kSmallText,
                   .across = Across::centre});
  };
  add_bound(kRandomClose, "random close");
  add_bound(kClosestPacking, "closest, 0.7405");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const AxisRow& row = rows[k];
    const double y = top - 6 - (static_cast<double>(k) + 0.5) * step;
    list.add(Label{.text = row.name,
                   .at = {left - 6, y},
                   .size = style::kText,
                   .across = Across::right,
                   .along = Along::middle});
    list.add(
        Segment{{left, y}, {box.high[0], y}, {with_alpha(style::kFaint, 0.4), style::kHairline}});
    const auto mark = [&](double density, Colour colour, bool filled) {
      if (!(density >= kLow && density <= kHigh)) return;
      list.add(Disc{{at(density), y}, 3, filled ? colour : style::kPaper, {colour, 1}});
    };
    mark(row.piston, category(0), false);
    mark(row.bulk, category(0), true);
    mark(row.shaken_piston, category(1), false);
    mark(row.shaken_bulk, category(1), true);
  }
}

/// What the four marks mean.
void add_key(DisplayList& list, const Vec<2>& low) {
  const std::array<std::string, 4> names{"by the piston", "away from the walls",
                                         "shaken, by the piston", "shaken, away from the walls"};
  double x = low[0];
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Colour colour = category(static_cast<int>(k / 2));
    list.add(Disc{{x, low[1]}, 3, k % 2 == 1 ? colour : style::kPaper, {colour, 1}});
    list.add(Label{.text = names[k],
                   .at = {x + 6, low[1]},
                   .size = style::kSmallText,
                   .along = Along::middle});
    x += k == 0 ? 70 : k == 1 ? 92 : 94;
  }
}

constexpr std::array<const char*, 5> kFiles{"packing_1484.toml", "packing_3498.toml",
                                            "packing_6944.toml", "packing_207_227.toml",
                                            "packing_1484_1747.toml"};
constexpr std::array<std::size_t, 3> kShaken{0, 3, 4};  // of these, shaken as well

/// The packings of figures 6 and 7, those of kFiles and then those of kShaken. They have been run
/// already when all figures are drawn.
std::vector<Packing> random_packings(const FigureOptions& options) {
  std::vector<PackingJob> jobs;
  for (const char* file : kFiles) {
    const Scene<3> scene = packing_scene(options, file);
    std::string name = "$r$ = " + shortest(std::get<double>(scene.fills[0].radius));
    if (scene.fills.size() > 1) name += ", " + shortest(std::get<double>(scene.fills[1].radius));
    jobs.push_back({name, scene});
  }
  for (const std::size_t k : kShaken) {
    const double seconds = options.quick ? 1 : k == 0 ? 4 : 2;
    jobs.push_back({"shaken", shaken(jobs[k].scene, seconds)});
  }
  return run_packings(jobs, options, options.out / "fig9_density.csv");
}

/// The rows of (c).
std::vector<AxisRow> axis_rows(const std::vector<Packing>& packings, const Closest& closest) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<AxisRow> rows;
  for (std::size_t k = 0; k < kFiles.size(); ++k) {
    rows.push_back(
        {packings[k].name + " m", packings[k].final_density(), packings[k].bulk, kNone, kNone});
  }
  for (std::size_t s = 0; s < kShaken.size(); ++s) {
    const Packing& shook = packings[kFiles.size() + s];
    rows[kShaken[s]].shaken_piston = shook.final_density();
    rows[kShaken[s]].shaken_bulk = shook.bulk;
  }
  rows.push_back({"closest packing, run", kNone, closest.packing.bulk, kNone, kNone});
  return rows;
}

/// Edges of the triangulation per site, over the number of sites.
struct EdgeCounts {
  Series scenes, lines;  ///< of the packings; of two lines that cross
  Csv table;             ///< the same for a file
};

EdgeCounts count_edges(const std::vector<Packing>& packings, const Closest& closest, bool quick) {
  EdgeCounts counts{series_style(0), series_style(1), Csv("sites,edges_per_site[-],what")};
  counts.scenes.name = "packings";
  counts.scenes.marker = Marker::disc;
  counts.scenes.width = 0;
  counts.lines.name = "two crossing lines";
  counts.lines.marker = Marker::square;
  const auto note = [&](Series& series, double n, double edges, const std::string& what) {
    series.x.push_back(n);
    series.y.push_back(edges);
    counts.table.row(n, edges, what);
  };
  const auto note_packing = [&](const Packing& p, const std::string& what) {
    note(counts.scenes, static_cast<double>(p.radius.size()), p.edges_per_site, what);
  };
  for (const Packing& p : packings) note_packing(p, p.name);
  note_packing(closest.packing, "closest packing");
  for (int n = 50; n <= (quick ? 400 : 1600); n *= 2) {
    note(counts.lines, n, edges_per_site_on_two_lines(n), "two crossing lines");
  }
  return counts;
}

DisplayList page(const Closest& closest, const EdgeCounts& counts, const std::vector<AxisRow>& rows,
                 bool quick) {
  const double gap = 20, picture = 150, row_height = 176;
  DisplayList list{.width = style::kPage, .height = 350, .title = "lagrain, figure 9"};
  add_title(list, {0, list.height - 2}, "(a)");
  add_packing(list, {16, list.height - 12 - picture}, picture, closest.packing, ColourBy::height,
              quick, "face-centred cubic, at rest: " + rounded(closest.packing.bulk, 4));
  const double x = picture + 32 + gap;
  add_title(list, {x, list.height - 2}, "(b)");
  add_plot(list, {{x + 14, list.height - 12 - picture - 10}, {style::kPage, list.height - 8}},
           {.x = {.label = "sites", .log = true},
            .y = {.label = "edges per site", .log = true},
            .series = {counts.scenes, counts.lines},
            .legend = Corner::top_left});
  add_title(list, {0, row_height - 4}, "(c)");
  add_density_axis(list, {{16, 14}, {style::kPage - 6, row_height - 6}}, rows);
  add_key(list, {110, 5});
  return list;
}

}  // namespace

FigureResult draw_figure9(const FigureOptions& options) {
  const std::vector<Packing> packings = random_packings(options);
  const Closest closest = run_closest(options);
  const EdgeCounts counts = count_edges(packings, closest, options.quick);
  const DisplayList list = page(closest, counts, axis_rows(packings, closest), options.quick);
  write_file(options.out / "fig9_edges.csv", counts.table.text());
  paint_png(list, options.out / "fig9.png", 300);
  paint_pdf(list, options.out / "fig9.pdf");

  const auto [least, most] = std::minmax_element(counts.scenes.y.begin(), counts.scenes.y.end());
  FigureResult result;
  result.caption =
      "(a) The closest packing of equal spheres, " + std::to_string(closest.packing.radius.size()) +
      " of them in square layers, after " + rounded(kDuration, 2) +
      " s under its own weight. (b) Edges of the triangulation per site. (c) Densities of the "
      "packings of figures 6 and 7; random close packing after Scott & Kilgour, J. Phys. D 2 "
      "(1969) 863.";
  result.comparisons = {
      {"closest packing of equal spheres", "0.74048 (Hales)",
       rounded(closest.packing.bulk, 5) + " within, run through the engine (" +
           rounded(closest.start, 5) + " before it carried itself)"},
      {"edges per site (third claim: linear in practice, quadratic at worst)", "O(n), O(n^2)",
       rounded(*least, 3) + " to " + rounded(*most, 3) +
           " in all packings; n/4 + 1 on two crossing lines (" + rounded(counts.lines.y.back(), 4) +
           " for " + rounded(counts.lines.x.back(), 5) + ")"}};
  result.facts = packing_facts(packings);
  result.facts.push_back({"closest packing: largest move of a grain",
                          rounded(100 * closest.largest_move, 2) + " % of its radius"});
  result.facts.push_back({"closest packing: kinetic energy at the end",
                          rounded(closest.kinetic_share, 2) + " of weight times radius"});
  result.facts.push_back(
      {"closest packing: contacts audited, missed",
       std::to_string(closest.packing.audited) + ", " + std::to_string(closest.packing.missed)});
  result.pictures = {"fig9.png", "fig9.pdf"};
  result.downloads = {"fig9_density.csv", "fig9_edges.csv"};
  return result;
}

}  // namespace lagrain::figures
