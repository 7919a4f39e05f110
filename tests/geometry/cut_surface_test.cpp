// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/cut_surface.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "hexaplast/mesh/blade.hpp"

namespace hexaplast {
namespace {

/// Cubes of edge 1 whose centres lie where `has` says so.
template <class Has>
HexMesh cubes(const std::array<int, 3>& n, const Has& has) {
  std::map<std::array<int, 3>, int> number;
  std::vector<std::array<int, 3>> nodes;
  std::vector<Hexahedron> hexahedra;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        if (!has(Vec3(i + 0.5, j + 0.5, k + 0.5))) continue;
        Hexahedron corners;
        for (int a = 0; a < kCorners; ++a) {
          const std::array<int, 3> at{i + (kCornerSign[a][0] + 1) / 2, j + (kCornerSign[a][1] + 1) / 2,
                                      k + (kCornerSign[a][2] + 1) / 2};
          const auto [entry, is_new] = number.emplace(at, static_cast<int>(nodes.size()));
          if (is_new) nodes.push_back(at);
          corners[a] = entry->second;
        }
        hexahedra.push_back(corners);
      }
  PointArray x(std::ssize(nodes), 3);
  for (std::size_t p = 0; p < nodes.size(); ++p)
    x.row(static_cast<Eigen::Index>(p)) << nodes[p][0], nodes[p][1], nodes[p][2];
  return {x, hexahedra};
}

/// A mesh that blades cut, call by call.
struct Cutting {
  explicit Cutting(HexMesh mesh)
      : initial(std::move(mesh)),
        joints(initial),
        copies(initial.num_nodes()),
        hexahedra(initial.hexahedra()),
        is_open(joints.count(), 0),
        cut(initial, joints),
        volume(initial.num_elements(), 1) {}

  /// A blade with these points moves by `way`.
  void pass(const PointArray& points, const Vec3& way) {
    PointArray x = initial.positions()(copies.initial(), Eigen::all);
    const std::vector<BladeAt> blade{{0, points}, {1, points.rowwise() + way.transpose()}};
    const std::vector<int> met = cut.opened(hexahedra, x, x, blade, is_open);
    opened.insert(opened.end(), met.begin(), met.end());
    crossings.insert(crossings.end(), cut.crossings().begin(), cut.crossings().end());
    const int end = static_cast<int>(met.size());
    if (end > 0) copies.split(initial, joints, met, {&end, 1}, is_open, volume, hexahedra);
  }

  HexMesh mesh() const { return {initial, copies.initial(), hexahedra}; }
  OpenFaces faces() const { return open_faces(joints, copies, opened, crossings, initial.num_elements()); }

  HexMesh initial;
  Joints joints;
  NodeCopies copies;
  std::vector<Hexahedron> hexahedra;
  std::vector<unsigned char> is_open;
  BladeCut cut;
  std::vector<double> volume;
  std::vector<int> opened;
  std::vector<double> crossings;
};

PointArray line(std::initializer_list<Vec3> points) {
  PointArray rows(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::Index n = 0;
  for (const Vec3& point : points) rows.row(n++) = point.transpose();
  return rows;
}

std::set<Edge> boundary_edges(std::span<const Quad> faces) {
  std::set<Edge> odd;
  for (const Quad& face : faces)
    for (int k = 0; k < 4; ++k)
      if (const Edge edge = sorted(Edge{face[k], face[(k + 1) % 4]}); edge[0] != edge[1] && !odd.insert(edge).second)
        odd.erase(edge);
  return odd;
}

double enclosed(const PointArray& x, std::span<const Quad> faces) {
  double sum = 0;
  const auto at = [&](int n) -> Vec3 { return x.row(n).transpose(); };
  for (const auto& [a, b, c, d] : faces) {
    const Vec3 middle = (at(a) + at(b) + at(c) + at(d)) / 4;
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, d), std::pair(d, a)})
      sum += at(p).dot(at(q).cross(middle)) / 6;
  }
  return sum;
}

