// SPDX-License-Identifier: LGPL-2.1-or-later
// hexaplast resume: a run that stops, however it stops, and goes on, against one that does not.
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "hexaplast/base/hash.hpp"
#include "support/command.hpp"

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Outcome;

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
    ".1 .08 .3' triangles='0 1 2'/><BarycentricMapping/></Node></Node>";

class Resume : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("bar.scn", kTearingBar);
  }

  static std::string hash_in(const std::string& out) {
    const std::size_t at = out.find("state hash");
    return at == out.npos ? out : out.substr(at, out.find('\n', at) - at);
  }

  /// The rows of a history.csv without the wall times.
  std::vector<std::string> rows(const std::string& file) const {
    std::istringstream lines(content(directory_ / file));
    std::vector<std::string> all, names;
    for (std::string line, cell; std::getline(lines, line);) {
      std::istringstream cells(line);
      std::string row;
      for (std::size_t column = 0; std::getline(cells, cell, ','); ++column) {
        if (all.empty()) names.push_back(cell);
        if (names.at(column) != "step_ms") row += cell + ",";
      }
      all.push_back(row);
    }
    return all;
  }

  std::vector<std::string> files(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory_ / folder)) names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
  }

  void expect_same_run(const std::string& resumed, const std::string& straight) const {
    EXPECT_EQ(rows(resumed + "/history.csv"), rows(straight + "/history.csv"));
    for (const char* name : {"/removed.csv", "/mesh.pvd", "/surface.pvd", "/instruments.pvd", "/springs.pvd"})
      EXPECT_EQ(content(directory_ / (resumed + name)), content(directory_ / (straight + name))) << name;
    EXPECT_EQ(files(resumed), files(straight));
    for (const std::string& name : files(straight)) {
      if (!name.ends_with(".vtu")) continue;
      EXPECT_EQ(content(directory_ / resumed / name), content(directory_ / straight / name)) << name;
    }
  }
};

TEST_F(Resume, GoesOnBitForBitAndWritesTheSameFiles) {
  const Outcome straight = succeeds("run bar.scn --out straight --frames 0 --checkpoint every=15 --threads 1");
  ASSERT_NE(straight.out.find("removed "), std::string::npos) << "the case is to tear\n" << straight.out;
  EXPECT_NE(straight.out.find("connected parts "), std::string::npos) << straight.out;

  // 20 steps, the last of them at no output: a run of 40 would not write it
  succeeds("run bar.scn --out resumed --frames 0 --checkpoint every=15 --steps 20 --threads 2");
  const Outcome resumed = succeeds("resume resumed --steps 40 --threads 3 --final last.json");
  EXPECT_EQ(hash_in(resumed.out), hash_in(straight.out));
  EXPECT_TRUE(fs::exists(directory_ / "last.json"));
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
  write("at_rest.scn", kTearingBar);
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 10 --set root/body.hardening=0.2");
  fs::create_directory(directory_ / "elsewhere");
  const Outcome resumed = shell("cd elsewhere && '" HEXAPLAST_COMMAND "' resume ../run --steps 12 --final last.json");
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_TRUE(fs::exists(directory_ / "elsewhere/last.json"));
}

TEST_F(Resume, WhatIsForeignOrDamagedIsRefusedAndUntouched) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 25");
  const std::string history = content(directory_ / "run/history.csv");
  const fs::path newest = directory_ / "run/checkpoint_000000025.hxc";

  std::string other = kTearingBar;
  other.replace(other.find("2e4"), 3, "3e4");
  write("bar.scn", other);
  Outcome refused = hexaplast("resume run --steps 40");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("is of another scene"), std::string::npos) << refused.err;
  write("bar.scn", kTearingBar);

  write("run/history.csv", "step,time\n0,0\n");
  refused = hexaplast("resume run --steps 40");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("history.csv does not begin with"), std::string::npos) << refused.err;
  write("run/history.csv", history);

  std::string bytes = content(newest);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  write("run/checkpoint_000000025.hxc", bytes);
  refused = hexaplast("resume run --steps 40");
  EXPECT_EQ(refused.code, 3);
  EXPECT_EQ(refused.err.find("hexaplast: error: run/checkpoint_000000025.hxc is damaged"), 0u) << refused.err;
  EXPECT_NE(refused.err.find("\n  hint: there is another one, run/checkpoint_000000020.hxc\n"), std::string::npos)
      << refused.err;
  EXPECT_EQ(content(directory_ / "run/history.csv"), history);
  succeeds("resume run/checkpoint_000000020.hxc --steps 40");

  EXPECT_EQ(hexaplast("resume nowhere").code, 5);
  fs::create_directory(directory_ / "empty");
  EXPECT_EQ(hexaplast("resume empty").code, 5);
}

