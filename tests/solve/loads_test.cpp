// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/loads.hpp"

#include "support/core.hpp"

namespace {

using namespace hexaplast;

TEST(LoadHistory, FindsTheKeyAndTheWayToTheNext) {
  const std::array<double, 3> times = {-1, 1, 5};
  const auto expect = [&](double time, int key, double fraction) {
    const KeyPhase phase = phase_at(times, time);
    EXPECT_EQ(phase.key, key) << time;
    EXPECT_EQ(phase.fraction, fraction) << time;
  };
  expect(-1.001, -1, 0);
  expect(-1, 0, 0);
  expect(-0.5, 0, 0.25);
  expect(1, 1, 0);
  expect(4, 1, 0.75);
  expect(5, 2, 0);
  expect(1e9, 2, 0);
}

// The ramp, hold and release of the shipped scenes: F min(1, k/50) in step k up to 200, nothing after, at the running
// time.
TEST(LoadHistory, ARampHoldAndReleaseIsMetInEveryStep) {
  const std::array<double, 4> times = {-0.01, 0.49, 1.994, 1.996}, load = {0, 1, 1, 0};
  double time = 0;
  for (int step = 1; step <= 500; ++step, time += 0.01) {
    const auto [key, fraction] = phase_at(times, time);
    const double value = load[key] + fraction * (load[std::min(key + 1, 3)] - load[key]);
    EXPECT_NEAR(value, step <= 200 ? std::min(1.0, step / 50.0) : 0.0, 1e-13) << step;
  }
}

// Nodes (3,0,1) and (3,4,5) about the line x = 1, y = 2: mean (3,2,.), arm (2,0), tangent (0,1) for the axis +z.
TEST(TangentialForces, AreTangentialAtTheCentreOfEachGroup) {
  PointArray x(3, 3);
  x << 3, 0, 1, 3, 4, 5, 7, 7, 7;
  PointArray f = PointArray::Ones(3, 3);
  const std::vector<int> nodes = {0, 1};
  add_tangential_forces(nodes, 2, Vec3(0, 0, 3), Vec3(1, 2, -8), 10, x, f);
  PointArray expected(3, 3);
  expected << 1, 6, 1, 1, 6, 1, 1, 1, 1;
  EXPECT_TRUE(f.isApprox(expected, 1e-15));
}

// Forces in a plane across the axis, of moment force * radius each.
TEST(TangentialForces, HaveTheMomentOfTheirArms) {
  PointArray x(2, 3);
  x << 0.3, -1.2, 0.8, 2.0, 0.4, -0.7;
  PointArray f = PointArray::Zero(2, 3);
  const std::vector<int> nodes = {0, 1};
  const Vec3 axis = Vec3(1, 2, -0.5).normalized(), centre(0.1, 0.2, 0.3);
  add_tangential_forces(nodes, 1, axis, centre, 7, x, f);
  for (int n = 0; n < 2; ++n) {
    const Vec3 arm = x.row(n).transpose() - centre, force = f.row(n).transpose();
    const double radius = (arm - axis * axis.dot(arm)).norm();
    EXPECT_NEAR(force.norm(), 7, 1e-14);
    EXPECT_NEAR(force.dot(axis), 0, 1e-14);
    EXPECT_NEAR(axis.dot(arm.cross(force)), 7 * radius, 1e-13);
  }
}

TEST(TangentialForces, HaveNoDirectionOnTheAxis) {
  const PointArray x = PointArray::Zero(1, 3);
  PointArray f = PointArray::Zero(1, 3);
  const std::vector<int> nodes = {0};
  EXPECT_THROW(add_tangential_forces(nodes, 1, Vec3::UnitZ(), Vec3(0, 0, 4), 1, x, f), NumericalError);
}

}  // namespace
