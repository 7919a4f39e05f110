// SPDX-License-Identifier: LGPL-2.1-or-later
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
  run(scene, steps);
  return nodes(scene);
}

const std::vector<std::string> kExactSolvers = {
    "<MultigridCGLinearSolver tolerance='1e-13' iterations='2000'/>",
    "<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-30'/>",
    "<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-30' warmStart='true'/>"};

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
  scene::Scene scene =
      read_and_init("<Node dt='0.5' gravity='0 0 -10'><DefaultAnimationLoop/><EulerImplicitSolver " + attributes +
                    "/><SparseLDLSolver/><MechanicalObject name='nodes' position='0 0 7' velocity='0 0 "
                    "2'/><UniformMass vertexMass='3' " +
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

/// A scene whose solver of motion is "euler" and keeps its accounts.
scene::Scene accounted(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  at<scene::OdeSolver>(scene, "euler").keep_energy_balance();
  return scene;
}

EnergyBalance after(scene::Scene& scene, int steps) {
  run(scene, steps);
  const EnergyBalance* balance = at<scene::OdeSolver>(scene, "euler").energy_balance();
  EXPECT_NE(balance, nullptr);
  return balance ? *balance : EnergyBalance();
}

/// A hanging bar of 0.1 x 0.1 x 0.4 m in a node of its own, of the given material, with other components.
std::string heavy_bar(const std::string& material, const std::string& others, double dt = 0.01) {
  return "<Node dt='" + std::to_string(dt) +
         "' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver name='euler' rayleighMass='0.2' "
         "rayleighStiffness='0.01'/><SparseLDLSolver/><RegularGridTopology n='3 3 9' max='.1 .1 .4'/>"
         "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
         "<HexahedronElastoplasticFEMForceField name='body' poissonRatio='0.3' " +
         material + "/>" + others + "</Node>";
}

const std::string kHeldAbove = "<FixedProjectiveConstraint indices='72-80'/>";

// A tool with spring and dashpot that pulls beyond yield and lets go, and an obstacle below: the balance closes, and
// what the plastic steps took is near what the law of flow dissipates.
TEST(EnergyOfAScene, APlasticCycleCloses) {
  scene::Scene scene = accounted(heavy_bar(
      "youngModulus='20000' yieldStress='1500' plasticFlowRate='3'",
      kHeldAbove + "<PlaneForceField normal='0 0 1' d='-.02' stiffness='500' damping='2'/>"
                   "<GraspForceField keyTimes='0 .3' positions='.05 .05 0  .1 .05 -.15' radius='.08' stiffness='400' "
                   "damping='5' releaseTime='.5'/>",
      0.0025));
  const EnergyBalance balance = after(scene, 320);
  const double dissipated = body(scene).dissipated_energy();
  EXPECT_GT(dissipated, 0.05 * balance.load_work);
  EXPECT_NEAR(balance.flow_loss, dissipated, 0.2 * dissipated);
  EXPECT_LT(std::abs(balance.error()), 0.005 * balance.load_work);
}

TEST(EnergyOfAScene, WhatActsOnEmbeddedPointsCounts) {
  scene::Scene scene = accounted(heavy_bar(
      "youngModulus='30000'",
      kHeldAbove + "<Node name='skin'><MechanicalObject name='points' "
                   "position='.02 .03 .01  .08 .07 .02  .05 .05 .1'/><UniformMass totalMass='0.3'/><ConstantForceField "
                   "forces='1 0 -1'/><BarycentricMapping/></Node>"));
  const EnergyBalance balance = after(scene, 60);
  EXPECT_GT(balance.load_work, 0.2);
  EXPECT_LT(std::abs(balance.error()), 0.02 * balance.load_work);
}

// Without flow the elastic energy is proportional to the modulus. When somebody looks at the balance changes nothing.
TEST(EnergyOfAScene, ChangesOfTheMaterialAreNoError) {
  const auto text = [](const std::string& material) {
    return heavy_bar(material, kHeldAbove)
        .replace(heavy_bar("", "").find("<RegularGrid"), 0, attribute_change("body", "youngModulus", ".2", "90000"));
  };
  scene::Scene scene = accounted(text("youngModulus='30000'"));
  const EnergyBalance before = after(scene, 20), behind = after(scene, 1);
  EXPECT_GT(before.elastic, .01);
  EXPECT_EQ(before.change_work, 0);
  EXPECT_NEAR(behind.change_work, 2 * before.elastic, 1e-9 * before.elastic);
  const EnergyBalance end = after(scene, 40);
  EXPECT_EQ(end.change_work, behind.change_work);
  EXPECT_LT(std::abs(end.error()), 0.02 * end.load_work);

  const std::string plastic = text("youngModulus='20000' yieldStress='900' plasticFlowRate='3'");
  scene::Scene asked = accounted(plastic), silent = accounted(plastic);
  for (int k = 0; k < 30; ++k) after(asked, 1);
  const EnergyBalance one = after(asked, 1), other = after(silent, 31);
  EXPECT_GT(one.flow_loss, 0);
  EXPECT_GT(one.change_work, 0);
  EXPECT_NEAR(other.flow_loss, one.flow_loss, 1e-12 * one.load_work);
  EXPECT_NEAR(other.change_work, one.change_work, 1e-12 * one.load_work);
}

TEST(EnergyOfAScene, ResetBeginsAnew) {
  scene::Scene scene = accounted(heavy_bar("youngModulus='20000' yieldStress='900' plasticFlowRate='3'", kHeldAbove));
  const EnergyBalance first = after(scene, 30);
  scene.reset();
  const EnergyBalance again = after(scene, 30);
  EXPECT_GT(first.flow_loss, 0);
  EXPECT_EQ(again.flow_loss, first.flow_loss);
  EXPECT_EQ(again.load_work, first.load_work);
  EXPECT_EQ(again.error(), first.error());
}

}  // namespace
