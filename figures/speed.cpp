#include "speed.hpp"

#include "beds.hpp"
#include "contenders.hpp"
#include "lammps.hpp"
#include "measure.hpp"

#include <lagrain/audit.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/observe.hpp>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <type_traits>
#include <utility>

namespace lagrain::bench {

namespace {

namespace fs = std::filesystem;

constexpr int kRounds = 3;
constexpr int kTurns = 12;  // that the measured steps of a round are taken in
constexpr int kAudits = 4;  // in the course of them
static_assert(kTurns % kAudits == 0);

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds of the wall clock that the simulation has spent so far, phase by phase; what it does not
/// name is the rest of the step.
template <class Sim>
std::vector<Phase> phases_so_far(const Sim& sim) {
  const PhaseTimes& t = sim.times();
  return {{"neighbourhood", 1e9 * t.refresh},
          {"grain forces", 1e9 * t.pairs},
          {"wall forces", 1e9 * t.walls},
          {"integration", 1e9 * t.integration}};
}

/// How many steps, and who takes part.
struct Plan {
  int warm_up = 0;
  int steps = 0;  ///< a multiple of kTurns
  int rounds = kRounds;
  bool oracle = true;
  bool rebuilt = true;
  bool lammps = true;
  bool multi = false;  ///< LAMMPS with bins by size as well
  bool bin = true;     ///< LAMMPS with equal bins
};

/// What one run of a contender gives.
template <int Dim>
struct Sample {
  double cpu = 0;  ///< [s], of the measured steps
  std::vector<Phase> phases;
  RunErrors errors;
  Columns<Dim> position;  ///< by id, at the end [m]
};

/// Contacts, overlaps, load and kinetic energy of a state, by a search of its own.
template <int Dim>
void examine(const Bed<Dim>& bed, const Columns<Dim>& x, const Columns<Dim>& v, RunErrors& errors) {
  const int n = bed.count();
  Eigen::VectorXd radius(n), no_margin = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) radius[i] = bed.grains[static_cast<std::size_t>(i)].radius;
  std::vector<Pair> touching;
  if (radius.maxCoeff() < 8 * radius.minCoeff()) {
    CellGrid<Dim>{}.near_pairs(x, radius, no_margin, touching);
  } else {
    TriangulationNeighbourhood<Dim>{}.near_pairs(x, radius, no_margin, touching);
  }
  double sum = 0, deepest = 0, load = 0, weight = 0, kinetic = 0;
  for (const auto& [i, j] : touching) {
    const double overlap =
        (radius[i] + radius[j] - (x.col(i) - x.col(j)).norm()) / std::min(radius[i], radius[j]);
    sum += overlap;
    deepest = std::max(deepest, overlap);
  }
  for (int i = 0; i < n; ++i) {
    const double mass = bed.grains[static_cast<std::size_t>(i)].mass;
    load += bed.law.normal.stiffness * std::max(0.0, radius[i] - x(Dim - 1, i));
    weight += mass * kGravity;
    kinetic += 0.5 * mass * v.col(i).squaredNorm();
  }
  const auto contacts = static_cast<double>(touching.size());
  errors.contacts_per_grain = contacts / n;
  errors.mean_overlap = contacts > 0 ? sum / contacts : 0;
  errors.largest_overlap = deepest;
  if (!bed.walls.front().moves()) errors.floor_load = load / weight;
  errors.kinetic = kinetic;
}

/// Phases in nanoseconds of processor time per grain and step: shares of the wall clock, because a
/// phase of nanoseconds cannot ask for the processor's.
std::vector<Phase> per_grain_step(const std::vector<Phase>& spent, double wall, double cpu,
                                  double grain_steps) {
  std::vector<Phase> phases;
  double rest = 1;
  for (const Phase& phase : spent) {
    const double share = 1e-9 * phase.ns / wall;
    phases.push_back({phase.name, 1e9 * share * cpu / grain_steps});
    rest -= share;
  }
  phases.push_back({"rest of the step", 1e9 * rest * cpu / grain_steps});
  return phases;
}

template <int Dim>
double grain_steps(const Bed<Dim>& bed, const Plan& plan) {
  return static_cast<double>(bed.count()) * plan.steps;
}

/// A contender on its way through the measured steps, in turns with others.
template <int Dim>
class TurnTaker {
 public:
  virtual ~TurnTaker() = default;
  virtual void take_turn(int turn) = 0;
  /// @pre all turns are taken
  virtual Sample<Dim> sample() = 0;
};

template <int Dim, class N>
class LagrainRun : public TurnTaker<Dim> {
 public:
  /// Takes the steps before those that are measured.
  /// @param careful measure the errors too, outside of the measured time
  LagrainRun(const Bed<Dim>& bed, const Plan& plan, N neighbourhood, bool careful)
      : bed_(bed),
        plan_(plan),
        careful_(careful),
        sim_(simulate<Dim, N>(bed, std::move(neighbourhood))) {
    sim_.measure_phases(true);
    sim_.step(plan.warm_up);
    if (careful) start_ = energy_ledger(sim_);
    refreshes_ = sim_.refreshes();
    before_ = phases_so_far(sim_);
  }

