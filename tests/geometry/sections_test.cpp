// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/sections.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

TEST(EndSections, LieAcrossTheLongestAxis) {
  const HexMesh mesh = regular_grid({2, 5, 1}, Vec3(0, -1, 0), Vec3(0.2, 1, 0.3));
  const EndSections ends = end_sections(mesh);
  EXPECT_EQ(ends.axis, 1);
  EXPECT_DOUBLE_EQ(ends.length, 2);
  EXPECT_EQ(ends.min, nodes_at(mesh, 1, -1));
  EXPECT_EQ(ends.max, nodes_at(mesh, 1, 1));
}

TEST(Elongation, IsTheMeanChangeOfLength) {
  const HexMesh mesh = block({2, 2, 6}, 0.1);
  const EndSections ends = end_sections(mesh);
  EXPECT_NEAR(elongation(ends, mapped(mesh.positions(), Vec3(0.8, 0.9, 1.3).asDiagonal(), Vec3(1, 2, 3))), 0.3, 1e-14);
}

TEST(SectionAngle, IsTheAngleOfBestFit) {
  Random random(71);
  const HexMesh mesh = block({3, 3, 2}, 0.1);
  const std::vector<int> section = nodes_at(mesh, 2, 0.2);
  for (const double angle : {-3.0, -1.0, 0.3, 2.5}) {
    // stretched as well as turned and moved along: none of these is a turn
    const Mat3 A = rotation_exp(Vec3(0, 0, angle)) * Vec3(1.1, 1.1, 2).asDiagonal();
    EXPECT_NEAR(section_angle(mesh, section, 2, mapped(mesh.positions(), A, random.vector(1))), angle, 1e-12);
  }
}

TEST(Twist, CountsFullTurns) {
  const HexMesh mesh = block({2, 2, 12}, 0.1);
  for (const double turns : {-2.25, 0.1, 0.75, 2.5}) {
    const double angle = turns * 2 * std::numbers::pi;
    EXPECT_NEAR(twist(mesh, end_sections(mesh), stretched_and_twisted(mesh, 1, angle)), angle, 1e-10);
  }
}

TEST(Twist, OfARigidTurnAboutTheAxisIsZero) {
  const HexMesh mesh = block({2, 2, 6}, 0.1);
  const PointArray turned = mapped(mesh.positions(), rotation_exp(Vec3(0, 0, 3.1)), Vec3(1, 2, 3));
  EXPECT_NEAR(twist(mesh, end_sections(mesh), turned), 0, 1e-12);
}

TEST(AxialPull, IsTheSameForOneLoadedEndAndForTwo) {
  const HexMesh mesh = regular_grid({2, 2, 5}, Vec3(0, 0, -1), Vec3(0.2, 0.2, 2));
  const EndSections ends = end_sections(mesh);
  PointArray forces = PointArray::Zero(mesh.num_nodes(), 3);
  const auto load = [&](const std::vector<int>& section, double force) {
    for (const int n : section) forces.row(n) += Vec3(3, -1, force / static_cast<double>(section.size())).transpose();
  };
  load(ends.max, 7);
  EXPECT_NEAR(axial_pull(mesh, ends, forces), 7, 1e-12);
  load(ends.min, -7);
  EXPECT_NEAR(axial_pull(mesh, ends, forces), 7, 1e-12);
  load(ends.max, -7);
  EXPECT_NEAR(axial_pull(mesh, ends, forces), 7, 1e-12);
  EXPECT_NEAR(axial_pull(mesh, ends, -forces), -7, 1e-12);  // it is compressed
}

}  // namespace
}  // namespace hexaplast
