// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::errors_of;

scene::Scene read_as_sofa(const std::string& text) {
  scene::Scene scene =
      scene::read_scene_text(text, "test.scn", support::factory(), support::plugins(), scene::Grammar::kSofaCompatible);
  scene.init();
  return scene;
}

/// What is said of a scene that is read as SOFA reads it: the errors, or else the rest.
std::string said_of(const std::string& text) {
  try {
    scene::Scene scene = read_as_sofa(text);
    std::string all;
    for (const scene::Message& message : scene.diagnostics().take_warnings())
      if (message.text.find("animation loop") == std::string::npos) all += scene::format(message) + "\n";
    return all;
  } catch (const scene::SceneError& error) {
    return error.what();
  }
}

TEST(ReadingAsSofa, PhysicsThatIsNotThereIsRefused) {
  for (const char* name :
       {"TetrahedralCorotationalFEMForceField", "BeamFEMForceField", "JointSpringForceField",
        "TetrahedronHyperelasticityFEMForceField", "BilateralLagrangianConstraint", "LineProjectiveConstraint",
        "AdaptiveBeamForceFieldAndMass", "TriangularQuadraticSprings", "CentralDifferenceThing2Solver", "Gravity",
        "MultiStepAnimationLoop", "TopologicalChangeProcessor"})
    EXPECT_EQ(said_of(std::string("<Node><") + name + "/></Node>"),
              std::string("test.scn:1: error: ") + name + ": changes the motion, and is not there in Hexaplast");
  // a mapping matters where it moves a state
  EXPECT_EQ(said_of("<Node><MechanicalObject position='0 0 0'/><Node><MechanicalObject position='0 0 0'/>"
                    "<OddMapping/></Node></Node>"),
            "test.scn:1: error: OddMapping: changes the motion, and is not there in Hexaplast");
  EXPECT_EQ(said_of("<Node><OglModel/><OddMapping/></Node>"),
            "test.scn:1: warning: OddMapping: unknown component, ignored\n");
  // strictly it is unknown as everything else is
  EXPECT_EQ(errors_of("<Node><BeamFEMForceField/></Node>"), "test.scn:1: error: BeamFEMForceField: unknown component");
}

TEST(ReadingAsSofa, WhatSofaDoesNotKnowEitherIsPassedOverWithLinksToIt) {
  EXPECT_EQ(said_of("<Node><BoxConstraint box='0 0 0 1 1 1'/></Node>"),
            "test.scn:1: warning: BoxConstraint: unknown component, of SOFA v26.06 too, ignored\n"
            "  hint: in its place: BoxROI and FixedProjectiveConstraint\n");
  const std::string said =
      said_of("<Node><MeshLoader name='old'/><OglModel src='@old'/><MeshTopology src='@old'/></Node>");
  EXPECT_NE(said.find("OglModel.src: link '@old' leads to MeshLoader 'old', which is ignored: so is the link"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("MeshTopology.src: link '@old'"), std::string::npos) << said;
  EXPECT_EQ(errors_of("<Node><BoxConstraint/></Node>"),
            "test.scn:1: error: BoxConstraint: unknown component, of SOFA v26.06 too\n"
            "  hint: in its place: BoxROI and FixedProjectiveConstraint");
}

// An engine that we lack may feed what is seen, and nothing else.
TEST(ReadingAsSofa, OnlyDrawingMayDoWithoutAComponent) {
  EXPECT_NE(said_of("<Node><OddEngine name='e'/><OglModel position='@e.points'/></Node>")
                .find("warning: OglModel.position: link '@e.points' leads to OddEngine 'e', which is ignored"),
            std::string::npos);
  EXPECT_NE(said_of("<Node><OddEngine name='e'/><MeshTopology position='@e.points'/></Node>")
                .find("error: MeshTopology.position: link '@e.points' stops at OddEngine 'e'"),
            std::string::npos);
}

TEST(SceneReading, PluginsOfSofasTreeNeedNoLoading) {
  for (const char* name : {"Sofa.Component.Mass", "SofaCUDA", "image", "MultiThreading", "SofaBaseMechanics"})
    EXPECT_EQ(errors_of(std::string("<Node><RequiredPlugin name='") + name + "'/></Node>"), "") << name;
  EXPECT_THROW(errors_of("<Node><RequiredPlugin name='SofaAbsent'/></Node>"), scene::PluginError);
}

TEST(SceneReading, NodesTakeSofasSwitchesOfDrawing) {
  EXPECT_EQ(errors_of("<Node showBoundingTree='0' showBehaviorModels='1'><Node depend='a b' sleeping='0'/></Node>"),
            "");
}

// In SOFA v26.06 the last value of a list that is too short is that of all other nodes.
TEST(ReadingAsSofa, TheLastOfTooFewNodalMassesIsThatOfTheOthers) {
  const std::string body = support::in_root(
      "",
      "<RegularGridTopology n='3 2 2' max='1 1 1'/><MechanicalObject/><DiagonalMass name='mass' vertexMass='7 5'/>");
  EXPECT_EQ(errors_of(body),
            "test.scn:1: error: DiagonalMass.vertexMass: 2 values given for 12 nodes, must be one or one per node");
  scene::Scene scene = read_as_sofa(body);
  PointArray weight = PointArray::Zero(12, 3);
  support::at<scene::Mass>(scene, "mass").add_gravity(Vec3(0, -10, 0), weight);
  EXPECT_NEAR(weight.col(1).sum(), -10 * (7 + 11 * 5), 1e-11);
  EXPECT_NE(said_of(body).find(
                "DiagonalMass.vertexMass: 2 values given for 12 nodes: the last one is that of all others, as in SOFA"),
            std::string::npos);
}

}  // namespace
