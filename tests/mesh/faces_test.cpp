// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/faces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "hexaplast/base/error.hpp"
#include "mesh/neighbours.hpp"
#include "mesh/selection.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::block;

Vec3 doubled_normal(const Quad& quad, ConstPoints x) {
  const Vec3 a = (x.row(quad[2]) - x.row(quad[0])).transpose(), b = (x.row(quad[3]) - x.row(quad[1])).transpose();
  return a.cross(b);
}

// Two cells share one of their twelve faces and four of their edges.
TEST(Faces, OfHexahedraAreThereOnceAndSeenFromOutsideTheFirst) {
  const HexMesh mesh = block({2, 1, 1}, 1);
  const std::vector<Quad> faces = faces_of(mesh.hexahedra());
  ASSERT_EQ(faces.size(), 11u);
  EXPECT_EQ(faces[0], (Quad{0, 3, 4, 1}));  // below the first cell
  std::set<std::array<int, 4>> distinct;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Vec3 from(i < 6 ? 0.5 : 1.5, 0.5, 0.5);
    Vec3 centre = Vec3::Zero();
    for (const int n : faces[i]) centre += mesh.positions().row(n).transpose() / 4;
    EXPECT_GT(doubled_normal(faces[i], mesh.positions()).dot(centre - from), 0) << i;
    EXPECT_EQ(faces[i][0], std::ranges::min(faces[i]));
    Quad sorted = faces[i];
    std::ranges::sort(sorted);
    distinct.insert(sorted);
  }
  EXPECT_EQ(distinct.size(), faces.size());
}

TEST(Faces, EdgesOfHexahedraAreThereOnce) {
  const std::vector<Edge> edges = edges_of(block({2, 1, 1}, 1).hexahedra());
  EXPECT_EQ(edges.size(), 20u);
  for (const auto& [a, b] : edges) EXPECT_LT(a, b);
  EXPECT_EQ(edges[0], (Edge{0, 1}));
}

// The same faces and edges as those of its hexahedra, in the grid's own order.
TEST(Faces, OfAGridAreThoseOfItsCells) {
  const HexMesh mesh = block({2, 3, 4}, 0.5);
  const auto sorted = [](auto cells) {
    for (auto& cell : cells) std::ranges::sort(cell);
    std::ranges::sort(cells);
    return cells;
  };
  const std::vector<Quad> quads = grid_quads({2, 3, 4});
  EXPECT_EQ(sorted(quads), sorted(faces_of(mesh.hexahedra())));
  EXPECT_EQ(sorted(grid_edges({2, 3, 4})), sorted(edges_of(mesh.hexahedra())));
  EXPECT_EQ(quads[1], (Quad{1, 2, 5, 4}));
  EXPECT_GT(doubled_normal(quads.front(), mesh.positions()).z(), 0);
  EXPECT_LT(doubled_normal(quads[2 * 3 * 5], mesh.positions()).y(), 0);
  EXPECT_GT(doubled_normal(quads.back(), mesh.positions()).x(), 0);
}

// In a block the neighbours are a step away along the lattice of cells.
TEST(Faces, LeadToTheElementsBeyondThem) {
  const std::array<int, 3> cells = {2, 3, 4};
  const HexMesh mesh = block(cells, 1);
  std::vector<unsigned char> alive(mesh.num_elements(), 1);
  const int gone = 1 + 2 * (1 + 3 * 2);
  alive[gone] = 0;
  const auto all = mesh.neighbours(), some = neighbours_across_faces(mesh, alive);
  for (int e = 0; e < 24; ++e)
    for (int side = 0; side < 6; ++side) {
      std::array<int, 3> at = {e % 2, e / 2 % 3, e / 6};
      for (int d = 0; d < 3; ++d) {  // the direction in which the four corners of the face agree
        const auto end_of = [&](int corner) { return kCornerSign[corner][d] > 0 ? 1 : -1; };
        const int end = end_of(kFaces[side][0]);
        if (std::ranges::all_of(kFaces[side], [&](int corner) { return end_of(corner) == end; })) at[d] += end;
      }
      bool is_inside = true;
      for (int d = 0; d < 3; ++d) is_inside = is_inside && at[d] >= 0 && at[d] < cells[d];
      const int beyond = is_inside ? at[0] + 2 * (at[1] + 3 * at[2]) : -1;
      EXPECT_EQ(all[e][side], beyond) << e << ", " << side;
      EXPECT_EQ(some[e][side], e == gone || beyond == gone ? -1 : beyond) << e << ", " << side;
    }
}

