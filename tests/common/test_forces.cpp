// SPDX-License-Identifier: GPL-3.0-or-later
// Gravity that changes, body forces, and grains that are driven: closed forms, and the ledger.

#include <lagrain/body_force.hpp>
#include <lagrain/cell_grid.hpp>
#include <lagrain/gravity.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/state.hpp>

#include <support/motion_scenes.hpp>
#include <support/scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
Grain<Dim> ball(const Vec<Dim>& place, const Vec<Dim>& velocity = Vec<Dim>::Zero()) {
  Grain<Dim> g;
  g.position = place;
  g.velocity = velocity;
  g.radius = 1;
  g.mass = 1;
  return g;
}

/// One grain far from everything. Its contacts would be so soft that they allow any step here.
template <int Dim, class Law = FrictionalSpring>
Sim<Dim, Law, AllPairs<Dim>> alone(const Grain<Dim>& grain, Setting<Dim> setting) {
  Material soft = kGravel;
  soft.stiffness = 1;
  const LawTable<Law> laws(make_law<Law>(soft));
  return {make_grains<Dim, Law::needs>({grain}), laws, {}, setting, {}};
}

template <int Dim>
GravityCourse<Dim> quarter_turn(double start, double stop) {
  TurningGravity<Dim> turning;
  if constexpr (Dim == 2) {
    turning.axis = SpinVec<2>(1.0);
  } else {
    turning.axis = SpinVec<3>(0, -1, 0);
  }
  turning.rate = 0.5 * std::numbers::pi / (stop - start);
  turning.start = start;
  turning.stop = stop;
  return turning;
}

template <class S>
double largest_energy(const S& sim, const Ledger& start) {
  const Ledger now = energy_ledger(sim);
  double largest = 0;
  for (const double e : {now.kinetic, now.gravity - start.gravity, now.elastic, now.dashpot,
                         now.friction, now.gravity_work, now.driven_work, now.force_work}) {
    largest = std::max(largest, std::abs(e));
  }
  return largest;
}

/// A spring to the origin, which keeps energy.
template <int Dim>
struct Tether {
  double stiffness;  // [N/m]
  Push<Dim> on(const GrainView<Dim>& grain, double) const { return {-stiffness * grain.position}; }
};

/// A push that comes and goes, and turns the grain as well.
template <int Dim>
struct Stirring {
  Push<Dim> on(const GrainView<Dim>& grain, double t) const {
    return {std::cos(3 * t) * grain.mass * Vec<Dim>::Unit(0),
            SpinVec<Dim>::Constant(0.1 * std::sin(t))};
  }
};

}  // namespace

