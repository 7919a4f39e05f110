// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/body.hpp"
#include "hexaplast/mesh/quality.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::in_root;
using support::read_and_init;

/// Two unit quads at a right angle, and what an extrusion takes.
const std::string kCorner =
    "<ExtrudeQuadsAndGenerateHexas name='shell' surfaceVertices='0 0 0  1 0 0  1 1 0  0 1 0  1 0 -1  1 1 -1' "
    "surfaceQuads='0 1 2 3  1 4 5 2' ";

double volume_of(scene::Engine& shell) {
  const std::vector<double>& x = shell.reals("extrudedVertices");
  const std::vector<std::int64_t>& nodes = shell.integers("extrudedHexas");
  std::vector<Hexahedron> hexahedra(nodes.size() / 8);
  for (std::size_t i = 0; i < nodes.size(); ++i) hexahedra[i / 8][i % 8] = static_cast<int>(nodes[i]);
  return quality(HexMesh(Eigen::Map<const PointArray>(x.data(), static_cast<Eigen::Index>(x.size() / 3), 3), hexahedra))
      .volume;
}

TEST(Extrusion, GrowsHexahedraWithTheThicknessOfTheQuads) {
  const auto volume = [](const std::string& attributes) {
    scene::Scene scene = read_and_init("<Node>" + kCorner + attributes + "/></Node>");
    return volume_of(at<scene::Engine>(scene, "shell"));
  };
  EXPECT_NEAR(volume("thicknessOut='0.1' numberOfSlices='3'"), 1.1 * 1.1 - 1, 1e-14);
  EXPECT_NEAR(volume("thicknessOut='0' thicknessIn='0.1'"), 1 - 0.9 * 0.9, 1e-14);
  EXPECT_NEAR(volume("thicknessOut='-0.1'"), 1 - 0.9 * 0.9, 1e-14);
  EXPECT_NEAR(volume("thicknessOut='0.1' flipNormals='true'"), 1.1 * 1.1 - 1, 1e-14);
  EXPECT_NEAR(volume("thicknessOut='0.1' scale='2 3 2'"), 3 * (2.1 * 2.1 - 4), 1e-13);
}

// SOFA's numbers: the nodes of a vertex one after the other, and the hexahedra of a quad.
TEST(Extrusion, NumbersAsSofaDoes) {
  scene::Scene scene = read_and_init("<Node>" + kCorner + "thicknessOut='0.1' numberOfSlices='2'/></Node>");
  auto& shell = at<scene::Engine>(scene, "shell");
  EXPECT_EQ(shell.integers("extrudedSurfaceQuads"), (std::vector<std::int64_t>{0, 3, 6, 9, 3, 12, 15, 6}));
  EXPECT_EQ(shell.integers("extrudedQuads").size(), 4u * (2 * 3 + 7 * 2));
  EXPECT_EQ(shell.vectors3("extrudedVertices").rows(), 18);
  EXPECT_TRUE(shell.vectors3("extrudedVertices").row(1).isApprox(Eigen::RowVector3d(0, 0, 0.05)));
  const std::vector<std::int64_t>& hexahedra = shell.integers("extrudedHexas");
  EXPECT_EQ(std::vector(hexahedra.begin() + 8, hexahedra.begin() + 16),
            (std::vector<std::int64_t>{1, 4, 7, 10, 2, 5, 8, 11}));
}

TEST(Extrusion, FeedsABody) {
  scene::Scene scene = read_and_init(
      in_root("gravity='0 0 -10'", kCorner + "thicknessOut='0.1' numberOfSlices='2'/>"
                                             "<HexahedronSetTopologyContainer position='@shell.extrudedVertices' "
                                             "hexas='@shell.extrudedHexas'/><MechanicalObject name='nodes'/>"
                                             "<MeshMatrixMass massDensity='100'/>"
                                             "<FixedProjectiveConstraint indices='0-2 9-11'/>"
                                             "<HexahedronFEMForceField name='body' youngModulus='1e6'/>"));
  EXPECT_NEAR(at<scene::ForceField>(scene, "body").body()->initial_volume(), 1.1 * 1.1 - 1, 1e-14);
  for (int k = 0; k < 3; ++k) scene.step();
  EXPECT_LT(at<scene::MechanicalState>(scene, "nodes").positions()(14, 2), -1) << "its end sinks";
}

TEST(Extrusion, RefusesWhatIsNoSurfaceOrFolds) {
  const auto errors = [](const std::string& attributes) {
    return errors_of("<Node><ExtrudeQuadsAndGenerateHexas surfaceVertices='0 0 0  1 0 0  1 1 0  0 1 0' " + attributes +
                     "/></Node>");
  };
  const std::string at = "test.scn:1: error: ExtrudeQuadsAndGenerateHexas.";
  EXPECT_EQ(errors("surfaceQuads='0 1 2'"), at + "surfaceQuads: 3 numbers given, must be groups of 4");
  EXPECT_EQ(errors("surfaceQuads='0 1 2 4'"), at + "surfaceQuads: 4 must lie in [0, 4)");
  EXPECT_EQ(errors(""), at + "surfaceQuads: a surface without quads: at least one needed");
  EXPECT_EQ(errors("surfaceQuads='0 2 1 3'"), at + "surfaceQuads: 1 quads that are flat, concave or twisted at a "
                                                   "corner: 0; all four corners must be convex on the same side");
  EXPECT_NE(errors("surfaceQuads='0 1 2 3' numberOfSlices='0'").find("numberOfSlices"), std::string::npos);
  EXPECT_EQ(errors("surfaceQuads='0 1 2 3' thicknessOut='0'"),
            at + "surfaceQuads: a thickness of 0 inward and 0 outward: must be finite, and their sum not 0");
  EXPECT_NE(errors_of("<Node>" + kCorner + "thicknessIn='2'/></Node>").find("2 quads fold"), std::string::npos);
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

TEST(ShapeTopology, RefusesWhatMakesNone) {
  const auto errors = [](const std::string& component) { return errors_of("<Node><" + component + "/></Node>"); };
  EXPECT_EQ(errors("TubeGridTopology cells='1 8'"),
            "test.scn:1: error: TubeGridTopology.cells: 2 numbers given, must be three");
  EXPECT_EQ(errors("TubeGridTopology cells='1000 1000 1000'"),
            "test.scn:1: error: TubeGridTopology.cells: 1e+09 cells, must be at most 16777216");
  EXPECT_EQ(errors("TubeGridTopology innerRadius='2'"),
            "test.scn:1: error: TubeGridTopology: an inner radius of 2 m and an outer one of 0.012 m: must be the "
            "lesser one");
  EXPECT_EQ(errors("TubeGridTopology centreline='0 0 1'"),
            "test.scn:1: error: TubeGridTopology: a curve of 21 points through 1: at least 2 needed");
  EXPECT_EQ(errors("SheetGridTopology size='1'"),
            "test.scn:1: error: SheetGridTopology.size: 1 numbers given, must be two");
  EXPECT_NE(errors("SheetGridTopology curvature='2000'"), "");
  EXPECT_NE(errors("SpherePatchGridTopology angle='180'"), "");
}

}  // namespace
