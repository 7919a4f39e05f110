// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/experiments.hpp"

#include <fmt/format.h>

#include <utility>

namespace hexaplast::runner {

Experiments::Experiments(std::vector<Experiment> all) : all_(std::move(all)) {
  std::size_t begin = 0;
  for (const Experiment& experiment : all_) {
    const TargetCurve& curve = experiment.target();
    for (std::size_t c = 0; c < curve.columns.size(); ++c) {
      const TargetCurve::Column& column = curve.columns[c];
      columns_.push_back(
          {.curve = &curve,
           .column = &column,
           .greatest = experiment.greatest(c),
           .begin = begin,
           .num_rows = curve.num_rows(),
           .name = all_.size() == 1 ? column.name : fmt::format("{} of {}", column.name, curve.file.string())});
      begin += curve.num_rows();
    }
  }
}

std::vector<double> Experiments::run(const std::vector<std::string>& assignments) const {
  std::vector<double> values;
  for (const Experiment& experiment : all_)
    for (const std::vector<double>& column : experiment.run(assignments))
      values.insert(values.end(), column.begin(), column.end());
  return values;
}

std::vector<double> Experiments::residuals(const std::vector<double>& values) const {
  std::vector<double> residuals;
  for (const ComparedColumn& compared : columns_)
    for (const double wanted : compared.column->values)
      residuals.push_back((values[residuals.size()] - wanted) / compared.greatest);
  return residuals;
}

}  // namespace hexaplast::runner
