// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

const PointArray& velocities(scene::Scene& scene) { return at<scene::MechanicalState>(scene, "nodes").velocities(); }

TEST(PartialFixed, HoldsTheChosenDirectionsAlone) {
  scene::Scene scene =
      read_and_init(four_nodes("<ConstantForceField forces='2 4 6'/>"
                               "<PartialFixedProjectiveConstraint indices='1 3' fixedDirections='1 0 1'/>"));
  scene.step();
  EXPECT_EQ(velocities(scene), rows({{1, 2, 3}, {0, 2, 0}, {1, 2, 3}, {0, 2, 0}}));

  scene::Scene all =
      read_and_init(four_nodes("<ConstantForceField forces='2 4 6'/>"
                               "<PartialFixedProjectiveConstraint fixAll='1' fixedDirections='0 0 1'/>"));
  all.step();
  EXPECT_EQ(velocities(all), rows({{1, 2, 0}, {1, 2, 0}, {1, 2, 0}, {1, 2, 0}}));
  EXPECT_EQ(errors_of(four_nodes("<PartialFixedProjectiveConstraint fixedDirections='1 0'/>")),
            "test.scn:1: error: PartialFixedProjectiveConstraint.fixedDirections: 2 numbers given, must be three");
}

// It takes the acceleration away, and a velocity on request.
TEST(Fixed, KeepsAVelocityUnlessAskedToTakeIt) {
  const auto speed = [](const std::string& constraint) {
    scene::Scene scene = read_and_init(in_root("gravity='0 0 -10'",
                                               "<MechanicalObject name='nodes' position='0 0 0' velocity='1 2 3'/>"
                                               "<UniformMass vertexMass='3'/>" +
                                                   constraint));
    scene.step();
    return PointArray(velocities(scene));
  };
  EXPECT_EQ(speed("<FixedProjectiveConstraint/>"), rows({{1, 2, 3}}));
  EXPECT_EQ(speed("<FixedProjectiveConstraint activate_projectVelocity='true'/>"), rows({{0, 0, 0}}));
  EXPECT_EQ(speed("<PartialFixedProjectiveConstraint projectVelocity='true' fixedDirections='0 1 1'/>"),
            rows({{1, 0, 0}}));
}

