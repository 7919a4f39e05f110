// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/solid.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "hexaplast/base/error.hpp"
#include "support/random.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

struct Surface {
  PointArray positions;
  std::vector<Triangle> triangles;
};

// A box around the origin, seen from outside counter-clockwise.
Surface box_surface(const Vec3& size) {
  Surface box{PointArray(8, 3),
              {{0, 2, 1},
               {0, 3, 2},
               {4, 5, 6},
               {4, 6, 7},
               {0, 1, 5},
               {0, 5, 4},
               {1, 2, 6},
               {1, 6, 5},
               {2, 3, 7},
               {2, 7, 6},
               {3, 0, 4},
               {3, 4, 7}}};
  box.positions << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  box.positions = (box.positions.array() - 0.5).matrix() * size.asDiagonal();
  return box;
}

// The way back along the normal ends on the surface, and no shorter way does: the distance does not change by more than
// one walks, and along the normal by just that.
void expect_distance(const Solid& solid, double size, unsigned seed) {
  Random random(seed);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p = random.vector(size);
    const SignedDistance at = solid.distance(p);
    ASSERT_NEAR(at.normal.norm(), 1, 1e-12);
    EXPECT_NEAR(solid.distance(p - at.value * at.normal).value, 0, 1e-12 * size);
    const Vec3 other = random.vector(size);
    EXPECT_LE(std::abs(solid.distance(other).value - at.value), (1 + 1e-12) * (other - p).norm());
    if (at.value > 0) {
      EXPECT_NEAR(solid.distance(p + 0.1 * size * at.normal).value, at.value + 0.1 * size, 1e-12 * size);
    }
  }
}

TEST(Solid, DistancesAreDistances) {
  expect_distance(Solid::sphere(0.3), 1, 1);
  expect_distance(Solid::capsule(0.2, 0.8), 1, 2);
  expect_distance(Solid::cylinder(0.3, 0.7), 1, 3);
  expect_distance(Solid::box({0.5, 0.9, 0.2}), 1, 4);
  const Surface box = box_surface({0.5, 0.9, 0.2});
  expect_distance(Solid::closed_surface(box.positions, box.triangles), 1, 5);
}

TEST(Solid, HandValues) {
  EXPECT_NEAR(Solid::sphere(0.3).distance({0, 0, 1}).value, 0.7, 1e-15);
  EXPECT_NEAR(Solid::sphere(0.3).distance({0, 0, 0}).value, -0.3, 1e-15);
  EXPECT_NEAR(Solid::capsule(0.2, 1).distance({0.5, 0, 0.3}).value, 0.3, 1e-15);
  EXPECT_NEAR(Solid::capsule(0.2, 1).distance({0, 0, 1}).value, 0.3, 1e-15);
  EXPECT_NEAR(Solid::cylinder(0.2, 1).distance({0.5, 0, 0.9}).value, 0.5, 1e-15);
  EXPECT_NEAR(Solid::cylinder(0.2, 1).distance({0.15, 0, 0.1}).value, -0.05, 1e-15);
  EXPECT_NEAR(Solid::box({2, 4, 6}).distance({0.9, 0, 0}).value, -0.1, 1e-15);
  EXPECT_NEAR(Solid::box({2, 4, 6}).distance({4, 6, 3}).value, 5, 1e-15);
  EXPECT_EQ(Solid::box({2, 4, 6}).smallest_radius(), 1);
  EXPECT_NEAR(Solid::box({2, 4, 6}).reach(), std::sqrt(14), 1e-15);
}

TEST(Solid, ASurfaceOfABoxIsTheBox) {
  const Vec3 size(0.5, 0.9, 0.2);
  const Surface surface = box_surface(size);
  const Solid box = Solid::box(size), solid = Solid::closed_surface(surface.positions, surface.triangles);
  Random random(7);
  for (int k = 0; k < 5000; ++k) {
    const Vec3 p = random.vector(k % 2 ? 0.3 : 1);
    EXPECT_NEAR(solid.distance(p).value, box.distance(p).value, 1e-14);
  }
  EXPECT_EQ(solid.smallest_radius(), box.smallest_radius());
  EXPECT_NEAR(solid.reach(), box.reach(), 1e-15);
}

