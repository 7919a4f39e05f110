// SPDX-License-Identifier: LGPL-2.1-or-later
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "support/command.hpp"
#include "support/csv.hpp"
#include "support/pulled_bar.hpp"

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::Csv;
using hexaplast::support::kSection;
using hexaplast::support::Outcome;
using Json = nlohmann::json;

class Sweep : public Command {
 protected:
  Csv table() { return Csv(content(directory_ / "found/sweep.csv")); }

  /// Processes whose working directory is this test's.
  int num_processes() {
    int count = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
      std::error_code none;
      count += fs::read_symlink(entry.path() / "cwd", none) == directory_;
    }
    return count;
  }
};

const std::string kTwoByTwo =
    "sweep bar.scn --out found --jobs 2 --vary body.youngModulus=1000:4000:2 "
    "--vary 'pull.forces=0 0 0 12.5 0 0,0 0 0 -5 0 0'";

TEST_F(Sweep, RunsEveryCombinationAndTellsWhatItCameTo) {
  write("bar.scn", hexaplast::support::pulled_bar());
  const Outcome outcome = hexaplast(kTwoByTwo);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_NE(outcome.out.find("bar: 4 of 4 runs done, 0 failed: found/sweep.csv"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find('\r'), std::string::npos);

  const Csv found = table();
  ASSERT_EQ(found.num_rows(), 4u);
  std::size_t row = 0;
  for (const double modulus : {1000.0, 4000.0})
    for (const double force : {50.0, -20.0}) {
      EXPECT_EQ(found.text(row, "run"), std::to_string(row + 1));
      EXPECT_EQ(found.number(row, "body.youngModulus"), modulus);
      EXPECT_EQ(found.text(row, "pull.forces"), force > 0 ? "0 0 0 12.5 0 0" : "0 0 0 -5 0 0");
      EXPECT_EQ(found.text(row, "exit_code"), "0");
      EXPECT_NEAR(found.number(row, "world_elongation"), force / (modulus * kSection), 1e-9);
      // the work of a force that grows in proportion: F^2 L / (2 E A)
      EXPECT_NEAR(found.number(row, "elastic_energy"), force * force / (2 * modulus * kSection), 1e-8);
      EXPECT_EQ(found.text(row, "plastic_elongation"), "0.0");
      ++row;
    }

  // a row is what a run of its own comes to
  EXPECT_EQ(hexaplast("run bar.scn --quiet --summary one.json --set body.youngModulus=4000").code, 0);
  EXPECT_EQ(Json::parse(content(directory_ / "one.json"))["state_hash"], found.text(2, "state_hash"));
  EXPECT_NE(content(directory_ / "found/sweep.svg").find("body.youngModulus [Pa]"), std::string::npos);
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_ / "found"), {}), 4);  // plan, table, times and picture
}

// Two springs in series: the elongation of each half of 0.5 m is F / (2 E A).
TEST_F(Sweep, ReachesTheValuesOfARegion) {
  std::string bar = hexaplast::support::pulled_bar();
  bar.replace(bar.rfind("</Node>"), 7, "<MaterialRegion name='tip' indices='1' youngModulus='700'/></Node>");
  write("bar.scn", bar);
  const Outcome outcome = hexaplast("sweep bar.scn --out found --vary tip.youngModulus=500:8000:2");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Csv found = table();
  ASSERT_EQ(found.num_rows(), 2u);
  const auto elongation = [](double tip) { return 50 / kSection / 2 * (1 / 2000.0 + 1 / tip); };
  for (const std::size_t row : {0u, 1u}) {
    const double tip = row == 0 ? 500 : 8000;
    EXPECT_EQ(found.number(row, "tip.youngModulus"), tip);
    EXPECT_NEAR(found.number(row, "world_elongation"), elongation(tip), 1e-9);
  }
  EXPECT_EQ(hexaplast("run bar.scn --quiet --summary one.json --set tip.youngModulus=8000").code, 0);
  EXPECT_EQ(Json::parse(content(directory_ / "one.json"))["state_hash"], found.text(1, "state_hash"));
  const Outcome refused = hexaplast("run bar.scn --set tip.youngModulus='1 2'");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("--set tip.youngModulus=1 2: error: MaterialRegion.youngModulus: 2 values given, must be "
                             "one or 1 (one per hexahedron of the region)"),
            std::string::npos)
      << refused.err;
}

