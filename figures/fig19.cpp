// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 19 (report): impacts of one or two spheres, the eight tests of Chung & Ooi, "Benchmark
// tests for verifying discrete element modelling codes at particle impact level", Granular Matter
// 13 (2011) 643, beside Hertz's theory, the laws of momentum, and published numbers.
//
// Materials and speeds are those with which other codes repeat these tests: Yade (its merge request
// 933, tests 1 to 4), Kratos Multiphysics (DEM application, test_examples/basic_benchmarks) and
// scripts for PySPH (tests 5 to 8). What is drawn as published was read off that paper's diagrams
// by the authors of Kratos (there in paper_data, benchmarkN); here it has three digits.
//
// Writes fig19.png, fig19.pdf and fig19_impacts.csv; runs the scenes of figures/scenes/impacts.

#include "diagrams.hpp"
#include "impacts.hpp"
#include "trials.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/style.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

/// A point that was read off a published diagram.
struct Point {
  double x, y;
};

/// Test 4: angle [degrees] and tangential restitution as measured by Kharaz, Gorham & Salman,
/// Powder Technology 120 (2001) 281, with spheres of aluminium oxide (benchmark4_graph1).
constexpr Point kMeasured[]{{2.24, 0.797}, {4.22, 0.746}, {9.84, 0.675}, {20.2, 0.599},
                            {30.4, 0.690}, {39.5, 0.774}, {49.6, 0.848}, {71.1, 0.937},
                            {79.2, 0.970}, {85.2, 0.979}};
/// The same, angle and spin afterwards [rad/s] (benchmark4_graph2).
constexpr Point kMeasuredSpin[]{{5.90, 135}, {10.9, 261}, {21.1, 574}, {31.1, 612}, {39.0, 595},
                                {50.2, 450}, {60.1, 376}, {70.0, 243}, {78.6, 142}, {84.3, 70.6}};
/// Test 5: slip before over mu times the normal velocity, and the same afterwards, by finite
/// elements (benchmark5_graph1).
constexpr Point kFiniteElements[]{{0.272, -0.027}, {0.586, -0.027}, {0.876, -0.080}, {1.19, -0.213},
                                  {1.55, -0.373},  {1.92, -0.627},  {2.31, -0.947},  {2.79, -1.25},
                                  {3.32, -1.52},   {3.97, -1.72},   {4.76, -1.71},   {5.76, -1.20},
                                  {7.12, 0.133},   {9.12, 2.15},    {12.4, 5.43}};
/// Test 5: the same by the discrete elements of Chung & Ooi, steel (benchmark5_graph1).
constexpr Point kSpeedByDem[]{{0.332, -0.280}, {0.671, -0.493}, {1.01, -0.747}, {1.34, -1.00},
                              {1.66, -1.27},   {2.00, -1.53},   {2.35, -1.81},  {2.99, -2.44},
                              {3.34, -2.69},   {4.01, -2.79},   {5.00, -2.00},  {6.00, -1.01},
                              {9.99, 3.01},    {13.0, 6.01}};
/// Test 6: by the discrete elements of Chung & Ooi, aluminium alloy (benchmark6_graph1).
constexpr Point kSpinByDem[]{{0.176, -0.820}, {0.352, -0.633}, {0.551, -0.445}, {0.771, -0.243},
                             {0.969, -0.028}, {1.19, 0.097},   {1.45, 0.119},   {1.74, 0.100},
                             {2.09, 0.058},   {2.49, 0.005},   {3.00, -0.050},  {3.63, -0.100},
                             {4.52, -0.140},  {5.75, -0.175},  {7.82, -0.208},  {11.9, -0.258},
                             {24.0, -0.342}};
