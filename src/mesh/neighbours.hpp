// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// HexMesh::neighbours of any hexahedra.
std::vector<std::array<int, 6>> neighbours_across_faces(std::span<const Hexahedron> hexahedra);

/// The same of what is left of a mesh.
/// alive: if not empty, one entry per element, 0 for those that are gone; these have no neighbours and are none.
std::vector<std::array<int, 6>> neighbours_across_faces(const HexMesh& mesh, std::span<const unsigned char> alive);

/// One of HexMesh::boundary_faces, and the element that has it.
struct BoundaryFace {
  Quad nodes;
  int element;
};

/// In the order of HexMesh::boundary_faces.
std::vector<BoundaryFace> boundary_of(const HexMesh& mesh, std::span<const unsigned char> alive);

}  // namespace hexaplast
