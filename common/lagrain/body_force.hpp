// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Forces on single grains besides their weight: drag, fields, whatever a program thinks of.

#include <lagrain/grains.hpp>
#include <lagrain/records.hpp>
#include <lagrain/state.hpp>
#include <lagrain/vec.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

/// A grain, as a body force sees it.
template <int Dim>
struct GrainView {
  Vec<Dim> position;                         ///< [m]
  Vec<Dim> velocity;                         ///< [m/s]
  SpinVec<Dim> spin = SpinVec<Dim>::Zero();  ///< [rad/s]; zero where nothing spins
  double radius = 0;                         ///< [m]
  double mass = 0;                           ///< [kg]
};

/// What it does to the grain.
template <int Dim>
struct Push {
  Vec<Dim> force = Vec<Dim>::Zero();           ///< [N]
  SpinVec<Dim> torque = SpinVec<Dim>::Zero();  ///< [N m]; without effect where nothing spins
};

/// A body force is a small struct with one function: on(grain, t), at time t [s]. It must depend on
/// nothing else, so that every order of grains and every number of threads gives the same bits. One
/// that slows grains down may say how fast: slowing(radius, mass) [1/s]; a time step that is too
/// long for that is refused.
template <class F, int Dim>
concept BodyForce = std::copy_constructible<F> &&
    requires(const F& f, const GrainView<Dim>& grain) {
  { f.on(grain, 0.0) } -> std::convertible_to<Push<Dim>>;
};

/// The part of a velocity that a force may take in a step [-]. At 2, alone, it would turn it round;
/// contacts need some of the room that is left.
inline constexpr double kMostTaken = 0.5;

/// The drag of a fluid that flows steadily, linear in the velocity against it. It is Stokes' of a
/// sphere in a viscous fluid, 6 pi eta r (v - u) and 8 pi eta r^3 omega (Landau & Lifshitz, Fluid
/// Mechanics, section 20). Besides, or in the plane, every velocity decays at a given rate.
template <int Dim>
struct Drag {
  double viscosity = 0;              ///< eta; of spheres alone [Pa s]
  double rate = 0;                   ///< of the decay [1/s]
  Vec<Dim> flow = Vec<Dim>::Zero();  ///< velocity u of the fluid [m/s]

  /// Force over velocity, with the opposite sign [kg/s].
  double coefficient(double radius, double mass) const {
    return rate * mass + 6 * std::numbers::pi * viscosity * radius;
  }
  /// Torque over spin, with the opposite sign [kg m^2/s].
  double spin_coefficient(double radius) const {
    return 8 * std::numbers::pi * viscosity * radius * radius * radius;
  }
  /// How fast it slows a grain down, or its spin, whichever is faster [1/s].
  double slowing(double radius, double mass) const {
    return std::max(coefficient(radius, mass) / mass,
                    spin_coefficient(radius) / grain_inertia<Dim>(mass, radius));
  }
  /// See BodyForce.
  Push<Dim> on(const GrainView<Dim>& grain, double) const {
    return {-coefficient(grain.radius, grain.mass) * (grain.velocity - flow),
            -spin_coefficient(grain.radius) * grain.spin};
  }
};
static_assert(BodyForce<Drag<2>, 2> && BodyForce<Drag<3>, 3>);

/// The body forces of a simulation. Each is compiled into a loop over the grains of a block, behind
/// one virtual call for a block; a simulation that has none pays for none.
template <int Dim, Needs needs>
class BodyForces {
 public:
  using Record = GrainRecord<Dim, needs>;  ///< where a grain's place and velocity are
  using Load = LoadRecord<Dim, needs>;     ///< where forces are added

  /// The work of one of the forces.
  struct Work {
    std::string name;  ///< of the force
    double power = 0;  ///< at the last evaluation [W]
    double work = 0;   ///< on the grains since the start [J]
  };

  bool empty() const { return loops_.empty(); }              ///< whether there is none
  const std::vector<Work>& works() const { return works_; }  ///< in the order in which they came

  /// Keeps or restores what they have done.
  /// @throws SceneError if the state is that of other forces
  void persist(const StateVisitor& visit) {
    for (std::size_t k = 0; k < works_.size(); ++k) {
      StateVisitor force = visit.in(std::to_string(k));
      force("power", works_[k].power);
      force("work", works_[k].work);
    }
  }

  /// Adds a force to those that act from now on, and to the loads of all grains.
  /// @param store  the grains in their slots
  /// @param t      time [s]
  template <BodyForce<Dim> F, class Store>
  void add(std::string name, F force, Store& store, double t) {
    loops_.push_back(std::make_shared<const LoopOf<F>>(std::move(force)));
    double power = 0;
    for (int slot = 0; slot < store.count(); ++slot) {
      power += loops_.back()->add_to(&store.load(slot), &store.record(slot), 1, t);
    }
    works_.push_back({std::move(name), power, 0});
  }
  /// Makes room for an evaluation.
  void begin(std::size_t blocks) { powers_.assign(blocks * loops_.size(), 0.0); }
  /// Adds forces and torques on the grains of a block to their loads.
  /// @param grains  records of the block
  /// @param count   number of its grains
  /// @param t       time [s]
  void add_to(Load* loads, const Record* grains, int count, std::size_t block, double t) {
    for (std::size_t k = 0; k < loops_.size(); ++k) {
      powers_[block * loops_.size() + k] = loops_[k]->add_to(loads, grains, count, t);
    }
  }
  /// Adds up the work of a step of dt [s], by the trapezoidal rule: that is of second order, like
  /// the motion. The order of the sum is fixed by the blocks.
  void end(double dt) {
    for (std::size_t k = 0; k < loops_.size(); ++k) {
      double power = 0;
      for (std::size_t at = k; at < powers_.size(); at += loops_.size()) power += powers_[at];
      works_[k].work += 0.5 * dt * (works_[k].power + power);
      works_[k].power = power;
    }
  }

 private:
  struct Loop {
    virtual ~Loop() = default;
    /// @returns the power of the force [W]
    virtual double add_to(Load* loads, const Record* grains, int count, double t) const = 0;
  };
  template <class F>
  struct LoopOf final : Loop {
    explicit LoopOf(F f) : force(std::move(f)) {}
    double add_to(Load* loads, const Record* grains, int count, double t) const override {
      double power = 0;
      for (int k = 0; k < count; ++k) {
        const Record& record = grains[k];
        Load& load = loads[k];
        GrainView<Dim> grain{record.position(), record.velocity(), SpinVec<Dim>::Zero(),
                             record.radius(), load.at[Load::kMass]};
        if constexpr (needs.spin) grain.spin = record.omega();
        const Push<Dim> push = force.on(grain, t);
        load.force() += push.force;
        power += push.force.dot(grain.velocity);
        if constexpr (needs.spin) {
          load.torque() += push.torque;
          power += push.torque.dot(grain.spin);
        }
      }
      return power;
    }
    F force;
  };

  std::vector<std::shared_ptr<const Loop>> loops_;  // copies of a simulation share them
  std::vector<Work> works_;                         // of each force
  std::vector<double> powers_;                      // of each block and force [W]
};

}  // namespace lagrain
