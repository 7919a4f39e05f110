// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/flow.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>

#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "kinematics/gradients.hpp"
#include "kinematics/polar.hpp"
#include "plain/plain.hpp"
#include "plastic/point_flow.hpp"
#include "plastic/rest_shape.hpp"
#include "support/bar.hpp"
#include "support/compare.hpp"
#include "support/materials.hpp"
#include "support/motion.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast {
namespace {

using support::hash_of;
using support::kEdge;
using support::kJoined;
using support::kSoft;
using support::kStep;
using support::mapped;
using support::Random;

constexpr YieldNorm kNorms[] = {YieldNorm::kVonMises, YieldNorm::kFrobenius, YieldNorm::kSpectral};

/// kSoft, as far as those rest shapes have it.
Material soft(RestShape rest_shape) { return rest_shape == RestShape::kJoined ? kSoft : support::stretching(300); }

class OfRestShapes : public testing::TestWithParam<RestShape> {};
INSTANTIATE_TEST_SUITE_P(Flow, OfRestShapes, testing::Values(RestShape::kJoined, RestShape::kIsolated),
                         [](const auto& test) { return test.param == RestShape::kJoined ? "joined" : "isolated"; });

TEST_P(OfRestShapes, ChangeNothingBelowYield) {
  Random random(151);
  Material m = soft(GetParam());
  m.yield_stress = 1e5;
  m.rotation_yield = 0.5;
  Body body(support::distorted_block({2, 2, 3}, kEdge, 0.15, 152), {m}, {.rest_shape = GetParam()});
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
    Body body(support::distorted_block({2, 2, 3}, kEdge, distortion, 155), {m}, kJoined);
    const PointArray rest = body.mesh().positions();
    for (int k = 0; k < 1000; ++k) body.flow(rest, kStep);
    // without any threshold rounding itself may flow, but it must not add up
    EXPECT_LE(support::max_abs(body.state().history.plastic_rest_positions - rest), 1e-15) << distortion;
  }
}

TEST_P(OfRestShapes, KeepFlowOfRigidMotionsAtNothing) {
  Random random(153);
  Body body(support::distorted_block({2, 2, 2}, kEdge, 0.15, 154), {soft(GetParam())}, {.rest_shape = GetParam()});
  const std::string before = hash_of(body);
  for (int k = 0; k < 100; ++k) body.flow(mapped(body.mesh().positions(), random.rotation(), random.vector(1)), kStep);
  EXPECT_EQ(hash_of(body), before);
}

