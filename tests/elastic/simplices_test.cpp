// SPDX-License-Identifier: LGPL-2.1-or-later
// Tetrahedra and triangles of SOFA. Where SOFA takes them: components/sofa_trajectories_test.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "elastic/corotated_triangles.hpp"
#include "elastic/dense_tetrahedra.hpp"
#include "hexaplast/base/error.hpp"
#include "support/compare.hpp"
#include "support/shapes.hpp"

namespace hexaplast::simplices {
namespace {

const std::vector<Lame> kLame = {lame(700, 0.3)};

PointArray five_points() {
  PointArray x(5, 3);
  x << 0, 0.1, 0, 1, -0.1, 0.2, 0.3, 1.2, 0, 0.1, 0.2, 0.9, 1.1, 1, 1.2;
  return x;
}
const std::vector<DenseTetrahedra::Corners> kTwo = {{0, 1, 2, 3}, {4, 2, 1, 3}};
const std::vector<Triangle> kTriangles = {{0, 1, 2}, {2, 1, 4}};

PointArray moved(const PointArray& x) {
  const Mat3 R = rotation_exp(Vec3(0.4, -0.9, 0.7));
  return (x * R.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 5);
}

template <class Elements>
PointArray force_at(Elements& elements, const PointArray& x) {
  PointArray f = PointArray::Zero(x.rows(), 3);
  elements.add_force(x, f);
  return f;
}

template <class Elements>
void expect_blocks_to_be_products(Elements& elements, const PointArray& x) {
  force_at(elements, x);
  BlockMatrix K(elements.num_nodes());
  elements.add_stiffness_blocks(-2, K);
  for (int n = 0; n < elements.num_nodes(); ++n)
    for (int axis = 0; axis < 3; ++axis) {
      PointArray dx = PointArray::Zero(x.rows(), 3), df = dx, of_blocks = dx;
      dx(n, axis) = 1;
      elements.add_stiffness_product(-2, dx, df);
      for (int row = 0; row < K.num_nodes(); ++row)
        for (const BlockMatrix::Entry& entry : K.row(row))
          if (entry.column == n) of_blocks.row(row) += entry.block.col(axis).transpose();
      EXPECT_LT(support::max_abs(df - of_blocks), 1e-10);
    }
}

TEST(DenseTetrahedra, ResistStretchAndNotRigidMotion) {
  for (const TetrahedronFrame frame : {TetrahedronFrame::kFirstEdges, TetrahedronFrame::kPolar}) {
    const PointArray rest = five_points();
    DenseTetrahedra elements(rest, kTwo, kLame, frame);
    EXPECT_LT(support::max_abs(force_at(elements, moved(rest))), 1e-10);
    PointArray x = rest;
    x.col(0) *= 1.1;
    const PointArray f = force_at(elements, x);
    EXPECT_GT(support::max_abs(f), 1);
    EXPECT_LT(f.colwise().sum().norm(), 1e-10);
    // a motion of the whole turns the forces
    const Mat3 R = rotation_exp(Vec3(0.4, -0.9, 0.7));
    EXPECT_LT(support::max_abs(force_at(elements, moved(x)) - f * R.transpose()), 1e-9);
    expect_blocks_to_be_products(elements, moved(x));
  }
}

// A uniaxial strain of a tetrahedron with three edges along the axes: f = -V g stress.
TEST(DenseTetrahedra, HaveTheStressOfTheirStrain) {
  PointArray rest = PointArray::Zero(4, 3);
  rest.bottomRows(3) = 2 * Mat3::Identity();
  DenseTetrahedra elements(rest, {{0, 1, 2, 3}}, kLame, TetrahedronFrame::kWorld);
  PointArray x = rest;
  x(1, 0) = 2.02;  // 1 %
  const PointArray f = force_at(elements, x);
  const double volume = 8.0 / 6, axial = (kLame[0].lambda + 2 * kLame[0].mu) * 0.01, across = kLame[0].lambda * 0.01;
  EXPECT_NEAR(f(1, 0), -volume / 2 * axial, 1e-12);
  EXPECT_NEAR(f(2, 1), -volume / 2 * across, 1e-12);
  EXPECT_NEAR(f(0, 0), volume / 2 * axial, 1e-12);
  // the order of the corners does not matter
  DenseTetrahedra mirrored(rest, {{0, 2, 1, 3}}, kLame, TetrahedronFrame::kWorld);
  EXPECT_LT(support::max_abs(force_at(mirrored, x) - f), 1e-12);
}

TEST(DenseTetrahedra, RefuseWhatHasNoVolume) {
  EXPECT_THROW(DenseTetrahedra(five_points(), {{0, 1, 2, 2}}, kLame), InputError);
  EXPECT_THROW(DenseTetrahedra(five_points(), {{0, 1, 2, 5}}, kLame), InputError);
  EXPECT_THROW(DenseTetrahedra(five_points(), kTwo, std::vector<Lame>(3, kLame[0])), InputError);
}

TEST(CorotatedTriangles, ResistStretchAndNotRigidMotion) {
  const PointArray rest = five_points();
  const std::vector<CorotatedTriangles::Membrane> membrane = {{.young_modulus = 50, .poisson_ratio = 0.3}};
  CorotatedTriangles elements(rest, kTriangles, membrane);
  EXPECT_LT(support::max_abs(force_at(elements, moved(rest))), 1e-11);
  PointArray x = rest;
  x.col(0) *= 1.1;
  const PointArray f = force_at(elements, x);
  EXPECT_GT(support::max_abs(f), 0.1);
  EXPECT_LT(f.colwise().sum().norm(), 1e-11);
  expect_blocks_to_be_products(elements, moved(x));
  EXPECT_THROW(CorotatedTriangles(rest, {{0, 1, 1}}, membrane), InputError);
  x.row(1) = x.row(0);
  EXPECT_THROW(force_at(elements, x), NumericalError);
}

// A right triangle, stretched along its first edge: plane stress E/(1 - nu^2) and plane strain lambda + 2 mu.
TEST(CorotatedTriangles, HaveTheStressOfTheirStrain) {
  PointArray rest = PointArray::Zero(3, 3);
  rest(1, 0) = 2;
  rest(2, 1) = 2;
  PointArray x = rest;
  x(1, 0) = 2.02;
  for (const bool is_plane_strain : {false, true}) {
    const std::vector<CorotatedTriangles::Membrane> membrane = {
        {.young_modulus = 700, .poisson_ratio = 0.3, .is_plane_strain = is_plane_strain}};
    CorotatedTriangles elements(rest, {{0, 1, 2}}, membrane);
    const double modulus = is_plane_strain ? kLame[0].lambda + 2 * kLame[0].mu : 700 / (1 - 0.09);
    const double strain = 0.02 / 2.02;  // of the present shape
    EXPECT_NEAR(force_at(elements, x)(1, 0), -2 * modulus * strain / 2.02, 1e-12);
  }
}

}  // namespace
}  // namespace hexaplast::simplices
