// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 16 (report): Box2D and lagrain on scenes of few discs whose rigid answer is known, error
// against processor time.
//
// Box2D is a rigid solver with a tolerance and a step that users choose by the frame rate; lagrain
// has springs whose stiffness users choose by the overlap that they bear. Both are swept over what
// their users can turn. Lengths are in metres with discs of 1 m, gravity is 10 m/s^2: the units in
// which Box2D's tolerances are meant, so nothing is scaled here.

#include "box2d_world.hpp"
#include "diagrams.hpp"
#include "rigid.hpp"
#include "trials.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr double kR = 1, kG = kGameGravity;  // [m], [m/s^2]
constexpr double kMass = std::numbers::pi;   // of a disc, at 1 kg/m^3 [kg]
constexpr int kPhases = 16;

/// A scene with a known answer, on which both engines are judged.
struct Contest {
  struct Panel {
    std::string title;
    std::string error;  ///< name of the axis
  };
  std::vector<Panel> panels;
  std::vector<int> rates;                                          ///< for Box2D: steps per second
  std::vector<double> stiffnesses;                                 ///< for lagrain [N/m]
  std::array<double, 3> refinements;                               ///< likewise, of the step
  std::function<std::vector<Outcome>(const EngineSettings&)> run;  ///< one per panel
};

Wall<2> ground() { return Wall<2>::half_space("floor", {0, 0}, {0, 1}); }

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double step_of(const Scene<2>& scene, const EngineSettings& settings) {
  return make_engine(scene, settings)->time_step();
}

/// Advances and gives the processor time per simulated second.
double cost_until(Engine& engine, double t, const FigureOptions& options) {
  const double from = engine.time();
  const double spent = advance_to(engine, t, options);
  return spent / (engine.time() - from);
}

/// A disc falls by 5 m and bounces: its first three apices.
Outcome bounce(const EngineSettings& settings, int phases, const FigureOptions& options) {
  constexpr double kHeight = 5, kRestitution = 0.8;
  constexpr double kAround = 0.2;  // apices come late by a contact or a step [s]
  Scene<2> scene = game_scene();
  scene.law.restitution = kRestitution;
  scene.walls = {ground()};
  scene.grains = {{.position = {0, kR + kHeight}, .radius = kR}};
  const double step = step_of(scene, settings);
  return over_phases(
      [&](double phase) {
        // It starts on its way down, so that the impact falls somewhere else in a step.
        const double start = phase * step;
        scene.grains[0].position.y() = kR + kHeight - 0.5 * kG * start * start;
        scene.grains[0].velocity.y() = -kG * start;
        const auto engine = make_engine(scene, settings);
        double up = std::sqrt(2 * kHeight / kG), impact = up - start, spent = 0, timed = 0;
        std::vector<double> errors;
        for (int k = 1; k <= 3; ++k) {
          up *= kRestitution;
          timed -= engine->time();
          spent += advance_to(*engine, impact + up - kAround, options);
          timed += engine->time();
          double highest = 0;
          while (engine->time() < impact + up + kAround) {
            engine->step();
            highest = std::max(highest, engine->positions()(1, 0) - kR);
          }
          impact += 2 * up;
          errors.push_back(highest / (kHeight * std::pow(kRestitution, 2 * k)) - 1);
        }
        return Outcome{root_mean_square(errors), spent / timed};
      },
      phases);
}

/// How a disc hits another one that rests.
struct Hit {
  double offset = 1.6 * kR;  ///< of the centres, across the way [m]
  double restitution = 0.9;
  double friction = 0;
  double damping = 0.15;  ///< of lagrain's viscous friction: what sticks needs more of it
};
constexpr double kHitSpeed = 5;  // [m/s]
constexpr Hit kSliding{.friction = 0.1}, kSticking{.friction = 0.5, .damping = 0.4};

