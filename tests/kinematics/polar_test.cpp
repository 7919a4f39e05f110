// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kinematics/polar.hpp"

#include <Eigen/SVD>
#include <map>

#include "support/core.hpp"

namespace hexaplast {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Polar, MatchesGoldenCases) {
  for (const auto& c : golden("polar")) {
    const Mat3 F = matrix(c["F"]);
    const Vec3 d = vector(c["D"]);
    EXPECT_LE((signed_svd(F).d - d).cwiseAbs().maxCoeff(), 1e-10);
    if (d[1] + d[2] < 1e-8) continue;  // two opposite or vanishing singular values leave the rotation open

    const Polar p = polar(F);
    EXPECT_TRUE(agrees(p.R, matrix(c["R"]), 1e-10)) << F;
    EXPECT_TRUE(agrees(p.S, matrix(c["S"]), 1e-10)) << F;
    const Vec3 w = rotation_log(p.R);
    // close to pi the axis comes from a difference that has lost digits: 1e-16 / 1e-7
    EXPECT_NEAR(w.norm(), c["phi"], 1e-9) << F;
    EXPECT_LE((w - vector(c["rotvec"])).cwiseAbs().maxCoeff(), 1e-8) << F;
  }
}

/// What a decomposition misses, each relative: U diag(d) V^T - F, U^T U - 1, V^T V - 1.
std::array<double, 3> errors(const Mat3& U, const Vec3& d, const Mat3& V, const Mat3& F) {
  const double scale = max_abs(F);
  return {max_abs(U * (d / scale).asDiagonal() * V.transpose() - F / scale),
          max_abs(U.transpose() * U - Mat3::Identity()), max_abs(V.transpose() * V - Mat3::Identity())};
}

TEST(SignedSvd, IsNoLessAccurateThanEigens) {
  Random random(19);
  const auto with = [&](double a, double b, double c) {
    return Mat3(random.rotation() * Vec3(a, b, c).asDiagonal() * random.rotation());
  };
  const auto number = [&] { return random.uniform(0, 1); };
  const std::map<std::string, std::function<Mat3()>> kinds{
      {"any", [&] { return random.matrix(1); }},
      {"inverted", [&] { return with(1, number(), -number()); }},
      {"of rank two", [&] { return with(1, number(), 0); }},
      {"of rank one", [&] { return with(1, 0, 0); }},
      {"nearly a line", [&] { return with(1, 1e-13 * number(), 1e-13 * number()); }},
      {"nearly equal stretches", [&] { return with(1, 1 - 1e-9 * number(), 1 - 1e-12 * number()); }},
      {"opposite stretches", [&] { return with(1, 0.5, -0.5); }},
      {"tiny", [&] { return Mat3(1e-300 * random.matrix(1)); }},
      {"huge", [&] { return Mat3(1e300 * random.matrix(1)); }},
      {"columns of different size", [&] { return Mat3(random.matrix(1) * Vec3(1, 1e-6, 1e6).asDiagonal()); }},
      {"of integers", [&] { return Mat3((3 * random.matrix(1)).array().round()); }}};
  for (const auto& [name, draw] : kinds) {
    std::array<double, 3> ours{}, eigens{};
    for (int k = 0; k < 5000; ++k) {
      const Mat3 F = draw();
      if (F.isZero(0)) continue;
      const SignedSvd svd = signed_svd(F);
      ASSERT_TRUE(svd.U.determinant() > 0 && svd.V.determinant() > 0) << name << '\n' << F;
      ASSERT_EQ(polar(F).R, svd.U * svd.V.transpose());
      const Eigen::JacobiSVD<Mat3> eigen(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const auto our = errors(svd.U, svd.d, svd.V, F),
                 its = errors(eigen.matrixU(), eigen.singularValues(), eigen.matrixV(), F);
      for (int n = 0; n < 3; ++n) {
        ours[n] = std::max(ours[n], our[n]);
        eigens[n] = std::max(eigens[n], its[n]);
      }
      ASSERT_LE((svd.d.cwiseAbs() - eigen.singularValues()).cwiseAbs().maxCoeff(), 1e-14 * eigen.singularValues()[0])
          << name << '\n'
          << F;
    }
    for (int n = 0; n < 3; ++n) EXPECT_LE(ours[n], std::max(1.5 * eigens[n], 2e-15)) << name << ", error " << n;
  }
}

TEST(Polar, TurnsNothingWhereNothingIsLeft) {
  EXPECT_EQ(polar(Mat3(Mat3::Zero())).R, Mat3::Identity());
  EXPECT_LE(max_abs(polar(Mat3(Vec3(2, 0, 0).asDiagonal())).R - Mat3::Identity()), 1e-15);
  Mat3 F = Mat3::Identity();
  F(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(polar(F).R.array().isNaN().all() && polar(F).S.array().isNaN().all());
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
