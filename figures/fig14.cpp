// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 14 (report): moving the triangulation by flips against building it anew.
//
// (a), (b) Time of an update over that of a build, against the displacement. (c), (d) What an
// update has to do: the rungs of its ladder. The paper warns that the triangulation becomes
// unstable under large steps; here is how large. (e) to (j) The same in runs of shaken grains,
// against the skin and against the time step.

#include "dense_packing.hpp"
#include "diagrams.hpp"
#include "measure.hpp"

#include <lagrain/audit.hpp>
#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/random.hpp>
#include <lagrain/run.hpp>
#include <lagrain/spatial_order.hpp>
#include <lagrain/style.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

/// A function that is told what is being done; it shows that, and throws Interrupted once the user
/// wants to stop.
using Tell = std::function<void(const std::string& doing)>;

std::string of_dimension(int dim) { return dim == 2 ? "discs" : "spheres"; }

// ---- One update --------------------------------------------------------------------------------

constexpr std::array<double, 3> kShares{0.01, 0.1, 1};
constexpr std::array<double, 7> kDisplacements{1e-4, 1e-3, 1e-2, 0.1, 0.3, 1, 3};

/// Updates of one kind.
struct Updates {
  int dim;
  double share;         ///< of the sites that move [-]
  double displacement;  ///< of each of them [mean radii]
  int count = 0;
  std::int64_t moved = 0;
  double update = 0, build = 0;  ///< processor time, medians [s]
  UpdateReport ladder;           ///< of all updates
  std::int64_t different = 0;    ///< edges and hidden sites that a build has otherwise
};

template <int Dim>
struct Sites {
  Columns<Dim> x;
  Eigen::VectorXd weight;
  double radius = 0;  ///< mean
};

/// The sites of a dense packing, in the order of Hilbert's curve, as a run keeps its grains.
template <int Dim>
Sites<Dim> packed_sites(int count) {
  const std::vector<Grain<Dim>> grains = dense_packing<Dim>(count, 1);
  Columns<Dim> x(Dim, count);
  for (int i = 0; i < count; ++i) x.col(i) = grains[static_cast<std::size_t>(i)].position;
  const std::vector<int> order = spatial_order<Dim>(x);
  Sites<Dim> sites{x(Eigen::seqN(0, Eigen::fix<Dim>), order), Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    const double r = grains[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])].radius;
    sites.weight[i] = r * r;
    sites.radius += r / count;
  }
  return sites;
}

template <int Dim>
Vec<Dim> random_direction(Random& random) {
  Vec<Dim> direction;
  for (double& component : direction) component = random.normal();
  return direction.normalized();
}

template <class List>
std::int64_t differences(const List& a, const List& b) {
  std::vector<typename List::value_type> both;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return static_cast<std::int64_t>(both.size());
}

template <class F>
double seconds(F&& f) {
  const double start = bench::processor_seconds();
  f();
  return bench::processor_seconds() - start;
}

/// Every update starts from the packing as it was built, and is followed by a build of its result.
template <int Dim>
std::vector<Updates> measure_updates(int count, int rounds, const Tell& tell) {
  const std::string doing = "updates of " + of_dimension(Dim);
  tell(doing);
  const Sites<Dim> sites = packed_sites<Dim>(count);
  Triangulation<Dim> before, built;
  before.build(sites.x, sites.weight);

  std::vector<Updates> all;
  for (const double share : kShares) {
    for (const double displacement : kDisplacements)
      all.push_back({.dim = Dim, .share = share, .displacement = displacement, .ladder = {}});
  }
  std::vector<std::vector<double>> update_times(all.size()), build_times(all.size());
  std::vector<int> moved;
  for (int round = 0; round < rounds; ++round) {
    Random random(static_cast<std::uint64_t>(round));
    for (std::size_t k = 0; k < all.size(); ++k) {
      Updates& updates = all[k];
      Columns<Dim> x = sites.x;
      moved.clear();
      for (int i = 0; i < count; ++i) {
        if (random.uniform() >= updates.share) continue;
        x.col(i) += updates.displacement * sites.radius * random_direction<Dim>(random);
        moved.push_back(i);
      }
      Triangulation<Dim> updated = before;
      update_times[k].push_back(
          seconds([&] { updates.ladder += updated.move(moved, x, sites.weight); }));
      build_times[k].push_back(seconds([&] { built.build(x, sites.weight); }));
      updates.different += differences(updated.edges(), built.edges()) +
                           differences(updated.hidden(), built.hidden());
      updates.moved += static_cast<std::int64_t>(moved.size());
      ++updates.count;
      tell(doing);
    }
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].update = bench::median_of(update_times[k]);
    all[k].build = bench::median_of(build_times[k]);
  }
  return all;
}

