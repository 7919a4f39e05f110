// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels against the plain implementation of the method, for every option of theirs, and its lanes against single
// elements, whose logarithms and rotations are found otherwise, for every option. On every instruction set.
#include "plain/plain.hpp"

#include "base/simd.hpp"
#include "hexaplast/material/rows.hpp"
#include "mesh/trilinear.hpp"
#include "support/core.hpp"
#include "support/history.hpp"

namespace hexaplast {
namespace {

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

/// All that the kernels have.
std::vector<Options> options_of_kernels() {
  std::vector<Options> all{{}};
  for (const std::string law : {"neoHookean", "stableNeoHookean", "mooneyRivlin"})
    all.push_back({{{"law", law}, {"recovery", "none"}}});
  all.push_back({{{"yieldNorm", "frobenius"}}});
  all.push_back({{{"yieldStressMeasure", "cauchy"}, {"inversionThreshold", "0.2"}}});
  all.push_back({{{"yieldNorm", "spectral"}, {"inversionThreshold", "0.7"}}});
  const std::pair<std::string, std::string> relaxing("relaxation", "0.7 0.3 2 0.02 0.4 0.1"),
      joined("restShape", "joined");
  all.push_back({{joined}});
  all.push_back({{joined, {"law", "neoHookean"}}});
  all.push_back({{joined, relaxing}});
  all.push_back({{joined, relaxing, {"recovery", "none"}}});
  all.push_back({{relaxing}});
  all.push_back({{{"relaxation", "1.5 0.05"}, {"yieldStressMeasure", "cauchy"}}});
  all.push_back({{relaxing, {"yieldNorm", "spectral"}, {"inversionThreshold", "0.2"}}});
  return all;
}

/// Of joined rest shapes, all values of what acts together, and of the rest one after the other.
std::vector<Options> options_of_paper() {
  std::vector<Options> all{{}};
  for (const std::string bending : {"blended", "assumedCorner", "vertex", "centre"})
    for (const std::string volumetric : {"sample", "volumeRatio"})
      for (const std::string law : {"corotated", "neoHookean", "stableNeoHookean", "mooneyRivlin"})
        all.push_back({{{"bending", bending}, {"volumetric", volumetric}, {"law", law}}});
  for (const std::string bending : {"blended", "assumedCorner"})
    for (const std::string mode : {"none", "vertex", "centre"})
      all.push_back({{{"rotationPlasticity", mode}, {"bending", bending}}});
  all.push_back({{{"rotationPlasticity", "vertex"}, {"rotationFrame", "world"}}});
  for (const std::string norm : {"frobenius", "spectral"}) all.push_back({{{"yieldNorm", norm}}});
  all.push_back({{{"bending", "blended"}, {"blendWeight", "0.3"}}});
  all.push_back({{{"volumeRestitution", "20"}}});
  all.push_back({{{"inversionThreshold", "0.7"}}});
  for (Options& options : all)
    options.words.insert(options.words.end(), {{"restShape", "joined"}, {"implementation", "plain"}});
  return all;
}

/// Soft, stiff and elastic hexahedra side by side, some of which harden, soften or tear. With isolated rest shapes
/// rotation does not flow. Nothing does where they are of another law, and where the kernels have joined ones.
std::vector<Material> materials_of(int num_elements, Random& random, const Settings& settings) {
  const bool is_isolated = settings.rest_shape == RestShape::kIsolated;
  const bool is_elastic =
      is_isolated ? settings.law != ElasticLaw::kCorotated : settings.implementation == Implementation::kAuto;
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
  EXPECT_EQ(report.removed, plainly.removed);

  const History& found = body.state().history;
  EXPECT_EQ(found.has_flowed, expected.has_flowed);
  EXPECT_EQ(found.removed, expected.removed);
  EXPECT_EQ(found.alive, expected.alive);
  EXPECT_NEAR(found.dissipated_energy, expected.dissipated_energy, kRounding * expected.dissipated_energy);
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    expect_same_history(found.element(model, e), expected.element(model, e), model.lame[e], kEdge, kRounding);
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
  Body::State& state = body.state();
  const std::unique_ptr<Backend> plainly = plain::make_backend(state.model, state.history, state.branches);
  plainly->linearize(x);
  PointArray force = PointArray::Zero(x.rows(), 3), expected = force, product = force;
  plainly->add_force(force);
  EXPECT_TRUE(agrees(force_at(body, x), force, tolerance));
  const double energy = plainly->energy(x);
  EXPECT_NEAR(body.energy(x), energy, tolerance * energy);

  plainly->add_product(-2, dx, expected);
  body.add_stiffness_product(-2, dx, product);
  EXPECT_TRUE(agrees(product, expected, tolerance));
  BlockMatrix K(body.mesh().num_nodes()), blocks(body.mesh().num_nodes());
  plainly->add_stiffness_blocks(3, K);
  body.add_stiffness_blocks(3, blocks);
  EXPECT_TRUE(agrees(support::dense(blocks), support::dense(K), tolerance));

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
    const HexMesh mesh = two_copies(distorted_block({5, 2, 2}, kEdge, distortion, 401), 1);
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
INSTANTIATE_TEST_SUITE_P(Plain, EveryOption, testing::ValuesIn(options_of_kernels()));

TEST_P(EveryOption, KernelsAreThePlainImplementation) {
  for (const std::string& target : simd_targets())
    for (const double distortion : {0.0, 0.15}) {
      set_simd_target(target);
      SCOPED_TRACE(target);
      make(distortion);
      compare_elasticity(*body, x, dx, kRounding);
    }
}

class EveryPlainOption : public testing::TestWithParam<Options> {
 protected:
  ~EveryPlainOption() override { set_simd_target(""); }
};
INSTANTIATE_TEST_SUITE_P(Plain, EveryPlainOption, testing::ValuesIn(options_of_paper()));

/// What every element gives, one after the other.
void compare_elasticity_with_elements(const Model& model, History history, ConstPoints x, ConstPoints dx) {
  PointArray force = PointArray::Zero(x.rows(), 3), product = force, found = force;
  double energy = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    if (!history.alive[e]) continue;
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const plain::Element element(gather(history.plastic_rest_positions, corners), gather(x, corners), model.lame[e],
                                 model.settings);
    const ElementPoints f = element.force(), df = element.force_increment(gather(dx, corners));
    energy += element.energy();
    for (int a = 0; a < kCorners; ++a) force.row(corners[a]) += f.row(a), product.row(corners[a]) += df.row(a);
  }
  const std::vector<BranchStep> branches;
  const std::unique_ptr<Backend> elasticity = plain::make_backend(model, history, branches);
  elasticity->linearize(x);
  elasticity->add_force(found);
  EXPECT_TRUE(agrees(found, force, kRounding));
  EXPECT_NEAR(elasticity->energy(x), energy, kRounding * energy);
  found.setZero();
  elasticity->add_product(2, dx, found);
  EXPECT_TRUE(agrees(found, 2 * product, kRounding));

  BlockMatrix K(model.mesh.num_nodes());
  elasticity->add_stiffness_blocks(2, K);
  PointArray diagonal = PointArray::Zero(x.rows(), 3);
  elasticity->add_diagonal(2, diagonal);
  const Eigen::MatrixXd dense = support::dense(K);
  EXPECT_TRUE(agrees(dense * Eigen::Map<const Eigen::VectorXd>(dx.data(), dx.size()),
                     Eigen::Map<const Eigen::VectorXd>(found.data(), found.size()), kRounding));
  EXPECT_TRUE(agrees(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), diagonal.size())),
                     Eigen::VectorXd(dense.diagonal()), kRounding));
}

