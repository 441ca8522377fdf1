// SPDX-License-Identifier: GPL-3.0-or-later
// Walls that turn, run, follow a path or go, and walls of many pieces, in simulations.
#include <lagrain/cell_grid.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/walls.hpp>

#include <support/scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// An axis on no axis of coordinates; in the plane there is one alone.
template <int Dim>
SpinVec<Dim> tilted_axis() {
  if constexpr (Dim == 2) {
    return SpinVec<2>(1.0);
  } else {
    return Vec<3>(2, 3, 6) / 7;
  }
}

/// The axis about which rolling along `along()` turns.
template <int Dim>
SpinVec<Dim> rolling_axis() {
  return rolling_spin<Dim>().normalized();
}

template <int Dim>
Grain<Dim> grain_at(const Vec<Dim>& x) {
  Grain<Dim> g;
  g.radius = g.mass = 1;
  g.position = x;
  return g;
}

template <class S>
void run_until(S& sim, double time) {
  while (sim.time() < time) sim.step();
}

/// A paddle wheel: strips from the middle outwards.
template <int Dim>
Wall<Dim> wheel(double radius, int paddles) {
  std::vector<WallPiece<Dim>> pieces;
  for (int k = 0; k < paddles; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.3) / paddles;
    const Vec<Dim> out = std::cos(angle) * along<Dim>() + std::sin(angle) * up<Dim>();
    if constexpr (Dim == 2) {
      pieces.push_back(WallSegment(Vec<2>::Zero(), radius * out));
    } else {
      const Vec<3> side = 4 * Vec<3>::UnitY();
      const Vec<3> end = radius * out;
      pieces.push_back(Plate({-side, end - side, end + side, side}));
    }
  }
  return Wall<Dim>::sheet("wheel", Vec<Dim>::Zero(), std::move(pieces));
}

/// Grain and wall of every contact, by a search over all pieces.
template <int Dim, class S>
std::multiset<std::pair<int, int>> touching_pieces(const S& sim) {
  std::multiset<std::pair<int, int>> found;
  for (std::size_t w = 0; w < sim.walls().size(); ++w) {
    std::vector<WallPair> pairs;
    for (int i = 0; i < sim.grains().size(); ++i) {
      pairs.clear();
      for (int v = 0; v < static_cast<int>(sim.walls().size()); ++v) {
        for (int p = 0; p < sim.walls()[static_cast<std::size_t>(v)].piece_count(); ++p) {
          pairs.push_back({i, v, p});
        }
      }
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        if (pairs[k].wall != static_cast<int>(w)) continue;
        const double radius = sim.grains().radius[i];
        const auto foot =
            contact_foot<Dim>(sim.walls().data(), pairs, k, sim.grains().position.col(i), radius);
        if (foot.distance < radius) found.emplace(i, static_cast<int>(w));
      }
    }
  }
  return found;
}

}  // namespace

