// SPDX-License-Identifier: LGPL-2.1-or-later
// What the command lets a scene write, and where; what it reads is never written over; and what names show of
// themselves.
#include "support/command.hpp"

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Outcome;

/// A bar of two hexahedra that reads a surface, and writes as `exporters` say.
std::string writing_bar(const std::string& exporters) {
  return "<Node name='root' dt='0.01'><RunSettings steps='3' outputEvery='1' endSections='yes'/><include "
         "href='rest.xml'/>"
         "<Node name='skin'><MeshOBJLoader name='mesh' filename='skin.obj'/><OglModel "
         "src='@mesh'/><BarycentricMapping/></Node>" +
         exporters + "</Node>";
}
const std::string kRest =
    "<Node name='Group'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/><RegularGridTopology n='2 2 3' "
    "max='0.1 0.1 0.2'/>"
    "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField "
    "name='body' youngModulus='2e4' poissonRatio='0.3'/><FixedProjectiveConstraint indices='0-3'/></Node>";
const std::string kSkin = "v 0.02 0.02 0.02\nv 0.08 0.02 0.02\nv 0.05 0.08 0.1\nf 1 2 3\n";

class SceneOutput : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("rest.xml", kRest);
    write("skin.obj", kSkin);
    write("bar.scn", writing_bar("<WriteState name='state' filename='state.txt'/>"));
    fs::create_directory(directory_ / "sub");
  }

  std::string error_of(const std::string& arguments, int code) {
    const Outcome outcome = hexaplast(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    return outcome.err;
  }
  void expect_error(const std::string& arguments, int code, const std::string& message) {
    const std::string shown = error_of(arguments, code);
    EXPECT_NE(shown.find(message), std::string::npos) << arguments << "\n" << shown;
  }
};

TEST_F(SceneOutput, LiesInTheRunsDirectoryOrTheWorkingDirectory) {
  EXPECT_EQ(error_of("run bar.scn --out run --frames 0", 0), "");
  EXPECT_TRUE(fs::exists(directory_ / "run/state.txt"));
  EXPECT_FALSE(fs::exists(directory_ / "state.txt"));
  EXPECT_EQ(error_of("run bar.scn", 0), "");
  EXPECT_EQ(content(directory_ / "state.txt"), content(directory_ / "run/state.txt"));
  EXPECT_EQ(error_of("run bar.scn --write-below sub/deeper", 0), "");
  EXPECT_EQ(content(directory_ / "sub/deeper/state.txt"), content(directory_ / "run/state.txt"));

  // the user's own file is not touched, nor is an earlier result
  write("state.txt", "mine");
  for (const char* command : {"run", "check"}) {
    expect_error(std::string(command) + " bar.scn", 5,
                 "bar.scn:1: error: WriteState.filename: '" + (directory_ / "state.txt").string() +
                     "' is there already\n  hint: --force replaces it");
    expect_error(std::string(command) + " bar.scn --set root/state.filename=" + (directory_ / "x.txt").string(), 3,
                 "hint: --allow-outside permits that");
    expect_error(std::string(command) + " bar.scn --set root/state.filename=../x.txt", 3, "is absolute or has '..'");
  }
  EXPECT_EQ(content(directory_ / "state.txt"), "mine");
  EXPECT_EQ(error_of("run bar.scn --set root/state.filename=../x.txt --out sub/run --frames 0 --allow-outside", 0), "");
  EXPECT_TRUE(fs::exists(directory_ / "sub/x.txt"));
  EXPECT_EQ(error_of("run bar.scn --force", 0), "");
  EXPECT_EQ(content(directory_ / "state.txt"), content(directory_ / "run/state.txt"));
  expect_error("run bar.scn --out run --write-below sub", 2, "--write-below");
}

