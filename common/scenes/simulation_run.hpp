// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Private to the sources of runs: the one implementation of Run, templated on the model.

#include "placing.hpp"

#include <lagrain/compiled_kernels.hpp>
#include <lagrain/contact_laws.hpp>
#include <lagrain/integrator.hpp>
#include <lagrain/numbers.hpp>
#include <lagrain/run.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/words.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lagrain::detail {

template <int Dim, class Law, class Motion>
class SimulationRun final : public Run<Dim> {
 public:
  using Sim = Simulation<Dim, Law, Motion, AnyNeighbourhood<Dim>>;

  SimulationRun(Scene<Dim> scene, Placement<Dim> placement, Grains<Dim, Law::needs> grains,
                LawTable<Law> laws, std::vector<Wall<Dim>> walls, const RecalledContacts& recalled,
                TimeScales scales, AnyNeighbourhood<Dim> neighbourhood)
      : Run<Dim>(scene, std::move(placement)),
        scales_(scales),
        sim_(std::move(grains), std::move(laws), std::move(walls),
             {.gravity = scene.gravity,
              .time_step = scene.time_step.seconds,
              .largest_overlap = scene.largest_overlap,
              .gravity_course = scene.gravity_course},
             std::move(neighbourhood)) {
    // The reader has refused drag for integrators of conservative scenes.
    if (scene.drag) sim_.add_force("drag", *scene.drag);
    recall(recalled);
    this->started();
  }

  std::int64_t steps() const override { return sim_.steps(); }
  double time() const override { return sim_.time(); }
  TimeScales time_scales() const override { return scales_; }
  const Columns<Dim>& positions() const override { return sim_.grains().position; }
  const Columns<Dim>& velocities() const override { return sim_.grains().velocity; }
  const Columns<kSpinDim<Dim>>* spins() const override {
    if constexpr (Law::needs.spin) return &sim_.grains().omega;
    return nullptr;
  }
  const Eigen::VectorXd& radii() const override { return sim_.radii(); }
  const Eigen::VectorXd& masses() const override { return sim_.masses(); }
  const std::vector<int>& ids() const override { return sim_.ids(); }
  const std::vector<Wall<Dim>>& walls() const override { return sim_.walls(); }
  const DrivenLoad<Dim>& driven() const override { return sim_.driven(); }
  ContactStatistics statistics() const override { return contact_statistics(sim_); }
  Ledger ledger() const override { return energy_ledger(sim_); }
  std::vector<Pair> near_pairs() const override { return sim_.near_pairs(); }
  std::vector<WallPair> near_wall_pairs() const override { return sim_.near_wall_pairs(); }
  std::int64_t refreshes() const override { return sim_.refreshes(); }
  const AnyNeighbourhood<Dim>& neighbourhood() const override { return sim_.neighbourhood(); }
  double neighbourhood_seconds() const override { return sim_.neighbourhood_seconds(); }

  std::vector<ContactRecord<Dim>> contacts() const override {
    std::vector<ContactRecord<Dim>> list;
    sim_.for_each_contact([&](Pair pair, const Touch<Dim>& touch, const Response<Dim>& response,
                              const auto&) {
      ContactRecord<Dim> record{pair.i, pair.j, -1, touch.overlap, touch.normal, response.force};
      if (record.i > record.j) {
        std::swap(record.i, record.j);
        record.normal = -record.normal;
        record.force = -record.force;
      }
      list.push_back(record);
    });
    const auto grains = static_cast<std::ptrdiff_t>(list.size());
    sim_.for_each_wall_contact(
        [&](WallPair pair, const Touch<Dim>& touch, const Response<Dim>& response, const auto&) {
          list.push_back({pair.i, -1, pair.wall, touch.overlap, touch.normal, response.force});
        });
    std::sort(list.begin(), list.begin() + grains, [](const auto& a, const auto& b) {
      return std::pair(a.i, a.j) < std::pair(b.i, b.j);
    });
    std::sort(list.begin() + grains, list.end(), [](const auto& a, const auto& b) {
      return std::pair(a.wall, a.i) < std::pair(b.wall, b.i);
    });
    return list;
  }

  void use_threads(int threads) override { sim_.use_threads(threads); }

  ModelSize size() const override {
    ModelSize s;
    s.per_grain = bytes_per_grain<Dim, Law::needs>();
    s.spin_per_grain = s.per_grain - bytes_per_grain<Dim, Needs{}>();
    s.memory_per_pair = Sim::Memory::kReals * sizeof(double);
    s.per_near_pair = sizeof(Pair) + s.memory_per_pair;
    return s;
  }

 private:
  void advance(std::int64_t count) override { sim_.step(count); }
  void persist_simulation(StateVisitor visit) override { sim_.persist(visit); }
  void exchange(const std::vector<int>& leavers,
                const std::vector<Grain<Dim>>& newcomers) override {
    sim_.exchange(leavers, make_grains<Dim, Law::needs>(newcomers));
  }
  bool near_is_valid() const override { return sim_.near_list_holds(); }

  void recall(const RecalledContacts& recalled) {
    if constexpr (Sim::Memory::kReals > 0) {
      if (recalled.pairs.empty() && recalled.at_walls.empty()) return;
      const auto entries = []<class P>(const std::vector<P>& pairs,
                                       const Eigen::MatrixXd& numbers) {
        std::vector<std::pair<P, typename Sim::Memory>> list;
        for (std::size_t k = 0; k < pairs.size(); ++k) {
          typename Sim::Memory memory;
          for (int r = 0; r < Sim::Memory::kReals; ++r) {
            memory[r] = numbers(r, static_cast<Eigen::Index>(k));
          }
          list.emplace_back(pairs[k], memory);
        }
        return list;
      };
      sim_.recall(entries(recalled.pairs, recalled.memories),
                  entries(recalled.at_walls, recalled.wall_memories));
    }
  }

