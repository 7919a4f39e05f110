// SPDX-License-Identifier: LGPL-2.1-or-later
// What the alternatives of the method do, and that the defaults are better: the differences have to be there.
#include <cmath>

#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "kinematics/polar.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/materials.hpp"
#include "support/motion.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
namespace {

using support::kEdge;
using support::kStep;
using support::mapped;
using support::Random;

// ---- gradients

int num_zero_modes(Bending scheme, double distortion) {
  Settings settings = published_element();
  settings.implementation = Implementation::kPlain;
  settings.bending = scheme;
  Body body(support::single_element(support::distorted_hexahedron(kEdge, distortion, 211)), {Material{}}, settings);
  BlockMatrix K(kCorners);
  body.linearize(body.mesh().positions());
  body.add_stiffness_blocks(-1, K);
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(support::dense(K)).eigenvalues();
  return static_cast<int>((values.array().abs() <= 1e-10 * values[23]).count());
}

TEST(Bending, OfTheCentreAloneHasTwelveHourglassModes) {
  for (const double distortion : {0.0, 0.15}) {
    EXPECT_EQ(num_zero_modes(Bending::kBlended, distortion), 6);
    EXPECT_EQ(num_zero_modes(Bending::kVertex, distortion), 6);
    EXPECT_EQ(num_zero_modes(Bending::kCentre, distortion), 18);
  }
}

// Force is the slope of the energy in every scheme; the patch test only passes in one.
TEST(Bending, EveryOneHasAnEnergyAndOnlyTheBlendedPassesThePatchTest) {
  const HexMesh mesh = support::distorted_block({3, 3, 3}, kEdge, 0.15, 212);
  const std::vector<bool> on_boundary = support::is_on_boundary(mesh);
  for (const Bending scheme : {Bending::kBlended, Bending::kVertex, Bending::kCentre}) {
    Random random(213);
    Settings settings = published_element();
    settings.implementation = Implementation::kPlain;
    settings.bending = scheme;
    Body body(mesh, {Material{}}, settings);
    const PointArray x = mesh.positions() + random.field(mesh.num_nodes(), 0.2 * kEdge);
    const PointArray dx = random.field(mesh.num_nodes(), 1);
    PointArray f = PointArray::Zero(mesh.num_nodes(), 3);
    body.linearize(x);
    body.add_force(f);
    const double slope = support::central_difference([&](double h) { return body.energy(x + h * dx); }, 1e-6 * kEdge);
    EXPECT_NEAR(-f.cwiseProduct(dx).sum(), slope, 1e-6 * std::abs(slope));

    f.setZero();
    body.linearize(mapped(mesh.positions(), random.rotation() * (Mat3::Identity() + random.matrix(0.2))));
    body.add_force(f);
    double inside = 0, boundary = 0;
    for (int n = 0; n < mesh.num_nodes(); ++n) {
      double& max = on_boundary[n] ? boundary : inside;
      max = std::max(max, f.row(n).norm());
    }
    if (scheme == Bending::kBlended)
      EXPECT_LE(inside, 1e-10 * boundary);
    else
      EXPECT_GE(inside, 1e-3 * boundary);
  }
}

// ---- fractions of stretch and rotation

/// Fraction of a small displacement u of a cube that one full step makes permanent, by stretch or rotation flow or
/// both.
double permanent_fraction(Bending bending, const ElementPoints& X, const ElementPoints& u, bool stretch,
                          bool rotation) {
  Material m;
  m.yield_stress = 0;
  m.flow_rate = stretch ? 1 / kStep : 0;  // all of it at once
  m.rotation_yield = 0;
  m.rotation_flow_rate = rotation ? 1 / kStep : 0;
  Settings settings = support::kJoined;
  settings.bending = bending;
  settings.volume_restitution = 0;
  Body body(support::single_element(X), {m}, settings);
  body.flow(PointArray(X + u), kStep);
  const ElementPoints moved = body.state().history.rest_shape[0] - X;
  return moved.cwiseProduct(u).sum() / u.squaredNorm();
}

TEST(PlasticStep, SharesTwistBendAndStretchBetweenStretchAndRotation) {
  const ElementPoints X = support::cube(kEdge);
  ElementPoints twist, bend, stretch;
  const double small = 1e-3;
  for (int a = 0; a < kCorners; ++a) {
    const Vec3 s = X.row(a).transpose() / kEdge;
    twist.row(a) << -s[1] * s[2], s[0] * s[2], 0;
    bend.row(a) << s[0] * s[2], -s[1] * s[2], 0;   // in two planes at once, so that it keeps the volume
    stretch.row(a) << -s[0] / 2, -s[1] / 2, s[2];  // likewise: pressure never flows
  }
  const struct {
    ElementPoints u;
    double by_stretch, by_stretch_where_shear_is_assumed;  // the rest by rotation
  } modes[] = {{twist, 0.25, 0.25}, {bend, 0.75, 0.5}, {stretch, 1, 1}};
  for (const Bending bending : {Bending::kBlended, Bending::kAssumedCorner})
    for (const auto& mode : modes) {
      const ElementPoints u = small * kEdge * mode.u;
      const double by_stretch = bending == Bending::kBlended ? mode.by_stretch : mode.by_stretch_where_shear_is_assumed;
      EXPECT_NEAR(permanent_fraction(bending, X, u, true, false), by_stretch, 2 * small);
      EXPECT_NEAR(permanent_fraction(bending, X, u, false, true), 1 - by_stretch, 2 * small);
      EXPECT_NEAR(permanent_fraction(bending, X, u, true, true), 1, 2 * small);
    }
}

// ---- frames of the paper's rotation modes

Body yielding_bar(const HexMesh& mesh, const Settings& settings) {
  Material m;
  m.yield_stress = 100;
  m.flow_rate = 3;
  m.rotation_yield = 0.01;
  m.rotation_flow_rate = 2;
  m.hardening = 0.2;
  return Body(mesh, {m}, settings);
}

/// Material shape of a bar stretched and twisted in a world that is turned by R, and spins on [rad/s] while it flows.
PointArray material_after(const HexMesh& mesh, const Settings& settings, const Mat3& R, const Vec3& spin) {
  Body body = yielding_bar(mesh, settings);
  for (int k = 1; k <= 120; ++k) {
    const double fraction = std::min(1.0, k / 80.0);
    const Mat3 pose = rotation_exp(k * kStep * spin) * R;
    body.flow(mapped(support::stretched_and_twisted(mesh, 1 + 0.3 * fraction, 1.5 * fraction), pose), kStep);
  }
  return body.state().history.plastic_rest_positions;
}

class PaperMode : public testing::TestWithParam<RotationPlasticity> {};

TEST_P(PaperMode, IsObjectiveAgainstTheBestFitAndNotAgainstTheAxes) {
  Random random(214);
  const HexMesh mesh = support::block({2, 2, 6}, kEdge);
  const Mat3 R = random.rotation();
  const Vec3 spin = 4 * random.direction(), still = Vec3::Zero();
  Settings settings = support::kJoined;
  settings.implementation = Implementation::kPlain;
  settings.rotation_plasticity = GetParam();
  for (const RotationFrame frame : {RotationFrame::kBestFit, RotationFrame::kWorld}) {
    settings.rotation_frame = frame;
    const PointArray expected = material_after(mesh, settings, Mat3::Identity(), still);
    const double posed = support::incongruence(material_after(mesh, settings, R, still), expected);
    const double spinning = support::incongruence(material_after(mesh, settings, Mat3::Identity(), spin), expected);
    if (frame == RotationFrame::kBestFit) {
      EXPECT_LE(posed, 1e-9);
      EXPECT_LE(spinning, 1e-9);
    } else {
      EXPECT_GE(posed, 1e-2 * kEdge);
      EXPECT_GE(spinning, 1e-2 * kEdge);
    }
  }
}

TEST_P(PaperMode, KeepsLessOfATwistThanTheObjectiveMode) {
  const HexMesh mesh = support::block({2, 2, 6}, kEdge);
  const EndSections ends = end_sections(mesh);
  const auto plastic_twist = [&](RotationPlasticity mode) {
    Settings settings = support::kJoined;
    settings.implementation = Implementation::kPlain;
    settings.rotation_plasticity = mode;
    return twist(mesh, ends, material_after(mesh, settings, Mat3::Identity(), Vec3::Zero()));
  };
  const double kept = plastic_twist(GetParam());
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, 0.6 * plastic_twist(RotationPlasticity::kObjective));
}

INSTANTIATE_TEST_SUITE_P(Modes, PaperMode, testing::Values(RotationPlasticity::kVertex, RotationPlasticity::kCentre),
                         [](const auto& test) {
                           return test.param == RotationPlasticity::kVertex ? "Vertex" : "Centre";
                         });

}  // namespace
}  // namespace hexaplast
