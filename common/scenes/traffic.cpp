// SPDX-License-Identifier: GPL-3.0-or-later
#include "traffic.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace lagrain::detail {

namespace {

/// Places tried for one grain in a look. Few more would be found in twice as many: a grain that
/// finds none waits for the next look.
constexpr int kTries = 100;

/// Whether a straight way is known to meet a region: one with an end that is not a number is not.
template <int Dim>
bool meets(const Region<Dim>& region, const Vec<Dim>& from, const Vec<Dim>& to) {
  if (!(to - from).allFinite()) return false;
  double first = 0, last = 1;  // the part of the way that lies in it, direction by direction
  for (int d = 0; d < Dim; ++d) {
    const double way = to[d] - from[d];
    if (way == 0) {
      if (!(from[d] >= region.low[d] && from[d] <= region.high[d])) return false;
      continue;
    }
    const double a = (region.low[d] - from[d]) / way, b = (region.high[d] - from[d]) / way;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

template <int Dim>
bool inside(const Region<Dim>& region, const Vec<Dim>& x) {
  return (x.array() >= region.low.array()).all() && (x.array() <= region.high.array()).all();
}

/// Whether a place is known to be outside: one that is not a number is not.
template <int Dim>
bool outside(const Region<Dim>& region, const Vec<Dim>& x) {
  return (x.array() < region.low.array()).any() || (x.array() > region.high.array()).any();
}

}  // namespace

template <int Dim>
Traffic<Dim>::Traffic(const Scene<Dim>& scene) : scene_(scene) {
  counts_.inlets.resize(scene.inlets.size());
  counts_.outlets.resize(scene.outlets.size());
  for (std::size_t k = 0; k < scene.inlets.size(); ++k) {
    // Each inlet has numbers of its own, which are not those of a fill.
    sources_.push_back({Random(scene.seed + 0xD1B54A32D192ED03ULL * (k + 1)),
                        RadiusDraw<Dim>(scene.inlets[k].radius),
                        {}});
  }
}

template <int Dim>
typename Traffic<Dim>::Change Traffic<Dim>::look(const Run<Dim>& run) {
  Change change;
  for (int i = 0; i < run.count(); ++i) {
    if (leaves(run, i)) change.leavers.push_back(i);
  }
  for (std::size_t k = 0; k < sources_.size(); ++k) let_in(run, k, change);
  return change;
}

template <int Dim>
void Traffic<Dim>::persist(StateVisitor visit, int grains) {
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    StateVisitor inlet = visit.in("inlets").in(std::to_string(k));
    Source& source = sources_[k];
    source.random.persist(inlet);
    double next_radius = source.next_radius.value_or(0);
    inlet("next_radius", next_radius);
    source.next_radius = next_radius > 0 ? std::optional(next_radius) : std::nullopt;
    inlet("grains", counts_.inlets[k].grains);
    inlet("waiting", counts_.inlets[k].waiting);
    inlet("longest_wait", counts_.inlets[k].longest_wait);
  }
  for (std::size_t k = 0; k < counts_.outlets.size(); ++k) {
    StateVisitor outlet = visit.in("outlets").in(std::to_string(k));
    outlet("grains", counts_.outlets[k].grains);
    outlet("mass", counts_.outlets[k].mass);
  }
  visit("lost", counts_.lost);
  std::vector<int> ids;
  std::vector<double> times;
  for (const TrafficCounts::Lost& lost : counts_.first_lost) {
    ids.push_back(lost.id);
    times.push_back(lost.time);
  }
  visit("lost_ids", ids);
  visit("lost_times", times);
  if (ids.size() != times.size()) throw SceneError("its lost grains do not fit together");
  counts_.first_lost.clear();
  for (std::size_t k = 0; k < ids.size(); ++k) counts_.first_lost.push_back({ids[k], times[k]});
  visit("before", before_);
  if (visit.restores() && before_.cols() != grains)
    throw SceneError("what it knows of its grains does not fit them");
}

template <int Dim>
void Traffic<Dim>::remember(const Run<Dim>& run) {
  before_ = run.positions();
}

template <int Dim>
bool Traffic<Dim>::leaves(const Run<Dim>& run, int number) {
  if (run.pinned()[number]) return false;
  const Vec<Dim> x = run.positions().col(number);
  for (std::size_t k = 0; k < scene_.outlets.size(); ++k) {
    const Region<Dim>& region = scene_.outlets[k].region;
    if (!inside(region, x) && !meets<Dim>(region, before_.col(number), x)) continue;
    ++counts_.outlets[k].grains;
    counts_.outlets[k].mass += run.masses()[number];
    return true;
  }
  if (!scene_.domain || !outside(*scene_.domain, x)) return false;
  ++counts_.lost;
  if (counts_.first_lost.size() < TrafficCounts::kNamed) {
    counts_.first_lost.push_back({run.id(number), run.time()});
  }
  return true;
}

/// Lets in those of an inlet's grains that are due and find room.
template <int Dim>
void Traffic<Dim>::let_in(const Run<Dim>& run, std::size_t k, Change& change) {
  const Inlet<Dim>& inlet = scene_.inlets[k];
  Source& source = sources_[k];
  TrafficCounts::In& count = counts_.inlets[k];
  count.waiting = due(inlet, run.time()) - count.grains;
  if (count.waiting == 0) return;

  struct Ball {
    Vec<Dim> x;
    double r;
  };
  std::vector<Ball> taken;
  const auto take_if_near = [&](const Vec<Dim>& x, double r) {
    const bool near =
        ((x - inlet.region.low).array() > -r).all() && ((inlet.region.high - x).array() > -r).all();
    if (near) taken.push_back({x, r});
  };
  auto leaver = change.leavers.begin();
  for (int i = 0; i < run.count(); ++i) {
    if (leaver != change.leavers.end() && *leaver == i) {
      ++leaver;
      continue;
    }
    take_if_near(run.positions().col(i), run.radii()[i]);
  }
  for (const Grain<Dim>& grain : change.newcomers) take_if_near(grain.position, grain.radius);

  const auto free_place = [&](double r) -> std::optional<Vec<Dim>> {
    for (int attempt = 0; attempt < kTries; ++attempt) {
      Vec<Dim> x;
      for (int d = 0; d < Dim; ++d) {
        x[d] = source.random.uniform(inlet.region.low[d] + r, inlet.region.high[d] - r);
      }
      const auto apart = [&](const Ball& other) {
        return (x - other.x).squaredNorm() >= (r + other.r) * (r + other.r);
      };
      if (clear_of_walls(run.walls(), x, r) && std::all_of(taken.begin(), taken.end(), apart)) {
        return x;
      }
    }
    return {};
  };
  for (; count.waiting > 0; --count.waiting, ++count.grains) {
    if (!source.next_radius) source.next_radius = source.draw(source.random);
    const double due_since = inlet.start + static_cast<double>(count.grains + 1) / inlet.rate;
    count.longest_wait = std::max(count.longest_wait, run.time() - due_since);
    const double r = *source.next_radius;
    const auto x = free_place(r);
    if (!x) break;
    source.next_radius.reset();
    change.newcomers.push_back(grain_from(scene_, inlet, r, *x, source.random));
    change.groups.push_back(static_cast<int>(scene_.fills.size() + k));
    taken.push_back({*x, r});
  }
}

template <int Dim>
std::int64_t due(const Inlet<Dim>& inlet, double t) {
  const double since = std::min(t, inlet.stop) - inlet.start;
  if (!(since > 0)) return 0;
  // A whole number must not lose one by rounding.
  const auto number = static_cast<std::int64_t>(inlet.rate * since * (1 + 1e-12));
  return inlet.count ? std::min<std::int64_t>(number, *inlet.count) : number;
}

template <int Dim>
void expect_in_domain(const Scene<Dim>& scene, const Placement<Dim>& placement) {
  if (!scene.domain) return;
  for (std::size_t i = 0; i < placement.grains.size(); ++i) {
    if (!outside(*scene.domain, placement.grains[i].position)) continue;
    throw scene.error("domain", "grain " + std::to_string(i) + " lies outside of it at the start");
  }
}

template class Traffic<2>;
template class Traffic<3>;
template std::int64_t due<2>(const Inlet<2>&, double);
template std::int64_t due<3>(const Inlet<3>&, double);
template void expect_in_domain<2>(const Scene<2>&, const Placement<2>&);
template void expect_in_domain<3>(const Scene<3>&, const Placement<3>&);

}  // namespace lagrain::detail
