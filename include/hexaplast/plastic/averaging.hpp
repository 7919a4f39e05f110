// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/base/linear_system.hpp"
#include "hexaplast/state/history.hpp"

namespace hexaplast {

/// Rest-to-material averaging: the joined positions x that fit the isolated rest shapes y best (theory.md section 5.5).
///
///   E(x) = sum_k min_Pi sum_i |Pi y_i - (x_i - c_k(x))|^2          c_k: mean of the element's corners      (eq. 30)
///
/// One rotation-projected Gauss-Newton step per call: with t_i = Pi y_i for the best rotations at the old x, solve
///
///   (H + 1e-7 P) dx = -g,   H_k = P - B (B^T B)^-1 B^T,   g = assembled x_i - c_k - t_i                    (eq. 31)
///
/// P removes an element's mean, B its infinitesimal rotations of t. Every connected part keeps the mean of its nodes.
struct AveragingReport {
  bool skipped = true;     ///< the rest shapes fitted already
  bool fell_back = false;  ///< Gauss-Newton would have raised E; the local/global step was taken
  int iterations = 0;      ///< of the linear solver
  double residual = 0;     ///< relative residual it left
};

class Averaging {
 public:
  explicit Averaging(const Model& model);

  /// Moves history.material by one step, and fits history.rotation_map before and after.
  AveragingReport step(const Model& model, LinearSolver& solver, History& history);

 private:
  class GaussNewton;
  class LocalGlobal;

  struct Shift {
    Vec3 sum = Vec3::Zero();
    int count = 0;
  };

  double fit(const Model& model, History& history);  // best rotations at the present x; returns E
  void keep_means(const Model& model);               // takes the mean of each connected part out of increment_

  std::vector<ElementPoints> target_;          // t = Pi y, per element
  std::vector<Mat3> inverse_inertia_;          // (B^T B)^-1, per element
  mutable std::vector<ElementPoints> corner_;  // scratch: what an element adds to its nodes
  std::vector<double> misfit_;                 // [m^2] share of E, per element
  std::vector<double> node_weight_;            // number of elements around a node: diagonal of P but for 7/8
  std::vector<Shift> shift_;                   // per connected part
  PointArray gradient_, increment_, before_;   // gradient_ holds -g
};

}  // namespace hexaplast