// Where contacts begin: the way from the surface is rounding.
TEST(Solid, NormalsOnASurfaceAreThoseOfItsFaces) {
  const Vec3 size(0.5, 0.9, 0.2);
  const Surface surface = box_surface(size);
  const Mat3 turned = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Solid solid = Solid::closed_surface(surface.positions * turned.transpose(), surface.triangles);
  Random random(9);
  for (const double depth : {0.0, 1e-16, 1e-15, 1e-13})
    for (int k = 0; k < 1000; ++k) {
      const int axis = k % 3;
      Vec3 p = 0.9 * random.vector(0.5).cwiseProduct(size), normal = Vec3::Zero();
      normal[axis] = k % 2 ? 1 : -1;
      p[axis] = normal[axis] * (size[axis] / 2 - depth);
      EXPECT_LE((solid.distance(turned * p).normal - turned * normal).norm(), 1e-12) << depth;
    }
}

// A ring around z, of this radius, and round like a wire.
Surface ring(double radius, double wire) {
  constexpr int kAlong = 60, kAround = 12;
  Surface surface{PointArray(kAlong * kAround, 3), {}};
  const auto node = [](int i, int j) { return i % kAlong * kAround + j % kAround; };
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAround; ++j) {
      const double along = 2 * std::numbers::pi * i / kAlong, around = 2 * std::numbers::pi * j / kAround;
      const double r = radius + wire * std::cos(around);
      surface.positions.row(node(i, j)) << r * std::cos(along), r * std::sin(along), wire * std::sin(around);
      surface.triangles.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
      surface.triangles.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  return surface;
}

// However it is turned, and whatever it reaches around.
TEST(Solid, TheSmallestRadiusOfASurfaceIsThatOfItsThinnestPart) {
  const Surface plate = box_surface({0.04, 0.04, 0.001});
  Random random(13);
  for (int k = 0; k < 20; ++k) {
    const Eigen::AngleAxisd turn(k == 0 ? std::numbers::pi / 4 : 3 * k, random.vector(1).normalized());
    const PointArray turned = plate.positions * turn.toRotationMatrix().transpose();
    EXPECT_NEAR(Solid::closed_surface(turned, plate.triangles).smallest_radius(), 0.0005, 1e-12);
  }
  const Surface wire = ring(0.02, 0.001);
  const double radius = Solid::closed_surface(wire.positions, wire.triangles).smallest_radius();
  EXPECT_LE(radius, 0.001);
  EXPECT_GT(radius, 0.0009);
}

// Rings of `kAround` nodes around z, each { z, radius }, and the ends closed by a node in the middle.
Surface rings(const std::vector<std::array<double, 2>>& profile, int num_around) {
  const int count = static_cast<int>(profile.size());
  Surface surface{PointArray(count * num_around + 2, 3), {}};
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < num_around; ++j) {
      const double angle = 2 * std::numbers::pi * j / num_around;
      surface.positions.row(i * num_around + j) << profile[i][1] * std::cos(angle), profile[i][1] * std::sin(angle),
          profile[i][0];
    }
  const int bottom = count * num_around, top = bottom + 1;
  surface.positions.row(bottom) << 0, 0, profile.front()[0];
  surface.positions.row(top) << 0, 0, profile.back()[0];
  for (int j = 0; j < num_around; ++j) {
    const int next = (j + 1) % num_around;
    surface.triangles.push_back({bottom, next, j});
    surface.triangles.push_back({top, (count - 1) * num_around + j, (count - 1) * num_around + next});
    for (int i = 0; i + 1 < count; ++i) {
      const int a = i * num_around + j, b = i * num_around + next;
      surface.triangles.push_back({a, b, b + num_around});
      surface.triangles.push_back({a, b + num_around, a + num_around});
    }
  }
  return surface;
}

