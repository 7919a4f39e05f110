// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/geometry/plane_cut.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::output {

inline constexpr int kCutParts = 4;              // of a hexahedron along each direction, for its cut and what meets it
inline constexpr double kUnseenFraction = 1e-4;  // of a body's length: a tenth of a pixel of a picture that it fills

/// What a plane cuts out of a body, as far as a picture shows it.
inline PlaneCut picture_cut(const HexMesh& mesh, ConstPoints positions, const Plane& plane,
                            std::span<const unsigned char> alive) {
  const Vec3 extent = (mesh.positions().colwise().maxCoeff() - mesh.positions().colwise().minCoeff()).transpose();
  return {positions, mesh.hexahedra(), plane, alive, kCutParts, kUnseenFraction * extent.maxCoeff()};
}

}  // namespace hexaplast::output
