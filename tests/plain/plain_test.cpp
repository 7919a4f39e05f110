// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels against the plain implementation of the method, for every option of theirs, on every instruction set.
#include "plain/plain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "base/simd.hpp"
#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "hexaplast/moving_body.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "plastic/rest_shape.hpp"
#include "support/compare.hpp"
#include "support/dense.hpp"
#include "support/materials.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::agrees;
using support::force_at;
using support::kEdge;
using support::kStep;
using support::mapped;
using support::max_abs;
using support::Random;

constexpr double kRounding = 1e-11;  // relative

/// Settings by the words of scenes.
struct Options {
  std::vector<std::pair<std::string, std::string>> words;

  Settings settings() const {
    Settings settings{.rest_shape = RestShape::kJoined};
    settings.averaging_tolerance = 1e-14;
    for (const auto& [attribute, word] : words) {
      const Row<Settings>* row = find_row(settings_rows(), attribute, Names::kScenes);
      if (!row) throw std::runtime_error(attribute);
      if (row->at.list) {
        std::istringstream in(word);
        for (double number; in >> number;) (settings.*row->at.list).push_back(number);
        continue;
      }
      row->at.set(settings, row->words.empty() ? std::stod(word) : place_of_word(*row, word));
    }
    return settings;
  }
};
void PrintTo(const Options& options, std::ostream* out) {
  for (const auto& [attribute, word] : options.words) *out << attribute << '=' << word << ' ';
}

/// All values that the kernels have of what acts together, and of the rest one after the other.
std::vector<Options> all_options() {
  std::vector<Options> all{{}};
  for (const std::string bending : {"blended", "assumedCorner"})
    for (const std::string volumetric : {"sample", "volumeRatio"})
      for (const std::string law : {"corotated", "neoHookean", "stableNeoHookean", "mooneyRivlin"})
        all.push_back({{{"bending", bending}, {"volumetric", volumetric}, {"law", law}, {"recovery", "none"}}});
  for (const std::string bending : {"blended", "assumedCorner"})
    all.push_back({{{"rotationPlasticity", "none"}, {"bending", bending}}});
  for (const std::string norm : {"frobenius", "spectral"}) all.push_back({{{"yieldNorm", norm}}});
  all.push_back({{{"bending", "blended"}, {"blendWeight", "0.3"}}});
  all.push_back({{{"averagingSteps", "3"}}});
  all.push_back({{{"volumeRestitution", "20"}}});
  all.push_back({{{"inversionThreshold", "0.7"}}});
  const std::pair<std::string, std::string> isolated("restShape", "isolated");
  all.push_back({{isolated}});
  all.push_back({{isolated, {"yieldStressMeasure", "cauchy"}, {"inversionThreshold", "0.2"}}});
  all.push_back({{isolated, {"volumetric", "sample"}, {"yieldNorm", "frobenius"}}});
  all.push_back({{isolated, {"yieldNorm", "spectral"}}});
  for (const std::string bending : {"blended", "assumedCorner"})
    for (const std::string law : {"corotated", "neoHookean", "stableNeoHookean", "mooneyRivlin"})
      if (bending == "blended" || law != "corotated") all.push_back({{isolated, {"bending", bending}, {"law", law}}});
  const std::pair<std::string, std::string> relaxing("relaxation", "0.7 0.3 2 0.02 0.4 0.1");
  all.push_back({{relaxing}});
  all.push_back({{relaxing, {"yieldNorm", "spectral"}, {"recovery", "none"}}});
  all.push_back({{relaxing, isolated}});
  all.push_back({{{"relaxation", "1.5 0.05"}, isolated, {"yieldStressMeasure", "cauchy"}}});
  all.push_back({{relaxing, isolated, {"yieldNorm", "spectral"}, {"inversionThreshold", "0.2"}}});
  return all;
}

/// Soft, stiff and elastic hexahedra side by side, some of which harden, soften or tear. With isolated rest shapes
/// rotation does not flow. Nothing does where joined ones relax, and where isolated ones are of another element or law.
std::vector<Material> materials_of(int num_elements, Random& random, const Settings& settings) {
  const bool is_isolated = settings.rest_shape == RestShape::kIsolated;
  const bool is_elastic = is_isolated
                              ? settings.bending != Bending::kAssumedCorner || settings.law != ElasticLaw::kCorotated
                              : settings.num_branches() > 0;
  std::vector<Material> materials(num_elements);
  for (int e = 0; e < num_elements; ++e) {
    Material& m = materials[e];
    m.young_modulus = random.uniform(3000, 8000);
    m.poisson_ratio = e % 3 == 0 ? 0.3 : 0.45;
    if (e % 5 == 4 || is_elastic) continue;
    m.yield_stress = random.uniform(50, 500);
    m.flow_rate = e % 7 == 3 ? 0 : 5;
    m.rotation_yield = random.uniform(0.001, 0.03);
    m.rotation_flow_rate = e % 4 == 3 || is_isolated ? 0 : 3;
    m.hardening = random.uniform(-0.2, 0.4);
    if (e % 6 == 1) m.fracture_stretch = 1.1;
    if (e % 6 == 2) m.fracture_stress = 520;
  }
  return materials;
}

