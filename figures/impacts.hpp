// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Impacts of spheres on each other or on a plane, one above the other: what went in, what came
/// out, and what Hertz and the laws of momentum say.

#include "figure.hpp"

#include <lagrain/scene.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace lagrain::figures {

/// How two bodies move, of which the upper one is a sphere and the lower one a sphere or a plane.
struct ImpactMotion {
  double approach = 0;  ///< of the centres, along z; negative afterwards [m/s]
  double slip = 0;      ///< of the upper surface over the lower one, along x [m/s]
  double across = 0;    ///< velocity of the upper centre along x [m/s]
  double spin = 0;      ///< of the upper sphere about y [rad/s]
};

/// An impact while it lasts.
struct ImpactMoment {
  double time = 0;     ///< since they touched [s]
  double overlap = 0;  ///< [m]
  double force = 0;    ///< along the normal [N]
};

/// One impact, from before the touch until after it.
struct Impact {
  std::string upper, lower;                ///< materials
  LawNumbers law;                          ///< between these
  double radius = 0;                       ///< of the upper sphere [m]
  double effective_radius = 0;             ///< [m]
  double effective_mass = 0;               ///< [kg]
  double mass_share = 1;                   ///< effective mass over that of the upper sphere [-]
  ImpactMotion before = {}, after = {};    ///< free of forces
  double duration = 0;                     ///< of the touch [s]
  std::vector<ImpactMoment> moments = {};  ///< one for each step in touch

  /// Relative speed of the surfaces before it [m/s].
  double speed() const { return std::hypot(before.approach, before.slip); }
  double restitution() const { return -after.approach / before.approach; }  ///< [-]
  double largest_force() const;                                             ///< at a step [N]
};

/// Impacts of a scene that were run to its end.
struct Impacts {
  std::vector<Impact> all = {};  ///< in the order of the scene's grains
  double steps = 0;              ///< to the shortest contact
  std::int64_t missed = 0;       ///< contacts, by the audit
  std::int64_t audited = 0;      ///< contacts
};

/// Runs a scene whose grains meet its only wall, or each other in pairs, the upper one first.
/// @param steps  to the shortest contact
/// @param phase  of a step: by how much later the grains placed by hand touch [-]
/// @throws SimulationError if two are in touch at the end, Interrupted
Impacts run_impacts(const Scene<3>& scene, double steps, const FigureOptions& options,
                    double phase = 0);

/// An elastic impact by Hertz: Johnson, Contact Mechanics, 1985, section 11.4.
struct HertzImpact {
  double overlap = 0;   ///< the deepest [m]
  double force = 0;     ///< the largest [N]
  double duration = 0;  ///< [s]
};
HertzImpact hertz_impact(const Impact& impact);
/// Force [N] at an overlap [m].
double hertz_force(const Impact& impact, double overlap);
/// When an elastic impact first reaches an overlap [s].
double hertz_time(const Impact& impact, double overlap);

/// Whether rigid spheres slide through all of the impact. Each of them has 5/2 of its mass over
/// its moment of inertia times r^2, so a slip falls by 7/2 of what friction takes.
bool slides(const Impact& impact);
/// After an impact that slides all the time friction is Coulomb's coefficient times the normal
/// impulse, and the rest is momentum.
/// @pre slip before is not negative
ImpactMotion after_sliding(const Impact& impact);

/// Difference of the upper sphere's velocities after the impact, of the speed before [-].
double velocity_error(const Impact& impact, const ImpactMotion& exact);
/// Difference of its spin times its radius, of that speed [-].
double spin_error(const Impact& impact, const ImpactMotion& exact);

}  // namespace lagrain::figures
