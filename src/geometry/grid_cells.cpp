// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/grid_cells.hpp"

#include <algorithm>

#include "base/disjoint_sets.hpp"

namespace hexaplast {
namespace {

/// Two cells of a grid that share four nodes share a face.
bool share_a_face(const Hexahedron& a, const Hexahedron& b) {
  return std::ranges::count_if(a, [&](int node) { return std::ranges::count(b, node) > 0; }) == 4;
}

}  // namespace

GridHexahedra grid_hexahedra(const std::vector<GridCell>& cells, const std::array<int, 3>& num_cells) {
  const std::int64_t ny = std::int64_t{num_cells[1]} + 1, nz = std::int64_t{num_cells[2]} + 1;
  const auto key = [&](const GridCell& c, int corner) {
    std::array<std::int64_t, 3> at;
    for (int d = 0; d < 3; ++d) at[d] = c[d] + (kCornerSign[corner][d] > 0 ? 1 : 0);
    return (at[0] * ny + at[1]) * nz + at[2];
  };
  std::vector<std::int64_t> keys;
  keys.reserve(kCorners * cells.size());
  for (const GridCell& c : cells)
    for (int a = 0; a < kCorners; ++a) keys.push_back(key(c, a));
  std::ranges::sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

  GridHexahedra found;
  found.nodes.reserve(keys.size());
  for (const std::int64_t at : keys)
    found.nodes.push_back(
        {static_cast<int>(at / (ny * nz)), static_cast<int>(at / nz % ny), static_cast<int>(at % nz)});
  found.hexahedra.reserve(cells.size());
  for (const GridCell& c : cells) {
    Hexahedron& corners = found.hexahedra.emplace_back();
    for (int a = 0; a < kCorners; ++a)
      corners[a] = static_cast<int>(std::ranges::lower_bound(keys, key(c, a)) - keys.begin());
  }
  return found;
}

GridConnection connection_of(const HexMesh& mesh) {
  GridConnection found;
  DisjointSets parts(mesh.num_elements());
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    const std::span<const HexMesh::Incidence> around = mesh.incident(n);
    const int count = static_cast<int>(around.size());
    DisjointSets here(count);
    for (int i = 0; i < count; ++i)
      for (int j = i + 1; j < count; ++j) {
        const int a = around[i].element, b = around[j].element;
        if (!share_a_face(mesh.hexahedra()[a], mesh.hexahedra()[b])) continue;
        parts.join(a, b);
        here.join(i, j);
      }
    found.num_hinges += here.num_sets() > 1;
  }
  found.num_parts = parts.num_sets();
  return found;
}

}  // namespace hexaplast
