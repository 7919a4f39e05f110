// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/cage.hpp"

#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

struct Surface {
  PointArray x;
  std::vector<Triangle> triangles = {};
  std::vector<Quad> quads = {};
};

/// A sphere of latitudes and longitudes, poles included: its corners lie on the sphere, its faces a little inside.
Surface sphere(const Vec3& centre, double radius, int count) {
  Surface surface;
  surface.x.resize(2 * count * (count + 1), 3);
  const auto node = [&](int i, int j) { return i * 2 * count + j % (2 * count); };
  for (int i = 0; i <= count; ++i)
    for (int j = 0; j < 2 * count; ++j) {
      const double polar = std::numbers::pi * i / count, azimuth = std::numbers::pi * j / count;
      const Vec3 normal(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
      surface.x.row(node(i, j)) = (centre + radius * normal).transpose();
    }
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < 2 * count; ++j)
      surface.quads.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
  return surface;
}

/// The six faces of a box.
Surface box(const Vec3& min, const Vec3& max) {
  const HexMesh mesh = regular_grid({1, 1, 1}, min, max);
  return {mesh.positions(), {}, faces_of(mesh.hexahedra())};
}

Surface side_by_side(const Surface& a, const Surface& b) {
  Surface both = a;
  const int first = static_cast<int>(a.x.rows());
  both.x.conservativeResize(first + b.x.rows(), 3);
  both.x.bottomRows(b.x.rows()) = b.x;
  for (Quad quad : b.quads) {
    for (int& node : quad) node += first;
    both.quads.push_back(quad);
  }
  return both;
}

Cage cage_of(const Surface& surface, const CageGrid& grid) {
  return cage_around(surface.x, surface.triangles, surface.quads, grid);
}

double volume_of(const HexMesh& mesh) {
  double sum = 0;
  for (const Hexahedron& corners : mesh.hexahedra()) sum += volume(gather(mesh.positions(), corners));
  return sum;
}

