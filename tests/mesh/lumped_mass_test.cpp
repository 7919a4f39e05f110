// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/lumped_mass.hpp"

#include <gtest/gtest.h>

#include "hexaplast/geometry/grid.hpp"

namespace {

using namespace hexaplast;

TEST(LumpedMass, ABoxGivesEachCornerAnEighth) {
  const HexMesh box = regular_grid({1, 1, 1}, Vec3(1, 2, 3), Vec3(1.5, 4, 7));
  EXPECT_TRUE(nodal_volumes(box.positions(), box.hexahedra()).isApprox(Eigen::VectorXd::Constant(8, 0.5), 1e-15));
}

TEST(LumpedMass, SharedNodesAddTheirHexahedra) {
  const HexMesh grid = regular_grid({2, 3, 4}, Vec3::Zero(), Vec3(2, 3, 4));
  const Eigen::VectorXd volume = nodal_volumes(grid.positions(), grid.hexahedra());
  EXPECT_NEAR(volume.sum(), 24, 1e-12);
  EXPECT_DOUBLE_EQ(volume[0], 0.125);                // a corner of the grid
  EXPECT_DOUBLE_EQ(volume[1 + 3 * (1 + 4 * 1)], 1);  // an inner node: eight eighths
}

// An affine map multiplies every volume by its determinant: here 2 * 3 * 0.5, sheared.
TEST(LumpedMass, FollowsAffineMapsExactly) {
  const HexMesh box = regular_grid({1, 1, 1}, Vec3::Zero(), Vec3::Ones());
  Mat3 A;
  A << 2, 0.7, -0.3, 0, 3, 0.9, 0, 0, 0.5;
  const PointArray x = box.positions() * A.transpose();
  EXPECT_NEAR(nodal_volumes(x, box.hexahedra()).sum(), 3, 1e-14);
}

// A frustum, 4 below and 1 above, with plane faces: h/3 (A + sqrt(A B) + B).
TEST(LumpedMass, IsTheVolumeWhereFacesArePlane) {
  ElementPoints x;
  x << 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 0, 0, 3, 1, 0, 3, 1, 1, 3, 0, 1, 3;
  EXPECT_NEAR(six_tetrahedra_volume(x), 3.0 / 3 * (4 + 2 + 1), 1e-14);
}

TEST(LumpedMass, NodesWithoutElementWeighNothing) {
  PointArray x = PointArray::Random(9, 3);
  x.topRows(8) = regular_grid({1, 1, 1}, Vec3::Zero(), Vec3::Ones()).positions();
  const std::vector<Hexahedron> hexahedra = regular_grid({1, 1, 1}, Vec3::Zero(), Vec3::Ones()).hexahedra();
  EXPECT_EQ(nodal_volumes(x, hexahedra)[8], 0);
}

}  // namespace
