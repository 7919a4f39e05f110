// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/replay.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <thread>

#include "support/compare.hpp"
#include "support/output.hpp"
#include "support/played.hpp"
#include "view/page_picture.hpp"
#include "view/trace.hpp"

namespace hexaplast::view {
namespace {

/// A run of 12 steps, each third of which is saved, and the positions then.
class WrittenRun : public testing::Test {
 protected:
  WrittenRun() {
    support::Played played(support::bar_with("<ConstantForceField indices='54-62' totalForce='1 0 8'/>"));
    output::Recorder recorder(
        scratch / "run", played.body(),
        {.title = "bar", .num_steps = 12, .dt = 0.01, .output_every = 3, .num_frames = 0, .probes = {"pull"}});
    auto& state = support::at<scene::MechanicalState>(played.scene(), "nodes");
    recorder.record({.probes = {0}}, state.positions(), state.velocities());
    for (int step = 1; step <= 12; ++step) {
      output::StepRecord record = played.step();
      record.time = played.scene().time();
      record.probes = {0.5 * step};
      recorder.record(record, state.positions(), state.velocities());
      positions.push_back(state.positions());
    }
    strain = std::ranges::max(played.body().fields(state.positions()).plastic_strain);
    recorder.finish();
    replay.emplace(output::RecordedRun(scratch / "run"));
  }

  const support::Scratch scratch;
  std::vector<PointArray> positions;  // after each step
  double strain = 0;
  std::optional<Replay> replay;
  Snapshot now;
};

TEST_F(WrittenRun, GoesFromStateToState) {
  ASSERT_EQ(replay->num_states(), 5);
  EXPECT_EQ(replay->title(), "run");
  EXPECT_NEAR(replay->dt(), 0.03, 1e-12);
  ASSERT_TRUE(replay->take(now));
  EXPECT_EQ(now.step, 0);
  EXPECT_FALSE(replay->take(now)) << "nothing has changed";
  replay->advance(2);
  ASSERT_TRUE(replay->take(now));
  EXPECT_EQ(now.step, 6);
  EXPECT_NEAR(now.sample.time, 0.06, 1e-12);
  EXPECT_TRUE(support::agrees(now.positions, positions[5], 1e-6));
  replay->advance(-1);
  replay->take(now);
  EXPECT_EQ(now.step, 3);
  replay->go_to(4);
  replay->take(now);
  EXPECT_EQ(now.step, 12);
  EXPECT_NEAR(std::ranges::max(now.of_hexahedra), strain, 1e-6);
  EXPECT_EQ(now.values.size(), 63u);
  replay->show(Quantity::kSpeed);
  ASSERT_TRUE(replay->take(now));
  EXPECT_TRUE(now.of_hexahedra.empty());
  EXPECT_GT(std::ranges::max(now.values), 0.01);
  replay->advance(9);
  replay->take(now);
  EXPECT_EQ(now.step, 12) << "the last one";
  replay->reset();
  replay->take(now);
  EXPECT_EQ(now.step, 0);

  const Traces traces = traces_of(replay->directory(), {{"other", "m"}, {"pull", "N"}});
  EXPECT_TRUE(traces.probes[0].empty());
  EXPECT_EQ(traces.probes[1].at(0.065), 3);
  EXPECT_NEAR(traces.kinetic.latest_time(), 0.12, 1e-12);
  EXPECT_GT(traces.current_elongation.latest(), 0.1) << "[%]";
  EXPECT_EQ(traces.step_ms.latest_time(), 12);
}

TEST_F(WrittenRun, PlaysAndStopsAtTheEnd) {
  replay->set_pace(Pace::kRealTime, 0.5);
  replay->run();
  std::vector<long> steps;
  do {
    if (replay->take(now)) steps.push_back(now.step);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while (now.is_running);
  EXPECT_TRUE(std::ranges::is_sorted(steps));
  EXPECT_EQ(steps.back(), 12);
  replay->set_pace(Pace::kFree);
  replay->run();  // from the beginning again, and a state at each look
  replay->take(now);
  EXPECT_EQ(now.step, 3);
}

TEST_F(WrittenRun, TellsOfAFileThatIsDamaged) {
  replay->take(now);
  std::ofstream(scratch / "run" / "mesh_000003.vtu") << "nothing";
  replay->advance(1);
  ASSERT_TRUE(replay->take(now));
  EXPECT_NE(now.failure.find("mesh_000003.vtu"), std::string::npos) << now.failure;
  replay->reset();
  replay->take(now);
  EXPECT_EQ(now.failure, "");
  EXPECT_EQ(now.step, 0);
}

TEST_F(WrittenRun, IsDrawnOnAPageAsInTheWindow) {
  replay->go_to(4);
  replay->take(now);
  Camera camera(Vec3::UnitY(), Vec3(1, 0.4, 2));
  camera.resize(1280, 720);
  camera.fit(Eigen::AlignedBox3d(Vec3(0, 0, 0), Vec3(0.1, 0.1, 0.3)));
  const auto words = [](const output::Drawing& drawing) {
    std::string all;
    for (const output::Drawing::Text& text : drawing.texts) all += text.words + "|";
    return all;
  };
  const output::Drawing whole =
      page_picture(*replay, now, {}, {}, camera, output::Scale(Quantity::kPlasticStrain, std::pair(0.0, 0.5)));
  EXPECT_NE(words(whole).find("run|"), std::string::npos) << words(whole);
  EXPECT_NE(words(whole).find("t = 0.12 s|"), std::string::npos) << words(whole);
  EXPECT_NE(words(whole).find("initial shape|"), std::string::npos) << words(whole);
  const Look cut{.ghost = Ghost::kNone, .cut = Plane{Vec3::UnitZ(), 0.15}};
  const output::Drawing half = page_picture(*replay, now, {}, cut, camera, output::Scale(Quantity::kPlasticStrain));
  EXPECT_EQ(words(half).find("initial shape|"), std::string::npos) << words(half);
  EXPECT_TRUE(whole.view->geometry.cut_faces.empty());
  EXPECT_FALSE(half.view->geometry.cut_faces.empty());
}

}  // namespace
}  // namespace hexaplast::view
