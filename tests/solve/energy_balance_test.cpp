// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/energy_balance.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

constexpr double kDensity = 1000, kYoungModulus = 5000;

/// A block of cubes of kEdge with nu = 0 that moves on in time and keeps its accounts.
struct Measured {
  Body body;
  std::vector<double> mass = lumped_masses(body, kDensity);
  LoadedBody system;
  ImplicitEuler euler;
  double dt;
  CholeskySolver solver = {};
  PointArray x = body.mesh().positions(), v = PointArray::Zero(x.rows(), 3);
  EnergyBalance balance = {};
  double time = 0;

  Measured(std::array<int, 3> cells, Material material, EulerSettings settings, std::vector<int> fixed = {},
           NodalLoad load = {}, double step = kStep)
      : body(block(cells, kEdge), {material}, published_element()),
        system(body, mass, std::move(fixed), std::move(load)),
        euler(settings),
        dt(step) {
    euler.measure_energy();
  }

  double kinetic() const {
    return Eigen::Map<const Eigen::VectorXd>(mass.data(), v.rows()).dot(v.rowwise().squaredNorm()) / 2;
  }
  void begin() { balance.begin(kinetic(), body.energy(x)); }
  void step() {
    euler.step(system, solver, time, dt, x, v);
    time += dt;
    balance.add_step(euler.energy(), kinetic(), body.energy(x), body.recovery_work(x));
    body.flow(x, dt);
    balance.add_flow(body.energy(x));
  }
};

Material elastic() {
  Material material;
  material.young_modulus = kYoungModulus;
  material.poisson_ratio = 0;
  return material;
}

// One hexahedron of mass m: v_n = n h g after n steps, fallen by h^2 g n (n + 1) / 2. What the scheme takes is
// m (h g)^2 / 2 a step.
TEST(EnergyBalance, OfAFallingHexahedronIsTheHandValue) {
  const Vec3 gravity(0, -9.81, 1);
  const double h = kStep, g_squared = gravity.squaredNorm(), m = kDensity * kEdge * kEdge * kEdge;
  Measured hexahedron({1, 1, 1}, elastic(), {}, {},
                      [&](double, ConstPoints, Points f) { f.rowwise() += m / 8 * gravity.transpose(); });
  hexahedron.begin();
  for (int n = 1; n <= 40; ++n) {
    hexahedron.step();
    const double fallen = h * h * n * (n + 1) / 2;  // over g
    ASSERT_NEAR(hexahedron.balance.load_work, m * g_squared * fallen, 1e-10);
    ASSERT_NEAR(hexahedron.balance.numerical_loss, n * m * h * h * g_squared / 2, 1e-10);
    ASSERT_NEAR(hexahedron.balance.kinetic, m * g_squared * n * n * h * h / 2, 1e-10);
  }
  EXPECT_NEAR(hexahedron.balance.damping_loss, 0, 1e-10);
  EXPECT_NEAR(hexahedron.balance.support_work, 0, 1e-10);
  EXPECT_NEAR(hexahedron.balance.error(), 0, 1e-9);
}

// A cube on a fixed face is a spring k = E A / L with the mass m of four nodes. The scalar recursion gives every term.
TEST(EnergyBalance, OfAReleasedSpringIsThatOfTheScalarScheme) {
  const double k = kYoungModulus * kEdge, m = 4 * kDensity * kEdge * kEdge * kEdge / 8, rM = 0.3, rK = 0.02, d = 0.5,
               h = kStep;
  for (const bool first_order : {true, false}) {
    for (const bool trapezoidal : {true, false}) {
      const HexMesh mesh = block({1, 1, 1}, kEdge);
      Measured cube({1, 1, 1}, elastic(),
                    {.rayleigh_mass = rM,
                     .rayleigh_stiffness = rK,
                     .velocity_damping = d,
                     .first_order = first_order,
                     .trapezoidal = trapezoidal},
                    nodes_at(mesh, 2, 0));
      const std::vector<int> top = nodes_at(mesh, 2, kEdge);
      double u = 0.02, v = 0, damped = 0, numerical = 0;
      for (const int n : top) cube.x(n, 2) += u;
      cube.begin();
      EXPECT_NEAR(cube.balance.initial, k * u * u / 2, 1e-12);

      const double a = trapezoidal ? 0.5 : 1, ah = a * h;
      for (int n = 0; n < 60; ++n) {
        cube.step();
        const double v_old = v, u_old = u;
        if (first_order)
          v = -k * u / (m + ah * k);
        else
          v += h * (-k * u - rM * m * v - (ah + rK) * k * v) / ((1 + ah * rM) * m + ah * (ah + rK) * k);
        u += h * v;
        const double v_a = first_order ? v : v_old + a * (v - v_old);
        const double rayleigh = first_order ? h * v * m * v : h * v * (rM * m + rK * k) * v_a;
        const double inertia = first_order ? 0 : m * (v * v - v_old * v_old) / 2;
        damped += rayleigh;
        numerical -= inertia + k * (u * u - u_old * u_old) / 2 + rayleigh;
        if (!first_order) damped += m * v * v * (1 - std::exp(-2 * d * h)) / 2;
        v *= std::exp(-d * h);
        ASSERT_NEAR(cube.balance.damping_loss, damped, 1e-12) << first_order << trapezoidal << " in step " << n;
        ASSERT_NEAR(cube.balance.numerical_loss, numerical, 1e-12) << first_order << trapezoidal << " in step " << n;
        ASSERT_NEAR(cube.balance.elastic, k * u * u / 2, 1e-12);
        for (const int node : top) {
          ASSERT_NEAR(cube.x(node, 2) - kEdge, u, 1e-12);
          ASSERT_NEAR(cube.v(node, 2), v, 1e-11);
        }
      }
      EXPECT_NEAR(cube.balance.load_work, 0, 1e-15);
      EXPECT_NEAR(cube.balance.support_work, 0, 1e-15);
      // the first order scheme has velocities, but no kinetic energy
      const double kinetic = first_order ? cube.balance.kinetic : 0;
      EXPECT_NEAR(cube.balance.error() + kinetic, 0, 1e-12);
    }
  }
}

