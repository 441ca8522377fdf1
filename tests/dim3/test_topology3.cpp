// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/topology3.hpp>

#include <lagrain/random.hpp>

#include "support/cases.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

using namespace lagrain;

namespace {

using Quad = Topology3::Quad;

/// One tetrahedron and the four infinite ones round it, as abstract as any other five.
Topology3 sphere(int vertices) {
  Topology3 t;
  t.clear(vertices);
  t.add({0, 1, 2, 3});
  for (int i = 0; i < 4; ++i) {
    Quad beyond{0, 1, 2, 3};
    beyond[static_cast<std::size_t>(i)] = Topology3::kInfinite;
    const auto& f = Topology3::kFacet[i];
    std::swap(beyond[static_cast<std::size_t>(f[0])], beyond[static_cast<std::size_t>(f[1])]);
    t.link(i, t.corner_at(t.add(beyond), Topology3::kInfinite));
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) t.link(t.corner_at(1 + i, j), t.corner_at(1 + j, i));
  }
  return t;
}

/// Vertices and twins of every cell alive.
std::vector<std::array<int, 9>> snapshot(const Topology3& t) {
  std::vector<std::array<int, 9>> list;
  for (int cell = 0; cell < t.slots(); ++cell) {
    if (!t.alive(cell)) continue;
    std::array<int, 9> row;
    row[0] = cell;
    for (int i = 0; i < 4; ++i) {
      row[static_cast<std::size_t>(1 + i)] = t.vertex(4 * cell + i);
      row[static_cast<std::size_t>(5 + i)] = t.twin(4 * cell + i);
    }
    list.push_back(row);
  }
  return list;
}

/// Twins are mutual, share their facet in opposite order, and every vertex knows a corner of its.
bool sound(const Topology3& t) {
  bool good = true;
  for (int cell = 0; cell < t.slots(); ++cell) {
    if (!t.alive(cell)) continue;
    for (int corner = 4 * cell; corner < 4 * cell + 4; ++corner) {
      const int other = t.twin(corner);
      good = good && t.alive(other >> 2) && t.twin(other) == corner;
      const auto facet = [&](int at) {
        std::array<int, 3> v;
        for (std::size_t k = 0; k < 3; ++k) {
          v[k] = t.vertex((at & ~3) + Topology3::kFacet[at & 3][k]);
        }
        std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
        return v;
      };
      auto mirrored = facet(other);
      std::swap(mirrored[1], mirrored[2]);
      good = good && facet(corner) == mirrored;
      const int at = t.corner_of(t.vertex(corner));
      good = good && at >= 0 && t.alive(at >> 2) && t.vertex(at) == t.vertex(corner);
    }
  }
  return good;
}

/// Puts a vertex into a cell and one of its neighbours.
void insert_into(Topology3& t, int v, int cell, int corner) {
  t.clear_marks();
  const std::vector<int> hole{cell, t.twin(corner) >> 2};
  for (const int inside : hole) t.set_mark(inside);
  std::vector<int> rim;
  for (const int inside : hole) {
    for (int at = 4 * inside; at < 4 * inside + 4; ++at) {
      if (!t.marked(t.twin(at) >> 2)) rim.push_back(at);
    }
  }
  t.fill_from(v, hole, rim);
}

/// 2-3 without any geometry; false if the two apices are one.
bool flip_facet(Topology3& t, int corner, std::vector<int>& made) {
  const int opposite = t.vertex(t.twin(corner));
  if (t.vertex(corner) == opposite) return false;
  std::array<Quad, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = t.vertices(corner >> 2);
    out[k][static_cast<std::size_t>(Topology3::kFacet[corner & 3][k])] = opposite;
  }
  made.assign(4, -1);
  t.exchange(std::array{corner >> 2, t.twin(corner) >> 2}, out, made);
  return true;
}

}  // namespace

