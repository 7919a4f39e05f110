// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/plane_cut.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

const Vec3 kDiagonal = Vec3(1, 1, 1).normalized();
const double kHexagon = 3 * std::sqrt(3.0) / 4;  // cut of the unit cube through its centre, across its diagonal

PlaneCut cut(const HexMesh& mesh, const Plane& plane, std::span<const unsigned char> alive = {}) {
  return PlaneCut(mesh.positions(), mesh.hexahedra(), plane, alive);
}

PointArray points_of(const PlaneCut& cut, const PointArray& nodes) {
  PointArray points(cut.num_points(), 3);
  cut.apply(nodes, points);
  return points;
}

double length(const std::vector<Edge>& lines, const PointArray& points) {
  double sum = 0;
  for (const auto& [a, b] : lines) sum += (points.row(a) - points.row(b)).norm();
  return sum;
}

TEST(PlaneCut, AreasOfManyHexahedraAddUpToThatOfTheBlock) {
  const HexMesh mesh = block({3, 4, 5}, 0.1);
  const PlaneCut aslant = cut(mesh, {Vec3(3, 0, 4) / 5, 0.33});
  // through x = 0 at z = 0.4125 and through x = 0.3 at z = 0.1875
  EXPECT_NEAR(aslant.area(), 0.4 * std::hypot(0.3, 0.225), 1e-15);
  EXPECT_NEAR(length(aslant.outline(), points_of(aslant, mesh.positions())), 2 * (0.4 + 0.375), 1e-14);
}

// Area vectors transform by the cofactor: the cut of the cube's image by normal . x = d has the area of the cube's cut
// times det A / |A^T normal|.
TEST(PlaneCut, OfAParallelepipedIsExact) {
  Mat3 A;
  A << 1.2, 0.3, -0.1, 0.2, 0.9, 0.4, -0.3, 0.1, 1.5;
  const HexMesh cube = block({2, 2, 2}, 0.5);
  const HexMesh mesh(mapped(cube.positions(), A), cube.hexahedra());
  const Vec3 normal = (A.transpose().inverse() * Vec3(1, 1, 1)).normalized();  // so that A^T normal is diagonal
  const double size = (A.transpose() * normal).norm();
  const PlaneCut image = cut(mesh, {normal, size * std::sqrt(3.0) / 2});
  EXPECT_NEAR(image.area(), kHexagon * A.determinant() / size, 1e-14);
}

// Areas along a line add up to the volume. Between two heights of corners or of their means the area is a quadratic, so
// that Simpson's rule is exact.
TEST(PlaneCut, AreasOfAWarpedHexahedronAddUpToItsExactVolume) {
  const ElementPoints x = distorted_hexahedron(1, 0.2, 7);
  const HexMesh mesh = single_element(x);
  const Vec3 normal = Vec3(0.3, -0.5, 0.8).normalized();
  std::vector<double> heights;
  const auto add_mean = [&](std::span<const int> corners) {
    Vec3 mean = Vec3::Zero();
    for (const int corner : corners) mean += x.row(corner).transpose() / static_cast<double>(corners.size());
    heights.push_back(normal.dot(mean));
  };
  const Hexahedron all{0, 1, 2, 3, 4, 5, 6, 7};
  add_mean(all);
  for (const int& corner : all) add_mean({&corner, 1});
  for (const auto& face : kFaces) add_mean(face);
  std::ranges::sort(heights);

  double sum = 0;
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    const double from = heights[k], width = heights[k + 1] - from;
    const auto area = [&](double fraction) { return cut(mesh, {normal, from + fraction * width}).area(); };
    // at a height itself nothing jumps
    sum += width * (area(1e-12) + 4 * area(0.5) + area(1 - 1e-12)) / 6;
  }
  EXPECT_NEAR(sum, volume(x), 1e-10);
}

