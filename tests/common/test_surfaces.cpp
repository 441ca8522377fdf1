// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/walls.hpp>

#include <lagrain/observe.hpp>

#include <support/cases.hpp>
#include <support/scenes.hpp>
#include <support/space.hpp>
#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// A place `x` to the right and `z` up.
template <int Dim>
Vec<Dim> at(double x, double z) {
  return x * along<Dim>() + z * up<Dim>();
}

/// Pieces between neighbouring points (x, z): segments, and in space strips 2 m wide.
template <int Dim>
std::vector<Wall<Dim>> polyline(const std::vector<Vec<2>>& points) {
  std::vector<Wall<Dim>> walls;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    walls.push_back(flat_piece<Dim>("piece " + std::to_string(k),
                                    at<Dim>(points[k][0], points[k][1]),
                                    at<Dim>(points[k + 1][0], points[k + 1][1])));
  }
  return walls;
}

template <class T>
void shuffle(std::vector<T>& list, Random& random) {
  for (std::size_t k = list.size(); k > 1; --k) {
    std::swap(list[k - 1], list[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  }
}

/// The same pieces in another order, some of them from the other end.
std::vector<Wall<2>> mixed(std::vector<Wall<2>> walls, Random& random) {
  for (Wall<2>& wall : walls) {
    const auto ends = wall.corners();
    if (random.uniform() < 0.5) wall = Wall<2>::segment(wall.name, ends[1], ends[0]);
  }
  shuffle(walls, random);
  return walls;
}
std::vector<Wall<3>> mixed(std::vector<Wall<3>> walls, Random& random) {
  for (Wall<3>& wall : walls) {
    auto corners = wall.corners();
    if (random.uniform() < 0.5) std::reverse(corners.begin(), corners.end());
    std::rotate(corners.begin(), corners.begin() + random.below(static_cast<int>(corners.size())),
                corners.end());
    wall = Wall<3>::plate(wall.name, corners);
  }
  shuffle(walls, random);
  return walls;
}

/// A contact of a place with a surface.
template <int Dim>
struct Found {
  int wall;
  double distance;
  Vec<Dim> normal;
};

/// The contacts of a grain at x with walls that have been joined.
template <int Dim>
std::vector<Found<Dim>> contacts_at(const std::vector<Wall<Dim>>& walls, const Vec<Dim>& x,
                                    double radius) {
  std::vector<WallPair> pairs;
  for (int w = 0; w < static_cast<int>(walls.size()); ++w) {
    for (int p = 0; p < walls[static_cast<std::size_t>(w)].piece_count(); ++p) {
      pairs.push_back({0, w, p});
    }
  }
  std::vector<Found<Dim>> found;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto foot = contact_foot<Dim>(walls.data(), pairs, k, x, radius);
    if (foot.distance < radius) found.push_back({pairs[k].wall, foot.distance, foot.normal});
  }
  return found;
}

template <int Dim>
Vec<Dim> random_direction(Random& random) {
  Vec<Dim> v;
  for (double& c : v) c = random.normal();
  return v.normalized();
}

Vec<3> random_place(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

template <int Dim>
Grain<Dim> ball(const Vec<Dim>& place) {
  Grain<Dim> g;
  g.radius = g.mass = 1;
  g.position = place;
  return g;
}

template <class S>
void run_for(S& sim, double duration) {
  const double end = sim.time() + duration;
  while (sim.time() < end) sim.step();
}

template <class S>
int wall_contacts(const S& sim) {
  int count = 0;
  sim.for_each_wall_contact([&](auto&&...) { ++count; });
  return count;
}

constexpr double kStiff = 1e5;      // [N/m]
constexpr double kGravity = 10;     // [m/s^2]
constexpr double kSunk = 10 / 1e5;  // overlap of a grain of 1 kg at rest on a plane [m]

LinearSpring soft_landing() {
  return make_law<LinearSpring>({.stiffness = kStiff, .restitution = 0.1});
}

/// How a grain has rolled, and with which tangential force in each step.
template <int Dim>
struct Rolled {
  Vec<Dim> place, velocity;
  SpinVec<Dim> omega;
  std::vector<double> forces;
  double balance;
};

/// A grain rolls along the pieces for a while. It slips a little at the start: the tangential
/// spring swings, below the limit of friction.
template <int Dim>
Rolled<Dim> rolled(const std::vector<Vec<2>>& points, double refinement, double duration) {
  const auto law = make_law<FrictionalSpring>({.stiffness = kStiff, .friction = 0.5});
  auto g = ball<Dim>(at<Dim>(0.3, 1 - kSunk));
  g.velocity = 5 * along<Dim>();
  g.omega = (4.995 / (1 - kSunk)) * rolling_spin<Dim>();
  auto sim = make_sim<Dim>(std::vector<Grain<Dim>>{g}, law, polyline<Dim>(points), refinement,
                           -kGravity * up<Dim>());
  Rolled<Dim> result;
  while (sim.time() < duration) {
    sim.step();
    Vec<Dim> on_walls = Vec<Dim>::Zero();
    for (const auto& wall : sim.walls()) on_walls += wall.force;
    result.forces.push_back(on_walls.dot(along<Dim>()));
  }
  result.place = sim.grains().position.col(0);
  result.velocity = sim.grains().velocity.col(0);
  result.omega = sim.grains().omega.col(0);
  result.balance = energy_ledger(sim).balance();
  return result;
}

template <int Dim>
void expect_same_rolling(const Rolled<Dim>& pieces, const Rolled<Dim>& whole) {
  CHECK((pieces.velocity - whole.velocity).norm() < 1e-9 * whole.velocity.norm());
  CHECK((pieces.omega - whole.omega).norm() < 1e-9 * whole.omega.norm());
  CHECK((pieces.place - whole.place).norm() < 1e-9);
  CHECK(relative_error(pieces.balance, whole.balance) < 1e-9);
  REQUIRE(pieces.forces.size() == whole.forces.size());
  double largest = 0, off = 0;
  for (std::size_t k = 0; k < whole.forces.size(); ++k) {
    largest = std::max(largest, std::abs(whole.forces[k]));
    off = std::max(off, std::abs(pieces.forces[k] - whole.forces[k]));
  }
  CHECK(largest > 0.1);  // the spring was stretched
  CHECK(off < 1e-6 * largest);
}

// ---- Boxes: the exterior of a convex body, and its interior
// --------------------------------------

/// The faces of an axis-parallel box, turned and moved.
template <int Dim>
struct BoxOfPieces {
  Vec<Dim> half;  ///< half its sides [m]
  Eigen::Matrix<double, Dim, Dim> turn;
  Vec<Dim> middle;

  Vec<Dim> outside(const Vec<Dim>& x) const { return turn * x + middle; }

  std::vector<Wall<Dim>> pieces(bool triangles) const {
    std::vector<Wall<Dim>> walls;
    if constexpr (Dim == 2) {
      const Vec<2> c[] = {{-half[0], -half[1]}, {half[0], -half[1]}, half, {-half[0], half[1]}};
      for (int k = 0; k < 4; ++k) {
        walls.push_back(Wall<2>::segment("side", outside(c[k]), outside(c[(k + 1) % 4])));
      }
    } else {
      for (int d = 0; d < 3; ++d) {
        for (const int side : {-1, 1}) {
          std::vector<Vec<3>> face;
          for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
            Vec<3> c;
            c[d] = side * half[d];
            c[(d + 1) % 3] = a * half[(d + 1) % 3];
            c[(d + 2) % 3] = b * half[(d + 2) % 3];
            face.push_back(outside(c));
          }
          if (triangles) {
            walls.push_back(Wall<3>::plate("half", {face[0], face[1], face[2]}));
            walls.push_back(Wall<3>::plate("half", {face[0], face[2], face[3]}));
          } else {
            walls.push_back(Wall<3>::plate("side", face));
          }
        }
      }
    }
    return walls;
  }
};

template <int Dim>
BoxOfPieces<Dim> random_box(Random& random) {
  BoxOfPieces<Dim> box;
  for (double& h : box.half) h = random.uniform(0.5, 2);
  if constexpr (Dim == 2) {
    box.turn = Eigen::Rotation2Dd(random.uniform(0, 6)).toRotationMatrix();
  } else {
    box.turn = Eigen::AngleAxisd(random.uniform(0, 6), random_direction<3>(random)).matrix();
  }
  box.middle = 3 * random_direction<Dim>(random);
  return box;
}

// ---- The nearest features of a sampled surface
// ---------------------------------------------------

/// Points of a piece, so dense that none of the piece is further than `step` from one.
std::vector<Vec<2>> samples(const Wall<2>& wall, int n) {
  const auto ends = wall.corners();
  std::vector<Vec<2>> points;
  for (int k = 0; k <= n; ++k) points.push_back(ends[0] + (ends[1] - ends[0]) * k / n);
  return points;
}
std::vector<Vec<3>> samples(const Wall<3>& triangle, int n) {
  const auto c = triangle.corners();
  std::vector<Vec<3>> points;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      points.push_back(c[0] + (c[1] - c[0]) * i / n + (c[2] - c[0]) * j / n);
    }
  }
  return points;
}

