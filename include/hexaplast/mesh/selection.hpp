// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "hexaplast/base/hexahedron.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Which part of a hexahedron must lie inside for it to count.
enum class Inside {
  kAllCorners,
  kCentre  ///< the mean of the corners
};

/// Hexahedra that lie inside a region, in ascending order. x: num_nodes x 3 [m]; the corners must be rows of x.
std::vector<int> hexahedra_inside(ConstPoints x, std::span<const Hexahedron> hexahedra, Inside rule,
                                  const std::function<bool(const Vec3&)>& region);

}  // namespace hexaplast
