// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/triangulation2.hpp>

#include "dim2/sets2.hpp"
#include "support/cases.hpp"
#include "support/triangulation_laws.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace lagrain;
using test::Edge;

TEST_SUITE("triangulation2") {
  TEST_CASE("sites inserted one by one into nothing give the triangulation that build gives") {
    for (int seed = 0; seed < test::cases(10, 300); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test::all_kinds(random)) test::check_insertions(s);
      test::check_insertions(test::collinear(random, 12));
    }
  }

  TEST_CASE("a move gives the triangulation that build gives, and moving back the former one") {
    for (int seed = 0; seed < test::cases(10, 500); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test::all_kinds(random)) {
        CHECK(test::check_moves(s, random).rebuilds == 0);
      }
    }
  }

  TEST_CASE("weights may change, hiding sites and showing them again") {
    for (int seed = 0; seed < test::cases(20, 500); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      const auto s = test::jittered(random, 10);
      CHECK(test::check_weights(s, 0.2, random).rebuilds == 0);
    }
  }

  TEST_CASE(
      "any sequence of moves, insertions and removals ends in the triangulation of what is there") {
    for (int seed = 0; seed < test::cases(10, 500); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s : test::all_kinds(random)) test::check_sequence(s, random);
    }
  }

  TEST_CASE("a row of sites on a floor that shakes is never built anew") {
    Random random(7);
    std::vector<std::array<double, 3>> rows;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 30; ++i) rows.push_back({1.0 * i, 1.0 * j, 0.25});
    }
    test::Sites s = test::make_sites("floor", rows, 0.5);
    auto t = test::built(s);
    UpdateReport total;

    for (int step = 0; step < 200; ++step) {
      const auto ids = test::some_ids(random, s.size(), 0.3);
      for (const int i : ids) {
        s.x.col(i) += 0.02 * Vec<2>(random.uniform(-1, 1), random.uniform(-1, 1));
        s.x(1, i) = std::max(0.0, s.x(1, i));
      }
      total += t.move(ids, s.x, s.w);
    }

    CHECK_AS_BUILT(t, s);
    CHECK(total.rebuilds == 0);
  }

  TEST_CASE("the six bad edges that no flip can mend are mended by taking out a hidden site") {
    // Three outer sites at radius 2, three inner ones at radius 1/2, and a far frame. With the
    // inner ones turned forward the spokes lean one way and are regular; turned back and with new
    // weights all six are bad, and none can be flipped.
    const auto turned = [](double angle, double outer, double inner) {
      std::vector<std::array<double, 3>> rows;
      for (int k = 0; k < 3; ++k) {
        const double at = 2 * std::numbers::pi / 3 * k;
        rows.push_back({2 * std::cos(at), 2 * std::sin(at), outer});
      }
      for (int k = 0; k < 3; ++k) {
        const double at = 2 * std::numbers::pi / 3 * k + angle;
        rows.push_back({std::cos(at) / 2, std::sin(at) / 2, inner});
      }
      for (int k = 0; k < 5; ++k) {
        const double at = 2 * std::numbers::pi / 5 * k;
        rows.push_back({50 * std::cos(at), 50 * std::sin(at), 0});
      }
      return test::make_sites("six bad edges", rows);
    };
    const test::Sites before = turned(0.9, 0, 0.25), after = turned(-0.2, 5, 0.25);
    auto t = test::built(before);
    for (const Edge& spoke :
         {Edge{1, 3}, Edge{2, 4}, Edge{0, 5}, Edge{0, 3}, Edge{1, 4}, Edge{2, 5}}) {
      const auto list = test::edges(t);
      REQUIRE(std::binary_search(list.begin(), list.end(), spoke));
    }

    const UpdateReport report = t.move(test::all_ids(after.size()), after.x, after.w);

    CHECK_AS_BUILT(t, after);
    CHECK(report.rebuilds == 0);
    CHECK(report.unstuck > 0);
    CHECK(test::hidden(t) == std::vector<int>{3, 4, 5});
  }

  TEST_CASE("sets of no, one, two and three sites are triangulations") {
    Triangulation<2> t;
    CHECK(t.dimension() == -1);
    CHECK(t.size() == 0);
    CHECK(t.audit().empty());

    t.insert(0, Vec<2>(1, 1), 1);
    CHECK(t.dimension() == 0);
    t.insert(1, Vec<2>(2, 2), 1);
    CHECK(t.dimension() == 1);
    CHECK(test::edges(t) == std::vector<Edge>{{0, 1}});
    t.insert(2, Vec<2>(4, 4), 1);
    CHECK(t.dimension() == 1);
    CHECK(test::edges(t) == std::vector<Edge>{{0, 1}, {1, 2}});
    t.insert(3, Vec<2>(4, 5), 1);
    CHECK(t.dimension() == 2);
    CHECK(test::triangles(t).size() == 2);
    CHECK(t.audit().empty());
    t.remove(3);
    CHECK(t.dimension() == 1);
    t.remove(0);
    t.remove(1);
    t.remove(2);
    CHECK(t.dimension() == -1);
    CHECK(t.size() == 4);
    CHECK(t.audit().empty());
    t.build(Columns<2>(2, 0), Eigen::VectorXd(0));
    CHECK(t.size() == 0);
  }

  TEST_CASE("many sites fall on one line and leave it again") {
    Random random(5);
    test::Sites s = test::jittered(random, 6);
    auto t = test::built(s);
    test::Sites flat = s;
    flat.x.row(1).setConstant(2.5);

    t.move(test::all_ids(s.size()), flat.x, flat.w);
    CHECK(t.dimension() == 1);
    CHECK_AS_BUILT(t, flat);
    t.move(test::all_ids(s.size()), s.x, s.w);

    CHECK(t.dimension() == 2);
    CHECK_AS_BUILT(t, s);
  }

  TEST_CASE("of coincident centres the heaviest is seen, of equal ones the last") {
    const auto line = test::built(test::make_sites("", {{1, 1, 2}, {1, 1, 3}, {1, 1, 3}}));
    CHECK(line.dimension() == 0);
    CHECK(test::hidden(line) == std::vector<int>{0, 1});

    const auto plane = test::built(test::make_sites(
        "", {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}, {1, 1, 2}, {1, 1, 3}, {1, 1, 3}, {1, 1, 1}}));
    CHECK(test::hidden(plane) == std::vector<int>{3, 4, 6});
    CHECK(plane.audit().empty());
  }

  TEST_CASE("all sites at one place, and then apart") {
    Random random(11);
    const test::Sites s = test::jittered(random, 5);
    test::Sites heap = s;
    heap.x.setConstant(3);
    auto t = test::built(s);

    t.move(test::all_ids(s.size()), heap.x, heap.w);
    CHECK(t.dimension() == 0);
    CHECK_AS_BUILT(t, heap);
    t.move(test::all_ids(s.size()), s.x, s.w);

    CHECK_AS_BUILT(t, s);
  }

  TEST_CASE("every neighbour relation is an edge, seen from both ends") {
    Random random(2);
    for (const auto& s : test::all_kinds(random)) test::check_neighbours(s);
  }

  TEST_CASE("an update tells which edges it made") {
    Random random(3);
    for (const auto& s : test::all_kinds(random)) test::check_new_edges(s, random);
  }

  TEST_CASE("a broken contract throws and changes nothing") {
    Random random(1);
    test::check_contracts(test::jittered(random, 4));
  }
}

