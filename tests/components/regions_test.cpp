// SPDX-License-Identifier: LGPL-2.1-or-later
// Selections of points and cells, and regions of a body: the values that its hexahedra get, and what is refused.
#include <fmt/format.h>

#include "hexaplast/body.hpp"
#include "scene/region.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

using Numbers = std::vector<std::int64_t>;

/// What an output of a selection holds.
void expect_selected(scene::Scene& scene,
                     std::initializer_list<std::tuple<const char*, const char*, Numbers>> selections) {
  for (const auto& [name, output, expected] : selections)
    EXPECT_EQ(at<scene::Engine>(scene, name).integers(output), expected) << name << "." << output;
}

/// A row of cells of 1 m along x, without loads.
std::string row_of_cells(int count, const std::string& selections) {
  return in_root("", "<RegularGridTopology n='" + std::to_string(count + 1) + " 2 2' max='" + std::to_string(count) +
                         " 1 1'/><MechanicalObject name='nodes'/><UniformMass totalMass='1'/>" + selections);
}

TEST(Selections, OfPoints) {
  scene::Scene scene =
      read_and_init(four_nodes("<BoxROI name='exact' box='1 0 0 1 0 0'/><BoxROI name='swapped' box='1 2 0  -1 -1 0'/>"
                               "<BoxROI name='two' box='0 0 3 0 0 3  -2 -2 4 0 0 5'/>"
                               "<SphereROI name='ball' centers='0 0 0' radii='2'/>"
                               "<SphereROI name='balls' centers='0 0 4  1 0 1' radii='1 1.5'/>"
                               "<SphereROI name='alike' centers='0 0 3  1 0 0' radii='0.1'/>"));
  expect_selected(scene, {{"exact", "indices", {0}},
                          {"swapped", "indices", {0, 1}},
                          {"swapped", "indicesOut", {2, 3}},
                          {"two", "indices", {2, 3}},
                          {"ball", "indices", {0, 1}},
                          {"balls", "indices", {0, 2}},
                          {"alike", "indices", {0, 2}}});
  scene::Scene empty = read_and_init(four_nodes("<BoxROI box='8 8 8 9 9 9'/>"));
  EXPECT_EQ(warnings_of(empty), "test.scn:1: warning: BoxROI: holds no point\n");
}

TEST(Selections, OfCellsByAllNodesOrByCentre) {
  scene::Scene scene =
      read_and_init(row_of_cells(3,
                                 "<BoxROI name='strict' box='0 0 0 2.6 1 1'/>"
                                 "<BoxROI name='centre' box='0 0 0 2.6 1 1' strict='false'/>"
                                 "<PlaneROI name='thin' plane='1 0 0  1 1 0  1 1 1  0.1'/><BoxROI name='thick' "
                                 "orientedBox='1 0 0  1 1 0  1 1 1  2  3 0 0  3 1 0  3 1 1  0.1'/>"));
  expect_selected(
      scene,
      {{"strict", "hexahedronIndices", {0, 1}},
       {"centre", "hexahedronIndices", {0, 1, 2}},
       {"centre", "hexahedraInROI", {0, 1, 5, 4, 8, 9, 13, 12, 1, 2, 6, 5, 9, 10, 14, 13, 2, 3, 7, 6, 10, 11, 15, 14}},
       {"thin", "indices", {1, 5, 9, 13}},
       {"thin", "hexahedronIndices", {}},
       {"thick", "hexahedronIndices", {0, 1, 2}}});
}

// The tetrahedron x, y, z >= 0, x + y + z <= 3.
TEST(MeshROI, TakesWhatAClosedSurfaceEncloses) {
  const auto scene_of = [&](const std::string& rest) {
    return read_and_init(in_root("",
                                 "<RegularGridTopology n='4 4 4' max='3 3 3'/><MechanicalObject name='nodes'/>"
                                 "<UniformMass totalMass='1'/><MeshROI name='roi' ROIposition='0 0 0  3 0 0  0 3 0"
                                 "  0 0 3  3 0 0' ROItriangles='" +
                                     rest + "/>"));
  };
  const auto inside = [&](const std::string& rest) {
    scene::Scene scene = scene_of(rest);
    return Numbers(at<scene::Engine>(scene, "roi").integers("hexahedronIndices"));
  };
  const Numbers expected{0, 1, 3, 9};  // cells whose centre has a sum of coordinates below 3
  const std::string closed = "0 2 1 0 1 3 ";
  EXPECT_EQ(inside(closed + "1 2 3 0 3 2'"), expected);
  EXPECT_EQ(inside(closed + "4 2 3 0 3 2'"), expected) << "by two points at one place";
  EXPECT_EQ(inside("0 1 2 0 3 1 1 3 2 0 2 3'"), expected) << "inside out";
  scene::Scene scene = scene_of(closed + "1 2 3 0 3 2'");
  EXPECT_EQ(at<scene::Engine>(scene, "roi").reals("box"), (std::vector<double>{0, 0, 0, 3, 3, 3}));
}

