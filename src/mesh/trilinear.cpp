// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/trilinear.hpp"

namespace hexaplast {

ElementPoints shape_derivatives(const Vec3& s) {
  ElementPoints dN;
  for (int a = 0; a < kCorners; ++a) {
    const Vec3 sign(kCornerSign[a][0], kCornerSign[a][1], kCornerSign[a][2]);
    const Vec3 factor = Vec3::Ones() + sign.cwiseProduct(s);
    dN.row(a) << sign[0] * factor[1] * factor[2], factor[0] * sign[1] * factor[2], factor[0] * factor[1] * sign[2];
  }
  return dN / 8;
}

Mat3 corner_jacobian(const ElementPoints& x, int corner) {
  Mat3 J;
  for (int d = 0; d < 3; ++d)
    J.col(d) = 0.5 * kCornerSign[corner][d] * (x.row(corner) - x.row(kEdgeNeighbour[corner][d])).transpose();
  return J;
}

Mat3 centre_jacobian(const ElementPoints& x) { return x.transpose() * shape_derivatives(Vec3::Zero()); }

Mat3 cofactor(const Mat3& J) {
  Mat3 cof;
  cof.col(0) = J.col(1).cross(J.col(2));
  cof.col(1) = J.col(2).cross(J.col(0));
  cof.col(2) = J.col(0).cross(J.col(1));
  return cof;
}

double volume(const ElementPoints& x) {
  double sum = 0;
  for_each_gauss_point(x, [&](const ElementPoints&, const Mat3& J) { sum += J.determinant(); });
  return sum;
}

}  // namespace hexaplast
