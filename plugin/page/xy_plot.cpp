// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/xy_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "hexaplast/formats/xml.hpp"
#include "page/chart.hpp"
#include "picture/axis.hpp"
#include "record/files.hpp"

namespace hexaplast::output {
namespace {

/// Measures of a grid [pixels]: one plot alone is large, many are small.
struct Layout {
  int columns;
  double width, height;  // of a panel's frame
  int ticks_across, ticks_upwards;
};

constexpr double kLeft = 78, kRight = 34, kTop = 84, kBottom = 24;        // margins of the page
constexpr double kGapX = 30, kGapY = 38, kGridHead = 34, kGridFoot = 60;  // between panels, around grids
constexpr double kLeastWidth = 560;                                       // of the page, for title and legend

Layout layout_of(std::size_t num_panels) {
  if (num_panels == 1) return {1, 560, 300, 6, 6};
  if (num_panels <= 3) return {static_cast<int>(num_panels), 270, 190, 4, 5};
  return {4, 210, 150, 3, 4};
}

/// The interval of an axis and where its ticks stand.
class Scale {
 public:
  Scale(Ticks ticks, double from, double to, bool is_logarithmic)
      : ticks_(std::move(ticks)), from_(from), to_(to), is_logarithmic_(is_logarithmic) {}

  double operator()(double value) const {
    const auto along = [&](double v) { return is_logarithmic_ ? std::log(v) : v; };
    return from_ + (to_ - from_) * (along(value) - along(ticks_.least)) / (along(ticks_.most) - along(ticks_.least));
  }
  const Ticks& ticks() const { return ticks_; }

 private:
  Ticks ticks_;
  double from_, to_;  // [pixels]
  bool is_logarithmic_;
};

template <class Visit>
void for_each_value(const XYGrid& grid, const Visit& visit) {
  for (const XYPanel& panel : grid.panels)
    for (const XYCurve& curve : panel.curves)
      for (std::size_t i = 0; i < curve.x.size(); ++i)
        if (std::isfinite(curve.y[i])) visit(curve.x[i], curve.y[i]);
}

Ticks ticks_across(const XYGrid& grid, int count) {
  if (!grid.across.names.empty()) {
    const double last = static_cast<double>(grid.across.names.size()) - 1;
    return {.least = -0.5, .most = last + 0.5, .values = {}, .decimals = 0};
  }
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const XYPanel& panel : grid.panels)
    for (const XYCurve& curve : panel.curves)
      for (const double x : curve.x) {
        least = std::min(least, x);
        most = std::max(most, x);
      }
  if (!(least < most)) {  // a single value stands in the middle
    const double margin = least == 0 || !std::isfinite(least) ? 1 : std::abs(least) / 2;
    least = std::isfinite(least) ? least - margin : -margin;
    most = least + 2 * margin;
  }
  return grid.across.is_logarithmic ? ticks_logarithmic(least, most, count) : ticks_within(least, most, count);
}

Ticks ticks_upwards(const XYGrid& grid, int count) {
  double least = 0, most = 0;  // zero, the original shape, is always in sight
  for_each_value(grid, [&](double, double y) {
    least = std::min(least, y);
    most = std::max(most, y);
  });
  if (most - least < grid.least_span) (-least > most ? least : most) += grid.least_span - (most - least);
  return ticks_around(least, most, count);
}

class Picture {
 public:
  void line(double x1, double y1, double x2, double y2, std::string_view colour) {
    svg_.add(
        fmt::format(R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" stroke="{}"/>)", x1, y1, x2, y2, colour));
  }

