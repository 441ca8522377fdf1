// SPDX-License-Identifier: GPL-3.0-or-later
#include <lagrain/edge_list.hpp>

#include <lagrain/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <vector>

using namespace lagrain;

namespace {

using Edges = std::vector<EdgeList::Edge>;

/// As a visitor sees them.
Edges visited(const EdgeList& list) {
  Edges edges;
  list.for_each([&](int i, int j) { edges.push_back({i, j}); });
  return edges;
}

}  // namespace

TEST_SUITE("edge_list") {
  TEST_CASE("visits see what notes have changed, and settling changes nothing that they see") {
    constexpr int kSites = 12;
    Random random(1);
    EdgeList list;
    list.find(kSites, [](auto&& f) {
      for (int i = 1; i < kSites; ++i) f(i - 1, i);
    });
    std::set<EdgeList::Edge> expected;
    for (int i = 1; i < kSites; ++i) expected.insert({i - 1, i});

    for (int k = 0; k < 500; ++k) {
      const int a = random.below(kSites), b = random.below(kSites);
      if (a == b) continue;
      const EdgeList::Edge edge{std::min(a, b), std::max(a, b)};
      if (expected.erase(edge) > 0) {
        list.note_gone(a, b);
      } else {
        expected.insert(edge);
        list.note_made(a, b);
      }

      CAPTURE(k);
      const Edges wanted(expected.begin(), expected.end());
      CHECK(visited(list) == wanted);
      if (k % 7 == 0) {
        CHECK(std::ranges::equal(list.settle(), wanted));
        CHECK(visited(list) == wanted);
      }
    }
  }
}
