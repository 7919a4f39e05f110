// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>
#include <set>

#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace hexaplast {
namespace {

using support::agrees;
using support::stacked;
using support::unstacked;

/// A full matrix as a linear system, with some degrees of freedom constrained.
class DenseSystem final : public LinearSystem {
 public:
  explicit DenseSystem(Eigen::MatrixXd A, std::set<int> constrained = {})
      : A_(std::move(A)), constrained_(std::move(constrained)) {
    for (const int dof : constrained_) {
      A_.row(dof).setZero();
      A_.col(dof).setZero();
    }
  }

  int num_nodes() const override { return static_cast<int>(A_.rows()) / 3; }
  void apply(ConstPoints p, Points Ap) const override { Ap = unstacked(A_ * stacked(p)); }
  void assemble(BlockMatrix& A) const override {
    for (int n = 0; n < num_nodes(); ++n) {
      for (int m = 0; m < num_nodes(); ++m) A.add(n, m, A_.block<3, 3>(3 * n, 3 * m));
    }
    for (const int dof : constrained_) A.pin(dof / 3, dof % 3);
  }
  void precondition(ConstPoints r, Points z) const override {
    for (int i = 0; i < A_.rows(); ++i) z(i / 3, i % 3) = constrained_.count(i) ? 0 : r(i / 3, i % 3) / A_(i, i);
  }

  const Eigen::MatrixXd& matrix() const { return A_; }

 private:
  Eigen::MatrixXd A_;
  std::set<int> constrained_;
};

Eigen::MatrixXd random_positive(support::Random& random, int size) {
  Eigen::MatrixXd B(size, size);
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) B(i, j) = random.uniform(-1, 1);
  }
  return B * B.transpose() + Eigen::MatrixXd::Identity(size, size);
}

class Solvers : public testing::Test {
 protected:
  static constexpr int kNodes = 12;
  static constexpr int kSize = 3 * kNodes;

  support::Random random{121};
  const Eigen::MatrixXd A = random_positive(random, kSize);
  const PointArray b = random.field(kNodes, 1);
  const PointArray exact = unstacked(A.ldlt().solve(stacked(b)));

  double residual(const PointArray& x) const { return (stacked(b) - A * stacked(x)).norm() / b.norm(); }
};

TEST_F(Solvers, AgreeWithADenseFactorisation) {
  const DenseSystem system(A);
  PointArray x = random.field(kNodes, 9);
  CholeskySolver cholesky;
  EXPECT_EQ(cholesky.solve(system, b, x).iterations, 1);
  EXPECT_TRUE(agrees(x, exact, 1e-10));

  x = random.field(kNodes, 9);
  ConjugateGradients cg({.iterations = 1000, .tolerance = 1e-14, .threshold = 0});
  EXPECT_TRUE(cg.solve(system, b, x).converged);
  EXPECT_TRUE(agrees(x, exact, 1e-10));

  x = random.field(kNodes, 9);
  PreconditionedConjugateGradients pcg(1e-14, 1000);
  EXPECT_TRUE(pcg.solve(system, b, x).converged);
  EXPECT_TRUE(agrees(x, exact, 1e-10));
}

// r.z / b.b without preconditioner is the square of |r| / |b|: the iterations are those of the plain method.
TEST_F(Solvers, PreconditionedBySolversTheyStopOnTheirSquaredResidual) {
  PointArray x(kNodes, 3), plain(kNodes, 3);
  SolverPreconditionedConjugateGradients squared(1e-10, 1000, nullptr);
  const SolveReport report = squared.solve(DenseSystem(A), b, x);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(residual(x), 1e-5);
  EXPECT_EQ(report.iterations, ConjugateGradients({.iterations = 1000, .tolerance = 1e-5, .threshold = 0})
                                   .solve(DenseSystem(A), b, plain)
                                   .iterations);
  EXPECT_TRUE(agrees(x, plain, 1e-12));
  EXPECT_FALSE(SolverPreconditionedConjugateGradients(1e-10, report.iterations - 1, nullptr)
                   .solve(DenseSystem(A), b, x)
                   .converged);

  CholeskySolver exactly;
  SolverPreconditionedConjugateGradients direct(1e-28, 1000, &exactly);
  EXPECT_LE(direct.solve(DenseSystem(A), b, x).iterations, 2);
  EXPECT_TRUE(agrees(x, exact, 1e-10));
  EXPECT_THROW(SolverPreconditionedConjugateGradients(1e-10, 1000, nullptr).solve(DenseSystem(-A), b, x),
               NumericalError);
}