  void curve(const XYCurve& curve, const Scale& x, const Scale& y) {
    std::string points;
    const auto finish_line = [&] {
      if (curve.has_line && !points.empty())
        svg_.add(
            fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.8" stroke-linejoin="round"/>)",
                        points, escaped(curve.colour)));
      points.clear();
    };
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (std::isfinite(curve.y[i]))
        points += fmt::format("{:.2f},{:.2f} ", x(curve.x[i]), y(curve.y[i]));
      else
        finish_line();
    }
    finish_line();
    if (!curve.has_dots) return;
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      if (std::isfinite(curve.y[i]))
        svg_.add(fmt::format(R"(<circle cx="{:.2f}" cy="{:.2f}" r="2.6" fill="{}"/>)", x(curve.x[i]), y(curve.y[i]),
                             escaped(curve.colour)));
  }

  void panel(const XYGrid& grid, const XYPanel& panel, const Layout& layout, double left, double top, bool is_leftmost,
             bool is_lowest) {
    const double right = left + layout.width, bottom = top + layout.height;
    const Scale x(ticks_across(grid, layout.ticks_across), left, right, grid.across.is_logarithmic);
    const Scale y(ticks_upwards(grid, layout.ticks_upwards), bottom, top, false);
    const Inks& inks = svg_.inks();
    for (const double value : x.ticks().values) {
      line(x(value), top, x(value), bottom, inks.grid);
      if (is_lowest) svg_.words(x(value), bottom + 17, "middle", 12, x.ticks().label(value));
    }
    if (is_lowest)
      for (std::size_t i = 0; i < grid.across.names.size(); ++i)
        svg_.words(x(static_cast<double>(i)), bottom + 17, "middle", 12, grid.across.names[i]);
    for (const double value : y.ticks().values) {
      line(left, y(value), right, y(value), value == 0 ? inks.frame : inks.grid);
      if (is_leftmost) svg_.words(left - 8, y(value) + 4, "end", 12, y.ticks().label(value));
    }
    svg_.add(fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{}" height="{}" fill="none" stroke="{}"/>)", left, top,
                         layout.width, layout.height, inks.frame));
    svg_.words(left + layout.width / 2, top - 8, "middle", 12, panel.title);
    for (const XYCurve& one : panel.curves) curve(one, x, y);
  }

  /// Returns the lower end of the grid.
  double grid(const XYGrid& grid, double top) {
    const Layout layout = layout_of(grid.panels.size());
    const int num_panels = static_cast<int>(grid.panels.size());
    svg_.words(kLeft, top, "start", 15, grid.quantity);
    for (int p = 0; p < num_panels; ++p) {
      const int row = p / layout.columns, column = p % layout.columns;
      panel(grid, grid.panels[p], layout, kLeft + column * (layout.width + kGapX),
            top + kGridHead + row * (layout.height + kGapY), column == 0, p + layout.columns >= num_panels);
    }
    const int rows = (num_panels + layout.columns - 1) / layout.columns;
    const double bottom = top + kGridHead + rows * (layout.height + kGapY) - kGapY;
    svg_.words(kLeft + width_of(grid), bottom + 37, "end", 13, grid.across.label);
    return bottom;
  }

  /// Of all panels side by side.
  static double width_of(const XYGrid& grid) {
    const Layout layout = layout_of(grid.panels.size());
    return layout.columns * (layout.width + kGapX) - kGapX;
  }

  void legend(std::span<const XYGrid> grids, double y) {
    std::set<std::pair<std::string, std::string>> shown;
    double x = kLeft;
    for (const XYGrid& grid : grids)
      for (const XYPanel& panel : grid.panels)
        for (const XYCurve& curve : panel.curves) {
          if (curve.name.empty() || !shown.emplace(curve.name, curve.colour).second) continue;
          if (curve.has_line)
            svg_.add(
                fmt::format(R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" stroke="{}" stroke-width="2.4"/>)",
                            x, y - 5, x + 26, y - 5, escaped(curve.colour)));
          if (curve.has_dots)
            svg_.add(fmt::format(R"(<circle cx="{:.2f}" cy="{:.2f}" r="3.2" fill="{}"/>)", x + 13, y - 5,
                                 escaped(curve.colour)));
          svg_.words(x + 33, y, "start", 13, curve.name);
          x += 54 + 7.4 * static_cast<double>(curve.name.size());
        }
  }

  SvgText& svg() { return svg_; }

 private:
  SvgText svg_;
};

}  // namespace

void write_xy_plot(WholeFile& out, const std::string& title, std::span<const XYGrid> grids) {
  Picture picture;
  double width = kLeastWidth, bottom = kTop;
  for (const XYGrid& grid : grids) {
    bottom = picture.grid(grid, bottom + kGridHead) + kGridFoot;
    width = std::max(width, Picture::width_of(grid));
  }
  picture.svg().words(kLeft, 42, "start", 19, title, R"( font-weight="bold")");
  picture.legend(grids, 72);
  width += kLeft + kRight;
  const double height = bottom + kBottom;

  out.write(
      fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                  "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"\n"
                  "     font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" fill=\"{2}\">\n"
                  "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
                  width, height, picture.svg().inks().text));
  out.write(picture.svg().text());
  out.write("</svg>\n");
  out.commit();
}

void write_xy_plot(const std::filesystem::path& file, const std::string& title, std::span<const XYGrid> grids) {
  WholeFile out(file);
  write_xy_plot(out, title, grids);
}

}  // namespace hexaplast::output
