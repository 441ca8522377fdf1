// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 17 (report): Box2D and lagrain in bulk, by integrals, because single paths of many discs
// are chaotic: what a heap looks like, how deep discs overlap at rest, how fast a hopper empties.
//
// Both engines get the same grains in the same places, one friction and one restitution. Overlaps
// are found from places alone, by code that belongs to neither. Springs are as stiff as it takes to
// overlap as much as Box2D does, and stiffer ones are swept.

#include "box2d_world.hpp"
#include "diagrams.hpp"
#include "measure.hpp"
#include "rigid.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr double kFriction = 0.5, kRestitution = 0.2;
constexpr double kSample = 1.0 / 60;        // of what is observed on the way [s]
constexpr double kLast = 1;                 // of what is averaged at the end [s]
constexpr double kMass = std::numbers::pi;  // of a disc of 1 m [kg]

/// Box2D for what comes to rest. It does not search for collisions within a step: the time for that
/// grows with the square of the number of discs. It keeps its own threshold for bounces, or every
/// step of gravity would bounce.
Box2dSettings box2d(int rate, int velocity_iterations = 8, int position_iterations = 3) {
  return {.time_step = 1.0 / rate,
          .velocity_iterations = velocity_iterations,
          .position_iterations = position_iterations,
          .continuous = false,
          .bounce_above = 1};
}

/// Springs that carry the weight of so many discs of 1 m with an overlap [m].
LagrainSettings springs(double discs, double overlap) {
  return {.stiffness = discs * kMass * kGameGravity / overlap};
}

/// A scene with friction in the game's units.
Scene<2> rough_scene() {
  Scene<2> scene = game_scene();
  scene.friction = FrictionModel::elastic;
  scene.law.friction = kFriction;
  scene.law.restitution = kRestitution;
  scene.law.tangential_damping = 0.2;
  return scene;
}

/// An open box from x = 0 on.
void add_box(Scene<2>& scene, double width, double floor = 0) {
  scene.walls.push_back(Wall<2>::half_space("floor", {0, floor}, {0, 1}));
  scene.walls.push_back(Wall<2>::half_space("left", {0, 0}, {1, 0}));
  scene.walls.push_back(Wall<2>::half_space("right", {width, 0}, {-1, 0}));
}

constexpr double kSmallest = 0.8, kLargest = 1.2;  // radii of beds [m]
constexpr double kCell = 2.05 * kLargest;          // of a lattice of them [m]

/// Loose rows of so many discs, with their lowest side at a height.
Fill<2> rows(int count, int across, double bottom = 0) {
  return {.name = "rows",
          .count = count,
          .radius = UniformRadius{kSmallest, kLargest},
          .region = {{0, bottom}, {across * kCell, bottom + (count / across + 2) * kCell}}};
}

/// Loose rows that fall to the floor of a box.
Scene<2> bed(int count, int across) {
  Scene<2> scene = rough_scene();
  add_box(scene, across * kCell);
  scene.fills = {rows(count, across)};
  return scene;
}

/// About so many discs of sizes from 1 to the ratio, each size with the same share of the area,
/// loosely packed; their mean radius is 1 m.
Scene<2> mixture(int count, double width, double ratio = 10) {
  constexpr double kSolid = 0.75;
  std::vector<double> sizes;  // large ones are placed first
  for (const double power : {1.0, 0.8, 0.6, 0.3, 0.0}) sizes.push_back(std::pow(ratio, power));
  double weights = 0;
  for (const double size : sizes) weights += 1 / (size * size);
  Scene<2> scene = rough_scene();
  add_box(scene, width);
  double sum = 0, area = 0, all = 0;
  for (const double size : sizes) {
    const double share = std::round(count / (size * size * weights));
    scene.fills.push_back({.name = "size " + rounded(size),
                           .count = static_cast<int>(share),
                           .radius = size,
                           .region = {},
                           .arrangement = Arrangement::random});
    all += share;
    sum += share * size;
    area += share * std::numbers::pi * size * size;
  }
  const double unit = all / sum;
  for (Fill<2>& fill : scene.fills) {
    fill.radius = unit * std::get<double>(fill.radius);
    fill.region.high = {width, unit * unit * area / (kSolid * width)};
  }
  return scene;
}

