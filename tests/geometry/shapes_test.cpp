// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/shapes.hpp"

#include "hexaplast/mesh/quality.hpp"
#include "layout/charts.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

using std::numbers::pi;

TEST(Sheet, IsABoxUnlessItIsBent) {
  const HexMesh flat = sheet({4, 3, 2}, {0.4, 0.6}, 0.01);
  EXPECT_EQ(flat.num_nodes(), 5 * 4 * 3);
  EXPECT_TRUE(flat.positions().row(0).isApprox(Eigen::RowVector3d(-0.2, -0.3, -0.005)));
  EXPECT_TRUE(flat.positions().row(1 + 5 * (2 + 4 * 2)).isApprox(Eigen::RowVector3d(-0.1, 0.1, 0.005)));
  EXPECT_NEAR(quality(flat).volume, 0.4 * 0.6 * 0.01, 1e-15);
  EXPECT_NEAR(quality(flat).min_scaled_jacobian, 1, 1e-12);
}

// A ring's sector keeps the volume of the sheet, as its middle keeps its length; chords lose what a polygon does.
TEST(Sheet, BendsAboutItsMiddle) {
  const double radius = 0.5, length = 1.2, thickness = 0.1;
  for (const double side : {1., -1.}) {
    const HexMesh bent = sheet({12, 2, 2}, {length, 0.3}, thickness, side / radius);
    const double step = length / radius / 12;
    EXPECT_NEAR(quality(bent).volume, length * 0.3 * thickness * std::sin(step) / step, 1e-15);
    const Vec3 axis(0, 0, -side * radius);
    for (int n = 0; n < bent.num_nodes(); ++n) {
      Vec3 from_axis = bent.positions().row(n).transpose() - axis;
      from_axis.y() = 0;
      const double above = thickness * (n / (13 * 3) - 1) / 2;  // the middle: of layer n / 39
      EXPECT_NEAR(from_axis.norm(), radius + side * above, 1e-14);
    }
    EXPECT_LT(side * bent.positions()(13 * 3, 2), -0.1) << "the ends sink";
  }
}

TEST(Tube, HasTheVolumeOfItsPrisms) {
  const HexMesh mesh = tube({2, 12, 5}, 0.1, 0.15, arc(0.7, 0, 6));
  EXPECT_EQ(mesh.num_nodes(), 3 * 12 * 6);
  EXPECT_EQ(mesh.num_elements(), 2 * 12 * 5);
  EXPECT_NEAR(quality(mesh).volume, 12 * std::sin(2 * pi / 12) / 2 * (0.15 * 0.15 - 0.1 * 0.1) * 0.7, 1e-15);
  EXPECT_TRUE(mesh.positions().row(0).isApprox(Eigen::RowVector3d(0.1, 0, 0)));
  EXPECT_TRUE(mesh.positions().row(2 + 3 * (3 + 12 * 5)).isApprox(Eigen::RowVector3d(0, 0.15, 0.7), 1e-14));
  EXPECT_EQ(mesh.boundary_faces().size(), 2u * (12 * 5 + 2 * 12));
}

// Pappus: the section's area times the way of its centre. The error falls with the square of the cells' size.
TEST(Tube, BentAlongAnArcApproachesASectorOfATorus) {
  const auto error = [](int n) {
    const HexMesh mesh = tube({n, 8 * n, 12 * n}, 0.1, 0.2, arc(1.5, 1.5 * pi, 12 * n + 1));
    return std::abs(quality(mesh).volume / (pi * (0.2 * 0.2 - 0.1 * 0.1) * 1.5) - 1);
  };
  EXPECT_LT(error(2), 0.035);
  EXPECT_NEAR(std::log2(error(1) / error(2)), 2, 0.1);
}

TEST(Arc, EndsWhereTheCircleDoes) {
  const Centreline quarter = arc(pi, pi / 2, 9);  // of radius 2
  EXPECT_TRUE(quarter.points.row(8).isApprox(Eigen::RowVector3d(2, 0, 2), 1e-14));
  EXPECT_TRUE(quarter.tangents.row(8).isApprox(Eigen::RowVector3d(1, 0, 0), 1e-14));
  for (int k = 0; k < 9; ++k) EXPECT_NEAR((quarter.points.row(k) - Eigen::RowVector3d(2, 0, 0)).norm(), 2, 1e-14);
  EXPECT_TRUE(arc(3, 0, 4).points.row(2).isApprox(Eigen::RowVector3d(0, 0, 2), 1e-14));
}