/// Displacement at which an update of the share takes as long as a build, between two that were
/// measured; NaN if none does. [mean radii]
double break_even(const std::vector<Updates>& all, double share) {
  const Updates* last = nullptr;
  for (const Updates& u : all) {
    if (u.share != share) continue;
    if (u.update >= u.build) {
      if (last == nullptr) return u.displacement;
      const double from = std::log(last->update / last->build), to = std::log(u.update / u.build);
      return last->displacement *
             std::pow(u.displacement / last->displacement, -from / (to - from));
    }
    last = &u;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

Diagram time_diagram(const std::string& title, const std::vector<Updates>& all) {
  Plot plot{.x = {.label = "displacement [mean radii]", .log = true},
            .y = {.label = "update / build", .log = true},
            .series = {},
            .legend = Corner::top_left};
  for (std::size_t s = 0; s < kShares.size(); ++s) {
    Series series = curve(static_cast<int>(s), rounded(100 * kShares[s]) + " % moved");
    for (const Updates& u : all) {
      if (u.share != kShares[s]) continue;
      series.x.push_back(u.displacement);
      series.y.push_back(u.update / u.build);
    }
    plot.series.push_back(series);
  }
  plot.series.push_back({.name = "",
                         .x = {kDisplacements.front(), kDisplacements.back()},
                         .y = {1, 1},
                         .colour = style::kFaint,
                         .width = style::kThin});
  leave_room_for_legend(plot);
  return {title, plot};
}

Diagram ladder_diagram(const std::string& title, const std::vector<Updates>& all) {
  Plot plot{.x = {.label = "displacement [mean radii]", .log = true},
            .y = {.label = "in one update, per site", .log = true},
            .series = {},
            .legend = Corner::top_left};
  const bool plane = all.front().dim == 2;
  const std::array<std::pair<std::string, std::int64_t UpdateReport::*>, 4> rungs{
      {{"flips", &UpdateReport::flips},
       {"sites taken out", &UpdateReport::extracted},
       {plane ? "sites that flips cannot free" : "cavities filled anew", &UpdateReport::unstuck},
       {"rebuilds (per update)", &UpdateReport::rebuilds}}};
  for (std::size_t k = 0; k < rungs.size(); ++k) {
    Series series = curve(static_cast<int>(k), rungs[k].first);
    for (const Updates& u : all) {
      if (u.share != 1) continue;
      const double whole = static_cast<double>(k < 3 ? u.moved : u.count);
      series.x.push_back(u.displacement);
      series.y.push_back(static_cast<double>(u.ladder.*rungs[k].second) / whole);
    }
    if (std::any_of(series.y.begin(), series.y.end(), [](double y) { return y > 0; })) {
      plot.series.push_back(series);
    }
  }
  leave_room_for_legend(plot);
  return {title, plot};
}

// ---- In a run ----------------------------------------------------------------------------------

constexpr double kUsualSkin = Laziness{}.skin;
constexpr double kUsualFraction = TimeStep{}.fraction_of_contact;
constexpr std::array<double, 8> kSkins{0.1, 0.2, 0.4, 0.7, 1, kUsualSkin, 1.6, 2};
constexpr std::array<double, 5> kFractions{1.0 / 100, 1.0 / 50, kUsualFraction, 1.0 / 15,
                                           kLargestContactFraction};

/// What one run has cost.
struct RunCost {
  int dim;
  double skin;      ///< see Laziness [-]
  double fraction;  ///< time step over the shortest contact time [-]
  double grain_steps = 0;
  std::int64_t steps = 0;
  double processor_time = 0;  ///< [s]
  std::int64_t refreshes = 0;
  TriangulationCost triangulation;
  std::int64_t audited = 0, missed = 0;  ///< contacts
  double astray = 0;    ///< farthest from the run of the usual skin, at the end [m]
  double residual = 0;  ///< of the energy ledger, of the energy turned over [-]

  double per_thousand(std::int64_t count) const {
    return 1000 * static_cast<double>(count) / grain_steps;
  }
  double nanoseconds() const { return 1e9 * processor_time / grain_steps; }
};

/// What the ledger cannot account for, of the larger of what is stored and what has
/// been dissipated.
template <int Dim>
double relative_residual(const Run<Dim>& run) {
  const Ledger end = run.ledger();
  return std::abs(run.energy_residual()) /
         std::max(end.kinetic + end.elastic, end.dashpot + end.friction);
}

int shaken_count(bool quick) { return quick ? 200 : 500; }

/// Loose grains in a box without a lid that shakes with four times gravity: they are thrown, mixed
/// and compressed.
template <int Dim>
Scene<Dim> shaken_grains(bool quick, double fraction) {
  constexpr double kRadius = 0.01, kGravity = 9.81;
  const int across = Dim == 2 ? 30 : 8;
  const double width = 2.1 * kRadius * across;
  Scene<Dim> scene;
  scene.title = "Shaken grains";
  scene.duration = quick ? 0.06 : 0.2;
  scene.time_step.fraction_of_contact = fraction;
  scene.gravity = -kGravity * Vec<Dim>::Unit(Dim - 1);
  scene.friction = FrictionModel::elastic;
  scene.law.stiffness = Dim == 2 ? 1e6 : 1e4;
  scene.law.restitution = 0.5;
  scene.law.friction = 0.4;
  scene.materials = {{"stone", 2500}};
  Fill<Dim> fill;
  fill.name = "grains";
  fill.count = shaken_count(quick);
  fill.radius = UniformRadius{0.7 * kRadius, kRadius};
  fill.region.high = Vec<Dim>::Constant(width);
  scene.fills = {fill};
  const Vec<Dim> origin = Vec<Dim>::Zero();
  scene.walls = {Wall<Dim>::half_space("floor", origin, Vec<Dim>::Unit(Dim - 1))};
  for (int axis = 0; axis < Dim - 1; ++axis) {
    const Vec<Dim> across_it = Vec<Dim>::Unit(axis);
    scene.walls.push_back(Wall<Dim>::half_space("low", origin, across_it));
    scene.walls.push_back(Wall<Dim>::half_space("high", width * across_it, -across_it));
  }
  for (Wall<Dim>& wall : scene.walls) {
    wall.motion = Shake<Dim>{kRadius * Vec<Dim>::Unit(Dim - 1),
                             std::sqrt(4 * kGravity / kRadius) / (2 * std::numbers::pi)};
  }
  return scene;
}

/// Runs of all skins at the usual time step, and of all time steps at the usual skin, side by side.
template <int Dim>
std::vector<RunCost> measure_runs(bool quick, const Tell& tell) {
  constexpr int kSlices = 40;
  std::vector<RunCost> costs;
  for (const double skin : kSkins)
    costs.push_back({.dim = Dim, .skin = skin, .fraction = kUsualFraction, .triangulation = {}});
  for (const double fraction : kFractions) {
    if (fraction != kUsualFraction)
      costs.push_back({.dim = Dim, .skin = kUsualSkin, .fraction = fraction, .triangulation = {}});
  }
  std::vector<std::unique_ptr<Run<Dim>>> runs;
  for (const RunCost& cost : costs) {
    TriangulationNeighbourhood<Dim> neighbourhood(Laziness{.skin = cost.skin, .leap = false});
    runs.push_back(make_run(shaken_grains<Dim>(quick, cost.fraction),
                            AnyNeighbourhood<Dim>(std::move(neighbourhood))));
    runs.back()->use_threads(1);
  }
  std::vector<ContactAudit<Dim>> audits(runs.size());
  for (int slice = 1; slice <= kSlices; ++slice) {
    for (std::size_t k = 0; k < runs.size(); ++k) {
      Run<Dim>& run = *runs[k];
      costs[k].processor_time +=
          seconds([&] { run.advance_to(run.scene().duration * slice / kSlices); });
      audits[k].check(run.positions(), run.radii(), run.near_pairs());
      tell("shaken " + of_dimension(Dim));
    }
  }
  const auto usual = static_cast<std::size_t>(std::find(kSkins.begin(), kSkins.end(), kUsualSkin) -
                                              kSkins.begin());
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Run<Dim>& run = *runs[k];
    RunCost& cost = costs[k];
    cost.steps = run.steps();
    cost.grain_steps = static_cast<double>(run.count()) * static_cast<double>(run.steps());
    cost.refreshes = run.refreshes();
    cost.triangulation = *run.neighbourhood().cost();
    cost.audited = audits[k].contacts();
    cost.missed = audits[k].missed();
    cost.residual = relative_residual(run);
    if (cost.fraction == kUsualFraction) {
      cost.astray = (run.positions() - runs[usual]->positions()).colwise().norm().maxCoeff();
    }
  }
  return costs;
}

/// Chosen runs in the order of what is varied.
std::vector<RunCost> varied(std::vector<RunCost> costs, double RunCost::*axis) {
  std::erase_if(costs, [&](const RunCost& c) {
    return axis == &RunCost::skin ? c.fraction != kUsualFraction : c.skin != kUsualSkin;
  });
  std::sort(costs.begin(), costs.end(),
            [&](const RunCost& a, const RunCost& b) { return a.*axis < b.*axis; });
  return costs;
}

Axis axis_of(double RunCost::*axis) {
  return axis == &RunCost::skin ? Axis{.label = "skin factor"}
                                : Axis{.label = "time step / shortest contact time", .log = true};
}

Diagram cost_diagram(const std::string& title, const std::vector<RunCost>& costs,
                     double RunCost::*axis) {
  Plot plot{.x = axis_of(axis),
            .y = {.label = "per 1,000 grain-steps", .log = true},
            .series = {},
            .legend = axis == &RunCost::skin ? Corner::top_right : Corner::top_left};
  const std::array<std::pair<const char*, std::int64_t (*)(const TriangulationCost&)>, 5> kinds{
      {{"references moved", [](const TriangulationCost& c) { return c.moved; }},
       {"flips", [](const TriangulationCost& c) { return c.ladder.flips; }},
       {"sites taken out", [](const TriangulationCost& c) { return c.ladder.extracted; }},
       {"ends of failing edges", [](const TriangulationCost& c) { return c.shrunk; }},
       {"searched", [](const TriangulationCost& c) { return c.searched; }}}};
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    Series series = curve(static_cast<int>(k), kinds[k].first);
    for (const RunCost& cost : varied(costs, axis)) {
      series.x.push_back(cost.*axis);
      series.y.push_back(cost.per_thousand(kinds[k].second(cost.triangulation)));
    }
    if (std::any_of(series.y.begin(), series.y.end(), [](double y) { return y > 0; })) {
      plot.series.push_back(series);
    }
  }
  leave_room_for_legend(plot);
  return {title, plot};
}

