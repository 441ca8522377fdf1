// SPDX-License-Identifier: GPL-3.0-or-later
/// Laguerre cells in space against the radical cells of Voro++, which finds them without a
/// triangulation, by cutting each with all sites near enough.

#include <lagrain/laguerre3.hpp>

#include "dim3/sets3.hpp"
#include "support/cases.hpp"

#include <doctest/doctest.h>
#include <voro++/voro++.hh>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace lagrain;

namespace {

struct Radical {
  double volume = 0;
  std::vector<int> beyond;  // sorted
};

/// One entry per site, empty for a site without a cell.
std::vector<Radical> radical_cells(const test3::Sites& s, const Eigen::AlignedBox3d& box) {
  const int blocks = std::max(1, static_cast<int>(std::cbrt(s.size() / 5.0)));
  voro::container_poly container(box.min()[0], box.max()[0], box.min()[1], box.max()[1],
                                 box.min()[2], box.max()[2], blocks, blocks, blocks, false, false,
                                 false, 8);
  for (int i = 0; i < s.size(); ++i) {
    container.put(i, s.x(0, i), s.x(1, i), s.x(2, i), std::sqrt(s.w[i]));
  }
  std::vector<Radical> cells(static_cast<std::size_t>(s.size()));
  voro::c_loop_all loop(container);
  voro::voronoicell_neighbor cell;
  if (!loop.start()) return cells;
  do {
    if (!container.compute_cell(cell, loop)) continue;
    Radical& radical = cells[static_cast<std::size_t>(loop.pid())];
    radical.volume = cell.volume();
    cell.neighbors(radical.beyond);
    std::sort(radical.beyond.begin(), radical.beyond.end());
  } while (loop.inc());
  return cells;
}

}  // namespace

TEST_SUITE("laguerre3 against Voro++") {
  TEST_CASE("cells have the volumes and the neighbours of radical cells") {
    for (int seed = 0; seed < test::cases(3, 100); ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      for (const auto& s :
           {test3::jittered(random, 7), test3::uniform(random, 300),
            test3::polydisperse(random, 300, 10), test3::polydisperse(random, 300, 100),
            test3::overlapping(random, 300)}) {
        CAPTURE(seed);
        CAPTURE(s.name);
        const Vec<3> low = s.x.rowwise().minCoeff(), high = s.x.rowwise().maxCoeff();
        const Eigen::AlignedBox3d box(low - Vec<3>::Constant(0.5), high + Vec<3>::Constant(0.5));
        const auto expected = radical_cells(s, box);
        const auto t = test::built(s);
        int different_faces = 0, faces = 0;

        for (int i = 0; i < s.size(); ++i) {
          CAPTURE(i);
          const auto cell = laguerre_cell(t, i, box);
          std::vector<int> beyond;
          for (const LaguerreFace& face : cell) beyond.push_back(face.beyond);
          std::sort(beyond.begin(), beyond.end());
          const Radical& radical = expected[static_cast<std::size_t>(i)];

          // A cell that is all but hidden is rounding.
          CHECK(std::abs(polyhedron_volume(cell) - radical.volume) <=
                1e-9 * radical.volume + 1e-13);
          faces += static_cast<int>(radical.beyond.size());
          different_faces += beyond != radical.beyond;
        }
        CHECK(faces > 1000);
        CHECK(different_faces == 0);
      }
    }
  }
}
