// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// Axis-aligned box [min, max] [m] cut into cells[0] x cells[1] x cells[2] hexahedra.
/// Node (i, j, k) has the index i + nx (j + ny k), elements are numbered alike (x fastest): the order of SOFA's
/// RegularGridTopology. Throws InputError for a cell count < 1, an empty box, or more nodes than an int can count.
HexMesh regular_grid(std::array<int, 3> cells, const Vec3& min, const Vec3& max);

/// The nodes of such a grid from `min` on, in the same order; directions without cells (cells[d] = 0) have one node.
/// The faces and edges below are then those that are left of it: of a flat grid its cells, of a line its pieces. All
/// three throw InputError for a negative count, and for more nodes than an int can count.
PointArray grid_points(std::array<int, 3> cells, const Vec3& min, const Vec3& spacing);

/// The faces of all cells of such a grid, each once, in the order of SOFA's grids: those normal to z, then y, then x,
/// each from its lower corner, with normals along +z, -y and +x.
std::vector<Quad> grid_quads(std::array<int, 3> cells);

/// Its edges, each once: those along x, then y, then z.
std::vector<Edge> grid_edges(std::array<int, 3> cells);

}  // namespace hexaplast
