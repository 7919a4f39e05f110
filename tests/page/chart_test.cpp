// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/chart.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "formats/xml.hpp"

namespace hexaplast::output {
namespace {

/// Heights of the horizontal grid lines, from the lowest line up, and of the points of the curve [pixels].
struct Heights {
  std::vector<double> ticks, points;
};

Heights heights_of(const Panel& panel, const PanelFrame& frame) {
  SvgText svg;
  svg.panel(frame, panel);
  const XmlElement root = parse_xml("<svg>" + svg.text() + "</svg>").root;
  Heights heights;
  for (const XmlElement& line : root.children)
    if (line.name == "line" && line.attribute("y1") == line.attribute("y2"))
      heights.ticks.push_back(frame.top + frame.height - std::stod(std::string(line.attribute("y1"))));
  std::istringstream words(std::string(root.child("polyline")->attribute("points")));
  for (double x, y; words >> x && words.ignore() && words >> y;) heights.points.push_back(frame.top + frame.height - y);
  return heights;
}

// The scale ends at a round number above the limit, and stays even up to it.
TEST(Chart, AnUpperLimitCutsCurvesAndLeavesTheScaleEven) {
  const PanelFrame frame{50, 40, 400, 300};
  Panel panel{.quantity = "time per step", .unit = "ms", .min_span = 1e-3};
  panel.series = {{.steps = {0, 1, 2, 3}, .x = {0, 1, 2, 3}, .curves = {{.colour = "red", .values = {1, 2, 50, 1}}}}};
  panel.highest = 4.5;
  const Heights heights = heights_of(panel, frame);
  ASSERT_EQ(heights.ticks.size(), 6u);  // 0, 1, ... 5
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(heights.ticks[static_cast<std::size_t>(k)], 60 * k, 0.02);
  ASSERT_EQ(heights.points.size(), 4u);
  EXPECT_NEAR(heights.points[0], 60, 0.02);
  EXPECT_NEAR(heights.points[1], 120, 0.02);
  EXPECT_NEAR(heights.points[2], 300, 0.02);  // at the upper edge, not beyond it
}

// One number on an axis tells no scale, however small the plot.
TEST(Ticks, AreTwoAtLeast) {
  const auto expect = [](const Ticks& ticks, const std::vector<double>& values) {
    ASSERT_EQ(ticks.values.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(ticks.values[i], values[i], 1e-12 * values[i]);
  };
  expect(ticks_within(6, 14, 3), {6, 8, 10, 12, 14});  // the multiples of 5 would be 10 alone
  expect(ticks_within(0, 10, 2), {0, 5, 10});
  for (double min = 0.01; min < 1000; min *= 1.37)
    for (double max = min * 1.2; max < 1e5; max *= 1.83)
      EXPECT_GE(ticks_within(min, max, 3).values.size(), 2u) << min << " to " << max;
}

}  // namespace
}  // namespace hexaplast::output
