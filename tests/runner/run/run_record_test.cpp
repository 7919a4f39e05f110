// SPDX-License-Identifier: LGPL-2.1-or-later
// What `hexaplast run --out` keeps beside the states: manifest.json, report.html, and the probes of history.csv.
#include <cmath>
#include <regex>

#include "hexaplast/base/types.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "support/command.hpp"
#include "support/golden.hpp"
#include "support/held_bar.hpp"

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

  succeeds("run '" HEXAPLAST_SOURCE_DIR "/scenes/cantilever_static.scn' --steps 1 --out still --frames 0");
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

/// A bar that forceps pull by its upper end.
class Probes : public Command {
 protected:
  void write_scene(const std::string& probes) {
    write("bar.scn", R"xml(<Node dt="0.01" gravity="0 0 0">
  <RunSettings steps="30" outputEvery="10"/>
  <DefaultAnimationLoop/>
  <EulerImplicitSolver rayleighMass="0.1" rayleighStiffness="0.1"/>
  <SparseLDLSolver/>
  <RegularGridTopology name="grid" n="3 3 9" max="0.1 0.1 0.4"/>
  <MechanicalObject name="nodes"/>
  <DiagonalMass massDensity="1000"/>
  <HexahedronElastoplasticFEMForceField name="body" youngModulus="5e4" poissonRatio="0.4" yieldStress="2000"
      plasticFlowRate="4"/>
  <FixedProjectiveConstraint name="held" indices="0-8"/>
  <GraspForceField name="forceps" indices="72-80" radius="1" graspTime="0.05" keyTimes="0.05 0.3"
      positions="0.05 0.05 0.4  0.05 0.1 0.45" stiffness="500"/>
)xml" + probes + "</Node>\n");
  }

  /// The last row's value of a column.
  double last(const std::string& column, const std::string& run = "run") const {
    return history(run).numbers("probe_" + column).back();
  }
};

TEST_F(Probes, AreColumnsOfTheHistoryLinesOfTheSummaryAndChartsOfTheReport) {
  write_scene(R"xml(  <Probe name="tip" value="@nodes.position" indices="72-80" change="true"/>
  <Probe name="tip_y" value="@nodes.position" indices="72-80" component="y"/>
  <Probe name="lowest" value="@nodes.position" indices="72-80" component="z" statistic="min"/>
  <Probe name="pull" value="@forceps.force"/>
  <Probe name="pull_z" value="@forceps.force" component="z"/>
  <Probe name="strain" value="@body.plasticStrain" statistic="max"/>
  <Probe name="volumes" value="@body.volumeRatio" indices="0-3" statistic="sum"/>
)xml");
  const Outcome outcome = succeeds("run bar.scn --out run --frames 0 --final final.json --summary summary.json");

  const Json state = json("final.json");
  const Eigen::MatrixXd end = matrix(state["positions"]).middleRows(72, 9);
  const hexaplast::Vec3 mean = end.colwise().mean();
  EXPECT_NEAR(last("tip"), (mean - hexaplast::Vec3(0.05, 0.05, 0.4)).norm(), 1e-15);
  EXPECT_NEAR(last("tip_y"), mean.y(), 1e-15);
  EXPECT_EQ(last("lowest"), end.col(2).minCoeff());
  EXPECT_GT(last("pull"), std::abs(last("pull_z")));
  EXPECT_GT(last("pull_z"), 1);
  EXPECT_EQ(last("strain"), json("summary.json")["largest_plastic_strain"]);
  EXPECT_NEAR(last("volumes"), vector(state["volume_ratio"]).head(4).sum(), 1e-14);

  for (const char* line :
       {"\n  tip                 ", " m  (min 0 at 0 s, max ", "\n  pull                ", " N  (min ", "\n  strain"})
    EXPECT_TRUE(has(outcome.out, line));
  EXPECT_TRUE(has(outcome.out, " times real time\n"));
  const std::string report = read("run/report.html");
  for (const char* title : {"pull_z", "tip_y", "volumes"}) EXPECT_TRUE(has(report, title));

  const std::vector<double> pulls = history().numbers("probe_pull_z"), times = history().numbers("time");
  const Json extremes = json("summary.json")["probe_extremes"]["pull_z"];
  const auto [min, max] = std::ranges::minmax_element(pulls);
  EXPECT_EQ(extremes["min"], *min);
  EXPECT_EQ(extremes["max"], *max);
  EXPECT_EQ(extremes["min_time"], times[static_cast<std::size_t>(min - pulls.begin())]);
  EXPECT_EQ(extremes["max_time"], times[static_cast<std::size_t>(std::ranges::max_element(pulls) - pulls.begin())]);
}

