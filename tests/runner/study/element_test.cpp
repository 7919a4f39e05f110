// SPDX-License-Identifier: LGPL-2.1-or-later
// `hexaplast element`, run as its users run it.                                                       docs/element.md
#include "hexaplast/material/rows.hpp"
#include "support/command.hpp"
#include "support/csv.hpp"
#include "support/golden.hpp"
#include "support/rows.hpp"

namespace hexaplast {
namespace {

using namespace support;

class ElementCommand : public Command {
 protected:
  Outcome element(const std::string& arguments, const std::string& input, int code = 0) {
    write("in", input);
    Outcome outcome = shell("('" HEXAPLAST_COMMAND "' element " + arguments + " < in)");
    EXPECT_EQ(outcome.code, code) << input << outcome.err;
    return outcome;
  }
  Json answer(const std::string& input) { return Json::parse(element("", input).out, nullptr, false); }
};

/// Greatest difference of two JSON values of one shape, relative to the greatest number of `expected`; infinite where
/// the shapes differ.
double difference(const Json& actual, const Json& expected) {
  std::vector<double> a, b;
  const auto flatten = [](const auto& self, const Json& value, std::vector<double>& into) -> void {
    if (value.is_array())
      for (const Json& entry : value) self(self, entry, into);
    else
      into.push_back(value.is_boolean() ? value.get<bool>() : number(value));
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

TEST_F(ElementCommand, AnswersReferenceFilesWithTheirNumbers) {
  for (const char* state : {"hex_0_box", "hex_1_distorted", "hex_2_evolved"}) {
    const Json golden = test_data("golden", state);
    for (const auto& [mode, name] :
         {std::pair{"objective", "objective"}, {"vertex", "paper_vertex"}, {"centre", "paper_centre"}}) {
      Json input = golden["element"];
      input["parameters"]["rotationPlasticity"] = mode;
      const Json answer = this->answer(input.dump());
      for (const std::string block : {"elastic", name}) {
        ASSERT_TRUE(answer.contains(block)) << block;
        for (const auto& [key, expected] : golden[block].items()) {
          ASSERT_TRUE(answer[block].contains(key)) << block << "." << key;
          // the free turn of a single element is rounding in the objective averaging: only to 1e-8
          const bool turns = block == "objective" && (key == "Pi_new" || key == "x_new");
          EXPECT_LE(difference(answer[block][key], expected), turns ? 1e-8 : 1e-10)
              << state << " " << block << "." << key;
        }
      }
    }
  }
}

TEST_F(ElementCommand, AnswersReferenceFilesOfIsolatedRestShapes) {
  const Json data = test_data("isolated", "golden_isolated_hexahedron");
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
    const Json answer = this->answer(Json{
        {"initial", one["material"]},
        {"current", one["world"]},
        {"plasticInverse", one["G"]},
        {"yieldStress", one["tau"]},
        {"parameters", parameters}}.dump());
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

/// The cube with more keys, and with parameters.
std::string with(const std::string& keys) { return "{" + kCube + ", " + keys + "}"; }
std::string with_parameters(const std::string& pairs) { return with(R"("parameters": {)" + pairs + "}"); }

TEST_F(ElementCommand, NeedsNothingButTheHexahedronAndReadsStandardInput) {
  const Json answer = this->answer("{" + kCube + "}");
  EXPECT_EQ(answer.size(), 2u);
  EXPECT_DOUBLE_EQ(answer["elastic"]["volume_x"], 1);
  EXPECT_LE(difference(answer["elastic"]["force"], Json(std::vector(8, std::vector(3, 0.0)))), 1e-12 * 5000);
  EXPECT_TRUE(answer.contains("objective"));
  EXPECT_EQ(Json::parse(element("-", "{" + kCube + "}").out), answer);
}

TEST_F(ElementCommand, AnswersForTheModeThatIsAskedFor) {
  for (const auto& [mode, block] :
       {std::pair{"vertex", "paper_vertex"}, {"centre", "paper_centre"}, {"none", "none"}}) {
    const Json answer = this->answer(with_parameters(std::string(R"("rotationPlasticity": ")") + mode + '"'));
    EXPECT_TRUE(answer.contains(block));
    EXPECT_EQ(answer.size(), 2u);
  }
}

// What parameters refuse is tested of all of them below.
TEST_F(ElementCommand, WrongInputEndsWith3AndNamesKeyValueAndWhatIsAllowed) {
  const std::string joined = R"(, "parameters": {"restShape": "joined"})";
  for (const auto& [input, parts] : std::vector<std::pair<std::string, std::vector<const char*>>>{
           {"", {"error"}},
           {"{", {"error"}},
           {"[1]", {"one JSON object"}},
           {"{}", {"initial", "missing"}},
           {R"({"initial": 3})", {"initial", "3", "eight rows of three numbers"}},
           {R"({"initial": [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,"x"]]})", {"initial", "x"}},
           // left-handed
           {R"({"initial": [[0,0,1],[1,0,1],[1,1,1],[0,1,1],[0,0,0],[1,0,0],[1,1,0],[0,1,0]]})", {"inverted"}},
           {with(R"("worlds": 1)"), {"worlds"}},
           {with(R"("rotationMap": [[1,0,0],[0,1,0],[0,0,2]])" + joined), {"rotationMap", "a rotation matrix"}},
           {with(R"("yieldStress": [1,2])"), {"yieldStress", "one per corner"}},
           {with(R"("plasticInverse": [[1,0,0],[0,1,0],[0,0,1]])" + joined), {"plasticInverse", "isolated only"}},
           {with(R"("plasticInverse": [[1,0,0],[0,1,0],[0,0,-1]])"), {"plasticInverse", "positive determinant"}},
           {with(R"("rotationYield": 1)"), {"rotationYield", "no meaning", "joined has it"}},
           {with(R"("parameters": 5)"), {"parameters", "an object"}},
           {with_parameters(R"("youngModulu": 5)"), {"youngModulu"}},
           {with_parameters(R"("dt": 1, "yieldStress": 1, "plasticFlowRate": 0.1, "restShape": "joined",
                               "volumeRestitution": 9)"),
            {"volumeRestitution"}}}) {
    const Outcome outcome = element("", input, 3);
    EXPECT_EQ(outcome.out, "") << input;
    for (const char* part : parts) EXPECT_TRUE(has(outcome.err, part)) << input;
  }
}

// Whatever rows the core has.
template <class Options, class Run>
void expect_parameters(std::span<const Row<Options>> rows, const Run& run) {
  for (const Row<Options>& row : rows) {
    if (row.at.list) continue;
    const std::string others = row.name == "rotationFlowRate" ? R"("restShape": "joined", )" : "", name(row.name);
    const auto run_with = [&](const Json& value, int code) {
      return run(with_parameters(others + '"' + name + "\": " + value.dump()), code);
    };
    const double value = another(row, row.at.get({}));
    const bool is_word = row.at.type == MemberType::kWord, is_whole = row.at.type == MemberType::kInteger;
    run_with(is_word    ? Json(row.words[static_cast<std::size_t>(value)])
             : is_whole ? Json(static_cast<int>(value))
                        : Json(value),
             row.name == "fracture" ? 3 : 0);  // it is the plain implementation that answers, which does not tear
    run_with(nullptr, row.may_be_infinite() ? 0 : 3);
    EXPECT_TRUE(has(run_with("wrong", 3).err, name));
    if (!row.admits(-1e9)) {
      EXPECT_TRUE(has(run_with(-1e9, 3).err, name));
    }
  }
}

TEST_F(ElementCommand, TakesEveryMemberOfMaterialAndSettings) {
  const auto run = [&](const std::string& input, int code) { return element("", input, code); };
  expect_parameters(material_rows(), run);
  expect_parameters(settings_rows(), run);
}

TEST_F(ElementCommand, RelaxesAlongAPathAlone) {
  write("hold.csv",
        "time,F11,F12,F13,F21,F22,F23,F31,F32,F33\n0,1,0,0,0,1,0,0,0,1\n1e-9,1.01,0,0,0,1,0,0,0,1\n# hold\n"
        "0.2,1.01,0,0,0,1,0,0,0,1\r\n");
  const std::string cube =
      with_parameters(R"("youngModulus": 1000, "poissonRatio": 0, "dt": 0.05, "relaxation": [2, 0.1])");
  const Csv t(element("- --path hold.csv", cube).out);
  ASSERT_EQ(t.num_rows(), 6u);
  // 2 mu e, and 2 g mu (2/3) e of the branch
  EXPECT_NEAR(t.number(1, "P11"), 10 + 2 * 20 / 3.0, 1e-5);
  EXPECT_NEAR(t.number(5, "P11"), 10 + 2 * 20 / 3.0 * std::exp(-2), 1e-5);
  EXPECT_TRUE(
      has(element("", cube, 3).err, "parameters.relaxation: the answer depends on what was before: needs --path"));
  EXPECT_TRUE(has(element("", with_parameters(R"("relaxation": 3)"), 3).err, "a list of numbers"));
}

TEST_F(ElementCommand, AFileThatCannotBeReadEndsWith5) {
  element("absent.json", "", 5);
  element("- --path absent.csv", "{" + kCube + "}", 5);
}

TEST_F(ElementCommand, TheExampleOfTheDocumentationYieldsAndKeepsAStretch) {
  const std::string examples = std::string("'") + HEXAPLAST_SOURCE_DIR + "/docs/examples/uniaxial";
  const Csv t(element(examples + ".json' --path " + examples + "_path.csv'", "").out);
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
    EXPECT_TRUE(has(element("- --path path.csv", "{" + kCube + "}", 3).err, part)) << csv;
  }
}

}  // namespace
}  // namespace hexaplast
