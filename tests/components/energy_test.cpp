// SPDX-License-Identifier: LGPL-2.1-or-later
// The balance of energy that a scene's solver of motion keeps.
#include <gtest/gtest.h>

#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// A scene whose solver of motion is "euler" and keeps its accounts.
scene::Scene accounted(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  at<scene::OdeSolver>(scene, "euler").keep_energy_balance();
  return scene;
}

EnergyBalance after(scene::Scene& scene, int steps) {
  for (int k = 0; k < steps; ++k) scene.step();
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

// The work of weight is m g times the way down of the centre of mass.
TEST(EnergyOfAScene, WeightWorksAlongTheWayOfTheCentreOfMass) {
  scene::Scene scene = accounted(heavy_bar("youngModulus='30000'", kHeldAbove));
  const PointArray before = at<scene::MechanicalState>(scene, "nodes").positions();
  const EnergyBalance balance = after(scene, 60);
  const PointArray way = at<scene::MechanicalState>(scene, "nodes").positions() - before;
  double work = 0;
  for (int n = 0; n < way.rows(); ++n) {
    const int i = n % 3, j = n / 3 % 3, k = n / 9;  // of a node of the grid; each of 32 cells weighs 1/8 kg
    const double fraction = (i == 1 ? 2 : 1) * (j == 1 ? 2 : 1) * (k > 0 && k < 8 ? 2 : 1) / 8.0;
    work -= fraction * 0.125 * 9.81 * way(n, 2);
  }
  EXPECT_GT(work, 0.1);
  EXPECT_NEAR(balance.load_work, work, 1e-9 * work);
  EXPECT_NEAR(balance.support_work, 0, 1e-12);
  EXPECT_EQ(balance.flow_loss, 0);
  EXPECT_LT(std::abs(balance.error()), 0.01 * work);
}

// A bar drawn out to a tenth more within a quarter of a second and held there: what was put in has become elastic
// energy or was damped. First with the slope that begins at once, which puts nodes back to where they are to be.
TEST(EnergyOfAScene, NodesThatAreLedPutEnergyIn) {
  const std::string material = "youngModulus='200000'";
  for (const std::string motion : {"keyTimes='0 .25 99' movements='0 0 0  0 0 .04  0 0 .04'",
                                   "keyTimes='0 .1 .35 99' movements='0 0 0  0 0 0  0 0 .04  0 0 .04'"}) {
    scene::Scene scene = accounted(heavy_bar(material,
                                             "<FixedProjectiveConstraint indices='0-8'/>"
                                             "<LinearMovementProjectiveConstraint indices='72-80' " +
                                                 motion + "/>"));
    const EnergyBalance balance = after(scene, 300);
    const double stretched = 200000 * 0.01 * 0.04 * 0.04 / (2 * 0.4);  // E A u^2 / 2 L, ends held a little stiffer
    EXPECT_GT(balance.support_work, stretched);
    EXPECT_NEAR(balance.elastic, stretched, 0.06 * stretched);
    EXPECT_LT(std::abs(balance.error()), 0.01 * balance.support_work) << motion;
  }
}

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
  const double dissipated = at<scene::ForceField>(scene, "body").body()->dissipated_energy();
  EXPECT_GT(dissipated, 0.05 * balance.load_work);
  EXPECT_NEAR(balance.flow_loss, dissipated, 0.2 * dissipated);
  EXPECT_LT(std::abs(balance.error()), 0.005 * balance.load_work);
}

// Masses and loads on a state that follows the body count as if they were on it.
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
