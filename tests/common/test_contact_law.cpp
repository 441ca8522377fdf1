// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/contact_law.hpp>

#include <lagrain/random.hpp>
#include <lagrain/time_step.hpp>

#include <support/cases.hpp>
#include <support/scenes.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace lagrain;
using namespace lagrain::test;

#define NORMAL_LAWS Case<2, LinearSpring>, Case<3, LinearSpring>, Case<2, Hertz>, Case<3, Hertz>
#define FRICTION_LAWS                                                             \
  Case<2, FrictionalSpring>, Case<3, FrictionalSpring>, Case<2, FrictionalHertz>, \
      Case<3, FrictionalHertz>, Case<2, ViscousSpring>, Case<3, ViscousSpring>,   \
      Case<2, ViscousHertz>, Case<3, ViscousHertz>

namespace {

template <int Dim>
Vec<Dim> random_unit(Random& random) {
  Vec<Dim> n;
  for (int d = 0; d < Dim; ++d) n[d] = random.normal();
  return n.normalized();
}

/// A contact with any direction, any relative motion, and overlaps up to a tenth of a radius.
template <int Dim>
Touch<Dim> random_touch(Random& random) {
  Touch<Dim> touch;
  touch.effective_mass = random.uniform(0.1, 10);
  touch.effective_radius = random.uniform(0.1, 10);
  touch.overlap = 0.1 * touch.effective_radius * random.uniform();
  touch.normal = random_unit<Dim>(random);
  touch.closing = 100 * random.normal();
  const Vec<Dim> any = 100 * random.normal() * random_unit<Dim>(random);
  touch.slip = any - any.dot(touch.normal) * touch.normal;
  return touch;
}

/// A stretch that the contact plane has turned away from by less than 45 degrees.
template <int Dim>
Vec<Dim> random_stretch(const Touch<Dim>& touch, Random& random) {
  Vec<Dim> flat = random_unit<Dim>(random);
  flat -= flat.dot(touch.normal) * touch.normal;
  return 0.01 * random.normal() *
         (flat.normalized() + random.uniform(-1, 1) * touch.normal).normalized();
}

/// A contact that remembers some stretch and, if it follows the overlap, some stiffness.
template <class Law, int Dim>
auto random_memory(const Law& law, const Touch<Dim>& touch, Random& random) {
  typename Law::template Memory<Dim> memory{};
  if constexpr (Law::needs.memory) {
    memory.stretch = random_stretch<Dim>(touch, random);
    if constexpr (memory.kStiffness) {
      memory.stiffness =
          random.uniform(0, 2) * law.stiffness_ratio * law.normal.stiffness_at(touch);
    }
  }
  return memory;
}

/// The refinement of a pair of grains of radius and mass 1 that gives a number of steps to
/// a contact.
template <class Law>
double refinement_for(const Law& law, double steps) {
  const double contact = law.contact_time(0.5, 0.5);
  const double damped = largest_damped_phase(law.damping_ratio) * law.natural_time(0.5, 0.5);
  return steps * std::min(kLargestContactFraction * contact, damped) / contact;
}

/// Root mean square error of the restitution over the places that a first and a last contact can
/// take in a time step. (A contact of a whole number of steps ends as it began, and the errors of a
/// reversible scheme cancel: the steps must differ as well.)
template <int Dim, class Law>
double restitution_error(const Law& law, double wanted, double refinement,
                         const Strike& strike = {}) {
  constexpr int kPhases = 32;
  double sum = 0;
  for (int p = 0; p < kPhases; ++p) {
    const double detuned = refinement * (1 + 0.1 * std::fmod(p * std::numbers::phi, 1.0));
    Strike shot = strike;
    shot.refinement = detuned;
    shot.phase = (p + 0.5) / kPhases;
    const Impact impact = head_on<Dim>(law, shot);
    sum += std::pow(impact.restitution - wanted, 2);
  }
  return std::sqrt(sum / kPhases);
}

}  // namespace

