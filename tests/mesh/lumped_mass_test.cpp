// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/lumped_mass.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <bit>
#include <cmath>
#include <numeric>

#include "hexaplast/geometry/grid.hpp"
#include "mesh/consistent_mass.hpp"
#include "support/compare.hpp"
#include "support/shapes.hpp"

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

// The entries of a box: m / 27, halved with each direction in which two corners differ.
TEST(ConsistentMass, OfABoxHalvesFromCornerToCorner) {
  const HexMesh mesh = regular_grid({1, 1, 1}, Vec3(1, 2, 3), Vec3(1.5, 4, 7));
  const ConsistentMass mass(mesh.positions(), mesh.hexahedra(), std::vector<double>{27});
  BlockMatrix A(8);
  mass.add_blocks(2, A);
  for (int n = 0; n < 8; ++n) {
    EXPECT_NEAR(mass.row_sums()[n], 27. / 8, 1e-14);
    ASSERT_EQ(A.row(n).size(), 8u);
    for (const BlockMatrix::Entry& entry : A.row(n)) {
      const int differences = std::popcount(static_cast<unsigned>(n ^ entry.column));  // nodes are numbered by bits
      EXPECT_TRUE(entry.block.isApprox(2 * std::pow(0.5, differences) * Mat3::Identity(), 1e-13));
    }
  }
}

TEST(ConsistentMass, ProductAndBlocksAgreeSumUpToTheMassAndArePositive) {
  const HexMesh mesh = support::distorted_block({2, 3, 2}, 0.3, 0.2, 17);
  const std::vector<double> volumes = element_volumes(mesh.positions(), mesh.hexahedra());
  const ConsistentMass mass(mesh.positions(), mesh.hexahedra(), volumes);
  EXPECT_NEAR(mass.row_sums().sum(), std::accumulate(volumes.begin(), volumes.end(), 0.0), 1e-14);

  support::Random random(5);
  const PointArray dx = random.field(mesh.num_nodes(), 1);
  PointArray product = PointArray::Zero(mesh.num_nodes(), 3), by_blocks = product;
  mass.add_product(3, dx, product);
  BlockMatrix A(mesh.num_nodes());
  mass.add_blocks(3, A);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(mesh.num_nodes(), mesh.num_nodes());
  for (int n = 0; n < mesh.num_nodes(); ++n)
    for (const BlockMatrix::Entry& entry : A.row(n)) {
      by_blocks.row(n) += dx.row(entry.column) * entry.block.transpose();
      dense(n, entry.column) = entry.block(0, 0);
    }
  EXPECT_TRUE(support::agrees(product, by_blocks, 1e-14));
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(dense).info(), Eigen::Success);
}

}  // namespace
