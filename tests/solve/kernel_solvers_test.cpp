// SPDX-License-Identifier: LGPL-2.1-or-later
#include <optional>

#include "hexaplast/solve/newton_raphson.hpp"
#include "layout/chunked_operator.hpp"
#include "solve/constrained_operator.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

/// m M + k K of a body, as the kernels see it.
class BodySystem final : public LinearSystem {
 public:
  BodySystem(const LoadedBody& body, const OperatorFactors& factors)
      : constraints_(constraints_of(body)), A_(body, factors, constraints_) {}
  int num_nodes() const override { return A_.num_nodes(); }
  void apply(ConstPoints p, Points Ap) const override { A_.apply(p, Ap); }
  void assemble(BlockMatrix& A) const override { A_.assemble(A); }
  bool matrix_free(MatrixFreeSystem& system) const override { return A_.matrix_free(system); }

 private:
  Constraints constraints_;
  ConstrainedOperator A_;
};

class KernelSolvers : public testing::TestWithParam<std::pair<Precision, Preconditioner>> {
 protected:
  KernelSolvers() {
    body.linearize(X);
    constraints_of(held).project(b);
  }

  static constexpr int kNodes = 9 * 9 * 9;  // large enough for coarse meshes
  Body body{block({8, 8, 8}, 0.1), {Material{}}, {.precision = GetParam().first}};
  PreconditionedConjugateGradients solver{1e-7, 2000, GetParam().second};
  const PointArray X = body.mesh().positions();
  const LoadedBody held{body, std::vector<double>(kNodes, 0.1), {0, 1, 2, 3, 40}, {}};
  const BodySystem A{held, {.mass = 1, .stiffness = -1e-2}};
  PointArray b = Random(8).field(kNodes, 1);
};

// The operator of a mixed body has coefficients in half precision: what it leaves is not what the system leaves.
TEST(ConjugateGradients, ReportTheTrueResidualOfAMixedBody) {
  const HexMesh mesh = block({6, 6, 6}, 0.1);
  const PointArray x = mesh.positions() + Random(31).field(mesh.num_nodes(), 0.01);
  Body exact(mesh, {Material{}}), mixed(mesh, {Material{}}, {.precision = Precision::kMixed});
  exact.linearize(x);
  mixed.linearize(x);
  const std::vector<double> mass(mesh.num_nodes(), 0.1);
  const LoadedBody in_double(exact, mass, {0, 1, 2}, {}), in_single(mixed, mass, {0, 1, 2}, {});
  const OperatorFactors factors{.mass = 1, .stiffness = -1e-2};
  PointArray b = Random(32).field(mesh.num_nodes(), 1), answer(mesh.num_nodes(), 3), product = answer;
  constraints_of(in_double).project(b);
  for (const double tolerance : {1e-2, 1e-7}) {
    ConjugateGradients cg({.iterations = 2000, .tolerance = tolerance, .threshold = 0});
    const SolveReport report = cg.solve(BodySystem(in_single, factors), b, answer);
    BodySystem(in_double, factors).apply(answer, product);
    const double left = (b - product).norm() / b.norm();
    EXPECT_NEAR(report.residual / left, 1, 1e-6);
    EXPECT_EQ(report.converged, left <= tolerance);
    EXPECT_EQ(report.converged, tolerance == 1e-2) << "the case is to leave more than its tolerance";
  }
}

