// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "hexaplast/body.hpp"
#include "hexaplast/geometry/sections.hpp"
#include "support/materials.hpp"
#include "support/shapes.hpp"

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

/// A bar that flows while it is stretched and twisted by these, up to two thirds of the steps, and then held.
struct HeldTwist {
  double stretch, angle;
  int steps;
  double dt = kStep;

  PointArray at(const HexMesh& mesh, int step) const {
    const double fraction = std::min(1.0, 1.5 * step / steps);
    return stretched_and_twisted(mesh, 1 + fraction * (stretch - 1), fraction * angle);
  }
  void flow(Body& body) const {
    for (int step = 1; step <= steps; ++step) body.flow(at(body.mesh(), step), dt);
  }
};

}  // namespace hexaplast::support
