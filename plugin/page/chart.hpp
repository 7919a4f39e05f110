// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "picture/axis.hpp"

namespace hexaplast::output {

/// Numbers along the horizontal axis, as a line. Colours are whatever SVG takes for one.
struct Curve {
  std::string name = {};  ///< empty: the panel says it all
  std::string colour = {};
  std::vector<double> values = {};  ///< in the panel's unit; where one is not finite there is a gap
  std::string dashes = {};          ///< of SVG; empty: a solid line
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

/// One quantity, or several with the same unit.
struct Panel {
  std::string quantity = {};
  std::string unit = {};  ///< empty: a number
  double min_span = 1;    ///< smaller ranges are shown this large, so that rounding does not look like a result
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

/// Colours of what is no curve: those of the page, in its scheme.
constexpr std::string_view kTextInk = "var(--ink)", kGridInk = "var(--grid)", kFrameInk = "var(--frame)";

/// Text of an SVG picture: panels and words that are drawn one after the other.
class SvgText {
 public:
  void add(std::string_view element);
  void words(double x, double y, std::string_view anchor, double size, std::string_view words,
             std::string_view attributes = "");
  void line(double x1, double y1, double x2, double y2, std::string_view colour, std::string_view attributes = "");

  /// Axes with ticks and what they mean, over time [s]; curves and levels.
  PanelAxes panel(const PanelFrame& frame, const Panel& panel);

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace hexaplast::output
