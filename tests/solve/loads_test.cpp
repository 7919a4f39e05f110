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

TEST(TangentialForces, HaveNoDirectionOnTheAxis) {
  const PointArray x = PointArray::Zero(1, 3);
  PointArray f = PointArray::Zero(1, 3);
  const std::vector<int> nodes = {0};
  EXPECT_THROW(add_tangential_forces(nodes, 1, Vec3::UnitZ(), Vec3(0, 0, 4), 1, x, f), NumericalError);
}

}  // namespace
