// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/walls.hpp>

#include <lagrain/cell_grid.hpp>
#include <lagrain/observe.hpp>

#include <support/scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
Grain<Dim> grain_at(double height) {
  Grain<Dim> g;
  g.radius = g.mass = 1;
  g.position = height * up<Dim>();
  return g;
}

/// The axis of a lying drum, and the way across it: along() in the plane.
template <int Dim>
Vec<Dim> drum_axis() {
  if constexpr (Dim == 2) {
    return Vec<2>::Zero();
  } else {
    return {0.6, 0.8, 0};
  }
}
template <int Dim>
Vec<Dim> across_drum() {
  if constexpr (Dim == 2) {
    return along<2>();
  } else {
    return {0.8, -0.6, 0};
  }
}

template <class S>
void run_for(S& sim, double duration) {
  const double end = sim.time() + duration;
  while (sim.time() < end) sim.step();
}

}  // namespace

TEST_SUITE("walls") {
  TEST_CASE_TEMPLATE("a half-space is measured along its normal, both ways", S, Space<2>,
                     Space<3>) {
    const auto n = oblique<S::Dim>();
    const auto wall = Wall<S::Dim>::half_space("w", 2 * n, 5 * n);  // the normal is made unit

    const Vec<S::Dim> away = n.unitOrthogonal();
    CHECK(relative_error(wall.foot(3.5 * n + 7 * away).distance, 1.5) < 1e-14);
    CHECK(relative_error(wall.foot(1.5 * n - 7 * away).distance, -0.5) < 1e-14);
    CHECK((wall.foot(9 * n).normal - n).norm() < 1e-15);
  }

  TEST_CASE("the foot on a segment is on its middle, or at an end") {
    const Vec<2> t = oblique<2>();
    const Vec<2> n = t.unitOrthogonal();
    const auto wall = Wall<2>::segment("w", 1 * t, 3 * t);
    const auto check = [&](const Vec<2>& x, double distance, const Vec<2>& normal) {
      CHECK(relative_error(wall.foot(x).distance, distance) < 1e-14);
      CHECK((wall.foot(x).normal - normal).norm() < 1e-14);
    };

    check(2.3 * t + 0.5 * n, 0.5, n);
    check(2.3 * t - 0.5 * n, 0.5, -n);  // solid from both sides
    check(0.2 * t, 0.8, -t);
    check(3.7 * t, 0.7, t);
    check(3 * t + 3 * t + 4 * n, 5, 0.6 * t + 0.8 * n);
    // Exactly on it, some normal at a right angle to it.
    CHECK(wall.foot(2 * t).distance < 1e-15);
    CHECK(relative_error(wall.foot(2 * t).normal.norm(), 1) < 1e-15);
    const auto axial = Wall<2>::segment("w", Vec<2>::Zero(), 4 * along<2>());
    CHECK(axial.foot(along<2>()).normal.dot(along<2>()) == 0);
  }

  TEST_CASE_TEMPLATE("a round wall is measured from its axis, and pushes towards it", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> middle = 0.3 * oblique<Dim>();
    const Vec<Dim> t = across_drum<Dim>();
    const Vec<Dim> axis = drum_axis<Dim>();
    const auto wall = Wall<Dim>::cylinder("w", middle, 5 * axis, 2);  // the axis is made unit
    const auto check = [&](const Vec<Dim>& x, double distance, const Vec<Dim>& normal) {
      CHECK(std::abs(wall.foot(x).distance - distance) < 1e-14);
      CHECK((wall.foot(x).normal - normal).norm() < 1e-14);
    };

    check(middle + 1.5 * t, 0.5, -t);
    check(middle - 1.5 * t + 40 * axis, 0.5, t);
    check(middle + 1.5 * up<Dim>() - 7 * axis, 0.5, -up<Dim>());
    check(middle + 2.5 * t, -0.5, -t);  // outside
    // On the axis, some normal at a right angle to it.
    const auto foot = wall.foot(middle);
    CHECK(foot.distance == 2);
    CHECK(relative_error(foot.normal.norm(), 1) < 1e-15);
    CHECK(std::abs(foot.normal.dot(axis)) < 1e-15);
  }

  TEST_CASE_TEMPLATE("a grain that slides in a drum is a pendulum", C, Case<2, LinearSpring>,
                     Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<LinearSpring>({.stiffness = 1e6});
    const double angle = 0.1;
    const double length = 2 + 10 * std::cos(angle) / 1e6;  // radius 3 less 1, and the overlap
    auto g = grain_at<Dim>(0);
    g.position = length * (std::sin(angle) * across_drum<Dim>() - std::cos(angle) * up<Dim>());
    auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{g}, law,
                             {Wall<Dim>::cylinder("drum", Vec<Dim>::Zero(), drum_axis<Dim>(), 3)},
                             1, -10 * up<Dim>());
    const auto place = [&] { return sim.grains().position.col(0).dot(across_drum<Dim>()); };
    std::vector<double> crossings;
    while (crossings.size() < 2 && sim.time() < 10) {
      const double before = place();
      sim.step();
      if (before * place() > 0) continue;
      crossings.push_back(sim.time() - sim.setting().time_step * place() / (place() - before));
    }

    REQUIRE(crossings.size() == 2);
    const double period = 2 * std::numbers::pi * std::sqrt(length / 10) *
                          (1 + angle * angle / 16 + 11 * std::pow(angle, 4) / 3072);
    // The spring gives by m v^2 / (k length), 5e-8; the crossing is known to (dt / period)^2.
    CHECK(relative_error(crossings[1] - crossings[0], 0.5 * period) < 1e-6);
    CHECK(relative_error(crossings[0], 0.25 * period) < 1e-6);
  }

  TEST_CASE_TEMPLATE("no contact with a round wall is missed, and nobody gets out", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, FrictionalSpring>,
                     Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    Random random(12);
    const auto packed = lattice<Dim>({.count = 60, .speed = 3, .spin = 2}, random);
    const Vec<Dim> middle = 0.5 * (packed.low + packed.high);
    // Upright in space, closed by two planes.
    const Vec<Dim> axis = Dim == 2 ? Vec<Dim>::Zero() : up<Dim>();
    const double radius = 0.5 * std::sqrt(2.0) * (packed.high - packed.low)[0];
    std::vector<Wall<Dim>> walls{Wall<Dim>::cylinder("drum", middle, axis, radius)};
    if (Dim == 3) {
      walls.push_back(Wall<Dim>::half_space("floor", packed.low, up<Dim>()));
      walls.push_back(Wall<Dim>::half_space("lid", packed.high, -up<Dim>()));
    }
    walls[0].motion = Shake<Dim>{0.2 * across_drum<Dim>(), 1};
    auto sim = make_sim<Dim, typename C::Law, CellGrid<Dim>>(
        packed.grains, make_law<typename C::Law>({.stiffness = 1e5, .friction = 0.5}), walls, 1);

    int listed = 0;
    int found = 0;
    for (int k = 0; k < 3000; ++k) {
      sim.step();
      sim.for_each_wall_contact([&](auto&&...) { ++listed; });
      for (const auto& wall : sim.walls()) {
        for (int i = 0; i < sim.grains().size(); ++i) {
          const double distance = wall.foot(sim.grains().position.col(i)).distance;
          if (distance < sim.grains().radius[i]) ++found;
          REQUIRE(distance > 0);
        }
      }
    }

    CHECK(found > 100);
    CHECK(listed == found);
  }

  TEST_CASE_TEMPLATE("the grains within reach of a wall are those whose foot is", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(6);
    Columns<Dim> x(Dim, 200);
    for (double& c : x.reshaped()) c = random.uniform(-3, 3);
    for (const auto& wall : {Wall<Dim>::half_space("h", Vec<Dim>::Zero(), oblique<Dim>()),
                             flat_piece<Dim>("s", -oblique<Dim>(), oblique<Dim>()),
                             Wall<Dim>::cylinder("c", 0.3 * oblique<Dim>(), drum_axis<Dim>(), 2)}) {
      std::vector<int> found;
      wall.for_each_within(
          x, [](int i) { return i % 2 ? 1.0 : 0.3; }, [&](int i, int) { found.push_back(i); });

      std::vector<int> expected;
      for (int i = 0; i < 200; ++i) {
        if (wall.foot(x.col(i)).distance <= (i % 2 ? 1.0 : 0.3)) expected.push_back(i);
      }
      CHECK(found == expected);
      CHECK(found.size() > 0);
    }
  }

  TEST_CASE_TEMPLATE("walls move as their motion says", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> a = 0.3 * oblique<Dim>();
    auto wall = Wall<Dim>::half_space("w", 2 * up<Dim>(), up<Dim>());
    const auto at = [&](double t) {
      wall.advance(t, 1e-3);
      return Vec<Dim>(wall.point - 2 * up<Dim>());
    };

    wall.motion = Steady<Dim>{a, 1, 3};
    CHECK(at(0.5).norm() < 1e-15);
    CHECK(wall.velocity.isZero(0));
    CHECK((at(2.5) - 1.5 * a).norm() < 1e-15);
    CHECK(wall.velocity == a);
    CHECK((at(7) - 2 * a).norm() < 1e-15);
    CHECK(wall.velocity.isZero(0));

    wall.motion = Shake<Dim>{a, 0.5, 1, 100};
    const double w = std::numbers::pi;
    CHECK(at(0.5).norm() < 1e-15);
    CHECK((at(1.7) - std::sin(0.7 * w) * a).norm() < 1e-15);
    CHECK((wall.velocity - w * std::cos(0.7 * w) * a).norm() < 1e-15);
  }

  TEST_CASE_TEMPLATE("no wall ever jumps: a moving wall's place is the integral of its velocity", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> a = 0.3 * oblique<Dim>();
    const double dt = 1e-3;
    // Stopped in mid-swing, at a quarter of a period.
    for (const auto& motion :
         {decltype(Wall<Dim>::motion){Steady<Dim>{a, 0.2, 0.7}},
          decltype(Wall<Dim>::motion){Shake<Dim>{a, 2, 0.2, 0.825}},
          decltype(Wall<Dim>::motion){Path<Dim>{{0.1, 0.4, 0.9}, {Vec<Dim>::Zero(), a, -2 * a}}}}) {
      CAPTURE(motion.index());
      auto wall = Wall<Dim>::half_space("w", Vec<Dim>::Zero(), up<Dim>());
      wall.motion = motion;
      wall.advance(0, 0);
      Vec<Dim> before = wall.point;
      for (int k = 1; k < 1500; ++k) {
        wall.advance(k * dt, dt);
        CHECK((wall.point - before).norm() < 1.01 * 2 * 2 * std::numbers::pi * 0.3 * dt);
        before = wall.point;
      }
      CHECK(wall.velocity.isZero(0));
    }
  }

  TEST_CASE_TEMPLATE("a fixed wall carries the weight, sheared by no force of its own", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, FrictionalHertz>,
                     Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    std::vector<Grain<Dim>> list;
    for (int k = 0; k < 3; ++k) {
      list.push_back(grain_at<Dim>(1));
      list.back().position += 3.0 * k * along<Dim>();
    }
    const auto law = make_law<typename C::Law>({.stiffness = 1e5, .restitution = 0.2});
    auto sim = make_sim<Dim>(list, law, {Wall<Dim>::half_space("f", Vec<Dim>::Zero(), up<Dim>())},
                             1, -10 * up<Dim>());

    run_for(sim, 1);

    // A restitution of 0.2 is a damping ratio of about 0.7; the contact lasts 0.01 s, so after a
    // hundred such times no motion is left.
    CHECK((sim.walls()[0].force + 30 * up<Dim>()).norm() < 1e-9);
  }

  TEST_CASE_TEMPLATE("a wall that advances on a grain throws it off with (1 + e) times its speed",
                     C, Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    auto law = make_law<LinearSpring>({.stiffness = 1e6});
    auto wall = Wall<Dim>::half_space("ram", Vec<Dim>::Zero(), up<Dim>());
    wall.motion = Steady<Dim>{2 * up<Dim>()};
    auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{grain_at<Dim>(1.0005)}, law, {wall}, 10);

    run_for(sim, 0.01);

    // (omega0 dt)^2 = 10^-3 bounds the error of an elastic contact, which is third order.
    CHECK(relative_error(sim.grains().velocity.col(0).dot(up<Dim>()), 4) < 1e-4);
    // All its energy is the wall's work.
    CHECK(relative_error(sim.flow().wall_work, 8) < 1e-3);
    CHECK(std::abs(energy_ledger(sim).balance()) < 1e-2);
  }

  TEST_CASE_TEMPLATE("the work of a moving wall is entered at second order", C,
                     Case<2, LinearSpring>, Case<3, Hertz>) {
    constexpr int Dim = C::Dim;
    const auto residual_at = [](double refinement) {
      const auto law = make_law<typename C::Law>({.stiffness = 1e6});
      auto wall = Wall<Dim>::half_space("ram", Vec<Dim>::Zero(), up<Dim>());
      wall.motion = Steady<Dim>{2 * up<Dim>()};
      auto sim =
          make_sim<Dim>(std::vector<Grain<Dim>>{grain_at<Dim>(1.0005)}, law, {wall}, refinement);
      run_for(sim, 0.02);
      return std::abs(energy_ledger(sim).balance());
    };

    // The force is zero at both ends of the contact, where the rule of rectangles is that of
    // trapezes. The places of the ends in a step scatter the error.
    CHECK(observed_order(residual_at(2), residual_at(64), 32) > 1.6);
  }

  TEST_CASE_TEMPLATE("a grain on a plate shaken slowly feels gravity plus the plate's acceleration",
                     C, Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    auto plate = Wall<Dim>::half_space("plate", Vec<Dim>::Zero(), up<Dim>());
    const double w = 2 * std::numbers::pi;
    plate.motion = Shake<Dim>{0.1 * up<Dim>(), 1, 0.5};  // 3.9 m/s^2 < g: it never leaves
    const auto law = make_law<LinearSpring>({.stiffness = 1e6, .restitution = 0.2});
    auto sim =
        make_sim<Dim>(std::vector<Grain<Dim>>{grain_at<Dim>(1)}, law, {plate}, 1, -10 * up<Dim>());
    run_for(sim, 1.5);

    for (int k = 0; k < 10; ++k) {
      run_for(sim, 0.1);
      const double a = -0.1 * w * w * std::sin(w * (sim.time() - 0.5));
      // A spring of 10^3 rad/s under a drive of 2 pi lags by 2 zeta w / omega0 < 1 %.
      CHECK(std::abs(-sim.walls()[0].force.dot(up<Dim>()) - (10 + a)) < 0.01 * 4);
    }
  }

  TEST_CASE_TEMPLATE("a loaded piston comes to rest on the grains and presses with its load", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, FrictionalSpring>,
                     Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    auto piston = Wall<Dim>::half_space("piston", 4.5 * up<Dim>(), -up<Dim>());
    piston.motion = Piston<Dim>{3, -50 * up<Dim>()};
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    const auto law = make_law<typename C::Law>({.stiffness = 1e5, .restitution = 0.2});
    auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{grain_at<Dim>(1), grain_at<Dim>(3)}, law,
                             {floor, piston}, 8, -10 * up<Dim>());

    run_for(sim, 5);

    CHECK((sim.walls()[1].force - 50 * up<Dim>()).norm() < 1e-8);
    CHECK((sim.walls()[0].force + 70 * up<Dim>()).norm() < 1e-8);
    CHECK(sim.walls()[1].velocity.norm() < 1e-10);
    if constexpr (std::is_same_v<typename C::Law, LinearSpring>) {
      const double sunk = (50 + 60 + 70) / 1e5;
      CHECK(relative_error(4 - sim.walls()[1].point.dot(up<Dim>()), sunk) < 1e-7);
    }
    // All the work of its load went into the grains; summed with a force that jumps at first touch,
    // so to first order: 2 zeta omega0 dt / 2 = 0.7 * 0.3 / 8 of the energy of impact.
    const double fallen = 4.5 - sim.walls()[1].point.dot(up<Dim>());
    CHECK(relative_error(sim.flow().wall_work, 50 * fallen) < 0.025);
  }

  TEST_CASE_TEMPLATE("a piston is held until its start, then falls; a lid out of reach feels none",
                     C, Case<2, LinearSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    auto piston = Wall<Dim>::half_space("piston", 9 * up<Dim>(), -up<Dim>());
    piston.motion = Piston<Dim>{3, -30 * up<Dim>(), 0.5};
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{grain_at<Dim>(1)},
                             make_law<typename C::Law>({.stiffness = 1e6}), {floor, piston}, 1);
    const double dt = sim.setting().time_step;

    run_for(sim, 0.5 - 2 * dt);
    CHECK(sim.walls()[1].point == 9 * up<Dim>());
    CHECK(sim.walls()[1].velocity.isZero(0));
    double longest = 0;
    while (sim.time() < 0.9) {
      const Vec<Dim> before = sim.walls()[1].point;
      sim.step();
      longest = std::max(longest, (sim.walls()[1].point - before).norm());
      CHECK(sim.walls()[1].force.isZero(0));
    }

    // From rest at 10 m/s^2, known to a step; it never moves further than its speed allows.
    const double fallen = 9 - sim.walls()[1].point.dot(up<Dim>());
    CHECK(std::abs(fallen - 0.5 * 10 * 0.4 * 0.4) < 3 * 10 * 0.4 * dt);
    CHECK(longest < 10 * (0.4 + 2 * dt) * dt);
    CHECK(sim.flow().wall_work == 0);
  }
}
