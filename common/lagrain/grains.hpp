// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// The grains as a structure of arrays.

#include <lagrain/check.hpp>
#include <lagrain/needs.hpp>
#include <lagrain/vec.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

namespace lagrain {

/// Rotation of N grains: present only where a law has friction.
template <int Dim>
struct SpinState {
  Columns<kSpinDim<Dim>> omega;     ///< angular velocity [rad/s], counter-clockwise positive
  Columns<kSpinDim<Dim>> torque;    ///< [N m]
  Eigen::VectorXd inverse_inertia;  ///< [1/(kg m^2)], 0 for a pinned or driven one
};

/// What stands in place of SpinState where nothing spins.
struct NoSpin {};

/// N discs (Dim = 2) or spheres (Dim = 3), as they are given to a simulation and as it shows them.
/// A frictionless `Grains` has no member `omega`: it is absent, not zero.
///
/// A pinned or driven grain has inverse mass and inverse inertia 0: forces on it are measured, and
/// it stays, or keeps its velocity and spin.
template <int Dim, Needs needs>
struct Grains : std::conditional_t<needs.spin, SpinState<Dim>, NoSpin> {
  Columns<Dim> position;               ///< Dim x N [m]
  Columns<Dim> velocity;               ///< Dim x N [m/s]
  Columns<Dim> force;                  ///< Dim x N [N]
  Eigen::VectorXd radius;              ///< N [m], positive
  Eigen::VectorXd mass;                ///< N [kg], positive
  Eigen::VectorXd inverse_mass;        ///< N [1/kg], 0 for a pinned or driven grain
  std::vector<std::uint8_t> material;  ///< N: row of the table of laws; empty if all are 0

  int size() const { return static_cast<int>(radius.size()); }  ///< N
};

/// What a grain is made from, before it joins `Grains`.
template <int Dim>
struct Grain {
  Vec<Dim> position = Vec<Dim>::Zero();       ///< [m]
  Vec<Dim> velocity = Vec<Dim>::Zero();       ///< [m/s]
  SpinVec<Dim> omega = SpinVec<Dim>::Zero();  ///< [rad/s]; ignored where nothing spins
  double radius = 0;                          ///< [m]
  double mass = 0;                            ///< [kg]
  int material = 0;                           ///< row of the table of laws
  bool pinned = false;                        ///< stays where it is, whatever pushes it
  bool driven = false;                        ///< keeps its velocity and spin, whatever pushes it

