// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/sweep_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "page/history_panels.hpp"
#include "page/panel_grids.hpp"

namespace hexaplast::runner {
namespace {

constexpr long kMaxPanels = 64;    // of a quantity: more are too small to be told apart
constexpr double kNoTwist = 0.05;  // [deg] a bar that is pulled turns by less

/// Two results with a common unit.
struct Shown {
  std::string_view quantity, plastic, current;
  double scale;
};
constexpr Shown kElongation = {"elongation [%]", "plastic_elongation", "world_elongation", 100};
constexpr Shown kTwist = {"twist [°]", "plastic_twist_deg", "world_twist_deg", 1};

/// "yieldStress = 300, plasticFlowRate = 4"
std::string title_of(const SweepTable& table, const std::vector<std::size_t>& choice) {
  std::string title;
  for (std::size_t f = 1; f < choice.size(); ++f) {
    const Factor& factor = table.factors()[f];
    title += fmt::format("{}{} = {}", f > 1 ? ", " : "", factor.attribute.substr(factor.attribute.rfind('.') + 1),
                         factor.values[choice[f]]);
  }
  return title;
}

/// The numbers of the first factor's values in the order in which they stand along the axis.
std::vector<std::size_t> order_of(const Factor& factor) {
  std::vector<std::size_t> order(factor.values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!factor.numbers.empty())
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return factor.numbers[a] < factor.numbers[b]; });
  return order;
}

output::PanelGrid grid_of(const Shown& shown, const SweepTable& table, const std::string& label) {
  const Factor& along = table.factors().front();
  const output::CurveColours colours;
  const bool has_numbers = !along.numbers.empty();
  const std::vector<std::size_t> order = order_of(along);
  const output::XAxis across{label, along.is_logarithmic, has_numbers ? std::vector<std::string>{} : along.values};
  output::PanelGrid grid{std::string(shown.quantity), {}};

  // the first factor's value changes slowest: the runs with its first value tell all combinations of the others
  const long num_panels = table.num_runs() / static_cast<long>(along.values.size());
  for (long first = 0; first < num_panels; ++first) {
    std::vector<std::size_t> choice = table.choice(first);
    output::Panel panel{.quantity = title_of(table, choice), .across = across};
    output::Series& series = panel.series.emplace_back();
    for (const std::size_t value : order)
      series.x.push_back(has_numbers ? along.numbers[value] : static_cast<double>(value));
    for (const auto& [name, colour, result] :
         {std::tuple{"current", colours.first, shown.current}, {"plastic", colours.second, shown.plastic}}) {
      output::Curve curve{.name = name, .colour = std::string(colour), .has_line = has_numbers, .has_dots = true};
      for (const std::size_t value : order) {
        choice[0] = value;
        const std::optional<SweepRow>& row = table.row(table.run_of(choice));
        curve.values.push_back(row ? shown.scale * row->number(result) : std::nan(""));
      }
      series.curves.push_back(std::move(curve));
    }
    grid.panels.push_back(std::move(panel));
  }
  return grid;
}

bool twists(const SweepTable& table) {
  for (long run = 0; run < table.num_runs(); ++run)
    if (const std::optional<SweepRow>& row = table.row(run))
      for (const std::string_view result : {kTwist.plastic, kTwist.current})
        if (std::abs(row->number(result)) > kNoTwist) return true;
  return false;
}

}  // namespace

std::vector<std::string> draw_sweep(const std::filesystem::path& file, const std::string& title,
                                    const SweepTable& table, std::span<const std::string> labels) {
  const long num_panels = table.num_runs() / static_cast<long>(table.factors().front().values.size());
  if (num_panels > kMaxPanels)
    return {
        fmt::format("no picture: it would have {} plots of a quantity, at most {} are drawn", num_panels, kMaxPanels)};
  std::vector<output::PanelGrid> grids = {grid_of(kElongation, table, labels.front())};
  if (twists(table)) grids.push_back(grid_of(kTwist, table, labels.front()));
  output::write_panel_grids(file, title, grids);
  return {};
}

}  // namespace hexaplast::runner
