// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_ONE_NUMBER
#include "kernel_backend.hpp"
#include "kinematics/polar.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"
#include "plastic/isolated_flow.hpp"
#include "plastic/point_flow-inl.hpp"
#include "support/archive.hpp"
#include "support/core.hpp"
#include "support/history.hpp"

namespace hexaplast {
namespace {

constexpr YieldNorm kNorms[] = {YieldNorm::kVonMises, YieldNorm::kFrobenius, YieldNorm::kSpectral};

// Whatever the axes are.
TEST(StressNorm, HasTheHandValues) {
  const Mat3 R = Random(51).rotation();
  const Mat3 sigma = R * Vec3(300, -100, -500).asDiagonal() * R.transpose();
  const Mat3 tension = R * Vec3(-700, 0, 0).asDiagonal() * R.transpose();
  for (const YieldNorm norm : kNorms) EXPECT_NEAR(stress_norm(tension, norm), 700, 1e-10);
  EXPECT_NEAR(stress_norm(sigma, YieldNorm::kVonMises), std::sqrt(0.5 * (400. * 400 + 400. * 400 + 800. * 800)), 1e-10);
  EXPECT_NEAR(stress_norm(sigma, YieldNorm::kFrobenius), std::sqrt(350000.0), 1e-10);
  EXPECT_NEAR(stress_norm(sigma, YieldNorm::kSpectral), 500, 1e-10);
}

TEST(Hardened, GrowsByWhatFlowsAndIsNeverNegative) {
  const auto hardened = HWY_NAMESPACE::hardened<double>;
  EXPECT_DOUBLE_EQ(hardened(300, 2, 0.01, 400), 308);
  EXPECT_EQ(hardened(300, -100, 0.01, 400), 0);
  EXPECT_EQ(hardened(300, 2, 0, 400), 300);
  // infinity times zero is no number, and nothing flows beyond it
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(hardened(kInfinity, -2, 0, 400), kInfinity);
  EXPECT_EQ(hardened(300, kInfinity, 0, 400), 300);
}

TEST(RestoreVolume, ScalesLengthsByTheRateTimesTheErrorAndWithinAFactorOfTwo) {
  const auto scale = [](double volume_ratio, double rate, double dt) {
    return HWY_NAMESPACE::restitution_scale(volume_ratio, rate * dt);
  };
  EXPECT_DOUBLE_EQ(scale(1.2, 5, 0.01), 1 - 0.05 * 0.2);
  EXPECT_DOUBLE_EQ(scale(0.7, 5, 0.01), 1 + 0.05 * 0.3);
  EXPECT_EQ(scale(1 + 1e-13, 1e12, 1), 1);  // rounding of volumes is left alone
  EXPECT_DOUBLE_EQ(scale(3, 50, 0.01), 0.5);
  EXPECT_DOUBLE_EQ(scale(-5, 50, 0.01), 2);
}

/// kSoft, as far as those rest shapes have it.
Material soft(RestShape rest_shape) { return rest_shape == RestShape::kJoined ? kSoft : stretching(300); }

class OfRestShapes : public testing::TestWithParam<RestShape> {};
INSTANTIATE_TEST_SUITE_P(Flow, OfRestShapes, testing::Values(RestShape::kJoined, RestShape::kIsolated),
                         [](const auto& test) { return test.param == RestShape::kJoined ? "joined" : "isolated"; });

TEST_P(OfRestShapes, ChangeNothingBelowYield) {
  Random random(151);
  Material m = soft(GetParam());
  m.yield_stress = 1e5;
  m.rotation_yield = 0.5;
  Body body(distorted_block({2, 2, 3}, kEdge, 0.15, 152), {m}, {.rest_shape = GetParam()});
  const std::string before = hash_of(body);
  for (int k = 0; k < 20; ++k) {
    const PointArray current =
        mapped(PointArray(body.mesh().positions() + random.field(36, 0.1 * kEdge)), random.rotation());
    EXPECT_EQ(body.flow(current, kStep).yielded, 0);
  }
  EXPECT_EQ(hash_of(body), before);
}

TEST(Flow, ChangesNothingAtRest) {
  Material m = kSoft;
  m.yield_stress = 0;
  m.rotation_yield = 0;
  for (const double distortion : {0.0, 0.15}) {
    Body body(distorted_block({2, 2, 3}, kEdge, distortion, 155), {m}, kJoined);
    const PointArray rest = body.mesh().positions();
    for (int k = 0; k < 1000; ++k) body.flow(rest, kStep);
    // without any threshold rounding itself may flow, but it must not add up
    EXPECT_LE(max_abs(body.state().history.plastic_rest_positions - rest), 1e-15) << distortion;
  }
}

TEST_P(OfRestShapes, KeepFlowOfRigidMotionsAtNothing) {
  Random random(153);
  Body body(distorted_block({2, 2, 2}, kEdge, 0.15, 154), {soft(GetParam())}, {.rest_shape = GetParam()});
  const std::string before = hash_of(body);
  for (int k = 0; k < 100; ++k) body.flow(mapped(body.mesh().positions(), random.rotation(), random.vector(1)), kStep);
  EXPECT_EQ(hash_of(body), before);
}

// One hexahedron of any shape held at a homogeneous stretch: tensors disappear, and a recursion of two numbers remains.
TEST(Flow, OfAHeldHexahedronFollowsTheScalarLaw) {
  Random random(155);
  for (const YieldNorm norm : kNorms) {
    for (const double stretch : {0.8, 1.4}) {
      const ElementPoints X = distorted_hexahedron(kEdge, 0.2, 156);
      Settings settings = published_element();
      settings.yield_norm = norm;
      Body body(single_element(X), {kSoft}, settings);
      const Mat3 Q = random.rotation();
      const auto uniaxial = [&](double log_stretch) {
        return Mat3(Q *
                    Vec3(std::exp(-log_stretch / 2), std::exp(-log_stretch / 2), std::exp(log_stretch)).asDiagonal() *
                    Q.transpose());
      };
      const PointArray current = mapped(PointArray(X), random.rotation() * uniaxial(std::log(stretch)));
      const Lame k = lame(kSoft.young_modulus, kSoft.poisson_ratio);

      double elastic = std::log(stretch), tau = kSoft.yield_stress;  // along the axis
      // steps so small that what the averaging's regularisation leaves of each, 1e-7, is below the tolerance
      const double dt = 0.05 * kStep;
      for (int step = 0; step < 600; ++step) {
        const double n = stress_norm(corotated_stress(uniaxial(elastic), k), norm);
        const double gamma = std::max(0.0, kSoft.flow_rate * dt * (n - tau) / n);
        elastic *= 1 - gamma;
        tau += kSoft.hardening * gamma * n;
        body.flow(current, dt);

        for (const double actual : body.state().history.yield_stress[0])
          ASSERT_NEAR(actual, tau, 1e-9 * tau) << "step " << step;
        // the plastic rest shape is free to turn, so compare Fp^T Fp
        const Mat3 U = uniaxial(std::log(stretch) - elastic);
        for (int a = 0; a < kCorners; ++a) {
          const Mat3 Fp = corner_jacobian(ElementPoints(body.state().history.plastic_rest_positions), a) *
                          corner_jacobian(X, a).inverse();
          ASSERT_LE((Fp.transpose() * Fp - U * U).cwiseAbs().maxCoeff(), 1e-10) << "step " << step;
        }
      }
      EXPECT_LT(std::abs(elastic), 0.7 * std::abs(std::log(stretch)));
    }
  }
}

/// A step of a body whose linearization says which hexahedra are at rest, and of one that looks at all of them.
int expect_the_same_without_a_screen(Body& screened, const PointArray& x) {
  const auto skip_screening = [](Body& body, bool skips) {
    dynamic_cast<KernelBackend&>(*body.state().backend).skips_screening = skips;
  };
  skip_screening(screened, false);
  Body all = screened;
  all.linearize(screened.mesh().positions());
  skip_screening(all, true);
  const int yielded = screened.flow(x, kStep).yielded;
  EXPECT_EQ(all.flow(x, kStep).yielded, yielded);
  EXPECT_EQ(hash_of(all), hash_of(screened));
  return yielded;
}

// Most of the bar does not yield.
TEST(Flow, IsTheSameWithAndWithoutAScreen) {
  for (const YieldNorm norm : kNorms) {
    Body body(block({16, 3, 3}, kEdge), {stretching(300)}, {.yield_norm = norm});
    for (int step = 0; step < 12; ++step) {
      PointArray x = body.mesh().positions();
      const double end = (step < 8 ? 3.5 : 6.5) * kEdge;
      for (int n = 0; n < x.rows(); ++n)
        if (x(n, 0) < end) x(n, 0) -= 0.02 * (step + 8) * (end - x(n, 0));
      const int yielded = expect_the_same_without_a_screen(body, x);
      EXPECT_TRUE(yielded > 0 && yielded < body.mesh().num_elements()) << yielded;
    }
  }
}

// At the yield stress but for a fraction, far from the axes. Single precision takes some of these stresses for larger
// than it, and does so with a screen, too.
TEST(Flow, IsTheSameWithAndWithoutAScreenAtSmallStrains) {
  for (const double strain : {1e-1, 1e-2, 1e-3, 1e-4})
    for (const double fraction : {1e-6, 2e-5, 1e-4, 1e-3, 1e-2})
      for (const Precision precision : {Precision::kDouble, Precision::kMixed})
        for (const double plastic_stretch : {1.0, 1.5, 3.0, 0.2}) {
          SCOPED_TRACE(testing::Message() << strain << ' ' << fraction << ' ' << plastic_stretch);
          const double stress = 3 * lame(kSoft.young_modulus, kSoft.poisson_ratio).mu * strain;
          Body body(block({4, 3, 3}, kEdge), {stretching(stress * (1 + fraction))}, {.precision = precision});
          const Mat3 plastic = Vec3(plastic_stretch, 1 / plastic_stretch, 1).asDiagonal(),
                     elastic = Vec3(1 + strain, 1 - strain / 2, 1 - strain / 2).asDiagonal();
          for (CornerTensors& G : body.state().history.plastic_inverse) G.fill(plastic.inverse());
          take_flowed(body);
          expect_the_same_without_a_screen(
              body, mapped(body.mesh().positions(), rotation_exp(Vec3(0.7, 0.4, -0.9)) * elastic * plastic));
        }
}

// Where a part has flowed, the body is linearized anew there alone.
TEST(Flow, OfAPartLeavesTheForcesAndProductsOfAFreshBody) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    const HexMesh mesh = distorted_block({24, 8, 8}, kEdge, 0.1, 159);  // several chunks
    Body body(mesh, {stretching(300)}, {.precision = precision}), fresh = body;
    PointArray x = mesh.positions();
    for (int step = 0; step < 5; ++step) {
      for (int n = 0; n < x.rows(); ++n)
        if (x(n, 0) < 3.5 * kEdge) x(n, 0) -= 0.15 * (3.5 * kEdge - x(n, 0));
      const auto force_and_product = [&](Body& of) {
        of.linearize(x);
        PointArray both = PointArray::Zero(2 * x.rows(), 3);
        of.add_force(both.topRows(x.rows()));
        of.add_stiffness_product(1, x, both.bottomRows(x.rows()));
        return both;
      };
      force_and_product(body);
      const int yielded = body.flow(x, kStep).yielded;
      EXPECT_GT(yielded, 0);
      EXPECT_LT(yielded, mesh.num_elements() / 2);
      load(fresh, saved(body));
      ASSERT_EQ(force_and_product(body), force_and_product(fresh)) << step;
    }
  }
}

