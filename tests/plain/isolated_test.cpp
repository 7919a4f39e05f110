// SPDX-License-Identifier: LGPL-2.1-or-later
// Isolated rest shapes against numbers of an independent program, and against what must hold of them.
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "plain/plain.hpp"
#include "plastic/isolated_flow.hpp"
#include "support/core.hpp"
#include "support/elastic_laws.hpp"
#include "support/history.hpp"

namespace hexaplast {
namespace {

Settings isolated(YieldStressMeasure measure = YieldStressMeasure::kBiot) {
  return {.recovery = RecoveryMode::kNone,
          .yield_stress_measure = measure,
          .rest_shape = RestShape::kIsolated,
          .implementation = Implementation::kPlain};
}

/// By the words of the reference files, where the corotated stress is that of Biot.
Settings settings_of(const Json& attributes) {
  Settings settings =
      isolated(attributes["yieldStressMeasure"] == "true" ? YieldStressMeasure::kCauchy : YieldStressMeasure::kBiot);
  if (attributes["bending"] == "blended") settings.bending = Bending::kBlended;
  if (attributes["volumetric"] == "sample") settings.volumetric = Volumetric::kSample;
  if (attributes.value("yieldNorm", "") == "frobenius") settings.yield_norm = YieldNorm::kFrobenius;
  return settings;
}

CornerTensors tensors(const Json& rows) {
  CornerTensors found;
  for (int i = 0; i < kCorners; ++i) found[i] = matrix(rows[i]);
  return found;
}

CornerValues corner_values(const Json& values) {
  CornerValues found;
  for (int i = 0; i < kCorners; ++i) found[i] = values[i];
  return found;
}

/// All of the eight in one matrix, so that errors are relative to the greatest entry of them.
Eigen::Matrix<double, 24, 3> in_rows(const CornerTensors& all) {
  Eigen::Matrix<double, 24, 3> rows;
  for (int i = 0; i < kCorners; ++i) rows.block<3, 3>(3 * i, 0) = all[i];
  return rows;
}
Eigen::Map<const Eigen::Matrix<double, kCorners, 1>> in_rows(const CornerValues& all) {
  return Eigen::Map<const Eigen::Matrix<double, kCorners, 1>>(all.data());
}

TEST(IsolatedRestShapes, AreThoseOfAnIndependentProgram) {
  constexpr double kTolerance = 1e-10;
  const Json data = test_data("isolated", "golden_isolated_hexahedron");
  const Lame k = lame(data["youngModulus"], data["poissonRatio"]);
  int num_cases = 0;
  for (const auto& [name, one] : data["cases"].items()) {
    SCOPED_TRACE(name);
    ++num_cases;
    const Settings settings = settings_of(one["attributes"]);
    const ElementPoints initial = matrix(one["material"]), current = matrix(one["world"]);
    const CornerTensors G = tensors(one["G"]);
    const plain::Element element(initial, current, k, settings, &G);
    const Json &elastic = one["elastic"], &flow = one["flow"];
    EXPECT_TRUE(agrees(element.energy(), elastic["energy"].get<double>(), kTolerance));
    EXPECT_TRUE(agrees(element.force(), matrix(elastic["force"]), kTolerance));
    EXPECT_TRUE(agrees(element.force_increment(matrix(one["dx"])), matrix(elastic["tangent_product"]), kTolerance));
    EXPECT_TRUE(agrees(in_rows(element.samples().F), in_rows(tensors(elastic["Fe"])), kTolerance));
    const IsolatedStress stress = isolated_stress(initial, G, element.samples(), settings.yield_stress_measure);
    EXPECT_TRUE(agrees(in_rows(stress.relieved), in_rows(tensors(flow["sigma_hat"])), kTolerance));

    const Material material{.flow_rate = one["parameters"]["flow"], .hardening = one["parameters"]["hardening"]};
    const IsolatedStep step = isolated_flow(element.samples(), stress, G, k.mu, material, settings.yield_norm,
                                            corner_values(one["tau"]), one["parameters"]["dt"]);
    EXPECT_TRUE(step.yielded);
    EXPECT_TRUE(agrees(in_rows(step.norm), in_rows(corner_values(flow["norm"])), kTolerance));
    EXPECT_TRUE(agrees(in_rows(step.fraction), in_rows(corner_values(flow["gamma"])), kTolerance));
    EXPECT_TRUE(agrees(in_rows(step.log_stretch), in_rows(tensors(flow["M"])), kTolerance));
    EXPECT_TRUE(agrees(in_rows(step.plastic_inverse), in_rows(tensors(flow["G_new"])), kTolerance));
    EXPECT_TRUE(agrees(in_rows(step.yield_stress), in_rows(corner_values(flow["tau_new"])), kTolerance));
    EXPECT_TRUE(agrees(in_rows(step.strain), in_rows(corner_values(flow["plastic_strain"])), kTolerance));
    EXPECT_TRUE(agrees(step.dissipated, flow["dissipation"].get<double>(), kTolerance));

    const plain::Element after(initial, current, k, settings, &step.plastic_inverse);
    EXPECT_TRUE(agrees(after.energy(), one["after"]["energy"].get<double>(), kTolerance));
    EXPECT_TRUE(agrees(after.force(), matrix(one["after"]["force"]), kTolerance));
  }
  EXPECT_EQ(num_cases, 3);
}

TEST(IsolatedRestShapes, MoveAndFlowAsInAnIndependentProgram) {
  constexpr double kTolerance = 1e-8;
  const Json data = test_data("isolated", "golden_isolated_mesh");
  const Material material{.young_modulus = data["youngModulus"],
                          .poisson_ratio = data["poissonRatio"],
                          .yield_stress = data["yieldStress"],
                          .flow_rate = data["flow"],
                          .hardening = data["hardening"]};
  const HexMesh mesh(matrix(data["material"]), hexahedra(data["hexahedra"]));
  const PointArray load = matrix(data["node_force"]);
  int num_states = 0;
  const auto follow = [&](const std::string& name, const Json& run, const Settings& settings) {
    Motion motion{.density = data["density"], .dt = data["dt"]};
    motion.euler = {.rayleigh_mass = data["rayleighMass"], .rayleigh_stiffness = data["rayleighStiffness"]};
    motion.fixed = data["fixed"].get<std::vector<int>>();
    motion.load = [&](double, ConstPoints, Points f) { f += load; };
    MovingBody moving(Body(mesh, {material}, settings), motion);
    for (const Json& state : run["steps"]) {
      SCOPED_TRACE(name + " " + state["step"].dump());
      ++num_states;
      moving.run(static_cast<int>(state["step"].get<long>() - moving.steps()));
      EXPECT_TRUE(agrees(moving.positions, PointArray(matrix(state["x"])), kTolerance));
      EXPECT_TRUE(agrees(moving.velocities, PointArray(matrix(state["v"])), kTolerance));
      EXPECT_TRUE(agrees(moving.body.energy(moving.positions), state["energy"].get<double>(), kTolerance));
      EXPECT_NEAR(moving.body.dissipated_energy(), state["dissipation"], kTolerance * state["energy"].get<double>());
      for (int e = 0; e < mesh.num_elements(); ++e) {
        const History& history = moving.body.state().history;
        EXPECT_TRUE(agrees(in_rows(history.yield_stress[e]), in_rows(corner_values(state["tau"][e])), kTolerance));
        EXPECT_LE(max_abs(in_rows(history.plastic_strain[e]) - in_rows(corner_values(state["plastic_strain"][e]))),
                  kTolerance);
        for (int i = 0; i < kCorners; ++i) {
          const Mat3 B = history.plastic_inverse[e][i] * history.plastic_inverse[e][i].transpose();
          const Eigen::Matrix<double, 6, 1> found{B(0, 0), B(1, 1), B(2, 2), B(0, 1), B(0, 2), B(1, 2)};
          EXPECT_TRUE(agrees(found, support::vector(state["metric"][e][i]), kTolerance));
        }
      }
    }
  };
  for (const auto& [name, run] : data["runs"].items()) {
    Settings settings = settings_of(run["attributes"]);
    follow(name, run, settings);
    if (settings.bending != Bending::kAssumedCorner) continue;
    settings.implementation = Implementation::kAuto;
    follow(name + " fast", run, settings);
  }
  EXPECT_EQ(num_states, 10);
}

Mat3 symmetric(Random& random, double size) {
  const Mat3 A = random.matrix(size);
  return (A + A.transpose()) / 2;
}

/// exp of a symmetric matrix without trace.
Mat3 isochoric(const Mat3& A) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A - A.trace() / 3 * Mat3::Identity());
  return eigen.eigenvectors() * eigen.eigenvalues().array().exp().matrix().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// What computes samples that have flowed: each form that has isolated rest shapes.
struct Form {
  std::string name;
  Settings settings = isolated();
  double distortion = 0.15;  // 0: parallelepipeds, which have coefficients of their own
};
std::vector<Form> flowed_forms() {
  std::vector<Form> all{{"assumedCorner"}, {"blended"}, {"kernels"}, {"kernelsBoxes", {}, 0}};
  all[1].settings.bending = Bending::kBlended;
  all[1].settings.volumetric = Volumetric::kSample;
  all[2].settings = all[3].settings = isolated();
  all[2].settings.implementation = all[3].settings.implementation = Implementation::kAuto;
  return all;
}

/// Blocks whose samples have flowed each in its own way.
class FlowedSamples : public testing::TestWithParam<Form> {
 protected:
  Random random{501};
  HexMesh mesh = distorted_block({2, 2, 2}, kEdge, GetParam().distortion, 502);
  Body body{mesh, {Material{.yield_stress = 100, .flow_rate = 8, .hardening = 0.2}}, GetParam().settings};
  std::vector<CornerTensors>& G = body.state().history.plastic_inverse;

