// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/newmark.hpp"

#include <cmath>
#include <utility>

#include "base/finite.hpp"
#include "base/require.hpp"
#include "solve/acceleration.hpp"
#include "solve/constrained_operator.hpp"

namespace hexaplast {

SolveReport Newmark::step(MechanicalSystem& system, LinearSolver& solver, double time, double dt, Points x, Points v) {
  require_rows("Newmark::step", "x", x, system.num_nodes());
  require_rows("Newmark::step", "v", v, system.num_nodes());
  const double h = dt, rM = settings_.rayleigh_mass, rK = settings_.rayleigh_stiffness, gamma = settings_.gamma,
               beta = settings_.beta;
  PointArray& b = right_hand_side_;
  b.resize(x.rows(), 3);
  next_.resize(x.rows(), 3);
  if (acceleration_.rows() != x.rows()) {
    system.prescribe(time, x, v);
    system.compute_force(time, x, v, b);
    solve_for_acceleration(system, &solver, memory_, b, next_);
    acceleration_ = next_;
  }

  system.compute_force(time, x, v, b);
  if (rM != 0 || rK != 0 || beta != 0.5)
    system.add_product({.mass = -h * (1 - gamma) * rM,
                        .damping = h * (1 - gamma),
                        .stiffness = h * (1 - gamma) * rK + h * h * (1 - 2 * beta) / 2},
                       acceleration_, b);
  system.add_product({.mass = -rM, .damping = 1, .stiffness = rK + h}, v, b);
  system.project(b);
  require_finite(b, "force");

  const OperatorFactors factors{
      .mass = 1 + h * gamma * rM, .damping = -h * gamma, .stiffness = -h * h * beta - h * rK * gamma};
  const SolveReport report = solver.solve_next(ConstrainedOperator(system, factors), b, next_, memory_);
  require_finite(next_, "acceleration");
  x += h * v + h * h * (0.5 - beta) * acceleration_ + h * h * beta * next_;
  v += h * (1 - gamma) * acceleration_ + h * gamma * next_;
  v *= std::exp(-h * settings_.velocity_damping);
  std::swap(acceleration_, next_);
  return report;
}

}  // namespace hexaplast
