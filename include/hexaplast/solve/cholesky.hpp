// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>

#include "hexaplast/base/linear_system.hpp"

namespace hexaplast {

/// Sparse Cholesky factorisation (CHOLMOD) of the assembled system; the symbolic part is reused while the pattern
/// stays.
class CholeskySolver final : public LinearSolver {
 public:
  CholeskySolver();
  ~CholeskySolver() override;
  SolveReport solve(const LinearSystem& A, ConstPoints b, Points x) override;
  void reset() override;

  /// The pattern, which holds what earlier systems coupled too: the order of elimination, and with it the last bits,
  /// comes from it.
  void serialize(Archive& archive) override;

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
  BlockMatrix matrix_;
};

}  // namespace hexaplast