// Two hexahedra on the same face of a third one: where one is gone, the other is there.
TEST(Faces, ThatThreeHexahedraShareLeadToThoseThatAreLeft) {
  const HexMesh pair = block({1, 1, 2}, 1);
  PointArray X(pair.num_nodes() + 4, 3);
  X.topRows(pair.num_nodes()) = pair.positions();
  Hexahedron third = pair.hexahedra()[1];
  for (int a = 0; a < 4; ++a) {
    X.row(pair.num_nodes() + a) = pair.positions().row(third[4 + a]) + Vec3(0.1, 0, 0).transpose();
    third[4 + a] = pair.num_nodes() + a;
  }
  const HexMesh mesh(X, {pair.hexahedra()[0], pair.hexahedra()[1], third});
  const auto above = [&](std::vector<unsigned char> alive) { return neighbours_across_faces(mesh, alive)[0]; };
  const auto all = above({1, 1, 1});
  const auto top = std::ranges::find_if(all, [](int other) { return other >= 0; }) - all.begin();
  EXPECT_EQ(std::ranges::count(all, -1), 5);
  EXPECT_EQ(above({1, 0, 1})[top], 2);
  EXPECT_EQ(above({1, 1, 0})[top], 1);
  EXPECT_EQ(above({1, 0, 0})[top], -1);
}

TEST(Faces, NodalMeansCountTheHexahedraThatAreLeft) {
  const HexMesh mesh = block({3, 1, 1}, 1);
  const std::vector<double> values = {1, 3, 8};
  const std::vector<double> all = nodal_means(mesh, values),
                            some = nodal_means(mesh, values, std::vector<unsigned char>{1, 0, 0});
  for (int node = 0; node < mesh.num_nodes(); ++node) {
    const int slice = static_cast<int>(std::lround(mesh.positions()(node, 0)));
    EXPECT_EQ(all[node], (std::array{1.0, 2.0, 5.5, 8.0}[slice]));
    EXPECT_EQ(some[node], (std::array{1.0, 1.0, 0.0, 0.0}[slice]));
  }
}

TEST(Selection, OrientedBoxesLieAboutTheirRectangle) {
  const OrientedBox box{{1, 0, 0}, {3, 2, 0}, {2, 3, 0}, 1};  // 2 sqrt 2 by sqrt 2, from z = -.5 to .5
  EXPECT_TRUE(box.contains({2, 1.5, 0.4}));
  EXPECT_TRUE(box.contains({1, 0, -0.5}));
  EXPECT_TRUE(box.contains({0.01 + 1, 0.02, 0}));
  EXPECT_FALSE(box.contains({2, 1.5, 0.6}));
  EXPECT_FALSE(box.contains({2, 0.9, 0}));
  EXPECT_FALSE(box.contains({0.9, 0, 0}));
  EXPECT_FALSE(box.contains({2, 3.1, 0}));
}

// A corner of 2 x 2 x 2 cells without one of them, and with one that touches another at an edge alone.
TEST(Selection, ClosedSurfacesEncloseTheirHexahedra) {
  const HexMesh mesh = block({2, 2, 2}, 1);
  for (const std::vector<unsigned char>& alive :
       {std::vector<unsigned char>{1, 1, 1, 1, 1, 1, 1, 0}, std::vector<unsigned char>{1, 0, 0, 1, 0, 0, 0, 0}}) {
    std::vector<Triangle> triangles;
    for (const Quad& face : mesh.boundary_faces(alive)) {
      triangles.push_back({face[0], face[1], face[2]});
      triangles.push_back({face[0], face[2], face[3]});
    }
    const EnclosedSpace space(mesh.positions(), triangles);
    support::Random random(5);
    for (int k = 0; k < 500; ++k) {
      const Vec3 point = Vec3(1, 1, 1) + random.vector(1.4);
      const Eigen::Array3i cell = point.array().floor().cast<int>();
      const bool is_in_block = (cell >= 0).all() && (cell < 2).all();
      const bool expected = is_in_block && alive[static_cast<std::size_t>(cell[0] + 2 * cell[1] + 4 * cell[2])];
      EXPECT_EQ(space.contains(point), expected) << point.transpose();
    }
    triangles.pop_back();
    EXPECT_THROW(EnclosedSpace(mesh.positions(), triangles), InputError);
    triangles.push_back({0, 1, 99});
    EXPECT_THROW(EnclosedSpace(mesh.positions(), triangles), InputError);
  }
}

TEST(Selection, CellsOfAnyKindAreTakenWholeOrByTheirCentre) {
  const HexMesh mesh = block({3, 1, 1}, 1);
  const auto left = [](const Vec3& p) { return p.x() <= 1.6; };
  const std::vector<Quad> quads = grid_quads({3, 1, 1});
  EXPECT_EQ(cells_inside<8>(mesh.positions(), mesh.hexahedra(), Inside::kAllCorners, left), (std::vector<int>{0}));
  EXPECT_EQ(cells_inside<8>(mesh.positions(), mesh.hexahedra(), Inside::kCentre, left), (std::vector<int>{0, 1}));
  EXPECT_EQ(cells_inside<4>(mesh.positions(), quads, Inside::kAllCorners, left),
            (std::vector<int>{0, 3, 6, 9, 12, 13}));
}

}  // namespace
}  // namespace hexaplast
