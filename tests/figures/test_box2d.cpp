// SPDX-License-Identifier: GPL-3.0-or-later
// Box2D as an engine for our scenes: its units, its walls, its forces; and the closed forms that
// both engines are held against.

#include "box2d_world.hpp"
#include "engine.hpp"
#include "rigid.hpp"
#include "support/tolerance.hpp"

#include <lagrain/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

using namespace lagrain;
using namespace lagrain::figures;
using lagrain::test::relative_error;

namespace {

constexpr double kR = 0.005, kG = 9.81;  // not the units of Box2D

Scene<2> small_scene() {
  Scene<2> scene = game_scene();
  scene.gravity = {0, -kG};
  scene.materials = {{"stone", 2500}};
  scene.law.stiffness = 1e6;
  scene.law.restitution = 0.2;
  return scene;
}

Wall<2> ground() { return Wall<2>::half_space("floor", {0, 0}, {0, 1}); }

std::unique_ptr<Box2dWorld> world_of(const Scene<2>& scene, const Box2dSettings& settings = {}) {
  return std::make_unique<Box2dWorld>(*make_run(scene, 1), settings);
}

void run_for(Engine& engine, int steps) {
  for (int k = 0; k < steps; ++k) engine.step();
}

/// The settings for what rests: with Box2D's own threshold, below which nothing bounces.
constexpr Box2dSettings kResting{.bounce_above = 1};

Vec<2> momentum(const std::array<RigidDisc, 2>& discs) {
  return discs[0].mass * discs[0].velocity + discs[1].mass * discs[1].velocity;
}

double angular_momentum(const std::array<RigidDisc, 2>& discs) {
  double sum = 0;
  for (const RigidDisc& d : discs) {
    sum += d.mass * (d.position.x() * d.velocity.y() - d.position.y() * d.velocity.x()) +
           0.5 * d.mass * d.radius * d.radius * d.spin;
  }
  return sum;
}

double energy(const std::array<RigidDisc, 2>& discs) {
  double sum = 0;
  for (const RigidDisc& d : discs) {
    sum += 0.5 * d.mass * (d.velocity.squaredNorm() + 0.5 * d.radius * d.radius * d.spin * d.spin);
  }
  return sum;
}

/// Velocity of the first disc's surface at the contact against the second's.
Vec<2> contact_velocity(const std::array<RigidDisc, 2>& discs) {
  const Vec<2> n = (discs[0].position - discs[1].position).normalized();
  const auto surface = [](const RigidDisc& d, const Vec<2>& arm) {
    return Vec<2>(d.velocity + d.spin * Vec<2>(-arm.y(), arm.x()));
  };
  return surface(discs[0], -discs[0].radius * n) - surface(discs[1], discs[1].radius * n);
}

/// Two unlike discs that touch and approach each other.
std::array<RigidDisc, 2> unlike_discs() {
  const Vec<2> n(0.6, 0.8);
  std::array<RigidDisc, 2> discs{RigidDisc{{0.3, 0.1}, {-2, -1.5}, 3, 0.5, 2},
                                 RigidDisc{{0, 0}, {0.4, 0.1}, -1, 1.5, 7}};
  discs[1].position = discs[0].position - 2 * n;
  return discs;
}

}  // namespace