/// A directory that a stranger has made: a scene in it that needs a plugin, which lies there too, and a checkpoint.
class ResumeOfAStranger : public Resume {
 protected:
  void SetUp() override {
    Resume::SetUp();
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
    ASSERT_TRUE(fs::exists(directory_ / "planted_code_has_run")) << "loading it does no harm that could be seen";
    for (const char* file : {"planted_code_has_run", "theirs/planted_code_has_run"}) fs::remove(directory_ / file);
    for (const char* file : {"victim.json", "victim.txt"}) write(file, "mine");
  }

  void expect_harmless(const std::string& line, int code, const std::string& message) {
    const Outcome outcome = shell(line);
    EXPECT_EQ(outcome.code, code) << line << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << line << "\n" << outcome.err;
    for (const auto& entry : fs::recursive_directory_iterator(directory_))
      EXPECT_NE(entry.path().filename(), "planted_code_has_run") << line << ": " << entry.path();
    for (const char* file : {"victim.json", "victim.txt"}) EXPECT_EQ(content(directory_ / file), "mine") << line;
  }

  /// Replaces some bytes in the section `run` of the newest checkpoint, by as many others, and mends the checksum.
  void forge(const std::string& what, const std::string& by) {
    ASSERT_EQ(what.size(), by.size());
    const fs::path file = directory_ / "theirs/checkpoint_000000020.hxc";
    std::string bytes = content(file);
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
    write("theirs/checkpoint_000000020.hxc", bytes);
  }

  const std::string command_ = "'" HEXAPLAST_COMMAND "' ";
};

// The run that the stranger carried out knew the plugin's folder and wrote files elsewhere: that was the stranger's
// will.
TEST_F(ResumeOfAStranger, LoadsNothingFromTheRunsDirectoryAndWritesNothingElsewhere) {
  const std::string missing = "there is no Planted.so or libPlanted.so", below = "from which nothing is loaded";
  expect_harmless(command_ + "resume theirs --steps 40", 6, missing);
  expect_harmless("cd theirs && " + command_ + "resume . --steps 40", 6, missing);
  for (const char* path : {"theirs", "theirs/plugins", "./mine/../theirs", "link", "mine/link"}) {
    if (!fs::exists(directory_ / "link")) fs::create_directory_symlink("theirs", directory_ / "link");
    if (!fs::exists(directory_ / "mine/link"))
      fs::create_directory_symlink("../theirs/plugins", directory_ / "mine/link");
    expect_harmless(command_ + "resume theirs --steps 40 --plugin-path " + path, 6, below);
    expect_harmless(command_ + "resume link --steps 40 --plugin-path " + path, 6, below);
  }
  expect_harmless("cd theirs && " + command_ + "resume . --steps 40 --plugin-path .", 6, below);
  expect_harmless("cd theirs && LD_LIBRARY_PATH=. " + command_ + "resume . --steps 40 --plugin-path plugins", 6, below);
  fs::create_directory(directory_ / "linked");
  fs::create_symlink("../theirs/libPlanted.so", directory_ / "linked/libPlanted.so");
  expect_harmless(command_ + "resume theirs --steps 40 --plugin-path linked", 6, below);

  // the same plugin from where the user has it
  const Outcome mine = succeeds("resume theirs --steps 40 --plugin-path mine --final last.json --summary last.txt");
  EXPECT_TRUE(fs::exists(directory_ / "planted_code_has_run")) << "the working directory is the user's";
  for (const char* file : {"last.json", "last.txt"}) EXPECT_TRUE(fs::exists(directory_ / file)) << file;
  for (const char* file : {"victim.json", "victim.txt"}) EXPECT_EQ(content(directory_ / file), "mine");
}

