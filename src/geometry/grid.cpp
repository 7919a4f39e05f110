// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/grid.hpp"

#include <fmt/format.h>

#include "geometry/lattice.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {

HexMesh regular_grid(std::array<int, 3> cells, const Vec3& min, const Vec3& max) {
  const NodeLattice lattice{cells};
  lattice.check();
  for (int d = 0; d < 3; ++d)
    if (!(min[d] < max[d]))
      throw InputError(fmt::format("a grid from {} to {} in direction {}: the box is empty", min[d], max[d], d));

  const Vec3 spacing = (max - min).cwiseQuotient(Vec3(cells[0], cells[1], cells[2]));
  return HexMesh(grid_points(cells, min, spacing), lattice.hexahedra());
}

PointArray grid_points(std::array<int, 3> cells, const Vec3& min, const Vec3& spacing) {
  const NodeLattice lattice{cells};
  lattice.check(0);
  PointArray positions(lattice.num_nodes(), 3);
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i)
        positions.row(lattice.node(i, j, k)) = (min + Vec3(i, j, k).cwiseProduct(spacing)).transpose();
  return positions;
}

namespace {

/// Calls visit(first) with the smallest corner of every part of the grid that extends over one cell in each direction
/// of `extent` and over none in the others.
template <class Visit>
void for_each_part(const std::array<int, 3>& cells, const std::array<int, 3>& extent, const Visit& visit) {
  const auto end = [&](int d) { return cells[d] + 1 - extent[d]; };
  for (int k = 0; k < end(2); ++k)
    for (int j = 0; j < end(1); ++j)
      for (int i = 0; i < end(0); ++i) visit(i + (cells[0] + 1) * (j + (cells[1] + 1) * k));
}

std::array<int, 3> strides(const std::array<int, 3>& cells) {
  NodeLattice{cells}.check(0);
  return {1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)};
}

}  // namespace

std::vector<Quad> grid_quads(std::array<int, 3> cells) {
  const std::array<int, 3> step = strides(cells);
  std::vector<Quad> quads;
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
    std::array<int, 3> extent{};
    extent[a] = extent[b] = 1;
    for_each_part(cells, extent, [&, a = a, b = b](int n) {
      quads.push_back({n, n + step[a], n + step[a] + step[b], n + step[b]});
    });
  }
  return quads;
}

std::vector<Edge> grid_edges(std::array<int, 3> cells) {
  const std::array<int, 3> step = strides(cells);
  std::vector<Edge> edges;
  for (int d = 0; d < 3; ++d) {
    std::array<int, 3> extent{};
    extent[d] = 1;
    for_each_part(cells, extent, [&](int n) { edges.push_back({n, n + step[d]}); });
  }
  return edges;
}

}  // namespace hexaplast
