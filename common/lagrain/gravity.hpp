// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// How gravity changes in time: it turns, as seen from a box that is turned, or it is switched.

#include <lagrain/vec.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <variant>
#include <vector>

namespace lagrain {

/// It stays as it is.
struct SteadyGravity {};

/// It turns at a constant rate between two times, and stays where it then is.
template <int Dim>
struct TurningGravity {
  SpinVec<Dim> axis;                                      ///< unit; 1 in the plane [-]
  double rate = 0;                                        ///< right-handed about the axis [rad/s]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
};

/// It is given at some times, and changes linearly between them. Where two of them are equal it is
/// switched. Before the first and after the last it stays.
template <int Dim>
struct GravityTable {
  std::vector<double> times;      ///< in order, at most two of them equal [s]
  std::vector<Vec<Dim>> gravity;  ///< one for each time [m/s^2]
};

/// One of these.
template <int Dim>
using GravityCourse = std::variant<SteadyGravity, TurningGravity<Dim>, GravityTable<Dim>>;

/// Whether gravity ever changes.
template <int Dim>
bool is_steady(const GravityCourse<Dim>& course) {
  return std::holds_alternative<SteadyGravity>(course);
}

/// Gravity [m/s^2] at time t [s].
/// @param first  gravity before anything changes [m/s^2]; a table does not need it
template <int Dim>
Vec<Dim> gravity_at(const GravityCourse<Dim>& course, const Vec<Dim>& first, double t) {
  if (const auto* turning = std::get_if<TurningGravity<Dim>>(&course)) {
    const double angle =
        turning->rate * (std::clamp(t, turning->start, turning->stop) - turning->start);
    if constexpr (Dim == 2) {
      return Eigen::Rotation2Dd(turning->axis[0] * angle) * first;
    } else {
      return Eigen::AngleAxisd(angle, turning->axis) * first;
    }
  }
  if (const auto* table = std::get_if<GravityTable<Dim>>(&course)) {
    const auto next = std::upper_bound(table->times.begin(), table->times.end(), t);
    const auto k = static_cast<std::size_t>(next - table->times.begin());
    if (k == 0) return table->gravity.front();
    if (k == table->times.size()) return table->gravity.back();
    const double part = (t - table->times[k - 1]) / (table->times[k] - table->times[k - 1]);
    return table->gravity[k - 1] + part * (table->gravity[k] - table->gravity[k - 1]);
  }
  return first;
}

}  // namespace lagrain
