// SPDX-License-Identifier: LGPL-2.1-or-later
// Pipes, folders, full devices and impossible names in the place of files: refused at once, with the reason.
#include <sys/stat.h>

#include <regex>

#include "support/bar_scene.hpp"
#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

class OddFiles : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("bar.scn", kPulledBar);
  }

  void make_pipe(const std::string& name) { ASSERT_EQ(::mkfifo((directory_ / name).c_str(), 0600), 0) << name; }

  Outcome in_time(const std::string& arguments) { return hexaplast(arguments, "timeout -s KILL 100"); }
};

TEST_F(OddFiles, APipeKeepsNobodyWaiting) {
  make_pipe("pipe");
  for (const char* arguments :
       {"run pipe", "check pipe", "mesh info pipe", "mesh cage pipe --cells 3 -o cage.vtu", "resume pipe",
        "element pipe", "fit bar.scn --target pipe --free bar/material.yieldStress=1:2",
        "bench --scene bar.scn --baseline pipe"}) {
    const Outcome refused = in_time(arguments);
    EXPECT_TRUE(refused.code == 5 || refused.code == 3) << arguments << ": " << refused.code;
    EXPECT_TRUE(std::regex_search(refused.err, std::regex("pipe: .*is not a file"))) << refused.err;
  }
}

TEST_F(OddFiles, APipeAmongTheFilesOfARunKeepsNobodyWaiting) {
  succeeds("run bar.scn --out run --frames 0 --checkpoint every=3");
  make_pipe("run/checkpoint_000000099.hxc");
  Outcome refused = in_time("resume run");
  EXPECT_EQ(refused.code, 5);
  EXPECT_EQ(refused.err, "hexaplast: error: run/checkpoint_000000099.hxc: is not a file\n");

  fs::remove(directory_ / "run/history.csv");
  make_pipe("run/history.csv");
  EXPECT_EQ(in_time("resume run/checkpoint_000000003.hxc").code, 5);
  EXPECT_EQ(in_time("compare run run").code, 5);
  fs::remove(directory_ / "run/mesh.pvd");
  make_pipe("run/mesh.pvd");
  EXPECT_EQ(in_time("render run -o picture.png").code, 5);

  make_pipe("last.json.part");
  refused = in_time("run bar.scn --final last.json");
  EXPECT_EQ(refused.code, 5);
  EXPECT_TRUE(has(refused.err, "last.json.part: is not a regular file"));

  fs::create_directory(directory_ / "sweep");
  make_pipe("sweep/sweep.json");
  EXPECT_EQ(in_time("sweep bar.scn --out sweep --vary bar/material.hardening=0:1:2").code, 5);
}

TEST_F(OddFiles, AFullDeviceIsNoticedByWhateverPrints) {
  succeeds("mesh grid --cells 1 1 1 --size 1 1 1 -o box.vtu");
  succeeds("run bar.scn --out run --frames 0");
  write("cube.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  for (const std::string arguments :
       {"--help", "--version", "run --help", "mesh grid --help", "list", "list --markdown", "list RegularGridTopology",
        "page man", "page bash", "check bar.scn", "run bar.scn", "mesh info box.vtu", "mesh info --json box.vtu",
        "mesh grid --cells 1 1 1 --size 1 1 1 -o box.vtu", "mesh cage cube.obj --cells 2 -o cage.vtu",
        "compare run run"}) {
    const Outcome outcome = shell("sh -c \"'" HEXAPLAST_COMMAND "' " + arguments + " > /dev/full\"");
    EXPECT_EQ(outcome.code, 5) << arguments;
    EXPECT_TRUE(has(outcome.err, "hexaplast: error: ")) << arguments;
  }
}

}  // namespace
