// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "record/files.hpp"
#include "runner/study/calibration.hpp"
#include "runner/study/confidence.hpp"
#include "runner/study/experiments.hpp"
#include "runner/study/fit.hpp"
#include "runner/study/free_attribute.hpp"

namespace hexaplast::runner {

/// What has been found of a free attribute.
struct Found {
  FreeAttribute free;
  double value = 0;
  Uncertainty uncertainty = {};  ///< by the slopes of the curve, in fractions of the way between the limits
  double half_width = 0;         ///< of the 95 % interval, in the same; infinite: none

  bool is_at_limit() const;
  bool has_interval() const;  ///< of 95 %

  /// The value at a distance, in fractions of the way between the limits, not beyond them.
  double moved(double distance) const;
};

/// What a fit has found out.
struct FitResult {
  std::vector<Found> found;
  Calibration calibration;
  Confidence confidence;         ///< noise in the unit of its curve
  std::vector<double> start;     ///< values of the curves, column after column, at the first values
  std::vector<double> fitted;    ///< at the best ones
  std::vector<double> rms = {};  ///< of the differences that remain, per column, in its unit
  double relative_rms = 0;       ///< of all, as fractions of the largest value of each column
};

/// By how much the residuals change, as a fraction of the largest value, for a value to be told from another.
constexpr double kCloseness = 0.01;
/// Of the way between the limits: a value that may move so far is not determined.
constexpr double kHardlyKnown = 0.5;

/// Whether a fraction of the way between the limits counts as one of them.
bool is_limit(double fraction);

std::vector<std::string> warnings_of(const FitResult& result, const Experiments& experiments, int max_evaluations);

void print(const FitResult& result, const Experiments& experiments);

/// scene_hashes: of the scene of each experiment.
void write_json(output::WholeFile& out, const FitResult& result, const Experiments& experiments,
                const std::vector<std::string>& scene_hashes, const std::vector<std::string>& warnings);

/// The curves, the fitted runs and the runs before the fit.
void draw(output::WholeFile& file, const FitResult& result, const Experiments& experiments);

}  // namespace hexaplast::runner