// The same spring with its upper face prescribed to move at the velocity w: the force at the end of a step times the
// way.
TEST(EnergyBalance, SupportsThatMoveDoTheWorkOfTheirReactions) {
  const double k = kYoungModulus * kEdge, w = 0.05, h = kStep;
  const HexMesh mesh = block({1, 1, 1}, kEdge);
  std::vector<int> fixed = nodes_at(mesh, 2, 0);
  const std::vector<int> top = nodes_at(mesh, 2, kEdge);
  fixed.insert(fixed.end(), top.begin(), top.end());
  Measured cube({1, 1, 1}, elastic(), {}, fixed);
  for (const int n : top) cube.v(n, 2) = w;
  cube.begin();
  double work = 0;
  for (int n = 1; n <= 20; ++n) {
    cube.step();
    work += k * n * h * w * h * w;
    ASSERT_NEAR(cube.balance.support_work, work, 1e-12);
    ASSERT_NEAR(cube.balance.numerical_loss, n * k * h * w * h * w / 2, 1e-12);
  }
  EXPECT_NEAR(cube.balance.error(), 0, 1e-12);
}

/// A bar on one end under its weight, turned out of its rest: it swings far, so that rotations count.
EnergyBalance swung(double dt, Material material) {
  const HexMesh mesh = block({6, 2, 2}, kEdge);
  const double m = kDensity * kEdge * kEdge * kEdge / 8;
  Measured bar(
      {6, 2, 2}, material, {}, nodes_at(mesh, 0, 0),
      [&](double, ConstPoints, Points f) {
        for (const Hexahedron& corners : mesh.hexahedra())
          for (const int n : corners) f(n, 2) -= m * 9.81;
      },
      dt);
  bar.begin();
  for (double time = 0; time < 0.4 - dt / 2; time += dt) bar.step();
  return bar.balance;
}

// What is left over is of second order in the displacement of a step, and there are as many steps as 1 / dt.
TEST(EnergyBalance, ClosesWithTheTimeStep) {
  Material material = elastic();
  material.young_modulus = 40000;
  material.poisson_ratio = 0.3;
  const EnergyBalance coarse = swung(0.01, material), fine = swung(0.0025, material);
  EXPECT_GT(coarse.load_work, 1);
  EXPECT_LT(std::abs(coarse.error()), 0.05 * coarse.load_work);
  EXPECT_LT(std::abs(fine.error()), 0.3 * std::abs(coarse.error()));
  EXPECT_GT(coarse.numerical_loss, 0);
}

// The law of flow says what it dissipates; what the plastic steps took from the elastic energy knows nothing of it.
TEST(EnergyBalance, FlowTakesWhatItDissipates) {
  Material material = yielding(200, 3);
  material.young_modulus = kYoungModulus;
  const HexMesh mesh = block({4, 1, 1}, kEdge);
  const std::vector<int> end = nodes_at(mesh, 0, 4 * kEdge);
  Measured bar(
      {4, 1, 1}, material, {.rayleigh_mass = 2, .rayleigh_stiffness = 0.02}, nodes_at(mesh, 0, 0),
      [&](double time, ConstPoints, Points f) {
        const double pull = 1.5 * std::sin(2 * 3.14159 * time);  // there, back, and beyond
        for (const int n : end) f(n, 0) += pull;
      },
      0.005);
  bar.begin();
  for (int n = 0; n < 200; ++n) bar.step();
  const double dissipated = bar.body.state().history.dissipated_energy;
  EXPECT_GT(dissipated, 0.05 * bar.balance.load_work);
  EXPECT_NEAR(bar.balance.flow_loss, dissipated, 0.05 * dissipated);
  EXPECT_NEAR(bar.balance.error(), 0, 1e-4 * bar.balance.load_work);  // nothing turns
}

TEST(EnergyBalance, MeasuringChangesNoBit) {
  const Material material = yielding(20, 3);
  const HexMesh mesh = block({3, 1, 1}, kEdge);
  const std::vector<int> end = nodes_at(mesh, 0, 3 * kEdge);
  const NodalLoad load = [&](double, ConstPoints, Points f) {
    for (const int n : end) f(n, 0) += 1;
  };
  const Motion motion{.density = kDensity,
                      .dt = kStep,
                      .euler = {.rayleigh_stiffness = 0.01},
                      .fixed = nodes_at(mesh, 0, 0),
                      .load = load};
  MovingBody silent(Body(mesh, {material}, published_element()), motion);
  Measured measured({3, 1, 1}, material, motion.euler, motion.fixed, load);
  for (int n = 0; n < 20; ++n) {
    silent.step();
    measured.step();
  }
  EXPECT_EQ(silent.positions, measured.x);
  EXPECT_EQ(silent.velocities, measured.v);
  EXPECT_EQ(silent.body.state().history.plastic_rest_positions, measured.body.state().history.plastic_rest_positions);
}

}  // namespace
}  // namespace hexaplast
