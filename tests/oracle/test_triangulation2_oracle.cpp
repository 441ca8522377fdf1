// SPDX-License-Identifier: GPL-3.0-or-later
/// Triangulation<2> against CGAL. CGAL breaks ties by coordinates and we by ids: where there are
/// none the edges are the same, where there are, each of our edges passes CGAL's power test and
/// each edge with a dual of positive length is there.

#include <lagrain/triangulation2.hpp>

#include "dim2/sets2.hpp"
#include "oracle/cgal2.hpp"
#include "support/cases.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

using namespace lagrain;

namespace {

void check_against_cgal(const Triangulation<2>& t, const test::Sites& s,
                        const std::vector<int>& ids, bool general) {
  const auto answer = test::ask(s, ids);
  const auto ours = test::edges(t);
  CHECK(test::audited(t) == "");
  CHECK(test::power_sides(t, s, ids).valid);
  if (general) {
    CHECK(!answer.ties);
    CHECK(ours == answer.edges);
    CHECK(test::visible(t) == answer.visible);
  }
}

/// In general position, with hidden sites and without.
std::vector<test::Sites> general_kinds(Random& random) {
  return {test::jittered(random, 7), test::overlapping(random, 60), test::size_ratio(random, 60),
          test::far_away(test::overlapping(random, 40))};
}

std::vector<test::Sites> tied_kinds(Random& random) {
  return {test::square_lattice(6, 1), test::square_lattice(6, 0.3), test::hexagonal_lattice(6, 1),
          test::integers(random, 40, 5, 3), test::integers(random, 40, 8, 1)};
}

}  // namespace

TEST_SUITE("triangulation2 against CGAL") {
  TEST_CASE("build, moves of one, few and all sites, and weight changes agree") {
    for (int seed = 0; seed < test::cases(4, 200); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const bool general : {true, false}) {
        for (test::Sites s : general ? general_kinds(random) : tied_kinds(random)) {
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
                const double unit =
                    general ? s.r * distance * random.uniform(-1, 1) : 0.125 * random.below(3);
                s.x(0, i) += unit;
                s.x(1, i) += general ? s.r * distance * random.uniform(-1, 1) : unit;
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
    for (int seed = 0; seed < test::cases(4, 200); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const bool general : {true, false}) {
        for (const test::Sites& s : general ? general_kinds(random) : tied_kinds(random)) {
          CAPTURE(seed);
          CAPTURE(s.name);
          Triangulation<2> t;
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

  TEST_CASE("on a lattice with ties every edge with a dual of positive length is there") {
    for (const test::Sites& s : {test::square_lattice(8, 1), test::hexagonal_lattice(8, 1)}) {
      CAPTURE(s.name);
      const auto answer = test::ask(s, test::all_ids(s.size()));
      const auto ours = test::edges(test::built(s));

      CHECK(std::includes(ours.begin(), ours.end(), answer.certain.begin(), answer.certain.end()));
    }
  }
}
