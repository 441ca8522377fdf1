// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Clouds and scenes that try a neighbourhood: every list is compared with brute force, every
/// trajectory bit for bit, and every step is audited.

#include <lagrain/all_pairs.hpp>
#include <lagrain/audit.hpp>

#include <support/scenes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace lagrain::test {

/// Centres [m] and radii [m].
template <int Dim>
struct Cloud {
  Columns<Dim> x;
  Eigen::VectorXd radius;
};

/// The kinds of set that trip neighbour searches.
enum class CloudKind {
  kUniform,
  kSizes,       ///< radii 1 : 100
  kClusters,    ///< a few tight heaps far from each other
  kFar,         ///< 10^6 radii from the origin
  kCoincident,  ///< centres on top of each other
  kLine,        ///< all on one line
  kFlat,        ///< all on one plane (in the plane: on one line, along an axis)
  kLattice,     ///< touching, equal: every tie there is
  kOne,
  kNone
};
inline constexpr CloudKind kClouds[] = {
    CloudKind::kUniform,    CloudKind::kSizes, CloudKind::kClusters, CloudKind::kFar,
    CloudKind::kCoincident, CloudKind::kLine,  CloudKind::kFlat,     CloudKind::kLattice,
    CloudKind::kOne,        CloudKind::kNone};

template <int Dim>
Cloud<Dim> make_cloud(CloudKind kind, int count, Random& random) {
  if (kind == CloudKind::kOne) count = 1;
  if (kind == CloudKind::kNone) count = 0;
  Cloud<Dim> cloud{Columns<Dim>(Dim, count), Eigen::VectorXd(count)};
  const double side = 2.0 * std::pow(count, 1.0 / Dim);
  const int row = static_cast<int>(std::ceil(std::pow(count, 1.0 / Dim)));
  for (int i = 0; i < count; ++i) {
    cloud.radius[i] = random.uniform(0.7, 1);
    if (kind == CloudKind::kSizes) cloud.radius[i] = std::pow(10, random.uniform(-2, 0));
    for (int d = 0, rest = i; d < Dim; ++d, rest /= row) {
      double& c = cloud.x(d, i);
      c = random.uniform(0, side);
      if (kind == CloudKind::kClusters) c = random.normal() + 1000 * ((i % 3) * (d + 1) % 3);
      if (kind == CloudKind::kFar) c += 1e6;
      if (kind == CloudKind::kCoincident && i % 3 != 0) c = cloud.x(d, i - 1);
      if (kind == CloudKind::kLine) c = 1.5 * i;
      if (kind == CloudKind::kLattice) c = 2 * (rest % row);
    }
    if (kind == CloudKind::kFlat) cloud.x(Dim - 1, i) = 0;
    if (kind == CloudKind::kLattice) cloud.radius[i] = 1;
  }
  return cloud;
}

/// Moves every grain a little, some far, some not at all.
template <int Dim>
void jostle(Cloud<Dim>& cloud, Random& random) {
  const double size = std::pow(10, random.uniform(-4, 0));
  for (Eigen::Index i = 0; i < cloud.x.cols(); ++i) {
    if (random.uniform() < 0.3) continue;
    const double far = random.uniform() < 0.02 ? 5 : 1;
    for (int d = 0; d < Dim; ++d) {
      cloud.x(d, i) += far * size * cloud.radius[i] * random.normal();
    }
  }
}

