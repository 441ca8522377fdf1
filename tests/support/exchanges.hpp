// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Grains that come and leave at random, the same in several simulations.

#include <lagrain/observe.hpp>

#include <support/motion_scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lagrain::test {

/// Those who leave, and those who come.
template <int Dim>
struct Traffic {
  std::vector<int> leavers;
  std::vector<Grain<Dim>> newcomers;
};

/// Each grain leaves with this probability. Half of them are followed by one that is smaller, so
/// that there is room for it, and some of these are followed by two that overlap.
template <int Dim, class S>
Traffic<Dim> random_traffic(const S& sim, double probability, Random& random) {
  Traffic<Dim> traffic;
  const auto& g = sim.grains();
  for (int i = 0; i < g.size(); ++i) {
    if (random.uniform() >= probability) continue;
    traffic.leavers.push_back(i);
    if (random.uniform() < 0.5) continue;
    Grain<Dim> heir;
    heir.position = g.position.col(i);
    heir.radius = std::max(0.9 * g.radius[i], 0.5);
    heir.mass = std::max(g.mass[i], 1.0);
    for (int d = 0; d < Dim; ++d) heir.velocity[d] = random.normal();
    for (int d = 0; d < kSpinDim<Dim>; ++d) heir.omega[d] = random.normal();
    traffic.newcomers.push_back(heir);
    if (random.uniform() < 0.8) continue;
    heir.position += 0.2 * heir.radius * oblique<Dim>();
    traffic.newcomers.push_back(heir);
  }
  return traffic;
}

/// Lets the same grains come and leave in two simulations at random, and compares them. The ledger
/// does not notice.
template <int Dim, class A, class B>
void check_exchanges(A& sim, B& reference, int exchanges, int steps_between, Random& random) {
  constexpr Needs needs = A::needs;
  std::vector<int> ids(static_cast<std::size_t>(sim.grains().size()));
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<int>(i);
  int next = static_cast<int>(ids.size());
  for (int k = 0; k < exchanges; ++k) {
    CAPTURE(k);
    const double balance = energy_ledger(sim).balance();
    const auto traffic = random_traffic<Dim>(sim, k % 5 == 4 ? 0.5 : 0.05, random);
    const auto newcomers = make_grains<Dim, needs>(traffic.newcomers);
    for (auto i = traffic.leavers.rbegin(); i != traffic.leavers.rend(); ++i) {
      ids.erase(ids.begin() + *i);
    }
    for (int c = 0; c < newcomers.size(); ++c) ids.push_back(next++);

    sim.exchange(traffic.leavers, newcomers);
    reference.exchange(traffic.leavers, newcomers);

    CHECK(sim.ids() == ids);
    CHECK(relative_error(energy_ledger(sim).balance(), balance) < 1e-11);
    REQUIRE(same_bits(sim, reference));
    sim.step(steps_between);
    reference.step(steps_between);
    REQUIRE(same_bits(sim, reference));
  }
}

}  // namespace lagrain::test