TEST_SUITE("rigid discs") {
  TEST_CASE("an impact keeps both momenta, turns the normal velocity by e, and gains no energy") {
    const auto before = unlike_discs();
    const Vec<2> n = (before[0].position - before[1].position).normalized(), t(-n.y(), n.x());
    for (const double e : {0.0, 0.3, 1.0}) {
      for (const double mu : {0.0, 0.1, 0.5, 10.0}) {
        CAPTURE(e);
        CAPTURE(mu);
        const auto after = rigid_impact(before, e, mu);

        CHECK((momentum(after) - momentum(before)).norm() < 1e-12);
        CHECK(std::abs(angular_momentum(after) - angular_momentum(before)) < 1e-12);
        const Vec<2> u0 = contact_velocity(before), u1 = contact_velocity(after);
        CHECK(relative_error(u1.dot(n) + 1, 1 - e * u0.dot(n)) < 1e-12);
        CHECK(energy(after) <= energy(before) * (1 + 1e-12));
        const Vec<2> impulse = before[0].mass * (after[0].velocity - before[0].velocity);
        CHECK(std::abs(impulse.dot(t)) <= mu * impulse.dot(n) * (1 + 1e-12) + 1e-15);
        // It sticks, or friction is at its limit and against the slip.
        if (std::abs(u1.dot(t)) > 1e-12) {
          CHECK(relative_error(std::abs(impulse.dot(t)) + 1, mu * impulse.dot(n) + 1) < 1e-12);
          CHECK(u1.dot(t) * u0.dot(t) > 0);
        }
        if (mu == 0) CHECK(after[0].spin == before[0].spin);
        if (mu == 10) CHECK(std::abs(u1.dot(t)) < 1e-12);
      }
    }
    CHECK(relative_error(energy(rigid_impact(before, 1, 0)), energy(before)) < 1e-12);
  }

  TEST_CASE("a disc rolls up to the angle at which friction would have to exceed its limit") {
    constexpr double kMu = 0.2;
    const double critical = std::atan(3 * kMu);
    for (const double angle : {0.1, 0.9 * critical, critical, 1.1 * critical, 1.2}) {
      const Descent d = descent(angle, kMu, 10, 0.5, 2);
      // The contact point rests where it rolls, and slides downhill elsewhere.
      const double slip = d.velocity - 0.5 * d.spin;
      if (angle <= critical)
        CHECK(std::abs(slip) < 1e-12);
      else
        CHECK(slip > 0);
      // Newton's and Euler's laws with one friction force.
      const double force = 10 * std::sin(angle) - d.velocity / 2;
      CHECK(relative_error(0.5 * 0.5 * d.spin / 2, force) < 1e-12);
      CHECK(force <= kMu * 10 * std::cos(angle) * (1 + 1e-12));
    }
  }

  TEST_CASE("the share that tunnels is what counting the phases gives") {
    constexpr int kPhases = 100000;
    for (const double stride : {0.3, 1.0, 1.25, 2.0, 3.7, 40.0}) {
      int passed = 0;
      for (int k = 0; k < kPhases; ++k) {
        // Steps end at x, one stride apart; the front half of the overlap is from -1 to 0.
        double x = -1 - stride * (k + 0.5) / kPhases;
        while (x < -1) x += stride;
        passed += x > 0;
      }
      CHECK(std::abs(tunnelling_share(stride) - static_cast<double>(passed) / kPhases) <
            2.0 / kPhases);
    }
  }
}

TEST_SUITE("overlaps") {
  TEST_CASE("the sweep finds what looking at all pairs finds") {
    Random random(5);
    constexpr int kCount = 60;
    Columns<2> x(2, kCount);
    Eigen::VectorXd r(kCount);
    for (int i = 0; i < kCount; ++i) {
      r[i] = random.uniform(0.1, 1);
      x.col(i) = Vec<2>(random.uniform(0, 10), random.uniform(0, 10));
    }
    const std::vector<Wall<2>> walls{ground(), Wall<2>::half_space("right", {9.5, 0}, {-1, 0})};
    double sum = 0, largest = 0, partners = 0;
    int contacts = 0, escaped = 0;
    const auto note = [&](double overlap, int discs) {
      if (overlap <= 0) return;
      sum += overlap;
      largest = std::max(largest, overlap);
      ++contacts;
      partners += discs;
    };
    for (int i = 0; i < kCount; ++i) {
      if (x(0, i) > 9.5) {
        ++escaped;
        continue;
      }
      note((r[i] - x(1, i)) / r[i], 1);
      note((r[i] - (9.5 - x(0, i))) / r[i], 1);
      for (int j = 0; j < i; ++j) {
        if (x(0, j) > 9.5) continue;
        note((r[i] + r[j] - (x.col(i) - x.col(j)).norm()) / std::min(r[i], r[j]), 2);
      }
    }

    const Overlaps found = overlaps_of(x, r, walls);

    REQUIRE(contacts > 20);
    REQUIRE(escaped > 0);
    CHECK(found.escaped == escaped);
    CHECK(relative_error(found.mean, sum / contacts) < 1e-12);
    CHECK(relative_error(found.largest, largest) < 1e-12);
    CHECK(relative_error(found.coordination, partners / (kCount - escaped)) < 1e-12);
  }
}

