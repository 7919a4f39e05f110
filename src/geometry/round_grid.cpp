// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/round_grid.hpp"

#include "hexaplast/geometry/grid.hpp"

namespace hexaplast {

PointArray grid_points(const RoundGrid& grid) {
  Mat3 axes;
  axes.col(2) = grid.axis.normalized();
  const bool lies_along_x = (axes.col(2) - Vec3::UnitX()).norm() < 1e-6;
  axes.col(1) = axes.col(2).cross(lies_along_x ? Vec3::UnitY() : Vec3::UnitX()).normalized();
  axes.col(0) = axes.col(1).cross(axes.col(2)).normalized();

  const Vec3 cells(grid.cells[0], grid.cells[1], grid.cells[2]);
  PointArray points = grid_points(grid.cells, Vec3::Constant(-grid.radius), (2 * grid.radius) * cells.cwiseInverse());
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    Vec3 p = points.row(n).transpose();
    if (grid.length) p[2] = 0;
    if (const double distance = p.norm(); distance > 1e-7) p *= p.cwiseAbs().maxCoeff() / distance;
    if (grid.length) p[2] = (points(n, 2) + grid.radius) / (2 * grid.radius) * *grid.length;
    points.row(n) = (grid.centre + axes * p).transpose();
  }
  return points;
}

}  // namespace hexaplast