TEST_F(Probes, ChangeNothingAndGoOnFromACheckpoint) {
  write_scene("");
  const auto hash = [](const std::string& text) { return text.substr(text.find("state hash")); };
  const std::string without = hash(hexaplast("run bar.scn").out);
  write_scene(
      "  <Probe name='tip' value='@nodes.position' indices='80' change='true'/><Probe name='z' value='@held.reaction' "
      "component='z'/>\n");
  const Outcome whole = hexaplast("run bar.scn --out run --frames 0");
  EXPECT_EQ(hash(whole.out), without);

  succeeds("run bar.scn --out half --frames 0 --steps 15 --checkpoint every=15 --quiet");
  const Outcome resumed = hexaplast("resume half --steps 30");
  EXPECT_EQ(hash(resumed.out), without) << resumed.err;
  EXPECT_EQ(last("tip", "half"), last("tip"));
  EXPECT_EQ(last("z", "half"), last("z"));
  EXPECT_NE(last("z"), 0);
}

TEST_F(Probes, HaveColumnsThatNoOtherColumnIsCalledLike) {
  write_scene("  <Probe name='step_ms' value='@nodes.position' indices='80'/>\n");
  succeeds("run bar.scn --out run --frames 0 --quiet");
  EXPECT_EQ(std::ranges::count_if(history().columns(), [](const std::string& c) { return c.starts_with("probe_"); }),
            1);
  EXPECT_EQ(std::ranges::count(history().columns(), "step_ms"), 1);
  EXPECT_NEAR(last("step_ms"), 0.45, 0.05);
}

TEST_F(Probes, ThatAreZeroThroughoutAreNamed) {
  write_scene(
      "  <Probe name='wide' value='@nodes.position' indices='0' component='x'/>\n"
      "  <Probe name='pull' value='@forceps.force'/>\n");
  EXPECT_EQ(succeeds("run bar.scn").err, "warning: the probe 'wide' was 0 throughout\n");
  EXPECT_TRUE(has(succeeds("run bar.scn --steps 3").err, "the probe 'pull' was 0 throughout")) << "not grasped yet";
}

TEST_F(Probes, BladesThatMissAreToldOfToo) {
  const std::string blade = "  <BladeController points='0 -1 0  0 1 0' keyTimes='0 0.1' positions='";
  write_scene(blade + "0.06 0 2  0.06 0 1'/>\n");
  EXPECT_TRUE(has(succeeds("run bar.scn").err, "warning: nothing was cut"));
  write_scene(blade + "-0.1 0 0.21  0.2 0 0.21'/>\n");
  EXPECT_EQ(succeeds("run bar.scn").err, "");
}

