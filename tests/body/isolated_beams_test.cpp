// SPDX-License-Identifier: LGPL-2.1-or-later
// Beams and plates beyond yield, with isolated rest shapes, against beam theory and an independent program.
#include <gtest/gtest.h>

#include <cmath>

#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/moving_body.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/newton_raphson.hpp"
#include "support/dense.hpp"
#include "support/shapes.hpp"

namespace hexaplast {
namespace {

using support::force_at;

constexpr Settings kIsolatedByKernels{.recovery = RecoveryMode::kNone, .rest_shape = RestShape::kIsolated};

// A strip of 8 x 1 x 6 hexahedra, bent by 1.4 times the load of first yield, comes to rest, and springs back but for
// the part that residual stress holds. Ideal plastic, static.
TEST(IsolatedBeams, ACantileverBeyondYieldComesToRestAndKeepsResidualStress) {
  constexpr double kLength = 0.2, kHeight = 0.02, kWidth = 0.01, kYield = 2350;
  const HexMesh mesh =
      regular_grid({8, 1, 6}, Vec3(0, -kWidth / 2, -kHeight / 2), Vec3(kLength, kWidth / 2, kHeight / 2));
  Body body(mesh, {Material{.young_modulus = 2.1e6, .poisson_ratio = 0, .yield_stress = kYield, .flow_rate = 0.2}},
            kIsolatedByKernels);
  const std::vector<int> end = support::nodes_at(mesh, 0, kLength);
  double load = 1.4004 * kYield * kWidth * kHeight * kHeight / 6 / kLength;  // [N]
  LoadedBody system(body, std::vector<double>(mesh.num_nodes(), 1), support::nodes_at(mesh, 0, 0),
                    [&](double, ConstPoints, Points f) {
                      for (const int n : end) f(n, 2) -= load / static_cast<double>(end.size());
                    });
  CholeskySolver cholesky;
  NewtonRaphson newton({.iterations = 20, .relative_successive = 0, .relative_initial = 0, .absolute_residual = 1e-9});
  PointArray x = mesh.positions();
  const auto rest_after = [&](int steps) {
    for (int step = 0; step < steps; ++step) {
      EXPECT_NE(newton.solve(system, cholesky, 0, x).status, NewtonStatus::kNotConverged);
      body.flow(x, 1);
    }
    newton.solve(system, cholesky, 0, x);
    double sum = 0;
    for (const int n : end) sum -= x(n, 2) - mesh.positions()(n, 2);
    return sum / static_cast<double>(end.size());
  };
  const double bent = rest_after(500), later = rest_after(5);
  EXPECT_NEAR(bent, 2.2115e-3, 0.01 * 2.2115e-3);
  EXPECT_LE(later - bent, 1e-6 * bent) << "creeps, in 1 / nu";
  load = 0;
  EXPECT_NEAR(rest_after(5), 0.1182e-3, 0.01 * 0.1182e-3);
  EXPECT_GT(body.energy(x), 1e-8) << "[J] of residual stress";
}

/// A piece of a strip in pure bending: 1 x 1 x cells hexahedra of height and length 1, whose ends turn against each
/// other. Stress is small beside the modulus.
class BentStrip final : public LoadedBody {
 public:
  static constexpr double kYield = 1, kYoung = 1000, kYieldCurvature = 2 * kYield / kYoung;
  static Body made(int cells, double width, double poisson_ratio) {
    return Body(
        regular_grid({1, 1, cells}, Vec3(-0.5, 0, -0.5), Vec3(0.5, width, 0.5)),
        {Material{.young_modulus = kYoung, .poisson_ratio = poisson_ratio, .yield_stress = kYield, .flow_rate = 1}},
        kIsolatedByKernels);
  }

  /// is_plate: nothing moves along the axis of bending.
  BentStrip(Body& body, bool is_plate) : LoadedBody(body, std::vector<double>(body.mesh().num_nodes(), 1), {}, {}) {
    for (int n = 0; n < num_nodes(); ++n) {
      const Vec3 X = body.mesh().positions().row(n);
      const bool is_in_middle = X.y() < 1e-9;
      held_.push_back({n, 0});
      if (is_plate || is_in_middle) held_.push_back({n, 1});
      if (is_in_middle && X.z() < -0.499) held_.push_back({n, 2});
    }
  }
  void project(Points field) const override {
    for (const auto& [n, axis] : held_) field(n, axis) = 0;
  }
  void pin(BlockMatrix& A) const override {
    for (const auto& [n, axis] : held_) A.pin(n, axis);
  }

  /// Moment in equilibrium at a curvature in terms of that of first yield, after some plastic steps of rate 1 there.
  double moment(Body& body, double curvature, int num_flows) {
    const PointArray& X = body.mesh().positions();
    if (x_.rows() == 0) x_ = X;
    x_.col(0) = X.col(0).array() * (1 + curvature * kYieldCurvature * X.col(2).array());
    for (int k = 0; k <= num_flows; ++k) {
      EXPECT_NE(newton_.solve(*this, cholesky_, 0, x_).status, NewtonStatus::kNotConverged);
      if (k < num_flows) body.flow(x_, 1);
    }
    const PointArray f = force_at(body, x_);
    double sum = 0;
    for (int n = 0; n < num_nodes(); ++n)
      if (X(n, 0) > 0) sum -= f(n, 0) * X(n, 2);
    return sum;
  }

 private:
  std::vector<std::pair<int, int>> held_;  // nodes, axes
  PointArray x_;
  CholeskySolver cholesky_;
  NewtonRaphson newton_{
      {.iterations = 50, .relative_successive = 0, .relative_initial = 0, .absolute_residual = 1e-11}};
};

// Two samples across a plate of one cell would have 2/sqrt(3) times the limit moment; eight that keep their volumes
// lock.
TEST(IsolatedBeams, APlateOneCellThickHasALimitMoment) {
  const double exact = 2 / std::sqrt(3.0) * BentStrip::kYield / 4;
  for (const auto& [cells, band] : {std::pair(1, 0.2), std::pair(4, 0.02)}) {
    Body body = BentStrip::made(cells, 1, 0.45);
    BentStrip strip(body, true);
    double moment = 0;
    for (int step = 1; step <= 100; ++step) moment = strip.moment(body, 0.2 * step, 2);
    EXPECT_LE(moment, (1 + band) * exact) << cells;
    EXPECT_GE(moment, (cells == 1 ? 1.05 : 0.98) * exact) << cells;
  }
}

// An ideal plastic strip that is bent to three times yield and as far back follows the moment of beam theory.
TEST(IsolatedBeams, AStripBentToAndFroFollowsTheLoopOfABeam) {
  constexpr int kCells = 8, kPerYield = 5;
  constexpr double kWidth = 0.05, kYieldMoment = BentStrip::kYield * kWidth / 6;
  Body body = BentStrip::made(kCells, kWidth, 0);
  BentStrip strip(body, false);
  const auto beam = [](double curvature) { return curvature <= 1 ? curvature : 1.5 - 0.5 / (curvature * curvature); };
  double squares = 0;
  for (int step = 1; step <= 9 * kPerYield; ++step) {
    const double curvature = (step <= 3 * kPerYield ? step : 6 * kPerYield - step) / static_cast<double>(kPerYield);
    const double expected = step <= 3 * kPerYield ? beam(curvature) : beam(3) - 2 * beam((3 - curvature) / 2);
    const double error = strip.moment(body, curvature, 4) / kYieldMoment - expected;
    squares += error * error;
  }
  EXPECT_LE(std::sqrt(squares / (9 * kPerYield)), 0.01);
}

}  // namespace
}  // namespace hexaplast
