// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/offset.hpp"

#include <map>

#include "formats/mesh_source.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "layout/charts.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

using std::numbers::pi;
using Parts = std::initializer_list<std::string>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The open surface place(i / cells_i, j / cells_j), its outer side on the left of i x j.
QuadSurface patch(int cells_i, int cells_j, const std::function<Vec3(double, double)>& place) {
  PointArray x((cells_i + 1) * (cells_j + 1), 3);
  const auto vertex = [&](int i, int j) { return j * (cells_i + 1) + i; };
  for (int j = 0; j <= cells_j; ++j)
    for (int i = 0; i <= cells_i; ++i)
      x.row(vertex(i, j)) = place(static_cast<double>(i) / cells_i, static_cast<double>(j) / cells_j).transpose();
  std::vector<Quad> quads;
  for (int j = 0; j < cells_j; ++j)
    for (int i = 0; i < cells_i; ++i)
      quads.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
  return QuadSurface(x, quads);
}

/// The lateral surface of a prism of `around` sides about z, its corners on the cylinder, normals outward.
QuadSurface prism(int around, int along, double radius, double length) {
  PointArray x(around * (along + 1), 3);
  std::vector<Quad> quads;
  const auto vertex = [&](int i, int k) { return k * around + i % around; };
  for (int k = 0; k <= along; ++k)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      x.row(vertex(i, k)) << radius * std::cos(angle), radius * std::sin(angle), length * k / along;
      if (k < along) quads.push_back({vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1), vertex(i, k + 1)});
    }
  return QuadSurface(x, quads);
}

/// The closed surface of a block of cubes, every vertex moved to place(vertex).
QuadSurface box(std::array<int, 3> cells, const std::function<Vec3(const Vec3&)>& place) {
  const HexMesh mesh = block(cells, 1);
  std::map<int, int> number;
  std::vector<Quad> quads = mesh.boundary_faces();
  for (Quad& quad : quads)
    for (int& n : quad) n = number.try_emplace(n, static_cast<int>(number.size())).first->second;
  PointArray x(static_cast<Eigen::Index>(number.size()), 3);
  for (const auto& [node, vertex] : number) x.row(vertex) = place(mesh.positions().row(node).transpose()).transpose();
  return QuadSurface(x, quads);
}

/// A sphere about the origin of 6 n^2 quads: the cube [-1, 1]^3 with its faces cut at equal angles, blown up.
QuadSurface sphere(int n, double radius) {
  return box({n, n, n}, [&](const Vec3& p) {
    const Vec3 s = (2 * p / n).array() - 1;
    return Vec3(radius * (std::numbers::pi / 4 * s.array()).tan().matrix().normalized());
  });
}

/// The sheet z = 0 of 3 x 2 unit quads, seen from above.
QuadSurface bent_sheet() {
  return patch(3, 2, [](double u, double v) { return Vec3(3 * u, 2 * v, 0); });
}

/// Smallest and greatest distance from the z axis of the outermost nodes.
std::pair<double, double> radii(const Shell& shell, int layers) {
  double min = kInfinity, max = 0;
  for (int n = layers; n < shell.mesh.num_nodes(); n += layers + 1) {
    const double r = shell.mesh.positions().row(n).head<2>().norm();
    min = std::min(min, r);
    max = std::max(max, r);
  }
  return {min, max};
}

testing::AssertionResult refuses_to_fold(const QuadSurface& surface, const ShellThickness& thickness, Parts parts) {
  return refuses<InputError>([&] { offset(surface, thickness); }, parts);
}
testing::AssertionResult are_refused(const PointArray& x, const std::vector<Quad>& quads, Parts parts) {
  return refuses<InputError>([&] { QuadSurface(x, quads); }, parts);
}

/// Every face belongs to one hexahedron or to two that see it from either side; returns how many belong to one.
int num_free_faces(const HexMesh& mesh) {
  std::map<Quad, int> count;
  for (const Hexahedron& hexahedron : mesh.hexahedra())
    for (const auto& local : kFaces) {
      Quad face;
      for (int k = 0; k < 4; ++k) face[k] = hexahedron[local[k]];
      std::ranges::sort(face);
      ++count[face];
    }
  int free = 0;
  for (const auto& [face, times] : count) {
    EXPECT_LE(times, 2);
    free += times == 1;
  }
  return free;
}

