// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Dense>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast::support {

/// Block matrix as a full one, degree of freedom 3 n + axis.
inline Eigen::MatrixXd dense(const BlockMatrix& A) {
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * A.num_nodes(), 3 * A.num_nodes());
  for (int n = 0; n < A.num_nodes(); ++n) {
    for (const BlockMatrix::Entry& entry : A.row(n)) full.block<3, 3>(3 * n, 3 * entry.column) = entry.block;
  }
  return full;
}

inline PointArray times(const BlockMatrix& A, ConstPoints p) {
  PointArray product = PointArray::Zero(p.rows(), 3);
  for (int n = 0; n < A.num_nodes(); ++n)
    for (const BlockMatrix::Entry& entry : A.row(n)) product.row(n) += p.row(entry.column) * entry.block.transpose();
  return product;
}

/// Nodal field as one column, and back.
inline Eigen::VectorXd stacked(ConstPoints field) {
  return Eigen::Map<const Eigen::VectorXd>(field.data(), field.size());
}
inline PointArray unstacked(const Eigen::VectorXd& values) {
  return Eigen::Map<const PointArray>(values.data(), values.size() / 3, 3);
}

/// Of a symmetric matrix, ascending; compiled once, as it takes six seconds.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);

/// What the constraints of a system leave free.
inline Constraints constraints_of(const MechanicalSystem& system) {
  Constraints constraints;
  constraints.reset(system.num_nodes());
  system.constrain(constraints);
  return constraints;
}

/// Elastic forces at x, of a body that is linearized there.
inline PointArray force_at(Body& body, const PointArray& x) {
  PointArray f = PointArray::Zero(x.rows(), 3);
  body.linearize(x);
  body.add_force(f);
  return f;
}

/// K = -df/dx at x, rotations held fixed.
inline Eigen::MatrixXd stiffness_at(Body& body, const PointArray& x) {
  BlockMatrix K(body.mesh().num_nodes());
  body.linearize(x);
  body.add_stiffness_blocks(-1, K);
  return dense(K);
}

}  // namespace hexaplast::support
