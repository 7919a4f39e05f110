// SPDX-License-Identifier: LGPL-2.1-or-later
// `hexaplast compare`: two runs beside each other.
#include "support/command.hpp"
#include "support/golden.hpp"
#include "support/held_bar.hpp"

namespace {

using namespace hexaplast::support;

const std::string kYieldingBar = in_a_node(
    held_bar("", "yieldStress='300' plasticFlowRate='4' restShape='joined'", "indices='2 5 8 11' forces='250 0 0'"),
    "steps='20' outputEvery='10'");

class Compare : public Command {
 protected:
  Compare() { write("bar.scn", kYieldingBar); }

  void run(const std::string& directory, const std::string& options = "") {
    succeeds("run bar.scn --frames 0 --quiet --out " + directory + " --final " + directory + ".json " + options);
  }

  /// The words of the line of the output that begins with `label`.
  static std::vector<std::string> line(const std::string& out, const std::string& label) {
    std::istringstream lines(out);
    for (std::string text; std::getline(lines, text);)
      if (text.starts_with("  " + label + " ")) {
        std::istringstream words(text.substr(2 + label.size()));
        return {std::istream_iterator<std::string>(words), {}};
      }
    ADD_FAILURE() << "no line '" << label << "' in\n" << out;
    return {};
  }
};

TEST_F(Compare, FindsNothingBetweenEqualRuns) {
  run("a", "--threads 1");
  run("b", "--threads 2");
  const Outcome outcome = succeeds("compare a b");
  EXPECT_TRUE(has(outcome.out, "Both end in the same state, bit for bit."));
  EXPECT_TRUE(has(outcome.out, "Where the scenes differ\n  Nowhere."));
  EXPECT_TRUE(has(outcome.out, "21 rows at common times, of 21 and 21"));
  for (const char* column : {"plastic_elongation", "elastic_energy", "dissipated_energy", "positions"})
    EXPECT_EQ(line(outcome.out, column).front(), "0") << column;
}

TEST_F(Compare, NamesTheLargestDifferencesAndWhereTheyAre) {
  run("a");
  run("b", "--set bar/material.yieldStress=200");
  const Outcome outcome = succeeds("compare a b");
  EXPECT_EQ(line(outcome.out, "/bar/material.yieldStress"), (std::vector<std::string>{"300", "200"}));

  const auto a = history("a"), b = history("b");
  for (const char* column : {"plastic_elongation", "dissipated_energy", "kinetic_energy", "current_elongation"}) {
    const Eigen::VectorXd in_a = vector(a.numbers(column)), in_b = vector(b.numbers(column));
    Eigen::Index at = 0;
    const double difference = (in_a - in_b).cwiseAbs().maxCoeff(&at),
                 largest = std::max(in_a.cwiseAbs().maxCoeff(), in_b.cwiseAbs().maxCoeff());
    ASSERT_GT(difference, 0) << column;
    const std::vector<std::string> words = line(outcome.out, column);
    EXPECT_NEAR(std::stod(words.at(0)), difference, 1e-5 * difference) << column;
    EXPECT_NEAR(std::stod(words.at(1)), difference / largest, 1e-2 * difference / largest) << column;
    EXPECT_EQ(std::stol(words.at(2)), at) << column;
  }

  // positions against the last states in JSON, which is written and read by others
  const Json state_a = json("a.json"), state_b = json("b.json");
  for (const auto& [label, array] : {std::pair<std::string, const char*>{"positions", "positions"},
                                     {"plastic rest positions", "plastic_rest_positions"}}) {
    Eigen::Index node = 0;
    const double farthest = (matrix(state_a[array]) - matrix(state_b[array])).rowwise().norm().maxCoeff(&node);
    const std::vector<std::string> words = line(outcome.out, label);
    EXPECT_NEAR(std::stod(words.at(0)), farthest, 1e-5 * farthest);
    EXPECT_EQ(std::stol(words.at(3)), node);  // "0.1 m node 7"
  }
  EXPECT_GT(std::stod(line(outcome.out, "plastic strain").at(0)), 0);
}

TEST_F(Compare, RunsOfOtherTimeStepsMeetWhereTheirTimesDo) {
  run("a");
  run("b", "--set .dt=0.005 --steps 40");
  const Outcome outcome = succeeds("compare a b");
  EXPECT_TRUE(has(outcome.out, "21 rows at common times, of 21 and 41"));
  EXPECT_TRUE(has(outcome.out, "states at 0.2 s"));

  run("c", "--steps 13");  // its last state is not among those of a: the one at 0.1 s is
  EXPECT_TRUE(has(hexaplast("compare a c").out, "states at 0.1 s"));
}

// Each has copies of nodes of its own.
TEST_F(Compare, MeetsRunsThatAreCutInOtherPlaces) {
  write(
      "bar.scn",
      R"(<Node dt="0.01" gravity="0 0 0"><RunSettings steps="10" outputEvery="5"/><DefaultAnimationLoop/><Node name="a">
<EulerImplicitSolver/><CGLinearSolver iterations="500" tolerance="1e-10" threshold="0"/>
<RegularGridTopology n="5 3 2" max="0.04 0.02 0.01"/><MechanicalObject/><DiagonalMass massDensity="1000"/>
<HexahedronElastoplasticFEMForceField/><FixedProjectiveConstraint indices="0"/>
<BladeController name="blade" points="0 0 -.05  0 0 .05" keyTimes="0.01 0.05"
  positions="0.01 -0.01 0  0.01 0.011 0"/></Node></Node>)");
  run("a");
  run("b", "--set 'a/blade.positions=0.03 -0.01 0  0.03 0.011 0'");
  run("c", "--set a/blade.active=false");
  for (const std::string other : {"b", "c"}) {
    const std::string out = succeeds("compare a " + other).out;
    EXPECT_LT(std::stod(line(out, "positions").at(0)), 1e-9);
    EXPECT_GT(std::stod(line(out, "opened").at(0)), other == "b" ? -1 : 0);
  }
}

TEST_F(Compare, WritesAPageOfBothRuns) {
  run("a");
  run("b", "--set bar/material.yieldStress=200");
  succeeds("compare a b --out both.html");
  const std::string page = read("both.html");
  EXPECT_TRUE(has(page, "/bar/material.yieldStress"));

  const auto a = history("a"), b = history("b");
  constexpr std::string_view kBegin = "<script type=\"application/json\">";
  int charts = 0;
  for (std::size_t at = page.find(kBegin); at != page.npos; at = page.find(kBegin, at + 1)) {
    const Json chart = Json::parse(page.substr(at + kBegin.size(), page.find("</script>", at) - at - kBegin.size()));
    ++charts;
    ASSERT_EQ(chart.at("series").size(), 2u);
    if (chart.at("quantity") != "elongation, plastic") continue;
    for (std::size_t k = 0; k < a.num_rows(); ++k) {
      EXPECT_NEAR(chart.at("series")[0].at("curves")[0].at("values")[k].get<double>(),
                  100 * a.number(k, "plastic_elongation"), 1e-5);
      EXPECT_NEAR(chart.at("series")[1].at("curves")[0].at("values")[k].get<double>(),
                  100 * b.number(k, "plastic_elongation"), 1e-5);  // seven digits
    }
  }
  EXPECT_GE(charts, 8);
}

TEST_F(Compare, RefusesWhatIsNoRunAndOtherBodies) {
  run("a");
  run("finer", "--set bar/grid.n='4 2 2' --set bar/pull.indices='2 5'");
  write("bad.csv", "");
  fs::create_directories(directory_ / "empty");
  expect_refused({{"compare a absent", 5, "absent: is no directory of a run"},
                  {"compare bad.csv a", 5, "bad.csv: is no directory of a run"},
                  {"compare a empty", 5, "empty: is no directory of a run: holds no history.csv"},
                  {"compare a finer", 3, "a has 12 nodes and 2 hexahedra, finer has 16 nodes and 3"},
                  {"compare a a --out absent/page.html", 5, "absent/page.html"},
                  {"compare a", 2, "run_b is required"}});
  write("a/manifest.json", "{}");
  EXPECT_EQ(hexaplast("compare a a").code, 5);
  fs::remove(directory_ / "a/manifest.json");  // a run of an earlier version has none
  succeeds("compare a a");
  write("finer/history.csv", "step,time\n0,0\n1,x\n");
  EXPECT_EQ(hexaplast("compare finer finer").code, 5);
}

}  // namespace