  void take_turn(int turn) override {
    const double wall = wall_seconds(), cpu = processor_seconds();
    sim_.step(plan_.steps / kTurns);
    cpu_ += processor_seconds() - cpu;
    wall_ += wall_seconds() - wall;
    if (!careful_ || (turn + 1) % (kTurns / kAudits) != 0) return;
    const std::vector<Pair> pairs = sim_.near_pairs();
    audit_.check(sim_.grains().position, sim_.grains().radius, pairs);
    near_ = static_cast<double>(pairs.size());
  }

  Sample<Dim> sample() override {
    Sample<Dim> sample;
    sample.cpu = cpu_;
    std::vector<Phase> spent = phases_so_far(sim_);
    for (std::size_t k = 0; k < spent.size(); ++k) spent[k].ns -= before_[k].ns;
    sample.phases = per_grain_step(spent, wall_, cpu_, grain_steps(bed_, plan_));
    sample.position = sim_.grains().position;
    if (careful_) sample.errors = errors();
    return sample;
  }

 private:
  RunErrors errors() const {
    RunErrors errors;
    examine<Dim>(bed_, sim_.grains().position, sim_.grains().velocity, errors);
    errors.missed = static_cast<double>(audit_.missed());
    errors.audited = static_cast<double>(audit_.contacts());
    const Ledger end = energy_ledger(sim_);
    const double turnover =
        std::max({end.kinetic + end.elastic,
                  end.dashpot + end.friction - start_.dashpot - start_.friction, 1e-300});
    errors.energy_residual = residual(end, start_) / turnover;
    errors.near_per_contact = near_ / (errors.contacts_per_grain * bed_.count());
    errors.refreshes = 1000 * static_cast<double>(sim_.refreshes() - refreshes_) / plan_.steps;
    return errors;
  }

  const Bed<Dim>& bed_;
  const Plan& plan_;
  bool careful_;
  BedSimulation<Dim, N> sim_;
  Ledger start_;
  std::int64_t refreshes_ = 0;
  std::vector<Phase> before_;
  double cpu_ = 0, wall_ = 0;  // [s]
  ContactAudit<Dim> audit_;
  double near_ = 0;  // pairs in the list
};

/// What the triangulation answers in a run, for the oracle.
template <int Dim>
Answers<Dim> record_answers(const Bed<Dim>& bed, int steps, const Checkpoint& checkpoint) {
  RecordingNeighbourhood<Dim> recorder;
  const auto answers = recorder.answers();
  auto sim = simulate<Dim, RecordingNeighbourhood<Dim>>(bed, std::move(recorder));
  note_touching<Dim>(*answers, sim.grains().position, sim.grains().radius);
  for (int s = 0; s < steps; ++s) {
    sim.step();
    note_touching<Dim>(*answers, sim.grains().position, sim.grains().radius);
    if (s % 50 == 0) checkpoint();
  }
  return std::move(*answers);
}

template <int Dim>
class LammpsTurns : public TurnTaker<Dim> {
 public:
  LammpsTurns(const fs::path& program, const fs::path& folder, const Bed<Dim>& bed,
              const Plan& plan, bool multi, bool careful)
      : bed_(bed),
        plan_(plan),
        careful_(careful),
        run_(program, folder, bed, {plan.warm_up, plan.steps, kTurns, multi}) {}

  void take_turn(int) override { run_.take_turn(); }

