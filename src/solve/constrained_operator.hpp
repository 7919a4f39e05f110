// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast {

/// m M + b B + k K of a mechanical system with its constraints, as a linear system.
class ConstrainedOperator final : public LinearSystem {
 public:
  ConstrainedOperator(const MechanicalSystem& system, const OperatorFactors& factors, const Constraints& constraints)
      : system_(system), factors_(factors), constraints_(constraints) {}

  int num_nodes() const override { return system_.num_nodes(); }

  void apply(ConstPoints p, Points Ap) const override {
    Ap.setZero();
    system_.add_product(factors_, p, Ap);
    constraints_.project(Ap);
  }

  void assemble(BlockMatrix& A) const override {
    system_.add_blocks(factors_, A);
    constraints_.pin(A);
  }

  bool matrix_free(MatrixFreeSystem& system) const override {
    system.diagonal.setZero(num_nodes(), 3);
    system.constraints = constraints_;
    return system_.add_operator(factors_, system);
  }

 private:
  const MechanicalSystem& system_;
  OperatorFactors factors_;
  const Constraints& constraints_;
};

}  // namespace hexaplast
