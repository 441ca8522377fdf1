#pragma once
/// @file
/// Vectors in Dim dimensions, and the few operations that differ between the plane and space.

#include <Eigen/Core>

namespace lagrain {

/// A point or vector, shape Dim.
template <int Dim>
using Vec = Eigen::Matrix<double, Dim, 1>;

/// Rows x N, one column per grain, columns contiguous.
template <int Rows>
using Columns = Eigen::Matrix<double, Rows, Eigen::Dynamic>;

/// Axes of rotation: one in the plane, three in space.
template <int Dim>
inline constexpr int kSpinDim = Dim == 2 ? 1 : 3;

/// Angular velocity [rad/s] or torque [N m]; in the plane one number, counter-clockwise positive.
template <int Dim>
using SpinVec = Eigen::Matrix<double, kSpinDim<Dim>, 1>;

/// Velocity omega x r of the point at arm r from the centre, shape Dim.
inline Vec<2> cross(const SpinVec<2>& omega, const Vec<2>& arm) {
  return {-omega[0] * arm[1], omega[0] * arm[0]};
}
inline Vec<3> cross(const SpinVec<3>& omega, const Vec<3>& arm) {
  return {omega[1] * arm[2] - omega[2] * arm[1], omega[2] * arm[0] - omega[0] * arm[2],
          omega[0] * arm[1] - omega[1] * arm[0]};
}

/// Torque r x f of a force at arm r.
inline SpinVec<2> torque(const Vec<2>& arm, const Vec<2>& force) {
  return SpinVec<2>(arm[0] * force[1] - arm[1] * force[0]);
}
inline SpinVec<3> torque(const Vec<3>& arm, const Vec<3>& force) {
  return cross(SpinVec<3>(arm), force);
}

/// The part of a spin that turns about the direction n (unit): none in the plane, where every axis
/// is at a right angle to n.
inline SpinVec<2> about(const Vec<2>&, const SpinVec<2>&) {
  return SpinVec<2>(0.0);
}
inline SpinVec<3> about(const Vec<3>& n, const SpinVec<3>& omega) {
  return n.dot(omega) * n;
}

}  // namespace lagrain
