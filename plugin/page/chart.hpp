// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace hexaplast::output {

/// Numbers over time, as a line. Colours are whatever SVG takes for one.
struct Curve {
  std::string name = {};  ///< empty: the panel says it all
  std::string colour;
  std::vector<double> values;  ///< in the panel's unit
  std::string dashes = {};     ///< of SVG; empty: a solid line
};

/// Curves with common times.
struct Series {
  std::string name = {};      ///< of the run, where several are shown
  std::vector<long> steps;    ///< ascending
  std::vector<double> times;  ///< [s] per step
  std::vector<Curve> curves;  ///< one value per step
};

/// A horizontal line that marks a value.
struct Level {
  std::string name;
  std::string colour;
  double value;
};

/// One quantity, or several with the same unit, over time. It has a series with a step at least.
struct Panel {
  std::string quantity;
  std::string unit = {};  ///< empty: a number
  double least_span = 1;  ///< smaller ranges are shown this large, so that rounding does not look like a result
  std::vector<Series> series = {};
  std::vector<Level> levels = {};
  double highest = std::numeric_limits<double>::infinity();  ///< what exceeds it is drawn at the upper edge

  std::string label() const;  ///< "quantity [unit]"
};

/// Where a panel's axes stand [pixels].
struct PanelFrame {
  double left, top, width, height;
};

/// The intervals that the axes of a panel show.
struct PanelAxes {
  double first_time, last_time;  ///< [s]
  double least, most;            ///< in the panel's unit
};

/// Colours of what is no curve.
struct Inks {
  std::string_view text = "#22222a", grid = "#e3e5e8", frame = "#8a8f98";
};

/// Text of an SVG picture: panels and words that are drawn one after the other.
class SvgText {
 public:
  explicit SvgText(Inks inks = {}) : inks_(inks) {}

  void add(std::string_view element);
  void words(double x, double y, std::string_view anchor, double size, std::string_view words,
             std::string_view attributes = "");

  /// Axes with ticks, the label above, curves and levels.
  PanelAxes panel(const PanelFrame& frame, const Panel& panel);

  const std::string& text() const { return text_; }
  const Inks& inks() const { return inks_; }

 private:
  Inks inks_;
  std::string text_;
};

}  // namespace hexaplast::output