TEST_F(SceneOutput, IsToldByCheck) {
  write("bar.scn",
        writing_bar(
            "<WriteState filename='deep/state.txt'/><VTKExporter filename='skin' exportEveryNumberOfSteps='1'/>"));
  const Outcome told = hexaplast("check bar.scn --out run");
  EXPECT_EQ(told.code, 0) << told.err;
  for (const char* name : {"run/deep/state.txt\n", "run/skin<N>.vtu\n"})
    EXPECT_NE(told.out.find("  writes              " + (directory_ / name).string()), std::string::npos) << told.out;
  EXPECT_FALSE(fs::exists(directory_ / "run"));
  EXPECT_NE(hexaplast("check bar.scn --json").out.find("\"writes\": [\n    \"" + directory_.string()),
            std::string::npos);
}

TEST_F(SceneOutput, IsRefusedByCheckAsByRun) {
  for (const std::string where : {"--out new", "--write-below sub"}) {
    const bool is_run = where == "--out new";
    for (const char* name : {"history.csv", "frames/frame_000000.png", "mesh_000006.vtu/x", "manifest.json.part"})
      for (const char* command : {"check", "run"})
        error_of(std::string(command) + " bar.scn " + where + " --set root/state.filename=" + name,
                 is_run || std::string(name).ends_with(".part") ? 3 : 0);
  }
  EXPECT_NE(hexaplast("check bar.scn --write-below sub/deep")
                .out.find("  writes              " + (directory_ / "sub/deep/state.txt").string()),
            std::string::npos);
  expect_error("check bar.scn --out run --write-below sub", 2, "--write-below");
  expect_error("run bar.scn --final fin.json --set root/state.filename=fin.json/x", 3, "is written by the run itself");
  expect_error("run bar.scn --final fin.json --set root/state.filename=fin.json.part", 3, "ends in .part");

  // a file that is there is no fault of the scene's, but what else is wrong with it comes first
  write("state.txt", "mine");
  expect_error("run bar.scn", 5, "state.txt' is there already");
  write("bar.scn", writing_bar("<WriteState filename='state.txt'/><WriteState filename='/x'/>"));
  expect_error("run bar.scn", 3, "state.txt' is there already");
}

// A run makes last.json.part before it makes last.json.
TEST_F(SceneOutput, WhatIsReadIsNoUnfinishedFileEither) {
  const std::string text = content(directory_ / "bar.scn");
  fs::rename(directory_ / "bar.scn", directory_ / "last.vtu.part");
  fs::copy_file(directory_ / "skin.obj", directory_ / "page.html.part");
  for (const char* arguments :
       {"run last.vtu.part --write-below sub --final last.vtu",
        "run last.vtu.part --write-below sub --summary last.vtu", "mesh export last.vtu.part -o last.vtu"})
    expect_error(arguments, 5, "last.vtu.part: is an input, and will not be written over");
  EXPECT_EQ(content(directory_ / "last.vtu.part"), text);

  // nor is a file of the user's that has the name, nor can such a name be asked for
  write("bar.scn", writing_bar(""));
  expect_error("run bar.scn --final page.html", 5, "page.html.part: is in the way, and no unfinished file");
  expect_error("mesh export bar.scn -o last.vtu", 5, "last.vtu.part: is in the way");
  EXPECT_EQ(content(directory_ / "page.html.part"), kSkin);
  expect_error("run bar.scn --final a.json.part --summary a.json", 5, "a.json.part: ends in .part");
}

// An earlier run goes only when all files of the new one can be made.
TEST_F(SceneOutput, ThatCannotBeMadeIsRefusedBeforeAnythingIsRemoved) {
  ASSERT_EQ(hexaplast("run bar.scn --out run --frames 0").code, 0);
  const std::string history = content(directory_ / "run/history.csv");
  const auto exporting = [&](const std::string& kind, const std::string& name) {
    write("long.scn", writing_bar("<" + kind + " filename='" + name + "'/>"));
    return std::string(" long.scn --out run --force");
  };
  const std::string series = "VTKExporter exportEveryNumberOfSteps='1'";
  for (const char* command : {"run", "check"}) {
    expect_error(command + exporting("WriteState", "sub/" + std::string(251, 'n')), 3, "is too long a name");
    expect_error(command + exporting(series, std::string(237, 'n')), 3, "is too long a name");
    expect_error(command + exporting("WriteState", std::string(300, 'n') + "/state.txt"), 3, "long.scn:1: error: ");
    expect_error(command + exporting("WriteState", std::string(300, 'n')), 3, "nnn: File name too long");
    EXPECT_EQ(error_of(std::string("check") + exporting(series, std::string(236, 'n')), 0), "");
    expect_error(command + exporting("WriteState", "/proc/self/attr/new/x") + " --allow-outside", 3, "is no directory");
  }
  EXPECT_EQ(content(directory_ / "run/history.csv"), history);
  EXPECT_EQ(fs::exists(directory_ / "run/sub"), false);

  // whom the system lets write everywhere cannot see this
  if (::geteuid() == 0) return;
  fs::create_directory(directory_ / "run/sub");
  fs::permissions(directory_ / "run/sub", fs::perms::owner_read | fs::perms::owner_exec);
  for (const char* command : {"run", "check"})
    expect_error(command + exporting("WriteState", "sub/state.txt"), 5,
                 "run/sub' cannot be written: Permission denied");
  EXPECT_EQ(content(directory_ / "run/history.csv"), history);
}

