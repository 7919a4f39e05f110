// SPDX-License-Identifier: LGPL-2.1-or-later
// Rigid frames and what follows them. Where SOFA takes them: sofa_trajectories_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::read_and_init;

const std::string kFrame =
    "<MechanicalObject name='frames' template='Rigid3d' position='1 2 3  0 0 0 1' velocity='0 0 0  0 0 2'/>";

std::string scene_with(const std::string& lines, const std::string& solver = "<SparseLDLSolver/>") {
  return "<Node dt='0.01' gravity='0 0 -10'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver + lines + "</Node>";
}

/// A frame with hexahedra on it, held by springs: the tissue stretches between the frame and fixed ground.
std::string with_tissue(const std::string& solver) {
  return scene_with(
      "<MechanicalObject name='frames' template='Rigid3d' position='0 0 0  0 0 0 1  0.1 0.05 1.1  0 0 0 1'/>"
      "<UniformMass totalMass='4'/><FixedProjectiveConstraint/>"
      "<Node name='tissue'><RegularGridTopology n='2 2 3' min='0 0 0' max='0.2 0.3 1'/><MechanicalObject name='nodes'/>"
      "<UniformMass totalMass='2'/><HexahedronFEMForceField youngModulus='3000' poissonRatio='0.3'/>"
      "<ConstantForceField indices='8' forces='3 1 0'/>"
      "<RigidMapping globalToLocalCoords='true' rigidIndexPerPoint='0 0 0 0  0 1 0 1  1 1 1 1'/></Node>",
      solver);
}

scene::RigidState& frames(scene::Scene& scene) { return at<scene::RigidState>(scene, "frames"); }

TEST(RigidFrames, FallAndTurnByThemselves) {
  scene::Scene scene = read_and_init(scene_with(kFrame + "<UniformMass totalMass='0.3'/>"));
  support::run(scene, 10);
  const Eigen::Quaterniond turned = frames(scene).orientations()[0];
  EXPECT_NEAR(turned.z(), std::sin(0.1), 1e-14);  // 0.2 rad
  EXPECT_NEAR(turned.w(), std::cos(0.1), 1e-14);
  EXPECT_NEAR(frames(scene).positions()(0, 2), 3 - 10 * 1e-4 * 55, 1e-12);  // implicit Euler: 1 + 2 + ... + 10 steps
  EXPECT_TRUE(frames(scene).positions().row(1).isZero(0));
  EXPECT_NEAR(at<scene::OdeSolver>(scene, "EulerImplicitSolver1").kinetic_energy(), 0.5 * 0.3 * (1 * 1 + 2 * 2),
              1e-12);  // inertia 1 m^2 times the mass
  scene.reset();
  EXPECT_EQ(frames(scene).orientations()[0].w(), 1);
  EXPECT_EQ(frames(scene).positions()(0, 2), 3);
}

TEST(RigidFrames, AreLedAndHeld) {
  scene::Scene scene = read_and_init(
      scene_with(kFrame + "<UniformMass totalMass='0.3'/><LinearMovementProjectiveConstraint keyTimes='0 0.1 100' "
                          "movements='0 0 0 0 0 0  0 0.5 0 0 0 1  0 0.5 0 0 0 1'/>"));
  support::run(scene, 6);  // to the time 0.05, as SOFA's movements lag by one step
  EXPECT_NEAR(frames(scene).positions()(0, 1), 2.25, 1e-14);
  EXPECT_NEAR(frames(scene).orientations()[0].z(), std::sin(0.25), 1e-14);
  EXPECT_NEAR(frames(scene).velocities()(1, 2), 10, 1e-12);
  const std::vector<double>& position = frames(scene).reals("position");
  EXPECT_NEAR(position.at(5), std::sin(0.25), 1e-14);
  support::run(scene, 20);
  EXPECT_NEAR(frames(scene).orientations()[0].z(), std::sin(0.5), 1e-14);
}

// The moment of a force at the end of a lever, by Newton's law.
TEST(RigidMapping, CarriesForcesAndMomentsUp) {
  scene::Scene scene = read_and_init(
      "<Node dt='0.01' gravity='0 0 0'><EulerImplicitSolver/><CGLinearSolver iterations='50' tolerance='1e-15' "
      "threshold='1e-30'/><MechanicalObject name='frames' template='Rigid3d' position='1 2 3  0 0 0.6 0.8'/>"
      "<UniformMass vertexMass='2 1 [0.5 0 0,0 0.25 0,0 0 0.1]'/><Node name='tip'><MechanicalObject name='point' "
      "position='0.5 0 0'/><RigidMapping/><ConstantForceField forces='0 0 4'/></Node></Node>");
  const Vec3 arm = Vec3(0.28, 0.96, 0) * 0.5;  // turned by 2 acos(0.8) about z
  const auto& point = at<scene::MechanicalState>(scene, "tip/point");
  EXPECT_TRUE(
      const_cast<scene::MechanicalState&>(point).positions().isApprox((Vec3(1, 2, 3) + arm).transpose().eval(), 1e-14));
  scene.step();
  const Vec3 moment = arm.cross(Vec3(0, 0, 4));
  EXPECT_NEAR(frames(scene).velocities()(0, 2), 0.01 * 4 / 2, 1e-14);
  EXPECT_NEAR(frames(scene).velocities()(1, 0), 0.01 * moment[0] / (2 * 0.5), 1e-14);
  EXPECT_NEAR(frames(scene).velocities()(1, 1), 0.01 * moment[1] / (2 * 0.25), 1e-14);
}

