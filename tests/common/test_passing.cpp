// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/passing.hpp>

#include <lagrain/observe.hpp>

#include <support/cases.hpp>
#include <support/scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

constexpr double kStiff = 1e5;  // [N/m]

template <int Dim>
Grain<Dim> ball(const Vec<Dim>& place, const Vec<Dim>& velocity = Vec<Dim>::Zero()) {
  Grain<Dim> g;
  g.radius = g.mass = 1;
  g.position = place;
  g.velocity = velocity;
  return g;
}

LinearSpring elastic() { return make_law<LinearSpring>({.stiffness = kStiff}); }

/// The time step of a simulation of such grains [s].
template <int Dim>
double step_of(const std::vector<Grain<Dim>>& list, const std::vector<Wall<Dim>>& walls) {
  return make_sim<Dim>(list, elastic(), walls, 1).setting().time_step;
}

/// What a simulation says when it stops within so many steps; empty if it goes on.
template <class S>
std::string said_by(S& sim, int steps, bool at_once = false) {
  try {
    if (at_once) {
      sim.step(steps);
    } else {
      for (int k = 0; k < steps; ++k) sim.step();
    }
  } catch (const SimulationError& error) {
    return error.what();
  }
  return "";
}

template <int Dim, class Motion = VelocityVerlet>
std::string said(const std::vector<Grain<Dim>>& list, const std::vector<Wall<Dim>>& walls,
                 int steps, bool at_once = false) {
  auto sim = make_sim<Dim, LinearSpring, AllPairs<Dim>, Motion>(list, elastic(), walls, 1);
  return said_by(sim, steps, at_once);
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The number that follows some words.
double number_after(const std::string& text, const std::string& words) {
  const auto found = text.find(words);
  REQUIRE(found != std::string::npos);
  return std::strtod(text.c_str() + found + words.size(), nullptr);
}

/// A grain shot at x with velocity v, so that it is half a step from there at a half step.
template <int Dim>
Grain<Dim> shot_through(const Vec<Dim>& place, const Vec<Dim>& velocity, double dt,
                        double steps_before = 3.5) {
  return ball<Dim>(place - steps_before * dt * velocity, velocity);
}

/// A thin wall across along(), 10 m high and wide.
template <int Dim>
Wall<Dim> screen(double x) {
  if constexpr (Dim == 2) {
    return Wall<2>::segment("screen", {x, -5}, {x, 5});
  } else {
    return Wall<3>::plate("screen", {{x, -5, -5}, {x, 5, -5}, {x, 5, 5}, {x, -5, 5}});
  }
}

}  // namespace

