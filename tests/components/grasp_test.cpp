// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "scene/load.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

using Numbers = std::vector<std::int64_t>;

/// A bar of 0.1 x 0.1 x 0.4 m, four hexahedra without lateral contraction, and a tool above its upper end; E A / L is
/// 2000 N/m.
std::string gripped_bar(const std::string& grasp) {
  return "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass='1' "
         "rayleighStiffness='0.02'/><SparseLDLSolver/><RegularGridTopology n='2 2 5' max='0.1 0.1 0.4'/>"
         "<MechanicalObject name='nodes'/><UniformMass totalMass='4'/><HexahedronElastoplasticFEMForceField "
         "name='body' "
         "youngModulus='8e4' poissonRatio='0'/><FixedProjectiveConstraint indices='0-3'/>" +
         grasp + "</Node>";
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
  EXPECT_TRUE(agrees(force_of(scene, "grasp", 1), rows({{0, 0, 0}, {0, 0, 0}, {0, 4, 0}, {0, 4, 0}}), 1e-14));
  scene.step();  // from t = 1
  EXPECT_TRUE(agrees(instrument.vector3("force"), Vec3(0, 8, 0), 1e-14));
  const PointArray v = at<scene::MechanicalState>(scene, "nodes").velocities();
  EXPECT_GT(v(2, 1), 0.1);
  run(scene, 2);  // from t = 1.5 and 2
  EXPECT_EQ(held(), Numbers{});
  EXPECT_EQ(instrument.vector3("force"), Vec3(0, 0, 0));
  EXPECT_TRUE(agrees(at<scene::MechanicalState>(scene, "nodes").velocities(), v, 1e-14));
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

// Points that follow the body are held just as well.
TEST(Grasp, HoldsEmbeddedPoints) {
  const std::string skin =
      "<Node name='skin'><MechanicalObject name='points' position='.02 .03 .38  .08 .07 .39  .05 .05 .1'/>"
      "<BarycentricMapping/>" +
      grasp("stiffness='3000' maxForce='20'") + "</Node>";
  scene::Scene scene = read_and_init(gripped_bar(skin));
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

  std::unique_ptr<scene::Component> hand = factory().make("GraspForceField");
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

  EXPECT_TRUE(refuses<scene::SceneError>([&] { joined.add(node, factory().make("GraspForceField"), "empty"); },
                                         {"GraspForceField."}));
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
