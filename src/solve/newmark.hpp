// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast {

struct NewmarkSettings {
  double rayleigh_mass = 0;       ///< [1/s]
  double rayleigh_stiffness = 0;  ///< [s]
  double velocity_damping = 0;    ///< [1/s]
  double gamma = 0.5;
  double beta = 0.25;
};

/// One step of Newmark's scheme, linearised about the step's beginning, as SOFA's NewmarkImplicitSolver defines it:
///
///   A  = (1 + h g rM) M - h g B - (h^2 beta + h g rK) K                            g = gamma
///   b  = f + [ -h (1-g) rM M + h (1-g) B + (h (1-g) rK + h^2 (1 - 2 beta) / 2) K ] a - rM M v + B v + (rK + h) K v
///   A a' = b  (both projected),  x += h v + h^2 ((1/2 - beta) a + beta a'),  v += h ((1-g) a + g a'),
///   and then v *= exp(-h velocity_damping)
///
/// With rM = rK = 0 and beta = 1/2 the terms of a in b are left out.
class Newmark {
 public:
  explicit Newmark(NewmarkSettings settings) : settings_(settings) {}

  /// Advances x [m] and v [m/s] by dt [s]. The first step finds the acceleration that it begins with. Throws
  /// NumericalError naming the first node that left the finite numbers, InputError for other sizes; x and v are then as
  /// before, but for what constraints prescribe.
  SolveReport step(MechanicalSystem& system, LinearSolver& solver, double time, double dt, Points x, Points v);

  SolverMemory& memory() { return memory_; }

  /// [m/s^2] of the latest step; without rows before the first. It belongs to x and v as the memory does.
  PointArray& acceleration() { return acceleration_; }

 private:
  NewmarkSettings settings_;
  SolverMemory memory_;
  PointArray acceleration_, next_, right_hand_side_;
};

}  // namespace hexaplast
