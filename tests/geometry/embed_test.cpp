// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/embed.hpp"

#include "hexaplast/mesh/faces.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

const HexMesh kMesh = distorted_block({3, 2, 4}, 0.5, 0.15, 41);  // no two edges parallel

PointArray points_inside(int count) {
  Random random(43);
  PointArray points(count, 3);
  for (int n = 0; n < count; ++n)
    points.row(n) << random.uniform(0.2, 1.3), random.uniform(0.2, 0.8), random.uniform(0.2, 1.8);
  return points;
}

// In hexahedra that are just not inside out too: corners moved by up to a third of an edge.
TEST(Embedding, FindsPlacesInTheWorstSoundHexahedra) {
  Random random(61);
  int num_sound = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const ElementPoints corners = distorted_hexahedron(1, 0.3, 1000 + trial);
    bool is_sound = true;
    for (int a = 0; a < kCorners; ++a) is_sound = is_sound && corner_jacobian(corners, a).determinant() > 0.005;
    if (!is_sound) continue;
    ++num_sound;
    PointArray points(40, 3);
    std::vector<Vec3> places;
    for (int n = 0; n < 40; ++n) {
      places.push_back(random.vector(1));
      Vec3 p = Vec3::Zero();
      for (int a = 0; a < kCorners; ++a) {
        double N = 1;
        for (int d = 0; d < 3; ++d) N *= (1 + kCornerSign[a][d] * places[n][d]) / 2;
        p += N * corners.row(a).transpose();
      }
      points.row(n) = p.transpose();
    }
    const HexMesh mesh = single_element(corners);
    const Embedding embedding(mesh.positions(), mesh.hexahedra(), points);
    ASSERT_EQ(embedding.num_outside(), 0) << trial;
    PointArray found(40, 3);
    embedding.apply(PointArray(cube(2)), found);
    for (int n = 0; n < 40; ++n) ASSERT_LE(max_abs(Vec3(found.row(n).transpose()) - places[n]), 1e-9) << trial;
  }
  EXPECT_GT(num_sound, 100);
}

// The distance of points outside against the nearest of many samples of the surface.
TEST(Embedding, ContinuesFromTheNearestPlace) {
  constexpr int kSamples = 40;
  std::vector<Vec3> samples;
  for (const Quad& face : kMesh.boundary_faces())
    for (int i = 0; i <= kSamples; ++i)
      for (int j = 0; j <= kSamples; ++j) {
        const double u = double(i) / kSamples, v = double(j) / kSamples;
        const auto corner = [&](int k) -> Vec3 { return kMesh.positions().row(face[k]).transpose(); };
        samples.push_back((1 - v) * ((1 - u) * corner(0) + u * corner(1)) + v * ((1 - u) * corner(3) + u * corner(2)));
      }
  Random random(63);
  for (int trial = 0; trial < 60; ++trial) {
    const Vec3 p = Vec3(0.75, 0.5, 1) + 2 * random.direction();
    const Embedding embedding(kMesh.positions(), kMesh.hexahedra(), PointArray(p.transpose()));
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& sample : samples) nearest = std::min(nearest, (sample - p).norm());
    EXPECT_LE(embedding.greatest_distance(), nearest + 1e-12) << trial;
    EXPECT_GE(embedding.greatest_distance(), nearest - 2e-4) << trial;  // samples are 0.013 apart, and 0.5 away
  }
}

// Nodes, centres of faces and edges belong to several hexahedra: any of them will do.
TEST(Embedding, PlacesOnBordersCountAsInside) {
  const Embedding nodes(kMesh.positions(), kMesh.hexahedra(), kMesh.positions());
  EXPECT_EQ(nodes.num_outside(), 0);
  Random random(51);
  const PointArray field = random.field(kMesh.num_nodes(), 1);
  PointArray found(kMesh.num_nodes(), 3);
  nodes.apply(field, found);
  EXPECT_LE(max_abs(found - field), 1e-9);
}

// Outside they go on to first order: exactly for affine motions, however far.
TEST(Embedding, ContinuesFromTheNearestHexahedron) {
  Random random(53);
  PointArray points = random.field(200, 5);
  const Embedding embedding(kMesh.positions(), kMesh.hexahedra(), points);
  EXPECT_GT(embedding.num_outside(), 150);
  EXPECT_GT(embedding.greatest_distance(), 2);
  PointArray found(200, 3);
  embedding.apply(kMesh.positions(), found);
  EXPECT_LE(max_abs(found - points), 1e-12);

  const Mat3 A = Mat3::Identity() + random.matrix(0.3);
  const Vec3 b(1, 2, 3);
  embedding.apply(mapped(kMesh.positions(), A, b), found);
  EXPECT_LE(max_abs(found - mapped(points, A, b)), 1e-11);

  // the nearest hexahedron carries a point just above the far end, and no other
  const PointArray above = (PointArray(1, 3) << 0.25, 0.25, 2.3).finished();
  PointArray weights = PointArray::Zero(kMesh.num_nodes(), 3);
  Embedding(kMesh.positions(), kMesh.hexahedra(), above).add_transposed(PointArray::Ones(1, 3), weights);
  for (int n = 0; n < kMesh.num_nodes(); ++n) {
    const bool is_far = kMesh.positions()(n, 2) < 1.2 || kMesh.positions()(n, 0) > 0.7;
    if (is_far) {
      EXPECT_EQ(weights(n, 0), 0) << n;
    }
  }
}

