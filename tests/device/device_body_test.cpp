// SPDX-License-Identifier: LGPL-2.1-or-later
// Bodies on a device, by its emulation on the CPU, against the same bodies computed by the CPU's kernels.
#include "device/device_body.hpp"

#include <thread>

#include "hexaplast/solve/compliance.hpp"
#include "support/core.hpp"
#include "support/slab.hpp"
#include "support/yielding_bar.hpp"

namespace hexaplast {
namespace {

const Settings kMixed{.precision = Precision::kMixed};
const Material kFlowing{
    .young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 300, .flow_rate = 4, .hardening = .2};

/// Of 7 x 5 x 6 hexahedra of two materials, in bricks that are not full and more than one block of nodes.
Body block(const Settings& settings = kMixed, double yield_stress = 300) {
  const HexMesh mesh = regular_grid({7, 5, 6}, {0, 0, 0}, {.7, .4, .6});
  std::vector<Material> materials(mesh.num_elements(), kFlowing);
  for (std::size_t e = 0; e < materials.size(); ++e) {
    materials[e].yield_stress = yield_stress;
    if (e % 3 == 0)
      materials[e] = {.young_modulus = 9000, .poisson_ratio = .3, .yield_stress = 2 * yield_stress, .flow_rate = 2};
  }
  return Body(mesh, materials, settings);
}

/// Turned, stretched by a fifth, and bent.
PointArray deformed(const Body& body, double size = .004, std::uint64_t seed = 5) {
  Random random(seed);
  PointArray x = body.mesh().positions();
  x.col(0) *= 1.2;
  x.col(1) += .3 * x.col(0).cwiseProduct(x.col(0));
  return x * random.rotation().transpose() + random.field(body.mesh().num_nodes(), size);
}

Body on_device(Body body) {
  body.use_device("emulation");
  return body;
}

PointArray force_at(Body& body, const PointArray& x) {
  PointArray force = PointArray::Zero(x.rows(), 3);
  body.linearize(x);
  body.add_force(force);
  return force;
}

double relative(const PointArray& found, const PointArray& right) { return (found - right).norm() / right.norm(); }

TEST(DeviceBody, EvaluatesAsTheCpuDoes) {
  for (const YieldStressMeasure measure : {YieldStressMeasure::kBiot, YieldStressMeasure::kCauchy}) {
    Settings settings = kMixed;
    settings.yield_stress_measure = measure;
    Body cpu = block(settings), device = on_device(block(settings));
    const PointArray x = deformed(cpu), dx = Random(6).field(cpu.mesh().num_nodes(), 1);
    PointArray force[2], product[2];
    for (int step = 0; step < 3; ++step) {
      int k = 0;
      for (Body* body : {&cpu, &device}) {
        body->linearize(x);
        force[k].setZero(x.rows(), 3), product[k].setZero(x.rows(), 3);
        body->add_force(force[k]);
        body->add_stiffness_product(-1, dx, product[k++]);
      }
      EXPECT_LE(relative(force[1], force[0]), 3e-5);
      EXPECT_LE(force[1].colwise().sum().norm(), 1e-5 * force[1].norm());
      EXPECT_LE(relative(product[1], product[0]), 5e-4);  // coefficients are half
      EXPECT_NEAR(device.energy(x), cpu.energy(x), 2e-6 * cpu.energy(x));
      const FlowReport of_cpu = cpu.flow(x, .01), of_device = device.flow(x, .01);
      EXPECT_GT(of_cpu.yielded, 40);
      EXPECT_EQ(of_device.yielded, of_cpu.yielded);
      EXPECT_NEAR(device.dissipated_energy(), cpu.dissipated_energy(), 1e-4 * cpu.dissipated_energy());
    }
    const History &a = std::as_const(cpu).state().history, &b = std::as_const(device).state().history;
    for (int e = 0; e < cpu.mesh().num_elements(); ++e)
      for (int i = 0; i < kCorners; ++i) {
        EXPECT_LE((a.plastic_inverse[e][i] - b.plastic_inverse[e][i]).norm(), 2e-6);
        EXPECT_NEAR(a.yield_stress[e][i], b.yield_stress[e][i], 2e-3);
        EXPECT_NEAR(a.plastic_strain[e][i], b.plastic_strain[e][i], 2e-6);
      }
    EXPECT_LE(max_abs(device.plastic_rest_positions() - cpu.plastic_rest_positions()), 2e-6);
  }
}

TEST(DeviceBody, EnergyHasTheForceAsItsSlope) {
  Body device = on_device(block());
  const PointArray x = deformed(device), along = Random(7).field(device.mesh().num_nodes(), 1);
  device.flow(x, .01);
  device.linearize(x);
  PointArray force = PointArray::Zero(x.rows(), 3);
  device.add_force(force);
  constexpr double kStep = 1e-3;
  const double slope = (device.energy(x + kStep * along) - device.energy(x - kStep * along)) / (2 * kStep);
  EXPECT_NEAR(slope, -force.cwiseProduct(along).sum(), 2e-3 * force.norm() * along.norm());
}

/// Springs to where the nodes began, which the kernels do not know.
struct Springs final : StepForces {
  void add_force(double, const Pair<ConstPoints>& x, const Pair<ConstPoints>&, Pair<Points> f) override {
    if (from.rows() == 0) from = x.first;
    f.first.topRows(30) -= 40 * (x.first - from).topRows(30);
  }
  void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    df.first.topRows(30) -= factor * 40 * dx.first.topRows(30);
  }
  PointArray from = PointArray(0, 3);
};

TEST(DeviceBody, MovesAndFlowsAsOnTheCpu) {
  for (const bool has_springs : {false, true}) {
    MovingBody cpu(yielding_bar(kMixed), pulling(), std::make_unique<PreconditionedConjugateGradients>(1e-5, 1000));
    MovingBody device(on_device(yielding_bar(kMixed)), pulling(),
                      std::make_unique<PreconditionedConjugateGradients>(1e-5, 1000));
    Springs of_cpu, of_device;
    if (has_springs) cpu.add(of_cpu), device.add(of_device);
    for (int step = 0; step < 40; ++step) {
      cpu.step();
      device.step();
      EXPECT_TRUE(device.latest.converged);
      EXPECT_EQ(device.latest.preconditioner, PreconditionedBy::kDiagonal);
      EXPECT_NEAR(device.latest.iterations, cpu.latest.iterations, 3);
    }
    EXPECT_LE(max_abs(device.positions - cpu.positions), 4e-5);  // 1e-4 of the size
    EXPECT_EQ(device.positions.topRows(9), cpu.positions.topRows(9)) << "fixed";
    if (has_springs) continue;
    EXPECT_GT(cpu.body.dissipated_energy(), 0);
    EXPECT_LE(max_abs(device.body.plastic_rest_positions() - cpu.body.plastic_rest_positions()), 4e-5);
  }
}

TEST(DeviceBody, HasTheSameBitsInEveryRun) {
  const auto hash = [] {
    MovingBody moving(on_device(yielding_bar(kMixed)), pulling(),
                      std::make_unique<ConjugateGradients>(ConjugateGradientSettings{.iterations = 10}));
    moving.run(15);
    return moving.state_hash();
  };
  EXPECT_EQ(hash(), hash());
}

// As it is saved and loaded, copied, or taken up after nothing was opened. Cycles take up what they know of spectra.
TEST(DeviceBody, GoesOnWithTheSameBits) {
  const auto pulled = [] {
    const HexMesh mesh = regular_grid({4, 4, 8}, {0, 0, 0}, {.1, .1, .4});
    Motion motion = pulling();
    motion.fixed = nodes_at(mesh, 2, 0);
    return MovingBody(on_device(Body(mesh, {kFlowing}, kMixed)), motion,
                      std::make_unique<PreconditionedConjugateGradients>(1e-4, 100, Preconditioner::kMultigrid));
  };
  MovingBody whole = pulled(), first = pulled(), second = pulled();
  whole.run(25);
  first.run(20);
  std::stringstream saved;
  first.save(saved);
  second.load(saved);
  second.run(5);
  EXPECT_GT(whole.body.dissipated_energy(), 0);
  EXPECT_EQ(whole.latest.preconditioner, PreconditionedBy::kMultigrid);
  EXPECT_EQ(second.state_hash(), whole.state_hash());

  Body body = on_device(block()), copy = body;
  const PointArray x = deformed(body);
  body.linearize(x);
  PointArray before = PointArray::Zero(x.rows(), 3), after = before;
  body.add_force(before);
  EXPECT_TRUE(body.open({}).empty());
  body.energy(x);
  body.add_force(after);
  EXPECT_EQ(after, before);
  copy = body;
  EXPECT_THROW(copy.add_force(after), InputError) << "it is not linearized";
  copy.linearize(x);
  after.setZero();
  copy.add_force(after);
  EXPECT_EQ(after, before);
}

// Rotations of such samples are found by the singular value decomposition.
TEST(DeviceBody, ComputesWhatIsInsideOutOrFlat) {
  Settings settings = kMixed;
  settings.recovery = RecoveryMode::kNone;
  Body cpu = block(settings), device = on_device(block(settings));
  const PointArray X = cpu.mesh().positions();
  PointArray shapes[4] = {X, X, X, X};
  shapes[0] *= Vec3(-.8, 1.1, 1.3).asDiagonal();
  shapes[1].leftCols(2) *= 1e-12;
  shapes[2] *= 1e-12;
  shapes[3].row(100).array() += .25;
  for (const PointArray& x : shapes) {
    const PointArray of_cpu = force_at(cpu, x), of_device = force_at(device, x);
    // of a point any rotation is as good
    EXPECT_LE(&x == &shapes[2] ? !of_device.allFinite() : relative(of_device, of_cpu), 1e-4) << &x - shapes;
    EXPECT_NEAR(device.energy(x), cpu.energy(x), 1e-5 * cpu.energy(x));
  }
}

TEST(DeviceBody, MovesInTwoThreads) {
  const auto run = [](std::string* hash) {
    MovingBody moving(on_device(yielding_bar(kMixed)), pulling(),
                      std::make_unique<PreconditionedConjugateGradients>(1e-4, 100));
    moving.run(10);
    *hash = moving.state_hash();
  };
  std::string alone, one, other;
  run(&alone);
  std::thread beside([&] { run(&other); });
  run(&one);
  beside.join();
  EXPECT_EQ(one, alone);
  EXPECT_EQ(other, alone);
}

TEST(DeviceBody, LeavesFoldedHexahedraToTheCpu) {
  Body cpu = block(), device = on_device(block());
  PointArray x = deformed(cpu);
  x.row(cpu.mesh().hexahedra()[17][6]) +=
      .9 * (x.row(cpu.mesh().hexahedra()[17][0]) - x.row(cpu.mesh().hexahedra()[17][6]));
  const FlowReport of_cpu = cpu.flow(x, .01), of_device = device.flow(x, .01);
  EXPECT_GT(of_cpu.skipped, 0);
  EXPECT_EQ(of_device.skipped, of_cpu.skipped);
  EXPECT_EQ(of_device.inverted, of_cpu.inverted);
  EXPECT_EQ(of_device.yielded, of_cpu.yielded);
  const PointArray force = force_at(cpu, x), found = force_at(device, x);
  EXPECT_TRUE(std::as_const(device).state().backend->recovery().acts());
  EXPECT_LE(relative(found, force), 1e-4);
  EXPECT_NEAR(device.energy(x), cpu.energy(x), 1e-4 * cpu.energy(x));
  for (std::size_t e = 0; e < cpu.plastic_strain().size(); ++e)
    for (int i = 0; i < kCorners; ++i) EXPECT_NEAR(device.plastic_strain()[e][i], cpu.plastic_strain()[e][i], 1e-5);
}

TEST(DeviceBody, WhatIsSavedKnowsNothingOfIt) {
  Body cpu = block(), device = on_device(block());
  const PointArray x = deformed(cpu);
  device.flow(x, .01);
  std::stringstream saved;
  device.save(saved);
  cpu.load(saved);
  const auto strain = [](const Body& body) { return body.plastic_strain()[20]; };
  EXPECT_EQ(strain(cpu), strain(device));
  EXPECT_GT(strain(cpu)[0], 0);
  std::stringstream again;
  cpu.flow(x, .01);
  cpu.save(again);
  device.load(again);
  EXPECT_EQ(strain(device), strain(cpu));
  Body copy = device;
  EXPECT_EQ(copy.device(), "emulation");
  copy.flow(x, .01);
  EXPECT_NE(strain(copy), strain(device));
  copy.use_device("cpu");
  EXPECT_EQ(copy.device(), "cpu");
  device.flow(x, .01);
  EXPECT_EQ(strain(copy), strain(device));
  device.reset();
  EXPECT_EQ(strain(device), strain(block()));
}

TEST(DeviceBody, FollowsRemovalsCutsAndOtherMaterials) {
  Body cpu = block(), device = on_device(block());
  const PointArray before = deformed(cpu);
  PointArray x;
  const std::vector<int> removed = {0, 7, 30};
  std::vector<Material> stiffer = cpu.materials();
  for (Material& material : stiffer) material.young_modulus *= 2;
  PointArray force[2];
  int k = 0;
  for (Body* body : {&cpu, &device}) {
    x = before;
    body->flow(x, .01);
    body->remove(removed);
    body->flow(x, .01);
    std::vector<int> cut;
    for (int joint = 40; joint < 80; ++joint) cut.push_back(joint);
    const std::vector<int> split_from = body->open(cut);
    EXPECT_GT(split_from.size(), 5u);
    append_rows(split_from, x);
    x.bottomRows(2).array() += .004;
    body->flow(x, .01);
    body->set_materials(stiffer);
    body->flow(x, .01);
    body->linearize(x);
    force[k].setZero(x.rows(), 3);
    body->add_force(force[k++]);
  }
  EXPECT_LE(relative(force[1], force[0]), 5e-5);
  EXPECT_NEAR(device.energy(x), cpu.energy(x), 5e-6 * cpu.energy(x));
  EXPECT_NEAR(device.dissipated_energy(), cpu.dissipated_energy(), 1e-4 * cpu.dissipated_energy());
}

TEST(DeviceBody, BreaksAndTearsAsOnTheCpu) {
  for (const Fracture fracture : {Fracture::kCell, Fracture::kFace}) {
    Settings settings = kMixed;
    settings.fracture = fracture;
    const HexMesh mesh = regular_grid({7, 5, 6}, {0, 0, 0}, {.7, .4, .6});
    Random random(8);
    std::vector<Material> materials(mesh.num_elements(), kFlowing);
    for (Material& material : materials)
      if (random.uniform(0, 1) < .5)
        material.fracture_stress = random.uniform(320, 600);
      else
        material.fracture_stretch = random.uniform(1.02, 1.2);
    Body cpu(mesh, materials, settings), device = on_device(Body(mesh, materials, settings));
    std::size_t torn = 0;
    for (int step = 0; step < 12; ++step) {
      const PointArray x = deformed(cpu, .01, 20 + step);
      const FlowReport of_cpu = cpu.flow(x, .02), of_device = device.flow(x, .02);
      EXPECT_EQ(of_device.yielded, of_cpu.yielded) << step;
      EXPECT_EQ(of_device.removed, of_cpu.removed) << step;
      EXPECT_EQ(of_device.torn, of_cpu.torn) << step;
      torn += of_cpu.torn.size();
      EXPECT_LE(relative(force_at(device, x), force_at(cpu, x)), 3e-5);
    }
    EXPECT_TRUE(std::ranges::equal(device.removed(), cpu.removed()));
    EXPECT_GE(fracture == Fracture::kCell ? cpu.removed().size() : torn, 20U);
  }
}

TEST(DeviceBody, RefusesByName) {
  const auto refusal = [](Body body, const std::string& name = "emulation") -> std::string {
    body.set_time_step(.01);
    try {
      body.use_device(name);
    } catch (const InputError& error) {
      EXPECT_EQ(body.device(), "cpu");
      EXPECT_LE(body.energy(body.mesh().positions()), 1e-20) << "it is as before";
      return error.what();
    }
    return "nothing";
  };
  const auto with = [](const auto& change) {
    Settings settings = kMixed;
    change(settings);
    return yielding_bar(settings);
  };
  EXPECT_EQ(refusal(yielding_bar()), "device emulation: precision must be mixed");
  EXPECT_EQ(refusal(with([](Settings& s) { s.yield_norm = YieldNorm::kFrobenius; })),
            "device emulation: yieldNorm must be vonMises");
  EXPECT_EQ(refusal(with([](Settings& s) { s.relaxation = {.5, 1}; })), "device emulation: relaxation must be empty");
  const HexMesh cube = regular_grid({1, 1, 1}, {0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(refusal(Body(cube, {Material{}}, {.law = ElasticLaw::kNeoHookean, .precision = Precision::kMixed})),
            "device emulation: law must be corotated");
  EXPECT_EQ(refusal(Body(distorted_block({2, 2, 2}, .1, .1, 3), {Material{}}, kMixed)),
            "device emulation: hexahedron 0 is no parallelepiped");
  EXPECT_EQ(refusal(yielding_bar(kMixed), "vulkan"), "device vulkan: must be cpu, cuda or emulation");
  Body device = on_device(block());
  device.linearize(device.mesh().positions());
  const std::string of_card = refusal(yielding_bar(kMixed), "cuda");
  EXPECT_TRUE(of_card == "nothing" || of_card.starts_with("device cuda: ")) << of_card;
  BlockMatrix K(device.mesh().num_nodes());
  EXPECT_THROW(device.add_stiffness_blocks(1, K), InputError);
}

PointArray stretched(const HexMesh& mesh) {
  PointArray x = mesh.positions();
  x.col(0) *= 1.3;
  x.col(2) += 2 * x.col(0).cwiseProduct(x.col(0));
  return x;
}

/// A slab of one body that has flowed, some of whose hexahedra are gone.
Slab flowed_slab(double young_modulus) {
  Slab slab(regular_grid({14, 12, 5}, Vec3::Zero(), kSlabSize));
  for (int n = 500; n < slab.num_nodes(); n += 11) slab.held.push_back(n);  // between coarse ones too
  Material soft = kFlowing;
  soft.young_modulus = young_modulus;
  soft.yield_stress = 1e-3 * young_modulus;
  Body& body = slab.bodies.emplace_back(slab.mesh, std::vector{soft}, kMixed);
  EXPECT_GT(body.flow(stretched(slab.mesh), .1).yielded, 800);
  const std::vector<int> removed = {5, 6, 100, 301};
  body.remove(removed);
  body.linearize(stretched(slab.mesh));
  return slab;
}

SolveReport solved(const Slab& slab, Preconditioner by, double tolerance, int iterations, PointArray& x) {
  const PointArray b = Random(3).field(slab.num_nodes(), 1);
  x.setZero(slab.num_nodes(), 3);
  return PreconditionedConjugateGradients(tolerance, iterations, by).solve(slab, b, x);
}

/// After one iteration a solution is the right-hand side over the diagonal, but for a factor.
TEST(DeviceBody, HasTheDiagonalOfTheBody) {
  Slab slab = flowed_slab(5e4);
  PointArray x[2];
  solved(slab, Preconditioner::kDiagonal, 0, 1, x[0]);
  slab.bodies.front().use_device("emulation");
  slab.bodies.front().linearize(stretched(slab.mesh));
  solved(slab, Preconditioner::kDiagonal, 0, 1, x[1]);
  const double factor = x[0].cwiseProduct(x[1]).sum() / x[0].squaredNorm();
  EXPECT_LE(relative(x[1] / factor, x[0]), 2e-2);
}

/// Alone, and with ties to the ground that are stiffer than hexahedra, in directions that are not axes; 1e8 N/m is
/// rigid.
TEST(DeviceBody, SolvesByCyclesAsTheCpuDoes) {
  const double cases[][2] = {{1e4, 0}, {1e4, 1e3}, {1e4, 1e8}, {1e6, 0}};
  for (const auto& [young_modulus, tie] : cases) {
    SCOPED_TRACE(fmt::format("{} Pa, {} N/m", young_modulus, tie));
    Slab slab = flowed_slab(young_modulus);
    for (int n = 200; n < 500 && tie > 0; ++n) {
      const Vec3 normal = Vec3(.02 * (n - 350), .5, 1).normalized();
      slab.ties.add(n, n, kSlabStep * kSlabStep * tie * normal * normal.transpose());
    }
    PointArray x[2];
    SolveReport report[2];
    for (int k = 0; k < 2; ++k) {
      if (k == 1) slab.bodies.front().use_device("emulation");
      slab.bodies.front().linearize(stretched(slab.mesh));
      report[k] = solved(slab, Preconditioner::kMultigrid, 1e-3, 200, x[k]);
      EXPECT_EQ(report[k].preconditioner, PreconditionedBy::kMultigrid);
      EXPECT_TRUE(report[k].converged);
    }
    EXPECT_LE(report[1].iterations, report[0].iterations + 2);
    EXPECT_LE(relative(x[1], x[0]), 1e-2);
    PointArray product(slab.num_nodes(), 3), b = Random(3).field(slab.num_nodes(), 1);
    slab.apply(x[1], product);
    slab.project(b);
    EXPECT_LE(relative(product, b), 2e-3);
    PointArray by_diagonal;
    const int iterations = solved(slab, Preconditioner::kDiagonal, 1e-3, 1000, by_diagonal).iterations;
    EXPECT_LE(iterations, tie > 0 ? 70 : 500);
  }
}

/// Two bodies that share nodes, tied to each other and to the ground; the second one on a device, or both.
TEST(DeviceBody, SolvesForSeveralBodiesAsTheCpuDoes) {
  for (const Preconditioner by : {Preconditioner::kDiagonal, Preconditioner::kMultigrid})
    for (const bool slides : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {}", by == Preconditioner::kMultigrid, slides));
      Slab slab(regular_grid({14, 12, 5}, Vec3::Zero(), kSlabSize));
      const int count = slab.mesh.num_elements();
      slab.add_body(0, count / 3, 1e6, Precision::kMixed);
      slab.add_body(count / 3, count, 1e4, Precision::kMixed);
      for (int n = 0; n < slab.num_nodes(); n += 15) slab.held.push_back(n);
      slab.slides = slides;
      for (int n = 40; n < slab.num_nodes(); n += 40) {
        const Mat3 tie = 1e3 * kSlabStep * kSlabStep * Vec3(1, 2, 2) * Vec3(1, 2, 2).transpose() / 9;
        slab.ties.add(n, n, tie);
        slab.ties.add(n, n - 39, -tie);
        slab.ties.add(n - 39, n, -tie);
        slab.ties.add(n - 39, n - 39, tie);
      }
      PointArray x[3], product(slab.num_nodes(), 3), b = Random(3).field(slab.num_nodes(), 1);
      slab.project(b);
      SolveReport report[3];
      for (int k = 0; k < 3; ++k) {
        if (k > 0) slab.bodies[2 - k].use_device("emulation");
        for (Body& body : slab.bodies) body.linearize(stretched(slab.mesh));
        x[k].setZero(slab.num_nodes(), 3);
        report[k] = PreconditionedConjugateGradients(1e-4, 600, by).solve(slab, b, x[k]);
        EXPECT_TRUE(report[k].converged);
        EXPECT_EQ(report[k].preconditioner,
                  by == Preconditioner::kDiagonal ? PreconditionedBy::kDiagonal : PreconditionedBy::kMultigrid);
        EXPECT_LE(report[k].iterations, 1.1 * report[0].iterations + 2);
        EXPECT_LE(relative(x[k], x[0]), 1e-2);
        slab.apply(x[k], product);
        EXPECT_LE(relative(product, b), 3e-3);  // coefficients are half
      }
    }
}

/// A diagonal, or blocks of one node each that only products know.
struct OtherTerms final : NodalOperator {
  void add_product(double factor, ConstPoints p, Points Fp) const override { Fp += factor * diagonal.cwiseProduct(p); }
  bool has_diagonal() const override { return is_known; }
  void add_diagonal(double factor, Points to) const override { to += factor * diagonal; }
  void add_blocks(double factor, BlockMatrix& A) const override {
    for (int n = 0; is_known && n < diagonal.rows(); ++n)
      A.add(n, n, Mat3(factor * diagonal.row(n).transpose().asDiagonal()));
  }
  PointArray diagonal;
  bool is_known = true;
};
struct SlabWithTerms final : LinearSystem {
  int num_nodes() const override { return slab.num_nodes(); }
  void apply(ConstPoints p, Points Ap) const override {
    slab.apply(p, Ap);
    terms.add_product(1, p, Ap);
    slab.project(Ap);
  }
  bool matrix_free(MatrixFreeSystem& system) const override {
    slab.matrix_free(system);
    system.others.emplace_back(&terms);
    return true;
  }
  Slab slab = Slab(regular_grid({6, 5, 5}, Vec3::Zero(), {.06, .05, .05}));
  OtherTerms terms;
};

/// Found by a trial: blocks and a diagonal at the same nodes; weak terms without blocks beside stiff ones; nodes that
/// have nothing but a term.
TEST(DeviceBody, SolvesWithTermsOfAllKinds) {
  enum Case { kBlocksAndDiagonal, kWeakWithoutBlocks, kOnlyABlock, kOnlyAnAxis };
  for (const Case which : {kBlocksAndDiagonal, kWeakWithoutBlocks, kOnlyABlock, kOnlyAnAxis})
    for (const Preconditioner by : {Preconditioner::kDiagonal, Preconditioner::kMultigrid}) {
      SCOPED_TRACE(fmt::format("{} {}", static_cast<int>(which), static_cast<int>(by)));
      SlabWithTerms system;
      Slab& slab = system.slab;
      Random random(7);
      const int num_nodes = slab.num_nodes(), last = num_nodes - 1;
      slab.add_body(0, slab.mesh.num_elements(), 5000, Precision::kMixed);
      system.terms.diagonal.setZero(num_nodes, 3);
      PointArray b = random.field(num_nodes, 1);
      if (which == kBlocksAndDiagonal)
        for (int n = 0; n < num_nodes; n += 2) {
          const Vec3 normal = random.rotation().col(0);
          slab.ties.add(n, n, 100 * normal * normal.transpose());
          system.terms.diagonal(n, 0) = .01;
        }
      if (which == kWeakWithoutBlocks) {
        system.terms.is_known = false;
        for (int n = 0; n < num_nodes; ++n) {
          if (n < 84) slab.ties.add(n, n, 1e9 * Vec3::UnitX() * Vec3::UnitX().transpose());
          if (n >= 210) system.terms.diagonal(n, 2) = .02;
        }
        b.setZero();
        b.bottomRows(42).col(2).setOnes();
      }
      if (which == kOnlyABlock || which == kOnlyAnAxis) {
        slab.bodies.front().remove({{slab.mesh.num_elements() - 1}});
        slab.diagonal.row(last).setZero();
        const Vec3 normal(.6, .8, 0);
        if (which == kOnlyABlock)
          slab.ties.add(last, last, .1 * normal * normal.transpose());
        else
          system.terms.diagonal.row(last).setConstant(.1);
        b.setZero();
        b.row(100).setOnes();
        b.row(last) = .01 * normal.transpose();
      }
      PointArray x[2];
      SolveReport report[2];
      for (int k = 0; k < 2; ++k) {
        if (k == 1) slab.bodies.front().use_device("emulation");
        slab.bodies.front().linearize(slab.mesh.positions());
        x[k].setZero(num_nodes, 3);
        report[k] = PreconditionedConjugateGradients(1e-3, 200, by).solve(system, b, x[k]);
        EXPECT_TRUE(report[k].converged);
      }
      EXPECT_LE(report[1].iterations, report[0].iterations + 3);
      EXPECT_LE(relative(x[1], x[0]), 1e-2);
    }
}

/// A body has one set of vectors there: the solves of several threads take turns.
TEST(DeviceBody, HasTheComplianceOfConstraintsForAnyThreads) {
  Slab slab(regular_grid({6, 6, 3}, Vec3::Zero(), {.06, .06, .03}));
  slab.add_body(0, slab.mesh.num_elements(), 2e5, Precision::kMixed);
  const int top = slab.num_nodes() - 1;
  const std::vector<ConstraintRow> rows = {{{top, Vec3::UnitZ()}},
                                           {{top - 3, Vec3::UnitX()}, {top - 10, Vec3::UnitX()}},
                                           {{top - 17, Vec3::UnitY()}},
                                           {{top - 22, Vec3(1, 0, 1)}}};
  Eigen::MatrixXd W[3];
  W[0] = Compliance(Preconditioner::kAuto, 1e-10).find(slab, rows);
  slab.bodies.front().use_device("emulation");
  slab.bodies.front().linearize(slab.mesh.positions());
  for (int k = 1; k < 3; ++k) {
    set_num_threads(k == 1 ? 1 : 4);
    W[k] = Compliance().find(slab, rows);
  }
  set_num_threads(1);
  EXPECT_LE((W[1] - W[0]).norm(), 2e-2 * W[0].norm());
  EXPECT_EQ(W[2], W[1]);
}

}  // namespace
}  // namespace hexaplast
