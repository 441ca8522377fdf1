// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Discs for the figures of the geometry (1 to 4), and what is asked of them: their regular
/// triangulation, their contacts, how they settle or move. Nothing here draws.

#include <lagrain/neighbourhood.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/vec.hpp>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lagrain::figures {

/// N discs in the plane.
struct Discs {
  Columns<2> centre;       ///< 2 x N [m]
  Eigen::VectorXd radius;  ///< N [m]

  int size() const { return static_cast<int>(radius.size()); }
  Vec<2> at(int i) const { return centre.col(i); }
  double overlap(Pair p) const {  ///< positive if they touch [m]
    return radius[p.i] + radius[p.j] - (at(p.i) - at(p.j)).norm();
  }
  /// Power |x - c_i|^2 - r_i^2 [m^2].
  double power(int i, const Vec<2>& x) const {
    return (x - at(i)).squaredNorm() - radius[i] * radius[i];
  }
};

/// Rows of x, y, r [m].
Discs make_discs(const std::vector<std::array<double, 3>>& rows);

/// Edges in increasing order.
std::vector<Pair> edges_of(const Triangulation<2>& triangulation);
/// Edges on the convex hull: those of one triangle only.
int hull_edges(const Triangulation<2>& triangulation);

/// Pairs at a distance of at most r_i + r_j, by trying all; in increasing order.
std::vector<Pair> contacts_of(const Discs& discs);

bool holds(const std::vector<Pair>& sorted, Pair pair);
/// What is in a and not in b, both sorted.
std::vector<Pair> without(const std::vector<Pair>& a, const std::vector<Pair>& b);

/// Discs, the triangulation of their centres for some weights, and which contacts lie on its edges.
struct Found {
  Discs discs;
  Triangulation<2> triangulation;
  std::vector<Pair> edges, found, missed;  ///< found and missed: all contacts
};
/// @param weights N [m^2]
Found find_contacts(const Discs& discs, const Eigen::VectorXd& weights);
/// The same with weights r^2, as the contact detection has them.
Found find_contacts(const Discs& discs);

/// Discs that have come to rest in an open box, 0 <= x <= width, y >= 0.
struct Settled {
  Discs discs;
  double width = 0;  ///< [m]
  std::uint64_t seed = 0;
  double time = 0;       ///< simulated [s]
  double time_step = 0;  ///< [s]
  std::int64_t steps = 0;
  double stiffness = 0;        ///< [N/m]
  double friction = 0;         ///< [-]
  double restitution = 0;      ///< [-]
  double mean_overlap = 0;     ///< of contacts, over the smaller radius [-]
  double largest_overlap = 0;  ///< [-]
  double kinetic_energy = 0;   ///< at the end [J]
  std::int64_t audited = 0;    ///< contacts found by brute force, over all steps
  std::int64_t missed = 0;     ///< of these, not found along T
};

/// Drops discs of uniformly distributed radii into the box under gravity, with friction.
Settled settle(int count, double smallest, double largest, double width, std::uint64_t seed);

/// Frictionless discs that fly and collide elastically in a square box, 0 <= x, y <= side.
struct Flight {
  Eigen::VectorXd radius;           ///< N [m]
  double side = 0;                  ///< [m]
  double interval = 0;              ///< between snapshots [s]
  std::vector<Columns<2>> centres;  ///< one for each snapshot, the first at time 0
  double largest_overlap = 0;       ///< in any snapshot, over the smaller radius [-]
  double energy_drift = 0;          ///< largest change of total energy, relative [-]

  Discs discs(std::size_t snapshot) const { return {centres[snapshot], radius}; }
};

/// Intervals between snapshots are multiples of this [s], half of the shortest contact.
inline constexpr double kLeastInterval = 5e-4;
Flight fly(int count, std::uint64_t seed, double duration, double interval);

/// Writes rows of numbers under the names "quantity[unit]"; reading them returns the same bits.
/// @throws SceneError if the file cannot be written
void write_csv(const std::filesystem::path& path, const std::string& names,
               const std::vector<std::vector<double>>& rows);

}  // namespace lagrain::figures
