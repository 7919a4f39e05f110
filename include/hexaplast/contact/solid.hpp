// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// How far a point is from the surface of a solid, and where to: negative inside.
struct SignedDistance {
  double value = 0;             ///< [m]
  Vec3 normal = Vec3::UnitZ();  ///< of length 1: the direction in which the distance grows
};

/// A rigid shape, in its own frame, with its exact signed distance. Inside, the distance is that to the nearest place
/// of the surface, however deep.
class Solid {
 public:
  /// Around the origin. Throw InputError for a size that is not positive and finite. [m]
  static Solid sphere(double radius);
  static Solid capsule(double radius, double length);   ///< length: of the axis, along z, without the two caps
  static Solid cylinder(double radius, double length);  ///< along z
  static Solid box(const Vec3& size);                   ///< edges along x, y, z

  /// The inside of a closed surface, of one or several parts; the nodes of a triangle run counter-clockwise seen from
  /// outside. Throws InputError, with the first edge or triangle concerned, for a surface that is open, whose triangles
  /// do not agree which side is outside, that is inside out, or has a triangle without area or a node that is not
  /// there.
  static Solid closed_surface(const PointArray& positions, const std::vector<Triangle>& triangles);

  SignedDistance distance(const Vec3& point) const;

  /// [m] Half of the smallest thickness: what it can slip through between points on a surface. That of a closed surface
  /// is measured inwards from the middle of each triangle, and from places on its edges.
  double smallest_radius() const;

  /// [m] A sphere around the origin of this radius holds it.
  double reach() const;

  class Shape;

 private:
  explicit Solid(std::shared_ptr<const Shape> shape) : shape_(std::move(shape)) {}
  std::shared_ptr<const Shape> shape_;
};

}  // namespace hexaplast
