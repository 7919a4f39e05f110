// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// F = U diag(d) V^T with U and V rotations and d in descending magnitude; d[2] < 0 exactly when det F < 0.  theory.md
/// eq. 5
struct SignedSvd {
  Mat3 U;
  Vec3 d;
  Mat3 V;
};
SignedSvd signed_svd(const Mat3& F);

/// F = R S, R a rotation (det R = +1 for every F, reflections and singular ones included), S symmetric.       theory.md
/// eq. 6
struct Polar {
  Mat3 R;
  Mat3 S;
};
Polar polar(const Mat3& F);
Polar polar(const SignedSvd& F);

/// The rotation R that minimises sum_i |R from_i - to_i|^2; both about their own means.
Mat3 fit_rotation(const ElementPoints& from, const ElementPoints& to);

/// Rotation vector (axis times angle, angle in [0, pi]) of a rotation matrix.
Vec3 rotation_log(const Mat3& R);

}  // namespace hexaplast