/// Test 8, case A: tangents of incidence and recoil, by the discrete elements of Chung & Ooi
/// (there in benchmark8_graph2).
constexpr Point kUnequalByDem[]{{0.166, 0.046}, {0.366, 0.112}, {0.573, 0.112}, {0.842, -0.019},
                                {1.00, -0.101}, {1.19, -0.297}, {1.43, -0.396}, {1.73, -0.412},
                                {2.14, 0.095},  {2.75, 1.31},   {3.72, 3.27},   {5.66, 7.15}};
/// Test 1, limestone, and test 2, magnesium alloy: largest force [N] (benchmark1, benchmark2).
constexpr double kForce1 = 7108, kForce2 = 7233;

constexpr double kUsualSteps = 25;  // to a contact, as scenes have them that name none
constexpr double kManySteps = 100;

double angle_of(const Impact& i) { return degrees(std::atan2(i.before.slip, i.before.approach)); }
double tangential_restitution(const Impact& i) { return i.after.across / i.before.across; }
double scaled_incidence(const Impact& i) {
  return i.before.slip / (i.law.friction * i.before.approach);
}
double scaled_recoil(const Impact& i) {
  return -i.after.slip / (i.law.friction * i.after.approach);
}
/// Of the normal impulse, what friction needs to end the slip over what it can give.
double grip(const Impact& i) {
  return 3.5 * i.law.friction * (1 + i.law.restitution) * i.before.approach / i.before.slip;
}
double slip_restitution(const Impact& i) { return -i.after.slip / i.before.slip; }
double tangent_before(const Impact& i) { return i.before.slip / i.before.approach; }
double tangent_after(const Impact& i) { return -i.after.slip / i.after.approach; }
double spin_before(const Impact& i) { return -i.before.spin; }
double spin_after(const Impact& i) { return -i.after.spin; }

using Quantity = double (*)(const Impact&);

/// Those of one upper and lower material, in order of x.
std::vector<Point> points(const Impacts& impacts, const std::string& upper, Quantity x, Quantity y,
                          const std::string& lower = "") {
  std::vector<Point> found;
  for (const Impact& impact : impacts.all) {
    if (impact.upper != upper || (!lower.empty() && impact.lower != lower)) continue;
    found.push_back({x(impact), y(impact)});
  }
  std::sort(found.begin(), found.end(), [](Point a, Point b) { return a.x < b.x; });
  return found;
}

Series series_of(std::span<const Point> points, Series style) {
  for (const Point& p : points) {
    style.x.push_back(p.x);
    style.y.push_back(p.y);
  }
  return style;
}

/// Marks of what was computed.
Series marks(int index, const std::string& name, std::span<const Point> points) {
  Series style = curve(index, name);
  style.width = 0;
  return series_of(points, style);
}

/// Marks of what others published.
Series published(Marker marker, const std::string& name, std::span<const Point> points) {
  return series_of(
      points,
      {.name = name, .x = {}, .y = {}, .colour = style::kFaint, .width = 0, .marker = marker});
}

/// A line of a closed form.
Series closed_form(const std::string& name, double low, double high,
                   const std::function<double(double)>& y) {
  constexpr int kParts = 120;
  Series line{.name = name, .x = {}, .y = {}, .colour = style::kInk, .width = style::kMedium};
  for (int k = 0; k <= kParts; ++k) {
    line.x.push_back(low + (high - low) * k / kParts);
    line.y.push_back(y(line.x.back()));
  }
  return line;
}

/// A line through the results of a run with small steps.
Series fine_line(const std::string& name, std::span<const Point> points) {
  return series_of(points, {.name = name,
                            .x = {},
                            .y = {},
                            .colour = style::kInk,
                            .width = style::kThin,
                            .dashes = {2, 1.5}});
}

/// Results between the points, straight.
double between(std::span<const Point> points, double x) {
  const auto after =
      std::find_if(points.begin() + 1, points.end() - 1, [x](const Point& p) { return p.x >= x; });
  const Point a = *(after - 1), b = *after;
  return a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
}

