// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>

#include "base/memory.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"
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

TEST(MeshTopology, RefusesNodesItDoesNotHaveBrokenGroupsAndCopies) {
  expect_errors(
      [](const std::string& cells) {
        return in_node(
            "<MeshTopology position='0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 "
            "1 0 1 1 1 1 0 1 1' " +
            cells + "/>");
      },
      {{"edges='0 8'", "edges: 8 must lie in [0, 8)"},
       {"quads='0 1 0'", "quads: 3 numbers given, must be groups of 4"},
       {"hexahedra='0 1 2 3 4 5 6 7 1 2 3 0 5 6 7 4'",
        "hexahedra: 1 hexahedra with the same eight nodes as another one: 1 as 0; each must be given once"}},
      "MeshTopology.");
}

TEST(MeshTopology, WithoutNodesTakesThoseOfTheState) {
  const auto scene_of = [](const std::string& mesh, const std::string& positions) {
    return in_root("", "<MeshTopology name='mesh' " + mesh + "/><MechanicalObject position='" + positions +
                           "'/><UniformMass totalMass='1'/><HexahedronElastoplasticFEMForceField name='body'/>");
  };
  for (const auto& [mesh, positions, count] :
       {std::tuple<std::string, const char*, int>{"hexahedra='0-7'",
                                                  "0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1", 1},
        {kTwoCells, "@mesh.position", 2}}) {
    scene::Scene scene = read_and_init(scene_of(mesh, positions));
    EXPECT_EQ(body(scene).mesh().num_elements(), count);
  }
  EXPECT_EQ(errors_of(scene_of("hexahedra='0-7'", "0 0 0  1 0 0")),
            "test.scn:1: error: HexahedronElastoplasticFEMForceField: hexahedron 0 of its topology has node 7, the "
            "mechanical state has 2 nodes");
}

TEST(Grid, TakesTheNumberOrTheWidthOfItsCells) {
  const auto grid = [](const std::string& attributes) {
    return in_node("<RegularGridTopology name='grid' " + attributes + "/>");
  };
  for (const auto& [attributes, count] : {std::pair("n='3 4 5' min='1 2 3' max='2 4 6'", 24u),
                                          {"cellWidth='0.7' min='1 2 3' max='2 4 6'", 2u * 3u * 5u}}) {
    scene::Scene scene = read_and_init(grid(attributes));
    EXPECT_EQ(at<scene::Topology>(scene, "grid").hexahedra().size(), count) << attributes;
  }
  expect_errors(grid,
                {{"n='2 2 1'", "n: 1 must lie in [2, 2147483646]"},
                 {"n='2 2'", "n: 2 numbers given, must be three"},
                 {"n='2 2 2147483646'", "n: 2.147e+09 cells, must be at most 16777216"},
                 {"cellWidth='1e-9'", "n: 1e+27 cells, must be at most 16777216"},
                 {"min='0 1 0'", "max: must be greater than min in every direction"}},
                "RegularGridTopology.");
}

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

const std::string kFolder = HEXAPLAST_TEST_DATA "/meshes/";

scene::Scene loaded_by(const std::string& loader, const std::string& file, const std::string& attributes = "") {
  return read_and_init("<Node><" + loader + " name='loader' filename='" + kFolder + file + "' " + attributes +
                       "/><MeshTopology name='mesh' src='@loader'/></Node>");
}