constexpr int kUnclear = -1;

/// How many local minima the distance from x to the union of the pieces has below a radius, by
/// looking at the samples alone; kUnclear where they are too coarse to tell.
template <int Dim>
int minima_of_distance(const std::vector<std::vector<Vec<Dim>>>& pieces, double step,
                       const Vec<Dim>& x, double radius) {
  std::vector<Vec<Dim>> minima;
  for (const auto& piece : pieces) {
    const Vec<Dim>* nearest = &piece.front();
    for (const auto& p : piece) {
      if ((p - x).squaredNorm() < (*nearest - x).squaredNorm()) nearest = &p;
    }
    const double distance = (*nearest - x).norm();
    if (std::abs(distance - radius) < 2 * step) return kUnclear;
    if (distance > radius) continue;
    bool least = true;
    for (const auto& other : pieces) {
      if (&other == &piece) continue;
      double apart = 1e300;
      bool lower = false;
      for (const auto& p : other) {
        const double away = (p - *nearest).norm();
        apart = std::min(apart, away);
        lower = lower || (away < 4 * step && (p - x).norm() < distance - 1e-12);
      }
      if (apart > 1e-9 && apart < 6 * step) return kUnclear;
      if (apart < 1e-9 && lower) least = false;
    }
    const bool known = std::any_of(minima.begin(), minima.end(),
                                   [&](const Vec<Dim>& m) { return (m - *nearest).norm() < 1e-9; });
    if (least && !known) minima.push_back(*nearest);
  }
  return static_cast<int>(minima.size());
}

/// How often contacts are those points of a surface where the distance has a minimum.
struct Minima {
  int wrong = 0;    ///< another number of contacts than of minima
  int lost = 0;     ///< within reach of the surface, and no contact
  int several = 0;  ///< more than one minimum
  int clear = 0;    ///< places where samples tell the number of minima

  template <int Dim>
  void compare(const std::vector<std::vector<Vec<Dim>>>& pieces, double step,
               const std::vector<Wall<Dim>>& walls, const Vec<Dim>& x, double radius) {
    const int expected = minima_of_distance<Dim>(pieces, step, x, radius);
    const int found = static_cast<int>(contacts_at<Dim>(walls, x, radius).size());
    double distance = std::numeric_limits<double>::infinity();
    for (const auto& wall : walls) distance = std::min(distance, wall.foot(x).distance);
    lost += distance < radius && found == 0;
    if (expected == kUnclear) return;
    ++clear;
    several += expected > 1;
    wrong += found != expected;
  }
};

/// Triangles round a middle, up and down: corners, edges, ridges and valleys.
std::vector<Wall<3>> fan(const Vec<3>& middle, int count, Random& random, double roughness) {
  std::vector<Vec<3>> rim;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * (k + random.uniform(-0.3, 0.3)) / count;
    const double reach = random.uniform(0.6, 1.4);
    rim.push_back(
        {reach * std::cos(angle), reach * std::sin(angle), roughness * random.uniform(-1, 1)});
  }
  std::vector<Wall<3>> walls;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    walls.push_back(Wall<3>::plate("t", {middle, rim[k], rim[(k + 1) % rim.size()]}));
  }
  return walls;
}

}  // namespace

