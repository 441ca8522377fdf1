#include "hard_cases.hpp"


#include <lagrain/output.hpp>
#include <lagrain/restitution.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <sstream>
#include <utility>

namespace lagrain::hard_cases {

namespace {

constexpr double kGravity = 9.81;        // [m/s^2]
constexpr double kDensity = 2500;        // [kg/m^3]
constexpr double kRadius = 0.01;         // [m]
constexpr std::int64_t kLookEvery = 20;  // steps between two audits

constexpr double kDeadRestitution = 0.05;  // strong dashpots, for what is to come to rest soon

/// The distance from |x| to the next double.
double last_bit_of(double x) {
  return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x);
}

template <int Dim>
double weight(double radius) {
  return kDensity * grain_volume<Dim>(radius) * kGravity;
}

/// Stone without grains and walls. The cases count steps, so that the duration is of no account.
template <int Dim>
Scene<Dim> stone(const std::string& title, double stiffness, double restitution) {
  Scene<Dim> scene;
  scene.title = title;
  scene.duration = 1;
  scene.law.stiffness = stiffness;
  scene.law.restitution = restitution;
  scene.materials = {{"stone", kDensity}};
  return scene;
}

template <int Dim>
void fall(Scene<Dim>& scene) {
  scene.gravity = -kGravity * Vec<Dim>::Unit(Dim - 1);
}

/// Takes the largest step that the scene's contacts allow.
template <int Dim>
void step_widely(Scene<Dim>& scene) {
  scene.time_step.fraction_of_contact = 1e-3;
  scene.time_step.seconds = make_run(scene, 1)->time_scales().safe_step;
}

template <int Dim>
void put(Scene<Dim>& scene, const Vec<Dim>& position, double radius = kRadius,
         const Vec<Dim>& velocity = Vec<Dim>::Zero()) {
  PlacedGrain<Dim> grain;
  grain.position = position;
  grain.radius = radius;
  grain.velocity = velocity;
  scene.grains.push_back(grain);
}

/// A floor, and sides around a square of the given width [m] from a corner on.
template <int Dim>
void add_tub(Scene<Dim>& scene, const Vec<Dim>& corner, double width) {
  scene.walls.push_back(Wall<Dim>::half_space("floor", corner, Vec<Dim>::Unit(Dim - 1)));
  for (int axis = 0; axis < Dim - 1; ++axis) {
    const Vec<Dim> across = Vec<Dim>::Unit(axis);
    const std::string name = axis == 0 ? "side" : "front";
    scene.walls.push_back(Wall<Dim>::half_space(name, corner, across));
    scene.walls.push_back(Wall<Dim>::half_space("other " + name, corner + width * across, -across));
  }
}

/// Steps a run, holds its near list against brute force now and then, and notes what ends it.
/// @param look   called after each of these checks
/// @param every  steps between two of them
template <int Dim>
void watch(Run<Dim>& run, std::int64_t steps, Outcome& outcome, const Checkpoint& checkpoint,
           const std::function<void()>& look = {}, std::int64_t every = kLookEvery) {
  ContactAudit<Dim> audit;
  try {
    for (std::int64_t k = 1; k <= steps; ++k) {
      run.step();
      if (k % every != 0 && k != steps) continue;
      audit.check(run.positions(), run.radii(), run.near_pairs());
      if (look) look();
      if (checkpoint) checkpoint();
    }
  } catch (const SimulationError& error) {
    outcome.stopped = error.what();
  }
  outcome.steps += run.steps();
  outcome.audited += audit.contacts();
  outcome.missed += audit.missed();
  for (int i = 0; i < run.count(); ++i) {
    const Vec<Dim> x = run.positions().col(i);
    const bool outside =
        std::any_of(run.walls().begin(), run.walls().end(),
                    [&](const Wall<Dim>& wall) { return !(wall.foot(x).distance > 0); });
    outcome.lost += outside || !x.allFinite();
  }
}

/// The largest force that is left on a grain, of its weight.
template <int Dim>
double unbalanced(const Run<Dim>& run) {
  Columns<Dim> force = run.scene().gravity * run.masses().transpose();
  for (const ContactRecord<Dim>& contact : run.contacts()) {
    force.col(contact.i) += contact.force;
    if (contact.j >= 0) force.col(contact.j) -= contact.force;
  }
  double largest = 0;
  for (int i = 0; i < run.count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (k < run.scene().grains.size() && run.scene().grains[k].pinned) continue;
    largest = std::max(largest, force.col(i).norm() / (run.masses()[i] * kGravity));
  }
  return largest;
}

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The places in a frame that `record` has written. Numbers that are none stay what they are.
std::vector<Vec<2>> places_in(const std::filesystem::path& file) {
  std::istringstream text(content(file));
  std::vector<Vec<2>> places;
  std::string line, id, x, y;
  std::getline(text, line);  // the head
  while (std::getline(text, line)) {
    std::istringstream cells(line);
    std::getline(cells, id, ',');
    std::getline(cells, x, ',');
    std::getline(cells, y, ',');
    places.emplace_back(std::stod(x), std::stod(y));
  }
  return places;
}

}  // namespace

// ---- At rest -----------------------------------------------------------------------------------

