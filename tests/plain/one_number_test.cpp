// SPDX-License-Identifier: LGPL-2.1-or-later
// The formulas as a compiler for a device reads them: without lanes, and without matrices of other libraries.
#define HEXAPLAST_ONE_NUMBER
#include "element/element-inl.hpp"
#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "kinematics/rotation-inl.hpp"
#include "material/stress_norm-inl.hpp"
#include "plastic/point_flow-inl.hpp"
#include "plastic/rest_shape-inl.hpp"

#if defined(HIGHWAY_HWY_BASE_H_) || defined(EIGEN_WORLD_VERSION)
#error "a formula includes what a device does not have"
#endif

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hexaplast
