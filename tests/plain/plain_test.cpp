// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels against the plain implementation of the method, for every option of theirs, on every instruction set.
#include "plain/plain.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
    Settings settings;
    settings.averaging_tolerance = 1e-14;
    for (const auto& [attribute, word] : words) {
      const Row<Settings>* row = find_row(settings_rows(), attribute, Names::kScenes);
      if (!row) throw std::runtime_error(attribute);
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
  return all;
}

/// Soft, stiff and elastic hexahedra side by side, some of which harden, soften or tear. With isolated rest shapes
/// rotation does not flow.
std::vector<Material> materials_of(int num_elements, Random& random, RestShape rest_shape = RestShape::kJoined) {
  std::vector<Material> materials(num_elements);
  for (int e = 0; e < num_elements; ++e) {
    Material& m = materials[e];
    m.young_modulus = random.uniform(3000, 8000);
    m.poisson_ratio = e % 3 == 0 ? 0.3 : 0.45;
    if (e % 5 == 4) continue;
    m.yield_stress = random.uniform(50, 500);
    m.flow_rate = e % 7 == 3 ? 0 : 5;
    m.rotation_yield = random.uniform(0.001, 0.03);
    m.rotation_flow_rate = e % 4 == 3 || rest_shape == RestShape::kIsolated ? 0 : 3;
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
  const FlowReport plainly = plain::flow(model, x, kStep, solver, expected), report = body.flow(x, kStep);
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
  return report;
}

class EveryOption : public testing::TestWithParam<Options> {
 protected:
  ~EveryOption() override { set_simd_target(""); }

  /// A body in two pieces and another beside it, which have flown before, and positions of it.
  void make(double distortion) {
    const HexMesh mesh = support::two_copies(support::distorted_block({5, 2, 2}, kEdge, distortion, 401), 1);
    Random random(402);
    const Settings settings = GetParam().settings();
    body.emplace(mesh, materials_of(mesh.num_elements(), random, settings.rest_shape), settings);
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
      EXPECT_GT(report.yielded, 0);
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
      make(distortion);
      const plain::Elasticity plainly(body->state().model, body->state().history, x);
      PointArray force = PointArray::Zero(x.rows(), 3), expected = force, product = force;
      plainly.add_force(force);
      EXPECT_TRUE(agrees(force_at(*body, x), force, kRounding)) << target;
      EXPECT_NEAR(body->energy(x), plainly.energy(), kRounding * plainly.energy()) << target;

      plainly.add_stiffness_product(-2, dx, expected);
      body->add_stiffness_product(-2, dx, product);
      EXPECT_TRUE(agrees(product, expected, kRounding)) << target;
      BlockMatrix K(body->mesh().num_nodes()), blocks(body->mesh().num_nodes());
      plainly.add_stiffness_blocks(3, K);
      body->add_stiffness_blocks(3, blocks);
      EXPECT_TRUE(agrees(support::dense(blocks), support::dense(K), kRounding)) << target;

      Settings mixed = body->settings();
      mixed.precision = Precision::kMixed;
      Body single(body->mesh(), body->materials(), mixed);
      single.state().history = body->state().history;
      ++single.state().history.version;
      EXPECT_TRUE(agrees(force_at(single, x), force, kRounding)) << target;
      product.setZero();
      single.add_stiffness_product(-2, dx, product);
      EXPECT_TRUE(agrees(product, expected, 4e-3)) << target;
    }
}

// A body of a scene may ask for it: with every kind of solver it moves as a fast one does.
TEST(Plain, ABodyMovesAsAFastOne) {
  const HexMesh mesh = support::distorted_block({2, 2, 5}, kEdge, 0.1, 407);
  Random random(408);
  const std::vector<Material> materials = materials_of(mesh.num_elements(), random);
  const Motion motion{.gravity = {0, 30, 0}, .fixed = support::nodes_at(mesh, 2, 0, 0.3 * kEdge)};
  const auto swung = [&](Implementation implementation, std::unique_ptr<LinearSolver> solver) {
    Settings settings{.averaging_tolerance = 1e-14, .implementation = implementation};
    MovingBody moving(Body(mesh, materials, settings), motion, std::move(solver));
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
    Body body(mesh, materials_of(mesh.num_elements(), random, settings.rest_shape), settings);
    History& history = body.state().history;
    for (CornerTensors& G : history.plastic_inverse)
      for (Mat3& one : G) one += random.matrix(0.3);
    std::ranges::fill(history.has_flowed, 1);
    for (ElementPoints& y : body.state().history.rest_shape)
      y = about_mean(y + random.uniform(0, 0.8) * ElementPoints(random.field(kCorners, kEdge)));
    ++body.state().history.version;
    const PointArray x = mesh.positions() + random.field(mesh.num_nodes(), random.uniform(0.2, 0.9) * kEdge);

    const plain::Elasticity plainly(body.state().model, body.state().history, x);
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
