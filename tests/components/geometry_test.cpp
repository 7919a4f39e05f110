// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cmath>

#include "base/memory.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "scene/visuals.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"
#include "support/mesh_text.hpp"
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

TEST(Grid, TakesTheNumberOfItsNodes) {
  const auto grid = [](const std::string& attributes) {
    return in_node("<RegularGridTopology name='grid' " + attributes + "/>");
  };
  scene::Scene scene = read_and_init(grid("n='3 4 5' min='1 2 3' max='2 4 6'"));
  EXPECT_EQ(at<scene::Topology>(scene, "grid").hexahedra().size(), 24u);
  expect_errors(grid,
                {{"n='2 2 1'", "n: 1 must lie in [2, 2147483646]"},
                 {"n='2 2'", "n: 2 numbers given, must be three"},
                 {"n='2 2 2147483646'", "n: 2.147e+09 cells, must be at most 16777216"},
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
    const bool adds_faces = std::string(loader) == "MeshGmshLoader";
    EXPECT_EQ(mesh.quads().size(), adds_faces ? 11u : 1u);
    EXPECT_EQ(scene::format(scene.diagnostics().take_warnings().back()),
              "test.scn:1: warning: " + std::string(loader) +
                  ".filename: 1 cells are skipped: neither edges, triangles, quads nor hexahedra of first order: 1 "
                  "tetrahedra");
  }
  scene::Scene surface = loaded_by("MeshOBJLoader", "surface.obj", "triangulate='true'");
  EXPECT_EQ(at<scene::Topology>(surface, "mesh").triangles().size(), 4u);
  EXPECT_TRUE(at<scene::Topology>(surface, "mesh").quads().empty());
}

TEST(MeshLoader, PlacesWhatItReads) {
  scene::Scene scene =
      loaded_by("MeshVTKLoader", "two_ascii.vtu", "scale3d='2 1 1' scale='2' rotation='0 0 90' translation='0 0 7'");
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

  EXPECT_EQ(std::get<1>(cage("n='2 2 5' min='-1 -1 -1' max='1 1 1'")), 2u);
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
       {kOrgan + "n='2 2 2147483646'/>", "SparseGridTopology.n: 2.147e+09 cells, must be at most 16777216"}});
  EXPECT_TRUE(has(errors_of(in_node(kOrgan + "max='1 1 0.2'/>")), "lies outside the box from (0, 0, 0)"));
}

// Three hexahedra without parallel edges, held at one end, and two points in them; `inner` goes into their node.
std::string skewed(const std::string& inner, const std::string& solver = "<SparseLDLSolver/>",
                   const std::string& outer = "") {
  return "<Node dt='0.02' gravity='0 0 0'><DefaultAnimationLoop/><EulerImplicitSolver name='euler' "
         "rayleighStiffness='0.02'/>" +
         solver +
         "<MeshTopology name='mesh' hexahedra='0-7  4-11  8-15' position='0 0 0  1 0 .1  1.1 1 0  0 1 0  .1 .1 1  1 0 "
         "1.2  "
         "1.2 1 1  0 .9 1.1  0 0 2  1 .2 2  1 1 2.2  .1 1 2  0 0 3  1 0 3.1  1 1 3  -.1 1 3'/>"
         "<MechanicalObject name='nodes'/><UniformMass totalMass='16'/><FixedProjectiveConstraint indices='0-3'/>"
         "<HexahedronElastoplasticFEMForceField youngModulus='2000' poissonRatio='0.3'/>" +
         outer + "<Node name='skin'><MechanicalObject name='points' position='.5 .4 2.4  .3 .7 1.2'/>" + inner +
         "</Node></Node>";
}

PointArray after(const std::string& text, int steps) {
  scene::Scene scene = read_and_init(text);
  run(scene, steps);
  return nodes(scene);
}

TEST(BarycentricMapping, PointsStayWhereTheyAreAndFollow) {
  scene::Scene scene = read_and_init(skewed("<BarycentricMapping input='@..' output='@.'/>", "<SparseLDLSolver/>",
                                            "<ConstantForceField indices='12-15' forces='1 2 3'/>"));
  auto& points = at<scene::MechanicalState>(scene, "skin/points");
  const PointArray first = points.positions();
  const Embedding expected(nodes(scene), at<scene::Topology>(scene, "mesh").hexahedra(), first);
  EXPECT_FALSE(has(warnings_of(scene), "Mapping"));
  run(scene, 10);
  PointArray x(2, 3), v(2, 3);
  expected.apply(nodes(scene), x);
  expected.apply(velocities(scene), v);
  EXPECT_TRUE(agrees(points.positions(), x, 1e-14));
  EXPECT_TRUE(agrees(points.velocities(), v, 1e-13));
  EXPECT_GT(max_abs(x - first), 0.01);
  scene.reset();
  EXPECT_TRUE(agrees(points.positions(), first, 1e-15));
}

