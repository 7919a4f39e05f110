// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures as files: of one picture, and those of a run.
#include "picture/png_file.hpp"
#include "support/output.hpp"
#include "support/pictures.hpp"
#include "support/png.hpp"

namespace hexaplast {
namespace {

TEST(PngFile, HoldsThePixels) {
  const Scratch scratch;
  Image image{31, 17, std::vector<std::uint8_t>(31 * 17 * 3)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i * i % 251);
  write_png(scratch / "some.png", image);

  const Image read = read_png(scratch / "some.png");
  EXPECT_EQ(read.width, 31);
  EXPECT_EQ(read.height, 17);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST(Frames, AreSpreadOverTheRunAndEndWithTheLastState) {
  const Scratch scratch;
  Body body = yielding_block();
  Recorder recorder(scratch / "run", body,
                    {.title = "frames", .num_steps = 8, .dt = 0.01, .output_every = 100, .num_frames = 4});
  record_stretch(recorder, body, 7);  // interrupted: the seventh step is the last
  EXPECT_EQ(recorder.finish(), std::vector<std::string>{});
  for (const char* name : {"frame_000002.png", "frame_000004.png", "frame_000006.png", "frame_000007.png"})
    EXPECT_TRUE(fs::exists(scratch / "run/frames" / name)) << name;
}

TEST(Frames, MissingRendererIsOneWarningAndNothingElseIsLost) {
  const Scratch scratch;
  Body body = yielding_block();
  Recorder recorder(scratch / "run", body, {.title = "blind", .num_steps = 3, .dt = 0.01},
                    [&] { return load_renderer(scratch / "nowhere"); });
  record_stretch(recorder, body, 3);
  const std::vector<std::string> warnings = recorder.finish();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("no pictures"), std::string::npos);
  EXPECT_NE(warnings[0].find("nowhere"), std::string::npos) << warnings[0];
  for (const char* name : {"history.csv", "mesh.pvd", "mesh_000003.vtu"})
    EXPECT_TRUE(fs::exists(scratch / "run" / name)) << name;
}

}  // namespace
}  // namespace hexaplast
