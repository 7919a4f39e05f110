// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
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

TEST(Loads, NameWhatIsMissingOrDoesNotFit) {
  support::expect_errors(
      four_nodes,
      {{"<ConstantForceField indices='3 1'/>",
        "ConstantForceField.forces: is not given, and totalForce neither: one of them is needed"},
       {"<ConstantForceField indices='3 1 0' forces='1 0 0  0 1 0'/>",
        "ConstantForceField.forces: 2 forces given for 3 nodes, must be one or as many"},
       {"<ConstantForceField indices='4' forces='1 0 0'/>", "ConstantForceField.indices: 4 must lie in [0, 4)"},
       {"<LinearForceField points='0' times='0 1 1' forces='1 0 0  2 0 0  3 0 0'/>",
        "LinearForceField.times: 1 is followed by 1, must be ascending"},
       {"<LinearForceField points='0' times='0 1' forces='1 0 0'/>",
        "LinearForceField.forces: 1 forces given for 2 times, must be as many"},
       {"<LinearForceField points='0'/>", "LinearForceField.times: is empty, must hold at least one time"}});
}

TEST(LinearForce, NothingBeforeTheFirstTimeLinearBetweenAndTheLastForEver) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearForceField name='load' points='2 0' times='1 2 4' forces='0 0 0  10 0 -4  0 0 6'/>"
                 "<LinearForceField name='scaled' points='0' times='0 1' forces='1 0 0  2 0 0' force='3'/>"));
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
  EXPECT_EQ(force_of(scene, "scaled", 0.5)(0, 0), 4.5);
  EXPECT_EQ(force_of(scene, "scaled", 1)(0, 0), 2) << "the factor ends with the history";
}

// Nodes (1,0,0), (0,2,0): each turns around z at its own radius, with the same force.
TEST(TangentialForce, ActsAroundTheAxisAndDoesNotGrowWithTheRadius) {
  scene::Scene scene = read_and_init(four_nodes(
      "<TangentialForceField name='twist' indices='0 1' axis='0 0 -5' centre='0 0 9' times='0 1' forces='4 8'/>"));
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({{0, -4, 0}, {4, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_TRUE(force_of(scene, "twist", 0.5).isApprox(rows({{0, -6, 0}, {6, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_TRUE(force_of(scene, "twist", 2).isApprox(rows({{0, -8, 0}, {8, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_EQ(force_of(scene, "twist", -1e-9), rows({kNone, kNone, kNone, kNone}));
  at<scene::MechanicalState>(scene, "nodes").positions().row(0) << -0.6, 0.8, 5;
  EXPECT_TRUE(force_of(scene, "twist", 0).isApprox(rows({{3.2, 2.4, 0}, {4, 0, 0}, kNone, kNone}), 1e-14));
}

}  // namespace