namespace {

/// A weight presses a contact in by this part of the radius.
constexpr double kCrystalOverlap = 1e-5;
/// The slowest mode of a column of ten decays as exp(-1.4e-3 k) in k steps (see tower): to 1e-12.
constexpr std::int64_t kCrystalSteps = 20000;

template <int Dim>
Scene<Dim> crystal_scene(Crystal crystal, const Vec<Dim>& corner) {
  Scene<Dim> scene =
      stone<Dim>("crystal", weight<Dim>(kRadius) / (kCrystalOverlap * kRadius), kDeadRestitution);
  fall(scene);
  const int across = Dim == 2 ? 10 : 5, layers = Dim == 2 ? 10 : 6;
  const double rise = crystal == Crystal::square      ? 2
                      : crystal == Crystal::hexagonal ? std::numbers::sqrt3
                                                      : std::numbers::sqrt2;
  for (int layer = 0; layer < layers; ++layer) {
    // Every other layer lies in the hollows of the one below.
    const int shift = crystal == Crystal::square ? 0 : layer % 2;
    const int count = across - shift;
    for (int k = 0; k < (Dim == 2 ? count : count * count); ++k) {
      Vec<Dim> place = Vec<Dim>::Constant(1 + shift);
      place[0] += 2 * (k % count);
      if (Dim == 3) place[1] += 2 * (k / count);
      place[Dim - 1] = 1 + rise * layer;
      put<Dim>(scene, corner + kRadius * place);
    }
  }
  add_tub<Dim>(scene, corner, 2 * kRadius * across);
  step_widely(scene);
  return scene;
}

template <int Dim>
CrystalAtRest rest(Crystal crystal, const Checkpoint& checkpoint) {
  const Scene<Dim> scene = crystal_scene<Dim>(crystal, Vec<Dim>::Zero());
  const auto run = make_run(scene, 1);
  const Columns<Dim> before = run->positions();
  CrystalAtRest result;
  watch(*run, kCrystalSteps, result, checkpoint);

  result.grains = run->count();
  const Columns<Dim> move = run->positions() - before;
  result.move = move.colwise().norm().maxCoeff() / kRadius;
  result.sink = -move.row(Dim - 1).mean();
  const double all = run->masses().sum() * kGravity;
  result.floor_error = std::abs(-run->walls()[0].force[Dim - 1] / all - 1);
  double twice_elastic = 0;
  for (const ContactRecord<Dim>& contact : run->contacts()) {
    twice_elastic += scene.law.stiffness * contact.overlap * contact.overlap;
    if (contact.j < 0) continue;
    ++result.contacts;
    const double apart = (before.col(contact.i) - before.col(contact.j)).norm();
    result.strangers += apart > 2.01 * kRadius;
  }
  // Gravity's work on the way to rest is twice the energy in the springs: half of it is damped.
  result.explained = twice_elastic / all;
  for (int i = 0; i < run->count(); ++i) {
    for (int j = 0; j < i; ++j) {
      const Vec<Dim> between = run->positions().col(i) - run->positions().col(j);
      result.brute_force += between.norm() < 2 * kRadius;
    }
  }
  return result;
}

}  // namespace

CrystalAtRest crystal_at_rest(Crystal crystal, const Checkpoint& checkpoint) {
  return crystal == Crystal::face_centred ? rest<3>(crystal, checkpoint)
                                          : rest<2>(crystal, checkpoint);
}

Tower tower(int height, std::int64_t steps, const Checkpoint& checkpoint) {
  constexpr double kOverlap = 1e-4;  // by one weight, of the radius
  constexpr int kSamples = 250;
  const double w = weight<2>(kRadius), stiffness = w / (kOverlap * kRadius);
  Scene<2> scene = stone<2>("tower", stiffness, kDeadRestitution);
  fall(scene);
  for (int k = 0; k < height; ++k) put<2>(scene, {0, (2 * k + 1) * kRadius});
  scene.walls.push_back(Wall<2>::half_space("floor", {0, 0}, {0, 1}));
  step_widely(scene);
  const auto run = make_run(scene, 1);

  Tower result;
  const auto n = static_cast<std::size_t>(height);
  const auto measure = [&] {
    result.force.assign(n, 0);
    for (const ContactRecord<2>& contact : run->contacts()) {
      const int below = contact.j < 0 ? -1 : contact.i;
      result.force[static_cast<std::size_t>(height - below - 2)] = contact.force.norm() / w;
    }
    double worst = 0;
    for (std::size_t m = 1; m <= n; ++m) {
      const auto weights = static_cast<double>(m);
      worst = std::max(worst, std::abs(result.force[m - 1] / weights - 1));
    }
    result.samples.push_back({static_cast<double>(run->steps()), worst});
  };
  const std::int64_t every = std::max(kLookEvery, steps / kSamples / kLookEvery * kLookEvery);
  watch(*run, steps, result, checkpoint, [&] {
    if (run->steps() % every == 0 || run->steps() == steps) measure();
  });

  // The modes of a column on a floor: omega = 2 sqrt(k/m) sin((2p - 1) pi / (4 n + 2)). Dashpots of
  // 2 zeta sqrt(k m/2) between neighbours damp the slowest by zeta sqrt(m / 2k) omega^2.
  const double mass = w / kGravity;
  const double half_angle = std::numbers::pi / (4 * height + 2);
  const double squared = 4 * stiffness / mass * std::pow(std::sin(half_angle), 2);
  result.decay = damping_ratio_for(kDeadRestitution) * std::sqrt(mass / (2 * stiffness)) * squared *
                 run->time_step();
  result.last_bit = last_bit_of(2 * kRadius * height) / (kOverlap * kRadius);
  return result;
}

