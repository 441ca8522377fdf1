// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 15 (report): what each piece of physics costs, in bytes and nanoseconds.
//
// One bed is brought to rest with the fullest model; every model settles anew from there.

#include "diagrams.hpp"
#include "measure.hpp"

#include <lagrain/csv.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace lagrain::figures {

namespace {

constexpr double kR = 0.01;  // [m]

struct Model {
  NormalModel normal;
  FrictionModel friction;

  std::string name() const {
    return std::string(name_of(normal)) + ", friction " + std::string(name_of(friction));
  }
};

constexpr Model kModels[] = {
    {NormalModel::linear, FrictionModel::none},    {NormalModel::linear, FrictionModel::viscous},
    {NormalModel::linear, FrictionModel::elastic}, {NormalModel::hertz, FrictionModel::none},
    {NormalModel::hertz, FrictionModel::viscous},  {NormalModel::hertz, FrictionModel::elastic}};

/// Grains let fall into a box as wide as it will be high.
template <int Dim>
Scene<Dim> box_of(int count) {
  Scene<Dim> scene;
  scene.gravity = -9.81 * Vec<Dim>::Unit(Dim - 1);
  scene.law.stiffness = Dim == 2 ? 2e7 : 2e6;
  scene.law.modulus = 5e8;
  scene.law.impact_speed = 1;
  scene.law.restitution = 0.3;
  scene.law.friction = 0.5;
  scene.law.tangential_damping = 0.15;
  scene.materials = {{"stone", 2500}};
  const int row = static_cast<int>(std::ceil(std::pow(count, 1.0 / Dim)));
  const double side = 2.04 * kR * row;
  Vec<Dim> far = Vec<Dim>::Constant(side);
  scene.walls = {Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), Vec<Dim>::Unit(Dim - 1))};
  for (int axis = 0; axis < Dim - 1; ++axis) {
    scene.walls.push_back(Wall<Dim>::half_space("low " + std::to_string(axis), Vec<Dim>::Zero(),
                                                Vec<Dim>::Unit(axis)));
    scene.walls.push_back(
        Wall<Dim>::half_space("high " + std::to_string(axis), far, -Vec<Dim>::Unit(axis)));
  }
  far[Dim - 1] *= 1.2;
  scene.fills = {{.name = "grains",
                  .count = count,
                  .radius = UniformRadius{0.95 * kR, kR},
                  .region = {Vec<Dim>::Zero(), far},
                  .arrangement = Arrangement::lattice}};
  return scene;
}

/// The grains of a run as they are, without their speed.
template <int Dim>
std::vector<PlacedGrain<Dim>> at_rest(const Run<Dim>& run) {
  std::vector<PlacedGrain<Dim>> grains;
  for (int i = 0; i < run.count(); ++i) {
    grains.push_back({.position = run.positions().col(i), .radius = run.radii()[i]});
  }
  return grains;
}

/// A model's figures.
struct Row {
  Model model;
  ModelSize size;
  std::vector<double> ns;  ///< per grain and step, a round each
  double contacts = 0;     ///< per grain
  double residual = 0;     ///< energy, of what was turned over [-]
  double mean_overlap = 0;
};

