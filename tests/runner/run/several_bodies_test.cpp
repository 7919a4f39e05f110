// SPDX-License-Identifier: LGPL-2.1-or-later
// What a run of several bodies writes, against runs of each alone.
#include <gtest/gtest.h>

#include <algorithm>

#include "hexaplast/formats/mesh_import.hpp"
#include "support/command.hpp"
#include "support/compare.hpp"
#include "support/golden.hpp"

namespace {

using namespace hexaplast;
using namespace support;

constexpr std::string_view kLiver =
    "<RegularGridTopology n='3 3 4' max='.02 .02 .03'/><MechanicalObject name='nodes'/><UniformMass totalMass='.1'/>"
    "<FixedProjectiveConstraint indices='0-8'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='3000' "
    "yieldStress='300' plasticFlowRate='5' fractureStretch='1.4'/><ConstantForceField indices='27-35' "
    "totalForce='0 0 .5'/>";
constexpr std::string_view kSac =
    "<RegularGridTopology n='2 3 2' min='.05 0 0' max='.06 .02 .01'/><MechanicalObject name='nodes'/>"
    "<UniformMass totalMass='.01'/><FixedProjectiveConstraint indices='0 1'/>"
    "<HexahedronElastoplasticFEMForceField name='body' youngModulus='1000'/>";

class SeveralBodiesRun : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    const auto scene = [](const std::string& nodes) {
      return "<Node gravity='0 -1 0' dt='.01'><DefaultAnimationLoop/><RunSettings steps='60' outputEvery='20'/>"
             "<EulerImplicitSolver rayleighMass='1'/><SparseLDLSolver/>" +
             nodes + "</Node>";
    };
    const std::string liver = "<Node name='liver'>" + std::string(kLiver) + "</Node>",
                      sac = "<Node name='sac'>" + std::string(kSac) + "</Node>";
    write("both.scn", scene(liver + sac));
    write("liver.scn", scene(liver));
    write("sac.scn", scene(sac));
  }

  ImportedState state(const std::string& file) const { return read_vtu_state(directory_ / file); }
  static std::vector<double> array(const std::vector<ImportedArray>& arrays, const std::string& name) {
    const auto found = std::ranges::find(arrays, name, &ImportedArray::name);
    EXPECT_NE(found, arrays.end()) << name;
    return found == arrays.end() ? std::vector<double>() : found->values;
  }
};

TEST_F(SeveralBodiesRun, WritesThemOneBehindTheOther) {
  for (const std::string name : {"both", "liver", "sac"}) {
    succeeds("run " + name + ".scn --quiet --frames 1 --out " + name + " --final " + name + ".json");
  }
  const Json both = json("both.json"), liver = json("liver.json"), sac = json("sac.json");
  EXPECT_EQ(both["bodies"], Json::parse(R"([{"name": "liver", "first_node": 0, "nodes": 36, "first_hexahedron": 0,
      "hexahedra": 12}, {"name": "sac", "first_node": 36, "nodes": 12, "first_hexahedron": 12, "hexahedra": 2}])"));
  EXPECT_FALSE(liver.contains("bodies"));
  for (const char* list : {"positions", "velocities", "plastic_rest_positions"}) {
    Eigen::MatrixXd expected(48, 3);
    expected << matrix(liver[list]), matrix(sac[list]);
    EXPECT_LT((matrix(both[list]) - expected).cwiseAbs().maxCoeff(), 1e-12) << list;
  }
  EXPECT_EQ(both["volume_ratio"].size(), 14U);
  EXPECT_NE(both["state_hash"], liver["state_hash"]);

  // hexahedra that have gone, of the liver alone
  EXPECT_FALSE(both["removed"].empty());
  EXPECT_EQ(both["removed"], liver["removed"]);
  const std::string removed = read("both/removed.csv");
  EXPECT_TRUE(removed.starts_with("step,time,hexahedron,body\n")) << removed;
  EXPECT_TRUE(has(removed, ",liver\n"));
  EXPECT_FALSE(has(removed, ",sac\n"));

  const ImportedState first = state("both/mesh_000000.vtu"), last = state("both/mesh_000060.vtu");
  EXPECT_EQ(first.mesh.positions.rows(), 48);
  std::vector<double> body(14, 0);
  body[12] = body[13] = 1;
  EXPECT_EQ(array(first.cell_data, "body"), body);
  EXPECT_EQ(array(last.cell_data, "body").size(), 14 - both["removed"].size());
  EXPECT_EQ(array(last.cell_data, "body").back(), 1);
  const std::vector<double> fixed = array(first.point_data, "fixed");
  for (int n = 0; n < 48; ++n) EXPECT_EQ(fixed[n], n < 9 || n == 36 || n == 37) << n;
  EXPECT_TRUE(is_there("both/frames/frame_000060.png"));
  const std::string report = read("both/report.html");
  EXPECT_TRUE(has(report, "body liver"));
  EXPECT_TRUE(has(report, "body sac"));
}

