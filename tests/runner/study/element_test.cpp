// SPDX-License-Identifier: LGPL-2.1-or-later
// `hexaplast element`, run as its users run it.                                                       docs/element.md
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hexaplast/material/rows.hpp"
#include "support/command.hpp"
#include "support/csv.hpp"
#include "support/golden.hpp"
#include "support/rows.hpp"

namespace hexaplast {
namespace {

using support::Json;
using support::Outcome;

class ElementCommand : public support::Command {
 protected:
  Outcome element(const std::string& arguments, const std::string& input = "") {
    write("in", input);
    return shell("('" HEXAPLAST_COMMAND "' element " + arguments + " < in)");
  }
};

/// Greatest difference of two JSON values of one shape, relative to the greatest number of `expected`; infinite where
/// the shapes differ.
double difference(const Json& actual, const Json& expected) {
  std::vector<double> a, b;
  const auto flatten = [](const auto& self, const Json& value, std::vector<double>& into) -> void {
    if (value.is_array())
      for (const Json& entry : value) self(self, entry, into);
    else
      into.push_back(value.is_boolean() ? value.get<bool>() : support::number(value));
  };
  flatten(flatten, actual, a);
  flatten(flatten, expected, b);
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double size = 0, worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    size = std::max(size, std::abs(b[i]));
    worst = std::max(worst, std::abs(a[i] - b[i]));
  }
  return worst / (size > 0 ? size : 1);
}

TEST_F(ElementCommand, AnswersReferenceFilesWithTheirOwnKeysAndNumbers) {
  for (const char* state : {"hex_0_box", "hex_1_distorted", "hex_2_evolved"}) {
    const std::string file = std::string(HEXAPLAST_TEST_DATA) + "/golden/" + state + ".json";
    const Outcome outcome = element("'" + file + "'");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json answer = Json::parse(outcome.out), golden = support::golden(state);
    for (const char* block : {"elastic", "objective", "paper_vertex", "paper_centre"}) {
      ASSERT_TRUE(answer.contains(block)) << block;
      for (const auto& [key, expected] : golden[block].items()) {
        ASSERT_TRUE(answer[block].contains(key)) << block << "." << key;
        // the free turn of a single element is rounding in the objective averaging: only to 1e-8
        const bool turns = std::string(block) == "objective" && (key == "Pi_new" || key == "x_new");
        EXPECT_LE(difference(answer[block][key], expected), turns ? 1e-8 : 1e-10)
            << state << " " << block << "." << key;
      }
    }
  }
}

TEST_F(ElementCommand, AnswersReferenceFilesOfIsolatedRestShapes) {
  const Json data = support::test_data("isolated", "golden_isolated_hexahedron");
  for (const auto& [name, one] : data["cases"].items()) {
    SCOPED_TRACE(name);
    const Json &words = one["attributes"], &numbers = one["parameters"];
    const Json parameters{{"youngModulus", data["youngModulus"]},
                          {"poissonRatio", data["poissonRatio"]},
                          {"yieldStress", 1},
                          {"plasticFlowRate", numbers["flow"]},
                          {"hardening", numbers["hardening"]},
                          {"dt", numbers["dt"]},
                          {"restShape", words["restShape"]},
                          {"bending", words["bending"]},
                          {"volumetric", words["volumetric"]},
                          {"yieldNorm", words["yieldNorm"]},
                          {"yieldStressMeasure", words["yieldStressMeasure"] == "true" ? "cauchy" : "biot"}};
    const Outcome outcome = element("", Json{{"initial", one["material"]},
                                             {"current", one["world"]},
                                             {"plasticInverse", one["G"]},
                                             {"yieldStress", one["tau"]},
                                             {"parameters", parameters}}
                                            .dump());
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json answer = Json::parse(outcome.out);
    for (const char* key : {"energy", "force"})
      EXPECT_LE(difference(answer["elastic"][key], one["elastic"][key]), 1e-10) << key;
    for (const auto& [key, expected] : {std::pair{"sigma", "sigma_hat"},
                                        {"sigma_norm", "norm"},
                                        {"gamma", "gamma"},
                                        {"Sp", "Sp"},
                                        {"G_new", "G_new"},
                                        {"tau_new", "tau_new"}})
      EXPECT_LE(difference(answer["objective"][key], one["flow"][expected]), 1e-10) << key;
  }
}

const std::string kCube = R"("initial": [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]])";

TEST_F(ElementCommand, NeedsNothingButTheHexahedronAndReadsStandardInput) {
  const Outcome outcome = element("", "{" + kCube + "}");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json answer = Json::parse(outcome.out);
  EXPECT_EQ(answer.size(), 2u);
  EXPECT_DOUBLE_EQ(answer["elastic"]["volume_x"], 1);
  EXPECT_LE(difference(answer["elastic"]["force"], Json(std::vector(8, std::vector(3, 0.0)))), 1e-12 * 5000);
  EXPECT_TRUE(answer.contains("objective"));
  EXPECT_EQ(element("-", "{" + kCube + "}").out, outcome.out);
}

TEST_F(ElementCommand, AnswersForTheModeThatIsAskedFor) {
  for (const auto& [mode, block] :
       {std::pair{"vertex", "paper_vertex"}, {"centre", "paper_centre"}, {"none", "none"}}) {
    const Outcome outcome = element("", "{" + kCube + R"(, "parameters": {"rotationPlasticity": ")" + mode + "\"}}");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json answer = Json::parse(outcome.out);
    EXPECT_TRUE(answer.contains(block));
    EXPECT_EQ(answer.size(), 2u);
  }
}

