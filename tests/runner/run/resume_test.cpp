// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast resume: a run that stops, however it stops, and goes on, against one that does not. The directory of a run
// belongs to one program at a time, and what is in it stays until all else is known to be well.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <thread>

#include "hexaplast/base/hash.hpp"
#include "support/bar_scene.hpp"
#include "support/command.hpp"
#include "support/csv.hpp"

namespace {

using namespace hexaplast::support;

// A bar with a triangle in it, pulled until it flows and tears, while a tool holds it.
const std::string kTearingBar =
    "<Node name='root' gravity='0 0 -9.81' dt='0.02'>\n<DefaultAnimationLoop/><RunSettings steps='40' outputEvery='8'/>"
    "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.01'/><CGLinearSolver iterations='60'/>"
    "<RegularGridTopology n='3 2 5' max='0.2 0.1 0.4'/><MechanicalObject/><DiagonalMass massDensity='1000'/>"
    "<HexahedronElastoplasticFEMForceField name='body' youngModulus='2e4' poissonRatio='0.3' yieldStress='500' "
    "plasticFlowRate='4' hardening='0.1' fractureStretch='1.02'/>"
    "<FixedProjectiveConstraint indices='24-29'/>"
    "<SpringForceField spring='0 20 3 .1 .05'/><GraspForceField radius='0.12' keyTimes='0 0.3' positions='.1 .05 0  .2 "
    ".05 -.2' graspTime='0.06' "
    "releaseTime='0.5' stiffness='300' maxForce='12'/><Node name='skin'><OglModel position='.05 .02 .1  .15 .02 .1  "
    ".1 .08 .3' triangles='0 1 2'/><BarycentricMapping/></Node>"
    "<BladeController points='0 -1 0  0 1 0' keyTimes='0 0.08' positions='-.1 0 .3  .12 0 .3'/></Node>";

class Resume : public Command {
 protected:
  Resume() { write("bar.scn", kTearingBar); }

  /// But for wall times.
  void expect_same_run(const std::string& resumed, const std::string& straight) const {
    const Csv history(read(resumed + "/history.csv")), expected(read(straight + "/history.csv"));
    EXPECT_EQ(history.columns(), expected.columns());
    for (const std::string& column : expected.columns())
      if (column != "step_ms") {
        EXPECT_EQ(history.numbers(column), expected.numbers(column)) << column;
      }
    const auto files = files_in(directory_ / resumed), expected_files = files_in(directory_ / straight);
    EXPECT_EQ(files.size(), expected_files.size());
    for (const auto& [name, bytes] : expected_files) {
      ASSERT_TRUE(files.contains(name)) << name;
      if (name.ends_with(".vtu") || name.ends_with(".pvd") || name == "removed.csv" || name == "opened.csv") {
        EXPECT_TRUE(files.at(name) == bytes) << name;
      }
    }
  }
};

TEST_F(Resume, GoesOnBitForBitAndWritesTheSameFiles) {
  const Outcome straight = succeeds("run bar.scn --out straight --frames 0 --checkpoint every=15 --threads 1");
  ASSERT_TRUE(has(straight.out, "removed ")) << "the case is to tear\n";
  EXPECT_TRUE(has(straight.out, "connected parts "));
  EXPECT_TRUE(has(straight.out, "opened "));

  // 20 steps, the last of them at no output: a run of 40 would not write it
  succeeds("run bar.scn --out resumed --frames 0 --checkpoint every=15 --steps 20 --threads 2");
  const Outcome resumed = succeeds("resume resumed --steps 40 --threads 3 --final last.json");
  EXPECT_EQ(hash_in(resumed), hash_in(straight));
  EXPECT_TRUE(is_there("last.json"));
  expect_same_run("resumed", "straight");
}

TEST_F(Resume, CutsWhatTheRunHadWrittenAfterItsCheckpoint) {
  succeeds("run bar.scn --out straight --frames 0 --checkpoint every=30");
  succeeds("run bar.scn --out resumed --frames 0 --checkpoint every=30");
  EXPECT_EQ(hexaplast("resume resumed").code, 2) << "all steps are done";
  const Outcome resumed = succeeds("resume resumed/checkpoint_000000030.hxc");
  expect_same_run("resumed", "straight");
}

TEST_F(Resume, FromAnotherPlaceFindsItsScene) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 10 --set root/body.hardening=0.2");
  fs::create_directory(directory_ / "elsewhere");
  const Outcome resumed = shell("cd elsewhere && '" HEXAPLAST_COMMAND "' resume ../run --steps 12 --final last.json");
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_TRUE(is_there("elsewhere/last.json"));
}