  TimeScales scales_;
  Sim sim_;
};

/// A drag must not take more than a part of a velocity in a step.
/// @param grains  at the start; those of inlets count as well
/// @throws SceneError that names the step that would do
template <int Dim>
void expect_slow_drag(const Scene<Dim>& scene, const std::vector<Grain<Dim>>& grains) {
  if (!scene.drag) return;
  double fastest = 0;  // [1/s]
  for (const Grain<Dim>& grain : grains) {
    fastest = std::max(fastest, scene.drag->slowing(grain.radius, grain.mass));
  }
  if (scene.time_step.seconds * fastest <= kMostTaken) return;
  throw scene.error("time_step", rounded(scene.time_step.seconds) +
                                     " s is too large for the drag, which allows at most " +
                                     rounded_down(kMostTaken / fastest) + " s; or give less drag");
}

/// The last part of make_run: law and grains as types.
template <int Dim, class Normal, template <class> class Friction>
std::unique_ptr<Run<Dim>> make_run_of(const Scene<Dim>& scene, Placement<Dim> placement,
                                      AnyNeighbourhood<Dim> neighbourhood) {
  using Law = Friction<Normal>;
  const auto law = [](const LawNumbers& numbers) { return make_law<Normal, Friction>(numbers); };
  LawTable<Law> laws(law(scene.law),
                     scene.pairs.empty() ? 1 : static_cast<int>(scene.materials.size()));
  for (const PairLaw& pair : scene.pairs) {
    laws.set(pair.a, pair.b, law(pair.law));
    if (!pair.touch) laws.set_apart(pair.a, pair.b);
  }
  auto grains = make_grains<Dim, Law::needs>(placement.grains);

  std::vector<Grain<Dim>> all = smallest_newcomers(scene);
  all.insert(all.end(), placement.grains.begin(), placement.grains.end());
  const TimeScales scales = time_scales(make_grains<Dim, Law::needs>(all), laws, placement.walls);
  if (scene.time_step.seconds <= 0 && !std::isfinite(scales.contact)) {
    throw scene.error("time_step", why_no_contact(scene) +
                                       ", so no contact sets a step; give one in seconds, "
                                       "or a grain that is not pinned");
  }
  Scene<Dim> resolved = scene;
  if (!(scene.time_step.seconds > 0)) {
    resolved.time_step.seconds = scene.time_step.fraction_of_contact * scales.contact;
  }
  if (!(resolved.time_step.seconds <= scales.safe_step)) {
    throw scene.error("time_step",
                      rounded(resolved.time_step.seconds) +
                          " s is too large: the stiffest contact lasts " + rounded(scales.contact) +
                          " s and allows at most " + rounded_down(scales.safe_step) + " s (\"" +
                          rounded(0.999 * scales.safe_step / scales.contact) + " contact\")");
  }

  expect_slow_drag(resolved, all);

  const auto walls = std::move(placement.walls);
  const auto recalled = std::move(placement.recalled);
  const auto finish = [&]<class Motion>(Motion) -> std::unique_ptr<Run<Dim>> {
    return std::make_unique<SimulationRun<Dim, Law, Motion>>(
        std::move(resolved), std::move(placement), std::move(grains), std::move(laws), walls,
        recalled, scales, std::move(neighbourhood));
  };
  switch (scene.integrator) {
    case IntegratorModel::symplectic_euler:
      return finish(SymplecticEuler{});
    case IntegratorModel::fourth_order:
      // With friction the scene reader has refused it already.
      if constexpr (!Law::needs.spin) return finish(ForestRuth{});
      break;
    case IntegratorModel::velocity_verlet:
      return finish(VelocityVerlet{});
  }
  throw scene.error("integrator",
                    "\"fourth order\" is for forces without loss: it needs friction = \"none\"");
}

/// The part of make_run before: the normal law becomes a type. Each friction law has a source file
/// of its own, so that they are compiled side by side.
template <int Dim, template <class> class Friction>
std::unique_ptr<Run<Dim>> make_run_with(const Scene<Dim>& scene, Placement<Dim> placement,
                                        AnyNeighbourhood<Dim> neighbourhood) {
  switch (scene.normal) {
#define LAGRAIN_CASE(word, Normal)                                         \
  case NormalModel::word:                                                  \
    return make_run_of<Dim, Normal, Friction>(scene, std::move(placement), \
                                              std::move(neighbourhood));
    LAGRAIN_NORMAL_LAWS(LAGRAIN_CASE)
#undef LAGRAIN_CASE
  }
  throw ContractError("a scene names no normal law");
}

#define LAGRAIN_MADE_ELSEWHERE(word, Friction)                        \
  extern template std::unique_ptr<Run<2>> make_run_with<2, Friction>( \
      const Scene<2>&, Placement<2>, AnyNeighbourhood<2>);            \
  extern template std::unique_ptr<Run<3>> make_run_with<3, Friction>( \
      const Scene<3>&, Placement<3>, AnyNeighbourhood<3>);
LAGRAIN_FRICTION_LAWS(LAGRAIN_MADE_ELSEWHERE)
#undef LAGRAIN_MADE_ELSEWHERE

}  // namespace lagrain::detail