/// Root of the mean square of what run and measurement differ by.
double deviation(std::span<const Point> measured, std::span<const Point> run) {
  double sum = 0;
  for (const Point& p : measured) {
    const double d = between(run, p.x) - p.y;
    sum += d * d / static_cast<double>(measured.size());
  }
  return std::sqrt(sum);
}

constexpr std::array<const char*, 8> kScenes{"elastic_pair",  "elastic_plane", "restitution",
                                             "oblique_angle", "oblique_speed", "spin_on_plane",
                                             "spin_pair",     "spin_unequal"};

/// The eight tests with one number of steps to a contact.
using Tests = std::array<Impacts, kScenes.size()>;

/// A row of the table of errors, and a curve.
struct ErrorRow {
  std::string test, against;
  /// @param run, fine  the tests with some number of steps, and with the most
  std::function<double(const Tests& run, const Tests& fine)> error;
  bool drawn = false;
};

/// The root of the mean square over the impacts of one upper material (and lower one).
/// @param error  of an impact; negative ones are left out
double over(const Impacts& run, const std::string& upper, const std::string& lower,
            const std::function<double(const Impact&, std::size_t)>& error) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < run.all.size(); ++k) {
    const Impact& impact = run.all[k];
    if (!impact.upper.starts_with(upper) || !impact.lower.starts_with(lower)) continue;
    const double e = error(impact, k);
    if (e < 0) continue;
    sum += e * e;
    ++count;
  }
  return std::sqrt(sum / count);
}

std::vector<ErrorRow> error_rows() {
  std::vector<ErrorRow> rows;
  const auto hertz = [&](int test, const std::string& upper, bool drawn) {
    const auto t = static_cast<std::size_t>(test - 1);
    rows.push_back({std::to_string(test) + ", " + upper + ": largest force", "Hertz",
                    [=](const Tests& run, const Tests&) {
                      return over(run[t], upper, "", [](const Impact& i, std::size_t) {
                        return std::abs(i.largest_force() / hertz_impact(i).force - 1);
                      });
                    },
                    drawn});
    rows.push_back({std::to_string(test) + ", " + upper + ": duration", "Hertz",
                    [=](const Tests& run, const Tests&) {
                      return over(run[t], upper, "", [](const Impact& i, std::size_t) {
                        return std::abs(i.duration / hertz_impact(i).duration - 1);
                      });
                    },
                    false});
  };
  const auto oblique = [&](int test, const std::string& upper, const std::string& lower,
                           bool drawn) {
    const auto t = static_cast<std::size_t>(test - 1);
    const std::string name =
        std::to_string(test) + ", " + upper + (lower == "plane" ? "" : " on " + lower);
    rows.push_back({name + ", sliding: velocities", "momentum",
                    [=](const Tests& run, const Tests&) {
                      return over(run[t], upper, lower, [](const Impact& i, std::size_t) {
                        return slides(i) ? velocity_error(i, after_sliding(i)) : -1;
                      });
                    },
                    drawn});
    rows.push_back({name + ", sliding: spins", "momentum",
                    [=](const Tests& run, const Tests&) {
                      return over(run[t], upper, lower, [](const Impact& i, std::size_t) {
                        return slides(i) ? spin_error(i, after_sliding(i)) : -1;
                      });
                    },
                    false});
    rows.push_back({name + ", holding: velocities", "small steps",
                    [=](const Tests& run, const Tests& fine) {
                      return over(run[t], upper, lower, [&](const Impact& i, std::size_t k) {
                        return slides(i) || i.before.slip == 0
                                   ? -1
                                   : velocity_error(i, fine[t].all[k].after);
                      });
                    },
                    drawn});
  };
  hertz(1, "glass", true);
  hertz(2, "aluminium", false);
  rows.push_back({"3, oxide: restitution", "as named",
                  [](const Tests& run, const Tests&) {
                    return over(run[2], "oxide", "", [](const Impact& i, std::size_t) {
                      return std::abs(i.restitution() / i.law.restitution - 1);
                    });
                  },
                  true});
  oblique(4, "oxide", "plane", true);
  oblique(5, "steel", "plane", false);
  oblique(6, "alloy", "plane", false);
  oblique(7, "alloy", "alloy", false);
  oblique(8, "alloy", "A", false);
  return rows;
}