TEST(Offset, OfAPlaneIsABlock) {
  const Shell shell = offset(bent_sheet(), {0.25, 1, 5});
  EXPECT_EQ(shell.mesh.num_elements(), 6 * 5);
  EXPECT_EQ(shell.mesh.num_nodes(), 12 * 6);
  EXPECT_NEAR(shell.quality.volume, 6 * 1.25, 1e-14);
  EXPECT_NEAR(shell.quality.min_scaled_jacobian, 1, 1e-14);
  // vertex 5 = (1, 1), layer by layer outward
  for (int l = 0; l <= 5; ++l)
    EXPECT_TRUE(shell.mesh.positions().row(5 * 6 + l).isApprox(Eigen::RowVector3d(1, 1, -0.25 + 0.25 * l), 1e-14));
  EXPECT_EQ(shell.mesh.hexahedra()[1], (Hexahedron{1, 7, 31, 25, 2, 8, 32, 26}));
  EXPECT_EQ(num_free_faces(shell.mesh), 2 * 6 + 10 * 5);
}

TEST(Offset, MayLieOffTheSurfaceAndOnEitherSide) {
  const Shell above = offset(bent_sheet(), {-0.5, 0.75, 1}), below = offset(bent_sheet(), {0, -0.75, 2});
  EXPECT_DOUBLE_EQ(above.mesh.positions().col(2).minCoeff(), 0.5);
  EXPECT_DOUBLE_EQ(above.mesh.positions().col(2).maxCoeff(), 0.75);
  EXPECT_NEAR(above.quality.volume, 1.5, 1e-14);
  EXPECT_DOUBLE_EQ(below.mesh.positions().col(2).minCoeff(), -0.75);
  EXPECT_NEAR(below.quality.volume, 4.5, 1e-14);
}

// The sides of a prism stay planes at the distance asked for, so that its shell is the difference of two prisms.
TEST(Offset, OfAPrismKeepsItsThicknessExactly) {
  for (const int around : {4, 5, 12, 48}) {
    const double radius = 0.5, thickness = 0.2, length = 2;
    const Shell shell = offset(prism(around, 3, radius, length), {0, thickness, 2});
    const double apothem = radius * std::cos(pi / around);  // distance of the sides from the axis
    const auto section = [&](double a) { return around * a * a * std::tan(pi / around); };
    EXPECT_NEAR(shell.quality.volume, length * (section(apothem + thickness) - section(apothem)), 1e-13);
    const auto [min, max] = radii(shell, 2);
    EXPECT_NEAR(min, (apothem + thickness) / std::cos(pi / around), 1e-14);
    EXPECT_NEAR(max, min, 1e-14);
    EXPECT_EQ(num_free_faces(shell.mesh), 2 * around * 3 + 2 * around * 2);
  }
}

// However the sphere is cut into quads.
TEST(Offset, LeadsAlongTheRadiusOfASphere) {
  Random random(17);
  const QuadSurface ball = box(
      {7, 8, 9}, [&](const Vec3& p) { return Vec3((p - Vec3(3.5, 4, 4.5) + random.vector(0.1)).normalized() * 0.7); });
  const PointArray u = offset_directions(ball);
  for (int n = 0; n < ball.num_vertices(); ++n) {
    const Vec3 radius = ball.positions().row(n).transpose() / 0.7;
    EXPECT_NEAR(u.row(n).normalized().dot(radius), 1, 1e-12) << n;
    EXPECT_GT(u.row(n).dot(radius), 1);
  }
}

// Twelve planes of a box without right angles, all moved by the same distance: another such box, larger by what the
// three widths gain.
TEST(Offset, MovesThePlanesOfABoxByTheThickness) {
  Mat3 edges;
  edges.col(0) << 1, 0.1, 0;
  edges.col(1) << -0.3, 0.8, 0.2;
  edges.col(2) << 0.2, 0.1, 0.7;
  for (const std::array<int, 3> cells : {std::array{1, 1, 1}, std::array{3, 2, 4}}) {
    const QuadSurface surface =
        box(cells, [&](const Vec3& p) { return Vec3(edges * p.cwiseQuotient(Vec3(cells[0], cells[1], cells[2]))); });
    EXPECT_TRUE(surface.is_closed());
    const double thickness = 0.05;
    double larger = edges.determinant();
    for (int d = 0; d < 3; ++d) {
      const double width = edges.determinant() / edges.col((d + 1) % 3).cross(edges.col((d + 2) % 3)).norm();
      larger *= 1 + 2 * thickness / width;
    }
    EXPECT_NEAR(offset(surface, {0, thickness, 2}).quality.volume, larger - edges.determinant(), 1e-12);
  }
}

