// SPDX-License-Identifier: LGPL-2.1-or-later
// W = J A^-1 J^T of frictional contacts against the same by a factorisation of A.
#include "hexaplast/solve/compliance.hpp"

#include <Eigen/SparseCholesky>

#include "hexaplast/base/block_matrix.hpp"
#include "support/core.hpp"
#include "support/slab.hpp"

namespace hexaplast {
namespace {

/// Contacts in faces of the top, moved by a fraction of an edge: a normal and two tangents each, over four nodes.
std::vector<ConstraintRow> contacts(const Slab& slab, int count, double fraction, unsigned seed = 3) {
  Random random(seed);
  std::vector<ConstraintRow> rows;
  for (int k = 0; k < count; ++k) {
    const int i = 3 + (k * 5) % 12, j = 1 + (k * 3) % 14;
    const double s = fraction, t = 0.3;
    const auto node = [&](int di, int dj) { return i + di + 17 * (j + dj + 17 * 4); };
    const double weights[] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    const int nodes[] = {node(0, 0), node(1, 0), node(0, 1), node(1, 1)};
    const Vec3 normal = Vec3(0.1 * k / count, -0.05, 1).normalized(), first = normal.cross(Vec3::UnitX()).normalized();
    for (const Vec3& direction : {normal, first, Vec3(normal.cross(first))}) {
      ConstraintRow& row = rows.emplace_back();
      for (int a = 0; a < 4; ++a) row.emplace_back(nodes[a], weights[a] * direction);
    }
  }
  EXPECT_LT(rows.back().back().first, slab.num_nodes());
  return rows;
}

PointArray transposed(const Slab& slab, const std::vector<ConstraintRow>& rows, const Eigen::VectorXd& lambda) {
  PointArray f = PointArray::Zero(slab.num_nodes(), 3);
  add_constraint_force(rows, {lambda.data(), rows.size()}, f);
  return f;
}

Eigen::MatrixXd factorised(const Slab& slab, const std::vector<ConstraintRow>& rows) {
  BlockMatrix A(slab.num_nodes());
  slab.assemble(A);
  std::vector<Eigen::Triplet<double>> entries;
  for (int n = 0; n < slab.num_nodes(); ++n)
    for (const BlockMatrix::Entry& entry : A.row(n))
      for (int k = 0; k < 9; ++k)
        entries.emplace_back(3 * n + k / 3, 3 * entry.column + k % 3, entry.block(k / 3, k % 3));
  Eigen::SparseMatrix<double> matrix(3 * slab.num_nodes(), 3 * slab.num_nodes());
  matrix.setFromTriplets(entries.begin(), entries.end());

  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd J(matrix.rows(), count);
  for (Eigen::Index j = 0; j < count; ++j) {
    PointArray b = transposed(slab, rows, Eigen::VectorXd::Unit(count, j));
    slab.project(b);
    J.col(j) = Eigen::Map<const Eigen::VectorXd>(b.data(), b.size());
  }
  return J.transpose() * Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(J);
}

struct SystemCase {
  const char* name;
  double young_modulus;
  Precision precision;
  Preconditioner preconditioner;
  double spring;
  int num_bodies = 1;
};

class ComplianceOf : public testing::TestWithParam<SystemCase> {};

TEST_P(ComplianceOf, ContactsIsThatOfAFactorisation) {
  Slab slab(slab_mesh());
  const int num_elements = slab.mesh.num_elements(), of_first = num_elements / GetParam().num_bodies;
  slab.add_body(0, of_first, GetParam().young_modulus, GetParam().precision);
  if (of_first < num_elements)  // of other hexahedra on the same nodes
    slab.add_body(of_first, num_elements, GetParam().young_modulus / 100, GetParam().precision);
  // deformed: coefficients of a body at rest are exact even in half precision
  const PointArray x = slab.mesh.positions() + Random(11).field(slab.num_nodes(), 1e-3);
  for (Body& body : slab.bodies) body.linearize(x);
  if (GetParam().spring > 0) slab.ties.add(200, 200, GetParam().spring * Mat3::Identity());
  const std::vector<ConstraintRow> rows = contacts(slab, 20, 0.2);
  Compliance compliance(GetParam().preconditioner);
  const Eigen::MatrixXd expected = factorised(slab, rows), found = compliance.find(slab, rows);
  const double error = (found - expected).norm() / expected.norm();
  const int anew = compliance.iterations();
  EXPECT_LE(error, 0.01);
  EXPECT_EQ(found, found.transpose());

  // the contacts have moved by a tenth of an edge
  const std::vector<ConstraintRow> moved = contacts(slab, 20, 0.3);
  const Eigen::MatrixXd expected_moved = factorised(slab, moved), found_moved = compliance.find(slab, moved);
  const double error_moved = (found_moved - expected_moved).norm() / expected_moved.norm();
  EXPECT_LE(error_moved, 0.01);
  EXPECT_LT(compliance.iterations(), anew);

  Compliance exact(GetParam().preconditioner, 1e-10);
  const double least = (exact.find(slab, rows) - expected).norm() / expected.norm();
  EXPECT_LE(least, 1e-7);
  std::cout << GetParam().name << ": error " << error << " by " << anew << " iterations, then " << error_moved << " by "
            << compliance.iterations() << "; solved exactly " << least << " by " << exact.iterations() << "\n";
}

INSTANTIATE_TEST_SUITE_P(Systems, ComplianceOf,
                         testing::Values(SystemCase{"stiff", 2e5, Precision::kDouble, Preconditioner::kAuto, 0},
                                         SystemCase{"mixed", 2e5, Precision::kMixed, Preconditioner::kAuto, 0},
                                         SystemCase{"soft", 500, Precision::kDouble, Preconditioner::kAuto, 0},
                                         SystemCase{"diagonal", 2e4, Precision::kDouble, Preconditioner::kDiagonal, 0},
                                         SystemCase{"spring", 2e5, Precision::kMixed, Preconditioner::kAuto, 5},
                                         SystemCase{"two_bodies", 2e5, Precision::kMixed, Preconditioner::kAuto, 0, 2}),
                         [](const auto& each) { return std::string(each.param.name); });

// Of which a preconditioned residual sees little.
TEST(Compliance, KnowsTheBendingOfSlenderAndStiffBodies) {
  for (const double young_modulus : {5e4, 5e5, 5e6})
    for (const Preconditioner preconditioner : {Preconditioner::kAuto, Preconditioner::kDiagonal}) {
      Slab bar(regular_grid({20, 4, 4}, Vec3::Zero(), {0.1, 0.02, 0.02}));
      bar.add_body(0, bar.mesh.num_elements(), young_modulus);
      bar.diagonal /= 8;  // cells of half a centimetre
      const std::vector<ConstraintRow> rows = {{{bar.num_nodes() - 1, Vec3(0, 0, 1)}}};
      const double expected = factorised(bar, rows)(0, 0);
      for (const double tolerance : {1e-3, 1e-5}) {
        Compliance compliance(preconditioner, tolerance);
        EXPECT_NEAR(compliance.find(bar, rows)(0, 0), expected, 5 * tolerance * expected) << young_modulus;
        EXPECT_EQ(compliance.num_stalled(), 0);
      }
    }
}

// The solutions before, which solves begin with, move what is fixed now.
TEST(Compliance, FollowsConstraintsThatChange) {
  for (const int num_bodies : {1, 2}) {
    Slab slab(slab_mesh());
    const int num_elements = slab.mesh.num_elements(), of_first = num_elements / num_bodies;
    slab.add_body(0, of_first, 2e4);
    if (num_bodies == 2) slab.add_body(of_first, num_elements, 1e4);
    const std::vector<ConstraintRow> rows = contacts(slab, 3, 0.2);
    Compliance compliance(Preconditioner::kAuto, 1e-6);
    compliance.find(slab, rows);
    for (int n = 0; n < slab.num_nodes(); ++n)
      if (slab.mesh.positions()(n, 2) == 0) slab.held.push_back(n);
    const Eigen::MatrixXd expected = factorised(slab, rows);
    EXPECT_LE((compliance.find(slab, rows) - expected).norm(), 1e-5 * expected.norm()) << num_bodies;
    slab.slides = true;
    const Eigen::MatrixXd sliding = compliance.find(slab, rows);
    Compliance anew(Preconditioner::kAuto, 1e-6);
    EXPECT_LE((sliding - anew.find(slab, rows)).norm(), 1e-5 * expected.norm()) << num_bodies;
  }
}

TEST(Compliance, ForcesOfMultipliersAreThoseOfTheTransposedJacobian) {
  const std::vector<ConstraintRow> rows = {{{1, Vec3(1, 2, 3)}, {0, Vec3(0, 0, 4)}}, {{1, Vec3(5, 0, 0)}}};
  PointArray f = PointArray::Ones(2, 3), expected(2, 3);
  add_constraint_force(rows, std::array{2.0, -1.0}, f);
  expected << 1, 1, 9, -2, 5, 7;
  EXPECT_EQ(f, expected);
  EXPECT_THROW(add_constraint_force(rows, std::array{2.0}, f), InputError);
  EXPECT_THROW(add_constraint_force(std::vector<ConstraintRow>{{{2, Vec3::Ones()}}}, std::array{1.0}, f), InputError);
}

TEST(Compliance, BeginsTheMotionOfMultipliersNearIt) {
  const Slab slab = slab_of_one_body(2e5, Precision::kDouble);
  const std::vector<ConstraintRow> rows = contacts(slab, 20, 0.2);
  Compliance compliance;
  const Eigen::MatrixXd W = compliance.find(slab, rows);
  Random random(5);
  const Eigen::VectorXd lambda = random.matrix(static_cast<int>(W.rows()), 1).cwiseAbs();
  PointArray b = transposed(slab, rows, lambda), x(slab.num_nodes(), 3), expected = x;
  ASSERT_TRUE(compliance.start(b, x));
  CholeskySolver().solve(slab, b, expected);
  const PointArray error = x - expected;
  PointArray A_error(slab.num_nodes(), 3), A_expected = A_error;
  slab.apply(error, A_error);
  slab.apply(expected, A_expected);
  EXPECT_LE(dot(error, A_error), 0.04 * dot(expected, A_expected)) << "a fifth in the energy norm";

  PreconditionedConjugateGradients solver(1e-3, 100, Preconditioner::kAuto);
  SolverMemory none;
  EXPECT_LE(solver.solve_from_guess(slab, b, x, none).residual, 1e-3);
  EXPECT_FALSE(Compliance().start(b, x));
  compliance.reset();
  EXPECT_FALSE(compliance.start(b, x));
}

TEST(Compliance, HasTheSameBitsForAnyNumberOfThreads) {
  const int threads = num_threads();
  Eigen::MatrixXd found[2];
  for (int k = 0; k < 2; ++k) {
    set_num_threads(k == 0 ? 1 : 3);
    const Slab slab = slab_of_one_body(2e5, Precision::kMixed);
    Compliance compliance;
    compliance.find(slab, contacts(slab, 7, 0.2));
    found[k] = compliance.find(slab, contacts(slab, 7, 0.25));
  }
  set_num_threads(threads);
  EXPECT_EQ(found[0], found[1]);
}

// As points of a mesh against several triangles each: more rows at a node than it has directions, nearly alike.
TEST(Compliance, OfRowsThatDependOnOneAnotherIsPositive) {
  const Slab slab = slab_of_one_body(2e5, Precision::kMixed);
  Random random(9);
  Compliance compliance;
  std::vector<ConstraintRow> rows;
  for (int k = 0; k < 40; ++k)
    for (int copy = 0; copy < 6; ++copy) {
      const Vec3 direction(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), copy % 3 - 0.5);
      rows.push_back({{5 + k % 8 + 17 * (3 + k / 8 + 17 * 4), direction}});
    }
  for (int k = 0; k < 2; ++k) {
    const Eigen::MatrixXd W = compliance.find(slab, rows), expected = factorised(slab, rows);
    EXPECT_LE((W - expected).norm(), 0.01 * expected.norm());
    const Eigen::VectorXd of_W = eigenvalues(W);
    EXPECT_GE(of_W.minCoeff(), -1e-12 * of_W.maxCoeff());
  }
}

TEST(Compliance, RowsMayBeManyNoneDependentOrHeld) {
  const Slab slab = slab_of_one_body(2e5, Precision::kDouble);
  Compliance compliance;
  EXPECT_EQ(compliance.find(slab, {}).size(), 0);
  std::vector<ConstraintRow> rows = contacts(slab, 4, 0.2);
  rows.push_back(rows[2]);                          // twice
  rows.push_back({{slab.held[3], Vec3::UnitX()}});  // nothing moves there
  rows.emplace_back();
  for (int k = 0; k < 2; ++k) {
    const Eigen::MatrixXd W = compliance.find(slab, rows), expected = factorised(slab, rows);
    EXPECT_LE((W - expected).norm(), 0.01 * expected.norm());
    EXPECT_EQ(W(13, 13), 0);
    EXPECT_EQ(W.col(14).norm(), 0);
  }
  rows.push_back({{slab.num_nodes(), Vec3::UnitX()}});
  EXPECT_THROW(compliance.find(slab, rows), InputError);
}

}  // namespace
}  // namespace hexaplast