// Masses and stiffness of points enter the system: products against blocks, through two mappings one below the
// other.
TEST(BarycentricMapping, CarriesMassesAndStiffnessUp) {
  const std::string inner =
      "<BarycentricMapping/><UniformMass vertexMass='3'/><PlaneForceField normal='0 0 -1' d='-1.1' stiffness='400'/>"
      "<Node name='copy'><MechanicalObject position='@../points.position'/><IdentityMapping/>"
      "<RestShapeSpringsForceField stiffness='30'/><UniformMass vertexMass='1'/></Node>";
  const PointArray direct = after(skewed(inner), 20);
  const PointArray iterative =
      after(skewed(inner, "<CGLinearSolver iterations='999' tolerance='1e-14' threshold='1e-30'/>"), 20);
  EXPECT_TRUE(agrees(iterative, direct, 1e-9));
  EXPECT_GT(max_abs(direct - after(skewed("<BarycentricMapping/>"), 20)), 0.01);

  // the same in one node: masses and springs add up
  const std::string flat =
      "<BarycentricMapping/><UniformMass vertexMass='4'/><PlaneForceField normal='0 0 -1' d='-1.1' stiffness='400'/>"
      "<RestShapeSpringsForceField stiffness='30'/>";
  EXPECT_TRUE(agrees(after(skewed(flat), 20), direct, 1e-12));
}

TEST(BarycentricMapping, TakesTheTopologyThatItIsGiven) {
  const auto errors = [](const std::string& attributes) {
    return errors_of(in_root(
        "",
        "<MeshTopology position='0 0 0 1 0 0 1 1 0 0 1 0' quads='0-3'/>"
        "<RegularGridTopology name='grid' n='2 2 2'/><MechanicalObject topology='@grid'/><UniformMass totalMass='1'/>"
        "<Node><MechanicalObject position='.5 .5 .5'/><BarycentricMapping " +
            attributes + "/></Node>"));
  };
  EXPECT_EQ(errors("input_topology='@../grid'"), "");
  EXPECT_TRUE(has(errors(""), "BarycentricMapping: 4 nodes in the topology, 8 in the mechanical state"));
  EXPECT_TRUE(has(errors("input_topology='@none'"), "BarycentricMapping.input_topology: link '@none'"));
}

TEST(BarycentricMapping, SaysHowManyPointsLieOutside) {
  scene::Scene scene =
      read_and_init(skewed("<Node name='far'><MechanicalObject name='far' position='.5 .5 5  .5 .5 .5  4 0 0'/>"
                           "<BarycentricMapping input='@/nodes'/></Node><BarycentricMapping/>"));
  const std::string said = warnings_of(scene);
  EXPECT_TRUE(has(said, "BarycentricMapping: 2 of 3 points lie outside the hexahedra, up to "));
  EXPECT_EQ(said.find("Mapping"), said.rfind("Mapping"));
}

