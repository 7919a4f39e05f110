// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "scene/load.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::force_of;
using support::four_nodes;
using support::nodes;
using support::read_and_init;
using support::rows;
using support::run;

using Numbers = std::vector<std::int64_t>;

/// A bar of 0.1 x 0.1 x 0.4 m, four hexahedra without lateral contraction, and a tool above its upper end; E A / L is
/// 2000 N/m.
std::string gripped_bar(const std::string& grasp, const std::string& material = "youngModulus='8e4' poissonRatio='0'",
                        const std::string& solver = "<SparseLDLSolver/>", const std::string& held = "0-3",
                        const std::string& below = "") {
  return "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='1' "
         "rayleighStiffness='0.02'/>" +
         solver +
         "<RegularGridTopology name='grid' n='2 2 5' max='0.1 0.1 0.4'/><MechanicalObject name='nodes'/>"
         "<UniformMass totalMass='4'/><HexahedronElastoplasticFEMForceField name='body' " +
         material + "/><FixedProjectiveConstraint indices='" + held + "'/>" + grasp + below + "</Node>";
}

std::string grasp(const std::string& attributes, const std::string& path =
                                                     "keyTimes='0 0.1' positions='.05 .05 .42  "
                                                     ".05 .05 .46'") {
  return "<GraspForceField name='grasp' radius='0.08' " + path + " " + attributes + "/>";
}

/// Of the upper end [m].
double elongation(scene::Scene& scene) { return nodes(scene).bottomRows(4).col(2).mean() - 0.4; }

TEST(Grasp, HoldsWhatIsNearFromItsTimeToTheOther) {
  scene::Scene scene = read_and_init(four_nodes(
      "<GraspForceField name='grasp' keyTimes='0.5 2' positions='0 0 3.5  0 3 3.5' radius='1.6' graspTime='0.5' "
      "releaseTime='1.5' stiffness='8'/>"));
  auto& instrument = at<scene::Component>(scene, "grasp");
  const auto held = [&] { return instrument.integers("grasped"); };
  scene.step();
  EXPECT_EQ(held(), Numbers{});
  EXPECT_EQ(force_of(scene, "grasp", 0.5), PointArray(PointArray::Zero(4, 3))) << "not yet closed";
  scene.step();  // from t = 0.5
  EXPECT_EQ(held(), (Numbers{2, 3}));
  EXPECT_EQ(nodes(scene).row(2), Eigen::RowVector3d(0, 0, 3));  // it closes without a pull
  // by then 1 m on, 4 N/m on each node
  EXPECT_TRUE(support::agrees(force_of(scene, "grasp", 1), rows({{0, 0, 0}, {0, 0, 0}, {0, 4, 0}, {0, 4, 0}}), 1e-14));
  scene.step();  // from t = 1
  EXPECT_TRUE(support::agrees(instrument.vector3("force"), Vec3(0, 8, 0), 1e-14));
  const PointArray v = at<scene::MechanicalState>(scene, "nodes").velocities();
  EXPECT_GT(v(2, 1), 0.1);
  run(scene, 2);  // from t = 1.5 and 2
  EXPECT_EQ(held(), Numbers{});
  EXPECT_EQ(instrument.vector3("force"), Vec3(0, 0, 0));
  EXPECT_TRUE(support::agrees(at<scene::MechanicalState>(scene, "nodes").velocities(), v, 1e-14));
  scene.reset();
  run(scene, 3);
  EXPECT_EQ(at<scene::MechanicalState>(scene, "nodes").velocities(), v) << "it closes again";
}

// What files and pictures ask for must not reach the next step.
TEST(Grasp, TellsItsLoadAndIsAsBefore) {
  scene::Scene scene = read_and_init(four_nodes(
      "<GraspForceField name='grasp' keyTimes='0 2' positions='0 0 3.5  0 3 3.5' radius='1.6' stiffness='8'/>"));
  run(scene, 2);
  auto& field = at<scene::ForceField>(scene, "grasp");
  const Vec3 before = field.vector3("force");
  const PointArray x = PointArray(nodes(scene).array() + 0.25), v = PointArray::Zero(4, 3);
  PointArray load = PointArray::Ones(4, 3), force = load;
  dynamic_cast<const scene::Load&>(field).add_load(1.5, x, v, load);
  EXPECT_EQ(field.vector3("force"), before);
  field.add_force(1.5, x, v, force);
  EXPECT_EQ(load, force);
  EXPECT_NE(field.vector3("force"), before) << "which a call of add_force changes";
}

