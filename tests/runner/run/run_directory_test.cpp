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

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Outcome;

class RunDirectory : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("bar.scn", hexaplast::support::kPulledBar);
  }

  /// The files below a directory, with their bytes.
  std::map<std::string, std::string> files(const std::string& folder) const {
    std::map<std::string, std::string> all;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory_ / folder))
      if (entry.is_regular_file()) all[entry.path().lexically_relative(directory_).string()] = content(entry.path());
    return all;
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
      const std::string history = content(directory_ / "run/history.csv");
      return std::ranges::count(history, '\n') > 5;
    };
    while (!has_begun() && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    meanwhile();
    ::kill(child, signal);
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  nlohmann::json manifest() const { return nlohmann::json::parse(content(directory_ / "run/manifest.json")); }

  static std::string hash_in(const Outcome& outcome) {
    const std::size_t at = outcome.out.find("state hash");
    return at == outcome.out.npos ? outcome.err : outcome.out.substr(at, outcome.out.find('\n', at) - at);
  }

  long newest_checkpoint() const {
    long newest = -1;
    for (const auto& [name, bytes] : files("run"))
      if (name.ends_with(".hxc")) newest = std::max(newest, std::stol(name.substr(name.find_first_of("0123456789"))));
    return newest;
  }
};

TEST_F(RunDirectory, IsOneProgramsAtATime) {
  const int code = end_by(SIGKILL, "--checkpoint every=2", [&] {
    for (const char* second : {"resume run", "run bar.scn --out run --force", "run bar.scn --out run/../run",
                               "sweep bar.scn --out run --vary bar/material.hardening=0:1:2"}) {
      const Outcome refused = hexaplast(second);
      EXPECT_EQ(refused.code, 5) << second;
      EXPECT_NE(refused.err.find("another run or sweep is at work there"), std::string::npos) << refused.err;
      EXPECT_EQ(refused.out, "");
    }
  });
  EXPECT_EQ(code, -SIGKILL);
  EXPECT_EQ(manifest().at("state"), "running");
  EXPECT_EQ(manifest().at("steps").at("done"), 0);
  EXPECT_FALSE(fs::exists(directory_ / "run/report.html"));

  // nothing keeps the next one out, neither this program's lock nor a file that it left
  const long steps = newest_checkpoint() + 3;
  const Outcome resumed = succeeds("resume run --steps " + std::to_string(steps));
  EXPECT_EQ(hash_in(resumed), hash_in(hexaplast("run bar.scn --steps " + std::to_string(steps))));
  succeeds("run bar.scn --out run --frames 0 --force");
  fs::create_directory(directory_ / "new");
  succeeds("run bar.scn --out new --frames 0");
  std::string names;
  for (const auto& [name, bytes] : files("new")) names += name.substr(4) + " ";
  EXPECT_EQ(names,
            "history.csv manifest.json mesh.pvd mesh_000000.vtu mesh_000002.vtu mesh_000004.vtu mesh_000006.vtu "
            "plot.svg removed.csv report.html viewer.json ");
}

TEST_F(RunDirectory, ASignalAlwaysLeavesACheckpoint) {
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EQ(end_by(signal, "", [] {}), 128 + signal);
    EXPECT_NE(content(directory_ / "messages").find("; hexaplast resume run continues it\n"), std::string::npos)
        << content(directory_ / "messages");
    ASSERT_GE(newest_checkpoint(), 4);
    EXPECT_EQ(manifest().at("state"), "interrupted");
    EXPECT_EQ(manifest().at("exit_reason"), "Ended by signal " + std::to_string(signal));
    EXPECT_EQ(manifest().at("steps").at("done"), newest_checkpoint());
    EXPECT_NE(content(directory_ / "messages").find("state hash"), std::string::npos);
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
  const auto before = files("run");
  ASSERT_GE(before.size(), 11u);
  for (const char* refused : {"resume run --steps 9 --final nowhere/last.json",
                              "resume run/checkpoint_000000004.hxc --final nowhere/last.json",
                              "run bar.scn --out run --force --final nowhere/last.json",
                              "run bar.scn --out run --force --summary nowhere/last.json"}) {
    const Outcome outcome = hexaplast(refused);
    EXPECT_EQ(outcome.code, 5) << refused;
    EXPECT_NE(outcome.err.find("nowhere/last.json.part: cannot be created"), std::string::npos) << outcome.err;
    EXPECT_TRUE(files("run") == before) << refused;
  }
}

TEST_F(RunDirectory, NoTableIsCutWhenTheOtherOneIsForeign) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=2");
  write("run/removed.csv", "");
  const auto before = files("run");
  const Outcome refused = hexaplast("resume run/checkpoint_000000004.hxc");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("removed.csv does not begin with"), std::string::npos) << refused.err;
  EXPECT_TRUE(files("run") == before);
}

TEST_F(RunDirectory, AStateThatIsGoneIsLeftOutAndSaid) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=3 --steps 3");
  fs::remove(directory_ / "run/mesh_000002.vtu");
  const Outcome resumed = succeeds("resume run --steps 6");
  EXPECT_NE(resumed.err.find("mesh_000002.vtu is gone: its .pvd file no longer names it\n"), std::string::npos)
      << resumed.err;
  const std::string series = content(directory_ / "run/mesh.pvd");
  for (const auto& [name, is_named] : {std::pair{"mesh_000000.vtu", true},
                                       {"mesh_000002.vtu", false},
                                       {"mesh_000004.vtu", true},
                                       {"mesh_000006.vtu", true}}) {
    EXPECT_EQ(series.find(name) != series.npos, is_named) << name;
    EXPECT_EQ(fs::exists(directory_ / "run" / name), is_named) << name;
  }
}

}  // namespace