TEST_F(ElementCommand, WrongInputEndsWith3AndNamesKeyValueAndWhatIsAllowed) {
  struct Case {
    std::string input;
    std::vector<std::string> parts;
  };
  for (const Case& c : std::vector<Case>{
           {"", {"error"}},
           {"{", {"error"}},
           {"[1]", {"one JSON object"}},
           {"{}", {"initial", "missing"}},
           {R"({"initial": 3})", {"initial", "3", "eight rows of three numbers"}},
           {R"({"initial": [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,"x"]]})", {"initial", "x"}},
           // left-handed
           {R"({"initial": [[0,0,1],[1,0,1],[1,1,1],[0,1,1],[0,0,0],[1,0,0],[1,1,0],[0,1,0]]})", {"inverted"}},
           {"{" + kCube + R"(, "worlds": 1})", {"worlds"}},
           {"{" + kCube + R"(, "plasticRest": 1, "x": 1})", {"x", "twice", "another name"}},
           {"{" + kCube + R"(, "rotationMap": [[1,0,0],[0,1,0],[0,0,2]], "parameters": {"restShape": "joined"}})",
            {"rotationMap", "a rotation matrix"}},
           {"{" + kCube + R"(, "yieldStress": [1,2]})", {"yieldStress", "one per corner"}},
           {"{" + kCube + R"(, "plasticInverse": [[1,0,0],[0,1,0],[0,0,1]], "parameters": {"restShape": "joined"}})",
            {"plasticInverse", "isolated only"}},
           {"{" + kCube + R"(, "plasticInverse": [[1,0,0],[0,1,0],[0,0,-1]]})",
            {"plasticInverse", "positive determinant"}},
           {"{" + kCube + R"(, "rotationYield": 1})", {"rotationYield", "no meaning", "joined has it"}},
           {"{" + kCube + R"(, "parameters": 5})", {"parameters", "an object"}},
           {"{" + kCube + R"(, "parameters": {"youngModulu": 5}})", {"youngModulu"}},
           {"{" + kCube + R"(, "parameters": {"youngModulus": "stiff"}})", {"youngModulus", "stiff", "number"}},
           {"{" + kCube + R"(, "parameters": {"youngModulus": -5}})", {"youngModulus", "-5"}},
           {"{" + kCube + R"(, "parameters": {"poissonRatio": 0.5}})", {"poissonRatio", "0.5"}},
           {"{" + kCube + R"(, "parameters": {"yieldNorm": "tresca"}})", {"yieldNorm", "tresca", "vonMises"}},
           {"{" + kCube +
                R"(, "parameters": {"dt": 1, "yieldStress": 1, "plasticFlowRate": 0.1, "restShape": "joined",
                  "volumeRestitution": 9}})",
            {"volumeRestitution"}},
           {"{" + kCube + R"(, "parameters": {"youngModulus": 1, "E": 2}})", {"E", "twice", "another name"}},
       }) {
    const Outcome outcome = element("", c.input);
    EXPECT_EQ(outcome.code, 3) << c.input;
    EXPECT_EQ(outcome.out, "") << c.input;
    for (const std::string& part : c.parts) {
      EXPECT_NE(outcome.err.find(part), std::string::npos) << "'" << part << "' is missing in: " << outcome.err;
    }
  }
}