// One hexahedron of any shape held at a homogeneous stretch: tensors disappear, and a recursion of two numbers remains.
TEST(Flow, OfAHeldHexahedronFollowsTheScalarLaw) {
  Random random(155);
  for (const YieldNorm norm : kNorms) {
    for (const double stretch : {0.8, 1.4}) {
      const ElementPoints X = support::distorted_hexahedron(kEdge, 0.2, 156);
      Settings settings = published_element();
      settings.yield_norm = norm;
      Body body(support::single_element(X), {kSoft}, settings);
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
        const double n = stress_norm(support::corotated_stress(uniaxial(elastic), k), norm);
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

/// Greatest relative difference, over 1 s, between the stress of a held small strain and its closed form.
double error_of_small_strain(double dt) {
  Material m;
  m.flow_rate = 3;
  m.hardening = 0.2;
  const double strain = 1e-4;
  const Lame k = lame(m.young_modulus, m.poisson_ratio);
  const double initial = 3 * k.mu * strain;  // von Mises stress of diag(-e/2, -e/2, e)
  m.yield_stress = 0.4 * initial;
  const double settled = (m.hardening * initial + m.yield_stress) / (1 + m.hardening);

  Body body(support::block({1, 1, 1}, kEdge), {m});
  const PointArray current = mapped(body.mesh().positions(),
                                    Vec3(std::exp(-strain / 2), std::exp(-strain / 2), std::exp(strain)).asDiagonal());
  double worst = 0;
  for (int step = 1; step * dt <= 1 + 1e-9; ++step) {
    body.flow(current, dt);
    const double expected = settled + (initial - settled) * std::exp(-m.flow_rate * (1 + m.hardening) * step * dt);
    worst = std::max(worst, std::abs(body.fields(current).stress_norm[0] - expected) / initial);
  }
  return worst;
}

TEST(Flow, ConvergesToTheClosedFormOfSmallStrainsInFirstOrder) {
  double before = error_of_small_strain(0.02);
  EXPECT_LT(before, 0.02);
  for (const double dt : {0.01, 0.005, 0.0025}) {
    const double error = error_of_small_strain(dt);
    EXPECT_NEAR(before / error, 2, 0.15) << "dt " << dt;
    before = error;
  }
}

TEST(Flow, OfAPureVolumeChangeMovesNothing) {
  for (const YieldNorm norm : kNorms) {
    Settings settings = kJoined;
    settings.yield_norm = norm;
    Body body(support::distorted_block({2, 2, 2}, kEdge, 0.15, 157), {kSoft}, settings);
    const PointArray X = body.mesh().positions(), current = mapped(X, 1.05 * Mat3::Identity());
    for (int k = 0; k < 50; ++k) body.flow(current, kStep);
    EXPECT_LE(support::max_abs(body.state().history.plastic_rest_positions - X), 1e-12);
    for (const auto& corners : body.state().history.yield_stress) {
      for (const double tau : corners) {
        if (norm == YieldNorm::kVonMises) {
          EXPECT_EQ(tau, 300);
        } else {
          EXPECT_GT(tau, 310);  // these two norms respond to pressure
        }
      }
    }
  }
}

/// The hash of a bar after steps in which its ends flow in turn, or both, or neither.
std::string hash_of_bar_whose_ends_flow(bool copies_it) {
  Material m = kSoft;
  m.yield_stress = 300;
  m.rotation_yield = 0.05;
  Settings settings = kJoined;
  settings.volume_restitution = 0;
  Body body(support::block({16, 3, 3}, kEdge), {m}, settings);
  const PointArray rest = body.mesh().positions();
  int max = 0, min = body.mesh().num_elements();
  for (int step = 0; step < 24; ++step) {
    PointArray current = body.plastic_rest_positions();
    for (int n = 0; n < rest.rows(); ++n) {
      if (step % 4 != 1 && rest(n, 0) < 3.5 * kEdge) current(n, 0) -= 0.2 * (3.5 * kEdge - rest(n, 0));
      if (step % 4 < 2 && rest(n, 0) > 12.5 * kEdge) current(n, 1) += 0.2 * (rest(n, 0) - 12.5 * kEdge);
    }
    if (step % 6 == 5) current = body.plastic_rest_positions();
    const int yielded = body.flow(current, kStep).yielded;
    max = std::max(max, yielded);
    if (yielded > 0) min = std::min(min, yielded);
    if (!copies_it) continue;
    std::stringstream saved;  // without what the plastic step keeps for itself
    body.save(saved);
    body.load(saved);
  }
  EXPECT_GT(min, 0);
  EXPECT_LT(max, body.mesh().num_elements() / 2);
  return hash_of(body);
}

TEST(Flow, LeavesWhatIsAtRestAsItIsWhateverFlowedBefore) {
  EXPECT_EQ(hash_of_bar_whose_ends_flow(false), hash_of_bar_whose_ends_flow(true));
}

/// The hash of two bars of which the first one flows and comes to rest, while most hexahedra go on flowing.
std::string hash_of_bars_of_which_one_rests(bool copies_it) {
  Material m = kSoft;
  m.yield_stress = 100;
  m.flow_rate = 3;
  m.hardening = 0.2;
  Settings settings = kJoined;
  settings.volume_restitution = 33;
  settings.averaging_tolerance = 1e-12;
  settings.averaging_steps = 8;
  const HexMesh two_bars = support::joined(support::block({2, 2, 2}, kEdge),
                                           support::shifted(support::block({8, 2, 2}, kEdge), {0, 20 * kEdge, 0}));
  Body body(two_bars, {m}, settings);
  const PointArray X = body.mesh().positions();
  const int first = 27, rest_begins = 20;
  for (int step = 0; step < 61; ++step) {
    PointArray x = X;
    const double f = 0.075 * std::min(step, rest_begins), bend = step / 30.0;
    Mat3 F;
    F << 1 + 0.1 * f, 0.4 * f, 0.1 * f * f, -0.1 * f, 1 - 0.05 * f, 0.3 * f * f, 0, 0.1 * f, 1;
    if (step < rest_begins)
      x.topRows(first) = X.topRows(first) * F.transpose();
    else
      x.topRows(first) = body.plastic_rest_positions().topRows(first);
    for (int n = first; n < X.rows(); ++n) {
      const double along = X(n, 0), beside = X(n, 1) - 20 * kEdge;
      x(n, 0) += 0.2 * bend * along - bend / kEdge * 0.1 * along * beside;
      x(n, 1) += 0.05 * bend / kEdge * along * along;
      x(n, 2) += 0.03 * bend / kEdge * along * beside;
    }
    body.flow(x, kStep);
    if (!copies_it) continue;
    std::stringstream saved;
    body.save(saved);
    body.load(saved);
  }
  return hash_of(body);
}

TEST(Flow, LeavesAPartAtRestAsItIsWhileOthersFlow) {
  EXPECT_EQ(hash_of_bars_of_which_one_rests(false), hash_of_bars_of_which_one_rests(true));
}

// Most of the bar does not yield.
TEST(Flow, IsTheSameWithAndWithoutAScreen) {
  for (const YieldNorm norm : kNorms) {
    const Model model(support::block({16, 3, 3}, kEdge), {support::stretching(300)}, {.yield_norm = norm});
    History screened(model), all(model);
    FlowWorkspace of_screened(model, screened), of_all(model, all);
    Linearization at(model), positions(model);
    for (int step = 0; step < 12; ++step) {
      PointArray current = model.mesh.positions();
      const double end = (step < 8 ? 3.5 : 6.5) * kEdge;
      for (int n = 0; n < current.rows(); ++n)
        if (current(n, 0) < end) current(n, 0) -= 0.02 * (step + 8) * (end - current(n, 0));
      linearize(model, screened, current, at);
      linearize(model, all, model.mesh.positions(), positions);
      set_positions(model, current, positions);
      const FlowReport report = flow(model, at, kStep, screened, of_screened);
      EXPECT_EQ(flow(model, positions, kStep, all, of_all).yielded, report.yielded);
      EXPECT_GT(report.yielded, 0);
      EXPECT_LT(report.yielded, model.mesh.num_elements());
      for (int e = 0; e < model.mesh.num_elements(); ++e) {
        const ElementHistory one = screened.element(e), other = all.element(e);
        ASSERT_EQ(one.plastic_inverse, other.plastic_inverse) << e;
        ASSERT_EQ(one.yield_stress, other.yield_stress) << e;
        ASSERT_EQ(one.plastic_strain, other.plastic_strain) << e;
      }
    }
  }
}

// Where a part has flowed, the body is linearized anew there alone.
TEST(Flow, OfAPartLeavesTheForcesAndProductsOfAFreshBody) {
  for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
    const HexMesh mesh = support::distorted_block({24, 8, 8}, kEdge, 0.1, 159);  // several chunks
    Body body(mesh, {support::stretching(300)}, {.precision = precision}), fresh = body;
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
      std::stringstream saved;
      body.save(saved);
      fresh.load(saved);
      ASSERT_EQ(force_and_product(body), force_and_product(fresh)) << step;
    }
  }
}

/// Yielding hexahedra of a bar whose stress is the yield stress but for a fraction, at this strain and far from the
/// axes.
int yielded_below(double fraction, double strain, Precision precision, bool is_screened, double plastic_stretch = 1) {
  Material m = kSoft;
  m.yield_stress = 3 * lame(m.young_modulus, m.poisson_ratio).mu * strain * (1 + fraction);
  m.rotation_flow_rate = 0;
  const Settings settings{.precision = precision};
  const Model model(support::block({4, 3, 3}, kEdge), {m}, settings);
  History history(model);
  const Mat3 plastic = Vec3(plastic_stretch, 1 / plastic_stretch, 1).asDiagonal();
  for (CornerTensors& G : history.plastic_inverse) G.fill(plastic.inverse());
  std::ranges::fill(history.has_flowed, 1);
  FlowWorkspace work(model, history);
  Linearization at(model);
  Mat3 stretch = Vec3(1 + strain, 1 - strain / 2, 1 - strain / 2).asDiagonal();
  const PointArray current = mapped(model.mesh.positions(), rotation_exp(Vec3(0.7, 0.4, -0.9)) * stretch * plastic);
  linearize(model, history, is_screened ? current : history.plastic_rest_positions, at);
  if (!is_screened) set_positions(model, current, at);
  return flow(model, at, kStep, history, work).yielded;
}

// Single precision takes some of these stresses for larger than the yield stress, and does so with a screen, too.
TEST(Flow, IsTheSameWithAndWithoutAScreenAtSmallStrains) {
  for (const double strain : {1e-1, 1e-2, 1e-3, 1e-4})
    for (const double fraction : {1e-6, 2e-5, 1e-4, 1e-3, 1e-2})
      for (const Precision precision : {Precision::kDouble, Precision::kMixed})
        for (const double plastic_stretch : {1.0, 1.5, 3.0, 0.2})
          EXPECT_EQ(yielded_below(fraction, strain, precision, true, plastic_stretch),
                    yielded_below(fraction, strain, precision, false, plastic_stretch))
              << strain << ' ' << fraction << ' ' << plastic_stretch;
}

/// After a bar was bent, twisted and held for 600 steps; `placed`: each step elsewhere, far from the origin.
Body bent_bar(Precision precision, bool placed) {
  Body body(support::distorted_block({8, 3, 3}, kEdge, 0.1, 77), {support::stretching(100)}, {.precision = precision});
  const PointArray X = body.mesh().positions();
  for (int step = 0; step < 600; ++step) {
    PointArray x = X;
    const double angle = 0.8 * std::min(step / 300.0, 1.0);
    for (int n = 0; n < x.rows(); ++n) {
      const double along = X(n, 0) / (8 * kEdge);
      x.row(n) = X.row(n) * rotation_exp(Vec3(angle * along, angle * along, 0)).transpose();
      x(n, 0) *= 1 + 0.3 * angle * along;
    }
    if (placed) x = support::mapped(x, rotation_exp(Vec3(0.01 * step, 1, 2)), Vec3(30, -20, 10));
    body.flow(x, kStep);
  }
  return body;
}

TEST(Flow, InSinglePrecisionIsThatInDoubleWhateverThePose) {
  Body exact = bent_bar(Precision::kDouble, false);
  ASSERT_GT(*std::max_element(exact.plastic_strain().back().begin(), exact.plastic_strain().back().end()), 0.1);
  for (const bool placed : {false, true}) {
    Body body = bent_bar(Precision::kMixed, placed);
    EXPECT_LE(support::max_abs(body.plastic_rest_positions() - exact.plastic_rest_positions()), 1e-6 * kEdge) << placed;
    EXPECT_NEAR(body.dissipated_energy(), exact.dissipated_energy(), 1e-6 * exact.dissipated_energy());
    for (int e = 0; e < body.mesh().num_elements(); ++e)
      EXPECT_LE(support::max_abs(body.element_rest_shape(e) - exact.element_rest_shape(e)), 1e-6 * kEdge) << e;
    const auto &found = body.state().history.plastic_inverse, &expected = exact.state().history.plastic_inverse;
    for (std::size_t e = 0; e < found.size(); ++e)
      for (int i = 0; i < kCorners; ++i) EXPECT_LE(support::max_abs(found[e][i] - expected[e][i]), 1e-5) << e;
  }
}

/// Volume ratio of a body whose plastic rest shape starts 3 % too large, after some steps of volume restitution alone.
double volume_ratio_after(int steps, double rate) {
  Settings settings = kJoined;
  settings.volume_restitution = rate;
  const Model model(support::distorted_block({2, 2, 2}, kEdge, 0.15, 158), {kSoft}, settings);
  History history(model);
  const double scale = std::cbrt(1.03);
  history.plastic_rest_positions *= scale;
  for (ElementPoints& y : history.rest_shape) y *= scale;
  ++history.version;
  PreconditionedConjugateGradients solver(1e-12, 10000);
  for (int k = 0; k < steps; ++k)  // the world follows: nothing yields
    plain::flow(model, PointArray(history.plastic_rest_positions), kStep, solver, history);
  double volume_now = 0, volume_before = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    volume_now += volume(gather(history.plastic_rest_positions, model.mesh.hexahedra()[e]));
    volume_before += model.volume[e];
  }
  return volume_now / volume_before;
}

