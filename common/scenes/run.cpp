// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/run.hpp>

#include "simulation_run.hpp"
#include "traffic.hpp"

#include <lagrain/all_pairs.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/output.hpp>
#include <lagrain/overlap_estimate.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>
#include <lagrain/words.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <thread>
#include <variant>

namespace lagrain {

template <int Dim>
Run<Dim>::Run(Scene<Dim> scene, Placement<Dim> placement)
    : scene_(std::move(scene)),
      groups_(std::move(placement.group)),
      origin_(std::move(placement.origin)) {
  std::vector<bool> pinned;
  for (const Grain<Dim>& grain : placement.grains) {
    materials_.push_back(grain.material);
    pinned.push_back(grain.held());
    drives_ = drives_ || grain.driven;
  }
  set_rules(pinned);
  for (const MeasuredPlane<Dim>& plane : scene_.planes) {
    std::optional<typename PlaneFlow<Dim>::Box> within;
    if (plane.region) within.emplace(plane.region->low, plane.region->high);
    flows_.emplace_back(plane.point, plane.normal, within);
  }
  if (!scene_.inlets.empty() || !scene_.outlets.empty() || scene_.domain) {
    traffic_ = std::make_unique<detail::Traffic<Dim>>(scene_);
  }
  // A duration of whole steps must not gain one by rounding.
  steps_planned_ = static_cast<std::int64_t>(
      std::ceil(scene_.duration / scene_.time_step.seconds * (1 - 1e-12)));
}

template <int Dim>
Run<Dim>::~Run() = default;

template <int Dim>
const TrafficCounts* Run<Dim>::traffic() const {
  return traffic_ ? &traffic_->counts() : nullptr;
}

template <int Dim>
void Run<Dim>::started() {
  start_ = ledger();
  if (traffic_) traffic_->remember(*this);
  look_at_planes(flows_);
  if (scene_.audit) check_contacts();
}

template <int Dim>
void Run<Dim>::persist(StateVisitor visit) {
  persist_simulation(visit);
  visit("materials", materials_);
  visit("groups", groups_);
  std::vector<bool> held(groups_.size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = pinned()[static_cast<int>(i)];
  visit("held", held);
  for (std::size_t k = 0; k < flows_.size(); ++k) {
    flows_[k].persist(visit.in("planes").in(std::to_string(k)));
  }
  start_.persist(visit.in("start"));
  audit_.persist(visit.in("audit"));
  if (traffic_) traffic_->persist(visit.in("traffic"), count());
  if (!visit.restores()) return;
  const auto n = static_cast<std::size_t>(count());
  const auto within = [](const std::vector<int>& list, int least, std::size_t end) {
    return std::all_of(list.begin(), list.end(),
                       [&](int k) { return k >= least && k < static_cast<int>(end); });
  };
  if (materials_.size() != n || groups_.size() != n || held.size() != n ||
      !within(materials_, 0, scene_.materials.size()) ||
      !within(groups_, -1, scene_.fills.size() + scene_.inlets.size())) {
    throw SceneError("its grains do not fit together");
  }
  set_rules(held);
}

template <int Dim>
void Run<Dim>::step(std::int64_t count) {
  constexpr int kLook = detail::Traffic<Dim>::kStepsBetweenLooks;
  // Ways count as straight from look to look. By default so many steps are less than half of a
  // contact, so that no grain turns back twice. It was not tuned: a look reads all grains once, so
  // at half of the number it costs twice as much, and the rim of a region is a little sharper.
  constexpr int kPlaneLook = 10;
  static_assert(kLook % kPlaneLook == 0);  // who leaves has just been looked at
  while (count > 0) {
    std::int64_t at_once = scene_.audit ? 1 : count;
    if (traffic_) at_once = std::min(at_once, kLook - steps() % kLook);
    if (!flows_.empty()) at_once = std::min(at_once, kPlaneLook - steps() % kPlaneLook);
    advance(at_once);
    count -= at_once;
    if (steps() % kPlaneLook == 0) look_at_planes(flows_);
    if (traffic_ && steps() % kLook == 0) look_after_traffic();
    if (scene_.audit) check_contacts();
  }
}

template <int Dim>
std::vector<PlaneFlow<Dim>> Run<Dim>::flows() const {
  std::vector<PlaneFlow<Dim>> now = flows_;
  look_at_planes(now);
  return now;
}

template <int Dim>
void Run<Dim>::look_at_planes(std::vector<PlaneFlow<Dim>>& flows) const {
  for (PlaneFlow<Dim>& flow : flows) flow.look(ids(), positions(), masses());
}

template <int Dim>
void Run<Dim>::set_rules(const std::vector<bool>& pinned) {
  rules_ =
      ContactRules(PinnedGrains(static_cast<int>(pinned.size()),
                                [&](int i) { return pinned[static_cast<std::size_t>(i)] ? 0 : 1; }),
                   std::vector<std::uint8_t>(materials_.begin(), materials_.end()), scene_.apart());
}

template <int Dim>
void Run<Dim>::look_after_traffic() {
  const auto change = traffic_->look(*this);
  if (change.leavers.empty() && change.newcomers.empty()) {
    traffic_->remember(*this);
    return;
  }
  exchange(change.leavers, change.newcomers);
  std::vector<bool> pinned;
  auto leaver = change.leavers.begin();
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    if (leaver != change.leavers.end() && static_cast<std::size_t>(*leaver) == i) {
      ++leaver;
      continue;
    }
    const std::size_t now = pinned.size();
    materials_[now] = materials_[i];
    groups_[now] = groups_[i];
    pinned.push_back(rules_.pinned()[static_cast<int>(i)]);
  }
  materials_.resize(pinned.size());
  groups_.resize(pinned.size());
  for (const Grain<Dim>& grain : change.newcomers) {
    materials_.push_back(grain.material);
    pinned.push_back(grain.held());
  }
  groups_.insert(groups_.end(), change.groups.begin(), change.groups.end());
  set_rules(pinned);
  traffic_->remember(*this);
  look_at_planes(flows_);
}

template <int Dim>
void Run<Dim>::advance_to(double t) {
  const double end = t - 0.5 * time_step();
  while (time() < end)
    step(std::max<std::int64_t>(1, static_cast<std::int64_t>((end - time()) / time_step())));
}

template <int Dim>
void Run<Dim>::check_contacts() {
  const bool listed_anew = refreshes() != refreshes_seen_;
  refreshes_seen_ = refreshes();
  constexpr int kEveryStepLimit = 1000;
  const bool due = count() <= kEveryStepLimit || listed_anew || steps() % scene_.audit_every == 0;
  // A fourth-order step ends with a drift after its last forces: a list that expired there is
  // renewed before anybody reads it.
  if (!due || !near_is_valid()) return;
  audit_.check(positions(), radii(), near_pairs(), rules_);
  audit_.check_walls(positions(), radii(), walls(), near_wall_pairs(), rules_);
}

namespace {

template <int Dim>
std::unique_ptr<Run<Dim>> make_run(const Scene<Dim>& scene, AnyNeighbourhood<Dim> neighbourhood,
                                   const PlacementWatch& watch) {
  Placement<Dim> placement = place_grains(scene, watch);
  detail::expect_in_domain(scene, placement);
  switch (scene.friction) {
#define LAGRAIN_CASE(word, Friction)                                         \
  case FrictionModel::word:                                                  \
    return detail::make_run_with<Dim, Friction>(scene, std::move(placement), \
                                                std::move(neighbourhood));
    LAGRAIN_FRICTION_LAWS(LAGRAIN_CASE)
#undef LAGRAIN_CASE
  }
  throw ContractError("a scene names no friction law");
}

template <int Dim>
AnyNeighbourhood<Dim> neighbourhood_of(const Scene<Dim>& scene) {
  switch (scene.neighbourhood) {
    case NeighbourhoodModel::all_pairs:
      return AnyNeighbourhood<Dim>(AllPairs<Dim>{});
    case NeighbourhoodModel::linked_cells:
      return AnyNeighbourhood<Dim>(CellGrid<Dim>{});
    case NeighbourhoodModel::triangulation:
      break;
  }
  return AnyNeighbourhood<Dim>(TriangulationNeighbourhood<Dim>{});
}

}  // namespace

template <int Dim>
std::unique_ptr<Run<Dim>> make_run(const Scene<Dim>& scene, AnyNeighbourhood<Dim> neighbourhood) {
  return make_run(scene, std::move(neighbourhood), PlacementWatch{});
}

template <int Dim>
std::unique_ptr<Run<Dim>> make_run(const Scene<Dim>& scene, int threads,
                                   const PlacementWatch& watch) {
  auto run = make_run(scene, neighbourhood_of(scene), watch);
  std::int64_t most = run->count();
  for (const Inlet<Dim>& inlet : scene.inlets) most += detail::due(inlet, scene.duration);
  run->use_threads(threads > 0 ? threads : threads_that_pay(most));
  return run;
}

int threads_that_pay(std::int64_t grains) {
  constexpr int kWorthWhile = 10000;
  if (grains < kWorthWhile) return 1;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace {

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}
std::string right(const std::string& text, std::size_t width) {
  return std::string(text.size() < width ? width - text.size() : 0, ' ') + text;
}

template <int Dim, class Law>
std::string size_row(const char* friction, bool chosen) {
  const std::size_t grain = bytes_per_grain<Dim, Law::needs>();
  const std::size_t spin = grain - bytes_per_grain<Dim, Needs{}>();
  const std::size_t memory = Law::template Memory<Dim>::kReals * sizeof(double);
  return (chosen ? "  > " : "    ") + padded(friction, 10) + right(std::to_string(grain), 8) +
         right(std::to_string(spin), 10) + right(std::to_string(sizeof(Pair) + memory), 12) +
         right(std::to_string(memory), 12) + "\n";
}

}  // namespace

template <int Dim>
std::string explain(const Run<Dim>& run) {
  const Scene<Dim>& scene = run.scene();
  std::string out;
  const auto line = [&](const std::string& name, const std::string& value) {
    out += padded(name, 16) + value + "\n";
  };
  const TimeScales scales = run.time_scales();
  line("title", readable(scene.title));
  line("dimension", std::to_string(Dim));
  line("contact law", std::string(description_of(scene.normal).in_words) + ", " +
                          std::string(description_of(scene.friction).in_words));
  line("integrator", std::string(name_of(scene.integrator)));
  line("neighbourhood", std::string(name_of(scene.neighbourhood)));
  if (!is_steady(scene.gravity_course)) line("gravity", "changes in time");
  if (scene.drag) line("drag", "linear in the velocity");
  if (!run.origin().empty()) line("start", run.origin());
  line("grains", std::to_string(run.count()) + (run.drives() ? ", some of them driven" : ""));
  line("walls", std::to_string(run.walls().size()));
  for (const Inlet<Dim>& inlet : scene.inlets) {
    line("inlet", "\"" + inlet.name + "\", " + shortest(inlet.rate) + " grains a second, " +
                      std::to_string(detail::due(inlet, scene.duration)) + " in all");
  }
  for (const Outlet<Dim>& outlet : scene.outlets) line("outlet", "\"" + outlet.name + "\"");
  for (const PairLaw& pair : scene.pairs) {
    if (pair.touch) continue;
    line("no contacts", "between \"" + scene.materials[static_cast<std::size_t>(pair.a)].name +
                            "\" and \"" + scene.materials[static_cast<std::size_t>(pair.b)].name +
                            "\"");
  }
  for (const Wall<Dim>& wall : run.walls()) {
    const auto* piston = std::get_if<Piston<Dim>>(&wall.motion);
    if (!piston || !piston->pressure) continue;
    const double area = area_of(*piston->pressure, run.walls());
    line("piston", "\"" + wall.name + "\" holds " + shortest(piston->pressure->value) +
                       " Pa, at the start on " + rounded(area) + " m^2");
  }
  for (const MeasuredPlane<Dim>& plane : scene.planes) {
    line("flow", "through plane \"" + plane.name + "\"");
  }
  if (std::isfinite(scales.contact)) {
    line("contact time", rounded(scales.contact) + " s (the shortest)");
    line("time step", rounded(run.time_step()) + " s (1/" +
                          rounded(scales.contact / run.time_step()) + " contact)");
    line("safe step", rounded(scales.safe_step) + " s (the largest allowed)");
  } else {
    line("contact time", "none: " + detail::why_no_contact(scene));
    line("time step", rounded(run.time_step()) + " s");
  }
  const OverlapEstimate guess = estimate_overlap(run);
  if (guess.stiffness > 0) {
    const auto percent = [](double overlap) { return rounded(100 * overlap) + " %"; };
    const LawKey& stiffness = description_of(scene.normal).keys[0];
    const bool walls_move = std::any_of(run.walls().begin(), run.walls().end(),
                                        [](const Wall<Dim>& wall) { return wall.moves(); });
    line("overlap", "about " + percent(guess.overlap()) +
                        " of the smaller radius, to a factor of 2" +
                        (walls_move ? ", walls that move left out" : ""));
    line("  of weight", percent(guess.overlap_of_load) + ", the heaviest column presses with " +
                            rounded(guess.load) + " N");
    line("  of impact", percent(guess.overlap_of_impact) + ", the deepest one at " +
                            rounded(guess.speed) + " m/s");
    line("for " + percent(kSoundOverlap), std::string(stiffness.name) + " = \"" +
                                              rounded(guess.stiffness) + " " +
                                              std::string(stiffness.unit) + "\"");
  } else {
    line("overlap", "none to be guessed: at the start nothing moves or weighs");
  }
  line("steps", std::to_string(run.steps_planned()) + " for " + rounded(scene.duration) + " s");
  const OutputEstimate output = estimate_output(run);
  line("output", "about " + rounded(output.bytes / 1e6, 2) + " MB: " + rounded(output.frames, 9) +
                     " frames of " + rounded(output.bytes_per_frame / 1e6, 2) + " MB");
  const ModelSize size = run.size();
  const auto bytes = [&](std::size_t whole, std::size_t part, const char* what) {
    return std::to_string(whole) +
           (part > 0 ? ", " + std::to_string(part) + " of them for " + what : "");
  };
  line("bytes per grain", bytes(size.per_grain, size.spin_per_grain, "spin"));
  line("bytes per pair", bytes(size.per_near_pair, size.memory_per_pair, "memory"));
  out += "\nwhat friction costs [bytes]\n";
  out += "    friction     grain   of spin  near pair   of memory\n";
#define LAGRAIN_SIZE_ROW(word, Friction) \
  out += size_row<Dim, Friction<LinearSpring>>(#word, scene.friction == FrictionModel::word);
  LAGRAIN_FRICTION_LAWS(LAGRAIN_SIZE_ROW)
#undef LAGRAIN_SIZE_ROW
  return out;
}

namespace {

/// Grains that are below all that could stop them: sheets however they are turned, held grains, and
/// outlets. A plane that is not upright, or a round container that is not, is below everything.
template <int Dim>
std::int64_t falling_for_ever(const Run<Dim>& run) {
  const Scene<Dim>& scene = run.scene();
  const Vec<Dim> gravity = gravity_at(scene.gravity_course, scene.gravity, run.time());
  if (scene.domain || gravity.isZero(0)) return 0;
  const Vec<Dim> down = gravity.normalized();
  constexpr double kUpright = 1e-9;                       // of a unit vector, by rounding
  double end = -std::numeric_limits<double>::infinity();  // of all that, along `down` [m]
  for (const Wall<Dim>& wall : run.walls()) {
    if (wall.gone) continue;
    if (const Sheet<Dim>* sheet = wall.pieces()) {
      end = std::max(end, wall.point.dot(down) + sheet->extent());
    } else if (const auto* plane = std::get_if<HalfSpace<Dim>>(&wall.shape)) {
      if (plane->normal.dot(down) < -kUpright) return 0;
    } else if (const auto& axis = std::get<Cylinder<Dim>>(wall.shape).axis;
               std::abs(axis.dot(down)) < 1 - kUpright) {
      return 0;
    }
  }
  for (const Outlet<Dim>& outlet : scene.outlets) {
    end = std::max(
        end,
        outlet.region.low.cwiseProduct(down).cwiseMax(outlet.region.high.cwiseProduct(down)).sum());
  }
  const auto depth = [&](int i) { return run.positions().col(i).dot(down); };
  for (int i = 0; i < run.count(); ++i) {
    if (run.pinned()[i]) end = std::max(end, depth(i) + run.radii()[i]);
  }
  // Where nothing could stop anything, falling is what the scene is about.
  if (!std::isfinite(end)) return 0;
  std::int64_t count = 0;
  for (int i = 0; i < run.count(); ++i) {
    count += !run.pinned()[i] && depth(i) - run.radii()[i] > end ? 1 : 0;
  }
  return count;
}

}  // namespace

template <int Dim>
std::vector<std::pair<std::string, std::string>> facts(const Run<Dim>& run) {
  std::vector<std::pair<std::string, std::string>> list;
  const auto fact = [&](const char* name, std::string value) {
    list.emplace_back(name, std::move(value));
  };
  const auto s = run.statistics();
  const Ledger now = run.ledger();
  if (!run.origin().empty()) fact("start", run.origin());
  fact("grains", std::to_string(run.count()));
  fact("steps", std::to_string(run.steps()));
  fact("time", rounded(run.time(), 6) + " s");
  const double contact = run.time_scales().contact;
  fact("time step", rounded(run.time_step()) + " s" +
                        (std::isfinite(contact) ? ", 1/" + rounded(contact / run.time_step()) +
                                                      " of the shortest contact"
                                                : std::string()));
  if (const std::int64_t falling = falling_for_ever(run); falling > 0) {
    fact("fall for ever", std::to_string(falling) +
                              " grains are below all walls and count in energies and means; a "
                              "[domain] takes out such grains");
  }
  fact("contacts", std::to_string(s.contacts) + " between grains, " +
                       std::to_string(s.wall_contacts) + " with walls");
  fact("coordination", rounded(s.coordination));
  fact("mean overlap", rounded(100 * s.mean_overlap) + " % of the smaller radius");
  fact("largest overlap", rounded(100 * s.largest_overlap) + " % of the smaller radius");
  fact("kinetic energy", rounded(now.kinetic) + " J");
  fact("energy residual", rounded(residual(now, run.start())) + " J");
  if (!is_steady(run.scene().gravity_course)) {
    fact("work of gravity", rounded(now.gravity_work) + " J, by whoever changes it");
  }
  if (run.scene().drag) fact("work of the drag", rounded(now.force_work) + " J");
  if (run.drives()) fact("work of driven grains", rounded(now.driven_work) + " J");
  if (run.traffic() != nullptr) {
    fact("energy carried", rounded(now.carried) + " J, in with grains less out with grains");
    const TrafficCounts& traffic = *run.traffic();
    for (std::size_t k = 0; k < traffic.inlets.size(); ++k) {
      const TrafficCounts::In& in = traffic.inlets[k];
      fact("inlet", "\"" + run.scene().inlets[k].name + "\": " + std::to_string(in.grains) +
                        " grains came, " + std::to_string(in.waiting) +
                        " wait for room, the longest wait was " + rounded(in.longest_wait) + " s");
    }
    for (std::size_t k = 0; k < traffic.outlets.size(); ++k) {
      const TrafficCounts::Out& out = traffic.outlets[k];
      fact("outlet", "\"" + run.scene().outlets[k].name + "\": " + std::to_string(out.grains) +
                         " grains left, " + rounded(out.mass) + " kg");
    }
    if (run.scene().domain) {
      std::string lost = std::to_string(traffic.lost) + " grains";
      for (const TrafficCounts::Lost& grain : traffic.first_lost) {
        lost += (&grain == traffic.first_lost.data() ? ": " : ", ") + std::to_string(grain.id) +
                " at " + rounded(grain.time, 4) + " s";
      }
      if (traffic.lost > static_cast<std::int64_t>(traffic.first_lost.size())) lost += ", ...";
      fact("left the domain", lost);
    }
  }
  const auto flows = run.flows();
  for (std::size_t k = 0; k < flows.size(); ++k) {
    fact("flow", "\"" + run.scene().planes[k].name + "\": " + std::to_string(flows[k].grains()) +
                     " grains passed, " + rounded(flows[k].mass()) + " kg");
  }
  fact("contacts audited", run.scene().audit ? std::to_string(run.audit().contacts()) + " in " +
                                                   std::to_string(run.audit().checks()) + " checks"
                                             : std::string("none"));
  if (run.scene().audit) fact("contacts missed", std::to_string(run.audit().missed()));
  fact("near list", std::to_string(run.near_pairs().size()) + " pairs, " +
                        std::to_string(run.refreshes()) + " refreshes");
  const auto per_contact = [&](std::int64_t pairs) {
    return rounded(static_cast<double>(pairs) / static_cast<double>(s.contacts));
  };
  if (s.contacts > 0) {
    fact("near pairs per contact", per_contact(static_cast<std::int64_t>(run.near_pairs().size())));
  }
  fact("neighbourhood", run.neighbourhood().name());
  if (const TriangulationCost* cost = run.neighbourhood().cost()) {
    const std::int64_t edges = run.neighbourhood().edges();
    fact("edges", std::to_string(edges));
    if (s.contacts > 0) fact("edges per contact", per_contact(edges));
    fact("triangulation updates", std::to_string(cost->updates) + ", " +
                                      std::to_string(cost->moved) + " grains moved, " +
                                      std::to_string(cost->ladder.flips) + " flips");
    fact("leaps", std::to_string(cost->leaps) + " builds with wide skins, left by " +
                      std::to_string(cost->walks) + " grains");
    fact("repairs", std::to_string(cost->ladder.extracted) + " grains taken out, " +
                        std::to_string(cost->ladder.unstuck) +
                        (Dim == 2 ? " more where flips stuck, " : " cavities filled anew, ") +
                        std::to_string(cost->ladder.reinserted) + " put back, " +
                        std::to_string(cost->ladder.rebuilds) + " rebuilds, " +
                        std::to_string(cost->searched) + " range searches");
  }
  return list;
}

template class Run<2>;
template class Run<3>;
template std::unique_ptr<Run<2>> make_run<2>(const Scene<2>&, AnyNeighbourhood<2>);
template std::unique_ptr<Run<3>> make_run<3>(const Scene<3>&, AnyNeighbourhood<3>);
template std::unique_ptr<Run<2>> make_run<2>(const Scene<2>&, int, const PlacementWatch&);
template std::unique_ptr<Run<3>> make_run<3>(const Scene<3>&, int, const PlacementWatch&);
template std::string explain<2>(const Run<2>&);
template std::string explain<3>(const Run<3>&);
template std::vector<std::pair<std::string, std::string>> facts<2>(const Run<2>&);
template std::vector<std::pair<std::string, std::string>> facts<3>(const Run<3>&);

}  // namespace lagrain
