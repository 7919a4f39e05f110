// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/implicit_euler.hpp"

#include <cmath>

#include "hexaplast/base/finite.hpp"
#include "solve/constrained_operator.hpp"

namespace hexaplast {

SolveReport ImplicitEuler::step(MechanicalSystem& system, LinearSolver& solver, double time, double dt, Points x,
                                Points v) {
  const double h = dt, ah = settings_.trapezoidal ? h / 2 : h;
  const double rM = settings_.rayleigh_mass, rK = settings_.rayleigh_stiffness;
  const bool first_order = settings_.first_order;
  right_hand_side_.resize(x.rows(), 3);
  velocity_.resize(x.rows(), 3);

  // b = h [ f - rM M v + (a h + rK) K v ]                                                                     eq. 41
  system.compute_force(time, x, v, right_hand_side_);
  if (!first_order) {
    system.add_product({.mass = -rM, .damping = 0, .stiffness = ah + rK}, v, right_hand_side_);
    right_hand_side_ *= h;
  }
  system.project(right_hand_side_);
  require_finite(right_hand_side_, "force");  // before the solver, which would spread it over all nodes

  // A = (1 + a h rM) M - a h B - a h (a h + rK) K                                                             eq. 40
  const OperatorFactors factors =
      first_order ? OperatorFactors{.mass = 1, .damping = 0, .stiffness = -ah}
                  : OperatorFactors{.mass = 1 + ah * rM, .damping = -ah, .stiffness = -ah * (ah + rK)};
  const SolveReport report = solver.solve(ConstrainedOperator(system, factors), right_hand_side_, velocity_);

  if (!first_order) velocity_ += v;  //                                                                        eq. 42
  require_finite(velocity_, "velocity");
  x += h * velocity_;
  // positions have moved by then: the decay acts on the steps that follow
  v = std::exp(-h * settings_.velocity_damping) * velocity_;
  return report;
}

}  // namespace hexaplast
