// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Dense>

#include "hexaplast/base/block_matrix.hpp"

namespace hexaplast::support {

/// Block matrix as a full one, degree of freedom 3 n + axis.
inline Eigen::MatrixXd dense(const BlockMatrix& A) {
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(3 * A.num_nodes(), 3 * A.num_nodes());
  for (int n = 0; n < A.num_nodes(); ++n) {
    for (const BlockMatrix::Entry& entry : A.row(n)) full.block<3, 3>(3 * n, 3 * entry.column) = entry.block;
  }
  return full;
}

/// Nodal field as one column, and back.
inline Eigen::VectorXd stacked(ConstPoints field) {
  return Eigen::Map<const Eigen::VectorXd>(field.data(), field.size());
}
inline PointArray unstacked(const Eigen::VectorXd& values) {
  return Eigen::Map<const PointArray>(values.data(), values.size() / 3, 3);
}

}  // namespace hexaplast::support
