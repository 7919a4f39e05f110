// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast {

/// What SOFA's preconditioners take of the assembled matrix A = D + L + L^T.
enum class MatrixPart {
  kDiagonal,        ///< D (JacobiPreconditioner)
  kDiagonalBlocks,  ///< the 3x3 blocks on the diagonal (BlockJacobiPreconditioner)
  kSymmetricSweep,  ///< (D/w + L^T) D^-1 (D/w + L) w / (2 - w), w: omega (SSORPreconditioner)
};

/// Solves with a part of the assembled matrix in its place: a preconditioner, as
/// SolverPreconditionedConjugateGradients takes it. Terms of rank one beside the blocks are left out.
class MatrixPartSolver final : public LinearSolver {
 public:
  /// omega: of kSymmetricSweep, in (0, 2).
  explicit MatrixPartSolver(MatrixPart part, double omega = 1) : part_(part), omega_(omega) {}
  void setup(const LinearSystem& A) override;
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;
  SolveReport solve_again(const LinearSystem& A, ConstPoints b, Points x) override;

 private:
  void sweep(ConstPoints b, Points x) const;

  MatrixPart part_;
  double omega_;
  BlockMatrix matrix_;
  std::vector<Mat3> inverse_;  // per node, of the part on the diagonal
};

}  // namespace hexaplast
