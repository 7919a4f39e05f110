// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A plane normal . x = offset; above it is the side that the normal points to, and the plane itself.
struct Plane {
  Vec3 normal = Vec3::UnitZ();  ///< of length 1
  double offset = 0;            ///< [m]

  double height(const Vec3& x) const { return normal.dot(x) - offset; }  ///< [m] above the plane
};

/// What a plane cuts out of hexahedra: a flat surface, and the lines in which it meets their faces.
///
/// A hexahedron is divided into `parts` trilinear cells along each direction, and a cell counts as 24 tetrahedra, one
/// between each edge of each face, the mean of the face's corners and the mean of all eight. Where faces are flat, as
/// those of parallelepipeds are, the cut is exact; where they are warped it is off by 1 / parts^2, and neighbours share
/// it without a gap. A plane along a face cuts the hexahedron below it and not the one above.
class PlaneCut {
 public:
  /// x: num_nodes x 3 [m], finite; hexahedra with corners in x; alive: if not empty, one per hexahedron, 0 for those
  /// that do not count; parts: at least 1; tolerance [m]: nodes that are nearer to the plane count as lying in it.
  /// Without it a layer of faces that is off the plane by rounding alone is cut along arbitrary curves. Throws
  /// InputError for corners that x has not, or an `alive` of another size.
  PlaneCut(ConstPoints x, std::span<const Hexahedron> hexahedra, const Plane& plane,
           std::span<const unsigned char> alive = {}, int parts = 1, double tolerance = 0);

  int num_points() const { return static_cast<int>(anchors_.size()); }
  const std::vector<Triangle>& triangles() const { return triangles_; }  ///< counter-clockwise seen from above
  const std::vector<Edge>& inner_lines() const { return inner_lines_; }  ///< at faces between two hexahedra, each once
  const std::vector<Edge>& outline() const { return outline_; }          ///< at faces of one hexahedron only

  /// The area [m^2] of the cut.
  double area() const { return area_; }

  /// points = the values of a nodal field (positions, or any three numbers per node) at the points of the cut. Throws
  /// InputError for fields of other sizes.
  void apply(ConstPoints nodes, Points points) const;

 private:
  /// A fixed combination of the corners of one hexahedron.
  struct Anchor {
    Hexahedron corners;
    std::array<double, kCorners> weight;
  };

  Eigen::Index num_nodes_;
  std::vector<Anchor> anchors_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> inner_lines_, outline_;
  double area_ = 0;
};

/// Where hexahedra lie along a direction of length 1: smallest and largest normal . x [m] of their corners, between
/// which planes cut them; 0 and 0 where there is no hexahedron.
std::pair<double, double> extent_along(const Vec3& normal, ConstPoints x, std::span<const Hexahedron> hexahedra,
                                       std::span<const unsigned char> alive = {});

}  // namespace hexaplast
