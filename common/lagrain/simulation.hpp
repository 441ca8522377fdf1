// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The step loop of the distinct element method.

#include <lagrain/contact_law.hpp>
#include <lagrain/contact_scene.hpp>
#include <lagrain/deep_overlap.hpp>
#include <lagrain/grain_system.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/integrator.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/moving_grain.hpp>
#include <lagrain/setting.hpp>
#include <lagrain/simulation_input.hpp>
#include <lagrain/stopwatch.hpp>
#include <lagrain/time_step.hpp>
#include <lagrain/walls.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

/// A simulation composed at compile time: dimension, contact law (with or without friction),
/// integrator, neighbourhood. The law decides what the grains and the contacts carry.
///
/// It follows the scheme of Ferrez & Liebling (2000), section 3:
///
///     1  Construct the initial triangulation T      the constructor
///     2  Detect contacts along the edges of T       evaluate_forces, by ContactForces
///     3  Apply some law at every contact point      the same, contact by contact
///     4  Update the trajectories                    update_trajectories
///     5  Update T with local operations             update_triangulation
///     6  Go back to 2                               step
///
/// Steps 2 and 3 are one pass over a list of near pairs (NearList): those edges of T whose grains
/// are so close that they might touch before the list is made again. Step 5 does nothing while that
/// list holds. Grains lie in slots (GrainStore), and blocks of slots are what threads share.
///
/// Forces are summed in an order fixed by the slots, so every neighbourhood, instruction set
/// and number of threads gives the same trajectory, bit for bit. One object is for one caller
/// at a time.
template <int Dim, ContactLaw<Dim> Law, Integrator Motion, Neighbourhood<Dim> N>
class Simulation : public GrainSystem<Dim, Law, N> {
  using System = GrainSystem<Dim, Law, N>;

 public:
  using System::needs;
  /// What contacts of two grains remember.
  using PairMemories = typename System::PairMemories;
  /// What contacts with walls remember.
  using WallMemories = typename System::WallMemories;

  /// Evaluates the forces at time 0.
  /// @throws ContractError if the time step is not safe (the message names the safe one), a
  /// material is not in the table of laws, or the integrator cannot integrate the scene.
  Simulation(Grains<Dim, needs> grains, LawTable<Law> laws, std::vector<Wall<Dim>> walls,
             Setting<Dim> setting, N neighbourhood = {})
      : System(std::move(grains), std::move(laws), std::move(walls), std::move(setting),
               std::move(neighbourhood)) {
    expect_known_materials(store_.by_number(), laws_, walls_);
    expect_safe_step(setting_.time_step, time_scales(store_.by_number(), laws_, walls_));
    expect_integrable<Motion>(laws_, walls_);
    if (!is_steady(setting_.gravity_course)) expect_no_change("gravity may change");
    update_triangulation(0);  // step 1: there is none yet
    force_step_ = 0;          // memories and energies do not advance
    evaluate_forces(0, {});
    force_step_ = Motion::kConservativeOnly ? 0 : setting_.time_step;
    flow_ = {};
    store_.outdate();
  }

  /// So many time steps; the same, bit for bit, whether they are asked for together or one by one.
  /// Together they take less time where memory decides: nobody looks in between, so the grains of
  /// a block move on as soon as their forces are known, while they are in the cache.
  /// @throws SimulationError if a grain is lost to NaN, two overlap beyond the limit, or one passes
  ///         through another or a wall within a step; the grains may be a step further by then.
  void step(std::int64_t count = 1) {
    store_.outdate();
    bool advanced = false;  // to where the next forces are wanted
    for (; count > 0; --count) {
      if (store_.sort_is_due(steps_)) sort_grains();
      for (int k = 0; k < Motion::kEvaluations; ++k) {
        const double t = instant(steps_, k);
        advance_walls(t, Motion::time_of(k) * setting_.time_step);
        if (!advanced) advance_trajectories(k, t);
        expect_no_passage(t);
        update_triangulation(t);
        const bool ends = k + 1 == Motion::kEvaluations;
        advanced = !ends || (count > 1 && !store_.sort_is_due(steps_ + 1));
        evaluate_forces(t, {.finish = ends,
                            .advance = advanced,
                            .evaluation = ends ? 0 : k + 1,
                            .time = ends ? instant(steps_ + 1, 0) : instant(steps_, k + 1)});
      }
      ++steps_;
    }
  }