TEST_SUITE("Box2D") {
  TEST_CASE("both engines start from the same discs") {
    Scene<2> scene = small_scene();
    scene.friction = FrictionModel::elastic;
    scene.walls = {ground(), Wall<2>::half_space("left", {0, 0}, {1, 0})};
    scene.fills = {{.name = "some",
                    .count = 40,
                    .radius = UniformRadius{0.6 * kR, 1.4 * kR},
                    .region = {{0, 0}, {24 * kR, 24 * kR}},
                    .velocity = {0.1, -0.2},
                    .random_speed = 0.3}};
    scene.grains = {{.position = {0.3, 0.3}, .radius = kR, .spin = SpinVec<2>(7.0)}};

    const auto ours = make_engine(scene, LagrainSettings{1e6});
    const auto theirs = make_engine(scene, Box2dSettings{});

    const double single = 1e-6;
    CHECK((theirs->positions() - ours->positions()).norm() < single * ours->positions().norm());
    CHECK((theirs->velocities() - ours->velocities()).norm() < single * ours->velocities().norm());
    CHECK((theirs->spins() - ours->spins()).norm() < single * ours->spins().norm());
    CHECK(ours->spins()(0, 0) == 7);
    CHECK(theirs->radii() == ours->radii());
    CHECK((theirs->masses() - ours->masses()).norm() < single * ours->masses().norm());
    const auto world = world_of(scene);
    const Eigen::ArrayXd inertia = 0.5 * ours->masses().array() * ours->radii().array().square();
    CHECK((world->inertias().array() / inertia - 1).abs().maxCoeff() < single);
    // The mean disc is 1 of Box2D's metres, and gravity 10.
    CHECK(relative_error(world->slop(), 0.005 * ours->radii().mean()) < single);
    CHECK(relative_error(world->time_step(), std::sqrt(10 * ours->radii().mean() / kG) / 60) <
          single);
  }

  TEST_CASE("a disc falls by g t^2 / 2 and by Euler's error on top, in SI") {
    Scene<2> scene = small_scene();
    scene.grains = {{.position = {1, 2}, .radius = kR, .velocity = {0.5, 0}}};
    for (const double rate : {60, 240}) {
      const auto world = world_of(scene, {.time_step = 1 / rate});
      run_for(*world, 100);
      const double t = world->time(), h = world->time_step();
      REQUIRE(relative_error(t, 100 * h) < 1e-12);
      CHECK(relative_error(2 - world->positions()(1, 0), 0.5 * kG * t * t * (1 + h / t)) < 1e-4);
      CHECK(relative_error(-world->velocities()(1, 0), kG * t) < 1e-5);
      CHECK(relative_error(world->positions()(0, 0), 1 + 0.5 * t) < 1e-5);
    }
  }

  TEST_CASE("a disc at rest lies on the true wall, to a slop, and presses it by its weight") {
    const double angle = 0.5;
    const Vec<2> along(std::cos(angle), std::sin(angle)), up(-along.y(), along.x());
    const std::array<Wall<2>, 3> walls{
        Wall<2>::half_space("half-space", {0, 0}, up),
        Wall<2>::segment("segment", -20 * kR * along, 20 * kR * along),
        Wall<2>::segment("segment, the other way", 20 * kR * along, -20 * kR * along)};
    for (const Wall<2>& wall : walls) {
      CAPTURE(wall.name);
      Scene<2> scene = small_scene();
      scene.gravity = -kG * up;
      scene.walls = {wall};
      // It falls by a fifth of a radius.
      scene.grains = {{.position = 1.2 * kR * up, .radius = kR}};
      const auto world = world_of(scene, kResting);
      run_for(*world, 600);

      const double gap = world->positions().col(0).dot(up) - kR;
      // Edges are in single precision, and long.
      CHECK(gap <= 0.1 * world->slop());
      CHECK(gap >= -1.1 * world->slop());
      const double weight = kG * world->masses()[0];
      CHECK((world->wall_force(0) + weight * up).norm() < 1e-3 * weight);
      CHECK(std::abs(wall_load(*world, scene) - 1) < 1e-3);
    }
  }

  TEST_CASE("contacts of a pile of two carry what lies above, along the line of centres") {
    Scene<2> scene = small_scene();
    scene.walls = {ground()};
    scene.grains = {{.position = {0, kR}, .radius = kR},
                    {.position = {0, 2 * kR + 0.5 * kR}, .radius = 0.5 * kR}};
    const auto world = world_of(scene, kResting);
    run_for(*world, 600);

    const auto contacts = world->contacts();
    REQUIRE(contacts.size() == 2);
    for (const ContactRecord<2>& c : contacts) {
      const bool on_floor = c.wall == 0;
      CHECK(c.i == 0);
      CHECK(c.j == (on_floor ? -1 : 1));
      const double above = kG * (world->masses()[1] + (on_floor ? world->masses()[0] : 0));
      const Vec<2> normal(0, on_floor ? 1 : -1);  // towards disc 0
      CHECK((c.normal - normal).norm() < 1e-5);
      CHECK((c.force - above * normal).norm() < 1e-3 * above);
      CHECK(c.overlap > -0.1 * world->slop());
      CHECK(c.overlap < 1.5 * world->slop());
    }
  }

  TEST_CASE("friction of the scene: on an incline a disc rolls or slides as a rigid one") {
    for (const double degrees : {20.0, 60.0}) {
      const double angle = degrees * std::numbers::pi / 180;
      Scene<2> scene = small_scene();
      scene.gravity = {kG * std::sin(angle), -kG * std::cos(angle)};
      scene.friction = FrictionModel::elastic;
      scene.law.friction = 0.2;
      scene.walls = {ground()};
      scene.grains = {{.position = {0, kR}, .radius = kR}};
      const auto world = world_of(scene, kResting);
      run_for(*world, 60);
      const Descent exact = descent(angle, 0.2, kG, kR, world->time());
      CHECK(relative_error(world->velocities()(0, 0), exact.velocity) < 1e-3);
      CHECK(relative_error(-world->spins()(0, 0), exact.spin) < 1e-3);
      // It drags the incline downhill as much as it is held back, and presses it.
      const double held = kG * std::sin(angle) - exact.velocity / world->time();
      const Vec<2> on_wall = world->masses()[0] * Vec<2>(held, -kG * std::cos(angle));
      CHECK((world->wall_force(0) - on_wall).norm() < 1e-3 * on_wall.norm());
    }
  }

  TEST_CASE("restitution of the scene, above the threshold and below") {
    Scene<2> scene = small_scene();
    scene.gravity.setZero();
    scene.law.restitution = 0.7;
    scene.grains = {{.position = {-3 * kR, 0}, .radius = kR, .velocity = {kR, 0}},
                    {.position = {0, 0}, .radius = kR}};
    for (const double above : {0.0, 2.0}) {  // the discs approach by 1 of Box2D's m/s
      const auto world = world_of(scene, {.bounce_above = above});
      run_for(*world, 120);
      const double apart = world->velocities()(0, 1) - world->velocities()(0, 0);
      CHECK(std::abs(apart - (above < 1 ? 0.7 : 0) * kR) < 1e-4 * kR);
    }
  }

  TEST_CASE("a slow disc does not fall asleep") {
    Scene<2> scene = small_scene();
    scene.gravity.setZero();
    scene.grains = {{.position = {0, 0}, .radius = kR, .velocity = {0.005 * kR, 0}}};
    const auto world = world_of(scene);
    run_for(*world, 120);
    CHECK(relative_error(world->positions()(0, 0), 0.005 * kR * world->time()) < 1e-4);
  }

  TEST_CASE("what lies within a step is seen if asked for: walls, and discs by a bullet") {
    constexpr int kPhases = 16;
    constexpr double kStride = 2;  // diameters in a step
    Scene<2> scene = small_scene();
    scene.gravity.setZero();
    const double speed = kStride * 2 * kR * 60;
    // Smaller discs than usual: Box2D moves nothing by more than 2 of its metres in a step.
    Box2dSettings blind{.continuous = false, .mean_radius = 0.25}, seeing = blind, bullet = blind;
    seeing.continuous = bullet.continuous = true;
    bullet.bullet = 0;
    const auto passing = [&](const Box2dSettings& settings) {
      int passed = 0;
      for (int k = 0; k < kPhases; ++k) {
        scene.grains[0].position.x() = -20 * kR - (k + 0.5) / kPhases * speed / 60;
        const auto world = world_of(scene, settings);
        run_for(*world, 20);
        passed += world->velocities()(0, 0) > 0.999 * speed;
      }
      return static_cast<double>(passed) / kPhases;
    };
    scene.grains = {{.position = {0, 0}, .radius = kR, .velocity = {speed, 0}}};
    scene.walls = {Wall<2>::segment("plank", {0, -10 * kR}, {0, 10 * kR})};
    CHECK(passing(blind) > 0);
    CHECK(passing(seeing) == 0);
    scene.walls.clear();
    scene.grains.push_back({.position = {0, 0}, .radius = kR});
    const double expected = tunnelling_share(kStride);
    CHECK(std::abs(passing(blind) - expected) <= 1.0 / kPhases);
    CHECK(std::abs(passing(seeing) - expected) <= 1.0 / kPhases);
    CHECK(passing(bullet) == 0);
  }

  TEST_CASE("a pinned disc stays and carries") {
    Scene<2> scene = small_scene();
    scene.grains = {{.position = {0, 0}, .radius = kR, .pinned = true},
                    {.position = {0, 2 * kR}, .radius = kR}};
    const auto world = world_of(scene, kResting);
    run_for(*world, 60);
    CHECK(world->positions().col(0).norm() == 0);
    CHECK(world->positions()(1, 1) > 1.98 * kR);
  }

  TEST_CASE("what Box2D cannot run is refused") {
    Scene<2> scene = small_scene();
    scene.grains = {{.position = {0, 0}, .radius = kR}};
    scene.walls = {Wall<2>::cylinder("drum", {0, 0}, {0, 0}, 1)};
    CHECK_THROWS_AS(world_of(scene), ContractError);
    scene.walls = {Wall<2>::half_space("lift", {0, -1}, {0, 1})};
    scene.walls[0].motion = Steady<2>{{0, 0.1}};
    CHECK_THROWS_AS(world_of(scene), ContractError);
    scene.walls.clear();
    scene.pairs = {{0, 0, scene.law}};
    CHECK_THROWS_AS(world_of(scene), ContractError);
  }
}