/// After a bar was bent, twisted and held for 600 steps; `placed`: each step elsewhere, far from the origin.
Body bent_bar(Precision precision, bool placed) {
  Body body(distorted_block({8, 3, 3}, kEdge, 0.1, 77), {stretching(100)}, {.precision = precision});
  const PointArray X = body.mesh().positions();
  for (int step = 0; step < 600; ++step) {
    PointArray x = X;
    const double angle = 0.8 * std::min(step / 300.0, 1.0);
    for (int n = 0; n < x.rows(); ++n) {
      const double along = X(n, 0) / (8 * kEdge);
      x.row(n) = X.row(n) * rotation_exp(Vec3(angle * along, angle * along, 0)).transpose();
      x(n, 0) *= 1 + 0.3 * angle * along;
    }
    if (placed) x = mapped(x, rotation_exp(Vec3(0.01 * step, 1, 2)), Vec3(30, -20, 10));
    body.flow(x, kStep);
  }
  return body;
}

TEST(Flow, InSinglePrecisionIsThatInDoubleWhateverThePose) {
  Body exact = bent_bar(Precision::kDouble, false);
  ASSERT_GT(*std::max_element(exact.plastic_strain().back().begin(), exact.plastic_strain().back().end()), 0.1);
  for (const bool placed : {false, true}) {
    Body body = bent_bar(Precision::kMixed, placed);
    EXPECT_LE(max_abs(body.plastic_rest_positions() - exact.plastic_rest_positions()), 1e-6 * kEdge) << placed;
    EXPECT_NEAR(body.dissipated_energy(), exact.dissipated_energy(), 1e-6 * exact.dissipated_energy());
    for (int e = 0; e < body.mesh().num_elements(); ++e)
      EXPECT_LE(max_abs(body.element_rest_shape(e) - exact.element_rest_shape(e)), 1e-6 * kEdge) << e;
    const auto &found = body.state().history.plastic_inverse, &expected = exact.state().history.plastic_inverse;
    for (std::size_t e = 0; e < found.size(); ++e)
      for (int i = 0; i < kCorners; ++i) EXPECT_LE(max_abs(found[e][i] - expected[e][i]), 1e-5) << e;
  }
}