TEST_F(Sweep, GoesOnWhereItWasInterrupted) {
  write("bar.scn", hexaplast::support::pulled_bar());
  ASSERT_EQ(hexaplast(kTwoByTwo).code, 0);
  const Csv whole = table();

  // the second and the fourth run are missing
  std::istringstream lines(content(directory_ / "found/sweep.csv"));
  std::string kept, line;
  for (int number = 0; std::getline(lines, line); ++number)
    if (number != 2 && number != 4) kept += line + "\n";
  std::ofstream(directory_ / "found/sweep.csv") << kept;
  const Outcome outcome = hexaplast(kTwoByTwo);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("run 1 of 4"), std::string::npos);
  EXPECT_NE(outcome.out.find("2 of 4 runs are done already"), std::string::npos);
  EXPECT_NE(outcome.out.find("run 2 of 4"), std::string::npos);
  for (std::size_t row = 0; row < 4; ++row) {
    EXPECT_EQ(table().text(row, "run"), std::to_string(row + 1));
    EXPECT_EQ(table().text(row, "state_hash"), whole.text(row, "state_hash"));
  }
}

TEST_F(Sweep, AnotherSweepIsNotWrittenOver) {
  write("bar.scn", hexaplast::support::pulled_bar());
  const std::string once = "sweep bar.scn --out found --vary body.youngModulus=1000,2000";
  ASSERT_EQ(hexaplast(once).code, 0);
  const std::string before = content(directory_ / "found/sweep.csv");
  for (const auto& [arguments, reason] : std::vector<std::pair<std::string, std::string>>{
           {"sweep bar.scn --out found --vary body.youngModulus=1000,3000",
            "the varied attributes or their values differ"},
           {once + " --steps 3", "the number of steps differs"},
           {once + " --set body.poissonRatio=0.3", "the scene, or what --set makes of it, differs"}}) {
    const Outcome outcome = hexaplast(arguments);
    EXPECT_EQ(outcome.code, 5) << arguments;
    EXPECT_EQ(outcome.err, "hexaplast: error: found: holds another sweep: " + reason + "; --force replaces it\n");
    EXPECT_EQ(content(directory_ / "found/sweep.csv"), before);
  }
  EXPECT_EQ(hexaplast(once + " --steps 3 --force").code, 0);
  EXPECT_NE(content(directory_ / "found/sweep.csv"), before);

  std::ofstream(directory_ / "found/sweep.csv", std::ios::app) << "9,1000,0\n";
  const Outcome outcome = hexaplast(once + " --steps 3");
  EXPECT_EQ(outcome.code, 5);
  EXPECT_EQ(outcome.err, "hexaplast: error: found/sweep.csv:4: is no run of this sweep; --force begins anew\n");
}

// What stands in its directory without a plan is somebody's; links lead elsewhere whoever made them.
TEST_F(Sweep, TouchesNothingThatIsNotItsOwn) {
  write("bar.scn", hexaplast::support::pulled_bar());
  write("victim", "mine");
  const std::string command = "sweep bar.scn --out found --steps 2 --vary body.youngModulus=1000,2000";
  for (const char* name : {"sweep.json", "sweep.csv", "sweep.svg", "run_2", "messages_1.txt"}) {
    fs::create_directories(directory_ / "found");
    const fs::path file = directory_ / "found" / name;
    write(std::string("found/") + name, "mine");
    const Outcome refused = hexaplast(command);
    EXPECT_EQ(refused.code, 5) << name << "\n" << refused.err;
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    EXPECT_EQ(content(file), "mine") << name;

    fs::remove(file);
    fs::create_symlink("../victim", file);
    for (const char* force : {"", " --force"}) {
      const Outcome linked = hexaplast(command + force);
      EXPECT_EQ(linked.code, 5) << name << force << "\n" << linked.err;
      EXPECT_NE(linked.err.find(std::string(name) + ": is a symbolic link"), std::string::npos) << linked.err;
    }
    EXPECT_TRUE(fs::is_symlink(file)) << name;
    fs::remove_all(directory_ / "found");
  }

  // names that are none of its own, and a run's own summary
  fs::create_directories(directory_ / "found/run_1");
  write("found/summary_1.json", "mine");
  EXPECT_EQ(hexaplast(command).code, 5) << "run_1 may be somebody's";
  fs::create_symlink("../../victim", directory_ / "found/run_1/summary.json");
  const Outcome forced = hexaplast(command + " --force");
  EXPECT_EQ(forced.code, 4);
  EXPECT_NE(forced.err.find("run_1/summary.json: is a symbolic link"), std::string::npos) << forced.err;
  fs::remove(directory_ / "found/run_1/summary.json");
  EXPECT_EQ(hexaplast(command + " --force").code, 0);
  EXPECT_FALSE(fs::exists(directory_ / "found/run_1")) << "nothing is left in it";
  EXPECT_EQ(content(directory_ / "found/summary_1.json"), "mine");
  EXPECT_EQ(content(directory_ / "victim"), "mine");

  // nor is the scene replaced, whatever it is called
  fs::rename(directory_ / "bar.scn", directory_ / "found/sweep.svg");
  const Outcome scene = hexaplast("sweep found/sweep.svg --out found --vary body.youngModulus=1000,2000 --force");
  EXPECT_EQ(scene.code, 5);
  EXPECT_NE(scene.err.find("found/sweep.svg: is an input"), std::string::npos) << scene.err;
  EXPECT_EQ(content(directory_ / "found/sweep.svg"), hexaplast::support::pulled_bar());
  fs::create_directory(directory_ / "found/run_1");
  for (const std::string name : {"found/run_1/summary.json", "found/sweep.csv.part"}) {
    fs::copy_file(directory_ / "found/sweep.svg", directory_ / name);
    const Outcome refused = hexaplast("sweep " + name + " --out found --vary body.youngModulus=1000,2000 --force");
    EXPECT_EQ(refused.code, 5);
    EXPECT_NE(refused.err.find(name + ": is an input of this sweep"), std::string::npos) << refused.err;
    EXPECT_EQ(content(directory_ / name), hexaplast::support::pulled_bar());
  }
}

