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
#include "support/scene.hpp"

namespace hexaplast::view {
namespace {

/// A soft bar of 0.1 x 0.1 x 0.3 m that stands on its lower end and yields under little stress.
constexpr const char* kBar =
    "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/>"
    "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.05'/>"
    "<CGLinearSolver iterations='200' tolerance='1e-9' threshold='1e-30'/>"
    "<RegularGridTopology name='grid' n='3 3 7' max='0.1 0.1 0.3'/><MechanicalObject name='nodes'/>"
    "<UniformMass totalMass='3'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='5000' "
    "poissonRatio='0.4' yieldStress='150' plasticFlowRate='4'/><FixedProjectiveConstraint indices='0-8'/></Node>";

const Vec3 kTop(0.05, 0.05, 0.3);

/// A scene in motion, as the command steps it.
class Played {
 public:
  explicit Played(const std::string& text = kBar) : scene_(support::read_and_init(text)) {}

  const output::StepRecord& step() {
    scene_.step();
    ++record_.step;
    return record_;
  }
  void reset() {
    scene_.reset();
    record_ = {};
  }
  Subject subject() {
    return {.title = "bar",
            .scene = scene_,
            .step = [this]() -> const output::StepRecord& { return step(); },
            .reset = [this] { reset(); }};
  }
  const Body& body() { return *support::at<scene::ForceField>(scene_, "body").body(); }
  std::string hash() {
    auto& state = support::at<scene::MechanicalState>(scene_, "nodes");
    return output::state_hash(record_.step, state.positions(), state.velocities(), &body());
  }
  std::string hash_after(int steps) {
    for (int k = 0; k < steps; ++k) step();
    return hash();
  }

