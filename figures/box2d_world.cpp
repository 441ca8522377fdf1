// SPDX-License-Identifier: GPL-3.0-or-later
#include "box2d_world.hpp"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <variant>

namespace lagrain::figures {

namespace {

b2Vec2 single(const Vec<2>& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y())}; }
Vec<2> twice(const b2Vec2& v) { return {static_cast<double>(v.x), static_cast<double>(v.y)}; }

/// What a surface is like; Box2D mixes friction as sqrt(ab) and restitution as max(a, b), so equal
/// surfaces give the scene's numbers.
b2FixtureDef surface(const Scene<2>& scene, const Box2dSettings& settings, const b2Shape& shape) {
  b2FixtureDef def;
  def.shape = &shape;
  def.friction =
      static_cast<float>(scene.friction == FrictionModel::none ? 0.0 : scene.law.friction);
  def.restitution = static_cast<float>(scene.law.restitution);
  def.restitutionThreshold = static_cast<float>(settings.bounce_above);
  return def;
}

}  // namespace

struct Box2dWorld::World {
  explicit World(const b2Vec2& gravity) : world(gravity) {}

  b2World world;
  std::vector<b2Body*> discs, walls;  // by number; a body's user data is its place in all of them
};

Box2dWorld::Box2dWorld(const Run<2>& run, const Box2dSettings& settings)
    : settings_(settings), radii_(run.radii()), masses_(run.masses()), walls_(run.walls()) {
  constexpr double kGravity = 10;  // [Box2D's m/s^2]
  const Scene<2>& scene = run.scene();
  LAGRAIN_EXPECTS(scene.pairs.empty(), "Box2D mixes materials by its own rule");
  units_.length = radii_.mean() / settings.mean_radius;
  units_.mass = masses_.mean();
  const double gravity = scene.gravity.norm();
  if (gravity > 0) units_.time = std::sqrt(units_.length * kGravity / gravity);

  world_ =
      std::make_unique<World>(single(scene.gravity * (units_.time * units_.time / units_.length)));
  world_->world.SetAllowSleeping(false);
  world_->world.SetContinuousPhysics(settings.continuous);
  for (int i = 0; i < run.count(); ++i) add_disc(run, i);
  for (const Wall<2>& wall : walls_) add_wall(run, wall);
}

Box2dWorld::~Box2dWorld() = default;

void Box2dWorld::add_disc(const Run<2>& run, int i) {
  const auto by_hand = static_cast<std::size_t>(i);
  const auto& placed = run.scene().grains;  // they come first
  b2BodyDef def;
  def.type = by_hand < placed.size() && placed[by_hand].pinned ? b2_staticBody : b2_dynamicBody;
  def.position = single(run.positions().col(i) / units_.length);
  def.linearVelocity = single(run.velocities().col(i) * (units_.time / units_.length));
  if (run.spins()) def.angularVelocity = static_cast<float>((*run.spins())(0, i) * units_.time);
  def.bullet = i == settings_.bullet;
  def.userData.pointer = static_cast<std::uintptr_t>(i);
  b2Body* body = world_->world.CreateBody(&def);

  const double radius = radii_[i] / units_.length;
  b2CircleShape circle;
  circle.m_radius = static_cast<float>(radius);
  b2FixtureDef fixture = surface(run.scene(), settings_, circle);
  // From a density Box2D derives the inertia m r^2 / 2, which is ours.
  fixture.density =
      static_cast<float>(masses_[i] / units_.mass / (std::numbers::pi * radius * radius));
  body->CreateFixture(&fixture);
  if (def.type == b2_dynamicBody) masses_[i] = static_cast<double>(body->GetMass()) * units_.mass;
  world_->discs.push_back(body);
}

void Box2dWorld::add_wall(const Run<2>& run, const Wall<2>& wall) {
  LAGRAIN_EXPECTS(!wall.drives(), "wall \"" + wall.name + "\" moves");
  constexpr double kReach = 100, kTimes = 10;  // mean radii, and times the extent of the grains
  const Columns<2>& x = run.positions();
  Vec<2> from, to, normal;  // towards the grains
  if (const auto* plane = std::get_if<HalfSpace<2>>(&wall.shape)) {
    normal = plane->normal;
    const Vec<2> middle = x.rowwise().mean();
    const Vec<2> foot = middle - (middle - wall.point).dot(normal) * normal;
    const double extent = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
    const Vec<2> along =
        (kTimes * extent + kReach * radii_.mean()) * Vec<2>(normal.y(), -normal.x());
    from = foot - along;
    to = foot + along;
  } else {
    const std::vector<Vec<2>> ends = wall.corners();
    LAGRAIN_EXPECTS(
        ends.size() == 2 && std::holds_alternative<WallSegment>(wall.pieces()->piece(0)),
        "wall \"" + wall.name + "\" is no straight piece");
    from = ends[0];
    to = ends[1];
    const Vec<2> along = to - from;
    normal = Vec<2>(-along.y(), along.x()).normalized();
    const Eigen::VectorXd sides = (x.colwise() - from).transpose() * normal;
    if (2 * (sides.array() < 0).count() > sides.size()) normal = -normal;
  }
  const Vec<2> back = static_cast<double>(b2_polygonRadius) * normal;
  b2EdgeShape edge;
  edge.SetTwoSided(single(from / units_.length - back), single(to / units_.length - back));
  b2BodyDef def;
  def.userData.pointer = world_->discs.size() + world_->walls.size();
  b2Body* body = world_->world.CreateBody(&def);
  const b2FixtureDef fixture = surface(run.scene(), settings_, edge);
  body->CreateFixture(&fixture);
  world_->walls.push_back(body);
}

