// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "support/command.hpp"
#include "support/pulled_bar.hpp"

namespace {

namespace fs = std::filesystem;
using hexaplast::support::Command;
using hexaplast::support::content;
using hexaplast::support::kSection;
using hexaplast::support::Outcome;
using Json = nlohmann::json;

class Fit : public Command {
 protected:
  Json found() { return Json::parse(content(directory_ / "found/fit.json")); }
  double value(int parameter) { return found()["parameters"][parameter]["value"]; }
};

TEST_F(Fit, RecoversWhatMadeACurve) {
  write("bar.scn", hexaplast::support::flowing_bar());
  ASSERT_EQ(hexaplast("run bar.scn --quiet --steps 40 --frames 0 --out truth --set body.yieldStress=110 "
                      "--set body.plasticFlowRate=1.3")
                .code,
            0);
  const std::string command =
      "fit bar.scn --target truth/history.csv --compare world_elongation --out found "
      "--free body.yieldStress=20:400 --free body.plasticFlowRate=0.1:8";
  const Outcome outcome = hexaplast(command);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("body."), std::string::npos) << outcome.err;  // no value in doubt
  EXPECT_NEAR(value(0), 110, 0.11);
  EXPECT_NEAR(value(1), 1.3, 0.0013);
  EXPECT_LT(found()["relative_rms"], 1e-4);
  EXPECT_LT(found()["evaluations"], 150);
  EXPECT_TRUE(found()["converged"]);
  EXPECT_EQ(found()["parameters"][0]["scale"], "log");
  EXPECT_NEAR(found()["parameters"][0]["start"], 60, 1e-9);  // what the scene has
  EXPECT_LT(found()["parameters"][0]["known_from"], 110);
  EXPECT_GT(found()["parameters"][0]["known_to"], 110);

  // the line to paste gives the fitted curve
  const std::string set = found()["set"];
  EXPECT_NE(outcome.out.find(set), std::string::npos);
  ASSERT_EQ(hexaplast("run bar.scn --quiet --steps 40 --frames 0 --out again " + set).code, 0);
  for (const char* name : {"before", "target", "fitted", "elongation [%]", "time [s]"})
    EXPECT_NE(content(directory_ / "found/fit.svg").find(name), std::string::npos) << name;

  EXPECT_EQ(hexaplast(command).code, 5);  // the directory holds a fit
}

TEST_F(Fit, OverForceRowsAreComparedWhereTheLoadsHaveThatPull) {
  write("bar.scn", hexaplast::support::pulled_bar());
  // F / (E A), at forces between those of the steps too
  std::string curve = "# measured\nforce, elongation\n";
  constexpr double kModulus = 3210;
  for (const double force : {4.0, 12.5, 31.0, 50.0})
    curve += std::to_string(force) + ", " + std::to_string(force / (kModulus * kSection)) + "\r\n";
  write("curve.csv", curve);
  const Outcome outcome = hexaplast("fit bar.scn --target curve.csv --free body.youngModulus=500:50000 --out found");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NEAR(value(0), kModulus, 0.5);
  EXPECT_EQ(found()["rows"], 4);
}

TEST_F(Fit, TheForceThatABodyCarriesIsCompared) {
  // moved by 0.1 m within a second
  std::string scene = hexaplast::support::pulled_bar();
  const std::string load = "<LinearForceField name='pull' points='2 5 8 11' times='0 1' forces='0 0 0  12.5 0 0'/>";
  scene.replace(scene.find(load), load.size(),
                "<LinearMovementProjectiveConstraint indices='2 5 8 11' keyTimes='0 1' movements='0 0 0  0.1 0 0'/>");
  write("bar.scn", scene);
  constexpr double kModulus = 7000;
  const auto force = [](double time) { return kModulus * kSection * 0.1 * time; };
  write("curve.csv", "time,force\n0.2," + std::to_string(force(0.2)) + "\n0.65," + std::to_string(force(0.65)) +
                         "\n1," + std::to_string(force(1)) + "\n");
  const Outcome outcome = hexaplast("fit bar.scn --target curve.csv --free body.youngModulus=500:50000 --out found");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NEAR(value(0), kModulus, 1);
}

