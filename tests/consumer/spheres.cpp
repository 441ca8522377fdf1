#include <lagrain/laguerre3.hpp>
#include <lagrain/triangulation3.hpp>

#include <cmath>

int main() {
  lagrain::Columns<3> sites(3, 9);  // the corners of a cube and its centre [m]
  for (int i = 0; i < 8; ++i) sites.col(i) << i % 2, i / 2 % 2, i / 4;
  sites.col(8).setConstant(0.5);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(9, 0.4 * 0.4);  // r^2 [m^2]

  lagrain::Triangulation<3> triangulation;
  triangulation.build(sites, weights);

  const Eigen::AlignedBox3d cube(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  double volume = 0;
  for (int i = 0; i < 9; ++i) {
    volume += lagrain::polyhedron_volume(lagrain::laguerre_cell(triangulation, i, cube));
  }
  return std::abs(volume - 1) < 1e-12 ? 0 : 1;
}
