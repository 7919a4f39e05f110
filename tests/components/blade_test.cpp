// SPDX-License-Identifier: LGPL-2.1-or-later
// Blades in scenes: what they open, and when. Which links they meet is tested in mesh/blade_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>

#include "hexaplast/body.hpp"
#include "hexaplast/plastic/flow_report.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

/// A block of 4 x 4 x 4 hexahedra of 1 m that nothing holds.
std::string block(const std::string& more, const std::string& gravity = "0 0 0") {
  return in_root("gravity='" + gravity + "' dt='0.1'",
                 "<RegularGridTopology name='grid' n='5 5 5' max='4 4 4'/><MechanicalObject name='nodes'/>"
                 "<DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField name='flesh'/>" +
                     more);
}

/// From the left to the right in a second, at a height of 2.1 m.
const std::string kBlade =
    "<BladeController name='blade' points='0 -1 0  0 5 0' keyTimes='0 1' positions='-1 0 2.1  5 0 2.1'/>";
/// From the front to the back in the same time.
const std::string kOther =
    "<BladeController name='other' points='0 0 -1  0 0 5' keyTimes='0 1' positions='2.1 -1 0  2.1 5 0'"
    " orientations='0 0 0 1  0 0 0 1'/>";

const Body& body(scene::Scene& scene, const std::string& path = "flesh") {
  return *at<scene::ForceField>(scene, path).body();
}
std::vector<int> opened(scene::Scene& scene) { return {body(scene).opened().begin(), body(scene).opened().end()}; }
int num_pieces(const Body& body) { return connected_parts(body.mesh(), body.alive()).count; }

TEST(BladeController, CutsWhatItPassesStepByStep) {
  scene::Scene scene = read_and_init(block(kBlade));
  run(scene, 2);
  EXPECT_EQ(opened(scene).size(), 0u);
  run(scene, 1);
  EXPECT_EQ(opened(scene).size(), 4u) << "at x = 0.8 it has passed the first four centres";
  run(scene, 7);
  EXPECT_EQ(opened(scene).size(), 16u);
  EXPECT_EQ(num_pieces(body(scene)), 2);
  EXPECT_EQ(body(scene).mesh().num_nodes(), 150);
  EXPECT_EQ(nodes(scene).rows(), 150);
  run(scene, 2);
  EXPECT_EQ(opened(scene).size(), 16u);
}

// None sees what the other one opens: a call of both, and not one after the other.
TEST(BladeController, ActsTogetherWithOthers) {
  scene::Scene scene = read_and_init(block(kBlade + kOther));
  Body at_once(body(scene).initial_mesh(), {{}});
  for (int step = 0; step < 10; ++step) {
    const std::size_t num_before = opened(scene).size();
    scene.step();
    const std::vector<int> all = opened(scene);
    at_once.open(std::span(all).subspan(num_before));
    EXPECT_EQ(body(scene).mesh().hexahedra(), at_once.mesh().hexahedra()) << "step " << step;
  }
  EXPECT_EQ(opened(scene).size(), 32u);
  EXPECT_EQ(num_pieces(body(scene)), 4);
}

// A blade at rest, and a body that falls past it.
TEST(BladeController, CutsTissueThatMoves) {
  scene::Scene scene =
      read_and_init(block("<BladeController points='-1 -1 0  5 5 0' keyTimes='0' positions='0.1 0 -0.2'/>", "0 0 -10"));
  run(scene, 15);
  EXPECT_GT(opened(scene).size(), 16u);
  EXPECT_LT(nodes(scene).col(2).maxCoeff(), -0.2);
  EXPECT_EQ(num_pieces(body(scene)), 2);
}

TEST(BladeController, CutsTheBodyOfItsLink) {
  const auto with = [&](const std::string& blade) {
    std::string left = block(""), right = left;
    for (std::string* each : {&left, &right}) each->erase(each->find("<DefaultAnimationLoop/>"), 23);
    left.insert(5, " name='left'");
    right.insert(5, " name='right'");
    return "<Node dt='0.1' gravity='0 0 0'><DefaultAnimationLoop/>" + left + right + blade + "</Node>";
  };
  std::string by_component = kBlade, by_node = kBlade;
  by_component.insert(16, " body='@right/flesh'");
  by_node.insert(16, " body='@left'");
  for (const auto& [blade, cut, whole] :
       {std::tuple{by_component, "right/flesh", "left/flesh"}, {by_node, "left/flesh", "right/flesh"}}) {
    scene::Scene scene = read_and_init(with(blade));
    run(scene, 10);
    EXPECT_EQ(body(scene, cut).opened().size(), 16u);
    EXPECT_EQ(body(scene, whole).opened().size(), 0u);
  }
}

TEST(BladeController, IsUndoneByResetAndGoesOnAfterACheckpoint) {
  scene::Scene scene = read_and_init(block(kBlade + kOther)), other = read_and_init(block(kBlade + kOther));
  run(scene, 5);
  go_on_in(scene, other);
  run(scene, 5);
  run(other, 5);
  EXPECT_EQ(saved(scene), saved(other));
  const std::vector<std::byte> first = saved(scene);
  scene.reset();
  EXPECT_TRUE(opened(scene).empty());
  run(scene, 10);
  EXPECT_EQ(saved(scene), first);
}

