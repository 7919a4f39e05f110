// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"
#include "hexaplast/material/material.hpp"
#include "kinematics/polar.hpp"

/// The frames of SOFA's elements: three rows.
namespace hexaplast {

/// The first axis along the first column, the second in the plane of the first two.
inline Mat3 edge_frame(const Mat3& edges) {
  const Vec3 x = edges.col(0).normalized(), z = x.cross(edges.col(1)).normalized();
  return (Mat3() << x, z.cross(x), z).finished().transpose();
}

/// Also of an inverted A, whose orthogonal factor is a reflection.
inline Mat3 orthogonal_factor(const Mat3& A) {
  const auto [U, d, V] = signed_svd(A);
  return U * Vec3(1, 1, d[2] < 0 ? -1 : 1).asDiagonal() * V.transpose();
}

/// K_ab of strains that are constant: volume [ mu (g_a.g_b I + g_b g_a^T) + lambda g_a g_b^T ].
inline Mat3 stiffness_block(const Vec3& g_a, const Vec3& g_b, double volume, Lame lame) {
  return volume *
         (lame.mu * (g_a.dot(g_b) * Mat3::Identity() + g_b * g_a.transpose()) + lame.lambda * g_a * g_b.transpose());
}

}  // namespace hexaplast