// Assembled matrices and products are the same.
TEST(RigidMapping, GivesDirectAndIterativeSolversTheSameSystem) {
  scene::Scene direct = read_and_init(with_tissue("<SparseLDLSolver/>"));
  scene::Scene iterative =
      read_and_init(with_tissue("<CGLinearSolver iterations='300' tolerance='1e-15' threshold='1e-30'/>"));
  const PointArray start = at<scene::MechanicalState>(direct, "tissue/nodes").positions();
  support::run(direct, 15);
  support::run(iterative, 15);
  const PointArray end = at<scene::MechanicalState>(direct, "tissue/nodes").positions();
  EXPECT_GT(support::max_abs(end - start), 0.01);
  EXPECT_LT(support::max_abs(end - at<scene::MechanicalState>(iterative, "tissue/nodes").positions()), 1e-10);
  // nodes of one frame keep their distances
  EXPECT_NEAR((end.row(8) - end.row(11)).norm(), (start.row(8) - start.row(11)).norm(), 1e-14);
}

TEST(RigidFrames, GoOnFromACheckpoint) {
  scene::Scene first = read_and_init(with_tissue("<SparseLDLSolver/>")),
               second = read_and_init(with_tissue("<SparseLDLSolver/>"));
  support::run(first, 5);
  std::vector<std::byte> bytes;
  Archive out([&](const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  });
  first.serialize(out);
  Archive in{std::span<const std::byte>(bytes)};
  second.serialize(in);
  support::run(first, 5);
  support::run(second, 5);
  EXPECT_EQ(frames(first).positions(), frames(second).positions());
  EXPECT_EQ(frames(first).orientations()[1].coeffs(), frames(second).orientations()[1].coeffs());
  EXPECT_EQ(at<scene::MechanicalState>(first, "tissue/nodes").positions(),
            at<scene::MechanicalState>(second, "tissue/nodes").positions());
}

TEST(RigidFrames, RefuseWhatDoesNotFit) {
  EXPECT_EQ(errors_of(scene_with("<MechanicalObject template='Rigid3d' position='1 2 3  0 0 0'/>")),
            "test.scn:1: error: MechanicalObject.position: 6 numbers given, must be groups of 7");
  EXPECT_EQ(errors_of(scene_with("<MechanicalObject template='Rigid3d' position='1 2 3  0 0 0 2'/>")),
            "test.scn:1: error: MechanicalObject.position: the quaternion of frame 0 has length 2, must have 1");
  EXPECT_EQ(errors_of(scene_with(kFrame + "<PlaneForceField normal='0 0 1'/>")),
            "test.scn:1: error: PlaneForceField: acts on points, and the MechanicalObject 'frames' has rigid frames");
  EXPECT_EQ(errors_of(scene_with(kFrame + "<UniformMass vertexMass='1 1 [1 0 0]'/>")),
            "test.scn:1: error: UniformMass.vertexMass: '1 1 [1 0 0]' must be one number, or eleven");
  EXPECT_EQ(errors_of(scene_with(kFrame + "<UniformMass vertexMass='1 1 1 0 0 0 1 0 0 0 -1'/>")),
            "test.scn:1: error: UniformMass.vertexMass: the inertia matrix must be symmetric and positive definite");
  EXPECT_EQ(errors_of(scene_with(kFrame + "<UniformMass totalMass='1'/><Node><MechanicalObject position='0 0 0'/>"
                                          "<RigidMapping index='1'/></Node>")),
            "test.scn:1: error: RigidMapping.index: 1 must lie in [0, 1)");
  EXPECT_EQ(
      errors_of("<Node dt='0.01'><StaticSolver/><NewtonRaphsonSolver/><SparseLDLSolver/>" + kFrame +
                "<UniformMass totalMass='1'/></Node>"),
      "test.scn:1: error: StaticSolver: the frames of MechanicalObject 'frames' need an EulerImplicitSolver or an "
      "explicit integrator");
  EXPECT_EQ(errors_of("<Node><EulerImplicitSolver/><SparseLDLSolver/><RegularGridTopology/><MechanicalObject/>"
                      "<UniformMass totalMass='1'/><Node><MechanicalObject position='0 0 0'/><RigidMapping/></Node>"
                      "</Node>"),
            "test.scn:1: error: RigidMapping: needs rigid frames (a MechanicalObject with template Rigid3d) above");
}

}  // namespace
