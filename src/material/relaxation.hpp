// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/material/material.hpp"

namespace hexaplast {

/// How a viscoelastic branch takes a step of h. Its stress is q = 2 g mu b, with the strain b = decay b + response D
/// after a step in which the deviator of the stretch changes by D at a constant rate.          theory.md section 5.10
struct BranchStep {
  double modulus;   ///< [-] g
  double decay;     ///< e^(-h/t)
  double response;  ///< z = (1 - e^(-h/t)) t/h                                                               eq. P13

  /// What the branch dissipates within the step, over g mu: held |b|^2 + mixed b : D + moved |D|^2.          eq. P19
  double loss_held, loss_mixed, loss_moved;
};

/// Of each branch. h [s] >= 0; infinite: equilibrium, in which branches hold nothing.
std::vector<BranchStep> branch_steps(const Settings& settings, double h);

}  // namespace hexaplast
