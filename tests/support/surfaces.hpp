// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "hexaplast/geometry/quad_surface.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "support/shapes.hpp"

namespace hexaplast::support {

/// The open surface place(i / cells_i, j / cells_j), its outer side on the left of i x j.
inline QuadSurface patch(int cells_i, int cells_j, const std::function<Vec3(double, double)>& place) {
  PointArray x((cells_i + 1) * (cells_j + 1), 3);
  const auto vertex = [&](int i, int j) { return j * (cells_i + 1) + i; };
  for (int j = 0; j <= cells_j; ++j)
    for (int i = 0; i <= cells_i; ++i)
      x.row(vertex(i, j)) = place(static_cast<double>(i) / cells_i, static_cast<double>(j) / cells_j).transpose();
  std::vector<Quad> quads;
  for (int j = 0; j < cells_j; ++j)
    for (int i = 0; i < cells_i; ++i)
      quads.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
  return QuadSurface(x, quads);
}

/// The lateral surface of a prism of `around` sides about z, its corners on the cylinder, normals outward.
inline QuadSurface prism(int around, int along, double radius, double length) {
  PointArray x(around * (along + 1), 3);
  std::vector<Quad> quads;
  const auto vertex = [&](int i, int k) { return k * around + i % around; };
  for (int k = 0; k <= along; ++k)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      x.row(vertex(i, k)) << radius * std::cos(angle), radius * std::sin(angle), length * k / along;
      if (k < along) quads.push_back({vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1), vertex(i, k + 1)});
    }
  return QuadSurface(x, quads);
}

/// The closed surface of a block of cubes, every vertex moved to place(vertex).
inline QuadSurface box(std::array<int, 3> cells, const std::function<Vec3(const Vec3&)>& place) {
  const HexMesh mesh = block(cells, 1);
  std::map<int, int> number;
  std::vector<Quad> quads = mesh.boundary_faces();
  for (Quad& quad : quads)
    for (int& n : quad) n = number.try_emplace(n, static_cast<int>(number.size())).first->second;
  PointArray x(static_cast<Eigen::Index>(number.size()), 3);
  for (const auto& [node, vertex] : number) x.row(vertex) = place(mesh.positions().row(node).transpose()).transpose();
  return QuadSurface(x, quads);
}

/// A sphere about the origin of 6 n^2 quads: the cube [-1, 1]^3 with its faces cut at equal angles, blown up.
inline QuadSurface sphere(int n, double radius) {
  return box({n, n, n}, [&](const Vec3& p) {
    const Vec3 s = (2 * p / n).array() - 1;
    return Vec3(radius * (std::numbers::pi / 4 * s.array()).tan().matrix().normalized());
  });
}

}  // namespace hexaplast::support
