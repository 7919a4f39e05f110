// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/chart.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/formats/xml.hpp"
#include "picture/axis.hpp"

namespace hexaplast::output {
namespace {

Ticks vertical_axis(const Panel& panel) {
  constexpr double kNoise = 1e-6;  // of the span: rounding does not turn a scale upside down
  double least = 0, most = 0;      // zero, the original shape, is always in sight
  const auto include = [&](double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  };
  for (const Series& series : panel.series)
    for (const Curve& curve : series.curves)
      for (const double value : curve.values) include(std::min(value, panel.highest));
  for (const Level& level : panel.levels) include(std::min(level.value, panel.highest));

  if (most - least < panel.least_span) {
    const bool falls = -least > most + kNoise * panel.least_span;
    most = falls ? std::max(most, 0.0) : least + panel.least_span;
    least = falls ? most - panel.least_span : least;
  }
  return ticks_around(least, most, 6);
}

Ticks horizontal_axis(const Panel& panel) {
  double first = panel.series.front().times.front(), last = first;
  for (const Series& series : panel.series) {
    first = std::min(first, series.times.front());
    last = std::max(last, series.times.back());
  }
  return ticks_within(first, std::max(last, first + 1e-9), 5);
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

PanelAxes SvgText::panel(const PanelFrame& frame, const Panel& panel) {
  const Ticks across = horizontal_axis(panel), upwards = vertical_axis(panel);
  const double right = frame.left + frame.width, bottom = frame.top + frame.height;
  const auto x_of = [&](double time) {
    return frame.left + frame.width * (time - across.least) / (across.most - across.least);
  };
  const auto y_of = [&](double value) {
    return bottom - frame.height * (std::min(value, upwards.most) - upwards.least) / (upwards.most - upwards.least);
  };
  const auto line = [&](double x1, double y1, double x2, double y2, std::string_view colour, std::string_view more) {
    add(fmt::format(R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" stroke="{}"{}/>)", x1, y1, x2, y2, colour,
                    more));
  };

  for (const double time : across.values) {
    line(x_of(time), frame.top, x_of(time), bottom, inks_.grid, "");
    words(x_of(time), bottom + 18, "middle", 13, across.label(time));
  }
  for (const double value : upwards.values) {
    line(frame.left, y_of(value), right, y_of(value), value == 0 ? inks_.frame : inks_.grid, "");
    words(frame.left - 8, y_of(value) + 4.5, "end", 13, upwards.label(value));
  }
  add(fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{}" height="{}" fill="none" stroke="{}"/>)", frame.left,
                  frame.top, frame.width, frame.height, inks_.frame));
  words(frame.left, frame.top - 10, "start", 14, panel.label());
  words(right, bottom + 36, "end", 13, "time [s]");

  for (const Series& series : panel.series)
    for (const Curve& curve : series.curves) {
      std::string points;
      for (std::size_t s = 0; s < series.times.size(); ++s)
        points += fmt::format("{:.2f},{:.2f} ", x_of(series.times[s]), y_of(curve.values[s]));
      const std::string dashes =
          curve.dashes.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", escaped(curve.dashes));
      add(fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.8" stroke-linejoin="round"{}/>)",
                      points, curve.colour, dashes));
    }
  for (const Level& level : panel.levels)
    line(frame.left, y_of(level.value), right, y_of(level.value), level.colour,
         R"( stroke-width="1.4" stroke-dasharray="6 4")");
  return {across.least, across.most, upwards.least, upwards.most};
}

}  // namespace hexaplast::output
