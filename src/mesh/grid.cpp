// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/grid.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

HexMesh regular_grid(std::array<int, 3> cells, const Vec3& least, const Vec3& most) {
  std::int64_t num_nodes = 1;
  for (int d = 0; d < 3; ++d) {
    if (cells[d] < 1)
      throw InputError(fmt::format("a grid of {} cells in direction {}: at least 1 needed", cells[d], d));
    if (!(least[d] < most[d]))
      throw InputError(fmt::format("a grid from {} to {} in direction {}: the box is empty", least[d], most[d], d));
    // checked in each factor, so that the product of the three cannot overflow 64 bits
    num_nodes *= std::int64_t{cells[d]} + 1;
    if (num_nodes > std::numeric_limits<int>::max())
      throw InputError(fmt::format("a grid of {} x {} x {} cells has more nodes than can be counted ({})", cells[0],
                                   cells[1], cells[2], std::numeric_limits<int>::max()));
  }

  const int nx = cells[0] + 1, ny = cells[1] + 1, nz = cells[2] + 1;
  const Vec3 spacing = (most - least).cwiseQuotient(Vec3(cells[0], cells[1], cells[2]));
  const auto index = [&](int i, int j, int k) { return i + nx * (j + ny * k); };

  PointArray positions(num_nodes, 3);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        positions.row(index(i, j, k)) = (least + Vec3(i, j, k).cwiseProduct(spacing)).transpose();

  std::vector<Hexahedron> hexahedra;
  hexahedra.reserve(std::size_t(cells[0]) * cells[1] * cells[2]);
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        hexahedra.push_back({index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k),
                             index(i, j, k + 1), index(i + 1, j, k + 1), index(i + 1, j + 1, k + 1),
                             index(i, j + 1, k + 1)});
  return HexMesh(std::move(positions), std::move(hexahedra));
}

namespace {

/// Calls visit(first) with the least corner of every part of the grid that extends over one cell in each direction of
/// `extent` and over none in the others.
template <class Visit>
void for_each_part(const std::array<int, 3>& cells, const std::array<int, 3>& extent, const Visit& visit) {
  const auto end = [&](int d) { return cells[d] + 1 - extent[d]; };
  for (int k = 0; k < end(2); ++k)
    for (int j = 0; j < end(1); ++j)
      for (int i = 0; i < end(0); ++i) visit(i + (cells[0] + 1) * (j + (cells[1] + 1) * k));
}

std::array<int, 3> strides(const std::array<int, 3>& cells) {
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