// Whatever rows the core has.
template <class Options, class Run>
void expect_parameters(std::span<const Row<Options>> rows, const Run& run) {
  for (const Row<Options>& row : rows) {
    const std::string others = row.name == "rotationFlowRate" ? R"("restShape": "joined", )" : "";
    const auto run_with = [&](const Json& value) {
      return run("{" + kCube + R"(, "parameters": {)" + others + '"' + std::string(row.name) + "\": " + value.dump() +
                 "}}");
    };
    if (row.at.list) continue;
    const double value = support::another(row, row.at.get({}));
    const bool is_word = row.at.type == MemberType::kWord, is_whole = row.at.type == MemberType::kInteger;
    const Outcome taken = run_with(is_word    ? Json(row.words[static_cast<std::size_t>(value)])
                                   : is_whole ? Json(static_cast<int>(value))
                                              : Json(value));
    EXPECT_EQ(taken.code, 0) << row.name << ": " << taken.err;
    EXPECT_EQ(run_with(nullptr).code, row.may_be_infinite() ? 0 : 3) << row.name;
    for (const Json& wrong : {Json("wrong"), Json(1e9), Json(-1e9)}) {
      if (wrong.is_number() && row.admits(wrong)) continue;
      const Outcome refused = run_with(wrong);
      EXPECT_EQ(refused.code, 3) << row.name;
      EXPECT_NE(refused.err.find(row.name), std::string::npos) << refused.err;
    }
  }
}

TEST_F(ElementCommand, TakesEveryMemberOfMaterialAndSettings) {
  const auto run = [&](const std::string& input) { return element("", input); };
  expect_parameters(material_rows(), run);
  expect_parameters(settings_rows(), run);
}

TEST_F(ElementCommand, RelaxesAlongAPathAlone) {
  write("hold.csv", "0,1,0,0,0,1,0,0,0,1\n1e-9,1.01,0,0,0,1,0,0,0,1\n0.2,1.01,0,0,0,1,0,0,0,1\n");
  const std::string cube = "{" + kCube + R"(, "parameters": {"youngModulus": 1000, "poissonRatio": 0, "dt": 0.05,
      "relaxation": [2, 0.1]}})";
  const support::Csv t(element("- --path hold.csv", cube).out);
  ASSERT_EQ(t.num_rows(), 6u);
  // 2 mu e, and 2 g mu (2/3) e of the branch
  EXPECT_NEAR(t.number(1, "P11"), 10 + 2 * 20 / 3.0, 1e-5);
  EXPECT_NEAR(t.number(5, "P11"), 10 + 2 * 20 / 3.0 * std::exp(-2), 1e-5);
  const Outcome refused = element("", cube);
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("parameters.relaxation: the answer depends on what was before: needs --path"),
            std::string::npos)
      << refused.err;
  EXPECT_NE(element("", "{" + kCube + R"(, "parameters": {"relaxation": 3}})").err.find("a list of numbers"),
            std::string::npos);
}

