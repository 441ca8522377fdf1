#pragma once
/// @file
/// The step loop of the distinct element method.

#include <lagrain/check.hpp>
#include <lagrain/contact_law.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/integrator.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/near_list.hpp>
#include <lagrain/time_step.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

/// What is the same for all grains.
template <int Dim>
struct Setting {
  Vec<Dim> gravity = Vec<Dim>::Zero();  ///< [m/s^2]
  double time_step = 0;                 ///< [s]
  double largest_overlap = 0.3;         ///< of the smaller radius; beyond it the run stops [-]
};

/// Energy that has come and gone since the start [J].
struct EnergyFlow {
  double wall_work = 0;  ///< by moving walls on the grains
  double dashpot = 0;    ///< taken by normal dashpots
  double friction = 0;   ///< taken by friction
};

/// A simulation composed at compile time: dimension, contact law (with or without friction),
/// integrator, neighbourhood. The law decides what the grains and the contacts carry.
///
/// The paper's scheme: detect contacts along the near edges of the triangulation (step 2), apply
/// the law (3), integrate (4), update the triangulation when the near list has expired (5).
///
/// Forces are summed in an order fixed by the grains' numbers, so every neighbourhood gives the
/// same trajectory, bit for bit. Not thread-safe.
template <int Dim, ContactLaw<Dim> Law, class Motion, Neighbourhood<Dim> N>
class Simulation {
 public:
  static constexpr Needs needs = Law::needs;
  using State = Grains<Dim, needs>;
  using Memory = typename Law::template Memory<Dim>;

  /// Evaluates the forces at time 0.
  /// @throws ContractError if the time step is not safe (the message names the safe one), or a kind
  /// is not in the table of laws.
  Simulation(State grains, LawTable<Law> laws, std::vector<Wall<Dim>> walls, Setting<Dim> setting,
             N neighbourhood = {}, Motion motion = {})
      : grains_(std::move(grains)),
        laws_(std::move(laws)),
        walls_(std::move(walls)),
        setting_(std::move(setting)),
        neighbourhood_(std::move(neighbourhood)),
        motion_(std::move(motion)) {
    check_kinds();
    const TimeScales scales = time_scales(grains_, laws_, walls_);
    std::ostringstream message;
    message << "time step " << setting_.time_step << " s: the stiffest contact lasts "
            << scales.contact << " s and allows at most " << scales.safe_step << " s";
    LAGRAIN_EXPECTS(setting_.time_step > 0 && setting_.time_step <= scales.safe_step,
                    message.str());
    if (Motion::kConservativeOnly) check_conservative();
    for (Wall<Dim>& wall : walls_) wall.advance(0, 0);
    evaluate_forces(0);  // with force_step_ = 0: memories and energies do not advance
    force_step_ = Motion::kConservativeOnly ? 0 : setting_.time_step;
    flow_ = {};
  }

