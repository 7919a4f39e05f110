// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kinematics/polar.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "support/compare.hpp"
#include "support/golden.hpp"
#include "support/random.hpp"

namespace hexaplast {
namespace {

using support::Random;

constexpr double kPi = std::numbers::pi;

/// The laws that hold for every F: R is a rotation, S symmetric, R S = F.
void expect_polar_of(const Mat3& F) {
  const Polar p = polar(F);
  const double size = F.cwiseAbs().maxCoeff();
  ASSERT_TRUE(p.R.allFinite() && p.S.allFinite()) << F;
  EXPECT_LE((p.R.transpose() * p.R - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-12) << F;
  EXPECT_NEAR(p.R.determinant(), 1, 1e-12) << F;
  EXPECT_LE((p.R * p.S - F).cwiseAbs().maxCoeff(), 1e-12 * size) << F;
  EXPECT_LE((p.S - p.S.transpose()).cwiseAbs().maxCoeff(), 1e-12 * size) << F;

  const SignedSvd svd = signed_svd(F);
  EXPECT_LE((svd.U.transpose() * svd.U - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-12) << F;
  EXPECT_LE((svd.V.transpose() * svd.V - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-12) << F;
  EXPECT_NEAR(svd.U.determinant(), 1, 1e-12) << F;
  EXPECT_NEAR(svd.V.determinant(), 1, 1e-12) << F;
  EXPECT_LE((svd.U * svd.d.asDiagonal() * svd.V.transpose() - F).cwiseAbs().maxCoeff(), 1e-12 * size) << F;
  EXPECT_GE(svd.d[0], svd.d[1]);
  EXPECT_GE(svd.d[1], std::abs(svd.d[2]));
}

TEST(Polar, MatchesGoldenCases) {
  for (const auto& c : support::golden("polar")) {
    const Mat3 F = support::matrix(c["F"]);
    const Vec3 d = support::vector(c["D"]);
    expect_polar_of(F);
    EXPECT_LE((signed_svd(F).d - d).cwiseAbs().maxCoeff(), 1e-10);
    if (d[1] + d[2] < 1e-8) continue;  // two opposite or vanishing singular values leave the rotation open

    const Polar p = polar(F);
    EXPECT_TRUE(support::agrees(p.R, support::matrix(c["R"]), 1e-10)) << F;
    EXPECT_TRUE(support::agrees(p.S, support::matrix(c["S"]), 1e-10)) << F;
    const Vec3 w = rotation_log(p.R);
    // close to pi the axis comes from a difference that has lost digits: 1e-16 / 1e-7
    EXPECT_NEAR(w.norm(), c["phi"], 1e-9) << F;
    EXPECT_LE((w - support::vector(c["rotvec"])).cwiseAbs().maxCoeff(), 1e-8) << F;
    EXPECT_LE((rotation_power(p.R, 0.3) - support::matrix(c["R_pow_0_3"])).cwiseAbs().maxCoeff(), 1e-8) << F;
  }
}

// A million gradients of every rank, orientation and scale, with equal and opposite singular values among them.
TEST(Polar, HoldsForAMillionGradientsAndIsEigensWhereItIsUnique) {
  Random random(17);
  constexpr double kScales[] = {1, 1, 1, 1e-150, 1e-75, 1e75, 1e150};
  int num_unique = 0;
  for (int k = 0; k < 1000000; ++k) {
    Vec3 d(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
    if (k % 4 == 1) d[1] = (k % 8 == 1 ? 1 : -1) * d[0];
    if (k % 16 == 3) d[2] = d[1] = d[0];
    if (k % 16 == 7) d[2] = 0;
    if (k % 16 == 11) d[2] = d[1] = 0;
    if (k % 1024 == 15) d.setZero();
    const Mat3 A = random.matrix(1);  // two rotations for the price of one: the frames of a random matrix
    const Eigen::JacobiSVD<Mat3> frames(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double scale = kScales[k % 7];
    const Mat3 F = scale * (frames.matrixU() * d.asDiagonal() * frames.matrixV().transpose());

    const SignedSvd svd = signed_svd(F);
    const Mat3 R = svd.U * svd.V.transpose();
    ASSERT_TRUE(R.allFinite() && svd.d.allFinite()) << F;
    ASSERT_LE((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-12) << F;
    ASSERT_GT(R.determinant(), 0) << F;
    ASSERT_LE((svd.U * svd.d.asDiagonal() * svd.V.transpose() - F).cwiseAbs().maxCoeff(), 4e-12 * scale) << F;
    const Polar p = polar(F);
    ASSERT_EQ(p.R, R) << F;
    ASSERT_LE((p.R * p.S - F).cwiseAbs().maxCoeff(), 4e-12 * scale) << F;
    ASSERT_LE((p.S - p.S.transpose()).cwiseAbs().maxCoeff(), 4e-12 * scale) << F;

    // unique where the two smallest stretches are not opposite
    if (svd.d[1] + svd.d[2] < 1e-3 * scale) continue;
    ++num_unique;
    const Eigen::JacobiSVD<Mat3> eigen(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 U = eigen.matrixU();
    if ((U * eigen.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
    ASSERT_LE((R - U * eigen.matrixV().transpose()).cwiseAbs().maxCoeff(), 1e-10) << F;
  }
  EXPECT_GT(num_unique, 500000);
}

TEST(RotationLog, GoesThereAndBack) {
  Random random(14);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 axis = random.direction();
    for (double angle = 1e-16; angle < 3; angle *= 10) {
      ASSERT_LE((rotation_log(rotation_exp(angle * axis)) - angle * axis).cwiseAbs().maxCoeff(),
                1e-12 * std::max(1.0, angle));
    }
    const double angle = random.uniform(0, kPi - 1e-5);
    ASSERT_LE((rotation_log(rotation_exp(angle * axis)) - angle * axis).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(RotationPower, MakesOneRotationOfTwoPartsUpToHalfATurn) {
  Random random(18);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 axis = random.direction();
    const double fraction = random.uniform(0, 1);
    for (const double gap : {1.0, 1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
      const Mat3 R = rotation_exp((kPi - gap) * axis);
      const double tolerance = gap > 1e-6 ? 1e-12 : 1e-8;
      ASSERT_LE((rotation_power(R, fraction) * rotation_power(R, 1 - fraction) - R).cwiseAbs().maxCoeff(), tolerance);
      ASSERT_LE((rotation_exp(rotation_log(R)) - R).cwiseAbs().maxCoeff(), tolerance) << "gap " << gap;
      ASSERT_LE(rotation_log(R).norm(), kPi + 1e-15);
    }
  }
}

TEST(RotationPower, MultipliesTheAngleAndKeepsTheAxis) {
  Random random(16);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 w = random.uniform(0, 3.1) * random.direction();
    const Mat3 R = rotation_exp(w);
    ASSERT_LE(
        (rotation_power(R, 0.3) - Eigen::AngleAxisd(0.3 * w.norm(), w.normalized()).matrix()).cwiseAbs().maxCoeff(),
        1e-12);
    ASSERT_LE((rotation_power(R, 0.3) * rotation_power(R, 0.7) - R).cwiseAbs().maxCoeff(), 1e-12);
    ASSERT_NEAR(rotation_power(R, 0.3).determinant(), 1, 1e-12);
  }
  EXPECT_EQ(rotation_power(Mat3::Identity(), 0.3), Mat3::Identity());
}

}  // namespace
}  // namespace hexaplast