  /// Gravity is g [m/s^2] from now on, and steady. The energy that this brings is in flow().
  /// @throws ContractError if the integrator is for conservative scenes
  void set_gravity(const Vec<Dim>& g) {
    expect_no_change("gravity may change");
    this->set_gravity_to(g);
  }

  /// Another force acts on every grain from now on, besides weight and contacts. It is added before
  /// the first step, or between two: there it acts from the next half step on.
  /// @param name  in the list of works
  /// @throws ContractError if the integrator is for conservative scenes, or the force slows a grain
  ///         down too fast for the time step
  template <BodyForce<Dim> F>
  void add_force(std::string name, F force) {
    expect_no_change("body forces may act");
    if constexpr (requires { force.slowing(1.0, 1.0); }) {
      for (int i = 0; i < this->count(); ++i) {
        const double taken =
            setting_.time_step * force.slowing(this->radii()[i], this->masses()[i]);
        LAGRAIN_EXPECTS(taken <= kMostTaken, name + " takes " + std::to_string(taken) +
                                                 " of the velocity of grain " + std::to_string(i) +
                                                 " in a step");
      }
    }
    body_forces_.add(std::move(name), std::move(force), store_, this->time());
    store_.outdate();
  }

  /// Between two steps, grains leave and others come. The others keep their ids, their order, the
  /// forces on them and what their contacts remember. Only where a leaver touched them, or a
  /// newcomer does, are forces evaluated anew. The energy that comes and goes is in flow().
  /// @param leavers    numbers, in increasing order
  /// @param newcomers  get the numbers that follow those of the others, and new ids
  /// @throws ContractError if a number is not that of a grain, the time step is not safe for the
  ///         newcomers, their material is unknown, or the integrator is for conservative scenes;
  ///         nothing has changed then
  void exchange(const std::vector<int>& leavers, const Grains<Dim, needs>& newcomers) {
    expect_no_change("grains may leave");
    std::vector<int> kept;
    auto leaver = leavers.begin();
    for (int i = 0; i < this->count(); ++i) {
      if (leaver != leavers.end() && *leaver == i) {
        ++leaver;
      } else {
        kept.push_back(i);
      }
    }
    LAGRAIN_EXPECTS(leaver == leavers.end(),
                    "leaver " + std::to_string(*leaver) + " is no grain, or out of order");
    if (newcomers.size() > 0) {
      expect_known_materials(newcomers, laws_, walls_);
      expect_safe_step(setting_.time_step,
                       time_scales(joined(store_.by_number(), kept, newcomers), laws_, walls_));
    }
    const auto changed = exchange_grains(kept, newcomers);
    evaluate_anew([&](int i) { return changed.grains[static_cast<std::size_t>(i)]; },
                  [&](std::size_t w) { return changed.walls[w]; });
  }

  /// Before the first step: contacts remember what they remembered in another simulation, from
  /// which the grains come. Who does not touch any more forgets.
  /// @param pairs       by number, as the first sees the contact
  /// @param wall_pairs  by number
  /// @throws ContractError if steps were made, or a pair is not one of grains or of a grain and a
  ///         piece of a wall
  void recall(PairMemories pairs, WallMemories wall_pairs) {
    LAGRAIN_EXPECTS(steps_ == 0,
                    "contacts recall before the first step, not after " + std::to_string(steps_));
    const auto is_grain = [&](int i) { return 0 <= i && i < this->count(); };
    for (const auto& entry : pairs) {
      const Pair& pair = entry.first;
      LAGRAIN_EXPECTS(is_grain(pair.i) && is_grain(pair.j) && pair.i != pair.j,
                      "pair " + std::to_string(pair.i) + ", " + std::to_string(pair.j));
    }
    for (const auto& entry : wall_pairs) {
      const WallPair& pair = entry.first;
      const bool is_wall = 0 <= pair.wall && static_cast<std::size_t>(pair.wall) < walls_.size();
      LAGRAIN_EXPECTS(is_grain(pair.i) && is_wall && 0 <= pair.piece &&
                          pair.piece < walls_[static_cast<std::size_t>(pair.wall)].piece_count(),
                      "grain " + std::to_string(pair.i) + " and piece " +
                          std::to_string(pair.piece) + " of wall " + std::to_string(pair.wall));
    }
    this->recall_contacts(std::move(pairs), std::move(wall_pairs));
    evaluate_anew([](int) { return true; }, [](std::size_t) { return true; });
  }

