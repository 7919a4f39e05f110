// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/geometry/voxels.hpp"

namespace hexaplast {

/// A closed surface around the hexahedra of one label.
struct VoxelSurface {
  PointArray positions;     ///< in the unit of the mesh
  std::vector<Quad> quads;  ///< counter-clockwise seen from outside
};

/// The faces between the hexahedra of a label and all others, smoothed: steps vanish, and volumes stay nearly as they
/// are (Taubin's two factors). No vertex moves by more than half a cell in any direction of the grid. Hexahedra that
/// share an edge or a node alone have vertices of their own there, so that two faces meet at each edge; unless both
/// ends of the edge are connected around it.
/// cell: column d is the edge of a hexahedron in direction d of the grid. Throws InputError for a label that no
/// hexahedron has.
VoxelSurface surface_of_label(const VoxelMesh& voxels, int label, const Mat3& cell);

}  // namespace hexaplast