TEST_P(EveryPlainOption, LanesAreTheElements) {
  Settings settings = GetParam().settings();
  settings.recovery = RecoveryMode::kNone;
  const HexMesh mesh = distorted_block({5, 3, 1}, kEdge, 0.15, 401);
  Random random(402);
  const Model model(mesh, materials_of(mesh.num_elements(), random, settings), settings);
  PreconditionedConjugateGradients solver(1e-12, 10000);
  for (const std::string& target : simd_targets()) {
    set_simd_target(target);
    SCOPED_TRACE(target);
    History history(model);
    history.alive[4] = 0, history.removed = {4};
    int yielded = 0;
    for (int step = 0; step < 4; ++step) {
      const PointArray x =
          mapped(PointArray(history.plastic_rest_positions + random.field(mesh.num_nodes(), 0.12 * kEdge)),
                 random.rotation(), random.vector(1));
      compare_elasticity_with_elements(model, history, x, random.field(mesh.num_nodes(), 1));

      const std::vector<Mat3> frames(model.maps_per_element() > 1 ? mesh.num_elements() : 0, random.rotation());
      History found = history, expected = history;
      std::vector<plain::ElementOutcome> outcomes;
      plain::flow_elements(model, x, kStep, frames, history, found, outcomes);
      for (int e = 0; e < mesh.num_elements(); ++e) {
        if (!history.alive[e]) continue;
        const plain::ElementOutcome alone =
            plain::flow_alone(model, x, kStep, frames.empty() ? nullptr : &frames[e], history, e, expected);
        EXPECT_EQ(outcomes[e].yielded, alone.yielded);
        EXPECT_EQ(outcomes[e].inverted, alone.inverted);
        EXPECT_EQ(outcomes[e].skipped, alone.skipped);
        EXPECT_EQ(outcomes[e].repaired, alone.repaired);
        EXPECT_NEAR(outcomes[e].volume_error, alone.volume_error, kRounding);
        EXPECT_NEAR(outcomes[e].dissipated, alone.dissipated, kRounding * alone.dissipated);
        yielded += alone.yielded;
        expect_same_history(found.element(model, e), expected.element(model, e), model.lame[e], kEdge, kRounding);
      }
      plain::flow(model, x, kStep, solver, history);  // on which the next step follows
    }
    EXPECT_GT(yielded, 0);
  }
}

