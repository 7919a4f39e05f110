// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/linear_system.hpp"

namespace hexaplast {

/// Conjugate gradients with the stopping rules of SOFA's CGLinearSolver (theory.md section 6).
struct ConjugateGradientSettings {
  int iterations = 25;
  double tolerance = 1e-5;  ///< on |r| / |b|
  double threshold = 1e-5;  ///< absolute, on p.Ap: stops when it is not greater
  bool warm_start = false;
};

class ConjugateGradients final : public LinearSolver {
 public:
  explicit ConjugateGradients(ConjugateGradientSettings settings) : settings_(settings) {}
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;
  void reset() override;

 private:
  ConjugateGradientSettings settings_;
  bool first_solve_ = true;  // SOFA's rules are relaxed in the very first solve
  PointArray residual_, direction_, product_, previous_;
};

/// Conjugate gradients with the stopping rule of SOFA's PCGLinearSolver: r.z <= tolerance b.b, where z is what another
/// solver makes of r, taken as preconditioner (z = r without one). Without preconditioner the tolerance is thus the
/// square of a relative residual.
class SolverPreconditionedConjugateGradients final : public LinearSolver {
 public:
  /// `preconditioner` may be null; it must be symmetric and positive definite, and outlive this.
  SolverPreconditionedConjugateGradients(double tolerance, int iterations, LinearSolver* preconditioner)
      : tolerance_(tolerance), iterations_(iterations), preconditioner_(preconditioner) {}
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;
  void reset() override;

 private:
  double tolerance_;
  int iterations_;
  LinearSolver* preconditioner_;
  PointArray residual_, direction_, product_, preconditioned_;
};

/// Preconditioned conjugate gradients that end on |r| <= max(tolerance |b|, A.rounding()) alone: for systems of our
/// own, where an answer is wanted rather than a number of iterations.
class PreconditionedConjugateGradients final : public LinearSolver {
 public:
  PreconditionedConjugateGradients(double tolerance, int iterations) : tolerance_(tolerance), iterations_(iterations) {}
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;

 private:
  double tolerance_;
  int iterations_;
  PointArray residual_, direction_, product_, preconditioned_;
};

}  // namespace hexaplast