/// @param per_contact_time  the time for as much of the motion, however many steps it takes
Diagram run_time_diagram(const std::string& title, const std::array<std::vector<RunCost>, 2>& costs,
                         double RunCost::*axis, bool per_contact_time) {
  Plot plot{.x = axis_of(axis),
            .y = {.label = per_contact_time ? "per grain and contact time [ns]"
                                            : "time per grain-step [ns]",
                  .log = true},
            .series = {},
            .legend = Corner::top_right};
  for (std::size_t k = 0; k < costs.size(); ++k) {
    Series series = curve(static_cast<int>(k), of_dimension(costs[k].front().dim));
    for (const RunCost& cost : varied(costs[k], axis)) {
      series.x.push_back(cost.*axis);
      series.y.push_back(cost.nanoseconds() / (per_contact_time ? cost.fraction : 1));
    }
    plot.series.push_back(series);
  }
  leave_room_for_legend(plot);
  return {title, plot};
}

// ---- Words -------------------------------------------------------------------------------------

/// "6 of 126 updates"
std::string fallen_back(const std::array<std::vector<Updates>, 2>& updates) {
  std::int64_t rebuilds = 0, count = 0;
  for (const std::vector<Updates>& all : updates) {
    for (const Updates& u : all) {
      rebuilds += u.ladder.rebuilds;
      count += u.count;
    }
  }
  return std::to_string(rebuilds) + " of " + std::to_string(count) + " updates";
}