/// Runs all scenes; the impacts of those placed by hand begin at several phases of a step, and
/// their errors are taken over all of these.
Tests run_tests(double steps, const FigureOptions& options) {
  Tests tests;
  for (std::size_t t = 0; t < kScenes.size(); ++t) {
    options.progress(static_cast<double>(t) / kScenes.size(), std::string(kScenes[t]));
    const Scene<3> scene =
        read_scene<3>(options.scenes / "impacts" / (std::string(kScenes[t]) + ".toml"));
    tests[t] = run_impacts(scene, steps, options);
    if (scene.grains.empty()) continue;
    constexpr int kPhases = 8;
    for (int k = 1; k < kPhases; ++k) {
      const Impacts more = run_impacts(scene, steps, options, static_cast<double>(k) / kPhases);
      tests[t].all.insert(tests[t].all.end(), more.all.begin(), more.all.end());
      tests[t].missed += more.missed;
      tests[t].audited += more.audited;
    }
  }
  return tests;
}

std::vector<Point> moments_of(const Impact& impact, double ImpactMoment::*x, double unit) {
  std::vector<Point> all;
  for (const ImpactMoment& m : impact.moments) all.push_back({m.*x / unit, m.force / 1e3});
  return all;
}

/// Force against overlap, by Hertz.
Diagram overlap_diagram(const Impacts& run) {
  Diagram d{"(a) 1: two like spheres",
            {.x = {.label = "overlap [mm]", .low = 0},
             .y = {.label = "force [kN]", .low = 0},
             .series = {},
             .legend = Corner::top_left}};
  for (int k = 0; k < 2; ++k) {
    const Impact& impact = run.all[static_cast<std::size_t>(k)];
    d.plot.series.push_back(
        closed_form(k == 0 ? "Hertz" : "", 0, hertz_impact(impact).overlap * 1e3,
                    [&](double mm) { return hertz_force(impact, mm * 1e-3) / 1e3; }));
    d.plot.series.push_back(
        marks(k, impact.upper, moments_of(impact, &ImpactMoment::overlap, 1e-3)));
  }
  return d;
}

/// Force against time, by Hertz.
Diagram time_diagram(const Impacts& run) {
  Diagram d{"(b) 2: sphere and plane",
            {.x = {.label = "time [ms]", .low = 0},
             .y = {.label = "force [kN]", .low = 0},
             .series = {},
             .legend = Corner::top_right}};
  for (int k = 0; k < 2; ++k) {
    const Impact& impact = run.all[static_cast<std::size_t>(k)];
    const HertzImpact hertz = hertz_impact(impact);
    Series line{.name = k == 0 ? "Hertz" : "",
                .x = {},
                .y = {},
                .colour = style::kInk,
                .width = style::kMedium};
    constexpr int kParts = 60;
    for (int p = -kParts; p <= kParts; ++p) {
      const double overlap = hertz.overlap * (1 - std::pow(std::abs(p) / double{kParts}, 2));
      const double t = hertz_time(impact, overlap);
      line.x.push_back((p < 0 ? t : hertz.duration - t) * 1e3);
      line.y.push_back(hertz_force(impact, overlap) / 1e3);
    }
    d.plot.series.push_back(std::move(line));
    d.plot.series.push_back(marks(k, impact.upper, moments_of(impact, &ImpactMoment::time, 1e-3)));
  }
  leave_room_for_legend(d.plot);
  return d;
}

