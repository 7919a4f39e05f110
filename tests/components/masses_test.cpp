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

}  // namespace
