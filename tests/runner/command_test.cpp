// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/command.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <regex>

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Outcome;

// A bar of two hexahedra, pulled at one end.
const std::string kBar =
    "<Node name='root' gravity='0 0 0'>\n<DefaultAnimationLoop/><RunSettings steps='4'/>\n<Node name='bar'>"
    "<EulerImplicitSolver/><SparseLDLSolver/>\n<RegularGridTopology n='3 2 2'/><MechanicalObject/><DiagonalMass/>\n"
    "<HexahedronElastoplasticFEMForceField name='material'/>\n<FixedProjectiveConstraint indices='0 3 6 9'/>"
    "<ConstantForceField name='pull' indices='2' forces='1 0 0'/></Node></Node>";

TEST_F(Command, ShowsASummaryAndWritesNothingElse) {
  write("bar.scn", kBar);
  const Outcome outcome = hexaplast("run bar.scn");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
  for (const char* line : {"bar: 4 steps of 0.01 s, to t = 0.04 s", "hexahedra           2", "plastic elongation",
                           "plastic twist", "volume error", "largest strain", "hex/ms", "state hash"}) {
    EXPECT_NE(outcome.out.find(line), std::string::npos) << line << " is missing in\n" << outcome.out;
  }
  // where nothing has flowed there is none, and what rounding leaves is zero
  EXPECT_EQ(outcome.out.find("plastic strain"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("-0.000"), std::string::npos) << outcome.out;
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 3);  // the scene, out and err
}

TEST_F(Command, ControlCodesStayOutOfFiles) {
  write("bar.scn", kBar);
  const Outcome outcome = hexaplast("run bar.scn --steps 50");
  EXPECT_EQ((outcome.out + outcome.err).find('\x1b'), std::string::npos);
  EXPECT_EQ((outcome.out + outcome.err).find('\r'), std::string::npos);
}

TEST_F(Command, QuietPrintsNothing) {
  write("bar.scn", kBar);
  const Outcome outcome = hexaplast("run bar.scn --quiet --set bar/material.plasticFlowRate=20");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out + outcome.err, "");
}

TEST_F(Command, StepsAndAttributesOfTheCommandLineCountBeforeTheScene) {
  write("bar.scn", kBar);
  EXPECT_NE(hexaplast("run bar.scn --steps 2 --set root.dt=0.5 --set bar/pull.forces='0 0 0'")
                .out.find("2 steps of 0.5 s, to t = 1 s"),
            std::string::npos);
}

TEST_F(Command, TheHashDoesNotDependOnThreads) {
  write("bar.scn", kBar);
  const auto hash = [&](const std::string& options) {
    const std::string out = hexaplast("run bar.scn " + options).out;
    return out.substr(out.find("state hash"));
  };
  EXPECT_EQ(hash("--threads 1"), hash("--threads 3"));
  EXPECT_NE(hash("--threads 1"), hash("--set bar/pull.forces='2 0 0'"));
}

