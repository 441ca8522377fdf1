// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 11 (report): how stiff a contact must be for the error that one can bear, and what that
// costs, for the linear spring and for Hertz's law.
//
// The rigid limit is known in closed form; soft contacts approach it as their stiffness grows, and
// pay with shorter steps.

#include "diagrams.hpp"
#include "rigid.hpp"
#include "trials.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr double kR = kTrialRadius, kG = kTrialGravity;
constexpr double kSpeed = 1;  // of impacts [m/s]

/// A law and its friction.
struct Model {
  std::string name;
  NormalModel normal;
  FrictionModel friction;
  int steps = 100;  ///< in a contact
};

/// Sets the stiffness by the overlap, in radii, that a head-on impact of two discs at kSpeed leads
/// to, and the step by the duration of that impact.
/// @returns the step [s]
double set_stiffness(Scene<2>& scene, const Model& model, double overlap) {
  const double m = trial_mass<2>() / 2, depth = overlap * kR;
  scene.normal = model.normal;
  scene.friction = model.friction;
  if (model.normal == NormalModel::linear) {
    scene.law.stiffness = m * kSpeed * kSpeed / (depth * depth);
    return std::numbers::pi * depth / kSpeed / model.steps;
  }
  // Energy: m v^2 / 2 = (2/5) K depth^(5/2).
  const double coefficient = 1.25 * m * kSpeed * kSpeed / std::pow(depth, 2.5);
  scene.law.modulus = 0.75 * coefficient / std::sqrt(kR / 2);
  scene.law.impact_speed = kSpeed;
  return 2.94328 * depth / kSpeed / model.steps;
}

Outcome impact(const Model& model, double overlap, const FigureOptions& options) {
  constexpr double kRestitution = 0.9, kOffset = 1.6;  // of a radius
  const double friction = model.friction == FrictionModel::none ? 0 : 0.1;
  const double mass = trial_mass<2>(), reach = std::sqrt(4 - kOffset * kOffset) * kR;
  const auto exact = rigid_impact({RigidDisc{{-reach, kOffset * kR}, {kSpeed, 0}, 0, kR, mass},
                                   RigidDisc{{0, 0}, {0, 0}, 0, kR, mass}},
                                  kRestitution, friction);
  return over_phases([&](double phase) {
    Scene<2> scene = empty_trial<2>();
    const double step = set_stiffness(scene, model, overlap);
    scene.law.restitution = kRestitution;
    scene.law.friction = friction;
    scene.law.tangential_damping = model.friction == FrictionModel::viscous ? 0.5 : 0;
    const double gap = (1 + phase) * kSpeed * step;
    scene.grains = {
        {.position = {-reach - gap, kOffset * kR}, .radius = kR, .velocity = {kSpeed, 0}},
        {.position = {0, 0}, .radius = kR}};
    scene.duration = gap / kSpeed + 2.5 * model.steps * step;
    const Trial<2> trial = run_trial(scene, step, options);
    const auto& v = trial.run->velocities();
    const auto* spin = trial.run->spins();
    double squares = 0;
    for (int i = 0; i < 2; ++i) {
      const RigidDisc& rigid = exact[static_cast<std::size_t>(i)];
      const double surface = spin != nullptr ? kR * (*spin)(0, i) : 0;
      squares += (v.col(i) - rigid.velocity).squaredNorm() + std::pow(surface - kR * rigid.spin, 2);
    }
    return Outcome{std::sqrt(squares / 6) / kSpeed, trial.cost};
  });
}

/// Ten discs on each other come to rest: the mean overlap, in radii; rigid ones have none.
Outcome column(const Model& model, double overlap, const FigureOptions& options) {
  constexpr int kDiscs = 10;
  Scene<2> scene = empty_trial<2>();
  const double step = set_stiffness(scene, model, overlap);
  scene.gravity = {0, -kG};
  scene.law.restitution = 0.3;
  scene.walls = {Wall<2>::half_space("floor", {0, 0}, {0, 1})};
  for (int k = 0; k < kDiscs; ++k) {
    scene.grains.push_back({.position = {0, (2 * k + 1) * kR}, .radius = kR});
  }
  scene.duration = 120 * model.steps * step;
  const Trial<2> trial = run_trial(scene, step, options);
  return {trial.run->statistics().mean_overlap, trial.cost};
}