TEST_F(Fit, IsTheSameForAnyNumberOfRunsAtATime) {
  write("bar.scn", hexaplast::support::flowing_bar());
  ASSERT_EQ(hexaplast("run bar.scn --quiet --steps 40 --frames 0 --out truth --set body.yieldStress=110").code, 0);
  const std::string command =
      "fit bar.scn --target truth/history.csv --compare world_elongation --free body.yieldStress=20:400 "
      "--free body.plasticFlowRate=0.1:8 ";
  std::string first, printed;
  for (const char* jobs : {"1", "2", "3"}) {
    const Outcome outcome = hexaplast(command + "--out found --force --jobs " + jobs);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    if (first.empty()) first = content(directory_ / "found/fit.json"), printed = outcome.out;
    EXPECT_EQ(content(directory_ / "found/fit.json"), first) << jobs;
    EXPECT_EQ(outcome.out, printed) << jobs;
  }
  // values with which the scene does not run count as such wherever they are tried
  const Outcome failing = hexaplast(
      "fit bar.scn --target truth/history.csv --compare world_elongation --free body.plasticFlowRate=1.9:100:linear "
      "--jobs 2");
  EXPECT_EQ(failing.code, 0) << failing.err;
  EXPECT_NE(failing.err.find("evaluations failed"), std::string::npos) << failing.err;
  EXPECT_EQ(hexaplast("fit --help").out.find("worker"), std::string::npos);
}

TEST_F(Fit, SaysWhatTheCurveDoesNotTell) {
  write("bar.scn", hexaplast::support::pulled_bar());
  write("curve.csv", "force,elongation\n10,0.02\n30,0.06\n50,0.1\n");
  // nothing reaches the yield stress
  const Outcome outcome = hexaplast(
      "fit bar.scn --target curve.csv --free body.youngModulus=1000:4000 --free body.yieldStress=1e4:1e6 --out found");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: body.yieldStress hardly matters here"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("body.youngModulus"), std::string::npos) << outcome.err;
  EXPECT_TRUE(found()["parameters"][1]["leeway_alone"].is_null());
  // 1 % of the curve is 1 % of the modulus times the root mean square of F / F_max
  const double fraction = std::sqrt((0.04 + 0.36 + 1) / 3);
  EXPECT_NEAR(double(found()["parameters"][0]["known_to"]) - value(0), 0.01 / fraction * 2000, 1);

  const Outcome beyond = hexaplast("fit bar.scn --target curve.csv --free body.youngModulus=2500:4000");
  EXPECT_NE(beyond.err.find("body.youngModulus is at its limit"), std::string::npos) << beyond.err;
  const Outcome early = hexaplast("fit bar.scn --target curve.csv --free body.youngModulus=3000:9000 --evaluations 3");
  EXPECT_NE(early.err.find("stopped after 3 evaluations"), std::string::npos) << early.err;
}

/// Rows of force and elongation of a bar of stiffness `modulus` across the section.
std::string hooke(double modulus, std::initializer_list<double> forces) {
  std::string curve = "force,elongation\n";
  for (const double force : forces) curve += fmt::format("{},{}\n", force, force / (modulus * kSection));
  return curve;
}

// A bar that contracts freely tells its modulus, one that cannot a combination of modulus and Poisson's ratio.
TEST_F(Fit, TwoExperimentsTellTogetherWhatNeitherTellsAlone) {
  constexpr double kYoung = 3000, kPoisson = 0.3,
                   kConfined = kYoung * (1 - kPoisson) / (1 + kPoisson) / (1 - 2 * kPoisson);
  write("free.scn", hexaplast::support::pulled_bar(false));
  write("confined.scn", hexaplast::support::pulled_bar(true));
  write("free.csv", hooke(kYoung, {5, 12, 20, 33, 50}));
  write("confined.csv", hooke(kConfined, {10, 40, 50}));
  const std::string free = " --free body.youngModulus=500:50000 --free body.poissonRatio=0:0.45 --out found --force ";
  for (const char* alone : {"free", "confined"}) {
    const Outcome outcome = hexaplast(fmt::format("fit {0}.scn --target {0}.csv", alone) + free);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("body.poissonRatio"), std::string::npos) << alone << " cannot tell it: " << outcome.err;
  }

  std::string first;
  for (const char* jobs : {"1", "2", "3"}) {
    const Outcome outcome =
        hexaplast("fit free.scn --target free.csv --experiment confined.scn confined.csv --jobs " + (jobs + free));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_NEAR(value(0), kYoung, 1e-4 * kYoung);
    EXPECT_NEAR(value(1), kPoisson, 1e-4 * kPoisson);
    for (const char* text : {"free: fitted to free.csv, 5 rows\n", "confined: fitted to confined.csv, 3 rows\n",
                             "elongation of confined.csv"})
      EXPECT_NE(outcome.out.find(text), std::string::npos) << outcome.out;
    if (first.empty()) first = content(directory_ / "found/fit.json");
    EXPECT_EQ(content(directory_ / "found/fit.json"), first) << jobs;
  }
  EXPECT_EQ(found()["rows"], 5);
  ASSERT_EQ(found()["further_experiments"].size(), 1u);
  EXPECT_EQ(found()["further_experiments"][0]["scene"], "confined.scn");
  EXPECT_EQ(found()["further_experiments"][0]["rows"], 3);
  EXPECT_EQ(found()["columns"][1]["target"], "confined.csv");
  for (const char* text : {"elongation [%], free", "elongation [%], confined"})
    EXPECT_NE(content(directory_ / "found/fit.svg").find(text), std::string::npos) << text;
}