TEST_SUITE("surfaces") {
  // ---- Flat joints
  // -------------------------------------------------------------------------------

  TEST_CASE_TEMPLATE("a grain rests on a flat joint as it rests anywhere else", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const double offsets[] = {-1.5,  -0.3,  -1e-3, -3e-5, -1e-6, -1e-8, -1e-9, -1e-12, -1e-16, 0,
                              1e-16, 1e-12, 1e-9,  1e-8,  1e-6,  3e-5,  1e-3,  0.2,    1.1};
    // By how much a piece goes beyond the place where the next one begins, and lies above it [m].
    for (const auto& misfit : {std::pair{0.0, 0.0},
                               {5e-16, 0.0},
                               {-5e-16, 0.0},
                               {1e-9, 0.0},
                               {-1e-9, 0.0},
                               {0.0, 1e-16},
                               {0.0, 1e-9},
                               {0.0, -1e-9}}) {
      const double beyond = misfit.first;
      const double above = misfit.second;
      for (const bool in_order : {true, false}) {
        CAPTURE(beyond);
        CAPTURE(above);
        CAPTURE(in_order);
        Random random(3);
        std::vector<Wall<Dim>> walls;
        std::vector<Grain<Dim>> list;
        for (std::size_t k = 0; k < std::size(offsets); ++k) {
          const double x = 4.0 * static_cast<double>(k);
          walls.push_back(flat_piece<Dim>("left", at<Dim>(x - 2, 0), at<Dim>(x + beyond, 0)));
          walls.push_back(flat_piece<Dim>("right", at<Dim>(x, above), at<Dim>(x + 2, 0)));
          list.push_back(ball<Dim>(at<Dim>(x + offsets[k], 1)));
        }
        if (!in_order) walls = mixed(walls, random);
        auto sim = make_sim<Dim>(list, soft_landing(), walls, 1, -kGravity * up<Dim>());

        run_for(sim, 1);

        CHECK(wall_contacts(sim) == static_cast<int>(list.size()));
        for (std::size_t k = 0; k < list.size(); ++k) {
          CAPTURE(offsets[k]);
          const double height = sim.grains().position.col(static_cast<int>(k)).dot(up<Dim>());
          const double allowed = above == 0 ? 1e-9 * kSunk : 2e-9;
          CHECK(std::abs(1 - height - kSunk) < allowed);
        }
        Vec<Dim> all = Vec<Dim>::Zero();
        for (const auto& wall : sim.walls()) all += wall.force;
        const double weight = kGravity * static_cast<double>(list.size());
        CHECK((all + weight * up<Dim>()).norm() < 1e-6 * weight);
      }
    }
  }

  TEST_CASE("joints that a person writes with rounding are joints") {
    // 0.1 + 0.2 and 0.3; 0.7 and seven tenths added up.
    const double tenths = 0.1 + 0.1 + 0.1 + 0.1 + 0.1 + 0.1 + 0.1;
    for (const auto& joint : {std::pair{0.1 + 0.2, 0.3},
                              {0.3, 0.1 + 0.2},
                              {0.7, tenths},
                              {tenths, 0.7},
                              {1.0 / 3, 0.3333333333},
                              {0.3333333333, 1.0 / 3}}) {
      const double end = joint.first;
      const double begin = joint.second;
      CAPTURE(end);
      std::vector<Wall<2>> walls{Wall<2>::segment("a", {-1, 0}, {end, 0}),
                                 Wall<2>::segment("b", {begin, 0}, {2, 0})};
      join_walls(walls);
      for (const double x : {begin, end, 0.5 * (begin + end), std::nextafter(end, 9.0),
                             std::nextafter(begin, -9.0), end + 1e-9, begin - 1e-9}) {
        CAPTURE(x - begin);
        CHECK(contacts_at<2>(walls, {x, 0.05}, 0.0501).size() == 1);
        CHECK(contacts_at<2>(walls, {x, -0.05}, 0.0501).size() == 1);
      }
    }
  }

  TEST_CASE("a point written twice, with another last digit, makes no second contact") {
    // A piece as short as rounding has any direction, and its neighbours are known no better.
    const Vec<2> along(0.6, 0.8), away(-0.8, 0.6);
    for (const Vec<2>& slip : {Vec<2>(1.2e-16, 0), {-1.2e-16, 1.2e-16}, {1e-15, 1e-15}}) {
      const Vec<2> joint = 0.3 * along;
      std::vector<Vec<2>> points{-2 * along, joint, joint + slip, 1 * along, 3 * along};
      REQUIRE(points[1] != points[2]);
      std::vector<WallPiece<2>> pieces;
      for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        pieces.push_back(WallSegment(points[k], points[k + 1]));
      }
      std::vector<Wall<2>> walls{Wall<2>::sheet("line", Vec<2>::Zero(), pieces)};
      join_walls(walls);
      for (double x = -0.5; x < 1.5; x += 1.0 / 64) {
        CAPTURE(x);
        CHECK(contacts_at<2>(walls, x * along + 0.9 * away, 1).size() == 1);
        CHECK(contacts_at<2>(walls, x * along - 0.9 * away, 1).size() == 1);
      }
      CHECK(contacts_at<2>(walls, joint + 0.9 * away, 1).size() == 1);
    }
  }

  TEST_CASE("exactly on an oblique flat joint, one of the two carries: segments") {
    Random random(7);
    int not_once = 0;
    for (int k = 0; k < cases(2000, 100000); ++k) {
      const Vec<2> t = random_direction<2>(random), n = t.unitOrthogonal();
      const Vec<2> joint = 3 * random_direction<2>(random);
      const Vec<2> a = joint - random.uniform(0.5, 2) * t, b = joint + random.uniform(0.5, 2) * t;
      std::vector<Wall<2>> walls{Wall<2>::segment("a", a, joint), Wall<2>::segment("b", joint, b)};
      walls = mixed(walls, random);
      join_walls(walls);
      const Vec<2> x = joint + 0.1 * n;
      not_once += contacts_at<2>(walls, x, 0.11).size() != 1;
    }
    CHECK(not_once == 0);
  }

  TEST_CASE("exactly on an oblique flat joint, one of the two carries: triangles") {
    Random random(8);
    int not_once = 0;
    for (int k = 0; k < cases(2000, 100000); ++k) {
      const Vec<3> t = random_direction<3>(random), n = t.unitOrthogonal(), u = n.cross(t);
      const Vec<3> a = random_place(random, 3), b = a + random.uniform(0.5, 2) * t;
      const Vec<3> c = a + 0.4 * t + random.uniform(0.5, 2) * u;
      const Vec<3> d = a + 0.7 * t - random.uniform(0.5, 2) * u;
      std::vector<Wall<3>> walls{Wall<3>::plate("c", {a, b, c}), Wall<3>::plate("d", {a, b, d})};
      walls = mixed(walls, random);
      join_walls(walls);
      const Vec<3> x = a + random.uniform() * (b - a) + 0.1 * n;
      not_once += contacts_at<3>(walls, x, 0.11).size() != 1;
    }
    CHECK(not_once == 0);
  }

  TEST_CASE("a grain rests anywhere on a floor of triangles") {
    const Vec<3> rim[] = {{2, 0, 0},  {2, 2, 0},   {0, 2, 0},  {-2, 2, 0},
                          {-2, 0, 0}, {-2, -2, 0}, {0, -2, 0}, {2, -2, 0}};
    const Vec<3> middle(0.3, -0.2, 0);
    const Vec<3> spots[] = {middle,
                            {0, 0, 0},
                            {0.9, 0.4, 0},
                            {1.15, -0.1, 0},  // on an edge
                            middle + Vec<3>(1e-9, 0, 0),
                            middle - Vec<3>(0, 1e-4, 0),
                            {1.15, 0.9, 0},  // on another
                            {-0.85, -0.1, 0},
                            {-0.2, -0.1, 0}};
    for (const bool in_order : {true, false}) {
      Random random(4);
      std::vector<Wall<3>> walls;
      std::vector<Grain<3>> list;
      for (std::size_t k = 0; k < std::size(spots); ++k) {
        const Vec<3> shift(4.0 * static_cast<double>(k), 0, 0);
        for (std::size_t c = 0; c < 8; ++c) {
          walls.push_back(
              Wall<3>::plate("t", {middle + shift, rim[c] + shift, rim[(c + 1) % 8] + shift}));
        }
        list.push_back(ball<3>(spots[k] + shift + Vec<3>(0, 0, 1)));
      }
      if (!in_order) walls = mixed(walls, random);
      auto sim = make_sim<3>(list, soft_landing(), walls, 1, -kGravity * up<3>());

      run_for(sim, 1);

      CHECK(wall_contacts(sim) == static_cast<int>(list.size()));
      for (int k = 0; k < static_cast<int>(list.size()); ++k) {
        CAPTURE(k);
        CHECK(relative_error(1 - sim.grains().position(2, k), kSunk) < 1e-9);
      }
    }
  }

  TEST_CASE_TEMPLATE("a grain rolls over joints, with a stretched spring, as on one long piece", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    std::vector<Vec<2>> points;
    for (int k = 0; k <= 13; ++k) points.emplace_back(-0.5 + 0.53 * k, 0);
    for (const double refinement : {1.0, 3.7}) {
      CAPTURE(refinement);
      expect_same_rolling<Dim>(rolled<Dim>(points, refinement, 1.1),
                               rolled<Dim>({points.front(), points.back()}, refinement, 1.1));
    }
  }

  TEST_CASE_TEMPLATE("a grain rolls over pieces that are shorter than its way in a step", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    std::vector<Vec<2>> points;
    for (int k = 0; k <= 600; ++k) points.emplace_back(-0.3 + 0.0023 * k, 0);
    expect_same_rolling<Dim>(rolled<Dim>(points, 1, 0.1),
                             rolled<Dim>({points.front(), points.back()}, 1, 0.1));
  }

  TEST_CASE_TEMPLATE("a grain rolls down a slope of pieces with the acceleration of a rigid one", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const double slope = 0.3, refinement = 1;
    const auto law = make_law<FrictionalSpring>({.stiffness = kStiff,
                                                 .restitution = 0.2,
                                                 .friction = 0.5,
                                                 .tangential_damping_ratio = 0.3});
    const Vec<2> down(std::cos(slope), -std::sin(slope)), n(std::sin(slope), std::cos(slope));
    const double sunk = kGravity * std::cos(slope) / kStiff;
    std::vector<Vec<2>> points;
    for (int k = 0; k <= 24; ++k) points.push_back(0.31 * (k - 1) * down);
    const Vec<2> start = (1 - sunk) * n;
    auto sim = make_sim<Dim>({ball<Dim>(at<Dim>(start[0], start[1]))}, law, polyline<Dim>(points),
                             refinement, -kGravity * up<Dim>());
    const Vec<Dim> way = at<Dim>(down[0], down[1]);

    run_for(sim, 0.5);
    const double before = sim.grains().velocity.col(0).dot(way), from = sim.time();
    double least = 1e300, most = -1e300;
    while (sim.time() < 2.3) {
      sim.step();
      Vec<Dim> on_walls = Vec<Dim>::Zero();
      for (const auto& wall : sim.walls()) on_walls += wall.force;
      const double friction = on_walls.dot(way);  // it drags the slope down
      least = std::min(least, friction);
      most = std::max(most, friction);
    }

    CHECK(sim.grains().position.col(0).dot(way) > 0.31 * 15);
    const double expected = kGravity * std::sin(slope) / (1 + kInertiaFactor<Dim>);
    const double a = (sim.grains().velocity.col(0).dot(way) - before) / (sim.time() - from);
    // The arm is shorter than the radius by the overlap, 1e-4 of it.
    CHECK(relative_error(a, expected) < 3e-4);
    const double held = kGravity * std::sin(slope) - expected;
    CHECK(relative_error(least, held) < 1e-3);
    CHECK(relative_error(most, held) < 1e-3);
    CHECK(most - least < 1e-6 * held);
  }

  TEST_CASE_TEMPLATE("a spring is carried along by pieces that move together", S, Space<2>,
                     Space<3>) {
    // A belt of two pieces pulls a grain along; the joint passes under it.
    constexpr int Dim = S::Dim;
    const auto law =
        make_law<FrictionalSpring>({.stiffness = kStiff, .restitution = 0.2, .friction = 0.5});
    const auto pulled = [&](const std::vector<Vec<2>>& points) {
      auto walls = polyline<Dim>(points);
      for (auto& wall : walls) wall.motion = Steady<Dim>{-0.1 * along<Dim>()};
      auto sim =
          make_sim<Dim>({ball<Dim>(at<Dim>(0, 1 - kSunk))}, law, walls, 1, -kGravity * up<Dim>());
      int most = 0;
      while (sim.time() < 0.3) {
        sim.step();
        most = std::max(most, wall_contacts(sim));
      }
      return std::tuple{sim.grains().velocity.col(0).eval(), sim.grains().omega.col(0).eval(),
                        sim.flow().wall_work, most};
    };

    const auto [v, omega, work, most] = pulled({{-2, 0}, {0.011, 0}, {0.02, 0}, {2, 0}});
    const auto [v1, omega1, work1, most1] = pulled({{-2, 0}, {2, 0}});

    CHECK(most == 1);
    CHECK(v1.norm() > 0.01);
    CHECK((v - v1).norm() < 1e-9 * v1.norm());
    CHECK((omega - omega1).norm() < 1e-9 * omega1.norm());
    CHECK(relative_error(work, work1) < 1e-9);
  }

  TEST_CASE_TEMPLATE("without friction a grain slides over joints as over nothing", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const auto law = make_law<LinearSpring>({.stiffness = kStiff});
    std::vector<Vec<2>> points;
    for (int k = 0; k <= 40; ++k) points.emplace_back(-0.2 + 0.173 * k, 0);
    Random random(5);
    auto g = ball<Dim>(at<Dim>(0, 1 - kSunk));
    g.velocity = 5 * along<Dim>();
    auto sim =
        make_sim<Dim>({g}, law, mixed(polyline<Dim>(points), random), 2.3, -kGravity * up<Dim>());
    const double start = energy_ledger(sim).balance();
    double thrown = 0, deepest = 0;
    while (sim.time() < 1.2) {
      sim.step();
      thrown = std::max(thrown, sim.grains().position.col(0).dot(up<Dim>()) - (1 - kSunk));
      deepest = std::max(deepest, (1 - kSunk) - sim.grains().position.col(0).dot(up<Dim>()));
      CHECK(wall_contacts(sim) == 1);
    }

    CHECK(sim.grains().position.col(0).dot(along<Dim>()) > 5);
    CHECK(thrown < 1e-9 * kSunk);
    CHECK(deepest < 1e-9 * kSunk);
    CHECK((sim.grains().velocity.col(0) - 5 * along<Dim>()).norm() < 1e-10);
    CHECK(relative_error(energy_ledger(sim).balance(), start) < 1e-12);
  }

  // ---- Convex joints
  // -----------------------------------------------------------------------------

  TEST_CASE_TEMPLATE("a grain goes round a convex corner in one contact", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const double angle : {1e-9, 1e-3, 0.3, 1.2, 2.5}) {  // by which the surface bends
      for (const bool in_order : {true, false}) {
        CAPTURE(angle);
        Random random(6);
        auto walls = polyline<Dim>({{-2, 0}, {0, 0}, {2 * std::cos(angle), -2 * std::sin(angle)}});
        if (!in_order) walls = mixed(walls, random);
        join_walls(walls);
        int off = 0;
        for (int k = 0; k <= 400; ++k) {
          // From the vertical above the first face to beyond the normal of the second.
          const double turned = -0.3 + k * (angle + 0.6) / 400;
          const Vec<Dim> arm = at<Dim>(std::sin(turned), std::cos(turned));
          const auto found = contacts_at<Dim>(walls, 0.9 * arm, 1);
          if (found.size() != 1) {
            ++off;
            continue;
          }
          const double t = std::clamp(turned, 0.0, angle);
          const Vec<Dim> normal = at<Dim>(std::sin(t), std::cos(t));
          CHECK((found[0].normal - normal).norm() < 1e-12);
          CHECK(relative_error(found[0].distance, 0.9 * std::cos(turned - t)) < 1e-12);
        }
        CHECK(off == 0);
      }
    }
  }

  TEST_CASE_TEMPLATE("a disc pushed round a corner is pushed by the corner, without loss", S,
                     Space<2>, Space<3>) {
    // It flies along a floor that bends down by half a right angle, and hits nothing on the way.
    constexpr int Dim = S::Dim;
    const auto law = make_law<LinearSpring>({.stiffness = kStiff});
    auto g = ball<Dim>(at<Dim>(-1, 1 - kSunk));
    g.velocity = 0.5 * along<Dim>();
    auto sim = make_sim<Dim>({g}, law, polyline<Dim>({{-3, 0}, {0, 0}, {3, -3}}), 10,
                             -kGravity * up<Dim>());
    const double start = energy_ledger(sim).balance();
    double left_at = -1;  // angle of the arm from the vertical where it leaves the corner
    while (sim.time() < 3.2 && left_at < 0) {
      sim.step();
      const int contacts = wall_contacts(sim);
      CHECK(contacts <= 1);
      const auto x = sim.grains().position.col(0);
      if (contacts == 0) left_at = std::atan2(x.dot(along<Dim>()), x.dot(up<Dim>()));
    }

    // On the circle about the corner: v^2 = v0^2 + 2 g r (1 - cos a), and it flies off where
    // g cos a = v^2 / r, unless it reaches the slope (a = 45 degrees) before: cos a = 2/3 + v0^2 /
    // (3 g r) = 0.675 there.
    CHECK(relative_error(energy_ledger(sim).balance(), start) < 1e-6);
    CHECK(left_at < 0);
    CHECK(relative_error(sim.grains().velocity.col(0).squaredNorm() / 2 +
                             kGravity * sim.grains().position.col(0).dot(up<Dim>()),
                         start) < 1e-4);
  }

  TEST_CASE_TEMPLATE("outside of a box of pieces there is one contact, with the nearest point", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(9);
    int wrong = 0, checked = 0;
    for (int k = 0; k < cases(60, 2000); ++k) {
      const auto box = random_box<Dim>(random);
      auto walls = mixed(box.pieces(k % 2 == 1), random);
      join_walls(walls);
      for (int n = 0; n < 50; ++n) {
        Vec<Dim> x, nearest;
        for (int d = 0; d < Dim; ++d) {
          x[d] = random.uniform(-1, 1) * (box.half[d] + 0.5);
          // Some right above an edge, a corner, or the middle line of a face.
          if (random.uniform() < 0.2) x[d] = box.half[d] * (random.below(3) - 1);
        }
        nearest = x.cwiseMin(box.half).cwiseMax(-box.half);
        const double distance = (x - nearest).norm();
        if (distance < 0.01 || distance > 0.49) continue;
        ++checked;
        const auto found = contacts_at<Dim>(walls, box.outside(x), 0.5);
        if (found.size() != 1) {
          ++wrong;
          continue;
        }
        CHECK(std::abs(found[0].distance - distance) < 1e-12);
        CHECK((found[0].normal - box.turn * (x - nearest) / distance).norm() < 1e-10);
      }
    }
    CHECK(checked > 500);
    CHECK(wrong == 0);
  }

  TEST_CASE_TEMPLATE("inside of a box of pieces every face within reach is touched", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(10);
    int wrong = 0;
    for (int k = 0; k < cases(60, 2000); ++k) {
      const auto box = random_box<Dim>(random);
      auto walls = mixed(box.pieces(k % 2 == 1), random);
      join_walls(walls);
      for (int n = 0; n < 50; ++n) {
        Vec<Dim> x;
        for (int d = 0; d < Dim; ++d) x[d] = random.uniform(-1, 1) * (box.half[d] - 0.01);
        int expected = 0;
        for (int d = 0; d < Dim; ++d) {
          expected += (box.half[d] - x[d] < 0.5) + (box.half[d] + x[d] < 0.5);
        }
        wrong += static_cast<int>(contacts_at<Dim>(walls, box.outside(x), 0.5).size()) != expected;
      }
    }
    CHECK(wrong == 0);
  }

  TEST_CASE("round the top of a pyramid there is one contact") {
    const Vec<3> top(0.1, 0.2, 1);
    for (const double height : {1e-6, 0.05, 0.5, 3.0}) {
      CAPTURE(height);
      const Vec<3> base[] = {
          {1, 1, 1 - height}, {-1, 1, 1 - height}, {-1, -1, 1 - height}, {1, -1, 1 - height}};
      std::vector<Wall<3>> walls;
      for (std::size_t k = 0; k < 4; ++k) {
        walls.push_back(Wall<3>::plate("side", {top, base[k], base[(k + 1) % 4]}));
      }
      Random random(11);
      walls = mixed(walls, random);
      join_walls(walls);
      int wrong = 0;
      for (int k = 0; k < 2000; ++k) {
        Vec<3> arm = random_direction<3>(random);
        if (k % 10 == 0) arm = Vec<3>(0, 0, 1);
        // Outside: above all four planes.
        const Vec<3> x = top + 0.3 * arm;
        bool above = true;
        for (std::size_t c = 0; c < 4; ++c) {
          const Vec<3> n = (base[c] - top).cross(base[(c + 1) % 4] - top).normalized();
          above = above && arm.dot(n[2] > 0 ? n : Vec<3>(-n)) > 1e-6;
        }
        if (!above) continue;
        wrong += contacts_at<3>(walls, x, 0.31).size() != 1;
      }
      CHECK(wrong == 0);
      const auto found = contacts_at<3>(walls, top + Vec<3>(0, 0, 0.3), 0.31);
      REQUIRE(found.size() == 1);
      CHECK((found[0].normal - up<3>()).norm() < 1e-5);
    }
  }

  // ---- Concave joints and joints in the form of a T
  // ----------------------------------------------

  TEST_CASE_TEMPLATE("in a groove both faces carry, as statics says", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const double slope : {0.1, 0.6, 1.2}) {
      CAPTURE(slope);
      const double c = 4 * std::cos(slope), s = 4 * std::sin(slope);
      const double load = kGravity / (2 * std::cos(slope));
      const double height = (1 - load / kStiff) / std::cos(slope);
      auto sim = make_sim<Dim>({ball<Dim>(at<Dim>(0, height + 1e-5))}, soft_landing(),
                               polyline<Dim>({{-c, s}, {0, 0}, {c, s}}), 1, -kGravity * up<Dim>());
      run_for(sim, 2);

      CHECK(wall_contacts(sim) == 2);
      CHECK(relative_error(sim.walls()[0].force.norm(), load) < 1e-9);
      CHECK(relative_error(sim.walls()[1].force.norm(), load) < 1e-9);
      CHECK(relative_error(sim.grains().position.col(0).dot(up<Dim>()), height) < 1e-12);
    }
  }

  TEST_CASE_TEMPLATE("a piece that stands in the inside of another meets it", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    // The foot of the second piece lies on the first, or a rounding below or above it.
    for (const double sunk : {0.0, 1e-17, -1e-17, 1e-12, -1e-12, 1e-10, -1e-10, 9e-10, -9e-10}) {
      for (const bool first : {true, false}) {
        CAPTURE(sunk);
        CAPTURE(first);
        std::vector<Wall<Dim>> walls{flat_piece<Dim>("floor", at<Dim>(-2, 0), at<Dim>(1.7, 0)),
                                     flat_piece<Dim>("post", at<Dim>(0.1, -sunk), at<Dim>(0.1, 2))};
        if (!first) std::swap(walls[0], walls[1]);
        join_walls(walls);
        // In the corner both; under the floor the floor alone; on top of the post its end.
        CHECK(contacts_at<Dim>(walls, at<Dim>(0.19, 0.09), 0.1).size() == 2);
        CHECK(contacts_at<Dim>(walls, at<Dim>(0.01, 0.09), 0.1).size() == 2);
        CHECK(contacts_at<Dim>(walls, at<Dim>(0.1, 2.09), 0.1).size() == 1);
        for (const double x :
             {0.1, 0.1 + 1e-9, 0.1 + 3e-7, 0.1 - 2e-6, 0.1 + 1e-5, 0.1 - 1e-4, 0.1 + 1e-3, 0.15}) {
          CAPTURE(x - 0.1);
          CHECK(contacts_at<Dim>(walls, at<Dim>(x, -0.09), 0.1).size() == 1);
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("joints written with seven digits, as people and single precision write them",
                     S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    // A post whose foot misses an oblique floor by a rounding of its coordinates, one way or other.
    for (const double off : {3e-8, -3e-8}) {
      CAPTURE(off);
      std::vector<Wall<Dim>> walls{
          flat_piece<Dim>("floor", at<Dim>(-1, -1), at<Dim>(1, 1)),
          flat_piece<Dim>("post", at<Dim>(0.1 + off, 0.1 - off), at<Dim>(-0.9, 1.1))};
      join_walls(walls);
      const Vec<Dim> n = at<Dim>(-std::sqrt(0.5), std::sqrt(0.5));
      const Vec<Dim> t = at<Dim>(std::sqrt(0.5), std::sqrt(0.5));
      for (const double x : {0.0, 1e-6, 1e-4, -1e-3}) {
        CAPTURE(x);
        CHECK(contacts_at<Dim>(walls, at<Dim>(0.1, 0.1) + x * t - 0.099 * n, 0.1).size() == 1);
      }
    }
    // Two flat pieces whose ends differ by as much.
    for (const auto& misfit : {std::pair{3e-8, 0.0}, {-3e-8, 0.0}, {0.0, 3e-8}}) {
      const double beyond = misfit.first;
      const double above = misfit.second;
      CAPTURE(beyond);
      CAPTURE(above);
      std::vector<Wall<Dim>> walls{flat_piece<Dim>("a", at<Dim>(-1, 0), at<Dim>(beyond, 0)),
                                   flat_piece<Dim>("b", at<Dim>(0, above), at<Dim>(1, 0))};
      join_walls(walls);
      for (const double x : {0.0, 1e-8, -1e-8, 1e-6, 1e-5, -1e-4, 1e-3}) {
        CAPTURE(x);
        CHECK(contacts_at<Dim>(walls, at<Dim>(x, 0.099), 0.1).size() == 1);
      }
    }
  }

  TEST_CASE_TEMPLATE("a post on a half-space is part of its surface", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    std::vector<Wall<Dim>> walls{Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>()),
                                 flat_piece<Dim>("post", at<Dim>(0, 0), at<Dim>(0, 1)),
                                 flat_piece<Dim>("ramp", at<Dim>(2, 0), at<Dim>(4, 1))};
    join_walls(walls);

    CHECK(contacts_at<Dim>(walls, at<Dim>(0.09, 0.09), 0.1).size() == 2);
    CHECK(contacts_at<Dim>(walls, at<Dim>(0, 1.09), 0.1).size() == 1);
    // Before the foot of the ramp the floor alone, further in the ramp too.
    CHECK(contacts_at<Dim>(walls, at<Dim>(1.92, 0.08), 0.1).size() == 1);
    CHECK(contacts_at<Dim>(walls, at<Dim>(1.955, 0.08), 0.1).size() == 1);
    CHECK(contacts_at<Dim>(walls, at<Dim>(1.97, 0.08), 0.1).size() == 2);
    CHECK(contacts_at<Dim>(walls, at<Dim>(1.99, 0.09), 0.1).size() == 2);
  }

  TEST_CASE("a rib under a floor, wider than the floor, is touched through the floor no more") {
    // Neither has a corner on the other, and yet the rib's upper edge lies on the floor.
    std::vector<Wall<3>> walls{
        Wall<3>::plate("floor", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}),
        Wall<3>::plate("rib", {{0, -2, 0}, {0, 2, 0}, {0, 2, -1}, {0, -2, -1}})};
    join_walls(walls);

    CHECK(contacts_at<3>(walls, {0, 0.3, 0.09}, 0.1).size() == 1);
    CHECK(contacts_at<3>(walls, {0.01, 0.3, 0.09}, 0.1).size() == 1);
    CHECK(contacts_at<3>(walls, {0.09, 0.3, -0.09}, 0.1).size() == 2);
    CHECK(contacts_at<3>(walls, {0, 1.5, 0.09}, 0.1).size() == 1);
  }

  TEST_CASE_TEMPLATE("pieces that lie on each other are one surface", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    // The second begins before the first ends; the third is the first once more.
    std::vector<Wall<Dim>> walls{flat_piece<Dim>("a", at<Dim>(-2, 0), at<Dim>(1, 0)),
                                 flat_piece<Dim>("b", at<Dim>(0, 0), at<Dim>(3, 0)),
                                 flat_piece<Dim>("c", at<Dim>(-2, 0), at<Dim>(1, 0))};
    join_walls(walls);

    for (const double x : {-1.0, 0.0, 0.5, 1.0, 2.0}) {
      CAPTURE(x);
      CHECK(contacts_at<Dim>(walls, at<Dim>(x, 0.09), 0.1).size() == 1);
    }
  }

  // ---- Moving pieces
  // -----------------------------------------------------------------------------

  TEST_CASE_TEMPLATE("a gap that opens makes two corners of a joint, and one again when it closes",
                     S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto walls = polyline<Dim>({{-2, 0}, {0, 0}, {2, 0}});
    walls[1].motion = Shake<Dim>{0.4 * along<Dim>(), 1};
    join_walls(walls);
    const auto count = [&](double t, double x, double height) {
      for (auto& wall : walls) wall.advance(t, 0);
      return contacts_at<Dim>(walls, at<Dim>(x, height), 0.5).size();
    };

    CHECK(count(0, 0, 0.49) == 1);
    CHECK(count(0.25, 0.2, 0.4) == 2);  // the gap is 0.4 wide: 0.2 from both corners
    CHECK(count(0.25, 0.2, 0.49) == 0);
    CHECK(count(0.25, -0.3, 0.49) == 1);
    CHECK(count(0.5, 0, 0.49) == 1);  // closed again, to rounding
    CHECK(count(0.5, 0.3, 0.49) == 1);
  }

  TEST_CASE_TEMPLATE("a piece that comes to lie on a half-space is one surface with it", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const std::size_t mover : {0, 1}) {
      CAPTURE(mover);
      std::vector<Wall<Dim>> walls{Wall<Dim>::half_space("floor", Vec<Dim>::Zero(), up<Dim>()),
                                   flat_piece<Dim>("lid", at<Dim>(-2, 1), at<Dim>(2, 1))};
      walls[mover].motion = Steady<Dim>{mover == 0 ? up<Dim>() : Vec<Dim>(-up<Dim>()), 0, 1};
      join_walls(walls);
      const auto count = [&](double t, double height) {
        for (auto& wall : walls) wall.advance(t, 0);
        return contacts_at<Dim>(walls, at<Dim>(0.3, walls[0].point[Dim - 1] + height), 0.5).size();
      };

      CHECK(count(0, 0.45) == 1);
      CHECK(count(0.1, 0.45) == 2);  // between the two
      CHECK(count(1, 0.45) == 1);
    }
  }

  TEST_CASE_TEMPLATE("a grain over a gap rests on its two corners", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    auto walls = polyline<Dim>({{-3, 0}, {0, 0}, {3, 0}});
    walls[1].motion = Steady<Dim>{0.5 * along<Dim>(), 0, 1.2};
    auto sim = make_sim<Dim>({ball<Dim>(at<Dim>(0.3, 1))}, soft_landing(), walls, 1,
                             -kGravity * up<Dim>());
    run_for(sim, 6);

    // 0.3 from the middle of the gap to both corners, seen from the centre under this angle.
    CHECK(wall_contacts(sim) == 2);
    const auto x = sim.grains().position.col(0);
    CHECK(relative_error(x.dot(along<Dim>()), 0.3) < 1e-9);
    const double away = std::hypot(0.3, x.dot(up<Dim>()));
    const double load = kGravity / (2 * x.dot(up<Dim>()) / away);
    CHECK(relative_error(kStiff * (1 - away), load) < 1e-8);
    CHECK(relative_error(sim.walls()[0].force.norm(), load) < 1e-8);
    CHECK(relative_error(sim.walls()[1].force.norm(), load) < 1e-8);
  }

  // ---- What a contact remembers
  // ------------------------------------------------------------------

  TEST_CASE("a spring goes along to the next piece only where the contact passes to it") {
    // Between two walls that meet far below, hardly wider than the disc: in the step in which it
    // leaves the one it hits the other, with a contact that has no past.
    const auto law = make_law<FrictionalSpring>({.stiffness = kStiff, .friction = 100});
    const double lean = 0.05, gap = 1e-4;
    const double depth = (1 + 0.5 * gap) / std::sin(lean);
    const Vec<2> bottom(0, -depth);
    const Vec<2> left(-std::sin(lean), std::cos(lean)), right(std::sin(lean), std::cos(lean));
    const std::vector<Wall<2>> walls{Wall<2>::segment("left", bottom, bottom + 2 * depth * left),
                                     Wall<2>::segment("right", bottom, bottom + 2 * depth * right)};
    int in_one_step = 0;
    for (int phase = 0; phase < 10; ++phase) {
      auto g = ball<2>({1e-4 * phase, 0});
      g.velocity = {-1, 0};
      g.omega[0] = 0.2;
      auto sim = make_sim<2>({g}, law, walls, 1);
      bool were_left = false, were_right = false;
      for (int k = 0; k < 100; ++k) {
        sim.step();
        bool on_left = false, on_right = false;
        double stretch = 0, slip = 0;
        sim.for_each_wall_contact(
            [&](WallPair pair, const Touch<2>& touch, const auto&, const auto& memory) {
              (pair.wall == 0 ? on_left : on_right) = true;
              if (pair.wall == 0) return;
              stretch = memory.stretch.norm();
              slip = touch.slip.norm();
            });
        if (on_right && !were_right && were_left && !on_left) {
          ++in_one_step;
          // The slip of one step, which changes by some part in it.
          CHECK(stretch < 1.5 * slip * sim.setting().time_step);
          break;
        }
        were_left = on_left;
        were_right = on_right;
      }
    }
    CHECK(in_one_step > 0);
  }

  // ---- Any surface
  // -------------------------------------------------------------------------------

  TEST_CASE("polylines are touched where the distance to them has a minimum") {
    Random random(12);
    Minima tally;
    for (int k = 0; k < cases(60, 3000); ++k) {
      std::vector<Vec<2>> points;
      Vec<2> p(0, 0);
      for (int n = 0; n < 6; ++n) {
        points.push_back(p);
        p += random.uniform(0.3, 1.2) * random_direction<2>(random);
      }
      if (k % 3 == 0) points.push_back(points.front());  // closed
      auto walls = polyline<2>(points);
      // One more from the inside of another: a T.
      const Vec<2> fork = points[1] + random.uniform(0.2, 0.8) * (points[2] - points[1]);
      walls.push_back(Wall<2>::segment("fork", fork, fork + random_direction<2>(random)));
      walls = mixed(walls, random);
      join_walls(walls);
      constexpr int kSamples = 400;
      std::vector<std::vector<Vec<2>>> pieces;
      for (const auto& wall : walls) pieces.push_back(samples(wall, kSamples));
      for (int n = 0; n < 12; ++n) {
        const double radius = random.uniform(0.1, 0.8);
        const auto& near = pieces[static_cast<std::size_t>(random.below(6))];
        const Vec<2> x = near[static_cast<std::size_t>(random.below(kSamples))] +
                         random.uniform(0.02, 1.1) * radius * random_direction<2>(random);
        tally.compare(pieces, 1.2 / kSamples, walls, x, radius);
      }
    }
    CHECK(tally.clear > 300);
    CHECK(tally.several > 50);
    CHECK(tally.wrong == 0);
    CHECK(tally.lost == 0);
  }

  TEST_CASE("triangles are touched where the distance to them has a minimum") {
    Random random(13);
    Minima tally;
    for (int k = 0; k < cases(30, 1000); ++k) {
      auto walls = fan(0.2 * random_place(random, 1), 5 + k % 4, random, k % 2 ? 1.5 : 0.4);
      walls = mixed(walls, random);
      join_walls(walls);
      constexpr int kSamples = 50;
      std::vector<std::vector<Vec<3>>> pieces;
      for (const auto& wall : walls) pieces.push_back(samples(wall, kSamples));
      for (int n = 0; n < 20; ++n) {
        const double radius = random.uniform(0.3, 0.8);
        const Vec<3> x = random_place(random, 0.9);
        tally.compare(pieces, 2.5 / kSamples, walls, x, radius);
      }
    }
    CHECK(tally.clear > 40);
    CHECK(tally.several > 1);
    CHECK(tally.wrong == 0);
    CHECK(tally.lost == 0);
  }

  TEST_CASE("near a corner of many flat triangles there is one contact, at any distance from it") {
    Random random(18);
    int none = 0, several = 0;
    for (int k = 0; k < cases(3000, 100000); ++k) {
      // Exact corners, and corners that each triangle has rounded for itself.
      const double rounding = k % 2 == 0 ? 0 : 1e-8;
      const int count = 4 + k % 6;
      const Vec<3> middle(0.3, -0.2, 0);
      const auto rounded_corner = [&](int c) -> Vec<3> {
        const double angle = 2 * std::numbers::pi * c / count;
        return middle + Vec<3>(std::cos(angle), std::sin(angle), 0) +
               rounding * random_direction<3>(random);
      };
      std::vector<Wall<3>> walls;
      for (int c = 0; c < count; ++c) {
        walls.push_back(Wall<3>::plate("t", {middle + rounding * random_direction<3>(random),
                                             rounded_corner(c), rounded_corner(c + 1)}));
      }
      walls = mixed(walls, random);
      join_walls(walls);
      const double away = 0.3 * std::pow(10, -9 * random.uniform());
      const double angle = random.uniform(0, 2 * std::numbers::pi);
      const double height = std::pow(10, -2 * random.uniform());
      const Vec<3> x = middle + Vec<3>(away * std::cos(angle), away * std::sin(angle), height);
      const auto found = contacts_at<3>(walls, x, 1.001 * height);
      none += found.empty();
      several += found.size() > 1;
    }
    CHECK(none == 0);
    CHECK(several == 0);
  }

  TEST_CASE("corners that agree to less than the seam make the same joints") {
    // The same corner with other last digits in each piece. Flat and convex, seen from outside: one
    // contact on every joint.
    Random random(14);
    int wrong = 0, lost = 0;
    for (int k = 0; k < cases(40, 2000); ++k) {
      auto box = random_box<3>(random);
      box.half = box.half.cwiseMax(1.0);
      std::vector<Wall<3>> walls;
      for (const auto& wall : box.pieces(true)) {
        auto corners = wall.corners();
        for (auto& corner : corners) corner += 2e-10 * random_direction<3>(random);
        walls.push_back(Wall<3>::plate("t", corners));
      }
      walls = mixed(walls, random);
      join_walls(walls);
      for (int n = 0; n < 60; ++n) {
        Vec<3> x, nearest;
        for (int d = 0; d < 3; ++d) {
          x[d] = random.uniform(-1, 1) * (box.half[d] + 0.4);
          if (random.uniform() < 0.4) x[d] = box.half[d] * (random.below(3) - 1);
          if (random.uniform() < 0.4)
            x[d] += std::pow(10, -10 * random.uniform()) * random.uniform(-0.01, 0.01);
        }
        nearest = x.cwiseMin(box.half).cwiseMax(-box.half);
        const double distance = (x - nearest).norm();
        if (distance < 0.01 || distance > 0.49) continue;
        const auto found = contacts_at<3>(walls, box.outside(x), 0.5);
        lost += found.empty();
        wrong += found.size() > 1;
      }
    }
    CHECK(lost == 0);
    CHECK(wrong == 0);
  }

  TEST_CASE("a mesh of large and small triangles with rounded corners loses no contact") {
    // Seams differ between pairs of pieces: a small one next to two large ones.
    Random random(15);
    int lost = 0;
    for (int k = 0; k < cases(3000, 100000); ++k) {
      const auto off = [&] { return Vec<3>(3e-10 * random_direction<3>(random)); };
      const Vec<3> o(0, 0, 0), a(1, 0, random.uniform(-0.3, 0.1)),
          b(0, 1, random.uniform(-0.3, 0.1)), c(-1, -1, random.uniform(-0.3, 0.1));
      const Vec<3> s(0.02, 0.001, 0);
      std::vector<Wall<3>> walls{Wall<3>::plate("l", {o + off(), a + off(), b + off()}),
                                 Wall<3>::plate("l", {o + off(), b + off(), c + off()}),
                                 Wall<3>::plate("s", {o + 0.01 * off(), c / 50, s}),
                                 Wall<3>::plate("s", {s, a / 50, o + 0.01 * off()})};
      walls = mixed(walls, random);
      join_walls(walls);
      const Vec<3> x = 0.3 * (up<3>() + 0.3 * random_direction<3>(random) *
                                            std::pow(10, -10 * random.uniform()));
      double distance = 1e300;
      for (const auto& wall : walls) distance = std::min(distance, wall.foot(x).distance);
      lost += contacts_at<3>(walls, x, distance + 1e-3).empty();
    }
    CHECK(lost == 0);
  }

  TEST_CASE_TEMPLATE("grains on a rough surface move by the same bits in every instruction set", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const auto law =
        make_law<FrictionalSpring>({.stiffness = kStiff, .restitution = 0.5, .friction = 0.5});
    Random random(16);
    std::vector<Wall<Dim>> walls;
    std::vector<Vec<2>> points;
    for (int k = 0; k <= 60; ++k) points.emplace_back(-3 + 1.1 * k, 0.8 * random.uniform());
    walls = polyline<Dim>(points);
    std::vector<Grain<Dim>> list;
    for (int k = 0; k < (Dim == 2 ? 1100 : 60); ++k) {
      auto g = ball<Dim>(at<Dim>(2.1 * (k % 28), 2.2 + 2.1 * (k / 28)));
      g.velocity = -3 * up<Dim>() + random_direction<Dim>(random);
      list.push_back(g);
    }
    const auto moved = [&](InstructionSet set, int threads) {
      auto grains = make_grains<Dim, FrictionalSpring::needs>(list);
      const LawTable<FrictionalSpring> laws(law);
      Setting<Dim> setting;
      setting.gravity = -kGravity * up<Dim>();
      setting.time_step = time_scales(grains, laws, walls).safe_step;
      setting.instructions = set;
      setting.threads = threads;
      Sim<Dim, FrictionalSpring> sim(std::move(grains), laws, walls, setting);
      sim.step(Dim == 2 ? 400 : 1200);
      CHECK(wall_contacts(sim) > 10);
      return Columns<Dim>(sim.grains().position);
    };

    const Columns<Dim> first = moved(instruction_sets().front(), 1);
    for (const InstructionSet set : instruction_sets()) {
      const bool same = moved(set, 1) == first;
      CHECK(same);
    }
    const bool same = moved(instruction_sets().back(), 4) == first;
    CHECK(same);
  }
}