/// A ball as an octahedron whose triangles are divided.
CarriedSurface ball(const Vec3& centre, double radius, int parts) {
  std::map<std::array<int, 3>, int> number;
  CarriedSurface ball;
  std::vector<Vec3> points;
  const auto at = [&](const std::array<int, 3>& p) {
    const auto [entry, is_new] = number.emplace(p, static_cast<int>(points.size()));
    if (is_new) points.emplace_back(centre + radius * Vec3(p[0], p[1], p[2]).normalized());
    return entry->second;
  };
  for (const int sx : {-1, 1})
    for (const int sy : {-1, 1})
      for (const int sz : {-1, 1})
        for (int i = 0; i < parts; ++i)
          for (int j = 0; i + j < parts; ++j) {
            const auto p = [&](int a, int b) { return at({sx * a, sy * b, sz * (parts - a - b)}); };
            const auto add = [&](int a, int b, int c) {
              sx* sy* sz > 0 ? ball.faces.push_back({a, b, c, c}) : ball.faces.push_back({a, c, b, b});
            };
            add(p(i, j), p(i + 1, j), p(i, j + 1));
            if (i + j + 1 < parts) add(p(i + 1, j), p(i + 1, j + 1), p(i, j + 1));
          }
  ball.points.resize(std::ssize(points), 3);
  for (std::size_t k = 0; k < points.size(); ++k) ball.points.row(static_cast<Eigen::Index>(k)) = points[k].transpose();
  return ball;
}

const Vec3 kCentre(8.1, 7.9, 8.05);
const CarriedSurface kBall = ball(kCentre, 6.3, 16);

/// The cubes around it.
Cutting ball_cage() {
  return Cutting(cubes({16, 16, 16}, [&](const Vec3& middle) { return (middle - kCentre).norm() < 7.25; }));
}

CarriedSurface skin_of(const Cutting& cutting, const CarriedSurface& whole, std::span<const unsigned char> alive = {}) {
  const HexMesh mesh = cutting.mesh();
  const OpenFaces open = cutting.faces();
  const CutWalls walls(mesh, open, alive);
  const Embedding embedding(mesh.positions(), mesh.hexahedra(), whole.points);
  return cut_skin(walls, whole.points, whole.faces, embedding, 0, mesh.num_elements());
}

void expect_whole(const CarriedSurface& surface, const CarriedSurface& before) {
  EXPECT_TRUE(boundary_edges(surface.faces).empty());
  EXPECT_NEAR(enclosed(surface.points, surface.faces) / enclosed(before.points, before.faces), 1, 0.005);
}

PointArray random_blade(std::mt19937& random, const Vec3& centre, double reach, Vec3& way) {
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
  way = direction();
  const Vec3 across = way.cross(direction()).normalized(), third = way.cross(across);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  const double bend = uniform(random);
  const Vec3 middle = centre + reach * (0.6 * uniform(random) * third) - 1.5 * reach * way;
  PointArray points(9, 3);
  for (int k = 0; k < 9; ++k) {
    const double s = (k - 4) / 4.0;
    points.row(k) = (middle + 1.5 * reach * s * across + reach * bend * s * s * third).transpose();
  }
  // to the end, or into the body
  way *= reach * (uniform(random) > 0 ? 3.2 : 1.5 + uniform(random));
  return points;
}

TEST(CutWalls, AnObliquePlaneIsAPlane) {
  Cutting block(cubes({6, 6, 6}, [](const Vec3&) { return true; }));
  const Vec3 normal = Vec3(1, 0.5, 0.3).normalized();
  const Vec3 across = normal.cross(Vec3(0, 0, 1)).normalized(), way = across.cross(normal);
  const Vec3 middle(3.1, 3.05, 2.9);
  block.pass(line({middle - 10 * across - 10 * way, middle + 10 * across - 10 * way}), 20 * way);
  const HexMesh mesh = block.mesh();
  const OpenFaces open = block.faces();
  const CutWalls walls(mesh, open);
  ASSERT_FALSE(walls.empty());
  int count = 0;
  for (const auto& [initial, node] : walls.nodes()) {
    EXPECT_TRUE(node.is_split());
    const Vec3 x = mesh.positions().row(initial).transpose();
    const int borders = static_cast<int>((x.array() == 0 || x.array() == 6).count());
    EXPECT_LE(((node.place - x).array() != 0 && (x.array() == 0 || x.array() == 6)).count(), 0);
    if (borders > 1) continue;
    ++count;
    EXPECT_NEAR(normal.dot(node.place - middle), 0, 0.06) << x.transpose();
  }
  EXPECT_GT(count, 30);
}