// Rounding of the stiffness, which such a body does not feel, is far above the forces that it feels. To 1 % some steps
// may leave the weight out: theory.md section 9.5, limits.
TEST(MixedPrecision, LetsStiffBodiesFallAsTheyMust) {
  for (const auto& [young_modulus, density] : {std::pair{1e11, 7800.0}, {2e11, 7800.0}, {7e10, 2700.0}})
    for (const Preconditioner preconditioner : {Preconditioner::kMultigrid, Preconditioner::kDiagonal}) {
      Body bar(block({3, 3, 10}, 0.01), {Material{.young_modulus = young_modulus, .poisson_ratio = 0.3}},
               {.precision = Precision::kMixed});
      MovingBody falling(std::move(bar), {.density = density, .dt = 0.01, .gravity = {0, 0, -9.81}},
                         std::make_unique<PreconditionedConjugateGradients>(1e-3, 500, preconditioner));
      const RunReport report = falling.run(20);
      EXPECT_NEAR(falling.velocities.col(2).mean(), -9.81 * 0.2, 0.02 * 9.81 * 0.2) << young_modulus;
      EXPECT_TRUE(report.solve.converged);
    }
}

// A cycle whose smoother takes the spectrum for a fifth of what it is. (Cycles subtract products, and the estimate adds
// them.)
TEST_P(KernelSolvers, ACycleThatIsNotPositiveDefiniteGivesWayToTheDiagonal) {
  class Growing final : public ChunkedOperator<float> {
   public:
    Growing(const ChunkedOperator<float>& op, const bool& has_grown) : op_(op), has_grown_(has_grown) {}
    const Partition& partition() const override { return op_.partition(); }
    void add_product(int chunk, float factor, const float* p, float* Ap) const override {
      op_.add_product(chunk, has_grown_ && factor < 0 ? 5 * factor : factor, p, Ap);
    }
    void add_diagonal(int chunk, float factor, float* diagonal) const override {
      op_.add_diagonal(chunk, factor, diagonal);
    }

   private:
    const ChunkedOperator<float>& op_;
    const bool& has_grown_;
  };
  class WithGrowingCycle final : public LinearSystem {
   public:
    explicit WithGrowingCycle(const BodySystem& A) : A_(A) {}
    int num_nodes() const override { return A_.num_nodes(); }
    void apply(ConstPoints p, Points Ap) const override { A_.apply(p, Ap); }
    void assemble(BlockMatrix& blocks) const override { A_.assemble(blocks); }
    bool matrix_free(MatrixFreeSystem& described) const override {
      A_.matrix_free(described);
      KernelBody& one = described.bodies.front();
      levels_.assign(one.levels.begin(), one.levels.end());
      if (!levels_.empty()) levels_.front().op = &cycle_.emplace(*levels_.front().op, has_grown);
      one.levels = levels_;
      return true;
    }
    bool has_grown = false;

   private:
    const BodySystem& A_;
    mutable std::optional<Growing> cycle_;
    mutable std::vector<LevelOperator> levels_;
  };
  WithGrowingCycle indefinite(A);
  PointArray x(kNodes, 3), expected(kNodes, 3), product(kNodes, 3);
  ASSERT_TRUE(PreconditionedConjugateGradients(1e-9, 2000).solve(A, b, expected).converged);

  const PreconditionedBy at_first =
      GetParam().second == Preconditioner::kMultigrid ? PreconditionedBy::kMultigrid : PreconditionedBy::kDiagonal;
  EXPECT_EQ(solver.solve(indefinite, b, x).preconditioner, at_first);
  indefinite.has_grown = true;
  const SolveReport report = solver.solve(indefinite, b, x);
  EXPECT_EQ(report.preconditioner, PreconditionedBy::kDiagonal);
  EXPECT_TRUE(report.converged);
  A.apply(x, product);
  const double left = (b - product).norm() / b.norm();
  EXPECT_NEAR(report.residual, left, GetParam().first == Precision::kMixed ? 1e-3 : 1e-9);
  EXPECT_LT((x - expected).norm(), (GetParam().first == Precision::kMixed ? 1e-2 : 1e-5) * expected.norm());

  // to the same bits again, by any number of threads; and the next system has its cycle
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    PointArray again(kNodes, 3);
    solver.solve(indefinite, b, again);
    EXPECT_EQ(again, x) << threads;
  }
  set_num_threads(1);
  EXPECT_EQ(solver.solve(A, b, x).preconditioner, at_first);
}

