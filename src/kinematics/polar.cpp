// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_ONE_NUMBER
#include "kinematics/polar.hpp"

#include "base/svd-inl.hpp"
#include "base/tensors-inl.hpp"
#include "kinematics/rotation-inl.hpp"

namespace hexaplast {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

SignedSvd signed_svd(const Mat3& F) {
  const scalar::SvdOf<double> found = scalar::signed_svd(scalar::entries(F));
  return {to_eigen(found.U).transpose(), Vec3::Map(found.d), to_eigen(found.V).transpose()};
}

Polar polar(const SignedSvd& F) { return {F.U * F.V.transpose(), F.V * F.d.asDiagonal() * F.V.transpose()}; }

Polar polar(const Mat3& F) { return polar(signed_svd(F)); }

Mat3 fit_rotation(const ElementPoints& from, const ElementPoints& to) { return polar(to.transpose() * from).R; }

Vec3 rotation_log(const Mat3& R) {
  const scalar::RotationVector<double> w = scalar::rotation_log(scalar::entries(R));
  return {w.axis_angle[0], w.axis_angle[1], w.axis_angle[2]};
}

}  // namespace hexaplast
