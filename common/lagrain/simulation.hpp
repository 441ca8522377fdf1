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
  double refresh = 0;      ///< of the near list, the triangulation's updates included
  double integration = 0;  ///< with the test whether the near list still holds
  double pairs = 0;        ///< contacts between grains; the mean over the threads
  double walls = 0;        ///< contacts with walls; the mean over the threads
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
  /// @throws ContractError if the time step is not safe (the message names the safe one), or a kind
  /// is not in the table of laws.
  Simulation(State grains, LawTable<Law> laws, std::vector<Wall<Dim>> walls, Setting<Dim> setting,
             N neighbourhood = {})
      : view_(std::move(grains)),
        view_known_(true),
        laws_(std::move(laws)),
        walls_(std::move(walls)),
        setting_(std::move(setting)),
        neighbourhood_(std::move(neighbourhood)),
        kernel_(setting_.instructions, view_.kind.empty()) {
    check_kinds();
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
    evaluate_forces(0);  // with force_step_ = 0: memories and energies do not advance
    force_step_ = Motion::kConservativeOnly ? 0 : setting_.time_step;
    flow_ = {};
    view_known_ = false;
  }

  /// One time step.
  /// @throws SimulationError if a grain is lost to NaN or two overlap beyond the limit.
  void step() {
    view_known_ = false;
    if (steps_ % kStepsBetweenSorts == kStepsBetweenSorts - 1) sort_if_mixed();
    const double start = time();
    for (int k = 0; k < Motion::kEvaluations; ++k) {
      const double t = Motion::time_of(k) * setting_.time_step;
      for (Wall<Dim>& wall : walls_) wall.advance(start + t, t);
      advance(k, start + t);
      evaluate_forces(start + t);
    }
    unfinished_ = true;
    ++steps_;
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
    if (!near_.fresh() || !near_.walls_hold(walls_, shift)) return false;
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
        f(pair, touch, laws_.of(g.kind, pair.i, pair.j).respond(touch, memory, 0), memory);
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
        f(pair, touch, laws_.with_wall(g.kind, pair.i, wall.kind).respond(touch, memory, 0),
          memory);
      }
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Record = GrainRecord<Dim, needs>;
  using Load = LoadRecord<Dim, needs>;
  static constexpr bool kRemembers = Motion::kRemembersAcceleration;

  template <class F>
  void for_each_table(F&& f) const {
    for (const auto& block : near_.blocks()) {
      f(block.within);
      f(block.across);
    }
  }

  /// What the integrator remembers of a grain.
  struct Accelerations {
    Vec<Dim> linear = Vec<Dim>::Zero();
    [[no_unique_address]] std::conditional_t<needs.spin, SpinVec<Dim>, NoSpin> angular{};
  };

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
    if constexpr (kRemembers) old_.resize(index(g.size()));
    radius_.resize(g.size());
    if (!g.kind.empty()) kinds_.resize(index(g.size()));
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
      if (!g.kind.empty()) kinds_[index(slot)] = g.kind[index(i)];
    }
    near_.reset(g.size(), std::max(kLeastBlock, (g.size() + kMostBlocks - 1) / kMostBlocks));
  }

  /// Puts the grains together by number, the step finished.
  void look() const {
    State& g = view_;
    for (int slot = 0; slot < count(); ++slot) {
      const int i = number(slot);
      const Load& load = loads_[index(slot)];
      Moving now(*this, slot);
      if (unfinished_) now.finish(setting_.time_step);
      g.position.col(i) = now.x;
      g.velocity.col(i) = now.v;
      g.force.col(i) = load.force();
      if constexpr (needs.spin) {
        g.omega.col(i) = now.omega;
        g.torque.col(i) = load.torque();
      }
    }
    view_known_ = true;
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
    permute(kinds_);
    if constexpr (kRemembers) permute(old_);
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

  /// f(block) for every block, shared by the threads. One thread alone does without OpenMP, whose
  /// team of one takes a microsecond to call together.
  template <class F>
  void for_each_block(F&& f) {
    const std::size_t blocks = near_.blocks().size();
    if (setting_.threads == 1) {
      for (std::size_t block = 0; block < blocks; ++block) f(block);
      return;
    }
#pragma omp parallel for schedule(static) num_threads(setting_.threads)
    for (std::size_t block = 0; block < blocks; ++block) f(block);
  }

  // ---- Motion ----------------------------------------------------------------------------------

  /// A grain on its way through a step.
  struct Moving {
    Vec<Dim> x, v, a, old;
    SpinVec<Dim> angle, omega, alpha, old_alpha;  // nobody asks for the angle

    Moving(const Simulation& s, int slot) {
      const Record& record = s.records_[index(slot)];
      const Load& load = s.loads_[index(slot)];
      x = record.position();
      v = record.velocity();
      a = record.at[Record::kInverseMass] * load.force();
      if constexpr (kRemembers) old = s.old_[index(slot)].linear;
      if constexpr (needs.spin) {
        omega = record.omega();
        alpha = record.at[Record::kInverseInertia] * load.torque();
        angle = omega;
        if constexpr (kRemembers) old_alpha = s.old_[index(slot)].angular;
      }
    }
    void finish(double dt) {
      Motion::finish(x, v, a, old, dt);
      if constexpr (needs.spin) Motion::finish(angle, omega, alpha, old_alpha, dt);
    }
    void advance(int evaluation, double dt) {
      Motion::advance(evaluation, x, v, a, old, dt);
      if constexpr (needs.spin) Motion::advance(evaluation, angle, omega, alpha, old_alpha, dt);
    }
    void store(Simulation& s, int slot) const {
      Record& record = s.records_[index(slot)];
      record.position() = x;
      record.velocity() = v;
      if constexpr (kRemembers) s.old_[index(slot)].linear = old;
      if constexpr (needs.spin) {
        record.omega() = omega;
        if constexpr (kRemembers) s.old_[index(slot)].angular = old_alpha;
      }
    }
  };

  /// Sets a load to the grain's weight.
  void weigh(Load& load) const {
    load.force() = load.at[Load::kMass] * setting_.gravity;
    if constexpr (needs.spin) load.torque().setZero();
  }

  /// Finishes the last step if that is left to do, moves all grains to where the forces are wanted
  /// next, and sees whether the near list holds there.
  /// @param t  [s]
  void advance(int evaluation, double t) {
    const auto start = measuring_ ? Clock::now() : Clock::time_point{};
    const Vec<Dim> shift = near_.shift(t);
    const bool listed = near_.fresh() && near_.walls_hold(walls_, shift);
    strays_.resize(near_.blocks().size());
    const auto pass = [&]<bool kFinish>() {
      for_each_block([&](std::size_t block) {
        const int end = near_.blocks()[block].end_slot;
        strays_[block].clear();
        for (int slot = near_.blocks()[block].first_slot; slot < end; ++slot) {
          Moving grain(*this, slot);
          if constexpr (kFinish) grain.finish(setting_.time_step);
          grain.advance(evaluation, setting_.time_step);
          grain.store(*this, slot);
          if (listed && !near_.holds(slot, grain.x, shift)) strays_[block].push_back(slot);
        }
      });
    };
    if (unfinished_) {
      pass.template operator()<true>();
    } else {
      pass.template operator()<false>();
    }
    unfinished_ = false;
    near_holds_ = listed && std::all_of(strays_.begin(), strays_.end(),
                                        [](const auto& list) { return list.empty(); });
    if (measuring_) times_.integration += seconds(Clock::now() - start);
  }

  // ---- Forces ----------------------------------------------------------------------------------

  void evaluate_forces(double t) {
    if (!near_holds_ || worth_narrowing()) refresh(t);
    const ContactScene<Dim, Law> scene{
        records_.data(), loads_.data(),           &kinds_, &laws_, walls_.data(),
        force_step_,     setting_.largest_overlap};
    const std::size_t blocks = near_.blocks().size();
    parts_.resize(blocks);
    for (Part& part : parts_) part.pair_seconds = part.wall_seconds = 0;
    kept_.resize(near_.across_count());
    wall_parts_.assign(blocks * walls_.size(), Vec<Dim>::Zero());
    if (blocks > 1) {
      for_each_block([&](std::size_t b) {
        auto& block = near_.blocks()[b];
        Part& part = parts_[b];
        const auto start = measuring_ ? Clock::now() : Clock::time_point{};
        part.across = kernel_.pairs(scene, block.across, 0, block.across.size(),
                                    listing_for(block.across.size(), part.across.contacts),
                                    kept_.data() + block.first_across);
        if (measuring_) part.pair_seconds += seconds(Clock::now() - start);
      });
    }
    for_each_block([&](std::size_t block) { block_forces(scene, block); });

    Tally total;
    for (const Part& part : parts_) total += part.across;
    for (const Part& part : parts_) {
      total += part.within;
      total += part.walls;
      times_.pairs += part.pair_seconds / setting_.threads;
      times_.walls += part.wall_seconds / setting_.threads;
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

  /// All that adds to the loads of a block's grains, in a fixed order.
  void block_forces(const ContactScene<Dim, Law>& scene, std::size_t b) {
    auto& block = near_.blocks()[b];
    Part& part = parts_[b];
    const auto start = measuring_ ? Clock::now() : Clock::time_point{};
    for (int slot = block.first_slot; slot < block.end_slot; ++slot) {
      weigh(loads_[index(slot)]);
      fetch_ahead(records_[index(slot)]);
    }
    part.within = kernel_.pairs(scene, block.within, 0, block.within.size(),
                                listing_for(block.within.size(), part.within.contacts));
    for (const auto& end : block.ends) {
      const PairLoad<Dim, needs>& both = kept_[end.pair];
      Load& load = loads_[index(end.slot)];
      if (end.second()) {
        both.give_to_j(load);
      } else {
        both.give_to_i(load);
      }
    }
    const auto between = measuring_ ? Clock::now() : Clock::time_point{};
    part.walls = kernel_.walls(scene, block.walls, 0, block.walls.size(),
                               wall_parts_.data() + b * walls_.size());
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
      if (!near_.fresh() || !near_.walls_hold(walls_, near_.shift(t))) return false;
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

  [[noreturn]] void report_deep_overlap(double t) {
    unfinished_ = false;
    double deepest = 0;
    std::ostringstream what;
    const auto note = [&](double ratio, int i, const std::string& partner) {
      if (ratio <= deepest) return;
      deepest = ratio;
      what.str({});
      what << "t = " << t << " s: grain " << i << " overlaps " << partner << " by " << ratio
           << " of the smaller radius";
    };
    for_each_contact([&](Pair pair, const Touch<Dim>& touch, auto&&...) {
      note(touch.overlap / std::min(view_.radius[pair.i], view_.radius[pair.j]),
           std::min(pair.i, pair.j), "grain " + std::to_string(std::max(pair.i, pair.j)));
    });
    for_each_wall_contact([&](WallPair pair, const Touch<Dim>& touch, auto&&...) {
      note(touch.overlap / view_.radius[pair.i], pair.i, "wall " + walls_[index(pair.wall)].name);
    });
    what << " (limit " << setting_.largest_overlap
         << "); a stiffer contact, a smaller time step or a gentler start would help";
    throw SimulationError(what.str());
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

  void check_kinds() const {
    const int kinds = laws_.kinds();
    const std::string have = ", but the table of laws has " + std::to_string(kinds) + " kinds";
    LAGRAIN_EXPECTS(kinds >= 1, "the table of laws is empty");
    for (std::size_t i = 0; i < view_.kind.size(); ++i) {
      LAGRAIN_EXPECTS(view_.kind[i] < kinds, "grain " + std::to_string(i) + " is of kind " +
                                                 std::to_string(view_.kind[i]) + have);
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

  /// Blocks of slots, the unit of work of a thread: large enough that few pairs lie across them.
  static constexpr int kLeastBlock = Dim == 2 ? 1024 : 2048;
  static constexpr int kMostBlocks = 128;

  /// What a block's sweeps added up. How many contacts there were is a guess for the next step.
  struct Part {
    Tally across, within, walls;
    double pair_seconds = 0, wall_seconds = 0;
  };

  mutable State view_;
  mutable bool view_known_ = false;
  std::vector<int> numbers_;  // of the grains in the slots; empty if they are the slots
  std::vector<Record> records_;
  std::vector<Load> loads_;
  std::vector<Accelerations> old_;
  std::vector<std::uint8_t> kinds_;
  Eigen::VectorXd radius_;

  LawTable<Law> laws_;
  std::vector<Wall<Dim>> walls_;
  Setting<Dim> setting_;
  N neighbourhood_;
  ContactKernel<Dim, Law> kernel_;
  NearList<Dim, Memory> near_;
  bool near_holds_ = false;
  bool unfinished_ = false;  // the integrator's last word on the step is still to be spoken
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