TEST_P(KernelSolvers, RecoverFromWhatIsNoNumber) {
  PointArray before(kNodes, 3), after(kNodes, 3), spoiled = X;
  ASSERT_TRUE(solver.solve(A, b, before).converged);

  spoiled(300, 1) = NAN;
  body.linearize(spoiled);
  EXPECT_TRUE(refuses<NumericalError>([&] { solver.solve(A, b, after); }, {"not finite"}));
  body.linearize(X);
  EXPECT_TRUE(solver.solve(A, b, after).converged);
  EXPECT_EQ(after, before);
  after.setConstant(NAN);
  SolverMemory none;
  EXPECT_TRUE(solver.solve_from_guess(A, b, after, none).converged) << "a start that is no number is none";
}

// Squares of what is far from 1 are beyond single precision: the same bits, times the power of two.
TEST_P(KernelSolvers, DoNotFeelTheSizeOfTheRightHandSide) {
  PointArray x(kNodes, 3), of_scaled(kNodes, 3);
  const SolveReport report = solver.solve(A, b, x);
  ASSERT_TRUE(report.converged);
  for (const int power : {-400, -150, -83, -1, 1, 66, 150, 400}) {
    const double scale = std::ldexp(1.0, power);
    const SolveReport scaled = solver.solve(A, scale * b, of_scaled);
    EXPECT_TRUE(scaled.converged) << power;
    EXPECT_EQ(scaled.iterations, report.iterations) << power;
    EXPECT_EQ(scaled.residual, report.residual) << power;
    EXPECT_EQ(of_scaled, scale * x) << power;
    of_scaled = scale * x;
    SolverMemory none;
    of_scaled(300, 1) *= 1.1;
    EXPECT_TRUE(solver.solve_from_guess(A, scale * b, of_scaled, none).converged) << power;
  }
}

// A body that nothing holds, and no mass: rigid motions cost nothing.
TEST_P(KernelSolvers, TakeABodyThatIsNotHeldForSemiDefinite) {
  LoadedBody system(body, std::vector<double>(kNodes, 0), {}, {});
  const BodySystem K(system, {.mass = 0, .stiffness = -1});
  PointArray pull = PointArray::Zero(kNodes, 3), x(kNodes, 3);
  pull.topRows(81).col(2).array() = -1;
  pull.bottomRows(81).col(2).array() = 1;
  EXPECT_TRUE(solver.solve(K, pull, x).converged) << "in equilibrium with itself";

  const PointArray weight = PointArray::Constant(kNodes, 3, 0.1);
  for (const PointArray& load : {weight, PointArray(pull + weight), PointArray(pull + 1e-4 * weight)}) {
    SolveReport report;
    EXPECT_NO_THROW(report = solver.solve(K, load, x));
    EXPECT_FALSE(report.converged);
    EXPECT_LT(report.iterations, 300) << "goes on along what rounding makes of nothing";
  }

  // D^-1 b is a rigid motion: the very first direction is one
  const Eigen::VectorXd volumes = nodal_volumes(X, body.mesh().hexahedra());
  for (int n = 0; n < kNodes; ++n) b.row(n) = Eigen::RowVector3d(0, 0, -1e-3 * volumes[n] / volumes[0]);
  const SolveReport report = solver.solve(K, b, x);
  EXPECT_FALSE(report.converged);
  EXPECT_LT(report.iterations, 20);
}

// Bending of a long bar is what comes nearest to no stiffness at all: 1e-7 of the stiffest direction, and sound.
TEST_P(KernelSolvers, TakeTheBendingOfALongBarForStiffness) {
  Body bar(regular_grid({100, 2, 2}, Vec3::Zero(), Vec3(1, 0.02, 0.02)), {Material{}}, {.precision = GetParam().first});
  const PointArray rest = bar.mesh().positions();
  LoadedBody system(bar, std::vector<double>(rest.rows(), 0), nodes_at(bar.mesh(), 0, 0), {});
  bar.linearize(rest);
  PointArray load = PointArray::Zero(rest.rows(), 3), x(rest.rows(), 3);
  load.col(2).setConstant(-1e-6);
  constraints_of(system).project(load);
  PreconditionedConjugateGradients patient(1e-6, 20000, GetParam().second);
  EXPECT_TRUE(patient.solve(BodySystem(system, {.mass = 0, .stiffness = -1}), load, x).converged);
}