void tell_updates(const std::array<std::vector<Updates>, 2>& measured, const FigureOptions& options,
                  FigureResult& result) {
  Csv times("dimension,share_moved[-],displacement[mean_radii],update[s],build[s],ratio[-]");
  Csv ladder(
      "dimension,share_moved[-],displacement[mean_radii],updates,moved,flips,taken_out,unstuck,"
      "put_back,rebuilds,differences_from_build");
  Table table{
      "Updates of the triangulation: time over that of a build; per moved site flips, sites taken "
      "out, unstuck; rebuilds",
      {"grains", "moved", "displacement [mean radii]", "update / build", "flips", "taken out",
       "unstuck", "rebuilds / updates", "edges unlike a build's"},
      {}};
  std::int64_t different = 0;
  for (const std::vector<Updates>& all : measured) {
    for (const Updates& u : all) {
      const UpdateReport& r = u.ladder;
      times.row(u.dim, u.share, u.displacement, u.update, u.build, u.update / u.build);
      ladder.row(u.dim, u.share, u.displacement, u.count, u.moved, r.flips, r.extracted, r.unstuck,
                 r.reinserted, r.rebuilds, u.different);
      const auto per_moved = [&](std::int64_t count) {
        return rounded(static_cast<double>(count) / static_cast<double>(u.moved));
      };
      table.rows.push_back({of_dimension(u.dim), rounded(100 * u.share) + " %",
                            rounded(u.displacement), rounded(u.update / u.build),
                            per_moved(r.flips), per_moved(r.extracted), per_moved(r.unstuck),
                            std::to_string(r.rebuilds) + " / " + std::to_string(u.count),
                            std::to_string(u.different)});
      different += u.different;
    }
  }
  write_file(options.out / "fig14_update.csv", times.text());
  write_file(options.out / "fig14_ladder.csv", ladder.text());
  result.facts.push_back({"fell back on a build", fallen_back(measured)});
  result.facts.push_back(
      {"edges and hidden sites in which an update and a build differ", std::to_string(different)});
  result.tables.push_back(table);
}

