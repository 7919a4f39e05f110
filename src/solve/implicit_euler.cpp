// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/implicit_euler.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

namespace {

/// m M + b B + k K of a mechanical system with its constraints, as a linear system.
class ConstrainedOperator final : public LinearSystem {
 public:
  ConstrainedOperator(const MechanicalSystem& system, const OperatorFactors& factors)
      : system_(system), factors_(factors) {}

  int num_nodes() const override { return system_.num_nodes(); }

  void apply(ConstPoints p, Points Ap) const override {
    Ap.setZero();
    system_.add_product(factors_, p, Ap);
    system_.project(Ap);
  }

  void assemble(BlockMatrix& A) const override {
    system_.add_blocks(factors_, A);
    system_.pin(A);
  }

 private:
  const MechanicalSystem& system_;
  OperatorFactors factors_;
};

void require_finite(ConstPoints field, const char* what) {
  for (int n = 0; n < field.rows(); ++n)
    if (!field.row(n).allFinite())
      throw NumericalError(fmt::format("the {} of node {} left the finite numbers in this step", what, n));
}

}  // namespace

SolveReport ImplicitEuler::step(MechanicalSystem& system, LinearSolver& solver, double time, double dt, Points x,
                                Points v) {
  const double h = dt, rM = settings_.rayleigh_mass, rK = settings_.rayleigh_stiffness;
  right_hand_side_.resize(x.rows(), 3);
  increment_.resize(x.rows(), 3);

  // b = h [ f - rM M v + (h + rK) K v ]                                                                       eq. 41
  system.compute_force(time, x, v, right_hand_side_);
  system.add_product({.mass = -rM, .damping = 0, .stiffness = h + rK}, v, right_hand_side_);
  right_hand_side_ *= h;
  system.project(right_hand_side_);
  require_finite(right_hand_side_, "force");  // before the solver, which would spread it over all nodes

  // A = (1 + h rM) M - h B - h (h + rK) K                                                                     eq. 40
  const ConstrainedOperator A(system, {.mass = 1 + h * rM, .damping = -h, .stiffness = -h * (h + rK)});
  const SolveReport report = solver.solve(A, right_hand_side_, increment_);

  increment_ += v;  // the new velocity                                                                        eq. 42
  require_finite(increment_, "velocity");
  v = increment_;
  x += h * v;
  return report;
}

}  // namespace hexaplast
