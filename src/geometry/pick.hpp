// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A half line: from a place along a direction, whose length does not matter but is not zero.
struct Ray {
  Vec3 origin = Vec3::Zero();  ///< [m]
  Vec3 direction = {0.0, 0.0, 1.0};
};

/// Where a ray first meets a surface.
struct Hit {
  int face = 0;               ///< in the order of the faces
  double distance = 0;        ///< [m] from the origin of the ray
  Vec3 place = Vec3::Zero();  ///< [m]
};

/// The first of the faces that a ray meets, from either side; none where it passes all of them by. A quad counts as the
/// two triangles on either side of its first diagonal; what is seen edge-on is not met. Of faces met at the same
/// distance the first one counts. x: num_points x 3 [m], corners of the faces in it: InputError otherwise.
std::optional<Hit> first_hit(const Ray& ray, ConstPoints x, std::span<const Triangle> triangles);
std::optional<Hit> first_hit(const Ray& ray, ConstPoints x, std::span<const Quad> quads);

/// Those of `candidates` within `radius` [m] of a place, and in any case the nearest `min_count` of them (all where
/// there are fewer), ascending. Of equally near ones the first in the list count. Throws InputError for a candidate
/// that is no row of x.
std::vector<int> nearest_nodes(ConstPoints x, std::span<const int> candidates, const Vec3& place, double radius,
                               int min_count);

}  // namespace hexaplast
