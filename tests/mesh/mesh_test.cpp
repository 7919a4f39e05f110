// SPDX-License-Identifier: LGPL-2.1-or-later
#include <limits>
#include <set>

#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "mesh/lumped_mass.hpp"
#include "mesh/neighbours.hpp"
#include "mesh/selection.hpp"
#include "mesh/trilinear.hpp"
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using namespace support;

TEST(HexMesh, RefusesWhatIsNoMesh) {
  const HexMesh good = block({3, 2, 2}, 0.1);
  const auto made = [&](const std::function<void(PointArray&, std::vector<Hexahedron>&)>& change) {
    return [&, change] {
      PointArray x = good.positions();
      std::vector<Hexahedron> hexahedra = good.hexahedra();
      change(x, hexahedra);
      HexMesh(x, hexahedra);
    };
  };
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_TRUE(refuses<InputError>(made([&](auto& x, auto&) { x(17, 1) = bad; }), {"17", "finite"}));
  for (const int bad : {-1, 36, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()})
    EXPECT_TRUE(refuses<InputError>(made([&](auto&, auto& all) { all[5][3] = bad; }), {"5", "[0, 36)"}));
  EXPECT_TRUE(refuses<InputError>(made([](auto&, auto& all) { all[6][3] = all[6][0]; }), {"6", "twice"}));

  // a quarter turn names the same cube by another corner first
  const Hexahedron h = good.hexahedra()[3];
  for (const Hexahedron& copy : {h, Hexahedron{h[1], h[2], h[3], h[0], h[5], h[6], h[7], h[4]}})
    EXPECT_TRUE(
        refuses<InputError>(made([&](auto&, auto& all) {
                              all.insert(all.end(), {all[0], copy});
                            }),
                            {"2 hexahedra with the same eight nodes as another one: 12 as 0, 13 as 3; each must"}));
  const auto turn_over = [](auto&, auto& all) {
    for (Hexahedron& corners : all) std::rotate(corners.begin(), corners.begin() + 4, corners.end());
  };
  EXPECT_TRUE(refuses<InputError>(made(turn_over), {"12 ", "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, ...", "left-handed"}));

  const ElementPoints cube = support::cube(1);
  EXPECT_TRUE(
      refuses<InputError>([&] { single_element(mapped(cube, Vec3(1, 1, 0).asDiagonal())); }, {"inverted, flat"}));
  ElementPoints folded = cube;
  folded.row(6) = -1.2 * cube.row(6);  // one corner pushed through the others: seven corners are still right
  EXPECT_TRUE(refuses<InputError>([&] { single_element(folded); }, {"0"}));
}

TEST(HexMesh, AllowsNodesWithoutElementAndNoElementsAtAll) {
  PointArray positions(9, 3);
  positions << PointArray(cube(1)), 5, 5, 5;
  const HexMesh mesh(positions, {Hexahedron{0, 1, 2, 3, 4, 5, 6, 7}});
  EXPECT_TRUE(mesh.incident(8).empty());
  EXPECT_EQ(HexMesh(positions, {}).num_elements(), 0);
}

TEST(HexMesh, BoundaryFacesLookOutwards) {
  const HexMesh mesh = distorted_block({2, 3, 2}, 0.1, 0.15, 63);
  const auto faces = mesh.boundary_faces();
  EXPECT_EQ(faces.size(), 2u * (2 * 3 + 3 * 2 + 2 * 2));
  // the divergence theorem: the faces enclose the volume only when all of them look outwards
  EXPECT_NEAR(enclosed_volume(mesh.positions(), faces), 0.012, 0.002);
}

// Each hexahedron that is left has six faces, and two of them have one in common unless it is on the surface.
TEST(HoldTogether, TellsWhichFacesAndNodesAreLeft) {
  Random random(65);
  const HexMesh mesh = block({4, 3, 5}, 0.1);
  const std::vector<Quad> faces = faces_of(mesh.hexahedra());
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<unsigned char> alive(mesh.num_elements());
    for (unsigned char& is_alive : alive) is_alive = random.uniform(0, 20) > trial;
    const auto num_alive = static_cast<std::size_t>(std::ranges::count(alive, 1));
    const auto num_left = static_cast<std::size_t>(
        std::ranges::count_if(faces, [&](const Quad& face) { return hold_together(mesh, alive, face); }));
    ASSERT_EQ(2 * num_left, 6 * num_alive + mesh.boundary_faces(alive).size()) << trial;

    const std::vector<int> part_of_node = connected_parts(mesh, alive).part_of_node;
    for (int n = 0; n < mesh.num_nodes(); ++n)
      ASSERT_EQ(hold_together(mesh, alive, std::array{n}), part_of_node[n] >= 0) << n;
  }
  const std::vector<unsigned char> none(mesh.num_elements(), 0);
  EXPECT_FALSE(hold_together(mesh, none, std::array{0, 1}));
  EXPECT_TRUE(hold_together(mesh, none, std::array{0, 4})) << "no hexahedron ever had both";
}