/// All six velocities after a hit, against those of rigid discs.
Outcome collide(const EngineSettings& settings, const Hit& hit, int phases,
                const FigureOptions& options) {
  Scene<2> scene = game_scene();
  scene.gravity.setZero();
  // Viscous: a contact that sticks keeps no slip.
  scene.friction = hit.friction > 0 ? FrictionModel::viscous : FrictionModel::none;
  scene.law.restitution = hit.restitution;
  scene.law.friction = hit.friction;
  scene.law.tangential_damping = hit.damping;
  const double reach = std::sqrt(4 * kR * kR - hit.offset * hit.offset);
  scene.grains = {{.position = {-2 * reach, hit.offset}, .radius = kR, .velocity = {kHitSpeed, 0}},
                  {.position = {0, 0}, .radius = kR}};
  const auto exact = rigid_impact({RigidDisc{{-reach, hit.offset}, {kHitSpeed, 0}, 0, kR, kMass},
                                   RigidDisc{{0, 0}, {0, 0}, 0, kR, kMass}},
                                  hit.restitution, hit.friction);
  const double step = step_of(scene, settings);
  return over_phases(
      [&](double phase) {
        const double before = (2 + phase) * step;
        scene.grains[0].position.x() = -reach - kHitSpeed * before;
        const auto engine = make_engine(scene, settings);
        const double cost = cost_until(*engine, before + 0.25, options);
        const Columns<2> v = engine->velocities();
        const Columns<1> omega = engine->spins();
        std::vector<double> errors;
        for (int i = 0; i < 2; ++i) {
          const RigidDisc& disc = exact[static_cast<std::size_t>(i)];
          errors.push_back((v(0, i) - disc.velocity.x()) / kHitSpeed);
          errors.push_back((v(1, i) - disc.velocity.y()) / kHitSpeed);
          errors.push_back(kR * (omega(0, i) - disc.spin) / kHitSpeed);
        }
        return Outcome{root_mean_square(errors), cost};
      },
      phases);
}

/// The settings for what rests: with Box2D's own threshold, or every step of gravity would bounce.
EngineSettings at_rest(EngineSettings settings) {
  if (auto* box2d = std::get_if<Box2dSettings>(&settings)) box2d->bounce_above = 1;
  return settings;
}

/// A disc on inclines on which it rolls and slides, two seconds from rest: velocity and spin.
Outcome incline(const EngineSettings& settings, const FigureOptions& options) {
  constexpr double kFriction = 0.2, kTime = 2;  // it slides from 31 degrees on
  constexpr std::array<double, 4> kDegrees{20, 30, 35, 60};
  std::vector<double> errors;
  double cost = 0;
  for (const double degrees : kDegrees) {
    const double angle = degrees * std::numbers::pi / 180;
    Scene<2> scene = game_scene();
    // Gravity is turned, the plane stays: to Box2D that is kinder.
    scene.gravity = {kG * std::sin(angle), -kG * std::cos(angle)};
    scene.friction = FrictionModel::elastic;
    scene.law.restitution = 0.2;
    scene.law.friction = kFriction;
    scene.law.tangential_damping = 0.3;
    scene.walls = {ground()};
    scene.grains = {{.position = {0, kR}, .radius = kR}};
    const auto engine = make_engine(scene, at_rest(settings));
    cost += cost_until(*engine, kTime, options) / kDegrees.size();
    const Descent exact = descent(angle, kFriction, kG, kR, engine->time());
    errors.push_back(engine->velocities()(0, 0) / exact.velocity - 1);
    errors.push_back(-engine->spins()(0, 0) / exact.spin - 1);
  }
  return {root_mean_square(errors), cost};
}

