// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

/// How well measured curves determine parameters, by the noise that is left of them and the slopes of the residuals.
namespace hexaplast::runner {

/// The noise of one curve, from what a fit leaves: a first-order autoregressive process, whose values correlate by
/// `correlation` from row to row.
struct CurveNoise {
  double deviation = 0;    ///< standard deviation, in the unit of the residuals
  double correlation = 0;  ///< in [0, 1)
  double degrees = 0;      ///< of freedom: rows as many as independent ones would tell as much, less parameters
};

/// A combination of parameters that the curves do not determine.
struct Direction {
  std::vector<double> step;  ///< per parameter, of length 1
  double half_width = 0;     ///< of the interval along it; infinite: it has no effect at all
};

struct Confidence {
  std::vector<CurveNoise> noise;   ///< per curve
  std::vector<double> half_width;  ///< of the 95 % interval, per parameter; infinite where it is not determined
  Eigen::MatrixXd correlation;     ///< of the estimates; zeros for those that are not estimated
  std::vector<Direction> undetermined = {};
  bool has_noise = false;  ///< false: there are not more rows than parameters, and nothing is known of the noise
};

/// Of a least-squares fit. slopes, residuals: at the solution, the curves one after another, with `num_rows` rows
/// each.
/// estimated: parameters that the fit has chosen freely; the others are taken to be known. A direction is undetermined
/// where the half-width along it exceeds `too_wide`. Linear in the parameters; curves are independent of one another.
Confidence confidence_of(const Eigen::MatrixXd& slopes, const Eigen::VectorXd& residuals,
                         std::span<const Eigen::Index> num_rows, std::span<const Eigen::Index> estimated,
                         double too_wide);

/// Student's t: the value that is exceeded with the probability (1 - level) / 2. degrees >= 1.
double student_quantile(double level, double degrees);

}  // namespace hexaplast::runner
