// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page/xy_plot.hpp"

#include <tinyxml2.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "picture/axis.hpp"
#include "support/output.hpp"

namespace hexaplast::output {
namespace {

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

TEST(XYPlot, LogarithmicAxesShowEqualFactorsAsEqualDistances) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "xy_plot_log.svg";
  const XYGrid grid{"y", 1, {"x", true, {}}, {{"", {{"a", "red", {1, 10, 100}, {0, 1, 2}}}}}};
  write_xy_plot(file, "t", {&grid, 1});
  const auto line = lines_of(file).at("red").at(0);
  ASSERT_EQ(line.size(), 3u);
  EXPECT_NEAR(line[1].first - line[0].first, line[2].first - line[1].first, 0.02);
  EXPECT_GT(line[0].second, line[2].second);  // upwards
  std::filesystem::remove(file);
}

TEST(XYPlot, ValuesThatAreMissingLeaveAGap) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "xy_plot_gap.svg";
  const XYGrid grid{"y", 1, {"x", false, {}}, {{"", {{"a", "red", {1, 2, 3, 4, 5}, {0, 1, std::nan(""), 3, 4}}}}}};
  write_xy_plot(file, "t", {&grid, 1});
  const auto lines = lines_of(file).at("red");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].size(), 2u);
  EXPECT_EQ(lines[1].size(), 2u);
  std::filesystem::remove(file);
}

TEST(XYPlot, SmallPlotsHaveTheSameAxes) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "xy_plot_grid.svg";
  const XYGrid grid{
      "y", 1, {"x", false, {}}, {{"one", {{"a", "red", {0, 1}, {0, 1}}}}, {"two", {{"b", "blue", {0, 1}, {0, 4}}}}}};
  write_xy_plot(file, "t", {&grid, 1});
  const auto lines = lines_of(file);
  const auto rise = [&](const char* colour) {
    const auto& line = lines.at(colour).at(0);
    return line[0].second - line[1].second;
  };
  EXPECT_NEAR(rise("blue"), 4 * rise("red"), 0.05);
  EXPECT_EQ(lines.at("red")[0][0].second, lines.at("blue")[0][0].second);
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
  for (double least = 0.01; least < 1000; least *= 1.37)
    for (double most = least * 1.2; most < 1e5; most *= 1.83) {
      EXPECT_GE(ticks_within(least, most, 3).values.size(), 2u) << least << " to " << most;
      EXPECT_GE(ticks_logarithmic(least, most, 3).values.size(), 2u) << least << " to " << most;
    }
}

}  // namespace
}  // namespace hexaplast::output
