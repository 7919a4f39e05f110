// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <set>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::read_and_init;
using support::rows;

scene::Topology& grid(scene::Scene& scene) { return at<scene::Topology>(scene, "grid"); }

TEST(FlatGrid, HasQuadsInThePlaceOfHexahedra) {
  scene::Scene scene =
      read_and_init("<Node><RegularGridTopology name='grid' nx='3' ny='1' nz='2' min='0 2 0' max='4 6 1'/></Node>");
  // in the middle along y, as in SOFA
  EXPECT_EQ(grid(scene).positions(), rows({{0, 4, 0}, {2, 4, 0}, {4, 4, 0}, {0, 4, 1}, {2, 4, 1}, {4, 4, 1}}));
  EXPECT_TRUE(grid(scene).hexahedra().empty());
  EXPECT_EQ(grid(scene).quads(), (std::vector<Quad>{{0, 1, 4, 3}, {1, 2, 5, 4}}));
  EXPECT_EQ(grid(scene).edges().size(), 7u);
  EXPECT_EQ(at<scene::Component>(scene, "grid").integers("triangles"),
            (std::vector<std::int64_t>{0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4}));
  EXPECT_TRUE(grid(scene).triangles().empty());  // so that a pressure acts once
}

TEST(FlatGrid, OfOneDirectionIsALineThatLiesAtMinAlongZ) {
  scene::Scene scene =
      read_and_init("<Node><RegularGridTopology name='grid' n='1 3 1' min='0 0 -1' max='2 2 1'/></Node>");
  EXPECT_EQ(grid(scene).positions(), rows({{1, 0, -1}, {1, 1, -1}, {1, 2, -1}}));
  EXPECT_TRUE(grid(scene).quads().empty());
  EXPECT_EQ(grid(scene).edges(), (std::vector<Edge>{{0, 1}, {1, 2}}));
}

TEST(FlatGrid, NeedsNoExtentWhereItHasNone) {
  EXPECT_EQ(errors_of("<Node><RegularGridTopology n='2 2 1' min='0 0 0' max='1 1 0'/></Node>"), "");
  EXPECT_EQ(errors_of("<Node><RegularGridTopology n='2 2 2' min='0 0 0' max='1 1 0'/></Node>"),
            "test.scn:1: error: RegularGridTopology.max: must be greater than min in every direction");
  EXPECT_EQ(errors_of("<Node><RegularGridTopology n='2 2 0'/></Node>"),
            "test.scn:1: error: RegularGridTopology.n: 0 must lie in [1, 2147483646]");
}

TEST(Grid, BeginsAtP0WithTheSizeOfItsBox) {
  scene::Scene scene =
      read_and_init("<Node><RegularGridTopology name='grid' n='2 2 2' min='1 1 1' max='2 3 4' p0='-1 0 5'/></Node>");
  EXPECT_EQ(grid(scene).positions().row(0), Eigen::RowVector3d(-1, 0, 5));
  EXPECT_EQ(grid(scene).positions().row(7), Eigen::RowVector3d(0, 2, 8));
}

// Two cells: ten outer faces, each of which lies at one hexahedron alone and is seen from outside.
TEST(TopologicalMapping, QuadsAreTheOuterFacesAndTrianglesTheirHalves) {
  scene::Scene scene = read_and_init(
      "<Node><RegularGridTopology name='grid' n='3 2 2'/>"
      "<Node name='skin'><QuadSetTopologyContainer name='quads'/><Hexa2QuadTopologicalMapping input='@../grid' "
      "output='@quads'/>"
      "<Node name='halves'><TriangleSetTopologyContainer name='triangles'/><Quad2TriangleTopologicalMapping "
      "input='@../quads' output='@triangles'/><OglModel name='seen' position='@triangles.position' "
      "triangles='@triangles.triangles'/></Node></Node></Node>");
  auto& quads = at<scene::Topology>(scene, "skin/quads");
  ASSERT_EQ(quads.quads().size(), 10u);
  const PointArray& x = quads.positions();
  EXPECT_EQ(x, grid(scene).positions());
  const Vec3 middle(.5, .5, .5);
  for (const Quad& quad : quads.quads()) {
    const Vec3 a = x.row(quad[0]), b = x.row(quad[1]), c = x.row(quad[2]);
    EXPECT_GT((b - a).cross(c - a).dot((a + c) / 2 - middle), 0);
  }
  auto& triangles = at<scene::Topology>(scene, "skin/halves/triangles");
  EXPECT_EQ(triangles.triangles().size(), 20u);
  EXPECT_EQ(at<scene::Component>(scene, "skin/halves/seen").integers("triangles").size(), 60u);
}

// Their volumes add up to that of the hexahedra, and none is turned over.
TEST(TopologicalMapping, SixTetrahedraFillAHexahedron) {
  scene::Scene scene = read_and_init(
      "<Node><RegularGridTopology name='grid' n='2 3 2' max='1 2 3'/>"
      "<Node name='inner'><TetrahedronSetTopologyContainer name='tetra'/><Hexa2TetraTopologicalMapping "
      "input='@../grid' output='@tetra'/><Node name='skin'><TriangleSetTopologyContainer "
      "name='skin'/><Tetra2TriangleTopologicalMapping input='@../tetra' output='@skin' flipNormals='true'/>"
      "</Node></Node></Node>");
  auto& tetra = at<scene::Topology>(scene, "inner/tetra");
  ASSERT_EQ(tetra.tetrahedra().size(), 12u);
  double volume = 0;
  for (const auto& [a, b, c, d] : tetra.tetrahedra()) {
    const PointArray& x = tetra.positions();
    const Vec3 ab = x.row(b) - x.row(a), ac = x.row(c) - x.row(a), ad = x.row(d) - x.row(a);
    EXPECT_GT(ab.cross(ac).dot(ad), 0);
    volume += ab.cross(ac).dot(ad) / 6;
  }
  EXPECT_NEAR(volume, 6, 1e-12);
  // two triangles for each of ten outer faces; inwards, as they are flipped
  auto& skin = at<scene::Topology>(scene, "inner/skin/skin");
  ASSERT_EQ(skin.triangles().size(), 20u);
  double enclosed = 0;
  for (const auto& [a, b, c] : skin.triangles()) {
    const Vec3 p = tetra.positions().row(a), q = tetra.positions().row(b), r = tetra.positions().row(c);
    enclosed += p.cross(q).dot(r) / 6;
  }
  EXPECT_NEAR(enclosed, -6, 1e-12);
}

TEST(TopologicalMapping, OfItselfIsRefused) {
  EXPECT_NE(errors_of("<Node><QuadSetTopologyContainer name='a'/><Quad2TriangleTopologicalMapping input='@a' "
                      "output='@a'/></Node>")
                .find("is made of itself by topological mappings"),
            std::string::npos);
  EXPECT_EQ(errors_of("<Node><RegularGridTopology name='grid'/><Hexa2QuadTopologicalMapping input='@grid'/></Node>"),
            "test.scn:1: error: Hexa2QuadTopologicalMapping.output: is not given, must lead to a topology");
}

}  // namespace
