// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/grip.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

const Vec3 kTool(1, 2, 3);

/// Four nodes near the tool and two elsewhere, without symmetry.
PointArray nodes() {
  Random random(71);
  PointArray x = random.field(6, 0.1);
  x.rowwise() += kTool.transpose();
  x.row(1) << 5, 5, 5;
  x.row(4) << -1, 2, 3;
  return x;
}

Grip closed(double max_force) {
  Grip grip{.stiffness = 200, .max_force = max_force};
  grip.close({5, 0, 2, 3}, kTool, nodes());
  return grip;
}

PointArray grip_force(const Grip& grip, const Vec3& tool, const PointArray& x) {
  PointArray f = PointArray::Zero(x.rows(), 3);
  grip.add_force(tool, x, f);
  return f;
}

TEST(Grip, FindsTheNodesWithinItsReach) {
  const std::vector<int> candidates{5, 4, 3, 2, 1};
  EXPECT_EQ(nodes_near(nodes(), candidates, kTool, 0.2), (std::vector<int>{5, 3, 2}));
  EXPECT_EQ(nodes_near(nodes(), candidates, kTool, 2), (std::vector<int>{5, 4, 3, 2}));  // on the border
  EXPECT_TRUE(nodes_near(nodes(), candidates, kTool + Vec3(0, 9, 0), 2).empty());
}

// Nothing where it closed, and 200 N/m times the way of the tool afterwards, shared by four.
TEST(Grip, PullsByItsStiffnessTimesTheWay) {
  const Grip grip = closed(1000);
  const PointArray x = nodes();
  EXPECT_LE(max_abs(grip_force(grip, kTool, x)), 1e-12);
  const PointArray f = grip_force(grip, kTool + Vec3(0.1, 0, -0.02), x);
  for (const int node : {5, 0, 2, 3}) EXPECT_LE(max_abs(Vec3(f.row(node).transpose()) - Vec3(5, 0, -1)), 1e-12);
  EXPECT_EQ(f.row(1), Eigen::RowVector3d(0, 0, 0));
  EXPECT_EQ(f.row(4), Eigen::RowVector3d(0, 0, 0));
}

// 12 N at most: 3 N for each node, in the direction in which its spring is elongated.
TEST(Grip, NeverPullsHarderThanItsLimit) {
  const Grip grip = closed(12);
  const PointArray x = nodes();
  const PointArray f = grip_force(grip, kTool + Vec3(0.3, 0, -0.4), x);
  for (const int node : {5, 0, 2, 3}) EXPECT_LE(max_abs(Vec3(f.row(node).transpose()) - Vec3(1.8, 0, -2.4)), 1e-12);
  EXPECT_NEAR(f.colwise().sum().norm(), 12, 1e-12);

  PointArray moved = x + Random(73).field(6, 0.3);
  PointArray g = PointArray::Zero(6, 3);
  grip.add_force(kTool, moved, g);
  PointArray elongations;
  grip.elongations_at(kTool, moved, elongations);
  EXPECT_LE(g.colwise().sum().norm(), 12);
  EXPECT_LE(max_abs(grip.total_force(elongations) - Vec3(g.colwise().sum().transpose())), 1e-12);
}