  FlowedSamples() {
    for (CornerTensors& of_element : G)
      for (Mat3& one : of_element) one = isochoric(symmetric(random, 0.3)) * random.rotation();
    take_flowed(body);
  }
  PointArray placed(double size = 0.15) {
    return mapped(PointArray(mesh.positions() + random.field(mesh.num_nodes(), size * kEdge)), random.rotation(),
                  random.vector(1));
  }
};
INSTANTIATE_TEST_SUITE_P(Plain, FlowedSamples, testing::ValuesIn(flowed_forms()),
                         [](const auto& test) { return test.param.name; });

TEST_P(FlowedSamples, HaveAnEnergyBalanceAndAStiffness) { expect_elastic_laws(body, placed(), random); }

// Only G G^T acts: rotations of the intermediate configuration, and of the world, change nothing.
TEST_P(FlowedSamples, FlowAndForcesDependOnTheMetricAlone) {
  const PointArray x = placed(), f = force_at(body, x);
  Body turned = body;
  for (CornerTensors& of_element : turned.state().history.plastic_inverse)
    for (Mat3& one : of_element) one *= random.rotation();
  take_flowed(turned);
  EXPECT_TRUE(agrees(force_at(turned, x), f, 1e-12));
  EXPECT_TRUE(agrees(turned.energy(x), body.energy(x), 1e-12));
  EXPECT_GT(body.flow(x, 0.01).yielded, 0);
  turned.flow(mapped(x, random.rotation(), random.vector(1)), 0.01);
  EXPECT_TRUE(agrees(turned.dissipated_energy(), body.dissipated_energy(), 1e-12));
  for (int e = 0; e < mesh.num_elements(); ++e)
    for (int i = 0; i < kCorners; ++i) {
      const Mat3 &one = G[e][i], &other = turned.state().history.plastic_inverse[e][i];
      EXPECT_TRUE(agrees(Mat3(other * other.transpose()), Mat3(one * one.transpose()), 1e-12));
      EXPECT_TRUE(agrees(turned.yield_stress()[e][i], body.yield_stress()[e][i], 1e-12));
    }
}

// With one F^p for all samples of a mesh the element is that of the affinely deformed rest shape.
TEST_P(FlowedSamples, OneDeformationOfAllIsThatOfTheRestShape) {
  const Mat3 deformation = random.rotation() * isochoric(symmetric(random, 0.4));
  for (CornerTensors& of_element : G) of_element.fill(deformation.inverse());
  take_flowed(body);
  Settings joined = GetParam().settings;
  joined.rest_shape = RestShape::kJoined;
  Body affine(HexMesh(mapped(mesh.positions(), deformation), mesh.hexahedra()), body.materials(), joined);
  const PointArray x = mapped(placed(), deformation), dx = random.field(mesh.num_nodes(), 1);
  EXPECT_TRUE(agrees(body.energy(x), affine.energy(x), 1e-12));
  EXPECT_TRUE(agrees(force_at(body, x), force_at(affine, x), 1e-12));
  EXPECT_TRUE(agrees(stiffness_at(body, x), stiffness_at(affine, x), 1e-12));
  if (GetParam().settings.bending != Bending::kAssumedCorner) return;
  // nor does the gauge matter to what is assumed
  for (CornerTensors& of_element : G)
    for (Mat3& one : of_element) one *= random.rotation();
  take_flowed(body);
  EXPECT_TRUE(agrees(force_at(body, x), force_at(affine, x), 1e-12));
}

TEST_P(FlowedSamples, FlowLowersTheEnergyAndKeepsTheVolume) {
  const auto log_volume = [&](int e) {
    double sum = 0;
    for (const Mat3& one : G[e]) sum += std::log(one.determinant());
    return sum;
  };
  // nu h up to 1 - 2 nu_P = .1, and to 1
  const double greatest_step = GetParam().settings.volumetric == Volumetric::kSample ? 0.0125 : 0.125;
  const History before = body.state().history;
  int num_yielded = 0;
  for (int round = 0; round < 200; ++round) {
    const long version = body.state().history.version;
    body.state().history = before;
    body.state().history.version = version;
    for (int e = 0; e < mesh.num_elements(); ++e)
      for (Mat3& one : G[e]) one = isochoric(symmetric(random, random.uniform(0, 0.4)));
    take_flowed(body);
    const PointArray x = placed(random.uniform(0, 0.2));
    std::vector<double> volumes;
    for (int e = 0; e < mesh.num_elements(); ++e) volumes.push_back(log_volume(e));
    const double energy = body.energy(x);
    num_yielded += body.flow(x, random.uniform(0.001, greatest_step)).yielded;
    EXPECT_LE(body.energy(x), energy * (1 + 1e-12)) << round;
    for (int e = 0; e < mesh.num_elements(); ++e) EXPECT_NEAR(log_volume(e), volumes[e], 1e-12) << round;
  }
  EXPECT_GT(num_yielded, 500);
}

// An affine history leaves a distorted mesh uniform, without forces inside.
TEST(IsolatedRestShapes, PassThePatchTestOfFlow) {
  Random random(503);
  const HexMesh mesh = distorted_block({3, 3, 3}, kEdge, 0.15, 504);
  Body body(mesh, {Material{.yield_stress = 100, .flow_rate = 5, .hardening = 0.2}},
            isolated(YieldStressMeasure::kCauchy));
  const Mat3 rate = random.matrix(0.4);
  PointArray x;
  for (int step = 1; step <= 20; ++step) {
    x = mapped(mesh.positions(), Mat3::Identity() + step / 20.0 * rate);
    EXPECT_EQ(body.flow(x, 0.01).skipped, 0);
  }
  const std::vector<CornerTensors>& G = body.state().history.plastic_inverse;
  const Mat3 metric = G[0][0] * G[0][0].transpose();
  EXPECT_GT((metric - Mat3::Identity()).norm(), 0.1);
  for (const CornerTensors& of_element : G)
    for (const Mat3& one : of_element) EXPECT_LE(max_abs(one * one.transpose() - metric), 1e-12);
  const PointArray f = force_at(body, x);
  const std::vector<bool> is_on_boundary = support::is_on_boundary(mesh);
  for (int n = 0; n < mesh.num_nodes(); ++n)
    EXPECT_LE(is_on_boundary[n] ? 0 : f.row(n).norm(), 1e-12 * f.cwiseAbs().sum());
}

// Multigrid cycles know what has flowed: a mesh that is as long where every hexahedron has flowed in its own way takes
// not much less.
TEST(IsolatedRestShapes, TakeAboutAsManyIterationsAsTheShapesThatTheyStandFor) {
  const HexMesh mesh = block({8, 8, 16}, kEdge);
  const Material material{.yield_stress = 100, .flow_rate = 1};
  const auto iterations = [&](Body& body, const PointArray& x) {
    LoadedBody system(body, std::vector<double>(mesh.num_nodes(), 1e-3), nodes_at(mesh, 2, 0),
                      [](double, ConstPoints, Points f) { f.col(0).array() += 1e-4; });
    PreconditionedConjugateGradients solver(1e-8, 500, Preconditioner::kMultigrid);
    PointArray positions = x, velocities = PointArray::Zero(x.rows(), 3);
    return ImplicitEuler({}).step(system, solver, 0, 0.1, positions, velocities).iterations;
  };
  Body flowed(mesh, {material}, {.recovery = RecoveryMode::kNone});
  PointArray stretched = mesh.positions();  // twice as long at one end
  const double length = 16 * kEdge;
  for (int e = 0; e < mesh.num_elements(); ++e) {
    const double at = gather(mesh.positions(), mesh.hexahedra()[e]).col(2).mean() / length;
    flowed.state().history.plastic_inverse[e].fill(Vec3(1, 1 + at, 1 / (1 + at)).asDiagonal());
  }
  take_flowed(flowed);
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    const double at = stretched(n, 2) / length;
    stretched(n, 1) /= 1 + at;
    stretched(n, 2) *= 1 + at / 2;
  }
  Body shaped(HexMesh(stretched, mesh.hexahedra()), {material}, flowed.settings());
  EXPECT_GT(iterations(shaped, stretched), 3);
  EXPECT_LE(iterations(flowed, stretched), 1.3 * iterations(shaped, stretched));
}