TEST_SUITE("contact_law") {
  TEST_CASE_TEMPLATE("a head-on impact has the restitution that the law names", C, NORMAL_LAWS) {
    constexpr int Dim = C::Dim;
    for (const double e : {1.0, 0.9, 0.5, 0.2, 0.05}) {
      const auto law = make_law<typename C::Law>({.restitution = e});
      for (const Strike& strike :
           {Strike{}, Strike{.mass_ratio = 1e3, .size_ratio = 10}, Strike{.mass_ratio = 1e-2},
            Strike{.size_ratio = 30}, Strike{.wall = true}}) {
        CAPTURE(e);
        CAPTURE(strike.mass_ratio);
        CAPTURE(strike.wall);
        Strike fine = strike;
        fine.refinement = 20;

        const Impact impact = head_on<Dim>(law, fine);

        // Spring and dashpot err at second order. The effective mass is the lighter grain's at
        // least times 1/2, and time_step comes from the lightest pair: omega0 dt is at most pi/10
        // over the refinement.
        const double angle = std::numbers::pi / 10 / fine.refinement;
        CHECK(std::abs(impact.restitution - e) <= angle * angle);
      }
    }
  }

  TEST_CASE_TEMPLATE("the error of the restitution falls with the order of the onset", C,
                     NORMAL_LAWS) {
    using Law = typename C::Law;
    constexpr bool linear = std::is_same_v<Law, LinearSpring>;
    for (const double e : {1.0, 0.9, 0.5, 0.2}) {
      CAPTURE(e);
      const Law law = make_law<Law>({.restitution = e});

      const double coarse = restitution_error<C::Dim>(law, e, 4);
      const double fine = restitution_error<C::Dim>(law, e, 32);
      const double order = observed_order(coarse, fine, 8);

      CAPTURE(coarse);
      CAPTURE(fine);
      if (e < 1 && !linear) {
        // Hertz's dashpot starts as delta^(1/4). The weight of the first step leaves order 5/4,
        // below errors that fall with order 2.
        CHECK(order > 1);
      } else {
        // A spring errs at order 2, Hertz's delta^(3/2) at 5/2; a dashpot that knows when its
        // contact began at order 2.
        CHECK(relative_error(order, linear ? 2 : 2.5) < 0.12);
      }
    }
  }

  TEST_CASE_TEMPLATE("with 25 steps an impact is right to 0.1 % wherever in a step it begins", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    // What common/scenes/README.md and figures/README.md say.
    for (const double e : {1.0, 0.9, 0.7, 0.5, 0.3, 0.2}) {
      CAPTURE(e);
      const auto law = make_law<LinearSpring>({.restitution = e});
      for (const Strike& strike : {Strike{}, Strike{.wall = true}, Strike{.mass_ratio = 8}}) {
        CAPTURE(strike.wall);
        CAPTURE(strike.mass_ratio);
        const double m = strike.wall ? 1 : 1 / (1 + 1 / strike.mass_ratio);
        // The step is that of a pair of the lighter grain, whose contact is the shortest.
        const double steps = 25 / (strike.wall ? 1 : std::sqrt(m / 0.5));
        const double error =
            restitution_error<C::Dim>(law, e, refinement_for(law, steps), strike) / e;
        const double half =
            restitution_error<C::Dim>(law, e, refinement_for(law, 2 * steps), strike) / e;

        CHECK(error < 1e-3);
        CHECK(relative_error(observed_order(error, half), 2) < 0.25);
      }
    }
  }

  TEST_CASE_TEMPLATE("with 25 steps an impact of Hertz's law is right to 0.3 %", C, Case<2, Hertz>,
                     Case<3, Hertz>) {
    for (const double e : {1.0, 0.9, 0.7, 0.5, 0.3, 0.2}) {
      CAPTURE(e);
      const auto law = make_law<Hertz>({.restitution = e});

      CHECK(restitution_error<C::Dim>(law, e, refinement_for(law, 25)) / e < 3e-3);
    }
  }

  TEST_CASE_TEMPLATE("an elastic collision lasts and dips as the closed form says", C,
                     NORMAL_LAWS) {
    using Law = typename C::Law;
    const Law law = make_law<Law>({.restitution = 1});
    const double m = 1 / (1 / 1.0 + 1 / 8.0);
    const double r = 1 / (1 / 1.0 + 1 / 2.0);

    const Impact impact =
        head_on<C::Dim>(law, {.mass_ratio = 8, .size_ratio = 2, .refinement = 20});

    double duration = 0;
    double deepest = 0;
    if constexpr (std::is_same_v<Law, LinearSpring>) {
      duration = std::numbers::pi * std::sqrt(m / law.stiffness);
      deepest = std::sqrt(m / law.stiffness);
    } else {
      const double k = 4.0 / 3.0 * law.modulus * std::sqrt(r);
      deepest = std::pow(1.25 * m / k, 0.4);
      // 2 Gamma(2/5) sqrt(pi) / (5/2 Gamma(9/10)) = 2.9432...: the integral of
      // dx / sqrt(1 - x^(5/2)) over the way in and out.
      duration =
          2 * std::sqrt(std::numbers::pi) * std::tgamma(0.4) / (2.5 * std::tgamma(0.9)) * deepest;
    }
    CHECK(std::abs(impact.duration - duration) <= 2 * impact.time_step);
    // 2.94328 is rounded after the fifth decimal.
    CHECK(relative_error(law.contact_time(m, r), duration) < 2e-6);
    // The deepest of samples a step apart: at most (omega0 dt / 2)^2 / 2 below, omega0 dt = pi/200.
    CHECK(relative_error(impact.deepest, deepest) < 2e-4);
  }

  TEST_CASE_TEMPLATE("a damped spring pushes for the clamped contact time", C,
                     Case<2, LinearSpring>, Case<3, LinearSpring>) {
    for (const double e : {0.9, 0.5, 0.2, 0.05}) {
      CAPTURE(e);
      const auto law = make_law<LinearSpring>({.restitution = e});

      const Impact impact = head_on<C::Dim>(law, {.refinement = 20});

      CHECK(std::abs(impact.duration - law.contact_time(0.5, 0.5)) <= 2 * impact.time_step);
    }
  }

  TEST_CASE_TEMPLATE("the time named for a damped Hertz contact is never longer than the real one",
                     C, Case<2, Hertz>, Case<3, Hertz>) {
    // Damping maps exactly from the spring's motion, time does not: the named time is an estimate
    // on the safe side, a quarter too short at worst.
    for (const double e : {0.9, 0.5, 0.2, 0.05}) {
      CAPTURE(e);
      const auto law = make_law<Hertz>({.restitution = e});

      const Impact impact = head_on<C::Dim>(law, {.refinement = 20});

      const double named = law.contact_time(0.5, 0.5);
      CHECK(impact.duration >= named - 2 * impact.time_step);
      CHECK(impact.duration <= 1.25 * named);
    }
  }

  TEST_CASE_TEMPLATE("no contact attracts, and friction stays inside Coulomb's cone", C,
                     NORMAL_LAWS, FRICTION_LAWS) {
    using Law = typename C::Law;
    constexpr int Dim = C::Dim;
    CAPTURE(Dim);
    Random random(11);
    for (int k = 0; k < cases(2000, 100000); ++k) {
      CAPTURE(k);
      const double mu = random.uniform(0, 2);
      const Law law = make_law<Law>({.restitution = random.uniform(0.05, 1),
                                     .friction = mu,
                                     .tangential_damping_ratio = random.uniform(0, 2)});
      const Touch<Dim> touch = random_touch<Dim>(random);
      auto memory = random_memory(law, touch, random);

      const Response<Dim> response = law.respond(touch, memory, 1e-5);

      const double fn = response.force.dot(touch.normal);
      const double ft = (response.force - fn * touch.normal).norm();
      // A unit normal and a product of vectors round at 1e-16 of the force each.
      const double round = 1e-14 * response.force.norm();
      CHECK(fn >= -round);
      CHECK(ft <= (Law::needs.spin ? mu * fn : 0.0) + round);
    }
  }

  TEST_CASE_TEMPLATE("friction takes energy and never gives it", C, FRICTION_LAWS) {
    using Law = typename C::Law;
    constexpr int Dim = C::Dim;
    Random random(13);
    for (int k = 0; k < cases(2000, 100000); ++k) {
      CAPTURE(k);
      const Law law = make_law<Law>({.restitution = random.uniform(0.05, 1),
                                     .friction = random.uniform(0, 2),
                                     .tangential_damping_ratio = random.uniform(0, 2)});
      const Touch<Dim> touch = random_touch<Dim>(random);
      auto memory = random_memory(law, touch, random);
      const double stored = law.elastic_energy(touch, memory);

      const Response<Dim> response = law.respond(touch, memory, 1e-5);

      CHECK(response.friction_loss >= -1e-14 * stored);
      CHECK(response.dashpot_loss >= 0);
    }
  }

  TEST_CASE_TEMPLATE("a law that is asked with time step 0 changes nothing", C, NORMAL_LAWS,
                     FRICTION_LAWS) {
    using Law = typename C::Law;
    constexpr int Dim = C::Dim;
    Random random(12);
    for (int k = 0; k < cases(2000, 100000); ++k) {
      CAPTURE(k);
      const Law law = make_law<Law>({.restitution = random.uniform(0.05, 1),
                                     .friction = random.uniform(0, 2),
                                     .tangential_damping_ratio = random.uniform(0, 2)});
      const Touch<Dim> touch = random_touch<Dim>(random);
      auto memory = random_memory(law, touch, random);
      const auto before = memory;
      Touch<Dim> still = touch;
      still.closing = 0;
      still.slip.setZero();

      const Response<Dim> look = law.respond(touch, memory, 0);
      CHECK(memory == before);
      CHECK(look.dashpot_loss == 0);

      // Of a contact that does not move it sees the force of the last step.
      const Response<Dim> step = law.respond(still, memory, 1e-5);
      const Response<Dim> again = law.respond(still, memory, 0);
      // The stretch is turned into the plane where it already lies: rounding only.
      CHECK((again.force - step.force).norm() <= 1e-13 * step.force.norm());
    }
  }

  TEST_CASE_TEMPLATE("the elastic energy is the work done against the elastic force", C,
                     NORMAL_LAWS) {
    using Law = typename C::Law;
    const Law law = make_law<Law>({.restitution = 0.5});
    Touch<C::Dim> touch;
    touch.effective_mass = 0.7;
    touch.effective_radius = 0.4;
    // Gauss-Legendre on two points in u, delta = u^2: the integrands are u^3 and u^4, and a panel
    // errs by h^5 f''''/4320, so 50 panels give 1e-11 relative.
    constexpr int kPanels = 50;
    const double deepest = 0.03;
    const double h = std::sqrt(deepest) / kPanels;
    double work = 0;
    for (int k = 0; k < kPanels; ++k) {
      for (const double s : {-1 / std::sqrt(3.0), 1 / std::sqrt(3.0)}) {
        const double u = (k + 0.5 + 0.5 * s) * h;
        touch.overlap = u * u;
        work += 0.5 * h * law.elastic_force(touch) * 2 * u;
      }
    }
    touch.overlap = deepest;

    CHECK(relative_error(law.elastic_energy(touch, NoMemory{}), work) < 1e-8);
  }

  TEST_CASE_TEMPLATE("the stiffness is the slope of the elastic force", C, NORMAL_LAWS) {
    using Law = typename C::Law;
    const Law law = make_law<Law>({});
    Touch<C::Dim> touch;
    touch.effective_radius = 0.4;
    touch.overlap = 0.01;
    Touch<C::Dim> deeper = touch;
    Touch<C::Dim> shallower = touch;
    deeper.overlap += 1e-6;
    shallower.overlap -= 1e-6;

    // Central difference: error (1e-4)^2 relative.
    CHECK(relative_error((law.elastic_force(deeper) - law.elastic_force(shallower)) / 2e-6,
                         law.stiffness_at(touch)) < 1e-8);
  }
}