template <int Dim>
std::vector<Row> measure(int count, const FigureOptions& options) {
  constexpr int kRounds = 5;
  const int steps = options.quick ? 20 : 500, warm_up = options.quick ? 10 : 3000;
  Scene<Dim> scene = box_of<Dim>(count);
  scene.friction = FrictionModel::elastic;
  scene.duration = options.quick ? 0.05 : 0.5;
  {
    const auto settling = make_run(scene);
    while (!settling->finished()) {
      settling->step();
      options.check_stop();
      if (settling->steps() % 100 == 0) {
        options.progress(settling->time() / scene.duration, "settling a bed");
      }
    }
    scene.grains = at_rest(*settling);
    scene.fills.clear();
    scene.largest_initial_overlap = 0.3;
  }
  std::vector<Row> rows;
  std::vector<std::unique_ptr<Run<Dim>>> runs;
  for (const Model& model : kModels) {
    scene.normal = model.normal;
    scene.friction = model.friction;
    runs.push_back(make_run(scene, 1));
    rows.push_back({model, runs.back()->size(), {}});
    for (int s = 0; s < warm_up; ++s) runs.back()->step();
  }
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < runs.size(); ++k) {
      options.check_stop();
      const double start = bench::processor_seconds();
      for (int s = 0; s < steps; ++s) runs[k]->step();
      rows[k].ns.push_back(1e9 * (bench::processor_seconds() - start) / steps / runs[k]->count());
    }
  }
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const ContactStatistics statistics = runs[k]->statistics();
    rows[k].contacts = static_cast<double>(statistics.contacts) / runs[k]->count();
    rows[k].mean_overlap = statistics.mean_overlap;
    const Ledger ledger = runs[k]->ledger();
    const double turned = ledger.dashpot + ledger.friction + ledger.kinetic;
    rows[k].residual = std::abs(runs[k]->energy_residual()) / turned;
  }
  return rows;
}

std::string bytes(std::size_t number) { return std::to_string(number); }

}  // namespace

FigureResult draw_figure15(const FigureOptions& options) {
  FigureResult result;
  Csv csv(
      "dimension[-],normal,friction,per_grain[B],per_near_pair[B],time[ns/grain/step],"
      "contacts_per_grain[-],time_per_contact[ns],energy_residual[-],mean_overlap[-]");
  Table table{"What a model costs",
              {"model", "bytes per grain", "bytes per near pair", "ns per grain and step",
               "contacts per grain", "ns per contact and step", "energy residual"},
              {}};
  std::vector<Diagram> diagrams;
  const auto add = [&]<int Dim>(const std::vector<Row>& rows, const std::string& title) {
    Diagram time{title,
                 {.x = {.label = "bytes per grain and its contacts"},
                  .y = {.label = "time per grain and step [ns]"},
                  .series = {},
                  .legend = Corner::top_left}};
    for (const Row& row : rows) {
      const double ns = bench::median_of(row.ns);
      const double all = static_cast<double>(row.size.per_grain) +
                         row.contacts * static_cast<double>(row.size.per_near_pair);
      csv.row(Dim, std::string(name_of(row.model.normal)), std::string(name_of(row.model.friction)),
              row.size.per_grain, row.size.per_near_pair, ns, row.contacts, ns / row.contacts,
              row.residual, row.mean_overlap);
      table.rows.push_back({std::to_string(Dim) + "D, " + row.model.name(),
                            bytes(row.size.per_grain), bytes(row.size.per_near_pair),
                            rounded(ns, 3), rounded(row.contacts, 3), rounded(ns / row.contacts, 3),
                            rounded(row.residual, 2)});
      Series series = curve(static_cast<int>(time.plot.series.size()), row.model.name());
      series.width = 0;
      series.x = {all};
      series.y = {ns};
      time.plot.series.push_back(std::move(series));
    }
    leave_room_for_legend(time.plot);
    time.plot.y.low = 0;
    diagrams.push_back(std::move(time));
  };
  add.template operator()<2>(measure<2>(options.quick ? 200 : 2000, options), "(a) discs");
  add.template operator()<3>(measure<3>(options.quick ? 200 : 2000, options), "(b) spheres");
  draw_diagrams(diagrams, 2, 190, options, "fig15", result);
  write_file(options.out / "fig15_physics.csv", csv.text());
  result.downloads = {"fig15_physics.csv"};
  result.tables = {table};
  result.caption =
      "What each piece of physics costs on a bed at rest: memory of a grain with its share of near "
      "pairs, and time of a step. A scene without friction stores no spin, no torque and no "
      "tangential memory, and does not compute them. Viscous friction adds spins, elastic friction "
      "the memory of contacts. Beside each time stands the energy that the run cannot account for, "
      "of what it turned over while it was measured.";
  return result;
}

}  // namespace lagrain::figures