TEST(Fixed, HoldsNodeZeroByDefaultOthersOrAllOnRequest) {
  const auto speeds = [](const std::string& constraint) {
    scene::Scene scene = read_and_init(four_nodes("<ConstantForceField forces='2 0 0'/>" + constraint));
    scene.step();
    return PointArray(velocities(scene));
  };
  EXPECT_EQ(speeds("<FixedProjectiveConstraint/>"), rows({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(speeds("<FixedProjectiveConstraint indices='2 1'/>"), rows({{1, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(speeds("<FixedProjectiveConstraint fixAll='true'/>"), PointArray::Zero(4, 3));
}

// h = .5. The step that begins at t ends with the movement m(t), and with the slope there; from the last key time on
// the node is free and keeps the last velocity.
TEST(LinearMovement, LagsByOneStepAndReleasesAtTheLastKey) {
  const std::string motion =
      "<LinearMovementProjectiveConstraint indices='2' keyTimes='0 1 2' movements='0 0 0  3 0 0  3 8 0'/>";
  for (const std::string solver :
       {"<SparseLDLSolver/>", "<CGLinearSolver iterations='50' tolerance='1e-14' threshold='0'/>"}) {
    scene::Scene scene =
        read_and_init("<Node gravity='0 0 0' dt='0.5'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver +
                      "<MechanicalObject name='nodes' position='1 0 0  0 2 0  0 0 3'/><UniformMass vertexMass='1'/>"
                      "<ConstantForceField forces='0 0 2'/>" +
                      motion + "</Node>");
    EXPECT_EQ(velocities(scene).row(2), Eigen::RowVector3d(3, 0, 0)) << "the first slope, before the first step";
    const Vec3 expected_x[] = {{0, 0, 3}, {1.5, 0, 3}, {3, 0, 3}, {3, 4, 3}, {3, 8, 3.5}, {3, 12, 4.5}};
    const Vec3 expected_v[] = {{3, 0, 0}, {3, 0, 0}, {0, 8, 0}, {0, 8, 0}, {0, 8, 1}, {0, 8, 2}};
    for (int k = 0; k < 6; ++k) {
      scene.step();
      EXPECT_TRUE(nodes(scene).row(2).isApprox(expected_x[k].transpose(), 1e-14)) << k;
      EXPECT_TRUE(velocities(scene).row(2).isApprox(expected_v[k].transpose(), 1e-14)) << k;
      EXPECT_DOUBLE_EQ(nodes(scene)(0, 2), 0.5 * 0.5 * 2 * (k + 1) * (k + 2) / 2) << "the others fall freely";
    }
    scene.reset();
    scene.step();
    EXPECT_TRUE(nodes(scene).row(2).isApprox(expected_x[0].transpose(), 1e-15));
  }
}

TEST(LinearMovement, BeginsWithItsFirstKey) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearMovementProjectiveConstraint indices='0' keyTimes='0.5 9.5' movements='4 5 5  13 5 5'/>"));
  scene.step();  // ends with what holds at t = 0: nothing
  EXPECT_EQ(nodes(scene).row(0), Eigen::RowVector3d(1, 0, 0));
  scene.step();
  EXPECT_EQ(nodes(scene).row(0), Eigen::RowVector3d(5, 5, 5));
  scene.step();
  EXPECT_EQ(nodes(scene).row(0), Eigen::RowVector3d(5.5, 5, 5));
  EXPECT_EQ(
      errors_of(four_nodes("<LinearMovementProjectiveConstraint keyTimes='0 1' movements='0 0 0'/>")),
      "test.scn:1: error: LinearMovementProjectiveConstraint.movements: 1 movements given for 2 times, must be as "
      "many");
}

// Eight steps of .1 s come to a little less than .8 s. What begins or ends at .8 s does so in the step that begins
// there, but for components of SOFA, which compare as SOFA does.
TEST(KeyTimes, AreNotLateByRounding) {
  ASSERT_LT(.1 + .1 + .1 + .1 + .1 + .1 + .1 + .1, .8);
  struct Case {
    std::string name, lines;
    bool is_of_sofa = false;
  };
  const Case cases[] = {
      {"an attribute changes",
       attribute_change("load", "totalForce", "KEY", "0 0 3") + "<ConstantForceField name='load' totalForce='0 0 1'/>"},
      {"a load around an axis begins",
       "<TangentialForceField indices='1' groupSize='1' axis='0 0 1' centre='0 0 0' times='KEY 99' forces='3 3'/>"},
      {"a grip closes", "<GraspForceField radius='5' graspTime='KEY' keyTimes='0' positions='1 1 1' stiffness='20'/>"},
      {"a grip opens", "<GraspForceField radius='5' releaseTime='KEY' keyTimes='0' positions='1 1 1' stiffness='20'/>"},
      {"a grip stops",
       "<GraspForceField radius='5' keyTimes='0 KEY' positions='0 0 0  KEY 0 0' stiffness='1e-200' damping='3'/>"},
      {"a motion ends", "<LinearMovementProjectiveConstraint indices='0' keyTimes='0 KEY' movements='0 0 0  0 0 0'/>",
       true},
      {"a load begins", "<LinearForceField points='1' times='KEY 99' forces='3 0 0  3 0 0'/>", true}};
  for (const auto& [name, lines, is_of_sofa] : cases) {
    const auto at_end = [&](const std::string& key) {
      std::string text = four_nodes(lines);
      for (std::size_t at = text.find("KEY"); at != text.npos; at = text.find("KEY")) text.replace(at, 3, key);
      text.replace(text.find("gravity='0 0 0' dt='0.5'"), 24, "gravity='0 0 -1' dt='0.1'");
      scene::Scene scene = read_and_init(text);
      run(scene, 12);
      return nodes(scene);
    };
    const PointArray at_key = at_end(".8"), before = at_end(".795"), after = at_end(".85");
    EXPECT_EQ(at_key, is_of_sofa ? after : before) << name;
    EXPECT_NE(at_key, is_of_sofa ? before : after) << name;
  }
}

TEST(PartialLinearMovement, LeavesTheOtherDirectionsFree) {
  scene::Scene scene = read_and_init(
      four_nodes("<ConstantForceField forces='0 2 4'/><PartialLinearMovementProjectiveConstraint indices='1' "
                 "keyTimes='0 10' movements='0 0 0  10 10 10' movedDirections='1 0 0'/>"));
  scene.step();
  scene.step();
  EXPECT_TRUE(nodes(scene).row(1).isApprox(Eigen::RowVector3d(0.5, 2 + 1.5, 3), 1e-15));
  EXPECT_TRUE(velocities(scene).row(1).isApprox(Eigen::RowVector3d(1, 2, 4), 1e-15));
}

// One cube with nu = 0 between a driven and a free face is a spring k = E A / L over four nodes. The solver sees the
// driven face at its old place and with its old velocity: b = h [k (d - u) + h k (w - v)].
TEST(DrivenNodes, PullASpringByTheDiscreteLaw) {
  const double h = 0.02, E = 5000, m = 4 * 125, k = E;
  scene::Scene scene = read_and_init(
      "<Node dt='0.02' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
      "<RegularGridTopology n='2 2 2'/><MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/>"
      "<LinearMovementProjectiveConstraint indices='0-3' keyTimes='0 0.4 100' movements='0 0 0  0 0 0.1  0 0 0.1'/>"
      "<HexahedronElastoplasticFEMForceField youngModulus='5000' poissonRatio='0'/></Node>");
  double u = 0, v = 0, d = 0, w = 0.25;
  for (int step = 0; step < 60; ++step) {
    scene.step();
    v += h * (k * (d - u) + h * k * (w - v)) / (m + h * h * k);
    u += h * v;
    const double t = step * h;
    d = std::min(t, 0.4) * 0.25;
    w = t < 0.4 - 1e-9 ? 0.25 : 0;
    for (int n = 4; n < 8; ++n) {
      ASSERT_NEAR(nodes(scene)(n, 2) - 1, u, 1e-12) << step;
      ASSERT_NEAR(nodes(scene)(n - 4, 2), d, 1e-12) << step;
      ASSERT_NEAR(velocities(scene)(n, 2), v, 1e-11) << step;
    }
  }
  EXPECT_GT(u, 0.05);
}

}  // namespace
