// SPDX-License-Identifier: LGPL-2.1-or-later

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/geometry/sections.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "plain/plain.hpp"
#include "plastic/rest_shape.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/motion.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::kEdge;
using support::kJoined;
using support::mapped;

Settings tight() {
  Settings settings = kJoined;
  settings.averaging_tolerance = 1e-12;
  return settings;
}

Model elastic_model(HexMesh mesh) { return Model(std::move(mesh), {Material{}}, tight()); }

/// History in which every element for itself would like to be stretched by half along z.
History stretched_rest_shapes(const Model& model) {
  History history(model);
  for (ElementPoints& y : history.rest_shape) y = mapped(y, Vec3(1, 1, 1.5).asDiagonal());
  return history;
}

AveragingReport join(const Model& model, LinearSolver& solver, History& history) {
  return plain::join_rest_shapes(model, std::vector<unsigned char>(model.mesh.num_elements(), 1), solver, history);
}

/// Square of the misfit of isolated and joined shapes that the averaging minimises.
double misfit(const Model& model, const History& history) {
  double sum = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const ElementPoints x = about_mean(gather(history.plastic_rest_positions, model.mesh.hexahedra()[e]));
    sum += (mapped(history.rest_shape[e], fit_rotation(history.rest_shape[e], x)) - x).squaredNorm();
  }
  return sum;
}

TEST(Averaging, JoinsStretchedElementsIntoAStretchedBarOfAnyLength) {
  for (const int slices : {10, 20, 40}) {
    const Model model = elastic_model(support::block({2, 2, slices}, kEdge));
    const EndSections ends = end_sections(model.mesh);
    for (const bool direct : {false, true}) {
      History history = stretched_rest_shapes(model);
      PreconditionedConjugateGradients iterative(1e-12, 10000);
      CholeskySolver cholesky;
      LinearSolver& solver = direct ? static_cast<LinearSolver&>(cholesky) : iterative;
      join(model, solver, history);
      EXPECT_NEAR(elongation(ends, history.plastic_rest_positions), 0.5,
                  1e-6);  // one step leaves its regularisation, 1e-7
      join(model, solver, history);
      EXPECT_NEAR(elongation(ends, history.plastic_rest_positions), 0.5, 1e-9) << slices << " slices";
    }
  }
}

TEST(Averaging, KeepsTheMeanOfEveryConnectedPart) {
  const HexMesh one = support::distorted_block({2, 2, 3}, kEdge, 0.15, 141);
  const HexMesh mesh = support::two_copies(one, 5);
  const PointArray& positions = mesh.positions();
  const Model model = elastic_model(mesh);
  ASSERT_EQ(connected_parts(model.mesh, History(model).alive).count, 2);

  support::Random random(142);
  History history(model);
  for (ElementPoints& y : history.rest_shape) y = about_mean(mapped(y, Mat3::Identity() + random.matrix(0.3)));
  PreconditionedConjugateGradients solver(1e-12, 10000);
  EXPECT_FALSE(join(model, solver, history).skipped);
  for (const int first : {0, one.num_nodes()}) {
    const Vec3 before = positions.middleRows(first, one.num_nodes()).colwise().mean();
    const Vec3 after = history.plastic_rest_positions.middleRows(first, one.num_nodes()).colwise().mean();
    EXPECT_LE((after - before).norm(), 1e-12);
  }
  EXPECT_GT(support::max_abs(history.plastic_rest_positions - positions), 1e-3);
}

TEST(Averaging, NeverRaisesTheMisfitAndArrives) {
  support::Random random(143);
  const Model model = elastic_model(support::distorted_block({2, 2, 3}, kEdge, 0.15, 144));
  for (const double size : {0.1, 0.5, 1.0}) {
    History history(model);
    for (ElementPoints& y : history.rest_shape) {
      y = about_mean(ElementPoints(mapped(y, random.rotation() * (Mat3::Identity() + random.matrix(0.3))) +
                                   ElementPoints(random.field(kCorners, size * kEdge / 2))));
    }
    PreconditionedConjugateGradients solver(1e-12, 10000);
    double before = misfit(model, history);
    for (int k = 0; k < 30; ++k) {
      join(model, solver, history);
      const double after = misfit(model, history);
      ASSERT_LE(after, before * (1 + 1e-12));
      before = after;
    }
    // at the minimum one more step changes nothing
    const PointArray arrived = history.plastic_rest_positions;
    join(model, solver, history);
    EXPECT_LE(support::max_abs(history.plastic_rest_positions - arrived), 1e-6 * kEdge);
  }
}

