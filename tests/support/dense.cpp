// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/dense.hpp"

namespace hexaplast::support {

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace hexaplast::support
