// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/base/memory.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::four_nodes;
using support::in_root;
using support::read_and_init;
using support::rows;

using Numbers = std::vector<std::int64_t>;

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
      read_and_init("<Node><MeshTopology name='mesh' " + kTwoCells + " quads='0 1 4 3' lines='0 1  1 2'/></Node>");
  EXPECT_EQ(at<scene::Topology>(given, "mesh").quads(), (std::vector<Quad>{{0, 1, 4, 3}}));
  EXPECT_EQ(at<scene::Topology>(given, "mesh").edges(), (std::vector<Edge>{{0, 1}, {1, 2}}));
}

TEST(MeshTopology, RefusesNodesItDoesNotHaveAndBrokenGroups) {
  EXPECT_EQ(errors_of("<Node><MeshTopology position='0 0 0  1 0 0' edges='0 2'/></Node>"),
            "test.scn:1: error: MeshTopology.edges: 2 must lie in [0, 2)");
  EXPECT_EQ(errors_of("<Node><MeshTopology position='0 0 0  1 0 0' quads='0 1 0'/></Node>"),
            "test.scn:1: error: MeshTopology.quads: 3 numbers given, must be groups of 4");
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

TEST(Grid, TakesItsSizeInEveryFormOfSofa) {
  const auto grid = [](const std::string& attributes) {
    scene::Scene scene = read_and_init("<Node><RegularGridTopology name='grid' " + attributes + "/></Node>");
    auto& topology = at<scene::Topology>(scene, "grid");
    return std::pair(PointArray(topology.positions()), topology.hexahedra().size());
  };
  const auto expected = grid("n='3 4 5' min='1 2 3' max='2 4 6'");
  EXPECT_EQ(expected.second, 24u);
  EXPECT_EQ(grid("nx='3' ny='4' nz='5' xmin='1' ymin='2' zmin='3' xmax='2' ymax='4' zmax='6'"), expected);
  EXPECT_EQ(grid("cellWidth='0.7' min='1 2 3' max='2 4 6'").second, 2u * 3u * 5u);
  EXPECT_EQ(errors_of("<Node><RegularGridTopology xmin='0'/></Node>"),
            "test.scn:1: error: RegularGridTopology.ymin: is not given, others of the six are: all are needed");
  EXPECT_EQ(errors_of("<Node><RegularGridTopology cellWidth='1e-9'/></Node>"),
            "test.scn:1: error: RegularGridTopology.n: 1e+27 cells, must be at most 16777216");
}

// Hexahedra that would fill the machine are refused before they are made.
TEST(Grid, WhoseBodyIsTooLargeForTheMachineIsRefused) {
  const std::uint64_t layers =
      physical_memory() / (256 * 256 * static_cast<std::uint64_t>(kLeastBytesPerHexahedron)) + 1;
  if (layers > 256) GTEST_SKIP() << "the largest grid fits into this machine";
  const std::string refusal =
      errors_of("<Node><RegularGridTopology n='257 257 " + std::to_string(layers + 1) + "'/></Node>");
  EXPECT_EQ(refusal.find("test.scn:1: error: RegularGridTopology.n: a body of "), 0u) << refusal;
}

TEST(Grid, HasQuadsAndEdges) {
  scene::Scene scene = read_and_init("<Node><RegularGridTopology name='grid' n='2 2 3'/></Node>");
  EXPECT_EQ(at<scene::Topology>(scene, "grid").integers("quads").size(), 4u * 11u);
  EXPECT_EQ(at<scene::Topology>(scene, "grid").integers("edges").size(), 2u * 20u);
}

TEST(State, SecondTransformationLeavesTheRestShapeAlone) {
  scene::Scene scene = read_and_init(in_root(
      "",
      "<MechanicalObject name='nodes' position='1 0 0  0 2 0' scale='2' rotation2='0 0 90' translation2='5 0 0' "
      "restScale='0.5'/><UniformMass totalMass='1'/>"));
  auto& state = at<scene::MechanicalState>(scene, "nodes");
  EXPECT_TRUE(state.rest_positions().isApprox(rows({{1, 0, 0}, {0, 2, 0}}), 1e-15));
  EXPECT_TRUE(state.positions().isApprox(rows({{5, 2, 0}, {1, 0, 0}}), 1e-15));
}

TEST(BoxROI, FindsCellsOfEveryKindAndTheirNodes) {
  scene::Scene scene = read_and_init(in_root(
      "",
      "<RegularGridTopology n='3 2 2' max='2 1 1'/><MechanicalObject name='nodes'/><UniformMass totalMass='1'/>"
      "<BoxROI name='roi' box='-1 -1 -1 1.1 2 2'/><BoxROI name='tilted' orientedBox='1 -1 -1  1 2 -1  1 2 2  0.1'/>"
      "<BoxROI name='own' box='-1 -1 -1 1.1 2 2' triangles='0 1 3  1 2 4' quads='1 2 5 4'/>"));
  auto& roi = at<scene::Engine>(scene, "roi");
  EXPECT_EQ(roi.integers("hexahedronIndices"), (Numbers{0}));
  EXPECT_EQ(roi.integers("hexahedraInROI"), (Numbers{0, 1, 4, 3, 6, 7, 10, 9}));
  EXPECT_EQ(roi.integers("quadIndices").size(), 6u);
  EXPECT_EQ(roi.integers("quadsInROI").size(), 24u);
  EXPECT_EQ(roi.integers("edgeIndices").size(), 12u);
  EXPECT_EQ(roi.integer("nbIndices"), 8);
  EXPECT_EQ(at<scene::Engine>(scene, "tilted").integers("indices"), (Numbers{1, 4, 7, 10}));
  EXPECT_EQ(at<scene::Engine>(scene, "own").integers("triangleIndices"), (Numbers{0}));
  EXPECT_EQ(at<scene::Engine>(scene, "own").integers("trianglesInROI"), (Numbers{0, 1, 3}));
  EXPECT_EQ(at<scene::Engine>(scene, "own").integers("quadIndices"), (Numbers{}));
  EXPECT_EQ(errors_of(four_nodes("<BoxROI orientedBox='1 2 3'/>")),
            "test.scn:1: error: BoxROI.orientedBox: 3 numbers given, must be groups of 10");
}

TEST(BoxROI, RefusesCellsOfNodesThatAreNotThereThoughNobodyAsksForThem) {
  const std::string error =
      errors_of(in_root("",
                        "<RegularGridTopology n='3 2 2' max='2 1 1'/><MechanicalObject/><UniformMass totalMass='1'/>"
                        "<BoxROI name='roi' box='-1 -1 -1 1.1 2 2' quads='1 2 5 12'/>"));
  EXPECT_NE(error.find("12"), std::string::npos) << error;
}

TEST(SphereROI, CountsItsSurfaceAsInside) {
  scene::Scene scene =
      read_and_init(four_nodes("<SphereROI name='one' centers='0 0 0' radii='2'/>"
                               "<SphereROI name='two' centers='0 0 4  1 0 1' radii='1 1.5'/>"
                               "<SphereROI name='same' centers='0 0 3  1 0 0' radii='0.1'/>"));
  EXPECT_EQ(at<scene::Engine>(scene, "one").integers("indices"), (Numbers{0, 1}));
  EXPECT_EQ(at<scene::Engine>(scene, "two").integers("indices"), (Numbers{0, 2}));
  EXPECT_EQ(at<scene::Engine>(scene, "same").integers("indices"), (Numbers{0, 2}));
  EXPECT_EQ(errors_of(four_nodes("<SphereROI centers='0 0 0' radii='1 2'/>")),
            "test.scn:1: error: SphereROI.radii: 2 radii given for 1 centers, must be one or as many");
}

// One box of 10 kg/m^3, 1 x 1 x 4 m as it stands and half as large in each direction at rest.
TEST(MeshMatrixMass, CouplesNodesUnlessLumped) {
  const auto product = [](const std::string& mass) {
    scene::Scene scene =
        read_and_init(in_root("gravity='0 0 0'",
                              "<RegularGridTopology n='2 2 2' max='1 1 2'/><MechanicalObject name='nodes' "
                              "scale3d='1 1 2' restScale='0.5'/><MeshMatrixMass name='mass' " +
                                  mass + "/>"));
    PointArray dx = PointArray::Zero(8, 3), df = dx;
    dx(0, 1) = 1;
    at<scene::Mass>(scene, "mass").add_product(1, dx, df);
    BlockMatrix A(8);
    at<scene::Mass>(scene, "mass").add_blocks(1, A);
    for (const auto& entry : A.row(0)) EXPECT_NEAR(entry.block(1, 1), df(entry.column, 1), 1e-14);
    PointArray weight = PointArray::Zero(8, 3);
    at<scene::Mass>(scene, "mass").add_gravity(Vec3(0, 0, 1), weight);
    EXPECT_NEAR(at<scene::Mass>(scene, "mass").kinetic_energy(dx), df(0, 1) / 2, 1e-14);
    return std::pair(Eigen::VectorXd(df.col(1)), weight.col(2).sum());
  };
  const auto& [coupled, weight] = product("massDensity='10'");
  EXPECT_NEAR(weight, 40, 1e-13);
  Eigen::VectorXd expected(8);
  expected << 8, 4, 4, 2, 4, 2, 2, 1;
  EXPECT_TRUE(coupled.isApprox(expected * 40 / 216, 1e-13)) << coupled;
  EXPECT_TRUE(product("massDensity='10' lumping='true'").first.isApprox(5 * Eigen::VectorXd::Unit(8, 0), 1e-14));
  EXPECT_NEAR(product("massDensity='10' computeMassOnRest='true'").second, 40. / 8, 1e-14);
  EXPECT_NEAR(product("totalMass='3'").second, 3, 1e-14);
  EXPECT_NEAR(product("").second, 1, 1e-14);
}

// The coupled mass enters the operator: (M - h^2 K) dv = h f on a free box.
TEST(MeshMatrixMass, EntersTheSystem) {
  for (const std::string solver :
       {"<SparseLDLSolver/>", "<CGLinearSolver iterations='99' tolerance='1e-14' threshold='0'/>"}) {
    scene::Scene scene = read_and_init(
        "<Node gravity='0 0 -2' dt='0.5'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver +
        "<RegularGridTopology n='2 2 2'/><MechanicalObject name='nodes'/><MeshMatrixMass name='mass' massDensity='10'/>"
        "<HexahedronElastoplasticFEMForceField name='body' youngModulus='100'/>"
        "<ConstantForceField indices='3' forces='0 4 0'/></Node>");
    const PointArray still = PointArray::Zero(8, 3);
    PointArray elastic = still;
    scene.step();
    const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
    auto& body = at<scene::ForceField>(scene, "body");
    PointArray momentum = still;
    at<scene::Mass>(scene, "mass").add_product(1, v, momentum);
    body.add_force(0, at<scene::MechanicalState>(scene, "nodes").rest_positions(), still, elastic);
    body.add_stiffness_product(-0.25, v, momentum);

    PointArray expected = still;
    expected.col(2).setConstant(0.5 * -2 * 10. / 8);
    expected(3, 1) = 0.5 * 4;
    EXPECT_LE(support::max_abs(momentum - expected), 1e-12);
  }
}

}  // namespace