// Against a frame that is known: about a helix, Frenet's frame turns by the torsion times the length, and ours not.
TEST(Tube, DoesNotTwistAboutAHelix) {
  const double radius = 0.5, rise = 0.2, scale = std::hypot(radius, rise), torsion = rise / (scale * scale);
  const int sections = 240;
  Centreline helix{PointArray(sections + 1, 3), PointArray(sections + 1, 3)};
  const double turns = 2 * pi * 1.25;
  const auto inward = [&](double t) { return Vec3(-std::cos(t), -std::sin(t), 0); };  // Frenet's normal
  for (int k = 0; k <= sections; ++k) {
    const double t = turns * k / sections;
    helix.points.row(k) << radius * std::cos(t), radius * std::sin(t), rise * t;
    helix.tangents.row(k) << -radius * std::sin(t) / scale, radius * std::cos(t) / scale, rise / scale;
  }
  const HexMesh mesh = tube({1, 16, sections}, 0.05, 0.1, helix);
  const auto angle = [&](int k) {
    const double t = turns * k / sections;
    const Vec3 first = (mesh.positions().row(2 * 16 * k) - helix.points.row(k)).transpose();
    const Vec3 side = Vec3(helix.tangents.row(k).transpose()).cross(inward(t));
    return std::atan2(first.dot(side), first.dot(inward(t)));
  };
  const double expected = -torsion * scale * turns;
  EXPECT_NEAR(std::remainder(angle(sections) - angle(0) - expected, 2 * pi), 0, 1e-4);
  EXPECT_GT(quality(mesh).min_scaled_jacobian, 0.9);
}

TEST(CurveThrough, PassesItsPointsAtEqualSteps) {
  PointArray points(4, 3);
  points << 0, 0, 0, 1, 0.2, 0, 1.5, 1, 0.4, 1.4, 2, 1;
  const Centreline curve = curve_through(points, 601);
  for (int i = 0; i < 4; ++i)
    EXPECT_LT((curve.points.rowwise() - points.row(i)).rowwise().norm().minCoeff(), 0.003) << i;
  EXPECT_TRUE(curve.points.row(600).isApprox(points.row(3), 1e-12));
  const Eigen::VectorXd steps = (curve.points.bottomRows(600) - curve.points.topRows(600)).rowwise().norm();
  EXPECT_LT(steps.maxCoeff() / steps.minCoeff(), 1.01);
  for (int k = 1; k < 600; ++k) {
    const Eigen::RowVector3d way = (curve.points.row(k + 1) - curve.points.row(k - 1)).normalized();
    EXPECT_GT(way.dot(curve.tangents.row(k)), 1 - 1e-4) << k;
  }
}

// Parabolas are reproduced where chords are equal, and lines always.
TEST(CurveThrough, FollowsLinesAndCircles) {
  const PointArray ends = (PointArray(2, 3) << 1, 0, 0, 1, 4, 0).finished();
  EXPECT_TRUE(curve_through(ends, 5).points.row(1).isApprox(Eigen::RowVector3d(1, 1, 0), 1e-12));
  const Centreline circle = arc(2, pi, 17);
  const Centreline through = curve_through(circle.points, 100);
  const double radius = 2 / pi;
  for (int k = 0; k < 100; ++k)
    EXPECT_NEAR((through.points.row(k) - Eigen::RowVector3d(radius, 0, 0)).norm(), radius, 1e-3) << k;
}

TEST(SpherePatch, ApproachesItsSolidAngle) {
  const double angle = 1.1, sine_squared = std::pow(std::sin(angle / 2), 2);
  const double exact = 4 * std::asin(sine_squared) * (std::pow(0.3, 3) - std::pow(0.25, 3)) / 3;
  const auto error = [&](int n) {
    return std::abs(quality(sphere_patch({n, n, 2}, 0.25, 0.3, angle)).volume / exact - 1);
  };
  EXPECT_LT(error(8), 0.01);
  EXPECT_NEAR(std::log2(error(8) / error(16)), 2, 0.1);
  const HexMesh mesh = sphere_patch({4, 6, 2}, 0.25, 0.3, angle);
  EXPECT_EQ(mesh.num_nodes(), 5 * 7 * 3);
  EXPECT_NEAR(mesh.positions().topRows(35).rowwise().norm().minCoeff(), 0.25, 1e-15);
  EXPECT_NEAR(mesh.positions().bottomRows(35).rowwise().norm().maxCoeff(), 0.3, 1e-15);
}

