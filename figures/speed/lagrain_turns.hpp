// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The contender lagrain, with any neighbourhood.

#include "contenders.hpp"
#include "measure.hpp"
#include "turns.hpp"

#include <lagrain/audit.hpp>
#include <lagrain/observe.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lagrain::bench {

inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds of the wall clock that the simulation has spent so far, phase by phase; what it does not
/// name is the rest of the step.
template <class Sim>
std::vector<Phase> phases_so_far(const Sim& sim) {
  const PhaseTimes& t = sim.times();
  return {{"neighbourhood", 1e9 * t.refresh},
          {"grain forces", 1e9 * t.pairs},
          {"wall forces", 1e9 * t.walls},
          {"integration", 1e9 * t.integration}};
}

/// A simulation of a bed with a neighbourhood.
template <int Dim, class N>
class LagrainRun : public TurnTaker<Dim> {
 public:
  /// Takes the steps before those that are measured.
  /// @param careful measure the errors too, outside of the measured time
  LagrainRun(const Bed<Dim>& bed, const Plan& plan, N neighbourhood, bool careful)
      : bed_(bed),
        plan_(plan),
        careful_(careful),
        sim_(simulate<Dim, N>(bed, std::move(neighbourhood))) {
    sim_.measure_phases(true);
    sim_.step(plan.warm_up);
    if (careful) start_ = energy_ledger(sim_);
    refreshes_ = sim_.refreshes();
    before_ = phases_so_far(sim_);
  }

  void take_turn(int turn) override {
    const double wall = wall_seconds(), cpu = processor_seconds();
    sim_.step(plan_.steps / kTurns);
    cpu_ += processor_seconds() - cpu;
    wall_ += wall_seconds() - wall;
    if (!careful_ || (turn + 1) % (kTurns / kAudits) != 0) return;
    const std::vector<Pair> pairs = sim_.near_pairs();
    audit_.check(sim_.grains().position, sim_.grains().radius, pairs);
    near_ = static_cast<double>(pairs.size());
  }

  Sample<Dim> sample() override {
    Sample<Dim> sample;
    sample.cpu = cpu_;
    std::vector<Phase> spent = phases_so_far(sim_);
    for (std::size_t k = 0; k < spent.size(); ++k) spent[k].ns -= before_[k].ns;
    sample.phases = per_grain_step(spent, wall_, cpu_, grain_steps(bed_, plan_));
    sample.position = sim_.grains().position;
    if (careful_) sample.errors = errors();
    return sample;
  }

 private:
  static constexpr int kAudits = 4;  // in the course of the measured steps
  static_assert(kTurns % kAudits == 0);

  RunErrors errors() const {
    RunErrors errors;
    examine<Dim>(bed_, sim_.grains().position, sim_.grains().velocity, errors);
    errors.missed = static_cast<double>(audit_.missed());
    errors.audited = static_cast<double>(audit_.contacts());
    const Ledger end = energy_ledger(sim_);
    const double turnover =
        std::max({end.kinetic + end.elastic,
                  end.dashpot + end.friction - start_.dashpot - start_.friction, 1e-300});
    errors.energy_residual = residual(end, start_) / turnover;
    errors.near_per_contact = near_ / (errors.contacts_per_grain * bed_.count());
    errors.refreshes = 1000 * static_cast<double>(sim_.refreshes() - refreshes_) / plan_.steps;
    return errors;
  }

  const Bed<Dim>& bed_;
  const Plan& plan_;
  bool careful_;
  BedSimulation<Dim, N> sim_;
  Ledger start_;
  std::int64_t refreshes_ = 0;
  std::vector<Phase> before_;
  double cpu_ = 0, wall_ = 0;  // [s]
  ContactAudit<Dim> audit_;
  double near_ = 0;  // pairs in the list
};

/// What the triangulation answers in a run, for the oracle.
template <int Dim>
Answers<Dim> record_answers(const Bed<Dim>& bed, int steps, const StopCheck& check_stop) {
  RecordingNeighbourhood<Dim> recorder;
  const auto answers = recorder.answers();
  auto sim = simulate<Dim, RecordingNeighbourhood<Dim>>(bed, std::move(recorder));
  note_touching<Dim>(*answers, sim.grains().position, sim.grains().radius);
  for (int s = 0; s < steps; ++s) {
    sim.step();
    note_touching<Dim>(*answers, sim.grains().position, sim.grains().radius);
    if (s % 50 == 0) check_stop();
  }
  return std::move(*answers);
}

}  // namespace lagrain::bench
