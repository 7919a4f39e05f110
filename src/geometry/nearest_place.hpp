// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <limits>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

using CornerWeights = Eigen::Matrix<double, kCorners, 1>;

/// N_a at s, in reference coordinates.
CornerWeights shape_functions(const Vec3& s);

/// The place of a hexahedron that is nearest to a point.
struct HexahedronPlace {
  Vec3 s = Vec3::Zero();  ///< in [-1, 1]^3
  double distance = std::numeric_limits<double>::infinity();
};

/// x: its corners; size [m]: about its own, which says what is exact.
HexahedronPlace nearest_place(const ElementPoints& x, const Vec3& p, double size);

/// w with sum_a w_a x_a = p, sum_a w_a = 1: the shape functions at s, continued linearly to p. Where that leads
/// farther than `farthest` in reference coordinates (out of a flat hexahedron), those at s.
CornerWeights weights_beyond(const ElementPoints& x, const Vec3& s, const Vec3& p,
                             double farthest = std::numeric_limits<double>::infinity());

/// The place of a triangle that is nearest to a point.
struct TrianglePlace {
  static constexpr int kFace = 6;

  Vec3 place = Vec3::Zero();
  double squared = std::numeric_limits<double>::infinity();  ///< distance [m^2]
  int feature = kFace;                                       ///< corner 0 1 2, edge behind it 3 4 5, or the face
};

TrianglePlace nearest_place(const std::array<Vec3, 3>& corners, const Vec3& p);

}  // namespace hexaplast
