// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

#include "hexaplast/base/error.hpp"
#include "page/history_panels.hpp"
#include "page/html.hpp"
#include "record/files.hpp"
#include "record/history_table.hpp"
#include "record/recorded_run.hpp"
#include "record/recorder.hpp"
#include "record/viewer_states.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

constexpr double kSameTime = 1e-9;  // of the greater of both times; running sums of dt differ by less

bool is_same_time(double a, double b) { return std::abs(a - b) <= kSameTime * std::max(std::abs(a), std::abs(b)); }

std::string number(double value) { return fmt::format("{:.6g}", value); }

/// A column that both histories have.
struct CommonColumn {
  std::size_t in_a, in_b;
};

/// |a - b|, also where numbers are infinite: 0 where they are equal.
double difference_of(double a, double b) {
  if (a == b) return 0;
  const double difference = std::abs(a - b);
  return std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
}

// The run itself
// ---------------------------------------------------------------------------------------------------------------------

struct Run {
  fs::path directory;
  std::optional<Manifest> manifest;
};

Run run_in(const fs::path& directory) {
  std::error_code error;
  if (!fs::is_directory(directory, error))
    throw OutputError(fmt::format("{}: is no directory of a run", directory.string()));
  if (!fs::is_regular_file(directory / "history.csv", error))
    throw OutputError(fmt::format("{}: is no directory of a run: holds no history.csv", directory.string()));
  return {directory, read_manifest(directory)};
}

ComparisonTable table_of_runs(const Run& a, const Run& b, const StepTimes& times_a, const StepTimes& times_b) {
  ComparisonTable table{"Runs", {"", "A", "B"}, {{"directory", a.directory.string(), b.directory.string()}}};
  const auto add = [&](const char* label, auto&& of) {
    table.rows.push_back({label, a.manifest ? of(*a.manifest) : "unknown", b.manifest ? of(*b.manifest) : "unknown"});
  };
  add("scene", [](const Manifest& run) { return run.scene_file; });
  add("scene XXH64", [](const Manifest& run) { return run.scene_hash; });
  add("version", [](const Manifest& run) { return run.version; });
  add("state", [](const Manifest& run) { return fmt::format("{}, {} steps", describe(run.state), run.steps_done); });
  add("time step", [](const Manifest& run) { return fmt::format("{:.6g} s", run.dt); });
  add("solvers", [](const Manifest& run) { return fmt::format("{}, {}", run.motion_solver, run.linear_solver); });
  add("precision", [](const Manifest& run) { return run.precision; });
  add("threads", [](const Manifest& run) { return fmt::format("{}", run.threads); });
  add("instruction set", [](const Manifest& run) { return run.simd; });
  add("state hash", [](const Manifest& run) { return run.state_hash.empty() ? "none" : run.state_hash; });
  const auto words = [](const StepTimes& times) {
    return fmt::format("{:.4g} / {:.4g} / {:.4g} ms", times.p50, times.p90, times.p99);
  };
  table.rows.push_back({"step, p50 / p90 / p99", words(times_a), words(times_b)});
  if (a.manifest && b.manifest && !a.manifest->state_hash.empty() && a.manifest->state_hash == b.manifest->state_hash)
    table.note = "Both end in the same state, bit for bit.";
  return table;
}

/// Attributes by "/path.attribute"; a component itself by "/path", its class.
std::map<std::string, std::string> attributes_of(const Manifest& run) {
  std::map<std::string, std::string> all;
  for (const ComponentRecord& component : run.components) {
    all.emplace(component.path, component.class_name);
    for (const AttributeRecord& attribute : component.attributes)
      all.emplace(fmt::format("{}.{}", component.path, attribute.name), attribute.value);
  }
  return all;
}

ComparisonTable table_of_scenes(const Manifest& a, const Manifest& b) {
  const std::map in_a = attributes_of(a), in_b = attributes_of(b);
  std::map<std::string, std::pair<std::string, std::string>> both;
  for (const auto& [name, value] : in_a) both[name].first = value;
  for (const auto& [name, value] : in_b) both[name].second = value;
  ComparisonTable table{"Where the scenes differ", {"", "A", "B"}, {}};
  for (const auto& [name, values] : both)
    if (values.first != values.second) {
      const bool is_component = name.find('.') == name.npos;
      const std::string absent = is_component ? "none" : "default";
      table.rows.push_back(
          {name, in_a.contains(name) ? values.first : absent, in_b.contains(name) ? values.second : absent});
    }
  if (table.rows.empty())
    table.note = a.scene_hash == b.scene_hash ? "Nowhere." : "In attributes that are given their default values.";
  return table;
}

// History
// ---------------------------------------------------------------------------------------------------------------------