/// Lets a few grains of the cloud stray, and checks the pairs that the neighbourhood then gives for
/// them against brute force.
/// @param centre, margin  those of the neighbourhood's last answer [m]
template <int Dim, AmendableNeighbourhood<Dim> N>
void check_amendment(N& neighbourhood, Cloud<Dim>& cloud, Columns<Dim> centre,
                     Eigen::VectorXd margin, Random& random) {
  std::vector<int> strays;
  for (int i = 0; i < cloud.radius.size(); ++i) {
    if (random.uniform() > 0.1) continue;
    strays.push_back(i);
    for (int d = 0; d < Dim; ++d) cloud.x(d, i) += 3 * margin[i] * random.normal();
    margin[i] = cloud.radius[i] * random.uniform(0, 0.1);
  }
  const Eigen::VectorXd asked = margin;
  const PlaceOf<Dim> place = [&](int i) -> Vec<Dim> { return cloud.x.col(i); };
  std::vector<Pair> candidates;
  if (!neighbourhood.pairs_of(strays, place, cloud.radius, margin, candidates)) return;

  CHECK((margin.array() <= asked.array()).all());
  std::vector<char> astray(static_cast<std::size_t>(margin.size()), false);
  for (const int i : strays) {
    astray[static_cast<std::size_t>(i)] = true;
    centre.col(i) = cloud.x.col(i);
  }
  const auto of_a_stray = [&](const Pair& pair) {
    return astray[static_cast<std::size_t>(pair.i)] || astray[static_cast<std::size_t>(pair.j)];
  };
  for (int i = 0; i < margin.size(); ++i) {
    if (!astray[static_cast<std::size_t>(i)]) CHECK(margin[i] == asked[i]);
  }
  std::vector<Pair> expected;
  AllPairs<Dim>{}.near_pairs(centre, cloud.radius, margin, expected);
  std::erase_if(expected, [&](const Pair& pair) { return !of_a_stray(pair); });
  std::erase_if(candidates, [&](const Pair& pair) {
    return !of_a_stray(pair) || !within_reach<Dim>(centre, cloud.radius, margin, pair.i, pair.j);
  });
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  REQUIRE(candidates == expected);
}

/// The lists of a neighbourhood, over a walk of the cloud, are those of brute force.
template <int Dim, class N>
void check_lists(CloudKind kind, std::uint64_t seed, int count, int rounds) {
  CAPTURE(seed);
  CAPTURE(static_cast<int>(kind));
  Random random(seed);
  Cloud<Dim> cloud = make_cloud<Dim>(kind, count, random);
  N neighbourhood;
  std::vector<Pair> found;
  std::vector<Pair> expected;
  for (int round = 0; round < rounds; ++round) {
    CAPTURE(round);
    Eigen::VectorXd asked = cloud.radius * random.uniform(0, 0.1);
    Eigen::VectorXd margin = asked;

    neighbourhood.near_pairs(cloud.x, cloud.radius, margin, found);

    CHECK((margin.array() <= asked.array()).all());
    AllPairs<Dim>{}.near_pairs(cloud.x, cloud.radius, margin, expected);
    REQUIRE(found == expected);
    if constexpr (AmendableNeighbourhood<N, Dim>) {
      check_amendment<Dim>(neighbourhood, cloud, cloud.x, margin, random);
    }
    jostle(cloud, random);
  }
}

/// A scene that moves, in units of metre, kilogram, second and k = 10^5 N/m.
template <int Dim>
struct MotionScene {
  std::string name;
  std::vector<Grain<Dim>> grains;
  std::vector<Wall<Dim>> walls;
  Vec<Dim> gravity = Vec<Dim>::Zero();
};

/// Grains dropped into a box.
template <int Dim>
MotionScene<Dim> settling_bed(int count, std::uint64_t seed) {
  Random random(seed);
  const auto packed = lattice<Dim>({.count = count, .speed = 0.3}, random);
  return {"settling bed", packed.grains, box<Dim>(packed.low, packed.high), -10 * up<Dim>()};
}

/// Grains that swirl through each other in a box, fast against their sound.
template <int Dim>
MotionScene<Dim> stirring(int count, std::uint64_t seed) {
  Random random(seed);
  const auto packed = lattice<Dim>({.count = count, .speed = 10, .spin = 5}, random);
  return {"stirring", packed.grains, box<Dim>(packed.low, packed.high)};
}

/// A cloud that stirs a little and drifts fast as a whole, past a fixed wall and off a moving one.
template <int Dim>
MotionScene<Dim> drifting(int count, std::uint64_t seed) {
  Random random(seed);
  const auto packed = lattice<Dim>({.count = count, .speed = 3, .spin = 5}, random);
  MotionScene<Dim> scene{"drifting cloud", packed.grains, {}};
  const Vec<Dim> drift = 200 * along<Dim>();
  for (auto& g : scene.grains) g.velocity += drift;
  scene.walls.push_back(Wall<Dim>::half_space("ground", packed.low, up<Dim>()));
  scene.walls.push_back(Wall<Dim>::half_space("ram", packed.low, along<Dim>()));
  scene.walls.back().motion = Steady<Dim>{drift};
  return scene;
}

