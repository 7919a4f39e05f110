// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/geometry/plane_cut.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "picture/regions.hpp"
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

/// The same of each of some regions by itself, with its number in place of values where colours stand for regions.
inline CutFace cut_face(const HexMesh& mesh, ConstPoints positions, const PointArray& values, const Plane& plane,
                        std::span<const unsigned char> alive, const Regions& regions, std::span<const int> numbers,
                        bool shows_numbers) {
  CutFace all;
  for (const int number : numbers) {
    const CutFace one = cut_face(mesh, positions, values, plane, regions.alive_in(number, alive));
    const auto first = static_cast<int>(all.points.size());
    const auto append = [&]<class Item>(const std::vector<Item>& from, std::vector<Item>& to) {
      for (Item item : from) {
        for (int& point : item) point += first;
        to.push_back(item);
      }
    };
    append(one.triangles, all.triangles);
    append(one.inner_lines, all.inner_lines);
    append(one.outline, all.outline);
    all.points.insert(all.points.end(), one.points.begin(), one.points.end());
    for (const float value : one.values) all.values.push_back(shows_numbers ? static_cast<float>(number) : value);
  }
  return all;
}

}  // namespace hexaplast::output
