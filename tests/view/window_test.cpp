// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <string>

#include "picture/page.hpp"
#include "support/bar_scene.hpp"
#include "support/command.hpp"
#include "support/png.hpp"

namespace hexaplast {
namespace {

using support::Outcome;

std::string hash(const std::string& text) { return text.substr(text.find("state hash")); }

const std::string kOnScreen = "timeout 280 bash '" HEXAPLAST_SOURCE_DIR "/tests/support/on_screen.sh'";

/// Runs the command with the live window on a screen in memory, by software.
class LiveWindow : public support::Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    for (const char* program : {"Xvfb", "xdotool"})
      if (shell(std::string("command -v ") + program).code != 0) GTEST_SKIP() << program << " is not installed";
    write("bar.scn", support::kBar);
  }

  /// Presses the mouse at a pixel of the window, moves it ten times, lets go, and closes the window.
  Outcome pull(const std::string& from, const std::string& step) {
    return shell(kOnScreen +
                 " bash '" HEXAPLAST_SOURCE_DIR "/tests/support/pull_in_window.sh' '" HEXAPLAST_COMMAND "' bar.scn " +
                 from + " " + step);
  }

  /// Mean height of the bar's free end, without forces [m]. It was 0.3.
  double free_end() {
    const auto state = nlohmann::json::parse(support::content(directory_ / "final.json"));
    const auto& nodes = state.at("plastic_rest_positions");
    double sum = 0;
    for (std::size_t n = 54; n < 63; ++n) sum += nodes.at(n).at(2).get<double>() / 9;
    return sum;
  }
};

/// Mean colours of places that the window and a picture from its viewpoint show, where neither is paper or ghost.
struct Agreement {
  int count = 0;
  Eigen::Array3d window = Eigen::Array3d::Zero(), picture = Eigen::Array3d::Zero();
  double difference = 0;  // of a colour's components at the same place, mean of their absolute values
};

/// is_wanted: of the colour in the picture.
template <class Wanted>
Agreement agreement(const output::Image& window, const output::Image& picture, const Wanted& is_wanted) {
  const output::Window part = output::Page(picture.width, picture.height).window();
  const double scale = window.height / static_cast<double>(part.height);
  const double middle = (330 + window.width - 340) / 2.0;  // between the panels
  const auto colour_at = [](const output::Image& image, int x, int y) {
    const std::uint8_t* pixel = &image.pixels[3 * (static_cast<std::size_t>(y) * image.width + x)];
    return Eigen::Array3d(pixel[0], pixel[1], pixel[2]);
  };
  Agreement found;
  for (int y = static_cast<int>(part.top); y < static_cast<int>(part.top + part.height); ++y)
    for (int x = static_cast<int>(part.left); x < static_cast<int>(part.left + part.width); ++x) {
      const int across = static_cast<int>(middle + scale * (x + 0.5 - (part.left + part.width / 2))),
                down = static_cast<int>(scale * (y + 0.5 - part.top));
      if (across < 330 || across >= window.width - 340 || down < 60) continue;  // beside the body: panels and words
      const Eigen::Array3d of_window = colour_at(window, across, down), of_picture = colour_at(picture, x, y);
      if (of_window.minCoeff() > 235 || of_picture.minCoeff() > 235 || !is_wanted(of_picture)) continue;
      ++found.count;
      found.window += of_window;
      found.picture += of_picture;
      found.difference += (of_window - of_picture).abs().mean();
    }
  found.window /= found.count;
  found.picture /= found.count;
  found.difference /= found.count;
  return found;
}