TEST_F(Solvers, LeaveConstrainedDegreesOfFreedomAlone) {
  const std::set<int> constrained{0, 4, 20, 21, 22};
  const DenseSystem system(A, constrained);
  Eigen::MatrixXd pinned = system.matrix();
  PointArray projected = b;
  for (const int dof : constrained) {
    pinned(dof, dof) = 1;
    projected(dof / 3, dof % 3) = 0;
  }
  const PointArray expected = unstacked(pinned.ldlt().solve(stacked(projected)));

  PointArray x(kNodes, 3);
  CholeskySolver cholesky;
  cholesky.solve(system, projected, x);
  EXPECT_TRUE(agrees(x, expected, 1e-10));
  ConjugateGradients cg({.iterations = 1000, .tolerance = 1e-14, .threshold = 0});
  cg.solve(system, projected, x);
  EXPECT_TRUE(agrees(x, expected, 1e-10));
  for (const int dof : constrained) EXPECT_EQ(x(dof / 3, dof % 3), 0);
}

TEST_F(Solvers, FollowAMatrixThatChanges) {
  CholeskySolver cholesky;
  PointArray x(kNodes, 3);
  cholesky.solve(DenseSystem(A), b, x);
  cholesky.solve(DenseSystem(2 * A), b, x);  // other numbers, same pattern
  EXPECT_TRUE(agrees(x, 0.5 * exact, 1e-10));

  const Eigen::MatrixXd smaller = A.topLeftCorner(15, 15);  // another size
  PointArray y(5, 3);
  cholesky.solve(DenseSystem(smaller), b.topRows(5), y);
  EXPECT_TRUE(agrees(y, unstacked(smaller.ldlt().solve(stacked(b.topRows(5)))), 1e-10));

  cholesky.reset();
  cholesky.solve(DenseSystem(A), b, x);
  EXPECT_TRUE(agrees(x, exact, 1e-10));
}

TEST_F(Solvers, CholeskyRefusesAnIndefiniteMatrix) {
  Eigen::MatrixXd indefinite = A;
  indefinite(20, 20) = -1;
  PointArray x(kNodes, 3);
  CholeskySolver cholesky;
  EXPECT_TRUE(support::refuses<NumericalError>([&] { cholesky.solve(DenseSystem(indefinite), b, x); },
                                               {"not positive definite"}));
  cholesky.solve(DenseSystem(A), b, x);  // and recovers
  EXPECT_TRUE(agrees(x, exact, 1e-10));
}

TEST_F(Solvers, ConjugateGradientsRefuseAnIndefiniteMatrix) {
  PointArray x(kNodes, 3);
  ConjugateGradients cg({.iterations = 1000, .tolerance = 1e-14, .threshold = 0});
  EXPECT_THROW(cg.solve(DenseSystem(-A), b, x), NumericalError);
}

