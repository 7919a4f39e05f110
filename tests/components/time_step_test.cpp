// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::four_nodes;
using support::in_root;
using support::read_and_init;
using support::rows;

double fall_speed(const std::string& solver, const std::string& mass) {
  scene::Scene scene = read_and_init(
      "<Node dt='0.5' gravity='0 0 -10'><DefaultAnimationLoop/>" + solver +
      "<SparseLDLSolver/><MechanicalObject name='nodes' position='0 0 7' velocity='0 0 2'/>" + mass + "</Node>");
  scene.step();
  const auto& state = at<scene::MechanicalState>(scene, "nodes");
  auto& moving = const_cast<scene::MechanicalState&>(state);
  EXPECT_DOUBLE_EQ(moving.positions()(0, 2), 7 + 0.5 * moving.velocities()(0, 2));
  return moving.velocities()(0, 2);
}

// v' = (v + h g) / (1 + h rM) with the solver's damping; v' = v + h g / (1 + h m) with the mass's own.
TEST(TimeStep, AFreeMassFallsByTheDiscreteLaw) {
  const std::string mass = "<UniformMass vertexMass='3'/>";
  EXPECT_DOUBLE_EQ(fall_speed("<EulerImplicitSolver/>", mass), 2 - 5);
  EXPECT_DOUBLE_EQ(fall_speed("<EulerImplicitSolver rayleighMass='0.4'/>", mass), (2 - 5) / 1.2);
  EXPECT_DOUBLE_EQ(fall_speed("<EulerImplicitSolver/>", "<UniformMass vertexMass='3' rayleighMass='0.4'/>"),
                   2 - 5 / 1.2);
}

TEST(TimeStep, ForcesAreThoseOfItsBeginning) {
  // The load begins at t = .5: the first step (from 0 to .5) does not feel it, the second does.
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

TEST(TimeStep, ResetReturnsToTheBeginning) {
  scene::Scene scene = read_and_init(four_nodes("<ConstantForceField forces='1 0 2'/>"));
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  const PointArray first = state.positions();
  for (int i = 0; i < 3; ++i) scene.step();
  const PointArray third = state.positions();
  scene.reset();
  EXPECT_EQ(scene.time(), 0);
  EXPECT_EQ(state.positions(), first);
  for (int i = 0; i < 3; ++i) scene.step();
  EXPECT_EQ(state.positions(), third);
}

}  // namespace
