// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>

#include "hexaplast/body.hpp"
#include "scene/parts.hpp"
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

TEST(EulerImplicitSolver, HasNoKineticEnergyWithoutInertia) {
  for (const bool first_order : {false, true}) {
    scene::Scene scene = read_and_init(
        std::string("<Node gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver name='euler' firstOrder='") +
        (first_order ? "true" : "false") +
        "'/><CGLinearSolver/><MechanicalObject position='0 0 0' velocity='0 0 3'/><UniformMass totalMass='2'/></Node>");
    EXPECT_EQ(at<scene::OdeSolver>(scene, "euler").kinetic_energy(), first_order ? 0 : 9);
  }
}

/// A slab of 2 x 2 x 2 hexahedra, held at one side and falling.
std::string slab(const std::string& preconditioner) {
  return "<Node dt='0.01' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='0.1' "
         "rayleighStiffness='0.01'/><MultigridCGLinearSolver name='solver' tolerance='1e-6' preconditioner='" +
         preconditioner +
         "'/><RegularGridTopology n='3 3 3' max='0.1 0.1 0.03'/><MechanicalObject name='nodes'/>"
         "<DiagonalMass massDensity='1000'/><BoxROI name='end' box='-1 -1 -1  1e-6 1 1'/><FixedProjectiveConstraint "
         "indices='@end.indices'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='1e5' poissonRatio='0.45'/></Node>";
}

