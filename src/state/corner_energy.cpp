// SPDX-License-Identifier: LGPL-2.1-or-later
#include "state/corner_energy.hpp"

#include <algorithm>

#include "mesh/trilinear.hpp"

namespace hexaplast {

namespace {

/// [m^3] What changes of the Jacobians are measured by: one that nearly vanishes at rest, by a tenth of the largest.
CornerValues sizes(const CornerValues& at_rest) {
  const double least = 0.1 * *std::max_element(at_rest.begin(), at_rest.end());
  CornerValues size;
  for (int i = 0; i < kCorners; ++i) size[i] = std::max(at_rest[i], least);
  return size;
}

CornerValues jacobians(const ElementPoints& x) {
  CornerValues det;
  for (int i = 0; i < kCorners; ++i) det[i] = corner_jacobian(x, i).determinant();
  return det;
}

}  // namespace

CornerValues corner_ratios(const ElementPoints& plastic_rest, const ElementPoints& current) {
  const CornerValues before = jacobians(plastic_rest), now = jacobians(current), size = sizes(before);
  CornerValues ratio;
  for (int i = 0; i < kCorners; ++i) ratio[i] = 1 + (now[i] - before[i]) / size[i];
  return ratio;
}

void CornerEnergy::add(const Hexahedron& nodes, double mu, double volume, const ElementPoints& plastic_rest,
                       const ElementPoints& current) {
  const CornerValues ratio = corner_ratios(plastic_rest, current), size = sizes(jacobians(plastic_rest));
  for (int i = 0; i < kCorners; ++i) {
    if (!(ratio[i] < kFrom)) continue;
    Corner& corner = corners_.emplace_back();
    corner.stiffness = kStrength * mu * volume / kCorners;
    corner.missing = kFrom - ratio[i];
    corner.nodes[0] = nodes[i];
    corner.slope.row(0).setZero();
    const Mat3 of_half_edges = cofactor(corner_jacobian(current, i)) / size[i];
    for (int d = 0; d < 3; ++d) {
      corner.nodes[d + 1] = nodes[kEdgeNeighbour[i][d]];
      corner.slope.row(d + 1) = -0.5 * kCornerSign[i][d] * of_half_edges.col(d).transpose();
      corner.slope.row(0) -= corner.slope.row(d + 1);
    }
  }
}

double CornerEnergy::energy() const {
  double sum = 0;
  for (const Corner& corner : corners_) sum += corner.stiffness / 2 * corner.missing * corner.missing;
  return sum;
}

void CornerEnergy::add_force(Points f) const {
  for (const Corner& corner : corners_)
    for (int k = 0; k < 4; ++k) f.row(corner.nodes[k]) += corner.stiffness * corner.missing * corner.slope.row(k);
}

void CornerEnergy::add_product(double factor, ConstPoints p, Points Fp) const {
  for (const Corner& corner : corners_) {
    double change = 0;
    for (int k = 0; k < 4; ++k) change += corner.slope.row(k).dot(p.row(corner.nodes[k]));
    for (int k = 0; k < 4; ++k) Fp.row(corner.nodes[k]) += factor * corner.stiffness * change * corner.slope.row(k);
  }
}

void CornerEnergy::add_diagonal(double factor, Points diagonal) const {
  for (const Corner& corner : corners_)
    for (int k = 0; k < 4; ++k)
      diagonal.row(corner.nodes[k]) += factor * corner.stiffness * corner.slope.row(k).cwiseAbs2();
}

void CornerEnergy::add_blocks(double factor, BlockMatrix& K) const {
  for (const Corner& corner : corners_)
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l)
        K.add(corner.nodes[k], corner.nodes[l],
              factor * corner.stiffness * corner.slope.row(k).transpose() * corner.slope.row(l));
}

}  // namespace hexaplast
