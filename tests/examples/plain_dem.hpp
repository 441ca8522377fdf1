// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The distinct element method on a dynamic triangulation, as plainly as it can be said: to be read
/// first. The functions are the steps of section 3 of the paper (Ferrez & Liebling, 16th IMACS
/// World Congress, 2000), under its numbers. Simulation (lagrain/simulation.hpp) does the same
/// faster, and with friction; test_plain_dem.cpp compares the two, bit for bit.

#include <lagrain/grains.hpp>
#include <lagrain/hooke.hpp>
#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>
#include <lagrain/walls.hpp>

#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace lagrain {

/// Discs (Dim = 2) or spheres (Dim = 3) that push each other along the line of their centres. All
/// are of one material, none is pinned, and walls stand still.
template <int Dim>
struct PlainDem {
  /// Grain i is pushed by grain j, or by a wall: then j is -1.
  struct Contact {
    int i, j;
    Touch<Dim> touch;  ///< overlap, normal, speed of approach
    Vec<Dim> force;    ///< on i; j receives the opposite [N]
  };

  Grains<Dim, LinearSpring::needs> grains;  ///< places, velocities, radii, masses
  LinearSpring law;
  std::vector<Wall<Dim>> walls;
  Vec<Dim> gravity;  ///< [m/s^2]
  double time_step;  ///< [s]

  Triangulation<Dim> triangulation{};    ///< T
  std::vector<Contact> contacts{};       ///< of this iteration
  Columns<Dim> acceleration{};           ///< of the last one [m/s^2]
  Columns<Dim> guess = grains.velocity;  ///< of the new velocities, for the dashpots [m/s]

  /// Step 1: construct the initial triangulation T. The weight of a grain is its radius squared.
  void construct_triangulation() {
    triangulation.build(grains.position, grains.radius.array().square());
  }

  /// Step 2: detect contacts along the edges of T. Every contact is an edge as long as no overlap
  /// exceeds 0.58 of the smaller radius. Walls are not in T: each grain is compared with each wall.
  void detect_contacts() {
    const auto& x = grains.position;
    const auto& r = grains.radius;
    contacts.clear();
    triangulation.for_each_edge([&](int i, int j) {
      const Vec<Dim> between = x.col(i) - x.col(j);
      if (!(squared(between) < (r[i] + r[j]) * (r[i] + r[j]))) return;
      const double distance = std::sqrt(squared(between));
      add_contact(i, j, r[i] + r[j] - distance, 1 / distance * between, guess.col(i) - guess.col(j),
                  1 / (grains.inverse_mass[i] + grains.inverse_mass[j]));
    });
    for (int i = 0; i < grains.size(); ++i) {
      for (const Wall<Dim>& wall : walls) {
        const auto [distance, normal] = wall.foot(x.col(i));
        if (!(distance < r[i])) continue;
        add_contact(i, -1, r[i] - distance, normal, guess.col(i), grains.mass[i]);
      }
    }
  }
  void add_contact(int i, int j, double overlap, const Vec<Dim>& normal, const Vec<Dim>& velocity,
                   double effective_mass) {
    Touch<Dim> touch;
    touch.overlap = overlap;
    touch.normal = normal;
    touch.closing = -dot(velocity, normal);
    touch.effective_mass = effective_mass;
    contacts.push_back({i, j, touch, Vec<Dim>::Zero()});
  }

  /// Step 3: apply the law at every contact. In the first iteration no time has passed yet.
  void apply_law() {
    const double passed = acceleration.cols() > 0 ? time_step : 0;
    for (Contact& c : contacts) c.force = law.push(c.touch, passed).force * c.touch.normal;
  }

  /// Step 4: update the trajectories. Gravity and the forces of the contacts are added up, and the
  /// motion is integrated by velocity Verlet: the new velocity takes the mean of the old and the
  /// new acceleration. The latter is known in the next iteration; until then we guess.
  void update_trajectories() {
    Columns<Dim> force = gravity * grains.mass.transpose();
    for (const Contact& c : contacts) {
      force.col(c.i) += c.force;
      if (c.j >= 0) force.col(c.j) -= c.force;
    }
    const Columns<Dim> a = force * grains.inverse_mass.asDiagonal();
    if (acceleration.cols() > 0) {
      grains.velocity = guess + 0.5 * time_step * (a - acceleration);
    }
    grains.position += time_step * (grains.velocity + 0.5 * time_step * a);
    guess = grains.velocity + time_step * a;
    acceleration = a;
  }

  /// Step 5: update the triangulation T with local operations, which are flips.
  void update_triangulation() {
    std::vector<int> moved(static_cast<std::size_t>(grains.size()));
    std::iota(moved.begin(), moved.end(), 0);
    triangulation.move(moved, grains.position, grains.radius.array().square());
  }

  /// Steps 2 to 5. Step 6, "go back to 2", is the loop of the caller. Afterwards places are a time
  /// step further, and velocities are those at its beginning.
  void iterate() {
    detect_contacts();
    apply_law();
    update_trajectories();
    update_triangulation();
  }
};

}  // namespace lagrain
