// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/integrator.hpp>

#include <lagrain/observe.hpp>

#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim, class Law, class Motion>
Sim<Dim, Law, AllPairs<Dim>, Motion> compose(const std::vector<Grain<Dim>>& list, const Law& law,
                                             const std::vector<Wall<Dim>>& walls, double dt,
                                             const Vec<Dim>& gravity = Vec<Dim>::Zero()) {
  Setting<Dim> setting;
  setting.time_step = dt;
  setting.gravity = gravity;
  return {make_grains<Dim, Law::needs>(list), LawTable<Law>(law), walls, setting};
}

/// Three grains squeezed between two walls, set ringing; no contact ever opens, so the force is
/// smooth. On an axis, where sideways forces are exactly zero: a squeezed chain would buckle.
template <int Dim, class Law, class Motion>
auto ringing_chain(const Law& law, double dt) {
  const Vec<Dim> n = up<Dim>();
  std::vector<Grain<Dim>> list(3);
  for (int i = 0; i < 3; ++i) {
    auto& g = list[static_cast<std::size_t>(i)];
    g.radius = 1;
    g.mass = 1 + 0.3 * i;
    g.position = (0.95 + 1.9 * i) * n;
    g.velocity = (i == 1 ? 1.0 : -0.5) * n;
  }
  return compose<Dim, Law, Motion>(list, law,
                                   {Wall<Dim>::half_space("left", Vec<Dim>::Zero(), n),
                                    Wall<Dim>::half_space("right", 5.7 * n, -n)},
                                   dt);
}

template <int Dim, class Law, class Motion>
Columns<Dim> chain_places(const Law& law, double dt, int steps) {
  auto sim = ringing_chain<Dim, Law, Motion>(law, dt);
  for (int k = 0; k < steps; ++k) sim.step();
  return sim.grains().position;
}

/// Largest departure of the energy from its start, over the start's.
template <int Dim, class Law, class Motion>
double chain_energy_error(const Law& law, double dt, int steps) {
  auto sim = ringing_chain<Dim, Law, Motion>(law, dt);
  const double start = energy_ledger(sim).balance();
  double worst = 0;
  for (int k = 0; k < steps; ++k) {
    sim.step();
    worst = std::max(worst, relative_error(energy_ledger(sim).balance(), start));
  }
  return worst;
}

template <int Dim, class Motion>
struct Scheme {
  static constexpr int Dimension = Dim;
  using Integrator = Motion;
  static constexpr double order = std::is_same_v<Motion, SymplecticEuler> ? 1
                                  : std::is_same_v<Motion, ForestRuth>    ? 4
                                                                          : 2;
};

#define SCHEMES                                                                      \
  Scheme<2, SymplecticEuler>, Scheme<3, SymplecticEuler>, Scheme<2, VelocityVerlet>, \
      Scheme<3, VelocityVerlet>, Scheme<2, ForestRuth>, Scheme<3, ForestRuth>

}  // namespace

