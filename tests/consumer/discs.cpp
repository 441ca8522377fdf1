#include <lagrain/triangulation2.hpp>

#include <iostream>

int main() {
  lagrain::Columns<2> sites(2, 5);  // the corners of a square and its centre [m]
  sites << 0, 1, 1, 0, 0.5, 0, 0, 1, 1, 0.5;
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(5, 0.35 * 0.35);  // r^2 [m^2]

  lagrain::Triangulation<2> triangulation;
  triangulation.build(sites, weights);

  int edges = 0;
  triangulation.for_each_edge([&](int, int) { ++edges; });
  std::cout << edges << " edges\n";
  return edges == 8 ? 0 : 1;
}
