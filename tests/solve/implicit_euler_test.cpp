// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/implicit_euler.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

std::unique_ptr<LinearSolver> exact_conjugate_gradients() {
  return std::make_unique<ConjugateGradients>(
      ConjugateGradientSettings{.iterations = 1000, .tolerance = 1e-14, .threshold = 0});
}

/// A unit mass on a spring.
class Oscillator final : public MechanicalSystem {
 public:
  explicit Oscillator(double frequency) : stiffness_(frequency * frequency) {}
  int num_nodes() const override { return 1; }
  void compute_force(double, ConstPoints x, ConstPoints, Points f) override { f = -stiffness_ * x; }
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override {
    df += (factors.mass - factors.stiffness * stiffness_) * dx;
  }
  void add_blocks(const OperatorFactors&, BlockMatrix&) const override {}

 private:
  double stiffness_;
};

/// Size of a vibration that begins with 1, after so many steps, or when it is a hundred; `phase` is its angular
/// frequency times dt.
double size_after(int num_steps, const EulerSettings& settings, double phase) {
  Oscillator system(phase / kStep);
  ImplicitEuler euler(settings);
  const std::unique_ptr<LinearSolver> solver = exact_conjugate_gradients();
  PointArray x = PointArray::Constant(1, 3, 1), v = PointArray::Zero(1, 3);
  double size = 1;
  for (int k = 0; k < num_steps && size < 100; ++k) {
    euler.step(system, *solver, 0, kStep, x, v);
    size = std::hypot(x(0, 0), v(0, 0) / (phase / kStep));
  }
  return size;
}

// 2 whatever Rayleigh's damping is; only a decay of velocities moves the limit.
TEST(ImplicitEuler, TheTrapezoidalSchemeIsStableBelowItsLimitAndNotAbove) {
  for (const double rM : {0.0, 3.0, 40.0})
    for (const double rK : {0.0, 0.004, 0.1}) {
      EXPECT_DOUBLE_EQ(
          stable_phase_per_step({.rayleigh_mass = rM, .rayleigh_stiffness = rK, .trapezoidal = true}, kStep), 2);
      for (const double decay : {0.0, 5.0, 60.0}) {
        const EulerSettings settings{
            .rayleigh_mass = rM, .rayleigh_stiffness = rK, .velocity_damping = decay, .trapezoidal = true};
        const double limit = stable_phase_per_step(settings, kStep);
        const auto what = testing::Message() << "rayleigh " << rM << " " << rK << ", decay " << decay << ": " << limit;
        if (std::isfinite(limit)) {
          EXPECT_GE(size_after(20000, settings, 1.02 * limit), 100) << what;
          EXPECT_LT(size_after(1000, settings, 0.98 * limit), 0.5) << what;
        } else {
          EXPECT_LT(size_after(1000, settings, 100), 0.5) << what;
        }
      }
    }
  for (const EulerSettings& settings : {EulerSettings{}, EulerSettings{.first_order = true, .trapezoidal = true}}) {
    EXPECT_EQ(stable_phase_per_step(settings, kStep), std::numeric_limits<double>::infinity());
    EXPECT_LE(size_after(1000, settings, 100), 1.001);
  }
}

// Undamped, a step multiplies the size by 1 - z / 4 where implicit Euler has 1 - z / 2, z = (h omega)^2.
TEST(ImplicitEuler, TheTrapezoidalSchemeHasHalfTheNumericalDamping) {
  const double phase = 0.05, z = phase * phase;
  EXPECT_NEAR(std::log(size_after(1000, {.trapezoidal = true}, phase)), -1000 * z / 4, 0.03 * 1000 * z / 4);
  EXPECT_NEAR(std::log(size_after(1000, {}, phase)), -1000 * z / 2, 0.03 * 1000 * z / 2);
}

TEST(ImplicitEuler, NamesTheNodeThatLeavesTheFiniteNumbersAndKeepsTheState) {
  Motion setup;
  bool spoiled = false;
  setup.load = [&](double, ConstPoints, Points f) {
    if (spoiled) f(5, 1) = std::numeric_limits<double>::quiet_NaN();
  };
  // fixing all but node 5 keeps the trouble at its place
  setup.fixed = {0, 1, 2, 3, 4, 6, 7};
  MovingBody body(Body(block({1, 1, 1}, 0.1), {Material{}}), std::move(setup), exact_conjugate_gradients());
  body.run(2);
  const PointArray x = body.positions, v = body.velocities;
  spoiled = true;
  EXPECT_TRUE(refuses<NumericalError>([&] { body.step(); }, {"node 5"}));
  EXPECT_EQ(body.positions, x);
  EXPECT_EQ(body.velocities, v);
}

}  // namespace
}  // namespace hexaplast