TEST(BladeController, NamesWhatItRefuses) {
  expect_errors([](const std::string& lines) { return block(lines); },
                {{"<BladeController points='0 0 0' keyTimes='0' positions='0 0 0'/>",
                  "BladeController.points: 1 given, must be at least two"},
                 {"<BladeController body='@nodes' points='0 0 0  1 0 0' keyTimes='0' positions='0 0 0'/>",
                  "BladeController.body: the link leads to MechanicalObject 'nodes', "
                  "must lead to a body of hexahedra"}});
  EXPECT_EQ(errors_of("<Node><DefaultAnimationLoop/>" + kBlade + "</Node>"),
            "test.scn:1: error: BladeController: needs a body of hexahedra in its node or above, or a link to one");

  scene::Scene scene = read_and_init(
      block("<BladeController name='blade' points='0 -1 0  0 5 0' keyTimes='0 0.1' positions='-1 0 2.1  500 0 2.1'/>"));
  try {
    scene.step();
    FAIL();
  } catch (const scene::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("BladeController: within a step, the blade and hexahedron"),
              std::string::npos)
        << error.what();
  }
}

/// A sheet that is pulled apart at both ends until it tears, and more.
std::string torn_sheet(const std::string& more, const std::string& fracture = "face") {
  return in_root(
      "gravity='0 0 0' dt='0.01'",
      "<RegularGridTopology name='grid' n='9 5 2' max='0.16 0.08 0.02'/><MechanicalObject name='nodes'/>"
      "<DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField name='flesh' poissonRatio='0.3' "
      "yieldStress='300' plasticFlowRate='20' hardening='0.5' fractureStress='500' fracture='" +
          fracture +
          "'/><BoxROI name='left' box='-1 -1 -1 0.001 1 1'/><BoxROI name='right' box='0.159 -1 -1 1 1 1'/>"
          "<LinearMovementProjectiveConstraint indices='@left.indices' keyTimes='0 1 9' movements='0 0 0 "
          "-0.04 0 0 -0.04 0 0'/>"
          "<LinearMovementProjectiveConstraint indices='@right.indices' keyTimes='0 1 9' movements='0 0 0 "
          "0.04 0 0 0.04 0 0'/>" +
          more);
}

// A tear and a blade open joints in one call: neither sees what the other one opens. The blade passes through the sheet
// near its left end in the step in which it first tears.
TEST(FaceTearing, OpensTogetherWithABlade) {
  int step = 0;
  std::vector<int> torn;
  for (scene::Scene scene = read_and_init(torn_sheet("")); torn.empty() && step < 100; ++step) {
    scene.step();
    torn = at<scene::ForceField>(scene, "flesh").flow_report()->torn;
  }
  ASSERT_FALSE(torn.empty());
  scene::Scene scene = read_and_init(torn_sheet("<BladeController name='blade' points='0 0 -1  0 0 1' keyTimes='" +
                                                std::to_string(0.01 * (step - 1)) + " " + std::to_string(0.01 * step) +
                                                "' positions='0.02 -0.01 0  0.02 0.09 0'/>"));
  run(scene, step - 1);
  EXPECT_TRUE(opened(scene).empty());
  const long revision = body(scene).revision();
  scene.step();
  EXPECT_EQ(body(scene).revision(), revision + 1) << "one call";
  EXPECT_EQ(at<scene::ForceField>(scene, "flesh").flow_report()->torn, torn);
  const std::vector<int> all = opened(scene);
  EXPECT_TRUE(std::ranges::includes(all, torn));
  EXPECT_EQ(all.size(), torn.size() + 4) << "the blade meets four links";
  for (std::size_t k = 0; k < all.size(); ++k)
    EXPECT_EQ(body(scene).crossings()[k] == 0.5, std::ranges::binary_search(torn, all[k])) << "joint " << all[k];
  run(scene, 60);
  EXPECT_TRUE(body(scene).removed().empty());
  EXPECT_GT(num_pieces(body(scene)), 2);
}

TEST(FaceTearing, GoesOnAfterACheckpointAndIsUndoneByReset) {
  scene::Scene scene = read_and_init(torn_sheet("")), other = read_and_init(torn_sheet(""));
  const std::vector<std::byte> first = saved(scene);
  int step = 0;
  while (opened(scene).empty() && ++step < 100) run(scene, 1);
  ASSERT_LT(step, 100) << "it tears";
  go_on_in(scene, other);
  run(scene, 10);
  run(other, 10);
  EXPECT_EQ(saved(scene), saved(other));
  scene.reset();
  EXPECT_EQ(saved(scene), first);
}

// Before the first step, and not when the first face tears.
TEST(FaceTearing, IsRefusedByWhatCannotFollow) {
  const std::string second = "<HexahedronElastoplasticFEMForceField name='second'/>";
  EXPECT_NE(errors_of(torn_sheet(second))
                .find("is a second body on the same nodes: no joint of "
                      "HexahedronElastoplasticFEMForceField 'flesh' can be opened"),
            std::string::npos);
  EXPECT_EQ(errors_of(torn_sheet(second, "cell")), "");
  // a mapping that has failed is not asked
  EXPECT_EQ(errors_of(torn_sheet("<Node><MechanicalObject position='0 0 0'/><BarycentricMapping "
                                 "input_topology='@/nodes'/></Node>"))
                .find("can be opened"),
            std::string::npos);
}

}  // namespace
