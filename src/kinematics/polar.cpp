// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kinematics/polar.hpp"

#include <Eigen/SVD>
#include <limits>

#include "kinematics/rotation-inl.hpp"

namespace hexaplast {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

SignedSvd signed_svd(const Mat3& F) {
  if (!F.allFinite()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {Mat3::Constant(nan), Vec3::Constant(nan), Mat3::Constant(nan)};
  }
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  SignedSvd out{svd.matrixU(), svd.singularValues(), svd.matrixV()};

  // carry reflections on the smallest stretch, so that U and V are rotations
  for (Mat3* Q : {&out.U, &out.V}) {
    if (Q->determinant() < 0) {
      Q->col(2) *= -1;
      out.d[2] *= -1;
    }
  }
  return out;
}

Polar polar(const SignedSvd& F) { return {F.U * F.V.transpose(), F.V * F.d.asDiagonal() * F.V.transpose()}; }

Polar polar(const Mat3& F) { return polar(signed_svd(F)); }

Vec3 rotation_log(const Mat3& R) {
  const scalar::RotationVector<double> w = scalar::rotation_log(scalar::entries(R));
  return {w.axis_angle[0], w.axis_angle[1], w.axis_angle[2]};
}

Mat3 rotation_exp(const Vec3& w) {
  const scalar::RotationVector<double> vector{{w[0], w[1], w[2]}, w.norm()};
  return Mat3::Identity() + to_eigen(scalar::rotation_expm1(vector, 1.0));
}

}  // namespace hexaplast
