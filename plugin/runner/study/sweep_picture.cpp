// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/sweep_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "page/history_panels.hpp"
#include "page/xy_plot.hpp"

namespace hexaplast::runner {
namespace {

constexpr long kMostPanels = 64;   // of a quantity: more are too small to be told apart
constexpr double kNoTwist = 0.05;  // [deg] a bar that is pulled turns by less

/// Two results with a common unit.
struct Shown {
  std::string_view quantity, plastic, world;
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

output::XYGrid grid_of(const Shown& shown, const SweepTable& table, const std::string& label) {
  const Factor& along = table.factors().front();
  const output::CurveColours colours;
  const bool has_numbers = !along.numbers.empty();
  output::XYGrid grid{std::string(shown.quantity), 1, {label, along.is_logarithmic, {}}, {}};
  if (!has_numbers) grid.across.names = along.values;

  // the first factor's value changes slowest: the runs with its first value tell all combinations of the others
  const long num_panels = table.num_runs() / static_cast<long>(along.values.size());
  for (long first = 0; first < num_panels; ++first) {
    std::vector<std::size_t> choice = table.choice(first);
    output::XYPanel panel{title_of(table, choice), {}};
    for (const auto& [name, colour, result] :
         {std::tuple{"world", colours.first, shown.world}, {"plastic", colours.second, shown.plastic}}) {
      output::XYCurve curve{name, std::string(colour), {}, {}, has_numbers, true};
      for (const std::size_t value : order_of(along)) {
        choice[0] = value;
        const std::optional<SweepRow>& row = table.row(table.run_of(choice));
        curve.x.push_back(has_numbers ? along.numbers[value] : static_cast<double>(value));
        curve.y.push_back(row ? shown.scale * row->number(result) : std::nan(""));
      }
      panel.curves.push_back(std::move(curve));
    }
    grid.panels.push_back(std::move(panel));
  }
  return grid;
}

bool twists(const SweepTable& table) {
  for (long run = 0; run < table.num_runs(); ++run)
    if (const std::optional<SweepRow>& row = table.row(run))
      for (const std::string_view result : {kTwist.plastic, kTwist.world})
        if (std::abs(row->number(result)) > kNoTwist) return true;
  return false;
}

}  // namespace

std::vector<std::string> draw_sweep(const std::filesystem::path& file, const std::string& title,
                                    const SweepTable& table, std::span<const std::string> labels) {
  const long num_panels = table.num_runs() / static_cast<long>(table.factors().front().values.size());
  if (num_panels > kMostPanels)
    return {
        fmt::format("no picture: it would have {} plots of a quantity, at most {} are drawn", num_panels, kMostPanels)};
  std::vector<output::XYGrid> grids = {grid_of(kElongation, table, labels.front())};
  if (twists(table)) grids.push_back(grid_of(kTwist, table, labels.front()));
  output::write_xy_plot(file, title, grids);
  return {};
}

}  // namespace hexaplast::runner
