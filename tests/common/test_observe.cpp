// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/observe.hpp>

#include <lagrain/cell_grid.hpp>
#include <lagrain/random.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
double fraction_of_one(const Vec<Dim>& centre, double radius, const Vec<Dim>& low,
                       const Vec<Dim>& high) {
  Grain<Dim> g;
  g.radius = radius;
  g.mass = 1;
  g.position = centre;
  const auto grains = make_grains<Dim, Needs{}>(std::vector<Grain<Dim>>{g});
  return solid_fraction(grains, Eigen::AlignedBox<double, Dim>(low, high)) * (high - low).prod();
}

/// What the ledger of a dissipative scene cannot account for: largest residual over the run, in
/// units of the energy that was turned over.
template <int Dim, class Law>
double ledger_error(const MotionScene<Dim>& scene, double refinement) {
  const auto law = make_law<Law>(kGravel);
  auto sim =
      make_sim<Dim, Law, CellGrid<Dim>>(scene.grains, law, scene.walls, refinement, scene.gravity);
  const Ledger start = energy_ledger(sim);
  double worst = 0;
  const int steps = static_cast<int>(1500 * refinement);
  for (int k = 0; k < steps; ++k) {
    sim.step();
    if (k % 20 == 0) worst = std::max(worst, std::abs(residual(energy_ledger(sim), start)));
  }
  const Ledger end = energy_ledger(sim);
  return worst / (end.dashpot + end.friction);
}

/// A settling bed in a box whose floor shakes.
template <int Dim>
MotionScene<Dim> shaken_box(int count, std::uint64_t seed) {
  auto scene = settling_bed<Dim>(count, seed);
  for (auto& wall : scene.walls) wall.motion = Shake<Dim>{0.2 * up<Dim>(), 4};
  return scene;
}

}  // namespace