TEST_F(ElementCommand, AFileThatCannotBeReadEndsWith5) {
  EXPECT_EQ(element("absent.json").code, 5);
  EXPECT_EQ(element("- --path absent.csv", "{" + kCube + "}").code, 5);
}

TEST_F(ElementCommand, DrivesTheHexahedronThroughAPath) {
  write("path.csv", "time,F11,F12,F13,F21,F22,F23,F31,F32,F33\n0,1,0,0,0,1,0,0,0,1\n# hold\n1,1.2,0,0,0,1,0,0,0,1\r\n");
  const std::string elastic = R"(, "parameters": {"youngModulus": 1000, "poissonRatio": 0.25, "dt": 0.1,
      "bending": "blended", "volumetric": "sample")";
  const Outcome outcome = element("- --path path.csv", "{" + kCube + elastic + "}}");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const support::Csv t(outcome.out);
  ASSERT_EQ(t.num_rows(), 11u);
  for (std::size_t k = 0; k < 11; ++k) {
    // uniaxial strain e: P11 = (lambda + 2 mu) e, P22 = lambda e, energy (lambda + 2 mu) e^2 / 2 in one cubic metre
    const double strain = 0.02 * k;
    EXPECT_NEAR(t.number(k, "time"), 0.1 * k, 1e-12);
    EXPECT_NEAR(t.number(k, "F11"), 1 + strain, 1e-12);
    EXPECT_NEAR(t.number(k, "P11"), 1200 * strain, 1e-9);
    EXPECT_NEAR(t.number(k, "P22"), 400 * strain, 1e-9);
    EXPECT_NEAR(t.number(k, "P12"), 0, 1e-9);
    EXPECT_NEAR(t.number(k, "energy"), 600 * strain * strain, 1e-9);
    EXPECT_NEAR(t.number(k, "stress_norm"), 800 * strain, 1e-9);
    EXPECT_EQ(t.number(k, "plastic_strain"), 0);
  }
}

TEST_F(ElementCommand, TheExampleOfTheDocumentationYieldsAndKeepsAStretch) {
  const std::string examples = std::string("'") + HEXAPLAST_SOURCE_DIR + "/docs/examples/uniaxial";
  const Outcome outcome = element(examples + ".json' --path " + examples + "_path.csv'");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const support::Csv t(outcome.out);
  double stress_free = 0;
  for (std::size_t k = 1; k < t.num_rows(); ++k)
    if (t.number(k, "time") > 2 && t.number(k - 1, "P11") > 0 && t.number(k, "P11") <= 0)
      stress_free = t.number(k, "F11");
  EXPECT_NEAR(stress_free, 1.19, 0.01);
  EXPECT_EQ(t.number(0, "plastic_strain"), 0);
  for (const char* column : {"plastic_strain", "dissipated_energy"}) EXPECT_GT(t.numbers(column).back(), 0) << column;
  EXPECT_GT(t.numbers("yield_stress").back(), t.number(0, "yield_stress")) << "it hardens";
}

TEST_F(ElementCommand, WrongPathsEndWith3AndNameTheLine) {
  const std::string rest = "0,1,0,0,0,1,0,0,0,1\n";
  for (const auto& [csv, part] : {std::pair<std::string, std::string>{"", "two rows"},
                                  {rest, "two rows"},
                                  {rest + "1,2,3\n", "path.csv:2"},
                                  {rest + "1,1,0,0,0,1,0,0,0,1,7\n", "path.csv:2"},
                                  {rest + "1,1,0,0,0,1,0,0,0,nan\n", "path.csv:2"},
                                  {rest + "0,1,0,0,0,1,0,0,0,1\n", "path.csv:2"}}) {
    write("path.csv", csv);
    const Outcome outcome = element("- --path path.csv", "{" + kCube + "}");
    EXPECT_EQ(outcome.code, 3) << csv;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace hexaplast
