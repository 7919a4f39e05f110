// SPDX-License-Identifier: LGPL-2.1-or-later
// What `hexaplast run --out` keeps beside the states: manifest.json and report.html.
#include <regex>

#include "hexaplast/formats/mesh_import.hpp"
#include "support/command.hpp"
#include "support/held_bar.hpp"
#include "support/pulled_bar.hpp"

namespace {

using namespace hexaplast::support;

const std::string kBody =
    held_bar("rayleighMass='0.1'", "precision='mixed' yieldStress='300'", "indices='2' forces='1 0 0'");

std::string scene(const std::string& body) { return in_a_node(body, "steps='4'"); }

class RunRecord : public Command {
 protected:
  /// The manifest of a run of `file`.
  Json manifest_of(const std::string& file, const std::string& options = "") {
    succeeds("run " + file + " --out run --force --frames 0 --quiet " + options);
    return manifest();
  }
};

// A bar of two hexahedra along x, held at x = 0: the nodes of its sections are 0 3 6 9, 1 4 7 10 and 2 5 8 11.
TEST_F(RunRecord, MeasuresElongationAndTwistWhereABodyIsPulledByItsEnds) {
  const auto columns = [&](const std::string& load, const std::string& settings = "", const std::string& more = "") {
    const std::string body = held_bar("", "yieldStress='300'", load);
    write("bar.scn", in_a_node(body + more, "steps='1' " + settings));
    const Outcome outcome = succeeds("run bar.scn --out run --force --frames 0");
    const std::string table = read("run/history.csv"), head = table.substr(0, table.find('\n'));
    const bool has_columns(has(head, "plastic_elongation,plastic_twist_deg,") &&
                           has(head, "current_elongation,current_twist_deg"));
    EXPECT_EQ(has_columns, has(head, "elongation"));
    EXPECT_EQ(has_columns, has(outcome.out, "plastic elongation"));
    EXPECT_EQ(has_columns, has(read("run/report.html"), "\"elongation\""));
    EXPECT_FALSE(read("run/plot.svg").empty());
    return has_columns;
  };
  EXPECT_TRUE(columns("indices='2' forces='1 0 0'"));
  EXPECT_TRUE(columns("indices='2 5 8 11 1 4 7 10' forces='1 0 0'")) << "a whole section between the ends";
  EXPECT_FALSE(columns("indices='2 1' forces='1 0 0'")) << "a part of one";
  EXPECT_FALSE(columns("indices='1 4 7 10' forces='1 0 0'")) << "one end only";
  EXPECT_TRUE(columns("indices='2 1' forces='1 0 0'", "endSections='yes'"));
  EXPECT_FALSE(columns("indices='2' forces='1 0 0'", "endSections='no'"));
}

TEST_F(RunRecord, NamesTheRegionsInTheStates) {
  write("bar.scn", scene(kBody + "<MaterialRegion name='soft &amp; small' indices='1' youngModulus='100'/>"
                                 "<MaterialRegion name='stiff' indices='0' youngModulus='9000'/>"));
  succeeds("run bar.scn --out run --frames 0");
  const std::string head = read("run/mesh_000000.vtu").substr(0, 900);
  EXPECT_TRUE(has(head, "Name=\"region bar/soft &amp; small\" NumberOfTuples=\"1\" format=\"ascii\">1<"));
  EXPECT_TRUE(has(head, "Name=\"region bar/stiff\" NumberOfTuples=\"1\" format=\"ascii\">2<"));
  const auto state = hexaplast::read_vtu_state(directory_ / "run/mesh_000000.vtu");
  const auto region = std::ranges::find(state.cell_data, "region", &hexaplast::ImportedArray::name);
  ASSERT_NE(region, state.cell_data.end());
  EXPECT_EQ(region->values, (std::vector<double>{2, 1}));
}

TEST_F(RunRecord, SaysWhatIsNeededToRepeatTheRun) {
  write("bar.scn", scene(kBody));
  const Outcome outcome =
      succeeds("run bar.scn --out first --frames 0 --threads 2 --set bar/material.yieldStress=250 --steps 3");
  const Json first = manifest("first");
  EXPECT_EQ(first.at("state"), "finished");
  EXPECT_EQ(first.at("command"), Json({"hexaplast", "run", "bar.scn", "--out", "first", "--frames", "0", "--threads",
                                       "2", "--set", "bar/material.yieldStress=250", "--steps", "3"}));
  EXPECT_EQ(first.at("working_directory"), fs::canonical(directory_).string());
  EXPECT_EQ(first.at("overrides"), Json({"bar/material.yieldStress=250"}));
  EXPECT_EQ(first.at("threads"), 2);
  EXPECT_EQ(first.at("precision"), "mixed");
  EXPECT_EQ(first.at("solver"), Json({{"motion", "EulerImplicitSolver"}, {"linear", "SparseLDLSolver"}}));
  EXPECT_EQ(first.at("steps"), Json({{"asked", 3}, {"done", 3}}));
  EXPECT_TRUE(
      std::regex_match(first.at("started").get<std::string>(), std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)")));
  // the summary is the one that was printed
  for (const auto& [label, value] : first.at("summary").items())
    EXPECT_TRUE(has(outcome.out, value.get<std::string>())) << label;
  EXPECT_EQ(first.at("summary").at("state hash"), first.at("state_hash"));
  EXPECT_TRUE(has(read("first/report.html"), first.at("state_hash").get<std::string>()));

  // what it says to do gives the same state
  std::string again;
  for (const std::string word : first.at("command")) again += (word == "first" ? "second" : word) + " ";
  succeeds(again.substr(again.find(' ')));
  EXPECT_EQ(manifest("second").at("state_hash"), first.at("state_hash"));
}

TEST_F(RunRecord, TheSceneIsHashedAsItIsCarriedOut) {
  write("bar.scn", scene(kBody));
  const std::string hash = manifest_of("bar.scn").at("scene").at("xxh64");

  write("spaced.scn", "<!-- the same -->\n" + std::regex_replace(scene(kBody), std::regex("/>"), "  />\n"));
  write("part.xml", "<Node name='Group'>" + kBody + "</Node>");
  write("whole.scn", scene("<include href='part.xml'/>"));
  for (const char* file : {"spaced.scn", "whole.scn"})
    EXPECT_EQ(manifest_of(file).at("scene").at("xxh64"), hash) << file;
  EXPECT_EQ(manifest_of("bar.scn", "--set bar/material.yieldStress=300.0 --threads 3").at("scene").at("xxh64"), hash);

  EXPECT_NE(manifest_of("bar.scn", "--set bar/material.yieldStress=301").at("scene").at("xxh64"), hash);
  write("part.xml",
        "<Node name='Group'>" + std::regex_replace(kBody, std::regex("'1 0 0'"), "'1 0 1e-15'") + "</Node>");
  EXPECT_NE(manifest_of("whole.scn").at("scene").at("xxh64"), hash);
}

TEST_F(RunRecord, ListsAttributesThatDifferFromTheirDefaults) {
  write("bar.scn", scene(kBody));
  const Json components =
      manifest_of("bar.scn", "--set bar/material.plasticFlowRate=0 --set bar/material.poissonRatio=0.3")
          .at("components");
  const auto material = std::ranges::find_if(components, [](const Json& c) { return c.at("path") == "/bar/material"; });
  ASSERT_NE(material, components.end());
  EXPECT_EQ(material->at("class"), "HexahedronElastoplasticFEMForceField");
  EXPECT_EQ(material->at("attributes"),  // a flow rate of 0 is the default one
            Json({{"precision", "mixed"}, {"yieldStress", "300"}, {"poissonRatio", "0.3"}}));
}

// A force that does not change has done F times the way of its node. Without inertia there is no such balance.
TEST_F(RunRecord, TellsWhereTheWorkWent) {
  write("bar.scn", scene(kBody));
  succeeds("run bar.scn --out run --frames 0 --steps 40 --final last.json");
  const Csv moved = history();
  ASSERT_EQ(moved.num_rows(), 41u);
  const double initial = moved.number(0, "kinetic_energy") + moved.number(0, "elastic_energy");
  for (std::size_t row = 0; row <= 40; ++row) {
    const auto at = [&](const char* column) { return moved.number(row, column); };
    EXPECT_NEAR(at("kinetic_energy") + at("elastic_energy") - initial,
                at("load_work") + at("support_work") + at("recovery_work") - at("damping_loss") - at("numerical_loss") -
                    at("flow_loss") - at("energy_error"),
                1e-9 * at("load_work") + 1e-15);
    EXPECT_LE(std::abs(at("energy_error")), 1e-3 * at("load_work")) << row;
  }
  const Json last = json("last.json");
  const double way = last.at("positions").at(2).at(0).get<double>() - 1;  // of the node that is pulled with 1 N
  EXPECT_GT(way, 0);
  EXPECT_NEAR(moved.number(40, "load_work"), way, 1e-9 * way);
  EXPECT_EQ(moved.number(40, "support_work"), 0);
  EXPECT_EQ(manifest().at("summary").at("energy").get<std::string>().find("work "), 0u);
  EXPECT_TRUE(has(read("run/report.html"), "energy balance"));

  write("bar.scn", pulled_bar());
  succeeds("run bar.scn --out still --frames 0");
  const std::vector<std::string> columns = history("still").columns();
  EXPECT_EQ(std::ranges::count(columns, "elastic_energy"), 1);
  EXPECT_EQ(std::ranges::count(columns, "load_work"), 0);
}

// RunDirectory has those that a signal ends.
TEST_F(RunRecord, TellsThatTheRunFailedAndWhatItCameTo) {
  // from 0.03 s on two forces whose sum is beyond all numbers
  const std::string overload = "<LinearForceField points='5' times='0 0.02 0.03' forces='2 0 0  2 0 0  1.7e308 0 0'/>";
  write("bar.scn", scene(kBody + overload + overload));
  EXPECT_EQ(hexaplast("run bar.scn --out failed --frames 0 --steps 9").code, 4);
  const Json failed = manifest("failed");
  EXPECT_FALSE(has(failed.at("summary").dump(), "nan")) << failed;
  EXPECT_EQ(failed.at("summary").at("energy").get<std::string>().find("work "), 0u);
  EXPECT_EQ(failed.at("state"), "failed");
  EXPECT_TRUE(has(failed.at("exit_reason").get<std::string>(), "is not finite")) << failed.at("exit_reason");
  EXPECT_TRUE(is_there("failed/report.html"));

  // it has what it came to: that of a run which ends before the failure
  const long done = failed.at("steps").at("done");
  ASSERT_GT(done, 0);
  succeeds("run bar.scn --out whole --frames 0 --steps " + std::to_string(done));
  const Json whole = manifest("whole");
  EXPECT_EQ(failed.at("state_hash"), whole.at("state_hash"));
  EXPECT_EQ(failed.at("summary").at("plastic elongation"), whole.at("summary").at("plastic elongation"));
  EXPECT_EQ(failed.at("summary").at("largest strain"), whole.at("summary").at("largest strain"));
}

}  // namespace
