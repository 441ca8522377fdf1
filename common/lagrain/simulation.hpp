// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The step loop of the distinct element method.

#include <lagrain/check.hpp>
#include <lagrain/contact_forces.hpp>
#include <lagrain/contact_kernel.hpp>
#include <lagrain/contact_law.hpp>
#include <lagrain/deep_overlap.hpp>
#include <lagrain/grain_store.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/integrator.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/moving_grain.hpp>
#include <lagrain/near_list.hpp>
#include <lagrain/records.hpp>
#include <lagrain/setting.hpp>
#include <lagrain/simulation_input.hpp>
#include <lagrain/stopwatch.hpp>
#include <lagrain/threads.hpp>
#include <lagrain/time_step.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
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
class Simulation {
 public:
  static constexpr Needs needs = Law::needs;          ///< what the law needs
  using Memory = typename Law::template Memory<Dim>;  ///< what a contact remembers

  /// Evaluates the forces at time 0.
  /// @throws ContractError if the time step is not safe (the message names the safe one), a
  /// material is not in the table of laws, or the integrator cannot integrate the scene.
  Simulation(Grains<Dim, needs> grains, LawTable<Law> laws, std::vector<Wall<Dim>> walls,
             Setting<Dim> setting, N neighbourhood = {})
      : store_(std::move(grains), !laws.one_law()),
        laws_(std::move(laws)),
        walls_(std::move(walls)),
        setting_(std::move(setting)),
        neighbourhood_(std::move(neighbourhood)),
        forces_(setting_.instructions, store_.materials().empty()) {
    expect_known_materials(store_.by_number(), laws_, walls_);
    expect_safe_step(setting_.time_step, time_scales(store_.by_number(), laws_, walls_));
    expect_integrable<Motion>(laws_, walls_);
    use_threads(setting_.threads);
    for (Wall<Dim>& wall : walls_) wall.advance(0, 0);
    near_.reset(count(), std::max(kLeastBlock, (count() + kMostBlocks - 1) / kMostBlocks));
    strays_.resize(near_.blocks().size());

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
  /// @throws SimulationError if a grain is lost to NaN or two overlap beyond the limit; the grains
  ///         may be a step further by then.
  void step(std::int64_t count = 1) {
    store_.outdate();
    bool advanced = false;  // to where the next forces are wanted
    for (; count > 0; --count) {
      if (store_.sort_is_due(steps_)) sort_grains();
      for (int k = 0; k < Motion::kEvaluations; ++k) {
        const double t = instant(steps_, k);
        for (Wall<Dim>& wall : walls_) wall.advance(t, Motion::time_of(k) * setting_.time_step);
        if (!advanced) advance_trajectories(k, t);
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

  std::int64_t steps() const { return steps_; }                                     ///< made so far
  double time() const { return static_cast<double>(steps_) * setting_.time_step; }  ///< [s]
  /// All grains as they are now, by number. Put together when asked for; stays until the next step.
  const Grains<Dim, needs>& grains() const { return store_.by_number(); }
  // What never changes is there without being put together.
  const Eigen::VectorXd& radii() const { return store_.radii(); }    ///< N, by number [m]
  const Eigen::VectorXd& masses() const { return store_.masses(); }  ///< N, by number [kg]
  const std::vector<Wall<Dim>>& walls() const { return walls_; }     ///< as they are now
  const LawTable<Law>& laws() const { return laws_; }                ///< as they were given
  const Setting<Dim>& setting() const { return setting_; }           ///< as it holds now
  const N& neighbourhood() const { return neighbourhood_; }          ///< what proposes the pairs
  /// Energy put in and taken out since the start.
  const EnergyFlow& flow() const { return flow_; }

  /// The listed pairs, sorted: they hold every contact while near_list_holds().
  std::vector<Pair> near_pairs() const {
    std::vector<Pair> pairs;
    pairs.reserve(near_count());
    for_each_table([&](const auto& table) {
      for (const auto [a, b] : table.pairs()) {
        const int i = store_.number(a), j = store_.number(b);
        pairs.push_back({std::min(i, j), std::max(i, j)});
      }
    });
    sort_pairs(pairs, count());
    return pairs;
  }
  std::size_t near_count() const { return near_.pair_count(); }  ///< how many pairs are listed
  std::int64_t refreshes() const { return near_.refreshes(); }   ///< of the near list
  /// Grains that the near list centred anew between refreshes.
  std::int64_t amended() const { return near_.amended(); }
  /// False when a step that ended with a move has made the list expire: the next forces renew it.
  bool near_list_holds() const {
    const Vec<Dim> shift = near_.shift(time());
    const Grains<Dim, needs>& g = grains();
    if (!near_.listed() || !near_.walls_hold(walls_, shift)) return false;
    for (int slot = 0; slot < count(); ++slot) {
      if (!near_.holds(slot, g.position.col(store_.number(slot)), shift)) return false;
    }
    return true;
  }

  /// Threads that share the steps from now on.
  /// @throws ContractError if there are none
  void use_threads(int threads) {
    LAGRAIN_EXPECTS(threads >= 1, "threads " + std::to_string(threads));
    setting_.threads = threads;
  }
  /// Where the time went while it was measured.
  const PhaseTimes& times() const { return times_; }
  /// Whether the time of each phase is measured from now on.
  void measure_phases(bool on) {
    measuring_ = on;
    forces_.measure_time(on);
  }
  /// Wall-clock time spent so far on knowing the near pairs [s].
  double neighbourhood_seconds() const { return times_.refresh; }

  /// Visits every grain-grain contact: f(pair, touch, response, memory), as grain pair.i sees it;
  /// pair.i may be the larger number.
  template <class F>
  void for_each_contact(F&& f) const {
    const Grains<Dim, needs>& g = grains();
    for_each_table([&](const auto& table) {
      for (std::size_t k = 0; k < table.size(); ++k) {
        const Pair pair{store_.number(table.pairs()[k].i), store_.number(table.pairs()[k].j)};
        const auto [touching, touch] = touch_of(body(g, pair.i), body(g, pair.j));
        if (!touching) continue;
        Memory memory = table.memory(k);
        f(pair, touch, laws_.of(g.material, pair.i, pair.j).respond(touch, memory, 0), memory);
      }
    });
  }

  /// Visits every wall contact: f(wall pair, touch, response, memory).
  template <class F>
  void for_each_wall_contact(F&& f) const {
    const Grains<Dim, needs>& g = grains();
    for (const auto& block : near_.blocks()) {
      for (std::size_t k = 0; k < block.walls.size(); ++k) {
        const WallPair pair{store_.number(block.walls.pairs()[k].i), block.walls.pairs()[k].wall};
        const Wall<Dim>& wall = walls_[index(pair.wall)];
        const auto [distance, normal] = wall.foot(g.position.col(pair.i));
        const auto [touching, touch] =
            touch_of_wall(body(g, pair.i), g.mass[pair.i], distance, normal, wall.velocity);
        if (!touching) continue;
        Memory memory = block.walls.memory(k);
        f(pair, touch, laws_.with_wall(g.material, pair.i, wall.material).respond(touch, memory, 0),
          memory);
      }
    }
  }

 private:
  using Record = GrainRecord<Dim, needs>;
  using Load = LoadRecord<Dim, needs>;
  using Moving = MovingGrain<Dim, needs, Motion>;

  /// Blocks of slots are the unit of work of a thread. They are so large that few pairs lie across
  /// them, and so few that what each adds up costs nothing. In blocks of half the size 2^(1/Dim)
  /// times as many pairs lie across; with twice the size small scenes have too few blocks for many
  /// threads. Results depend on the size in the last digits, because blocks fix the order of sums.
  static constexpr int kLeastBlock = Dim == 2 ? 1024 : 2048;
  static constexpr int kMostBlocks = 128;

  /// What grains do once forces are known.
  struct Then {
    bool finish = false;   ///< the step
    bool advance = false;  ///< to where the next forces are wanted
    int evaluation = 0;    ///< which ones they are
    double time = 0;       ///< and when [s]
  };

  template <class I>
  static std::size_t index(I i) {
    return static_cast<std::size_t>(i);
  }

  int count() const { return store_.count(); }

  /// When the forces of an evaluation are wanted [s].
  double instant(std::int64_t step, int evaluation) const {
    return static_cast<double>(step) * setting_.time_step +
           Motion::time_of(evaluation) * setting_.time_step;
  }

  static Body<Dim, needs> body(const Grains<Dim, needs>& g, int i) {
    Body<Dim, needs> b{g.position.col(i), g.velocity.col(i), g.radius[i], g.inverse_mass[i], {}};
    if constexpr (needs.spin) b.omega = g.omega.col(i);
    return b;
  }

  template <class F>
  void for_each_table(F&& f) const {
    for (const auto& block : near_.blocks()) {
      f(block.within);
      f(block.across);
    }
  }

  /// f(block, thread) for every block, shared by the threads.
  template <class F>
  void for_each_block(F&& f) {
    share_among_threads(near_.blocks().size(), setting_.threads, f);
  }

  void sort_grains() {
    if (!store_.order_matters()) return;
    store_.expect_finite(time());
    const std::vector<int> slot_of = store_.sort_if_mixed();
    if (slot_of.empty()) return;
    near_.renumber(slot_of);
    if constexpr (requires { neighbourhood_.forget(); }) neighbourhood_.forget();
  }

  /// Steps 2 to 4 of the paper: forces where the grains are at time t [s]. Each block goes on once
  /// its own are known: nobody else reads its places then.
  void evaluate_forces(double t, const Then& then) {
    const ContactScene<Dim, Law> scene{
        store_.records().data(), nullptr,     &store_.materials(),     &laws_,
        walls_.data(),           force_step_, setting_.largest_overlap};
    const std::size_t blocks = near_.blocks().size();
    forces_.begin(near_, walls_.size(), setting_.threads);
    move_seconds_.assign(blocks, 0);
    if (blocks > 1) {
      for_each_block(
          [&](std::size_t b, std::size_t) { forces_.keep_pairs_across(scene, near_, b); });
    }
    for_each_block([&](std::size_t b, std::size_t thread) {
      const Load* loads =
          forces_.detect_and_apply_law(scene, near_, b, thread, store_, setting_.gravity);
      const Stopwatch watch(measuring_);
      update_trajectories(b, loads, then);
      move_seconds_[b] = watch.seconds();
    });
    const auto [tally, pair_seconds, wall_seconds] = forces_.totals();
    times_.pairs += pair_seconds / setting_.threads;
    times_.walls += wall_seconds / setting_.threads;
    for (const double moving : move_seconds_) times_.integration += moving / setting_.threads;
    flow_.dashpot += tally.dashpot;
    flow_.friction += tally.friction;
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      walls_[w].force = forces_.wall_force(w);
      flow_.wall_work -= walls_[w].force.dot(walls_[w].velocity) * force_step_;
    }
    if (tally.excess > 0) {
      report_deep_overlap(
          forces_.deepest(), [&](int slot) { return store_.number(slot); }, walls_, t,
          setting_.largest_overlap);
    }
  }

  // ---- The paper's step 4 ----------------------------------------------------------------------

  /// The grains of a block go on with the forces that act on them now.
  void update_trajectories(std::size_t block, const Load* now, const Then& then) {
    const auto pass = [&]<bool kFinish, bool kAdvance>() {
      const Vec<Dim> shift = near_.shift(then.time);
      const int first = near_.blocks()[block].first_slot, end = near_.blocks()[block].end_slot;
      if (kAdvance) strays_[block].clear();
      for (int slot = first; slot < end; ++slot) {
        Record& record = store_.record(slot);
        Load& before = store_.load(slot);  // as the step began
        const Load& load = now[slot - first];
        if constexpr (kFinish || kAdvance) {
          Moving grain(record, load);
          if constexpr (kFinish) grain.finish(record, before, setting_.time_step);
          if constexpr (kAdvance) advance(grain, block, slot, then.evaluation, shift);
          grain.store(record);
        }
        before = load;
      }
    };
    if (then.finish && then.advance) {
      pass.template operator()<true, true>();
    } else if (then.finish) {
      pass.template operator()<true, false>();
    } else if (then.advance) {
      pass.template operator()<false, true>();
    } else {
      pass.template operator()<false, false>();
    }
  }

  /// Brings all grains to where the forces of an evaluation are wanted, at time t [s].
  void advance_trajectories(int evaluation, double t) {
    const Stopwatch watch(measuring_);
    const Vec<Dim> shift = near_.shift(t);
    for_each_block([&](std::size_t block, std::size_t) {
      strays_[block].clear();
      const int end = near_.blocks()[block].end_slot;
      for (int slot = near_.blocks()[block].first_slot; slot < end; ++slot) {
        Moving grain(store_.record(slot), store_.load(slot));
        advance(grain, block, slot, evaluation, shift);
        grain.store(store_.record(slot));
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

  // ---- The paper's step 5 ----------------------------------------------------------------------

  /// Brings the near list, and with it T, up to date with the grains and walls at time t [s], if it
  /// no longer holds. Single grains that have left their margins are amended, if that will do.
  void update_triangulation(double t) {
    const bool walls_hold = near_.listed() && near_.walls_hold(walls_, near_.shift(t));
    const bool holds = walls_hold && std::all_of(strays_.begin(), strays_.end(),
                                                 [](const auto& list) { return list.empty(); });
    // Where lists are not amended, one that holds is too dear to give away.
    const bool narrow = AmendableNeighbourhood<N, Dim> && near_.worth_narrowing(steps_);
    if (holds && !narrow) return;
    const Stopwatch watch;
    const auto velocity = [&](int slot) { return store_.record(slot).velocity(); };
    if (narrow || !walls_hold || !amend(t, velocity)) {
      store_.expect_finite(time());
      near_.refresh(store_.places(), store_.radius(), velocity, walls_, neighbourhood_, t,
                    setting_.time_step, steps_);
    }
    times_.refresh += watch.seconds();
  }

  /// @returns false if a refresh is due
  template <class Velocity>
  bool amend(double t, Velocity&& velocity) {
    if constexpr (AmendableNeighbourhood<N, Dim>) {
      all_strays_.clear();
      for (const auto& list : strays_) {
        all_strays_.insert(all_strays_.end(), list.begin(), list.end());
      }
      return near_.amend(
          all_strays_, [&](int slot) { return store_.record(slot).position(); }, velocity,
          store_.radius(), walls_, neighbourhood_, t, setting_.time_step);
    }
    return false;
  }

  GrainStore<Dim, needs> store_;
  LawTable<Law> laws_;
  std::vector<Wall<Dim>> walls_;
  Setting<Dim> setting_;
  N neighbourhood_;
  ContactForces<Dim, Law> forces_;
  NearList<Dim, Memory> near_;
  EnergyFlow flow_;
  double force_step_ = 0;  // what memories and losses advance by in an evaluation [s]
  std::int64_t steps_ = 0;
  PhaseTimes times_;
  bool measuring_ = false;

  std::vector<std::vector<int>> strays_;  // grains of each block that have left their margins
  std::vector<int> all_strays_;
  std::vector<double> move_seconds_;  // of each block, in an evaluation
};

}  // namespace lagrain
