// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

using Numbers = std::vector<std::int64_t>;

TEST(BoxROI, CountsItsBorderAsInsideAndSwapsItsCorners) {
  scene::Scene scene =
      read_and_init(four_nodes("<BoxROI name='exact' box='1 0 0 1 0 0'/><BoxROI name='swapped' box='1 2 0  -1 -1 0'/>"
                               "<BoxROI name='two' box='0 0 3 0 0 3  -2 -2 4 0 0 5'/>"));
  EXPECT_EQ(at<scene::Engine>(scene, "exact").integers("indices"), (Numbers{0}));
  EXPECT_EQ(at<scene::Engine>(scene, "swapped").integers("indices"), (Numbers{0, 1}));
  EXPECT_EQ(at<scene::Engine>(scene, "swapped").integers("indicesOut"), (Numbers{2, 3}));
  EXPECT_EQ(at<scene::Engine>(scene, "two").integers("indices"), (Numbers{2, 3}));
  EXPECT_EQ(at<scene::Engine>(scene, "two").reals("pointsInROI"), (std::vector<double>{0, 0, 3, -1, -1, 4}));
}

TEST(BoxROI, TakesHexahedraByAllNodesOrByCentre) {
  scene::Scene scene = read_and_init(
      in_root("",
              "<RegularGridTopology n='4 2 2' max='3 1 1'/><MechanicalObject/><UniformMass totalMass='1'/>"
              "<BoxROI name='strict' box='0 0 0 2.6 1 1'/>"
              "<BoxROI name='centre' box='0 0 0 2.6 1 1' strict='false'/>"));
  EXPECT_EQ(at<scene::Engine>(scene, "strict").integers("hexahedronIndices"), (Numbers{0, 1}));
  EXPECT_EQ(at<scene::Engine>(scene, "centre").integers("hexahedronIndices"), (Numbers{0, 1, 2}));
}

TEST(BoxROI, WarnsWhenItHoldsNothing) {
  scene::Scene scene = read_and_init(four_nodes("<BoxROI box='8 8 8 9 9 9'/>"));
  EXPECT_EQ(warnings_of(scene), "test.scn:1: warning: BoxROI: holds no point\n");
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
}

TEST(SphereROI, CountsItsSurfaceAsInside) {
  scene::Scene scene =
      read_and_init(four_nodes("<SphereROI name='one' centers='0 0 0' radii='2'/>"
                               "<SphereROI name='two' centers='0 0 4  1 0 1' radii='1 1.5'/>"
                               "<SphereROI name='same' centers='0 0 3  1 0 0' radii='0.1'/>"));
  EXPECT_EQ(at<scene::Engine>(scene, "one").integers("indices"), (Numbers{0, 1}));
  EXPECT_EQ(at<scene::Engine>(scene, "two").integers("indices"), (Numbers{0, 2}));
  EXPECT_EQ(at<scene::Engine>(scene, "same").integers("indices"), (Numbers{0, 2}));
}

TEST(PlaneROI, TakesWhatLiesInAThickRectangle) {
  scene::Scene scene = read_and_init(
      in_root("",
              "<RegularGridTopology n='4 2 2' max='3 1 1'/><MechanicalObject/><UniformMass totalMass='1'/>"
              "<PlaneROI name='thin' plane='1 0 0  1 1 0  1 1 1  0.1'/>"
              "<PlaneROI name='thick' plane='1 0 0  1 1 0  1 1 1  2  3 0 0  3 1 0  3 1 1  0.1'/>"));
  EXPECT_EQ(at<scene::Engine>(scene, "thin").integers("indices"), (Numbers{1, 5, 9, 13}));
  EXPECT_EQ(at<scene::Engine>(scene, "thin").integers("hexahedronIndices"), (Numbers{}));
  EXPECT_EQ(at<scene::Engine>(scene, "thick").integers("hexahedronIndices"), (Numbers{0, 1, 2}));
}

// The tetrahedron x, y, z >= 0, x + y + z <= 3.
TEST(MeshROI, TakesWhatAClosedSurfaceEncloses) {
  const std::string points = "ROIposition='0 0 0  3 0 0  0 3 0  0 0 3  3 0 0'", closed = "ROItriangles='0 2 1 0 1 3 ";
  const auto roi = [&](const std::string& rest) { return "<MeshROI name='roi' " + points + " " + rest + "/>"; };
  const auto scene_of = [&](const std::string& rest) {
    return in_root("",
                   "<RegularGridTopology n='4 4 4' max='3 3 3'/><MechanicalObject name='nodes'/><UniformMass "
                   "totalMass='1'/>" +
                       roi(rest));
  };
  const auto inside = [&](const std::string& rest) {
    scene::Scene scene = read_and_init(scene_of(rest));
    return Numbers(at<scene::Engine>(scene, "roi").integers("hexahedronIndices"));
  };
  Numbers expected;  // cells whose centre has a sum of coordinates below 3
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        if (i + j + k + 1.5 < 3) expected.push_back(i + 3 * (j + 3 * k));
  EXPECT_EQ(inside(closed + "1 2 3 0 3 2'"), expected);
  EXPECT_EQ(inside(closed + "4 2 3 0 3 2'"), expected) << "by two points at one place";
  EXPECT_EQ(inside("ROItriangles='0 1 2 0 3 1 1 3 2 0 2 3'"), expected) << "inside out";
  EXPECT_EQ(inside(closed + "1 2 3 0 3 2' computeMeshROI='false'").size(), 27u);
  scene::Scene scene = read_and_init(scene_of(closed + "1 2 3 0 3 2'"));
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
       {"<BoxROI box='-1 -1 -1 1 2 2' quads='0 1 2 12'/>", "BoxROI.quads: 12 must lie in [0, 4)"},
       {"<SphereROI centers='0 0 0' radii='1 2'/>",
        "SphereROI.radii: 2 radii given for 1 centers, must be one or as many"},
       {"<PlaneROI plane='1 2 3'/>", "PlaneROI.plane: 3 numbers given, must be groups of 10"},
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
  const auto numbers = [&](const char* name, const char* output) {
    return at<scene::Engine>(scene, name).integers(output);
  };
  EXPECT_EQ(numbers("first", "indices"), (Numbers{1, 0}));
  EXPECT_EQ(numbers("first", "otherIndices"), (Numbers{2, 3, 4}));
  EXPECT_EQ(numbers("all", "indices"), (Numbers{0, 1, 2, 4}));
  EXPECT_EQ(numbers("all", "otherIndices"), (Numbers{3}));
  EXPECT_TRUE(numbers("missing", "indices").empty());
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

}  // namespace