template <int Dim>
HeavyOnLight heavy_on_light(const Checkpoint& checkpoint) {
  constexpr double kTimes = 1000;    // as dense
  constexpr double kOverlap = 1e-4;  // by the heavy grain's weight, of the radius
  constexpr std::int64_t kSteps = 300000;
  const int light = 1 << (Dim - 1);
  const double w = weight<Dim>(kRadius);
  Scene<Dim> scene =
      stone<Dim>("heavy on light", kTimes * w / (kOverlap * kRadius), kDeadRestitution);
  fall(scene);
  scene.materials.push_back({"heavy stone", kTimes * kDensity});
  for (int k = 0; k < light; ++k) {
    Vec<Dim> place = Vec<Dim>::Ones();
    for (int d = 0; d < Dim - 1; ++d) place[d] += 2 * (k >> d & 1);
    put<Dim>(scene, kRadius * place);
  }
  // In the hollow of the others: by a radius off each of them along every horizontal axis.
  const double up = std::sqrt(4.0 - (Dim - 1));
  Vec<Dim> top = Vec<Dim>::Constant(2);
  top[Dim - 1] = 1 + up;
  put<Dim>(scene, kRadius * top);
  scene.grains.back().material = 1;
  add_tub<Dim>(scene, Vec<Dim>::Zero(), 4 * kRadius);
  step_widely(scene);
  const auto run = make_run(scene, 1);

  HeavyOnLight result;
  watch(*run, kSteps, result, checkpoint);
  const double all = (kTimes + light) * w;
  result.floor_error = std::abs(-run->walls()[0].force[Dim - 1] / all - 1);
  // Each contact with the heavy grain carries its weight / (light cos), half of that along an axis;
  // half of the light grains lean on a wall.
  const double cosine = up / 2;
  const double thrust = kTimes * w / (4 * cosine);
  result.wall_error = std::abs(-run->walls()[1].force[0] / thrust - 1);
  // Its spring are those contacts, in series with the floor's and the walls'; dashpots of
  // 2 zeta sqrt(k m) go with all of them, so that it decays by zeta sqrt(m / k) omega^2.
  const double compliance = (1 / (cosine * cosine) + 1 + (Dim - 1) / (4 * cosine * cosine)) / light;
  const double natural = std::sqrt(w / kGravity / scene.law.stiffness);
  result.decay =
      damping_ratio_for(kDeadRestitution) / (natural * kTimes * compliance) * run->time_step();
  result.overlap = run->statistics().largest_overlap;
  return result;
}
template HeavyOnLight heavy_on_light<2>(const Checkpoint&);
template HeavyOnLight heavy_on_light<3>(const Checkpoint&);

GiantAndDust giant_and_dust(const Checkpoint& checkpoint) {
  constexpr double kGiant = 1, kDust = 1e-3;  // [m]
  constexpr double kGiantDensity = 250;       // [kg/m^3]: it is hollow
  constexpr double kStiffness = 1e7;          // [N/m]
  constexpr double kSeconds = 0.12;
  Scene<2> scene = stone<2>("giant and dust", kStiffness, 0.3);
  // On a slope of 45 degrees; a wall holds the giant from below.
  const double part = kGravity / std::numbers::sqrt2;
  scene.gravity = {-part, -part};
  scene.friction = FrictionModel::elastic;
  scene.law.friction = 0.5;
  scene.law.tangential_damping = 0.2;
  scene.materials.push_back({"hollow stone", kGiantDensity});
  const double sunk = kGiantDensity * grain_volume<2>(kGiant) * part / kStiffness;
  put<2>(scene, {0, kGiant - sunk}, kGiant);
  scene.grains.back().material = 1;
  scene.walls.push_back(Wall<2>::half_space("slope", {0, 0}, {0, 1}));
  scene.walls.push_back(Wall<2>::half_space("stop", {sunk - kGiant, 0}, {1, 0}));
  // At x from its foot, the giant's flank is x^2 / 2 above the slope.
  constexpr double kLow = 0.06, kHigh = 0.24;  // [m]
  Fill<2> dust;
  dust.name = "dust";
  dust.count = 300;
  dust.radius = UniformRadius{0.8 * kDust, kDust};
  dust.low = {kLow, 0};
  dust.high = {kHigh, kHigh * kHigh / 2};
  dust.arrangement = Arrangement::random;
  scene.fills.push_back(dust);
  const auto run = make_run(scene, 1);
  const Vec<2> before = run->positions().col(0);

  GiantAndDust result;
  watch(*run, std::llround(kSeconds / run->time_step()), result, checkpoint);
  for (const ContactRecord<2>& contact : run->contacts()) {
    result.giant_contacts += contact.i == 0 && contact.j > 0;
  }
  // Nobody gets through the cleft, or leaves it uphill.
  for (int i = 1; i < run->count(); ++i) {
    const double x = run->positions()(0, i);
    result.lost += x < 0 || x > kHigh;
  }
  result.giant_move = (run->positions().col(0) - before).norm() / kGiant;
  result.overlap = run->statistics().largest_overlap;
  const Ledger now = run->ledger();
  result.residual = run->energy_residual() / (now.dashpot + now.friction);
  result.rebuilds = run->neighbourhood().cost()->ladder.rebuilds;
  return result;
}

