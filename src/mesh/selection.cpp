// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/selection.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

bool OrientedBox::contains(const Vec3& point) const {
  const Vec3 along = p1 - p0, across = p2 - p1;
  const Vec3 normal = along.cross(across).normalized();
  const Vec3 from_corner = point - p0;
  const auto lies_between_ends = [&](const Vec3& side) {
    const double fraction = from_corner.dot(side) / side.squaredNorm();
    return fraction >= 0 && fraction <= 1;
  };
  return lies_between_ends(along) && lies_between_ends(across) && std::abs(from_corner.dot(normal)) <= depth / 2;
}

EnclosedSpace::EnclosedSpace(ConstPoints points, std::span<const Triangle> triangles) {
  std::map<std::array<double, 3>, int> first_at;  // of several points at one place
  const auto representative = [&](int n) {
    return first_at.try_emplace({points(n, 0), points(n, 1), points(n, 2)}, n).first->second;
  };
  std::map<std::pair<int, int>, int> count;  // of each edge, by its direction
  for (const Triangle& triangle : triangles) {
    require_nodes("EnclosedSpace", triangle, points.rows());
    std::array<Vec3, 3>& corners = triangles_.emplace_back();
    for (std::size_t a = 0; a < 3; ++a) {
      corners[a] = points.row(triangle[a]).transpose();
      box_.extend(corners[a]);
      ++count[{representative(triangle[a]), representative(triangle[(a + 1) % 3])}];
    }
  }
  for (const auto& [edge, times] : count) {
    const auto opposite = count.find({edge.second, edge.first});
    if (opposite == count.end() || opposite->second != times)
      throw InputError(
          fmt::format("the surface is open or not oriented at the edge from point {} to point {}: each "
                      "edge must occur as often in one direction as in the other",
                      edge.first, edge.second));
  }
}

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

bool EnclosedSpace::contains(const Vec3& point) const {
  if (!box_.contains(point)) return false;
  double angle = 0;
  for (const auto& [a, b, c] : triangles_) angle += solid_angle(a - point, b - point, c - point);
  return std::abs(angle) > 2 * std::numbers::pi;  // 4 pi inside, none outside
}

}  // namespace hexaplast