// The thickness does not depend on how the planes beside an edge are cut into quads.
TEST(Offset, LeansOnAnglesNotOnTheNumberOfQuads) {
  PointArray x(8, 3);
  // a roof: the ridge from vertex 0 to 1 belongs to one quad on the left; on the right its end 1 has two
  x << 0, 0, 0, 2, 0, 0, 2, -1, -1, 0, -1, -1, 0, 1, -1, 2, 1, -1, 4, 1, -1, 4, 0, 0;
  const QuadSurface roof(x, {{0, 3, 2, 1}, {1, 5, 4, 0}, {1, 7, 6, 5}});
  const PointArray u = offset_directions(roof);
  EXPECT_TRUE(u.row(1).isApprox(Eigen::RowVector3d(0, 0, std::sqrt(2)), 1e-12)) << u.row(1);
  EXPECT_TRUE(u.row(0).isApprox(u.row(1), 1e-12)) << u.row(0);
}

// 1 m of radius: the limit is the radius of curvature, of the sides for a prism.
TEST(Offset, KnowsHowFarItCanGo) {
  const QuadSurface sides = prism(16, 2, 1, 1);
  const OffsetLimits tube = offset_limits(sides, offset_directions(sides));
  EXPECT_NEAR(tube.inward, std::cos(pi / 16), 1e-12);
  EXPECT_EQ(tube.outward, kInfinity);
  const QuadSurface ball = sphere(12, 1);
  EXPECT_NEAR(offset_limits(ball, offset_directions(ball)).inward, 1, 0.01);
  // a saddle, z = (x^2 - y^2) / 2 r, folds on both sides
  const QuadSurface saddle = patch(20, 20, [](double u, double v) {
    const double x = u - 0.5, y = v - 0.5;
    return Vec3(x, y, (x * x - y * y) / (2 * 0.8));
  });
  const OffsetLimits both = offset_limits(saddle, offset_directions(saddle));
  EXPECT_NEAR(both.inward, 0.8, 0.03);
  EXPECT_NEAR(both.outward, 0.8, 0.03);
}

TEST(Offset, RefusesToFold) {
  const QuadSurface sides = prism(16, 2, 1, 1);
  EXPECT_GT(offset(sides, {0.95, 0, 4}).quality.min_scaled_jacobian, 0);
  EXPECT_TRUE(refuses_to_fold(sides, {1.1, 0, 4},
                              {"32 quads fold", "1.1 inward", "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, ...", "the worst is",
                               "scaled Jacobian of -", "less than 0.9808 inward and any distance outward"}));
  // through the centre of a sphere both directions turn over, and every corner of the hexahedra looks sound
  const QuadSurface ball = sphere(4, 1);
  EXPECT_TRUE(refuses_to_fold(ball, {2.5, 0, 1}, {"96 quads fold"}));
  EXPECT_TRUE(refuses_to_fold(ball, {2.5, -2, 1}, {"96 quads fold"}));
}

TEST(Offset, RefusesNumbersThatMeanNothing) {
  EXPECT_TRUE(refuses_to_fold(bent_sheet(), {0, 0, 1}, {"0 inward and 0 outward"}));
  EXPECT_TRUE(refuses_to_fold(bent_sheet(), {0.5, -0.5, 1}, {"their sum not 0"}));
  EXPECT_TRUE(refuses_to_fold(bent_sheet(), {0, kInfinity, 1}, {"inf outward", "must be finite"}));
  EXPECT_TRUE(refuses_to_fold(bent_sheet(), {0, 1, 0}, {"0 layers: at least 1"}));
  EXPECT_TRUE(refuses_to_fold(bent_sheet(), {0, 1, std::numeric_limits<int>::max()}, {"more nodes"}));
}

