// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

// A table of numbers at namespace scope that device code may index with a variable.
#ifdef __CUDA_ARCH__
#define HEXAPLAST_TABLE __attribute__((device)) constexpr
#else
#define HEXAPLAST_TABLE inline constexpr
#endif

namespace hexaplast {

/// The trilinear hexahedron: corner order of SOFA, VTK (cell 12) and Gmsh (type 5), and what follows from it.
///
///        7--------6
///       /|       /|        corner a lies at s = kCornerSign[a] in the reference cube [-1, 1]^3
///      4--------5 |
///      | 3------|-2        z  y
///      |/       |/         | /
///      0--------1          o-- x
inline constexpr int kCorners = 8;

HEXAPLAST_TABLE std::array<std::array<int, 3>, kCorners> kCornerSign{
    {{-1, -1, -1}, {+1, -1, -1}, {+1, +1, -1}, {-1, +1, -1}, {-1, -1, +1}, {+1, -1, +1}, {+1, +1, +1}, {-1, +1, +1}}};

/// kEdgeNeighbour[a][d]: the corner that differs from corner a in direction d only.
HEXAPLAST_TABLE std::array<std::array<int, 3>, kCorners> kEdgeNeighbour{
    {{1, 3, 4}, {0, 2, 5}, {3, 1, 6}, {2, 0, 7}, {5, 7, 0}, {4, 6, 1}, {7, 5, 2}, {6, 4, 3}}};

/// The six faces, corners counter-clockwise seen from outside.
inline constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

/// The twelve edges.
inline constexpr std::array<std::array<int, 2>, 12> kEdges{
    {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};

/// Symmetric tensors, one per corner: xx, yy, zz, yz, zx, xy of each.
using CornerSymmetric = std::array<std::array<double, 6>, kCorners>;

/// Corner indices of one hexahedron, and of cells of lower dimension.
using Hexahedron = std::array<int, kCorners>;
using Quad = std::array<int, 4>;
using Triangle = std::array<int, 3>;
using Edge = std::array<int, 2>;

/// Nodes of a face of a hexahedron; face: one of kFaces.
inline Quad face_of(const Hexahedron& nodes, const Quad& face) {
  return {nodes[face[0]], nodes[face[1]], nodes[face[2]], nodes[face[3]]};
}

}  // namespace hexaplast
