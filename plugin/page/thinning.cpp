// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/thinning.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace hexaplast::output {
namespace {

constexpr long kMaxRows = 1500;      // that are drawn one by one
constexpr long kNumStretches = 400;  // of a longer table: about one per pixel

}  // namespace

Thinning::Thinning(long num_rows, std::size_t num_curves)
    : stride_(num_rows <= kMaxRows ? 1 : (num_rows + kNumStretches - 1) / kNumStretches) {
  kept_.curves.resize(num_curves);
}

void Thinning::add(long step, double time, std::span<const double> values) {
  stretch_.push_back({step, time, {values.begin(), values.end()}});
  latest_ = stretch_.back();
  if (static_cast<long>(stretch_.size()) == stride_) keep_extremes();
}

Series Thinning::take() {
  keep_extremes();
  if (!kept_.steps.empty() && kept_.steps.back() != latest_.step) keep(latest_);  // the axis reaches the end of the run
  return std::move(kept_);
}

void Thinning::keep(const Row& row) {
  kept_.steps.push_back(row.step);
  kept_.x.push_back(row.time);
  for (std::size_t c = 0; c < row.values.size(); ++c) kept_.curves[c].values.push_back(row.values[c]);
}

void Thinning::keep_extremes() {
  if (stretch_.empty()) return;
  std::set<std::size_t> rows{0};
  for (std::size_t c = 0; c < kept_.curves.size(); ++c) {
    const auto of_curve = [&](const Row& row) { return row.values[c]; };
    const auto [min, max] = std::ranges::minmax_element(stretch_, {}, of_curve);
    rows.insert(static_cast<std::size_t>(min - stretch_.begin()));
    rows.insert(static_cast<std::size_t>(max - stretch_.begin()));
  }
  for (const std::size_t row : rows) keep(stretch_[row]);
  stretch_.clear();
}

double percentile(const std::vector<double>& sorted, double rank) {
  if (sorted.empty()) return 0;
  const auto at = static_cast<long>(std::ceil(rank * static_cast<double>(sorted.size()))) - 1;
  return sorted[static_cast<std::size_t>(std::clamp(at, 0L, static_cast<long>(sorted.size()) - 1))];
}

}  // namespace hexaplast::output
