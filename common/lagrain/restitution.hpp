// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Restitution of a linear spring and dashpot that never attracts.

namespace lagrain {

/// Restitution [-] of a head-on impact through a spring and dashpot whose force is cut at zero,
/// for a damping ratio zeta = gamma / (2 sqrt(k m_eff)) >= 0.
///
/// Source: Schwager & Poeschel, Granular Matter 9 (2007) 465. Without the cut the force would
/// attract at the end of the contact and the restitution would be exp(-pi zeta / sqrt(1 - zeta^2)).
double clamped_restitution(double damping_ratio);

/// The damping ratio [-] that gives a restitution in (0, 1]: the inverse of clamped_restitution,
/// to 40 bits, so that a scene means the same with every C library.
/// @throws ContractError outside (0, 1].
double damping_ratio_for(double restitution);

/// Duration of that contact [-] in units of 1 / omega0 = sqrt(m_eff / k).
double clamped_contact_time(double damping_ratio);

}  // namespace lagrain
