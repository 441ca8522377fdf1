// SPDX-License-Identifier: GPL-3.0-or-later
// A picture: discs at rest in a box, their Laguerre cells, and forces between them as lines, the
// thicker the larger. One list of shapes is painted as PNG and as SVG, into the current folder.
// To build it: find_package(lagrain 0.1 COMPONENTS render), lagrain::dim2 and lagrain::render, as
// in CMakeLists.txt.

#include <lagrain/compiled_kernels.hpp>
#include <lagrain/laguerre2.hpp>
#include <lagrain/paint.hpp>
#include <lagrain/simulation.hpp>
#include <lagrain/style.hpp>
#include <lagrain/triangulation_neighbourhood.hpp>

#include <cmath>
#include <cstdio>

using namespace lagrain;
using Law = CundallStrack<LinearSpring>;

int main() {
  std::vector<Grain<2>> discs;  // [m], [kg]
  for (int k = 0; k < 60; ++k) {
    discs.push_back({.position = {0.02 + 0.04 * (k % 10), 0.02 + 0.042 * (k / 10)},
                     .velocity = {0.2 * std::sin(k), 0},
                     .radius = k % 3 == 0 ? 0.018 : 0.012,
                     .mass = k % 3 == 0 ? 2.5 : 1.1});
  }
  const Law law{.normal = LinearSpring::with_restitution(1e6, 0.5), .friction = 0.4};
  Simulation<2, Law, VelocityVerlet, TriangulationNeighbourhood<2>> sim(
      make_grains<2, Law::needs>(discs), LawTable<Law>(law),
      {Wall<2>::half_space("floor", {0, 0}, {0, 1}), Wall<2>::half_space("left", {0, 0}, {1, 0}),
       Wall<2>::half_space("right", {0.4, 0}, {-1, 0})},
      {.gravity = {0, -9.81}, .time_step = 5e-5});
  while (sim.time() < 1.5) sim.step();

  const Columns<2>& x = sim.grains().position;
  Triangulation<2> triangulation;
  triangulation.build(x, sim.radii().array().square());
  const Eigen::AlignedBox2d box(Vec<2>(0, 0), Vec<2>(0.4, 0.16));   // [m]
  DisplayList list{.width = 240, .height = 110};                    // [pt]
  const Panel panel({{5, 5}, {235, 105}}, {box.min(), box.max()});  // from [m] to [pt]
  double area = 0;                                                  // of all cells [m^2]
  for (int i = 0; i < x.cols(); ++i) {
    const Columns<2> cell = laguerre_cell(triangulation, i, box);
    area += polygon_area(cell);
    Polygon polygon{.corners = {}, .fill = style::kCell, .outline = style::kCellLine};
    for (const auto& corner : cell.colwise()) polygon.corners.push_back(panel.point(corner));
    list.add(polygon);
    list.add(Disc{panel.point(x.col(i)), panel.length(sim.radii()[i]), style::kGrain,
                  style::kGrainLine});
  }
  sim.for_each_contact([&](Pair pair, const auto&, const Response<2>& response, const auto&) {
    const Stroke stroke{style::kContact, 0.02 * response.force.norm()};  // [pt] for [N]
    list.add(Segment{panel.point(x.col(pair.i)), panel.point(x.col(pair.j)), stroke});
  });
  paint_png(list, "picture.png");
  paint_svg(list, "picture.svg");
  std::printf("picture.png, picture.svg: %td cells, which fill %.12f of the box\n", x.cols(),
              area / box.volume());
  return std::abs(area / box.volume() - 1) < 1e-12 ? 0 : 1;
}