TEST_SUITE("observe") {
  TEST_CASE("a disc cut by a line, or two, counts by the part inside") {
    const double pi = std::numbers::pi;
    const Vec<2> far(100, 100);
    // Simpson's rule on 200 intervals of h = pi/200: a kink, where the region's side leaves the
    // disc, errs by at most h^2 r^2 / 4 = 6e-5 r^2; without one the rule is exact to 1e-8.
    const double kink = 7e-5 * 4;
    for (const double cut : {-1.5, 0.0, 0.3, 1.9}) {
      CAPTURE(cut);
      const double segment = 4 * std::acos(cut / 2) - cut * std::sqrt(4 - cut * cut);
      const Vec<2> c(7, -3);
      CHECK(std::abs(fraction_of_one<2>(c, 2, c + Vec<2>(cut, -100), c + far) - segment) < kink);
      CHECK(std::abs(fraction_of_one<2>(c, 2, c + Vec<2>(-100, cut), c + far) - segment) < 1e-7);
      CHECK(std::abs(fraction_of_one<2>(c, 2, c - far, c + Vec<2>(100, -cut)) - segment) < 1e-7);
    }
    CHECK(std::abs(fraction_of_one<2>({1, 1}, 2, {1, 1}, {50, 50}) - pi) < kink);
    CHECK(relative_error(fraction_of_one<2>({1, 1}, 2, -far, far), 4 * pi) < 1e-14);
    CHECK(fraction_of_one<2>({1, 1}, 2, {3.5, -50}, far) == 0);
    // A region inside the disc is full; one that cuts a strip out of it is the sum of two halves.
    CHECK(std::abs(fraction_of_one<2>({0, 0}, 2, {-0.5, -0.5}, {0.7, 0.6}) - 1.2 * 1.1) < kink);
  }

  TEST_CASE("a sphere in a corner, on an edge, under a plane counts by the part inside") {
    const double whole = 4.0 / 3 * std::numbers::pi;
    const Vec<3> far(100, 100, 100);
    const double kink = 2e-4;  // as for discs, integrated over the third axis

    CHECK(std::abs(fraction_of_one<3>({5, 6, 7}, 1, {5, 6, 7}, far) - whole / 8) < kink);
    CHECK(std::abs(fraction_of_one<3>({5, 6, 7}, 1, {5, -100, 7}, far) - whole / 4) < kink);
    CHECK(std::abs(fraction_of_one<3>({5, 6, 7}, 1, -far, {5, 100, 100}) - whole / 2) < kink);
    for (const double height : {0.2, 1.0, 1.7}) {
      const double cap = std::numbers::pi * height * height * (3 - height) / 3;
      for (int d = 0; d < 3; ++d) {
        CAPTURE(height);
        CAPTURE(d);
        Vec<3> low = -far;
        low[d] = 1 - height;
        CHECK(std::abs(fraction_of_one<3>({0, 0, 0}, 1, low, far) - cap) < kink);
      }
    }
  }

  TEST_CASE_TEMPLATE("cutting a region in two cuts its solid in two", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(9);
    const auto packed = lattice<Dim>({.count = 60}, random);
    const auto g = make_grains<Dim, Needs{}>(packed.grains);
    const auto solid = [&](double from, double to) {
      Eigen::AlignedBox<double, Dim> region(packed.low, packed.high);
      region.min()[0] = from;
      region.max()[0] = to;
      return solid_fraction(g, region) * region.volume();
    };
    double all = 0;
    for (const auto& grain : packed.grains) all += grain_volume<Dim>(grain.radius);

    CHECK(relative_error(solid(packed.low[0], packed.high[0]), all) < 1e-13);
    const double cut = 0.37 * packed.high[0];
    CHECK(relative_error(solid(packed.low[0], cut) + solid(cut, packed.high[0]), all) < 1e-4);
  }

  TEST_CASE_TEMPLATE("energy and momenta are those of rigid bodies", C, Case<2, FrictionalSpring>,
                     Case<3, FrictionalSpring>, Case<2, LinearSpring>, Case<3, LinearSpring>) {
    constexpr int Dim = C::Dim;
    Grain<Dim> a;
    a.radius = 2;
    a.mass = 3;
    a.position = 4 * up<Dim>();
    a.velocity = 5 * along<Dim>();
    a.omega = 7 * rolling_spin<Dim>();
    Grain<Dim> pin = a;
    pin.pinned = true;
    pin.velocity.setZero();
    pin.omega.setZero();
    const auto g = make_grains<Dim, C::Law::needs>({a, pin});

    const double inertia = (Dim == 2 ? 0.5 : 0.4) * 3 * 4;
    const double spins = C::Law::needs.spin ? 1 : 0;
    CHECK(relative_error(kinetic_energy(g), 0.5 * (3 * 25 + spins * inertia * 49)) < 1e-14);
    CHECK((momentum(g) - 15 * along<Dim>()).norm() < 1e-14);
    // up x along is the axis that rolls along: both parts add.
    CHECK((angular_momentum(g) - (60 + spins * 7 * inertia) * rolling_spin<Dim>()).norm() < 1e-12);
  }

  TEST_CASE_TEMPLATE("contacts are counted for both grains, walls once", C, Case<2, LinearSpring>,
                     Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    std::vector<Grain<Dim>> list(3);
    for (int k = 0; k < 3; ++k) {
      auto& g = list[static_cast<std::size_t>(k)];
      g.radius = k == 1 ? 1 : 2;
      g.mass = 1;
      g.position = (k == 0 ? 0 : k == 1 ? 2.9 : 6.0) * along<Dim>();
    }
    const auto floor = Wall<Dim>::half_space("floor", -1.98 * up<Dim>(), up<Dim>());
    auto sim = make_sim<Dim>(list, make_law<typename C::Law>({}), {floor}, 1);

    const ContactStatistics s = contact_statistics(sim);

    // 0-1 overlaps by 0.1 of a radius of 1, 0 and 2 overlap the floor by 0.02 of a radius of 2.
    CHECK(s.contacts == 1);
    CHECK(s.wall_contacts == 2);
    CHECK(relative_error(s.coordination, 4.0 / 3) < 1e-15);
    CHECK(relative_error(s.largest_overlap, 0.1) < 1e-12);
    CHECK(relative_error(s.mean_overlap, 0.12 / 3) < 1e-12);
  }

  TEST_CASE_TEMPLATE("the ledger of a settling bed closes, and closer with smaller steps", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, FrictionalSpring>,
                     Case<3, FrictionalSpring>, Case<2, ViscousSpring>, Case<3, Hertz>,
                     Case<2, FrictionalHertz>, Case<3, FrictionalHertz>, Case<2, RollingSpring>,
                     Case<3, RollingSpring>, Case<3, RollingHertz>) {
    const auto scene = settling_bed<C::Dim>(64, 3);

    const double coarse = ledger_error<C::Dim, typename C::Law>(scene, 1);
    const double fine = ledger_error<C::Dim, typename C::Law>(scene, 8);

    // Losses are summed with the velocities that integrators predict, which the first force of a
    // contact and the first slide make wrong by a step's change: better than first order. Viscous
    // friction falls more slowly, from a smaller error.
    CHECK(coarse < 0.03);
    CHECK(fine < 1e-3);
    CHECK(observed_order(coarse, fine, 8) >
          (std::is_same_v<typename C::Law, ViscousSpring> ? 1.1 : 1.3));
  }

  TEST_CASE_TEMPLATE("so does the ledger of a shaken box, the walls' work included", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    const auto scene = shaken_box<C::Dim>(64, 4);

    const double coarse = ledger_error<C::Dim, typename C::Law>(scene, 1);
    const double fine = ledger_error<C::Dim, typename C::Law>(scene, 8);

    CHECK(coarse < 0.05);
    CHECK(observed_order(coarse, fine, 8) > 1.3);
  }

  TEST_CASE_TEMPLATE("a gas gains no energy from elastic friction", C, Case<2, FrictionalSpring>,
                     Case<3, FrictionalSpring>, Case<2, FrictionalHertz>,
                     Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    Random random(5);
    const auto packed = lattice<Dim>({.count = Dim == 2 ? 36 : 64, .speed = 1}, random);
    // Hertz's law keeps a stiffness of the spring's size.
    const auto law =
        make_law<typename C::Law>({.stiffness = 1e6, .friction = 1, .impact_speed = 3});
    auto sim = make_sim<Dim>(packed.grains, law, box<Dim>(packed.low, packed.high), 8);
    const double start = energy_ledger(sim).balance();

    double most = 0;
    for (int k = 0; k < 20000; ++k) {
      sim.step();
      if (k % 50 != 0) continue;
      const Ledger now = energy_ledger(sim);
      most = std::max(most, (now.kinetic + now.elastic) / start - 1);
    }
    const Ledger end = energy_ledger(sim);
    CHECK(most < 1e-3);
    CHECK(std::abs(end.balance() / start - 1) < 1e-3);
    // Where the stiffness follows the overlap, springs lose what a path could gain.
    if (!law.normal.kConstantStiffness) CHECK(end.friction > 1e-3 * start);
  }
}
