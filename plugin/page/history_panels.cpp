// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/history_panels.hpp"

#include <algorithm>
#include <cmath>

#include "page/thinning.hpp"
#include "record/history_table.hpp"
#include "record/recorder.hpp"

namespace hexaplast::output {
namespace {

/// A curve whose columns are in the file.
struct Source {
  const HistoryCurve* curve;
  std::vector<int> columns;

  double value(std::span<const double> row) const {
    double sum = curve->shift;
    for (const int column : columns) sum += row[static_cast<std::size_t>(column)];
    return curve->scale * sum;
  }
};

std::vector<Source> sources_of(const HistoryPanel& panel, const HistoryTable& table) {
  std::vector<Source> sources;
  for (const HistoryCurve& curve : panel.curves) {
    Source source{&curve, {}};
    for (const std::string& column : curve.columns) source.columns.push_back(table.find(column));
    if (std::ranges::count(source.columns, -1) == 0) sources.push_back(std::move(source));
  }
  return sources;
}

StepTimes step_times_of(std::vector<double> ms) {
  if (ms.empty()) return {};
  std::ranges::sort(ms);
  return {percentile(ms, 0.5), percentile(ms, 0.9), percentile(ms, 0.99), ms.back()};
}

}  // namespace

std::vector<HistoryPanel> history_panels() {
  using namespace colours;
  constexpr std::string_view kCurrent = kFirst, kPlastic = kSecond;
  return {
      {"elongation",
       "%",
       1,
       {{"current", {"current_elongation"}, 100, 0, kCurrent}, {"plastic", {"plastic_elongation"}, 100, 0, kPlastic}}},
      {"twist",
       "°",
       1,
       {{"current", {"current_twist_deg"}, 1, 0, kCurrent}, {"plastic", {"plastic_twist_deg"}, 1, 0, kPlastic}}},
      {"volume error",
       "%",
       0.01,
       {{"current", {"current_volume_ratio"}, 100, -1, kCurrent},
        {"plastic", {"plastic_rest_volume_ratio"}, 100, -1, kPlastic}}},
      {"yielded hexahedra", "", 5, {{"yielded", {"yielded"}}}},
      {"energy",
       "J",
       1e-9,
       {{"elastic", {"elastic_energy"}, 1, 0, kFirst},
        {"dissipated by flow", {"dissipated_energy"}, 1, 0, kSecond},
        {"kinetic", {"kinetic_energy"}, 1, 0, kThird},
        {"sum", {"elastic_energy", "dissipated_energy", "kinetic_energy"}, 1, 0, kFourth}}},
      {"energy balance",
       "J",
       1e-9,
       {{"work", {"load_work", "support_work"}, 1, 0, kFirst},
        {"flow", {"flow_loss"}, 1, 0, kSecond},
        {"in the body", {"elastic_energy", "kinetic_energy"}, 1, 0, kThird},
        {"damping", {"damping_loss"}, 1, 0, kFourth},
        {"integrator", {"numerical_loss"}, 1, 0, kFifth},
        {"recovery and changes", {"recovery_work", "change_work"}, 1, 0, kSixth, true},
        {"unexplained", {"energy_error"}, 1, 0, kRest}}},
      {"displacement of loaded nodes", "mm", 1e-3, {{"mean", {"end_displacement"}, 1000, 0, kFirst}}},
      {"removed hexahedra", "", 5, {{"removed", {"removed"}}}},
      {"opened joints", "", 5, {{"opened", {"opened"}}}},
      {"solver iterations", "", 5, {{"iterations", {"solver_iterations"}, 1, 0, kFirst}}},
      {"time per step", "ms", 1e-3, {{"step", {"step_ms"}, 1, 0, kFirst}}},
  };
}

HistoryPanel panel_of(const ProbeRecord& probe) {
  return {probe.name, probe.unit, 1e-12, {{probe.name, {probe_column(probe.name)}, 1, 0, colours::kFirst}}};
}

bool has_nothing_to_see(const Panel& panel) {
  // nothing is loaded, nothing is torn
  constexpr std::string_view kShownIfNotZero[] = {
      "elongation", "twist", "yielded hexahedra", "displacement of loaded nodes", "removed hexahedra", "opened joints"};
  if (std::ranges::count(kShownIfNotZero, panel.quantity) == 0) return false;
  const double rounding = 1e-9 * panel.min_span;
  return std::ranges::all_of(panel.series, [&](const Series& series) {
    return std::ranges::all_of(series.curves, [&](const Curve& curve) {
      return std::ranges::all_of(curve.values, [&](double value) { return std::abs(value) <= rounding; });
    });
  });
}

HistoryView view_history(const std::filesystem::path& file, std::span<const HistoryPanel> wanted) {
  HistoryView view;
  view.num_rows = count_rows(file);
  HistoryTable table(file);

  std::vector<std::vector<Source>> sources;
  std::vector<Thinning> thinned;
  for (const HistoryPanel& panel : wanted) {
    sources.push_back(sources_of(panel, table));
    thinned.emplace_back(view.num_rows, sources.back().size());
  }
  const int step_ms = table.find("step_ms");
  std::vector<double> ms, values;
  for (std::span<const double> row = table.next(); !row.empty(); row = table.next()) {
    for (std::size_t p = 0; p < sources.size(); ++p) {
      values.clear();
      for (const Source& source : sources[p]) values.push_back(source.value(row));
      if (std::ranges::all_of(values, [](double value) { return std::isfinite(value); }))
        thinned[p].add(static_cast<long>(row[HistoryTable::kStep]), row[HistoryTable::kTime], values);
    }
    if (step_ms >= 0 && row[HistoryTable::kStep] > 0) ms.push_back(row[static_cast<std::size_t>(step_ms)]);
  }
  view.step_times = step_times_of(std::move(ms));

  for (std::size_t p = 0; p < wanted.size(); ++p) {
    Series series = thinned[p].take();
    std::vector<Curve> shown;
    for (std::size_t c = 0; c < sources[p].size(); ++c) {
      const HistoryCurve& curve = *sources[p][c].curve;
      if (curve.unless_zero && std::ranges::all_of(series.curves[c].values, [](double value) { return value == 0; }))
        continue;
      shown.push_back(std::move(series.curves[c]));
      shown.back().name = curve.name;
      shown.back().colour = curve.colour;
    }
    if (shown.empty() || series.steps.empty()) continue;
    series.curves = std::move(shown);
    view.panels.push_back({.quantity = wanted[p].quantity,
                           .unit = wanted[p].unit,
                           .min_span = wanted[p].min_span,
                           .series = {std::move(series)}});
  }
  return view;
}

}  // namespace hexaplast::output
