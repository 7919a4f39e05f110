// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/cantilever.hpp"

#include "support/compare.hpp"
#include "support/golden.hpp"

namespace hexaplast {
namespace {

using support::relative_deflection;

// Between full integration (.666 and .514) and the exact answer: what blending gives to bending. Some locking stays at
// .45.
TEST(Cantilever, HasTheStiffnessOfTheBlendedElement) {
  EXPECT_NEAR(relative_deflection(1, 0), 0.886, 0.005 * 0.886);
  EXPECT_NEAR(relative_deflection(1, 0.3), 0.849, 0.005 * 0.849);
  EXPECT_NEAR(relative_deflection(1, 0.45), 0.647, 0.005 * 0.647);
}

TEST(Cantilever, OfCornerGradientsIsFarTooStiff) {
  EXPECT_NEAR(relative_deflection(1, 0, GradientScheme::kVertex), 0.225, 0.005 * 0.225);
  EXPECT_NEAR(relative_deflection(1, 0.45, GradientScheme::kVertex), 0.167, 0.005 * 0.167);
}

// Towards incompressibility trilinear hexahedra stiffen. Blending takes part of it away: the answer lies between the
// fully integrated element and the one with incompatible modes, as CalculiX has them on the same mesh.
TEST(Cantilever, LocksLessThanFullIntegration) {
  const support::Json reference = support::calculix("locking");
  const auto& poisson_ratios = reference["poisson_ratio"];
  ASSERT_EQ(poisson_ratios.size(), 5u);
  for (std::size_t k = 0; k < poisson_ratios.size(); ++k) {
    const double deflection = relative_deflection(2, poisson_ratios[k]);
    EXPECT_GT(deflection, reference["C3D8"][k].get<double>()) << poisson_ratios[k];
    EXPECT_LT(deflection, reference["C3D8I"][k].get<double>()) << poisson_ratios[k];
  }
}

TEST(Cantilever, ConvergesWithRefinement) {
  EXPECT_NEAR(relative_deflection(2, 0), 0.968, 0.005 * 0.968);
  EXPECT_NEAR(relative_deflection(2, 0.45), 0.837, 0.005 * 0.837);
}

}  // namespace
}  // namespace hexaplast