TEST(Embedding, TransposedKeepsForceAndMoment) {
  Random random(57);
  PointArray points = points_inside(60);
  points.bottomRows(10).array() += 3;  // some outside
  const Embedding embedding(kMesh.positions(), kMesh.hexahedra(), points);
  const PointArray x = kMesh.positions() + random.field(kMesh.num_nodes(), 0.4), f = random.field(60, 1);
  PointArray p(60, 3), nodal = PointArray::Zero(kMesh.num_nodes(), 3);
  embedding.apply(x, p);
  embedding.add_transposed(f, nodal);
  EXPECT_LE(max_abs(nodal.colwise().sum() - f.colwise().sum()), 1e-12);

  // virtual work: what the points' forces do on any movement of the nodes
  const PointArray dx = random.field(kMesh.num_nodes(), 1);
  PointArray dp(60, 3);
  embedding.apply(dx, dp);
  EXPECT_NEAR(nodal.cwiseProduct(dx).sum(), f.cwiseProduct(dp).sum(), 1e-12);

  EXPECT_LE(max_abs(moment(x, nodal) - moment(p, f)), 1e-11);
}

// J^T B J by blocks against the product J^T (B (J dx)).
TEST(Embedding, BlocksAgreeWithTheProduct) {
  Random random(59);
  const Embedding embedding(kMesh.positions(), kMesh.hexahedra(), points_inside(7));
  BlockMatrix B(7), A(kMesh.num_nodes());
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; j += 2) B.add(i, j, random.matrix(1));
  embedding.add_transposed_blocks(B, A);
  EXPECT_FALSE(A.leaves_out());

  const PointArray dx = random.field(kMesh.num_nodes(), 1);
  PointArray dp(7, 3), expected = PointArray::Zero(kMesh.num_nodes(), 3);
  embedding.apply(dx, dp);
  embedding.add_transposed(unstacked(dense(B) * stacked(dp)), expected);
  const PointArray product = unstacked(dense(A) * stacked(dx));
  EXPECT_TRUE(agrees(product, expected, 1e-13));
  B.leave_out();
  embedding.add_transposed_blocks(B, A);
  EXPECT_TRUE(A.leaves_out());
}

// Small triangles about points: left as long as the hexahedron is that each lies in.
TEST(Embedding, CellsGoWithTheirHexahedra) {
  constexpr int kTriangles = 300;
  Random random(71);
  PointArray points(3 * kTriangles, 3);
  const PointArray centres = points_inside(kTriangles);
  for (int n = 0; n < 3 * kTriangles; ++n) points.row(n) = centres.row(n / 3) + 1e-3 * random.field(1, 1);
  const Embedding embedding(kMesh.positions(), kMesh.hexahedra(), points);
  std::vector<unsigned char> alive(kMesh.num_elements(), 1);
  const auto nodes = [&](std::span<const int> corners) { return hold_together(kMesh, alive, corners); };

  int num_gone = 0;
  for (int e = 0; e < kMesh.num_elements(); e += 3) alive[e] = 0;
  for (int t = 0; t < kTriangles; ++t) {
    const std::array<int, 3> triangle{3 * t, 3 * t + 1, 3 * t + 2};
    const bool expected = std::ranges::all_of(triangle, [&](int n) { return alive[embedding.hexahedron_of(n)] != 0; });
    ASSERT_EQ(embedding.is_left(triangle, nodes), expected) << t;
    num_gone += !expected;
  }
  EXPECT_GT(num_gone, 50);
  EXPECT_LT(num_gone, 250);
}

// A surface whose points are the nodes: a face of the surface is left as long as its hexahedron is, and what was inside
// and is bare now is left as well.
TEST(Embedding, CellsOnNodesGoWithTheHexahedraThatHaveThem) {
  const Embedding embedding(kMesh.positions(), kMesh.hexahedra(), kMesh.positions());
  std::vector<unsigned char> alive(kMesh.num_elements(), 1);
  const auto nodes = [&](std::span<const int> corners) { return hold_together(kMesh, alive, corners); };
  alive[7] = 0;
  for (const int e : {0, 1, 7, 8, 13})
    for (const auto& face : kFaces) {
      std::array<int, 4> quad{};
      for (int k = 0; k < 4; ++k) quad[k] = kMesh.hexahedra()[e][face[k]];
      EXPECT_EQ(embedding.is_left(quad, nodes), hold_together(kMesh, alive, quad));
    }
}

TEST(Embedding, CellsOutsideGoWithTheNearestHexahedron) {
  const PointArray above = (PointArray(3, 3) << 0.2, 0.2, 2.3, 0.3, 0.2, 2.3, 0.2, 0.3, 2.3).finished();
  const Embedding embedding(kMesh.positions(), kMesh.hexahedra(), above);
  const std::array<int, 3> triangle{0, 1, 2};
  for (int e = 0; e < kMesh.num_elements(); ++e) {
    std::vector<unsigned char> alive(kMesh.num_elements(), 1);
    alive[e] = 0;
    EXPECT_EQ(
        embedding.is_left(triangle, [&](std::span<const int> nodes) { return hold_together(kMesh, alive, nodes); }),
        e != embedding.hexahedron_of(0));
  }
}

TEST(Embedding, NeedsAHexahedronAndFinitePoints) {
  EXPECT_THROW(Embedding(kMesh.positions(), {}, points_inside(1)), InputError);
  PointArray bad = points_inside(2);
  bad(1, 2) = std::nan("");
  EXPECT_THROW(Embedding(kMesh.positions(), kMesh.hexahedra(), bad), NumericalError);
}

}  // namespace
}  // namespace hexaplast