TEST(Mapping, CarriesAVisualModelAndNothingElseInAStep) {
  scene::Scene scene = read_and_init(
      "<Node><EulerImplicitSolver/><CGLinearSolver/><RegularGridTopology/><MechanicalObject/><UniformMass "
      "totalMass='1'/>"
      "<Node><OglModel name='visual' position='.5 .5 .5  .6 .5 .5  .5 .6 .5' triangles='0 1 2' color='red' "
      "template='ExtVec3d'/>"
      "<BarycentricMapping input='@..' "
      "output='@visual'/></Node><Node><OglModel/></Node><Node><IdentityMapping/></Node></Node>");
  EXPECT_EQ(scene.diagnostics().take_warnings().size(), 2u);  // no loop, and a mapping to nothing: notes
  const std::vector<scene::VisualModel*> models = scene.root().all<scene::VisualModel>();
  ASSERT_EQ(models.size(), 2u);
  EXPECT_TRUE(models[0]->is_carried());
  EXPECT_EQ(models[0]->points()(1, 0), 0.6);
  EXPECT_EQ(models[0]->triangles(), (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_FALSE(models[1]->is_carried());
  EXPECT_NO_THROW(scene.step());
}

TEST(OglModel, RefusesCellsWithoutTheirPoints) {
  expect_errors(
      in_node, {{"<OglModel position='0 0 0  1 0 0' triangles='0 1 2'/>", "OglModel.triangles: 2 must lie in [0, 2)"}});
}

TEST(VisualStyle, TellsWhatItsLastWordSays) {
  const auto shown = [](const std::string& flags) {
    scene::Scene scene = read_and_init("<Node><VisualStyle displayFlags='" + flags + "'/></Node>");
    const auto* style = scene.root().local<scene::VisualStyle>();
    return std::tuple(style->shows_visual_models(), style->shows_behaviour_models(), style->shows_loads());
  };
  using Answers = std::tuple<std::optional<bool>, std::optional<bool>, bool>;
  EXPECT_EQ(shown("showWireframe showForceFields"), (Answers{{}, {}, true})) << "the first has no effect";
  EXPECT_EQ(shown("showBehaviorModels hideVisualModels"), (Answers{false, true, true}));
  EXPECT_EQ(shown("showForceFields hideAll showVisual"), (Answers{true, false, false}));
}

std::optional<scene::Viewpoint> viewpoint(const std::string& attributes) {
  scene::Scene scene = read_and_init("<Node><InteractiveCamera " + attributes + "/></Node>");
  return scene.root().local<scene::Camera>()->viewpoint();
}

// From its position, which counts where it has a field of view; otherwise distance and detail are fitted.
TEST(InteractiveCamera, LooksFromItsPositionAtItsTarget) {
  const std::string at = "position='1 2 3' lookAt='1 1 5'";
  const std::optional<scene::Viewpoint> fitted = viewpoint(at), seen = viewpoint(at + " fieldOfView='30'");
  ASSERT_TRUE(fitted && seen && seen->eye);
  EXPECT_EQ(fitted->towards, Vec3(0, 1, -2));
  EXPECT_FALSE(fitted->up || fitted->eye);
  EXPECT_EQ(seen->eye->position, Vec3(1, 2, 3));
  EXPECT_EQ(seen->eye->looks_at, Vec3(1, 1, 5));
  EXPECT_EQ(seen->eye->field_of_view, 30);
  for (const auto& [type, is_perspective] : {std::pair("Orthographic", false), {"1", false}, {"0", true}})
    EXPECT_EQ(viewpoint(at + " fieldOfView='30' projectionType='" + type + "'")->eye->is_perspective, is_perspective);
  EXPECT_TRUE(seen->eye->is_perspective);
  EXPECT_FALSE(viewpoint("position='1 2 3' fieldOfView='45'"));
  expect_errors([](const std::string& attributes) { return in_node("<InteractiveCamera " + attributes + "/>"); },
                {{"position='1 2 3' lookAt='1 2 3'", "lookAt: is the camera's own position: must be another point"},
                 {"orientation='0 0 1'", "orientation: must be four numbers, a quaternion x y z w"},
                 {"orientation='0 0 0 0'", "orientation: is 0 0 0 0, the zero quaternion"}},
                "InteractiveCamera.");
}

// A quarter turn about x looks up along y instead of along -z, and has z at its head.
TEST(InteractiveCamera, TurnsByItsOrientation) {
  const std::string quarter = "orientation='0.70710678118654752 0 0 0.70710678118654752'";
  const std::optional<scene::Viewpoint> seen = viewpoint(quarter);
  ASSERT_TRUE(seen && seen->up);
  EXPECT_LT((seen->towards - Vec3(0, -1, 0)).norm(), 1e-15);
  EXPECT_LT((*seen->up - Vec3(0, 0, 1)).norm(), 1e-15);
  EXPECT_FALSE(seen->eye);
  const auto placed = viewpoint(quarter + " position='1 2 3' distance='4' fieldOfView='20'");
  EXPECT_LT((placed->eye->looks_at - Vec3(1, 6, 3)).norm(), 1e-14);
}

TEST(OglModel, TakesThePointsOfTheStateThatItFollows) {
  scene::Scene scene =
      read_and_init(skewed("<IdentityMapping input='@../nodes' output='@copy'/><OglModel name='copy' quads='0 1 2 3'/>"
                           "<BarycentricMapping/>"));
  EXPECT_EQ(at<scene::VisualModel>(scene, "skin/copy").points(), nodes(scene));
}

TEST(Mapping, RefusesWhatDoesNotFit) {
  expect_errors(
      [](const std::string& inner) { return skewed(inner); },
      {{"<IdentityMapping/>", "IdentityMapping: 2 nodes follow 16, must be as many"},
       {"<IdentityMapping input='@.' />", "IdentityMapping.input: is the mapped state itself: must be another one"},
       {"<BarycentricMapping/><FixedProjectiveConstraint/>",
        "FixedProjectiveConstraint: constrains a state that follows another one"},
       {"", "EulerImplicitSolver: no mass on MechanicalObject 'points' of its node and below"}});
}

}  // namespace