TEST(VolumeRestitution, DecaysExponentially) {
  for (const double rate : {1.0, 5.0}) {
    for (const int steps : {20, 100}) {
      const double discrete = [&] {
        double beta = 1.03;
        for (int k = 0; k < steps; ++k) beta *= std::pow(1 + rate * kStep * (1 - beta), 3);
        return beta;
      }();
      EXPECT_NEAR(volume_ratio_after(steps, rate) - 1, discrete - 1, 1e-6 * 0.03);
      const double decay = std::exp(-3 * rate * steps * kStep);
      EXPECT_NEAR(discrete - 1, 0.03 * decay, 0.1 * 0.03 * rate);  // the recursion itself is a decay of that rate
    }
  }
  EXPECT_NEAR((volume_ratio_after(100, 1) - 1) / 0.03, std::exp(-3.0), 0.1 * std::exp(-3.0));
}

TEST(Flow, OfAHeldShapeDoesNotDriftInTenThousandSteps) {
  Body body(support::block({1, 1, 3}, kEdge), {kSoft}, kJoined);
  const HexMesh& mesh = body.mesh();
  const PointArray current = support::stretched_and_twisted(mesh, 1.3, 0);
  for (int k = 0; k < 10000; ++k) body.flow(current, kStep);
  const PointArray& x = body.state().history.plastic_rest_positions;
  EXPECT_GT(elongation(end_sections(mesh), x), 0.1);
  EXPECT_LE((x.colwise().mean() - mesh.positions().colwise().mean()).norm(), 1e-10);
  EXPECT_NEAR(body.volume(x) / body.initial_volume(), 1, 1e-10);
  const Mat3 moment =
      (x.rowwise() - x.colwise().mean()).transpose() * (mesh.positions().rowwise() - mesh.positions().colwise().mean());
  EXPECT_LE(rotation_log(polar(moment).R).norm(), 1e-6);
}

