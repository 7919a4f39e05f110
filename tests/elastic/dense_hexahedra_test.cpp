// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/dense_hexahedra.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::dense;
using support::stacked;
using support::unstacked;

constexpr double kYoung = 700, kPoisson = 0.3;
const std::vector<Lame> kLame = {lame(kYoung, kPoisson)};

Mat3 turn() { return rotation_exp(Vec3(0.4, -0.9, 0.7)); }

/// Two hexahedra, distorted, with a turn at rest.
HexMesh turned_mesh() {
  const HexMesh mesh = support::distorted_block({2, 1, 1}, 1, 0.15, 3);
  return HexMesh(mesh.positions() * rotation_exp(Vec3(-0.3, 0.2, 0.5)).transpose(), mesh.hexahedra());
}

DenseHexahedra made(const HexMesh& mesh, ElementFrame frame, ElementMatrix matrix = ElementMatrix::kIntegrated) {
  return DenseHexahedra(mesh.positions(), mesh.hexahedra(), kLame, {frame, matrix});
}

PointArray force_at(DenseHexahedra& elements, const PointArray& x) {
  PointArray f = PointArray::Zero(x.rows(), 3);
  elements.add_force(x, f);
  return f;
}

/// As textbooks have it: B (6 x 24) and Hooke's matrix with engineering shears, 2x2x2 Gauss points.
Eigen::MatrixXd textbook_stiffness(const ElementPoints& X) {
  Eigen::Matrix<double, 6, 6> D = Eigen::Matrix<double, 6, 6>::Zero();
  D.topLeftCorner<3, 3>().setConstant(kPoisson);
  D.diagonal().head<3>().setConstant(1 - kPoisson);
  D.diagonal().tail<3>().setConstant((1 - 2 * kPoisson) / 2);
  D *= kYoung / ((1 + kPoisson) * (1 - 2 * kPoisson));
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(24, 24);
  const double s = 1 / std::sqrt(3.0);
  for (double r : {-s, s})
    for (double t : {-s, s})
      for (double w : {-s, s}) {
        Eigen::Matrix<double, 8, 3> dN;
        for (int a = 0; a < 8; ++a) {
          const double p = (a % 4 == 1 || a % 4 == 2) ? 1 : -1, q = a % 4 >= 2 ? 1 : -1, o = a >= 4 ? 1 : -1;
          dN.row(a) << p * (1 + q * t) * (1 + o * w) / 8, q * (1 + p * r) * (1 + o * w) / 8,
              o * (1 + p * r) * (1 + q * t) / 8;
        }
        const Mat3 J = X.transpose() * dN;
        const Eigen::Matrix<double, 8, 3> g = dN * J.inverse();
        Eigen::MatrixXd B = Eigen::MatrixXd::Zero(6, 24);
        for (int a = 0; a < 8; ++a)
          B.block<6, 3>(0, 3 * a) << g(a, 0), 0, 0, 0, g(a, 1), 0, 0, 0, g(a, 2), g(a, 1), g(a, 0), 0, 0, g(a, 2),
              g(a, 1), g(a, 2), 0, g(a, 0);
        K += J.determinant() * B.transpose() * D * B;
      }
  return K;
}

/// The frame as SOFA names its corners. Rows: axes.
Mat3 frame_of(const ElementPoints& x, ElementFrame kind) {
  const auto n = [&](int a) -> Vec3 { return x.row(a); };
  const Vec3 along = (n(1) - n(0) + n(2) - n(3) + n(5) - n(4) + n(6) - n(7)) / 4,
             up = (n(3) - n(0) + n(2) - n(1) + n(7) - n(4) + n(6) - n(5)) / 4,
             back = (n(4) - n(0) + n(5) - n(1) + n(7) - n(3) + n(6) - n(2)) / 4;
  Mat3 Q = Mat3::Identity();
  if (kind == ElementFrame::kMeanEdges) {
    Q.row(0) = along.normalized();
    Q.row(2) = along.cross(up).normalized();
    Q.row(1) = Vec3(Q.row(2)).cross(Vec3(Q.row(0)));
  } else if (kind == ElementFrame::kPolar) {
    Q << along.transpose(), up.transpose(), back.transpose();
    for (int k = 0; k < 60; ++k) Q = (Q + Q.inverse().transpose()) / 2;  // Newton, to the orthogonal factor
  }
  return Q;
}