TEST_SUITE("moving walls") {
  TEST_CASE_TEMPLATE("the surface of a wall that moves and turns has the velocity of its places", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const double dt = 1e-6;
    for (const bool swings : {false, true}) {
      Wall<Dim> wall = wheel<Dim>(2, 3);
      wall.point = wall.home = 0.5 * oblique<Dim>();
      wall.motion = Shake<Dim>{0.3 * oblique<Dim>(), 2};
      const Vec<Dim> about = along<Dim>();
      if (swings) {
        wall.turning = Swing<Dim>{tilted_axis<Dim>(), 0.7, 1.5, about};
      } else {
        wall.turning = Turn<Dim>{tilted_axis<Dim>(), -1.3, about};
      }
      REQUIRE(wall.defect().empty());
      wall.uneven = true;
      for (const double t : {0.1, 0.35, 0.8}) {
        wall.advance(t - dt, dt);
        const auto before = wall.corners();
        const auto then = wall.pose();
        wall.advance(t + dt, dt);
        const auto after = wall.corners();
        Vec<Dim> outside = 3 * oblique<Dim>();
        const Vec<Dim> carried = wall.carried_along(then, before[1]);
        wall.advance(t, dt);
        for (std::size_t k = 0; k < before.size(); ++k) {
          const Vec<Dim> rate = (after[k] - before[k]) / (2 * dt);
          const Vec<Dim> velocity = wall.velocity_at(wall.corners()[k], outside.normalized());
          CHECK((rate - velocity).norm() < 1e-7);
          CHECK(velocity.norm() <= wall.fastest(Vec<Dim>::Zero()) * (1 + 1e-12));
        }
        CHECK((carried - after[1]).norm() < 1e-12);
        CHECK(wall.way_since(then, Vec<Dim>::Zero()) >= (wall.corners()[1] - before[1]).norm());
      }
    }
  }

  TEST_CASE_TEMPLATE("a turn begins and stops where it should, and the wall then rests", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Wall<Dim> wall = wheel<Dim>(1, 1);
    const auto home = wall.corners();
    wall.turning = Turn<Dim>{tilted_axis<Dim>(), 0.5 * std::numbers::pi, Vec<Dim>::Zero(), 1, 5};
    wall.advance(0.9, 0.1);
    CHECK(wall.corners() == home);
    CHECK(wall.spin.isZero(0));
    wall.advance(5, 0.1);
    CHECK((wall.corners()[1] - home[1]).norm() < 1e-12);  // one whole turn
    CHECK(relative_error(wall.angle, 2 * std::numbers::pi) < 1e-12);
    CHECK(wall.spin.isZero(0));
  }

  TEST_CASE("what has no end turns in itself alone, and a piston does not turn") {
    auto plane = Wall<3>::half_space("p", Vec<3>::Zero(), Vec<3>::UnitZ());
    plane.turning = Turn<3>{Vec<3>::UnitZ(), 1, Vec<3>(1, 0, 0)};
    CHECK(plane.defect().empty());
    plane.turning = Turn<3>{Vec<3>::UnitX(), 1, Vec<3>(1, 0, 0)};
    CHECK(plane.defect() == "what has no end turns about its normal alone; give plates");
    auto line = Wall<2>::half_space("p", Vec<2>::Zero(), Vec<2>::UnitY());
    line.turning = Turn<2>{SpinVec<2>(1.0), 1, Vec<2>::Zero()};
    CHECK(!line.defect().empty());
    auto drum = Wall<3>::cylinder("d", Vec<3>::Zero(), Vec<3>::UnitX(), 1);
    drum.turning = Turn<3>{-Vec<3>::UnitX(), 1, Vec<3>(0, 1, 0)};
    CHECK(drum.defect().empty());
    drum.turning = Turn<3>{Vec<3>::UnitY(), 1, Vec<3>(0, 1, 0)};
    CHECK(drum.defect() == "what has no end turns about its axis alone; give plates");
    auto piston = wheel<3>(1, 2);
    piston.motion = Piston<3>{1, Vec<3>::UnitX()};
    piston.turning = Turn<3>{Vec<3>::UnitX(), 1, Vec<3>::Zero()};
    CHECK(piston.defect() == "a piston does not turn");
    auto none = wheel<3>(1, 2);
    none.turning = Turn<3>{Vec<3>::Zero(), 1, Vec<3>::Zero()};
    CHECK(none.defect() == "it turns about no axis");
    auto path = wheel<2>(1, 2);
    path.motion = Path<2>{{0, 1, 1}, {{0, 0}, {1, 0}, {1, 1}}};
    CHECK(path.defect() == "the times of a path increase");
    path.motion = Path<2>{{0, 1}, {{0, 0}}};
    CHECK(!path.defect().empty());
    CHECK_THROWS_AS(
        (make_sim<2, LinearSpring>({grain_at<2>({5, 5})}, make_law<LinearSpring>({}), {path}, 1)),
        ContractError);
  }

  // An elastic impact by a wall that is as heavy as can be doubles its velocity.
  TEST_CASE_TEMPLATE("a paddle that turns hits a grain with the velocity of the place", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    const double rate = 0.2, arm = 50;
    Wall<Dim> paddle = wheel<Dim>(60, 1);
    const double start = 2 * std::numbers::pi * 0.3;
    // A quarter of a turn on, one radius ahead.
    const double angle = 1.0;
    const auto direction = [&](double a) -> Vec<Dim> {
      return std::cos(a) * along<Dim>() + std::sin(a) * up<Dim>();
    };
    paddle.turning = Turn<Dim>{-rolling_axis<Dim>(), rate, Vec<Dim>::Zero()};
    const Vec<Dim> normal = direction(start + angle + std::numbers::pi / 2);
    auto sim =
        make_sim<Dim, typename C::Law>({grain_at<Dim>(arm * direction(start + angle) + normal)},
                                       make_law<typename C::Law>({.stiffness = 1e7}), {paddle}, 4);
    run_until(sim, angle / rate + 0.02);

    const Vec<Dim> v = sim.grains().velocity.col(0);
    CHECK(relative_error(v.dot(normal), 2 * rate * arm) < 1e-3);
    // The work that the paddle has done is the energy that the grain has.
    CHECK(relative_error(sim.walls()[0].work, 0.5 * v.squaredNorm()) < 1e-3);
    CHECK(relative_error(sim.flow().wall_work, sim.walls()[0].work) < 1e-12);
  }

  // Sliding ends when v + r omega = V; a force F gives both: v = V c / (1 + c) with I = c m r^2.
  TEST_CASE_TEMPLATE("a grain laid on a belt ends rolling on it, and the belt has paid", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, Case<2, ViscousSpring>,
                     Case<3, ViscousHertz>) {
    constexpr int Dim = C::Dim;
    Wall<Dim> belt = Wall<Dim>::half_space("belt", Vec<Dim>::Zero(), up<Dim>());
    const double speed = 3, c = kInertiaFactor<Dim>;
    belt.belt = speed * along<Dim>() - 7 * up<Dim>();  // what points into it does nothing
    auto sim =
        make_sim<Dim, typename C::Law>({grain_at<Dim>(up<Dim>())},
                                       make_law<typename C::Law>({.stiffness = 1e7,
                                                                  .restitution = 0.3,
                                                                  .friction = 0.4,
                                                                  .tangential_damping_ratio = 0.5}),
                                       {belt}, 2, -10 * up<Dim>());
    const Ledger start = energy_ledger(sim);
    run_until(sim, 2);

    const double v = speed * c / (1 + c);
    CHECK(relative_error(sim.grains().velocity.col(0).dot(along<Dim>()), v) < 1e-3);
    CHECK(relative_error(sim.walls()[0].work, v * speed) < 1e-3);  // m = 1: force is m dv/dt
    CHECK(std::abs(residual(energy_ledger(sim), start)) < 1e-3 * v * speed);
  }

  TEST_CASE_TEMPLATE("a disc that turns under a grain drags it along", C, Case<3, FrictionalSpring>,
                     Case<3, FrictionalHertz>) {
    Wall<3> floor = Wall<3>::half_space("floor", Vec<3>::Zero(), Vec<3>::UnitZ());
    floor.turning = Turn<3>{Vec<3>::UnitZ(), 0.3, Vec<3>(0, -10, 0)};
    Wall<3> plate = Wall<3>::sheet("disc", Vec<3>(0, -10, 0),
                                   {Frustum{Vec<3>::Zero(), Vec<3>::UnitZ(), 0, 0, 20}});
    plate.turning = floor.turning;
    std::vector<Vec<3>> velocities;
    for (const Wall<3>& wall : {floor, plate}) {
      auto sim = make_sim<3, typename C::Law>(
          {grain_at<3>(Vec<3>::UnitZ())},
          make_law<typename C::Law>({.stiffness = 1e7, .restitution = 0.3, .friction = 0.4}),
          {wall}, 2, Vec<3>(0, 0, -10));
      run_until(sim, 0.2);
      CHECK(sim.walls()[0].pose().frame.isIdentity(0));  // it turns in itself
      velocities.push_back(sim.grains().velocity.col(0));
    }
    CHECK(velocities[0][0] < -0.5);  // sliding at first: mu g t
    CHECK((velocities[0] - velocities[1]).norm() < 1e-9);
  }

  // Riding on a turntable, a grain is at rest against it: nothing rolls, twists or slides.
  TEST_CASE_TEMPLATE("a grain in the middle of a turntable comes to turn with it, and no more", C,
                     Case<3, RollingSpring>, Case<3, FrictionalSpring>) {
    Wall<3> table = Wall<3>::half_space("table", Vec<3>::Zero(), Vec<3>::UnitZ());
    table.turning = Turn<3>{Vec<3>::UnitZ(), 2, Vec<3>::Zero()};
    Grain<3> grain = grain_at<3>(Vec<3>::UnitZ());
    const bool twists = C::Law::needs.rolling;
    grain.omega = Vec<3>(0, 0, twists ? 0 : 2);
    auto sim = make_sim<3, typename C::Law>({grain},
                                            make_law<typename C::Law>({.stiffness = 1e6,
                                                                       .restitution = 0.3,
                                                                       .friction = 0.4,
                                                                       .rolling_friction = 0.1,
                                                                       .twisting_friction = 0.1}),
                                            {table}, 2, Vec<3>(0, 0, -10));
    const Ledger start = energy_ledger(sim);
    run_until(sim, 3);
    CHECK((sim.grains().omega.col(0) - Vec<3>(0, 0, 2)).norm() < 1e-3);
    CHECK(sim.grains().velocity.col(0).norm() < 1e-6);
    // Twisting: torque times angle of the table, half of which is lost while the grain catches up.
    const double kinetic = 0.5 * kInertiaFactor<3> * 4;
    if (twists) CHECK(relative_error(sim.walls()[0].work, 2 * kinetic) < 0.02);
    CHECK(std::abs(residual(energy_ledger(sim), start)) < 1e-3 * kinetic);
  }

  TEST_CASE_TEMPLATE("a wall goes at its time, with what the contacts with it held", C,
                     Case<2, LinearSpring>, Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    Wall<Dim> floor = flat_piece<Dim>("gate", -3 * along<Dim>(), 3 * along<Dim>());
    floor.until = 1.5;
    Grain<Dim> grain = grain_at<Dim>(1.0 * up<Dim>());
    auto sim = make_sim<Dim, typename C::Law>(
        {grain}, make_law<typename C::Law>({.stiffness = 1e5, .restitution = 0.2}), {floor}, 4,
        -10 * up<Dim>());
    const Ledger start = energy_ledger(sim);
    run_until(sim, 1.4);
    const double held = energy_ledger(sim).elastic;
    const double height = sim.grains().position.col(0).dot(up<Dim>());
    CHECK(held > 0);
    CHECK(relative_error(-sim.walls()[0].force.dot(up<Dim>()), 10) < 1e-3);
    run_until(sim, 2);

    CHECK(sim.walls()[0].gone);
    CHECK(sim.walls()[0].force.isZero(0));
    const double fall = sim.time() - 1.5, dt = sim.setting().time_step;
    CHECK(relative_error(height - sim.grains().position.col(0).dot(up<Dim>()),
                         0.5 * 10 * fall * fall) < 4 * dt / fall);
    CHECK(relative_error(-sim.walls()[0].work, held) < 1e-2);
    const Ledger now = energy_ledger(sim);
    CHECK(now.elastic == 0);
    CHECK(std::abs(residual(now, start)) < 0.1 * held);
  }

  // The joints of part of a wall are those of walls of their own.
  TEST_CASE_TEMPLATE("pieces of one wall make the same surface as walls of their own", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>,
                     Case<2, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    const double slopes[] = {-0.6, -0.2, 0.0, 0.3, 0.0, -0.4, 0.5};
    std::vector<Wall<Dim>> single;
    std::vector<WallPiece<Dim>> pieces;
    Vec<Dim> from = -6 * along<Dim>() + 2 * up<Dim>();
    for (const double slope : slopes) {
      const Vec<Dim> to = from + 2 * along<Dim>() + 2 * slope * up<Dim>();
      if constexpr (Dim == 2) {
        single.push_back(Wall<2>::segment(std::to_string(single.size()), from, to));
        pieces.push_back(WallSegment(from, to));
      } else {
        const Vec<3> side = 5 * Vec<3>::UnitY();
        const std::vector<Vec<3>> corners{from - side, to - side, to + side, from + side};
        single.push_back(Wall<3>::plate(std::to_string(single.size()), corners));
        pieces.push_back(Plate(corners));
      }
      from = to;
    }
    Grain<Dim> grain = grain_at<Dim>(-5.5 * along<Dim>() + 3.3 * up<Dim>());
    const auto law = make_law<typename C::Law>(
        {.stiffness = 1e6, .restitution = 0.6, .friction = 0.4, .tangential_damping_ratio = 0.2});
    auto apart = make_sim<Dim, typename C::Law>({grain}, law, single, 2, -10 * up<Dim>());
    auto together = make_sim<Dim, typename C::Law>(
        {grain}, law, {Wall<Dim>::sheet("ground", Vec<Dim>::Zero(), pieces)}, 2, -10 * up<Dim>());
    apart.step(24000);
    together.step(24000);
    CHECK(apart.grains().position.col(0).dot(along<Dim>()) > -3);
    CHECK((apart.grains().position - together.grains().position).norm() < 1e-8);
    Vec<Dim> force = Vec<Dim>::Zero();
    for (const auto& wall : apart.walls()) force += wall.force;
    CHECK((force - together.walls()[0].force).norm() < 1e-5);
  }

  TEST_CASE_TEMPLATE("no contact with a wheel in a crowd is missed, and its work closes the ledger",
                     C, Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, FrictionalSpring>,
                     Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    Random random(4);
    auto packed = lattice<Dim>({.count = Dim == 2 ? 60 : 100, .speed = 0.3}, random);
    const Vec<Dim> middle = 0.5 * (packed.low + packed.high);
    const double wheel_radius = 3.5;
    std::erase_if(packed.grains, [&](const Grain<Dim>& g) {
      const Vec<Dim> arm = g.position - middle;
      return std::hypot(arm[0], arm[Dim - 1]) < wheel_radius + 1.1;
    });
    std::vector<Wall<Dim>> walls = box<Dim>(packed.low, packed.high);
    Wall<Dim> rotor = wheel<Dim>(wheel_radius, 5);
    rotor.point = rotor.home = middle;
    rotor.turning = Turn<Dim>{-rolling_axis<Dim>(), 3, middle, 0.2};
    walls.push_back(rotor);
    const auto law = make_law<typename C::Law>(
        {.stiffness = 3e5, .restitution = 0.9, .friction = 0.5, .tangential_damping_ratio = 0.2});
    auto sim =
        make_sim<Dim, typename C::Law, CellGrid<Dim>>(packed.grains, law, walls, 2, -5 * up<Dim>());
    auto reference = make_sim<Dim, typename C::Law>(packed.grains, law, walls, 2, -5 * up<Dim>());
    const Ledger start = energy_ledger(sim);
    std::size_t contacts = 0;
    for (int k = 0; k < 400; ++k) {
      sim.step(25);
      reference.step(25);
      std::multiset<std::pair<int, int>> listed;
      sim.for_each_wall_contact(
          [&](WallPair pair, auto&&...) { listed.emplace(pair.i, pair.wall); });
      const auto expected = touching_pieces<Dim>(sim);
      REQUIRE(listed == expected);
      for (const auto& [i, w] : listed) contacts += w == static_cast<int>(walls.size()) - 1;
    }
    CHECK(contacts > 15);
    CHECK(sim.grains().position == reference.grains().position);

    // The ledger is of second order: a fourth of the step leaves a sixteenth of its residual.
    auto fine =
        make_sim<Dim, typename C::Law, CellGrid<Dim>>(packed.grains, law, walls, 8, -5 * up<Dim>());
    fine.step(40000);
    const double work = sim.walls().back().work;
    CHECK(work > 1000);
    CHECK(std::abs(residual(energy_ledger(sim), start)) < 0.01 * work);
    CHECK(std::abs(residual(energy_ledger(fine), start)) <
          0.3 * std::abs(residual(energy_ledger(sim), start)));
  }

  TEST_CASE("a sphere rolls over a mesh of ten thousand facets as over a plane, and lists few") {
    std::vector<WallPiece<3>> facets;
    const int side = 71;
    const double width = 0.37;
    Random random(6);
    const auto corner = [&](int i, int j) -> Vec<3> { return {width * i, width * j, 0}; };
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j) {
        facets.push_back(Plate({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)}));
        facets.push_back(Plate({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)}));
      }
    }
    Grain<3> grain = grain_at<3>({6.1, 5.3, 1});
    grain.velocity = {6, 5, 0};
    const auto law = make_law<FrictionalSpring>(
        {.stiffness = 1e6, .restitution = 0.5, .friction = 0.5, .tangential_damping_ratio = 0.3});
    auto mesh = make_sim<3, FrictionalSpring>(
        {grain}, law, {Wall<3>::sheet("mesh", Vec<3>::Zero(), facets)}, 1, Vec<3>(0, 0, -10));
    auto plane = make_sim<3, FrictionalSpring>(
        {grain}, law, {Wall<3>::half_space("plane", Vec<3>::Zero(), Vec<3>::UnitZ())}, 1,
        Vec<3>(0, 0, -10));
    for (int k = 0; k < 12000; ++k) {
      mesh.step();
      plane.step();
      int contacts = 0;
      mesh.for_each_wall_contact([&](auto&&...) { ++contacts; });
      CHECK(contacts <= 1);
    }
    CHECK(plane.grains().position(0, 0) > 11);
    CHECK((mesh.grains().position - plane.grains().position).norm() < 1e-6);
    CHECK((mesh.grains().omega - plane.grains().omega).norm() < 1e-6);
  }
}