TEST(Flow, KeepsPlasticTwistBelowTheTwistThatIsHeld) {
  Material m = kSoft;
  m.yield_stress = 50;
  m.rotation_yield = 0;
  m.hardening = 0;
  Settings settings = kJoined;
  settings.volume_restitution = 5;
  Body body(support::block({2, 2, 8}, kEdge), {m}, settings);
  const EndSections ends = end_sections(body.mesh());
  const PointArray current = support::stretched_and_twisted(body.mesh(), 1, 2);
  double before = 0;
  for (int k = 0; k < 300; ++k) {
    body.flow(current, kStep);
    const double now = twist(body.mesh(), ends, body.state().history.plastic_rest_positions);
    ASSERT_LE(now, 2) << "step " << k;
    ASSERT_GE(now, before - 1e-6) << "step " << k;
    before = now;
  }
  EXPECT_GT(before, 1.5);
}

TEST(Guard, KeepsInvertedElementsElastic) {
  Body body(support::block({1, 1, 2}, kEdge), {kSoft}, kJoined);
  PointArray current = body.mesh().positions();
  current.bottomRows(4) = mapped(PointArray(current.bottomRows(4)), Mat3::Identity(),
                                 Vec3(0, 0, -1.6 * kEdge));  // the upper cube, inside out
  const FlowReport report = body.flow(current, kStep);
  EXPECT_EQ(report.inverted, 1);
  EXPECT_EQ(report.skipped, 1);
  for (const double tau : body.state().history.yield_stress[1]) EXPECT_EQ(tau, 300);

  // the same at a stretch below the threshold, though not inverted
  current = mapped(body.mesh().positions(), Vec3(1, 1, 0.05).asDiagonal());
  EXPECT_EQ(body.flow(current, kStep).skipped, 2);
  EXPECT_EQ(body.fields(current).yield_stress[1], 300);
}