/// A column of discs, put on each other without overlap, between smooth walls that they do not
/// quite touch: the largest overlap within a second, and the mean force of the contact (the
/// floor's among them) that errs most from the weight on it.
std::vector<Outcome> column(const EngineSettings& settings, int discs, double seconds,
                            const FigureOptions& options) {
  constexpr double kRoom = 1e-3, kSample = 1.0 / 60;
  Scene<2> scene = game_scene();
  scene.law.restitution = 0.2;
  const double half = kR + kRoom;
  scene.walls = {ground(), Wall<2>::half_space("left", {-half, 0}, {1, 0}),
                 Wall<2>::half_space("right", {half, 0}, {-1, 0})};
  for (int k = 0; k < discs; ++k) {
    scene.grains.push_back({.position = {0, (2 * k + 1) * kR}, .radius = kR});
  }
  const auto engine = make_engine(scene, at_rest(settings));
  const double cost = cost_until(*engine, seconds, options);
  std::vector<double> load(static_cast<std::size_t>(discs), 0);  // on the lower side of each [N]
  double overlap = 0;
  int samples = 0;
  while (engine->time() < seconds + 1) {
    advance_to(*engine, engine->time() + kSample, options);
    for (const ContactRecord<2>& contact : engine->contacts()) {
      const int upper = contact.wall >= 0 ? contact.i : std::max(contact.i, contact.j);
      load[static_cast<std::size_t>(upper)] += std::abs(contact.force.y());
    }
    overlap =
        std::max(overlap, overlaps_of(engine->positions(), engine->radii(), scene.walls).largest);
    ++samples;
  }
  double worst = 0;
  for (int k = 0; k < discs; ++k) {
    const double weight = (discs - k) * kMass * kG;
    worst = std::max(worst, std::abs(load[static_cast<std::size_t>(k)] / samples / weight - 1));
  }
  return {{overlap, cost}, {worst, cost}};
}

constexpr int kCradle = 5;  // discs of it

/// Newton's cradle: discs in a row, gaps between them.
struct Cradle {
  Outcome all;        ///< error of all velocities, over the first one's
  double last = 0;    ///< velocity of the last disc over the first one's
  double energy = 0;  ///< after over before
};

Cradle swing(const EngineSettings& settings, double gap, int phases, const FigureOptions& options) {
  constexpr double kSpeed = 1;
  Cradle mean;
  Scene<2> scene = game_scene();
  scene.gravity.setZero();
  for (int k = 0; k < kCradle; ++k) {
    scene.grains.push_back({.position = {(2 * kR + gap) * k, 0}, .radius = kR});
  }
  scene.grains[0].velocity.x() = kSpeed;
  const double step = step_of(scene, settings);
  mean.all = over_phases(
      [&](double phase) {
        const double before = (2 + phase) * step;
        scene.grains[0].position.x() = -kSpeed * before + gap;
        const auto engine = make_engine(scene, settings);
        const double cost = cost_until(*engine, before + (kCradle - 2) * gap / kSpeed + 2, options);
        const Eigen::ArrayXd v = engine->velocities().row(0).transpose().array() / kSpeed;
        mean.last += v[kCradle - 1] / phases;
        mean.energy += v.square().sum() / phases;
        std::vector<double> errors(v.begin(), v.end());
        errors.back() -= 1;
        return Outcome{root_mean_square(errors), cost};
      },
      phases);
  return mean;
}

/// Stiffnesses at which an impact at a speed [m/s] overlaps by these parts of a radius.
std::vector<double> for_impact(double speed, double effective_mass,
                               const std::vector<double>& overlaps) {
  std::vector<double> stiffnesses;
  for (const double overlap : overlaps) {
    stiffnesses.push_back(effective_mass * std::pow(speed / (overlap * kR), 2));
  }
  return stiffnesses;
}

/// Stiffnesses at which a weight of so many discs overlaps by these parts of a radius.
std::vector<double> for_load(double discs, const std::vector<double>& overlaps) {
  std::vector<double> stiffnesses;
  for (const double overlap : overlaps) {
    stiffnesses.push_back(discs * kMass * kG / (overlap * kR));
  }
  return stiffnesses;
}

