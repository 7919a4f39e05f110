// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/body.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "support/compare.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
namespace {

/// Tip deflection of a clamped 1 x 0.1 x 0.1 m beam of cubes, `thickness` of them across, relative to Timoshenko's
/// beam.
double relative_deflection(int thickness, double poisson_ratio, GradientScheme gradient = GradientScheme::kBlended) {
  constexpr double kLength = 1, kWidth = 0.1, kForce = 1e-6;
  Material m;
  m.poisson_ratio = poisson_ratio;
  const double E = m.young_modulus, G = E / (2 * (1 + poisson_ratio));
  const HexMesh mesh = support::block({10 * thickness, thickness, thickness}, kWidth / thickness);
  const std::vector<int> tip = support::nodes_at(mesh, 0, kLength);

  // one step of 10^6 s from rest: inertia has no part in it, what is left is the linear static answer
  support::SimulationSetup setup;
  setup.density = 1e-3;
  setup.dt = 1e6;
  setup.fixed = support::nodes_at(mesh, 0, 0);
  setup.load = [&](double, ConstPoints, Points f) {
    // the end face's load per node: a quarter cell's share for every cell that the node belongs to
    for (const int n : tip) f(n, 2) += kForce * mesh.incident(n).size() / (4.0 * thickness * thickness);
  };
  Settings settings;
  settings.gradient = gradient;
  support::Simulation beam(Body(mesh, {m}, settings), std::move(setup));
  beam.step();

  double deflection = 0;
  for (const int n : tip) deflection += (beam.x(n, 2) - mesh.positions()(n, 2)) / tip.size();
  const double area = kWidth * kWidth, inertia = area * area / 12;
  return deflection /
         (kForce * kLength * kLength * kLength / (3 * E * inertia) + kForce * kLength / (5.0 / 6 * G * area));
}

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

// Towards incompressibility trilinear hexahedra stiffen; the answer stays a number, and falls without jumps.
TEST(Cantilever, LocksTowardsIncompressibilityAndStillRuns) {
  double before = 1;
  for (const double poisson_ratio : {0.0, 0.3, 0.45, 0.49, 0.499}) {
    const double deflection = relative_deflection(2, poisson_ratio);
    RecordProperty("poisson_ratio_" + std::to_string(poisson_ratio), std::to_string(deflection));
    EXPECT_LT(deflection, before) << poisson_ratio;
    EXPECT_GT(deflection, 0.1) << poisson_ratio;
    before = deflection;
  }
}

TEST(Cantilever, ConvergesWithRefinement) {
  EXPECT_NEAR(relative_deflection(2, 0), 0.968, 0.005 * 0.968);
  EXPECT_NEAR(relative_deflection(2, 0.45), 0.837, 0.005 * 0.837);
}

}  // namespace
}  // namespace hexaplast
