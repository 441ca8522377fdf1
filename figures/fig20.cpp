// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 20, of the report: bulk processes. A silo that empties, a drum that mixes, a ball that
// comes to rest in a bed, against laws of bulk flow and against what others have published.

#include "bulk.hpp"
#include "diagrams.hpp"
#include "together.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/style.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

// What others have got. Dosta et al. ran eight codes from beds that all of them shared; the public
// pages of peclet-examples (computational-chemical-engineering, benchmarks/dem-bulk-dosta2024)
// quote the mean over the codes, and list what MUSEN and LIGGGHTS gave from the same beds.
constexpr double kPublishedGrain = 0.004;                           // diameter in the silo [m]
constexpr double kPublishedLarge = 23200, kPublishedSpread = 0.05;  // D = 60 mm, mean [1/s]
constexpr double kPublishedSmall = 7700;                            // D = 40 mm, MUSEN [1/s]
constexpr double kPublishedFall = 0.0907;                     // of the ball, MUSEN and LIGGGHTS [m]
constexpr std::array<double, 2> kPublishedTroughs{1.4, 3.4};  // of M1 in zone 2, LIGGGHTS [s]
constexpr std::array<double, 2> kPublishedPeaks{17000, 12200};  // its two peaks
constexpr double kPublishedSmallGrains = 30000;                 // of M1 in the drum

constexpr double kYoungOverEffective = 2 * (1 - 0.2 * 0.2);  // E / E* at a Poisson ratio of 0.2
constexpr double kFastest = 0.6;                             // end of the map of speeds [m/s]

std::string millimetres(double metres, int digits = 3) {
  return rounded(1e3 * metres, digits) + " mm";
}

/// A number and its error, with the decimals that the error has: "0.58 ± 0.02".
std::string with_error(double value, double error) {
  const int decimals =
      error > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, 6) : 2;
  return fixed(value, decimals) + " ± " + fixed(error, decimals);
}

/// Which runs a figure needs: how many times as large as in the scenes the grains are, and how many
/// times as small the moduli. The published sizes, moduli and times would take days. What they
/// change is measured: sizes by the law, whose variable is D / d, moduli by the runs with half.
struct Plan {
  struct SiloJob {
    double coarse, orifice, soft, seconds;  ///< factors; [m]; [s] with an open gate
  };
  struct BallJob {
    double coarse, soft;
  };
  std::vector<SiloJob> silos;  ///< the first is drawn, the last is softer
  double drum = 1;             ///< how much coarser
  std::vector<BallJob> balls;  ///< the first is drawn; of the last two one is softer

  /// Which silo differs from the last one by its moduli alone.
  std::size_t stiff_silo() const {
    std::size_t k = 0;
    while (silos[k].coarse != silos.back().coarse || silos[k].orifice != silos.back().orifice) ++k;
    return k;
  }
};

Plan full_plan() {
  return {{{1.25, 0.06, 1, 0.7},
           {1.5, 0.04, 1, 1},
           {2, 0.06, 1, 1},
           {2, 0.07, 1, 0.8},
           {2, 0.06, 2, 1}},
          2,
          {{1.5, 1}, {2, 1}, {2, 2}}};
}

Plan quick_plan() {
  return {{{2.5, 0.06, 1, 1}, {2.5, 0.07, 1, 0.8}, {2.5, 0.08, 1, 0.6}, {2.5, 0.06, 2, 1}},
          4,
          {{3, 1}, {3, 2}}};
}

/// All runs of the figure.
struct Figure20 {
  Plan plan;
  std::vector<Silo> silos;
  Drum drum;
  std::vector<Penetration> balls;
  Beverloo law;
  ImpactLaw impact;

  /// D / d and W in the law's units, of the runs with the scene's moduli.
  std::pair<std::vector<double>, std::vector<double>> flows() const {
    std::pair<std::vector<double>, std::vector<double>> all;
    for (std::size_t k = 0; k < silos.size(); ++k) {
      if (plan.silos[k].soft != 1) continue;
      all.first.push_back(silos[k].orifice / silos[k].grain);
      all.second.push_back(flow_of(silos[k]));
    }
    return all;
  }
  static double flow_of(const Silo& silo) {
    return beverloo_flow(silo.rate, silo.grain, silo.solid);
  }
};

