// SPDX-License-Identifier: LGPL-2.1-or-later
// Nodes that are tied, or drawn, to those of another mechanical state.
#include "hexaplast/solve/energy_balance.hpp"
#include "support/compare.hpp"
#include "support/two_states.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

// A bar of which each half is a body is the whole bar: lumped masses add up, and so do forces. At rest, forces that
// cancel at the tie leave their rounding there, which is no reason to end: the tolerance asks for less than that is.
TEST(AttachProjectiveConstraint, TwoHalvesAreTheWhole) {
  const auto half = [](const std::string& name, const std::string& grid, const std::string& rest) {
    return node(name, "<RegularGridTopology " + grid +
                          "/><MechanicalObject name='state'/><DiagonalMass massDensity='1000'/>"
                          "<HexahedronElastoplasticFEMForceField youngModulus='20000' poissonRatio='.4'/>" +
                          rest);
  };
  const std::string held = "<FixedProjectiveConstraint indices='0-8'/>", pulled = "<ConstantForceField indices='",
                    euler = "<EulerImplicitSolver rayleighStiffness='.01'/>";
  struct Case {
    std::string solvers;
    int steps = 50;
    double tolerance = 1e-9;
  };
  for (const auto& [solvers, steps, tolerance] :
       {Case{euler + "<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-40'/>"},
        Case{euler + "<MultigridCGLinearSolver tolerance='1e-12' preconditioner='multigrid'/>"},
        Case{euler + "<MultigridCGLinearSolver tolerance='1e-12' preconditioner='diagonal'/>"},
        Case{"<StaticSolver/><NewtonRaphsonSolver maxNbIterationsNewton='50' absoluteResidualStoppingThreshold='1e-9'/>"
             "<MultigridCGLinearSolver tolerance='1e-12' iterations='3000'/>",
             4, 6e-7}}) {
    const std::string above = "<Node dt='.01' gravity='0 -9.81 0'><DefaultAnimationLoop/>" + solvers;
    scene::Scene scene = read_and_init(
        above + half("first", "n='3 3 5' max='.04 .04 .08'", held) +
        half("second", "n='3 3 5' min='0 0 .08' max='.04 .04 .16'", pulled + "36-44' totalForce='.3 0 .5'/>") +
        "<AttachProjectiveConstraint twoWay='true' object1='@first' object2='@second' indices1='36-44' "
        "indices2='0-8'/></Node>");
    scene::Scene whole = read_and_init(
        above + half("whole", "n='3 3 9' max='.04 .04 .16'", held + pulled + "72-80' totalForce='.3 0 .5'/>") +
        "</Node>");
    run(scene, steps);
    run(whole, steps);
    const PointArray& expected = positions(whole, "whole");
    EXPECT_TRUE(agrees(positions(scene, "first"), expected.topRows(45), tolerance)) << solvers;
    EXPECT_TRUE(agrees(positions(scene, "second"), expected.bottomRows(45), tolerance)) << solvers;
    EXPECT_GT((expected.row(80) - Eigen::RowVector3d(.04, .04, .16)).norm(), .01) << "something happened";
  }
}

/// Two clouds of points of one kilogram each without forces, and what ties them.
std::string tied(const std::string& rest, const std::string& solver = "<CGLinearSolver/>",
                 const std::string& in_first = "", const std::string& in_second = "") {
  return "<Node dt='.5' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver name='euler'/>" + solver +
         node("first",
              "<MechanicalObject name='state' position='0 0 0  5 5 5'/><UniformMass vertexMass='1'/>" + in_first) +
         node("second",
              "<MechanicalObject name='state' position='4 0 0  9 5 5'/><UniformMass vertexMass='1'/>" + in_second) +
         "<AttachProjectiveConstraint object1='@first' object2='@second' " + rest + "/></Node>";
}

// SOFA's steps: the second node halves its distance, both get the mean of their velocities.
TEST(AttachProjectiveConstraint, DrawsTheSecondNodeToTheFirst) {
  for (const std::string two_way : {"", "twoWay='true' "}) {
    scene::Scene scene = read_and_init(tied(two_way + "indices1='0' indices2='0'"));
    EXPECT_EQ(positions(scene, "second"), rows({{2, 0, 0}, {9, 5, 5}})) << "at the beginning, too";
    at<scene::MechanicalState>(scene, "first/state").velocities().row(0) << 0, 1, 0;
    scene.step();
    // it moved by .5 m with 1 m/s alone; with twoWay no acceleration either, for there is no force
    EXPECT_EQ(positions(scene, "first"), rows({{0, .5, 0}, {5, 5, 5}}));
    EXPECT_EQ(positions(scene, "second"), rows({{1, .25, 0}, {9, 5, 5}}));
    EXPECT_EQ(at<scene::MechanicalState>(scene, "first/state").velocities().row(0), Eigen::RowVector3d(0, .5, 0));
    EXPECT_EQ(at<scene::MechanicalState>(scene, "second/state").velocities().row(0), Eigen::RowVector3d(0, .5, 0));
    scene.reset();
    EXPECT_EQ(positions(scene, "second"), rows({{2, 0, 0}, {9, 5, 5}}));
  }
}

