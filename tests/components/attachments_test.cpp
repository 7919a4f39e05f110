// SPDX-License-Identifier: LGPL-2.1-or-later
// Nodes that are tied, or drawn, to those of another mechanical state.
#include <gtest/gtest.h>

#include "hexaplast/solve/energy_balance.hpp"
#include "support/compare.hpp"
#include "support/two_states.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::both;
using support::errors_of;
using support::node;
using support::positions;
using support::read_and_init;

// A bar of which each half is a body is the whole bar: lumped masses add up, and so do forces.
TEST(AttachProjectiveConstraint, TwoHalvesAreTheWhole) {
  const auto half = [](const std::string& name, const std::string& grid, const std::string& rest) {
    return node(name, "<RegularGridTopology " + grid +
                          "/><MechanicalObject name='state'/><DiagonalMass massDensity='1000'/>"
                          "<HexahedronElastoplasticFEMForceField youngModulus='20000' poissonRatio='.4'/>" +
                          rest);
  };
  const std::string held = "<FixedProjectiveConstraint indices='0-8'/>", pulled = "<ConstantForceField indices='";
  for (const std::string solver : {"<CGLinearSolver iterations='2000' tolerance='1e-13' threshold='1e-40'/>",
                                   "<MultigridCGLinearSolver tolerance='1e-12' preconditioner='multigrid'/>",
                                   "<MultigridCGLinearSolver tolerance='1e-12' preconditioner='diagonal'/>"}) {
    const std::string above =
        "<Node dt='.01' gravity='0 -9.81 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighStiffness='.01'/>" +
        solver;
    const std::string ties =
        "<AttachProjectiveConstraint twoWay='true' object1='@first' object2='@second' "
        "indices1='36 37 38 39 40 41 42 43 44' indices2='0 1 2 3 4 5 6 7 8'/>";
    scene::Scene scene = read_and_init(
        above + half("first", "n='3 3 5' max='.04 .04 .08'", held) +
        half("second", "n='3 3 5' min='0 0 .08' max='.04 .04 .16'", pulled + "36-44' totalForce='.3 0 .5'/>") + ties +
        "</Node>");
    scene::Scene whole = read_and_init(
        above + half("whole", "n='3 3 9' max='.04 .04 .16'", held + pulled + "72-80' totalForce='.3 0 .5'/>") +
        "</Node>");
    support::run(scene, 50);
    support::run(whole, 50);
    const PointArray& expected = positions(whole, "whole");
    EXPECT_TRUE(support::agrees(positions(scene, "first"), expected.topRows(45), 1e-9)) << solver;
    EXPECT_TRUE(support::agrees(positions(scene, "second"), expected.bottomRows(45), 1e-9)) << solver;
    EXPECT_GT((expected.row(80) - Eigen::RowVector3d(.04, .04, .16)).norm(), .01) << "something happened";
  }
}

/// Two clouds of points of one kilogram each without forces, and what ties them.
std::string tied(const std::string& rest, const std::string& solver = "<CGLinearSolver/>",
                 const std::string& in_first = "") {
  return "<Node dt='.5' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver +
         node("first",
              "<MechanicalObject name='state' position='0 0 0  5 5 5'/><UniformMass vertexMass='1'/>" + in_first) +
         node("second", "<MechanicalObject name='state' position='4 0 0  9 5 5'/><UniformMass vertexMass='1'/>") +
         "<AttachProjectiveConstraint object1='@first' object2='@second' " + rest + "/></Node>";
}

// SOFA's steps: the second node halves its distance, both get the mean of their velocities.
TEST(AttachProjectiveConstraint, DrawsTheSecondNodeToTheFirst) {
  for (const std::string two_way : {"", "twoWay='true' "}) {
    scene::Scene scene = read_and_init(tied(two_way + "indices1='0' indices2='0'"));
    EXPECT_EQ(positions(scene, "second"), support::rows({{2, 0, 0}, {9, 5, 5}})) << "at the beginning, too";
    at<scene::MechanicalState>(scene, "first/state").velocities().row(0) << 0, 1, 0;
    scene.step();
    // it moved by .5 m with 1 m/s alone; with twoWay no acceleration either, for there is no force
    EXPECT_EQ(positions(scene, "first"), support::rows({{0, .5, 0}, {5, 5, 5}}));
    EXPECT_EQ(positions(scene, "second"), support::rows({{1, .25, 0}, {9, 5, 5}}));
    EXPECT_EQ(at<scene::MechanicalState>(scene, "first/state").velocities().row(0), Eigen::RowVector3d(0, .5, 0));
    EXPECT_EQ(at<scene::MechanicalState>(scene, "second/state").velocities().row(0), Eigen::RowVector3d(0, .5, 0));
    scene.reset();
    EXPECT_EQ(positions(scene, "second"), support::rows({{2, 0, 0}, {9, 5, 5}}));
  }
}