TEST_SUITE("contacts in the triangulation") {
  TEST_CASE("only the weight r^2 has the touching pair as an edge") {
    const auto has_edge = [](const std::vector<std::array<double, 3>>& discs, auto weight,
                             Edge edge) {
      auto rows = discs;
      for (auto& row : rows) row[2] = weight(row[2]);
      const auto list = test::edges(test::built(test::make_sites("", rows)));
      return std::binary_search(list.begin(), list.end(), edge);
    };
    const auto squared = [](double r) { return r * r; };
    const auto plain = [](double r) { return r; };
    const auto root = [](double r) { return std::sqrt(r); };
    const auto none = [](double) { return 0.0; };
    const std::vector<std::array<double, 3>> first{
        {9.99, 0, 10}, {-9.99, 0, 10}, {0, 4.7, 1}, {0, -4.7, 1}};
    const std::vector<std::array<double, 3>> second{
        {0.1099, 0, 0.1}, {-0.1099, 0, 0.1}, {0, 0.00999, 0.01}, {0, -0.00999, 0.01}};

    CHECK(has_edge(first, squared, {0, 1}));
    CHECK(!has_edge(first, plain, {0, 1}));
    CHECK(!has_edge(first, root, {0, 1}));
    CHECK(!has_edge(first, none, {0, 1}));
    CHECK(has_edge(second, squared, {2, 3}));
    CHECK(!has_edge(second, plain, {2, 3}));
    CHECK(!has_edge(second, root, {2, 3}));
  }

  TEST_CASE("four equal discs in a square keep both contacts up to an overlap of 0.5858 r") {
    const auto square = [](double half) {
      return test::make_sites("", {{0.9999, 0, 1}, {-0.9999, 0, 1}, {0, half, 1}, {0, -half, 1}});
    };

    CHECK(test::missed_contacts(test::built(square(1.00015)), square(1.00015)) == 0);
    CHECK(test::missed_contacts(test::built(square(0.9998)), square(0.9998)) == 1);
  }

  TEST_CASE("every contact is an edge while overlaps stay below 0.58 of the smaller radius") {
    int contacts_checked = 0;
    for (int seed = 0; seed < test::cases(40, 2000); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      // Random sequential packing that admits such overlaps.
      std::vector<std::array<double, 3>> rows;
      const double ratio = std::pow(10.0, random.uniform(0, 1.5));
      for (int trial = 0; trial < 1500 && rows.size() < 150; ++trial) {
        const double r = random.uniform() < 0.2 ? 1 : random.uniform(1 / ratio, 1);
        const Vec<2> x(random.uniform(0, 12), random.uniform(0, 12));
        bool fits = true;
        for (const auto& row : rows) {
          const double q = std::sqrt(row[2]);
          fits = fits && r + q - (x - Vec<2>(row[0], row[1])).norm() < 0.58 * std::min(r, q);
        }
        if (fits) rows.push_back({x[0], x[1], r * r});
      }
      const test::Sites s = test::make_sites("packing", rows);

      const auto t = test::built(s);

      CHECK(test::missed_contacts(t, s) == 0);
      CHECK(t.hidden().empty());
      ++contacts_checked;
    }
    CHECK(contacts_checked > 0);
  }

  TEST_CASE("a build sorts sites at the edge of numbers, and with one far away") {
    test::check_edge_of_numbers<2>();
  }
}