TEST_F(LiveWindow, WhatTheMouseDragsStaysStretched) {
  const Outcome outcome = pull("900 430", "12 0");  // the bar's free end lies on the right
  ASSERT_EQ(outcome.code, 0) << outcome.err << support::content(directory_ / "outcome");
  EXPECT_GT(free_end(), 0.3 * 1.005);
  const std::string said = support::content(directory_ / "outcome"), line = "plastic strain      ";
  ASSERT_NE(said.find(line), std::string::npos) << said;
  EXPECT_GT(std::stod(said.substr(said.find(line) + line.size())), 0.05) << said;

  // and again without a window
  const Outcome again = hexaplast("run recorded.scn");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(hash(again.out), hash(said));

  // pictures of the whole window, and not the same before and after
  const std::string before = support::content(directory_ / "bar_001.png"),
                    after = support::content(directory_ / "bar_004.png");
  EXPECT_EQ(before.substr(0, 24), after.substr(0, 24));
  EXPECT_EQ(before.substr(16, 8), std::string("\0\0\x05\xa0\0\0\x03\x5c", 8)) << "1440 x 860";
  EXPECT_GT(before.size(), 20'000u);
  EXPECT_NE(before, after);
}

TEST_F(LiveWindow, TheHandPressesWithABallAndTakesItBack) {
  const Outcome outcome =
      shell(kOnScreen + " bash '" HEXAPLAST_SOURCE_DIR "/tests/support/hand_in_window.sh' '" HEXAPLAST_COMMAND
                        "' bar.scn 800 430 2");
  ASSERT_EQ(outcome.code, 0) << outcome.err << support::content(directory_ / "outcome");
  const std::string recorded = support::content(directory_ / "recorded.scn"), tool = "<InstrumentContactForceField";
  const std::size_t first = recorded.find(tool);
  ASSERT_NE(first, std::string::npos) << recorded;
  EXPECT_EQ(recorded.find(tool, first + 1), std::string::npos) << "the other one was taken back";
  EXPECT_EQ(recorded.find("<GraspForceField"), std::string::npos);
  const Outcome again = hexaplast("run recorded.scn");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(hash(again.out), hash(support::content(directory_ / "outcome")));

  const auto size = [&](const char* name) { return support::content(directory_ / name).substr(16, 8); };
  EXPECT_EQ(size("bar_001.png"), std::string("\0\0\x05\xa0\0\0\x03\x5c", 8)) << "of the window: 1440 x 860";
  EXPECT_EQ(size("bar_002.png"), std::string("\0\0\x05\0\0\0\x02\xd0", 8)) << "as of render: 1280 x 720";
  EXPECT_GT(support::content(directory_ / "bar_003.png").size(), 20'000u) << "the window goes on";

  // the window looks as the picture does: tissue with its edges, and the ball
  const output::Image window = support::read_png(directory_ / "bar_001.png"),
                      picture = support::read_png(directory_ / "bar_002.png");
  const auto is_metal = [](const Eigen::Array3d& colour) { return colour[2] > colour[0] + 12 && colour[0] > 90; };
  const auto is_tissue = [](const Eigen::Array3d& colour) { return colour[0] > colour[2] + 12; };
  const Agreement tissue = agreement(window, picture, is_tissue), metal = agreement(window, picture, is_metal);
  EXPECT_GT(tissue.count, 5000);
  EXPECT_LT((tissue.window - tissue.picture).abs().maxCoeff(), 6) << tissue.window << "\n" << tissue.picture;
  EXPECT_LT(tissue.difference, 12);
  EXPECT_GT(metal.count, 200);
  EXPECT_LT((metal.window - metal.picture).abs().maxCoeff(), 8) << metal.window << "\n" << metal.picture;
}

TEST_F(LiveWindow, ShowsAFinishedRun) {
  ASSERT_EQ(hexaplast("run bar.scn --steps 6 --out run --frames 0").code, 0);
  const Outcome outcome = shell(kOnScreen + " '" HEXAPLAST_COMMAND "' view run --steps 1 --picture last.png");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(support::content(directory_ / "last.png").size(), 20'000u);
  for (const char* option : {"--set body.youngModulus=1", "--final final.json", "--record out.scn"}) {
    const Outcome refused = hexaplast(std::string("view run ") + option, "env -u DISPLAY");
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_NE(refused.err.find("run is a run that is finished, not a scene"), std::string::npos) << refused.err;
  }
}

// The bar runs along z.
TEST_F(LiveWindow, StandsAsItIsAskedTo) {
  for (const bool is_upright : {false, true}) {
    const Outcome outcome =
        shell(kOnScreen + " '" HEXAPLAST_COMMAND "' view bar.scn --steps 1 --picture last.png --up " +
              (is_upright ? "z" : "y"));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const output::Image window = support::read_png(directory_ / "last.png");
    Eigen::AlignedBox2i tissue;
    for (int y = 60; y < 690; ++y)
      for (int x = 330; x < window.width - 340; ++x) {
        const std::uint8_t* pixel = &window.pixels[3 * (static_cast<std::size_t>(y) * window.width + x)];
        if (pixel[0] > pixel[2] + 12) tissue.extend(Eigen::Vector2i(x, y));
      }
    ASSERT_FALSE(tissue.isEmpty());
    EXPECT_EQ(tissue.sizes().y() > tissue.sizes().x(), is_upright) << tissue.sizes();
  }
}

TEST_F(LiveWindow, RunsSoManyStepsAndClosesByItself) {
  const Outcome outcome =
      shell(kOnScreen + " '" HEXAPLAST_COMMAND "' view bar.scn --steps 7 --picture last.png --final final.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Outcome headless = hexaplast("run bar.scn --steps 7");
  EXPECT_EQ(hash(outcome.out), hash(headless.out)) << "the window changes nothing";
  EXPECT_GT(support::content(directory_ / "last.png").size(), 20'000u);
}

TEST_F(LiveWindow, WithoutAScreenItSaysSo) {
  const Outcome outcome = hexaplast("view bar.scn", "env -u DISPLAY -u WAYLAND_DISPLAY");
  EXPECT_EQ(outcome.code, 5);
  EXPECT_NE(outcome.err.find("error: no window can be opened: "), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace hexaplast