std::vector<Contest> contests(const FigureOptions& options) {
  const int phases = options.quick ? 4 : kPhases;
  const double seconds = options.quick ? 3 : 12;
  std::vector<int> rates{60, 240}, frame_rates = rates;
  std::vector<double> overlaps{1e-1, 1e-2}, hard = overlaps, soft{1e-1, 3e-2};
  if (!options.quick) {
    frame_rates = {60, 120, 240, 480, 960};
    rates = frame_rates;
    rates.insert(rates.end(), {1920, 3840});
    soft = {1e-1, 3e-2, 1e-2};
    overlaps = {1e-1, 3e-2, 1e-2, 3e-3, 1e-3};
    hard = overlaps;
    hard.insert(hard.end(), {3e-4, 1e-4});
  }
  const std::array<double, 3> usual{1, 2, 4};
  const auto hit = [phases, &options](const Hit& how) {
    return [=, &options](const EngineSettings& s) {
      return std::vector{collide(s, how, phases, options)};
    };
  };
  const auto stand = [seconds, &options](int discs) {
    return [=, &options](const EngineSettings& s) { return column(s, discs, seconds, options); };
  };
  const double pair = kMass / 2;
  return {
      {{{"(a) bouncing disc, e = 0.8", "apices"}},
       rates,
       for_impact(10, kMass, soft),
       {1, 4, 16},
       [=, &options](const EngineSettings& s) { return std::vector{bounce(s, phases, options)}; }},
      {{{"(b) oblique impact that slides", "velocities over v"}},
       rates,
       for_impact(3, pair, overlaps),
       usual,
       hit(kSliding)},
      {{{"(c) oblique impact that sticks", "velocities over v"}},
       rates,
       for_impact(3, pair, overlaps),
       usual,
       hit(kSticking)},
      {{{"(d) on inclines of 20° to 60°", "velocity, spin"}},
       rates,
       for_load(1, hard),
       usual,
       [&options](const EngineSettings& s) { return std::vector{incline(s, options)}; }},
      {{{"(e) cradle of 5, gaps of 0.02 r", "velocities over v"}},
       rates,
       for_impact(1, pair, overlaps),
       usual,
       [=, &options](const EngineSettings& s) {
         return std::vector{swing(s, 0.02 * kR, phases, options).all};
       }},
      {{{"(f) column of 10 at rest", "overlap over r"},
        {"(g) column of 10 at rest", "worst of the forces"}},
       frame_rates,
       for_load(10, hard),
       usual,
       stand(10)},
      {{{"(h) column of 50 at rest", "overlap over r"},
        {"(i) column of 50 at rest", "worst of the forces"}},
       frame_rates,
       for_load(50, hard),
       usual,
       stand(50)},
  };
}

/// A curve: what one turns while the rest stays.
struct Sweep {
  std::string name;
  std::vector<EngineSettings> settings;
};

/// Over Box2D's step for some numbers of iterations, and over lagrain's stiffness for some steps.
std::vector<Sweep> sweeps(const Contest& contest) {
  constexpr std::array<std::array<int, 2>, 3> kIterations{{{8, 3}, {20, 10}, {50, 20}}};
  const std::array<const char*, 3> steps{"largest step", "finer", "finest"};
  std::vector<Sweep> all;
  for (std::size_t k = 0; k < kIterations.size(); ++k) {
    const auto [velocity, position] = kIterations[k];
    Sweep rigid{"Box2D, " + std::to_string(velocity) + "/" + std::to_string(position), {}};
    for (const int rate : contest.rates) {
      rigid.settings.push_back(Box2dSettings{.time_step = 1.0 / rate,
                                             .velocity_iterations = velocity,
                                             .position_iterations = position});
    }
    Sweep soft{std::string("lagrain, ") + steps[k], {}};
    for (const double stiffness : contest.stiffnesses) {
      soft.settings.push_back(LagrainSettings{stiffness, contest.refinements[k]});
    }
    all.push_back(rigid);
    all.push_back(soft);
  }
  return all;
}

/// One colour per engine, one marker per curve of it.
Series series_of(const Sweep& sweep, std::size_t index) {
  Series series = curve(static_cast<int>(index / 2), sweep.name);
  series.colour = category(index % 2 == 0 ? 1 : 0);
  return series;
}

struct Point {
  EngineSettings settings;
  Outcome outcome;
};

/// The cheapest setting of an engine whose error is within a limit; null if there is none.
const Point* cheapest(const std::vector<Point>& points, bool box2d, double limit) {
  const Point* best = nullptr;
  for (const Point& point : points) {
    if (is_box2d(point.settings) != box2d || !(point.outcome.error <= limit)) continue;
    if (best == nullptr || point.outcome.cost < best->outcome.cost) best = &point;
  }
  return best;
}

