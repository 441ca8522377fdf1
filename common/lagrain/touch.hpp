#pragma once
/// @file
/// One contact as a law sees it, and what the law answers.

#include <lagrain/vec.hpp>

namespace lagrain {

/// A contact of grain i with a partner j: another grain or a wall.
template <int Dim>
struct Touch {
  double overlap = 0;                  ///< r_i + r_j - |x_i - x_j| [m], positive
  Vec<Dim> normal = Vec<Dim>::Zero();  ///< unit vector from j to i [-]
  double closing = 0;                  ///< -(v_i - v_j) . normal [m/s], positive when approaching
  Vec<Dim> slip = Vec<Dim>::Zero();    ///< tangential velocity of i against j at the contact [m/s]
  /// Mean angular velocity of the two about the normal [rad/s]: how fast the contact turns in its
  /// own plane. Known to laws that remember; a wall does not turn.
  SpinVec<Dim> twist = SpinVec<Dim>::Zero();
  double effective_mass = 0;    ///< m_i m_j / (m_i + m_j) [kg]; m_i against a wall
  double effective_radius = 0;  ///< r_i r_j / (r_i + r_j) [m]; r_i against a wall
};

/// The answer of a law, and where the energy of the step went.
template <int Dim>
struct Response {
  Vec<Dim> force = Vec<Dim>::Zero();  ///< on i [N]; j receives the opposite
  double dashpot_loss = 0;            ///< energy taken by the normal dashpot in this step [J]
  double friction_loss = 0;           ///< energy taken by sliding and tangential damping [J]
};

}  // namespace lagrain
