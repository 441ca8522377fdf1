#pragma once
/// @file
/// The step loop of the distinct element method.

#include <lagrain/check.hpp>
#include <lagrain/contact_kernel.hpp>
#include <lagrain/contact_law.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/integrator.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/near_list.hpp>
#include <lagrain/records.hpp>
#include <lagrain/spatial_order.hpp>
#include <lagrain/time_step.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
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
  int threads = 1;                      ///< that share a step; results do not depend on it
  InstructionSet instructions = instruction_sets().back();  ///< nor on this
};

/// Energy that has come and gone since the start [J].
struct EnergyFlow {
  double wall_work = 0;  ///< by moving walls on the grains
  double dashpot = 0;    ///< taken by normal dashpots
  double friction = 0;   ///< taken by friction
};

/// Wall-clock time spent so far [s]. What is done once per step is measured only if asked for.
struct PhaseTimes {
  double refresh = 0;  ///< of the near list, the triangulation's updates included
  // What the threads share is the mean over them.
  double integration = 0;  ///< with the test whether the near list still holds
  double pairs = 0;        ///< contacts between grains
  double walls = 0;        ///< contacts with walls
};

/// A simulation composed at compile time: dimension, contact law (with or without friction),
/// integrator, neighbourhood. The law decides what the grains and the contacts carry.
///
/// The paper's scheme: detect contacts along the near edges of the triangulation (step 2), apply
/// the law (3), integrate (4), update the triangulation when the near list has expired (5).
///
/// Inside, grains lie in *slots* along Hilbert's curve, and are put in order again when they have
/// mixed; outside, everything speaks of the grains' numbers, which never change. Forces are summed
/// in an order fixed by the slots, so every neighbourhood, instruction set and number of threads
/// gives the same trajectory, bit for bit. One object is for one caller at a time.
template <int Dim, ContactLaw<Dim> Law, Integrator Motion, Neighbourhood<Dim> N>
class Simulation {
 public:
  static constexpr Needs needs = Law::needs;
  using State = Grains<Dim, needs>;
  using Memory = typename Law::template Memory<Dim>;

  /// Evaluates the forces at time 0.
  /// @throws ContractError if the time step is not safe (the message names the safe one), or a material
  /// is not in the table of laws.
  Simulation(State grains, LawTable<Law> laws, std::vector<Wall<Dim>> walls, Setting<Dim> setting,
             N neighbourhood = {})
      : view_(std::move(grains)),
        view_known_(true),
        laws_(std::move(laws)),
        walls_(std::move(walls)),
        setting_(std::move(setting)),
        neighbourhood_(std::move(neighbourhood)),
        kernel_(setting_.instructions, laws_.one_law() || view_.material.empty()) {
    check_materials();
    const TimeScales scales = time_scales(view_, laws_, walls_);
    std::ostringstream message;
    message << "time step " << setting_.time_step << " s: the stiffest contact lasts "
            << scales.contact << " s and allows at most " << scales.safe_step << " s";
    LAGRAIN_EXPECTS(setting_.time_step > 0 && setting_.time_step <= scales.safe_step,
                    message.str());
    use_threads(setting_.threads);
    if (Motion::kConservativeOnly) check_conservative();
    for (Wall<Dim>& wall : walls_) wall.advance(0, 0);
    store();
    evaluate_forces(0, {});  // with force_step_ = 0: memories and energies do not advance
    force_step_ = Motion::kConservativeOnly ? 0 : setting_.time_step;
    flow_ = {};
    view_known_ = false;
  }

