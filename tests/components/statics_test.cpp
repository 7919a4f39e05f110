// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "hexaplast/body.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::read_and_init;

// A bar of 1 x 1 x 1 m in two slices along x, held at x = 0; Young's modulus 1000 Pa, no lateral contraction.
std::string static_bar(const std::string& solver, const std::string& more, const std::string& material = "") {
  return "<Node gravity='10 0 0' dt='0.02'><DefaultAnimationLoop/><StaticSolver name='statics'/>" + solver +
         "<SparseLDLSolver/><RegularGridTopology n='3 2 2'/><MechanicalObject name='nodes' velocity='0 0 1 0 0 1 0 0 1 "
         "0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1'/>"
         "<HexahedronElastoplasticFEMForceField name='body' youngModulus='1000' poissonRatio='0' " +
         material + "/><FixedProjectiveConstraint indices='0 3 6 9'/>" + more + "</Node>";
}
const std::string kNewton = "<NewtonRaphsonSolver maxNbIterationsNewton='50' maxNbIterationsLineSearch='8'/>";
const std::string kPull = "<ConstantForceField indices='2 5 8 11' totalForce='100 0 0'/>";

TEST(Statics, APulledBarGrowsByForceOverStiffness) {
  scene::Scene scene = read_and_init(static_bar(kNewton, kPull));
  EXPECT_TRUE(scene.diagnostics().take_warnings().empty());
  const SolveReport report = scene.step();
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.residual, 1e-5);
  EXPECT_GE(report.iterations, 1);
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  for (const int n : {2, 5, 8, 11}) EXPECT_NEAR(state.positions()(n, 0), 1.1, 1e-12);
  for (const int n : {1, 4, 7, 10}) EXPECT_NEAR(state.positions()(n, 0), 0.55, 1e-12);
  EXPECT_EQ(state.velocities(), PointArray::Zero(12, 3));

  const SolveReport again = scene.step();
  EXPECT_TRUE(again.converged) << "equilibrium stays equilibrium";
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(again.residual, 0);
}

// Of 10 kg/m^3 and 10 m/s^2: the upper slice carries three quarters of 100 N, the lower one a quarter.
TEST(Statics, AHangingBarGrowsByItsWeight) {
  scene::Scene scene = read_and_init(static_bar(kNewton, "<DiagonalMass massDensity='10'/>"));
  scene.step();
  const PointArray& x = at<scene::MechanicalState>(scene, "nodes").positions();
  EXPECT_NEAR(x(1, 0), 0.5375, 1e-12);
  EXPECT_NEAR(x(2, 0), 1.05, 1e-12);
}

// Stretch 1.1 and stress 100 Pa in equilibrium, yield stress 50 Pa: gamma = 2 x 0.02 x (100 - 50) / 100 = 0.02, and of
// the stretch's logarithm the part without change of volume flows.
TEST(Statics, FlowFollowsEquilibrium) {
  scene::Scene scene = read_and_init(static_bar(kNewton, kPull, "yieldStress='50' plasticFlowRate='2'"));
  scene.step();
  const PointArray& material = at<scene::ForceField>(scene, "body").body()->plastic_rest_positions();
  EXPECT_NEAR(material(2, 0) - material(0, 0), std::pow(1.1, 0.02 * 2 / 3), 1e-9);
}

TEST(Statics, WithoutNewtonRaphsonSolverOneIterationWithAWarning) {
  scene::Scene scene = read_and_init(
      static_bar("", "<ConstantForceField indices='2 5 8 11' totalForce='0 0 100'/>"));  // a bend: rotations change
  EXPECT_EQ(support::warnings_of(scene),
            "test.scn:1: warning: StaticSolver.newtonSolver: no NewtonRaphsonSolver in its node or above: takes one "
            "with default settings, a single iteration per step\n");
  const SolveReport report = scene.step();
  EXPECT_FALSE(report.converged);
  EXPECT_GT(report.residual, 1e-5);
}

TEST(Statics, AFollowedLinkCountsBeforeTheNearest) {
  const std::string two =
      "<NewtonRaphsonSolver name='one'/><NewtonRaphsonSolver name='many' maxNbIterationsNewton='99' "
      "maxNbIterationsLineSearch='8'/>";
  const auto converges = [&](const std::string& link) {
    std::string text = static_bar(two, "<ConstantForceField indices='2 5 8 11' totalForce='0 0 100'/>");
    text.insert(text.find("name='statics'"), link);
    scene::Scene scene = read_and_init(text);
    return scene.step().converged;
  };
  EXPECT_FALSE(converges(""));
  EXPECT_TRUE(converges("newtonSolver='@many' "));
}

}  // namespace