Wedge tiny_disc_between_giants(const Checkpoint& checkpoint) {
  constexpr double kGiant = 1, kTiny = 1e-3;  // [m]
  constexpr double kStiffness = 1e7;          // [N/m]
  // The giants' swing against their walls decays at zeta sqrt(k/M) = 18/s.
  constexpr double kSeconds = 1.6;
  Scene<2> scene = stone<2>("wedge", kStiffness, 0.3);
  fall(scene);
  const double foot = kGiant - weight<2>(kGiant) / kStiffness;
  put<2>(scene, {kGiant, foot}, kGiant);
  put<2>(scene, {3 * kGiant, foot}, kGiant);
  put<2>(scene, {2 * kGiant, foot + std::sqrt(kTiny * (2 * kGiant + kTiny))}, kTiny);
  add_tub<2>(scene, {0, 0}, 4 * kGiant);
  step_widely(scene);
  const auto run = make_run(scene, 1);

  Wedge result;
  watch(*run, std::llround(kSeconds / run->time_step()), result, checkpoint);
  const double w = weight<2>(kTiny);
  for (const ContactRecord<2>& contact : run->contacts()) {
    if (contact.j != 2) continue;
    result.force = contact.force.norm() / w;
    result.overlap = contact.overlap / kTiny;
  }
  // The flanks carry the small disc, 2 f y / d = w; d is shorter by f / k, and each giant gives way
  // to f x / d by as much as that presses it into its wall.
  double f = w, x = kGiant;
  for (int round = 0; round < 100; ++round) {
    const double d = kGiant + kTiny - f / kStiffness;
    f = w * d / (2 * std::sqrt((d - x) * (d + x)));
    x = kGiant + f * x / d / kStiffness;
  }
  result.closed_form = f / w;
  return result;
}

// ---- Degenerate places -------------------------------------------------------------------------

template <int Dim>
Row row_of_grains(bool slanted, const Checkpoint& checkpoint) {
  constexpr int kGrains = 20;
  constexpr double kGap = 0.1;            // between neighbours, of the radius
  constexpr double kDeepest = 0.01;       // overlap of a collision, of the radius
  constexpr double kStiffness = 1e7;      // [N/m]
  constexpr double kFraction = 1 / 50.5;  // a step, of the contact time; not a whole number of them
  Scene<Dim> scene = stone<Dim>("row", kStiffness, 1);
  scene.time_step.fraction_of_contact = kFraction;
  const Vec<Dim> along =
      slanted ? Vec<Dim>(Vec<Dim>::Ones().normalized()) : Vec<Dim>(Vec<Dim>::UnitX());
  for (int k = 0; k < kGrains; ++k) put<Dim>(scene, kRadius * (2 + kGap) * k * along);
  const double mass = kDensity * grain_volume<Dim>(kRadius);
  const double speed = kDeepest * kRadius * std::sqrt(2 * kStiffness / mass);
  scene.grains[0].velocity = speed * along;
  const auto run = make_run(scene, 1);

  Row result;
  // The way of the impulse, with the time that it spends in contacts, and once more the gap.
  const double seconds = kGrains * (kGap * kRadius / speed + run->time_scales().contact);
  watch(*run, std::llround(seconds / run->time_step()), result, checkpoint, {}, 1);
  const Columns<Dim>& v = run->velocities();
  result.speed = v.col(kGrains - 1).dot(along) / speed;
  // Where a contact opens or closes within a step the energy errs by at most (omega dt)^2 / 4 of
  // the pair's, the speed by half of that; and the other way round where it ends.
  result.bound = (kGrains - 1) * std::pow(std::numbers::pi * kFraction, 2) / 8;
  result.momentum = (v.rowwise().sum() - speed * along).norm() / speed;
  for (int k = 0; k < kGrains; ++k) {
    const Vec<Dim> x = run->positions().col(k);
    result.sideways = std::max(result.sideways, (x - x.dot(along) * along).norm() / kRadius);
  }
  return result;
}
template Row row_of_grains<2>(bool, const Checkpoint&);
template Row row_of_grains<3>(bool, const Checkpoint&);

template <int Dim>
OnePlace all_in_one_place(const Checkpoint& checkpoint) {
  constexpr std::int64_t kSteps = 5000;
  OnePlace result;
  result.grains = 10;
  Scene<Dim> scene = stone<Dim>("one place", 1e7, 1);
  scene.time_step.fraction_of_contact = 1.0 / 100;
  for (int k = 0; k < result.grains; ++k) put<Dim>(scene, Vec<Dim>::Ones());
  try {
    make_run(scene, 1);
  } catch (const SceneError& error) {
    result.refused = error.what();
  }
  scene.largest_initial_overlap = 2;  // of the radius: all there is
  try {
    make_run(scene, 1);
  } catch (const SimulationError& error) {
    result.stopped = error.what();
  }
  scene.largest_overlap = 2;
  const auto run = make_run(scene, 1);
  result.pairs = static_cast<int>(run->near_pairs().size());
  watch(*run, kSteps, result.free, checkpoint, {}, 1);
  const Columns<Dim>& v = run->velocities();
  result.momentum = v.rowwise().sum().norm() / v.colwise().norm().sum();
  result.separation = std::numeric_limits<double>::infinity();
  for (int i = 0; i < run->count(); ++i) {
    for (int j = 0; j < i; ++j) {
      const Vec<Dim> between = run->positions().col(i) - run->positions().col(j);
      result.separation = std::min(result.separation, between.norm() / (2 * kRadius));
    }
  }
  return result;
}
template OnePlace all_in_one_place<2>(const Checkpoint&);
template OnePlace all_in_one_place<3>(const Checkpoint&);

