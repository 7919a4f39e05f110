// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/blade.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "support/refused.hpp"
#include "support/shapes.hpp"

namespace hexaplast::parts {
namespace {

using support::refused;

constexpr double kStep = 0.1;  // [s]

PointArray points(const std::vector<Vec3>& rows) {
  PointArray points(rows.size(), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) points.row(k) = rows[k].transpose();
  return points;
}

/// Four layers of hexahedra of 1 m.
class BladePart : public testing::Test {
 protected:
  /// The joints that open in steps from a time on, the blade being the only one.
  std::set<int> opened(Blade& blade, double time, int num_steps) {
    std::set<int> all;
    for (int step = 0; step < num_steps; ++step, time += kStep) {
      blade.begin_step({.time = time, .dt = kStep, .rayleigh_stiffness = 0}, body.mesh().positions());
      const std::vector<int> joints = blade.end_step(body.mesh().positions());
      body.open(joints);
      all.insert(joints.begin(), joints.end());
    }
    return all;
  }

  /// Joints between hexahedra below and above the plane z = 2.
  std::set<int> between_layers() const {
    std::set<int> joints;
    for (int joint = 0; joint < body.joints().count(); ++joint)
      if (body.joints().hexahedra(joint)[0] < 32 && body.joints().hexahedra(joint)[1] >= 32) joints.insert(joint);
    return joints;
  }

  Body body{support::block({4, 4, 4}, 1), {{.young_modulus = 5000}}};
  const PointArray edge = points({{0, -1, 0}, {0, 2, 0}, {0, 5, 0}});
};

TEST_F(BladePart, CutsWherePathLeadsIt) {
  Blade blade({.points = edge, .key_times = {0.25, 1.25}, .positions = points({{-1, 0, 2.1}, {5, 0, 2.1}})}, body);
  EXPECT_EQ(opened(blade, 0, 3).size(), 0u) << "0.3 m after the first key time it is 0.7 m away from the first centres";
  EXPECT_EQ(opened(blade, 0.3, 12), between_layers());
  EXPECT_EQ(connected_parts(body.mesh(), body.alive()).count, 2);
  EXPECT_TRUE(opened(blade, 0, 12).empty()) << "what is open is passed over";
  body.reset();
  EXPECT_EQ(opened(blade, 0, 15), between_layers());
}

// It leaves a corner of its path out unless it stops there within the step.
TEST_F(BladePart, PassesItsKeyTimesWithinAStep) {
  Blade blade(
      {.points = edge, .key_times = {0, 0.05, 0.1}, .positions = points({{-1, 0, 2.1}, {5, 0, 2.1}, {-1, 0, 2.1}})},
      body);
  EXPECT_EQ(opened(blade, 0, 1), between_layers());
}

// Half a turn about the axis x = z = 2 in one step: from far left to far right, through the lower half alone.
TEST_F(BladePart, TurnsOnAnArc) {
  const double half = std::sqrt(0.5);
  Blade blade({.points = points({{0, -3, -1.4}, {0, 3, -1.4}}),
               .key_times = {0, kStep},
               .positions = points({{2, 2, 2}, {2, 2, 2}}),
               .orientations = {0, half, 0, half, 0, -half, 0, half}},
              body);
  std::set<int> expected;
  for (int joint = 0; joint < body.joints().count(); ++joint) {
    const auto is_inside = [&](int hexahedron) {
      const Vec3 centre = gather(body.mesh().positions(), body.mesh().hexahedra()[hexahedron]).colwise().mean();
      return std::hypot(centre[0] - 2, centre[2] - 2) < 1.4;
    };
    const int first = body.joints().hexahedra(joint)[0], second = body.joints().hexahedra(joint)[1];
    if (is_inside(first) != is_inside(second) && first < 32 && second < 32) expected.insert(joint);
  }
  EXPECT_EQ(expected.size(), 16u);
  EXPECT_EQ(opened(blade, 0, 1), expected);
}

TEST_F(BladePart, IsMovedByAHost) {
  Blade blade({.points = edge, .is_prescribed = true}, body);
  blade.prescribe({.position = {-1, 0, 2.1}}, {.position = {2, 0, 2.1}});
  const std::size_t half = opened(blade, 0, 1).size();
  EXPECT_EQ(half, 8u);
  blade.prescribe({.position = {2, 0, 2.1}}, {.position = {5, 0, 2.1}});
  EXPECT_EQ(opened(blade, 0, 1).size(), 8u);
  EXPECT_EQ(connected_parts(body.mesh(), body.alive()).count, 2);
}

TEST_F(BladePart, OpensNothingWhereItIsNotActive) {
  BladeOptions options{
      .points = edge, .key_times = {0, 1}, .positions = points({{-1, 0, 2.1}, {5, 0, 2.1}}), .active = false};
  Blade blade(options, body);
  EXPECT_TRUE(opened(blade, 0, 5).empty());
  options.active = true;
  blade.set_options(options);
  EXPECT_EQ(opened(blade, 0.5, 6).size(), 8u);
}

TEST_F(BladePart, NamesTheOptionsThatItRefuses) {
  EXPECT_EQ(refused([&] { Blade({}, body); }),
            "points: 0 given, must be at least two; keyTimes: is empty, must hold at least one time");
  EXPECT_EQ(
      refused([&] {
        Blade(
            {.points = edge.topRows(1), .key_times = {0, 1}, .positions = PointArray::Zero(1, 3), .orientations = {1}},
            body);
      }),
      "points: 1 given, must be at least two; positions: 1 positions given for 2 times, must be as many; "
      "orientations: 1 numbers given, must be a quaternion (4) for each of 2 key times");
}

}  // namespace
}  // namespace hexaplast::parts