TEST(HexMesh, RefusesValuesThatAreNotOneForEachHexahedron) {
  const HexMesh mesh = block({2, 1, 1}, 1);
  const std::vector<unsigned char> one(1, 1), two(2, 1);
  const std::vector<double> values(2, 1);
  EXPECT_TRUE(refuses<InputError>([&] { mesh.boundary_faces(one); }, {"alive has 1 rows, must have 2"}));
  EXPECT_TRUE(refuses<InputError>([&] { connected_parts(mesh, one); }, {"alive has 1 rows, must have 2"}));
  EXPECT_TRUE(refuses<InputError>([&] { nodal_means(mesh, values, one); }, {"alive has 1 rows, must have 2"}));
  EXPECT_TRUE(refuses<InputError>([&] { nodal_means(mesh, {}); }, {"of_hexahedra has 0 rows, must have 2"}));
  EXPECT_TRUE(refuses<InputError>([&] { hold_together(mesh, one, std::array{0}); }, {"alive"}));
  EXPECT_TRUE(refuses<InputError>([&] { hold_together(mesh, two, std::array{12}); }, {"node 12", "[0, 12)"}));
  EXPECT_TRUE(refuses<InputError>([&] { hold_together(mesh, two, {}); }, {"nodes"}));
}

TEST(Gather, AndScatterAreAdjoint) {
  Random random(64);
  const HexMesh mesh = block({2, 2, 3}, 0.1);
  const PointArray field = random.field(mesh.num_nodes(), 1);
  std::vector<ElementPoints> corner(mesh.num_elements());
  double expected = 0;
  for (int e = 0; e < mesh.num_elements(); ++e) {
    corner[e] = random.field(kCorners, 1);
    expected += corner[e].cwiseProduct(gather(field, mesh.hexahedra()[e])).sum();
  }
  PointArray nodal = PointArray::Zero(mesh.num_nodes(), 3);
  scatter(mesh, corner, nodal);
  EXPECT_NEAR(nodal.cwiseProduct(field).sum(), expected, 1e-12);
}

TEST(RegularGrid, NumbersNodesAndElementsWithXFastest) {
  const HexMesh mesh = regular_grid({2, 3, 4}, Vec3(-1, 0, 1), Vec3(1, 3, 3));
  EXPECT_EQ(mesh.num_nodes(), 3 * 4 * 5);
  EXPECT_EQ(mesh.num_elements(), 24);
  EXPECT_TRUE(mesh.positions().row(1 + 3 * (2 + 4 * 3)).isApprox(Eigen::RowVector3d(0, 2, 2.5)));
  EXPECT_EQ(mesh.hexahedra()[1], (Hexahedron{1, 2, 5, 4, 13, 14, 17, 16}));
}

