// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast {

/// Minimum residuals (Paige and Saunders 1975) with the stopping rules of SOFA's MinResLinearSolver: ends where the
/// estimate of |r| / (|A| |x|), or of |A r| / (|A| |r|), is at most the tolerance, |A| being that of Lanczos' matrix.
/// A need not be definite. As in SOFA, each solve of a SolverMemory begins at the solution before.
class MinimumResiduals final : public LinearSolver {
 public:
  MinimumResiduals(double tolerance, int iterations) : tolerance_(tolerance), iterations_(iterations) {}
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;
  SolveReport solve_next(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& memory) override;

 private:
  double tolerance_;
  int iterations_;
  PointArray v_, before_, now_, product_, w_, w_before_;  // Lanczos' vectors, and directions of x
};

}  // namespace hexaplast