/// "1.8 (discs), 0.13 (spheres)"
std::string break_even_text(const std::array<std::vector<Updates>, 2>& updates, double share) {
  std::string text;
  for (const std::vector<Updates>& all : updates) {
    const double at = break_even(all, share);
    text += (text.empty() ? "" : ", ") +
            (std::isnan(at) ? "more than " + rounded(kDisplacements.back()) : rounded(at, 2)) +
            " (" + of_dimension(all.front().dim) + ")";
  }
  return text;
}

/// The dearest update, in builds.
double at_worst(const std::vector<Updates>& all) {
  double ratio = 0;
  for (const Updates& u : all) ratio = std::max(ratio, u.update / u.build);
  return ratio;
}

/// The range of skin factors whose steps cost at most a tenth more than the cheapest.
std::string cheap_skins(const std::vector<RunCost>& costs) {
  const std::vector<RunCost> runs = varied(costs, &RunCost::skin);
  double least = std::numeric_limits<double>::infinity();
  for (const RunCost& c : runs) least = std::min(least, c.nanoseconds());
  std::string first, last;
  for (const RunCost& c : runs) {
    if (c.nanoseconds() > 1.1 * least) continue;
    last = rounded(c.skin);
    if (first.empty()) first = last;
  }
  return first == last ? first : first + " to " + last;
}