/// A hexahedron whose branches hold something.
Body held_hexahedron(std::vector<double> relaxation, double distortion, Random& random) {
  Body body(distorted_block({1, 1, 1}, kEdge, distortion, 409), {Material{.poisson_ratio = 0.45}},
            {.relaxation = std::move(relaxation), .recovery = RecoveryMode::kNone, .rest_shape = RestShape::kJoined});
  History& history = body.state().history;
  for (auto* tensors : {&history.branch_strain, &history.branch_stretch})
    for (CornerSymmetric& of_element : *tensors)
      for (auto& one : of_element) {
        for (double& number : one) number = random.uniform(-0.2, 0.2);
        of_element.front()[2] -= one[0] + one[1] + one[2];  // traces have no sum
      }
  ++history.version;
  body.set_time_step(kStep);
  return body;
}

// At samples that are inverted, or all but: where the sum of two stretches is less than a tenth of their difference,
// what balances moments is bounded.
TEST(Plain, BranchesAreThoseOfTheKernels) {
  Random random(410);
  for (const double distortion : {0.0, 0.2})
    for (const std::vector<double>& relaxation : {std::vector<double>{2, 0.02}, {0.7, 0.3, 2, 0.02}})
      for (const double least : {0.8, 1e-3, 1e-9, -1e-9, -0.3, -0.45, -0.47, -0.6, -1.0}) {
        SCOPED_TRACE(testing::Message() << distortion << ' ' << least);
        Body body = held_hexahedron(relaxation, distortion, random);
        const Mat3 turned = random.rotation(), axes = random.rotation();
        const Mat3 F = turned * axes * Vec3(1.1, 0.5, least).asDiagonal() * axes.transpose();
        const PointArray x = mapped(body.mesh().positions(), F, random.vector(1));
        compare_elasticity(body, x, random.field(kCorners, 1), 10 * kRounding);
        Body single = in_mixed_precision(body);
        flow_both(single, x);
        const FlowReport report = flow_both(body, x);
        EXPECT_EQ(report.inverted, least < 0);
        EXPECT_EQ(report.skipped, 0.55 * least < 0.1);
      }
}

