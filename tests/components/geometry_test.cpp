// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "base/memory.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

const std::string kTwoCells =
    "position='0 0 0  1 0 0  2 0 0  0 1 0  1 1 0  2 1 0  0 0 1  1 0 1  2 0 1  0 1 1  1 1 1  2 1 1' "
    "hexahedra='0 1 4 3 6 7 10 9  1 2 5 4 7 8 11 10'";

TEST(MeshTopology, HoldsWhatIsGivenAndTheFacesOfItsHexahedra) {
  for (const std::string name : {"MeshTopology", "HexahedronSetTopologyContainer"}) {
    scene::Scene scene =
        read_and_init("<Node><" + name + " name='mesh' " + kTwoCells +
                      " triangles='0 1 4'/><HexahedronSetTopologyModifier removeIsolated='0'/></Node>");
    auto& mesh = at<scene::Topology>(scene, "mesh");
    EXPECT_EQ(mesh.positions().rows(), 12);
    EXPECT_EQ(mesh.hexahedra()[1], (Hexahedron{1, 2, 5, 4, 7, 8, 11, 10}));
    EXPECT_EQ(mesh.triangles(), (std::vector<Triangle>{{0, 1, 4}}));
    EXPECT_EQ(mesh.quads().size(), 11u);
    EXPECT_EQ(mesh.edges().size(), 20u);
  }
  scene::Scene given =
      read_and_init("<Node><MeshTopology name='mesh' " + kTwoCells + " quads='0 1 4 3' edges='0 1  1 2'/></Node>");
  EXPECT_EQ(at<scene::Topology>(given, "mesh").quads(), (std::vector<Quad>{{0, 1, 4, 3}}));
  EXPECT_EQ(at<scene::Topology>(given, "mesh").edges(), (std::vector<Edge>{{0, 1}, {1, 2}}));
}

TEST(MeshTopology, RefusesNodesItDoesNotHaveAndBrokenGroups) {
  expect_errors(in_node,
                {{"<MeshTopology position='0 0 0  1 0 0' edges='0 2'/>", "MeshTopology.edges: 2 must lie in [0, 2)"},
                 {"<MeshTopology position='0 0 0  1 0 0' quads='0 1 0'/>",
                  "MeshTopology.quads: 3 numbers given, must be groups of 4"}});
}

// A mesh may know its cells alone; the nodes are then those of the state.
TEST(MeshTopology, WithoutNodesTakesThoseOfTheState) {
  const std::string body = "<HexahedronElastoplasticFEMForceField name='body'/>";
  const std::string state = "<MechanicalObject name='nodes' position='@mesh.position'/><UniformMass totalMass='1'/>";
  scene::Scene scene = read_and_init(
      in_root("",
              "<MeshTopology hexahedra='0-7'/><MechanicalObject name='nodes' position='0 0 0  1 0 0  1 1 0  0 1 0  "
              "0 0 1  1 0 1  1 1 1  0 1 1'/><UniformMass totalMass='1'/>" +
                  body));
  EXPECT_EQ(at<scene::ForceField>(scene, "body").body()->mesh().num_elements(), 1);
  EXPECT_EQ(errors_of(in_root("",
                              "<MeshTopology hexahedra='0-7'/><MechanicalObject position='0 0 0  1 0 0'/>"
                              "<UniformMass totalMass='1'/>" +
                                  body)),
            "test.scn:1: error: HexahedronElastoplasticFEMForceField: hexahedron 0 of its topology has node 7, the "
            "mechanical state has 2 nodes");
  scene::Scene linked = read_and_init(in_root("", "<MeshTopology name='mesh' " + kTwoCells + "/>" + state + body));
  EXPECT_EQ(at<scene::ForceField>(linked, "body").body()->mesh().num_elements(), 2);
}

TEST(Grid, NumbersItsNodesWithXFastest) {
  scene::Scene scene =
      read_and_init("<Node><RegularGridTopology name='grid' n='2 3 4' min='1 0 0' max='2 4 9'/></Node>");
  auto& grid = at<scene::Topology>(scene, "grid");
  ASSERT_EQ(grid.positions().rows(), 24);
  EXPECT_EQ(grid.positions().row(1 + 2 * (2 + 3 * 1)), Eigen::RowVector3d(2, 4, 3));
  EXPECT_EQ(grid.hexahedra().size(), 6u);
  EXPECT_EQ(grid.hexahedra()[1], (Hexahedron{2, 3, 5, 4, 8, 9, 11, 10}));
  EXPECT_EQ(grid.integers("hexahedra").size(), 48u);
}

