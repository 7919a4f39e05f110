// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>

#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast {

/// Sparse Cholesky factorisation (CHOLMOD) of the assembled system; the symbolic part is reused while the pattern
/// stays. Where that leaves something out, it preconditions conjugate gradients.
class CholeskySolver final : public LinearSolver {
 public:
  CholeskySolver();
  ~CholeskySolver() override;
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;

 private:
  void factorise(const LinearSystem& A);

  struct Factor;
  std::unique_ptr<Factor> factor_;
  BlockMatrix matrix_;
};

}  // namespace hexaplast