// An hourglass of long triangles, whose middles lie where it is wide: what counts is its neck. A tip is no neck.
TEST(Solid, TheSmallestRadiusOfLongTrianglesIsThatOfTheThinnestPart) {
  for (const int num_around : {4, 8, 16}) {
    const Surface glass = rings({{-0.02, 0.01}, {0, 0.00025}, {0.02, 0.01}}, num_around);
    const double least = 0.00025 * std::cos(std::numbers::pi / num_around);
    const double radius = Solid::closed_surface(glass.positions, glass.triangles).smallest_radius();
    EXPECT_LE(radius, 0.00025 + 1e-12) << num_around;
    EXPECT_GE(radius, least - 1e-12) << num_around;
  }
  // a notch across a bar: nothing but its deepest edge is near the other side
  Surface notch{PointArray(10, 3), {{0, 3, 4}, {0, 1, 3}, {1, 2, 3}, {5, 9, 8}, {5, 8, 6}, {6, 8, 7}}};
  const double x[] = {-0.05, 0.05, 0.05, 0, -0.05}, z[] = {0, 0, 0.01, 0.0006, 0.01};
  for (int k = 0; k < 5; ++k) {
    const int next = (k + 1) % 5;
    notch.positions.row(k) << x[k], -0.02, z[k];
    notch.positions.row(5 + k) << x[k], 0.02, z[k];
    notch.triangles.push_back({k, 5 + k, 5 + next});
    notch.triangles.push_back({k, 5 + next, next});
  }
  EXPECT_NEAR(Solid::closed_surface(notch.positions, notch.triangles).smallest_radius(), 0.0003, 1e-12);
  // a needle with a sharp tip
  Surface needle = rings({{-0.05, 0.001}, {0, 0.001}}, 16);
  needle.positions(needle.positions.rows() - 1, 2) = 0.004;
  EXPECT_GT(Solid::closed_surface(needle.positions, needle.triangles).smallest_radius(), 0.0006);
}

// A star with deep notches: whether a point is inside is asked by counting the triangles above it.
TEST(Solid, KnowsTheInsideOfSurfacesThatAreNotConvex) {
  constexpr int kPoints = 10;
  Surface star = rings({{-0.2, 1}, {0.2, 1}}, kPoints);
  for (int k = 1; k < 2 * kPoints; k += 2) star.positions.row(k).head<2>() *= 0.25;
  const Solid solid = Solid::closed_surface(star.positions, star.triangles);
  const auto is_inside = [&](const Vec3& p) {
    if (std::abs(p.z()) >= 0.2) return false;
    int crossings = 0;  // of a ray along x, in the plane
    for (int k = 0; k < kPoints; ++k) {
      const Vec3 a = star.positions.row(k).transpose(), b = star.positions.row((k + 1) % kPoints).transpose();
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      crossings += a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()) > p.x();
    }
    return crossings % 2 == 1;
  };
  Random random(11);
  int num_inside = 0;
  for (int k = 0; k < 20000; ++k) {
    Vec3 p = random.vector(1.1);
    p.z() *= 0.3;
    num_inside += is_inside(p);
    EXPECT_EQ(solid.distance(p).value < 0, is_inside(p)) << p.transpose();
  }
  EXPECT_GT(num_inside, 1000);
}

TEST(Solid, RefusesWhatIsNoSolid) {
  EXPECT_THROW(Solid::sphere(0), InputError);
  EXPECT_THROW(Solid::sphere(-1), InputError);
  EXPECT_THROW(Solid::capsule(1, 0), InputError);
  EXPECT_THROW(Solid::cylinder(std::nan(""), 1), InputError);
  EXPECT_THROW(Solid::box({1, 0, 1}), InputError);

  const auto refusal_of = [](void (*change)(Surface&)) -> std::string {
    Surface box = box_surface({1, 1, 1});
    change(box);
    try {
      Solid::closed_surface(box.positions, box.triangles);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal_of([](Surface& box) { box.triangles.pop_back(); }),
            "closed surface: is open at edge 3 7 of triangle 8");
  EXPECT_EQ(
      refusal_of([](Surface& box) { std::swap(box.triangles[3][0], box.triangles[3][1]); }),
      "closed surface: triangles 2 and 3 run along edge 6 4 in the same direction: they do not agree which side is "
      "outside, or more than two meet there");
  EXPECT_EQ(refusal_of([](Surface& box) {
              for (Triangle& triangle : box.triangles) std::swap(triangle[0], triangle[1]);
            }),
            "closed surface: is inside out (its volume is -1 m^3)");
  EXPECT_EQ(refusal_of([](Surface& box) { box.triangles[5][2] = 8; }),
            "closed surface: triangle 5 has node 8, must lie in [0, 8)");
  EXPECT_EQ(refusal_of([](Surface& box) { box.positions.row(1) = box.positions.row(0); }),
            "closed surface: triangle 0 has no area");
  EXPECT_EQ(refusal_of([](Surface& box) { box.triangles.clear(); }), "closed surface: has no triangle");
}

}  // namespace
