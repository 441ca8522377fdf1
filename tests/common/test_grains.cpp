// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/grains.hpp>

#include <lagrain/pair_table.hpp>
#include <lagrain/records.hpp>

#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <class G>
concept HasOmega = requires(G g) {
  g.omega;
};
template <class G>
concept HasTorque = requires(G g) {
  g.torque;
};

static_assert(!HasOmega<Grains<2, LinearSpring::needs>> && !HasTorque<Grains<2, Hertz::needs>>);
static_assert(!HasOmega<Grains<3, LinearSpring::needs>> && !HasTorque<Grains<3, Hertz::needs>>);
static_assert(HasOmega<Grains<2, FrictionalSpring::needs>>);
static_assert(HasOmega<Grains<3, ViscousHertz::needs>>);

// A frictionless contact stores nothing either.
template <class Law>
using Contacts = PairTable<Pair, typename Law::template Memory<3>>;
static_assert(Contacts<LinearSpring>::kReals == 0 && Contacts<ViscousSpring>::kReals == 0);
static_assert(Contacts<FrictionalSpring>::kReals == 3);

template <int Dim>
Grain<Dim> unit_grain() {
  Grain<Dim> g;
  g.radius = 1;
  g.mass = 1;
  return g;
}

}  // namespace

TEST_SUITE("grains") {
  TEST_CASE("a grain costs what its model needs") {
    // What contacts read: place, velocity, radius, 1/mass; spin, 1/inertia.
    CHECK(sizeof(GrainRecord<2, LinearSpring::needs>) == 8 * (4 + 2));
    CHECK(sizeof(GrainRecord<3, LinearSpring::needs>) == 8 * (6 + 2));
    CHECK(sizeof(GrainRecord<2, FrictionalSpring::needs>) == 8 * (4 + 2 + 2));
    CHECK(sizeof(GrainRecord<3, FrictionalSpring::needs>) == 8 * (6 + 2 + 4));
    // What they write: force and mass; torque. In fours.
    CHECK(sizeof(LoadRecord<2, LinearSpring::needs>) == 8 * 4);
    CHECK(sizeof(LoadRecord<3, LinearSpring::needs>) == 8 * 4);
    CHECK(sizeof(LoadRecord<2, FrictionalSpring::needs>) == 8 * 4);
    CHECK(sizeof(LoadRecord<3, FrictionalSpring::needs>) == 8 * 8);
    // With the old accelerations, and the place and margin of the near list.
    CHECK(bytes_per_grain<2, LinearSpring::needs>() == 48 + 32 + 24);
    CHECK(bytes_per_grain<3, LinearSpring::needs>() == 64 + 32 + 32);
    CHECK(bytes_per_grain<2, FrictionalSpring::needs>() == 64 + 32 + 24);
    CHECK(bytes_per_grain<3, FrictionalSpring::needs>() == 96 + 64 + 32);
  }

  TEST_CASE("discs are rods of unit depth, spheres are spheres") {
    CHECK(relative_error(grain_volume<2>(2, 3), 12 * std::numbers::pi) < 1e-15);
    CHECK(relative_error(grain_volume<3>(2), 32.0 / 3 * std::numbers::pi) < 1e-15);
    CHECK(relative_error(grain_inertia<2>(3, 2), 6) < 1e-15);
    CHECK(relative_error(grain_inertia<3>(3, 2), 4.8) < 1e-15);
  }

  TEST_CASE_TEMPLATE("a pinned grain has no inverse mass, and says what it weighs", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    Grain<C::Dim> pin = unit_grain<C::Dim>();
    pin.pinned = true;
    const auto g = make_grains<C::Dim, C::Law::needs>({unit_grain<C::Dim>(), pin});

    CHECK(g.inverse_mass[0] == 1);
    CHECK(g.inverse_mass[1] == 0);
    CHECK(g.inverse_inertia[1] == 0);
    CHECK(g.mass[1] == 1);
  }

  TEST_CASE_TEMPLATE("input that no grain can have is refused by name", C, Case<2, LinearSpring>,
                     Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double inf = std::numeric_limits<double>::infinity();
    const auto refused = [](const auto& spoil) {
      std::vector<Grain<Dim>> list(3, unit_grain<Dim>());
      spoil(list[2]);
      CHECK_THROWS_WITH_AS((make_grains<Dim, C::Law::needs>(list)), doctest::Contains("grain 2: "),
                           ContractError);
    };

    for (const double bad : {0.0, -1.0, nan, inf}) {
      refused([&](Grain<Dim>& g) { g.radius = bad; });
      refused([&](Grain<Dim>& g) { g.mass = bad; });
    }
    for (const double bad : {nan, inf, -inf}) {
      refused([&](Grain<Dim>& g) { g.position[Dim - 1] = bad; });
      refused([&](Grain<Dim>& g) { g.velocity[0] = bad; });
      refused([&](Grain<Dim>& g) { g.omega[0] = bad; });
    }
    // The material is stored in a byte.
    refused([](Grain<Dim>& g) { g.material = -1; });
    refused([](Grain<Dim>& g) { g.material = 256; });
    // "It stays": a pinned grain that moves would drive the others without appearing in the ledger.
    refused([](Grain<Dim>& g) { g.pinned = true, g.velocity[0] = 1; });
    refused([](Grain<Dim>& g) { g.pinned = true, g.omega[0] = 1; });
  }

  TEST_CASE("no grains are grains too") {
    const auto g = make_grains<3, FrictionalSpring::needs>({});

    CHECK(g.size() == 0);
  }
}
