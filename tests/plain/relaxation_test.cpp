// SPDX-License-Identifier: LGPL-2.1-or-later
// Viscoelastic branches against closed forms, and against what must hold of them.
#include "support/relaxation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "hexaplast/solve/newton_raphson.hpp"
#include "support/core.hpp"
#include "support/elastic_laws.hpp"

namespace hexaplast {
namespace {

constexpr double kEquilibrium = std::numeric_limits<double>::infinity();

/// By the kernels, which are the plain implementation (tests/plain/plain_test.cpp).
Settings relaxing(std::vector<double> relaxation, RestShape rest_shape = RestShape::kIsolated) {
  return {.relaxation = std::move(relaxation), .recovery = RecoveryMode::kNone, .rest_shape = rest_shape};
}

void step(Body& body, const PointArray& x, double h) {
  body.set_time_step(h);
  body.flow(x, h);
}

/// What acts at the moment.
PointArray force_now(Body& body, const PointArray& x) {
  body.set_time_step(0);
  return force_at(body, x);
}

Mat3 deviator(const Mat3& S) { return S - S.trace() / 3 * Mat3::Identity(); }

// P = P of slow deformation + sum 2 g mu e^(-t/T) R dev S, whatever the steps.
TEST(Relaxation, AfterAJumpIsExponentialForAnySteps) {
  const std::vector<double> relaxation{0.7, 0.3, 2, 0.05};
  const HexMesh mesh = distorted_block({2, 2, 2}, kEdge, 0.15, 701);
  const Material material{.young_modulus = 4000, .poisson_ratio = 0.4};
  Body body(mesh, {material}, relaxing(relaxation)), slow(mesh, {material});
  Mat3 F = Mat3::Identity();
  F(0, 0) = 1.3;
  F(0, 1) = 0.6;
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 R = svd.matrixU() * svd.matrixV().transpose(), S = R.transpose() * F;
  const double mu = lame(material.young_modulus, material.poisson_ratio).mu;
  const PointArray x = mapped(mesh.positions(), F), slow_force = force_at(slow, x);
  const double volume = body.initial_volume();

  step(body, x, 1e-13);
  double time = 0;
  for (const double h : {0.01, 0.2, 0.003, 1.5, 0.07}) {
    double held = 0;
    for (std::size_t k = 0; k < relaxation.size(); k += 2)
      held += 2 * relaxation[k] * mu * std::exp(-time / relaxation[k + 1]);
    const PointArray f = force_now(body, x) - slow_force;
    const Mat3 P = -f.transpose() * mesh.positions() / volume;
    EXPECT_TRUE(agrees(P, Mat3(held * R * deviator(S)), 1e-8)) << time;
    step(body, x, h);
    time += h;
  }
}

TEST(Relaxation, ASuddenChangeMeetsAllModuliAndAnEquilibriumTheSlowOnes) {
  const HexMesh mesh = distorted_block({2, 2, 2}, kEdge, 0.15, 702);
  const double E = 4000, nu = 0.4, g = 1.5;
  Body body(mesh, {{.young_modulus = E, .poisson_ratio = nu}}, relaxing({g, 0.3})),
      slow(mesh, {{.young_modulus = E, .poisson_ratio = nu}});
  Random random(703);
  const PointArray x = mesh.positions() + random.field(mesh.num_nodes(), 0.1 * kEdge);
  step(body, x, 0.1);
  body.set_time_step(kEquilibrium);
  EXPECT_TRUE(agrees(force_at(body, x), force_at(slow, x), 1e-12));
  EXPECT_TRUE(agrees(stiffness_at(body, x), stiffness_at(slow, x), 1e-12));
  body.flow(x, 0.1);
  EXPECT_TRUE(agrees(force_now(body, x), force_at(slow, x), 1e-12)) << "nothing is held";

  // all modes of small displacements, those inside a cell too
  const Mat3 shear = (Mat3() << 1, 0.3, 0.1, 0, 1.2, -0.2, 0, 0, 0.7).finished();
  const HexMesh cubes = block({2, 1, 1}, kEdge), cells(mapped(cubes.positions(), shear), cubes.hexahedra());
  const Lame k = lame(E, nu);
  const double mu = k.mu * (1 + g), bulk = k.lambda + 2 * k.mu / 3;
  Body relaxing_cells(cells, {{.young_modulus = E, .poisson_ratio = nu}}, relaxing({1, 0.3, g - 1, 7})),
      sudden(cells, {{.young_modulus = 9 * bulk * mu / (3 * bulk + mu),
                      .poisson_ratio = (3 * bulk - 2 * mu) / (2 * (3 * bulk + mu))}});
  relaxing_cells.set_time_step(0);
  EXPECT_TRUE(agrees(stiffness_at(relaxing_cells, cells.positions()), stiffness_at(sudden, cells.positions()), 1e-10));

  // and how they relax: what is beyond slow forces by each branch's share
  Body slow_cells(cells, {{.young_modulus = E, .poisson_ratio = nu}});
  const PointArray bent = cells.positions() + random.field(cells.num_nodes(), 1e-7 * kEdge);
  const PointArray slow_force = force_at(slow_cells, bent), sudden_force = force_at(sudden, bent);
  step(relaxing_cells, bent, 1e-13);
  double time = 0;
  for (const double h : {0.1, 0.3, 2.0, 10.0}) {
    const double share = (std::exp(-time / 0.3) + (g - 1) * std::exp(-time / 7)) / g;
    const PointArray expected = slow_force + share * (sudden_force - slow_force);
    EXPECT_TRUE(agrees(force_now(relaxing_cells, bent), expected, 1e-6)) << time;
    step(relaxing_cells, bent, h);
    time += h;
  }
}

TEST(Relaxation, WhatHasRelaxedStaysSoWhenTheMaterialChanges) {
  const HexMesh mesh = distorted_block({2, 1, 1}, kEdge, 0.1, 711);
  const Material stiffer{.young_modulus = 9000, .poisson_ratio = 0.45};
  Body body(mesh, {{.young_modulus = 5000, .poisson_ratio = 0.3}}, relaxing({1.5, 0.01})), slow(mesh, {stiffer});
  const PointArray bent = mesh.positions() + Random(712).field(mesh.num_nodes(), 0.1 * kEdge);
  step(body, bent, 10);
  step(body, bent, 10);
  body.set_materials({stiffer});
  EXPECT_TRUE(agrees(force_now(body, bent), force_at(slow, bent), 1e-12));
}

/// A block whose branches hold what a random path has left in them; true: and whose samples have flowed.
class HeldBody : public testing::TestWithParam<bool> {
 protected:
  HeldBody() {
    for (int n = 0; n < 6; ++n) step(body, placed(), random.uniform(0.01, 0.1));
    body.set_time_step(0.03);
  }
  PointArray placed(double size = 0.15) {
    return mapped(PointArray(mesh.positions() + random.field(mesh.num_nodes(), size * kEdge)), random.rotation(),
                  random.vector(1));
  }
  Random random{704};
  HexMesh mesh = distorted_block({2, 2, 2}, kEdge, 0.15, 705);
  Body body{mesh,
            {GetParam() ? Material{.yield_stress = 100, .flow_rate = 8, .hardening = 0.2}
                        : Material{.poisson_ratio = 0.1}},  // where w is at its bound
            relaxing({0.7, 0.3, 2, 0.02})};
};
INSTANTIATE_TEST_SUITE_P(That, HeldBody, testing::Bool(),
                         [](const auto& test) { return test.param ? "flows" : "is_elastic"; });

TEST_P(HeldBody, HasAnEnergyBalanceAndAStiffness) { expect_elastic_laws(body, placed(), random); }

// What is dissipated by relaxation, and what the energy loses when it is accounted for.
TEST_P(HeldBody, DissipatesInEveryStepOfARandomPath) {
  for (int n = 0; n < 200; ++n) {
    const PointArray x = placed(random.uniform(0, 0.2));
    const double h = std::pow(10, random.uniform(-6, n % 2 == 0 ? 1 : -1.5)), before = body.dissipated_energy();
    body.set_time_step(h);
    const double energy = body.energy(x);
    body.flow(x, h);
    EXPECT_GE(body.dissipated_energy(), before) << n;
    EXPECT_LE(body.energy(x), energy * (1 + 1e-12)) << n;
  }
}

TEST(Relaxation, WorkOnAClosedPathIsStoredAndDissipated) {
  const HexMesh mesh = distorted_block({2, 1, 1}, kEdge, 0.15, 706);
  Random random(707);
  const PointArray u = random.field(mesh.num_nodes(), 0.3 * kEdge), w = random.field(mesh.num_nodes(), 0.3 * kEdge);
  const auto defect = [&](int steps) {
    Body body(mesh, {{}}, relaxing({0.7, 0.3, 2, 0.1}));
    PointArray x = mesh.positions(), f = force_now(body, x);
    double work = 0;
    for (int n = 1; n <= steps; ++n) {
      const double angle = 2 * std::numbers::pi * n / steps;
      const PointArray next = mesh.positions() + std::sin(angle) * u + (1 - std::cos(angle)) * w;
      step(body, next, 1.0 / steps);
      const PointArray force = force_now(body, next);
      work -= (f + force).cwiseProduct(next - x).sum() / 2;
      x = next, f = force;
    }
    return (work - body.energy(x) - body.dissipated_energy()) / body.dissipated_energy();
  };
  const double coarse = defect(50), middle = defect(100), fine = defect(200);
  EXPECT_LE(std::abs(coarse), 1e-2);
  EXPECT_NEAR(coarse / middle, 4, 0.3);
  EXPECT_NEAR(middle / fine, 4, 0.15);
}

// Branches carry more than yield stress while stretch grows, and none of it for ever.
TEST(Relaxation, StressAfterAHoldIsTheYieldStress) {
  const double tau = 100;
  const HexMesh mesh = block({1, 1, 1}, kEdge);
  Body body(mesh, {{.young_modulus = 5000, .poisson_ratio = 0.3, .yield_stress = tau, .flow_rate = 4}},
            relaxing({1, 0.2}, RestShape::kIsolated));
  const auto stretched = [&](double stretch) {
    return mapped(mesh.positions(), Vec3(stretch, 1 / std::sqrt(stretch), 1 / std::sqrt(stretch)).asDiagonal());
  };
  const double h = 0.01;
  double greatest = 0, previous = std::numeric_limits<double>::infinity();
  for (int n = 1; n <= 20; ++n) {
    step(body, stretched(1 + 0.01 * n), h);
    greatest = std::max(greatest, body.fields(stretched(1 + 0.01 * n)).stress_norm[0]);
  }
  EXPECT_GT(greatest, 2.5 * tau);
  for (const int steps : {100, 100, 1000}) {
    for (int n = 0; n < steps; ++n) step(body, stretched(1.2), h);
    const double stress = body.fields(stretched(1.2)).stress_norm[0];
    EXPECT_GT(stress, tau * (1 - 1e-12));
    EXPECT_LT(stress, previous);
    previous = stress;
  }
  EXPECT_NEAR(previous, tau, 1e-4 * tau);
}

// However stiff the branches are: more flow than that would take the stress below it, or turn it round.
TEST(Relaxation, PlasticityWithoutARateReturnsToTheYieldStress) {
  const double tau = 100, h = 0.01;
  const HexMesh mesh = block({1, 1, 1}, kEdge);
  Body body(mesh, {{.young_modulus = 5000, .poisson_ratio = 0.3, .yield_stress = tau, .flow_rate = 500}},
            relaxing({4, 100}, RestShape::kIsolated));
  const PointArray x = mapped(mesh.positions(), Vec3(1.01, 1 / std::sqrt(1.01), 1 / std::sqrt(1.01)).asDiagonal());
  step(body, x, h);
  EXPECT_NEAR(body.fields(x).stress_norm[0], tau, 0.01 * tau);
}

// Pairs of opposite stretches have no rotation, and the moment that balances a stress no bound.
TEST(Relaxation, ForcesOfInvertedSamplesAreBoundedAndInBalance) {
  const HexMesh mesh = block({1, 1, 1}, kEdge);
  Body body(mesh, {{}}, relaxing({1, 0.2}));
  Mat3 F = Mat3::Identity();
  F(0, 1) = F(2, 1) = 0.3;
  step(body, mapped(mesh.positions(), F), 1e-3);
  body.set_time_step(1e-3);
  const double size = max_abs(force_at(body, mapped(mesh.positions(), F)));
  for (const double least : {-0.3, -0.5 + 1e-3, -0.5 + 1e-6, -0.5 + 1e-9, -0.5 + 1e-15}) {
    const PointArray x = mapped(mesh.positions(), Vec3(1.1, 0.5, least).asDiagonal()), f = force_at(body, x);
    EXPECT_LE(max_abs(f), 100 * size) << least;
    EXPECT_LE(moment(x, f).norm(), 1e-12 * f.cwiseAbs().sum() * kEdge) << least;
  }
}

/// A bar that bends by its weight; with isolated rest shapes it yields.
MovingBody bending_bar(std::vector<double> relaxation, RestShape rest_shape, Precision precision) {
  const HexMesh mesh = distorted_block({6, 6, 24}, kEdge, 0.1, 709);
  Settings settings = relaxing(std::move(relaxation), rest_shape);
  settings.precision = precision;
  Material material{.young_modulus = 1e5, .poisson_ratio = 0.3};
  if (rest_shape == RestShape::kIsolated) material.yield_stress = 600, material.flow_rate = 4;
  return {Body(mesh, {material}, settings),
          {.dt = 0.01, .gravity = {0, -9.81, 0}, .fixed = nodes_at(mesh, 2, 0, 0.2 * kEdge)},
          std::make_unique<PreconditionedConjugateGradients>(1e-6, 500, Preconditioner::kMultigrid)};
}

TEST(RelaxingBody, HasTheSameBitsForAnyThreads) {
  for (const RestShape rest_shape : {RestShape::kJoined, RestShape::kIsolated})
    for (const Precision precision : {Precision::kDouble, Precision::kMixed})
      expect_the_same_for_any_threads([&] {
        MovingBody bar = bending_bar({0.7, 0.3, 2, 0.02}, rest_shape, precision);
        EXPECT_EQ(bar.run(6).flow.yielded > 0, rest_shape == RestShape::kIsolated);
        return bar.state_hash();
      });
}

// Cycles and their coarse meshes know what branches add to the stiffness, which resists shear nine times as much.
TEST(RelaxingBody, TakesAboutAsManyIterationsOfMultigrid) {
  for (const RestShape rest_shape : {RestShape::kJoined, RestShape::kIsolated})
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      const auto iterations = [&](std::vector<double> relaxation) {
        MovingBody bar = bending_bar(std::move(relaxation), rest_shape, precision);
        int sum = 0;
        for (int n = 0; n < 5; ++n) {
          bar.step();
          sum += bar.latest.iterations;
        }
        return sum;
      };
      const int without = iterations({});
      EXPECT_GT(without, 15);
      EXPECT_LE(iterations({3, 0.3, 5, 2}), 1.25 * without);
    }
}

// A time integrator says how long its step is, a static analysis that it is for ever.
TEST(Relaxation, StaticAnalysisFindsTheEquilibriumOfSlowDeformation) {
  const HexMesh mesh = block({4, 1, 1}, kEdge);
  const auto deflection = [&](Settings settings) {
    Body body(mesh, {{}}, std::move(settings));
    LoadedBody system(body, lumped_masses(body, 1000), nodes_at(mesh, 0, 0),
                      [](double, ConstPoints, Points f) { f.col(1).array() -= 1e-4; });
    CholeskySolver solver;
    PointArray x = mesh.positions();
    NewtonRaphson({.iterations = 100, .relative_initial = 1e-12}).solve(system, solver, 0, x);
    return PointArray(x - mesh.positions());
  };
  EXPECT_TRUE(agrees(deflection(relaxing({3, 0.2})), deflection(relaxing({})), 1e-8));
}

// With two branches. The thinner a beam, the more of its energy is that of modes inside of cells.
TEST(RelaxingBody, RelaxesAndCreepsAsTheorySays) {
  const std::vector<double> times{0, 0.1, 0.5, 2, 10};
  for (const auto& [name, band] :
       {std::pair("held bar", 1e-4), std::pair("held shear", 1e-4), std::pair("loaded bar", 1e-4),
        std::pair("loaded beam", 0.01), std::pair("loaded thin beam", 0.015)}) {
    const std::vector<double> ours = relax(name, times), exact = relax_in_theory(name, times);
    for (std::size_t n = 0; n < times.size(); ++n)
      EXPECT_NEAR(ours[n], exact[n], band * exact[n]) << name << ", " << times[n] << " s";
  }
}

TEST(RelaxingBody, NeedsItsTimeStepBeforeOtherCalls) {
  const HexMesh mesh = block({1, 1, 1}, kEdge);
  Body body(mesh, {{}}, relaxing({1, 0.2}));
  const PointArray& x = mesh.positions();
  for (const auto& call : std::vector<std::function<void()>>{[&] { body.linearize(x); }, [&] { body.energy(x); },
                                                             [&] { body.flow(x, 0.1); }})
    EXPECT_TRUE(refuses<InputError>(call, {"set_time_step must be called first"}));
  EXPECT_TRUE(refuses<InputError>([&] { body.set_time_step(-1); }, {"dt = -1 s: must lie in [0, inf]"}));
  body.set_time_step(0.1);
  EXPECT_TRUE(refuses<InputError>([&] { body.flow(x, 0.2); }, {"must be the time step", "0.1 s"}));
  body.linearize(x);
  body.set_time_step(0.2);
  PointArray f = PointArray::Zero(x.rows(), 3);
  EXPECT_TRUE(refuses<InputError>([&] { body.add_force(f); }, {"since set_time_step"}));
}

}  // namespace
}  // namespace hexaplast
