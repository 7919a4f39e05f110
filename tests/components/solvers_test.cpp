// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

// A bar of 2 x 2 x 5 hexahedra, held at one end, pulled aside at the other.
std::string pulled_bar(const std::string& ode_solver, const std::string& linear_solver) {
  return "<Node dt='0.02' gravity='0 -3 0'><DefaultAnimationLoop/>" + ode_solver + linear_solver +
         "<RegularGridTopology n='3 3 6' min='0 0 0' max='0.2 0.2 0.5'/><MechanicalObject name='nodes'/>"
         "<DiagonalMass massDensity='1000'/><BoxROI name='end' box='-1 -1 -.01  1 1 .01'/>"
         "<BoxROI name='far' box='-1 -1 .49  1 1 .51'/><FixedProjectiveConstraint indices='@end.indices'/>"
         "<ConstantForceField indices='@far.indices' totalForce='6 2 -3'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='2e4' poissonRatio='0.4' yieldStress='300' "
         "plasticFlowRate='4' rayleighStiffness='0.01'/></Node>";
}

PointArray end_of_run(const std::string& ode_solver, const std::string& linear_solver, int steps = 25) {
  scene::Scene scene = read_and_init(pulled_bar(ode_solver, linear_solver));
  for (int k = 0; k < steps; ++k) scene.step();
  return at<scene::MechanicalState>(scene, "nodes").positions();
}

const std::vector<std::string> kExactSolvers = {
    "<MultigridCGLinearSolver tolerance='1e-13' iterations='2000'/>",
    "<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-30'/>",
    "<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-30' warmStart='true'/>"};

// Time integration, equilibrium, and every linear solver: the same trajectory, up to what the solvers leave.
TEST(SolverPairs, GiveTheSameTrajectory) {
  const std::vector<std::string> ode_solvers = {
      "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.1'/>",
      "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.05' trapezoidalScheme='true' vdamping='0.3'/>",
      "<EulerImplicitSolver firstOrder='true'/>",
      "<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='40' maxNbIterationsLineSearch='3' "
      "absoluteResidualStoppingThreshold='1e-9' relativeSuccessiveStoppingThreshold='0' "
      "relativeInitialStoppingThreshold='0'/>"};
  for (const std::string& ode_solver : ode_solvers) {
    const int steps = ode_solver.starts_with("<Static") ? 3 : 25;
    const PointArray reference = end_of_run(ode_solver, "<SparseLDLSolver/>", steps);
    EXPECT_GT(max_abs(reference - end_of_run(ode_solver, "<SparseLDLSolver/>", steps - 1)), 1e-5)
        << ode_solver << " does not move";
    for (const std::string& linear_solver : kExactSolvers)
      EXPECT_LE(max_abs(end_of_run(ode_solver, linear_solver, steps) - reference), 1e-9) << ode_solver << linear_solver;
  }
}

double fall(const std::string& attributes, const std::string& of_mass = "") {
  scene::Scene scene = read_and_init(
      "<Node dt='0.5' gravity='0 0 -10'><DefaultAnimationLoop/><EulerImplicitSolver " + attributes +
      "/><SparseLDLSolver/><MechanicalObject name='nodes' position='0 0 7' velocity='0 0 2'/><UniformMass "
      "vertexMass='3' " +
      of_mass + "/></Node>");
  run(scene, 2);
  return nodes(scene)(0, 2);
}

// Two steps of h = .5 with v0 = 2, g = -10: v1 = -3, then v decays or not, v2 = v1 - 5. With the solver's damping
// v' = (v + h g) / (1 + h rM), with the mass's own v' = v + h g / (1 + h m).
TEST(EulerImplicitSolver, AFreeMassFollowsTheDiscreteLawOfEachScheme) {
  EXPECT_DOUBLE_EQ(fall(""), 7 + 0.5 * (-3 - 8));
  EXPECT_DOUBLE_EQ(fall("rayleighMass='0.4'"), 7 + 0.5 * (-3 / 1.2 + (-3 / 1.2 - 5) / 1.2));
  EXPECT_DOUBLE_EQ(fall("", "rayleighMass='0.4'"), 7 + 0.5 * (2 * (2 - 5 / 1.2) - 5 / 1.2));
  EXPECT_NEAR(fall("vdamping='0.8'"), 7 + 0.5 * (-3 + (-3 * std::exp(-0.4) - 5)), 1e-14);
  double v = 2, z = 7;
  for (int k = 0; k < 2; ++k) {
    v += 0.5 * (-10 - 0.4 * v) / (1 + 0.25 * 0.4);
    z += 0.5 * v;
  }
  EXPECT_DOUBLE_EQ(fall("rayleighMass='0.4' trapezoidalScheme='true'"), z);
  EXPECT_DOUBLE_EQ(fall("firstOrder='true' rayleighMass='0.4'"), 7 - 2 * 0.5 * 10);
}

