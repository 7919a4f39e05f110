// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "support/compare.hpp"
#include "support/played.hpp"
#include "view/trace.hpp"

namespace hexaplast::view {
namespace {

using support::bar_with;
using support::BarSession;
using support::kBar;
using support::kTop;
using support::Played;
using support::wait_for;
using support::wait_for_step;

Touch touch(const Vec3& place) { return {.place = place}; }

/// Of the first parameter of an attribute; as many as there are: there is none.
std::size_t number_of(const Session& session, std::string_view name) {
  const auto attribute = [](const Parameter& one) { return one.attribute->name; };
  return static_cast<std::size_t>(std::ranges::find(session.parameters(), name, attribute) -
                                  session.parameters().begin());
}

TEST(Session, MovesTheSceneAsACommandDoesWhileItIsLookedAt) {
  const std::string loaded = bar_with("<ConstantForceField indices='54-62' totalForce='0 0 3'/>");
  Played alone(loaded), played(loaded);
  {
    Session session(played.subject(), support::make);
    session.advance(30);
    wait_for(session, [](const Snapshot& at) { return at.step >= 10; });
    for (const Quantity quantity : {Quantity::kStress, Quantity::kVolumeRatio, Quantity::kSpeed})
      session.show(quantity);
    session.advance(10);
    const Snapshot end = wait_for_step(session, 40);
    EXPECT_NEAR(end.sample.time, 0.4, 1e-12);
    EXPECT_GT(end.sample.measures.current_elongation, 0);
  }
  EXPECT_EQ(played.hash(), alone.hash_after(40));
}

// That takes as long as some steps: nobody waits for it while the scene moves.
TEST_F(BarSession, FindsTheReleasedShapeWhereItIsLookedAtOrTheScenePauses) {
  session.set_pace(Pace::kFree);
  session.grab(touch(kTop), session.suggested_hand());
  session.drag(kTop + Vec3(0, 0, 0.15));
  session.run();
  const PointArray& initial = session.mesh().positions();
  Snapshot at = wait_for(
      session, [](const Snapshot& now) { return now.is_running && now.sample.greatest_plastic_strain > 0.02; });
  EXPECT_EQ(at.plastic_rest, initial);
  Traces traces;
  traces.add(at);
  EXPECT_FALSE(traces.current_elongation.empty());
  EXPECT_TRUE(traces.plastic_elongation.empty());

  session.show_plastic_rest(true);
  at = wait_for(session, [&](const Snapshot& now) { return now.is_running && now.plastic_rest != initial; });
  EXPECT_GT(at.sample.measures.plastic_elongation, 0);
  traces.add(at);
  EXPECT_FALSE(traces.plastic_elongation.empty());

  session.show_plastic_rest(false);
  wait_for(session, [&](const Snapshot& now) { return now.is_running && now.plastic_rest == initial; });
  session.pause();
  at = wait_for(session, [](const Snapshot& now) { return !now.is_running; });
  EXPECT_GT(at.sample.measures.plastic_elongation, 0);
}

TEST_F(BarSession, WhatIsDraggedFarStaysStretched) {
  session.grab(touch(kTop), session.suggested_hand());
  Snapshot at = advance(1);
  ASSERT_FALSE(at.held.empty());
  for (const int node : at.held)
    EXPECT_LE((at.positions.row(node).transpose() - kTop).norm(), session.suggested_hand().radius + 1e-9);

  session.drag(kTop + Vec3(0, 0, 0.15));
  at = advance(60);
  EXPECT_GT(at.hand_force.z(), 1);
  EXPECT_NEAR(at.hand_force.x(), 0, 0.05 * at.hand_force.z());
  const double pulled = at.sample.measures.current_elongation;
  EXPECT_GT(pulled, 0.05);

  session.release();
  at = advance(150);
  EXPECT_TRUE(at.held.empty());
  EXPECT_EQ(at.hand_force, Vec3(0, 0, 0));
  EXPECT_GT(at.sample.measures.plastic_elongation, 0.02);
  EXPECT_LT(at.sample.measures.plastic_elongation, pulled);
  EXPECT_NEAR(at.sample.measures.current_elongation, at.sample.measures.plastic_elongation, 0.01) << "it rests";
  EXPECT_NEAR(at.sample.measures.plastic_rest_volume_ratio, 1, 0.01);
  EXPECT_GT(at.sample.dissipated_energy, 0);
  EXPECT_GT(at.sample.greatest_plastic_strain, 0.02);
}

TEST_F(BarSession, MaterialsChangeWhileItMoves) {
  session.set("youngModulus", 8000);
  session.set("yieldStress", 90);
  session.set("poissonRatio", 0.5);    // out of the attribute's range
  session.set("rotationFlowRate", 1);  // isolated rest shapes have none: refused by the body
  const Snapshot at = advance(1);
  session.stop();
  const Material& material = played.body().materials().front();
  EXPECT_EQ(material.young_modulus, 8000);
  EXPECT_EQ(material.yield_stress, 90);
  EXPECT_EQ(material.poisson_ratio, 0.4);
  EXPECT_EQ(material.rotation_flow_rate, 0);
  EXPECT_TRUE(at.failure.empty()) << at.failure;
  ASSERT_EQ(at.messages.size(), 2u);
  EXPECT_NE(at.messages[0].find("poissonRatio: 0.5 must lie in [0, 0.5)"), std::string::npos) << at.messages[0];
  EXPECT_NE(at.messages[1].find("rotationFlowRate"), std::string::npos) << at.messages[1];
}

TEST(Session, ThereIsAParameterForEachMemberOfAMaterial) {
  Played played;
  const Session session(played.subject(), support::make);
  ASSERT_EQ(session.parameters().size(), material_rows().size());
  const auto parameter = [&](std::string_view name) { return session.parameters().at(number_of(session, name)); };
  for (const Row<Material>& row : material_rows()) parameter(row.name);
  EXPECT_EQ(parameter("youngModulus").value, 5000);
  EXPECT_EQ(parameter("youngModulus").attribute->unit, "Pa");
  EXPECT_TRUE(parameter("youngModulus").is_logarithmic);
  EXPECT_FALSE(parameter("fractureStress").value);
  EXPECT_EQ(parameter("plasticFlowRate").max, 5);  // 5 % of the excess in a step of 0.01 s
  EXPECT_LT(parameter("poissonRatio").max, 0.5);
  for (const Parameter& one : session.parameters()) {
    EXPECT_TRUE(one.attribute->range.contains(one.min) && one.attribute->range.contains(one.max))
        << one.attribute->name;
    EXPECT_TRUE(one.min <= one.value.value_or(one.suggested) && one.value.value_or(one.suggested) <= one.max)
        << one.attribute->name;
  }
}

// A body that yields, then one that never does, then one that breaks: as ticks in a panel.
TEST_F(BarSession, AttributesCanBeTakenAwayAndGivenAgain) {
  const auto parameter_value = [&](const Snapshot& at, std::string_view name) {
    EXPECT_TRUE(session.parameters().at(number_of(session, name)).may_be_none) << name;
    return at.parameter_values.at(number_of(session, name));
  };
  session.set("yieldStress", std::nullopt);
  session.set("fractureStress", 700);
  const Snapshot without = advance(1);
  ASSERT_EQ(without.messages.size(), 1u);
  EXPECT_NE(without.messages[0].find("fractureStress has no effect: without yieldStress"), std::string::npos)
      << without.messages[0];
  EXPECT_FALSE(parameter_value(without, "yieldStress"));
  EXPECT_EQ(parameter_value(without, "fractureStress"), 700);
  session.set("yieldStress", 150);
  session.set("fractureStress", std::nullopt);
  const Snapshot with = advance(1);
  EXPECT_EQ(parameter_value(with, "yieldStress"), 150);
  EXPECT_FALSE(parameter_value(with, "fractureStress"));
  session.stop();
  const Material& material = played.body().materials().front();
  EXPECT_EQ(material.yield_stress, 150);
  EXPECT_EQ(material.fracture_stress, Material().fracture_stress);
}

TEST(Session, SlidersOfARegionReachTheBody) {
  Played played(bar_with("<MaterialRegion name='tumour' indices='3 7' youngModulus='9000' yieldStress='100 300'/>"));
  Session session(played.subject(), support::make);
  ASSERT_EQ(session.parameters().size(), material_rows().size() + 2);
  const Parameter& modulus = session.parameters()[material_rows().size()];
  EXPECT_EQ(modulus.name, "tumour.youngModulus");
  EXPECT_EQ(modulus.value, 9000);
  EXPECT_TRUE(modulus.may_be_none);
  session.set("tumour.youngModulus", 7000);
  session.set("tumour.yieldStress", 1.5);
  session.set("tumour.yieldStress", 2);  // of both, and of the scene's values, not of the latest ones
  session.set("youngModulus", 6000);
  session.advance(1);
  const Snapshot at = wait_for_step(session, 1);
  EXPECT_EQ(at.parameter_values[material_rows().size()], 7000);
  EXPECT_EQ(at.parameter_values[material_rows().size() + 1], 2);
  EXPECT_TRUE(at.messages.empty());
  const auto material = [&](int e) { return played.body().materials().at(static_cast<std::size_t>(e)); };
  EXPECT_EQ(material(3).young_modulus, 7000);
  EXPECT_EQ(material(3).yield_stress, 200);
  EXPECT_EQ(material(7).yield_stress, 600);
  EXPECT_EQ(material(4).young_modulus, 6000);
  EXPECT_EQ(material(4).yield_stress, 150);
  session.set("tumour.youngModulus", std::nullopt);
  session.set("tumour.yieldStress", -1);
  session.advance(1);
  EXPECT_EQ(wait_for_step(session, 2).messages.size(), 1u);
  session.stop();
  EXPECT_EQ(material(3).young_modulus, 6000);
  EXPECT_EQ(material(3).yield_stress, 200);
}

TEST_F(BarSession, CanBePaused) {
  session.run();
  const Snapshot at = wait_for(session, [](const Snapshot& now) { return now.step >= 10; });
  session.pause();
  const long stopped = wait_for(session, [](const Snapshot& now) { return !now.is_running; }).step;
  EXPECT_GE(stopped, at.step);
  std::this_thread::sleep_for(std::chrono::milliseconds(40));
  session.advance(1);
  EXPECT_EQ(wait_for_step(session, stopped + 1).step, stopped + 1);
}

// On a clock that the test moves.
TEST(Pacing, KeepsAStatedFractionOfRealTime) {
  using std::chrono::milliseconds;
  const Pacing::Clock::time_point begin{milliseconds(5000)};
  for (const int lasts : {40, 2}) {  // [ms] of steps of 10 ms
    Pacing pacing;
    pacing.set_step(1e-3 * lasts, begin);
    for (int step = 0; step < 8; ++step) {
      const Pacing::Clock::time_point due = begin + step * milliseconds(lasts);
      EXPECT_FALSE(pacing.is_due(due - milliseconds(1)));
      EXPECT_TRUE(pacing.is_due(due));
      pacing.end_step(due + milliseconds(lasts / 2));  // what a step takes does not add up
    }
  }
}

// Steps that take longer than they last: few snapshots, so that no time is lost for steps, and none is made up for.
TEST(Pacing, SnapshotsAreDroppedBeforeSteps) {
  using std::chrono::milliseconds;
  Pacing::Clock::time_point now{milliseconds(5000)};
  Pacing pacing;
  pacing.set_step(0.01, now);
  pacing.show(now);
  int num_shown = 0, num_late = 0;
  for (; now < Pacing::Clock::time_point(milliseconds(6000)); now += milliseconds(14)) {
    ASSERT_TRUE(pacing.is_due(now));
    pacing.end_step(now + milliseconds(14));
    num_late += pacing.is_late(now + milliseconds(14));
    if (!pacing.is_show_due(now)) continue;
    ++num_shown;
    pacing.show(now);
  }
  EXPECT_GT(num_late, 60) << "of 72";
  EXPECT_EQ(num_shown, 4) << "five a second at most";
}

// A step that cannot be made ends the motion, not the session.
TEST(Session, AFailureIsToldAndResetLeadsOut) {
  Played played;
  Subject subject = played.subject();
  bool fails = true;
  subject.step = [&]() -> const output::StepRecord& {
    if (fails) throw NumericalError("step 1: the positions are not finite");
    return played.step();
  };
  Session session(subject, support::make);
  session.run();
  const Snapshot broken = wait_for(session, [](const Snapshot& at) { return !at.failure.empty(); });
  EXPECT_EQ(broken.failure, "step 1: the positions are not finite");
  EXPECT_FALSE(broken.is_running);
  session.advance(1);
  session.reset();
  EXPECT_TRUE(wait_for(session, [](const Snapshot& at) { return at.failure.empty(); }).failure.empty());
  fails = false;
  session.advance(2);
  EXPECT_EQ(wait_for_step(session, 2).step, 2);
  session.stop();
  EXPECT_EQ(session.failure(), "");
}

// A number on a slider takes the place of a link, and one that is refused leaves it.
TEST(Session, SlidersTakeThePlaceOfLinks) {
  std::string text = kBar;
  text.replace(text.find("youngModulus='5000'"), 19, "youngModulus='@map.outputValues'");
  text.insert(text.find("<UniformMass"), "<IndexValueMapper name='map' indices='0-23' value='5000'/>");
  text.replace(text.find("yieldStress='150'"), 17, "yieldStress='@yields.outputValues' fractureStress='300'");
  text.insert(text.find("<UniformMass"), "<IndexValueMapper name='yields' indices='0-23' value='150'/>");
  Played played(text);
  Session session(played.subject(), support::make);
  session.set("youngModulus", 2);
  session.set("yieldStress", 10);  // beyond fracture
  session.advance(1);
  wait_for_step(session, 1);
  session.stop();
  EXPECT_EQ(played.body().material(5).young_modulus, 10000);
  EXPECT_EQ(played.body().material(5).yield_stress, 150);
  EXPECT_NE(support::at<scene::ForceField>(played.scene(), "body").find_data("yieldStress")->source(), nullptr);
}

// What the scene changes goes back, and what was set on a slider stays.
TEST(Session, ResetKeepsSlidersAndNoChangesOfTheScene) {
  std::string text = kBar;
  text.insert(text.find("<RegularGridTopology"),
              "<AttributeChange component='@body' attribute='youngModulus' keyTimes='0.02' values='9000'/>"
              "<AttributeChange component='@body' attribute='yieldStress' keyTimes='0.02' values='70'/>");
  Played played(text);
  Session session(played.subject(), support::make);
  session.advance(4);
  wait_for_step(session, 4);
  session.set("yieldStress", 60);
  session.grab(touch(kTop), session.suggested_hand());
  session.release();
  session.set("yieldStress", 50);
  session.undo();
  session.advance(1);
  wait_for_step(session, 5);
  session.reset();
  session.advance(1);
  wait_for_step(session, 1);
  session.stop();
  EXPECT_EQ(played.body().materials().front().young_modulus, 5000);
  EXPECT_EQ(played.body().materials().front().yield_stress, 60);
  ASSERT_EQ(session.actions().changes.size(), 1u);
  EXPECT_EQ(session.actions().changes.front().attribute, "yieldStress");
}

TEST(Session, AResetThatFailsIsTold) {
  Played played;
  Subject subject = played.subject();
  subject.reset = [] { throw InputError("no way back"); };
  Session session(subject, support::make);
  session.reset();
  EXPECT_EQ(wait_for(session, [](const Snapshot& at) { return !at.failure.empty(); }).failure, "no way back");
}

// What is left of it in the scene would be used.
TEST(Session, AfterARefusedInstrumentThereIsNoResetAndNoUndo) {
  Played played;
  Session session(played.subject(), [](std::string_view class_name) {
    std::unique_ptr<scene::Component> made = support::make(class_name);
    if (scene::Data* triangles = made->find_data("embeddedTriangles"))
      triangles->set(std::vector<std::int64_t>{0, 1, 99}, {.file = "test"});
    return made;
  });
  session.grab(touch(kTop), session.suggested_hand());
  session.release();
  HandSettings settings = session.suggested_hand();
  settings.tool = Tool::kSphere;
  session.grab(touch(kTop), settings);
  session.undo();
  session.reset();
  session.advance(1);
  session.stop();
  EXPECT_NE(session.failure().find("the scene has refused an instrument and must be opened anew"), std::string::npos)
      << session.failure();
  EXPECT_EQ(session.actions().num_steps, 0);
}

TEST(Session, NamesOfParametersAreUnique) {
  const std::string_view all = kBar;
  const std::size_t begin = all.find("<EulerImplicitSolver"), end = all.rfind("</Node>");
  const std::string bar =
      std::string(all.substr(begin, end - begin)) +
      "<InstrumentContactForceField name='plate' radius='0.1' keyTimes='0' positions='0 0 9'/></Node>";
  const std::string text =
      std::string(all.substr(0, begin)) + "<Node name='first'>" + bar + "<Node name='second'>" + bar + "</Node>";
  Played played(text);
  Session session(played.subject(), support::make);
  std::vector<std::string> names;
  for (const Parameter& parameter : session.parameters()) names.push_back(parameter.name);
  for (const char* name : {"/first/plate.active", "/second/plate.active"})
    EXPECT_EQ(std::ranges::count(names, name), 1) << name;
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
  session.set("/second/plate.active", 0);
  session.stop();
  for (const Parameter& parameter : session.parameters())
    if (parameter.name.ends_with("plate.active")) {
      EXPECT_EQ(parameter.component->boolean("active"), parameter.name == "/first/plate.active");
    }
}

// Two bars beside each other, in one system.
TEST(Session, TheHandTakesHoldOfTheNearestBody) {
  const auto bar = [](const std::string& name, const std::string& begin, const std::string& end) {
    return "<Node name='" + name + "'><RegularGridTopology name='grid' n='3 3 4' min='" + begin + "' max='" + end +
           "'/><MechanicalObject name='nodes'/><UniformMass totalMass='1'/><HexahedronElastoplasticFEMForceField "
           "name='body' youngModulus='5000' poissonRatio='0.4' yieldStress='1e6' plasticFlowRate='1'/>"
           "<FixedProjectiveConstraint indices='0-8'/></Node>";
  };
  scene::Scene scene = support::read_and_init(
      "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='0.1' "
      "rayleighStiffness='0.05'/><MultigridCGLinearSolver tolerance='1e-8'/>" +
      bar("left", "0 0 0", "0.1 0.1 0.2") + bar("right", "0.12 0 0", "0.22 0.1 0.2") + "</Node>");
  output::StepRecord record;
  const auto step = [&]() -> const output::StepRecord& {
    scene.step();
    ++record.step;
    return record;
  };
  Session session({.title = "", .scene = scene, .step = step, .reset = {}, .serialize = {}}, support::make);
  EXPECT_EQ(session.mesh().num_nodes(), 72);
  std::vector<std::string> names;
  for (const Parameter& parameter : session.parameters()) names.push_back(parameter.name);
  for (const char* name : {"left.youngModulus", "right.youngModulus"})
    EXPECT_EQ(std::ranges::count(names, name), 1) << name;

  const Vec3 place(0.12, 0.05, 0.2);  // the hand would reach the other bar too
  session.grab(touch(place), session.suggested_hand());
  session.drag(place + Vec3(0, 0, 0.05));
  session.set("left.youngModulus", 7000);
  session.advance(20);
  const Snapshot at = wait_for_step(session, 20);
  ASSERT_FALSE(at.held.empty());
  for (const int node : at.held) {
    EXPECT_GE(node, 36);
    EXPECT_LE((session.mesh().positions().row(node).transpose() - place).norm(),
              session.suggested_hand().radius + 1e-9);
  }
  EXPECT_GT(at.hand_force.z(), 0.1);
  const PointArray moved = at.positions - session.mesh().positions();
  EXPECT_LT(moved.topRows(36).cwiseAbs().maxCoeff(), 1e-9) << "nothing joins the bars";
  EXPECT_GT(moved.bottomRows(36).maxCoeff(), 0.005);
  EXPECT_EQ(support::at<scene::ForceField>(scene, "left/body").body()->materials().front().young_modulus, 7000);
  EXPECT_EQ(support::at<scene::ForceField>(scene, "right/body").body()->materials().front().young_modulus, 5000);
}

TEST(Session, NeedsABody) {
  scene::Scene scene = support::read_and_init(
      "<Node><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/><MechanicalObject position='0 0 0'/>"
      "<UniformMass totalMass='1'/></Node>");
  try {
    Session session({.title = "", .scene = scene, .step = {}, .reset = {}, .serialize = {}}, support::make);
    FAIL();
  } catch (const scene::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("no body in the scene, and a window shows at least one"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace hexaplast::view