TEST_F(Probes, OfConstraintsTellWhatBalancesABodyAtRest) {
  // at rest the support carries what the forceps pull, in force and in moment
  write_scene(R"xml(  <Probe name="fx" value="@held.reaction" component="x"/>
  <Probe name="fy" value="@held.reaction" component="y"/>
  <Probe name="fz" value="@held.reaction" component="z"/>
  <Probe name="mx" value="@held.reactionTorque" component="x"/>
  <Probe name="my" value="@held.reactionTorque" component="y"/>
  <Probe name="gy" value="@forceps.force" component="y"/>
  <Probe name="gz" value="@forceps.force" component="z"/>
  <Probe name="tx" value="@forceps.torque" component="x"/>
)xml");
  write("bar.scn", replaced(replaced(read("bar.scn"), "yieldStress=\"2000\"\n      plasticFlowRate=\"4\"", ""),
                            "rayleighMass=\"0.1\"", "rayleighMass=\"8\""));
  succeeds("run bar.scn --out run --frames 0 --quiet --steps 600");
  EXPECT_GT(std::abs(last("gy")), 0.5);
  EXPECT_NEAR(last("fx"), 0, 1e-6);
  EXPECT_NEAR(last("fy"), -last("gy"), 1e-6);
  EXPECT_NEAR(last("fz"), -last("gz"), 1e-6);
  // the tool ends at (0.05, 0.1, 0.45)
  const double about_origin = last("tx") + 0.1 * last("gz") - 0.45 * last("gy");
  EXPECT_GT(std::abs(about_origin), 0.1);
  EXPECT_NEAR(last("mx"), -about_origin, 1e-6);
}

TEST_F(Probes, OfConstraintsAreExactInMotionToo) {
  // every node is prescribed: a rigid body that is accelerated needs its mass times its acceleration, step by step
  write("prescribed.scn", R"xml(<Node dt="0.01" gravity="0 0 -10">
  <RunSettings steps="20"/><DefaultAnimationLoop/><EulerImplicitSolver rayleighMass="0" rayleighStiffness="0"/>
  <SparseLDLSolver/><RegularGridTopology name="grid" n="3 3 3" max="0.1 0.1 0.1"/><MechanicalObject name="nodes"/>
  <UniformMass totalMass="2"/><HexahedronElastoplasticFEMForceField name="body" youngModulus="5e4"/>
  <FixedProjectiveConstraint name="held" indices="0-8"/><Probe name="z" value="@held.reaction" component="z"/>
  <Probe name="com" value="@nodes.velocity" component="z" statistic="sum"/></Node>)xml");
  succeeds("run prescribed.scn --out run --frames 0 --quiet");
  const Csv moved = history();
  double before = 0;
  for (std::size_t step = 0; step < moved.num_rows(); ++step) {
    // momentum: m dv / dt = reaction - weight, whatever happens inside
    const double momentum = 2. / 27 * moved.number(step, "probe_com");
    if (step > 0) {
      EXPECT_NEAR((momentum - before) / 0.01, moved.number(step, "probe_z") - 20, 1e-7) << step;
    }
    before = momentum;
  }
}

TEST_F(Probes, OfConstraintsAreToldByImplicitEulerAlone) {
  write_scene("  <Probe name='z' value='@held.reaction' component='z'/>\n");
  write("static.scn", replaced(read("bar.scn"), "<EulerImplicitSolver rayleighMass=\"0.1\" rayleighStiffness=\"0.1\"/>",
                               "<StaticSolver newtonSolver='@newton'/><NewtonRaphsonSolver name='newton'/>"));
  expect_refused({{"run static.scn", 3, "reaction: is told by EulerImplicitSolver only"}});
}

