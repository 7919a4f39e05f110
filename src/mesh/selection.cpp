// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/selection.hpp"

#include <algorithm>

namespace hexaplast {

std::vector<int> hexahedra_inside(ConstPoints x, std::span<const Hexahedron> hexahedra, Inside rule,
                                  const std::function<bool(const Vec3&)>& region) {
  std::vector<int> inside;
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    const Hexahedron& corners = hexahedra[e];
    Vec3 centre = Vec3::Zero();
    for (const int node : corners) centre += x.row(node).transpose() / kCorners;
    const bool counts =
        rule == Inside::kCentre
            ? region(centre)
            : std::all_of(corners.begin(), corners.end(), [&](int node) { return region(x.row(node).transpose()); });
    if (counts) inside.push_back(static_cast<int>(e));
  }
  return inside;
}

}  // namespace hexaplast
