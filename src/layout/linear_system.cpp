// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/layout/linear_system.hpp"

#include "base/irregular_field.hpp"
#include "base/require.hpp"

namespace hexaplast {
namespace {

double number(Eigen::Index node, int axis) { return 0.5 + irregular_number(3 * node + axis); }

}  // namespace

void SolveReport::add(const SolveReport& again) {
  iterations += again.iterations;
  residual = again.residual;
  converged = again.converged;
  if (again.preconditioner == PreconditionedBy::kDiagonal && again.iterations > 0)
    preconditioner = again.preconditioner;  // a cycle has given way to it
}

PointArray irregular_numbers(int num_nodes) {
  PointArray numbers(num_nodes, 3);
  fill_irregularly(numbers);
  numbers.array() += 0.5;
  return numbers;
}

void MatrixFreeSystem::begin_free(int num_nodes) {
  free.setOnes(num_nodes, 3);
  couples_coordinates = false;
}

void MatrixFreeSystem::fill_axis(int axis) {
  scratch.setZero(free.rows(), 3);
  for (Eigen::Index n = 0; n < scratch.rows(); ++n) scratch(n, axis) = number(n, axis);
}

void MatrixFreeSystem::take_free(int axis) {
  for (Eigen::Index n = 0; n < scratch.rows(); ++n) {
    if (scratch(n, axis) == 0)
      free(n, axis) = 0;
    else
      scratch(n, axis) -= number(n, axis);
  }
  couples_coordinates = couples_coordinates || !scratch.isZero(0);
}

void require_sizes(const LinearSystem& A, ConstPoints b, ConstPoints x) {
  require_rows("solve", "b", b, A.num_nodes());
  require_rows("solve", "x", x, A.num_nodes());
}

}  // namespace hexaplast
