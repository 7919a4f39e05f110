// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/xml.hpp"

namespace hexaplast::output {
namespace {

Ticks vertical_axis(const Panel& panel, int count) {
  constexpr double kNoise = 1e-6;  // of the span: rounding does not turn a scale upside down
  const double span = panel.min_span;
  double min = 0, max = 0;  // zero, the initial shape, is always in sight
  const auto include = [&](double value) {
    if (!std::isfinite(value)) return;
    min = std::min(min, std::min(value, panel.highest));
    max = std::max(max, std::min(value, panel.highest));
  };
  for (const Series& series : panel.series)
    for (const Curve& curve : series.curves) std::ranges::for_each(curve.values, include);
  for (const Level& level : panel.levels) include(level.value);

  if (max - min < span) {
    const bool falls = -min > max + kNoise * span;
    max = falls ? max : min + span;
    min = falls ? max - span : min;
  }
  return ticks_around(min, max, count);
}

Ticks horizontal_axis(const Panel& panel, int count) {
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const Series& series : panel.series)
    for (const double x : series.x) {
      min = std::min(min, x);
      max = std::max(max, x);
    }
  if (!(min < max)) {  // a single value stands in the middle
    const double margin = min == 0 || !std::isfinite(min) ? 1 : std::abs(min) / 2;
    min = std::isfinite(min) ? min - margin : -margin;
    max = min + 2 * margin;
  }
  return ticks_within(min, max, count);
}

/// Where values stand in a frame [pixels].
struct Scales {
  const PanelFrame& frame;
  const PanelAxes& axes;

  double x(double value) const {
    return frame.left + frame.width * (value - axes.across.min) / (axes.across.max - axes.across.min);
  }
  double y(double value) const {
    const double min = axes.upwards.min, max = axes.upwards.max;
    return frame.top + frame.height * (1 - (std::min(value, max) - min) / (max - min));
  }
};

void draw(SvgText& svg, const Scales& at, const std::vector<double>& x, const Curve& curve) {
  const std::string dashes = curve.dashes.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", curve.dashes);
  std::string points;
  const auto finish_line = [&] {
    if (!points.empty())
      svg.add(
          fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.8" stroke-linejoin="round"{}/>)",
                      points, curve.colour, dashes));
    points.clear();
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isfinite(curve.values[i]))
      points += fmt::format("{:.2f},{:.2f} ", at.x(x[i]), at.y(curve.values[i]));
    else
      finish_line();
  }
  finish_line();
}

}  // namespace

std::string Panel::label() const { return unit.empty() ? quantity : fmt::format("{} [{}]", quantity, unit); }

void SvgText::add(std::string_view element) {
  text_ += element;
  text_ += '\n';
}

void SvgText::words(double x, double y, std::string_view anchor, double size, std::string_view words,
                    std::string_view attributes) {
  add(fmt::format(R"(<text x="{:.2f}" y="{:.2f}" text-anchor="{}" font-size="{}"{}>{}</text>)", x, y, anchor, size,
                  attributes, escaped(words)));
}

void SvgText::line(double x1, double y1, double x2, double y2, std::string_view colour, std::string_view attributes) {
  add(fmt::format(R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" stroke="{}"{}/>)", x1, y1, x2, y2, colour,
                  attributes));
}

PanelAxes SvgText::panel(const PanelFrame& frame, const Panel& panel) {
  constexpr double kLabelSize = 13;  // [pixels]
  const PanelAxes axes{horizontal_axis(panel, 5), vertical_axis(panel, 6)};
  const Scales at{frame, axes};
  const double right = frame.left + frame.width, bottom = frame.top + frame.height;

  for (const double value : axes.across.values) {
    line(at.x(value), frame.top, at.x(value), bottom, kGridInk);
    words(at.x(value), bottom + 5 + kLabelSize, "middle", kLabelSize, axes.across.label(value));
  }
  for (const double value : axes.upwards.values) {
    line(frame.left, at.y(value), right, at.y(value), value == 0 ? kFrameInk : kGridInk);
    words(frame.left - 8, at.y(value) + (kLabelSize - 4) / 2, "end", kLabelSize, axes.upwards.label(value));
  }
  add(fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{}" height="{}" fill="none" stroke="{}"/>)", frame.left,
                  frame.top, frame.width, frame.height, kFrameInk));

  for (const Series& series : panel.series)
    for (const Curve& curve : series.curves) draw(*this, at, series.x, curve);
  for (const Level& level : panel.levels)
    line(frame.left, at.y(level.value), right, at.y(level.value), level.colour,
         R"( stroke-width="1.4" stroke-dasharray="6 4")");
  words(frame.left, frame.top - 10, "start", 14, panel.label());
  words(right, bottom + 36, "end", 13, "time [s]");
  return axes;
}

}  // namespace hexaplast::output