/// One plastic step by the kernels, and plainly from the same history.
FlowReport flow_both(Body& body, const PointArray& x) {
  const Model& model = body.state().model;
  History expected = body.state().history;
  PreconditionedConjugateGradients solver(1e-14, 10000);
  body.set_time_step(kStep);
  const FlowReport plainly = plain::flow(model, x, kStep, solver, expected, body.state().branches),
                   report = body.flow(x, kStep);
  EXPECT_EQ(report.yielded, plainly.yielded);
  EXPECT_EQ(report.inverted, plainly.inverted);
  EXPECT_EQ(report.skipped, plainly.skipped);
  EXPECT_EQ(report.repaired, plainly.repaired);
  EXPECT_EQ(report.rolled_back, plainly.rolled_back);
  EXPECT_EQ(report.removed, plainly.removed);
  EXPECT_EQ(report.averaging.skipped, plainly.averaging.skipped);
  EXPECT_EQ(report.averaging.fell_back, plainly.averaging.fell_back);
  EXPECT_NEAR(report.worst_volume_error, plainly.worst_volume_error, kRounding);

  const History& found = body.state().history;
  EXPECT_EQ(found.has_flowed, expected.has_flowed);
  EXPECT_EQ(found.removed, expected.removed);
  EXPECT_EQ(found.alive, expected.alive);
  EXPECT_LE(max_abs(found.plastic_rest_positions - expected.plastic_rest_positions), kRounding * kEdge);
  EXPECT_NEAR(found.dissipated_energy, expected.dissipated_energy, kRounding * expected.dissipated_energy);
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const ElementHistory one = found.element(e), other = expected.element(e);
    EXPECT_LE(max_abs(one.rest_shape - other.rest_shape), kRounding * kEdge) << e;
    for (int i = 0; i < kCorners; ++i) {
      EXPECT_LE(max_abs(one.rotation_map[i] - other.rotation_map[i]), kRounding) << e;
      EXPECT_LE(max_abs(one.plastic_stretch[i] - other.plastic_stretch[i]), kRounding) << e;
      EXPECT_LE(max_abs(one.plastic_inverse[i] - other.plastic_inverse[i]), kRounding) << e;
      EXPECT_NEAR(one.plastic_strain[i], other.plastic_strain[i], kRounding) << e;
      EXPECT_NEAR(one.rotation_yield[i], other.rotation_yield[i], kRounding) << e;
      EXPECT_TRUE(one.yield_stress[i] == other.yield_stress[i] ||  // infinite
                  std::abs(one.yield_stress[i] - other.yield_stress[i]) <= kRounding * model.lame[e].lambda)
          << e;
    }
  }
  const auto agree = [](const std::vector<CornerSymmetric>& some, const std::vector<CornerSymmetric>& others) {
    ASSERT_EQ(some.size(), others.size());
    for (std::size_t k = 0; k < some.size(); ++k)
      for (int i = 0; i < kCorners; ++i)
        for (int n = 0; n < 6; ++n) EXPECT_NEAR(some[k][i][n], others[k][i][n], kRounding) << k;
  };
  agree(found.branch_strain, expected.branch_strain);
  agree(found.branch_stretch, expected.branch_stretch);
  return report;
}

Body in_mixed_precision(const Body& body) {
  Settings mixed = body.settings();
  mixed.precision = Precision::kMixed;
  Body single(body.mesh(), body.materials(), mixed);
  single.state().history = body.state().history;
  ++single.state().history.version;
  single.set_time_step(kStep);
  return single;
}