// ResumeOfAStranger has what belongs to something else.
TEST_F(Resume, WhatIsDamagedIsRefusedWithTheNextOne) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 25");
  const std::string history = read("run/history.csv");
  std::string bytes = read("run/checkpoint_000000025.hxc");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  write("run/checkpoint_000000025.hxc", bytes);
  const Outcome refused =
      fails("resume run --steps 40", 3, "hexaplast: error: run/checkpoint_000000025.hxc is damaged");
  EXPECT_TRUE(has(refused.err, "\n  hint: there is another one, run/checkpoint_000000020.hxc\n"));
  EXPECT_EQ(read("run/history.csv"), history);
  succeeds("resume run/checkpoint_000000020.hxc --steps 40");
  fs::create_directory(directory_ / "empty");
  EXPECT_EQ(hexaplast("resume empty").code, 5);
}

/// A directory that a stranger has made: a scene in it that needs a plugin, which lies there too, and a checkpoint.
class ResumeOfAStranger : public Resume {
 protected:
  void SetUp() override {
    fs::create_directories(directory_ / "theirs/plugins");
    fs::create_directories(directory_ / "mine");
    for (const char* place : {"theirs", "theirs/plugins", "mine"})
      fs::copy_file(HEXAPLAST_PLANTED_PLUGIN, directory_ / place / "libPlanted.so");
    std::string text = kTearingBar;
    text.insert(text.find("<RunSettings"), "<RequiredPlugin pluginName='Planted'/>");
    write("theirs/bar.scn", text);
    const Outcome run = succeeds(
        "run theirs/bar.scn --out theirs --frames 0 --steps 20 --checkpoint every=10 --plugin-path "
        "theirs/plugins --final victim.json --summary victim.txt");
    ASSERT_TRUE(is_there("planted_code_has_run")) << "loading it does no harm that could be seen";
    for (const char* file : {"planted_code_has_run", "theirs/planted_code_has_run"}) fs::remove(directory_ / file);
    for (const char* file : {"victim.json", "victim.txt"}) write(file, "mine");
  }

  /// A resume of theirs is refused, before any code of theirs runs.
  void expect_harmless(const std::string& options, int code, const std::string& message,
                       const std::string& before = "") {
    fails("resume " + options, code, message, before);
    for (const auto& [name, bytes] : files_in(directory_)) EXPECT_FALSE(has(name, "planted_code_has_run")) << options;
    for (const char* file : {"victim.json", "victim.txt"}) EXPECT_EQ(read(file), "mine") << options;
  }

  /// Replaces some bytes in the section `run` of the newest checkpoint, by as many others, and mends the checksum.
  void forge(const std::string& what, const std::string& by) {
    ASSERT_EQ(what.size(), by.size());
    std::string bytes = read(kNewest);
    const std::size_t head = 8 + 4 + 4 + 8 + 8;
    ASSERT_EQ(bytes.substr(head, 4), std::string("run\0", 4));
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + head + 8, 8);
    const std::size_t at = bytes.find(what, head + 16);
    ASSERT_LT(at, head + 16 + size) << what;
    bytes.replace(at, what.size(), by);
    hexaplast::StateHash hash;
    hash.add(bytes.data() + head, 16 + size);
    const std::uint64_t checksum = hash.value();
    std::memcpy(bytes.data() + head + 16 + size, &checksum, 8);
    write(kNewest, bytes);
  }

  static constexpr const char* kNewest = "theirs/checkpoint_000000020.hxc";
};

// The run that the stranger carried out knew the plugin's folder and wrote files elsewhere: that was the stranger's
// will.
TEST_F(ResumeOfAStranger, LoadsNothingFromTheRunsDirectoryAndWritesNothingElsewhere) {
  const std::string missing = "there is no Planted.so or libPlanted.so", below = "from which nothing is loaded";
  expect_harmless("theirs --steps 40", 6, missing);
  expect_harmless(". --steps 40", 6, missing, "cd theirs &&");
  fs::create_directory_symlink("theirs", directory_ / "link");
  fs::create_directory_symlink("../theirs/plugins", directory_ / "mine/link");
  fs::create_directory(directory_ / "linked");
  fs::create_symlink("../theirs/libPlanted.so", directory_ / "linked/libPlanted.so");
  for (const std::string path : {"theirs", "theirs/plugins", "./mine/../theirs", "link", "mine/link", "linked"})
    for (const std::string run : {"theirs", "link"})
      expect_harmless(run + " --steps 40 --plugin-path " + path, 6, below);
  expect_harmless(". --steps 40 --plugin-path .", 6, below, "cd theirs &&");
  expect_harmless(". --steps 40 --plugin-path plugins", 6, below, "cd theirs && LD_LIBRARY_PATH=.");

  // the same plugin from where the user has it
  succeeds("resume theirs --steps 40 --plugin-path mine --final last.json --summary last.txt");
  EXPECT_TRUE(is_there("planted_code_has_run")) << "the working directory is the user's";
  for (const char* file : {"last.json", "last.txt"}) EXPECT_TRUE(is_there(file)) << file;
  for (const char* file : {"victim.json", "victim.txt"}) EXPECT_EQ(read(file), "mine");
}

