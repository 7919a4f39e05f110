// SPDX-License-Identifier: LGPL-2.1-or-later
#include "baselines/dense_peer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "mesh/lumped_mass.hpp"

namespace hexaplast {
namespace {

/// 2 x 3 x 2 cells, every node moved by a fifth of an edge.
HexMesh shaken_mesh() {
  const HexMesh grid = regular_grid({2, 3, 2}, Vec3::Zero(), Vec3(1, 1.2, .9));
  PointArray X = grid.positions();
  for (int n = 0; n < X.rows(); ++n)
    for (int axis = 0; axis < 3; ++axis) X(n, axis) += 0.08 * std::sin(7.0 * n + 3.0 * axis);
  return HexMesh(X, grid.hexahedra());
}

struct DensePeerTest : testing::Test {
  Body body{shaken_mesh(), {Material{.young_modulus = 700, .poisson_ratio = .3}}, published_element()};
  const PointArray& X = body.mesh().positions();
  Eigen::VectorXd masses = 3 * nodal_volumes(X, body.mesh().hexahedra());
  baselines::DensePeer peer{body.mesh(), body.state().model.lame, masses, {0, 1, 2}};
  PointArray zero = PointArray::Zero(X.rows(), 3);

  PointArray affine() const {
    Mat3 F;
    F << 1.2, .3, -.1, .05, .9, .2, -.4, .1, 1.1;
    return X * F.transpose();
  }
};

// An affine motion has one rotation and one stretch: both elements then obey the same law exactly.
TEST_F(DensePeerTest, HasOurForcesUnderAffineMotion) {
  const PointArray x = affine();
  PointArray ours = zero, theirs = zero;
  body.linearize(x);
  body.add_force(ours);
  peer.add_force(x, theirs);
  EXPECT_LT((ours - theirs).norm(), 1e-11 * ours.norm());
  EXPECT_GT(ours.norm(), 1);
}

TEST_F(DensePeerTest, HasOurProductOfAnAffineIncrement) {
  const PointArray x = affine(), dx = X * (Mat3() << .1, .2, -.3, .4, -.5, .6, .7, -.8, .9).finished().transpose();
  PointArray ours = zero, theirs = zero;
  body.linearize(x);
  body.add_stiffness_product(1, dx, ours);
  peer.add_force(x, theirs);
  theirs.setZero();
  peer.add_stiffness_product(1, dx, theirs);
  EXPECT_LT((ours - theirs).norm(), 1e-11 * ours.norm());
}

// Solved to the end, the step obeys M dv + dt^2 K dv = dt (f + dt K v) with its own forces and products.
TEST_F(DensePeerTest, StepSolvesImplicitEuler) {
  const double dt = .02;
  const Vec3 gravity(1, -9, 2);
  PointArray x = affine(), v = (2 * X).array().cos(), dv(X.rows(), 3);
  for (int n = 0; n < 3; ++n) v.row(n).setZero();
  const PointArray x_before = x, v_before = v;
  const SolveReport report = peer.step(gravity, dt, {.iterations = 500, .tolerance = 1e-13}, x, v, dv);
  EXPECT_TRUE(report.converged);
  EXPECT_GT(report.iterations, 5);

  PointArray rest = masses * gravity.transpose();
  peer.add_force(x_before, rest);
  peer.add_stiffness_product(dt, v, rest);  // v = v_before + dv
  rest = dt * rest - masses.asDiagonal() * dv;
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ(dv.row(n).norm(), 0);
    rest.row(n).setZero();
  }
  EXPECT_LT(rest.norm(), 1e-11 * (masses.asDiagonal() * dv).norm());
  EXPECT_LT((x - x_before - dt * v).norm(), 1e-14);
}

}  // namespace
}  // namespace hexaplast