/// Forces, energy, products and blocks of a body that is at a time step, and plainly.
void compare_elasticity(Body& body, const PointArray& x, const PointArray& dx, double tolerance) {
  const plain::Elasticity plainly(body.state().model, body.state().history, x, body.state().branches);
  PointArray force = PointArray::Zero(x.rows(), 3), expected = force, product = force;
  plainly.add_force(force);
  EXPECT_TRUE(agrees(force_at(body, x), force, tolerance));
  EXPECT_NEAR(body.energy(x), plainly.energy(), tolerance * plainly.energy());

  plainly.add_stiffness_product(-2, dx, expected);
  body.add_stiffness_product(-2, dx, product);
  EXPECT_TRUE(agrees(product, expected, tolerance));
  BlockMatrix K(body.mesh().num_nodes()), blocks(body.mesh().num_nodes());
  plainly.add_stiffness_blocks(3, K);
  body.add_stiffness_blocks(3, blocks);
  EXPECT_TRUE(agrees(support::dense(blocks), support::dense(K), tolerance));

  if (body.settings().rest_shape == RestShape::kJoined && body.can_flow()) return;  // in double precision alone
  Body single = in_mixed_precision(body);
  EXPECT_TRUE(agrees(force_at(single, x), force, tolerance));
  product.setZero();
  single.add_stiffness_product(-2, dx, product);
  EXPECT_TRUE(agrees(product, expected, 4e-3));
}

class EveryOption : public testing::TestWithParam<Options> {
 protected:
  ~EveryOption() override { set_simd_target(""); }

  /// A body in two pieces and another beside it, which have flown before, and positions of it.
  void make(double distortion) {
    const HexMesh mesh = support::two_copies(support::distorted_block({5, 2, 2}, kEdge, distortion, 401), 1);
    Random random(402);
    const Settings settings = GetParam().settings();
    body.emplace(mesh, materials_of(mesh.num_elements(), random, settings), settings);
    for (int step = 0; step < 6; ++step) {
      if (step == 3) {
        std::vector<int> middle;
        for (int e = 0; e < mesh.num_elements() / 2; ++e)
          if (std::abs(gather(mesh.positions(), mesh.hexahedra()[e]).col(0).mean() - 2.5 * kEdge) < 0.4 * kEdge)
            middle.push_back(e);
        ASSERT_EQ(middle.size(), 4u);
        body->remove(middle);
      }
      x = placed(0.1, random);
      const FlowReport report = flow_both(*body, x);
      EXPECT_EQ(report.yielded > 0, body->can_flow());
    }
    x = placed(0.2, random);
    dx = random.field(mesh.num_nodes(), 1);
  }

  /// Positions near the plastic rest positions, turned and elsewhere.
  PointArray placed(double size, Random& random) const {
    const PointArray& rest = body->plastic_rest_positions();
    return mapped(PointArray(rest + random.field(static_cast<int>(rest.rows()), size * kEdge)), random.rotation(),
                  random.vector(1));
  }

  std::optional<Body> body;
  PointArray x, dx;
};
INSTANTIATE_TEST_SUITE_P(Plain, EveryOption, testing::ValuesIn(all_options()));

TEST_P(EveryOption, KernelsAreThePlainImplementation) {
  for (const std::string& target : simd_targets())
    for (const double distortion : {0.0, 0.15}) {
      set_simd_target(target);
      SCOPED_TRACE(target);
      make(distortion);
      compare_elasticity(*body, x, dx, kRounding);
    }
}

/// A hexahedron with a random G, and branches that hold something.
Body held_hexahedron(RestShape rest_shape, std::vector<double> relaxation, double distortion, Random& random) {
  Settings settings{.relaxation = std::move(relaxation), .recovery = RecoveryMode::kNone, .rest_shape = rest_shape};
  Material material{.poisson_ratio = 0.45};
  if (rest_shape == RestShape::kIsolated) material.yield_stress = 1e9, material.flow_rate = 1;  // has G, and keeps it
  Body body(support::distorted_block({1, 1, 1}, kEdge, distortion, 409), {material}, settings);
  History& history = body.state().history;
  for (CornerTensors& G : history.plastic_inverse)
    for (Mat3& one : G) one += random.matrix(0.2);
  std::ranges::fill(history.has_flowed, 1);
  for (auto* tensors : {&history.branch_strain, &history.branch_stretch})
    for (CornerSymmetric& of_element : *tensors)
      for (auto& one : of_element) {
        for (double& number : one) number = random.uniform(-0.2, 0.2);
        one[2] = -one[0] - one[1];  // without trace
      }
  ++history.version;
  body.set_time_step(kStep);
  return body;
}

