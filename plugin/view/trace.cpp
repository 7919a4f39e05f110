// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/trace.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include "page/thinning.hpp"
#include "record/history_table.hpp"
#include "record/recorder.hpp"

namespace hexaplast::view {

void Trace::add(double at, double value) {
  points_.push_back({at, value});
  while (points_.front().at < at - span_) points_.pop_front();
}

void Trace::forget_after(double at) {
  while (!points_.empty() && points_.back().at > at) points_.pop_back();
}

double Trace::at(double abscissa) const {
  const auto after = std::ranges::upper_bound(points_, abscissa, {}, &Point::at);
  return after == points_.begin() ? points_.front().value : std::prev(after)->value;
}

void Trace::extend_range(double begin, double& min, double& max) const {
  for_each_since(begin, [&](double, double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  });
}

double Trace::quantile(double fraction) const {
  std::vector<double> values;
  for (const Point& point : points_) values.push_back(point.value);
  std::ranges::sort(values);
  return output::percentile(values, fraction);
}

Traces::Traces(double span, double num_steps)
    : current_elongation(span),
      plastic_elongation(span),
      plastic_strain(span),
      current_volume(span),
      plastic_rest_volume(span),
      kinetic(span),
      elastic(span),
      dissipated(span),
      step_ms(num_steps),
      span_(span) {}

Traces traces_of(const std::filesystem::path& directory, const std::vector<output::ProbeRecord>& probes) {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  Traces traces(kAll, kAll);
  traces.probes.resize(probes.size(), Trace(kAll));
  const std::filesystem::path file = directory / "history.csv";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return traces;
  output::HistoryTable table(file);
  struct Column {
    const char* name;
    Trace* trace;
    double scale, shift;
  };
  std::vector<std::pair<int, Column>> columns;
  for (const Column& column :
       {Column{"current_elongation", &traces.current_elongation, 100, 0},
        Column{"plastic_elongation", &traces.plastic_elongation, 100, 0},
        Column{"current_volume_ratio", &traces.current_volume, 100, -1},
        Column{"plastic_rest_volume_ratio", &traces.plastic_rest_volume, 100, -1},
        Column{"kinetic_energy", &traces.kinetic, 1, 0}, Column{"elastic_energy", &traces.elastic, 1, 0},
        Column{"dissipated_energy", &traces.dissipated, 1, 0}})
    if (const int number = table.find(column.name); number >= 0) columns.emplace_back(number, column);
  for (std::size_t p = 0; p < probes.size(); ++p)
    if (const int number = table.find(output::probe_column(probes[p].name)); number >= 0)
      columns.emplace_back(number, Column{nullptr, &traces.probes[p], 1, 0});
  const int step_ms = table.find("step_ms");
  for (std::span<const double> row = table.next(); !row.empty(); row = table.next()) {
    const auto at = [&](int column) { return row[static_cast<std::size_t>(column)]; };
    for (const auto& [number, column] : columns)
      if (std::isfinite(at(number)))
        column.trace->add(at(output::HistoryTable::kTime), column.scale * (at(number) + column.shift));
    if (step_ms >= 0 && at(output::HistoryTable::kStep) > 0)
      traces.step_ms.add(at(output::HistoryTable::kStep), at(step_ms));
  }
  return traces;
}

void Traces::add(const Snapshot& snapshot) {
  const Sample& sample = snapshot.sample;
  if (!plastic_strain.empty() && sample.time < plastic_strain.latest_time()) {  // it went back
    for (Trace* trace : {&current_elongation, &plastic_elongation, &plastic_strain, &current_volume,
                         &plastic_rest_volume, &kinetic, &elastic, &dissipated})
      trace->forget_after(sample.time);
    for (Trace& trace : probes) trace.forget_after(sample.time);
    step_ms.forget_after(static_cast<double>(snapshot.step) - static_cast<double>(snapshot.step_ms.size()));
  }
  const double time = sample.time;
  current_elongation.add(time, 100 * sample.measures.current_elongation);
  plastic_strain.add(time, sample.greatest_plastic_strain);
  current_volume.add(time, 100 * (sample.measures.current_volume_ratio - 1));
  plastic_rest_volume.add(time, 100 * (sample.measures.plastic_rest_volume_ratio - 1));
  if (std::isfinite(sample.measures.plastic_elongation))  // it was found
    plastic_elongation.add(time, 100 * sample.measures.plastic_elongation);
  kinetic.add(time, sample.kinetic_energy);
  elastic.add(time, sample.elastic_energy);
  dissipated.add(time, sample.dissipated_energy);
  if (probes.size() < sample.probes.size()) probes.resize(sample.probes.size(), Trace(span_));
  for (std::size_t p = 0; p < sample.probes.size(); ++p) probes[p].add(time, sample.probes[p]);
  const auto first = snapshot.step - static_cast<long>(snapshot.step_ms.size());
  for (std::size_t k = 0; k < snapshot.step_ms.size(); ++k)
    step_ms.add(static_cast<double>(first) + static_cast<double>(k + 1), snapshot.step_ms[k]);
}

}  // namespace hexaplast::view
