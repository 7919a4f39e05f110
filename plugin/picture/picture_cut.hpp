// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/geometry/plane_cut.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "picture/surface.hpp"

namespace hexaplast::output {

inline constexpr int kCutParts = 4;              // of a hexahedron along each direction, for its cut and what meets it
inline constexpr double kUnseenFraction = 1e-4;  // of a body's length: a tenth of a pixel of a picture that it fills

/// Where a body is cut through.
struct CutFace {
  std::vector<Eigen::Vector3f> points;  ///< [m]
  std::vector<float> values;
  std::vector<Triangle> triangles;
  std::vector<Edge> inner_lines, outline;
};

/// What a plane cuts out of a body, as far as a picture shows it. values: one per node, in the first column.
inline CutFace cut_face(const HexMesh& mesh, ConstPoints positions, const PointArray& values, const Plane& plane,
                        std::span<const unsigned char> alive) {
  const Vec3 extent = (mesh.positions().colwise().maxCoeff() - mesh.positions().colwise().minCoeff()).transpose();
  const PlaneCut cut(positions, mesh.hexahedra(), plane, alive, kCutParts, kUnseenFraction * extent.maxCoeff());
  PointArray points(cut.num_points(), 3), blended(cut.num_points(), 3);
  cut.apply(positions, points);
  cut.apply(values, blended);
  CutFace face{single(points), {}, cut.triangles(), cut.inner_lines(), cut.outline()};
  for (Eigen::Index n = 0; n < points.rows(); ++n) face.values.push_back(static_cast<float>(blended(n, 0)));
  return face;
}

}  // namespace hexaplast::output
