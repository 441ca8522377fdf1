// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/time_step.hpp>

#include <lagrain/observe.hpp>

#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
Grain<Dim> grain(double mass, int material = 0) {
  Grain<Dim> g;
  g.radius = 1;
  g.mass = mass;
  g.material = material;
  return g;
}

}  // namespace

TEST_SUITE("time_step") {
  TEST_CASE_TEMPLATE("the shortest collision is that of the two lightest grains", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    const auto g = make_grains<C::Dim, LinearSpring::needs>(
        {grain<C::Dim>(5), grain<C::Dim>(2), grain<C::Dim>(7)});
    const LawTable<LinearSpring> laws(make_law<LinearSpring>({.stiffness = 1e4}));

    const TimeScales scales = time_scales(g, laws, std::vector<Wall<C::Dim>>{});

    const double shortest = std::numbers::pi * std::sqrt(1 / 1e4);  // m_eff = 2 / 2
    CHECK(relative_error(scales.contact, shortest) < 1e-14);
    CHECK(relative_error(scales.safe_step, 0.1 * shortest) < 1e-14);
  }

  TEST_CASE("a strong dashpot shortens the safe step") {
    const auto g = make_grains<2, LinearSpring::needs>({grain<2>(2)});
    const LawTable<LinearSpring> laws(LinearSpring{1e4, 5});

    const TimeScales scales = time_scales(g, laws, std::vector<Wall<2>>{});

    // On the edge of stability: 4 u^2 / 4 + 2 4 zeta u = 1 for u = omega0 dt.
    const double u = scales.safe_step / std::sqrt(1 / 1e4);
    CHECK(std::abs(u * u + 8 * 5 * u - 1) < 1e-14);
  }

  TEST_CASE("every pair of materials counts with its own law, walls with theirs") {
    const auto g = make_grains<3, LinearSpring::needs>({grain<3>(1, 0), grain<3>(4, 1)});
    LawTable<LinearSpring> laws(make_law<LinearSpring>({.stiffness = 1}), 3);
    const auto contact = [&](const std::vector<Wall<3>>& walls) {
      return time_scales(g, laws, walls).contact / std::numbers::pi;
    };
    auto wall = Wall<3>::half_space("floor", Vec<3>::Zero(), up<3>());
    wall.material = 2;

    CHECK(relative_error(contact({}), std::sqrt(0.5 / 1)) < 1e-14);  // the light pair
    laws.set(0, 1, make_law<LinearSpring>({.stiffness = 100}));
    CHECK(relative_error(contact({}), std::sqrt(0.8 / 100)) < 1e-14);
    laws.set(1, 2, make_law<LinearSpring>({.stiffness = 1e4}));
    CHECK(relative_error(contact({}), std::sqrt(0.8 / 100)) < 1e-14);  // no wall, no matter
    CHECK(relative_error(contact({wall}), std::sqrt(4 / 1e4)) < 1e-14);

    // Where one law holds for all, the lightest grain alone counts.
    const LawTable<LinearSpring> one(make_law<LinearSpring>({.stiffness = 1}));
    CHECK(relative_error(time_scales(g, one, std::vector{wall}).contact / std::numbers::pi,
                         std::sqrt(0.5 / 1)) < 1e-14);
  }

  TEST_CASE_TEMPLATE("no pair of one material collides faster than the named time", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, Hertz>, Case<3, Hertz>) {
    Random random(5);
    std::vector<Grain<C::Dim>> list;
    for (int k = 0; k < 50; ++k) {
      Grain<C::Dim> g;
      g.radius = std::pow(10, random.uniform(-2, 0));
      g.mass = grain_volume<C::Dim>(g.radius);
      list.push_back(g);
    }
    const auto law = make_law<typename C::Law>({.restitution = 0.5});
    const auto g = make_grains<C::Dim, C::Law::needs>(list);

    const double named =
        time_scales(g, LawTable<typename C::Law>(law), std::vector<Wall<C::Dim>>{}).contact;

    for (int i = 0; i < 50; ++i) {
      for (int j = i; j < 50; ++j) {
        const double m = 1 / (1 / g.mass[i] + 1 / g.mass[j]);
        const double r = 1 / (1 / g.radius[i] + 1 / g.radius[j]);
        CHECK(law.contact_time(m, r) >= named * (1 - 1e-12));
      }
    }
  }

  TEST_CASE_TEMPLATE("a simulation refuses a step above the safe one, and names it", C,
                     Case<2, LinearSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    using Law = typename C::Law;
    const LawTable<Law> laws(make_law<Law>({.stiffness = 1e4}));
    const auto g = make_grains<Dim, Law::needs>({grain<Dim>(2)});
    const auto with_step = [&](double dt) {
      Setting<Dim> setting;
      setting.time_step = dt;
      return Sim<Dim, Law>(g, laws, {}, setting);
    };

    // 0.1 pi sqrt(1 / 10^4) = 0.00314159
    CHECK_THROWS_WITH_AS(with_step(0.00315), doctest::Contains("at most 0.00314159 s"),
                         ContractError);
    CHECK_THROWS_AS(with_step(0), ContractError);
    CHECK_THROWS_AS(with_step(-1e-3), ContractError);
    CHECK_THROWS_AS(with_step(std::nan("")), ContractError);
    CHECK_NOTHROW(with_step(0.00314));
  }

  TEST_CASE_TEMPLATE("the safe step is stable with a piston much lighter than the grain", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    Grain<Dim> g = grain<Dim>(1);
    g.pinned = true;
    auto piston = Wall<Dim>::half_space("piston", 1.001 * up<Dim>(), -up<Dim>());
    piston.motion = Piston<Dim>{1e-3, -1.0 * up<Dim>()};
    auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{g}, make_law<LinearSpring>({}), {piston}, 1);

    for (int k = 0; k < 10000; ++k) sim.step();

    // An elastic rebound never returns faster than the piston fell: v^2 = 2 a h = 2 * 10^3 * 10^-3.
    CHECK(sim.walls()[0].velocity.norm() < 1.5 * std::sqrt(2.0));
  }
}
