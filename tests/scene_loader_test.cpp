// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::in_root;
using support::read_and_init;

const std::string kFolder = HEXAPLAST_TEST_DATA "/meshes/";

scene::Scene loaded(const std::string& loader, const std::string& file, const std::string& attributes = "") {
  return read_and_init("<Node><" + loader + " name='loader' filename='" + kFolder + file + "' " + attributes +
                       "/><MeshTopology name='mesh' src='@loader'/></Node>");
}

TEST(MeshLoader, GivesTopologiesWhatAFileHolds) {
  for (const auto& [loader, file] :
       {std::pair("MeshGmshLoader", "two_41_binary.msh"), std::pair("MeshVTKLoader", "two_zlib.vtu"),
        std::pair("MeshVTKLoader", "two_42_binary.vtk")}) {
    scene::Scene scene = loaded(loader, file);
    auto& mesh = at<scene::Topology>(scene, "mesh");
    EXPECT_EQ(mesh.positions().row(9), Eigen::RowVector3d(0.1, 1, 1.1));
    EXPECT_EQ(mesh.hexahedra()[1], (Hexahedron{1, 2, 5, 4, 7, 8, 11, 10}));
    EXPECT_EQ(mesh.triangles().size(), 2u);
    const bool adds_faces = std::string(loader) == "MeshGmshLoader";  // its createSubelements is true by default
    EXPECT_EQ(mesh.quads().size(), adds_faces ? 11u : 1u);
    EXPECT_EQ(scene::format(scene.diagnostics().take_warnings().back()),
              "test.scn:1: warning: " + std::string(loader) +
                  ".filename: 1 cells are skipped: neither edges, triangles, quads nor hexahedra of first order");
  }
  scene::Scene surface = loaded("MeshOBJLoader", "surface.obj", "triangulate='true'");
  EXPECT_EQ(at<scene::Topology>(surface, "mesh").triangles().size(), 4u);
  EXPECT_TRUE(at<scene::Topology>(surface, "mesh").quads().empty());
}

TEST(MeshLoader, PlacesAndCleans) {
  scene::Scene scene = loaded("MeshVTKLoader", "two_ascii.vtu",
                              "scale3d='2 1 1' scale='2' rotation='0 0 90' translation='0 0 7' onlyAttachedPoints='1'");
  EXPECT_EQ(at<scene::Topology>(scene, "mesh").positions().rows(), 12);
  // (1.25, 0, .1) -> (5, 0, .2) -> (0, 5, .2) -> (0, 5, 7.2)
  EXPECT_TRUE(at<scene::Topology>(scene, "mesh").positions().row(1).isApprox(Eigen::RowVector3d(0, 5, 7.2), 1e-14));
  scene::Scene matrix =
      loaded("MeshVTKLoader", "two_ascii.vtu", "transformation='0 0 1 5  1 0 0 6  0 1 0 7  0 0 0 1' scale='9'");
  EXPECT_TRUE(at<scene::Topology>(matrix, "mesh").positions().row(1).isApprox(Eigen::RowVector3d(5.1, 7.25, 7), 1e-14));
}

// Said once, however many components ask for the mesh.
TEST(MeshLoader, RefusesWhereTheSceneNamesTheFile) {
  const std::string scene =
      "<Node>\n<MeshGmshLoader name='loader' filename='none.msh'/>\n<MeshTopology src='@loader'/>"
      "<MeshTopology name='other' src='@loader'/></Node>";
  EXPECT_EQ(errors_of(scene), "test.scn:2: error: MeshGmshLoader.filename: none.msh: no such file");
  EXPECT_EQ(errors_of("<Node><MeshVTKLoader filename='" + kFolder + "two_22_ascii.msh'/></Node>"),
            "test.scn:1: error: MeshVTKLoader.filename: " + kFolder +
                "two_22_ascii.msh:1: the file does not begin with '# vtk DataFile Version' and is no XML");
  EXPECT_EQ(errors_of("<Node><MeshVTKLoader/></Node>"),
            "test.scn:1: error: MeshVTKLoader.filename: is not given, must name a mesh file");
  EXPECT_EQ(errors_of("<Node><MeshVTKLoader filename='" + kFolder + "two_ascii.vtu' transformation='1 0 0'/></Node>"),
            "test.scn:1: error: MeshVTKLoader.transformation: 3 numbers given, must be sixteen");
}

// An elastic scene as SOFA users write it: loader, container, state by links, elastic field.
TEST(MeshLoader, FeedsABody) {
  scene::Scene scene = read_and_init(in_root(
      "gravity='0 -10 0'", "<MeshVTKLoader name='loader' filename='" + kFolder +
                               "two_51_binary.vtk' onlyAttachedPoints='true'/>"
                               "<HexahedronSetTopologyContainer name='mesh' src='@loader'/>"
                               "<HexahedronSetTopologyModifier/><HexahedronSetGeometryAlgorithms/>"
                               "<MechanicalObject name='nodes' src='@loader'/><MeshMatrixMass massDensity='100'/>"
                               "<FixedProjectiveConstraint indices='0 3 6 9'/>"
                               "<HexahedronFEMForceField name='body' youngModulus='20000' poissonRatio='0.3'/>"));
  const auto& field = at<scene::ForceField>(scene, "body");
  EXPECT_EQ(field.body()->mesh().num_elements(), 2);
  for (int k = 0; k < 20; ++k) scene.step();
  EXPECT_LT(at<scene::MechanicalState>(scene, "nodes").positions()(8, 1), -0.001) << "it sags";
  EXPECT_EQ(field.flow_report()->yielded, 0);
}

// The elastic case of our own field, with the same bits.
TEST(HexahedronFEM, IsTheElasticCase) {
  const auto end = [](const std::string& field) {
    scene::Scene scene = read_and_init(
        in_root("",
                "<RegularGridTopology n='3 3 5' max='2 2 8'/><MechanicalObject name='nodes'/><UniformMass "
                "totalMass='9'/><FixedProjectiveConstraint indices='0-8'/>" +
                    field));
    for (int k = 0; k < 10; ++k) scene.step();
    return PointArray(at<scene::MechanicalState>(scene, "nodes").positions());
  };
  const PointArray ours =
      end("<HexahedronElastoplasticFEMForceField youngModulus='300' poissonRatio='0.3' rayleighStiffness='0.1'/>");
  EXPECT_EQ(end("<HexahedronFEMForceField youngModulus='300' poissonRatio='0.3' rayleighStiffness='0.1' "
                "method='polar' updateStiffnessMatrix='false' drawing='1'/>"),
            ours);
  EXPECT_NE(errors_of(in_root("", "<HexahedronFEMForceField method='qr'/>")), "");
  EXPECT_NE(errors_of(in_root("", "<HexahedronFEMForceField updateStiffnessMatrix='true'/>")), "");
}

}  // namespace