TEST(MeshLoader, GivesTopologiesWhatAFileHolds) {
  for (const auto& [loader, file] :
       {std::pair("MeshGmshLoader", "two_41_binary.msh"), std::pair("MeshVTKLoader", "two_zlib.vtu"),
        std::pair("MeshVTKLoader", "two_42_binary.vtk")}) {
    scene::Scene scene = loaded_by(loader, file);
    auto& mesh = at<scene::Topology>(scene, "mesh");
    EXPECT_EQ(mesh.positions().row(9), Eigen::RowVector3d(0.1, 1, 1.1));
    EXPECT_EQ(mesh.hexahedra()[1], (Hexahedron{1, 2, 5, 4, 7, 8, 11, 10}));
    EXPECT_EQ(mesh.triangles().size(), 2u);
    const bool adds_faces = std::string(loader) == "MeshGmshLoader";  // its createSubelements is true by default
    EXPECT_EQ(mesh.quads().size(), adds_faces ? 11u : 1u);
    EXPECT_EQ(scene::format(scene.diagnostics().take_warnings().back()),
              "test.scn:1: warning: " + std::string(loader) +
                  ".filename: 1 cells are skipped: neither edges, triangles, quads nor hexahedra of first order: 1 "
                  "tetrahedra " +
                  (adds_faces ? "of 4 nodes (Gmsh type 4)" : "(VTK type 10)"));
  }
  scene::Scene surface = loaded_by("MeshOBJLoader", "surface.obj", "triangulate='true'");
  EXPECT_EQ(at<scene::Topology>(surface, "mesh").triangles().size(), 4u);
  EXPECT_TRUE(at<scene::Topology>(surface, "mesh").quads().empty());
}

TEST(MeshLoader, PlacesAndCleans) {
  scene::Scene scene =
      loaded_by("MeshVTKLoader", "two_ascii.vtu",
                "scale3d='2 1 1' scale='2' rotation='0 0 90' translation='0 0 7' onlyAttachedPoints='1'");
  EXPECT_EQ(at<scene::Topology>(scene, "mesh").positions().rows(), 12);
  // (1.25, 0, .1) -> (5, 0, .2) -> (0, 5, .2) -> (0, 5, 7.2)
  EXPECT_TRUE(at<scene::Topology>(scene, "mesh").positions().row(1).isApprox(Eigen::RowVector3d(0, 5, 7.2), 1e-14));
}

// Files of meshio: both hexahedra are in group 1 of volume 1, which has no name.
TEST(MeshLoader, GivesThePhysicalGroupsOfAGmshFile) {
  for (const char* file : {"two_41_ascii.msh", "two_41_binary.msh"}) {
    scene::Scene scene =
        read_and_init(in_root("", "<MeshGmshLoader name='loader' filename='" + kFolder + file +
                                      "'/><MeshTopology src='@loader'/><MechanicalObject/><UniformMass totalMass='1'/>"
                                      "<HexahedronElastoplasticFEMForceField name='body'/>"
                                      "<MaterialRegion indices='@loader.1' youngModulus='40 50'/>"));
    EXPECT_EQ(body(scene).material(0).young_modulus, 40) << file;
    EXPECT_EQ(body(scene).material(1).young_modulus, 50) << file;
    EXPECT_TRUE(has(errors_of("<Node><MeshGmshLoader name='loader' filename='" + kFolder + file +
                              "'/><IndexValueMapper indices='@loader.2'/></Node>"),
                    "which has no attribute '2'"));
  }
}

