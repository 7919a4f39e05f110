// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/minres.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/finite.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

SolveReport MinimumResiduals::solve(const LinearSystem& A, ConstPoints b, Points x) {
  SolverMemory none;
  return solve_next(A, b, x, none);
}

SolveReport MinimumResiduals::solve_next(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& memory) {
  require_sizes(A, b, x);
  constexpr double kRounding = std::numeric_limits<double>::epsilon();
  SolveReport report;
  product_.resize(b.rows(), 3);
  now_ = b;
  if (memory.start.rows() == b.rows()) {
    x = memory.start;
    A.apply(x, product_);
    now_ -= product_;
  } else {
    x.setZero();
  }
  const double norm_b = std::sqrt(hexaplast::dot(b, b)), norm_r = std::sqrt(hexaplast::dot(now_, now_));
  if (!std::isfinite(norm_b) || !std::isfinite(norm_r))
    throw NumericalError("minimum residuals: the right-hand side or its square is not finite");
  if (norm_r == 0) return report;

  before_.setZero(b.rows(), 3);
  w_.setZero(b.rows(), 3);
  w_before_.setZero(b.rows(), 3);
  // the QR decomposition of Lanczos' tridiagonal matrix: one Givens rotation (c, s) per iteration
  double beta = norm_r, beta_before = 0, c = -1, s = 0, diagonal_left = 0, far = 0, residual = norm_r, squares = 0;
  double greatest = 0, min = std::numeric_limits<double>::max();
  report.converged = false;
  while (report.iterations < iterations_) {
    const bool is_first = report.iterations++ == 0;

    // the next vector of Lanczos
    v_ = now_ / beta;
    A.apply(v_, product_);
    if (!is_first) product_ -= beta / beta_before * before_;
    const double alpha = hexaplast::dot(v_, product_);
    product_ -= alpha / beta * now_;
    before_.swap(now_);
    now_ = product_;
    beta_before = beta;
    beta = std::sqrt(hexaplast::dot(now_, now_));
    if (!std::isfinite(alpha) || !std::isfinite(beta))
      throw NumericalError("minimum residuals: the matrix is not finite");
    squares += alpha * alpha + beta_before * beta_before + beta * beta;

    // the rotation before, on the new column, and the new one
    const double far_before = far, upper = c * diagonal_left + s * alpha, on_diagonal = s * diagonal_left - c * alpha;
    far = s * beta;
    diagonal_left = -c * beta;
    const double of_residual = std::hypot(on_diagonal, diagonal_left);  // |A r| / |r| of the residual before
    const double pivot = std::max(std::hypot(on_diagonal, beta), kRounding);
    c = on_diagonal / pivot;
    s = beta / pivot;
    const double along = c * residual;
    residual *= s;

    w_before_.swap(w_);
    w_ = (v_ - far_before * w_ - upper * w_before_) / pivot;
    x += along * w_;

    if (is_first && beta < 10 * kRounding * norm_r) {
      report.converged = true;
      break;
    }
    const double norm_A = std::sqrt(squares), norm_x = std::sqrt(hexaplast::dot(x, x));
    greatest = std::max(greatest, pivot);
    min = std::min(min, pivot);
    const double of_A = of_residual / norm_A;
    report.converged = residual <= tolerance_ * norm_A * norm_x || of_A <= tolerance_;
    if (report.converged || greatest / min >= 0.1 / kRounding || norm_A * kRounding * norm_x >= norm_r) break;
  }
  require_finite(x, "solution");
  memory.start = x;
  report.residual = norm_b > 0 ? residual / norm_b : 0;
  return report;
}

}  // namespace hexaplast
