// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// Where the hexahedra of an initial mesh lie on lattices, along which coarse cells of twice the edge length cover up
/// to 2 x 2 x 2 of them, and where the cells of each coarser mesh do. Found once: it holds for the same hexahedra when
/// their nodes have split (coarsen).
///
/// Neighbours across faces lie a step apart on the lattice of a chart. What nodes have in common that lie at one place
/// of it, or are one node at several places, is a point: a mesh that is not split has a node at each.
struct Charts {
  explicit Charts(const HexMesh& initial);

  /// A hexahedron in its cell.
  struct Element {
    int cell;
    std::array<unsigned char, kCorners> place;  ///< of its corners in it: x + 3 y + 9 z, each 0, 1 or 2 half edges
    unsigned char slot;                         ///< corner of the cell at which it lies
    unsigned char centre;                       ///< its corner in the middle of the cell
  };
  struct Level {
    std::vector<Element> elements;
    std::vector<Hexahedron> points;  ///< of the elements' corners, below num_points
    int num_points = 0;
    std::vector<Hexahedron> cells;  ///< in the order of their first element; corners: coarse points
    int num_coarse_points = 0;
  };

  /// From fine to coarse; the cells of each are the elements of the next. They end where coarsening gains little: fewer
  /// elements than a direct treatment deserves, elements that form no lattice, a cell that meets itself around a loop,
  /// or cells that do not meet where the mesh is connected.
  std::vector<Level> levels;
};

/// Fine elements per cell: less, and coarsening gains nothing.
inline constexpr double kMinGain = 2.5;

/// Corners of a cell between which a place in it lies: one where it is a corner, all where it is the middle.
struct CornersAround {
  int count = 0;
  std::array<unsigned char, kCorners> corner = {};  // ascending
};
inline constexpr std::array<CornersAround, 27> kCornersAround = [] {
  std::array<CornersAround, 27> around;
  for (int place = 0; place < 27; ++place)
    for (int a = 0; a < kCorners; ++a) {
      const std::array<int, 3> at = {place % 3, place / 3 % 3, place / 9};
      bool is_around = true;
      for (int d = 0; d < 3; ++d) is_around = is_around && (at[d] == 1 || at[d] == kCornerSign[a][d] + 1);
      if (is_around) around[place].corner[around[place].count++] = static_cast<unsigned char>(a);
    }
  return around;
}();

}  // namespace hexaplast