/// Discs of which the last weighs so many times as much, one on the other.
Scene<2> heavy_on_light(int light, double ratio) {
  constexpr double kRoom = 1e-3;
  Scene<2> scene = game_scene();
  scene.law.restitution = kRestitution;
  add_box(scene, 2 * (1 + kRoom));
  scene.materials.push_back({"heavy", ratio});
  for (int k = 0; k <= light; ++k) {
    scene.grains.push_back(
        {.position = {1 + kRoom, 2.0 * k + 1}, .radius = 1, .material = k == light ? 1 : 0});
  }
  return scene;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// "12.3 +- 0.4"
std::string with_deviation(const std::vector<double>& values, int digits = 3) {
  return rounded(mean_of(values), digits) + " ± " + rounded(deviation_of(values), 1);
}

/// How a bed came to rest, or did not.
struct Settled {
  Overlaps rest;              ///< at the end
  double peak = 0;            ///< largest overlap on the way [-]
  double kinetic = 0;         ///< per disc, at the end [m g r]
  double height = 0;          ///< of the centre of mass [r]
  std::vector<double> loads;  ///< on all walls in the last second, of the weight [-]
  double cost = 0;            ///< processor time over simulated time, the median of the samples [-]
};

Settled settle(const Scene<2>& scene, const EngineSettings& settings, double seconds,
               const FigureOptions& options) {
  const auto engine = make_engine(scene, settings);
  Settled result;
  std::vector<double> costs;
  while (engine->time() < seconds) {
    const double from = engine->time();
    const double spent = advance_to(*engine, from + kSample, options);
    costs.push_back(spent / (engine->time() - from));
    result.rest = overlaps_of(engine->positions(), engine->radii(), scene.walls);
    result.peak = std::max(result.peak, result.rest.largest);
    if (engine->time() > seconds - kLast) result.loads.push_back(wall_load(*engine, scene));
  }
  result.cost = bench::median_of(costs);
  const Eigen::ArrayXd m = engine->masses(), r = engine->radii();
  const Columns<2> v = engine->velocities();
  const Columns<1> omega = engine->spins();
  const double kinetic = 0.5 * (m * (v.colwise().squaredNorm().transpose().array() +
                                     0.5 * r.square() * omega.row(0).transpose().array().square()))
                                   .sum();
  result.kinetic = kinetic / (m.sum() * scene.gravity.norm() * r.mean());
  result.height = engine->positions().row(1).dot(m.matrix()) / (m.sum() * r.mean());
  return result;
}

/// What a column that has collapsed looks like.
struct Heap {
  double front = 0;    ///< which 99 % of the discs have not passed [m]
  double height = 0;   ///< of the centre of mass [m]
  double kinetic = 0;  ///< [m g r]
  Overlaps overlaps;
  std::vector<double> profile;  ///< area of discs per width, in bins [m]
  double cost = 0;
};

constexpr double kBin = 0.05;  // of the profile [m]

Heap collapse(const Scene<2>& scene, const EngineSettings& settings, const FigureOptions& options) {
  const auto engine = make_engine(scene, settings);
  Heap heap;
  heap.cost = advance_to(*engine, scene.duration, options) / scene.duration;
  const Columns<2> x = engine->positions();
  const Eigen::VectorXd& r = engine->radii();
  const Eigen::VectorXd& m = engine->masses();
  std::vector<double> across(x.row(0).begin(), x.row(0).end());
  std::sort(across.begin(), across.end());
  heap.front = across[static_cast<std::size_t>(0.99 * static_cast<double>(across.size() - 1))];
  heap.height = x.row(1).dot(m) / m.sum();
  heap.kinetic = 0.5 * engine->velocities().colwise().squaredNorm().dot(m) /
                 (m.sum() * scene.gravity.norm() * r.mean());
  heap.overlaps = overlaps_of(x, r, scene.walls);
  heap.profile.assign(static_cast<std::size_t>(across.back() / kBin) + 1, 0);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const auto bin = static_cast<std::size_t>(std::max(0.0, x(0, i)) / kBin);
    heap.profile[bin] += std::numbers::pi * r[i] * r[i] / kBin;
  }
  return heap;
}