// Far from the origin the volume of a hexahedron at rest is not exact; nothing is restored, or taken back.
TEST(IsolatedRestShapes, KeepWhatHasFlowedFarFromTheOrigin) {
  constexpr double kFine = 0.002;
  Settings settings = isolated();
  settings.implementation = Implementation::kAuto;
  const HexMesh mesh =
      regular_grid({4, 2, 2}, Vec3(100, 100, 100), Vec3(100 + 4 * kFine, 100 + 2 * kFine, 100 + 2 * kFine));
  Body body(mesh, {Material{.yield_stress = 100, .flow_rate = 20}}, settings);
  PointArray x = mesh.positions();
  x.col(0).array() += 0.2 * (x.col(0).array() - 100);
  for (int step = 0; step < 3; ++step) EXPECT_GT(body.flow(x, 0.01).yielded, 0);
  const std::vector<CornerTensors> flowed = body.state().history.plastic_inverse;
  EXPECT_GT((flowed[0][0] - Mat3::Identity()).norm(), 0.01);
  x = mapped(mesh.positions(), flowed[0][0].inverse());  // nearly at rest
  for (int step = 0; step < 4; ++step) {
    EXPECT_EQ(body.flow(x, 0.01).yielded, 0);
    EXPECT_EQ(body.state().history.plastic_inverse, flowed) << step;
  }
}

