// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/pick.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

// A block of 3 x 2 x 1 cells of 0.5 m, seen along a slanted line that enters through the top and would leave through
// the side: the line is that of two given points, so that the place is known beforehand.
TEST(Pick, MeetsTheFirstOfTheFacesAtTheKnownPlace) {
  const HexMesh mesh = block({3, 2, 1}, 0.5);
  const std::vector<Quad> faces = mesh.boundary_faces();
  const Vec3 enters(1.1, 0.3, 0.5), from(1.5, -0.2, 2);
  const std::optional<Hit> hit = first_hit({from, 7 * (enters - from)}, mesh.positions(), faces);
  ASSERT_TRUE(hit);
  EXPECT_TRUE(agrees(hit->place, enters, 1e-14));
  EXPECT_NEAR(hit->distance, (enters - from).norm(), 1e-14);
  for (const int node : faces[hit->face]) {
    EXPECT_EQ(mesh.positions()(node, 2), 0.5);
    EXPECT_TRUE(mesh.positions()(node, 0) >= 1 && mesh.positions()(node, 1) <= 0.5);
  }
  EXPECT_FALSE(first_hit({from, from - enters}, mesh.positions(), faces)) << "what lies behind is not met";
  EXPECT_FALSE(first_hit({from, Vec3(0, 0, -1)}, mesh.positions(), faces)) << "it passes by the side";

  // from within, the faces are met from behind
  const std::optional<Hit> above = first_hit({Vec3(0.7, 0.6, 0.2), Vec3(0, 0, 1)}, mesh.positions(), faces);
  ASSERT_TRUE(above);
  EXPECT_TRUE(agrees(above->place, Vec3(0.7, 0.6, 0.5), 1e-14));
}

// Against a dense solve for every triangle: o + t d = a + r (b - a) + s (c - a).
TEST(Pick, NothingStandsBeforeWhatIsMet) {
  const HexMesh mesh = distorted_block({3, 3, 3}, 1, 0.25, 17);
  const PointArray& x = mesh.positions();
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c, d] : mesh.boundary_faces()) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  Random random(5);
  int met = 0, missed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Vec3 middle(1.5, 1.5, 1.5), origin = middle + 6 * random.vector(1).normalized();
    const Vec3 direction = middle + random.vector(2.2) - origin;
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : triangles) {
      Mat3 A;
      A << (x.row(b) - x.row(a)).transpose(), (x.row(c) - x.row(a)).transpose(), -direction.normalized();
      const Vec3 found = A.fullPivLu().solve(origin - x.row(a).transpose());
      if (found[0] >= 0 && found[1] >= 0 && found[0] + found[1] <= 1 && found[2] >= 0)
        nearest = std::min(nearest, found[2]);
    }
    const std::optional<Hit> hit = first_hit({origin, direction}, x, triangles);
    ASSERT_EQ(hit.has_value(), nearest < 1e9) << trial;
    ++(hit ? met : missed);
    if (!hit) continue;
    EXPECT_NEAR(hit->distance, nearest, 1e-11);
    EXPECT_TRUE(agrees(hit->place, Vec3(origin + nearest * direction.normalized()), 1e-11));
    const auto& [a, b, c] = triangles[hit->face];
    const Vec3 normal = Vec3((x.row(b) - x.row(a)).transpose()).cross(Vec3((x.row(c) - x.row(a)).transpose()));
    EXPECT_NEAR(normal.normalized().dot(hit->place - x.row(a).transpose()), 0, 1e-11);
  }
  EXPECT_GT(met, 20);
  EXPECT_GT(missed, 5);
}

// A quad is two triangles: across its first diagonal it bends.
TEST(Pick, AWarpedQuadBendsAtItsFirstDiagonal) {
  PointArray x(4, 3);
  x << 0, 0, 0, 1, 0, 1, 1, 1, 0, 0, 1, 1;
  const std::vector<Quad> quads{{0, 1, 2, 3}};
  const auto height = [&](double px, double py) {
    return first_hit({Vec3(px, py, 5), Vec3(0, 0, -1)}, x, quads)->place.z();
  };
  EXPECT_NEAR(height(0.5, 0.5), 0, 1e-15);
  EXPECT_NEAR(height(0.75, 0.25), 0.5, 1e-15);
  EXPECT_NEAR(height(0.25, 0.75), 0.5, 1e-15);
}

TEST(Pick, TakesWhatIsNearAndAtLeastSoMany) {
  const HexMesh mesh = block({4, 1, 1}, 1);
  std::vector<int> lower;  // the five nodes of an edge, from the far end
  for (int i = 4; i >= 0; --i) lower.push_back(i);
  const auto nodes = [&](double radius, int min) {
    return nearest_nodes(mesh.positions(), lower, Vec3(2.2, 0, 0), radius, min);
  };
  EXPECT_EQ(nodes(1.25, 1), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(nodes(1.15, 1), (std::vector<int>{2, 3}));
  EXPECT_EQ(nodes(0.1, 1), (std::vector<int>{2}));
  EXPECT_EQ(nodes(0.1, 2), (std::vector<int>{2, 3}));
  EXPECT_EQ(nodes(0.1, 9), (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(nodes(0.1, 0).empty());
}

}  // namespace
}  // namespace hexaplast
