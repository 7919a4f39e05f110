// SPDX-License-Identifier: LGPL-2.1-or-later
// The formulas as a compiler for a device reads them: without lanes, and without matrices of other libraries.
#define HEXAPLAST_ONE_NUMBER
#include "element/element-inl.hpp"
#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "kinematics/rotation-inl.hpp"
#include "material/law-inl.hpp"
#include "plastic/point_flow-inl.hpp"

#if defined(HIGHWAY_HWY_BASE_H_) || defined(EIGEN_WORLD_VERSION)
#error "a formula includes what a device does not have"
#endif

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hexaplast {
namespace {

namespace formula = one_number;

TEST(OneNumber, FormulasOfIsolatedRestShapesStandByThemselves) {
  const formula::Sym<double> M{0.4, -0.3, 0.2, 0.5, -0.6, 0.7}, minus{-0.4, 0.3, -0.2, -0.5, 0.6, -0.7};
  formula::Mat<double> G{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  G = formula::flowed_plastic_inverse(G, M);
  EXPECT_NEAR(formula::determinant(G), std::exp(-0.3), 1e-14);
  G = formula::flowed_plastic_inverse(G, minus);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(G(i, j), i == j, 1e-14);

  const formula::Mat<double> axes = formula::symmetric_expm1(formula::Sym<double>{2, -3, 1e-9, 0, 0, 0});
  EXPECT_NEAR(axes(0, 0), std::expm1(2), 1e-14 * std::exp(2));
  EXPECT_NEAR(axes(1, 1), std::expm1(-3), 1e-14);
  EXPECT_NEAR(axes(2, 2), std::expm1(1e-9), 1e-22);
}

TEST(OneNumber, RotationsInSinglePrecisionAreOrthogonalWhereverTheFormOfLanesEnds) {
  const formula::Mat<float> cases[] = {{{{1.1f, 0.2f, -0.1f}, {0.1f, 0.9f, 0.3f}, {-0.2f, 0.1f, 1.3f}}},
                                       {{{1, 0, 0}, {0, 0.5f, 0}, {0, 0, -0.5f}}},
                                       {{{1, 2, 3}, {2, 4, 6}, {-1, -2, -3}}},
                                       {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}};
  for (const formula::Mat<float>& F : cases) {
    const formula::PolarLanes<float> polar = formula::safe_polar(F);
    const formula::Mat<float> RtR = transposed_product(polar.R, polar.R), RS = polar.R * matrix(polar.S);
    EXPECT_NEAR(formula::determinant(polar.R), 1, 1e-6);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(RtR(i, j), i == j, 1e-6);
        EXPECT_NEAR(RS(i, j), F(i, j), 1e-5);
      }
  }
}

template <class N>
void expect_powers_of_rotations(N rounding) {
  const N axis[] = {2 / N(7), -3 / N(7), 6 / N(7)};
  const formula::Mat<N> K{{{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}}}, KK = K * K;
  for (const N angle : {N(0), N(1e-12), N(1e-6), N(0.01), N(0.8), N(1.6), N(2.6), N(3.14159)})
    for (const N fraction : {N(0.1), N(1)}) {
      SCOPED_TRACE(angle);
      const auto rotation = [&](N a, N one) {  // by Rodrigues' formula; one = 0: less the identity
        formula::Mat<N> R;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            R(i, j) = (i == j ? one : 0) + std::sin(a) * K(i, j) + 2 * std::pow(std::sin(a / 2), N(2)) * KK(i, j);
        return R;
      };
      const formula::RotationVector<N> w = formula::rotation_log(rotation(angle, 1));
      EXPECT_NEAR(w.angle, angle, rounding);
      if (w.near_half_turn) continue;
      const formula::Mat<N> power = formula::rotation_expm1(w, fraction), expected = rotation(fraction * angle, 0);
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(w.axis_angle[i], angle * axis[i], rounding);
        for (int j = 0; j < 3; ++j)
          EXPECT_NEAR(power(i, j), expected(i, j), rounding * std::min(N(1), angle + rounding));
      }
    }
}
TEST(OneNumber, PowersOfRotationsAreThoseOfRodriguesFormula) {
  expect_powers_of_rotations<double>(2e-15);
  expect_powers_of_rotations<float>(1e-6F);
}

}  // namespace
}  // namespace hexaplast
