// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/preconditioners.hpp"

#include <gtest/gtest.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "solve/minres.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace hexaplast {
namespace {

using support::stacked;
using support::unstacked;

/// A full matrix as a linear system.
class FullSystem final : public LinearSystem {
 public:
  explicit FullSystem(Eigen::MatrixXd A) : A_(std::move(A)) {}
  int num_nodes() const override { return static_cast<int>(A_.rows()) / 3; }
  void apply(ConstPoints p, Points Ap) const override { Ap = unstacked(A_ * stacked(p)); }
  void assemble(BlockMatrix& A) const override {
    for (int n = 0; n < num_nodes(); ++n)
      for (int m = 0; m < num_nodes(); ++m) A.add(n, m, A_.block<3, 3>(3 * n, 3 * m));
  }
  const Eigen::MatrixXd& matrix() const { return A_; }

 private:
  Eigen::MatrixXd A_;
};

/// Symmetric, with the given eigenvalues.
Eigen::MatrixXd symmetric(const Eigen::VectorXd& eigenvalues) {
  const Eigen::Index size = eigenvalues.size();
  support::Random random(11);
  const Eigen::MatrixXd any =
      Eigen::Map<const Eigen::MatrixXd>(random.field(static_cast<int>(size * size), 1).data(), size, size);
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(any).householderQ();
  return Q * eigenvalues.asDiagonal() * Q.transpose();
}

const Eigen::VectorXd kPositive = Eigen::VectorXd::LinSpaced(15, 1, 40);

PointArray right_hand_side() { return support::Random(5).field(5, 1); }

// Against the matrices that the names stand for.
TEST(MatrixPartSolver, SolvesWithItsPart) {
  const FullSystem A(symmetric(kPositive));
  const Eigen::MatrixXd& M = A.matrix();
  const double w = 1.3;
  Eigen::MatrixXd D = M.diagonal().asDiagonal(), blocks = Eigen::MatrixXd::Zero(15, 15),
                  L = M.triangularView<Eigen::StrictlyLower>();
  for (int n = 0; n < 5; ++n) blocks.block<3, 3>(3 * n, 3 * n) = M.block<3, 3>(3 * n, 3 * n);
  const Eigen::MatrixXd sweep = (D / w + L.transpose()) * (D / w).inverse() * (D / w + L) / (2 - w);
  const PointArray b = right_hand_side();
  PointArray x(5, 3);
  for (const auto& [part, expected] : {std::pair<MatrixPart, const Eigen::MatrixXd&>{MatrixPart::kDiagonal, D},
                                       {MatrixPart::kDiagonalBlocks, blocks},
                                       {MatrixPart::kSymmetricSweep, sweep}}) {
    MatrixPartSolver solver(part, w);
    solver.solve(A, b, x);
    EXPECT_LT((expected * stacked(x) - stacked(b)).norm(), 1e-12) << static_cast<int>(part);
  }
}

TEST(MatrixPartSolver, PreconditionsToTheSameAnswerInFewerIterations) {
  Eigen::MatrixXd scaled = symmetric(kPositive);
  for (int i = 0; i < 15; ++i) {  // badly scaled, as nodes of small and large mass are
    const double s = i / 3 % 2 ? 30 : 1;
    scaled.row(i) *= s;
    scaled.col(i) *= s;
  }
  const FullSystem A(scaled);
  const PointArray b = right_hand_side();
  const Eigen::VectorXd exact = scaled.ldlt().solve(stacked(b));
  const auto iterations = [&](LinearSolver* preconditioner) {
    SolverPreconditionedConjugateGradients solver(1e-22, 1000, preconditioner, PreconditionedBy::kDiagonal);
    PointArray x(5, 3);
    const SolveReport report = solver.solve(A, b, x);
    EXPECT_TRUE(report.converged);
    EXPECT_LT((stacked(x) - exact).norm(), 1e-8 * exact.norm());
    EXPECT_EQ(report.preconditioner, preconditioner ? PreconditionedBy::kDiagonal : PreconditionedBy::kNothing);
    return report.iterations;
  };
  const int without = iterations(nullptr);
  for (const MatrixPart part : {MatrixPart::kDiagonal, MatrixPart::kDiagonalBlocks, MatrixPart::kSymmetricSweep}) {
    MatrixPartSolver preconditioner(part);
    EXPECT_LT(iterations(&preconditioner), without) << static_cast<int>(part);
  }
}

TEST(MatrixPartSolver, RefusesADiagonalThatIsNotPositive) {
  Eigen::MatrixXd M = symmetric(kPositive);
  M(7, 7) = 0;
  const FullSystem A(M);
  const PointArray b = right_hand_side();
  PointArray x(5, 3);
  MatrixPartSolver solver(MatrixPart::kDiagonal);
  EXPECT_THROW(solver.solve(A, b, x), NumericalError);
  EXPECT_THROW(MatrixPartSolver(MatrixPart::kDiagonal).solve_again(A, b, x), InputError);
}

TEST(MinimumResiduals, SolvesDefiniteAndIndefiniteSystems) {
  Eigen::VectorXd mixed = kPositive;
  mixed.head<6>() *= -1;
  for (const Eigen::VectorXd& eigenvalues : {kPositive, mixed}) {
    const FullSystem A(symmetric(eigenvalues));
    const PointArray b = right_hand_side();
    PointArray x(5, 3);
    MinimumResiduals solver(1e-14, 100);
    const SolveReport report = solver.solve(A, b, x);
    EXPECT_LT((A.matrix() * stacked(x) - stacked(b)).norm(), 1e-11);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.iterations, 20);
  }
}

