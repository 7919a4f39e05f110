// SPDX-License-Identifier: LGPL-2.1-or-later
// The directory of a run belongs to one program at a time, and what is in it stays until all else is known to be well.
#include <fcntl.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/bar_scene.hpp"
#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

class RunDirectory : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("bar.scn", kPulledBar);
  }

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
            "plot.svg removed.csv report.html viewer.json ");
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
