// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/compliance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "solve/constants.hpp"

namespace hexaplast {
namespace {

constexpr int kColumns = 8;  // of W, that are multiplied at once

void require_node(const char* whose, int node, int row, int num_nodes) {
  if (node < 0 || node >= num_nodes)
    throw InputError(fmt::format("{}: node {} of row {} must lie in [0, {})", whose, node, row, num_nodes));
}

Eigen::Map<PointArray> field_of(Eigen::MatrixXd& columns, int column) {
  return {columns.col(column).data(), columns.rows() / 3, 3};
}

}  // namespace

void add_constraint_force(std::span<const ConstraintRow> rows, std::span<const double> lambda, Points f) {
  if (lambda.size() != rows.size())
    throw InputError(fmt::format("add_constraint_force: {} values of lambda, must be {}", lambda.size(), rows.size()));
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (const auto& [node, direction] : rows[j]) {
      require_node("add_constraint_force", node, static_cast<int>(j), static_cast<int>(f.rows()));
      f.row(node) += lambda[j] * direction.transpose();
    }
}

Compliance::Compliance(Preconditioner preconditioner, double tolerance)
    : preconditioner_(preconditioner),
      tolerance_(tolerance),
      residual_(std::clamp(std::sqrt(kSquareOfResidual * tolerance), kLeastResidual, kMostResidual)) {}

void Compliance::reset() { *this = Compliance(preconditioner_, tolerance_); }

bool Compliance::start(ConstPoints b, Points x) const {
  if (x_.cols() == 0 || x_.rows() != 3 * b.rows()) return false;
  const PointArray flat = b;
  const Eigen::VectorXd of_rows = x_.transpose() * Eigen::VectorXd::Map(flat.data(), flat.size()),
                        all = x_ * factor_.solve(of_rows);  // the nearest combination in the energy norm
  x = Eigen::Map<const PointArray>(all.data(), b.rows(), 3);
  return true;
}

const Eigen::MatrixXd& Compliance::find(const LinearSystem& A, std::span<const ConstraintRow> rows) {
  const int size = 3 * A.num_nodes(), num_rows = static_cast<int>(rows.size());
  if (num_rows == 0) {
    x_.resize(0, 0);
    w_.resize(0, 0);
    iterations_ = num_stalled_ = 0;
    return w_;
  }
  b_.setZero(size, num_rows);
  for (int j = 0; j < num_rows; ++j)
    for (const auto& [node, direction] : rows[j]) {
      require_node("Compliance", node, j, A.num_nodes());
      field_of(b_, j).row(node) += direction.transpose();
    }
  const int num_solvers = num_threads();
  while (static_cast<int>(solvers_.size()) < num_solvers)
    solvers_.emplace_back(1e-3, kMaxIterationsPerRow, preconditioner_);
  bool is_parallel = true;
  const Constraints* constraints = nullptr;
  SolverMemory memory;
  for (int k = 0; k < num_solvers && is_parallel; ++k) {
    const PreparedSystem prepared = solvers_[k].prepare(A, memory);
    constraints = prepared.constraints;
    is_parallel = prepared.is_concurrent;
  }
  const auto project = [&](Eigen::MatrixXd& columns, int column) {
    if (constraints) constraints->project(field_of(columns, column));
  };
  for (int j = 0; j < num_rows; ++j) project(b_, j);

  // each begins with the nearest combination of the solutions before
  const bool has_previous = x_.cols() > 0 && x_.rows() == size;
  std::swap(x_, previous_);
  for (Eigen::MatrixXd* columns : {&x_, &r_}) columns->resize(size, num_rows);
  Eigen::MatrixXd coefficients;
  if (has_previous) {
    coefficients = Eigen::MatrixXd(previous_.cols(), num_rows);
    parallel_for(num_rows, [&](int j) {
      Eigen::VectorXd known = Eigen::VectorXd::Zero(previous_.cols());
      for (const auto& [node, direction] : rows[j]) known += previous_.middleRows(3 * node, 3).transpose() * direction;
      coefficients.col(j) = factor_.solve(known);
      const double negligible = kNegligible * std::sqrt(std::max(known.dot(coefficients.col(j)), 0.0));
      for (int i = 0; i < static_cast<int>(known.size()); ++i)
        if (std::abs(coefficients(i, j)) * std::sqrt(std::max(energy_[i], 0.0)) < negligible) coefficients(i, j) = 0;
    });
  }

  x_.setZero();
  std::vector<unsigned char> has_start(static_cast<std::size_t>(num_rows), 0);
  parallel_for(has_previous ? num_rows : 0, [&](int j) {
    for (int i = 0; i < static_cast<int>(previous_.cols()); ++i) {
      if (coefficients(i, j) == 0) continue;
      x_.col(j) += coefficients(i, j) * previous_.col(i);
      has_start[j] = 1;
    }
  });
  for (int j = 0; j < num_rows; ++j)  // the constraints may be others than those of the solutions before
    if (has_start[j]) project(x_, j);

  std::vector<SolveReport> reports(static_cast<std::size_t>(num_rows));
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(num_rows));
  const auto solve = [&](PreconditionedConjugateGradients& solver, int j) {
    try {
      reports[j] = solver.approximate(field_of(b_, j), residual_, has_start[j] != 0, field_of(x_, j), field_of(r_, j));
    } catch (...) {
      failures[j] = std::current_exception();
    }
  };
  if (is_parallel) {
    parallel_for(num_solvers, [&](int k) {
      for (int j = k; j < num_rows; j += num_solvers) solve(solvers_[k], j);
    });
  } else {
    for (int j = 0; j < num_rows; ++j) solve(solvers_.front(), j);
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) {
      reset();
      std::rethrow_exception(failure);
    }
  if (tolerance_ < kSingleSuffices)
    for (int j = 0; j < num_rows; ++j)
      solvers_.front().refine_residual(field_of(b_, j), field_of(x_, j), field_of(r_, j));
  iterations_ = num_stalled_ = 0;
  for (const SolveReport& report : reports) {
    iterations_ += report.iterations;
    num_stalled_ += !report.converged;
  }