TEST(Selections, RefuseWhatCannotBe) {
  const std::string points = "<MeshROI ROIposition='0 0 0  3 0 0  0 3 0  0 0 3  3 0 0' ROItriangles='",
                    rule =
                        "MeshROI.ROItriangles: the surface is open or not oriented at the edge from point 0 to point "
                        "2: each edge must "
                        "occur as often in one direction as in the other";
  expect_errors(
      four_nodes,
      {{"<BoxROI orientedBox='1 2 3'/>", "BoxROI.orientedBox: 3 numbers given, must be groups of 10"},
       {"<BoxROI orientedBox='0 0 0  1 0 0  2 0 0  1'/>",
        "BoxROI.orientedBox: the corners of box 0 are not those of a rectangle"},
       {"<PlaneROI plane='0 0 0  1 0 0  1 1 0  1  0 0 0  1 0 0  2 1 0  1'/>",
        "PlaneROI.plane: the corners of box 1 are not those of a rectangle"},
       {"<PlaneROI plane='0 0 0  1 0 0  1 1 0  0'/>", "PlaneROI.plane: the thickness of box 0 is 0, must be > 0"},
       {"<BoxROI box='-1 -1 -1 1 2 2' hexahedra='0 1 2 12 0 1 2 3'/>", "BoxROI.hexahedra: 12 must lie in [0, 4)"},
       {"<SphereROI centers='0 0 0' radii='1 2'/>",
        "SphereROI.radii: 2 radii given for 1 centers, must be one or as many"},
       {"<IndexValueMapper indices='10000000'/>", "IndexValueMapper.indices: 10000000 must lie in [0, 9999999]"},
       {points + "0 2 1 0 1 3 1 2 3'/>", rule},
       {points + "0 2 1 0 1 3 1 2 3 0 2 3'/>", rule},
       {points + "'/>", "MeshROI.ROItriangles: has no triangle, must have those of a closed surface"},
       {points + "0 1'/>", "MeshROI.ROItriangles: 2 numbers given, must be groups of 3"},
       {points + "0 1 5'/>", "MeshROI.ROItriangles: 5 must lie in [0, 5)"}});
}

TEST(IndicesFromValues, FindsPlacesOfValues) {
  scene::Scene scene =
      read_and_init(four_nodes("<IndicesFromValues name='first' global='7 5 7 3 5' values='5 7'/>"
                               "<IndicesFromValues name='all' global='7 5 7 3 5' values='5 7' recursiveSearch='true'/>"
                               "<IndicesFromValues name='missing' global='7 5' values='6'/>"));
  expect_selected(scene, {{"first", "indices", {1, 0}}, {"all", "indices", {0, 1, 2, 4}}, {"missing", "indices", {}}});
  EXPECT_EQ(warnings_of(scene), "test.scn:1: warning: IndicesFromValues.values: 6 is not among the values of global\n");
}

// As in SOFA: the list grows as far as the indices reach.
TEST(IndexValueMapper, PutsAValueAtIndices) {
  scene::Scene scene = read_and_init(
      four_nodes("<IndexValueMapper name='given' inputValues='5 6 7' indices='2 0' value='-1'/>"
                 "<IndexValueMapper name='grown' inputValues='5' indices='3 1' value='9' defaultValue='0.5'/>"
                 "<IndexValueMapper name='chain' inputValues='@grown.outputValues' indices='0 5' value='2'/>"
                 "<IndexValueMapper name='none'/>"));
  const auto values = [&](const char* name) { return at<scene::Engine>(scene, name).reals("outputValues"); };
  using Values = std::vector<double>;
  EXPECT_EQ(values("given"), (Values{-1, 6, -1}));
  EXPECT_EQ(values("grown"), (Values{5, 9, 0.5, 9}));
  EXPECT_EQ(values("chain"), (Values{2, 9, 0.5, 9, 1, 2}));
  EXPECT_EQ(values("none"), Values{});
  at<scene::Engine>(scene, "grown").find_data("value")->set(8.0, {});
  EXPECT_EQ(values("chain"), (Values{2, 8, 0.5, 8, 1, 2}));
}