TEST_F(Probes, FollowPointsWithinTheBodyAndVolumesOfRegions) {
  write_scene(R"xml(  <Probe name="inside" value="@nodes.position" points="0.03 0.07 0.21" component="z"/>
  <Probe name="moved" value="@nodes.position" points="0.03 0.07 0.21  0.05 0.05 0.4" change="true" statistic="max"/>
  <Probe name="at_node" value="@nodes.position" points="0.05 0.05 0.4" component="y"/>
  <Probe name="node" value="@nodes.position" indices="76" component="y"/>
  <Probe name="volume" value="@body.volume" statistic="sum"/>
  <Probe name="plastic_volume" value="@body.plasticVolume" indices="0-3" statistic="sum"/>
)xml");
  succeeds("run bar.scn --out run --frames 0 --final final.json --set body.restShape=joined");
  EXPECT_NEAR(last("at_node"), last("node"), 1e-14);
  EXPECT_GT(last("moved"), 0.01);
  // by hand: the cell's corners around it, 20 % and 40 % along its sides, 1/5 up
  const Json state = json("final.json");
  double z = 0;
  const double s[3] = {0.03 / 0.05, 0.02 / 0.05, 0.01 / 0.05};
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
    const double weight = (i ? s[0] : 1 - s[0]) * (j ? s[1] : 1 - s[1]) * (k ? s[2] : 1 - s[2]);
    z += weight * state["positions"][(4 + k) * 9 + (1 + j) * 3 + i][2].get<double>();
  }
  EXPECT_NEAR(last("inside"), z, 1e-14);
  EXPECT_NEAR(last("volume"), 0.004 * history().numbers("current_volume_ratio").back(), 1e-15);
  EXPECT_NEAR(last("plastic_volume"), vector(state["volume_ratio"]).head(4).sum() * 0.05 * 0.05 * 0.05, 1e-15);

  write_scene("  <Probe name='out' value='@nodes.position' points='0.05 0.05 0.5'/>\n");
  EXPECT_TRUE(has(hexaplast("run bar.scn --steps 1").err, "1 of 1 lie outside of all hexahedra, by up to 0.1 m"));
}

TEST_F(Probes, AreComparedSideBySide) {
  write_scene("  <Probe name='pull' value='@forceps.force'/>\n");
  succeeds("run bar.scn --out a --frames 0 --quiet");
  succeeds("run bar.scn --out b --frames 0 --quiet --set body.youngModulus=4e4");
  succeeds("compare a b -o page.html");
  const std::string page = read("page.html");
  EXPECT_TRUE(has(page.substr(page.find("Over time")), ">pull"));
}

TEST_F(Probes, ThatCannotBeReadAreRefused) {
  for (const auto& [probe, message] : std::vector<std::pair<std::string, std::string>>{
           {"<Probe name='tip'/>", "14: error: Probe.value: is not given: there is nothing to record"},
           {"<Probe name='tip' value='@nodes.position' indices='81'/>",
            "14: error: Probe.indices: holds 81, must lie in [0, 81)"},
           {"<Probe name='tip' value='@nodes.position' indices=''/>", "14: error: Probe.indices: holds none"},
           {"<Probe name='tip' value='@nodes.position' component='w'/>", "14: error: Probe.component"},
           {"<Probe name='tip' value='@body.volume' component='z'/>",
            "14: error: Probe.component: is given for a value that holds no vectors"},
           {"<Probe name='tip' value='@body.plasticStrain' points='0.05 0.05 0.5'/>",
            "14: error: Probe.points: need one vector per node"},
           {"<Probe name='tip' value='@forceps.name'/>", "14: error: "},
           {"<Probe name='tip' value='@nobody.force'/>", "14: error: "},
           {"<Probe name='the tip' value='@nodes.position'/>", "14: error: Probe 'the tip': names a column"},
           {"<Node name='a'><Probe name='tip' value='@../nodes.position'/></Node>\n<Node name='b'><Probe name='tip' "
            "value='@../nodes.position'/></Node>",
            "15: error: Probe 'tip': a second probe of that name"},
           {"<Probe name='probe_tip' value='@nodes.position'/>\n<Probe name='tip' value='@nodes.position'/>",
            "15: error: Probe 'tip': its column of history.csv has the name of that of Probe 'probe_tip'"}}) {
    write_scene(probe + "\n");
    expect_refused({{"run bar.scn --out run --frames 0", 3, "bar.scn:" + message}});
    EXPECT_FALSE(is_there("run/history.csv"));
  }
}

}  // namespace
