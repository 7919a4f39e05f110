// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/newton_raphson.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/irregular_field.hpp"
#include "base/require.hpp"
#include "hexaplast/base/parallel.hpp"
#include "solve/constants.hpp"
#include "solve/constrained_operator.hpp"

namespace hexaplast {

namespace {

/// Holds the nodes on which the stiffness does not act, as those are whose elements are all gone. A displacement
/// without any regularity moves a force at every other node.
void hold_unsupported(const MechanicalSystem& system, PointArray& displacement, PointArray& product,
                      Constraints& constraints) {
  fill_irregularly(displacement);
  product.setZero();
  system.add_product({.mass = 0, .damping = 0, .stiffness = -1}, displacement, product);
  for (int n = 0; n < product.rows(); ++n)
    if (product.row(n).isZero(0)) constraints.free.row(n).setZero();
}

}  // namespace

NewtonReport NewtonRaphson::solve(MechanicalSystem& system, LinearSolver& solver, double time, Points x) {
  require_rows("NewtonRaphson::solve", "x", x, system.num_nodes());
  system.set_time_step(std::numeric_limits<double>::infinity());
  const auto norm = [](ConstPoints field) { return std::sqrt(dot(field, field)); };
  const auto residual_at = [&](ConstPoints at, PointArray& f) {
    system.compute_force(time, at, velocity_, f);
    constraints_.project(f);
    return norm(f);
  };
  // a threshold of 0 is never met, not even by 0
  const auto below = [](double value, double threshold) { return threshold > 0 && value <= threshold; };

  position_ = x;
  velocity_.setZero(x.rows(), 3);
  trial_.resize(x.rows(), 3);
  force_.resize(x.rows(), 3);
  trial_force_.resize(x.rows(), 3);
  increment_.resize(x.rows(), 3);

  NewtonReport report;
  system.compute_force(time, position_, velocity_, force_);
  constraints_.reset(system.num_nodes());
  system.constrain(constraints_);
  hold_unsupported(system, increment_, trial_force_, constraints_);
  constraints_.project(force_);
  report.initial_residual = report.residual = norm(force_);
  if (report.residual == 0 || below(report.residual, settings_.absolute_residual)) {
    report.status = NewtonStatus::kEquilibrium;
    return report;
  }

  while (report.iterations < settings_.iterations && report.status == NewtonStatus::kNotConverged) {
    ++report.iterations;
    const ConstrainedOperator A(system, {.mass = 0, .damping = 0, .stiffness = -1}, constraints_);
    const SolveReport solved = solver.solve_next(A, force_, increment_, memory_);
    report.linear_iterations += solved.iterations;
    report.preconditioner = solved.preconditioner;
    report.at_threshold = report.at_threshold || solved.at_threshold;
    require_finite(increment_, "displacement");

    double residual = 0, step = 1;
    bool decreased = false;
    for (int attempt = 0; attempt < std::max(settings_.line_search_iterations, 1) && !decreased; ++attempt) {
      if (attempt > 0) step *= settings_.line_search_coefficient;
      trial_ = position_ + step * increment_;
      residual = residual_at(trial_, trial_force_);
      decreased = residual < report.residual;
    }
    require_finite(trial_force_, "force");

    const double moved = step * norm(increment_);
    // neither a residual that falls from where it had blown up to, nor a step that an unfinished linear solution made
    // in vain, is a sign of equilibrium
    const bool is_nearer = residual <= kOfInitial * report.initial_residual && (decreased || solved.converged);
    const bool converged = below(residual, settings_.absolute_residual) ||
                           (is_nearer && (below(residual / report.residual, settings_.relative_successive) ||
                                          below(residual / report.initial_residual, settings_.relative_initial) ||
                                          below(moved, settings_.absolute_estimate) ||
                                          below(moved / norm(position_), settings_.relative_estimate)));
    if (converged) report.status = NewtonStatus::kConverged;
    position_.swap(trial_);
    force_.swap(trial_force_);
    report.residual = residual;
  }
  x = position_;
  return report;
}

}  // namespace hexaplast
