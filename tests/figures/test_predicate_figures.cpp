// SPDX-License-Identifier: GPL-3.0-or-later
// What the report's figures of predicates and of updates claim, without their times.

#include "dense_packing.hpp"
#include "figure.hpp"
#include "predicate_trials.hpp"

#include <lagrain/check.hpp>

#include <support/tolerance.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace lagrain::figures {
FigureResult draw_figure13(const FigureOptions& options);
FigureResult draw_figure14(const FigureOptions& options);
}  // namespace lagrain::figures

using namespace lagrain;
using namespace lagrain::figures;

namespace {

constexpr int kSites = 512, kQueries = 2000;

/// Neither on a lattice nor on or near a curve or surface.
bool in_general_position(const std::string& name) {
  return name == "random" || name.starts_with("packing") || name.ends_with("off by 1e-6");
}

/// Counts the calls of a predicate, and holds it against exact arithmetic in every one.
template <class Predicate>
Tally checked_tally(const std::vector<Site<Predicate::kDim>>& sites) {
  const auto queries = draw_queries<Predicate>(sites, kQueries, 1);
  for (const auto& query : queries) {
    REQUIRE(filtered_sign<Predicate>(query) == always_exact_sign<Predicate>(query));
  }
  return tally<Predicate>(queries);
}

template <int Dim>
void check_signs() {
  for (const TrialSet<Dim>& set : trial_sets<Dim>(kSites)) {
    CAPTURE(set.name);
    const Tally turn = checked_tally<Orientation<Dim>>(set.sites);
    const Tally side = checked_tally<PowerSide<Dim>>(set.sites);
    CHECK(turn.queries == kQueries);
    CHECK(side.queries == kQueries);
    if (in_general_position(set.name)) {
      CHECK(turn.wrong + side.wrong == 0);
      CHECK(turn.ties + side.ties == 0);
    } else {
      CHECK(turn.wrong + side.wrong > 0);
      // What doubles get wrong, intervals of doubles cannot know.
      CHECK(turn.undecided >= turn.wrong);
      CHECK(side.undecided >= side.wrong);
    }
  }
}

FigureOptions quick(const std::string& folder) {
  FigureOptions o;
  o.out = std::filesystem::path(LAGRAIN_TEST_FOLDER) / folder;
  std::filesystem::create_directories(o.out);
  o.scenes = LAGRAIN_SCENES;
  o.quick = true;
  return o;
}

std::string fact(const FigureResult& result, const std::string& name) {
  const auto at = std::find_if(result.facts.begin(), result.facts.end(),
                               [&](const Fact& f) { return f.name == name; });
  return at == result.facts.end() ? "no such fact" : at->value;
}

void check_files(const FigureResult& result, const FigureOptions& o) {
  for (const auto& list : {result.pictures, result.downloads}) {
    CHECK(!list.empty());
    for (const auto& file : list) CHECK(std::filesystem::file_size(o.out / file) > 0);
  }
}

}  // namespace

TEST_SUITE("predicate figures") {
  TEST_CASE("exact signs part the grid of doubles along its diagonal, signs of doubles do not") {
    const OrientationMap map = orientation_map(256);

    int wrong = 0, opposite = 0;
    for (int row = 0; row < map.side; ++row) {
      for (int column = 0; column < map.side; ++column) {
        const std::size_t k = map.index(row, column);
        // The line is y = x, and the left of its direction is above it.
        REQUIRE(map.exact[k] == (row > column) - (row < column));
        wrong += map.plain[k] != map.exact[k];
        opposite += map.plain[k] * map.exact[k] < 0;
      }
    }
    CHECK(wrong > 1000);
    CHECK(opposite > 100);
  }

  TEST_CASE("doubles suffice for sites in general position, and fail where sites are degenerate") {
    check_signs<2>();
    check_signs<3>();
  }

  TEST_CASE("counts do not depend on the order of the calls: no rounding mode is left behind") {
    const TrialSet<3> lattice = trial_sets<3>(kSites)[3];
    REQUIRE(lattice.name == "cubic lattice");
    std::vector<Query<PowerSide<3>>> queries =
        draw_queries<PowerSide<3>>(lattice.sites, kQueries, 1);
    const Tally forwards = tally<PowerSide<3>>(queries);

    std::reverse(queries.begin(), queries.end());

    CHECK(tally<PowerSide<3>>(queries) == forwards);
    CHECK(forwards.undecided > 0);
  }

  TEST_CASE("queries of the power side begin with a positive simplex") {
    for (const TrialSet<2>& set : trial_sets<2>(kSites)) {
      for (const auto& q : draw_queries<PowerSide<2>>(set.sites, kQueries, 2)) {
        REQUIRE(orientation(q[0], q[1], q[2]) > 0);
      }
    }
    const std::vector<Site2> on_one_line = [] {
      std::vector<Site2> sites;
      for (int i = 0; i < 20; ++i) sites.push_back({1.0 * i, 2.0 * i, 1});
      return sites;
    }();
    CHECK_THROWS_AS(draw_queries<PowerSide<2>>(on_one_line, 10, 1), ContractError);
  }

  TEST_CASE("packed grains do not overlap, and fill their box as dense as they should") {
    const std::vector<Grain<2>> discs = dense_packing<2>(300, 1);
    double area = 0;
    Vec<2> low = discs[0].position, high = low;
    for (std::size_t i = 0; i < discs.size(); ++i) {
      area += grain_volume<2>(discs[i].radius);
      low = low.cwiseMin(Vec<2>(discs[i].position.array() - discs[i].radius));
      high = high.cwiseMax(Vec<2>(discs[i].position.array() + discs[i].radius));
      for (std::size_t j = 0; j < i; ++j) {
        REQUIRE((discs[i].position - discs[j].position).norm() >=
                (discs[i].radius + discs[j].radius) * (1 - 1e-12));
      }
    }
    CHECK(test::relative_error(area / (high - low).prod(), kDense<2>) < 0.03);
  }

  TEST_CASE("the figure of predicates writes what it shows") {
    const FigureOptions o = quick("fig13");

    const FigureResult result = draw_figure13(o);

    check_files(result, o);
    CHECK(fact(result, "wrong signs of doubles, random sites and packings") == "0 %");
  }

  TEST_CASE("the figure of updates finds what a build finds, and misses no contact") {
    const FigureOptions o = quick("fig14");

    const FigureResult result = draw_figure14(o);

    check_files(result, o);
    CHECK(fact(result, "edges and hidden sites in which an update and a build differ") == "0");
    CHECK(fact(result, "runs: contacts audited; missed").ends_with("; 0"));
    CHECK(fact(result, "runs of other skins end elsewhere by at most") == "0 m");
  }

  TEST_CASE("both stop when the user wants it") {
    FigureOptions o = quick("stopped");
    o.stop = [] { return true; };

    CHECK_THROWS_AS(draw_figure13(o), Interrupted);
    CHECK_THROWS_AS(draw_figure14(o), Interrupted);
  }
}