Eigen::MatrixXd for_eight_corners(const Mat3& Q) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(24, 24);
  for (int a = 0; a < 8; ++a) all.block<3, 3>(3 * a, 3 * a) = Q;
  return all;
}

struct DenseHexahedraFrames : testing::TestWithParam<ElementFrame> {
  HexMesh mesh = turned_mesh();
  const PointArray& X = mesh.positions();
  DenseHexahedra elements = made(mesh, GetParam());
  support::Random random{7};
  PointArray moved = support::mapped(X, turn(), Vec3(1, 2, 3)) + random.field(X.rows(), 0.2);
};

// Force and stiffness of each hexahedron, assembled here from the textbook's matrix.
TEST_P(DenseHexahedraFrames, HaveTheForceAndTheStiffnessOfTheTextbooksMatrix) {
  PointArray f = PointArray::Zero(X.rows(), 3);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * X.rows(), 3 * X.rows());
  double energy = 0;
  for (const Hexahedron& corners : mesh.hexahedra()) {
    const ElementPoints rest = gather(X, corners), x = gather(moved, corners);
    const Mat3 Q0 = frame_of(rest, GetParam()), Q = frame_of(x, GetParam());
    const ElementPoints local_rest = rest * Q0.transpose(), local = x * Q.transpose();
    const Eigen::MatrixXd Ke = textbook_stiffness(local_rest), all = for_eight_corners(Q),
                          turned = all.transpose() * Ke * all;
    const Eigen::VectorXd u = stacked(PointArray(local - local_rest));
    energy += u.dot(Ke * u) / 2;
    const Eigen::VectorXd force = -all.transpose() * Ke * u;
    for (int a = 0; a < 8; ++a) {
      f.row(corners[a]) += force.segment<3>(3 * a).transpose();
      for (int b = 0; b < 8; ++b) K.block<3, 3>(3 * corners[a], 3 * corners[b]) += turned.block<3, 3>(3 * a, 3 * b);
    }
  }
  EXPECT_LT(support::max_abs(force_at(elements, moved) - f), 1e-11 * support::max_abs(f));
  EXPECT_NEAR(elements.energy(moved), energy, 1e-12 * energy);
  BlockMatrix blocks(static_cast<int>(X.rows()));
  elements.add_stiffness_blocks(-2, blocks);
  EXPECT_LT((dense(blocks) - 2 * K).cwiseAbs().maxCoeff(), 1e-11 * K.cwiseAbs().maxCoeff());
  const PointArray dx = random.field(X.rows(), 1);
  PointArray df = PointArray::Zero(X.rows(), 3);
  elements.add_stiffness_product(-2, dx, df);
  EXPECT_LT((stacked(df) - 2 * K * stacked(dx)).norm(), 1e-11 * stacked(df).norm());
}

// A displacement of all corners by +, -, +, - along the edges leaves the mean edges, and so the frame, as they are.
TEST_P(DenseHexahedraFrames, ForceChangesByTheProductWhereTheFrameStays) {
  const HexMesh one = support::single_element(support::distorted_hexahedron(1, 0.2, 5));
  DenseHexahedra element = made(one, GetParam());
  const PointArray x = support::mapped(one.positions(), turn());
  PointArray dx(8, 3);
  for (int a = 0; a < 8; ++a) {
    const auto& s = kCornerSign[a];
    dx.row(a) << 0.1 * s[0] * s[1], 0.2 * s[1] * s[2], -0.1 * s[0] * s[1] * s[2];
  }
  const PointArray after = force_at(element, x + dx), before = force_at(element, x);
  PointArray df = PointArray::Zero(8, 3);
  element.add_stiffness_product(1, dx, df);
  EXPECT_LT(support::max_abs(after - before - df), 1e-11 * support::max_abs(df));
}