/// Sizes from 1 to `ratio`, scattered without overlap, every other one close to a larger one.
template <int Dim>
MotionScene<Dim> size_mix(int count, double ratio, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> radii;
  for (int i = 0; i < count; ++i) radii.push_back(std::pow(ratio, -random.uniform()));
  std::sort(radii.rbegin(), radii.rend());
  double volume = 0;
  for (const double r : radii) volume += grain_volume<Dim>(r);
  const double side = std::pow(volume / (Dim == 2 ? 0.5 : 0.25), 1.0 / Dim) + 2;
  MotionScene<Dim> scene{"sizes 1 : " + std::to_string(ratio), {}, {}};
  for (const double r : radii) {
    Grain<Dim> g;
    g.radius = r;
    g.mass = grain_volume<Dim>(r);
    for (bool fits = false; !fits;) {
      for (int d = 0; d < Dim; ++d) g.position[d] = random.uniform(r, side - r);
      if (scene.grains.size() % 2 == 1) {
        const auto k = random.below(static_cast<int>(scene.grains.size()));
        const Grain<Dim>& o = scene.grains[static_cast<std::size_t>(k)];
        const Vec<Dim> away = (g.position - o.position).normalized();
        g.position = o.position + (o.radius + r * random.uniform(1, 2)) * away;
      }
      fits = g.position.minCoeff() > r && g.position.maxCoeff() < side - r;
      for (const Grain<Dim>& o : scene.grains) {
        fits = fits && (o.position - g.position).norm() > o.radius + r;
      }
    }
    // A third of the speed that crosses a tenth of the radius in a safe step of the grain's own:
    // 100 m/s in the plane, where such steps go with r; in space they go with r^1.5.
    const double speed = 30 * std::pow(r, 1 - 0.5 * Dim);
    for (int d = 0; d < Dim; ++d) g.velocity[d] = speed * random.normal();
    scene.grains.push_back(g);
  }
  // The grains are numbered at random, so that their numbers do not follow their sizes.
  for (int i = count - 1; i > 0; --i) {
    std::swap(scene.grains[static_cast<std::size_t>(i)],
              scene.grains[static_cast<std::size_t>(random.below(i + 1))]);
  }
  scene.walls = box<Dim>(Vec<Dim>::Zero(), Vec<Dim>::Constant(side));
  return scene;
}

/// A grain that crosses more than its radius in a step, shot through the others, in the open.
template <int Dim>
MotionScene<Dim> bullet(int count, std::uint64_t seed) {
  Random random(seed);
  const auto packed = lattice<Dim>({.count = count, .spacing = 0.9, .speed = 0.1}, random);
  MotionScene<Dim> scene{"bullet", packed.grains, {}};
  Grain<Dim> shot;
  shot.radius = 0.5;
  shot.mass = 1;
  shot.position = packed.low - 3 * (packed.high - packed.low).normalized();
  shot.velocity = 1000 * (packed.high - packed.low).normalized();
  scene.grains.push_back(shot);
  return scene;
}

/// Grains of radius and density 1 at these places, at rest.
template <int Dim>
std::vector<Grain<Dim>> equal_grains(const std::vector<Vec<Dim>>& places) {
  std::vector<Grain<Dim>> grains;
  for (const Vec<Dim>& place : places) {
    Grain<Dim> g;
    g.radius = 1;
    g.mass = grain_volume<Dim>(1);
    g.position = place;
    grains.push_back(g);
  }
  return grains;
}

