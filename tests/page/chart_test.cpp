// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/chart.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "page/panel_grids.hpp"

namespace hexaplast::output {
namespace {

/// Heights of the horizontal grid lines, from the lowest line up, and of the points of the curve [pixels].
struct Heights {
  std::vector<double> ticks, points;
};

Heights heights_of(const Panel& panel, const PanelFrame& frame) {
  SvgText svg;
  svg.panel(frame, panel);
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.Parse(("<svg>" + svg.text() + "</svg>").c_str()), tinyxml2::XML_SUCCESS);
  Heights heights;
  const tinyxml2::XMLElement& root = *document.RootElement();
  for (auto line = root.FirstChildElement("line"); line; line = line->NextSiblingElement("line"))
    if (line->DoubleAttribute("y1") == line->DoubleAttribute("y2"))
      heights.ticks.push_back(frame.top + frame.height - line->DoubleAttribute("y1"));
  std::istringstream words(root.FirstChildElement("polyline")->Attribute("points"));
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

/// The polylines of a picture, by their colours.
std::map<std::string, std::vector<std::vector<std::pair<double, double>>>> lines_of(const std::filesystem::path& file) {
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.LoadFile(file.c_str()), tinyxml2::XML_SUCCESS);
  std::map<std::string, std::vector<std::vector<std::pair<double, double>>>> lines;
  const tinyxml2::XMLElement* line = document.RootElement()->FirstChildElement("polyline");
  for (; line; line = line->NextSiblingElement("polyline")) {
    std::vector<std::pair<double, double>> points;
    std::istringstream words(line->Attribute("points"));
    for (double x, y; words >> x && words.ignore() && words >> y;) points.emplace_back(x, y);
    lines[line->Attribute("stroke")].push_back(points);
  }
  return lines;
}

Panel panel_of(const char* colour, std::vector<double> x, std::vector<double> y, bool is_logarithmic = false) {
  return {.across = {"x", is_logarithmic, {}},
          .series = {{.x = std::move(x), .curves = {{.name = "a", .colour = colour, .values = std::move(y)}}}}};
}

TEST(PanelGrids, LogarithmicAxesShowEqualFactorsAsEqualDistances) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "panel_grids_log.svg";
  const PanelGrid grid{"y", {panel_of("red", {1, 10, 100}, {0, 1, 2}, true)}};
  write_panel_grids(file, "t", {&grid, 1});
  const auto line = lines_of(file).at("red").at(0);
  ASSERT_EQ(line.size(), 3u);
  EXPECT_NEAR(line[1].first - line[0].first, line[2].first - line[1].first, 0.02);
  EXPECT_GT(line[0].second, line[2].second);  // upwards
  std::filesystem::remove(file);
}

TEST(PanelGrids, ValuesThatAreMissingLeaveAGap) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "panel_grids_gap.svg";
  const PanelGrid grid{"y", {panel_of("red", {1, 2, 3, 4, 5}, {0, 1, std::nan(""), 3, 4})}};
  write_panel_grids(file, "t", {&grid, 1});
  const auto lines = lines_of(file).at("red");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].size(), 2u);
  EXPECT_EQ(lines[1].size(), 2u);
  std::filesystem::remove(file);
}

TEST(PanelGrids, SmallPlotsHaveTheSameAxes) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "panel_grids_grid.svg";
  const PanelGrid grid{"y", {panel_of("red", {0, 1}, {0, 1}), panel_of("blue", {0, 1}, {0, 4})}};
  write_panel_grids(file, "t", {&grid, 1});
  const auto lines = lines_of(file);
  const auto rise = [&](const char* colour) {
    const auto& line = lines.at(colour).at(0);
    return line[0].second - line[1].second;
  };
  EXPECT_NEAR(rise("blue"), 4 * rise("red"), 0.05);
  EXPECT_EQ(lines.at("red")[0][0].second, lines.at("blue")[0][0].second);
  std::filesystem::remove(file);
}

// A fall of a fiftieth of the smallest span stands at the upper edge of a scale that reaches downwards.
TEST(PanelGrids, ASmallFallIsShownOnTheLeastSpan) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "panel_grids_fall.svg";
  const PanelGrid grid{"y", {panel_of("red", {0, 1, 2}, {0, -0.02, -0.01}), panel_of("blue", {0, 1, 2}, {0, 0, 0})}};
  write_panel_grids(file, "t", {&grid, 1});
  const auto lines = lines_of(file);
  const auto& falls = lines.at("red").at(0);
  const auto& stays = lines.at("blue").at(0);
  EXPECT_EQ(falls[0].second, stays[0].second);
  EXPECT_NEAR(falls[1].second - falls[0].second, 0.02 * 190, 0.02);  // of 190 pixels for the span of 1, downwards
  EXPECT_NEAR(falls[2].second - falls[0].second, 0.01 * 190, 0.02);
  std::filesystem::remove(file);
}

TEST(LogarithmicTicks, AreRoundNumbersWithinTheInterval) {
  const auto expect = [](const Ticks& ticks, const std::vector<double>& values) {
    ASSERT_EQ(ticks.values.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(ticks.values[i], values[i], 1e-12 * values[i]);
  };
  expect(ticks_logarithmic(0.3, 6, 5), {0.5, 1, 2, 5});
  expect(ticks_logarithmic(1, 10, 5), {1, 2, 5, 10});
  expect(ticks_logarithmic(0.02, 3000, 6), {0.1, 1, 10, 100, 1000});
  EXPECT_EQ(ticks_logarithmic(100, 1000, 5).label(200), "200");
}

// One number on an axis tells no scale, however small the plot.
TEST(Ticks, AreTwoAtLeast) {
  const auto expect = [](const Ticks& ticks, const std::vector<double>& values) {
    ASSERT_EQ(ticks.values.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(ticks.values[i], values[i], 1e-12 * values[i]);
  };
  expect(ticks_within(6, 14, 3), {6, 8, 10, 12, 14});  // the multiples of 5 would be 10 alone
  expect(ticks_within(0, 10, 2), {0, 5, 10});
  expect(ticks_logarithmic(150, 2500, 3), {200, 500, 1000, 2000});  // the powers of ten would be 1000 alone
  expect(ticks_logarithmic(2.2, 4.5, 3), {3, 4});                   // no 1, 2 or 5 is there
  for (double min = 0.01; min < 1000; min *= 1.37)
    for (double max = min * 1.2; max < 1e5; max *= 1.83) {
      EXPECT_GE(ticks_within(min, max, 3).values.size(), 2u) << min << " to " << max;
      EXPECT_GE(ticks_logarithmic(min, max, 3).values.size(), 2u) << min << " to " << max;
    }
}

}  // namespace
}  // namespace hexaplast::output
