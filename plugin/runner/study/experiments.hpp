// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "runner/study/experiment.hpp"

namespace hexaplast::runner {

/// A column that a fit compares.
struct ComparedColumn {
  const TargetCurve* curve;
  const TargetCurve::Column* column;
  double greatest;              ///< size of its largest value
  std::size_t begin, num_rows;  ///< where its values stand among those of all columns
  std::string name;             ///< with the file of its curve where there are several curves
};

/// Experiments that are to be repeated with the same parameters. Values of all their columns stand one after another.
class Experiments {
 public:
  /// At least one.
  explicit Experiments(std::vector<Experiment> all);
  Experiments(const Experiments&) = delete;
  Experiments& operator=(const Experiments&) = delete;

  /// What runs with these assignments give, of one experiment after the other. Throws as Experiment::run does.
  std::vector<double> run(const std::vector<std::string>& assignments) const;

  /// Differences of such values from the curves, each column's as a fraction of its largest value.
  std::vector<double> residuals(const std::vector<double>& values) const;

  std::span<const Experiment> all() const { return all_; }
  const std::vector<ComparedColumn>& columns() const { return columns_; }
  std::size_t num_values() const { return columns_.back().begin + columns_.back().num_rows; }

 private:
  std::vector<Experiment> all_;
  std::vector<ComparedColumn> columns_;
};

}  // namespace hexaplast::runner
