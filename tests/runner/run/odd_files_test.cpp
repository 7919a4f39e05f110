// SPDX-License-Identifier: LGPL-2.1-or-later
// Pipes, folders, full devices and impossible names in the place of files are refused at once, names of files are
// names, whatever stands in them, and what the command reads is never written over.
#include <sys/stat.h>

#include <regex>

#include "support/bar_scene.hpp"
#include "support/command.hpp"

namespace {

using namespace hexaplast::support;

class OddFiles : public Command {
 protected:
  OddFiles() { write("bar.scn", kPulledBar); }

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
        "check bar.scn", "run bar.scn", "mesh info box.vtu", "mesh info --json box.vtu",
        "mesh grid --cells 1 1 1 --size 1 1 1 -o box.vtu", "mesh cage cube.obj --cells 2 -o cage.vtu",
        "compare run run"}) {
    const Outcome outcome = shell("sh -c \"'" HEXAPLAST_COMMAND "' " + arguments + " > /dev/full\"");
    EXPECT_EQ(outcome.code, 5) << arguments;
    EXPECT_TRUE(has(outcome.err, "hexaplast: error: ")) << arguments;
  }
}

const std::string kOdd = "it's \"100 %s\" $(touch hit) `touch hit` \xc3\xbc;|&*?[a]\\n";

