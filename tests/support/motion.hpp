// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

#include "hexaplast/geometry/sections.hpp"
#include "kinematics/polar.hpp"

namespace hexaplast::support {

/// The initial positions of a bar along z, stretched by `stretch` at constant volume and twisted by `angle` [rad] from
/// end to end, about its axis and its middle.
inline PointArray stretched_and_twisted(const HexMesh& mesh, double stretch, double angle) {
  const EndSections ends = end_sections(mesh);
  const Vec3 middle = mesh.positions().colwise().mean().transpose();
  const double narrowed = 1 / std::sqrt(stretch);
  PointArray x = mesh.positions();
  for (int n = 0; n < x.rows(); ++n) {
    const Vec3 arm = x.row(n).transpose() - middle;
    const Mat3 turn = rotation_exp(Vec3(0, 0, angle * arm[2] / ends.length));
    x.row(n) = (turn * Vec3(narrowed * arm[0], narrowed * arm[1], stretch * arm[2])).transpose();
  }
  return x;
}

}  // namespace hexaplast::support