// The derivative of the forces, of springs on both sides of the limit, against difference quotients; product, blocks
// and diagonal agree.
TEST(Grip, StiffnessIsTheDerivativeOfTheForce) {
  const Grip grip = closed(12);
  Random random(79);
  PointArray x = nodes() + random.field(6, 0.05);
  x.row(0) += Eigen::RowVector3d(0.2, -0.1, 0.3);
  const Vec3 tool = kTool + Vec3(0.01, 0.005, 0);
  PointArray f = PointArray::Zero(6, 3);
  grip.add_force(tool, x, f);
  PointArray elongations;
  grip.elongations_at(tool, x, elongations);
  const Eigen::VectorXd length = elongations.rowwise().norm();
  EXPECT_GT(length.maxCoeff(), 0.06 * 1.5);
  EXPECT_LT(length.minCoeff(), 0.06 * 0.9);

  const PointArray dx = random.field(6, 1);
  const double h = 1e-6;
  const PointArray slope = (grip_force(grip, tool, x + h * dx) - grip_force(grip, tool, x - h * dx)) / (2 * h);
  PointArray product = PointArray::Zero(6, 3), diagonal = product;
  grip.add_stiffness_product(elongations, 2, dx, product);
  EXPECT_TRUE(agrees(product, 2 * slope, 1e-8));

  BlockMatrix A(6);
  grip.add_stiffness_blocks(elongations, 2, A);
  EXPECT_TRUE(agrees(times(A, dx), product, 1e-14));
  EXPECT_FALSE(grip.add_stiffness_diagonal(elongations, 2, diagonal));

  const Grip strong = closed(1000);
  product.setZero();
  strong.add_stiffness_product(elongations, 2, dx, product);
  ASSERT_TRUE(strong.add_stiffness_diagonal(elongations, 2, diagonal));
  EXPECT_TRUE(agrees(PointArray(diagonal.cwiseProduct(dx)), product, 1e-14));
}

// No work is gained on a closed way, below the limit and beyond it.
TEST(Grip, ForcesHaveAPotential) {
  Random random(83);
  for (int trial = 0; trial < 10; ++trial) {
    const Grip grip = closed(trial < 7 ? 12 : std::numeric_limits<double>::infinity());
    EXPECT_NEAR(grip.energy(kTool, nodes()), 0, 1e-15);
    const PointArray x = nodes() + random.field(6, 0.08), dx = random.field(6, 1);
    const double work = -grip_force(grip, kTool, x).cwiseProduct(dx).sum();
    EXPECT_NEAR(central_difference([&](double h) { return grip.energy(kTool, x + h * dx); }, 1e-6), work,
                1e-7 * std::abs(work) + 1e-7);
  }
}

TEST(Grip, OpenItHoldsNothing) {
  Grip grip = closed(12);
  grip.open();
  EXPECT_TRUE(grip_force(grip, kTool + Vec3(1, 1, 1), nodes()).isZero(0));
  PointArray diagonal = PointArray::Zero(6, 3);
  EXPECT_TRUE(grip.add_stiffness_diagonal(PointArray(0, 3), 1, diagonal));
  EXPECT_TRUE(diagonal.isZero(0));
}

// 60 N s/m shared by four, against the velocity relative to the tool; product, blocks and diagonal are its derivative.
TEST(Grip, DashpotsBrakeWhatMovesAgainstTheTool) {
  Grip grip = closed(1000);
  grip.damping = 60;
  Random random(83);
  const PointArray v = random.field(6, 1);
  const Vec3 tool_velocity(0.3, -0.1, 0.2);
  PointArray f = PointArray::Zero(6, 3), moved = f, product = f, diagonal = f;
  const Vec3 sum = grip.add_damping_force(tool_velocity, v, f);
  for (const int node : {5, 0, 2, 3})
    EXPECT_LE(max_abs(Vec3(f.row(node).transpose()) - 15 * (tool_velocity - Vec3(v.row(node).transpose()))), 1e-12);
  EXPECT_EQ(f.row(1), Eigen::RowVector3d(0, 0, 0));
  EXPECT_LE(max_abs(sum - Vec3(f.colwise().sum().transpose())), 1e-12);

  const PointArray dv = random.field(6, 1);
  grip.add_damping_force(tool_velocity, v + dv, moved);
  grip.add_damping_product(0.7, dv, product);
  EXPECT_TRUE(agrees(product, PointArray(0.7 * (moved - f)), 1e-12));
  BlockMatrix A(6);
  grip.add_damping_blocks(0.7, A);
  EXPECT_TRUE(agrees(times(A, dv), product, 1e-12));
  grip.add_damping_diagonal(0.7, diagonal);
  EXPECT_TRUE(agrees(PointArray(diagonal.cwiseProduct(dv)), product, 1e-12));
}

}  // namespace
}  // namespace hexaplast
