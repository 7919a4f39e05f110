// SPDX-License-Identifier: LGPL-2.1-or-later
// A body whose boundary follows an affine motion finds it inside, on any hexahedra.
#include <cmath>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "kinematics/gradients.hpp"
#include "kinematics/polar.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::mapped;

/// Minus df/dx with the nodes of the boundary pinned.
class InteriorStiffness final : public LinearSystem {
 public:
  InteriorStiffness(const Body& body, const std::vector<bool>& is_fixed) : body_(body), is_fixed_(is_fixed) {}

  int num_nodes() const override { return body_.mesh().num_nodes(); }

  void apply(ConstPoints p, Points Ap) const override {
    Ap.setZero();
    body_.add_stiffness_product(-1, p, Ap);
    for (int n = 0; n < num_nodes(); ++n) {
      if (is_fixed_[n]) Ap.row(n).setZero();
    }
  }

  void assemble(BlockMatrix& A) const override {
    body_.add_stiffness_blocks(-1, A);
    for (int n = 0; n < num_nodes(); ++n) {
      for (int axis = 0; axis < 3 && is_fixed_[n]; ++axis) A.pin(n, axis);
    }
  }

 private:
  const Body& body_;
  const std::vector<bool>& is_fixed_;
};

/// Moves the free nodes of x until the body is in equilibrium.
void relax(Body& body, const std::vector<bool>& is_fixed, PointArray& x) {
  CholeskySolver solver;
  PointArray f(x.rows(), 3), dx(x.rows(), 3);
  for (int iteration = 0; iteration < 100; ++iteration) {
    f.setZero();
    body.linearize(x);
    body.add_force(f);
    for (int n = 0; n < x.rows(); ++n) {
      if (is_fixed[n]) f.row(n).setZero();
    }
    solver.solve(InteriorStiffness(body, is_fixed), f, dx);
    x += dx;
    if (support::max_abs(dx) < 1e-16) return;
  }
}

/// MacNeal and Harder's solid patch: a unit cube around a distorted hexahedron, seven elements in all. One corner of
/// the element in front is reentrant.
HexMesh macneal_harder_patch() {
  PointArray positions(16, 3);
  for (int a = 0; a < kCorners; ++a) {
    for (int d = 0; d < 3; ++d) positions(a, d) = kCornerSign[a][d] > 0 ? 1 : 0;
  }
  positions.bottomRows(8) << .249, .342, .192, .826, .288, .288, .850, .649, .263, .273, .750, .230, .320, .186, .643,
      .677, .305, .683, .788, .693, .644, .165, .745, .702;
  std::vector<Hexahedron> hexahedra{{8, 9, 10, 11, 12, 13, 14, 15}};
  for (const auto& face : kFaces) {
    // from the outer face, seen from within, to the same face of the inner element
    hexahedra.push_back({face[0], face[3], face[2], face[1], face[0] + 8, face[3] + 8, face[2] + 8, face[1] + 8});
  }
  return HexMesh(positions, hexahedra);
}

TEST(MacNealHarderPatch, HasTheStatedStressEverywhere) {
  Material m;
  m.young_modulus = 1e6;
  m.poisson_ratio = 0.25;
  const Lame k = lame(m.young_modulus, m.poisson_ratio);
  Mat3 expected = Mat3::Constant(400);
  expected.diagonal().setConstant(2000);
  const Mat3 gradient = (Mat3() << 2, 1, 1, 1, 2, 1, 1, 1, 2).finished() * 0.5e-3;  // u = 1e-3 (2x + y + z) / 2, ...
  support::Random random(113);

  for (const bool turned : {false, true}) {
    const Mat3 R = turned ? random.rotation() : Mat3(Mat3::Identity());
    const HexMesh mesh = macneal_harder_patch();
    Body body(mesh, {m});
    std::vector<bool> is_fixed(16, false);
    std::fill_n(is_fixed.begin(), 8, true);
    PointArray x = mapped(mesh.positions(), R);
    x.topRows(8) = mapped(mesh.positions(), R * (Mat3::Identity() + gradient)).topRows(8);
    relax(body, is_fixed, x);

    for (const Hexahedron& corners : mesh.hexahedra()) {
      for (const Mat3& F :
           deformation_gradients(rest_operator(gather(mesh.positions(), corners)), gather(x, corners))) {
        EXPECT_LE((support::corotated_stress(polar(F).S, k) - expected).cwiseAbs().maxCoeff(), 1e-10 * 2000);
        EXPECT_LE((polar(F).R - R).cwiseAbs().maxCoeff(), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace hexaplast