TEST(CutWalls, RandomCutsOfABlockKeepItsOutlineAndVolume) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    Cutting block(cubes({7, 6, 5}, [](const Vec3&) { return true; }));
    for (int cuts = 1 + trial % 3; cuts > 0; --cuts) {
      Vec3 way;
      const PointArray blade = random_blade(random, {3.5, 3, 2.5}, 5, way);
      block.pass(blade, way);
    }
    const HexMesh mesh = block.mesh();
    const OpenFaces open = block.faces();
    const WallVertices walls = wall_vertices(CutWalls(mesh, open));
    const Embedding embedding(mesh.positions(), mesh.hexahedra(), walls.points, walls.hexahedron);
    PointArray x = mesh.positions(), moved(walls.points.rows(), 3);
    embedding.apply(mesh.positions(), moved);
    for (std::size_t k = 0; k < walls.node.size(); ++k) x.row(walls.node[k]) = moved.row(static_cast<Eigen::Index>(k));
    SCOPED_TRACE(fmt::format("trial {}, {} open, {} nodes on walls", trial, block.opened.size(), walls.node.size()));
    const std::vector<Quad> faces = mesh.boundary_faces();
    EXPECT_TRUE(boundary_edges(faces).empty());
    EXPECT_NEAR(enclosed(x, faces), 7 * 6 * 5, 1e-9);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(x.col(axis).minCoeff(), 0, 1e-12);
      EXPECT_NEAR(x.col(axis).maxCoeff(), 7 - axis, 1e-12);
    }
  }
}

TEST(CutSkin, RandomCutsLeaveAClosedSurfaceOfTheSameVolume) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Cutting cage = ball_cage();
    for (int cuts = 1 + trial % 3; cuts > 0; --cuts) {
      Vec3 way;
      const PointArray blade = random_blade(random, kCentre, 7, way);
      cage.pass(blade, way);
      const CarriedSurface skin = skin_of(cage, kBall);
      SCOPED_TRACE(fmt::format("trial {}, {} open, {} faces", trial, cage.opened.size(), skin.faces.size()));
      expect_whole(skin, kBall);
    }
  }
}

// Where they cross, a wall on one side of which the skin closes otherwise would add its volume or take it away. Of 200,
// a lip or two may find no way along walls that both sides have.
TEST(CutSkin, PlanesThatCrossKeepTheVolumeOfCoarseCages) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  int num_off = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::array<int, 3> n{3 + trial % 3, 3 + trial / 3 % 3, 3 + trial / 9 % 3};
    const Vec3 size(n[0], n[1], n[2]);
    Cutting cage(cubes(n, [](const Vec3&) { return true; }));
    const CarriedSurface whole = ball(size / 2, 0.36 * size.minCoeff(), 6);
    for (int cuts = 0; cuts < 2 + trial % 2; ++cuts) {
      const Vec3 way = vector().normalized(), across = way.cross(vector()).normalized();
      const Vec3 begin = size / 2 + 0.4 * vector() - 8 * way;
      cage.pass(line({begin - 8 * across, begin + 8 * across}), (8 + normal(random)) * way);
    }
    const CarriedSurface skin = skin_of(cage, whole);
    EXPECT_TRUE(boundary_edges(skin.faces).empty()) << trial;
    num_off += std::abs(enclosed(skin.points, skin.faces) / enclosed(whole.points, whole.faces) - 1) > 0.005;
  }
  EXPECT_LE(num_off, 2);
}

