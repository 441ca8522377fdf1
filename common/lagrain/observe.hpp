// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// These functions measure a simulation: energies and their ledger, momentum, overlaps,
/// coordination, packing density.

#include <lagrain/grains.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/state.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace lagrain {

/// Where the energy is, and where it went [J].
struct Ledger {
  double kinetic = 0;       ///< of translation and rotation
  double gravity = 0;       ///< -sum m g.x, up to a constant
  double elastic = 0;       ///< in the springs of all contacts
  double wall_work = 0;     ///< put in by moving walls
  double dashpot = 0;       ///< taken by normal dashpots
  double friction = 0;      ///< taken by friction
  double carried = 0;       ///< brought by grains that came, less what grains took along that left
  double gravity_work = 0;  ///< put in by whoever changes gravity
  double driven_work = 0;   ///< put in by driven grains
  double force_work = 0;    ///< put in by body forces; taken by drag: negative

  /// What is in the system or has left it; constant in exact arithmetic with an exact integrator.
  double balance() const {
    return kinetic + gravity + elastic + dashpot + friction - wall_work - carried - gravity_work -
           driven_work - force_work;
  }

  /// Keeps or restores it.
  void persist(StateVisitor visit) {
    visit("kinetic", kinetic);
    visit("gravity", gravity);
    visit("elastic", elastic);
    visit("wall_work", wall_work);
    visit("dashpot", dashpot);
    visit("friction", friction);
    visit("carried", carried);
    visit("gravity_work", gravity_work);
    visit("driven_work", driven_work);
    visit("force_work", force_work);
  }
};

/// Energy that the ledger cannot account for since `start` [J]: the run's own error bar.
inline double residual(const Ledger& now, const Ledger& start) {
  return now.balance() - start.balance();
}

/// Total momentum [kg m/s], shape Dim.
template <int Dim, Needs needs>
Vec<Dim> momentum(const Grains<Dim, needs>& g) {
  return g.velocity * g.mass;
}

/// Angular momentum about the origin [kg m^2/s], spin included.
template <int Dim, Needs needs>
SpinVec<Dim> angular_momentum(const Grains<Dim, needs>& g) {
  SpinVec<Dim> total = SpinVec<Dim>::Zero();
  for (int i = 0; i < g.size(); ++i) {
    total += torque(Vec<Dim>(g.position.col(i)), Vec<Dim>(g.mass[i] * g.velocity.col(i)));
    if constexpr (needs.spin) {
      if (g.inverse_inertia[i] > 0) total += g.omega.col(i) / g.inverse_inertia[i];
    }
  }
  return total;
}

/// Where the energy of a simulation is now, and where it went since the start.
template <int Dim, class Law, class Motion, class N>
Ledger energy_ledger(const Simulation<Dim, Law, Motion, N>& sim) {
  const auto& g = sim.grains();
  Ledger ledger;
  ledger.kinetic = kinetic_energy(g);
  ledger.gravity = -sim.setting().gravity.dot(g.position * g.mass);
  sim.for_each_contact([&](Pair pair, const Touch<Dim>& touch, const auto&, const auto& memory) {
    ledger.elastic += sim.laws().of(g.material, pair.i, pair.j).elastic_energy(touch, memory);
  });
  sim.for_each_wall_contact(
      [&](WallPair pair, const Touch<Dim>& touch, const auto&, const auto& memory) {
        const int material = sim.walls()[static_cast<std::size_t>(pair.wall)].material;
        ledger.elastic +=
            sim.laws().with_wall(g.material, pair.i, material).elastic_energy(touch, memory);
      });
  ledger.wall_work = sim.flow().wall_work;
  ledger.dashpot = sim.flow().dashpot;
  ledger.friction = sim.flow().friction;
  ledger.carried = sim.flow().carried;
  ledger.gravity_work = sim.flow().gravity_work;
  ledger.driven_work = sim.flow().driven_work;
  for (const auto& force : sim.body_forces()) ledger.force_work += force.work;
  return ledger;
}

/// Overlaps relative to the smaller radius, and how many neighbours a grain touches.
struct ContactStatistics {
  std::int64_t contacts = 0;       ///< between grains
  std::int64_t wall_contacts = 0;  ///< between a grain and a wall
  double mean_overlap = 0;         ///< of grain and wall contacts, of the smaller radius [-]
  double largest_overlap = 0;      ///< [-]
  double coordination = 0;         ///< mean number of contacts of a grain, walls included [-]
};

/// Counts the contacts of a simulation as it is now.
template <int Dim, class Law, class Motion, class N>
ContactStatistics contact_statistics(const Simulation<Dim, Law, Motion, N>& sim) {
  const auto& g = sim.grains();
  ContactStatistics s;
  const auto note = [&](double overlap) {
    s.mean_overlap += overlap;
    s.largest_overlap = std::max(s.largest_overlap, overlap);
  };
  sim.for_each_contact([&](Pair pair, const Touch<Dim>& touch, const auto&, const auto&) {
    ++s.contacts;
    note(touch.overlap / std::min(g.radius[pair.i], g.radius[pair.j]));
  });
  sim.for_each_wall_contact([&](WallPair pair, const Touch<Dim>& touch, const auto&, const auto&) {
    ++s.wall_contacts;
    note(touch.overlap / g.radius[pair.i]);
  });
  const std::int64_t all = s.contacts + s.wall_contacts;
  if (all > 0) s.mean_overlap /= static_cast<double>(all);
  if (g.size() > 0) {
    s.coordination = static_cast<double>(2 * s.contacts + s.wall_contacts) / g.size();
  }
  return s;
}

namespace detail {

/// Measure of a ball of the given radius inside an axis-parallel box with corners low, high
/// relative to the ball's centre: slices, each integrated by Simpson's rule after z = r sin(a),
/// which is smooth where the ball ends.
template <int Dim>
double ball_in_box(double radius, const double* low, const double* high) {
  const double a = std::max(low[Dim - 1], -radius);
  const double b = std::min(high[Dim - 1], radius);
  if (!(a < b)) return 0;
  if constexpr (Dim == 1) {
    return b - a;
  } else {
    constexpr int kIntervals = 200;
    const double first = std::asin(a / radius);
    const double h = (std::asin(b / radius) - first) / kIntervals;
    double sum = 0;
    for (int k = 0; k <= kIntervals; ++k) {
      const double angle = first + k * h;
      const double slice = ball_in_box<Dim - 1>(radius * std::cos(angle), low, high);
      sum += (k == 0 || k == kIntervals ? 1 : k % 2 == 1 ? 4 : 2) * slice * std::cos(angle);
    }
    return sum * radius * h / 3;
  }
}

}  // namespace detail

/// Solid fraction [-] in an axis-parallel region: volume (area in 2D) of the grains inside it over
/// its own. Grains cut by the region's faces count by their part inside; overlaps count twice.
template <int Dim, Needs needs>
double solid_fraction(const Grains<Dim, needs>& g, const Eigen::AlignedBox<double, Dim>& region) {
  double solid = 0;
  for (int i = 0; i < g.size(); ++i) {
    const double r = g.radius[i];
    const Vec<Dim> low = region.min() - g.position.col(i);
    const Vec<Dim> high = region.max() - g.position.col(i);
    if ((low.array() <= -r).all() && (high.array() >= r).all()) {
      solid += grain_volume<Dim>(r);
    } else {
      solid += detail::ball_in_box<Dim>(r, low.data(), high.data());
    }
  }
  return solid / region.volume();
}

}  // namespace lagrain