TEST_F(Solvers, ConjugateGradientsStopAsSoonAsTheRelativeResidualIsReached) {
  for (const double tolerance : {1e-2, 1e-5, 1e-8}) {
    PointArray x(kNodes, 3), shorter(kNodes, 3);
    ConjugateGradients cg({.iterations = 1000, .tolerance = tolerance, .threshold = 0});
    const SolveReport report = cg.solve(DenseSystem(A), b, x);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(residual(x), 1.001 * tolerance);
    EXPECT_NEAR(report.residual, residual(x), 1e-3 * tolerance + 1e-12);

    ConjugateGradients limited({.iterations = report.iterations - 1, .tolerance = tolerance, .threshold = 0});
    const SolveReport cut = limited.solve(DenseSystem(A), b, shorter);
    EXPECT_FALSE(cut.converged);
    EXPECT_EQ(cut.iterations, report.iterations - 1);
    EXPECT_GT(residual(shorter), tolerance);
  }
}

// |r| / |b| does not feel the size of b; p.Ap, which is compared with the threshold, grows with its square.
TEST_F(Solvers, ConjugateGradientsCompareTheCurvatureWithAnAbsoluteThreshold) {
  const auto iterations_for = [&](double size) {
    PointArray x(kNodes, 3);
    ConjugateGradients cg({.iterations = 1000, .tolerance = 1e-10, .threshold = 1e-5});
    cg.solve(DenseSystem(A), b, x);  // the rules hold in full from the second solve on
    const SolveReport report = cg.solve(DenseSystem(A), size * b, x);
    EXPECT_TRUE(report.converged);
    return report.iterations;
  };
  EXPECT_GT(iterations_for(1e6), iterations_for(1));
  EXPECT_GT(iterations_for(1), iterations_for(1e-2));
  EXPECT_EQ(iterations_for(1e-6), 0);
}

TEST_F(Solvers, ConjugateGradientsAlwaysTakeTheFirstStepOfTheFirstSolve) {
  PointArray x(kNodes, 3);
  ConjugateGradients cg({.iterations = 1000, .tolerance = 1e-10, .threshold = 1e6});
  EXPECT_EQ(cg.solve(DenseSystem(A), b, x).iterations, 1);
  EXPECT_EQ(cg.solve(DenseSystem(A), b, x).iterations, 0);
  EXPECT_TRUE(x.isZero(0));
  cg.reset();
  EXPECT_EQ(cg.solve(DenseSystem(A), b, x).iterations, 1);

  ConjugateGradients lenient({.iterations = 1000, .tolerance = 2, .threshold = 0});
  EXPECT_EQ(lenient.solve(DenseSystem(A), b, x).iterations, 1);
  EXPECT_EQ(lenient.solve(DenseSystem(A), b, x).iterations, 0);
}

TEST_F(Solvers, ConjugateGradientsStartWarmWhenAsked) {
  PointArray x(kNodes, 3);
  ConjugateGradients warm({.iterations = 1000, .tolerance = 1e-10, .threshold = 0, .warm_start = true});
  const int first = warm.solve(DenseSystem(A), b, x).iterations;
  EXPECT_LE(warm.solve(DenseSystem(A), b, x).iterations, 1);
  EXPECT_TRUE(agrees(x, exact, 1e-8));
  warm.reset();
  EXPECT_EQ(warm.solve(DenseSystem(A), b, x).iterations, first);
}

TEST_F(Solvers, AnswerNothingWithNothing) {
  const PointArray zero = PointArray::Zero(kNodes, 3);
  PointArray x = b;
  ConjugateGradients({.iterations = 10}).solve(DenseSystem(A), zero, x);
  EXPECT_TRUE(x.isZero(0));
  x = b;
  PreconditionedConjugateGradients(1e-10, 10).solve(DenseSystem(A), zero, x);
  EXPECT_TRUE(x.isZero(0));
  x = b;
  SolverPreconditionedConjugateGradients(1e-10, 10, nullptr).solve(DenseSystem(A), zero, x);
  EXPECT_TRUE(x.isZero(0));
  x = b;
  CholeskySolver().solve(DenseSystem(A), zero, x);
  EXPECT_TRUE(x.isZero(0));
}

}  // namespace
}  // namespace hexaplast
