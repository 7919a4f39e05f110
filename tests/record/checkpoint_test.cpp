// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/checkpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "formats/line_file.hpp"
#include "hexaplast/base/error.hpp"
#include "record/files.hpp"
#include "record/time_series.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"

namespace hexaplast::output {
namespace {

using namespace support;

/// What is saved into an archive.
template <class Save>
std::vector<std::byte> saved(const Save& save) {
  std::vector<std::byte> bytes;
  Archive archive([&](const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
  });
  save(archive);
  return bytes;
}

class CheckpointFile : public testing::Test {
 protected:
  fs::path file(const std::string& name) const { return directory_ / name; }
  std::string read(const std::string& name) const { return content(file(name)); }
  void write(const std::string& name, const std::string& text) const { put(file(name), text); }

  void write_checkpoint(long step, double value = 1.5) const {
    std::vector<int> numbers = {3, 1, 4};
    std::string word = "grip";
    const CheckpointSection sections[] = {{"scene", [&](Archive& archive) { archive(value, numbers); }},
                                          {"output", [&](Archive& archive) { archive(word); }}};
    output::write_checkpoint(directory_.path(), step, 0x1234567890abcdef, sections);
  }

  const Scratch directory_;
};

TEST_F(CheckpointFile, IsReadAsItWasWritten) {
  write_checkpoint(40, 2.25);
  const Checkpoint checkpoint(file("checkpoint_000000040.hxc"));
  EXPECT_EQ(checkpoint.scene_hash(), 0x1234567890abcdefu);
  Archive scene = checkpoint.section("scene"), output = checkpoint.section("output");
  double value = 0;
  std::vector<int> numbers;
  std::string word;
  scene(value, numbers);
  output(word);
  EXPECT_EQ(value, 2.25);
  EXPECT_EQ(numbers, (std::vector<int>{3, 1, 4}));
  EXPECT_EQ(word, "grip");
  EXPECT_EQ(scene.rest() + output.rest(), 0u);
  EXPECT_THROW(checkpoint.section("run"), InputError);
}

// record/checkpoint.hpp has the format, byte by byte
TEST_F(CheckpointFile, HasTheDocumentedLayout) {
  write_checkpoint(1);
  const std::string bytes = read("checkpoint_000000001.hxc");
  ASSERT_EQ(bytes.size(), 32u + (8 + 8 + 8 + 8 + 12 + 8) + (8 + 8 + 8 + 4 + 8));
  EXPECT_EQ(bytes.substr(0, 8), std::string("HXPCKPT\0", 8));
  EXPECT_EQ(bytes.substr(8, 8), std::string("\23\0\0\0\2\0\0\0", 8));
  EXPECT_EQ(bytes.substr(16, 8), "\xef\xcd\xab\x90\x78\x56\x34\x12");
  EXPECT_EQ(bytes.substr(32, 16), std::string("scene\0\0\0\x1c\0\0\0\0\0\0\0", 16));
}

TEST_F(CheckpointFile, TheNewestTwoAreKept) {
  for (const long step : {5, 10, 15, 100, 20}) write_checkpoint(step);
  std::vector<std::string> names;
  for (const fs::path& path : checkpoints_in(directory_.path())) names.push_back(path.filename());
  EXPECT_EQ(names, (std::vector<std::string>{"checkpoint_000000100.hxc", "checkpoint_000000020.hxc"}));
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_.path()), {}), 2) << "nothing is left beside them";
}

TEST_F(CheckpointFile, EveryDamagedByteIsFound) {
  write_checkpoint(1);
  const std::string bytes = read("checkpoint_000000001.hxc");
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int bit : {0, 7}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      write("damaged", damaged);
      EXPECT_THROW(Checkpoint(file("damaged")), InputError) << "byte " << i;
    }
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    write("damaged", bytes.substr(0, size));
    EXPECT_THROW(Checkpoint(file("damaged")), InputError) << size << " bytes";
  }
  write("damaged", bytes + '\0');
  EXPECT_THROW(Checkpoint(file("damaged")), InputError);
}

TEST_F(CheckpointFile, SaysWhatIsWrong) {
  const auto refusal = [&](const std::string& text) {
    write("other", text);
    return error_of<InputError>([&] { Checkpoint(file("other")); });
  };
  write_checkpoint(1);
  std::string bytes = read("checkpoint_000000001.hxc");
  EXPECT_TRUE(has(refusal(bytes.substr(0, 50)), "other is damaged: "));
  EXPECT_TRUE(has(refusal("step,time,kinetic_energy"), "other is no checkpoint"));
  EXPECT_TRUE(has(refusal(""), "other is no checkpoint"));
  bytes[8] = 1;
  EXPECT_TRUE(has(refusal(bytes), "other has format version 1, must be 19"));
  EXPECT_THROW(Checkpoint(file("nowhere")), OutputError);
}

// Of a series, a checkpoint may name its own states alone.
TEST_F(CheckpointFile, ASeriesHasTimesAndItsOwnNames) {
  const auto read_back = [&](double time, std::string name) {
    std::uint64_t count = 1;
    const std::vector<std::byte> bytes = saved([&](Archive& archive) { archive(count, time, name); });
    Archive back{std::span<const std::byte>(bytes)};
    output::TimeSeries(file("mesh.pvd")).serialize(back);
  };
  EXPECT_NO_THROW(read_back(0.5, "mesh_000012.vtu"));
  for (const char* name : {"surface_000012.vtu", "../mesh_000012.vtu", "mesh_1.vtu\"/><x a=\"", "mesh_.vtu", ""})
    EXPECT_THROW(read_back(0.5, name), InputError) << name;
  for (const double time : {std::nan(""), HUGE_VAL})
    EXPECT_THROW(read_back(time, "mesh_000012.vtu"), InputError) << time;
}

TEST_F(CheckpointFile, LinesGoOnWhereTheyWere) {
  std::vector<std::byte> bytes;
  {
    LineFile lines(file("lines"));
    lines.append("a\nb");
    bytes = saved([&](Archive& archive) { lines.save(archive); });
    lines.append("c");
  }
  ASSERT_EQ(read("lines"), "a\nb\nc\n");
  {
    Archive back{std::span<const std::byte>(bytes)};
    LineFile lines(file("lines"), back);
    EXPECT_EQ(read("lines"), "a\nb\nc\n") << "whether the run can go on is not known yet";
    lines.cut();
    EXPECT_EQ(read("lines"), "a\nb\n");
    lines.append("d");
  }
  EXPECT_EQ(read("lines"), "a\nb\nd\n");

  for (const char* text : {"a\n", "a\nB\nd\n", ""}) {
    write("lines", text);
    Archive back{std::span<const std::byte>(bytes)};
    EXPECT_THROW(LineFile(file("lines"), back), InputError) << text;
    EXPECT_EQ(read("lines"), text);
  }
}

}  // namespace
}  // namespace hexaplast::output
