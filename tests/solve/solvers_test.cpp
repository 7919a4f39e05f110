// SPDX-License-Identifier: LGPL-2.1-or-later
#include <set>

#include "support/core.hpp"

namespace hexaplast {
namespace {

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
      for (int m = 0; m < num_nodes(); ++m) {
        Mat3 block = A_.block<3, 3>(3 * n, 3 * m);
        if (beyond.size() > 0) block += beyond.block<3, 3>(3 * n, 3 * m);
        if (n == m || !block.isZero(0)) A.add(n, m, block);
      }
    }
    if (beyond.size() > 0) A.leave_out();
    for (const int dof : constrained_) A.pin(dof / 3, dof % 3);
  }
  void precondition(ConstPoints r, Points z) const override {
    // as our own systems do, it leaves out what has no diagonal
    for (int i = 0; i < A_.rows(); ++i) z(i / 3, i % 3) = A_(i, i) == 0 ? 0 : r(i / 3, i % 3) / A_(i, i);
  }

  const Eigen::MatrixXd& matrix() const { return A_; }

  Eigen::MatrixXd beyond;  ///< what the assembled matrix has, and products have not

 private:
  Eigen::MatrixXd A_;
  std::set<int> constrained_;
};

Eigen::MatrixXd random_positive(Random& random, int size) {
  const Eigen::MatrixXd B = random.matrix(size, size);
  return B * B.transpose() + Eigen::MatrixXd::Identity(size, size);
}

class Solvers : public testing::Test {
 protected:
  static constexpr int kNodes = 12;
  static constexpr int kSize = 3 * kNodes;

  Random random{121};
  const Eigen::MatrixXd A = random_positive(random, kSize);
  const PointArray b = random.field(kNodes, 1);
  const PointArray exact = unstacked(A.ldlt().solve(stacked(b)));

  double residual(const PointArray& x) const { return (stacked(b) - A * stacked(x)).norm() / b.norm(); }
};

/// Every kind of solver, new.
std::vector<std::pair<std::string, std::unique_ptr<LinearSolver>>> every_solver() {
  std::vector<std::pair<std::string, std::unique_ptr<LinearSolver>>> all;
  all.emplace_back("Cholesky", std::make_unique<CholeskySolver>());
  for (const bool warm : {false, true})
    all.emplace_back(warm ? "warm CG" : "CG",
                     std::make_unique<ConjugateGradients>(ConjugateGradientSettings{
                         .iterations = 1000, .tolerance = 1e-14, .threshold = 0, .warm_start = warm}));
  all.emplace_back("PCG", std::make_unique<PreconditionedConjugateGradients>(1e-14, 1000));
  all.emplace_back("multigrid PCG",
                   std::make_unique<PreconditionedConjugateGradients>(1e-14, 1000, Preconditioner::kMultigrid));
  return all;
}

TEST_F(Solvers, AgreeWithADenseFactorisation) {
  for (const auto& [name, solver] : every_solver()) {
    PointArray x = random.field(kNodes, 9);
    EXPECT_TRUE(solver->solve(DenseSystem(A), b, x).converged) << name;
    EXPECT_TRUE(agrees(x, exact, 1e-10)) << name;
    solver->solve(DenseSystem(A), PointArray::Zero(kNodes, 3), x);
    EXPECT_TRUE(x.isZero(0)) << name << ": nothing for nothing";
  }
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

  for (const auto& [name, solver] : every_solver()) {
    PointArray x(kNodes, 3);
    solver->solve(system, projected, x);
    EXPECT_TRUE(agrees(x, expected, 1e-10)) << name;
    for (const int dof : constrained) EXPECT_EQ(x(dof / 3, dof % 3), 0) << name;
  }
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
    SolverMemory memory;
    memory.is_first = false;  // the rules hold in full from the second solve on
    const SolveReport report = cg.solve_next(DenseSystem(A), size * b, x, memory);
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.at_threshold, report.residual > 1e-10) << size;
    return report.iterations;
  };
  EXPECT_GT(iterations_for(1e6), iterations_for(1));
  EXPECT_GT(iterations_for(1), iterations_for(1e-2));
  EXPECT_EQ(iterations_for(1e-6), 0);
}