// Whatever hexahedra and their samples have been through, and at samples that are inverted, or all but: where the sum
// of two stretches is less than a tenth of their difference, what balances moments is bounded.
TEST(Plain, BranchesAreThoseOfTheKernels) {
  Random random(410);
  for (const RestShape rest_shape : {RestShape::kJoined, RestShape::kIsolated})
    for (const double distortion : {0.0, 0.2})
      for (const std::vector<double>& relaxation : {std::vector<double>{2, 0.02}, {0.7, 0.3, 2, 0.02}}) {
        SCOPED_TRACE(testing::Message() << "isolated " << (rest_shape == RestShape::kIsolated) << ", " << distortion);
        for (int round = 0; round < 10; ++round) {
          Body body = held_hexahedron(rest_shape, relaxation, distortion, random);
          const PointArray placed = body.mesh().positions() + random.field(kCorners, 0.15 * kEdge);
          const PointArray x = mapped(placed, random.rotation(), random.vector(1));
          compare_elasticity(body, x, random.field(kCorners, 1), kRounding);
          Body single = in_mixed_precision(body);
          flow_both(single, x);
          flow_both(body, x);
        }
        if (rest_shape == RestShape::kIsolated) continue;
        for (const double least : {1e-3, 1e-9, -1e-9, -0.3, -0.45, -0.47, -0.6, -1.0}) {
          SCOPED_TRACE(least);
          Body body = held_hexahedron(rest_shape, relaxation, distortion, random);
          const Mat3 turned = random.rotation(), axes = random.rotation();
          const Mat3 F = turned * axes * Vec3(1.1, 0.5, least).asDiagonal() * axes.transpose();
          const PointArray x = mapped(body.mesh().positions(), F, random.vector(1));
          compare_elasticity(body, x, random.field(kCorners, 1), 10 * kRounding);
          const FlowReport report = flow_both(body, x);
          EXPECT_EQ(report.inverted, least < 0);
          EXPECT_EQ(report.skipped, 0.55 * least < 0.1);
        }
      }
}

// A body of a scene may ask for it: with every kind of solver it moves as a fast one does.
TEST(Plain, ABodyMovesAsAFastOne) {
  const HexMesh mesh = support::distorted_block({2, 2, 5}, kEdge, 0.1, 407);
  const Motion motion{.gravity = {0, 30, 0}, .fixed = support::nodes_at(mesh, 2, 0, 0.3 * kEdge)};
  const auto swung = [&](Implementation implementation, std::unique_ptr<LinearSolver> solver, bool relaxes = false) {
    Settings settings{.rest_shape = RestShape::kJoined, .averaging_tolerance = 1e-14, .implementation = implementation};
    if (relaxes) {
      settings.rest_shape = RestShape::kIsolated;
      settings.relaxation = {0.7, 0.3, 2, 0.02};
    }
    Random random(408);
    MovingBody moving(Body(mesh, materials_of(mesh.num_elements(), random, settings), settings), motion,
                      std::move(solver));
    const RunReport report = moving.run(10);
    EXPECT_GT(report.flow.yielded, 0);
    EXPECT_EQ(report.stalled, 0);
    return moving.x;
  };
  const PointArray expected = swung(Implementation::kFast, nullptr);
  EXPECT_GT(max_abs(expected - mesh.positions()), 0.1 * kEdge);
  EXPECT_LE(max_abs(swung(Implementation::kPlain, nullptr) - expected), 1e-10 * kEdge);
  for (const auto preconditioner : {Preconditioner::kDiagonal, Preconditioner::kMultigrid})
    EXPECT_LE(max_abs(swung(Implementation::kPlain,
                            std::make_unique<PreconditionedConjugateGradients>(1e-13, 1000, preconditioner)) -
                      expected),
              1e-9 * kEdge);
  EXPECT_LE(max_abs(swung(Implementation::kPlain, std::make_unique<ConjugateGradients>(ConjugateGradientSettings{
                                                      .iterations = 1000, .tolerance = 1e-13, .threshold = 0})) -
                    expected),
            1e-9 * kEdge);

  const PointArray relaxed = swung(Implementation::kPlain, nullptr, true);
  EXPECT_GT(max_abs(relaxed - expected), 0.01 * kEdge);
  EXPECT_LE(max_abs(swung(Implementation::kFast, nullptr, true) - relaxed), 1e-10 * kEdge);
  for (const auto preconditioner : {Preconditioner::kDiagonal, Preconditioner::kMultigrid})
    EXPECT_LE(max_abs(swung(Implementation::kFast,
                            std::make_unique<PreconditionedConjugateGradients>(1e-13, 1000, preconditioner), true) -
                      relaxed),
              1e-9 * kEdge);
}

TEST(Plain, NamesTheImplementationThatAnOptionNeeds) {
  const std::vector<std::pair<Settings, std::string>> cases = {
      {{.bending = Bending::kVertex}, "bending = vertex needs implementation = plain"},
      {{.rotation_plasticity = RotationPlasticity::kCentre},
       "rotationPlasticity = centre needs implementation = plain"},
      {{.averaging = AveragingMethod::kJacobi}, "averaging = jacobi needs implementation = plain"},
      {{.precision = Precision::kMixed, .implementation = Implementation::kPlain},
       "precision = mixed needs implementation = fast"}};
  for (const auto& [settings, message] : cases)
    EXPECT_TRUE(support::refuses<InputError>([&] { validate(settings, Names::kScenes); }, {message}));
}