  Sample<Dim> sample() override {
    const LammpsReport<Dim> report = run_.finish();
    Sample<Dim> sample;
    sample.cpu = report.cpu_seconds;
    std::vector<Phase> spent;
    for (const auto& [name, seconds] : report.phases) {
      if (name == "Neigh") spent.push_back({"neighbourhood", 1e9 * seconds});
      if (name == "Pair") spent.push_back({"grain forces", 1e9 * seconds});
      if (name == "Modify") spent.push_back({"walls and integration", 1e9 * seconds});
    }
    sample.phases =
        per_grain_step(spent, report.wall_seconds, report.cpu_seconds, grain_steps(bed_, plan_));
    sample.position = report.position;
    if (!careful_) return sample;
    RunErrors& errors = sample.errors;
    examine<Dim>(bed_, report.position, report.velocity, errors);
    errors.dangerous = static_cast<double>(report.dangerous);
    errors.near_per_contact =
        static_cast<double>(report.neighbours) / (errors.contacts_per_grain * bed_.count());
    errors.refreshes = 1000 * static_cast<double>(report.builds) / plan_.steps;
    return sample;
  }

 private:
  const Bed<Dim>& bed_;
  const Plan& plan_;
  bool careful_;
  LammpsRun<Dim> run_;
};

std::string folder_name(const std::string& scene) {
  std::string name;
  for (const char c : scene) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  return name;
}

/// Grains with commas between the thousands.
std::string grouped(int count) {
  std::string text = std::to_string(count);
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), 1, ',');
  }
  return text;
}

class Harness {
 public:
  Harness(const FigureOptions& options, const std::optional<fs::path>& lammps,
          const std::function<void(const SpeedResults&)>& after_scene)
      : options_(options), lammps_(lammps), after_scene_(after_scene) {
    checkpoint_ = [this] {
      options_.check_stop();
      options_.progress(done_ / scenes_, doing_);
    };
  }

  SpeedResults run() {
    std::vector<std::function<void()>> scenes;
    add_settled(scenes);
    add_sizes(scenes);
    add_impacts(scenes);
    add_moving(scenes);
    add_growth(scenes);
    scenes_ = static_cast<double>(scenes.size());
    for (const auto& scene : scenes) {
      scene();
      ++done_;
      after_scene_(results_);
    }
    return std::move(results_);
  }

 private:
  static constexpr double kRadius = 0.02;  // of the discs, the larger ones, and of most balls [m]

  bool quick() const { return options_.quick; }

  /// As many steps as give each contender about the same work, whatever the number of grains.
  Plan plan_for(int grains, double grain_steps) const {
    Plan plan;
    const double effort = quick() ? grain_steps / 40 : grain_steps;
    // Long turns: the first step of each takes one more pass over the grains.
    plan.steps =
        kTurns * std::clamp(static_cast<int>(effort / grains / kTurns), quick() ? 2 : 20, 250);
    plan.warm_up = std::min(200, 2 * plan.steps);  // margins adapt
    if (quick()) plan.rounds = 2;
    return plan;
  }

  /// The same, through two whole periods of shaking, after one in which lists and skins settle.
  template <int Dim>
  Plan plan_of_period(const Bed<Dim>& bed, double radius) const {
    Plan plan = plan_for(bed.count(), 3e6);
    const double period = shake_period(radius) / bed.setting.time_step / (quick() ? 16 : 1);
    plan.warm_up = static_cast<int>(std::lround(period));
    plan.steps = kTurns * static_cast<int>(std::lround(2 * period / kTurns));
    return plan;
  }

  /// One scene and all who take part.
  template <int Dim>
  struct Match {
    struct Entry {
      std::string name;
      /// Takes the steps before those that are measured. Reads this match, which stays in its
      /// place.
      std::function<std::unique_ptr<TurnTaker<Dim>>(bool careful)> start;
      std::unique_ptr<TurnTaker<Dim>> running;
      std::vector<std::vector<Phase>> phases;  // by round
      Columns<Dim> position;                   // at the end of the first [m]
      bool out = false;
    };
    Bed<Dim> bed;
    Plan plan;
    SceneSpeed scene;
    std::vector<Entry> entries;
  };

  // Beds. Each tile settles once.

