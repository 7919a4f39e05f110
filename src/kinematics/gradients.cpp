// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kinematics/gradients.hpp"

namespace hexaplast {

namespace {

/// Adds `scale` g_ia, the shape gradients at a corner, to one row per corner: only the corner and its three neighbours.
void add_corner_gradient(const Mat3& inverse_jacobian, int corner, double scale, ElementPoints& gradient) {
  for (int d = 0; d < 3; ++d) {
    const Eigen::RowVector3d half_edge = scale * 0.5 * kCornerSign[corner][d] * inverse_jacobian.row(d);
    gradient.row(corner) += half_edge;
    gradient.row(kEdgeNeighbour[corner][d]) -= half_edge;
  }
}

}  // namespace

Mat3 cofactor(const Mat3& J) {
  Mat3 cof;
  cof.col(0) = J.col(1).cross(J.col(2));
  cof.col(1) = J.col(2).cross(J.col(0));
  cof.col(2) = J.col(0).cross(J.col(1));
  return cof;
}

ElementPoints volume_gradient(const ElementPoints& x) {
  ElementPoints sum = ElementPoints::Zero();
  for_each_gauss_point(x, [&](const ElementPoints& dN, const Mat3& J) { sum += dN * cofactor(J).transpose(); });
  return sum;
}

ElementPoints mean_gradient(const ElementPoints& x) { return volume_gradient(x) / volume(x); }

RestOperator rest_operator(const ElementPoints& plastic_rest, const Sampling& sampling) {
  RestOperator rest;
  rest.corner_weight = sampling.corner_weight;
  rest.volume = volume(plastic_rest);
  for (int j = 0; j < kCorners; ++j) rest.inverse_jacobian[j] = corner_jacobian(plastic_rest, j).inverse();

  if (sampling.of_the_centre) {
    rest.shared_gradient = shape_derivatives(Vec3::Zero()) * centre_jacobian(plastic_rest).inverse();
  } else if (sampling.corner_weight == 1) {
    rest.shared_gradient.setZero();
  } else {  // h_a = Gm_a - corner_weight mean_j g_ja eq. 8
    rest.shared_gradient = mean_gradient(plastic_rest);
    for (int j = 0; j < kCorners; ++j)
      add_corner_gradient(rest.inverse_jacobian[j], j, -sampling.corner_weight / kCorners, rest.shared_gradient);
  }
  return rest;
}

ElementPoints sample_gradient(const RestOperator& rest, int sample) {
  ElementPoints gradient = rest.shared_gradient;
  add_corner_gradient(rest.inverse_jacobian[sample], sample, rest.corner_weight, gradient);
  return gradient;
}

}  // namespace hexaplast