TEST(PlaneCut, OfAWarpedHexahedronIsBetterInMoreParts) {
  const HexMesh mesh = single_element(distorted_hexahedron(1, 0.3, 9));
  const Plane plane{Vec3(1, 2, 3).normalized(), 0.05};
  const auto area = [&](int parts) { return PlaneCut(mesh.positions(), mesh.hexahedra(), plane, {}, parts).area(); };
  const double best = area(32), one = std::abs(area(1) - best), four = std::abs(area(4) - best);
  EXPECT_GT(one, 1e-4);
  EXPECT_LT(four, one / 8);

  const HexMesh flat = block({2, 2, 2}, 0.5);
  const PlaneCut parted(flat.positions(), flat.hexahedra(), {kDiagonal, std::sqrt(3.0) / 2}, {}, 3);
  EXPECT_NEAR(parted.area(), kHexagon, 1e-14);
  EXPECT_NEAR(length(parted.outline(), points_of(parted, flat.positions())), 3 * std::sqrt(2.0), 1e-13);
  EXPECT_NEAR(length(parted.inner_lines(), points_of(parted, flat.positions())), 3 * std::sqrt(2.0) / 2 * 2, 1e-13);
}

TEST(PlaneCut, PointsLieInThePlaneAndCarryFields) {
  const HexMesh mesh = distorted_block({3, 2, 4}, 0.5, 0.15, 41);
  const Plane plane{Vec3(1, 2, 3).normalized(), 1.1};
  const PlaneCut warped = cut(mesh, plane);
  ASSERT_GT(warped.num_points(), 20);
  const PointArray points = points_of(warped, mesh.positions());
  for (Eigen::Index n = 0; n < points.rows(); ++n) EXPECT_NEAR(plane.height(points.row(n).transpose()), 0, 1e-14);

  Mat3 A;
  A << 2, 1, 0, -1, 3, 1, 0.5, 0, -2;
  const PointArray field = mapped(mesh.positions(), A, Vec3(1, 2, 3));
  EXPECT_LE(max_abs(points_of(warped, field) - mapped(points, A, Vec3(1, 2, 3))), 1e-13);

  for (const auto& [a, b, c] : warped.triangles()) {
    const Vec3 normal = (points.row(b) - points.row(a)).cross(points.row(c) - points.row(a)).transpose();
    EXPECT_GE(normal.dot(plane.normal), 0);
  }
}

// Every place of the outline has one line that comes and one that goes: there is no gap between neighbours.
TEST(PlaneCut, OutlineOfAWarpedBlockIsClosed) {
  const HexMesh mesh = distorted_block({3, 2, 4}, 0.5, 0.15, 43);
  const PlaneCut warped(mesh.positions(), mesh.hexahedra(), {Vec3(1, 2, 3).normalized(), 1.1}, {}, 2);
  const PointArray points = points_of(warped, mesh.positions());
  const auto lines_at = [&](int point) {
    int count = 0;
    for (const Edge& line : warped.outline())
      for (const int end : line) count += (points.row(end) - points.row(point)).norm() < 1e-12;
    return count;
  };
  ASSERT_GT(warped.outline().size(), 20u);
  for (const auto& [a, b] : warped.outline()) {
    EXPECT_EQ(lines_at(a), 2);
    EXPECT_EQ(lines_at(b), 2);
  }
}