TEST(MeshLoader, GivesTheCellDataOfHexahedra) {
  const Scratch folder;
  put(folder / "labels.vtu",
      "<VTKFile type='UnstructuredGrid' byte_order='LittleEndian'><UnstructuredGrid><Piece NumberOfPoints='12' "
      "NumberOfCells='3'><Points><DataArray type='Float64' NumberOfComponents='3' format='ascii'>"
      "0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0 0 0 1 1 0 1 2 0 1 0 1 1 1 1 1 2 1 1</DataArray></Points><Cells>"
      "<DataArray type='Int32' Name='connectivity' format='ascii'>0 1 4 0 1 4 3 6 7 10 9 1 2 5 4 7 8 11 10"
      "</DataArray><DataArray type='Int32' Name='offsets' format='ascii'>3 11 19</DataArray>"
      "<DataArray type='UInt8' Name='types' format='ascii'>5 12 12</DataArray></Cells><CellData>"
      "<DataArray type='Int32' Name='label' format='ascii'>7 4 7</DataArray>"
      "<DataArray type='Float64' Name='modulus' format='ascii'>-1 300 500.5</DataArray>"
      "<DataArray type='Float64' Name='pairs' NumberOfComponents='2' format='ascii'>1 2 3 4 5 6</DataArray>"
      "</CellData></Piece></UnstructuredGrid></VTKFile>");
  const auto scene_of = [&](const std::string& more) {
    return in_root("", "<MeshVTKLoader name='loader' filename='" + (folder / "labels.vtu").string() +
                           "'/><MeshTopology src='@loader'/><MechanicalObject/><UniformMass totalMass='1'/>"
                           "<HexahedronElastoplasticFEMForceField name='body' youngModulus='@loader.modulus'/>" +
                           more);
  };
  scene::Scene scene = read_and_init(
      scene_of("<IndicesFromValues name='liver' global='@loader.label' values='7' recursiveSearch='true'/>"
               "<MaterialRegion indices='@liver.indices' yieldStress='40'/>"));
  EXPECT_EQ(body(scene).material(0).young_modulus, 300);
  EXPECT_EQ(body(scene).material(1).young_modulus, 500.5);
  EXPECT_EQ(body(scene).material(1).yield_stress, 40);
  EXPECT_FALSE(std::isfinite(body(scene).material(0).yield_stress));
  for (const char* name : {"labels", "pairs"})
    EXPECT_TRUE(has(errors_of(scene_of("<IndicesFromValues name='liver' global='@loader." + std::string(name) + "'/>")),
                    "stops at MeshVTKLoader 'loader', which has no attribute '" + std::string(name) + "'"));
}

// Said once, however many components ask for the mesh, and of the file, not of the labels that are not there then.
TEST(MeshLoader, RefusesWhereTheSceneNamesTheFile) {
  const std::string body =
      "<RegularGridTopology/><MechanicalObject/><UniformMass totalMass='1'/><HexahedronElastoplasticFEMForceField/>"
      "<MaterialRegion indices='@loader.tumour'/>";
  expect_errors(in_node,
                {{"<MeshGmshLoader name='loader' filename='none.msh'/><MeshTopology src='@loader'/><MeshTopology "
                  "name='other' src='@loader'/>",
                  "MeshGmshLoader.filename: none.msh: no such file"},
                 {"<MeshVTKLoader filename='" + kFolder + "two_22_ascii.msh'/>",
                  "MeshVTKLoader.filename: " + kFolder +
                      "two_22_ascii.msh:1: the file does not begin with '# vtk DataFile Version' and is no XML"},
                 {"<MeshVTKLoader/>", "MeshVTKLoader.filename: is not given, must name a mesh file"},
                 {"<MeshGmshLoader/>", "MeshGmshLoader.filename: is not given, must name a mesh file"}});
  EXPECT_EQ(errors_of(in_root("", "<MeshGmshLoader name='loader' filename='none.msh'/>" + body)),
            "test.scn:1: error: MeshGmshLoader.filename: none.msh: no such file");
  EXPECT_TRUE(has(errors_of(in_root("", "<MeshVTKLoader name='loader' filename='" + kFolder + "block.vtk'/>" + body)),
                  "has no attribute 'tumour'"));
}

// Walls of 0.1 and 0.4 m in cells of 0.034 and 0.0816 m.
const std::string kOrgan = "<SparseGridTopology name='cage' fileTopology='" + kFolder + "organ.obj' ";

