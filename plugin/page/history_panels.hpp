// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "page/chart.hpp"
#include "record/manifest.hpp"

namespace hexaplast::output {

/// Colours of the curves in a panel: current or first run, plastic or second run, and more; those of the page, in its
/// scheme.
namespace colours {
constexpr std::string_view kFirst = "var(--first)", kSecond = "var(--second)", kThird = "var(--third)",
                           kFourth = "var(--fourth)", kFifth = "var(--fifth)", kSixth = "var(--sixth)",
                           kRest = "var(--frame)";  ///< of what is left over
}

/// What a panel shows: the sum of columns of history.csv, shifted and then scaled to the panel's unit.
struct HistoryCurve {
  std::string name;
  std::vector<std::string> columns;
  double scale = 1;
  double shift = 0;
  std::string_view colour = colours::kSecond;
  bool unless_zero = false;  ///< left out of its panel where it is 0 all along
};

struct HistoryPanel {
  std::string quantity, unit;
  double min_span;
  std::vector<HistoryCurve> curves;
};

/// Elongation, twist, volume error, yielded hexahedra, energy and its balance, displacement where the load is, removed
/// hexahedra, solver iterations, time per step: in the order in which they are shown.
std::vector<HistoryPanel> history_panels();

/// A panel of a probe.
HistoryPanel panel_of(const ProbeRecord& probe);

/// How long the steps of a run took [ms]; its first row, the initial state, is no step.
struct StepTimes {
  double p50 = 0, p90 = 0, p99 = 0, longest = 0;
};

/// history.csv as panels, in the order of `wanted`. Curves of which a column is not in the file are left out, and
/// panels without a curve; in each panel, rows that are not finite. Long histories are thinned (thinning.hpp).
struct HistoryView {
  long num_rows = 0;
  std::vector<Panel> panels;
  StepTimes step_times;
};

/// Whether a panel of a quantity that many runs do not have, as twist or removed hexahedra, shows nothing but rounding.
bool has_nothing_to_see(const Panel& panel);

/// Throws OutputError.
HistoryView view_history(const std::filesystem::path& file, std::span<const HistoryPanel> wanted);

}  // namespace hexaplast::output