FarAway far_from_origin(double distance, const Checkpoint& checkpoint) {
  FarAway result;
  double step = 0;
  const auto settled = [&](const Vec<2>& corner) {
    const auto run = make_run(crystal_scene<2>(Crystal::hexagonal, corner), 1);
    watch(*run, kCrystalSteps, result, checkpoint);
    result.last_bit = last_bit_of(run->positions().cwiseAbs().maxCoeff()) / kRadius;
    step = run->time_step();
    return run->contacts();
  };
  const auto here = settled(Vec<2>::Zero());
  const auto there = settled(Vec<2>::Constant(distance * kRadius));
  // Places stand once a step adds less than half of a last bit to each coordinate. What two grains
  // may still have of speed then, 2 sqrt(2) times that at most, their dashpot turns into a force of
  // 2 zeta sqrt(k m_eff) times it, in place of an overlap; and overlaps have last bits as well.
  const double mass = kDensity * grain_volume<2>(kRadius);
  const double natural = std::sqrt(mass / 2 * kCrystalOverlap * kRadius / weight<2>(kRadius));
  result.bound =
      (2 * std::numbers::sqrt2 * damping_ratio_for(kDeadRestitution) * natural / step + 2) *
      result.last_bit;
  const double w = weight<2>(kRadius);
  // A contact that one of the two lacks counts with the whole of the other's.
  const auto key = [](const ContactRecord<2>& c) { return std::array{c.wall, c.i, c.j}; };
  auto a = here.begin(), b = there.begin();
  while (a != here.end() || b != there.end()) {
    const bool has_a = a != here.end() && (b == there.end() || key(*a) <= key(*b));
    const bool has_b = b != there.end() && (a == here.end() || key(*b) <= key(*a));
    const Vec<2> none = Vec<2>::Zero();
    const double overlap = (has_a ? a->overlap : 0) - (has_b ? b->overlap : 0);
    const Vec<2> force = (has_a ? a->force : none) - (has_b ? b->force : none);
    result.overlap_error = std::max(result.overlap_error, std::abs(overlap) / kRadius);
    result.force_error = std::max(result.force_error, force.norm() / w);
    if (has_a) ++a;
    if (has_b) ++b;
  }
  return result;
}

Scales nine_decades_of_radii(std::int64_t steps, const Checkpoint& checkpoint) {
  constexpr double kGiant = 1000;         // [m]
  constexpr double kStiffness = 1e7;      // [N/m]
  constexpr double kDeepest = 0.01;       // overlap of an impact, of the radius
  constexpr double kFraction = 1.0 / 25;  // a step, of the shortest contact time
  Scene<2> scene = stone<2>("scales", kStiffness, 1);
  scene.time_step.fraction_of_contact = kFraction;
  put<2>(scene, {0, -kGiant}, kGiant);
  // In the plane the contact time goes with the radius: all hit with the same speed.
  const double speed = kDeepest * std::sqrt(kStiffness / (kDensity * std::numbers::pi));
  const std::vector<double> radii{1e-6, 1e-3, 1};
  for (std::size_t k = 0; k < radii.size(); ++k) {
    // On the giant's surface, at an angle so that they are clear of each other.
    const double angle = 0.003 * static_cast<double>(k);
    const Vec<2> up(std::sin(angle), std::cos(angle));
    const Vec<2> place = Vec<2>(0, -kGiant) + (kGiant + radii[k]) * up;
    put<2>(scene, place, radii[k], -speed * up);
  }
  const auto run = make_run(scene, 1);

  Scales result;
  watch(*run, steps, result, checkpoint);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    Bounce bounce;
    bounce.radius = radii[k];
    const auto i = static_cast<Eigen::Index>(k + 1);
    const double inverse_mass = 1 / run->masses()[i] + 1 / run->masses()[0];
    const double angle = std::sqrt(kStiffness * inverse_mass) * run->time();
    bounce.over = angle > std::numbers::pi;
    const Vec<2> up = (run->positions().col(i) - run->positions().col(0)).normalized();
    const Vec<2> velocity = run->velocities().col(i) - run->velocities().col(0);
    const double expected = bounce.over ? 1 : -std::cos(angle);
    bounce.speed_error = std::abs(velocity.dot(up) / speed - expected);
    // The step in a contact, the last bit of the distance in the overlap, and the last bit of a
    // place in what a step adds to it.
    const double place = run->positions().col(i).cwiseAbs().maxCoeff();
    bounce.bound = std::pow(angle / static_cast<double>(steps), 2) / 8 +
                   last_bit_of(kGiant) / (kDeepest * radii[k]) +
                   last_bit_of(place) / (2 * speed * run->time_step());
    result.bounces.push_back(bounce);
  }
  return result;
}

// ---- Speed and step ----------------------------------------------------------------------------