// With the plugin where it may be loaded from: whatever else is wrong is found before.
TEST_F(ResumeOfAStranger, LoadsNothingBeforeEverythingIsChecked) {
  const std::string resume = command_ + "resume theirs --plugin-path mine ";
  expect_harmless(resume, 2, "has all 20 steps of the run already");
  expect_harmless(resume + "--steps 40 --final nowhere/last.json", 5, "nowhere/last.json.part: cannot be created");
  expect_harmless(resume + "--steps 40 --final theirs/bar.scn", 5, "is an input");
  expect_harmless(resume + "--steps 40 --final theirs/checkpoint_000000020.hxc", 5, "is an input");
  expect_harmless(resume + "--steps x", 2, "--steps");

  const std::string history = content(directory_ / "theirs/history.csv"),
                    scene = content(directory_ / "theirs/bar.scn");
  write("theirs/history.csv", "step,time\n");
  expect_harmless(resume + "--steps 40", 3, "history.csv does not begin with");
  write("theirs/history.csv", history);
  write("theirs/bar.scn", scene.substr(0, scene.find("2e4")) + "3" + scene.substr(scene.find("2e4") + 1));
  expect_harmless(resume + "--steps 40", 3, "is of another scene");
  write("theirs/bar.scn", scene);

  std::string bytes = content(directory_ / "theirs/checkpoint_000000020.hxc");
  const char version = std::exchange(bytes[8], 1);  // an earlier format, which told where to look for plugins
  write("theirs/checkpoint_000000020.hxc", bytes);
  expect_harmless(resume + "--steps 40", 3, "has format version 1, must be " + std::to_string(version));
  bytes[8] = version;
  bytes[100] = static_cast<char>(bytes[100] ^ 1);
  write("theirs/checkpoint_000000020.hxc", bytes);
  expect_harmless(resume + "--steps 40", 3, "is damaged");
}

TEST_F(ResumeOfAStranger, AForgedRecordIsRefusedOrHarmless) {
  const auto number = [](std::int64_t value) { return std::string(reinterpret_cast<const char*>(&value), 8); };
  const std::string resume = command_ + "resume theirs --plugin-path mine --steps 40", given(1, 1);
  const std::string path = (directory_ / "theirs/bar.scn").string();
  const fs::path checkpoint = directory_ / "theirs/checkpoint_000000020.hxc";
  const std::string sound = content(checkpoint);
  forge(given + number(10), given + number(0));
  expect_harmless(resume, 3, "is damaged");
  write("theirs/checkpoint_000000020.hxc", sound);
  forge(given + number(20), given + number(-20));
  expect_harmless(resume, 3, "is damaged");
  write("theirs/checkpoint_000000020.hxc", sound);

  // another scene in its place, whose text is not the one of the run
  write("theirs/baz.scn", kTearingBar);
  forge(path, path.substr(0, path.size() - 7) + "baz.scn");
  expect_harmless(resume, 3, "is of another scene");
}

