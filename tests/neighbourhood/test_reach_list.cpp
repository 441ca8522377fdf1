// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/reach_list.hpp>

#include <lagrain/triangulation2.hpp>
#include <lagrain/triangulation3.hpp>

#include <support/cases.hpp>
#include <support/motion_scenes.hpp>
#include <support/space.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

using namespace lagrain;
using namespace lagrain::test;

namespace {

template <int Dim>
using Balls = std::vector<typename ReachList<Dim>::Ball>;

template <int Dim>
Balls<Dim> inflated(const Cloud<Dim>& cloud, double factor) {
  Balls<Dim> balls;
  for (Eigen::Index i = 0; i < cloud.x.cols(); ++i) {
    balls.push_back({cloud.x.col(i), factor * cloud.radius[i]});
  }
  return balls;
}

template <int Dim>
ReachList<Dim> list_of(const Balls<Dim>& balls) {
  const auto count = static_cast<Eigen::Index>(balls.size());
  Columns<Dim> x(Dim, count);
  Eigen::VectorXd weight(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& ball = balls[static_cast<std::size_t>(i)];
    x.col(i) = ball.centre;
    weight[i] = ball.radius * ball.radius;
  }
  Triangulation<Dim> t;
  t.build(x, weight);
  ReachList<Dim> list;
  list.build(t, [&](int i) { return balls[static_cast<std::size_t>(i)]; });
  return list;
}

/// Every pair that brute force finds is listed, none is listed twice, and each grain knows the
/// partners that the pairs give it.
template <int Dim>
void check_complete(const ReachList<Dim>& list, const Balls<Dim>& balls) {
  const int count = static_cast<int>(balls.size());
  std::set<Pair> listed(list.pairs().begin(), list.pairs().end());
  CHECK(std::is_sorted(list.pairs().begin(), list.pairs().end()));
  listed.insert(list.added().begin(), list.added().end());
  CHECK(listed.size() == list.pairs().size() + list.added().size());
  std::set<Pair> by_partner;
  for (int i = 0; i < count; ++i) {
    list.for_each_partner(i, [&](int j) {
      CHECK(i != j);
      by_partner.insert({std::min(i, j), std::max(i, j)});
    });
  }
  CHECK(by_partner == listed);
  int missed = 0;
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      const auto &a = balls[static_cast<std::size_t>(i)], &b = balls[static_cast<std::size_t>(j)];
      if ((a.centre - b.centre).norm() > a.radius + b.radius) continue;
      missed += listed.count({i, j}) == 0;
    }
  }
  CHECK(missed == 0);
}

}  // namespace

TEST_SUITE("reach_list") {
  TEST_CASE_TEMPLATE("walks in T find all balls that meet, however deeply", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const CloudKind kind : kClouds) {
      for (int seed = 0; seed < cases(5, 200); ++seed) {
        for (const int count : {1, 2, 3, 4, 10, 100}) {
          for (const double factor : {1.0, 2.5, 5.0}) {
            CAPTURE(static_cast<int>(kind));
            CAPTURE(seed);
            CAPTURE(count);
            CAPTURE(factor);
            Random random(static_cast<std::uint64_t>(seed));
            const auto balls = inflated<Dim>(make_cloud<Dim>(kind, count, random), factor);

            const auto list = list_of<Dim>(balls);

            check_complete<Dim>(list, balls);
          }
        }
      }
    }
  }

  TEST_CASE_TEMPLATE("only balls that meet are listed", S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    Random random(1);
    const auto balls = inflated<Dim>(make_cloud<Dim>(CloudKind::kSizes, 200, random), 2);

    const auto list = list_of<Dim>(balls);

    for (const auto& [i, j] : list.pairs()) {
      const auto &a = balls[static_cast<std::size_t>(i)], &b = balls[static_cast<std::size_t>(j)];
      CHECK((a.centre - b.centre).norm() <= (a.radius + b.radius) * (1 + 1e-9));
    }
  }

  TEST_CASE_TEMPLATE(
      "balls that move while T stays find all that they meet, and are found: a little, far out of "
      "the hull, and onto others",
      S, Space<2>, Space<3>) {
    constexpr int Dim = S::Dim;
    for (const CloudKind kind : kClouds) {
      if (kind == CloudKind::kNone) continue;
      for (int seed = 0; seed < cases(3, 100) * 3; ++seed) {
        CAPTURE(static_cast<int>(kind));
        CAPTURE(seed);
        Random random(static_cast<std::uint64_t>(seed));
        const int most = seed % 3 == 0 ? 2 : seed % 3 == 1 ? 5 : 60;
        auto balls = inflated<Dim>(make_cloud<Dim>(kind, most, random), 2.5);
        auto list = list_of<Dim>(balls);
        const int count = static_cast<int>(balls.size());
        for (int round = 0; round < 10; ++round) {
          CAPTURE(round);
          for (int k = 0; k < 12; ++k) {
            const int i = random.below(count);
            auto& ball = balls[static_cast<std::size_t>(i)];
            const int where = random.below(10);
            if (where == 0) {
              ball.centre = balls[static_cast<std::size_t>(random.below(count))].centre;
            } else {
              const double way = where == 1 ? 30 : 0.6;
              for (int d = 0; d < Dim; ++d) ball.centre[d] += way * ball.radius * random.normal();
            }
            list.move(i, ball);
          }
          check_complete<Dim>(list, balls);
        }
      }
    }
  }
}
