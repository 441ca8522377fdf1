// SPDX-License-Identifier: GPL-3.0-or-later
// A force of your own: charged grains in a magnetic field, which turns their velocities and does no
// work. A grain goes round in a circle of radius m v / (q B), once in 2 pi m / (q B).
// To build it: find_package(lagrain 0.1), lagrain::common.

#include <lagrain/all_pairs.hpp>
#include <lagrain/body_force.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/observe.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>

using namespace lagrain;

struct MagneticForce {
  double charge;  // of every grain [C]
  Vec<3> field;   // [T]
  Push<3> on(const GrainView<3>& grain, double) const {
    return {charge * grain.velocity.cross(field)};
  }
};

int main() {
  const double mass = 1e-3, charge = 1e-3, field = 2;  // [kg], [C], [T]
  const std::vector<Grain<3>> grains{{.velocity = {0.1, 0, 0}, .radius = 1e-3, .mass = mass}};
  const double period = 2 * std::numbers::pi * mass / (charge * field);  // [s]
  const LawTable laws(LinearSpring::with_restitution(10, 1));
  constexpr int kSteps = 10000;
  Simulation<3, LinearSpring, VelocityVerlet, AllPairs<3>> sim(
      make_grains<3, Needs{}>(grains), laws, {}, {.time_step = period / kSteps});
  sim.add_force("magnetic", MagneticForce{charge, {0, 0, field}});
  const Ledger start = energy_ledger(sim);
  const double radius = mass * 0.1 / (charge * field);  // [m]
  sim.step(kSteps / 2);
  const double across = sim.grains().position.col(0).norm();
  sim.step(kSteps / 2);
  const double off = sim.grains().position.col(0).norm();
  std::printf("half a turn: %.6f m, as the radius says %.6f m\n", across, 2 * radius);
  std::printf("a whole one: %.0e m from the start; work %.0e J, residual %.0e J\n", off,
              sim.body_forces().front().work, residual(energy_ledger(sim), start));
  if (!(std::abs(across / (2 * radius) - 1) < 1e-5 && off < 1e-5 * radius)) return 1;
}
