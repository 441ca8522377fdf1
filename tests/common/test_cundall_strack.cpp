// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/cundall_strack.hpp>

#include <lagrain/random.hpp>

#include <support/cases.hpp>
#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
Touch<Dim> resting_touch(const Vec<Dim>& normal) {
  Touch<Dim> touch;
  touch.normal = normal;
  touch.overlap = 1e-3;
  touch.effective_mass = 1;
  touch.effective_radius = 1;
  return touch;
}

/// The turn of a rigid body that has spun at omega [rad/s] for t [s].
Eigen::Matrix2d turn_after(const SpinVec<2>& omega, double t) {
  return Eigen::Rotation2Dd(t * omega[0]).toRotationMatrix();
}
Eigen::Matrix3d turn_after(const SpinVec<3>& omega, double t) {
  return Eigen::AngleAxisd(t * omega.norm(), omega.normalized()).toRotationMatrix();
}

}  // namespace

TEST_SUITE("cundall_strack") {
  TEST_CASE_TEMPLATE("a held contact answers as a spring and a dashpot", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    const auto law = make_law<typename C::Law>({.friction = 10, .tangential_damping_ratio = 0.3});
    Touch<C::Dim> touch = resting_touch<C::Dim>(up<C::Dim>());
    touch.slip = 1e-2 * along<C::Dim>();
    typename C::Law::template Memory<C::Dim> memory{};

    Response<C::Dim> response;
    for (int k = 0; k < 100; ++k) response = law.respond(touch, memory, 1e-5);

    const double kt = 2.0 / 7 * law.normal.stiffness;
    const double spring = kt * 100 * 1e-5 * 1e-2;
    const double dashpot = 2 * 0.3 * std::sqrt(kt * 1) * 1e-2;
    CHECK(relative_error(-response.force.dot(along<C::Dim>()), spring + dashpot) < 1e-12);
    CHECK(relative_error(law.elastic_energy(touch, memory),
                         0.5 * law.normal.stiffness * 1e-6 + 0.5 * spring * spring / kt) < 1e-12);
  }

  TEST_CASE_TEMPLATE(
      "a sliding contact carries Coulomb's limit against the slip, and its spring no more", C,
      Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, Case<2, FrictionalHertz>,
      Case<3, FrictionalHertz>) {
    for (const double damping : {0.0, 0.5, 2.0}) {
      CAPTURE(damping);
      const auto law =
          make_law<typename C::Law>({.friction = 0.5, .tangential_damping_ratio = damping});
      Touch<C::Dim> touch = resting_touch<C::Dim>(up<C::Dim>());
      touch.slip = along<C::Dim>();
      typename C::Law::template Memory<C::Dim> memory{};

      Response<C::Dim> response;
      for (int k = 0; k < 1000; ++k) response = law.respond(touch, memory, 1e-4);

      const double limit = 0.5 * law.normal.push(touch, 1e-4).force;
      CHECK((response.force - limit / 0.5 * touch.normal + limit * along<C::Dim>()).norm() <
            1e-13 * limit);
      CHECK(relative_error(
                law.stiffness_ratio * law.normal.stiffness_at(touch) * memory.stretch.norm(),
                limit) < 1e-13);
      CHECK(relative_error(response.friction_loss, limit * 1e-4) < 1e-10);
    }
  }

  TEST_CASE("the spring turns with the contact plane and keeps its length") {
    // A quarter turn in steps of a degree about an axis, as seen by a contact that holds.
    const auto law = make_law<FrictionalSpring>({.friction = 1e9});
    const auto turned = [&](const auto& normal_at, auto memory, auto dim) {
      constexpr int Dim = decltype(dim)::value;
      for (int k = 0; k <= 90; ++k) {
        const Touch<Dim> touch = resting_touch<Dim>(normal_at(k * std::numbers::pi / 180));
        law.respond(touch, memory, 1e-5);
        CHECK(std::abs(memory.stretch.dot(touch.normal)) < 1e-18);
      }
      return memory.stretch;
    };
    const auto in_plane = [](double a) { return Vec<2>(-std::sin(a), std::cos(a)); };
    const auto about_second = [](double a) { return Vec<3>(std::sin(a), 0, std::cos(a)); };

    // 90 projections and scalings, each rounding at 1e-16 of 1e-3.
    CHECK((turned(in_plane, FrictionalSpring::Memory<2>{{1e-3, 0}},
                  std::integral_constant<int, 2>{}) -
           Vec<2>(0, 1e-3))
              .norm() < 1e-16);
    CHECK((turned(about_second, FrictionalSpring::Memory<3>{{1e-3, 0, 0}},
                  std::integral_constant<int, 3>{}) -
           Vec<3>(0, 0, -1e-3))
              .norm() < 1e-16);
    // A stretch along the axis of turning stays where it is.
    CHECK((turned(about_second, FrictionalSpring::Memory<3>{{0, 1e-3, 0}},
                  std::integral_constant<int, 3>{}) -
           Vec<3>(0, 1e-3, 0))
              .norm() < 1e-16);
  }

  TEST_CASE_TEMPLATE("the force of two grains that turn as one rigid body turns with them", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>,
                     Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    const auto law = make_law<typename C::Law>({.friction = 1e9});
    Random random(11);
    for (int k = 0; k < cases(10, 200); ++k) {
      CAPTURE(k);
      // About any axis: a contact both tilts and twists.
      SpinVec<Dim> omega;
      Vec<Dim> normal;
      Vec<Dim> stretch;
      for (int d = 0; d < kSpinDim<Dim>; ++d) omega[d] = 2 * random.normal();
      for (int d = 0; d < Dim; ++d) normal[d] = random.normal(), stretch[d] = random.normal();
      normal.normalize();
      stretch = 1e-3 * (stretch - stretch.dot(normal) * normal).normalized();
      typename C::Law::template Memory<Dim> memory{stretch};
      if constexpr (memory.kStiffness) {
        memory.stiffness =
            law.stiffness_ratio * law.normal.stiffness_at(resting_touch<Dim>(normal));
      }
      const double dt = 1e-4;
      constexpr int kSteps = 10000;

      Response<Dim> response;
      const auto first = law.respond(resting_touch<Dim>(normal), memory, 0.0).force.eval();
      for (int step = 1; step <= kSteps; ++step) {
        Touch<Dim> touch = resting_touch<Dim>(turn_after(omega, step * dt) * normal);
        touch.twist = about(touch.normal, omega);
        response = law.respond(touch, memory, dt);
      }

      const auto turn = turn_after(omega, kSteps * dt);
      CHECK(relative_error(memory.stretch.norm(), 1e-3) < 1e-11);
      // Each step errs by at most (omega dt)^2 / 4 in direction.
      const double angle = 0.25 * omega.squaredNorm() * dt * dt * kSteps;
      CHECK((memory.stretch - turn * stretch).norm() < 1e-3 * (angle + 1e-11));
      CHECK((response.force - turn * first).norm() < first.norm() * (angle + 1e-11));
    }
  }

  TEST_CASE_TEMPLATE("a contact twists with the mean spin of its two grains; a wall does not turn",
                     C, Case<2, FrictionalSpring>, Case<3, FrictionalSpring>) {
    constexpr int Dim = C::Dim;
    Grain<Dim> a;
    a.radius = a.mass = 1;
    a.position = 0.999 * up<Dim>();
    Grain<Dim> b = a;
    b.position = 2.998 * up<Dim>();
    for (int d = 0; d < kSpinDim<Dim>; ++d) a.omega[d] = 2 + d, b.omega[d] = 6 - d;
    const auto floor = Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>());
    const auto sim =
        make_sim<Dim>(std::vector<Grain<Dim>>{a, b}, make_law<FrictionalSpring>({}), {floor}, 1);

    int seen = 0;
    const auto check = [&](const Touch<Dim>& touch, const SpinVec<Dim>& mean) {
      ++seen;
      CHECK((touch.twist - about(up<Dim>(), mean)).norm() < 1e-15);
      if (Dim == 2) CHECK(touch.twist.isZero(0));
    };
    sim.for_each_contact([&](auto, const Touch<Dim>& touch, const auto&, const auto&) {
      check(touch, 0.5 * (a.omega + b.omega));
    });
    sim.for_each_wall_contact([&](auto, const Touch<Dim>& touch, const auto&, const auto&) {
      check(touch, 0.5 * a.omega);
    });
    CHECK(seen == 2);
  }

  TEST_CASE_TEMPLATE("no closed path of overlap and slip gains energy", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, Case<2, FrictionalHertz>,
                     Case<3, FrictionalHertz>) {
    constexpr int Dim = C::Dim;
    Random random(17);
    for (int k = 0; k < cases(200, 5000); ++k) {
      CAPTURE(k);
      // So much friction that nothing slides, or little.
      const auto law = make_law<typename C::Law>({.friction = k % 2 == 0 ? 1e9 : 0.3});
      constexpr int kSteps = 400;
      const double dt = 1e-3;
      // Two harmonics each, about a stretch of their own.
      std::array<double, 4> a, b;
      for (double& x : a) x = random.uniform(-1, 1);
      for (double& x : b) x = random.uniform(-1, 1);
      const auto harmonics = [](const std::array<double, 4>& c, double t) {
        const double angle = 2 * std::numbers::pi * t;
        return c[0] * std::cos(angle) + c[1] * std::sin(angle) + c[2] * std::cos(2 * angle) +
               c[3] * std::sin(2 * angle);
      };
      const auto overlap = [&](double t) { return 1e-3 * (1 + 0.24 * harmonics(a, t)); };
      const auto place = [&](double t) { return 1e-3 * harmonics(b, t); };
      typename C::Law::template Memory<Dim> memory{};
      double taken = 0, losses = 0, start = 0;
      // Of a spring stretched by a millimetre, to measure rounding by.
      const double round = 1e-12 * 1e-6 * law.normal.stiffness_at(resting_touch<Dim>(up<Dim>()));
      for (int step = 0; step < 3 * kSteps; ++step) {
        const double t = static_cast<double>(step) / kSteps, h = 1.0 / kSteps;
        Touch<Dim> touch = resting_touch<Dim>(up<Dim>());
        touch.overlap = overlap(t);
        touch.closing = (overlap(t) - overlap(t - h)) / dt;
        touch.slip = (place(t + h / 2) - place(t - h / 2)) / dt * along<Dim>();
        const auto tangential_energy = [&] {
          return law.elastic_energy(touch, memory) - law.normal.elastic_energy(touch, NoMemory{});
        };
        const Response<Dim> response = law.respond(touch, memory, dt);
        // The first turns settle where the spring swings.
        if (step < kSteps) {
          start = tangential_energy();
          continue;
        }
        const double loss = response.friction_loss;
        CHECK(loss >= -round);
        losses += loss;
        taken -=
            dt * (response.force - response.force.dot(touch.normal) * touch.normal).dot(touch.slip);
        CHECK(std::abs(start + taken - losses - tangential_energy()) <= round);
      }
      // No more comes out than what the spring held.
      CHECK(taken >= -start - round);
      if (k % 2 == 0 && !law.normal.kConstantStiffness) CHECK(losses > 0);
    }
  }

  TEST_CASE_TEMPLATE("without friction there is no tangential force, nor memory of one", C,
                     Case<2, FrictionalSpring>, Case<3, FrictionalHertz>) {
    const auto law = make_law<typename C::Law>({.friction = 0, .tangential_damping_ratio = 1});
    Touch<C::Dim> touch = resting_touch<C::Dim>(up<C::Dim>());
    touch.slip = along<C::Dim>();
    typename C::Law::template Memory<C::Dim> memory{};

    const Response<C::Dim> response = law.respond(touch, memory, 1e-4);

    CHECK(response.force.dot(along<C::Dim>()) == 0);
    CHECK(memory.stretch.isZero(0));
  }
}