// Folded and thrown bodies: recovery springs, hexahedra that are skipped, repaired and rolled back.
TEST(Plain, IsTheKernelsForThrownBodiesToo) {
  Random random(403);
  FlowReport sum;
  int num_recovering = 0;
  for (int round = 0; round < 40; ++round) {
    const HexMesh mesh = support::distorted_block({4, 2, 2}, kEdge, round % 16 == 0 ? 0 : 0.1, 404 + round);
    Settings settings = Options{}.settings();
    settings.bending = round % 2 ? Bending::kBlended : Bending::kAssumedCorner;
    settings.inversion_threshold = round % 4 < 2 ? 0.1 : 0.5;
    if (round % 8 == 0) settings.rest_shape = RestShape::kIsolated;
    if (round % 8 == 0 && round > 8) settings.relaxation = {0.7, 0.3, 2, 0.02};
    Body body(mesh, materials_of(mesh.num_elements(), random, settings), settings);
    body.set_time_step(kStep);
    History& history = body.state().history;
    for (CornerSymmetric& of_element : history.branch_strain)
      for (auto& one : of_element) one = {0.1, random.uniform(-0.2, 0), -0.1, 0, random.uniform(-0.2, 0.2), 0};
    for (CornerTensors& G : history.plastic_inverse)
      for (Mat3& one : G) one += random.matrix(0.3);
    std::ranges::fill(history.has_flowed, 1);
    for (ElementPoints& y : body.state().history.rest_shape)
      y = about_mean(y + random.uniform(0, 0.8) * ElementPoints(random.field(kCorners, kEdge)));
    ++body.state().history.version;
    const PointArray x = mesh.positions() + random.field(mesh.num_nodes(), random.uniform(0.2, 0.9) * kEdge);

    const plain::Elasticity plainly(body.state().model, body.state().history, x, body.state().branches);
    PointArray force = PointArray::Zero(x.rows(), 3);
    plainly.add_force(force);
    EXPECT_TRUE(agrees(force_at(body, x), force, 1e-9)) << round;  // some samples are nearly singular
    EXPECT_NEAR(body.energy(x), plainly.energy(), 1e-9 * plainly.energy()) << round;
    num_recovering += body.state().at.recovery.acts();

    const FlowReport report = flow_both(body, x);
    sum.yielded += report.yielded;
    sum.inverted += report.inverted;
    sum.skipped += report.skipped;
    sum.rolled_back += report.rolled_back;
    sum.removed += report.removed;
    // once more, where plastic rest positions are what the step has made of them
    sum.repaired += flow_both(body, x).repaired;
  }
  EXPECT_GT(num_recovering, 5);
  EXPECT_GT(sum.yielded, 50);
  EXPECT_GT(sum.inverted, 5);
  EXPECT_GT(sum.skipped, 5);
  EXPECT_GT(sum.repaired, 0);
  EXPECT_GT(sum.rolled_back, 0);
  EXPECT_GT(sum.removed, 0);
}

// Rest shapes that fit no mesh: Gauss-Newton steps overshoot, and are replaced.
TEST(Plain, JoinsRestShapesAsTheKernelsDo) {
  Random random(405);
  int num_fell_back = 0;
  for (int round = 0; round < 30; ++round) {
    const Model model(support::distorted_block({3, 2, 2}, kEdge, 0.1, 406 + round), {Material{}}, Options{}.settings());
    History found(model);
    for (ElementPoints& y : found.rest_shape)
      y = about_mean(std::exp(random.uniform(-3, 3)) * ElementPoints(random.field(kCorners, kEdge)));
    History expected = found;
    PreconditionedConjugateGradients solver(1e-14, 10000);
    const std::vector<unsigned char> all(model.mesh.num_elements(), 1);
    for (int step = 0; step < 3; ++step) {
      const AveragingReport report = Averaging(model).advance(model, solver, found, all);
      EXPECT_EQ(plain::join_rest_shapes(model, all, solver, expected).fell_back, report.fell_back) << round;
      num_fell_back += report.fell_back;
      EXPECT_LE(max_abs(found.plastic_rest_positions - expected.plastic_rest_positions), kRounding * kEdge) << round;
      expected = found;
    }
  }
  EXPECT_GT(num_fell_back, 0);
}

}  // namespace
}  // namespace hexaplast
