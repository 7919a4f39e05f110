// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/springs.hpp"

#include "support/core.hpp"

namespace {

using namespace hexaplast;

PointArray nodes() { return Random(71).field(5, 1.2); }
PointArray velocities() { return Random(73).field(5, 0.5); }

std::vector<Spring> without_damping() {
  return {{0, 1, 30, 0, .8}, {1, 2, 12, 0, 1.9}, {4, 0, 7, 0, .1}, {2, 3, 40, 0, 3, true}, {3, 4, 9, 0, .5, true}};
}

PointArray force(Springs& springs, const PointArray& x, const PointArray& v) {
  PointArray f = PointArray::Zero(5, 3);
  springs.add_force(x, v, f);
  return f;
}

TEST(Springs, ForceIsMinusTheGradientOfTheEnergy) {
  Springs springs(without_damping(), 5);
  const PointArray x = nodes(), f = force(springs, x, PointArray::Zero(5, 3));
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    constexpr double kStep = 1e-5;
    PointArray ahead = x, behind = x;
    ahead.data()[i] += kStep;
    behind.data()[i] -= kStep;
    EXPECT_NEAR(f.data()[i], -(springs.energy(ahead) - springs.energy(behind)) / (2 * kStep), 1e-7) << i;
  }
  // those that only pull and are short do nothing
  Springs short_ones({{2, 3, 40, 7, 3, true}}, 5);
  EXPECT_EQ(force(short_ones, x, velocities()), PointArray::Zero(5, 3));
  EXPECT_EQ(short_ones.energy(x), 0);
}

TEST(Springs, ProductIsTheDerivativeOfTheForce) {
  Springs springs(without_damping(), 5);
  const PointArray x = nodes(), dx = velocities(), still = PointArray::Zero(5, 3);
  constexpr double kStep = 1e-5;
  const PointArray slope =
      (force(springs, x + kStep * dx, still) - force(springs, x - kStep * dx, still)) / (2 * kStep);
  force(springs, x, still);
  PointArray product = PointArray::Zero(5, 3);
  springs.add_stiffness_product(1, dx, product);
  EXPECT_LT((product - slope).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(Springs, BlocksAreTheProduct) {
  std::vector<Spring> all = without_damping();
  for (Spring& spring : all) spring.damping = .3;
  Springs springs(all, 5);
  force(springs, nodes(), velocities());
  BlockMatrix A(5);
  springs.add_stiffness_blocks(-2.5, A);
  const PointArray dx = velocities();
  PointArray product = PointArray::Zero(5, 3);
  springs.add_stiffness_product(-2.5, dx, product);
  EXPECT_LT((product - times(A, dx)).cwiseAbs().maxCoeff(), 1e-13);
}

// A spring along x of 2 m, at rest 1.5 m, whose ends go apart by .5 m/s: 10 * .5 + 4 * .5 = 7 N. Across, they go free.
TEST(Springs, DampingActsAlongASpring) {
  PointArray x(2, 3), v(2, 3), f = PointArray::Zero(2, 3);
  x << 1, 5, 5, 3, 5, 5;
  v << 0, 1, 0, .5, -1, 2;
  Springs springs({{0, 1, 10, 4, 1.5}}, 2);
  springs.add_force(x, v, f);
  EXPECT_EQ(f.row(0), Eigen::RowVector3d(7, 0, 0));
  EXPECT_EQ(f.row(1), Eigen::RowVector3d(-7, 0, 0));
}

TEST(Springs, OfNoLengthMakeNoForceAndWrongNodesAreRefused) {
  PointArray x = PointArray::Zero(2, 3), f = PointArray::Zero(2, 3);
  Springs springs({{0, 1, 10, 4, 1.5}}, 2);
  springs.add_force(x, x, f);
  EXPECT_EQ(f, PointArray::Zero(2, 3));
  EXPECT_THROW(Springs({{0, 2, 1, 0, 1}}, 2), InputError);
}

// From a set of three nodes to a set of two: as within one set that has all five, one behind the other.
TEST(Springs, BetweenTwoSetsOfNodes) {
  const std::vector<Spring> across{{0, 1, 30, .2, .8}, {2, 0, 40, .3, .9}, {1, 1, 9, 0, 3, true}};
  std::vector<Spring> within = across;
  for (Spring& spring : within) spring.b += 3;
  Springs springs(across, {3, 2}), expected(within, 5);
  const PointArray x = nodes(), v = velocities();
  const auto of_two = [](const PointArray& field) {
    return Pair<ConstPoints>(ConstPoints(field.topRows(3)), ConstPoints(field.bottomRows(2)));
  };
  PointArray f = PointArray::Zero(5, 3), product = f, expected_product = f;
  springs.add_force(of_two(x), of_two(v), {Points(f.topRows(3)), Points(f.bottomRows(2))});
  EXPECT_EQ(f, force(expected, x, v));
  EXPECT_GT(f.norm(), 1);
  EXPECT_EQ(springs.energy(of_two(x)), expected.energy(x));
  springs.add_stiffness_product(2, of_two(v), {Points(product.topRows(3)), Points(product.bottomRows(2))});
  expected.add_stiffness_product(2, v, expected_product);
  EXPECT_EQ(product, expected_product);

  // the second set before the first one in the matrix; and each of them alone, where the other one is not in it
  BlockMatrix A(5), B(5), first(3), second(2);
  springs.add_stiffness_blocks(2, A, {2, 0});
  expected.add_stiffness_blocks(2, B);
  springs.add_stiffness_blocks(2, first, {0, -1});
  springs.add_stiffness_blocks(2, second, {-1, 0});
  const Eigen::MatrixXd all = dense(B);
  const std::vector<int> swapped{9, 10, 11, 12, 13, 14, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(dense(A), all(swapped, swapped));
  for (int n = 0; n < 3; ++n) {
    const auto own = Eigen::seqN(3 * n, 3);
    EXPECT_EQ(dense(first)(own, own), all(own, own));
  }
  for (int n = 0; n < 2; ++n)
    EXPECT_EQ(dense(second)(Eigen::seqN(3 * n, 3), Eigen::seqN(3 * n, 3)),
              all(Eigen::seqN(9 + 3 * n, 3), Eigen::seqN(9 + 3 * n, 3)));
  EXPECT_THROW(Springs(across, {2, 2}), InputError);
  EXPECT_THROW(Springs(across, {3, 1}), InputError);
}

TEST(Springs, AnchorsPullBackToRest) {
  const PointArray rest = nodes();
  PointArray x = rest, f = PointArray::Zero(5, 3);
  x.row(1) += Eigen::RowVector3d(1, 2, 3);
  x.row(3) += Eigen::RowVector3d(0, 0, -2);
  const std::vector<int> held{1, 3};
  add_anchor_forces(held, std::vector<double>{10, 4}, rest, x, f);
  EXPECT_LT((f.row(1) - Eigen::RowVector3d(-10, -20, -30)).norm(), 1e-13);
  EXPECT_LT((f.row(3) - Eigen::RowVector3d(0, 0, 8)).norm(), 1e-13);
  EXPECT_EQ(f.row(0).norm() + f.row(2).norm() + f.row(4).norm(), 0);
}

}  // namespace
