// SPDX-License-Identifier: LGPL-2.1-or-later
#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/motion.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

struct Permanent {
  double elongation;
  double twist;  ///< [rad]
};

/// What stays of a bar of 0.2 x 0.2 x 1 m that is stretched by 30 % and twisted by 2 rad within 0.6 s and held to 1.2
/// s.
Permanent permanent_shape(int cells_across, double dt, AveragingMethod averaging = AveragingMethod::kGaussNewton) {
  Material m;
  m.yield_stress = 300;
  m.flow_rate = 4;
  m.rotation_flow_rate = 4;
  m.rotation_yield = 0.02 / cells_across;  // the rotation of a corner against its centre shrinks with the cell
  m.hardening = 0.2;
  const HexMesh mesh = support::block({cells_across, cells_across, 5 * cells_across}, 0.2 / cells_across);
  Settings settings{.rest_shape = RestShape::kJoined};
  settings.averaging = averaging;
  if (averaging == AveragingMethod::kJacobi) settings.implementation = Implementation::kPlain;
  Body body(mesh, {m}, settings);
  const int steps = static_cast<int>(std::lround(1.2 / dt));
  for (int k = 1; k <= steps; ++k) {
    const double fraction = std::min(1.0, 2.0 * k / steps);
    body.flow(support::stretched_and_twisted(mesh, 1 + 0.3 * fraction, 2 * fraction), dt);
  }
  const EndSections ends = end_sections(mesh);
  return {elongation(ends, body.state().history.plastic_rest_positions),
          twist(mesh, ends, body.state().history.plastic_rest_positions)};
}

TEST(PlasticResult, DoesNotDependMuchOnTheMesh) {
  const Permanent coarse = permanent_shape(2, 0.01), fine = permanent_shape(4, 0.01);
  EXPECT_GT(coarse.elongation, 0.05);
  EXPECT_GT(coarse.twist, 0.3);
  EXPECT_NEAR(fine.elongation, coarse.elongation, 0.05 * coarse.elongation);
  EXPECT_NEAR(fine.twist, coarse.twist, 0.15 * coarse.twist);
}

// The power of the test above: one sweep of node means reaches less far on a finer mesh.
TEST(PlasticResult, OfOneJacobiSweepPerStepDependsOnTheMesh) {
  const Permanent coarse = permanent_shape(2, 0.01, AveragingMethod::kJacobi),
                  fine = permanent_shape(4, 0.01, AveragingMethod::kJacobi);
  EXPECT_LT(fine.elongation, 0.7 * coarse.elongation);
  EXPECT_LT(fine.twist, 0.7 * coarse.twist);
}

TEST(PlasticResult, DoesNotDependMuchOnTheTimeStep) {
  const Permanent large = permanent_shape(2, 0.01), small = permanent_shape(2, 0.00125);
  EXPECT_NEAR(large.elongation, small.elongation, 0.02 * small.elongation);
  EXPECT_NEAR(large.twist, small.twist, 0.02 * small.twist);
}

}  // namespace
}  // namespace hexaplast
