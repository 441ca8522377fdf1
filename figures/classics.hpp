// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Three scenes that every user of discrete elements knows, run and measured: Janssen's silo, the
/// heap under a lifted tube, the biaxial test. All are in the plane, where discs are 1 m deep.

#include "figure.hpp"

#include <lagrain/run.hpp>

#include <cmath>
#include <span>
#include <vector>

namespace lagrain::figures {

/// Vertical stress in a silo against depth, by Janssen: sigma = gamma lambda (1 - exp(-z / lambda))
/// with the weight gamma of the bed per volume.
/// @param depth, length  z and lambda [m]
inline double janssen_stress(double depth, double weight, double length) {
  return weight * length * -std::expm1(-depth / length);
}

/// Janssen's length [m] that fits stresses [Pa] at depths [m] best (least squares).
/// @param weight  of the bed per volume [N/m^3]
double janssen_length(std::span<const double> depth, std::span<const double> stress, double weight);

/// A bed in a silo; means over time.
struct JanssenSilo {
  std::vector<double> depth;       ///< of the slices' middles below the surface [m]
  std::vector<double> vertical;    ///< stress [Pa]
  std::vector<double> horizontal;  ///< stress [Pa]
  double weight = 0;               ///< of the bed per volume [N/m^3]
  double width = 0;                ///< between the walls [m]
  double wall_friction = 0;        ///< mobilised: force along the walls over that on them [-]
  double lateral_ratio = 0;        ///< horizontal over vertical stress in the lower half [-]

  /// By Janssen, from the two numbers above [m].
  double length() const { return width / (2 * wall_friction * lateral_ratio); }
};

/// The angles [rad] of the left and the right flank of a heap: of the straight line through the
/// tops of the highest discs in columns of two mean diameters, where these are between a fifth and
/// four fifths of the heap's height. None for a flank with fewer than three columns.
/// @param x       centres [m]
/// @param radius  of the discs [m]
std::vector<double> flank_angles(const Columns<2>& x, const Eigen::VectorXd& radius);

/// A biaxial test: a row for each moment.
struct Biaxial {
  std::vector<double> strain;    ///< along the axis, compression positive [-]
  std::vector<double> dilation;  ///< growth of the volume [-]
  std::vector<double> axial;     ///< stress, the force over the width as it is [Pa]
  std::vector<double> lateral;   ///< stress, the force over the height as it is [Pa]
};

/// Angle of internal friction that two principal stresses mobilise [rad].
inline double friction_angle(double larger, double smaller) {
  return std::asin((larger - smaller) / (larger + smaller));
}

/// Runs janssen.toml from its start on; the means are over its last 0.8 s.
JanssenSilo run_silo(Run<2>& run, const FigureOptions& options);
/// Runs a scene with walls "side" and "top" on the right and above; means over 20 ms.
Biaxial run_biaxial(Run<2>& run, const FigureOptions& options);

}  // namespace lagrain::figures
