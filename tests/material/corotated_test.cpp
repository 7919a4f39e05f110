// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/corotated.hpp"

#include "kinematics/polar.hpp"
#include "support/compare.hpp"
#include "support/random.hpp"

namespace hexaplast {
namespace {

using support::Random;

const Lame kLame = lame(5000, 0.45);

Mat3 first_piola(const Mat3& F) {
  const Polar p = polar(F);
  return p.R * stress(p.S, kLame);
}

TEST(Lame, HasTheHandValues) {
  EXPECT_NEAR(kLame.mu, 5000 / 2.9, 1e-9);
  EXPECT_NEAR(kLame.lambda, 5000 * 0.45 / (1.45 * 0.1), 1e-9);
}

TEST(CorotatedLaw, UniaxialStressIsYoungsModulusTimesStrain) {
  const double strain = 0.2;
  const Mat3 S = Vec3(1 - 0.45 * strain, 1 - 0.45 * strain, 1 + strain).asDiagonal();
  EXPECT_LE((stress(S, kLame) - Mat3(Vec3(0, 0, 5000 * strain).asDiagonal())).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_NEAR(energy_density(S, kLame), 0.5 * 5000 * strain * strain, 1e-10);
}

TEST(CorotatedLaw, StressIsTheGradientOfTheEnergy) {
  Random random(41);
  for (int k = 0; k < 20; ++k) {
    Mat3 F = Mat3::Identity() + random.matrix(0.5);
    if (k % 4 == 3) F.col(0) *= -1;  // inside out
    const Vec3 d = signed_svd(F).d;
    if (d[1] + d[2] < 0.1) continue;  // near a gradient where the rotation jumps

    const Mat3 P = first_piola(F);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double slope = support::central_difference(
            [&](double h) {
              Mat3 nudged = F;
              nudged(i, j) += h;
              return energy_density(polar(nudged).S, kLame);
            },
            1e-5);
        EXPECT_NEAR(P(i, j), slope, 1e-7 * P.norm()) << "entry " << i << "," << j;
      }
    }
  }
}

// At F = R the operator that holds rotations fixed lacks nothing: dR resists no stress.
TEST(StressIncrement, IsTheSlopeOfTheStressAtAPureRotation) {
  Random random(42);
  const Mat3 R = random.rotation(), dF = random.matrix(1);
  const double h = 1e-6;
  const Mat3 slope = (first_piola(R + h * dF) - first_piola(R - h * dF)) / (2 * h);
  EXPECT_TRUE(support::agrees(stress_increment(R, dF, kLame), slope, 1e-8));
}

}  // namespace
}  // namespace hexaplast
