// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/geometry/cage.hpp"

namespace hexaplast {

/// What becomes of fine cells of one coarse cell that are not connected within it.
enum class SeparateParts {
  kShareHexahedron,  ///< they deform together
  kOwnHexahedra      ///< each has a hexahedron of its own in the same place: branches that lie close stay apart
};

/// Which neighbouring cells of the finest grid are connected.
enum class CellsMeet {
  kAtFaces,      ///< all that share a face
  kWhereCrossed  ///< of those that the surface touches only the ones whose common face an edge of the surface crosses
};

/// Hexahedra of a coarse grid around a surface that was found on a finer one.
struct CoarsenedCage {
  HexMesh mesh;
  std::vector<double> fill;  ///< share of matter of each hexahedron (0, 1]: the mean over its fine cells
  int num_doubled = 0;       ///< hexahedra that lie in one place with others
};

/// cage_around on a grid with 2^levels times the cells of `grid` in each direction, made coarse again: a cell of `grid`
/// becomes a hexahedron if one of its fine cells was kept. A fine cell that the surface touches counts `touched_fill`,
/// an enclosed one 1, others 0. Nodes and hexahedra have the order of SOFA's sparse grids with virtual finer levels.
/// Throws InputError as cage_around does, and where levels < 0.
CoarsenedCage coarsened_cage(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads,
                             const CageGrid& grid, int levels, SeparateParts parts, double touched_fill,
                             CellsMeet meet = CellsMeet::kAtFaces);

}  // namespace hexaplast
