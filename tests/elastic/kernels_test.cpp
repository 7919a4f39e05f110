// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels on every instruction set of this machine; tests/plain compares all options.
#include <gtest/gtest.h>

#include <cmath>

#include "base/simd.hpp"
#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "kinematics/polar.hpp"
#include "plain/plain.hpp"
#include "plastic/flow.hpp"
#include "plastic/flow_pass.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
namespace {

using support::kEdge;
using support::Random;

/// Restores the choice of the instruction set.
class OnEverySet : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { set_simd_target(GetParam()); }
  void TearDown() override { set_simd_target(""); }
};
INSTANTIATE_TEST_SUITE_P(Simd, OnEverySet, testing::ValuesIn(simd_targets()),
                         [](const auto& test) { return test.param; });

/// Gradients of every kind: any, small strains, singular ones, inside out, with equal and nearly equal stretches, of
/// all sizes.
Mat3 gradient_of_kind(int kind, Random& random) {
  const Mat3 any = random.field(3, 1), turn = random.rotation(), other = random.rotation();
  const Vec3 d = random.field(1, 1).row(0).transpose();
  switch (kind) {
    case 0:
      return any;
    case 1:
      return turn * (Mat3::Identity() + 0.1 * any);
    case 2:
      return turn * Vec3(d[0], d[1], 0).asDiagonal() * other;
    case 3:
      return turn * Vec3(d[0], 0, 0).asDiagonal() * other;
    case 4:
      return turn * Vec3(1, 1, -std::abs(d[0])).asDiagonal() * other;
    case 5:
      return turn * Vec3(1, 1 + 1e-9 * d[1], 1 - 1e-12 * d[2]).asDiagonal() * other;
    case 6:
      return any * std::pow(10.0, 150 * d[0]);
    default:
      return Mat3::Zero();
  }
}

TEST_P(OnEverySet, RotationsAreThoseOfTheSingularValueDecomposition) {
  constexpr int kKinds = 8;
  const int count = GetParam() == simd_targets().front() ? 1000000 : 40000;
  Random random(96);
  std::vector<Mat3> F(count), R(count);
  for (int k = 0; k < count; ++k) F[k] = gradient_of_kind(k % kKinds, random);
  rotations(F, R);
  double orthogonal = 0, determinant = 0, different = 0;
  int num_unique = 0;
  for (int k = 0; k < count; ++k) {
    ASSERT_TRUE(R[k].allFinite()) << F[k];
    orthogonal = std::max(orthogonal, support::max_abs(R[k].transpose() * R[k] - Mat3::Identity()));
    determinant = std::max(determinant, std::abs(R[k].determinant() - 1));
    if (count > 100000 && k % 10 > 0) continue;  // the comparison is the slow part
    const SignedSvd svd = signed_svd(F[k]);
    if (!(svd.d[1] + svd.d[2] > 1e-3 * svd.d[0])) continue;  // not unique, or barely
    ++num_unique;
    different = std::max(different, support::max_abs(R[k] - polar(svd).R));
  }
  EXPECT_LE(orthogonal, 1e-12);
  EXPECT_LE(determinant, 1e-12);
  EXPECT_LE(different, 1e-10);
  EXPECT_GT(num_unique, count / 100);
}

/// One plastic step of a body of `cells` whose every corner yields; `size` is that of the displacements, in edges.
Body flown(std::array<int, 3> cells, double distortion, YieldNorm norm, double size = 0.1,
           Precision precision = Precision::kDouble) {
  Material material;
  material.yield_stress = 500 * size;
  material.flow_rate = 5;
  material.hardening = 0.3;
  const Settings settings{.yield_norm = norm, .precision = precision};
  Body body(support::distorted_block(cells, kEdge, distortion, 93), {material}, settings);
  Random random(94);
  body.flow(body.mesh().positions() + random.field(body.mesh().num_nodes(), size * kEdge), 0.01);
  return body;
}

/// What a step adds to a history has these errors: of lengths in units of the edge, and of angles and strains.
double rounding_of_flow(Precision precision) { return precision == Precision::kDouble ? 1e-14 : 5e-8; }

void expect_the_same_flow(const History& found, const History& expected, const Model& model, double rounding) {
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const ElementHistory one = found.element(e), plainly = expected.element(e);
    const Lame& lame = model.lame[e];
    EXPECT_LE(support::max_abs(one.rest_shape - plainly.rest_shape), rounding * kEdge);
    for (int i = 0; i < kCorners; ++i) {
      EXPECT_LE(support::max_abs(one.plastic_stretch[i] - plainly.plastic_stretch[i]), rounding);
      EXPECT_LE(support::max_abs(one.plastic_inverse[i] - plainly.plastic_inverse[i]), rounding);
      EXPECT_NEAR(one.yield_stress[i], plainly.yield_stress[i], 0.1 * rounding * (3 * lame.lambda + 2 * lame.mu));
      EXPECT_NEAR(one.rotation_yield[i], plainly.rotation_yield[i], 10 * rounding);
      EXPECT_NEAR(one.plastic_strain[i], plainly.plastic_strain[i], rounding);
    }
  }
}

