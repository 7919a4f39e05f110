// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>

#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast {

/// Conjugate gradients with the stopping rules of SOFA's CGLinearSolver (theory.md section 6). A solve that the
/// threshold ends counts as converged, as in SOFA. With products in single precision the residual that is reported is
/// that of the system in double, which is one product more; with tolerance 0 it is the iteration's own. The first solve
/// of a SolverMemory, which a solve by itself always is, makes its first iteration whatever the rules say.
struct ConjugateGradientSettings {
  int iterations = 25;
  double tolerance = 1e-5;  ///< on |r| / |b|
  double threshold = 1e-5;  ///< absolute, on p.Ap: stops when it is not greater
  bool warm_start = false;  ///< starts from SolverMemory::start
};

class ConjugateGradients final : public LinearSolver {
 public:
  explicit ConjugateGradients(ConjugateGradientSettings settings);
  ~ConjugateGradients() override;
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;
  SolveReport solve_next(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& memory) override;

 private:
  ConjugateGradientSettings settings_;
  struct Spaces;  // the vectors, in the form and the precision that the system asks for
  std::unique_ptr<Spaces> spaces_;
};

enum class Preconditioner {
  kAuto,       ///< multigrid where it pays: stiff systems, of which one step couples many elements
  kMultigrid,  ///< a V-cycle over coarser meshes; the diagonal where the system has none
  kDiagonal    ///< Jacobi
};

/// What `prepare` says of a system.
struct PreparedSystem {
  bool is_concurrent = false;                ///< `approximate` of several solvers may run at the same time
  const Constraints* constraints = nullptr;  ///< of A, if it has told them; until the next `prepare`
};

/// Preconditioned conjugate gradients that end on |r| <= max(tolerance |b|, A.rounding()) alone: for systems of our
/// own, where an answer is wanted rather than a number of iterations. In a system of several bodies
/// (MatrixFreeSystem::parts) the same holds for each of them: |r_i| <= tolerance max(|b_i|, |(F x)_i|), so that a heavy
/// one does not hide what is left of a light one (theory.md section 9.5).
class PreconditionedConjugateGradients final : public LinearSolver {
 public:
  PreconditionedConjugateGradients(double tolerance, int iterations,
                                   Preconditioner preconditioner = Preconditioner::kDiagonal);
  ~PreconditionedConjugateGradients() override;
  PreconditionedConjugateGradients(const PreconditionedConjugateGradients& other)
      : PreconditionedConjugateGradients(other.tolerance_, other.iterations_, other.preconditioner_) {}
  PreconditionedConjugateGradients(PreconditionedConjugateGradients&&) noexcept;
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;
  SolveReport solve_next(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& memory) override;
  SolveReport solve_from_guess(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& memory) override;

  /// For many right-hand sides of one A (Compliance): prepares what their solves share. A stays as it is until the last
  /// of them. memory: of all solvers of this A.
  PreparedSystem prepare(const LinearSystem& A, SolverMemory& memory);

  /// x near A^-1 b of the A of the latest prepare, and r = b - A x, |r| <= residual |b|. b, and x with has_start, which
  /// it begins with, keep the constraints. Throws NumericalError where A is not positive definite.
  SolveReport approximate(ConstPoints b, double residual, bool has_start, Points x, Points r);
  /// r = b - A x in double precision, where products of `approximate` are in single; elsewhere r stays.
  void refine_residual(ConstPoints b, ConstPoints x, Points r);

 private:
  SolveReport iterate(const LinearSystem& A, ConstPoints b, const ConstPoints* start, Points x);
  SolveReport attempt(const LinearSystem& A, ConstPoints b, const ConstPoints* start, Points x);

  double tolerance_;
  int iterations_;
  Preconditioner preconditioner_;
  struct Spaces;
  std::unique_ptr<Spaces> spaces_;
};

}  // namespace hexaplast
