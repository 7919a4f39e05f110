// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "picture/axis.hpp"

namespace hexaplast::output {

/// Numbers along the horizontal axis, as a line, as dots, or as both. Colours are whatever SVG takes for one.
struct Curve {
  std::string name = {};  ///< empty: the panel says it all
  std::string colour = {};
  std::vector<double> values = {};  ///< in the panel's unit; where one is not finite there is a gap
  std::string dashes = {};          ///< of SVG; empty: a solid line
  bool has_line = true;
  bool has_dots = false;
};

/// Curves with common places along the horizontal axis.
struct Series {
  std::string name = {};           ///< of the run, where several are shown
  std::vector<long> steps = {};    ///< of a history: ascending, one per place
  std::vector<double> x = {};      ///< of a history: times [s]
  std::vector<Curve> curves = {};  ///< one value per place
};

/// A horizontal line that marks a value.
struct Level {
  std::string name;
  std::string colour;
  double value;
};

/// What stands along the horizontal axis.
struct XAxis {
  std::string label = "time [s]";
  bool is_logarithmic = false;          ///< all values > 0
  std::vector<std::string> names = {};  ///< not numbers but these, at 0, 1, 2, ...
};

/// One quantity, or several with the same unit.
struct Panel {
  std::string quantity = {};
  std::string unit = {};  ///< empty: a number
  double min_span = 1;    ///< smaller ranges are shown this large, so that rounding does not look like a result
  XAxis across = {};
  std::vector<Series> series = {};
  std::vector<Level> levels = {};
  double highest = std::numeric_limits<double>::infinity();  ///< what exceeds it is drawn at the upper edge

  std::string label() const;  ///< "quantity [unit]"
};

/// Where a panel's axes stand [pixels].
struct PanelFrame {
  double left, top, width, height;
};

/// The intervals that the axes of a panel show, and their ticks.
struct PanelAxes {
  Ticks across, upwards;
};

/// Axes with about so many ticks, on which all panels fit. They have the horizontal axis and the smallest span of the
/// first.
PanelAxes axes_of(std::span<const Panel> panels, int ticks_across, int ticks_upwards);

/// Which ticks of a panel are labelled.
struct TickLabels {
  double size = 13;  ///< of the words [pixels]
  bool across = true, upwards = true;
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
  void line(double x1, double y1, double x2, double y2, std::string_view colour, std::string_view attributes = "");
  void dot(double x, double y, double radius, std::string_view colour);

  /// Axes with ticks, curves and levels.
  void panel(const PanelFrame& frame, const Panel& panel, const PanelAxes& axes, const TickLabels& labels = {});

  /// The same with axes of its own, and around it what they mean.
  PanelAxes panel(const PanelFrame& frame, const Panel& panel);

  const std::string& text() const { return text_; }

  /// What was drawn, on white, as a file of its own.
  std::string picture(double width, double height) const;

 private:
  Inks inks_;
  std::string text_;
};

}  // namespace hexaplast::output
