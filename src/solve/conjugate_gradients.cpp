// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/conjugate_gradients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

SolveReport ConjugateGradients::solve(const LinearSystem& A, ConstPoints b, Points x) {
  // SOFA lets the first iteration of the very first solve pass its stopping rules
  const bool first_solve = std::exchange(first_solve_, false);
  SolveReport report;

  direction_.resize(b.rows(), 3);
  product_.resize(b.rows(), 3);
  if (settings_.warm_start && previous_.rows() == b.rows()) {
    x = previous_;
    A.apply(x, product_);
    residual_ = b - product_;
  } else {
    x.setZero();
    residual_ = b;
  }

  const double norm_b = std::sqrt(dot(b, b));
  if (norm_b == 0) {
    x.setZero();
    return report;
  }

  report.converged = false;
  double rho = dot(residual_, residual_), rho_before = 0;
  for (int iteration = 1; iteration <= settings_.iterations; ++iteration) {
    const bool must_go_on = first_solve && iteration == 1;
    if (std::sqrt(rho) / norm_b <= settings_.tolerance && !must_go_on) {
      report.converged = true;
      break;
    }

    if (iteration == 1)
      direction_ = residual_;
    else
      direction_ = residual_ + (rho / rho_before) * direction_;
    A.apply(direction_, product_);
    const double curvature = dot(direction_, product_);
    if (curvature == 0 || (std::abs(curvature) <= settings_.threshold && !must_go_on)) {
      report.converged = true;
      break;
    }
    if (curvature < 0)
      throw NumericalError(
          fmt::format("conjugate gradients: the matrix is not positive definite (p.Ap = {})", curvature));

    const double alpha = rho / curvature;
    x += alpha * direction_;
    residual_ -= alpha * product_;
    report.iterations = iteration;
    rho_before = rho;
    rho = dot(residual_, residual_);
  }
  report.residual = std::sqrt(rho) / norm_b;
  report.converged = report.converged || report.residual <= settings_.tolerance;
  if (settings_.warm_start) previous_ = x;
  return report;
}

void ConjugateGradients::reset() {
  first_solve_ = true;
  previous_.resize(0, 3);
}

SolveReport SolverPreconditionedConjugateGradients::solve(const LinearSystem& A, ConstPoints b, Points x) {
  SolveReport report;
  product_.resize(b.rows(), 3);
  preconditioned_.resize(b.rows(), 3);
  x.setZero();
  const double b_squared = dot(b, b);
  if (b_squared == 0) return report;

  const auto precondition = [&] {
    if (preconditioner_)
      preconditioner_->solve(A, residual_, preconditioned_);
    else
      preconditioned_ = residual_;
    return dot(residual_, preconditioned_);
  };

  residual_ = b;
  double rho = precondition();
  direction_ = preconditioned_;
  while (report.iterations < iterations_ && rho > tolerance_ * b_squared) {
    A.apply(direction_, product_);
    const double curvature = dot(direction_, product_);
    if (!(curvature > 0))
      throw NumericalError(
          fmt::format("conjugate gradients: the matrix is not positive definite (p.Ap = {})", curvature));

    const double alpha = rho / curvature;
    x += alpha * direction_;
    residual_ -= alpha * product_;
    ++report.iterations;

    const double rho_before = std::exchange(rho, precondition());
    direction_ = preconditioned_ + (rho / rho_before) * direction_;
  }
  report.residual = std::sqrt(dot(residual_, residual_) / b_squared);
  report.converged = rho <= tolerance_ * b_squared;
  return report;
}

void SolverPreconditionedConjugateGradients::reset() {
  if (preconditioner_) preconditioner_->reset();
}

SolveReport PreconditionedConjugateGradients::solve(const LinearSystem& A, ConstPoints b, Points x) {
  SolveReport report;
  product_.resize(b.rows(), 3);
  preconditioned_.resize(b.rows(), 3);
  x.setZero();
  const double norm_b = std::sqrt(dot(b, b));
  if (norm_b == 0) return report;

  residual_ = b;
  A.precondition(residual_, preconditioned_);
  direction_ = preconditioned_;
  double rho = dot(residual_, preconditioned_);
  report.residual = 1;
  const double enough = std::max(tolerance_, A.rounding() / norm_b);
  while (report.residual > enough && report.iterations < iterations_) {
    A.apply(direction_, product_);
    const double curvature = dot(direction_, product_);
    if (!(curvature > 0)) break;  // what is left of b lies outside the range of a semi-definite A: rounding

    const double alpha = rho / curvature;
    x += alpha * direction_;
    residual_ -= alpha * product_;
    ++report.iterations;
    report.residual = std::sqrt(dot(residual_, residual_)) / norm_b;

    A.precondition(residual_, preconditioned_);
    const double rho_before = std::exchange(rho, dot(residual_, preconditioned_));
    direction_ = preconditioned_ + (rho / rho_before) * direction_;
  }
  report.converged = report.residual <= enough;
  return report;
}

}  // namespace hexaplast