// Stiffness of the wrong sign beside a mass: the diagonal is positive, the matrix is not.
TEST_P(KernelSolvers, RefuseNegativeCurvature) {
  LoadedBody system(body, std::vector<double>(kNodes, 1), {}, {});
  BlockMatrix K(kNodes);
  body.add_stiffness_blocks(-1, K);
  double greatest = 0;
  for (int n = 0; n < kNodes; ++n)
    for (const BlockMatrix::Entry& entry : K.row(n))
      if (entry.column == n) greatest = std::max(greatest, entry.block.diagonal().maxCoeff());
  const BodySystem indefinite(system, {.mass = 1, .stiffness = 0.7 / greatest});
  PointArray x(kNodes, 3);
  EXPECT_TRUE(refuses<NumericalError>([&] { solver.solve(indefinite, b, x); }, {"not positive definite"}));
}

/// Nodes that keep to planes, which are those of no axis.
class OnObliquePlane final : public LoadedBody {
  struct Planes final : hexaplast::Projector {
    Planes(const Vec3& along, std::vector<int> of) : normal(along.normalized().transpose()), nodes(std::move(of)) {}
    void project(Points field) const override {
      for (const int n : nodes) field.row(n) -= field.row(n).dot(normal) * normal;
    }
    Eigen::RowVector3d normal;
    std::vector<int> nodes;
  };

 public:
  OnObliquePlane(Body& body, const std::vector<double>& mass, const Vec3& normal, std::vector<int> nodes)
      : LoadedBody(body, mass, {},
                   [mass](double, ConstPoints, Points f) {
                     for (Eigen::Index n = 0; n < f.rows(); ++n) f.row(n) += mass[n] * Eigen::RowVector3d(9.81, 3, -5);
                   }),
        planes_(normal, std::move(nodes)) {}
  void constrain(Constraints& constraints) const override { constraints.projector = &planes_; }
  /// How far they are from where their planes began.
  double distance(const PointArray& moved) const {
    double max = 0;
    for (const int n : planes_.nodes) max = std::max(max, std::abs(moved.row(n).dot(planes_.normal)));
    return max;
  }

 private:
  Planes planes_;
};

// A vector of ones does not see a plane of which it is a direction.
TEST(ImplicitEuler, KeepsNodesOnObliquePlanesOfASystemOfOnesOwn) {
  for (const Vec3& normal : {Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(1, 1, -2), Vec3(0, 0.6, 0.8)})
    for (const Precision precision : {Precision::kDouble, Precision::kMixed})
      for (const Preconditioner preconditioner : {Preconditioner::kMultigrid, Preconditioner::kDiagonal}) {
        Body body(block({8, 8, 8}, 0.01), {Material{.young_modulus = 1e5, .poisson_ratio = 0.3}},
                  {.precision = precision});
        const PointArray rest = body.mesh().positions();
        OnObliquePlane system(body, lumped_masses(body, 1000), normal, nodes_at(body.mesh(), 0, 0));
        PreconditionedConjugateGradients solver(1e-8, 2000, preconditioner);
        ConjugateGradients plain({.iterations = 5000, .tolerance = 1e-12, .threshold = 0});
        PointArray x = rest, by_plain = rest, v = PointArray::Zero(rest.rows(), 3), v_plain = v;
        for (int step = 0; step < 3; ++step) {
          EXPECT_TRUE(ImplicitEuler({}).step(system, solver, 0, 0.01, x, v).converged);
          ImplicitEuler({}).step(system, plain, 0, 0.01, by_plain, v_plain);
        }
        EXPECT_GT((x - rest).norm(), 1e-3);
        EXPECT_LE(system.distance(x - rest), 1e-12);
        EXPECT_TRUE(agrees(x - rest, by_plain - rest, precision == Precision::kDouble ? 1e-6 : 1e-2));
      }
}