// One node at 1 m/s meets another one at rest: both go on with half of it, and half of the energy is the constraint's.
TEST(AttachProjectiveConstraint, IsASupportInTheBalanceOfEnergy) {
  for (const std::string two_way : {"", "twoWay='true' "}) {
    scene::Scene scene = read_and_init(tied(two_way + "indices1='0' indices2='0'"));
    auto& euler = at<scene::OdeSolver>(scene, "euler");
    at<scene::MechanicalState>(scene, "first/state").velocities().row(0) << 0, 1, 0;
    euler.keep_energy_balance();
    run(scene, 3);
    const EnergyBalance& balance = *euler.energy_balance();
    EXPECT_NEAR(balance.initial, .5, 1e-15);
    EXPECT_NEAR(balance.kinetic, .25, 1e-15);
    EXPECT_NEAR(balance.support_work, -.25, 1e-15);
    EXPECT_NEAR(balance.error(), 0, 1e-15);
  }
}

const std::string kOfBoth =
    ": ties nodes that FixedProjectiveConstraint 'fixed' constrains too: each node must have one of both";

TEST(AttachProjectiveConstraint, MistakesAreNamed) {
  const std::string own = "AttachProjectiveConstraint", one = "indices1='0' indices2='0'",
                    two_way = "twoWay='true' indices1='0' indices2='0'";
  expect_errors([](const std::string& rest) { return tied(rest); },
                {{"indices1='0' indices2='2'", "indices2: 2 must lie in [0, 2)"},
                 {"indices1='0 1' indices2='1'", "indices2: 1 nodes given for 2 of indices1, must be as many"},
                 {"indices1='0 1' indices2='1 1'", "indices2: 1 is given twice, must be tied once"},
                 {"twoWay='true' indices1='0 0' indices2='0 1'", "indices1: 0 is given twice, must be tied once"}},
                own + ".");
  EXPECT_EQ(errors_of(tied("indices1='0 0' indices2='0 1'")), "") << "two may follow one";
  expect_errors(
      [](const std::string& text) { return text; },
      {{tied(two_way, "<SparseLDLSolver name='direct'/>"),
        ".twoWay: ties nodes in both ways: no matrix has that, but SparseLDLSolver 'direct' needs one: take a "
        "MultigridCGLinearSolver or a CGLinearSolver"},
       {tied(two_way, "<CGLinearSolver/>", "<FixedProjectiveConstraint name='fixed' indices='0'/>"), kOfBoth},
       {replaced(tied(one), "object2='@second'", "object2='@first/state'"),
        ".object2: leads to 'state', as object1 does: must lead to another state"}},
      own);
}

TEST(AttachProjectiveConstraint, ChangesAreChecked) {
  const auto refusal_of = [](const std::string& changes) {
    return error_of<scene::SceneError>([&] {
      scene::Scene scene =
          read_and_init(replaced(tied("name='tie' twoWay='true' indices1='0' indices2='0'", "<CGLinearSolver/>",
                                      "<FixedProjectiveConstraint name='fixed' indices='1'/>"),
                                 "<EulerImplicit", changes + "<EulerImplicit"));
      run(scene, 3);
    });
  };
  const std::string refused = "test.scn:1: error: AttachProjectiveConstraint" + kOfBoth,
                    ties_it = attribute_change("tie", "indices1", ".5", "1"),
                    fixes_it = attribute_change("first/fixed", "indices", ".5", "0");
  EXPECT_EQ(refusal_of(ties_it), refused);
  EXPECT_EQ(refusal_of(fixes_it), refused);
  EXPECT_EQ(refusal_of(fixes_it + ties_it), "");
  EXPECT_EQ(refusal_of(attribute_change("tie", "twoWay", ".5", "false")),
            "test.scn:1: error: AttributeChange.attribute: AttachProjectiveConstraint 'tie' has no attribute 'twoWay' "
            "that may change");
}

}  // namespace
