// SPDX-License-Identifier: GPL-3.0-or-later
// Hard cases: every one runs right or stops with an error that says whose fault it is. None may
// crash, hang, lose a grain or go on with what is no number.

#include "hard_cases.hpp"

#include <lagrain/scene.hpp>

#include <support/cases.hpp>
#include <support/files.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

using namespace lagrain;
using namespace lagrain::hard_cases;
using namespace lagrain::test;

namespace {

void check_ran(const Outcome& outcome) {
  CHECK(outcome.stopped == "");
  CHECK(outcome.audited > 0);
  CHECK(outcome.missed == 0);
  CHECK(outcome.lost == 0);
}

void says(const std::string& message, const std::string& part) {
  CAPTURE(message);
  CAPTURE(part);
  CHECK(message.find(part) != std::string::npos);
}

}  // namespace

TEST_SUITE("hard cases at rest") {
  TEST_CASE("perfect lattices rest on their springs at the safe step, without new neighbours") {
    for (const Crystal kind : {Crystal::square, Crystal::hexagonal, Crystal::face_centred}) {
      CAPTURE(static_cast<int>(kind));

      const CrystalAtRest crystal = crystal_at_rest(kind);

      check_ran(crystal);
      CHECK(crystal.contacts == crystal.brute_force);
      CHECK(crystal.contacts > crystal.grains);
      CHECK(crystal.strangers == 0);
      CHECK(crystal.floor_error < 1e-9);
      // Clapeyron's theorem holds to first order in the moves; grains that leave their places would
      // break it.
      CHECK(crystal.move < 1e-3);
      CHECK(relative_error(crystal.sink, crystal.explained) < crystal.move);
    }
  }

  TEST_CASE("the grains of a square lattice sink as columns of springs do") {
    const CrystalAtRest crystal = crystal_at_rest(Crystal::square);

    // Ten contacts below the highest disc carry 10, 9, ..., 1 weights, each of which is 1e-5 r.
    CHECK(relative_error(crystal.move, 55 * 1e-5) < 1e-8);
  }

  TEST_CASE("in a tower of 100 discs every contact carries the weight above it") {
    const std::int64_t steps = cases(300000, 1200000);

    const Tower tall = tower(100, steps);

    check_ran(tall);
    REQUIRE(tall.force.size() == 100);
    // A load put on at once excites the slowest mode by 4 / pi of it. What its decay leaves, and
    // the last bits of the places.
    const double left = 4 / std::numbers::pi * std::exp(-tall.decay * static_cast<double>(steps));
    CHECK(tall.samples.back().error < left + tall.last_bit);
    CHECK(tall.samples.front().error > 0.1);  // it was not at rest at first
  }

  TEST_CASE("a tower of 20 discs comes to rest to the last bit of its places") {
    const Tower low = tower(20, 70000);

    check_ran(low);
    CHECK(low.decay * 70000 > std::log(1 / low.last_bit));
    CHECK(low.samples.back().error < 2 * low.last_bit);
  }

  TEST_CASE_TEMPLATE("a grain of 1,000 times their density rests on light ones", S, Space<2>,
                     Space<3>) {
    const HeavyOnLight pile = heavy_on_light<S::Dim>();

    check_ran(pile);
    // Put down at once, it starts with a swing as large as its weight.
    CHECK(pile.floor_error < 2 * std::exp(-pile.decay * static_cast<double>(pile.steps)) + 1e-12);
    // Overlaps tilt the contacts, to first order.
    CHECK(pile.overlap < 1e-4);
    CHECK(pile.wall_error < 3 * pile.overlap);
  }

  TEST_CASE("dust of a thousandth of its size lies beneath a giant's flank") {
    const GiantAndDust cleft = giant_and_dust();

    check_ran(cleft);
    CHECK(cleft.giant_contacts > 0);
    CHECK(cleft.overlap < 0.05);
    CHECK(cleft.giant_move < 1e-3);
    // A collision errs by (omega dt)^2 / 4 of its energy at most where it begins and where it ends;
    // a step is 1/25 of the contact.
    CHECK(std::abs(cleft.residual) < 2 * std::pow(std::numbers::pi / 25, 2) / 4);
  }

  TEST_CASE("a tiny disc wedged between giants presses them apart as the closed form says") {
    const Wedge wedge = tiny_disc_between_giants();

    check_ran(wedge);
    CHECK(wedge.closed_form > 11);
    // Places about 2 m from the origin have last bits of 4.4e-16 m: 5e-9 of this overlap.
    CHECK(relative_error(wedge.force, wedge.closed_form) < 4.4e-16 / (wedge.overlap * 1e-3));
  }
}