/// Fraction of a small displacement u of a cube that one full step makes permanent, by stretch or rotation flow or
/// both.
double permanent_fraction(Bending bending, const ElementPoints& X, const ElementPoints& u, bool stretch,
                          bool rotation) {
  const Material all_at_once{
      .yield_stress = 0, .flow_rate = stretch ? 1 / kStep : 0, .rotation_flow_rate = rotation ? 1 / kStep : 0};
  Body body(single_element(X), {all_at_once},
            {.bending = bending, .rest_shape = RestShape::kJoined, .volume_restitution = 0});
  body.flow(PointArray(X + u), kStep);
  const ElementPoints moved = body.state().history.rest_shape[0] - X;
  return moved.cwiseProduct(u).sum() / u.squaredNorm();
}

TEST(PlasticStep, SharesTwistBendAndStretchBetweenStretchAndRotation) {
  const ElementPoints X = cube(kEdge);
  ElementPoints twist, bend, stretch;
  const double small = 1e-3;
  for (int a = 0; a < kCorners; ++a) {
    const Vec3 s = X.row(a).transpose() / kEdge;
    twist.row(a) << -s[1] * s[2], s[0] * s[2], 0;
    bend.row(a) << s[0] * s[2], -s[1] * s[2], 0;   // in two planes at once, so that it keeps the volume
    stretch.row(a) << -s[0] / 2, -s[1] / 2, s[2];  // likewise: pressure never flows
  }
  const struct {
    ElementPoints u;
    double by_stretch, by_stretch_where_shear_is_assumed;  // the rest by rotation
  } modes[] = {{twist, 0.25, 0.25}, {bend, 0.75, 0.5}, {stretch, 1, 1}};
  for (const Bending bending : {Bending::kBlended, Bending::kAssumedCorner})
    for (const auto& mode : modes) {
      const ElementPoints u = small * kEdge * mode.u;
      const double by_stretch = bending == Bending::kBlended ? mode.by_stretch : mode.by_stretch_where_shear_is_assumed;
      EXPECT_NEAR(permanent_fraction(bending, X, u, true, false), by_stretch, 2 * small);
      EXPECT_NEAR(permanent_fraction(bending, X, u, false, true), 1 - by_stretch, 2 * small);
      EXPECT_NEAR(permanent_fraction(bending, X, u, true, true), 1, 2 * small);
    }
}