/// A row of four hexahedra along x, of 1 m each.
std::string row_of_four(const std::string& body, const std::string& behind = "", const std::string& before = "") {
  return in_root("gravity='0 0 0' dt='0.02'",
                 "<RegularGridTopology name='grid' n='5 2 2' max='4 1 1'/><MechanicalObject name='nodes'/>"
                 "<DiagonalMass massDensity='1000'/>" +
                     before + "<HexahedronElastoplasticFEMForceField name='body' " + body + "/>" + behind +
                     "<FixedProjectiveConstraint indices='0 5 10 15'/>");
}

std::vector<double> moduli(scene::Scene& scene) {
  std::vector<double> values;
  for (int e = 0; e < body(scene).mesh().num_elements(); ++e) values.push_back(body(scene).material(e).young_modulus);
  return values;
}
std::vector<double> moduli_of(const std::string& text) {
  scene::Scene scene = read_and_init(text);
  return moduli(scene);
}
using Values = std::vector<double>;

const std::string kBox = "<BoxROI name='roi' box='0.9 -1 -1  3.1 2 2'/>";

TEST(MaterialRegion, TakesTheHexahedraOfAnROIWhereverItStands) {
  const Values expected = {5000, 300, 300, 5000};
  const std::string by_nodes = "<MaterialRegion hexahedra='@roi.hexahedraInROI' youngModulus='300'/>";
  const std::string by_numbers = "<MaterialRegion indices='@roi.hexahedronIndices' youngModulus='300'/>";
  const std::string in_any_order =
      "<MaterialRegion hexahedra='2 3 8 7 12 13 18 17  16 6 1 11 17 7 12 2' youngModulus='300'/>";
  for (const auto& [behind, before] : std::vector<std::pair<std::string, std::string>>{
           {kBox + by_nodes, ""},
           {by_nodes + kBox, ""},
           {kBox, by_nodes},
           {by_numbers, kBox},
           {"", by_numbers + kBox},
           {"<Node name='below'>" + by_nodes + "</Node>", kBox},  // the nearest body above
           {in_any_order, ""}})
    EXPECT_EQ(moduli_of(row_of_four("", behind, before)), expected) << behind << before;

  const std::string bar =
      replaced(replaced(row_of_four(""), "<DefaultAnimationLoop/>", ""), "<Node", "<Node name='bar'");
  scene::Scene scene = read_and_init("<Node><DefaultAnimationLoop/>" + bar +
                                     "<MaterialRegion body='@bar/body' indices='2' youngModulus='9'/></Node>");
  EXPECT_EQ(body(scene, "bar/body").material(2).young_modulus, 9) << "by its link";
}

TEST(MaterialRegion, LaterOnesCountMoreThanEarlierOnes) {
  const std::string first = "<MaterialRegion indices='0 1 2' youngModulus='100 200 300' hardening='0.5'/>";
  const std::string second = "<MaterialRegion indices='2 1' youngModulus='7000 8000'/>";
  const std::string each = "youngModulus='1 2 3 4'";
  EXPECT_EQ(moduli_of(row_of_four(each, first + second)), (Values{100, 8000, 7000, 4}));
  EXPECT_EQ(moduli_of(row_of_four(each, first, second)), (Values{100, 200, 300, 4}));
  scene::Scene scene = read_and_init(row_of_four("hardening='0.1'", first + second));
  EXPECT_EQ(body(scene).material(1).hardening, 0.5);
  EXPECT_EQ(body(scene).material(3).hardening, 0.1);
}

// Hexahedra that the surface passes through are half full.
TEST(MaterialRegion, IsScaledWhereHexahedraArePartlyFilled) {
  const auto scene_of = [](const std::string& body, const std::string& more) {
    return in_root("", "<SparseGridTopology name='grid' fileTopology='" HEXAPLAST_TEST_DATA
                       "/meshes/organ.obj' n='4 4 6'/><MechanicalObject name='nodes'/><DiagonalMass/>"
                       "<HexahedronElastoplasticFEMForceField name='body' youngModulus='" +
                           body + "'/>" + more);
  };
  const Values full = moduli_of(scene_of("3000", ""));
  ASSERT_NE(std::ranges::min(full), std::ranges::max(full));
  EXPECT_EQ(
      moduli_of(scene_of("1", fmt::format("<MaterialRegion indices='0-{}' youngModulus='3000'/>", full.size() - 1))),
      full);
  scene::Scene scene = read_and_init(scene_of("3000' yieldStress='100' fractureStress='120", ""));
  for (int e = 0; e < body(scene).mesh().num_elements(); ++e) {
    EXPECT_EQ(body(scene).material(e).yield_stress, full[e] / 30);
    EXPECT_EQ(body(scene).material(e).fracture_stress, full[e] / 25);
  }
}

