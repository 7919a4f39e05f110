// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include "hexaplast/body.hpp"
#include "support/compare.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::errors_of;
using support::four_nodes;
using support::in_root;
using support::read_and_init;

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
  EXPECT_EQ(errors_of(four_nodes("<UniformMass/>")),
            "test.scn:1: error: UniformMass.totalMass: is not given, and vertexMass neither: one of them is needed");
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

TEST(Mass, MovesWithItsEnergy) {
  scene::Scene scene = read_and_init(in_root("gravity='0 0 0'",
                                             "<MechanicalObject name='nodes' position='0 0 0  1 1 1' "
                                             "velocity='3 0 4  0 1 0'/><UniformMass vertexMass='2'/>"));
  EXPECT_DOUBLE_EQ(at<scene::OdeSolver>(scene, "euler").kinetic_energy(), 26);
}

// One box of 10 kg/m^3, 1 x 1 x 4 m as it stands and half as large in each direction at rest.
TEST(MeshMatrixMass, CouplesNodesUnlessLumped) {
  const auto product = [](const std::string& mass) {
    scene::Scene scene =
        read_and_init(in_root("gravity='0 0 0'",
                              "<RegularGridTopology n='2 2 2' max='1 1 2'/><MechanicalObject name='nodes' "
                              "scale3d='1 1 2' restScale='0.5'/><MeshMatrixMass name='mass' " +
                                  mass + "/>"));
    PointArray dx = PointArray::Zero(8, 3), df = dx;
    dx(0, 1) = 1;
    at<scene::Mass>(scene, "mass").add_product(1, dx, df);
    BlockMatrix A(8);
    at<scene::Mass>(scene, "mass").add_blocks(1, A);
    for (const auto& entry : A.row(0)) EXPECT_NEAR(entry.block(1, 1), df(entry.column, 1), 1e-14);
    PointArray weight = PointArray::Zero(8, 3);
    at<scene::Mass>(scene, "mass").add_gravity(Vec3(0, 0, 1), weight);
    EXPECT_NEAR(at<scene::Mass>(scene, "mass").kinetic_energy(dx), df(0, 1) / 2, 1e-14);
    return std::pair(Eigen::VectorXd(df.col(1)), weight.col(2).sum());
  };
  const auto& [coupled, weight] = product("massDensity='10'");
  EXPECT_NEAR(weight, 40, 1e-13);
  Eigen::VectorXd expected(8);
  expected << 8, 4, 4, 2, 4, 2, 2, 1;
  EXPECT_TRUE(coupled.isApprox(expected * 40 / 216, 1e-13)) << coupled;
  EXPECT_TRUE(product("massDensity='10' lumping='true'").first.isApprox(5 * Eigen::VectorXd::Unit(8, 0), 1e-14));
  EXPECT_NEAR(product("massDensity='10' computeMassOnRest='true'").second, 40. / 8, 1e-14);
  EXPECT_NEAR(product("totalMass='3'").second, 3, 1e-14);
  EXPECT_NEAR(product("").second, 1, 1e-14);
}

// The coupled mass enters the operator: (M - h^2 K) dv = h f on a free box.
// 8/27 of a hexahedron's mass between every two of its corners.
TEST(HexahedronFEMForceFieldAndMass, CouplesAllCornersAlike) {
  for (const bool is_lumped : {false, true}) {
    scene::Scene scene = support::read_and_init(
        support::in_root("gravity='0 0 -2'",
                         "<RegularGridTopology n='3 2 2' max='2 3 0.5'/><MechanicalObject name='nodes'/>"
                         "<HexahedronFEMForceFieldAndMass name='own' density='4' lumpedMass='" +
                             std::string(is_lumped ? "true" : "false") + "'/>"));
    auto& mass = dynamic_cast<scene::MassMatrix&>(support::at<scene::ForceField>(scene, "own"));
    PointArray dx = PointArray::Zero(12, 3), df = PointArray::Zero(12, 3), weight = df;
    dx(0, 1) = 1;
    mass.add_product(3, dx, df);
    const double entry = 8.0 / 27 * 6;  // 4 kg/m^3, 1 x 3 x 0.5 m^3
    EXPECT_NEAR(df(0, 1), 3 * entry * (is_lumped ? 8 : 1), 1e-12);
    EXPECT_NEAR(df(1, 1), is_lumped ? 0 : 3 * entry, 1e-12);
    EXPECT_EQ(df(2, 1), 0);  // of the other hexahedron
    mass.add_gravity(Vec3(0, 0, -2), weight);
    EXPECT_NEAR(weight.col(2).sum(), -2 * 12, 1e-12);
    BlockMatrix A(12);
    mass.add_blocks(3, A);
    for (const BlockMatrix::Entry& block : A.row(1))
      if (block.column == 0) {
        EXPECT_NEAR(block.block(1, 1), is_lumped ? 0 : 3 * entry, 1e-12);
      }
    EXPECT_NEAR(mass.kinetic_energy(PointArray::Ones(12, 3)), 0.5 * 3 * 2 * 64 * entry, 1e-10);
  }
}

TEST(Mass, IsNeeded) {
  const std::string text =
      support::in_root("gravity='0 0 -2'",
                       "<RegularGridTopology/><MechanicalObject name='nodes'/><HexahedronElastoplasticFEMForceField/>"
                       "<FixedProjectiveConstraint indices='0-3'/>");
  EXPECT_EQ(support::errors_of(text),
            "test.scn:1: error: EulerImplicitSolver: no mass on MechanicalObject 'nodes' of its node and below");
}

TEST(MeshMatrixMass, EntersTheSystem) {
  for (const std::string solver :
       {"<SparseLDLSolver/>", "<CGLinearSolver iterations='99' tolerance='1e-14' threshold='0'/>"}) {
    scene::Scene scene = read_and_init(
        "<Node gravity='0 0 -2' dt='0.5'><DefaultAnimationLoop/><EulerImplicitSolver/>" + solver +
        "<RegularGridTopology n='2 2 2'/><MechanicalObject name='nodes'/><MeshMatrixMass name='mass' massDensity='10'/>"
        "<HexahedronElastoplasticFEMForceField name='body' youngModulus='100'/>"
        "<ConstantForceField indices='3' forces='0 4 0'/></Node>");
    const PointArray still = PointArray::Zero(8, 3);
    PointArray elastic = still;
    scene.step();
    const PointArray& v = at<scene::MechanicalState>(scene, "nodes").velocities();
    auto& body = at<scene::ForceField>(scene, "body");
    PointArray momentum = still;
    at<scene::Mass>(scene, "mass").add_product(1, v, momentum);
    body.add_force(0, at<scene::MechanicalState>(scene, "nodes").rest_positions(), still, elastic);
    body.add_stiffness_product(-0.25, v, momentum);

    PointArray expected = still;
    expected.col(2).setConstant(0.5 * -2 * 10. / 8);
    expected(3, 1) = 0.5 * 4;
    EXPECT_LE(support::max_abs(momentum - expected), 1e-12);
  }
}

}  // namespace
