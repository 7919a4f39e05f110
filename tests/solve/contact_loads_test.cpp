// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/contact_loads.hpp"

#include "hexaplast/mesh/faces.hpp"
#include "support/core.hpp"

namespace hexaplast {
namespace {

// On a closed surface the force is the gradient of pressure times enclosed volume, and has neither sum nor moment.
TEST(Pressure, OnAClosedSurfaceIsTheGradientOfTheVolume) {
  const HexMesh mesh = distorted_block({1, 1, 1}, 0.4, 0.2, 7);
  const std::vector<Quad> faces = faces_of(mesh.hexahedra());
  const PointArray x = mesh.positions();
  PointArray f = PointArray::Zero(8, 3);
  for (const Quad& face : faces) add_pressure(face, 300, x, f);

  for (int n = 0; n < 8; ++n)
    for (int i = 0; i < 3; ++i) {
      const double slope = central_difference(
          [&](double h) {
            PointArray nudged = x;
            nudged(n, i) += h;
            return 300 * enclosed_volume(nudged, faces);
          },
          1e-6);
      EXPECT_NEAR(f(n, i), slope, 1e-7);
    }
  EXPECT_LE(max_abs(f.colwise().sum()), 1e-13);
  EXPECT_LE(max_abs(moment(x, f)), 1e-13);
}

TEST(Obstacle, PushesBackWhatIsBehindItAndNothingElse) {
  const Obstacle wall{.normal = Vec3(0.6, 0, 0.8), .distance = 1, .stiffness = 200, .damping = 3};
  PointArray x(3, 3), v(3, 3);
  x << 0, 4, 0, /* in front */ 3, 0, 0, 0.6, 7, 0.5;  // depths 1, -.8 and .24
  v << 1, 2, 3, 1, 2, 3, -1, 0, 2;
  PointArray f = PointArray::Zero(3, 3);
  wall.add_force(x, v, f);
  std::vector<int> stiff{7};
  wall.stiff_at(x, v, stiff);
  EXPECT_EQ(stiff, (std::vector<int>{0, 2}));
  EXPECT_TRUE(f.row(0).isApprox(200 * Eigen::RowVector3d(0.6, 0, 0.8) - 3 * v.row(0), 1e-14));
  EXPECT_TRUE(f.row(1).isZero(0));
  EXPECT_TRUE(f.row(2).isApprox(0.24 * (200 * Eigen::RowVector3d(0.6, 0, 0.8) - 3 * v.row(2)), 1e-13));
}

TEST(Obstacle, LimitsItsForceAndHasNoStiffnessThere) {
  const Obstacle weak{.stiffness = 1000, .damping = 0, .max_force = 5};
  PointArray x(3, 3), v = PointArray::Zero(3, 3), f = PointArray::Zero(3, 3);
  x << 0, -2, 0, 0, 0.001, 0, 0, -0.004, 0;
  weak.add_force(x, v, f);
  EXPECT_TRUE(f.isApprox((PointArray(3, 3) << 0, 5, 0, 0, 0, 0, 0, 4, 0).finished(), 1e-15));
  std::vector<int> stiff;
  weak.stiff_at(x, v, stiff);
  EXPECT_EQ(stiff, std::vector<int>{2});
}

TEST(Obstacle, StiffnessIsTheSlopeOfItsForceAndEqualToItsBlocks) {
  const Obstacle wall{.normal = Vec3(0.6, 0, 0.8), .distance = 1, .stiffness = 200, .damping = 0};
  Random random(3);
  const PointArray x = random.field(4, 0.3), dx = random.field(4, 1), v = PointArray::Zero(4, 3);  // all are behind
  std::vector<int> stiff;
  wall.stiff_at(x, v, stiff);
  ASSERT_EQ(stiff.size(), 4u);

  PointArray df = PointArray::Zero(4, 3), ahead = df, behind = df;
  wall.add_stiffness_product(stiff, 2, dx, df);
  wall.add_force(x + 1e-3 * dx, v, ahead);
  wall.add_force(x - 1e-3 * dx, v, behind);
  EXPECT_TRUE(agrees(df, 2 * (ahead - behind) / 2e-3, 1e-10));

  BlockMatrix A(4);
  wall.add_stiffness_blocks(stiff, 2, A);
  for (int n = 0; n < 4; ++n) {
    ASSERT_EQ(A.row(n).size(), 1u);
    EXPECT_TRUE(agrees(A.row(n)[0].block * dx.row(n).transpose(), df.row(n).transpose(), 1e-14));
  }
}

}  // namespace
}  // namespace hexaplast
