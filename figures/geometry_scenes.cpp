// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry_scenes.hpp"

#include <lagrain/all_pairs.hpp>
#include <lagrain/audit.hpp>
#include <lagrain/compiled_kernels.hpp>
#include <lagrain/csv.hpp>
#include <lagrain/cundall_strack.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/observe.hpp>
#include <lagrain/output.hpp>
#include <lagrain/random.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>

namespace lagrain::figures {
namespace {

constexpr double kDensity = 2500;    // [kg/m^3], glass
constexpr double kDepth = 0.01;      // of the discs, which are slices of rods [m]
constexpr double kStepShare = 0.05;  // time step over the shortest contact

double disc_mass(double r) { return kDensity * grain_volume<2>(r, kDepth); }

double time_step_for(const std::vector<Grain<2>>& grains, double stiffness) {
  double lightest = grains.front().mass;
  for (const Grain<2>& grain : grains) lightest = std::min(lightest, grain.mass);
  // Two of the lightest grains; damping only makes contacts longer.
  return kStepShare * LinearSpring{stiffness, 0}.contact_time(0.5 * lightest, 0);
}

std::vector<Wall<2>> open_box(double width) {
  return {Wall<2>::half_space("floor", {0, 0}, {0, 1}), Wall<2>::half_space("left", {0, 0}, {1, 0}),
          Wall<2>::half_space("right", {width, 0}, {-1, 0})};
}

}  // namespace

Discs make_discs(const std::vector<std::array<double, 3>>& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  Discs discs{Columns<2>(2, n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& row = rows[static_cast<std::size_t>(i)];
    discs.centre.col(i) << row[0], row[1];
    discs.radius[i] = row[2];
  }
  return discs;
}

std::vector<Pair> edges_of(const Triangulation<2>& triangulation) {
  std::vector<Pair> edges;
  triangulation.for_each_edge([&](int i, int j) { edges.push_back({i, j}); });
  std::sort(edges.begin(), edges.end());
  return edges;
}

int hull_edges(const Triangulation<2>& triangulation) {
  std::map<Pair, int> triangles;
  const auto count = [&](int a, int b) { ++triangles[{std::min(a, b), std::max(a, b)}]; };
  triangulation.for_each_triangle([&](int a, int b, int c) {
    count(a, b);
    count(b, c);
    count(c, a);
  });
  return static_cast<int>(std::count_if(triangles.begin(), triangles.end(),
                                        [](const auto& edge) { return edge.second == 1; }));
}

std::vector<Pair> contacts_of(const Discs& discs) {
  std::vector<Pair> contacts;
  Eigen::VectorXd no_margin = Eigen::VectorXd::Zero(discs.radius.size());
  AllPairs<2>{}.near_pairs(discs.centre, discs.radius, no_margin, contacts);
  return contacts;
}

bool holds(const std::vector<Pair>& sorted, Pair pair) {
  return std::binary_search(sorted.begin(), sorted.end(), pair);
}

std::vector<Pair> without(const std::vector<Pair>& a, const std::vector<Pair>& b) {
  std::vector<Pair> rest;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
  return rest;
}

Found find_contacts(const Discs& discs, const Eigen::VectorXd& weights) {
  Found found{discs, {}, {}, {}, {}};
  found.triangulation.build(discs.centre, weights);
  found.edges = edges_of(found.triangulation);
  const std::vector<Pair> contacts = contacts_of(discs);
  found.missed = without(contacts, found.edges);
  found.found = without(contacts, found.missed);
  return found;
}

Found find_contacts(const Discs& discs) {
  return find_contacts(discs, discs.radius.array().square());
}

Settled settle(int count, double smallest, double largest, double width, std::uint64_t seed) {
  using Law = CundallStrack<LinearSpring>;
  Settled result{.discs = {},
                 .width = width,
                 .seed = seed,
                 .time = 2,
                 .stiffness = 2e4,
                 .friction = 0.5,
                 .restitution = 0.3};

  // Places on a loose lattice, jittered so that no two columns fall alike.
  Random random(seed);
  const double pitch = 2.2 * largest;
  const int columns = static_cast<int>(width / pitch);
  std::vector<Grain<2>> grains;
  for (int i = 0; i < count; ++i) {
    Grain<2> grain;
    grain.radius = random.uniform(smallest, largest);
    grain.mass = disc_mass(grain.radius);
    const double room = 0.5 * pitch - grain.radius;
    const Vec<2> cell((i % columns + 0.5) * width / columns, (i / columns + 0.5) * pitch);
    grain.position = cell + Vec<2>(random.uniform(-room, room), random.uniform(-room, room));
    grains.push_back(grain);
  }

  const Law law{.normal = LinearSpring::with_restitution(result.stiffness, result.restitution),
                .friction = result.friction};
  result.time_step = time_step_for(grains, result.stiffness);
  Simulation<2, Law, VelocityVerlet, TriangulationNeighbourhood<2>> simulation(
      make_grains<2, Law::needs>(grains), LawTable<Law>(law), open_box(width),
      {.gravity = {0, -9.81}, .time_step = result.time_step}, TriangulationNeighbourhood<2>());
  ContactAudit<2> audit;
  while (simulation.time() < result.time) {
    simulation.step();
    audit.check(simulation.grains().position, simulation.grains().radius, simulation.near_pairs());
  }

  result.discs = {simulation.grains().position, simulation.grains().radius};
  result.steps = simulation.steps();
  const ContactStatistics statistics = contact_statistics(simulation);
  result.mean_overlap = statistics.mean_overlap;
  result.largest_overlap = statistics.largest_overlap;
  result.kinetic_energy = kinetic_energy(simulation.grains());
  result.audited = audit.contacts();
  result.missed = audit.missed();
  return result;
}

Flight fly(int count, std::uint64_t seed, double duration, double interval) {
  constexpr double kSide = 0.24;                         // [m]
  constexpr double kSmallest = 0.010, kLargest = 0.030;  // radii [m]
  constexpr double kSpeed = 0.25;                        // [m/s]
  constexpr double kStiffness = 4e4;                     // [N/m]

  // Places at random, largest disc first, so that all find room.
  Random random(seed);
  std::vector<double> radii;
  for (int i = 0; i < count; ++i) radii.push_back(random.uniform(kSmallest, kLargest));
  std::sort(radii.rbegin(), radii.rend());
  std::vector<Grain<2>> grains;
  while (static_cast<int>(grains.size()) < count) {
    Grain<2> grain;
    grain.radius = radii[grains.size()];
    grain.mass = disc_mass(grain.radius);
    grain.position = {random.uniform(grain.radius, kSide - grain.radius),
                      random.uniform(grain.radius, kSide - grain.radius)};
    const bool free = std::none_of(grains.begin(), grains.end(), [&](const Grain<2>& other) {
      return (other.position - grain.position).norm() < other.radius + grain.radius;
    });
    if (free) grains.push_back(grain);
  }
  for (Grain<2>& grain : grains) {
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    grain.velocity = kSpeed * Vec<2>(std::cos(angle), std::sin(angle));
  }

  std::vector<Wall<2>> walls = open_box(kSide);
  walls.push_back(Wall<2>::half_space("top", {0, kSide}, {0, -1}));
  // The step does not depend on the interval: films of one seed show the same motion.
  const double largest_step = time_step_for(grains, kStiffness);
  const double time_step = kLeastInterval / std::ceil(kLeastInterval / largest_step);
  const int steps = static_cast<int>(std::lround(interval / time_step));
  Simulation<2, LinearSpring, VelocityVerlet, TriangulationNeighbourhood<2>> simulation(
      make_grains<2, LinearSpring::needs>(grains), LawTable<LinearSpring>(LinearSpring{kStiffness}),
      std::move(walls), {.time_step = time_step}, TriangulationNeighbourhood<2>());

  Flight flight{
      .radius = simulation.grains().radius, .side = kSide, .interval = interval, .centres = {}};
  const double energy = energy_ledger(simulation).balance();
  const int snapshots = static_cast<int>(std::lround(duration / interval));
  for (int k = 0;; ++k) {
    flight.centres.push_back(simulation.grains().position);
    flight.largest_overlap =
        std::max(flight.largest_overlap, contact_statistics(simulation).largest_overlap);
    flight.energy_drift = std::max(flight.energy_drift,
                                   std::abs(energy_ledger(simulation).balance() - energy) / energy);
    if (k == snapshots) break;
    for (int step = 0; step < steps; ++step) simulation.step();
  }
  return flight;
}

void write_csv(const std::filesystem::path& path, const std::string& names,
               const std::vector<std::vector<double>>& rows) {
  Csv csv(names);
  for (const std::vector<double>& row : rows) {
    for (const double value : row) csv.number(value);
    csv.end();
  }
  write_file(path, csv.text());
}

}  // namespace lagrain::figures
