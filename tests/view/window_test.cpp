// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Eigen/Geometry>
#include <string>

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
};

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
  EXPECT_GT(support::content(directory_ / "bar_002.png").size(), 20'000u) << "the window goes on";
}

TEST_F(LiveWindow, RefusesAFinishedRun) {
  ASSERT_EQ(hexaplast("run bar.scn --steps 6 --out run --frames 0").code, 0);
  for (const char* run : {"run", "run/mesh.pvd"}) {
    const Outcome refused = hexaplast(std::string("view ") + run, "env -u DISPLAY");
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_NE(refused.err.find("is a finished run, not a scene: open run/report.html in a browser, or use hexaplast "
                               "render"),
              std::string::npos)
        << refused.err;
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