/// The cheapest setting within a limit in words, or how far the engine came.
std::string cheapest_text(const std::vector<Point>& points, bool box2d, double limit) {
  if (const Point* best = cheapest(points, box2d, limit)) {
    return rounded(1e3 * best->outcome.cost, 2) + " ms: " + name_of(best->settings);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Point& point : points) {
    if (is_box2d(point.settings) == box2d) least = std::min(least, point.outcome.error);
  }
  return "not reached, " + rounded(least, 2) + " at best";
}

/// lagrain's time over Box2D's for the same error; NaN where one does not reach it.
double ratio_within(const std::vector<Point>& points, double limit) {
  const Point* ours = cheapest(points, false, limit);
  const Point* box2d = cheapest(points, true, limit);
  return ours && box2d ? ours->outcome.cost / box2d->outcome.cost
                       : std::numeric_limits<double>::quiet_NaN();
}

/// Order at which errors fall with the step: Box2D's over its default iterations, lagrain's over
/// its stiffest springs.
double order_in_step(const std::vector<Point>& points, bool box2d) {
  double stiffest = 0;
  for (const Point& point : points) {
    if (const auto* ours = std::get_if<LagrainSettings>(&point.settings)) {
      stiffest = std::max(stiffest, ours->stiffness);
    }
  }
  std::vector<double> steps, errors;
  for (const Point& point : points) {
    double step = 0;
    if (const auto* theirs = std::get_if<Box2dSettings>(&point.settings)) {
      if (box2d && theirs->velocity_iterations == 8) step = theirs->time_step;
    } else {
      const auto& ours = std::get<LagrainSettings>(point.settings);
      if (!box2d && ours.stiffness == stiffest) step = 1 / ours.refinement;
    }
    if (!(step > 0)) continue;
    steps.push_back(step);
    errors.push_back(point.outcome.error);
  }
  return bench::observed_order(steps, errors);
}

/// What the two tables of impacts compare: Box2D from its usual step on, lagrain's springs for
/// impacts that overlap by a tenth and by a thousandth of a radius.
std::vector<EngineSettings> usual_choices(double speed) {
  std::vector<EngineSettings> all;
  for (const int rate : {60, 240, 960}) all.push_back(Box2dSettings{.time_step = 1.0 / rate});
  for (const double stiffness : for_impact(speed, kMass / 2, {1e-1, 1e-3})) {
    all.push_back(LagrainSettings{stiffness});
  }
  return all;
}

/// A row per hit, a column per choice: errors.
Table hits_table(int phases, const FigureOptions& options) {
  const std::vector<std::pair<std::string, Hit>> hits{
      {"head-on, e = 1", {.offset = 0, .restitution = 1}},
      {"off centre, e = 1", {.restitution = 1}},
      {"e = 0.9, friction 0.1 slides", kSliding},
      {"e = 0.9, friction 0.5 sticks", kSticking},
      {"e = 0.1, friction 0.1 slides", {.restitution = 0.1, .friction = 0.1}}};
  Table table{"Two discs, one at rest: error of all six velocities over the speed", {"impact"}, {}};
  // All but the first come at 3 m/s along the line of centres.
  const std::vector<EngineSettings> choices = usual_choices(3);
  for (const EngineSettings& choice : choices) table.head.push_back(name_of(choice));
  for (const auto& [name, hit] : hits) {
    std::vector<std::string> row{name};
    for (const EngineSettings& choice : choices) {
      row.push_back(rounded(collide(choice, hit, phases, options).error, 2));
    }
    table.rows.push_back(row);
  }
  return table;
}

/// A row per choice, a column per gap.
Table cradle_table(int phases, const FigureOptions& options) {
  Table table{
      "Newton's cradle of five: velocity of the last disc over the first one's (energy kept)",
      {"engine", "in touch", "gaps of 0.02 r", "gaps of 0.1 r"},
      {}};
  std::vector<EngineSettings> choices = usual_choices(1);
  choices.insert(choices.begin() + 3,
                 Box2dSettings{.velocity_iterations = 50, .position_iterations = 20});
  for (const EngineSettings& choice : choices) {
    std::vector<std::string> row{name_of(choice)};
    for (const double gap : {0.0, 0.02 * kR, 0.1 * kR}) {
      const Cradle after = swing(choice, gap, phases, options);
      row.push_back(rounded(after.last) + " (" + rounded(after.energy) + ")");
    }
    table.rows.push_back(row);
  }
  return table;
}