FastGrain fast_grain(double way, int shots, const Checkpoint& checkpoint) {
  FastGrain result;
  result.way = way;
  result.shots = shots;
  Scene<2> scene = stone<2>("fast grain", 1e7, 1);
  put<2>(scene, {0, 0});
  scene.grains[0].pinned = true;
  const double step = make_run(scene, 1)->time_step();
  for (int shot = 0; shot < shots; ++shot) {
    Scene<2> one = scene;
    // The first contact lies anywhere in a step.
    const double start = -2 - way * (shot + 0.5) / shots;
    put<2>(one, {start * kRadius, 0}, kRadius, {way * kRadius / step, 0});
    const auto run = make_run(one, 1);
    // Long enough for a bounce (a contact lasts 25 steps or, against a pinned grain, 36), or to
    // come out.
    watch(*run, 60 + static_cast<std::int64_t>(5 / way), result, checkpoint, {}, 1);
    if (!result.stopped.empty()) {
      ++result.refused;
      result.refusal = std::exchange(result.stopped, {});
    } else if (run->positions()(0, 1) < 0) {
      ++result.bounced;
    } else {
      ++result.unseen;
    }
  }
  // Nearer than 2 radii less the largest overlap the run stops: on as long a way to both sides.
  const double guarded = 2 * (2 - scene.largest_overlap);
  result.expected = std::max(0.0, 1 - guarded / way);
  const double mass = kDensity * grain_volume<2>(kRadius);
  result.bounce_up_to = scene.largest_overlap * std::sqrt(scene.law.stiffness / mass) * step;
  return result;
}

namespace {

Scene<2> head_on(double overlap, double speed) {
  Scene<2> scene = stone<2>("head-on collision", 0, 1);
  scene.normal = NormalModel::hertz;
  // Hertz's deepest overlap is (5 m v^2 / 4 K)^(2/5), K = (4/3) E* sqrt(r_eff).
  const double mass = kDensity * grain_volume<2>(kRadius) / 2;
  const double k = 1.25 * mass * speed * speed / std::pow(overlap * kRadius, 2.5);
  scene.law.modulus = 0.75 * k / std::sqrt(kRadius / 2);
  put<2>(scene, {-1.001 * kRadius, 0}, kRadius, {speed / 2, 0});
  put<2>(scene, {1.001 * kRadius, 0}, kRadius, {-speed / 2, 0});
  return scene;
}

}  // namespace