/// The places of a lattice of `side` layers in each direction, from the first corner on: points of
/// whole coordinates, all of them or those of even sum, so that nearest ones are 2 apart [m]. In
/// space the latter is face-centred cubic, in the plane a square lattice that stands on its corner.
template <int Dim>
std::vector<Vec<Dim>> crystal_places(int side, bool face_centred) {
  std::vector<Vec<Dim>> places;
  const double unit = face_centred ? std::sqrt(2.0) : 2;
  for (int k = 0; k < static_cast<int>(std::lround(std::pow(side, Dim))); ++k) {
    Vec<Dim> place;
    int sum = 0;
    for (int d = 0, rest = k; d < Dim; ++d, rest /= side) {
      place[d] = 1 + unit * (rest % side);
      sum += rest % side;
    }
    if (!face_centred || sum % 2 == 0) places.push_back(place);
  }
  return places;
}

/// How a perfect crystal of touching grains begins to move.
struct Disorder {
  double room = 0;  ///< between the grains and the walls on the far sides [m]
  double kick = 0;  ///< speed of the last grain, obliquely into the others [m/s]
  double stir = 0;  ///< standard deviation of all velocity components [m/s]
};

/// A perfect crystal in a box, under gravity.
template <int Dim>
MotionScene<Dim> crystal(int side, bool face_centred, const Disorder& disorder) {
  Random random(1);
  MotionScene<Dim> scene{face_centred ? "face-centred crystal" : "cubic crystal",
                         equal_grains<Dim>(crystal_places<Dim>(side, face_centred)),
                         {},
                         -10 * up<Dim>()};
  for (auto& g : scene.grains) {
    for (int d = 0; d < Dim; ++d) g.velocity[d] = disorder.stir * random.normal();
  }
  scene.grains.back().velocity -= disorder.kick * oblique<Dim>();
  const double far = 2 + (side - 1) * (face_centred ? std::sqrt(2.0) : 2) + disorder.room;
  scene.walls = box<Dim>(Vec<Dim>::Zero(), Vec<Dim>::Constant(far));
  return scene;
}

/// A cubic crystal in a box whose floor shakes.
template <int Dim>
MotionScene<Dim> shaken_box(int side, const Disorder& disorder) {
  MotionScene<Dim> scene = crystal<Dim>(side, false, disorder);
  scene.name = "shaken box";
  constexpr std::size_t kFloor = 2 * (Dim - 1);
  scene.walls[kFloor].motion = Shake<Dim>{.amplitude = 0.2 * up<Dim>(), .frequency = 4};
  return scene;
}

/// One layer of equal grains on a floor between walls, which slide and roll about on it: a flat set
/// until friction or a grain dropped from above lifts the first of them.
template <int Dim>
MotionScene<Dim> monolayer(int count, bool dropped, std::uint64_t seed) {
  Random random(seed);
  MotionScene<Dim> scene{dropped ? "monolayer, and one from above" : "monolayer", {}, {}};
  int side = 1;
  while (std::pow(side, Dim - 1) < count) ++side;
  std::vector<Vec<Dim>> places;
  for (int k = 0; k < count; ++k) {
    Vec<Dim> place = up<Dim>();
    for (int d = 0, rest = k; d < Dim - 1; ++d, rest /= side) {
      place[d] = 1.05 + 2.1 * (rest % side);
    }
    places.push_back(place);
  }
  if (dropped) {
    Vec<Dim> above = Vec<Dim>::Constant(1.05 * side);
    above[Dim - 1] = 4;
    places.push_back(above);
  }
  scene.grains = equal_grains<Dim>(places);
  for (int k = 0; k < count; ++k) {
    Vec<Dim>& velocity = scene.grains[static_cast<std::size_t>(k)].velocity;
    for (int d = 0; d < Dim - 1; ++d) velocity[d] = random.normal();
  }
  if (dropped) scene.grains.back().velocity = -10 * up<Dim>();
  scene.walls = box<Dim>(Vec<Dim>::Zero(), Vec<Dim>::Constant(2.1 * side));
  scene.gravity = -10 * up<Dim>();
  return scene;
}