TEST(Grid, TakesTheNumberOrTheWidthOfItsCells) {
  const auto grid = [](const std::string& attributes) {
    scene::Scene scene = read_and_init("<Node><RegularGridTopology name='grid' " + attributes + "/></Node>");
    auto& topology = at<scene::Topology>(scene, "grid");
    return topology.hexahedra().size();
  };
  EXPECT_EQ(grid("n='3 4 5' min='1 2 3' max='2 4 6'"), 24u);
  EXPECT_EQ(grid("cellWidth='0.7' min='1 2 3' max='2 4 6'"), 2u * 3u * 5u);
  expect_errors(
      in_node,
      {{"<RegularGridTopology n='2 2 1'/>", "RegularGridTopology.n: 1 must lie in [2, 2147483646]"},
       {"<RegularGridTopology n='2 2'/>", "RegularGridTopology.n: 2 numbers given, must be three"},
       {"<RegularGridTopology n='2 2 2147483646'/>",
        "RegularGridTopology.n: 2.147e+09 cells, must be at most 16777216"},
       {"<RegularGridTopology cellWidth='1e-9'/>", "RegularGridTopology.n: 1e+27 cells, must be at most 16777216"},
       {"<RegularGridTopology min='0 1 0'/>", "RegularGridTopology.max: must be greater than min in every direction"}});
}

// Hexahedra that would fill the machine are refused before they are made.
TEST(Grid, WhoseBodyIsTooLargeForTheMachineIsRefused) {
  const std::uint64_t layers =
      available_memory() / (256 * 256 * static_cast<std::uint64_t>(kMinBytesPerHexahedron)) + 1;
  if (layers > 256) GTEST_SKIP() << "the largest grid fits into this machine";
  const std::string refusal =
      errors_of("<Node><RegularGridTopology n='257 257 " + std::to_string(layers + 1) + "'/></Node>");
  EXPECT_EQ(refusal.find("test.scn:1: error: RegularGridTopology.n: a body of "), 0u) << refusal;
}

TEST(State, IsScaledThenTurnedThenMoved) {
  scene::Scene scene = read_and_init(in_root(
      "",
      "<MechanicalObject name='nodes' position='1 2 3  0 0 0' scale3d='2 1 1' rotation='90 0 90' translation='10 0 0'/>"
      "<UniformMass totalMass='1'/>"));
  // (1,2,3) -> (2,2,3) -> about x (2,-3,2) -> about z (3,2,2) -> (13,2,2)
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  EXPECT_TRUE(state.positions().isApprox(rows({{13, 2, 2}, {10, 0, 0}}), 1e-14));
  EXPECT_EQ(state.rest_positions(), state.positions());
}

TEST(State, FieldsHaveOneRowPerNode) {
  EXPECT_EQ(errors_of(in_root(
                "", "<MechanicalObject position='0 0 0  1 0 0' velocity='1 0 0'/><UniformMass totalMass='1'/>")),
            "test.scn:1: error: MechanicalObject.velocity: 1 vectors given for 2 nodes");
  EXPECT_EQ(errors_of(in_root("", "<MechanicalObject/><UniformMass totalMass='1'/>")),
            "test.scn:1: error: MechanicalObject: has no nodes: needs position or a topology");
}

TEST(ShapeTopology, MakesWhatItsNameSays) {
  scene::Scene scene = read_and_init(
      "<Node><TubeGridTopology name='straight' cells='1 8 4' innerRadius='1' outerRadius='2' length='4'/>"
      "<TubeGridTopology name='bent' cells='1 8 4' innerRadius='1' outerRadius='2' length='10' bend='90'/>"
      "<TubeGridTopology name='along' cells='1 8 4' innerRadius='1' outerRadius='2' centreline='0 0 0  0 0 1  0 0 4'/>"
      "<SheetGridTopology name='sheet' cells='3 2 1' size='3 2' thickness='0.5'/>"
      "<SpherePatchGridTopology name='patch' cells='2 2 1' innerRadius='1' outerRadius='2' angle='90'/></Node>");
  auto& straight = at<scene::Topology>(scene, "straight");
  EXPECT_EQ(straight.positions().rows(), 2 * 8 * 5);
  EXPECT_EQ(straight.hexahedra().size(), 32u);
  EXPECT_EQ(straight.quads().size(), (32u * 6 + 2 * 8 * 4 + 2 * 8) / 2);
  EXPECT_EQ(straight.integers("edges").size(), 2u * (8 * 5 + 2 * 8 * 5 + 2 * 8 * 4));
  EXPECT_DOUBLE_EQ(straight.positions().col(2).maxCoeff(), 4);
  EXPECT_LT((at<scene::Topology>(scene, "along").positions() - straight.positions()).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_NEAR(at<scene::Topology>(scene, "bent").positions().col(0).maxCoeff(), 20 / std::acos(-1), 1e-12);
  EXPECT_EQ(at<scene::Topology>(scene, "sheet").positions().row(0), Eigen::RowVector3d(-1.5, -1, -0.25));
  EXPECT_TRUE(at<scene::Topology>(scene, "patch").positions().row(4).isApprox(Eigen::RowVector3d(0, 0, 1)));
}

// What else makes none is refused by Shapes and Options.
TEST(ShapeTopology, RefusesWhatMakesNone) {
  expect_errors(in_node, {{"<TubeGridTopology cells='1000 1000 1000'/>",
                           "TubeGridTopology.cells: 1e+09 cells, must be at most 16777216"},
                          {"<TubeGridTopology innerRadius='2'/>",
                           "TubeGridTopology: an inner radius of 2 m and an outer one of 0.012 m: must be the lesser "
                           "one"}});
}

}  // namespace
