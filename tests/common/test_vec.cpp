// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/vec.hpp>

#include <lagrain/random.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace lagrain;

namespace {

Vec<3> embedded(const Vec<2>& v) { return {v[0], v[1], 0}; }

}  // namespace

TEST_SUITE("vec") {
  TEST_CASE("spin and torque in the plane are those in space about the third axis") {
    Random random(1);
    for (int k = 0; k < 100; ++k) {
      const Vec<2> arm(random.normal(), random.normal());
      const Vec<2> force(random.normal(), random.normal());
      const SpinVec<2> omega(random.normal());

      // The same products in the same order: equal bit for bit.
      CHECK(embedded(cross(omega, arm)) == cross(SpinVec<3>(0, 0, omega[0]), embedded(arm)));
      CHECK(Vec<3>(0, 0, torque(arm, force)[0]) == torque(embedded(arm), embedded(force)));
    }
  }

  TEST_CASE("counter-clockwise is positive") {
    CHECK(cross(SpinVec<2>(2.0), Vec<2>(1, 0)) == Vec<2>(0, 2));
    CHECK(torque(Vec<2>(1, 0), Vec<2>(0, 3))[0] == 3);
    CHECK(cross(SpinVec<3>(1, 0, 0), Vec<3>(0, 1, 0)) == Vec<3>(0, 0, 1));
  }

  TEST_CASE("a spin's part about a direction is none in the plane, and its projection in space") {
    CHECK(about(Vec<2>(0.6, 0.8), SpinVec<2>(3.0))[0] == 0);
    CHECK(about(Vec<3>(0, 0, 1), SpinVec<3>(1, 2, 3)) == Vec<3>(0, 0, 3));
    CHECK((about(Vec<3>(0.6, 0, 0.8), SpinVec<3>(1, 2, 3)) - 3 * Vec<3>(0.6, 0, 0.8)).norm() <
          1e-15);
  }

  TEST_CASE_TEMPLATE("a turning body's power is torque times spin", D,
                     std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
    constexpr int Dim = D::value;
    Random random(2);
    for (int k = 0; k < 100; ++k) {
      Vec<Dim> arm, force;
      SpinVec<Dim> omega;
      for (int d = 0; d < Dim; ++d) arm[d] = random.normal(), force[d] = random.normal();
      for (int d = 0; d < kSpinDim<Dim>; ++d) omega[d] = random.normal();

      // Both are sums of the same products, whose terms may cancel.
      const double size = omega.norm() * arm.norm() * force.norm();
      CHECK(std::abs(cross(omega, arm).dot(force) - omega.dot(torque(arm, force))) < 1e-15 * size);
    }
  }
}