TEST_F(Fit, AnExperimentHasColumnsAndSettingsOfItsOwn) {
  constexpr double kModulus = 3210;
  write("bar.scn", hexaplast::support::pulled_bar());
  write("weak.csv", hooke(kModulus, {4, 25, 50}));
  // twice the pull, and a column that is none of the scene's
  std::string curve = "force,elongation,width\n";
  for (const double force : {20.0, 60.0, 100.0})
    curve += fmt::format("{},{},1\n", force, force / (kModulus * kSection));
  write("strong.csv", curve);
  const std::string command = "fit bar.scn --target weak.csv --free body.youngModulus=500:50000 --out found --force ";
  const std::string strong = "--experiment bar.scn strong.csv ", pull = "'pull.forces=0 0 0  25 0 0' ";
  const Outcome outcome = hexaplast(command + strong + pull + "elongation");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NEAR(value(0), kModulus, 0.5);
  EXPECT_EQ(found()["further_experiments"][0]["overrides"], Json({"pull.forces=0 0 0  25 0 0"}));

  const auto expect_refused = [&](const std::string& words, int code, const std::string& message) {
    const Outcome refused = hexaplast(command + words);
    EXPECT_EQ(refused.code, code) << words;
    EXPECT_NE(refused.err.find(message), std::string::npos) << refused.err;
  };
  expect_refused(strong + pull, 3, "strong.csv:1: error: column 'width' is not known");
  expect_refused(strong + pull + "height", 3,
                 "strong.csv:1: error: no column that could be compared is called 'height'");
  expect_refused(strong + "elongation", 3, "strong.csv:3: error: force 60 N: the loads of the scene do not have");
  expect_refused(strong + "elongation pull.forse=1", 2, "(of the scene bar.scn)");
  expect_refused(strong + "elongation body.youngModulus=1", 2,
                 "strong.csv: body.youngModulus=1: must not be a free attribute");
  expect_refused("--experiment bar.scn", 2, "--experiment bar.scn: must be SCENE CURVE.csv");
  expect_refused("--experiment bar.scn absent.csv", 5, "absent.csv");
  expect_refused("--experiment absent.scn weak.csv", 5, "absent.scn");
  std::string other = hexaplast::support::pulled_bar();
  other.replace(other.find("'body'"), 6, "'rod'");
  write("rod.scn", other);
  expect_refused("--experiment rod.scn weak.csv", 2, "(of the scene rod.scn)");
  fs::create_directory(directory_ / "d");
  write("d/fit.svg", content(directory_ / "weak.csv"));
  const Outcome lost = hexaplast(
      "fit bar.scn --target weak.csv --free body.youngModulus=500:50000 --out d --force "
      "--experiment bar.scn d/fit.svg");
  EXPECT_EQ(lost.code, 5);
  EXPECT_NE(lost.err.find("d/fit.svg: is an input"), std::string::npos) << lost.err;
}

TEST_F(Fit, MistakesOfTheCurveAreNamedWithTheirLine) {
  write("bar.scn", hexaplast::support::pulled_bar());
  for (const auto& [curve, message] : std::vector<std::pair<std::string, std::string>>{
           {"", "curve.csv: error: is empty"},
           {"# nothing\n\n", "curve.csv: error: is empty"},
           {"elongation\n1\n2\n", "curve.csv:1: error: no column is called time or force"},
           {"time\n1\n2\n", "curve.csv:1: error: no column to compare"},
           {"time,lenght\n1,1\n2,2\n", "curve.csv:1: error: column 'lenght' is not known"},
           {"time,elongation,world_elongation\n1,1,1\n2,2,2\n", "curve.csv:1: error: elongation is there twice"},
           {"time,elongation\n0.1,0.1\n", "curve.csv: error: at least 2 rows are needed"},
           {"time,elongation\n0.1,0\n0.2,0\n", "curve.csv: error: elongation is zero in every row"},
           {"time,elongation\n0.1,0.1\n0.2\n", "curve.csv:3: error: 1 fields, must be 2"},
           {"time,elongation\n0.1,nan\n0.2,1\n", "curve.csv:2: error: elongation: 'nan': must be a finite number"},
           {"time,elongation\n0.1,1\n# back\n0.1,2\n", "curve.csv:4: error: time 0.1 does not come after 0.1"},
           {"time,elongation\n-0.1,1\n0.1,2\n", "curve.csv:2: error: time -0.1: must not be negative"},
           {"force,elongation\n10,0.1\n60,0.2\n", "curve.csv:3: error: force 60 N: the loads of the scene do not have"},
           {"force,elongation\n10,0.1\n5,0.2\n",
            "curve.csv:3: error: force 5 N: the loads of the scene do not have"}}) {
    write("curve.csv", curve);
    const Outcome outcome = hexaplast("fit bar.scn --target curve.csv --free body.youngModulus=500:50000");
    EXPECT_EQ(outcome.code, 3) << curve;
    EXPECT_EQ(outcome.err.find(message), 0u) << curve << "\n" << outcome.err;
  }
  EXPECT_EQ(hexaplast("fit bar.scn --target absent.csv --free body.youngModulus=500:50000").code, 5);
}

