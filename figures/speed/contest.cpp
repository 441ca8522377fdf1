// SPDX-License-Identifier: GPL-3.0-or-later
#include "contest.hpp"

#include "contenders.hpp"
#include "lagrain_turns.hpp"
#include "lammps_turns.hpp"

#include <lagrain/cell_grid.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace lagrain::bench {

namespace {

namespace fs = std::filesystem;

std::string folder_name(const std::string& scene) {
  std::string name;
  for (const char c : scene) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  return name;
}

/// The oracle knows the contacts for nothing: what the run spends on asking it does not count.
template <int Dim>
void forgive_neighbourhood(Sample<Dim>& sample, const Match<Dim>& match) {
  for (Phase& phase : sample.phases) {
    if (phase.name != "neighbourhood") continue;
    sample.cpu -= 1e-9 * phase.ns * grain_steps(match.bed, match.plan);
    phase.ns = 0;
  }
}

/// Enters what a contender has done in a round.
template <int Dim>
void note(Match<Dim>& match, std::size_t k, bool careful, Sample<Dim> sample) {
  auto& entry = match.entries[k];
  Contender& contender = match.scene.contenders[k];
  if (entry.name == kOracle) forgive_neighbourhood(sample, match);
  contender.name = entry.name;
  contender.ns.push_back(1e9 * sample.cpu / grain_steps(match.bed, match.plan));
  entry.phases.push_back(sample.phases);
  if (!careful) return;
  contender.errors = sample.errors;
  entry.position = std::move(sample.position);
}

/// The radius of the smallest grain [m].
template <int Dim>
double smallest_radius(const Bed<Dim>& bed) {
  double smallest = bed.grains.front().radius;
  for (const Grain<Dim>& grain : bed.grains) smallest = std::min(smallest, grain.radius);
  return smallest;
}

/// Chooses the phases of the median round, and says how far everybody is astray.
template <int Dim>
void finish(Match<Dim>& match) {
  for (std::size_t k = 0; k < match.entries.size(); ++k) {
    Contender& contender = match.scene.contenders[k];
    for (std::size_t round = 0; round < contender.ns.size(); ++round) {
      if (contender.ns[round] == contender.median()) {
        contender.phases = match.entries[k].phases[round];
      }
    }
    if (contender.ns.empty()) continue;
    const Columns<Dim>& reference = match.entries.front().position;
    contender.errors.astray = (match.entries[k].position - reference).colwise().norm().maxCoeff() /
                              smallest_radius(match.bed);
  }
  std::erase_if(match.scene.contenders, [](const Contender& c) { return c.ns.empty(); });
}

}  // namespace

Contest::Contest(const FigureOptions& options, const std::optional<fs::path>& lammps)
    : options_(options), lammps_(lammps) {
  check_stop_ = [this] {
    options_.check_stop();
    options_.progress(fraction_, doing_);
  };
}

/// A contender that fails leaves the others running; the triangulation must not fail.
template <int Dim, class F>
void Contest::unless_it_fails(Match<Dim>& match, std::size_t k, F&& f) {
  try {
    f();
  } catch (const SimulationError& error) {
    options_.check_stop();  // Ctrl-C reaches LAMMPS too
    if (k == 0) throw;
    auto& entry = match.entries[k];
    results_.notes.push_back(match.scene.name + ", " + entry.name + ": " + error.what());
    entry.out = true;
    entry.running = nullptr;
  }
}

template <int Dim>
void Contest::compete(const std::vector<std::unique_ptr<Match<Dim>>>& matches) {
  const auto for_each_entry = [&](auto&& f) {
    for (const auto& match : matches) {
      for (std::size_t k = 0; k < match->entries.size(); ++k) {
        if (!match->entries[k].out) f(*match, k);
      }
    }
  };
  for (int round = 0; round < matches.front()->plan.rounds; ++round) {
    const bool careful = round == 0;
    for_each_entry([&](Match<Dim>& match, std::size_t k) {
      auto& entry = match.entries[k];
      doing_ = match.scene.name + ": " + entry.name + ", round " + std::to_string(round + 1);
      check_stop_();
      unless_it_fails(match, k, [&] { entry.running = entry.start(careful); });
    });
    for (int turn = 0; turn < kTurns; ++turn) {
      for_each_entry([&](Match<Dim>& match, std::size_t k) {
        check_stop_();
        unless_it_fails(match, k, [&] { match.entries[k].running->take_turn(turn); });
      });
    }
    for_each_entry([&](Match<Dim>& match, std::size_t k) {
      unless_it_fails(match, k,
                      [&] { note(match, k, careful, match.entries[k].running->sample()); });
      match.entries[k].running = nullptr;
    });
  }
  for (const auto& match : matches) {
    finish(*match);
    results_.scenes.push_back(match->scene);
  }
}

template <int Dim>
std::unique_ptr<Match<Dim>> Contest::prepare(const std::string& group, const std::string& what,
                                             const Bed<Dim>& its_bed, const Plan& its_plan,
                                             double parameter) {
  auto match = std::make_unique<Match<Dim>>();
  match->bed = its_bed;
  match->plan = its_plan;
  const Bed<Dim>& bed = match->bed;
  const Plan& plan = match->plan;
  SceneSpeed& scene = match->scene;
  scene.group = group;
  scene.name = grouped(bed.count()) + " " + what;
  if (group != kSettledGroup && group != kGrowthGroup) {
    scene.name = what + " (" + grouped(bed.count()) + ")";
  }
  scene.dimension = Dim;
  scene.grains = bed.count();
  scene.steps = plan.steps;
  scene.time_step = bed.setting.time_step;
  scene.parameter = parameter;

  const auto add = [&]<class N>(const char* name, N neighbourhood) {
    auto& entry = match->entries.emplace_back();
    entry.name = name;
    entry.start = [&bed, &plan, neighbourhood](bool careful) {
      return std::make_unique<LagrainRun<Dim, N>>(bed, plan, neighbourhood, careful);
    };
  };
  doing_ = scene.name;
  add(kTriangulation, TriangulationNeighbourhood<Dim>{});
  if (plan.oracle) {
    add(kOracle, Oracle<Dim>(record_answers<Dim>(bed, plan.warm_up + plan.steps, check_stop_)));
  }
  add(kCells, CellGrid<Dim>{});
  if (plan.rebuilt) add(kRebuilt, RebuiltTriangulation<Dim>{});
  if (lammps_ && plan.lammps) {
    const auto add_lammps = [&](const char* name, bool multi) {
      const fs::path folder =
          options_.out / "lammps" / folder_name(scene.name + (multi ? " multi" : ""));
      auto& entry = match->entries.emplace_back();
      entry.name = name;
      entry.start = [this, &bed, &plan, folder, multi](bool careful) {
        return std::make_unique<LammpsTurns<Dim>>(*lammps_, folder, bed, plan, multi, careful);
      };
    };
    if (plan.bin) add_lammps(kLammps, false);
    if (plan.multi) add_lammps(kLammpsMulti, true);
  }
  scene.contenders.resize(match->entries.size());
  return match;
}

template std::unique_ptr<Match<2>> Contest::prepare<2>(const std::string&, const std::string&,
                                                       const Bed<2>&, const Plan&, double);
template std::unique_ptr<Match<3>> Contest::prepare<3>(const std::string&, const std::string&,
                                                       const Bed<3>&, const Plan&, double);
template void Contest::compete<2>(const std::vector<std::unique_ptr<Match<2>>>&);
template void Contest::compete<3>(const std::vector<std::unique_ptr<Match<3>>>&);

}  // namespace lagrain::bench
