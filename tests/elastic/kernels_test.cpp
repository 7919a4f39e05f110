// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels on every instruction set of this machine; tests/plain compares all options.
#define HEXAPLAST_ONE_NUMBER
#include "base/simd.hpp"
#include "base/tensors-inl.hpp"
#include "hwy/targets.h"
#include "kinematics/polar-inl.hpp"
#include "kinematics/polar.hpp"
#include "plain/plain.hpp"
#include "support/core.hpp"
#include "support/history.hpp"

namespace hexaplast {
namespace {

/// Restores the choice of the instruction set.
class OnEverySet : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { set_simd_target(GetParam()); }
  void TearDown() override { set_simd_target(""); }
};
INSTANTIATE_TEST_SUITE_P(Simd, OnEverySet, testing::ValuesIn(simd_targets()),
                         [](const auto& test) { return test.param; });

// The form of the lanes, here of one double.
TEST(ClosedForm, IsThePolarDecompositionWhereItIsNotDoubtful) {
  Random random(96);
  double orthogonal = 0, determinant = 0, different = 0;
  int num_compared = 0;
  constexpr int kCount = 100000;
  for (int k = 0; k < kCount; ++k) {
    const Mat3 F = gradient_of_kind(k % 8, random);
    const auto closed = HWY_NAMESPACE::polar(HWY_NAMESPACE::entries(F));
    if (closed.doubtful != 0) continue;
    const Mat3 R = to_eigen(closed.R);
    ASSERT_TRUE(R.allFinite()) << F;
    orthogonal = std::max(orthogonal, max_abs(R.transpose() * R - Mat3::Identity()));
    determinant = std::max(determinant, std::abs(R.determinant() - 1));
    different = std::max(different, max_abs(R - polar(F).R));
    ++num_compared;
  }
  EXPECT_LE(orthogonal, 1e-12);
  EXPECT_LE(determinant, 1e-12);
  EXPECT_LE(different, 1e-10);
  EXPECT_GT(num_compared, kCount / 2);
}

/// A body whose every corner yields at displacements of this size, in edges.
Body yielding_body(std::array<int, 3> cells, double distortion, double size, Settings settings) {
  const Material material{.yield_stress = 500 * size, .flow_rate = 5, .hardening = 0.3};
  return Body(distorted_block(cells, kEdge, distortion, 93), {material}, settings);
}
PointArray displaced(const Body& body, double size) {
  return body.mesh().positions() + Random(94).field(body.mesh().num_nodes(), size * kEdge);
}

/// What a step adds to a history has these errors: of lengths in units of the edge, and of angles and strains.
double rounding_of_flow(Precision precision) { return precision == Precision::kDouble ? 1e-14 : 5e-8; }

/// A step of a body of which all hexahedra flow, against that of the plain implementation.
void expect_the_flow_of_the_elements(Body body, const PointArray& x) {
  const Model& model = body.state().model;
  History expected(model);
  PreconditionedConjugateGradients solver(1e-6, 10000);
  ASSERT_EQ(plain::flow(model, x, 0.01, solver, expected).yielded, body.mesh().num_elements());
  body.flow(x, 0.01);
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    expect_same_history(body.state().history.element(model, e), expected.element(model, e), model.lame[e], kEdge,
                        rounding_of_flow(model.settings.precision));
}

TEST_P(OnEverySet, FlowIsThatOfTheElements) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed})
    for (const YieldNorm norm : {YieldNorm::kVonMises, YieldNorm::kFrobenius})
      for (const double size : {0.001, 0.01, 0.03, 0.1}) {  // power series of every length
        const Body body = yielding_body({3, 2, 3}, 0.15, size, {.yield_norm = norm, .precision = precision});
        expect_the_flow_of_the_elements(body, displaced(body, size));
      }
  for (const double stretch : {0.35, 0.6, 1.6, 2.5, 3.8, 7.0}) {
    const Body body = yielding_body({4, 4, 2}, 0.1, 0.02, {});
    const Mat3 F = Random(96).rotation() * Vec3(stretch, 1 / std::sqrt(stretch), 1 / std::sqrt(stretch)).asDiagonal();
    expect_the_flow_of_the_elements(body, mapped(body.mesh().positions(), F));
  }
}

/// Plastic strain of sixteen separate cubes that are stretched alike, but for one of them, which is pushed through
/// itself as far as makes S + tr S / 3 singular. -1: none is.
std::vector<double> strains_beside(int pushed, Precision precision) {
  PointArray X(16 * kCorners, 3), x = X;
  std::vector<Hexahedron> cubes(16);
  for (int e = 0; e < 16; ++e) {
    const Vec3 stretch = e == pushed ? Vec3(1, 1, -0.5) : e % 2 ? Vec3(3, 1, 1) : Vec3(5, 0.6, 0.6);
    const PointArray cube = block({1, 1, 1}, 1).positions();
    for (int a = 0; a < kCorners; ++a) {
      const int n = kCorners * e + a;
      X.row(n) = cube.row(a) + Vec3(3 * e, 0, 0).transpose();
      x.row(n) = cube.row(a) * stretch.asDiagonal() + Vec3(10 * e, 0, 0).transpose();
      cubes[e][a] = kCorners * e + block({1, 1, 1}, 1).hexahedra()[0][a];
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
  expect_the_same_for_any_threads([] {
    Body body = yielding_body({17, 16, 15}, 0.1, 0.1, {});  // several chunks
    body.flow(displaced(body, 0.1), 0.01);
    return hash_of(body);
  });
}

TEST(Simd, NamesItsSetsAndRefusesOthers) {
  EXPECT_EQ(simd_target(), simd_targets().front());
  EXPECT_TRUE(refuses<InputError>([] { set_simd_target("ABACUS"); }, {"ABACUS", simd_targets().front()}));
}

TEST(Simd, RefusesBodiesOnAProcessorWithoutAnySet) {
  hwy::SetSupportedTargetsForTest(HWY_SCALAR);
  EXPECT_TRUE(refuses<InputError>(
      [] {
        Body(block({1, 1, 1}, 1), {Material{}});
      },
      {"this processor", "instruction sets"}));
  set_simd_target("");
}

}  // namespace
}  // namespace hexaplast