std::string refusal_of_step(double safe_steps) {
  Scene<2> scene = head_on(0.02, 1);
  scene.law.impact_speed = 1;
  scene.time_step.fraction_of_contact = safe_steps * kLargestContactFraction;
  try {
    make_run(scene, 1);
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

StepSize collisions_at_step(double safe_steps, const Checkpoint& checkpoint) {
  constexpr double kOverlap = 0.02;  // of the radius
  constexpr double kSpeed = 1;       // [m/s]
  constexpr int kPhases = 32;
  StepSize result;
  result.safe_steps = safe_steps;
  Scene<2> scene = head_on(kOverlap, kSpeed);
  // The contact time goes with the speed to the power -1/5.
  scene.law.impact_speed = kSpeed * std::pow(safe_steps, -5);
  scene.time_step.fraction_of_contact = kLargestContactFraction;
  const double way = kSpeed * make_run(scene, 1)->time_step();  // of both together
  for (int phase = 0; phase < kPhases; ++phase) {
    Scene<2> one = scene;
    const double gap = way * (phase + 0.5) / kPhases;
    one.grains[0].position.x() = -kRadius - gap / 2;
    one.grains[1].position.x() = kRadius + gap / 2;
    const auto run = make_run(one, 1);
    double deepest = 0;
    ContactAudit<2> audit;
    // Until they part again.
    const auto apart = [&] {
      const Vec<2> between = run->positions().col(1) - run->positions().col(0);
      deepest = std::max(deepest, 2 - between.norm() / kRadius);
      return between.norm() > 2 * kRadius;
    };
    const auto closing = [&] { return run->velocities()(0, 0) > run->velocities()(0, 1); };
    while ((!apart() || closing()) && result.stopped.empty()) {
      try {
        run->step();
      } catch (const SimulationError& error) {
        result.stopped = error.what();
      }
      audit.check(run->positions(), run->radii(), run->near_pairs());
    }
    if (checkpoint) checkpoint();
    const double energy = run->ledger().kinetic / run->start().kinetic;
    result.energy_error = std::max(result.energy_error, std::abs(energy - 1));
    result.overlap_error = std::max(result.overlap_error, std::abs(deepest / kOverlap - 1));
    result.steps += run->steps();
    result.audited += audit.contacts();
    result.missed += audit.missed();
  }
  return result;
}

// ---- Long runs ---------------------------------------------------------------------------------

Pile pile(FrictionModel friction, std::int64_t steps, const Checkpoint& checkpoint) {
  constexpr int kPinned = 30, kAcross = 5, kLayers = 10;
  constexpr int kSamples = 400;
  constexpr double kStiffness = 1e7;  // [N/m]: the lowest discs overlap by about 0.1 % of a radius
  Scene<2> scene = stone<2>("pile", kStiffness, 0.3);
  fall(scene);
  scene.friction = friction;
  scene.law.friction = 0.5;
  // A thick film creeps slowly enough to be seen for a while; it needs short steps.
  const bool viscous = friction == FrictionModel::viscous;
  scene.law.tangential_damping = viscous ? 0.35 : 0.2;
  scene.time_step.fraction_of_contact = viscous ? 1.0 / 36 : 1.0 / 20;
  for (int k = 0; k < kPinned; ++k) {
    put<2>(scene, {(2 * k + 1) * kRadius, 0});
    scene.grains.back().pinned = true;
  }
  const double middle = kPinned * kRadius, half = 2.1 * kRadius * kAcross / 2;
  Fill<2> column;
  column.name = "column";
  column.count = kAcross * kLayers;
  column.radius = UniformRadius{0.8 * kRadius, kRadius};
  column.low = {middle - half, kRadius};
  column.high = {middle + half, kRadius * (1 + 2.1 * kLayers)};
  scene.fills.push_back(column);
  scene.walls.push_back(Wall<2>::half_space("left", {0, 0}, {1, 0}));
  scene.walls.push_back(Wall<2>::half_space("right", {2 * middle, 0}, {-1, 0}));
  const auto run = make_run(scene, 1);

  Pile result;
  result.grains = run->count() - kPinned;
  const std::int64_t every = std::max(kLookEvery, steps / kSamples / kLookEvery * kLookEvery);
  const std::int64_t tenth = (steps - steps / 10) / kLookEvery * kLookEvery;
  Columns<2> then;
  watch(*run, steps, result, checkpoint, [&] {
    if (run->steps() % every == 0) {
      result.samples.push_back(
          {run->time(), run->ledger().kinetic, run->positions().row(1).maxCoeff()});
    }
    if (run->steps() == tenth) then = run->positions();
  });
  if (!result.stopped.empty()) return result;
  result.drift = (run->positions() - then).colwise().norm().maxCoeff() / kRadius;
  result.drift_seconds = static_cast<double>(steps - tenth) * run->time_step();
  // Along both axes; a disc that rolls so has half as much again in its spin.
  const double crawl = std::numbers::sqrt2 * last_bit_of(2 * middle) / (2 * run->time_step());
  result.crawl = crawl / kRadius;
  result.rounding_floor = 1.5 * result.grains * run->masses().maxCoeff() / 2 * crawl * crawl;
  // A film of 2 zeta_t sqrt(k m_eff) under a tangential force of mu times a disc's weight.
  const double mass = kDensity * grain_volume<2>(kRadius);
  const double film = 2 * scene.law.tangential_damping * std::sqrt(kStiffness * mass / 2);
  result.creep = scene.law.friction * mass * kGravity / film / kRadius;
  result.unbalanced = unbalanced(*run);
  return result;
}

Gas elastic_gas(std::int64_t grain_steps, const Checkpoint& checkpoint) {
  constexpr int kGrains = 200, kSamples = 200;
  constexpr double kSide = 0.45;  // [m]
  // A step, of the contact time. What remains of a contact after whole steps, 0.24 of one, is where
  // the errors at its two ends are uncorrelated (the root of Bernoulli's fourth polynomial).
  constexpr double kFraction = 1 / 25.24;
  Scene<2> scene = stone<2>("elastic gas", 1e7, 1);
  scene.time_step.fraction_of_contact = kFraction;
  Fill<2> gas;
  gas.name = "gas";
  gas.count = kGrains;
  gas.radius = kRadius;
  gas.low = {0, 0};
  gas.high = {kSide, kSide};
  gas.arrangement = Arrangement::random;
  gas.random_speed = 2;
  scene.fills.push_back(gas);
  add_tub<2>(scene, {0, 0}, kSide);
  scene.walls.push_back(Wall<2>::half_space("lid", {0, kSide}, {0, -1}));
  const auto run = make_run(scene, 1);

  Gas result;
  result.grains = kGrains;
  const std::int64_t steps = grain_steps / kGrains;
  const std::int64_t every = std::max(kLookEvery, steps / kSamples / kLookEvery * kLookEvery);
  double open = 0, samples = 0, most_open = 0;
  watch(*run, steps, result, checkpoint, [&] {
    const auto contacts = static_cast<double>(run->statistics().contacts);
    open += contacts;
    most_open = std::max(most_open, contacts);
    samples += 1;
    if (run->steps() % every != 0 && run->steps() != steps) return;
    result.samples.push_back({static_cast<double>(run->steps() * kGrains),
                              run->energy_residual() / run->start().kinetic});
  });
  result.collisions = open / samples * run->time() / run->time_scales().contact;
  // A contact that opens or closes a share s of a step before the step's end errs by
  // (omega dt)^2 s (1 - s) of the pair's energy along the normal, with opposite signs at the two
  // ends: a standard deviation of (omega dt)^2 sqrt(2 (1/30 - 1/36)) of an energy whose mean square
  // over collisions in the plane is 2 (kT)^2; and the gas has kGrains kT.
  const double squared = std::pow(std::numbers::pi * kFraction, 2);
  result.random_walk =
      squared * std::sqrt(2 * (1.0 / 30 - 1.0 / 36) * 2 * result.collisions) / kGrains;
  // Within a contact velocity Verlet errs by (omega dt)^2 / 4 of its energy, of kT in the mean.
  result.open_contacts = squared / 4 * most_open / kGrains;
  return result;
}

// ---- What must stop ----------------------------------------------------------------------------

namespace {

/// Runs a scene into a folder, and notes what ends it.
/// @return whether last.csv holds all grains at finite places that fulfil a condition
template <class Condition>
bool record_until_it_stops(Run<2>& run, const std::filesystem::path& folder, Outcome& outcome,
                           const Checkpoint& checkpoint, Condition&& sound) {
  try {
    record(run, {folder,
                 [&] {
                   if (checkpoint) checkpoint();
                   return false;
                 },
                 {}});
  } catch (const SimulationError& error) {
    outcome.stopped = error.what();
  }
  outcome.steps = run.steps();
  outcome.audited = run.audit().contacts();
  outcome.missed = run.audit().missed();
  const std::vector<Vec<2>> places = places_in(folder / "last.csv");
  const std::string text = content(folder / "last.csv");
  return static_cast<int>(places.size()) == run.count() && text.find("nan") == std::string::npos &&
         text.find("inf") == std::string::npos && std::all_of(places.begin(), places.end(), sound);
}

}  // namespace

NotANumber not_a_number(const std::filesystem::path& folder, const Checkpoint& checkpoint) {
  NotANumber result;
  // A short tower, and a disc beside it that is to be spoilt.
  Scene<2> scene = stone<2>("not a number", 1e5, 0.5);
  fall(scene);
  scene.friction = FrictionModel::elastic;
  scene.law.friction = 0.5;
  scene.law.tangential_damping = 0.2;
  for (int k = 0; k < 5; ++k) put<2>(scene, {0, (2 * k + 1) * kRadius});
  put<2>(scene, {12 * kRadius, kRadius});
  scene.walls.push_back(Wall<2>::half_space("floor", {0, 0}, {0, 1}));

  try {
    const std::string sound = to_toml(scene), key = "position = [";
    const auto at = sound.find(key) + key.size();
    parse_scene<2>(sound.substr(0, at) + "nan" + sound.substr(sound.find(',', at)), "scene.toml");
  } catch (const SceneError& error) {
    result.in_file = error.what();
  }

  Scene<2> spoilt = scene;
  spoilt.grains[5].velocity.y() = std::numeric_limits<double>::quiet_NaN();
  try {
    make_run(spoilt, 1);
  } catch (const std::exception& error) {
    result.in_program = error.what();
  }

  Scene<2> fast = scene;
  fast.grains[5].velocity.y() = std::numeric_limits<double>::max();
  fast.duration = 1;
  fast.audit = true;
  {
    const auto run = make_run(fast, 1);
    result.last_is_sound = record_until_it_stops(*run, folder, result.overflow, checkpoint,
                                                 [](const Vec<2>& x) { return x.allFinite(); });
  }

  fast.grains[5].velocity.y() = 1e150;
  const auto run = make_run(fast, 1);
  watch(*run, 1000, result.huge, checkpoint);
  return result;
}

PushedThrough pushed_through_walls(const Checkpoint& checkpoint) {
  PushedThrough result;
  constexpr double kStiffness = 1e6;  // [N/m]
  Scene<2> scene = stone<2>("lid", kStiffness, 0.5);
  fall(scene);
  for (int k = 0; k < 40; ++k) {
    put<2>(scene, {(1 + 2 * (k % 8)) * kRadius, (1 + 2 * (k / 8)) * kRadius});
  }
  add_tub<2>(scene, {0, 0}, 16 * kRadius);
  Scene<2> crushed = scene;
  // Three times as fast as the contact can stop a disc within the largest overlap.
  const double mass = kDensity * grain_volume<2>(kRadius);
  const double speed = 3 * scene.largest_overlap * kRadius * std::sqrt(kStiffness / mass);
  crushed.walls.push_back(Wall<2>::half_space("lid", {0, 12 * kRadius}, {0, -1}));
  crushed.walls.back().motion = Steady<2>{{0, -speed}};
  watch(*make_run(crushed, 1), 10000, result.lid, checkpoint);

  // The lowest discs would sink in by their radius.
  PairLaw soft{0, 1, scene.law};
  soft.law.stiffness = 5 * weight<2>(kRadius) / kRadius;
  scene.materials.push_back({"mud", 0});
  scene.pairs.push_back(soft);
  scene.walls[0].material = 1;
  watch(*make_run(scene, 1), 10000, result.soft_floor, checkpoint);
  return result;
}

Shrinking shrinking_box(const std::filesystem::path& folder, const Checkpoint& checkpoint) {
  constexpr double kSide = 0.3;   // at the start [m]
  constexpr double kSpeed = 0.2;  // of each wall [m/s]
  Scene<2> scene = stone<2>("shrinking box", 1e6, 0.3);
  Fill<2> grains;
  grains.name = "grains";
  grains.count = 100;
  grains.radius = UniformRadius{0.7 * kRadius, kRadius};
  grains.low = {0, 0};
  grains.high = {kSide, kSide};
  grains.arrangement = Arrangement::random;
  scene.fills.push_back(grains);
  add_tub<2>(scene, {0, 0}, kSide);
  scene.walls.push_back(Wall<2>::half_space("lid", {0, kSide}, {0, -1}));
  for (Wall<2>& wall : scene.walls) {
    wall.motion = Steady<2>{kSpeed * std::get<HalfSpace<2>>(wall.shape).normal};
  }
  scene.duration = kSide / (2 * kSpeed);  // nothing is left of the box then
  scene.audit = true;
  const auto run = make_run(scene, 1);

  Shrinking result;
  result.grains = run->count();
  // The last good state is older than the walls are now: they have come nearer since.
  result.last_is_sound = record_until_it_stops(
      *run, folder, result, checkpoint,
      [&](const Vec<2>& x) { return (x.array() > 0).all() && (x.array() < kSide).all(); });
  const double side = kSide - 2 * kSpeed * run->time();
  result.jammed = std::numbers::pi * run->radii().squaredNorm() / (side * side);
  return result;
}

}  // namespace lagrain::hard_cases