/// How far restitutions are from those that were named.
Diagram restitution_diagram(const Impacts& usual, const Impacts& finer) {
  Diagram d{"(c) 3: restitution",
            {.x = {.label = "restitution, as named", .low = 0, .high = 1.1},
             .y = {.label = "error [%]"},
             .series = {closed_form("", 0, 1.1, [](double) { return 0.0; })},
             .legend = Corner::top_right}};
  const auto add = [&](int index, const std::string& material, const Impacts& run) {
    std::vector<Point> errors;
    for (const Impact& i : run.all) {
      if (!i.upper.starts_with(material)) continue;
      errors.push_back({i.law.restitution, 100 * (i.restitution() / i.law.restitution - 1)});
    }
    d.plot.series.push_back(marks(index, material + ", " + rounded(run.steps) + " steps", errors));
  };
  add(0, "oxide", usual);
  add(1, "iron", usual);
  add(2, "oxide", finer);
  leave_room_for_legend(d.plot);
  return d;
}

Diagram angle_diagram(const Impacts& run, const Impacts& fine) {
  const LawNumbers& law = run.all.front().law;
  const double c = law.friction * (1 + law.restitution);
  const double onset = degrees(std::atan(3.5 * c));
  return {
      "(d) 4: one speed, different angles",
      {.x = {.label = "angle of incidence [degrees]", .low = 0, .high = 90},
       .y = {.label = "tangential restitution", .low = 0.25, .high = 1},
       .series = {closed_form("slides: momentum", onset, 89,
                              [c](double a) { return 1 - c / std::tan(a / degrees(1)); }),
                  fine_line("small steps", points(fine, "oxide", angle_of, tangential_restitution)),
                  published(Marker::ring, "measured", kMeasured),
                  marks(0, "oxide", points(run, "oxide", angle_of, tangential_restitution)),
                  marks(3, "alloy", points(run, "alloy", angle_of, tangential_restitution))},
       .legend = Corner::bottom_right}};
}

Diagram speed_diagram(const Impacts& run, const Impacts& fine) {
  const double e = run.all.front().law.restitution;
  return {"(e) 5: different tangential speed",
          {.x = {.label = "$v_s / (\\mu v_n)$ before", .low = 0, .high = 14},
           .y = {.label = "$v_s / (\\mu v_n)$ after", .low = -3.2, .high = 8},
           .series = {closed_form("", 3.5 * (1 + e), 13.5,
                                  [e](double x) { return (x - 3.5 * (1 + e)) / e; }),
                      fine_line("", points(fine, "steel", scaled_incidence, scaled_recoil)),
                      published(Marker::ring, "finite elements", kFiniteElements),
                      published(Marker::diamond, "Chung & Ooi", kSpeedByDem),
                      marks(0, "steel", points(run, "steel", scaled_incidence, scaled_recoil)),
                      marks(3, "polyethylene",
                            points(run, "polyethylene", scaled_incidence, scaled_recoil))},
           .legend = Corner::top_left}};
}

Diagram spin_diagram(const Impacts& run, const Impacts& fine) {
  return {"(f) 6: different spins, on a plane",
          {.x = {.label = "$3.5 \\mu (1 + e) v_n / v_s$", .log = true, .low = 0.15, .high = 30},
           .y = {.label = "slip after / before, reversed", .low = -1.6, .high = 0.7},
           .series = {closed_form("", 0.15, 1, [](double x) { return x - 1; }),
                      fine_line("", points(fine, "alloy", grip, slip_restitution)),
                      published(Marker::diamond, "Chung & Ooi, alloy", kSpinByDem),
                      marks(0, "alloy", points(run, "alloy", grip, slip_restitution)),
                      marks(3, "nylon", points(run, "nylon", grip, slip_restitution))},
           .legend = Corner::bottom_right}};
}

