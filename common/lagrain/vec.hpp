// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Vectors in Dim dimensions, and the few operations that differ between the plane and space.

#include <Eigen/Core>

namespace lagrain {

/// A point or vector, shape Dim; of several contacts at once if Real is Lanes.
template <int Dim, class Real = double>
using Vec = Eigen::Matrix<Real, Dim, 1>;

/// Rows x N, one column per grain, columns contiguous.
template <int Rows>
using Columns = Eigen::Matrix<double, Rows, Eigen::Dynamic>;

/// Axes of rotation: one in the plane, three in space.
template <int Dim>
inline constexpr int kSpinDim = Dim == 2 ? 1 : 3;

/// Angular velocity [rad/s] or torque [N m]; in the plane one number, counter-clockwise positive.
template <int Dim, class Real = double>
using SpinVec = Eigen::Matrix<Real, kSpinDim<Dim>, 1>;

/// Scalar product, summed from the first component to the last: Eigen's own order of summation
/// differs between number types, and results must not.
template <class A, class B>
typename A::Scalar dot(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  typename A::Scalar sum = a.coeff(0) * b.coeff(0);
  for (int k = 1; k < A::RowsAtCompileTime; ++k) sum += a.coeff(k) * b.coeff(k);
  return sum;
}
/// |a|^2, by the same order of summation.
template <class A>
typename A::Scalar squared(const Eigen::MatrixBase<A>& a) {
  return dot(a, a);
}

/// a x b in space. In the plane a is along the missing axis: the velocity omega x r of the point at
/// arm r from the centre.
/// @{
template <class Real>
Vec<2, Real> cross(const Eigen::Matrix<Real, 1, 1>& omega, const Vec<2, Real>& arm) {
  return {-omega[0] * arm[1], omega[0] * arm[0]};
}
template <class Real>
Vec<3, Real> cross(const Vec<3, Real>& a, const Vec<3, Real>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// @}

/// Torque r x f [N m] of a force f [N] at arm r [m].
/// @{
template <class Real>
SpinVec<2, Real> torque(const Vec<2, Real>& arm, const Vec<2, Real>& force) {
  return SpinVec<2, Real>(arm[0] * force[1] - arm[1] * force[0]);
}
template <class Real>
SpinVec<3, Real> torque(const Vec<3, Real>& arm, const Vec<3, Real>& force) {
  return cross<Real>(arm, force);
}
/// @}

/// The part of a spin that turns about the direction n (unit): none in the plane, where every axis
/// is at a right angle to n.
/// @{
template <class Real>
SpinVec<2, Real> about(const Vec<2, Real>&, const Eigen::Matrix<Real, 1, 1>&) {
  return SpinVec<2, Real>(Real(0.0));
}
template <class Real>
SpinVec<3, Real> about(const Vec<3, Real>& n, const Vec<3, Real>& omega) {
  return dot(n, omega) * n;
}
/// @}

}  // namespace lagrain
