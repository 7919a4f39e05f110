// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/sections.hpp"
#include "kinematics/polar.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

Model elastic_model(HexMesh mesh) {
  return Model(
      std::move(mesh), {Material{}},
      {.rest_shape = RestShape::kJoined, .averaging_tolerance = 1e-12, .implementation = Implementation::kPlain});
}

AveragingReport join(const Model& model, LinearSolver& solver, History& history) {
  return plain::join_rest_shapes(model, std::vector<unsigned char>(model.mesh.num_elements(), 1), solver, history);
}

/// Square of the misfit of isolated and joined shapes that the averaging minimises.
double misfit(const Model& model, const History& history) {
  double sum = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    if (!history.alive[e]) continue;
    const ElementPoints x = about_mean(gather(history.plastic_rest_positions, model.mesh.hexahedra()[e]));
    sum += (mapped(history.rest_shape[e], fit_rotation(history.rest_shape[e], x)) - x).squaredNorm();
  }
  return sum;
}

// Rest shapes that fit no mesh: Gauss-Newton steps overshoot, and are replaced. They come to a minimum all the same.
TEST(Averaging, NeverRaisesTheMisfitAndArrives) {
  Random random(405);
  int num_fell_back = 0;
  for (int round = 0; round < 30; ++round) {
    const Model model = elastic_model(distorted_block({3, 2, 2}, kEdge, 0.1, 406 + round));
    History history(model);
    for (ElementPoints& y : history.rest_shape)
      y = about_mean(std::exp(random.uniform(-3, 3)) * ElementPoints(random.field(kCorners, kEdge)));
    if (round == 0)  // less far from any mesh
      for (int e = 0; e < model.mesh.num_elements(); ++e)
        history.rest_shape[e] = about_mean(mapped(gather(model.mesh.positions(), model.mesh.hexahedra()[e]),
                                                  random.rotation() * (Mat3::Identity() + random.matrix(0.3))) +
                                           ElementPoints(random.field(kCorners, 0.25 * kEdge)));
    PreconditionedConjugateGradients solver(1e-14, 10000);
    PointArray before;
    for (int step = 0; step < (round == 0 ? 30 : 3); ++step) {
      before = history.plastic_rest_positions;
      const double misfit_before = misfit(model, history);
      num_fell_back += join(model, solver, history).fell_back;
      EXPECT_LE(misfit(model, history), misfit_before * (1 + 1e-9)) << round;
    }
    EXPECT_TRUE(round > 0 || max_abs(history.plastic_rest_positions - before) < 1e-6 * kEdge);
  }
  EXPECT_GT(num_fell_back, 0);
}

/// Rest shapes cut from the mesh in other positions, each in a frame of its own.
History cut_from(const Model& model, const PointArray& positions) {
  Random random(147);
  History history(model);
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    history.rest_shape[e] = mapped(about_mean(gather(positions, model.mesh.hexahedra()[e])), random.rotation());
  return history;
}

TEST(Averaging, JoinsPiecesOfATwistedBarWhateverTheSize) {
  for (const int refine : {1, 2, 4}) {
    const Model model(block({3 * refine, 2 * refine, 8 * refine}, kEdge / refine), {Material{}},
                      {.rest_shape = RestShape::kJoined, .implementation = Implementation::kPlain});
    History history = cut_from(model, stretched_and_twisted(model.mesh, 1.2, 1.0));
    PreconditionedConjugateGradients solver = plain::averaging_solver(model);
    for (int k = 0; k < 12; ++k) EXPECT_TRUE(join(model, solver, history).converged);
    const EndSections ends = end_sections(model.mesh);
    EXPECT_NEAR(elongation(ends, history.plastic_rest_positions), 0.2, 1e-6);
    EXPECT_NEAR(twist(model.mesh, ends, history.plastic_rest_positions), 1.0, 1e-6) << "refine " << refine;
  }
}

TEST(Averaging, LeavesConnectedPartsThatDoNotFlowBitForBit) {
  const HexMesh one = block({2, 2, 10}, kEdge);
  const HexMesh mesh = two_copies(one, 1);
  const Material soft{.yield_stress = 50, .flow_rate = 2};
  std::vector<Material> materials(mesh.num_elements(), soft);
  for (int e = one.num_elements(); e < mesh.num_elements(); ++e) materials[e].yield_stress = 1e9;
  const Settings settings{.rest_shape = RestShape::kJoined, .averaging_tolerance = 1e-9};  // of all parts together
  Body body(mesh, materials, settings), alone(one, {soft}, settings);
  for (int k = 1; k <= 10; ++k) {
    const PointArray bent = stretched_and_twisted(one, 1 + 0.02 * k, 0.1 * k);
    PointArray current(mesh.num_nodes(), 3);
    current << bent, mapped(bent, Mat3::Identity(), Vec3(1, 0, 0));
    EXPECT_GT(body.flow(current, 0.01).yielded, 0);
    alone.flow(bent, 0.01);
  }
  EXPECT_EQ(body.state().history.plastic_rest_positions.bottomRows(one.num_nodes()),
            mesh.positions().bottomRows(one.num_nodes()));
  const PointArray flowed = body.state().history.plastic_rest_positions.topRows(one.num_nodes());
  EXPECT_LE(max_abs(flowed - alone.state().history.plastic_rest_positions), 1e-6 * kEdge);
  EXPECT_GT(max_abs(flowed - one.positions()), 1e-2 * kEdge);
}

