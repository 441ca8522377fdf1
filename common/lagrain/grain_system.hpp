// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Grains, walls and the contacts between them: what a simulation is made of and shows, whatever
/// moves it on.

#include <lagrain/body_force.hpp>
#include <lagrain/check.hpp>
#include <lagrain/contact_forces.hpp>
#include <lagrain/contact_law.hpp>
#include <lagrain/contact_rules.hpp>
#include <lagrain/grain_store.hpp>
#include <lagrain/grains.hpp>
#include <lagrain/law_table.hpp>
#include <lagrain/near_list.hpp>
#include <lagrain/neighbourhood.hpp>
#include <lagrain/passing.hpp>
#include <lagrain/pinned_grains.hpp>
#include <lagrain/records.hpp>
#include <lagrain/setting.hpp>
#include <lagrain/simulation_input.hpp>
#include <lagrain/state.hpp>
#include <lagrain/stopwatch.hpp>
#include <lagrain/threads.hpp>
#include <lagrain/walls.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

/// The part of a Simulation that does not depend on its integrator: grains in slots, walls, laws,
/// the list of near pairs with what contacts remember, and the paper's step 5, which keeps that
/// list and the triangulation up to date, also where grains come and leave.
template <int Dim, ContactLaw<Dim> Law, Neighbourhood<Dim> N>
class GrainSystem {
 public:
  static constexpr Needs needs = Law::needs;          ///< what the law needs
  using Memory = typename Law::template Memory<Dim>;  ///< what a contact remembers
  /// Pairs with what their contacts remember.
  /// @{
  using PairMemories = typename NearList<Dim, Memory>::PairMemories;
  using WallMemories = typename NearList<Dim, Memory>::WallMemories;
  /// @}

  std::int64_t steps() const { return steps_; }                                     ///< made so far
  double time() const { return static_cast<double>(steps_) * setting_.time_step; }  ///< [s]
  /// All grains as they are now, by number. Put together when asked for; stays until the next step.
  const Grains<Dim, needs>& grains() const { return store_.by_number(); }
  // What never changes is there without being put together.
  const Eigen::VectorXd& radii() const { return store_.radii(); }    ///< N, by number [m]
  const Eigen::VectorXd& masses() const { return store_.masses(); }  ///< N, by number [kg]
  /// N, by number, in increasing order: what a grain keeps when others come and leave, and what
  /// messages call it. Empty while the numbers are the ids.
  const std::vector<int>& ids() const { return store_.ids(); }
  const std::vector<Wall<Dim>>& walls() const { return walls_; }  ///< as they are now
  const LawTable<Law>& laws() const { return laws_; }             ///< as they were given
  const Setting<Dim>& setting() const { return setting_; }        ///< as it holds now
  const N& neighbourhood() const { return neighbourhood_; }       ///< what proposes the pairs
  /// Energy put in and taken out since the start.
  const EnergyFlow& flow() const { return flow_; }