// A load that begins at t = .5: the first step (from 0 to .5) does not feel it, the second does.
TEST(TimeStep, ForcesAreThoseOfItsBeginning) {
  scene::Scene scene = read_and_init(four_nodes("<LinearForceField points='0' times='0.5' forces='0 6 0'/>"));
  const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
  scene.step();
  EXPECT_EQ(v, PointArray::Zero(4, 3));
  scene.step();
  EXPECT_EQ(v(0, 1), 3);
  EXPECT_EQ(scene.time(), 1);
}

TEST(TimeStep, ConstantNodalForcesOfTheStateAct) {
  scene::Scene scene =
      read_and_init(in_root("gravity='0 0 0' dt='1'",
                            "<MechanicalObject name='nodes' position='0 0 0  1 0 0' externalForce='0 0 0  0 3 "
                            "0'/><UniformMass vertexMass='2'/>"));
  scene.step();
  const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
  EXPECT_TRUE(v.isApprox(rows({{0, 0, 0}, {0, 1.5, 0}}), 1e-15)) << v;
}

/// A slab of 10 x 10 x 3 hexahedra, held at one side and falling, and what acts beside it.
std::string slab(const std::string& beside, const std::string& nodes = "11 11 4",
                 const std::string& preconditioner = "multigrid") {
  return "<Node dt='0.01' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='0.1' "
         "rayleighStiffness='0.01'/><MultigridCGLinearSolver name='solver' tolerance='1e-6' preconditioner='" +
         preconditioner + "'/><RegularGridTopology n='" + nodes +
         "' max='0.1 0.1 0.03'/><MechanicalObject name='nodes'/>"
         "<DiagonalMass massDensity='1000'/><BoxROI name='end' box='-1 -1 -1  1e-6 1 1'/><FixedProjectiveConstraint "
         "indices='@end.indices'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='1e5' poissonRatio='0.45'/>" +
         beside + "</Node>";
}

const std::string kGrip = "<GraspForceField radius='0.02' keyTimes='0 0.1' positions='.1 .05 .03  .12 .06 .06' ";

// The first five steps, in which a grip reaches its greatest force.
int max_iterations(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  int max = 0;
  for (int k = 0; k < 5; ++k) {
    const SolveReport report = scene.step();
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.residual, 1e-6);
    EXPECT_EQ(report.preconditioner, PreconditionedBy::kMultigrid);
    max = std::max(max, report.iterations);
  }
  return max;
}

// How few iterations that takes, and in mixed precision, is OtherTerms.
TEST(MultigridCGLinearSolver, StaysWhateverActsBesideTheBody) {
  const int alone = max_iterations(slab(""));
  for (const std::string& beside :
       {std::string("<PlaneForceField normal='0 0 1' d='1e-4' stiffness='50'/>"),
        std::string("<PlaneForceField normal='.36 .48 .8' d='.04' stiffness='50'/>"),
        kGrip + "stiffness='50' maxForce='.02' damping='.2'/>",
        std::string("<Node><MechanicalObject position='.07 .05 .031  .08 .03 .02'/><BarycentricMapping/><UniformMass "
                    "totalMass='.05'/><PlaneForceField normal='0 0 1' d='.1' stiffness='20'/></Node>")})
    EXPECT_LE(max_iterations(slab(beside)), 1.5 * alone) << beside;
}

TEST(MultigridCGLinearSolver, IsTheSameToTheLastBitBesideWhatActsNowhere) {
  const auto end = [](const std::string& beside) {
    scene::Scene scene = read_and_init(slab(beside));
    run(scene, 3);
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  const PointArray alone = end("");
  for (const std::string& beside :
       {std::string("<PlaneForceField normal='.36 .48 .8' d='-10' stiffness='1e5'/>"),
        kGrip + "stiffness='50' graspTime='10'/>",
        std::string("<Node><MechanicalObject position='.07 .05 .031'/><BarycentricMapping/><PlaneForceField d='-10' "
                    "stiffness='1e5'/></Node>")})
    EXPECT_EQ(end(beside), alone) << beside;
}

TEST(MultigridCGLinearSolver, SaysOnceThatABodyHasNoCoarseMeshes) {
  const auto warnings = [](const std::string& preconditioner) {
    scene::Scene scene = read_and_init(slab("", "3 3 3", preconditioner));
    scene.diagnostics().take_warnings();
    run(scene, 3);
    return scene.diagnostics().take_warnings();
  };
  ASSERT_EQ(warnings("multigrid").size(), 1u);
  EXPECT_TRUE(warnings("auto").empty());
}

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
  EXPECT_EQ(warnings_of(scene),
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