  /// So many time steps; the same, bit for bit, whether they are asked for together or one by one.
  /// Together they take less time where memory decides: nobody looks in between, so the grains of
  /// a block move on as soon as their forces are known, while they are in the cache.
  /// @throws SimulationError if a grain is lost to NaN or two overlap beyond the limit; the grains
  ///         may be a step further by then.
  void step(std::int64_t count = 1) {
    view_known_ = false;
    bool moved = false;  // to where the next forces are wanted
    for (; count > 0; --count) {
      if (sort_is_due(steps_)) sort_if_mixed();
      for (int k = 0; k < Motion::kEvaluations; ++k) {
        const double t = instant(steps_, k);
        for (Wall<Dim>& wall : walls_) wall.advance(t, Motion::time_of(k) * setting_.time_step);
        if (!moved) move_all(k, t);
        look_for_strays(t);
        const bool ends = k + 1 == Motion::kEvaluations;
        moved = !ends || (count > 1 && !sort_is_due(steps_ + 1));
        evaluate_forces(t, {.finish = ends,
                            .advance = moved,
                            .evaluation = ends ? 0 : k + 1,
                            .time = ends ? instant(steps_ + 1, 0) : instant(steps_, k + 1)});
      }
      ++steps_;
    }
  }

  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * setting_.time_step; }  ///< [s]
  /// As they are now, by number. Put together when asked for; stays until the next step.
  const State& grains() const {
    if (!view_known_) look();
    return view_;
  }
  /// What never changes is there without being put together.
  const Eigen::VectorXd& radii() const { return view_.radius; }  ///< N, by number [m]
  const Eigen::VectorXd& masses() const { return view_.mass; }   ///< N, by number [kg]
  const std::vector<Wall<Dim>>& walls() const { return walls_; }
  const LawTable<Law>& laws() const { return laws_; }
  const Setting<Dim>& setting() const { return setting_; }
  const N& neighbourhood() const { return neighbourhood_; }
  const EnergyFlow& flow() const { return flow_; }

  /// The listed pairs, sorted: they hold every contact while near_list_holds().
  std::vector<Pair> near_pairs() const {
    std::vector<Pair> pairs;
    pairs.reserve(near_count());
    for_each_table([&](const auto& table) {
      for (const auto [a, b] : table.pairs()) {
        const int i = number(a), j = number(b);
        pairs.push_back({std::min(i, j), std::max(i, j)});
      }
    });
    sort_pairs(pairs, count());
    return pairs;
  }
  std::size_t near_count() const { return near_.pair_count(); }
  std::int64_t refreshes() const { return near_.refreshes(); }  ///< of the near list
  /// Grains that the near list centred anew between refreshes.
  std::int64_t amended() const { return near_.amended(); }
  /// False when a step that ended with a move has made the list expire: the next forces renew it.
  bool near_list_holds() const {
    const Vec<Dim> shift = near_.shift(time());
    const State& g = grains();
    if (!near_.listed() || !near_.walls_hold(walls_, shift)) return false;
    for (int slot = 0; slot < count(); ++slot) {
      if (!near_.holds(slot, g.position.col(number(slot)), shift)) return false;
    }
    return true;
  }

  /// Threads that share the steps from now on.
  /// @throws ContractError if there are none
  void use_threads(int threads) {
    LAGRAIN_EXPECTS(threads >= 1, "threads " + std::to_string(threads));
    setting_.threads = threads;
  }
  const PhaseTimes& times() const { return times_; }
  void measure_phases(bool on) { measuring_ = on; }
  /// Wall-clock time spent so far on knowing the near pairs [s].
  double neighbourhood_seconds() const { return times_.refresh; }

  /// Visits every grain-grain contact: f(pair, touch, response, memory), as grain pair.i sees it;
  /// pair.i may be the larger number.
  template <class F>
  void for_each_contact(F&& f) const {
    const State& g = grains();
    for_each_table([&](const auto& table) {
      for (std::size_t k = 0; k < table.size(); ++k) {
        const Pair pair{number(table.pairs()[k].i), number(table.pairs()[k].j)};
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
    const State& g = grains();
    for (const auto& block : near_.blocks()) {
      for (std::size_t k = 0; k < block.walls.size(); ++k) {
        const WallPair pair{number(block.walls.pairs()[k].i), block.walls.pairs()[k].wall};
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
  using Clock = std::chrono::steady_clock;
  using Record = GrainRecord<Dim, needs>;
  using Load = LoadRecord<Dim, needs>;

  template <class F>
  void for_each_table(F&& f) const {
    for (const auto& block : near_.blocks()) {
      f(block.within);
      f(block.across);
    }
  }

  /// Below this number all grains fit into the cache in any order.
  static constexpr int kSortFrom = 1024;
  static constexpr std::int64_t kStepsBetweenSorts = 10000;
  /// Slots are put in order again when the way through all grains is longer by this factor.
  static constexpr double kMixed = 1.3;

  template <class I>
  static std::size_t index(I i) {
    return static_cast<std::size_t>(i);
  }
  static double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

  int count() const { return static_cast<int>(records_.size()); }
  /// The number of the grain in a slot.
  int number(int slot) const { return numbers_.empty() ? slot : numbers_[index(slot)]; }

  static Body<Dim, needs> body(const State& g, int i) {
    Body<Dim, needs> b{g.position.col(i), g.velocity.col(i), g.radius[i], g.inverse_mass[i], {}};
    if constexpr (needs.spin) b.omega = g.omega.col(i);
    return b;
  }

  // ---- Between numbers and slots ---------------------------------------------------------------

  /// Puts the grains of view_ into slots.
  void store() {
    const State& g = view_;
    if (g.size() > kSortFrom && g.position.allFinite()) numbers_ = spatial_order<Dim>(g.position);
    records_.resize(index(g.size()));
    loads_.resize(index(g.size()));
    radius_.resize(g.size());
    if (!laws_.one_law() && !g.material.empty()) materials_.resize(index(g.size()));
    for (int slot = 0; slot < g.size(); ++slot) {
      const int i = number(slot);
      Record& record = records_[index(slot)];
      record.position() = g.position.col(i);
      record.velocity() = g.velocity.col(i);
      record.at[Record::kRadius] = radius_[slot] = g.radius[i];
      record.at[Record::kInverseMass] = g.inverse_mass[i];
      loads_[index(slot)].at[Load::kMass] = g.mass[i];
      if constexpr (needs.spin) {
        record.omega() = g.omega.col(i);
        record.at[Record::kInverseInertia] = g.inverse_inertia[i];
      }
      if (!materials_.empty()) materials_[index(slot)] = g.material[index(i)];
    }
    near_.reset(g.size(), std::max(kLeastBlock, (g.size() + kMostBlocks - 1) / kMostBlocks));
    strays_.resize(near_.blocks().size());
  }

  /// Puts the grains together by number.
  void look() const {
    State& g = view_;
    for (int slot = 0; slot < count(); ++slot) {
      const int i = number(slot);
      const Record& record = records_[index(slot)];
      const Load& load = loads_[index(slot)];
      g.position.col(i) = record.position();
      g.velocity.col(i) = record.velocity();
      g.force.col(i) = load.force();
      if constexpr (needs.spin) {
        g.omega.col(i) = record.omega();
        g.torque.col(i) = load.torque();
      }
    }
    view_known_ = true;
  }

  static bool sort_is_due(std::int64_t step) {
    return step % kStepsBetweenSorts == kStepsBetweenSorts - 1;
  }

  /// Gives the grains new slots if neighbours in space lie far apart in memory. Judged by places
  /// alone at fixed steps, so that all neighbourhoods do the same.
  void sort_if_mixed() {
    if (count() <= kSortFrom) return;
    check_finite();
    const Columns<Dim> x = places();
    const auto way = [&](auto&& slot_at) {
      double length = 0;
      for (int k = 1; k < count(); ++k) {
        length += (x.col(slot_at(k)) - x.col(slot_at(k - 1))).norm();
      }
      return length;
    };
    const std::vector<int> order = spatial_order<Dim>(x);
    if (way([](int k) { return k; }) <= kMixed * way([&](int k) { return order[index(k)]; }))
      return;
    const auto permute = [&](auto& list) {
      if (list.empty()) return;
      auto sorted = list;
      for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = list[index(order[k])];
      list.swap(sorted);
    };
    permute(records_);
    permute(loads_);
    permute(numbers_);
    permute(materials_);
    std::vector<int> slot_of(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      slot_of[index(order[k])] = static_cast<int>(k);
      radius_[static_cast<Eigen::Index>(k)] = records_[k].radius();
    }
    near_.renumber(slot_of);
    if constexpr (requires { neighbourhood_.forget(); }) neighbourhood_.forget();
  }

  Columns<Dim> places() const {
    Columns<Dim> x(Dim, count());
    for (int slot = 0; slot < count(); ++slot) x.col(slot) = records_[index(slot)].position();
    return x;
  }

  /// f(block, thread) for every block, shared by the threads. One thread alone does without OpenMP,
  /// whose team of one takes a microsecond to call together.
  template <class F>
  void for_each_block(F&& f) {
    const std::size_t blocks = near_.blocks().size(), threads = index(setting_.threads);
    const auto share = [&](std::size_t thread) {
      const std::size_t end = blocks * (thread + 1) / threads;
      for (std::size_t block = blocks * thread / threads; block < end; ++block) f(block, thread);
    };
    if (threads == 1) {
      share(0);
      return;
    }
#pragma omp parallel for schedule(static, 1) num_threads(setting_.threads)
    for (std::size_t thread = 0; thread < threads; ++thread) share(thread);
  }

  // ---- Motion ----------------------------------------------------------------------------------

  /// A grain on its way through a step.
  struct Moving {
    Vec<Dim> x, v, a;
    SpinVec<Dim> angle, omega, alpha;  // nobody asks for the angle

    Moving(const Record& record, const Load& load)
        : x(record.position()), v(record.velocity()), a(linear(record, load)) {
      if constexpr (needs.spin) {
        omega = record.omega();
        alpha = angular(record, load);
        angle = omega;
      }
    }
    void finish(const Record& record, const Load& before, double dt) {
      Motion::finish(x, v, a, linear(record, before), dt);
      if constexpr (needs.spin) Motion::finish(angle, omega, alpha, angular(record, before), dt);
    }
    void advance(int evaluation, double dt) {
      Motion::advance(evaluation, x, v, a, dt);
      if constexpr (needs.spin) Motion::advance(evaluation, angle, omega, alpha, dt);
    }
    void store(Record& record) const {
      record.position() = x;
      record.velocity() = v;
      if constexpr (needs.spin) record.omega() = omega;
    }

   private:
    static Vec<Dim> linear(const Record& record, const Load& load) {
      return record.at[Record::kInverseMass] * load.force();
    }
    static SpinVec<Dim> angular(const Record& record, const Load& load) {
      return record.at[Record::kInverseInertia] * load.torque();
    }
  };

  /// When the forces of an evaluation are wanted [s].
  double instant(std::int64_t step, int evaluation) const {
    return static_cast<double>(step) * setting_.time_step +
           Motion::time_of(evaluation) * setting_.time_step;
  }

  /// What grains do once forces are known.
  struct Then {
    bool finish = false;   ///< the step
    bool advance = false;  ///< to where the next forces are wanted
    int evaluation = 0;    ///< which ones they are
    double time = 0;       ///< and when [s]
  };

  /// Brings all grains to where the forces of an evaluation are wanted, at time t [s].
  void move_all(int evaluation, double t) {
    const auto start = measuring_ ? Clock::now() : Clock::time_point{};
    const Vec<Dim> shift = near_.shift(t);
    for_each_block([&](std::size_t block, std::size_t) {
      strays_[block].clear();
      const int end = near_.blocks()[block].end_slot;
      for (int slot = near_.blocks()[block].first_slot; slot < end; ++slot) {
        Moving grain(records_[index(slot)], loads_[index(slot)]);
        advance(grain, block, slot, evaluation, shift);
        grain.store(records_[index(slot)]);
      }
    });
    if (measuring_) times_.integration += seconds(Clock::now() - start);
  }

  /// Also notes if the grain leaves its margin.
  void advance(Moving& grain, std::size_t block, int slot, int evaluation, const Vec<Dim>& shift) {
    grain.advance(evaluation, setting_.time_step);
    if (near_.listed() && !near_.holds(slot, grain.x, shift)) strays_[block].push_back(slot);
  }

  /// The grains of a block go on with the forces that act on them now.
  void move_on(std::size_t block, const Load* now, const Then& then) {
    const auto pass = [&]<bool kFinish, bool kAdvance>() {
      const Vec<Dim> shift = near_.shift(then.time);
      const int first = near_.blocks()[block].first_slot, end = near_.blocks()[block].end_slot;
      if (kAdvance) strays_[block].clear();
      for (int slot = first; slot < end; ++slot) {
        Record& record = records_[index(slot)];
        Load& load = loads_[index(slot)];  // as the step began
        const Load& fresh = now[slot - first];
        if constexpr (kFinish || kAdvance) {
          Moving grain(record, fresh);
          if constexpr (kFinish) grain.finish(record, load, setting_.time_step);
          if constexpr (kAdvance) advance(grain, block, slot, then.evaluation, shift);
          grain.store(record);
        }
        load = fresh;
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

  /// Whether the near list holds where the grains and walls are at time t [s].
  void look_for_strays(double t) {
    near_holds_ =
        near_.listed() && near_.walls_hold(walls_, near_.shift(t)) &&
        std::all_of(strays_.begin(), strays_.end(), [](const auto& list) { return list.empty(); });
  }

  // ---- Forces ----------------------------------------------------------------------------------

  /// Forces where the grains are at time t [s]. Each block goes on once its own are known: nobody
  /// else reads its places then.
  void evaluate_forces(double t, const Then& then) {
    if (!near_holds_ || worth_narrowing()) refresh(t);
    const ContactScene<Dim, Law> scene{
        records_.data(),         nullptr, &materials_, &laws_, walls_.data(), force_step_,
        setting_.largest_overlap};
    const std::size_t blocks = near_.blocks().size();
    parts_.resize(blocks);
    for (Part& part : parts_) {
      part.deepest = {};
      part.pair_seconds = part.wall_seconds = part.move_seconds = 0;
    }
    kept_.resize(near_.across_count());
    wall_parts_.assign(blocks * walls_.size(), Vec<Dim>::Zero());
    if (blocks > 1) {
      for_each_block([&](std::size_t b, std::size_t) {
        auto& block = near_.blocks()[b];
        Part& part = parts_[b];
        const auto start = measuring_ ? Clock::now() : Clock::time_point{};
        part.across = kernel_.pairs(scene, block.across, 0, block.across.size(),
                                    listing_for(block.across.size(), part.across.contacts),
                                    kept_.data() + block.first_across);
        if (part.across.excess > 0) note_deepest(part.deepest, block.across);
        if (measuring_) part.pair_seconds += seconds(Clock::now() - start);
      });
    }
    new_loads_.resize(index(setting_.threads));
    for_each_block([&](std::size_t block, std::size_t thread) {
      block_forces(scene, block, new_loads_[thread]);
      const auto start = measuring_ ? Clock::now() : Clock::time_point{};
      move_on(block, new_loads_[thread].data(), then);
      if (measuring_) parts_[block].move_seconds = seconds(Clock::now() - start);
    });

    Tally total;
    for (const Part& part : parts_) total += part.across;
    for (const Part& part : parts_) {
      total += part.within;
      total += part.walls;
      times_.pairs += part.pair_seconds / setting_.threads;
      times_.walls += part.wall_seconds / setting_.threads;
      times_.integration += part.move_seconds / setting_.threads;
    }
    flow_.dashpot += total.dashpot;
    flow_.friction += total.friction;
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      walls_[w].force.setZero();
      for (std::size_t block = 0; block < blocks; ++block) {
        walls_[w].force += wall_parts_[block * walls_.size() + w];
      }
      flow_.wall_work -= walls_[w].force.dot(walls_[w].velocity) * force_step_;
    }
    if (total.excess > 0) report_deep_overlap(t);
  }

  /// Sets a load to the grain's weight.
  void weigh(Load& load, double mass) const {
    load.at[Load::kMass] = mass;
    load.force() = mass * setting_.gravity;
    if constexpr (needs.spin) load.torque().setZero();
  }

  /// All that adds up to the loads of a block's grains, in a fixed order.
  void block_forces(ContactScene<Dim, Law> scene, std::size_t b, std::vector<Load>& fresh) {
    auto& block = near_.blocks()[b];
    Part& part = parts_[b];
    const auto start = measuring_ ? Clock::now() : Clock::time_point{};
    fresh.resize(index(block.end_slot - block.first_slot));
    scene.loads = fresh.data();
    scene.first_slot = block.first_slot;
    for (int slot = block.first_slot; slot < block.end_slot; ++slot) {
      weigh(scene.load(slot), loads_[index(slot)].at[Load::kMass]);
      fetch_ahead(records_[index(slot)]);
    }
    part.within = kernel_.pairs(scene, block.within, 0, block.within.size(),
                                listing_for(block.within.size(), part.within.contacts));
    for (const auto& end : block.ends) {
      const PairLoad<Dim, needs>& both = kept_[end.pair];
      Load& load = scene.load(end.slot);
      if (end.second()) {
        both.give_to_j(load);
      } else {
        both.give_to_i(load);
      }
    }
    const auto between = measuring_ ? Clock::now() : Clock::time_point{};
    part.walls = kernel_.walls(scene, block.walls, 0, block.walls.size(),
                               wall_parts_.data() + b * walls_.size());
    if (part.within.excess > 0) note_deepest(part.deepest, block.within);
    if (part.walls.excess > 0) note_deepest(part.deepest, block.walls);
    if (!measuring_) return;
    part.pair_seconds += seconds(between - start);
    part.wall_seconds += seconds(Clock::now() - between);
  }

  void refresh(double t) {
    const auto start = Clock::now();
    const auto velocity = [&](int slot) { return records_[index(slot)].velocity(); };
    if (worth_narrowing() || !amend(t, velocity)) {
      check_finite();
      near_.refresh(places(), radius_, velocity, walls_, neighbourhood_, t, setting_.time_step,
                    steps_);
    }
    near_holds_ = true;
    times_.refresh += seconds(Clock::now() - start);
  }

  /// Where lists are not amended, one that holds is too dear to give away.
  bool worth_narrowing() const {
    return AmendableNeighbourhood<N, Dim> && near_.worth_narrowing(steps_);
  }

  /// Brings the near list up to date without a refresh, if that will do.
  template <class Velocity>
  bool amend(double t, Velocity&& velocity) {
    if constexpr (AmendableNeighbourhood<N, Dim>) {
      if (!near_.listed() || !near_.walls_hold(walls_, near_.shift(t))) return false;
      all_strays_.clear();
      for (const auto& list : strays_) {
        all_strays_.insert(all_strays_.end(), list.begin(), list.end());
      }
      return near_.amend(
          all_strays_, [&](int slot) { return records_[index(slot)].position(); }, velocity,
          radius_, walls_, neighbourhood_, t, setting_.time_step);
    }
    return false;
  }

  /// An overlap that stops the run.
  struct DeepOverlap {
    double ratio = 0;  ///< of the smaller radius
    int slot = -1;
    int partner = -1;  ///< slot of the other grain, or wall
    bool with_wall = false;
  };

  double overlap_ratio(const Pair& pair) const {
    const Record &a = records_[index(pair.i)], &b = records_[index(pair.j)];
    return (a.radius() + b.radius() - (a.position() - b.position()).norm()) /
           std::min(a.radius(), b.radius());
  }
  double overlap_ratio(const WallPair& pair) const {
    const Record& grain = records_[index(pair.i)];
    return 1 - walls_[index(pair.wall)].foot(grain.position()).distance / grain.radius();
  }
  template <class P>
  void note_deepest(DeepOverlap& deepest, const PairTable<P, Memory>& table) const {
    for (const P& pair : table.pairs()) {
      const double ratio = overlap_ratio(pair);
      if (ratio <= deepest.ratio) continue;
      if constexpr (std::is_same_v<P, WallPair>) {
        deepest = {ratio, pair.i, pair.wall, true};
      } else {
        deepest = {ratio, pair.i, pair.j, false};
      }
    }
  }

  [[noreturn]] void report_deep_overlap(double t) const {
    DeepOverlap deepest;
    for (const Part& part : parts_) {
      if (part.deepest.ratio > deepest.ratio) deepest = part.deepest;
    }
    const auto [ratio, slot, partner, with_wall] = deepest;
    int grain = number(slot);
    std::string other;
    if (with_wall) {
      other = "wall " + walls_[index(partner)].name;
    } else {
      const int second = number(partner);
      other = "grain " + std::to_string(std::max(grain, second));
      grain = std::min(grain, second);
    }
    std::ostringstream message;
    message << "t = " << t << " s: grain " << grain << " overlaps " << other << " by " << ratio
            << " of the smaller radius (limit " << setting_.largest_overlap
            << "); a stiffer contact, a smaller time step or a gentler start would help";
    throw SimulationError(message.str());
  }

  void check_finite() const {
    for (int slot = 0; slot < count(); ++slot) {
      const Record& record = records_[index(slot)];
      if (record.position().allFinite() && record.velocity().allFinite()) continue;
      std::ostringstream message;
      message << "t = " << time() << " s: grain " << number(slot)
              << " has a place or velocity that is not a number; a smaller time step would help";
      throw SimulationError(message.str());
    }
  }

  void check_materials() const {
    const int materials = laws_.materials();
    const std::string have =
        ", but the table of laws has " + std::to_string(materials) + " materials";
    LAGRAIN_EXPECTS(materials >= 1, "the table of laws is empty");
    if (laws_.one_law()) return;
    for (std::size_t i = 0; i < view_.material.size(); ++i) {
      LAGRAIN_EXPECTS(view_.material[i] < materials, "grain " + std::to_string(i) +
                                                         " is of material " +
                                                         std::to_string(view_.material[i]) + have);
    }
    for (const Wall<Dim>& wall : walls_) {
      LAGRAIN_EXPECTS(
          wall.material >= 0 && wall.material < materials,
          "wall " + wall.name + " is of material " + std::to_string(wall.material) + have);
    }
  }

  void check_conservative() const {
    const auto materials = static_cast<std::size_t>(laws_.materials());
    for (std::size_t k = 0; k < materials * materials; ++k) {
      LAGRAIN_EXPECTS(
          laws_.between(k / materials, k % materials).conservative(),
          std::string(Motion::kName) + " integrates conservative scenes: restitution 1");
    }
    for (const Wall<Dim>& wall : walls_) {
      LAGRAIN_EXPECTS(!wall.moves(), std::string(Motion::kName) +
                                         " integrates conservative scenes: wall " + wall.name +
                                         " moves");
    }
  }

  /// Blocks of slots, the unit of work of a thread: large enough that few pairs lie across them.
  static constexpr int kLeastBlock = Dim == 2 ? 1024 : 2048;
  static constexpr int kMostBlocks = 128;

  /// What a block's sweeps added up. How many contacts there were is a guess for the next step.
  struct Part {
    Tally across, within, walls;
    DeepOverlap deepest;
    double pair_seconds = 0, wall_seconds = 0, move_seconds = 0;
  };

  mutable State view_;
  mutable bool view_known_ = false;
  std::vector<int> numbers_;  // of the grains in the slots; empty if they are the slots
  std::vector<Record> records_;
  std::vector<Load> loads_;                   // by the forces that were evaluated last
  std::vector<std::vector<Load>> new_loads_;  // of a block that a thread is at
  std::vector<std::uint8_t> materials_;
  Eigen::VectorXd radius_;

  LawTable<Law> laws_;
  std::vector<Wall<Dim>> walls_;
  Setting<Dim> setting_;
  N neighbourhood_;
  ContactKernel<Dim, Law> kernel_;
  NearList<Dim, Memory> near_;
  bool near_holds_ = false;
  EnergyFlow flow_;
  double force_step_ = 0;  // what memories and losses advance by in an evaluation [s]
  std::int64_t steps_ = 0;
  PhaseTimes times_;
  bool measuring_ = false;

  std::vector<std::vector<int>> strays_;  // grains of each block that have left their margins
  std::vector<int> all_strays_;
  std::vector<Part> parts_;
  std::vector<PairLoad<Dim, needs>> kept_;
  std::vector<Vec<Dim>> wall_parts_;  // forces on the walls, by block
};

}  // namespace lagrain