ComparisonTable table_of_histories(const HistoryComparison& found) {
  ComparisonTable table{"Largest differences of history.csv",
                        {"column", "difference", "relative", "step of A", "time [s]", "A", "B"},
                        {}};
  for (const ColumnDifference& column : found.columns) {
    const double relative = column.largest > 0 ? column.difference / column.largest : 0;
    table.rows.push_back({column.column, number(column.difference), fmt::format("{:.2e}", relative),
                          fmt::format("{}", column.step), number(column.time), number(column.a), number(column.b)});
  }
  std::stable_partition(table.rows.begin(), table.rows.end(),
                        [](const auto& row) { return row[0].starts_with("probe_"); });
  table.note = fmt::format("{} rows at common times, of {} and {}. Relative to the largest magnitude in the column.",
                           found.num_common, found.num_rows_a, found.num_rows_b);
  return table;
}

// States
// ---------------------------------------------------------------------------------------------------------------------

/// The last two states of equal time; every run has the one at its beginning.
std::pair<RecordedRun::Entry, RecordedRun::Entry> last_common(const RecordedRun& a, const RecordedRun& b) {
  for (auto of_a = a.entries().rbegin(); of_a != a.entries().rend(); ++of_a)
    for (auto of_b = b.entries().rbegin(); of_b != b.entries().rend(); ++of_b)
      if (is_same_time(of_a->time, of_b->time)) return {*of_a, *of_b};
  throw InputError(fmt::format("{} and {}: their mesh.pvd name no states of equal time", a.name(), b.name()));
}

ComparisonTable table_of_states(const fs::path& directory_a, const fs::path& directory_b) {
  RecordedRun a(directory_a), b(directory_b);
  if (a.mesh().hexahedra() != b.mesh().hexahedra())
    throw InputError(
        fmt::format("{} has {} nodes and {} hexahedra, {} has {} nodes and {}: runs of the same hexahedra "
                    "can be compared",
                    directory_a.string(), a.mesh().num_nodes(), a.mesh().num_elements(), directory_b.string(),
                    b.mesh().num_nodes(), b.mesh().num_elements()));
  const auto [entry_a, entry_b] = last_common(a, b);
  const RecordedRun::State state_a = a.state(entry_a, Quantity::kPlasticStrain),
                           state_b = b.state(entry_b, Quantity::kPlasticStrain);

  ComparisonTable table{fmt::format("Largest differences of the states at {} s", number(entry_a.time)),
                        {"", "difference", "where", "A", "B"},
                        {}};
  const auto place = [](const PointArray& points, Eigen::Index row) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", points(row, 0), points(row, 1), points(row, 2));
  };
  // by the corners of hexahedra: each run may have copies of nodes of its own
  const auto add_points = [&](const char* label, const PointArray& in_a, const PointArray& in_b) {
    std::pair<int, int> nodes;
    double farthest = -1;
    for (std::size_t e = 0; e < a.mesh().hexahedra().size(); ++e)
      for (int c = 0; c < kCorners; ++c) {
        const int of_a = a.mesh().hexahedra()[e][c], of_b = b.mesh().hexahedra()[e][c];
        const double here = (in_a.row(of_a) - in_b.row(of_b)).matrix().norm();
        if (!(here > farthest)) continue;
        farthest = here;
        nodes = {of_a, of_b};
      }
    table.rows.push_back({label, fmt::format("{:.6g} m", farthest), fmt::format("node {}", nodes.first),
                          place(in_a, nodes.first), place(in_b, nodes.second)});
  };
  add_points("positions", state_a.positions, state_b.positions);
  add_points("plastic rest positions", state_a.plastic_rest, state_b.plastic_rest);

  std::size_t farthest = 0, num_in_one = 0;
  double difference = -1;
  for (std::size_t e = 0; e < state_a.values.size(); ++e) {
    num_in_one += state_a.alive[e] != state_b.alive[e];
    const double here = std::abs(state_a.values[e] - state_b.values[e]);
    if (state_a.alive[e] && state_b.alive[e] && here > difference) {
      difference = here;
      farthest = e;
    }
  }
  if (difference >= 0)
    table.rows.push_back({"plastic strain", number(difference), fmt::format("hexahedron {}", farthest),
                          number(state_a.values[farthest]), number(state_b.values[farthest])});
  if (num_in_one > 0) table.note = fmt::format("{} hexahedra are left in one of the states alone.", num_in_one);
  return table;
}

// Curves
// ---------------------------------------------------------------------------------------------------------------------

/// A panel per curve, so that two runs are told apart by colour.
std::vector<HistoryPanel> single_curves() {
  std::vector<HistoryPanel> panels;
  for (const HistoryPanel& panel : history_panels())
    for (HistoryCurve curve : panel.curves) {
      curve.unless_zero = false;  // the other run may have it
      panels.push_back({panel.quantity, panel.unit, panel.min_span, {std::move(curve)}});
    }
  return panels;
}

