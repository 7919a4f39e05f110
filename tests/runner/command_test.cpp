// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/command.hpp"

#include <regex>

#include "support/held_bar.hpp"

namespace {

using namespace hexaplast::support;

// A bar of two hexahedra, pulled at one end.
const std::string kBar = in_a_node(held_bar("", "", "indices='2' forces='1 0 0'"), "steps='4'");

TEST_F(Command, ShowsASummaryAndWritesNothingElse) {
  write("bar.scn", kBar);
  const Outcome outcome = succeeds("run bar.scn");
  EXPECT_EQ(outcome.err, "");
  for (const char* line : {"bar: 4 steps of 0.01 s, to t = 0.04 s", "hexahedra           2", "plastic elongation",
                           "plastic twist", "volume error", "largest strain", "hex/ms", "state hash"}) {
    EXPECT_TRUE(has(outcome.out, line));
  }
  // where nothing has flowed there is none, and what rounding leaves is zero
  EXPECT_FALSE(has(outcome.out, "plastic strain"));
  EXPECT_FALSE(has(outcome.out, "-0.000"));
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 3);  // the scene, out and err
}

TEST_F(Command, WritesNoControlCodesIntoFilesAndNothingWhereItIsQuiet) {
  write("bar.scn", kBar);
  const Outcome outcome = hexaplast("run bar.scn --steps 50");
  EXPECT_FALSE(has(outcome.out + outcome.err, "\x1b"));
  EXPECT_FALSE(has(outcome.out + outcome.err, "\r"));
  const Outcome quiet = succeeds("run bar.scn --quiet --set bar/material.plasticFlowRate=20");
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(Command, StepsAndAttributesOfTheCommandLineCountBeforeTheScene) {
  write("bar.scn", kBar);
  for (const char* pull : {"bar/pull.forces", "root/bar/pull.forces"})
    EXPECT_TRUE(has(hexaplast("run bar.scn --steps 2 --set root.dt=0.5 --set " + std::string(pull) + "='0 0 0'").out,
                    "2 steps of 0.5 s, to t = 1 s"));
}

TEST_F(Command, VersionAndHelpAreNoErrors) {
  const Outcome version = succeeds("--version");
  EXPECT_EQ(version.out.rfind("hexaplast ", 0), 0u);
  const Outcome help = succeeds("run --help");
  for (const char* option : {"--steps", "--out", "--final", "--threads", "--set", "--frames", "--force", "--quiet",
                             "--plugin-path", "Exit codes"}) {
    EXPECT_TRUE(has(help.out, option));
  }
}

// The run stands still for most of the ten seconds.
TEST_F(Command, ALogOfALongRunSaysHowMuchIsLeft) {
  write("bar.scn", kBar);
  const Outcome run = shell("{ '" HEXAPLAST_COMMAND
                            "' run bar.scn --steps 100000000 & sleep 1; kill -STOP $!; sleep 10; "
                            "kill -CONT $!; sleep 1; kill $!; wait $!; }");
  EXPECT_TRUE(std::regex_search(run.err, std::regex("^[0-9]+ of 100000000  t = [0-9.]+ s  [0-9]+ yielded  [0-9.e+]+ "
                                                    "per s  [0-9]+ h [0-9]+ min left\n")))
      << run.err;
  EXPECT_FALSE(has(run.err, "\x1b")) << "no control codes";
}

// 2: the command line; 3: the scene; 5: files; 6: plugins.
TEST_F(Command, EndsWithTheCodeOfWhatIsWrongAndSaysIt) {
  write("bar.scn", kBar);
  write("file", "");
  write("bad.scn", "<Node>\n<Nonsense/>\n<RunSettings stepz='3'/>\n</Node>");
  write("mass.scn",
        "<Node><DefaultAnimationLoop/><EulerImplicitSolver/><CGLinearSolver/><MechanicalObject position='0 0 0'/>"
        "<UniformMass totalMass='1'/></Node>");
  EXPECT_TRUE(has(succeeds("").out, "Subcommands:")) << "alone it prints its help";
  const std::string set = "run bar.scn --set bar/material.", endless(5000, 'n'), help = "\nRun with --help",
                    empty = ": must not be empty" + help, none = "error: unknown ";
  expect_refused(
      {{"walk", 2, "hexaplast: " + none + "subcommand 'walk'" + help},
       {"rnu bar.scn", 2, "hexaplast: " + none + "subcommand 'rnu'\n  hint: did you mean 'run'?" + help},
       {"mesh", 2, "error: "},
       {"mesh exprt bar.scn", 2, "hexaplast mesh: " + none + "subcommand 'exprt'\n  hint: did you mean 'export'?"},
       {"--vesion", 2, "hexaplast: " + none + "option '--vesion'\n  hint: did you mean '--version'?"},
       {"run bar.scn --stpes 3", 2, "run: " + none + "option '--stpes'\n  hint: did you mean '--steps'?"},
       {"run --Threads=4 bar.scn", 2, "run: " + none + "option '--Threads'\n  hint: did you mean '--threads'?"},
       {"run bar.scn --nonsense", 2, "run: " + none + "option '--nonsense'" + help},
       {"run bar.scn other.scn", 2, "run: error: unexpected argument 'other.scn'"},
       {"run", 2, "hexaplast run: error: "},
       {"resume", 2, "hexaplast resume: error: "},
       {"check", 2, "hexaplast check: error: "},
       {"mesh grid", 2, "hexaplast mesh grid: error: "},
       {"run bar.scn --steps -1", 2, "--steps"},
       {"run bar.scn --steps x", 2, "--steps"},
       {"run bar.scn --threads 0", 2, "--threads"},
       {"run bar.scn --frames 2", 2, "--frames"},
       {"run bar.scn --out", 2, "--out"},
       {"run bar.scn --checkpoint every=5", 2, "--checkpoint"},
       {"run bar.scn --out run --checkpoint 5", 2, "--checkpoint"},
       {"run bar.scn --out run --checkpoint every=0", 2, "--checkpoint"},
       {"run bar.scn --out run --checkpoint every=2x", 2, "--checkpoint"},
       {"resume run --steps -1", 2, "--steps"},
       {"run mass.scn", 2, "--steps"},
       {"run ''", 2, empty},
       {"resume ''", 2, empty},
       {"check ''", 2, empty},
       {"mesh info ''", 2, empty},
       {"run bar.scn --out ''", 2, empty},
       {"run bar.scn --final ''", 2, empty},
       {"compare bar.scn ''", 2, empty},
       {"run bar.scn --set nonsense", 2, "--set nonsense: error: "},
       {set + "yieldStres=1", 2, "yieldStres"},
       {set + "yieldStress=-1", 2, "yieldStress"},
       {"run bar.scn --set bar/pull.indices=@nowhere.indices", 2, "nowhere"},
       {"run bar.scn --set baar/material.yieldStress=1", 2, "baar"},
       // what only the scene can refuse
       {"run bar.scn --set bar/pull.indices=99", 3, "ConstantForceField.indices: "},
       {set + "restShape=joined --set bar/material.plasticFlowRate=1e6 --set bar/material.yieldStress=1", 3,
        "plasticFlowRate = 1000000 1/s times dt = 0.01 s is 10000"},
       {"run bad.scn", 3,
        "bad.scn:2: error: Nonsense: unknown component\n  hint: a scene with other components of SOFA runs in "
        "SOFA, with the plugin Hexaplast\nbad.scn:3: error: RunSettings.stepz: unknown attribute\n  hint: did you mean "
        "'steps'?\n"},
       {"check bad.scn", 3, "bad.scn:2: error: Nonsense: unknown component\n"},
       {"run mass.scn --steps 1 --final state.json", 3, "mass.scn"},
       {"mesh export mass.scn -o mass.vtu", 3, "no body in the scene: there is nothing to export"},
       {"mesh export bar.scn -o bar.stl", 2, "bar.stl"},
       {"mesh export bar.scn -o nowhere/bar.vtu", 5, "nowhere/bar.vtu"},
       {"run absent.scn", 5, "absent.scn: error: no such file\n"},
       {"check absent.scn", 5, "absent.scn: error: no such file\n"},
       {"run .", 5, ".: error: is not a file\n"},
       {"mesh info .", 5, ".: error: is not a file\n"},
       {"resume absent", 5, "hexaplast: error: absent: no such file\n"},
       {"run " + endless, 5, endless + ": error: cannot be read: File name too long\n"},
       {"resume " + endless, 5, endless + ": cannot be read: File name too long\n"},
       {"run bar.scn --final absent/state.json", 5, "absent/state.json"},
       {"run bar.scn --out file", 5, "file: is a file"}});
  EXPECT_FALSE(is_there("run"));
  succeeds("run mass.scn --steps 1");
}

// What is wrong with files of plugins is tested in PluginFiles.
TEST_F(Command, PluginsThatCannotBeUsedEndWith6) {
  write("absent.scn", "<Node>\n<RequiredPlugin name='Absent'/></Node>");
  write("other.scn", "<Node>\n<RequiredPlugin pluginName='Sofa.Component.Mass Other'/></Node>");
  write("path.scn", "<Node>\n<RequiredPlugin pluginName='./Other'/></Node>");
  write("libOther.so", "just some text, longer than any header could be: " + std::string(200, '.'));
  const std::string none = "there is no Absent.so or libAbsent.so; search path: elsewhere:";
  expect_refused(
      {{"run absent.scn --plugin-path elsewhere", 6, "absent.scn:2: error: RequiredPlugin: plugin 'Absent': " + none},
       {"check other.scn --plugin-path .", 6, "it is damaged, or no shared library; search path: .:"},
       {"list --plugin Other --plugin-path .", 6, "it is damaged, or no shared library; search path: .:"}});

  // the directory of the scene is no place for plugins by itself
  fs::copy_file(fs::path(HEXAPLAST_COMMAND).parent_path() / ".." / HEXAPLAST_PLUGIN_DIR / "Hexaplast.so",
                directory_ / "libOther.so", fs::copy_options::overwrite_existing);
  expect_refused({{"run other.scn", 6, "there is no Other.so or libOther.so"},
                  {"run path.scn --plugin-path .", 6, "never by path"}});
}

TEST_F(Command, ClosedStreamsStayOutOfFiles) {
  write("bar.scn", kBar);
  const std::string line = "cd '" + directory_.string() +
                           "' && '" HEXAPLAST_COMMAND
                           "' run bar.scn --out out --frames 0 --set bar/CGLinearSolver1.iterations=1 <&- >&- 2>&-";
  write("bar.scn", std::regex_replace(kBar, std::regex("SparseLDLSolver"), "CGLinearSolver"));
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 5) << "the summary is lost";
  const std::string history = read("out/history.csv");
  EXPECT_EQ(std::count(history.begin(), history.end(), '\n'), 6);  // header, initial state, four steps
  EXPECT_FALSE(has(history, "warning"));
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
  succeeds("run python.scn --steps 60 --final python.json");
  succeeds("run '" + (source / "scenes" / "bar_stretch_high.scn").string() + "' --steps 60 --final xml.json");
  EXPECT_EQ(read("python.json"), read("xml.json"));
  EXPECT_TRUE(has(read("xml.json"), "state_hash"));
}

