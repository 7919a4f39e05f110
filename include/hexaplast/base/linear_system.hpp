// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A symmetric positive definite system A x = b over nodal fields, seen by its solvers.
class LinearSystem {
 public:
  virtual ~LinearSystem() = default;

  virtual int num_nodes() const = 0;

  /// Ap = A p. Rows of constrained degrees of freedom are zero.
  virtual void apply(ConstPoints p, Points Ap) const = 0;

  /// A += the same operator as blocks, constrained degrees of freedom pinned (BlockMatrix::pin). `A` arrives cleared.
  virtual void assemble(BlockMatrix& A) const = 0;

  /// z = an approximation of A^-1 r, symmetric and positive definite; the default is none (z = r).
  virtual void precondition(ConstPoints r, Points z) const { z = r; }

  /// Size of the rounding errors in b: a residual as small as this cannot be improved.
  virtual double rounding() const { return 0; }
};

struct SolveReport {
  int iterations = 0;     ///< 1 for a direct solver
  double residual = 0;    ///< |b - A x| / |b| as the solver knows it (0 for a direct solver)
  bool converged = true;  ///< false: stopped by the iteration limit
};

/// Solves A x = b; x arrives with any content. Throws NumericalError when A is found not to be positive definite.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  virtual SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) = 0;

  /// Forgets what it kept of earlier solves (warm start, factors).
  virtual void reset() {}
};

}  // namespace hexaplast
