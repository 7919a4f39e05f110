// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Cholesky>
#include <span>
#include <utility>
#include <vector>

#include "hexaplast/solve/conjugate_gradients.hpp"

namespace hexaplast {

/// A row of a constraint's Jacobian: directions at nodes.
using ConstraintRow = std::vector<std::pair<int, Vec3>>;

/// f += J^T lambda. Throws InputError for another number of lambda than of rows, and for a node that f has not.
void add_constraint_force(std::span<const ConstraintRow> rows, std::span<const double> lambda, Points f);

/// What constraints feel of a system: W = J A^-1 J^T, for rows of J that are few against the nodes.
///
/// Each row of J is a right-hand side b_i. Approximate solutions X, with the residuals R = B - A X, span a space. W is
/// that of the best solutions within it:
///
///   W = G^T K^-1 G,  G = X^T B,  K = X^T A X = X^T (B - R)                                 theory.md eq. W1
///
/// Its error is of second order in those of X: residuals of a twentieth leave it wrong by about a thousandth. It is
/// positive semi-definite however large they are, and rows that depend on one another do so in W; solvers of contact
/// need both.
///
/// Each solve begins with the combination of the solutions before that is the best one in the energy norm; so contacts
/// that stay cost next to nothing.
class Compliance {
 public:
  /// tolerance: of W, about, to 1e-8 at best, 5e-8 with mixed precision; at most 1e-3. That of the solver beside it
  /// suits. Residuals of rows are |r| <= sqrt(2.5 tolerance) |b|.
  explicit Compliance(Preconditioner preconditioner = Preconditioner::kAuto, double tolerance = 1e-3);

  /// W [1/(unit of A)] for these rows, symmetric; the same bits for any number of threads. Throws InputError for a node
  /// that is not there, NumericalError where A is not positive definite on a row.
  const Eigen::MatrixXd& find(const LinearSystem& A, std::span<const ConstraintRow> rows);

  /// x near A^-1 b: the best combination of the solutions of the latest `find`, that is of forces J^T lambda the
  /// sum of theirs. False where there are none of as many nodes, and x is as before.
  bool start(ConstPoints b, Points x) const;

  int iterations() const { return iterations_; }    ///< of all solves of the latest `find`
  int num_stalled() const { return num_stalled_; }  ///< solves of them that ended above their residual

  /// As it was made.
  void reset();

 private:
  void factorise(const Eigen::MatrixXd& K);

  Preconditioner preconditioner_;
  double tolerance_;
  double residual_;                                        // |b - A x| / |b| of a row, at most
  std::vector<PreconditionedConjugateGradients> solvers_;  // one per thread
  Eigen::MatrixXd b_, x_, previous_, r_;                   // 3 num_nodes x rows
  Eigen::MatrixXd w_;
  Eigen::VectorXd energy_;              // x_i.A x_i
  Eigen::LLT<Eigen::MatrixXd> factor_;  // of K, with a little of the identity
  int iterations_ = 0, num_stalled_ = 0;
};

}  // namespace hexaplast
