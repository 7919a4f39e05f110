// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/explicit_integrators.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "solve/newmark.hpp"
#include "support/compare.hpp"

namespace hexaplast {
namespace {

/// Two nodes of masses m0 and m1, each drawn to the origin by k x + c x^3 and braked by b v; they may share a mass. The
/// second one may be prescribed along x = 0.3 t.
struct TwoSprings final : MechanicalSystem {
  double m[2] = {2, 0.5}, k = 30, c = 0, b = 0, shared = 0;
  bool is_prescribed = false;
  int num_evaluations = 0;
  PointArray at = PointArray::Zero(2, 3);

  int num_nodes() const override { return 2; }
  void compute_force(double, ConstPoints x, ConstPoints v, Points f) override {
    ++num_evaluations;
    at = x;
    f = -k * x - c * x.cwiseProduct(x).cwiseProduct(x) - b * v;
  }
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override {
    for (int n = 0; n < 2; ++n)
      df.row(n) += factors.mass * (m[n] * dx.row(n) + shared * dx.row(1 - n)) - factors.damping * b * dx.row(n);
    df -= factors.stiffness * (k * dx + 3 * c * at.cwiseProduct(at).cwiseProduct(dx));
  }
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override {
    for (int n = 0; n < 2; ++n) {
      const Vec3 stiffness = (k + 3 * c * at.row(n).array().square()).matrix().transpose();
      A.add(n, n,
            Mat3((Vec3::Constant(factors.mass * m[n] - factors.damping * b) - factors.stiffness * stiffness)
                     .asDiagonal()));
      A.add(n, 1 - n, factors.mass * shared * Mat3::Identity());
    }
  }
  bool add_mass_diagonal(Points diagonal) const override {
    for (int n = 0; n < 2; ++n) diagonal.row(n).array() += m[n];
    return shared == 0;
  }
  void prescribe(double time, Points x, Points v) const override {
    if (!is_prescribed) return;
    x.row(1) << 0.3 * time, 0, 0;
    v.row(1) << 0.3, 0, 0;
  }
  void project(Points field) const override {
    if (is_prescribed) field.row(1).setZero();
  }
  void pin(BlockMatrix& A) const override {
    for (int axis = 0; is_prescribed && axis < 3; ++axis) A.pin(1, axis);
  }
};

struct Motion {
  PointArray x = (PointArray(2, 3) << 0.4, -0.2, 0.1, 0.3, 0.7, -0.5).finished();
  PointArray v = (PointArray(2, 3) << 1, 0, -2, 0.5, 1, 0).finished();
};

Motion run(ExplicitScheme scheme, TwoSprings& system, double dt, int steps, double rayleigh_mass = 0) {
  Motion motion;
  ExplicitIntegrator integrator(scheme, rayleigh_mass);
  for (int n = 0; n < steps; ++n) integrator.step(system, nullptr, n * dt, dt, motion.x, motion.v);
  return motion;
}

// By hand, for each number of its own.
TEST(ExplicitIntegrator, FollowsTheRecurrenceOfEachScheme) {
  const double h = 0.03, r = 0.7;
  for (const auto& [scheme, advance] : std::vector<std::pair<
           ExplicitScheme, std::function<void(double m, double&x, double&v)>>>{{ExplicitScheme::kEuler,
                                                                                [&](double m, double&x, double&v) {
                                                                                  const double a = -30 * x / m;
                                                                                  x += h * v;
                                                                                  v += h * a;
                                                                                }},
                                                                               {ExplicitScheme::kSymplecticEuler,
                                                                                [&](double m, double&x, double&v) {
                                                                                  v += h * (-30 * x / m);
                                                                                  x += h * v;
                                                                                }},
                                                                               {ExplicitScheme::kMidpoint,
                                                                                [&](double m, double&x, double&v) {
                                                                                  const double middle = x + h / 2 * v;
                                                                                  x += h * (v + h / 2 * (-30 * x / m));
                                                                                  v += h * (-30 * middle / m);
                                                                                }},
                                                                               {ExplicitScheme::kRungeKutta4,
                                                                                [&](double m, double&x, double&v) {
                                                                                  // of a linear system: the Taylor
                                                                                  // series up to h^4
                                                                                  const double w = -30 / m, x0 = x,
                                                                                               v0 = v;
                                                                                  x = x0 *
                                                                                          (1 + h * h * w / 2 +
                                                                                           h * h * h * h * w * w / 24) +
                                                                                      v0 * (h + h * h * h * w / 6);
                                                                                  v = v0 *
                                                                                          (1 + h * h * w / 2 +
                                                                                           h * h * h * h * w * w / 24) +
                                                                                      x0 * w * (h + h * h * h * w / 6);
                                                                                }},
                                                                               {ExplicitScheme::kCentralDifference,
                                                                                [&](double m, double&x, double&v) {
                                                                                  v = ((1 / h - r / 2) * v -
                                                                                       30 * x / m) /
                                                                                      (1 / h + r / 2);
                                                                                  x += h * v;
                                                                                }}}) {
    TwoSprings system;
    const Motion found = run(scheme, system, h, 20, r);
    Motion expected;
    for (int n = 0; n < 2; ++n)
      for (int axis = 0; axis < 3; ++axis)
        for (int step = 0; step < 20; ++step) advance(system.m[n], expected.x(n, axis), expected.v(n, axis));
    EXPECT_LT(support::max_abs(found.x - expected.x), 1e-13) << static_cast<int>(scheme);
    EXPECT_LT(support::max_abs(found.v - expected.v), 1e-12) << static_cast<int>(scheme);
  }
}

// Halving the step of a nonlinear, damped motion divides the error by 2^order.
TEST(ExplicitIntegrator, HasTheOrderOfItsScheme) {
  const auto end = [](ExplicitScheme scheme, int steps) {
    TwoSprings system;
    system.c = 50;
    system.b = 0.4;
    return run(scheme, system, 0.5 / steps, steps).x;
  };
  const PointArray exact = end(ExplicitScheme::kRungeKutta4, 20000);
  for (const auto& [scheme, order] : {std::pair{ExplicitScheme::kEuler, 1},
                                      {ExplicitScheme::kSymplecticEuler, 1},
                                      {ExplicitScheme::kMidpoint, 2},
                                      {ExplicitScheme::kRungeKutta4, 4}}) {
    const double coarse = (end(scheme, 200) - exact).norm(), fine = (end(scheme, 400) - exact).norm();
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.1) << static_cast<int>(scheme);
  }
}

// A vibration of 1 rad/s, a little below and above the limit.
TEST(ExplicitIntegrator, IsStableUpToItsLimit) {
  for (const ExplicitScheme scheme :
       {ExplicitScheme::kSymplecticEuler, ExplicitScheme::kCentralDifference, ExplicitScheme::kRungeKutta4}) {
    TwoSprings system;
    system.k = system.m[0] = system.m[1] = 1;
    const double limit = stable_phase_per_step(scheme);
    EXPECT_LT(run(scheme, system, 0.99 * limit, 400).x.norm(), 100) << static_cast<int>(scheme);
    EXPECT_GT(run(scheme, system, 1.01 * limit, 400).x.norm(), 1e6) << static_cast<int>(scheme);
  }
}

TEST(ExplicitIntegrator, EvaluatesAsOftenAsItsSchemeSays) {
  for (const auto& [scheme, count] : {std::pair{ExplicitScheme::kEuler, 1},
                                      {ExplicitScheme::kSymplecticEuler, 1},
                                      {ExplicitScheme::kCentralDifference, 1},
                                      {ExplicitScheme::kMidpoint, 2},
                                      {ExplicitScheme::kRungeKutta4, 4}}) {
    TwoSprings system;
    run(scheme, system, 0.01, 3);
    EXPECT_EQ(system.num_evaluations, 3 * count);
  }
}

// As in SOFA, constraints lead the node by the beginning of the step in each evaluation; it has no acceleration of its
// own.
TEST(ExplicitIntegrator, LetsConstraintsLeadWithinAStep) {
  TwoSprings system;
  system.is_prescribed = true;
  Motion motion;
  ExplicitIntegrator integrator(ExplicitScheme::kRungeKutta4);
  integrator.step(system, nullptr, 2, 0.1, motion.x, motion.v);
  EXPECT_EQ(system.at(1, 0), 0.3 * 2);
  EXPECT_EQ(motion.v.row(1), Eigen::RowVector3d(0.3, 0, 0));
  EXPECT_NEAR(motion.x(1, 0), 0.6 + 0.03, 1e-15);
}

// M a = f with M = [m0 s; s m1].
TEST(ExplicitIntegrator, SolvesForTheAccelerationWhereMassesCoupleNodes) {
  TwoSprings system;
  system.shared = 0.4;
  Motion motion;
  const Motion before;
  ExplicitIntegrator integrator(ExplicitScheme::kEuler);
  EXPECT_THROW(integrator.step(system, nullptr, 0, 0.1, motion.x, motion.v), InputError);
  EXPECT_EQ(motion.x, before.x);
  CholeskySolver solver;
  integrator.step(system, &solver, 0, 0.1, motion.x, motion.v);
  const double det = 2 * 0.5 - 0.4 * 0.4;
  for (int axis = 0; axis < 3; ++axis) {
    const double f0 = -30 * before.x(0, axis), f1 = -30 * before.x(1, axis);
    EXPECT_NEAR(motion.v(0, axis), before.v(0, axis) + 0.1 * (0.5 * f0 - 0.4 * f1) / det, 1e-12);
    EXPECT_NEAR(motion.v(1, axis), before.v(1, axis) + 0.1 * (2 * f1 - 0.4 * f0) / det, 1e-12);
  }
}

TEST(ExplicitIntegrator, NamesANodeWithoutMass) {
  TwoSprings system;
  system.m[1] = 0;
  Motion motion;
  const Motion before;
  ExplicitIntegrator integrator(ExplicitScheme::kSymplecticEuler);
  try {
    integrator.step(system, nullptr, 0, 0.1, motion.x, motion.v);
    FAIL() << "accepted";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("node 1"), std::string::npos) << error.what();
  }
  EXPECT_EQ(motion.x, before.x);
}

