// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

/// Least squares over a box, for functions that take a whole simulation to evaluate and have no derivatives.
namespace hexaplast::runner {

/// Parameters, each in [0, 1].
using Point = std::vector<double>;

/// Differences between what is computed and what is wanted, as fractions of what is wanted, at several points at once,
/// which may be found at the same time. None: there is no result at that point.
using Residuals = std::function<std::vector<std::optional<std::vector<double>>>(const std::vector<Point>&)>;

struct Calibration {
  Point best;
  std::vector<double> residuals;  ///< there
  double mean_square = 0;         ///< of these
  int num_evaluations = 0;        ///< points at which residuals were asked for
  int num_failed = 0;             ///< of them: without result
  bool is_converged = false;      ///< false: it ended because of the number of evaluations
};

struct CalibrationOptions {
  int max_evaluations = 200;
  bool looks_around = true;  ///< begins at the best of some points around the start
};

/// The parameters of smallest mean square, by Levenberg and Marquardt's method with differences for slopes, from
/// `start` (which has a result) on. What it asks for does not depend on how many points are evaluated at the same time.
/// `follow` is told the number of evaluations and the smallest root mean square so far. What the residuals throw passes
/// through.
Calibration calibrate(const Residuals& residuals, const Point& start, const CalibrationOptions& options,
                      const std::function<void(int, double)>& follow);

/// The most points that calibrate and slopes_at ask for at once.
int largest_batch(std::size_t num_parameters);

/// Slopes of the residuals (rows) over the parameters (columns) at a point that has `residuals_there`, by differences:
/// from both sides where both lie within the box and have results.
Eigen::MatrixXd slopes_at(const Residuals& residuals, const Point& at, const std::vector<double>& residuals_there);

/// How far a parameter can move before the residuals move by `distance` (root mean square), by their slopes.
struct Uncertainty {
  double alone = 0;     ///< the other parameters staying; infinite where it does not matter
  double together = 0;  ///< the others moving along as they will: not less than `alone`
};

/// Of every parameter.
std::vector<Uncertainty> uncertainties(const Eigen::MatrixXd& slopes, double distance);

}  // namespace hexaplast::runner