/// The files of a run; of viewer.json what is not the name of the scene, and of others than states their names.
std::map<std::string, std::string> states_in(const fs::path& run) {
  auto files = files_in(run);
  files.erase("manifest.json");  // names of files, and times
  for (auto& [name, bytes] : files)
    if (!name.ends_with(".vtu") && !name.ends_with(".pvd") && name != "viewer.json") bytes.clear();
  std::string& viewer = files.at("viewer.json");
  viewer = std::regex_replace(viewer, std::regex(R"("title":"(\\.|[^"\\])*",)"), "");
  return files;
}

TEST_F(Command, TakesBlanksQuotesAndSignsOfTheShellInNamesAsTheyAre) {
  fs::create_directory(directory_ / kOdd);
  write("bar.scn", kPulledBar);
  write(kOdd + "/" + kOdd + ".scn", kPulledBar);
  succeeds("run bar.scn --frames 0 --out plain --checkpoint every=3");
  const std::string scene = quoted(kOdd + "/" + kOdd + ".scn"), out = quoted(kOdd + "/out" + kOdd);
  succeeds("run " + scene + " --frames 0 --out " + out + " --checkpoint every=3");

  const auto plain = states_in(directory_ / "plain"), odd = states_in(directory_ / kOdd / ("out" + kOdd));
  EXPECT_GE(plain.size(), 8u);
  for (const auto& [name, bytes] : plain) {
    ASSERT_TRUE(odd.contains(name)) << name;
    EXPECT_TRUE(odd.at(name) == bytes) << name;
  }
  EXPECT_EQ(plain.size(), odd.size());

  succeeds("resume " + out + " --steps 8 --quiet");
  succeeds("compare plain " + out + " --out " + quoted(kOdd + ".html"));
  EXPECT_EQ(hexaplast("run " + quoted("no " + kOdd)).code, 5);
  EXPECT_FALSE(is_there("hit"));
  EXPECT_FALSE(fs::exists(directory_ / kOdd / "hit"));
}

/// A bar of two hexahedra that reads a surface, with more components.
std::string bar_with(const std::string& components) {
  return "<Node name='root' dt='0.01'><RunSettings steps='3' outputEvery='1' endSections='yes'/><include "
         "href='rest.xml'/>"
         "<Node name='skin'><MeshOBJLoader name='mesh' filename='skin.obj'/><OglModel "
         "src='@mesh'/><BarycentricMapping/></Node>" +
         components + "</Node>";
}
const std::string kRest =
    "<Node name='Group'><DefaultAnimationLoop/><EulerImplicitSolver/><SparseLDLSolver/><RegularGridTopology n='2 2 3' "
    "max='0.1 0.1 0.2'/>"
    "<MechanicalObject name='nodes'/><DiagonalMass massDensity='1000'/><HexahedronElastoplasticFEMForceField "
    "name='body' youngModulus='2e4' poissonRatio='0.3'/><FixedProjectiveConstraint indices='0-3'/></Node>";
const std::string kSkin = "v 0.02 0.02 0.02\nv 0.08 0.02 0.02\nv 0.05 0.08 0.1\nf 1 2 3\n";

class SceneOutput : public Command {
 protected:
  SceneOutput() {
    write("rest.xml", kRest);
    write("skin.obj", kSkin);
    write("bar.scn", bar_with(""));
    fs::create_directory(directory_ / "sub");
  }
};

// A run makes last.json.part before it makes last.json.
TEST_F(SceneOutput, WhatIsReadIsNoUnfinishedFileEither) {
  const std::string text = read("bar.scn");
  fs::rename(directory_ / "bar.scn", directory_ / "last.vtu.part");
  fs::copy_file(directory_ / "skin.obj", directory_ / "page.html.part");
  for (const char* arguments : {"run last.vtu.part --final last.vtu", "run last.vtu.part --summary last.vtu",
                                "mesh export last.vtu.part -o last.vtu"})
    fails(arguments, 5, "last.vtu.part: is an input, and will not be written over");
  EXPECT_EQ(read("last.vtu.part"), text);

  // nor is a file of the user's that has the name, nor can such a name be asked for
  write("bar.scn", text);
  fails("run bar.scn --final page.html", 5, "page.html.part: is in the way, and no unfinished file");
  fails("mesh export bar.scn -o last.vtu", 5, "last.vtu.part: is in the way");
  EXPECT_EQ(read("page.html.part"), kSkin);
  fails("run bar.scn --final a.json.part --summary a.json", 5, "a.json.part: ends in .part");
}

// Whatever option names it, and whatever the verb. InputFiles.* has links and other names.
TEST_F(SceneOutput, NeverReplacesWhatIsRead) {
  fs::create_hard_link(directory_ / "bar.scn", directory_ / "same.scn");
  fs::create_symlink("skin.obj", directory_ / "link.obj");
  succeeds("run bar.scn --out earlier --steps 1 --frames 0");
  succeeds("mesh convert skin.obj -o sub/mesh_000000.vtu");  // among the files of a run
  succeeds("bench --scene bar.scn --json b.json");
  write("log", "mine\n");
  write("reads.scn",
        replaced(replaced(bar_with(""), "MeshOBJLoader", "MeshVTKLoader"), "skin.obj", "sub/mesh_000000.vtu"));
  const auto bytes = [&] {
    std::string all;
    for (const char* name : {"bar.scn", "rest.xml", "skin.obj", "log", "b.json", "sub/mesh_000000.vtu",
                             "earlier/manifest.json", "earlier/history.csv"})
      all += read(name);
    return all;
  };
  const std::string before = bytes(), run = "run bar.scn --force ", in_run = run + "--out run ",
                    bench = "bench --scene bar.scn --baseline b.json --ratio 0 --json ", mesh = "sub/mesh_000000.vtu",
                    input = ": is an input", by_run = "is written by the run itself",
                    earlier = "earlier/manifest.json: is a file of an earlier run; --force replaces it",
                    open = "/dev/stdout: is a link of the system's to what is open";
  expect_refused({{run + "--final bar.scn", 5, "bar.scn" + input},
                  {run + "--summary same.scn", 5, "same.scn" + input},
                  {in_run + "--final rest.xml", 5, "rest.xml" + input},
                  {in_run + "--summary skin.obj", 5, "skin.obj" + input},
                  {in_run + "--final link.obj", 5, "link.obj" + input},
                  {in_run + "--final run/history.csv", 5, by_run},
                  {in_run + "--summary run/history.csv", 5, by_run},
                  {"run bar.scn --final earlier/manifest.json", 5, earlier},
                  {"run bar.scn --summary earlier/manifest.json", 5, earlier},
                  {in_run + "--video link.obj.png --final x --summary x", 5,
                   "is being written by another program, or by another option"},
                  {"run bar.scn --out bar.scn", 5, "bar.scn: is a file; an output directory is needed"},
                  {"run reads.scn --out sub --force", 5, mesh + ": is an input of this run"},
                  {"mesh convert " + mesh + " -o " + mesh, 5, input},
                  {"mesh offset " + mesh + " --thickness 1 -o " + mesh, 3, ""},
                  {"compare earlier earlier --out earlier/history.csv", 5, input},
                  {bench + "bar.scn", 5, "bar.scn" + input},
                  {bench + "rest.xml", 5, "rest.xml" + input},
                  {bench + "b.json", 5, "b.json" + input}});
  for (const char* option : {"--final", "--summary"}) {  // as in `--final /dev/stdout >> log`
    const Outcome outcome =
        shell("sh -c \"'" HEXAPLAST_COMMAND "' " + run + "--quiet " + option + " /dev/stdout >> log\"");
    EXPECT_EQ(outcome.code, 5) << option;
    EXPECT_TRUE(has(outcome.err, open));
  }
  EXPECT_NE(hexaplast("mesh export bar.scn -o skin.obj").code, 0);
  EXPECT_NE(hexaplast("mesh cage " + mesh + " --cells 2 -o " + mesh).code, 0);
  EXPECT_TRUE(bytes() == before);
}

// Names of files and components, and values, come from strangers: a terminal must not obey them.
TEST_F(SceneOutput, NamesDoNotSteerTheTerminal) {
  const std::string escape =
                        "\x1b]0;owned\x07\x1b[2J\xc2\x9b"
                        "31m\x7f",
                    odd = "bar" + escape + "\xc3\xa9.scn";
  const std::string shown = "bar\\u001b]0;owned\\u0007\\u001b[2J\\u009b31m\\u007f\xc3\xa9";
  const std::string shown_of_xml = "bar\\u009b31m\\u007f\xc3\xa9";  // which has no others
  write(odd, bar_with(""));
  const auto expect_shown = [&](const std::string& arguments, int code, const std::string& text) {
    const Outcome outcome = hexaplast(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    const std::string all = outcome.out + outcome.err;
    EXPECT_FALSE(has(all, "\x1b")) << arguments;
    EXPECT_FALSE(has(all, "\x7f")) << arguments;
    EXPECT_FALSE(has(all, "\xc2\x9b")) << arguments;
    EXPECT_TRUE(has(all, text)) << arguments;
  };
  const std::string name = "'" + odd + "'";
  expect_shown("run " + name, 0, shown);
  expect_shown("check " + name, 0, shown);
  expect_shown("check " + name + " --set 'root.bar" + escape + "\xc3\xa9=1'", 2, shown);
  expect_shown("run " + name + " --out " + name, 5, shown);
  expect_shown("run 'absent " + odd + "'", 5, shown);
  expect_shown("run --" + name, 2, shown);
  expect_shown("sweep " + name + " --out found --vary root/body.youngModulus=1e4", 0, shown);
  fs::copy_file(directory_ / "skin.obj", directory_ / (odd + ".obj"));
  expect_shown("mesh info '" + odd + ".obj'", 0, shown);

  write("named.scn", bar_with("<BoxROI name='a' box='@bar&#155;31m&#127;é.box'/>"));
  expect_shown("check named.scn", 3, shown_of_xml);
  // nor do they make lines of their own, or turn them
  const std::string forged = "safe.txt&#10;  memory              1.0 MB&#10;slab.scn: warning: forged &#x202E;";
  const std::string one_line = "safe.txt\\u000a  memory              1.0 MB\\u000aslab.scn: warning: forged \\u202e";
  write("named.scn", bar_with("<BoxROI box='@" + forged + ".box'/>"));
  fails("check named.scn", 3, one_line);
  EXPECT_EQ(hexaplast("run 'a\nb.scn: error: forged'").err, "a\\u000ab.scn: error: forged: error: no such file\n");
  write("named.scn", bar_with("<BoxROI box='0 0 0 bar&#155;31m&#127;é'/>"));
  expect_shown("check named.scn", 3, shown_of_xml);
  write("named.scn", bar_with("<BoxROI box='bar&#27;]0;owned'/>"));
  expect_shown("check named.scn", 3, "invalid character number");
}

}  // namespace
