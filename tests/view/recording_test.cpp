// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/recording.hpp"

#include <gtest/gtest.h>

#include "hexaplast/body.hpp"
#include "scene/reader.hpp"
#include "support/compare.hpp"
#include "support/played.hpp"

namespace hexaplast::view {
namespace {

using support::kTop;
using support::Played;
using support::wait_for;

/// The scene that repeats what was done.
std::string record(Played& played, const Session& session) {
  scene::Diagnostics diagnostics;
  return recorded_scene(played.scene(), scene::read_document(played.text(), "test.scn", diagnostics), {},
                        session.actions(), "");
}

std::string hash_of(const std::string& text) {
  Played again(text);
  scene::Component& settings = *scene::find_settings(again.scene());
  return again.hash_after(settings.integer("steps"));
}

/// One whose hand goes on after each step.
class RecordedScene : public support::BarSession {
 protected:
  Snapshot drag(Vec3 from, const Vec3& by, int steps) {
    Snapshot last;
    for (int k = 0; k < steps; ++k) {
      session.drag(from += by);
      last = advance(1);
    }
    return last;
  }
};

HandSettings with(HandSettings settings, Tool tool) {
  settings.tool = tool;
  return settings;
}

TEST_F(RecordedScene, RepeatsPullsAndSliders) {
  session.set("youngModulus", 6000);  // before the first step
  advance(3);
  session.grab({.place = kTop}, session.suggested_hand());
  drag(kTop, Vec3(0.004, -0.001, 0.007), 20);
  session.set("yieldStress", 90);
  session.set("yieldStress", 110);
  drag(kTop, Vec3(-0.002, 0.003, 0.006), 10);
  session.release();
  advance(7);
  session.set("yieldStress", std::nullopt);
  session.grab({.place = kTop}, session.suggested_hand());  // twice, and without a step between
  session.grab({.place = Vec3(0, 0.05, 0.15)}, session.suggested_hand());
  drag(Vec3(0, 0.05, 0.15), Vec3(-0.005, 0, 0), 10);
  session.stop();  // it still holds
  EXPECT_EQ(session.actions().motions.size(), 2u);
  EXPECT_EQ(session.actions().changes.size(), 3u) << "of two at the same time the last one counts";
  EXPECT_EQ(session.actions().num_steps, 50);
  EXPECT_EQ(hash_of(record(played, session)), played.hash());
  EXPECT_GT(std::ranges::max(played.body().fields(played.positions()).plastic_strain), 0.02);
}

TEST_F(RecordedScene, RepeatsCuts) {
  const HexMesh whole = played.body().initial_mesh();
  const double height = whole.positions().col(2).maxCoeff() / 2 + 0.01;
  HandSettings scalpel = with(session.suggested_hand(), Tool::kScalpel);
  scalpel.depth = 1;
  const auto cut = [&](const Vec3& from, int steps, int steps_up = 0) {
    session.grab({.place = from, .outwards = Vec3::UnitY(), .towards = Vec3::UnitY()}, scalpel);
    advance(2);
    EXPECT_EQ(advance(3).messages, std::vector<std::string>());
    Snapshot last = drag(from, Vec3(0.02, 0, 0), steps);
    if (steps_up > 0) last = drag(from + steps * Vec3(0.02, 0, 0), Vec3(0, 0, 0.02), steps_up);
    session.release();
    return last;
  };
  advance(2);
  const PointArray before = cut(Vec3(-0.1, 0.1, height), 4).positions;
  EXPECT_EQ(before.rows(), whole.num_nodes()) << "it has not come to the first centres, and comes along its edge";
  const long at_grab = step;
  const Snapshot part = cut(Vec3(-0.01, 0.1, height), 3, 3);
  EXPECT_GT(part.positions.rows(), whole.num_nodes());
  EXPECT_EQ(part.mesh->num_nodes(), part.positions.rows());
  EXPECT_EQ(advance(4).positions.rows(), part.positions.rows()) << "it leaves along its edge";
  session.undo();
  step = at_grab + 1;  // the one before had to leave first
  EXPECT_EQ(advance(1).positions.rows(), whole.num_nodes());
  cut(Vec3(-0.1, 0.1, height), 30);
  advance(5);
  session.stop();
  EXPECT_EQ(session.failure(), "");
  EXPECT_EQ(connected_parts(played.body().mesh(), played.body().alive()).count, 2);
  EXPECT_EQ(hash_of(record(played, session)), played.hash());
}

TEST_F(RecordedScene, RepeatsWhatTouches) {
  EXPECT_EQ(session.touch_refusal(), "");
  for (const Tool tool : {Tool::kSphere, Tool::kCapsule, Tool::kBox, Tool::kSphere}) {
    const Vec3 side = advance(1).positions.row(50).transpose();  // the middle of the side, below the top
    session.grab({.place = side, .outwards = Vec3::UnitX(), .towards = Vec3(1, 0, 1).normalized()},
                 with(session.suggested_hand(), tool));
    const Snapshot first = advance(1);
    const Vec3 coming = first.hand_force;
    EXPECT_EQ(first.messages, std::vector<std::string>()) << "it begins away from the body";
    if (side == Vec3(0.1, 0.05, 0.25)) {
      EXPECT_EQ(coming, Vec3(0, 0, 0)) << "it does not touch yet";
    }
    EXPECT_LT(drag(side, Vec3(-0.003, 0, 0.0005), 12).hand_force.x(), -0.05) << "it pushes";
    session.release();
    if (tool != Tool::kCapsule) advance(20);  // the box takes the place of the capsule at once
  }
  session.stop();
  EXPECT_EQ(session.actions().motions.size(), 4u);
  EXPECT_EQ(hash_of(record(played, session)), played.hash());
  EXPECT_GT((played.positions() - played.body().mesh().positions()).rowwise().norm().maxCoeff(), 0.005);
}

TEST_F(RecordedScene, LeavesOutWhatWasUndone) {
  const auto pull = [&](const Vec3& by, Tool tool, int count) {
    session.grab({.place = kTop}, with(session.suggested_hand(), tool));
    drag(kTop, by, count);
    session.release();
    return advance(3);
  };
  pull(Vec3(0, 0, 0.01), Tool::kGrip, 12);
  session.set("yieldStress", 120);
  const Snapshot kept = pull(Vec3(0, 0, -0.004), Tool::kSphere, 9);
  pull(Vec3(0.01, 0, 0), Tool::kGrip, 15);
  session.set("youngModulus", 7000);
  const Snapshot after = pull(Vec3(0, 0.002, -0.005), Tool::kBox, 9);
  EXPECT_EQ(after.num_undo, 3) << "the first pull was before there were instruments that touch";
  session.undo();
  session.undo();
  const Snapshot back = wait_for(session, [](const Snapshot& at) { return at.num_undo == 1; });
  EXPECT_EQ(back.step, kept.step);
  EXPECT_EQ(back.positions, kept.positions);
  EXPECT_EQ(back.sample.time, kept.sample.time);
  EXPECT_EQ(back.parameter_values, kept.parameter_values) << "the sliders too";
  step = kept.step;
  pull(Vec3(0.003, 0, -0.006), Tool::kCapsule, 9);
  session.stop();
  EXPECT_EQ(session.actions().motions.size(), 3u);
  EXPECT_EQ(hash_of(record(played, session)), played.hash());
}

TEST_F(RecordedScene, BeginsAnewAfterAReset) {
  session.grab({.place = kTop}, with(session.suggested_hand(), Tool::kSphere));
  drag(kTop, Vec3(0.01, 0, -0.01), 10);
  session.set("yieldStress", 90);
  session.reset();
  step = 0;
  session.grab({.place = kTop}, session.suggested_hand());
  drag(kTop, Vec3(0.01, 0, 0.01), 10);
  session.stop();
  EXPECT_EQ(session.actions().motions.size(), 1u);
  EXPECT_EQ(session.actions().changes.size(), 1u);
  EXPECT_EQ(hash_of(record(played, session)), played.hash());
}

TEST_F(RecordedScene, KeepsOverridesAndNamesFilesFromItsOwnFolder) {
  const std::string folder = HEXAPLAST_SOURCE_DIR "/scenes/";
  const std::string text =
      "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver iterations='20'/>"
      "<MeshOBJLoader name='loader' filename='" +
      folder.substr(1) + "mesh/liver.obj'/><Node name='body'>" +
      "<RegularGridTopology name='grid' n='2 2 3' max='0.1 0.1 0.3'/><MechanicalObject name='nodes'/>"
      "<UniformMass totalMass='3'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='5000' "
      "poissonRatio='0.4'/></Node></Node>";
  scene::PluginLoader& plugins = support::plugins();
  scene::Scene scene = scene::read_scene_text(text, "/test.scn", support::factory(), plugins);
  const std::vector<std::string> overrides{"body/body.youngModulus=8000",
                                           "loader.filename=" + folder.substr(1) + "mesh/liver.obj"};
  for (const std::string& assignment : overrides) scene::override_attribute(scene, assignment);
  scene.init();
  scene::Diagnostics diagnostics;
  const std::string written = recorded_scene(scene, scene::read_document(text, "/test.scn", diagnostics), overrides,
                                             {.num_steps = 12, .motions = {}, .changes = {}}, folder + "sofa");
  EXPECT_NE(written.find("youngModulus=\"8000\""), std::string::npos) << written;
  EXPECT_EQ(written.find("youngModulus=\"5000\""), std::string::npos) << written;
  EXPECT_NE(written.find("<RunSettings steps=\"12\"/>"), std::string::npos) << written;
  EXPECT_NE(written.find("filename=\"../mesh/liver.obj\""), std::string::npos) << written;
}

}  // namespace
}  // namespace hexaplast::view