// Rest shapes that fit no mesh: Gauss-Newton steps overshoot, and are replaced.
TEST(Averaging, ReplacesStepsThatOvershoot) {
  support::Random random(405);
  int num_fell_back = 0;
  for (int round = 0; round < 30; ++round) {
    const Model model = elastic_model(support::distorted_block({3, 2, 2}, kEdge, 0.1, 406 + round));
    History history(model);
    for (ElementPoints& y : history.rest_shape)
      y = about_mean(std::exp(random.uniform(-3, 3)) * ElementPoints(random.field(kCorners, kEdge)));
    PreconditionedConjugateGradients solver(1e-14, 10000);
    for (int step = 0; step < 3; ++step) {
      const double before = misfit(model, history);
      num_fell_back += join(model, solver, history).fell_back;
      EXPECT_LE(misfit(model, history), before * (1 + 1e-9)) << round;
    }
  }
  EXPECT_GT(num_fell_back, 0);
}

/// Rest shapes cut from the mesh in other positions, each in a frame of its own.
History cut_from(const Model& model, const PointArray& positions) {
  support::Random random(147);
  History history(model);
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    history.rest_shape[e] = mapped(about_mean(gather(positions, model.mesh.hexahedra()[e])), random.rotation());
  return history;
}

TEST(Averaging, JoinsPiecesOfATwistedBarWhateverTheSize) {
  for (const int refine : {1, 2, 4}) {
    const Model model(support::block({3 * refine, 2 * refine, 8 * refine}, kEdge / refine), {Material{}}, kJoined);
    History history = cut_from(model, support::stretched_and_twisted(model.mesh, 1.2, 1.0));
    PreconditionedConjugateGradients solver = averaging_solver(model);
    for (int k = 0; k < 12; ++k) EXPECT_TRUE(join(model, solver, history).converged);
    const EndSections ends = end_sections(model.mesh);
    EXPECT_NEAR(elongation(ends, history.plastic_rest_positions), 0.2, 1e-6);
    EXPECT_NEAR(twist(model.mesh, ends, history.plastic_rest_positions), 1.0, 1e-6) << "refine " << refine;
  }
}

TEST(Averaging, LeavesConnectedPartsThatDoNotFlowBitForBit) {
  const HexMesh one = support::block({2, 2, 10}, kEdge);
  const HexMesh mesh = support::two_copies(one, 1);
  Material soft;
  soft.yield_stress = 50;
  soft.flow_rate = 2;
  std::vector<Material> materials(mesh.num_elements(), soft);
  for (int e = one.num_elements(); e < mesh.num_elements(); ++e) materials[e].yield_stress = 1e9;
  Settings settings = kJoined;
  settings.averaging_tolerance = 1e-9;  // of all parts together
  Body body(mesh, materials, settings), alone(one, {soft}, settings);
  for (int k = 1; k <= 10; ++k) {
    const PointArray bent = support::stretched_and_twisted(one, 1 + 0.02 * k, 0.1 * k);
    PointArray current(mesh.num_nodes(), 3);
    current << bent, mapped(bent, Mat3::Identity(), Vec3(1, 0, 0));
    EXPECT_GT(body.flow(current, 0.01).yielded, 0);
    alone.flow(bent, 0.01);
  }
  EXPECT_EQ(body.state().history.plastic_rest_positions.bottomRows(one.num_nodes()),
            mesh.positions().bottomRows(one.num_nodes()));
  const PointArray flowed = body.state().history.plastic_rest_positions.topRows(one.num_nodes());
  EXPECT_LE(support::max_abs(flowed - alone.state().history.plastic_rest_positions), 1e-6 * kEdge);
  EXPECT_GT(support::max_abs(flowed - one.positions()), 1e-2 * kEdge);
}

TEST(Averaging, ByMultigridAgreesWithTheDirectSolverOnTornBodies) {
  const Model model = elastic_model(support::distorted_block({4, 5, 8}, kEdge, 0.1, 148));
  support::Random random(149);
  History torn(model);
  for (ElementPoints& y : torn.rest_shape) y = about_mean(mapped(y, Mat3::Identity() + random.matrix(0.2)));
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const int layer = e / 20;
    if (layer == 3 || e % 13 == 0) {  // two pieces, with holes
      torn.alive[e] = 0;
      torn.removed.push_back(e);
    }
  }
  ASSERT_EQ(connected_parts(model.mesh, torn.alive).count, 2);
  History iterated = torn, exact = torn;
  PreconditionedConjugateGradients multigrid(1e-11, 1000, Preconditioner::kMultigrid);
  CholeskySolver cholesky;
  join(model, multigrid, iterated);
  join(model, cholesky, exact);
  EXPECT_GT(support::max_abs(exact.plastic_rest_positions - torn.plastic_rest_positions), 1e-2 * kEdge);
  EXPECT_LE(support::max_abs(iterated.plastic_rest_positions - exact.plastic_rest_positions), 1e-6 * kEdge);
}