TEST_F(SeveralBodiesRun, ChecksEach) {
  const Outcome checked = succeeds("check both.scn --json");
  const Json found = Json::parse(checked.out);
  EXPECT_EQ(found["nodes"], 48);
  EXPECT_EQ(found["hexahedra"], 14);
  EXPECT_EQ(found["held_nodes"], 11);
  EXPECT_TRUE(found["body"].is_null());
  ASSERT_EQ(found["bodies"].size(), 2U);
  EXPECT_EQ(found["bodies"][0]["name"], "liver");
  EXPECT_NEAR(found["bodies"][0]["mass"].get<double>(), 0.1, 1e-15);
  EXPECT_EQ(found["bodies"][1]["name"], "sac");
  EXPECT_NEAR(found["bodies"][1]["volume"].get<double>(), 0.01 * 0.02 * 0.01, 1e-15);
  EXPECT_NEAR(found["load"][1].get<double>(), -0.11, 1e-12);
  EXPECT_TRUE(has(hexaplast("check both.scn").out, "body                sac"));
}

// What step 0 of a run is.
TEST_F(SeveralBodiesRun, AreExportedAsOneMesh) {
  succeeds("mesh export both.scn -o both.vtu");
  succeeds("run both.scn --quiet --steps 1 --frames 0 --out both");
  const ImportedState exported = state("both.vtu"), ran = state("both/mesh_000000.vtu");
  EXPECT_EQ(exported.mesh.positions, ran.mesh.positions);
  EXPECT_EQ(exported.mesh.hexahedra, ran.mesh.hexahedra);
  EXPECT_EQ(array(exported.cell_data, "body"), array(ran.cell_data, "body"));
}

// A curve of one body of two, as a Probe records it.
TEST_F(SeveralBodiesRun, AreFitted) {
  std::string scene = read("both.scn");
  scene.insert(scene.rfind("</Node>"),
               "<Probe name='sag' value='@sac/nodes.position' indices='11' component='y' change='true'/>");
  write("probed.scn", scene);
  succeeds("run probed.scn --quiet --steps 30 --frames 0 --out truth --set sac/body.youngModulus=2300");
  succeeds(
      "fit probed.scn --target truth/history.csv --compare probe_sag --out found --free "
      "sac/body.youngModulus=300:9000");
  EXPECT_NEAR(json("found/fit.json")["parameters"][0]["value"].get<double>(), 2300, 2);

  write("force.csv", "time,force\n0.1,1\n0.2,2\n");
  fails("fit both.scn --target force.csv --out none --free sac/body.youngModulus=300:9000", 3,
        "force.csv:1: error: column 'force': is that of the only body, and the scene has 2");
}

TEST_F(SeveralBodiesRun, ABenchmarkIsOfOne) {
  const Outcome refused = fails("bench --scene both.scn", 3, "`bench` takes scenes of one");
  EXPECT_TRUE(has(refused.err, "both.scn:1: error: "));
}

}  // namespace
