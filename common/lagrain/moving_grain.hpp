// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// One grain on its way through a time step.

#include <lagrain/integrator.hpp>
#include <lagrain/records.hpp>
#include <lagrain/vec.hpp>

namespace lagrain {

/// The integrator applied to one grain: read from its records, moved on, stored again. A spin is
/// integrated like a velocity; nobody asks for its angle.
template <int Dim, Needs needs, Integrator Motion>
class MovingGrain {
 public:
  using Record = GrainRecord<Dim, needs>;  ///< where its place and velocity are kept
  using Load = LoadRecord<Dim, needs>;     ///< where its force is kept

  /// @param load  force and torque that were evaluated last
  MovingGrain(const Record& record, const Load& load)
      : x_(record.position()), v_(record.velocity()), a_(acceleration(record, load)) {
    if constexpr (needs.spin) {
      omega_ = record.omega();
      alpha_ = spin_acceleration(record, load);
      angle_ = omega_;
    }
  }

  const Vec<Dim>& position() const { return x_; }  ///< [m]

  /// Completes a step of length dt [s].
  /// @param before  force and torque of the evaluation before the last
  [[gnu::always_inline]] void finish(const Record& record, const Load& before, double dt) {
    Motion::finish(x_, v_, a_, acceleration(record, before), dt);
    if constexpr (needs.spin) {
      Motion::finish(angle_, omega_, alpha_, spin_acceleration(record, before), dt);
    }
  }
  /// Brings the grain to where the forces of an evaluation are wanted.
  [[gnu::always_inline]] void advance(int evaluation, double dt) {
    Motion::advance(evaluation, x_, v_, a_, dt);
    if constexpr (needs.spin) Motion::advance(evaluation, angle_, omega_, alpha_, dt);
  }
  /// Writes place, velocity and spin into its record.
  void store(Record& record) const {
    record.position() = x_;
    record.velocity() = v_;
    if constexpr (needs.spin) record.omega() = omega_;
  }

 private:
  static Vec<Dim> acceleration(const Record& record, const Load& load) {
    return record.at[Record::kInverseMass] * load.force();
  }
  static SpinVec<Dim> spin_acceleration(const Record& record, const Load& load) {
    return record.at[Record::kInverseInertia] * load.torque();
  }

  Vec<Dim> x_, v_, a_;
  SpinVec<Dim> angle_, omega_, alpha_;
};

}  // namespace lagrain
