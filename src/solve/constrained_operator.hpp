// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast {

/// m M + b B + k K of a mechanical system with its constraints, as a linear system. `unsupported`: nodes on which it
/// does not act; the assembled matrix holds them, so that it is not singular.
class ConstrainedOperator final : public LinearSystem {
 public:
  ConstrainedOperator(const MechanicalSystem& system, const OperatorFactors& factors,
                      std::span<const int> unsupported = {})
      : system_(system), factors_(factors), unsupported_(unsupported) {}

  int num_nodes() const override { return system_.num_nodes(); }

  void apply(ConstPoints p, Points Ap) const override {
    Ap.setZero();
    system_.add_product(factors_, p, Ap);
    system_.project(Ap);
  }

  void assemble(BlockMatrix& A) const override {
    system_.add_blocks(factors_, A);
    system_.pin(A);
    for (const int n : unsupported_)
      for (int axis = 0; axis < 3; ++axis) A.pin(n, axis);
  }

  bool describe(MatrixFreeSystem& system) const override {
    system.diagonal.setZero(num_nodes(), 3);
    if (!system_.describe(factors_, system)) return false;
    system.find_free(num_nodes(), [&](Points field) { system_.project(field); });
    return true;
  }

  void project(Points field) const override { system_.project(field); }

 private:
  const MechanicalSystem& system_;
  OperatorFactors factors_;
  std::span<const int> unsupported_;
};

}  // namespace hexaplast