TEST_SUITE("integrator") {
  TEST_CASE_TEMPLATE("free flight is exact to the scheme", S, SCHEMES) {
    constexpr int Dim = S::Dimension;
    const auto law = make_law<LinearSpring>({});
    Grain<Dim> g;
    g.radius = 1;
    g.mass = 2;
    g.position = oblique<Dim>();
    g.velocity = 3 * along<Dim>();
    const Vec<Dim> gravity = -9.81 * up<Dim>();
    const double dt = 1e-4;
    auto sim = compose<Dim, LinearSpring, typename S::Integrator>({g}, law, {}, dt, gravity);

    for (int k = 0; k < 10000; ++k) sim.step();

    // Euler's velocity leads by half a step: t^2 becomes t (t + dt). The others are exact.
    const double lead = S::order == 1 ? dt : 0;
    const Vec<Dim> place = g.position + g.velocity + 0.5 * (1 + lead) * gravity;
    // 10^4 roundings at 10^-16 of numbers up to 5.
    CHECK((sim.grains().position.col(0) - place).norm() < 1e-11);
    CHECK((sim.grains().velocity.col(0) - (g.velocity + gravity)).norm() < 1e-11);
  }

  TEST_CASE("in free flight the spin stays") {
    Grain<3> g;
    g.radius = g.mass = 1;
    g.omega = {1, 2, 3};
    auto sim = make_sim<3>(std::vector<Grain<3>>{g}, make_law<FrictionalSpring>({}), {}, 1);

    for (int k = 0; k < 100; ++k) sim.step();

    CHECK(sim.grains().omega.col(0) == g.omega);
  }

  TEST_CASE_TEMPLATE("on a smooth motion places converge at the scheme's order", S, SCHEMES) {
    constexpr int Dim = S::Dimension;
    using Motion = typename S::Integrator;
    const Hertz law = make_law<Hertz>({.stiffness = 1e4});
    const double dt = 8e-4;
    constexpr int kSteps = 50;

    const Columns<Dim> exact = chain_places<Dim, Hertz, ForestRuth>(law, dt / 32, 32 * kSteps);
    const double coarse = (chain_places<Dim, Hertz, Motion>(law, dt, kSteps) - exact).norm();
    const double fine = (chain_places<Dim, Hertz, Motion>(law, dt / 4, 4 * kSteps) - exact).norm();

    CHECK(relative_error(observed_order(coarse, fine, 4), S::order) < 0.1);
  }

  TEST_CASE_TEMPLATE("on a smooth motion the energy error converges at the scheme's order", S,
                     SCHEMES) {
    constexpr int Dim = S::Dimension;
    using Motion = typename S::Integrator;
    const Hertz law = make_law<Hertz>({.stiffness = 1e4});
    const double dt = 8e-4;

    const double coarse = chain_energy_error<Dim, Hertz, Motion>(law, dt, 250);
    const double fine = chain_energy_error<Dim, Hertz, Motion>(law, dt / 4, 1000);

    CHECK(relative_error(observed_order(coarse, fine, 4), S::order) < 0.1);
  }

  TEST_CASE_TEMPLATE("symplectic: the energy error of a smooth motion does not grow with time", S,
                     SCHEMES) {
    constexpr int Dim = S::Dimension;
    using Motion = typename S::Integrator;
    const Hertz law = make_law<Hertz>({.stiffness = 1e4});

    const double few = chain_energy_error<Dim, Hertz, Motion>(law, 8e-4, 500);
    const double many = chain_energy_error<Dim, Hertz, Motion>(law, 8e-4, 20000);

    // A longer look finds a somewhat higher peak of the same oscillation; growth would be 40-fold.
    CHECK(many < 2 * few);
  }

  TEST_CASE_TEMPLATE("velocity Verlet keeps second order under a dashpot", C, Case<2, LinearSpring>,
                     Case<3, LinearSpring>, Case<2, Hertz>, Case<3, Hertz>) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    using Motion = VelocityVerlet;
    const Law law = make_law<Law>({.stiffness = 1e4, .restitution = 0.5});
    const double dt = 4e-4;
    constexpr int kSteps = 50;

    const Columns<Dim> exact = chain_places<Dim, Law, Motion>(law, dt / 64, 64 * kSteps);
    const double coarse = (chain_places<Dim, Law, Motion>(law, dt, kSteps) - exact).norm();
    const double fine = (chain_places<Dim, Law, Motion>(law, dt / 4, 4 * kSteps) - exact).norm();

    CHECK(relative_error(observed_order(coarse, fine, 4), 2) < 0.1);
  }

  TEST_CASE_TEMPLATE("where contacts open and close, fourth order is not kept", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    // The spring's force has a kink at first touch, and again at the last: second order. (The two
    // would cancel in a contact of a whole number of steps, so the steps are detuned.)
    const auto law = make_law<LinearSpring>({});
    const double duration = law.contact_time(0.5, 0.5);
    const auto error = [&](double refinement) {
      double sum = 0;
      constexpr int kPhases = 64;
      for (int p = 0; p < kPhases; ++p) {
        Grain<Dim> a;
        a.radius = a.mass = 1;
        Grain<Dim> b = a;
        const double detuned = refinement * (1 + 0.1 * std::fmod(p * std::numbers::phi, 1.0));
        const double dt = 0.1 * duration / detuned;
        const double gap = (1 + (p + 0.5) / kPhases) * dt;
        b.position = (2 + gap) * oblique<Dim>();
        b.velocity = -oblique<Dim>();
        auto sim = compose<Dim, LinearSpring, ForestRuth>({a, b}, law, {}, dt);
        while (sim.time() < 1.5 * duration) sim.step();
        const double apart = (sim.grains().position.col(1) - sim.grains().position.col(0)).norm();
        sum += std::pow(apart - (2 + sim.time() - gap - duration), 2);
      }
      return std::sqrt(sum / kPhases);
    };

    const double order = observed_order(error(2), error(16), 8);

    CHECK(relative_error(order, 2) < 0.05);
  }

  TEST_CASE_TEMPLATE("the fourth-order scheme refuses what it cannot integrate", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    Grain<Dim> g;
    g.radius = g.mass = 1;
    const auto build = [&](const auto& law, std::vector<Wall<Dim>> walls) {
      using Law = std::decay_t<decltype(law)>;
      return compose<Dim, Law, ForestRuth>({g}, law, walls, 1e-5);
    };
    auto moving = Wall<Dim>::half_space("belt", -2 * up<Dim>(), up<Dim>());
    moving.motion = Steady<Dim>{along<Dim>()};

    CHECK_THROWS_WITH_AS(build(make_law<LinearSpring>({.restitution = 0.9}), {}),
                         doctest::Contains("restitution 1"), ContractError);
    CHECK_THROWS_AS(build(make_law<FrictionalSpring>({.friction = 0.1}), {}), ContractError);
    CHECK_THROWS_WITH_AS(build(make_law<LinearSpring>({}), {moving}), doctest::Contains("belt"),
                         ContractError);
    CHECK_NOTHROW(build(make_law<LinearSpring>({}), {}));
  }
}