TEST_F(Fit, WhatCannotBeWrittenIsFoundBeforeTheFirstEvaluation) {
  write("bar.scn", hexaplast::support::pulled_bar());
  write("curve.csv", "force, elongation\n12.5, 0.02\n50, 0.08\n");
  const auto fit = [&](const std::string& scene, const std::string& curve, const std::string& more) {
    return hexaplast("fit " + scene + " --target " + curve + " --free body.youngModulus=500:50000 --out d " + more);
  };
  const auto expect_refused = [&](const Outcome& outcome, const std::string& message) {
    EXPECT_EQ(outcome.code, 5) << outcome.err;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.find("residual"), std::string::npos) << "nothing has been run: " << outcome.err;
  };
  fs::create_directory(directory_ / "d");

  // inputs that lie where it writes
  for (const char* name : {"d/fit.svg", "d/fit.json", "d/fit.svg.part"}) {
    fs::copy_file(directory_ / "bar.scn", directory_ / name);
    expect_refused(fit(name, "curve.csv", "--force"), std::string(name) + ": is an input");
    EXPECT_EQ(content(directory_ / name), hexaplast::support::pulled_bar());
    fs::remove(directory_ / name);
    fs::copy_file(directory_ / "curve.csv", directory_ / name);
    expect_refused(fit("bar.scn", name, "--force"), std::string(name) + ": is an input");
    EXPECT_EQ(content(directory_ / name), content(directory_ / "curve.csv"));
    fs::remove(directory_ / name);
  }

  write("d/fit.svg", "mine");
  expect_refused(fit("bar.scn", "curve.csv", ""), "d: holds an earlier fit (fit.svg); --force replaces it");
  EXPECT_EQ(content(directory_ / "d/fit.svg"), "mine");
  fs::remove(directory_ / "d/fit.svg");
  fs::create_directory(directory_ / "d/fit.svg");
  expect_refused(fit("bar.scn", "curve.csv", "--force"), "d/fit.svg: is not a regular file");
  fs::remove(directory_ / "d/fit.svg");

  // a disk that is full at the end takes the files, not the values
  const Outcome full =
      shell("sh -c \"(trap '' XFSZ; ulimit -f 0; '" HEXAPLAST_COMMAND
            "' fit bar.scn --target curve.csv --free body.youngModulus=500:50000 --out d 2>&1) | cat\"");
  EXPECT_NE(full.out.find("--set body.youngModulus="), std::string::npos) << full.out;
  EXPECT_NE(full.out.find("fit.json.part: cannot be written: File too large"), std::string::npos) << full.out;
  EXPECT_TRUE(fs::is_empty(directory_ / "d"));
  EXPECT_EQ(fit("bar.scn", "curve.csv", "").code, 0);
}

TEST_F(Fit, MistakesOfTheCommandLineEndWith2) {
  write("bar.scn", hexaplast::support::pulled_bar());
  write("curve.csv", "force,elongation\n10,0.02\n50,0.1\n");
  for (const auto& [free, message] : std::vector<std::pair<std::string, std::string>>{
           {"body.youngModulus", "must be PATH.attribute=lo:hi"},
           {"body.youngModulus=1:2:cubic", "must be PATH.attribute=lo:hi"},
           {"body.youngModulus=1:x", "'x' is no number"},
           {"body.youngModulus=5:5", "5 is not less than 5"},
           {"body.youngModulus=0:5:log", "limits greater than 0"},
           {"body.poissonRatio=0:0.5", "must lie in [0, 0.5)"},
           {"body.poisonRatio=0:0.4", "did you mean 'poissonRatio'?"},
           {"bodi.youngModulus=1:2", "bodi"},
           {"body.yieldNorm=1:2", "must be a number that the scene gives"},
           {"body.plasticStrain=1:2", "holds what is computed"},
           {"body.youngModulus=1:2 --free body.youngModulus=1:3", "is free already"}}) {
    const Outcome outcome = hexaplast("fit bar.scn --target curve.csv --free " + free);
    EXPECT_EQ(outcome.code, 2) << free;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << free << "\n" << outcome.err;
  }
}

}  // namespace