TEST(Flow, OfAHeldShapeDoesNotDriftInTenThousandSteps) {
  Body body(block({1, 1, 3}, kEdge), {kSoft}, kJoined);
  const HexMesh& mesh = body.mesh();
  const PointArray current = stretched_and_twisted(mesh, 1.3, 0);
  for (int k = 0; k < 10000; ++k) body.flow(current, kStep);
  const PointArray& x = body.state().history.plastic_rest_positions;
  EXPECT_GT(elongation(end_sections(mesh), x), 0.1);
  EXPECT_LE((x.colwise().mean() - mesh.positions().colwise().mean()).norm(), 1e-10);
  EXPECT_NEAR(body.volume(x) / body.initial_volume(), 1, 1e-10);
  const Mat3 moment =
      (x.rowwise() - x.colwise().mean()).transpose() * (mesh.positions().rowwise() - mesh.positions().colwise().mean());
  EXPECT_LE(rotation_log(polar(moment).R).norm(), 1e-6);
}

// The upper one of two cubes is flattened, or turned inside out.
TEST(Guard, LeavesElasticWhatIsInvertedOrNearlySo) {
  const HexMesh mesh = block({1, 1, 2}, kEdge);
  const std::vector<double> relaxing = {1, 0.2};
  for (Settings settings : std::vector<Settings>{kJoined,
                                                 {},
                                                 {.implementation = Implementation::kPlain},
                                                 {.relaxation = relaxing},
                                                 {.relaxation = relaxing, .implementation = Implementation::kPlain},
                                                 {.relaxation = relaxing, .rest_shape = RestShape::kJoined}})
    for (const auto& [height, threshold] : {std::pair(0.09, 0.1), {0.09, 0.08}, {-1.0, 0.1}})
      for (const Material& material :
           {Material{.yield_stress = 1, .flow_rate = 5}, Material{.yield_stress = 1e9, .flow_rate = 5}, Material{}}) {
        const bool is_relaxing = !settings.relaxation.empty();
        if (is_relaxing && settings.rest_shape == RestShape::kJoined && material.flow_rate > 0) continue;
        SCOPED_TRACE(testing::Message() << height << ' ' << threshold << ' ' << material.yield_stress);
        settings.inversion_threshold = threshold;
        Body body(mesh, {material}, settings);
        body.set_time_step(kStep);
        PointArray x = mesh.positions();
        x.bottomRows(4).col(2).array() = (1 + height) * kEdge;
        const std::string before = hash_of(body);
        const FlowReport report = body.flow(x, kStep);
        const bool flows = height > threshold && material.yield_stress == 1;
        EXPECT_EQ(report.inverted, height < 0);
        EXPECT_EQ(report.skipped, height < threshold);
        EXPECT_EQ(report.yielded, flows);
        EXPECT_TRUE(is_relaxing || (hash_of(body) == before) == !flows);
      }
}

