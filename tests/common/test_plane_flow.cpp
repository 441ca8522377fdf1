// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/plane_flow.hpp>

#include "support/space.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

/// One grain of 2 kg at a place along a direction.
template <int Dim>
void look_at(PlaneFlow<Dim>& flow, const Vec<Dim>& x) {
  Columns<Dim> places(Dim, 1);
  places.col(0) = x;
  flow.look({}, places, Eigen::VectorXd::Constant(1, 2.0));
}

}  // namespace

TEST_SUITE("flow through a plane") {
  TEST_CASE_TEMPLATE("what passes along the normal counts, and what comes back is taken off", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    const Vec<Dim> normal = Vec<Dim>::Ones().normalized();
    PlaneFlow<Dim> flow(normal, normal);
    int expected = 0;
    bool in_front = false;
    for (int k = 0; k <= 1000; ++k) {
      const double s = 1 + std::cos(std::numbers::pi + 0.05 * k);
      look_at<Dim>(flow, s * normal);
      if (k > 0) expected += (s >= 1) - in_front;
      in_front = s >= 1;
      REQUIRE(flow.grains() == expected);
      REQUIRE(flow.mass() == 2.0 * expected);
    }
    CHECK(std::abs(expected) <= 1);
  }

  TEST_CASE_TEMPLATE("the plane itself belongs to its front: nobody counts twice there", S,
                     Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    PlaneFlow<Dim> flow(Vec<Dim>::Zero(), Vec<Dim>::UnitX());
    for (const double x : {-1.0, 0.0, 0.0, 1.0, 0.0, 2.0})
      look_at<Dim>(flow, x * Vec<Dim>::UnitX());
    CHECK(flow.grains() == 1);
    look_at<Dim>(flow, -1e-300 * Vec<Dim>::UnitX());
    CHECK(flow.grains() == 0);
    CHECK(flow.mass() == 0);
  }

  TEST_CASE_TEMPLATE("in a box only those ways count that meet the plane there", S, Space<2>,
                     Space<3>) {
    constexpr int Dim = S::Dim;
    const typename PlaneFlow<Dim>::Box box(Vec<Dim>::Constant(-1), Vec<Dim>::Constant(1));
    PlaneFlow<Dim> flow(Vec<Dim>::Zero(), Vec<Dim>::UnitX(), box);
    Vec<Dim> from = Vec<Dim>::Constant(-2), to = Vec<Dim>::Constant(2);
    look_at<Dim>(flow, from);  // outside of the box, but the way goes through its middle
    look_at<Dim>(flow, to);
    CHECK(flow.grains() == 1);
    from = to;
    from[0] = -2;  // beside the box
    look_at<Dim>(flow, from);
    CHECK(flow.grains() == 1);
  }

  TEST_CASE("grains are known by their ids: newcomers and leavers do not pass") {
    PlaneFlow<2> flow({0, 0}, {0, 1});
    Columns<2> three(2, 3), two(2, 2);
    three << 0, 0, 0, -1, -1, 1;
    flow.look({}, three, Eigen::VectorXd::Constant(3, 1.0));  // 0 and 1 are behind, 2 in front
    two << 0, 0, 1, -1;
    // 0 has left. 1 has passed. 7 comes behind.
    flow.look({1, 7}, two, Eigen::VectorXd::Constant(2, 1.0));
    CHECK(flow.grains() == 1);
    two << 0, 0, 1, 1;
    flow.look({1, 8}, two, Eigen::VectorXd::Constant(2, 1.0));  // 8 comes in front, 7 has left
    CHECK(flow.grains() == 1);
  }
}