// What several programs write into one directory is not told apart, and nor is what is open told from a file.
TEST_F(SceneOutput, IsOneProgramsAtATime) {
  for (const std::string& where : {std::string(), std::string(" --write-below sub/new")}) {
    const std::string line = "'" HEXAPLAST_COMMAND "' run bar.scn --quiet --steps 1000000000" + where;
    const Outcome outcome = shell("sh -c \"" + line + " & until test -e ./" + (where.empty() ? "" : "sub/new/") +
                                  "state.txt; do sleep 0.01; done; '" HEXAPLAST_COMMAND "' run bar.scn --force" +
                                  where + "; code=\\$?; kill \\$!; wait; exit \\$code\"");
    EXPECT_EQ(outcome.code, 5) << outcome.err;
    EXPECT_NE(outcome.err.find("another run or sweep is at work there"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(error_of("run bar.scn --force", 0), "") << "nothing keeps the next one out";
  EXPECT_EQ(error_of("run bar.scn --set root/state.filename=" + (directory_ / "sub/x.txt").string() +
                         " --allow-outside --write-below nowhere/deep",
                     0),
            "");
  EXPECT_FALSE(fs::exists(directory_ / "nowhere")) << "nothing is written there";
}

TEST_F(SceneOutput, ReplacesNothingThatIsOpen) {
  write("log", "mine\n");
  const std::string into_log = "sh -c \"'" HEXAPLAST_COMMAND "' run bar.scn --quiet --force ";
  for (const char* arguments :
       {"--final /dev/stdout", "--summary /dev/stdout", "--allow-outside --set root/state.filename=/dev/stdout"}) {
    const Outcome outcome = shell(into_log + arguments + " >> log\"");
    EXPECT_TRUE(outcome.code == 5 || outcome.code == 3) << arguments;
    EXPECT_NE(outcome.err.find("/dev/stdout: is a link of the system's to what is open"), std::string::npos)
        << outcome.err;
  }
  EXPECT_EQ(content(directory_ / "log"), "mine\n");
}

TEST_F(SceneOutput, NeverReplacesWhatIsRead) {
  fs::create_hard_link(directory_ / "bar.scn", directory_ / "same.scn");
  fs::create_symlink("skin.obj", directory_ / "link.obj");
  for (const std::string name : {"bar.scn", "same.scn", "rest.xml", "skin.obj"}) {
    for (const char* command : {"run", "check"})
      expect_error(std::string(command) + " bar.scn --force --allow-outside --set root/state.filename=" + name, 3,
                   "is read by this scene, and what is read is never written over");
    for (const char* option : {"--final", "--summary"})
      for (const char* where : {"--write-below sub", "--out run"})
        expect_error(std::string("run bar.scn --force ") + where + " " + option + " " + name, 5,
                     name + ": is an input");
  }
  for (const char* option : {"--final", "--summary"}) {
    expect_error(std::string("run bar.scn --out run --force ") + option + " link.obj", 5, "link.obj: is an input");
    expect_error(std::string("run bar.scn --out run --force ") + option + " run/history.csv", 5,
                 "is written by the run itself");
  }
  ASSERT_EQ(hexaplast("run bar.scn --out earlier --steps 1 --frames 0").code, 0);
  const std::string manifest = content(directory_ / "earlier/manifest.json");
  for (const char* option : {"--final", "--summary"})
    expect_error(std::string("run bar.scn ") + option + " earlier/manifest.json", 5,
                 "earlier/manifest.json: is a file of an earlier run; --force replaces it");
  EXPECT_EQ(content(directory_ / "earlier/manifest.json"), manifest);
  expect_error("run bar.scn --out run --force --video link.obj.png --final x --summary x", 5,
               "is being written by another program, or by another option");
  expect_error("run bar.scn --out bar.scn", 3, "bar.scn' is no directory");
  expect_error("run bar.scn --out new/ --set root/state.filename=history.csv", 3, "is written by the run itself");
  expect_error("run bar.scn --out run --set root/state.filename=history.csv", 3, "is written by the run itself");
  expect_error("run bar.scn --final sub/x.txt --set root/state.filename=sub/x.txt", 3, "is written by the run itself");
  EXPECT_EQ(content(directory_ / "rest.xml"), kRest);
  EXPECT_EQ(content(directory_ / "skin.obj"), kSkin);

  // a mesh among the files of an earlier run
  ASSERT_EQ(hexaplast("mesh convert skin.obj -o sub/mesh_000000.vtu").code, 0);
  const std::string mesh = content(directory_ / "sub/mesh_000000.vtu");
  std::string text = writing_bar("");
  text.replace(text.find("MeshOBJLoader"), 13, "MeshVTKLoader");
  text.replace(text.find("skin.obj"), 8, "sub/mesh_000000.vtu");
  write("reads.scn", text);
  expect_error("run reads.scn --out sub --force", 5, "sub/mesh_000000.vtu: is an input of this run");
  EXPECT_EQ(content(directory_ / "sub/mesh_000000.vtu"), mesh);

  // other commands
  for (const char* arguments :
       {"mesh convert sub/mesh_000000.vtu -o sub/mesh_000000.vtu",
        "mesh cage sub/mesh_000000.vtu --cells 2 -o sub/mesh_000000.vtu",
        "mesh offset sub/mesh_000000.vtu --thickness 1 -o sub/mesh_000000.vtu", "mesh export bar.scn -o skin.obj"}) {
    const std::string shown = hexaplast(arguments).err;
    EXPECT_EQ(content(directory_ / "sub/mesh_000000.vtu"), mesh) << arguments << "\n" << shown;
    EXPECT_EQ(content(directory_ / "skin.obj"), kSkin) << arguments << "\n" << shown;
  }
  expect_error("mesh convert sub/mesh_000000.vtu -o sub/mesh_000000.vtu", 5, "is an input");
  ASSERT_EQ(hexaplast("run bar.scn --out run --frames 0").code, 0);
  const std::string history = content(directory_ / "run/history.csv");
  expect_error("compare run run --out run/history.csv", 5, "is an input");
  EXPECT_EQ(content(directory_ / "run/history.csv"), history);
}

TEST_F(SceneOutput, OfASweepIsOneFolderPerRun) {
  const std::string sweep = "sweep bar.scn --out found --jobs 2 --vary root/body.youngModulus=1e4,2e4,3e4";
  const Outcome outcome = hexaplast(sweep);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  ASSERT_EQ(hexaplast("run bar.scn --write-below alone --set root/body.youngModulus=2e4").code, 0);
  EXPECT_EQ(content(directory_ / "found/run_2/state.txt"), content(directory_ / "alone/state.txt"));
  EXPECT_NE(content(directory_ / "found/run_1/state.txt"), content(directory_ / "found/run_3/state.txt"));
  EXPECT_FALSE(fs::exists(directory_ / "state.txt"));

  write("bar.scn", writing_bar("<WriteState filename='" + (directory_ / "state.txt").string() + "'/>"));
  EXPECT_EQ(hexaplast(sweep + " --force").code, 3) << "all runs would write the same file";
  EXPECT_FALSE(fs::exists(directory_ / "state.txt"));
  expect_error(sweep + " --force --allow-outside", 2, "unknown option");
  fs::create_directories(directory_ / "begun/run_2");
  expect_error("sweep bar.scn --out begun --vary root/body.youngModulus=1e4,2e4", 5, "run_2: is there without a plan");
}

TEST_F(SceneOutput, IsNoneOfCommandsThatOnlyTryAScene) {
  write("bar.scn", writing_bar("<WriteState filename='/proc/no/where'/>"));
  ASSERT_EQ(hexaplast("mesh export bar.scn -o bar.vtu").code, 0);
  write("curve.csv", "time,elongation\n0.01,0\n0.02,0.001\n");
  const Outcome fit = hexaplast("fit bar.scn --target curve.csv --free root/body.youngModulus=1e4:3e4 --evaluations 3");
  EXPECT_EQ(fit.code, 0) << fit.err;
  EXPECT_NE(fit.out.find("--set root/body.youngModulus="), std::string::npos) << fit.out;
  EXPECT_EQ(error_of("bench --scene bar.scn --threads 1", 0), "");
}

// Names of files and components, and values, come from strangers: a terminal must not obey them.
TEST_F(SceneOutput, NamesDoNotSteerTheTerminal) {
  const std::string escape =
                        "\x1b]0;owned\x07\x1b[2J\xc2\x9b"
                        "31m\x7f",
                    odd = "bar" + escape + "\xc3\xa9.scn";
  const std::string shown = "bar\\u001b]0;owned\\u0007\\u001b[2J\\u009b31m\\u007f\xc3\xa9";
  write(odd, writing_bar(""));
  const auto expect_shown = [&](const std::string& arguments, int code) {
    const Outcome outcome = hexaplast(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    const std::string all = outcome.out + outcome.err;
    EXPECT_EQ(all.find('\x1b'), all.npos) << arguments;
    EXPECT_EQ(all.find('\x7f'), all.npos) << arguments;
    EXPECT_EQ(all.find("\xc2\x9b"), all.npos) << arguments;
    EXPECT_NE(all.find(shown), all.npos) << arguments << "\n" << all;
  };
  const std::string name = "'" + odd + "'";
  expect_shown("run " + name, 0);
  expect_shown("check " + name, 0);
  expect_shown("check " + name + " --set 'root.bar" + escape + "\xc3\xa9=1'", 2);
  expect_shown("run " + name + " --out " + name, 5);
  expect_shown("run 'absent " + odd + "'", 5);
  expect_shown("run --" + name, 2);
  expect_shown("sweep " + name + " --out found --vary root/body.youngModulus=1e4", 0);
  fs::copy_file(directory_ / "skin.obj", directory_ / (odd + ".obj"));
  expect_shown("mesh info '" + odd + ".obj'", 0);

  write("named.scn", writing_bar("<BoxROI name='a' box='@bar&#27;]0;owned&#7;&#27;[2J&#155;31m&#127;é.box'/>"));
  expect_shown("check named.scn", 3);
  // nor do they make lines of their own, or turn them
  const std::string forged = "safe.txt&#10;  memory              1.0 MB&#10;slab.scn: warning: forged &#x202E;";
  write("named.scn", writing_bar("<WriteState name='state' filename='" + forged + "'/>"));
  const std::string one_line = "safe.txt\\u000a  memory              1.0 MB\\u000aslab.scn: warning: forged \\u202e";
  EXPECT_NE(hexaplast("check named.scn").out.find(one_line), std::string::npos);
  for (const char* arguments : {"check named.scn --json --out x", "check named.scn"})
    EXPECT_EQ(hexaplast(arguments).out.find("\n  memory              1.0 MB"), std::string::npos) << arguments;
  write("named.scn", writing_bar("<BoxROI box='@" + forged + ".box'/>"));
  expect_error("check named.scn", 3, one_line);
  EXPECT_EQ(hexaplast("run 'a\nb.scn: error: forged'").err, "a\\u000ab.scn: error: forged: error: no such file\n");
  write("named.scn", writing_bar("<BoxROI box='0 0 0 bar&#27;]0;owned&#7;&#27;[2J&#155;31m&#127;é'/>"));
  expect_shown("check named.scn", 3);
}

}  // namespace