void add_row(Csv& csv, const Contest::Panel& panel, const Point& point) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (const auto* box2d = std::get_if<Box2dSettings>(&point.settings)) {
    csv.row(panel.title, panel.error, "Box2D", box2d->time_step, box2d->velocity_iterations,
            box2d->position_iterations, kNone, kNone, point.outcome.cost, point.outcome.error);
  } else {
    const auto& ours = std::get<LagrainSettings>(point.settings);
    csv.row(panel.title, panel.error, "lagrain", kNone, kNone, kNone, ours.stiffness,
            ours.refinement, point.outcome.cost, point.outcome.error);
  }
}

/// A contest that has been run: its diagrams, and all points of each.
struct Judged {
  std::vector<Diagram> panels;
  std::vector<std::vector<Point>> points;
};

/// Runs both engines over their sweeps, in turns.
/// @param tell  told the share that is done and the settings that come next
Judged run_contest(const Contest& contest,
                   const std::function<void(double, const EngineSettings&)>& tell, Csv& csv) {
  Judged judged;
  for (const Contest::Panel& panel : contest.panels) {
    judged.panels.push_back(error_diagram(panel.title, panel.error, Corner::none));
  }
  const std::size_t count = contest.panels.size();
  judged.points.resize(count);
  const std::vector<Sweep> curves = sweeps(contest);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    std::vector<Series> series(count, series_of(curves[k], k));
    for (const EngineSettings& settings : curves[k].settings) {
      tell(static_cast<double>(k) / static_cast<double>(curves.size()), settings);
      const std::vector<Outcome> outcomes = contest.run(settings);
      for (std::size_t p = 0; p < count; ++p) {
        series[p].x.push_back(outcomes[p].cost);
        series[p].y.push_back(outcomes[p].error);
        judged.points[p].push_back({settings, outcomes[p]});
        add_row(csv, contest.panels[p], judged.points[p].back());
      }
    }
    for (std::size_t p = 0; p < count; ++p) judged.panels[p].plot.series.push_back(series[p]);
  }
  for (Diagram& panel : judged.panels) {  // in the legend each engine stands by itself
    std::vector<Series>& s = panel.plot.series;
    s = {s[0], s[2], s[4], s[1], s[3], s[5]};
  }
  return judged;
}

/// The cheapest settings of both engines on a panel, for two limits of the error.
std::vector<std::string> cost_row(const Contest::Panel& panel, const std::vector<Point>& points) {
  std::vector<std::string> row{panel.title.substr(4) + ": " + panel.error};
  for (const double limit : {1e-2, 1e-3}) {
    for (const bool box2d : {true, false}) row.push_back(cheapest_text(points, box2d, limit));
    const double ratio = ratio_within(points, limit);
    row.push_back(std::isnan(ratio) ? "" : rounded(ratio, 2));
  }
  return row;
}

std::string orders_text(const std::vector<Point>& points) {
  return "Box2D " + rounded(order_in_step(points, true), 2) + "; lagrain, stiffest springs, " +
         rounded(order_in_step(points, false), 2);
}