void expect_the_flow_of_the_elements(YieldNorm norm, double size, Precision precision) {
  const Body body = flown({3, 2, 3}, 0.15, norm, size, precision);
  const Model& model = body.state().model;
  History expected(model);
  Random random(94);
  const PointArray x = body.mesh().positions() + random.field(body.mesh().num_nodes(), size * kEdge);
  PreconditionedConjugateGradients solver(1e-6, 10000);
  ASSERT_EQ(plain::flow(model, x, 0.01, solver, expected).yielded, body.mesh().num_elements());
  expect_the_same_flow(body.state().history, expected, model, rounding_of_flow(precision));
}

TEST_P(OnEverySet, FlowIsThatOfTheElements) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    for (const YieldNorm norm : {YieldNorm::kVonMises, YieldNorm::kFrobenius})
      for (const double size : {0.001, 0.01, 0.03, 0.1})  // power series of every length
        expect_the_flow_of_the_elements(norm, size, precision);
}

/// Whether flow_block does all elements of a bar of constant volume with this stretch, to the result of the plain way.
bool flows_in_lanes(double stretch) {
  const HexMesh mesh = support::distorted_block({4, 4, 2}, kEdge, 0.1, 95);
  const Model model(mesh, {Material{.yield_stress = 10, .flow_rate = 20, .fracture_stretch = 3}}, {});
  History history(model), trial = history;
  Random random(96);
  const Mat3 turn = random.rotation(),
             F = turn * Vec3(stretch, 1 / std::sqrt(stretch), 1 / std::sqrt(stretch)).asDiagonal();
  PointArray x = mesh.positions() * F.transpose();
  Linearization at(model);
  linearize(model, history, x, at);
  std::vector<ElementFlow> flows(mesh.num_elements());
  for (int block = 0; block < model.partition->num_blocks; ++block)
    if (flow_block(model, at, 0.01, history, {}, block, trial, flows.data()) != 0) return false;

  History expected = history;
  PreconditionedConjugateGradients solver(1e-6, 10000);
  EXPECT_EQ(plain::flow(model, x, 0.01, solver, expected).yielded, mesh.num_elements());
  expect_the_same_flow(trial, expected, model, rounding_of_flow(Precision::kDouble));
  return true;
}

TEST_P(OnEverySet, LargeStretchesFlowInLanes) {
  for (const double stretch : {0.35, 0.6, 1.05, 1.6, 2.5, 3.8}) EXPECT_TRUE(flows_in_lanes(stretch)) << stretch;
  EXPECT_FALSE(flows_in_lanes(7));
}

/// Plastic strain of sixteen separate cubes that are stretched alike, but for one of them, which is pushed through
/// itself as far as makes S + tr S / 3 singular. -1: none is.
std::vector<double> strains_beside(int pushed, Precision precision) {
  PointArray X(16 * kCorners, 3), x = X;
  std::vector<Hexahedron> cubes(16);
  for (int e = 0; e < 16; ++e) {
    const Vec3 stretch = e == pushed ? Vec3(1, 1, -0.5) : e % 2 ? Vec3(3, 1, 1) : Vec3(5, 0.6, 0.6);
    const PointArray cube = support::block({1, 1, 1}, 1).positions();
    for (int a = 0; a < kCorners; ++a) {
      const int n = kCorners * e + a;
      X.row(n) = cube.row(a) + Vec3(3 * e, 0, 0).transpose();
      x.row(n) = cube.row(a) * stretch.asDiagonal() + Vec3(10 * e, 0, 0).transpose();
      cubes[e][a] = kCorners * e + support::block({1, 1, 1}, 1).hexahedra()[0][a];
    }
  }
  Body body(HexMesh(X, cubes), {{.young_modulus = 1000, .poisson_ratio = 0.3, .yield_stress = 1, .flow_rate = 50}},
            {.precision = precision});
  body.flow(x, 0.01);
  std::vector<double> strains;
  for (int e = 0; e < 16; ++e) strains.push_back(body.plastic_strain()[e][0]);
  return strains;
}

TEST_P(OnEverySet, LanesAreAsAccurateBesideOneThatFails) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    const std::vector<double> alone = strains_beside(-1, precision);
    for (int pushed = 0; pushed < 16; ++pushed) {
      const std::vector<double> beside = strains_beside(pushed, precision);
      for (int e = 0; e < 16; ++e) {
        if (e == pushed) continue;
        EXPECT_NEAR(beside[e], alone[e], rounding_of_flow(precision)) << e << " beside " << pushed;
      }
    }
  }
}

TEST_P(OnEverySet, GiveTheSameBitsForAnyThreadCount) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 3, 7}) {
    set_num_threads(threads);
    hashes.push_back(support::hash_of(flown({17, 16, 15}, 0.1, YieldNorm::kVonMises)));  // several chunks
  }
  set_num_threads(1);
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes.front());
}

TEST(Simd, NamesItsSetsAndRefusesOthers) {
  EXPECT_EQ(simd_target(), simd_targets().front());
  EXPECT_TRUE(support::refuses<InputError>([] { set_simd_target("ABACUS"); }, {"ABACUS", simd_targets().front()}));
}

}  // namespace
}  // namespace hexaplast
