// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/panel_grids.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace hexaplast::output {
namespace {

/// Measures of a grid [pixels]: one panel alone is large, many are small.
struct Layout {
  int columns;
  double width, height;  // of a panel's frame
  int ticks_across, ticks_upwards;

  double total_width() const;
};

constexpr double kLeft = 78, kRight = 34, kTop = 84, kBottom = 24;        // margins of the page
constexpr double kGapX = 30, kGapY = 38, kGridHead = 34, kGridFoot = 60;  // between panels, around grids
constexpr double kMinWidth = 560;                                         // of the page, for title and legend

Layout layout_of(std::size_t num_panels) {
  if (num_panels == 1) return {1, 560, 300, 6, 6};
  if (num_panels <= 3) return {static_cast<int>(num_panels), 270, 190, 4, 5};
  return {4, 210, 150, 3, 4};
}

double Layout::total_width() const { return columns * (width + kGapX) - kGapX; }

/// Returns the lower end of the grid.
double draw(SvgText& svg, const PanelGrid& grid, double top) {
  const Layout layout = layout_of(grid.panels.size());
  const PanelAxes axes = axes_of(grid.panels, layout.ticks_across, layout.ticks_upwards);
  const int num_panels = static_cast<int>(grid.panels.size());
  svg.words(kLeft, top, "start", 15, grid.quantity);
  for (int p = 0; p < num_panels; ++p) {
    const int row = p / layout.columns, column = p % layout.columns;
    const PanelFrame frame{kLeft + column * (layout.width + kGapX), top + kGridHead + row * (layout.height + kGapY),
                           layout.width, layout.height};
    const Panel& panel = grid.panels[static_cast<std::size_t>(p)];
    svg.panel(frame, panel, axes, {12, p + layout.columns >= num_panels, column == 0});
    svg.words(frame.left + frame.width / 2, frame.top - 8, "middle", 12, panel.label());
  }
  const int rows = (num_panels + layout.columns - 1) / layout.columns;
  const double bottom = top + kGridHead + rows * (layout.height + kGapY) - kGapY;
  svg.words(kLeft + layout.total_width(), bottom + 37, "end", 13, grid.panels.front().across.label);
  return bottom;
}

std::vector<Curve> curves_of(std::span<const PanelGrid> grids) {
  std::vector<Curve> curves;
  for (const PanelGrid& grid : grids)
    for (const Panel& panel : grid.panels)
      for (const Series& series : panel.series) curves.insert(curves.end(), series.curves.begin(), series.curves.end());
  return curves;
}

void draw_legend(SvgText& svg, std::span<const PanelGrid> grids, double y) {
  std::set<std::pair<std::string, std::string>> shown;
  double x = kLeft;
  for (const Curve& curve : curves_of(grids)) {
    if (curve.name.empty() || !shown.emplace(curve.name, curve.colour).second) continue;
    if (curve.has_line) svg.line(x, y - 5, x + 26, y - 5, curve.colour, R"( stroke-width="2.4")");
    if (curve.has_dots) svg.dot(x + 13, y - 5, 3.2, curve.colour);
    svg.words(x + 33, y, "start", 13, curve.name);
    x += 54 + 7.4 * static_cast<double>(curve.name.size());
  }
}

}  // namespace

void write_panel_grids(WholeFile& out, const std::string& title, std::span<const PanelGrid> grids) {
  SvgText svg;
  double width = kMinWidth, bottom = kTop;
  for (const PanelGrid& grid : grids) {
    bottom = draw(svg, grid, bottom + kGridHead) + kGridFoot;
    width = std::max(width, layout_of(grid.panels.size()).total_width());
  }
  svg.words(kLeft, 42, "start", 19, title, R"( font-weight="bold")");
  draw_legend(svg, grids, 72);
  out.write(svg.picture(kLeft + width + kRight, bottom + kBottom));
  out.commit();
}

void write_panel_grids(const std::filesystem::path& file, const std::string& title, std::span<const PanelGrid> grids) {
  WholeFile out(file);
  write_panel_grids(out, title, grids);
}

}  // namespace hexaplast::output
