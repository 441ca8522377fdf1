// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangulation<3> and its predicates against CGAL. CGAL breaks ties by coordinates and we by ids:
/// where there are none the edges and tetrahedra are the same, where there are, each of our
/// tetrahedra passes CGAL's power test and each edge that no choice can avoid is there.

#include <lagrain/triangulation3.hpp>

#include "dim3/sets3.hpp"
#include "oracle/cgal3.hpp"
#include "support/cases.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

using namespace lagrain;
using test::FastKernel;

namespace {

void check_against_cgal(const Triangulation<3>& t, const test3::Sites& s,
                        const std::vector<int>& ids, bool general) {
  const auto answer = test::ask(s, ids);
  const auto ours = test::edges(t);
  CHECK(test::audited(t) == "");
  CHECK(test::power_sides(t, s, ids).valid);
  CHECK(t.dimension() == answer.dimension);
  // A site that is tied with its own cell may be hidden or not, and edges end at it or pass it.
  if (test::visible(t) == answer.visible) {
    CHECK(std::includes(ours.begin(), ours.end(), answer.certain.begin(), answer.certain.end()));
  }
  if (general) {
    CHECK(!answer.ties);
    CHECK(ours == answer.edges);
    CHECK(test::tetrahedra(t) == answer.simplices);
    CHECK(test::visible(t) == answer.visible);
  }
}

/// On a plane or a line along the axes, but not tied.
test3::Sites flattened(test3::Sites s, int axes) {
  s.name += axes == 1 ? " in a plane" : " on a line";
  s.x.topRows(axes).setConstant(0.3);
  return s;
}

/// In general position, with hidden sites and without.
std::vector<test3::Sites> general_kinds(Random& random) {
  return {test3::jittered(random, 4),
          test3::uniform(random, 60),
          test3::overlapping(random, 60),
          test3::polydisperse(random, 60, 100),
          test3::size_ratio(random, 60),
          test3::nearly_coplanar(random, 30),
          flattened(test3::overlapping(random, 40), 1),
          flattened(test3::uniform(random, 30), 2),
          test::far_away(test3::overlapping(random, 40))};
}

std::vector<test3::Sites> tied_kinds(Random& random) {
  auto kinds = test3::tied_kinds(random, 3);
  for (auto& s : test3::flat_kinds(random, 25)) kinds.push_back(std::move(s));
  return kinds;
}

/// doctest would print CGAL's own type with the help of a library that nobody links.
int as_number(CGAL::Sign sign) { return static_cast<int>(sign); }

}  // namespace

