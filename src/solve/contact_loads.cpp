// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/contact_loads.hpp"

#include <cmath>

#include "base/require.hpp"

namespace hexaplast {
namespace {

/// Twice the area of the triangle of three nodes, along its normal.
Eigen::RowVector3d doubled_area(ConstPoints x, int a, int b, int c) {
  const Eigen::RowVector3d ab = x.row(b) - x.row(a), ac = x.row(c) - x.row(a);
  return ab.cross(ac);
}

}  // namespace

void add_pressure(const Triangle& face, double pressure, ConstPoints x, Points f) {
  require_nodes("add_pressure", face, x.rows());
  require_rows("add_pressure", "f", f, x.rows());
  const Eigen::RowVector3d force = pressure / 6 * doubled_area(x, face[0], face[1], face[2]);
  for (const int node : face) f.row(node) += force;
}

void add_pressure(const Quad& face, double pressure, ConstPoints x, Points f) {
  add_pressure(Triangle{face[0], face[1], face[2]}, pressure, x, f);
  add_pressure(Triangle{face[0], face[2], face[3]}, pressure, x, f);
}

Eigen::RowVector3d Obstacle::unlimited_force(double d, ConstPoints v, int node) const {
  return -stiffness * d * normal.transpose() + damping * d * v.row(node);
}

void Obstacle::stiff_at(ConstPoints x, ConstPoints v, std::vector<int>& stiff) const {
  require_rows("Obstacle::stiff_at", "v", v, x.rows());
  stiff.clear();
  for (int node = 0; node < static_cast<int>(x.rows()); ++node) {
    const double d = gap(x, node);
    if (d < 0 && !is_limited(unlimited_force(d, v, node).norm())) stiff.push_back(node);
  }
}

void Obstacle::add_force(ConstPoints x, ConstPoints v, Points f) const {
  require_rows("Obstacle::add_force", "v", v, x.rows());
  require_rows("Obstacle::add_force", "f", f, x.rows());
  for (int node = 0; node < static_cast<int>(x.rows()); ++node) {
    const double d = gap(x, node);
    if (!(d < 0)) continue;
    Eigen::RowVector3d force = unlimited_force(d, v, node);
    const double size = force.norm();
    if (is_limited(size)) force *= max_force / size;
    f.row(node) += share_of(node) * force;
  }
}

void Obstacle::add_stiffness_product(std::span<const int> stiff, double factor, ConstPoints dx, Points df) const {
  require_nodes("Obstacle::add_stiffness_product", stiff, dx.rows());
  require_rows("Obstacle::add_stiffness_product", "df", df, dx.rows());
  for (const int node : stiff)
    df.row(node) -= share_of(node) * factor * stiffness * dx.row(node).dot(normal) * normal.transpose();
}

void Obstacle::add_stiffness_blocks(std::span<const int> stiff, double factor, BlockMatrix& A) const {
  require_nodes("Obstacle::add_stiffness_blocks", stiff, A.num_nodes());
  const Mat3 block = -factor * stiffness * normal * normal.transpose();
  for (const int node : stiff) A.add(node, node, share_of(node) * block);
}

}  // namespace hexaplast