TEST_F(Solvers, ConjugateGradientsAlwaysTakeTheFirstStepOfTheFirstSolve) {
  PointArray x(kNodes, 3);
  ConjugateGradients cg({.iterations = 1000, .tolerance = 1e-10, .threshold = 1e6});
  SolverMemory memory;
  EXPECT_EQ(cg.solve_next(DenseSystem(A), b, x, memory).iterations, 1);
  EXPECT_EQ(cg.solve_next(DenseSystem(A), b, x, memory).iterations, 0);
  EXPECT_TRUE(x.isZero(0));
  EXPECT_EQ(cg.solve(DenseSystem(A), b, x).iterations, 1) << "a solve by itself is the first";
  memory.reset();
  EXPECT_EQ(cg.solve_next(DenseSystem(A), b, x, memory).iterations, 1);

  ConjugateGradients lenient({.iterations = 1000, .tolerance = 2, .threshold = 0});
  memory.reset();
  EXPECT_EQ(lenient.solve_next(DenseSystem(A), b, x, memory).iterations, 1);
  EXPECT_EQ(lenient.solve_next(DenseSystem(A), b, x, memory).iterations, 0);
}

TEST_F(Solvers, ConjugateGradientsStartWarmWhenAsked) {
  PointArray x(kNodes, 3);
  ConjugateGradients warm({.iterations = 1000, .tolerance = 1e-10, .threshold = 0, .warm_start = true});
  SolverMemory memory;
  const int first = warm.solve_next(DenseSystem(A), b, x, memory).iterations;
  EXPECT_LE(warm.solve_next(DenseSystem(A), b, x, memory).iterations, 1);
  EXPECT_TRUE(agrees(x, exact, 1e-8));
  EXPECT_EQ(warm.solve(DenseSystem(A), b, x).iterations, first);
  memory.reset();
  EXPECT_EQ(warm.solve_next(DenseSystem(A), b, x, memory).iterations, first);
}

// What is not a number, in b, in A or in the start, must not be remembered.
TEST_F(Solvers, RecoverFromWhatIsNoNumber) {
  const PointArray nan = PointArray::Constant(kNodes, 3, NAN);
  Eigen::MatrixXd spoiled = A;
  spoiled(4, 7) = spoiled(7, 4) = NAN;
  for (const auto& [name, made] : every_solver()) {
    LinearSolver* const solver = made.get();
    PointArray x(kNodes, 3), again(kNodes, 3);
    SolverMemory memory;
    solver->solve_next(DenseSystem(A), b, x, memory);  // SOFA's rules differ in the very first solve
    solver->solve_next(DenseSystem(A), b, x, memory);
    for (const auto& trouble : std::initializer_list<std::function<void()>>{
             [&] { solver->solve_next(DenseSystem(A), nan, again, memory); },
             [&] { solver->solve_next(DenseSystem(spoiled), b, again, memory); },
             [&] {
               again = nan;
               solver->solve_from_guess(DenseSystem(A), b, again, memory);
             }}) {
      try {
        trouble();
      } catch (const NumericalError&) {
      }
      const SolveReport report = solver->solve_next(DenseSystem(A), b, again, memory);
      EXPECT_TRUE(report.converged) << name;
      EXPECT_TRUE(agrees(again, exact, 1e-8)) << name;
    }
  }
  PreconditionedConjugateGradients pcg(1e-10, 1000);
  PointArray x = nan;
  SolverMemory none;
  EXPECT_TRUE(pcg.solve_from_guess(DenseSystem(A), b, x, none).converged) << "a start that is no number is none";
  EXPECT_TRUE(agrees(x, exact, 1e-8));
}

