// SPDX-License-Identifier: LGPL-2.1-or-later
// Far from where the method is meant to be used: extreme steps and stiffnesses, many steps, shapes without volume.
#include <Eigen/QR>
#include <cmath>

#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "plastic/point_flow.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/motion.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
namespace {

using support::kEdge;
using support::kSoft;
using support::Random;

/// A clamped bar under a side load that is the same fraction of its stiffness for every E.
support::Simulation bent_bar(double young_modulus, double dt, double yield_fraction,
                             RestShape rest_shape = RestShape::kIsolated) {
  const HexMesh mesh = support::block({1, 1, 4}, kEdge);
  Material m = kSoft;
  m.young_modulus = young_modulus;
  m.yield_stress = yield_fraction * young_modulus;
  m.flow_rate = std::min(1.0, 0.05 / dt);
  m.rotation_flow_rate = 0;
  Settings settings{.rest_shape = rest_shape};
  settings.volume_restitution = std::min(1.0, 0.3 / dt);
  support::SimulationSetup setup;
  setup.dt = dt;
  setup.euler = {.rayleigh_mass = std::sqrt(young_modulus / 1000), .rayleigh_stiffness = 0.1};  // about critical
  setup.fixed = support::nodes_at(mesh, 2, 0);
  const std::vector<int> tip = support::nodes_at(mesh, 2, 0.4);
  setup.load = [tip, young_modulus](double, ConstPoints, Points f) {
    for (const int n : tip) f(n, 0) += 2e-4 * young_modulus * kEdge * kEdge;
  };
  return support::Simulation(Body(mesh, {m}, settings), std::move(setup));
}

TEST(Simulation, StaysFiniteForEveryTimeStepAndStiffness) {
  for (const double E : {1e2, 1e4, 1e6, 1e9}) {
    for (const double dt : {1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0}) {
      for (const double yield_fraction : {1e3, 0.003})
        for (const RestShape rest_shape : {RestShape::kJoined, RestShape::kIsolated}) {
          support::Simulation bar = bent_bar(E, dt, yield_fraction, rest_shape);
          for (int k = 0; k < 50; ++k) {
            bar.step();
            ASSERT_TRUE(bar.x.allFinite() && bar.v.allFinite() &&
                        bar.body.state().history.plastic_rest_positions.allFinite() &&
                        std::isfinite(bar.body.dissipated_energy()))
                << "E " << E << " dt " << dt << " step " << k;
          }
          ASSERT_LE(support::max_abs(bar.x), 10) << "E " << E << " dt " << dt;
        }
    }
  }
}

TEST(Simulation, ComesToRestWhereTheTimeStepDoesNotMatter) {
  constexpr double kDuration = 200;  // [s]
  for (const double E : {1e2, 1e5, 1e9}) {
    support::Simulation reference = bent_bar(E, 0.1, 1e3);
    reference.run(static_cast<int>(kDuration / 0.1));
    EXPECT_GT(support::max_abs(reference.x - reference.body.mesh().positions()), 0.01 * kEdge);
    for (const double dt : {0.4, 1.0}) {
      support::Simulation bar = bent_bar(E, dt, 1e3);
      bar.run(static_cast<int>(kDuration / dt));
      EXPECT_LE(support::max_abs(bar.x - reference.x), 1e-8 * 0.4) << "E " << E << " dt " << dt;
    }
  }
}

// The product of the increments becomes as ill-conditioned as random matrices' products do, and its determinant loses
// as many digits. So the product is carried as Q R with Q a rotation: the logarithms of R's diagonal add up to that of
// the determinant, without loss.
TEST(StretchFlow, KeepsTheVolumeOverAHundredThousandRandomSteps) {
  Random random(221);
  const Lame k = lame(5000, 0.45);
  for (const double strain : {0.1, 0.3}) {
    for (const YieldNorm norm : {YieldNorm::kVonMises, YieldNorm::kFrobenius, YieldNorm::kSpectral}) {
      Mat3 Q = Mat3::Identity();
      double log_determinant = 0, log_stretch = 0;
      for (int step = 0; step < 100000; ++step) {
        const Mat3 A = random.matrix(strain);
        const Mat3 S = Mat3::Identity() + (A + A.transpose()) / 2;
        const Eigen::HouseholderQR<Mat3> qr(
            stretch_flow(S, support::corotated_stress(S, k), norm, 100, 4, 0.01).increment * Q);
        Q = qr.householderQ();
        const Vec3 diagonal = qr.matrixQR().diagonal().cwiseAbs();
        log_determinant += diagonal.array().log().sum();
        log_stretch += std::log(diagonal[0]);
      }
      EXPECT_GT(std::abs(log_stretch), 0.1) << "nothing flowed";
      EXPECT_NEAR(std::exp(log_determinant), 1, 1e-10) << "strain " << strain;
    }
  }
}

TEST(Body, KeepsItsVolumeAfterRandomPlasticMotions) {
  for (int seed = 0; seed < 4; ++seed) {
    Random random(222 + seed);
    Body body(support::distorted_block({2, 2, 3}, kEdge, 0.1, 226), {kSoft}, support::kJoined);
    for (int k = 0; k < 300; ++k) {
      const PointArray current =
          body.state().history.plastic_rest_positions + random.field(body.mesh().num_nodes(), 0.3 * kEdge);
      body.flow(current, 0.01);
    }
    EXPECT_GT(body.state().history.dissipated_energy, 0);
    for (int k = 0; k < 300; ++k) body.flow(body.state().history.plastic_rest_positions, 0.01);  // unloaded
    EXPECT_NEAR(body.volume(body.state().history.plastic_rest_positions) / body.initial_volume(), 1, 1e-3)
        << "seed " << seed;
  }
}

}  // namespace
}  // namespace hexaplast
