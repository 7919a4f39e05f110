// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/sections.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/require.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {

namespace {

constexpr double kSameCoordinate = 1e-6;  // of the length: nodes this close along the axis form one section

double mean_coordinate(const std::vector<int>& nodes, int axis, ConstPoints at) {
  double sum = 0;
  for (const int n : nodes) sum += at(n, axis);
  return sum / static_cast<double>(nodes.size());
}

/// The nodes grouped by equal initial coordinate along the axis, in ascending order.
std::vector<std::vector<int>> layers_along(const HexMesh& mesh, const EndSections& ends) {
  const PointArray& X = mesh.positions();
  std::vector<int> order(mesh.num_nodes());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return X(a, ends.axis) < X(b, ends.axis); });

  std::vector<std::vector<int>> grouped;
  for (const int n : order) {
    if (grouped.empty() || X(n, ends.axis) - X(grouped.back().front(), ends.axis) > kSameCoordinate * ends.length)
      grouped.emplace_back();
    grouped.back().push_back(n);
  }
  return grouped;
}

}  // namespace

EndSections end_sections(const HexMesh& mesh) {
  const PointArray& X = mesh.positions();
  if (X.rows() == 0) throw InputError("a mesh without nodes has no end sections");
  const Vec3 min = X.colwise().minCoeff(), max = X.colwise().maxCoeff();
  const Vec3 extent = max - min;

  // a direction counts as longer only beyond rounding, so that a cube is measured along x
  EndSections ends;
  for (int d = 1; d < 3; ++d)
    if (extent[d] > extent[ends.axis] * (1 + kSameCoordinate)) ends.axis = d;
  ends.length = extent[ends.axis];
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (X(n, ends.axis) - min[ends.axis] <= kSameCoordinate * ends.length) ends.min.push_back(n);
    if (max[ends.axis] - X(n, ends.axis) <= kSameCoordinate * ends.length) ends.max.push_back(n);
  }
  ends.layers = layers_along(mesh, ends);
  return ends;
}

double elongation(const EndSections& ends, ConstPoints at) {
  require_nodes("elongation", ends.max, at.rows());
  require_nodes("elongation", ends.min, at.rows());
  return (mean_coordinate(ends.max, ends.axis, at) - mean_coordinate(ends.min, ends.axis, at)) / ends.length - 1;
}

double section_angle(const HexMesh& mesh, const std::vector<int>& section, int axis, ConstPoints at) {
  require_rows("section_angle", "at", at, mesh.num_nodes());
  require_nodes("section_angle", section, mesh.num_nodes());
  const PointArray& X = mesh.positions();
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double Xi = mean_coordinate(section, i, X), Xj = mean_coordinate(section, j, X);
  const double xi = mean_coordinate(section, i, at), xj = mean_coordinate(section, j, at);

  // the plane rotation that maximises sum x . R X has tan(angle) = sum X cross x / sum X dot x
  double cross = 0, along = 0;
  for (const int n : section) {
    const double Ui = X(n, i) - Xi, Uj = X(n, j) - Xj, ui = at(n, i) - xi, uj = at(n, j) - xj;
    cross += Ui * uj - Uj * ui;
    along += Ui * ui + Uj * uj;
  }
  return std::atan2(cross, along);
}

double twist(const HexMesh& mesh, const EndSections& ends, ConstPoints at) {
  require_rows("twist", "at", at, mesh.num_nodes());
  double total = 0;
  double previous = 0;
  bool first = true;
  for (const auto& layer : ends.layers) {
    if (layer.size() < 2) continue;  // one node has no angle
    const double angle = section_angle(mesh, layer, ends.axis, at);
    if (!first) total += std::remainder(angle - previous, 2 * std::numbers::pi);
    previous = angle;
    first = false;
  }
  return total;
}

double axial_pull(const HexMesh& mesh, const EndSections& ends, ConstPoints forces) {
  require_rows("axial_pull", "forces", forces, mesh.num_nodes());
  constexpr double kInTheMiddle = 1e-6;  // of the length: such nodes belong to neither half
  const auto X = mesh.positions().col(ends.axis);
  const double middle = (X.minCoeff() + X.maxCoeff()) / 2;
  double beyond = 0, before = 0;
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (X(n) > middle + kInTheMiddle * ends.length) beyond += forces(n, ends.axis);
    if (X(n) < middle - kInTheMiddle * ends.length) before -= forces(n, ends.axis);
  }
  return std::abs(before) > std::abs(beyond) ? before : beyond;
}

}  // namespace hexaplast