  const Bed<2>& disc_tile() {
    const int count = quick() ? 250 : 1000;
    return tile<2>({count, kRadius, 0.7 * kRadius, quick() ? 0.42 : 0.6});
  }
  /// A quarter of the unit cube's grains in a quarter of its area; an eighth as many if quick, of
  /// twice the radius.
  const Bed<3>& ball_tile(int count, double radius) {
    const double larger = quick() ? 2 * radius : radius;
    return tile<3>({quick() ? count / 8 : count, larger, larger, 0.5});
  }
  template <int Dim>
  const Bed<Dim>& tile(const Pour<Dim>& what) {
    auto& tiles = tiles_of<Dim>();
    const std::pair<int, double> key{what.count, what.radius};
    auto at = tiles.find(key);
    if (at == tiles.end()) {
      doing_ = "settling " + std::to_string(what.count) + (Dim == 2 ? " discs" : " spheres");
      at = tiles.emplace(key, pour<Dim>(what, checkpoint_)).first;
    }
    return at->second;
  }
  template <int Dim>
  std::map<std::pair<int, double>, Bed<Dim>>& tiles_of() {
    if constexpr (Dim == 2) {
      return disc_tiles_;
    } else {
      return ball_tiles_;
    }
  }

  /// Without its highest grains, as long as there are more than `count`.
  static Bed<3> trimmed(Bed<3> bed, int count) {
    std::stable_sort(bed.grains.begin(), bed.grains.end(),
                     [](const auto& a, const auto& b) { return a.position.z() < b.position.z(); });
    if (bed.count() > count) bed.grains.resize(static_cast<std::size_t>(count));
    return bed;
  }

  // Scenes.