/// A hopper: a funnel of two planks with a gap, a box below that holds everything.
Scene<2> hopper(int count, int across, double gap) {
  const double width = across * kCell, slope = 0.5 * (width - gap);  // at 45 degrees
  const double deep = 1.3 * count * std::numbers::pi / width;
  Scene<2> scene = rough_scene();
  add_box(scene, width, -deep);
  scene.walls.push_back(Wall<2>::segment("left plank", {0, slope}, {slope, 0}));
  scene.walls.push_back(Wall<2>::segment("right plank", {width, slope}, {width - slope, 0}));
  scene.fills = {rows(count, across, slope)};
  return scene;
}

/// How a hopper empties.
struct Discharge {
  std::vector<double> time, fallen;  ///< [s], share of the discs [-]
  double rate = 0;                   ///< between 20 and 70 % [1/s]
  double peak = 0;                   ///< largest overlap on the way [-]
  double cost = 0;
};

Discharge empty(const Scene<2>& scene, const EngineSettings& settings, double seconds,
                const FigureOptions& options) {
  constexpr double kFrom = 0.2, kTo = 0.7;
  const auto engine = make_engine(scene, settings);
  const auto count = static_cast<double>(engine->radii().size());
  Discharge flow;
  double from = std::numeric_limits<double>::quiet_NaN(), to = from, first = from, last = from;
  while (engine->time() < seconds) {
    flow.cost += advance_to(*engine, engine->time() + kSample, options) / seconds;
    const Columns<2> x = engine->positions();
    const double share = static_cast<double>((x.row(1).array() < 0).count()) / count;
    flow.time.push_back(engine->time());
    flow.fallen.push_back(share);
    flow.peak = std::max(flow.peak, overlaps_of(x, engine->radii(), scene.walls).largest);
    if (std::isnan(from) && share >= kFrom) from = engine->time(), first = share;
    if (std::isnan(to) && share >= kTo) to = engine->time(), last = share;
  }
  flow.rate = (last - first) * count / (to - from);
  return flow;
}

/// Share of start phases in which a fast disc passes untouched through a row of its like that
/// nothing holds.
struct Passage {
  double share = 0;    ///< that passes
  bool stops = false;  ///< the engine refused to go on, in some phase
};

constexpr double kBulletRadius = 0.25;  // [m]; Box2D moves nothing by more than 2 m in a step

Passage shoot(double speed, EngineSettings settings, int phases, const FigureOptions& options) {
  constexpr double r = kBulletRadius, kFlight = 4;  // [m], before the row
  Scene<2> scene = game_scene();
  scene.gravity.setZero();
  scene.law.restitution = 0.5;
  scene.grains = {{.position = {0, 0}, .radius = r, .velocity = {speed, 0}}};
  for (int k = -4; k <= 4; ++k) scene.grains.push_back({.position = {0, 2 * r * k}, .radius = r});
  if (auto* box2d = std::get_if<Box2dSettings>(&settings)) box2d->mean_radius = r;
  scene.grains[0].position.x() = -kFlight;
  const double step = make_engine(scene, settings)->time_step();
  Passage passage;
  for (int k = 0; k < phases; ++k) {
    scene.grains[0].position.x() = -kFlight - (k + 0.5) / phases * speed * step;
    const auto engine = make_engine(scene, settings);
    try {
      advance_to(*engine, 2 * kFlight / speed + 2 * step, options);
    } catch (const SimulationError&) {
      passage.stops = true;
      continue;
    }
    if (engine->velocities()(0, 0) > 0.999 * speed) passage.share += 1.0 / phases;
  }
  return passage;
}

/// The table, the CSV, and where the figure stands.
class Report {
 public:
  Report(const FigureOptions& options, double parts) : options_(options), parts_(parts) {}

