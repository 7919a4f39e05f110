// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using support::at;
using support::read_and_init;

TEST(ShapeTopology, MakesWhatItsNameSays) {
  scene::Scene scene = read_and_init(
      "<Node><TubeGridTopology name='straight' cells='1 8 4' innerRadius='1' outerRadius='2' length='4'/>"
      "<TubeGridTopology name='bent' cells='1 8 4' innerRadius='1' outerRadius='2' length='10' bend='90'/>"
      "<TubeGridTopology name='along' cells='1 8 4' innerRadius='1' outerRadius='2' centreline='0 0 0  0 0 1  0 0 4'/>"
      "<SheetGridTopology name='sheet' cells='3 2 1' size='3 2' thickness='0.5'/>"
      "<SpherePatchGridTopology name='patch' cells='2 2 1' innerRadius='1' outerRadius='2' angle='90'/></Node>");
  auto& straight = at<scene::Topology>(scene, "straight");
  EXPECT_EQ(straight.positions().rows(), 2 * 8 * 5);
  EXPECT_EQ(straight.hexahedra().size(), 32u);
  EXPECT_EQ(straight.quads().size(), (32u * 6 + 2 * 8 * 4 + 2 * 8) / 2);
  EXPECT_EQ(straight.integers("edges").size(), 2u * (8 * 5 + 2 * 8 * 5 + 2 * 8 * 4));
  EXPECT_DOUBLE_EQ(straight.positions().col(2).maxCoeff(), 4);
  EXPECT_LT((at<scene::Topology>(scene, "along").positions() - straight.positions()).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_NEAR(at<scene::Topology>(scene, "bent").positions().col(0).maxCoeff(), 20 / std::acos(-1), 1e-12);
  EXPECT_EQ(at<scene::Topology>(scene, "sheet").positions().row(0), Eigen::RowVector3d(-1.5, -1, -0.25));
  EXPECT_TRUE(at<scene::Topology>(scene, "patch").positions().row(4).isApprox(Eigen::RowVector3d(0, 0, 1)));
}

// What else makes none is refused by Shapes and Options.
TEST(ShapeTopology, RefusesWhatMakesNone) {
  support::expect_errors(
      [](const std::string& component) { return "<Node><" + component + "/></Node>"; },
      {{"TubeGridTopology cells='1000 1000 1000'", "TubeGridTopology.cells: 1e+09 cells, must be at most 16777216"},
       {"TubeGridTopology innerRadius='2'",
        "TubeGridTopology: an inner radius of 2 m and an outer one of 0.012 m: must be the lesser "
        "one"}});
}

}  // namespace