// Folded and thrown bodies: recovery springs and the corner energy, hexahedra that are skipped.
TEST(Plain, IsTheKernelsForThrownBodiesToo) {
  Random random(403);
  FlowReport sum;
  int num_recovering = 0;
  for (int round = 0; round < 24; ++round) {
    const HexMesh mesh = distorted_block({4, 2, 2}, kEdge, round % 8 == 0 ? 0 : 0.1, 404 + round);
    Settings settings;
    settings.inversion_threshold = round % 4 < 2 ? 0.1 : 0.5;
    if (round % 2) settings.relaxation = {0.7, 0.3, 2, 0.02};
    Body body(mesh, materials_of(mesh.num_elements(), random, settings), settings);
    body.set_time_step(kStep);
    History& history = body.state().history;
    for (CornerSymmetric& of_element : history.branch_strain)
      for (int i = 0; i < kCorners; ++i) {  // traces have no sum
        const double y = random.uniform(-0.2, 0), trace = 0.1 * kCornerSign[i][0];
        of_element[i] = {0.1, y, trace - 0.1 - y, 0, random.uniform(-0.2, 0.2), 0};
      }
    for (CornerTensors& G : history.plastic_inverse)
      for (Mat3& one : G) one += random.matrix(0.3);
    take_flowed(body);
    const PointArray x = mesh.positions() + random.field(mesh.num_nodes(), random.uniform(0.2, 0.9) * kEdge);

    Body::State& state = body.state();
    const std::unique_ptr<Backend> plainly = plain::make_backend(state.model, state.history, state.branches);
    plainly->linearize(x);
    PointArray force = PointArray::Zero(x.rows(), 3);
    plainly->add_force(force);
    EXPECT_TRUE(agrees(force_at(body, x), force, 1e-9)) << round;  // some samples are nearly singular
    const double energy = plainly->energy(x);
    EXPECT_NEAR(body.energy(x), energy, 1e-9 * energy) << round;
    num_recovering += body.state().backend->recovery().acts();

    const FlowReport report = flow_both(body, x);
    sum.yielded += report.yielded;
    sum.inverted += report.inverted;
    sum.skipped += report.skipped;
    sum.removed += report.removed;
  }
  EXPECT_GT(num_recovering, 5);
  EXPECT_GT(sum.yielded, 50);
  EXPECT_GT(sum.inverted, 5);
  EXPECT_GT(sum.skipped, 5);
  EXPECT_GT(sum.removed, 0);
}

// Thrown bodies whose rest shapes fit no mesh: hexahedra that are repaired and rolled back. Whatever happens, the
// history stays sound.
TEST(Plain, JoinsRestShapesThatFitNoMesh) {
  Random random(405);
  int num_repaired = 0, num_rolled_back = 0;
  for (int round = 0; round < 30; ++round) {
    Settings settings = support::kJoined;
    settings.inversion_threshold = round % 4 < 2 ? 0.1 : 0.5;
    Body body(distorted_block({3, 2, 2}, kEdge, 0.1, 406 + round), {kSoft}, settings);
    History& history = body.state().history;
    for (ElementPoints& y : history.rest_shape)
      y = about_mean(y + random.uniform(0, 1) * ElementPoints(random.field(kCorners, kEdge)));
    ++history.version;
    const PointArray x = body.mesh().positions() + random.field(body.mesh().num_nodes(), 0.4 * kEdge);
    for (int step = 0; step < 3; ++step) {
      const FlowReport report = body.flow(x, kStep);
      num_repaired += report.repaired;
      num_rolled_back += report.rolled_back;
      validate(body.state().model, history);
    }
  }
  EXPECT_GT(num_rolled_back, 0);
  EXPECT_GT(num_repaired, 0);
}

}  // namespace
}  // namespace hexaplast