  /// One time step.
  /// @throws SimulationError if a grain is lost to NaN or two overlap beyond the limit.
  void step() {
    const double start = time();
    auto forces = [&](double t) {
      for (Wall<Dim>& wall : walls_) wall.advance(start + t, t);
      evaluate_forces(start + t);
    };
    motion_.step(grains_, setting_.time_step, forces);
    ++steps_;
  }

  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * setting_.time_step; }  ///< [s]
  const State& grains() const { return grains_; }
  const std::vector<Wall<Dim>>& walls() const { return walls_; }
  const LawTable<Law>& laws() const { return laws_; }
  const Setting<Dim>& setting() const { return setting_; }
  const NearList<Dim, Memory>& near() const { return near_; }
  const N& neighbourhood() const { return neighbourhood_; }
  const EnergyFlow& flow() const { return flow_; }

  /// Wall-clock time spent so far on knowing the near pairs: tests whether the list has expired,
  /// and refreshes [s].
  double neighbourhood_seconds() const {
    return std::chrono::duration<double>(neighbourhood_time_).count();
  }

  /// Visits every grain-grain contact: f(pair, touch, response, memory).
  template <class F>
  void for_each_contact(F&& f) const {
    for (std::size_t k = 0; k < near_.grains.pairs.size(); ++k) {
      const Pair pair = near_.grains.pairs[k];
      Touch<Dim> touch;
      if (!touching(pair, touch)) continue;
      Memory memory = memory_of(near_.grains, k);
      f(pair, touch, laws_.of(grains_.kind, pair.i, pair.j).respond(touch, memory, 0), memory);
    }
  }

  /// Visits every wall contact: f(wall pair, touch, response, memory).
  template <class F>
  void for_each_wall_contact(F&& f) const {
    for (std::size_t k = 0; k < near_.walls.pairs.size(); ++k) {
      const WallPair pair = near_.walls.pairs[k];
      const Wall<Dim>& wall = walls_[static_cast<std::size_t>(pair.wall)];
      Touch<Dim> touch;
      if (!touching(pair, wall, touch)) continue;
      Memory memory = memory_of(near_.walls, k);
      f(pair, touch, laws_.with_wall(grains_.kind, pair.i, wall.kind).respond(touch, memory, 0),
        memory);
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  void evaluate_forces(double t) {
    const auto start = Clock::now();
    if (near_.expired(grains_.position, walls_, t)) {
      check_finite();
      near_.refresh(grains_, walls_, neighbourhood_, t, setting_.time_step, steps_);
    }
    neighbourhood_time_ += Clock::now() - start;
    for (Eigen::Index i = 0; i < grains_.force.cols(); ++i) {
      grains_.force.col(i) = grains_.mass[i] * setting_.gravity;
    }
    if constexpr (needs.spin) grains_.torque.setZero();
    for (Wall<Dim>& wall : walls_) wall.force.setZero();
    deepest_ = {};
    grain_forces();
    wall_forces();
    if (deepest_.ratio > setting_.largest_overlap) report_deep_overlap();
  }

  void grain_forces() {
    const std::size_t count = near_.grains.pairs.size();
    for (std::size_t k = 0; k < count; ++k) {
      const auto [i, j] = near_.grains.pairs[k];
      Touch<Dim> touch;
      if (!touching({i, j}, touch)) {
        forget(near_.grains, k);
        continue;
      }
      const Response<Dim> response = respond(laws_.of(grains_.kind, i, j), touch, near_.grains, k);
      grains_.force.col(i) += response.force;
      grains_.force.col(j) -= response.force;
      if constexpr (needs.spin) {
        // Both forces act at one point, so that angular momentum is conserved exactly.
        const Vec<Dim> arm_i = -(grains_.radius[i] - 0.5 * touch.overlap) * touch.normal;
        const Vec<Dim> arm_j = (grains_.radius[j] - 0.5 * touch.overlap) * touch.normal;
        grains_.torque.col(i) += torque(arm_i, response.force);
        grains_.torque.col(j) -= torque(arm_j, response.force);
      }
      note_overlap(touch.overlap, std::min(grains_.radius[i], grains_.radius[j]), i, j);
    }
  }

  void wall_forces() {
    const std::size_t count = near_.walls.pairs.size();
    for (std::size_t k = 0; k < count; ++k) {
      const auto [w, i] = near_.walls.pairs[k];
      Wall<Dim>& wall = walls_[static_cast<std::size_t>(w)];
      Touch<Dim> touch;
      if (!touching(WallPair{w, i}, wall, touch)) {
        forget(near_.walls, k);
        continue;
      }
      const Response<Dim> response =
          respond(laws_.with_wall(grains_.kind, i, wall.kind), touch, near_.walls, k);
      grains_.force.col(i) += response.force;
      wall.force -= response.force;
      flow_.wall_work += response.force.dot(wall.velocity) * force_step_;
      if constexpr (needs.spin) {
        const Vec<Dim> arm = -(grains_.radius[i] - touch.overlap) * touch.normal;
        grains_.torque.col(i) += torque(arm, response.force);
      }
      note_overlap(touch.overlap, grains_.radius[i], i, -1 - w);
    }
  }

  /// Fills in the touch of two grains; false if they do not touch.
  bool touching(Pair pair, Touch<Dim>& touch) const {
    const auto [i, j] = pair;
    const double inverse_mass = grains_.inverse_mass[i] + grains_.inverse_mass[j];
    if (inverse_mass == 0) return false;  // both are pinned
    const Vec<Dim> between = grains_.position.col(i) - grains_.position.col(j);
    const double reach = grains_.radius[i] + grains_.radius[j];
    const double squared = between.squaredNorm();
    if (!(squared < reach * reach)) return false;
    const double distance = std::sqrt(squared);
    touch.overlap = reach - distance;
    // Coincident centres have no direction of their own; any fixed one parts them.
    touch.normal = distance > 0 ? Vec<Dim>(between / distance) : Vec<Dim>(Vec<Dim>::UnitX());
    Vec<Dim> velocity = grains_.velocity.col(i) - grains_.velocity.col(j);
    touch.closing = -velocity.dot(touch.normal);
    if constexpr (needs.spin) {
      const double half = 0.5 * touch.overlap;
      velocity -= cross(SpinVec<Dim>((grains_.radius[i] - half) * grains_.omega.col(i) +
                                     (grains_.radius[j] - half) * grains_.omega.col(j)),
                        touch.normal);
      touch.slip = velocity + touch.closing * touch.normal;
    }
    if constexpr (needs.memory) {
      touch.twist =
          about(touch.normal, SpinVec<Dim>(0.5 * (grains_.omega.col(i) + grains_.omega.col(j))));
    }
    touch.effective_mass = 1 / inverse_mass;
    touch.effective_radius = grains_.radius[i] * grains_.radius[j] / reach;
    return true;
  }

  /// Fills in the touch of a grain with a wall; false if they do not touch.
  bool touching(WallPair pair, const Wall<Dim>& wall, Touch<Dim>& touch) const {
    const int i = pair.i;
    const auto [distance, normal] = wall.foot(grains_.position.col(i));
    touch.overlap = grains_.radius[i] - distance;
    if (!(touch.overlap > 0)) return false;
    touch.normal = normal;
    Vec<Dim> velocity = grains_.velocity.col(i) - wall.velocity;
    touch.closing = -velocity.dot(normal);
    if constexpr (needs.spin) {
      velocity -= cross(SpinVec<Dim>(distance * grains_.omega.col(i)), normal);
      touch.slip = velocity + touch.closing * normal;
    }
    if constexpr (needs.memory) {
      touch.twist = about(normal, SpinVec<Dim>(0.5 * grains_.omega.col(i)));
    }
    touch.effective_mass = grains_.mass[i];
    touch.effective_radius = grains_.radius[i];
    return true;
  }

  template <class P>
  static Memory memory_of(const PairTable<P, Memory>& table, std::size_t k) {
    if constexpr (PairTable<P, Memory>::kRemembers) return table.memory[k];
    return Memory{};
  }

  template <class P>
  static void forget(PairTable<P, Memory>& table, std::size_t k) {
    if constexpr (PairTable<P, Memory>::kRemembers) table.memory[k] = Memory{};
  }

  template <class P>
  Response<Dim> respond(const Law& law, const Touch<Dim>& touch, PairTable<P, Memory>& table,
                        std::size_t k) {
    Memory none;
    Memory* memory = &none;
    if constexpr (PairTable<P, Memory>::kRemembers) memory = &table.memory[k];
    const Response<Dim> response = law.respond(touch, *memory, force_step_);
    flow_.dashpot += response.dashpot_loss;
    flow_.friction += response.friction_loss;
    return response;
  }

  void note_overlap(double overlap, double smaller_radius, int i, int j) {
    if (overlap > deepest_.ratio * smaller_radius) {
      deepest_ = {overlap / smaller_radius, i, j};
    }
  }

  [[noreturn]] void report_deep_overlap() const {
    std::ostringstream message;
    message << "t = " << time() << " s: grain " << deepest_.i << " overlaps ";
    if (deepest_.j >= 0) {
      message << "grain " << deepest_.j;
    } else {
      message << "wall " << walls_[static_cast<std::size_t>(-1 - deepest_.j)].name;
    }
    message << " by " << deepest_.ratio << " of the smaller radius (limit "
            << setting_.largest_overlap
            << "); a stiffer contact, a smaller time step or a gentler start would help";
    throw SimulationError(message.str());
  }

  void check_finite() const {
    for (int i = 0; i < grains_.size(); ++i) {
      if (grains_.position.col(i).allFinite() && grains_.velocity.col(i).allFinite()) continue;
      std::ostringstream message;
      message << "t = " << time() << " s: grain " << i
              << " has a place or velocity that is not a number; a smaller time step would help";
      throw SimulationError(message.str());
    }
  }

  void check_kinds() const {
    const int kinds = laws_.kinds();
    const std::string have = ", but the table of laws has " + std::to_string(kinds) + " kinds";
    LAGRAIN_EXPECTS(kinds >= 1, "the table of laws is empty");
    for (std::size_t i = 0; i < grains_.kind.size(); ++i) {
      LAGRAIN_EXPECTS(grains_.kind[i] < kinds, "grain " + std::to_string(i) + " is of kind " +
                                                   std::to_string(grains_.kind[i]) + have);
    }
    for (const Wall<Dim>& wall : walls_) {
      LAGRAIN_EXPECTS(wall.kind >= 0 && wall.kind < kinds,
                      "wall " + wall.name + " is of kind " + std::to_string(wall.kind) + have);
    }
  }

  void check_conservative() const {
    const auto kinds = static_cast<std::size_t>(laws_.kinds());
    for (std::size_t k = 0; k < kinds * kinds; ++k) {
      LAGRAIN_EXPECTS(
          laws_.between(k / kinds, k % kinds).conservative(),
          std::string(Motion::kName) + " integrates conservative scenes: restitution 1");
    }
    for (const Wall<Dim>& wall : walls_) {
      LAGRAIN_EXPECTS(!wall.moves(), std::string(Motion::kName) +
                                         " integrates conservative scenes: wall " + wall.name +
                                         " moves");
    }
  }

  struct Deepest {
    double ratio = 0;
    int i = 0;
    int j = 0;  // -1 - w for wall w
  };

  State grains_;
  LawTable<Law> laws_;
  std::vector<Wall<Dim>> walls_;
  Setting<Dim> setting_;
  N neighbourhood_;
  Motion motion_;
  NearList<Dim, Memory> near_;
  EnergyFlow flow_;
  Deepest deepest_;
  double force_step_ = 0;  ///< what memories and losses advance by in an evaluation [s]
  std::int64_t steps_ = 0;
  Clock::duration neighbourhood_time_{0};
};

}  // namespace lagrain
