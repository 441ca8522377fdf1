// SPDX-License-Identifier: GPL-3.0-or-later
#include "plain_dem.hpp"

#include <lagrain/triangulation_neighbourhood.hpp>

#include <support/scenes.hpp>
#include <support/space.hpp>

#include <doctest/doctest.h>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// The same grains in a box, twice.
template <int Dim>
struct Twins {
  PlainDem<Dim> plain;
  Sim<Dim, LinearSpring, TriangulationNeighbourhood<Dim>> sim;
};

/// Close to each other and thrown about, they fall.
template <int Dim>
Twins<Dim> twins(int count) {
  Random random(19);
  const auto packed =
      lattice<Dim>({.count = count, .low = 0.9, .spacing = 0.96, .speed = 3}, random);
  const auto law = LinearSpring::with_restitution(2e4, 0.6);  // [N/m], [-]
  const auto walls = box<Dim>(packed.low, packed.high);
  const Vec<Dim> gravity = -10 * up<Dim>();
  auto sim = make_sim<Dim, LinearSpring, TriangulationNeighbourhood<Dim>>(packed.grains, law, walls,
                                                                          2, gravity);
  const double dt = sim.setting().time_step;
  Twins<Dim> both{{.grains = make_grains<Dim, LinearSpring::needs>(packed.grains),
                   .law = law,
                   .walls = walls,
                   .gravity = gravity,
                   .time_step = dt},
                  std::move(sim)};
  both.plain.construct_triangulation();
  return both;
}

}  // namespace

// Up to 1,024 grains Simulation keeps them in the order of their numbers and in one block. Then it
// adds up a grain's weight, its contacts in the order of their pairs and those with walls, as the
// plain loop does.
TEST_CASE_TEMPLATE("the plain loop and Simulation agree bit for bit", S, Space<2>, Space<3>) {
  constexpr int Dim = S::Dim;
  auto [plain, sim] = twins<Dim>(200);
  std::size_t contacts = 0;
  for (int step = 0; step < 1500; ++step) {
    plain.iterate();
    REQUIRE(plain.grains.velocity == sim.grains().velocity);  // at the beginning of the step
    sim.step();
    REQUIRE(plain.grains.position == sim.grains().position);  // at its end
    contacts += plain.contacts.size();
  }
  CHECK(contacts > 100000);
  CHECK(plain.triangulation.hidden().empty());
}

// Beyond, Simulation keeps them along Hilbert's curve and in several blocks: the same forces are
// summed in another order.
TEST_CASE_TEMPLATE("with many grains they agree to rounding", S, Space<2>, Space<3>) {
  constexpr int Dim = S::Dim;
  auto [plain, sim] = twins<Dim>(2500);
  for (int step = 0; step < 400; ++step) plain.iterate();
  sim.step(400);
  const double radius = 0.9;  // of the smallest grain [m]
  const double apart = (plain.grains.position - sim.grains().position).cwiseAbs().maxCoeff();
  CHECK(plain.contacts.size() > 500);
  CHECK(apart > 0);
  CHECK(apart < 1e-12 * radius);
}
