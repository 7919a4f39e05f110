// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/point_flow.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "kinematics/rotation-inl.hpp"
#include "plastic/point_flow-inl.hpp"
#include "plastic/rest_shape-inl.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/random.hpp"

namespace hexaplast {
namespace {

using support::corotated_stress;
using support::Random;

const Lame kSoftLame = lame(5000, 0.45);
constexpr YieldNorm kYieldNorms[] = {YieldNorm::kVonMises, YieldNorm::kFrobenius, YieldNorm::kSpectral};

Mat3 random_stretch(Random& random, double size) {
  const Mat3 V = random.rotation();
  const Vec3 d = Vec3::Ones() + random.vector(size);
  return V * d.asDiagonal() * V.transpose();
}

// Whatever the axes are.
TEST(StressNorm, HasTheHandValues) {
  const Mat3 R = Random(51).rotation();
  const Mat3 sigma = R * Vec3(300, -100, -500).asDiagonal() * R.transpose();
  const Mat3 tension = R * Vec3(-700, 0, 0).asDiagonal() * R.transpose();
  for (const YieldNorm norm : kYieldNorms) EXPECT_NEAR(stress_norm(tension, norm), 700, 1e-10);
  EXPECT_NEAR(stress_norm(sigma, YieldNorm::kVonMises), std::sqrt(0.5 * (400. * 400 + 400. * 400 + 800. * 800)), 1e-10);
  EXPECT_NEAR(stress_norm(sigma, YieldNorm::kFrobenius), std::sqrt(350000.0), 1e-10);
  EXPECT_NEAR(stress_norm(sigma, YieldNorm::kSpectral), 500, 1e-10);
}

double fraction(double value, double threshold, double rate_dt) {
  return HWY_NAMESPACE::flow_fraction(value, threshold, rate_dt, value);
}

TEST(FlowShare, IsTheRateTimesTheExcessAndStaysWithinZeroAndOne) {
  EXPECT_DOUBLE_EQ(fraction(400, 300, 0.02), 0.02 * 0.25);
  EXPECT_EQ(fraction(300, 300, 0.02), 0);
  EXPECT_EQ(fraction(200, 300, 0.02), 0);
  EXPECT_EQ(fraction(0, 0, 0.02), 0);
  EXPECT_EQ(fraction(400, std::numeric_limits<double>::infinity(), 0.02), 0);
  EXPECT_EQ(fraction(400, 0, 10), 1);
}

TEST(Hardened, GrowsByWhatFlowsAndIsNeverNegative) {
  EXPECT_DOUBLE_EQ(hardened(300, 2, 0.01, 400), 308);
  EXPECT_EQ(hardened(300, -100, 0.01, 400), 0);
  EXPECT_EQ(hardened(300, 2, 0, 400), 300);
  // infinity times zero is no number, and nothing flows beyond it
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(hardened(kInfinity, -2, 0, 400), kInfinity);
  EXPECT_EQ(hardened(300, kInfinity, 0, 400), 300);
}

TEST(RestoreVolume, ScalesLengthsByTheRateTimesTheErrorAndWithinAFactorOfTwo) {
  const auto scale = [](double volume_ratio, double rate, double dt) {
    return HWY_NAMESPACE::restitution_scale(volume_ratio, rate * dt);
  };
  EXPECT_DOUBLE_EQ(scale(1.2, 5, 0.01), 1 - 0.05 * 0.2);
  EXPECT_DOUBLE_EQ(scale(0.7, 5, 0.01), 1 + 0.05 * 0.3);
  EXPECT_EQ(scale(1 + 1e-13, 1e12, 1), 1);  // rounding of volumes is left alone
  EXPECT_DOUBLE_EQ(scale(3, 50, 0.01), 0.5);
  EXPECT_DOUBLE_EQ(scale(-5, 50, 0.01), 2);
}

TEST(StretchFlow, IsAShareOfTheDeviatoricLogarithmicStretch) {
  Random random(53);
  for (const YieldNorm norm : kYieldNorms) {
    for (int k = 0; k < 200; ++k) {
      const Mat3 S = random_stretch(random, 0.4);
      const StretchFlow flow = stretch_flow(S, corotated_stress(S, kSoftLame), norm, 100, 3, 0.01);
      const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S);
      Vec3 logs = eigen.eigenvalues().array().log();
      logs.array() -= logs.mean();

      ASSERT_NEAR(flow.norm, stress_norm(corotated_stress(S, kSoftLame), norm), 1e-9);
      ASSERT_DOUBLE_EQ(flow.fraction, fraction(flow.norm, 100, 0.03));
      const Vec3 expected = (flow.fraction * logs).array().exp();
      ASSERT_LE((flow.increment - eigen.eigenvectors() * expected.asDiagonal() * eigen.eigenvectors().transpose())
                    .cwiseAbs()
                    .maxCoeff(),
                1e-12);
      ASSERT_NEAR(flow.increment.determinant(), 1, 1e-12);
      ASSERT_NEAR(flow.strain, std::sqrt(2.0 / 3) * flow.fraction * logs.norm(), 1e-12);
      const Mat3 flowed = eigen.eigenvectors() * (flow.fraction * logs).asDiagonal() * eigen.eigenvectors().transpose();
      ASSERT_NEAR(flow.dissipated, corotated_stress(S, kSoftLame).cwiseProduct(flowed).sum(), 1e-9);
      if (norm == YieldNorm::kVonMises) {
        ASSERT_GE(flow.dissipated, 0);
      }
    }
  }
}

TEST(RotationFlow, IsAShareOfTheRotation) {
  Random random(56);
  for (int k = 0; k < 200; ++k) {
    const Vec3 axis = random.direction();
    const double angle = random.uniform(0.06, 3.1);
    const Mat3 Q = Eigen::AngleAxisd(angle, axis).matrix();
    const double eta = random.uniform(0, 1);
    const auto turn = HWY_NAMESPACE::rotation_log(HWY_NAMESPACE::entries(Q));
    ASSERT_NEAR(turn.angle, angle, 1e-14);
    const Mat3 increment = Mat3::Identity() + to_eigen(HWY_NAMESPACE::rotation_expm1(turn, eta));
    ASSERT_LE((increment - Eigen::AngleAxisd(eta * angle, axis).matrix()).cwiseAbs().maxCoeff(), 1e-12);
    ASSERT_NEAR(increment.determinant(), 1, 1e-12);
    // the pose of the element slows the paper's modes down
    ASSERT_NEAR(HWY_NAMESPACE::flow_fraction(angle, 0.05, 0.02, angle + 0.4), 0.02 * (angle - 0.05) / (angle + 0.4),
                1e-15);
  }
}

}  // namespace
}  // namespace hexaplast