  void add_settled(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      const Bed<2> bed = tiled<2>(disc_tile(), {quick() ? 4 : 20});
      compete<2>(kSettledGroup, "discs", bed, plan_for(bed.count(), 6e6), bed.count());
    });
    struct Cube {
      int tile;
      int count;
      double radius;
    };
    // The paper's boxes, each made of four quarters.
    for (const Cube& cube : {Cube{371, 1484, 0.04}, {875, 3498, 0.03}, {1736, 6944, 0.02}}) {
      if (quick() && cube.tile != 371) continue;
      scenes.emplace_back([this, cube] {
        const Bed<3> bed = trimmed(tiled<3>(ball_tile(cube.tile, cube.radius), {2, 2}), cube.count);
        compete<3>(kSettledGroup, "spheres", bed, plan_for(bed.count(), 3e6), bed.count());
      });
    }
    if (quick()) return;
    scenes.emplace_back([this] {
      const Bed<3> bed = tiled<3>(ball_tile(1736, kRadius), {6, 6});
      Plan plan = plan_for(bed.count(), 3e6);
      plan.rounds = 2;
      plan.rebuilt = false;
      compete<3>(kSettledGroup, "spheres", bed, plan, bed.count());
    });
  }

  template <int Dim>
  std::unique_ptr<Match<Dim>> mixture(const Bed<Dim>& tile, const std::vector<int>& copies,
                                      int ratio, int large) {
    Bed<Dim> bed = tiled<Dim>(tile, copies);
    const double small = bed.grains.front().radius;
    const double largest =
        std::max_element(bed.grains.begin(), bed.grains.end(), [](const auto& a, const auto& b) {
          return a.radius < b.radius;
        })->radius;
    doing_ = "sizes 1 : " + std::to_string(ratio);
    if (large > 0)
      put_large_grains<Dim>(bed, ratio * (Dim == 3 ? small : largest), large, checkpoint_);
    Plan plan = plan_for(bed.count(), 3e6);
    plan.multi = ratio > 1;
    plan.bin = ratio <= 10;
    plan.rebuilt = false;
    return prepare<Dim>(
        kSizesGroup, std::string(Dim == 2 ? "discs" : "spheres") + " 1 : " + std::to_string(ratio),
        bed, plan, ratio);
  }
  void add_sizes(std::vector<std::function<void()>>& scenes) {
    struct Mix {
      int ratio, tiles, large;
    };
    scenes.emplace_back([this] {
      std::vector<std::unique_ptr<Match<2>>> matches;
      for (const Mix& mix : {Mix{1, 20, 0}, {10, 21, 10}, {30, 22, 4}, {100, 30, 2}}) {
        if (quick() && mix.ratio > 10) continue;
        matches.push_back(mixture<2>(disc_tile(), {quick() ? 4 : mix.tiles}, mix.ratio,
                                     quick() ? std::min(mix.large, 2) : mix.large));
      }
      compete_together(matches);
    });
    if (quick()) return;
    scenes.emplace_back([this] {
      std::vector<std::unique_ptr<Match<3>>> matches;
      for (const Mix& mix : {Mix{1, 4, 0}, {10, 4, 5}, {30, 4, 1}}) {
        matches.push_back(
            mixture<3>(ball_tile(1736, kRadius), {mix.tiles, mix.tiles}, mix.ratio, mix.large));
      }
      compete_together(matches);
    });
  }

  /// The settled box, five times as hard, and above its middle a ball of five radii.
  Bed<3> target() {
    constexpr double kHarder = 5, kBall = 5;
    Bed<3> tile = ball_tile(quick() ? 371 : 1736, quick() ? 2 * kRadius : kRadius);
    const double r = tile.grains.front().radius;
    doing_ = "making the target";
    settle<3>(tile, r, r, {{1 / kHarder, 2}}, checkpoint_);
    Bed<3> bed = tiled<3>(tile, {2, 2});
    choose_law<3>(bed, r, r, kRestitution, 1 / kHarder);
    Grain<3> ball;
    ball.radius = kBall * r;
    ball.mass = kDensity * grain_volume<3>(ball.radius);
    ball.position = 0.5 * bed.size;
    ball.position.z() = ball.radius;
    for (const Grain<3>& grain : bed.grains) {
      const double reach = 1.0001 * (ball.radius + grain.radius);
      const double beside = (ball.position - grain.position).head<2>().squaredNorm();
      if (beside >= reach * reach) continue;
      ball.position.z() =
          std::max(ball.position.z(), grain.position.z() + std::sqrt(reach * reach - beside));
    }
    bed.grains.push_back(ball);
    return bed;
  }
  void add_impacts(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      Bed<3> bed = target();
      Plan plan = plan_for(bed.count(), 3e6);
      plan.warm_up = 10;
      plan.multi = true;
      std::vector<std::unique_ptr<Match<3>>> matches;
      for (const int speed : {0, 1, 10, 50}) {
        if (quick() && speed == 1) continue;
        bed.grains.back().velocity = {0, 0, -static_cast<double>(speed)};
        matches.push_back(prepare<3>(
            kImpactGroup, "a ball of 5 r at " + std::to_string(speed) + " m/s", bed, plan, speed));
      }
      compete_together(matches);
    });
  }

  void add_moving(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      Bed<2> bed = tiled<2>(disc_tile(), {quick() ? 2 : 5});
      doing_ = "a column starts to collapse";
      bed.size[0] *= 3;  // the right wall gives way
      bed.walls = open_box<2>(bed.size);
      advance<2>(bed, steps_for(bed, kRadius, 6), checkpoint_);
      compete<2>(kMovingGroup, "a column of discs collapses", bed, plan_for(bed.count(), 3e6), 0);
    });
    scenes.emplace_back([this] {
      Bed<2> bed = tiled<2>(disc_tile(), {quick() ? 2 : 10});
      doing_ = "shaking discs";
      shake<2>(bed, kRadius, checkpoint_);
      compete<2>(kMovingGroup, "discs shaken with 4 g", bed, plan_of_period(bed, kRadius), 0);
    });
    scenes.emplace_back([this] {
      Bed<3> bed = ball_tile(quick() ? 371 : 1736, quick() ? 2 * kRadius : kRadius);
      doing_ = "shaking spheres";
      const double radius = bed.grains.front().radius;
      shake<3>(bed, radius, checkpoint_);
      compete<3>(kMovingGroup, "spheres shaken with 4 g", bed, plan_of_period(bed, radius), 0);
    });
  }

  void add_growth(std::vector<std::function<void()>>& scenes) {
    scenes.emplace_back([this] {
      std::vector<std::unique_ptr<Match<2>>> matches;
      for (const int tiles :
           quick() ? std::vector<int>{1, 4} : std::vector<int>{1, 10, 100, 1000}) {
        const Bed<2> bed = tiled<2>(disc_tile(), {tiles});
        Plan plan = plan_for(bed.count(), 3e6);
        plan.oracle = plan.rebuilt = plan.lammps = false;
        matches.push_back(prepare<2>(kGrowthGroup, "discs", bed, plan, bed.count()));
      }
      compete_together(matches);
    });
  }

  // The competition.

  template <int Dim>
  void compete(const std::string& group, const std::string& what, const Bed<Dim>& bed,
               const Plan& plan, double parameter) {
    std::vector<std::unique_ptr<Match<Dim>>> match;
    match.push_back(prepare<Dim>(group, what, bed, plan, parameter));
    compete_together(match);
  }

  /// Round by round, and in each round turn by turn, through all scenes and contenders: what is
  /// compared shares the machine's moods, which may last a second.
  template <int Dim>
  void compete_together(const std::vector<std::unique_ptr<Match<Dim>>>& matches) {
    const auto for_each_entry = [&](auto&& f) {
      for (const auto& match : matches) {
        for (std::size_t k = 0; k < match->entries.size(); ++k) {
          if (!match->entries[k].out) f(*match, k);
        }
      }
    };
    for (int round = 0; round < matches.front()->plan.rounds; ++round) {
      const bool careful = round == 0;
      for_each_entry([&](Match<Dim>& match, std::size_t k) {
        auto& entry = match.entries[k];
        doing_ = match.scene.name + ": " + entry.name + ", round " + std::to_string(round + 1);
        checkpoint_();
        unless_it_fails(match, k, [&] { entry.running = entry.start(careful); });
      });
      for (int turn = 0; turn < kTurns; ++turn) {
        for_each_entry([&](Match<Dim>& match, std::size_t k) {
          checkpoint_();
          unless_it_fails(match, k, [&] { match.entries[k].running->take_turn(turn); });
        });
      }
      for_each_entry([&](Match<Dim>& match, std::size_t k) {
        unless_it_fails(match, k,
                        [&] { note(match, k, careful, match.entries[k].running->sample()); });
        match.entries[k].running = nullptr;
      });
    }
    for (const auto& match : matches) finish(*match);
  }

  template <int Dim>
  std::unique_ptr<Match<Dim>> prepare(const std::string& group, const std::string& what,
                                      const Bed<Dim>& its_bed, const Plan& its_plan,
                                      double parameter) {
    auto match = std::make_unique<Match<Dim>>();
    match->bed = its_bed;
    match->plan = its_plan;
    const Bed<Dim>& bed = match->bed;
    const Plan& plan = match->plan;
    SceneSpeed& scene = match->scene;
    scene.group = group;
    scene.name = grouped(bed.count()) + " " + what;
    if (group != kSettledGroup && group != kGrowthGroup) {
      scene.name = what + " (" + grouped(bed.count()) + ")";
    }
    scene.dimension = Dim;
    scene.grains = bed.count();
    scene.steps = plan.steps;
    scene.time_step = bed.setting.time_step;
    scene.parameter = parameter;

    const auto add = [&]<class N>(const char* name, N neighbourhood) {
      auto& entry = match->entries.emplace_back();
      entry.name = name;
      entry.start = [&bed, &plan, neighbourhood](bool careful) {
        return std::make_unique<LagrainRun<Dim, N>>(bed, plan, neighbourhood, careful);
      };
    };
    doing_ = scene.name;
    add(kTriangulation, TriangulationNeighbourhood<Dim>{});
    if (plan.oracle) {
      add(kOracle, Oracle<Dim>(record_answers<Dim>(bed, plan.warm_up + plan.steps, checkpoint_)));
    }
    add(kCells, CellGrid<Dim>{});
    if (plan.rebuilt) add(kRebuilt, RebuiltTriangulation<Dim>{});
    if (lammps_ && plan.lammps) {
      const auto add_lammps = [&](const char* name, bool multi) {
        const fs::path folder =
            options_.out / "lammps" / folder_name(scene.name + (multi ? " multi" : ""));
        auto& entry = match->entries.emplace_back();
        entry.name = name;
        entry.start = [this, &bed, &plan, folder, multi](bool careful) {
          return std::make_unique<LammpsTurns<Dim>>(*lammps_, folder, bed, plan, multi, careful);
        };
      };
      if (plan.bin) add_lammps(kLammps, false);
      if (plan.multi) add_lammps(kLammpsMulti, true);
    }
    scene.contenders.resize(match->entries.size());
    return match;
  }

  /// A contender that fails leaves the others running; the triangulation must not fail.
  template <int Dim, class F>
  void unless_it_fails(Match<Dim>& match, std::size_t k, F&& f) {
    try {
      f();
    } catch (const SimulationError& error) {
      options_.check_stop();  // Ctrl-C reaches LAMMPS too
      if (k == 0) throw;
      auto& entry = match.entries[k];
      results_.notes.push_back(match.scene.name + ", " + entry.name + ": " + error.what());
      entry.out = true;
      entry.running = nullptr;
    }
  }

  /// Enters what a contender has done in a round.
  template <int Dim>
  void note(Match<Dim>& match, std::size_t k, bool careful, Sample<Dim> sample) {
    auto& entry = match.entries[k];
    Contender& contender = match.scene.contenders[k];
    if (entry.name == kOracle) forgive_neighbourhood(sample, match);
    contender.name = entry.name;
    contender.ns.push_back(1e9 * sample.cpu / grain_steps(match.bed, match.plan));
    entry.phases.push_back(sample.phases);
    if (!careful) return;
    contender.errors = sample.errors;
    entry.position = std::move(sample.position);
  }

  template <int Dim>
  void finish(Match<Dim>& match) {
    for (std::size_t k = 0; k < match.entries.size(); ++k) {
      Contender& contender = match.scene.contenders[k];
      for (std::size_t round = 0; round < contender.ns.size(); ++round) {
        if (contender.ns[round] == contender.median()) {
          contender.phases = match.entries[k].phases[round];
        }
      }
      if (contender.ns.empty()) continue;
      const Columns<Dim>& reference = match.entries.front().position;
      contender.errors.astray =
          (match.entries[k].position - reference).colwise().norm().maxCoeff() /
          smallest_radius(match.bed);
    }
    std::erase_if(match.scene.contenders, [](const Contender& c) { return c.ns.empty(); });
    results_.scenes.push_back(match.scene);
  }

  /// The oracle knows the contacts for nothing: what the run spends on asking it does not count.
  template <int Dim>
  static void forgive_neighbourhood(Sample<Dim>& sample, const Match<Dim>& match) {
    for (Phase& phase : sample.phases) {
      if (phase.name != "neighbourhood") continue;
      sample.cpu -= 1e-9 * phase.ns * grain_steps(match.bed, match.plan);
      phase.ns = 0;
    }
  }

  template <int Dim>
  static double smallest_radius(const Bed<Dim>& bed) {
    double smallest = bed.grains.front().radius;
    for (const Grain<Dim>& grain : bed.grains) smallest = std::min(smallest, grain.radius);
    return smallest;
  }

  const FigureOptions& options_;
  std::optional<fs::path> lammps_;
  std::function<void(const SpeedResults&)> after_scene_;
  Checkpoint checkpoint_;
  std::string doing_;
  double scenes_ = 1;
  double done_ = 0;
  SpeedResults results_;
  std::map<std::pair<int, double>, Bed<2>> disc_tiles_;
  std::map<std::pair<int, double>, Bed<3>> ball_tiles_;
};

}  // namespace

double Contender::median() const {
  return median_of(ns);
}

double Contender::spread() const {
  const auto [low, high] = std::minmax_element(ns.begin(), ns.end());
  return ns.empty() ? kUnknown : (*high - *low) / median();
}

double ratio(const Contender& a, const Contender& b) {
  std::vector<double> ratios;
  for (std::size_t round = 0; round < std::min(a.ns.size(), b.ns.size()); ++round) {
    ratios.push_back(a.ns[round] / b.ns[round]);
  }
  return ratios.empty() ? kUnknown : median_of(ratios);
}

const Contender* SceneSpeed::find(const std::string& wanted) const {
  for (const Contender& contender : contenders) {
    if (contender.name == wanted) return &contender;
  }
  return nullptr;
}

SpeedResults measure_speed(const FigureOptions& options, const std::optional<fs::path>& lammps,
                           const std::function<void(const SpeedResults&)>& after_scene) {
  return Harness(options, lammps, after_scene).run();
}

}  // namespace lagrain::bench
