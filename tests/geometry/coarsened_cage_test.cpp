// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/coarsened_cage.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "hexaplast/base/error.hpp"

namespace {

using namespace hexaplast;

/// The surface of boxes with the given corners.
struct Boxes {
  PointArray points;
  std::vector<Quad> quads;

  void add(const Vec3& min, const Vec3& max) {
    const auto first = static_cast<int>(points.rows());
    points.conservativeResize(first + 8, 3);
    for (int a = 0; a < 8; ++a)
      for (int d = 0; d < 3; ++d) points(first + a, d) = (a >> d & 1) ? max[d] : min[d];
    for (const Quad& face :
         {Quad{0, 2, 3, 1}, Quad{4, 5, 7, 6}, Quad{0, 1, 5, 4}, Quad{2, 6, 7, 3}, Quad{0, 4, 6, 2}, Quad{1, 3, 7, 5}})
      quads.push_back({face[0] + first, face[1] + first, face[2] + first, face[3] + first});
  }
};

std::set<std::array<double, 3>> places(const HexMesh& mesh) {
  std::set<std::array<double, 3>> all;
  for (const Hexahedron& nodes : mesh.hexahedra()) {
    const auto p = mesh.positions().row(nodes[0]);
    all.insert({p[0], p[1], p[2]});
  }
  return all;
}

// Two thin prongs along x within one layer of coarse cells, which a bar at the end joins: a fork.
Boxes fork() {
  Boxes fork;
  fork.add({.1, .1, .1}, {7.9, .4, .9});
  fork.add({.1, 1.6, .1}, {7.9, 1.9, .9});
  fork.add({7.1, .1, .1}, {7.9, 1.9, .9});
  return fork;
}

const CageGrid kCoarse{.cells = {4, 1, 1}, .min = {0, 0, 0}, .max = {8, 2, 2}};

TEST(CoarsenedCage, BranchesInOneCellStayApart) {
  const Boxes surface = fork();
  const CoarsenedCage cage =
      coarsened_cage(surface.points, {}, surface.quads, kCoarse, 2, SeparateParts::kOwnHexahedra, .5);
  // three cells with two prongs each, and the one with the bar
  EXPECT_EQ(cage.mesh.hexahedra().size(), 7u);
  EXPECT_EQ(cage.num_doubled, 6);
  EXPECT_EQ(places(cage.mesh).size(), 4u);
  // the prongs share nodes at the bar alone: 4 faces of 4 nodes each prong, of which the last is common
  EXPECT_EQ(cage.mesh.positions().rows(), 2 * 3 * 4 + 4 + 4);
}

// A frame around a hole: its two branches join on either side, and have all eight nodes of the cell in common.
TEST(CoarsenedCage, BranchesThatJoinOnAllSidesAreOneHexahedron) {
  const CageGrid grid{.cells = {12, 4, 4}, .min = {0, 0, 0}, .max = {12, 4, 4}};
  std::vector<CageCell> cells;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 12; ++i) {
        const bool is_hole = i >= 4 && i < 8 && (j == 1 || j == 2);
        cells.push_back(is_hole ? CageCell::kOutside : CageCell::kEnclosed);
      }
  const Cage fine = cage_of(cells, grid);
  const std::vector<double> fill(fine.mesh.hexahedra().size(), 1);
  const CoarsenedCage cage = coarsened_cage(fine, grid, fill, 2, SeparateParts::kOwnHexahedra, std::nullopt);
  EXPECT_EQ(cage.mesh.num_elements(), 3);
  EXPECT_EQ(cage.mesh.boundary_faces().size(), 14u);
  EXPECT_EQ(cage.fill, (std::vector<double>{1, .5, 1}));
  EXPECT_EQ(cage.num_doubled, 0);
}

TEST(CoarsenedCage, OrTheyShareAHexahedron) {
  const Boxes surface = fork();
  const CoarsenedCage cage =
      coarsened_cage(surface.points, {}, surface.quads, kCoarse, 2, SeparateParts::kShareHexahedron, .5);
  EXPECT_EQ(cage.mesh.hexahedra().size(), 4u);
  EXPECT_EQ(cage.num_doubled, 0);
  EXPECT_EQ(cage.mesh.positions().rows(), 5 * 4);
  // nodes ascend by x, then y, then z
  EXPECT_EQ(cage.mesh.positions().row(1), Eigen::RowVector3d(0, 0, 2));
  EXPECT_EQ(cage.mesh.positions().row(4), Eigen::RowVector3d(2, 0, 0));
}

// The matter does not depend on who shares it, and is that of the fine cells.
TEST(CoarsenedCage, FillIsTheMeanOfTheFineCells) {
  const Boxes surface = fork();
  const CageGrid fine{.cells = {16, 4, 4}, .min = kCoarse.min, .max = kCoarse.max};
  const Cage cells = cage_around(surface.points, {}, surface.quads, fine);
  const double matter = .5 * cells.num_touched + static_cast<double>(cells.mesh.hexahedra().size()) - cells.num_touched;
  for (const SeparateParts parts : {SeparateParts::kOwnHexahedra, SeparateParts::kShareHexahedron}) {
    const CoarsenedCage cage = coarsened_cage(surface.points, {}, surface.quads, kCoarse, 2, parts, .5);
    EXPECT_NEAR(std::accumulate(cage.fill.begin(), cage.fill.end(), 0.0), matter / 64, 1e-12);
    for (const double fill : cage.fill) EXPECT_TRUE(fill > 0 && fill <= 1) << fill;
  }
}

// Two boxes in two neighbouring cells, of which nothing reaches the common face, and one that does.
TEST(CoarsenedCage, CellsMeetWhereTheSurfaceCrossesTheirFace) {
  const CageGrid two{.cells = {1, 2, 1}, .min = {0, 0, 0}, .max = {1, 2, 1}};
  Boxes apart;
  apart.add({.1, .1, .1}, {.9, .4, .9});
  apart.add({.1, 1.6, .1}, {.9, 1.9, .9});
  Boxes near;  // edges reach beyond their first corner, as far as they are long
  near.add({.1, .1, .1}, {.9, .9, .9});
  near.add({.1, 1.1, .1}, {.9, 1.9, .9});
  Boxes joined;
  joined.add({.1, .1, .1}, {.9, 1.9, .9});
  const auto num_nodes = [&](const Boxes& surface, CellsMeet meet) {
    return coarsened_cage(surface.points, {}, surface.quads, two, 0, SeparateParts::kOwnHexahedra, .5, meet)
        .mesh.positions()
        .rows();
  };
  EXPECT_EQ(num_nodes(apart, CellsMeet::kWhereCrossed), 16);
  EXPECT_EQ(num_nodes(apart, CellsMeet::kAtFaces), 12);
  EXPECT_EQ(num_nodes(near, CellsMeet::kWhereCrossed), 12);
  EXPECT_EQ(num_nodes(joined, CellsMeet::kWhereCrossed), 12);
}

TEST(CoarsenedCage, LevelsAreLimited) {
  const Boxes surface = fork();
  for (const int levels : {-1, 11})
    EXPECT_THROW(coarsened_cage(surface.points, {}, surface.quads, kCoarse, levels, SeparateParts::kOwnHexahedra, .5),
                 InputError);
  CageGrid large = kCoarse;
  large.cells = {1000, 1000, 1000};
  EXPECT_THROW(coarsened_cage(surface.points, {}, surface.quads, large, 1, SeparateParts::kOwnHexahedra, .5),
               InputError);
}

}  // namespace
