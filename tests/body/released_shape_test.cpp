// SPDX-License-Identifier: LGPL-2.1-or-later
// Plastic rest positions of isolated rest shapes: the shape of a body that nothing loads and nothing holds.
#include "support/archive.hpp"
#include "support/core.hpp"
#include "support/history.hpp"

namespace hexaplast {
namespace {

constexpr double kModulus = 5000;

/// Along x, of square cells.
PointArray bent(const PointArray& X, double angle) {
  const double length = X.col(0).maxCoeff(), radius = length / angle, middle = X.col(2).maxCoeff() / 2;
  PointArray x = X;
  for (Eigen::Index n = 0; n < X.rows(); ++n) {
    const double arm = radius - (X(n, 2) - middle), turn = X(n, 0) / radius;
    x(n, 0) = arm * std::sin(turn);
    x(n, 2) = radius - arm * std::cos(turn);
  }
  return x;
}

class ReleasedShapeOf : public testing::TestWithParam<Implementation> {
 protected:
  static Body made(const HexMesh& mesh) {
    return Body(mesh, {Material{.young_modulus = kModulus, .yield_stress = 100, .flow_rate = 1}},
                {.rest_shape = RestShape::kIsolated, .implementation = GetParam()});
  }
  /// A bar that was bent by so much, and has flowed there: ideal plastic, with residual stress.
  static Body bent_bar(double angle) {
    Body body = made(block({16, 2, 3}, kEdge));
    bend(body, angle);
    return body;
  }
  static void bend(Body& body, double angle, double from = 0) {
    for (int step = 1; step <= 20; ++step)
      body.flow(bent(body.mesh().positions(), from + step / 20.0 * (angle - from)), 1);
  }
};
INSTANTIATE_TEST_SUITE_P(Of, ReleasedShapeOf, testing::Values(Implementation::kPlain, Implementation::kAuto),
                         [](const auto& test) { return test.param == Implementation::kPlain ? "plain" : "kernels"; });

TEST_P(ReleasedShapeOf, OneDeformationOfAllIsTheMeshThatIsDeformedSo) {
  Random random(701);
  Body body = made(distorted_block({4, 3, 3}, kEdge, 0.15, 702));
  const Mat3 stretch = Vec3(1.4, 0.9, 1 / (1.4 * 0.9)).asDiagonal(), turn = random.rotation();
  const Mat3 plastic = random.rotation() * turn * stretch * turn.transpose();
  History& history = body.state().history;
  for (CornerTensors& of_element : history.plastic_inverse) of_element.fill(plastic.inverse());
  take_flowed(body);
  EXPECT_LE(incongruence(body.plastic_rest_positions(), mapped(body.mesh().positions(), plastic)), 1e-3 * kEdge);
}

TEST_P(ReleasedShapeOf, ABentBarIsInEquilibriumWhereItsEnergyIsLeast) {
  Body body = bent_bar(0.8 * std::numbers::pi);
  const PointArray x = body.plastic_rest_positions();
  EXPECT_GT(incongruence(x, body.mesh().positions()), kEdge) << "it is bent";
  EXPECT_LE(max_abs(force_at(body, x)), 1e-3 * kModulus * kEdge * kEdge);
  const double energy = body.energy(x);
  EXPECT_GT(energy, 1e-4 * body.energy(body.mesh().positions())) << "of residual stress";
  Random random(703);
  for (const double size : {0.003, 0.01, 0.1})
    for (int round = 0; round < 3; ++round)
      EXPECT_LT(energy, body.energy(x + random.field(x.rows(), size * kEdge))) << size;
  for (const double angle : {0.3, 0.4}) EXPECT_LT(energy, body.energy(bent(body.mesh().positions(), angle)));
}

// Corners that are thin there have their energy in it too.                                                  eq. E32
TEST_P(ReleasedShapeOf, ACrumpledBarIsInEquilibriumWithItsThinCorners) {
  const auto crumpled = [](RecoveryMode recovery) {
    const HexMesh mesh = block({2, 2, 3}, kEdge);
    Body body(mesh, {Material{.young_modulus = kModulus, .yield_stress = 100, .flow_rate = 50}},
              {.recovery = recovery, .implementation = GetParam()});
    const PointArray moved = Random(707).field(mesh.num_nodes(), .6 * kEdge);
    for (int step = 1; step <= 30; ++step) body.flow(mesh.positions() + step / 30.0 * moved, .01);
    return body;
  };
  Body body = crumpled(RecoveryMode::kCluster);
  const PointArray x = body.plastic_rest_positions();
  EXPECT_GT(body.energy(x), 1.01 * crumpled(RecoveryMode::kNone).energy(x)) << "some corners are thin";
  EXPECT_LE(max_abs(force_at(body, x)), 1e-3 * kModulus * kEdge * kEdge);
}

TEST_P(ReleasedShapeOf, DoesNotDependOnWhenItWasAskedBefore) {
  Body body = bent_bar(0.3 * std::numbers::pi);
  const PointArray before = body.plastic_rest_positions();
  bend(body, 0.6 * std::numbers::pi, 0.3 * std::numbers::pi);
  const Body other = body;
  EXPECT_GT(incongruence(body.plastic_rest_positions(), before), 0.9 * kEdge);
  EXPECT_EQ(body.plastic_rest_positions(), other.plastic_rest_positions());
}

TEST_P(ReleasedShapeOf, IsAskedForWithoutATrace) {
  Body body = bent_bar(0.2 * std::numbers::pi);
  const std::string hash = hash_of(body), file = saved(body);
  const PointArray x = bent(body.mesh().positions(), 0.5), f = force_at(body, x);
  EXPECT_NE(body.plastic_rest_positions(), body.mesh().positions());
  PointArray again = PointArray::Zero(x.rows(), 3);
  body.add_force(again);
  EXPECT_EQ(again, f);
  EXPECT_EQ(hash_of(body), hash);
  EXPECT_EQ(saved(body), file);
}

TEST_P(ReleasedShapeOf, IsTheMeshBeforeAnythingHasFlowedAndAfterAReset) {
  Body body = made(distorted_block({3, 2, 2}, kEdge, 0.15, 704));
  EXPECT_EQ(body.plastic_rest_positions(), body.mesh().positions());
  body.flow(mapped(body.mesh().positions(), Vec3(1.01, 1, 1).asDiagonal()), 1);
  EXPECT_EQ(body.plastic_rest_positions(), body.mesh().positions()) << "elastic";
  bend(body, 1);
  EXPECT_NE(body.plastic_rest_positions(), body.mesh().positions());
  body.reset();
  EXPECT_EQ(body.plastic_rest_positions(), body.mesh().positions());
}

TEST_P(ReleasedShapeOf, HasTheSameBitsForAnyThreadCount) {
  Body body = made(block({24, 4, 4}, kEdge));
  bend(body, 0.5 * std::numbers::pi);
  expect_the_same_for_any_threads([&] { return Body(body).plastic_rest_positions(); });
}

// Hexahedra in a row, each of eight points that want other shapes: nothing that flow leaves.
TEST_P(ReleasedShapeOf, SaysWhereItsIterationsDidNotConverge) {
  Random random(705);
  Body body = made(distorted_block({40, 1, 1}, kEdge, 0.1, 706));
  History& history = body.state().history;
  for (CornerTensors& of_element : history.plastic_inverse)
    for (Mat3& G : of_element) {
      const Mat3 turn = random.rotation();
      G = turn * Vec3(1.6, 1, 1 / 1.6).asDiagonal() * turn.transpose();
    }
  take_flowed(body);
  EXPECT_FALSE(body.plastic_rest_has_converged());
  EXPECT_LT(body.energy(body.plastic_rest_positions()), body.energy(body.mesh().positions())) << "the best of them";
  EXPECT_TRUE(bent_bar(1).plastic_rest_has_converged());
}

// Pieces lie where they lay in the mesh, each by itself; nodes that have lost their hexahedra do too.
TEST_P(ReleasedShapeOf, LaysEachPieceOnItsInitialPlace) {
  Body body = bent_bar(0.3 * std::numbers::pi);
  const PointArray& X = body.mesh().positions();
  std::vector<int> gone;
  for (int e = 0; e < body.mesh().num_elements(); ++e) {
    const double middle = gather(X, body.mesh().hexahedra()[e]).col(0).mean();
    if (middle > 6 * kEdge && middle < 8 * kEdge) gone.push_back(e);
  }
  body.remove(gone);
  const PointArray x = body.plastic_rest_positions();
  const ConnectedParts parts = connected_parts(body.mesh(), body.alive());
  EXPECT_EQ(parts.count, 2);
  std::vector<Vec3> shift(2, Vec3::Zero());
  for (int n = 0; n < body.mesh().num_nodes(); ++n)
    if (parts.part_of_node[n] < 0)
      EXPECT_EQ(x.row(n), X.row(n));
    else
      shift[parts.part_of_node[n]] += (x.row(n) - X.row(n)).transpose();
  for (const Vec3& one : shift) EXPECT_LE(one.norm(), 1e-9 * kEdge);
  EXPECT_LE(max_abs(force_at(body, x)), 1e-3 * kModulus * kEdge * kEdge);
}

}  // namespace
}  // namespace hexaplast