TEST_F(Command, VersionAndHelpAreNoErrors) {
  const Outcome version = hexaplast("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out.rfind("hexaplast ", 0), 0u);
  const Outcome help = hexaplast("run --help");
  EXPECT_EQ(help.code, 0);
  for (const char* option : {"--steps", "--out", "--final", "--threads", "--set", "--frames", "--force", "--quiet",
                             "--plugin-path", "Exit codes"}) {
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
  }
}

TEST_F(Command, UsageErrorsEndWith2) {
  write("bar.scn", kBar);
  write("endless.scn",
        "<Node><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/><MechanicalObject position='0 0 0'/>"
        "<UniformMass totalMass='1'/></Node>");
  for (const char* arguments :
       {"", "walk", "run", "run bar.scn --nonsense", "run bar.scn --steps -1", "run bar.scn --steps x",
        "run bar.scn --threads 0", "run bar.scn --frames 2", "run bar.scn --out", "run bar.scn --set nonsense",
        "run bar.scn --set bar/material.yieldStres=1", "run bar.scn --set bar/material.yieldStress=-1",
        "run bar.scn --set bar/material.yieldStress=x", "run bar.scn --set bar/pull.indices=@nowhere.indices",
        "run bar.scn --set baar/material.yieldStress=1", "run endless.scn"}) {
    const Outcome outcome = hexaplast(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err, "") << arguments;
  }
}

TEST_F(Command, AnOverrideThatOnlyTheSceneRefusesEndsWith3) {
  write("bar.scn", kBar);
  for (const auto& [assignment, part] : {std::pair{"bar/pull.indices=99", "ConstantForceField.indices: "},
                                         {"bar/material.plasticFlowRate=1e6 --set bar/material.yieldStress=1",
                                          "plasticFlowRate = 1000000 1/s times dt = 0.01 s is 10000"}}) {
    const Outcome outcome = hexaplast(std::string("run bar.scn --set ") + assignment);
    EXPECT_EQ(outcome.code, 3) << assignment;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  }
}

TEST_F(Command, MisspeltSubcommandsAndOptionsAreToldTheNearest) {
  for (const auto& [arguments, message] : std::vector<std::pair<std::string, std::string>>{
           {"rnu bar.scn", "hexaplast: error: unknown subcommand 'rnu'\n  hint: did you mean 'run'?"},
           {"walk", "hexaplast: error: unknown subcommand 'walk'"},
           {"mesh exprt bar.scn", "hexaplast mesh: error: unknown subcommand 'exprt'\n  hint: did you mean 'export'?"},
           {"--vesion", "hexaplast: error: unknown option '--vesion'\n  hint: did you mean '--version'?"},
           {"run bar.scn --stpes 3", "hexaplast run: error: unknown option '--stpes'\n  hint: did you mean '--steps'?"},
           {"run --Threads=4 bar.scn",
            "hexaplast run: error: unknown option '--Threads'\n  hint: did you mean '--threads'?"},
           {"run bar.scn --nonsense", "hexaplast run: error: unknown option '--nonsense'"},
           {"run bar.scn other.scn", "hexaplast run: error: unexpected argument 'other.scn'"}}) {
    const Outcome outcome = hexaplast(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_EQ(outcome.err, message + "\nRun with --help for more information.\n") << arguments;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST_F(Command, RejectedScenesEndWith3) {
  write("bad.scn", "<Node>\n<Nonsense/>\n<RunSettings stepz='3'/>\n</Node>");
  const Outcome outcome = hexaplast("run bad.scn");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(
      outcome.err,
      "bad.scn:2: error: Nonsense: unknown component\n  hint: a scene with other components of SOFA runs in SOFA, "
      "with the plugin Hexaplast\n"
      "bad.scn:3: error: RunSettings.stepz: unknown attribute\n  hint: did you mean 'steps'?\n");

  write(
      "two.scn",
      "<Node><DefaultAnimationLoop/><RunSettings "
      "steps='1'/>\n<EulerImplicitSolver name='first'/><CGLinearSolver/>\n<Node><EulerImplicitSolver/><CGLinearSolver/>"
      "<MechanicalObject position='0 0 0'/><UniformMass totalMass='1'/></Node></Node>");
  const Outcome two = hexaplast("run two.scn");
  EXPECT_EQ(two.code, 3);
  EXPECT_EQ(two.err,
            "two.scn:3: error: EulerImplicitSolver: EulerImplicitSolver 'first' moves everything in its node and below "
            "already\n");

  write("mass.scn",
        "<Node><DefaultAnimationLoop/><RunSettings steps='1'/><EulerImplicitSolver/><CGLinearSolver/><MechanicalObject "
        "position='0 0 0'/><UniformMass totalMass='1'/></Node>");
  EXPECT_EQ(hexaplast("run mass.scn").code, 0);
  EXPECT_EQ(hexaplast("run mass.scn --final state.json").code, 3);
}

TEST_F(Command, NumericalFailureEndsWith4AndNamesTheStep) {
  write("bar.scn", kBar);
  const Outcome outcome = hexaplast("run bar.scn --set bar/pull.forces='1e308 0 0'");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_NE(outcome.err.find("bar.scn: error: step "), std::string::npos) << outcome.err;
}

TEST_F(Command, UnreadableAndUnwritableFilesEndWith5) {
  write("bar.scn", kBar);
  write("file", "");
  EXPECT_EQ(hexaplast("run absent.scn").err, "absent.scn: error: no such file\n");
  EXPECT_EQ(hexaplast("run absent.scn").code, 5);
  EXPECT_EQ(hexaplast("run .").code, 5);
  EXPECT_EQ(hexaplast("run bar.scn --final absent/state.json").code, 5);
  EXPECT_EQ(hexaplast("run bar.scn --out file").code, 5);
}

TEST_F(Command, PluginsThatCannotBeUsedEndWith6) {
  write("absent.scn", "<Node>\n<RequiredPlugin name='Absent'/></Node>");
  const Outcome absent = hexaplast("run absent.scn --plugin-path elsewhere");
  EXPECT_EQ(absent.code, 6);
  EXPECT_EQ(
      absent.err.rfind("absent.scn:2: error: RequiredPlugin: plugin 'Absent': there is no Absent.so or libAbsent.so; "
                       "search path: elsewhere:",
                       0),
      0u)
      << absent.err;

  const fs::path real = fs::path(HEXAPLAST_COMMAND).parent_path() / ".." / HEXAPLAST_PLUGIN_DIR / "Hexaplast.so";
  const std::string bytes = content(real);
  ASSERT_FALSE(bytes.empty()) << real;
  const auto renamed = [&](const std::string& symbol) {
    std::string other = bytes;
    for (std::size_t at = other.find(symbol); at != other.npos; at = other.find(symbol, at)) other[at] = 'H';
    return other;
  };
  std::string other_number = bytes;
  const std::size_t tag = bytes.find("hexaplast plugin");
  ASSERT_NE(tag, bytes.npos);
  other_number[tag + 20] = 99;  // behind the magic and the size of the tag: the number of the interface

  const std::pair<std::string, std::string> cases[] = {
      {"", "it is damaged, or no shared library"},
      {"just some text, longer than any header could be: " + std::string(200, '.'), "it is not a shared library"},
      {renamed("hexaplast_plugin_abi_tag"), "it carries no hexaplast_plugin_abi_tag of this program"},
      {renamed("hexaplast_register_components"), "it has no function hexaplast_register_components"},
      {other_number, "it was built for another component interface: 99, must be 10"},
  };
  write("other.scn", "<Node>\n<RequiredPlugin pluginName='Sofa.Component.Mass Other'/></Node>");
  for (const auto& [file, reason] : cases) {
    write("libOther.so", file);
    for (const char* arguments :
         {"run other.scn --plugin-path .", "check other.scn --plugin-path .", "list --plugin Other --plugin-path ."}) {
      const Outcome outcome = hexaplast(arguments);
      EXPECT_EQ(outcome.code, 6) << arguments << ": " << reason;
      EXPECT_NE(outcome.err.find(reason + "; search path: .:"), std::string::npos) << outcome.err;
    }
  }
}

TEST_F(Command, AScenesPluginIsANameNeverAPath) {
  fs::copy_file(fs::path(HEXAPLAST_COMMAND).parent_path() / ".." / HEXAPLAST_PLUGIN_DIR / "Hexaplast.so",
                directory_ / "libOther.so");
  for (const std::string& name :
       {(directory_ / "libOther.so").string(), std::string("./Other"), std::string("../Other"), std::string(".")}) {
    write("path.scn", "<Node>\n<RequiredPlugin pluginName='" + name + "'/></Node>");
    const Outcome outcome = hexaplast("run path.scn --plugin-path .");
    EXPECT_EQ(outcome.code, 6) << name;
    EXPECT_NE(outcome.err.find("never by path"), std::string::npos) << outcome.err;
  }
  // the directory of the scene is no place for plugins by itself
  write("here.scn", "<Node>\n<RequiredPlugin pluginName='Other'/></Node>");
  EXPECT_NE(hexaplast("run here.scn").err.find("there is no Other.so or libOther.so"), std::string::npos);
}

TEST_F(Command, ASignalEndsTheRunAfterTheStep) {
  write("bar.scn", kBar);
  const std::string forever = "run bar.scn --steps 1000000000";
  // --foreground: otherwise timeout signals its group too, and the second signal ends the program at once
  const Outcome interrupted = hexaplast(forever, "timeout --foreground --preserve-status -s INT 0.5");
  EXPECT_EQ(interrupted.code, 130);
  EXPECT_NE(interrupted.out.find("state hash"), std::string::npos);
  EXPECT_NE(interrupted.err.find("warning: ended by signal 2 after step "), std::string::npos);
  EXPECT_EQ(hexaplast(forever, "timeout --foreground --preserve-status -s TERM 0.5").code, 143);
}

TEST_F(Command, ClosedStreamsStayOutOfFiles) {
  write("bar.scn", kBar);
  const std::string line = "cd '" + directory_.string() +
                           "' && '" HEXAPLAST_COMMAND
                           "' run bar.scn --out out --frames 0 --set bar/CGLinearSolver1.iterations=1 <&- >&- 2>&-";
  write("bar.scn", std::regex_replace(kBar, std::regex("SparseLDLSolver"), "CGLinearSolver"));
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 5) << "the summary is lost";
  const std::string history = content(directory_ / "out" / "history.csv");
  EXPECT_EQ(std::count(history.begin(), history.end(), '\n'), 6);  // header, initial state, four steps
  EXPECT_EQ(history.find("warning"), std::string::npos);
}

TEST_F(Command, ASolverThatStopsEarlyIsReported) {
  write("bar.scn", std::regex_replace(kBar, std::regex("SparseLDLSolver"),
                                      "CGLinearSolver iterations='1' tolerance='1e-12' threshold='0'"));
  const Outcome outcome = hexaplast("run bar.scn");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("warning: the linear solver stopped before its tolerance in 4 of 4 steps"),
            std::string::npos)
      << outcome.err;
}

TEST_F(Command, TheFinalFileMayLieInTheOutputDirectory) {
  write("bar.scn", kBar);
  EXPECT_EQ(hexaplast("run bar.scn --out files --frames 0 --final files/final.json").code, 0);
  EXPECT_TRUE(fs::exists(directory_ / "files" / "final.json"));
}

TEST_F(Command, OverridesMayNameTheRootOrNot) {
  write("bar.scn", kBar);
  for (const char* path : {"bar/material", "root/bar/material"})
    EXPECT_EQ(hexaplast(std::string("run bar.scn --set ") + path + ".youngModulus=100").code, 0) << path;
}

TEST_F(Command, AClosedOutputDoesNotCrashIt) {
  write("bar.scn", kBar);
  const std::string scene = " '" + (directory_ / "bar.scn").string() + "'";
  const auto code = [&](const std::string& arguments) {
    return WEXITSTATUS(std::system(("'" HEXAPLAST_COMMAND "' " + arguments + " >&- 2>&-").c_str()));
  };
  for (const std::string& arguments : {"run" + scene, "check" + scene, std::string("list"), std::string("--help")})
    EXPECT_EQ(code(arguments), 5) << arguments << ": what it says is lost";
  EXPECT_EQ(code("run --quiet" + scene), 0) << "nothing is lost";
}

// What SofaPython3 would add to the scene graph, in XML: the same scene, so the same bits.
TEST_F(Command, ThePythonSceneIsTheSceneInXml) {
  const fs::path source(HEXAPLAST_SOURCE_DIR);
  const Outcome recorded = shell("python3 '" + std::string(HEXAPLAST_TEST_DATA) + "/python/record_scene.py' '" +
                                 (source / "scenes" / "bar_stretch.py").string() + "'");
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  write("python.scn", recorded.out);
  ASSERT_EQ(hexaplast("run python.scn --steps 60 --final python.json").code, 0);
  ASSERT_EQ(
      hexaplast("run '" + (source / "scenes" / "bar_stretch_high.scn").string() + "' --steps 60 --final xml.json").code,
      0);
  EXPECT_EQ(content(directory_ / "python.json"), content(directory_ / "xml.json"));
  EXPECT_NE(content(directory_ / "xml.json").find("state_hash"), std::string::npos);
}

}  // namespace