Diagram pair_diagram(const Impacts& run, const Impacts& fine) {
  const Impact& first = run.all.front();
  const double taken = 2.5 * 0.5 * first.law.friction * (1 + first.law.restitution) *
                       first.before.approach / first.radius;
  Impacts gears, rubbing, rubbing_fine;
  for (std::size_t k = 0; k < run.all.size(); ++k) {
    (run.all[k].before.slip == 0 ? gears : rubbing).all.push_back(run.all[k]);
    if (run.all[k].before.slip != 0) rubbing_fine.all.push_back(fine.all[k]);
  }
  std::vector<Point> all = points(gears, "alloy", spin_before, spin_after);
  const std::vector<Point> copper = points(gears, "copper", spin_before, spin_after);
  all.insert(all.end(), copper.begin(), copper.end());
  return {
      "(g) 7: two like spheres that spin",
      {.x = {.label = "spin before [rad/s]", .low = 0, .high = 21},
       .y = {.label = "spin after [rad/s]", .low = 0, .high = 28},
       .series = {closed_form("", 0, 20, [](double w) { return w; }),
                  closed_form("", 1.4 * taken, 20, [=](double w) { return w - taken; }),
                  fine_line("", points(rubbing_fine, "alloy", spin_before, spin_after)),
                  marks(1, "opposite, both metals", all),
                  marks(0, "equal, alloy", points(rubbing, "alloy", spin_before, spin_after)),
                  marks(3, "equal, copper", points(rubbing, "copper", spin_before, spin_after))},
       .legend = Corner::top_left}};
}

Diagram unequal_diagram(const Impacts& run, const Impacts& fine) {
  const LawNumbers& law = run.all.front().law;
  const double e = law.restitution, onset = 3.5 * law.friction * (1 + e);
  return {"(h) 8: two spheres 1 : 5 that spin",
          {.x = {.label = "$v_s / v_n$ before", .low = 0, .high = 6},
           .y = {.label = "$v_s / v_n$ after", .low = -1, .high = 8},
           .series = {closed_form("", onset, 6, [=](double x) { return (x - onset) / e; }),
                      fine_line("", points(fine, "alloy", tangent_before, tangent_after, "A")),
                      published(Marker::diamond, "Chung & Ooi, A", kUnequalByDem),
                      marks(0, "case A", points(run, "alloy", tangent_before, tangent_after, "A")),
                      marks(3, "case B", points(run, "alloy", tangent_before, tangent_after, "B"))},
           .legend = Corner::top_left}};
}

/// The tests with several numbers of steps to a contact, few first, and with so many that they
/// stand for none.
struct Runs {
  std::vector<Tests> some;
  Tests fine;

  const Tests& with(double steps) const {
    return *std::find_if(some.begin(), some.end(),
                         [steps](const Tests& tests) { return tests.front().steps == steps; });
  }
};

Runs run_all(const FigureOptions& options) {
  Runs runs{{}, run_tests(options.quick ? 400 : 3200, options)};
  for (const double steps : options.quick
                                ? std::vector<double>{kUsualSteps, kManySteps}
                                : std::vector<double>{16, kUsualSteps, 50, kManySteps, 200, 400}) {
    runs.some.push_back(run_tests(steps, options));
  }
  return runs;
}

/// Enters the errors into a table, and those that are to be drawn into a diagram.
std::pair<Table, Diagram> errors_of(const Runs& runs) {
  Table table{"Errors (root mean square over the impacts) against the steps to a contact",
              {"test", "against"},
              {}};
  Diagram diagram{"(i) errors",
                  {.x = {.label = "steps to a contact", .log = true},
                   .y = {.label = "error", .log = true},
                   .series = {},
                   .legend = Corner::top_right}};
  for (const Tests& run : runs.some) table.head.push_back(rounded(run.front().steps));
  for (const ErrorRow& row : error_rows()) {
    std::vector<std::string> cells{row.test, row.against};
    Series series = curve(static_cast<int>(diagram.plot.series.size()), row.test);
    for (const Tests& run : runs.some) {
      series.x.push_back(run.front().steps);
      series.y.push_back(row.error(run, runs.fine));
      cells.push_back(percent(series.y.back()));
    }
    table.rows.push_back(std::move(cells));
    if (row.drawn) diagram.plot.series.push_back(std::move(series));
  }
  leave_room_for_legend(diagram.plot);
  return {std::move(table), std::move(diagram)};
}