TEST_SUITE("forces") {
  TEST_CASE_TEMPLATE("gravity turns between two times and stays", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> down = -10 * up<Dim>();
    const auto course = quarter_turn<Dim>(1, 3);
    CHECK((gravity_at(course, down, 0) - down).norm() == 0);
    CHECK((gravity_at(course, down, 2) - 10 * std::sqrt(0.5) * (Vec<Dim>::Unit(0) - up<Dim>()))
              .norm() < 1e-14);
    CHECK((gravity_at(course, down, 3) - 10 * Vec<Dim>::Unit(0)).norm() < 1e-14);
    CHECK((gravity_at(course, down, 99) - 10 * Vec<Dim>::Unit(0)).norm() < 1e-14);
  }

  TEST_CASE("gravity of a table is linear between times, and switched where two are equal") {
    const GravityCourse<2> course =
        GravityTable<2>{{1, 2, 2, 4}, {Vec<2>(0, -10), Vec<2>(0, -20), Vec<2>(5, 0), Vec<2>(5, 8)}};
    const Vec<2> unused = Vec<2>::Zero();
    CHECK(gravity_at(course, unused, 0) == Vec<2>(0, -10));
    CHECK(gravity_at(course, unused, 1.5) == Vec<2>(0, -15));
    CHECK(gravity_at(course, unused, 2) == Vec<2>(5, 0));
    CHECK(gravity_at(course, unused, 3) == Vec<2>(5, 4));
    CHECK(gravity_at(course, unused, 5) == Vec<2>(5, 8));
  }

  TEST_CASE_TEMPLATE("a grain falls the way that double integration of gravity says", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const double end = 2, rate = 0.25 * std::numbers::pi;
    const auto course = quarter_turn<Dim>(0, 2);
    const auto error = [&](int steps) {
      auto sim = alone<Dim>(
          ball<Dim>(Vec<Dim>::Zero()),
          {.gravity = -10 * up<Dim>(), .time_step = end / steps, .gravity_course = course});
      const Ledger start = energy_ledger(sim);
      sim.step(steps);
      // Gravity is g (sin wt, -cos wt), so velocity is g/w (1 - cos wt, -sin wt), and place
      // g/w^2 (wt - sin wt, cos wt - 1).
      const double g = 10, phase = rate * end;
      const Vec<Dim> place =
          g / (rate * rate) *
          ((phase - std::sin(phase)) * Vec<Dim>::Unit(0) + (std::cos(phase) - 1) * up<Dim>());
      // Gravity is as strong as before: the balance of velocity Verlet is exact for any step.
      CHECK(std::abs(residual(energy_ledger(sim), start)) < 1e-12 * largest_energy(sim, start));
      return (sim.grains().position.col(0) - place).norm();
    };
    CHECK(error(100) < 1e-3);
    CHECK(error(200) < 0.27 * error(100));  // second order
  }

  TEST_CASE_TEMPLATE("gravity that is switched by a program: the ledger knows", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    auto sim =
        alone<Dim>(ball<Dim>(3 * up<Dim>()), {.gravity = -10 * up<Dim>(), .time_step = 0.01});
    const Ledger start = energy_ledger(sim);
    sim.step(50);
    sim.set_gravity(4 * Vec<Dim>::Unit(0));
    CHECK(std::abs(residual(energy_ledger(sim), start)) < 1e-12);
    sim.step(50);
    CHECK(sim.setting().gravity == 4 * Vec<Dim>::Unit(0));
    // Velocity Verlet leaves dt^2 m a^2 / 8 more than before.
    CHECK(relative_error(residual(energy_ledger(sim), start), 1e-4 * (16 - 100) / 8) < 1e-8);
    // Half of the step in which it is switched belongs to each.
    const Vec<Dim> velocity = -10 * 0.505 * up<Dim>() + 4 * 0.495 * Vec<Dim>::Unit(0);
    CHECK((sim.grains().velocity.col(0) - velocity).norm() < 1e-12);
  }

  TEST_CASE_TEMPLATE("a bed whose box is turned: ledger, and bits of threads and neighbourhoods", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    const auto bed = settling_bed<Dim>(Dim == 2 ? 200 : 300, 5);
    const auto law = make_law<Law>(kGravel);
    const auto scales =
        time_scales(make_grains<Dim, Law::needs>(bed.grains), LawTable<Law>(law), bed.walls);
    const auto run = [&](auto neighbourhood, int threads, double refinement) {
      Setting<Dim> setting{.gravity = bed.gravity,
                           .time_step = scales.safe_step / refinement,
                           .largest_overlap = 1e9,
                           .threads = threads,
                           .gravity_course = quarter_turn<Dim>(0.2, 1.5)};
      Sim<Dim, Law, decltype(neighbourhood)> sim(make_grains<Dim, Law::needs>(bed.grains),
                                                 LawTable<Law>(law), bed.walls, setting,
                                                 neighbourhood);
      sim.add_force("drag", Drag<Dim>{.rate = 0.3, .flow = Vec<Dim>::Unit(0)});
      const Ledger start = energy_ledger(sim);
      while (sim.time() < 2) sim.step(10);
      CHECK(std::abs(sim.flow().gravity_work) > 0.01 * largest_energy(sim, start));
      CHECK(sim.body_forces().front().work != 0);
      return std::pair(sim.grains().position,
                       residual(energy_ledger(sim), start) / largest_energy(sim, start));
    };
    const auto cells = run(CellGrid<Dim>{}, 1, 4);
    CHECK(cells.first == run(AllPairs<Dim>{}, 2, 4).first);
    CHECK(std::abs(cells.second) < 0.01);
  }

  TEST_CASE_TEMPLATE("a drag at a rate lets a velocity decay, and no more than the fluid's", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> wind = 2 * Vec<Dim>::Unit(0);
    const auto error = [&](int steps) {
      auto sim = alone<Dim>(ball<Dim>(Vec<Dim>::Zero(), 5 * up<Dim>()), {.time_step = 2.0 / steps});
      sim.add_force("drag", Drag<Dim>{.rate = 1.5, .flow = wind});
      const Ledger start = energy_ledger(sim);
      sim.step(steps);
      const double left = std::exp(-3.0);
      CHECK(std::abs(residual(energy_ledger(sim), start)) < 30.0 / steps);
      return (sim.grains().velocity.col(0) - left * 5 * up<Dim>() - (1 - left) * wind).norm();
    };
    CHECK(error(100) < 2e-3);
    CHECK(error(200) < 0.27 * error(100));
  }

  TEST_CASE("a sphere in a viscous fluid: the speed at which it sinks, and how its spin decays") {
    Grain<3> sphere = ball<3>(Vec<3>::Zero());
    sphere.omega = {0, 0, 7};
    auto sim = alone<3>(sphere, {.gravity = -9.81 * up<3>(), .time_step = 2e-3});
    const double eta = 0.3, pi = std::numbers::pi;
    sim.add_force("drag", Drag<3>{.viscosity = eta});
    sim.step(2000);
    CHECK(relative_error(-sim.grains().velocity(2, 0), 9.81 / (6 * pi * eta)) < 1e-8);
    const double decay = 8 * pi * eta / 0.4;  // over 2 m r^2 / 5
    sim.step(1);
    CHECK(std::abs(sim.grains().omega(2, 0)) < 7 * std::exp(-decay * 3.9));
  }

  TEST_CASE_TEMPLATE("a force of one's own: a spring to a place keeps energy to second order", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto swing = [&](int steps) {
      auto sim =
          alone<Dim>(ball<Dim>(3 * up<Dim>(), Vec<Dim>::Unit(0)), {.time_step = 10.0 / steps});
      sim.add_force("tether", Tether<Dim>{4});
      sim.add_force("stirring", Stirring<Dim>{});
      const Ledger start = energy_ledger(sim);
      sim.step(steps);
      CHECK(sim.body_forces()[0].name == "tether");
      CHECK(sim.body_forces()[1].name == "stirring");
      return std::abs(residual(energy_ledger(sim), start));
    };
    CHECK(swing(2000) < 1e-2);
    CHECK(swing(4000) < 0.3 * swing(2000));
  }

  TEST_CASE("a drag that stops spins within a step is refused") {
    const auto take = [](double viscosity) {
      auto sim = alone<3>(ball<3>(Vec<3>::Zero()), {.time_step = 0.01});
      sim.add_force("drag", Drag<3>{.viscosity = viscosity});
    };
    // Spins decay at 20 pi eta r / m, faster than velocities.
    const double most = 0.5 / (0.01 * 20 * std::numbers::pi);
    take(0.99 * most);
    CHECK_THROWS_AS(take(1.01 * most), ContractError);
  }

  TEST_CASE_TEMPLATE("gravity that is switched where grains come and leave at that time", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Material soft = kGravel;
    soft.stiffness = 1;
    const LawTable<LinearSpring> laws(make_law<LinearSpring>(soft));
    const std::vector<Grain<Dim>> two{ball<Dim>(7 * up<Dim>()),
                                      ball<Dim>(5 * Vec<Dim>::Unit(0) + 3 * up<Dim>())};
    Simulation<Dim, LinearSpring, VelocityVerlet, AllPairs<Dim>> sim(
        make_grains<Dim, Needs{}>(two), laws, {}, {.gravity = -10 * up<Dim>(), .time_step = 1e-4},
        {});
    const Ledger start = energy_ledger(sim);
    sim.step(5);
    sim.set_gravity(4 * Vec<Dim>::Unit(0));
    sim.exchange({0}, make_grains<Dim, Needs{}>({ball<Dim>(-90 * Vec<Dim>::Unit(0))}));
    sim.step(5);
    // dt^2 m a^2 / 8 is all that velocity Verlet leaves.
    CHECK(std::abs(residual(energy_ledger(sim), start)) < 1e-6);
  }

  TEST_CASE_TEMPLATE("what a state keeps: gravity that was set, and forces of one name", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto make = [] {
      auto sim = alone<Dim>(ball<Dim>(3 * up<Dim>(), Vec<Dim>::Unit(0)),
                            {.gravity = -10 * up<Dim>(), .time_step = 0.01});
      sim.add_force("pull", Tether<Dim>{4});
      sim.add_force("pull", Tether<Dim>{1});
      return sim;
    };
    auto sim = make();
    sim.step(20);
    sim.set_gravity(4 * Vec<Dim>::Unit(0));
    const auto check_going_on = [&] {
      State state;
      sim.persist(StateVisitor::keeping(state));
      auto whole = sim, again = make();
      again.persist(StateVisitor::restoring(state));
      whole.step(30);
      again.step(30);
      CHECK(whole.grains().position == again.grains().position);
      CHECK(whole.setting().gravity == again.setting().gravity);
      CHECK(whole.flow().gravity_work == again.flow().gravity_work);
      for (std::size_t k = 0; k < 2; ++k) {
        CHECK(whole.body_forces()[k].work == again.body_forces()[k].work);
      }
    };
    check_going_on();  // before the first step with the new gravity
    sim.step(5);
    check_going_on();
  }

  TEST_CASE("an integrator of conservative scenes takes neither") {
    const LawTable<LinearSpring> laws(make_law<LinearSpring>({.stiffness = 1e3}));
    Simulation<2, LinearSpring, ForestRuth, AllPairs<2>> sim(
        make_grains<2, Needs{}>({ball<2>(Vec<2>::Zero())}), laws, {}, {.time_step = 1e-3}, {});
    CHECK_THROWS_AS(sim.set_gravity(Vec<2>(0, -1)), ContractError);
    CHECK_THROWS_AS(sim.add_force("drag", Drag<2>{.rate = 1}), ContractError);
  }

  TEST_CASE_TEMPLATE("a driven grain keeps its velocity, and throws another one at twice that", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto law = make_law<LinearSpring>({.stiffness = 1e4, .restitution = 1});
    Grain<Dim> driven = ball<Dim>(Vec<Dim>::Zero(), 3 * Vec<Dim>::Unit(0));
    driven.driven = true;
    const Grain<Dim> free = ball<Dim>(2.2 * Vec<Dim>::Unit(0));
    const auto thrown = [&](double refinement) {
      auto sim = make_sim<Dim>(std::vector{driven, free}, law, {}, refinement);
      const Ledger start = energy_ledger(sim);
      while (sim.time() < 0.5) sim.step();
      CHECK(sim.grains().velocity.col(0) == driven.velocity);
      CHECK((sim.grains().position.col(0) - sim.time() * driven.velocity).norm() < 1e-12);
      // The driver gives 2 m v^2: half of it stays with the other grain as 1/2 m (2 v)^2 = 18 J.
      CHECK(relative_error(sim.flow().driven_work, 18) < 4 / refinement / refinement);
      CHECK(std::abs(residual(energy_ledger(sim), start)) < 40 / refinement / refinement);
      return relative_error(sim.grains().velocity(0, 1), 6);
    };
    CHECK(thrown(20) < 1e-3);
  }

  TEST_CASE("a driven sphere that spins in its place spins another one by friction") {
    const auto law = make_law<FrictionalSpring>(
        {.stiffness = 1e5, .restitution = 0.3, .friction = 0.5, .tangential_damping_ratio = 0.2});
    Grain<3> wheel = ball<3>(Vec<3>::Zero());
    wheel.driven = true;
    wheel.omega = {0, 0, 2};
    // A sphere is pressed against it by a plate, and held in a groove by nothing but its inertia.
    Grain<3> other = ball<3>({1.999, 0, 0});
    const auto wall = Wall<3>::half_space("smooth", {2.998, 0, 0}, -Vec<3>::Unit(0));
    LawTable<FrictionalSpring> laws(law, 2);
    auto smooth = make_law<FrictionalSpring>({.stiffness = 1e5, .restitution = 0.3});
    laws.set(0, 1, smooth);
    std::vector<Wall<3>> walls{wall};
    walls[0].material = 1;
    auto grains = make_grains<3, FrictionalSpring::needs>({wheel, other});
    const double step = time_scales(grains, laws, walls).safe_step / 10;
    Simulation<3, FrictionalSpring, VelocityVerlet, AllPairs<3>> sim(grains, laws, walls,
                                                                     {.time_step = step}, {});
    const Ledger start = energy_ledger(sim);
    while (sim.time() < 0.002) sim.step();
    CHECK(sim.driven().torque[2] < 0);  // friction brakes the wheel
    while (sim.time() < 0.1) sim.step();
    CHECK(sim.grains().omega.col(0) == wheel.omega);
    CHECK(sim.grains().omega(2, 1) < -0.01);  // the other way round
    CHECK(sim.flow().driven_work > 0);
    CHECK(std::abs(residual(energy_ledger(sim), start)) < 0.02 * sim.flow().driven_work);
  }

  TEST_CASE_TEMPLATE("two driven grains pass through each other, and touch no wall that stays", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Grain<Dim> one = ball<Dim>(-2 * Vec<Dim>::Unit(0), Vec<Dim>::Unit(0));
    Grain<Dim> two = ball<Dim>(2 * Vec<Dim>::Unit(0), -Vec<Dim>::Unit(0));
    one.driven = two.driven = true;
    const auto wall = Wall<Dim>::half_space("wall", Vec<Dim>::Zero(), Vec<Dim>::Unit(0));
    const LawTable<LinearSpring> laws(make_law<LinearSpring>({.stiffness = 1e4}));
    Simulation<Dim, LinearSpring, VelocityVerlet, CellGrid<Dim>> sim(
        make_grains<Dim, Needs{}>({one, two}), laws, {wall}, {.time_step = 0.01}, {});
    sim.step(600);
    CHECK(sim.flow().driven_work == 0);
    CHECK(relative_error(sim.grains().position(0, 0), 4) < 1e-12);
  }

  TEST_CASE("a grain cannot be pinned and driven") {
    Grain<2> grain = ball<2>(Vec<2>::Zero());
    grain.pinned = grain.driven = true;
    CHECK_THROWS_AS((make_grains<2, Needs{}>({grain})), ContractError);
  }
}