Figure20 make_figure20(const FigureOptions& options) {
  Figure20 figure;
  figure.plan = options.quick ? quick_plan() : full_plan();
  const Plan& plan = figure.plan;
  const auto silo = read_scene<3>(options.scenes / "silo_space.toml");
  const auto drum = read_scene<3>(options.scenes / "drum_space.toml");
  const auto ball = read_scene<3>(options.scenes / "penetration.toml");
  figure.silos.resize(plan.silos.size());
  figure.balls.resize(plan.balls.size());
  // The longest ones come first, so that all cores come to an end together.
  std::vector<std::function<void(const Watch&)>> pieces;
  pieces.push_back(
      [&](const Watch& watch) { figure.drum = run_drum(coarser(drum, plan.drum), watch); });
  for (std::size_t k = 0; k < plan.balls.size(); ++k) {
    pieces.push_back([&, k](const Watch& watch) {
      const Plan::BallJob& job = plan.balls[k];
      figure.balls[k] = run_penetration(softer(coarser(ball, job.coarse), job.soft), watch);
    });
  }
  for (std::size_t k = 0; k < plan.silos.size(); ++k) {
    pieces.push_back([&, k](const Watch& watch) {
      const Plan::SiloJob& job = plan.silos[k];
      Scene<3> scene = with_orifice(softer(coarser(silo, job.coarse), job.soft), job.orifice);
      scene.duration = gate_of(scene) + job.seconds;
      figure.silos[k] = run_silo(scene, watch);
    });
  }
  do_together(
      pieces.size(), [&](std::size_t k, const Watch& watch) { pieces[k](watch); }, options, "runs");
  const auto [x, y] = figure.flows();
  figure.law = fit_beverloo(x, y);
  figure.impact = fit_impact_law(figure.balls[0]);
  return figure;
}

// ---- Pictures ----------------------------------------------------------------------------------

/// What all pictures share: seen from the front, half of it cut away if `cut`.
Scene3 from_the_front(const Box3& box, bool cut, bool quick) {
  Scene3 scene;
  if (cut) scene.cuts.push_back({{0, -1, 0}, 0});
  scene.camera = camera_framing(box, {0, 1, cut ? -0.12 : 0}, {0, 0, 1}, 1, 0, 0.01);
  scene.lights = over_the_shoulder(scene.camera);
  scene.subframes = quick ? kVideoSubframes : kPrintSubframes;
  return scene;
}

void add_line(Scene3& scene, const Vec<3>& a, const Vec<3>& b) {
  scene.lines.push_back({a, b, {style::kWall, style::kMedium}});
}

Scene3 silo_scene(const Silo& silo, bool quick) {
  const double wide = 0.1, lip = silo.orifice / 2 - wide;
  Scene3 scene = from_the_front({{-wide, 0, lip - 0.045}, {wide, 0, lip + 0.155}}, true, quick);
  for (Eigen::Index i = 0; i < silo.radius.size(); ++i) {
    scene.balls.push_back({silo.position.col(i), silo.radius[i],
                           colour(ColourMap::viridis, silo.speed[i] / kFastest)});
  }
  for (const double side : {-1.0, 1.0}) {
    add_line(scene, {side * wide, 0, lip + 0.15}, {side * wide, 0, 0});
    add_line(scene, {side * wide, 0, 0}, {side * silo.orifice / 2, 0, lip});
  }
  return scene;
}

constexpr Colour kSmallGrains{222, 170, 60, 255}, kLargeGrains{60, 92, 140, 255};