TEST(Averaging, LeavesShapesThatFitUntouched) {
  support::Random random(145);
  const Model model = elastic_model(support::distorted_block({2, 2, 3}, kEdge, 0.15, 146));
  History history(model);
  for (ElementPoints& y : history.rest_shape) y = mapped(y, random.rotation());  // each in a frame of its own
  PreconditionedConjugateGradients solver(1e-12, 10000);
  EXPECT_TRUE(join(model, solver, history).skipped);
  EXPECT_EQ(history.plastic_rest_positions, model.mesh.positions());
}

/// Flows in stretch and rotation at the strains of a bar twisted by hand.
Material twistable(double rotation_yield) {
  Material m;
  m.yield_stress = 50;
  m.flow_rate = 2;
  m.rotation_flow_rate = 2;
  m.rotation_yield = rotation_yield;
  return m;
}

/// Permanent twist of a bar twisted by hand, with `averaging_steps` per time step.
double permanent_twist(int averaging_steps) {
  Settings settings = kJoined;
  settings.averaging_steps = averaging_steps;
  Body body(support::block({2, 2, 10}, kEdge), {twistable(0.005)}, settings);
  for (int k = 1; k <= 60; ++k) {
    const double fraction = std::min(1.0, k / 40.0);
    const PointArray current = support::stretched_and_twisted(body.mesh(), 1 + 0.3 * fraction, 2 * fraction);
    body.flow(current, 0.01);
  }
  return twist(body.mesh(), end_sections(body.mesh()), body.state().history.plastic_rest_positions);
}

// What is left of one step is taken up by the next, and nothing grows; on a mesh without symmetry, of which no solver
// could take advantage.
TEST(Averaging, OfABodyFollowsATightSolutionOverManySteps) {
  Body body(support::distorted_block({8, 8, 20}, kEdge / 2, 0.1, 150), {twistable(0.0025)}, kJoined);
  const Model& model = body.state().model;
  History history(model);
  PreconditionedConjugateGradients exact(1e-12, 10000);
  for (int k = 1; k <= 100; ++k) {
    const double fraction = std::min(1.0, k / 40.0);
    const PointArray current = support::stretched_and_twisted(model.mesh, 1 + 0.3 * fraction, 2 * fraction);
    body.flow(current, 0.01);
    plain::flow(model, current, 0.01, exact, history);
  }
  EXPECT_LE(support::max_abs(body.state().history.plastic_rest_positions - history.plastic_rest_positions),
            1e-6 * kEdge);
}

/// Angle between the original and the plastic rest shape of a distorted bar after it was stretched and twisted [rad].
double tilt_after_a_twist(bool turns_isolated_shapes) {
  Body body(support::distorted_block({2, 2, 6}, kEdge, 0.2, 151), {twistable(0.005)}, kJoined);
  body.state().model.turns_isolated_shapes = turns_isolated_shapes;
  for (int k = 1; k <= 60; ++k) {
    const double fraction = std::min(1.0, k / 40.0);
    body.flow(support::stretched_and_twisted(body.mesh(), 1 + 0.3 * fraction, 1.5 * fraction), 0.01);
  }
  const PointArray before = body.mesh().positions(), after = body.state().history.plastic_rest_positions;
  const Mat3 covariance =
      (after.rowwise() - after.colwise().mean()).transpose() * (before.rowwise() - before.colwise().mean());
  return rotation_log(polar(covariance).R).norm();
}

// A step that leaves the rotations of the isolated shapes free mixes turns of the whole body into the solution.
TEST(Averaging, DoesNotTiltABodyOfDistortedHexahedra) {
  EXPECT_LE(tilt_after_a_twist(false), 1e-2);
  EXPECT_GE(tilt_after_a_twist(true), 5e-2);
}

TEST(Averaging, IsConvergedAfterOneStepPerTimeStep) {
  const double one = permanent_twist(1), four = permanent_twist(4);
  EXPECT_GT(one, 0.1);
  EXPECT_NEAR(one, four, 1e-3 * four);
}

}  // namespace
}  // namespace hexaplast
