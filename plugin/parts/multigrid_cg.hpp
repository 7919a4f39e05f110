// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/solve/conjugate_gradients.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// In scenes: MultigridCGLinearSolver.
struct MultigridCGOptions {
  Preconditioner preconditioner = Preconditioner::kAuto;
  double tolerance = 0.01;  ///< on |r| / |b|
  int iterations = 500;     ///< at most

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(preconditioner);
    HEXAPLAST_OPTION(tolerance);
    HEXAPLAST_OPTION(iterations);
  }
};

/// Preconditioned conjugate gradients that end when the answer is as good as asked for.
class MultigridCG {
 public:
  /// Throws OptionError.
  explicit MultigridCG(const MultigridCGOptions& options);

  const MultigridCGOptions& options() const { return options_; }
  LinearSolver& solver() { return solver_; }

  /// To be told what each solve did. Warns once where multigrid was asked for and not possible, or not definite.
  std::vector<Remark> heed(const SolveReport& report);

 private:
  MultigridCGOptions options_;
  PreconditionedConjugateGradients solver_;
  bool has_cycled_ = false;  // multigrid was possible
  bool is_warned_ = false;
};

}  // namespace hexaplast::parts