Scene3 drum_scene(const Drum& drum, const Columns<3>& x, bool quick) {
  constexpr double kRadius = 0.1;
  Scene3 scene = from_the_front({{-kRadius, 0, -kRadius}, {kRadius, 0, kRadius}}, false, quick);
  for (Eigen::Index i = 0; i < drum.radius.size(); ++i) {
    const bool large = drum.material[static_cast<std::size_t>(i)] == 1;
    scene.balls.push_back({x.col(i), drum.radius[i], large ? kLargeGrains : kSmallGrains});
  }
  constexpr int kSides = 120;
  const auto on_rim = [](int k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
    return Vec<3>(kRadius * std::cos(angle), -0.031, kRadius * std::sin(angle));
  };
  for (int k = 0; k < kSides; ++k) add_line(scene, on_rim(k), on_rim(k + 1));
  return scene;
}

/// Neighbouring layers differ in lightness, so that they part in grey print too.
Colour layer_colour(double layer) {
  constexpr int kLayers = 8;
  const int k = std::clamp(static_cast<int>(layer * kLayers), 0, kLayers - 1);
  const Colour base = colour(ColourMap::viridis, (k + 0.5) / kLayers);
  return k % 2 == 0 ? base : mix(base, style::kPaper, 0.35);
}

Scene3 crater_scene(const Penetration& p, bool quick) {
  Scene3 scene = from_the_front({{-0.075, 0, -0.01}, {0.075, 0, 0.14}}, true, quick);
  scene.balls.push_back({p.position.col(0), p.radius[0], {110, 108, 116, 255}});
  for (Eigen::Index i = 1; i < p.radius.size(); ++i) {
    scene.balls.push_back({p.position.col(i), p.radius[i], layer_colour(p.layer[i])});
  }
  for (const double side : {-0.05, 0.05}) add_line(scene, {side, 0, 0}, {side, 0, 0.135});
  add_line(scene, {-0.05, 0, 0}, {0.05, 0, 0});
  return scene;
}

// ---- Diagrams ----------------------------------------------------------------------------------