TEST_F(Resume, FollowsNoLinkOutOfTheRunsDirectory) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 20");
  fs::create_directory(directory_ / "elsewhere");
  write("elsewhere/frame_000001.png", "mine");
  for (const char* name : {"mesh.pvd", "report.html", "manifest.json", "plot.svg", "mesh_000040.vtu",
                           "mesh_000024.vtu.part", "surface.pvd"}) {
    write(std::string("elsewhere/") + name, "mine");
    fs::remove(directory_ / "run" / name);
    fs::create_symlink(directory_ / "elsewhere" / name, directory_ / "run" / name);
  }
  fs::create_directory_symlink(directory_ / "elsewhere", directory_ / "run/frames");
  const Outcome refused = hexaplast("resume run --steps 40");
  EXPECT_EQ(refused.code, 5) << refused.err;
  EXPECT_NE(refused.err.find("run/frames: is a symbolic link"), std::string::npos) << refused.err;
  fs::remove(directory_ / "run/frames");
  succeeds("resume run --steps 40");
  for (const auto& entry : fs::directory_iterator(directory_ / "elsewhere"))
    EXPECT_EQ(content(entry.path()), "mine") << entry.path();

  const std::string history = content(directory_ / "run/history.csv");
  write("elsewhere/history.csv", history);
  fs::remove(directory_ / "run/history.csv");
  fs::create_symlink(directory_ / "elsewhere/history.csv", directory_ / "run/history.csv");
  EXPECT_EQ(hexaplast("resume run --steps 60").code, 5);
  EXPECT_EQ(content(directory_ / "elsewhere/history.csv"), history);
}

// Below the run's directory, and so below that of a stranger; a link of the user's own leads where it leads.
TEST_F(Resume, NamedFilesFollowNoLinkOfTheRunsDirectory) {
  const std::string run = "run bar.scn --out run --frames 0 --checkpoint every=10 --steps 20";
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
      for (const std::string& command : {std::string("resume run --steps 40 "), run + " --force "}) {
        const Outcome refused = hexaplast(command + option + name);
        EXPECT_EQ(refused.code, 5) << command << option << name << "\n" << refused.err;
        EXPECT_NE(refused.err.find("is a symbolic link, which is not followed"), std::string::npos) << refused.err;
      }
  EXPECT_EQ(content(directory_ / "elsewhere/last.json"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_ / "elsewhere"), {}), 1);

  // other commands that write where a run is
  for (const std::string command : {"render run --out run/last.png", "compare run run --out run/last.html"}) {
    fs::create_symlink("../elsewhere/last.json", directory_ / command.substr(command.find("run/")));
    const Outcome refused = hexaplast(command);
    EXPECT_EQ(refused.code, 5) << refused.err;
    EXPECT_NE(refused.err.find("is a symbolic link, which is not followed"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(content(directory_ / "elsewhere/last.json"), "mine");

  fs::create_symlink("elsewhere/last.json", directory_ / "mine.json");
  succeeds("resume same --steps 40 --final mine.json --summary same/sub/summary.json");
  EXPECT_NE(content(directory_ / "elsewhere/last.json"), "mine");
  EXPECT_TRUE(fs::exists(directory_ / "run/sub/summary.json"));
}

// A file of the run with another name elsewhere would change there too.
TEST_F(Resume, WritesIntoNoFileThatHasOtherNames) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=10 --steps 20");
  for (const std::string name : {"history.csv", "removed.csv"}) {
    const fs::path file = directory_ / "run" / name;
    write("victim", content(file) + "mine\n");
    fs::rename(file, directory_ / "kept");
    fs::create_hard_link(directory_ / "victim", file);
    const Outcome refused = hexaplast("resume run --steps 40");
    EXPECT_EQ(refused.code, 5) << name << "\n" << refused.err;
    EXPECT_NE(refused.err.find("has other names, which would change with it"), std::string::npos) << refused.err;
    EXPECT_EQ(content(directory_ / "victim"), content(directory_ / "kept") + "mine\n") << name;
    fs::remove(directory_ / "victim");
    fs::rename(directory_ / "kept", file);
  }
  // content of the same size
  const std::string history = content(directory_ / "run/history.csv");
  write("run/history.csv", "S" + history.substr(1));
  const Outcome other = hexaplast("resume run --steps 40");
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.err.find("history.csv does not begin with"), std::string::npos) << other.err;
  write("run/history.csv", history);
  succeeds("resume run --steps 40");
}

}  // namespace
