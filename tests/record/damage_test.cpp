// SPDX-License-Identifier: LGPL-2.1-or-later
// Directories and disks that do not take a run: what stood there stays, and what was written can be read.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <cstring>

#include "formats/line_file.hpp"
#include "hexaplast/base/error.hpp"
#include "record/checkpoint.hpp"
#include "record/files.hpp"
#include "record/manifest.hpp"
#include "record/time_series.hpp"
#include "support/compare.hpp"
#include "support/files.hpp"
#include "support/vtu_reader.hpp"

namespace hexaplast {
namespace {

using namespace support;
using namespace output;

TEST(WholeFile, ReplacesFilesAndLinksAlone) {
  const Scratch scratch;
  const fs::path pipe = scratch / "pipe", file = scratch / "file", link = scratch / "link";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(WholeFile{pipe}, OutputError);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_THROW(WholeFile{scratch / "."}, OutputError);

  std::ofstream(file) << "before";
  fs::create_symlink(file, link);
  {
    WholeFile out(link);
    out.write("after");
    EXPECT_EQ(content(link), "before");
    out.commit();
  }
  EXPECT_EQ(content(file), "before") << "what the link led to is not touched";
  EXPECT_EQ(content(link), "after");
  EXPECT_FALSE(fs::is_symlink(link));

  // but a name on a command line stands for what it leads to
  fs::remove(link);
  fs::create_symlink(file, link);
  EXPECT_EQ(output_place(link), fs::canonical(file));
  EXPECT_EQ(output_place(file), file);
}

TEST(WholeFile, IsWrittenIntoANewPartAlone) {
  const Scratch scratch;
  const fs::path file = scratch / "file", part = scratch / "file.part", victim = scratch / "victim";
  put(victim, "mine");

  // a file that has the name is somebody's
  put(part, "mine");
  EXPECT_THROW(WholeFile{file}, OutputError);
  EXPECT_EQ(content(part), "mine");
  fs::remove(part);

  // what a killed run has left is taken away, not filled: another name of it keeps its content
  if (const pid_t killed = fork(); killed == 0) {
    WholeFile out(file);
    std::_Exit(0);
  } else {
    ::waitpid(killed, nullptr, 0);
  }
  fs::create_hard_link(part, scratch / "left");
  put(scratch / "left", "mine");
  {
    WholeFile out(file);
    EXPECT_FALSE(fs::equivalent(scratch / "left", part));
    out.write("new");
    EXPECT_THROW(WholeFile{file}, OutputError) << "somebody is writing it";
    EXPECT_TRUE(fs::exists(part));
    out.commit();
  }
  EXPECT_EQ(content(scratch / "left"), "mine");
  EXPECT_EQ(content(file), "new");
  std::ofstream(scratch / "plain") << "new";
  EXPECT_EQ(fs::status(file).permissions(), fs::status(scratch / "plain").permissions()) << "as any file has them";

  put(victim, "mine");
  for (const fs::path& target : {victim, scratch / "nothing"}) {
    fs::create_symlink(target, part);
    EXPECT_THROW(WholeFile{file}, OutputError);
    EXPECT_TRUE(fs::is_symlink(part));
    fs::remove(part);
  }
  EXPECT_EQ(content(victim), "mine");
  EXPECT_FALSE(fs::exists(scratch / "nothing"));

  // exchanged on the way
  WholeFile out(file);
  out.write("newer");
  fs::remove(part);
  fs::create_symlink(victim, part);
  EXPECT_THROW(out.commit(), OutputError);
  EXPECT_EQ(content(file), "new");
  EXPECT_EQ(content(victim), "mine");
}

TEST(InputFiles, AreKnownWhateverTheirNames) {
  const Scratch scratch;
  put(scratch / "scene", "text");
  fs::create_symlink(scratch / "scene", scratch / "link");
  fs::create_hard_link(scratch / "scene", scratch / "other");
  put(scratch / "copy", "text");
  const InputFiles inputs({scratch / "link", scratch / "absent"});
  for (const char* name : {"scene", "link", "other", "./scene"}) {
    EXPECT_EQ(inputs.replaced_by(scratch / name), scratch / name);
    EXPECT_THROW(output_place(scratch / name, inputs), OutputError);
  }
  for (const char* name : {"copy", "absent"}) EXPECT_EQ(inputs.replaced_by(scratch / name), fs::path()) << name;

  // an unfinished file takes a place too
  fs::create_hard_link(scratch / "scene", scratch / "copy.part");
  EXPECT_EQ(inputs.replaced_by(scratch / "copy"), scratch / "copy.part");
  EXPECT_THROW(output_place(scratch / "copy", inputs), OutputError);
  fs::create_symlink(scratch / "copy", scratch / "elsewhere");
  EXPECT_THROW(output_place(scratch / "elsewhere", inputs), OutputError);
  fs::create_symlink(scratch / "new.part", scratch / "astray");
  for (const char* name : {"new.part", "astray"}) EXPECT_THROW(output_place(scratch / name), OutputError) << name;
}

TEST(ManifestFile, OfMoreThanOneMayKeepIsRefused) {
  const Scratch scratch;
  const fs::path file = scratch / "manifest.json";
  const auto refusal = [&](const std::string& text) {
    put(file, text);
    return error_of<OutputError>([&] { output::read_manifest(fs::path(scratch / "")); });
  };
  for (const std::string& text : {repeated("[", 100) + repeated("]", 100), "[" + repeated("0,", 999'998) + "0]"})
    EXPECT_TRUE(has(refusal(text), "is no manifest of a run") && !has(refusal(text), "a million values"));
  for (const std::string& text : {repeated("[", 101) + repeated("]", 101), "[" + repeated("0,", 1'000'000) + "0]",
                                  repeated("[", 5'000'000), "[" + repeated("[],", 1'000'000) + "0]"})
    EXPECT_TRUE(has(refusal(text), "more than a million values"));
  EXPECT_TRUE(has(refusal("[1"), "parse error"));
}

TEST(LineFile, IsItsOwnAndFollowsNoLink) {
  const Scratch scratch;
  put(scratch / "mine", "mine");
  EXPECT_THROW(LineFile(scratch / "mine"), OutputError);
  EXPECT_EQ(content(scratch / "mine"), "mine");
  put(scratch / "victim", "mine");
  fs::create_symlink(scratch / "victim", scratch / "history.csv");
  EXPECT_THROW(LineFile(scratch / "history.csv"), OutputError);
  std::vector<std::byte> nothing(16);  // no bytes, and their checksum
  StateHash hash;
  const std::uint64_t checksum = hash.value();
  std::memcpy(nothing.data() + 8, &checksum, 8);
  Archive saved{std::span<const std::byte>(nothing)};
  EXPECT_THROW(LineFile(scratch / "history.csv", saved), OutputError);
  EXPECT_EQ(content(scratch / "victim"), "mine");
}

TEST(LineFile, LosesNoLineSilently) {
  const Scratch scratch;
  LineFile lines(scratch / "lines");
  lines.append("1");
  fs::rename(scratch / "lines", scratch / "moved");
  lines.append("2");
  EXPECT_EQ(content(scratch / "moved"), "1\n2\n");
  fs::remove(scratch / "moved");
  EXPECT_TRUE(refuses<OutputError>([&] { lines.append("3"); }, {"lines: has been taken away"}));
}

TEST(LineFile, SaysTheReasonOfTheSystem) {
  const Scratch scratch;
  for (const auto& [name, reason] : {std::pair(std::string(300, 'n'), "File name too long"),
                                     {std::string("nowhere/lines"), "No such file or directory"}})
    EXPECT_TRUE(refuses<OutputError>([&, name = name] { LineFile{scratch / name}; },
                                     {name, std::string("cannot be opened for writing: ") + reason}));
}

// `--final /dev/stdout >> log`: the log would be replaced.
TEST(OutputPlace, IsNothingThatIsOpen) {
  const Scratch scratch;
  put(scratch / "log", "mine");
  const int log = ::open((scratch / "log").c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  const std::string open_file = "/proc/self/fd/" + std::to_string(log);
  fs::create_symlink(open_file, scratch / "link");
  for (const fs::path& name : {fs::path(open_file), scratch / "link", fs::path("/dev/fd") / std::to_string(log)})
    EXPECT_TRUE(refuses<OutputError>([&] { output_place(name); }, {name.string(), "to what is open"}));
  ::close(log);
  EXPECT_EQ(output_place("/dev/null"), "/dev/null");  // refused as no regular file when it is opened

  fs::create_symlink("circle", scratch / "circle");
  EXPECT_THROW(output_place(scratch / "circle"), OutputError);
  fs::create_symlink("there", scratch / "first");
  fs::create_symlink("first", scratch / "second");
  EXPECT_EQ(output_place(scratch / "second"), fs::canonical(scratch / "") / "there") << "where nothing is yet";
}

TEST(Directory, OfAnEarlierRunIsLeftAloneUnlessForced) {
  const Scratch scratch;
  Body body = yielding_block();
  fs::create_directories(scratch / "run/frames");
  for (const char* name : {"history.csv", "removed.csv", "mesh.pvd", "mesh_000300.vtu", "mesh_000300.vtu.part",
                           "surface.pvd", "surface_000300.vtu", "instruments.pvd", "instruments_000300.vtu",
                           "springs.pvd", "springs_000300.vtu", "frames/frame_000300.png", "manifest.json",
                           "report.html", "viewer.json", "notes.txt", "mesh_fine.vtu", "frames/mine.png"})
    put(scratch / "run" / name, "earlier");
  const std::vector<std::string> before = names_in(scratch / "run");

  EXPECT_THROW(Recorder(scratch / "run", body, plan(2, 1)), OutputError);
  EXPECT_EQ(names_in(scratch / "run"), before);
  EXPECT_EQ(content(scratch / "run/history.csv"), "earlier");

  RunPlan run = plan(2, 2);
  run.force = true;
  Recorder recorder(scratch / "run", body, run);
  record_stretch(recorder, body, 2);
  recorder.finish();
  const std::vector<std::string> after{"frames",          "frames/mine.png", "history.csv",   "mesh.pvd",
                                       "mesh_000000.vtu", "mesh_000002.vtu", "mesh_fine.vtu", "notes.txt",
                                       "removed.csv",     "viewer.json"};
  EXPECT_EQ(names_in(scratch / "run"), after);
  EXPECT_EQ(content(scratch / "run/notes.txt"), "earlier");
}

TEST(Directory, WithAnInputALinkOrSomethingElseInAFilesPlaceIsRefusedEvenIfForced) {
  const Scratch scratch;
  const Body body = yielding_block();
  for (const char* folder : {"run", "elsewhere", "other/history.csv"}) fs::create_directories(scratch / folder);
  put(scratch / "run/mesh_000010.vtu", "the mesh of the scene");
  put(scratch / "elsewhere/frame_000001.png", "mine");
  RunPlan run = plan(1, 1);
  run.force = true;
  run.inputs.add(scratch / "run/mesh_000010.vtu");
  EXPECT_THROW(Recorder(scratch / "run", body, run), OutputError);
  EXPECT_EQ(names_in(scratch / "run"), std::vector<std::string>{"mesh_000010.vtu"});

  run.inputs = {};
  fs::create_directory_symlink(scratch / "elsewhere", scratch / "run/frames");
  EXPECT_THROW(Recorder(scratch / "run", body, run), OutputError);
  EXPECT_EQ(content(scratch / "elsewhere/frame_000001.png"), "mine");

  put(scratch / "other/mesh.pvd", "earlier");
  EXPECT_THROW(Recorder(scratch / "other", body, run), OutputError);
  EXPECT_EQ(content(scratch / "other/mesh.pvd"), "earlier");
}

/// Files cannot grow beyond a size, as on a full disk; writing fails instead of ending the program.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit lower{.rlim_cur = bytes, .rlim_max = limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &lower);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit limit_{};
  void (*handler_)(int) = nullptr;
};

TEST(FullDisk, IsReportedAtTheNextOutputAndWhatTheSeriesNamesStaysReadable) {
  Recorded run(plan(10, 1), 2);
  {
    const FullDisk full(5000);
    EXPECT_TRUE(refuses<OutputError>([&] { run.recorder.record({.step = 3, .time = 0.03}, run.x, run.x); },
                                     {std::strerror(EFBIG)}));
  }
  const auto series = series_in(run.scratch / "run");
  ASSERT_EQ(series.size(), 3u);
  EXPECT_EQ(read_with_meshio(run.scratch, series.back().second, {"points"}).at("points"), bytes_of(run.x));
  for (const std::string& name : names_in(run.scratch / "run")) EXPECT_FALSE(name.ends_with(".part")) << name;
}

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
  EXPECT_EQ(bytes.substr(8, 8), std::string("\24\0\0\0\2\0\0\0", 8));
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
  EXPECT_TRUE(has(refusal(bytes), "other has format version 1, must be 20"));
  EXPECT_THROW(Checkpoint(file("nowhere")), OutputError);
}

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
}  // namespace hexaplast