std::string csv_of(const Runs& runs) {
  Csv csv(
      "scene,upper,lower,steps[-],approach[m/s],slip[m/s],across[m/s],spin[rad/s],"
      "approach_after[m/s],slip_after[m/s],across_after[m/s],spin_after[rad/s],duration[s],"
      "largest_force[N]");
  const auto add = [&csv](const Tests& tests) {
    for (std::size_t t = 0; t < tests.size(); ++t) {
      for (const Impact& i : tests[t].all) {
        csv.row(std::string(kScenes[t]), i.upper, i.lower, tests[t].steps, i.before.approach,
                i.before.slip, i.before.across, i.before.spin, i.after.approach, i.after.slip,
                i.after.across, i.after.spin, i.duration, i.largest_force());
      }
    }
  };
  for (const Tests& run : runs.some) add(run);
  add(runs.fine);
  return csv.text();
}

double lowest(std::span<const Point> points) {
  return std::min_element(points.begin(), points.end(), [](Point a, Point b) { return a.y < b.y; })
      ->y;
}

double highest(std::span<const Point> points) {
  return std::max_element(points.begin(), points.end(), [](Point a, Point b) { return a.y < b.y; })
      ->y;
}

/// Those from x on.
std::span<const Point> from(double x, std::span<const Point> points) {
  return {std::find_if(points.begin(), points.end(), [x](const Point& p) { return p.x >= x; }),
          points.end()};
}

std::vector<Comparison> comparisons_of(const Tests& run) {
  const auto force = [&](std::size_t test) {
    const Impact& impact = run[test].all[1];
    return rounded(impact.largest_force(), 4) +
           " N (Hertz: " + rounded(hertz_impact(impact).force, 4) + " N)";
  };
  const auto restitutions = points(run[3], "oxide", angle_of, tangential_restitution);
  const auto spins =
      points(run[3], "oxide", angle_of, [](const Impact& i) { return i.after.spin; });
  const auto recoils = points(run[4], "steel", scaled_incidence, scaled_recoil);
  const auto slips = points(run[5], "alloy", grip, slip_restitution);
  const auto unequal = points(run[7], "alloy", tangent_before, tangent_after, "A");
  return {{"1, limestone: largest force", rounded(kForce1, 4) + " N", force(0)},
          {"2, magnesium alloy: largest force", rounded(kForce2, 4) + " N", force(1)},
          {"4, oxide: least tangential restitution (measured)", rounded(lowest(kMeasured)),
           rounded(lowest(restitutions))},
          {"4, oxide: largest spin afterwards (measured)",
           rounded(highest(kMeasuredSpin)) + " rad/s", rounded(highest(spins)) + " rad/s"},
          {"5, steel: lowest recoil (finite elements; Chung & Ooi's discrete elements)",
           rounded(lowest(kFiniteElements)) + "; " + rounded(lowest(kSpeedByDem)),
           rounded(lowest(recoils))},
          {"6, alloy: most of the slip that comes back (Chung & Ooi)", rounded(highest(kSpinByDem)),
           rounded(highest(slips))},
          {"8, case A: lowest recoil (Chung & Ooi)", rounded(lowest(kUnequalByDem)),
           rounded(lowest(unequal))}};
}

