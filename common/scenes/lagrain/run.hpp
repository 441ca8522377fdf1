// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// A simulation whose model was chosen at run time, by a scene.

#include <lagrain/any_neighbourhood.hpp>
#include <lagrain/audit.hpp>
#include <lagrain/contact_rules.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/placement.hpp>
#include <lagrain/plane_flow.hpp>
#include <lagrain/scene.hpp>
#include <lagrain/state.hpp>
#include <lagrain/time_step.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lagrain {

namespace detail {
template <int Dim>
class Traffic;
}

/// One contact, for output and pictures.
template <int Dim>
struct ContactRecord {
  int i = 0;                           ///< grain
  int j = -1;                          ///< grain, or -1 for a wall
  int wall = -1;                       ///< wall, or -1 for a grain
  double overlap = 0;                  ///< [m]
  Vec<Dim> normal = Vec<Dim>::Zero();  ///< from the partner to i [-]
  Vec<Dim> force = Vec<Dim>::Zero();   ///< on i [N]
};

/// Who has come and left since the start, one entry for each inlet and outlet of the scene.
struct TrafficCounts {
  static constexpr std::size_t kNamed = 5;  ///< of those lost, so many are named
  /// Of an inlet.
  struct In {
    std::int64_t grains = 0;   ///< that came
    std::int64_t waiting = 0;  ///< that were due when it was looked last, and found no room
    double longest_wait = 0;   ///< of a grain since it was due [s]
  };
  /// Of an outlet.
  struct Out {
    std::int64_t grains = 0;  ///< that left
    double mass = 0;          ///< of these [kg]
  };
  /// A grain that left the domain.
  struct Lost {
    int id = 0;       ///< of the grain
    double time = 0;  ///< when [s]
  };

  std::vector<In> inlets;        ///< in the scene's order
  std::vector<Out> outlets;      ///< in the scene's order
  std::int64_t lost = 0;         ///< that left the domain
  std::vector<Lost> first_lost;  ///< the first of these
};

/// What a model stores.
struct ModelSize {
  std::size_t per_grain = 0;        ///< bytes of state of a grain
  std::size_t per_near_pair = 0;    ///< bytes of a pair in the near list, memory included
  std::size_t spin_per_grain = 0;   ///< of the first: spin, torque, inertia
  std::size_t memory_per_pair = 0;  ///< of the second: memory
};

/// A simulation behind a plain interface: one virtual call per step, none within. The types
/// behind it are those that the scene names; make_run chooses them. Grains come and leave as the
/// scene's inlets, outlets and domain say; what is asked for is that of the N grains present.
template <int Dim>
class Run {
 public:
  virtual ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// So many time steps, each followed by the audit if the scene asks for it.
  /// @throws SimulationError if the physics went wrong
  void step(std::int64_t count = 1);
  /// Steps until `time() >= t`, to half a time step.
  /// @throws SimulationError
  void advance_to(double t);

  std::int64_t steps_planned() const { return steps_planned_; }  ///< the scene's duration in steps
  /// Whether all planned steps are made.
  bool finished() const { return steps() >= steps_planned_; }

  virtual std::int64_t steps() const = 0;              ///< made so far
  virtual double time() const = 0;                     ///< [s]
  virtual TimeScales time_scales() const = 0;          ///< of the scene at its start
  virtual const Columns<Dim>& positions() const = 0;   ///< Dim x N [m]
  virtual const Columns<Dim>& velocities() const = 0;  ///< Dim x N [m/s]
  /// N columns [rad/s]; null where nothing spins.
  virtual const Columns<kSpinDim<Dim>>* spins() const = 0;
  virtual const Eigen::VectorXd& radii() const = 0;   ///< N [m]
  virtual const Eigen::VectorXd& masses() const = 0;  ///< N [kg]
  /// What a grain keeps while others come and leave; empty while grain i has the id i.
  virtual const std::vector<int>& ids() const = 0;
  virtual const std::vector<Wall<Dim>>& walls() const = 0;       ///< as they are now
  virtual std::vector<ContactRecord<Dim>> contacts() const = 0;  ///< grains first, in order
  /// What the others exert on all driven grains together.
  virtual const DrivenLoad<Dim>& driven() const = 0;
  virtual ContactStatistics statistics() const = 0;                ///< of the contacts now
  virtual Ledger ledger() const = 0;                               ///< where the energy is now
  virtual std::vector<Pair> near_pairs() const = 0;                ///< sorted
  virtual std::vector<WallPair> near_wall_pairs() const = 0;       ///< sorted
  virtual std::int64_t refreshes() const = 0;                      ///< of the near list
  virtual const AnyNeighbourhood<Dim>& neighbourhood() const = 0;  ///< what proposes pairs
  /// Wall-clock time spent on knowing the near pairs [s].
  virtual double neighbourhood_seconds() const = 0;
  virtual ModelSize size() const = 0;  ///< of the model that was chosen