// After k iterations the residual is the smallest of all vectors of the Krylov space b, A b, ..., A^(k-1) b.
TEST(MinimumResiduals, HasTheLeastResidualOfItsKrylovSpace) {
  Eigen::VectorXd mixed = kPositive / 10;
  mixed.head<6>() *= -1;
  const FullSystem A(symmetric(mixed));
  const PointArray b = right_hand_side();
  for (const int k : {1, 2, 5}) {
    Eigen::MatrixXd images(15, k);
    Eigen::VectorXd power = stacked(b);
    for (int i = 0; i < k; ++i) images.col(i) = power = A.matrix() * power;
    const Eigen::VectorXd min = stacked(b) - images * images.colPivHouseholderQr().solve(stacked(b));
    PointArray x(5, 3);
    const SolveReport report = MinimumResiduals(0, k).solve(A, b, x);
    EXPECT_EQ(report.iterations, k);
    EXPECT_FALSE(report.converged);
    EXPECT_NEAR((stacked(b) - A.matrix() * stacked(x)).norm(), min.norm(), 1e-10);
    EXPECT_NEAR(report.residual, min.norm() / stacked(b).norm(), 1e-10);
  }
}

// As SOFA's: the same system again costs nothing.
TEST(SolverMemory, LetsTheNextSolveBeginAtTheSolutionBefore) {
  const FullSystem A(symmetric(kPositive));
  const PointArray b = right_hand_side();
  SolverPreconditionedConjugateGradients cg(1e-24, 100, nullptr);
  MinimumResiduals minres(1e-12, 100);
  for (LinearSolver* solver : {static_cast<LinearSolver*>(&cg), static_cast<LinearSolver*>(&minres)}) {
    SolverMemory memory;
    PointArray x(5, 3), again(5, 3), fresh(5, 3);
    EXPECT_GT(solver->solve_next(A, b, x, memory).iterations, 5);
    EXPECT_LE(solver->solve_next(A, b, again, memory).iterations, 1);
    EXPECT_LT(support::max_abs(again - x), 1e-12);
    solver->solve(A, b, fresh);
    EXPECT_EQ(fresh, x) << "a solve by itself has no memory";
  }
}

TEST(MinimumResiduals, EndsAtOnceWhereThereIsLittleToDo) {
  const FullSystem A(3 * Eigen::MatrixXd::Identity(15, 15));
  const PointArray b = right_hand_side();
  PointArray x(5, 3);
  EXPECT_EQ(MinimumResiduals(1e-9, 100).solve(A, b, x).iterations, 1);
  EXPECT_LT(support::max_abs(x - b / 3), 1e-15);
  EXPECT_EQ(MinimumResiduals(1e-9, 100).solve(A, PointArray::Zero(5, 3), x).iterations, 0);
  EXPECT_EQ(support::max_abs(x), 0);
  PointArray broken = b;
  broken(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MinimumResiduals(1e-9, 100).solve(A, broken, x), NumericalError);
}

}  // namespace
}  // namespace hexaplast