// Two unconnected bars are stretched; hexahedra of the first have rest shapes that fit no mesh.
TEST(Guard, RollsBackTheConnectedPartAloneThatAveragingWouldFlatten) {
  const HexMesh one = block({2, 1, 3}, kEdge), mesh = two_copies(one, 1);
  const Model model(mesh, {kSoft}, kJoined), model_alone(one, {kSoft}, kJoined);
  History history(model), alone(model_alone);
  Random random(4);
  for (int e = 0; e < one.num_elements(); ++e)
    history.rest_shape[e] = about_mean(history.rest_shape[e] + ElementPoints(random.field(8, 0.8 * kEdge)));
  const PointArray stretched = stretched_and_twisted(one, 1.2, 0.3);
  PointArray current(mesh.num_nodes(), 3);
  current << stretched, mapped(stretched, Mat3::Identity(), Vec3(1, 0, 0));

  PreconditionedConjugateGradients solver(1e-12, 10000);
  const auto flowed = [&](const Model& of, const PointArray& x, History& to) {
    return plain::flow(of, x, kStep, solver, to);
  };
  const FlowReport report = flowed(model, current, history);
  const FlowReport report_alone = flowed(model_alone, stretched, alone);
  EXPECT_EQ(report.rolled_back, one.num_elements());
  EXPECT_EQ(report_alone.yielded, one.num_elements());
  EXPECT_EQ(report_alone.rolled_back, 0);
  EXPECT_EQ(report.yielded, report_alone.yielded);

  const int n = one.num_nodes();
  EXPECT_EQ(history.plastic_rest_positions.topRows(n), one.positions());
  const PointArray other = history.plastic_rest_positions.bottomRows(n);
  EXPECT_GT(max_abs(alone.plastic_rest_positions - one.positions()), 1e-4 * kEdge);
  EXPECT_LE(max_abs(other - mapped(alone.plastic_rest_positions, Mat3::Identity(), Vec3(1, 0, 0))), 1e-9 * kEdge);
  EXPECT_NEAR(history.dissipated_energy, alone.dissipated_energy, 1e-9 * alone.dissipated_energy);
}

TEST(Flow, FineBodiesAreAtRestInSpiteOfRounding) {
  // edges of 2 mm, 2 m away from the origin: positions, and with them volumes, are rounded to 1e-13 of an edge
  HexMesh mesh = block({2, 2, 100}, 0.002);
  const PointArray X = mesh.positions().rowwise() + Eigen::RowVector3d(2.1, -1.7, 0.3);
  Body body(HexMesh(X, mesh.hexahedra()), {Material{.yield_stress = 1e9, .flow_rate = 1}}, kJoined);
  const FlowReport report = body.flow(X, 0.01);
  EXPECT_TRUE(report.averaging.skipped);
  EXPECT_EQ(report.worst_volume_error, 0) << "some element was not passed over";
}

}  // namespace
}  // namespace hexaplast