TEST_SUITE("plates") {
  TEST_CASE("the foot on a plate is on its face, an edge or a corner") {
    // A square, turned and moved.
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, oblique<3>()).matrix();
    const Vec<3> shift(0.3, -2, 5);
    const auto place = [&](double x, double y, double z) {
      return Vec<3>(turn * Vec<3>(x, y, z) + shift);
    };
    const auto plate =
        Wall<3>::plate("p", {place(-1, -1, 0), place(1, -1, 0), place(1, 1, 0), place(-1, 1, 0)});
    const auto check = [&](const Vec<3>& x, double distance, const Vec<3>& normal, Feature f) {
      CHECK(relative_error(plate.foot(x).distance, distance) < 1e-14);
      CHECK((plate.foot(x).normal - turn * normal).norm() < 1e-14);
      const auto foot = plate.foot(x);
      CHECK(plate.feature(0, x - foot.distance * foot.normal, 1e-9) == f);
    };

    check(place(0.2, -0.7, 0.5), 0.5, {0, 0, 1}, Feature::face);
    check(place(0.2, -0.7, -0.5), 0.5, {0, 0, -1}, Feature::face);
    check(place(0.2, 1.3, 0.4), 0.5, {0, 0.6, 0.8}, Feature::edge);
    check(place(-1.4, 0.1, -0.3), 0.5, {-0.8, 0, -0.6}, Feature::edge);
    check(place(1.2, 1.3, 0.6), 0.7, Vec<3>(2, 3, 6) / 7, Feature::corner);
    check(place(-1.2, 1.3, 0.6), 0.7, Vec<3>(-2, 3, 6) / 7, Feature::corner);
    REQUIRE(plate.pieces());
    CHECK(plate.pieces()->largest() > 2.8);
    // Exactly on it, a normal of the plate.
    CHECK(plate.foot(place(0.3, 0.1, 0)).distance < 1e-15);
    const auto level = Wall<3>::plate("p", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(std::abs(level.foot({0.3, 0.1, 0}).normal[2]) == 1);
  }

  TEST_CASE("the foot on any convex polygon is the nearest of many points") {
    Random random(17);
    for (int k = 0; k < cases(40, 1000); ++k) {
      const int n = 3 + k % 5;
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(random.uniform(0, 6), random_direction<3>(random)).matrix();
      // Points of an ellipse make a convex polygon.
      std::vector<double> angles;
      for (int c = 0; c < n; ++c) angles.push_back(6.28 * (c + random.uniform(0, 0.7)) / n);
      std::vector<Vec<3>> corners;
      for (const double a : angles)
        corners.push_back(turn * Vec<3>(std::cos(a), 2 * std::sin(a), 0));
      if (k % 2) std::reverse(corners.begin(), corners.end());
      const auto plate = Wall<3>::plate("p", corners);
      const Vec<3> x = random_place(random, 2);
      double least = 1e300;
      for (int m = 0; m < 4000; ++m) {
        Vec<3> p = Vec<3>::Zero();
        double all = 0;
        for (const auto& corner : corners) {
          const double weight = std::pow(random.uniform(), 4);
          p += weight * corner;
          all += weight;
        }
        least = std::min(least, (p / all - x).norm());
      }
      const auto foot = plate.foot(x);
      CHECK(foot.distance <= least + 1e-12);
      CHECK(foot.distance > least - 0.15);
      // It lies on the plate.
      CHECK(plate.foot(x - foot.distance * foot.normal).distance < 1e-12);
    }
  }

  TEST_CASE("corners that make no plate are told why") {
    using Corners = std::vector<Vec<3>>;
    const Corners square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    CHECK(Plate::defect(square) == "");
    CHECK(Plate::defect({square.rbegin(), square.rend()}) == "");
    CHECK(Plate::defect({}) == "a plate needs at least 3 corners");
    CHECK(Plate::defect({square[0], square[1]}) == "a plate needs at least 3 corners");
    CHECK(Plate::defect({square[0], square[1], square[1], square[2]}) ==
          "corner 2 and corner 3 are one point");
    CHECK(Plate::defect({square[0], square[1], square[2], square[0]}) ==
          "corner 1 and corner 4 are one point");
    CHECK(Plate::defect({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}) == "the corners lie on a line");
    const std::string warped = Plate::defect({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}});
    CHECK(warped.find("does not lie in a plane with the others") != std::string::npos);
    const std::string dented = Plate::defect({{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}});
    CHECK(dented.find("no convex polygon") != std::string::npos);
    const std::string crossed = Plate::defect({square[0], square[2], square[1], square[3]});
    CHECK(crossed != "");
    CHECK(crossed.find("line") == std::string::npos);
    // A star of five turns left at every corner, and twice around.
    Corners star;
    for (int k = 0; k < 5; ++k) {
      const double angle = 2 * std::numbers::pi * 2 * k / 5;
      star.push_back({std::cos(angle), std::sin(angle), 0});
    }
    CHECK(Plate::defect(star) != "");
    // A square run around twice.
    Corners twice = square;
    twice.insert(twice.end(), square.begin(), square.end());
    CHECK(Plate::defect(twice) != "");
    CHECK_THROWS_AS(Wall<3>::plate("p", {}), ContractError);
    CHECK_THROWS_AS(Wall<3>::plate("p", {square[0], square[1]}), ContractError);
    CHECK_THROWS_AS(Wall<3>::plate("p", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}}),
                    ContractError);
    // Large and far, small and near: the size decides, not a length.
    for (const double size : {1e-9, 1e-3, 1e6}) {
      Corners scaled = square;
      for (auto& corner : scaled) corner *= size;
      CHECK(Plate::defect(scaled) == "");
      scaled[2][2] += 1e-3 * size;
      CHECK(Plate::defect(scaled) != "");
    }
    // A corner in the middle of an edge is allowed: T-joints of meshes have them.
    CHECK(Plate::defect({{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}) == "");
    // First three corners on a line.
    const auto plate =
        Wall<3>::plate("p", {{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(relative_error(plate.foot({0.5, 0.5, 0.25}).distance, 0.25) < 1e-14);
  }
}