TEST_SUITE("hard cases of degenerate places") {
  TEST_CASE_TEMPLATE("grains in a row hand on speed and momentum, and stay in the row", S, Space<2>,
                     Space<3>) {
    for (const bool slanted : {false, true}) {
      CAPTURE(slanted);

      const Row row = row_of_grains<S::Dim>(slanted);

      check_ran(row);
      CHECK(std::abs(row.speed - 1) < row.bound);
      CHECK(row.momentum < 1e-16 * static_cast<double>(row.steps));
      // On the diagonal places are rounded: 42 radii of 0.01 m to 5.6e-17 m, or 5.6e-15 r.
      CHECK(row.sideways <= (slanted ? 1e-13 : 0));
    }
  }

  TEST_CASE_TEMPLATE("grains in one place are refused, or part without a division by zero", S,
                     Space<2>, Space<3>) {
    const OnePlace place = all_in_one_place<S::Dim>();

    says(place.refused, "grain[1]: overlaps grain[0] by 200 %");
    says(place.stopped, "t = 0 s: grain 0 overlaps grain 1 by 2 of the smaller radius");
    check_ran(place.free);
    CHECK(place.pairs == place.grains * (place.grains - 1) / 2);
    CHECK(place.momentum < 1e-16 * static_cast<double>(place.free.steps));
    CHECK(place.separation > 1);
  }

  TEST_CASE("a million radii from the origin a crystal rests as at the origin") {
    const FarAway crystal = far_from_origin(1e6);

    check_ran(crystal);
    CHECK(crystal.overlap_error < crystal.bound);
    CHECK(crystal.overlap_error > 0);
  }

  TEST_CASE("discs of a micrometre, a millimetre and a metre bounce off one of a kilometre") {
    const Scales scales = nine_decades_of_radii(cases(30000, 3000000));

    check_ran(scales);
    REQUIRE(scales.bounces.size() == 3);
    for (const Bounce& bounce : scales.bounces) {
      CAPTURE(bounce.radius);
      CHECK(bounce.speed_error < bounce.bound);
    }
    CHECK(scales.bounces[0].over);
  }
}

TEST_SUITE("hard cases of speed and step") {
  TEST_CASE("a fast disc bounces, or is stopped in the step in which it goes too deep or passes") {
    for (const double way : {0.02, 0.05, 1.0, 3.0, 4.0, 10.0, 100.0}) {
      CAPTURE(way);

      const FastGrain shots = fast_grain(way, 64);

      CHECK(shots.missed == 0);
      CHECK(shots.lost == 0);
      CHECK(shots.unseen == 0);
      CHECK(shots.bounced + shots.refused + shots.crossed == shots.shots);
      CHECK(shots.bounced == (way < shots.bounce_up_to ? 64 : 0));
      // The phases are spread evenly: the count is off by less than one.
      CHECK(std::abs(shots.crossed - 64 * shots.expected) < 1);
      if (shots.refused > 0) says(shots.refusal, "grain 0 overlaps grain 1");
      if (shots.crossed > 0) says(shots.passage, "grain 1 passed through grain 0 near (");
    }
  }

  TEST_CASE("the safe step is accepted and right; a larger one is refused, with the safe one") {
    CHECK(refusal_of_step(1) == "");
    for (const double steps : {1.001, 2.0, 4.0}) {
      const std::string refusal = refusal_of_step(steps);
      says(refusal, "time_step: ");
      says(refusal, "allows at most ");
    }
    const StepSize safe = collisions_at_step(1);
    CHECK(safe.stopped == "");
    CHECK(safe.missed == 0);
    // (omega dt)^2 / 4 where a linear contact opens or closes, and Hertz's is softer there.
    CHECK(safe.energy_error < std::pow(0.1 * std::numbers::pi, 2) / 4);
  }

  TEST_CASE("beyond the safe step, if the run is deceived, collisions lose their energy's digits") {
    double last = 0;
    for (const double steps : {0.25, 1.0, 4.0, 8.0}) {
      CAPTURE(steps);
      const StepSize size = collisions_at_step(steps);
      CHECK(size.stopped == "");
      CHECK(size.energy_error > 4 * last);  // second order at least
      last = size.energy_error;
    }
    CHECK(last > 1);  // at 8 safe steps energy comes from nowhere
  }
}

