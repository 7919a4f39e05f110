// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/implicit_euler.hpp"

#include "hexaplast/base/finite.hpp"
#include "solve/constrained_operator.hpp"

namespace hexaplast {

SolveReport ImplicitEuler::step(MechanicalSystem& system, LinearSolver& solver, double time, double dt, Points x,
                                Points v) {
  const double h = dt, rM = settings_.rayleigh_mass, rK = settings_.rayleigh_stiffness;
  right_hand_side_.resize(x.rows(), 3);
  increment_.resize(x.rows(), 3);

  // b = h [ f - rM M v + (h + rK) K v ]                                                                       eq. 41
  system.compute_force(time, x, v, right_hand_side_);
  system.add_product({.mass = -rM, .damping = 0, .stiffness = h + rK}, v, right_hand_side_);
  right_hand_side_ *= h;
  system.project(right_hand_side_);
  require_finite(right_hand_side_, "force");  // before the solver, which would spread it over all nodes

  // A = (1 + h rM) M - h B - h (h + rK) K                                                                     eq. 40
  const ConstrainedOperator A(system, {.mass = 1 + h * rM, .damping = -h, .stiffness = -h * (h + rK)});
  const SolveReport report = solver.solve(A, right_hand_side_, increment_);

  increment_ += v;  // the new velocity                                                                        eq. 42
  require_finite(increment_, "velocity");
  v = increment_;
  x += h * v;
  return report;
}

}  // namespace hexaplast