TEST_F(Sweep, ARunThatFailsIsARowAndTheOthersGoOn) {
  write("bar.scn", hexaplast::support::flowing_bar());
  // 0.1 s times 100 1/s is more than the whole excess per step
  const std::string command = "sweep bar.scn --out found --vary body.plasticFlowRate=1,100,2";
  const Outcome outcome = hexaplast(command);
  EXPECT_EQ(outcome.code, 4);
  EXPECT_NE(outcome.err.find("warning: run 2 of 3: body.plasticFlowRate=100: ended with 3: bar.scn:"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("bar: error: 1 of 3 runs failed"), std::string::npos);
  ASSERT_EQ(table().num_rows(), 3u);
  EXPECT_EQ(table().text(1, "exit_code"), "3");
  EXPECT_EQ(table().text(1, "state_hash"), "");
  EXPECT_GT(table().number(2, "plastic_elongation"), table().number(0, "plastic_elongation"));
  EXPECT_NE(content(directory_ / "found/messages_2.txt").find("plasticFlowRate"), std::string::npos);

  // of a sweep whose runs all ended alike it is their code
  const Outcome refused = hexaplast("sweep bar.scn --out refused --vary body.plasticFlowRate=100,200");
  EXPECT_EQ(refused.code, 3) << refused.err;
  EXPECT_NE(refused.err.find("bar: error: 2 of 2 runs failed"), std::string::npos);

  // it would fail again
  const Outcome again = hexaplast(command);
  EXPECT_EQ(again.code, 4);
  EXPECT_NE(again.out.find("3 of 3 runs are done already"), std::string::npos);
}

// A push of 400 N drives the second of these bars through its support.
TEST_F(Sweep, RunsWithoutAMeaningAreWarnedOfAndFailWhereItIsStrict) {
  write("bar.scn", hexaplast::support::flowing_bar());
  const std::string command =
      "sweep bar.scn --out found --vary 'pull.forces=0 0 0 1 0 0 1 0 0 0 0 0,"
      "0 0 0 -2000 0 0 -2000 0 0 -2000 0 0' --set body.yieldStress=1e9";
  const std::string doubt = "run 2 of 2: pull.forces=0 0 0 -2000 0 0 -2000 0 0 -2000 0 0: ";
  const Outcome outcome = hexaplast(command);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("warning: " + doubt), 0u) << outcome.err;
  EXPECT_NE(outcome.err.find("hexahedra are inverted at the end"), std::string::npos) << outcome.err;

  const Outcome other = hexaplast(command + " --strict");
  EXPECT_EQ(other.code, 5);
  EXPECT_NE(other.err.find("--strict is given to one of them only"), std::string::npos) << other.err;
  const Outcome strict = hexaplast(command + " --strict --force");
  EXPECT_EQ(strict.code, 4);
  EXPECT_NE(strict.err.find("warning: " + doubt + "ended with 4: "), std::string::npos) << strict.err;
  EXPECT_EQ(table().text(0, "exit_code"), "0");
  EXPECT_EQ(table().text(1, "exit_code"), "4");
}

