// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <cmath>

#include "body_state.hpp"
#include "elastic/operators.hpp"
#include "hexaplast/body.hpp"
#include "kinematics/gradients.hpp"
#include "kinematics/polar.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/materials.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
namespace {

using support::force_at;
using support::kEdge;
using support::mapped;
using support::Random;
using support::stiffness_at;

constexpr double kYoung = 5000;  // [Pa]

Body elastic_body(HexMesh mesh) {
  Material m;
  m.young_modulus = kYoung;
  return Body(std::move(mesh), {m}, published_element());
}

/// True when no sample of the body comes near a gradient at which its rotation jumps (the two smallest stretches
/// opposite).
bool is_smooth_at(const Body& body, const PointArray& x) {
  for (const Hexahedron& corners : body.mesh().hexahedra()) {
    for (const Mat3& F : deformation_gradients(
             rest_operator(gather(body.state().history.plastic_rest_positions, corners)), gather(x, corners))) {
      const Vec3 d = signed_svd(F).d;
      if (d[1] + d[2] < 0.02) return false;
    }
  }
  return true;
}

int count_inverted(const Body& body, const PointArray& x) {
  int count = 0;
  for (const Hexahedron& corners : body.mesh().hexahedra()) {
    for (const Mat3& F : deformation_gradients(
             rest_operator(gather(body.state().history.plastic_rest_positions, corners)), gather(x, corners))) {
      count += F.determinant() < 0;
    }
  }
  return count;
}

TEST(Force, IsTheSlopeOfTheEnergyEvenInsideOut) {
  Random random(81);
  Body body = elastic_body(support::distorted_block({2, 2, 2}, kEdge, 0.15, 82));
  int num_states = 0, num_inverted = 0;
  for (int k = 0; k < 200 && num_states < 6; ++k) {
    const PointArray x =
        mapped(PointArray(body.mesh().positions() + random.field(27, (k % 2 ? 0.7 : 0.3) * kEdge)), random.rotation());
    if (!is_smooth_at(body, x)) continue;
    ++num_states;
    num_inverted += count_inverted(body, x) > 0;

    const PointArray f = force_at(body, x);
    for (int n = 0; n < x.rows(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const double slope = support::central_difference(
            [&](double h) {
              PointArray nudged = x;
              nudged(n, axis) += h;
              return body.energy(nudged);
            },
            1e-7);
        ASSERT_NEAR(f(n, axis), -slope, 1e-6 * support::max_abs(f)) << "node " << n;
      }
    }
  }
  EXPECT_EQ(num_states, 6);
  EXPECT_GE(num_inverted, 2);
}

TEST(Force, AndItsMomentVanishForAnyShape) {
  Random random(83);
  Body body = elastic_body(support::distorted_block({3, 2, 2}, kEdge, 0.15, 84));
  for (int k = 0; k < 100; ++k) {
    const PointArray x =
        mapped(PointArray(body.mesh().positions() + random.field(36, kEdge)), random.rotation(), random.vector(1));
    const PointArray f = force_at(body, x);
    Vec3 moment = Vec3::Zero();
    double force_size = 0, moment_size = 0;
    for (int n = 0; n < x.rows(); ++n) {
      const Vec3 m = Vec3(x.row(n)).cross(Vec3(f.row(n)));
      moment += m;
      force_size += f.row(n).norm();
      moment_size += m.norm();
    }
    ASSERT_LE(f.colwise().sum().norm(), 1e-12 * force_size);
    ASSERT_LE(moment.norm(), 1e-11 * moment_size);
  }
}

TEST(Force, OfARigidMotionIsNothing) {
  Random random(85);
  Body body = elastic_body(support::distorted_block({2, 1, 1}, kEdge, 0.15, 86));
  for (int k = 0; k < 10000; ++k) {
    const Mat3 R =
        k % 10 == 0 ? random.rotation_by(std::numbers::pi + random.uniform(-1e-12, 1e-12)) : random.rotation();
    const PointArray x = mapped(body.mesh().positions(), R, random.vector(1));
    ASSERT_LE(support::max_abs(force_at(body, x)), 1e-10 * kYoung * kEdge * kEdge);
    ASSERT_LE(body.energy(x), 1e-12 * kYoung * kEdge * kEdge * kEdge);
  }
}

TEST(Force, TurnsWithTheBody) {
  Random random(87);
  Body body = elastic_body(support::distorted_block({2, 2, 2}, kEdge, 0.15, 88));
  const PointArray x = body.mesh().positions() + random.field(27, 0.3 * kEdge);
  const PointArray f = force_at(body, x);
  for (int k = 0; k < 20; ++k) {
    const Mat3 R = random.rotation();
    EXPECT_TRUE(support::agrees(force_at(body, mapped(x, R, random.vector(1))), mapped(f, R), 1e-11));
  }
}

// Corner a of the cube goes where a rotation of the cube takes it: 24 ways to number one and the same hexahedron.
TEST(Force, DoesNotDependOnTheNumberingOfTheCorners) {
  Random random(89);
  const ElementPoints X = support::distorted_hexahedron(kEdge, 0.2, 90);
  const PointArray x = PointArray(X) + random.field(8, 0.3 * kEdge);
  Body body = elastic_body(support::single_element(X));
  const PointArray f = force_at(body, x);

  int num_numberings = 0;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3i Q = Eigen::Matrix3i::Zero();
      for (int d = 0; d < 3; ++d) Q(axes[d], d) = signs & (1 << d) ? -1 : 1;
      if (Q.cast<double>().determinant() < 0) continue;
      Hexahedron corners;
      for (int a = 0; a < kCorners; ++a) {
        const Eigen::Vector3i turned = Q * Eigen::Vector3i(kCornerSign[a].data());
        for (int b = 0; b < kCorners; ++b) {
          if (turned == Eigen::Vector3i(kCornerSign[b].data())) corners[a] = b;
        }
      }
      Body renumbered = elastic_body(HexMesh(PointArray(X), {corners}));
      EXPECT_TRUE(support::agrees(force_at(renumbered, x), f, 1e-12));
      ++num_numberings;
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  EXPECT_EQ(num_numberings, 24);
}

TEST(Force, OfTheMirroredBodyIsMirrored) {
  Random random(91);
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  const HexMesh mesh = support::distorted_block({2, 2, 2}, kEdge, 0.15, 92);
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  for (Hexahedron& corners : hexahedra) {
    for (const int a : {0, 3, 4, 7}) std::swap(corners[a], corners[kEdgeNeighbour[a][0]]);
  }
  const PointArray x = mesh.positions() + random.field(27, 0.3 * kEdge);
  Body body = elastic_body(mesh), mirrored = elastic_body(HexMesh(mapped(mesh.positions(), mirror), hexahedra));
  EXPECT_TRUE(support::agrees(force_at(mirrored, mapped(x, mirror)), mapped(force_at(body, x), mirror), 1e-12));
}

TEST(Stiffness, IsSymmetricAndNotNegative) {
  Random random(93);
  Body body = elastic_body(support::distorted_block({2, 2, 2}, kEdge, 0.15, 94));
  for (int k = 0; k < 10; ++k) {
    const PointArray x = mapped(PointArray(body.mesh().positions() + random.field(27, 0.5 * kEdge)), random.rotation());
    const Eigen::MatrixXd K = stiffness_at(body, x);
    EXPECT_LE(support::max_abs(K - K.transpose()), 1e-12 * support::max_abs(K));
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
    EXPECT_GE(values[0], -1e-10 * values[80]);
  }
}

TEST(Stiffness, HasSixZeroModesUnderARigidMotion) {
  Random random(95);
  for (const double fraction : {0.0, 0.15}) {
    Body body = elastic_body(support::single_element(support::distorted_hexahedron(kEdge, fraction, 96)));
    const Eigen::MatrixXd K = stiffness_at(body, mapped(body.mesh().positions(), random.rotation(), random.vector(1)));
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
    for (int i = 0; i < 6; ++i) EXPECT_LE(std::abs(values[i]), 1e-10 * values[23]);
    EXPECT_GE(values[6], 1e-3 * values[23]);
  }
}

// Where nothing is strained the operator with fixed rotations lacks nothing, so the difference quotient must agree.
TEST(Stiffness, IsTheSlopeOfTheForceAtARigidMotion) {
  Random random(97);
  Body body = elastic_body(support::distorted_block({2, 2, 2}, kEdge, 0.15, 98));
  const PointArray x = mapped(body.mesh().positions(), random.rotation()), dx = random.field(27, 1);
  const double h = 1e-7;
  const PointArray slope = (force_at(body, x + h * dx) - force_at(body, x - h * dx)) / (2 * h);
  PointArray product = PointArray::Zero(27, 3);
  body.linearize(x);
  body.add_stiffness_product(1, dx, product);
  EXPECT_TRUE(support::agrees(product, slope, 1e-6));
}

TEST(StiffnessProduct, OfASuperposedSpinIsNothing) {
  Random random(101);
  Body body = elastic_body(support::distorted_block({2, 2, 2}, kEdge, 0.15, 102));
  const PointArray x = body.mesh().positions();
  const Vec3 w = random.vector(1);
  PointArray spin(27, 3), product = PointArray::Zero(27, 3);
  for (int n = 0; n < 27; ++n) spin.row(n) = w.cross(Vec3(x.row(n))).transpose();
  body.linearize(x);
  body.add_stiffness_product(1, spin, product);
  EXPECT_LE(support::max_abs(product), 1e-12 * kYoung * kEdge);
}

TEST(FreeBody, KeepsItsMomentumWhileSpinning) {
  support::SimulationSetup setup;
  support::Simulation bar(elastic_body(support::block({2, 2, 5}, kEdge)), std::move(setup));
  const Vec3 omega(2, 0, 0), drift(0.3, -0.2, 0.1), centre = bar.x.colwise().mean().transpose();
  for (int n = 0; n < bar.x.rows(); ++n) {
    bar.v.row(n) = (drift + omega.cross(Vec3(bar.x.row(n)) - centre)).transpose();
  }
  double mass = 0;
  for (const double m : bar.mass()) mass += m;
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (int n = 0; n < bar.x.rows(); ++n) sum += bar.mass()[n] * bar.v.row(n).transpose();
    return sum;
  };
  const auto angular_momentum = [&] {
    Vec3 first = Vec3::Zero(), sum = Vec3::Zero();
    for (int n = 0; n < bar.x.rows(); ++n) first += bar.mass()[n] / mass * bar.x.row(n).transpose();
    for (int n = 0; n < bar.x.rows(); ++n) {
      sum += bar.mass()[n] * (Vec3(bar.x.row(n)) - first).cross(Vec3(bar.v.row(n)) - drift);
    }
    return sum;
  };
  const Vec3 momentum_before = momentum(), angular_before = angular_momentum();
  bar.run(100);
  EXPECT_LE((momentum() - momentum_before).norm(), 1e-12 * momentum_before.norm());
  EXPECT_LE((angular_momentum() - angular_before).norm(), 1e-3 * angular_before.norm());
}

TEST(Energy, OfAUniaxialStretchHasTheHandValue) {
  Body body = elastic_body(support::block({2, 2, 3}, kEdge));
  const double strain = 0.1;
  const Mat3 F = Vec3(1 - 0.45 * strain, 1 - 0.45 * strain, 1 + strain).asDiagonal();
  const double expected = 0.5 * kYoung * strain * strain * body.initial_volume();
  EXPECT_NEAR(body.energy(mapped(body.mesh().positions(), F)), expected, 1e-12 * expected);
}

}  // namespace
}  // namespace hexaplast