// Newmark's scheme by hand, for each number of its own: with B = -b, K = -k.
TEST(Newmark, FollowsItsRecurrence) {
  const double h = 0.05, rM = 0.3, rK = 0.02, decay = 0.4, gamma = 0.6, beta = 0.3, b = 0.7, k = 30;
  TwoSprings system;
  system.b = b;
  Newmark newmark(
      {.rayleigh_mass = rM, .rayleigh_stiffness = rK, .velocity_damping = decay, .gamma = gamma, .beta = beta});
  CholeskySolver solver;
  Motion found, expected;
  PointArray a(2, 3);
  for (int n = 0; n < 2; ++n) a.row(n) = (-k * expected.x.row(n) - b * expected.v.row(n)) / system.m[n];
  for (int step = 0; step < 20; ++step) {
    newmark.step(system, solver, step * h, h, found.x, found.v);
    for (int n = 0; n < 2; ++n)
      for (int axis = 0; axis < 3; ++axis) {
        double &x = expected.x(n, axis), &v = expected.v(n, axis), &before = a(n, axis);
        const double m = system.m[n],
                     right = -k * x - b * v - h * (1 - gamma) * (rM * m + b + rK * k) * before -
                             h * h * (1 - 2 * beta) / 2 * k * before - rM * m * v - b * v - (rK + h) * k * v,
                     after = right / ((1 + h * gamma * rM) * m + h * gamma * b + (h * h * beta + h * rK * gamma) * k);
        x += h * v + h * h * ((0.5 - beta) * before + beta * after);
        v = (v + h * ((1 - gamma) * before + gamma * after)) * std::exp(-h * decay);
        before = after;
      }
  }
  EXPECT_LT(support::max_abs(found.x - expected.x), 1e-13);
  EXPECT_LT(support::max_abs(found.v - expected.v), 1e-12);
  EXPECT_LT(support::max_abs(newmark.acceleration() - a), 1e-10);
}

// Without damping the mean acceleration keeps the energy of a linear vibration.
TEST(Newmark, KeepsTheEnergyOfAVibration) {
  TwoSprings system;
  Newmark newmark({});
  CholeskySolver solver;
  Motion motion;
  const auto energy = [&] {
    double sum = 15 * motion.x.squaredNorm();
    for (int n = 0; n < 2; ++n) sum += system.m[n] / 2 * motion.v.row(n).squaredNorm();
    return sum;
  };
  const double before = energy();
  for (int step = 0; step < 500; ++step) newmark.step(system, solver, 0, 0.1, motion.x, motion.v);
  EXPECT_NEAR(energy(), before, 1e-10 * before);
}

}  // namespace
}  // namespace hexaplast