  /// Tells what is being done; to be called once for each of the parts.
  void begin(const std::string& scene, const EngineSettings& settings) {
    options_.progress(part_++ / parts_, scene + ": " + name_of(settings));
  }
  void row(const std::string& scene, const EngineSettings& settings, const Settled& s) {
    add(scene, settings,
        {rounded(s.rest.mean, 2), rounded(s.rest.largest, 2), rounded(s.peak, 2),
         rounded(s.kinetic, 1), with_deviation(s.loads, 4),
         rounded(s.rest.coordination) + " contacts, centre at " + rounded(s.height, 4) + " r"},
        s.cost);
    note(scene, settings, "mean_overlap[-]", s.rest.mean);
    note(scene, settings, "largest_overlap[-]", s.rest.largest);
    note(scene, settings, "peak_overlap[-]", s.peak);
    note(scene, settings, "kinetic[mgr]", s.kinetic);
    note(scene, settings, "load[-]", mean_of(s.loads));
    note(scene, settings, "load_deviation[-]", deviation_of(s.loads));
    note(scene, settings, "coordination[-]", s.rest.coordination);
    note(scene, settings, "centre[r]", s.height);
    note(scene, settings, "cost[s/s]", s.cost);
    note_escaped(settings, s.rest.escaped);
  }
  void note_escaped(const EngineSettings& settings, int discs) {
    escaped_[is_box2d(settings)] += discs;
  }
  void add(const std::string& scene, const EngineSettings& settings, std::vector<std::string> cells,
           double cost) {
    cells.insert(cells.begin(), {scene, name_of(settings)});
    cells.push_back(rounded(cost, 2));
    table_.rows.push_back(std::move(cells));
  }
  void note(const std::string& scene, const EngineSettings& settings, const std::string& quantity,
            double value) {
    csv_.row(scene, name_of(settings), quantity, value);
  }
  std::string escaped() const {
    return "Box2D " + std::to_string(escaped_[1]) + ", lagrain " + std::to_string(escaped_[0]);
  }
  const Table& table() const { return table_; }
  const Csv& csv() const { return csv_; }

 private:
  const FigureOptions& options_;
  double parts_, part_ = 0;
  std::array<int, 2> escaped_{};  // of lagrain, of Box2D
  Table table_{"Both engines in bulk; overlaps in smaller radii",
               {"scene", "engine and setting", "mean overlap", "largest", "on the way",
                "kinetic energy [m g r]", "force on walls over weight", "integrals",
                "processor s per simulated s"},
               {}};
  Csv csv_{"scene,engine,quantity,value"};
};

// ---- Panels ------------------------------------------------------------------------------------

/// The k-th curve of an engine.
Series curve_of(const EngineSettings& settings, int k, const std::string& name) {
  Series series = curve(k, name);
  series.colour = category(is_box2d(settings) ? 1 : 0);
  return series;
}

Diagram collapse_panel(Report& report, const FigureOptions& options) {
  const std::string name = "column collapse";
  const int seeds = options.quick ? 1 : 3, count = options.quick ? 150 : 500;
  Scene<2> scene = read_scene<2>(options.scenes / "column_collapse.toml");
  scene.audit = false;
  scene.largest_overlap = 0.5;  // a soft heap is measured, too
  scene.fills[0].count = count;
  scene.fills[0].region.high = {count * 0.25e-3, 1.2};  // about as slender as the scene's own [m]
  if (options.quick) scene.duration *= 0.5;
  Diagram diagram{"(a) collapse of " + std::to_string(count) + " discs",
                  {.x = {.label = "from the wall [m]", .low = 0},
                   .y = {.label = "area of discs per width [m]", .low = 0},
                   .series = {},
                   .legend = Corner::top_right}};
  const std::vector<std::pair<std::string, EngineSettings>> contestants{
      {"Box2D, 1/60 s", box2d(60)},
      {"Box2D, 1/240 s", box2d(240)},
      {"lagrain, soft", LagrainSettings{scene.law.stiffness / 5}},
      {"lagrain, as the scene", LagrainSettings{scene.law.stiffness}},
      {"lagrain, stiff", LagrainSettings{10 * scene.law.stiffness}}};
  for (std::size_t c = 0; c < contestants.size(); ++c) {
    const auto& [label, settings] = contestants[c];
    report.begin(name, settings);
    std::vector<double> front, height, kinetic, overlap, cost, profile;
    Scene<2> repeated = scene;
    for (int seed = 0; seed < seeds; ++seed) {
      repeated.seed = scene.seed + static_cast<std::uint64_t>(seed);
      const Heap heap = collapse(repeated, settings, options);
      front.push_back(heap.front);
      height.push_back(heap.height);
      kinetic.push_back(heap.kinetic);
      overlap.push_back(heap.overlaps.mean);
      report.note_escaped(settings, heap.overlaps.escaped);
      cost.push_back(heap.cost);
      profile.resize(std::max(profile.size(), heap.profile.size()), 0);
      for (std::size_t b = 0; b < heap.profile.size(); ++b) profile[b] += heap.profile[b] / seeds;
      report.note(name, settings, "front[m]", heap.front);
      report.note(name, settings, "centre[m]", heap.height);
    }
    Series series = curve_of(settings, static_cast<int>(c < 2 ? c : c - 2), label);
    series.marker = Marker::none;
    for (std::size_t b = 0; b < profile.size(); ++b) {
      series.x.push_back((static_cast<double>(b) + 0.5) * kBin);
      series.y.push_back(profile[b]);
      report.note(name, settings, "profile[m] at " + rounded(series.x.back()) + " m", profile[b]);
    }
    diagram.plot.series.push_back(series);
    report.add(
        name, settings,
        {rounded(mean_of(overlap), 2), "", "", rounded(mean_of(kinetic), 1), "",
         "99 % within " + with_deviation(front) + " m, centre at " + with_deviation(height) + " m"},
        mean_of(cost));
  }
  double highest = 0;
  for (const Series& series : diagram.plot.series) {
    highest = std::max(highest, *std::max_element(series.y.begin(), series.y.end()));
  }
  diagram.plot.y.high = 1.5 * highest;  // room for the legend
  return diagram;
}

