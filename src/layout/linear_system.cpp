// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/layout/linear_system.hpp"

#include "base/irregular_field.hpp"
#include "base/require.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {
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

void Constraints::project(Points field) const {
  require_rows("Constraints::project", "field", field, static_cast<int>(free.rows()));
  for (Eigen::Index n = 0; n < free.rows(); ++n)
    for (int axis = 0; axis < 3; ++axis)
      if (!free(n, axis)) field(n, axis) = 0;
  if (projector) projector->project(field);
}

void Constraints::pin(BlockMatrix& A) const {
  require_count("Constraints::pin", "A", A.num_nodes(), static_cast<int>(free.rows()));
  for (Eigen::Index n = 0; n < free.rows(); ++n)
    for (int axis = 0; axis < 3; ++axis)
      if (!free(n, axis)) A.pin(static_cast<int>(n), axis);
}

void LinearSystem::assemble(BlockMatrix& /*A*/) const {
  throw InputError("the system is known by its products alone: a solver that factorises has no matrix of it");
}

void require_sizes(const LinearSystem& A, ConstPoints b, ConstPoints x) {
  require_rows("solve", "b", b, A.num_nodes());
  require_rows("solve", "x", x, A.num_nodes());
}

}  // namespace hexaplast