/// The update of all sites by the given displacement.
const Updates& all_moved(const std::vector<Updates>& all, double displacement) {
  return *std::find_if(all.begin(), all.end(), [&](const Updates& u) {
    return u.share == 1 && u.displacement == displacement;
  });
}

std::string percent_taken_out(const Updates& u) {
  return percent(static_cast<double>(u.ladder.extracted) / static_cast<double>(u.moved));
}

std::string words(const std::array<std::vector<Updates>, 2>& updates,
                  const std::array<std::vector<RunCost>, 2>& runs, int discs, int spheres,
                  int grains) {
  constexpr double kLarge = 0.3;
  const auto& [plane, space] = updates;
  const std::vector<RunCost> steps = varied(runs[0], &RunCost::fraction);
  const RunCost &shortest_step = steps.front(), &longest_step = steps.back();
  const auto of_motion = [](const RunCost& c) { return c.nanoseconds() / c.fraction; };
  return "(a), (b) Processor time of an update by flips over that of a build, for a dense random "
         "packing of " +
         std::to_string(discs) + " discs and one of " + std::to_string(spheres) +
         " spheres; each site that moves goes the displacement in a direction of its own. (c), (d) "
         "What the update does when all move. (e) to (j) Runs of " +
         std::to_string(grains) +
         " grains thrown by a box that shakes with four times gravity, which T follows by flips "
         "alone here: otherwise it would leap, with wider skins. Every update was compared with "
         "the build that follows it, and contacts in the runs with those found from nothing: see "
         "below. Lesson: the displacement from which on a build is faster, in radii, is " +
         break_even_text(updates, 1) + " where all sites move, " + break_even_text(updates, 0.1) +
         " where 10 % do, and " + break_even_text(updates, 0.01) +
         " where 1 % do. The instability under large steps that Ferrez & Liebling warn of is "
         "there: when all move by " +
         rounded(kLarge) + " radii, " + percent_taken_out(all_moved(plane, kLarge)) +
         " of the discs and " + percent_taken_out(all_moved(space, kLarge)) +
         " of the spheres are taken out because a triangle or tetrahedron would turn inside out, "
         "and " +
         fallen_back(updates) + " fell back on a build; but it costs time only, at worst " +
         rounded(at_worst(plane), 2) + " builds for discs and " + rounded(at_worst(space), 2) +
         " for spheres. Runs stay far below: few references move at a time, whatever the time "
         "step. Skin factors of " +
         cheap_skins(runs[0]) + " (discs) and " + cheap_skins(runs[1]) +
         " (spheres) are within a tenth of the fastest. Long time steps move more references in "
         "each, but make the motion as a whole cheaper: discs by " +
         rounded(of_motion(shortest_step) / of_motion(longest_step), 2) + " from 1/" +
         rounded(1 / shortest_step.fraction) + " to 1/" + rounded(1 / longest_step.fraction) +
         " of the contact time, while the energy residual grows from " +
         rounded(100 * shortest_step.residual, 2) + " % to " +
         rounded(100 * longest_step.residual, 2) + " %.";
}