TEST_SUITE("hard cases of long runs") {
  TEST_CASE("a pile with elastic friction stands still to the last bit") {
    const Pile heap = pile(FrictionModel::elastic, cases(120000, 1000000));

    check_ran(heap);
    CHECK(heap.drift < heap.crawl * heap.drift_seconds);
    CHECK(heap.samples.back().kinetic < heap.rounding_floor);
    CHECK(heap.unbalanced < 1e-9);
    // It is a heap: higher than a layer.
    CHECK(heap.samples.back().top > 0.05);
  }

  TEST_CASE("a pile with viscous friction creeps") {
    const Pile heap = pile(FrictionModel::viscous, 150000);

    check_ran(heap);
    CHECK(heap.drift > 0.01 * heap.creep * heap.drift_seconds);
    CHECK(heap.samples.back().kinetic > 1e6 * heap.rounding_floor);
  }

  TEST_CASE("an elastic gas keeps its grains and, but for a random walk, its energy") {
    const Gas gas = elastic_gas(cases(1000000, 10000000));

    check_ran(gas);
    CHECK(gas.collisions > 1000);
    double largest = 0;
    for (const GasSample& s : gas.samples) largest = std::max(largest, std::abs(s.drift));
    // Four standard deviations, and what open contacts hold.
    CHECK(largest < 4 * gas.random_walk + gas.open_contacts);
  }
}

TEST_SUITE("hard cases that must stop") {
  TEST_CASE("a number that is none is refused, or found where it arises, and the rest is kept") {
    const Folder folder;

    const NotANumber nan = not_a_number(folder.path);

    says(nan.in_file, "scene.toml:");
    says(nan.in_file, "grain[0].position: expected a length [m], got nan");
    says(nan.in_program, "grain 5: position, velocity or spin is not a number");
    says(nan.overflow.stopped, "t = ");
    says(nan.overflow.stopped, "grain 5 has a place or velocity that is not a number");
    says(nan.overflow.stopped, "last.csv");
    CHECK(nan.overflow.missed == 0);
    CHECK(nan.last_is_sound);
    check_ran(nan.huge);
  }

  TEST_CASE("a lid too fast and a floor too soft end the run, which names the grain and the wall") {
    const PushedThrough walls = pushed_through_walls();

    says(walls.lid.stopped, "grain ");
    says(walls.lid.stopped, "overlaps wall lid by 0.3");
    says(walls.soft_floor.stopped, "overlaps wall floor by 0.3");
    for (const Outcome& outcome : {walls.lid, walls.soft_floor}) {
      CHECK(outcome.audited > 0);
      CHECK(outcome.missed == 0);
      CHECK(outcome.lost == 0);
    }
  }

  TEST_CASE(
      "a box that shrinks ends the run once its grains are jammed, and keeps the last state") {
    const Folder folder;

    const Shrinking box = shrinking_box(folder.path);

    says(box.stopped, "overlaps");
    says(box.stopped, "largest_overlap is 0.3");
    says(box.stopped, "last.csv");
    CHECK(box.audited > 0);
    CHECK(box.missed == 0);
    CHECK(box.lost == 0);
    CHECK(box.last_is_sound);
    // Discs of unlike sizes jam at about 0.84; with overlaps of 0.3 r everywhere it would be more
    // than that over (1 - 0.15)^2.
    CHECK(box.jammed > 0.84);
    CHECK(box.jammed < 0.84 / (0.85 * 0.85));
  }
}