// With the plugin where it may be loaded from: whatever else is wrong is found before.
TEST_F(ResumeOfAStranger, LoadsNothingBeforeEverythingIsChecked) {
  const std::string theirs = "theirs --plugin-path mine ", further = theirs + "--steps 40 ";
  expect_harmless(theirs, 2, "has all 20 steps of the run already");
  expect_harmless(further + "--final nowhere/last.json", 5, "nowhere/last.json.part: cannot be created");
  for (const char* input : {"theirs/bar.scn", kNewest}) expect_harmless(further + "--final " + input, 5, "is an input");
  expect_harmless(theirs + "--steps x", 2, "--steps");

  const std::string scene = read("theirs/bar.scn"), bytes = read(kNewest);
  std::string early = bytes, damaged = bytes;
  early[8] = 1;  // the format of which told where to look for plugins
  damaged[100] = static_cast<char>(damaged[100] ^ 1);
  for (const auto& [file, text, message] :
       {std::tuple<std::string, std::string, std::string>{"theirs/history.csv", "step,time\n",
                                                          "history.csv does not begin with"},
        {"theirs/bar.scn", replaced(scene, "2e4", "3e4"), "is of another scene"},
        {kNewest, early, "has format version 1, must be " + std::to_string(bytes[8])},
        {kNewest, damaged, "is damaged"}}) {
    const std::string before = read(file);
    write(file, text);
    expect_harmless(further, 3, message);
    EXPECT_EQ(read(file), text);
    write(file, before);
  }
}

TEST_F(ResumeOfAStranger, AForgedRecordIsRefusedOrHarmless) {
  const auto number = [](std::int64_t value) { return std::string(reinterpret_cast<const char*>(&value), 8); };
  const std::string further = "theirs --plugin-path mine --steps 40", given(1, 1), sound = read(kNewest);
  for (const auto& [from, to] : {std::pair{10, 0}, {20, -20}}) {
    forge(given + number(from), given + number(to));
    expect_harmless(further, 3, "is damaged");
    write(kNewest, sound);
  }

  // another scene in its place, whose text is not the one of the run
  write("theirs/baz.scn", kTearingBar);
  const std::string path = (directory_ / "theirs/bar.scn").string();
  forge(path, path.substr(0, path.size() - 7) + "baz.scn");
  expect_harmless(further, 3, "is of another scene");
}

TEST_F(Resume, FollowsNoLinkOutOfTheRunsDirectory) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 20");
  fs::create_directory(directory_ / "elsewhere");
  write("elsewhere/frame_000001.png", "mine");
  for (const char* name :
       {"mesh.pvd", "report.html", "manifest.json", "mesh_000040.vtu", "mesh_000024.vtu.part", "surface.pvd"}) {
    write(std::string("elsewhere/") + name, "mine");
    fs::remove(directory_ / "run" / name);
    fs::create_symlink(directory_ / "elsewhere" / name, directory_ / "run" / name);
  }
  fs::create_directory_symlink(directory_ / "elsewhere", directory_ / "run/frames");
  fails("resume run --steps 40", 5, "run/frames: is a symbolic link");
  fs::remove(directory_ / "run/frames");
  succeeds("resume run --steps 40");
  for (const auto& [name, bytes] : files_in(directory_ / "elsewhere")) EXPECT_EQ(bytes, "mine") << name;

  const std::string history = read("run/history.csv");
  write("elsewhere/history.csv", history);
  fs::remove(directory_ / "run/history.csv");
  fs::create_symlink(directory_ / "elsewhere/history.csv", directory_ / "run/history.csv");
  EXPECT_EQ(hexaplast("resume run --steps 60").code, 5);
  EXPECT_EQ(read("elsewhere/history.csv"), history);
}

