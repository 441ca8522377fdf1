// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Rolling resistance against closed forms, after the cases of Ai, Chen, Rotter & Ooi, Powder
/// Technol. 206 (2011) 269.
#include <lagrain/rolling_resistance.hpp>

#include <lagrain/cell_grid.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/random.hpp>

#include <support/cases.hpp>
#include <support/on_plane.hpp>
#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

#define ROLLING_LAWS \
  Case<2, RollingSpring>, Case<3, RollingSpring>, Case<2, RollingHertz>, Case<3, RollingHertz>

namespace {

constexpr double kRolling = 0.1;  // mu_r

Material rough_rubber(double friction = 0.5) {
  Material m = kRubber;
  m.friction = friction;
  m.rolling_friction = kRolling;
  return m;
}

/// k_r [N m] of a grain on a plane at a depth [m].
template <int Dim, class Law>
double rolling_stiffness(const Law& law, double overlap) {
  Touch<Dim> touch;
  touch.overlap = overlap;
  touch.effective_radius = 1;
  return law.stiffness_ratio * normal_of(law).stiffness_at(touch);
}

/// A contact as its law sees it, with nothing but numbers in general position.
template <int Dim>
Touch<Dim> some_touch(Random& random) {
  Touch<Dim> touch;
  touch.overlap = random.uniform(0.5e-3, 2e-3);
  touch.normal = oblique<Dim>();
  touch.closing = random.uniform(-1, 1);
  for (double& c : touch.slip) c = random.normal();
  touch.slip -= touch.slip.dot(touch.normal) * touch.normal;
  for (double& c : touch.relative_spin) c = random.normal();
  SpinVec<Dim> mean;
  for (double& c : mean) c = random.normal();
  touch.twist = about(touch.normal, mean);
  touch.effective_mass = 1;
  touch.effective_radius = 0.5;
  return touch;
}

/// Two harmonics with random amplitudes.
class Harmonics {
 public:
  explicit Harmonics(Random& random) {
    for (double& c : c_) c = random.uniform(-1, 1);
  }
  double operator()(double turn) const {
    const double angle = 2 * std::numbers::pi * turn;
    return c_[0] * std::cos(angle) + c_[1] * std::sin(angle) + c_[2] * std::cos(2 * angle) +
           c_[3] * std::sin(2 * angle);
  }

 private:
  std::array<double, 4> c_;
};

/// A column of discs that has fallen apart on a floor of pinned discs.
struct FallenColumn {
  double height = 0;   ///< of the highest disc above the floor [m]
  double kinetic = 0;  ///< at the end [J]
  double largest = 0;  ///< kinetic energy on the way [J]
  double drift = 0;    ///< of any disc in the last quarter [m]
  double balance = 0;  ///< residual of the ledger, of what was turned over [-]
};

template <class Law>
FallenColumn let_fall(const Law& law, double duration) {
  constexpr int kFloor = 100, kAcross = 8, kLayers = 25;
  constexpr double kMass = 0.8, kRadius = 0.01;
  std::vector<Grain<2>> list;
  for (int k = 0; k < kFloor; ++k) {
    list.push_back(
        {.position = {2 * kRadius * k, 0}, .radius = kRadius, .mass = kMass, .pinned = true});
  }
  Random random(4);
  const double middle = kRadius * (kFloor - 1);
  for (int k = 0; k < kAcross * kLayers; ++k) {
    const double radius = kRadius * random.uniform(0.8, 1);
    const double x = 2.05 * kRadius * (k % kAcross - 0.5 * (kAcross - 1));
    const double y = 2.05 * kRadius * (1 + k / kAcross);
    list.push_back({.position = {middle + x, y},
                    .radius = radius,
                    .mass = kMass * radius * radius / (kRadius * kRadius)});
  }
  auto sim = make_sim<2, Law, CellGrid<2>>(list, law, {}, 2, -9.81 * up<2>());
  const Ledger start = energy_ledger(sim);
  FallenColumn result;
  Columns<2> then;
  while (sim.time() < duration) {
    if (sim.time() < 0.75 * duration) then = sim.grains().position;
    sim.step(100);
    result.largest = std::max(result.largest, kinetic_energy(sim.grains()));
  }
  const Ledger end = energy_ledger(sim);
  result.height = sim.grains().position.row(1).maxCoeff();
  result.kinetic = end.kinetic;
  result.drift = (sim.grains().position - then).colwise().norm().maxCoeff();
  result.balance = std::abs(residual(end, start)) / (end.dashpot + end.friction);
  return result;
}

}  // namespace

