// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast {

/// Stopping rules and line search of SOFA's NewtonRaphsonSolver; norms are Euclidean norms of the projected force [N]
/// and of the positions [m]. A threshold of 0 switches its rule off. All rules but that on |r_k| hold only where |r_k|
/// is not above twice |r_0|, and where the linear solver converged or |r_k| fell.
struct NewtonSettings {
  int iterations = 1;                    ///< at most
  double relative_successive = 1e-5;     ///< on |r_k| / |r_k-1|
  double relative_initial = 1e-5;        ///< on |r_k| / |r_0|
  double absolute_residual = 1e-5;       ///< on |r_k|
  double relative_estimate = 0;          ///< on |x_k - x_k-1| / |x_k-1|
  double absolute_estimate = 0;          ///< on |x_k - x_k-1|
  int line_search_iterations = 1;        ///< tries per iteration, at least 1
  double line_search_coefficient = 0.5;  ///< by which the step is shortened while the residual has not decreased
};

enum class NewtonStatus {
  kEquilibrium,  ///< the absolute rule held before the first iteration
  kConverged,    ///< one of the rules held
  kNotConverged  ///< the iterations ran out
};

struct NewtonReport {
  NewtonStatus status = NewtonStatus::kNotConverged;
  int iterations = 0;
  int linear_iterations = 0;    ///< of the linear solver, all Newton iterations together
  double initial_residual = 0;  ///< [N] |r_0|
  double residual = 0;          ///< [N] |r| at the end
  PreconditionedBy preconditioner = PreconditionedBy::kNothing;  ///< of the last linear solution
  bool at_threshold = false;                                     ///< SolveReport::at_threshold of some linear solution
};

/// Static equilibrium, as SOFA's StaticSolver finds it: f(x) = 0 under constraints.               theory.md eq. 43
///
///   -K(x_k) dx = f(x_k),  x_k+1 = x_k + a dx,  a = 1, c, c^2, ... until |f| decreases
///
/// A node on which no stiffness acts, since all elements around it are gone, has no equilibrium: it stays where it is,
/// and the force on it does not count.
class NewtonRaphson {
 public:
  explicit NewtonRaphson(NewtonSettings settings) : settings_(settings) {}

  /// Moves x [m] towards equilibrium under the loads at `time`; velocities are taken as zero. Throws NumericalError
  /// naming the first node that left the finite numbers, InputError where x has not one row per node of the system; x
  /// is then as before, `memory` is not.
  NewtonReport solve(MechanicalSystem& system, LinearSolver& solver, double time, Points x);

  /// What the linear solver of the next iteration begins with (ImplicitEuler::memory).
  SolverMemory& memory() { return memory_; }

 private:
  NewtonSettings settings_;
  SolverMemory memory_;
  PointArray position_, trial_, velocity_, force_, trial_force_, increment_;
  Constraints constraints_;  // and nodes on which no stiffness acts
};

}  // namespace hexaplast
