// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hexaplast/geometry/cage.hpp"

namespace hexaplast {

/// What becomes of fine cells of one coarse cell that are not connected within it.
enum class SeparateParts {
  kShareHexahedron,  ///< they deform together
  kOwnHexahedra      ///< each has a hexahedron of its own in the same place: branches that lie close stay apart, unless
                     ///< they join at all eight corners
};

/// Which neighbouring cells of the finest grid are connected.
enum class CellsMeet {
  kAtFaces,      ///< all that share a face
  kWhereCrossed  ///< of those that the surface touches only the ones whose common face an edge of the surface crosses
};

/// Hexahedra of a coarse grid around a surface that was found on a finer one.
struct CoarsenedCage {
  HexMesh mesh;
  std::vector<double> fill;  ///< of each hexahedron: the mean over its fine cells
  int num_doubled = 0;       ///< hexahedra that lie in one place with others
};

/// cage_around on a grid with 2^levels times the cells of `grid` in each direction, made coarse again: a cell of `grid`
/// becomes a hexahedron if one of its fine cells was kept. A fine cell that the surface touches counts `touched_fill`,
/// an enclosed one 1, others 0. Nodes and hexahedra have the order of SOFA's sparse grids with virtual finer levels.
/// Throws InputError as cage_around does, and where levels < 0.
CoarsenedCage coarsened_cage(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads,
                             const CageGrid& grid, int levels, SeparateParts parts, double touched_fill,
                             CellsMeet meet = CellsMeet::kAtFaces);

/// A grid with 2^levels times the cells of `grid` in each direction. Throws InputError where levels < 0 or the cells
/// are too many.
CageGrid finer(CageGrid grid, int levels);

/// The edges of faces of a surface: where they cross a common face, touched cells are connected.
struct CageCrossings {
  ConstPoints x;
  std::span<const Triangle> triangles;
  std::span<const Quad> quads;
};

/// A cage on `fine_grid`, which is finer(grid, levels), made coarse again. fill: of each of its hexahedra.
CoarsenedCage coarsened_cage(const Cage& fine, const CageGrid& fine_grid, std::span<const double> fill, int levels,
                             SeparateParts parts, const std::optional<CageCrossings>& crossings);

}  // namespace hexaplast
