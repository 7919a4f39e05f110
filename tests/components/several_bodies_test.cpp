// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/parts.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

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