/// The cost at which a curve of falling errors has this error, between its points along a power
/// law; NaN outside.
double cost_at(const Series& curve, double error) {
  for (std::size_t k = 1; k < curve.x.size(); ++k) {
    if (!(curve.y[k] <= error && error <= curve.y[k - 1])) continue;
    const double t = std::log(error / curve.y[k - 1]) / std::log(curve.y[k] / curve.y[k - 1]);
    return curve.x[k - 1] * std::pow(curve.x[k] / curve.x[k - 1], t);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// Overlaps of a bed at rest, and on the way to it, against time.
std::vector<Diagram> settling_panels(Report& report, const FigureOptions& options,
                                     FigureResult& result) {
  const int count = options.quick ? 200 : 1000, across = options.quick ? 14 : 32;
  const double seconds = options.quick ? 3 : 10;
  const Scene<2> scene = bed(count, across);
  const std::string name = std::to_string(count) + " discs settle";
  const auto panel = [&](const std::string& title, const std::string& axis) {
    return Diagram{title,
                   {.x = {.label = "processor s per simulated s", .log = true},
                    .y = {.label = axis, .log = true},
                    .series = {},
                    .legend = Corner::top_right}};
  };
  std::vector<Diagram> panels{panel("(b) " + name, "mean overlap at rest [$r$]"),
                              panel("(c) on their way to rest", "largest overlap [$r$]")};
  std::vector<EngineSettings> all{box2d(60), box2d(240), box2d(60, 20, 10)};
  std::vector<double> overlaps{1e-2, 1e-3};
  // Curves go through some of them.
  std::vector<std::pair<std::string, std::vector<std::size_t>>> curves{
      {"Box2D, steps", {0, 1}}, {"Box2D, iterations", {0, 2}}, {"lagrain, stiffness", {}}};
  if (!options.quick) {
    all = {box2d(60), box2d(120), box2d(240), box2d(480), box2d(60, 20, 10), box2d(60, 50, 20)};
    curves[0].second = {0, 1, 2, 3};
    curves[1].second = {0, 4, 5};
    overlaps = {2e-2, 7e-3, 2e-3, 7e-4, 2e-4};
  }
  for (const double overlap : overlaps) {
    curves[2].second.push_back(all.size());
    all.push_back(springs(0.5 * count / across, overlap));
  }
  std::vector<Settled> settled(all.size());
  // The engines take turns; Box2D's settings come first.
  const std::size_t first_of_ours = curves[2].second.front();
  for (std::size_t turn = 0; turn < first_of_ours; ++turn) {
    for (const std::size_t i : {turn, first_of_ours + turn}) {
      if (i >= all.size()) continue;
      report.begin(name, all[i]);
      settled[i] = settle(scene, all[i], seconds, options);
      report.row(name, all[i], settled[i]);
    }
  }
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const auto& [label, chosen] = curves[k];
    Series rest = curve_of(all[chosen[0]], static_cast<int>(k % 2), label), way = rest;
    for (const std::size_t i : chosen) {
      rest.x.push_back(settled[i].cost);
      rest.y.push_back(settled[i].rest.mean);
      way.y.push_back(settled[i].peak);
    }
    way.x = rest.x;
    panels[0].plot.series.push_back(rest);
    panels[1].plot.series.push_back(way);
  }
  const Series& theirs = panels[0].plot.series[0];
  const Series& ours = panels[0].plot.series[2];
  std::string ratios;
  for (std::size_t k = 0; k < theirs.x.size(); ++k) {
    const double ratio = cost_at(ours, theirs.y[k]) / theirs.x[k];
    ratios += (k > 0 ? ", " : "") + rounded(ratio, 2) + " (1/" +
              rounded(1 / std::get<Box2dSettings>(all[curves[0].second[k]]).time_step) + " s)";
  }
  result.facts.push_back({"(b): lagrain's time over Box2D's at the same mean overlap", ratios});
  for (Diagram& diagram : panels) leave_room_for_legend(diagram.plot);
  return panels;
}

/// Beds for which the table has room.
void settle_others(Report& report, const FigureOptions& options) {
  struct Bed {
    std::string name;
    Scene<2> scene;
    double seconds;
    std::vector<EngineSettings> settings;
  };
  std::vector<Bed> beds;
  Box2dSettings with_search = box2d(60);
  with_search.continuous = true;
  if (options.quick) {
    beds.push_back({"sizes 1 : 10", mixture(150, 25), 2, {box2d(60), springs(20, 1e-2)}});
  } else {
    beds.push_back({"1000 discs settle", bed(1000, 32), 10, {with_search}});
    beds.push_back({"5000 discs settle", bed(5000, 70), 8, {box2d(60), springs(35, 1.2e-2)}});
    beds.push_back({"20000 discs settle, 3 s", bed(20000, 141), 3, {box2d(60), springs(71, 2e-2)}});
    beds.push_back({"1000 discs, sizes 1 : 10",
                    mixture(1000, 60),
                    8,
                    {box2d(60), box2d(240), springs(40, 1e-2), springs(40, 1e-3)}});
    beds.push_back({"2000 discs, sizes 1 : 30",
                    mixture(2000, 100, 30),
                    8,
                    {box2d(60), box2d(240), springs(100, 1e-2), springs(100, 1e-3)}});
  }
  for (const Bed& b : beds) {
    for (const EngineSettings& settings : b.settings) {
      report.begin(b.name, settings);
      report.row(b.name, settings, settle(b.scene, settings, b.seconds, options));
    }
  }
}

Diagram hopper_panel(Report& report, const FigureOptions& options) {
  const std::string name = "hopper";
  constexpr double kGap = 14;  // [r]
  const int count = options.quick ? 150 : 400, seeds = options.quick ? 1 : 3;
  const double seconds = options.quick ? 6 : 14;
  Diagram diagram{"(d) a hopper with a gap of 14 $r$",
                  {.x = {.label = "time [s]", .low = 0},
                   .y = {.label = "share of discs fallen", .low = 0, .high = 1.05},
                   .series = {},
                   .legend = Corner::bottom_right}};
  const std::vector<std::pair<std::string, EngineSettings>> contestants{
      {"Box2D, 1/60 s", box2d(60)},
      {"Box2D, 1/240 s", box2d(240)},
      {"lagrain, soft", springs(15, 1e-2)},
      {"lagrain, stiff", springs(15, 1e-3)}};
  for (std::size_t c = 0; c < contestants.size(); ++c) {
    const auto& [label, settings] = contestants[c];
    report.begin(name, settings);
    std::vector<double> rate, peak, cost;
    Series series = curve_of(settings, static_cast<int>(c % 2), label);
    series.marker = Marker::none;
    Scene<2> scene = hopper(count, options.quick ? 12 : 16, kGap);
    for (int seed = 1; seed <= seeds; ++seed) {
      scene.seed = static_cast<std::uint64_t>(seed);
      const Discharge flow = empty(scene, settings, seconds, options);
      rate.push_back(flow.rate);
      peak.push_back(flow.peak);
      cost.push_back(flow.cost);
      series.x = flow.time;
      series.y = flow.fallen;
      report.note(name, settings, "rate[1/s]", flow.rate);
      report.note(name, settings, "peak_overlap[-]", flow.peak);
      report.note(name, settings, "cost[s/s]", flow.cost);
    }
    diagram.plot.series.push_back(series);  // of the last seed
    report.add(name, settings,
               {"", "", rounded(mean_of(peak), 2), "", "", with_deviation(rate) + " discs per s"},
               mean_of(cost));
  }
  return diagram;
}

/// A heavy disc on ten light ones: what its weight does.
Diagram heavy_panel(Report& report, const FigureOptions& options) {
  const std::string name = "heavy on ten light";
  const double seconds = options.quick ? 2 : 20;
  constexpr int kLight = 10;
  Diagram diagram{"(e) a heavy disc on ten light ones",
                  {.x = {.label = "ratio of their masses", .log = true},
                   .y = {.label = "largest overlap [$r$]", .log = true},
                   .series = {},
                   .legend = Corner::top_left}};
  const std::vector<std::pair<std::string, EngineSettings>> contestants{
      {"Box2D, 1/60 s, 8/3", box2d(60)},
      {"Box2D, 1/60 s, 50/20", box2d(60, 50, 20)},
      {"Box2D, 1/960 s, 8/3", box2d(960)},
      {"lagrain, soft", springs(1000 + kLight, 0.1)},
      {"lagrain, stiff", springs(1000 + kLight, 1e-3)}};
  for (std::size_t c = 0; c < contestants.size(); ++c) {
    const auto& [label, settings] = contestants[c];
    Series series = curve_of(settings, static_cast<int>(c < 3 ? c : c - 3), label);
    for (const double ratio : {1.0, 10.0, 100.0, 1000.0}) {
      const std::string what = "1 : " + rounded(ratio, 4) + ", " + name;
      report.begin(what, settings);
      const Settled s = settle(heavy_on_light(kLight, ratio), settings, seconds, options);
      series.x.push_back(ratio);
      series.y.push_back(s.rest.largest);
      if (ratio == 1000) report.row(what, settings, s);
    }
    diagram.plot.series.push_back(series);
  }
  diagram.plot.y.high = 30;  // room for the legend over the light end
  return diagram;
}

Diagram tunnelling_panel(Report& report, const FigureOptions& options, FigureResult& result) {
  const std::string name = "fast disc at a free row";
  const int phases = options.quick ? 8 : 32;
  const std::vector<double> strides{0.5, 0.8, 1, 1.25, 1.6, 2, 2.5, 3, 3.7};
  const auto speed_of = [](double stride) { return stride * 60 * 2 * kBulletRadius; };
  const auto springs_for = [&](double stride) {
    // A fifth of a radius at the deepest.
    const double mass = 0.5 * std::numbers::pi * kBulletRadius * kBulletRadius;
    return LagrainSettings{mass * std::pow(speed_of(stride) / (0.2 * kBulletRadius), 2)};
  };
  Diagram diagram{"(f) a fast disc at a row that is free to move",
                  {.x = {.label = "way in 1/60 s over a diameter"},
                   .y = {.label = "share that passes through"},
                   .series = {},
                   .legend = Corner::top_left}};
  const Box2dSettings plain{.time_step = 1.0 / 60};
  Box2dSettings bullet = plain;
  bullet.bullet = 0;
  Series formula = series_style(3);
  formula.name = "$1 - 2r/(v\\,\\Delta t)$";
  formula.colour = style::kFaint;
  for (double stride = 1; stride <= strides.back(); stride += 0.05) {
    formula.x.push_back(stride);
    formula.y.push_back(tunnelling_share(stride));
  }
  diagram.plot.series = {formula};
  const std::vector<std::pair<std::string, EngineSettings>> contestants{
      {"Box2D, 1/60 s", plain},
      {"lagrain, springs for $v$", LagrainSettings{}},
      {"Box2D, 1/60 s, bullet", bullet}};
  for (std::size_t c = 0; c < contestants.size(); ++c) {
    const auto& [label, settings] = contestants[c];
    Series series = curve_of(settings, c == 0 ? 0 : 1, label);
    if (!is_box2d(settings))
      series.marker = Marker::none, series.dashes = {};  // beneath the bullet
    for (const double stride : strides) {
      const EngineSettings taken = is_box2d(settings) ? settings : springs_for(stride);
      if (stride == strides.front()) report.begin(name, taken);
      const Passage passage = shoot(speed_of(stride), taken, phases, options);
      series.x.push_back(stride);
      series.y.push_back(passage.share);
      report.note(name, taken, "passes[-] at " + rounded(stride), passage.share);
    }
    diagram.plot.series.push_back(series);
  }
  leave_room_for_legend(diagram.plot);
  std::string stopped = "none of these speeds";
  for (const double stride : strides) {
    if (!shoot(speed_of(stride), springs_for(strides.front()), 1, options).stops) continue;
    stopped = "from " + rounded(stride / strides.front(), 2) + " times that speed on";
    break;
  }
  result.facts.push_back(
      {"springs made for the slowest disc: lagrain stops with an error", stopped});
  return diagram;
}

std::string slop_share(const Scene<2>& scene, const Box2dSettings& settings) {
  const Box2dWorld world(*make_run(scene, 1), settings);
  return rounded(100 * world.slop() / world.radii().minCoeff(), 2) + " %";
}

}  // namespace

