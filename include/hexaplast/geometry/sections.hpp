// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// The two end sections of a body along the longest axis of its initial bounding box: how bars are measured.
struct EndSections {
  int axis = 0;                          ///< 0, 1, 2: the longest direction (the first one of equals)
  double length = 0;                     ///< [m] initial distance of the two sections
  std::vector<int> min;                  ///< nodes with the smallest coordinate along the axis
  std::vector<int> max;                  ///< nodes with the largest one
  std::vector<std::vector<int>> layers;  ///< all nodes, grouped by equal initial coordinate along the axis, ascending
};

EndSections end_sections(const HexMesh& mesh);

/// What follows throws InputError for positions of other than num_nodes rows.

/// (mean axial position of `max` - mean of `min`) / length - 1.
double elongation(const EndSections& ends, ConstPoints at);

/// Angle [rad, in (-pi, pi]] by which a section of nodes has turned about the axis: the rotation that best fits
/// (least squares, about the section's own centre) the initial section to the present one.
double section_angle(const HexMesh& mesh, const std::vector<int>& section, int axis, ConstPoints at);

/// Twist between the two end sections [rad], following full turns: the change of angle is added up over the layers of
/// nodes with equal initial axial coordinate, each step taken in (-pi, pi].
double twist(const HexMesh& mesh, const EndSections& ends, ConstPoints at);

/// Pull [N] of nodal forces (num_nodes x 3) along the body's longest axis, positive where they lengthen it: what they
/// add up to on the nodes beyond the middle of its initial length, or against it on those before the middle, whichever
/// is greater in size. A bar that is pulled by F at one end, the other being held, and one that is pulled by F at both
/// ends have the same pull F. The elastic forces of a body at rest, taken negatively, have it too: it is the axial
/// force that the middle carries.
double axial_pull(const HexMesh& mesh, const EndSections& ends, ConstPoints forces);

}  // namespace hexaplast
