// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/base/hexahedron.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast::output {

/// An instrument that holds or touches a body, and its force.
struct Instrument {
  int id = 0;              ///< its number among the instruments of the scene
  Vec3 place;              ///< [m] of the tool
  std::vector<int> nodes;  ///< on which it acts
  PointArray forces;       ///< [N] on them, one row each

  PointArray shape_points = PointArray(0, 3);  ///< [m] of its surface; empty: it has no shape
  std::vector<Triangle> shape_triangles = {};  ///< of these points, counter-clockwise seen from outside

  /// [N] on the body.
  Vec3 force() const { return forces.rows() == 0 ? Vec3::Zero() : Vec3(forces.colwise().sum()); }
};

/// What holds and loads a body at a moment, but for its weight.
struct BoundaryConditions {
  std::vector<unsigned char> fixed;  ///< per node: 1 where all directions are fixed or prescribed; empty: none
  PointArray loads =
      PointArray(0, 3);  ///< [N] external forces, those of instruments included: num_nodes x 3; empty: none
  std::vector<Instrument> instruments;
};

}  // namespace hexaplast::output