TEST(MaterialRegion, MayChangeDuringARunAndWhatFlowedStays) {
  scene::Scene scene =
      read_and_init(row_of_four("youngModulus='1000' yieldStress='5' plasticFlowRate='5'", kBox,
                                "<MaterialRegion name='region' hexahedra='@roi.hexahedraInROI' youngModulus='2000'/>"));
  auto& field = at<scene::ForceField>(scene, "body");
  auto& region = at<scene::MaterialRegion>(scene, "region");
  at<scene::MechanicalState>(scene, "nodes").positions().col(0) *= 1.3;
  scene.step();
  const double strain = field.reals("plasticStrain")[1];
  EXPECT_GT(strain, 0);
  region.find_data("youngModulus")->set(Values{3000, 4000}, {});
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{1000, 3000, 4000, 1000}));
  EXPECT_GE(field.reals("plasticStrain")[1], strain);
  at<scene::Engine>(scene, "roi").find_data("box")->set(Values{-1, -1, -1, 2.1, 2, 2}, {});
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{3000, 4000, 1000, 1000})) << "the ROI may change too";
  field.find_data("youngModulus")->set(Values{800}, {});
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{3000, 4000, 800, 800})) << "regions stay over their body";
  scene.reset();
  EXPECT_EQ(moduli(scene), (Values{3000, 4000, 800, 800}));
  region.find_data("youngModulus")->unset();
  scene.step();
  EXPECT_EQ(moduli(scene), (Values{800, 800, 800, 800}));
  region.find_data("youngModulus")->set(Values{1, 2, 3}, {});
  EXPECT_THROW(scene.step(), scene::SceneError);
}

TEST(MaterialRegion, RefusesWhatCannotBe) {
  const std::string none = "has no hexahedron, must have at least one of the body", first = "0 1 6 5 10 11 16 15",
                    region = "MaterialRegion.";
  expect_errors(
      [](const std::string& attributes) {
        return row_of_four("", "<BoxROI name='roi' box='0 0 0 0.5 1 1'/><MaterialRegion " + attributes + "/>");
      },
      {{"youngModulus='1'", region + "hexahedra: is not given, nor is indices: one of the two is needed"},
       {"hexahedra='" + first + "' indices='0'",
        region + "indices: is given besides hexahedra: must be one of the two"},
       {"indices=''", region + "indices: " + none},
       {"hexahedra='@roi.hexahedraInROI'", region + "hexahedra: " + none},
       {"indices='0 4'", region + "indices: 4 must lie in [0, 4)"},
       {"indices='0 1 0'", region + "indices: hexahedron 0 is given twice, must be given once"},
       {"hexahedra='" + first + " " + first + "'",
        region + "hexahedra: hexahedron 0 is given twice, must be given once"},
       {"hexahedra='0 1 2'", region + "hexahedra: 3 numbers given, must be groups of 8"},
       {"hexahedra='0 1 6 5 10 11 16 14'",
        region + "hexahedra: 0 1 6 5 10 11 16 14 are the nodes of no hexahedron of the body, must be of one"},
       {"indices='0 1' youngModulus='1 2 3'",
        region + "youngModulus: 3 values given, must be one or 2 (one per hexahedron of the region)"},
       {"indices='0 1' hardening='1 2'", region + "hardening: 2 values given, must be one"},
       {"indices='0 1' plasticFlowRate='51'",
        region + "plasticFlowRate: 51 times dt = 0.02 s is 1.02: must be at most 1"},
       {"indices='0' body='@grid'",
        region + "body: the link leads to RegularGridTopology 'grid', must lead to a body of hexahedra"}});
  expect_errors(four_nodes, {{"<MaterialRegion indices='0'/>",
                              "MaterialRegion: needs a body of hexahedra in its node or above, or a link to one"}});
}

TEST(MaterialRegion, AllThatIsWrongIsSaidOnce) {
  const std::string two = "<MaterialRegion indices='9'/>\n<MaterialRegion indices='0' youngModulus='1 2'/>";
  const std::string expected =
      "test.scn:1: error: MaterialRegion.indices: 9 must lie in [0, 4)\n"
      "test.scn:2: error: MaterialRegion.youngModulus: 2 values given, must be one or 1 (one per hexahedron of the "
      "region)";
  EXPECT_EQ(errors_of(row_of_four("", two)), expected);
  EXPECT_EQ(errors_of(row_of_four("", "", two)), expected);
}

TEST(MaterialRegion, WarnsWhereItGivesNothing) {
  scene::Scene scene = read_and_init(row_of_four("", "<MaterialRegion indices='1'/>"));
  EXPECT_TRUE(warnings_of(scene).ends_with(
      "test.scn:1: warning: MaterialRegion: gives its hexahedra no value: it has no effect\n"));
}

}  // namespace