/// A disc falls and bounces three times; error of the height of the third apex.
Outcome bounces(const Model& model, double overlap, const FigureOptions& options) {
  constexpr double kRestitution = 0.8;
  return over_phases(
      [&](double phase) {
        Scene<2> scene = empty_trial<2>();
        const double step = set_stiffness(scene, model, overlap);
        scene.gravity = {0, -kG};
        scene.law.restitution = kRestitution;
        scene.walls = {Wall<2>::half_space("floor", {0, 0}, {0, 1})};
        const double height = kSpeed * kSpeed / (2 * kG) + phase * kSpeed * step;
        scene.grains = {{.position = {0, kR + height}, .radius = kR}};
        const double fall = std::sqrt(2 * height / kG), e = kRestitution;
        // Until the disc is on its way to the third apex for sure.
        scene.duration = fall * (1 + 2 * e + 2 * e * e + 0.7 * e * e * e);
        const Trial<2> trial = run_trial(scene, step, options);
        const double y = trial.run->positions()(1, 0) - kR, v = trial.run->velocities()(1, 0);
        const double apex = y + v * v / (2 * kG);
        return Outcome{std::abs(apex / (height * std::pow(e, 6)) - 1), trial.cost};
      },
      4);
}

/// A diagram: a scene and the models that are tried on it.
struct Experiment {
  std::string title, error;
  std::vector<Model> models;
  Outcome (*run)(const Model&, double, const FigureOptions&);
};

std::vector<Experiment> experiments() {
  const Model linear{"linear", NormalModel::linear, FrictionModel::none};
  const Model hertz{"Hertz", NormalModel::hertz, FrictionModel::none};
  const auto coarse = [](Model model) {
    model.name += ", 25 steps";
    model.steps = 25;
    return model;
  };
  return {{"(a) oblique impact, no friction",
           "velocities, of $v$",
           {linear, coarse(linear), hertz, coarse(hertz)},
           impact},
          {"(b) oblique impact that slides, friction 0.1",
           "velocities, of $v$",
           {{"linear, viscous", NormalModel::linear, FrictionModel::viscous},
            {"linear, elastic", NormalModel::linear, FrictionModel::elastic},
            {"Hertz, viscous", NormalModel::hertz, FrictionModel::viscous},
            {"Hertz, elastic", NormalModel::hertz, FrictionModel::elastic}},
           impact},
          {"(c) column of 10 discs at rest",
           "mean overlap, of $r$",
           {coarse(linear), coarse(hertz)},
           column},
          {"(d) third apex of a bouncing disc",
           "height",
           {linear, coarse(linear), hertz, coarse(hertz)},
           bounces}};
}

/// The overlaps of the sweep, in radii.
std::vector<double> overlaps(bool quick) {
  return quick ? std::vector<double>{1e-2, 1e-3} : std::vector<double>{3e-2, 1e-2, 3e-3, 1e-3};
}

/// Runs all models of an experiment; enters the errors into the CSV, the slopes into the table.
Diagram diagram_of(const Experiment& experiment, const FigureOptions& options, Csv& csv,
                   Table& slopes) {
  Diagram diagram = error_diagram(experiment.title, experiment.error, Corner::top_right);
  for (const Model& model : experiment.models) {
    Series series = curve(static_cast<int>(diagram.plot.series.size()), model.name);
    for (const double overlap : overlaps(options.quick)) {
      const Outcome outcome = experiment.run(model, overlap, options);
      series.x.push_back(outcome.cost);
      series.y.push_back(outcome.error);
      csv.row(experiment.title, model.name, overlap, outcome.cost, outcome.error);
    }
    slopes.rows.push_back(
        {experiment.title, model.name, rounded(bench::observed_order(series.x, series.y), 2)});
    diagram.plot.series.push_back(std::move(series));
  }
  leave_room_for_legend(diagram.plot);
  return diagram;
}

constexpr const char* kCaption =
    "Error against the rigid limit, for contacts from soft (left: an impact at 1 m/s overlaps by 3 "
    "% of a radius) to stiff (right: by 0.1 %), with 100 or 25 steps to a contact. What softness "
    "costs falls with the overlap, and the overlap with the inverse of the processor time (at rest "
    "with its square). Where the step's own error is reached (a, d: 25 steps) more stiffness buys "
    "nothing: stiffness and step belong together. Hertz's law is as good as the linear spring at "
    "the same overlap and costs about the same.";

}  // namespace

FigureResult draw_figure11(const FigureOptions& options) {
  FigureResult result;
  Csv csv("scene,law,overlap_of_impact[r],cost[s/s],error[-]");
  Table slopes{"How the error falls as processor time grows (slope in the diagrams)",
               {"scene", "law", "slope"},
               {}};
  std::vector<Diagram> diagrams;
  const std::vector<Experiment> all = experiments();
  for (std::size_t e = 0; e < all.size(); ++e) {
    options.progress(static_cast<double>(e) / static_cast<double>(all.size()), all[e].title);
    diagrams.push_back(diagram_of(all[e], options, csv, slopes));
  }
  draw_diagrams(diagrams, 2, 165, options, "fig11", result);
  write_file(options.out / "fig11_stiffness.csv", csv.text());
  result.downloads = {"fig11_stiffness.csv"};
  result.tables = {slopes};
  result.caption = kCaption;
  return result;
}

}  // namespace lagrain::figures