TEST_P(DenseHexahedraFrames, RigidMotionMakesForceOnlyInTheWorldsFrame) {
  const PointArray f = force_at(elements, support::mapped(X, turn(), Vec3(4, -5, 6)));
  EXPECT_EQ(support::max_abs(f) < 1e-10, GetParam() != ElementFrame::kWorld) << support::max_abs(f);
  EXPECT_LT(support::max_abs(force_at(elements, support::mapped(X, Mat3::Identity(), Vec3(4, -5, 6)))), 1e-10);
}

// Evaluation leaves nothing behind, and as many threads as there are make the same bits.
TEST_P(DenseHexahedraFrames, SameBitsForAnyNumberOfThreadsAndInAnyOrder) {
  const HexMesh block = support::distorted_block({5, 4, 3}, 1, 0.1, 9);
  const PointArray x = block.positions() + random.field(block.num_nodes(), 0.1),
                   dx = random.field(block.num_nodes(), 1);
  PointArray force, product;
  double energy = 0;
  for (const int threads : {1, 2, 3, 7}) {
    set_num_threads(threads);
    DenseHexahedra one = made(block, GetParam());
    force_at(one, dx);
    const PointArray f = force_at(one, x);
    PointArray df = f;
    one.add_stiffness_product(0.3, dx, df);
    if (threads == 1) {
      force = f;
      product = df;
      energy = one.energy(x);
    }
    EXPECT_EQ(f, force);
    EXPECT_EQ(df, product);
    EXPECT_EQ(one.energy(x), energy);
  }
  set_num_threads(1);
}

INSTANTIATE_TEST_SUITE_P(Frames, DenseHexahedraFrames,
                         testing::Values(ElementFrame::kWorld, ElementFrame::kMeanEdges, ElementFrame::kPolar));

// Energy of small strains is quadratic: the central difference is exact.
TEST(DenseHexahedra, ForceIsTheGradientOfTheEnergyInTheWorldsFrame) {
  const HexMesh mesh = turned_mesh();
  DenseHexahedra elements = made(mesh, ElementFrame::kWorld);
  const PointArray x = mesh.positions() + support::Random(2).field(mesh.num_nodes(), 0.3);
  const PointArray f = force_at(elements, x);
  for (int n = 0; n < mesh.num_nodes(); ++n)
    for (int i = 0; i < 3; ++i) {
      PointArray after = x, before = x;
      after(n, i) += 0.5;
      before(n, i) -= 0.5;
      EXPECT_NEAR(elements.energy(before) - elements.energy(after), f(n, i), 1e-10 * support::max_abs(f));
    }
}

// Patch test: inside a distorted block that follows an affine motion of small strain there is no force.
TEST(DenseHexahedra, InnerNodesOfAnAffineMotionAreAtRest) {
  const HexMesh mesh = support::distorted_block({3, 3, 3}, 1, 0.2, 4);
  DenseHexahedra elements = made(mesh, ElementFrame::kWorld);
  const Mat3 F = Mat3::Identity() + 1e-3 * (Mat3() << 2, 1, 1, 1, 2, 1, 1, 1, 2).finished() / 2;
  const PointArray f = force_at(elements, support::mapped(mesh.positions(), F));
  const std::vector<bool> on_boundary = support::is_on_boundary(mesh);
  for (int n = 0; n < mesh.num_nodes(); ++n)
    EXPECT_TRUE(on_boundary[n] || f.row(n).norm() < 1e-12 * support::max_abs(f)) << n;
}