TEST_SUITE("rolling_resistance") {
  TEST_CASE_TEMPLATE("a grain that rolls comes to rest after v^2 (1 + I / m r^2) / (2 mu_r g)", C,
                     ROLLING_LAWS) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(rough_rubber());
    const double arm = OnPlane<Dim, typename C::Law>(law, 0, 0, 0).arm;
    OnPlane<Dim, typename C::Law> grain(law, 0, 1, 1 / arm);
    const double c = inertia_factor<Dim>(arm);
    // The moment is mu_r r f_n with the radius, 1 m, and acts about the plane.
    const double slowing = kRolling * kGravity / arm / (1 + c);
    const double duration = 1 / slowing;

    grain.run(0.5 * duration);
    CHECK(relative_error(grain.speed(), 1 - slowing * grain.sim.time()) < 1e-3);
    CHECK(relative_error(grain.spin() * arm, grain.speed()) < 1e-4);
    grain.run(0.5 * duration + 1);

    // The springs are loaded on the way, rolled or stretched by so much.
    const double rolled = kRolling * kGravity / rolling_stiffness<Dim>(law, 1 - arm);
    const double slack = 3 * (rolled + grain.sim.setting().time_step);
    CHECK(std::abs(grain.place() - 1 / (2 * slowing)) < slack);
    CHECK(std::abs(grain.speed()) < 1e-8);
    CHECK(std::abs(grain.spin()) < 1e-8);
  }

  TEST_CASE_TEMPLATE("a grain holds on a slope below tan = mu_r, and rolls down above it", C,
                     ROLLING_LAWS) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(rough_rubber());
    for (const double factor : {0.5, 0.97, 1.03, 3.0}) {
      CAPTURE(factor);
      const double slope = std::atan(factor * kRolling);
      OnPlane<Dim, typename C::Law> grain(law, slope, 0, 0);
      grain.run(1);
      const double from = grain.speed(), start = grain.sim.time();
      const double place = grain.place();

      grain.run(0.5);

      if (factor < 1) {
        CHECK(std::abs(grain.speed()) < 1e-9);
        CHECK(std::abs(grain.place() - place) < 1e-9);
        continue;
      }
      const double pull = kGravity * (std::sin(slope) - kRolling * std::cos(slope) / grain.arm);
      const double t = grain.sim.time() - start;
      CHECK(relative_error((grain.speed() - from) / t,
                           pull / (1 + inertia_factor<Dim>(grain.arm))) < 1e-7);
      CHECK(relative_error(grain.spin() * grain.arm, grain.speed()) < 1e-3);
    }
  }

  TEST_CASE_TEMPLATE("below the limit a contact rolls to and fro at sqrt(k_r / (I + m r^2))", C,
                     ROLLING_LAWS) {
    constexpr int Dim = C::Dim;
    constexpr double kZeta = 0.1, kSpeed = 1e-3;
    Material material = rough_rubber();
    // So soft that the tangential spring is stiff beside it.
    material.rolling_stiffness_ratio = 1e-3;
    material.rolling_damping_ratio = kZeta;
    const auto law = make_law<typename C::Law>(material);
    const double arm = OnPlane<Dim, typename C::Law>(law, 0, 0, 0).arm;
    OnPlane<Dim, typename C::Law> grain(law, 0, kSpeed, kSpeed / arm, 10);
    const double omega =
        std::sqrt(rolling_stiffness<Dim>(law, 1 - arm) / (1 + inertia_factor<Dim>(arm))) / arm;
    const double damped = std::sqrt(1 - kZeta * kZeta);

    // One period: the grain passes its first place twice.
    int passed = 0;
    double before = 0, crossed = 0;
    while (passed < 2) {
      before = grain.place();
      grain.sim.step();
      const double now = grain.place();
      if (before * now >= 0) continue;
      ++passed;
      crossed = grain.sim.time() - now / (now - before) * grain.sim.setting().time_step;
    }

    CHECK(relative_error(crossed * omega * damped, 2 * std::numbers::pi) < 5e-3);
    CHECK(relative_error(-std::log(grain.speed() / kSpeed), 2 * std::numbers::pi * kZeta / damped) <
          2e-2);
  }

  TEST_CASE_TEMPLATE("a sphere that twists on a plane stops after I omega / (mu_t r f_n)", Law,
                     RollingSpring, RollingHertz) {
    constexpr double kTwisting = 0.02, kSpin = 2;
    Material material = rough_rubber();
    material.twisting_friction = kTwisting;
    const auto law = make_law<Law>(material);
    Grain<3> sphere;
    sphere.radius = sphere.mass = 1;
    sphere.position = (1 - static_overlap<3>(normal_of(law), 1, kGravity)) * up<3>();
    sphere.omega = kSpin * up<3>();
    auto sim = make_sim<3>(std::vector<Grain<3>>{sphere}, law,
                           {Wall<3>::half_space("plane", Vec<3>::Zero(), up<3>())}, 1,
                           -kGravity * up<3>());
    const double slowing = kTwisting * kGravity / 0.4;
    const auto run_until = [&](double time) {
      while (sim.time() < time) sim.step();
    };

    run_until(0.75 * kSpin / slowing);
    CHECK(relative_error(sim.grains().omega(2, 0), kSpin - slowing * sim.time()) < 1e-2);
    run_until(kSpin / slowing + 0.5);
    CHECK(sim.grains().omega.col(0).norm() < 1e-8);
    // It neither rolled nor slid.
    CHECK((sim.grains().position.col(0) - sphere.position).norm() < 1e-12);

    material.twisting_friction = 0;
    auto free = make_sim<3>(std::vector<Grain<3>>{sphere}, make_law<Law>(material),
                            {Wall<3>::half_space("plane", Vec<3>::Zero(), up<3>())}, 1,
                            -kGravity * up<3>());
    for (int k = 0; k < 1000; ++k) free.step();
    CHECK(free.grains().omega(2, 0) == kSpin);
  }

  TEST_CASE_TEMPLATE("two grains conserve momentum and angular momentum, whoever is first", C,
                     ROLLING_LAWS) {
    constexpr int Dim = C::Dim;
    Material material = rough_rubber(5);
    material.twisting_friction = 0.3;
    const auto law = make_law<typename C::Law>(material);
    Random random(3);
    for (int k = 0; k < 5; ++k) {
      CAPTURE(k);
      std::vector<Grain<Dim>> pair(2);
      for (auto& g : pair) {
        g.radius = random.uniform(0.5, 1);
        g.mass = random.uniform(0.5, 2);
        for (double& c : g.omega) c = 3 * random.normal();
      }
      pair[0].position = 0.9999 * (pair[0].radius + pair[1].radius) * oblique<Dim>();
      pair[0].velocity = 0.3 * along<Dim>() - oblique<Dim>();
      auto sim = make_sim<Dim>(pair, law, {}, 4);
      auto reversed = make_sim<Dim>(std::vector<Grain<Dim>>{pair[1], pair[0]}, law, {}, 4);
      const Vec<Dim> momentum_before = momentum(sim.grains());
      const SpinVec<Dim> before = angular_momentum(sim.grains());

      double moment = 0;
      for (int step = 0; step < 25; ++step) {
        sim.step();
        reversed.step();
        sim.for_each_contact([&](auto, const auto&, const Response<Dim>& response, const auto&) {
          moment = std::max(moment, response.moment.norm());
        });
      }

      CHECK(moment > 1);
      CHECK((momentum(sim.grains()) - momentum_before).norm() < 1e-13);
      CHECK((angular_momentum(sim.grains()) - before).norm() < 1e-13 * (1 + before.norm()));
      CHECK((sim.grains().omega.col(0) - pair[0].omega).norm() > 0.1);
      CHECK((sim.grains().omega.col(0) - reversed.grains().omega.col(1)).norm() < 1e-12);
      CHECK((sim.grains().velocity.col(1) - reversed.grains().velocity.col(0)).norm() < 1e-12);
    }
  }

  TEST_CASE_TEMPLATE("the partner sees the opposite force and moment", C, ROLLING_LAWS) {
    constexpr int Dim = C::Dim;
    Material material = rough_rubber();
    material.twisting_friction = 0.2;
    const auto law = make_law<typename C::Law>(material);
    Random random(8);
    const Touch<Dim> here = some_touch<Dim>(random);
    Touch<Dim> there = here;
    there.normal = -here.normal;
    there.slip = -here.slip;
    there.relative_spin = -here.relative_spin;
    typename C::Law::template Memory<Dim> memory{};
    for (int k = 0; k < 5; ++k) law.respond(here, memory, 1e-5);
    auto theirs = memory.seen_from_partner();

    const Response<Dim> a = law.respond(here, memory, 1e-5);
    const Response<Dim> b = law.respond(there, theirs, 1e-5);

    CHECK(a.moment.norm() > 0);
    CHECK(a.force == -b.force);
    CHECK(a.moment == -b.moment);
    CHECK(a.friction_loss == b.friction_loss);
    CHECK(memory.seen_from_partner() == theirs);
    CHECK(law.elastic_energy(here, memory) == law.elastic_energy(there, theirs));
  }

  TEST_CASE_TEMPLATE("who only looks changes nothing, and each coefficient has its own limit", C,
                     ROLLING_LAWS) {
    constexpr int Dim = C::Dim;
    Material material = rough_rubber();
    material.twisting_friction = 0.03;
    const auto law = make_law<typename C::Law>(material);
    Random random(9);
    Touch<Dim> touch = some_touch<Dim>(random);
    touch.closing = 0;
    touch.twist.setZero();
    typename C::Law::template Memory<Dim> memory{};
    Response<Dim> response;
    for (int k = 0; k < 1000; ++k) response = law.respond(touch, memory, 1e-3);
    const auto past = memory;
    const double lever = 0.5 * response.force.dot(touch.normal);

    const Response<Dim> look = law.respond(touch, memory, 0);

    CHECK(memory == past);
    CHECK((look.moment - response.moment).norm() < 1e-12 * response.moment.norm());
    CHECK(std::abs(look.friction_loss) < 1e-16);
    const SpinVec<Dim> twist = about(touch.normal, touch.relative_spin);
    const SpinVec<Dim> roll = touch.relative_spin - twist;
    SpinVec<Dim> limit = -kRolling * lever * roll.normalized();
    if (Dim == 3) limit -= 0.03 * lever * twist.normalized();
    CHECK((response.moment - limit).norm() < 1e-12 * lever);
  }

  TEST_CASE("a rolled spring and a twisted one turn with two spheres that turn as one body") {
    Material material = rough_rubber();
    material.rolling_friction = material.twisting_friction = 1e9;
    const auto law = make_law<RollingSpring>(material);
    const Vec<3> omega(1.5, -0.7, 2), normal = oblique<3>();
    Touch<3> touch;
    touch.overlap = 1e-3;
    touch.normal = normal;
    touch.effective_mass = touch.effective_radius = 1;
    RollingSpring::Memory<3> memory{};
    memory.rolled = 1e-3 * normal.unitOrthogonal();
    memory.twisted = 2e-3;
    const Vec<3> first = law.respond(touch, memory, 0).moment;
    const double dt = 1e-4;
    constexpr int kSteps = 10000;

    Response<3> response;
    for (int step = 1; step <= kSteps; ++step) {
      touch.normal = Eigen::AngleAxisd(step * dt * omega.norm(), omega.normalized()) * normal;
      touch.twist = about(touch.normal, omega);
      response = law.respond(touch, memory, dt);
    }

    const Vec<3> turned = Eigen::AngleAxisd(kSteps * dt * omega.norm(), omega.normalized()) * first;
    // Each step errs by at most (omega dt)^2 / 4 in direction.
    CHECK((response.moment - turned).norm() < first.norm() * 0.25 * omega.squaredNorm() * dt);
  }

  TEST_CASE_TEMPLATE("no closed path of overlap and rolling gains energy", C, ROLLING_LAWS) {
    constexpr int Dim = C::Dim;
    Random random(17);
    for (int k = 0; k < cases(100, 3000); ++k) {
      CAPTURE(k);
      Material material;
      // Nothing yields, or much does; with a dashpot or none.
      material.rolling_friction = k % 2 == 0 ? 1e9 : 0.3;
      material.twisting_friction = 0.5 * material.rolling_friction;
      material.rolling_damping_ratio = k % 3 == 0 ? 0 : 0.3;
      const auto law = make_law<typename C::Law>(material);
      constexpr int kSteps = 400;
      const double dt = 1e-3;
      const Harmonics overlap(random);
      std::vector<Harmonics> angle(kSpinDim<Dim>, Harmonics(random));
      for (auto& one : angle) one = Harmonics(random);
      typename C::Law::template Memory<Dim> memory{};
      double taken = 0, losses = 0, start = 0;
      Touch<Dim> touch;
      touch.normal = up<Dim>();
      touch.effective_mass = touch.effective_radius = 1;
      touch.overlap = 1e-3;
      const double round = 1e-12 * 1e-6 * normal_of(law).stiffness_at(touch);
      for (int step = 0; step < 3 * kSteps; ++step) {
        const double t = static_cast<double>(step) / kSteps, h = 1.0 / kSteps;
        touch.overlap = 1e-3 * (1 + 0.24 * overlap(t));
        touch.closing = 0.24e-3 * (overlap(t) - overlap(t - h)) / dt;
        for (std::size_t d = 0; d < kSpinDim<Dim>; ++d) {
          touch.relative_spin[static_cast<int>(d)] =
              1e-3 * (angle[d](t + h / 2) - angle[d](t - h / 2)) / dt;
        }
        const auto rolling_energy = [&] {
          return law.elastic_energy(touch, memory) -
                 law.sliding.elastic_energy(touch, memory.sliding);
        };
        const Response<Dim> response = law.respond(touch, memory, dt);
        // The first turn settles where the springs swing.
        if (step < kSteps) {
          start = rolling_energy();
          continue;
        }
        const double loss = response.friction_loss;
        CHECK(loss >= -round);
        losses += loss;
        taken -= dt * response.moment.dot(touch.relative_spin);
        CHECK(std::abs(start + taken - losses - rolling_energy()) <= round);
      }
      // No more comes out than what the springs held.
      CHECK(taken >= -start - round);
      if (k % 2 == 1) CHECK(losses > 0);
    }
  }

  TEST_CASE_TEMPLATE("without coefficients a grain moves as by friction alone", C,
                     Case<2, RollingSpring>, Case<3, RollingSpring>, Case<3, RollingHertz>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>(kRubber);
    OnPlane<Dim, typename C::Law> rolling(law, 0.3, 0.2, -1, 2);
    const double dt = rolling.sim.setting().time_step;
    using Friction = decltype(law.sliding);
    OnPlane<Dim, Friction> sliding(law.sliding, 0.3, 0.2, -1, 2);
    // Rolling springs that exert nothing still bound the step.
    sliding =
        OnPlane<Dim, Friction>(law.sliding, 0.3, 0.2, -1, 2 * sliding.sim.setting().time_step / dt);
    REQUIRE(relative_error(sliding.sim.setting().time_step, dt) < 1e-15);

    rolling.run(0.1);
    sliding.run(0.1);

    CHECK(relative_error(rolling.place(), sliding.place()) < 1e-12);
    CHECK(relative_error(rolling.spin(), sliding.spin()) < 1e-12);
  }

  TEST_CASE_TEMPLATE("the safe step is safe for the stiffest packing with any rolling spring", C,
                     Case<2, RollingSpring>, Case<3, RollingSpring>) {
    constexpr int Dim = C::Dim;
    // A closest packing whose outer grains are pinned, pressed a little, and all grains turning.
    std::vector<Grain<Dim>> list;
    Random random(2);
    constexpr int kHalf = 4;
    for (int a = -kHalf; a <= kHalf; ++a) {
      for (int b = -kHalf; b <= kHalf; ++b) {
        for (int c = Dim == 2 ? 0 : -kHalf; c <= (Dim == 2 ? 0 : kHalf); ++c) {
          Grain<Dim> g;
          g.radius = g.mass = 1;
          if constexpr (Dim == 2) {
            g.position = 1.998 * Vec<2>(a + 0.5 * b, std::sqrt(0.75) * b);
          } else {
            g.position = 1.998 * std::sqrt(0.5) * Vec<3>(a + b, b + c, c + a);
          }
          const double out = g.position.norm();
          if (out > 2 * kHalf) continue;
          g.pinned = out > 2 * (kHalf - 1);
          for (double& w : g.omega) w = g.pinned ? 0 : 1e-3 * random.normal();
          list.push_back(g);
        }
      }
    }
    for (const double ratio : {0.1, 2.0 / 7, 1.0, 10.0}) {
      for (const double damping : {0.0, 0.3, 2.0}) {
        CAPTURE(ratio);
        CAPTURE(damping);
        const auto law = make_law<typename C::Law>({.friction = 1e9,
                                                    .rolling_friction = 1e9,
                                                    .twisting_friction = 1e9,
                                                    .rolling_stiffness_ratio = ratio,
                                                    .rolling_damping_ratio = damping});
        auto sim = make_sim<Dim>(list, law, {}, 1);
        const double energy = energy_ledger(sim).kinetic;
        for (int k = 0; k < 300; ++k) sim.step();
        CHECK(energy_ledger(sim).kinetic < energy);
      }
    }
  }

  TEST_CASE("a heap on a rough floor comes to rest and stays, steeper than without resistance") {
    Material material{.stiffness = 1e6,
                      .restitution = 0.3,
                      .friction = 0.5,
                      .tangential_damping_ratio = 0.5,
                      .rolling_friction = 0.3};
    const FallenColumn heap = let_fall(make_law<RollingSpring>(material), 4);
    material.rolling_friction = 0;
    const FallenColumn flat = let_fall(make_law<RollingSpring>(material), 2);

    CAPTURE(heap.height);
    CAPTURE(flat.height);
    CHECK(heap.kinetic < 1e-20 * heap.largest);
    CHECK(heap.drift < 1e-9);
    CHECK(heap.height > 1.3 * flat.height);
    CHECK(heap.balance < 0.01);
  }
}
