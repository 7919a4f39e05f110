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

TEST(Polar, MatchesGoldenCases) {
  for (const auto& c : support::golden("polar")) {
    const Mat3 F = support::matrix(c["F"]);
    const Vec3 d = support::vector(c["D"]);
    EXPECT_LE((signed_svd(F).d - d).cwiseAbs().maxCoeff(), 1e-10);
    if (d[1] + d[2] < 1e-8) continue;  // two opposite or vanishing singular values leave the rotation open

    const Polar p = polar(F);
    EXPECT_TRUE(support::agrees(p.R, support::matrix(c["R"]), 1e-10)) << F;
    EXPECT_TRUE(support::agrees(p.S, support::matrix(c["S"]), 1e-10)) << F;
    const Vec3 w = rotation_log(p.R);
    // close to pi the axis comes from a difference that has lost digits: 1e-16 / 1e-7
    EXPECT_NEAR(w.norm(), c["phi"], 1e-9) << F;
    EXPECT_LE((w - support::vector(c["rotvec"])).cwiseAbs().maxCoeff(), 1e-8) << F;
  }
}

TEST(Polar, HoldsForAMillionGradientsAndIsEigensWhereItIsUnique) {
  Random random(17);
  int num_unique = 0;
  for (int k = 0; k < 1000000; ++k) {
    const Mat3 F = support::gradient_of_kind(k % 8, random);
    const double scale = support::max_abs(F);
    const SignedSvd svd = signed_svd(F);
    const Mat3 R = svd.U * svd.V.transpose();
    ASSERT_TRUE(R.allFinite() && svd.d.allFinite()) << F;
    ASSERT_LE((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-12) << F;
    ASSERT_GT(R.determinant(), 0) << F;
    ASSERT_GT(svd.U.determinant(), 0) << F;
    ASSERT_LE((svd.U * svd.d.asDiagonal() * svd.V.transpose() - F).cwiseAbs().maxCoeff(), 4e-12 * scale) << F;
    const Polar p = polar(F);
    ASSERT_EQ(p.R, R) << F;
    ASSERT_LE((p.R * p.S - F).cwiseAbs().maxCoeff(), 4e-12 * scale) << F;
    ASSERT_LE((p.S - p.S.transpose()).cwiseAbs().maxCoeff(), 4e-12 * scale) << F;

    // unique where the two smallest stretches are not opposite
    if (!(svd.d[1] + svd.d[2] > 1e-3 * scale)) continue;
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

TEST(RotationLog, IsThatOfTheRotationUpToHalfATurn) {
  Random random(18);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 axis = random.direction();
    for (const double gap : {1.0, 1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
      const Mat3 R = rotation_exp((kPi - gap) * axis);
      ASSERT_LE((rotation_exp(rotation_log(R)) - R).cwiseAbs().maxCoeff(), gap > 1e-6 ? 1e-12 : 1e-8) << "gap " << gap;
      ASSERT_LE(rotation_log(R).norm(), kPi + 1e-15);
    }
  }
}

}  // namespace
}  // namespace hexaplast
