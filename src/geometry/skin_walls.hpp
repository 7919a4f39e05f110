// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/geometry/cut_surface.hpp"

namespace hexaplast {

/// An embedded surface that is divided where a cut passes.
struct DividedSkin {
  /// An edge of a lip, as the skin runs along it, and the copies of wall nodes that its ends are joined to. Each second
  /// one lies across the one before, and runs the other way.
  struct Lip {
    int from, to;
    int copy_from, copy_to;  ///< -1: the cut ends here
  };

  std::vector<Vec3> points;
  std::vector<int> hexahedron;      ///< of a point
  std::vector<Triangle> triangles;  ///< before they are divided along the cut
  std::vector<Quad> faces;          ///< triangles have their last corner twice
  std::vector<Lip> lips;

  int add_point(const Vec3& place, int of_hexahedron) {
    points.push_back(place);
    hexahedron.push_back(of_hexahedron);
    return static_cast<int>(points.size()) - 1;
  }
};

/// Closes a skin with the walls of the cut within it, and strips from its lips to them, behind its other faces. The
/// skin is of num_hexahedra hexahedra from the first one on.
void add_walls(const CutWalls& walls, int first_hexahedron, int num_hexahedra, DividedSkin& skin);

}  // namespace hexaplast