// Within the body, up to its skin, and all of a lip.
TEST(CutSkin, RemovedHexahedraBesideTheCutLeaveItClosed) {
  Cutting cage = ball_cage();
  cage.pass(line({{-1, -1, 6.2}, {17, -1, 10.1}}), Vec3(0, 18, 1));
  const HexMesh mesh = cage.mesh();
  const OpenFaces open = cage.faces();
  const CutWalls walls(mesh, open);
  std::size_t num_before = 0;
  for (const double reach : {2.0, 3.5, 6.5, 9.0}) {
    std::vector<unsigned char> alive(static_cast<std::size_t>(mesh.num_elements()), 1);
    for (const CutWalls::Wall& wall : walls.walls()) {
      const Vec3 middle = gather(mesh.positions(), mesh.hexahedra()[wall.hexahedron]).colwise().mean();
      // those above it
      if ((middle - kCentre).norm() < reach && middle.z() > 6.2 + 3.9 / 18 * (middle.x() + 1) + (middle.y() + 1) / 18)
        alive[wall.hexahedron] = 0;
    }
    const auto num_removed = static_cast<std::size_t>(std::ranges::count(alive, 0));
    SCOPED_TRACE(fmt::format("{} removed", num_removed));
    EXPECT_GT(num_removed, std::exchange(num_before, num_removed));
    expect_whole(skin_of(cage, kBall, alive), kBall);
  }
}

/// A box of twelve triangles, or of eight where it has no ends.
CarriedSurface box(const Vec3& lower, const Vec3& upper, bool has_ends) {
  CarriedSurface box;
  box.points.resize(8, 3);
  for (int n = 0; n < 8; ++n)
    for (int i = 0; i < 3; ++i) box.points(n, i) = (n >> i & 1) != 0 ? upper[i] : lower[i];
  for (const Quad& q : {Quad{0, 1, 5, 4}, Quad{2, 6, 7, 3}, Quad{0, 2, 3, 1}, Quad{4, 5, 7, 6}, Quad{0, 4, 6, 2},
                        Quad{1, 3, 7, 5}}) {  // the ends last
    box.faces.push_back({q[0], q[1], q[2], q[2]});
    box.faces.push_back({q[0], q[2], q[3], q[3]});
  }
  if (!has_ends) box.faces.resize(8);
  return box;
}

TEST(CutSkin, OfFewTrianglesIsCutAndOpenEndsStayOpen) {
  const Vec3 lower(0.4, 0.4, 0.4), upper(11.6, 4.6, 4.6);
  for (const bool has_ends : {true, false}) {
    const CarriedSurface whole = box(lower, upper, has_ends);
    Cutting bar(cubes({12, 5, 5}, [](const Vec3&) { return true; }));
    bar.pass(line({{6.2, -1, -1}, {6.7, -1, 6}}), Vec3(0, 7, 0));
    const CarriedSurface skin = skin_of(bar, whole);
    EXPECT_GT(std::ranges::count(skin.is_wall, 1), 20);
    if (has_ends) expect_whole(skin, whole);
    for (const Edge& edge : boundary_edges(skin.faces))
      for (const int p : edge)
        EXPECT_TRUE(skin.points(p, 0) == lower.x() || skin.points(p, 0) == upper.x()) << has_ends;
  }
}

TEST(CutSkin, PointsOfALipCoincideAtRest) {
  Cutting cage = ball_cage();
  cage.pass(line({{-1, -1, 6.2}, {17, -1, 10.1}}), Vec3(0, 18, 1));
  const CarriedSurface skin = skin_of(cage, kBall);
  const HexMesh mesh = cage.mesh();
  const Embedding embedding(mesh.positions(), mesh.hexahedra(), skin.points, skin.hexahedron);
  PointArray rest(skin.points.rows(), 3);
  embedding.apply(mesh.positions(), rest);
  EXPECT_LT((rest - skin.points).cwiseAbs().maxCoeff(), 1e-12);
  // each wall lies on another one
  std::map<std::array<double, 3>, int> walls;
  for (std::size_t f = 0; f < skin.faces.size(); ++f) {
    if (!skin.is_wall[f] || skin.faces[f][2] == skin.faces[f][3]) continue;  // strips may be divided in another way
    Vec3 middle = Vec3::Zero();
    for (const int p : skin.faces[f]) middle += rest.row(p).transpose();
    ++walls[{std::round(1e9 * middle.x()), std::round(1e9 * middle.y()), std::round(1e9 * middle.z())}];
  }
  EXPECT_GT(walls.size(), 20u);
  for (const auto& [middle, count] : walls)
    EXPECT_EQ(count % 2, 0) << middle[0] << " " << middle[1] << " " << middle[2];
}

}  // namespace
}  // namespace hexaplast