// Below the run's directory, and so below that of a stranger; a link of the user's own leads where it leads.
TEST_F(Resume, NamedFilesFollowNoLinkOfTheRunsDirectory) {
  const std::string run = "run bar.scn --out run --frames 0 --checkpoint every=10 --steps 20",
                    followed = "is a symbolic link, which is not followed";
  succeeds(run);
  for (const char* folder : {"elsewhere", "run/sub"}) fs::create_directory(directory_ / folder);
  write("elsewhere/last.json", "mine");
  fs::create_symlink("../elsewhere/last.json", directory_ / "run/last.json");
  fs::create_symlink("../../elsewhere/new.json", directory_ / "run/sub/last.json");
  fs::create_directory_symlink("../elsewhere", directory_ / "run/away");
  fs::create_directory_symlink("run", directory_ / "same");
  for (const std::string option : {"--final ", "--summary "})
    for (const std::string name : {"run/last.json", "run/sub/last.json", "run/away/last.json", "run/away/new.json",
                                   "same/last.json", "same/sub/../away/last.json", "run/away/../run/last.json"})
      for (const std::string& command : {std::string("resume run --steps 40 "), run + " --force "})
        fails(command + option + name, 5, followed);
  EXPECT_EQ(read("elsewhere/last.json"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_ / "elsewhere"), {}), 1);

  // other commands that write where a run is
  for (const std::string command : {"render run --out run/last.png", "compare run run --out run/last.html"}) {
    fs::create_symlink("../elsewhere/last.json", directory_ / command.substr(command.find("run/")));
    fails(command, 5, followed);
  }
  EXPECT_EQ(read("elsewhere/last.json"), "mine");

  fs::create_symlink("elsewhere/last.json", directory_ / "mine.json");
  succeeds("resume same --steps 40 --final mine.json --summary same/sub/summary.json");
  EXPECT_NE(read("elsewhere/last.json"), "mine");
  EXPECT_TRUE(is_there("run/sub/summary.json"));
}

// A file of the run with another name elsewhere would change there too.
TEST_F(Resume, WritesIntoNoFileThatHasOtherNames) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 20");
  for (const std::string name : {"history.csv", "removed.csv"}) {
    const fs::path file = directory_ / "run" / name;
    write("victim", content(file) + "mine\n");
    fs::rename(file, directory_ / "kept");
    fs::create_hard_link(directory_ / "victim", file);
    fails("resume run --steps 40", 5, "has other names, which would change with it");
    EXPECT_EQ(read("victim"), read("kept") + "mine\n") << name;
    fs::remove(directory_ / "victim");
    fs::rename(directory_ / "kept", file);
  }
  succeeds("resume run --steps 40");
}

class RunDirectory : public Command {
 protected:
  RunDirectory() { write("bar.scn", kPulledBar); }