TEST(Averaging, OfATornBodyKeepsTheMeanOfEachPart) {
  const Model model = elastic_model(distorted_block({4, 5, 8}, kEdge, 0.1, 148));
  Random random(149);
  History torn(model);
  for (ElementPoints& y : torn.rest_shape) y = about_mean(mapped(y, Mat3::Identity() + random.matrix(0.2)));
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const int layer = e / 20;
    if (layer == 3 || e % 13 == 0) {  // two pieces, with holes
      torn.alive[e] = 0;
      torn.removed.push_back(e);
    }
  }
  const ConnectedParts parts = connected_parts(model.mesh, torn.alive);
  ASSERT_EQ(parts.count, 2);
  History joined = torn;
  PreconditionedConjugateGradients solver(1e-11, 1000);
  EXPECT_TRUE(join(model, solver, joined).converged);
  EXPECT_GT(max_abs(joined.plastic_rest_positions - torn.plastic_rest_positions), 1e-2 * kEdge);
  EXPECT_LT(misfit(model, joined), misfit(model, torn));
  std::array<Vec3, 2> shift{Vec3::Zero(), Vec3::Zero()};
  for (int n = 0; n < model.mesh.num_nodes(); ++n)
    if (parts.part_of_node[n] >= 0)
      shift[parts.part_of_node[n]] += Vec3(joined.plastic_rest_positions.row(n) - torn.plastic_rest_positions.row(n));
  for (const Vec3& one : shift) EXPECT_LE(one.norm(), 1e-10);
}

TEST(Averaging, LeavesShapesThatFitUntouched) {
  Random random(145);
  const Model model = elastic_model(distorted_block({2, 2, 3}, kEdge, 0.15, 146));
  History history(model);
  for (ElementPoints& y : history.rest_shape) y = mapped(y, random.rotation());  // each in a frame of its own
  PreconditionedConjugateGradients solver(1e-12, 10000);
  EXPECT_TRUE(join(model, solver, history).skipped);
  EXPECT_EQ(history.plastic_rest_positions, model.mesh.positions());
}

/// Flows in stretch and rotation at the strains of a bar twisted by hand.
Material twistable(double rotation_yield) {
  return {.yield_stress = 50, .flow_rate = 2, .rotation_yield = rotation_yield, .rotation_flow_rate = 2};
}

// What is left of one step is taken up by the next, and nothing grows; on a mesh without symmetry, of which no solver
// could take advantage.
TEST(Averaging, OfABodyFollowsATightSolutionOverManyStepsByOneStepEach) {
  const HexMesh mesh = distorted_block({8, 8, 20}, kEdge / 2, 0.1, 150);
  const HeldTwist twist{.stretch = 1.3, .angle = 2, .steps = 60};
  Body body(mesh, {twistable(0.0025)}, kJoined),
      more_steps(mesh, {twistable(0.0025)}, {.rest_shape = RestShape::kJoined, .averaging_steps = 4});
  twist.flow(more_steps);
  const Model& model = body.state().model;
  History history(model);
  PreconditionedConjugateGradients exact(1e-12, 10000);
  for (int step = 1; step <= twist.steps; ++step) {
    body.flow(twist.at(mesh, step), twist.dt);
    plain::flow(model, twist.at(mesh, step), twist.dt, exact, history);
  }
  const PointArray& x = body.plastic_rest_positions();
  EXPECT_LE(max_abs(x - history.plastic_rest_positions), 1e-6 * kEdge);
  const EndSections ends = end_sections(mesh);
  EXPECT_GT(hexaplast::twist(mesh, ends, x), 0.1);
  EXPECT_NEAR(hexaplast::twist(mesh, ends, more_steps.plastic_rest_positions()) / hexaplast::twist(mesh, ends, x), 1,
              1e-3);
}

/// Angle between the original and the plastic rest shape of a distorted bar after it was stretched and twisted [rad].
double tilt_after_a_twist(bool turns_isolated_shapes) {
  Body body(distorted_block({2, 2, 6}, kEdge, 0.2, 151), {twistable(0.005)}, kJoined);
  body.state().model.turns_isolated_shapes = turns_isolated_shapes;
  HeldTwist{.stretch = 1.3, .angle = 1.5, .steps = 60}.flow(body);
  const PointArray before = body.mesh().positions(), after = body.plastic_rest_positions();
  const Mat3 covariance =
      (after.rowwise() - after.colwise().mean()).transpose() * (before.rowwise() - before.colwise().mean());
  return rotation_log(polar(covariance).R).norm();
}

// A step that leaves the rotations of the isolated shapes free mixes turns of the whole body into the solution.
TEST(Averaging, DoesNotTiltABodyOfDistortedHexahedra) {
  EXPECT_LE(tilt_after_a_twist(false), 1e-2);
  EXPECT_GE(tilt_after_a_twist(true), 5e-2);
}

}  // namespace
}  // namespace hexaplast