TEST(MultigridCGLinearSolver, SaysOnceThatABodyHasNoCoarseMeshes) {
  const auto warnings = [](const std::string& preconditioner) {
    scene::Scene scene = read_and_init(slab(preconditioner));
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
std::string heavy_bar(const std::string& material, const std::string& others) {
  return "<Node dt='0.01' gravity='0 0 -9.81'><DefaultAnimationLoop/><EulerImplicitSolver name='euler' "
         "rayleighMass='0.2' "
         "rayleighStiffness='0.01'/><SparseLDLSolver/><RegularGridTopology n='3 3 9' max='.1 .1 .4'/>"
         "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
         "<HexahedronElastoplasticFEMForceField name='body' poissonRatio='0.3' " +
         material + "/>" + others + "</Node>";
}

const std::string kHeldAbove = "<FixedProjectiveConstraint indices='72-80'/>";

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

// Two bars of other sizes and other matter, each held at one end and pulled; one flows, the other carries points.
constexpr std::string_view kSoft =
    "<RegularGridTopology n='3 3 7' min='0 0 0' max='.1 .1 .3'/><MechanicalObject name='nodes'/>"
    "<UniformMass totalMass='2'/><BoxROI name='end' box='-1 -1 -.01 1 1 .01'/>"
    "<FixedProjectiveConstraint indices='@end.indices'/>"
    "<HexahedronElastoplasticFEMForceField youngModulus='5000' poissonRatio='.4' yieldStress='100' "
    "plasticFlowRate='4'/><ConstantForceField indices='54-62' forces='.1 0 .3'/>";
constexpr std::string_view kStiff =
    "<RegularGridTopology n='4 3 3' min='1 0 0' max='1.3 .1 .1'/><MechanicalObject name='nodes'/>"
    "<UniformMass totalMass='1'/><FixedProjectiveConstraint indices='0 4 8 12 16 20 24 28 32'/>"
    "<HexahedronElastoplasticFEMForceField youngModulus='50000' poissonRatio='.3'/>"
    "<Node name='skin'><MechanicalObject name='points' position='1.2 .05 .05  1.25 .02 .07'/>"
    "<BarycentricMapping/><ConstantForceField forces='0 2 0'/></Node>";

std::string node(const std::string& name, std::string_view content) {
  return "<Node name='" + name + "'>" + std::string(content) + "</Node>";
}
std::string scene_of(const std::string& content) {
  return "<Node dt='.02' gravity='0 -9.81 0'><DefaultAnimationLoop/>" + content + "</Node>";
}

PointArray end_of(const std::string& text, const std::string& state, int steps = 30) {
  scene::Scene scene = read_and_init(text);
  run(scene, steps);
  return at<scene::MechanicalState>(scene, state).positions();
}

// One system over two states that nothing couples is two systems. In mixed precision too, where a body's products are
// rounded, and what its flow adds: then the last bits of positions decide how it is rounded. Without recovery, whose
// onset at single corners makes more of these bits.
TEST(SeveralBodies, UnderOneSolverMoveAsTheyDoAlone) {
  struct Case {
    std::string solvers;
    double tolerance = 1e-9;
    int steps = 30;
    std::string soft = std::string(kSoft);
  };
  std::string mixed(kSoft);
  mixed.insert(mixed.find("yieldStress"), "precision='mixed' recovery='none' ");
  std::string elastic = mixed;
  elastic.replace(elastic.find("100"), 3, "1e9");
  const std::string euler = "<EulerImplicitSolver rayleighMass='.1'/>",
                    multigrid = "<MultigridCGLinearSolver preconditioner='multigrid' tolerance=",
                    newton =
                        "<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='30' "
                        "relativeInitialStoppingThreshold='1e-12'/>";
  for (const auto& [solvers, tolerance, steps, soft] :
       {Case{euler + "<SparseLDLSolver/>", 1e-12},
        Case{euler + "<CGLinearSolver iterations='400' tolerance='1e-13' threshold='1e-30'/>"},
        Case{euler + multigrid + "'1e-12'/>"},
        Case{euler + "<MultigridCGLinearSolver tolerance='1e-12' preconditioner='diagonal'/>"},
        Case{newton + "<SparseLDLSolver/>", 1e-8, 3}, Case{euler + multigrid + "'1e-9'/>", 2e-6, 30, mixed},
        Case{euler + multigrid + "'1e-9'/>", 1e-7, 30, elastic}}) {
    const std::string both = scene_of(solvers + node("soft", soft) + node("stiff", kStiff));
    for (const std::string state : {"soft/nodes", "stiff/nodes", "stiff/skin/points"}) {
      const std::string alone = state == "soft/nodes" ? node("soft", soft) : node("stiff", kStiff);
      EXPECT_TRUE(agrees(end_of(both, state, steps), end_of(scene_of(solvers + alone), state, steps), tolerance))
          << solvers << state;
    }
  }
}

// The tolerance holds for each: what is left of a vessel of a gram is nothing beside the weight of an organ of a
// kilogram.
TEST(SeveralBodies, AHeavyOneDoesNotHideWhatIsLeftOfALightOne) {
  const std::string solvers =
      "<EulerImplicitSolver rayleighStiffness='.01'/><MultigridCGLinearSolver tolerance='1e-3'/>";
  const std::string vessel =
      node("vessel",
           "<RegularGridTopology n='13 3 3' max='.03 .005 .005'/><MechanicalObject name='nodes'/>"
           "<DiagonalMass massDensity='1050'/><HexahedronElastoplasticFEMForceField youngModulus='20000'/>"
           "<FixedProjectiveConstraint indices='0 13 26 39 52 65 78 91 104'/>");
  const std::string organ =
      node("organ",
           "<RegularGridTopology n='7 7 4' min='1 0 0' max='1.15 .12 .06'/><MechanicalObject/>"
           "<DiagonalMass massDensity='1050'/><HexahedronElastoplasticFEMForceField youngModulus='5000'/>"
           "<BoxROI name='end' box='.9 -1 -1 1.0001 1 1'/><FixedProjectiveConstraint indices='@end.indices'/>");
  const double alone = end_of(scene_of(solvers + vessel), "vessel/nodes", 25)(64, 1);
  for (const std::string& both : {vessel + organ, organ + vessel})
    EXPECT_NEAR(end_of(scene_of(solvers + both), "vessel/nodes", 25)(64, 1), alone, 2e-5);  // [m], of some millimetres
}

// On which nothing acts but what the other one does to it: its own right-hand side is none to compare a residual with.
TEST(SeveralBodies, OneThatOnlyAnotherOneLoadsIsSolvedToo) {
  const auto bar = [](const std::string& name, const std::string& from, const std::string& to,
                      const std::string& rest) {
    return node(name, "<RegularGridTopology n='5 3 3' min='" + from + " 0 0' max='" + to +
                          " .05 .05'/><MechanicalObject name='nodes'/><UniformMass totalMass='.2'/>"
                          "<HexahedronElastoplasticFEMForceField youngModulus='5000'/>" +
                          rest);
  };
  const auto scene_with = [&](const std::string& solver, const std::string& join) {
    return "<Node dt='.02' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='1'/>" + solver +
           bar("left", "0", ".1", "<ConstantForceField indices='0 5 10' forces='.2 .1 0'/>") +
           bar("right", ".1", ".2", "<FixedProjectiveConstraint indices='4 9 14 19 24 29 34 39 44'/>") + join +
           "</Node>";
  };
  const std::string springs =
      "<SpringForceField object1='@left/nodes' object2='@right/nodes' "
      "spring='4 0 100 0 0  14 10 100 0 0  24 20 100 0 0  34 30 100 0 0  44 40 100 0 0'/>";
  const std::string tie =
      "<AttachProjectiveConstraint object1='@left/nodes' object2='@right/nodes' twoWay='true' "
      "indices1='4 9 14 19 24 29 34 39 44' indices2='0 5 10 15 20 25 30 35 40'/>";
  for (const std::string& join : {springs, tie}) {
    scene::Scene scene = read_and_init(scene_with("<MultigridCGLinearSolver tolerance='1e-5'/>", join));
    for (int k = 0; k < 25; ++k) {
      const SolveReport report = scene.step();
      EXPECT_TRUE(report.converged) << join << k;
      EXPECT_LE(report.iterations, 200) << join << k;
    }
    const std::string exact =
        join == tie ? "<CGLinearSolver iterations='2000' tolerance='1e-12' threshold='0'/>" : "<SparseLDLSolver/>";
    const PointArray right = end_of(scene_with(exact, join), "right/nodes", 25);
    EXPECT_LT((at<scene::MechanicalState>(scene, "right/nodes").positions() - right).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_GT((right - at<scene::MechanicalState>(scene, "right/nodes").rest_positions()).norm(), 1e-3);
  }
}

TEST(SeveralBodies, HaveOneBalanceOfEnergy) {
  const auto balance_of = [](const std::string& bodies) {
    scene::Scene scene = read_and_init(scene_of("<EulerImplicitSolver name='euler'/><SparseLDLSolver/>" + bodies));
    auto& euler = at<scene::OdeSolver>(scene, "euler");
    euler.keep_energy_balance();
    run(scene, 30);
    return *euler.energy_balance();
  };
  const EnergyBalance both = balance_of(node("soft", kSoft) + node("stiff", kStiff));
  EnergyBalance sum = balance_of(node("soft", kSoft));
  sum += balance_of(node("stiff", kStiff));
  for (double EnergyBalance::*term : {&EnergyBalance::kinetic, &EnergyBalance::elastic, &EnergyBalance::load_work,
                                      &EnergyBalance::numerical_loss, &EnergyBalance::flow_loss})
    EXPECT_NEAR(both.*term, sum.*term, 1e-9 * sum.load_work);
}

TEST(SeveralBodies, AStateThatNothingMovesStaysAndSaysSo) {
  const std::string moved = node("soft", "<EulerImplicitSolver/><SparseLDLSolver/>" + std::string(kSoft));
  const std::string still =
      "<Node name='still'><MechanicalObject name='nodes' position='0 1 0'/><UniformMass totalMass='1'/></Node>";
  scene::Scene scene = read_and_init(scene_of(moved + still));
  const std::vector<scene::Message> warnings = scene.diagnostics().take_warnings();
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(scene::format(warnings.back()),
            "test.scn:1: warning: MechanicalObject: nothing moves it: no OdeSolver in its node or above");
  run(scene, 3);
  EXPECT_EQ(at<scene::MechanicalState>(scene, "still/nodes").positions()(0, 1), 1);
  EXPECT_EQ(errors_of(scene_of(still)),
            "test.scn:1: error: MechanicalObject: nothing moves it: needs an OdeSolver in its node or above");
}

TEST(SeveralBodies, OneSolverMovesEach) {
  const std::string solver = "<EulerImplicitSolver name='outer'/><SparseLDLSolver/>";
  const std::string twice =
      "EulerImplicitSolver: EulerImplicitSolver 'outer' moves everything in its node and below already";
  expect_errors(scene_of,
                {{solver + node("soft", "<EulerImplicitSolver/>" + std::string(kSoft)), twice},
                 {solver + "<EulerImplicitSolver/>" + node("soft", kSoft), twice},
                 {solver + node("soft", kSoft) + "<Node><MechanicalObject name='free' position='0 0 0'/></Node>",
                  "EulerImplicitSolver: no mass on MechanicalObject 'free' of its node and below"},
                 {solver, "EulerImplicitSolver: no mechanical state in its node and below, must be at least one"},
                 {"<EulerImplicitSolver/>" + node("soft", kSoft),
                  "EulerImplicitSolver: needs a LinearSolver in its node or above"}});
}

TEST(SeveralBodies, HaveNames) {
  scene::Scene scene = read_and_init(scene_of("<EulerImplicitSolver/><SparseLDLSolver/>" + node("soft", kSoft) +
                                              node("left, stiff", kStiff) + node("soft", kStiff)));
  std::string names;
  for (const scene::SceneBody& body : scene::bodies_of(scene)) names += body.name + " ";
  EXPECT_EQ(names, "soft body_2 body_3 ");
}

}  // namespace
