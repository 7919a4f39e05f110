// SPDX-License-Identifier: LGPL-2.1-or-later
// One hexahedron by itself. Its intermediates are compared with golden data through the command
// (runner/study/element_test.cpp), which prints them; here with hand values.
#include "inspect.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

const Material kFlowing = yielding(100, 0.001);

/// A distorted hexahedron whose corners have been moved by up to a tenth of its edge.
HexahedronState deformed(const Material& material) {
  HexahedronState state = initial_hexahedron(distorted_hexahedron(kEdge, 0.15, 411), material);
  state.current += Random(412).field(kCorners, 0.1 * kEdge);
  return state;
}

TEST(HexahedronStep, ShowsTheDeformationOfAGuardedHexahedronThatDoesNotFlow) {
  HexahedronState state = deformed(kFlowing);
  state.current.col(0) *= -1;
  const HexahedronStep step = inspect_step(state, kFlowing, kJoined, 0.01);
  EXPECT_TRUE(step.skipped);
  for (int i = 0; i < kCorners; ++i) {
    EXPECT_LT(step.F[i].determinant(), 0);
    EXPECT_GT(step.stress_norm[i], 100);
    EXPECT_EQ(step.stretch_flow_fraction[i], 0);
  }
  EXPECT_EQ(step.plastic_rest, state.plastic_rest);
}

TEST(FollowPath, UniaxialStrainAnswersWithLameConstants) {
  const Material material{.young_modulus = 1000, .poisson_ratio = 0.25};  // lambda = mu = 400 Pa
  Mat3 stretched = Mat3::Identity();
  stretched(0, 0) = 1.1;
  std::vector<PathResponse> answers;
  follow_path(distorted_hexahedron(kEdge, 0.15, 414), material, published_element(), 0.25,
              {{1, Mat3::Identity()}, {2, stretched}, {2.1, stretched}},
              [&](const PathResponse& answer) { answers.push_back(answer); });
  ASSERT_EQ(answers.size(), 6u) << "four steps of .25 s and one that is shorter, after the beginning";
  EXPECT_DOUBLE_EQ(answers[1].time, 1.25);
  EXPECT_DOUBLE_EQ(answers[5].time, 2.1);
  for (const PathResponse& answer : answers) {
    const double strain = answer.F(0, 0) - 1;
    const Mat3 P = Vec3(1200 * strain, 400 * strain, 400 * strain).asDiagonal();
    EXPECT_LE(max_abs(answer.P - P), 1e-9);
    EXPECT_NEAR(answer.stress_norm, 800 * strain, 1e-9);
  }
  EXPECT_NEAR(answers[2].F(0, 0), 1.05, 1e-12);
}

TEST(HexahedronStep, IsExactWhateverThePrecisionOfABody) {
  const HexahedronState state = deformed(kFlowing);
  const HexahedronStep step =
      inspect_step(state, kFlowing, {.rest_shape = RestShape::kJoined, .precision = Precision::kMixed}, .01);
  EXPECT_EQ(step.plastic_rest, inspect_step(state, kFlowing, kJoined, .01).plastic_rest);
}

TEST(HexahedronStep, RefusesTimeStepsThatAreNone) {
  const HexahedronState state = deformed(kFlowing);
  const std::vector<PathPoint> path{{0, Mat3::Identity()}, {1, Mat3::Identity()}};
  for (const double dt :
       {0., -.01, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(refuses<InputError>([&] { inspect_step(state, {}, {}, dt); }, {"dt = ", "(0, inf)"})) << dt;
    EXPECT_TRUE(refuses<InputError>([&] { follow_path(state.initial, {}, {}, dt, path, [](const PathResponse&) {}); },
                                    {"dt = ", "(0, inf)"}))
        << dt;
  }
  EXPECT_TRUE(refuses<InputError>([&] { follow_path(state.initial, {}, {}, 1e-300, path, [](const PathResponse&) {}); },
                                  {"dt = 1e-300", "steps of the path"}));
}

TEST(FollowPath, RefusesNoPathAndTimesThatDoNotAscend) {
  const auto follow = [](const std::vector<PathPoint>& path) {
    follow_path(cube(kEdge), kFlowing, kJoined, 0.01, path, [](const PathResponse&) {});
  };
  EXPECT_TRUE(refuses<InputError>([&] { follow({}); }, {"at least one point"}));
  EXPECT_TRUE(refuses<InputError>(
      [&] {
        follow({{1, Mat3::Identity()}, {1, Mat3::Identity()}});
      },
      {"time 1 does not come after 1"}));
}

}  // namespace
}  // namespace hexaplast