// A corner of a cube pulled out to a needle, and a roof whose two sides all but touch.
TEST(Offset, RefusesVerticesThatAreTooSharp) {
  const auto pulled = [](double length) {
    return box({1, 1, 1}, [&](const Vec3& p) { return Vec3(p.isOnes(0) ? length * p : p); });
  };
  const auto roof = [](double width) {
    return patch(2, 1, [&](double u, double v) { return Vec3(v, width * (2 * u - 1), -std::abs(2 * u - 1)); });
  };
  EXPECT_GT(offset_directions(pulled(3)).rowwise().norm().maxCoeff(), 2);
  EXPECT_TRUE(refuses<InputError>([&] { offset_directions(pulled(20)); }, {"1 vertices are too sharp", ": 7;"}));
  EXPECT_NEAR(offset_directions(roof(0.2)).rowwise().norm().maxCoeff(), std::sqrt(1 + 1 / 0.04), 1e-12);
  EXPECT_TRUE(refuses<InputError>([&] { offset_directions(roof(0.05)); }, {"2 vertices are too sharp", "1, 4;"}));
}

TEST(Offset, NamesTheWorstQuadsFirst) {
  const Shell shell = offset(
      box({3, 3, 3}, [](const Vec3& p) { return Vec3(p + (p == Vec3(1, 1, 3) ? Vec3(0.5, 0.4, 0) : Vec3(0, 0, 0))); }),
      {0, 0.2, 2});
  ASSERT_EQ(shell.worst_quads.size(), 5u);
  EXPECT_EQ(shell.quality.worst_element / 2, shell.worst_quads.front());
  std::vector<double> shapes;
  for (const int q : shell.worst_quads)
    shapes.push_back(scaled_jacobian(gather(shell.mesh.positions(), shell.mesh.hexahedra()[2 * q])));
  EXPECT_TRUE(std::ranges::is_sorted(shapes));
  EXPECT_LT(shapes.front(), 0.8);
}

// What multigrid rests on: neighbours across faces form lattices, around a closed tube too, and in the six parts of a
// sphere.
TEST(Offset, MakesShellsThatCoarsen) {
  const auto cells_after = [](const QuadSurface& surface, int layers) {
    const HexMesh mesh = offset(surface, {0, 0.1, layers}).mesh;
    const auto levels = Charts(mesh).levels;
    return levels.empty() ? 0 : mesh.num_elements() / static_cast<double>(levels.front().cells.size());
  };
  EXPECT_EQ(cells_after(prism(24, 16, 1, 3), 2), 8);
  EXPECT_EQ(cells_after(patch(16, 12, [](double u, double v) { return Vec3(u, v, u * v); }), 2), 8);
  EXPECT_EQ(cells_after(patch(16, 12, [](double u, double v) { return Vec3(u, v, u * v); }), 1), 4);
  EXPECT_GT(cells_after(sphere(8, 1), 2), 6);
}

// ---- the surface ----------------------------------------------------------------------------------------------------

TEST(QuadSurface, KnowsItsNeighboursAndWhetherItIsClosed) {
  const QuadSurface open = bent_sheet();
  EXPECT_FALSE(open.is_closed());
  EXPECT_EQ(open.incident(5).size(), 4u);
  EXPECT_EQ(open.incident(0).size(), 1u);
  EXPECT_TRUE(sphere(2, 1).is_closed());
}

TEST(QuadSurface, RefusesWhatIsNoSurface) {
  const QuadSurface good = bent_sheet();
  const auto refused = [&](const std::function<void(PointArray&, std::vector<Quad>&)>& change, Parts parts) {
    PointArray x = good.positions();
    std::vector<Quad> quads = good.quads();
    change(x, quads);
    return are_refused(x, quads, parts);
  };
  EXPECT_TRUE(refused([](auto&, auto& quads) { quads.clear(); }, {"without quads"}));
  EXPECT_TRUE(refused([](auto& x, auto&) { x(7, 1) = std::nan(""); }, {"1 vertices", "finite: 7;"}));
  EXPECT_TRUE(refused([](auto&, auto& quads) { quads[2][1] = 12; }, {"range: 2;", "[0, 12)"}));
  EXPECT_TRUE(refused([](auto&, auto& quads) { quads[2][1] = -1; }, {"range: 2;"}));
  EXPECT_TRUE(refused([](auto&, auto& quads) { quads[4][1] = quads[4][3]; }, {"twice: 4;"}));
  EXPECT_TRUE(refused([](auto&, auto& quads) { quads.erase(quads.begin()); }, {"without a quad: 0;"}));
  EXPECT_TRUE(refused([](auto& x, auto&) { x.row(3) = x.row(8); }, {"duplicate vertices: 3, 8;"}));
}