 private:
  using System::advance_walls, System::exchange_grains, System::expect_no_passage,
      System::for_each_block, System::sort_grains, System::update_triangulation;
  using System::body_forces_, System::driven_, System::driven_in_blocks_, System::driven_load_;
  using System::flow_, System::force_step_, System::forces_, System::laws_, System::measuring_,
      System::near_, System::setting_, System::steps_, System::store_, System::strays_,
      System::team_, System::times_, System::walls_, System::watch_;
  using typename System::Load;
  using typename System::Record;
  using Moving = MovingGrain<Dim, needs, Motion>;

  /// What grains do once forces are known.
  struct Then {
    bool finish = false;   ///< the step
    bool advance = false;  ///< to where the next forces are wanted
    int evaluation = 0;    ///< which ones they are
    double time = 0;       ///< and when [s]
  };

  /// When the forces of an evaluation are wanted [s].
  double instant(std::int64_t step, int evaluation) const {
    return static_cast<double>(step) * setting_.time_step +
           Motion::time_of(evaluation) * setting_.time_step;
  }

  /// Steps 2 and 3 of the paper: forces where the grains are. f(block, loads of its grains) goes on
  /// with a block once its own are known: nobody else reads its places then.
  /// @param time_step  by which memories and losses advance [s]
  /// @param t          time [s]
  template <class F>
  void find_forces(double time_step, double t, F&& f) {
    const ContactScene<Dim, Law> scene{
        store_.records().data(), nullptr,   &store_.materials(),     &laws_,
        walls_.data(),           time_step, setting_.largest_overlap};
    forces_.begin(near_, walls_, setting_.threads);
    if (near_.blocks().size() > 1) {
      for_each_block(
          [&](std::size_t b, std::size_t) { forces_.keep_pairs_across(scene, near_, b); });
    }
    const std::size_t blocks = near_.blocks().size();
    body_forces_.begin(blocks);
    driven_in_blocks_.resize(driven_.empty() ? 0 : blocks);
    for_each_block([&](std::size_t b, std::size_t thread) {
      Load* loads = forces_.detect_and_apply_law(scene, near_, b, thread, store_, setting_.gravity);
      const auto& block = near_.blocks()[b];
      if (!body_forces_.empty()) {
        body_forces_.add_to(loads, &store_.record(block.first_slot),
                            block.end_slot - block.first_slot, b, t);
      }
      if (!driven_.empty()) {
        driven_in_blocks_[b] = this->driven_in(block.first_slot, block.end_slot, loads);
      }
      f(b, loads);
    });
    body_forces_.end(time_step);
    const double power = driven_load_.power;
    driven_load_ = {};
    for (const auto& part : driven_in_blocks_) driven_load_ += part;
    flow_.driven_work += 0.5 * time_step * (power + driven_load_.power);
  }