TEST(RegularGrid, RefusesEmptyAndUncountableGrids) {
  const Vec3 zero = Vec3::Zero(), one = Vec3::Ones();
  EXPECT_TRUE(refuses<InputError>([&] { regular_grid({1, 0, 1}, zero, one); }, {"0 cells"}));
  EXPECT_TRUE(refuses<InputError>([&] { regular_grid({1, 1, 1}, zero, Vec3(1, 0, 1)); }, {"empty"}));
  EXPECT_TRUE(refuses<InputError>([&] { regular_grid({100000, 100000, 100000}, zero, one); }, {"100000 x 100000"}));
  const int max = std::numeric_limits<int>::max();
  EXPECT_TRUE(refuses<InputError>([&] { regular_grid({max, max, max}, zero, one); }, {"more nodes"}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(regular_grid({1, 1, 1}, zero, Vec3(1, nan, 1)), InputError);
  for (const std::array<int, 3> cells :
       {std::array{max, 0, 0}, std::array{1 << 16, 1 << 16, 0}, std::array{-1, 1, 1}}) {
    EXPECT_THROW(grid_points(cells, zero, one), InputError);
    EXPECT_THROW(grid_quads(cells), InputError);
    EXPECT_THROW(grid_edges(cells), InputError);
  }
}

/// Gradient (d/ds) of the trilinear shape functions at s, one row per corner: written out anew, to compare with.
ElementPoints reference_gradient(const Vec3& s) {
  ElementPoints g;
  for (int a = 0; a < kCorners; ++a) {
    const auto& c = kCornerSign[a];
    const double u = 1 + c[0] * s[0], v = 1 + c[1] * s[1], w = 1 + c[2] * s[2];
    g.row(a) << c[0] * v * w / 8, u * c[1] * w / 8, u * v * c[2] / 8;
  }
  return g;
}

Mat3 jacobian(const ElementPoints& x, const Vec3& s) { return x.transpose() * reference_gradient(s); }

Vec3 corner_point(int a) { return {double(kCornerSign[a][0]), double(kCornerSign[a][1]), double(kCornerSign[a][2])}; }

/// Calls visit(s, weight) at the 3x3x3 Gauss points of the reference cube.
template <class Visit>
void for_gauss_points(const Visit& visit) {
  const double at[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)};
  const double weight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) visit(Vec3(at[i], at[j], at[k]), weight[i] * weight[j] * weight[k]);
    }
  }
}

TEST(Jacobian, IsTheDerivativeOfTheTrilinearMap) {
  const ElementPoints x = distorted_hexahedron(0.1, 0.2, 21);
  for (int a = 0; a < kCorners; ++a) EXPECT_TRUE(agrees(corner_jacobian(x, a), jacobian(x, corner_point(a)), 1e-14));
  EXPECT_TRUE(agrees(centre_jacobian(x), jacobian(x, Vec3::Zero()), 1e-14));
}

TEST(Volume, IsTheIntegralOfTheJacobian) {
  const ElementPoints x = distorted_hexahedron(0.1, 0.25, 23);
  double integral = 0;
  for_gauss_points([&](const Vec3& s, double weight) { integral += weight * jacobian(x, s).determinant(); });
  EXPECT_NEAR(volume(x), integral, 1e-14 * integral);
  EXPECT_NEAR(volume(cube(0.1)), 1e-3, 1e-17);
}

TEST(LumpedMass, SharedNodesAddTheirHexahedra) {
  const HexMesh grid = regular_grid({2, 3, 4}, Vec3::Zero(), Vec3(2, 3, 4));
  const Eigen::VectorXd volume = nodal_volumes(grid.positions(), grid.hexahedra());
  EXPECT_NEAR(volume.sum(), 24, 1e-12);
  EXPECT_DOUBLE_EQ(volume[0], 0.125);                // a corner of the grid
  EXPECT_DOUBLE_EQ(volume[1 + 3 * (1 + 4 * 1)], 1);  // an inner node: eight eighths
}

// An affine map multiplies every volume by its determinant: here 2 * 3 * 0.5, sheared.
TEST(LumpedMass, FollowsAffineMapsExactly) {
  const HexMesh box = regular_grid({1, 1, 1}, Vec3::Zero(), Vec3::Ones());
  Mat3 A;
  A << 2, 0.7, -0.3, 0, 3, 0.9, 0, 0, 0.5;
  const PointArray x = box.positions() * A.transpose();
  EXPECT_NEAR(nodal_volumes(x, box.hexahedra()).sum(), 3, 1e-14);
}

// A frustum, 4 below and 1 above, with plane faces: h/3 (A + sqrt(A B) + B).
TEST(LumpedMass, IsTheVolumeWhereFacesArePlane) {
  ElementPoints x;
  x << 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 0, 0, 3, 1, 0, 3, 1, 1, 3, 0, 1, 3;
  EXPECT_NEAR(six_tetrahedra_volume(x), 3.0 / 3 * (4 + 2 + 1), 1e-14);
}

TEST(LumpedMass, NodesWithoutElementWeighNothing) {
  PointArray x = PointArray::Random(9, 3);
  x.topRows(8) = regular_grid({1, 1, 1}, Vec3::Zero(), Vec3::Ones()).positions();
  const std::vector<Hexahedron> hexahedra = regular_grid({1, 1, 1}, Vec3::Zero(), Vec3::Ones()).hexahedra();
  EXPECT_EQ(nodal_volumes(x, hexahedra)[8], 0);
}

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
    Random random(5);
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

}  // namespace
}  // namespace hexaplast