NodalLoad weight(const std::vector<double>& mass) {
  return [&mass](double, ConstPoints, Points f) {
    for (Eigen::Index n = 0; n < f.rows(); ++n) f(n, 2) -= 9.81 * mass[n];
  };
}

// Coarse meshes feel a plane of held nodes between their own.
TEST(NewtonRaphson, TakesFewIterationsOfMultigridWhereverNodesAreHeld) {
  for (const int plane : {0, 1, 2, 3, 4, 7}) {
    Body body(block({16, 16, 16}, 0.01), {Material{.young_modulus = 1e5, .poisson_ratio = 0.3}}, {});
    PointArray x = body.mesh().positions();
    const std::vector<double> mass = lumped_masses(body, 1000);
    LoadedBody system(body, mass, nodes_at(body.mesh(), 0, 0.01 * plane), weight(mass));
    PreconditionedConjugateGradients solver(1e-6, 1000, Preconditioner::kMultigrid);
    EXPECT_LE(NewtonRaphson({.iterations = 1}).solve(system, solver, 0, x).linear_iterations, 14) << plane;
  }
}

// Nothing holds the body, or half of it: there is no equilibrium, however small a step becomes beside where it began.
TEST(NewtonRaphson, FindsNoEquilibriumOfWhatNothingHolds) {
  for (const bool is_half_held : {false, true})
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      std::vector<std::pair<std::string, std::unique_ptr<LinearSolver>>> solvers;
      solvers.emplace_back("diagonal", std::make_unique<PreconditionedConjugateGradients>(1e-6, 500));
      solvers.emplace_back("multigrid",
                           std::make_unique<PreconditionedConjugateGradients>(1e-6, 500, Preconditioner::kMultigrid));
      solvers.emplace_back("CG", std::make_unique<ConjugateGradients>(ConjugateGradientSettings{
                                     .iterations = 500, .tolerance = 1e-6, .threshold = 1e-12}));
      for (const auto& [name, solver] : solvers) {
        Body body(block({6, 6, 6}, 0.01), {Material{.young_modulus = 1e5, .poisson_ratio = 0.3}},
                  {.precision = precision});
        const PointArray rest = body.mesh().positions();
        std::vector<int> removed, held;
        for (int e = 108; is_half_held && e < 144; ++e) removed.push_back(e);
        body.remove(removed);
        for (int n = 0; is_half_held && n < 49; ++n) held.push_back(n);
        const std::vector<double> mass = lumped_masses(body, 1000);
        LoadedBody system(body, mass, held, weight(mass));
        NewtonRaphson newton({.iterations = 5, .relative_estimate = 1e-6, .absolute_estimate = 1e-6});
        PointArray x = rest;
        try {
          EXPECT_EQ(newton.solve(system, *solver, 0, x).status, NewtonStatus::kNotConverged)
              << name << (is_half_held ? ", half" : ", all");
          if (name == "diagonal" || name == "multigrid") {
            EXPECT_TRUE(agrees(x, rest, 1)) << name;
          }
        } catch (const NumericalError&) {  // says so too
        }
      }
    }
}

INSTANTIATE_TEST_SUITE_P(InEachForm, KernelSolvers,
                         testing::Values(std::pair(Precision::kDouble, Preconditioner::kDiagonal),
                                         std::pair(Precision::kDouble, Preconditioner::kMultigrid),
                                         std::pair(Precision::kMixed, Preconditioner::kDiagonal),
                                         std::pair(Precision::kMixed, Preconditioner::kMultigrid)));

}  // namespace
}  // namespace hexaplast
