// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "base/require.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Which part of a cell must lie inside for it to count.
enum class Inside {
  kAllCorners,
  kCentre  ///< the mean of the corners
};

/// Box of any direction, as SOFA's BoxROI describes it: the rectangle with three consecutive corners p0, p1, p2 [m],
/// thickened by `depth` [m], half of it to either side.
struct OrientedBox {
  Vec3 p0, p1, p2;
  double depth;

  /// Points on the surface are inside, up to rounding of the projections.
  bool contains(const Vec3& point) const;
};

/// The solid angle of a triangle [sr] as seen from the origin, positive from behind (van Oosterom and Strackee 1983).
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// What a closed surface of triangles encloses.
class EnclosedSpace {
 public:
  /// points: num_points x 3 [m], of which several may lie at one place. Throws InputError for a corner that they have
  /// not, and where the surface is open or not oriented: each of its edges must occur as often in one direction
  /// as in the other.
  EnclosedSpace(ConstPoints points, std::span<const Triangle> triangles);

  /// Whether the surface winds around a point. On the surface itself either may be.
  bool contains(const Vec3& point) const;

  const Eigen::AlignedBox3d& box() const { return box_; }  ///< around the surface

 private:
  std::vector<std::array<Vec3, 3>> triangles_;
  Eigen::AlignedBox3d box_;
};

/// Cells (edges, triangles, quads, hexahedra: their corners are rows of x) that lie inside a region, in ascending
/// order. x: num_nodes x 3 [m]; region(point) says whether a point is inside. Throws InputError for a corner that x has
/// not.
template <std::size_t N, class Region>
std::vector<int> cells_inside(ConstPoints x, std::span<const std::array<int, N>> cells, Inside rule,
                              const Region& region) {
  std::vector<int> inside;
  for (std::size_t e = 0; e < cells.size(); ++e) {
    const std::array<int, N>& corners = cells[e];
    require_nodes("cells_inside", corners, x.rows());
    Vec3 centre = Vec3::Zero();
    for (const int node : corners) centre += x.row(node).transpose() / static_cast<double>(N);
    const bool counts = rule == Inside::kCentre ? region(centre) : std::ranges::all_of(corners, [&](int node) {
      return region(Vec3(x.row(node).transpose()));
    });
    if (counts) inside.push_back(static_cast<int>(e));
  }
  return inside;
}

}  // namespace hexaplast
