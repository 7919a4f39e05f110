// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// Smallest over the corners of det J / (product of the lengths of its columns): the volume that three edges span,
/// relative to a box of these edges. 1 for a box, 0 where a corner is flat, negative where it is inverted.
double scaled_jacobian(const ElementPoints& x);

/// How large the elements of a mesh are, and how well they are shaped.
struct MeshQuality {
  double min_scaled_jacobian = 1;
  int worst_element = -1;    ///< the first one with that value; -1: no elements
  double shortest_edge = 0;  ///< [m]
  double longest_edge = 0;   ///< [m]
  double volume = 0;         ///< [m^3]
  int num_inverted = 0;      ///< elements with a scaled Jacobian that is not positive
  int num_unused_nodes = 0;  ///< nodes without element
};

MeshQuality quality(const HexMesh& mesh);

/// Scaled Jacobian below which the stiffness of a corner dominates its element.
inline constexpr double kPoorShape = 0.2;

/// One sentence for each thing in a mesh from which results suffer.
std::vector<std::string> check_shapes(const MeshQuality& quality);

}  // namespace hexaplast