 private:
  scene::Scene scene_;
  output::StepRecord record_;
};

std::unique_ptr<scene::Component> hand() { return support::factory().make("GraspForceField"); }

/// The first snapshot that is as wanted; fails where none comes for long.
template <class Wanted>
Snapshot wait_for(Session& session, const Wanted& wanted) {
  Snapshot snapshot;
  for (int k = 0; k < 20'000; ++k) {
    if (session.take(snapshot) && wanted(snapshot)) return snapshot;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ADD_FAILURE() << "the session does not get there";
  return snapshot;
}

Snapshot wait_for_step(Session& session, long step) {
  return wait_for(session, [&](const Snapshot& at) { return at.step == step && !at.is_running; });
}

TEST(Session, MovesTheSceneAsACommandDoesWhileItIsLookedAt) {
  const std::string loaded = std::string(kBar).insert(std::string(kBar).find("</Node>"),
                                                      "<ConstantForceField indices='54-62' totalForce='0 0 3'/>");
  Played alone(loaded), played(loaded);
  {
    Session session(played.subject(), hand);
    session.advance(30);
    wait_for(session, [](const Snapshot& at) { return at.step >= 10; });
    for (const Quantity quantity : {Quantity::kStressNorm, Quantity::kVolumeRatio, Quantity::kSpeed})
      session.show(quantity);
    session.advance(10);
    const Snapshot end = wait_for_step(session, 40);
    EXPECT_NEAR(end.sample.time, 0.4, 1e-12);
    EXPECT_GT(end.sample.measures.world_elongation, 0);
  }
  EXPECT_EQ(played.hash(), alone.hash_after(40));
}

TEST(Session, WhatIsDraggedFarStaysStretched) {
  Played played;
  Session session(played.subject(), hand);
  session.grab(kTop, session.suggested_hand());
  session.advance(1);
  Snapshot at = wait_for_step(session, 1);
  ASSERT_FALSE(at.held.empty());
  for (const int node : at.held)
    EXPECT_LE((at.positions.row(node).transpose() - kTop).norm(), session.suggested_hand().radius + 1e-9);

  session.drag(kTop + Vec3(0, 0, 0.15));
  session.advance(60);
  at = wait_for_step(session, 61);
  EXPECT_GT(at.grip_force.z(), 1);
  EXPECT_NEAR(at.grip_force.x(), 0, 0.05 * at.grip_force.z());
  const double pulled = at.sample.measures.world_elongation;
  EXPECT_GT(pulled, 0.05);

  session.release();
  session.advance(150);
  at = wait_for_step(session, 211);
  EXPECT_TRUE(at.held.empty());
  EXPECT_EQ(at.grip_force, Vec3(0, 0, 0));
  EXPECT_GT(at.sample.measures.plastic_elongation, 0.02);
  EXPECT_LT(at.sample.measures.plastic_elongation, pulled);
  EXPECT_NEAR(at.sample.measures.world_elongation, at.sample.measures.plastic_elongation, 0.01) << "it rests";
  EXPECT_NEAR(at.sample.measures.material_volume_ratio, 1, 0.01);
  EXPECT_GT(at.sample.dissipated_energy, 0);
  EXPECT_GT(at.sample.greatest_plastic_strain, 0.02);
}

TEST(Session, WithoutYieldNothingStays) {
  Played played(std::string(kBar).replace(std::string(kBar).find("yieldStress='150'"), 17, ""));
  Session session(played.subject(), hand);
  session.grab(kTop, session.suggested_hand());
  session.drag(kTop + Vec3(0, 0, 0.15));
  session.advance(20);
  EXPECT_GT(wait_for_step(session, 20).sample.measures.world_elongation, 0.02);
  session.release();
  session.advance(1);
  EXPECT_EQ(wait_for_step(session, 21).sample.measures.plastic_elongation, 0);
}

TEST(Session, ResetLeadsBackToTheFirstBits) {
  Played fresh, played;
  Session session(played.subject(), hand);
  session.grab(kTop, session.suggested_hand());
  session.drag(kTop + Vec3(0.1, 0, 0.1));
  session.advance(40);
  EXPECT_GT(wait_for_step(session, 40).sample.greatest_plastic_strain, 0);
  session.reset();
  const Snapshot back = wait_for_step(session, 0);
  EXPECT_EQ(back.positions, played.body().mesh().positions());
  EXPECT_TRUE(back.held.empty());
  session.advance(5);
  session.stop();
  EXPECT_EQ(played.hash(), fresh.hash_after(5));
}

TEST(Session, MaterialsChangeWhileItMoves) {
  Played played;
  Session session(played.subject(), hand);
  session.set("youngModulus", 8000);
  session.set("yieldStress", 90);
  session.set("poissonRatio", 0.5);     // out of the attribute's range
  session.set("plasticFlowRate", 200);  // twice all of the excess in a step: refused by the body
  session.advance(1);
  const Snapshot at = wait_for_step(session, 1);
  session.stop();
  const Material& material = played.body().materials().front();
  EXPECT_EQ(material.young_modulus, 8000);
  EXPECT_EQ(material.yield_stress, 90);
  EXPECT_EQ(material.poisson_ratio, 0.4);
  EXPECT_EQ(material.flow_rate, 4);
  EXPECT_TRUE(at.failure.empty()) << at.failure;
  ASSERT_EQ(at.messages.size(), 2u);
  EXPECT_NE(at.messages[0].find("poissonRatio: 0.5 must lie in [0, 0.5)"), std::string::npos) << at.messages[0];
  EXPECT_NE(at.messages[1].find("plasticFlowRate"), std::string::npos) << at.messages[1];
}

TEST(Session, ThereIsAParameterForEachMemberOfAMaterial) {
  Played played;
  const Session session(played.subject(), hand);
  const auto parameter = [&](std::string_view name) {
    const auto found =
        std::ranges::find(session.parameters(), name, [](const Parameter& one) { return one.attribute->name; });
    EXPECT_NE(found, session.parameters().end()) << name;
    return *found;
  };
  ASSERT_EQ(session.parameters().size(), material_rows().size());
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
TEST(Session, AttributesCanBeTakenAwayAndGivenAgain) {
  Played played;
  Session session(played.subject(), hand);
  const auto parameter_value = [&](const Snapshot& at, std::string_view name) {
    const auto parameter =
        std::ranges::find(session.parameters(), name, [](const Parameter& one) { return one.attribute->name; });
    EXPECT_TRUE(parameter->may_be_none) << name;
    return at.parameter_values.at(static_cast<std::size_t>(parameter - session.parameters().begin()));
  };
  session.set("yieldStress", std::nullopt);
  session.set("fractureStress", 700);
  session.advance(1);
  const Snapshot without = wait_for_step(session, 1);
  ASSERT_EQ(without.messages.size(), 1u);
  EXPECT_NE(without.messages[0].find("fractureStress has no effect: without yieldStress"), std::string::npos)
      << without.messages[0];
  EXPECT_FALSE(parameter_value(without, "yieldStress"));
  EXPECT_EQ(parameter_value(without, "fractureStress"), 700);
  session.set("yieldStress", 150);
  session.set("fractureStress", std::nullopt);
  session.advance(1);
  const Snapshot with = wait_for_step(session, 2);
  EXPECT_EQ(parameter_value(with, "yieldStress"), 150);
  EXPECT_FALSE(parameter_value(with, "fractureStress"));
  session.stop();
  const Material& material = played.body().materials().front();
  EXPECT_EQ(material.yield_stress, 150);
  EXPECT_EQ(material.fracture_stress, Material().fracture_stress);
}

TEST(Session, AFactorMovesTheValuesOfAllHexahedra) {
  const std::string one = "youngModulus='5000'";
  std::string all = "youngModulus='";
  for (int e = 0; e < 24; ++e) all += std::to_string(4000 + 100 * e) + " ";
  Played played(std::string(kBar).replace(std::string(kBar).find(one), one.size(), all + "'"));
  Session session(played.subject(), hand);
  const Parameter& parameter = session.parameters().front();
  ASSERT_EQ(parameter.attribute->name, "youngModulus");
  EXPECT_EQ(parameter.of_hexahedra.size(), 24u);
  EXPECT_EQ(parameter.value, 1);
  session.set("youngModulus", 2.5);
  session.set("youngModulus", 3);  // of the scene's values, not of the latest ones
  session.advance(1);
  EXPECT_NEAR(wait_for_step(session, 1).parameter_values.front().value(), 3, 1e-12);
  session.stop();
  for (int e = 0; e < 24; ++e)
    EXPECT_NEAR(played.body().materials().at(static_cast<std::size_t>(e)).young_modulus, 3 * (4000 + 100 * e), 1e-9);
}

TEST(Session, SlidersOfARegionReachTheBody) {
  const std::string end = "</Node>";
  std::string text = kBar;
  text.replace(text.rfind(end), end.size(),
               "<MaterialRegion name='tumour' indices='3 7' youngModulus='9000' yieldStress='100 300'/></Node>");
  Played played(text);
  Session session(played.subject(), hand);
  ASSERT_EQ(session.parameters().size(), material_rows().size() + 2);
  const Parameter& modulus = session.parameters()[material_rows().size()];
  EXPECT_EQ(modulus.name, "tumour.youngModulus");
  EXPECT_EQ(modulus.value, 9000);
  EXPECT_TRUE(modulus.may_be_none);
  session.set("tumour.youngModulus", 7000);
  session.set("tumour.yieldStress", 2);  // of both
  session.set("youngModulus", 6000);
  session.advance(1);
  const Snapshot at = wait_for_step(session, 1);
  EXPECT_EQ(at.parameter_values[material_rows().size()], 7000);
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

TEST(Session, KeepsRealTimeAndCanBePaused) {
  Played played;
  Session session(played.subject(), hand);
  const auto begin = std::chrono::steady_clock::now();
  session.run();
  const Snapshot at = wait_for(session, [](const Snapshot& now) { return now.step >= 10; });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GE(seconds, 0.09) << "ten steps of 10 ms";
  session.pause();
  const long stopped = wait_for(session, [](const Snapshot& now) { return !now.is_running; }).step;
  EXPECT_GE(stopped, at.step);
  std::this_thread::sleep_for(std::chrono::milliseconds(40));
  session.advance(1);
  EXPECT_EQ(wait_for_step(session, stopped + 1).step, stopped + 1);
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
  Session session(subject, hand);
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

// A contact is switched off and on again, as by the box in the window.
TEST(Session, ContactsCanBeSwitchedOff) {
  std::string text = kBar;
  text.insert(text.rfind("</Node>"),
              "<InstrumentContactForceField name='plate' shape='box' size='1 1 1' keyTimes='0' positions='0 0 .798'/>");
  Played played(text);
  Session session(played.subject(), hand);
  const auto found = std::ranges::find(session.parameters(), "plate.active", &Parameter::name);
  ASSERT_NE(found, session.parameters().end());
  EXPECT_EQ(found->value, 1);
  session.set("plate.active", 0);
  session.advance(1);
  const Snapshot off = wait_for_step(session, 1);
  EXPECT_EQ(off.parameter_values[static_cast<std::size_t>(found - session.parameters().begin())], 0);
  EXPECT_LT((off.positions - session.mesh().positions()).cwiseAbs().maxCoeff(), 1e-12) << "2 mm inside the plate";
  session.set("plate.active", 1);
  session.advance(1);
  EXPECT_LT(wait_for_step(session, 2).positions.bottomRows(9).col(2).maxCoeff(), 0.299);
  session.stop();
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
  Session session({.title = "", .scene = scene, .step = step, .reset = {}}, hand);
  EXPECT_EQ(session.mesh().num_nodes(), 72);
  std::vector<std::string> names;
  for (const Parameter& parameter : session.parameters()) names.push_back(parameter.name);
  for (const char* name : {"left.youngModulus", "right.youngModulus"})
    EXPECT_EQ(std::ranges::count(names, name), 1) << name;

  const Vec3 place(0.12, 0.05, 0.2);  // the hand would reach the other bar too
  session.grab(place, session.suggested_hand());
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
  EXPECT_GT(at.grip_force.z(), 0.1);
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
    Session session({.title = "", .scene = scene, .step = {}, .reset = {}}, hand);
    FAIL();
  } catch (const scene::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("no body in the scene, and a window shows at least one"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace hexaplast::view
