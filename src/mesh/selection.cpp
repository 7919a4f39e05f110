// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/selection.hpp"

#include <cmath>

namespace hexaplast {

bool OrientedBox::contains(const Vec3& point) const {
  const Vec3 along = p1 - p0, across = p2 - p1;
  const Vec3 normal = along.cross(across).normalized();
  const Vec3 from_corner = point - p0;
  const auto lies_between_ends = [&](const Vec3& side) {
    const double share = from_corner.dot(side) / side.squaredNorm();
    return share >= 0 && share <= 1;
  };
  return lies_between_ends(along) && lies_between_ends(across) && std::abs(from_corner.dot(normal)) <= depth / 2;
}

}  // namespace hexaplast
