// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::force_of;
using support::four_nodes;
using support::in_root;
using support::read_and_init;
using support::rows;

std::string box(const std::string& load) {
  return in_root("gravity='0 0 0'",
                 "<RegularGridTopology name='grid' n='3 2 2' max='4 1 3'/><MechanicalObject name='nodes'/>"
                 "<UniformMass vertexMass='1'/>" +
                     load);
}

// The face x = 4 of 1 x 3: half of the force to each of its triangles' sides.
TEST(SurfacePressure, ActsOnTheFacesOfABoxAtTheirPresentShape) {
  scene::Scene scene =
      read_and_init(box("<SurfacePressureForceField name='load' pressure='10' min='3.9 -1 -1' max='4.1 2 4'/>"));
  PointArray f = force_of(scene, "load", 0);
  EXPECT_TRUE(f.colwise().sum().isApprox(Eigen::RowVector3d(30, 0, 0), 1e-15));
  EXPECT_TRUE(f.row(2).isApprox(Eigen::RowVector3d(10, 0, 0), 1e-15));
  EXPECT_TRUE(f.row(5).isApprox(Eigen::RowVector3d(5, 0, 0), 1e-15));
  EXPECT_EQ(at<scene::ForceField>(scene, "load").loaded_nodes().size(), 4u);

  at<scene::MechanicalState>(scene, "nodes").positions().col(1) *= 2;  // twice the area, still in the box
  EXPECT_TRUE(force_of(scene, "load", 0).isApprox(2 * f, 1e-15));
  at<scene::MechanicalState>(scene, "nodes").positions().col(0) *= 3;  // out of the box
  EXPECT_TRUE(force_of(scene, "load", 0).isZero(0));
}

TEST(SurfacePressure, TakesQuadsAndTrianglesByNumber) {
  const std::string mesh =
      "<MeshTopology name='mesh' position='0 0 0  2 0 0  2 2 0  0 2 0' quads='0 1 2 3' triangles='0 1 2  0 3 2'/>"
      "<MechanicalObject name='nodes'/><UniformMass vertexMass='1'/>";
  const auto total = [&](const std::string& load) {
    scene::Scene scene = read_and_init(in_root("", mesh + load));
    return Vec3(force_of(scene, "load", 0).colwise().sum().transpose());
  };
  EXPECT_EQ(total("<SurfacePressureForceField name='load' pressure='3' quadIndices='0' triangleIndices='1'/>"),
            Vec3(0, 0, 12 - 6));
  EXPECT_EQ(total("<SurfacePressureForceField name='load' pressure='3'/>"), Vec3(0, 0, 12));
  EXPECT_EQ(errors_of(in_root("", mesh + "<SurfacePressureForceField quadIndices='1'/>")),
            "test.scn:1: error: SurfacePressureForceField.quadIndices: 1 must lie in [0, 1)");
}

// A mass of 1 kg thrown against a wall at z = 0 with k = 500, c = 5, by the implicit scheme with K and without the
// wall's damping in the matrix.
TEST(Plane, CatchesAMassByTheDiscreteLaw) {
  scene::Scene scene = read_and_init(
      "<Node dt='0.01' gravity='0 0 -10'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/>"
      "<MechanicalObject name='nodes' position='0 0 0.05' velocity='0 0 -1'/><UniformMass vertexMass='1'/>"
      "<PlaneForceField normal='0 0 1'/></Node>");
  const double h = 0.01, k = 500, c = 5;
  double z = 0.05, v = -1, lowest = 0;
  for (int step = 0; step < 60; ++step) {
    scene.step();
    const bool touches = z < 0;
    const double force = -10 + (touches ? -k * z + c * z * v : 0);
    v += h * (force - (touches ? h * k * v : 0)) / (1 + (touches ? h * h * k : 0));
    z += h * v;
    lowest = std::min(lowest, z);
    ASSERT_NEAR(at<scene::MechanicalState>(scene, "nodes").positions()(0, 2), z, 1e-12) << step;
  }
  EXPECT_LT(lowest, -0.02);
  EXPECT_NE(errors_of(four_nodes("<PlaneForceField normal='0 0 0'/>")), "");
}

}  // namespace
