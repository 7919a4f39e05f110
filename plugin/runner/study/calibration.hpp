// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <optional>
#include <vector>

/// Least squares over a box, for functions that take a whole simulation to evaluate and have no derivatives.
namespace hexaplast::runner {

/// Differences between what is computed and what is wanted, as shares of what is wanted; the argument holds parameters
/// in [0, 1]. None: there is no result at these parameters.
using Residuals = std::function<std::optional<std::vector<double>>(const std::vector<double>&)>;

struct Calibration {
  std::vector<double> best;   ///< parameters, in [0, 1]
  double mean_square = 0;     ///< of the residuals there
  int num_evaluations = 0;    ///< of the residuals
  int num_failed = 0;         ///< evaluations without result
  bool is_converged = false;  ///< false: it ended because of the number of evaluations
};

/// The parameters of least mean square, by NLopt, from `start` (which has a result) on. `follow` is told the number of
/// evaluations and the least root mean square so far. What the residuals throw passes through.
Calibration calibrate(const Residuals& residuals, const std::vector<double>& start, int most_evaluations,
                      const std::function<void(int, double)>& follow);

/// How far a parameter can move before the residuals move by `distance` (root mean square), by their slopes.
struct Uncertainty {
  double alone = 0;     ///< the other parameters staying; infinite where it does not matter
  double together = 0;  ///< the others moving along as they will: not less than `alone`
};

/// Of every parameter at `at`; evaluates the residuals once or twice per parameter.
std::vector<Uncertainty> uncertainties(const Residuals& residuals, const std::vector<double>& at, double distance);

}  // namespace hexaplast::runner
