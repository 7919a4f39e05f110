// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::force_of;
using support::four_nodes;
using support::read_and_init;
using support::rows;

const Vec3 kNone = Vec3::Zero();

TEST(ConstantForce, OneForceForAllOrOneEachOrATotal) {
  scene::Scene scene =
      read_and_init(four_nodes("<ConstantForceField name='same' indices='3 1' forces='1 2 3'/>"
                               "<ConstantForceField name='each' indices='3 1' forces='1 0 0  0 1 0'/>"
                               "<ConstantForceField name='total' indices='3 1' totalForce='4 0 -2'/>"
                               "<ConstantForceField name='all' totalForce='4 0 0'/>"));
  EXPECT_EQ(force_of(scene, "same", 7), rows({kNone, {1, 2, 3}, kNone, {1, 2, 3}}));
  EXPECT_EQ(force_of(scene, "each", 0), rows({kNone, {0, 1, 0}, kNone, {1, 0, 0}}));
  EXPECT_EQ(force_of(scene, "total", 0), rows({kNone, {2, 0, -1}, kNone, {2, 0, -1}}));
  EXPECT_EQ(force_of(scene, "all", 0), rows({{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(at<scene::ForceField>(scene, "each").loaded_nodes()[0], 1);
}

TEST(ConstantForce, NeedsAForce) {
  EXPECT_EQ(
      errors_of(four_nodes("<ConstantForceField indices='3 1'/>")),
      "test.scn:1: error: ConstantForceField.forces: is not given, and totalForce neither: one of them is needed");
  EXPECT_EQ(errors_of(four_nodes("<ConstantForceField indices='3 1 0' forces='1 0 0  0 1 0'/>")),
            "test.scn:1: error: ConstantForceField.forces: 2 forces given for 3 nodes, must be one or as many");
  EXPECT_EQ(errors_of(four_nodes("<ConstantForceField indices='4' forces='1 0 0'/>")),
            "test.scn:1: error: ConstantForceField.indices: 4 must lie in [0, 4)");
}

TEST(ConstantForce, CountsFromTheEndOnRequest) {
  scene::Scene scene =
      read_and_init(four_nodes("<ConstantForceField name='load' indices='0 2' indexFromEnd='1' forces='1 2 3'/>"));
  EXPECT_EQ(force_of(scene, "load", 0), rows({{0, 0, 0}, {1, 2, 3}, {0, 0, 0}, {1, 2, 3}}));
}

TEST(LinearForce, NothingBeforeTheFirstTimeLinearBetweenAndTheLastForEver) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearForceField name='load' points='2 0' times='1 2 4' forces='0 0 0  10 0 -4  0 0 6'/>"));
  const auto on_node = [&](double time) -> Vec3 { return force_of(scene, "load", time).row(2).transpose(); };
  EXPECT_EQ(on_node(0.99), kNone);
  EXPECT_EQ(on_node(1), kNone);
  EXPECT_EQ(on_node(1.25), Vec3(2.5, 0, -1));
  EXPECT_EQ(on_node(2), Vec3(10, 0, -4));
  EXPECT_EQ(on_node(3), Vec3(5, 0, 1));
  EXPECT_EQ(on_node(4), Vec3(0, 0, 6));
  EXPECT_EQ(on_node(1e6), Vec3(0, 0, 6));
  EXPECT_EQ(force_of(scene, "load", 2),
            rows({{10, 0, -4}, kNone, {10, 0, -4}, kNone}));  // the whole force on each point
}

TEST(LinearForce, TheFactorEndsWithTheHistory) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearForceField name='load' points='0' times='0 1' forces='1 0 0  2 0 0' force='3'/>"));
  EXPECT_EQ(force_of(scene, "load", 0.5)(0, 0), 4.5);
  EXPECT_EQ(force_of(scene, "load", 1)(0, 0), 2);
}

TEST(LinearForce, NeedsAscendingTimesWithOneForceEach) {
  EXPECT_EQ(errors_of(four_nodes("<LinearForceField points='0' times='0 1 1' forces='1 0 0  2 0 0  3 0 0'/>")),
            "test.scn:1: error: LinearForceField.times: 1 is followed by 1, must be ascending");
  EXPECT_EQ(errors_of(four_nodes("<LinearForceField points='0' times='0 1' forces='1 0 0'/>")),
            "test.scn:1: error: LinearForceField.forces: 1 forces given for 2 times, must be as many");
  EXPECT_EQ(errors_of(four_nodes("<LinearForceField points='0'/>")),
            "test.scn:1: error: LinearForceField.times: is empty, must hold at least one time");
}

// Nodes (1,0,0), (0,2,0): each turns around z at its own radius, with the same force.
TEST(TangentialForce, ActsAroundTheAxisAndDoesNotGrowWithTheRadius) {
  scene::Scene scene = read_and_init(four_nodes(
      "<TangentialForceField name='twist' indices='0 1' axis='0 0 -5' centre='0 0 9' times='0 1' forces='4 8'/>"));
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({{0, -4, 0}, {4, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_TRUE(force_of(scene, "twist", 0.5).isApprox(rows({{0, -6, 0}, {6, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_TRUE(force_of(scene, "twist", 2).isApprox(rows({{0, -8, 0}, {8, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_EQ(force_of(scene, "twist", -1e-9), rows({kNone, kNone, kNone, kNone}));
}

// The mean of (1,0,0) and (0,2,0) lies at (.5, 1): its tangent is (-1, .5)/|.|, shared by the two nodes.
TEST(TangentialForce, AGroupSharesTheForceOfItsCentre) {
  scene::Scene scene = read_and_init(four_nodes(
      "<TangentialForceField name='twist' indices='0 1' groupSize='2' axis='0 0 1' times='0' forces='20'/>"));
  const Vec3 fraction = 10 * Vec3(-1, 0.5, 0).normalized();
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({fraction, fraction, kNone, kNone}), 1e-14));
}

TEST(TangentialForce, TurnsWithTheBody) {
  scene::Scene scene =
      read_and_init(four_nodes("<TangentialForceField name='twist' indices='0' axis='0 0 1' times='0' forces='1'/>"));
  at<scene::MechanicalState>(scene, "nodes").positions().row(0) << -0.6, 0.8, 5;
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({{-0.8, -0.6, 0}, kNone, kNone, kNone}), 1e-14));
}

TEST(TangentialForce, RefusesHalfGroupsAndAnAxisWithoutDirection) {
  EXPECT_EQ(errors_of(four_nodes("<TangentialForceField indices='0 1 2' groupSize='2' times='0' forces='1'/>")),
            "test.scn:1: error: TangentialForceField.indices: 3 nodes do not form groups of 2");
  EXPECT_EQ(errors_of(four_nodes("<TangentialForceField indices='0' axis='0 0 0' times='0' forces='1'/>")),
            "test.scn:1: error: TangentialForceField.axis: is zero, must have a direction");
}

}  // namespace