TEST(SparseGrid, HoldsTheCellsOfASurface) {
  const auto cage = [](const std::string& attributes) {
    scene::Scene scene = read_and_init("<Node><DefaultAnimationLoop/>" + kOrgan + attributes + "/></Node>");
    EXPECT_TRUE(scene.diagnostics().take_warnings().empty()) << attributes;
    auto& topology = at<scene::Topology>(scene, "cage");
    EXPECT_EQ(topology.integers("hexahedra").size(), 8 * topology.hexahedra().size());
    return std::tuple(PointArray(topology.positions()), topology.hexahedra().size(),
                      std::vector<double>(topology.fill().begin(), topology.fill().end()));
  };
  const auto& [x, num_hexahedra, fill] = cage("n='4 4 6'");
  EXPECT_EQ(num_hexahedra, 45u);  // 3 x 3 x 5
  EXPECT_TRUE(x.row(0).isApprox(Eigen::RowVector3d(-0.001, -0.001, -0.004), 1e-13));
  EXPECT_TRUE(x.row(1).isApprox(Eigen::RowVector3d(-0.001, -0.001, 0.0776), 1e-13));  // z fastest
  EXPECT_EQ(std::count(fill.begin(), fill.end(), 0.5), 42);
  EXPECT_TRUE(std::ranges::all_of(fill.end() - 3, fill.end(), [](double fraction) { return fraction == 1; }));

  for (const auto& [attributes, count] : {std::pair("n='4 4 6' onlyInsideCells='true'", 3u),
                                          {"cellWidth='0.06'", 2u * 2u * 7u},
                                          {"n='2 2 5' min='-1 -1 -1' max='1 1 1'", 2u}})
    EXPECT_EQ(std::get<1>(cage(attributes)), count) << attributes;
  EXPECT_TRUE(std::get<2>(cage("n='4 4 6' fillWeighted='false'")).empty());
  EXPECT_EQ(std::get<0>(cage("n='2 2 5' min='-1 -1 -1' max='1 1 1'")).row(0), Eigen::RowVector3d(-1, -1, -0.5));
}

TEST(SparseGrid, SaysWhatIsWrong) {
  EXPECT_EQ(
      errors_of(in_node("<SparseGridTopology n='9 9 9' fileTopology='" + kFolder + "open_box.obj'/>")).substr(0, 74),
      "test.scn:1: error: SparseGridTopology: the surface is open, and 216 cells ");
  expect_errors(
      in_node,
      {{"<SparseGridTopology/>", "SparseGridTopology.fileTopology: is not given, must name a mesh file"},
       {"<SparseGridTopology fileTopology='none.obj'/>", "SparseGridTopology.fileTopology: none.obj: no such file"},
       {kOrgan + "n='3 3'/>", "SparseGridTopology.n: 2 numbers given, must be three"},
       {kOrgan + "cellWidth='1e-9'/>", "SparseGridTopology.n: 4.245e+24 cells, must be at most 16777216"}});
  EXPECT_TRUE(has(errors_of(in_node(kOrgan + "max='1 1 0.2'/>")), "lies outside the box from (0, 0, 0)"));
}

TEST(MeshSTLLoader, LoadsTheSurfaceThatOthersLoadToo) {
  const auto loaded = [](const std::string& loader) {
    scene::Scene scene = read_and_init("<Node>" + loader + "<MeshTopology name='skin' src='@loader'/></Node>");
    return std::tuple(PointArray(at<scene::Topology>(scene, "skin").positions()),
                      at<scene::Topology>(scene, "skin").triangles());
  };
  const auto [x, triangles] = loaded("<MeshSTLLoader name='loader' filename='" + kFolder +
                                     "organ_binary.stl' scale3d='2 1 1' translation='0 0 1'/>");
  EXPECT_EQ(triangles.size(), 12u);
  EXPECT_NEAR(x.col(0).maxCoeff(), 0.2, 1e-7);
  EXPECT_NEAR(x.col(2).minCoeff(), 1, 1e-7);
  EXPECT_EQ(std::get<1>(loaded("<MeshSTLLoader name='loader' filename='" + kFolder + "organ_ascii.stl'/>")), triangles);
  expect_errors(in_node, {{"<MeshSTLLoader filename='" + kFolder + "organ_ascii.stl' headerSize='79'/>",
                           "MeshSTLLoader.headerSize: must be 80, as the format has it"}});
}

}  // namespace