TEST_F(Command, BenchWritesRecordsAndItsOwnBaselineHolds) {
  const Outcome outcome = succeeds("bench --quick --sizes 100 --threads 1,2 --json now.json");
  EXPECT_TRUE(has(outcome.out, "state hash"));
  ASSERT_EQ(json("now.json").size(), 36u);

  // half of the lead is far beyond what noise takes; ten times of it is never there
  const std::string again = "bench --quick --sizes 100 --json - --baseline now.json --ratio ";
  const Outcome behind = fails(again + "10", 4, "times the dense peer, less than 10 of the baseline's");
  EXPECT_EQ(Json::parse(behind.out).size(), 36u) << "records are written before the command fails";
  succeeds(again + "0.01");
}

TEST_F(Command, BenchMeasuresAScene) {
  write("bar.scn",
        "<Node><DefaultAnimationLoop/><RunSettings steps='6'/><EulerImplicitSolver/><CGLinearSolver iterations='7' "
        "tolerance='0' threshold='0'/><RegularGridTopology n='4 3 3' max='1 .5 .5'/><MechanicalObject/><DiagonalMass "
        "totalMass='2'/><HexahedronElastoplasticFEMForceField youngModulus='2000' yieldStress='1' "
        "plasticFlowRate='2'/></Node>");
  const Outcome outcome = succeeds("bench --scene bar.scn --threads 1,3 --json -");
  const Json records = Json::parse(outcome.out);
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0]["size"], 12);
  EXPECT_EQ(records[0]["iterations"], 7);
  EXPECT_EQ(records[0]["solver"], "CGLinearSolver");
  EXPECT_EQ(records[1]["threads"], 3);
  const Outcome ran = hexaplast("run bar.scn");
  EXPECT_TRUE(has(ran.out, records[0]["state_hash"].get<std::string>())) << "a run ends in its state";
}