  /// Runs the bar into `run` for ever, looks on as soon as some steps are written, and ends it by a signal.
  int end_by(int signal, const std::string& options, const std::function<void()>& meanwhile) {
    fs::remove_all(directory_ / "run");
    const pid_t child = fork();
    if (child == 0) {
      if (::chdir(directory_.c_str()) != 0) std::_Exit(99);
      const int messages = ::open("messages", O_WRONLY | O_CREAT | O_TRUNC, 0600);
      ::dup2(messages, 1);
      ::dup2(messages, 2);
      const std::string line =
          "exec '" HEXAPLAST_COMMAND
          "' run bar.scn --out run --frames 0 --steps 1000000000 --set settings.outputEvery=1000 " +
          options;
      ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      std::_Exit(99);
    }
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    const auto has_begun = [&] {
      const std::string history = read("run/history.csv");
      return std::ranges::count(history, '\n') > 5;
    };
    while (!has_begun() && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ::kill(child, SIGSTOP);  // on a busy machine it would come to its end meanwhile
    meanwhile();
    ::kill(child, signal);
    ::kill(child, SIGCONT);
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  long newest_checkpoint() const {
    long newest = -1;
    for (const auto& [name, bytes] : files_in(directory_ / "run"))
      if (name.ends_with(".hxc")) newest = std::max(newest, std::stol(name.substr(name.find_first_of("0123456789"))));
    return newest;
  }
};

TEST_F(RunDirectory, IsOneProgramsAtATime) {
  const int code = end_by(SIGKILL, "--checkpoint every=2", [&] {
    for (const char* second : {"resume run", "run bar.scn --out run --force", "run bar.scn --out run/../run",
                               "sweep bar.scn --out run --vary bar/material.hardening=0:1:2"})
      expect_refused({{second, 5, "another run or sweep is at work there"}});
  });
  EXPECT_EQ(code, -SIGKILL);
  EXPECT_EQ(manifest().at("state"), "running");
  EXPECT_EQ(manifest().at("steps").at("done"), 0);
  EXPECT_FALSE(is_there("run/report.html"));

  // nothing keeps the next one out, neither this program's lock nor a file that it left
  const long steps = newest_checkpoint() + 3;
  const Outcome resumed = succeeds("resume run --steps " + std::to_string(steps));
  EXPECT_EQ(hash_in(resumed), hash_in(hexaplast("run bar.scn --steps " + std::to_string(steps))));
  succeeds("run bar.scn --out run --frames 0 --force");
  fs::create_directory(directory_ / "new");
  succeeds("run bar.scn --out new --frames 0");
  std::string names;
  for (const auto& [name, bytes] : files_in(directory_ / "new")) names += name + " ";
  EXPECT_EQ(names,
            "history.csv manifest.json mesh.pvd mesh_000000.vtu mesh_000002.vtu mesh_000004.vtu mesh_000006.vtu "
            "removed.csv report.html viewer.json ");
}

TEST_F(RunDirectory, ASignalAlwaysLeavesACheckpoint) {
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EQ(end_by(signal, "", [] {}), 128 + signal);
    EXPECT_TRUE(has(read("messages"), "; hexaplast resume run continues it\n"));
    ASSERT_GE(newest_checkpoint(), 4);
    EXPECT_EQ(manifest().at("state"), "interrupted");
    EXPECT_EQ(manifest().at("exit_reason"), "Ended by signal " + std::to_string(signal));
    EXPECT_EQ(manifest().at("steps").at("done"), newest_checkpoint());
    EXPECT_TRUE(has(read("messages"), "state hash"));
    const std::string steps = std::to_string(newest_checkpoint() + 5);
    const Outcome resumed = succeeds("resume run --steps " + steps);
    EXPECT_EQ(hash_in(resumed), hash_in(hexaplast("run bar.scn --steps " + steps)));
  }
}

TEST_F(RunDirectory, ARunOfNoStepsLeavesTheCheckpointThatIsAskedFor) {
  succeeds("run bar.scn --out run --frames 0 --steps 0 --checkpoint every=1");
  EXPECT_EQ(newest_checkpoint(), 0);
  const Outcome resumed = succeeds("resume run --steps 6");
  EXPECT_EQ(hash_in(resumed), hash_in(hexaplast("run bar.scn")));
}

TEST_F(RunDirectory, StaysAsItIsUntilAllFilesAreKnownToBeWritable) {
  succeeds("run bar.scn --out run --frames 1 --checkpoint every=2");
  const auto before = files_in(directory_ / "run");
  ASSERT_GE(before.size(), 11u);
  for (const char* refused : {"resume run --steps 9 --final nowhere/last.json",
                              "resume run/checkpoint_000000004.hxc --final nowhere/last.json",
                              "run bar.scn --out run --force --final nowhere/last.json",
                              "run bar.scn --out run --force --summary nowhere/last.json"}) {
    fails(refused, 5, "nowhere/last.json.part: cannot be created");
    EXPECT_TRUE(files_in(directory_ / "run") == before) << refused;
  }
}

TEST_F(RunDirectory, NoTableIsCutWhenTheOtherOneIsForeign) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=2");
  write("run/removed.csv", "");
  const auto before = files_in(directory_ / "run");
  fails("resume run/checkpoint_000000004.hxc", 3, "removed.csv does not begin with");
  EXPECT_TRUE(files_in(directory_ / "run") == before);
}

TEST_F(RunDirectory, AStateThatIsGoneIsLeftOutAndSaid) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=3 --steps 3");
  fs::remove(directory_ / "run/mesh_000002.vtu");
  const Outcome resumed = succeeds("resume run --steps 6");
  EXPECT_TRUE(has(resumed.err, "mesh_000002.vtu is gone: its .pvd file no longer names it\n"));
  const std::string series = read("run/mesh.pvd");
  EXPECT_FALSE(has(series, "mesh_000002.vtu") || is_there("run/mesh_000002.vtu"));
  for (const std::string name : {"mesh_000000.vtu", "mesh_000004.vtu", "mesh_000006.vtu"})
    EXPECT_TRUE(has(series, name) && is_there("run/" + name)) << name;
}

}  // namespace