// Two unconnected bars are stretched; hexahedra of the first have rest shapes that fit no mesh.
TEST(Guard, RollsBackTheConnectedPartAloneThatAveragingWouldFlatten) {
  const HexMesh one = support::block({2, 1, 3}, kEdge), mesh = support::two_copies(one, 1);
  const Model model(mesh, {kSoft}, kJoined), model_alone(one, {kSoft}, kJoined);
  History history(model), alone(model_alone);
  Random random(4);
  for (int e = 0; e < one.num_elements(); ++e)
    history.rest_shape[e] = about_mean(history.rest_shape[e] + ElementPoints(random.field(8, 0.8 * kEdge)));
  const PointArray stretched = support::stretched_and_twisted(one, 1.2, 0.3);
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
  EXPECT_GT(support::max_abs(alone.plastic_rest_positions - one.positions()), 1e-4 * kEdge);
  EXPECT_LE(support::max_abs(other - mapped(alone.plastic_rest_positions, Mat3::Identity(), Vec3(1, 0, 0))),
            1e-9 * kEdge);
  EXPECT_NEAR(history.dissipated_energy, alone.dissipated_energy, 1e-9 * alone.dissipated_energy);
}

TEST(Flow, FineBodiesAreAtRestInSpiteOfRounding) {
  // edges of 2 mm, 2 m away from the origin: positions, and with them volumes, are rounded to 1e-13 of an edge
  HexMesh mesh = support::block({2, 2, 100}, 0.002);
  const PointArray X = mesh.positions().rowwise() + Eigen::RowVector3d(2.1, -1.7, 0.3);
  Body body(HexMesh(X, mesh.hexahedra()), {Material{.yield_stress = 1e9, .flow_rate = 1}}, kJoined);
  const FlowReport report = body.flow(X, 0.01);
  EXPECT_TRUE(report.averaging.skipped);
  EXPECT_EQ(report.worst_volume_error, 0) << "some element was not passed over";
}

}  // namespace
}  // namespace hexaplast