TEST_SUITE("topology3") {
  TEST_CASE("one tetrahedron and its outside are five cells, each next to each") {
    const Topology3 t = sphere(4);

    CHECK(sound(t));
    CHECK(t.cells() == 5);
    CHECK(!t.infinite(0));
    for (int cell = 1; cell < 5; ++cell) CHECK(t.infinite(cell));
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        if (i != j) CHECK(t.degree(i, j, 9) == 3);
      }
    }
  }

  TEST_CASE("vertices put into random holes leave a sphere") {
    for (int seed = 0; seed < test::cases(20, 1000); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      Topology3 t = sphere(4);
      for (int v = 4; v < 40; ++v) {
        t.add_vertex();
        int cell = random.below(t.slots());
        while (!t.alive(cell)) cell = random.below(t.slots());
        insert_into(t, v, cell, 4 * cell + random.below(4));
        REQUIRE(sound(t));
        // Two cells out, a cone over their six facets in; two neighbours of the first five share
        // more than one facet only if they are glued twice, which these are not.
        REQUIRE(t.cells() == 5 + 4 * (v - 3));
      }
      std::vector<int> star;
      for (int v = -1; v < 40; ++v) {
        t.star(v, star);
        int count = 0;
        for (int cell = 0; cell < t.slots(); ++cell) {
          const auto& q = t.vertices(cell);
          count += t.alive(cell) && std::find(q.begin(), q.end(), v) != q.end();
        }
        REQUIRE(static_cast<int>(star.size()) == count);
        for (const int corner : star) REQUIRE(t.vertex(corner) == v);
      }
    }
  }

  TEST_CASE("exchanges undone in opposite order restore every cell, id for id") {
    for (int seed = 0; seed < test::cases(20, 1000); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      Topology3 t = sphere(4);
      for (int v = 4; v < 30; ++v) {
        t.add_vertex();
        int cell = random.below(t.slots());
        while (!t.alive(cell)) cell = random.below(t.slots());
        insert_into(t, v, cell, 4 * cell + random.below(4));
      }
      const auto before = snapshot(t);
      struct Done {
        std::array<Quad, 2> quads;
        std::vector<int> made;
      };
      std::vector<Done> log;

      for (int step = 0; step < 60; ++step) {
        int cell = random.below(t.slots());
        while (!t.alive(cell)) cell = random.below(t.slots());
        const int corner = 4 * cell + random.below(4);
        Done done{{t.vertices(cell), t.vertices(t.twin(corner) >> 2)}, {}};
        if (!flip_facet(t, corner, done.made)) continue;
        log.push_back(done);
        REQUIRE(sound(t));
      }
      CHECK(log.size() > 30);
      for (; !log.empty(); log.pop_back()) {
        std::array<int, 4> made;
        t.exchange(std::span(log.back().made).first(3), log.back().quads, made);
        REQUIRE(sound(t));
      }

      CHECK(snapshot(t) == before);
    }
  }

  TEST_CASE("marks and flags belong to their cell and vanish with it") {
    Topology3 t = sphere(5);
    t.set_mark(2);
    CHECK(t.marked(2));
    CHECK(!t.marked(1));
    CHECK(!t.exchange_flag(9, true));
    CHECK(t.exchange_flag(9, true));
    CHECK(!t.exchange_flag(8, true));

    t.clear_marks();
    CHECK(!t.marked(2));
    t.set_mark(2);
    t.release(2);
    CHECK(!t.alive(2));
    CHECK(t.cells() == 4);
    CHECK(t.add({0, 1, 2, 4}) == 2);

    CHECK(!t.marked(2));
    CHECK(!t.exchange_flag(9, false));
    CHECK(!t.exchange_flag(8, false));
  }

  TEST_CASE("edges are what cells turn around, even where two join the same vertices") {
    int doubled = 0;
    for (int seed = 0; seed < test::cases(20, 1000); ++seed) {
      CAPTURE(seed);
      Random random(static_cast<std::uint64_t>(seed));
      constexpr int kVertices = 8;
      auto t = sphere(kVertices);
      const auto any_cell = [&] {
        int cell = random.below(t.slots());
        while (!t.alive(cell)) cell = random.below(t.slots());
        return cell;
      };
      for (int v = 4; v < kVertices; ++v) {
        const int cell = any_cell();
        insert_into(t, v, cell, 4 * cell + random.below(4));
      }
      std::vector<int> made;
      for (int flips = 0; flips < 30; ++flips) {
        flip_facet(t, 4 * any_cell() + random.below(4), made);
        t.clear_marks();
        std::vector<int> cells;
        for (int cell = 0; cell < t.slots(); ++cell) {
          if (!t.alive(cell)) continue;
          t.set_mark(cell);
          cells.push_back(cell);
        }
        std::vector<std::pair<int, int>> edges;
        bool all_inside = true;
        t.for_each_edge_of(cells, [&](int a, int b, bool inside) {
          edges.push_back(std::minmax(a, b));
          all_inside = all_inside && inside;
        });
        CHECK(all_inside);
        // V - E + F - C = 0 with F = 2 C, the vertex at infinity included.
        CHECK(static_cast<int>(edges.size()) == kVertices + 1 + t.cells());
        std::sort(edges.begin(), edges.end());
        doubled += std::adjacent_find(edges.begin(), edges.end()) != edges.end();

        const int one = any_cell();
        t.clear_marks();
        t.set_mark(one);
        int around = 0, inside_one = 0;
        t.for_each_edge_of(std::array{one}, [&](int, int, bool inside) {
          ++around;
          inside_one += inside;
        });
        CHECK(around == 6);
        CHECK(inside_one == 0);
      }
    }
    CHECK(doubled > 0);
  }
}