  bool held() const { return pinned || driven; }  ///< no force moves it
};

/// Volume [m^3] of a disc of the given depth [m] (Dim = 2: a rod) or of a sphere (depth unused).
template <int Dim>
double grain_volume(double radius, double depth = 1) {
  if constexpr (Dim == 2) {
    return std::numbers::pi * radius * radius * depth;
  } else {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  }
}

/// Moment of inertia [kg m^2] of a solid disc (m r^2 / 2) or sphere (2 m r^2 / 5).
template <int Dim>
double grain_inertia(double mass, double radius) {
  return (Dim == 2 ? 0.5 : 0.4) * mass * radius * radius;
}

/// Kinetic energy of translation and rotation [J].
template <int Dim, Needs needs>
double kinetic_energy(const Grains<Dim, needs>& g) {
  double twice = 0;
  for (int i = 0; i < g.size(); ++i) {
    twice += g.mass[i] * g.velocity.col(i).squaredNorm();
    if constexpr (needs.spin) {
      if (g.inverse_inertia[i] > 0) twice += g.omega.col(i).squaredNorm() / g.inverse_inertia[i];
    }
  }
  return 0.5 * twice;
}

/// Lays grains out as arrays, forces zero.
/// @throws ContractError if a radius or mass is not positive and finite, a number is NaN, a
/// material does not fit its byte, or a pinned grain moves.
template <int Dim, Needs needs>
Grains<Dim, needs> make_grains(const std::vector<Grain<Dim>>& list) {
  const auto n = static_cast<Eigen::Index>(list.size());
  Grains<Dim, needs> grains;
  grains.position.resize(Dim, n);
  grains.velocity.resize(Dim, n);
  grains.force.setZero(Dim, n);
  grains.radius.resize(n);
  grains.mass.resize(n);
  grains.inverse_mass.resize(n);
  if constexpr (needs.spin) {
    grains.omega.resize(kSpinDim<Dim>, n);
    grains.torque.setZero(kSpinDim<Dim>, n);
    grains.inverse_inertia.resize(n);
  }
  bool one_material = true;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Grain<Dim>& grain = list[static_cast<std::size_t>(i)];
    const std::string name = "grain " + std::to_string(i) + ": ";
    LAGRAIN_EXPECTS(grain.radius > 0 && std::isfinite(grain.radius),
                    name + "radius " + std::to_string(grain.radius));
    LAGRAIN_EXPECTS(grain.mass > 0 && std::isfinite(grain.mass),
                    name + "mass " + std::to_string(grain.mass));
    LAGRAIN_EXPECTS(
        grain.position.allFinite() && grain.velocity.allFinite() && grain.omega.allFinite(),
        name + "position, velocity or spin is not a number");
    LAGRAIN_EXPECTS(grain.material >= 0 && grain.material <= 255,
                    name + "material " + std::to_string(grain.material));
    LAGRAIN_EXPECTS(
        !grain.pinned || (!grain.driven && grain.velocity.isZero(0) && grain.omega.isZero(0)),
        name + "pinned, but moving");
    grains.position.col(i) = grain.position;
    grains.velocity.col(i) = grain.velocity;
    grains.radius[i] = grain.radius;
    grains.mass[i] = grain.mass;
    grains.inverse_mass[i] = grain.held() ? 0 : 1 / grain.mass;
    if constexpr (needs.spin) {
      grains.omega.col(i) = grain.omega;
      grains.inverse_inertia[i] =
          grain.held() ? 0 : 1 / grain_inertia<Dim>(grain.mass, grain.radius);
    }
    one_material = one_material && grain.material == 0;
  }
  if (!one_material) {
    for (const Grain<Dim>& grain : list)
      grains.material.push_back(static_cast<std::uint8_t>(grain.material));
  }
  return grains;
}

/// Some grains of one set, then all of another one.
/// @param kept  which of the first set, by number
template <int Dim, Needs needs>
Grains<Dim, needs> joined(const Grains<Dim, needs>& first, const std::vector<int>& kept,
                          const Grains<Dim, needs>& second) {
  const auto stay = static_cast<Eigen::Index>(kept.size());
  const Eigen::Index come = second.size();
  const auto columns = [&](const auto& a, const auto& b) {
    typename std::decay_t<decltype(a)> both(a.rows(), stay + come);
    both.leftCols(stay) = a(Eigen::seqN(0, a.rows()), kept);
    both.rightCols(come) = b;
    return both;
  };
  const auto numbers = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    Eigen::VectorXd both(stay + come);
    both.head(stay) = a(kept);
    both.tail(come) = b;
    return both;
  };
  Grains<Dim, needs> all;
  all.position = columns(first.position, second.position);
  all.velocity = columns(first.velocity, second.velocity);
  all.force = columns(first.force, second.force);
  all.radius = numbers(first.radius, second.radius);
  all.mass = numbers(first.mass, second.mass);
  all.inverse_mass = numbers(first.inverse_mass, second.inverse_mass);
  if constexpr (needs.spin) {
    all.omega = columns(first.omega, second.omega);
    all.torque = columns(first.torque, second.torque);
    all.inverse_inertia = numbers(first.inverse_inertia, second.inverse_inertia);
  }
  if (!first.material.empty() || !second.material.empty()) {
    const auto material = [](const Grains<Dim, needs>& g, int i) {
      return g.material.empty() ? std::uint8_t{0} : g.material[static_cast<std::size_t>(i)];
    };
    for (const int i : kept) all.material.push_back(material(first, i));
    for (int i = 0; i < come; ++i) all.material.push_back(material(second, i));
  }
  return all;
}

}  // namespace lagrain