/// What a panel of single_curves() is called.
std::string name_of(const Panel& panel) {
  const std::string& curve = panel.series.front().curves.front().name;
  if (curve == panel.quantity) return curve;  // a probe
  static constexpr std::string_view kSaidByThePanel[] = {"yielded", "removed", "iterations", "step", "mean"};
  return std::ranges::count(kSaidByThePanel, curve) > 0 ? panel.quantity : panel.quantity + ", " + curve;
}

Series series_of(const Panel& panel, const char* run, std::string_view colour, const char* dashes) {
  Series series = panel.series.front();
  series.name = run;
  series.curves.front().name.clear();
  series.curves.front().colour = colour;
  series.curves.front().dashes = dashes;
  return series;
}

bool is_zero(const Series& series) {
  return std::ranges::all_of(series.curves.front().values, [](double value) { return value == 0; });
}

}  // namespace

HistoryComparison compare_histories(const fs::path& a, const fs::path& b) {
  HistoryTable of_a(a), of_b(b);
  HistoryComparison found{.num_rows_a = count_rows(a), .num_rows_b = count_rows(b)};
  std::vector<CommonColumn> columns;
  for (std::size_t c = 0; c < of_a.columns().size(); ++c) {
    const int other = of_b.find(of_a.columns()[c]);
    if (c == HistoryTable::kStep || c == HistoryTable::kTime || other < 0) continue;
    columns.push_back({c, static_cast<std::size_t>(other)});
    found.columns.push_back({.column = of_a.columns()[c], .difference = -1});
  }

  std::span<const double> row_a = of_a.next(), row_b = of_b.next();
  while (!row_a.empty() && !row_b.empty()) {
    const double time_a = row_a[HistoryTable::kTime], time_b = row_b[HistoryTable::kTime];
    if (is_same_time(time_a, time_b)) {
      ++found.num_common;
      for (std::size_t c = 0; c < columns.size(); ++c) {
        ColumnDifference& column = found.columns[c];
        const double value_a = row_a[columns[c].in_a], value_b = row_b[columns[c].in_b];
        const double difference = difference_of(value_a, value_b);
        column.largest = std::max({column.largest, std::abs(value_a), std::abs(value_b)});
        if (difference <= column.difference) continue;
        column.difference = difference;
        column.step = static_cast<long>(row_a[HistoryTable::kStep]);
        column.time = time_a;
        column.a = value_a;
        column.b = value_b;
      }
      row_a = of_a.next();
      row_b = of_b.next();
    } else if (time_a < time_b) {
      row_a = of_a.next();
    } else {
      row_b = of_b.next();
    }
  }
  if (found.num_common == 0) found.columns.clear();
  return found;
}

std::vector<ComparisonTable> compare_runs(const fs::path& a, const fs::path& b) {
  const Run run_a = run_in(a), run_b = run_in(b);
  std::vector<ComparisonTable> tables;
  tables.push_back(table_of_runs(run_a, run_b, view_history(a / "history.csv", {}).step_times,
                                 view_history(b / "history.csv", {}).step_times));
  if (run_a.manifest && run_b.manifest) tables.push_back(table_of_scenes(*run_a.manifest, *run_b.manifest));
  tables.push_back(table_of_states(a, b));
  tables.push_back(table_of_histories(compare_histories(a / "history.csv", b / "history.csv")));
  return tables;
}

std::string comparison_page(const fs::path& a, const fs::path& b, const std::vector<ComparisonTable>& tables) {
  HtmlPage page(fmt::format("{} and {}", a.string(), b.string()));
  const std::optional<ViewerData> of_a = read_viewer_data(a), of_b = read_viewer_data(b);
  if (of_a && of_b && of_a->has_states && of_b->has_states) page.viewer({of_a->markup, of_b->markup});
  for (const ComparisonTable& table : tables) {
    page.heading(table.title);
    if (!table.rows.empty()) page.table(table.columns, table.rows, "wide");
    if (!table.note.empty()) page.paragraph(table.note, "lead");
  }

  std::vector<HistoryPanel> wanted;
  if (const std::optional<Manifest> manifest = read_manifest(a))
    for (const ProbeRecord& probe : manifest->probes) wanted.push_back(panel_of(probe));
  std::ranges::copy(single_curves(), std::back_inserter(wanted));
  const HistoryView view_a = view_history(a / "history.csv", wanted), view_b = view_history(b / "history.csv", wanted);
  page.heading("Over time");
  page.add("<div class=\"charts\">");
  for (const Panel& panel : view_a.panels) {
    const std::string quantity = name_of(panel);
    const auto other = std::ranges::find(view_b.panels, quantity, name_of);
    if (other == view_b.panels.end()) continue;
    Panel both{.quantity = quantity, .unit = panel.unit, .min_span = panel.min_span};
    both.series = {series_of(panel, "A", colours::kFirst, ""), series_of(*other, "B", colours::kSecond, "6 4")};
    if (!is_zero(both.series.front()) || !is_zero(both.series.back())) page.chart(both);
  }
  page.add("</div>");
  return std::move(page).finish();
}

}  // namespace hexaplast::output
