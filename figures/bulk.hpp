// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Three bulk processes, as figure 20 shows them: a silo that empties, a drum that mixes, a ball
/// that comes to rest in a bed. They are those of M. Dosta et al., "Comparing open-source DEM
/// frameworks for simulations of common bulk processes", Computer Physics Communications 296 (2024)
/// 109066; the scenes say what is ours.

#include "together.hpp"

#include <lagrain/run.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lagrain::figures {

/// A scene with grains `factor` times as large in its fills, and so many fewer that they fill as
/// much. What is placed by hand stays.
Scene<3> coarser(Scene<3> scene, double factor);
/// A scene with all moduli `factor` times as small.
Scene<3> softer(Scene<3> scene, double factor);

/// What a run tells about itself.
struct RunReport {
  int grains = 0;              ///< at the start
  double radius = 0;           ///< the smallest [m]
  double modulus = 0;          ///< effective, of [law] [Pa]
  double time_step = 0;        ///< [s]
  double grain_steps = 0;      ///< of the grains present
  double seconds = 0;          ///< processor time of one core
  double largest_overlap = 0;  ///< at any sample, of the smaller radius [-]
  double residual = 0;         ///< of the energy ledger, over what was dissipated [-]
  std::int64_t audited = 0;    ///< contacts found from nothing
  std::int64_t missed = 0;     ///< of these, not known to the run
};

/// A silo with another orifice: its funnel keeps its slope, so that the lip lies higher or lower.
/// @param orifice  diameter [m]
Scene<3> with_orifice(Scene<3> scene, double orifice);

/// A silo that empties, after its gate is gone.
struct Silo {
  RunReport report;
  double orifice = 0;        ///< diameter [m]
  double grain = 0;          ///< diameter [m]
  std::vector<double> time;  ///< since the gate is gone [s]
  std::vector<double> left;  ///< grains above the orifice
  double solid = 0;          ///< solid fraction of the bed at rest [-]
  double rate = 0;           ///< of the steady flow [1/s]
  double rate_error = 0;     ///< its standard error [1/s]
  Columns<3> position;       ///< at kSiloPicture, 3 x N [m]
  Eigen::VectorXd radius;    ///< then, N [m]
  Eigen::VectorXd speed;     ///< then, N [m/s]
};
inline constexpr double kSiloPicture = 0.4;  ///< since the gate is gone [s]
inline constexpr double kSteadyFrom =
    0.15;  ///< when the flow has become steady, as its curve shows [s]
inline constexpr double kSiloGravity = 9.81;  ///< [m/s^2]
/// When a silo's gate is gone [s].
double gate_of(const Scene<3>& scene);
/// @throws SimulationError
Silo run_silo(const Scene<3>& scene, const Watch& watch);

/// Mass flow in the units of Beverloo's law, W / (rho sqrt(g) d^(5/2)), from a number of grains of
/// diameter d [m] per second and the solid fraction of the bed.
double beverloo_flow(double rate, double grain, double solid);

/// Beverloo's law, W = C rho sqrt(g) (D - k d)^(5/2) (W. A. Beverloo, H. A. Leniger, J. van de
/// Velde, Chemical Engineering Science 15 (1961) 260), with the standard errors of its constants.
struct Beverloo {
  double c = 0, c_error = 0;  ///< [-]
  double k = 0, k_error = 0;  ///< [-]
};
/// The straight line through flow^(2/5) against D / d, by least squares.
/// @pre three points or more
Beverloo fit_beverloo(const std::vector<double>& orifice_over_grain,
                      const std::vector<double>& flow);

/// A drum that turns, since it began to.
struct Drum {
  RunReport report;
  std::vector<double> time;  ///< [s]
  /// Grains of M1 and of M2 in a quadrant, against time: in zone 1, above on the side where the
  /// wall rises, and in zone 2, which is opposite.
  std::array<std::array<std::vector<double>, 2>, 2> count;
  std::array<int, 2> grains{};  ///< of M1, of M2
  /// About the axis, means between a sample and the one before [N m]:
  std::vector<double> torque;    ///< of the drum on the grains
  std::vector<double> weight;    ///< m g times the way of the centre of mass from the axis, across
  std::vector<double> momentum;  ///< change of the grains' angular momentum in time
  std::vector<int> material;     ///< of each grain: 0 for M1, 1 for M2
  Eigen::VectorXd radius;        ///< N [m]
  Columns<3> before, after;      ///< when the drum begins to turn, and at the end, 3 x N [m]
};
/// @throws SimulationError
Drum run_drum(const Scene<3>& scene, const Watch& watch);

/// A ball in a bed, since it passed the place of release.
struct Penetration {
  RunReport report;
  std::vector<double> time;    ///< [s]
  std::vector<double> height;  ///< of the ball's centre above the floor [m]
  std::vector<double> speed;   ///< downwards [m/s]
  double solid = 0;            ///< solid fraction of the bed before [-]
  double surface = 0;          ///< of the bed, where it slows the ball down first [m]
  double ball = 0;             ///< radius [m]
  Eigen::VectorXd layer;       ///< height of each grain before the impact, of the bed's [-]
  Columns<3> position;         ///< at the end, 3 x N [m]; the ball comes first
  Eigen::VectorXd radius;      ///< N [m]

  /// How deep the ball's underside lies below the surface, sample by sample [m].
  double depth(std::size_t k) const { return surface - (height[k] - ball); }
};
inline constexpr double kRelease = 0.150243;  ///< published place of the ball's centre [m]
/// @throws SimulationError
Penetration run_penetration(const Scene<3>& scene, const Watch& watch);

/// The force law of impacts on grains, m a = m g - m v^2 / d - k z (H. Katsuragi, D. J. Durian,
/// Nature Physics 3 (2007) 420).
struct ImpactLaw {
  double length = 0;     ///< d, over which the speed falls by inertia alone [m]
  double stiffness = 0;  ///< k / m [1/s^2]
  double worst = 0;      ///< how far v^2 / 2 is off at worst, over its value at the start [-]
  std::vector<double> depth, speed;  ///< the curve [m], [m/s]
};
/// The law's two numbers, by least squares of the kinetic energy against depth.
ImpactLaw fit_impact_law(const Penetration& penetration);

}  // namespace lagrain::figures