std::string caption_of(const Runs& runs, const Table& errors) {
  const auto cell = [&](const std::string& test) {
    const auto row = std::find_if(errors.rows.begin(), errors.rows.end(),
                                  [&](const auto& cells) { return cells.front() == test; });
    const auto column = std::find(errors.head.begin(), errors.head.end(), rounded(kUsualSteps));
    return (*row)[static_cast<std::size_t>(column - errors.head.begin())];
  };
  const Tests& usual = runs.with(kUsualSteps);
  const auto run = points(usual[3], "oxide", angle_of, tangential_restitution);
  const auto fine = points(runs.fine[3], "oxide", angle_of, tangential_restitution);
  constexpr double kSliding = 35;  // degrees: from there on all slide
  const std::span<const Point> measured(kMeasured);
  const std::span<const Point> holding =
      measured.first(measured.size() - from(kSliding, kMeasured).size());
  return "The eight tests of Chung & Ooi, Granular Matter 13 (2011) 643, by Hertz's law with "
         "elastic friction and " +
         rounded(kUsualSteps) +
         " steps to the shortest contact, as scenes have them. Solid lines are closed forms: "
         "Hertz's, and momentum where the surfaces slide all the time. Dashed: the same law with " +
         grouped(static_cast<std::int64_t>(runs.fine.front().steps)) +
         " steps. Grey marks are published ones. Forces and durations (a, b) are Hertz's to " +
         cell("1, glass: largest force") + " and " + cell("1, glass: duration") +
         ", restitutions (c) those named to " + cell("3, oxide: restitution") +
         ". Sliding impacts (d) keep momentum to " + cell("4, oxide, sliding: velocities") +
         " of the speed; spins are off by " + cell("4, oxide, sliding: spins") +
         " (e: " + cell("5, steel, sliding: spins") +
         "), because friction acts at the flattened surface, nearer to the centre than the radius. "
         "Where the contact holds, its spring leaves the step first order (i). Beyond " +
         rounded(kSliding) + " degrees the measured tangential restitution is met to " +
         rounded(deviation(from(kSliding, kMeasured), run), 2) + " (root mean square), below to " +
         rounded(deviation(holding, run), 2) + " (with small steps " +
         rounded(deviation(holding, fine), 2) +
         "): there the law is simpler than the contact, which slips at its rim first (Maw, Barber "
         "& Fawcett, Wear 38 (1976) 101). In (e) it lies on the other side of the finite elements "
         "than the discrete elements of the paper, whose law where contacts hold is not this one; "
         "that shows in (f) and (h), too. With a restitution of one half (f to h) the dashpot "
         "presses at once, so that the surfaces hold for a moment before they slide: what is left "
         "of the errors there with small steps is the law's. Spheres that spin like gears (g) keep "
         "their spins to the last bit.";
}

}  // namespace

FigureResult draw_figure19(const FigureOptions& options) {
  const Runs runs = run_all(options);
  const Tests& usual = runs.with(kUsualSteps);
  auto [table, convergence] = errors_of(runs);

  FigureResult result;
  draw_diagrams({overlap_diagram(usual[0]), time_diagram(usual[1]),
                 restitution_diagram(usual[2], runs.with(kManySteps)[2]),
                 angle_diagram(usual[3], runs.fine[3]), speed_diagram(usual[4], runs.fine[4]),
                 spin_diagram(usual[5], runs.fine[5]), pair_diagram(usual[6], runs.fine[6]),
                 unequal_diagram(usual[7], runs.fine[7]), convergence},
                3, 150, options, "fig19", result);
  write_file(options.out / "fig19_impacts.csv", csv_of(runs));
  result.downloads = {"fig19_impacts.csv"};
  result.caption = caption_of(runs, table);
  result.comparisons = comparisons_of(usual);
  result.tables = {std::move(table)};

  std::int64_t missed = 0, audited = 0;
  const auto count = [&](const Tests& tests) {
    for (const Impacts& impacts : tests) {
      missed += impacts.missed;
      audited += impacts.audited;
    }
  };
  for (const Tests& tests : runs.some) count(tests);
  count(runs.fine);
  result.facts = {{"contacts missed", grouped(missed) + " of " + grouped(audited)}};
  return result;
}

}  // namespace lagrain::figures
