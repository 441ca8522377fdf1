// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// LAMMPS as a contender.

#include "lammps.hpp"
#include "turns.hpp"

#include <filesystem>
#include <vector>

namespace lagrain::bench {

/// A run of LAMMPS on a bed, in a folder of its own.
template <int Dim>
class LammpsTurns : public TurnTaker<Dim> {
 public:
  LammpsTurns(const std::filesystem::path& program, const std::filesystem::path& folder,
              const Bed<Dim>& bed, const Plan& plan, bool multi, bool careful)
      : bed_(bed),
        plan_(plan),
        careful_(careful),
        run_(program, folder, bed, {plan.warm_up, plan.steps, kTurns, multi}) {}

  void take_turn(int) override { run_.take_turn(); }

  Sample<Dim> sample() override {
    const LammpsReport<Dim> report = run_.finish();
    Sample<Dim> sample;
    sample.cpu = report.cpu_seconds;
    std::vector<Phase> spent;
    for (const auto& [name, seconds] : report.phases) {
      if (name == "Neigh") spent.push_back({"neighbourhood", 1e9 * seconds});
      if (name == "Pair") spent.push_back({"grain forces", 1e9 * seconds});
      if (name == "Modify") spent.push_back({"walls and integration", 1e9 * seconds});
    }
    sample.phases =
        per_grain_step(spent, report.wall_seconds, report.cpu_seconds, grain_steps(bed_, plan_));
    sample.position = report.position;
    if (!careful_) return sample;
    RunErrors& errors = sample.errors;
    examine<Dim>(bed_, report.position, report.velocity, errors);
    errors.dangerous = static_cast<double>(report.dangerous);
    errors.near_per_contact =
        static_cast<double>(report.neighbours) / (errors.contacts_per_grain * bed_.count());
    errors.refreshes = 1000 * static_cast<double>(report.builds) / plan_.steps;
    return sample;
  }

 private:
  const Bed<Dim>& bed_;
  const Plan& plan_;
  bool careful_;
  LammpsRun<Dim> run_;
};

}  // namespace lagrain::bench