TEST_F(Sweep, ASignalEndsItWithAllItsRuns) {
  write("bar.scn", hexaplast::support::flowing_bar());
  // the last two take too long for any test
  const std::string command = "sweep bar.scn --out found --jobs 2 --vary RunSettings1.steps=1,2,500000000,600000000";
  std::thread watch([&] {  // sent when the short runs are in the table, in whatever order they came to their ends
    const auto has_run = [&](const char* row) {
      return content(directory_ / "found/sweep.csv").find(row) != std::string::npos;
    };
    for (int i = 0; i < 2000 && !(has_run("\n1,") && has_run("\n2,")); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::ignore = std::system(("kill -INT $(cat '" + (directory_ / "id").string() + "')").c_str());
  });
  const Outcome outcome =
      shell("sh -c 'echo $$ > id; exec \"" + std::string(HEXAPLAST_COMMAND) + "\" " + command + "'");
  watch.join();
  EXPECT_EQ(outcome.code, 130);
  EXPECT_NE(outcome.err.find("ended by signal 2; the same command resumes it"), std::string::npos) << outcome.err;
  EXPECT_EQ(num_processes(), 0);
  ASSERT_EQ(table().num_rows(), 2u);
  EXPECT_EQ(table().text(1, "exit_code"), "0");
}

// Also with --force, which would take the files from under the hands of the first one.
TEST_F(Sweep, TwoInOneDirectoryAreRefused) {
  write("bar.scn", hexaplast::support::flowing_bar());
  // the second run takes too long for any test
  shell("(setsid sh -c 'echo $$ > id; exec \"" + std::string(HEXAPLAST_COMMAND) +
        "\" sweep bar.scn --out found --jobs 1 --vary RunSettings1.steps=1,500000000' > /dev/null 2>&1 &)");
  for (int i = 0; i < 2000 && content(directory_ / "found/sweep.csv").find("\n1,") == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const std::string second = "sweep bar.scn --out found --vary RunSettings1.steps=1,2";
  for (const char* force : {"", " --force"}) {
    const Outcome refused = hexaplast(second + force);
    EXPECT_EQ(refused.code, 5);
    EXPECT_EQ(refused.err,
              "hexaplast: error: found: another run or sweep is at work there: wait for its end, or end it\n");
  }
  EXPECT_EQ(table().num_rows(), 1u);

  // one that is killed, with its run, keeps nobody out
  shell("kill -KILL -$(cat id)");
  for (int i = 0; i < 2000 && num_processes() > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  int code = 5;  // what is dying holds its files for a moment longer than its name
  for (int i = 0; i < 200 && code == 5; ++i) code = hexaplast(second + " --force").code;
  EXPECT_EQ(code, 0);
}

TEST_F(Sweep, MistakesAreFoundBeforeTheFirstRun) {
  write("bar.scn", hexaplast::support::pulled_bar());
  for (const auto& [vary, message] : std::vector<std::pair<std::string, std::string>>{
           {"body.youngModulus", "must be PATH.attribute=a:b:n"},
           {"body.youngModulus=1:2", "must be PATH.attribute=a:b:n"},
           {"body.youngModulus=1:2:1", "'1' values: must be a whole number from 2"},
           {"body.youngModulus=1:x:3", "'x' is no number"},
           {"body.youngModulus=0:1:3:log", "limits greater than 0"},
           {"body.youngModulus=1,,2", "a value is empty"},
           {"body.youngModulus=1,1", "the value 1 comes twice"},
           {"body.youngModulus=1,2 --vary body.youngModulus=3,4", "is varied already"},
           {"body.youngModulus=1:2:400 --vary body.poissonRatio=0:0.4:400", "more than 100000 runs"},
           {"body.youngModulos=1,2", "did you mean 'youngModulus'?"},
           {"bodi.youngModulus=1,2", "bodi"},
           {"body.youngModulus=-1:1:3", "must be > 0"}}) {
    const Outcome outcome = hexaplast("sweep bar.scn --out found --vary " + vary);
    EXPECT_EQ(outcome.code, 2) << vary;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << vary << "\n" << outcome.err;
    EXPECT_FALSE(fs::exists(directory_ / "found")) << vary;
  }
  EXPECT_EQ(hexaplast("sweep bar.scn --out bar.scn --vary body.youngModulus=1,2").code, 5);
  EXPECT_EQ(hexaplast("sweep absent.scn --out found --vary body.youngModulus=1,2").code, 5);
}

TEST_F(Sweep, ValuesAreSpreadEvenlyOrInEqualFactors) {
  write("bar.scn", hexaplast::support::pulled_bar());
  EXPECT_EQ(hexaplast("sweep bar.scn --out found --steps 0 --vary body.poissonRatio=0.1:0.4:4 "
                      "--vary body.youngModulus=100:10000:3:log")
                .code,
            0);
  const Csv found = table();
  ASSERT_EQ(found.num_rows(), 12u);
  for (int row = 0; row < 12; ++row) {
    EXPECT_EQ(found.text(row, "body.poissonRatio"), (std::vector{"0.1", "0.2", "0.3", "0.4"}[row / 3]));
    EXPECT_EQ(found.text(row, "body.youngModulus"), (std::vector{"100", "1000", "10000"}[row % 3]));
  }
}

}  // namespace