void tell_runs(const std::array<std::vector<RunCost>, 2>& measured, const FigureOptions& options,
               FigureResult& result) {
  Csv csv(
      "dimension,skin_factor[-],time_step[contact_times],steps,grain_steps,time_per_grain_step[ns],"
      "refreshes,references_moved,flips,taken_out,unstuck,put_back,rebuilds,shrunk,searched,"
      "contacts_audited,contacts_missed,astray[m],energy_residual[-]");
  Table table{"Runs of shaken grains, per 1,000 grain-steps; refreshes per 1,000 steps",
              {"grains", "skin factor", "time step [contact]", "ns / grain-step", "refreshes",
               "references moved", "flips", "taken out", "unstuck", "rebuilds",
               "ends of failing edges", "searched", "contacts missed / audited",
               "places unlike the usual skin's [m]", "energy residual"},
              {}};
  std::int64_t audited = 0, missed = 0, rebuilds = 0;
  double astray = 0;
  for (const std::vector<RunCost>& costs : measured) {
    for (const RunCost& c : costs) {
      const TriangulationCost& t = c.triangulation;
      csv.row(c.dim, c.skin, c.fraction, c.steps, c.grain_steps, c.nanoseconds(), c.refreshes,
              t.moved, t.ladder.flips, t.ladder.extracted, t.ladder.unstuck, t.ladder.reinserted,
              t.ladder.rebuilds, t.shrunk, t.searched, c.audited, c.missed, c.astray, c.residual);
      const auto share = [&](std::int64_t count) { return rounded(c.per_thousand(count)); };
      table.rows.push_back(
          {of_dimension(c.dim), rounded(c.skin), "1/" + rounded(1 / c.fraction),
           rounded(c.nanoseconds()),
           rounded(1000 * static_cast<double>(c.refreshes) / static_cast<double>(c.steps)),
           share(t.moved), share(t.ladder.flips), share(t.ladder.extracted),
           share(t.ladder.unstuck), std::to_string(t.ladder.rebuilds), share(t.shrunk),
           share(t.searched), std::to_string(c.missed) + " / " + std::to_string(c.audited),
           c.fraction == kUsualFraction ? rounded(c.astray) : "",
           rounded(100 * c.residual, 2) + " %"});
      audited += c.audited;
      missed += c.missed;
      rebuilds += t.ladder.rebuilds;
      astray = std::max(astray, c.astray);
    }
  }
  write_file(options.out / "fig14_run.csv", csv.text());
  result.facts.push_back(
      {"runs: contacts audited; missed", std::to_string(audited) + "; " + std::to_string(missed)});
  result.facts.push_back({"runs: rebuilds", std::to_string(rebuilds)});
  result.facts.push_back({"runs of other skins end elsewhere by at most", rounded(astray) + " m"});
  result.tables.push_back(table);
}

}  // namespace

FigureResult draw_figure14(const FigureOptions& options) {
  double done = 0;
  const Tell tell = [&](const std::string& doing) {
    options.check_stop();
    options.progress(done / 4, doing);
  };
  const int rounds = options.quick ? 1 : 3;
  const int discs = options.quick ? 1000 : 20000, spheres = options.quick ? 1000 : 10000;
  std::array<std::vector<Updates>, 2> updates;
  std::array<std::vector<RunCost>, 2> runs;
  updates[0] = measure_updates<2>(discs, rounds, tell);
  ++done;
  updates[1] = measure_updates<3>(spheres, rounds, tell);
  ++done;
  runs[0] = measure_runs<2>(options.quick, tell);
  ++done;
  runs[1] = measure_runs<3>(options.quick, tell);

  FigureResult result;
  result.caption = words(updates, runs, discs, spheres, shaken_count(options.quick));
  tell_updates(updates, options, result);
  tell_runs(runs, options, result);
  draw_diagrams({time_diagram("(a) discs: time of an update", updates[0]),
                 time_diagram("(b) spheres: time of an update", updates[1]),
                 ladder_diagram("(c) discs: what it does, all moved", updates[0]),
                 ladder_diagram("(d) spheres: what it does, all moved", updates[1])},
                2, 160, options, "fig14", result);
  draw_diagrams({cost_diagram("(e) shaken discs", runs[0], &RunCost::skin),
                 cost_diagram("(f) shaken spheres", runs[1], &RunCost::skin),
                 cost_diagram("(g) shaken discs", runs[0], &RunCost::fraction),
                 cost_diagram("(h) shaken spheres", runs[1], &RunCost::fraction),
                 run_time_diagram("(i) the whole step", runs, &RunCost::skin, false),
                 run_time_diagram("(j) the whole motion", runs, &RunCost::fraction, true)},
                2, 150, options, "fig14_run", result);
  result.downloads = {"fig14_update.csv", "fig14_ladder.csv", "fig14_run.csv"};
  return result;
}

}  // namespace lagrain::figures
