// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 10 (report): what an integrator and its step cost, and the error that they buy.
//
// Every panel is a scene whose answer is known: a closed form, or the same scene with steps so
// small that only rounding is left. All scenes are run through the engine as users run theirs.

#include "diagrams.hpp"
#include "trials.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/restitution.hpp>
#include <lagrain/time_step.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace lagrain::figures {

namespace {

using std::numbers::pi;

constexpr double kR = kTrialRadius, kK = kTrialStiffness, kG = kTrialGravity;
constexpr std::array<IntegratorModel, 3> kIntegrators{IntegratorModel::symplectic_euler,
                                                      IntegratorModel::velocity_verlet,
                                                      IntegratorModel::fourth_order};

/// How long two trial discs touch [s]; the steps of the sweep are fractions of it.
double contact_time() { return pi * std::sqrt(trial_mass<2>() / 2 / kK); }

/// What is tried in every panel.
struct Choice {
  IntegratorModel integrator;
  double step;  ///< [s]
};

/// A panel: a scene, the error it is judged by, and what theory says of its order.
struct Experiment {
  std::string title;
  std::string error;                  ///< name of the axis
  bool conservative;                  ///< fourth order applies
  std::array<const char*, 3> orders;  ///< by theory, for kIntegrators
  std::function<Outcome(const Choice&)> run;
};

Wall<2> floor_at(double y) { return Wall<2>::half_space("floor", {0, y}, {0, 1}); }

/// Free flight; error of the place, of the height fallen.
Outcome free_flight(const Choice& choice, const FigureOptions& options) {
  Scene<2> scene = empty_trial<2>();
  scene.integrator = choice.integrator;
  scene.gravity = {0, -kG};
  scene.duration = 0.2;
  scene.grains = {{.position = {0, 0}, .radius = kR, .velocity = {1, 1}}};
  const Trial<2> trial = run_trial(scene, choice.step, options);
  const double t = scene.duration;
  const Vec<2> exact{t, t - 0.5 * kG * t * t};
  return {(trial.run->positions().col(0) - exact).norm() / (0.5 * kG * t * t), trial.cost};
}

/// A disc that swings on the spring of the floor and never leaves it: smooth. Closed form.
Outcome swing(const Choice& choice, double restitution, const FigureOptions& options) {
  const double m = trial_mass<2>(), omega = std::sqrt(kK / m), depth = m * kG / kK;
  Scene<2> scene = empty_trial<2>();
  scene.integrator = choice.integrator;
  scene.gravity = {0, -kG};
  scene.law.restitution = restitution;
  scene.walls = {floor_at(0)};
  scene.grains = {{.position = {0, kR - 0.5 * depth}, .radius = kR}};
  scene.duration = (restitution < 1 ? 1.3 : 10.3) * 2 * pi / omega;
  const Trial<2> trial = run_trial(scene, choice.step, options);
  const double zeta = damping_ratio_for(restitution), t = scene.duration;
  const double damped = omega * std::sqrt(1 - zeta * zeta);
  const double offset = 0.5 * depth * std::exp(-zeta * omega * t) *
                        (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
  const double exact = kR - depth + offset;
  return {std::abs(trial.run->positions()(1, 0) - exact) / (0.5 * depth), trial.cost};
}

/// A step somewhat shorter than wanted, by another part at every phase. In a contact of a whole
/// number of steps the errors of its beginning and its end cancel, which is luck.
double detuned(double step, double phase) {
  return step / (1 + 0.1 * std::fmod(8 * phase * std::numbers::phi, 1.0));
}

/// How long a disc touches a wall [s].
double wall_contact_time(double restitution) {
  return LinearSpring::with_restitution(kK, restitution).contact_time(trial_mass<2>(), kR);
}

/// A disc bounces off a wall; error of its speed afterwards, of what the restitution makes of it.
Outcome bounce(const Choice& choice, double restitution, const FigureOptions& options) {
  constexpr double kSpeed = 1;
  return over_phases([&](double phase) {
    Scene<2> scene = empty_trial<2>();
    scene.integrator = choice.integrator;
    scene.law.restitution = restitution;
    scene.walls = {floor_at(0)};
    const double step = detuned(choice.step, phase);
    const double gap = kSpeed * step * (1 + phase);
    scene.grains = {{.position = {0, kR + gap}, .radius = kR, .velocity = {0, -kSpeed}}};
    scene.duration = gap / kSpeed + 1.5 * wall_contact_time(restitution);
    const Trial<2> trial = run_trial(scene, step, options);
    const double exact = restitution * kSpeed;
    return Outcome{std::abs(trial.run->velocities()(1, 0) / exact - 1), trial.cost};
  });
}

/// Two discs meet obliquely, with friction that holds; velocities and spins afterwards.
Eigen::Matrix<double, 6, 1> oblique(const Choice& choice, double phase_gap,
                                    const FigureOptions& options, double* cost) {
  constexpr double kSpeed = 1, kOffset = 1.2;  // of a radius, across
  Scene<2> scene = empty_trial<2>();
  scene.integrator = choice.integrator;
  scene.friction = FrictionModel::elastic;
  scene.law.restitution = 0.9;
  scene.law.friction = 0.3;
  const double along = std::sqrt(4 - kOffset * kOffset) * kR;
  scene.grains = {
      {.position = {-along - phase_gap, kOffset * kR}, .radius = kR, .velocity = {kSpeed, 0}},
      {.position = {0, 0}, .radius = kR}};
  // Until well after the contact, at the same place whatever the gap.
  scene.duration = phase_gap / kSpeed + 2 * contact_time();
  const Trial<2> trial = run_trial(scene, choice.step, options);
  *cost = trial.cost;
  const auto& v = trial.run->velocities();
  const auto& spin = *trial.run->spins();
  Eigen::Matrix<double, 6, 1> all;
  all << v(0, 0), v(1, 0), kR * spin(0, 0), v(0, 1), v(1, 1), kR * spin(0, 1);
  return all / kSpeed;
}

/// Steps of a converged reference.
double fine_step() { return contact_time() / 20000; }

Outcome oblique_error(const Choice& choice, const FigureOptions& options) {
  static const Eigen::Matrix<double, 6, 1> exact = [&] {
    double cost;
    return oblique({IntegratorModel::velocity_verlet, fine_step()}, 0, options, &cost);
  }();
  return over_phases([&](double phase) {
    Outcome outcome;
    const Choice one{choice.integrator, detuned(choice.step, phase)};
    const auto found = oblique(one, phase * one.step, options, &outcome.cost);
    outcome.error = (found - exact).norm() / std::sqrt(6.0);
    return outcome;
  });
}

/// Places of a column of discs that were put on each other without overlap, a while later.
Eigen::VectorXd column(const Choice& choice, const FigureOptions& options, double* cost) {
  constexpr int kDiscs = 10;
  Scene<2> scene = empty_trial<2>();
  scene.integrator = choice.integrator;
  scene.gravity = {0, -kG};
  scene.law.restitution = 0.5;
  scene.walls = {floor_at(0)};
  for (int k = 0; k < kDiscs; ++k) {
    scene.grains.push_back({.position = {0, (2 * k + 1) * kR}, .radius = kR});
  }
  scene.duration = 20 * contact_time();
  const Trial<2> trial = run_trial(scene, choice.step, options);
  *cost = trial.cost;
  return trial.run->positions().row(1).transpose();
}

Outcome column_error(const Choice& choice, const FigureOptions& options) {
  static const Eigen::VectorXd exact = [&] {
    double cost;
    return column({IntegratorModel::velocity_verlet, contact_time() / 5000}, options, &cost);
  }();
  const double depth = trial_mass<2>() * kG / kK;
  Outcome outcome;
  const Eigen::VectorXd found = column(choice, options, &outcome.cost);
  outcome.error = (found - exact).cwiseAbs().maxCoeff() / depth;
  return outcome;
}

/// A gas of row times row discs that lose nothing, in a box as wide as it is high [m].
Scene<2> gas_in_box(int row, double side) {
  Scene<2> scene = empty_trial<2>();
  scene.neighbourhood = NeighbourhoodModel::triangulation;
  scene.walls = {floor_at(0), Wall<2>::half_space("left", {0, 0}, {1, 0}),
                 Wall<2>::half_space("right", {side, 0}, {-1, 0}),
                 Wall<2>::half_space("top", {0, side}, {0, -1})};
  scene.fills = {{.name = "gas",
                  .count = row * row,
                  .radius = kR,
                  .region = {{0, 0}, {side, side}},
                  .arrangement = Arrangement::random,
                  .random_speed = 1}};
  return scene;
}

/// The largest energy error of a gas on its way.
Outcome gas(const Choice& choice, const FigureOptions& options) {
  constexpr int kRow = 10;
  Scene<2> scene = gas_in_box(kRow, 4 * kR * kRow);
  scene.integrator = choice.integrator;
  scene.duration = 0.3;
  const double steps = std::ceil(scene.duration / choice.step);
  scene.time_step.seconds = scene.duration / steps;
  const auto run = make_run(scene, 1);
  const double start = run->start().balance();
  double spent = 0;
  Outcome outcome;
  constexpr int kSamples = 50;
  for (int sample = 1; sample <= kSamples; ++sample) {
    options.check_stop();
    const double before = bench::processor_seconds();
    run->advance_to(scene.duration * sample / kSamples);
    spent += bench::processor_seconds() - before;
    outcome.error = std::max(outcome.error, std::abs(run->energy_residual()) / start);
  }
  outcome.cost = spent / scene.duration;
  return outcome;
}

/// The velocity and the spin of a body on an incline, two seconds from rest, against those of a
/// rigid one: it rolls if tan(angle) <= (1 + m r^2 / I) mu, else it slides.
template <int Dim>
Outcome incline(const Choice& choice, double degrees, const FigureOptions& options) {
  constexpr double kMu = 0.2;
  const double angle = degrees * pi / 180;
  const double inertia = Dim == 2 ? 0.5 : 0.4;  // of m r^2
  const double mass = trial_mass<Dim>();
  Scene<Dim> scene = empty_trial<Dim>();
  scene.integrator = choice.integrator;
  scene.friction = FrictionModel::elastic;
  scene.law.restitution = 0.5;
  scene.law.friction = kMu;
  // Gravity is turned, the plane is level.
  scene.gravity = Vec<Dim>::Zero();
  scene.gravity[0] = kG * std::sin(angle);
  scene.gravity[Dim - 1] = -kG * std::cos(angle);
  scene.walls = {Wall<Dim>::half_space("plane", Vec<Dim>::Zero(), Vec<Dim>::Unit(Dim - 1))};
  PlacedGrain<Dim> body{.radius = kR};
  body.position[Dim - 1] = kR - mass * kG * std::cos(angle) / kK;
  scene.grains = {body};
  scene.duration = 2;
  const Trial<Dim> trial = run_trial(scene, choice.step, options);
  const double t = scene.duration;
  const bool rolls = std::tan(angle) <= (1 + 1 / inertia) * kMu;
  const double friction = rolls ? kG * std::sin(angle) * inertia / (1 + inertia)
                                : kMu * kG * std::cos(angle);  // over the mass
  const double v = (kG * std::sin(angle) - friction) * t, surface = friction / inertia * t;
  const double spin = trial.run->spins()->col(0).norm();
  return {
      std::max(std::abs(trial.run->velocities()(0, 0) / v - 1), std::abs(kR * spin / surface - 1)),
      trial.cost};
}

/// Five discs in a row with small gaps, hit by the first: what the last one lacks of its speed.
Outcome cradle(const Choice& choice, const FigureOptions& options) {
  constexpr double kSpeed = 0.1, kGap = 0.02 * kR;
  return over_phases([&](double phase) {
    Scene<2> scene = empty_trial<2>();
    scene.integrator = choice.integrator;
    const double step = detuned(choice.step, phase);
    const double first_gap = kGap + phase * kSpeed * step;
    for (int k = 0; k < 5; ++k) {
      const double x = (2 * kR + kGap) * k - (k == 0 ? first_gap - kGap : 0);
      scene.grains.push_back({.position = {x, 0}, .radius = kR});
    }
    scene.grains[0].velocity = {kSpeed, 0};
    scene.duration = (4 * kGap + first_gap) / kSpeed + 8 * contact_time();
    const Trial<2> trial = run_trial(scene, step, options);
    return Outcome{std::abs(trial.run->velocities()(0, 4) / kSpeed - 1), trial.cost};
  });
}

std::vector<Experiment> experiments(const FigureOptions& options) {
  const auto with = [&options](auto&& trial) {
    return [&options, trial](const Choice& choice) { return trial(choice, options); };
  };
  return {
      {"(a) free flight", "place, of the fall", true, {"1", "exact", "exact"}, with(free_flight)},
      {"(b) swing in contact",
       "place, of the amplitude",
       true,
       {"1", "2", "4"},
       [&](const Choice& c) { return swing(c, 1, options); }},
      {"(c) damped settling",
       "place, of the amplitude",
       false,
       {"1", "2", ""},
       [&](const Choice& c) { return swing(c, 0.5, options); }},
      {"(d) damped bounce off a wall",
       "speed afterwards",
       false,
       {"1", "2", ""},
       [&](const Choice& c) { return bounce(c, 0.5, options); }},
      {"(e) oblique impact, friction",
       "velocities, of $v$",
       false,
       {"1", "1", ""},
       with(oblique_error)},
      {"(f) Newton's cradle, five discs", "speed of the last", true, {"2", "2", "2"}, with(cradle)},
      {"(g) elastic gas of 100 discs", "energy", true, {"1", "2", "2"}, with(gas)},
      {"(h) column of 10 discs", "places, of $mg/k$", false, {"1", "2", ""}, with(column_error)},
  };
}

/// Steps of the sweep, as parts of the contact time of two discs.
std::vector<int> parts(bool quick) {
  return quick ? std::vector<int>{12, 24, 48}
               : std::vector<int>{12, 16, 22, 32, 45, 64, 90, 128, 180, 256, 360, 640};
}

/// A panel of the inclines: bodies and slopes instead of integrators.
Diagram incline_panel(const FigureOptions& options, Csv& csv) {
  Diagram diagram = error_diagram("(i) on an incline, Verlet", "velocity, spin", Corner::top_right);
  struct Slope {
    std::string name;
    Outcome (*run)(const Choice&, double, const FigureOptions&);
    double degrees;
  };
  const std::array<Slope, 4> slopes{{{"disc rolls, 20°", incline<2>, 20},
                                     {"disc slides, 60°", incline<2>, 60},
                                     {"sphere rolls, 20°", incline<3>, 20},
                                     {"sphere slides, 60°", incline<3>, 60}}};
  for (const Slope& slope : slopes) {
    Series series = curve(static_cast<int>(diagram.plot.series.size()), slope.name);
    // The contact of a sphere is shorter: its mass is smaller.
    const bool disc = slope.run == &incline<2>;
    const double contact = pi * std::sqrt((disc ? trial_mass<2>() : trial_mass<3>()) / 2 / kK);
    for (const int part :
         options.quick ? std::vector<int>{12, 24} : std::vector<int>{12, 24, 48, 96}) {
      const Outcome outcome =
          slope.run({IntegratorModel::velocity_verlet, contact / part}, slope.degrees, options);
      series.x.push_back(outcome.cost);
      series.y.push_back(outcome.error);
      csv.row(diagram.title, slope.name, contact / part, 1.0 / part, outcome.cost, outcome.error);
    }
    diagram.plot.series.push_back(std::move(series));
  }
  leave_room_for_legend(diagram.plot);
  return diagram;
}

/// Pressure of a dilute gas on its walls, against the equation of state of hard discs.
struct Pressure {
  double measured = 0;   ///< P A / (N k T), A the area that centres can reach [-]
  double deviation = 0;  ///< standard error of that mean
  double expected = 0;   ///< by Henderson
  double drift = 0;      ///< of the energy
};

Pressure gas_pressure(const FigureOptions& options) {
  const int row = options.quick ? 10 : 30;
  const double side = 5.6 * kR * row;
  Scene<2> scene = gas_in_box(row, side);
  scene.law.stiffness = 1e8;  // hard: an overlap makes the disc smaller
  scene.duration = options.quick ? 1 : 6;
  scene.time_step.fraction_of_contact = 1.0 / 15;
  const auto run = make_run(scene, 1);
  constexpr int kBlocks = 30;
  const double reach = side - 2 * kR;
  std::vector<double> blocks;
  for (int block = 0; block < kBlocks; ++block) {
    options.progress(static_cast<double>(block) / kBlocks, "pressure of a gas");
    double force = 0, kinetic = 0;
    std::int64_t steps = 0;
    const double end = scene.duration * (block + 1) / kBlocks;
    while (run->time() < end) {
      run->step();
      for (const Wall<2>& wall : run->walls()) force += wall.force.norm();
      ++steps;
      options.check_stop();
    }
    kinetic = run->ledger().kinetic;
    const double pressure = force / static_cast<double>(steps) / (4 * reach);
    if (block >= kBlocks / 5) blocks.push_back(pressure * reach * reach / kinetic);
  }
  Pressure p;
  for (const double z : blocks) p.measured += z / static_cast<double>(blocks.size());
  for (const double z : blocks) p.deviation += (z - p.measured) * (z - p.measured);
  const auto count = static_cast<double>(blocks.size());
  p.deviation = std::sqrt(p.deviation / (count - 1) / count);
  // Solid fraction of hard discs whose centres reach this area.
  const double eta = run->count() * pi * kR * kR / (reach * reach);
  p.expected = (1 + eta * eta / 8) / ((1 - eta) * (1 - eta));
  p.drift = std::abs(run->energy_residual()) / run->start().balance();
  return p;
}

/// One curve: an integrator on an experiment over the steps of the sweep, and the order observed.
struct Sweep {
  Series series;
  double order = 0;  ///< NaN where rounding hides it
};

/// @param tell  told the share of the sweep that is done
Sweep sweep(const Experiment& experiment, std::size_t integrator, const std::vector<int>& steps,
            const std::function<void(double)>& tell, Csv& csv) {
  Sweep result{curve(static_cast<int>(integrator), std::string(name_of(kIntegrators[integrator])))};
  std::vector<double> taken, errors;
  for (std::size_t s = 0; s < steps.size(); ++s) {
    tell(static_cast<double>(s) / static_cast<double>(steps.size()));
    const Choice choice{kIntegrators[integrator], contact_time() / steps[s]};
    const Outcome outcome = experiment.run(choice);
    result.series.x.push_back(outcome.cost);
    result.series.y.push_back(outcome.error);
    csv.row(experiment.title, result.series.name, choice.step, 1.0 / steps[s], outcome.cost,
            outcome.error);
    // What rounding has reached says nothing about the order.
    if (outcome.error > 1e-11) {
      taken.push_back(choice.step);
      errors.push_back(outcome.error);
    }
  }
  result.order = bench::observed_order(taken, errors);
  return result;
}

/// Runs all integrators on an experiment, and enters the orders into the table.
/// @param tell  told the share that is done of each sweep
Diagram diagram_of(const Experiment& experiment, const std::vector<int>& steps,
                   const std::function<void(double)>& tell, Csv& csv, Table& orders) {
  Diagram diagram = error_diagram(experiment.title, experiment.error, Corner::none);
  std::vector<std::string> row{experiment.title};
  for (std::size_t k = 0; k < kIntegrators.size(); ++k) {
    if (kIntegrators[k] == IntegratorModel::fourth_order && !experiment.conservative) {
      row.push_back("not for dissipative scenes");
      continue;
    }
    Sweep result = sweep(experiment, k, steps, tell, csv);
    row.push_back((std::isnan(result.order) ? "rounding" : rounded(result.order, 3)) + " (" +
                  experiment.orders[k] + ")");
    diagram.plot.series.push_back(std::move(result.series));
  }
  orders.rows.push_back(std::move(row));
  return diagram;
}

/// Two discs meet head-on; error of their speed afterwards, of what the restitution makes of it.
Outcome head_on(double step, double restitution, const FigureOptions& options) {
  constexpr double kSpeed = 1;  // of the one against the other [m/s]
  const double contact =
      LinearSpring::with_restitution(kK, restitution).contact_time(trial_mass<2>() / 2, kR / 2);
  return over_phases([&](double phase) {
    Scene<2> scene = empty_trial<2>();
    scene.law.restitution = restitution;
    const double one_step = detuned(step, phase);
    const double gap = kSpeed * one_step * (1 + phase);
    for (const double side : {-1.0, 1.0}) {
      scene.grains.push_back({.position = {side * (kR + gap / 2), 0},
                              .radius = kR,
                              .velocity = {-side * kSpeed / 2, 0}});
    }
    scene.duration = gap / kSpeed + 1.5 * contact;
    const Trial<2> trial = run_trial(scene, one_step, options);
    const double apart = trial.run->velocities()(0, 1) - trial.run->velocities()(0, 0);
    return Outcome{std::abs(apart / (restitution * kSpeed) - 1), trial.cost};
  });
}

/// How many steps of velocity Verlet to a contact of two discs an impact needs for an error: the
/// fewest, from the largest step that is allowed on.
Table steps_needed(const FigureOptions& options) {
  constexpr std::array<double, 3> kErrors{1e-2, 3e-3, 1e-3};
  Table table{"Steps to a contact of two discs for an error of the restitution, at any phase",
              {"restitution", "1 %", "0.3 %", "0.1 %"},
              {}};
  for (const double restitution : {0.2, 0.5, 0.9, 1.0}) {
    const auto law = LinearSpring::with_restitution(kK, restitution);
    const double mass = trial_mass<2>() / 2, contact = law.contact_time(mass, kR / 2);
    const double safe = largest_damped_phase(law.damping_ratio) * law.natural_time(mass, kR / 2);
    const int fewest =
        static_cast<int>(std::ceil(std::max(1 / kLargestContactFraction, contact / safe)));
    std::vector<std::string> row{rounded(restitution, 1)};
    int steps = fewest;
    for (const double error : kErrors) {
      const auto reached = [&] {
        return head_on(contact / steps, restitution, options).error <= error;
      };
      while (!reached()) steps += std::max(1, steps / 20);
      row.push_back((steps == fewest ? "≤ " : "") + std::to_string(steps));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

constexpr const char* kCaption =
    "Error against processor time per simulated second, for steps from a twelfth of the contact "
    "time (just below the safe limit) downwards. Where the motion is smooth (a to c) the orders "
    "are those of theory, and the fourth order is worth its four force evaluations wherever more "
    "than three digits are wanted. Where contacts begin and end (d to g) no step ends on it, and "
    "every scheme is left with second order at best: velocity Verlet is the cheapest. It keeps "
    "that order where the force of a dashpot sets in at once (d), because laws know since when a "
    "contact has lasted within its first step; symplectic Euler, whose dashpots see an old "
    "velocity, does not. A tangential spring (e) takes the slip of a step before its force, which "
    "leaves first order. (Before and after an impact without loss nothing acts, and symplectic "
    "Euler is Verlet with its velocities taken half a step later: f shows them equal.) On an "
    "incline (i) the error is that of the soft contact, which takes a while to load, and not of "
    "the step: smaller steps buy nothing. So: velocity Verlet with 1/25 of the contact time for "
    "scenes with contacts, where a head-on impact errs by 0.1 %, or the largest step allowed "
    "where 1 % will do (last table); the fourth order for smooth and conservative ones. Errors of "
    "impacts are root mean squares over eight phases of the first contact within a step.";

}  // namespace

FigureResult draw_figure10(const FigureOptions& options) {
  FigureResult result;
  Csv csv("scene,choice,step[s],step_over_contact_time[-],cost[s/s],error[-]");
  Table orders{"Observed order: slope of the error over the step (by theory, where it applies)",
               {"scene", "symplectic Euler", "velocity Verlet", "fourth order"},
               {}};
  std::vector<Diagram> diagrams;
  const std::vector<Experiment> all = experiments(options);
  for (std::size_t e = 0; e < all.size(); ++e) {
    const auto tell = [&](double share) {
      options.progress((static_cast<double>(e) + share) / static_cast<double>(all.size() + 2),
                       all[e].title);
    };
    diagrams.push_back(diagram_of(all[e], parts(options.quick), tell, csv, orders));
  }
  diagrams.front().plot.legend = Corner::top_right;  // for all of them
  leave_room_for_legend(diagrams.front().plot);
  diagrams.push_back(incline_panel(options, csv));
  const Pressure pressure = gas_pressure(options);

  draw_diagrams(diagrams, 3, 150, options, "fig10", result);
  write_file(options.out / "fig10_integrators.csv", csv.text());
  result.downloads = {"fig10_integrators.csv"};
  result.tables = {orders, steps_needed(options)};
  result.caption = kCaption;
  result.facts = {{"pressure of a dilute elastic gas, P A / (N k T)",
                   rounded(pressure.measured, 4) + " ± " + rounded(pressure.deviation, 2) +
                       "; hard discs have " + rounded(pressure.expected, 4) +
                       " (Henderson, Mol. Phys. 30 (1975) 971)"},
                  {"energy error of that gas", rounded(pressure.drift, 2)}};
  return result;
}

}  // namespace lagrain::figures
