// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kinematics/gradients.hpp"

#include <cmath>

#include "support/compare.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::Random;

/// Gradient (d/ds) of the trilinear shape functions at s, one row per corner: written out anew, to compare with.
ElementPoints reference_gradient(const Vec3& s) {
  ElementPoints g;
  for (int a = 0; a < kCorners; ++a) {
    const auto& c = kCornerSign[a];
    const double u = 1 + c[0] * s[0], v = 1 + c[1] * s[1], w = 1 + c[2] * s[2];
    g.row(a) << c[0] * v * w / 8, u * c[1] * w / 8, u * v * c[2] / 8;
  }
  return g;
}

Mat3 jacobian(const ElementPoints& x, const Vec3& s) { return x.transpose() * reference_gradient(s); }

Vec3 corner_point(int a) { return {double(kCornerSign[a][0]), double(kCornerSign[a][1]), double(kCornerSign[a][2])}; }

/// Calls visit(s, weight) at the 3x3x3 Gauss points of the reference cube.
template <class Visit>
void for_gauss_points(const Visit& visit) {
  const double at[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)};
  const double weight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) visit(Vec3(at[i], at[j], at[k]), weight[i] * weight[j] * weight[k]);
    }
  }
}

ElementPoints parallelepiped(const Mat3& edges) { return support::mapped(support::cube(1), edges); }

TEST(Jacobian, IsTheDerivativeOfTheTrilinearMap) {
  const ElementPoints x = support::distorted_hexahedron(0.1, 0.2, 21);
  for (int a = 0; a < kCorners; ++a)
    EXPECT_TRUE(support::agrees(corner_jacobian(x, a), jacobian(x, corner_point(a)), 1e-14));
  EXPECT_TRUE(support::agrees(centre_jacobian(x), jacobian(x, Vec3::Zero()), 1e-14));
}

TEST(Volume, IsTheIntegralOfTheJacobian) {
  const ElementPoints x = support::distorted_hexahedron(0.1, 0.25, 23);
  double integral = 0;
  for_gauss_points([&](const Vec3& s, double weight) { integral += weight * jacobian(x, s).determinant(); });
  EXPECT_NEAR(volume(x), integral, 1e-14 * integral);
  EXPECT_NEAR(volume(support::cube(0.1)), 1e-3, 1e-17);
  EXPECT_NEAR(rest_operator(x).volume, integral, 1e-14 * integral);
}

TEST(DeformationGradient, OfAnAffineMotionIsExactEverywhere) {
  Random random(24);
  for (int k = 0; k < 50; ++k) {
    const ElementPoints x = support::distorted_hexahedron(0.1, 0.2, 100 + k);
    const Mat3 A = random.matrix(1);
    for (const Mat3& F : deformation_gradients(rest_operator(x), support::mapped(x, A, random.vector(2)))) {
      ASSERT_LE((F - A).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

// The correction that makes the patch test pass: the samples have the exact mean on every hexahedron.
TEST(DeformationGradient, HasTheExactMean) {
  const ElementPoints x = support::distorted_hexahedron(0.1, 0.2, 30),
                      current = support::distorted_hexahedron(0.1, 0.4, 31);
  Mat3 integral = Mat3::Zero();
  double volume_of_x = 0;
  for_gauss_points([&](const Vec3& s, double weight) {
    const Mat3 J = jacobian(x, s);
    integral += weight * J.determinant() * jacobian(current, s) * J.inverse();
    volume_of_x += weight * J.determinant();
  });
  Mat3 mean = Mat3::Zero();
  for (const Mat3& F : deformation_gradients(rest_operator(x), current)) mean += F / 8;
  EXPECT_LE((mean - integral / volume_of_x).cwiseAbs().maxCoeff(), 1e-12);
}

// Why corner and centre are mixed in equal parts: F~ (x - o) reproduces bending and twisting without error.
TEST(DeformationGradient, ReproducesQuadraticMotionsOfParallelepipeds) {
  Random random(32);
  const Mat3 edges = Mat3::Identity() + random.matrix(0.3);
  const ElementPoints s = support::cube(2), x = parallelepiped(edges);
  ElementPoints current = support::mapped(x, Mat3::Identity() + random.matrix(0.3));
  const Vec3 xy = random.vector(1), yz = random.vector(1), zx = random.vector(1);
  for (int a = 0; a < kCorners; ++a) {
    current.row(a) += (s(a, 0) * s(a, 1) * xy + s(a, 1) * s(a, 2) * yz + s(a, 2) * s(a, 0) * zx).transpose();
  }
  const auto F = deformation_gradients(rest_operator(x), current);
  const Vec3 centre = current.colwise().mean().transpose();
  for (int a = 0; a < kCorners; ++a) {
    EXPECT_LE((F[a] * x.row(a).transpose() - (current.row(a).transpose() - centre)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

}  // namespace
}  // namespace hexaplast