// A force of 2 N on the second node: with twoWay 1 m/s^2 for each of two kilograms, otherwise it is held.
TEST(AttachProjectiveConstraint, PassesForcesInBothWaysOrNone) {
  for (const bool two_way : {true, false}) {
    std::string text = tied(std::string(two_way ? "twoWay='true' " : "") + "indices1='0' indices2='0'");
    text.insert(text.find("</Node><AttachProjective"), "<ConstantForceField indices='0' forces='2 0 0'/>");
    scene::Scene scene = read_and_init(text);
    scene.step();
    EXPECT_NEAR(at<scene::MechanicalState>(scene, "first/state").velocities()(0, 0), two_way ? .5 : 0, 1e-15);
    EXPECT_NEAR(at<scene::MechanicalState>(scene, "second/state").velocities()(0, 0), two_way ? .5 : 0, 1e-15);
  }
}

// One node at 1 m/s meets another one at rest: both go on with half of it, and half of the energy is the constraint's.
TEST(AttachProjectiveConstraint, IsASupportInTheBalanceOfEnergy) {
  for (const std::string two_way : {"", "twoWay='true' "}) {
    std::string text = tied(two_way + "indices1='0' indices2='0'");
    text.replace(text.find("<EulerImplicitSolver/>"), 22, "<EulerImplicitSolver name='euler'/>");
    scene::Scene scene = read_and_init(text);
    auto& euler = at<scene::OdeSolver>(scene, "euler");
    at<scene::MechanicalState>(scene, "first/state").velocities().row(0) << 0, 1, 0;
    euler.keep_energy_balance();
    support::run(scene, 3);
    const EnergyBalance& balance = *euler.energy_balance();
    EXPECT_NEAR(balance.initial, .5, 1e-15);
    EXPECT_NEAR(balance.kinetic, .25, 1e-15);
    EXPECT_NEAR(balance.support_work, -.25, 1e-15);
    EXPECT_NEAR(balance.error(), 0, 1e-15);
  }
}

TEST(AttachProjectiveConstraint, ByADirectSolverInOneWay) {
  const std::string loads = "<ConstantForceField indices='0 1' forces='2 0 0  0 3 0'/>";
  const auto end_with = [&](const std::string& solver) {
    std::string text = tied("indices1='0' indices2='0'", solver);
    text.insert(text.find("</Node><AttachProjective"), loads);
    scene::Scene scene = read_and_init(text);
    support::run(scene, 5);
    return both(scene);
  };
  EXPECT_TRUE(support::agrees(end_with("<SparseLDLSolver/>"), end_with("<CGLinearSolver/>"), 1e-14));
}

TEST(AttachProjectiveConstraint, MistakesAreNamed) {
  const std::string at_start = "test.scn:1: error: AttachProjectiveConstraint";
  for (const auto& [rest, message] : std::vector<std::pair<std::string, std::string>>{
           {"indices1='0' indices2='2'", "indices2: 2 must lie in [0, 2)"},
           {"indices1='0 1' indices2='1'", "indices2: 1 nodes given for 2 of indices1, must be as many"},
           {"indices1='0 1' indices2='1 1'", "indices2: 1 is given twice, must be tied once"},
           {"twoWay='true' indices1='0 0' indices2='0 1'", "indices1: 0 is given twice, must be tied once"}})
    EXPECT_EQ(errors_of(tied(rest)), at_start + "." + message);
  EXPECT_EQ(errors_of(tied("indices1='0 0' indices2='0 1'")), "") << "two may follow one";
  EXPECT_EQ(errors_of(tied("twoWay='true' indices1='0' indices2='0'", "<SparseLDLSolver name='direct'/>")),
            at_start +
                ".twoWay: ties nodes in both ways: no matrix has that, but SparseLDLSolver 'direct' needs one: "
                "take a MultigridCGLinearSolver or a CGLinearSolver");
  EXPECT_EQ(errors_of(tied("twoWay='true' indices1='0' indices2='0'", "<CGLinearSolver/>",
                           "<FixedProjectiveConstraint name='fixed' indices='0'/>")),
            at_start +
                ": ties nodes that FixedProjectiveConstraint 'fixed' constrains too: each node must have one of "
                "both");
  std::string same = tied("indices1='0' indices2='0'");
  same.replace(same.find("object2='@second'"), 17, "object2='@first/state'");
  EXPECT_EQ(errors_of(same), at_start + ".object2: leads to 'state', as object1 does: must lead to another state");
}