// Two springs in series: the tool goes 40 mm, the bar takes k / (k + E A / L) of it.
TEST(Grasp, PullsABarAsFarAsTwoSpringsInSeries) {
  scene::Scene scene = read_and_init(gripped_bar(grasp("stiffness='6000'")));
  run(scene, 600);
  EXPECT_NEAR(elongation(scene), 0.04 * 6000 / (6000 + 2000), 1e-6);
  EXPECT_NEAR(at<scene::Component>(scene, "grasp").vector3("force")[2], 0.03 * 2000, 2e-3);
}

// A free body gains the momentum that the springs give it over the step, as the implicit step takes them: by force and
// stiffness at its beginning. Below the limit the springs are linear, so that this is their force at its end.
TEST(Grasp, GivesAFreeBodyItsMomentum) {
  scene::Scene scene = read_and_init(
      "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
      "<RegularGridTopology n='3 3 5' max='0.1 0.1 0.4'/><MechanicalObject name='nodes'/><UniformMass totalMass='4.5'/>"
      "<HexahedronElastoplasticFEMForceField youngModulus='2e4' yieldStress='200' plasticFlowRate='4'/>" +
      grasp("stiffness='500'", "keyTimes='0 0.1 0.3' positions='0 0 .42  .1 .05 .4  .1 -.1 .3'") + "</Node>");
  const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
  for (int k = 0; k < 30; ++k) {
    const Eigen::RowVector3d before = 0.1 * v.colwise().sum();
    scene.step();
    const Eigen::RowVector3d gained = 0.1 * v.colwise().sum() - before;
    const Eigen::RowVector3d force = force_of(scene, "grasp", 0.01 * k).colwise().sum();
    EXPECT_LE(support::max_abs(gained - 0.01 * force), 1e-12 + 1e-10 * gained.norm()) << k;
  }
  EXPECT_GT(v.norm(), 0.1);
}

// The stiffness enters every solver alike, below the limit and above it: by products, blocks, and the kernels'
// diagonal.
TEST(Grasp, EverySolverFeelsItsStiffness) {
  const std::string soft = "youngModulus='2e4' poissonRatio='0.3'",
                    path = "keyTimes='0 0.1 0.2' positions='.05 .02 .42  .06 .05 .46  0 .08 .44'";
  for (const std::string limit : {"", "maxForce='5'"}) {
    const auto end = [&](const std::string& solver) {
      scene::Scene scene = read_and_init(gripped_bar(grasp("stiffness='2000' " + limit, path), soft, solver));
      run(scene, 20);
      return PointArray(nodes(scene));
    };
    const PointArray direct = end("<SparseLDLSolver/>");
    EXPECT_TRUE(
        support::agrees(end("<CGLinearSolver iterations='999' tolerance='1e-13' threshold='1e-30'/>"), direct, 1e-10));
    EXPECT_TRUE(support::agrees(end("<MultigridCGLinearSolver tolerance='1e-12' iterations='999'/>"), direct, 1e-10));
  }
}

// What was pulled beyond yield stays stretched when it is let go, by the plastic elongation of the body; what only
// stretched comes back.
TEST(Grasp, WhatItStretchedStaysSo) {
  const auto left = [](const std::string& yield) {
    scene::Scene scene = read_and_init(
        gripped_bar(grasp("stiffness='6000' releaseTime='2'"), "youngModulus='8e4' poissonRatio='0.3' " + yield));
    run(scene, 200);
    EXPECT_GT(elongation(scene), 0.02);
    run(scene, 400);
    EXPECT_EQ(at<scene::Component>(scene, "grasp").vector3("force"), Vec3(0, 0, 0));
    const PointArray& material = at<scene::ForceField>(scene, "body").body()->plastic_rest_positions();
    EXPECT_NEAR(elongation(scene), material.bottomRows(4).col(2).mean() - material.topRows(4).col(2).mean() - 0.4,
                5e-4);
    return elongation(scene);
  };
  EXPECT_NEAR(left(""), 0, 1e-4);
  EXPECT_GT(left("yieldStress='1500' plasticFlowRate='4'"), 0.01);
}

