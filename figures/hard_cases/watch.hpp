// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How the hard cases run: step by step, with the near list held against brute force.

#include "hard_cases.hpp"

#include <lagrain/run.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>

namespace lagrain::hard_cases {

inline constexpr std::int64_t kAuditEvery = 20;  // steps between two audits

/// Steps a run, holds its near list against brute force now and then, and notes what ends it.
/// @param after_audit  called after each of these checks
/// @param every        steps between two of them
template <int Dim>
void watch(Run<Dim>& run, std::int64_t steps, Outcome& outcome, const StopCheck& check_stop,
           const std::function<void()>& after_audit = {}, std::int64_t every = kAuditEvery) {
  ContactAudit<Dim> audit;
  try {
    for (std::int64_t k = 1; k <= steps; ++k) {
      run.step();
      if (k % every != 0 && k != steps) continue;
      audit.check(run.positions(), run.radii(), run.near_pairs(), run.rules());
      if (after_audit) after_audit();
      if (check_stop) check_stop();
    }
  } catch (const SimulationError& error) {
    outcome.stopped = error.what();
  }
  outcome.steps += run.steps();
  outcome.audited += audit.contacts();
  outcome.missed += audit.missed();
  for (int i = 0; i < run.count(); ++i) {
    const Vec<Dim> x = run.positions().col(i);
    const bool outside =
        std::any_of(run.walls().begin(), run.walls().end(),
                    [&](const Wall<Dim>& wall) { return !(wall.foot(x).distance > 0); });
    outcome.lost += outside || !x.allFinite();
  }
}

}  // namespace lagrain::hard_cases
