// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kinematics/polar.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

namespace hexaplast {

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
  // through the quaternion: accurate for the smallest angles and at pi alike
  const Eigen::Quaterniond q(R);
  const double sine = q.vec().norm();
  if (sine == 0) return Vec3::Zero();
  const double angle = 2 * std::atan2(sine, std::abs(q.w()));
  return std::copysign(angle / sine, q.w()) * q.vec();
}

Mat3 rotation_exp(const Vec3& w) {
  const double angle = w.norm();
  if (angle == 0) return Mat3::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Mat3 rotation_power(const Mat3& R, double power) { return rotation_exp(power * rotation_log(R)); }

}  // namespace hexaplast