// Within a thousandth of a parallelepiped the edges at corner 0 count for all; beyond it they do not.
TEST(DenseHexahedra, TakesOneJacobianForWhatIsNearlyAParallelepiped) {
  const auto differs = [](double bump) {
    ElementPoints X = support::cube(2);
    X(6, 0) += bump;
    const HexMesh bumped = support::single_element(X), cube = support::single_element(support::cube(2));
    BlockMatrix of_bumped(8), of_cube(8);
    made(bumped, ElementFrame::kWorld).add_stiffness_blocks(1, of_bumped);
    made(cube, ElementFrame::kWorld).add_stiffness_blocks(1, of_cube);
    return (dense(of_bumped) - dense(of_cube)).cwiseAbs().maxCoeff() > 1e-9;
  };
  EXPECT_FALSE(differs(0.0019));
  EXPECT_TRUE(differs(0.0021));
}

// The closed form of a cube and the Gauss points agree up to single precision; of a box only the normal strains do.
TEST(DenseHexahedra, TheMatrixOfACubeIsThatOfTheGaussPoints) {
  const auto difference = [](const HexMesh& mesh) {
    BlockMatrix closed(8), integrated(8);
    made(mesh, ElementFrame::kWorld, ElementMatrix::kCube).add_stiffness_blocks(-1, closed);
    made(mesh, ElementFrame::kWorld).add_stiffness_blocks(-1, integrated);
    return (dense(closed) - dense(integrated)).cwiseAbs().maxCoeff() / dense(integrated).cwiseAbs().maxCoeff();
  };
  const double of_cube = difference(support::single_element(support::cube(0.7)));
  EXPECT_LT(of_cube, 1e-7);
  EXPECT_GT(of_cube, 1e-9);
  EXPECT_GT(difference(regular_grid({1, 1, 1}, Vec3::Zero(), Vec3(1, 2, 3))), 0.1);
}

// As in SOFA, an inverted hexahedron is at rest in its mirror image.
TEST(DenseHexahedra, PolarFramesTakeReflections) {
  const HexMesh mesh = support::single_element(support::cube(1));
  DenseHexahedra elements = made(mesh, ElementFrame::kPolar);
  const PointArray mirrored = support::mapped(mesh.positions(), Vec3(1, 1, -1).asDiagonal());
  EXPECT_LT(support::max_abs(force_at(elements, mirrored)), 1e-10);
}

TEST(DenseHexahedra, ThoseThatAreGoneMakeNothing) {
  const HexMesh both = turned_mesh(), second(both.positions(), {both.hexahedra()[1]});
  DenseHexahedra elements = made(both, ElementFrame::kPolar), alone = made(second, ElementFrame::kPolar);
  const PointArray x = support::mapped(both.positions(), Mat3(Vec3(1.1, 0.9, 1.2).asDiagonal()));
  elements.set_alive(std::vector<unsigned char>{0, 1});
  EXPECT_EQ(force_at(elements, x), force_at(alone, x));
  EXPECT_EQ(elements.energy(x), alone.energy(x));
  BlockMatrix of_both(both.num_nodes()), of_alone(both.num_nodes());
  elements.add_stiffness_blocks(1, of_both);
  alone.add_stiffness_blocks(1, of_alone);
  EXPECT_EQ(dense(of_both), dense(of_alone));
  elements.set_alive(std::vector<unsigned char>{1, 1});
  EXPECT_NE(force_at(elements, x), force_at(alone, x));
}

TEST(DenseHexahedra, TakesOtherMaterials) {
  const HexMesh mesh = turned_mesh();
  const std::vector<Lame> stiffer = {lame(2 * kYoung, kPoisson), lame(2 * kYoung, kPoisson)};
  DenseHexahedra elements = made(mesh, ElementFrame::kMeanEdges);
  const PointArray x = support::mapped(mesh.positions(), Mat3(Vec3(1.1, 0.9, 1.2).asDiagonal()));
  const PointArray before = force_at(elements, x);
  elements.set_lame(stiffer);
  EXPECT_LT(support::max_abs(force_at(elements, x) - 2 * before), 1e-12 * support::max_abs(before));
  EXPECT_THROW(elements.set_lame(std::vector<Lame>(3)), InputError);
  PointArray f = PointArray::Zero(3, 3);
  EXPECT_THROW(elements.add_force(f, f), InputError);
}

}  // namespace
}  // namespace hexaplast