// A cell belongs to the cage when the ball reaches it, and is touched when the ball does not fill it: known without any
// triangle. The grid has no symmetry, and no cell is nearer to the borderline than the faces deviate from the sphere.
TEST(Cage, HoldsTheCellsThatABallReaches) {
  const Vec3 centre(0.31, -0.22, 1.13);
  const double radius = 0.5;
  const int count = 100;
  const CageGrid grid{.cells = {9, 7, 8}, .min = {-0.3, -0.75, 0.6}, .max = {0.9, 0.35, 1.7}};
  const Cage cage = cage_of(sphere(centre, radius, count), grid);

  const HexMesh all = regular_grid(grid.cells, grid.min, grid.max);
  const double deviation = radius * std::pow(std::numbers::pi / count, 2);
  int num_touched = 0, num_enclosed = 0;
  for (const Hexahedron& corners : all.hexahedra()) {
    const ElementPoints x = gather(all.positions(), corners);
    const Eigen::AlignedBox3d cell(Vec3(x.row(0).transpose()), Vec3(x.row(6).transpose()));
    const double nearest = cell.exteriorDistance(centre);
    const double farthest = (x.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
    ASSERT_GT(std::abs(nearest - radius), deviation);
    ASSERT_GT(std::abs(farthest - radius), deviation);
    if (farthest < radius) ++num_enclosed;
    if (nearest < radius && farthest > radius) ++num_touched;
  }
  EXPECT_EQ(cage.num_touched, num_touched);
  EXPECT_EQ(cage.mesh.num_elements(), num_touched + num_enclosed);
  EXPECT_GT(num_enclosed, 50);
  EXPECT_EQ(cage.num_parts, 1);
  EXPECT_EQ(cage.num_hinges, 0);
  for (int e = 0; e < cage.mesh.num_elements(); ++e) {
    const ElementPoints x = gather(cage.mesh.positions(), cage.mesh.hexahedra()[e]);
    const double farthest = (x.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
    EXPECT_EQ(e<cage.num_touched, farthest> radius) << e;
  }
}

// Conforming: each face belongs to two hexahedra or to the border, whose outward faces enclose the same volume as the
// sum of the hexahedra. And the surface lies inside.
TEST(Cage, IsOneConformingMeshAroundTheSurface) {
  const Surface surface = sphere(Vec3(1, 2, 3), 0.2, 40);
  const Cage cage = cage_of(surface, cubes_around(surface.x, 7));
  const PointArray& x = cage.mesh.positions();
  const double enclosed = enclosed_volume(x, cage.mesh.boundary_faces());
  EXPECT_NEAR(enclosed, volume_of(cage.mesh), 1e-12);
  EXPECT_GT(enclosed, 4 * std::numbers::pi / 3 * 0.008);
  EXPECT_EQ(Embedding(x, cage.mesh.hexahedra(), surface.x).num_outside(), 0);
  for (int n = 0; n < cage.mesh.num_nodes(); ++n) EXPECT_FALSE(cage.mesh.incident(n).empty());
}

// The lines of a triangle without any direction of the grid, sampled densely: what holds a sample is touched, and what
// is touched is as near to a sample as the samples are to each other.
TEST(Cage, TouchedAreTheCellsOfATriangle) {
  Random random(61);
  for (int trial = 0; trial < 20; ++trial) {
    const PointArray x = random.field(3, 1);
    const CageGrid grid{.cells = {7, 6, 5}, .min = Vec3::Constant(-1), .max = Vec3::Ones()};
    const std::vector<Triangle> triangles{{0, 1, 2}};
    const Cage cage = cage_around(x, triangles, {}, grid);
    std::vector<bool> holds_sample(static_cast<std::size_t>(cage.mesh.num_elements()), false);
    const int count = 400;
    for (int i = 0; i <= count; ++i)
      for (int j = 0; i + j <= count; ++j) {
        const Vec3 p = (x.row(0) + (x.row(1) - x.row(0)) * i / count + (x.row(2) - x.row(0)) * j / count).transpose();
        bool is_inside = false;
        for (int e = 0; e < cage.mesh.num_elements(); ++e) {
          const ElementPoints corners = gather(cage.mesh.positions(), cage.mesh.hexahedra()[e]);
          const Eigen::AlignedBox3d cell(Vec3(corners.row(0).transpose()), Vec3(corners.row(6).transpose()));
          is_inside = is_inside || cell.exteriorDistance(p) <= 1e-9;
          if (cell.exteriorDistance(p) <= 3.0 / count) holds_sample[e] = true;
        }
        ASSERT_TRUE(is_inside) << trial;
      }
    EXPECT_TRUE(std::ranges::all_of(holds_sample, [](bool holds) { return holds; })) << trial;
  }
}

// SOFA's SparseGridTopology: boundary cells first, x fastest; nodes by x, then y, then z. A wall between two cells
// touches both.
TEST(Cage, IsNumberedAsSofaNumbersIt) {
  const Cage cage = cage_of(box(Vec3(0.1, 0.1, 0.1), Vec3(2.9, 2.9, 2.9)),
                            {.cells = {3, 3, 3}, .min = Vec3::Zero(), .max = Vec3::Constant(3)});
  ASSERT_EQ(cage.mesh.num_elements(), 27);
  EXPECT_EQ(cage.num_touched, 26);
  const auto first_corner = [&](int e) -> Vec3 {
    return cage.mesh.positions().row(cage.mesh.hexahedra()[e][0]).transpose();
  };
  EXPECT_EQ(first_corner(1), Vec3(1, 0, 0));
  EXPECT_EQ(first_corner(13), Vec3(2, 1, 1));
  EXPECT_EQ(first_corner(26), Vec3(1, 1, 1));
  EXPECT_EQ(cage.mesh.hexahedra()[0], (Hexahedron{0, 16, 20, 4, 1, 17, 21, 5}));

  const Cage wall = cage_around((PointArray(3, 3) << 1, 0.2, 0.2, 1, 0.8, 0.2, 1, 0.2, 0.8).finished(),
                                std::vector<Triangle>{{0, 1, 2}}, {},
                                {.cells = {4, 2, 1}, .min = Vec3::Zero(), .max = Vec3(4, 2, 1)});
  EXPECT_EQ(wall.mesh.num_elements(), 2);
}

// Cubes: as many along the longest side as asked for, and no more than needed along the others.
TEST(Cage, CubesCoverTheBoxAroundTheSurface) {
  const PointArray x = box(Vec3(-1, 2, 0), Vec3(1, 2.5, 0.9)).x;
  const CageGrid grid = cubes_around(x, 10);
  EXPECT_EQ(grid.cells, (std::array<int, 3>{10, 3, 5}));
  const Vec3 size = grid.max - grid.min;
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(size[d] / grid.cells[d], 0.204, 1e-14);
  EXPECT_LE(max_abs((grid.max + grid.min) / 2 - Vec3(0, 2.25, 0.45)), 1e-14);

  // a sheet lies in the middle of one layer
  const PointArray flat = box(Vec3(0, 0, 1), Vec3(1, 1, 2)).x.topRows(4);
  const CageGrid layer = cubes_around(flat, 4);
  EXPECT_EQ(layer.cells, (std::array<int, 3>{4, 4, 1}));
  EXPECT_NEAR(layer.min[2] + layer.max[2], 2, 1e-14);
  EXPECT_EQ(cage_around(flat, {}, std::vector<Quad>{{0, 1, 3, 2}}, layer).mesh.num_elements(), 16);
}

TEST(Cage, CountsPartsAndHinges) {
  const CageGrid grid{.cells = {5, 5, 5}, .min = Vec3::Zero(), .max = Vec3::Constant(5)};
  const Surface first = box(Vec3(0.2, 0.2, 0.2), Vec3(1.8, 1.8, 1.8));
  const auto with = [&](const Vec3& min) {
    return cage_of(side_by_side(first, box(min, min + Vec3::Constant(0.6))), grid);
  };
  EXPECT_EQ(with(Vec3(3.2, 3.2, 3.2)).num_parts, 2);  // far away
  EXPECT_EQ(with(Vec3(3.2, 3.2, 3.2)).num_hinges, 0);
  EXPECT_EQ(with(Vec3(2.2, 2.2, 0.2)).num_parts, 2);  // at an edge, which has two nodes
  EXPECT_EQ(with(Vec3(2.2, 2.2, 0.2)).num_hinges, 2);
  EXPECT_EQ(with(Vec3(2.2, 2.2, 2.2)).num_hinges, 1);  // at a corner
  EXPECT_EQ(with(Vec3(2.2, 1.2, 0.2)).num_parts, 1);   // at a face
  EXPECT_EQ(with(Vec3(2.2, 1.2, 0.2)).num_hinges, 0);
}

// Without its lid a box would hold nothing, whichever way its faces look, and where they look in different ways.
TEST(Cage, ASurfaceWithAHoleIsRefusedWhereTheCageWouldBeHollow) {
  const CageGrid grid{.cells = {6, 6, 6}, .min = Vec3::Zero(), .max = Vec3::Constant(6)};
  Surface open = box(Vec3(0.5, 0.5, 0.5), Vec3(5.5, 5.5, 5.5));
  EXPECT_EQ(cage_of(open, grid).mesh.num_elements(), 216);
  open.quads.pop_back();
  for (int turn = 0; turn < 3; ++turn) {
    EXPECT_TRUE(refuses<InputError>(
        [&] { cage_of(open, grid); },
        {"the surface is open", "64 cells inside", "4 edges belong to one face alone",
         "close the holes, or use larger cells; where the wall alone is meant, make layers on the surface"}));
    if (turn == 0)
      for (Quad& quad : open.quads) std::ranges::reverse(quad);
    else
      for (std::size_t q = 0; q < 2; ++q) std::ranges::reverse(open.quads[q]);
  }
  Surface turned = open;  // faces that are there again, turned over or not, close no hole
  for (Quad& quad : turned.quads) std::swap(quad[1], quad[3]);
  for (const Surface& other : {open, turned})
    EXPECT_TRUE(
        refuses<InputError>([&] { cage_of(side_by_side(open, other), grid); }, {"4 edges belong to one face alone"}));
}

// A pinhole in a sphere: as long as no cell passes through it, the cage is that of the whole sphere.
TEST(Cage, AHoleSmallerThanTheCellsDoesNotMatter) {
  const Surface whole = sphere(Vec3(1, 2, 3), 1, 12);
  Surface open = whole;
  open.quads.erase(open.quads.begin() + 130);
  int num_refused = 0, num_whole = 0;
  for (const int cells : {3, 6, 10, 40}) {
    const CageGrid grid = cubes_around(whole.x, cells);
    if (refuses<InputError>([&] { cage_of(open, grid); }, {": 4 edges belong to one face alone"})) {
      ++num_refused;
    } else {
      EXPECT_EQ(cage_of(open, grid).mesh.hexahedra(), cage_of(whole, grid).mesh.hexahedra()) << cells;
      ++num_whole;
    }
  }
  EXPECT_GT(num_refused, 0);
  EXPECT_GT(num_whole, 0);
}

// What is open and surrounds nothing has the cells that it touches: a belt, and a wall with a border of its own. So
// have two halves whose corners do not meet: their seam is a hole without width.
TEST(Cage, AnOpenSurfaceWithoutInsideIsNoMistake) {
  const Surface ball = sphere(Vec3::Zero(), 1, 40);
  Surface belt{ball.x, {}, {ball.quads.begin() + 19 * 80, ball.quads.begin() + 21 * 80}};
  const CageGrid grid = cubes_around(ball.x, 20);
  const Cage around = cage_of(belt, grid);
  EXPECT_EQ(around.num_touched, around.mesh.num_elements());
  EXPECT_GT(around.num_touched, 40);

  for (const int rows : {4, 8, 20})  // a cap of 18 and of 36 degrees, and a bowl
    for (const int cells : {10, 20, 45}) {
      const Surface cap{ball.x, {}, {ball.quads.begin(), ball.quads.begin() + rows * 80}};
      const Cage cage = cage_of(cap, cubes_around(ball.x.topRows((rows + 1) * 80), cells));
      EXPECT_EQ(cage.num_touched, cage.mesh.num_elements()) << rows << " rows, " << cells << " cells";
    }

  const Surface upper{ball.x, {}, {ball.quads.begin(), ball.quads.begin() + 20 * 80}};
  Surface lower{ball.x, {}, {ball.quads.begin() + 20 * 80, ball.quads.end()}};
  const Mat3 turn = Eigen::AngleAxisd(1e-3, Vec3::UnitZ()).toRotationMatrix();
  lower.x = lower.x * turn.transpose();
  const Cage whole = cage_of(ball, grid), halves = cage_of(side_by_side(upper, lower), grid);
  EXPECT_EQ(halves.mesh.num_elements(), whole.mesh.num_elements());
  EXPECT_GT(halves.mesh.num_elements(), halves.num_touched);
}

TEST(Cage, RefusesWhatCannotBeCaged) {
  const Surface good = box(Vec3(0.5, 0.5, 0.5), Vec3(1.5, 1.5, 1.5));
  const CageGrid grid{.cells = {2, 2, 2}, .min = Vec3::Zero(), .max = Vec3::Constant(2)};
  EXPECT_TRUE(refuses<InputError>([&] { cage_around(good.x, {}, {}, grid); }, {"neither triangles nor quads"}));
  const std::vector<Quad> wrong{{0, 1, 2, 8}};
  EXPECT_TRUE(refuses<InputError>([&] { cage_around(good.x, {}, wrong, grid); }, {"node 8: must lie in [0, 8)"}));
  CageGrid small = grid;
  small.max[1] = 1;
  EXPECT_TRUE(refuses<InputError>([&] { cage_of(good, small); }, {"(0.5, 1.5, 0.5), lies outside the box"}));
  small.max[1] = 0;
  EXPECT_TRUE(refuses<InputError>([&] { cage_of(good, small); }, {"from 0 to 0 in direction 1: the box is empty"}));
  CageGrid large = grid;
  large.cells = {2000000000, 2000000000, 2000000000};
  EXPECT_TRUE(refuses<InputError>([&] { cage_of(good, large); }, {"at most 134217728"}));
  large.cells = {2, 0, 2};
  EXPECT_TRUE(refuses<InputError>([&] { cage_of(good, large); }, {"0 cells in direction 1: at least 1"}));
  Surface lost = good;
  lost.x(3, 0) = std::nan("");
  EXPECT_TRUE(refuses<InputError>([&] { cage_of(lost, grid); }, {"node 3", "nan"}));
  EXPECT_TRUE(refuses<InputError>([&] { cubes_around(good.x, 0); }, {"0 cells: at least 1"}));
  EXPECT_TRUE(refuses<InputError>([&] { cubes_around(good.x.topRows(1), 3); }, {"no extent"}));
}

}  // namespace
}  // namespace hexaplast