TEST(Shapes, Coarsen) {
  const auto gain = [](const HexMesh& mesh) {
    const auto levels = Charts(mesh).levels;
    return levels.empty() ? 0 : mesh.num_elements() / static_cast<double>(levels.front().cells.size());
  };
  EXPECT_EQ(gain(tube({2, 24, 20}, 0.1, 0.12, arc(0.5, 1, 21))), 8);
  EXPECT_EQ(gain(tube({1, 24, 20}, 0.1, 0.12, arc(0.5, 1, 21))), 4);
  EXPECT_EQ(gain(sheet({16, 16, 2}, {0.1, 0.1}, 0.002, 5)), 8);
  EXPECT_EQ(gain(sphere_patch({8, 8, 4}, 0.1, 0.12, 1)), 8);
}

TEST(Shapes, RefuseWhatMakesNone) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const std::array<int, 3> n{2, 4, 2};
  EXPECT_TRUE(refuses<InputError>([&] { sheet({0, 1, 1}, {1, 1}, 1); }, {"0 cells in direction 0: at least 1"}));
  EXPECT_TRUE(refuses<InputError>([&] { sheet(n, {1, nan}, 1); }, {"a side of nan m"}));
  EXPECT_TRUE(refuses<InputError>([&] { sheet(n, {1, 1}, 0); }, {"a thickness of 0 m"}));
  EXPECT_TRUE(refuses<InputError>([&] { sheet(n, {1, 1}, 0.5, 4); }, {"4 1/m folds a sheet 0.5 m thick", "below 4"}));
  EXPECT_TRUE(refuses<InputError>([&] { sheet(n, {4, 1}, 0.1, -2); }, {"meet itself", "below 1.5708"}));
  EXPECT_TRUE(refuses<InputError>([&] { sheet(n, {4, 1}, 0.1, nan); }, {"nan"}));
  EXPECT_TRUE(refuses<InputError>([&] { sheet({2000, 2000, 2000}, {1, 1}, 1); }, {"more nodes than can be counted"}));
  EXPECT_TRUE(refuses<InputError>([&] { sphere_patch(n, 0.2, 0.1, 1); }, {"0.2 m and an outer one of 0.1 m"}));
  EXPECT_TRUE(refuses<InputError>([&] { sphere_patch(n, 0.1, infinity, 1); }, {"an outer radius of inf m"}));
  EXPECT_TRUE(refuses<InputError>([&] { sphere_patch(n, 0.1, 0.2, pi); }, {"must lie in (0, pi)"}));
  EXPECT_TRUE(refuses<InputError>([&] { arc(1, 7, 3); }, {"an arc of 7 rad"}));
  EXPECT_TRUE(refuses<InputError>([&] { arc(1, 1, 1); }, {"a curve of 1 points"}));
  EXPECT_TRUE(refuses<InputError>([&] { curve_through(PointArray::Zero(1, 3), 3); }, {"at least 2"}));
  EXPECT_TRUE(refuses<InputError>([&] { curve_through(PointArray::Zero(2, 3), 3); }, {"points 0 and 1", "same place"}));
  EXPECT_TRUE(refuses<InputError>([&] { tube({1, 2, 2}, 0.1, 0.2, arc(1, 0, 3)); }, {"2 cells in direction 1", "3"}));
  EXPECT_TRUE(refuses<InputError>([&] { tube(n, 0, 0.2, arc(1, 0, 3)); }, {"an inner radius of 0 m"}));
  EXPECT_TRUE(refuses<InputError>([&] { tube(n, 0.1, 0.2, arc(1, 0, 4)); }, {"2 cells along a curve of 4 points"}));
  // the bend has a radius of 0.2 m
  EXPECT_TRUE(refuses<InputError>(
      [&] {
        tube({1, 8, 10}, 0.1, 0.3, arc(0.2 * pi, pi, 11));
      },
      {"outer radius 0.3 m folds between sections 0 and 1"}));
  EXPECT_NO_THROW(tube({1, 8, 10}, 0.1, 0.19, arc(0.2 * pi, pi, 11)));
}

}  // namespace
}  // namespace hexaplast
