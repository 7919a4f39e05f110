// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

const Vec3 kNone = Vec3::Zero();

TEST(ConstantForce, OneForceForAllOrOneEachOrATotal) {
  scene::Scene scene =
      read_and_init(four_nodes("<ConstantForceField name='same' indices='3 1' forces='1 2 3'/>"
                               "<ConstantForceField name='each' indices='3 1' forces='1 0 0  0 1 0'/>"
                               "<ConstantForceField name='total' indices='3 1' totalForce='4 0 -2'/>"
                               "<ConstantForceField name='all' totalForce='4 0 0'/>"));
  EXPECT_EQ(force_of(scene, "same", 7), rows({kNone, {1, 2, 3}, kNone, {1, 2, 3}}));
  EXPECT_EQ(force_of(scene, "each", 0), rows({kNone, {0, 1, 0}, kNone, {1, 0, 0}}));
  EXPECT_EQ(force_of(scene, "total", 0), rows({kNone, {2, 0, -1}, kNone, {2, 0, -1}}));
  EXPECT_EQ(force_of(scene, "all", 0), rows({{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(at<scene::ForceField>(scene, "each").loaded_nodes()[0], 1);
}

TEST(Loads, NameWhatIsMissingOrDoesNotFit) {
  expect_errors(
      four_nodes,
      {{"<ConstantForceField indices='3 1'/>",
        "ConstantForceField.forces: is not given, and totalForce neither: one of them is needed"},
       {"<ConstantForceField indices='3 1 0' forces='1 0 0  0 1 0'/>",
        "ConstantForceField.forces: 2 forces given for 3 nodes, must be one or as many"},
       {"<ConstantForceField indices='4' forces='1 0 0'/>", "ConstantForceField.indices: 4 must lie in [0, 4)"},
       {"<LinearForceField points='0' times='0 1' forces='1 0 0'/>",
        "LinearForceField.forces: 1 forces given for 2 times, must be as many"},
       {"<LinearForceField points='0'/>", "LinearForceField.times: is empty, must hold at least one time"},
       {"<PlaneForceField normal='0 0 0'/>", "PlaneForceField.normal: is zero, must have a direction"},
       {"<UniformMass/>", "UniformMass.totalMass: is not given, and vertexMass neither: one of them is needed"}});
}

TEST(LinearForce, NothingBeforeTheFirstTimeLinearBetweenAndTheLastForEver) {
  scene::Scene scene = read_and_init(
      four_nodes("<LinearForceField name='load' points='2 0' times='1 2 4' forces='0 0 0  10 0 -4  0 0 6'/>"
                 "<LinearForceField name='scaled' points='0' times='0 1' forces='1 0 0  2 0 0' force='3'/>"));
  const auto on_node = [&](double time) -> Vec3 { return force_of(scene, "load", time).row(2).transpose(); };
  EXPECT_EQ(on_node(0.99), kNone);
  EXPECT_EQ(on_node(1), kNone);
  EXPECT_EQ(on_node(1.25), Vec3(2.5, 0, -1));
  EXPECT_EQ(on_node(2), Vec3(10, 0, -4));
  EXPECT_EQ(on_node(3), Vec3(5, 0, 1));
  EXPECT_EQ(on_node(4), Vec3(0, 0, 6));
  EXPECT_EQ(on_node(1e6), Vec3(0, 0, 6));
  EXPECT_EQ(force_of(scene, "load", 2),
            rows({{10, 0, -4}, kNone, {10, 0, -4}, kNone}));  // the whole force on each point
  EXPECT_EQ(force_of(scene, "scaled", 0.5)(0, 0), 4.5);
  EXPECT_EQ(force_of(scene, "scaled", 1)(0, 0), 2) << "the factor ends with the history";
}

// Nodes (1,0,0), (0,2,0): each turns around z at its own radius, with the same force.
TEST(TangentialForce, ActsAroundTheAxis) {
  scene::Scene scene = read_and_init(four_nodes(
      "<TangentialForceField name='twist' indices='0 1' axis='0 0 -5' centre='0 0 9' times='0 1' forces='4 8'/>"));
  EXPECT_TRUE(force_of(scene, "twist", 0.5).isApprox(rows({{0, -6, 0}, {6, 0, 0}, kNone, kNone}), 1e-15));
  EXPECT_EQ(force_of(scene, "twist", -1e-9), rows({kNone, kNone, kNone, kNone}));
}

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
}

Eigen::VectorXd masses_of(scene::Scene& scene, std::string_view path) {
  PointArray f = PointArray::Zero(at<scene::MechanicalState>(scene, "nodes").num_nodes(), 3);
  at<scene::Mass>(scene, path).add_gravity(Vec3(0, 0, 1), f);
  return f.col(2);
}

TEST(Mass, UniformMassIsTheTotalSharedOrTheOneOfEachNode) {
  scene::Scene scene =
      read_and_init(four_nodes("<UniformMass name='total' totalMass='6' vertexMass='9'/>"
                               "<UniformMass name='each' vertexMass='9'/>"));
  EXPECT_EQ(masses_of(scene, "total"), Eigen::VectorXd::Constant(4, 1.5));
  EXPECT_EQ(masses_of(scene, "each"), Eigen::VectorXd::Constant(4, 9));
}

// Two boxes of .5 x 1 x 2: a node of one cell gets an eighth of its mass, a shared one two.
TEST(Mass, DiagonalMassGivesEachNodeItsEighths) {
  const auto two_cells = [](const std::string& mass) {
    return in_root("gravity='0 0 0'",
                   "<RegularGridTopology n='3 2 2' max='1 1 2'/><MechanicalObject name='nodes'/>" + mass);
  };
  scene::Scene scene =
      read_and_init(two_cells("<DiagonalMass name='density' massDensity='10'/>"
                              "<DiagonalMass name='total' totalMass='4' massDensity='10'/>"
                              "<DiagonalMass name='none'/>"
                              "<DiagonalMass name='nodal' vertexMass='1 2 3 4 5 6 7 8 9 10 11 12'/>"));
  const Eigen::VectorXd density = masses_of(scene, "density");
  ASSERT_EQ(density.size(), 12);
  for (int n = 0; n < 12; ++n) EXPECT_NEAR(density[n], n % 3 == 1 ? 2.5 : 1.25, 1e-15) << n;
  EXPECT_TRUE(masses_of(scene, "total").isApprox(density * 0.2, 1e-15));
  EXPECT_TRUE(masses_of(scene, "none").isApprox(density * 0.05, 1e-15));
  EXPECT_EQ(masses_of(scene, "nodal")[4], 5);
  EXPECT_EQ(errors_of(two_cells("<DiagonalMass vertexMass='1 2'/>")),
            "test.scn:1: error: DiagonalMass.vertexMass: 2 values given for 12 nodes, must be one or one per node");
}

}  // namespace