/// Equal grains in a row in the open that meet; the second one also moves across, at `aside` [m/s].
template <int Dim>
MotionScene<Dim> row(int count, const Vec<Dim>& direction, double aside) {
  std::vector<Vec<Dim>> places;
  for (int k = 0; k < count; ++k) places.push_back((2.0 + 0.01 * (k % 3)) * k * direction);
  MotionScene<Dim> scene{"row", equal_grains<Dim>(places), {}};
  for (int k = 0; k < count; ++k) {
    scene.grains[static_cast<std::size_t>(k)].velocity =
        (0.5 * count - k) * 0.3 * direction;  // towards the middle
  }
  Eigen::Index axis = 0;
  direction.cwiseAbs().minCoeff(&axis);
  const Vec<Dim> across = Vec<Dim>::Unit(axis) - direction[axis] * direction;
  scene.grains[1].velocity += aside * across;
  return scene;
}

/// Runs one law through the scene; contacts may be as deep as they like.
template <int Dim, class Law, class N>
Sim<Dim, Law, N> start(const MotionScene<Dim>& scene, const Law& law, N neighbourhood = {},
                       int threads = 1, InstructionSet instructions = instruction_sets().back()) {
  auto grains = make_grains<Dim, Law::needs>(scene.grains);
  const LawTable<Law> laws(law);
  Setting<Dim> setting;
  setting.gravity = scene.gravity;
  setting.time_step = time_scales(grains, laws, scene.walls).safe_step;
  setting.largest_overlap = std::numeric_limits<double>::infinity();
  setting.threads = threads;
  setting.instructions = instructions;
  return {std::move(grains), laws, scene.walls, setting, std::move(neighbourhood)};
}

inline constexpr Material kGravel{.stiffness = 1e5,
                                  .restitution = 0.6,
                                  .friction = 0.5,
                                  .tangential_damping_ratio = 0.2,
                                  .rolling_friction = 0.1,
                                  .twisting_friction = 0.05};

struct AuditResult {
  std::int64_t contacts = 0;
  std::int64_t missed = 0;
};

/// Audits the near list after every step.
template <int Dim, class Sim>
AuditResult audited(Sim& sim, int steps) {
  ContactAudit<Dim> audit;
  for (int k = 0; k < steps; ++k) {
    sim.step();
    audit.check(sim.grains().position, sim.grains().radius, sim.near_pairs());
  }
  return {audit.contacts(), audit.missed()};
}

template <class Sim>
auto contact_memories(const Sim& sim) {
  std::vector<std::pair<Pair, typename Sim::Memory>> all;
  sim.for_each_contact([&](Pair pair, const auto&, const auto&, const auto& memory) {
    all.emplace_back(pair, memory);
  });
  return all;
}

/// Two simulations are in the same state, bit for bit, memories included. (Losses are summed in
/// parts that depend on which pairs are listed: they agree to rounding.)
template <class A, class B>
bool same_bits(const A& a, const B& b) {
  const auto& g = a.grains();
  const auto& h = b.grains();
  bool same = g.position == h.position && g.velocity == h.velocity && g.force == h.force &&
              std::abs(a.flow().dashpot - b.flow().dashpot) <= 1e-12 * b.flow().dashpot &&
              std::abs(a.flow().friction - b.flow().friction) <= 1e-12 * b.flow().friction &&
              contact_memories(a) == contact_memories(b);
  if constexpr (A::needs.spin) same = same && g.omega == h.omega && g.torque == h.torque;
  return same && g.position.allFinite();
}

/// The trajectory with N is the one with brute force.
template <int Dim, class Law, class N>
void check_trajectory(const MotionScene<Dim>& scene, int steps, N neighbourhood = {}) {
  CAPTURE(scene.name);
  const Law law = make_law<Law>(kGravel);
  auto reference = start<Dim>(scene, law, AllPairs<Dim>{});
  auto sim = start<Dim>(scene, law, std::move(neighbourhood));
  for (int k = 0; k < steps; ++k) {
    reference.step();
    sim.step();
    if (k % 100 != 99 && k + 1 != steps) continue;
    CAPTURE(k);
    REQUIRE(same_bits(sim, reference));
  }
  CHECK(sim.flow().dashpot > 0);  // something collided
}

}  // namespace lagrain::test
