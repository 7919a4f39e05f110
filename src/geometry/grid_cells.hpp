// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// A cell of a regular grid, by its place in each direction.
using GridCell = std::array<int, 3>;

/// Some cells of a grid as hexahedra.
struct GridHexahedra {
  std::vector<std::array<int, 3>> nodes;  ///< places of the nodes in the grid, ascending by x, then y, then z
  std::vector<Hexahedron> hexahedra;      ///< in the order of the cells
};

/// num_cells: of the grid in each direction.
GridHexahedra grid_hexahedra(const std::vector<GridCell>& cells, const std::array<int, 3>& num_cells);

/// How hexahedra that are cells of one grid hang together.
struct GridConnection {
  int num_parts = 0;   ///< connected by faces
  int num_hinges = 0;  ///< nodes at which hexahedra meet that are not joined by faces there
};
GridConnection connection_of(const HexMesh& mesh);

}  // namespace hexaplast
