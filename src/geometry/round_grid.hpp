// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A grid of nodes in a cylinder or a ball: each square (or cube) of nodes around the middle becomes a circle (or a
/// sphere), by moving its nodes along their radius. The nodes and their order are those of SOFA's CylinderGridTopology
/// and SphereGridTopology; the hexahedra are those of regular_grid.
struct RoundGrid {
  std::array<int, 3> cells = {1, 1, 1};  ///< at least 1 each, the third along the axis
  Vec3 centre = Vec3::Zero();            ///< [m] of a ball; where the axis of a cylinder begins
  Vec3 axis = Vec3::UnitZ();             ///< not 0
  double radius = 1;                     ///< [m]
  std::optional<double> length = {};     ///< [m] of a cylinder; none: a ball
};
PointArray grid_points(const RoundGrid& grid);

}  // namespace hexaplast