// What init refuses is refused when it comes to be in a run, after all that changes in a step has changed.
TEST(AttachProjectiveConstraint, ChangesAreChecked) {
  const auto error_of = [](const std::string& changes, const std::string& fixed) {
    std::string text = tied("name='tie' twoWay='true' indices1='0' indices2='0'", "<CGLinearSolver/>",
                            "<FixedProjectiveConstraint name='fixed' indices='" + fixed + "'/>");
    text.insert(text.find("<EulerImplicit"), changes);
    try {
      scene::Scene scene = read_and_init(text);
      support::run(scene, 3);
      return std::string();
    } catch (const scene::SceneError& error) {
      return std::string(error.what());
    }
  };
  const auto change = [](const std::string& component, const std::string& attribute, const std::string& value) {
    return "<AttributeChange component='@" + component + "' attribute='" + attribute + "' keyTimes='.5' values='" +
           value + "'/>";
  };
  const std::string at_start = "test.scn:1: error: AttachProjectiveConstraint";
  EXPECT_EQ(
      error_of(change("tie", "twoWay", "false"), "1"),
      "test.scn:1: error: AttributeChange.attribute: AttachProjectiveConstraint 'tie' has no attribute 'twoWay' that "
      "may change");
  const std::string of_both =
      at_start + ": ties nodes that FixedProjectiveConstraint 'fixed' constrains too: each node must have one of both";
  EXPECT_EQ(error_of(change("tie", "indices1", "1"), "1"), of_both);
  EXPECT_EQ(error_of(change("first/fixed", "indices", "0"), "1"), of_both);
  EXPECT_EQ(error_of(change("first/fixed", "indices", "0") + change("tie", "indices1", "1"), "1"), "");
}

// A hook that moves along, and drags the node behind it.
TEST(RestShapeSpringsForceField, PullsToWhereAnotherStateIs) {
  const auto text = [](const std::string& springs) {
    return "<Node dt='.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
           "<Node name='pulled'><MechanicalObject name='state' position='0 0 0  1 0 0'/><UniformMass vertexMass='1'/>" +
           springs +
           "</Node><Node name='hook'><MechanicalObject name='state' position='3 4 0  0 0 2  1 1 0'/>"
           "<UniformMass vertexMass='1'/></Node></Node>";
  };
  scene::Scene scene = read_and_init(
      text("<RestShapeSpringsForceField name='s' points='1 0' stiffness='10 100' external_rest_shape='@../hook/state' "
           "external_points='2 0'/>"));
  PointArray f = PointArray::Zero(2, 3);
  const PointArray x = support::rows({{0, 0, 1}, {1, 0, 0}}), still = PointArray::Zero(2, 3);
  at<scene::ForceField>(scene, "pulled/s").add_force(0, x, still, f);
  EXPECT_EQ(f, support::rows({{300, 400, -100}, {0, 10, 0}}));
  at<scene::MechanicalState>(scene, "hook/state").positions()(2, 1) = 3;
  f.setZero();
  at<scene::ForceField>(scene, "pulled/s").add_force(0, x, still, f);
  EXPECT_EQ(f.row(1), Eigen::RowVector3d(0, 30, 0));
  scene.step();
  EXPECT_EQ(positions(scene, "hook").row(0), Eigen::RowVector3d(3, 4, 0)) << "it feels nothing";

  const auto errors = [&](const std::string& rest) {
    return errors_of(text("<RestShapeSpringsForceField external_rest_shape='@../hook/state' " + rest + "/>"));
  };
  EXPECT_EQ(errors(""),
            "test.scn:1: error: RestShapeSpringsForceField.external_rest_shape: 3 points of 'state' for 2 "
            "nodes, must be as many");
  EXPECT_EQ(
      errors("external_points='1'"),
      "test.scn:1: error: RestShapeSpringsForceField.external_points: 1 points of 'state' for 2 nodes, must be as "
      "many");
  EXPECT_EQ(errors("external_points='1 3'"),
            "test.scn:1: error: RestShapeSpringsForceField.external_points: 3 must lie in [0, 3)");
  EXPECT_EQ(
      errors_of(text("<RestShapeSpringsForceField external_points='1 2'/>")),
      "test.scn:1: error: RestShapeSpringsForceField.external_points: given without external_rest_shape, the state "
      "that has them");
}

}  // namespace
