// SPDX-License-Identifier: LGPL-2.1-or-later
// What must not matter: where the body is, how it is turned, which hand it is seen in.
#include <cmath>

#include "body_state.hpp"
#include "hexaplast/body.hpp"
#include "kinematics/polar.hpp"
#include "support/bar.hpp"
#include "support/compare.hpp"
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

constexpr int kSteps = 120;

/// A soft bar of that mesh at those initial positions.
Body yielding_bar(const PointArray& positions, const HexMesh& mesh) {
  return Body(HexMesh(positions, mesh.hexahedra()), {support::yielding(100, 0.01)}, support::kJoined);
}

/// A mesh that is stretched and twisted step by step while it flows.
class DrivenBar {
 public:
  explicit DrivenBar(HexMesh mesh) : mesh_(std::move(mesh)), reference_(yielding_bar(mesh_.positions(), mesh_)) {
    drive(reference_, [](int, const PointArray& x) { return x; });
  }

  /// posed(k, x) says where the deformed shape stands in the world at step k.
  template <class Pose>
  void drive(Body& body, const Pose& posed) const {
    for (int k = 1; k <= kSteps; ++k) {
      const double fraction = std::min(1.0, k / 80.0);
      body.flow(posed(k, support::stretched_and_twisted(mesh_, 1 + 0.3 * fraction, 1.5 * fraction)), kStep);
    }
  }

  void expect_equal_history(const Body& body, double tolerance) const {
    EXPECT_LE(support::incongruence(body.state().history.plastic_rest_positions,
                                    reference_.state().history.plastic_rest_positions),
              tolerance);
    double shape_error = 0, threshold_error = 0;
    for (int e = 0; e < mesh_.num_elements(); ++e) {
      const ElementHistory actual = body.state().history.element(e), expected = reference_.state().history.element(e);
      shape_error = std::max(shape_error, support::max_abs(actual.rest_shape - expected.rest_shape));
      for (int a = 0; a < kCorners; ++a) {
        threshold_error =
            std::max(threshold_error, support::relative_error(actual.yield_stress[a], expected.yield_stress[a]));
      }
    }
    EXPECT_LE(shape_error, tolerance);
    EXPECT_LE(threshold_error, tolerance);
  }

  const HexMesh& mesh() const { return mesh_; }
  const PointArray& reference_material() const { return reference_.state().history.plastic_rest_positions; }

 private:
  HexMesh mesh_;
  Body reference_;
};

class Objectivity : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_GT(support::max_abs(bar.reference_material() - mesh.positions()), 0.3 * kEdge);  // it has flowed
  }

  Random random{171};
  DrivenBar bar{support::block({2, 2, 6}, kEdge)};
  const HexMesh& mesh = bar.mesh();
};

// Turned, moved and spinning while it flows.
TEST_F(Objectivity, ThePoseInTheWorldDoesNotMatter) {
  const Mat3 R = random.rotation();
  const Vec3 shift = random.vector(1), spin = 4 * random.direction();  // [rad/s]
  const DrivenBar distorted(support::distorted_block({2, 2, 6}, kEdge, 0.05, 172));
  for (const DrivenBar* of : {&std::as_const(bar), &distorted}) {
    Body body = yielding_bar(of->mesh().positions(), of->mesh());
    of->drive(body, [&](int k, const PointArray& x) { return mapped(x, rotation_exp(k * kStep * spin) * R, shift); });
    of->expect_equal_history(body, 1e-9);
  }
}

TEST_F(Objectivity, TurningTheWholeSceneTurnsTheResult) {
  const Mat3 R = random.rotation();
  Body body = yielding_bar(mapped(mesh.positions(), R), mesh);
  bar.drive(body, [&](int, const PointArray& x) { return mapped(x, R); });
  EXPECT_LE(support::incongruence(body.state().history.plastic_rest_positions, bar.reference_material()),
            1e-10 * kEdge);
}

TEST_F(Objectivity, MovingTheWholeSceneMovesTheResult) {
  for (const double far : {1.0, 1e3}) {
    const Vec3 shift(far, -0.5 * far, 0.3 * far);
    Body body = yielding_bar(mapped(mesh.positions(), Mat3::Identity(), shift), mesh);
    bar.drive(body, [&](int, const PointArray& x) { return mapped(x, Mat3::Identity(), shift); });
    EXPECT_LE(support::incongruence(body.state().history.plastic_rest_positions, bar.reference_material()),
              far > 1 ? 1e-7 : 1e-10);
  }
}

TEST_F(Objectivity, TheMirroredSceneHasTheMirroredResult) {
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  for (Hexahedron& corners : hexahedra) {
    for (const int a : {0, 3, 4, 7}) std::swap(corners[a], corners[kEdgeNeighbour[a][0]]);
  }
  const HexMesh mirrored(mapped(mesh.positions(), mirror), hexahedra);
  Body body = yielding_bar(mirrored.positions(), mirrored);
  bar.drive(body, [&](int, const PointArray& x) { return mapped(x, mirror); });
  EXPECT_LE(
      support::incongruence(mapped(body.state().history.plastic_rest_positions, mirror), bar.reference_material()),
      1e-10);
}

/// Current positions of a loaded, yielding bar after some steps, the whole scene turned and moved; given back in the
/// unmoved frame.
PointArray loaded_bar(RestShape rest_shape, const Mat3& R, const Vec3& shift) {
  const HexMesh mesh = support::block({2, 2, 5}, kEdge);
  support::SimulationSetup setup;
  setup.euler = {.rayleigh_mass = 0.1, .rayleigh_stiffness = 0.1};
  setup.fixed = support::nodes_at(mesh, 2, 0);
  const std::vector<int> loaded = support::nodes_at(mesh, 2, 0.5);
  setup.load = [&](double, ConstPoints, Points f) {
    for (const int n : loaded) f.row(n) += (R * Vec3(0.6, 0.2, 2)).transpose();
  };
  support::Simulation bar(
      Body(HexMesh(mapped(mesh.positions(), R, shift), mesh.hexahedra()),
           {rest_shape == RestShape::kJoined ? support::yielding(100, 0.01) : support::stretching(100)},
           {.rest_shape = rest_shape}),
      std::move(setup));
  bar.run(100);
  EXPECT_GT(bar.body.state().history.dissipated_energy, 0);
  return mapped(mapped(bar.x, Mat3::Identity(), -shift), R.transpose());
}

TEST(Trajectory, TurnsAndMovesWithTheScene) {
  Random random(173);
  const double length = 0.5;
  for (const RestShape rest_shape : {RestShape::kJoined, RestShape::kIsolated}) {
    const PointArray expected = loaded_bar(rest_shape, Mat3::Identity(), Vec3::Zero());
    EXPECT_LE(support::max_abs(loaded_bar(rest_shape, random.rotation(), Vec3::Zero()) - expected), 1e-8 * length);
    const Vec3 far = 1000 * length * random.direction();
    EXPECT_LE(support::max_abs(loaded_bar(rest_shape, Mat3::Identity(), far) - expected), 1e-5 * length);
  }
}

}  // namespace
}  // namespace hexaplast
