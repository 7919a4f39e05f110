// SPDX-License-Identifier: LGPL-2.1-or-later
// The formulas of isolated rest shapes as a compiler for a device reads them: without lanes, and without matrices of
// other libraries.
#define HEXAPLAST_ONE_NUMBER
#include "element/isolated-inl.hpp"

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

}  // namespace
}  // namespace hexaplast