void Box2dWorld::step() {
  world_->world.Step(static_cast<float>(settings_.time_step), settings_.velocity_iterations,
                     settings_.position_iterations);
  ++steps_;
}

double Box2dWorld::time_step() const {
  return static_cast<double>(static_cast<float>(settings_.time_step)) * units_.time;
}

Columns<2> Box2dWorld::positions() const {
  Columns<2> x(2, radii_.size());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    x.col(i) = units_.length * twice(world_->discs[static_cast<std::size_t>(i)]->GetPosition());
  }
  return x;
}

Columns<2> Box2dWorld::velocities() const {
  Columns<2> v(2, radii_.size());
  for (Eigen::Index i = 0; i < v.cols(); ++i) {
    v.col(i) = units_.length / units_.time *
               twice(world_->discs[static_cast<std::size_t>(i)]->GetLinearVelocity());
  }
  return v;
}

Columns<1> Box2dWorld::spins() const {
  Columns<1> omega(1, radii_.size());
  for (Eigen::Index i = 0; i < omega.cols(); ++i) {
    const b2Body* body = world_->discs[static_cast<std::size_t>(i)];
    omega(0, i) = static_cast<double>(body->GetAngularVelocity()) / units_.time;
  }
  return omega;
}

Eigen::VectorXd Box2dWorld::inertias() const {
  Eigen::VectorXd inertia(radii_.size());
  for (Eigen::Index i = 0; i < inertia.size(); ++i) {
    const b2Body* body = world_->discs[static_cast<std::size_t>(i)];
    inertia[i] =
        static_cast<double>(body->GetInertia()) * units_.mass * units_.length * units_.length;
  }
  return inertia;
}

std::vector<ContactRecord<2>> Box2dWorld::contacts() const {
  const Columns<2> x = positions();
  const int discs = static_cast<int>(radii_.size());
  const double unit = force_unit() / static_cast<double>(static_cast<float>(settings_.time_step));
  std::vector<ContactRecord<2>> list;
  for (b2Contact* c = world_->world.GetContactList(); c != nullptr; c = c->GetNext()) {
    if (!c->IsTouching()) continue;
    b2WorldManifold manifold;
    c->GetWorldManifold(&manifold);
    const b2ManifoldPoint& point = c->GetManifold()->points[0];
    const Vec<2> normal = twice(manifold.normal);  // from A to B
    // On B, after b2ContactSolver.
    const Vec<2> force =
        unit * (static_cast<double>(point.normalImpulse) * normal +
                static_cast<double>(point.tangentImpulse) * Vec<2>(normal.y(), -normal.x()));
    const auto number = [](b2Fixture* fixture) {
      return static_cast<int>(fixture->GetBody()->GetUserData().pointer);
    };
    const int a = number(c->GetFixtureA()), b = number(c->GetFixtureB());
    ContactRecord<2> record;
    record.i = std::min(a, b);
    const double sign = record.i == b ? 1 : -1;
    record.normal = sign * normal;
    record.force = sign * force;
    const int partner = std::max(a, b);
    if (partner < discs) {
      record.j = partner;
      record.overlap =
          radii_[record.i] + radii_[partner] - (x.col(record.i) - x.col(partner)).norm();
    } else {
      record.wall = partner - discs;
      record.overlap = radii_[record.i] -
                       walls_[static_cast<std::size_t>(record.wall)].foot(x.col(record.i)).distance;
    }
    list.push_back(record);
  }
  return list;
}

Vec<2> Box2dWorld::wall_force(int wall) const {
  Vec<2> sum = Vec<2>::Zero();
  for (const ContactRecord<2>& record : contacts()) {
    if (record.wall == wall) sum -= record.force;
  }
  return sum;
}

double Box2dWorld::slop() const { return static_cast<double>(b2_linearSlop) * units_.length; }

std::string box2d_version() {
  return std::to_string(b2_version.major) + "." + std::to_string(b2_version.minor) + "." +
         std::to_string(b2_version.revision);
}

}  // namespace lagrain::figures