  /// The body forces that act, and the work of each.
  const auto& body_forces() const { return body_forces_.works(); }
  /// What the others exert on all driven grains together, as it was evaluated last.
  const DrivenLoad<Dim>& driven() const { return driven_load_; }

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
  /// The listed pairs of grains and walls, sorted: the same for contacts with walls.
  std::vector<WallPair> near_wall_pairs() const {
    std::vector<WallPair> pairs;
    for (const auto& block : near_.blocks()) {
      for (WallPair pair : block.walls.pairs()) {
        pair.i = store_.number(pair.i);
        pairs.push_back(pair);
      }
    }
    std::sort(pairs.begin(), pairs.end());
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

  /// At most so many threads share the steps from now on: as many as pay on a machine that others
  /// may use as well.
  /// @throws ContractError if there are none
  void use_threads(int threads) {
    LAGRAIN_EXPECTS(threads >= 1, "threads " + std::to_string(threads));
    setting_.threads = threads;
    team_ = ThreadTeam(threads);
  }
  /// Keeps all that a simulation with the same laws, walls and setting needs to go on with the same
  /// bits, or restores it. What has been measured of its speed is not part of it.
  /// @throws SceneError if the state is not that of such a simulation; which is of no use then
  void persist(StateVisitor visit) {
    visit("step", steps_);
    flow_.persist(visit.in("energy"));
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      walls_[w].persist(visit.in("walls").in(std::to_string(w)));
    }
    visit("gravity", setting_.gravity);
    visit("first_gravity", first_gravity_);
    body_forces_.persist(visit.in("forces"));
    driven_load_.persist(visit.in("driven"));
    store_.persist(visit.in("grains"));
    near_.persist(visit.in("memory"), count(), block_size());
    if (!visit.restores()) return;
    expect_sound();
    go_on();
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
    for_each_contact_of([](int) { return true; }, f);
  }
  /// The same for the contacts with a grain of a kind: wanted(number).
  template <class Wanted, class F>
  void for_each_contact_of(Wanted&& wanted, F&& f) const {
    const Grains<Dim, needs>& g = grains();
    for_each_table([&](const auto& table) {
      for (std::size_t k = 0; k < table.size(); ++k) {
        const Pair pair{store_.number(table.pairs()[k].i), store_.number(table.pairs()[k].j)};
        if (!wanted(pair.i) && !wanted(pair.j)) continue;
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
    for_each_wall_contact_of([](int) { return true; }, f);
  }
  /// The same for the contacts of the grains of a kind: wanted(number).
  template <class Wanted, class F>
  void for_each_wall_contact_of(Wanted&& wanted, F&& f) const {
    const Grains<Dim, needs>& g = grains();
    for (const auto& block : near_.blocks()) {
      for (std::size_t k = 0; k < block.walls.size(); ++k) {
        WallPair pair = block.walls.pairs()[k];
        pair.i = store_.number(pair.i);
        if (!wanted(pair.i)) continue;
        const Wall<Dim>& wall = walls_[index(pair.wall)];
        const Vec<Dim> x = g.position.col(pair.i);
        const auto [distance, normal] =
            contact_foot<Dim>(walls_.data(), block.walls.pairs(), k, x, g.radius[pair.i]);
        const Vec<Dim> velocity = wall.velocity_at(x - distance * normal, normal);
        const auto [touching, touch] =
            touch_of_wall(body(g, pair.i), g.mass[pair.i], distance, normal, velocity, wall.spin);
        if (!touching) continue;
        Memory memory = block.walls.memory(k);
        f(pair, touch, laws_.with_wall(g.material, pair.i, wall.material).respond(touch, memory, 0),
          memory);
      }
    }
  }

 protected:
  /// @cond  What Simulation builds on.
  using Record = GrainRecord<Dim, needs>;
  using Load = LoadRecord<Dim, needs>;

  /// Step 1 of the paper is the first call of update_triangulation.
  GrainSystem(Grains<Dim, needs> grains, LawTable<Law> laws, std::vector<Wall<Dim>> walls,
              Setting<Dim> setting, N neighbourhood)
      : store_(std::move(grains), !laws.one_law()),
        laws_(std::move(laws)),
        walls_(std::move(walls)),
        setting_(std::move(setting)),
        first_gravity_(setting_.gravity),
        neighbourhood_(std::move(neighbourhood)),
        forces_(setting_.instructions, store_.materials().empty()) {
    use_threads(setting_.threads);
    expect_sound_walls(walls_);
    join_walls(walls_);
    for (Wall<Dim>& wall : walls_) wall.advance(0, 0);
    setting_.gravity = gravity_at(setting_.gravity_course, first_gravity_, 0);
    near_.reset(count(), block_size());
    watch_ = PassageWatch<Dim>(walls_, 0);
    meet_grains();
  }

  int count() const { return store_.count(); }

  /// f(block, thread) for every block, shared by the threads.
  template <class F>
  void for_each_block(const F& f) {
    team_.share(near_.blocks().size(), f);
  }

  void sort_grains() {
    if (!store_.order_matters()) return;
    store_.expect_finite(time());
    const std::vector<int> slot_of = store_.sort_if_mixed();
    if (slot_of.empty()) return;
    near_.renumber(slot_of, count(), block_size());
    renumber_encounters(slot_of);
    meet_grains();
    if constexpr (requires { neighbourhood_.forget(); }) neighbourhood_.forget();
  }

  /// Brings the walls to time t [s], a step dt [s] after the last call. A wall that goes takes
  /// along what the contacts with it have stored.
  void advance_walls(double t, double dt) {
    update_loads(walls_);
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      if (!walls_[w].gone && t >= walls_[w].until) {
        const double taken = elastic_energy_at(w);
        walls_[w].work -= taken;
        flow_.wall_work -= taken;
      }
      walls_[w].advance(t, dt);
    }
  }

  /// From the next evaluation on gravity is g [m/s^2], and steady.
  void set_gravity_to(const Vec<Dim>& g) {
    setting_.gravity_course = SteadyGravity{};
    first_gravity_ = g;
    moment_ = moment_of_mass();
  }

  /// Brings gravity to time t [s], at which the grains are. Who changes it does work. As far as its
  /// kinetic energy goes, velocity Verlet moves a grain from x to x' by the mean of the forces
  /// before and after (but for dt^2 m (a'^2 - a^2) / 8, which does not add up). With the potential
  /// -g . sum m x this leaves the work -(g' - g) . sum m (x + x') / 2.
  void advance_gravity(double t) {
    const Vec<Dim> now = gravity_at(setting_.gravity_course, first_gravity_, t);
    if (is_steady(setting_.gravity_course) && now == setting_.gravity) return;
    const Vec<Dim> moment = moment_of_mass();
    flow_.gravity_work -= 0.5 * (now - setting_.gravity).dot(moment_ + moment);
    setting_.gravity = now;
    moment_ = moment;
  }

  /// The power and the load of the driven grains of a block, from their loads.
  DrivenLoad<Dim> driven_in(int first_slot, int end_slot, const Load* loads) const {
    DrivenLoad<Dim> sum;
    const auto begin = std::lower_bound(driven_.begin(), driven_.end(), first_slot);
    for (auto slot = begin; slot != driven_.end() && *slot < end_slot; ++slot) {
      const Record& grain = store_.record(*slot);
      const Load& load = loads[*slot - first_slot];
      sum.power -= load.force().dot(grain.velocity());
      sum.force += load.force() - load.at[Load::kMass] * setting_.gravity;
      if constexpr (needs.spin) {
        sum.power -= load.torque().dot(grain.omega());
        sum.torque += load.torque();
      }
    }
    return sum;
  }

  /// Marks for grains and walls.
  struct Marks {
    std::vector<bool> grains;  ///< by number
    std::vector<bool> walls;   ///< by place among the walls
  };

  /// Grains leave and others come, with the energy that they carry. What contacts of the others
  /// remember stays.
  /// @param kept  numbers of those that stay, in increasing order
  /// @returns whose forces change: newcomers, and what touches them or touched one that left
  Marks exchange_grains(const std::vector<int>& kept, const Grains<Dim, needs>& newcomers) {
    std::vector<bool> leaves(index(count()), true);
    for (const int i : kept) leaves[index(i)] = false;
    Marks before{leaves, std::vector<bool>(walls_.size())};
    flow_.carried -= energy_of(leaves, before);
    Marks changed{{}, before.walls};
    for (const int i : kept) changed.grains.push_back(before.grains[index(i)]);

    const bool one_law = store_.materials().empty();
    const std::vector<int> slot_of = store_.exchange(kept, newcomers);
    near_.renumber(slot_of, count(), block_size());
    renumber_encounters(slot_of);
    if (store_.materials().empty() != one_law) {
      forces_ = ContactForces<Dim, Law>(setting_.instructions, store_.materials().empty());
      forces_.measure_time(measuring_);
    }
    watch_ = PassageWatch<Dim>(walls_, time());
    meet_grains();
    if constexpr (requires {
                    neighbourhood_.exchange(slot_of, store_.places(), store_.radius());
                  }) {
      store_.expect_finite(time());
      const Stopwatch watch;
      neighbourhood_.exchange(slot_of, store_.places(), store_.radius());
      times_.refresh += watch.seconds();
    } else if constexpr (requires { neighbourhood_.forget(); }) {
      neighbourhood_.forget();
    }
    update_triangulation(time());

    moment_ = moment_of_mass();
    std::vector<bool> is_new(kept.size(), false);
    is_new.resize(index(count()), true);
    changed.grains.resize(index(count()), true);
    flow_.carried += energy_of(is_new, changed);
    return changed;
  }

  /// Contacts remember what these entries say, by number, and no others anything.
  void recall_contacts(PairMemories pairs, WallMemories wall_pairs) {
    std::vector<int> slot_of(index(count()));
    for (int slot = 0; slot < count(); ++slot) slot_of[index(store_.number(slot))] = slot;
    near_.recall(std::move(pairs), std::move(wall_pairs), slot_of, count(), block_size());
    update_triangulation(time());
  }

  /// Grains and walls have come to where they are at time t [s].
  void expect_no_passage(double t) {
    watch_.expect_no_passage(
        count(), [&](int slot) -> const Record& { return store_.record(slot); },
        [&](int slot) { return store_.id(slot); }, walls_, near_.rules(), t,
        near_.shift(t) - near_.shift(watch_.since()), setting_.time_step);
  }

  // ---- The paper's step 5 ----------------------------------------------------------------------

  /// Brings the near list, and with it T, up to date with the grains and walls at time t [s].
  void update_triangulation(double t) {
    renew_near_list(t);
    for (const Wall<Dim>& wall : walls_) {
      if (!wall.front_only) continue;
      find_encounters();
      break;
    }
  }

  GrainStore<Dim, needs> store_;
  LawTable<Law> laws_;
  std::vector<Wall<Dim>> walls_;
  Setting<Dim> setting_;
  Vec<Dim> first_gravity_;              // before anything has changed it
  Vec<Dim> moment_ = Vec<Dim>::Zero();  // sum m x, as gravity was looked at last
  N neighbourhood_;
  BodyForces<Dim, needs> body_forces_;
  std::vector<int> driven_;  // slots of the grains that are driven
  DrivenLoad<Dim> driven_load_;
  std::vector<DrivenLoad<Dim>> driven_in_blocks_;
  ContactForces<Dim, Law> forces_;
  NearList<Dim, Memory> near_;
  EnergyFlow flow_;
  double force_step_ = 0;  // what memories and losses advance by in an evaluation [s]
  std::int64_t steps_ = 0;
  ThreadTeam team_;
  PhaseTimes times_;
  bool measuring_ = false;

  std::vector<std::vector<int>> strays_;  // grains of each block that have left their margins
  std::vector<int> all_strays_;
  PassageWatch<Dim> watch_;
  /// @endcond

 private:
  /// Blocks of slots are the unit of work of a thread. They are so large that few pairs lie across
  /// them, and so few that what each adds up costs nothing. In blocks of half the size 2^(1/Dim)
  /// times as many pairs lie across; with twice the size small scenes have too few blocks for many
  /// threads. Results depend on the size in the last digits, because blocks fix the order of sums.
  static constexpr int kLeastBlock = Dim == 2 ? 1024 : 2048;
  static constexpr int kMostBlocks = 128;

  template <class I>
  static std::size_t index(I i) {
    return static_cast<std::size_t>(i);
  }

  /// sum m x [kg m], in the order of the slots.
  Vec<Dim> moment_of_mass() const {
    Vec<Dim> moment = Vec<Dim>::Zero();
    for (int slot = 0; slot < count(); ++slot) {
      moment += store_.load(slot).at[Load::kMass] * store_.record(slot).position();
    }
    return moment;
  }

  static Body<Dim, needs> body(const Grains<Dim, needs>& g, int i) {
    Body<Dim, needs> b{g.position.col(i), g.velocity.col(i), g.radius[i], g.inverse_mass[i], {}};
    if constexpr (needs.spin) b.omega = g.omega.col(i);
    return b;
  }

  /// Everything is as a state says: what is kept besides to be fast follows.
  /// What was restored may point to grains and laws that there are not.
  void expect_sound() const {
    const auto known = [&](int material) { return material >= 0 && material < laws_.materials(); };
    const auto present = [&](int slot) { return slot >= 0 && slot < count(); };
    for (const int material : store_.materials()) {
      if (!known(material)) throw SceneError("a grain of it is of a material that there is not");
    }
    for (const Wall<Dim>& wall : walls_) {
      for (const auto& encounter : wall.encounters) {
        if (!present(encounter.grain))
          throw SceneError("a wall of it has met a grain that is none");
      }
    }
    if (steps_ < 0) throw SceneError("its number of steps is negative");
  }

  void go_on() {
    forces_ = ContactForces<Dim, Law>(setting_.instructions, store_.materials().empty());
    forces_.measure_time(measuring_);
    watch_ = PassageWatch<Dim>(walls_, time());
    meet_grains();
    if constexpr (requires { neighbourhood_.forget(); }) neighbourhood_.forget();
    moment_ = moment_of_mass();
    update_triangulation(time());
  }

  /// Makes the near list anew if it no longer holds. Single grains that have left their margins are
  /// amended, if that will do.
  void renew_near_list(double t) {
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

  /// Sees who touches walls that are solid from the front alone, and who passes through them.
  void find_encounters() {
    std::vector<std::vector<typename Wall<Dim>::Encounter>> now(walls_.size());
    for (const auto& block : near_.blocks()) {
      const std::vector<WallPair>& pairs = block.walls.pairs();
      for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {
        const auto [slot, w, unused] = pairs[first];
        while (end < pairs.size() && pairs[end].i == slot && pairs[end].wall == w) ++end;
        if (!walls_[index(w)].front_only) continue;
        const Record& grain = store_.record(slot);
        note_encounter<Dim>(walls_[index(w)], {pairs.data() + first, end - first}, grain.position(),
                            grain.radius(), now[index(w)]);
      }
    }
    for (std::size_t w = 0; w < walls_.size(); ++w) walls_[w].encounters = std::move(now[w]);
  }
  /// @param slot_of  new slot of each old one; -1 where the grain has left
  void renumber_encounters(const std::vector<int>& slot_of) {
    for (Wall<Dim>& wall : walls_) {
      for (auto& encounter : wall.encounters) encounter.grain = slot_of[index(encounter.grain)];
      std::erase_if(wall.encounters, [](const auto& encounter) { return encounter.grain < 0; });
      std::sort(wall.encounters.begin(), wall.encounters.end(),
                [](const auto& a, const auto& b) { return a.grain < b.grain; });
    }
  }

  /// What the contacts with a wall have stored [J].
  double elastic_energy_at(std::size_t wall) {
    store_.outdate();
    double energy = 0;
    for_each_wall_contact(
        [&](WallPair pair, const Touch<Dim>& touch, const auto&, const Memory& memory) {
          if (index(pair.wall) != wall) return;
          energy += laws_.with_wall(grains().material, pair.i, walls_[wall].material)
                        .elastic_energy(touch, memory);
        });
    store_.outdate();
    return energy;
  }

  template <class F>
  void for_each_table(F&& f) const {
    for (const auto& block : near_.blocks()) {
      f(block.within);
      f(block.across);
    }
  }

  int block_size() const {
    return std::max(kLeastBlock, (count() + kMostBlocks - 1) / kMostBlocks);
  }

  /// The grains have come to lie in other slots, or they are others.
  void meet_grains() {
    near_.set_rules(ContactRules(
        PinnedGrains(count(),
                     [&](int slot) { return store_.record(slot).at[Record::kInverseMass]; }),
        store_.materials(), laws_.apart()));
    driven_.clear();
    for (int slot = 0; slot < count(); ++slot) {
      const Record& grain = store_.record(slot);
      bool moves = !grain.velocity().isZero(0);
      if constexpr (needs.spin) moves = moves || !grain.omega().isZero(0);
      if (moves && !(grain.at[Record::kInverseMass] > 0)) driven_.push_back(slot);
    }
    strays_.assign(near_.blocks().size(), {});
    // A run that may overlap without a limit may pass through things as well.
    if (std::isfinite(setting_.largest_overlap) && count() > 0) {
      watch_.meet(near_.blocks().size(), store_.radius().minCoeff());
    }
  }

  /// Kinetic and potential energy of some grains, and the elastic energy of their contacts [J].
  /// @param some     marks them
  /// @param touched  gets marks where grains and walls touch one of them
  double energy_of(const std::vector<bool>& some, Marks& touched) const {
    const Grains<Dim, needs>& g = grains();
    std::vector<int> numbers;
    for (int i = 0; i < count(); ++i) {
      if (some[index(i)]) numbers.push_back(i);
    }
    const auto theirs = joined(g, numbers, make_grains<Dim, needs>({}));
    double energy = kinetic_energy(theirs) - setting_.gravity.dot(theirs.position * theirs.mass);
    const auto wanted = [&](int i) { return static_cast<bool>(some[index(i)]); };
    for_each_contact_of(wanted, [&](Pair pair, const auto& touch, const auto&, const auto& memory) {
      energy += laws_.of(g.material, pair.i, pair.j).elastic_energy(touch, memory);
      touched.grains[index(pair.i)] = touched.grains[index(pair.j)] = true;
    });
    for_each_wall_contact_of(
        wanted, [&](WallPair pair, const auto& touch, const auto&, const auto& memory) {
          const int material = walls_[index(pair.wall)].material;
          energy += laws_.with_wall(g.material, pair.i, material).elastic_energy(touch, memory);
          touched.walls[index(pair.wall)] = true;
        });
    return energy;
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
};

}  // namespace lagrain