TEST_SUITE("triangulation3 against CGAL") {
  TEST_CASE("orientation and power test have CGAL's signs") {
    const FastKernel kernel;
    const auto orientation_of = kernel.orientation_3_object();
    const auto power_side_of = kernel.power_side_of_oriented_power_sphere_3_object();
    for (int seed = 0; seed < test::cases(20, 1000); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test3::all_kinds(random)) {
        CAPTURE(seed);
        CAPTURE(s.name);
        for (int trial = 0; trial < 50; ++trial) {
          std::array<Site3, 5> p;
          std::array<FastKernel::Weighted_point_3, 5> q;
          for (std::size_t k = 0; k < 5; ++k) {
            const int i = random.below(s.size());
            p[k] = {s.x(0, i), s.x(1, i), s.x(2, i), s.w[i]};
            q[k] = test::Cgal<3, FastKernel>::weighted(s, i);
          }

          const int side = orientation(p[0], p[1], p[2], p[3]);

          REQUIRE(side == as_number(orientation_of(q[0].point(), q[1].point(), q[2].point(),
                                                   q[3].point())));
          if (side == 0) continue;
          if (side < 0) {
            std::swap(p[0], p[1]);
            std::swap(q[0], q[1]);
          }
          REQUIRE(power_side(p[0], p[1], p[2], p[3], p[4]) ==
                  as_number(power_side_of(q[0], q[1], q[2], q[3], q[4])));
        }
      }
    }
  }

  TEST_CASE("build, moves of one, few and all sites, and weight changes agree") {
    for (int seed = 0; seed < test::cases(5, 50); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const bool general : {true, false}) {
        for (test3::Sites s : general ? general_kinds(random) : tied_kinds(random)) {
          CAPTURE(seed);
          CAPTURE(s.name);
          const auto ids = test::all_ids(s.size());
          auto t = test::built(s);
          check_against_cgal(t, s, ids, general);
          for (const double distance : {0.01, 0.05, 0.17, 1.0}) {
            for (const double fraction : {0.0, 0.1, 1.0}) {
              CAPTURE(distance);
              CAPTURE(fraction);
              auto moved = test::some_ids(random, s.size(), fraction);
              if (moved.empty()) moved = {random.below(s.size())};
              for (const int i : moved) {
                // Multiples of 1/8 keep ties in the tied sets.
                const Vec<3> step = general
                                        ? Vec<3>(s.r * distance * test::random_direction<3>(random))
                                        : Vec<3>(0.125 * random.below(3) * Vec<3>(1, 1, -1));
                s.x.col(i) += step;
                if (random.uniform() < 0.3) s.w[i] *= general ? random.uniform(0.5, 1.5) : 0.5;
              }
              t.move(moved, s.x, s.w);
              check_against_cgal(t, s, ids, general);
            }
          }
        }
      }
    }
  }

  TEST_CASE("insertions and removals in any order agree") {
    for (int seed = 0; seed < test::cases(5, 100); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const bool general : {true, false}) {
        for (const auto& s : general ? general_kinds(random) : tied_kinds(random)) {
          CAPTURE(seed);
          CAPTURE(s.name);
          Triangulation<3> t;
          for (int i = 0; i < s.size(); ++i) t.insert(i, s.x.col(i), s.w[i]);
          check_against_cgal(t, s, test::all_ids(s.size()), general);

          std::vector<int> left;
          for (int i = 0; i < s.size(); ++i) {
            if (random.uniform() < 0.4) {
              t.remove(i);
            } else {
              left.push_back(i);
            }
          }

          check_against_cgal(t, s, left, general);
        }
      }
    }
  }
}

TEST_SUITE("triangulation3 against CGAL: a large set") {
  TEST_CASE("moves of all sites and of single ones agree, and the report says what they took") {
    const int count = test::cases(10000, 100000);
    for (const bool loose : {false, true}) {
      Random random(17);
      auto s = loose ? test3::uniform(random, count)
                     : test3::jittered(random, static_cast<int>(std::cbrt(count)));
      CAPTURE(s.name);
      auto t = test::built(s);
      for (const double distance : {0.01, 0.05, 0.17, 1.0}) {
        CAPTURE(distance);
        const auto agree = [&](const UpdateReport& report, const std::string& what) {
          const auto answer = test::ask_fast(s, test::all_ids(s.size()));
          // Both are long: compared in the check they would be printed.
          const bool edges_agree = test::edges(t) == answer.edges;
          const bool tetrahedra_agree = test::tetrahedra(t) == answer.simplices;
          CHECK(edges_agree);
          CHECK(tetrahedra_agree);
          CHECK(test::visible(t).size() == answer.visible.size());
          if (distance <= 0.05) CHECK(report.rebuilds == 0);
          MESSAGE(s.name << ", " << s.size() << " sites, " << what << " by " << distance
                         << " r: flips " << report.flips << ", extracted " << report.extracted
                         << ", unstuck " << report.unstuck << ", reinserted " << report.reinserted
                         << ", rebuilds " << report.rebuilds);
        };

        const auto all = test::all_ids(s.size());
        s = test::displaced(s, all, distance * s.r, random);
        agree(t.move(all, s.x, s.w), "all");

        UpdateReport total;
        for (int k = 0; k < 300; ++k) {
          const std::vector<int> one{random.below(s.size())};
          s = test::displaced(s, one, distance * s.r, random);
          total += t.move(one, s.x, s.w);
        }
        agree(total, "300 one by one");
      }
    }
  }
}
