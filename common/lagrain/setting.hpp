// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `Setting` holds what a simulation is told besides its grains, walls and laws; `EnergyFlow` and
/// `PhaseTimes` are what it counts.

#include <lagrain/contact_kernel.hpp>
#include <lagrain/gravity.hpp>
#include <lagrain/state.hpp>
#include <lagrain/vec.hpp>

namespace lagrain {

/// What is the same for all grains.
template <int Dim>
struct Setting {
  Vec<Dim> gravity = Vec<Dim>::Zero();  ///< at the start, and of a simulation now [m/s^2]
  double time_step = 0;                 ///< [s]
  /// Of the smaller radius; beyond it, and where something passes through something within a step,
  /// the run stops. Infinite: it never does [-].
  double largest_overlap = kLargestOverlap;
  int threads = 1;  ///< at most so many share a step; results do not depend on it
  InstructionSet instructions = instruction_sets().back();  ///< nor on this
  GravityCourse<Dim> gravity_course = SteadyGravity{};      ///< how gravity changes
};

/// Energy that has come and gone since the start [J].
struct EnergyFlow {
  double wall_work = 0;     ///< by moving walls on the grains
  double dashpot = 0;       ///< taken by normal dashpots
  double friction = 0;      ///< taken by friction
  double carried = 0;       ///< by grains that came, less that of grains that left
  double gravity_work = 0;  ///< by whoever changes gravity, on the grains in it
  double driven_work = 0;   ///< by driven grains on the others

  /// Keeps or restores it.
  void persist(StateVisitor visit) {
    visit("wall_work", wall_work);
    visit("dashpot", dashpot);
    visit("friction", friction);
    visit("carried", carried);
    visit("gravity_work", gravity_work);
    visit("driven_work", driven_work);
  }
};

/// What the others exert on the driven grains, all together, and what these do to them.
template <int Dim>
struct DrivenLoad {
  Vec<Dim> force = Vec<Dim>::Zero();           ///< without weights [N]
  SpinVec<Dim> torque = SpinVec<Dim>::Zero();  ///< about the centre of each [N m]
  double power = 0;                            ///< that driving them takes [W]

  /// Of several parts, in their order.
  DrivenLoad& operator+=(const DrivenLoad& other) {
    force += other.force;
    torque += other.torque;
    power += other.power;
    return *this;
  }
  /// Keeps or restores it.
  void persist(StateVisitor visit) {
    visit("force", force);
    visit("torque", torque);
    visit("power", power);
  }
};

/// Wall-clock time spent so far [s]. What is done once per step is measured only if asked for.
struct PhaseTimes {
  double refresh = 0;  ///< of the near list, the triangulation's updates included
  // The others are shared by the threads: these are means over them.
  double integration = 0;  ///< with the test whether the near list still holds
  double pairs = 0;        ///< contacts between grains
  double walls = 0;        ///< contacts with walls
};

}  // namespace lagrain