  /// Keeps all that the run needs to go on with the same bits, or restores it into a run that was
  /// made from the same scene.
  /// @throws SceneError if the state is not that of such a run, which is of no use then
  void persist(StateVisitor visit);

  /// Threads that share the steps from now on; results do not depend on it.
  /// @throws ContractError if there are none
  virtual void use_threads(int threads) = 0;

  int count() const { return static_cast<int>(radii().size()); }  ///< N
  /// The id of the grain in column i.
  int id(int i) const { return ids().empty() ? i : ids()[static_cast<std::size_t>(i)]; }
  /// Who has come and left; null where the scene says nothing of that.
  const TrafficCounts* traffic() const;
  /// What comes from the run that the scene starts from, in words; empty if nothing does.
  const std::string& origin() const { return origin_; }
  /// As it runs: the time step is in seconds.
  const Scene<Dim>& scene() const { return scene_; }
  double time_step() const { return scene_.time_step.seconds; }     ///< [s]
  const std::vector<int>& materials() const { return materials_; }  ///< N, of the scene's
  /// N: index into the scene's fills and then inlets; -1 for a grain placed by hand.
  const std::vector<int>& groups() const { return groups_; }
  const ContactRules& rules() const { return rules_; }            ///< who may touch whom
  const PinnedGrains& pinned() const { return rules_.pinned(); }  ///< what no force moves
  bool drives() const { return drives_; }                         ///< whether any grain is driven
  /// What has passed through the scene's planes since the start, one entry for each of them.
  std::vector<PlaneFlow<Dim>> flows() const;
  const Ledger& start() const { return start_; }                         ///< the ledger at time 0
  double energy_residual() const { return residual(ledger(), start_); }  ///< [J]
  const ContactAudit<Dim>& audit() const { return audit_; }  ///< what audits have found so far

 protected:
  Run(Scene<Dim> scene, Placement<Dim> placement);  ///< for make_run
  /// To be called at the end of the constructor.
  void started();

 private:
  virtual void advance(std::int64_t count) = 0;
  /// See GrainSystem::persist.
  virtual void persist_simulation(StateVisitor visit) = 0;
  /// See Simulation::exchange.
  virtual void exchange(const std::vector<int>& leavers,
                        const std::vector<Grain<Dim>>& newcomers) = 0;
  /// Whether the near list holds for the places as they are; between the stages of a step it may
  /// just have expired.
  virtual bool near_is_valid() const = 0;
  void check_contacts();
  void look_after_traffic();
  void look_at_planes(std::vector<PlaneFlow<Dim>>& flows) const;
  /// @param pinned  of each grain
  void set_rules(const std::vector<bool>& pinned);

  Scene<Dim> scene_;
  std::unique_ptr<detail::Traffic<Dim>> traffic_;  // null where nobody comes or leaves
  std::vector<int> materials_;
  std::vector<int> groups_;
  std::string origin_;
  ContactRules rules_;
  std::vector<PlaneFlow<Dim>> flows_;  // as they were looked at last
  bool drives_ = false;
  std::int64_t steps_planned_ = 0;
  Ledger start_;
  ContactAudit<Dim> audit_;
  std::int64_t refreshes_seen_ = 0;
};

/// Builds the simulation that a scene names: places the grains, chooses the types once, evaluates
/// the forces at time 0.
/// @param threads  at most so many share its steps; 0: all cores, if there are many grains
/// @param watch    the grains being placed
/// @throws SceneError if the grains do not fit or overlap, or the time step is not safe;
/// ContractError if a scene that no file was read for has a number that is NaN or out of range
template <int Dim>
std::unique_ptr<Run<Dim>> make_run(const Scene<Dim>& scene, int threads = 0,
                                   const PlacementWatch& watch = {});

/// The same on one thread with a neighbourhood of one's own in place of the one that it names.
template <int Dim>
std::unique_ptr<Run<Dim>> make_run(const Scene<Dim>& scene, AnyNeighbourhood<Dim> neighbourhood);

/// Threads worth starting for so many grains: one until a step is long against waking them up, then
/// all cores.
int threads_that_pay(std::int64_t grains);

/// What a run is made of and what it will cost, as text.
template <int Dim>
std::string explain(const Run<Dim>& run);

/// Name and value of what a careful person states beside a result: grains, steps, overlaps,
/// residuals, audit, cost of the neighbourhood.
template <int Dim>
std::vector<std::pair<std::string, std::string>> facts(const Run<Dim>& run);

}  // namespace lagrain