// Neither zero nor what is no number passes for an answer.
TEST_F(Solvers, RefuseWhatIsNotFinite) {
  for (const double spoil : {static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    PointArray spoiled_b = b, answer(kNodes, 3);
    spoiled_b(5, 1) = spoil;
    EXPECT_TRUE(refuses<NumericalError>([&] { CholeskySolver().solve(DenseSystem(A), spoiled_b, answer); },
                                        {"right-hand side", "not finite"}));
    for (const auto& [row, column] : {std::pair{4, 7}, std::pair{5, 5}}) {
      Eigen::MatrixXd spoiled = A;
      spoiled(row, column) = spoiled(column, row) = spoil;
      for (const auto& [name, made] : every_solver()) {
        LinearSolver* const solver = made.get();
        PointArray x(kNodes, 3);
        EXPECT_TRUE(refuses<NumericalError>([&] { solver->solve(DenseSystem(spoiled), b, x); }, {"not finite"}))
            << name << ": " << spoil << " at " << row << ", " << column;
      }
    }
  }
}

TEST_F(Solvers, CholeskySolvesWithWhatBlocksLeaveOut) {
  DenseSystem system(A, {5, 20});
  const Eigen::MatrixXd motions = random.matrix(kSize, 6);
  system.beyond = motions * motions.transpose();
  PointArray free_b = b, x(kNodes, 3);
  free_b(1, 2) = free_b(6, 2) = 0;
  CholeskySolver cholesky;
  const SolveReport report = cholesky.solve(system, free_b, x);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_TRUE(agrees(unstacked(system.matrix() * stacked(x)), free_b, 1e-11));
  DenseSystem indefinite(-0.5 * A);
  indefinite.beyond = 1.5 * A;
  EXPECT_TRUE(refuses<NumericalError>([&] { cholesky.solve(indefinite, b, x); }, {"not positive definite"}));
  cholesky.solve(DenseSystem(A), b, x);  // and forgets what was left out
  EXPECT_TRUE(agrees(x, exact, 1e-10));
}

// What goes from one solve to the next is in the memory: two sequences through one solver do not meet.
TEST_F(Solvers, KeepNothingBesideTheMemoryOfASequence) {
  const auto all = every_solver(), others = every_solver();
  for (std::size_t k = 0; k < all.size(); ++k) {
    LinearSolver &shared = *all[k].second, &alone = *others[k].second;
    SolverMemory of_one, of_other, of_alone;
    PointArray x(kNodes, 3), y(kNodes, 3), expected(kNodes, 3);
    for (int turn = 0; turn < 3; ++turn) {
      const PointArray now = (1 + 0.1 * turn) * b;
      shared.solve_next(DenseSystem(A), now, x, of_one);
      alone.solve_next(DenseSystem(A), now, expected, of_alone);
      EXPECT_EQ(x, expected) << all[k].first << ", " << turn;
      shared.solve_next(DenseSystem(3 * A), now.colwise().reverse(), y, of_other);
    }
  }
}

// The same bits as those of a new solver, whatever was solved before.
TEST_F(Solvers, DirectOnesRememberNothingThatAResultDependsOn) {
  Eigen::MatrixXd sparse = A;  // a chain: each node with the next
  for (int n = 0; n < kNodes; ++n)
    for (int m = 0; m < kNodes; ++m)
      if (std::abs(n - m) > 1) sparse.block<3, 3>(3 * n, 3 * m).setZero();
  sparse.diagonal().array() += 30;
  Eigen::MatrixXd indefinite = A;
  indefinite(20, 20) = -1;
  const Eigen::MatrixXd smaller = A.topLeftCorner(15, 15);
  PointArray expected(kNodes, 3), x(kNodes, 3), of_smaller(5, 3);
  CholeskySolver().solve(DenseSystem(sparse), b, expected);

  CholeskySolver used;
  const std::function<void()> troubles[] = {
      [&] { used.solve(DenseSystem(A), b, x); },  // couples all nodes
      [&] {
        EXPECT_TRUE(
            refuses<NumericalError>([&] { used.solve(DenseSystem(indefinite), b, x); }, {"not positive definite"}));
      },
      [&] { used.solve(DenseSystem(2 * sparse), b, x); },
      [&] { used.solve(DenseSystem(smaller), b.topRows(5), of_smaller); }};
  for (const auto& trouble : troubles) {
    trouble();
    used.solve(DenseSystem(sparse), b, x);
    EXPECT_EQ(x, expected);
  }
  EXPECT_TRUE(agrees(of_smaller, unstacked(smaller.ldlt().solve(stacked(b.topRows(5)))), 1e-10));
}

class Definiteness : public Solvers {
 protected:
  PreconditionedConjugateGradients solver{1e-10, 1000};

  /// Eigenvalues 1 to 2 and, of the last three, `last`.
  Eigen::MatrixXd with_last(double last) const {
    const Eigen::MatrixXd Q = A.householderQr().householderQ();
    Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(kSize, 1, 2);
    eigenvalues.tail<3>().setConstant(last);
    return Q * eigenvalues.asDiagonal() * Q.transpose();
  }
};

TEST_F(Definiteness, NegativeCurvatureIsRefused) {
  PointArray x(kNodes, 3);
  for (const double last : {-2.0, -0.5, -0.01})
    EXPECT_TRUE(refuses<NumericalError>([&] { solver.solve(DenseSystem(with_last(last)), b, x); },
                                        {"not positive definite", "p.Ap = -"}))
        << last;
  EXPECT_THROW(solver.solve(DenseSystem(-A), b, x), NumericalError);
  ConjugateGradients cg({.iterations = 1000, .tolerance = 1e-14, .threshold = 0});
  EXPECT_THROW(cg.solve(DenseSystem(-A), b, x), NumericalError);
}

// b has a part outside of the range: nothing solves it, and nothing is wrong with the matrix.
TEST_F(Definiteness, ASemiDefiniteMatrixIsReportedAsNotConverged) {
  const Eigen::MatrixXd Q = A.householderQr().householderQ(), singular = with_last(0);
  const PointArray within = unstacked(singular * stacked(b)), outside = unstacked(Q.col(kSize - 1));
  PointArray x(kNodes, 3);
  EXPECT_TRUE(solver.solve(DenseSystem(singular), within, x).converged);
  EXPECT_TRUE(agrees(singular * stacked(x), stacked(within), 1e-8));

  SolveReport report;
  for (const double fraction : {1e-3, 1.0}) {
    EXPECT_NO_THROW(report = solver.solve(DenseSystem(singular), within + fraction * outside, x));
    EXPECT_FALSE(report.converged);
    EXPECT_GT(report.residual, 1e-6);
  }
  EXPECT_NO_THROW(report = solver.solve(DenseSystem(singular), outside, x));
  EXPECT_FALSE(report.converged);
  EXPECT_NO_THROW(report = solver.solve(DenseSystem(Eigen::MatrixXd::Zero(kSize, kSize)), b, x));
  EXPECT_FALSE(report.converged);
  EXPECT_TRUE(x.isZero(0));
}

TEST_F(Solvers, APreconditionerThatIsNotPositiveDefiniteIsRefused) {
  PointArray x(kNodes, 3);
  class Turned final : public LinearSystem {
   public:
    explicit Turned(const LinearSystem& A) : A_(A) {}
    int num_nodes() const override { return A_.num_nodes(); }
    void apply(ConstPoints p, Points Ap) const override { A_.apply(p, Ap); }
    void assemble(BlockMatrix& blocks) const override { A_.assemble(blocks); }
    void precondition(ConstPoints r, Points z) const override { z = -r; }

   private:
    const LinearSystem& A_;
  };
  const DenseSystem positive(A);
  EXPECT_TRUE(
      refuses<NumericalError>([&] { PreconditionedConjugateGradients(1e-10, 1000).solve(Turned(positive), b, x); },
                              {"preconditioner", "not positive definite"}));
}

}  // namespace
}  // namespace hexaplast