// A seam: neighbours with vertices of their own at the same places.
TEST(QuadSurface, RefusesSeams) {
  PointArray x(8, 3);
  x << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1 + 1e-12, 0;
  EXPECT_TRUE(are_refused(x, {{0, 1, 2, 3}, {4, 5, 6, 7}}, {"4 duplicate vertices: 1, 2, 4, 7;", "must share"}));
}

TEST(QuadSurface, RefusesEdgesAndVerticesThatAreNoManifold) {
  PointArray x(8, 3);
  x << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0, 1, 0, 1, 1, 1, 1;
  // three quads at the edge from 1 to 2
  EXPECT_TRUE(are_refused(x, {{0, 1, 2, 3}, {1, 4, 5, 2}, {1, 6, 7, 2}},
                          {"3 quads meet more than one other quad", "0, 1, 2;"}));
  EXPECT_TRUE(are_refused(x.topRows(6), {{0, 1, 2, 3}, {2, 5, 4, 1}},
                          {"2 quads have a neighbour of the other orientation: 0, 1;"}));
  EXPECT_TRUE(are_refused(x.topRows(4), {{0, 1, 2, 3}, {0, 1, 2, 3}}, {"orientation"}));
  // two quads that meet in vertex 2 only
  PointArray tip(7, 3);
  tip << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 1, 0, 2, 2, 0, 1, 2, 0;
  EXPECT_TRUE(are_refused(tip, {{0, 1, 2, 3}, {2, 4, 5, 6}}, {"1 vertices join quads that share no edge there: 2;"}));
}

// A closed surface pinched in a vertex, where one full fan of quads touches another.
TEST(QuadSurface, RefusesClosedFansThatTouch) {
  const QuadSurface cube = box({2, 2, 2}, [](const Vec3& p) { return p; });
  const int n = cube.num_vertices();
  int tip = 0;
  while (!cube.positions().row(tip).isApprox(Eigen::RowVector3d(2, 2, 2))) ++tip;
  PointArray x(2 * n, 3);
  x << cube.positions(), (-cube.positions()).rowwise() + Eigen::RowVector3d(4, 4, 4);
  std::vector<Quad> quads = cube.quads();
  for (Quad quad : cube.quads()) {
    std::ranges::reverse(quad);
    for (int& vertex : quad) vertex = vertex == tip ? tip : vertex + n - (vertex > tip);
    quads.push_back(quad);
  }
  PointArray without_twin(2 * n - 1, 3);
  without_twin << x.topRows(n + tip), x.bottomRows(n - tip - 1);
  EXPECT_TRUE(are_refused(without_twin, quads, {"1 vertices join", std::to_string(tip)}));
}

TEST(QuadSurface, RefusesQuadsOfNoShape) {
  const auto refused = [](const Vec3& last) {
    PointArray x(4, 3);
    x << 0, 0, 0, 1, 0, 0, 1, 1, 0, last.transpose();
    return are_refused(x, {{0, 1, 2, 3}}, {"flat, concave or twisted at a corner: 0;"});
  };
  EXPECT_FALSE(refused({0, 1, 0.9}));
  for (const Vec3& last : {Vec3(0.5, 0.5, 0), Vec3(0.8, 0.4, 0), Vec3(1.5, 0.5, 0), Vec3(2, 0.5, 9)})
    EXPECT_TRUE(refused(last)) << last.transpose();
}

TEST(QuadSurface, IsWhatAMeshFileHolds) {
  const std::string plane = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\n";
  EXPECT_EQ(surface_of(parse_obj(plane + "f 2 5 6 3\n", "a.obj")).num_quads(), 2);
  EXPECT_TRUE(refuses<InputError>([&] { surface_of(parse_obj(plane + "f 2 5 6\n", "a.obj")); },
                                  {"1 triangles", "1 quads", "vertices 1, 4, 5", "must be quads"}));
  EXPECT_TRUE(refuses<InputError>([&] { surface_of(parse_obj(plane, "a.obj")); }, {"without a quad: 4, 5;"}));
}

}  // namespace
}  // namespace hexaplast