  /// Forces where grains and walls are now, between two steps: nothing advances.
  /// @param grain_takes  whether a grain takes its new force: grain_takes(number)
  /// @param wall_takes   the same for walls
  template <class GrainTakes, class WallTakes>
  void evaluate_anew(GrainTakes&& grain_takes, WallTakes&& wall_takes) {
    find_forces(0, this->time(), [&](std::size_t b, const Load* loads) {
      const auto& block = near_.blocks()[b];
      for (int slot = block.first_slot; slot < block.end_slot; ++slot) {
        if (grain_takes(store_.number(slot))) store_.load(slot) = loads[slot - block.first_slot];
      }
    });
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      if (!wall_takes(w)) continue;
      const WallLoad<Dim> load = forces_.wall_load(w);
      walls_[w].force = load.force;
      walls_[w].torque = load.torque;
    }
    store_.outdate();
  }

  static void expect_no_change(const char* change) {
    LAGRAIN_EXPECTS(!Motion::kConservativeOnly,
                    std::string(Motion::kName) + " integrates conservative scenes: no " + change);
  }

  /// Steps 2 to 4 of the paper, where the grains are at time t [s].
  void evaluate_forces(double t, const Then& then) {
    this->advance_gravity(t);
    move_seconds_.assign(near_.blocks().size(), 0);
    find_forces(force_step_, t, [&](std::size_t b, const Load* loads) {
      const Stopwatch watch(measuring_);
      update_trajectories(b, loads, t, then);
      move_seconds_[b] = watch.seconds();
    });
    const auto [tally, pair_seconds, wall_seconds] = forces_.totals();
    const int threads = team_.size();
    times_.pairs += pair_seconds / threads;
    times_.walls += wall_seconds / threads;
    for (const double moving : move_seconds_) times_.integration += moving / threads;
    flow_.dashpot += tally.dashpot;
    flow_.friction += tally.friction;
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      const WallLoad<Dim> load = forces_.wall_load(w);
      walls_[w].force = load.force;
      walls_[w].torque = load.torque;
      const double work = -walls_[w].power_of(load) * force_step_;
      walls_[w].work += work;
      flow_.wall_work += work;
    }
    if (tally.excess > 0) {
      report_deep_overlap(
          forces_.deepest(), [&](int slot) { return store_.id(slot); }, walls_, t,
          setting_.largest_overlap);
    }
  }

  // ---- The paper's step 4 ----------------------------------------------------------------------

  /// The grains of a block go on with the forces that act on them now, at time t [s].
  void update_trajectories(std::size_t block, const Load* now, double t, const Then& then) {
    if (then.finish && then.advance) {
      go_on<true, true>(block, now, t, then);
    } else if (then.finish) {
      go_on<true, false>(block, now, t, then);
    } else if (then.advance) {
      go_on<false, true>(block, now, t, then);
    } else {
      go_on<false, false>(block, now, t, then);
    }
  }
  template <bool kFinish, bool kAdvance>
  void go_on(std::size_t block, const Load* now, double t, const Then& then) {
    const Vec<Dim> shift = near_.shift(then.time);
    const Vec<Dim> frame_way = shift - near_.shift(t);
    const int first = near_.blocks()[block].first_slot, end = near_.blocks()[block].end_slot;
    if (kAdvance) strays_[block].clear();
    for (int slot = first; slot < end; ++slot) {
      Record& record = store_.record(slot);
      Load& before = store_.load(slot);  // as the step began
      const Load& load = now[slot - first];
      if constexpr (kFinish || kAdvance) {
        const Vec<Dim> from = record.position();
        Moving grain(record, load);
        if constexpr (kFinish) grain.finish(record, before, setting_.time_step);
        if constexpr (kAdvance) advance(grain, block, slot, then.evaluation, shift);
        grain.store(record);
        if constexpr (kAdvance) watch_.note(block, slot, from, grain.position(), frame_way);
      }
      before = load;
    }
  }

  /// Brings all grains to where the forces of an evaluation are wanted, at time t [s].
  void advance_trajectories(int evaluation, double t) {
    const Stopwatch watch(measuring_);
    const Vec<Dim> shift = near_.shift(t);
    const Vec<Dim> frame_way = shift - near_.shift(watch_.since());
    const double since_forces = this->time() - watch_.since();  // 0, or a last drift of the step
    for_each_block([&](std::size_t block, std::size_t) {
      strays_[block].clear();
      const int end = near_.blocks()[block].end_slot;
      for (int slot = near_.blocks()[block].first_slot; slot < end; ++slot) {
        Record& record = store_.record(slot);
        const Vec<Dim> from = record.position() - since_forces * record.velocity();
        Moving grain(record, store_.load(slot));
        advance(grain, block, slot, evaluation, shift);
        grain.store(record);
        watch_.note(block, slot, from, grain.position(), frame_way);
      }
    });
    times_.integration += watch.seconds();
  }

  /// Also notes if the grain leaves its margin.
  void advance(Moving& grain, std::size_t block, int slot, int evaluation, const Vec<Dim>& shift) {
    grain.advance(evaluation, setting_.time_step);
    if (near_.listed() && !near_.holds(slot, grain.position(), shift)) {
      strays_[block].push_back(slot);
    }
  }

  std::vector<double> move_seconds_;  // of each block, in an evaluation
};

}  // namespace lagrain
