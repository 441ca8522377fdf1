// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// `Needs` says which state a contact law requires, so that a scene carries only what it needs.

namespace lagrain {

/// What a contact law asks for. All false: frictionless, and neither spin nor memory is stored.
struct Needs {
  bool spin = false;     ///< grains carry angular velocity, torque and inertia
  bool memory = false;   ///< contacts carry history from step to step
  bool rolling = false;  ///< contacts resist turning by a moment of their own; needs both others
};

}  // namespace lagrain