/// A body that flows and tears, and a step at positions that stretch it more and more.
Body tearing_body(double fracture_stretch) {
  return Body(distorted_block({2, 2, 3}, kEdge, 0.15, 505),
              {Material{.yield_stress = 100, .flow_rate = 20, .hardening = 0.2, .fracture_stretch = fracture_stretch}},
              {.recovery = RecoveryMode::kNone});
}
void stretch_more(Body& body, int step) {
  Random random(600 + step);
  const PointArray stretched = body.mesh().positions() * Vec3(1 + 0.02 * step, 1, 1).asDiagonal();
  body.flow(stretched + random.field(body.mesh().num_nodes(), 0.1 * kEdge), 0.01);
}

TEST(IsolatedRestShapes, KeepVolumesOfTheMesh) {
  Body body = tearing_body(10);
  for (int step = 0; step < 20; ++step) stretch_more(body, step);
  for (const double ratio : body.fields(body.mesh().positions()).volume_ratio) EXPECT_NEAR(ratio, 1, 1e-14);
  for (const double ratio : plastic_volume_ratios(body)) EXPECT_NEAR(ratio, 1, 1e-14);
  EXPECT_GT(body.dissipated_energy(), 0);
}

// By the least singular value of G, in the step in which it falls below the limit.
TEST(IsolatedRestShapes, TearByPlasticStretch) {
  Body body = tearing_body(1.3), whole = tearing_body(10);
  bool has_torn_partly = false;
  const auto greatest_stretch = [&](int e) {
    double greatest = 0;
    for (const Mat3& G : whole.state().history.plastic_inverse[e])
      greatest = std::max(greatest, 1 / Eigen::JacobiSVD<Mat3>(G).singularValues()[2]);
    return greatest;
  };
  for (int step = 0; step < 40; ++step) {
    for (Body* each : {&body, &whole}) stretch_more(*each, step);
    for (int e = 0; e < body.mesh().num_elements(); ++e)
      EXPECT_EQ(body.alive()[e] == 0, greatest_stretch(e) > 1.3) << step << ' ' << e;
    has_torn_partly = has_torn_partly || (!body.removed().empty() && body.removed().size() < body.alive().size());
  }
  EXPECT_TRUE(has_torn_partly);
}

}  // namespace
}  // namespace hexaplast