  // W = G^T K^-1 G, G = X^T B, K = X^T A X = X^T (B - R)                                                     eq. W1
  Eigen::MatrixXd G(num_rows, num_rows), K(num_rows, num_rows);
  parallel_for(num_rows, [&](int i) {
    for (int j = 0; j < num_rows; ++j) {
      G(i, j) = 0;
      for (const auto& [node, direction] : rows[j]) G(i, j) += x_.col(i).segment<3>(3 * node).dot(direction);
    }
  });
  parallel_for((num_rows + kColumns - 1) / kColumns, [&](int part) {
    const int first = kColumns * part, count = std::min(kColumns, num_rows - first);
    K.middleCols(first, count).noalias() = x_.transpose() * r_.middleCols(first, count);
  });
  K = G - K;
  // rounding makes it unsymmetric: a half alone would not be definite where rows depend on one another
  K = (0.5 * (K + K.transpose())).eval();
  factorise(K);
  const auto lower = factor_.matrixL();
  lower.solveInPlace(G);
  w_.noalias() = G.transpose() * G;
  w_ = (0.5 * (w_ + w_.transpose())).eval();
  return w_;
}

// Rows may depend on one another, and then so may their solutions.
void Compliance::factorise(const Eigen::MatrixXd& K) {
  energy_ = K.diagonal();
  const double mean = energy_.mean();
  for (double fraction = kRegularised; fraction < 1e-2; fraction *= 10) {
    Eigen::MatrixXd regularised = K;
    regularised.diagonal().array() += mean > 0 ? fraction * mean : 1;
    factor_.compute(regularised);
    if (factor_.info() == Eigen::Success) return;
  }
  reset();
  throw NumericalError("Compliance: the system is not positive definite on the rows of the constraints");
}

}  // namespace hexaplast