TEST(PlaneCut, AlongFacesBelongsToWhatIsBelow) {
  const HexMesh mesh = block({2, 2, 3}, 1);
  const std::vector<unsigned char> upper{0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
  EXPECT_DOUBLE_EQ(cut(mesh, {Vec3::UnitZ(), 1}).area(), 4);
  EXPECT_DOUBLE_EQ(cut(mesh, {Vec3::UnitZ(), 3}).area(), 4);
  EXPECT_DOUBLE_EQ(cut(mesh, {Vec3::UnitZ(), 0}).area(), 0);
  EXPECT_DOUBLE_EQ(cut(mesh, {Vec3::UnitZ(), 1}, upper).area(), 0);
  EXPECT_DOUBLE_EQ(cut(mesh, {-Vec3::UnitZ(), -1}, upper).area(), 4);
}

// Planes through the nodes, and through the divisions of hexahedra, of a block that stands aslant: all heights there
// are ones of rounding, of either sign.
TEST(PlaneCut, HasNoHolesWhereRoundingDecides) {
  const HexMesh upright = block({3, 4, 7}, 0.1);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const HexMesh mesh(mapped(upright.positions(), turn, Vec3(0.3, 0.1, -0.2)), upright.hexahedra());
  const Vec3 normal = turn.col(2);
  for (const double place : {0.1, 0.3, 0.325, 0.35, 0.4, 0.6})
    for (const int parts : {1, 2, 4}) {
      const double offset = place + normal.dot(Vec3(0.3, 0.1, -0.2));
      const PlaneCut across(mesh.positions(), mesh.hexahedra(), {normal, offset}, {}, parts);
      EXPECT_NEAR(across.area(), 0.12, 1e-12) << place << " in " << parts;
    }
}

// The middle layer of nodes of a block lies in the plane but for a millionth of an edge, as it does after a run. What
// is cut are the faces of the layer, and what is drawn are their edges.
TEST(PlaneCut, AlmostAlongALayerOfFacesShowsTheirEdges) {
  constexpr double kCell = 0.1, kOff = 1e-7;
  const HexMesh even = block({4, 3, 5}, kCell);
  PointArray x = even.positions();
  Random random(17);
  for (Eigen::Index n = 0; n < x.rows(); ++n)
    if (std::abs(x(n, 0) - 2 * kCell) < kCell / 2) x(n, 0) += kOff * random.uniform(-1, 1);
  const HexMesh mesh(x, even.hexahedra());
  const Plane plane{Vec3::UnitX(), 2 * kCell};
  const double edges_inside = 2 * 0.5 + 4 * 0.3;  // [m] of the lines between 3 x 5 squares

  const PlaneCut exact(x, mesh.hexahedra(), plane, {}, 4);
  EXPECT_NEAR(exact.area(), 0.15, 1e-9);
  EXPECT_GT(length(exact.inner_lines(), points_of(exact, x)), 1.5 * edges_inside) << "where it crosses the layer";

  for (const int parts : {1, 4}) {
    const PlaneCut along(x, mesh.hexahedra(), plane, {}, parts, 10 * kOff);
    const PointArray points = points_of(along, x);
    EXPECT_NEAR(along.area(), 0.15, 1e-9) << parts;
    EXPECT_NEAR(length(along.inner_lines(), points), edges_inside, 1e-9) << parts;
    EXPECT_NEAR(length(along.outline(), points), 1.6, 1e-9) << parts;
    EXPECT_LE((points.col(0).array() - 2 * kCell).abs().maxCoeff(), kOff) << parts;
    for (const std::vector<Edge>* lines : {&along.inner_lines(), &along.outline()})
      for (const Edge& line : *lines) {
        const int a = line[0], b = line[1];
        const auto is_along_edges = [&](int across) {
          const double cells = points(a, across) / kCell;
          return std::abs(points(a, across) - points(b, across)) < 1e-15 && std::abs(cells - std::round(cells)) < 1e-12;
        };
        EXPECT_TRUE(is_along_edges(1) || is_along_edges(2)) << points.row(a) << " to " << points.row(b);
      }
  }
}

TEST(PlaneCut, LeavesOutWhatIsRemoved) {
  const HexMesh mesh = block({2, 2, 1}, 1);
  const std::vector<unsigned char> alive{1, 0, 1, 1};
  const PlaneCut rest = cut(mesh, {Vec3::UnitZ(), 0.5}, alive);
  EXPECT_DOUBLE_EQ(rest.area(), 3);
  const PointArray points = points_of(rest, mesh.positions());
  EXPECT_NEAR(length(rest.outline(), points), 8, 1e-14);
  EXPECT_NEAR(length(rest.inner_lines(), points), 2, 1e-14);
}

TEST(PlaneCut, MeetsHexahedraWithinTheirExtent) {
  const HexMesh mesh = block({2, 1, 1}, 1);
  const Vec3 normal = Vec3(3, 0, -4) / 5;
  const auto [min, max] = extent_along(normal, mesh.positions(), mesh.hexahedra());
  EXPECT_DOUBLE_EQ(min, -0.8);
  EXPECT_DOUBLE_EQ(max, 1.2);
  EXPECT_EQ(extent_along(normal, mesh.positions(), mesh.hexahedra(), std::vector<unsigned char>{1, 0}).second, 0.6);
  EXPECT_EQ(extent_along(normal, mesh.positions(), {}), std::pair(0.0, 0.0));
  EXPECT_EQ(cut(mesh, {normal, -0.81}).area(), 0);
  EXPECT_GT(cut(mesh, {normal, -0.79}).area(), 0);
}

}  // namespace
}  // namespace hexaplast