FigureResult draw_figure17(const FigureOptions& options) {
  FigureResult result;
  Report report(options, options.quick ? 39 : 56);
  std::vector<Diagram> diagrams{collapse_panel(report, options)};
  for (Diagram& panel : settling_panels(report, options, result))
    diagrams.push_back(std::move(panel));
  settle_others(report, options);
  diagrams.push_back(hopper_panel(report, options));
  diagrams.push_back(heavy_panel(report, options));
  diagrams.push_back(tunnelling_panel(report, options, result));
  draw_diagrams(diagrams, 2, 170, options, "fig17", result);
  write_file(options.out / "fig17.csv", report.csv().text());
  result.downloads = {"fig17.csv"};
  result.tables = {report.table()};
  result.facts.push_back({"discs that left through a wall", report.escaped()});
  result.facts.push_back(
      {"times",
       "one thread, steps alone, each run once, of beds the median over samples of 1/60 s; Box2D "
       "as the system packs it, lagrain with the widest vector instructions of this processor"});
  result.facts.push_back(
      {"Box2D",
       "the library calls itself " + box2d_version() +
           " (so does release 2.4.1); no sleeping, restitution threshold 1 m/s (its own)"});
  result.facts.push_back(
      {"Box2D's tolerance over the smallest radius",
       slop_share(bed(100, 10), {}) + " in beds and the hopper, " +
           slop_share(mixture(150, 25), {}) + " with sizes 1 : 10, " +
           slop_share(mixture(2000, 100, 30), {}) + " with 1 : 30, " +
           slop_share(read_scene<2>(options.scenes / "column_collapse.toml"), {}) +
           " in the collapse"});
  result.caption =
      "Box2D in orange, lagrain in blue, the same discs in the same places, friction 0.5; single "
      "paths are chaotic, so integrals are compared. Overlaps are over the smaller radius. (a) The "
      "scene column_collapse with fewer discs at its end, mean over the seeds. (b) Mean overlap of "
      "a bed at the end: Box2D's step is shortened, or its iterations raised from 8/3; lagrain's "
      "springs are stiffened. (c) The largest overlap in the same runs, seen every 1/60 s. (d) One "
      "of the seeds; the rates are in the table. (e) The largest overlap at the end. (f) Discs of "
      "0.25 m; the line is the share expected if a hit needs a step that ends in the front half of "
      "the overlap. 20000 discs are still falling when that run ends: it is for speed only. What "
      "to take: at a game's 1/60 s and 8/3 Box2D's heap and discharge are those of shorter steps "
      "and of springs to a tenth, as far as three seeds can tell; soft springs give a slightly "
      "flatter heap. In a bed lagrain is the cheaper one at equal mean overlap, the more so the "
      "smaller it is, because Box2D is first order in its step and iterations buy little; with "
      "sizes 1 : 10 and 1 : 30 the two are closer. Springs resolve impacts, so discs overlap less "
      "on the way; but at an equal mean lagrain's largest overlap at rest is the larger one, and "
      "soft beds ring for longer (force on the walls). Deep beds come to rest slowly in both. A "
      "heavy disc on light ones takes both about the same time for the same overlap: Box2D needs a "
      "shorter step or more iterations than its defaults, which let light discs be squeezed by "
      "half; springs must be stiff for the heaviest disc with a step for the lightest, and still "
      "ring. Fast discs pass through others in Box2D unless each is declared a bullet; lagrain "
      "needs springs made for the speed, and with softer ones it stops with an error.";
  return result;
}

}  // namespace lagrain::figures