Series line_of(int index, const std::string& name, std::vector<double> x, std::vector<double> y) {
  Series series = series_style(index);
  series.name = name;
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

Series points_of(Marker marker, Colour tint, const std::string& name, std::vector<double> x,
                 std::vector<double> y) {
  return {.name = name,
          .x = std::move(x),
          .y = std::move(y),
          .colour = tint,
          .width = 0,
          .marker = marker};
}

Plot silo_plot(const Figure20& figure) {
  Plot plot{.x = {.label = "time since the gate is gone [s]", .low = 0},
            .y = {.label = "share of the grains above the orifice", .low = 0, .high = 1.02},
            .series = {},
            .legend = Corner::bottom_left};
  const auto millimetre = [](double metres) { return rounded(1e3 * metres, 2); };
  for (std::size_t k = 0; k < figure.silos.size(); ++k) {
    const Silo& silo = figure.silos[k];
    std::vector<double> share;
    for (const double left : silo.left) share.push_back(left / silo.report.grains);
    const bool soft = figure.plan.silos[k].soft != 1;
    Series series = line_of(
        static_cast<int>(k),
        "D " + millimetre(silo.orifice) + ", d " + millimetre(silo.grain) + (soft ? ", E/2" : ""),
        silo.time, share);
    if (soft) {
      series.colour = style::kInk;
      series.dashes = {0.5, 4};
      series.width = style::kThick;
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot beverloo_plot(const Figure20& figure) {
  auto [x, flow] = figure.flows();
  std::vector<double> y;
  for (const double w : flow) y.push_back(std::pow(w, 0.4));
  const double slope = std::pow(figure.law.c, 0.4), k = figure.law.k;
  const double end = std::max(15.0, *std::max_element(x.begin(), x.end())) + 1;
  // Where the others' solid fraction is not known it is taken to be ours.
  const double solid = figure.silos[0].solid;
  const auto published = [&](double rate) {
    return std::pow(beverloo_flow(rate, kPublishedGrain, solid), 0.4);
  };
  Plot plot{.x = {.label = "orifice over grain, D/d", .low = 0, .high = end},
            .y = {.label = "$(W / \\rho g^{1/2} d^{5/2})^{2/5}$", .low = 0},
            .series = {},
            .legend = Corner::top_left};
  plot.series.push_back(line_of(1, "fit: C " + fixed(figure.law.c, 2) + ", k " + fixed(k, 2),
                                {k, end}, {0, slope * (end - k)}));
  plot.series.push_back(
      line_of(3, "C 0.58, k 1.4", {1.4, end}, {0, std::pow(0.58, 0.4) * (end - 1.4)}));
  plot.series.push_back(points_of(Marker::disc, style::kInk, "lagrain", x, y));
  plot.series.push_back(
      points_of(Marker::square, style::kContact, "published",
                {0.04 / kPublishedGrain, 0.06 / kPublishedGrain, 0.06 / kPublishedGrain},
                {published(kPublishedSmall), published(kPublishedLarge * (1 - kPublishedSpread)),
                 published(kPublishedLarge * (1 + kPublishedSpread))}));
  leave_room_for_legend(plot);
  plot.y.low = 0;
  return plot;
}

Plot mixing_plot(const Drum& drum) {
  Plot plot{.x = {.label = "time since the drum turns [s]", .low = 0, .high = 5},
            .y = {.label = "share of a kind in a zone", .low = 0},
            .series = {},
            .legend = Corner::top_right};
  for (std::size_t zone = 0; zone < 2; ++zone) {
    for (std::size_t kind = 0; kind < 2; ++kind) {
      std::vector<double> share;
      for (const double n : drum.count[kind][zone]) share.push_back(n / drum.grains[kind]);
      Series series =
          line_of(static_cast<int>(2 * zone + kind),
                  std::string(kind == 0 ? "M1" : "M2") + ", zone " + std::to_string(zone + 1),
                  drum.time, share);
      series.colour = kind == 0 ? mix(kSmallGrains, style::kInk, 0.15) : kLargeGrains;
      series.dashes = zone == 0 ? std::vector<double>{3, 2} : std::vector<double>{};
      plot.series.push_back(std::move(series));
    }
  }
  plot.series.push_back(points_of(Marker::square, style::kContact, "published troughs",
                                  {kPublishedTroughs[0], kPublishedTroughs[1]}, {0, 0}));
  leave_room_for_legend(plot);
  plot.y.low = -0.02;
  return plot;
}

Plot torque_plot(const Drum& drum) {
  std::vector<double> torque, weight, both;
  for (std::size_t k = 0; k < drum.time.size(); ++k) {
    torque.push_back(1e3 * drum.torque[k]);
    weight.push_back(1e3 * drum.weight[k]);
    both.push_back(1e3 * (drum.weight[k] + drum.momentum[k]));
  }
  Plot plot{.x = {.label = "time since the drum turns [s]", .low = 0, .high = 5},
            .y = {.label = "torque [N mm]"},
            .series = {line_of(0, "by the drum", drum.time, torque),
                       line_of(1, "$m g R$ sin $\\alpha$", drum.time, weight),
                       line_of(2, "and $dL/dt$", drum.time, both)},
            .legend = Corner::top_right};
  leave_room_for_legend(plot);
  return plot;
}

Plot fall_plot(const Figure20& figure) {
  Plot plot{.x = {.label = "time since the release [s]", .low = 0, .high = 0.1},
            .y = {.label = "fall of the ball [mm]"},
            .series = {},
            .legend = Corner::bottom_right};
  for (std::size_t k = 0; k < figure.balls.size(); ++k) {
    const Penetration& p = figure.balls[k];
    std::vector<double> fall;
    for (const double h : p.height) fall.push_back(1e3 * (kRelease - h));
    plot.series.push_back(line_of(static_cast<int>(k),
                                  "d = " + rounded(2e3 * p.report.radius, 2) + " mm" +
                                      (figure.plan.balls[k].soft == 1 ? "" : ", E / 2"),
                                  p.time, fall));
  }
  const double published = 1e3 * kPublishedFall;
  Series rest = line_of(0, "published, at rest", {0, 0.1}, {published, published});
  rest.colour = style::kContact;
  rest.dashes = {1, 2};
  plot.series.push_back(std::move(rest));
  return plot;
}

Plot impact_plot(const Figure20& figure) {
  const Penetration& p = figure.balls[0];
  std::vector<double> depth, speed, law;
  for (std::size_t k = 0; k < p.time.size(); ++k) {
    depth.push_back(1e3 * p.depth(k));
    speed.push_back(p.speed[k]);
  }
  for (const double z : figure.impact.depth) law.push_back(1e3 * z);
  return {.x = {.label = "depth of the ball's underside [mm]", .low = 0},
          .y = {.label = "speed [m/s]", .low = 0, .high = 6.5},
          .series = {line_of(0, "lagrain", depth, speed),
                     line_of(1, "$m a = m g - m v^2/l - \\kappa z$", law, figure.impact.speed)},
          .legend = Corner::top_right};
}

// ---- The page ----------------------------------------------------------------------------------

DisplayList page(const Figure20& figure, bool quick) {
  constexpr double kGap = 10, kTitleRoom = 16, kPlotHeight = 150, kPlotGap = 14;
  const double side = (style::kPage - 3 * kGap) / 4;
  const double width = (style::kPage - 2 * kPlotGap) / 3;
  DisplayList list{.width = style::kPage,
                   .height = side + kTitleRoom + 2 * (kPlotHeight + kTitleRoom) + 8,
                   .title = "lagrain, figure 20"};
  const double low = list.height - kTitleRoom - side;
  const auto picture = [&](int column, const std::string& title, const Scene3& scene) {
    const double x = column * (side + kGap);
    const Box box{{x, low}, {x + side, low + side}};
    list.add(paint_scene3(scene, box));
    list.add(Label{.text = title, .at = {x, low + side + 5}, .size = style::kTitle});
  };
  picture(0, "(a) silo", silo_scene(figure.silos[0], quick));
  add_colour_bar(list, {{4, low + 2}, {8, low + 26}}, ColourMap::viridis, 0, kFastest, "m/s");
  picture(1, "(b) drum at the start", drum_scene(figure.drum, figure.drum.before, quick));
  picture(2, "(c) drum after 5 s", drum_scene(figure.drum, figure.drum.after, quick));
  picture(3, "(d) ball at rest", crater_scene(figure.balls[0], quick));
  const auto kind = [&](double down, Colour tint, const std::string& name) {
    const Vec<2> at(2 * side + kGap - 13, low + side - down);
    list.add(Disc{at, 2.5, tint});
    list.add(Label{
        .text = name, .at = {at[0] + 5, at[1]}, .size = style::kSmallText, .along = Along::middle});
  };
  kind(2, kSmallGrains, "M1");
  kind(10, kLargeGrains, "M2");
  const auto plot = [&](int place, const std::string& title, const Plot& content) {
    const double x = (place % 3) * (width + kPlotGap);
    const double y = low - 8 - (place / 3 + 1) * (kPlotHeight + kTitleRoom);
    add_plot(list, {{x, y}, {x + width, y + kPlotHeight}}, content);
    list.add(Label{.text = title, .at = {x, y + kPlotHeight + 5}, .size = style::kTitle});
  };
  plot(0, "(e) the silo empties", silo_plot(figure));
  plot(1, "(f) the drum mixes", mixing_plot(figure.drum));
  plot(2, "(g) the ball sinks", fall_plot(figure));
  plot(3, "(h) Beverloo's law", beverloo_plot(figure));
  plot(4, "(i) torque of the drum", torque_plot(figure.drum));
  plot(5, "(j) speed against depth", impact_plot(figure));
  return list;
}

// ---- What the numbers say ----------------------------------------------------------------------

/// When a curve is lowest [time], and how high it rises afterwards.
struct Swing {
  double trough = 0;
  double peak = 0;
};

/// The swings of a curve that falls to about 0, rises, and falls again. A trough is the middle of
/// the time that is spent below 5 % of the curve's largest value.
std::vector<Swing> swings_of(const std::vector<double>& time, const std::vector<double>& y) {
  const double low = 0.05 * *std::max_element(y.begin(), y.end());
  std::vector<Swing> swings;
  bool below = false;
  double since = 0;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (y[k] < low && !below) since = time[k];
    if (y[k] >= low && below) swings.push_back({(since + time[k]) / 2, 0});
    below = y[k] < low;
    if (!swings.empty()) swings.back().peak = std::max(swings.back().peak, y[k]);
  }
  return swings;
}

/// Mean torque over the last turns, and how far off the balance of angular momentum is.
struct TorqueBalance {
  double torque = 0, weight = 0;  ///< means from kFrom on [N m]
  double error = 0;               ///< root mean square of the difference over the mean torque [-]
  static constexpr double kFrom = 1;  ///< [s]
};

TorqueBalance balance_of(const Drum& drum) {
  TorqueBalance b;
  double n = 0, squares = 0;
  for (std::size_t k = 1; k < drum.time.size(); ++k) {
    squares += std::pow(drum.torque[k] - drum.weight[k] - drum.momentum[k], 2);
    if (drum.time[k] < TorqueBalance::kFrom) continue;
    b.torque += drum.torque[k];
    b.weight += drum.weight[k];
    ++n;
  }
  b.torque /= n;
  b.weight /= n;
  b.error = std::sqrt(squares / static_cast<double>(drum.time.size() - 1)) / b.torque;
  return b;
}

struct NamedReport {
  std::string name;
  const RunReport* report;
};

std::vector<NamedReport> reports_of(const Figure20& figure) {
  std::vector<NamedReport> all;
  for (const Silo& silo : figure.silos) {
    all.push_back({"silo, D = " + millimetres(silo.orifice, 2), &silo.report});
  }
  all.push_back({"drum", &figure.drum.report});
  for (const Penetration& ball : figure.balls) all.push_back({"ball in a bed", &ball.report});
  return all;
}

Table runs_table(const Figure20& figure) {
  Table table{.title = "The runs, each on one core",
              .head = {"run", "grains", "smallest d", "E of M1", "time step", "grain-steps",
                       "grain-steps per second", "largest overlap", "residual of the ledger",
                       "contacts audited", "missed"},
              .rows = {}};
  for (const auto& [name, r] : reports_of(figure)) {
    table.rows.push_back({name, grouped(r->grains), millimetres(2 * r->radius),
                          rounded(kYoungOverEffective * 1e-6 * r->modulus, 2) + " MPa",
                          rounded(1e6 * r->time_step) + " us", rounded(r->grain_steps),
                          rounded(r->grain_steps / r->seconds), percent(r->largest_overlap),
                          percent(r->residual), grouped(r->audited), grouped(r->missed)});
  }
  return table;
}

/// How much a number of a softer run differs from that of another one: "-3 %".
std::string change(double softer, double other) {
  return (softer < other ? "" : "+") + percent(softer / other - 1);
}

Table published_table(const Figure20& figure) {
  Table table{.title = "Published numbers and these runs",
              .head = {"quantity", "published", "here"},
              .rows = {}};
  const auto add = [&](const std::string& quantity, const std::string& theirs,
                       const std::string& ours) {
    table.rows.push_back({quantity, theirs, ours});
  };
  const auto by_law = [&](double orifice) {
    const double flow =
        figure.law.c * std::pow(std::max(0.0, orifice / kPublishedGrain - figure.law.k), 2.5);
    return grouped(std::lround(flow / beverloo_flow(1, kPublishedGrain, figure.silos[0].solid)));
  };
  add("grains of 4 mm per second through 60 mm",
      "23,200, mean of eight codes, which agree within 5 %; MUSEN 24,200, LIGGGHTS 24,500",
      by_law(0.06) + " by the law fitted here");
  add("the same through 40 mm", "MUSEN 7,700", by_law(0.04) + " by the law fitted here");
  add("Beverloo's constants", "C 0.58, k 1.4 for a flat bottom",
      "C " + with_error(figure.law.c, figure.law.c_error) + ", k " +
          with_error(figure.law.k, figure.law.k_error) + " for the funnel of 45 degrees");
  std::string troughs, peaks;
  for (const Swing& swing : swings_of(figure.drum.time, figure.drum.count[0][1])) {
    const double share = swing.peak / figure.drum.grains[0];
    troughs += (troughs.empty() ? "" : ", ") + fixed(swing.trough, 2) + " s";
    peaks += (peaks.empty() ? "" : ", ") + percent(share);
  }
  add("drum: when zone 2 is empty of M1",
      "LIGGGHTS " + fixed(kPublishedTroughs[0], 1) + " s, " + fixed(kPublishedTroughs[1], 1) + " s",
      troughs.empty() ? "never, with grains as large as these" : troughs);
  add("share of M1 there at its peaks",
      "LIGGGHTS " + percent(kPublishedPeaks[0] / kPublishedSmallGrains) + ", " +
          percent(kPublishedPeaks[1] / kPublishedSmallGrains),
      peaks.empty() ? "none" : peaks);
  const Penetration& ball = figure.balls[0];
  add("fall of the ball until it rests, bed of 100,000",
      "MUSEN and LIGGGHTS " + millimetres(kPublishedFall),
      millimetres(kRelease - ball.height.back()) + " in " + grouped(ball.report.grains - 1) +
          " grains");
  return table;
}

void write_numbers(const Figure20& figure, const FigureOptions& options, FigureResult& result) {
  const auto save = [&](const std::string& name, const Csv& csv) {
    write_file(options.out / name, csv.text());
    result.downloads.push_back(name);
  };
  Csv silo("orifice[m],grain[m],softer[-],time[s],left[-]");
  Csv flow("orifice[m],grain[m],softer[-],solid[-],rate[1/s],rate_error[1/s],flow[-]");
  for (std::size_t k = 0; k < figure.silos.size(); ++k) {
    const Silo& s = figure.silos[k];
    const double soft = figure.plan.silos[k].soft;
    flow.row(s.orifice, s.grain, soft, s.solid, s.rate, s.rate_error, Figure20::flow_of(s));
    for (std::size_t i = 0; i < s.time.size(); ++i) {
      silo.row(s.orifice, s.grain, soft, s.time[i], s.left[i]);
    }
  }
  save("fig20_silo.csv", silo);
  save("fig20_flow.csv", flow);
  Csv drum(
      "time[s],m1_zone1[-],m1_zone2[-],m2_zone1[-],m2_zone2[-],torque[N m],weight[N m],"
      "momentum_rate[N m]");
  const Drum& d = figure.drum;
  for (std::size_t i = 0; i < d.time.size(); ++i) {
    drum.row(d.time[i], d.count[0][0][i], d.count[0][1][i], d.count[1][0][i], d.count[1][1][i],
             d.torque[i], d.weight[i], d.momentum[i]);
  }
  save("fig20_drum.csv", drum);
  Csv ball("grain[m],softer[-],time[s],height[m],depth[m],speed[m/s]");
  for (std::size_t k = 0; k < figure.balls.size(); ++k) {
    const Penetration& p = figure.balls[k];
    for (std::size_t i = 0; i < p.time.size(); ++i) {
      ball.row(2 * p.report.radius, figure.plan.balls[k].soft, p.time[i], p.height[i], p.depth(i),
               p.speed[i]);
    }
  }
  save("fig20_ball.csv", ball);
}

std::string caption_of(const Figure20& figure) {
  const Silo& silo = figure.silos[0];
  const Penetration& ball = figure.balls[0];
  const TorqueBalance torque = balance_of(figure.drum);
  return "Three bulk processes with the materials, the walls and the conditions of Dosta et al., "
         "Computer Physics Communications 296 (2024) 109066. Beds are ours, and all moduli are a "
         "hundredth of the published ones, those of the ball and its bed a fiftieth. (a) A silo "
         "with a funnel of 45 degrees, D = " +
         millimetres(silo.orifice, 2) + ", " + fixed(kSiloPicture, 1) +
         " s after its gate is gone; cut in half, colours are speeds. (b, c) A drum of 200 mm at 2 "
         "rad/s from its front, " +
         grouped(figure.drum.grains[0]) + " small grains of M1 and " +
         grouped(figure.drum.grains[1]) + " large ones of M2, " + rounded(figure.plan.drum, 2) +
         " times as large as published. (d) A steel ball of 20 mm, 0.1 s after its release at 5 "
         "m/s, in " +
         grouped(ball.report.grains - 1) + " grains of " + millimetres(2 * ball.report.radius) +
         ", " + millimetres(ball.depth(ball.time.size() - 1)) +
         " deep; cut in half, colours are layers before the impact. (e) Grains above the orifice; "
         "D and d in mm. (f) Grains in the quadrant above the rising side of the drum (zone 1) and "
         "in the opposite one (zone 2). (g) Fall of the ball since it was 150.2 mm above the "
         "floor. (h) Flow in the units of Beverloo's law, with the bulk density that the bed had "
         "at rest. What is called published are the mean of the paper's codes and runs of MUSEN "
         "and LIGGGHTS from its beds, in grains of the published sizes, as the public pages of "
         "peclet-examples quote and list them. (i) The torque of the drum is the moment of the "
         "grains' weight (R: distance of the centre of mass from the axis, alpha: its angle from "
         "below) and the change of their angular momentum L: root mean square difference " +
         percent(torque.error) + " of the mean torque, " + rounded(1e3 * torque.torque) +
         " N mm; the weight's mean moment is " + rounded(1e3 * torque.weight) +
         " N mm. (j) Speed of the ball against depth, and the force law of Katsuragi and Durian, "
         "Nature Physics 3 (2007) 420, with l = " +
         millimetres(figure.impact.length) +
         " and kappa / m = " + rounded(figure.impact.stiffness) +
         " / s^2 fitted: kinetic energy to " + percent(figure.impact.worst) + " of the first.";
}

}  // namespace

FigureResult draw_figure20(const FigureOptions& options) {
  const Figure20 figure = make_figure20(options);
  FigureResult result;
  write_numbers(figure, options, result);
  const DisplayList list = page(figure, options.quick);
  paint_png(list, options.out / "fig20.png", 300);
  paint_pdf(list, options.out / "fig20.pdf");
  result.pictures = {"fig20.png", "fig20.pdf"};
  result.caption = caption_of(figure);
  result.tables = {published_table(figure), runs_table(figure)};

  double grain_steps = 0, seconds = 0, overlap = 0, residual = 0;
  std::int64_t audited = 0, missed = 0;
  for (const auto& [name, r] : reports_of(figure)) {
    grain_steps += r->grain_steps;
    seconds += r->seconds;
    overlap = std::max(overlap, r->largest_overlap);
    residual = std::max(residual, r->residual);
    audited += r->audited;
    missed += r->missed;
  }
  const Silo& hard = figure.silos[figure.plan.stiff_silo()];
  const Silo& soft = figure.silos.back();
  const Penetration& hard_ball = figure.balls[figure.balls.size() - 2];
  const Penetration& soft_ball = figure.balls.back();
  result.facts = {
      {"all runs", rounded(grain_steps) + " grain-steps in " + rounded(seconds) +
                       " s of one core: " + rounded(grain_steps / seconds) +
                       " a second, audits included"},
      {"solid fraction of the beds at rest",
       "silo " + rounded(figure.silos[0].solid) + ", box " + rounded(figure.balls[0].solid)},
      {"half the modulus", "flow " + change(soft.rate, hard.rate) + " (errors " +
                               percent(hard.rate_error / hard.rate) + " and " +
                               percent(soft.rate_error / soft.rate) + "), depth of the ball " +
                               change(soft_ball.depth(soft_ball.time.size() - 1),
                                      hard_ball.depth(hard_ball.time.size() - 1))},
      {"contacts audited; missed", grouped(audited) + "; " + grouped(missed)},
      {"largest overlap at any sample", percent(overlap) + " of the smaller radius"},
      {"largest residual of the ledger", percent(residual) + " of what was dissipated"}};
  for (const char* scene : {"silo_space.toml", "drum_space.toml", "penetration.toml"}) {
    result.downloads.push_back(options.scenes / scene);
  }
  return result;
}

}  // namespace lagrain::figures
