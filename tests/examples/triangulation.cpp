// SPDX-License-Identifier: GPL-3.0-or-later
// Only the triangulation, without any simulation: of five discs in the plane one moves, some grow,
// and a sixth comes and goes. In space it is the same, with <lagrain/triangulation3.hpp>.
// To build it: find_package(lagrain 0.1) and lagrain::dim2, as in CMakeLists.txt.

#include <lagrain/triangulation2.hpp>

#include <cstdio>
#include <vector>

namespace {

bool all_hold = true;

/// Prints what T is like now, and whether it is what the example says.
void show(const char* what, lagrain::Triangulation<2>& t, std::size_t edges, std::size_t hidden) {
  std::printf("%-26s %zu edges, %zu hidden\n", what, t.edges().size(), t.hidden().size());
  all_hold = all_hold && t.edges().size() == edges && t.hidden().size() == hidden;
}

}  // namespace

int main() {
  lagrain::Columns<2> centres(2, 5);  // the corners of a square and its middle [m]
  centres << 0, 1, 1, 0, 0.5,         //
      0, 0, 1, 1, 0.5;
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(5, 0.3 * 0.3);  // squares of the radii [m^2]

  lagrain::Triangulation<2> t;
  t.build(centres, weights);
  show("a square and its middle:", t, 8, 0);

  centres.col(4) << 0.5, -0.2;  // the disc in the middle leaves the square
  const lagrain::UpdateReport update = t.move(std::vector{4}, centres, weights);
  show("the middle has moved out:", t, 7, 0);

  weights[4] = 0;
  centres.col(4) << 0.5, 0.5;
  weights.head(4).setConstant(0.8 * 0.8);  // the corners cover the middle, which shrinks to a point
  t.move(std::vector{0, 1, 2, 3, 4}, centres, weights);
  show("the middle is covered:", t, 5, 1);

  t.insert(5, {2, 0.5}, 0.1 * 0.1);
  show("a sixth disc to the right:", t, 7, 1);
  t.for_each_neighbour(5, [](int j) { std::printf("  it is a neighbour of %d\n", j); });
  t.remove(5);
  show("and gone:", t, 5, 1);

  all_hold = all_hold && update.rebuilds == 0 && t.audit().empty();  // exactly what it should be
  std::puts(all_hold ? "as it should be" : "NOT as it should be");
  return all_hold ? 0 : 1;
}