// BenchBatch has what the records say.
TEST_F(Command, BenchStepsABatchAtOnce) {
  const Outcome outcome = succeeds("bench --batch --quick --sizes 90 --bodies 5 --threads 1,3 --json batch.json");
  EXPECT_TRUE(has(outcome.out, "together"));
  ASSERT_EQ(json("batch.json").size(), 8u);  // two modes, two precisions, two numbers of threads
  EXPECT_EQ(json("batch.json")[0]["bodies"], 5);
}

TEST_F(Command, BenchRefusesWhatMeansNothing) {
  for (const char* arguments :
       {"--sizes 0", "--sizes 3q", "--sizes 9999k", "--threads 0", "--simd SSE9", "--ratio 0.5",
        "--scene a.scn --quick", "--batch --scene a.scn", "--batch --baseline now.json", "--batch --bodies 0",
        "--bodies 5", "--batch --bodies 30000 --sizes 90", "--batch --bodies 60000 --sizes 23", "--batch --sizes 0"})
    EXPECT_EQ(hexaplast(std::string("bench ") + arguments).code, 2) << arguments;
  EXPECT_EQ(hexaplast("bench --quick --sizes 50 --baseline missing.json").code, 3);
  EXPECT_EQ(hexaplast("bench --quick --sizes 50 --json missing/now.json").code, 5);
}

}  // namespace