// Points that follow the body are held just as well.
TEST(Grasp, HoldsEmbeddedPoints) {
  const std::string skin =
      "<Node name='skin'><MechanicalObject name='points' position='.02 .03 .38  .08 .07 .39  .05 .05 .1'/>"
      "<BarycentricMapping/>" +
      grasp("stiffness='3000' maxForce='20'") + "</Node>";
  scene::Scene scene =
      read_and_init(gripped_bar("", "youngModulus='8e4' poissonRatio='0'", "<SparseLDLSolver/>", "0-3", skin));
  run(scene, 600);
  EXPECT_EQ(at<scene::Component>(scene, "skin/grasp").integers("grasped"), (Numbers{0, 1}));
  EXPECT_NEAR(at<scene::Component>(scene, "skin/grasp").vector3("force")[2], 20, 1e-3);
  // 20 N from below the points on: the same reaction at the foot
  PointArray f = PointArray::Zero(20, 3);
  at<scene::ForceField>(scene, "body").add_force(0, nodes(scene), f, f);
  EXPECT_NEAR(f.topRows(4).col(2).sum(), 20, 1e-2);
}

TEST(Grasp, ChoosesAmongTheNodesThatCanBeHeld) {
  scene::Scene scene = read_and_init(gripped_bar(grasp("indices='12-17'", "keyTimes='0' positions='.05 .05 .35'")));
  scene.step();
  EXPECT_EQ(at<scene::Component>(scene, "grasp").integers("grasped"), Numbers{});
  EXPECT_EQ(scene::format(scene.diagnostics().take_warnings().back()),
            "test.scn:1: warning: GraspForceField.radius: the grip closes on nothing: no node within 0.08 m of (0.05, "
            "0.05, 0.35) at t = 0 s");
  scene::Scene near = read_and_init(gripped_bar(grasp("indices='12-17'", "keyTimes='0' positions='.05 .05 .38'")));
  near.step();
  EXPECT_EQ(at<scene::Component>(near, "grasp").integers("grasped"), (Numbers{16, 17}));
}

// A hand that comes later does the same as one that has waited: all solvers hear of it.
TEST(Grasp, MayJoinASceneThatIsReady) {
  const std::string path = "keyTimes='0' positions='.05 .05 .42'";
  scene::Scene waiting = read_and_init(gripped_bar(grasp("graspTime='0.025' stiffness='900'", path)));
  scene::Scene joined = read_and_init(gripped_bar(""));
  run(waiting, 3);
  run(joined, 3);
  const auto move = [](scene::Scene& scene) {
    at<scene::Component>(scene, "grasp").find_data("positions")->set(std::vector<double>{.05, .07, .5}, {});
    scene.step();
  };

  std::unique_ptr<scene::Component> hand = support::factory().make("GraspForceField");
  const auto set = [&](std::string_view name, scene::Value value) { hand->find_data(name)->set(std::move(value), {}); };
  set("keyTimes", std::vector<double>{0});
  set("positions", std::vector<double>{.05, .05, .42});
  set("radius", 0.08);
  set("stiffness", 900.0);
  scene::Node& node = at<scene::Component>(joined, "nodes").node();
  EXPECT_EQ(joined.add(node, std::move(hand), "grasp").name(), "grasp");
  for (scene::Scene* scene : {&waiting, &joined}) {
    scene->step();
    for (int k = 0; k < 10; ++k) move(*scene);
  }
  EXPECT_GT(elongation(joined), 0.001);
  EXPECT_EQ(nodes(joined), nodes(waiting));

  try {
    joined.add(node, support::factory().make("GraspForceField"), "empty");
    FAIL() << "it has no radius";
  } catch (const scene::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("GraspForceField."), std::string::npos) << error.what();
  }
}

TEST(Grasp, AValueThatIsRefusedLeavesNoTrace) {
  scene::Scene scene = read_and_init(gripped_bar(""));
  scene::Data& yield = *at<scene::Component>(scene, "body").find_data("yieldStress");
  EXPECT_THROW(yield.set(std::vector<double>{-1}, {}), InputError);
  EXPECT_FALSE(yield.is_given());
  yield.set(std::vector<double>{40}, {});
  EXPECT_TRUE(yield.is_given());
}

}  // namespace