TEST_SUITE("passing") {
  // ---- The overlap that nobody sees
  // --------------------------------------------------------------

  TEST_CASE("the overlap missed on a chord is that of the closed form") {
    Random random(1);
    for (int k = 0; k < cases(2000, 50000); ++k) {
      // Past a centre at the distance h, from -a to b along the way.
      const double reach = random.uniform(0.5, 3), radius = random.uniform(0.05, 0.5) * reach;
      const double h = reach * random.uniform(0, 1.2);
      const double a = reach * random.uniform(-0.5, 4), b = reach * random.uniform(-0.5, 4) + 1e-9;
      if (a + b <= 0) continue;
      const auto distance = [&](double s) { return std::hypot(h, -a + s * (a + b)); };
      const double least = a < 0 ? distance(0) : b < 0 ? distance(1) : h;
      const double seen = std::max(0.0, reach - std::min(distance(0), distance(1)));
      const double missed = std::max(0.0, reach - least) - seen;

      const double found = missed_overlap(distance, reach, radius);

      if (missed > kMissed * radius * (1 + 1e-6)) {
        CHECK(std::abs(found - missed) < 1e-9 * reach);
      } else if (missed < kMissed * radius * (1 - 1e-6)) {
        CHECK(found == 0);
      }
    }
  }

  TEST_CASE("nothing is missed of a way out of a round container, which is deepest at an end") {
    // Concave: the distance from the container's wall along a chord.
    Random random(2);
    for (int k = 0; k < 1000; ++k) {
      const double x = random.uniform(-3, 3), y = random.uniform(-3, 3), u = random.uniform(-3, 3),
                   w = random.uniform(-3, 3);
      const auto distance = [&](double s) {
        return 3 - std::hypot(x + s * (u - x), y + s * (w - y));
      };
      CHECK(missed_overlap(distance, 0.5, 0.5) == 0);
    }
  }

  TEST_CASE("slow grains can miss no more than the bound") {
    // The largest chord that a way of twice kSlow can hide, for all ratios of radii.
    for (const double other : {1.0, 1.5, 3.0, 100.0}) {
      const double reach = 1 + other, half = kSlow;
      const double h = std::sqrt(reach * reach - half * half) + 1e-12;
      const auto distance = [&](double s) { return std::hypot(h, (2 * s - 1) * half); };
      CHECK(reach - h <= kMissed);
      CHECK(missed_overlap(distance, reach, 1) == 0);
    }
  }

  // ---- Grains through grains
  // ---------------------------------------------------------------------

  TEST_CASE_TEMPLATE("a bullet does not pass through a grain unseen", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> t = oblique<Dim>(), n = t.unitOrthogonal();
    const double dt = step_of<Dim>({ball<Dim>(Vec<Dim>::Zero()), ball<Dim>(9 * t)}, {});
    for (const double way : {4.5, 10.0, 300.0, 1e6}) {
      for (const double aside : {0.0, 0.5, 1.7}) {
        for (const bool pinned : {true, false}) {
          for (const bool at_once : {true, false}) {
            CAPTURE(way);
            CAPTURE(aside);
            auto target = ball<Dim>(Vec<Dim>::Zero());
            target.pinned = pinned;
            const auto bullet = shot_through<Dim>(aside * n, way / dt * t, dt);
            const std::string message = said<Dim>({target, bullet}, {}, 10, at_once);
            const std::string other = said<Dim>({bullet, target}, {}, 10, at_once);

            // The faster one is named first.
            CHECK(has(message, "grain 1 passed through grain 0 near ("));
            CHECK(has(other, "grain 0 passed through grain 1 near ("));
            CHECK(relative_error(number_after(message, "t = "), 4 * dt) < 0.3);
            CHECK(relative_error(number_after(message, "it moved by "), way) < 1e-4);
          }
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("the message tells where the grain was halfway", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const double dt = step_of<Dim>({ball<Dim>(Vec<Dim>::Zero()), ball<Dim>(9 * up<Dim>())}, {});
    Vec<Dim> place = Vec<Dim>::Constant(7);
    place[0] = 5;
    const auto bullet = shot_through<Dim>(place, 10 / dt * along<Dim>(), dt);
    const std::string message = said<Dim>({ball<Dim>(place), bullet}, {}, 10);

    const auto from = message.find("near (") + 6;
    CHECK(std::abs(std::strtod(message.c_str() + from, nullptr) - 5) < 1e-3);
    CHECK(has(message, Dim == 2 ? ", 7) m" : ", 7, 7) m"));
  }

  TEST_CASE_TEMPLATE("at the step that the message names nothing passes unseen", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(3);
    for (int k = 0; k < cases(40, 2000); ++k) {
      Vec<Dim> aim = Vec<Dim>::Zero();
      for (int d = 1; d < Dim; ++d) aim[d] = random.uniform(-1, 1);
      const double way = std::pow(10, random.uniform(0.7, 2));
      auto target = ball<Dim>(Vec<Dim>::Zero());
      target.pinned = k % 2 == 0;
      const double dt = step_of<Dim>({target, ball<Dim>(9 * up<Dim>())}, {});
      const auto bullet = shot_through<Dim>(aim, way / dt * along<Dim>(), dt);
      const std::vector<Grain<Dim>> list{target, bullet};
      const std::string message = said<Dim>(list, {}, 10);
      if (!has(message, "passed through")) continue;
      const double step = number_after(message, "at most ");
      REQUIRE(step > 0);
      REQUIRE(step < dt);

      auto grains = make_grains<Dim, LinearSpring::needs>(list);
      Setting<Dim> setting;
      setting.time_step = step;
      Sim<Dim, LinearSpring> sim(std::move(grains), LawTable<LinearSpring>(elastic()), {}, setting);
      std::string then;
      bool touched = false;
      try {
        for (double end = 8 * dt; sim.time() < end;) {
          sim.step();
          touched = touched || contact_statistics(sim).contacts > 0;
        }
      } catch (const SimulationError& error) {
        then = error.what();
      }
      CHECK(!has(then, "passed"));
      CHECK((touched || has(then, "overlaps")));
    }
  }

  TEST_CASE_TEMPLATE("two fast grains do not pass through each other", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> t = oblique<Dim>(), n = t.unitOrthogonal();
    const double dt = step_of<Dim>({ball<Dim>(Vec<Dim>::Zero()), ball<Dim>(9 * t)}, {});
    for (const double way : {2.5, 20.0, 1000.0}) {
      // Head-on, and crossing at a right angle.
      const auto a = shot_through<Dim>(Vec<Dim>::Zero(), way / dt * t, dt);
      const auto b = shot_through<Dim>(Vec<Dim>::Zero(), -way / dt * t, dt);
      const auto c = shot_through<Dim>(Vec<Dim>::Zero(), way / dt * n, dt);
      CAPTURE(way);
      CHECK(has(said<Dim>({a, b}, {}, 10), "passed through grain "));
      CHECK(has(said<Dim>({b, a}, {}, 10, true), "passed through grain "));
      if (way > 3) CHECK(has(said<Dim>({a, c}, {}, 10), "passed through grain "));
      // At another time at the same place.
      auto late = c;
      late.position -= 5.5 * dt * late.velocity;
      if (way > 20) CHECK(said<Dim>({a, late}, {}, 20) == "");
    }
  }

  TEST_CASE_TEMPLATE("of what all have in common nobody is told", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(4);
    const auto packed = lattice<Dim>({.count = 60, .speed = 0.3}, random);
    auto list = packed.grains;
    for (auto& g : list) g.velocity += 1e5 * oblique<Dim>();
    CHECK(said<Dim>(list, {}, 300) == "");
    CHECK(said<Dim>(list, {}, 300, true) == "");
    CHECK(said<Dim, ForestRuth>(list, {}, 100) == "");
    // A wall that flies with them, and one that they fly along.
    auto wall = flat_piece<Dim>("w", packed.low - 1 * up<Dim>(),
                                packed.low - 1 * up<Dim>() + 9 * along<Dim>());
    wall.motion = Steady<Dim>{1e5 * oblique<Dim>()};
    CHECK(said<Dim>(list, {wall}, 300) == "");

    // And a grain at rest in their way is passed through.
    Grain<Dim> idle = list[7];
    const double dt = step_of<Dim>(list, {});
    idle.position = list[7].position + 20.5 * dt * list[7].velocity;
    idle.velocity.setZero();
    list.push_back(idle);
    CHECK(has(said<Dim>(list, {}, 60), "passed through"));
  }

  TEST_CASE_TEMPLATE("a fast grain that misses all others, or grazes one, goes on", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> t = oblique<Dim>(), n = t.unitOrthogonal();
    const double dt = step_of<Dim>({ball<Dim>(Vec<Dim>::Zero()), ball<Dim>(9 * t)}, {});
    for (const double way : {1.0, 10.0, 1000.0}) {
      CAPTURE(way);
      const auto passes_at = [&](double aside) {
        return said<Dim>(
            {ball<Dim>(Vec<Dim>::Zero()), shot_through<Dim>(aside * n, way / dt * t, dt)}, {}, 10);
      };
      CHECK(passes_at(2.001) == "");
      CHECK(passes_at(2 - 0.9 * kMissed) == "");
      if (way > 1) CHECK(has(passes_at(2 - 1.1 * kMissed), "passed through"));
    }
    // Through the gap of a screen, and beyond its end.
    std::vector<Wall<Dim>> walls{screen<Dim>(0)};
    walls[0].point += 6.1 * up<Dim>();
    walls[0].home = walls[0].point;
    CHECK(said<Dim>({shot_through<Dim>(Vec<Dim>::Zero(), 10 / dt * along<Dim>(), dt)}, walls, 10) ==
          "");
  }

  TEST_CASE_TEMPLATE("a fast grain that is stiff enough bounces, and nothing is reported", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    // The deepest overlap of an impact on a pinned grain is v / omega0; 0.25 radii here.
    const double omega = std::sqrt(kStiff), v = 0.25 * omega;
    auto target = ball<Dim>(Vec<Dim>::Zero());
    target.pinned = true;
    for (const double phase : {0.0, 0.3, 0.6, 0.9}) {
      for (const double aside : {0.0, 0.7, 1.5, 1.95}) {
        auto bullet = ball<Dim>(-3 * along<Dim>() + aside * up<Dim>(), v * along<Dim>());
        const double dt = step_of<Dim>({target, bullet}, {});
        bullet.position -= phase * dt * bullet.velocity;
        auto sim = make_sim<Dim>({target, bullet}, elastic(), {}, 1);
        CHECK(said_by(sim, 200) == "");
        if (aside == 0) CHECK(sim.grains().velocity.col(1).dot(along<Dim>()) < -0.9 * v);
        auto at_wall = make_sim<Dim>({bullet}, elastic(), {screen<Dim>(0)}, 1);
        CHECK(said_by(at_wall, 200) == "");
        CHECK(at_wall.grains().velocity.col(0).dot(along<Dim>()) < -0.9 * v);
      }
    }
  }

  TEST_CASE_TEMPLATE("a large grain among small ones moves by more than they are wide", S, Space<2>,
                     Space<3>) {
    // It pushes a pinned small one aside at no moment; and rolls over none unseen.
    constexpr int Dim = S::Dim;
    auto large = ball<Dim>(-101.0 * along<Dim>());
    large.radius = 100;
    large.mass = 1e6;
    auto small = ball<Dim>(Vec<Dim>::Zero());
    const double dt = step_of<Dim>({large, small}, {});
    large.position -= 3.3 * along<Dim>();
    large.velocity = 1 / dt * along<Dim>();  // one small radius in a step: not sound
    const std::string message = said<Dim>({large, small}, {}, 30);
    CHECK(has(message, "overlaps"));
  }

  TEST_CASE("by every integrator a bullet is seen") {
    const double dt = step_of<2>({ball<2>({0, 0}), ball<2>({9, 0})}, {});
    for (const bool at_once : {true, false}) {
      for (const double phase : {3.1, 3.4, 3.5, 3.7, 4.0}) {
        for (const double way : {6.0, 50.0}) {
          CAPTURE(at_once);
          CAPTURE(phase);
          CAPTURE(way);
          const std::vector<Grain<2>> list{ball<2>({0, 0}),
                                           shot_through<2>({0, 0}, Vec<2>(way / dt, 0), dt, phase)};
          const auto stops = [&](const std::string& message) {
            return has(message, "passed through ") || has(message, "overlaps");
          };
          CHECK(stops(said<2, SymplecticEuler>(list, {}, 10, at_once)));
          CHECK(stops(said<2, ForestRuth>(list, {}, 10, at_once)));
          CHECK(stops(said<2, VelocityVerlet>(list, {}, 10, at_once)));
          const std::vector<Grain<2>> alone{list[1]};
          CHECK(stops(said<2, SymplecticEuler>(alone, {screen<2>(0)}, 10, at_once)));
          CHECK(stops(said<2, ForestRuth>(alone, {screen<2>(0)}, 10, at_once)));
        }
      }
    }
  }

  TEST_CASE("a passage is seen whether steps are asked for together or one by one") {
    // The fourth-order scheme moves grains at the end of a step as well: both ways count as one.
    const double dt = step_of<2>({ball<2>({0, 0}), ball<2>({9, 0})}, {});
    Random random(5);
    int differ = 0, seen = 0;
    for (int k = 0; k < cases(400, 10000); ++k) {
      const double way = random.uniform(0.3, 2);
      const Vec<2> v(way / dt, 0);
      auto target = ball<2>({0, 0});
      target.pinned = true;
      const std::vector<Grain<2>> list{
          target, ball<2>(Vec<2>(-4 - random.uniform(0, way), random.uniform(1.9, 2)), v)};
      const bool together = said<2, ForestRuth>(list, {}, 40, true) == "";
      const bool one_by_one = said<2, ForestRuth>(list, {}, 40, false) == "";
      differ += together != one_by_one;
      seen += !together;
    }
    CHECK(seen > 0);
    CHECK(differ == 0);
  }

  // ---- Walls
  // -------------------------------------------------------------------------------------

  TEST_CASE_TEMPLATE("a bullet does not pass through a thin wall unseen", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto wall = screen<Dim>(0);
    const double dt = step_of<Dim>({ball<Dim>(9 * along<Dim>())}, {wall});
    const Vec<Dim> n = along<Dim>(), t = up<Dim>();
    for (const double way : {3.0, 30.0, 1e5}) {
      for (const double lean : {0.0, 0.5, 2.0}) {
        for (const bool at_once : {true, false}) {
          CAPTURE(way);
          CAPTURE(lean);
          // Straight, and slanting: the way across the wall counts.
          const Vec<Dim> v = way / dt * (n + lean * t);
          const std::string message =
              said<Dim>({shot_through<Dim>(Vec<Dim>::Zero(), v, dt)}, {wall}, 10, at_once);
          if (way == 3 && lean == 2.0) {
            CHECK(message != "");
          } else {
            CHECK(has(message, "grain 0 passed through wall screen near ("));
          }
        }
      }
    }
    // By its edge with half a radius, and hardly.
    const auto by_edge = [&](double aside) {
      return said<Dim>({shot_through<Dim>((5 + aside) * t, 30 / dt * n, dt)}, {wall}, 10);
    };
    CHECK(has(by_edge(0.5), "passed through wall screen"));
    CHECK(by_edge(0.995) == "");
  }

  TEST_CASE_TEMPLATE("a bullet from outside and inside a closed box, and through half-spaces", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), along<Dim>());
    const auto drum =
        Wall<Dim>::cylinder("drum", Vec<Dim>::Zero(), Dim == 2 ? Vec<Dim>::Zero() : up<Dim>(), 20);
    const double dt = step_of<Dim>({ball<Dim>(9 * along<Dim>())}, {floor});
    for (const double way : {3.0, 100.0, 1e7}) {
      const auto bullet = shot_through<Dim>(1e-3 * along<Dim>(), -way / dt * along<Dim>(), dt, 2.5);
      CHECK(has(said<Dim>({bullet}, {floor}, 10), "overlaps wall floor"));
      auto out = ball<Dim>(Vec<Dim>::Zero(), way / dt * along<Dim>());
      CHECK(has(said<Dim>({out}, {drum}, 40), "overlaps wall drum"));
    }
  }

  TEST_CASE_TEMPLATE("a thin wall that sweeps over a grain at rest stops the run", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    auto wall = screen<Dim>(0);
    const auto grain = ball<Dim>(12.5 * along<Dim>() + 0.3 * up<Dim>());
    const double dt = step_of<Dim>({grain}, {wall});
    // By five radii in a step, from -30 m on.
    const auto from = [&](Wall<Dim> w, double x) {
      w.point = w.point + x * along<Dim>();
      w.home = w.point;
      return w;
    };
    auto steady = from(wall, -30);
    steady.motion = Steady<Dim>{5 / dt * along<Dim>()};
    // Half a swing of 60 m in 24 steps: 7.9 m per step in the middle.
    auto shaken = from(wall, 12.5);
    shaken.motion = Shake<Dim>{60 * along<Dim>(), 1 / (48 * dt), 0};
    auto swept = ball<Dim>(12.5 * along<Dim>() + 20 * along<Dim>());
    auto piston = from(wall, -30);
    piston.motion = Piston<Dim>{1, 2.5 / (dt * dt) * along<Dim>()};
    for (const bool at_once : {true, false}) {
      CHECK(has(said<Dim>({grain}, {steady}, 20, at_once), "grain 0 passed through wall screen"));
      CHECK(has(said<Dim>({swept}, {shaken}, 20, at_once), "grain 0 passed through wall screen"));
      CHECK(has(said<Dim>({grain}, {piston}, 20, at_once), "grain 0 passed through wall screen"));
    }
    // One among many.
    std::vector<Grain<Dim>> many;
    for (int k = 0; k < 30; ++k)
      many.push_back(ball<Dim>(12.5 * along<Dim>() + (9 + 3 * k) * up<Dim>()));
    many.push_back(grain);
    CHECK(has(said<Dim>(many, {steady}, 20), "grain 30 passed through wall screen"));
    many.pop_back();
    CHECK(said<Dim>(many, {steady}, 20) == "");
  }

  TEST_CASE_TEMPLATE("a thin wall that stops or starts within a step is watched in that step", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto wall = screen<Dim>(0);
    const auto grain = ball<Dim>(12.5 * along<Dim>());
    const double dt = step_of<Dim>({grain}, {wall});
    // It goes ten radii in a step, and stands still from one and a half steps on, at 15 m.
    wall.motion = Steady<Dim>{10 / dt * along<Dim>(), 0, 1.5 * dt};
    CHECK(has(said<Dim>({grain}, {wall}, 10), "passed through wall screen"));
    // Exactly at a step's end.
    wall.motion = Steady<Dim>{15 / dt * along<Dim>(), 0, dt};
    CHECK(has(said<Dim>({grain}, {wall}, 10), "passed through wall screen"));
    // It starts late in the step, and does not come as far.
    wall.motion = Steady<Dim>{20 / dt * along<Dim>(), 0.6 * dt, dt};
    CHECK(said<Dim>({grain}, {wall}, 10) == "");
    // A quarter of a swing, to where it rests for a moment: 15 m in one step.
    wall.motion = Shake<Dim>{15 * along<Dim>(), 1 / (4 * dt), 0, dt};
    CHECK(has(said<Dim>({grain}, {wall}, 10), "passed through wall screen"));
  }

  TEST_CASE_TEMPLATE("a wall takes grains along, however fast, and is no passage", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    // A grain lies on a tray that flies; the tray is accelerated slowly.
    auto tray = flat_piece<Dim>("tray", -5 * along<Dim>(), 5 * along<Dim>());
    const auto law = make_law<LinearSpring>({.stiffness = kStiff, .restitution = 0.3});
    auto grain = ball<Dim>(1.0001 * up<Dim>());
    auto sim0 = make_sim<Dim>({grain}, law, {tray}, 1);
    const double dt = sim0.setting().time_step;
    tray.motion = Steady<Dim>{3 / dt * up<Dim>()};
    grain.velocity = 3 / dt * up<Dim>();
    auto sim = make_sim<Dim>({grain}, law, {tray}, 1, -10 * up<Dim>());
    CHECK(said_by(sim, 300) == "");
    CHECK(contact_statistics(sim).wall_contacts == 1);
    // A grain that slides fast along a wall, over its joints too.
    std::vector<Wall<Dim>> floor;
    for (int k = 0; k < 60; ++k) {
      floor.push_back(flat_piece<Dim>("f", 5.0 * k * along<Dim>(), 5.0 * (k + 1) * along<Dim>()));
    }
    auto slider = ball<Dim>(0.9999 * up<Dim>() + along<Dim>(), 0.9 / dt * along<Dim>());
    auto slides = make_sim<Dim>({slider}, law, floor, 1, -10 * up<Dim>());
    CHECK(said_by(slides, 300) == "");
  }

  TEST_CASE_TEMPLATE(
      "a grain that slides fast over pieces shorter than its way, pressed in by some "
      "percent, passes through none of them",
      S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    std::vector<Wall<Dim>> floor;
    for (int k = 0; k < 400; ++k) {
      floor.push_back(flat_piece<Dim>("f", 0.1 * k * along<Dim>(), 0.1 * (k + 1) * along<Dim>()));
    }
    // It rests with an overlap of 3 % of its radius, and goes 0.4 of it in a step.
    auto slider = ball<Dim>(0.97 * up<Dim>() + along<Dim>());
    auto still = make_sim<Dim>({slider}, elastic(), floor, 1);
    slider.velocity = 0.4 / still.setting().time_step * along<Dim>();
    auto sim = make_sim<Dim>({slider}, elastic(), floor, 1, -0.03 * kStiff * up<Dim>());
    CHECK(said_by(sim, 60) == "");
  }

  TEST_CASE_TEMPLATE("a wall may sweep over pinned grains: neither can move", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    auto wall = screen<Dim>(0);
    auto pinned = ball<Dim>(12.5 * along<Dim>());
    pinned.pinned = true;
    const auto free = ball<Dim>(12.5 * along<Dim>() + 20 * up<Dim>());
    const double dt = step_of<Dim>({pinned, free}, {wall});
    wall.motion = Steady<Dim>{5 / dt * along<Dim>()};
    CHECK(said<Dim>({pinned, free}, {wall}, 20) == "");
    // Slowly it does: this is what the fast one must agree with.
    wall.motion = Steady<Dim>{0.1 / dt * along<Dim>()};
    CHECK(said<Dim>({pinned, free}, {wall}, 400) == "");
    // A piston is held up.
    wall.motion = Piston<Dim>{1, 0.5 / (dt * dt) * along<Dim>()};
    CHECK(has(said<Dim>({pinned, free}, {wall}, 60), "wall screen"));
  }

  // ---- Many grains
  // -------------------------------------------------------------------------------

  TEST_CASE("among thousands of grains in changing slots a bullet is named by its number") {
    // The bullet flies through a bed that stirs: slots are sorted now and then.
    Random random(6);
    const auto packed = lattice<2>({.count = 3000, .speed = 3}, random);
    auto list = packed.grains;
    const double dt = step_of<2>(list, {});
    auto bullet = list[1234];
    // It comes after 150 steps, from far to the left, along the row of a grain that is pinned.
    list[1700].pinned = true;
    list[1700].velocity.setZero();
    const Vec<2> target = list[1700].position;
    bullet.velocity = {1000 / dt, 0};
    bullet.position = target - 150.5 * dt * bullet.velocity;
    list.push_back(bullet);
    std::string first;
    for (const int threads : {1, 4}) {
      auto grains = make_grains<2, LinearSpring::needs>(list);
      Setting<2> setting;
      setting.time_step = dt;
      setting.threads = threads;
      Sim<2, LinearSpring> sim(std::move(grains), LawTable<LinearSpring>(elastic()),
                               box<2>(packed.low - Vec<2>(1e9, 0), packed.high), setting);
      const std::string message = said_by(sim, 160, threads > 1);
      CHECK(has(message, "grain 3000 passed through grain "));
      if (first.empty()) first = message;
      CHECK(message == first);
      CHECK(relative_error(number_after(message, "t = "), 151 * dt) < 1e-3);
    }
  }

  TEST_CASE(
      "where many are fast, whoever passes through another is found, and nobody else is told") {
    // Rows that fly through each other in lanes, and one grain in the lane of another.
    const double dt = step_of<2>({ball<2>({0, 0}), ball<2>({9, 0})}, {});
    for (const double way : {0.5, 3.0, 50.0, 1e4}) {
      CAPTURE(way);
      std::vector<Grain<2>> list;
      for (int k = 0; k < 60; ++k) {
        const double sign = k % 2 ? 1 : -1;
        const Vec<2> v(sign * way / dt, 0);
        list.push_back(shot_through<2>({0, 2.01 * k}, v, dt, 5.5));
      }
      CHECK(said<2>(list, {}, 12) == "");
      CHECK(said<2>(list, {}, 12, true) == "");
      auto idle = ball<2>({0, 2.01 * 30});
      list.push_back(idle);
      const std::string message = said<2>(list, {}, 12);
      CHECK(message != "");
      if (way > 4) CHECK(has(message, "grain 30 passed through grain 60 near ("));
      list.pop_back();
      // Head-on in one lane.
      list.push_back(shot_through<2>({0, 2.01 * 30}, -list[30].velocity, dt, 5.5));
      const std::string head_on = said<2>(list, {}, 12);
      CHECK(head_on != "");
      if (way > 4) CHECK(has(head_on, "passed through"));
    }
  }

  TEST_CASE("where overlaps have no limit, nothing is watched") {
    const double dt = step_of<2>({ball<2>({0, 0}), ball<2>({9, 0})}, {});
    const std::vector<Grain<2>> list{ball<2>({0, 0}),
                                     shot_through<2>({0, 0}, Vec<2>(10 / dt, 0), dt)};
    auto grains = make_grains<2, LinearSpring::needs>(list);
    Setting<2> setting;
    setting.time_step = dt;
    setting.largest_overlap = std::numeric_limits<double>::infinity();
    Sim<2, LinearSpring> sim(std::move(grains), LawTable<LinearSpring>(elastic()), {}, setting);
    CHECK(said_by(sim, 10) == "");
  }
}