std::string caption_of(int phases) {
  return "Error against processor time per simulated second, Box2D in orange, lagrain in blue; "
         "discs of 1 m under 10 m/s^2, the units for which Box2D's tolerances are made. Box2D's "
         "step goes from 1/60 s to 1/3840 s (columns: 1/960 s) along its curves, one for each "
         "number of iterations for velocities and places; lagrain's stiffness goes along its own, "
         "one for the largest step that it allows, and for a half and a quarter of it, in (a) a "
         "quarter and a sixteenth. (a) Height of the first three apices after a fall of 5 m. (b, "
         "c) All six velocities after an impact off the centre, e = 0.9, against rigid discs. (d) "
         "Velocity and spin after 2 s. (e) All velocities. (f to i) Columns that were put down "
         "without overlap, over a second after they had time to come to rest; (g, i) the contact "
         "whose mean force errs most from the weight on it. In (a, b, c, e) errors are root mean "
         "squares over " +
         std::to_string(phases) +
         " phases of the impact within a step: a single phase is luck. What to take: with few "
         "bodies neither engine is the cheaper one throughout, the table says where which is. "
         "Box2D needs one step for an impact and springs ten or more, but a step of few discs "
         "costs lagrain less. Friction that sticks (c) is Box2D's best case, a row of discs (e) "
         "lagrain's. In (a) Box2D is of first order, because impacts fall between its steps, and "
         "lagrain's error is the time that its soft contact takes, with stiff ones that of its "
         "largest step. On inclines (d) and in the cradle (e) Box2D errs by single precision "
         "alone, which grows with the number of steps; springs err by their depth. Discs in touch "
         "have no one rigid answer (last table): Box2D's all move off together, springs pass "
         "nearly all on. At rest, overlap is to lagrain a load over a stiffness and to Box2D a "
         "tolerance, which more iterations or shorter steps lower, at a price that grows with the "
         "column. Forces of springs end at double precision, Box2D's at single. With lagrain, "
         "choose the stiffness by the error, and the largest step: shorter ones help in (a) and "
         "(e) alone.";
}

/// @param orders  observed in (a), see orders_text
std::vector<Fact> facts_of(const std::string& orders) {
  Scene<2> unit = game_scene();
  unit.grains = {{.position = {0, 0}, .radius = kR}};
  const Box2dWorld world(*make_run(unit, 1), {});
  return {
      {"Box2D", "the library calls itself " + box2d_version() + " (so does release 2.4.1)"},
      {"Box2D's tolerance of length", rounded(100 * world.slop() / kR) + " % of a radius"},
      {"Box2D's settings",
       "no sleeping, collisions within a step seen (CCD), restitution threshold 0 for impacts and "
       "its own 1 m/s for what rests"},
      {"observed order in the step, (a)", orders},
      {"lagrain's friction",
       "viscous in (b, c), so that a contact that sticks keeps no slip; elastic in (d)"},
      {"Box2D 3 (commit 617d32ab; Debian has no package of it, not reproducible here)",
       "friction and restitution together leave an error of 0.085 v in (b) at every step; column "
       "of 50 with its defaults: overlap 0.028 r"}};
}

}  // namespace

FigureResult draw_figure16(const FigureOptions& options) {
  FigureResult result;
  Csv csv(
      "scene,judged_by,engine,time_step[s],velocity_iterations,position_iterations,stiffness[N/m],"
      "step_refinement[-],cost[s/s],error[-]");
  Table costs{"Processor time per simulated second of the cheapest setting within an error",
              {"scene", "Box2D, 0.01", "lagrain, 0.01", "lagrain / Box2D", "Box2D, 0.001",
               "lagrain, 0.001", "lagrain / Box2D"},
              {}};
  std::string orders;  // in the first panel
  std::vector<Diagram> diagrams;
  const std::vector<Contest> all = contests(options);
  for (std::size_t c = 0; c < all.size(); ++c) {
    const auto tell = [&](double share, const EngineSettings& settings) {
      options.progress((static_cast<double>(c) + share) / static_cast<double>(all.size()),
                       name_of(settings));
    };
    Judged judged = run_contest(all[c], tell, csv);
    if (c == 0) orders = orders_text(judged.points.front());
    for (std::size_t p = 0; p < judged.panels.size(); ++p) {
      costs.rows.push_back(cost_row(all[c].panels[p], judged.points[p]));
      diagrams.push_back(std::move(judged.panels[p]));
    }
  }
  diagrams.front().plot.legend = Corner::top_right;  // for all of them
  leave_room_for_legend(diagrams.front().plot);
  draw_diagrams(diagrams, 3, 165, options, "fig16", result);
  write_file(options.out / "fig16.csv", csv.text());
  result.downloads = {"fig16.csv"};
  const int phases = options.quick ? 4 : kPhases;
  result.tables = {costs, hits_table(phases, options), cradle_table(phases, options)};
  result.caption = caption_of(phases);
  result.facts = facts_of(orders);
  return result;
}

}  // namespace lagrain::figures
